//! Tests of `taxel describe`: imprints as text, stored shapes, and messages about bad ones.

use super::library::Shelf;
use super::refused;
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
        ".##.\r\n#..#\r\n.##.\r\n\r\n",
        ".##.\n#..#\n.##.\r",
        ".##.\n#..#\n.##.\n\n  \n",
    ] {
        assert_eq!(taxel("describe -", input), expected, "{input:?}");
    }
    let shelf = Shelf::new();
    let file = shelf.file("ring.txt", ".##.\n#..#\n.##.\n");
    assert_eq!(shelf.run(&format!("describe|{file}"), ""), expected);
}

#[test]
fn a_bad_imprint_is_reported_with_line_and_column() {
    let other = "not an imprint: expected rows of '#' and '.', a table of 0 and 1 (CSV), or NPY";
    for (input, message) in [
        (
            &b"##\n#x\n"[..],
            "line 2, column 2: found 'x', expected '#' or '.'",
        ),
        (b"\x89PNG", other),
        (
            b"##\n###\n",
            "line 2: found 3 taxels, expected 2 as in the first row",
        ),
        (&b"#\n".repeat(65), "expected 1 to 64 rows of '#' and '.'"),
        (b"", "expected 1 to 64 rows of '#' and '.'"),
        (
            &b"\n".repeat(1 << 21),
            "larger than 1 MiB, the limit for an imprint or a shape",
        ),
    ] {
        let message = format!("standard input: {message}");
        refused(&taxel("describe -", input), 1, &message);
    }
}

#[test]
fn the_error_for_a_recording_names_the_command_that_reads_it() {
    for name in ["records.npy", "tekscan.asf", "topics.mcap", "plain.csv"] {
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
    let run = taxel("describe -", SHAPE);
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
}

#[test]
fn a_bad_shape_is_reported_with_line_and_column() {
    for (from, to, message) in [
        (
            "shape/1",
            "shape/2",
            "line 3, column 27: unknown value `taxel-shape/2`, expected `taxel-shape/1`",
        ),
        (
            "\"name\"",
            "\"nom\"",
            "line 4, column 7: unknown key `nom`, expected one of `format`, `name`, `sensor`, `imprint`, `source`",
        ),
        (
            "\"side\": 2",
            "\"side\": 20",
            "source: side: 20 is above 3 (allowed: above 0, up to 3)",
        ),
    ] {
        let run = taxel("describe -", SHAPE.replace(from, to));
        refused(&run, 1, &format!("standard input: {message}"));
    }
    // Text from files cannot send control characters to the terminal.
    let hostile = SHAPE.replace("corner", r"\u001b[31m\u0007\u009b");
    let run = taxel("describe -", hostile);
    let told = run.stderr.contains("cannot be in a name");
    assert!(run.status == Some(1) && told, "{}", run.stderr);
    assert!(!run.stderr.contains(['\u{1b}', '\u{7}']), "{}", run.stderr);
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    for (line, message) in [
        (
            "describe no-such-shape",
            "no stored shape or file named \"no-such-shape\"; 'taxel library list' shows all",
        ),
        (
            "describe Wsher",
            "no stored shape or file named \"Wsher\"; did you mean \"washer\"?",
        ),
        (
            "describe no/such-file",
            "no/such-file: cannot read: no such file or folder",
        ),
        ("describe .", ".: cannot read: it is a folder"),
    ] {
        refused(&taxel(line, ""), 1, message);
    }
}
