//! Drives: read from logs, seen as tables, measured; and questionnaires scored.

use crate::{
    arrow::{Columns, Given, Made, table_of},
    error::{maveric_error, raised},
    figures::Figure,
};
use maveric_domain::{Answer, Drive as Signals, Moment, ParticipantId, Scale};
use maveric_ingest::{IngestSettings, Mapping};
use maveric_measures::objective;
use maveric_report::{
    Context,
    figures::{drive_overview, drive_overview::DriveOverview},
};
use path_slash::PathExt as _;
use pyo3::{prelude::*, types::PyDict};
use std::path::PathBuf;

/// A drive's signals, and what reading its file warned of.
#[pyclass(frozen, module = "maveric")]
pub struct Drive {
    pub(crate) signals: Signals,
    pub(crate) warnings: Vec<String>,
    pub(crate) source: String,
}

#[pymethods]
impl Drive {
    #[getter]
    fn name(&self) -> &str {
        self.signals.meta().drive.as_str()
    }

    #[getter]
    fn participant(&self) -> &str {
        self.signals.meta().participant.as_str()
    }

    #[getter]
    fn condition(&self) -> String {
        self.signals.meta().condition.to_string()
    }

    #[getter]
    fn rate_hz(&self) -> f64 {
        self.signals.rate_hz()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// The signals, a row a sample.
    fn columns(&self, py: Python<'_>) -> Made {
        let r = self.signals.rows();
        let some = |values: &[f64]| values.iter().copied().map(Some).collect::<Vec<_>>();
        let whole = |values: &mut dyn Iterator<Item = i64>| values.map(Some).collect::<Vec<_>>();
        let followed = r.following.iter().zip(&r.lead_dx_m);
        Columns::new(py)
            .numbers("time_s", some(&r.time_s))
            .integers("segment", whole(&mut r.segment.iter().map(|&s| s.into())))
            .numbers("ego_x_m", some(&r.ego_x_m))
            .numbers("ego_y_m", some(&r.ego_y_m))
            .numbers("ego_speed_mps", some(&r.ego_speed_mps))
            .integers("lane", whole(&mut r.lane.iter().map(|&l| l.into())))
            .flags("lead_present", &r.lead_present)
            .integers("lead_id", r.lead_id.iter().map(|id| id.map(i64::from)))
            .numbers("lead_dx_m", some(&r.lead_dx_m))
            .numbers("lead_dy_m", some(&r.lead_dy_m))
            .numbers("lead_speed_mps", some(&r.lead_speed_mps))
            .flags("lane_change", &r.lane_change)
            .integers("changing", whole(&mut r.changing.iter().map(|&c| c.into())))
            .flags("change_completes", &r.change_completes)
            .flags("following", &r.following)
            .numbers("following_distance_m", followed.map(|(&f, &d)| f.then_some(d)))
            .numbers("gap_behind_left_m", r.gap_behind_left_m.iter().copied())
            .numbers("gap_behind_right_m", r.gap_behind_right_m.iter().copied())
            .finish()
    }

    /// The objective measures by name; None where the drive has no such value.
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let values = PyDict::new(py);
        for measure in objective::all() {
            values.set_item(measure.name, measure.of(&self.signals))?;
        }
        Ok(values)
    }

    /// Speed, gap and lane over time.
    fn plot(&self) -> PyResult<Figure> {
        let (r, road) = (self.signals.rows(), self.signals.road());
        let led = r.lead_present.iter().zip(&r.lead_dx_m);
        let input = DriveOverview {
            drive: self.name().to_owned(),
            source: self.source.clone(),
            time_s: r.time_s.clone(),
            segment: r.segment.clone(),
            speed_mps: r.ego_speed_mps.clone(),
            gap_m: led.map(|(&present, &gap)| present.then_some(gap)).collect(),
            lane: r.lane.clone(),
            lanes: road.lanes,
        };
        let drawn = drive_overview(&input, &Context::real());
        drawn.map(Figure).map_err(raised)
    }

    fn _repr_svg_(&self) -> PyResult<String> {
        Ok(self.plot()?.0.standalone_svg())
    }

