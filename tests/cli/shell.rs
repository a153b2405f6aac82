//! Integration into the shell: completions, man pages, and the examples of every help text, which are all run.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use super::commands::commands;
use super::misused;
use super::program;
use super::skip::lacking;
use super::taxel;

/// Every command; each has its own help.
static COMMANDS: LazyLock<Vec<String>> = LazyLock::new(|| commands(&help));

/// Returns true if a program is installed; otherwise reports that a part of the test is skipped.
fn has(name: &str) -> bool {
    let there = Command::new(name).arg("--version").output().is_ok();
    if !there {
        lacking(name);
    }
    there
}

fn help(command: &str) -> String {
    let run = taxel(&format!("{command} --help"), "");
    assert_eq!(
        (run.status, run.stderr.as_str()),
        (Some(0), ""),
        "{command}"
    );
    run.stdout
}

#[test]
fn every_help_fits_80_columns_and_ends_with_examples() {
    for command in COMMANDS.iter() {
        let help = help(command);
        let (_, examples) = help.split_once("\nExamples:\n").expect(command);
        assert!(
            examples.lines().all(|line| line.starts_with("  ")),
            "{command}: {examples}"
        );
        let widest = help.lines().map(|line| line.chars().count()).max();
        assert!(widest <= Some(80), "{command}: {widest:?}\n{help}");
    }
}

/// Returns the examples of a help text: one line each, or several if a line ends in a backslash.
fn examples(help: &str) -> Vec<String> {
    let (_, examples) = help.split_once("\nExamples:\n").expect("examples");
    let examples = examples.replace("\\\n", "");
    examples
        .lines()
        .map(|line| line.trim().to_owned())
        .collect()
}

/// Prepares a folder with all files that the examples expect.
fn furnished(folder: &Path) {
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).expect("written");
    write("imprint.txt", ".##.\n#..#\n.##.\n");
    let cells: Vec<String> = (1..=16).map(|cell| format!("s{cell}")).collect();
    let values = vec!["12"; 16].join(",");
    let labelled = format!("label,{}\nwasher,{values}\n", cells.join(","));
    write("labelled.csv", &labelled);
    write("dead.txt", "....\n..#.\n....\n");
    fs::create_dir(folder.join("parts")).expect("made");
    let bracket = include_str!("../../examples/parts/bracket-left.svg");
    write("parts/bracket.svg", bracket);
    write(
        "parts/cam.svg",
        include_str!("../../examples/parts/cam.svg"),
    );
    write("logo.svg", &bracket.replace("mm\"", "\""));
    write("points.csv", "x,y\n0,0\n15,0\n0,10\n");
    write("touch.txt", include_str!("../../examples/touch.txt"));
    write("washer.json", super::describe::SHAPE);
    write("poses.jsonl", "{\"imprint\":[\"##\",\"#.\"]}\n");
    for (name, text) in [
        (
            "recording.csv",
            include_str!("../../examples/recording.csv"),
        ),
        (
            "plain.csv",
            include_str!("../files/frames/samples/plain.csv"),
        ),
    ] {
        write(name, text);
    }
    write("parts.jsonl", super::model::PARTS);
    write("rows.txt", include_str!("../files/frames/samples/rows.txt"));
    write("test.taxel", "Keys f<Enter>\nExpect /ellipse/\n");
    fs::create_dir(folder.join("tests")).expect("made");
    write("tests/a.taxel", "Keys f<Enter>\n");
    for folder_of in [
        "shapes",
        ".zfunc",
        ".config/fish/completions",
        ".local/share/bash-completion/completions",
    ] {
        fs::create_dir_all(folder.join(folder_of)).expect("made");
    }
    let grid = "sweep hexagon --side 3 --angle 0 --x0 1 --y0 1:1.03:0.01 --quiet";
    for (shard, file) in [("1/2", "a.npz"), ("2/2", "b.npz")] {
        let file = folder.join(file);
        let line = format!("{grid} --shard {shard} --atlas {}", file.display());
        assert_eq!(taxel(&line, "").status, Some(0), "{line}");
        let twin = format!("hexagon-{}.npz", &shard[..1]);
        fs::copy(&file, folder.join(twin)).expect("copied");
    }
}

