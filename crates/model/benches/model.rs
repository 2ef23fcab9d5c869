//! Training and predicting on small drives made by hand. Run with `cargo bench -p maveric-model`.

#[path = "../tests/support/drives.rs"]
mod drives;

use divan::{Bencher, counter::ItemsCount};
use maveric_model::{Model, Predictor, TrainSettings, TrainingDrive, train};
use std::ops::ControlFlow;

fn main() {
    divan::main();
}

fn trained(drives: &[drives::Scored], epochs: usize, batch_size: usize) -> (Model, usize) {
    let given: Vec<_> = drives.iter().map(TrainingDrive::from).collect();
    let settings = TrainSettings {
        heads: maveric_model::HeadsKind::Paper,
        epochs,
        batch_size,
        validation_fraction: 0.0,
        ..TrainSettings::default()
    };
    let trained = train(&given, &settings, 1, &mut |_| ControlFlow::Continue(()))
        .expect("drives long enough");
    (trained.model, trained.report.networks.map_or(0, |n| n.rows))
}

/// Five epochs over the rows of 38 drives of ten minutes, with their gathering; items are rows times epochs.
///
/// The example `training_speed` takes the epochs alone, beside the processor's peak.
#[divan::bench(args = [256, 1024, 4096], sample_count = 3, sample_size = 1)]
fn train_epoch(bencher: Bencher<'_, '_>, batch_size: usize) {
    let drives = drives::drivers(38, 600.0);
    let rows = trained(&drives, 1, batch_size).1;
    bencher.counter(ItemsCount::new(5 * rows)).bench_local(|| trained(&drives, 5, batch_size));
}

#[divan::bench]
fn predict_one_window(bencher: Bencher<'_, '_>) {
    let drives = drives::drivers(2, 60.0);
    let model = trained(&drives, 1, 512).0;
    let predictor = Predictor::new(&model, model.mean_embedding()).expect("the model's own size");
    let mut window = model.paper().expect("networks were trained").window_buffer();
    for row in 0..100 {
        let situation = drives[0].0.situation(row).expect("600 rows");
        window.push(&situation).expect("increasing times");
    }
    bencher.bench_local(|| predictor.predict(&window));
}
