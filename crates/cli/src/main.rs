//! The `maveric` program: its words in, its exit status out.

use maveric_cli::Invocation;
use std::io::Write as _;
use std::process::ExitCode;

fn main() -> ExitCode {
    if !maveric_pipeline::end_with_run() {
        let _ = std::io::stderr().write_all(b"error: the run that started this was killed\n");
        return ExitCode::from(1);
    }
    match Invocation::of_this_program() {
        Ok(invocation) => ExitCode::from(maveric_cli::run(invocation)),
        Err(status) => ExitCode::from(status),
    }
}
