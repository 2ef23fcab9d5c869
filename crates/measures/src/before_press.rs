//! What a ride was like before somebody pressed "uncomfortable", and at other moments of the same minute.

use crate::objective::{cut_ins, derivatives, inverse_time_to_collision};
use maveric_domain::{Drive, press::PressMoment};

/// From when on a press counts, in s: before, a person looks about.
const FIRST_S: f64 = 20.0;
/// So long after a press nobody is asked again, in s: a second press there is of the same cause.
const AFTER_S: f64 = 5.0;
/// What came before a moment is what happened from so long to so short before it, in s: a hand needs half a second.
const BEFORE_S: [f64; 2] = [4.0, 0.5];
/// How far the course before a press is shown, in s.
const COURSE_S: f64 = 10.0;
/// A press is held against moments of the same minute.
const MINUTE_S: f64 = 60.0;
/// Border of the low pass behind which accelerations are taken, in Hz.
const BORDER_HZ: f64 = 1.0;

/// The moments of every minute of a ride in which somebody pressed (`presses_s`: times since its start, in s), one a second and one a press,
/// and those of the ten seconds before each press.
///
/// A press takes part that comes 20 s after the start or later and not within 5 s of the press before. Each other second of its minute
/// from 20 s on takes part, with its middle, unless somebody pressed in it; those soon after a press, too, since the ride goes on as it would
/// have, and leaving moments out by where a press lies would lean the odds.
///
/// # Source
/// The design is Maclure's (1991), with minutes of one ride as fixed strata, so that no moment is chosen by where a press lies (Janes,
/// Sheppard and Lumley, 2005). The borders are ours.
pub fn press_moments(drive: &Drive, presses_s: &[f64]) -> Vec<PressMoment> {
    let mut presses = presses_s.to_vec();
    presses.sort_by(f64::total_cmp);
    let rows = drive.rows();
    let Some((first_s, last_s)) = rows.time_s.first().zip(rows.time_s.last()) else {
        return Vec::new();
    };
    let end_s = last_s - first_s;
    let in_time = |t: f64| t >= FIRST_S && t <= end_s;
    let soon_after = |t: f64| presses.iter().any(|p| *p < t && t - p <= AFTER_S);
    let counted = presses.iter().copied();
    let counted: Vec<f64> = counted.filter(|t| in_time(*t) && !soon_after(*t)).collect();
    let exposures = Exposures::from_drive(drive);
    let mut moments = Vec::new();
    for second in 0..end_s.floor() as u32 {
        let start_s = f64::from(second);
        let minute = |t: f64| (t / MINUTE_S) as u32;
        let within = |p: &&f64| **p >= start_s && **p < start_s + 1.0;
        if let Some(press) = counted.iter().find(within) {
            moments.push(exposures.at(*press, minute(*press), (true, true), Some(0.0)));
            continue;
        }
        let middle_s = start_s + 0.5;
        let with_press = counted.iter().any(|p| minute(*p) == minute(middle_s));
        let pressed_here = presses.iter().any(|p| within(&p));
        let at_risk = with_press && in_time(middle_s) && !pressed_here;
        let next = counted.iter().find(|p| **p > middle_s);
        let to_press = next.map(|p| p - middle_s).filter(|s| *s <= COURSE_S);
        if at_risk || to_press.is_some() {
            moments.push(exposures.at(middle_s, minute(middle_s), (false, at_risk), to_press));
        }
    }
    moments
}

/// Every second of a ride, with what came before its middle, as somebody may press in it.
pub fn seconds_of(drive: &Drive) -> Vec<PressMoment> {
    let time_s = &drive.rows().time_s;
    let ends = time_s.first().zip(time_s.last());
    let seconds = ends.map_or(0.0, |(first, last)| last - first).floor() as u32;
    let exposures = Exposures::from_drive(drive);
    let second = |second| {
        let middle_s = f64::from(second) + 0.5;
        let minute = (middle_s / MINUTE_S) as u32;
        exposures.at(middle_s, minute, (false, true), None)
    };
    (0..seconds).map(second).collect()
}

