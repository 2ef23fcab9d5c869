//! One lane: its vehicles in order, one column a quantity.

use super::driver::IdmDriver;

/// Hardest braking of the background, in m/s².
pub(super) const BRAKING_LIMIT_MPS2: f64 = 8.0;
/// Shortest gap that the model is asked about, in m: overlapping vehicles brake as hard as they can.
const LEAST_GAP_M: f64 = 0.1;

/// What an entry of a lane is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// A vehicle that drives here.
    Moving,
    /// A vehicle that is still leaving this lane for another, where its `Moving` entry is.
    Leaving,
    /// A vehicle moved from outside, such as ego.
    Guest,
    /// Nothing any more: taken out when the lane is put in order.
    Gone,
}

/// Whether a lane closes on itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Ends {
    /// A ring of this length, in m.
    Ring(f64),
    /// An open road.
    Open,
}

impl Ends {
    /// Distance from `behind_m` forward to `ahead_m`, in m: on a ring from 0 to its length.
    pub(super) fn forward(self, behind_m: f64, ahead_m: f64) -> f64 {
        let distance = ahead_m - behind_m;
        match self {
            Self::Ring(length) if distance < 0.0 => distance + length,
            _ => distance,
        }
    }
}

/// Vehicles in increasing order of their front bumper, from `head` on and round; every column has shape `(n,)`.
#[derive(Debug, Clone, Default)]
pub(super) struct Lane {
    /// Front bumper, in m.
    pub(super) x: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) acc: Vec<f64>,
    pub(super) length: Vec<f64>,
    /// 1 / v0.
    inv_v0: Vec<f64>,
    time_gap: Vec<f64>,
    standstill: Vec<f64>,
    a: Vec<f64>,
    /// 1 / (2 √(ab)).
    inv_2sab: Vec<f64>,
    pub(super) id: Vec<u32>,
    pub(super) role: Vec<Role>,
    /// Step before which the vehicle does not think of changing lane.
    pub(super) busy_until: Vec<u32>,
    /// Index of the vehicle with the smallest x.
    pub(super) head: usize,
}

/// Calls a macro for each column.
macro_rules! columns {
    ($do:ident) => {
        $do!(x, v, acc, length, inv_v0, time_gap, standstill, a, inv_2sab, id, role, busy_until)
    };
}

impl Lane {
    pub(super) fn with_capacity(capacity: usize) -> Self {
        let mut lane = Self::default();
        macro_rules! reserve {
            ($($column:ident),*) => { $( lane.$column.reserve_exact(capacity); )* };
        }
        columns!(reserve);
        lane
    }

    pub(super) fn len(&self) -> usize {
        self.x.len()
    }

    pub(super) fn clear(&mut self) {
        macro_rules! clear {
            ($($column:ident),*) => { $( self.$column.clear(); )* };
        }
        columns!(clear);
        self.head = 0;
    }

    pub(super) fn push(&mut self, x_m: f64, v_mps: f64, id: u32, role: Role, driver: &IdmDriver) {
        self.x.push(x_m);
        self.v.push(v_mps);
        self.acc.push(0.0);
        self.length.push(driver.length_m);
        self.inv_v0.push(1.0 / driver.desired_speed_mps);
        self.time_gap.push(driver.time_gap_s);
        self.standstill.push(driver.standstill_m);
        self.a.push(driver.acceleration_mps2);
        let root = (driver.acceleration_mps2 * driver.braking_mps2).sqrt();
        self.inv_2sab.push(0.5 / root);
        self.id.push(id);
        self.role.push(role);
        self.busy_until.push(0);
    }

    pub(super) fn push_from(&mut self, other: &Self, i: usize) {
        macro_rules! copy {
            ($($column:ident),*) => { $( self.$column.push(other.$column[i]); )* };
        }
        columns!(copy);
    }

    pub(super) fn pop(&mut self) {
        macro_rules! pop {
            ($($column:ident),*) => { $( self.$column.pop(); )* };
        }
        columns!(pop);
    }

    pub(super) fn swap(&mut self, i: usize, j: usize) {
        macro_rules! swap {
            ($($column:ident),*) => { $( self.$column.swap(i, j); )* };
        }
        columns!(swap);
    }

