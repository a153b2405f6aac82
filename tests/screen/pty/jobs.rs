//! The program is stopped and continued by a shell.

use rustix::process::Signal;

use super::program::{Program, Start, TAXEL};
use super::screens::session;

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

/// Nobody would continue the first process of a session, so it keeps running, and keys still work.
#[test]
fn without_a_shell_the_program_is_not_stopped() {
    let mut program = Program::started(&Start::default());
    program.types(b"\x1a");
    program.shows("! there is no shell to go back to");
    program.signal(Signal::TSTP);
    program.types(b" ");
    program.shows("NA 1 in all");
    program.types(b"qy");
    program.ends_well(0);
}

/// After a stop from outside that left no chance to clean up, the program takes over the terminal again.
#[test]
fn after_a_stop_from_outside_everything_is_redrawn() {
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
