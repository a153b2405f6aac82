//! Skips a test whose requirements are missing, and reports that it was skipped.
#![allow(dead_code, reason = "every test file uses its own part of this one")]

use std::env;
use std::fs::OpenOptions;
use std::io::Write;

/// Reports that a test, or a part of one, is skipped. `cargo test` hides the output of passing tests, so a line is
/// also added to the file that `TAXEL_SKIPS` names; `.ci/run` prints these lines at its end.
pub(crate) fn skipped(why: &str) {
    eprintln!("SKIPPED: {why}");
    if let Some(path) = env::var_os("TAXEL_SKIPS") {
        let file = OpenOptions::new().create(true).append(true).open(path);
        let mut file = file.expect("TAXEL_SKIPS names a file");
        let line = format!("{why}\n");
        file.write_all(line.as_bytes()).expect("written");
    }
}

/// Reports that a test is skipped because a program is missing. With `TAXEL_CI` set, the test fails instead: the
/// workflow installs all programs.
pub(crate) fn lacking(program: &str) {
    let must = env::var_os("TAXEL_CI").is_some_and(|set| !set.is_empty());
    assert!(!must, "there is no {program}");
    skipped(&format!("there is no {program}"));
}
