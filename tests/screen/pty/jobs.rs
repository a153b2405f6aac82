//! Stopped and continued by a shell.

use rustix::process::Signal;

use super::program::{Program, Start, TAXEL};
use super::screens::session;

/// A shell with jobs: runs the program, then waits for a line and brings it back.
const SHELL: &str =
    "set -m; \"$0\"; echo stopped $?; read line; fg >/dev/null; echo ended $?; read line";

#[test]
fn ctrl_z_stops_it_and_fg_brings_it_back() {
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

/// Everybody who waits for it is stopped too.
#[test]
fn the_whole_group_stops() {
    let outer = "set -m; sh -c '\"$0\"; echo inner' \"$0\"; echo stopped; read line; fg >/dev/null; echo ended; read line";
    let command = ["sh", "-c", outer, TAXEL];
    let mut program = Program::started(&Start {
        command: &command,
        ..Start::default()
    });
    program.types(b"\x1a");
    program.shows("stopped");
    program.is_left();
    program.forget();
    program.types(b"\n");
    program.agrees(&session(false, (80, 24)));
    program.types(b"q");
    program.shows("inner");
    program.shows("ended");
    program.is_left();
}

/// The first process of a session has nobody who would continue it: it goes on, and keys still work.
#[test]
fn without_a_shell_it_is_not_stopped() {
    let mut program = Program::started(&Start::default());
    program.types(b"\x1a");
    program.shows("! there is no shell to go back to");
    program.signal(Signal::TSTP);
    program.types(b" ");
    program.shows("NA 1 in all");
    program.types(b"qy");
    program.ends_well(0);
}

/// Stopped from outside without a chance to tidy up, it takes the terminal anew.
#[test]
fn after_a_stop_from_outside_everything_is_drawn_anew() {
    let mut program = Program::started(&Start::default());
    program.signal(Signal::STOP);
    program.until("a stop", |program| program.state() == 'T');
    program.forget();
    program.signal(Signal::CONT);
    program.agrees(&session(false, (80, 24)));
    assert!(program.screen().alternate_screen());
    program.types(b"q");
    program.ends_well(0);
}
