//! An SVG, or paths of one, from any bytes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| taxel_fuzz::run("svg", bytes));
