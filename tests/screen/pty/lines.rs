//! What the program costs a line: bytes and wake-ups; and the live page over a slow line, where at most one picture is in
//! transit, because after each one the terminal is asked for its status.

use std::io::Write;
use std::time::{Duration, Instant};

use super::live::Watched;
use super::program::{Program, QUESTION, Start, count, emulator};

/// Returns a frame of 16 × 16 with a moving object, nine taxels across.
fn pressed(number: u32) -> String {
    let (x, y) = (5 + number % 6, 5 + number * 5 % 7);
    let value = |column: u32, row: u32| {
        let away = column.abs_diff(x) + row.abs_diff(y);
        format!("{} ", 100_u32.saturating_sub(20 * away))
    };
    let row = |row: u32| (0..16).map(|column| value(column, row)).collect::<String>() + "\n";
    (0..16).map(row).collect::<String>() + "\n"
}

impl Watched {
    /// Sends the next frame, which is shown with a question after it. Returns the number of questions so far.
    fn asks_after(&mut self, number: u32) -> usize {
        let before = self.program.questions();
        self.sends(number..number + 1);
        self.program.shows(&format!("frame {number} "));
        self.program
            .until("a question", |program| program.questions() > before);
        self.program.questions()
    }
}

/// A slow line with a terminal at its end. Buffers accept everything at once, as with SSH.
struct SlowLine {
    /// The number of bytes that have reached the terminal.
    brought: usize,
    /// The number of questions that were answered.
    answers: usize,
    /// The terminal.
    terminal: vt100::Parser,
}

impl SlowLine {
    /// Transfers up to `most` bytes.
    fn brings(&mut self, program: &mut Program, most: usize) {
        program.read(Duration::from_millis(1));
        let end = program.bytes.len().min(self.brought + most);
        self.terminal.process(&program.bytes[self.brought..end]);
        self.brought = end;
        let questions = count(&program.bytes[..end], QUESTION);
        for _ in self.answers..questions {
            program.answer();
        }
        self.answers = questions;
    }
}

#[test]
fn a_key_is_not_queued_behind_pictures() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    watched.program.answers = false;
    let mut line = SlowLine {
        brought: 0,
        answers: 0,
        terminal: emulator(80, 24),
    };
    for number in 0..100 {
        let frame = pressed(number).into_bytes();
        watched.pipe.write_all(&frame).expect("it is read");
        // At most two thousand bytes and twenty frames per second.
        line.brings(&mut watched.program, 100);
        std::thread::sleep(Duration::from_millis(50));
    }
    watched.program.types(b"?");
    let before = line.brought;
    while !line
        .terminal
        .screen()
        .contents()
        .contains("Watching a sensor")
    {
        line.brings(&mut watched.program, 100);
        std::thread::sleep(Duration::from_millis(5));
    }
    let (pictures, behind) = (line.answers, line.brought - before);
    println!("{pictures} pictures in {before} bytes, then help within {behind} bytes");
    assert!(pictures >= 3, "{pictures}");
    // The bytes of one picture and of the help.
    assert!(behind <= 4000, "{behind} bytes");
}

#[test]
fn a_terminal_that_does_not_answer_is_only_asked_a_few_times() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    watched.program.answers = false;
    for number in 0..6 {
        watched.sends(number..number + 1);
        watched.program.shows(&format!("frame {number} "));
    }
    assert_eq!(watched.program.questions(), 3);
    // The terminal was only slow.
    watched.program.answers = true;
    watched.program.answer();
    watched.program.types(b"p");
    watched.program.shows("max held");
    assert_eq!(watched.asks_after(6), 4);
    watched.ends();
}

#[test]
fn an_answer_after_the_page_was_left_is_not_taken_for_a_key() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    watched.asks_after(0);
    watched.program.answers = false;
    watched.asks_after(1);
    watched.program.types(b"q");
    watched.program.shows("? Help");
    watched.program.answer();
    // Had the answer been taken for keys, its "n" would have made a new shape before this key.
    watched.program.types(b" ");
    watched.program.shows("NA 1 in all");
    watched.program.types(b"qy");
    watched.program.ends_well(0);
}

#[test]
fn a_key_takes_at_most_one_packet_and_the_first_screen_four() {
    let mut program = Program::start(&Start::default());
    let first = program.written(|program| program.shows("? Help"));
    assert!(first <= 4500, "first screen: {first} bytes");
    for (keys, shown) in [
        (&b"\x1b[C"[..], "column  9"),
        (b" ", "NA 1 in all"),
        (b"f", "Radius x"),
        (b"\r", "ellipse rx"),
        (b" ", "NA "),
        (b"n", "The matrix is empty"),
    ] {
        let bytes = program.written(|program| {
            program.types(keys);
            program.shows(shown);
        });
        assert!(bytes <= 1448, "{keys:?}: {bytes} bytes");
    }
}

#[test]
fn an_idle_program_does_not_wake_up() {
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
    let end = Instant::now() + Duration::from_secs(5);
    while let Some(left) = end.checked_duration_since(Instant::now()) {
        program.read(left);
    }
    let after = switches(&program);
    assert_eq!((after, program.bytes.len() - written), (before, 0));
    // For the build of the tests: 1.3 MB were measured.
    assert!(program.status("RssAnon") <= 2 * 1024);
}
