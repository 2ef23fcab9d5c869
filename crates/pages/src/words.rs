//! Phrases that pages share: lists, shares, intervals, and tests as APA writes them.

use maveric_analysis::{
    Analysis, Contrast, ContrastTest, Correlation, Described, OtherChoice, Panel, PrimaryOutcome,
    Verdict,
};
use maveric_domain::{ConditionId, Design, ScoreRange, design::DeclaredTest};
pub use maveric_report::markup::capital;
use maveric_report::{
    apa,
    claims::{Claim, DfSource, Quantity},
    markup,
};
use maveric_stats::{Adjustment, ByDesign, PERIOD, apa::Statements};
use minijinja::{Value, context};

/// A title within a sentence: its first letter small, unless it is an abbreviation's (`NASA-TLX`).
pub fn small(title: &str) -> String {
    let mut letters = title.chars();
    let first = letters.next().into_iter().flat_map(char::to_lowercase);
    if letters.clone().next().is_some_and(|second| second.is_lowercase() || second == ' ') {
        return first.chain(letters).collect();
    }
    title.to_owned()
}

/// The title of the primary outcome that closed one of `all`.
pub(crate) fn closed_by(outcome: &PrimaryOutcome, all: &[PrimaryOutcome]) -> Option<String> {
    let id = outcome.closed_by.as_ref()?;
    let known = all.iter().find(|o| o.outcome == *id);
    Some(known.map_or_else(|| id.clone(), |o| o.title.clone()))
}

/// What that one came to, in words that follow its title.
pub(crate) fn closed_as(outcome: &PrimaryOutcome, all: &[PrimaryOutcome]) -> Option<&'static str> {
    let id = outcome.closed_by.as_ref()?;
    let closed = all.iter().find(|o| o.outcome == *id);
    Some(match closed.map(|o| o.verdict) {
        Some(Verdict::NotTestable) => "cannot be tested",
        Some(Verdict::TooFew | Verdict::NotAsked) => "has too few people",
        _ => "is not below .05",
    })
}

/// A quantity with its unit, where it has one.
pub fn with_unit(title: &str, unit: &str) -> String {
    if unit.is_empty() { title.to_owned() } else { format!("{title} ({unit})") }
}

/// Decimals of numbers in the unit of an outcome, by how much people differ within conditions.
pub(crate) fn outcome_decimals(described: &[Described], outcome: &str) -> usize {
    let of_outcome = described.iter().filter(|d| d.outcome == outcome);
    apa::decimals_among(of_outcome.filter_map(|d| d.sd))
}

/// How texts write numbers in the unit of an outcome: with so many `decimals`, of what was measured with the unit that it is `measured_in`.
pub(crate) fn in_unit_of(analysis: &Analysis, outcome: &str) -> Value {
    let mut panels = analysis.panels.iter();
    let measured = panels.find(|p| p.outcome == outcome && p.measured);
    context! {
        decimals => outcome_decimals(&analysis.descriptives, outcome),
        measured_in => measured.map_or("", |panel| panel.unit.as_str()),
    }
}

/// `a`, `a and b`, `a, b and c`.
pub fn listed(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// `24`, or `21 to 23` of counts that differ; none of none.
pub(crate) fn counted(counts: impl IntoIterator<Item = usize>) -> Option<String> {
    let counts: Vec<usize> = counts.into_iter().collect();
    let (least, most) = (counts.iter().min()?, counts.iter().max()?);
    Some(if least == most { most.to_string() } else { format!("{least} to {most}") })
}

/// `86.9%`, with a true minus; `no value` where there is none.
pub fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "no value".to_owned(), |v| format!("{}%", apa::number(100.0 * v, 1)))
}

/// How a number is written: one that 1 bounds without the zero before the point.
pub(crate) fn written(bounded: bool) -> fn(f64, usize) -> String {
    if bounded { apa::bounded } else { apa::number }
}

/// ` [0.12, 0.34]`, or nothing.
pub fn interval(ends: Option<(f64, f64)>, decimals: usize, bounded: bool) -> String {
    let written = |end| written(bounded)(end, decimals);
    ends.map_or_else(String::new, |(low, high)| format!(" [{}, {}]", written(low), written(high)))
}

/// A correlation with its test, with marks.
pub fn correlation(c: &Correlation) -> String {
    c.statement().map_or_else(
        || format!("not computed from {} pairs", c.n),
        |statement| statement.markup().to_owned(),
    )
}

