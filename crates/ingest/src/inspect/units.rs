//! Guesses units from names and from what vehicles can do.

use super::columns::TableColumn;

/// Units of length.
pub(super) const LENGTHS: [&str; 2] = ["m", "ft"];
/// Metres a foot.
const FOOT_M: f64 = 0.3048;
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

/// The unit of length.
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

/// The unit of speed.
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
