//! What a paper about a study is written from: its methods, from the design and the results.

use super::{Reliability, StudyPage, titled};
use crate::manuscript::{Block, Manuscript, Reference};
use maveric_domain::Scale;
use maveric_measures::objective;
use maveric_report::{Report, ReportError, html::RenderedFile};
use minijinja::context;

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
    /// page, and references.
    ///
    /// # Errors
    /// [`ReportError::Template`] for a text that asks for a value which is not given, or a document that cannot be packed.
    pub fn manuscript(
        &self,
        report: &Report,
        scales: &[Scale],
        reliabilities: &[Reliability],
    ) -> Result<Vec<RenderedFile>, ReportError> {
        let is_asked = |s: &&Scale| reliabilities.iter().any(|r| of_scale(r, s));
        let asked_scales: Vec<&Scale> = scales.iter().filter(is_asked).collect();
        let paragraphs = self.methods()?;
        let mut methods = vec![Block::Heading(1, self.methods.text("heading")?)];
        for (heading, abouts) in HEADINGS {
            let mut below = match heading {
                "participants" => vec![self.done()?],
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
            let matching = paragraphs
                .iter()
                .filter(|(about, _)| abouts.contains(about));
            below.extend(matching.map(|(_, text)| text.clone()));
            if !below.is_empty() {
                let heading = self.methods.text(&format!("heading_{heading}"))?;
                methods.push(Block::Heading(2, heading));
                methods.extend(below.into_iter().map(Block::Paragraph));
            }
        }
        let of_scale = asked_scales
            .iter()
            .map(|s| (s.id.clone(), s.reference.clone()));
        let of_tests = self.cited_tests()?;
        let manuscript = Manuscript {
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
            ("excluded_drives", &flow.drives),
        ] {
            for row in rows {
                paragraphs.push(self.methods.with(row).text(key)?);
            }
        }
        for panel in &self.analysis.panels {
            if !panel.dropped.is_empty() {
                let unordered = panel.dropped.len() - panel.lacking();
                let values = context! { title => titled(panel), lacking => panel.lacking(), unordered, n => panel.n };
                paragraphs.push(self.methods.with(&values).text("incomplete")?);
            }
        }
        Ok(paragraphs)
    }

    /// Where the tests that were used were published.
    fn cited_tests(&self) -> Result<Vec<(String, String)>, ReportError> {
        let used = self.method_values().get_attr("used");
        let used = |name: &str| {
            let used = used.as_ref().ok().and_then(|used| used.get_attr(name).ok());
            used.is_some_and(|used| used.is_true())
        };
        let tested = self.analysis.panels.iter().any(|p| p.comparison.is_some());
        let equivalence = self.analysis.reproduction.iter().any(|r| r.bias.is_some())
            || self.analysis.hypotheses.iter().any(|h| h.bounds.is_some());
        let mut cited = Vec::new();
        for (wanted, key) in [
            (used("one_factor"), "friedman1937"),
            (used("one_factor"), "greenhouse1959"),
            (used("one_factor"), "huynh1976"),
            (tested, "holm1979"),
            (equivalence, "schuirmann1987"),
            (tested, "shapiro1965"),
            (used("groups"), "welch1951"),
            (used("wilcoxon"), "wilcoxon1945"),
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

    /// The definition of every measure that is an outcome.
    fn measures(&self) -> Result<Vec<String>, ReportError> {
        let mut definitions = Vec::new();
        for panel in self.analysis.panels.iter().filter(|p| p.group.is_none()) {
            if let Some(own) = self.design.measure(&panel.outcome) {
                let values = context! { title => own.title.as_str(), unit => own.shown_unit() };
                definitions.push(self.methods.with(&values).text("own_measure")?);
            } else if let Some(measure) = objective::find(&panel.outcome) {
                let values =
                    context! { title => panel.title.as_str(), description => measure.description };
                definitions.push(self.methods.with(&values).text("measure")?);
            }
        }
        Ok(definitions)
    }
}
