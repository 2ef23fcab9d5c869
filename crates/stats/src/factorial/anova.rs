//! F of every effect.

use serde::{Deserialize, Serialize};

use super::{
    Effect,
    cells::{Cells, Rows, average, contrasts, products, unit_average},
};
use crate::{
    Interval, Mauchly, Named, Reasons, Sphericity,
    numerics::{distributions::f_upper, moments::dot, noncentral::f_ncp_interval},
    sphericity,
};

/// One effect of a factorial design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FactorialEffect {
    /// Mean square of the effect over that of its error.
    #[serde(rename = "F")]
    pub f: Option<f64>,
    /// Degrees of freedom of the effect.
    pub df1: usize,
    /// Of its error: (n - groups) times those of the part within subjects.
    pub df2: usize,
    /// P(F' ≥ F) if sphericity holds.
    pub p: Option<f64>,
    /// Type III sum of squares.
    pub ss: f64,
    /// Sum of squares of the error that `f` is over.
    pub ss_error: f64,
    /// SS / (SS + SSe).
    pub eta2_partial: Option<f64>,
    /// Its 90 % interval, by the noncentral F: ncp / (ncp + df2).
    #[serde(flatten, with = "crate::interval::eta2_partial_ci90")]
    pub eta2_partial_ci90: Interval,
    /// SS / (SS + all error sums of squares), every factor counted as manipulated.
    pub eta2_generalized: Option<f64>,
    /// Its 90 % interval: the limits ncp MSe in the place of SS, the errors as observed.
    #[serde(flatten, with = "crate::interval::eta2_generalized_ci90")]
    pub eta2_generalized_ci90: Interval,
    /// With a factor within subjects (SS - df1 MSe) / (SS + SSe + SSs + MSs), s the subjects within groups; between subjects
    /// (SS - df1 MSs) / (SS + (n - df1) MSs). It may be negative.
    pub omega2_partial: Option<f64>,
}

pub(super) struct Tests {
    pub(super) anova: Named<FactorialEffect>,
    pub(super) sphericity: Named<Sphericity>,
    pub(super) mauchly: Named<Mauchly>,
}

/// Sums of squares of one effect, and the residuals of its contrasts within subjects.
pub(super) struct Sums {
    pub(super) ss: f64,
    pub(super) ss_error: f64,
    pub(super) df1: usize,
    pub(super) df2: usize,
    errors: Rows,
}

impl Effect {
    /// Weights of the groups and of the cells that the effect compares.
    pub(super) fn rows(self, cells: &Cells) -> (Rows, Rows) {
        let design = cells.design;
        let between = design.between.iter().enumerate().map(|(f, factor)| {
            let k = factor.levels.len();
            if self.has(f) { contrasts(k) } else { average(k) }
        });
        let first = design.between.len();
        let within = design.within.iter().enumerate().map(|(f, factor)| {
            let k = factor.levels.len();
            if self.has(first + f) { contrasts(k) } else { unit_average(k) }
        });
        let (between, within): (Vec<Rows>, Vec<Rows>) = (between.collect(), within.collect());
        (products(&between), products(&within))
    }

    pub(super) fn sums(self, cells: &Cells) -> Sums {
        let (groups, within) = self.rows(cells);
        let errors: Rows = within.iter().map(|row| cells.error(row)).collect();
        Sums {
            ss: cells.hypothesis(&groups, &within),
            ss_error: errors.iter().map(|e| dot(e, e)).sum(),
            df1: groups.len() * within.len(),
            df2: cells.freedom * within.len(),
            errors,
        }
    }

    pub(super) fn is_within(self, cells: &Cells) -> bool {
        self.0 >> cells.design.between.len() != 0
    }
}

