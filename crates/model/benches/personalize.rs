//! Personalising on small drives made by hand. Run with `cargo bench -p maveric-model --bench personalize`.

#[path = "../tests/support/drives.rs"]
mod drives;

use divan::Bencher;
use maveric_domain::Drive;
use maveric_model::{
    CurveSettings, HeadsKind, Model, Personalizer, TrainSettings, TrainingDrive, learning_curve,
    train,
};
use std::ops::ControlFlow;

fn main() {
    divan::main();
}

fn model(heads: HeadsKind) -> Model {
    let drives = drives::drivers_apart(20, 600.0);
    let given: Vec<_> = drives.iter().map(TrainingDrive::from).collect();
    let settings = TrainSettings { heads, epochs: 10, ..TrainSettings::default() };
    train(&given, &settings, 1, &mut |_| ControlFlow::Continue(()))
        .expect("drives long enough")
        .model
}

/// Ten minutes at 20 Hz: 12,000 samples.
fn new_drive() -> Drive {
    let habits = drives::Habits { speed_mps: 29.0, time_gap_s: 1.6, passes: true };
    drives::drive_at(20.0, "new", &habits, 600.0)
}

/// Events and the posterior of one driver's 12,000 samples.
#[divan::bench(args = [HeadsKind::Linear, HeadsKind::Paper], sample_count = 20, sample_size = 1)]
fn twelve_thousand_samples(bencher: Bencher<'_, '_>, heads: HeadsKind) {
    let (model, drive) = (model(heads), new_drive());
    let personalizer = Personalizer::new(&model);
    bencher.bench_local(|| personalizer.fit(&drive, None));
}

/// The learning curve of the same drive: six fits.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn learning_curve_of_ten_minutes(bencher: Bencher<'_, '_>) {
    let (model, drive) = (model(HeadsKind::Linear), new_drive());
    let personalizer = Personalizer::new(&model);
    let params = CurveSettings::default();
    bencher.bench_local(|| learning_curve(&personalizer, &drive, &params));
}
