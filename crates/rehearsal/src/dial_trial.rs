//! Does it work? The recommendation on made-up people whose preference is known, and how many trials it takes to learn.

use crate::{
    error::RehearsalError,
    population::CarSetting,
    world::{Rehearsed, World},
};
use maveric_analysis::{Dial, FURTHEST_POINTS, Learned, Percept, SETTINGS};
use maveric_domain::{
    MeasureValues, ParticipantId, Score as Scored, design::ScoreName, stream_seed,
};
use maveric_participants::{Effects, Participant, preferred_shift, rate_trial};
use maveric_stats::{Belief, HALF_95, Proportion, proportion};
use serde::Serialize;

/// A way to set the dial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// The own style for everybody.
    OwnForAll,
    /// What the model expects of the person's questionnaires and own drive.
    BeforeRiding,
    /// That, and the person's ratings of the four conditions.
    AfterFourConditions,
    /// As the last, by who knows how people perceive a drive and has learned the rest from very many of them.
    Ceiling,
}

impl Method {
    /// All, in the order of tables.
    pub const ALL: [Self; 4] = [
        Self::OwnForAll,
        Self::BeforeRiding,
        Self::AfterFourConditions,
        Self::Ceiling,
    ];

    /// Name for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::OwnForAll => "Own style for all",
            Self::BeforeRiding => "questionnaires and own drive",
            Self::AfterFourConditions => "and ratings of four conditions",
            Self::Ceiling => "ceiling: law of perception known, 1,000 people",
        }
    }
}

/// How near a method came to the preference that people were made with.
#[derive(Debug, Clone, Serialize)]
pub struct Score {
    /// By what the dial was set.
    pub method: Method,
    /// New people over all studies.
    pub people: usize,
    /// Share within 5 ADB points, with Wilson's 95 % interval.
    pub within_5: Option<Proportion>,
    /// Mean |error| in ADB points.
    pub mean_error: f64,
    /// Half of the 95 % interval of that mean.
    pub mean_error_half: f64,
    /// Share of people whose 95 % interval holds their preference; none for a method without intervals.
    pub covered: Option<Proportion>,
}

/// The recommendation learned from studies of one size.
#[derive(Debug, Clone, Serialize)]
pub struct LearnedFrom {
    /// Participants of each study learned from.
    pub participants: usize,
    /// Method by method.
    pub scores: Vec<Score>,
    /// Truth and recommendation after the four conditions with its interval, a person each; of the first study.
    pub shown: Vec<[f64; 4]>,
}

/// Errors after some trials.
#[derive(Debug, Clone, Serialize)]
pub struct TrialError {
    /// Trials shown.
    pub trials: usize,
    /// New people over all studies.
    pub people: usize,
    /// Mean |error| in ADB points and half of its 95 % interval, each setting chosen by expected information.
    pub active: (f64, f64),
    /// The same settings for all: a grid of seven, each person in an order of their own.
    pub grid: (f64, f64),
    /// Share within 5 points: active, grid.
    pub within_5: (f64, f64),
}

/// New people on whom each study's model is tried.
const NEW_PEOPLE: usize = 24;
/// People from whom the ceiling has learned.
const MANY: usize = 1000;

/// What the generator knows.
struct Truth {
    percept: Percept,
    dial: Dial,
}

impl Truth {
    fn new(world: &World, many: &Rehearsed) -> Result<Self, RehearsalError> {
        let Effects { perception, .. } = &world.effects;
        let people = &many.data.participants;
        let own_drives: Vec<&MeasureValues> = people
            .iter()
            .filter_map(|p| many.data.drive(p, many.data.design.baseline_id()?))
            .collect();
        let percept = Percept {
            shift: perception.shift.clone(),
            distance: perception.distance.clone(),
            spread: maveric_domain::spread(&own_drives),
        };
        let dial = percept
            .dial(&many.data, people)
            .ok_or(RehearsalError::NoDirection)?;
        Ok(Self { percept, dial })
    }

