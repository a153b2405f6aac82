//! Compares sweeps with single touches over the paper's whole grid; any difference is an error.
//!
//! `cargo run --release --example sweep_check [-- NAME]` runs the figures and pictures of
//! `tests/imprints/sweep/cases.rs` (or those whose name contains NAME), each over 100 × 100 positions and 360 angles,
//! and exits with status 1 if any pose differs. It takes about four minutes on one core; the sweeps are a hundredth of
//! that.

#[path = "../tests/imprints/sweep/cases.rs"]
mod cases;

use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let only = std::env::args().nth(1).unwrap_or_default();
    let mut wrong = 0;
    let cases = cases::cases().into_iter();
    for case in cases.filter(|case| case.name.contains(&only)) {
        let grid = case.grid("0:359:1", 1);
        let start = Instant::now();
        let found = cases::differences(&grid);
        wrong += u32::from(found != Ok(0));
        let (poses, took) = (grid.poses(), start.elapsed().as_secs_f64());
        println!(
            "{:<38} {poses:>9} poses  {took:>6.1} s  {found:?} differ",
            case.name
        );
    }
    println!("{wrong} cases with differences");
    ExitCode::from(u8::from(wrong > 0))
}
