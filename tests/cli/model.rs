//! Tests of `taxel model`: training, shards, evaluation, and refusals.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::Run;
use super::finish;
use super::misused;
use super::program;
use super::python_has;
use super::refused;
use super::sweep::{folder, names};
use super::taxel;

/// Two shapes that no touch confuses.
pub(crate) const PARTS: &str = "{\"name\":\"disc\",\"figure\":\"ellipse\",\"radius_x\":3,\"radius_y\":3}\n\
                                {\"name\":\"ring\",\"picture\":\"washer\"}\n";

/// Four rectangles that are hard to tell apart.
pub(crate) const RECTANGLES: &str = "{\"name\":\"a\",\"figure\":\"rectangle\",\"length\":6,\"width\":3}\n\
     {\"name\":\"b\",\"figure\":\"rectangle\",\"length\":6,\"width\":3.2}\n\
     \n\
     {\"name\":\"c\",\"figure\":\"rectangle\",\"length\":6.2,\"width\":3}\n\
     {\"name\":\"d\",\"figure\":\"rectangle\",\"length\":4.2,\"width\":4.2}\n";

/// The grid of the published numbers.
const PUBLISHED: &str = "--x0 10:10.99:0.01 --y0 10:10.99:0.01 --angle 0:359:1 --anchor corner \
                         --columns 32 --rows 32 --quiet";

/// A coarse grid, for a quick training.
pub(crate) const COARSE: &str = "--positions 10 --angle 0:355:5 --quiet";

/// A folder with files, in which the program runs and has its library.
pub(crate) struct Place(pub(crate) tempfile::TempDir);

impl Place {
    pub(crate) fn new() -> Self {
        let place = Self(folder());
        place.write("parts.jsonl", PARTS);
        place.write("rectangles.jsonl", RECTANGLES);
        place
    }

    pub(crate) fn path(&self, name: &str) -> String {
        self.0.path().join(name).display().to_string()
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        fs::write(self.0.path().join(name), text).expect("written");
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.0.path().join(name)).expect("it is there")
    }

    /// Runs a line in the folder; words are split at spaces, but not between single quotes.
    pub(crate) fn run(&self, line: &str, input: &str) -> Run {
        let mut arguments = Vec::new();
        for (index, part) in line.split('\'').enumerate() {
            if index % 2 == 1 {
                arguments.push(part);
            } else {
                arguments.extend(part.split_whitespace());
            }
        }
        let mut program = program(&arguments, "C.UTF-8");
        program
            .current_dir(self.0.path())
            .env("TAXEL_LIBRARY", self.0.path().join("library"));
        finish(program.spawn().expect("it starts"), input.as_bytes())
    }

    /// Runs a line that must succeed, and returns its output.
    pub(crate) fn done(&self, line: &str) -> String {
        let run = self.run(line, "");
        assert_eq!(run.status, Some(0), "{line}: {}", run.stderr);
        run.stdout
    }

    pub(crate) fn json(&self, line: &str) -> Value {
        serde_json::from_str(&self.done(line)).expect("a line of JSON")
    }
}

/// Returns the keys of an object in the order of its text.
pub(crate) fn keys(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let (mut depth, mut quoted, mut word) = (0, false, String::new());
    for sign in text.chars() {
        match sign {
            '"' => {
                quoted = !quoted;
                if quoted {
                    word.clear();
                }
            }
            _ if quoted => word.push(sign),
            '{' | '[' => depth += 1,
            '}' | ']' => depth -= 1,
            ':' if depth == 1 => found.push(word.clone()),
            _ => {}
        }
    }
    found
}