    /// The setting of the dial that a person was made to like best, in ADB points.
    fn points(&self, world: &World, person: &Participant, seed: u64) -> f64 {
        let preferred = preferred_shift(person, &world.effects, seed);
        self.dial
            .points_at(preferred)
            .clamp(-FURTHEST_POINTS, FURTHEST_POINTS)
    }
}

/// New people of a world, whom every method is to serve.
pub struct DialTrials<'a> {
    world: &'a World,
    truth: Truth,
    ceiling: Learned,
}

/// Truth, and each method's setting with its interval; one person.
#[derive(Debug, Clone)]
pub struct Tried {
    truth: f64,
    settings: [Option<Setting>; 4],
}

/// A shift in points, with its interval where the method has one.
type Setting = (f64, Option<(f64, f64)>);

impl<'a> DialTrials<'a> {
    /// Trials in a world; the ceiling has learned from 1,000 of its people.
    ///
    /// # Errors
    /// [`RehearsalError`] where nothing can be learned, or the dial has no direction.
    pub fn new(world: &'a World, seed: u64) -> Result<Self, RehearsalError> {
        Self::with(world, MANY, stream_seed(seed, &["many"]))
    }

    fn with(world: &'a World, many: usize, seed: u64) -> Result<Self, RehearsalError> {
        let many = world.study(many, seed)?;
        let truth = Truth::new(world, &many)?;
        let percept = Some(truth.percept.clone());
        let ceiling = Learned::from(&many.data, &many.data.participants, percept)?;
        Ok(Self {
            world,
            truth,
            ceiling,
        })
    }

    /// Where the dial truly is in the unit of perceived shift.
    pub fn dial(&self) -> Dial {
        self.truth.dial
    }

    /// Learns from one study of `n` and recommends to new people.
    ///
    /// # Errors
    /// [`RehearsalError`] where nothing can be learned from that study.
    pub fn one(&self, n: usize, seed: u64) -> Result<Vec<Tried>, RehearsalError> {
        let old = self.world.study(n, seed)?;
        let learned = Learned::from(&old.data, &old.data.participants, None)?;
        let new_seed = stream_seed(seed, &["new people"]);
        let new = self.world.study(NEW_PEOPLE, new_seed)?;
        let setting = |learned: &Learned, p: &ParticipantId, with_ratings: bool| {
            let belief = learned.belief(&new.data, p, with_ratings);
            let preferred = learned.preferred(&belief, &learned.traits(&new.data, p))?;
            Some((preferred.points, Some((preferred.low, preferred.high))))
        };
        let tried = new.people.iter().map(|person| Tried {
            truth: self.truth.points(self.world, person, new_seed),
            settings: Method::ALL.map(|method| match method {
                Method::OwnForAll => Some((0.0, None)),
                Method::BeforeRiding => setting(&learned, &person.id, false),
                Method::AfterFourConditions => setting(&learned, &person.id, true),
                Method::Ceiling => setting(&self.ceiling, &person.id, true),
            }),
        });
        Ok(tried.collect())
    }

    /// |Error| of new people after 0, 1, … trials, in ADB points: each setting chosen by expected information, then a grid.
    ///
    /// # Errors
    /// As [`DialTrials::one`].
    pub fn search(
        &self,
        n: usize,
        trials: usize,
        seed: u64,
    ) -> Result<Vec<[Vec<f64>; 2]>, RehearsalError> {
        let old = self.world.study(n, seed)?;
        let learned = Learned::from(&old.data, &old.data.participants, None)?;
        let new_seed = stream_seed(seed, &["new people"]);
        let new = self.world.study(NEW_PEOPLE, new_seed)?;
        let mut errors = Vec::new();
        for person in &new.people {
            let rider = Rider {
                trials: self,
                learned: &learned,
                person,
                new: &new,
                seed: new_seed,
            };
            let order = shuffled(stream_seed(new_seed, &[person.id.as_str(), "grid"]));
            errors.push([
                rider.ride(trials, |belief, traits, _| learned.next(belief, traits).0)?,
                rider.ride(trials, |_, _, trial| SETTINGS[order[trial % order.len()]])?,
            ]);
        }
        Ok(errors)
    }
}

