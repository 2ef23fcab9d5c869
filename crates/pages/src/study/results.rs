//! The results as sentences, with every test; a number stands as the analysis gave it.

use super::{
    StudyPage,
    tested::{contrast, tested},
    titled,
};
use crate::{manuscript::Block, texts::value};
use maveric_analysis::{Described, Panel, Reproduction};
use maveric_report::{ReportError, apa, markup};
use maveric_stats::Adjustment;
use minijinja::{Value, context};

/// Paragraphs below a heading; neither without a paragraph.
fn headed(heading: String, paragraphs: Vec<String>) -> Vec<Block> {
    let heading = (!paragraphs.is_empty()).then_some(Block::Heading(2, heading));
    let paragraphs = paragraphs.into_iter().map(Block::Paragraph);
    heading.into_iter().chain(paragraphs).collect()
}

impl StudyPage<'_> {
    pub(super) fn results(&self) -> Result<Vec<Block>, ReportError> {
        let a = self.analysis;
        let mut blocks = vec![Block::Heading(1, self.results.text("heading")?)];
        blocks.extend(headed(
            self.results.text("primary_heading")?,
            self.each("primary", self.primary_rows().into_iter())?,
        ));
        let judged = a.hypotheses.iter().map(value);
        blocks.extend(headed(
            self.results.text("hypotheses")?,
            self.each("hypothesis", judged)?,
        ));
        for panel in &a.panels {
            blocks.extend(headed(
                markup::literal(&titled(panel)),
                self.outcome(panel)?,
            ));
        }
        if let Some(first) = a.reproduction.first() {
            let texts = self.results.with(&context! {
                own => first.condition.to_string(),
                rows => value(&a.reproduction),
            });
            let mut own = vec![texts.text("accuracy")?];
            let biased = a.reproduction.iter().filter(|r| r.bias.is_some());
            own.extend(self.each("equivalence", biased.map(biased_row))?);
            own.extend(self.each("nearer", a.nearer.iter().map(value))?);
            blocks.extend(headed(texts.text("own")?, own));
        }
        let lines = [&a.line, &a.line_without_adb].into_iter().flatten();
        let along = lines.flat_map(|line| {
            let rows = line.rows.iter();
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
        let mut paragraphs = Vec::new();
        let of = self.analysis.descriptives.iter();
        let described: Vec<&Described> = of.filter(|d| d.outcome == panel.outcome).collect();
        // What was measured is described over everybody.
        if panel.group.is_none() && !described.is_empty() {
            let values = context! { described => value(&described) };
            paragraphs.push(self.results.with(&values).text("described")?);
        }
        paragraphs.extend(self.each("tested", tested(self.design, panel).iter().map(value))?);
        if let Some(by_factor) = &panel.by_factor {
            let rows = by_factor.contrasts.iter();
            let rows = rows.map(|contrast| self.factor_contrast(panel, contrast));
            let all = self.each("factor_contrast", rows)?;
            if !all.is_empty() {
                paragraphs.push(
                    self.results
                        .with(&context! { all })
                        .text("factor_contrasts")?,
                );
            }
        }
        let pairs = panel.contrasts.iter().map(|pair| contrast(panel, pair));
        let all = self.each("contrast", pairs)?;
        if !all.is_empty() {
            paragraphs.push(self.results.with(&context! { all }).text("contrasts")?);
        }
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
            let all = self.each("pair", of_factor.iter().map(value))?;
            let values = context! { all, ..value(&of_factor[0]) };
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
fn biased_row(row: &Reproduction) -> Value {
    let test = row.bias.as_ref().and_then(|b| {
        let said = apa::t(b.t?, b.df as f64, b.p_holm?, Adjustment::Holm, None);
        Some(said.markup().to_owned())
    });
    context! { test, ..value(row) }
}
