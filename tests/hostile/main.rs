//! Hostile input: random and mutated bytes, and a mebibyte of each kind of malice. No panic, at most 64 MiB. The times
//! are told, not held: `cargo test --release --test hostile -- --nocapture --test-threads=1` measures them.

mod bodies;

mod malice;

use std::process::{Command, Stdio};
use std::time::Instant;

use proptest::collection::vec;
use proptest::prelude::*;

/// A body with what it usually gets.
type Body = (&'static str, fn(&[u8]), &'static [&'static str]);

const SHAPE: &str = r###"{"format":"taxel-shape/1","name":"washer","sensor":{"columns":3,"rows":2,"pitch_mm":1.0,"threshold":0.5},"imprint":["##.","#.."],"source":{"figure":"ellipse","radius_x":1.0,"radius_y":1.0,"x0":1.99,"y0":-1.47,"angle":0,"thickness":2.0}}"###;
const PICTURED: &str = r###"{"format":"taxel-shape/1","name":"é","sensor":{"columns":1,"rows":1},"imprint":["#"],"source":{"picture":["##","#."],"x0":0,"y0":1,"angle":10,"zoom_x":0.84,"zoom_y":0.75}}"###;

const BODIES: [Body; 4] = [
    ("shape", bodies::shape, &[SHAPE, PICTURED]),
    (
        "job",
        bodies::job,
        &[
            r#"{"figure":"hexagon","side":3.0,"x0":2.1,"y0":1.35,"angle":17,"thickness":1.0}"#,
            r###"{"picture":["##","#."],"x0":5.75,"y0":3.87,"angle":10,"zoom_x":0.84,"zoom_y":0.75}"###,
            r#"{"picture":"washer","x0":2.0,"y0":2.0,"angle":0,"zoom_x":1.0,"zoom_y":1.0}"#,
            r##"{"imprint":["..","#."],"sensor":{"columns":32,"rows":32,"threshold":0.5}}"##,
        ],
    ),
    ("imprint", bodies::imprint, &[".##.\n#..#\n.##.\n", "#\r\n"]),
    (
        "keys",
        bodies::keys,
        &["f<3x:Down><Tab>4.00<C-u><lt>>é<Enter>", "<S-Left><gt>"],
    ),
];

fn body(index: usize) -> Body {
    BODIES[index]
}

/// A change of some bytes: where, how many go, what comes.
fn changes() -> impl Strategy<Value = Vec<(usize, usize, Vec<u8>)>> {
    let piece = prop_oneof![
        vec(any::<u8>(), 0..4),
        proptest::sample::select(
            &[
                "\"", "\\", "{", "}", "[", "]", ",", ":", "1e999", "-0", "null", "\u{fffd}", "<",
                ">", "9x:"
            ][..]
        )
        .prop_map(|piece| piece.as_bytes().to_vec()),
    ];
    vec((any::<usize>(), 0..5_usize, piece), 1..6)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn random_bytes_are_refused(index in 0..BODIES.len(), bytes in vec(any::<u8>(), 0..200)) {
        body(index).1(&bytes);
    }

    #[test]
    fn mutated_bytes_are_read_or_refused(
        index in 0..BODIES.len(), seed in any::<usize>(), changes in changes()
    ) {
        let (_, read, seeds) = body(index);
        let mut bytes = seeds[seed % seeds.len()].as_bytes().to_vec();
        for (at, gone, new) in changes {
            let at = at % (bytes.len() + 1);
            let end = (at + gone).min(bytes.len());
            bytes.splice(at..end, new);
        }
        read(&bytes);
    }
}

#[test]
fn what_is_usual_is_read() {
    for (_, read, seeds) in BODIES {
        for seed in seeds {
            read(seed.as_bytes());
        }
    }
    assert!(taxel::formats::shape::Shape::read(SHAPE.as_bytes()).is_ok());
    assert!(taxel::formats::shape::Shape::read(PICTURED.as_bytes()).is_ok());
}

const VARIABLE: &str = "TAXEL_HOSTILE";

/// One input in a process of its own, which this test is when the variable is set.
#[test]
fn one() {
    let Ok(asked) = std::env::var(VARIABLE) else {
        return;
    };
    let (name, malice) = asked.split_once(':').expect("a body and a malice");
    let (_, read, _) = BODIES
        .into_iter()
        .find(|(own, ..)| *own == name)
        .expect("known");
    let index: usize = malice.parse().expect("a number");
    let bytes = malice::all(name)[index].1();
    assert!(bytes.len() >= malice::SIZE / 2 && bytes.len() <= malice::SIZE);
    let start = Instant::now();
    read(&bytes);
    println!("TOOK {} µs", start.elapsed().as_micros());
    // The most memory that this process has ever had.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    if let Some(line) = status.lines().find(|line| line.starts_with("VmHWM:")) {
        println!("{line}");
    }
}

/// Reads a number behind a word.
fn number(said: &str, word: &str) -> Option<u64> {
    let line = said.lines().find(|line| line.contains(word))?;
    let digits = line.split(word).nth(1)?.trim().split(' ').next()?;
    digits.parse().ok()
}

#[test]
fn a_mebibyte_of_malice_takes_little_memory() {
    for (name, ..) in BODIES {
        let mut slowest = (0, "");
        let mut largest = (0, "");
        for (index, (what, _)) in malice::all(name).into_iter().enumerate() {
            let output = Command::new(std::env::current_exe().expect("this binary"))
                .args(["--exact", "one", "--nocapture"])
                .env(VARIABLE, format!("{name}:{index}"))
                .stderr(Stdio::piped())
                .output()
                .expect("it runs");
            let said = String::from_utf8_lossy(&output.stdout).into_owned();
            assert!(
                output.status.success(),
                "{name}, {what}: {said}{}",
                String::from_utf8_lossy(&output.stderr)
            );
            let took = number(&said, "TOOK").expect("it says how long it took");
            slowest = slowest.max((took, what));
            // Only where the system tells.
            let kibibytes = number(&said, "VmHWM:").unwrap_or_default();
            assert!(kibibytes <= 64 << 10, "{name}, {what}: {kibibytes} KiB");
            largest = largest.max((kibibytes, what));
        }
        eprintln!(
            "{name}: at most {} µs ({}), the process at most {} MiB ({})",
            slowest.0,
            slowest.1,
            largest.0 >> 10,
            largest.1
        );
    }
}
