//! Tests of `taxel model`: training, shards, evaluation, and refusals.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::sweep::{folder, names};
use super::{Run, finish, program, python_has, refused};

/// Two shapes that no touch confuses.
pub(crate) const PARTS: &str = "{\"name\":\"disc\",\"figure\":\"ellipse\",\"radius_x\":3,\"radius_y\":3}\n\
                                {\"name\":\"ring\",\"picture\":\"washer\"}\n";

/// Four rectangles that are hard to tell apart.
const RECTANGLES: &str = "{\"name\":\"a\",\"figure\":\"rectangle\",\"length\":6,\"width\":3}\n\
     {\"name\":\"b\",\"figure\":\"rectangle\",\"length\":6,\"width\":3.2}\n\
     \n\
     {\"name\":\"c\",\"figure\":\"rectangle\",\"length\":6.2,\"width\":3}\n\
     {\"name\":\"d\",\"figure\":\"rectangle\",\"length\":4.2,\"width\":4.2}\n";

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

    /// A place with a model of the rectangles, in the library and in a file.
    pub(crate) fn with_model() -> Self {
        let place = Self::new();
        place.done(&format!("model train rectangles.jsonl {COARSE} --name r"));
        fs::copy(place.path("library/models/r.npz"), place.path("m.npz")).expect("copied");
        place
    }

    pub(crate) fn path(&self, name: &str) -> String {
        self.0.path().join(name).display().to_string()
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).expect("written");
    }

    fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).expect("it is there")
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
            .env("TAXEL_LIBRARY", self.path("library"));
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

    /// Checks that a line with this input is refused for this reason.
    pub(crate) fn refuses(&self, line: &str, input: &str, message: &str) {
        refused(&self.run(line, input), 1, message);
    }

    /// Some lines, each with what it writes.
    pub(crate) fn transcript(&self, command: &str, lines: &[&str]) -> String {
        let text = lines.iter().map(|line| {
            let run = self.run(&format!("{command} {line}"), "");
            let status = run.status.filter(|status| *status > 0);
            let status = status.map_or(String::new(), |status| format!("status {status}\n"));
            format!(
                "$ taxel {command} {line}\n{}{}{status}\n",
                run.stderr, run.stdout
            )
        });
        let text: String = text.collect();
        text.replace(&self.path(""), "FOLDER/")
    }
}

#[test]
fn models_are_trained_shown_and_evaluated_in_every_form() {
    let place = Place::new();
    let train = "model train rectangles.jsonl --positions 10 --angle 0:355:5 --name r";
    let noise = "confusion r --noise 0:0.1:0.05 --touches 50";
    let lines = [
        "list",
        "show r",
        "show r --json",
        "confusion r",
        "confusion r --json",
        "confusion r --csv",
        "confusion r --ascii --given na,p --export m.svg",
        "confusion r --greedy --round cg_cd=0.01",
        "confusion r --greedy --json",
        "confusion r --classifier knn --sample 7 --seed 3",
        "confusion r --classifier z --json",
        "confusion r --test 20 --foreign parts.jsonl washer",
        "confusion r --test 20 --seed 5 --noise 0 --csv",
        "confusion r --test 20 --tolerance 0 --json --foreign washer",
        &format!("{noise} --export noise.svg"),
        &format!("{noise} --json"),
        "touches r --runs 20",
        "touches r --runs 20 --json",
        "delete r",
    ];
    let text = place.transcript("", &[train]) + &place.transcript("model", &lines);
    insta::assert_snapshot!("model", text);
    let file = |name| String::from_utf8(place.read(name)).expect("text");
    assert!(
        file("m.svg").contains(">57.2 %</text>"),
        "{}",
        file("m.svg")
    );
    let drawn = file("noise.svg");
    assert!(drawn.contains(">named right</text>") && drawn.contains(">noise</text>"));
}

