//! The program ends by a key, a signal, a lost line or a panic. Each time, it leaves the terminal as it was.

use std::time::Duration;

use rustix::process::Signal;
use taxel::tui::app::state::{App, Options};
use taxel::tui::runtime::{World, mailbox};
use taxel::tui::terminal;
use taxel::tui::terminal::input::Input;
use taxel::tui::terminal::settings::{Flags, TerminalSettings};
use taxel_files::storage::{Library, Orphan};

use super::program::{Program, Start, TAXEL};

/// The states in which the program is ended: keys, and a text that is then on the screen.
const STATES: [(&[u8], &str); 5] = [
    (b"f\t2", "rx 2.00"),
    (b"f\rq", "(y: lose it, n: stay, s: save first)"),
    // A sweep that takes minutes is running.
    (
        b"fr\r:explore --x0 0:9.999:0.001 --y0 0:9.999:0.001\r",
        "poses a second",
    ),
    // Half of a paste, and half of a key: a reader that waited for the rest would not notice anything else.
    (b" \x1b[200~12", "NA 1 in all"),
    (b" \x1b[1;", "NA 1 in all"),
];

fn in_state(start: &Start<'_>, (keys, shown): (&[u8], &str)) -> Program {
    let mut program = Program::started(start);
    program.types(keys);
    program.shows(shown);
    program
}

#[test]
fn every_signal_in_every_state_leaves_the_terminal_as_it_was() {
    let signals = [
        (Signal::HUP, 129),
        (Signal::INT, 130),
        (Signal::QUIT, 131),
        (Signal::TERM, 143),
        // This signal means nothing to the program; by default, it ends it at once.
        (Signal::USR1, 138),
    ];
    for state in STATES {
        for (signal, status) in signals {
            let mut program = in_state(&Start::default(), state);
            program.signal(signal);
            program.ends_well(status);
        }
    }
}

/// Unsaved work waits in the library, however the program ended.
#[test]
fn unsaved_work_is_kept_at_every_end() {
    for end in [Some(Signal::HUP), Some(Signal::TERM), None] {
        let folder = tempfile::tempdir().expect("a folder");
        let start = Start {
            library: Some(folder.path()),
            ..Start::default()
        };
        // The end comes at once, before the journal would be written.
        let mut program = in_state(&start, (b" \x1b[C \x1b[C ", "NA 3 in all"));
        match end {
            Some(signal) => program.signal(signal),
            None => program.hang_up(),
        }
        program.ends();
        let left = Orphan::all(&Library::open(folder.path().to_owned()));
        let taxels: Vec<u32> = left.iter().map(|left| left.shape.imprint.count()).collect();
        assert_eq!(taxels, [3], "{end:?}");
    }
    // After work was saved or given up, nothing is offered.
    for keys in [&b"  q"[..], b" qy", b" sname\rq"] {
        let folder = tempfile::tempdir().expect("a folder");
        let start = Start {
            library: Some(folder.path()),
            ..Start::default()
        };
        let mut program = Program::started(&start);
        program.types(keys);
        program.ends_well(0);
        let left = Orphan::all(&Library::open(folder.path().to_owned()));
        assert!(left.is_empty(), "{left:?}");
    }
}

#[test]
fn keys_end_the_program_with_status_0() {
    for keys in [&b"q"[..], b"\x03", b" qy", b"f\r\x03y"] {
        let mut program = Program::started(&Start::default());
        program.types(keys);
        program.ends_well(0);
    }
}

/// Two Ctrl-C during a sweep: the program does not wait for the sweep.
#[test]
fn quitting_does_not_wait_for_a_running_sweep() {
    let mut program = in_state(&Start::default(), STATES[2]);
    program.types(b"\x03\x03");
    program.ends_well(0);
}

/// The program ends with and without a signal from the system, and with any half-typed input.
#[test]
fn a_lost_line_ends_the_program() {
    let ignoring = ["sh", "-c", "trap '' HUP; exec \"$0\"", TAXEL];
    for state in STATES {
        for (command, controlling) in [(&[TAXEL][..], true), (&ignoring, true), (&[TAXEL], false)] {
            let start = Start {
                command,
                controlling,
                ..Start::default()
            };
            // A very busy machine may take longer, but not every time.
            let is_soon = (0..5).any(|_| {
                let mut program = in_state(&start, state);
                program.hang_up();
                let (ended, took) = program.ends();
                assert_eq!(ended.code(), Some(129), "{command:?}");
                took < Duration::from_secs(1)
            });
            assert!(is_soon, "{command:?}");
        }
    }
}

/// A terminal that accepts no more output cannot keep the program from ending.
#[test]
fn a_stuck_line_does_not_keep_the_program_from_ending() {
    let mut program = Program::started(&Start::default());
    for _ in 0..150 {
        program.types(b"\x0c");
        std::thread::sleep(Duration::from_millis(1));
    }
    program.signal(Signal::TERM);
    // Nothing is read from the terminal until the program has ended.
    let master = program.take_master();
    let (ended, _) = program.ends();
    assert_eq!(ended.code(), Some(143));
    drop(master);
}

/// The program with a failure at the first key, as a child of the next test.
#[test]
#[ignore = "only as a child of other tests"]
fn panics() {
    let _ = rustix::process::setsid();
    let _ = rustix::process::ioctl_tiocsctty(std::io::stdin());
    let settings = TerminalSettings::from_environment(std::env::var_os, &Flags::default());
    let app = App::new(&Options::plain(true));
    let world = World::scratch().expect("a folder");
    let mail = mailbox::new().expect("a mailbox");
    let outcome = terminal::run(app, None, world, &settings, mail, &mut |input| {
        assert!(!matches!(input, Input::Key(_)), "on purpose");
    });
    println!("{outcome:?}");
}

#[test]
fn a_panic_leaves_the_terminal_as_it_was() {
    let own = std::env::current_exe().expect("this test");
    let own = own.to_str().expect("a name");
    let command = [
        own,
        "--exact",
        "pty::ends::panics",
        "--ignored",
        "--nocapture",
    ];
    let mut program = Program::started(&Start {
        command: &command,
        ..Start::default()
    });
    assert!(program.screen().alternate_screen());
    program.types(b" ");
    let (ended, _) = program.ends();
    assert_ne!(ended.code(), Some(0));
    program.is_left();
    // The panic is reported after the screen was left.
    program.shows("on purpose");
}
