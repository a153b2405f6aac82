//! The real program in a pseudo-terminal: ends, hang-ups, stops, odd terminals, bytes and wake-ups.
//!
//! Nothing waits a fixed time for something to be right: every wait is for a condition, with a long deadline.

mod drawn;

mod program;

mod screens;

mod ends;

mod jobs;

mod cost;

mod scripts;

mod mouse;

mod record;

mod saves;

mod tracer;

mod reading;

mod hostile;

mod live;

mod links;

/// Becomes the program; see `program`.
#[test]
#[ignore = "only as a child of other tests"]
fn launcher() {
    program::launch();
}
