//! The page of the dial's rehearsal: figures, tables, lines.

use super::{DialRehearsal, LearnedFrom, Method, RehearseDial, Score, TrialError};
use crate::error::StudyError;
use maveric_analysis::Question;
use maveric_pages::{
    DIAL, PageTexts,
    cards::rehearsal::{recommends, saves},
};
use maveric_report::{
    Card, Context, Figure, Report,
    figures::{
        curves::{CurvePanel, CurvePoint, Curves, curves},
        recommendation::{Recommendations, recommendation},
    },
};
use serde::Serialize;
use std::collections::BTreeMap;

pub(super) fn page(
    rehearsal: &DialRehearsal,
    options: &RehearseDial,
) -> Result<Report, StudyError> {
    let context = Context::synthetic(options.seed);
    let texts = PageTexts::new(DIAL, &BTreeMap::from([("studies", options.studies)]))?;
    let mut figures = vec![sizes_figure(rehearsal, &texts, &context)?];
    if let Some(first) = rehearsal.learned_from.first() {
        figures.push(scatter(first, &texts, &context)?);
    }
    let scores = texts.table("recommendation", scores(rehearsal))?;
    let searched = texts.table("active-learning", &rehearsal.search)?;
    let search = vec![search_figure(rehearsal, &texts, &context)?];
    Ok(Report {
        cards: cards(rehearsal, &texts)?,
        sections: vec![
            texts.section("after", figures, vec![scores])?,
            texts.section("next", search, vec![searched])?,
        ],
        ..texts.page(&context, (options.seed, options.command.as_deref()))?
    })
}

/// What the page opens with.
fn cards(rehearsal: &DialRehearsal, texts: &PageTexts) -> Result<Vec<Card>, StudyError> {
    let mut cards = Vec::new();
    for finding in &rehearsal.findings {
        cards.extend(match (finding.question, rehearsal.learned_from.last()) {
            (Question::Recommends, Some(learned)) => Some(recommends(learned, finding)?),
            (Question::Active, _) => saves(
                &rehearsal.search,
                &saved(&rehearsal.search, texts)?,
                finding,
            )?,
            _ => None,
        });
    }
    Ok(cards)
}

