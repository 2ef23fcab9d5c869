//! Our results under the keys of the claims ledger.

use super::{people::People, study::Run};
use maveric_analysis::{Correlation, Preference};
use maveric_domain::SpeedUnit;
use maveric_pages::words::short;
use maveric_report::claims::Made;
use std::collections::BTreeMap;

/// The stage that made what stands under a key, and the figure or table that shows it.
pub(super) fn origin(key: &str) -> Made {
    let (first, rest) = key.split_once('.').unwrap_or((key, ""));
    let (stage, shown_in) = match first {
        "participants" => ("generate", Some("table-participants")),
        "scenario" => ("generate", Some("figure-domain")),
        "model" => ("train", Some("figure-architecture")),
        "steer" => ("steer", Some("figure-embedding-space")),
        "line" if rest.starts_with("min_headway") || rest.starts_with("left_lane") => {
            ("stats", Some("figure-perpendicular"))
        }
        "line" => ("stats", Some("figure-aggression-line")),
        "accuracy" => ("stats", Some("table-accuracy")),
        "nearer" => ("stats", Some("table-nearer")),
        "dial" | "rated" => ("stats", Some("figure-difference-panels")),
        "across" => ("stats", Some("figure-perpendicular")),
        "preference" => ("stats", Some("figure-preference")),
        "homophily" | "similarity" => ("stats", Some("table-correlations")),
        _ => ("stats", None),
    };
    Made { stage: stage.to_owned(), shown_in: shown_in.map(str::to_owned) }
}

struct Results(BTreeMap<String, f64>);

impl Results {
    fn set(&mut self, key: impl Into<String>, value: Option<f64>) {
        if let Some(value) = value {
            self.0.insert(key.into(), value);
        }
    }

    fn correlation(&mut self, key: &str, c: &Correlation) {
        self.set(format!("{key}.r"), c.r);
        self.set(format!("{key}.p"), c.p);
        self.set(format!("{key}.n"), Some(c.n as f64));
        let ranks = if c.method == "spearman" { 1.0 } else { 0.0 };
        self.set(format!("{key}.ranks"), c.r.map(|_| ranks));
    }
}

fn percent(part: usize, whole: usize) -> Option<f64> {
    (whole > 0).then(|| 100.0 * part as f64 / whole as f64)
}

/// What the panels give: each condition against that at 0 on the dial, and ratings against "as I do".
fn panels(run: &Run, by_key: &mut Results) {
    let Some(own_style) = run.design.own_style() else {
        return;
    };
    for panel in &run.analysis.panels {
        let measured = panel.measured;
        for pair in &panel.contrasts {
            // The pair may stand either way round; the claims are the other minus the own style.
            let (other, sign) = match (pair.first == own_style, pair.second == own_style) {
                (true, _) => (pair.second, -1.0),
                (_, true) => (pair.first, 1.0),
                _ => continue,
            };
            let difference = pair.mean_difference.map(|d| sign * d);
            if measured {
                let key = format!("dial.{}.{other}", short(&panel.outcome));
                by_key.set(format!("{key}.difference"), difference);
                by_key.set(format!("{key}.p"), pair.p_holm);
                continue;
            }
            let key = format!("rated.{}.{other}", panel.outcome);
            by_key.set(format!("{key}.p"), pair.p_holm);
            // Above 0: it lies on the expected side.
            let expected = pair.expected.map_or(1.0, |e| sign * e.factor());
            by_key.set(format!("{key}.direction"), difference.map(|d| expected * d));
        }
        let Some(same) = panel.same.filter(|_| !measured) else {
            continue;
        };
        for (column, condition) in panel.conditions.iter().enumerate() {
            let values = panel.rows.iter().filter_map(|row| *row.get(column)?);
            let (n, sum) = values.fold((0.0, 0.0), |(n, sum), v| (n + 1.0, sum + v));
            by_key.set(
                format!("rated.{}.{condition}.from_same", panel.outcome),
                (n > 0.0).then(|| sum / n - same),
            );
        }
    }
}

/// Every result that a claim may ask for.
pub(super) fn results(
    run: &Run,
    people: &People,
    setup: &[(String, f64)],
) -> BTreeMap<String, f64> {
    let analysis = &run.analysis;
    let mut by_key = Results(BTreeMap::new());
    for (key, value) in setup {
        by_key.set(key.clone(), Some(*value));
    }
    for (key, value) in people.results() {
        by_key.set(key, value);
    }
    by_key.set("n", Some(analysis.participants as f64));
    for row in analysis.line.iter().flat_map(|line| &line.rows) {
        let key = format!("line.{}", short(&row.measure));
        by_key.correlation(&key, &row.correlation);
        // The paper says its speeds in mph, whatever the page does.
        let speed = run.design.speed_unit();
        if let Some((low, high)) = row.ends.filter(|_| row.unit == speed.name()) {
            let in_mph = SpeedUnit::Mph.per_mps() / speed.per_mps();
            by_key.set(format!("{key}.low_mph"), Some(low * in_mph));
            by_key.set(format!("{key}.high_mph"), Some(high * in_mph));
        }
    }
    for row in &analysis.reproduction {
        by_key.set(
            format!("accuracy.{}.{}", row.condition, short(&row.measure)),
            row.mean.map(|m| 100.0 * m),
        );
    }
    for row in &analysis.nearer {
        let key = format!("nearer.{}.{}", short(&row.measure), row.than);
        by_key.set(format!("{key}.p"), row.p_holm);
        // Above 0: by the signed ranks the car at 0 on the dial is the nearer one.
        by_key.set(format!("{key}.direction"), row.effect);
    }
    panels(run, &mut by_key);
    for row in &analysis.kept {
        let name = short(&row.measure);
        by_key.correlation(&format!("line.{name}"), &row.line);
        by_key.correlation(&format!("across.{name}"), &row.angle);
    }
    for row in &analysis.homophily {
        by_key.correlation(&row.key(), &row.correlation);
    }
    for row in &analysis.similarity {
        by_key.correlation(&format!("similarity.{}", row.rating), &row.pooled);
    }
    preferences(&analysis.preferences, &mut by_key);
    by_key.0
}

/// Shares of people who rated a condition above their own style: of all ratings together, and rating by rating.
fn preferences(rated: &[Preference], by_key: &mut Results) {
    let Some(first) = rated.first() else { return };
    let n: usize = rated.iter().map(|p| p.n).sum();
    for (index, other) in first.others.iter().enumerate() {
        let above = rated.iter().filter_map(|p| Some(p.others.get(index)?.above));
        let key = format!("preference.{}.percent", other.condition);
        by_key.set(key, percent(above.sum(), n));
    }
    for row in rated {
        for other in &row.others {
            let key = format!("preference.{}.{}", row.rating, other.condition);
            by_key.set(format!("{key}.percent"), percent(other.above, row.n));
            by_key.set(format!("{key}.not_below_percent"), percent(other.not_below, row.n));
        }
    }
}
