//! The settings of property tests: every run draws the same cases, and a failure writes no file into the source tree.
//! New cases are left to the fuzzer.

use proptest::prelude::ProptestConfig;
use proptest::test_runner::RngSeed;

/// Returns the settings for a number of cases.
pub(crate) fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(2008),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}
