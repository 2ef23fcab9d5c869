//! The `maveric` program: its words in, its exit status out.

use maveric_cli::Invocation;
use std::process::ExitCode;

fn main() -> ExitCode {
    if !maveric_pipeline::end_with_run() {
        return ExitCode::from(1);
    }
    match Invocation::of_this_program() {
        Ok(invocation) => ExitCode::from(maveric_cli::run(invocation)),
        Err(status) => ExitCode::from(status),
    }
}
