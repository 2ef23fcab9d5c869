//! Three people who rode three ways, analysed.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_analysis::{Purpose, StudyData, Tables, analyse};
use maveric_domain::{
    ConditionId, Design, DriveId, DriveMeta, DrivenBy, MeasuredDrive, ParticipantId,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let design = Design::from_toml(
        r#"
        [study]
        title = "Calm, normal, sporty"
        synthetic = true
        [baseline]
        id = "own"
        [[condition]]
        id = "calm"
        [[condition]]
        id = "normal"
        [[condition]]
        id = "sporty"
        "#,
    )?;
    let mut tables = Tables::default();
    for (i, own) in [26.0, 28.0, 31.0].into_iter().enumerate() {
        let participant = ParticipantId::new(format!("P{}", i + 1))?;
        for (condition, faster) in [
            ("own", 0.0),
            ("calm", 0.5 * i as f64 - 2.5),
            ("normal", 0.2 * i as f64 - 0.1),
            ("sporty", 0.3 * i as f64 + 2.0),
        ] {
            let condition: ConditionId = condition.parse()?;
            tables.measurements.push(MeasuredDrive {
                meta: DriveMeta::new(
                    DriveId::in_condition(&participant, condition)?,
                    participant.clone(),
                    condition,
                    DrivenBy::Synthetic,
                ),
                values: [("mean_velocity_mps".to_owned(), Some(own + faster))].into(),
                counted_s: None,
            });
        }
    }
    let analysis = analyse(&StudyData::new(&design, tables)?, Purpose::Report)?;
    for contrast in &analysis.panels[0].contrasts {
        let [kmh, p] = [contrast.mean_difference, contrast.p_holm];
        println!("{} - {}: {kmh:.2?} km/h, p {p:.3?}", contrast.first, contrast.second);
    }
    Ok(())
}