/// The test over the conditions, and over what else the design crosses with them, in words with marks; `short` is for a panel's width: without
/// interval and ε, and of several effects the highest.
pub fn omnibus(design: &Design, panel: &Panel, short: bool) -> String {
    let Some(found) = &panel.comparison else {
        let reason = panel.reasons.first().map_or("", String::as_str);
        return if short {
            format!("not tested: *n* = {}", panel.n)
        } else {
            format!("not tested: {reason}")
        };
    };
    if let Some(found) = found.one_factor() {
        let statement = if short {
            found.omnibus.short_statement(found.n)
        } else {
            found.omnibus.statement(found.n)
        };
        return statement.map_or_else(
            || {
                let why = found.undefined.get("omnibus").filter(|_| !short);
                let why = why.map_or_else(String::new, |why| format!(": {why}"));
                format!("no test statistic{why}")
            },
            |statement| statement.markup().to_owned(),
        );
    }
    // Pairs have a table of their own.
    let effects = found.effects();
    // Of several effects the highest of factors, whatever covariates stand behind it.
    let is_covariate = |part: &str| design.covariates().iter().any(|c| c.column == part);
    let beside = |part: &str| is_covariate(part) || part == PERIOD;
    let counts = |name: &str| !short || !name.split(':').any(beside);
    let statements: Vec<String> = found
        .statements()
        .into_iter()
        .filter(|(name, _)| effects.len() == 1 || effects.iter().any(|(e, _)| e == name))
        .filter(|(name, _)| counts(name))
        .map(|(name, said)| match effects.len() {
            1 => said.markup().to_owned(),
            _ => format!("{}: {}", markup::literal(&effect_title(design, &name)), said.markup()),
        })
        .collect();
    match (&statements[..], short || effects.len() == 1) {
        ([], _) => {
            let why = why_undefined(found).filter(|_| !short);
            let why = why.map_or_else(String::new, |why| format!(": {}", markup::literal(why)));
            format!("no test statistic{why}")
        }
        ([first, ..], true) if effects.len() == 1 => first.clone(),
        ([.., last], true) => last.clone(),
        (statements, false) => statements.join("; "),
    }
}

/// What the test of a panel is over: the conditions, of one condition the factors that divide people.
pub(crate) fn over(design: &Design, panel: &Panel) -> String {
    let factors = design.factors().iter();
    let factors: Vec<String> = factors.map(|f| design.factor_label(&f.name)).collect();
    if panel.conditions.len() > 1 || factors.is_empty() {
        return "the conditions".to_owned();
    }
    factors.join(" × ")
}

/// Why numbers of a test do not exist, by the first of its reasons.
fn why_undefined(found: &ByDesign) -> Option<&str> {
    let undefined = match found {
        ByDesign::Factorial(chosen) => &chosen.found.anova.undefined,
        ByDesign::Groups(chosen) => &chosen.found.undefined,
        ByDesign::Mixed(chosen) => &chosen.found.model.undefined,
        ByDesign::Ordinal(chosen) => &chosen.found.model.undefined,
        _ => return None,
    };
    undefined.iter().next().map(|(_, why)| why)
}

/// An effect of several factors by the labels of its factors: `City × Condition`.
pub(crate) fn effect_title(design: &Design, name: &str) -> String {
    // A model of ordered answers calls `conditions` what a mixed model calls `condition`.
    let one = |label: String| {
        if label == "conditions" { "condition".to_owned() } else { label }
    };
    let label = |name: &str| one(design.factor_label(name));
    let factors: Vec<String> = name.split(':').map(label).collect();
    factors.join(" × ")
}

/// A paired test in words; *p* is that of Holm over its family, under its own name or, where what stands beside says so, its plain one.
pub fn paired(panel: &Panel, pair: &Contrast, named: Adjustment) -> Option<String> {
    let effect = pair.effect.as_ref();
    let p = pair.p_holm?;
    Some(match (panel.test?, pair.df) {
        (ContrastTest::T | ContrastTest::Mixed | ContrastTest::Ordinal, Some(df)) => {
            let size = effect.and_then(|e| Some((e.value?, e.ci)));
            apa::t(pair.statistic?, df, p, named, size).markup().to_owned()
        }
        _ => apa::wilcoxon(pair.statistic?, p, named, effect.and_then(|e| e.value))
            .markup()
            .to_owned(),
    })
}

