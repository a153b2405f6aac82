//! The live page over slow lines: at most one picture is in transit, because after each one the terminal is asked for
//! its status.

use std::io::Write;
use std::time::{Duration, Instant};

use rustix::process::Signal;

use super::drawn::emulator;
use super::live::Watched;
use super::program::{Program, QUESTION, count};

/// The sequence that leaves the alternate screen.
const LEFT: &[u8] = b"\x1b[?1049l";
/// The text that a shell would show if it received the terminal's answer.
const TYPED: &[u8] = b"^[[0n";

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
fn keys_are_drawn_at_once_while_a_picture_is_under_way() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    watched.asks_after(0);
    watched.program.answers = false;
    let questions = watched.asks_after(1);
    watched.sends(2..5);
    watched.program.types(b"p");
    watched.program.shows("max held");
    watched.program.shows("frame 1 ");
    assert_eq!(watched.program.questions(), questions);
    // The newest frame comes next.
    watched.program.answer();
    watched.program.shows("frame 4 ");
    watched.program.answers = true;
    watched.program.answer();
    watched.ends();
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
fn a_dumb_terminal_is_asked_nothing() {
    let Some(mut watched) = Watched::started("TERM=dumb", "") else {
        return;
    };
    for number in 0..3 {
        watched.sends(number..number + 1);
        watched.program.shows(&format!("frame {number} "));
    }
    assert_eq!(watched.program.questions(), 0);
    watched.ends();
}

#[test]
fn an_answer_in_pieces_is_not_taken_for_a_key() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    watched.asks_after(0);
    watched.program.answers = false;
    for (number, (first, rest)) in (1..).zip([("\x1b", "[0n"), ("\x1b[", "0n"), ("\x1b[0", "n")]) {
        watched.asks_after(number);
        watched.program.types(first.as_bytes());
        // Longer than the program waits after an ESC.
        watched.program.read(Duration::from_millis(300));
        watched.program.types(rest.as_bytes());
    }
    watched.program.answers = true;
    watched.asks_after(4);
    let screen = watched.program.rows();
    assert!(!screen.contains("model"), "{screen}");
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

/// Ends the program with an open question, which is answered once the shell seems to have the terminal. Returns true
/// if the program had not ended by then.
fn is_answered_at_its_end(
    watched: &mut Watched,
    end: impl FnOnce(&mut Program),
    status: i32,
) -> bool {
    watched.asks_after(0);
    watched.program.answers = false;
    watched.asks_after(1);
    end(&mut watched.program);
    let left = |program: &mut Program| program.count(LEFT) > 0;
    watched.program.until("the shell", left);
    let is_in_time = !watched.program.has_ended();
    watched.program.answer();
    watched.program.ends_well(status);
    assert!(!is_in_time || watched.program.count(TYPED) == 0);
    is_in_time
}

#[test]
fn the_shell_does_not_receive_a_late_answer() {
    for status in [0, 143] {
        let end = |program: &mut Program| match status {
            0 => b"qq".iter().for_each(|key| program.types(&[*key])),
            _ => program.signal(Signal::TERM),
        };
        // A very busy machine may answer later than the program waits.
        let is_in_time = (0..10).any(|_| {
            let watched = Watched::start();
            watched.is_none_or(|mut watched| is_answered_at_its_end(&mut watched, end, status))
        });
        assert!(is_in_time);
    }
}

/// Stops the program while an answer is lost, and returns the time from its continuation to the next question; None
/// if there is no terminal to test with.
fn time_to_continue() -> Option<Duration> {
    let mut watched = Watched::start()?;
    watched.asks_after(0);
    watched.program.answers = false;
    watched.asks_after(1);
    watched.program.signal(Signal::STOP);
    watched
        .program
        .until("a stop", |program| program.state() == 'T');
    watched.program.forget();
    watched.program.answers = true;
    let begun = Instant::now();
    watched.program.signal(Signal::CONT);
    watched.asks_after(2);
    let time = begun.elapsed();
    watched.ends();
    Some(time)
}

#[test]
fn pictures_continue_after_a_stop_in_which_an_answer_was_lost() {
    // The program waits ten seconds for an answer over a stalled line. A very busy machine may be as slow as that, but
    // not every time.
    let is_sooner = |time| time < Duration::from_secs(9);
    assert!((0..5).any(|_| time_to_continue().is_none_or(is_sooner)));
}
