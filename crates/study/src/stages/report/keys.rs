//! Our results under the keys of the claims ledger.

use super::people::People;
use maveric_analysis::{Analysis, Correlation, Preference};
use maveric_domain::ConditionId;
use maveric_report::claims::Made;
use std::collections::BTreeMap;

/// The stage that made what stands under a key, and the figure or table that shows it.
pub(super) fn made(key: &str) -> Made {
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
        "mimic_accuracy" => ("stats", Some("table-mimic-accuracy")),
        "nearer" => ("stats", Some("table-nearer")),
        "dial" | "rated_aggressiveness" => ("stats", Some("figure-difference-panels")),
        "perpendicular" => ("stats", Some("figure-perpendicular")),
        "preference" => ("stats", Some("figure-preference")),
        "correlation" => ("stats", Some("table-correlations")),
        _ => ("stats", None),
    };
    Made {
        stage: stage.to_owned(),
        shown_in: shown_in.map(str::to_owned),
    }
}

/// The ledger's word for a measure.
pub(super) fn short(measure: &str) -> &str {
    match measure {
        "mean_velocity_mps" => "mean_velocity",
        "mean_headway_time_s" => "mean_headway_time",
        "headway_merge_back_m" => "distance_headway_merge_back",
        "headway_merge_back_s" => "time_headway_merge_back",
        "min_headway_distance_m" => "min_headway_distance",
        other => other,
    }
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
    }
}

fn percent(part: usize, whole: usize) -> Option<f64> {
    (whole > 0).then(|| 100.0 * part as f64 / whole as f64)
}

/// What the panels give: Aggressive and Cautious against Mimic, and ratings against "the same".
fn panels(analysis: &Analysis, found: &mut Results) {
    for panel in &analysis.panels {
        let rated = panel.measure == "aggressiveness";
        for pair in panel.pairs.iter().filter(|p| p.first == ConditionId::MIMIC) {
            if !rated {
                let key = format!("dial.{}.{}", short(&panel.measure), pair.second);
                // The pair is Mimic minus the other; the claims are the other minus Mimic.
                found.set(
                    format!("{key}.difference"),
                    pair.mean_difference.map(|d| -d),
                );
                found.set(format!("{key}.p"), pair.p_holm);
                continue;
            }
            let key = format!("rated_aggressiveness.{}", pair.second);
            found.set(format!("{key}.p"), pair.p_holm);
            // The claims: Cautious is rated below Mimic, Aggressive above it.
            let sign = if pair.second == ConditionId::CAUTIOUS {
                1.0
            } else {
                -1.0
            };
            found.set(
                format!("{key}.direction"),
                pair.mean_difference.map(|d| sign * d),
            );
        }
        for (column, condition) in ConditionId::AV.iter().enumerate().filter(|_| rated) {
            let values = panel.rows.iter().filter_map(|row| *row.get(column)?);
            let (n, sum) = values.fold((0.0, 0.0), |(n, sum), v| (n + 1.0, sum + v));
            found.set(
                format!("rated_aggressiveness.{condition}.from_same"),
                (n > 0.0).then(|| sum / n - panel.same),
            );
        }
    }
}

/// Every result that a claim may ask for.
pub(super) fn results(
    analysis: &Analysis,
    people: &People,
    setup: &[(String, f64)],
) -> BTreeMap<String, f64> {
    let mut found = Results(BTreeMap::new());
    for (key, value) in setup {
        found.set(key.clone(), Some(*value));
    }
    for (key, value) in people.results() {
        found.set(key, value);
    }
    for row in &analysis.line.rows {
        found.correlation(&format!("line.{}", short(&row.measure)), &row.correlation);
    }
    if let Some((low, high)) = analysis.line.velocity_ends_mph {
        found.set("line.mean_velocity.low_mph", Some(low));
        found.set("line.mean_velocity.high_mph", Some(high));
    }
    for row in &analysis.accuracy {
        found.set(
            format!("mimic_accuracy.{}", short(&row.measure)),
            row.mean.map(|m| 100.0 * m),
        );
    }
    for row in &analysis.nearer {
        let key = format!("nearer.{}.{}", short(&row.measure), row.than);
        found.set(format!("{key}.p"), row.p_holm);
        // Above 0: for more people than not, Mimic is the nearer one.
        found.set(format!("{key}.direction"), row.share.map(|s| s - 0.5));
    }
    panels(analysis, &mut found);
    for row in &analysis.kept {
        let name = short(&row.measure);
        found.correlation(&format!("line.{name}"), &row.line);
        found.correlation(&format!("perpendicular.{name}"), &row.angle);
    }
    for row in &analysis.homophily {
        let versus = if row.versus == ConditionId::CAUTIOUS {
            "mc"
        } else {
            "ma"
        };
        found.correlation(
            &format!("correlation.{}.{versus}_{}", row.factor, row.rating),
            &row.correlation,
        );
    }
    for row in &analysis.similarity {
        found.correlation(
            &format!("correlation.similarity.{}", row.rating),
            &row.pooled,
        );
    }
    let over = |of: fn(&Preference) -> usize| {
        let n: usize = analysis.preferences.iter().map(|p| p.n).sum();
        percent(analysis.preferences.iter().map(of).sum(), n)
    };
    found.set(
        "preference.aggressive.percent",
        over(|p| p.aggressive_above),
    );
    found.set("preference.cautious.percent", over(|p| p.cautious_above));
    for row in &analysis.preferences {
        match row.rating.as_str() {
            "competence" => found.set(
                "preference.competence.mimic_at_most_cautious_percent",
                percent(row.mimic_not_above_cautious, row.n),
            ),
            "discomfort" => {
                found.set(
                    "preference.discomfort.aggressive_percent",
                    percent(row.aggressive_above, row.n),
                );
            }
            _ => {}
        }
    }
    found.0
}
