//! The setting and the people.

use super::{StudyPage, titled};
use maveric_analysis::{FEWEST_AGREED, LeftOutFor};
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
    /// Cronbach's alpha.
    pub alpha: Option<f64>,
    /// Lower end of its 95 % interval.
    pub ci_low: Option<f64>,
    /// Upper end.
    pub ci_high: Option<f64>,
    /// McDonald's omega.
    pub omega: Option<f64>,
}

/// The people of one part in the study, of one population or of all.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParticipantGroup {
    /// Such as `Tested, internal`.
    pub group: String,
    /// How many.
    pub n: usize,
    /// Drives that were recorded: by hand, or of a car of the study’s own.
    pub drives: usize,
    /// Drives of the car that are analysed.
    pub driven: usize,
    /// Mean age in years.
    pub mean_age: Option<f64>,
    /// Standard deviation of the age.
    pub sd_age: Option<f64>,
    /// Share who are female, 0 to 1, of all who gave a gender; none where no word for it is known.
    pub female: Option<f64>,
    /// Words that are neither female nor male, with how many gave them.
    pub other_genders: Vec<(String, usize)>,
    /// Mean score of what the dial turns, in points.
    pub mean_score: Option<f64>,
    /// Its standard deviation.
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
        let texts = self
            .texts
            .with(&context! { others, dial, synthetic => self.analysis.synthetic });
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
        let texts = self
            .texts
            .with(&context! { lends, days, few, fewest => FEWEST_AGREED });
        texts.table("consents", versions).map(Some)
    }

    fn flow(&self) -> Flow {
        let flow = &self.analysis.flow;
        let rows =
            |left: &[LeftOutFor]| left.iter().map(|l| (l.why.clone(), l.who.len())).collect();
        let panels = self.analysis.panels.iter();
        let held_back = flow.not_admitted.iter();
        Flow {
            not_admitted: held_back
                .map(|n| (format!("not fulfilled: {}", n.rule), n.people))
                .collect(),
            recruited: flow.recruited,
            drove: flow.drove,
            left_out: rows(&flow.left_out),
            analysed: flow.analysed,
            drives_left_out: rows(&flow.drives),
            outcomes: panels.map(|p| (titled(p), p.n)).collect(),
        }
    }
}
