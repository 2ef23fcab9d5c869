//! What a paper about a study is written from: its methods, from the design and the results.

use super::{
    Run,
    methods::Paragraph,
    setting::{Reliable, done},
};
use maveric_measures::objective;
use maveric_pages::words::listed;
use maveric_report::{Manuscript, apa, markup};

/// Methods under the headings that journals ask for, with the questionnaires' references.
pub(super) fn manuscript(
    run: &Run,
    paragraphs: &[Paragraph],
    reliabilities: &[Reliable],
) -> Manuscript {
    let about = |wanted: &[&str]| -> Vec<String> {
        let of = paragraphs
            .iter()
            .filter(|(about, _)| wanted.contains(about));
        of.map(|(_, text)| text.clone()).collect()
    };
    let mut participants = vec![done(run)];
    participants.extend(about(&["Participants"]));
    let mut methods = vec![
        ("Participants".to_owned(), participants),
        ("Apparatus".to_owned(), about(&["Driving"])),
        (
            "Learned styles".to_owned(),
            about(&["Learning", "Personalising"]),
        ),
        ("Conditions".to_owned(), about(&["Conditions"])),
        ("Measures".to_owned(), measures(run)),
        (
            "Questionnaires".to_owned(),
            questionnaires(run, reliabilities),
        ),
        ("Analysis".to_owned(), about(&["Tests", ""])),
    ];
    methods.retain(|(_, paragraphs)| !paragraphs.is_empty());
    let asked = run.scales.iter().filter(|s| asked(&s.id, reliabilities));
    Manuscript {
        methods,
        references: asked.map(|s| (s.id.clone(), s.reference.clone())).collect(),
    }
}

/// Whether somebody answered a scale.
fn asked(scale: &str, reliabilities: &[Reliable]) -> bool {
    reliabilities
        .iter()
        .any(|r| r.id.split('.').next() == Some(scale))
}

/// The definition of every measure that is an outcome.
fn measures(run: &Run) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for panel in run.analysis.panels.iter().filter(|p| p.group.is_none()) {
        if let Some(own) = run.design.measure(&panel.outcome) {
            let unit = own.shown_unit();
            let unit = if unit.is_empty() {
                String::new()
            } else {
                format!(" (in {unit})")
            };
            let title = markup::literal(&own.title);
            found.push(format!("{title}: a measure of our own{unit}."));
        } else if let Some(measure) = objective::find(&panel.outcome) {
            found.push(format!(
                "{}: {}.",
                panel.title,
                measure.description.trim_end_matches('.')
            ));
        }
    }
    found
}

/// Each questionnaire with its items and how its scales hold together here.
fn questionnaires(run: &Run, reliabilities: &[Reliable]) -> Vec<String> {
    let mut found = Vec::new();
    for scale in run.scales.iter().filter(|s| asked(&s.id, reliabilities)) {
        let mine = reliabilities
            .iter()
            .filter(|r| r.id.split('.').next() == Some(&*scale.id));
        let held: Vec<String> = mine
            .filter_map(|r| {
                Some(format!(
                    "{} *α* = {}",
                    markup::literal(&r.title),
                    apa::bounded(r.found.alpha?, 2)
                ))
            })
            .collect();
        let held = if held.is_empty() {
            String::new()
        } else {
            format!(" Reliability: {}.", listed(&held))
        };
        found.push(format!(
            "{} ({} items; {}).{held}",
            markup::literal(&scale.title),
            scale.items,
            markup::literal(&scale.reference)
        ));
    }
    found
}
