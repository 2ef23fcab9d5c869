//! Three measures against the aggression line and the two axes across it.

use super::{PARTICIPANTS, pearson, wobble};
use maveric_report::{
    Context, Figure, ReportError,
    figures::axis_regressions::{AxisMeasure, AxisRegressions, StyleAxis, axis_regressions},
};

pub(crate) fn draw(context: &Context) -> Result<Figure, ReportError> {
    axis_regressions(&input(), context)
}

pub(crate) fn input() -> AxisRegressions {
    let position = |axis: usize, i: usize| 1.8 * wobble(i, 7 + axis);
    let titles = [
        "Aggression (SD)",
        "First axis across (SD)",
        "Second axis across (SD)",
    ];
    let measures = [
        ("Mean velocity (mph)", 65.0, [2.6, 1.9, 0.2]),
        ("Mean headway time (s)", 1.8, [-0.22, 0.02, 0.2]),
        ("Time in the left lane (share)", 0.22, [0.0, 0.05, -0.01]),
    ];
    let measure = |k: usize| {
        let (title, centre, slopes) = measures[k];
        let value = |i: usize| {
            let along: f64 = (0..3).map(|axis| slopes[axis] * position(axis, i)).sum();
            // One driver never merged back.
            (k != 1 || i > 0).then(|| centre + along + 0.04 * centre * wobble(i, 50 + k))
        };
        let test = |axis: usize| {
            let points = |i: usize| Some((position(axis, i), value(i)?));
            pearson(&(0..PARTICIPANTS).filter_map(points).collect::<Vec<_>>())
        };
        AxisMeasure {
            title: title.into(),
            values: (0..PARTICIPANTS).map(value).collect(),
            statistics: (0..3).map(test).collect(),
        }
    };
    let axis = |k: usize| StyleAxis {
        title: titles[k].into(),
        positions: (0..PARTICIPANTS).map(|i| position(k, i)).collect(),
    };
    AxisRegressions {
        axes: (0..3).map(axis).collect(),
        measures: (0..3).map(measure).collect(),
    }
}
