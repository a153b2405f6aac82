//! Tests of `taxel recognise`: answers for people and for programs, single and in bulk, and exit statuses.

use std::fs;

use serde_json::Value;

use super::model::{COARSE, Place};
use super::{Run, finish, misused, program};

/// A square of 4 × 4, which only one of the four rectangles leaves.
const SQUARE: &str = "......\n.####.\n.####.\n.####.\n.####.\n......\n";

/// A bar that three of the rectangles leave.
const BAR: &str = "........\n.######.\n.######.\n.######.\n........\n";

/// A single taxel, which no rectangle leaves.
const SPECK: &str = "...\n.#.\n...\n";

/// Makes a place with a model of four rectangles, called `r`.
fn place() -> Place {
    let place = Place::with_model();
    place.write("square.txt", SQUARE);
    place.write("bar.txt", BAR);
    place.write("speck.txt", SPECK);
    place
}

fn answer(run: &Run) -> Value {
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    serde_json::from_str(&run.stdout).expect("a line of JSON")
}

#[test]
fn touches_are_answered_in_words_and_as_json() {
    let place = place();
    place.write("cut.txt", "####.\n####.\n####.\n####.\n");
    place.write(
        "odd.txt",
        "........\n.######.\n.#####..\n.######.\n........\n",
    );
    place.write(
        "square8.txt",
        "........\n...##...\n...##...\n........\n........\n",
    );
    place.write("noisy.txt", &BAR.replacen("........\n", "#.......\n", 1));
    place.write("twins.jsonl", "{\"name\":\"one\",\"figure\":\"rectangle\",\"length\":4,\"width\":4}\n{\"name\":\"two\",\"figure\":\"rectangle\",\"length\":4,\"width\":4}\n");
    place.done(&format!("model train twins.jsonl {COARSE} --name twins"));
    place.done("figure rectangle --length 6 --width 3 --threshold 0.2 --save low");
    let lines = [
        "square.txt --model r",
        "square.txt --model r --json",
        "bar.txt --model r --json --top 1",
        "bar.txt --model r --reject 0.99",
        "bar.txt --model r --noise 0",
        "bar.txt --model r --noise 0.01",
        "cut.txt --model r --json",
        "odd.txt --model r --ascii",
        "odd.txt --model r --pose --ascii",
        "odd.txt --model r --noise 0 --ascii",
        "odd.txt --model r --mask square8.txt --tolerance 0",
        "speck.txt --model r",
        "speck.txt --model r --noise 0.01 --pose --json",
        "square.txt --model twins",
        "square.txt --model twins --json",
        "bar.txt --model r --pose --pitch 2.5",
        "bar.txt --model r --pose --pitch 2.5 --json",
        "noisy.txt --model r --noise 0.01 --pose",
        // It was touched at another threshold.
        "low --model r",
    ];
    insta::assert_snapshot!("recognise", place.transcript("recognise", &lines));
}

#[test]
fn a_touch_that_no_shape_fits_is_none_of_these() {
    let place = place();
    // A square with two corners missing, and a cross that no rectangle resembles.
    place.write(
        "near.txt",
        "......\n..###.\n.####.\n.####.\n.###..\n......\n",
    );
    place.write(
        "cross.txt",
        "...........\n.....#.....\n.....#.....\n.....#.....\n.....#.....\n.#########.\n\
         .....#.....\n.....#.....\n.....#.....\n.....#.....\n...........\n",
    );
    for (line, expected) in [
        ("near.txt", "d  "),
        ("near.txt --tolerance 0", "none of these: nearest d, "),
        ("near.txt --noise 0", "unknown: no trained pose leaves this"),
        ("cross.txt", "none of these: nearest "),
        ("cross.txt --noise 0.01", "none of these: nearest "),
        ("cross.txt --tolerance 30", "d  "),
        ("near.txt --mask near.txt", "d  "),
    ] {
        let text = place.done(&format!("recognise {line} --model r"));
        assert!(text.starts_with(expected), "{line}: {text}");
    }
}

/// The position, the angle and the zooms of a fit are those of other commands, to the last digit.
#[test]
fn a_fit_touched_again_differs_in_as_many_taxels_as_it_states() {
    let place = Place::new();
    let disc = r#""figure":"ellipse","radius_x":3.2,"radius_y":2.1"#;
    let key = r#""picture":"key""#;
    let washer = r#""picture":"washer""#;
    fitted_again(&place, &[("disc", disc), ("key", key)], "");
    fitted_again(
        &place,
        &[("washer", washer), ("key", key)],
        "--zoom-x 1:1.2:0.2 --zoom-y 0.9",
    );
}

