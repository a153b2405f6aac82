//! Tests of outlines on the command line: from drawings, stored, swept, trained, and in mm.

use serde_json::{Value, json};

use super::model::Place;

/// A plate with a square hole beside a disc, 14.5 mm × 10 mm, a stroke and a text.
const PLATE: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="15mm" height="10mm" viewBox="0 0 150 100">
<path fill-rule="evenodd" d="M0 0H100V100H0Z M20 20V50H50V20Z"/>
<circle cx="125" cy="50" r="20"/>
<path d="M0 0L150 100" fill="none" stroke="black"/>
<text x="10" y="20">plate</text>
</svg>
"#;

/// A wedge, y up.
const WEDGE: &str = "x,y\n0,0\n15,0\n0,10\n";

const COARSE: &str = "--positions 5 --angle 0:350:10 --quiet";

fn place() -> Place {
    let place = Place::new();
    place.write("plate.svg", PLATE);
    place.write("wedge.csv", WEDGE);
    place.write(
        "line.svg",
        "<svg xmlns=\"http://www.w3.org/2000/svg\"><path d=\"M0 0L9 9\"/></svg>",
    );
    place
}

#[test]
fn outlines_stand_wherever_a_stored_shape_may() {
    let place = place();
    let train =
        format!("model train plate.svg wedge.csv --unit mm --pitch 2.5 {COARSE} --out m.npz");
    let separate = format!("model separate plate.svg wedge.csv --unit mm --pitch 2:4:1 {COARSE}");
    let lines = [
        "picture plate.svg --pitch 2.5 --x0 5 --y0 3 --angle 10",
        "picture wedge.csv --unit mm --y-up --pitch 2.5 --save wedge",
        "picture wedge --pitch 1.25 --x0 2 --json",
        "library import plate.svg --name plate --pitch 2.5",
        "export plate drawn.svg",
        &train,
        "model show m.npz",
        "recognise plate --model m.npz",
        "recognise plate",
        &separate,
    ];
    let file = |name: &str| std::fs::read_to_string(place.path(name)).expect("written");
    let mut text = place.transcript("", &lines) + &file("library/plate.json");
    text.extend(
        file("drawn.svg")
            .lines()
            .filter(|line| line.contains("class=\"outline\"")),
    );
    insta::assert_snapshot!("outlines", text.replace("taxel  ", "taxel "));
}

#[test]
fn the_same_part_is_the_same_for_every_command() {
    let place = place();
    place.done("library import plate.svg --name plate --pitch 2.5");
    let line = json!({
        "name": "plate", "unit": "mm",
        "outline": [
            [[0, 0], [10, 0], [10, 10], [0, 10]],
            [[2, 2], [5, 2], [5, 5], [2, 5]],
            {"cx": 12.5, "cy": 5, "rx": 2, "ry": 2},
        ],
    });
    place.write("plate.jsonl", &line.to_string());
    // A touch.
    let pose = "--x0 5 --y0 3 --angle 10";
    let touched = place.done(&format!("picture plate.svg --pitch 2.5 {pose} --json"));
    assert_eq!(place.done(&format!("picture plate {pose} --json")), touched);
    let mut posed = line.clone();
    for (key, value) in [("x0", 5), ("y0", 3), ("angle", 10)] {
        posed[key] = value.into();
    }
    let _ = posed.as_object_mut().map(|keys| keys.remove("name"));
    assert_eq!(
        place.run("batch --pitch 2.5", &posed.to_string()).stdout,
        touched
    );
    posed["sensor"] = json!({"pitch_mm": 2.5});
    assert_eq!(place.run("batch", &posed.to_string()).stdout, touched);
    let stored = r#"{"picture":"plate","x0":5,"y0":3,"angle":10}"#;
    assert_eq!(place.run("batch", stored).stdout, touched);
    // A sweep.
    let sweep = "--x0 5:5.8:0.2 --y0 4 --angle 0:350:10 --pitch 3 --quiet --json";
    let distinct = |what: &str| -> Value {
        let mut swept = place.json(&format!("sweep --picture {what} {sweep}"));
        swept["seconds"].take();
        swept
    };
    assert_eq!(distinct("plate"), distinct("plate.svg"));
    // A training, and the same pitch of a separation.
    let card = |what: &str| {
        let card = place.json(&format!(
            "model train {what} wedge.csv --unit mm --pitch 3 {COARSE} --out {what}.npz --json"
        ));
        json!({"right": card["right"], "touches": card["touches"], "keys": card["keys"]})
    };
    let trained = card("plate.svg");
    assert_eq!(card("plate.jsonl"), trained);
    assert_eq!(card("plate"), trained);
    let separated = place.json(&format!(
        "model separate plate.jsonl wedge.csv --unit mm --pitch 3 {COARSE} --json"
    ));
    for key in ["right", "touches", "keys"] {
        assert_eq!(
            separated["points"][0][key], trained[key],
            "{key}: {separated}"
        );
    }
}

#[test]
fn outlines_that_cannot_be_used_are_refused() {
    let place = place();
    place.done("library import plate.svg --name plate --pitch 2.5");
    let lines = [
        "picture plate.svg",
        "picture plate.svg --pitch 0.5",
        "picture line.svg",
        "describe plate.svg",
        "sweep rectangle --unit mm",
        "library import plate.svg --name plate --pitch 2.5",
        "library import washer --name washer2",
        "model train parts.jsonl --unit mm --out x.npz",
        "model train plate.svg --pitch 0.2 --out x.npz",
        "model separate parts.jsonl plate.svg --scale 1:2:1",
        "picture plate.svg --mm-per-unit 0",
    ];
    let text = place.transcript("", &lines);
    insta::assert_snapshot!("outlines_refused", text.replace("taxel  ", "taxel "));
}