#[test]
fn four_rectangles_on_the_command_line_are_confused_as_published() {
    let place = Place::new();
    place.done(&format!(
        "model train rectangles.jsonl {PUBLISHED} --out s4.npz"
    ));
    let text = place.done("model confusion s4.npz --json");
    assert_eq!(
        keys(&text),
        [
            "labels",
            "touches",
            "right",
            "accuracy",
            "error",
            "certain",
            "tied",
            "right_in_top_two",
            "information_bits",
            "prior_bits",
            "keys",
            "keys_of_one_shape",
            "confusion"
        ]
    );
    let limit: Value = serde_json::from_str(&text).expect("JSON");
    let count = |key: &str| limit[key].as_u64().expect("a count");
    assert_eq!(
        ["touches", "right", "certain", "tied"].map(count),
        [14_400_000, 10_498_796, 4_821_044, 524]
    );
    assert_eq!(
        limit["confusion"].to_string(),
        "[[1642740,650164,1307096,0],[261984,2673920,664096,0],[572156,445708,2582136,0],[0,0,0,3600000]]"
    );
    assert_eq!(limit["labels"].to_string(), r#"["a","b","c","d"]"#);
    let bits = limit["information_bits"].as_f64().expect("bits");
    assert_eq!(format!("{bits:.4}"), "1.2066");
    let table = place.done("model confusion s4.npz --csv");
    assert_eq!(
        table.lines().nth(1),
        Some("a,1642740,650164,1307096,0"),
        "{table}"
    );
    let shown = place.done("model confusion s4.npz");
    assert!(
        shown.contains("1 a        [1642740]") && shown.contains("·"),
        "{shown}"
    );
    assert!(shown.contains("most confused: a and c (13.1 %)"), "{shown}");
}

#[test]
fn confusion_is_evaluated_for_descriptors_pairs_and_classifiers() {
    let place = Place::new();
    place.done(&format!(
        "model train rectangles.jsonl {COARSE} --out m.npz"
    ));
    let limit = place.json("model confusion m.npz --json");
    let right = |answer: &Value| answer["right"].as_u64().expect("a count");
    let given = place.json("model confusion m.npz --given na,p --json");
    assert_eq!(given["touches"], limit["touches"]);
    assert!(right(&given) <= right(&limit));
    let fine = place.json("model confusion m.npz --given cg_cd --json");
    let rounded = place.json("model confusion m.npz --given cg_cd --round cg_cd=0.1 --json");
    assert!(right(&rounded) < right(&fine) && rounded["keys"].as_u64() < fine["keys"].as_u64());
    let greedy = place.json("model confusion m.npz --greedy --json");
    let chosen = greedy["chosen"].as_array().expect("steps");
    assert!(!chosen.is_empty() && right(chosen.last().expect("one")) <= right(&limit));
    assert_eq!(greedy["limit"], limit["error"]);
    let pairs = place.json("model confusion m.npz --pairs --json");
    assert_eq!(pairs["errors"][0][3].as_f64(), Some(0.0));
    assert_eq!(pairs["errors"][0][2], pairs["errors"][2][0]);
    let table = place.json("model confusion m.npz --classifier all --json");
    for name in ["z", "knn", "template"] {
        let peer = place.json(&format!("model confusion m.npz --classifier {name} --json"));
        assert_eq!(peer["classifier"], name);
        assert_eq!(peer["error"], table[name], "{name}");
        assert!(right(&peer) <= right(&limit) && peer["certain"].is_null());
    }
    assert_eq!(table["limit"], limit["error"]);
    // A drawn sample is marked as such, and nothing that is unknown is called certain.
    let knn = "model confusion m.npz --classifier knn --sample 7 --seed 3";
    let answer = place.json(&format!("{knn} --json"));
    assert_eq!((&answer["sample"], &answer["seed"]), (&7.into(), &3.into()));
    let text = place.done(knn);
    assert!(text.contains("knn draws 7 poses of each shape, with seed 3\n"));
    assert!(!text.contains("certain"), "{text}");
    let all = place.done("model confusion m.npz --classifier all");
    assert!(
        all.contains("knn draws 2,000 poses of each shape, with seed 0\n"),
        "{all}"
    );
    misused(
        "model confusion m.npz --given na,cg",
        "invalid value 'na,cg' for '--given <KEY,...>': cg depends on the position",
    );
    misused(
        "model confusion m.npz --round cg_cd=0",
        "invalid value 'cg_cd=0' for '--round <KEY=STEP>': rounding \"cg_cd=0\": expected",
    );
}

#[test]
fn messages_and_files_match_the_request() {
    let place = Place::new();
    place.done(&format!(
        "model train rectangles.jsonl {COARSE} --out m.npz"
    ));
    let wrong = |asked: &str| {
        let text = place.done(&format!("model confusion m.npz {asked}"));
        let line = text.lines().find(|line| line.starts_with("wrong"));
        line.expect("it is there").to_owned()
    };
    assert!(wrong("").ends_with("the limit: no method does better"));
    let given = wrong("--given na,p");
    assert!(given.ends_with("no method that sees only these descriptors does better"));
    assert!(wrong("--classifier z").ends_with('%'), "not the limit");
    place.done("model confusion m.npz --classifier all --export all.csv");
    let table = String::from_utf8(place.read("all.csv")).expect("text");
    assert!(table.starts_with("classifier,error,right_in_top_two,information_bits\nz,"));
    assert!(
        table
            .lines()
            .last()
            .is_some_and(|line| line.starts_with("limit,"))
    );
    let run = place.run(
        "model confusion m.npz --classifier all --export all.svg",
        "",
    );
    refused(
        &run,
        1,
        "all.svg: expected a name that ends in .csv, for the table of all classifiers",
    );
    // With noise: from the whole imprint, and from descriptors.
    let noisy = "model confusion m.npz --noise 0:0.04:0.02 --dead 0,4 --touches 50 --quiet";
    let shown = place.done(&format!("{noisy} --export noise.svg"));
    assert!(shown.contains("\n4 dead taxels\n"), "{shown}");
    let drawn = String::from_utf8(place.read("noise.svg")).expect("text");
    assert!(drawn.contains(">4 dead taxels</text>") && drawn.contains(">noise</text>"));
    let right = |asked: &str| {
        let answer = place.json(&format!("{noisy} --json {asked}"));
        let rows = answer["degradation"].as_array().expect("rows").clone();
        [0, 2].map(|row: usize| rows[row]["accuracy"].as_f64().expect("a share"))
    };
    let run = place.run("model confusion m.npz --noise 0 --dead 257", "");
    refused(
        &run,
        1,
        "--dead 257 is above 256 (allowed: 0 to 256, the taxels of the matrix)",
    );
    let (whole, given) = (right(""), right("--given na,p"));
    assert!(given[0] <= whole[0] + 0.1 && given[1] < whole[1] - 0.05);
    assert!(given[1] < given[0] - 0.1, "one taxel more is another count");
}

#[test]
fn shards_and_threads_give_the_same_bytes() {
    let place = Place::new();
    let train = "model train parts.jsonl --positions 10 --angle 0:359:3 --quiet";
    place.done(&format!("{train} --jobs 1 --out one.npz"));
    place.done(&format!("{train} --jobs 2 --out two.npz"));
    assert!(
        place.read("one.npz") == place.read("two.npz"),
        "threads differ"
    );
    for shard in 1..=3 {
        place.done(&format!("{train} --shard {shard}/3 --out part-{shard}.npz"));
    }
    place.done("merge part-3.npz part-1.npz part-2.npz --out merged.npz");
    assert!(
        place.read("merged.npz") == place.read("one.npz"),
        "shards differ"
    );
    let run = place.run("merge part-1.npz part-3.npz --out no.npz", "");
    refused(&run, 1, "shard 2/3 is missing");
    let run = place.run("merge part-2.npz --out no.npz", "");
    refused(&run, 1, "2 of 3 shards are missing: 1, 3");
    let run = place.run("merge part-1.npz one.npz --out no.npz", "");
    let message = "one.npz: shard 1/1, but part-1.npz is shard 1/3: not the same study";
    refused(&run, 1, message);
    let run = place.run(
        "merge part-1.npz part-2.npz part-3.npz --out ./part-1.npz --force",
        "",
    );
    let message = "part-1.npz: one of the shards; write to another file";
    refused(&run, 1, message);
    assert!(!names(place.0.path()).contains(&"no.npz".to_owned()));
}

#[test]
fn models_can_be_named_listed_and_shown() {
    let place = Place::new();
    let built_in = "figures: built in\nfigures-30: built in\nshapes: built in\n";
    assert_eq!(place.done("model list"), built_in);
    assert_eq!(place.done("model list --json"), "");
    place.done(&format!(
        "model train rectangles.jsonl {COARSE} --name parts --threshold 0.4"
    ));
    let library = place.0.path().join("library");
    assert_eq!(names(&library.join("models")), ["parts.npz"]);
    let card = place.done("model show parts");
    for line in [
        "16 × 16 sensor, threshold 0.4, centre at x0 7:7.9:0.1 cells, y0 7:7.9:0.1 cells, angle 0:355:5°",
        "  d: rectangle length 4.20, width 4.20, named right in 100.0 % of its touches",
        "7,200 poses each",
    ] {
        assert!(card.lines().any(|own| own == line), "{line}\n{card}");
    }
    place.done(
        "model train washer --zoom-x 0.5:1:0.25 --positions 2 --angle 0 --out zoomed.npz --quiet",
    );
    let zoomed = place.done("model show zoomed.npz");
    assert!(
        zoomed.contains(", angle 0°, zoom_x 0.5:1:0.25\n"),
        "{zoomed}"
    );
    let run = place.run("frames zoomed.npz", "");
    let kind = "zoomed.npz: an atlas or a model of taxel, expected Tekscan ASCII, ";
    assert!(
        run.stderr.starts_with(&format!("error: {kind}")),
        "{}",
        run.stderr
    );
    let card = place.json("model show parts --json");
    assert_eq!(card["shapes"][1]["name"], "b");
    assert_eq!(card["ranges"]["x0"], "7:7.9:0.1");
    assert_eq!(card["hash"].as_str().map(str::len), Some(32));
    let list = place.done("model list --json");
    assert!(list.contains(r#""shapes":["a","b","c","d"]"#), "{list}");
    let run = place.run(
        &format!("model train parts.jsonl {COARSE} --name parts"),
        "",
    );
    let there = format!(
        "{:?} already exists; --force replaces it",
        place.path("library/models/parts.npz")
    );
    refused(&run, 1, &there);
    refused(
        &place.run("model delete figures", ""),
        1,
        "figures is built in and cannot be deleted",
    );
    assert_eq!(place.done("model delete parts"), "deleted parts\n");
    refused(
        &place.run("model delete parts", ""),
        1,
        "no model named \"parts\"; 'taxel model list' shows all",
    );
}

/// Shapes of a set come from anywhere: files, standard input, the library.
#[test]
fn shapes_come_from_files_and_the_library() {
    let place = Place::new();
    place.done("library save mine washer");
    place.write("more.jsonl", "{\"name\":\"big disc\",\"figure\":\"ellipse\",\"radius_x\":5,\"radius_y\":5}\n{\"name\":\"key\",\"picture\":\"key\"}\n");
    let line = format!("model train rectangles.jsonl - mine more.jsonl {COARSE} --out all.npz");
    let run = place.run(
        &line,
        "{\"name\":\"corner\",\"imprint\":[\"##\",\"#.\"],\"weight\":2}\r\n",
    );
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    let limit = place.json("model confusion all.npz --json");
    assert_eq!(
        limit["labels"].to_string(),
        r#"["a","b","c","d","corner","mine","big disc","key"]"#
    );
    let card = place.json("model show all.npz --json");
    assert_eq!(card["shapes"][4]["weight"], 2);
    assert_eq!(card["touches"].as_u64(), Some(9 * 7200));
}

#[test]
fn an_evaluation_says_if_touches_count_with_weights() {
    let place = Place::new();
    for (weights, counted) in [([1, 1], false), ([2, 2], true), ([1, 3], true)] {
        let [a, b] = weights;
        let lines = format!(
            "{{\"name\":\"a\",\"figure\":\"rectangle\",\"length\":4,\"width\":4,\"weight\":{a}}}\n\
             {{\"name\":\"b\",\"figure\":\"hexagon\",\"side\":3,\"weight\":{b}}}\n"
        );
        let run = place.run(
            &format!("model train - {COARSE} --out m.npz --force"),
            &lines,
        );
        assert_eq!(run.status, Some(0), "{}", run.stderr);
        let said = "each touch counts with the weight of its shape\n";
        for output in [run.stdout, place.done("model confusion m.npz")] {
            assert_eq!(output.contains(said), counted, "{weights:?}: {output}");
        }
        let noise = "model confusion m.npz --noise 0:0.2:0.1 --touches 20";
        let output = place.done(noise);
        assert_eq!(output.contains(said), counted, "{weights:?}: {output}");
        for row in place.json(&format!("{noise} --json"))["degradation"]
            .as_array()
            .expect("rows")
        {
            let [touches, right, accuracy] =
                ["touches", "right", "accuracy"].map(|key| row[key].as_f64().expect("a number"));
            assert_eq!(touches, f64::from(20 * (a + b)), "{row}");
            assert!((right / touches - accuracy).abs() < 1e-12, "{row}");
        }
    }
}

#[test]
fn meaningless_sets_are_refused_in_one_sentence() {
    let place = Place::new();
    let train = |what: &str, input: &str| {
        place.run(&format!("model train {what} {COARSE} --out m.npz"), input)
    };
    let disc = r#""figure":"ellipse","radius_x":3,"radius_y":3"#;
    for (input, message) in [
        (
            format!("{{\"name\":\"a\",{disc}}}\n{{{disc}}}\n"),
            "standard input: line 2: name: missing; every shape of a set needs one",
        ),
        (
            format!("{{\"name\":\"a\",{disc}}}\n\n{{\"name\":\"a\",{disc}}}\n"),
            "two shapes are named \"a\"; give each its own name",
        ),
        (
            "{\"name\":\"a\"".to_owned(),
            "standard input: line 1, column 11: ",
        ),
        (
            "{\"name\":\"a\",\"figure\":\"ellipse\",\"radius_x\":3}".to_owned(),
            "standard input: line 1: radius_y",
        ),
        (
            "{\"name\":\"a\",\"figure\":\"ellipse\",\"radius_x\":3,\"radius_y\":3,\"sensor\":{}}"
                .to_owned(),
            "standard input: line 1: ",
        ),
        (
            "{\"name\":\"a\",\"picture\":\"no such\"}".to_owned(),
            "standard input: line 1: picture",
        ),
        (
            "\n \n".to_owned(),
            "standard input: no shapes, expected a line of JSON for each",
        ),
    ] {
        let run = train("-", &input);
        assert_eq!((run.status, run.stdout.as_str()), (Some(1), ""), "{input}");
        assert!(
            run.stderr.starts_with(&format!("error: {message}")),
            "{input}: {}",
            run.stderr
        );
        assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    }
    let run = train("no-such-shape", "");
    assert!(run.stderr.contains("no-such-shape"), "{}", run.stderr);
    // Poses that the sensor cuts off are refused unless they are allowed.
    place.write(
        "t.jsonl",
        "{\"name\":\"t\",\"figure\":\"triangle\",\"side\":11.77}\n",
    );
    let cut = "model train t.jsonl --x0 5:5.9:0.1 --y0 5:5.9:0.1 \
               --angle 0:350:10 --columns 16 --rows 16 --quiet --out cut.npz";
    refused(
        &place.run(cut, ""),
        1,
        "t: the 16 × 16 sensor cuts off 3,600 of 3,600 poses; \
         use a larger sensor, other positions or smaller shapes, or allow it with --allow-cut",
    );
    place.done(&format!("{cut} --allow-cut"));
    refused(
        &train(
            "-",
            "{\"name\":\"huge\",\"figure\":\"ellipse\",\"radius_x\":40,\"radius_y\":40}\n",
        ),
        1,
        "huge: the 64 × 64 sensor cuts off 7,200 of 7,200 poses; use a larger sensor, other positions or smaller shapes, or allow it with --allow-cut",
    );
    refused(
        &taxel("model confusion nowhere", ""),
        1,
        "no model or file named \"nowhere\"; models: figures, figures-30, shapes",
    );
    misused(
        "model train parts.jsonl --out m.npz --positions 3",
        "invalid value '3' for '--positions <N>': expected 1, 2, 4, 5, 10, 20, 25, 50 or 100",
    );
}

#[test]
fn training_chooses_missing_sides_of_the_sensor() {
    let place = Place::new();
    place.write(
        "a.jsonl",
        "{\"name\":\"a\",\"figure\":\"ellipse\",\"radius_x\":9,\"radius_y\":9}\n",
    );
    let disc = "model train a.jsonl --positions 2 --angle 0 --json --quiet --out m.npz";
    for (given, columns, rows) in [
        ("", 19, 19),
        ("--columns 40", 40, 19),
        ("--rows 40", 19, 40),
        // The corner is at x0: with 18 cells, one of them begins at 3.5.
        ("--columns 40 --x0 3:3.5:0.5", 40, 19),
        ("--rows 40 --x0 3:3.5:0.5", 22, 40),
    ] {
        let sensor = &place.json(&format!("{disc} {given} --force"))["sensor"];
        assert_eq!(
            (&sensor["columns"], &sensor["rows"]),
            (&columns.into(), &rows.into()),
            "{given}"
        );
    }
    // Small shapes do not make the sensor smaller than 16.
    let small = "model train parts.jsonl --positions 2 --angle 0:330:30 --rows 20 --json --quiet --out small.npz";
    assert_eq!(place.json(small)["sensor"]["columns"], 16);
}

#[test]
fn if_every_sensor_cuts_poses_off_the_message_says_what_helps() {
    let place = Place::new();
    place.write(
        "square.jsonl",
        "{\"name\":\"a\",\"figure\":\"rectangle\",\"length\":3,\"width\":3}\n",
    );
    let square = "model train square.jsonl --x0 0 --y0 0 --quiet --out m.npz";
    let cut = |line: &str, cut: &str| {
        let remedy = "use a larger sensor, other positions or smaller shapes";
        let message = format!("a: the {cut}; {remedy}, or allow it with --allow-cut");
        refused(&place.run(line, ""), 1, &message);
    };
    // When turned, it reaches beyond the left and upper rim.
    cut(square, "16 × 16 sensor cuts off 356 of 360 poses");
    let sensor = &place.json(&format!("{square} --allow-cut --json"))["sensor"];
    assert_eq!(
        (&sensor["columns"], &sensor["rows"]),
        (&16.into(), &16.into())
    );
    place.write(
        "a.jsonl",
        "{\"name\":\"a\",\"figure\":\"ellipse\",\"radius_x\":9,\"radius_y\":9}\n",
    );
    let disc = "model train a.jsonl --angle 0 --quiet --out disc.npz";
    for (given, cut_off) in [
        (
            "--columns 8",
            "8 × 19 sensor cuts off 10,000 of 10,000 poses",
        ),
        (
            "--columns 8 --rows 8 --x0 1 --y0 1",
            "8 × 8 sensor cuts off 1 of 1 poses",
        ),
        (
            "--columns 20 --rows 20 --x0 10 --y0 1",
            "20 × 20 sensor cuts off 1 of 1 poses",
        ),
        (
            "--columns 8 --rows 8 --x0 1 --y0 1 --anchor centre",
            "8 × 8 sensor cuts off 1 of 1 poses",
        ),
    ] {
        cut(&format!("{disc} {given}"), cut_off);
    }
}

#[test]
fn a_shape_of_a_set_has_no_pose() {
    let place = Place::new();
    let refused_at = |line: &str, input: &str, place_and_key: &str| {
        let message = format!(
            "{place_and_key}: a shape of a set has no pose of its own; it is touched in all poses of the grid"
        );
        refused(
            &place.run(&format!("{line} {COARSE} --out m.npz"), input),
            1,
            &message,
        );
    };
    let disc = r#""name":"disc","figure":"ellipse","radius_x":3,"radius_y":3"#;
    for (shape, key) in [
        (format!("{disc},\"angle\":90,\"x0\":900"), "x0"),
        (format!("{disc},\"zoom_x\":2"), "zoom_x"),
        (
            r##""name":"big","imprint":["#.","#."],"zoom_y":1"##.to_owned(),
            "zoom_y",
        ),
    ] {
        let at = format!("standard input: line 1: {key}");
        refused_at("model train -", &format!("{{{shape}}}\n"), &at);
    }
    // The pose of a stored shape belongs to its figure, so it is accepted.
    place.done(&format!("model train washer {COARSE} --out washer.npz"));
}

#[test]
fn damaged_models_are_refused() {
    let place = Place::new();
    place.done("model train parts.jsonl --positions 2 --angle 0:330:30 --quiet --out m.npz");
    let good = place.read("m.npz");
    let numbers = crate::sweep::numbers_in(&good);
    let mut refusals = 0;
    for at in (0..good.len()).step_by(good.len() / 60) {
        let mut bad = good.clone();
        bad[at] ^= 0x55;
        fs::write(place.path("bad.npz"), &bad).expect("written");
        let run = place.run("model confusion bad.npz --json", "");
        let expected = run.status == Some(1) || !numbers[at] && run.status == Some(0);
        assert!(expected, "{at}: {:?} {}", run.status, run.stderr);
        refusals += i32::from(numbers[at]);
    }
    assert!(refusals > 30, "{refusals}");
    for bytes in [&b""[..], b"no archive", &good[..good.len() / 2]] {
        fs::write(place.path("bad.npz"), bytes).expect("written");
        let run = place.run("recognise - --model bad.npz", "#\n");
        assert_eq!(run.status, Some(1));
        assert!(
            run.stderr
                .contains("bad.npz: cannot be read as an atlas or a model"),
            "{}",
            run.stderr
        );
    }
    // An atlas is not a model, and a set of shapes is not one, either.
    place.done("sweep hexagon --x0 5 --y0 5 --angle 0 --quiet --atlas atlas.npz");
    let run = place.run("model show atlas.npz", "");
    let kind = "atlas.npz: an atlas of taxel sweep, expected a model";
    refused(&run, 1, kind);
    let untrained = "parts.jsonl: not a model; if it is a set of shapes, 'taxel model train' makes a model of it";
    for line in [
        "recognise - --model parts.jsonl",
        "model confusion parts.jsonl",
    ] {
        refused(&place.run(line, "#\n"), 1, untrained);
    }
    for (one, other, message) in [
        ("atlas", "m", "m.npz: a model, but atlas.npz is an atlas"),
        ("m", "atlas", "atlas.npz: an atlas, but m.npz is a model"),
    ] {
        refused(
            &place.run(&format!("merge {one}.npz {other}.npz --out all.npz"), ""),
            1,
            &format!("{message}; give the shards of one sweep or of one training"),
        );
    }
}

#[test]
fn the_confusion_matrix_is_exported_to_files() {
    let place = Place::new();
    place.done(&format!(
        "model train rectangles.jsonl {COARSE} --out m.npz"
    ));
    for name in ["m.csv", "m.svg"] {
        place.done(&format!("model confusion m.npz --export {name}"));
    }
    let svg = String::from_utf8(place.read("m.svg")).expect("text");
    let limit = place.json("model confusion m.npz --json");
    let number = limit["confusion"][0][0].to_string();
    assert!(svg.contains(&format!(">{number}</text>")), "{svg}");
    let table = place.done("model confusion m.npz --csv");
    assert_eq!(place.read("m.csv"), table.as_bytes());
    let run = place.run("model confusion m.npz --export m.svg", "");
    refused(&run, 1, "\"m.svg\" already exists; --force replaces it");
    misused(
        "model confusion m.npz --export m.txt",
        "invalid value 'm.txt' for '--export <FILE>': expected a name that ends in .csv or .svg",
    );
}

#[test]
fn names_are_quoted_in_tables_if_necessary() {
    let place = Place::new();
    place.write(
        "odd.jsonl",
        "{\"name\":\"bar, long\",\"figure\":\"rectangle\",\"length\":5,\"width\":2}\n\
         {\"name\":\" é's #1; \",\"figure\":\"rectangle\",\"length\":9,\"width\":2}\n\
         {\"name\":\"a \\\"disc\\\"\",\"figure\":\"ellipse\",\"radius_x\":3,\"radius_y\":3}\n",
    );
    place.done("model train odd.jsonl --positions 1 --angle 0 --quiet --out m.npz");
    assert_eq!(
        place.done("model confusion m.npz --csv"),
        "true,\"bar, long\", é's #1; ,\"a \"\"disc\"\"\"\n\
         \"bar, long\",1,0,0\n \
         é's #1; ,0,1,0\n\
         \"a \"\"disc\"\"\",0,0,1\n"
    );
}

#[test]
fn an_interrupted_training_leaves_no_files() {
    let place = Place::new();
    // Minutes of work.
    let line =
        "model train rectangles.jsonl --x0 10:10.9999:0.0001 --y0 10:10.9999:0.0001 --out m.npz";
    let arguments: Vec<&str> = line.split(' ').collect();
    let mut program = program(&arguments, "C.UTF-8");
    let mut child = program
        .current_dir(place.0.path())
        .spawn()
        .expect("it starts");
    // The program listens for signals before it says what it will do.
    let mut notes = BufReader::new(child.stderr.take().expect("piped"));
    let mut note = String::new();
    notes.read_line(&mut note).expect("a line");
    assert!(note.contains("sensor, threshold 0.5"), "{note}");
    std::thread::sleep(Duration::from_millis(200));
    let start = Instant::now();
    let id = i32::try_from(child.id()).expect("a process");
    let id = rustix::process::Pid::from_raw(id).expect("a process");
    rustix::process::kill_process(id, rustix::process::Signal::TERM).expect("it runs still");
    let mut rest = String::new();
    notes.read_to_string(&mut rest).expect("text");
    let run = finish(child, b"");
    let took = start.elapsed();
    println!("stopped after {took:?}");
    assert!(took < Duration::from_secs(5), "{took:?}");
    assert_eq!(rest, "error: stopped; nothing was written\n");
    assert_eq!((run.status, run.stdout.as_str()), (Some(143), ""));
    assert_eq!(names(place.0.path()), ["parts.jsonl", "rectangles.jsonl"]);
}

/// The real numpy reads a model, if Python has it; with `TAXEL_NUMPY` set, it is required.
#[test]
fn numpy_reads_a_model() {
    if !python_has("numpy") {
        return;
    }
    let place = Place::new();
    place.done(&format!(
        "model train rectangles.jsonl {COARSE} --out m.npz"
    ));
    let limit = place.done("model confusion m.npz --json");
    let check = r"
import sys, json, numpy
model, limit = numpy.load(sys.argv[1]), json.loads(sys.argv[2])
header = json.loads(model['header'].tobytes())
assert header['format'] == 'taxel-model/1' and header['poses'] == 7200, header
assert [shape['name'] for shape in header['shapes']] == limit['labels']
keys, shapes = len(model['height']), len(limit['labels'])
assert keys == limit['keys'] and model['rows'].shape[0] == keys
counts = numpy.zeros((keys, shapes), dtype=numpy.uint64)
counts[model['key'], model['shape']] = model['count']
assert (counts.sum(axis=0) == header['poses']).all()
assert counts.max(axis=1).sum() == limit['right']
assert counts[(counts > 0).sum(axis=1) == 1].sum() == limit['certain']
bits = model['rows'][:, :, None] >> numpy.arange(16, dtype=model['rows'].dtype) & 1
assert (bits.any(axis=2).sum(axis=1) == model['height']).all()
assert (bits.any(axis=1).sum(axis=1) == model['width']).all()
";
    let python = Command::new("python3")
        .args(["-c", check, &place.path("m.npz"), &limit])
        .output()
        .expect("python3 runs");
    let said = String::from_utf8_lossy(&python.stderr);
    assert!(python.status.success(), "{said}");
}

/// A table of 20,000 shapes would take more than 12 GB.
#[test]
fn the_table_of_pairs_is_limited() {
    let place = Place::new();
    let line = |number: u32| {
        format!("{{\"name\":\"{number}\",\"figure\":\"rectangle\",\"length\":2,\"width\":1}}\n")
    };
    let lines: String = (0..4097).map(line).collect();
    fs::write(place.path("many.jsonl"), lines).expect("written");
    let train = "model train many.jsonl --quiet --out";
    place.done(&format!("{train} many.npz --positions 1 --angle 0"));
    for (line, table) in [
        ("model confusion many.npz --pairs", "--pairs"),
        ("model confusion many.npz", "confusion matrix"),
        ("model confusion many.npz --json", "confusion matrix"),
        ("model confusion many.npz --given na", "confusion matrix"),
    ] {
        let run = place.run(line, "");
        let message = format!("{table}: the model has 4097 shapes (allowed: up to 4096)");
        refused(&run, 1, &message);
    }
    // A drawing is limited to fewer shapes. This is found before the file that exists, and so before the work.
    let lines: String = (0..65).map(line).collect();
    place.write("65.jsonl", &lines);
    place.done("model train 65.jsonl --positions 1 --angle 0 --out 65.npz --quiet");
    place.write("there.svg", "");
    let run = place.run(
        "model confusion 65.npz --classifier knn --export there.svg",
        "",
    );
    let message = "there.svg: 65 shapes, and a drawing shows at most 64; .csv takes all";
    refused(&run, 1, message);
}

#[test]
fn identical_shapes_have_no_number_of_touches_until_certainty() {
    let place = Place::new();
    place.write("abc.jsonl", "{\"name\":\"a\",\"figure\":\"ellipse\",\"radius_x\":2,\"radius_y\":2}\n{\"name\":\"b\",\"figure\":\"ellipse\",\"radius_x\":2,\"radius_y\":2}\n{\"name\":\"c\",\"figure\":\"rectangle\",\"length\":6,\"width\":3}\n");
    place.done(&format!("model train abc.jsonl --out t.npz {COARSE}"));
    let text = place.done("model touches t.npz --runs 5 --quiet");
    assert!(
        text.contains("a              –          5 of 5 runs took more than 10,000 touches\n"),
        "{text}"
    );
    assert!(text.ends_with("all shapes     –\n"), "{text}");
    let answer = place.json("model touches t.npz --runs 5 --quiet --json");
    assert_eq!(answer["mean"], Value::Null);
    assert_eq!(answer["shapes"][0]["standard_error"], Value::Null);
    assert!(answer["shapes"][2]["mean"].is_number(), "{answer}");
}

#[test]
fn the_name_of_a_built_in_set_is_preferred_to_a_file_of_that_name() {
    let place = Place::new();
    fs::create_dir(place.path("figures")).expect("a folder");
    let text = place.done("recognise washer");
    assert!(!text.is_empty());
    let run = place.run("recognise washer --model ./figures", "");
    refused(&run, 1, "./figures: cannot read: not a regular file");
    let train = format!("model train parts.jsonl {COARSE} --name");
    for name in ["figures", "Figures-30", "shapes"] {
        let run = place.run(&format!("{train} {name}"), "");
        let message = format!("{name} is the name of a built-in model; choose another name");
        refused(&run, 1, &message);
    }
}

#[test]
fn files_that_cannot_be_used_are_refused_before_any_work() {
    let place = Place::new();
    let run = place.run("model train missing.jsonl --out x.npz", "");
    let message = "missing.jsonl: cannot read: no such file or folder";
    refused(&run, 1, message);
    for shard in ["1/2", "2/2"] {
        let out = format!("part-{}.npz", &shard[..1]);
        place.done(&format!(
            "model train parts.jsonl --shard {shard} --out {out} {COARSE}"
        ));
    }
    place.write("model.csv", "kept");
    let merge = "merge part-1.npz part-2.npz --out model.csv --force --quiet";
    let run = place.run(merge, "");
    refused(
        &run,
        1,
        "model.csv: expected a name that ends in .npz, for a model",
    );
    assert_eq!(place.read("model.csv"), b"kept");
}

#[test]
fn a_shard_of_a_model_can_be_shown_and_merged_but_not_evaluated() {
    let place = Place::new();
    let train = format!("model train parts.jsonl {COARSE} --shard 1/2");
    place.done(&format!("{train} --out half.npz"));
    place.done(&format!("{train} --name half"));
    assert!(place.done("model show half.npz").contains("shard 1/2"));
    let list = place.done("model list");
    assert!(
        list.contains("\nhalf: ") && list.contains(", shard 1/2 of a model\n"),
        "{list}"
    );
    assert_eq!(place.json("model list --json")["shard"], "1/2");
    let said = "half.npz: shard 1/2 of a model only; 'taxel merge' puts shards together";
    for line in [
        "model confusion half.npz",
        "model separate half --scale 1",
        "model touches half.npz",
        "recognise washer --model half",
    ] {
        let run = place.run(line, "");
        assert_eq!(run.status, Some(1), "{line}");
        assert!(run.stderr.contains(said), "{line}: {}", run.stderr);
    }
}

#[test]
fn flags_that_would_be_ignored_are_refused() {
    for (line, message) in [
        (
            "model confusion figures --seed 5",
            "--seed has no effect without --noise or --classifier knn, which draw touches",
        ),
        (
            "model confusion figures --classifier z --neighbours 3",
            "--neighbours has no effect with --classifier z",
        ),
        (
            "model confusion figures --given na --round cg_cd=0.01",
            "--round has no effect for cg_cd, which --given does not name",
        ),
        (
            "model train a.jsonl --out a.npz --positions 10 --x0 5 --y0 5",
            "--positions has no effect with both --x0 and --y0",
        ),
    ] {
        refused(&taxel(line, ""), 2, message);
    }
    for line in [
        "model confusion figures --force",
        "model confusion figures --dead 4 --matrix 16x16 --touches 50 --pairs",
        "model confusion figures --neighbours 3 --greedy",
    ] {
        misused(line, "the following required arguments were not provided");
    }
}

#[test]
fn a_classifier_can_be_given_descriptors() {
    let place = Place::new();
    place.done(&format!("model train parts.jsonl {COARSE} --out m.npz"));
    let error = |more: &str| {
        let line = format!("model confusion m.npz --classifier z {more} --json");
        place.json(&line)["error"].as_f64().expect("a number")
    };
    assert!(error("--given na") > error(""), "less is known");
}

#[test]
fn impossible_requests_are_refused_with_the_reason() {
    let place = Place::new();
    let train = format!("model train parts.jsonl {COARSE}");
    let run = place.run(&format!("{train} --out model.txt"), "");
    refused(
        &run,
        1,
        "model.txt: expected a name that ends in .npz, for a model",
    );
    place.done(&format!("{train} --name parts"));
    // A name that differs only in case is the same name.
    let run = place.run(&format!("{train} --name Parts"), "");
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    assert!(run.stderr.contains("parts.npz"), "{}", run.stderr);
    place.done("model show PARTS");
    for (line, message) in [
        (
            "model separate parts --pitch 1000:2000:1000",
            "--pitch 2000 is out of range (allowed: above 0, up to 1000)",
        ),
        (
            "model confusion parts --noise 0.01 --matrix 3x3",
            "disc: none of its imprints fits on 3 × 3 taxels",
        ),
    ] {
        refused(&place.run(line, ""), 1, message);
    }
    place.done(&format!(
        "model train rectangles.jsonl {COARSE} --out r.npz"
    ));
    let noisy = "model confusion r.npz --noise 0 --touches 5 --matrix 6x6 --json";
    let run = place.run(noisy, "");
    let said = "left out, because they do not fit on 6 × 6: ";
    assert!(run.stderr.contains(said), "{}", run.stderr);
    assert!(
        run.stderr.contains(" % of the poses of c\n"),
        "{}",
        run.stderr
    );
    assert_eq!(place.run(&format!("{noisy} --quiet"), "").stderr, "");
    place.write("there.csv", "kept");
    let run = place.run("model confusion parts --export there.csv", "");
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    assert_eq!(place.read("there.csv"), b"kept");
}

#[test]
fn the_name_of_a_written_file_stays_on_its_line() {
    let place = Place::new();
    let said = place.done("model train washer --out 'a\nright 100 %.npz' --x0 7 --y0 7 --angle 0");
    assert!(
        said.starts_with("written: a\\u{a}right 100 %.npz\n"),
        "{said}"
    );
}
