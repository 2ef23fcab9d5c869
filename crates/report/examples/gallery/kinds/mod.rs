//! Made-up input for every kind of figure. The numbers come from sines and mean nothing.

use maveric_domain::{ConditionId, Design};
use maveric_report::{Context, Figure, ReportError, apa, figures::ConditionLook};
use maveric_stats::linear_fit;

pub(crate) mod ablation;
pub(crate) mod aggression_line;
pub(crate) mod architecture;
pub(crate) mod calibration;
pub(crate) mod car_following;
pub(crate) mod comparison;
pub(crate) mod completeness;
pub(crate) mod congruence;
pub(crate) mod curves;
pub(crate) mod dial_sweep;
pub(crate) mod difference_panels;
pub(crate) mod domain;
pub(crate) mod drive_overview;
pub(crate) mod embedding_space;
pub(crate) mod false_positives;
pub(crate) mod family;
pub(crate) mod fidelity;
pub(crate) mod flow;
pub(crate) mod following_errors;
pub(crate) mod forest;
pub(crate) mod interaction;
pub(crate) mod intervals;
pub(crate) mod learning_curve;
pub(crate) mod perpendicular;
pub(crate) mod preference;
pub(crate) mod press_course;
pub(crate) mod residuals;
pub(crate) mod scatter;
pub(crate) mod simulator_view;
pub(crate) mod time_space;
pub(crate) mod training_curves;

/// The paper's design: its conditions are those of these figures.
fn design() -> Design {
    let text = maveric_data::DESIGNS_PAPER;
    Design::from_toml(text).expect("a test reads the design that is shipped")
}

/// The ids of the conditions.
pub(crate) fn conditions() -> Vec<ConditionId> {
    design().condition_ids().collect()
}

/// Synthetic participants in these conditions.
#[allow(dead_code, reason = "a test of the page alone and the bench have contexts of their own")]
pub(crate) fn context(seed: u64) -> Context {
    let design = design();
    Context::synthetic(seed)
        .with_conditions(ConditionLook::of(&design))
        .with_speed(design.speed_unit())
}

pub(crate) const PARTICIPANTS: usize = 24;

/// A function that draws one kind of figure.
pub(crate) type Draw = fn(&Context) -> Result<Figure, ReportError>;

/// Draws the made-up numbers of a kind by the figure of its name.
macro_rules! draw {
    ($kind:ident) => {
        (stringify!($kind), |context| maveric_report::figures::$kind(&$kind::input(), context))
    };
}

/// Every kind: the name of its function, and one that draws it from made-up numbers.
pub(crate) const KINDS: [(&str, Draw); 31] = [
    draw!(flow),
    draw!(completeness),
    ("domain", domain::draw),
    draw!(architecture),
    draw!(simulator_view),
    draw!(training_curves),
    draw!(calibration),
    draw!(residuals),
    draw!(learning_curve),
    draw!(ablation),
    draw!(embedding_space),
    draw!(aggression_line),
    draw!(perpendicular),
    draw!(difference_panels),
    draw!(comparison),
    draw!(interaction),
    draw!(scatter),
    draw!(forest),
    draw!(preference),
    draw!(congruence),
    draw!(press_course),
    draw!(family),
    ("intervals", intervals::draw),
    draw!(curves),
    draw!(false_positives),
    draw!(fidelity),
    draw!(dial_sweep),
    draw!(car_following),
    draw!(following_errors),
    draw!(drive_overview),
    draw!(time_space),
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
    let column = |coordinate: fn(&(f64, f64)) -> f64| {
        points.iter().map(|p| Some(coordinate(p))).collect::<Vec<_>>()
    };
    let fit = linear_fit(&column(|p| p.0), &column(|p| p.1));
    let r_and_p = fit.ok().and_then(|f| Some((f.slope.signum() * f.r2?.sqrt(), f.slope_p?)));
    let (r, p) = r_and_p.unwrap_or((f64::NAN, f64::NAN));
    apa::r(r, points.len().saturating_sub(2), p).markup().to_owned()
}
