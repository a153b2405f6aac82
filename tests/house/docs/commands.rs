//! The commands that the documents show.
//!
//! Blocks are run in a folder of their page that holds the samples of the guide. In a `console` block, what a line
//! `$ …` prints follows it; of a `bash` block, what it prints is left out. A `python` block is run if Python has the
//! modules that it imports; a `taxel` block is a script for the screen. In an `sh` block is what no test can run, such as
//! a sensor on a serial line: it is only asked whether `taxel` takes the flags.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use crate::docs::{document, documents, root};
use crate::skip::skipped;

/// A folder that belongs to this build, with a folder for each page.
const FOLDERS: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/docs");

/// The samples, made by the lines that the guide shows for them.
static SAMPLES: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = Path::new(FOLDERS);
    // It may be left from an earlier run.
    fs::remove_dir_all(folder).ok();
    fs::create_dir_all(folder).expect("a folder can be made");
    let guide = document("docs/README.md");
    let lines = blocks(&guide, "sh").find(|lines| lines.contains("CLONE"));
    let clone = root().to_str().expect("a path in UTF-8");
    let lines = lines.expect("the samples").replace("CLONE", clone);
    printed(folder, &format!("set -e\n{lines}"));
    folder.join("samples")
});

/// Returns the blocks of code in a language.
fn blocks<'a>(text: &'a str, language: &'a str) -> impl Iterator<Item = &'a str> {
    let codes = text.split("```").skip(1).step_by(2);
    codes.filter_map(move |code| code.strip_prefix(language)?.strip_prefix('\n'))
}

/// Runs lines in a shell, with this build's `taxel` first on the path, and without the user's settings and library.
fn shell(folder: &Path, lines: &str) -> Output {
    let taxel = Path::new(env!("CARGO_BIN_EXE_taxel"));
    let taxel = taxel.parent().expect("it is in a folder").to_owned();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::iter::once(taxel).chain(std::env::split_paths(&path));
    Command::new("sh")
        .args(["-c", lines])
        .current_dir(folder)
        .env("PATH", std::env::join_paths(path).expect("a path"))
        .env("TAXEL_CONFIG", "/dev/null")
        .env("TAXEL_LIBRARY", folder.join("library"))
        .env("XDG_CACHE_HOME", Path::new(FOLDERS).join("cache"))
        .env("LC_ALL", "C.UTF-8")
        .output()
        .expect("there is a shell")
}

/// Returns what lines print that must succeed; nothing if there is no such program as the last one of them.
fn printed(folder: &Path, lines: &str) -> Option<String> {
    let output = shell(folder, lines);
    let said = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(127) {
        skipped(&format!("lines of the documents are not run: {said}"));
        return None;
    }
    assert!(output.status.success(), "{lines}: {said}");
    Some(String::from_utf8(output.stdout).expect("the output is text"))
}

/// Runs the blocks of a page in their order. Returns the page with their present output, and its folder.
pub(crate) fn run(page: &Path, text: &str) -> (String, PathBuf) {
    let folder = Path::new(FOLDERS).join(page.to_string_lossy().replace('/', "-"));
    let mut parts: Vec<String> = text.split("```").map(str::to_owned).collect();
    for code in parts.iter_mut().skip(1).step_by(2) {
        match code.split_once('\n') {
            Some(("console", lines)) => {
                *code = format!("console\n{}", console(furnished(&folder), lines));
            }
            Some(("bash", lines)) => {
                printed(furnished(&folder), &format!("set -e\n{lines}"));
            }
            // python/tests runs those of the page about the module, which has to be built for them.
            Some(("python", program)) if !page.ends_with("python.md") => {
                python(furnished(&folder), program);
            }
            Some(("taxel", script)) => {
                fs::write(furnished(&folder).join("shown.taxel"), script).expect("written");
                printed(&folder, "taxel script --update shown.taxel");
            }
            _ => {}
        }
    }
    (parts.join("```"), folder)
}

/// Puts the samples into a folder, unless it is there already, and the folder that the README calls `examples`.
fn furnished(folder: &Path) -> &Path {
    let (samples, to) = (SAMPLES.display(), folder.display());
    if !folder.exists() {
        let lines = format!("cp -r '{samples}' '{to}' && ln -s \"$PWD/examples\" '{to}/examples'");
        printed(root(), &lines);
    }
    folder
}

/// Returns the block with the present output of its lines.
fn console(folder: &Path, block: &str) -> String {
    let mut text = String::new();
    for line in block.lines() {
        let Some(command) = line.strip_prefix("$ ") else {
            continue;
        };
        // Later lines may need what this one writes, so the block stays as it is.
        let Some(printed) = printed(folder, command) else {
            return block.to_owned();
        };
        for line in std::iter::once(line).chain(printed.lines()) {
            text += line.trim_end();
            text.push('\n');
        }
    }
    text
}

/// Runs a program if Python has its modules; otherwise its grammar is checked.
fn python(folder: &Path, program: &str) {
    let imports = program.lines().filter(|line| line.starts_with("import "));
    let imports = imports.collect::<Vec<_>>().join("\n");
    let python = |arguments: &[&str]| {
        let mut python = Command::new("python3");
        let output = python.args(arguments).current_dir(folder).output();
        let output = output.map_err(|error| error.to_string())?;
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        output.status.success().then_some(()).ok_or(said)
    };
    let Err(lacks) = python(&["-c", &imports]) else {
        return python(&["-c", program]).unwrap_or_else(|said| panic!("{program}\n{said}"));
    };
    let lacks = lacks.trim_end().lines().last().unwrap_or_default();
    skipped(&format!("a program of the documents is not run: {lacks}"));
    if python(&["-c", ""]).is_ok() {
        let read = "import ast, sys; ast.parse(sys.argv[1])";
        python(&["-c", read, program]).unwrap_or_else(|said| panic!("{program}\n{said}"));
    }
}

/// Readers copy the lines that cannot be run here, too. With `--help` at its end, `taxel` refuses the flags before it
/// that it does not have, and values that they cannot take.
#[test]
fn every_command_that_is_not_run_exists_with_its_flags() {
    let mut checked = 0;
    for (page, text) in documents() {
        for block in blocks(&text, "sh") {
            // A part of a line ends at a pipe, a file or a comment.
            let mut parts = block.replace("\\\n", " ");
            for end in [" | ", " > ", " < ", " #", "; "] {
                parts = parts.replace(end, "\n");
            }
            for call in parts.lines().filter(|part| part.starts_with("taxel ")) {
                let output = shell(root(), &format!("{call} --help"));
                let said = String::from_utf8_lossy(&output.stderr);
                let page = page.display();
                assert!(output.status.success(), "{page}: {call}: {said}");
                checked += 1;
            }
        }
    }
    assert!(
        checked >= 20,
        "{checked} commands were found in the documents"
    );
}
