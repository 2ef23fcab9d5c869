//! A design as the text of a preregistration; its words are `texts/preregistration.md`.

use crate::{
    texts::document,
    words::{declared_test, in_words},
};
use maveric_analysis::{PlannedTest, held_against_baseline, planned, shown_unit};
use maveric_domain::{
    Design,
    design::{
        Car, Claim, Compare, Condition, DeclaredTest, Donors, Hypothesis, LevelContrast, Levels,
        Outcome, Quantity, Sign,
    },
};
use maveric_measures::{objective, survey::FEWEST_ITEMS};
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
        _ if design.conditions().len() < 2 => match held_against_baseline(design) {
            Some([_, baseline]) => ("baseline", Some(design.label(baseline))),
            None => ("none", None),
        },
        Compare::All => ("all", None),
        Compare::Against(one) => ("against", Some(design.label(*one))),
        Compare::Pairs(_) => ("pairs", None),
    };
    let homophily = design.homophily().map(|family| {
        let ratings: Vec<String> = family.ratings.iter().map(ToString::to_string).collect();
        context! { factors => family.factors.clone(), ratings, tested => design.has_style_differences() }
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
        ordered => design.outcomes().iter().any(|o| o.test == Some(DeclaredTest::Ordinal)),
        may_be_ordered => may_be_ordered(design),
        by_looks => by_looks(design),
        homophily,
        exclude => exclude(design),
    };
    document("preregistration.md", include_str!("../texts/preregistration.md"), values)
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
    let declared = design.outcomes().iter().find(|o| o.id() == h.outcome);
    let label = declared.and_then(|o| o.label.clone());
    let label = label.or_else(|| title(design, &h.outcome));
    context! {
        says => sentence(&h.says),
        outcome => label.unwrap_or_else(|| h.outcome.clone()),
        unit => shown_unit(design, &h.outcome),
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

/// What the design leaves out; who is left out by name is counted.
fn exclude(design: &Design) -> Value {
    let rules = design.exclude();
    context! {
        shorter_than_s => rules.drive_shorter_than_s.map(|s| s.to_string()),
        straight_lined => rules.straight_lined,
        fewest_items => in_words(FEWEST_ITEMS),
        attention_missed => rules.attention_missed_at_least.map(std::num::NonZeroUsize::get),
        fewer_than => rules.fewer_conditions_than,
        people => rules.people.len(),
        drives => rules.drives.len(),
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

/// What a measure is called; none of a score.
fn title(design: &Design, id: &str) -> Option<String> {
    let own_title = design.measure(id).map(|m| m.title.as_str());
    let known = || objective::find(id).map(|m| m.title);
    own_title.or_else(known).map(str::to_owned)
}

fn outcome(design: &Design, o: &Outcome) -> Value {
    let id = o.id();
    context! {
        label => o.label.clone().or_else(|| title(design, &id)),
        description => objective::find(&id).map(|m| m.description),
        own_unit => design.measure(&id).map(|m| m.unit.as_str()),
        unit => shown_unit(design, &id),
        same => o.same_within.map(|within| within.to_string()),
        id,
    }
}

/// A primary outcome with its declared test and the contrast that decides.
fn primary(design: &Design, o: &Outcome) -> Option<Value> {
    let [first, second] = o.primary?.map(|c| design.label(c));
    let test = declared_test(o.test?);
    Some(context! { id => o.id(), first, second, test })
}

/// Whether a rating may be tested by its order because it is of one item, which the answers show.
fn may_be_ordered(design: &Design) -> bool {
    let is_chosen = |o: &Outcome| o.test.is_none() && matches!(o.quantity, Quantity::Score(_));
    design.outcomes().is_empty() || design.outcomes().iter().any(is_chosen)
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
        assert!(one.contains(line) && !one.contains("in the order written"), "{one}");
        let two =
            text(&(primary("mean_velocity_mps", "mixed") + &primary("lane_changes", "mixed")));
        assert!(two.contains("in the order written, each at .05"), "{two}");
        let item = "[[outcome]]\nscale = \"comfort.total\"\nprimary = true\ntest = \"ordinal\"\ncontrast = [\"sporty\", \"calm\"]\n";
        let without_bound = "their odds have no finite estimate";
        let of_item = text(&format!("{item}[[outcome]]\nmeasure = \"mean_velocity_mps\"\n"));
        assert!(of_item.contains(without_bound) && !one.contains(without_bound));
        let none = text("[[outcome]]\nmeasure = \"mean_velocity_mps\"\n");
        // Nobody declares the test of a rating of one item: it is found where orders are known.
        let where_known = "- Where orders are known and everybody gives the lowest";
        let rating = text(
            "[[outcome]]\nscale = \"comfort.total\"\n[[outcome]]\nmeasure = \"mean_velocity_mps\"\n",
        );
        assert!(rating.contains(where_known) && text("").contains(where_known));
        assert!(!none.contains(without_bound) && !of_item.contains("Where orders are known and"));
        assert!(!none.contains("Primary:") && none.contains("the period is a factor"), "{none}");
        let auto = text("[[outcome]]\nmeasure = \"mean_velocity_mps\"\ntest = \"auto\"\n");
        assert!(auto.contains("`mean_velocity_mps` has no period in its test"), "{auto}");
    }

    #[test]
    fn bounds_stand_in_the_unit_in_which_they_are_tested() {
        let text = |outcome: &str, units: &str| {
            let claim = "equivalent = [-1.0, 1.5]";
            let study = STUDY
                .replace("direction = \"+\"", claim)
                .replace("mean_velocity_mps", outcome)
                .replace(
                    "[[condition]]\nid = \"calm\"",
                    &format!("{units}[[condition]]\nid = \"calm\""),
                );
            preregistration(&Design::from_toml(&study).unwrap(), &[]).unwrap()
        };
        for (outcome, units, said) in [
            (
                "mean_velocity_mps",
                "",
                "In Mean velocity: sporty minus calm lies between -1 and 1.5 km/h (two",
            ),
            ("mean_velocity_mps", "units = \"us\"\n", "between -1 and 1.5 mph (two"),
            (
                "jian_trust.overall",
                "",
                "In jian_trust.overall: sporty minus calm lies between -1 and 1.5 (two",
            ),
        ] {
            let text = text(outcome, units);
            assert!(text.contains(said), "{said} in {text}");
        }
    }

    #[test]
    fn one_condition_is_compared_with_the_baseline_or_with_nothing() {
        let one = |more: &str| {
            let text = format!("[study]\ntitle = \"t\"\n[[condition]]\nid = \"ride\"\n{more}");
            preregistration(&Design::from_toml(&text).unwrap(), &[]).unwrap()
        };
        let alone = one("");
        assert!(
            alone.contains("No condition is compared") && !alone.contains("Every condition"),
            "{alone}"
        );
        assert!(alone.contains("No outcome has a test"), "{alone}");
        let beside = one("[baseline]\nid = \"own\"\n");
        for said in ["- The condition is compared with own.", "- Each outcome: a paired t test"] {
            assert!(beside.contains(said), "{said} in {beside}");
        }
        // The baseline is in no order, so that its period is in no test.
        for not in ["No outcome has a test", "the period is a factor"] {
            assert!(!beside.contains(not), "{not} in {beside}");
        }
        let two = preregistration(&Design::from_toml(STUDY).unwrap(), &[]).unwrap();
        assert!(
            two.contains("- Every condition is compared with every other, with Holm's"),
            "{two}"
        );
    }

    #[test]
    fn a_family_of_correlations_is_promised_where_there_are_differences_from_the_own_style_alone() {
        let family = "[homophily]\nfactors = [\"mini_ipip\"]\nratings = [\"jian_trust.overall\"]\n";
        let text = |design: &str| {
            let design = Design::from_toml(&format!("{design}{family}")).unwrap();
            preregistration(&design, &[]).unwrap()
        };
        let steered = "[study]\ntitle = \"t\"\n[people]\nlearn = { group = \"drivers\" }\n[style]\nscore = \"adb.total\"\npoints = 15\n\
                       [[condition]]\nid = \"same\"\ncar = { dial = 0 }\n[[condition]]\nid = \"fast\"\ncar = { dial = \"+1\" }\n";
        let (steered, recorded) = (text(steered), text(STUDY));
        let (promised, not) = ("One family of correlations", "nothing is correlated");
        assert!(steered.contains(promised) && !steered.contains(not), "{steered}");
        assert!(recorded.contains(not) && !recorded.contains(promised), "{recorded}");
    }

    #[test]
    fn tests_by_looks_are_those_of_the_outcome_that_asks_for_them_whether_orders_are_known_or_not()
    {
        let text = |test: &str| {
            let outcome = format!("[[outcome]]\nmeasure = \"mean_velocity_mps\"\n{test}");
            let design = Design::from_toml(&format!("{STUDY}{outcome}")).unwrap();
            preregistration(&design, &[]).unwrap()
        };
        let by_looks = text("test = \"auto\"\n");
        let line =
            "has no period in its test. Of it, and of every outcome where no order is known:\n";
        assert!(by_looks.contains(line), "{by_looks}");
        let period = text("");
        assert!(period.contains("changes no verdict. Where no order is known:\n"), "{period}");
    }

    #[test]
    fn who_straight_lines_is_told_as_the_rule_judges_it() {
        let said = |rule: &str| {
            let study = STUDY.replace("[exclude]", &format!("[exclude]\n{rule}"));
            preregistration(&Design::from_toml(&study).unwrap(), &[]).unwrap()
        };
        let rule = "People who gave one answer, and not the middle one, to every item of a questionnaire with items reversed and not, of six answers or more.";
        let declared = said("straight_lined = true\n");
        assert!(declared.contains(rule), "{declared}");
        assert!(!said("").contains("gave one answer"));
    }

    #[test]
    fn who_is_left_out_by_name_is_counted_and_not_named() {
        let text = |names: &str| {
            let design = Design::from_toml(&format!("{STUDY}{names}")).unwrap();
            preregistration(&design, &[]).unwrap()
        };
        let named = text(
            "people = { P7 = \"withdrew\", P9 = \"as P7\" }\ndrives = { \"P8-calm\" = \"P8 was sick\" }\n",
        );
        let line = "- Left out by name when this text was made: 2 people and 1 drive.\n";
        assert!(named.contains(line), "{named}");
        assert!(!named.contains("P7") && !named.contains("P8"), "{named}");
        let drive = text("drives = { \"P8-calm\" = \"lost\" }\n");
        assert!(drive.contains("was made: 1 drive.\n"), "{drive}");
        assert!(!text("").contains("by name"));
    }

    #[test]
    fn a_design_reads_as_a_preregistration() {
        let text = preregistration(&Design::from_toml(STUDY).unwrap(), &[]).unwrap();
        for said in [
            "## Hypotheses\n\n- Sporty is faster. In Mean velocity: sporty lies above calm",
            "- calm (`calm`): driven by the laboratory's own car",
            "Drives shorter than 300 s",
            "a paired t test",
        ] {
            assert!(text.contains(said), "{said} in {text}");
        }
    }
}
