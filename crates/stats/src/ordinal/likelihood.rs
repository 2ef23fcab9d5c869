//! The likelihood of a cumulative logit model with a random intercept, and its exact gradient.
//!
//! ln P(answer) splits into ln F at the threshold above, ln (1 - F) at the one below, and a part of both thresholds alone: the
//! first two are logistic terms ln F(s η), s = ±1, η = threshold - coefficient - σ v, with v ~ N(0, 1) a subject.

/// A logistic term of one answer.
#[derive(Debug, Clone, Copy)]
struct Term {
    /// 1 for the threshold above, -1 for the one below.
    sign: f64,
    threshold: usize,
    /// Parameters of its condition and its period; none of the first of each.
    effects: [Option<usize>; 2],
}

/// All answers, by subject.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    subjects: Vec<Vec<Term>>,
    /// How often each category lies between two thresholds, by the lower of them.
    between: Vec<f64>,
    categories: usize,
    /// Coefficients of conditions and periods.
    coefficients: usize,
    /// Share of the answers at or below each threshold.
    shares: Vec<f64>,
}

/// Nodes and weights, for an integrand scaled to exp(-z²).
pub(super) struct Rule {
    /// √2 z.
    nodes: Vec<f64>,
    /// w exp(z²) / √π.
    weights: Vec<f64>,
}

/// Positive nodes of Gauss-Hermite quadrature with ten, and their weights.
const TEN: [(f64, f64); 5] = [
    (0.342_901_327_223_704_6, 0.610_862_633_735_325_8),
    (1.036_610_829_789_513_7, 0.240_138_611_082_314_7),
    (1.756_683_649_299_881_8, 0.033_874_394_455_481_06),
    (2.532_731_674_232_79, 0.001_343_645_746_781_233),
    (3.436_159_118_837_737_6, 7.640_432_855_232_62e-6),
];

impl Rule {
    /// One node: Laplace's approximation.
    pub(super) fn laplace() -> Self {
        Self { nodes: vec![0.0], weights: vec![1.0] }
    }

    pub(super) fn ten_nodes() -> Self {
        let root = std::f64::consts::PI.sqrt();
        let (mut nodes, mut weights) = (Vec::new(), Vec::new());
        for (z, w) in TEN {
            for sign in [-1.0, 1.0] {
                nodes.push(sign * std::f64::consts::SQRT_2 * z);
                weights.push(w * libm::exp(z * z) / root);
            }
        }
        Self { nodes, weights }
    }
}

/// Sums over the terms of a subject at one v.
struct At {
    /// Σ ln F(s η) - v²/2.
    value: f64,
    /// Σ of the first, second and third derivative by η.
    d: [f64; 3],
}

impl Sample {
    /// `subjects`: category of each answer, and positions of its condition and its period; `levels`: how many of both there are.
    pub(super) fn new(
        subjects: Vec<Vec<(usize, [usize; 2])>>,
        categories: usize,
        levels: [usize; 2],
    ) -> Self {
        let mut between = vec![0.0; categories];
        let mut shares = vec![0.0; categories - 1];
        let count: usize = subjects.iter().map(Vec::len).sum();
        for &(category, _) in subjects.iter().flatten() {
            if category > 0 && category + 1 < categories {
                between[category - 1] += 1.0;
            }
            for share in &mut shares[category.min(categories - 1)..] {
                *share += 1.0 / count as f64;
            }
        }
        let first = [categories - 1, categories + levels[0] - 2];
        let terms = |rows: Vec<(usize, [usize; 2])>| {
            let of_answer = |(category, positions): (usize, [usize; 2])| {
                let effect =
                    |f: usize| positions[f].checked_sub(1).map(|position| first[f] + position);
                let term =
                    |sign, threshold| Term { sign, threshold, effects: [effect(0), effect(1)] };
                let above = (category + 1 < categories).then(|| term(1.0, category));
                let below = (category > 0).then(|| term(-1.0, category.wrapping_sub(1)));
                above.into_iter().chain(below)
            };
            rows.into_iter().flat_map(of_answer).collect()
        };
        Self {
            subjects: subjects.into_iter().map(terms).collect(),
            between,
            categories,
            coefficients: levels.map(|levels| levels.saturating_sub(1)).iter().sum(),
            shares,
        }
    }

    pub(super) fn thresholds(&self) -> usize {
        self.categories - 1
    }

    /// Thresholds, coefficients but those of the first condition and the first period, σ.
    pub(super) fn parameters(&self) -> usize {
        self.thresholds() + self.coefficients + 1
    }

    /// Thresholds of the pooled answers, no effects, σ = 1.
    pub(super) fn start(&self) -> Vec<f64> {
        let logit = |share: &f64| 1.15 * libm::log(share / (1.0 - share));
        let mut start: Vec<f64> = self.shares.iter().map(logit).collect();
        start.resize(self.parameters() - 1, 0.0);
        start.push(1.0);
        start
    }

