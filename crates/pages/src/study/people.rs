//! The setting and the people.

use super::{StudyPage, titled};
use maveric_analysis::{ConsentVersion, FEWEST_AGREED, LeftOutFor};
use maveric_domain::Design;
use maveric_report::{
    ReportError,
    figures::{
        domain,
        flow::{Flow, flow},
        simulator_view::{SimulatorView, simulator_view},
    },
    html::Section,
    tables::Table,
};
use minijinja::context;
use serde::Serialize;
use std::collections::BTreeMap;

/// How well the items of a score agree.
#[derive(Debug, Clone, Serialize)]
pub struct Reliability {
    /// `SCALE.SUBSCALE`, to find it by.
    pub id: String,
    /// What the page calls it.
    pub title: String,
    /// How many items the score is made of.
    pub items: usize,
    /// Answer sheets without a missing item.
    pub n: usize,
    pub alpha: Option<f64>,
    /// Lower end of its 95 % interval.
    pub ci_low: Option<f64>,
    pub ci_high: Option<f64>,
    pub omega: Option<f64>,
}

/// The people of one part in the study, of one population or of all.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParticipantGroup {
    /// Such as `Tested, internal`.
    pub group: String,
    pub n: usize,
    /// Drives that were recorded: by hand, or of a car of the study’s own.
    pub drives: usize,
    /// Drives of the car that are analysed.
    pub driven: usize,
    pub mean_age: Option<f64>,
    /// Standard deviation of the age.
    pub sd_age: Option<f64>,
    /// Share who are female, 0 to 1, of all who gave a gender; none where no word for it is known.
    pub female: Option<f64>,
    /// Words that are neither female nor male, with how many gave them.
    pub other_genders: Vec<(String, usize)>,
    /// Mean score of what the dial turns, in points.
    pub mean_score: Option<f64>,
    pub sd_score: Option<f64>,
}

impl StudyPage<'_> {
    /// Who took part in what; `model` says whether there is one, `view` is the scene of a drive.
    ///
    /// # Errors
    /// [`ReportError`] for a figure that cannot be drawn, or a text that asks for a value which is not given.
    pub fn setting(
        &self,
        model: bool,
        view: Option<&SimulatorView>,
        groups: &[ParticipantGroup],
        reliabilities: &[Reliability],
    ) -> Result<Section, ReportError> {
        let mut figures = vec![flow(&self.flow(), self.context)?];
        if model {
            figures.push(domain(self.context)?);
        }
        if let Some(view) = view {
            figures.push(simulator_view(view, self.context)?);
        }
        let mut tables = vec![self.participants(groups)?];
        tables.extend(self.consents()?);
        tables.extend(self.texts.table_if_any("reliabilities", reliabilities)?);
        let texts = self.texts.with(&context! { done => self.done()? });
        texts.section("study", figures, tables)
    }

    fn participants(&self, groups: &[ParticipantGroup]) -> Result<Table, ReportError> {
        let mut others = BTreeMap::new();
        for (word, n) in groups.iter().flat_map(|group| &group.other_genders) {
            *others.entry(word.as_str()).or_insert(0) += n;
        }
        let dial = self.design.style().map(|style| style.label.as_str());
        let texts =
            self.texts.with(&context! { others, dial, synthetic => self.analysis.synthetic });
        texts.table("participants", groups)
    }

    /// Who agreed to which version of the consent, and how many did not; none where nobody was asked.
    fn consents(&self) -> Result<Option<Table>, ReportError> {
        let versions = &self.analysis.flow.consents;
        if versions.is_empty() {
            return Ok(None);
        }
        let lends = versions.iter().any(|v| v.style_lent.is_some());
        let days = versions.iter().any(|v| v.first_day.is_some());
        let mut agreed = versions.iter().map(|v| v.agreed);
        let few = agreed.any(|n| (1..FEWEST_AGREED).contains(&n));
        let texts = self.texts.with(&context! { lends, days, few, fewest => FEWEST_AGREED });
        texts.table("consents", versions).map(Some)
    }

    fn flow(&self) -> Flow {
        let flow = &self.analysis.flow;
        let rows =
            |left: &[LeftOutFor]| left.iter().map(|l| (l.why.clone(), l.who.len())).collect();
        let [absent, left_out] = who_left(flow);
        let panels = self.analysis.panels.iter();
        let held_back = flow.not_admitted.iter();
        Flow {
            not_admitted: held_back
                .map(|n| (format!("not fulfilled: {}", n.rule), n.people))
                .collect(),
            not_agreed: not_agreed(self.design, &flow.consents),
            recruited: flow.recruited,
            absent,
            drove: flow.drove,
            left_out,
            analysed: flow.analysed,
            drives_left_out: rows(&flow.drives),
            outcomes: panels.map(|p| (titled(p), p.n)).collect(),
        }
    }
}

/// Who did not take part, and who was left out of the others: reason and count. Whoever did not take part had left before the others, whatever
/// they are left out by.
fn who_left(flow: &maveric_analysis::Flow) -> [Vec<(String, usize)>; 2] {
    [true, false].map(|is_absent| {
        let counted = flow.left_out.iter().map(|row| {
            let who = row.who.iter();
            let counted = who.filter(|who| flow.absent.contains(who) == is_absent);
            (row.why.clone(), counted.count())
        });
        counted.filter(|(_, n)| *n > 0).collect()
    })
}

/// How many of those who were to be tested did not agree; not counted where people are learned from, too, whose refusals are among them.
fn not_agreed(design: &Design, consents: &[ConsentVersion]) -> usize {
    if design.people().learn.is_some() {
        return 0;
    }
    consents.iter().map(|v| v.not_agreed).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_analysis::Rule;

    #[test]
    fn who_did_not_take_part_is_told_apart() {
        let row = |rule: Rule, why: &str, who: &[&str]| LeftOutFor {
            rule,
            why: why.to_owned(),
            who: who.iter().map(|who| (*who).to_owned()).collect(),
        };
        let mut flow = maveric_analysis::Flow {
            recruited: 6,
            drove: 4,
            absent: vec!["P3".to_owned(), "P6".to_owned()],
            left_out: vec![
                row(Rule::People, "sick", &["P1", "P2"]),
                row(Rule::StraightLined, "one answer", &["P3"]),
                row(Rule::Absent, "no drive", &["P6"]),
            ],
            analysed: 2,
            ..maveric_analysis::Flow::default()
        };
        let counts = |rows: &[(&str, usize)]| -> Vec<(String, usize)> {
            rows.iter().map(|(why, n)| ((*why).to_owned(), *n)).collect()
        };
        let expected = [counts(&[("one answer", 1), ("no drive", 1)]), counts(&[("sick", 2)])];
        assert_eq!(who_left(&flow), expected);
        (flow.absent, flow.drove) = (Vec::new(), 6);
        assert!(who_left(&flow)[0].is_empty());
    }

    #[test]
    fn refusals_are_of_those_to_be_tested_where_nobody_else_was_asked() {
        let consents = [ConsentVersion {
            text_sha256: "0".to_owned(),
            first_day: None,
            last_day: None,
            agreed: 9,
            not_agreed: 2,
            style_lent: None,
        }];
        let of = |people: &str| {
            let text = format!("[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n{people}");
            not_agreed(&Design::from_toml(&text).unwrap(), &consents)
        };
        assert_eq!(of(""), 2);
        assert_eq!(of("[people]\nlearn = { part = \"learn\" }\n"), 0);
    }
}
