//! Means, pairs and simple effects of a factorial design, by the tests that decide about its effects.

use serde::{Deserialize, Serialize};

use super::{
    Chosen, DesignColumns, DesignTable, FactorialFinding, LevelChoice, LevelContrast, SimpleTest,
    factors::shaped, level_contrast, level_contrast::Scores, simple_effects,
};
use crate::{
    Interval, Named, Reasons, StatsError,
    factorial::{SubjectCovariate, cell_weights, stratum_weights},
    within_subjects::pairs,
};

/// What follows the tests of the effects of a factorial design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FollowUp {
    /// The covariates at whose mean the means are.
    pub covariates: Vec<String>,
    /// Means of each effect of factors, by cell.
    pub emm: Named<Named<CellMean>>,
    /// Pairs of the levels of each factor.
    pub contrast: Named<Named<LevelPair>>,
    /// Simple effects of each interaction of two factors.
    pub simple: Vec<SimplePairs>,
    /// Why numbers do not exist, by name: those of the analysis of variance too.
    pub undefined: Reasons,
}

/// A mean over cells with equal weight; each group has an error of its own, and with covariates all have that of the regressions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellMean {
    /// Subjects behind it.
    pub n: usize,
    /// In the unit of the values.
    pub mean: f64,
    /// Its standard error; `None` where the subjects do not differ, or a group has one.
    pub se: Option<f64>,
    /// Degrees of freedom of its interval.
    pub df: Option<f64>,
    /// Its 95 % interval.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
}

/// Two levels of a factor, A minus B.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LevelPair {
    /// The difference and its test.
    #[serde(flatten)]
    pub test: LevelContrast,
    /// Holm's correction over the pairs beside it.
    pub p_holm: Option<f64>,
}

/// A simple effect with its pairs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimplePairs {
    /// Which factor at which level of another, and its test.
    #[serde(flatten)]
    pub effect: SimpleTest,
    /// The pairs of the factor there; empty where it has two levels, whose pair is the effect.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub pairs: Named<LevelPair>,
}

const NO_ERROR: &str =
    "it does not vary between subjects or a group has one subject, so it has no error";

/// What follows the tests of effects: the means of each effect, the pairs of each factor as [`level_contrast`](level_contrast()) has them, and the
/// [`simple_effects`], all of the subjects that the effects were tested with.
///
/// Of two levels the pair is the effect's own test. Where there are covariates of the subjects each mean is that of regressions on the groups
/// and the covariates, at the mean of these: what all cells of a subject have in common on all covariates, a difference between cells on those
/// that are declared to be multiplied by its effect. So means differ by their pair.
///
/// # Errors
/// Those of the tests of the whole; what one pair lacks is a reason in `undefined`.
pub fn follow_up(
    data: &DesignColumns<'_>,
    whole: &Chosen<FactorialFinding>,
) -> Result<FollowUp, StatsError> {
    let anova = &whole.found.anova;
    let complete = |row: &usize| !anova.dropped.contains(&data.subjects[*row]);
    let rows: Vec<usize> = (0..data.subjects.len()).filter(complete).collect();
    let table = DesignTable::rows(data, &rows, None);
    let data = table.columns();
    let mut undefined = Reasons::default();
    for (name, reason) in anova.undefined.iter() {
        let part = name.split('.').next();
        if !matches!(part, Some("emm" | "contrast" | "simple")) {
            undefined.note(name, reason);
        }
    }
    let emm = means(&data, whole, &mut undefined)?;
    let mut contrast = Vec::new();
    for (factor, levels) in anova.levels.iter() {
        let name = format!("contrast.{factor}");
        let pairs = level_pairs(&data, whole, (factor, levels), None, (&name, &mut undefined));
        contrast.push((factor.to_owned(), pairs));
    }
    let mut simple = Vec::new();
    for effect in simple_effects(&data, whole)? {
        let SimpleTest { factor, at, level, .. } = &effect;
        let name = format!("simple.{factor}@{at}:{level}");
        if let Some(why) = &effect.why_not {
            undefined.note(&name, why.as_str());
        }
        let levels = anova.levels.get(factor).filter(|levels| levels.len() > 2);
        let pairs = levels.map_or_else(Named::default, |levels| {
            let held = Some((at.as_str(), level.as_str()));
            level_pairs(&data, whole, (factor, levels), held, (&name, &mut undefined))
        });
        simple.push(SimplePairs { effect, pairs });
    }
    Ok(FollowUp {
        covariates: (data.covariates.iter()).map(|(name, _)| (*name).to_owned()).collect(),
        emm,
        contrast: contrast.into_iter().collect(),
        simple,
        undefined,
    })
}

