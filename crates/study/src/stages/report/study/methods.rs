//! How the study was done, in words, with the numbers that it was done with.

use super::Run;
use crate::stages::train::TrainingSummary;
use maveric_analysis::Panel;
use maveric_domain::{
    MetresPerSecond, Road,
    design::{By, Car, Compare, Condition},
};
use maveric_stats::{ByDesign, PosthocTest};
use path_slash::PathExt as _;

/// A paragraph with what it is about.
pub(super) type Paragraph = (&'static str, String);

/// The paragraphs as the page has them.
pub(super) fn on_page(paragraphs: &[Paragraph]) -> Vec<String> {
    let one = |(about, text): &Paragraph| match *about {
        "" => text.clone(),
        about => format!("*{about}.* {text}"),
    };
    paragraphs.iter().map(one).collect()
}

pub(super) fn text(run: &Run, road: Option<&Road>, minutes: Option<f64>) -> Vec<Paragraph> {
    let mut paragraphs = Vec::new();
    if let Some(road) = road {
        let by_hand = if run.design.baseline().is_some_and(|b| b.by == By::Hand) {
            " by hand"
        } else {
            ""
        };
        let long = minutes.map_or_else(String::new, |m| {
            let s = if (0.5..1.5).contains(&m) { "" } else { "s" };
            format!(", {m:.0} minute{s} a drive{by_hand}")
        });
        let driven = format!(
            "{} lanes of {:.2} m in one direction, posted {:.0} mph{long}.",
            road.lanes,
            road.lane_width_m,
            MetresPerSecond(road.posted_speed_mps).mph(),
        );
        paragraphs.push(("Driving", driven));
    }
    if let Some(training) = &run.training {
        paragraphs.push(("Learning", learning(training)));
    }
    if run.model.is_some() {
        let score = run.design.style().map_or_else(String::new, |style| {
            format!(", once with the driver’s {} and once without", style.label)
        });
        let fitted = format!(
            "What was learned stays as it is; the embedding of each baseline drive is solved for, with its covariance{score}."
        );
        paragraphs.push(("Personalising", fitted));
    }
    let conditions = run.design.conditions().iter();
    let conditions: Vec<String> = conditions
        .map(|c| format!("{} {}", run.label(c.id), car(run, c)))
        .collect();
    paragraphs.push(("Conditions", format!("{}.", conditions.join("; "))));
    paragraphs.push(("Tests", tests(run)));
    paragraphs.extend(run.analysis.notes.iter().map(|note| ("", note.clone())));
    if run.analysis.synthetic {
        let made_up = "They are generated: traits drawn at random, driving by a driver model of another kind than the one that learns, answers \
             and ratings from the traits and from what each condition did. Effects come from one file and are what was put in.";
        paragraphs.push(("Participants", made_up.to_owned()));
    }
    paragraphs
}

/// What was learned from, and how.
fn learning(training: &TrainingSummary) -> String {
    let settings = &training.settings;
    let Some(networks) = &training.networks else {
        return format!(
            "Every drive is read as events: free speed, gap kept, moving out, merging back, passing or not. A mixed model with \
             an embedding of size {} explains them; it was fitted to {} drives, seed {}.",
            settings.embedding_size, training.drives, training.seed
        );
    };
    format!(
        "The paper’s networks: windows of {} s at {} Hz; {} passes over {} rows in batches of {}; {}seed {}.",
        settings.window_s,
        settings.window_rate_hz,
        networks.epochs.len(),
        networks.rows,
        settings.batch_size,
        networks
            .selection
            .as_ref()
            .map_or_else(String::new, |s| kept_back(s.people, settings.patience)),
        training.seed
    )
}

/// What the people who were kept back decided: with a patience of 0 nothing, every pass is kept.
fn kept_back(people: usize, patience: usize) -> String {
    if patience == 0 {
        format!(
            "every pass was kept: {people} people were kept back of a training of its own, to say how it does on whom it has not seen, and decided nothing; "
        )
    } else {
        format!(
            "their number was chosen on {people} people kept back (no better for {patience} passes), after which the model learned from everybody; "
        )
    }
}

/// What drove in a condition.
fn car(run: &Run, condition: &Condition) -> String {
    let elsewhere = if condition.recorded && condition.car.is_some() {
        ", driven in the laboratory’s own rig"
    } else {
        ""
    };
    let dial = run.style_label();
    let what = match &condition.car {
        None => "is the study’s own car, of which the recordings are read".to_owned(),
        Some(Car::Dial(0.0)) => "is the fitted embedding itself".to_owned(),
        Some(Car::Dial(points)) => {
            let from = match run.own_style() {
                Some(own) => run.label(own),
                None => "the embedding fitted to the person".to_owned(),
            };
            let way = if *points > 0.0 { "up" } else { "down" };
            let held = run.score_range().map_or_else(String::new, |(low, high)| {
                format!(", held within {low:.0} to {high:.0}")
            });
            format!(
                "lies {} points of {dial} {way} from {from}{held}",
                points.abs()
            )
        }
        Some(Car::Across) => format!(
            "is drawn at random from the ellipse one standard deviation across the gradient of {dial}"
        ),
        Some(Car::Mean) => "is the average driver".to_owned(),
        Some(Car::Embedding(path)) => format!("is the style in {}", path.to_slash_lossy()),
        Some(Car::Free) => "was turned by the person while riding".to_owned(),
        Some(_) => "was steered otherwise".to_owned(),
    };
    let wanders = if condition.vary {
        ", wandering in speed, gap and place in the lane as the person’s own drive does"
    } else {
        ""
    };
    format!("{what}{wanders}{elsewhere}")
}

fn tests(run: &Run) -> String {
    let design = &run.design;
    let used = chosen(run);
    let compared = match design.compare() {
        Compare::All => "every condition with every other".to_owned(),
        Compare::Against(one) => format!("every condition with {}", run.label(*one)),
        Compare::Pairs(pairs) => pairs
            .iter()
            .map(|[a, b]| format!("{} with {}", run.label(*a), run.label(*b)))
            .collect::<Vec<_>>()
            .join(", "),
    };
    let correlations = if run.analysis.homophily.is_empty() && run.analysis.line.is_none() {
        ""
    } else {
        " Correlations are Pearson’s or Spearman’s by the same check."
    };
    format!(
        "{used} Compared are {compared}; *p* is adjusted after Holm over the contrasts of an outcome.{correlations} Intervals are 95%. Each \
         measure and each test is defined in docs/method.md."
    )
}

/// The kinds of test that the design called for, each with what calls for it.
fn chosen(run: &Run) -> String {
    let design = &run.design;
    let factors = || {
        let named = design.factors().iter();
        let named = named.map(|c| c.label.as_ref().unwrap_or(&c.column).as_str());
        named.collect::<Vec<_>>().join(" and ")
    };
    let found = |is: fn(&ByDesign) -> bool| {
        let mut all = run
            .analysis
            .panels
            .iter()
            .filter_map(|p| p.comparison.as_ref());
        all.any(is)
    };
    let mut said = Vec::new();
    if found(|f| matches!(f, ByDesign::Factorial(_))) {
        let between = if design.factors().is_empty() {
            String::new()
        } else {
            format!(" with {} between people", factors())
        };
        said.push(format!(
            "Factorial analysis{between} (type III): each effect within people over its own stratum, groups with their own covariances, covariates of people between them alone; by the rank test of each person’s contrasts where the residuals are not normal."
        ));
    }
    if found(|f| matches!(f, ByDesign::Groups(_))) {
        let factors = factors();
        said.push(format!(
            "Groups of {factors} by Welch’s test, or by ranks where they are not normal."
        ));
    }
    if found(|f| matches!(f, ByDesign::Mixed(_))) {
        let covariates = design.covariates().iter();
        let covariates = covariates.map(|c| c.label.as_ref().unwrap_or(&c.column).as_str());
        let covariates = covariates.collect::<Vec<_>>().join(" and ");
        said.push(format!(
            "Mixed models with a variance of the person and of the person at each level of each factor take out the influence of {covariates} (Satterthwaite’s degrees of freedom)."
        ));
    }
    if found(|f| matches!(f, ByDesign::Ordinal(_))) {
        said.push(
            "Ratings of one item, whose answers have an order alone, by a cumulative logit model with a random intercept of the person; the rank \
             tests stand beside it."
                .to_owned(),
        );
    }
    if found(|f| f.one_factor().is_some_and(|c| c.k > 2)) {
        said.push(
            "Repeated-measures ANOVA, with its degrees of freedom corrected where sphericity fails, or Friedman’s test where the residuals are not \
             normal; then paired t tests or Wilcoxon’s."
                .to_owned(),
        );
    } else {
        said.extend(pairs(&run.analysis.panels));
    }
    said.join(" ")
}

/// How contrasts were tested, of those that were.
fn pairs(panels: &[Panel]) -> Option<String> {
    let tested = panels
        .iter()
        .filter(|p| p.contrasts.iter().any(|c| c.p.is_some()));
    let tests: Vec<PosthocTest> = tested.filter_map(|p| p.test).collect();
    let any = |test: PosthocTest| tests.contains(&test);
    let text = match (any(PosthocTest::T), any(PosthocTest::Wilcoxon)) {
        (true, true) => {
            "Contrasts by paired t tests, or Wilcoxon’s signed ranks where the residuals are not normal."
        }
        (true, false) => "Contrasts by paired t tests.",
        (false, true) => "Contrasts by Wilcoxon’s signed ranks.",
        (false, false) => return None,
    };
    Some(text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_tests_that_were_run_are_named() {
        let panel = |test: Option<PosthocTest>| -> Panel {
            let contrast = serde_json::json!({
                "first": "a", "second": "b", "expected": null, "people": [1, 0, 0], "mean_difference": 1.0, "statistic": 1.0,
                "df": 3, "effect": null, "p": test.map(|_| 0.5), "p_holm": null,
            });
            serde_json::from_value(serde_json::json!({
                "outcome": "x", "title": "X", "unit": "", "measured": true, "same": null, "range": null, "differences_from": null, "group": null,
                "participants": [], "conditions": ["a", "b"], "rows": [], "n": 4, "dropped": [], "test": test, "reasons": [],
                "comparison": null, "contrasts": [contrast],
            }))
            .unwrap()
        };
        let said = |tests: &[Option<PosthocTest>]| {
            let panels: Vec<Panel> = tests.iter().map(|test| panel(*test)).collect();
            pairs(&panels).unwrap_or_default()
        };
        let (t, w) = (Some(PosthocTest::T), Some(PosthocTest::Wilcoxon));
        assert_eq!(said(&[t]), "Contrasts by paired t tests.");
        assert!(!said(&[w]).contains("t tests"));
        assert!(said(&[t, w]).contains("t tests") && said(&[w, t]).contains("signed ranks"));
        assert_eq!(said(&[None]), "");
    }

    #[test]
    fn where_patience_is_0_people_kept_back_decided_nothing_and_the_page_says_so() {
        assert!(kept_back(120, 0).contains("decided nothing"));
        assert!(kept_back(120, 5).contains("was chosen on 120 people kept back"));
    }
}