    fn subject(
        terms: &[Term],
        rule: &Rule,
        parameters: &[f64],
        gradient: &mut [f64],
        work: &mut Work,
        mode: &mut f64,
    ) -> f64 {
        let sigma = parameters[parameters.len() - 1];
        work.etas.clear();
        for term in terms {
            let effects = term.effects.iter().flatten();
            let effect: f64 = effects.map(|&at| parameters[at]).sum();
            work.etas.push(parameters[term.threshold] - effect);
        }
        *mode = work.mode(terms, sigma, *mode);
        let mode = *mode;
        let top = work.at(terms, sigma, mode, true);
        let curvature = 1.0 - sigma * sigma * top.d[1];
        let spread = curvature.sqrt().recip();
        // Around the mode no term of the sum exceeds its weight.
        let (mut sum, mut pull, mut stretch, mut by_sigma) = (0.0, 0.0, 0.0, 0.0);
        work.mean.clear();
        work.mean.resize(terms.len(), 0.0);
        for (node, weight) in rule.nodes.iter().zip(&rule.weights) {
            let v = mode + spread * node;
            let point = work.at(terms, sigma, v, false);
            let share = weight * libm::exp(point.value - top.value);
            sum += share;
            let slope = share * (-sigma * point.d[0] - v);
            pull += slope;
            stretch += slope * node;
            by_sigma -= share * v * point.d[0];
            for (mean, d) in work.mean.iter_mut().zip(&work.first) {
                *mean += share * d;
            }
        }
        let (pull, stretch) = (pull / sum, stretch / sum);
        // A parameter moves the mode by h_vθ / curvature, and the spread by spread³ (h_vvθ + h_vvv dv) / 2.
        let third = -sigma.powi(3) * top.d[2];
        let by_spread = 0.5 * spread.powi(3) * (1.0 / spread + stretch);
        let by_mode = (pull + by_spread * third) / curvature;
        for (i, term) in terms.iter().enumerate() {
            let along = work.mean[i] / sum - by_mode * sigma * work.second[i]
                + by_spread * sigma * sigma * work.third[i];
            gradient[term.threshold] += along;
            for &at in term.effects.iter().flatten() {
                gradient[at] -= along;
            }
        }
        let last = gradient.len() - 1;
        gradient[last] += by_sigma / sum
            + by_mode * (sigma * mode * top.d[1] - top.d[0])
            + by_spread * (2.0 * sigma * top.d[1] - sigma * sigma * mode * top.d[2]);
        top.value + libm::log(spread * sum)
    }
}

/// The likelihood of a sample by one rule; remembers each subject's mode, near which the next one lies.
pub(super) struct Likelihood<'a> {
    sample: &'a Sample,
    rule: &'a Rule,
    modes: Vec<f64>,
    work: Work,
}

impl<'a> Likelihood<'a> {
    pub(super) fn new(sample: &'a Sample, rule: &'a Rule) -> Self {
        Self { sample, rule, modes: vec![0.0; sample.subjects.len()], work: Work::default() }
    }

    pub(super) fn sample(&self) -> &Sample {
        self.sample
    }

    /// Its logarithm at the parameters, with the gradient in `gradient`; `None` where thresholds are out of order.
    pub(super) fn at(&mut self, parameters: &[f64], gradient: &mut [f64]) -> Option<f64> {
        gradient.fill(0.0);
        let mut total = 0.0;
        for (lower, count) in self.sample.between.iter().enumerate().filter(|(_, n)| **n > 0.0) {
            let width = parameters[lower + 1] - parameters[lower];
            if width.is_nan() || width <= 0.0 {
                return None;
            }
            total += count * libm::log(-libm::expm1(-width));
            let slope = count / libm::expm1(width);
            gradient[lower + 1] += slope;
            gradient[lower] -= slope;
        }
        for (terms, mode) in self.sample.subjects.iter().zip(&mut self.modes) {
            total += Sample::subject(terms, self.rule, parameters, gradient, &mut self.work, mode);
        }
        total.is_finite().then_some(total)
    }
}

/// Numbers a term of the subject at hand.
#[derive(Default)]
struct Work {
    /// η without the subject.
    etas: Vec<f64>,
    /// First derivative by η at the last v.
    first: Vec<f64>,
    /// Second and third, at the mode.
    second: Vec<f64>,
    third: Vec<f64>,
    /// Mean of the first over the nodes.
    mean: Vec<f64>,
}

