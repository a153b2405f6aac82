//! The real program in a pseudo-terminal: ends, hang-ups, stops, unusual terminals, bytes and wake-ups.
//!
//! No test waits a fixed time for a result: every wait is for a condition, with a long deadline.

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

/// Becomes the program; see [`program`].
#[test]
#[ignore = "only as a child of other tests"]
fn launcher() {
    program::launch();
}
