//! A range `start:end:step` or a shard `K/N`, from any bytes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| taxel_fuzz::run("range", bytes));
