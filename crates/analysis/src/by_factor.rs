//! What the factors of a design did, level by level: means, simple effects, declared contrasts.

use crate::{
    AnalysisError,
    crossed::factors_within,
    data::StudyData,
    family::holm,
    result::{ByFactor, FactorContrast, LevelMean, TestedFactor},
};
use maveric_domain::{
    Design,
    design::{LevelContrast, Levels},
};
use maveric_stats::{
    Chosen, DesignColumns, FactorialFinding, GroupSummary, GroupsAnalysis, LevelChoice,
    level_contrast, mean, mean_of_groups_interval, simple_effects, within_subject_intervals,
};
use std::collections::{BTreeMap, BTreeSet};

/// The factors of an outcome that several were tested of; and why a declared contrast has no test.
pub(crate) fn by_factor(
    design: &Design,
    columns: &DesignColumns<'_>,
    chosen: &Chosen<FactorialFinding>,
) -> Result<(ByFactor, Vec<String>), AnalysisError> {
    let is_within = |name: &str| columns.within.iter().any(|(within, _)| *within == name);
    let factors = chosen.found.anova.levels.iter();
    let factors: Vec<TestedFactor> = factors
        .map(|(name, levels)| TestedFactor {
            name: name.to_owned(),
            within: is_within(name),
            levels: levels.clone(),
        })
        .collect();
    let mut reasons = Vec::new();
    let mut contrasts = Vec::new();
    for declared in design.level_contrasts() {
        let parts: Vec<(&str, LevelChoice)> =
            declared.iter().map(|(name, levels)| (name.as_str(), choice(levels))).collect();
        match level_contrast(columns, chosen, &parts) {
            Ok(test) => contrasts.push(FactorContrast {
                levels: parts.into_iter().map(|(n, c)| (n.to_owned(), c)).collect(),
                test,
                p_holm: None,
            }),
            // What one outcome lacks is no fault of the study.
            Err(why) => reasons.push(format!(
                "the declared contrast of {} has no test: {why}",
                in_words(design, declared)
            )),
        }
    }
    holm(contrasts.iter_mut().map(|c| (c.test.p, &mut c.p_holm)))?;
    Ok((
        ByFactor {
            means: means(&factors, columns, chosen),
            simple: simple_effects(columns, chosen)?,
            contrasts,
            factors,
        },
        reasons,
    ))
}

fn choice(levels: &Levels) -> LevelChoice {
    match levels {
        Levels::Pair(pair) => LevelChoice::Pair(pair.clone()),
        Levels::At(level) => LevelChoice::At(level.clone()),
    }
}

/// A declared contrast in the words of the design.
fn in_words(design: &Design, declared: &LevelContrast) -> String {
    let part = |(name, levels): (&String, &Levels)| {
        let labels = levels.named().iter().map(|l| design.level_label(name, l));
        let labels: Vec<String> = labels.collect();
        format!("{}: {}", design.factor_label(name), labels.join(" − "))
    };
    declared.iter().map(part).collect::<Vec<_>>().join(", ")
}

/// The mean of each level and of each cell.
fn means(
    factors: &[TestedFactor],
    columns: &DesignColumns<'_>,
    chosen: &Chosen<FactorialFinding>,
) -> Vec<LevelMean> {
    let anova = &chosen.found.anova;
    let people = complete(columns, &anova.dropped);
    let mut means = Vec::new();
    for mask in 1..1_usize << factors.len() {
        let inside = factors.iter().enumerate();
        let inside: Vec<&TestedFactor> =
            inside.filter(|(f, _)| mask >> f & 1 == 1).map(|(_, factor)| factor).collect();
        let names: Vec<&str> = inside.iter().map(|f| f.name.as_str()).collect();
        let effect = names.join(":");
        let Some(cells) = anova.emm.get(&effect) else {
            continue;
        };
        let whole = inside.len() == factors.len() && inside.iter().any(|f| f.within);
        for (levels, mean) in product(&inside).into_iter().zip(cells.values()) {
            let is_there = |person: &&Complete| {
                let level = |(f, level): (&&TestedFactor, &String)| {
                    f.within || person.groups.contains(&(f.name.as_str(), level.as_str()))
                };
                inside.iter().zip(&levels).all(level)
            };
            let those: Vec<&Complete> = people.iter().filter(is_there).collect();
            means.push(LevelMean {
                n: those.len(),
                mean: mean.mean,
                interval: mean_of_groups_interval(&scores(&those, columns, &inside, &levels), 0.95)
                    .map(|[_, low, high]| (low, high)),
                within: whole.then(|| within(&those, columns, &inside, &levels)).flatten(),
                effect: effect.clone(),
                levels,
            });
        }
    }
    means.sort_by_key(|mean| mean.levels.len());
    means
}

