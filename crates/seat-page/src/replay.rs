//! The same drive again.

use crate::{
    drive::SeatDrive,
    error::SeatPageError,
    record::{Asked, End, Record},
};
use maveric_domain::{DrivenBy, Setpoints};
use maveric_simulator::{Planner, Rollout, View};

/// A drive that was driven again from its record.
#[derive(Debug)]
pub struct Replayed {
    pub rollout: Rollout,
    /// The end it came to now.
    pub end: End,
    /// The end that the record holds; none where the drive was cut short.
    pub recorded: Option<End>,
}

impl Replayed {
    /// Whether it went through the same states, to the byte; what was cut short has nothing to be held against.
    pub fn same(&self) -> bool {
        self.recorded.as_ref().is_none_or(|end| *end == self.end)
    }
}

/// Set-points as they were asked.
struct AskedAgain<I: Iterator<Item = Asked>> {
    asked: std::iter::Peekable<I>,
    given: u32,
    last: Setpoints,
    short: bool,
}

impl<I: Iterator<Item = Asked>> Planner for AskedAgain<I> {
    fn plan(&mut self, _: &View<'_>) -> Setpoints {
        while self.asked.peek().is_some_and(|now| self.given >= now.rows) {
            self.asked.next();
            self.given = 0;
        }
        match self.asked.peek() {
            Some(now) => {
                self.given += 1;
                self.last = now.setpoints;
            }
            None => self.short = true,
        }
        self.last
    }
}

/// Drives a record again.
///
/// # Errors
/// [`SeatPageError::Record`] for a ride whose set-points do not reach to its last step, a drive
/// that is longer than its scenario; [`SeatPageError::Simulator`].
pub fn replay(record: &Record) -> Result<Replayed, SeatPageError> {
    let header = &record.header;
    let problem = |problem: &str| SeatPageError::Record { problem: problem.to_owned() };
    let mut planner = AskedAgain {
        asked: record.chunks.iter().flat_map(|c| c.asked.iter().copied()).peekable(),
        given: 0,
        last: Setpoints {
            speed_mps: 0.0,
            following_distance_m: 0.0,
            wish: maveric_domain::LaneWish::Stay,
        },
        short: false,
    };
    let (scenario, seed) = (&header.scenario, header.seed);
    let driven = match (header.driven_by, &header.controllers) {
        (DrivenBy::Automated, Some(controllers)) => {
            let mut drive = SeatDrive::ride(scenario, seed, &mut planner, controllers)?;
            again(&mut drive, record)?;
            drive.finish()?
        }
        (DrivenBy::Automated, None) => {
            let mut drive = SeatDrive::shown(scenario, seed)?;
            again(&mut drive, record)?;
            drive.finish()?
        }
        (driven_by, _) => {
            let mut drive = SeatDrive::by_hand(scenario, seed, driven_by)?;
            again(&mut drive, record)?;
            drive.finish()?
        }
    };
    if planner.short {
        return Err(problem("set-points end before the ride does"));
    }
    Ok(Replayed { rollout: driven.rollout, end: driven.end, recorded: record.end.clone() })
}

fn again(drive: &mut SeatDrive<'_>, record: &Record) -> Result<(), SeatPageError> {
    for chunk in &record.chunks {
        let given = chunk.held.iter().flat_map(|held| {
            let steps = usize::try_from(held.steps).unwrap_or(usize::MAX);
            std::iter::repeat_n(held.input, steps)
        });
        let ride = (!record.header.holds_inputs())
            .then(|| (0..chunk.ticks).map(|_| crate::input::Input::default()));
        for input in given.chain(ride.into_iter().flatten()) {
            if !drive.tick(input) {
                return Err(SeatPageError::Record {
                    problem: format!(
                        "inputs go on after step {}, where the scenario ends",
                        drive.ticks()
                    ),
                });
            }
        }
    }
    Ok(())
}
