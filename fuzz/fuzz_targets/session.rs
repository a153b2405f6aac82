//! Keys, pastes, mouse events and resizes for the whole screen, from any bytes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| taxel_fuzz::run("session", bytes));
