//! Stages on a cluster.
use crate::*;
use std::collections::BTreeSet;
use crate::attempt::Workshop;
use crate::schedule::Schedule;
pub(crate) fn refuse_while_jobs_run(_place: &Place) -> Result<(), PipelineError> { Ok(()) }
pub(crate) fn run(_e: Executor, _w: &Workshop<'_>, _s: &mut Schedule<'_>, _f: &BTreeSet<usize>, _o: &RunOptions, _ob: &mut dyn FnMut(Event<'_>)) -> Result<(), PipelineError> { Ok(()) }
