//! Every test that a report prints, by name.

use maveric_analysis::{Analysis, CongruenceRow, Correlation, Judged, Panel, Question, Verdict};
use serde::{Deserialize, Serialize};

/// Which part of the report a test belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// 9.1, the line of the style.
    Line,
    /// 9.3, the omnibus test of a panel.
    Omnibus,
    /// 9.3, a pair of conditions within a panel.
    Pairs,
    /// 9.3, whether the car at 0 on the dial is nearer to the own drive.
    Nearer,
    /// 9.4, habits kept along the line and round the ellipse.
    Kept,
    /// 9.5, factors against rating differences.
    Homophily,
    /// 9.5, perceived similarity, every answer a pair of its own.
    SimilarityPooled,
    /// 9.5, perceived similarity within people.
    SimilarityWithin,
    /// 9.5, the mixed model.
    Mixed,
    /// The curvature of a rating over the distance from the own style.
    Congruence,
}

impl Part {
    /// All, in the order of the report.
    pub const ALL: [Self; 10] = [
        Self::Line,
        Self::Omnibus,
        Self::Pairs,
        Self::Nearer,
        Self::Kept,
        Self::Homophily,
        Self::SimilarityPooled,
        Self::SimilarityWithin,
        Self::Mixed,
        Self::Congruence,
    ];

    pub fn title(self) -> &'static str {
        match self {
            Self::Line => "Line of the style (Pearson)",
            Self::Omnibus => "Outcomes over the conditions",
            Self::Pairs => "Pairs of conditions (t or Wilcoxon)",
            Self::Nearer => "Own style nearer to own drive (Wilcoxon)",
            Self::Kept => "Habits kept: line, angle, circle",
            Self::Homophily => "Factors × rating differences (Pearson or Spearman)",
            Self::SimilarityPooled => "Similarity × rating, all rows (Spearman)",
            Self::SimilarityWithin => "Similarity × rating, within people",
            Self::Mixed => "Rating on shift (mixed model)",
            Self::Congruence => "Curvature of a rating over the distance (mixed model)",
        }
    }
}

/// One test of one study.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    pub part: Part,
    /// Such as `nearer.lane_changes.calm`; of a homophily test the claims ledger's key, before `.r`.
    pub key: String,
    /// What it is about, for people: `Mean velocity, calm − sporty`.
    pub about: String,
    /// Tests corrected together; none of a test that stands alone.
    pub family: Option<String>,
    /// r, share less ½, difference or coefficient; none for an omnibus test.
    pub estimate: Option<f64>,
    /// p, where the test has one.
    pub p: Option<f64>,
    /// After Holm within the family.
    pub p_holm: Option<f64>,
}

/// What came of one study.
#[derive(Debug, Clone, PartialEq)]
pub struct Studied {
    pub tests: Vec<Found>,
    /// The declared hypotheses, in the design's order.
    pub judged: Vec<Judged>,
    /// What became of each question of the study's page.
    pub findings: Vec<(Question, Verdict)>,
}

/// Every test of a study and every declared hypothesis, always in the same order.
pub fn found_in(a: &Analysis) -> Studied {
    Studied {
        tests: alone(a).into_iter().chain(in_families(a)).collect(),
        judged: a.hypotheses.clone(),
        findings: a.findings.iter().map(|f| (f.question, f.verdict)).collect(),
    }
}

fn r_and_p(c: &Correlation) -> (Option<f64>, Option<f64>) {
    (c.r, c.p)
}

