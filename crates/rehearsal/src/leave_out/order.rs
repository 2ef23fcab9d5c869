//! Does a drive lie where its driver was told to drive? Of people whom the model has not met, beside speed alone and time gap alone.

use super::{Drove, Line, Missing, Uncounted, between_people, driven, people, share};
use crate::error::RehearsalError;
use maveric_domain::{ConditionId, ParticipantId, stream_seed};
use maveric_stats::{Proportion, WithinSubjects, within_without_exact};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

/// Which drive has to lie above which of the same person.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Asked {
    /// The role whose drive has to be the highest.
    pub higher: ConditionId,
    /// The roles whose drives it has to be above, all of them.
    pub lower: Vec<ConditionId>,
}

impl Asked {
    /// In ids, as a finding names it.
    pub fn title(&self) -> String {
        format!("{} above {}", self.higher, ConditionId::listed(&self.lower))
    }

    /// The share of people who would come out right by chance.
    pub fn chance(&self) -> f64 {
        1.0 / (1 + self.lower.len()) as f64
    }
}

/// By what a drive is placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum By {
    /// The line of the score.
    Line,
    /// Mean speed alone; faster is higher.
    Speed,
    /// Median time gap alone; nearer is higher.
    TimeGap,
}

impl By {
    /// All of them, the line first.
    pub const ALL: [Self; 3] = [Self::Line, Self::Speed, Self::TimeGap];
}

/// A mean over people, with its 95 % interval by Student's t.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Mean {
    pub n: usize,
    pub mean: f64,
    /// Lower end; none for one person, and where everybody has the same.
    pub low: Option<f64>,
    pub high: Option<f64>,
    /// Mean over the SD of the differences.
    pub dz: Option<f64>,
}

/// How one way of placing drives did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReadOrder {
    pub by: By,
    /// People with all the drives that are asked for.
    pub n: usize,
    /// People of whom the higher drive is above all the others; a tie is not above.
    pub right: usize,
    /// Their share, with Clopper and Pearson's interval; none without people.
    pub share: Option<Proportion>,
    /// One-sided p: at least as many are right where roles are exchanged within people; none where nothing was exchanged.
    pub p: Option<f64>,
    /// One-sided p of the other side: at most as many are right.
    pub p_below: Option<f64>,
    /// Mean difference to the mean of the others, in SDs between the people learned from.
    pub difference: Option<Mean>,
    /// Mean over people of this difference less that of speed alone; none of speed itself.
    pub beyond_speed: Option<Mean>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PersonOrder {
    pub participant: ParticipantId,
    /// Whether the higher drive is above all the others on the line.
    pub right: Option<bool>,
    /// On the line, higher less mean of the others.
    pub line: Option<f64>,
    /// Its standard error, the drives taken as independent.
    pub line_se: Option<f64>,
    /// Mean speed of the higher drive less the mean of the others, in m/s.
    pub speed_mps: Option<f64>,
    /// Time gap of the higher drive less the mean of the others, in s.
    pub time_gap_s: Option<f64>,
}

impl PersonOrder {
    /// Whether the order is wrong on the line, and its standard error does not cover that.
    pub fn wrong_and_sure(&self) -> bool {
        super::wrong_and_sure(self.right == Some(false), self.line, self.line_se)
    }
}

/// What became of an order that was asked for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Order {
    pub asked: Asked,
    /// Share of people that chance would give.
    pub chance: f64,
    /// By the line, by speed, by time gap.
    pub readings: Vec<ReadOrder>,
    pub people: Vec<PersonOrder>,
    /// How often roles were exchanged.
    pub permutations: usize,
    pub uncounted: Vec<Uncounted>,
}

impl Order {
    /// How one way of placing drives did.
    pub fn by(&self, by: By) -> Option<&ReadOrder> {
        self.readings.iter().find(|r| r.by == by)
    }
}

/// Values by which drives are placed, higher being more aggressive: person by person of each drive of all.
struct Placed {
    by: By,
    /// By person, then by drive; of the road the same for all.
    values: Vec<Vec<Option<f64>>>,
}

/// The line for each person, in the order of [`people`]; none where none can be learned from the others.
type Lines = Vec<Option<Line>>;

/// The lines that the points of every drive give.
type Read<'a, E> = dyn FnMut(&[Option<f64>]) -> Result<Lines, E> + 'a;

