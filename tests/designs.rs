//! Studies that are not the paper's, walked with the program: what a `study.toml` says is what happens.

mod faults;
mod recordings;
mod rehearsed;

use crate::support::own_logs::{
    PEOPLE, TABLE, TO_THE_NUMBERS, analysis, answers, change, measured, recorded, recorded_of,
    scale, speed, table,
};
use crate::support::page::Page;
use crate::support::{TempStudy, argv, tells};
