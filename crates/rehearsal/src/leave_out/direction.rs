//! Does the dial point where the driver's own drives of two roles differ? Beside directions drawn in style space, speed alone, and speed
//! with gap.

use crate::{error::RehearsalError, validation::mean};
use maveric_domain::{ParticipantId, stream_seed};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

/// What a direction is made of: mean speed, time gap, gap when moving out, lane changes a minute.
pub const AXES: usize = 4;

/// A change of driving, each part in SDs between people; a part that was not measured on both sides is empty.
pub type Change = [Option<f64>; AXES];

/// One person's own change, and what the car does.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pointed {
    pub participant: ParticipantId,
    /// Their own drive in the higher role less that in the lower.
    pub own: Change,
    /// The car with the dial turned less the car in the own style.
    pub dial: Change,
    /// The way in style space that the dial turns, as far as it does.
    pub step: Vec<f64>,
    /// What the car does for one unit along each coordinate of the style.
    pub response: Vec<Change>,
}

/// How far the dial points where people themselves go.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Direction {
    pub n: usize,
    /// Mean cosine of the car's change as it was driven; none without people.
    pub driven: Option<f64>,
    /// Mean cosine of the change that the car's response to each coordinate gives for the dial: what is held beside the directions.
    pub dial: Option<f64>,
    /// Mean cosine of more speed and nothing else.
    pub speed: Option<f64>,
    /// Mean cosine of as much more speed as less gap.
    pub speed_and_gap: Option<f64>,
    /// Directions drawn, one for all people, as far as the dial turns.
    pub directions: usize,
    pub drawn: Option<f64>,
    /// (1 + directions whose mean cosine is at least the dial's) / (1 + directions).
    pub p: Option<f64>,
    /// The same of the other side.
    pub p_below: Option<f64>,
    /// Person by person: the own change, the car's, and the cosine of the two.
    pub people: Vec<PersonDirection>,
}

/// How one person's own change and the car's lie to each other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PersonDirection {
    pub participant: ParticipantId,
    pub own: Change,
    /// The car's, as it was driven.
    pub dial: Change,
    /// The cosine of the two; none where they share no part that changes.
    pub cosine: Option<f64>,
}

/// The cosine of two changes over the parts that both have.
fn cosine(a: &Change, b: &Change) -> Option<f64> {
    let both = a.iter().zip(b).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (a, b) in both {
        ab += a * b;
        aa += a * a;
        bb += b * b;
    }
    let length = (aa * bb).sqrt();
    (length > 0.0).then(|| ab / length)
}

/// What a step in style space changes, by the response to each coordinate.
fn along(response: &[Change], step: &[f64]) -> Change {
    let mut change = [None; AXES];
    for (axis, part) in change.iter_mut().enumerate() {
        let parts = response.iter().zip(step);
        *part = parts.map(|(change, step)| Some(change[axis]? * step)).sum::<Option<f64>>();
    }
    change
}

/// Mean over people with a cosine.
fn mean_cosine(people: &[Pointed], change: impl Fn(&Pointed) -> Change) -> Option<f64> {
    let cosines: Vec<f64> = people.iter().filter_map(|p| cosine(&change(p), &p.own)).collect();
    mean(&cosines)
}

