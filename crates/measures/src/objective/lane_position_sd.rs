//! How much a person wanders in the lane.

use super::{Measure, Shown};
use maveric_domain::Drive;

/// Standard deviation of the place in the lane.
///
/// # Source
/// SDLP, the weaving of the car: Verster and Roth (2011), Standard operation procedures for conducting the on-the-road driving test, and
/// measurement of the standard deviation of lateral position, by abstract and summary, where overtaking is cut out of the data too. Ours:
/// only between changes of lane, less 2 s on both sides of each, and about the mean of
/// each stretch between two changes, so that a person's place in one lane and in another are no wandering. From 5 Hz on. A drive with
/// places that were [cut off](maveric_domain::Road::is_cut_off) at the edge of the lane has none.
pub(super) const MEASURE: Measure = Measure {
    name: "lane_position_sd_m",
    title: "Standard deviation of the lane position",
    unit: "m",
    shown: Shown::In("m"),
    aggression: None,
    description: "Standard deviation of the place in the lane about its mean in each stretch between lane changes, less 2 s on both sides of a change.",
    of_passing: true,
    grows: false,
    why_missing: "less than 10 s between lane changes, below 5 Hz, a log without lateral positions, or places beyond the lane, which ingest cuts off at its edge",
    value,
};

/// What is left out on both sides of a change, in s.
const MARGIN_S: f64 = 2.0;
/// Lowest rate at which it is measured, in Hz.
const LOWEST_HZ: f64 = 5.0;
/// Shortest time between changes in all, in s.
const SHORTEST_S: f64 = 10.0;

fn value(drive: &Drive) -> Option<f64> {
    let rows = drive.rows();
    if drive.rate_hz() < LOWEST_HZ {
        return None;
    }
    let margin = (MARGIN_S * drive.rate_hz()).round() as usize;
    let mut keeps = vec![true; drive.len()];
    for row in (0..drive.len()).filter(|row| rows.changing[*row] != 0) {
        let end = (row + margin + 1).min(drive.len());
        keeps[row.saturating_sub(margin)..end].fill(false);
    }
    let place_m = |row: usize| rows.ego_y_m[row] - drive.road().lane_centre_m(rows.lane[row]);
    let mut stretches: Vec<Vec<f64>> = Vec::new();
    let mut goes_on = false;
    for (row, keeps) in keeps.into_iter().enumerate() {
        if !keeps {
            goes_on = false;
            continue;
        }
        let same = row > 0
            && rows.segment[row] == rows.segment[row - 1]
            && rows.lane[row] == rows.lane[row - 1];
        match stretches.last_mut().filter(|_| goes_on && same) {
            Some(stretch) => stretch.push(place_m(row)),
            None => stretches.push(vec![place_m(row)]),
        }
        goes_on = true;
    }
    if stretches.iter().flatten().any(|place| drive.road().is_cut_off(*place)) {
        return None;
    }
    let n: usize = stretches.iter().map(Vec::len).sum();
    if (n as f64) < SHORTEST_S * drive.rate_hz() {
        return None;
    }
    let squares = stretches.iter().map(|stretch| {
        let mean = stretch.iter().sum::<f64>() / stretch.len() as f64;
        stretch.iter().map(|place| (place - mean).powi(2)).sum::<f64>()
    });
    let freedom = n - stretches.len();
    (freedom > 0).then(|| (squares.sum::<f64>() / freedom as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;
    use maveric_domain::Road;

    /// Twenty seconds at 10 Hz in the middle of the right lane, half a metre to both sides in turn.
    fn wandering(
        rate_hz: f64,
        n: usize,
        change: impl FnOnce(&mut maveric_domain::drive::Rows),
    ) -> Drive {
        by_rows(rate_hz, n, |rows| {
            let centre = Road::PAPER.lane_centre_m(0);
            rows.ego_y_m =
                (0..n).map(|row| centre + if row % 2 == 0 { 0.5 } else { -0.5 }).collect();
            change(rows);
        })
    }

    #[test]
    fn half_a_metre_to_both_sides_is_half_a_metre() {
        let sd = MEASURE.of(&wandering(10.0, 200, |_| ())).unwrap();
        assert!((sd - 0.5 * (200.0_f64 / 199.0).sqrt()).abs() < 1e-12, "{sd}");
        let still = by_rows(10.0, 200, |_| ());
        assert_eq!(MEASURE.of(&still), Some(0.0));
    }

    #[test]
    fn a_change_and_two_seconds_around_it_do_not_count_and_neither_does_a_place_of_ones_own_in_each_lane()
     {
        let width = Road::PAPER.lane_width_m;
        let passing = |rows: &mut maveric_domain::drive::Rows| {
            // Out of the lane for all the rows that are left out, and 0.4 m further left afterwards.
            rows.changing[100..110].fill(1);
            rows.ego_y_m[80..130].fill(7.0);
            rows.lane[130..].fill(1);
            for y in &mut rows.ego_y_m[130..] {
                *y += width + 0.4;
            }
        };
        let sd = MEASURE.of(&wandering(10.0, 300, passing)).unwrap();
        // 80 and 170 rows, each about its own mean.
        assert!((sd - 0.5 * (250.0_f64 / 248.0).sqrt()).abs() < 1e-9, "{sd}");
        let one_more = |rows: &mut maveric_domain::drive::Rows| {
            passing(rows);
            rows.ego_y_m[79] = 7.0;
        };
        assert!(MEASURE.of(&wandering(10.0, 300, one_more)).unwrap() > 0.6);
    }

    #[test]
    fn places_cut_off_have_no_value() {
        let edge = 0.49 * Road::PAPER.lane_width_m;
        let cut_off = |place: f64| {
            MEASURE.of(&wandering(10.0, 200, |rows| {
                rows.ego_y_m[50..60].fill(Road::PAPER.lane_centre_m(0) + place);
            }))
        };
        assert_eq!(cut_off(edge), None);
        assert_eq!(cut_off(-edge), None);
        assert!(cut_off(0.9 * edge).is_some());
        // Beside the road nothing is cut off.
        assert!(cut_off(-1.1 * edge).is_some());
    }

    #[test]
    fn slow_samples_and_a_short_time_have_none() {
        assert!(MEASURE.of(&wandering(5.0, 100, |_| ())).is_some());
        assert_eq!(MEASURE.of(&wandering(4.0, 100, |_| ())), None);
        assert!(MEASURE.of(&wandering(10.0, 100, |_| ())).is_some());
        assert_eq!(MEASURE.of(&wandering(10.0, 99, |_| ())), None);
    }
}
