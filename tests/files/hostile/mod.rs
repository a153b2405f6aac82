//! Hostile input: random and mutated bytes, and a mebibyte of each kind of malice. No panic, and at most 64 MiB of memory;
//! 320 MiB where a recording must be unpacked as a whole ([`malice::UNPACKED`]). Times are printed, not judged:
//! `cargo test --release --test files hostile -- --nocapture --test-threads=1` measures them.

mod bodies;

mod found;

mod malice;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use self::bodies::{BODIES, body};
use proptest::collection::vec;
use proptest::prelude::*;
use taxel::tui::app::message::Message;

/// The usual inputs of a body, by their names.
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
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn random_bytes_do_no_harm(index in 0..BODIES.len(), bytes in vec(any::<u8>(), 0..200)) {
        BODIES[index].2(&bytes);
    }

    #[test]
    fn mutated_bytes_are_read_or_refused(
        index in 0..BODIES.len(), seed in any::<usize>(), changes in changes()
    ) {
        let (_, folder, read) = BODIES[index];
        let (_, mut bytes) = seeds(folder).swap_remove(seed % seeds(folder).len());
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
    for (body, folder, read) in BODIES {
        for (name, seed) in seeds(folder) {
            let is_read = read(&seed);
            // Two bodies change the arrays of a sound archive, which may be refused then.
            let changes = folder.ends_with("arrays") && name != "nothing";
            assert!(is_read || changes, "{body} refuses its seed {name}");
        }
    }
}

/// Wherever text can be pasted, so much of it is taken as there is room for, and the program goes on.
#[test]
fn a_mebibyte_is_pasted_everywhere() {
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

/// One input in a process of its own, which this test is when the variable is set.
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

/// Each in a process of its own, two at a time: the processes do all the work. Some bodies take much longer than others, so
/// each thread takes the next one that is left.
#[test]
fn a_mebibyte_of_malice_takes_little_memory() {
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

/// All malice for one body.
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
        // Only where the system tells.
        let kibibytes = number(&said, "VmHWM:").unwrap_or_default();
        let most = if what == malice::UNPACKED { 320 } else { 64 };
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