/// Trains the models that the examples of a command expect.
fn with_models(folder: &Path, command: &str) {
    let coarse = "--positions 5 --angle 0:350:10 --quiet";
    let train = |files: &str| {
        let line = format!(
            "model train {} {coarse} {files}",
            folder.join("parts.jsonl").display()
        );
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let mut run = program(&arguments, "C.UTF-8");
        let output = run.env("TAXEL_LIBRARY", folder.join("library")).output();
        assert!(output.expect("it runs").status.success(), "{line}");
    };
    let file = |name: &str| folder.join(name).display().to_string();
    match command {
        "model" | "model train" => {}
        "merge" => {
            train(&format!("--shard 1/2 --out {}", file("part-1.npz")));
            train(&format!("--shard 2/2 --out {}", file("part-2.npz")));
        }
        _ => {
            train("--name parts");
            train(&format!("--out {}", file("parts.npz")));
            fs::copy(file("parts.npz"), file("shipped.npz")).expect("copied");
        }
    }
}

fn in_library(folder: &Path, arguments: &[&str]) {
    let mut run = program(&[&["library"], arguments].concat(), "C.UTF-8");
    let output = run.env("TAXEL_LIBRARY", folder.join("library")).output();
    assert!(output.expect("it runs").status.success(), "{arguments:?}");
}

/// The examples of one help text run in sequence in one folder: what the first one stores, the second may delete.
#[test]
fn every_example_of_every_help_runs() {
    let binary = Path::new(env!("CARGO_BIN_EXE_taxel"));
    let mut path = binary.parent().expect("a folder").as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let man = has("man");
    let mut run = 0;
    for command in COMMANDS.iter() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        furnished(folder);
        let named = ["merge", "recognise", "frames", "watch"].contains(&command.as_str());
        if named || command.starts_with("model") {
            with_models(folder, command);
        }
        if ["library delete", "library restore", "library path"].contains(&command.as_str()) {
            in_library(folder, &["save", "ring", "washer"]);
        }
        if command == "library restore" {
            in_library(folder, &["delete", "ring"]);
        }
        for example in examples(&help(command)) {
            // The screen has its own tests, and so have sweeps, which would take long with millions of poses.
            let long = [
                "sweep rectangle --length 6 --width 3",
                "--zoom-x 0.8:1.2:0.1",
            ];
            if example == "taxel" || long.iter().any(|long| example.contains(long)) {
                continue;
            }
            if example.contains(" man ") && !man {
                continue;
            }
            let output = Command::new("sh")
                .args(["-c", &example])
                .current_dir(folder)
                .env("PATH", &path)
                .env("HOME", folder)
                .env("MANPATH", folder.join(".local/share/man"))
                .env("TAXEL_LIBRARY", folder.join("library"))
                .env_remove("TAXEL_CONFIG")
                .env_remove("XDG_CACHE_HOME")
                .env_remove("XDG_CONFIG_HOME")
                .env_remove("XDG_DATA_HOME")
                .env("LC_ALL", "C.UTF-8")
                .output()
                .expect("there is a shell");
            assert!(output.status.success(), "{example}: {output:?}");
            run += 1;
        }
    }
    assert!(run > 40, "only {run} examples");
}

#[test]
fn shells_accept_the_completions() {
    for (shell, check) in [("bash", "-n"), ("zsh", "-n"), ("fish", "--no-execute")] {
        let run = taxel(&format!("completions {shell}"), "");
        assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""), "{shell}");
        for word in ["figure", "restore", "radius-x"] {
            assert!(run.stdout.contains(word), "{shell}: no {word}");
        }
        if !has(shell) {
            continue;
        }
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("completions");
        fs::write(&file, &run.stdout).expect("written");
        let output = Command::new(shell).arg(check).arg(&file).output();
        let output = output.expect("it runs");
        assert!(output.status.success(), "{shell}: {output:?}");
    }
    misused("completions", "the following required arguments");
    misused("completions csh", "invalid value 'csh'");
}

#[test]
fn every_command_has_a_man_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let pages = folder.path().join("share/man1");
    let run = taxel(&format!("man {}", pages.display()), "");
    let said = format!("written: {} pages in {}\n", COMMANDS.len(), pages.display());
    assert_eq!(
        (run.status, run.stdout, run.stderr.as_str()),
        (Some(0), said, "")
    );
    let first = fs::read_to_string(pages.join("taxel.1")).expect("a page");
    assert_eq!(taxel("man", "").stdout, first);
    let groff = has("groff");
    for command in COMMANDS.iter().filter(|_| groff) {
        let name = format!("taxel {command}").trim().replace(' ', "-");
        let mut groff = Command::new("groff");
        let page = pages.join(format!("{name}.1"));
        let output = groff.args(["-man", "-Tutf8"]).arg(page).output();
        assert!(output.expect("it runs").status.success(), "{command}");
    }
    let number = fs::read_dir(&pages).expect("a folder").count();
    assert_eq!(number, COMMANDS.len(), "each command has a page");
}
