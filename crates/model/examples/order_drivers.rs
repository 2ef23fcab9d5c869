//! Trains on a few made-up drivers, meets a new one, and says where everybody is on the line of aggression.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

#[path = "../tests/support/drives.rs"]
mod drives;

use maveric_model::{
    ModelError, PersonalizeParams, Predictor, TrainParams, TrainSettings, TrainingDrive,
    personalize,
    style_space::{AggressionAxis, shift},
    train,
};
use std::ops::ControlFlow;

fn main() -> Result<(), ModelError> {
    let recorded = drives::drivers(8, 300.0);
    let given: Vec<_> = recorded
        .iter()
        .map(|(drive, adb)| TrainingDrive {
            drive,
            adb: Some(*adb),
        })
        .collect();
    let params = TrainParams::new(TrainSettings {
        batch_size: 128,
        ..TrainSettings::default()
    })?;
    let trained = train(&given, &params, 1, &mut |epoch| {
        if epoch.epoch % 10 == 0 {
            println!("epoch {:2}: loss {:.3}", epoch.epoch, epoch.total);
        }
        ControlFlow::Continue(())
    })?;
    let axis = AggressionAxis::of(&trained.model)?;
    for ((drive, embedding), (_, adb)) in trained.embeddings.iter().zip(&recorded) {
        let (said, read) = (adb.points(), axis.aggression_hat(embedding)?);
        println!("{drive}: {said:.0} points said, {read:.0} read");
    }

    let habits = drives::Habits {
        speed_mps: 31.0,
        time_gap_s: 1.4,
        passes: true,
    };
    let new = drives::drive("new", &habits, 300.0);
    let fit = personalize(&trained.model, &new, None, &PersonalizeParams::default(), 1)?;
    println!("new driver: starts differ by {:.3} SD", fit.start_spread);
    for points in [-15.0, 0.0, 15.0] {
        let moved = shift(&axis, &fit.embedding, points)?;
        let gap = Predictor::new(&trained.model, &moved.embedding)?.following_distance(24.0);
        println!(
            "{points:+3} points: S reads {:.0}, keeps {gap:.1} m at 24 m/s",
            moved.to_points
        );
    }
    Ok(())
}
