//! Variances of u that several random columns share: of the subjects, and of the subjects at each level of a factor.

use super::{Fit, MixedMethod, blocks::Blocks, profile};
use crate::numerics::{
    matrix::Matrix,
    minimise::{decades, minimise},
};

/// What the degrees of freedom are where a variance has its top at 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AtZero {
    /// Those of the model without it: the error is pooled, as lmerTest has it.
    Pooled,
    /// Those of the effect's own stratum: a variance that is 0 by chance lends nobody its degrees of freedom.
    Strata,
}

/// The random columns of each variance; the columns of one are uncorrelated and vary alike, those of two are uncorrelated.
pub(super) struct Components(Vec<Vec<usize>>);

impl Components {
    /// `sizes` columns of each, one after the other.
    pub(super) fn of_sizes(sizes: &[usize]) -> Self {
        let mut next = 0..;
        Self(sizes.iter().map(|&n| next.by_ref().take(n).collect()).collect())
    }

    /// The entries of Ψ at which each variance stands.
    pub(super) fn entries(&self) -> Vec<Vec<(usize, usize)>> {
        let diagonal = |columns: &Vec<usize>| columns.iter().map(|&c| (c, c)).collect();
        self.0.iter().map(diagonal).collect()
    }

    /// Each variance over that of a residual.
    pub(super) fn ratios(&self, l: &Matrix) -> Vec<f64> {
        let first = |columns: &Vec<usize>| l[(columns[0], columns[0])].powi(2);
        self.0.iter().map(first).collect()
    }

    pub(super) fn some_is_zero(&self, l: &Matrix) -> bool {
        self.ratios(l).iter().any(|ratio| *ratio <= 0.0)
    }

    /// The fit at given ratios of the standard deviations of u and ε.
    pub(super) fn at(&self, blocks: &Blocks, theta: &[f64]) -> Option<Fit> {
        let mut l = Matrix::zeros(blocks.q, blocks.q);
        for (columns, &theta) in self.0.iter().zip(theta) {
            for &c in columns {
                l[(c, c)] = theta;
            }
        }
        profile(blocks, l, MixedMethod::Reml)
    }

    /// The top of the restricted likelihood, to its last digits; a variance whose top is at 0 is exactly 0.
    pub(super) fn top(&self, blocks: &Blocks) -> Option<Fit> {
        let deviance_of = |blocks: &Blocks, theta: &[f64]| {
            self.at(blocks, theta).map_or(f64::MAX, |fit| fit.deviance)
        };
        let count = self.0.len();
        // Each in its own unit: people may differ a million times more than their rows.
        let units = (0..count).fold(vec![1.0; count], |units, k| {
            let start = |factor: f64| with(&units, &[(k, factor)]);
            let theta = |factor: f64| times(&[START].repeat(count), &start(factor));
            let value = |factor: f64| deviance_of(blocks, &theta(factor));
            with(&units, &[(k, decades(value))])
        });
        let in_units = |theta: &[f64]| deviance_of(blocks, &times(theta, &units));
        let (found, _) = minimise(&[START].repeat(count), 0.4, 1e-10, in_units);
        let mut theta = times(&found, &units);
        // From here on of what those coefficients leave: a deviance with all of its digits.
        let near = self.at(blocks, &theta)?.beta;
        let rest = blocks.less(&near);
        let deviance = |theta: &[f64]| deviance_of(&rest, theta);
        let mut lowest = deviance(&theta);
        for k in 0..theta.len() {
            let without = with(&theta, &[(k, 0.0)]);
            let there = deviance(&without);
            if there <= lowest + 1e-9 {
                (theta, lowest) = (without, there.min(lowest));
            } else {
                theta[k] = theta[k].abs();
            }
        }
        for _ in 0..4 {
            let Some(next) = newton(&theta, &deviance) else {
                break;
            };
            // Rounding of the deviance may hide which of the two is lower.
            let there = deviance(&next);
            if there > lowest + 1e-9 {
                break;
            }
            (theta, lowest) = (next, there.min(lowest));
        }
        let mut fit = self.at(&rest, &theta)?;
        fit.beta.add(&near, 1.0);
        Some(fit)
    }
}

/// Where the search for the ratios starts, in their units.
const START: f64 = 0.7;

