//! Holds every check of every case in `tests/oracle` (see its folders' `expected.json`).
//!
//! A check is right if it is within either tolerance; none means equal. A number marked
//! `undefined` must be null, with a reason in `undefined`. `STATS_CASES` names another
//! folder of such cases, as `tests/external/stats_differential.py` draws them.
#![expect(clippy::unwrap_used, clippy::panic, reason = "helpers of tests may fail like tests")]

mod table;

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use maveric_stats as stats;
use serde_json::Value;
use table::Table;

/// Checks that we do not meet, with what we answer instead.
///
/// They quote a program where the number does not exist: the rule of this crate, and of
/// the reference's own README, is null with a reason.
const KNOWN_WRONG: [(&str, &str, &str); 13] = [
    (
        "additive_exact",
        "shapiro.residuals.W",
        "R tests rounding noise: the residuals are exactly zero",
    ),
    (
        "additive_exact",
        "shapiro.residuals.p",
        "R tests rounding noise: the residuals are exactly zero",
    ),
    ("all_equal", "shapiro.c1.W", "SciPy returns 1 for 0/0; R refuses"),
    ("all_equal", "shapiro.c1.p", "SciPy returns 1 for 0/0; R refuses"),
    ("all_equal", "shapiro.c2.W", "SciPy returns 1 for 0/0; R refuses"),
    ("all_equal", "shapiro.c2.p", "SciPy returns 1 for 0/0; R refuses"),
    ("all_equal", "shapiro.c3.W", "SciPy returns 1 for 0/0; R refuses"),
    ("all_equal", "shapiro.c3.p", "SciPy returns 1 for 0/0; R refuses"),
    ("all_equal", "shapiro.residuals.W", "SciPy returns 1 for 0/0; R refuses"),
    ("all_equal", "shapiro.residuals.p", "SciPy returns 1 for 0/0; R refuses"),
    ("one_constant_condition", "shapiro.c1.W", "the case's own title says that it is not defined"),
    ("one_constant_condition", "shapiro.c1.p", "the case's own title says that it is not defined"),
    (
        "corr_constant",
        "spearman.p_exact",
        "SciPy's permutation test returns 0 for a rho that does not exist",
    ),
];

fn answer(case: &Value, table: &Table) -> Value {
    let text = |key: &str| case[key].as_str().unwrap_or_default().to_lowercase();
    let json = |value: &dyn erased::Json| value.json();
    match text("design").as_str() {
        "within" => json(&stats::within(&table.within())),
        "sample" => json(&stats::normality(&table.numbers("value")).unwrap()),
        "p_adjust" => json(&stats::adjust(&table.complete("p")).unwrap()),
        "correlation" => {
            let (x, y) = (table.numbers("x"), table.numbers("y"));
            json(&stats::correlate(&x, &y, stats::CorrelationMethod::All, None).unwrap())
        }
        "rm_corr" => {
            let (x, y) = (table.numbers("x"), table.numbers("y"));
            json(&stats::rm_correlation(&table.text("subject"), &x, &y).unwrap())
        }
        "mixed" if case["fixed"].is_string() => random_intercept(case, table),
        "mixed" => mixed(case, table),
        "ordinal" => {
            let (subject, condition) = (table.text("subject"), table.text("condition"));
            json(&stats::ordinal(&subject, &condition, &table.numbers("value")).unwrap())
        }
        "factorial" => factorial(case, table),
        "by_design" => by_design(case, table),
        "crossover" => crossover(table),
        "case_crossover" => json(&stats::case_crossover(&table.strata())),
        "event_rates" => event_rates(table),
        "groups" => {
            let (group, value) = (table.text("group"), table.numbers("value"));
            json(&stats::groups(&group, &value).unwrap())
        }
        "equivalence" => equivalence(case, table),
        "bayes" => bayes(case, table),
        "items" => {
            let columns: Vec<_> =
                table.header.iter().map(|h| (h.as_str(), table.numbers(h))).collect();
            let items: Vec<(&str, &[Option<f64>])> =
                columns.iter().map(|(h, c)| (*h, &c[..])).collect();
            json(&stats::alpha(&items, None).unwrap())
        }
        "between" => json(&stats::levene(&table.text("group"), &table.numbers("value")).unwrap()),
        "bootstrap" => bootstrap(&text("statistic"), table),
        "power" => json(&stats::power(&table.questions()).unwrap()),
        "reported" => json(&stats::recheck(&table.reported()).unwrap()),
        other => panic!("no call for design {other}"),
    }
}

