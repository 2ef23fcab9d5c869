use super::{super::testing::*, *};

/// A line that says the points: by least squares on speed among the others, so that it learns which way is up.
fn by_speed(
    drives: &[Drove],
) -> impl FnMut(&[Option<f64>]) -> Result<Vec<Option<Line>>, RehearsalError> + '_ {
    |points| {
        let of = |who: &ParticipantId| {
            let learned = drives.iter().zip(points);
            let learned = learned.filter(|(d, _)| d.participant != *who);
            let pairs: Vec<(f64, f64)> =
                learned.filter_map(|(d, p)| Some((d.speed_mps?, (*p)?))).collect();
            let n = pairs.len() as f64;
            let sums = pairs.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
            let slope: f64 = pairs.iter().map(|p| (p.0 - sums.0) * (p.1 - sums.1)).sum();
            Some(Line {
                position: drives.iter().map(|d| Some(slope.signum() * d.speed_mps?)).collect(),
                se: vec![Some(0.3); drives.len()],
                score: vec![None; drives.len()],
            })
        };
        Ok(people(drives).iter().map(of).collect())
    }
}

fn asked(drives: &[Drove]) -> Asked {
    Asked { higher: drives[1].role, lower: vec![drives[0].role] }
}

#[test]
fn an_order_is_counted_by_person_and_its_p_comes_from_exchanged_roles() {
    let drives = six();
    let found = order(&drives, &asked(&drives), 500, 1, &mut by_speed(&drives)).unwrap();
    let (line, speed, gap) =
        (found.by(By::Line).unwrap(), found.by(By::Speed).unwrap(), found.by(By::TimeGap).unwrap());
    assert_eq!((line.right, speed.right, gap.right), (5, 5, 6));
    assert!((found.chance - 0.5).abs() < 1e-12);
    // 6 of 6 in one direction: 1/64 of the exchanges; 5 or more: 7/64.
    assert!((gap.p.unwrap() - 1.0 / 64.0).abs() < 0.015, "{:?}", gap.p);
    assert!((speed.p.unwrap() - 7.0 / 64.0).abs() < 0.04, "{:?}", speed.p);
    // The line learns its direction from exchanged roles too, so it is right more often by chance than a fixed one.
    assert!(line.p.unwrap() > speed.p.unwrap(), "{:?}", line.p);
    let interval = gap.share.unwrap();
    assert!((interval.low - 0.540_742).abs() < 1e-5 && interval.high >= 1.0);
    assert_eq!(found.people[5].right, Some(false));
    assert!((found.people[0].line_se.unwrap() - 0.3 * 2.0_f64.sqrt()).abs() < 1e-12);
    assert!((found.people[0].time_gap_s.unwrap() + 0.5).abs() < 1e-12);
}

#[test]
fn differences_are_in_spreads_between_people_and_paired_with_speed() {
    let drives = six();
    let found = order(&drives, &asked(&drives), 0, 1, &mut by_speed(&drives)).unwrap();
    let line = found.by(By::Line).unwrap();
    // It is speed, so nothing lies beyond speed.
    let beyond = line.beyond_speed.unwrap();
    assert!(beyond.mean.abs() < 1e-12 && beyond.n == 6, "{beyond:?}");
    assert!(line.difference.unwrap().mean > 1.0);
    assert_eq!((line.p, found.permutations), (None, 0));
    let gap = found.by(By::TimeGap).unwrap();
    let beyond = gap.beyond_speed.unwrap();
    assert!(beyond.low.unwrap() > 0.0, "{beyond:?}");
    assert_eq!(found.by(By::Speed).unwrap().beyond_speed, None);
}

#[test]
fn a_tie_is_not_above_and_whoever_lacks_a_drive_or_a_reading_is_named() {
    let mut drives = six();
    drives[1].speed_mps = drives[0].speed_mps;
    drives[3].time_gap_s = None;
    drives.remove(11);
    let found = order(&drives, &asked(&drives), 20, 1, &mut by_speed(&drives)).unwrap();
    let (speed, gap) = (found.by(By::Speed).unwrap(), found.by(By::TimeGap).unwrap());
    assert_eq!((speed.n, speed.right), (5, 4));
    assert_eq!(gap.n, 4);
    assert_eq!(found.uncounted[0].why, Missing::Drive { role: asked(&six()).higher });
    let reading = &found.uncounted[1].why;
    assert!(
        matches!(reading, Missing::Reading { by: By::TimeGap, drive } if *drive == drives[3].drive)
    );
    // Nobody has a line: nothing is said, and nothing is no number.
    let none = order::<RehearsalError>(&drives, &asked(&drives), 20, 1, &mut |_| Ok(vec![None; 6]));
    let none = none.unwrap();
    let line = none.by(By::Line).unwrap();
    assert_eq!((line.n, line.share, line.p, line.difference), (0, None, None, None));
}

#[test]
fn exchanged_roles_stay_with_their_person_and_a_seed_gives_the_same() {
    let drives = six();
    let everybody = people(&drives);
    let first = exchanged(&drives, &everybody, 7, 3);
    assert_eq!(first, exchanged(&drives, &everybody, 7, 3));
    for (place, from) in first.iter().enumerate() {
        assert_eq!(drives[place].participant, drives[*from].participant);
    }
    let differing = (0..20).filter(|&k| exchanged(&drives, &everybody, 7, k) != first);
    assert!(differing.count() > 10);
}
