//! One synthetic study at the level of measures and ratings.

use crate::{
    error::RehearsalError,
    groups,
    population::{CarSetting, PopulationModel},
};
use maveric_analysis::{StudyData, Tables};
use maveric_domain::{
    ConditionId, ConditionRow, Design, DriveId, DriveMeta, DrivenBy, Embedding, EmbeddingRow,
    MeasureValues, MeasuredDrive, Moment, ParticipantId, ProbeAnswer, Ride, Scale, Score,
    design::{Car, Condition, Probe, ScoreName},
    occasion::first,
    spread,
};
use maveric_measures::survey::score_probes;
use maveric_participants::{
    Cohort, CohortSettings, Effects, Participant, answer_at_random, answer_before,
    probes_at_random, rate,
};

/// Points of the ADB score in one step of the population model.
const POINTS: f64 = 15.0;

/// Everything that a synthetic study is drawn from.
#[derive(Debug, Clone)]
pub struct World {
    /// Who is tested in which conditions.
    pub design: Design,
    /// What drives look like.
    pub population: PopulationModel,
    /// Sizes of the effects in answers and ratings.
    pub effects: Effects,
    /// The questionnaires.
    pub scales: Vec<Scale>,
    /// Points of the design's dial in one step of the population.
    pub points: f64,
}

/// A study that was never driven.
pub struct Rehearsed {
    /// Who they are.
    pub people: Vec<Participant>,
    /// What a run would have left.
    pub data: StudyData,
}

impl World {
    /// The world of a design. `points_a_point` is how many ADB points one point of the design's dial is worth.
    ///
    /// # Errors
    /// [`RehearsalError::UnknownCar`] for a condition whose drives cannot be made up: of a car that was recorded elsewhere, that the
    /// person turns, or whose style stands in a file, nobody knows what it will do.
    pub fn new(
        design: Design,
        population: PopulationModel,
        mut effects: Effects,
        scales: Vec<Scale>,
        points_a_point: f64,
    ) -> Result<Self, RehearsalError> {
        let unknown = |c: &&Condition| !matches!(c.car, Some(Car::Dial(_) | Car::Across));
        if let Some(condition) = design.conditions().iter().find(unknown) {
            return Err(RehearsalError::UnknownCar {
                condition: condition.id,
            });
        }
        if let Some(probe) = &design.protocol().probe
            && !scales.iter().any(|scale| scale.id == probe.scale)
        {
            let scale = probe.scale.clone();
            return Err(RehearsalError::NoProbeScale { scale });
        }
        // What is not asked is not answered.
        let is_asked = |id: &String| scales.iter().any(|s| s.id == *id);
        effects.ratings.retain(|id, _| is_asked(id));
        effects.answers.retain(|id, _| is_asked(id));
        Ok(Self {
            design,
            population,
            effects,
            scales,
            points: POINTS / points_a_point,
        })
    }

    /// The same world with every effect times `factor`; 0 has none at all, order and halo included.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            design: self.design.clone(),
            population: self.population.scaled(factor),
            effects: if factor == 0.0 {
                self.effects.without_effects()
            } else {
                self.effects.scaled(factor)
            },
            scales: self.scales.clone(),
            points: self.points,
        }
    }

    /// Draws a study of `n` people, their drives, answers and ratings.
    ///
    /// # Errors
    /// [`RehearsalError`] where effects and questionnaires do not fit, or the design has no baseline.
    pub fn study(&self, n: usize, seed: u64) -> Result<Rehearsed, RehearsalError> {
        let cohort = Cohort::draw(0, n, seed, &CohortSettings::default(), &self.design)?;
        let answers = answer_before(&cohort, &self.scales, &self.effects, seed)?;
        let people = cohort.participants;
        let Some(baseline) = self.design.baseline_id() else {
            return Err(RehearsalError::NoBaseline);
        };
        let drives: Vec<Driven> = people
            .iter()
            .map(|person| self.drives(person, baseline, seed))
            .collect();
        let mut tables = Tables {
            scales: self.scales.clone(),
            pre: maveric_measures::score(&self.scales, &answers, None)?.scores,
            post: self.ratings(&people, &drives, seed)?,
            people: groups::rows(&self.design, &people),
            ..Tables::default()
        };
        let style = self.style_of(&tables.pre);
        for (person, driven) in people.iter().zip(&drives) {
            let first = std::iter::once((Ride::from(baseline), &driven.own));
            let others = driven.again.iter().chain(&driven.trials);
            for (ride, values) in first.chain(others.map(|(ride, v)| (*ride, v))) {
                tables.measurements.push(MeasuredDrive {
                    meta: meta(person, ride, ride.condition == baseline)?,
                    values: values.clone(),
                    counted_s: None,
                });
            }
            let score = style.score(&tables.pre, person);
            let z = score.map_or(0.0, |score| style.standardised(score));
            let (without, with) = self.population.positions(person, z, seed);
            for (adb_used, position) in [(false, without), (true, with)] {
                tables
                    .embeddings
                    .push(embedding((person, baseline), adb_used, score, position)?);
            }
            let own_points = style.points(with);
            for condition in self.design.conditions() {
                let row = condition_row(person, condition, driven.angle, own_points)?;
                tables.conditions.push(row);
            }
        }
        Ok(Rehearsed {
            people,
            data: StudyData::new(&self.design, tables)?,
        })
    }
}

