//! One synthetic study at the level of measures and ratings.

use crate::{
    donors::{self, Loan, POINTS, Place},
    error::RehearsalError,
    groups,
    population::{CarSetting, PopulationModel},
    unknown_car::UnknownCar,
};
use maveric_analysis::{StudyData, Tables};
use maveric_domain::{
    Answer, ConditionId, ConditionRow, Design, DriveId, DriveMeta, DrivenBy, Embedding,
    EmbeddingRow, Lent, MeasureValues, MeasuredDrive, Moment, ParticipantId, ProbeAnswer, Ride,
    Scale, Score, ScoreRange,
    design::{Car, Condition, Matched, Probe, ScoreName},
    spread,
};
use maveric_measures::survey::score_probes;
use maveric_participants::{
    Cohort, CohortSettings, Effects, Participant, answer_at_random, answer_before,
    probes_at_random, rate,
};
use std::collections::BTreeMap;

/// Everything that a synthetic study is drawn from.
#[derive(Debug, Clone)]
pub struct World {
    /// Who is tested in which conditions.
    pub design: Design,
    pub population: PopulationModel,
    /// Sizes of the effects in answers and ratings.
    pub effects: Effects,
    pub scales: Vec<Scale>,
    /// Points of the design's dial in one step of the population.
    pub points: f64,
}

/// A study that was never driven.
pub struct Rehearsed {
    pub people: Vec<Participant>,
    /// What a run would have left.
    pub data: StudyData,
}

