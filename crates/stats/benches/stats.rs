//! Times of the main calls; run by hand with `cargo bench -p maveric-stats`.

use maveric_stats::{
    Adjustment, BootstrapData, BootstrapSettings, CorrelationMethod, FactorialDesign, Formula,
    PosthocTest, Predictor, Statistic, WithinSubjects, aligned_ranks, bootstrap, compare,
    correlate, factorial, friedman, groups, ordinal, posthoc, random_intercept, rm_anova, within,
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
            let person_level = uniform() * 3.0;
            (0..k)
                .map(|j| {
                    let noise: f64 = (0..6).map(|_| uniform()).sum();
                    ((person_level + noise + 0.3 * j as f64) * decimals).round() / decimals
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
    bencher.bench(|| bootstrap(Statistic::Eta2Partial, BootstrapData::Within(&data), &settings));
}

/// A long table: subjects, names of the columns of `data`, values.
fn long(data: &WithinSubjects) -> (Vec<String>, Vec<String>, Vec<Option<f64>>) {
    let (mut subjects, mut conditions, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for (subject, row) in data.subjects().iter().zip(data.rows()) {
        for (condition, value) in data.conditions().iter().zip(row) {
            subjects.push(subject.clone());
            conditions.push(condition.clone());
            values.push(Some(*value));
        }
    }
    (subjects, conditions, values)
}

/// 24 subjects in 2 x 2 cells.
fn two_by_two() -> FactorialDesign {
    let (subjects, cells, values) = long(&table(24, 4, 100.0));
    let level = |bit: usize| -> Vec<String> {
        let digit = |cell: &String| cell[1..].parse::<usize>().expect("a number") >> bit & 1;
        cells.iter().map(|cell| digit(cell).to_string()).collect()
    };
    let (a, b) = (level(1), level(0));
    FactorialDesign::from_columns(&subjects, &[("a", &a), ("b", &b)], &[], &values)
        .expect("the table is complete")
}

#[divan::bench(name = "stats/factorial/24x(2x2)")]
fn factorial_24(bencher: divan::Bencher) {
    let design = two_by_two();
    bencher.bench(|| factorial(&design));
}

#[divan::bench(name = "stats/aligned_ranks/24x(2x2)")]
fn aligned_ranks_24(bencher: divan::Bencher) {
    let design = two_by_two();
    bencher.bench(|| aligned_ranks(&design));
}

#[divan::bench(name = "stats/ordinal/24x4")]
fn ordinal_24(bencher: divan::Bencher) {
    let (subjects, conditions, values) = long(&table(24, 4, 1.0));
    bencher.bench(|| ordinal(&subjects, &conditions, &values));
}

#[divan::bench(name = "stats/random_intercept/24x4")]
fn mixed_24(bencher: divan::Bencher) {
    let (subjects, conditions, values) = long(&table(24, 4, 100.0));
    let conditions: Vec<Option<String>> = conditions.into_iter().map(Some).collect();
    let formula: Formula = "condition".parse().expect("a formula");
    let predictors = [("condition", Predictor::Factor(&conditions))];
    bencher.bench(|| random_intercept(&subjects, &formula, &predictors, &values));
}

#[divan::bench(name = "stats/groups/3x24")]
fn groups_72(bencher: divan::Bencher) {
    let (_, names, values) = long(&table(24, 3, 100.0));
    bencher.bench(|| groups(&names, &values));
}
