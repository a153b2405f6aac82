//! The real program in a pseudo-terminal: ends, hang-ups, stops, kinds of terminals, live frames, bytes and wake-ups.
//!
//! No test waits a fixed time for a result: every wait is for a condition, with a long deadline.

mod program;

mod ends;

mod screens;

mod live;

/// Becomes the program; see [`program`].
#[test]
#[ignore = "only as a child of other tests"]
fn launcher() {
    program::launch();
}