/// Touches with these shapes, recognises the touches, and touches with the fits.
fn fitted_again(place: &Place, shapes: &[(&str, &str)], zooms: &str) {
    let read = |text: &str| -> Vec<Value> {
        let lines = text.lines();
        lines
            .map(|line| serde_json::from_str(line).expect("JSON"))
            .collect()
    };
    let taxels = |value: &Value| -> Vec<u8> {
        let rows = value["imprint"].as_array().expect("rows").iter();
        rows.flat_map(|row| row.as_str().expect("a row").bytes())
            .collect()
    };
    let lines = shapes
        .iter()
        .map(|(name, shape)| format!("{{\"name\":\"{name}\",{shape}}}\n"));
    place.write("set.jsonl", &lines.collect::<String>());
    let train = "model train set.jsonl --positions 5 --angle 0:357:3 --threshold 0.4";
    place.done(&format!("{train} {zooms} --out m.npz --force --quiet"));
    let mut poses = String::new();
    for (number, (_, shape)) in (0..24).zip(shapes.iter().cycle()) {
        let [x0, y0, angle] = [0.37, 0.53, 17.3].map(|step| step * f64::from(number));
        let (x0, y0, angle) = (6.0 + x0 % 3.0, 5.0 + y0 % 4.0, angle % 360.0);
        poses += &format!("{{{shape},\"x0\":{x0},\"y0\":{y0},\"angle\":{angle}");
        poses += match (shape.contains("picture"), zooms) {
            (false, _) => "}\n",
            (true, "") => ",\"zoom_x\":1,\"zoom_y\":1}\n",
            (true, _) => ",\"zoom_x\":1.2,\"zoom_y\":0.9}\n",
        };
    }
    let batch = "batch --columns 26 --rows 24 --threshold 0.4";
    let touched = place.run(batch, &poses).stdout;
    let answers = [1, 4].map(|jobs| {
        let line = format!("recognise - --model m.npz --jobs {jobs}");
        place.run(&line, &touched).stdout
    });
    assert_eq!(answers[0], answers[1]);
    let answers = read(&answers[0]);
    let mut fits = String::new();
    for answer in &answers {
        let mut fit = answer["fit"].as_object().expect("a fit").clone();
        let shape = shapes.iter().find(|(name, _)| fit["name"] == *name);
        let shape = shape.expect("one of the set").1;
        assert_eq!(fit.contains_key("zoom_x"), !zooms.is_empty(), "{answer}");
        if zooms.is_empty() && shape.contains("picture") {
            fit.extend(["zoom_x", "zoom_y"].map(|zoom| (zoom.to_owned(), 1.into())));
        }
        fit.retain(|key, _| key != "name" && key != "differs");
        let keys = Value::Object(fit).to_string();
        fits += &format!("{{{shape},{}\n", &keys[1..]);
    }
    let again = read(&place.run(batch, &fits).stdout);
    let mut exact = 0;
    for ((answer, again), touched) in answers.iter().zip(again).zip(read(&touched)) {
        let pairs = taxels(&again).into_iter().zip(taxels(&touched));
        let differs = pairs.filter(|(one, other)| one != other).count();
        assert_eq!(answer["fit"]["differs"], differs, "{answer}");
        exact += u32::from(differs == 0);
    }
    assert!((18..=24).contains(&exact), "{exact}");
}

#[test]
fn wrong_names_and_flags_are_refused() {
    let place = place();
    let lines = [
        "square.txt --model nobody",
        "nothing.txt --model r",
        "square.txt --model r --mask bar.txt",
        "square.txt --model r --noise 0 --tolerance 1",
    ];
    insta::assert_snapshot!("refused", place.transcript("recognise", &lines));
}

#[test]
fn standard_input_is_read_once() {
    for line in [
        "recognise - --noise 0.01 --mask -",
        "model train - - --out two.npz",
        "frames - --all --at-least 3 --gain -",
        "watch - --at-least 3 --mask - --gain -",
    ] {
        misused(line, "standard input can be read only once");
    }
}

