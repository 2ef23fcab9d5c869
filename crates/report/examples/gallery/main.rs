//! Draws figures and a page from made-up numbers.
//!
//! - `cargo run -p maveric-report --example gallery -- FOLDER`: the page of all figures and tables
//! - `cargo run -p maveric-report --example gallery -- FOLDER preference`: one kind, as SVG and PNG; how its plain
//!   numbers are put together stands in `kinds/preference.rs`
//! - `cargo run -p maveric-report --example gallery -- --docs docs`: `docs/gallery.md` and its pictures
#![expect(clippy::print_stdout, reason = "an example talks to whoever runs it")]

mod gallery_page;
mod made_up;

use made_up::kinds;
use maveric_report::html::RenderedFile;
use maveric_report::{Context, render};
use std::{error::Error, fs, path::Path};

const USAGE: &str = "usage: gallery FOLDER [KIND], or gallery --docs FOLDER";

fn main() -> Result<(), Box<dyn Error>> {
    let context = kinds::context(1);
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let (folder, files) = match words[..] {
        ["--docs", folder] => (folder, gallery_page::files(&context)?),
        [folder] => (folder, render(&made_up::report(&context)?)?),
        [folder, kind] => (folder, one(kind, &context)?),
        _ => return Err(USAGE.into()),
    };
    for file in &files {
        let path = Path::new(folder).join(&file.path);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent)?;
        }
        fs::write(path, &file.bytes)?;
    }
    println!("{} files in {folder}", files.len());
    Ok(())
}

fn one(kind: &str, context: &Context) -> Result<Vec<RenderedFile>, Box<dyn Error>> {
    let Some((_, draw)) = kinds::KINDS.iter().find(|(name, _)| *name == kind) else {
        let names = kinds::KINDS.map(|(name, _)| name).join(", ");
        return Err(format!("no kind `{kind}`; there are {names}").into());
    };
    let figure = draw(context)?;
    Ok(vec![
        RenderedFile {
            path: format!("{}.svg", figure.name),
            bytes: figure.standalone_svg().into_bytes(),
        },
        RenderedFile { path: format!("{}.png", figure.name), bytes: figure.png()? },
    ])
}