impl Work {
    fn at(&mut self, terms: &[Term], sigma: f64, v: f64, keep: bool) -> At {
        let mut sums = At { value: -0.5 * v * v, d: [0.0; 3] };
        self.first.clear();
        if keep {
            self.second.clear();
            self.third.clear();
        }
        let mut product = 1.0;
        for (term, eta) in terms.iter().zip(&self.etas) {
            let odds = libm::exp((term.sign * (eta - sigma * v)).clamp(-700.0, 700.0));
            let q = 1.0 / (1.0 + odds);
            product *= odds * q;
            if product < 1e-200 {
                sums.value += libm::log(product);
                product = 1.0;
            }
            let first = term.sign * q;
            let second = -q * (odds * q);
            sums.d[0] += first;
            sums.d[1] += second;
            self.first.push(first);
            if keep {
                let third = -term.sign * second * (1.0 - 2.0 * q);
                sums.d[2] += third;
                self.second.push(second);
                self.third.push(third);
            }
        }
        sums.value += libm::log(product);
        sums
    }

    /// Where value is largest: Newton's method from a point nearby, kept within what brackets the root of a falling slope.
    fn mode(&mut self, terms: &[Term], sigma: f64, near: f64) -> f64 {
        let reach = sigma.abs() * terms.len() as f64 + 1e-9;
        let (mut low, mut high, mut v) = (-reach, reach, near.clamp(-reach, reach));
        for _ in 0..200 {
            let point = self.at(terms, sigma, v, false);
            let slope = -sigma * point.d[0] - v;
            if slope > 0.0 {
                low = v;
            } else {
                high = v;
            }
            let step = slope / (1.0 - sigma * sigma * point.d[1]);
            let next = v + step;
            let inside = next > low && next < high;
            v = if inside { next } else { f64::midpoint(low, high) };
            if (inside && step.abs() < 1e-13 * (1.0 + v.abs())) || high - low < 1e-14 * reach {
                break;
            }
        }
        v
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Sample {
        let rows = vec![
            vec![(0, 0), (1, 1), (1, 2)],
            vec![(1, 0), (2, 1), (3, 2)],
            vec![(3, 0), (3, 1), (2, 2), (2, 0)],
            vec![(0, 0), (0, 1), (2, 2)],
        ];
        let of = |(category, condition): (usize, usize)| (category, [condition, 0]);
        let rows = rows.into_iter().map(|rows| rows.into_iter().map(of).collect());
        Sample::new(rows.collect(), 4, [3, 1])
    }

    #[test]
    fn the_nodes_integrate_polynomials_of_degree_nineteen() {
        let rule = Rule::ten_nodes();
        // Moments of the normal distribution: 1, 1, 3, 15, ... at even degrees.
        let mut exact = 1.0;
        for half in 0..10_i32 {
            let terms = rule.nodes.iter().zip(&rule.weights);
            let moment: f64 = terms.map(|(x, w)| w * (-0.5 * x * x).exp() * x.powi(2 * half)).sum();
            assert!((moment / exact - 1.0).abs() < 1e-12, "{half}");
            exact *= f64::from(2 * half + 1);
        }
    }

    #[test]
    fn the_gradient_is_that_of_the_value() {
        let sample = sample();
        let at = [-1.3, 0.2, 1.9, 0.6, -0.7, 1.2];
        for rule in [Rule::laplace(), Rule::ten_nodes()] {
            let mut gradient = vec![0.0; 6];
            Likelihood::new(&sample, &rule).at(&at, &mut gradient).unwrap();
            for j in 0..6 {
                let value = |step: f64| {
                    let mut moved = at;
                    moved[j] += step;
                    Likelihood::new(&sample, &rule).at(&moved, &mut [0.0; 6]).unwrap()
                };
                let slope = (value(1e-5) - value(-1e-5)) / 2e-5;
                assert!((slope - gradient[j]).abs() < 1e-8, "{j}: {slope} {}", gradient[j]);
            }
        }
    }

    #[test]
    fn without_people_who_differ_it_is_the_product_of_all_answers() {
        let at = [-1.3, 0.2, 1.9, 0.6, -0.7, 0.0];
        let found = Likelihood::new(&sample(), &Rule::ten_nodes()).at(&at, &mut [0.0; 6]).unwrap();
        let below = |j: usize, effect: f64| match j {
            0 => 0.0,
            4 => 1.0,
            j => 1.0 / (1.0 + (effect - at[j - 1]).exp()),
        };
        let effects = [0.0, 0.6, -0.7];
        let rows = [
            (0, 0),
            (1, 1),
            (1, 2),
            (1, 0),
            (2, 1),
            (3, 2),
            (3, 0),
            (3, 1),
            (2, 2),
            (2, 0),
            (0, 0),
            (0, 1),
            (2, 2),
        ];
        let exact: f64 = rows
            .iter()
            .map(|&(j, c): &(usize, usize)| (below(j + 1, effects[c]) - below(j, effects[c])).ln())
            .sum();
        assert!((found - exact).abs() < 1e-12);
    }
}
