#![doc = include_str!("../README.md")]
#![allow(clippy::missing_errors_doc)] // a part of the program: its errors are read, not matched on
#![warn(clippy::print_stderr)] // it panics where stderr is closed: `diagnostics::tell` does not

mod citation;
mod commands;
mod diagnostics;
mod interrupt;
mod invocation;
mod place;
mod progress;
mod stage_files;

pub use commands::stats::stats_of_table;
pub use invocation::Invocation;

/// Runs the program as if it had been started with these words (the first is not its name), and says how it ends: 0 done, 1 the work
/// failed, 2 wrong usage, 130 interrupted.
///
/// It prints to the process's own streams, takes over Ctrl-C and may end the process when interrupted, so it is for a `main`; other
/// programs call `maveric-study`.
pub fn run(invocation: Invocation) -> u8 {
    let parsed = commands::parsed(invocation.words.iter().map(String::as_str));
    invocation::begin(invocation);
    match parsed {
        Ok(args) => {
            interrupt::listen();
            commands::styled(args.style.as_deref(), args.command)
                .map_or_else(diagnostics::Failure::report, |()| 0)
        }
        Err(error) => {
            // Help and version are asked for; a stream that is closed wanted no more.
            drop(error.print());
            u8::try_from(error.exit_code()).unwrap_or(2)
        }
    }
}
