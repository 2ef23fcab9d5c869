//! The pipeline end to end, on the small study: everything runs, a second run does nothing, a changed
//! parameter rebuilds what follows and only that, an interrupted run goes on.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

mod others;
mod small_study;
#[path = "../support/mod.rs"]
mod support;

use std::{path::Path, process::Stdio, time::Duration};
use support::{TempStudy, argv, tells};
