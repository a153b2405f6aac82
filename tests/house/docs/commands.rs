//! The output of the command line, and the commands that the documents show.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use crate::commands::commands;
use crate::docs::documents;

const TAXEL: &str = env!("CARGO_BIN_EXE_taxel");

/// Every command, in the order of `taxel help`.
static COMMANDS: LazyLock<Vec<String>> =
    LazyLock::new(|| commands(&|name| shell(&format!("taxel {name} --help"))));

fn is_command(name: &str) -> bool {
    COMMANDS.iter().any(|command| command == name)
}

/// Returns the output of a shell line, with this build's `taxel` first on the path and the program's default settings.
fn shell(line: &str) -> String {
    shell_in(Path::new(env!("CARGO_MANIFEST_DIR")), line)
}

/// Like [`shell`], in a given folder.
pub(crate) fn shell_in(current: &Path, line: &str) -> String {
    let folder = Path::new(TAXEL)
        .parent()
        .expect("the program is in a folder");
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::iter::once(folder.to_owned()).chain(std::env::split_paths(&path));
    let output = Command::new("sh")
        .args(["-c", line])
        .current_dir(current)
        .env("PATH", std::env::join_paths(path).expect("a path"))
        .env("TAXEL_CONFIG", "/dev/null")
        .env("LC_ALL", "C.UTF-8")
        .output()
        .expect("there is a shell");
    assert!(
        output.status.success(),
        "{line}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).expect("the output is text")
}

/// The result in the README: a command and its output.
pub(crate) fn result() -> String {
    let line = "taxel sweep rectangle --length 6 --width 3 --quiet | grep -E 'imprints|mean|^na |^p |^side_ratio'";
    format!("\n```text\n$ {line}\n{}```\n\n", shell(line))
}

/// The worked example of the page about sweeps.
pub(crate) fn study() -> String {
    let line = "for width in 3 3.2 4; do taxel sweep rectangle --length 6 --width $width --quiet | grep '^na '; done";
    format!("\n```text\n$ {line}\n{}```\n\n", shell(line))
}

/// The help texts.
pub(crate) fn help() -> String {
    COMMANDS
        .iter()
        .map(|name| {
            let line = format!("taxel {name}").trim_end().to_owned();
            format!(
                "\n### {line}\n\n```text\n{}```\n",
                shell(&format!("{line} --help"))
            )
        })
        .collect::<String>()
        + "\n"
}

/// Returns the shell lines of a document that call `taxel`; continuation lines are joined.
fn calls(text: &str) -> Vec<String> {
    let mut calls = Vec::new();
    for (index, fence) in text.split("```").enumerate() {
        let Some(code) = fence.strip_prefix("sh\n").filter(|_| index % 2 == 1) else {
            continue;
        };
        let code = code.replace("\\\n", " ");
        calls.extend(
            code.lines()
                .filter(|line| line.starts_with("taxel "))
                .map(str::to_owned),
        );
    }
    calls
}

fn is_of_flag(character: char) -> bool {
    character.is_ascii_alphanumeric() || character == '-'
}

/// Readers copy these lines, so each must name a command of the program and flags of this command.
#[test]
fn every_command_shown_exists_with_its_flags() {
    let mut helps = BTreeMap::new();
    let mut checked = 0;
    for (path, text) in documents() {
        for call in calls(&text) {
            let call = call.split(" #").next().expect("a line");
            let call = call.split(['|', '<', '>', ';']).next().expect("a command");
            let mut words = call.split_whitespace().skip(1).peekable();
            let mut name = words
                .next_if(|word| !word.starts_with('-'))
                .unwrap_or_default()
                .to_owned();
            // A subcommand has its own help.
            let longer = words.peek().map(|word| format!("{name} {word}"));
            if let Some(longer) = longer.filter(|longer| is_command(longer)) {
                words.next();
                name = longer;
            }
            let name = name.as_str();
            if name == "help" {
                continue;
            }
            assert!(
                is_command(name),
                "{}: no command {name:?}: {call}",
                path.display()
            );
            let help: &String = helps
                .entry(name.to_owned())
                .or_insert_with(|| shell(&format!("taxel {name} --help")));
            for flag in words.filter(|word| word.starts_with("--")) {
                let flag = flag.split('=').next().expect("a flag");
                let mut known = help.split(|character: char| !is_of_flag(character));
                assert!(
                    known.any(|word| word == flag),
                    "{}: taxel {name} has no {flag}",
                    path.display()
                );
                checked += 1;
            }
        }
    }
    assert!(checked >= 20, "{checked} flags were found in the documents");
}
