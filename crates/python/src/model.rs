//! Models of how people drive, and styles.

use crate::{
    drive::Drive,
    error::{asked_to_stop, maveric_error, raised},
};
use maveric_domain::{BeyondWhy, Embedding, ScoreRange};
use maveric_model::{
    Habits, HeadsKind, Model as Learned, Support, TrainSettings, TrainingDrive, model_file,
    personalize, style_space::LinearHead, train,
};
use pyo3::{
    prelude::*,
    types::{PyBytes, PyDict},
};
use std::{ops::ControlFlow, sync::Arc};

/// What was learned of how people drive.
#[pyclass(frozen, module = "maveric")]
pub struct Model {
    pub(crate) learned: Arc<Learned>,
    drivers: Vec<(String, Embedding)>,
    warnings: Vec<String>,
}

/// A driver's style in a model's terms.
#[pyclass(frozen, module = "maveric")]
#[derive(Clone)]
pub struct Style {
    pub(crate) model: Arc<Learned>,
    pub(crate) embedding: Embedding,
    covariance: Option<Vec<f64>>,
    /// How well the people learned from explain the drive that it was learned of.
    support: Option<Support>,
    clamped: bool,
}

/// The scale of scores between two numbers, where they are given.
fn range_of(ends: Option<(f64, f64)>) -> PyResult<Option<ScoreRange>> {
    let range = ends.map(|(low, high)| ScoreRange::new(low, high));
    range.transpose().map_err(raised)
}

#[pymethods]
impl Model {
    /// Learns from drives; `scores` has a score of aggression by the drive's name or its participant's, `score_range` the ends of its
    /// scale, those of the ADB score where none are given.
    #[staticmethod]
    #[pyo3(signature = (drives, scores, score_range, heads, embedding_size, epochs, seed))]
    #[expect(clippy::too_many_arguments, reason = "a keyword each in Python")]
    fn train(
        py: Python<'_>,
        drives: Vec<Bound<'_, Drive>>,
        scores: Option<Bound<'_, PyDict>>,
        score_range: Option<(f64, f64)>,
        heads: &str,
        embedding_size: usize,
        epochs: usize,
        seed: u64,
    ) -> PyResult<Self> {
        let heads = match heads {
            "linear" => HeadsKind::Linear,
            "paper" => HeadsKind::Paper,
            other => {
                return Err(maveric_error(format!(
                    "heads `{other}`, expected `linear` or `paper`"
                )));
            }
        };
        let range = range_of(score_range)?.unwrap_or(ScoreRange::ADB);
        let settings = TrainSettings { heads, embedding_size, epochs, ..TrainSettings::default() };
        let mut given = Vec::new();
        for drive in &drives {
            let drive = &drive.get().signals;
            let meta = drive.meta();
            let score = match &scores {
                None => None,
                Some(scores) => match scores.get_item(meta.drive.as_str())? {
                    None => scores.get_item(meta.participant.as_str())?,
                    score => score,
                },
            };
            let points = score.map(|s| s.extract::<f64>()).transpose()?;
            let adb = points.map(|p| range.score(p)).transpose().map_err(raised)?;
            given.push(TrainingDrive { drive, adb });
        }
        // Ctrl-C is seen between epochs.
        let mut stopped = None;
        let trained = py.allow_threads(|| {
            train(&given, &settings, seed, &mut |_| match asked_to_stop() {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => {
                    stopped = Some(error);
                    ControlFlow::Break(())
                }
            })
        });
        if let Some(error) = stopped {
            return Err(error);
        }
        let trained = trained.map_err(raised)?;
        let warnings = trained.report.warnings.iter().map(ToString::to_string);
        Ok(Self {
            warnings: warnings.collect(),
            learned: Arc::new(trained.model.on_range(range)),
            drivers: trained
                .embeddings
                .into_iter()
                .map(|(drive, embedding)| (drive.to_string(), embedding))
                .collect(),
        })
    }

    /// Solves for the style of a drive, the model as it is.
    #[pyo3(signature = (drive, score = None))]
    fn personalize(&self, py: Python<'_>, drive: &Drive, score: Option<f64>) -> PyResult<Style> {
        let range = self.learned.score_range();
        let adb = score.map(|s| range.score(s)).transpose();
        let adb = adb.map_err(raised)?;
        let fit = py.allow_threads(|| personalize(&self.learned, &drive.signals, adb));
        let fit = fit.map_err(raised)?;
        Ok(Style { covariance: fit.covariance, support: fit.support, ..self.at(fit.embedding) })
    }

    /// The style with these coordinates.
    fn style(&self, embedding: Vec<f64>) -> PyResult<Style> {
        let expected = self.learned.embedding_size();
        if embedding.len() != expected {
            return Err(maveric_error(format!(
                "{} coordinates, expected {expected}: the model's styles have that many",
                embedding.len()
            )));
        }
        Ok(self.at(Embedding::new(embedding).map_err(raised)?))
    }

