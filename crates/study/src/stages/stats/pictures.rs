//! The figure of a result: rainclouds with contrasts, means of two factors, a scatter, or a forest.

mod cells;
mod designs;
mod points;

pub(super) use cells::{conditions, pairs};
pub(super) use designs::{
    aligned, by_design, equivalence, factorial, groups, mixed, ordinal, plain_cells,
};
pub(super) use points::{correlation, within_people};

use crate::{atomic_write::atomic_write_bytes, error::StudyError};
use maveric_report::{
    Context, Figure,
    figures::{
        comparison::{Comparison, ComparisonPanel, comparison},
        forest::{Forest, forest},
        interaction::{Interaction, InteractionPanel, interaction},
        scatter::{Scatter, scatter},
    },
    markup,
};
use maveric_stats::apa;
use path_slash::PathExt as _;
use std::path::Path;

/// What is drawn of one result.
#[derive(Debug)]
pub(super) enum Picture {
    /// Groups, conditions or cells; the sentences say what intervals and brackets are.
    Panel(ComparisonPanel, &'static str, &'static str),
    Interaction(InteractionPanel),
    Scatter(Scatter),
    Forest(Forest),
}

/// Draws one result, or the panels of several outcomes, into an SVG, PNG or PDF file.
pub(super) fn write(path: &Path, pictures: Vec<Picture>) -> Result<(), StudyError> {
    let figure = draw(pictures)?;
    let bytes = match format(path)? {
        Format::Svg => figure.standalone_svg().into_bytes(),
        Format::Png => figure.png()?,
        Format::Pdf => figure.pdf()?,
    };
    atomic_write_bytes(path, &bytes)
}

/// As what a figure is written.
#[derive(Debug, Clone, Copy)]
pub(super) enum Format {
    Svg,
    Png,
    Pdf,
}

pub(super) fn format(path: &Path) -> Result<Format, StudyError> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("svg") => Ok(Format::Svg),
        Some("png") => Ok(Format::Png),
        Some("pdf") => Ok(Format::Pdf),
        _ => Err(StudyError::not_possible(format!(
            "{}: a figure is written as .svg, .png or .pdf",
            path.to_slash_lossy()
        ))),
    }
}

fn draw(pictures: Vec<Picture>) -> Result<Figure, StudyError> {
    let context = Context::real();
    let (mut panels, mut crossed) = (Vec::new(), Vec::new());
    let (mut forests, mut scatters) = (Vec::new(), Vec::new());
    let mut notes = ("", "");
    for picture in pictures {
        match picture {
            Picture::Panel(panel, intervals, contrasts) => {
                notes = (intervals, contrasts);
                panels.push(panel);
            }
            Picture::Interaction(panel) => crossed.push(panel),
            Picture::Forest(input) => forests.push(input),
            Picture::Scatter(input) => scatters.push(input),
        }
    }
    if let Some(mut first) = forests.pop() {
        // Several outcomes under each other, each row with its own.
        while let Some(other) = forests.pop() {
            first.title = format!("{}; {}", other.title, first.title);
            first.rows.splice(0..0, other.rows);
        }
        return Ok(forest(&first, &context)?);
    }
    if let Some(input) = scatters.pop() {
        return Ok(scatter(&input, &context)?);
    }
    if !crossed.is_empty() {
        let input = Interaction {
            panels: crossed,
            intervals: "They are those of the marginal means, cells with equal weight.".to_owned(),
        };
        return Ok(interaction(&input, &context)?);
    }
    let input = Comparison { panels, intervals: notes.0.to_owned(), contrasts: notes.1.to_owned() };
    Ok(comparison(&input, &context)?)
}

/// The first sentence of a result, for above a panel.
pub(super) fn first(result: &impl apa::Statements) -> String {
    let first = result.statements().into_iter().next();
    first.map_or_else(
        || markup::literal("no test has a value"),
        |(_, sentence)| sentence.markup().to_owned(),
    )
}
