//! Figures, from exactly the plain numbers that each draws.

use crate::error::{raised, said};
use maveric_report::{Context, Figure as Drawn, ReportError, figures};
use pyo3::{prelude::*, types::PyBytes};
use serde::de::DeserializeOwned;

/// A finished figure.
#[pyclass(frozen, module = "maveric")]
pub struct Figure(pub(crate) Drawn);

#[pymethods]
impl Figure {
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    #[getter]
    fn title(&self) -> &str {
        &self.0.title
    }

    #[getter]
    fn caption(&self) -> &str {
        &self.0.caption
    }

    #[getter]
    fn alt(&self) -> &str {
        &self.0.alt
    }

    /// SVG with its font inside.
    #[getter]
    fn svg(&self) -> String {
        self.0.standalone_svg()
    }

    #[pyo3(signature = (dots_per_inch = 300.0))]
    fn png<'py>(&self, py: Python<'py>, dots_per_inch: f64) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.allow_threads(|| self.0.png_at(dots_per_inch)).map_err(raised)?;
        Ok(PyBytes::new(py, &bytes))
    }

    fn _repr_svg_(&self) -> String {
        self.0.standalone_svg()
    }

    fn __repr__(&self) -> String {
        format!("<maveric.Figure {}: {}>", self.0.name, self.0.title)
    }
}

/// Draws one kind from its input, as JSON.
type Draw = fn(&str, &Context) -> Result<Drawn, Refused>;

enum Refused {
    Input(serde_json::Error),
    Figure(ReportError),
}

fn read<T: DeserializeOwned>(
    json: &str,
    context: &Context,
    draw: impl Fn(&T, &Context) -> Result<Drawn, ReportError>,
) -> Result<Drawn, Refused> {
    let input = serde_json::from_str(json).map_err(Refused::Input)?;
    draw(&input, context).map_err(Refused::Figure)
}

macro_rules! kinds {
    ($($name:ident),+ $(,)?) => {
        [$((stringify!($name), (|json, context| read(json, context, figures::$name)) as Draw)),+]
    };
}

/// The figures that draw numbers of one's own.
const KINDS: [(&str, Draw); 20] = kinds![
    ablation,
    aggression_line,
    calibration,
    car_following,
    comparison,
    correlation_heatmap,
    curves,
    dial_sweep,
    difference_panels,
    drive_overview,
    false_positives,
    flow,
    following_errors,
    forest,
    learning_curve,
    residuals,
    scatter,
    step_responses,
    time_space,
    training_curves,
];

/// Draws the figure of this name from its input as JSON.
#[pyfunction]
pub fn draw(py: Python<'_>, name: &str, input: &str, synthetic: Option<u64>) -> PyResult<Figure> {
    let kind = KINDS.iter().find(|(known, _)| *known == name);
    let (_, draw) = kind.ok_or_else(|| said(format!("there is no figure `{name}`")))?;
    let context = synthetic.map_or_else(Context::real, Context::synthetic);
    let drawn = py.allow_threads(|| draw(input, &context));
    drawn.map(Figure).map_err(|refused| match refused {
        Refused::Input(error) => said(format!("figure `{name}`: {error}")),
        Refused::Figure(error) => raised(error),
    })
}

/// The figures' names.
#[pyfunction]
pub fn figure_names() -> Vec<&'static str> {
    KINDS.iter().map(|(name, _)| *name).collect()
}
