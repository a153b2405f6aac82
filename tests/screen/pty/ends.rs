//! The program ends or stops by a key, a signal, a lost line or a panic. Each time, it leaves the terminal as it was,
//! and unsaved work in the library.

use std::fs::File;
use std::path::Path;
use std::time::Duration;

use rustix::process::Signal;
use taxel::tui::app::{App, Options};
use taxel::tui::jobs::Jobs;
use taxel::tui::terminal;
use taxel::tui::terminal::input::Input;
use taxel::tui::terminal::settings::{Flags, TerminalSettings};
use taxel_files::storage::{Library, Orphan};

use super::program::{Program, Start, TAXEL};
use super::screens::session;

/// The states in which the program is ended: keys, and a text that is then on the screen.
const STATES: [(&[u8], &str); 5] = [
    (b"f\t2", "rx 2.00"),
    (b"f\rq", "(y: lose it, n: stay, s: save first)"),
    // A sweep that takes minutes is running.
    (
        b"fr\r:explore --x0 0:9.999:0.001 --y0 0:9.999:0.001\r",
        "poses a second",
    ),
    // Half of a paste, and half of a key: a loop that waited for the rest would not notice anything else.
    (b" \x1b[200~12", "NA 1 in all"),
    (b" \x1b[1;", "NA 1 in all"),
];

fn in_state(start: &Start<'_>, (keys, shown): (&[u8], &str)) -> Program {
    let mut program = Program::started(start);
    program.types(keys);
    program.shows(shown);
    program
}

fn with_library(folder: &Path) -> Start<'_> {
    Start {
        library: Some(folder),
        ..Start::default()
    }
}

/// Returns the numbers of taxels of the unsaved work in a library.
fn left_in(folder: &Path) -> Vec<u32> {
    let left = Orphan::all(&Library::open(folder.to_owned()));
    left.iter().map(|left| left.shape.imprint.count()).collect()
}

#[test]
fn every_signal_in_every_state_leaves_the_terminal_as_it_was() {
    for state in STATES {
        for (signal, status) in [
            (Signal::HUP, 129),
            (Signal::INT, 130),
            (Signal::QUIT, 131),
            (Signal::TERM, 143),
            // This signal means nothing to the program; by default, it ends it at once.
            (Signal::USR1, 138),
        ] {
            let mut program = in_state(&Start::default(), state);
            program.signal(signal);
            program.ends_well(status);
        }
    }
}

#[test]
fn keys_end_the_program_with_status_0() {
    for keys in [&b"q"[..], b"\x03", b" qy", b"f\r\x03y"] {
        let mut program = Program::started(&Start::default());
        program.types(keys);
        program.ends_well(0);
    }
    // It does not wait for a running sweep.
    let mut program = in_state(&Start::default(), STATES[2]);
    program.types(b"\x03\x03");
    program.ends_well(0);
}

/// The program ends with and without a signal from the system, and with any half-typed input.
#[test]
fn a_lost_line_ends_the_program_within_a_second() {
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

/// A terminal that takes no more output keeps neither the program from ending nor unsaved work from the journal.
#[test]
fn a_stuck_line_does_not_keep_the_program_from_ending() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut program = in_state(&with_library(folder.path()), (b" ", "NA 1 in all"));
    // Nothing is read from the terminal meanwhile.
    for _ in 0..150 {
        program.types(b"\x0c");
        std::thread::sleep(Duration::from_millis(1));
    }
    program.signal(Signal::TERM);
    assert_eq!(program.ends_unread().code(), Some(143));
    assert_eq!(left_in(folder.path()), [1]);
}

