//! A driver's habits as set-points: a free speed, a gap and a wish.

use maveric_domain::{LaneWish, Reference, Setpoints, When};
use maveric_model::{Habits, heads::OwnHead};
use maveric_simulator::View;

/// Time from a wish to where a change of lane shows (0.15 m/s sideways), in s: habits are read where a change shows, so the wish comes
/// that much sooner. Chosen, not fitted.
const SHOWS_AFTER_S: f64 = 0.5;
/// Probability of passing from which a pass is meant.
const MEANT: f64 = 0.5;
/// Least speed over the vehicle beside, in m/s: else a pass never ends.
const LEAST_OVER_MPS: f64 = 1.0;

/// Asks for what a driver's habits say of the situation.
///
/// A pass is meant where it is likelier than not, and wished for at the driver's own time gap; merging back is wished for once the
/// vehicle that was passed is the driver's own time gap behind. Where nothing of a kind was learned, nothing of it is asked: the
/// posted speed, the safe distance, the own lane.
#[derive(Debug, Clone)]
pub struct HabitRule {
    habits: Habits,
}

impl HabitRule {
    /// Takes a driver's habits.
    pub fn new(habits: Habits) -> Self {
        Self { habits }
    }

    /// What this driver asks for now.
    pub fn setpoints(&self, view: &View<'_>) -> Setpoints {
        let free_mps = plain(self.habits.free_speed.as_ref()).unwrap_or(view.road.posted_speed_mps);
        let place = Place::of(view);
        let gap_s = plain(self.habits.following_gap.as_ref()).unwrap_or(0.0);
        let lead_mps = match place {
            Place::Behind(lead) => lead.speed_mps,
            _ => view.scene.ego.speed_mps,
        };
        Setpoints {
            speed_mps: match place {
                Place::Passing(beside) => self.passing_speed_mps(free_mps, &beside),
                _ => free_mps,
            },
            following_distance_m: gap_s * lead_mps,
            wish: self.wish(view, free_mps, place),
        }
    }

    fn passing_speed_mps(&self, free_mps: f64, beside: &Reference) -> f64 {
        let over = self.habits.passing_speed.as_ref();
        let over = over.map(|h| h.middle(&[free_mps - beside.speed_mps]));
        over.map_or(free_mps, |over| beside.speed_mps + over.max(LEAST_OVER_MPS))
    }

    fn wish(&self, view: &View<'_>, free_mps: f64, place: Place) -> LaneWish {
        let ego_mps = view.scene.ego.speed_mps;
        match place {
            Place::Behind(lead) if view.lane + 1 < view.road.lanes => {
                let pass = self.habits.pass.as_ref();
                let likely = pass.map_or(0.0, |h| h.middle(&[free_mps - lead.speed_mps]));
                let Some(at_s) = plain(self.habits.move_out.as_ref()).filter(|_| likely > MEANT)
                else {
                    return LaneWish::Stay;
                };
                let closing_mps = ego_mps - lead.speed_mps;
                let shown_m = lead.dx_m - closing_mps * SHOWS_AFTER_S;
                LaneWish::MoveOut(when(shown_m <= at_s * ego_mps))
            }
            Place::Passing(passed) => match plain(self.habits.merge_back.as_ref()) {
                None => LaneWish::Stay,
                Some(at_s) => {
                    let opening_mps = ego_mps - passed.speed_mps;
                    let shown_m = -passed.dx_m + opening_mps * SHOWS_AFTER_S;
                    LaneWish::MoveBack(when(passed.dx_m < 0.0 && shown_m >= at_s * ego_mps))
                }
            },
            _ => LaneWish::Stay,
        }
    }
}

fn when(now: bool) -> When {
    if now { When::Now } else { When::NotYet }
}

/// The middle of a habit that reads nothing.
fn plain(head: Option<&OwnHead>) -> Option<f64> {
    head.map(|h| h.middle(&[]))
}

/// Where ego is to its reference vehicle.
#[derive(Debug, Clone, Copy)]
enum Place {
    /// Behind it, in its lane.
    Behind(Reference),
    /// In a lane to its left.
    Passing(Reference),
    /// Neither.
    Free,
}

impl Place {
    fn of(view: &View<'_>) -> Self {
        let reference = view.reference;
        let half = 0.5 * view.road.lane_width_m;
        if reference.vehicle.is_none() {
            Self::Free
        } else if reference.dy_m < -half {
            Self::Passing(reference)
        } else if reference.dy_m <= half && reference.dx_m > 0.0 {
            Self::Behind(reference)
        } else {
            Self::Free
        }
    }
}
