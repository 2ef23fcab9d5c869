//! How the study was done, in words, with the numbers that it was done with.

use super::Run;
use maveric_domain::{AdbScore, MetresPerSecond, Road};

pub(super) fn text(run: &Run, road: &Road, minutes: f64) -> Vec<String> {
    let training = &run.training;
    let settings = &training.settings;
    let moved = run.conditions.iter().map(|c| c.moved_points.abs());
    let mut paragraphs = vec![
        format!(
            "*Driving.* {} lanes of {:.2} m in one direction, posted {:.0} mph, {:.0} minutes a drive by hand.",
            road.lanes,
            road.lane_width_m,
            MetresPerSecond(road.posted_speed_mps).mph(),
            minutes
        ),
        match &training.networks {
            None => format!(
                "*Learning.* Every drive is read as events: free speed, gap kept, moving out, merging back, passing or not. A mixed model with \
                 an embedding of size {} explains them; it was fitted to {} drives, seed {}.",
                settings.embedding_size, training.drives, training.seed
            ),
            Some(networks) => format!(
                "*Learning.* The paper’s networks: windows of {} s at {} Hz; {} passes over {} rows in batches of {}; {}seed {}.",
                settings.window_s,
                settings.window_rate_hz,
                networks.epochs.len(),
                networks.rows,
                settings.batch_size,
                networks.selection.as_ref().map_or_else(String::new, |s| format!(
                    "their number was chosen on {} rows kept back, after which the model learned from all of them; ",
                    s.validation_rows
                )),
                training.seed
            ),
        },
        "*Personalising.* What was learned stays as it is; the embedding of each own drive is solved for, with its covariance, once with \
         the driver’s ADB score and once without."
            .to_owned(),
        format!(
            "*Conditions.* Mimic is the fitted embedding; Aggressive and Cautious lie up to {:.0} ADB points up and down the gradient of the \
             style predictor, held within {:.0} to {:.0} points; Perpendicular is drawn at random from the ellipse one standard deviation \
             across it.",
            moved.fold(0.0, f64::max),
            AdbScore::MIN,
            AdbScore::MAX
        ),
        "*Tests.* Repeated-measures ANOVA, with its degrees of freedom corrected where sphericity fails, or Friedman’s test where the \
         residuals are not normal; pairs adjusted after Holm within a panel. Correlations are Pearson’s or Spearman’s by the same check. \
         Intervals are 95%. Each measure and each test is defined in docs/method.md."
            .to_owned(),
    ];
    if run.analysis.synthetic {
        paragraphs.push(
            "*Participants* are generated: traits drawn at random, driving by a driver model of another kind than the one that learns, answers \
             and ratings from the traits and from what each condition did. Effects come from one file and are what was put in."
                .to_owned(),
        );
    }
    paragraphs
}
