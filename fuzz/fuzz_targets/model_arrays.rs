//! A model with changed bytes in its arrays.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| taxel_fuzz::run("model_arrays", bytes));
