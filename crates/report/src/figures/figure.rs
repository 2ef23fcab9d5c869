//! What every figure is, and what it says about whose numbers it shows.

use super::ConditionLook;
use super::axes::Place;
use super::canvas::{Canvas, Look, sketch};
use super::font::font_face_css;
use super::page::Head;
use super::style;
use super::theme::{MUTED, size};
use crate::error::ReportError;
use crate::{apa, markup};
use maveric_domain::{ConditionId, SpeedUnit};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// Whose numbers are shown.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Context {
    /// The participants do not exist: every figure, caption and file says so.
    pub synthetic: bool,
    /// A script drove in place of people: every figure, caption and file says so.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub scripted: bool,
    /// People beyond what the model has learned from for whom the dial was turned all the same: every caption says how many.
    #[serde(default, skip_serializing_if = "none_beyond")]
    pub beyond: usize,
    /// Root seed of the run, written into the files' metadata.
    pub seed: Option<u64>,
    /// How the conditions look, as their design says.
    pub conditions: Vec<ConditionLook>,
    /// In which unit people read speeds, as their design says.
    #[serde(default)]
    pub speed: SpeedUnit,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks with a reference")]
fn none_beyond(beyond: &usize) -> bool {
    *beyond == 0
}

impl Context {
    /// A context of real recordings.
    pub fn real() -> Self {
        Self::default()
    }

    /// A context of synthetic participants, or of real recordings.
    pub fn of(synthetic: bool, seed: u64) -> Self {
        if synthetic { Self::synthetic(seed) } else { Self::real() }
    }

    /// A context of synthetic participants.
    pub fn synthetic(seed: u64) -> Self {
        Self { synthetic: true, seed: Some(seed), ..Self::default() }
    }

    /// The same, with the conditions of a study.
    #[must_use]
    pub fn with_conditions(self, conditions: Vec<ConditionLook>) -> Self {
        Self { conditions, ..self }
    }

    /// The same, with speeds read in this unit.
    #[must_use]
    pub fn with_speed(self, speed: SpeedUnit) -> Self {
        Self { speed, ..self }
    }

    /// A speed as it is read, without its unit.
    pub(crate) fn speed(&self, mps: f64, decimals: usize) -> String {
        apa::number(mps * self.speed.per_mps(), decimals)
    }

    /// How a condition looks, as its design says, or the style that was chosen.
    pub(crate) fn look(&self, id: ConditionId) -> ConditionLook {
        let known = self.conditions.iter().find(|look| look.id == id);
        let look = known.cloned().unwrap_or_else(|| ConditionLook::unknown(id));
        match style::current().and_then(|style| style.look(id)) {
            Some(other) => look.dressed(other),
            None => look,
        }
    }

    /// What a page's subtitle begins with.
    pub fn preface(&self) -> &'static str {
        match (self.synthetic, self.scripted) {
            (true, _) => "Synthetic participants: ",
            (false, true) => "Driven by a script: ",
            (false, false) => "",
        }
    }

    /// Who stands in place of people, if nobody real drove.
    pub(crate) fn stand_ins(&self) -> Option<&'static str> {
        match (self.synthetic, self.scripted) {
            (true, _) => Some("synthetic participants"),
            (false, true) => Some("driven by a script"),
            (false, false) => None,
        }
    }

    pub(crate) fn metadata(&self) -> String {
        let mut words = Vec::new();
        if self.synthetic {
            words.push("Synthetic participants".to_owned());
        }
        if self.scripted {
            words.push("Driven by a script".to_owned());
        }
        if let Some(seed) = self.seed {
            words.push(format!("seed {seed}"));
        }
        words.join("; ")
    }
}

/// A finished figure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// Stem of its files and its anchor: lower-case letters, digits, hyphens.
    pub name: String,
    /// One line.
    pub title: String,
    /// The caption, with marks (see [`crate::markup`]): what is shown, n, the test.
    pub caption: String,
    /// The finding in words, for who cannot see the picture. Plain text.
    pub alt: String,
    /// SVG 1.1, without the font inside: for a page that has the font, and for comparing.
    pub svg: String,
    /// Each of its panels as a figure of its own, of one column's width; empty for a figure of one panel.
    pub panels: Vec<Figure>,
    /// Where each panel stands in the drawing, and before them what stands above all: left, top, width and height in its units.
    pub cells: Vec<[i32; 4]>,
}

