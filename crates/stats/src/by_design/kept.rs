//! Covariates, and subjects who stay although a cell is missing: the mixed model.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    ByDesign, Chosen, ChosenTest, CorrectedTerm, DesignChoice, DesignColumns, DesignTable,
    MixedFinding, PERIOD, said_of_ordinal,
};
use crate::{
    FactorialDesign, Formula, Named, Predictor, RandomIntercept, StatsError, TermTest, factorial,
    factorial::check_between, mixed::random_with_own_errors, numerics::distributions::f_upper,
    within_subjects::Index,
};

/// The rows of subjects who lack no cell, where somebody does.
pub(super) fn listwise(data: &DesignColumns<'_>) -> Option<DesignTable> {
    let gaps = subjects_with_gaps(data);
    let whole = |row: &usize| !gaps.contains(data.subjects[*row].as_str());
    let rows: Vec<usize> = (0..data.subjects.len()).filter(whole).collect();
    (!gaps.is_empty()).then(|| DesignTable::rows(data, &rows, None))
}

/// The subjects who lack a cell that others have.
pub(super) fn subjects_with_gaps<'a>(data: &DesignColumns<'a>) -> BTreeSet<&'a str> {
    let rows = data.values.len().min(data.subjects.len());
    if data.within.is_empty() || data.within.iter().any(|(_, cells)| cells.len() < rows) {
        return BTreeSet::new();
    }
    let cell = |row: usize| -> Vec<&str> {
        let levels = data.within.iter();
        levels.map(|(_, cells)| cells[row].as_str()).collect()
    };
    let cells: BTreeSet<Vec<&str>> = (0..rows).map(cell).collect();
    let mut filled: BTreeMap<&str, BTreeSet<Vec<&str>>> = BTreeMap::new();
    for row in 0..rows {
        let person_cells = filled.entry(data.subjects[row].as_str()).or_default();
        if data.values[row].is_some() {
            person_cells.insert(cell(row));
        }
    }
    let short = filled.into_iter().filter(|(_, person_cells)| person_cells.len() < cells.len());
    short.map(|(subject, _)| subject).collect()
}

/// The first covariate that has two values for one subject.
///
/// # Errors
/// [`StatsError::LengthMismatch`].
pub(super) fn varying<'a>(data: &DesignColumns<'a>) -> Result<Option<&'a str>, StatsError> {
    let people = Index::from_labels(data.subjects);
    for (name, cells) in &data.covariates {
        StatsError::same_length(name, cells.len(), data.subjects.len())?;
        let mut values: Vec<Option<f64>> = vec![None; people.names.len()];
        for (&person, cell) in people.rows.iter().zip(*cells) {
            let Some(value) = *cell else { continue };
            let first = *values[person].get_or_insert(value);
            if (first - value).abs() > 0.0 {
                return Ok(Some(*name));
            }
        }
    }
    Ok(None)
}

