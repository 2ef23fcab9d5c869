//! The paper's world, from the files that are shipped.

use crate::{PopulationModel, World};
use maveric_domain::{Design, Scale, ScoreRange};
use std::path::Path;

fn text(path: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data");
    std::fs::read_to_string(root.join(path)).unwrap()
}

pub(crate) fn design() -> Design {
    Design::from_toml(&text("designs/paper.toml")).unwrap()
}

pub(crate) fn population() -> PopulationModel {
    PopulationModel::from_toml(&text("population.toml")).unwrap()
}

pub(crate) fn world() -> World {
    let scales = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/scales");
    let mut paths: Vec<_> = std::fs::read_dir(scales).unwrap().map(|e| e.unwrap().path()).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "toml"));
    paths.sort();
    let scale =
        |p: &std::path::PathBuf| Scale::from_toml(&std::fs::read_to_string(p).unwrap()).unwrap();
    let scales: Vec<Scale> = paths.iter().map(scale).collect();
    let effects = toml::from_str(&text("effects.toml")).unwrap();
    World::new(design(), population(), effects, scales, ScoreRange::ADB).unwrap()
}
