//! Hostile input: random and mutated bytes, and a mebibyte of each kind of malice. The program must not panic, and may
//! use at most 64 MiB of memory, or 320 MiB if a recording must be unpacked completely ([`malice::UNPACKED`]). Times
//! are printed, not checked: `cargo test --release --test files hostile -- --nocapture --test-threads=1` measures
//! them.

mod bodies;

mod found;

pub(crate) mod malice;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use self::bodies::{BODIES, body};
use crate::property::config;
use proptest::collection::vec;
use proptest::prelude::*;
use taxel::tui::app::Message;

/// Returns the usual inputs of a body, with their names.
fn seeds(folder: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/files/hostile/seeds")
        .join(folder);
    let files = std::fs::read_dir(folder).expect("every body has usual inputs");
    let mut files: Vec<_> = files
        .map(|file| file.expect("the folder can be read").path())
        .collect();
    files.sort();
    let read = |path: &PathBuf| {
        let name = path.file_name().expect("a file").to_string_lossy();
        let bytes = std::fs::read(path).expect("a file that can be read");
        (name.into_owned(), bytes)
    };
    files.iter().map(read).collect()
}

/// Changes of some bytes: the place, the number of bytes to remove, the bytes to insert.
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
    #![proptest_config(config(600))]

    #[test]
    fn random_bytes_cause_no_panic(index in 0..BODIES.len(), bytes in vec(any::<u8>(), 0..200)) {
        BODIES[index].2(&bytes);
    }

    #[test]
    fn mutated_bytes_are_read_or_refused(
        index in 0..BODIES.len(), seed in any::<usize>(), changes in changes()
    ) {
        let (_, folder, read) = BODIES[index];
        let mut seeds = seeds(folder);
        let (_, mut bytes) = seeds.swap_remove(seed % seeds.len());
        for (at, gone, new) in changes {
            let at = at % (bytes.len() + 1);
            let end = (at + gone).min(bytes.len());
            bytes.splice(at..end, new);
        }
        read(&bytes);
    }
}

#[test]
fn usual_inputs_are_read() {
    for (body, folder, read) in BODIES {
        for (name, seed) in seeds(folder) {
            let is_read = read(&seed);
            // Two bodies change the arrays of a valid archive, which may then be refused.
            let changes = folder.ends_with("arrays") && name != "nothing";
            assert!(is_read || changes, "{body} refuses its seed {name}");
        }
    }
}

/// A paste is accepted anywhere as far as there is room, and the program continues.
#[test]
fn a_mebibyte_can_be_pasted_anywhere() {
    for (opens, leaves) in [
        ("", "q"),
        ("f<Tab>", "<Esc>q"),
        ("S", "<Esc>q"),
        ("l", "<Esc>q"),
        (":", "<Esc>q"),
        (" s", "<Esc>qy"),
        ("?", "<Esc>q"),
    ] {
        let mut session = bodies::session_of(opens);
        for text in ["7", "a\n", "\u{301}", "\x1b[2J"] {
            let times = malice::SIZE / text.len();
            session.send(Message::Paste(text.repeat(times)));
            let screen = session.screen();
            assert_eq!(screen.lines().count(), 24, "{opens:?}, {text:?}");
            assert!(!screen.contains('\x1b'), "{opens:?}, {text:?}: {screen}");
        }
        session.keys(leaves).expect("the keys are right");
        assert!(session.app().ended(), "{opens:?}: {}", session.screen());
    }
}

const VARIABLE: &str = "TAXEL_HOSTILE";

/// Runs one input; this test runs in a process of its own, with a variable that names the input.
#[test]
#[ignore = "only as a child of other tests"]
fn one() {
    let asked = std::env::var(VARIABLE).expect("a body and a malice");
    let (name, malice) = asked.split_once(':').expect("a body and a malice");
    let index: usize = malice.parse().expect("a number");
    let bytes = malice::bytes(name, index);
    assert!(bytes.len() >= malice::SIZE / 2 && bytes.len() <= malice::SIZE);
    let start = Instant::now();
    body(name)(&bytes);
    println!("TOOK {} µs", start.elapsed().as_micros());
    // The highest memory use of this process so far.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    if let Some(line) = status.lines().find(|line| line.starts_with("VmHWM:")) {
        println!("{line}");
    }
}

/// Reads the number after a word.
fn number(said: &str, word: &str) -> Option<u64> {
    let line = said.lines().find(|line| line.contains(word))?;
    let digits = line.split(word).nth(1)?.trim().split(' ').next()?;
    digits.parse().ok()
}

/// Each input runs in a process of its own, two at a time: the processes do all the work. Some bodies take much longer
/// than others, so each thread takes the next one that is left.
#[test]
fn a_mebibyte_of_malicious_input_takes_little_memory() {
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some((name, ..)) = BODIES.get(next.fetch_add(1, Ordering::Relaxed)) {
                    all_malice(name);
                }
            });
        }
    });
}

/// Runs all malicious inputs of a body.
fn all_malice(name: &str) {
    let mut slowest = (0, "");
    let mut largest = (0, "");
    for (index, (what, _)) in malice::all(name).into_iter().enumerate() {
        let output = Command::new(std::env::current_exe().expect("this binary"))
            .args(["--exact", "hostile::one", "--ignored", "--nocapture"])
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
        let memory = number(&said, "VmHWM:");
        // Other systems do not report it.
        assert!(memory.is_some() || !cfg!(target_os = "linux"), "{said}");
        let kibibytes = memory.unwrap_or_default();
        let most = match name {
            _ if what == malice::UNPACKED => 320,
            // The parser of TOML makes a table of each part of a key, that of XML keeps the start of each line.
            "config" | "svg" => 128,
            _ => 64,
        };
        assert!(kibibytes <= most << 10, "{name}, {what}: {kibibytes} KiB");
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
