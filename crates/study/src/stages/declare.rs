//! `design describe`: the design as the text of a preregistration.

use super::sample_size::sample_size;
use crate::{design::DesignFile, error::StudyError, outcome::Outcome};
use maveric_analysis::{PlannedTest, exclusions::declared, planned};
use maveric_domain::{
    Design,
    design::{Car, Claim, Compare, Condition, Sign},
};
use maveric_measures::objective;
use path_slash::PathExt as _;
use serde::Serialize;
use std::{collections::BTreeMap, fmt::Write as _, path::Path};

/// A design in plain English.
#[derive(Debug, Clone, Serialize)]
pub struct Described {
    /// Markdown, a section a heading.
    pub text: String,
}

/// The design in plain English, under the headings of a preregistration. The power of its tests is what a rehearsal found: `power`, or
/// `rehearsal/rehearsal.json` beside the design.
///
/// # Errors
/// [`StudyError`] if the design or the rehearsal cannot be read, or the rehearsal is of other outcomes or conditions.
///
/// # Source
/// Headings: the OSF Preregistration template and AsPredicted.
pub fn describe(
    design: Option<&Path>,
    power: Option<&Path>,
) -> Result<Outcome<Described>, StudyError> {
    let study = DesignFile::find(design)?;
    let text = text(&study.design, sample_size(&study, power)?);
    Ok(Outcome {
        summary: text.lines().map(str::to_owned).collect(),
        value: Described { text },
        warnings: Vec::new(),
    })
}

fn text(design: &Design, sample_size: Vec<String>) -> String {
    let mut out = format!("# {}\n", design.title());
    let mut section = |title: &str, lines: Vec<String>| {
        let _ = write!(out, "\n## {title}\n\n");
        for line in lines {
            let _ = writeln!(out, "- {line}");
        }
    };
    section("Hypotheses", hypotheses(design));
    section(
        "Conditions",
        design
            .conditions()
            .iter()
            .map(|c| condition(design, c))
            .chain(baseline(design))
            .collect(),
    );
    section("Participants", people(design));
    section("Sample size", sample_size);
    section("Measured variables", outcomes(design));
    section("Analyses", analyses(design));
    section("Exclusions", declared(design));
    out
}

fn hypotheses(design: &Design) -> Vec<String> {
    let one = |h: &maveric_domain::design::Hypothesis| {
        let [first, second] = h.contrast.map(|c| design.label(c));
        let rule = match h.claim {
            Claim::Direction(sign) => format!(
                "{first} {} {second} (two-sided p < .05 after Holm)",
                if sign == Sign::Plus {
                    "lies above"
                } else {
                    "lies below"
                }
            ),
            Claim::Equivalent([low, high]) => {
                format!(
                    "{first} minus {second} lies between {low} and {high} (two one-sided tests)"
                )
            }
        };
        format!("{} In {}: {rule}.", sentence(&h.says), h.outcome)
    };
    let found: Vec<String> = design.hypotheses().iter().map(one).collect();
    or_none(
        found,
        "No hypothesis is declared: every analysis is exploratory.",
    )
}

fn sentence(text: &str) -> String {
    format!("{}.", text.trim().trim_end_matches('.'))
}

fn or_none(found: Vec<String>, none: &str) -> Vec<String> {
    if found.is_empty() {
        vec![none.to_owned()]
    } else {
        found
    }
}

fn condition(design: &Design, c: &Condition) -> String {
    let dial = design.style().map_or("the style", |s| s.label.as_str());
    let car = match &c.car {
        None => "driven by the laboratory's own car or rig; its recordings are read".to_owned(),
        Some(Car::Dial(0.0)) => "a car with the participant's own learned style".to_owned(),
        Some(Car::Dial(points)) => {
            format!(
                "a car with the participant's learned style moved by {points:+} points of {dial}"
            )
        }
        Some(Car::Across) => {
            format!("a car with a style that differs from the participant's, but not in {dial}")
        }
        Some(Car::Mean) => {
            "a car that drives as the average of the drivers learned from".to_owned()
        }
        Some(Car::Embedding(path)) => format!("a car with the style in {}", path.to_slash_lossy()),
        Some(_) => format!("a car whose {dial} the participant turns while riding"),
    };
    let levels: Vec<String> = c.levels.iter().map(|(f, l)| format!("{f}: {l}")).collect();
    let levels = if levels.is_empty() {
        String::new()
    } else {
        format!(" ({})", levels.join(", "))
    };
    format!("{} (`{}`): {car}{levels}.", c.label, c.id)
}

fn baseline(design: &Design) -> Option<String> {
    let baseline = design.baseline()?;
    Some(format!(
        "Baseline: {} (`{}`), from which the differences of measures are taken.",
        baseline.label, baseline.id
    ))
}

fn people(design: &Design) -> Vec<String> {
    let wanted = |cells: &Option<BTreeMap<String, String>>| {
        let cells = cells.as_ref()?.iter().map(|(k, v)| format!("{k} = {v}"));
        Some(cells.collect::<Vec<_>>().join(" and "))
    };
    let mut lines = Vec::new();
    if let Some(learn) = wanted(&design.people().learn) {
        lines.push(format!("Learned from: those with {learn}."));
    }
    lines.push(wanted(&design.people().test).map_or_else(
        || "Tested: everybody who is not learned from.".to_owned(),
        |test| format!("Tested: those with {test}."),
    ));
    for factor in design.factors() {
        lines.push(format!("Groups by `{}`.", factor.column));
    }
    lines
}

