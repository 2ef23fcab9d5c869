//! Draws every figure and a page from made-up numbers, into a folder.
//!
//! `cargo run -p maveric-report --example gallery -- target/gallery`
#![expect(clippy::print_stdout, reason = "an example talks to whoever runs it")]

mod made_up;

use maveric_report::{Context, render};
use std::{error::Error, fs, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("usage: gallery FOLDER")?);
    let files = render(&made_up::report(&Context::synthetic(1))?)?;
    for file in &files {
        let path = folder.join(&file.path);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent)?;
        }
        fs::write(path, &file.bytes)?;
    }
    println!("{} files in {}", files.len(), folder.display());
    Ok(())
}
