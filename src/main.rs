//! Runs `taxel::cli` with the arguments of the process, and ends with its exit status.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(taxel::cli::run(std::env::args_os()))
}
