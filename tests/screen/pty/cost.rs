//! The costs of the program: bytes, wake-ups, memory, time. The numbers are printed:
//! `cargo test --test screen pty -- --nocapture`.

use std::time::{Duration, Instant};

use super::program::{Program, Start};
use super::screens::session;

/// The highest number of bytes for a move of the cursor.
const MOVE: usize = 60;
/// The highest number of bytes for a toggle: fourteen descriptors change, whose new digits alone take 70 bytes.
const TOGGLE: usize = 158;
/// The highest number of bytes for the first toggle on an empty matrix: all descriptors appear, and the hints about what
/// is there.
const FIRST_TOGGLE: usize = 290;

#[test]
fn screens_of_80_x_24_take_few_bytes() {
    // The programs run together, because each test mostly waits for its program.
    std::thread::scope(|scope| {
        for variables in [
            &[("TERM", "xterm-256color"), ("LANG", "C.UTF-8")],
            &[("TERM", "xterm"), ("LANG", "C.UTF-8")],
            &[("TERM", "linux"), ("LANG", "C")],
            &[("TERM", "vt100"), ("LANG", "C")],
            &[("TERM", "dumb"), ("LANG", "C")],
        ] {
            scope.spawn(move || bytes_with(variables));
        }
    });
}

fn bytes_with(variables: &[(&str, &str)]) {
    let mut program = Program::start(&Start {
        variables,
        ..Start::default()
    });
    let ascii = !variables.contains(&("LANG", "C.UTF-8"));
    let mut script = session(ascii, (80, 24));
    let first = program.written(|program| program.shows("? Help"));
    println!(
        "{variables:?}: first frame {first} bytes in {} reads",
        program.reads
    );
    assert!(first <= 2200, "first frame: {first} bytes");
    let mut over = Vec::new();
    let mut press = |name: &str, notation: &str, bytes: &[u8], most: usize| {
        let written = program.written(|program| {
            program.types(bytes);
            script.keys(notation).expect("keys");
            if variables.contains(&("TERM", "dumb")) {
                program.agrees_plainly(&script);
            } else {
                program.agrees(&script);
            }
        });
        println!("  {name}: {written} bytes");
        if std::env::var_os("PTY_SHOW").is_some() {
            let sent = &program.bytes[program.bytes.len() - written..];
            println!("    {}", String::from_utf8_lossy(sent).escape_debug());
        }
        if written > most {
            over.push(format!("{name}: {written} bytes, at most {most}"));
        }
    };
    let arrows: [(&str, &str, &[u8]); 4] = [
        ("left", "<Left>", b"\x1b[D"),
        ("up", "<Up>", b"\x1b[A"),
        ("right", "<Right>", b"\x1b[C"),
        ("down", "<Down>", b"\x1b[B"),
    ];
    for (name, notation, bytes) in arrows {
        press(name, notation, bytes, MOVE);
    }
    // Esc does nothing here; bytes that it wrote would be counted with the move.
    press(
        "nothing, then right",
        "<Esc><Right>",
        b"\x1b\x1b\x1b[C",
        MOVE,
    );
    press("a figure", "f<CR>", b"f\r", 4000);
    // Over the whole figure, its edges and the corners of the matrix.
    for (turns, index) in [(10, 0), (5, 1), (10, 2), (6, 3), (12, 0), (7, 1)] {
        let (name, notation, bytes) = arrows[index];
        for turn in 0..turns {
            press(&format!("{name} {turn} on a figure"), notation, bytes, MOVE);
        }
    }
    press("first column", "<Home>", b"\x1b[H", MOVE);
    press("last row", "<PageDown>", b"\x1b[6~", MOVE);
    press("last column", "<End>", b"\x1b[F", MOVE);
    press("first row", "<PageUp>", b"\x1b[5~", MOVE);
    press(
        "to the middle",
        "<8x:Left><8x:Down>",
        &b"\x1b[D\x1b[B".repeat(8),
        8 * 2 * MOVE,
    );
    press("toggle that makes a hole", "<Space>", b" ", TOGGLE);
    press("toggle back", "<Space>", b" ", TOGGLE);
    press("help", "?", b"?", 2500);
    // The menu of the matrix appears again.
    press("help closed", "<Esc>", b"\x1b\x1b", 2590);
    press("empty", "n", b"n", 2500);
    press("first toggle", "<Space>", b" ", FIRST_TOGGLE);
    for name in ["second toggle", "third toggle"] {
        press("right, off an active taxel", "<Right>", b"\x1b[C", MOVE);
        press(name, "<Space>", b" ", TOGGLE);
    }
    assert!(over.is_empty(), "{variables:?}: {over:#?}");
}

#[test]
fn an_idle_program_does_not_wake_up() {
    // Both run together, because they mostly wait.
    std::thread::scope(|scope| {
        scope.spawn(it_idles_after_its_start);
        scope.spawn(it_idles_after_a_stopped_sweep);
    });
}

fn it_idles_after_its_start() {
    let mut program = Program::start(&Start::default());
    program.written(|program| program.shows("? Help"));
    let switches = |program: &Program| (program.status("voluntary_ctxt_switches"), program.cpu());
    // On a busy machine, the program may not be idle yet.
    let mut before = switches(&program);
    program.until("sleep", |program| {
        program.read(Duration::from_millis(500));
        let now = switches(program);
        std::mem::replace(&mut before, now) == now
    });
    let written = program.bytes.len();
    let end = Instant::now() + Duration::from_secs(10);
    while let Some(left) = end.checked_duration_since(Instant::now()) {
        program.read(left);
    }
    let after = switches(&program);
    let written = program.bytes.len() - written;
    println!(
        "10 idle seconds: {} wake-ups, {written} bytes; resident {} kB",
        after.0 - before.0,
        program.status("VmHWM")
    );
    assert_eq!((after, written), (before, 0));
    // For the build of the tests: 1.3 MB were measured, and 12 MB together with the pages of the program file, of which
    // the system maps more or fewer.
    assert!(program.status("RssAnon") <= 2 * 1024);
    assert!(program.status("VmHWM") <= 14 * 1024);
}

/// A sweep wakes the program about ten times a second; after it was stopped, nothing does.
fn it_idles_after_a_stopped_sweep() {
    let mut program = Program::started(&Start::default());
    program.types(b"fr\r:explore --x0 0:9.999:0.001 --y0 0:9.999:0.001\r");
    program.shows("poses a second");
    program.types(b"\x1b\x1b");
    program.shows("a part: ");
    let count = |program: &Program| (program.wake_ups(), program.bytes.len());
    // Threads take a moment to fall asleep, longer on a busy machine; then nothing happens for three seconds.
    let still = (0..10).any(|_| {
        let before = count(&program);
        let end = Instant::now() + Duration::from_secs(3);
        while let Some(left) = end.checked_duration_since(Instant::now()) {
            program.read(left);
        }
        count(&program) == before
    });
    assert!(
        still,
        "wake-ups of each thread, and bytes: {:?}",
        count(&program)
    );
}

#[test]
fn the_first_frame_is_drawn() {
    // The time is printed, not checked: the machine may be busy.
    let times = (0..7).map(|_| {
        let start = Instant::now();
        Program::started(&Start::default());
        start.elapsed()
    });
    // This includes the time of the launcher.
    println!("started and drawn in {:?}", times.min().expect("some"));
}
