//! Tests of `taxel model separate`: the error against size and threshold, on the command line.

use super::misused;
use super::model::{COARSE, Place, keys};
use super::refused;

#[test]
fn the_error_falls_with_the_size_as_in_separate_trainings() {
    let place = Place::new();
    let line =
        "model separate rectangles.jsonl --scale 1:2:0.5 --positions 10 --angle 0:355:5 --quiet";
    let text = place.done(&format!("{line} --json"));
    assert_eq!(keys(&text), ["axis", "points"]);
    let answer = place.json(&format!("{line} --json"));
    assert_eq!(answer["axis"], "scale");
    let points = answer["points"].as_array().expect("points");
    assert_eq!(points.len(), 3);
    let point = text
        .split_once("[{")
        .and_then(|(_, rest)| rest.split_once('}'));
    let point = format!("{{{}}}", point.expect("a point").0);
    assert_eq!(
        keys(&point),
        [
            "scale",
            "threshold",
            "error",
            "touches",
            "right",
            "certain",
            "keys",
            "side"
        ]
    );
    // At 1 it equals a training of the set, at 2 a training of shapes that are twice as large.
    place.done(&format!(
        "model train rectangles.jsonl {COARSE} --out m.npz"
    ));
    place.write("twice.jsonl", "{\"name\":\"a\",\"figure\":\"rectangle\",\"length\":12,\"width\":6}\n{\"name\":\"b\",\"figure\":\"rectangle\",\"length\":12,\"width\":6.4}\n{\"name\":\"c\",\"figure\":\"rectangle\",\"length\":12.4,\"width\":6}\n{\"name\":\"d\",\"figure\":\"rectangle\",\"length\":8.4,\"width\":8.4}\n");
    place.done(&format!("model train twice.jsonl {COARSE} --out twice.npz"));
    for (file, point) in [("m.npz", &points[0]), ("twice.npz", &points[2])] {
        let limit = place.json(&format!("model confusion {file} --json"));
        for key in ["touches", "right", "certain", "keys", "error"] {
            assert_eq!(point[key], limit[key], "{file} {key}");
        }
    }
    // A model provides its shapes and its grid.
    let model = place.json("model separate m.npz --scale 1:2:0.5 --quiet --json");
    assert_eq!(model["points"], answer["points"]);
    let table = place.done(&format!("{line} --csv"));
    assert!(
        table.starts_with("scale,threshold,error,touches,right,certain,keys,side\n1,0.5,"),
        "{table}"
    );
    place.done(&format!("{line} --export m.csv"));
    assert_eq!(place.read("m.csv"), table.as_bytes());
    let shown = place.done(line);
    assert!(shown.starts_with("scale  threshold   error"), "{shown}");
    let braille = |sign: char| ('\u{2801}'..'\u{2900}').contains(&sign);
    assert!(
        shown.chars().filter(|&sign| braille(sign)).count() > 50,
        "{shown}"
    );
    place.done(&format!("{line} --export m.svg"));
    let svg = String::from_utf8(place.read("m.svg")).expect("text");
    assert!(
        svg.contains(">threshold 0.5</text>") && svg.contains(">scale</text>"),
        "{svg}"
    );
}

#[test]
fn half_the_pitch_equals_twice_the_scale() {
    let place = Place::new();
    let grid = "--positions 5 --angle 0:350:10 --quiet --json";
    let scales = place.json(&format!(
        "model separate rectangles.jsonl --scale 0.5:2:0.5 {grid}"
    ));
    let pitches = place.json(&format!(
        "model separate rectangles.jsonl --pitch 0.5:2:0.5 {grid}"
    ));
    assert_eq!(pitches["axis"], "pitch_mm");
    let find = |value: &serde_json::Value, key: &str, wanted: f64| {
        let points = value["points"].as_array().expect("points");
        let found = points
            .iter()
            .find(|point| point[key].as_f64() == Some(wanted));
        found.expect("a point")["right"].clone()
    };
    for (scale, pitch) in [(0.5, 2.0), (1.0, 1.0), (2.0, 0.5)] {
        assert_eq!(
            find(&scales, "scale", scale),
            find(&pitches, "pitch_mm", pitch)
        );
    }
}

#[test]
fn the_smallest_size_that_reaches_an_error_is_found() {
    let place = Place::new();
    let line =
        "model separate rectangles.jsonl --scale 1:3:0.5 --positions 5 --angle 0:350:10 --quiet";
    let answer = place.json(&format!("{line} --want 0.1 --json"));
    let found = &answer["want"][0];
    let scale = found["smallest"]["scale"].as_f64().expect("a scale");
    let error = found["smallest"]["error"].as_f64().expect("an error");
    assert!(error <= 0.1 && scale > 1.0, "{answer}");
    assert_eq!(found["step"].as_f64(), Some(0.05));
    // The scale before it does not reach the error.
    let before = scale - 0.05;
    let before = place.json(&format!(
        "model separate rectangles.jsonl --scale {before:.2} --positions 5 --angle 0:350:10 --quiet --json"
    ));
    assert!(
        before["points"][0]["error"].as_f64() > Some(0.1),
        "{before}"
    );
    let text = place.done(&format!("{line} --want 0.1"));
    assert!(
        text.contains(&format!(
            "the smallest scale with an error of at most 0.1 is {scale}:"
        )) && text.contains(
            "tried from the smallest on in steps of 0.5, then in steps of 0.05 just before"
        ),
        "{text}"
    );
    let text = place.done(&format!("{line} --want 0"));
    assert!(
        text.contains("no scale that was tried has an error of at most 0\n"),
        "{text}"
    );
    let table = place.done(&format!("{line} --csv"));
    let run = place.run(&format!("{line} --want 0.1 --csv"), "");
    assert_eq!(run.stdout, table);
    let said = format!("the smallest scale with an error of at most 0.1 is {scale}:");
    assert!(run.stderr.starts_with(&said), "{}", run.stderr);
    let never = place.json(&format!("{line} --want 0 --json"));
    assert!(never["want"][0]["smallest"].is_null());
    let text = place.done(&format!("{line} --want 0.9"));
    assert!(text.contains("no smaller scale was tried"), "{text}");
}

