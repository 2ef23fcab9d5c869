//! The page of the dial's rehearsal: figures, tables, lines.

use super::{DialRehearsal, LearnedFrom, Method, RehearseDial, TrialError};
use crate::{error::StudyError, stages::report::page_of};
use maveric_analysis::Question;
use maveric_pages::cards::rehearsal::{recommends, saves};
use maveric_report::{
    Card, Context, Figure, Report,
    figures::{
        curves::{CurvePanel, CurvePoint, Curves, curves},
        recommendation::{Recommendations, recommendation},
    },
    html::Section,
    tables::{Cell, Table},
};
use maveric_stats::Proportion;

pub(super) fn page(found: &DialRehearsal, options: &RehearseDial) -> Result<Report, StudyError> {
    let context = Context::synthetic(options.seed);
    let section = |title: &str, intro: &str, figures, tables| Section {
        title: title.to_owned(),
        intro: vec![intro.to_owned()],
        figures,
        tables,
    };
    let mut figures = vec![sizes_figure(found, &context)?];
    if let Some(first) = found.learned_from.first() {
        figures.push(scatter(first, &context)?);
    }
    let subtitle = format!(
        "Synthetic participants: {} studies of each size to learn from, new people to recommend to, not driven",
        options.studies
    );
    let new = page_of(
        ("How far to turn the dial for this person", subtitle),
        &context,
        "A Bayesian linear regression with shrinkage, learned from one study and tried on people of another; docs/rehearsal.md gives the model.",
        (options.seed, options.command.as_deref().unwrap_or_default()),
    );
    Ok(Report {
        cards: cards(found)?,
        sections: vec![
            section(
                "After the four conditions",
                "Each model is learned from one study and tried on 24 people it has not seen, whose preferred shift the generator knows.",
                figures,
                vec![scores_table(found)],
            ),
            section(
                "Which shift to show next",
                "A new person, known by questionnaires and own drive, is shown one setting after another. Active: the setting whose rating is \
                 expected to tell most. Grid: seven evenly spaced settings in an order of their own.",
                vec![search_figure(found, &context)?],
                vec![search_table(&found.search)],
            ),
        ],
        ..new
    })
}

/// What the page opens with.
fn cards(found: &DialRehearsal) -> Result<Vec<Card>, StudyError> {
    let mut cards = Vec::new();
    for finding in &found.findings {
        cards.extend(match (finding.question, found.learned_from.last()) {
            (Question::Recommends, Some(learned)) => Some(recommends(learned, finding)?),
            (Question::Active, _) => saves(&found.search, &saved(&found.search), finding)?,
            _ => None,
        });
    }
    Ok(cards)
}

fn sizes_figure(found: &DialRehearsal, context: &Context) -> Result<Figure, StudyError> {
    let near = |m: usize| -> Vec<CurvePoint> {
        let points = found.learned_from.iter().filter_map(|l| {
            let share = l.scores[m].within_5?;
            Some(CurvePoint {
                x: l.participants as f64,
                y: share.estimate,
                low: share.low,
                high: share.high,
            })
        });
        points.collect()
    };
    let error = |m: usize| -> Vec<CurvePoint> {
        let points = found.learned_from.iter().map(|l| {
            let s = &l.scores[m];
            CurvePoint {
                x: l.participants as f64,
                y: s.mean_error,
                low: s.mean_error - s.mean_error_half,
                high: s.mean_error + s.mean_error_half,
            }
        });
        points.collect()
    };
    let count = Method::ALL.len();
    let input = Curves {
        name: "recommendation-sizes".to_owned(),
        title: "How near the recommended shift comes".to_owned(),
        caption: "New people whose preferred shift is known, by the size of the study learned from; 95% intervals.".to_owned(),
        alt: summary(found).join(" "),
        x: "Participants learned from".to_owned(),
        curves: Method::ALL.iter().map(|m| m.title().to_owned()).collect(),
        rule: None,
        range: None,
        panels: vec![
            CurvePanel {
                title: "Within 5 points".to_owned(),
                y: "Share of people".to_owned(),
                curves: (0..count).map(near).collect(),
            },
            CurvePanel {
                title: "Mean |error|".to_owned(),
                y: "ADB points".to_owned(),
                curves: (0..count).map(error).collect(),
            },
        ],
    };
    Ok(curves(&input, context)?)
}

fn scatter(first: &LearnedFrom, context: &Context) -> Result<Figure, StudyError> {
    let input = Recommendations {
        unit: "ADB points".to_owned(),
        people: first.shown.clone(),
        learned_from: first.participants,
    };
    Ok(recommendation(&input, context)?)
}