/// What groups of people did who are compared with one another alone: the mean of each, and nothing within them.
pub(crate) fn of_groups(columns: &DesignColumns<'_>, groups: &GroupsAnalysis) -> Option<ByFactor> {
    let (name, _) = columns.between.first()?;
    let mean_of = |(level, group): (&str, &GroupSummary)| LevelMean {
        effect: (*name).to_owned(),
        levels: vec![level.to_owned()],
        n: group.n,
        mean: group.mean,
        // None where nobody differs, as of several factors.
        interval: group.ci.ends().filter(|(low, high)| low < high),
        within: None,
    };
    let levels = groups.desc.iter().map(|(level, _)| level.to_owned());
    Some(ByFactor {
        means: groups.desc.iter().map(mean_of).collect(),
        factors: vec![TestedFactor {
            name: (*name).to_owned(),
            within: false,
            levels: levels.collect(),
        }],
        simple: Vec::new(),
        contrasts: Vec::new(),
    })
}

/// Every combination of levels, the last factor counting fastest.
fn product(factors: &[&TestedFactor]) -> Vec<Vec<String>> {
    factors.iter().fold(vec![Vec::new()], |cells, factor| {
        let longer = |cell: &Vec<String>| {
            let levels = factor.levels.iter();
            let with = levels.map(|level| [cell.as_slice(), std::slice::from_ref(level)].concat());
            with.collect::<Vec<_>>()
        };
        cells.iter().flat_map(longer).collect()
    })
}

/// Somebody with a value in every cell.
struct Complete<'a> {
    groups: Vec<(&'a str, &'a str)>,
    rows: Vec<usize>,
}

fn complete<'a>(columns: &DesignColumns<'a>, dropped: &[String]) -> Vec<Complete<'a>> {
    let mut seen = BTreeSet::new();
    let subjects = columns.subjects.iter();
    let people = subjects.filter(|who| !dropped.contains(who) && seen.insert(*who));
    people
        .map(|who| {
            let rows = (0..columns.subjects.len()).filter(|r| columns.subjects[*r] == *who);
            let rows: Vec<usize> = rows.collect();
            let level = |(name, cells): &(&'a str, &'a [Option<String>])| {
                Some((*name, cells[rows[0]].as_deref()?))
            };
            Complete { groups: columns.between.iter().filter_map(level).collect(), rows }
        })
        .collect()
}

/// The mean of each person over their rows at these levels, by group: the tests do not pool groups, so neither do intervals.
fn scores(
    people: &[&Complete],
    columns: &DesignColumns<'_>,
    factors: &[&TestedFactor],
    levels: &[String],
) -> Vec<Vec<f64>> {
    let is_here = |row: usize| {
        columns.within.iter().all(|(name, cells)| {
            let mut held = factors.iter().zip(levels);
            held.all(|(factor, level)| factor.name != *name || cells[row] == *level)
        })
    };
    let mut groups: BTreeMap<&[(&str, &str)], Vec<f64>> = BTreeMap::new();
    for person in people {
        let rows = person.rows.iter().filter(|row| is_here(**row));
        let values: Vec<f64> = rows.filter_map(|row| columns.values[*row]).collect();
        let scores = groups.entry(&person.groups).or_default();
        scores.extend(mean(&values));
    }
    groups.into_values().collect()
}

/// The ends of the interval within people of one cell of all factors.
fn within(
    people: &[&Complete],
    columns: &DesignColumns<'_>,
    factors: &[&TestedFactor],
    levels: &[String],
) -> Option<(f64, f64)> {
    let values: Vec<Vec<f64>> = people
        .iter()
        .map(|p| p.rows.iter().map(|row| columns.values[*row]).collect())
        .collect::<Option<_>>()?;
    let is_cell = |row: &usize| {
        columns.within.iter().all(|(name, cells)| {
            let mut wanted = factors.iter().zip(levels);
            wanted.any(|(factor, level)| factor.name == *name && cells[*row] == *level)
        })
    };
    let place = people.first()?.rows.iter().position(is_cell)?;
    let [_, low, high] = within_subject_intervals(&values)?[place];
    Some((low, high))
}

