//! Three people who rode three ways, analysed.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_analysis::{Family, Friedman, StudyData, Tables, analyse};
use maveric_domain::{
    ConditionId, DriveId, DriveMeta, DrivenBy, MeasuredDrive, Moment, ParticipantId, Score,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut tables = Tables::default();
    for (i, own) in [26.0, 28.0, 31.0].into_iter().enumerate() {
        let participant = ParticipantId::new(format!("P{}", i + 1))?;
        tables.tested.insert(participant.clone());
        for condition in [ConditionId::OWN].into_iter().chain(ConditionId::AV) {
            let faster = match condition {
                ConditionId::AGGRESSIVE => 2.0 + 0.3 * i as f64,
                ConditionId::CAUTIOUS => -2.5 + 0.5 * i as f64,
                _ => 0.2 * i as f64 - 0.1,
            };
            tables.measurements.push(MeasuredDrive {
                meta: DriveMeta {
                    drive: DriveId::new(format!("{participant}-{condition}"))?,
                    participant: participant.clone(),
                    condition,
                    driven_by: DrivenBy::Synthetic,
                },
                values: [("mean_velocity_mps".to_owned(), Some(own + faster))].into(),
            });
        }
        tables.pre.push(Score {
            participant,
            moment: Moment::Pre,
            scale: "mini_ipip".to_owned(),
            subscale: "openness".to_owned(),
            value: Some(3.0 + i as f64),
            answered: 4,
            items: 4,
        });
    }
    let family: Family = "mini_ipip".parse()?;
    let found = analyse(&StudyData::new(tables)?, &family, Friedman::Exact)?;
    for pair in &found.panels[0].pairs {
        let [mph, p] = [pair.mean_difference, pair.p_holm];
        println!("{} - {}: {mph:.2?} mph, p {p:.3?}", pair.first, pair.second);
    }
    Ok(())
}
