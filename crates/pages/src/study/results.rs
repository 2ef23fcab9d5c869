//! The results as sentences, with every test; a number stands as the analysis gave it.

use super::{
    StudyPage,
    tested::{contrast, tested},
    titled,
};
use crate::{manuscript::Block, page_texts::PageTexts, texts::value, words::in_unit_of};
use maveric_analysis::{Analysis, Described, Panel, Presses, Reproduction};
use maveric_report::{ReportError, apa, markup};
use maveric_stats::Adjustment;
use minijinja::{Value, context};

/// Paragraphs below a heading; neither without a paragraph.
fn headed(heading: String, paragraphs: Vec<String>) -> Vec<Block> {
    let heading = (!paragraphs.is_empty()).then_some(Block::Heading(2, heading));
    let paragraphs = paragraphs.into_iter().map(Block::Paragraph);
    heading.into_iter().chain(paragraphs).collect()
}

/// What people pressed: whether the rates differ, and what came before a press.
fn pressed(texts: &PageTexts, presses: &Presses) -> Result<Vec<String>, ReportError> {
    let mut sentences = Vec::new();
    if let Some(rates) = &presses.rates {
        sentences.push(texts.with(rates).text("press_rates")?);
    }
    for row in &presses.before {
        let values = context! {
            title => row.title.as_str(), p_holm => row.p_holm, ..value(&row.test)
        };
        sentences.push(texts.with(&values).text("press_before")?);
    }
    Ok(sentences)
}

impl StudyPage<'_> {
    pub(super) fn results(&self) -> Result<Vec<Block>, ReportError> {
        let a = self.analysis;
        let mut blocks = vec![Block::Heading(1, self.results.text("heading")?)];
        if a.synthetic {
            blocks.push(Block::Paragraph(self.results.text("synthetic")?));
        }
        blocks.extend(headed(
            self.results.text("primary_heading")?,
            self.each("primary", self.primary_rows().into_iter())?,
        ));
        let judged = a.hypotheses.iter();
        let judged = judged.map(|h| context! { ..in_unit_of(a, &h.outcome), ..value(h) });
        blocks.extend(headed(self.results.text("hypotheses")?, self.each("hypothesis", judged)?));
        for panel in &a.panels {
            blocks.extend(headed(markup::literal(&titled(panel)), self.outcome(panel)?));
        }
        let reproduced = || a.reproduction.iter().filter(|r| r.n > 0);
        if let Some(first) = reproduced().next() {
            let texts = self.results.with(&context! {
                own => first.condition.to_string(),
                rows => value(&reproduced().collect::<Vec<_>>()),
            });
            let mut accuracy = vec![texts.text("accuracy")?];
            let biased = reproduced().filter(|r| r.bias.is_some());
            let biased = biased.map(|r| biased_row(a, r));
            accuracy.extend(self.each("equivalence", biased)?);
            accuracy.extend(self.each("nearer", a.nearer.iter().map(value))?);
            blocks.extend(headed(texts.text("own")?, accuracy));
        }
        let lines = [&a.line, &a.line_without_adb].into_iter().flatten();
        let along = lines.flat_map(|line| {
            let rows = line.rows.iter().filter(|row| row.correlation.n > 0);
            rows.map(move |row| context! { adb_used => line.adb_used, ..value(row) })
        });
        let mut line = self.each("along", along)?;
        for kept in &a.kept {
            let angle = self.results.with(kept).text("angle")?;
            let values = context! { angle, ..value(kept) };
            line.push(self.results.with(&values).text("kept")?);
        }
        blocks.extend(headed(
            self.results.text("carry_over_heading")?,
            self.each("carry_over", self.carry_over_rows().into_iter())?,
        ));
        blocks.extend(headed(self.results.text("line")?, line));
        blocks.extend(headed(self.results.text("people")?, self.preferences()?));
        blocks.extend(headed(
            self.results.text("retest_heading")?,
            self.each("retest", self.retested())?,
        ));
        if let Some(presses) = &a.presses {
            let pressed = pressed(&self.results, presses)?;
            blocks.extend(headed(self.results.text("presses")?, pressed));
        }
        Ok(blocks)
    }

    /// A sentence for each of these.
    fn each(
        &self,
        key: &str,
        rows: impl Iterator<Item = Value>,
    ) -> Result<Vec<String>, ReportError> {
        rows.map(|row| self.results.with(&row).text(key)).collect()
    }

    /// Descriptives, tests and contrasts of an outcome.
    fn outcome(&self, panel: &Panel) -> Result<Vec<String>, ReportError> {
        let together = |sentences: Vec<String>, key: &str| {
            let values = (!sentences.is_empty()).then(|| context! { all => sentences });
            values.map(|values| self.results.with(&values).text(key)).transpose()
        };
        let mut paragraphs = Vec::new();
        let descriptives = self.analysis.descriptives.iter();
        let described: Vec<&Described> =
            descriptives.filter(|d| d.outcome == panel.outcome && d.n > 0).collect();
        // What was measured is described over everybody.
        if panel.group.is_none() && !described.is_empty() {
            let numbers = in_unit_of(self.analysis, &panel.outcome);
            let values = context! { described => value(&described), ..numbers };
            paragraphs.push(self.results.with(&values).text("described")?);
        }
        paragraphs.extend(self.each("tested", tested(self.design, panel).iter().map(value))?);
        let sentences = self.each("group_pair", self.group_pairs(panel).into_iter().flatten())?;
        paragraphs.extend(together(sentences, "group_pairs")?);
        if let Some(by_factor) = &panel.by_factor {
            let rows = by_factor.contrasts.iter();
            let rows = rows.map(|contrast| self.factor_contrast(panel, contrast));
            let sentences = self.each("factor_contrast", rows)?;
            paragraphs.extend(together(sentences, "factor_contrasts")?);
        }
        // Of nobody with both values there is nothing to tell.
        let pairs = panel.contrasts.iter();
        let pairs = pairs.filter(|pair| pair.mean_difference.is_some() || pair.p.is_some());
        let sentences =
            self.each("contrast", pairs.map(|pair| contrast(self.analysis, panel, pair)))?;
        paragraphs.extend(together(sentences, "contrasts")?);
        Ok(paragraphs)
    }

    fn preferences(&self) -> Result<Vec<String>, ReportError> {
        let a = self.analysis;
        let rated = a.preferences.iter().filter(|p| p.n > 0);
        let mut paragraphs = self.each("preferred", rated.map(value))?;
        if !a.homophily.is_empty() {
            let values = context! { rows => value(&a.homophily) };
            paragraphs.push(self.results.with(&values).text("family")?);
        }
        for of_factor in a.homophily.chunk_by(|a, b| a.factor == b.factor) {
            let sentences = self.each("pair", of_factor.iter().map(value))?;
            let values = context! { all => sentences, ..value(&of_factor[0]) };
            paragraphs.push(self.results.with(&values).text("factor")?);
        }
        paragraphs.extend(self.each("similar", a.similarity.iter().map(value))?);
        for row in &a.mixed {
            let fixed = |name| row.model.as_ref().and_then(|m| m.fixed.get(name));
            if let (Some(shift), Some(squared)) = (fixed("shift"), fixed("shift_squared")) {
                let values =
                    context! { shift => value(shift), squared => value(squared), ..value(row) };
                paragraphs.push(self.results.with(&values).text("mixed")?);
            }
        }
        Ok(paragraphs)
    }
}