/// What was chosen otherwise, in words that follow a difference.
pub(crate) fn other_choice(choice: &OtherChoice) -> String {
    match choice {
        OtherChoice::WithoutItems { items } => {
            let numbers: Vec<String> = items.iter().map(ToString::to_string).collect();
            let noun = if items.len() == 1 { "item" } else { "items" };
            format!("without {noun} {}", listed(&numbers))
        }
        OtherChoice::WithStopped { rides: 1 } => "with the ride that was stopped".to_owned(),
        OtherChoice::WithStopped { rides } => format!("with the {rides} rides that were stopped"),
    }
}

/// A declared test in words that end a sentence.
pub(crate) fn declared_test(test: DeclaredTest) -> &'static str {
    match test {
        DeclaredTest::Auto => "a test chosen by what the data look like",
        DeclaredTest::Mixed => {
            "a mixed model of condition, and of period where orders are known, with the person at random"
        }
        DeclaredTest::Ordinal => {
            "a cumulative logit model of condition, and of period where orders are known, with the person at random"
        }
        DeclaredTest::RmAnova => "analysis of variance, its contrasts by paired *t* tests",
        DeclaredTest::Friedman => "Friedman’s test, its contrasts by Wilcoxon’s signed ranks",
    }
}

/// What a design calls a condition, the baseline or a role, with marks.
pub fn label(design: &Design, id: ConditionId) -> String {
    markup::literal(&design.label(id))
}

/// The same of an id as a test names it; what is the id of nothing stays as it is.
pub(crate) fn label_of_id(design: &Design, id: &str) -> String {
    id.parse().map_or_else(|_| id.to_owned(), |id| label(design, id))
}

pub(crate) fn style(design: &Design) -> &str {
    design.style().map_or("the style", |style| &style.label)
}

/// Decimals of points of the style; none where nobody says its range.
pub(crate) fn decimals(score_range: Option<(f64, f64)>) -> usize {
    let range = score_range.and_then(|(low, high)| ScoreRange::new(low, high).ok());
    range.map_or(0, ScoreRange::decimals)
}

/// A distance on the dial to one decimal more than its points have: 15, 1.7, 0.57.
pub(crate) fn points(points: f64, digits: usize) -> f64 {
    let finest = (0..=digits).fold(1.0, |finest, _| 10.0 * finest);
    (points * finest).round() / finest
}

/// A small number as a word.
pub(crate) fn in_words(n: usize) -> String {
    const WORDS: [&str; 10] =
        ["no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine"];
    WORDS.get(n).map_or_else(|| n.to_string(), |w| (*w).to_owned())
}

/// The ledger's word for a measure.
pub fn short(measure: &str) -> &str {
    match measure {
        "mean_velocity_mps" => "mean_velocity",
        "mean_headway_time_s" => "mean_headway_time",
        "headway_merge_back_m" => "distance_headway_merge_back",
        "headway_merge_back_s" => "time_headway_merge_back",
        "min_headway_distance_m" => "min_headway_distance",
        other => other,
    }
}

/// The correlation that a claim printed, with marks; degrees of freedom only where they were printed too.
pub(crate) fn correlation_of_claim(claim: &Claim) -> Option<String> {
    let write = match claim.quantity {
        Quantity::Rho => apa::rho,
        _ => apa::r,
    };
    let printed = claim.printed_p.as_ref()?;
    // "< .001" is printed again as such, not as ".001".
    let p = if printed.bound == Some('<') { printed.value * 0.999 } else { printed.value };
    let df = claim.df.unwrap_or_default();
    let statement = write(claim.printed.value, df as usize, p);
    let marked = statement.markup();
    Some(match claim.df_from {
        Some(DfSource::Printed) => marked.to_owned(),
        _ => marked.replacen(&format!("({df})"), "", 1),
    })
}

/// Whose panel it is, where people are divided.
pub fn of_group(panel: &Panel) -> String {
    panel.group.as_ref().map_or_else(String::new, |g| format!(" ({}: {})", g.factor, g.label))
}

#[cfg(test)]
mod tests {
    use super::{
        ByDesign, Described, closed_as, closed_by, correlation_of_claim, counted, outcome_decimals,
        why_undefined,
    };
    use maveric_analysis::{PrimaryOutcome, Verdict};
    use maveric_domain::design::DeclaredTest;
    use maveric_report::claims::load;
    use maveric_stats::{Chosen, ChosenTest, Named, OrdinalFinding, ordinal};