/// What one person drove and rode.
struct Driven {
    /// The first drive by hand.
    own: MeasureValues,
    /// Those of further sessions.
    again: Vec<(Ride, MeasureValues)>,
    /// The rides.
    trials: Vec<(Ride, MeasureValues)>,
    /// Of a move across the dial, in rad.
    angle: f64,
}

impl World {
    /// Every drive and ride that the design asks of a person.
    fn drives(&self, person: &Participant, baseline: ConditionId, seed: u64) -> Driven {
        let angle = PopulationModel::angle(person, seed);
        let by_hand = self.design.rides(baseline).skip(1);
        let by_hand = by_hand.map(|ride| (ride, CarSetting::ByHand));
        let ridden = self.design.conditions().iter().flat_map(|condition| {
            let setting = CarSetting::for_condition(condition, angle, self.points);
            let rides = self.design.rides(condition.id);
            rides.map(move |ride| (ride, setting))
        });
        let settings: Vec<(Ride, CarSetting)> = by_hand.chain(ridden).collect();
        let labels: Vec<String> = settings.iter().map(|(ride, _)| ride.to_string()).collect();
        let labelled: Vec<(&str, CarSetting)> = labels
            .iter()
            .zip(&settings)
            .map(|(label, (_, setting))| (label.as_str(), *setting))
            .collect();
        let drives = self.population.drives(person, &labelled, seed);
        let values = settings.iter().map(|(ride, _)| *ride).zip(drives.trials);
        let (again, trials) = values.partition(|(ride, _)| ride.condition == baseline);
        Driven {
            own: drives.own,
            again,
            trials,
            angle,
        }
    }

    /// Scores of what people say of their rides: afterwards, and on the way.
    fn ratings(
        &self,
        people: &[Participant],
        drives: &[Driven],
        seed: u64,
    ) -> Result<Vec<Score>, RehearsalError> {
        let unit = spread(&drives.iter().map(|driven| &driven.own).collect::<Vec<_>>());
        let (scales, effects) = (&self.scales, &self.effects);
        let (mut answers, mut probes) = (Vec::new(), Vec::new());
        for (person, driven) in people.iter().zip(drives) {
            let (own, trials) = (&driven.own, &driven.trials);
            let rated = rate(person, own, trials, &unit, scales, effects, seed)?;
            answers.extend(rated.answers);
            for (ride, _) in trials {
                let (moment, missing) = (Moment::After(*ride), effects.missing_rate);
                let unknown = effects.unknown_of(&self.design, scales);
                answers.extend(answer_at_random(&person.id, moment, unknown, missing, seed));
                probes.extend(self.probes(&person.id, *ride, seed));
            }
        }
        let mut scores = maveric_measures::score(scales, &answers, None)?.scores;
        scores.extend(score_probes(scales, &probes)?);
        Ok(scores)
    }

    /// What is answered on the way, at random; nothing where nothing is asked.
    fn probes(&self, who: &ParticipantId, ride: Ride, seed: u64) -> Vec<ProbeAnswer> {
        let protocol = self.design.protocol();
        let Some(probe) = &protocol.probe else {
            return Vec::new();
        };
        let Some(scale) = self.scales.iter().find(|scale| scale.id == probe.scale) else {
            return Vec::new();
        };
        let times_s = Probe::asked_s(probe.every_s, protocol.ride_s);
        probes_at_random(who, ride, scale, times_s, self.effects.missing_rate, seed)
    }
}