/// The model in words.
pub(super) fn model_of(data: &DesignColumns<'_>) -> &'static str {
    if Index::from_labels(data.subjects).repeated.is_none() {
        return "linear model, as each subject has a single row (analysis of covariance)";
    }
    match data.within.len() {
        0 | 1 => {
            "mixed model with a random intercept of the subject, by Satterthwaite's degrees of freedom"
        }
        _ => {
            "mixed model with a variance of the subject and of the subject at each level of each factor within subjects, by Satterthwaite's degrees of freedom"
        }
    }
}

/// All factors and their products, and the covariates, in one model.
pub(super) fn mixed(
    data: &DesignColumns<'_>,
    choice: &DesignChoice,
    mut reasons: Vec<String>,
) -> Result<ByDesign, StatsError> {
    reasons.extend(said_of_ordinal(choice, "they are taken as numbers"));
    for column in &data.between {
        check_between(data.subjects, column)?;
    }
    let within: Vec<(&str, Vec<Option<String>>)> = data
        .within
        .iter()
        .map(|(name, cells)| (*name, cells.iter().cloned().map(Some).collect()))
        .collect();
    let between = data.between.iter().map(|(name, cells)| (*name, *cells));
    let within = within.iter().map(|(name, cells)| (*name, cells.as_slice()));
    let periods = labels(data.periods);
    let factors: Vec<(&str, &[Option<String>])> = between.chain(within).collect();
    let names: Vec<&str> = factors.iter().map(|(name, _)| *name).collect();
    let mut beside: Vec<&str> = data.covariates.iter().map(|(name, _)| *name).collect();
    // It is in no product: each condition is met in every period.
    beside.extend((!periods.is_empty()).then_some(PERIOD));
    let factors = factors.iter().map(|(name, cells)| (*name, Predictor::Factor(cells)));
    let numbers = data.covariates.iter().map(|(name, cells)| (*name, Predictor::Covariate(cells)));
    let period = (PERIOD, Predictor::Factor(&periods));
    let predictors: Vec<(&str, Predictor<'_>)> = factors.chain(numbers).chain([period]).collect();
    let mut formula = Formula::crossed(&names, &beside)?;
    for (covariate, factors) in products(data)? {
        formula = formula.and_product(covariate, &factors)?;
    }
    let by: Vec<&str> = data.within.iter().map(|(name, _)| *name).collect();
    let (model, own_error) =
        random_with_own_errors(data.subjects, &formula, &by, &predictors, data.values)?;
    let corrected = corrected(data, &model);
    if !corrected.is_empty() {
        reasons.push(
            "the model takes the levels of a factor to covary alike: degrees of freedom within subjects are multiplied by Greenhouse and \
             Geisser's epsilon of the complete subjects"
                .to_owned(),
        );
    }
    if !own_error.is_empty() {
        reasons.push(
            "each pair has an error of its own, over the spread of that difference between people"
                .to_owned(),
        );
    }
    let finding = MixedFinding { model, corrected, own_error };
    Ok(ByDesign::Mixed(Box::new(Chosen {
        chosen: ChosenTest::Mixed,
        reasons,
        checks: Vec::new(),
        found: finding,
    })))
}

/// Periods as the labels of a factor.
pub(super) fn labels(periods: &[usize]) -> Vec<Option<String>> {
    periods.iter().map(|period| Some(period.to_string())).collect()
}

/// A covariate, and the factors within subjects that it is multiplied by.
type Product<'a> = (&'a str, Vec<&'a str>);

/// The declared products.
///
/// # Errors
/// [`StatsError::Formula`] for one of another covariate, or of what is no effect within subjects.
pub(super) fn products<'a>(data: &DesignColumns<'a>) -> Result<Vec<Product<'a>>, StatsError> {
    let effects: Vec<Vec<&'a str>> = (1..1_usize << data.within.len())
        .map(|effect| {
            let factors = data.within.iter().enumerate();
            let factors = factors.filter(|(f, _)| effect >> f & 1 == 1);
            factors.map(|(_, (name, _))| *name).collect()
        })
        .collect();
    let mut products = Vec::new();
    for (covariate, with) in &data.with {
        let is_covariate = data.covariates.iter().any(|(name, _)| name == covariate);
        for effect in with {
            let factors = effects.iter().find(|e| e.join(":") == **effect);
            let Some(factors) = factors.filter(|_| is_covariate) else {
                let known: Vec<String> = effects.iter().map(|e| e.join(":")).collect();
                return Err(StatsError::formula(
                    format!("{covariate}:{effect}"),
                    format!("a covariate with an effect within subjects ({})", known.join(", ")),
                ));
            };
            products.push((*covariate, factors.clone()));
        }
    }
    Ok(products)
}

/// The terms that a factorial analysis of the complete subjects corrects for a lack of sphericity; none where nobody is complete.
fn corrected(data: &DesignColumns<'_>, model: &RandomIntercept) -> Named<CorrectedTerm> {
    let complete =
        FactorialDesign::from_columns(data.subjects, &data.within, &data.between, data.values);
    let Ok(complete) = complete.map(|design| factorial(&design)) else {
        return Named::from_iter([]);
    };
    let one = |(name, test): (&str, &TermTest)| {
        let epsilon = complete.sphericity.get(name)?.gg?;
        let (df1, df2) = (test.df1 as f64 * epsilon, test.df2? * epsilon);
        let p = f_upper(test.f, df1, df2);
        let term = CorrectedTerm { epsilon, df1, df2, p };
        Some((name.to_owned(), term))
    };
    model.anova.iter().filter_map(one).collect()
}