fn outcomes(design: &Design) -> Vec<String> {
    let one = |o: &maveric_domain::design::Outcome| {
        let id = o.id();
        let known = objective::find(&id);
        let label = o
            .label
            .clone()
            .or_else(|| known.map(|m| m.title.to_owned()));
        let what = known.map_or_else(String::new, |m| format!(": {}", m.description));
        let same = o.same_within.map_or_else(String::new, |w| {
            format!(" Differences of at most {w} count as none.")
        });
        match label {
            Some(label) => format!("{label} (`{id}`){what}{same}"),
            None => format!("`{id}`{what}{same}"),
        }
    };
    let found = design.outcomes().iter().map(one).collect();
    or_none(
        found,
        "All objective measures, and every scale that is asked after a condition.",
    )
}

fn analyses(design: &Design) -> Vec<String> {
    let compared = match design.compare() {
        Compare::All => "Every condition is compared with every other".to_owned(),
        Compare::Against(one) => format!("Every condition is compared with {}", design.label(*one)),
        Compare::Pairs(_) => {
            let pairs: Vec<String> = design
                .contrasts()
                .iter()
                .map(|[a, b]| format!("{} with {}", design.label(*a), design.label(*b)))
                .collect();
            format!("Compared are {}", pairs.join(", "))
        }
    };
    let mut lines = vec![format!(
        "{compared}, with Holm's correction over the contrasts of an outcome."
    )];
    lines.extend(tests(design));
    if !design.factors().is_empty() {
        lines.push("The conditions are compared over everybody, one family for Holm's correction, and in each group on its own, another.".to_owned());
    }
    if let Some(family) = design.homophily() {
        let ratings: Vec<String> = family.ratings.iter().map(ToString::to_string).collect();
        lines.push(format!(
            "One family of correlations: {} against the differences in {} between the own style and each shifted one, with Holm's correction and the false \
             discovery rate.",
            family.factors.join(", "),
            ratings.join(", ")
        ));
    }
    lines.push("Whatever else the page shows is exploratory.".to_owned());
    lines
}

/// The test of each outcome, from the value that the analysis goes by.
fn tests(design: &Design) -> Vec<String> {
    let item = "A rating of one item (at most seven whole answers) is tested by its order alone";
    match planned(design) {
        PlannedTest::Pair => vec![
            "Each outcome: a paired t test where the differences look normal (Shapiro-Wilk, .05), else Wilcoxon's test.".to_owned(),
            format!("{item}: a cumulative logit model with a random intercept, its likelihood ratio held against F."),
        ],
        PlannedTest::OneFactor => vec![
            "Each outcome: repeated-measures ANOVA (degrees of freedom corrected after Greenhouse and Geisser or Huynh and Feldt) and paired t tests where the \
             residuals look normal (Shapiro-Wilk, .05), else Friedman's test and Wilcoxon's."
                .to_owned(),
            format!("{item}: a cumulative logit model with a random intercept, its likelihood ratio held against F."),
        ],
        PlannedTest::Groups => vec![
            "Each outcome: Welch's test of the groups where the residuals look normal (Shapiro-Wilk, .05), else Mann-Whitney or Kruskal-Wallis.".to_owned(),
        ],
        PlannedTest::Covariance => vec![
            "Each outcome: a linear model of groups and covariates (analysis of covariance).".to_owned(),
        ],
        PlannedTest::Effects(plan) => {
            let mut lines = vec![format!(
                "Each outcome has one test an effect, over everybody; residuals are judged by Shapiro and Wilk at .05. {item}, as are values far from normal."
            )];
            lines.extend(plan.effects.iter().map(|effect| {
                let normal = effect.normal.words();
                if effect.normal == effect.far_from_normal {
                    format!("`{}`: {normal}.", effect.effect)
                } else {
                    let far = effect.far_from_normal.words();
                    format!("`{}`: {normal}; far from normal {far}.", effect.effect)
                }
            }));
            lines
        }
        PlannedTest::None(why) => vec![format!("No outcome has a test: {why}.")],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STUDY: &str = "[study]\ntitle = \"Calm or sporty\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"\n\
                         [baseline]\nid = \"own\"\n[[hypothesis]]\nsays = \"Sporty is faster\"\noutcome = \"mean_velocity_mps\"\n\
                         contrast = [\"sporty\", \"calm\"]\ndirection = \"+\"\n[exclude]\ndrive_shorter_than_s = 300\n";

    #[test]
    fn effects_and_covariates_are_declared_with_the_tests_that_they_get() {
        let more = "[[factor]]\ncolumn = \"city\"\n[[covariate]]\ncolumn = \"age\"\nwith = [\"condition\"]\n";
        let text = text(
            &Design::from_toml(&format!("{STUDY}{more}")).unwrap(),
            Vec::new(),
        );
        for said in [
            "`city`: F of a regression",
            "`condition`: F of a regression",
            "`age:condition`: F of a regression",
            "over everybody",
            "in each group on its own",
        ] {
            assert!(text.contains(said), "{said} in {text}");
        }
        assert!(!text.contains("tested within each group"), "{text}");
    }

    #[test]
    fn a_design_reads_as_a_preregistration() {
        let text = text(&Design::from_toml(STUDY).unwrap(), Vec::new());
        for said in [
            "## Hypotheses\n\n- Sporty is faster. In mean_velocity_mps: sporty lies above calm",
            "- calm (`calm`): driven by the laboratory's own car",
            "Drives shorter than 300 s",
            "a paired t test",
        ] {
            assert!(text.contains(said), "{said} in {text}");
        }
    }
}
