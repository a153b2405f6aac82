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
    // With a pitch, lengths and areas are also in mm.
    let run = taxel(&format!("{RING} --pitch 2.5 --ascii"), "");
    assert_eq!(run.stdout, include_str!("ring-ascii-mm.txt"));
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
    for (line, made) in [
        (
            "figure ellipse",
            "ellipse rx 4.00 ry 4.00 at 4.00, 4.00, 0°",
        ),
        (
            "figure rectangle",
            "rectangle length 6.00 width 3.00 at 4.00, 4.00, 0°",
        ),
        (
            "figure octagon --angle 7.25",
            "octagon side 4.00 at 4.00, 4.00, 7.25°",
        ),
    ] {
        assert_eq!(taxel(line, "").stdout.lines().nth(18), Some(made));
    }
}

#[test]
fn numbers_may_be_negative_and_figures_reach_beyond_the_sensor() {
    let figure = "figure hexagon --x0 -8e-1 --y0 3 --columns 3 --rows 2";
    let expected = "
    0   2
 0  · · ·
 1  · · ·

hexagon side 3.00 at -0.80, 3.00, 0°
the figure reaches beyond the sensor
3 × 2 taxels, threshold 0.5, NA 0 in all

no active taxels, so no regions to describe
";
    // An answer without a place for it is followed by a note.
    let note = "the figure reaches beyond the sensor\n";
    for (form, answer, notes) in [
        ("", &expected[1..], ""),
        (
            "--json",
            "{\"imprint\":[\"...\",\"...\"],\"na\":0,\"regions\":[]}\n",
            note,
        ),
    ] {
        let run = taxel(&format!("{figure} {form}"), "");
        assert_eq!(
            (run.status, &*run.stdout, &*run.stderr),
            (Some(0), answer, notes)
        );
    }
}

#[test]
fn wrong_usage_exits_with_status_2() {
    for (line, message) in [
        ("figur", "unrecognized subcommand 'figur'\n"),
        (
            "figure",
            "the following required arguments were not provided:\n  <KIND>\n",
        ),
        (
            "figure blob",
            "invalid value 'blob' for '<KIND>'\n  [possible values: ellipse, ",
        ),
        (
            "figure ellipse --side 3",
            "'--side' does not belong to 'ellipse', which takes --radius-x, --radius-y, --x0, --y0, --angle and --thickness\n",
        ),
        (
            "figure hexagon --side nan",
            "invalid value 'nan' for '--side <CELLS>': not a number\n",
        ),
        (
            "figure hexagon --side 3,5",
            "invalid value '3,5' for '--side <CELLS>': not a number; write 3.5\n",
        ),
        (
            "--columns 3 figure hexagon",
            "'--columns' before 'figure' is only for the screen\n",
        ),
    ] {
        misused(line, message);
    }
}

#[test]
fn a_word_that_is_not_a_figure_is_refused_with_a_tip() {
    let shelf = Shelf::new();
    for (line, tip) in [
        ("figure|circle", "a circle is an ellipse with equal radii"),
        ("figure|hexagn", "a similar value exists: 'hexagon'"),
    ] {
        let run = shelf.run(line, "");
        let told = run.stderr.contains(&format!("tip: {tip}\n"));
        assert!(run.status == Some(2) && told, "{line}: {}", run.stderr);
    }
    for line in ["describe|hexagon", "model|train|hexagon|--out|no.npz"] {
        let message = "no stored shape or file named \"hexagon\"; \"hexagon\" is a figure, which taxel figure and taxel sweep take";
        refused(&shelf.run(line, ""), 1, message);
    }
}

#[test]
fn a_number_out_of_range_exits_with_status_1_and_names_the_range() {
    for (line, message) in [
        (
            "figure hexagon --side 99",
            "--side 99 is above 16 (allowed: above 0, up to 16)",
        ),
        (
            "figure ellipse --angle 360",
            "--angle 360 is not below 360 (allowed: 0 to below 360)",
        ),
        (
            "batch --columns 2.5",
            "--columns 2.5 is not a whole number (allowed: 1 to 64)",
        ),
        (
            "describe - --pitch -1 --json",
            "--pitch -1 is not above 0 (allowed: above 0, up to 1000)",
        ),
        (
            "--threshold 0",
            "--threshold 0 is not above 0 (allowed: above 0, up to 1)",
        ),
    ] {
        refused(&taxel(line, ""), 1, message);
    }
    let large = taxel("figure hexagon --side 20 --columns 32", "");
    assert_eq!(large.status, Some(0));
}
