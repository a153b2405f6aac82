//! An archive for `taxel merge` that is valid except for some bytes of its arrays.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| taxel_fuzz::run("arrays", bytes));