/// Analysis of variance, and under `art` the aligned ranks.
fn factorial(case: &Value, table: &Table) -> Value {
    let (within, between) = (names(case, "within"), names(case, "between"));
    let cells: Vec<_> = within.iter().map(|name| table.text(name)).collect();
    let levels: Vec<_> = between.iter().map(|name| table.labels(name)).collect();
    let within = columns(&within, &cells);
    let between = columns(&between, &levels);
    let design = stats::FactorialDesign::from_columns(
        &table.text("subject"),
        &within,
        &between,
        &table.numbers("value"),
    )
    .unwrap();
    let mut answer = serde_json::to_value(stats::factorial(&design)).unwrap();
    let art = serde_json::to_value(stats::aligned_ranks(&design)).unwrap();
    answer["art"] = art["art"].clone();
    for (name, reason) in art["undefined"].as_object().unwrap() {
        answer["undefined"][name] = reason.clone();
    }
    answer
}

/// The names that a case lists under `key`.
fn names<'a>(case: &'a Value, key: &str) -> Vec<&'a str> {
    let list = case[key].as_array().unwrap();
    list.iter().map(|name| name.as_str().unwrap()).collect()
}

/// Each column under its name.
fn columns<'a, T>(names: &[&'a str], cells: &'a [Vec<T>]) -> Vec<(&'a str, &'a [T])> {
    let cells = cells.iter().map(Vec::as_slice);
    names.iter().copied().zip(cells).collect()
}

/// The tests that decide, effect by effect.
fn by_design(case: &Value, table: &Table) -> Value {
    let (within, between) = (names(case, "within"), names(case, "between"));
    let cells: Vec<_> = within.iter().map(|name| table.text(name)).collect();
    let groups: Vec<_> = between.iter().map(|name| table.labels(name)).collect();
    let declared = case["covariates"].as_object().unwrap();
    let covariates: Vec<_> = declared.keys().map(|name| table.numbers(name)).collect();
    let (subjects, values) = (table.text("subject"), table.numbers("value"));
    let columns = stats::DesignColumns {
        subjects: &subjects,
        within: columns(&within, &cells),
        between: columns(&between, &groups),
        covariates: declared
            .keys()
            .map(String::as_str)
            .zip(covariates.iter().map(Vec::as_slice))
            .collect(),
        with: declared
            .iter()
            .map(|(name, products)| {
                let effects = products.as_array().unwrap().iter();
                (name.as_str(), effects.map(|e| e.as_str().unwrap()).collect())
            })
            .collect(),
        labels: Vec::new(),
        periods: &[],
        values: &values,
    };
    let chosen = stats::compare_by_design(&columns, &stats::DesignChoice::default());
    serde_json::to_value(chosen.unwrap()).unwrap()
}

/// The model with the period, and that with carry-over.
fn crossover(table: &Table) -> Value {
    let (subjects, conditions) = (table.text("subject"), table.text("condition"));
    let periods = table.text("period");
    let periods: Vec<usize> = periods.iter().map(|p| p.parse().unwrap()).collect();
    let values = table.numbers("value");
    let columns = stats::DesignColumns {
        subjects: &subjects,
        within: vec![("condition", &conditions)],
        periods: &periods,
        values: &values,
        ..Default::default()
    };
    let choice = stats::DesignChoice { test: stats::AskedTest::Mixed, ..Default::default() };
    serde_json::json!({
        "by_design": stats::compare_by_design(&columns, &choice).unwrap(),
        "carry_over": stats::carry_over(&columns).unwrap(),
    })
}

/// People one after the other, with every condition in the same order.
fn event_rates(table: &Table) -> Value {
    let mut conditions = table.text("condition");
    let mut seen = std::collections::BTreeSet::new();
    conditions.retain(|condition| seen.insert(condition.clone()));
    let (events, weeks) = (table.complete("events"), table.complete("weeks"));
    let cells: Vec<stats::Exposed> = events
        .iter()
        .zip(&weeks)
        .map(|(&events, &time)| stats::Exposed { events: events as usize, time })
        .collect();
    let rows: Vec<Vec<stats::Exposed>> =
        cells.chunks(conditions.len()).map(<[stats::Exposed]>::to_vec).collect();
    serde_json::to_value(stats::event_rates(&conditions, &rows, 100, 1).unwrap()).unwrap()
}

fn equivalence(case: &Value, table: &Table) -> Value {
    let (low, high) = (case["bounds"][0].as_f64().unwrap(), case["bounds"][1].as_f64().unwrap());
    let bounds = if case["standardized"] == Value::Bool(true) {
        stats::Bounds::Standardized { low, high }
    } else {
        stats::Bounds::Raw { low, high }
    };
    let found = if case["kind"] == "paired" {
        stats::equivalence(&table.within(), bounds)
    } else {
        let mu = case["mu"].as_f64().unwrap();
        stats::equivalence_one(&table.numbers("value"), mu, bounds)
    };
    serde_json::to_value(found.unwrap()).unwrap()
}

