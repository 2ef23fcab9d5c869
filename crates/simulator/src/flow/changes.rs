//! Lane changes and the ends of an open road: who moves where in this step.

use super::{
    Change, Flow,
    lane::{BRAKING_LIMIT_MPS2, Ends, Lane, Role},
    mobil::Considering,
};

/// Distance within which the vehicle ahead sets the speed of one that enters, in m.
const MINDS_M: f64 = 200.0;
/// Braking at which a vehicle that is leaving a lane minds the one ahead of it there, in m/s².
const MINDS_MPS2: f64 = 1.5;
/// Gap below which it minds in any case, in m.
const CLOSE_M: f64 = 4.0;
/// Gap that it keeps, in m.
const STOPS_SHORT_M: f64 = 1.0;
/// How much harder than needed it then brakes.
const RESERVE: f64 = 1.2;

impl Flow {
    /// Asks every vehicle whose turn it is; steps to the left and to the right take turns.
    ///
    /// With one direction a step no two vehicles come into a lane from both sides at once.
    pub(super) fn consider_changes(&mut self) {
        let Some(mobil) = self.settings.mobil else {
            return;
        };
        let count = self.lanes.len();
        let to_left = self.step.is_multiple_of(2);
        let every = mobil.considers_every_s / (2.0 * self.settings.step_s);
        let every = (every.round() as u32).max(1);
        let in_steps = |time_s: f64| (time_s / self.settings.step_s).round() as u32;
        let (takes, pause) = (in_steps(mobil.duration_s), in_steps(mobil.pause_s));
        for own in 0..count {
            let (target, far) = if to_left {
                (own + 1, Some(own + 2).filter(|&far| far < count))
            } else {
                (own.wrapping_sub(1), own.checked_sub(2))
            };
            if target >= count {
                continue;
            }
            let mut decided = std::mem::take(&mut self.decided);
            decided.clear();
            Considering {
                own: &self.lanes[own],
                target: &self.lanes[target],
                far: far.map(|far| &self.lanes[far]),
                ends: self.ends,
                step: self.step,
                every,
                sign: if to_left { 1.0 } else { -1.0 },
            }
            .decide(&mobil, &mut decided);
            for &i in &decided {
                self.lanes[own].busy_until[i] = self.step + takes + pause;
                self.stage(target, |entries, lanes| entries.push_from(&lanes[own], i));
                let id = self.lanes[own].id[i];
                if takes > 0 {
                    self.changes[id as usize] = Change {
                        from: own as u8,
                        into: target as u8,
                        began: self.step,
                        ends: self.step + takes,
                    };
                    self.lanes[own].role[i] = Role::Leaving;
                    self.changing += 1;
                } else {
                    self.lanes[own].role[i] = Role::Gone;
                }
                self.touched[own] = true;
            }
            self.started_changes += decided.len() as u64;
            self.decided = decided;
        }
    }

    /// Lets go of the lanes that have been left.
    pub(super) fn end_changes(&mut self) {
        for k in 0..self.pairs.len() {
            let (id, [_, (lane, i)]) = self.pairs[k];
            if self.changes[id as usize].ends <= self.step {
                self.lanes[lane].role[i] = Role::Gone;
                self.touched[lane] = true;
                self.changing -= 1;
            }
        }
    }

    /// Finds the two entries of each vehicle that is changing lane and gives them one acceleration: that of the new
    /// lane, less where the vehicle ahead in the old one would otherwise be hit.
    pub(super) fn join_pairs(&mut self) {
        self.pairs.clear();
        if self.changing == 0 {
            return;
        }
        for (lane, entries) in self.lanes.iter().enumerate() {
            let leaving = entries.role.iter().enumerate();
            for (i, _) in leaving.filter(|(_, role)| **role == Role::Leaving) {
                self.pairs.push((entries.id[i], [(usize::MAX, 0), (lane, i)]));
            }
        }
        for (id, [drives, (left, i)]) in &mut self.pairs {
            let x = self.lanes[*left].x[*i];
            let into = usize::from(self.changes[*id as usize].into);
            let Some(j) = self.lanes[into].find(*id, x) else {
                continue;
            };
            *drives = (into, j);
            let limit = self.lanes[*left].escape(*i, self.ends);
            let acc = self.lanes[into].acc[j].min(limit);
            self.lanes[into].acc[j] = acc;
            self.lanes[*left].acc[*i] = acc;
        }
    }

