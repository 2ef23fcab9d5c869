//! What a paper about a study is written from: its methods, from the design and the results.

use super::{Reliability, StudyPage};
use maveric_domain::Scale;
use maveric_measures::objective;
use maveric_report::{Manuscript, ReportError};
use minijinja::context;

/// The headings that journals ask for, with the paragraphs of the methods that stand below them.
const HEADINGS: [(&str, &[&str]); 7] = [
    ("participants", &["Participants"]),
    ("apparatus", &["Driving"]),
    ("styles", &["Learning", "Personalising"]),
    ("conditions", &["Conditions"]),
    ("measures", &[]),
    ("questionnaires", &[]),
    ("analysis", &["Tests", ""]),
];

impl StudyPage<'_> {
    /// Methods under the headings that journals ask for, with the references of the questionnaires that somebody answered.
    ///
    /// # Errors
    /// [`ReportError::Template`] for a text that asks for a value which is not given.
    pub fn manuscript(
        &self,
        scales: &[Scale],
        reliabilities: &[Reliability],
    ) -> Result<Manuscript, ReportError> {
        let of_scale = |r: &&Reliability, scale: &Scale| r.id.split('.').next() == Some(&*scale.id);
        let asked = scales
            .iter()
            .filter(|s| reliabilities.iter().any(|r| of_scale(&r, s)));
        let paragraphs = self.methods()?;
        let mut methods = Vec::new();
        for (heading, abouts) in HEADINGS {
            let mut below = match heading {
                "participants" => vec![self.done()?],
                "measures" => self.measures()?,
                "questionnaires" => {
                    let said = asked.clone().map(|scale| {
                        let mine = reliabilities.iter().filter(|r| of_scale(r, scale));
                        self.questionnaire(scale, mine)
                    });
                    said.collect::<Result<_, _>>()?
                }
                _ => Vec::new(),
            };
            let of = paragraphs
                .iter()
                .filter(|(about, _)| abouts.contains(about));
            below.extend(of.map(|(_, text)| text.clone()));
            if !below.is_empty() {
                methods.push((self.methods.text(&format!("heading_{heading}"))?, below));
            }
        }
        Ok(Manuscript {
            methods,
            references: asked.map(|s| (s.id.clone(), s.reference.clone())).collect(),
        })
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
            items => scale.items,
            reference => scale.reference.as_str(),
            alphas => alphas.collect::<Result<Vec<_>, _>>()?,
        };
        self.methods.with(&values).text("questionnaire")
    }

    /// The definition of every objective measure that is an outcome.
    fn measures(&self) -> Result<Vec<String>, ReportError> {
        let panels = self.analysis.panels.iter().filter(|p| p.group.is_none());
        let known = panels.filter_map(|p| Some((p, objective::find(&p.outcome)?)));
        let said = known.map(|(panel, measure)| {
            let values =
                context! { title => panel.title.as_str(), description => measure.description };
            self.methods.with(&values).text("measure")
        });
        said.collect()
    }
}
