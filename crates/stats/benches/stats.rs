//! Times of the main calls; run by hand with `cargo bench -p maveric-stats`.

use maveric_stats::{
    Adjustment, BootstrapData, BootstrapSettings, CorrelationMethod, PosthocTest, Statistic,
    WithinSubjects, bootstrap, compare, correlate, friedman, posthoc, rm_anova, within,
    within_without_exact,
};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

fn main() {
    divan::main();
}

/// Roughly normal values with one shifted condition.
fn table(n: usize, k: usize, decimals: f64) -> WithinSubjects {
    let mut generator = Pcg64::seed_from_u64(5);
    let mut uniform = || f64::from(generator.next_u32()) / f64::from(u32::MAX);
    let rows: Vec<Vec<f64>> = (0..n)
        .map(|_| {
            let own = uniform() * 3.0;
            (0..k)
                .map(|j| {
                    let noise: f64 = (0..6).map(|_| uniform()).sum();
                    ((own + noise + 0.3 * j as f64) * decimals).round() / decimals
                })
                .collect()
        })
        .collect();
    let names = |size: usize| -> Vec<String> { (0..size).map(|i| format!("n{i}")).collect() };
    WithinSubjects::from_rows(&names(k), &names(n), &rows).expect("the table is complete")
}

#[divan::bench(name = "stats/within/24x4")]
fn within_24(bencher: divan::Bencher) {
    let data = table(24, 4, 100.0);
    bencher.bench(|| within(&data));
}

#[divan::bench(name = "stats/within_without_exact/24x4")]
fn within_fast(bencher: divan::Bencher) {
    let data = table(24, 4, 100.0);
    bencher.bench(|| within_without_exact(&data));
}

#[divan::bench(name = "stats/spearman", args = [24, 10_000])]
fn spearman(bencher: divan::Bencher, n: usize) {
    let data = table(n, 2, 100.0);
    let column = |j: usize| data.column(j).into_iter().map(Some).collect::<Vec<_>>();
    let (x, y) = (column(0), column(1));
    bencher.bench(|| correlate(&x, &y, CorrelationMethod::Spearman, None));
}

#[divan::bench(name = "stats/rm_anova", args = [24, 10_000])]
fn anova(bencher: divan::Bencher, n: usize) {
    let data = table(n, 4, 100.0);
    bencher.bench(|| rm_anova(&data));
}

#[divan::bench(name = "stats/friedman_exact", args = [9, 24])]
fn friedman_exact(bencher: divan::Bencher, n: usize) {
    let data = table(n, 4, 1000.0);
    bencher.bench(|| friedman(&data));
}

#[divan::bench(name = "stats/friedman_exact_ties/24x4")]
fn friedman_ties(bencher: divan::Bencher) {
    let data = table(24, 4, 1.0);
    bencher.bench(|| friedman(&data));
}

#[divan::bench(name = "stats/wilcoxon_holm", args = [24, 10_000])]
fn wilcoxon(bencher: divan::Bencher, n: usize) {
    let data = table(n, 4, 100.0);
    bencher.bench(|| posthoc(&data, PosthocTest::Wilcoxon, Adjustment::default(), 0.05));
}

#[divan::bench(name = "stats/compare/24x4")]
fn compare_24(bencher: divan::Bencher) {
    let data = table(24, 4, 100.0);
    bencher.bench(|| compare(&data, 0.05));
}

#[divan::bench(name = "stats/bootstrap_eta2/24x4x10000")]
fn bootstrap_eta2(bencher: divan::Bencher) {
    let data = table(24, 4, 100.0);
    let settings = BootstrapSettings::default();
    bencher.bench(|| {
        bootstrap(
            Statistic::Eta2Partial,
            BootstrapData::Within(&data),
            &settings,
        )
    });
}
