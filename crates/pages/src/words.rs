//! Phrases that pages share: lists, shares, intervals, and tests as APA writes them.

use maveric_analysis::{Contrast, ContrastTest, Correlation, OtherChoice, Panel, PrimaryOutcome};
use maveric_domain::{ConditionId, Design, ScoreRange, design::DeclaredTest};
pub use maveric_report::markup::capital;
use maveric_report::{
    apa,
    claims::{Claim, DfSource, Quantity},
    markup,
};
use maveric_stats::{Adjustment, PERIOD, apa::Statements};

/// A title within a sentence: its first letter small, unless it is an abbreviation's (`NASA-TLX`).
pub fn small(title: &str) -> String {
    let mut letters = title.chars();
    let first = letters.next().into_iter().flat_map(char::to_lowercase);
    if letters
        .clone()
        .next()
        .is_some_and(|second| second.is_lowercase() || second == ' ')
    {
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

/// A quantity with its unit, where it has one.
pub fn with_unit(title: &str, unit: &str) -> String {
    if unit.is_empty() {
        title.to_owned()
    } else {
        format!("{title} ({unit})")
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
    Some(if least == most {
        most.to_string()
    } else {
        format!("{least} to {most}")
    })
}

/// `86.9%`, with a true minus; `no value` where there is none.
pub fn percent(share: Option<f64>) -> String {
    share.map_or_else(
        || "no value".to_owned(),
        |v| format!("{}%", apa::number(100.0 * v, 1)),
    )
}

/// How a number is written: one that 1 bounds without the zero before the point.
pub(crate) fn written(bounded: bool) -> fn(f64, usize) -> String {
    if bounded { apa::bounded } else { apa::number }
}

/// ` [0.12, 0.34]`, or nothing.
pub fn interval(ends: Option<(f64, f64)>, decimals: usize, bounded: bool) -> String {
    let written = |end| written(bounded)(end, decimals);
    ends.map_or_else(String::new, |(low, high)| {
        format!(" [{}, {}]", written(low), written(high))
    })
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
            _ => format!(
                "{}: {}",
                markup::literal(&effect_title(design, &name)),
                said.markup()
            ),
        })
        .collect();
    match (&statements[..], short || effects.len() == 1) {
        ([], _) => "no test statistic: see the reasons in the analysis".to_owned(),
        ([first, ..], true) if effects.len() == 1 => first.clone(),
        ([.., last], true) => last.clone(),
        (statements, false) => statements.join("; "),
    }
}

/// An effect of several factors by the labels of its factors: `City × Condition`.
pub(crate) fn effect_title(design: &Design, name: &str) -> String {
    // A model of ordered answers calls `conditions` what a mixed model calls `condition`.
    let one = |label: String| {
        if label == "conditions" {
            "condition".to_owned()
        } else {
            label
        }
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
            apa::t(pair.statistic?, df, p, named, size)
                .markup()
                .to_owned()
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
    id.parse()
        .map_or_else(|_| id.to_owned(), |id| label(design, id))
}

/// What the dial turns.
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
    const WORDS: [&str; 10] = [
        "no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine",
    ];
    WORDS
        .get(n)
        .map_or_else(|| n.to_string(), |w| (*w).to_owned())
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
    let p = if printed.bound == Some('<') {
        printed.value * 0.999
    } else {
        printed.value
    };
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
    panel
        .group
        .as_ref()
        .map_or_else(String::new, |g| format!(" ({}: {})", g.factor, g.label))
}

#[cfg(test)]
mod tests {
    use super::{correlation_of_claim, counted};
    use maveric_report::claims::load;

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
