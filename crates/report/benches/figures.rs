//! How long figures and tables take: `cargo bench -p maveric-report`.

#[path = "../examples/gallery/made_up.rs"]
mod made_up;

use maveric_report::{Context, Figure, render};

fn main() {
    divan::main();
}

fn context() -> Context {
    Context::synthetic(7)
}

/// What a run of the paper's pipeline draws.
const PAPER: [&str; 11] = [
    "aggression_line",
    "architecture",
    "calibration",
    "difference_panels",
    "domain",
    "embedding_space",
    "perpendicular",
    "preference",
    "residuals",
    "simulator_view",
    "training_curves",
];

fn paper() -> Vec<Figure> {
    let drawn = made_up::kinds::KINDS.iter().filter(|(name, _)| PAPER.contains(name));
    drawn.filter_map(|(_, draw)| draw(&context()).ok()).collect()
}

#[divan::bench(name = "report/svg/paper", sample_count = 10)]
fn svg_of_the_paper() -> Vec<Figure> {
    paper()
}

#[divan::bench(name = "report/svg/every", sample_count = 10)]
fn svg_of_every_figure() -> Option<Vec<Figure>> {
    made_up::kinds::figures(&context()).ok()
}

#[divan::bench(name = "report/png/paper", sample_count = 5)]
fn png_of_the_paper(bencher: divan::Bencher<'_, '_>) {
    bencher
        .with_inputs(paper)
        .bench_values(|figures| figures.iter().map(Figure::png).collect::<Result<Vec<_>, _>>());
}

/// The page, every figure as SVG and PNG, every table in four formats.
#[divan::bench(name = "report/everything/every", sample_count = 5)]
fn everything(bencher: divan::Bencher<'_, '_>) {
    bencher
        .with_inputs(|| made_up::report(&context()))
        .bench_values(|report| report.and_then(|report| render(&report)));
}

/// The same with the figures of the paper alone.
#[divan::bench(name = "report/everything/paper", sample_count = 5)]
fn everything_of_the_paper(bencher: divan::Bencher<'_, '_>) {
    bencher
        .with_inputs(|| {
            made_up::report(&context()).map(|mut report| {
                report.sections[0].figures = paper();
                report
            })
        })
        .bench_values(|report| report.and_then(|report| render(&report)));
}
