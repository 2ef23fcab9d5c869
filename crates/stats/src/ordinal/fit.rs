//! The top of the likelihood.

use super::likelihood::Likelihood;
use crate::numerics::{matrix::Matrix, moments::dot};

/// The highest point of a likelihood.
pub(super) struct Top {
    pub(super) parameters: Vec<f64>,
    pub(super) value: f64,
}

/// Beyond these, on the scale of the logit, an estimate grows without bound.
const LARGEST_ESTIMATE: f64 = 25.0;
const LARGEST_ERROR: f64 = 200.0;
const LARGEST_SD: f64 = 100.0;
/// An SD that is called zero: the likelihood is flat in its square.
const NO_SD: f64 = 1e-4;

impl Top {
    pub(super) fn sd(&self) -> f64 {
        self.parameters.last().copied().unwrap_or(0.0)
    }

    /// The estimate with its standard error; `None` where it grows without bound.
    pub(super) fn finite(&self, parameter: usize, se: Option<f64>) -> Option<(f64, Option<f64>)> {
        let finite = self.parameters[parameter].abs() < LARGEST_ESTIMATE
            && se.is_none_or(|se| se < LARGEST_ERROR);
        finite.then_some((self.parameters[parameter], se))
    }
}

/// Finds it by Newton's method, with the gradient's differences for its derivative; from a point nearby if one is known.
///
/// `None` if that does not settle.
pub(super) fn top(likelihood: &mut Likelihood, from: Option<&Top>) -> Option<Top> {
    let size = likelihood.sample().parameters();
    let mut parameters = likelihood.sample().start();
    if let Some(near) = from.filter(|near| near.sd() > NO_SD) {
        parameters.clone_from(&near.parameters);
    }
    let mut gradient = vec![0.0; size];
    let mut value = likelihood.at(&parameters, &mut gradient)?;
    let mut settled = false;
    for _ in 0..100 {
        let step = uphill(likelihood, &parameters, &gradient)?;
        let gain = dot(&step, &gradient);
        let mut share = 1.0;
        let (next, there) = loop {
            let next: Vec<f64> = parameters.iter().zip(&step).map(|(x, s)| x + share * s).collect();
            let there = likelihood.at(&next, &mut gradient);
            if let Some(there) = there.filter(|there| *there >= value + 1e-4 * share * gain - 1e-11)
            {
                break (next, there);
            }
            share *= 0.5;
            if share < 1e-8 {
                return None;
            }
        };
        (parameters, value) = (next, there);
        if gain < 1e-11 && share > 0.5 {
            settled = true;
            break;
        }
    }
    let sd = parameters[size - 1].abs();
    parameters[size - 1] = if sd < NO_SD { 0.0 } else { sd };
    if !settled || sd > LARGEST_SD {
        return None;
    }
    let value = likelihood.at(&parameters, &mut gradient)?;
    Some(Top { parameters, value })
}

/// -∂²/∂θ² by differences of the gradient, on both sides or on one.
fn information(
    likelihood: &mut Likelihood,
    parameters: &[f64],
    step: f64,
    gradient: Option<&[f64]>,
) -> Option<Matrix> {
    let size = parameters.len();
    let mut rows = Matrix::zeros(size, size);
    let (mut moved, mut up, mut down) = (parameters.to_vec(), vec![0.0; size], vec![0.0; size]);
    for j in 0..size {
        let h = step * (1.0 + parameters[j].abs());
        moved[j] = parameters[j] + h;
        likelihood.at(&moved, &mut up)?;
        let width = if let Some(gradient) = gradient {
            down.copy_from_slice(gradient);
            h
        } else {
            moved[j] = parameters[j] - h;
            likelihood.at(&moved, &mut down)?;
            2.0 * h
        };
        moved[j] = parameters[j];
        for i in 0..size {
            rows[(j, i)] = (down[i] - up[i]) / width;
        }
    }
    Some(Matrix::from(size, size, |i, j| 0.5 * (rows[(i, j)] + rows[(j, i)])))
}

/// Newton's step, bent towards the gradient where the likelihood is not concave, and no longer than a few logits.
fn uphill(likelihood: &mut Likelihood, parameters: &[f64], gradient: &[f64]) -> Option<Vec<f64>> {
    let size = parameters.len();
    let information = information(likelihood, parameters, 1e-6, Some(gradient))?;
    let slope = Matrix::from(size, 1, |i, _| gradient[i]);
    let mut ridge = 0.0;
    for _ in 0..60 {
        let mut bent = information.clone();
        for i in 0..size {
            bent[(i, i)] += ridge;
        }
        if let Some(factor) = bent.cholesky() {
            let step = factor.solve(&slope);
            let step: Vec<f64> = (0..size).map(|i| step[(i, 0)]).collect();
            let longest = step.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
            let share = (3.0 / longest).min(1.0);
            return Some(step.into_iter().map(|s| share * s).collect());
        }
        ridge = if ridge > 0.0 { 4.0 * ridge } else { 1e-3 };
    }
    None
}

/// Standard errors of combinations of the parameters at the top, from the observed information.
pub(super) struct Errors {
    /// Of the parameters that are estimated: at 0 the SD is not, and has nothing to do with the others.
    inverse: Option<Matrix>,
}

impl Errors {
    pub(super) fn at(likelihood: &mut Likelihood, parameters: &[f64]) -> Self {
        let free = parameters.len() - usize::from(parameters[parameters.len() - 1].abs() < NO_SD);
        let inverse = information(likelihood, parameters, 1e-4, None).and_then(|all| {
            let part = Matrix::from(free, free, |i, j| all[(i, j)]);
            Some(part.cholesky()?.inverse())
        });
        Self { inverse }
    }

    pub(super) fn of_parameter(&self, parameter: usize) -> Option<f64> {
        self.of_difference(Some(parameter), None)
    }

    /// Of one parameter less another; none of the two is 0, as the reference's.
    pub(super) fn of_difference(&self, a: Option<usize>, b: Option<usize>) -> Option<f64> {
        let inverse = self.inverse.as_ref()?;
        let known = |i: Option<usize>| i.is_none_or(|i| i < inverse.rows);
        let entry =
            |i: Option<usize>, j: Option<usize>| i.zip(j).map_or(0.0, |place| inverse[place]);
        let variance = || entry(a, a) + entry(b, b) - 2.0 * entry(a, b);
        let variance = (known(a) && known(b)).then(variance)?;
        Some(variance.sqrt()).filter(|se| se.is_finite() && *se > 0.0)
    }
}
