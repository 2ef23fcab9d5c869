//! Tests that need what is not everywhere: recordings, a scheduler, LaTeX, a disk of their own. One whose need is not met is not run: it
//! counts as ignored, by its name, and the reason is said.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

#[cfg(target_os = "linux")]
mod hyperqueue;
mod paper;
mod recordings;
#[cfg(target_os = "linux")]
mod small_disk;
#[path = "../support/mod.rs"]
mod support;

use libtest_mimic::{Arguments, Trial};

/// A test that runs unless something is missing.
fn trial(
    name: &'static str,
    missing: Option<String>,
    test: impl FnOnce() + Send + 'static,
) -> Trial {
    let ignored = missing
        .inspect(|why| eprintln!("skipped: {name}: {why}"))
        .is_some();
    let test = || {
        test();
        Ok(())
    };
    Trial::test(name, test).with_ignored_flag(ignored)
}

fn main() {
    let mut tests = recordings::tests();
    tests.extend(paper::tests());
    #[cfg(target_os = "linux")]
    {
        tests.extend(hyperqueue::tests());
        tests.extend(small_disk::tests());
    }
    libtest_mimic::run(&Arguments::from_args(), tests).exit();
}
