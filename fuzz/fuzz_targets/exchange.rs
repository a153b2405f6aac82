//! An imprint in any of the formats of other programs, from any bytes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| taxel_fuzz::run("exchange", bytes));
