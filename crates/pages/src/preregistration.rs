//! A design as the text of a preregistration; its words are `texts/preregistration.md`.

use crate::{texts::document, words::declared_test};
use maveric_analysis::{PlannedTest, planned};
use maveric_domain::{
    Design,
    design::{
        Car, Claim, Compare, Condition, DeclaredTest, Donors, Hypothesis, LevelContrast, Levels,
        Outcome, Sign,
    },
};
use maveric_measures::objective;
use maveric_report::ReportError;
use minijinja::{Value, context};
use path_slash::PathExt as _;
use std::collections::BTreeMap;

/// Markdown under the headings of a preregistration; `sample_size` has the sentences about how many people.
///
/// # Errors
/// [`ReportError::Template`] for a text that asks for a value which is not given.
///
/// # Source
/// Headings: the OSF Preregistration template and AsPredicted.
pub fn preregistration(design: &Design, sample_size: &[String]) -> Result<String, ReportError> {
    let pair = |[a, b]: [_; 2]| format!("{} with {}", design.label(a), design.label(b));
    let (compare, against) = match design.compare() {
        Compare::All => ("all", None),
        Compare::Against(one) => ("against", Some(design.label(*one))),
        Compare::Pairs(_) => ("pairs", None),
    };
    let homophily = design.homophily().map(|family| {
        let ratings: Vec<String> = family.ratings.iter().map(ToString::to_string).collect();
        context! { factors => family.factors.clone(), ratings }
    });
    let cells = |cells: &Option<BTreeMap<String, String>>| {
        let cells = cells.as_ref()?.iter().map(|(k, v)| format!("{k} = {v}"));
        Some(cells.collect::<Vec<_>>().join(" and "))
    };
    let hypotheses = design.hypotheses().iter().map(|h| hypothesis(design, h));
    let conditions = design.conditions().iter().map(condition);
    let values = context! {
        title => design.title(),
        hypotheses => hypotheses.collect::<Vec<_>>(),
        conditions => conditions.collect::<Vec<_>>(),
        dial => crate::words::style(design),
        baseline => design.baseline().map(|b| context! { label => b.label.as_str(), id => b.id.to_string() }),
        learn => cells(&design.people().learn),
        test => cells(&design.people().test),
        groups => design.factors().iter().map(|f| design.factor_label(&f.name)).collect::<Vec<_>>(),
        sample_size => sample_size.to_vec(),
        outcomes => design.outcomes().iter().map(|o| outcome(design, o)).collect::<Vec<_>>(),
        own => design.measures().iter().map(|m| m.title.clone()).collect::<Vec<_>>(),
        compare,
        against,
        pairs => design.contrasts().into_iter().map(pair).collect::<Vec<_>>(),
        of_levels => design.level_contrasts().iter().map(|c| levels(design, c)).collect::<Vec<_>>(),
        tests => tests(design),
        reduced => design.outcomes().iter().filter(|o| !o.drop_items.is_empty()).map(|o| context! { id => o.id(), items => &o.drop_items }).collect::<Vec<_>>(),
        primary => design.outcomes().iter().filter_map(|o| primary(design, o)).collect::<Vec<_>>(),
        by_looks => by_looks(design),
        homophily,
        exclude => exclude(design),
    };
    document(
        "preregistration.md",
        include_str!("../texts/preregistration.md"),
        values,
    )
}

/// A contrast of levels by the labels of its factors.
fn levels(design: &Design, contrast: &LevelContrast) -> String {
    let part = |(factor, levels): (&String, &Levels)| {
        let labels = levels.named().iter().map(|l| design.level_label(factor, l));
        let labels: Vec<String> = labels.collect();
        format!("{} ({})", design.factor_label(factor), labels.join(" − "))
    };
    contrast.iter().map(part).collect::<Vec<_>>().join(" × ")
}

fn hypothesis(design: &Design, h: &Hypothesis) -> Value {
    let [first, second] = h.contrast.map(|c| design.label(c));
    let bounds = match h.claim {
        Claim::Direction(_) => None,
        Claim::Equivalent(bounds) => Some(bounds.map(|end| end.to_string())),
    };
    let [low, high] = bounds.map_or([None, None], |[low, high]| [Some(low), Some(high)]);
    context! {
        says => sentence(&h.says),
        outcome => h.outcome.as_str(),
        first,
        second,
        above => matches!(h.claim, Claim::Direction(Sign::Plus)),
        low,
        high,
    }
}

/// One full stop at the end.
fn sentence(text: &str) -> String {
    format!("{}.", text.trim().trim_end_matches('.'))
}

/// What the design leaves out.
fn exclude(design: &Design) -> Value {
    let rules = design.exclude();
    let row = |id: &str, why: &str| context! { id, why => sentence(why) };
    let people = rules.people.iter().map(|(id, why)| row(id.as_str(), why));
    let drives = rules.drives.iter().map(|(id, why)| row(id.as_str(), why));
    context! {
        shorter_than_s => rules.drive_shorter_than_s.map(|s| s.to_string()),
        straight_lined => rules.straight_lined,
        attention_missed => rules.attention_missed_at_least.map(std::num::NonZeroUsize::get),
        fewer_than => rules.fewer_conditions_than,
        people => people.collect::<Vec<_>>(),
        drives => drives.collect::<Vec<_>>(),
    }
}

