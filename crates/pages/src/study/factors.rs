//! What the factors of a design did: the interaction drawn, means of levels, simple effects, declared contrasts.

use super::{
    StudyPage,
    conditions::{amount, ends},
    titled,
};
use crate::words::{effect_title, in_unit_of, listed, with_unit};
use maveric_analysis::{ByFactor, FactorContrast, LevelMean, Panel, TestedFactor};
use maveric_report::{
    Figure, ReportError,
    figures::interaction::{Interaction, InteractionLine, InteractionPanel, interaction},
    tables::Table,
};
use maveric_stats::{
    ByDesign, ChosenTest, LevelChoice, SimpleTest,
    apa::{Statement, Statements},
};
use minijinja::{Value, context};

impl StudyPage<'_> {
    /// The panels that factors were tested of, several or one that divides people.
    fn factorial_panels(&self) -> impl Iterator<Item = (&Panel, &ByFactor)> {
        let panels = self.analysis.panels.iter();
        panels.filter_map(|panel| Some((panel, panel.by_factor.as_ref()?)))
    }

    /// The interaction of each outcome drawn; none where no design crosses factors.
    pub(super) fn interaction(&self) -> Result<Option<Figure>, ReportError> {
        let crossed = || self.factorial_panels().filter(|(_, b)| b.factors.len() > 1);
        let panels: Vec<InteractionPanel> = crossed()
            .flat_map(|(panel, by_factor)| self.interaction_panels(panel, by_factor))
            .collect();
        if panels.is_empty() {
            return Ok(None);
        }
        let means = || crossed().flat_map(|(_, b)| &b.means);
        let values = context! {
            within => means().any(|mean| mean.within.is_some()),
            between => crossed().any(|(_, b)| b.factors.iter().any(|f| !f.within)),
            lacking => self.without_factors(),
            covariates => self.design.covariates().len(),
        };
        let input =
            Interaction { panels, intervals: self.texts.with(&values).text("interaction")? };
        interaction(&input, self.context).map(Some)
    }

    /// Outcomes that factors are tested of by another test, which gives neither means nor contrasts of their levels: listed.
    fn without_factors(&self) -> String {
        let panels = self.analysis.panels.iter().filter(|p| p.group.is_none());
        let without = panels.filter(|p| p.comparison.is_some() && p.by_factor.is_none());
        let titles: Vec<String> = without.map(titled).collect();
        listed(&titles)
    }

    /// Pairs of groups of people, where these alone were compared and there are more than two of them.
    pub(super) fn group_pairs(&self, panel: &Panel) -> Option<Vec<Value>> {
        let comparison = panel.comparison.as_ref()?;
        let ByDesign::Groups(groups) = comparison else {
            return None;
        };
        let several = groups.found.several.as_ref()?;
        let dunn = groups.chosen == ChosenTest::KruskalWallis;
        let factor = &self.design.factors().first()?.name;
        let row = |(name, said): (String, Statement)| {
            let (first, second) = name.split_once('|')?;
            let (z, howell) = (several.dunn.get(&name), several.games_howell.get(&name));
            let label = |level: &str| self.design.level_label(factor, level);
            Some(context! {
                outcome => panel.outcome.as_str(),
                title => titled(panel),
                first,
                second,
                pair => format!("{} − {}", label(first), label(second)),
                sentence => said.markup(),
                test => if dunn { "z" } else { "t" },
                statistic => if dunn { z.and_then(|z| z.z) } else { howell.and_then(|t| t.t) },
                p => if dunn { z.and_then(|z| z.p_holm) } else { howell.and_then(|t| t.p) },
            })
        };
        let statements = comparison.statements().into_iter();
        Some(statements.filter_map(row).collect())
    }

    /// A panel of two factors; with further factors one for each combination of their levels.
    fn interaction_panels(&self, panel: &Panel, by_factor: &ByFactor) -> Vec<InteractionPanel> {
        let (x, line) = axes(&by_factor.factors);
        let others: Vec<usize> =
            (0..by_factor.factors.len()).filter(|f| *f != x && *f != line).collect();
        let whole = |mean: &&LevelMean| mean.levels.len() == by_factor.factors.len();
        let cells: Vec<&LevelMean> = by_factor.means.iter().filter(whole).collect();
        let mut splits: Vec<Vec<&str>> = Vec::new();
        for cell in &cells {
            let split: Vec<&str> = others.iter().map(|f| cell.levels[*f].as_str()).collect();
            if !splits.contains(&split) {
                splits.push(split);
            }
        }
        let label =
            |f: usize, level: &str| self.design.level_label(&by_factor.factors[f].name, level);
        let test = crate::words::omnibus(self.design, panel, true);
        let drawn = |split: Vec<&str>| {
            let is_here = |cell: &&&LevelMean| {
                let mut levels = others.iter().zip(&split);
                levels.all(|(f, level)| cell.levels[*f] == *level)
            };
            let shown_cells: Vec<&&LevelMean> = cells.iter().filter(is_here).collect();
            let mean = |first: &str, second: &str| {
                let cell = shown_cells
                    .iter()
                    .find(|c| c.levels[x] == first && c.levels[line] == second)?;
                // A mean without an interval is drawn without one.
                let ends = cell.within.or(cell.interval);
                let (low, high) = ends.unwrap_or((cell.mean, cell.mean));
                Some([cell.mean, low, high])
            };
            let along = &by_factor.factors[x].levels;
            let lines = by_factor.factors[line].levels.iter();
            let names = others.iter().zip(&split).map(|(f, level)| {
                let factor = self.design.factor_label(&by_factor.factors[*f].name);
                format!("{factor}: {}", label(*f, level))
            });
            let names: Vec<String> = std::iter::once(panel.title.clone()).chain(names).collect();
            InteractionPanel {
                title: names.join(", "),
                test: test.clone(),
                n: panel.n,
                axis: match (panel.differences_from, panel.unit.as_str()) {
                    (None, unit) => amount(panel, unit),
                    (Some(_), unit) => with_unit("Difference", unit),
                },
                factor: self.design.factor_label(&by_factor.factors[x].name),
                levels: along.iter().map(|level| label(x, level)).collect(),
                lines: lines
                    .map(|second| InteractionLine {
                        name: label(line, second),
                        means: along.iter().map(|first| mean(first, second)).collect(),
                    })
                    .collect(),
                range: ends(panel),
            }
        };
        splits.into_iter().map(drawn).collect()
    }

    /// Means of levels and of cells, simple effects and declared contrasts; a table without rows is left out.
    pub(super) fn factor_tables(&self) -> Result<Vec<Table>, ReportError> {
        let mut tables = Vec::new();
        let means = self.factorial_panels().flat_map(|(panel, by_factor)| {
            let most = by_factor.factors.len();
            let shown = move |mean: &&LevelMean| [1, most].contains(&mean.levels.len());
            let rows = by_factor.means.iter().filter(shown);
            rows.map(move |mean| self.mean(panel, by_factor, mean))
        });
        let contrasts = self.factorial_panels().flat_map(|(panel, by_factor)| {
            let rows = by_factor.contrasts.iter();
            rows.map(move |contrast| self.factor_contrast(panel, contrast))
        });
        let simple = self.factorial_panels().flat_map(|(panel, by_factor)| {
            let rows = by_factor.simple.iter();
            rows.map(move |effect| self.simple_effect(panel, effect))
        });
        let pairs = self.factorial_panels();
        let pairs = pairs.filter_map(|(panel, _)| self.group_pairs(panel));
        let values = context! { lacking => self.without_factors() };
        for (key, rows) in [
            ("level-means", means.collect::<Vec<_>>()),
            ("group-pairs", pairs.flatten().collect()),
            ("factor-contrasts", contrasts.collect()),
            ("simple-effects", simple.collect()),
        ] {
            tables.extend(self.texts.with(&values).table_if_any(key, rows)?);
        }
        Ok(tables)
    }

    fn mean(&self, panel: &Panel, by_factor: &ByFactor, mean: &LevelMean) -> Value {
        let names: Vec<&str> = match mean.levels.len() {
            1 => vec![&mean.effect],
            _ => by_factor.factors.iter().map(|f| f.name.as_str()).collect(),
        };
        let levels = names.into_iter().zip(&mean.levels);
        let level: Vec<String> =
            levels.map(|(name, level)| self.design.level_label(name, level)).collect();
        // As the figure draws it: an interval may reach beyond the scale, and says nothing there.
        let scale = ends(panel);
        let cut = |end: f64| scale.map_or(end, |(low, high)| end.clamp(low, high));
        context! {
            outcome => panel.outcome.as_str(),
            title => titled(panel),
            unit => panel.unit.as_str(),
            effect => mean.effect.as_str(),
            factor => effect_title(self.design, &mean.effect),
            level_id => mean.levels.join(":"),
            level => level.join(", "),
            n => mean.n,
            mean => mean.mean,
            low => mean.interval.map(|i| cut(i.0)),
            high => mean.interval.map(|i| cut(i.1)),
            ..in_unit_of(self.analysis, &panel.outcome)
        }
    }

    fn simple_effect(&self, panel: &Panel, effect: &SimpleTest) -> Value {
        let design = self.design;
        let test = effect.test.as_ref();
        let sentence = effect.p_holm.and_then(|p| effect.statement(p));
        context! {
            outcome => panel.outcome.as_str(),
            title => titled(panel),
            factor => effect.factor.as_str(),
            at => effect.at.as_str(),
            level => effect.level.as_str(),
            effect => design.factor_label(&effect.factor),
            held => format!(
                "{}: {}",
                design.factor_label(&effect.at),
                design.level_label(&effect.at, &effect.level)
            ),
            n => effect.n,
            sentence => sentence.map(|s| s.markup().to_owned()),
            why_not => effect.why_not.as_deref(),
            method => test.map(|t| t.method.title()),
            statistic => test.and_then(|t| t.statistic),
            df1 => test.and_then(|t| t.df1),
            df2 => test.and_then(|t| t.df2),
            p => test.and_then(|t| t.p),
            p_holm => effect.p_holm,
        }
    }

    pub(super) fn factor_contrast(&self, panel: &Panel, contrast: &FactorContrast) -> Value {
        let parts = contrast.levels.iter().map(|(factor, choice)| match choice {
            LevelChoice::Pair([first, second]) => (format!("{factor}:{first}-{second}"), {
                let [first, second] = [first, second].map(|l| self.design.level_label(factor, l));
                format!("{}: {first} − {second}", self.design.factor_label(factor))
            }),
            LevelChoice::At(level) => (format!("{factor}:{level}"), {
                let level = self.design.level_label(factor, level);
                format!("at {}: {level}", self.design.factor_label(factor))
            }),
        });
        let (ids, words): (Vec<String>, Vec<String>) = parts.unzip();
        let test = &contrast.test;
        let sentence = contrast.p_holm.and_then(|p| test.statement(p));
        context! {
            outcome => panel.outcome.as_str(),
            title => titled(panel),
            unit => panel.unit.as_str(),
            contrast_id => ids.join("."),
            contrast => words.join(" × ").replace(" × at ", ", at "),
            sentence => sentence.map(|s| s.markup().to_owned()),
            n => test.n,
            method => test.method.title(),
            estimate => test.estimate,
            low => test.ci.low,
            high => test.ci.high,
            statistic => test.statistic,
            df1 => test.df,
            p => test.p,
            p_holm => contrast.p_holm,
            ..in_unit_of(self.analysis, &panel.outcome)
        }
    }
}

/// The factor along the axis, and that with a line a level: those within people first, the one with more levels along the axis.
fn axes(factors: &[TestedFactor]) -> (usize, usize) {
    let mut places: Vec<usize> = (0..factors.len()).collect();
    places.sort_by_key(|f| (!factors[*f].within, std::cmp::Reverse(factors[*f].levels.len())));
    (places[0], places[1])
}