/// The signals of a ride from which exposures are taken, a value a row.
struct Exposures<'a> {
    drive: &'a Drive,
    acceleration: Option<Vec<Option<f64>>>,
    jerk: Option<Vec<Option<f64>>>,
    aside: Option<Vec<Option<f64>>>,
    /// Rows at which a vehicle has just cut in.
    cut_in: Vec<usize>,
}

impl<'a> Exposures<'a> {
    fn from_drive(drive: &'a Drive) -> Self {
        let rows = drive.rows();
        let along = derivatives(drive, &rows.ego_speed_mps, BORDER_HZ);
        let (acceleration, jerk) = along.map_or((None, None), |[a, j]| (Some(a), Some(j)));
        let lateral = drive.has_lateral();
        let aside = derivatives(drive, &rows.ego_y_m, BORDER_HZ).filter(|_| lateral);
        Self {
            drive,
            acceleration,
            jerk,
            aside: aside.map(|[_, acceleration]| acceleration),
            cut_in: cut_ins(drive).collect(),
        }
    }

    /// The moment at this time, with what came before it.
    fn at(
        &self,
        time_s: f64,
        minute: u32,
        (pressed, at_risk): (bool, bool),
        to_press_s: Option<f64>,
    ) -> PressMoment {
        let (drive, rows) = (self.drive, self.drive.rows());
        let start = rows.time_s.first().copied().unwrap_or(0.0);
        let [from, to] = BEFORE_S.map(|before| {
            let end = start + time_s - before;
            rows.time_s.partition_point(|t| *t < end)
        });
        let window = from..to;
        let most = |signal: &Option<Vec<Option<f64>>>, size: fn(f64) -> f64| {
            let values = signal.as_ref()?[window.clone()].iter().flatten();
            values.map(|v| size(*v)).reduce(f64::max)
        };
        let ahead = || window.clone().filter(|row| drive.lead_ahead(*row));
        let yes_or_no = |is: bool| f64::from(u8::from(is));
        let seen = drive.has_lateral() && !window.is_empty();
        PressMoment {
            participant: drive.meta().participant.clone(),
            condition: drive.meta().condition,
            drive: drive.meta().drive.clone(),
            minute,
            time_s,
            pressed,
            at_risk,
            to_press_s,
            least_gap_m: ahead().map(|row| rows.lead_dx_m[row]).reduce(f64::min),
            inverse_time_to_collision_per_s: window
                .clone()
                .map(|row| inverse_time_to_collision(drive, row))
                .reduce(f64::max),
            braking_mps2: most(&self.acceleration, |a| (-a).max(0.0)),
            jerk_mps3: most(&self.jerk, f64::abs),
            lateral_acceleration_mps2: most(&self.aside, f64::abs),
            lane_change: seen.then(|| yes_or_no(window.clone().any(|row| rows.changing[row] != 0))),
            cut_in: seen.then(|| yes_or_no(self.cut_in.iter().any(|row| window.contains(row)))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::testing::{Scripted, by_rows};

    fn steady(seconds: f64) -> Drive {
        Scripted::new(seconds).lead(400.0, 25.0).drive()
    }

    /// What a drive was like before its one press.
    fn pressed(drive: &Drive, press_s: f64) -> PressMoment {
        let moments = press_moments(drive, &[press_s]);
        moments.into_iter().find(|m| m.pressed).unwrap()
    }

    fn times(moments: &[PressMoment], which: impl Fn(&PressMoment) -> bool) -> Vec<f64> {
        let chosen = moments.iter().filter(|m| which(m));
        chosen.map(|m| m.time_s).collect()
    }

    #[test]
    fn a_press_is_held_against_all_other_seconds_of_its_minute() {
        let moments = press_moments(&steady(200.0), &[75.3]);
        assert_eq!(times(&moments, |m| m.pressed), [75.3]);
        let others = times(&moments, |m| m.at_risk && !m.pressed);
        assert_eq!(others.len(), 60 - 1);
        assert!(others.iter().all(|t| (60.0..120.0).contains(t)));
        assert!(others.contains(&60.5) && others.contains(&119.5) && others.contains(&76.5));
        assert!(moments.iter().all(|m| m.minute == 1));
    }

    #[test]
    fn presses_at_the_start_and_soon_after_another_take_no_part() {
        let moments = press_moments(&steady(100.0), &[10.0, 70.0, 74.0]);
        assert_eq!(times(&moments, |m| m.pressed), [70.0]);
        // The second of a press that takes no part is no moment without one.
        let others = times(&moments, |m| m.at_risk);
        assert!(!others.contains(&74.5) && others.contains(&73.5) && others.contains(&75.5));
        assert!(press_moments(&steady(100.0), &[]).is_empty());
        assert!(press_moments(&steady(100.0), &[150.0]).is_empty());
        let first_minute = press_moments(&steady(100.0), &[30.0]);
        assert!(times(&first_minute, |m| m.at_risk).iter().all(|t| *t >= 20.0));
    }

    #[test]
    fn the_course_before_a_press_reaches_into_the_minute_before() {
        let moments = press_moments(&steady(100.0), &[62.0]);
        let course = times(&moments, |m| m.to_press_s.is_some());
        assert_eq!(course.first(), Some(&52.5));
        assert!(times(&moments, |m| m.at_risk).iter().all(|t| *t >= 60.0));
        let just_before = moments.iter().find(|m| (m.time_s - 61.5).abs() < 1e-9).unwrap();
        assert_eq!(just_before.to_press_s, Some(0.5));
    }

    #[test]
    fn what_came_before_is_of_the_four_seconds_that_end_half_a_second_before() {
        // Braking from 68 to 70 s.
        let brakes = |t: f64| 30.0 - 3.0 * (t - 68.0).clamp(0.0, 2.0);
        let drive = Scripted::new(120.0).speed(brakes).lead(400.0, 24.0).drive();
        let braking = |press_s: f64| pressed(&drive, press_s).braking_mps2.unwrap();
        assert!((2.5..3.3).contains(&braking(71.0)), "{}", braking(71.0));
        assert!(braking(67.0) < 0.1 && braking(78.0) < 0.1);
        assert!(braking(68.3) < 0.1, "what begins .3 s before was too late to be its cause");
    }

    #[test]
    fn each_exposure_is_there_where_it_happened_and_not_elsewhere() {
        let drive = Scripted::new(120.0).lead(60.0, 29.0).pass(70.0, 90.0).drive();
        let (quiet, changing) = (pressed(&drive, 50.0), pressed(&drive, 73.0));
        assert_eq!((quiet.lane_change, changing.lane_change), (Some(0.0), Some(1.0)));
        let aside = |m: &PressMoment| m.lateral_acceleration_mps2.unwrap();
        assert!(aside(&changing) > 0.5 && aside(&quiet) < 0.05);
        // It closes in by 1 m/s.
        let gap = quiet.least_gap_m.unwrap();
        assert!((gap - (60.0 - 49.5)).abs() < 0.1, "{gap}");
        let closing = quiet.inverse_time_to_collision_per_s.unwrap();
        assert!((closing - 1.0 / gap).abs() < 1e-2, "{closing}");
        let opening = pressed(&Scripted::new(120.0).lead(60.0, 33.0).drive(), 50.0);
        assert_eq!(opening.inverse_time_to_collision_per_s, Some(0.0));
        let alone = press_moments(&Scripted::new(120.0).drive(), &[50.0]);
        assert_eq!(alone[0].least_gap_m, None);
    }

    #[test]
    fn a_vehicle_that_cuts_in_is_seen_and_a_rig_without_lanes_says_nothing_of_them() {
        let drive = by_rows(10.0, 1000, |rows| {
            rows.lead_id[400..].fill(Some(2));
            rows.lead_dy_m[400..410].fill(1.8);
            rows.lead_dx_m[400..].fill(10.0);
        });
        let cut_in = |press_s: f64| pressed(&drive, press_s).cut_in;
        assert_eq!((cut_in(42.0), cut_in(60.0)), (Some(1.0), Some(0.0)));
        let blind = pressed(&drive.without_lateral(), 42.0);
        assert_eq!((blind.cut_in, blind.lane_change), (None, None));
        assert!(blind.lateral_acceleration_mps2.is_none() && blind.braking_mps2.is_some());
    }
}
