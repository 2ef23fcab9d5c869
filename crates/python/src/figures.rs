//! Figures, from exactly the plain numbers that each draws.

use crate::error::{maveric_error, raised};
use maveric_domain::Design;
use maveric_report::{
    Context, Figure as Drawn, ReportError,
    figures::{self, ConditionLook, intervals, intervals::Intervals},
};
use pyo3::{prelude::*, types::PyBytes};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::{Value, json};

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

/// Draws one kind from its input.
type Draw = fn(Value, &Context) -> Result<Drawn, Refused>;

/// Why a figure is not drawn.
enum Refused {
    /// A field that is missing, or of another kind.
    Input(serde_json::Error),
    /// A field that the figure does not have.
    Unknown(String),
    /// Numbers that cannot be drawn.
    Figure(ReportError),
}

fn read<T: DeserializeOwned + Serialize>(
    given: Value,
    context: &Context,
    draw: impl Fn(&T, &Context) -> Result<Drawn, ReportError>,
) -> Result<Drawn, Refused> {
    let input: T = serde_json::from_value(given.clone()).map_err(Refused::Input)?;
    let known = serde_json::to_value(&input).map_err(Refused::Input)?;
    match stranger(&given, &known) {
        Some(field) => Err(Refused::Unknown(field)),
        None => draw(&input, context).map_err(Refused::Figure),
    }
}

/// A field of `given` that `known` does not have: a misspelt one that may be left out would be lost without a word.
fn stranger(given: &Value, known: &Value) -> Option<String> {
    match (given, known) {
        (Value::Object(given), Value::Object(known)) => given.iter().find_map(|(name, value)| {
            let Some(inner) = known.get(name) else {
                let fields: Vec<&str> = known.keys().map(String::as_str).collect();
                return Some(format!("has no field `{name}`; there are {}", fields.join(", ")));
            };
            stranger(value, inner)
        }),
        (Value::Array(given), Value::Array(known)) => {
            let mut both = given.iter().zip(known);
            both.find_map(|(given, known)| stranger(given, known))
        }
        _ => None,
    }
}

/// Estimates with their intervals, under a title of one's own.
#[derive(Serialize, Deserialize)]
struct Titled {
    title: String,
    #[serde(flatten)]
    input: Intervals,
}

macro_rules! kinds {
    ($($name:ident),+ $(,)?) => {
        [
            $((stringify!($name), (|given, context| read(given, context, figures::$name)) as Draw),)+
            ("intervals", |given, context| {
                read(given, context, |titled: &Titled, context| {
                    intervals::intervals("intervals", &titled.title, &titled.input, context)
                })
            }),
        ]
    };
}

const KINDS: [(&str, Draw); 26] = kinds![
    ablation,
    aggression_line,
    architecture,
    calibration,
    car_following,
    comparison,
    curves,
    dial_sweep,
    difference_panels,
    drive_overview,
    embedding_space,
    false_positives,
    family,
    fidelity,
    flow,
    following_errors,
    forest,
    learning_curve,
    perpendicular,
    preference,
    residuals,
    scatter,
    simulator_view,
    time_space,
    training_curves,
];

/// How conditions look: `given` are tables as `[[condition]]` of a `study.toml`, of which id, label and colour count.
fn looks(given: Value) -> PyResult<Vec<ConditionLook>> {
    let study = json!({ "study": { "title": "figure" }, "condition": given });
    let text = toml::to_string(&study).map_err(raised)?;
    Ok(ConditionLook::of(&Design::from_toml(&text).map_err(raised)?))
}

/// Draws the figure of this name; its input and its conditions are JSON.
#[pyfunction]
pub fn draw(
    py: Python<'_>,
    name: &str,
    input: &str,
    synthetic: Option<u64>,
    conditions: Option<&str>,
) -> PyResult<Figure> {
    let kind = KINDS.iter().find(|(known, _)| *known == name);
    let (_, draw) = kind.ok_or_else(|| maveric_error(format!("there is no figure `{name}`")))?;
    let input: Value = serde_json::from_str(input).map_err(raised)?;
    let mut context = synthetic.map_or_else(Context::real, Context::synthetic);
    if let Some(given) = conditions {
        context = context.with_conditions(looks(serde_json::from_str(given).map_err(raised)?)?);
    }
    let drawn = py.allow_threads(|| draw(input, &context));
    drawn.map(Figure).map_err(|refused| match refused {
        Refused::Input(error) => maveric_error(format!("figure `{name}`: {error}")),
        Refused::Unknown(what) => maveric_error(format!("figure `{name}` {what}")),
        Refused::Figure(error) => raised(error),
    })
}

/// What `draw` takes as `name`.
#[pyfunction]
pub fn figure_names() -> Vec<&'static str> {
    KINDS.iter().map(|(name, _)| *name).collect()
}
