//! Tests of `taxel batch`: the order of answers, bad lines, long lines, pauses.

use std::io::{BufRead, BufReader, Read, Write};

use super::program;
use super::refused;
use super::taxel;

/// The shortest pose; its answer follows.
pub(super) const POINT: &str = r##"{"imprint":["#"]}"##;
const POINT_ANSWER: &str = concat!(
    r##"{"imprint":["#"],"na":1,"regions":[{"kind":"exterior","na":1,"nae":1,"ce":1,"num_x":0.5,"num_y":0.5,"##,
    r##""cg":[0.5,0.5],"p":0.0,"f":0.0,"rect":{"left":0,"top":0,"right":1,"bottom":1},"cd":[0.5,0.5],"area":1,"##,
    r##""diagonals":[45.0,135.0],"side_ratio":1.0,"filling":1.0,"cg_cd":0.0,"cg_cd_direction":null}]}"##,
    "\n"
);

/// Answers the files that the README names.
#[test]
fn the_files_in_the_examples_folder_are_answered() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let poses = std::fs::read_to_string(format!("{folder}/poses.jsonl")).expect("it is there");
    let run = taxel("batch", poses.as_str());
    assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""));
    assert_eq!(run.stdout.lines().count(), poses.lines().count());
    let named = taxel(&format!("batch {folder}/poses.jsonl"), "");
    assert_eq!(named.stdout, run.stdout, "the same as a file");
    let marked = taxel("batch -", format!("\u{feff}{poses}"));
    assert_eq!(marked.stdout, run.stdout, "with a byte order mark");
    let missing = taxel("batch nothing.jsonl", "");
    let message = "nothing.jsonl: cannot read: no such file or folder";
    refused(&missing, 1, message);
    let first = run.stdout.lines().next().expect("an answer");
    let run = taxel(&format!("describe {folder}/imprint.txt --json"), "");
    assert_eq!(run.stdout.trim_end(), first, "Fig. 1, drawn and touched");
}

