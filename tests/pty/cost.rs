//! What it costs: bytes, wake-ups, memory, time. The figures are printed: `cargo test --test pty -- --nocapture`.

use std::time::{Duration, Instant};

use crate::program::{Program, Start};
use crate::screens::session;

#[test]
fn bytes_at_80_x_24() {
    for variables in [
        &[("TERM", "xterm-256color"), ("LANG", "C.UTF-8")][..],
        &[("TERM", "xterm"), ("LANG", "C.UTF-8")],
        &[("TERM", "linux"), ("LANG", "C")],
        &[("TERM", "vt100"), ("LANG", "C")],
        &[("TERM", "dumb"), ("LANG", "C")],
    ] {
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
        let mut press = |name: &str, notation: &str, bytes: &[u8], most: usize| {
            let written = program.written(|program| {
                program.types(bytes);
                script.keys(notation).expect("keys");
                let rows = script.screen();
                program.until(name, |program| program.rows() == rows.trim_end());
            });
            println!("  {name}: {written} bytes");
            assert!(written <= most, "{name}: {written} bytes, at most {most}");
        };
        press("cursor right", "<Right>", b"\x1b[C", 60);
        press("cursor down", "<Down>", b"\x1b[B", 60);
        press("cursor left", "<Left>", b"\x1b[D", 60);
        press("cursor up", "<Up>", b"\x1b[A", 60);
        press("nothing", "<Esc>", b"\x1b\x1b", 0);
        press("a figure", "f<CR>", b"f\r", 4000);
        press("cursor up on a figure", "<Up>", b"\x1b[A", 60);
        press("cursor left on a figure", "<Left>", b"\x1b[D", 60);
        // These change eight and more descriptors, and two lines at the foot.
        press("toggle that makes a hole", "<Space>", b" ", 200);
        press("toggle back", "<Space>", b" ", 200);
        press("help", "?", b"?", 2500);
        press("help closed", "<Esc>", b"\x1b\x1b", 2500);
        press("empty", "n", b"n", 2500);
        press("first toggle", "<Space>", b" ", 1000);
        press("cursor from active to inactive", "<Right>", b"\x1b[C", 80);
        press("second toggle", "<Space>", b" ", 200);
        press("cursor from active to inactive", "<Right>", b"\x1b[C", 80);
        press("third toggle", "<Space>", b" ", 200);
    }
}

#[test]
fn nothing_is_done_for_nothing() {
    let mut program = Program::start(&Start::default());
    program.written(|program| program.shows("? Help"));
    let switches = |program: &Program| (program.status("voluntary_ctxt_switches"), program.cpu());
    let before = switches(&program);
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
    assert!(program.status("VmHWM") <= 8 * 1024);
}

#[test]
fn the_first_frame_comes_quickly() {
    let times = (0..7).map(|_| {
        let start = Instant::now();
        Program::started(&Start::default());
        start.elapsed()
    });
    // The launcher's own time is in it.
    println!("started and drawn in {:?}", times.min().expect("some"));
}
