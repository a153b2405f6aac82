//! Keys, pastes, the mouse and new sizes through the whole screen, from any bytes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| taxel_fuzz::run("session", bytes));