/// Refuses a declared contrast of a factor that no test has, or of a level that nobody who is tested has.
pub(crate) fn check(data: &StudyData) -> Result<(), AnalysisError> {
    let design = &data.design;
    let conditions: Vec<_> = design.condition_ids().collect();
    let within = factors_within(design, &conditions);
    let between = design.factors().iter().map(|f| f.name.as_str());
    let tested: Vec<&str> = between.chain(within.iter().map(|(n, _)| n.as_str())).collect();
    for declared in design.level_contrasts() {
        if tested.len() < 2 {
            return Err(AnalysisError::OneFactor { factor: tested.concat() });
        }
        for (factor, levels) in declared {
            let unknown = |level: &str, known: Vec<String>| AnalysisError::UnknownLevel {
                factor: factor.clone(),
                found: level.to_owned(),
                known,
            };
            if !tested.contains(&factor.as_str()) {
                return Err(AnalysisError::UntestedFactor {
                    factor: factor.clone(),
                    known: tested.iter().map(|name| (*name).to_owned()).collect(),
                });
            }
            let of_people = || {
                let people = data.participants.iter();
                let levels = people.filter_map(|p| data.column(p, factor).map(str::to_owned));
                levels.collect::<BTreeSet<String>>()
            };
            let known: BTreeSet<String> = match within.iter().find(|(name, _)| name == factor) {
                Some((_, levels)) => levels.iter().cloned().collect(),
                None => of_people(),
            };
            if let Some(level) = levels.named().iter().find(|level| !known.contains(*level)) {
                return Err(unknown(level, known.into_iter().collect()));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::{
        AnalysisError, Purpose, StudyData, analyse,
        testing::{CONDITIONS, SPEED, design, near, panel, plain, tables},
    };
    use maveric_stats::{DesignColumns, LevelChoice, groups};

    const LEVELS: [(&str, &str); 4] =
        [("slow", "town"), ("slow", "land"), ("fast", "town"), ("fast", "land")];

    /// Our four conditions as two factors, with these contrasts.
    fn crossed(contrasts: &str) -> String {
        let conditions = CONDITIONS.iter().zip(LEVELS).map(|(id, (pace, road))| {
            format!("[[condition]]\nid = \"{id}\"\nlevels = {{ pace = \"{pace}\", road = \"{road}\" }}\n")
        });
        format!(
            "[study]\ntitle = \"t\"\n[baseline]\nid = \"own\"\n{}[[outcome]]\nmeasure = \"{SPEED}\"\n\
             [contrasts]\nfactors = [{contrasts}]\n",
            conditions.collect::<String>()
        )
    }

    #[test]
    fn means_and_contrasts_are_those_of_each_persons_values() {
        let text = crossed(
            "{ pace = [\"fast\", \"slow\"], road = [\"town\", \"land\"] }, { pace = [\"slow\", \"fast\"] }",
        );
        let data = StudyData::new(&design(&text), tables()).unwrap();
        let a = analyse(&data, Purpose::Report).unwrap();
        let panel = panel(&a, SPEED);
        let found = panel.by_factor.as_ref().unwrap();
        let score = |weights: [f64; 4]| -> Vec<f64> {
            let row =
                |row: &Vec<Option<f64>>| row.iter().zip(weights).map(|(v, w)| w * v.unwrap()).sum();
            panel.rows.iter().map(row).collect()
        };
        let by_hand = |scores: &[f64]| {
            let n = scores.len() as f64;
            let mean = scores.iter().sum::<f64>() / n;
            let square: f64 = scores.iter().map(|s| (s - mean).powi(2)).sum();
            (mean, mean / (square / (n - 1.0) / n).sqrt())
        };
        for (contrast, weights) in
            found.contrasts.iter().zip([[-1.0, 1.0, 1.0, -1.0], [0.5, 0.5, -0.5, -0.5]])
        {
            let (mean, t) = by_hand(&score(weights));
            near(Some(contrast.test.estimate), mean);
            // Where ranks decided there is no t.
            if contrast.test.df.is_some() {
                near(contrast.test.statistic, t);
            }
        }
        assert_eq!(
            found.contrasts[1].levels.get("pace"),
            Some(&LevelChoice::Pair(["slow", "fast"].map(str::to_owned)))
        );
        let p = found.contrasts.iter().map(|c| c.test.p.unwrap());
        let least = p.clone().fold(1.0, f64::min);
        let holm = found.contrasts.iter().filter_map(|c| c.p_holm).fold(1.0, f64::min);
        near(Some(holm), (2.0 * least).min(1.0));
        let slow = found.means.iter().find(|m| m.levels == ["slow"]).unwrap();
        let scores = score([0.5, 0.5, 0.0, 0.0]);
        near(Some(slow.mean), by_hand(&scores).0);
        let [_, low, high] = maveric_stats::mean_interval(&scores, 0.95).unwrap();
        near(slow.interval.map(|ends| ends.0), low);
        near(slow.interval.map(|ends| ends.1), high);
        let cell = found.means.iter().find(|m| m.levels == ["fast", "land"]).unwrap();
        near(Some(cell.mean), by_hand(&score([0.0, 0.0, 0.0, 1.0])).0);
        assert!(cell.within.is_some() && slow.within.is_none());
        // A rehearsal does without.
        let quick = analyse(&data, Purpose::Simulation).unwrap();
        assert!(quick.panels.iter().all(|p| p.by_factor.is_none()));
    }

    #[test]
    fn a_group_in_which_nobody_differs_has_no_interval() {
        let cities = ["A", "A", "B", "B"].map(str::to_owned);
        let values = [2.0, 2.0, 1.0, 3.0].map(Some);
        let cells = cities.clone().map(Some);
        let columns = DesignColumns {
            between: vec![("city", &cells[..])],
            values: &values,
            ..DesignColumns::default()
        };
        let comparison = groups(&cities, &values).unwrap();
        let means = super::of_groups(&columns, &comparison).unwrap().means;
        let intervals = [0, 1].map(|i: usize| means[i].interval);
        assert!(intervals[0].is_none());
        assert!(intervals[1].is_some_and(|(low, high)| low < 2.0 && 2.0 < high));
    }

    #[test]
    fn a_mixed_model_says_that_it_gives_no_contrasts_of_levels() {
        let text = crossed("{ pace = [\"slow\", \"fast\"] }");
        let said = |text: &str| {
            let data = StudyData::new(&design(text), tables()).unwrap();
            let a = analyse(&data, Purpose::Report).unwrap();
            let panel = panel(&a, SPEED);
            let why = |reason: &String| reason.contains("a mixed model gives none");
            (panel.by_factor.is_some(), panel.reasons.iter().any(why))
        };
        assert_eq!(said(&text), (true, false));
        let declared = text.replace("[contrasts]", "test = \"mixed\"\n[contrasts]");
        assert_eq!(said(&declared), (false, true));
    }

    #[test]
    fn a_contrast_that_no_test_can_have_is_refused_before_anything_is_tested() {
        let refused = |text: &str| {
            let data = StudyData::new(&design(text), tables()).unwrap();
            analyse(&data, Purpose::Report).unwrap_err()
        };
        let one = plain(
            &["fast", "slow"],
            "[contrasts]\nfactors = [{ condition = [\"fast\", \"slow\"] }]\n",
        );
        assert!(
            matches!(refused(&one), AnalysisError::OneFactor { factor } if factor == "condition")
        );
        // A cell is missing, so that the conditions are tested in one row: nobody has a road.
        let text = crossed("{ road = [\"town\", \"land\"] }");
        let at = text.find("[[condition]]\nid = \"across\"").unwrap();
        let end = text.find("[[outcome]]").unwrap();
        let short = format!("{}[[factor]]\ncolumn = \"group\"\n{}", &text[..at], &text[end..]);
        let refused = refused(&short);
        assert!(
            matches!(&refused, AnalysisError::UntestedFactor { known, .. } if known == &["group", "condition"])
        );
        assert!(refused.to_string().contains("names `road`"), "{refused}");
        assert!(refused.suggestion().is_some());
    }
}
