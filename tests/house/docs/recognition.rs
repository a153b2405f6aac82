//! The commands on the page about recognition: the program runs them when the page is checked, so each number is its
//! own.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use crate::docs::commands::shell_in;

/// The set of shapes that the page uses.
const SET: &str = include_str!("../../../examples/figures.jsonl");

/// Runs shell lines in a folder with the set and its model. Returns each line followed by its output.
fn shown(lines: &[&str]) -> String {
    trained();
    let shown = lines
        .iter()
        .map(|line| format!("$ {line}\n{}", shell_in(Path::new(FOLDER), line)));
    let shown: Vec<String> = shown.collect();
    format!("\n```text\n{}```\n\n", shown.join("\n"))
}

const TRAIN: &str = "taxel model train figures.jsonl --out figures.npz --quiet";

/// A folder that belongs to this build.
const FOLDER: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/recognition");

/// Trains the model in the folder, once for all blocks of the page, and returns the output of the training.
fn trained() -> &'static str {
    static PRINTED: OnceLock<String> = OnceLock::new();
    PRINTED.get_or_init(|| {
        let folder = Path::new(FOLDER);
        // The folder may be left from an earlier run.
        fs::remove_dir_all(folder).ok();
        fs::create_dir_all(folder).expect("a folder can be made");
        fs::write(folder.join("figures.jsonl"), SET).expect("written");
        shell_in(folder, TRAIN)
    })
}

pub(crate) fn set() -> String {
    format!("\n```json\n{SET}```\n\n")
}

pub(crate) fn train() -> String {
    format!("\n```text\n$ {TRAIN}\n{}```\n\n", trained())
}

pub(crate) fn confusion() -> String {
    shown(&["taxel model confusion figures.npz | tail -1"])
}

pub(crate) fn worth() -> String {
    shown(&["taxel model confusion figures.npz --greedy"])
}

pub(crate) fn peers() -> String {
    shown(&[
        "for by in z knn template; do taxel model confusion figures.npz --classifier $by | grep wrong; done",
    ])
}

/// The numbers in the text of the page must be those that the program prints.
#[test]
fn the_numbers_in_the_text_are_those_that_the_commands_print() {
    let page = crate::docs::document("docs/recognition.md");
    let limit = trained().lines().find(|line| line.starts_with("wrong"));
    assert!(limit.is_some_and(|line| line.contains(" 33.0 %")));
    assert!(page.contains("misnames at least 33 %") && page.contains("The limit is 0.330"));
}
