//! Tests of `taxel describe`: imprints as text, stored shapes, and messages about bad ones.

use std::path::PathBuf;

use super::Run;
use super::library::Shelf;
use super::refused;
use super::run_in;
use super::taxel;
use super::watch::sample;

/// A shape whose source reaches beyond its sensor, on cells of 2.5 mm.
pub(super) const SHAPE: &str = r###"
{
  "format": "taxel-shape/1",
  "name": "corner",
  "sensor": { "columns": 3, "rows": 2, "pitch_mm": 2.5, "threshold": 0.5 },
  "imprint": ["##.", "#.."],
  "source": { "figure": "triangle", "side": 2, "x0": -1, "y0": 0, "angle": 0 }
}"###;

/// A temporary file for a test.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str, content: &[u8]) -> Self {
        let file = format!("taxel-cli-{}-{name}", std::process::id());
        let path = std::env::temp_dir().join(file);
        std::fs::write(&path, content).expect("the temporary folder takes files");
        Self(path)
    }

    fn describe(&self) -> Run {
        run_in("C.UTF-8", &["describe".as_ref(), self.0.as_os_str()], b"")
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

#[test]
fn an_imprint_is_described_with_any_kind_of_line_ends() {
    let expected = taxel("describe -", ".##.\n#..#\n.##.");
    assert_eq!((expected.status, expected.stderr.as_str()), (Some(0), ""));
    assert!(expected.stdout.starts_with(
        "    0   2\n 0  · ████·\n 1  ██· · ██\n 2  · ████·\n\n4 × 3 taxels, NA 6 in all\n\n"
    ));
    let na = expected.stdout.lines().find(|line| line.starts_with("NA "));
    let na: Vec<&str> = na.into_iter().flat_map(str::split_whitespace).collect();
    assert_eq!(na, ["NA", "taxels", "6", "2"]);
    for input in [
        ".##.\n#..#\n.##.\n",
        ".##.\r\n#..#\r\n.##.\r\n\r\n",
        ".##.\n#..#\n.##.\r",
        ".##.\n#..#\n.##.\n\n  \n",
    ] {
        assert_eq!(taxel("describe -", input), expected, "{input:?}");
    }
    let file = Scratch::new("ring.txt", b".##.\n#..#\n.##.\n");
    assert_eq!(file.describe(), expected);
}

#[test]
fn a_bad_imprint_is_reported_with_line_and_column() {
    let bad = |input: &[u8], message: &str| {
        refused(
            &taxel("describe -", input),
            1,
            &format!("standard input: {message}"),
        );
    };
    bad(
        b"##\n#x\n",
        "line 2, column 2: found 'x', expected '#' or '.'",
    );
    bad(
        b"##\n #\n##",
        "line 2, column 1: found ' ', expected '#' or '.'",
    );
    bad(
        "##\n.\u{e9}".as_bytes(),
        "line 2, column 2: found '\u{e9}', expected '#' or '.'",
    );
    bad(
        b"##\n#\x1b",
        "line 2, column 2: found U+001B, expected '#' or '.'",
    );
    for other in [&b"##\n.\xff"[..], b"\x89PNG"] {
        let known =
            "not an imprint: expected rows of '#' and '.', a table of 0 and 1 (CSV), PBM or NPY";
        bad(other, known);
    }
    bad(
        b"##\n###\n",
        "line 2: found 3 taxels, expected 2 as in the first row",
    );
    bad(
        b"##\n#\n",
        "line 2: found 1 taxel, expected 2 as in the first row",
    );
    bad(b"##\n\n##\n", "line 2: found 0 taxels, expected 1 to 64");
    bad(&[b'#'; 65], "line 1: found 65 taxels, expected 1 to 64");
    bad(&b"#\n".repeat(65), "expected 1 to 64 rows of '#' and '.'");
    bad(b"", "expected 1 to 64 rows of '#' and '.'");
    bad(b"\r\n\n", "expected 1 to 64 rows of '#' and '.'");
    bad(
        &b"\n".repeat(1 << 21),
        "larger than 1 MiB, the limit for an imprint or a shape",
    );
}

#[test]
fn the_error_for_a_recording_names_the_command_that_reads_it() {
    for name in [
        "records.npy",
        "u2.npy",
        "xsensor.csv",
        "tekscan.asf",
        "topics.mcap",
        "frames.jsonl",
        "plain.csv",
    ] {
        let run = taxel(&format!("describe {}", sample(name)), "");
        assert_eq!(run.status, Some(1), "{name}: {}", run.stdout);
        let hint = "; if this is a recording, use taxel frames\n";
        assert!(run.stderr.ends_with(hint), "{name}: {}", run.stderr);
    }
    for broken in ["#.\n##x\n", "{\"format\":\"taxel-shape/1\"}", ""] {
        let run = taxel("describe -", broken);
        assert!(!run.stderr.contains("recording"), "{}", run.stderr);
    }
}

#[test]
fn a_stored_shape_is_described_with_its_name_and_source() {
    let file = Scratch::new("corner.json", SHAPE.as_bytes());
    let run = file.describe();
    let expected = "
    0   2
 0  ████·
 1  ██· ·

corner
triangle side 2.00 at -1.00, 0.00, 0°
the figure reaches beyond the sensor
3 × 2 taxels of 2.5 mm, threshold 0.5, NA 3 in all

";
    assert!(run.stdout.starts_with(&expected[1..]), "{}", run.stdout);
    assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""));
    assert!(run.stdout.contains("in mm²"), "it has a pitch of its own");
    let run = taxel("describe - --pitch 4", SHAPE);
    assert!(run.stdout.contains("\n3 × 2 taxels of 4 mm, "));
    assert!(run.stdout.contains("in mm²"));
}

