//! The commands and pictures of the page about drawn parts: the program runs them when the page is checked.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use crate::docs::commands::shell_in;
use crate::docs::{document, root};

/// A folder that belongs to this build.
const FOLDER: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/parts");

const TOUCH: &str =
    "taxel picture cam.svg --pitch 3 --x0 5.3 --y0 4.6 --angle 33 --export touch.svg | tail -3";
const SEPARATE: &str = "taxel model separate *.svg --pitch 1:5:0.5 --want 0.02 --positions 5 --angle 0:357:3 --quiet --export pitch.svg | grep -E 'error |×'";
const TRAIN: &str = "taxel model train *.svg --pitch 3 --positions 20 --out parts.npz --quiet";
const CONFUSION: &str = "taxel model confusion parts.npz --quiet --export confusion.svg | tail -1";
const RECOGNISE: &str = "taxel picture cam.svg --pitch 3 --x0 5.3 --y0 4.6 --angle 33 --export touch.txt > imprint.log\n$ taxel recognise touch.txt --model parts.npz --pose";

/// The five steps, in order: each line with what it prints.
fn steps() -> &'static [String; 5] {
    static STEPS: OnceLock<[String; 5]> = OnceLock::new();
    STEPS.get_or_init(|| {
        let folder = Path::new(FOLDER);
        // The folder may be left from an earlier run.
        fs::remove_dir_all(folder).ok();
        fs::create_dir_all(folder).expect("a folder can be made");
        for entry in fs::read_dir(root().join("examples/parts")).expect("the parts are there") {
            let path = entry.expect("parts can be listed").path();
            let name = path.file_name().expect("a file").to_owned();
            fs::copy(path, folder.join(name)).expect("copied");
        }
        // The drawings that a step writes are no parts of the next one.
        [TOUCH, SEPARATE, TRAIN, CONFUSION, RECOGNISE].map(|line| {
            let printed = shell_in(folder, &line.replace("\n$ ", "\n"));
            for drawn in ["touch", "pitch", "confusion"] {
                let (from, to) = (format!("{drawn}.svg"), format!("{drawn}.drawing"));
                fs::rename(folder.join(from), folder.join(to)).ok();
            }
            let printed: Vec<&str> = printed.lines().map(str::trim_end).collect();
            format!("\n```text\n$ {line}\n{}\n```\n\n", printed.join("\n"))
        })
    })
}

pub(crate) fn touch() -> String {
    steps()[0].clone()
}

pub(crate) fn separate() -> String {
    steps()[1].clone()
}

pub(crate) fn train() -> String {
    steps()[2].clone()
}

pub(crate) fn confusion() -> String {
    steps()[3].clone()
}

pub(crate) fn recognise() -> String {
    steps()[4].clone()
}

/// The pictures of the page, by file name.
pub(crate) fn svgs() -> Vec<(String, String)> {
    steps();
    let drawn = ["touch", "pitch", "confusion"].map(|name| {
        let path = Path::new(FOLDER).join(format!("{name}.drawing"));
        (
            format!("parts-{name}"),
            fs::read_to_string(path).expect("drawn"),
        )
    });
    drawn.to_vec()
}

/// The numbers in the text of the page must be those that the program prints.
#[test]
fn the_numbers_in_the_text_are_those_that_the_commands_print() {
    let page = document("docs/parts.md");
    assert!(separate().contains("is 3.2 mm: 1.5 %") && page.contains("cells of 3.2 mm"));
    let at_5 = separate();
    let at_5 = at_5.lines().find(|line| line.starts_with("5 "));
    assert!(at_5.is_some_and(|line| line.contains(" 31.3 %")) && page.contains("31.3 %"));
}