#[test]
fn the_order_of_touches_does_not_matter() {
    let place = Place::new();
    let left = r####"["#..","#..","###","##."]"####;
    let right = r####"["..#","..#","###",".##"]"####;
    let set =
        format!("{{\"name\":\"L\",\"picture\":{left}}}\n{{\"name\":\"R\",\"picture\":{right}}}\n");
    fs::write(place.path("lr.jsonl"), set).expect("written");
    place.done("model train lr.jsonl --positions 10 --angle 0:350:10 --out lr.npz --quiet");
    // R leaves the mirror image of each imprint of L just as often.
    let one = r#"[".....",".###.",".##..","....."]"#;
    let mirrored = r#"[".....",".###.","..##.","....."]"#;
    let touches = |order: [&str; 4]| {
        format!(
            "{{\"touches\":[{}]}}\n",
            order.map(|own| [own; 50].join(",")).join(",")
        )
    };
    let input = touches([one, mirrored, one, mirrored]) + &touches([mirrored, mirrored, one, one]);
    for noise in ["", "--noise 0.01"] {
        let run = place.run(&format!("recognise - --model lr.npz {noise}"), &input);
        assert_eq!(run.status, Some(0), "{}", run.stderr);
        for line in run.stdout.lines() {
            let answer: Value = serde_json::from_str(line).expect("JSON");
            assert_eq!(answer["state"], "tied", "{line}");
            for of_shape in answer["ranking"].as_array().expect("an array") {
                assert_eq!(of_shape["probability"], 0.5, "{line}");
            }
        }
        assert_eq!(run.stdout.lines().count(), 2);
    }
}

#[test]
fn lines_are_answered_in_their_order() {
    let place = place();
    let square = r#"["......",".####.",".####.",".####.",".####.","......"]"#;
    let bar = r#"["........",".######.",".######.",".######.","........"]"#;
    let input = format!(
        "{{\"frame\":7,\"imprint\":{bar},\"label\":\"x\",\"other\":[1]}}\n\n\
         {{\"time\":0.10,\"label\":null,\"channel\":\"left\",\"imprint\":{square}}}\n\
         {{\"imprint\":[\"#?\"]}}\n\
         {{\"touches\":[{bar},{bar}]}}\n\
         {{\"touches\":[{bar},{square}]}}\n"
    );
    let run = place.run("recognise - --model r", &input);
    insta::assert_snapshot!("lines", run.stdout);
    assert_eq!(run.stderr, "error: 1 of 5 lines could not be answered\n");
    let read = |line: &str| serde_json::from_str::<Value>(line).expect("JSON");
    let lines: Vec<Value> = run.stdout.lines().map(read).collect();
    let first = |line: usize| lines[line]["ranking"][0]["probability"].as_f64();
    assert!(first(3) > first(0), "two touches tell more than one");
    // The answers of a batch are such lines.
    let poses = "{\"figure\":\"rectangle\",\"length\":4.2,\"width\":4.2,\"x0\":5.2,\"y0\":5.3,\"angle\":20}\n";
    let answers = place.run("batch", &poses.repeat(3));
    let run = place.run("recognise - --model r", &answers.stdout);
    assert_eq!((run.status, run.stdout.lines().count()), (Some(0), 3));
}

#[test]
fn a_pose_is_given_in_cells_degrees_and_mm() {
    let place = place();
    let number = |value: &Value| value.as_f64().expect("a number");
    let bar = place.json("recognise bar.txt --model r --pose --pitch 2.5 --json");
    let pose = &bar["pose"];
    assert_eq!(pose["name"], bar["answer"]);
    // The middle of the bar, from the corner of the matrix and from the corner of its box, which begins at (1, 1).
    let [x, y] = [0, 1].map(|axis| number(&pose["centre"][axis]));
    assert!((x - 4.0).abs() < 0.1 && (y - 2.5).abs() < 0.1, "{pose}");
    assert!(
        (x - number(&pose["centre_in_box"][0]) - 1.0).abs() < 1e-9,
        "{pose}"
    );
    assert!((number(&pose["centre_mm"][0]) - 2.5 * x).abs() < 1e-9);
    // A disc has no angle.
    place.done(&format!("model train parts.jsonl {COARSE} --name parts"));
    let figure = "figure ellipse --radius-x 3 --radius-y 3 --x0 4.5 --y0 5 --json";
    let disc = place.run(
        "recognise - --model parts --pose --json",
        &place.done(figure),
    );
    let disc = answer(&disc);
    assert_eq!(
        (&disc["answer"], &disc["pose"]["angle"]),
        (&"disc".into(), &Value::Null)
    );
    assert!(
        (number(&disc["pose"]["centre"][0]) - 7.5).abs() < 0.3,
        "{disc}"
    );
    // So far beside the centres of the taxels, a tiny disc leaves nothing.
    place.write(
        "tiny.jsonl",
        "{\"name\":\"tiny\",\"figure\":\"ellipse\",\"radius_x\":0.1,\"radius_y\":0.1}\n",
    );
    place.done(&format!("model train tiny.jsonl {COARSE} --name tiny"));
    let empty = place.run("recognise - --model tiny --noise 0", "....\n....\n");
    assert!(
        empty.stdout.starts_with("tiny  100.0 %  certain\n"),
        "{}",
        empty.stdout
    );
    // A single degree is said once.
    place.write(
        "b.jsonl",
        "{\"name\":\"bar\",\"figure\":\"rectangle\",\"length\":6,\"width\":3}\n",
    );
    place.done("model train b.jsonl --positions 2 --angle 0:345:15 --out b.npz");
    place.done("figure rectangle --length 6 --width 3 --x0 5 --y0 5 --angle 30 --export touch.txt");
    let text = place.done("recognise touch.txt --model b.npz --pose");
    let said = "centre 8.00 ± 0.00, 6.50 ± 0.00 cells\n\
                angle 30° ± 0° (repeats every 180°); 95 % of 2 poses: 30°\n";
    assert!(text.contains(said), "{text}");
}

