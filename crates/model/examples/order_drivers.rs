//! Learns the habits of a few made-up drivers, meets a new one, and says where everybody is on the line of aggression.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

#[path = "../tests/support/drives.rs"]
mod drives;

use maveric_model::{
    Habits, HeadsKind, ModelError, TrainSettings, TrainingDrive, personalize,
    style_space::LinearHead, train,
};
use std::ops::ControlFlow;

fn main() -> Result<(), ModelError> {
    let recorded = drives::drivers_apart(12, 300.0);
    let given: Vec<_> = recorded.iter().map(TrainingDrive::from).collect();
    let params = TrainSettings {
        heads: HeadsKind::Linear,
        ..TrainSettings::default()
    };
    let trained = train(&given, &params, 1, &mut |_| ControlFlow::Continue(()))?;
    let axis = LinearHead::aggression(&trained.model)?;
    for ((drive, embedding), (_, adb)) in trained.embeddings.iter().zip(&recorded) {
        let (stated, read) = (adb.points(), axis.read(embedding)?);
        println!("{drive}: {stated:.0} points said, {read:.0} read");
    }

    let habits = drives::Habits {
        speed_mps: 31.0,
        time_gap_s: 1.4,
        passes: true,
    };
    let new = drives::drive_apart("new", &habits, 300.0);
    let fit = personalize(&trained.model, &new, None)?;
    let sd = fit.sd_along(axis.gradient()).unwrap_or_default();
    println!("new driver: known to {sd:.2} SD of drivers along aggression");
    for points in [-15.0, 0.0, 15.0] {
        let moved = axis.shift(&fit.embedding, points)?;
        let moved_habits = Habits::new(&trained.model, &moved.embedding)?;
        println!(
            "{points:+3} points: S reads {:.0}, {:.1} m/s, merges back {:.2} s ahead",
            moved.to_points,
            moved_habits.free_speed_mps(None).unwrap_or_default(),
            moved_habits.merge_back_s().unwrap_or_default()
        );
    }
    Ok(())
}
