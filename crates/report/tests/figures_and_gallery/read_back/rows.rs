//! Rows with their estimates and intervals.

use super::*;

fn row_interval([value, low, high]: [f64; 3], row: usize) -> [Drawn; 3] {
    [Drawn::InRow(value, row), Drawn::EndInRow(low, row), Drawn::EndInRow(high, row)]
}

#[test]
fn rows_hold_their_estimates_and_both_ends_of_their_intervals() {
    let forest = kinds::forest::input();
    let figure = figures::forest(&forest, &context()).unwrap();
    let rows = forest.rows.iter().enumerate();
    let expected = rows.flat_map(|(i, row)| row_interval(row.estimate.unwrap(), i)).collect();
    read_back(&figure, &[expected]);

    let few = kinds::intervals::input();
    let figure = figures::intervals::intervals("x", "X", &few, &context()).unwrap();
    let rows = few.rows.iter().enumerate();
    let expected = rows.flat_map(|(i, row)| {
        let (low, high) = row.interval.unwrap();
        let others =
            [Drawn::EndInRow(row.floor.unwrap(), i), Drawn::InRow(row.ceiling.unwrap(), i)];
        row_interval([row.estimate.unwrap(), low, high], i).into_iter().chain(others)
    });
    read_back(&figure, &[expected.collect()]);

    let family = kinds::family::input();
    let figure = figures::family(&family, &context()).unwrap();
    let expected = family.panels.iter().map(|panel| {
        let rows = panel.cells.iter().enumerate();
        let cells = rows.flat_map(|(i, row)| row.iter().flatten().map(move |cell| (i, *cell)));
        cells.flat_map(|(i, cell)| row_interval(cell, i)).collect()
    });
    read_back(&figure, &expected.collect::<Vec<_>>());

    let fidelity = kinds::fidelity::input();
    let figure = figures::fidelity(&fidelity, &context()).unwrap();
    let rows = fidelity.measures.iter().enumerate();
    let expected = rows.flat_map(|(i, row)| {
        let series = [Some(row.car), row.test_retest, row.population].into_iter().flatten();
        let paper = row.paper.map(|share| Drawn::InRow(100.0 * share, i));
        series
            .flat_map(move |a| row_interval([a.mean, a.low, a.high].map(|v| 100.0 * v), i))
            .chain(paper)
    });
    read_back(&figure, &[expected.collect()]);

    let rates = kinds::false_positives::input();
    let figure = figures::false_positives(&rates, &context()).unwrap();
    let parts = rates.parts.iter().enumerate();
    let tests =
        parts.flat_map(|(i, part)| part.rates.iter().map(move |rate| Drawn::InRow(*rate, i)));
    let families = rates.families.iter().enumerate();
    let families = families.flat_map(|(i, (_, rate, (low, high)))| {
        row_interval([*rate, *low, *high], rates.parts.len() + i)
    });
    read_back(&figure, &[tests.chain(families).collect()]);

    let errors = kinds::following_errors::input();
    let figure = figures::following_errors(&errors, &context()).unwrap();
    let expected = errors.models.iter().flat_map(|model| {
        let short = model.model == figures::car_following::Follower::IdmPopulation;
        let errors = model.gap_rmse_m.iter().enumerate();
        errors.map(
            move |(i, error)| {
                if short { Drawn::EndInRow(*error, i) } else { Drawn::InRow(*error, i) }
            },
        )
    });
    read_back(&figure, &[expected.collect()]);

    let ablation = kinds::ablation::input();
    let figure = figures::ablation(&ablation, &context()).unwrap();
    let expected = (0..ablation.losses.len()).map(|loss| {
        let reference = &ablation.variants[0].losses[loss];
        let variants = ablation.variants.iter().enumerate();
        let mean = variants.map(|(i, variant)| {
            let pairs = variant.losses[loss].iter().zip(reference);
            let differences: Vec<f64> = pairs.filter_map(|(a, b)| Some((*a)? - (*b)?)).collect();
            Drawn::InRow(differences.iter().sum::<f64>() / differences.len() as f64, i)
        });
        mean.collect()
    });
    read_back(&figure, &expected.collect::<Vec<_>>());
}