#[test]
fn each_flag_of_an_evaluation_counts() {
    let place = Place::with_model();
    let right = |asked: &str| {
        let answer = place.json(&format!("model confusion r --json {asked}"));
        answer["right"].as_u64().expect("a count")
    };
    assert!(right("--given cg_cd --round cg_cd=0.1") < right("--given cg_cd"));
    assert!(right("--classifier z --given na") < right("--classifier z"));
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
    let shards = "part-1.npz part-2.npz part-3.npz";
    for (line, message) in [
        (
            "part-1.npz part-3.npz --out no.npz",
            "1 of 3 shards is missing: 2",
        ),
        (
            &format!("{shards} --out ./part-1.npz --force"),
            "part-1.npz: one of the shards; write to another file",
        ),
        (
            &format!("{shards} --out a.csv"),
            "a.csv: expected a name that ends in .npz, for a model",
        ),
    ] {
        place.refuses(&format!("merge {line} --quiet"), "", message);
    }
    assert!(!names(place.0.path()).contains(&"no.npz".to_owned()));
    // A shard can be shown, but it answers no touches.
    place.done(&format!("{train} --shard 1/2 --name half"));
    assert!(place.done("model show half").contains("shard 1/2"));
    assert!(
        place
            .done("model list")
            .contains(", shard 1/2 of a model\n")
    );
    for line in [
        "model confusion",
        "model separate --scale 1",
        "recognise washer --model",
    ] {
        let run = place.run(&format!("{line} half"), "");
        let said = "half.npz: shard 1/2 of a model only; 'taxel merge' puts shards together";
        assert!(
            run.status == Some(1) && run.stderr.contains(said),
            "{line}: {}",
            run.stderr
        );
    }
}