    /// Lets those whose time has come onto an open road, one a lane and step at most.
    pub(super) fn let_enter(&mut self) {
        if self.departures.is_empty() {
            return;
        }
        let now_s = self.time_s();
        for lane in 0..self.lanes.len() {
            let next = &mut self.next_departure[lane];
            let wanted = |d: &super::Departure| usize::from(d.lane) == lane;
            while self.departures.get(*next).is_some_and(|d| !wanted(d)) {
                *next += 1;
            }
            let id = *next;
            let Some(departure) = self.departures.get(id).filter(|d| d.time_s <= now_s) else {
                continue;
            };
            let driver = departure.driver;
            let first = (self.lanes[lane].len() > 0).then(|| {
                let entries = &self.lanes[lane];
                (entries.x[0] - entries.length[0] - driver.length_m, entries.v[0])
            });
            let speed = first.map_or(driver.desired_speed_mps, |(gap, v)| {
                let minds = gap < MINDS_M;
                if minds { v.min(driver.desired_speed_mps) } else { driver.desired_speed_mps }
            });
            let room = driver.standstill_m + speed * driver.time_gap_s;
            if first.is_some_and(|(gap, _)| gap < room) {
                continue;
            }
            *next += 1;
            let number = (self.placed + id) as u32;
            self.stage(lane, |entries, _| {
                entries.push(driver.length_m, speed, number, Role::Moving, &driver);
            });
        }
    }

    /// Takes those past the end off an open road.
    pub(super) fn let_leave(&mut self) {
        for entries in &mut self.lanes {
            while entries.x.last().is_some_and(|&x| x > self.settings.length_m) {
                if entries.role.last() == Some(&Role::Guest) {
                    break;
                }
                if entries.role.last() == Some(&Role::Leaving) {
                    self.changing -= 1;
                }
                entries.pop();
            }
        }
        // Entries have gone: indices of pairs are found again before they are used, in the next step.
        self.pairs.clear();
    }
}

impl Lane {
    /// Index of the driving entry of vehicle `id`, whose front is at `x`.
    fn find(&self, id: u32, x: f64) -> Option<usize> {
        let n = self.len();
        let (mut low, mut high) = (0, n);
        while low < high {
            let middle = low.midpoint(high);
            if self.x[self.at(middle)] < x {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        // More than one only where entries share one x.
        let mut same = (low..n).map(|rank| self.at(rank)).take_while(|&i| self.x[i] <= x);
        same.find(|&i| self.id[i] == id && self.role[i] == Role::Moving)
    }

    /// Acceleration that keeps entry `i` off the vehicle ahead while it is leaving the lane, in m/s².
    ///
    /// It is on its way out, so it minds only what it would hit (ours): the braking that ends the closing speed 1 m
    /// short, once that is more than 1.5 m/s² or the gap less than 4 m.
    fn escape(&self, i: usize, ends: Ends) -> f64 {
        let (gap, lead_v) = self.lead(i, ends);
        let closing = self.v[i] - lead_v;
        if closing <= 0.0 {
            return f64::INFINITY;
        }
        let needed = closing * closing / (2.0 * (gap - STOPS_SHORT_M).max(0.05));
        if needed > MINDS_MPS2 || gap < CLOSE_M {
            -(RESERVE * needed).min(BRAKING_LIMIT_MPS2)
        } else {
            f64::INFINITY
        }
    }
}