/// One new person, shown one setting after another.
struct Rider<'a> {
    trials: &'a DialTrials<'a>,
    learned: &'a Learned,
    person: &'a Participant,
    new: &'a Rehearsed,
    seed: u64,
}

impl Rider<'_> {
    fn ride(
        &self,
        trials: usize,
        choose: impl Fn(&Belief, &[f64], usize) -> f64,
    ) -> Result<Vec<f64>, RehearsalError> {
        let Self {
            trials: dial,
            learned,
            person,
            new,
            seed,
        } = self;
        let world = dial.world;
        let truth = dial.truth.points(world, person, *seed);
        let traits = learned.traits(&new.data, &person.id);
        let mut belief = learned.belief(&new.data, &person.id, false);
        let error = |belief: &Belief| {
            let setting = learned.preferred(belief, &traits).map_or(0.0, |p| p.points);
            (setting - truth).abs()
        };
        let mut errors = vec![error(&belief)];
        let unit = dial.truth.percept.spread.clone();
        let shown = world.design.conditions().first();
        let shown = shown.ok_or(RehearsalError::NoCondition)?.id;
        for trial in 0..trials {
            let points = choose(&belief, &traits, trial);
            let label = format!("trial {trial}");
            let settings = [(
                label.as_str(),
                CarSetting::Shift(points / learned.dial.points),
            )];
            let drives = world.population.drives(person, &settings, *seed);
            let rated = rate_trial(
                person,
                &drives.own,
                (&label, shown, &drives.trials[0]),
                &unit,
                &world.scales,
                &world.effects,
                *seed,
            )?;
            let scores = maveric_measures::score(&world.scales, &rated.answers, None)?.scores;
            let score = |name: &ScoreName| {
                let is = |s: &&Scored| s.scale == name.scale && s.subscale == name.subscale;
                scores.iter().find(is).and_then(|s| s.value)
            };
            if let Some(rating) = learned.rating(score) {
                let perceived = learned.percept.perceived(&drives.own, &drives.trials[0]);
                let setting = SETTINGS.iter().position(|s| (s - points).abs() < 0.5);
                let row = Learned::row(&traits, perceived, setting);
                learned.observe(&mut belief, &row, rating);
            }
            errors.push(error(&belief));
        }
        Ok(errors)
    }
}

/// An order of the seven settings.
fn shuffled(seed: u64) -> [usize; SETTINGS.len()] {
    let mut order = std::array::from_fn(|i| i);
    order.sort_by_key(|i: &usize| stream_seed(seed, &[&i.to_string()]));
    order
}

/// Mean and half of its 95 % interval.
fn mean_and_half(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, HALF_95 * (variance / n).sqrt())
}

impl LearnedFrom {
    /// Scores every method over studies of one size.
    pub fn of(participants: usize, studies: &[Vec<Tried>]) -> Self {
        let people: Vec<&Tried> = studies.iter().flatten().collect();
        let scores = Method::ALL.iter().enumerate().map(|(m, method)| {
            // Where the model recommends nothing the car stays with the own style.
            let errors: Vec<f64> = people
                .iter()
                .map(|t| (t.settings[m].map_or(0.0, |s| s.0) - t.truth).abs())
                .collect();
            let near = errors.iter().filter(|e| **e <= 5.0).count();
            let intervals: Vec<bool> = people
                .iter()
                .filter_map(|t| {
                    let (low, high) = t.settings[m]?.1?;
                    Some((low..=high).contains(&t.truth))
                })
                .collect();
            let held = intervals.iter().filter(|h| **h).count();
            let (mean_error, mean_error_half) = mean_and_half(&errors);
            Score {
                method: *method,
                people: errors.len(),
                within_5: proportion(near, errors.len(), 0.95).ok(),
                mean_error,
                mean_error_half,
                covered: proportion(held, intervals.len(), 0.95).ok(),
            }
        });
        let shown = studies.first().into_iter().flatten().filter_map(|t| {
            let (points, interval) = t.settings[2]?;
            let (low, high) = interval?;
            Some([t.truth, points, low, high])
        });
        Self {
            participants,
            scores: scores.collect(),
            shown: shown.collect(),
        }
    }
}

