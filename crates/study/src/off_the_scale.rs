//! Drives that a model reads as a score that its scale does not have.

use crate::once::told_once;
use maveric_domain::{BeyondWhy, DriveId, EmbeddingRow, ParticipantId, ScoreRange};
use serde::Serialize;

/// A drive that a model reads as a score that its scale does not have.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OffTheScale {
    pub drive: DriveId,
    pub participant: ParticipantId,
    /// Whether the person's own score was read too.
    pub adb_used: bool,
    /// What the model read, in points.
    pub reading: f64,
}

/// Takes out what a model reads as a score that the scale does not have, which is none, and tells it.
pub(crate) fn taken_out(range: ScoreRange, rows: &mut [EmbeddingRow]) -> Vec<OffTheScale> {
    let mut off = Vec::new();
    for row in rows {
        let reading = row.adb_hat;
        let by_support = row.beyond_why.take();
        (row.adb_hat, row.beyond_why) = BeyondWhy::of_reading(range, reading, by_support);
        if let (None, Some(reading)) = (row.adb_hat, reading) {
            off.push(OffTheScale {
                drive: row.drive.clone(),
                participant: row.participant.clone(),
                adb_used: row.adb_used,
                reading,
            });
        }
    }
    off
}

/// A sentence for each drive that reads as no score of the scale.
pub(crate) fn warnings(range: ScoreRange, off: &[OffTheScale]) -> Vec<String> {
    let why = format!(
        "reads as a score outside {range}, so it has none: the model has met nobody who drives like this, and where it puts this driver says little"
    );
    told_once("drive", off.iter().map(|o| (o.drive.to_string(), why.clone())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_that_is_no_score_of_the_scale_is_taken_out_and_told_and_one_at_its_end_stays() {
        let risky = ScoreRange::new(1.0, 6.0).unwrap();
        let row = |drive: &str, points: Option<f64>| EmbeddingRow {
            adb_hat: points,
            ..EmbeddingRow::new(
                DriveId::new(drive).unwrap(),
                ParticipantId::new("p").unwrap(),
                "own".parse().unwrap(),
                maveric_domain::Embedding::new(vec![0.0]).unwrap(),
            )
        };
        let points = [0.9, 1.0, 3.5, 6.0, 6.1].map(Some);
        let mut rows: Vec<EmbeddingRow> = ["a", "b", "c", "d", "e", "f"]
            .into_iter()
            .zip(points.into_iter().chain([None]))
            .map(|(drive, points)| row(drive, points))
            .collect();
        let off = taken_out(risky, &mut rows);
        let kept: Vec<bool> = rows.iter().map(|r| r.adb_hat.is_some()).collect();
        assert_eq!(kept, [false, true, true, true, false, false]);
        let found: Vec<&str> = off.iter().map(|o| o.drive.as_str()).collect();
        assert_eq!(found, ["a", "e"]);
        assert!((off[1].reading - 6.1).abs() < 1e-9);
        let said = warnings(risky, &off);
        assert!(
            said[0].starts_with("2 drives (a, e): reads as a score outside 1 to 6"),
            "{said:?}"
        );
        assert!(warnings(risky, &[]).is_empty());
    }
}