/// Holds the dial beside `directions` others, drawn evenly over all ways in style space.
///
/// # Errors
/// [`RehearsalError::Population`] where the people's styles are of several sizes.
pub fn direction(
    people: &[Pointed],
    directions: usize,
    seed: u64,
) -> Result<Direction, RehearsalError> {
    let size = people.first().map_or(0, |p| p.step.len());
    if people.iter().any(|p| p.step.len() != size || p.response.len() != size) {
        let problem = "styles of several sizes, expected one".to_owned();
        return Err(RehearsalError::Population(problem));
    }
    let length = |step: &[f64]| step.iter().map(|s| s * s).sum::<f64>().sqrt();
    let dial = mean_cosine(people, |p| along(&p.response, &p.step));
    let labels = ["leave-out", "directions"];
    let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(seed, &labels));
    let (mut drawn, mut above, mut below) = (Vec::new(), 0, 0);
    for _ in 0..directions {
        let way: Vec<f64> = (0..size).map(|_| StandardNormal.sample(&mut rng)).collect();
        let way_length = length(&way);
        let cosine = mean_cosine(people, |p| {
            let scale = length(&p.step) / way_length;
            let step: Vec<f64> = way.iter().map(|w| scale * w).collect();
            along(&p.response, &step)
        });
        let (Some(cosine), Some(dial)) = (cosine, dial) else {
            continue;
        };
        above += usize::from(cosine >= dial);
        below += usize::from(cosine <= dial);
        drawn.push(cosine);
    }
    let share =
        |count: usize| (!drawn.is_empty()).then(|| (1 + count) as f64 / (1 + drawn.len()) as f64);
    let rows = people.iter().map(|p| PersonDirection {
        participant: p.participant.clone(),
        own: p.own,
        dial: p.dial,
        cosine: cosine(&p.dial, &p.own),
    });
    let rows: Vec<PersonDirection> = rows.collect();
    Ok(Direction {
        n: rows.iter().filter(|r| r.cosine.is_some()).count(),
        driven: mean_cosine(people, |p| p.dial),
        dial,
        speed: mean_cosine(people, |_| [Some(1.0), Some(0.0), Some(0.0), Some(0.0)]),
        speed_and_gap: mean_cosine(people, |_| [Some(1.0), Some(-1.0), Some(0.0), Some(0.0)]),
        directions: drawn.len(),
        drawn: mean(&drawn),
        p: share(above),
        p_below: share(below),
        people: rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn person(own: Change, dial: Change, step: [f64; 2]) -> Pointed {
        // The first coordinate is speed, the second shortens the gap.
        let response =
            vec![[Some(1.0), Some(0.0), None, Some(0.0)], [Some(0.0), Some(-1.0), None, Some(0.0)]];
        Pointed {
            participant: ParticipantId::new("P1").unwrap(),
            own,
            dial,
            step: step.to_vec(),
            response,
        }
    }

    #[test]
    fn a_dial_along_the_own_change_beats_nearly_every_direction_and_one_against_it_none() {
        let own = [Some(1.0), Some(-1.0), None, Some(0.0)];
        let found = |step: [f64; 2]| {
            let dial = [Some(step[0]), Some(-step[1]), None, None];
            direction(&[person(own, dial, step)], 2000, 1).unwrap()
        };
        let along = found([1.0, 1.0]);
        assert!((along.dial.unwrap() - 1.0).abs() < 1e-12);
        assert!((along.driven.unwrap() - 1.0).abs() < 1e-12);
        assert!(along.p.unwrap() < 0.01, "{:?}", along.p);
        assert!((along.speed_and_gap.unwrap() - 1.0).abs() < 1e-12);
        assert!((along.speed.unwrap() - 0.5_f64.sqrt()).abs() < 1e-12);
        assert!(along.drawn.unwrap().abs() < 0.05);
        let against = found([-1.0, -1.0]);
        assert!(against.p.unwrap() > 0.99 && against.p_below.unwrap() < 0.01);
        // Across: half of all directions are better.
        let across = found([1.0, -1.0]);
        assert!((across.p.unwrap() - 0.5).abs() < 0.05, "{:?}", across.p);
    }

    #[test]
    fn parts_that_were_not_measured_are_left_out_and_nobody_gives_nothing() {
        let own = [Some(1.0), None, Some(3.0), Some(0.0)];
        let dial = [Some(2.0), Some(5.0), None, Some(0.0)];
        let found = direction(&[person(own, dial, [1.0, 0.0])], 100, 1).unwrap();
        assert_eq!(found.people[0].cosine, Some(1.0));
        let nobody = direction(&[], 100, 1).unwrap();
        assert_eq!((nobody.n, nobody.p, nobody.driven), (0, None, None));
        let still = [None; AXES];
        let found = direction(&[person(own, still, [1.0, 0.0])], 10, 1).unwrap();
        assert_eq!((found.n, found.people[0].cosine), (0, None));
        let again = direction(&[person(own, dial, [1.0, 0.2])], 500, 3).unwrap();
        assert_eq!(again, direction(&[person(own, dial, [1.0, 0.2])], 500, 3).unwrap());
    }
}
