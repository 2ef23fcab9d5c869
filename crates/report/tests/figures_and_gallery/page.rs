//! `docs/gallery.md` names every figure there is, with its pictures beside it.

use crate::{gallery_page, golden, kinds};
use maveric_report::Context;
use std::path::Path;

#[test]
fn the_page_is_what_the_example_writes() {
    let docs = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs"));
    if golden::updating() {
        for file in gallery_page::files(&Context::synthetic(1)).unwrap() {
            let path = docs.join(&file.path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, file.bytes).unwrap();
        }
    }
    let committed = std::fs::read_to_string(docs.join("gallery.md")).unwrap();
    let now = gallery_page::text(&Context::synthetic(1)).unwrap();
    let differs = committed.lines().zip(now.lines()).find(|(a, b)| a != b);
    assert!(
        committed == now,
        "docs/gallery.md is old, at {differs:?}: cargo run -p maveric-report --example gallery -- --docs docs"
    );
    for (_, draw) in kinds::KINDS {
        let name = draw(&Context::real()).unwrap().name;
        let picture = docs.join(format!("gallery/{name}.png"));
        assert!(picture.is_file(), "{} is missing", picture.display());
    }
}

#[test]
fn every_figure_function_of_the_library_is_in_the_gallery() {
    let list = include_str!("../../src/figures/mod.rs");
    let functions: Vec<&str> = list
        .lines()
        .filter_map(|line| {
            line.strip_prefix("pub use ")?
                .strip_suffix(';')?
                .split_once("::")
        })
        .filter(|(module, function)| module == function)
        .map(|(_, function)| function)
        .collect();
    assert!(functions.len() > 20, "{functions:?}");
    for function in functions {
        let known = kinds::KINDS.iter().any(|(name, _)| *name == function);
        assert!(
            known,
            "figures::{function} is not in examples/gallery/kinds/mod.rs"
        );
    }
}
