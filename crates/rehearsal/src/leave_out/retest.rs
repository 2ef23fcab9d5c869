//! How alike are two drives of one person in one role? ICC(2,1), standard error of measurement and smallest detectable change, measure by measure.

use super::{By, Drove, Line, Missing, Uncounted, between_people, order::twice, people};
use crate::error::RehearsalError;
use maveric_domain::ConditionId;
use maveric_stats::{Icc, icc};
use serde::Serialize;

/// What two drives of a person are compared in.
#[derive(Debug, Clone)]
pub struct Repeated<'a> {
    pub name: &'a str,
    pub title: &'a str,
    /// Its unit; empty for a number without one.
    pub unit: &'a str,
    pub values: Vec<Option<f64>>,
}

/// Two drives of the same people in one role.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Retest {
    /// The role in which they drove twice.
    pub role: ConditionId,
    /// Code name of the measure.
    pub measure: String,
    pub title: String,
    /// Its unit; empty for a number without one.
    pub unit: String,
    /// People with a value in both drives.
    pub n: usize,
    /// ICC(2,1) with McGraw and Wong's interval, SEM and SDC; none below two people.
    pub icc: Option<Icc>,
}

/// Compares everybody's first two drives in a role: by `measured`, and by the position on the line and the score, each read by the model
/// that has not met the driver. Positions are put into the spread between the people learned from, so that those of several models mean
/// the same. Gives also whoever drove only once, or lacks something in one of the two drives.
///
/// # Errors
/// [`RehearsalError::Stats`] for a value that is not finite.
pub fn retest(
    drives: &[Drove],
    role: ConditionId,
    measured: &[Repeated<'_>],
    lines: &[Option<Line>],
) -> Result<(Vec<Retest>, Vec<Uncounted>), RehearsalError> {
    let everybody = people(drives);
    let mut uncounted = Vec::new();
    let mut pairs = Vec::new();
    for (who, person) in everybody.iter().enumerate() {
        match twice(drives, person, role) {
            Ok((first, second)) => pairs.push((who, first, second)),
            Err(why) => uncounted.push(Uncounted::new(person, why)),
        }
    }
    let position = |who: usize, drive: usize| {
        let line = lines.get(who)?.as_ref()?;
        let (centre, sd) = between_people(drives, &line.position, &everybody[who])?;
        Some((line.position[drive]? - centre) / sd)
    };
    for &(who, first, second) in &pairs {
        let mut miss = |why| uncounted.push(Uncounted::new(&everybody[who], why));
        let lacks = |repeated: &&Repeated<'_>| {
            repeated.values[first].is_none() || repeated.values[second].is_none()
        };
        let measures: Vec<String> =
            measured.iter().filter(lacks).map(|repeated| repeated.title.to_owned()).collect();
        if !measures.is_empty() {
            miss(Missing::Measures { measures });
        }
        let line = lines.get(who).and_then(Option::as_ref);
        let off_the_line = line.and_then(|line| {
            let mut both = [first, second].into_iter();
            both.find(|&drive| line.position[drive].is_none())
        });
        if let Some(drive) = off_the_line {
            miss(Missing::reading(&drives[drive], By::Line));
        }
    }
    let score = |who: usize, drive: usize| lines.get(who)?.as_ref()?.score[drive];
    let mut retests = Vec::new();
    for repeated in measured {
        let value = |_: usize, drive: usize| repeated.values[drive];
        retests.push(compared(
            role,
            &pairs,
            (repeated.name, repeated.title, repeated.unit),
            value,
        )?);
    }
    let names = ("line_position", "Position on the line", "SD");
    retests.push(compared(role, &pairs, names, position)?);
    let names = ("score", "Score read from the style", "points");
    retests.push(compared(role, &pairs, names, score)?);
    Ok((retests, uncounted))
}

fn compared(
    role: ConditionId,
    pairs: &[(usize, usize, usize)],
    (name, title, unit): (&str, &str, &str),
    value: impl Fn(usize, usize) -> Option<f64>,
) -> Result<Retest, RehearsalError> {
    let both = pairs
        .iter()
        .filter_map(|&(who, first, second)| Some((value(who, first)?, value(who, second)?)));
    let (first, second): (Vec<Option<f64>>, Vec<Option<f64>>) =
        both.map(|(a, b)| (Some(a), Some(b))).unzip();
    let n = first.len();
    let columns: [(&str, &[Option<f64>]); 2] = [("first", &first), ("second", &second)];
    Ok(Retest {
        role,
        measure: name.to_owned(),
        title: title.to_owned(),
        unit: unit.to_owned(),
        n,
        icc: (n >= 2).then(|| icc(&columns)).transpose()?,
    })
}

#[cfg(test)]
mod tests {
    use super::{super::testing::*, *};

    #[test]
    fn two_drives_in_a_role_give_a_spread_within_people_and_one_gives_none() {
        let mut drives = Vec::new();
        for i in 0..5_u8 {
            let speed = 25.0 + 2.0 * f64::from(i);
            let by = if i % 2 == 0 { 0.4 } else { -0.4 };
            drives.push(drove(&format!("P{i}"), "calm", 20.0, speed, 2.0));
            drives.push(drove(&format!("P{i}"), "calm", 20.0, speed + by, None));
        }
        drives.push(drove("P9", "calm", 20.0, 30.0, 2.0));
        let role = drives[0].role;
        let of = |name, value: fn(&Drove) -> Option<f64>| Repeated {
            name,
            title: name,
            unit: "",
            values: drives.iter().map(value).collect(),
        };
        let measured = [of("speed", |d| d.speed_mps), of("gap", |d| d.time_gap_s)];
        let line = Line {
            position: drives.iter().map(|d| d.speed_mps).collect(),
            se: vec![None; drives.len()],
            score: vec![Some(30.0); drives.len()],
        };
        let lines = vec![Some(line); 6];
        let (found, uncounted) = retest(&drives, role, &measured, &lines).unwrap();
        let speed = &found[0];
        let why = |who: &str| {
            let theirs = uncounted.iter().filter(|u| u.participant.as_str() == who);
            theirs.map(|u| u.why.clone()).collect::<Vec<_>>()
        };
        assert_eq!((speed.n, uncounted.len()), (5, 6));
        assert_eq!(why("P9"), [Missing::Second { role }]);
        let measures = vec!["gap".to_owned()];
        assert_eq!(why("P0"), [Missing::Measures { measures }]);
        let speed = speed.icc.as_ref().unwrap();
        // Differences of .4 three times and -.4 twice: their mean is less than chance would have it, and takes nothing away.
        let squares = 5.0 * (0.4_f64.powi(2) - 0.08_f64.powi(2));
        assert!((speed.sem - (squares / 8.0).sqrt()).abs() < 1e-12);
        assert!(speed.sem_ci.low.unwrap() < speed.sem && speed.sem < speed.sem_ci.high.unwrap());
        assert!(speed.icc.unwrap() > 0.9);
        let gap = &found[1];
        assert!(gap.n == 0 && gap.icc.is_none());
        let (position, score) = (&found[2], &found[3]);
        assert!(position.n == 5 && position.icc.as_ref().unwrap().icc.unwrap() > 0.9);
        // Everybody at one score: a spread of 0, without an interval, and no correlation.
        let score = score.icc.as_ref().unwrap();
        assert_eq!((score.sem, score.sem_ci.low, score.icc), (0.0, None, None));
    }
}
