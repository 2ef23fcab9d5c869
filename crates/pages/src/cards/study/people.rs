//! What people want: their own style or another, and whether their traits tell.

use super::data::Study;
use crate::{
    card::{Drawn, tested_card},
    texts::{Texts, value},
    words,
};
use maveric_analysis::{
    Above, CongruenceRow, Finding, HomophilyRow, Part, Preference, Verdict, least_that_holds,
};
use maveric_report::{Card, ReportError, figures::intervals::IntervalRow};
use maveric_stats::Proportion;
use minijinja::{Value, context};

/// Most rows of a picture.
const ROWS: usize = 8;

/// Do people like best a car near their own style? The parts of each rating are where its top lies and how far that moves.
pub(super) fn congruence(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Card, ReportError> {
    let say = |key: &str, values: &Value| texts.say("congruence", key, values);
    let digits = words::decimals(study.score_range);
    let rows = study.analysis.congruence.iter();
    let rows = rows.filter(|row| row.is_judged());
    let judged: Vec<(&CongruenceRow, &[Part])> = rows.zip(finding.parts.chunks(2)).collect();
    let shown = |at: usize| {
        let parts = judged.iter().filter_map(|(_, parts)| parts.get(at));
        parts.filter(|part| part.verdict == Verdict::Shown).count()
    };
    let mut drawn = Vec::new();
    let mut tests = Vec::new();
    for (row, parts) in &judged {
        let [top, movement] = parts else { continue };
        drawn.push(IntervalRow::new(&row.title, top.estimate, top.interval));
        tests.push(say(
            "test",
            &context! { top => value(top), movement => value(movement), digits, ..value(row) },
        )?);
    }
    let tops = judged.iter().filter_map(|(row, parts)| Some((row, parts.first()?)));
    let furthest = tops
        .filter_map(|(row, top)| Some((row, top.estimate?)))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let first = judged.first().map(|(row, _)| *row);
    let near = first.map_or(0.0, |row| row.near_points);
    let values = context! {
        style => words::style(study.design),
        ratings => judged.len(),
        tops => shown(0),
        stay => shown(1),
        near => words::points(near, digits),
        digits,
        places => first.map(|row| row.places),
        furthest => furthest.map(|(row, top)| context! { title => row.title.as_str(), top }),
    };
    let drawn = Drawn::beside(0.0, drawn).within((-near, near));
    tested_card(texts, finding, &values, Some(drawn), tests)
}

/// Do people tell which ride was in their own style? All of them, then by which came first.
pub(super) fn which(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Option<Card>, ReportError> {
    let Some((ride, all)) = study.analysis.which.as_ref().and_then(|r| Some((r, r.all?))) else {
        return Ok(None);
    };
    let values = context! {
        own => study.label(ride.own),
        other => study.label(ride.other),
        not_counted => ride.not_counted,
        interval => value(&all.share.percent().ends()),
        ..value(&all)
    };
    let [first, second] = ride.by_place;
    let rows = [("row_all", Some(all)), ("row_first", first), ("row_second", second)];
    let (mut drawn, mut tests) = (Vec::new(), Vec::new());
    for (key, choice) in rows {
        let Some(choice) = choice else { continue };
        let row = texts.say("which", key, &values)?;
        let values = context! { row => row.as_str(), ..value(&choice) };
        tests.push(texts.say("which", "test", &values)?);
        drawn.push(IntervalRow::share(&row, Some(&choice.share)));
    }
    let drawn = Drawn::beside(50.0, drawn);
    tested_card(texts, finding, &values, Some(drawn), tests).map(Some)
}

/// Would people rather be driven as they drive?
pub(super) fn preferred(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Card, ReportError> {
    let say = |key: &str, values: &Value| texts.say("preferred", key, values);
    let rated = study.analysis.preferences.iter().filter(|p| p.n > 0);
    let rated: Vec<&Preference> = rated.collect();
    let answers: usize = rated.iter().map(|p| p.n).sum();
    let mut shares = Vec::new();
    for (at, other) in rated.first().into_iter().flat_map(|p| p.others.iter().enumerate()) {
        let above = rated.iter().filter_map(|p| p.others.get(at));
        let above: usize = above.map(|other| other.above).sum();
        let values = context! {
            label => study.label(other.condition),
            share => 100.0 * above as f64 / answers.max(1) as f64,
        };
        shares.push(say("shares", &values)?);
    }
    let comparisons: Vec<(&Preference, &Above)> =
        rated.iter().flat_map(|p| p.others.iter().map(move |o| (*p, o))).collect();
    let values_of = |(p, o): (&Preference, &Above)| {
        context! {
            title => p.title.as_str(),
            label => study.label(o.condition),
            other => study.design.label(o.condition),
            above => o.above,
            n => p.n,
            share => o.share.as_ref().map(|s| s.estimate),
            interval => value(&o.share.as_ref().map(|s| s.percent().ends())),
        }
    };
    let known = || comparisons.iter().filter_map(|(p, o)| Some((*p, *o, o.share.as_ref()?)));
    let larger = |a: &Proportion, b: &Proportion| a.estimate.total_cmp(&b.estimate);
    let most = known().max_by(|a, b| larger(a.2, b.2));
    let mut rows = Vec::new();
    for (p, o) in comparisons.iter().take(ROWS) {
        rows.push(IntervalRow::share(say("row", &values_of((p, o)))?, o.share.as_ref()));
    }
    let values = context! {
        ratings => rated.len(),
        shares,
        most => most.map(|(p, o, _)| values_of((p, o))),
    };
    let drawn = Drawn::beside(50.0, rows);
    let tests = known().map(|(p, o, _)| say("test", &values_of((p, o))));
    let tests = tests.collect::<Result<_, _>>()?;
    tested_card(texts, finding, &values, Some(drawn), tests)
}

/// Strongest correlations that are shown.
const STRONGEST: usize = 3;

/// Does what people are like tell whose style they want?
pub(super) fn personality(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Option<Card>, ReportError> {
    let say = |key: &str, values: &Value| texts.say("personality", key, values);
    let rows = study.analysis.homophily.iter();
    let mut tested: Vec<&HomophilyRow> = rows.filter(|r| r.p_holm.is_some()).collect();
    let size = |r: &HomophilyRow| r.correlation.r.unwrap_or(0.0).abs();
    tested.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let Some(strongest) = tested.first() else {
        return Ok(None);
    };
    let values_of = |r: &HomophilyRow| {
        context! {
            title => r.title.as_str(),
            rating_title => r.rating_title.as_str(),
            own => study.label(r.own),
            versus => study.label(r.versus),
            correlation => words::correlation(&r.correlation),
            p_holm => r.p_holm,
        }
    };
    let alone = tested.iter().filter(|r| r.correlation.p.is_some_and(|p| p < 0.05));
    let could = least_that_holds(&study.analysis.homophily);
    let values = context! {
        all => tested.len(),
        kept => finding.count(Verdict::Shown),
        low => alone.count(),
        chance => 0.05 * tested.len() as f64,
        strongest => values_of(strongest),
        could => could.map(|(people, least)| context! { people, least }),
    };
    let (mut drawn, mut tests) = (Vec::new(), Vec::new());
    for row in tested.iter().take(STRONGEST) {
        let values = values_of(row);
        drawn.push(IntervalRow::new(say("row", &values)?, row.correlation.r, row.simultaneous));
        tests.push(say("test", &values)?);
    }
    let drawn = Drawn::beside(0.0, drawn);
    tested_card(texts, finding, &values, Some(drawn), tests).map(Some)
}
