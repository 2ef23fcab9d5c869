//! How far from the recorded gap each model drove, drive by drive.

use super::following_spread as spread;
use super::prelude::*;
use maveric_stats::mean;

pub use super::following_spread::ModelErrors;

/// Errors of several models on the same drivers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FollowingErrors {
    /// Names of the recordings, such as `OpenACC AstaZero`.
    pub data_set: String,
    /// The drivers' ids, one row each.
    pub drivers: Vec<String>,
    /// The models.
    pub models: Vec<ModelErrors>,
}

const NAME: &str = "following-errors";
const ROW: f64 = 15.0;
/// Above this many drivers they have no row of their own.
const MOST_DRIVERS: usize = 40;

/// Draws a row of dots for every driver, and one for the mean.
///
/// # Errors
/// [`ReportError`] if there is no driver or model, lengths differ, or a value is negative or not
/// finite.
pub fn following_errors(input: &FollowingErrors, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "drivers", input.drivers.len())?;
    check.at_least(1, "models", input.models.len())?;
    for ModelErrors { model, gap_rmse_m } in &input.models {
        check.length(model.label(), gap_rmse_m.len(), input.drivers.len())?;
        check.finite("gap_rmse_m", gap_rmse_m.iter().copied())?;
        let (any, errors) = ((0.0, f64::MAX), gap_rmse_m.iter().copied());
        check.within(any, "gap_rmse_m", errors, "an error of at least 0 m")?;
    }
    let labels = Labels { x: "Root-mean-square error of the gap (m)", ..Labels::default() };
    let crowd = input.drivers.len() > MOST_DRIVERS;
    draw(plan(input, crowd), context, |canvas, place| {
        if crowd {
            spread::paint(canvas, place, &labels, &input.models);
        } else {
            by_driver(canvas, place, &labels, input);
        }
    })
}

fn plan(input: &FollowingErrors, crowd: bool) -> Plan {
    let models = input.models.len() as f64;
    let (height_points, shown) = if crowd {
        (
            58.0 + spread::ROW * models,
            "Thin lines hold nine in ten drives, thick lines the middle half, points are means over drives",
        )
    } else {
        (
            58.0 + 10.0 * (models / 3.0).ceil() + ROW * (input.drivers.len() + 1) as f64,
            "Points know the driver, the short line is the same for everybody; points are above each other where they would meet",
        )
    };
    let means = input.models.iter().filter_map(|model| {
        let mean = number(mean(&model.gap_rmse_m)?, 2);
        Some(format!("{}: {mean} m.", model.model.label()))
    });
    Plan {
        name: NAME.to_owned(),
        size_mm: (120.0, height_points / 72.0 * 25.4),
        title: "Error of the gap in closed loop, by drive".to_owned(),
        caption: format!(
            "{}: root-mean-square error of the gap over the unseen last third of each drive, in \
             closed loop. {shown}. *n* = {} drives, each with \
             the same weight in the mean; no test.",
            markup::literal(&input.data_set),
            input.drivers.len()
        ),
        alt: format!("Mean over drives. {}", sentences(means)),
        shows: Shows::Participants,
    }
}

/// A row of marks for every driver, and one for the mean.
fn by_driver(canvas: &mut Canvas<'_>, place: Place, labels: &Labels<'_>, input: &FollowingErrors) {
    let keys = input.models.iter().map(|m| m.model.key());
    let place = canvas.legend(place, &keys.collect::<Vec<_>>());
    let every = input.models.iter().flat_map(|m| &m.gap_rmse_m).copied();
    let x = Scale::between(0.0, 1.05 * every.fold(0.1, f64::max), 6);
    let names = input.drivers.iter().map(String::as_str).chain(["Mean"]);
    let rows = Rows::new(names, 0.6);
    let mut panel = Panel::open(canvas, place, labels, (x, rows.axis()));
    panel.level(0.5, Pen::new(MUTED, stroke::AXIS));
    for row in 0..=input.drivers.len() {
        let value =
            |m: &ModelErrors| m.gap_rmse_m.get(row).copied().or_else(|| mean(&m.gap_rmse_m));
        let values: Vec<f64> = input.models.iter().filter_map(value).collect();
        let (low, high) = extent(values.iter().copied());
        panel.line([low, high].map(|end| (end, rows.y(row))), Pen::new(GRID, 2.0));
        let places: Vec<(f64, f64)> =
            values.iter().map(|v| panel.frame.at(*v, rows.y(row))).collect();
        let offsets = apart(&places.iter().map(|place| place.0).collect::<Vec<_>>());
        for ((model, (x, y)), offset) in input.models.iter().zip(places).zip(offsets).rev() {
            let (model, y) = (model.model, y + offset);
            match model.mark() {
                Some(pen) => panel.canvas.line((x, y - 4.5), (x, y + 4.5), pen),
                None => panel.canvas.marker((x, y), 2.4, model.marker(), model.colour()),
            }
        }
    }
}

/// How far markers at these places move up or down so that none hides another, in points.
fn apart(places: &[f64]) -> Vec<f64> {
    const LEVELS: [f64; 3] = [0.0, -4.2, 4.2];
    const WIDE: f64 = 4.6;
    let mut taken: Vec<(f64, f64)> = Vec::new();
    for &x in places {
        let free = |level: &&f64| {
            let mut beside = taken.iter().filter(|(_, at)| (at - **level).abs() < 0.1);
            beside.all(|(other, _)| (other - x).abs() >= WIDE)
        };
        taken.push((x, *LEVELS.iter().find(free).unwrap_or(&0.0)));
    }
    taken.into_iter().map(|(_, level)| level).collect()
}

#[cfg(test)]
mod tests {
    use super::super::car_following::Follower;
    use super::*;

    #[test]
    fn a_driver_without_an_error_is_refused() {
        let input = FollowingErrors {
            data_set: "x".into(),
            drivers: vec!["a".into(), "b".into()],
            models: vec![ModelErrors { model: Follower::Idm, gap_rmse_m: vec![1.0] }],
        };
        let refused = following_errors(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::LengthMismatch { .. })));
    }
}
