//! `docs/gallery.md` names every figure there is, with its pictures beside it.

use crate::{gallery_page, golden, kinds};
use std::path::Path;

/// A shade of a sample (0 to 255) that rounding on another platform may change.
const SHADE: u8 = 40;
/// One sample in so many may differ by more.
const ONE_IN: usize = 20_000;

#[test]
fn page_and_pictures_are_what_the_example_writes() {
    let docs = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs"));
    let mut old = Vec::new();
    for file in gallery_page::files(&kinds::context(1)).unwrap() {
        let path = docs.join(&file.path);
        if golden::updating() {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, &file.bytes).unwrap();
        }
        let committed = std::fs::read(&path).unwrap_or_default();
        let text = path.extension().is_some_and(|e| e == "md");
        let same = if text || committed.is_empty() {
            committed == file.bytes
        } else {
            let (now, before) = (golden::pixels(&file.bytes), golden::pixels(&committed));
            let samples = now.2.iter().zip(&before.2);
            let differ = samples.filter(|(a, b)| a.abs_diff(**b) > SHADE).count();
            (now.0, now.1) == (before.0, before.1) && differ <= now.2.len() / ONE_IN
        };
        if !same {
            old.push(file.path);
        }
    }
    assert!(
        old.is_empty(),
        "{} are old: cargo run -p maveric-report --example gallery -- --docs docs",
        old.join(", ")
    );
}

#[test]
fn every_figure_function_of_the_library_is_in_the_gallery() {
    let list = include_str!("../../src/figures/mod.rs");
    let functions: Vec<&str> = list
        .lines()
        .filter_map(|line| line.strip_prefix("pub use ")?.strip_suffix(';')?.split_once("::"))
        .filter(|(module, function)| module == function)
        .map(|(_, function)| function)
        .collect();
    assert!(functions.len() > 20, "{functions:?}");
    for function in functions {
        let known = kinds::KINDS.iter().any(|(name, _)| *name == function);
        assert!(known, "figures::{function} is not in examples/gallery/kinds/mod.rs");
    }
}