/// A finer pitch means larger shapes, so the search starts at the coarsest. A buyer must not read that a coarser pitch
/// than the one found does as well.
#[test]
fn the_answer_about_pitches_says_coarser_and_finer() {
    let place = Place::new();
    let line =
        "model separate rectangles.jsonl --pitch 0.4:1:0.2 --positions 5 --angle 0:350:10 --quiet";
    let text = place.done(&format!("{line} --want 0.1"));
    assert!(
        text.contains("the coarsest pitch with an error of at most 0.1 is 0.")
            && text.contains(" mm: ")
            && text.contains("tried from the coarsest on in steps of 0.2 mm, then in steps of 0.02 mm just before")
            && text.contains("every finer pitch that was tried reaches it, too"),
        "{text}"
    );
    let text = place.done(&format!("{line} --want 0.9"));
    assert!(
        text.contains("with an error of at most 0.9 is 1 mm: ")
            && text.contains("no coarser pitch was tried; one may reach the error as well"),
        "{text}"
    );
}

#[test]
fn every_threshold_has_its_curve() {
    let place = Place::new();
    let line = "model separate rectangles.jsonl --positions 5 --angle 0:350:10 --quiet";
    let answer = place.json(&format!("{line} --threshold 0.3:0.7:0.2 --json"));
    let thresholds = answer["points"].as_array().expect("points").iter();
    let thresholds: Vec<_> = thresholds
        .map(|point| point["threshold"].as_f64())
        .collect();
    assert_eq!(thresholds, [Some(0.3), Some(0.5), Some(0.7)]);
    let text = place.done(&format!(
        "{line} --scale 1:1.5:0.5 --threshold 0.4:0.6:0.2 --want 0.01"
    ));
    for part in [
        "\nthreshold 0.4\n",
        "\nthreshold 0.6\n",
        "threshold 0.4: ",
        "threshold 0.6: ",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
}

#[test]
fn what_differs_from_the_model_is_said() {
    let place = Place::new();
    place.done(
        "model train washer --zoom-x 0.8:1.2:0.2 --x0 8:8.6:0.3 --y0 8 --angle 0 --out zooms.npz",
    );
    let separate = "model separate zooms.npz --scale 1 --csv";
    let run = place.run(separate, "");
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    for note in [
        "the zooms of the model are left out",
        "the positions of the model are not one cell; here they are 100 × 100 in a cell",
    ] {
        assert!(run.stderr.contains(note), "{note}: {}", run.stderr);
    }
    assert_eq!(place.run(&format!("{separate} --quiet"), "").stderr, "");
}

#[test]
fn sizes_that_fit_on_no_sensor_are_omitted() {
    let place = Place::new();
    let coarse = "--positions 2 --angle 0 --quiet --json";
    let scales = |run: &super::Run| {
        let answer: serde_json::Value = serde_json::from_str(&run.stdout).expect("JSON");
        let points = answer["points"].as_array().expect("points").iter();
        let scales = points.map(|point| point["scale"].as_f64().expect("a number"));
        scales.collect::<Vec<_>>()
    };
    let too_large = "the shapes do not fit on 64 × 64 taxels in every angle";
    let run = place.run(
        &format!("model separate rectangles.jsonl --scale 7:20:2 {coarse}"),
        "",
    );
    assert_eq!((run.status, scales(&run)), (Some(0), vec![7.0, 9.0]));
    assert_eq!(
        run.stderr,
        format!("left out: scale 11 to 19: {too_large}\n")
    );
    // The finest pitch makes the largest shapes.
    let run = place.run(
        &format!("model separate rectangles.jsonl --pitch 0.05:0.25:0.2 {coarse}"),
        "",
    );
    assert_eq!((run.status, scales(&run)), (Some(0), vec![4.0]));
    assert_eq!(
        run.stderr,
        format!("left out: pitch_mm 0.05: {too_large}\n")
    );
    refused(
        &place.run(
            "model separate rectangles.jsonl --scale 19:20:1 --quiet",
            "",
        ),
        1,
        &format!("scale 19, threshold 0.5: {too_large}"),
    );
    for (range, value) in [("0:0.5:0.1", "0"), ("0.5:1.5:0.5", "1.5")] {
        let line = format!("model separate rectangles.jsonl --threshold {range} --quiet");
        let expected = format!("--threshold {value} is out of range (allowed: above 0, up to 1)");
        refused(&place.run(&line, ""), 1, &expected);
    }
    let run = place.run(
        "model separate rectangles.jsonl --pitch 0:1:0.5 --quiet",
        "",
    );
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    let only = "model separate rectangles.jsonl --threshold 0.4:0.6:0.2 --want 0.9 --positions 2 --angle 0 --quiet";
    let text = place.done(only);
    assert!(text.ends_with(" %\n  no other scale was tried\n"), "{text}");
    refused(
        &place.run("model separate figures washer --scale 1 --quiet", ""),
        1,
        "figures: a model; give one model or several shapes, not both",
    );
    misused("model separate a.npz", "the following required arguments");
    misused(
        "model separate a.npz --scale 1 --pitch 1",
        "the argument '--scale <RANGE>' cannot be used with '--pitch",
    );
}