impl World {
    /// The world of a design whose style has scores in this `range`.
    ///
    /// # Errors
    /// [`RehearsalError::UnknownCar`] for a condition whose drives cannot be made up; [`RehearsalError::NothingAcross`] for somebody else's
    /// style where people differ along the line alone.
    pub fn new(
        design: Design,
        population: PopulationModel,
        mut effects: Effects,
        scales: Vec<Scale>,
        range: ScoreRange,
    ) -> Result<Self, RehearsalError> {
        for Condition { id, car, .. } in design.conditions() {
            let condition = *id;
            if let Some(why) = UnknownCar::of(car.as_ref()) {
                return Err(RehearsalError::UnknownCar { condition, why });
            }
        }
        let styles = donors::style_traits(&population).len();
        if let Some((condition, _)) = matched(&design).next().filter(|_| styles < 2) {
            return Err(RehearsalError::NothingAcross { condition, found: styles });
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
            points: POINTS * range.width() / ScoreRange::ADB.width(),
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

    /// Refuses a study of so few people that a condition with somebody else's style has too few donors.
    ///
    /// # Errors
    /// [`RehearsalError::FewDonors`].
    pub fn enough_donors(&self, people: usize) -> Result<(), RehearsalError> {
        matched(&self.design).try_for_each(|(condition, _)| donors::enough(condition, people))
    }

    /// Draws a study of `n` people, their drives, answers and ratings.
    ///
    /// # Errors
    /// [`RehearsalError`] where effects and questionnaires do not fit, or the design has no baseline; as [`World::enough_donors`].
    pub fn study(&self, n: usize, seed: u64) -> Result<Rehearsed, RehearsalError> {
        let cohort = Cohort::draw(0, n, seed, &CohortSettings::default(), &self.design)?;
        let answers = answer_before(&cohort, &self.scales, &self.effects, seed)?;
        let people = cohort.participants;
        let Some(baseline) = self.design.baseline_id() else {
            return Err(RehearsalError::NoBaseline);
        };
        let tables = self.tables(&people, baseline, &answers, seed)?;
        Ok(Rehearsed { people, data: StudyData::new(&self.design, tables)? })
    }

    /// What these people left behind.
    fn tables(
        &self,
        people: &[Participant],
        baseline: ConditionId,
        answers: &[Answer],
        seed: u64,
    ) -> Result<Tables, RehearsalError> {
        let pre = maveric_measures::score(&self.scales, answers, None)?.scores;
        let style = self.style_of(&pre);
        let fitted = people.iter().map(|person| {
            let score = style.score(&pre, person);
            let z = score.map_or(0.0, |score| style.standardised(score));
            let (without, with) = self.population.positions(person, z, seed);
            Fitted { score, without, with }
        });
        let fitted: Vec<Fitted> = fitted.collect();
        let lent = self.lent(people, &fitted, &style, seed)?;
        let drives = people.iter().zip(lent);
        let drives: Vec<Driven<'_>> =
            drives.map(|(person, lent)| self.drives(person, lent, baseline, seed)).collect();
        let mut tables = Tables {
            scales: self.scales.clone(),
            post: self.ratings(people, &drives, seed)?,
            people: groups::rows(&self.design, people),
            pre,
            ..Tables::default()
        };
        for ((person, driven), fitted) in people.iter().zip(&drives).zip(&fitted) {
            let first = std::iter::once((Ride::from(baseline), &driven.own));
            let others = driven.again.iter().chain(&driven.trials);
            for (ride, values) in first.chain(others.map(|(ride, v)| (*ride, v))) {
                tables.measurements.push(MeasuredDrive {
                    meta: meta(person, ride, ride.condition == baseline)?,
                    values: values.clone(),
                    counted_s: None,
                });
            }
            for (adb_used, position) in [(false, fitted.without), (true, fitted.with)] {
                let row = embedding((person, baseline), adb_used, fitted.score, position)?;
                tables.embeddings.push(row);
            }
            for condition in self.design.conditions() {
                let lent = driven.lent.get(&condition.id);
                let lent = lent.map(|loan| self.lent_row(loan, baseline, &style));
                let places = [fitted.with, 0.0].map(|position| style.points(position));
                let row = condition_row(person, condition, places, driven.angle)?;
                tables.conditions.push(ConditionRow { lent: lent.transpose()?, ..row });
            }
        }
        Ok(tables)
    }
}

/// The conditions in which somebody else's style is lent.
fn matched(design: &Design) -> impl Iterator<Item = (ConditionId, Matched)> {
    let conditions = design.conditions().iter();
    conditions.filter_map(|condition| match condition.car {
        Some(Car::Matched(matched)) => Some((condition.id, matched)),
        _ => None,
    })
}

/// A person's place on the line.
struct Fitted {
    /// As the questionnaire has it.
    score: Option<f64>,
    /// Without the score in the fit, in standard deviations over people.
    without: f64,
    /// The same with the score in the fit.
    with: f64,
}

/// Whose style is lent to a person in which condition.
type LentTo<'a> = BTreeMap<ConditionId, Loan<'a>>;

/// What one person drove and rode.
struct Driven<'a> {
    /// The first drive by hand.
    own: MeasureValues,
    again: Vec<(Ride, MeasureValues)>,
    trials: Vec<(Ride, MeasureValues)>,
    /// Of a move across the dial, in rad.
    angle: f64,
    lent: LentTo<'a>,
}

impl World {
    /// Points of the ADB's scale in a standard deviation over people on the line.
    fn adb_points_a_sd(&self, style: &OwnStyleScore) -> f64 {
        style.sd / self.points * POINTS
    }