fn times(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

fn with(theta: &[f64], values: &[(usize, f64)]) -> Vec<f64> {
    let mut theta = theta.to_vec();
    for &(k, value) in values {
        theta[k] = value;
    }
    theta
}

/// Newton's next point among those that keep zeros at zero, by differences; none where the function is not curved upwards.
fn newton(theta: &[f64], value: &impl Fn(&[f64]) -> f64) -> Option<Vec<f64>> {
    let free: Vec<usize> = (0..theta.len()).filter(|&k| theta[k] > 0.0).collect();
    let step = |k: usize| 1e-4 * theta[k];
    let centre = value(theta);
    let moved = |signs: &[(usize, f64)]| {
        let values: Vec<(usize, f64)> =
            signs.iter().map(|&(k, sign)| (k, theta[k] + sign * step(k))).collect();
        value(&with(theta, &values))
    };
    let n = free.len();
    let mut slope = Matrix::zeros(n, 1);
    let mut curvature = Matrix::zeros(n, n);
    for (a, &i) in free.iter().enumerate() {
        let (low, high) = (moved(&[(i, -1.0)]), moved(&[(i, 1.0)]));
        slope[(a, 0)] = (high - low) / (2.0 * step(i));
        curvature[(a, a)] = (high - 2.0 * centre + low) / (step(i) * step(i));
        for (b, &j) in free[..a].iter().enumerate() {
            let corner = |x: f64, y: f64| moved(&[(i, x), (j, y)]);
            let twist =
                corner(1.0, 1.0) - corner(1.0, -1.0) - corner(-1.0, 1.0) + corner(-1.0, -1.0);
            let mixed = twist / (4.0 * step(i) * step(j));
            curvature[(a, b)] = mixed;
            curvature[(b, a)] = mixed;
        }
    }
    let change = curvature.cholesky()?.solve(&slope);
    let next: Vec<(usize, f64)> =
        free.iter().enumerate().map(|(a, &k)| (k, theta[k] - change[(a, 0)])).collect();
    let valid = next.iter().all(|(_, value)| value.is_finite() && *value > 0.0);
    valid.then(|| with(theta, &next))
}

#[cfg(test)]
mod tests {
    use crate::{
        Factorial, FactorialDesign, Named, Predictor, RandomIntercept, StatsError, factorial,
        random_by_factor, random_intercept,
    };

    /// People in two groups, each in 2 x 3 cells: `spread` of levels, of the effect of `style`, of `light`, and of a row.
    struct Made {
        people: Vec<String>,
        group: Vec<Option<String>>,
        style: Vec<String>,
        light: Vec<String>,
        y: Vec<Option<f64>>,
    }

    const BY: [&str; 2] = ["style", "light"];

    fn made(people: usize, spread: [f64; 4]) -> Made {
        // Numbers without a pattern between -1 and 1.
        let drawn = |seed: usize| (libm::sin(seed as f64 * 12.9898) * 43758.547).fract();
        let mut made = Made {
            people: Vec::new(),
            group: Vec::new(),
            style: Vec::new(),
            light: Vec::new(),
            y: Vec::new(),
        };
        for person in 0..people {
            for style in 0..2 {
                for light in 0..3 {
                    let y = spread[0] * drawn(person + 1)
                        + spread[1] * drawn(100 + 2 * person + style)
                        + spread[2] * drawn(500 + 3 * person + light)
                        + spread[3] * drawn(900 + 6 * person + 3 * style + light)
                        + 0.3 * style as f64;
                    made.people.push(format!("P{person}"));
                    made.group.push(Some(["a", "b"][person % 2].to_owned()));
                    made.style.push(["calm", "sporty"][style].to_owned());
                    made.light.push(["day", "dusk", "night"][light].to_owned());
                    made.y.push(Some(y));
                }
            }
        }
        made
    }

    fn some(labels: &[String]) -> Vec<Option<String>> {
        labels.iter().cloned().map(Some).collect()
    }

    fn model(made: &Made, by: &[&str]) -> Result<RandomIntercept, StatsError> {
        let (style, light) = (some(&made.style), some(&made.light));
        let predictors = [
            ("group", Predictor::Factor(&made.group)),
            ("style", Predictor::Factor(&style)),
            ("light", Predictor::Factor(&light)),
        ];
        let formula = "group*style*light".parse()?;
        random_by_factor(&made.people, &formula, by, &predictors, &made.y)
    }

    fn strata(made: &Made) -> Factorial {
        let within = [("style", &made.style[..]), ("light", &made.light[..])];
        let between = [("group", &made.group[..])];
        let design = FactorialDesign::from_columns(&made.people, &within, &between, &made.y);
        factorial(&design.unwrap())
    }

    fn effects(table: &Factorial) -> impl Iterator<Item = (&str, f64, f64)> {
        table.anova.iter().map(|(name, effect)| (name, effect.f.unwrap(), effect.df2 as f64))
    }

    #[test]
    fn complete_data_give_the_analysis_of_variance_by_strata() {
        for people in [8, 16] {
            let made = made(people, [3.0, 2.0, 1.5, 0.7]);
            let (fit, table) = (model(&made, &BY).unwrap(), strata(&made));
            assert!(fit.variance_by.values().all(|variance| *variance > 0.0));
            assert_eq!(fit.anova.len(), 7);
            for (name, f, df2) in effects(&table) {
                let term = fit.anova.get(name).unwrap();
                let p = table.anova.get(name).unwrap().p.unwrap();
                assert!((term.f / f - 1.0).abs() < 1e-6, "{name}: {} {f}", term.f);
                assert!((term.df2.unwrap() / df2 - 1.0).abs() < 1e-6, "{name}");
                assert!((term.p.unwrap() / p - 1.0).abs() < 1e-6, "{name}");
            }
        }
    }

    #[test]
    fn a_variance_at_zero_lends_nobody_its_degrees_of_freedom() {
        // People who differ in their level alone.
        let made = made(8, [3.0, 0.0, 0.0, 1.0]);
        let (fit, table) = (model(&made, &BY).unwrap(), strata(&made));
        let zeros = fit.variance_by.values().filter(|v| **v <= 0.0).count();
        assert!(zeros > 0, "{:?}", fit.variance_by);
        assert_eq!(fit.variance_by.len(), 2);
        for (name, _, df2) in effects(&table) {
            let df = fit.anova.get(name).unwrap().df2.unwrap();
            assert!((df / df2 - 1.0).abs() < 1e-6, "{name}: {df} {df2}");
        }
    }

    #[test]
    fn an_effect_that_differs_between_people_is_not_tested_over_the_residual() {
        let made = made(12, [1.0, 4.0, 0.0, 0.5]);
        let fit = model(&made, &BY).unwrap();
        let style = fit.anova.get("style").unwrap();
        let (plain, by_style) = (model(&made, &[]).unwrap(), model(&made, &["style"]).unwrap());
        assert!(plain.anova.get("style").unwrap().df2.unwrap() > 40.0);
        for df in [style.df2.unwrap(), by_style.anova.get("style").unwrap().df2.unwrap()] {
            assert!((df - 10.0).abs() < 1e-6, "{df}");
        }
    }

    #[test]
    fn somebody_with_a_missing_cell_stays() {
        let mut made = made(12, [3.0, 2.0, 1.5, 0.7]);
        made.y[4] = None;
        made.y[31] = None;
        let fit = model(&made, &BY).unwrap();
        assert_eq!((fit.n_obs, fit.n_subjects, fit.missing), (70, 12, 2));
        let whole: Vec<f64> = fit.anova.values().map(|term| term.df2.unwrap()).collect();
        // Between 10 (people less groups) and what complete cells would leave.
        assert!(whole.iter().all(|df| (9.0..20.5).contains(df)), "{whole:?}");
    }

    #[test]
    fn the_order_of_rows_changes_nothing() {
        // With gaps: else all axes of a term have the same degrees of freedom.
        let mut forth = made(10, [3.0, 2.0, 1.5, 0.7]);
        for row in [4, 17, 18, 33] {
            forth.y[row] = None;
        }
        let mut back = made(10, [0.0; 4]);
        back.y.clone_from(&forth.y);
        back.people.reverse();
        back.group.reverse();
        back.style.reverse();
        back.light.reverse();
        back.y.reverse();
        let (forth, back) = (model(&forth, &BY).unwrap(), model(&back, &BY).unwrap());
        for (name, a) in forth.anova.iter() {
            let b = back.anova.get(name).unwrap();
            assert!((a.f / b.f - 1.0).abs() < 1e-8, "{name}");
            assert!((a.df2.unwrap() / b.df2.unwrap() - 1.0).abs() < 1e-8, "{name}");
        }
    }

    #[test]
    fn a_factor_whose_every_row_is_a_level_of_its_own_is_the_residual() {
        let made = made(8, [2.0, 0.0, 1.0, 1.0]);
        let day: Vec<usize> = (0..made.y.len()).filter(|i| i % 6 < 3).collect();
        let people: Vec<String> = day.iter().map(|&i| made.people[i].clone()).collect();
        let light: Vec<_> = day.iter().map(|&i| Some(made.light[i].clone())).collect();
        let y: Vec<_> = day.iter().map(|&i| made.y[i]).collect();
        let predictors = [("light", Predictor::Factor(&light))];
        let formula = "light".parse().unwrap();
        let by = random_by_factor(&people, &formula, &["light"], &predictors, &y).unwrap();
        let plain = random_intercept(&people, &formula, &predictors, &y).unwrap();
        assert_eq!(by.variance_by, Named::default());
        assert_eq!(by.anova, plain.anova);
    }

    #[test]
    fn a_name_that_is_no_factor_is_refused() {
        let refused = model(&made(6, [1.0; 4]), &["speed"]).unwrap_err();
        assert!(matches!(refused, StatsError::Formula { text, .. } if text == "speed"));
    }
}