fn sizes_figure(
    rehearsal: &DialRehearsal,
    texts: &PageTexts,
    context: &Context,
) -> Result<Figure, StudyError> {
    let near = |m: usize| -> Vec<CurvePoint> {
        let points = rehearsal.learned_from.iter().filter_map(|l| {
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
        let points = rehearsal.learned_from.iter().map(|l| {
            let score = &l.scores[m];
            point(l.participants, (score.mean_error, score.mean_error_half))
        });
        points.collect()
    };
    let count = Method::ALL.len();
    let first = rehearsal.learned_from.first();
    let people = first.and_then(|l| l.scores.first()).map(|s| s.people);
    let texts = &texts.with(&BTreeMap::from([("people", people)]));
    let input = Curves {
        name: "recommendation-sizes".to_owned(),
        title: texts.text("sizes")?,
        caption: texts.text("sizes_caption")?,
        alt: lines(rehearsal, texts)?.join(" "),
        x: texts.text("learned_from")?,
        curves: Method::ALL.iter().map(|m| m.title().to_owned()).collect(),
        rule: None,
        range: None,
        panels: vec![
            CurvePanel {
                title: texts.text("within")?,
                y: texts.text("share")?,
                curves: (0..count).map(near).collect(),
            },
            CurvePanel {
                title: texts.text("error")?,
                y: texts.text("unit")?,
                curves: (0..count).map(error).collect(),
            },
        ],
    };
    Ok(curves(&input, context)?)
}

/// A value with half of its interval.
fn point(x: usize, (y, half): (f64, f64)) -> CurvePoint {
    CurvePoint {
        x: x as f64,
        y,
        low: y - half,
        high: y + half,
    }
}

fn scatter(
    first: &LearnedFrom,
    texts: &PageTexts,
    context: &Context,
) -> Result<Figure, StudyError> {
    let input = Recommendations {
        unit: texts.text("unit")?,
        people: first.shown.clone(),
        learned_from: first.participants,
    };
    Ok(recommendation(&input, context)?)
}

fn search_figure(
    rehearsal: &DialRehearsal,
    texts: &PageTexts,
    context: &Context,
) -> Result<Figure, StudyError> {
    let line = |errors: fn(&TrialError) -> (f64, f64)| -> Vec<CurvePoint> {
        let trials = rehearsal.search.iter();
        trials.map(|t| point(t.trials, errors(t))).collect()
    };
    let people = rehearsal.search.first().map(|t| t.people);
    let texts = &texts.with(&BTreeMap::from([("people", people)]));
    let input = Curves {
        name: "active-learning".to_owned(),
        title: texts.text("search")?,
        caption: texts.text("search_caption")?,
        alt: saved(&rehearsal.search, texts)?,
        x: texts.text("trials")?,
        curves: vec![texts.text("active")?, texts.text("grid")?],
        rule: None,
        range: None,
        panels: vec![
            CurvePanel {
                title: texts.text("error")?,
                y: texts.text("unit")?,
                curves: vec![line(|t| t.active), line(|t| t.grid)],
            },
            CurvePanel {
                title: texts.text("within")?,
                y: texts.text("share")?,
                curves: vec![line(|t| (t.within_5.0, 0.0)), line(|t| (t.within_5.1, 0.0))],
            },
        ],
    };
    Ok(curves(&input, context)?)
}

/// The first trial after which a mean error is not above `wanted`.
fn reached(
    search: &[TrialError],
    error: fn(&TrialError) -> (f64, f64),
    wanted: f64,
) -> Option<usize> {
    search
        .iter()
        .find(|t| error(t).0 <= wanted)
        .map(|t| t.trials)
}

/// How many trials active learning saves on the way to half of what the grid gains.
fn saved(search: &[TrialError], texts: &PageTexts) -> Result<String, StudyError> {
    #[derive(Serialize)]
    struct Saved {
        trials: usize,
        /// The mean error of half of what the grid gains.
        wanted: f64,
        active: Option<usize>,
        grid: Option<usize>,
    }
    let (Some(first), Some(last)) = (search.first(), search.last()) else {
        return Ok(String::new());
    };
    let wanted = f64::midpoint(first.grid.0, last.grid.0);
    let values = Saved {
        trials: last.trials,
        wanted,
        active: reached(search, |t| t.active, wanted),
        grid: reached(search, |t| t.grid, wanted),
    };
    Ok(texts.with(&values).text("saved")?)
}

/// How near a method came, and how many people it learned from.
#[derive(Serialize)]
struct ScoreRow<'a> {
    title: &'static str,
    participants: usize,
    #[serde(flatten)]
    score: &'a Score,
}

fn scores(rehearsal: &DialRehearsal) -> impl Iterator<Item = ScoreRow<'_>> {
    rehearsal.learned_from.iter().flat_map(|learned| {
        learned.scores.iter().map(|score| ScoreRow {
            title: score.method.title(),
            participants: learned.participants,
            score,
        })
    })
}

fn lines(rehearsal: &DialRehearsal, texts: &PageTexts) -> Result<Vec<String>, StudyError> {
    let scores = scores(rehearsal).map(|row| Ok(texts.with(&row).text("score")?));
    scores.chain([saved(&rehearsal.search, texts)]).collect()
}

/// The result in a few lines.
pub(super) fn summary(rehearsal: &DialRehearsal) -> Result<Vec<String>, StudyError> {
    lines(rehearsal, &PageTexts::new(DIAL, &())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_trial_at_which_an_error_is_reached_is_the_first() {
        let trial = |trials, active, grid| TrialError {
            trials,
            people: 24,
            active: (active, 0.1),
            grid: (grid, 0.1),
            within_5: (0.5, 0.4),
        };
        let search = [trial(0, 9.0, 9.0), trial(1, 6.0, 8.0), trial(2, 5.0, 6.0)];
        assert_eq!(reached(&search, |t| t.active, 6.0), Some(1));
        assert_eq!(reached(&search, |t| t.grid, 5.5), None);
        let said = saved(&search, &PageTexts::new(DIAL, &()).unwrap()).unwrap();
        assert!(
            said.ends_with("active choice after 1, by the grid after 2"),
            "{said}"
        );
    }
}
