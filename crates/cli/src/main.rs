//! The `maveric` program: parse, dispatch, exit status; nothing else.

#![warn(clippy::print_stderr)] // it panics where stderr is closed: `diagnostics::tell` does not

mod args;
mod commands;
mod diagnostics;
mod interrupt;
mod place;
mod progress;

use clap::Parser as _;
use std::process::ExitCode;

fn main() -> ExitCode {
    let args = commands::Args::parse();
    interrupt::listen();
    match commands::run(args.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
