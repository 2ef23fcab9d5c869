//! A drive at a glance: speed, gap and lane over time.

use super::prelude::*;

/// A drive's signals; every column has one entry a row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriveOverview {
    /// Id of the drive.
    pub drive: String,
    /// Where it comes from.
    pub source: String,
    /// Time of each row, in seconds, rising.
    pub time_s: Vec<f64>,
    /// Rises by one after each hole; lines stop there.
    pub segment: Vec<u32>,
    /// Ego's speed, in m/s.
    pub speed_mps: Vec<f64>,
    /// Bumper-to-bumper distance to the reference vehicle, in metres, negative behind ego; none without one.
    pub gap_m: Vec<Option<f64>>,
    /// Ego's lane, 0 the right one.
    pub lane: Vec<u8>,
    /// Lanes of the road.
    pub lanes: u8,
}

/// Draws speed, gap and lane, one below the other.
///
/// # Errors
/// [`ReportError`] if there are fewer than two rows, lengths differ, or a value is not finite.
pub fn drive_overview(input: &DriveOverview, context: &Context) -> Result<Figure, ReportError> {
    let check = Check("drive-overview");
    let rows = input.time_s.len();
    check.at_least(2, "rows", rows)?;
    check.finite("time_s", input.time_s.iter().copied())?;
    check.finite("speed_mps", input.speed_mps.iter().copied())?;
    check.finite("gap_m", input.gap_m.iter().flatten().copied())?;
    check.length("segment", input.segment.len(), rows)?;
    check.length("speed_mps", input.speed_mps.len(), rows)?;
    check.length("gap_m", input.gap_m.len(), rows)?;
    check.length("lane", input.lane.len(), rows)?;
    let first = input.time_s[0];
    let last = input.time_s[rows - 1];
    let with_lead = input.gap_m.iter().flatten().count();
    let plan = Plan {
        name: "drive-overview".to_owned(),
        size_mm: (TWO_COLUMNS_MM, 120.0),
        title: format!("Drive {}", markup::literal(&input.drive)),
        caption: format!(
            "{}: speed, gap to the reference vehicle (bumper to bumper, negative once it is behind) and lane (0 is the \
             right one) over {:.0} s; {with_lead} of {rows} rows have a reference vehicle. Lines stop at holes in the \
             recording. *n* = 1 drive; no test.",
            markup::literal(&input.source),
            last - first
        ),
        alt: format!("Speed, gap and lane of {} over {:.0} seconds.", input.drive, last - first),
        shows: Shows::Participants,
    };
    let speed: Vec<Option<f64>> = input.speed_mps.iter().copied().map(Some).collect();
    let lane: Vec<Option<f64>> = input.lane.iter().map(|&l| Some(f64::from(l))).collect();
    let over =
        |values: &[Option<f64>]| Scale::over(values.iter().flatten().copied().chain([0.0]), 5);
    let lanes = (0..input.lanes.max(1)).map(|l| (f64::from(l), l.to_string()));
    let lanes_high = f64::from(input.lanes.max(1)) - 0.5;
    let panels = [
        ("Speed (m/s)", &speed, PURPLE, over(&speed)),
        ("Gap (m)", &input.gap_m, INK, over(&input.gap_m)),
        ("Lane", &lane, GREY, Scale::labelled(-0.5, lanes_high, lanes.collect())),
    ];
    draw(plan, context, |canvas, whole| {
        let height = (whole.bottom - whole.top) / 3.0;
        for (i, (title, values, colour, y)) in panels.into_iter().enumerate() {
            let last_one = i + 1 == 3;
            let place = Place {
                top: whole.top + height * i as f64,
                bottom: whole.top + height * (i + 1) as f64 - if last_one { 0.0 } else { 6.0 },
                ..whole
            };
            let labels = Labels {
                x: if last_one { "Time (s)" } else { "" },
                y: title,
                numbers: 14.0,
                ..Labels::default()
            };
            let x = Scale::between(0.0, last - first, 8);
            let mut panel = Panel::open(canvas, place, &labels, (x, y));
            for run in runs(input, values) {
                panel.line(run, Pen::new(colour, 1.0));
            }
        }
    })
}

/// Stretches of rows with a value and without a hole, in seconds since the start.
fn runs(input: &DriveOverview, values: &[Option<f64>]) -> Vec<Vec<(f64, f64)>> {
    let rows: Vec<(usize, &Option<f64>)> = values.iter().enumerate().collect();
    let joined = |a: &(usize, &Option<f64>), b: &(usize, &Option<f64>)| {
        a.1.is_some() && b.1.is_some() && input.segment[a.0] == input.segment[b.0]
    };
    let point = |&(row, value): &(usize, &Option<f64>)| {
        Some((input.time_s[row] - input.time_s[0], (*value)?))
    };
    let runs = rows.chunk_by(joined);
    let runs = runs.map(|run| run.iter().filter_map(point).collect::<Vec<_>>());
    runs.filter(|run| !run.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stop_at_holes_and_where_nobody_is_ahead() {
        let input = DriveOverview {
            drive: "d".to_owned(),
            source: "s".to_owned(),
            time_s: vec![0.0, 1.0, 2.0, 5.0, 6.0],
            segment: vec![0, 0, 0, 1, 1],
            speed_mps: vec![1.0; 5],
            gap_m: vec![Some(9.0), None, Some(8.0), Some(7.0), Some(6.0)],
            lane: vec![0; 5],
            lanes: 1,
        };
        let lengths: Vec<usize> = runs(&input, &input.gap_m).iter().map(Vec::len).collect();
        assert_eq!(lengths, [1, 1, 2]);
        assert!(drive_overview(&input, &Context::real()).is_ok());
    }
}