    /// The styles of the drives that were learned from, by the drives' names; none in a model that was read from a file.
    #[getter]
    fn drivers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let drivers = PyDict::new(py);
        for (drive, embedding) in &self.drivers {
            drivers.set_item(drive, self.at(embedding.clone()))?;
        }
        Ok(drivers)
    }

    /// The style in the middle of those that were learned from.
    #[getter]
    fn mean_style(&self) -> Style {
        self.at(self.learned.mean_embedding().clone())
    }

    #[getter]
    fn heads(&self) -> String {
        self.learned.kind().to_string()
    }

    #[getter]
    fn embedding_size(&self) -> usize {
        self.learned.embedding_size()
    }

    #[getter]
    fn knows_aggression(&self) -> bool {
        self.learned.knows_aggression()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// The model as the bytes of a model file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = model_file::to_bytes(&self.learned).map_err(raised)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The model of a model file's bytes; its scores are told on the scale with these ends, or on the file's own.
    #[staticmethod]
    #[pyo3(signature = (bytes, score_range = None))]
    fn from_bytes(bytes: &[u8], score_range: Option<(f64, f64)>) -> PyResult<Self> {
        let learned = model_file::from_bytes(bytes).map_err(raised)?;
        Ok(Self {
            learned: Arc::new(learned.on_range(range_of(score_range)?)),
            drivers: Vec::new(),
            warnings: Vec::new(),
        })
    }

    fn __repr__(&self) -> String {
        format!(
            "<maveric.Model: {} heads, styles of {} numbers, {} parameters>",
            self.heads(),
            self.embedding_size(),
            self.learned.parameters()
        )
    }
}

impl Model {
    fn at(&self, embedding: Embedding) -> Style {
        Style {
            model: self.learned.clone(),
            embedding,
            covariance: None,
            support: None,
            clamped: false,
        }
    }
}

impl Style {
    /// The score, in points, and why the style is beyond what the model has learned from.
    fn read(&self) -> PyResult<(Option<f64>, Option<BeyondWhy>)> {
        let axis = LinearHead::aggression(&self.model).ok();
        let reading = axis.map(|axis| axis.read(&self.embedding)).transpose();
        let by_support = self.support.as_ref().and_then(Support::beyond);
        let (range, reading) = (self.model.score_range(), reading.map_err(raised)?);
        Ok(BeyondWhy::of_reading(range, reading, by_support))
    }
}

#[pymethods]
impl Style {
    /// Its coordinates.
    #[getter]
    fn embedding(&self) -> Vec<f64> {
        self.embedding.coordinates().to_vec()
    }

    /// How well the coordinates are known, as rows of a covariance; none where that was not computed.
    #[getter]
    fn covariance(&self) -> Option<Vec<Vec<f64>>> {
        let size = self.embedding.size();
        let covariance = self.covariance.as_ref()?;
        Some(covariance.chunks(size).map(<[f64]>::to_vec).collect())
    }

    /// What the model reads as the score of aggression, in points; none in a model that saw no scores, and where the scale has no
    /// such score.
    #[getter]
    fn aggression(&self) -> PyResult<Option<f64>> {
        Ok(self.read()?.0)
    }

    /// Probability of a drive at least as surprising by one of the people learned from; none where the model cannot say.
    #[getter]
    fn support_p(&self) -> Option<f64> {
        self.support.as_ref().and_then(|s| s.p)
    }

    /// Whether the drive is beyond what the model has learned from; none where it cannot say.
    #[getter]
    fn beyond(&self) -> PyResult<Option<bool>> {
        let beyond = self.read()?.1.is_some();
        Ok((beyond || self.support_p().is_some()).then_some(beyond))
    }

    /// Why: `scale`, `style:HABIT` or `habits:HABIT`; none where it is not.
    #[getter]
    fn beyond_why(&self) -> PyResult<Option<String>> {
        Ok(self.read()?.1.map(String::from))
    }

    /// Whether an end of the scale cut the last turn of the dial short.
    #[getter]
    fn clamped(&self) -> bool {
        self.clamped
    }

    /// The style so many points more aggressive; less, where negative.
    fn dial(&self, points: f64) -> PyResult<Self> {
        let axis = LinearHead::aggression(&self.model).map_err(raised)?;
        let moved = axis.shift(&self.embedding, points).map_err(raised)?;
        Ok(Self { embedding: moved.embedding, clamped: moved.clamped, ..self.clone() })
    }

    /// What the model predicts of this driver: behind a lead at a speed (m/s), or on free road. Linear heads alone.
    #[pyo3(signature = (lead_speed_mps = None))]
    fn predict<'py>(
        &self,
        py: Python<'py>,
        lead_speed_mps: Option<f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        if lead_speed_mps.is_some_and(|v| !v.is_finite() || v < 0.0) {
            return Err(maveric_error("`lead_speed_mps` must be a finite speed of 0 or more"));
        }
        let habits = Habits::new(&self.model, &self.embedding).map_err(raised)?;
        let free = habits.free_speed_mps(None);
        let predicted = PyDict::new(py);
        predicted.set_item("free_speed_mps", free)?;
        predicted.set_item("move_out_gap_s", habits.move_out_s())?;
        predicted.set_item("merge_back_gap_s", habits.merge_back_s())?;
        let both = free.zip(lead_speed_mps);
        let against_lead = |f: fn(&Habits, f64, f64) -> Option<f64>| {
            both.and_then(|(free, lead)| f(&habits, free, lead))
        };
        predicted.set_item("following_gap_s", against_lead(Habits::following_gap_s))?;
        predicted.set_item("passes", against_lead(Habits::passes))?;
        predicted
            .set_item("passing_speed_over_mps", against_lead(Habits::passing_speed_over_mps))?;
        Ok(predicted)
    }

    fn __repr__(&self) -> PyResult<String> {
        let words: Vec<String> =
            self.embedding.coordinates().iter().map(|x| format!("{x:.3}")).collect();
        let reads = self.aggression()?;
        let reads =
            reads.map_or_else(String::new, |points| format!(", read as {points:.1} points"));
        Ok(format!("<maveric.Style ({}){reads}>", words.join(", ")))
    }
}
