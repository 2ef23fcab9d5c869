//! The files that made-up studies are drawn from.

use crate::{
    atomic_write::read_text,
    design::DesignFile,
    error::StudyError,
    run_folder::{effects_of, read_effects, read_scales},
    style_scores::style_range,
};
use maveric_domain::ScoreRange;
use maveric_rehearsal::{PopulationModel, RehearsalError, World};
use std::path::Path;

/// The world of a design; population, effects and questionnaires are those given, else the design's, else as shipped.
pub(crate) fn read_world(
    study: &DesignFile,
    [population, effects, scales]: [Option<&Path>; 3],
) -> Result<World, StudyError> {
    let files = study.design.files();
    let own_effects = files.effects.as_ref().map(|path| study.resolve(path));
    let own_effects = own_effects.filter(|path| path.is_file());
    let effects = match effects.or(own_effects.as_deref()) {
        Some(path) => read_effects(path)?,
        None => effects_of(Path::new("effects.toml"), maveric_data::EFFECTS)?,
    };
    let own_scales = study.resolve(&files.scales);
    let scales = read_scales(scales.unwrap_or(&own_scales))?;
    let shipped = || Ok(maveric_data::POPULATION.to_owned());
    let text = population.map_or_else(shipped, read_text)?;
    let path = population.unwrap_or(Path::new("population.toml"));
    let population = PopulationModel::from_toml(&text)
        .map_err(|error| StudyError::file(path, error.to_string()))?;
    let range = style_range(study)?.unwrap_or(ScoreRange::ADB);
    World::new(study.design.clone(), population, effects, scales, range).map_err(
        |error| match error {
            RehearsalError::UnknownCar { .. } => study.wrong(
                error.to_string(),
                Some(
                    "maveric stats power gives the power of a test for an effect that you assume"
                        .to_owned(),
                ),
            ),
            RehearsalError::NothingAcross { .. } => study.wrong(
                error.to_string(),
                Some(
                    "give the population (--population) loadings on two traits or more".to_owned(),
                ),
            ),
            other => other.into(),
        },
    )
}
