//! What a paper about a study is written from: its methods, from the design and the results.

use super::{ParticipantGroup, Reliability, StudyPage, titled};
use crate::manuscript::{Block, Manuscript, Reference};
use maveric_analysis::Panel;
use maveric_domain::Scale;
use maveric_measures::objective;
use maveric_report::{Report, ReportError, html::RenderedFile};
use minijinja::context;
use std::collections::{BTreeMap, BTreeSet};

/// The headings that journals ask for, with the paragraphs of the methods that stand below them.
const HEADINGS: [(&str, &[&str]); 8] = [
    ("participants", &["Participants"]),
    ("exclusions", &[]),
    ("apparatus", &["Driving"]),
    ("styles", &["Learning", "Personalising"]),
    ("conditions", &["Conditions"]),
    ("measures", &[]),
    ("questionnaires", &[]),
    ("analysis", &["Tests", ""]),
];

/// Whether a score is of this questionnaire.
fn of_scale(reliability: &Reliability, scale: &Scale) -> bool {
    reliability.id.split('.').next() == Some(&*scale.id)
}

impl StudyPage<'_> {
    /// What a paper is written from: methods under the headings that journals ask for, results with every test, the numbers and tables of the
    /// page, and references; what the page's summary says of the declaration stands with the analysis.
    ///
    /// # Errors
    /// [`ReportError::Template`] for a text that asks for a value which is not given, or a document that cannot be packed.
    pub fn manuscript(
        &self,
        report: &Report,
        groups: &[ParticipantGroup],
        scales: &[Scale],
        reliabilities: &[Reliability],
    ) -> Result<Vec<RenderedFile>, ReportError> {
        let is_asked = |s: &&Scale| reliabilities.iter().any(|r| of_scale(r, s));
        let asked_scales: Vec<&Scale> = scales.iter().filter(is_asked).collect();
        let paragraphs = self.methods()?;
        let mut methods = vec![Block::Heading(1, self.methods.text("heading")?)];
        for (heading, abouts) in HEADINGS {
            let mut below: Vec<String> = match heading {
                "participants" => {
                    let groups = groups.iter().map(|g| self.methods.with(g).text("group"));
                    let groups = groups.collect::<Result<Vec<_>, _>>()?.join(" ");
                    let sentences = (!groups.is_empty()).then_some(groups);
                    [self.done()?].into_iter().chain(sentences).collect()
                }
                "exclusions" => self.left_out()?,
                "measures" => self.measures()?,
                "questionnaires" => {
                    let descriptions = asked_scales.iter().map(|scale| {
                        let mine = reliabilities.iter().filter(|r| of_scale(r, scale));
                        self.questionnaire(scale, mine)
                    });
                    descriptions.collect::<Result<_, _>>()?
                }
                _ => Vec::new(),
            };
            let matching = paragraphs.iter().filter(|(about, _)| abouts.contains(about));
            below.extend(matching.map(|(_, text)| text.clone()));
            match heading {
                "conditions" => below.extend(self.repeats()?.into_iter().flat_map(|s| s.intro)),
                "analysis" => below.extend(report.summary.iter().cloned()),
                _ => {}
            }
            if !below.is_empty() {
                let heading = self.methods.text(&format!("heading_{heading}"))?;
                methods.push(Block::Heading(2, heading));
                methods.extend(below.into_iter().map(Block::Paragraph));
            }
        }
        let of_scale = asked_scales.iter().map(|s| (s.id.clone(), s.reference.clone()));
        let of_tests = self.cited_tests()?;
        let manuscript = Manuscript {
            title: self.design.title().to_owned(),
            authors: self.design.authors().to_vec(),
            methods,
            results: self.results()?,
            references: of_scale
                .chain(of_tests)
                .map(|(key, text)| Reference { key, text })
                .collect(),
        };
        manuscript.files(report)
    }

    /// Who was left out of what, why and by which rule; people are counted.
    fn left_out(&self) -> Result<Vec<String>, ReportError> {
        let flow = &self.analysis.flow;
        let mut paragraphs = Vec::new();
        for (key, rows) in [
            ("excluded_people", &flow.left_out),
            ("excluded_learners", &flow.not_learned_from),
            ("excluded_drives", &flow.drives),
        ] {
            for row in rows {
                paragraphs.push(self.methods.with(row).text(key)?);
            }
        }
        for panel in &self.analysis.panels {
            if !panel.dropped.is_empty() {
                let values = context! {
                    title => titled(panel),
                    parts => self.not_in_tests(panel)?,
                    dropped => panel.dropped.len(),
                    n => panel.n,
                };
                paragraphs.push(self.methods.with(&values).text("incomplete")?);
            }
        }
        Ok(paragraphs)
    }

    /// How many are not in the tests of a panel, a part a reason.
    fn not_in_tests(&self, panel: &Panel) -> Result<Vec<String>, ReportError> {
        let mut columns: BTreeMap<&String, usize> = BTreeMap::new();
        for column in panel.without_column.values() {
            *columns.entry(column).or_default() += 1;
        }
        let columns = columns.into_iter().map(|(column, people)| {
            let label = self.design.factor_label(column);
            ("without_column", people, Some(label))
        });
        let others =
            [("lacking", panel.lacking(), None), ("unordered", panel.without_order.len(), None)];
        let parts = others.into_iter().chain(columns);
        parts
            .filter(|(_, people, _)| *people > 0)
            .map(|(key, people, column)| {
                let values = context! { people, column };
                self.methods.with(&values).text(key)
            })
            .collect()
    }

    /// Where the tests that were used were published.
    fn cited_tests(&self) -> Result<Vec<(String, String)>, ReportError> {
        let used = self.method_values().get_attr("used");
        let used = |name: &str| {
            let used = used.as_ref().ok().and_then(|used| used.get_attr(name).ok());
            used.is_some_and(|used| used.is_true())
        };
        let tested = self.analysis.panels.iter().any(|p| p.comparison.is_some());
        let ranks = used("one_factor") || used("wilcoxon") || used("nearer");
        let mut cited = Vec::new();
        for (wanted, key) in [
            (used("own_error"), "bell2002"),
            (used("dunn"), "dunn1964"),
            (used("one_factor"), "friedman1937"),
            (used("games_howell"), "games1976"),
            (used("epsilon"), "greenhouse1959"),
            (used("one_factor"), "huynh1976"),
            (tested, "holm1979"),
            (used("equivalence"), "schuirmann1987"),
            (used("normality"), "shapiro1965"),
            (used("groups"), "welch1951"),
            (ranks, "wilcoxon1945"),
        ] {
            if wanted {
                cited.push((key.to_owned(), self.methods.text(key)?));
            }
        }
        Ok(cited)
    }

    /// A questionnaire with its items and how its scales hold together here.
    fn questionnaire<'r>(
        &self,
        scale: &Scale,
        mine: impl Iterator<Item = &'r Reliability>,
    ) -> Result<String, ReportError> {
        let alphas = mine.filter(|r| r.alpha.is_some());
        let alphas = alphas.map(|r| self.methods.with(r).text("alpha"));
        let values = context! {
            title => scale.title.as_str(),
            items => scale.count(),
            reference => scale.reference.as_str(),
            alphas => alphas.collect::<Result<Vec<_>, _>>()?,
        };
        self.methods.with(&values).text("questionnaire")
    }

    /// The definition of every measure that is an outcome, or of which results say how near a car comes to the person.
    fn measures(&self) -> Result<Vec<String>, ReportError> {
        let a = self.analysis;
        let panels = a.panels.iter().filter(|p| p.group.is_none());
        let outcomes = panels.map(|p| (p.outcome.as_str(), p.title.as_str()));
        let reproduced = a.reproduction.iter().filter(|r| r.n > 0);
        let reproduced = reproduced.map(|r| (r.measure.as_str(), r.title.as_str()));
        let kept = a.kept.iter().map(|k| (k.measure.as_str(), k.title.as_str()));
        let mut known: BTreeSet<&str> = BTreeSet::new();
        let mut definitions = Vec::new();
        for (id, title) in outcomes.chain(reproduced).chain(kept) {
            if !known.insert(id) {
                continue;
            }
            if let Some(own) = self.design.measure(id) {
                let values = context! { title => own.title.as_str(), unit => own.shown_unit() };
                definitions.push(self.methods.with(&values).text("own_measure")?);
            } else if let Some(measure) = objective::find(id) {
                let values = context! { title, description => measure.description };
                definitions.push(self.methods.with(&values).text("measure")?);
            }
        }
        Ok(definitions)
    }
}
