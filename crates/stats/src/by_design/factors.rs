//! Several factors, or one with covariates of the subjects: a test of each effect, as its plan has it.

use super::{
    ByDesign, Chosen, ChosenTest, DesignChoice, DesignColumns, DesignPlan, DesignShape,
    EffectMethod, FactorialFinding, OutcomeScale, effects::Effects, judged, kept::products,
    one_factor::few_whole_answers,
};
use crate::{
    AssumptionCheck, EffectTest, Factor, Factorial, FactorialDesign, Named, StatsError, factorial,
    factorial::SubjectCovariate, normality::shapiro_wilk, within_subjects::Index,
};

pub(super) fn several(
    data: &DesignColumns<'_>,
    choice: &DesignChoice,
    mut reasons: Vec<String>,
) -> Result<ByDesign, StatsError> {
    let (design, shape, covariates) = shaped(data)?;
    let [inside, people] = design.standardised_residuals();
    let checks: Vec<_> =
        [("the standardised residuals", inside), ("the subjects' standardised means", people)]
            .into_iter()
            .filter(|(_, residuals)| !residuals.is_empty())
            .map(|(name, residuals)| {
                AssumptionCheck::of_normality(name, &shapiro_wilk(&residuals).0)
            })
            .collect();
    let (mut normal, mut words) = judged(&checks);
    if let Some(order) = order_alone(choice.scale, data.values) {
        (normal, words) = (false, order);
    }
    let plan = DesignPlan::of(&shape);
    reasons.push(format!("{}; {words}", kinds(data)));
    if choice.scale == OutcomeScale::Ordinal {
        reasons.push(
            "several factors or a covariate: ranks are of each subject's means and differences of the answers' numbers, and F, means and \
             regressions are of these numbers; other numbers in the same order may give something else"
                .to_owned(),
        );
    }
    for (effect, _) in &shape.covariates {
        let effect = data.called(effect);
        reasons.push(format!(
            "{effect} has one value a subject: it is tested between subjects, and changes no effect within them that it is not declared to be multiplied by"
        ));
    }
    reasons.extend(methods_in_words(data, &plan, normal));
    let (anova, tests) = tested(&design, &shape, &covariates, &plan, normal)?;
    for (effect, test) in tests.iter().filter(|(_, test)| test.is_unanimous()) {
        let effect = data.called(effect);
        let ordered = match test.method {
            EffectMethod::FriedmanOfDifferences => "the differences between the levels",
            _ => "the levels",
        };
        reasons.push(format!(
            "{effect}: all subjects order {ordered} alike, so F has no bound; Friedman's chi-squared decides in its place"
        ));
    }
    let ranked = tests.values().any(|test| test.method.is_of_ranks());
    Ok(ByDesign::Factorial(Box::new(Chosen {
        chosen: if ranked { ChosenTest::Ranks } else { ChosenTest::Factorial },
        reasons,
        checks,
        found: FactorialFinding { anova, tests },
    })))
}

/// The complete subjects, what their design is made of, and the covariates of each.
pub(super) fn shaped<'a>(
    data: &DesignColumns<'a>,
) -> Result<(FactorialDesign, DesignShape, Vec<SubjectCovariate<'a>>), StatsError> {
    let values = with_covariates(data);
    let design =
        FactorialDesign::from_columns(data.subjects, &data.within, &data.between, &values)?;
    let shape = shape_of(data, &design)?;
    let covariates = of_subjects(data, &design);
    Ok((design, shape, covariates))
}

/// The analysis of variance, and the test of each effect as the plan has it.
pub(super) fn tested(
    design: &FactorialDesign,
    shape: &DesignShape,
    covariates: &[SubjectCovariate],
    plan: &DesignPlan,
    normal: bool,
) -> Result<(Factorial, Named<EffectTest>), StatsError> {
    let anova = factorial(design);
    let effects = Effects { shape, design, anova: &anova, covariates };
    let tests = effects.tests(plan, normal)?;
    Ok((anova, tests))
}

/// Why only the order of the values counts, if so.
fn order_alone(scale: OutcomeScale, values: &[Option<f64>]) -> Option<String> {
    match scale {
        OutcomeScale::Ordinal => Some("ordered answers, as asked".to_owned()),
        OutcomeScale::Rating => few_whole_answers(values)
            .ok()
            .map(|words| format!("an item ({words}), of which only the order counts")),
        OutcomeScale::Measure => None,
    }
}

fn kinds(data: &DesignColumns<'_>) -> String {
    let factors = |count: usize| format!("{count} factor{}", if count == 1 { "" } else { "s" });
    match (data.within.len(), data.between.len()) {
        (0, k) => format!("{} between subjects", factors(k)),
        (k, 0) => format!("{} within subjects", factors(k)),
        (w, b) => format!("{} within and {b} between subjects", factors(w)),
    }
}

/// A sentence a method: the effects that it tests.
fn methods_in_words(data: &DesignColumns<'_>, plan: &DesignPlan, normal: bool) -> Vec<String> {
    let mut by_method: Vec<(EffectMethod, Vec<String>)> = Vec::new();
    for effect in &plan.effects {
        let method = effect.method(normal);
        match by_method.iter_mut().find(|(known, _)| *known == method) {
            Some((_, names)) => names.push(data.called(&effect.effect)),
            None => by_method.push((method, vec![data.called(&effect.effect)])),
        }
    }
    by_method
        .into_iter()
        .map(|(method, names)| format!("{}: {}", names.join(", "), method.words()))
        .collect()
}

/// The values, without those of subjects who lack a covariate: they are left out and named.
fn with_covariates(data: &DesignColumns<'_>) -> Vec<Option<f64>> {
    let people = Index::from_labels(data.subjects);
    let known: Vec<bool> = (0..people.names.len())
        .map(|person| {
            data.covariates.iter().all(|(_, cells)| {
                let mut rows = people.rows.iter().zip(*cells);
                rows.any(|(p, cell)| *p == person && cell.is_some())
            })
        })
        .collect();
    let rows = people.rows.iter().zip(data.values);
    rows.map(|(&person, value)| value.filter(|_| known[person])).collect()
}

/// Each covariate of the complete subjects.
fn of_subjects<'a>(
    data: &DesignColumns<'a>,
    design: &FactorialDesign,
) -> Vec<SubjectCovariate<'a>> {
    let value = |cells: &[Option<f64>], subject: &String| {
        let mut rows = data.subjects.iter().zip(cells);
        rows.find_map(|(s, cell)| cell.filter(|_| s == subject))
    };
    let one = |(name, cells): &(&'a str, &[Option<f64>])| SubjectCovariate {
        name,
        values: design.subjects().iter().filter_map(|subject| value(cells, subject)).collect(),
    };
    data.covariates.iter().map(one).collect()
}

fn shape_of(data: &DesignColumns<'_>, design: &FactorialDesign) -> Result<DesignShape, StatsError> {
    let levels =
        |factors: &[Factor]| factors.iter().map(|f| (f.name.clone(), f.levels.len())).collect();
    let products = products(data)?;
    let with = |name: &str| -> Vec<String> {
        let of_this = products.iter().filter(|(covariate, _)| *covariate == name);
        of_this.map(|(_, factors)| factors.join(":")).collect()
    };
    Ok(DesignShape {
        within: levels(design.within()),
        between: levels(design.between()),
        covariates: data
            .covariates
            .iter()
            .map(|(name, _)| ((*name).to_owned(), with(name)))
            .collect(),
    })
}
