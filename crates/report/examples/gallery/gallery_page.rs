//! `docs/gallery.md`: every figure with the function that makes it.

use crate::kinds::KINDS;
use maveric_report::html::RenderedFile;
use maveric_report::{Context, ReportError, markup};
use std::fmt::Write as _;

/// Fine enough for a screen.
const DOTS_PER_INCH: f64 = 96.0;

/// The page and its pictures, relative to `docs`.
pub(crate) fn files(context: &Context) -> Result<Vec<RenderedFile>, ReportError> {
    let mut files =
        vec![RenderedFile { path: "gallery.md".to_owned(), bytes: text(context)?.into_bytes() }];
    for (_, draw) in KINDS {
        let figure = draw(context)?;
        files.push(RenderedFile {
            path: format!("gallery/{}.png", figure.name),
            bytes: figure.png_at(DOTS_PER_INCH)?,
        });
    }
    Ok(files)
}

/// The page alone.
pub(crate) fn text(context: &Context) -> Result<String, ReportError> {
    let mut out = "# Gallery\n\n\
        Every figure of `maveric-report`, from made-up numbers (**example data**: sines, which mean nothing), each with \
        the function that makes it and the few lines that put its plain numbers together.\n\n\
        This page is written by `cargo run -p maveric-report --example gallery -- --docs docs`; one kind alone, as SVG \
        and PNG at 300 dots per inch, by `cargo run -p maveric-report --example gallery -- FOLDER preference`.\n\n"
        .to_owned();
    for (name, draw) in KINDS {
        let figure = draw(context)?;
        let _ = write!(
            out,
            "## {}\n\n`figures::{name}` · [example](../crates/report/examples/gallery/kinds/{name}.rs)\n\n![{}](gallery/{}.png)\n\n{}\n\n",
            markup::plain(&figure.title),
            markup::plain(&figure.title),
            figure.name,
            markup::plain(&figure.caption)
        );
    }
    Ok(out)
}
