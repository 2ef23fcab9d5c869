//! Correlations of the position on the style line.

use super::{Cell, Column, Correlation, Table};
use serde::{Deserialize, Serialize};

/// One measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LineCorrelation {
    /// Such as `Mean velocity`.
    pub measure: String,
    /// Ours; `None` if it could not be computed.
    pub ours: Option<Correlation>,
    /// With embeddings fitted without the questionnaire's term, where that was done.
    pub without_style_loss: Option<Correlation>,
    /// What the paper printed.
    pub paper: Option<Correlation>,
}

/// Builds the table `embedding-line`; `score` is what the line predicts.
pub fn embedding_line(rows: &[LineCorrelation], score: &str, participants: usize) -> Table {
    let cell = |correlation: Option<&Correlation>| {
        correlation.map_or(Cell::Missing, |c| {
            Cell::Marked(c.statement().markup().to_owned())
        })
    };
    let printed = rows.iter().any(|row| row.paper.is_some());
    Table {
        name: "embedding-line".to_owned(),
        title: "Position on the line against each measure".to_owned(),
        columns: ["Measure", "Here", "Here, fitted without *L*_{4}"]
            .into_iter()
            .chain(printed.then_some("Paper"))
            .map(Column::left)
            .collect(),
        rows: rows
            .iter()
            .map(|row| {
                let mut cells = vec![
                    Cell::text(&row.measure),
                    cell(row.ours.as_ref()),
                    cell(row.without_style_loss.as_ref()),
                ];
                cells.extend(printed.then(|| cell(row.paper.as_ref())));
                cells
            })
            .collect(),
        notes: vec![format!(
            "*n* = {participants} test participants. With *L*_{{4}} the score itself ({score}) takes part in \
             fitting the embedding, so its own correlation is partly built in: the third column \
             leaves it out.",
            score = crate::markup::literal(score)
        )],
    }
}
