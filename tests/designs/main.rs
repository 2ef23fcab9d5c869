//! Studies that are not the paper's, walked with the program: what a `study.toml` says is what happens.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

mod faults;
mod recordings;
mod rehearsed;
#[path = "../support/mod.rs"]
mod support;

use support::own_logs::{
    PEOPLE, TABLE, TO_THE_NUMBERS, analysis, answers, change, measured, recorded, recorded_of,
    scale, speed, table,
};
use support::page::Page;
use support::{TempStudy, argv, tells};