    /// Appends the entries of `other` in `range`, in order.
    pub(super) fn extend_from(&mut self, other: &Self, range: std::ops::Range<usize>) {
        macro_rules! extend {
            ($($column:ident),*) => { $( self.$column.extend_from_slice(&other.$column[range.clone()]); )* };
        }
        columns!(extend);
    }

    /// The i-th entry from the head, as an index.
    pub(super) fn at(&self, rank: usize) -> usize {
        let i = self.head + rank;
        if i >= self.len() { i - self.len() } else { i }
    }

    /// The entry ahead of `i`, if there is one.
    pub(super) fn next(&self, i: usize, ends: Ends) -> Option<usize> {
        let n = self.len();
        match ends {
            Ends::Ring(_) if n > 1 => Some(if i + 1 == n { 0 } else { i + 1 }),
            Ends::Open if i + 1 < n => Some(i + 1),
            _ => None,
        }
    }

    /// The entry behind `i`, if there is one.
    pub(super) fn previous(&self, i: usize, ends: Ends) -> Option<usize> {
        let n = self.len();
        match ends {
            Ends::Ring(_) if n > 1 => Some(if i == 0 { n - 1 } else { i - 1 }),
            Ends::Open if i > 0 => Some(i - 1),
            _ => None,
        }
    }

    /// Bumper to bumper from `i` to the entry ahead, in m, and that one's speed; infinite on free road.
    pub(super) fn lead(&self, i: usize, ends: Ends) -> (f64, f64) {
        match self.next(i, ends) {
            Some(j) => (self.ahead_of(i, j, ends) - self.length[j], self.v[j]),
            None => (f64::INFINITY, self.v[i]),
        }
    }

    /// Distance of the fronts of `i` and of `j`, the entry ahead of it, in m; negative if they are out of order.
    pub(super) fn ahead_of(&self, i: usize, j: usize, ends: Ends) -> f64 {
        let straight = self.x[j] - self.x[i];
        match ends {
            Ends::Ring(length) if j == self.head => straight + length,
            _ => straight,
        }
    }

    /// Acceleration of entry `i` behind a vehicle of speed `lead_v` at `gap`, in m/s².
    ///
    /// # Source
    /// Treiber, Hennecke and Helbing 2000, equations (1) and (2) with δ = 4 and s1 = 0:
    /// a [1 − (v/v0)⁴ − (s*/s)²], s* = s0 + max(0, vT + vΔv / (2√(ab))); braking is bounded.
    #[inline]
    pub(super) fn toward(&self, i: usize, gap: f64, lead_v: f64) -> f64 {
        idm(
            self.v[i],
            self.inv_v0[i],
            self.time_gap[i],
            self.standstill[i],
            self.a[i],
            self.inv_2sab[i],
            gap,
            lead_v,
        )
    }

    /// Every entry's acceleration towards the one ahead.
    pub(super) fn accelerate(&mut self, ends: Ends) {
        let n = self.len();
        if n == 0 {
            return;
        }
        let m = n - 1;
        // Equal lengths, stated once, so that the loop carries no bound checks.
        let (x, ahead_x) = (&self.x[..m], &self.x[1..n]);
        let (v, ahead_v) = (&self.v[..m], &self.v[1..n]);
        let ahead_length = &self.length[1..n];
        let (inv_v0, time_gap) = (&self.inv_v0[..m], &self.time_gap[..m]);
        let (standstill, a) = (&self.standstill[..m], &self.a[..m]);
        let (inv_2sab, acc) = (&self.inv_2sab[..m], &mut self.acc[..m]);
        for i in 0..m {
            acc[i] = idm(
                v[i],
                inv_v0[i],
                time_gap[i],
                standstill[i],
                a[i],
                inv_2sab[i],
                ahead_x[i] - x[i] - ahead_length[i],
                ahead_v[i],
            );
        }
        // The loop took the columns as a straight line: their end, and the seam of a ring, are left.
        let seam = if self.head == 0 { m } else { self.head - 1 };
        for i in [m, seam] {
            let (gap, lead_v) = self.lead(i, ends);
            self.acc[i] = self.toward(i, gap, lead_v);
        }
    }

