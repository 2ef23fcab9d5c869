//! Who prefers what, and what goes with it.

use super::StudyPage;
use crate::texts::value;
use maveric_analysis::{CongruenceRow, HomophilyRow, MixedRow};
use maveric_report::{
    ReportError,
    figures::{
        family::{Family, FamilyPanel, family},
        preference::{Preferences, ScalePreference, preference},
    },
    html::Section,
    tables::Table,
};
use maveric_stats::{RatioTest, Region};
use minijinja::{Value, context};

/// A tested ratio as its columns show it: the ends are those of the region or of what it leaves out.
fn ratio(test: &RatioTest) -> Value {
    let (kind, ends) = match test.region {
        Some(Region::Between { low, high }) => (Some("between"), Some((low, high))),
        Some(Region::Outside { low, high }) => (Some("outside"), Some((low, high))),
        Some(Region::Everywhere) => (Some("everywhere"), None),
        None => (None, None),
    };
    let p = test.p_lower.zip(test.p_upper);
    let p = p.map(|(lower, upper)| lower.max(upper));
    context! { estimate => test.estimate, kind, ends => value(&ends), p }
}

/// Where a rating turns and how far that moves.
fn congruence_row(row: &CongruenceRow) -> Value {
    let model = row.model.as_ref();
    let curvature = model.and_then(|m| m.coef.get("moved^2"));
    let (turn, movement) = (
        model.map(|m| ratio(&m.turn)),
        model.map(|m| ratio(&m.movement)),
    );
    context! { curvature => value(&curvature), turn, movement, ..value(row) }
}

/// A row a number of the surface.
fn surface_rows(row: &CongruenceRow) -> Vec<Value> {
    let surface = row.model.iter().flat_map(|model| model.surface.iter());
    surface
        .map(|(name, effect)| {
            let rating = row.rating.to_string();
            context! { rating, title => row.title.as_str(), name, effect => value(effect) }
        })
        .collect()
}

impl StudyPage<'_> {
    /// `None` for a study that declared no family and in which nobody can prefer another style.
    ///
    /// # Errors
    /// [`ReportError`] for a figure that cannot be drawn, or a text that asks for a value which is not given.
    pub fn homophily(&self) -> Result<Option<Section>, ReportError> {
        let a = self.analysis;
        if a.congruence.is_empty()
            && a.homophily.is_empty()
            && a.preferences.is_empty()
            && a.similarity.is_empty()
        {
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
        let mut tables = self.congruence()?;
        tables.push(self.correlations()?);
        tables.extend(self.mixed()?);
        let texts = self.texts.with(&values);
        texts.section("homophily", figures, tables).map(Some)
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

    /// Where what is liked best lies, and the surface it is read from; nothing where no dial has three places.
    fn congruence(&self) -> Result<Vec<Table>, ReportError> {
        let rows = || self.analysis.congruence.iter().filter(|row| row.n > 0);
        if rows().next().is_none() {
            return Ok(Vec::new());
        }
        let mut table = self.texts.table("congruence", rows().map(congruence_row))?;
        for row in rows().filter(|row| row.why_not.is_some()) {
            let why = self.texts.with(row).text("mixed_without")?;
            table.notes.push(why);
        }
        let surface = rows().flat_map(surface_rows);
        let surface = self.texts.table("congruence-surface", surface)?;
        Ok(vec![table, surface])
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page_texts::{PageTexts, STUDY};
    use maveric_stats::{CongruenceData, congruence};

    /// Eight people in five cars, whose liking bends by so much.
    fn row(bend: f64) -> CongruenceRow {
        let rows = 0..40_usize;
        let person = |row: usize| row / 5;
        let moved = |row: usize| 7.5 * (row % 5) as f64 - 15.0;
        let side = |row: usize| if person(row) % 2 == 0 { 1.0 } else { -1.0 };
        let pattern = |row: usize| side(row) * [1.0, -1.0, 0.5, -0.5, 0.3][row % 5];
        let wobble = |row: usize| 0.01 * ((row * 7) % 11) as f64;
        let liking = |row: usize| Some(pattern(row) + wobble(row) - bend * moved(row).powi(2));
        let subjects: Vec<String> = rows.clone().map(|row| person(row).to_string()).collect();
        let model = congruence(
            &CongruenceData {
                subjects: &subjects,
                liking: &rows.clone().map(liking).collect::<Vec<_>>(),
                moved: &rows.clone().map(|row| Some(moved(row))).collect::<Vec<_>>(),
                own: &rows.map(|row| Some(person(row) as f64)).collect::<Vec<_>>(),
                beside: &[],
            },
            5.0,
        );
        CongruenceRow {
            rating: "jian_trust.overall".parse().unwrap(),
            title: "Trust".to_owned(),
            n: 8,
            places: 5,
            near_points: 5.0,
            middle: 30.0,
            period: false,
            model: Some(model.unwrap()),
            why_not: None,
        }
    }

    #[test]
    fn a_region_is_shown_with_its_ends_or_says_that_it_has_none() {
        let texts = PageTexts::new(STUDY, &context! { style => "ADB score" }).unwrap();
        let unfitted = CongruenceRow {
            model: None,
            why_not: Some("too few".to_owned()),
            ..row(0.05)
        };
        let rows = [row(0.05), row(0.0), unfitted];
        let table = texts
            .table("congruence", rows.iter().map(congruence_row))
            .unwrap();
        let shown = format!("{table:?}");
        for text in ["top", " to ", "anywhere", "±5 points", "5 places"] {
            assert!(shown.contains(text), "{text}: {shown}");
        }
        assert!(!shown.contains("the period"));
        let surface = rows.iter().flat_map(surface_rows);
        let surface = texts.table("congruence-surface", surface).unwrap();
        assert_eq!(surface.rows.len(), 18);
    }
}
