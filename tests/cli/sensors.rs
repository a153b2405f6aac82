//! Runs every line of the page about sensors that can be run here, in the order of the page.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;

const PAGE: &str = include_str!("../../docs/sensors.md");

/// Returns the contents of the fenced blocks in a language.
fn fences(language: &str) -> Vec<&'static str> {
    let start = format!("{language}\n");
    let parts = PAGE.split("```").enumerate();
    parts
        .filter(|(index, _)| index % 2 == 1)
        .filter_map(|(_, part)| part.strip_prefix(start.as_str()))
        .collect()
}

/// Returns two frames of 8 × 8 as candump prints them, one message per row.
fn candump() -> String {
    let mut text = String::new();
    for frame in 0..2 {
        for row in 0..8 {
            let values = (0..8).map(|column| format!(" {:02X}", 16 * row + column + frame + 1));
            let values: String = values.collect();
            let _ = writeln!(text, "  can0  10{row}   [8] {values}");
        }
    }
    text
}

fn furnished(folder: &Path) {
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/frames/samples");
    for name in ["plain.csv", "echo.txt", "echo.yaml", "frames.jsonl"] {
        fs::copy(samples.join(name), folder.join(name)).expect(name);
    }
    let recording = include_str!("../../examples/recording.csv");
    fs::write(folder.join("recording.csv"), recording).expect("written");
    fs::write(folder.join("candump.txt"), candump()).expect("written");
    fs::write(folder.join("rows.awk"), fences("awk")[0]).expect("written");
}

/// Reads the recording of the page with the Python lines that the page shows for it.
fn reads_by_numpy(folder: &Path) {
    if !super::python_has("numpy") {
        return;
    }
    let mut programs = fences("python").into_iter();
    let program = programs.find(|program| program.contains("numpy.load"));
    let run = Command::new("python3")
        .args(["-c", program.expect("it reads the recording")])
        .current_dir(folder)
        .output()
        .expect("Python runs");
    let said = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success() && !said.contains("nan"), "{run:?}");
}

#[test]
fn every_line_that_can_be_run_works() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    furnished(folder);
    let binary = Path::new(env!("CARGO_BIN_EXE_taxel"));
    let mut path = binary.parent().expect("a folder").as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let mut answered = 0;
    for line in fences("console").iter().flat_map(|fence| fence.lines()) {
        let line = line.strip_prefix("$ ").expect("a line begins with $");
        let run = Command::new("sh")
            .args(["-c", line])
            .current_dir(folder)
            .env("PATH", &path)
            .env("HOME", folder)
            .env("TAXEL_LIBRARY", folder.join("library"))
            .env("TAXEL_CONFIG", "/dev/null")
            .env("LC_ALL", "C.UTF-8")
            .output()
            .expect("there is a shell");
        assert!(run.status.success(), "{line}: {run:?}");
        assert!(line.contains(" > ") || !run.stdout.is_empty(), "{line}");
        if line.contains("--model") {
            let text = String::from_utf8_lossy(&run.stdout);
            let named = ["hexagon  ", "\"answer\":\"hexagon\""];
            assert!(
                named.iter().any(|name| text.contains(name)),
                "{line}: {text}"
            );
        }
        if line.contains("candump") {
            let text = String::from_utf8_lossy(&run.stdout).into_owned();
            assert_eq!(text.lines().count(), 2, "{text}");
            assert!(
                text.contains("\"max\":120") && text.contains("\"max\":121"),
                "{text}"
            );
        }
        answered += 1;
    }
    reads_by_numpy(folder);
    assert!(answered > 15, "{answered} lines");
    for file in ["mask.txt", "touch.npy", "touch.json"] {
        assert!(folder.join(file).exists(), "{file}");
    }
}