/// The angle of a picture that a quarter turn maps onto itself is only known up to quarter turns.
#[test]
fn the_angle_of_a_cross_is_known_modulo_a_quarter_turn() {
    let place = Place::new();
    place.done("model train cross --positions 2 --angle 0:345:15 --out c.npz");
    let cross = place.done("picture cross --angle 15 --json");
    let run = place.run("recognise - --model c.npz --pose", &cross);
    let answer = answer(&run);
    let angle = &answer["pose"]["angle"];
    assert_eq!(angle["period"], 90.0, "{answer}");
    let mean = angle["mean"].as_f64().expect("an angle");
    assert!((mean - 15.0).abs() < 8.0, "{answer}");
}

#[test]
fn a_heptagon_repeats_every_seventh_of_a_turn() {
    let place = Place::new();
    place.write(
        "heptagon.jsonl",
        "{\"name\":\"heptagon\",\"figure\":\"heptagon\",\"side\":4}\n",
    );
    place.done("model train heptagon.jsonl --positions 4 --name h");
    let near = place.done("figure heptagon --side 4 --x0 5.25 --y0 5 --angle 2 --json");
    let near = answer(&place.run("recognise - --model h", &near));
    // The imprint that the heptagon leaves in one of the few poses of the model.
    let touched = format!("{{\"imprint\":{}}}\n", near["nearest"]["imprint"]);
    let rows = near["nearest"]["imprint"].as_array().expect("rows");
    let rows = rows.iter().filter_map(Value::as_str);
    let drawn: String = rows.map(|row| format!("{row}\n")).collect();
    let text = place.run("recognise - --model h --pose", &drawn).stdout;
    assert!(text.contains("(repeats every 51.43°)"), "{text}");
    let json = answer(&place.run("recognise - --model h --pose --json", &touched));
    let angle = &json["pose"]["angle"];
    let number = |key: &str| angle[key].as_f64().expect("a number");
    assert!((number("period") - 360.0 / 7.0).abs() < 1e-9, "{angle}");
    assert!(number("degrees") <= 52.0, "{angle}");
}

#[test]
fn every_stored_shape_is_known_without_a_model() {
    let place = Place::new();
    place.done("figure triangle --side 9.3 --thickness 1.6 --save mine");
    place.write("library/broken.json", "{");
    for shape in ["mine", "gear"] {
        let pose = "--columns 24 --rows 24 --x0 5.3 --y0 6.6 --angle 71 --json";
        let touched = place.done(&format!("picture {shape} {pose}"));
        let run = place.run("recognise -", &touched);
        assert_eq!(run.status, Some(0), "{}", run.stderr);
        let left_out = "left out: broken (unreadable)\n";
        assert!(run.stderr.starts_with(left_out), "{}", run.stderr);
        let known: Value = serde_json::from_str(&run.stdout).expect("a line of JSON");
        assert_eq!(known["answer"], shape);
        // The same touch as a frame of a sensor.
        let touch: Value = serde_json::from_str(&touched).expect("a line of JSON");
        let row = |row: &Value| -> Vec<u8> {
            let row = row.as_str().unwrap_or_default().bytes();
            row.map(|taxel| u8::from(taxel == b'#')).collect()
        };
        let rows = touch["imprint"].as_array().expect("rows").iter();
        let frame = serde_json::json!({"frame": rows.map(row).collect::<Vec<_>>()});
        let flags = "frames - --frame 0 --json --at-least 1 --model";
        let named = place.run(flags, &format!("{frame}\n"));
        let named: Value = serde_json::from_str(&named.stdout).expect("a line of JSON");
        assert_eq!(named["recognition"]["answer"], shape, "{named}");
    }
    let card = place.done("model show figures");
    assert!(card.contains("hexagon: hexagon side 4.00"), "{card}");
}