#[test]
fn a_bad_shape_is_reported_with_line_and_column() {
    let bad = |from: &str, to: &str, message: &str| {
        let run = taxel("describe -", SHAPE.replace(from, to));
        refused(&run, 1, &format!("standard input: {message}"));
    };
    bad(
        "shape/1",
        "shape/2",
        "line 3, column 27: unknown value `taxel-shape/2`, expected `taxel-shape/1`",
    );
    bad(
        "\"name\"",
        "\"nom\"",
        "line 4, column 7: unknown key `nom`, expected one of `format`, `name`, `sensor`, `imprint`, `source`",
    );
    bad(
        "#..",
        "#.x",
        "line 6, column 27: row 2, column 3: found 'x', expected '#' or '.'",
    );
    bad(
        "\"side\": 2",
        "\"side\": 20",
        "source: side: 20 is above 3 (allowed: above 0, up to 3)",
    );
    bad(
        "corner\"",
        "\u{1b}[31m\"",
        "line 4, column 12: control character (\\u0000-\\u001F) found while parsing a string",
    );
}

#[test]
fn text_from_files_cannot_send_control_characters_to_the_terminal() {
    let run = taxel(
        "describe -",
        SHAPE.replace("corner", r"\u001b[31m\u0007\u009b"),
    );
    assert_eq!(run.status, Some(1));
    assert!(run.stderr.contains("cannot be in a name"), "{}", run.stderr);
    assert!(
        !run.stderr.contains('\u{1b}') && !run.stderr.contains('\u{7}'),
        "{}",
        run.stderr
    );
}

#[test]
fn a_shape_can_be_described_by_its_name() {
    let shelf = Shelf::new();
    let shown = shelf.does("library|show|washer|--pitch|2", "");
    assert_eq!(shelf.does("describe|Washer|--pitch|2", ""), shown);
    shelf.does("library|save|ring|-", ".##.\n#..#\n.##.\n");
    let json = shelf.does("describe|ring|--json", "");
    assert!(json.starts_with(r##"{"imprint":[".##.","#..#",".##."],"na":6,"##));
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let run = taxel("describe no-such-shape", "");
    let message =
        "no stored shape or file named \"no-such-shape\"; to list all shapes: taxel library list";
    refused(&run, 1, message);
    let run = taxel("describe Wsher", "");
    let message = "no stored shape or file named \"Wsher\"; did you mean \"washer\"?";
    refused(&run, 1, message);
    let run = taxel("describe no/such-file", "");
    let message = "no/such-file: cannot read: no such file or folder";
    refused(&run, 1, message);
    refused(
        &taxel("describe .", ""),
        1,
        ".: cannot read: it is a folder",
    );
}

#[test]
fn the_error_for_lines_of_another_command_names_that_command() {
    let field =
        "unknown key `figure`, expected one of `format`, `name`, `sensor`, `imprint`, `source`";
    let pose = "{\"figure\":\"hexagon\",\"side\":3,\"x0\":2,\"y0\":2}\n";
    let told = |column: u32, what: &str, command: &str| {
        format!(
            "standard input: line 1, column {column}: {field}; if this is {what}, use taxel {command}"
        )
    };
    let run = taxel("describe -", pose.repeat(2));
    refused(&run, 1, &told(9, "a list of poses", "batch"));
    let shape = "{\"name\":\"disc\",\"figure\":\"ellipse\",\"radius_x\":3,\"radius_y\":3}\n";
    let run = taxel("describe -", shape);
    refused(&run, 1, &told(23, "a set of shapes", "model train"));
    // A stored shape is neither of the two, whatever it was made from.
    let run = taxel("describe -", SHAPE.replace("\"name\"", "\"nom\""));
    assert!(!run.stderr.contains("use taxel"), "{}", run.stderr);
    let run = taxel("recognise -", pose);
    let answer = "{\"error\":\"line 1: expected exactly one of the keys frame (with values), imprint, touches; if \
                  this is a list of poses, use taxel batch\"}\n";
    assert_eq!((run.status, run.stdout.as_str()), (Some(1), answer));
}