/// The score that the positions are made of: that of the design's own style.
struct StyleScore {
    name: ScoreName,
    /// Which way aggression moves it.
    aggression: f64,
    mean: f64,
    sd: f64,
}

impl StyleScore {
    /// The score of a place on the line, which lies in standard deviations over people.
    fn points(&self, position: f64) -> f64 {
        self.mean + self.aggression * self.sd * position
    }

    fn score(&self, pre: &[Score], person: &Participant) -> Option<f64> {
        let is_theirs = |s: &&Score| s.participant == person.id && self.is(s);
        pre.iter().find(is_theirs)?.value
    }

    fn is(&self, score: &Score) -> bool {
        score.moment == Moment::Pre
            && score.scale == self.name.scale
            && score.subscale == self.name.subscale
    }

    /// In SD over people, up with aggression.
    fn standardised(&self, score: f64) -> f64 {
        self.aggression * (score - self.mean) / self.sd
    }
}

impl World {
    /// The ADB score has the mean and SD that its effects were planted with; another score those of the people who answered it.
    fn style_of(&self, pre: &[Score]) -> StyleScore {
        let declared = self.design.style();
        let mut style = StyleScore {
            name: declared.map_or_else(
                || ScoreName {
                    scale: "adb".to_owned(),
                    subscale: "total".to_owned(),
                },
                |style| style.score.clone(),
            ),
            aggression: declared.map_or(1.0, |style| style.aggression.factor()),
            mean: self.effects.adb.mean_points,
            sd: self.effects.adb.sd_points,
        };
        if (style.name.scale.as_str(), style.name.subscale.as_str()) != ("adb", "total") {
            let scores: Vec<f64> = pre
                .iter()
                .filter(|s| style.is(s))
                .filter_map(|s| s.value)
                .collect();
            let n = scores.len() as f64;
            style.mean = scores.iter().sum::<f64>() / n;
            let squares: f64 = scores.iter().map(|v| (v - style.mean).powi(2)).sum();
            let sd = (squares / (n - 1.0)).sqrt();
            // Where all answered alike nobody lies anywhere but in the middle.
            style.sd = if sd > 0.0 { sd } else { 1.0 };
        }
        style
    }
}

fn meta(person: &Participant, ride: Ride, by_hand: bool) -> Result<DriveMeta, RehearsalError> {
    let driven_by = if by_hand {
        DrivenBy::Synthetic
    } else {
        DrivenBy::Automated
    };
    let drive = DriveId::in_condition(&person.id, ride)?;
    let meta = DriveMeta::new(drive, person.id.clone(), ride.condition, driven_by);
    Ok(meta.on(ride.occasion))
}

fn embedding(
    (person, baseline): (&Participant, ConditionId),
    adb_used: bool,
    adb: Option<f64>,
    position: f64,
) -> Result<EmbeddingRow, RehearsalError> {
    Ok(EmbeddingRow {
        drive: DriveId::in_condition(&person.id, baseline)?,
        participant: person.id.clone(),
        condition: baseline,
        session: first(),
        trial: first(),
        adb_used,
        adb,
        adb_hat: None,
        line_position: Some(position),
        readings: None,
        covariance: None,
        line_position_se: None,
        support_p: None,
        beyond_why: None,
        posted_unseen: None,
        embedding: Embedding::new(vec![position])?,
    })
}