/// Are drives placed as their drivers were told? `read` gives for each person, in the order of [`people`], the line that was learned
/// from the others by the points of every drive, and none where no line can be learned; for the permutations it is asked again.
///
/// Roles are exchanged within people, of all drives, in those that the line is learned from as in those that are judged.
///
/// # Errors
/// [`RehearsalError::Stats`] where a number is not finite, and what `read` gives.
pub fn order<E: From<RehearsalError>>(
    drives: &[Drove],
    asked: &Asked,
    permutations: usize,
    seed: u64,
    read: &mut Read<'_, E>,
) -> Result<Order, E> {
    let everybody = people(drives);
    let points: Vec<Option<f64>> = drives.iter().map(|d| d.points).collect();
    let roles: Vec<ConditionId> = drives.iter().map(|d| d.role).collect();
    let lines = read(&points)?;
    let mut placed = vec![
        by_line(&lines, drives.len()),
        by_road(By::Speed, &everybody, drives, |d| d.speed_mps),
        by_road(By::TimeGap, &everybody, drives, |d| d.time_gap_s.map(|g| -g)),
    ];
    let (counted, uncounted) = count_people(drives, &roles, &everybody, asked, &placed);
    let counts = |placed: &[Placed], roles: &[ConditionId]| -> Vec<usize> {
        let right = |p: &Placed, who: usize| {
            let places = places(drives, roles, &everybody[who], asked).ok();
            places.and_then(|places| places.right(&p.values[who])) == Some(true)
        };
        let right_count = |p: &Placed| counted.iter().filter(|(who, _)| right(p, *who)).count();
        placed.iter().map(right_count).collect()
    };
    let observed = counts(&placed, &roles);
    let (mut above, mut below) = (vec![0; placed.len()], vec![0; placed.len()]);
    for number in 0..permutations {
        let order = exchanged(drives, &everybody, seed, number);
        let roles: Vec<ConditionId> = order.iter().map(|&i| roles[i]).collect();
        let points: Vec<Option<f64>> = order.iter().map(|&i| points[i]).collect();
        placed[0] = by_line(&read(&points)?, drives.len());
        for (k, count) in counts(&placed, &roles).into_iter().enumerate() {
            above[k] += usize::from(count >= observed[k]);
            below[k] += usize::from(count <= observed[k]);
        }
    }
    placed[0] = by_line(&lines, drives.len());
    let differences: Vec<Vec<Option<f64>>> = placed
        .iter()
        .map(|p| {
            let difference = |(who, places): &(usize, Places)| {
                let values = &p.values[*who];
                let (_, sd) = between_people(drives, values, &everybody[*who])?;
                Some(places.difference(values)? / sd)
            };
            counted.iter().map(difference).collect()
        })
        .collect();
    let mut readings = Vec::new();
    for (k, p) in placed.iter().enumerate() {
        let known = |(who, places): &&(usize, Places)| places.right(&p.values[*who]).is_some();
        let n = counted.iter().filter(known).count();
        let chance_of = |count: usize| (1 + count) as f64 / (1 + permutations) as f64;
        let tested = permutations > 0 && n > 0;
        readings.push(ReadOrder {
            by: p.by,
            n,
            right: observed[k],
            share: share(observed[k], n)?,
            p: tested.then(|| chance_of(above[k])),
            p_below: tested.then(|| chance_of(below[k])),
            difference: mean_of(&differences[k], None)?,
            beyond_speed: if p.by == By::Speed {
                None
            } else {
                mean_of(&differences[k], Some(&differences[1]))?
            },
        });
    }
    let of_people = counted.iter().map(|(who, places)| {
        let line = &placed[0].values[*who];
        let ses = lines[*who].as_ref().map(|l| l.se.as_slice());
        PersonOrder {
            participant: everybody[*who].clone(),
            right: places.right(line),
            line: places.difference(line),
            line_se: ses.and_then(|se| places.standard_error(se)),
            speed_mps: places.difference(&placed[1].values[*who]),
            time_gap_s: places.difference(&placed[2].values[*who]).map(|d| -d),
        }
    });
    Ok(Order {
        chance: asked.chance(),
        people: of_people.collect(),
        asked: asked.clone(),
        readings,
        permutations,
        uncounted,
    })
}

fn by_line(lines: &[Option<Line>], drives: usize) -> Placed {
    let values = lines.iter().map(|line| {
        let line = line.as_ref().map(|l| l.position.clone());
        line.unwrap_or_else(|| vec![None; drives])
    });
    Placed { by: By::Line, values: values.collect() }
}

fn by_road(
    by: By,
    everybody: &[ParticipantId],
    drives: &[Drove],
    value: fn(&Drove) -> Option<f64>,
) -> Placed {
    let values: Vec<Option<f64>> = drives.iter().map(value).collect();
    Placed { by, values: vec![values; everybody.len()] }
}

/// Whoever has all the drives that are asked for, with where they stand; and who cannot be counted, and why.
fn count_people(
    drives: &[Drove],
    roles: &[ConditionId],
    everybody: &[ParticipantId],
    asked: &Asked,
    placed: &[Placed],
) -> (Vec<(usize, Places)>, Vec<Uncounted>) {
    let (mut counted, mut uncounted) = (Vec::new(), Vec::new());
    for (who, person) in everybody.iter().enumerate() {
        match places(drives, roles, person, asked) {
            Ok(places) => counted.push((who, places)),
            Err(role) => uncounted.push(Uncounted::new(person, Missing::Drive { role })),
        }
    }
    for placed in placed {
        for (who, places) in &counted {
            let missing = places.all().find(|&i| placed.values[*who][i].is_none());
            let why = missing.map(|i| Missing::reading(&drives[i], placed.by));
            uncounted.extend(why.map(|why| Uncounted::new(&everybody[*who], why)));
        }
    }
    (counted, uncounted)
}