#[test]
fn unsaved_work_is_kept_at_every_end() {
    for end in [Some(Signal::HUP), Some(Signal::TERM), None] {
        let folder = tempfile::tempdir().expect("a folder");
        // The end comes at once, before the journal would be written.
        let keys: &[u8] = b" \x1b[C \x1b[C ";
        let mut program = in_state(&with_library(folder.path()), (keys, "NA 3 in all"));
        match end {
            Some(signal) => program.signal(signal),
            None => program.hang_up(),
        }
        program.ends();
        assert_eq!(left_in(folder.path()), [3], "{end:?}");
    }
    // After work was saved or given up, nothing is offered.
    for keys in [&b"  q"[..], b" qy", b" sname\rq"] {
        let folder = tempfile::tempdir().expect("a folder");
        let mut program = Program::started(&with_library(folder.path()));
        program.types(keys);
        program.ends_well(0);
        assert!(left_in(folder.path()).is_empty(), "{keys:?}");
    }
}

/// Another program holds the library, like a disk that hangs: keys work, and the end does not wait.
#[test]
fn a_save_that_waits_keeps_neither_keys_nor_the_end() {
    for signal in [None, Some(Signal::TERM)] {
        let folder = tempfile::tempdir().expect("a folder");
        let lock = File::create(folder.path().join(".lock")).expect("a lock");
        lock.lock().expect("it is free");
        let mut program = Program::started(&with_library(folder.path()));
        program.types(b" sname\r");
        program.shows("waiting for another taxel to release the library");
        let Some(signal) = signal else {
            program.types(b"\x1b[C \x1b[C ");
            program.shows("NA 3 in all");
            lock.unlock().expect("held");
            program.shows("saved as name");
            // Taxels drawn meanwhile are not saved.
            program.types(b"q");
            program.shows("The imprint is not saved");
            continue;
        };
        program.signal(signal);
        program.ends_well(143);
        program.shows("the next start offers it as unsaved work");
        assert!(
            Library::open(folder.path().to_owned())
                .load("name")
                .is_err()
        );
        assert_eq!(left_in(folder.path()), [1]);
    }
}

/// The program with a failure at the first key, as a child of the next test.
#[test]
#[ignore = "only as a child of other tests"]
fn panics() {
    let _ = rustix::process::setsid();
    let _ = rustix::process::ioctl_tiocsctty(std::io::stdin());
    let settings = TerminalSettings::from_environment(std::env::var_os, &Flags::default());
    let app = App::new(&Options::plain(true));
    let world = Jobs::scratch().expect("a folder");
    let status = terminal::run(app, None, world, &settings, &mut |input| {
        assert!(!matches!(input, Input::Key(_)), "on purpose");
    });
    println!("{status:?}");
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

/// A shell with job control: it runs the program, then waits for a line and continues the program.
const SHELL: &str =
    "set -m; \"$0\"; echo stopped $?; read line; fg >/dev/null; echo ended $?; read line";

#[test]
fn ctrl_z_stops_the_program_and_fg_continues_it() {
    let command = ["sh", "-c", SHELL, TAXEL];
    let mut program = Program::started(&Start {
        command: &command,
        ..Start::default()
    });
    program.types(b"f\r ");
    program.shows("Region 1");
    program.types(b"\x1a");
    program.shows("stopped");
    program.is_left();
    program.forget();
    program.types(b"\n");
    let mut script = session(false, (80, 24));
    script.keys("f<CR><Space>").expect("keys");
    program.agrees(&script);
    assert!(program.screen().alternate_screen());
    program.types(b"qy");
    program.shows("ended 0");
    program.is_left();
}

/// Nobody would continue the first process of a session, so it keeps running. After a stop from outside that left no
/// chance to clean up, it takes over the terminal again.
#[test]
fn without_a_shell_only_others_stop_the_program() {
    let mut program = Program::started(&Start::default());
    program.types(b"\x1a");
    program.shows("! there is no shell to go back to");
    program.signal(Signal::TSTP);
    program.types(b" ");
    program.shows("NA 1 in all");
    // Signals and keys come on two ways; the second key takes away any message.
    program.written(|program| program.types(b"\x1b[C"));
    program.signal(Signal::STOP);
    program.until("a stop", |program| program.state() == 'T');
    program.forget();
    program.signal(Signal::CONT);
    let mut script = session(false, (80, 24));
    script.keys("<Space><Right>").expect("keys");
    program.agrees(&script);
    assert!(program.screen().alternate_screen());
    program.types(b"qy");
    program.ends_well(0);
}