fn bayes(case: &Value, table: &Table) -> Value {
    let found = match case["kind"].as_str().unwrap() {
        "paired" => stats::bayes_paired(&table.within()),
        "two" => stats::bayes_groups(&table.text("group"), &table.numbers("value")).unwrap(),
        "one" => {
            let mu = case["mu"].as_f64().unwrap();
            stats::bayes_one(&table.numbers("value"), mu).unwrap()
        }
        _ => {
            let (x, y) = (table.numbers("x"), table.numbers("y"));
            return serde_json::to_value(stats::bayes_correlation(&x, &y).unwrap()).unwrap();
        }
    };
    serde_json::to_value(found).unwrap()
}

/// A predictor whose values are all numbers is a covariate, any other a factor.
fn random_intercept(case: &Value, table: &Table) -> Value {
    let formula: stats::Formula = case["fixed"].as_str().unwrap().parse().unwrap();
    let labels: Vec<_> = formula.predictors().iter().map(|name| table.labels(name)).collect();
    let numbers: Vec<Option<Vec<Option<f64>>>> = labels
        .iter()
        .map(|column| {
            let number = |cell: &Option<String>| match cell {
                None => Some(None),
                Some(text) => text.parse().ok().map(Some),
            };
            column.iter().map(number).collect()
        })
        .collect();
    let predictors: Vec<(&str, stats::Predictor)> = formula
        .predictors()
        .iter()
        .zip(labels.iter().zip(&numbers))
        .map(|(name, (labels, numbers))| {
            let zero = case["sum_to_zero"].as_array().into_iter().flatten();
            let predictor = match numbers {
                _ if zero.clone().any(|n| n == name.as_str()) => {
                    stats::Predictor::SumToZero(labels)
                }
                Some(numbers) => stats::Predictor::Covariate(numbers),
                None => stats::Predictor::Factor(labels),
            };
            (name.as_str(), predictor)
        })
        .collect();
    let (people, y) = (table.text("subject"), table.numbers("value"));
    let by: Option<Vec<&str>> =
        case["by"].as_array().map(|names| names.iter().filter_map(Value::as_str).collect());
    let fit = match by {
        None => stats::random_intercept(&people, &formula, &predictors, &y),
        Some(by) => stats::random_by_factor(&people, &formula, &by, &predictors, &y),
    };
    serde_json::to_value(fit.unwrap()).unwrap()
}

/// Both likelihoods of one model, under `reml` and `ml`.
fn mixed(case: &Value, table: &Table) -> Value {
    let (fixed, random) = (names(case, "fixed"), names(case, "random"));
    let values: Vec<_> = fixed.iter().map(|name| table.numbers(name)).collect();
    let fixed = columns(&fixed, &values);
    let run = |method| {
        let (people, y) = (table.text("subject"), table.numbers("y"));
        stats::mixed_model(&people, &y, &fixed, &random, method).unwrap()
    };
    serde_json::json!({
        "reml": run(stats::MixedMethod::Reml),
        "ml": run(stats::MixedMethod::Ml),
    })
}

fn bootstrap(words: &str, table: &Table) -> Value {
    use stats::{BootstrapData, BootstrapSettings, Statistic};
    let settings = BootstrapSettings { resamples: 20_000, seed: 7, confidence: 0.95 };
    let result = if words.contains("pearson") {
        let (x, y) = (table.numbers("x"), table.numbers("y"));
        stats::bootstrap(Statistic::Pearson, BootstrapData::Pairs(&x, &y), &settings)
    } else if words.contains("mean") {
        stats::bootstrap(Statistic::Mean, BootstrapData::Values(&table.numbers("value")), &settings)
    } else {
        stats::bootstrap(Statistic::Eta2Partial, BootstrapData::Within(&table.within()), &settings)
    };
    serde_json::to_value(result.unwrap()).unwrap()
}

/// Any serialisable result as JSON.
mod erased {
    pub(super) trait Json {
        fn json(&self) -> serde_json::Value;
    }

    impl<T: serde::Serialize> Json for T {
        fn json(&self) -> serde_json::Value {
            serde_json::to_value(self).unwrap()
        }
    }
}

/// Every leaf under its dotted name.
fn flat(value: &Value, path: &str, into: &mut BTreeMap<String, Value>) {
    let name = |key: &str| {
        if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
    };
    match value {
        Value::Object(map) => {
            for (key, inner) in map.iter().filter(|(key, _)| *key != "undefined") {
                flat(inner, &name(key), into);
            }
        }
        Value::Array(list) => {
            for (i, inner) in list.iter().enumerate() {
                flat(inner, &name(&i.to_string()), into);
            }
        }
        leaf => {
            into.insert(path.to_owned(), leaf.clone());
        }
    }
}