    /// Moves everybody on by `dt`, holding accelerations; nobody rolls backwards.
    pub(super) fn advance(&mut self, dt: f64, ends: Ends) {
        let n = self.len();
        let (x, v, acc) = (&mut self.x[..n], &mut self.v[..n], &self.acc[..n]);
        let length = match ends {
            Ends::Ring(length) => length,
            Ends::Open => f64::INFINITY,
        };
        let wrap = if length.is_finite() { length } else { 0.0 };
        for i in 0..n {
            let after = v[i] + acc[i] * dt;
            let moved =
                if after < 0.0 { v[i] * v[i] / (-2.0 * acc[i]) } else { 0.5 * (v[i] + after) * dt };
            let there = x[i] + moved;
            x[i] = there - if there >= length { wrap } else { 0.0 };
            v[i] = after.max(0.0);
        }
        if let Ends::Ring(_) = ends {
            self.turn_head();
        }
    }

    /// Finds the smallest x again after some have passed the ring's seam.
    pub(super) fn turn_head(&mut self) {
        let n = self.len();
        for _ in 0..n {
            let before = if self.head == 0 { n - 1 } else { self.head - 1 };
            if self.x[before] >= self.x[self.head] {
                break;
            }
            self.head = before;
        }
    }
}

#[inline]
#[expect(
    clippy::too_many_arguments,
    reason = "one entry of eight columns, kept apart so that the loop over them vectorises"
)]
fn idm(
    v: f64,
    inv_v0: f64,
    time_gap: f64,
    standstill: f64,
    a: f64,
    inv_2sab: f64,
    gap: f64,
    lead_v: f64,
) -> f64 {
    let ratio = v * inv_v0;
    let square = ratio * ratio;
    let dynamic = v * (time_gap + (v - lead_v) * inv_2sab);
    let z = (standstill + dynamic.max(0.0)) / gap.max(LEAST_GAP_M);
    (a * (1.0 - square * square - z * z)).max(-BRAKING_LIMIT_MPS2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two(gap_m: f64, v: f64, lead_v: f64) -> Lane {
        let mut lane = Lane::with_capacity(2);
        lane.push(0.0, v, 0, Role::Moving, &IdmDriver::CAR);
        lane.push(gap_m + 5.0, lead_v, 1, Role::Moving, &IdmDriver::CAR);
        lane
    }

    #[test]
    fn acceleration_is_that_of_the_law() {
        let mut lane = two(30.0, 20.0, 18.0);
        lane.accelerate(Ends::Open);
        let law = IdmDriver::CAR.law();
        let expected = law.accel_mps2(30.0, 20.0, 18.0);
        assert!((lane.acc[0] - expected).abs() < 1e-12, "{:?}", lane.acc);
        let free = law.accel_mps2(f64::INFINITY, 18.0, 18.0);
        assert!((lane.acc[1] - free).abs() < 1e-12);
    }

    #[test]
    fn the_last_on_a_ring_follows_the_first() {
        let mut lane = two(30.0, 20.0, 18.0);
        lane.accelerate(Ends::Ring(100.0));
        let alone = lane.toward(1, 100.0 - 35.0 - 5.0, 20.0);
        assert!((lane.acc[1] - alone).abs() < 1e-12);
    }

    #[test]
    fn a_car_that_stops_within_the_step_stops_where_it_brakes_to() {
        let mut lane = two(1e6, 0.5, 0.0);
        lane.acc = vec![-8.0, 0.0];
        lane.advance(0.1, Ends::Open);
        assert!((lane.x[0] - 0.25 / 16.0).abs() < 1e-12 && lane.v[0].abs() < 1e-12);
    }

    #[test]
    fn the_head_turns_with_the_ring() {
        let mut lane = two(30.0, 20.0, 20.0);
        lane.x = vec![60.0, 99.0];
        lane.advance(0.1, Ends::Ring(100.0));
        assert_eq!((lane.head, lane.x[1] < 2.0), (1, true));
        lane.x = vec![99.0, 10.0];
        lane.head = 1;
        lane.advance(0.1, Ends::Ring(100.0));
        assert_eq!(lane.head, 0);
        assert!(lane.x[0] < lane.x[1]);
    }
}
