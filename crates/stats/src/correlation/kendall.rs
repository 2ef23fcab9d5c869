//! Kendall's τ-b.

use serde::{Deserialize, Serialize};

use crate::{
    Interval, PMethod, Reasons,
    numerics::{decimal::tied, distributions::normal_two_sided},
    ranks,
};

/// Kendall's τ-b.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Kendall {
    /// (concordant - discordant) / √((pairs - tied in x)(pairs - tied in y)).
    pub tau_b: Option<f64>,
    /// Exact without ties below 50 pairs, as R; else normal with ties corrected.
    pub p: Option<f64>,
    /// Which of the two.
    pub p_method: Option<PMethod>,
    /// The 95 % interval: Fisher's z with variance 0.437/(n-4) (Fieller et
    /// al., 1957).
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
}

/// Tie sums of one column: Σ t(t-1)/2, Σ t(t-1)(t-2), Σ t(t-1)(2t+5).
fn tie_sums(values: &[f64]) -> (f64, f64, f64) {
    let (mut ranks, _) = ranks::doubled(values);
    ranks.sort_unstable();
    ranks.chunk_by(|a, b| a == b).map(|g| g.len() as f64).fold((0.0, 0.0, 0.0), |(a, b, c), t| {
        let pairs = t * (t - 1.0);
        (a + 0.5 * pairs, b + pairs * (t - 2.0), c + pairs * (2.0 * t + 5.0))
    })
}

pub(super) fn test(x: &[f64], y: &[f64]) -> (Kendall, Reasons) {
    let mut reasons = Reasons::default();
    let (x, y) = (tied(x), tied(y));
    let n = x.len() as f64;
    let pairs = 0.5 * n * (n - 1.0);
    let ((tied_x, x1, x2), (tied_y, y1, y2)) = (tie_sums(&x), tie_sums(&y));
    if tied_x >= pairs || tied_y >= pairs {
        reasons.note("", "a column does not vary, so tau is 0/0");
        return (Kendall::default(), reasons);
    }
    let (mut concordant, mut discordant) = (0_u64, 0_u64);
    for i in 0..x.len() {
        for j in 0..i {
            let product = order(x[i], x[j]) * order(y[i], y[j]);
            concordant += u64::from(product > 0);
            discordant += u64::from(product < 0);
        }
    }
    let difference = concordant as f64 - discordant as f64;
    let (untied_x, untied_y) = (pairs - tied_x, pairs - tied_y);
    // Counts, so that all pairs in one order are told from nearly all.
    let tau = if difference * difference >= untied_x * untied_y {
        1.0_f64.copysign(difference)
    } else {
        difference / (untied_x.sqrt() * untied_y.sqrt())
    };
    let untied = tied_x + tied_y <= 0.0;
    let (p, method) = if untied && x.len() < 50 {
        (exact(x.len(), concordant.min(discordant) as usize), PMethod::Exact)
    } else {
        let mixed = if n > 2.0 { x1 * y1 / (9.0 * n * (n - 1.0) * (n - 2.0)) } else { 0.0 };
        let variance = (n * (n - 1.0) * (2.0 * n + 5.0) - x2 - y2) / 18.0
            + 2.0 * tied_x * tied_y / (n * (n - 1.0))
            + mixed;
        (normal_two_sided(difference / variance.sqrt()), PMethod::Normal)
    };
    let interval = (n > 4.0 && tau.abs() < 1.0)
        .then(|| super::fisher_interval(tau, (0.437 / (n - 4.0)).sqrt()));
    if interval.is_none() {
        let reason = "the interval needs at least five pairs and a tau inside -1 to 1";
        reasons.note_ends(&["ci"], reason);
    }
    let result =
        Kendall { tau_b: Some(tau), p: Some(p), p_method: Some(method), ci: interval.into() };
    (result, reasons)
}

fn order(a: f64, b: f64) -> i32 {
    i32::from(a > b) - i32::from(a < b)
}

/// Twice P(inversions ≤ `fewer`) among all orders of n.
fn exact(n: usize, fewer: usize) -> f64 {
    let mut mass = vec![0.0; fewer + 1];
    mass[0] = 1.0;
    for size in 2..=n {
        // The next element adds 0 to size-1 inversions, each as likely.
        let mut window = 0.0;
        let before = mass.clone();
        for (count, into) in mass.iter_mut().enumerate() {
            window += before[count];
            if count >= size {
                window -= before[count - size];
            }
            *into = window / size as f64;
        }
    }
    (2.0 * mass.iter().sum::<f64>()).min(1.0)
}
