//! The pipeline end to end, on the small study: everything runs, a second run does nothing, a changed
//! parameter rebuilds what follows and only that, an interrupted run goes on.

mod others;
mod small_study;

use crate::support::{TempStudy, argv, tells};
use std::{path::Path, process::Stdio, time::Duration};
