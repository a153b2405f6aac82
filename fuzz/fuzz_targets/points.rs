//! An outline as points, from any bytes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| taxel_fuzz::run("points", bytes));
