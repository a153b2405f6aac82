//! The description beside a recording, from any bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../tests/files/hostile/bodies/mod.rs"]
#[allow(dead_code, reason = "every target has one of the bodies")]
mod bodies;

fuzz_target!(|bytes: &[u8]| bodies::body("description")(bytes));
