//! Lanes put in order again after somebody has come or gone.

use super::{
    Flow, Guest,
    lane::{Ends, Lane, Role},
};

impl Flow {
    /// Adds an entry to the arrivals of `lane`, in order.
    pub(super) fn stage(&mut self, lane: usize, write: impl FnOnce(&mut Lane, &[Lane])) {
        let staged = &mut self.staged[lane];
        write(staged, &self.lanes);
        staged.settle_last();
        self.touched[lane] = true;
    }

    /// Takes out whoever is gone and puts in whoever has come, and sets the accelerations of the lanes concerned.
    pub(super) fn rebuild_touched(&mut self) {
        let mut any = false;
        for k in 0..self.lanes.len() {
            if !std::mem::take(&mut self.touched[k]) {
                continue;
            }
            any = true;
            self.spare.merge(&self.lanes[k], &self.staged[k]);
            std::mem::swap(&mut self.spare, &mut self.lanes[k]);
            self.staged[k].clear();
            self.lanes[k].accelerate(self.ends);
        }
        if any {
            self.join_pairs();
        }
    }

    /// Puts the entries of guest `key` where it is now.
    pub(super) fn move_guest(&mut self, key: usize, before: [Option<u8>; 2], guest: &Guest) {
        for lane in before.into_iter().flatten() {
            let entries = &mut self.lanes[usize::from(lane)];
            let Some(i) = entries.guest(key) else {
                continue;
            };
            let stays = guest.lanes.contains(&Some(lane));
            if stays && entries.fits(i, guest.front_m, self.ends) {
                entries.x[i] = guest.front_m;
                entries.v[i] = guest.speed_mps;
                if let Ends::Ring(_) = self.ends {
                    entries.turn_head_either_way();
                }
            } else {
                entries.role[i] = Role::Gone;
                self.touched[usize::from(lane)] = true;
            }
        }
        for lane in guest.lanes.into_iter().flatten() {
            let lane = usize::from(lane);
            if self.lanes[lane].guest(key).is_none() {
                self.stage(lane, |entries, _| {
                    let (x, v) = (guest.front_m, guest.speed_mps);
                    entries.push(x, v, key as u32, Role::Guest, &guest.driver);
                });
            }
        }
        self.rebuild_touched();
    }
}

impl Lane {
    /// Moves the last entry forward to where it belongs.
    fn settle_last(&mut self) {
        let mut i = self.len() - 1;
        while i > 0 && self.x[i] < self.x[i - 1] {
            self.swap(i, i - 1);
            i -= 1;
        }
    }

    fn guest(&self, key: usize) -> Option<usize> {
        (0..self.len()).find(|&i| self.role[i] == Role::Guest && self.id[i] as usize == key)
    }

    /// Whether entry `i` at `x` is still between its neighbours.
    fn fits(&self, i: usize, x: f64, ends: Ends) -> bool {
        let behind = self.previous(i, ends);
        let ahead = self.next(i, ends);
        match (behind, ahead) {
            // Its one companion on the ring is both ahead and behind.
            (Some(j), Some(k)) if j == k => true,
            (Some(j), Some(k)) => {
                let along = ends.forward(self.x[j], x);
                along >= 0.0 && along < ends.forward(self.x[j], self.x[k])
            }
            (Some(j), None) => x > self.x[j],
            (None, Some(k)) => x < self.x[k],
            (None, None) => true,
        }
    }

    /// Finds the smallest x after one entry has been placed from outside.
    fn turn_head_either_way(&mut self) {
        let smallest = (0..self.len()).min_by(|&i, &j| self.x[i].total_cmp(&self.x[j]));
        self.head = smallest.unwrap_or(0);
    }

    /// Becomes `old` without those gone and with `arrivals`, from the head.
    fn merge(&mut self, old: &Self, arrivals: &Self) {
        self.clear();
        let n = old.len();
        let mut next = 0;
        // [from, to) is a run of entries not yet copied, none of which is gone.
        let mut from = old.head;
        for rank in 0..n {
            let i = old.at(rank);
            if i == 0 && rank > 0 {
                self.extend_from(old, from..n);
                from = 0;
            }
            let gone = old.role[i] == Role::Gone;
            let arrives = next < arrivals.len() && arrivals.x[next] < old.x[i];
            if !(gone || arrives) {
                continue;
            }
            self.extend_from(old, from..i);
            from = i;
            while next < arrivals.len() && arrivals.x[next] < old.x[i] {
                self.push_from(arrivals, next);
                next += 1;
            }
            if gone {
                from = i + 1;
            }
        }
        let end = if old.head == 0 { n } else { old.head };
        self.extend_from(old, from.min(end)..end);
        while next < arrivals.len() {
            self.push_from(arrivals, next);
            next += 1;
        }
    }
}
