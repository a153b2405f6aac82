//! Tests of `taxel figure`: the paper's worked example, flags, ranges, usage.

use super::RING;
use super::library::Shelf;
use super::misused;
use super::refused;
use super::taxel;

#[test]
fn the_papers_example_is_shown_as_matrix_and_table() {
    let run = taxel(RING, "");
    assert_eq!(run.stdout, include_str!("ring.txt"));
    assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""));
}

#[test]
fn with_a_pitch_lengths_and_areas_are_also_in_mm() {
    let run = taxel(&format!("{RING} --pitch 2.5 --ascii"), "");
    assert_eq!(run.stdout, include_str!("ring-ascii-mm.txt"));
    assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""));
}

#[test]
fn the_papers_example_is_the_same_line_of_json_from_every_command() {
    let expected = include_str!("ring.json");
    let run = taxel(&format!("{RING} --json"), "");
    assert_eq!((run.status, run.stdout.as_str()), (Some(0), expected));
    let pose = r#"{"figure":"ellipse","radius_x":4,"radius_y":4,"x0":1.99,"y0":1.47,"angle":0,"thickness":2}"#;
    assert_eq!(taxel("batch", pose).stdout, expected);
    let rows = expected
        .split('"')
        .filter(|text| text.contains(['.', '#']) && text.len() == 16);
    let text = rows.collect::<Vec<_>>().join("\n");
    assert_eq!(taxel("describe - --json", text).stdout, expected);
}

#[test]
fn missing_sizes_and_positions_have_defaults() {
    let line = |line: &str| taxel(line, "").stdout.lines().nth(18).map(str::to_owned);
    let made = |text: &str| Some(text.to_owned());
    assert_eq!(
        line("figure ellipse"),
        made("ellipse rx 4.00 ry 4.00 at 4.00, 4.00, 0°")
    );
    assert_eq!(
        line("figure rectangle"),
        made("rectangle length 6.00 width 3.00 at 4.00, 4.00, 0°")
    );
    assert_eq!(
        line("figure octagon --angle 7.25"),
        made("octagon side 4.00 at 4.00, 4.00, 7.25°")
    );
}

#[test]
fn numbers_may_be_negative_and_figures_reach_beyond_the_sensor() {
    for x0 in ["-0.8", "-.8", "-8e-1"] {
        let run = taxel(
            &format!("figure hexagon --x0 {x0} --y0 3 --columns 3 --rows 2"),
            "",
        );
        let expected = "
    0   2
 0  · · ·
 1  · · ·

hexagon side 3.00 at -0.80, 3.00, 0°
the figure reaches beyond the sensor
3 × 2 taxels, threshold 0.5, NA 0 in all

no active taxels, so no regions to describe
";
        assert_eq!(run.stdout, expected[1..], "{x0}");
        assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""));
    }
    // An answer without a place for it is followed by a note.
    let figure = "figure hexagon --x0 -0.8 --y0 3 --columns 3 --rows 2";
    let answers = [
        (
            "--json",
            "{\"imprint\":[\"...\",\"...\"],\"na\":0,\"regions\":[]}\n",
        ),
        ("--export - --format txt", "...\n...\n"),
    ];
    for (form, answer) in answers {
        let run = taxel(&format!("{figure} {form}"), "");
        let note = "the figure reaches beyond the sensor\n";
        assert_eq!(
            (run.status, &*run.stdout, &*run.stderr),
            (Some(0), answer, note)
        );
    }
}

#[test]
fn wrong_usage_exits_with_status_2() {
    misused("figur", "unrecognized subcommand 'figur'\n");
    misused(
        "figure",
        "the following required arguments were not provided:\n  <KIND>\n\n  \
         tip: KIND is ellipse, rectangle, triangle, pentagon, hexagon, heptagon or octagon\n\nUsage: ",
    );
    misused(
        "figure blob",
        "invalid value 'blob' for '<KIND>'\n  [possible values: ellipse, ",
    );
    misused(
        "figure ellipse --side 3",
        "'--side' does not belong to 'ellipse', which takes --radius-x, --radius-y, --x0, --y0, --angle and --thickness\n\nUsage: taxel figure ",
    );
    misused(
        "figure hexagon --side",
        "a value is required for '--side <CELLS>'",
    );
    misused(
        "figure hexagon --side 1 --side 2",
        "the argument '--side <CELLS>' cannot be used multiple times\n",
    );
    for text in ["three", "nan", "inf", "--json", "0x3"] {
        misused(
            &format!("figure hexagon --side {text}"),
            &format!("invalid value '{text}' for '--side <CELLS>': not a number\n"),
        );
    }
    misused(
        "figure hexagon --side 3,5",
        "invalid value '3,5' for '--side <CELLS>': not a number; write 3.5\n",
    );
    misused("describe", "the following required arguments");
    misused("describe one two", "unexpected argument 'two' found\n");
    misused(
        "frames touch.csv -- --peak",
        "unexpected argument '--peak' found\n",
    );
    misused(
        "--columns 3 figure hexagon",
        "'--columns' must come after 'figure'; before it, it is a flag of the screen\n",
    );
}