/// The pairs of a factor's levels, at a level of another or over all of them.
fn level_pairs(
    data: &DesignColumns<'_>,
    whole: &Chosen<FactorialFinding>,
    (factor, levels): (&str, &[String]),
    held: Option<(&str, &str)>,
    (prefix, undefined): (&str, &mut Reasons),
) -> Named<LevelPair> {
    let of_pair = |(a, b, name): (usize, usize, String)| {
        let pair = LevelChoice::Pair([levels[a].clone(), levels[b].clone()]);
        let held = held.map(|(other, level)| (other, LevelChoice::At(level.to_owned())));
        let parts: Vec<(&str, LevelChoice)> = [(factor, pair)].into_iter().chain(held).collect();
        match level_contrast(data, whole, &parts) {
            Ok(test) => {
                if test.p.is_none() {
                    undefined.note(&format!("{prefix}.{name}"), NO_ERROR);
                }
                Some((name, LevelPair { test, p_holm: None }))
            }
            Err(why) => {
                undefined.note(&format!("{prefix}.{name}"), why.to_string());
                None
            }
        }
    };
    let pairs: Named<LevelPair> = pairs(levels).into_iter().filter_map(of_pair).collect();
    pairs.with_holm(|pair| pair.test.p, |pair, p| pair.p_holm = p)
}

/// The means of each effect of factors, by cell.
fn means(
    data: &DesignColumns<'_>,
    whole: &Chosen<FactorialFinding>,
    undefined: &mut Reasons,
) -> Result<Named<Named<CellMean>>, StatsError> {
    let (design, shape, covariates) = shaped(data)?;
    let factors: Vec<(&str, &Vec<String>)> = whole.found.anova.levels.iter().collect();
    let mut by_effect = Vec::new();
    for (effect, between, within) in shape.effects() {
        let Some(test) = whole.found.tests.get(&effect) else {
            continue;
        };
        let mask = between | within << shape.between.len();
        let inside = factors.iter().enumerate();
        let inside: Vec<(&str, &Vec<String>)> =
            inside.filter(|(f, _)| mask >> f & 1 == 1).map(|(_, factor)| *factor).collect();
        let mut cells: Vec<Vec<&str>> = vec![Vec::new()];
        for (_, levels) in &inside {
            let mut longer = Vec::new();
            for cell in &cells {
                longer.extend(levels.iter().map(|l| [&cell[..], &[l.as_str()]].concat()));
            }
            cells = longer;
        }
        let mut means = Vec::new();
        for cell in cells {
            let position = |name: &str| {
                let place = inside.iter().position(|(factor, _)| *factor == name)?;
                let mut factors = design.between().iter().chain(design.within());
                let factor = factors.find(|factor| factor.name == name)?;
                factor.levels.iter().position(|level| level == cell[place])
            };
            let (groups, weights) = cell_weights(&design, position);
            let scores =
                Scores { design: &design, sides: design.weighted_sides(&weights), weights: groups };
            let contrast = if covariates.is_empty() {
                scores.by_welch(test.method)
            } else {
                // The covariates of each stratum, as its tests and its pairs have them.
                let strata = (0..=within).filter(|stratum| stratum & !within == 0);
                let of_stratum = |stratum: usize| {
                    let names = shape.within.iter().enumerate();
                    let names = names.filter(|(f, _)| stratum >> f & 1 == 1);
                    let names: Vec<&str> = names.map(|(_, (name, _))| name.as_str()).collect();
                    let weights = stratum_weights(&design, position, |name| names.contains(&name));
                    let sides = design.weighted_sides(&weights).into_iter();
                    let part: Vec<f64> = sides.map(|[plus, minus]| plus - minus).collect();
                    let mut on = covariates.clone();
                    on.retain(|covariate| shape.has_covariate(stratum, covariate.name));
                    (part, on)
                };
                let parts: Vec<(Vec<f64>, Vec<SubjectCovariate>)> =
                    strata.map(of_stratum).collect();
                scores.by_regressions(test.method, &parts)
            };
            let name = cell.join(":");
            if contrast.se.is_none() {
                undefined.note(&format!("emm.{effect}.{name}"), NO_ERROR);
            }
            let mean = CellMean {
                n: contrast.n,
                mean: contrast.estimate,
                se: contrast.se,
                df: contrast.df,
                ci: contrast.ci,
            };
            means.push((name, mean));
        }
        by_effect.push((effect, means.into_iter().collect()));
    }
    Ok(by_effect.into_iter().collect())
}
