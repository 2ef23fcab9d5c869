//! Traits against what four scales gain, with the stars of adjusted tests.

use super::{PARTICIPANTS, wobble};
use maveric_report::{
    Context, Figure, ReportError,
    figures::correlation_heatmap::{CorrelationHeatMap, HeatCell, correlation_heatmap},
};

pub(crate) fn draw(context: &Context) -> Result<Figure, ReportError> {
    correlation_heatmap(&input(), context)
}

pub(crate) fn input() -> CorrelationHeatMap {
    let traits = [
        "Openness",
        "Conscientiousness",
        "Extraversion",
        "Agreeableness",
        "Neuroticism",
        "Locus of control",
    ];
    let scales = ["trust", "competence", "intelligence", "comfort"];
    let versus = ["M − A", "M − C"];
    let columns = versus
        .iter()
        .flat_map(|v| scales.iter().map(move |s| format!("{v} {s}")));
    let cell = |row: usize, column: usize| {
        let value = 0.85 * wobble(row, 20 + column);
        let p = (1.0 - value.abs()).powi(8);
        ((row, column) != (3, 5)).then_some(HeatCell { value, p })
    };
    CorrelationHeatMap {
        rows: traits.map(str::to_owned).to_vec(),
        columns: columns.collect(),
        cells: (0..6)
            .map(|row| (0..8).map(|column| cell(row, column)).collect())
            .collect(),
        family: "Spearman’s *ρ*; *p* after Holm over the 47 tests shown.".into(),
        participants: PARTICIPANTS,
    }
}
