//! Made-up input for every kind of figure. The numbers come from sines and mean nothing.

use maveric_report::{Context, Figure, ReportError, apa};
use maveric_stats::linear_fit;

pub(crate) mod ablation;
pub(crate) mod aggression_line;
pub(crate) mod architecture;
pub(crate) mod axis_regressions;
pub(crate) mod calibration;
pub(crate) mod car_following;
pub(crate) mod comparison;
pub(crate) mod correlation_heatmap;
pub(crate) mod curves;
pub(crate) mod dial_sweep;
pub(crate) mod difference_panels;
pub(crate) mod domain;
pub(crate) mod drive_overview;
pub(crate) mod embedding_space;
pub(crate) mod false_positives;
pub(crate) mod fidelity;
pub(crate) mod following_errors;
pub(crate) mod forest;
pub(crate) mod lane_change_quality;
pub(crate) mod learning_curve;
pub(crate) mod perpendicular;
pub(crate) mod perpendicular_circle;
pub(crate) mod population_distributions;
pub(crate) mod preference;
pub(crate) mod recommendation;
pub(crate) mod residuals;
pub(crate) mod scatter;
pub(crate) mod simulator_view;
pub(crate) mod step_responses;
pub(crate) mod test_retest;
pub(crate) mod time_space;
pub(crate) mod training_curves;

pub(crate) const PARTICIPANTS: usize = 24;

/// A function that draws one kind of figure.
pub(crate) type Draw = fn(&Context) -> Result<Figure, ReportError>;

/// Every kind: the name of its function, and one that draws it from made-up numbers.
pub(crate) const KINDS: [(&str, Draw); 32] = [
    ("domain", domain::draw),
    ("architecture", architecture::draw),
    ("simulator_view", simulator_view::draw),
    ("population_distributions", population_distributions::draw),
    ("training_curves", training_curves::draw),
    ("calibration", calibration::draw),
    ("residuals", residuals::draw),
    ("learning_curve", learning_curve::draw),
    ("ablation", ablation::draw),
    ("embedding_space", embedding_space::draw),
    ("aggression_line", aggression_line::draw),
    ("axis_regressions", axis_regressions::draw),
    ("perpendicular", perpendicular::draw),
    ("perpendicular_circle", perpendicular_circle::draw),
    ("difference_panels", difference_panels::draw),
    ("comparison", comparison::draw),
    ("scatter", scatter::draw),
    ("forest", forest::draw),
    ("preference", preference::draw),
    ("correlation_heatmap", correlation_heatmap::draw),
    ("recommendation", recommendation::draw),
    ("curves", curves::draw),
    ("false_positives", false_positives::draw),
    ("fidelity", fidelity::draw),
    ("test_retest", test_retest::draw),
    ("dial_sweep", dial_sweep::draw),
    ("car_following", car_following::draw),
    ("following_errors", following_errors::draw),
    ("drive_overview", drive_overview::draw),
    ("time_space", time_space::draw),
    ("step_responses", step_responses::draw),
    ("lane_change_quality", lane_change_quality::draw),
];

pub(crate) fn figures(context: &Context) -> Result<Vec<Figure>, ReportError> {
    KINDS.iter().map(|(_, draw)| draw(context)).collect()
}

/// A number between −1 and 1 that looks like chance.
pub(crate) fn wobble(a: usize, b: usize) -> f64 {
    let x = (a as f64 * 12.989_8 + b as f64 * 78.233).sin() * 43_758.545_3;
    let y = (a as f64 * 39.346 + b as f64 * 11.135).sin() * 24_634.634_5;
    (x - x.floor()) + (y - y.floor()) - 1.0
}

/// Pearson's r of points, as a panel shows it.
pub(crate) fn pearson(points: &[(f64, f64)]) -> String {
    let column =
        |of: fn(&(f64, f64)) -> f64| points.iter().map(|p| Some(of(p))).collect::<Vec<_>>();
    let fit = linear_fit(&column(|p| p.0), &column(|p| p.1));
    let found = fit
        .ok()
        .and_then(|f| Some((f.slope.signum() * f.r2?.sqrt(), f.slope_p?)));
    let (r, p) = found.unwrap_or((f64::NAN, f64::NAN));
    apa::r(r, points.len().saturating_sub(2), p)
        .markup()
        .to_owned()
}