/// A condition as texts call it, with what drove in it.
pub(crate) fn condition(c: &Condition) -> Value {
    let (car, points, path) = match &c.car {
        None => ("recorded", None, None),
        Some(Car::Dial(0.0)) => ("own", None, None),
        Some(Car::Dial(points)) => ("dial", Some(format!("{points:+}")), None),
        Some(Car::Across) => ("across", None, None),
        Some(Car::Mean) => ("mean", None, None),
        Some(Car::Embedding(path)) => ("embedding", None, Some(path.to_slash_lossy().into_owned())),
        Some(Car::Matched(_)) => ("matched", None, None),
        Some(Car::Replay) => ("replay", None, None),
        Some(_) => ("turned", None, None),
    };
    let levels = c.levels.iter().map(|(f, l)| format!("{f}: {l}"));
    context! {
        label => c.label.as_str(),
        id => c.id.to_string(),
        car,
        points,
        path,
        lent => lent(c),
        varies => c.vary,
        recorded => c.recorded,
        levels => levels.collect::<Vec<_>>(),
    }
}

/// Whose style is lent, and how far apart they shall lie.
fn lent(c: &Condition) -> Option<Value> {
    let Some(Car::Matched(matched)) = &c.car else {
        return None;
    };
    let [least, most] = matched.apart_sd;
    let tested = matched.from == Donors::Tested;
    Some(context! { tested, from => Donors::FROM, least, most })
}

fn outcome(design: &Design, o: &Outcome) -> Value {
    let known = objective::find(&o.id());
    let own_measure = design.measure(&o.id());
    let title = || {
        let own_title = own_measure.map(|m| m.title.as_str());
        own_title
            .or_else(|| known.map(|m| m.title))
            .map(str::to_owned)
    };
    context! {
        id => o.id(),
        label => o.label.clone().or_else(title),
        description => known.map(|m| m.description),
        own_unit => own_measure.map(|m| m.unit.as_str()),
        same => o.same_within.map(|within| within.to_string()),
    }
}

/// A primary outcome with its declared test and the contrast that decides.
fn primary(design: &Design, o: &Outcome) -> Option<Value> {
    let [first, second] = o.primary?.map(|c| design.label(c));
    let test = declared_test(o.test?);
    Some(context! { id => o.id(), first, second, test })
}

/// The outcomes whose test is declared to be chosen by what the data look like, whether orders are known or not.
fn by_looks(design: &Design) -> Vec<String> {
    let outcomes = design.outcomes().iter();
    let auto = outcomes.filter(|o| o.test == Some(DeclaredTest::Auto));
    auto.map(Outcome::id).collect()
}

/// The test of each outcome, from the value that the analysis goes by.
fn tests(design: &Design) -> Value {
    let kind = |kind: &str| context! { kind };
    match planned(design) {
        PlannedTest::Pair => kind("pair"),
        PlannedTest::OneFactor => kind("one factor"),
        PlannedTest::Groups => kind("groups"),
        PlannedTest::Covariance => kind("covariance"),
        PlannedTest::Effects(plan) => {
            let effects = plan.effects.iter().map(|e| {
                context! {
                    effect => e.effect.as_str(),
                    normal => e.normal.words(),
                    far => e.far_from_normal.words(),
                }
            });
            context! { kind => "effects", effects => effects.collect::<Vec<_>>() }
        }
        PlannedTest::None(why) => context! { kind => "none", why },
        _ => kind("other"),
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
        let design = Design::from_toml(&format!("{STUDY}{more}")).unwrap();
        let text = preregistration(&design, &[]).unwrap();
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
    fn measures_of_the_studys_own_are_told_with_their_unit_whether_outcomes_are_named_or_not() {
        let own = "[[measure]]\nid = \"tor_s\"\ntitle = \"Take-over time\"\nunit = \"s\"\n";
        let text = |more: &str| {
            let design = Design::from_toml(&format!("{STUDY}{more}")).unwrap();
            preregistration(&design, &[]).unwrap()
        };
        let all = text(own);
        assert!(all.contains("the study's own (Take-over time;"), "{all}");
        assert!(!text("").contains("the study's own"));
        let study = STUDY.replace("mean_velocity_mps", "tor_s");
        let design = format!("{study}{own}[[outcome]]\nmeasure = \"tor_s\"\n");
        let named = preregistration(&Design::from_toml(&design).unwrap(), &[]).unwrap();
        let line = "- Take-over time (`tor_s`): a measure of the study's own, in s;";
        assert!(named.contains(line), "{named}");
    }

    #[test]
    fn primary_outcomes_are_declared_with_test_contrast_and_gate_and_the_period_is() {
        let primary = |measure: &str, test: &str| {
            format!(
                "[[outcome]]\nmeasure = \"{measure}\"\nprimary = true\ntest = \"{test}\"\ncontrast = [\"sporty\", \"calm\"]\n"
            )
        };
        let text = |more: &str| {
            let design = Design::from_toml(&format!("{STUDY}{more}")).unwrap();
            preregistration(&design, &[]).unwrap()
        };
        let one = text(&primary("mean_velocity_mps", "mixed"));
        let line = "- Primary: `mean_velocity_mps`, sporty less calm, by a mixed model of condition, and of period";
        assert!(
            one.contains(line) && !one.contains("in the order written"),
            "{one}"
        );
        let two =
            text(&(primary("mean_velocity_mps", "mixed") + &primary("lane_changes", "mixed")));
        assert!(two.contains("in the order written, each at .05"), "{two}");
        let none = text("[[outcome]]\nmeasure = \"mean_velocity_mps\"\n");
        assert!(
            !none.contains("Primary:") && none.contains("the period is a factor"),
            "{none}"
        );
        let auto = text("[[outcome]]\nmeasure = \"mean_velocity_mps\"\ntest = \"auto\"\n");
        assert!(
            auto.contains("`mean_velocity_mps` has no period in its test"),
            "{auto}"
        );
    }

    #[test]
    fn a_design_reads_as_a_preregistration() {
        let text = preregistration(&Design::from_toml(STUDY).unwrap(), &[]).unwrap();
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