fn said_undefined(name: &str, answer: &Value) -> bool {
    answer["undefined"].as_object().is_some_and(|reasons| {
        reasons.iter().any(|(key, reason)| {
            let below = name.strip_prefix(key.as_str());
            let below = below.is_some_and(|r| r.is_empty() || r.starts_with('.'));
            below && !reason.as_str().unwrap_or_default().is_empty()
        })
    })
}

/// What is wrong with one check, if anything.
fn problem(
    name: &str,
    want: &Value,
    answer: &Value,
    got: &BTreeMap<String, Value>,
) -> Option<String> {
    let number = |value: Option<&Value>| value.and_then(Value::as_f64);
    if want["undefined"] == Value::Bool(true) {
        let null = got.get(name).is_none_or(Value::is_null);
        let said = said_undefined(name, answer);
        return (!(null && said))
            .then(|| format!("has no value; got {:?}, reason {said}", got.get(name)));
    }
    if let Some(consistent) = want.get("consistent") {
        let p = number(got.get(&format!("{name}.p")))?;
        let wanted = want["p"].as_f64()?;
        let right = got.get(&format!("{name}.consistent")) == Some(consistent)
            && ((p - wanted) / wanted).abs() <= 1e-6;
        return (!right).then(|| format!("want {want}, got p {p}"));
    }
    match &want["value"] {
        Value::Bool(_) => {
            return (got.get(name) != Some(&want["value"]))
                .then(|| format!("want {}, got {:?}", want["value"], got.get(name)));
        }
        Value::Array(list) => {
            let have: Vec<&Value> = (0..).map_while(|i| got.get(&format!("{name}.{i}"))).collect();
            let same = have.len() == list.len() && list.iter().all(|v| have.contains(&v));
            return (!same).then(|| format!("want {list:?}, got {have:?}"));
        }
        _ => {}
    }
    let Some(have) = number(got.get(name)) else {
        return Some(format!("want {}, got {:?}", want["value"], got.get(name)));
    };
    if let Some(range) = want["accept"].as_array() {
        let (low, high) = (range[0].as_f64()?, range[1].as_f64()?);
        return (!(low..=high).contains(&have)).then(|| format!("want {low}..{high}, got {have}"));
    }
    let value = want["value"].as_f64()?;
    let tolerance = |key: &str| want[key].as_f64().unwrap_or(0.0);
    let gap = (have - value).abs();
    let close = gap <= tolerance("abs_tol") || gap <= tolerance("rel_tol") * value.abs();
    (!close).then(|| format!("want {value}, got {have}"))
}

/// A number without a reason, or a reason without a missing number, is a fault of ours.
fn every_null_has_a_reason(answer: &Value, got: &BTreeMap<String, Value>) -> Vec<String> {
    got.iter()
        .filter(|(name, value)| value.is_null() && !said_undefined(name, answer))
        .map(|(name, _)| format!("{name}: null without a reason"))
        .collect()
}

#[test]
fn every_check_of_every_case_holds() {
    let other = std::env::var_os("STATS_CASES").map(PathBuf::from);
    let own = other.is_none();
    let folder =
        other.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracle"));
    let (mut faults, mut checks, mut cases) = (Vec::new(), 0, 0);
    let mut folders: Vec<_> = fs::read_dir(folder).unwrap().map(|f| f.unwrap().path()).collect();
    folders.sort();
    for folder in folders {
        let case: Value =
            serde_json::from_str(&fs::read_to_string(folder.join("expected.json")).unwrap())
                .unwrap();
        let id = case["case"].as_str().unwrap().to_owned();
        let table = Table::read(&folder.join("data.csv"), &case);
        let answer = answer(&case, &table);
        let mut got = BTreeMap::new();
        flat(&answer, "", &mut got);
        for fault in every_null_has_a_reason(&answer, &got) {
            faults.push(format!("{id}: {fault}"));
        }
        for (name, want) in case["checks"].as_object().unwrap() {
            if !["value", "accept", "undefined", "consistent"]
                .iter()
                .any(|key| want.get(key).is_some())
            {
                continue;
            }
            checks += 1;
            let problem = problem(name, want, &answer, &got);
            let known = KNOWN_WRONG.iter().any(|(c, n, _)| *c == id && n == name);
            if known {
                // Asserted as it is: null, with a reason.
                let null =
                    got.get(name).is_none_or(Value::is_null) && said_undefined(name, &answer);
                if !null {
                    faults.push(format!("{id}: {name}: listed as known wrong, but is not null"));
                }
            } else if let Some(problem) = problem {
                faults.push(format!("{id}: {name}: {problem}"));
            }
        }
        cases += 1;
    }
    assert!(faults.is_empty(), "{} of {checks} checks:\n{}", faults.len(), faults.join("\n"));
    assert!(!own || (cases > 50 && checks > 5000), "{cases} cases, {checks} checks");
}