#[test]
fn a_flag_that_a_command_does_not_have_is_refused() {
    for (line, message) in [
        (
            "figure hexagon --zoom-x 2",
            "unexpected argument '--zoom-x' found\n",
        ),
        (
            "recognise - --at-least 3",
            "unexpected argument '--at-least' found\n",
        ),
        (
            "library --json list",
            "unexpected argument '--json' found\n\n  tip: 'list --json' exists\n",
        ),
        (
            "picture washer --columnss 3",
            "unexpected argument '--columnss' found\n\n  tip: a similar argument exists: '--columns'\n",
        ),
    ] {
        misused(line, message);
    }
}

#[test]
fn a_word_that_is_not_a_figure_is_refused_with_a_tip() {
    let shelf = Shelf::new();
    shelf.does("library|save|my ring|washer", "");
    let tip = |line: &str| {
        let run = shelf.run(line, "");
        assert_eq!((run.status, run.stdout.as_str()), (Some(2), ""), "{line}");
        let mut tips = run
            .stderr
            .lines()
            .filter_map(|line| line.trim().strip_prefix("tip: "));
        let tip = tips.next().map(str::to_owned);
        assert_eq!(tips.next(), None, "{line}");
        tip
    };
    for (line, expected) in [
        (
            "figure|circle",
            Some("a circle is an ellipse with equal radii"),
        ),
        (
            "sweep|Square",
            Some("a square is a rectangle with equal sides"),
        ),
        (
            "figure|washer",
            Some("for a stored shape, use taxel picture washer"),
        ),
        (
            "figure|my ring|--json",
            Some("for a stored shape, use taxel picture 'my ring'"),
        ),
        (
            "figure|blob",
            Some("for a stored shape, use taxel picture blob"),
        ),
        ("figure|hexagn", Some("a similar value exists: 'hexagon'")),
        (
            "sweep|washer",
            Some("for a stored shape, use --picture washer"),
        ),
    ] {
        assert_eq!(tip(line).as_deref(), expected, "{line}");
    }
    for (line, message) in [
        (
            "describe|hexagon",
            "no stored shape or file named \"hexagon\"; \"hexagon\" is a figure, which taxel figure and taxel sweep take",
        ),
        (
            "model|train|hexagon|--out|no.npz",
            "no shape named \"hexagon\"; \"hexagon\" is a figure: a file of lines may have {\"name\":\"hexagon\",\"figure\":\"hexagon\",\"side\":4}",
        ),
    ] {
        refused(&shelf.run(line, ""), 1, message);
    }
    let out = shelf.file("hexagon.npz", "");
    let shape = shelf.file(
        "set.jsonl",
        "{\"name\":\"hexagon\",\"figure\":\"hexagon\",\"side\":4}\n",
    );
    let shape = format!("{shape}|--x0|7|--y0|7|--angle|0");
    shelf.does(
        &format!("model|train|washer|{shape}|--out|{out}|--force|--quiet"),
        "",
    );
}

#[test]
fn a_number_out_of_range_exits_with_status_1_and_names_the_range() {
    let out = |line: &str, message: &str| refused(&taxel(line, ""), 1, message);
    out(
        "figure hexagon --side 99",
        "--side 99 is above 16 (allowed: above 0, up to 16)",
    );
    out(
        "figure hexagon --side 0",
        "--side 0 is not above 0 (allowed: above 0, up to 16)",
    );
    out(
        "figure hexagon --side 17 --rows 8",
        "--side 17 is above 16 (allowed: above 0, up to 16)",
    );
    out(
        "figure ellipse --angle 360",
        "--angle 360 is not below 360 (allowed: 0 to below 360)",
    );
    out(
        "figure ellipse --x0 -16.5",
        "--x0 -16.5 is below -16 (allowed: -16 to 16)",
    );
    out(
        "figure ellipse --columns 1e3",
        "--columns 1e3 is above 64 (allowed: 1 to 64)",
    );
    out(
        "batch --columns 2.5",
        "--columns 2.5 is not a whole number (allowed: 1 to 64)",
    );
    out(
        "describe - --pitch -1 --json",
        "--pitch -1 is not above 0 (allowed: above 0, up to 1000)",
    );
    out(
        "--threshold 0",
        "--threshold 0 is not above 0 (allowed: above 0, up to 1)",
    );
    assert_eq!(
        taxel("figure hexagon --side 20 --columns 32", "").status,
        Some(0)
    );
}