    #[test]
    fn why_there_is_no_number_is_what_the_model_says_of_it() {
        let others = [2, 3, 1, 2, 4, 3, 2, 2, 3, 4, 1, 3, 2, 1, 3, 2];
        let said = |last: [i32; 8]| {
            let people: Vec<String> = (0..24).map(|i| (i / 3).to_string()).collect();
            let rides: Vec<String> =
                (0..24).map(|i| ["calm", "normal", "sporty"][i % 3].to_owned()).collect();
            let answer = |i: usize| match i % 3 {
                2 => last[i / 3],
                ride => others[2 * (i / 3) + ride],
            };
            let answers: Vec<Option<f64>> = (0..24).map(|i| Some(f64::from(answer(i)))).collect();
            let found = OrdinalFinding {
                model: ordinal(&people, &rides, &answers).unwrap(),
                small_sample: None,
                period: None,
                contrast: Named::default(),
                ratio: Named::default(),
                beside: None,
            };
            let found = ByDesign::Ordinal(Box::new(Chosen {
                chosen: ChosenTest::Ordinal,
                reasons: Vec::new(),
                checks: Vec::new(),
                found,
            }));
            why_undefined(&found).map(str::to_owned)
        };
        let extreme = said([1; 8]).unwrap();
        let why = "everybody gives the same extreme answer in this condition";
        assert!(extreme.starts_with(why), "{extreme}");
        let spread = said([1, 2, 3, 2, 1, 3, 4, 2]);
        assert!(spread.is_none_or(|spread| !spread.contains("extreme")));
    }

    #[test]
    fn a_share_of_a_hundredth_has_more_decimals_than_a_speed_and_a_constant_has_two() {
        let row = |outcome: &str, sd: f64| Described {
            outcome: outcome.to_owned(),
            title: String::new(),
            unit: String::new(),
            condition: "calm".parse().unwrap(),
            n: 12,
            mean: None,
            sd: Some(sd),
            median: None,
        };
        let rows = [
            row("offroad", 0.004),
            row("offroad", 0.006),
            row("speed", 9.8),
            row("same", 0.0),
            row("met", 0.0),
            row("met", 0.0),
            row("met", 0.0),
            row("met", 0.204),
        ];
        let outcomes = ["offroad", "speed", "same", "met", "other"];
        assert_eq!(outcomes.map(|o| outcome_decimals(&rows, o)), [4, 2, 2, 2, 2]);
    }

    #[test]
    fn what_closed_the_gate_is_told_as_what_it_came_to() {
        let outcome = |id: &str, closed_by: Option<&str>, verdict| PrimaryOutcome {
            outcome: id.to_owned(),
            title: id.to_uppercase(),
            unit: String::new(),
            first: "calm".parse().unwrap(),
            second: "sporty".parse().unwrap(),
            test: DeclaredTest::Ordinal,
            n: 24,
            closed_by: closed_by.map(str::to_owned),
            mean_difference: None,
            interval: None,
            odds: None,
            unbounded: false,
            p: None,
            verdict,
            why_not: None,
        };
        for (verdict, said) in [
            (Verdict::NotTestable, "cannot be tested"),
            (Verdict::NotShown, "is not below .05"),
            (Verdict::TooFew, "has too few people"),
        ] {
            let all = [outcome("a", None, verdict), outcome("b", Some("a"), Verdict::NotTested)];
            assert_eq!(closed_by(&all[1], &all).as_deref(), Some("A"));
            assert_eq!(closed_as(&all[1], &all), Some(said));
            assert_eq!(closed_as(&all[0], &all), None);
        }
    }

    #[test]
    fn counts_that_differ_are_a_range_and_none_is_nothing() {
        assert_eq!(counted([23, 21, 22]).as_deref(), Some("21 to 23"));
        assert_eq!(counted([24, 24]).as_deref(), Some("24"));
        assert_eq!(counted([]), None);
    }

    #[test]
    fn degrees_of_freedom_that_a_paper_does_not_print_are_not_printed_as_its() {
        let said = |df: &str| {
            let claims = load(&format!(
                "[[claim]]\nid = \"a\"\ntext = \"t\"\nsection = \"s\"\nquantity = \"r\"\nprinted = \".49\"\n\
                 printed_p = \".022\"\n{df}key = \"x.r\"\nrule = \"above\"\n"
            ))
            .unwrap();
            correlation_of_claim(&claims[0]).unwrap()
        };
        let with_df = said("df = 22\ndf_from = \"printed\"\n");
        assert_eq!(with_df, "*r*(22) = .49, *p* = .022");
        for unsaid in ["df = 22\ndf_from = \"participants\"\n", ""] {
            assert_eq!(said(unsaid), "*r* = .49, *p* = .022");
        }
    }
}