impl Figure {
    /// The SVG with the font inside, to stand alone as a file.
    pub fn standalone_svg(&self) -> String {
        match self.svg.split_once("<metadata>") {
            Some((before, after)) => {
                format!("{before}<style>{}</style>\n<metadata>{after}", font_face_css())
            }
            None => self.svg.clone(),
        }
    }

    /// The figure as PDF, a page of its own size.
    ///
    /// # Errors
    /// [`ReportError::Pdf`] if the SVG cannot be read.
    #[cfg(feature = "pdf")]
    pub fn pdf(&self) -> Result<Vec<u8>, ReportError> {
        super::pdf::render(&self.name, &self.svg)
    }

    /// The figure as PNG at 300 dots per inch, on white.
    ///
    /// # Errors
    /// [`ReportError::Png`] if the SVG cannot be read or rendered.
    #[cfg(feature = "png")]
    pub fn png(&self) -> Result<Vec<u8>, ReportError> {
        self.png_at(PRINT_DPI)
    }

    /// The figure as PNG at a resolution in dots per inch, on white.
    ///
    /// # Errors
    /// [`ReportError::Png`] if the SVG cannot be read or rendered, or the picture would have no or too many pixels.
    ///
    /// # Example
    /// ```
    /// use maveric_report::{Context, figures};
    /// let small = figures::domain(&Context::real())?.png_at(96.0)?;
    /// assert_eq!(&small[1..4], b"PNG");
    /// # Ok::<(), maveric_report::ReportError>(())
    /// ```
    #[cfg(feature = "png")]
    pub fn png_at(&self, dots_per_inch: f64) -> Result<Vec<u8>, ReportError> {
        super::png::render(&self.name, &self.svg, &self.alt, dots_per_inch)
    }
}

/// What journals ask for.
#[cfg(feature = "png")]
const PRINT_DPI: f64 = 300.0;

/// Whether a figure shows what participants did, or explains a thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shows {
    Participants,
    Explanation,
}

/// Everything of a figure but the drawing.
#[derive(Debug)]
pub(crate) struct Plan {
    pub(crate) name: String,
    pub(crate) size_mm: (f64, f64),
    pub(crate) title: String,
    pub(crate) caption: String,
    pub(crate) alt: String,
    pub(crate) shows: Shows,
}

/// Around the drawing, in points.
pub(crate) const MARGIN: f64 = 3.0;
const LABEL_HEIGHT: f64 = 8.0;

/// Draws a figure into its place; says "synthetic participants", or that a script drove, where that is so.
pub(crate) fn draw(
    plan: Plan,
    context: &Context,
    paint: impl FnOnce(&mut Canvas<'_>, Place),
) -> Result<Figure, ReportError> {
    let shown = plan.shows == Shows::Participants;
    let stand_ins = context.stand_ins().filter(|_| shown);
    let style = style::current();
    let (shown_mm, size_mm) = style.map_or((plan.size_mm, plan.size_mm), |s| s.sizes(plan.size_mm));
    let head = Head {
        name: plan.name.clone(),
        shown_mm,
        size_mm,
        title: markup::plain(&plan.title),
        description: plan.alt.clone(),
        metadata: match plan.shows {
            Shows::Participants => context.metadata(),
            Shows::Explanation => String::new(),
        },
    };
    let sketch = sketch(&head, |canvas| {
        let foot = if stand_ins.is_some() { LABEL_HEIGHT } else { 0.0 };
        let (right, bottom) = (canvas.width - MARGIN, canvas.height - MARGIN);
        let place = Place { left: MARGIN, top: MARGIN, right, bottom: bottom - foot };
        paint(canvas, place);
        if let Some(who) = stand_ins {
            let look = Look::new(size::SMALL).end().colour(MUTED);
            canvas.text(who, (right, bottom), look);
        }
    })?;
    let mut caption = plan.caption;
    if sketch.unknown_signs {
        caption += " A question mark stands for a sign that the figure’s font lacks.";
    }
    if let Some(who) = stand_ins {
        let _ = write!(caption, " {}.", markup::capital(who));
    }
    if shown && context.beyond > 0 {
        let many = if context.beyond == 1 { "person is" } else { "people are" };
        let _ = write!(
            caption,
            " {} {many} beyond what the model has learned from; the dial was turned for them all the same.",
            context.beyond
        );
    }
    Ok(Figure {
        name: plan.name,
        title: plan.title,
        caption,
        alt: plan.alt,
        svg: style.map_or(sketch.svg.clone(), |style| style.dressed(&sketch.svg)),
        panels: Vec::new(),
        cells: Vec::new(),
    })
}
