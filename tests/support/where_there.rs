//! Tests that need what is not everywhere. One whose need is not met is not run: it counts as ignored, by its name, and the reason is said.

#![allow(dead_code, unreachable_pub, reason = "each test file uses its own part of this")]

use libtest_mimic::{Arguments, Trial};
use std::{
    path::{Path, PathBuf},
    process::Command,
};

/// A test that runs unless something is missing.
pub fn trial(
    name: &'static str,
    missing: Option<String>,
    test: impl FnOnce() + Send + 'static,
) -> Trial {
    let ignored = missing.inspect(|why| eprintln!("skipped: {name}: {why}")).is_some();
    let test = || {
        test();
        Ok(())
    };
    Trial::test(name, test).with_ignored_flag(ignored)
}

/// Runs the tests as a test harness does.
pub fn run(tests: Vec<Trial>) -> ! {
    libtest_mimic::run(&Arguments::from_args(), tests).exit()
}

/// Recordings that stand beside the checkout; else which are missing.
pub fn shared(path: &str) -> Result<PathBuf, String> {
    let found = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")).join(path);
    if found.exists() {
        return Ok(found);
    }
    Err(format!("{} is not there", found.display()))
}

/// Whether a program is on the PATH; else that it is not.
pub fn runs(program: &str) -> Result<(), String> {
    let ran = Command::new(program).arg("--version").output();
    match ran {
        Ok(ran) if ran.status.success() => Ok(()),
        _ => Err(format!("`{program}` is not on the PATH")),
    }
}