    fn __len__(&self) -> usize {
        self.signals.len()
    }

    fn __repr__(&self) -> String {
        format!(
            "<maveric.Drive {}: {} rows at {} Hz, {} lane changes, {} warnings>",
            self.name(),
            self.signals.len(),
            self.rate_hz(),
            self.signals.lane_changes().len(),
            self.warnings.len()
        )
    }
}

/// Reads the drives of a log; a mapping is a file, or JSON of its keys.
#[pyfunction]
pub fn read_log(
    py: Python<'_>,
    path: PathBuf,
    mapping: Option<PathBuf>,
    given: Option<&str>,
    rate_hz: Option<f64>,
    recover: bool,
) -> PyResult<Vec<Drive>> {
    let mapping = match (mapping, given) {
        (Some(file), _) => Some(Mapping::read(&file).map_err(raised)?),
        (None, Some(json)) => Some(serde_json::from_str(json).map_err(raised)?),
        (None, None) => None,
    };
    let settings = IngestSettings { mapping, rate_hz, recover, ..IngestSettings::default() };
    let drives = py.allow_threads(|| maveric_ingest::read_log(&path, &settings));
    let source = path.to_slash_lossy().into_owned();
    let drives = drives.map_err(raised)?.into_iter().map(|log| {
        Ok(Drive {
            signals: Signals::from_recording(log.meta, &log.recording).map_err(raised)?,
            warnings: log.warnings.iter().map(ToString::to_string).collect(),
            source: source.clone(),
        })
    });
    drives.collect()
}

/// The shipped scale of this id, or the one that a TOML text defines.
fn scale_of(scale: &str) -> PyResult<Scale> {
    Scale::from_toml(maveric_data::scale(scale).unwrap_or(scale)).map_err(raised)
}

/// Scores answer sheets: a row a person, a column an item. Gives the scores and the warnings.
#[pyfunction]
pub fn score(
    py: Python<'_>,
    data: Given,
    scale: &str,
    participant: &str,
    items: Option<Vec<String>>,
) -> PyResult<(Made, Vec<String>)> {
    let scale = scale_of(scale)?;
    let table = table_of(data).table("table").map_err(raised)?;
    let people = table.text(participant).map_err(raised)?;
    let items = items.unwrap_or_else(|| {
        let numbered = 1..=scale.count();
        numbered.map(|item| scale.column_of(item)).collect()
    });
    if items.len() != scale.items.len() {
        return Err(maveric_error(format!(
            "{} columns of items, expected {}: scale `{}` has that many",
            items.len(),
            scale.count(),
            scale.id
        )));
    }
    let mut answers = Vec::new();
    for (item, name) in (1..=scale.count()).zip(&items) {
        let cells = table.numbers(name).map_err(raised)?;
        for ((row, person), cell) in people.iter().enumerate().zip(cells) {
            let whole = cell.is_none_or(|v| v.fract() == 0.0 && v.abs() < 1e6);
            let (Some(person), true) = (person, whole) else {
                return Err(maveric_error(format!(
                    "row {}: expected a name in `{participant}` and a whole number in `{name}`",
                    row + 1
                )));
            };
            answers.push(Answer {
                participant: ParticipantId::new(person.clone()).map_err(raised)?,
                moment: Moment::Pre,
                scale: scale.id.clone(),
                item,
                answer: cell.map(|v| v as i32),
            });
        }
    }
    let scored = maveric_measures::score(std::slice::from_ref(&scale), &answers, None);
    let scored = scored.map_err(raised)?;
    let scores = &scored.scores;
    let out = Columns::new(py)
        .texts("participant", scores.iter().map(|s| s.participant.to_string()))
        .texts("score", scores.iter().map(|s| format!("{}.{}", s.scale, s.subscale)))
        .numbers("value", scores.iter().map(|s| s.value))
        .integers("answered", scores.iter().map(|s| Some(s.answered.into())))
        .integers("items", scores.iter().map(|s| Some(s.items.into())));
    let warnings = scored.warnings.iter().map(ToString::to_string).collect();
    Ok((out.finish(), warnings))
}
