//! Times that are written by a pattern, such as `20220702 18:26:03:8236`.

use chrono::{
    DateTime, NaiveDateTime, NaiveTime,
    format::{Item, StrftimeItems},
};

/// Whether a pattern can be read: `%f`, a fraction of any width, may stand at its end alone.
pub(super) fn is_pattern(pattern: &str) -> bool {
    let whole = pattern.strip_suffix("%f").unwrap_or(pattern);
    let mut items = StrftimeItems::new(whole);
    !whole.is_empty() && !whole.contains("%f") && items.all(|item| item != Item::Error)
}

/// A time by a pattern, in ns since 1970, or since midnight where it has no date. `%f` at the end is a fraction of any width.
pub(crate) fn patterned(text: &str, pattern: &str) -> Option<i64> {
    let (whole, pattern, fraction_ns) = match pattern.strip_suffix("%f") {
        None => (text, pattern, 0),
        Some(pattern) => {
            let digits = text.len() - text.trim_end_matches(|c: char| c.is_ascii_digit()).len();
            let (whole, digits) = text.split_at(text.len() - digits);
            let nine = format!("{digits:0<9}");
            (whole, pattern, nine.get(..9)?.parse().ok().filter(|_| !digits.is_empty())?)
        }
    };
    let time = NaiveDateTime::parse_from_str(whole, pattern).ok().or_else(|| {
        let time = NaiveTime::parse_from_str(whole, pattern).ok()?;
        Some(DateTime::UNIX_EPOCH.date_naive().and_time(time))
    })?;
    time.and_utc().timestamp_nanos_opt()?.checked_add(fraction_ns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_reads_a_fraction_of_any_width_and_a_time_of_day() {
        let pattern = "%Y%m%d %H:%M:%S:%f";
        let whole = DateTime::parse_from_rfc3339("2022-07-02T18:26:03Z").unwrap();
        let whole = whole.timestamp_nanos_opt().unwrap();
        for (text, ns) in [("8236", 823_600_000), ("08", 80_000_000), ("123456789", 123_456_789)] {
            let found = patterned(&format!("20220702 18:26:03:{text}"), pattern);
            assert_eq!(found, Some(whole + ns), "{text}");
        }
        assert_eq!(patterned("00:01:02.5", "%H:%M:%S.%f"), Some(62_500_000_000));
        assert_eq!(patterned("20220702 18:26:03:", pattern), None);
        assert_eq!(patterned("18:26:03:8236", pattern), None);
        assert!(is_pattern(pattern) && !is_pattern("%H:%f:%S") && !is_pattern("%Q"));
    }
}