/// The drives are made up as the dial says, beyond the ends of the scale too; so are their places.
fn condition_row(
    person: &Participant,
    condition: &Condition,
    angle: f64,
    own: f64,
) -> Result<ConditionRow, RehearsalError> {
    let moved = condition.dial().unwrap_or(0.0);
    Ok(ConditionRow {
        participant: person.id.clone(),
        condition: condition.id,
        adb_hat: Some(own + moved),
        moved_points: Some(moved),
        moved_points_sd: None,
        clamped: false,
        angle_rad: (condition.car == Some(Car::Across)).then_some(angle),
        lent: None,
        beyond_training: false,
        beyond_why: None,
        sweep: None,
        embedding: Embedding::new(vec![0.0])?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{design, world};

    /// Pearson's r of two lists.
    fn r(x: &[f64], y: &[f64]) -> f64 {
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        let (mx, my) = (mean(x), mean(y));
        let sum = |of: &dyn Fn(usize) -> f64| (0..x.len()).map(of).sum::<f64>();
        let (dx, dy) = (|i: usize| x[i] - mx, |i: usize| y[i] - my);
        sum(&|i| dx(i) * dy(i)) / (sum(&|i| dx(i) * dx(i)) * sum(&|i| dy(i) * dy(i))).sqrt()
    }

    /// By how much the score of this style goes better with the positions of 200 people that were fitted with it than with the others.
    fn gained(style: &str) -> f64 {
        let text =
            include_str!("../../../study_data/designs/paper.toml").replace("adb.total", style);
        let other = World {
            design: Design::from_toml(&text).unwrap(),
            ..world()
        };
        let data = other.study(200, 7).unwrap().data;
        let name: ScoreName = style.parse().unwrap();
        let people = || data.participants.iter();
        let scores: Vec<f64> = people().map(|p| data.pre(p, &name).unwrap()).collect();
        let [without, with] = [false, true].map(|adb_used| {
            let position = |p| data.embedding(p, adb_used).unwrap().line_position.unwrap();
            r(&scores, &people().map(position).collect::<Vec<f64>>())
        });
        with - without
    }

    #[test]
    fn people_come_again_and_what_is_asked_on_the_way_is_answered_without_changing_their_first_session()
     {
        let paper = include_str!("../../../study_data/designs/paper.toml");
        let repeated = format!(
            "{paper}\n[protocol]\nprobe = {{ scale = \"misc\", every_s = 30 }}\nride_s = 120\nrides_per_condition = 2\nsessions = {{ count = 2, days_between = [2, 14] }}\n"
        );
        let design = Design::from_toml(&repeated).unwrap();
        let misc = Scale::from_toml(maveric_data::scale("misc").unwrap()).unwrap();
        let once = world();
        let bare = World::new(
            design.clone(),
            once.population.clone(),
            once.effects.clone(),
            once.scales.clone(),
            1.0,
        );
        assert!(matches!(bare, Err(RehearsalError::NoProbeScale { scale }) if scale == "misc"));
        let scales = [once.scales.clone(), vec![misc]].concat();
        let twice = World::new(
            design,
            once.population.clone(),
            once.effects.clone(),
            scales,
            1.0,
        )
        .unwrap();
        let (once, twice) = (
            once.study(40, 3).unwrap().data,
            twice.study(40, 3).unwrap().data,
        );
        // Four conditions with two rides and a drive by hand, in each of two sessions.
        assert_eq!(twice.measurements().len(), 40 * 2 * (4 * 2 + 1));
        let first = |data: &StudyData| {
            let first = data
                .measurements()
                .iter()
                .filter(|d| d.meta.ride().occasion == maveric_domain::Occasion::FIRST);
            first.cloned().collect::<Vec<_>>()
        };
        assert_eq!(first(&twice), first(&once));
        let name: ScoreName = "misc.sickness".parse().unwrap();
        let mimic: ConditionId = "mimic".parse().unwrap();
        let sick = twice
            .participants
            .iter()
            .filter_map(|p| twice.rated(p, mimic, &name));
        // Three probes in each of two rides, evenly among 0 to 10.
        let sick: Vec<f64> = sick.collect();
        let mean = sick.iter().sum::<f64>() / sick.len() as f64;
        assert!(sick.len() == 40 && (mean - 5.0).abs() < 1.0, "{mean}");
        let found =
            maveric_analysis::analyse(&twice, maveric_analysis::Purpose::Simulation).unwrap();
        let repeats = found.repeats.unwrap();
        assert_eq!((repeats.back, repeats.gone), (40, 0));
        let speed = repeats
            .retest
            .iter()
            .find(|r| r.outcome == "mean_velocity_mps" && r.condition.as_str() == "own");
        assert!(
            speed
                .unwrap()
                .icc
                .as_ref()
                .is_some_and(|icc| icc.icc.is_some_and(|r| r > 0.5)),
            "{speed:?}"
        );
    }

    #[test]
    fn people_lie_on_the_line_of_the_design_s_own_score_whatever_it_is() {
        assert_eq!(design().style().unwrap().score.to_string(), "adb.total");
        let (adb, risky) = (gained("adb.total"), gained("mdsi.risky"));
        assert!(adb > 0.1 && risky > 0.1, "{adb} {risky}");
    }
}
