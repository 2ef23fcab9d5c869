//! The learning curve over all drives: means with intervals.

use super::Personalize;
use crate::{
    atomic_write::write_json,
    error::StudyError,
    mean::{mean, mean_interval},
    outcome::{Outcome, Watch, for_each_on},
    tables::{TableName, write_rows},
};
use maveric_domain::{Drive, stream_seed};
use maveric_model::{
    CurvePoint, CurveSettings, LearningCurve, ModelError, Personalizer, learning_curve,
};
use serde::Serialize;
use std::path::Path;

/// A mean over drives with its 95% interval: percentiles of 10,000 bootstrap resamples of drives.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct MeanWithInterval {
    /// Drives that have a value.
    pub n: usize,
    /// Mean over these drives; none where no drive has a value.
    pub mean: Option<f64>,
    /// Lower end; none for fewer than two drives.
    pub low: Option<f64>,
    pub high: Option<f64>,
}

/// How good embeddings are after some minutes of driving.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CurveRow {
    /// Minutes fitted to; 0: the mean of the training embeddings; none: all that is not held out.
    pub minutes: Option<f64>,
    /// Drives that are long enough.
    pub drives: usize,
    /// Mean loss of what the part held out shows; see [`CurvePoint::held_out`].
    pub held_out: MeanWithInterval,
    /// Distance to the embedding of the whole drive, in SDs of the training embeddings.
    pub distance_to_full_sd: MeanWithInterval,
    /// Root mean square standard error over the coordinates.
    pub standard_error: MeanWithInterval,
}

#[derive(Debug)]
pub(super) struct CurveOfDrives {
    pub(super) drives: usize,
    pub(super) rows: Vec<CurveRow>,
}

/// A file of a learning curve: the means, and every drive.
#[derive(Serialize)]
struct CurveFile<'a> {
    means: &'a [CurveRow],
    drives: &'a [LearningCurve],
}

/// Computes the curve of every drive that is long enough and writes it.
pub(super) fn of_drives(
    personalizer: &Personalizer<'_>,
    drives: &[Drive],
    (options, path): (&Personalize, &Path),
    watch: Watch<'_>,
) -> Result<Outcome<CurveOfDrives>, StudyError> {
    let settings = CurveSettings::default();
    let curves =
        for_each_on(options.jobs, drives, watch, "learning curves", |drive| match learning_curve(
            personalizer,
            drive,
            &settings,
        ) {
            Err(ModelError::DriveTooShort { .. }) => Ok(None),
            other => Ok(Some(other?)),
        })?;
    let curves: Vec<LearningCurve> = curves.into_iter().flatten().collect();
    let mut warnings = Vec::new();
    let short = drives.len() - curves.len();
    if short > 0 {
        warnings
            .push(format!("{short} of {} drives are too short for a learning curve", drives.len()));
    }
    let mut rows = Vec::new();
    let minutes = settings.minutes.iter().copied();
    for minutes in std::iter::once(0.0).chain(minutes).map(Some).chain([None]) {
        let points: Vec<&CurvePoint> =
            curves.iter().filter_map(|c| c.points.iter().find(|p| is_at(p, minutes))).collect();
        if let (true, Some(minutes)) = (points.len() < curves.len(), minutes) {
            warnings.push(format!(
                "{} of {} drives do not have {minutes} min before the part that is held out",
                curves.len() - points.len(),
                curves.len()
            ));
        }
        if !points.is_empty() {
            rows.push(row(minutes, &points, options.seed)?);
        }
    }
    write(path, &rows, &curves)?;
    let summary: Vec<String> = rows
        .iter()
        .map(|r| {
            let minutes = r.minutes.map_or("all".to_owned(), |m| format!("{m}"));
            let show = |m: &MeanWithInterval| m.mean.map_or("-".to_owned(), |x| format!("{x:.3}"));
            format!(
                "  {minutes:>4} min: loss {} on the rest, {} SD from the whole drive's ({} drives)",
                show(&r.held_out),
                show(&r.distance_to_full_sd),
                r.drives
            )
        })
        .collect();
    let drives = curves.len();
    Ok(Outcome::new(CurveOfDrives { drives, rows }, summary, warnings))
}

fn is_at(point: &CurvePoint, minutes: Option<f64>) -> bool {
    match minutes {
        Some(minutes) => !point.all && (point.minutes - minutes).abs() < 1e-9,
        None => point.all,
    }
}

fn row(minutes: Option<f64>, points: &[&CurvePoint], seed: u64) -> Result<CurveRow, StudyError> {
    let mean = |name: &str, value: &dyn Fn(&CurvePoint) -> Option<f64>| {
        let values: Vec<Option<f64>> = points.iter().map(|p| value(p)).collect();
        interval(&values, stream_seed(seed, &["learning curve", name]))
    };
    Ok(CurveRow {
        minutes,
        drives: points.len(),
        held_out: mean("held out", &|p| p.held_out)?,
        distance_to_full_sd: mean("distance", &|p| Some(p.distance_to_full_sd))?,
        standard_error: mean("standard error", &|p| {
            let errors = p.standard_error.as_ref()?;
            let squares: f64 = errors.iter().map(|e| e * e).sum();
            Some((squares / errors.len() as f64).sqrt())
        })?,
    })
}

fn interval(values: &[Option<f64>], seed: u64) -> Result<MeanWithInterval, StudyError> {
    let known: Vec<f64> = values.iter().flatten().copied().collect();
    let ends = mean_interval(values, seed)?;
    Ok(MeanWithInterval {
        n: known.len(),
        mean: mean(&known),
        low: ends.and_then(|e| e.low),
        high: ends.and_then(|e| e.high),
    })
}

fn write(path: &Path, rows: &[CurveRow], curves: &[LearningCurve]) -> Result<(), StudyError> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) {
        let file = CurveFile { means: rows, drives: curves };
        return write_json(path, &file);
    }
    let columns = rows.iter().map(|row| {
        let named = |name: &str, m: &MeanWithInterval| {
            let ends = [("", m.mean), ("_low", m.low), ("_high", m.high)];
            ends.map(|(end, value)| (format!("{name}{end}"), value))
        };
        (
            ("minutes", row.minutes),
            ("drives", row.drives),
            named("held_out", &row.held_out),
            named("distance_to_full_sd", &row.distance_to_full_sd),
            named("standard_error", &row.standard_error),
        )
    });
    write_rows(TableName::LearningCurve, path, columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_has_an_interval_from_two_drives_on() {
        let one = interval(&[Some(2.0), None], 1).unwrap();
        assert_eq!((one.n, one.mean, one.low), (1, Some(2.0), None));
        let three = interval(&[Some(1.0), Some(2.0), Some(3.0)], 1).unwrap();
        assert!(three.low.unwrap() < 2.0 && three.high.unwrap() > 2.0);
        assert_eq!(three, interval(&[Some(1.0), Some(2.0), Some(3.0)], 1).unwrap());
        assert_eq!(interval(&[None], 1).unwrap(), MeanWithInterval::default());
    }
}
