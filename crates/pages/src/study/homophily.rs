//! Who prefers what, and what goes with it.

use super::StudyPage;
use crate::{texts::value, words};
use maveric_analysis::{CongruenceCurve, CongruenceRow, HomophilyRow, MixedRow};
use maveric_domain::design::Quantity;
use maveric_report::{
    Figure, ReportError,
    figures::{
        congruence::{Congruence, CongruenceLine, CongruencePanel, congruence},
        family::{Family, FamilyPanel, family},
        preference::{Preferences, ScalePreference, preference},
    },
    html::Section,
    tables::Table,
};
use maveric_stats::{Bend, RatioTest, Region};
use minijinja::{Value, context};

const STEPS: u32 = 40;

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
    let (turn, movement) = (model.map(|m| ratio(&m.turn)), model.map(|m| ratio(&m.movement)));
    context! { curvature => value(&curvature), turn, movement, ..value(row) }
}

/// A curve as it is drawn: over what its people met, with what they like best, if they met that.
fn curve(row: &CongruenceRow, curve: &CongruenceCurve) -> CongruenceLine {
    let (low, high) = curve.met;
    let [level, slope, bend] = curve.rating;
    let rated = |moved: f64| level + moved * (slope + bend * moved);
    let point = |moved: f64| (curve.own + moved, rated(moved));
    let step = (high - low) / f64::from(STEPS);
    let met = (0..=STEPS).map(|at| low + f64::from(at) * step);
    let is_top = row.model.as_ref().is_some_and(|m| m.bend == Bend::Top);
    let is_met = |moved: &f64| (low..=high).contains(moved);
    let best = Some(-slope / (2.0 * bend)).filter(|moved| is_top && is_met(moved));
    CongruenceLine {
        own: curve.own,
        points: if step > 0.0 { met.map(point).collect() } else { vec![point(low)] },
        at_own: Some(level).filter(|_| is_met(&0.0)),
        best: best.map(point),
    }
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
        let mut figures = self.surfaces()?;
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
        let mut counts = Vec::new();
        for row in &self.analysis.homophily {
            let key = format!("{}.r", row.key());
            let claimed = self.ledger.iter().any(|l| l.claim.key == key);
            if claimed || row.correlation.p.is_some_and(|p| p < 0.05) {
                counts.push(row.correlation.n);
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
        let people = words::counted(counts);
        let texts = self.texts.with(&context! { people });
        texts.table("correlations", rows)
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
        if !rows().any(CongruenceRow::is_judged) {
            return Ok(Vec::new());
        }
        let mut table = self.texts.table("congruence", rows().map(congruence_row))?;
        for row in rows().filter(|row| row.why_not.is_some()) {
            let why = self.texts.with(row).text("congruence_without")?;
            table.notes.push(why);
        }
        let surface = rows().flat_map(surface_rows);
        let surface = self.texts.table("congruence-surface", surface)?;
        Ok(vec![table, surface])
    }

    /// The same surface as curves, of primary outcomes first; nothing where it was not fitted.
    fn surfaces(&self) -> Result<Vec<Figure>, ReportError> {
        let is_drawn = |row: &&CongruenceRow| !row.curves.is_empty();
        let mut rows: Vec<&CongruenceRow> =
            self.analysis.congruence.iter().filter(is_drawn).collect();
        let Some(first) = rows.first() else {
            return Ok(Vec::new());
        };
        let places = first.places;
        rows.sort_by_key(|row| {
            let mut outcomes = self.design.outcomes().iter();
            let is_it = |q: &Quantity| matches!(q, Quantity::Score(name) if *name == row.rating);
            !outcomes.any(|outcome| outcome.primary.is_some() && is_it(&outcome.quantity))
        });
        let panels = rows.into_iter().map(|row| self.surface(row));
        let figure = Congruence {
            style: words::style(self.design).to_owned(),
            panels: panels.collect::<Result<_, _>>()?,
            places,
            part: None,
        };
        let parts = figure.parts();
        let drawn = parts.iter().map(|part| congruence(part, self.context));
        drawn.collect()
    }

    fn surface(&self, row: &CongruenceRow) -> Result<CongruencePanel, ReportError> {
        let curvature = row.model.as_ref().and_then(|m| m.coef.get("moved^2"));
        let better = if row.less_is_better { -1.0 } else { 1.0 };
        let texts = self.texts.with(&context! {
            less_is_better => row.less_is_better,
            estimate => curvature.map(|c| better * c.estimate),
            turned => curvature.map(|c| c.estimate),
            p => curvature.and_then(|c| c.p),
        });
        let drawn_curve = |sds: i8| {
            let mut curves = row.curves.iter();
            let theirs = curves.find(|curve| curve.sds == sds)?;
            Some(curve(row, theirs))
        };
        Ok(CongruencePanel {
            title: row.title.clone(),
            axis: texts.text("predicted")?,
            test: texts.text("curvature")?,
            n: row.n,
            period: row.period,
            curves: [-1, 0, 1].map(drawn_curve),
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
            table.notes.push(self.texts.with(row).text("mixed_without")?);
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
        let drawn = rows.iter().filter(|row| row.simultaneous.is_some());
        let texts = self.texts.with(values).with(first);
        Ok(Some(Family {
            rows: factors.iter().map(|f| f.title.clone()).collect(),
            panels: ratings.iter().map(panel).collect(),
            what: texts.text("family")?,
            n: drawn.map(|row| row.correlation.n).collect(),
            series,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page_texts::{PageTexts, STUDY};
    use maveric_analysis::PerceivedStyle;
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
            less_is_better: false,
            perceived: None,
            n: 8,
            places: 5,
            near_points: 5.0,
            middle: 30.0,
            period: false,
            model: Some(model.unwrap()),
            curves: Vec::new(),
            why_not: None,
        }
    }

    #[test]
    fn a_region_is_shown_with_its_ends_or_says_that_it_has_none() {
        let texts = PageTexts::new(STUDY, &context! { style => "ADB score", digits => 0 }).unwrap();
        let unfitted =
            CongruenceRow { model: None, why_not: Some("too few".to_owned()), ..row(0.05) };
        let rows = [row(0.05), row(0.0), unfitted];
        let table = texts.table("congruence", rows.iter().map(congruence_row)).unwrap();
        let shown = format!("{table:?}");
        for text in ["top", " to ", "anywhere", "±5 points", "5 places"] {
            assert!(shown.contains(text), "{text}: {shown}");
        }
        assert!(!shown.contains("the period") && !shown.contains("perceived"));
        let surface = rows.iter().flat_map(surface_rows);
        let surface = texts.table("congruence-surface", surface).unwrap();
        assert_eq!(surface.rows.len(), 18);
    }

    #[test]
    fn what_was_perceived_stands_below_with_its_own_bounds_and_how_it_was_asked() {
        let texts = PageTexts::new(STUDY, &context! { style => "ADB score", digits => 0 }).unwrap();
        let shown = |same| {
            let perceived = CongruenceRow {
                perceived: Some(PerceivedStyle {
                    score: "aggressiveness.aggressiveness".parse().unwrap(),
                    title: "Perceived aggressiveness".to_owned(),
                    same,
                }),
                near_points: 0.75,
                ..row(0.05)
            };
            let rows = [row(0.05), perceived];
            let table = texts.table("congruence", rows.iter().map(congruence_row));
            format!("{:?}", table.unwrap())
        };
        for (same, said) in [(Some(4.0), "counted from 4 (“as I do”)"), (None, "of themselves")]
        {
            let shown = shown(same);
            for text in ["perceived", "driven", "Perceived aggressiveness", "±0.75", said] {
                assert!(shown.contains(text), "{text}: {shown}");
            }
        }
    }

    #[test]
    fn a_curve_is_drawn_over_what_was_met_and_its_best_place_only_there() {
        let theirs = |met: (f64, f64), rating: [f64; 3]| CongruenceCurve {
            sds: 0,
            own: 30.0,
            n: 3,
            met,
            rating,
        };
        // 5 - 0.01 (δ - 2)².
        let near = [4.96, 0.04, -0.01];
        let drawn = curve(&row(0.05), &theirs((-15.0, 15.0), near));
        let ends = (drawn.points[0], drawn.points[drawn.points.len() - 1]);
        let is = |(x, y): (f64, f64), expected: (f64, f64)| {
            assert!((x - expected.0).abs() < 1e-9 && (y - expected.1).abs() < 1e-9);
        };
        is(ends.0, (15.0, 5.0 - 0.01 * 289.0));
        is(ends.1, (45.0, 5.0 - 0.01 * 169.0));
        is(drawn.best.unwrap(), (32.0, 5.0));
        assert_eq!(drawn.at_own, Some(4.96));
        // Who met only faster cars: nothing is said of the own style, nor of what lies between.
        let faster = curve(&row(0.05), &theirs((5.0, 15.0), near));
        assert_eq!((faster.at_own, faster.best), (None, None));
        let alone = curve(&row(0.05), &theirs((5.0, 5.0), near));
        assert_eq!(alone.points.len(), 1);
        // Where the rating is worst is no best place.
        let worst = curve(&row(-0.05), &theirs((-15.0, 15.0), [4.96, -0.04, 0.01]));
        assert_eq!(worst.best, None);
    }
}
