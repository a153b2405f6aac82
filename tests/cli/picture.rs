//! Tests of `taxel picture`: shapes of the library and of files, moved; named pictures in a batch.

use super::library::Shelf;

#[test]
fn without_flags_a_picture_is_the_shape_itself() {
    let shelf = Shelf::new();
    for name in taxel_files::storage::shipped::names() {
        let shown = shelf.does(&format!("describe|{name}|--json"), "");
        let touched = shelf.does(&format!("picture|{name}|--json"), "");
        assert_eq!(shown, touched, "{name}");
    }
    let text = shelf.does("picture|washer", "");
    assert!(text.contains("\npicture of washer at 2.00, 2.00, 0°, zoom 1.00 × 1.00\n16 × 16 taxels, threshold 0.5, NA 36 in all\n"), "{text}");
}

#[test]
fn picture_and_batch_give_the_same_answer_for_a_pose() {
    let shelf = Shelf::new();
    let json = shelf.run(
        "picture|key|--x0|3.5|--y0|-1|--angle|30|--zoom-x|0.8|--zoom-y|1.25|--columns|20|--threshold|0.4|--json",
        "",
    );
    let pose = r#"{"picture":"KEY","x0":3.5,"y0":-1,"angle":30,"zoom_x":0.8,"zoom_y":1.25}"#;
    let line = "batch|--columns|20|--threshold|0.4";
    let answer = shelf.does(line, &format!("{pose}\n{pose}"));
    assert_eq!(answer, json.stdout.repeat(2));
    assert_eq!(json.stderr, "the picture reaches beyond the sensor\n");
}

#[test]
fn the_sensor_is_the_shapes_own_or_large_enough() {
    let shelf = Shelf::new();
    let save = "figure|hexagon|--columns|20|--rows|12|--threshold|0.25|--save|wide";
    shelf.does(save, "");
    let wide = format!("{}\n", "#".repeat(40));
    for (line, input, size) in [
        ("picture|wide", "", "20 × 12 taxels, threshold 0.25, "),
        ("picture|wide|--rows|30", "", "20 × 30 taxels, "),
        (
            "picture|-",
            "##\n#.\n",
            "16 × 16 taxels, threshold 0.5, NA 3 ",
        ),
        ("picture|-", &wide, "40 × 16 taxels, threshold 0.5, NA 40 "),
    ] {
        let text = shelf.does(line, input);
        assert!(text.contains(&format!("\n{size}")), "{line}: {text}");
    }
}

#[test]
fn a_picture_is_stored_and_read_from_its_file() {
    let shelf = Shelf::new();
    let file = shelf.file("shape.txt", "##\n##\n");
    let moved = format!("picture|{file}|--x0|5|--zoom-x|2|--save|moved");
    let saved = shelf.does(&moved, "");
    assert!(saved.contains("\nsaved as moved\n"), "{saved}");
    let path = shelf.folder.join("moved.json").display().to_string();
    let stored = std::fs::read_to_string(&path).expect("saved");
    assert!(stored.contains("\"picture\": ["), "{stored}");
    let json = |what: &str| shelf.does(&format!("picture|{what}|--json"), "");
    assert_eq!(json(&path), json("moved"));
    for (line, message) in [
        (
            "picture|nothing",
            "no stored shape or file named \"nothing\"; 'taxel library list' shows all",
        ),
        (
            "picture|no/such.txt",
            "no/such.txt: cannot read: no such file or folder",
        ),
        (
            "picture|washer|--zoom-x|0",
            "--zoom-x 0 is not above 0 (allowed: above 0, up to 64)",
        ),
    ] {
        shelf.refuses(line, message);
    }
}

#[test]
fn a_batch_reports_unknown_names() {
    let shelf = Shelf::new();
    shelf.does("library|save|mine|-", "#\n");
    std::fs::write(shelf.folder.join("bad.json"), "{").expect("written");
    let pose = |name: &str| format!(r#"{{"picture":"{name}","x0":0,"y0":0,"angle":0}}"#);
    let input = ["mine", "none", "a/b", "bad", "Mine"].map(pose).join("\n");
    let run = shelf.run("batch", &input);
    let answers: Vec<&str> = run.stdout.lines().collect();
    assert!(answers[0].contains(r#""na":1,"#) && answers[4] == answers[0]);
    let unknown = r#"{"error":"line 2: picture: no shape named \"none\""}"#;
    assert_eq!((run.status, answers[1]), (Some(1), unknown));
    for (answer, error) in [
        (2, "line 3: picture: '/' cannot be in a name"),
        (3, "bad.json: line 1, column 1: EOF"),
    ] {
        assert!(answers[answer].contains(error), "{}", answers[answer]);
    }
}