fn search_figure(found: &DialRehearsal, context: &Context) -> Result<Figure, StudyError> {
    let line = |of: fn(&TrialError) -> (f64, f64)| -> Vec<CurvePoint> {
        let points = found.search.iter().map(|t| {
            let (y, half) = of(t);
            CurvePoint {
                x: t.trials as f64,
                y,
                low: y - half,
                high: y + half,
            }
        });
        points.collect()
    };
    let share = |of: fn(&TrialError) -> f64| -> Vec<CurvePoint> {
        let points = found.search.iter().map(|t| {
            let y = of(t);
            CurvePoint {
                x: t.trials as f64,
                y,
                low: y,
                high: y,
            }
        });
        points.collect()
    };
    let input = Curves {
        name: "active-learning".to_owned(),
        title: "Trials to learn a preference".to_owned(),
        caption: "Error of the recommended shift after each trial; 95% intervals over people."
            .to_owned(),
        alt: saved(&found.search),
        x: "Trials".to_owned(),
        curves: vec!["active".to_owned(), "fixed grid".to_owned()],
        rule: None,
        range: None,
        panels: vec![
            CurvePanel {
                title: "Mean |error|".to_owned(),
                y: "ADB points".to_owned(),
                curves: vec![line(|t| t.active), line(|t| t.grid)],
            },
            CurvePanel {
                title: "Within 5 points".to_owned(),
                y: "Share of people".to_owned(),
                curves: vec![share(|t| t.within_5.0), share(|t| t.within_5.1)],
            },
        ],
    };
    Ok(curves(&input, context)?)
}

/// The first trial after which a mean error is not above `wanted`.
fn reached(search: &[TrialError], of: fn(&TrialError) -> (f64, f64), wanted: f64) -> Option<usize> {
    search.iter().find(|t| of(t).0 <= wanted).map(|t| t.trials)
}

/// How many trials active learning saves on the way to half of what the grid gains.
fn saved(search: &[TrialError]) -> String {
    let (Some(first), Some(last)) = (search.first(), search.last()) else {
        return String::new();
    };
    let wanted = f64::midpoint(first.grid.0, last.grid.0);
    let after = |of: fn(&TrialError) -> (f64, f64)| {
        reached(search, of, wanted).map_or_else(|| "more".to_owned(), |n| n.to_string())
    };
    format!(
        "half of what {} trials of the grid gain, a mean error of {wanted:.2} points, is reached by the active choice after {}, by the grid after {}",
        last.trials,
        after(|t| t.active),
        after(|t| t.grid)
    )
}

fn scores_table(found: &DialRehearsal) -> Table {
    let all = found.learned_from.iter();
    let rows = all.flat_map(|learned| learned.scores.iter().map(move |s| (learned, s)));
    let percent = |share: Option<Proportion>, of: fn(Proportion) -> f64| {
        Cell::number(share.map(|p| 100.0 * of(p)), 0)
    };
    Table::of("recommendation", "Recommended against preferred shift", rows)
        .text("Set by", |(_, s)| s.method.title())
        .right("Learned from", |(learned, _)| Cell::count(learned.participants))
        .right("Tried on", |(_, s)| Cell::count(s.people))
        .right("Within 5 points (%)", |(_, s)| percent(s.within_5, |p| p.estimate))
        .right("2.5%", |(_, s)| percent(s.within_5, |p| p.low))
        .right("97.5%", |(_, s)| percent(s.within_5, |p| p.high))
        .right("Mean |error|, points", |(_, s)| Cell::number(Some(s.mean_error), 2))
        .right("Interval holds the truth (%)", |(_, s)| percent(s.covered, |p| p.estimate))
        .right("2.5%", |(_, s)| percent(s.covered, |p| p.low))
        .right("97.5%", |(_, s)| percent(s.covered, |p| p.high))
        .noted("Wilson’s 95% intervals. Where the model has no recommendation the car stays with the own style. Preferences beyond 30 points count as 30.")
}

fn search_table(search: &[TrialError]) -> Table {
    Table::of("active-learning", "Error after each trial", search)
        .left("Trials", |t| Cell::count(t.trials))
        .right("Active: mean |error|", |t| {
            Cell::number(Some(t.active.0), 2)
        })
        .right("Grid: mean |error|", |t| Cell::number(Some(t.grid.0), 2))
        .right("Active: within 5 (%)", |t| {
            Cell::number(Some(100.0 * t.within_5.0), 0)
        })
        .right("Grid: within 5 (%)", |t| {
            Cell::number(Some(100.0 * t.within_5.1), 0)
        })
        .noted("Errors in ADB points.")
}

/// The result in a few lines.
pub(super) fn summary(found: &DialRehearsal) -> Vec<String> {
    let mut lines = Vec::new();
    for learned in &found.learned_from {
        for s in &learned.scores {
            let share = s.within_5.map_or(f64::NAN, |p| 100.0 * p.estimate);
            lines.push(format!(
                "learned from {}: {}: {share:.0}% within 5 points, mean error {:.2} points",
                learned.participants,
                s.method.title(),
                s.mean_error
            ));
        }
    }
    lines.push(saved(&found.search));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_trial_at_which_an_error_is_reached_is_the_first() {
        let trial = |trials, active, grid| TrialError {
            trials,
            active: (active, 0.1),
            grid: (grid, 0.1),
            within_5: (0.5, 0.4),
        };
        let search = [trial(0, 9.0, 9.0), trial(1, 6.0, 8.0), trial(2, 5.0, 6.0)];
        assert_eq!(reached(&search, |t| t.active, 6.0), Some(1));
        assert_eq!(reached(&search, |t| t.grid, 5.5), None);
        let said = saved(&search);
        assert!(
            said.ends_with("active choice after 1, by the grid after 2"),
            "{said}"
        );
    }
}
