//! Tests of `taxel model separate`: the error against size and threshold, on the command line.

use serde_json::Value;

use super::model::Place;

#[test]
fn sizes_are_answered_in_every_form() {
    let place = Place::new();
    let sizes = "rectangles.jsonl --positions 5 --angle 0:350:10 --quiet";
    let lines = [
        format!("{sizes} --scale 1:3:0.5 --want 0.1"),
        format!("{sizes} --scale 1:3:0.5 --want 0.9"),
        format!("{sizes} --scale 1 --want 0.9"),
        format!("{sizes} --pitch 0.4:1:0.2 --want 0.1 --export m.svg"),
        format!("{sizes} --pitch 0.4:1:0.2 --want 0 --json"),
        format!("{sizes} --scale 1:1.5:0.5 --threshold 0.4 --want 0.2 --ascii"),
    ];
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    insta::assert_snapshot!("separate", place.transcript("model separate", &lines));
    let svg = std::fs::read_to_string(place.path("m.svg")).expect("written");
    for part in [
        ">threshold 0.5</text>",
        ">wanted 0.1</text>",
        ">pitch / mm</text>",
    ] {
        assert!(svg.contains(part), "{part}: {svg}");
    }
}

#[test]
fn a_model_provides_its_shapes_and_its_grid() {
    let place = Place::with_model();
    let points =
        |line: &str| place.json(&format!("model separate {line} --quiet --json"))["points"].take();
    let grid = "--positions 10 --angle 0:355:5";
    let scales = points(&format!("rectangles.jsonl --scale 1:2:0.5 {grid}"));
    assert_eq!(points("m.npz --scale 1:2:0.5"), scales);
    // Half the pitch equals twice the scale.
    let pitches = points(&format!("r --pitch 0.5:1:0.5 {grid}"));
    for key in ["scale", "right", "certain"] {
        assert_eq!(pitches[1][key], scales[2][key], "{key}");
    }
}

#[test]
fn sizes_that_fit_on_no_sensor_are_omitted() {
    let place = Place::new();
    let coarse = "--positions 2 --angle 0 --quiet --json";
    let large = "the shapes do not fit on 64 × 64 taxels in every angle";
    for (range, scales, left_out) in [
        ("--scale 7:20:2", vec![7.0, 9.0], "scale 11 to 19"),
        // The finest pitch makes the largest shapes.
        ("--pitch 0.05:0.25:0.2", vec![4.0], "pitch_mm 0.05"),
    ] {
        let run = place.run(
            &format!("model separate rectangles.jsonl {range} {coarse}"),
            "",
        );
        let answer: Value = serde_json::from_str(&run.stdout).expect("JSON");
        let points = answer["points"].as_array().expect("points").iter();
        let found: Vec<_> = points.filter_map(|point| point["scale"].as_f64()).collect();
        assert_eq!((run.status, found), (Some(0), scales));
        assert_eq!(run.stderr, format!("left out: {left_out}: {large}\n"));
    }
    let lines = [
        "rectangles.jsonl --scale 19:20:1",
        "rectangles.jsonl --scale 1 --threshold 1.5",
        "rectangles.jsonl --pitch 0:1:0.5",
        "figures washer --scale 1",
        "rectangles.jsonl",
        "rectangles.jsonl --scale 1 --pitch 1",
    ];
    insta::assert_snapshot!("sizes_refused", place.transcript("model separate", &lines));
}
