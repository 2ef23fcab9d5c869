//! Four quantities of made-up drivers beside two sources and recordings.

use maveric_report::{
    Context, Figure, ReportError,
    figures::population_distributions::{
        DistributionGroup, DistributionPanel, Origin, PopulationDistributions,
        population_distributions,
    },
};

pub(crate) fn draw(context: &Context) -> Result<Figure, ReportError> {
    population_distributions(&input(), context)
}

pub(crate) fn input() -> PopulationDistributions {
    let group = |name: &str, origin, centre: f64, spread: f64, shares: &[(f64, f64)], n| {
        DistributionGroup {
            name: name.into(),
            origin,
            quantiles: shares
                .iter()
                .map(|(share, z)| (*share, centre + spread * z))
                .collect(),
            n,
        }
    };
    let deciles = [
        (0.1, -1.28),
        (0.25, -0.67),
        (0.5, 0.0),
        (0.75, 0.67),
        (0.9, 1.28),
    ];
    let ends = [(0.1, -1.28), (0.9, 1.28)];
    let panel = |title: &str, axis: &str, centre: f64, spread: f64| DistributionPanel {
        title: title.into(),
        axis: axis.into(),
        groups: vec![
            group(
                "Made-up drivers",
                Origin::Generated,
                centre,
                spread,
                &deciles,
                Some(1000),
            ),
            group(
                "Example source A",
                Origin::Published,
                1.03 * centre,
                1.1 * spread,
                &ends,
                Some(64),
            ),
            group(
                "Example source B",
                Origin::Published,
                0.98 * centre,
                0.8 * spread,
                &deciles[1..4],
                None,
            ),
            group(
                "Example recordings",
                Origin::Recorded,
                0.95 * centre,
                1.2 * spread,
                &deciles,
                Some(41),
            ),
        ],
    };
    PopulationDistributions {
        panels: vec![
            panel("Desired speed", "Speed (mph)", 66.5, 6.0),
            panel("Time gap when following", "Time gap (s)", 1.4, 0.4),
            panel("Duration of a lane change", "Duration (s)", 4.9, 0.8),
            panel("Lane changes", "Changes an hour", 52.0, 17.0),
        ],
    }
}