/// Each of these lines is refused before a built-in set is trained.
#[test]
fn mistyped_names_are_refused_before_training() {
    let place = place();
    place.write("there.svg", "");
    for line in [
        "recognise square.txt --noise 0.01 --mask nowhere",
        "frames nowhere --all --at-least 1 --model figures",
        "model confusion figures --export there.svg",
    ] {
        let arguments: Vec<&str> = line.split(' ').collect();
        let mut program = program(&arguments, "C.UTF-8");
        program
            .current_dir(place.0.path())
            .env("XDG_CACHE_HOME", place.path("cache"));
        let run = finish(program.spawn().expect("it starts"), b"");
        assert_eq!(run.status, Some(1), "{line}: {}", run.stderr);
        let said = |name: &str| run.stderr.contains(name);
        assert!(said("nowhere") || said("there.svg"), "{}", run.stderr);
        let is_trained = fs::exists(place.path("cache")).expect("it can be looked at");
        assert!(!is_trained, "{line}");
    }
}

/// One of these frames has a square. The frames are named with `--model`, and through a pipe.
#[test]
fn frames_are_named_by_a_model() {
    let place = place();
    let row = |values: &str| format!("[{values}]");
    let empty = row("0,0,0,0,0,0");
    let full = row("0,9,9,9,9,0");
    let frame = |rows: [&str; 6]| format!("{{\"frame\":[{}]}}\n", rows.join(","));
    let square = frame([&empty, &full, &full, &full, &full, &empty]);
    let nothing = frame([&empty; 6]);
    place.write("touch.jsonl", &(nothing + &square));
    let flags = "--at-least 5 --model r --noise 0.01";
    let listed = place.done(&format!("frames touch.jsonl --all --json {flags}"));
    let lines: Vec<Value> = listed
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    assert_eq!(lines[0]["recognition"], Value::Null);
    let named = &lines[1]["recognition"];
    assert_eq!(
        (&named["answer"], &named["noise"]),
        (&"d".into(), &0.01.into())
    );
    assert_eq!(named["nearest"]["distance"], 0);
    // A stream gives the same answers, and the answers of both are input for recognise.
    let watched = place.done(&format!("watch touch.jsonl --once {flags}"));
    assert_eq!(watched, listed);
    let piped = answer(&place.run(
        "recognise - --model r --noise 0.01",
        listed.lines().last().expect("a line"),
    ));
    assert_eq!(
        (&piped["frame"], &piped["answer"]),
        (&1.into(), &"d".into())
    );
    assert_eq!(piped["ranking"], named["ranking"]);
    let text = place.done("frames touch.jsonl --peak --at-least 5 --model r");
    assert!(text.contains("\nd  >99.9 %  fits exactly at "), "{text}");
    // A masked cell may be covered. Without it and a corner, the touch fits as well as allowed.
    let gap = row("0,9,0,9,9,0");
    let corner = row("0,0,9,9,9,0");
    place.write(
        "gap.jsonl",
        &frame([&empty, &full, &gap, &full, &corner, &empty]),
    );
    place.write(
        "mask.txt",
        "......\n......\n..#...\n......\n......\n......\n",
    );
    let near = "gap.jsonl --at-least 5 --mask mask.txt --model r --tolerance";
    for (tolerance, state) in [(0, "unknown"), (1, "likely")] {
        let named =
            place.json(&format!("frames {near} {tolerance} --all --json"))["recognition"].take();
        assert_eq!(
            (&named["state"], &named["fit"]["differs"]),
            (&state.into(), &1.into())
        );
        let watched = place.json(&format!("watch {near} {tolerance} --once"));
        assert_eq!(watched["recognition"], named);
    }
    let text = place.done(&format!("frames {near} 1 --all"));
    assert!(text.contains("\n  · ██x ████·\n"), "{text}");
    let lacks = "the following required arguments were not provided:
  --model ";
    misused("frames touch.jsonl --all --at-least 5 --tolerance 1", lacks);
    misused("watch touch.jsonl --once --noise 0.01", lacks);
    for line in [
        "watch touch.jsonl --once",
        "frames touch.jsonl --peak --at-least 5",
    ] {
        let run = place.run(&format!("{line} --model nowhere"), "");
        assert_eq!(run.status, Some(1), "{line}");
        assert!(run.stderr.contains("nowhere"), "{}", run.stderr);
    }
}
