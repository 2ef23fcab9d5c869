//! A report as a list of files.

use super::page::{page, table_page};
use super::report::{RenderedFile, Report};
use crate::claims::ledger_table;
use crate::error::ReportError;
use crate::figures::Figure;
use crate::tables::{Table, exclusions};
#[cfg(feature = "parallel")]
use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// Renders `index.html`, `figures/*.{svg,png}` and PDF (each with its feature) and `tables/*.{csv,md,tex,html}`.
///
/// The same report gives the same bytes.
///
/// # Errors
/// What [`Report::check`] finds; [`ReportError::Png`] or [`ReportError::Template`] if rendering
/// fails.
pub fn render(report: &Report) -> Result<Vec<RenderedFile>, ReportError> {
    report.check()?;
    let left_out = exclusions(&report.exclusions);
    let ledger = report.ledger.as_deref().map(ledger_table);
    let mut plots = Vec::new();
    for card in &report.cards {
        plots.push(card.figure(&report.context)?);
    }
    let mut files = vec![RenderedFile {
        path: "index.html".to_owned(),
        bytes: page(report, &plots, &left_out)?.into_bytes(),
    }];
    let figures = report.all_sections().flat_map(|section| &section.figures);
    let figures: Vec<&Figure> = plots
        .iter()
        .flatten()
        .chain(figures)
        .flat_map(|figure| std::iter::once(figure).chain(&figure.panels))
        .collect();
    // Rendering pictures takes most of the time; the order of the files stays that of the figures.
    #[cfg(feature = "parallel")]
    let figures = figures.into_par_iter();
    #[cfg(not(feature = "parallel"))]
    let figures = figures.into_iter();
    let drawn = figures.map(figure_files);
    files.extend(drawn.collect::<Result<Vec<_>, _>>()?.into_iter().flatten());
    let tables = report.all_sections().flat_map(|section| &section.tables);
    for table in tables.chain([&left_out]).chain(ledger.as_ref()) {
        files.extend(table_files(table, report)?);
    }
    files.extend(report.beside.iter().cloned());
    Ok(files)
}

fn figure_files(figure: &Figure) -> Result<Vec<RenderedFile>, ReportError> {
    let path = |ending: &str| format!("figures/{}.{ending}", figure.name);
    Ok(vec![
        RenderedFile { path: path("svg"), bytes: figure.standalone_svg().into_bytes() },
        #[cfg(feature = "png")]
        RenderedFile { path: path("png"), bytes: figure.png()? },
        #[cfg(feature = "pdf")]
        RenderedFile { path: path("pdf"), bytes: figure.pdf()? },
    ])
}

fn table_files(table: &Table, report: &Report) -> Result<[RenderedFile; 4], ReportError> {
    let file = |ending: &str, text: String| RenderedFile {
        path: format!("tables/{}.{ending}", table.name),
        bytes: text.into_bytes(),
    };
    Ok([
        file("csv", table.to_csv()),
        file("md", table.to_markdown()),
        file("tex", table.to_latex()),
        file("html", table_page(table, report)?),
    ])
}