impl TrialError {
    /// Errors after each number of trials, over people as [`DialTrials::search`] gives them.
    pub fn of(people: &[[Vec<f64>; 2]], trials: usize) -> Vec<Self> {
        (0..=trials)
            .map(|trial| {
                let errors_of = |m: usize| people.iter().map(|p| p[m][trial]).collect::<Vec<f64>>();
                let near = |m: usize| {
                    let errors = errors_of(m);
                    errors.iter().filter(|e| **e <= 5.0).count() as f64 / errors.len() as f64
                };
                Self {
                    trials: trial,
                    people: people.len(),
                    active: mean_and_half(&errors_of(0)),
                    grid: mean_and_half(&errors_of(1)),
                    within_5: (near(0), near(1)),
                }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::world;
    use maveric_analysis::{Preferred, Turns};

    #[test]
    fn errors_after_a_trial_are_those_of_everybody() {
        let person = |error: f64| [vec![error, error - 1.0], vec![error; 2]];
        let found = TrialError::of(&[person(8.0), person(4.0)], 1);
        assert_eq!(found.len(), 2);
        assert_eq!((found[1].people, found[1].trials), (2, 1));
        assert!((found[1].active.0 - 5.0).abs() < 1e-9);
        assert!((found[1].grid.0 - 6.0).abs() < 1e-9);
    }

    #[test]
    fn who_is_known_is_served_better_than_by_the_own_style_for_all() {
        let world = world();
        let trials = DialTrials::with(&world, 150, 3).unwrap();
        let studies = [trials.one(48, 11).unwrap(), trials.one(48, 12).unwrap()];
        let found = LearnedFrom::of(48, &studies);
        let error = |m: usize| found.scores[m].mean_error;
        assert!(error(2) < 0.8 * error(0), "{} {}", error(2), error(0));
        assert!(error(3) < 0.8 * error(0));
    }

    #[test]
    fn where_somebody_left_the_dial_draws_what_is_recommended_the_more_the_surer_they_were() {
        let data = world().study(60, 5).unwrap().data;
        let learned = Learned::from(&data, &data.participants, None).unwrap();
        let p = data.participants[0].clone();
        let preferred = |turned: &[(f64, f64)]| {
            let ride = Turns {
                participant: p.clone(),
                turned: turned.to_vec(),
                duration_s: 100.0,
                step: 5.0,
            };
            let data = data.clone().with_turns(&[ride]);
            learned.recommendation(&data, &p).preferred.unwrap()
        };
        let before = preferred(&[]);
        let aim = before.points - 8.0 * before.points.signum();
        let still = preferred(&[(10.0, aim)]);
        let restless = preferred(&[(10.0, aim + 20.0), (75.0, aim - 20.0)]);
        assert!((still.points - aim).abs() < 6.0, "{before:?} {still:?}");
        assert!(still.high - still.low < before.high - before.low);
        let moved = |p: &Preferred| (p.points - before.points).abs();
        assert!(moved(&restless) < moved(&still), "{restless:?} {still:?}");
    }

    #[test]
    fn how_people_perceive_is_learned_from_their_answers() {
        let world = world();
        let study = world.study(60, 5).unwrap();
        let percept = Percept::learn(&study.data, &study.data.participants).unwrap();
        let weight = |name: &str| percept.shift[name];
        assert!(weight("mean_velocity_mps") > 0.2, "{percept:?}");
        assert!(
            weight("headway_merge_back_m") + weight("headway_merge_back_s") < 0.0,
            "{percept:?}"
        );
    }

    #[test]
    fn a_grid_shows_every_setting_once() {
        let mut order = shuffled(4);
        assert_ne!(order, shuffled(5));
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2, 3, 4, 5, 6]);
    }
}
