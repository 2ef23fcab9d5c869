//! When a driver of the background changes lane: MOBIL.

use super::lane::{Ends, Lane, Role};
use crate::scenario::setting::settings;
use maveric_laws::Sides;

settings! {
    /// How the background changes lane.
    ///
    /// # Source
    /// Kesting, Treiber and Helbing 2007: politeness 0 to 0.5, threshold 0.1 m/s², safe braking 4 m/s²; by default the published
    /// ones, politeness in the middle. Their model is instantaneous and asks at every moment; the last three settings are ours.
    #[derive(Copy)]
    pub struct Mobil {
        /// p, the weight of what the two followers gain or lose.
        politeness: f64 = 0.25, 0.0..=1.0;
        /// Gain below which nobody bothers.
        threshold_mps2: f64 = 0.1, 0.0..=2.0;
        /// Braking that a change may force on the new follower, positive.
        safe_braking_mps2: f64 = 4.0, 0.5..=6.0;
        /// Advantage of the lane to the right; 0: every lane is as good.
        keep_right_mps2: f64 = 0.0, 0.0..=1.0;
        /// Each vehicle considers each side once in this time.
        considers_every_s: f64 = 1.0, 0.01..=10.0;
        /// Time for which a changing vehicle takes up both lanes; 0: it jumps.
        duration_s: f64 = 4.0, 0.0..=15.0;
        /// Time after a change before the next is considered.
        pause_s: f64 = 4.0, 0.0..=60.0;
    }
}

impl Mobil {
    /// Whether entry `i` of `own` would do well, and no harm, between `behind` and `ahead` in `target`.
    ///
    /// Accelerations of both lanes are those of this moment. `sign` is 1 for a change to the left, -1 to the right.
    pub(super) fn wants(
        &self,
        own: &Lane,
        i: usize,
        target: &Lane,
        (behind, ahead): (Option<usize>, Option<usize>),
        sign: f64,
        ends: Ends,
    ) -> bool {
        let rule = maveric_laws::Mobil {
            politeness: self.politeness,
            threshold_mps2: self.threshold_mps2,
            keep_right_mps2: self.keep_right_mps2,
            safe_braking_mps2: self.safe_braking_mps2,
        };
        let (x, v) = (own.x[i], own.v[i]);
        let (gap, lead_v) = ahead.map_or((f64::INFINITY, v), |j| {
            (ends.forward(x, target.x[j]) - target.length[j], target.v[j])
        });
        let room = |f: usize| ends.forward(target.x[f], x) - own.length[i];
        if gap < LEAST_ROOM_M || behind.is_some_and(|f| room(f) < LEAST_ROOM_M) {
            return false;
        }
        let sides = Sides {
            own: (own.acc[i], own.toward(i, gap, lead_v)),
            new_follower: behind.map(|f| (target.acc[f], target.toward(f, room(f), v))),
            old_follower: own.previous(i, ends).map(|o| {
                let (gap, lead_v) = own.lead(i, ends);
                // Its gap to the vehicle ahead of the one that goes.
                let gap = gap + own.ahead_of(o, i, ends);
                (own.acc[o], own.toward(o, gap, lead_v))
            }),
        };
        rule.wants(&sides, sign > 0.0)
    }
}

/// Room that must be free ahead and behind, in m.
const LEAST_ROOM_M: f64 = 2.0;
/// Distance to a guest on the far side of a lane within which nobody moves into that lane, in m: the guest may
/// be about to move into it from there.
const COURTESY_M: f64 = 60.0;

/// One lane looking at the next.
pub(super) struct Considering<'a> {
    pub(super) own: &'a Lane,
    pub(super) target: &'a Lane,
    /// Lane on the far side of the target, if there is one.
    pub(super) far: Option<&'a Lane>,
    pub(super) ends: Ends,
    pub(super) step: u32,
    /// Each vehicle is asked once in so many steps of this direction.
    pub(super) every: u32,
    pub(super) sign: f64,
}

impl Considering<'_> {
    /// Indices in `own` of those who change now, in order from its head; one for each gap of the target at most.
    pub(super) fn decide(&self, mobil: &Mobil, changes: &mut Vec<usize>) {
        let (own, target) = (self.own, self.target);
        let n = target.len();
        let mut rank = 0;
        let mut claimed: Option<(usize, usize)> = None;
        let turn = self.step / 2 % self.every;
        for place in 0..own.len() {
            let i = own.at(place);
            let x = own.x[i];
            while rank < n && target.x[target.at(rank)] <= x {
                rank += 1;
            }
            let its_turn = own.id[i] % self.every == turn;
            if !its_turn || own.role[i] != Role::Moving || own.busy_until[i] > self.step {
                continue;
            }
            let gap = if n > 0 && rank == n && self.ends != Ends::Open { 0 } else { rank };
            if claimed.is_some_and(|(first, last)| first == gap || last == gap) {
                continue;
            }
            let neighbours = self.neighbours(rank);
            if mobil.wants(own, i, target, neighbours, self.sign, self.ends)
                && !self.guest_beyond(x)
            {
                changes.push(i);
                claimed = Some((claimed.map_or(gap, |(first, _)| first), gap));
            }
        }
    }

    fn neighbours(&self, rank: usize) -> (Option<usize>, Option<usize>) {
        let n = self.target.len();
        if n == 0 {
            return (None, None);
        }
        match self.ends {
            Ends::Ring(_) => {
                let ahead = if rank == n { 0 } else { rank };
                let behind = if rank == 0 { n - 1 } else { rank - 1 };
                (Some(self.target.at(behind)), Some(self.target.at(ahead)))
            }
            Ends::Open => (rank.checked_sub(1), (rank < n).then_some(rank)),
        }
    }

    fn guest_beyond(&self, x: f64) -> bool {
        let Some(far) = self.far else {
            return false;
        };
        (0..far.len()).any(|k| {
            let ahead = self.ends.forward(x, far.x[k]).abs();
            let behind = self.ends.forward(far.x[k], x).abs();
            far.role[k] == Role::Guest && ahead.min(behind) < COURTESY_M
        })
    }
}