/// Tests of which each stands for itself.
fn alone(a: &Analysis) -> Vec<Found> {
    let mut tests = Vec::new();
    let mut add = |part, key: String, about: String, estimate, p| {
        tests.push(Found { part, key, about, family: None, estimate, p, p_holm: None });
    };
    for line in [&a.line, &a.line_without_adb].into_iter().flatten() {
        let (fit, fitted) = if line.adb_used {
            ("with_score", "fitted with the score")
        } else {
            ("without_score", "fitted without the score")
        };
        for row in &line.rows {
            let (r, p) = r_and_p(&row.correlation);
            let about = format!("{}, {fitted}", row.title);
            add(Part::Line, format!("line.{fit}.{}", row.measure), about, r, p);
        }
    }
    for panel in &a.panels {
        for (key, about, p) in omnibus(panel) {
            add(Part::Omnibus, key, about, None, p);
        }
    }
    for row in &a.kept {
        let key = |what: &str| format!("kept.{}.{what}", row.measure);
        let ((line_r, line_p), (angle_r, angle_p)) = (r_and_p(&row.line), r_and_p(&row.angle));
        for (what, r, p) in [
            ("line", line_r, line_p),
            ("angle", angle_r, angle_p),
            ("circle", row.circular_r, row.circular_p),
        ] {
            add(Part::Kept, key(what), format!("{}, {what}", row.title), r, p);
        }
    }
    for row in &a.similarity {
        let ((pooled_r, pooled_p), (within_r, within_p)) =
            (r_and_p(&row.pooled), r_and_p(&row.within));
        add(
            Part::SimilarityPooled,
            format!("similarity.{}", row.rating),
            row.title.clone(),
            pooled_r,
            pooled_p,
        );
        add(
            Part::SimilarityWithin,
            format!("similarity_within.{}", row.rating),
            row.title.clone(),
            within_r,
            within_p,
        );
    }
    for row in &a.mixed {
        for (name, term) in [("shift", "shift"), ("shift_squared", "shift squared")] {
            let effect = row.model.as_ref().and_then(|m| m.fixed.get(name));
            let (estimate, p) = (effect.map(|e| e.estimate), effect.and_then(|e| e.p));
            add(
                Part::Mixed,
                format!("mixed.{}.{name}", row.rating),
                format!("{}, {term}", row.title),
                estimate,
                p,
            );
        }
    }
    let driven = |row: &&CongruenceRow| row.perceived.is_none();
    for row in a.congruence.iter().filter(driven) {
        let curvature = row.model.as_ref().and_then(|m| m.coef.get("moved^2"));
        let (estimate, p) = (curvature.map(|c| c.estimate), curvature.and_then(|c| c.p));
        let key = format!("congruence.{}.curvature", row.rating);
        add(Part::Congruence, key, row.title.clone(), estimate, p);
    }
    tests
}

/// The effects of an outcome over the conditions: key, what it is about and p.
fn omnibus(panel: &Panel) -> Vec<(String, String, Option<f64>)> {
    let (name, title) = (name_of(panel), title_of(panel));
    let Some(comparison) = &panel.comparison else {
        return vec![(format!("{name}.omnibus"), title, None)];
    };
    let effects = comparison.effects();
    let is_one = effects.len() == 1;
    let effect = |(effect, p): (&str, Option<f64>)| {
        let about = if is_one {
            title.clone()
        } else {
            format!("{title}, {}", effect.replace(':', " × "))
        };
        (format!("{name}.{effect}"), about, p)
    };
    effects.into_iter().map(effect).collect()
}

/// Tests that are corrected together with others.
fn in_families(a: &Analysis) -> Vec<Found> {
    let mut tests = Vec::new();
    let mut corrected =
        |part, (key, about): (String, String), family: String, estimate, p, p_holm| {
            tests.push(Found { part, key, about, family: Some(family), estimate, p, p_holm });
        };
    for panel in &a.panels {
        let name = name_of(panel);
        for pair in &panel.contrasts {
            let (first, second) = (pair.first, pair.second);
            let about = format!("{}, {first} − {second}", title_of(panel));
            corrected(
                Part::Pairs,
                (format!("{name}.{first}-{second}"), about),
                name.clone(),
                pair.mean_difference,
                pair.p,
                pair.p_holm,
            );
        }
    }
    for row in &a.nearer {
        let key = format!("nearer.{}.{}", row.measure, row.than);
        corrected(
            Part::Nearer,
            (key, format!("{}, than {}", row.title, row.than)),
            "nearer".to_owned(),
            row.effect,
            row.p,
            row.p_holm,
        );
    }
    for row in &a.homophily {
        let (title, rating, own, versus) = (&row.title, &row.rating_title, row.own, row.versus);
        let about = format!("{title} / {rating} ({own} − {versus})");
        let (r, p) = r_and_p(&row.correlation);
        corrected(Part::Homophily, (row.key(), about), "homophily".to_owned(), r, p, row.p_holm);
    }
    tests
}

/// The outcome, and the group where people are divided.
fn name_of(panel: &Panel) -> String {
    match &panel.group {
        Some(group) => format!("panel.{}.{}", panel.outcome, group.level),
        None => format!("panel.{}", panel.outcome),
    }
}

fn title_of(panel: &Panel) -> String {
    match &panel.group {
        Some(group) => format!("{} ({})", panel.title, group.label),
        None => panel.title.clone(),
    }
}