#[test]
fn sizes_and_pose_have_no_defaults() {
    for (line, missing) in [
        (r#"{"figure":"hexagon"}"#, "side"),
        (r#"{"figure":"hexagon","side":3,"x0":1,"y0":1}"#, "angle"),
        (r##"{"picture":["#"],"x0":1}"##, "y0"),
    ] {
        let run = taxel("batch", line);
        let answer =
            format!("{{\"error\":\"line 1: {missing}: missing, expected a number (allowed: ");
        assert!(run.stdout.starts_with(&answer), "{line}: {run:?}");
    }
    let picture = |zooms: &str| {
        let line = format!("{{\"picture\":[\"#\"],\"x0\":1,\"y0\":1,\"angle\":0{zooms}}}");
        taxel("batch", line)
    };
    assert_eq!(picture(""), picture(",\"zoom_x\":1,\"zoom_y\":1"));
}

#[test]
fn bad_lines_are_answered_in_their_places() {
    let lines: [&[u8]; 10] = [
        POINT.as_bytes(),
        b"nonsense",
        b"  \r",
        b"{\"figure\":\"hexagon\",\"side\":99,\"x0\":2,\"y0\":2,\"angle\":0}",
        b"{\"picture\":\"gasket\",\"x0\":2,\"y0\":2,\"angle\":0}",
        b"{\"figure\":\"\xff\"}",
        b"{\"figure\":\"\\u001b\xc3\xa9\"}",
        b"{\"imprint\":[\"##\",\"#\"]}",
        b"{\"figure\":\"hexagon\",\"sied\":3}",
        POINT.as_bytes(),
    ];
    let run = taxel("batch", lines.join(&b'\n'));
    let error = |message: &str| format!("{{\"error\":\"line {message}\"}}\n");
    let expected = [
        POINT_ANSWER.to_owned(),
        error("2: not a JSON object"),
        error("4: side: 99 is above 16 (allowed: above 0, up to 16)"),
        error("5: picture: no shape named \\\"gasket\\\""),
        error("6: column 12: invalid unicode code point"),
        error(
            "7: column 21: figure \\\"\\\\u{1b}\\u00e9\\\" is unknown, expected one of ellipse, rectangle, triangle, pentagon, hexagon, heptagon, octagon",
        ),
        error("8: column 22: row 2: found 1 taxel, expected 2 as in the first row"),
        error("9: column 26: unknown key \\\"sied\\\"; did you mean \\\"side\\\"?"),
        POINT_ANSWER.to_owned(),
    ];
    assert_eq!(run.stdout, expected.concat());
    assert_eq!(run.stderr, "error: 7 of 9 lines could not be answered\n");
    assert_eq!(run.status, Some(1));
}

#[test]
fn a_line_that_is_too_long_is_refused_and_skipped() {
    let mebibyte = 1 << 20;
    let padded = |length: usize| format!("{}{POINT}", " ".repeat(length - POINT.len()));
    let input = [
        padded(mebibyte),
        padded(mebibyte + 1),
        "x".repeat(2 * mebibyte),
        POINT.to_owned(),
    ];
    let run = taxel("batch", input.join("\n"));
    let long = |line: usize| {
        format!("{{\"error\":\"line {line}: longer than 1 MiB, the limit for a pose\"}}\n")
    };
    let expected = [
        POINT_ANSWER.to_owned(),
        long(2),
        long(3),
        POINT_ANSWER.to_owned(),
    ];
    assert_eq!(run.stdout, expected.concat());
    assert_eq!(run.status, Some(1));
    let run = taxel("batch", "x".repeat(2 * mebibyte));
    assert_eq!(run.stdout, long(1));
}

#[test]
fn the_sensor_of_a_batch_is_set_by_flags_and_lines() {
    let pose = r#"{"figure":"rectangle","length":1,"width":1,"x0":0,"y0":0.25,"angle":0"#;
    let input =
        format!("{pose}}}\n{pose},\"sensor\":{{\"rows\":2,\"threshold\":0.25}}}}\n{pose}}}\n");
    let run = taxel("batch --columns 1 --rows 1 --threshold 0.75", input);
    let rows: Vec<&str> = run
        .stdout
        .lines()
        .filter_map(|line| line.get(..21))
        .collect();
    assert_eq!(
        rows,
        [
            r##"{"imprint":["#"],"na""##,
            r##"{"imprint":["#","#"],"##,
            r##"{"imprint":["#"],"na""##
        ]
    );
}

/// However many threads there are, and wherever blocks of lines end.
#[test]
fn answers_do_not_depend_on_threads() {
    let mut lines = String::new();
    for number in 0..3000 {
        let pad = " ".repeat(number % 97);
        lines += &match number % 500 {
            7 => format!("{pad}nonsense\n"),
            8 => format!("{pad}\n"),
            _ => format!("{pad}{POINT}\n"),
        };
    }
    let one = taxel("batch --jobs 1", lines.as_str());
    assert_eq!(one.stdout.lines().count(), 3000 - 6);
    let bad = one.stdout.lines().nth(507 - 1).expect("an answer");
    assert_eq!(bad, "{\"error\":\"line 508: not a JSON object\"}");
    assert_eq!(
        one.stderr,
        "error: 6 of 2,994 lines could not be answered\n"
    );
    for jobs in [2, 3, 16] {
        let run = taxel(&format!("batch --jobs {jobs}"), lines.as_str());
        assert!(run == one, "{jobs} threads");
    }
    assert_eq!(taxel("batch", " \r\n\t\n").stdout, "");
}

#[test]
fn an_answer_does_not_wait_for_the_next_line() {
    let mut child = program(&["batch"], "C")
        .spawn()
        .expect("the program starts");
    let mut stdin = child.stdin.take().expect("piped");
    let mut stdout = BufReader::new(child.stdout.take().expect("piped"));
    // The second pose arrives in two pieces, the first one together with the first pose.
    let (begin, end) = POINT.split_at(5);
    for (sent, expected) in [
        (format!("{POINT}\n{begin}"), POINT_ANSWER),
        (format!("{end}\n"), POINT_ANSWER),
    ] {
        stdin.write_all(sent.as_bytes()).expect("the program reads");
        let mut answer = String::new();
        stdout.read_line(&mut answer).expect("the program answers");
        assert_eq!(answer, expected);
    }
    drop(stdin);
    assert_eq!(stdout.read_to_end(&mut Vec::new()).expect("the end"), 0);
    assert_eq!(child.wait().expect("the program ends").code(), Some(0));
}

/// A frame of a real sensor's values, with the rule for its imprint.
#[test]
fn a_frame_with_a_threshold_is_described() {
    let input = concat!(
        "{\"frame\":[[0,30],[null,31]],\"at_least\":30}\n",
        "{\"frame\":[[0,30],[null,31]]}\n",
        "{\"frame\":[[0,30]],\"at_least\":30,\"imprint\":[\"#\"]}\n",
        "{\"frame\":[[0,30]],\"at_least\":30,\"least\":4096}\n",
    );
    let run = taxel("batch", input);
    for (line, answer) in run.stdout.lines().zip([
        "{\"imprint\":[\".#\",\".#\"],\"na\":2,",
        "no threshold, expected at_least",
        "expected exactly one of the keys",
        "{\"imprint\":[\"..\"],\"na\":0,",
    ]) {
        assert!(line.contains(answer), "{line}");
    }
    assert_eq!(run.stdout.lines().count(), 4);
}

/// Python writes `NaN`, although JSON has no such number.
#[test]
fn nan_in_a_frame_is_a_missing_cell() {
    let frame = |cell: &str| format!("{{\"frame\":[[0,{cell},9]],\"percent\":50}}\n");
    let run = taxel("batch", frame("NaN"));
    assert_eq!(run, taxel("batch", frame("null")));
    assert_eq!(run.status, Some(0), "{}", run.stdout);
    let run = taxel("batch", "{\"frame\":[[NaN]],x}");
    assert!(
        run.stdout.contains("line 1: key must be a string"),
        "{}",
        run.stdout
    );
    let run = taxel("batch", "x\n");
    assert_eq!(run.stderr, "error: 1 of 1 line could not be answered\n");
}
