//! Scores five answers to a questionnaire and lists the objective measures.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_domain::{Answer, Moment, ParticipantId, Scale};
use maveric_measures::{objective, score};

const SCALE: &str = r#"
id = "calm"
title = "Calmness"
reference = "made up for this example"
items = 5
min = 1
max = 7
scoring = "mean"
reversed = [2, 4]

[[subscales]]
id = "calm"
title = "Calmness"
items = [1, 2, 3, 4, 5]
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scale = Scale::from_toml(SCALE)?;
    let participant = ParticipantId::new("P01")?;
    let answers: Vec<Answer> = [Some(6), Some(2), Some(7), None, Some(5)]
        .into_iter()
        .zip(1..)
        .map(|(answer, item)| Answer {
            participant: participant.clone(),
            moment: Moment::Pre,
            scale: scale.id.clone(),
            item,
            answer,
        })
        .collect();
    let scored = score(std::slice::from_ref(&scale), &answers, Some(&[participant]))?;
    for s in &scored.scores {
        println!(
            "{} {}/{}: {:?} from {} of {} items",
            s.participant, s.scale, s.subscale, s.value, s.answered, s.items
        );
    }
    for measure in objective::all() {
        println!("{:24} {:4} {}", measure.name, measure.unit, measure.title);
    }
    Ok(())
}