/// How far the car lies from the person, with its test against no difference.
fn biased_row(analysis: &Analysis, row: &Reproduction) -> Value {
    let test = row.bias.as_ref().and_then(|b| {
        let statement = apa::t(b.t?, b.df as f64, b.p_holm?, Adjustment::Holm, None);
        Some(statement.markup().to_owned())
    });
    context! { test, ..context! { ..in_unit_of(analysis, &row.measure), ..value(row) } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page_texts::RESULTS;
    use maveric_analysis::BeforePress;
    use maveric_domain::Design;
    use maveric_stats::{CaseStratum, Exposed, case_crossover, event_rates};

    #[test]
    fn pairs_of_groups_are_told_by_their_labels() {
        let texts = PageTexts::new(RESULTS, &context! {}).unwrap();
        let values = context! { pair => "in*town − rural", sentence => "*z* = 2.41" };
        let pair = texts.with(&values).text("group_pair").unwrap();
        assert_eq!(markup::plain(&pair), "in*town − rural, z = 2.41");
        let all = texts.with(&context! { all => vec![pair.clone(), pair] });
        let all = all.text("group_pairs").unwrap();
        assert!(all.starts_with("Pairs of groups: ") && all.contains("; "), "{all}");
    }

    #[test]
    fn a_hypothesis_stands_with_the_p_that_made_it_so() {
        let label = Value::from_function(|id: &str| id.to_owned());
        let texts = PageTexts::new(RESULTS, &context! { label }).unwrap();
        let said_of = |odds: Option<Value>, verdict: &str, bounds: Option<Vec<f64>>, holm: bool| {
            let values = context! {
                says => "So", verdict, bounds, holm, rule => "shown if it is", n => 24, first => "calm", second => "sporty",
                decimals => 2, measured_in => "",
                mean_difference => 2.0, interval => vec![1.5, 2.5], odds, p => 0.999, p_outside => 0.001,
                unbounded => false, why_not => None::<&str>,
            };
            texts.with(&values).text("hypothesis").unwrap()
        };
        let said = |verdict: &str, bounds, holm| said_of(None, verdict, bounds, holm);
        let bounds = || Some(vec![-1.0, 1.0]);
        let fails = said("fails", bounds(), false);
        assert!(
            fails.starts_with("“So”: fails (shown if it is). ")
                && fails.ends_with("lies outside: *p* = .001."),
            "{fails}"
        );
        let open = said("not_shown", bounds(), false);
        assert!(open.ends_with("the larger *p* = .999."), "{open}");
        assert!(said("fails", None, true).ends_with(", *p*_{Holm} = .999."));
        assert!(said("shown", None, false).ends_with(", *p* = .999."));
        // Of ordered answers p is of the odds, which stand in the place of an interval of the difference.
        let odds = context! { ratio => 3.0, interval => vec![2.0, 4.5] };
        let ordered = said_of(Some(odds), "shown", None, false);
        assert!(ordered.contains("*M* = 2.00, odds ratio 3.00, 95% CI"), "{ordered}");
        assert!(!ordered.contains("2.50"), "{ordered}");
    }

    #[test]
    fn who_rated_another_style_better_is_told_as_that_whichever_way_the_rating_is_keyed() {
        let label = Value::from_function(|id: &str| id.to_owned());
        let texts = PageTexts::new(RESULTS, &context! { label }).unwrap();
        let said = |title: &str, less_is_better: bool| {
            let other = |condition: &str, above: usize, not_below: usize| context! { condition, above, not_below };
            let others = vec![other("fast", 3, 4), other("slow", 7, 7)];
            let values = context! { title, less_is_better, own => "mimic", n => 24, others };
            texts.with(&values).text("preferred").unwrap()
        };
        assert_eq!(
            said("Discomfort", true),
            "Discomfort (less is better): fast rated better than mimic by 3 of 24 (and as good by 1); slow rated better than mimic by 7 of 24."
        );
        assert!(said("Trust", false).starts_with("Trust: fast rated better than mimic by 3 of 24"));
    }

    #[test]
    fn what_was_pressed_stands_in_the_results_with_its_tests_and_what_was_not_tested_does_not() {
        let design = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"\nlabel = \"Sporty *car*\"";
        let design = Design::from_toml(design).unwrap();
        let texts = PageTexts::new(RESULTS, &context! {}).unwrap();
        let texts = texts.labelled(&design);
        let ridden = |events| Exposed { events, time: 10.0 };
        let rows: Vec<Vec<Exposed>> = (0..12).map(|i| vec![ridden(1), ridden(4 + i % 3)]).collect();
        let names = ["calm".to_owned(), "sporty".to_owned()];
        let strata: Vec<CaseStratum> = (0..12)
            .map(|i| CaseStratum {
                person: format!("P{i}"),
                events: vec![2.0 + f64::from(i % 4)],
                others: vec![1.0, 2.0, f64::from(i % 3)],
            })
            .collect();
        let presses = Presses {
            rates: Some(event_rates(&names, &rows, 999, 1).unwrap()),
            incomplete: Vec::new(),
            people: 12,
            presses: 12,
            before: vec![BeforePress {
                precursor: "braking_mps2".to_owned(),
                title: "Strongest braking".to_owned(),
                unit: "m/s²".to_owned(),
                test: case_crossover(&strata),
                p_holm: Some(0.02),
                missing: 0,
            }],
            course: Vec::new(),
        };
        let said = pressed(&texts, &presses).unwrap();
        assert_eq!(said.len(), 2, "{said:?}");
        assert!(
            said[0].contains("calm 0.10; Sporty \\*car\\* 0.50") && said[0].contains("*n* = 12"),
            "{}",
            said[0]
        );
        assert!(
            said[1].starts_with("Strongest braking before a press")
                && said[1].contains("*OR* = ")
                && said[1].contains("12 people, 12 presses"),
            "{}",
            said[1]
        );
        let nothing = Presses { rates: None, before: Vec::new(), ..presses };
        assert!(pressed(&texts, &nothing).unwrap().is_empty());
    }
}