    /// Whose style is lent to each person: those of all the others in the same study.
    fn lent<'a>(
        &self,
        people: &'a [Participant],
        fitted: &[Fitted],
        style: &OwnStyleScore,
        seed: u64,
    ) -> Result<Vec<LentTo<'a>>, RehearsalError> {
        let mut lent = vec![LentTo::new(); people.len()];
        if matched(&self.design).next().is_none() {
            return Ok(lent);
        }
        let place = |(person, fitted): (&'a Participant, &Fitted)| Place {
            person,
            line_points: fitted.with * self.adb_points_a_sd(style),
            across: donors::across(&self.population, person),
        };
        let places: Vec<Place<'a>> = people.iter().zip(fitted).map(place).collect();
        for (condition, asked) in matched(&self.design) {
            let loans = donors::lend((condition, asked), &places, seed)?;
            for (theirs, loan) in lent.iter_mut().zip(loans) {
                theirs.insert(condition, loan);
            }
        }
        Ok(lent)
    }

    /// What a run keeps of a loan, in points of the design's style.
    fn lent_row(
        &self,
        loan: &Loan<'_>,
        baseline: ConditionId,
        style: &OwnStyleScore,
    ) -> Result<Lent, RehearsalError> {
        let sds = loan.offer.shift_points / self.adb_points_a_sd(style);
        Ok(Lent {
            donor: DriveId::in_condition(&loan.donor.id, baseline)?,
            donor_shift_points: style.points(sds) - style.points(0.0),
            donor_distance_sd: loan.offer.distance_sd,
            donor_within_reach: loan.within_reach,
        })
    }

    /// Every drive and ride that the design asks of a person.
    fn drives<'a>(
        &self,
        person: &Participant,
        lent: LentTo<'a>,
        baseline: ConditionId,
        seed: u64,
    ) -> Driven<'a> {
        let angle = PopulationModel::angle(person, seed);
        // The dial turns the score, the population knows aggression.
        let aggression = self.design.style().map(|style| style.aggression.factor());
        let step = self.points * aggression.unwrap_or(1.0);
        let by_hand = self.design.rides(baseline).skip(1);
        let by_hand = by_hand.map(|ride| (ride, CarSetting::ByHand));
        let ridden = self.design.conditions().iter().flat_map(|condition| {
            let setting = lent
                .get(&condition.id)
                .map_or_else(|| CarSetting::for_condition(condition, angle, step), Loan::setting);
            let rides = self.design.rides(condition.id);
            rides.map(move |ride| (ride, setting))
        });
        let settings: Vec<(Ride, CarSetting<'_>)> = by_hand.chain(ridden).collect();
        let labels: Vec<String> = settings.iter().map(|(ride, _)| ride.to_string()).collect();
        let labelled: Vec<(&str, CarSetting<'_>)> = labels
            .iter()
            .zip(&settings)
            .map(|(label, (_, setting))| (label.as_str(), *setting))
            .collect();
        let drives = self.population.drives(person, &labelled, seed);
        let values = settings.iter().map(|(ride, _)| *ride).zip(drives.trials);
        let (again, trials) = values.partition(|(ride, _)| ride.condition == baseline);
        Driven { own: drives.own, again, trials, angle, lent }
    }

    /// Scores of what people say of their rides: afterwards, and on the way.
    fn ratings(
        &self,
        people: &[Participant],
        drives: &[Driven<'_>],
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
struct OwnStyleScore {
    name: ScoreName,
    /// Which way aggression moves it.
    aggression: f64,
    mean: f64,
    sd: f64,
}

impl OwnStyleScore {
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
    fn style_of(&self, pre: &[Score]) -> OwnStyleScore {
        let declared = self.design.style();
        let mut style = OwnStyleScore {
            name: declared.map_or_else(
                || ScoreName { scale: "adb".to_owned(), subscale: "total".to_owned() },
                |style| style.score.clone(),
            ),
            aggression: declared.map_or(1.0, |style| style.aggression.factor()),
            mean: self.effects.adb.mean_points,
            sd: self.effects.adb.sd_points,
        };
        if (style.name.scale.as_str(), style.name.subscale.as_str()) != ("adb", "total") {
            let scores: Vec<f64> =
                pre.iter().filter(|s| style.is(s)).filter_map(|s| s.value).collect();
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
    let driven_by = if by_hand { DrivenBy::Synthetic } else { DrivenBy::Automated };
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
    let drive = DriveId::in_condition(&person.id, baseline)?;
    let style = Embedding::new(vec![position])?;
    Ok(EmbeddingRow {
        adb_used,
        adb,
        line_position: Some(position),
        ..EmbeddingRow::new(drive, person.id.clone(), baseline, style)
    })
}

/// The drives are made up as the dial says, beyond the ends of the scale too; so are their places, `own` and `average` in points.
fn condition_row(
    person: &Participant,
    condition: &Condition,
    [own, average]: [f64; 2],
    angle: f64,
) -> Result<ConditionRow, RehearsalError> {
    let moved = match condition.car {
        Some(Car::Mean) => average - own,
        _ => condition.dial().unwrap_or(0.0),
    };
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
mod tests;