/// The error sums of squares of the subjects, and of all strata within subjects together.
pub(super) fn errors(cells: &Cells) -> (f64, f64) {
    let levels = cells.design.within.iter().map(|f| f.levels.len());
    let rows = levels.map(|k| [unit_average(k), contrasts(k)].concat());
    // The first row is the mean of all cells.
    let squares = products(&rows.collect::<Vec<_>>());
    let squares: Vec<f64> = squares.iter().map(|row| cells.error_square(row)).collect();
    (squares[0], squares[1..].iter().sum())
}

pub(super) fn tests(cells: &Cells, undefined: &mut Reasons) -> Tests {
    let (mut anova, mut epsilons, mut mauchly) = (Vec::new(), Vec::new(), Vec::new());
    let (subjects, within) = errors(cells);
    for effect in Effect::all(cells.design) {
        let name = effect.name(cells.design);
        let sums = effect.sums(cells);
        let test = describe(effect, cells, &sums, subjects, subjects + within);
        let test = undefined.result(&format!("anova.{name}"), test);
        if sums.errors.len() > 1 {
            let spectrum =
                sphericity::Spectrum::new(sums.errors, cells.freedom, cells.design.cells());
            let sphericity = undefined.result(&format!("mauchly.{name}"), spectrum.mauchly());
            mauchly.push((name.clone(), sphericity));
            let epsilon = spectrum.corrections(test.f, test.df1, test.df2);
            let epsilon = undefined.result(&format!("sphericity.{name}"), epsilon);
            epsilons.push((name.clone(), epsilon));
        }
        anova.push((name, test));
    }
    Tests {
        anova: anova.into_iter().collect(),
        sphericity: epsilons.into_iter().collect(),
        mauchly: mauchly.into_iter().collect(),
    }
}

fn describe(
    effect: Effect,
    cells: &Cells,
    sums: &Sums,
    subjects: f64,
    all_errors: f64,
) -> (FactorialEffect, Reasons) {
    let mut reasons = Reasons::default();
    let (ss, ss_error) = (sums.ss, sums.ss_error);
    let (d1, d2) = (sums.df1 as f64, sums.df2 as f64);
    let ms_error = ss_error / d2;
    let f = (ss_error > 0.0).then(|| ss / d1 / ms_error).filter(|f| f.is_finite());
    let interval = f.and_then(|f| f_ncp_interval(f, d1, d2, 0.05));
    if f.is_none() {
        let reason = "the error sum of squares is zero, so F has no finite value";
        reasons.note_all(&["F", "p", "omega2_partial"], reason);
    }
    if interval.is_none() {
        let intervals = ["eta2_partial_ci90", "eta2_generalized_ci90"];
        reasons.note_ends(&intervals, "there is no F to invert");
    }
    if ss + ss_error <= 0.0 {
        reasons.note("eta2_partial", "neither effect nor error varies: it is 0/0");
    }
    if ss + all_errors <= 0.0 {
        let reason = "neither effect nor errors vary: it is 0/0";
        reasons.note("eta2_generalized", reason);
    }
    let ms_subjects = subjects / cells.freedom as f64;
    let below = if effect.is_within(cells) {
        ss + ss_error + subjects + ms_subjects
    } else {
        ss + (cells.design.n() as f64 - d1) * ms_subjects
    };
    let partial = |ncp: f64| ncp / (ncp + d2);
    let generalized = |ncp: f64| ncp * ms_error / (ncp * ms_error + all_errors);
    let interval = Interval::from(interval);
    let test = FactorialEffect {
        f,
        df1: sums.df1,
        df2: sums.df2,
        p: f.map(|f| f_upper(f, d1, d2)),
        ss,
        ss_error,
        eta2_partial: (ss + ss_error > 0.0).then(|| ss / (ss + ss_error)),
        eta2_partial_ci90: interval.map(partial),
        eta2_generalized: (ss + all_errors > 0.0).then(|| ss / (ss + all_errors)),
        eta2_generalized_ci90: interval.map(generalized),
        omega2_partial: f.map(|_| (ss - d1 * ms_error) / below),
    };
    (test, reasons)
}
