//! Guesses units from names and from what vehicles can do.

use super::columns::TableColumn;
use crate::mapping::FOOT_M;

/// Units of length.
pub(super) const LENGTHS: [&str; 2] = ["m", "ft"];
/// Lengths of cars, in m; the median of a table lies here.
const CARS_M: (f64, f64) = (2.5, 8.0);
/// Drivers seldom change speed faster than this, in m/s².
const HARD_MPS2: f64 = 4.0;

/// Why a unit was guessed, and whether that leaves a doubt.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reason {
    pub(super) why: String,
    pub(super) doubt: bool,
}

/// A unit, and why it is that.
pub(super) type Guessed = (&'static str, Reason);

fn sure(unit: &'static str, why: impl Into<String>) -> Guessed {
    let (why, doubt) = (why.into(), false);
    (unit, Reason { why, doubt })
}

fn doubt(unit: &'static str, why: impl Into<String>) -> Guessed {
    let (why, doubt) = (why.into(), true);
    (unit, Reason { why, doubt })
}

/// Units of time, and seconds in one.
const TIMES: [(&str, f64); 5] = [
    ("s", 1.0),
    ("ms", 1e-3),
    ("us", 1e-6),
    ("ns", 1e-9),
    ("frames", 1.0 / 25.0),
];

/// Seconds in a unit of time.
pub(super) fn seconds(unit: &str) -> f64 {
    TIMES.iter().find(|u| u.0 == unit).map_or(1.0, |u| u.1)
}

/// The unit of time, from its name, its size and its step.
pub(super) fn time_unit(
    column: Option<&TableColumn>,
    pattern: Option<&str>,
    named: Option<&'static str>,
    step: Option<f64>,
) -> Guessed {
    let Some(column) = column else {
        return doubt("s", "no column looks like a time");
    };
    if column.numbers.is_none() {
        return match pattern {
            Some(_) => sure("pattern", "its cells are times as `time_pattern` says"),
            None => sure("iso8601", "its cells are dates"),
        };
    }
    let largest = column.range().map_or(0.0, |(a, b)| a.abs().max(b.abs()));
    let step = step.unwrap_or(0.0);
    // Step in seconds that a unit gives: drives are sampled between once a second and a thousand times.
    let fits = |unit: &str| (0.0009..=1.5).contains(&(step * seconds(unit)));
    let units = || TIMES[..4].iter().map(|u| u.0);
    if let Some(unit) = units().find(|u| Some(*u) == named && fits(u)) {
        return sure(unit, "its name says so");
    }
    let since_1970 = [("ns", 1e17), ("us", 1e14), ("ms", 1e11), ("s", 1e8)];
    if let Some((unit, _)) = since_1970.iter().find(|(_, least)| largest >= *least) {
        return sure(unit, "its size is that of a date since 1970");
    }
    let by_one = (step - 1.0).abs() < 1e-9;
    if by_one && column.whole() && column.name.to_ascii_lowercase().contains("frame") {
        let why = "whole numbers that rise by one: frames, at 25 a second?";
        return doubt("frames", why);
    }
    let Some(unit) = units().find(|u| fits(u)) else {
        return doubt("s", format!("its step is {step}, which fits no unit"));
    };
    let why = format!("its step is {step:.6}, {:.6} s", step * seconds(unit));
    if by_one {
        doubt(unit, why)
    } else {
        sure(unit, why)
    }
}

/// Ratios of a speed to a change of position a second, each by its units.
const RATIOS: [(&str, &str, f64); 8] = [
    ("m", "m/s", 1.0),
    ("m", "km/h", 3.6),
    ("m", "mph", 2.236_936),
    ("m", "ft/s", 1.0 / FOOT_M),
    ("ft", "ft/s", 1.0),
    ("ft", "mph", 0.681_818),
    ("ft", "km/h", 1.097_28),
    ("ft", "m/s", FOOT_M),
];

/// The units of length and speed of some that give the nearest ratio, that ratio, and how far off it is (0: exactly).
fn nearest_ratio(
    ratio: f64,
    of: impl Fn(&str, &str) -> bool,
) -> Option<(&'static str, &'static str, f64, f64)> {
    let fits = RATIOS.iter().filter(|r| of(r.0, r.1));
    let off = fits.map(|&(length, speed, r)| (length, speed, r, libm::log(ratio / r).abs()));
    off.min_by(|a, b| a.3.total_cmp(&b.3))
}

/// The nearest ratio that units can give, and how far off it is (0: exactly).
pub(super) fn known_ratio(ratio: f64) -> (f64, f64) {
    nearest_ratio(ratio, |_, _| true).map_or((1.0, f64::INFINITY), |r| (r.2, r.3))
}

/// As a name says; else by the lengths of vehicles, the unit of speeds and `ratio`, or the `harshest` change of speed.
pub(super) fn length_unit(
    named: Option<&'static str>,
    lengths: [Option<&TableColumn>; 2],
    named_speed: Option<&'static str>,
    ratio: Option<f64>,
    harshest: Option<f64>,
) -> Guessed {
    if let Some(unit) = named {
        return sure(unit, "a name says so");
    }
    let known = lengths.into_iter().flatten().find_map(|c| {
        let median = c.quantile(0.5).filter(|m| *m > 0.0)?;
        Some((&c.name, median))
    });
    if let Some((name, median)) = known {
        let cars = |m: f64| (CARS_M.0..=CARS_M.1).contains(&m);
        let why = |unit: &str| format!("vehicles are {median:.1} long by `{name}`: {unit}");
        return match (cars(median), cars(median * FOOT_M)) {
            (true, false) => sure("m", why("metres")),
            (false, true) => sure("ft", why("feet")),
            // Between 8.2 and 8 nothing lies, so this is neither.
            _ => doubt("m", why("neither cars in metres nor in feet")),
        };
    }
    if let (Some(speed), Some(ratio)) = (named_speed, ratio)
        && let Some((length, ..)) = nearest_ratio(ratio, |_, s| s == speed)
    {
        return sure(length, format!("positions move as a speed in {speed} says"));
    }
    let Some(harshest) = harshest else {
        return doubt("m", "nothing says it");
    };
    let same = |r: f64| (known_ratio(r).0 - 1.0).abs() < 1e-9;
    if ratio.is_some_and(same) && harshest > HARD_MPS2 {
        let what = "a second, which in m/s would be hard braking";
        return doubt("ft", format!("speeds change by {harshest:.1} {what}"));
    }
    let what = "no name and no vehicle length says it; speeds change by at most";
    doubt("m", format!("{what} {harshest:.1} a second"))
}

pub(super) fn speed_unit(
    named: Option<&'static str>,
    length: &'static str,
    ratio: Option<f64>,
    column: Option<&TableColumn>,
) -> Guessed {
    let units = ["m/s", "km/h", "mph", "ft/s"];
    if let Some(unit) = named.filter(|n| units.contains(n)) {
        return sure(unit, "its name says so");
    }
    if let Some(ratio) = ratio
        && let Some((_, speed, _, off)) = nearest_ratio(ratio, |l, _| l == length)
        && off < 0.2
    {
        let what = format!("times what positions in {length} change a second");
        return sure(speed, format!("it is {ratio:.3} {what}"));
    }
    let fastest = column.and_then(|c| c.quantile(0.99)).unwrap_or(0.0);
    let (unit, what) = match fastest {
        f if f <= 45.0 => ("m/s", "m/s is likely, mph possible"),
        f if f <= 85.0 => ("km/h", "km/h, mph and ft/s are all possible"),
        _ => ("km/h", "km/h is likely"),
    };
    doubt(unit, format!("its 99th percentile is {fastest:.1}: {what}"))
}

/// What a gap is measured between, and why.
pub(super) fn gap_kind(
    gap: &TableColumn,
    ego_x: Option<&TableColumn>,
    lead_x: Option<&TableColumn>,
    lead_length: Option<&TableColumn>,
    length: &str,
) -> (&'static str, String) {
    let numbers = |c: Option<&TableColumn>| c.and_then(|c| c.numbers.clone());
    let (gaps, ego, lead) = (numbers(Some(gap)), numbers(ego_x), numbers(lead_x));
    if let (Some(gaps), Some(ego), Some(lead)) = (gaps, ego, lead) {
        let lengths = numbers(lead_length).unwrap_or_else(|| vec![0.0; gaps.len()]);
        let mut left: Vec<(f64, f64)> = (0..gaps.len())
            .map(|i| (lead[i] - ego[i] - gaps[i], lengths[i]))
            .filter(|(over, long)| over.is_finite() && long.is_finite())
            .collect();
        left.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let Some(&(over, long)) = left.get(left.len() / 2) {
            if long > 0.0 && (over - long).abs() < 0.05 * long {
                let why = "it is the distance of the positions less the leader's length";
                return ("bumper_to_bumper", why.to_owned());
            }
            if long > 0.0 && over.abs() < 0.05 * long {
                let why = "it is the distance of the positions, and the leader has a length";
                return ("front_to_front", why.to_owned());
            }
        }
    }
    let name = gap.name.to_ascii_lowercase();
    if name.contains("headway") || name.contains("dhw") {
        let why = "doubt: a headway is usually from front to front; check what yours is";
        return ("front_to_front", why.to_owned());
    }
    let least = gap.quantile(0.001).unwrap_or(0.0);
    let why = format!(
        "doubt: nothing but the name says it; the smallest is {least:.1} {length}, and standing cars keep 1 to 3 m \
         between bumpers"
    );
    ("bumper_to_bumper", why)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str, numbers: impl IntoIterator<Item = f64>) -> TableColumn {
        TableColumn {
            name: name.to_owned(),
            numbers: Some(numbers.into_iter().collect()),
            words: Vec::new(),
        }
    }

    /// The unit, and whether there is a doubt.
    fn told((unit, reason): Guessed) -> (&'static str, bool) {
        (unit, reason.doubt)
    }

    #[test]
    fn a_unit_of_time_follows_from_the_name_the_size_and_the_step() {
        let of = |name: &str, numbers: [f64; 3], named, step| {
            told(time_unit(
                Some(&column(name, numbers)),
                None,
                named,
                Some(step),
            ))
        };
        let small = [0.0, 1.0, 2.0];
        assert_eq!(of("t_ms", small, Some("ms"), 50.0), ("ms", false));
        // A name that the step denies says nothing.
        assert_eq!(of("t_ms", small, Some("ms"), 0.05), ("s", false));
        for (unit, largest, step) in [
            ("ns", 1.7e18, 1e8),
            ("us", 1.7e15, 1e5),
            ("ms", 1.7e12, 100.0),
            ("s", 1.7e9, 0.1),
        ] {
            assert_eq!(of("t", [largest, largest, -1.0], None, step), (unit, false));
        }
        assert_eq!(of("Frame_ID", small, None, 1.0), ("frames", true));
        assert_eq!(of("frame", [0.0, 0.5, 2.0], None, 1.0), ("s", true));
        // By one second, or by one of a number: a doubt.
        assert_eq!(of("t", small, None, 1.0), ("s", true));
        for (step, unit) in [
            (0.0009, "s"),
            (1.5, "s"),
            (1.6, "ms"),
            (1500.0, "ms"),
            (1600.0, "us"),
            (2e6, "ns"),
        ] {
            assert_eq!(of("t", small, None, step), (unit, false), "{step}");
        }
        assert_eq!(of("t", small, None, 2e9), ("s", true));
        assert_eq!(told(time_unit(None, None, None, None)), ("s", true));
        let dates = TableColumn {
            numbers: None,
            ..column("t", [])
        };
        assert_eq!(
            told(time_unit(Some(&dates), None, None, None)),
            ("iso8601", false)
        );
        let written = time_unit(Some(&dates), Some("%H:%M"), None, None);
        assert_eq!(told(written), ("pattern", false));
        let all = ["s", "ms", "us", "ns", "frames", "?"].map(seconds);
        let expected = [1.0, 1e-3, 1e-6, 1e-9, 0.04, 1.0];
        assert_eq!(all.map(f64::to_bits), expected.map(f64::to_bits));
    }

    #[test]
    fn a_unit_of_length_follows_from_a_name_the_cars_the_speed_and_the_braking() {
        let cars = |median: f64| column("len", [median; 3]);
        let by_cars = |median: f64| {
            told(length_unit(
                None,
                [None, Some(&cars(median))],
                None,
                None,
                None,
            ))
        };
        assert_eq!(
            told(length_unit(
                Some("ft"),
                [Some(&cars(4.5)), None],
                None,
                None,
                None
            )),
            ("ft", false)
        );
        for (median, unit, doubt) in [
            (4.5, "m", false),
            (2.5, "m", false),
            (8.0, "m", false),
            (15.0, "ft", false),
            (26.0, "ft", false),
            (8.1, "m", true),
            (60.0, "m", true),
        ] {
            assert_eq!(by_cars(median), (unit, doubt), "{median}");
        }
        // Without a length the speed's unit tells, by how fast positions move.
        let by_speed = |speed, ratio| {
            told(length_unit(
                None,
                [Some(&cars(0.0)), None],
                Some(speed),
                Some(ratio),
                None,
            ))
        };
        assert_eq!(by_speed("km/h", 3.6), ("m", false));
        assert_eq!(by_speed("km/h", 1.1), ("ft", false));
        assert_eq!(by_speed("mph", 2.2), ("m", false));
        assert_eq!(by_speed("mph", 0.7), ("ft", false));
        assert_eq!(by_speed("m/s", 0.31), ("ft", false));
        let by_braking =
            |ratio, harshest| told(length_unit(None, [None, None], None, ratio, harshest));
        assert_eq!(by_braking(Some(1.0), Some(HARD_MPS2 + 0.1)), ("ft", true));
        assert_eq!(by_braking(Some(1.0), Some(HARD_MPS2)), ("m", true));
        assert_eq!(by_braking(Some(3.6), Some(20.0)), ("m", true));
        assert_eq!(by_braking(Some(1.0), None), ("m", true));
    }

    #[test]
    fn a_unit_of_speed_follows_from_the_name_the_positions_and_how_fast_the_fastest_are() {
        let fast = |v: f64| column("v", [v; 4]);
        let of =
            |named, length, ratio, v: f64| told(speed_unit(named, length, ratio, Some(&fast(v))));
        assert_eq!(of(Some("mph"), "m", Some(1.0), 30.0), ("mph", false));
        assert_eq!(of(Some("s"), "m", Some(1.0), 30.0), ("m/s", false));
        for (length, ratio, unit) in [
            ("m", 3.5, "km/h"),
            ("m", 2.3, "mph"),
            ("m", 3.3, "ft/s"),
            ("ft", 1.0, "ft/s"),
            ("ft", 0.67, "mph"),
            ("ft", 1.12, "km/h"),
            ("ft", 0.3, "m/s"),
        ] {
            assert_eq!(
                of(None, length, Some(ratio), 30.0),
                (unit, false),
                "{length} {ratio}"
            );
        }
        // Too far off from any.
        assert_eq!(of(None, "m", Some(10.0), 30.0), ("m/s", true));
        for (v, unit) in [
            (45.0, "m/s"),
            (45.1, "km/h"),
            (85.0, "km/h"),
            (120.0, "km/h"),
        ] {
            assert_eq!(of(None, "m", None, v), (unit, true), "{v}");
        }
        assert!(
            speed_unit(None, "m", None, Some(&fast(80.0)))
                .1
                .why
                .contains("all possible")
        );
        assert!(
            speed_unit(None, "m", None, Some(&fast(90.0)))
                .1
                .why
                .contains("is likely")
        );
        let (ratio, off) = known_ratio(3.6 * 1.1);
        assert!((ratio - 3.6).abs() < 1e-12 && (off - 1.1_f64.ln()).abs() < 1e-12);
    }

    #[test]
    fn a_gap_is_told_by_the_positions_and_the_length_else_by_its_name() {
        let n = 20;
        let ego = column("x", (0..n).map(f64::from));
        let lead = column(
            "lead_x",
            (0..n).map(|i| f64::from(i) + 30.0 + 0.1 * f64::from(i)),
        );
        let long = column("lead_length", vec![5.0; 20]);
        let gap =
            |name: &str, less: f64| column(name, (0..n).map(|i| 30.0 + 0.1 * f64::from(i) - less));
        let of = |gap: &TableColumn, length: Option<&TableColumn>| {
            gap_kind(gap, Some(&ego), Some(&lead), length, "m")
        };
        for (less, kind) in [
            (5.0, "bumper_to_bumper"),
            (4.8, "bumper_to_bumper"),
            (0.0, "front_to_front"),
            (0.2, "front_to_front"),
        ] {
            let (found, why) = of(&gap("headway", less), Some(&long));
            assert_eq!(found, kind, "{less}");
            assert!(!why.starts_with("doubt"));
        }
        // Neither: then the name says it, and it may be wrong.
        for (name, less, kind) in [
            ("gap", 2.5, "bumper_to_bumper"),
            ("Headway", 2.5, "front_to_front"),
            ("DHW", 2.5, "front_to_front"),
        ] {
            let (found, why) = of(&gap(name, less), Some(&long));
            assert_eq!(found, kind, "{name}");
            assert!(why.starts_with("doubt"));
        }
        let (found, why) = of(&gap("gap", 0.0), None);
        assert_eq!(found, "bumper_to_bumper");
        assert!(why.contains("the smallest is 30.0 m"), "{why}");
    }
}