/// Shapes of a set come from anywhere: files, standard input, the library.
#[test]
fn shapes_come_from_files_and_the_library() {
    let place = Place::new();
    place.done("library save mine washer");
    place.write("more.jsonl", "{\"name\":\"big disc\",\"figure\":\"ellipse\",\"radius_x\":5,\"radius_y\":5}\n{\"name\":\"key\",\"picture\":\"key\"}\n");
    let run = place.run(
        &format!("model train rectangles.jsonl - mine more.jsonl {COARSE} --out all.npz"),
        "{\"name\":\"corner\",\"imprint\":[\"##\",\"#.\"],\"weight\":2}\r\n",
    );
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    let card = place.json("model show all.npz --json");
    let shapes = card["shapes"].as_array().expect("shapes").iter();
    let shapes: Vec<_> = shapes.filter_map(|shape| shape["name"].as_str()).collect();
    assert_eq!(
        shapes,
        ["a", "b", "c", "d", "corner", "mine", "big disc", "key"]
    );
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
        let said = "each touch counts with the weight of its shape\n";
        let noise = "model confusion m.npz --noise 0:0.2:0.1 --touches 20";
        for output in [
            run.stdout,
            place.done("model confusion m.npz"),
            place.done(noise),
        ] {
            assert_eq!(output.contains(said), counted, "{weights:?}: {output}");
        }
        let table = place.json(&format!("{noise} --json"));
        for row in table["degradation"].as_array().expect("rows") {
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
    let disc = r#""figure":"ellipse","radius_x":3,"radius_y":3"#;
    let no_pose = |key: &str| {
        format!(
            "standard input: line 1: {key}: a shape of a set has no pose of its own; it is touched in all poses of the grid\n"
        )
    };
    for (input, message) in [
        (
            format!("{{\"name\":\"a\",{disc}}}\n{{{disc}}}\n"),
            "standard input: line 2: name: missing; every shape of a set needs one\n".to_owned(),
        ),
        (
            format!("{{\"name\":\"a\",{disc}}}\n\n{{\"name\":\"a\",{disc}}}\n"),
            "two shapes are named \"a\"; give each its own name\n".to_owned(),
        ),
        (
            "{\"name\":\"a\"".to_owned(),
            "standard input: line 1, column 11: ".to_owned(),
        ),
        (
            "{\"name\":\"a\",\"picture\":\"no such\"}".to_owned(),
            "standard input: line 1: picture".to_owned(),
        ),
        (
            "\n \n".to_owned(),
            "standard input: no shapes, expected a line of JSON for each\n".to_owned(),
        ),
        (
            format!("{{\"name\":\"disc\",{disc},\"angle\":90,\"x0\":900}}"),
            no_pose("x0"),
        ),
        (
            r##"{"name":"big","imprint":["#.","#."],"zoom_y":1}"##.to_owned(),
            no_pose("zoom_y"),
        ),
    ] {
        let run = place.run(&format!("model train - {COARSE} --out m.npz"), &input);
        assert_eq!((run.status, run.stdout.as_str()), (Some(1), ""), "{input}");
        let begins = run.stderr.starts_with(&format!("error: {message}"));
        assert!(
            begins && run.stderr.lines().count() == 1,
            "{input}: {}",
            run.stderr
        );
    }
}

#[test]
fn training_chooses_missing_sides_of_the_sensor() {
    let place = Place::new();
    place.write(
        "a.jsonl",
        "{\"name\":\"a\",\"figure\":\"ellipse\",\"radius_x\":9,\"radius_y\":9}\n",
    );
    let disc = "model train a.jsonl --positions 2 --angle 0 --json --quiet --out m.npz --force";
    // Small shapes do not make the sensor smaller than 16.
    let small = "model train parts.jsonl --positions 2 --angle 0:330:30 --rows 20 --json --quiet --out small.npz";
    for (line, columns, rows) in [
        (disc.to_owned(), 19, 19),
        (format!("{disc} --columns 40"), 40, 19),
        (format!("{disc} --rows 40"), 19, 40),
        // The corner is at x0: with 18 cells, one of them begins at 3.5.
        (format!("{disc} --columns 40 --x0 3:3.5:0.5"), 40, 19),
        (format!("{disc} --rows 40 --x0 3:3.5:0.5"), 22, 40),
        (small.to_owned(), 16, 20),
    ] {
        let sensor = &place.json(&line)["sensor"];
        assert_eq!(
            (&sensor["columns"], &sensor["rows"]),
            (&columns.into(), &rows.into()),
            "{line}"
        );
    }
}

#[test]
fn damaged_models_are_refused() {
    let place = Place::new();
    place.done("model train parts.jsonl --positions 2 --angle 0:330:30 --quiet --out m.npz");
    let good = place.read("m.npz");
    for bytes in [&b""[..], b"no archive", &good[..good.len() / 2]] {
        fs::write(place.path("bad.npz"), bytes).expect("written");
        let run = place.run("recognise - --model bad.npz", "#\n");
        assert_eq!(run.status, Some(1));
        let said = "bad.npz: cannot be read as an atlas or a model";
        assert!(run.stderr.contains(said), "{}", run.stderr);
    }
    // An atlas is not a model, and a set of shapes is not one, either.
    place.done("sweep hexagon --x0 5 --y0 5 --angle 0 --quiet --atlas atlas.npz");
    let untrained = "parts.jsonl: not a model; if it is a set of shapes, 'taxel model train' makes a model of it";
    for (line, message) in [
        (
            "model show atlas.npz",
            "atlas.npz: an atlas of taxel sweep, expected a model",
        ),
        ("recognise - --model parts.jsonl", untrained),
        ("model confusion parts.jsonl", untrained),
    ] {
        place.refuses(line, "#\n", message);
    }
}

#[test]
fn names_are_quoted_in_tables_and_messages_if_necessary() {
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
    let said = place.done("model train washer --out 'a\nright 100 %.npz' --x0 7 --y0 7 --angle 0");
    assert!(
        said.starts_with("written: a\\u{a}right 100 %.npz\n"),
        "{said}"
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
    assert!(
        start.elapsed() < Duration::from_secs(5),
        "{:?}",
        start.elapsed()
    );
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
    let place = Place::with_model();
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

#[test]
fn identical_shapes_have_no_number_of_touches_until_certainty() {
    let place = Place::new();
    place.write("abc.jsonl", "{\"name\":\"a\",\"figure\":\"ellipse\",\"radius_x\":2,\"radius_y\":2}\n{\"name\":\"b\",\"figure\":\"ellipse\",\"radius_x\":2,\"radius_y\":2}\n{\"name\":\"c\",\"figure\":\"rectangle\",\"length\":6,\"width\":3}\n");
    place.done(&format!("model train abc.jsonl --out t.npz {COARSE}"));
    let card = place.done("model show t.npz");
    assert!(
        card.contains("\nnever certain, since other shapes leave the same: a, b\n"),
        "{card}"
    );
    let text = place.done("model touches t.npz --runs 5 --quiet");
    assert!(
        text.contains("–          5 runs took more than 10,000 touches\n"),
        "{text}"
    );
    let answer = place.json("model touches t.npz --runs 5 --quiet --json");
    assert_eq!(answer["mean"], Value::Null);
    assert_eq!(answer["shapes"][0]["standard_error"], Value::Null);
    assert!(answer["shapes"][2]["mean"].is_number(), "{answer}");
}

#[test]
fn what_cannot_be_done_is_refused_with_the_reason() {
    let place = Place::with_model();
    place.write("there.svg", "kept");
    place.write(
        "t.jsonl",
        "{\"name\":\"t\",\"figure\":\"triangle\",\"side\":11.77}\n",
    );
    let shape = |number: u32| {
        format!("{{\"name\":\"{number}\",\"figure\":\"rectangle\",\"length\":2,\"width\":1}}\n")
    };
    for (file, shapes) in [("many", 4097), ("65", 65)] {
        place.write("set.jsonl", &(0..shapes).map(shape).collect::<String>());
        let train = "model train set.jsonl --positions 1 --angle 0 --quiet";
        place.done(&format!("{train} --out {file}.npz"));
    }
    // A built-in set precedes a file of its name.
    fs::create_dir(place.path("figures")).expect("a folder");
    assert!(!place.done("recognise washer").is_empty());
    let cut = "--x0 5:5.9:0.1 --y0 5:5.9:0.1 --angle 0:350:10 --columns 16 --rows 16 --quiet";
    let lines = [
        "train missing.jsonl --out m.npz",
        "train parts.jsonl --positions 1 --out model.txt",
        "train parts.jsonl --positions 3 --out m.npz",
        "train parts.jsonl --positions 10 --x0 5 --y0 5 --out a.npz",
        "train parts.jsonl --name Figures-30",
        // A name that differs only in case is the same name.
        "train parts.jsonl --name R",
        &format!("train t.jsonl {cut} --out cut.npz"),
        &format!("train t.jsonl {cut} --out cut.npz --allow-cut"),
        "show ./figures",
        "delete figures",
        "delete nowhere",
        "confusion nowhere",
        "confusion r --seed 5",
        "confusion r --classifier z --neighbours 3",
        "confusion r --given na --round cg_cd=0.01",
        "confusion r --force",
        "confusion r --touches 50 --greedy",
        "confusion r --given na,cg",
        "confusion r --test 5 --noise 0:0.1:0.1",
        "confusion r --test 5 --foreign rectangles.jsonl",
        "confusion r --test 5 --export m.svg",
        "confusion r --greedy --round cg_cd=0",
        "confusion r --export m.txt",
        "confusion r --export there.svg",
        "confusion r --noise 0.01 --given na",
        // A table of 20,000 shapes would take more than 12 GB.
        "confusion many.npz --json",
        "confusion 65.npz --classifier knn --export m.svg",
    ];
    insta::assert_snapshot!("refused", place.transcript("model", &lines));
    assert_eq!(place.read("there.svg"), b"kept");
}
