//! The commands on the page about recognition: the program runs them when the page is checked, so each number is its
//! own.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use crate::docs::commands::shell_in;

/// The set of shapes that the page uses.
const SET: &str = include_str!("../../../examples/figures.jsonl");

/// The set whose lengths are in mm.
const MM: &str = include_str!("../../../examples/mm.jsonl");

/// Runs shell lines in a folder with both sets and the model of the first. Returns each line followed by its output.
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
        fs::write(folder.join("mm.jsonl"), MM).expect("written");
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
    shown(&["taxel model confusion figures.npz | tail -n +9"])
}

pub(crate) fn worth() -> String {
    shown(&[
        "taxel model confusion figures.npz --given na,p | grep wrong",
        "taxel model confusion figures.npz --greedy",
        "taxel model confusion figures.npz --greedy --round cg_cd=0.01",
    ])
}

pub(crate) fn peers() -> String {
    shown(&["taxel model confusion figures.npz --classifier all"])
}

pub(crate) fn sizes() -> String {
    static SIZES: OnceLock<String> = OnceLock::new();
    let sizes = || {
        shown(&["for scale in 0.577 1 1.414 2; do \
           taxel model separate figures.npz --scale $scale --csv --quiet | tail -1; done"])
    };
    SIZES.get_or_init(sizes).clone()
}

pub(crate) fn want() -> String {
    shown(&[
        "taxel model separate figures.npz --scale 0.5:3:0.1 --positions 20 --want 0.01 --quiet | tail -18",
    ])
}

pub(crate) fn mm() -> String {
    format!("\n```json\n{MM}```\n\n")
}

pub(crate) fn pitch() -> String {
    static PITCH: OnceLock<String> = OnceLock::new();
    let pitch =
        || shown(&["taxel model separate mm.jsonl --pitch 0.5:4:0.5 --positions 20 --want 0.05"]);
    PITCH.get_or_init(pitch).clone()
}

/// The numbers in the text of the page must be those that the program prints.
#[test]
fn the_numbers_in_the_text_are_those_that_the_commands_print() {
    let page = crate::docs::document("docs/recognition.md");
    let sizes = sizes();
    let errors: Vec<f64> = sizes
        .lines()
        .filter(|line| line.contains(",0.5,"))
        .map(|line| {
            let error = line.split(',').nth(2).expect("an error");
            error.parse().expect("a number")
        })
        .collect();
    let said = ["0.63", "0.33", "0.11", "0.02"];
    assert_eq!(errors.len(), said.len(), "{sizes}");
    for (error, said) in errors.iter().zip(said) {
        assert_eq!(format!("{error:.2}"), said);
        assert!(page.contains(&format!(" {said}")), "{said}");
    }
    let pitch = pitch();
    assert!(pitch.contains("is 1.4 mm: 2.0 %") && page.contains("Cells of 1.4 mm are fine enough"));
    let at_1_5 = pitch.lines().find(|line| line.starts_with("1.5 "));
    assert!(at_1_5.is_some_and(|line| line.contains(" 6.6 %")));
    assert!(page.contains("it is wrong in 6.6 %"));
    assert!(page.contains("The limit is 0.330") && format!("{:.3}", errors[1]) == "0.330");
}
