//! Runs the programs of `examples/python` if Python has the required modules. With `TAXEL_NUMPY` set, it must have
//! them.

use std::process::Command;

use super::python_has;
use super::skip::skipped;

/// Runs an example, if Python has these modules, and returns what it prints.
fn output_of(name: &str, modules: &str, arguments: &[&str]) -> Option<String> {
    if !python_has(modules) {
        return None;
    }
    let path = format!("{}/examples/python/{name}", env!("CARGO_MANIFEST_DIR"));
    let output = Command::new("python3")
        .arg(path)
        .args(arguments)
        .env("TAXEL", env!("CARGO_BIN_EXE_taxel"))
        .env("TAXEL_CONFIG", "/dev/null")
        .env("PYTHONIOENCODING", "utf-8")
        .output()
        .expect("it was found before");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {said}");
    Some(String::from_utf8(output.stdout).expect("text"))
}

#[test]
fn an_atlas_is_read_as_arrays() {
    let Some(printed) = output_of("atlas.py", "numpy", &[]) else {
        return;
    };
    for line in [
        "406 imprints in 24000 poses, an array of (406, 16, 16)",
        "active taxels: 23.03 ± 1.06; the continuous hexagon covers 23.38 cells",
        "poses: an array of (60, 20, 20); at 17 degrees 80 imprints",
    ] {
        assert!(printed.contains(line), "{line:?} in\n{printed}");
    }
}

#[test]
fn no_classifier_passes_the_limit() {
    let Some(printed) = output_of("classifier.py", "numpy, sklearn", &[]) else {
        return;
    };
    let number = |start: &str| -> f64 {
        let line = printed.lines().find_map(|line| line.strip_prefix(start));
        let number = line.and_then(|rest| rest.split_whitespace().next());
        number.expect("a line").parse().expect("a number")
    };
    let descriptors = number("the limit of any method that knows these descriptors:");
    let imprint = number("the limit of any method that knows the imprint:");
    let tree = number("a decision tree that learns all touches, on the same touches:");
    assert!(imprint < descriptors && descriptors <= tree, "{printed}");
}

#[test]
fn live_frames_are_named() {
    let Some(printed) = output_of("live.py", "json", &[]) else {
        return;
    };
    for name in ["disc", "bar"] {
        let end = format!(": {name} (certain)\n");
        assert_eq!(printed.matches(&end).count(), 12, "{printed}");
    }
    assert!(printed.starts_with("frame 0: no contact\n"), "{printed}");
    // This recording begins and ends without contact.
    let recording = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/recording.csv");
    let Some(printed) = output_of("live.py", "json", &[recording]) else {
        return;
    };
    assert!(
        printed.contains(": no contact\n") && printed.contains(" taxels at "),
        "{printed}"
    );
}

#[test]
fn real_footsteps_are_named() {
    let recording = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../shared/reference/data/pressuRe/fscan_testL.asf"
    );
    if !std::path::Path::new(recording).exists() {
        skipped(&format!(
            "there is no recording of an insole at {recording}"
        ));
        return;
    }
    let Some(printed) = output_of("footsteps.py", "json", &[recording]) else {
        return;
    };
    // The recording is of a left foot. Each step begins with the heel, then the whole foot follows, then the ball.
    let steps = printed
        .matches(": left heel, left whole, left ball")
        .count();
    let last = printed.lines().last().expect("a line");
    let left: u32 = last
        .split(' ')
        .next()
        .expect("a word")
        .parse()
        .expect("a number");
    assert!(
        steps == 5 && left >= 95 && last.contains(" of 102 frames"),
        "{printed}"
    );
}
