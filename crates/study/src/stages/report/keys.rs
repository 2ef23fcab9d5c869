//! Our results under the keys of the claims ledger.

use super::people::People;
use crate::stages::analyse::{Analysis, Correlation};
use maveric_domain::Condition;
use std::collections::BTreeMap;

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

/// Every result that a claim may ask for.
pub(super) fn results(
    analysis: &Analysis,
    people: &People,
    setup: &[(&str, f64)],
) -> BTreeMap<String, f64> {
    let mut found = Results(BTreeMap::new());
    for (key, value) in setup {
        found.set(*key, Some(*value));
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
    let rated = analysis
        .panels
        .iter()
        .filter(|p| p.measure == "aggressiveness")
        .flat_map(|p| &p.pairs);
    for pair in rated.filter(|p| p.first == Condition::Mimic) {
        let key = format!("rated_aggressiveness.{}", pair.second);
        found.set(format!("{key}.p"), pair.p_holm);
        // The claims: Cautious is rated below Mimic, Aggressive above it.
        let sign = if pair.second == Condition::Cautious {
            1.0
        } else {
            -1.0
        };
        found.set(
            format!("{key}.direction"),
            pair.mean_difference.map(|d| sign * d),
        );
    }
    for row in &analysis.kept {
        let name = short(&row.measure);
        found.correlation(&format!("line.{name}"), &row.line);
        found.correlation(&format!("perpendicular.{name}"), &row.angle);
    }
    for row in &analysis.homophily {
        let versus = if row.versus == Condition::Cautious {
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
    let over = |of: fn(&crate::stages::analyse::Preference) -> usize| {
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