/// Where the drives stand that are held beside each other.
struct Places {
    higher: usize,
    lower: Vec<usize>,
}

/// Of each role that is asked for the first drive; the role that is missing otherwise.
fn places(
    drives: &[Drove],
    roles: &[ConditionId],
    who: &ParticipantId,
    asked: &Asked,
) -> Result<Places, ConditionId> {
    let first = |role: ConditionId| {
        let mut roles_driven = drives.iter().zip(roles);
        let place = roles_driven.position(|(d, r)| d.participant == *who && *r == role);
        place.ok_or(role)
    };
    Ok(Places {
        higher: first(asked.higher)?,
        lower: asked.lower.iter().map(|role| first(*role)).collect::<Result<_, _>>()?,
    })
}

impl Places {
    fn all(&self) -> impl Iterator<Item = usize> {
        std::iter::once(self.higher).chain(self.lower.iter().copied())
    }

    /// Whether the higher drive is above all the others; none where one of them has no value.
    fn right(&self, values: &[Option<f64>]) -> Option<bool> {
        let higher = values[self.higher]?;
        let lower: Option<Vec<f64>> = self.lower.iter().map(|&i| values[i]).collect();
        Some(lower?.into_iter().all(|value| higher > value))
    }

    fn difference(&self, values: &[Option<f64>]) -> Option<f64> {
        let lower: Option<Vec<f64>> = self.lower.iter().map(|&i| values[i]).collect();
        Some(values[self.higher]? - crate::validation::mean(&lower?)?)
    }

    fn standard_error(&self, se: &[Option<f64>]) -> Option<f64> {
        let lower: Option<Vec<f64>> = self.lower.iter().map(|&i| se[i]).collect();
        let lower = lower?;
        let of_mean = lower.iter().map(|s| s * s).sum::<f64>() / (lower.len() as f64).powi(2);
        Some((se[self.higher]?.powi(2) + of_mean).sqrt())
    }
}

/// The drives in another order, each person's among themselves: the drive at place i gets what the one at `exchanged[i]` was told.
fn exchanged(
    drives: &[Drove],
    everybody: &[ParticipantId],
    seed: u64,
    number: usize,
) -> Vec<usize> {
    let labels = ["leave-out", "exchanged", &number.to_string()];
    let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(seed, &labels));
    let mut order: Vec<usize> = (0..drives.len()).collect();
    for who in everybody {
        let theirs: Vec<usize> =
            (0..drives.len()).filter(|&i| drives[i].participant == *who).collect();
        for last in (1..theirs.len()).rev() {
            let with = rng.random_range(0..=last);
            order.swap(theirs[last], theirs[with]);
        }
    }
    order
}

/// The mean over people with a value, less that of `beside` where it is given.
fn mean_of(
    values: &[Option<f64>],
    beside: Option<&[Option<f64>]>,
) -> Result<Option<Mean>, RehearsalError> {
    let pair = |i: usize| Some((values[i]?, beside.map_or(Some(0.0), |b| b[i])?));
    let pairs: Vec<(f64, f64)> = (0..values.len()).filter_map(pair).collect();
    let n = pairs.len();
    let differences: Vec<f64> = pairs.iter().map(|(a, b)| a - b).collect();
    let Some(mean) = crate::validation::mean(&differences) else {
        return Ok(None);
    };
    let alone = Mean { n, mean, low: None, high: None, dz: None };
    if n < 2 {
        return Ok(Some(alone));
    }
    let people: Vec<String> = (0..n).flat_map(|i| [i.to_string(), i.to_string()]).collect();
    let which: Vec<String> = (0..n).flat_map(|_| ["a".to_owned(), "b".to_owned()]).collect();
    let rows: Vec<Option<f64>> = pairs.iter().flat_map(|(a, b)| [Some(*a), Some(*b)]).collect();
    let data = WithinSubjects::from_long(&people, &which, &rows)?;
    let analysis = within_without_exact(&data);
    let test = analysis.paired.get("a|b");
    Ok(Some(Mean {
        low: test.and_then(|t| t.ci.low),
        high: test.and_then(|t| t.ci.high),
        dz: test.and_then(|t| t.dz),
        ..alone
    }))
}

/// The drives of two of a person in one role: the first and the second.
pub(super) fn twice(
    drives: &[Drove],
    who: &ParticipantId,
    role: ConditionId,
) -> Result<(usize, usize), Missing> {
    match driven(drives, who, role)[..] {
        [] => Err(Missing::Drive { role }),
        [_] => Err(Missing::Second { role }),
        [first, second, ..] => Ok((first, second)),
    }
}

#[cfg(test)]
mod tests;
