//! Who prefers what, and what goes with it.

use super::StudyPage;
use crate::texts::value;
use maveric_analysis::{HomophilyRow, MixedRow};
use maveric_report::{
    ReportError,
    figures::{
        family::{Family, FamilyPanel, family},
        preference::{Preferences, ScalePreference, preference},
    },
    html::Section,
    tables::Table,
};
use minijinja::{Value, context};

impl StudyPage<'_> {
    /// `None` for a study that declared no family and in which nobody can prefer another style.
    ///
    /// # Errors
    /// [`ReportError`] for a figure that cannot be drawn, or a text that asks for a value which is not given.
    pub fn homophily(&self) -> Result<Option<Section>, ReportError> {
        let a = self.analysis;
        if a.homophily.is_empty() && a.preferences.is_empty() && a.similarity.is_empty() {
            return Ok(None);
        }
        let below = |p: fn(&HomophilyRow) -> Option<f64>| {
            let low = |row: &&HomophilyRow| p(row).is_some_and(|p| p < 0.05);
            a.homophily.iter().filter(low).count()
        };
        let tested = a.homophily.iter().filter(|r| r.correlation.p.is_some());
        let values = context! {
            tested => tested.count(),
            low => below(|r| r.correlation.p),
            holm => below(|r| r.p_holm),
            bh => below(|r| r.p_bh),
            factors => self.design.homophily().map_or_else(String::new, |h| h.factors.join(", ")),
            claims => !self.ledger.is_empty(),
        };
        let mut figures = Vec::new();
        if let Some(bars) = self.preferred() {
            figures.push(preference(&bars, self.context)?);
        }
        if let Some(input) = self.forest(&values)? {
            figures.push(family(&input, self.context)?);
        }
        let tables = std::iter::once(self.correlations()?).chain(self.mixed()?);
        let texts = self.texts.with(&values);
        texts
            .section("homophily", figures, tables.collect())
            .map(Some)
    }

    /// The pairs of the family that the claims name or that are below .05 here, then similarity.
    fn correlations(&self) -> Result<Table, ReportError> {
        let mut rows: Vec<Value> = Vec::new();
        for row in &self.analysis.homophily {
            let key = format!("{}.r", row.key());
            let claimed = self.ledger.iter().any(|l| l.claim.key == key);
            if claimed || row.correlation.p.is_some_and(|p| p < 0.05) {
                rows.push(context! {
                    id => row.key(),
                    independent => row.title.as_str(),
                    dependent => self.texts.with(row).text("dependent")?,
                    here => value(&row.correlation),
                    repeated => (),
                    paper => self.printed(&key),
                });
            }
        }
        for row in &self.analysis.similarity {
            rows.push(context! {
                id => format!("similarity.{}", row.rating),
                independent => self.texts.text("similarity")?,
                dependent => row.title.as_str(),
                here => value(&row.pooled),
                repeated => value(&row.within),
                paper => self.printed(&format!("similarity.{}.r", row.rating)),
            });
        }
        self.texts.table("correlations", rows)
    }

    /// Who rated another style above their own; `None` where nobody could.
    fn preferred(&self) -> Option<Preferences> {
        let rated = self.analysis.preferences.iter().filter(|p| p.n > 0);
        let first = rated.clone().next()?;
        Some(Preferences {
            own: first.own,
            others: first.others.iter().map(|o| o.condition).collect(),
            scales: rated
                .map(|p| ScalePreference {
                    scale: p.title.clone(),
                    n: p.n,
                    less_is_better: p.less_is_better,
                    above: p.others.iter().map(|o| o.above).collect(),
                })
                .collect(),
        })
    }

    /// Ratings on the shift of the dial: what the four answers of a person say together; `None` where it was not fitted.
    fn mixed(&self) -> Result<Option<Table>, ReportError> {
        let fitted = &self.analysis.mixed;
        if fitted.is_empty() {
            return Ok(None);
        }
        let row = |row: &MixedRow| {
            let fixed = |name| row.model.as_ref().and_then(|m| m.fixed.get(name));
            let sd = row.model.as_ref().and_then(|m| m.random_sd.get("shift"));
            let (shift, squared) = (fixed("shift"), fixed("shift_squared"));
            context! { shift => value(&shift), squared => value(&squared), sd => sd.copied(), ..value(row) }
        };
        let mut table = self.texts.table("mixed", fitted.iter().map(row))?;
        for row in fitted.iter().filter(|row| row.why_not.is_some()) {
            table
                .notes
                .push(self.texts.with(row).text("mixed_without")?);
        }
        Ok(Some(table))
    }

    /// The declared family as a forest; `None` where there is none.
    fn forest(&self, values: &Value) -> Result<Option<Family>, ReportError> {
        let rows = &self.analysis.homophily;
        let Some(first) = rows.first() else {
            return Ok(None);
        };
        let mut factors: Vec<&HomophilyRow> = Vec::new();
        let mut ratings: Vec<&HomophilyRow> = Vec::new();
        let mut series = Vec::new();
        for row in rows {
            if !factors.iter().any(|f| f.factor == row.factor) {
                factors.push(row);
            }
            if !ratings.iter().any(|r| r.rating == row.rating) {
                ratings.push(row);
            }
            if !series.contains(&row.versus) {
                series.push(row.versus);
            }
        }
        let cell = |factor: &HomophilyRow, rating: &HomophilyRow, versus| {
            let fits = |r: &&HomophilyRow| {
                r.factor == factor.factor && r.rating == rating.rating && r.versus == versus
            };
            let row = rows.iter().find(fits)?;
            let (low, high) = row.simultaneous?;
            Some([row.correlation.r?, low, high])
        };
        let panel = |rating: &&HomophilyRow| FamilyPanel {
            title: rating.rating_title.clone(),
            cells: factors
                .iter()
                .map(|f| series.iter().map(|v| cell(f, rating, *v)).collect())
                .collect(),
        };
        let texts = self.texts.with(values).with(first);
        Ok(Some(Family {
            rows: factors.iter().map(|f| f.title.clone()).collect(),
            panels: ratings.iter().map(panel).collect(),
            what: texts.text("family")?,
            participants: self.analysis.participants,
            series,
        }))
    }
}
