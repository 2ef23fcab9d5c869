//! One trained model: everybody's embeddings, and the car driven from them.

mod rides;

use super::people::{People, Person};
use crate::{
    error::StudyError,
    mean::column_means,
    outcome::{Watch, for_each_on},
};
use maveric_analysis::Finding;
use maveric_domain::{Drive, Embedding, StyleScore};
use maveric_measures::likeness::windows;
use maveric_model::{
    Heads, HeadsKind, Model, Personalized, personalize,
    style_space::{LinearHead, share_outside_training},
};
use maveric_rehearsal::findings;
use maveric_rehearsal::validation::{
    Across, Agreement, ByColumn, Dial, Driven, Fidelity, Held, Identification, Known, Likeness,
    Reading, Values, across, agreement, dial, fidelity, held, identify, identify_posteriors,
    likeness, likeness_by_column, regression, standardiser, values, within_person,
};
use maveric_simulator::Scenario;
use rides::Ridden;
use serde::Serialize;

/// What was found about one model.
#[derive(Debug, Clone, Serialize)]
pub struct Examined {
    pub model: String,
    pub heads: HeadsKind,
    /// Further files that hold the same model, as trainings of linear heads with other seeds do: examined and counted once.
    pub same: Vec<String>,
    pub identity: Vec<Identification>,
    /// Do the standard errors of the styles hold?
    pub errors: Held,
    /// People learned from who drove twice, from whom the model knows how far days differ; none where the errors are of a drive alone.
    pub days_of: Option<usize>,
    /// Is the car like its driver?
    pub fidelity: Vec<Fidelity>,
    pub likeness: Vec<Likeness>,
    /// By what it is not.
    pub likeness_by_column: Vec<ByColumn>,
    /// Settings of the dial, in ADB points.
    pub steps: Vec<f64>,
    /// Does the dial do what it says?
    pub dial: Vec<Dial>,
    /// Across the dial: what changes while S does not.
    pub perpendicular: Vec<Across>,
    /// Largest change of S by moving across, in points.
    pub perpendicular_moves_s: f64,
    /// The aggression line against score and latent.
    pub line: Vec<Agreement>,
    /// Share of the dial's embeddings that lie further out than any training driver.
    pub beyond_training: Option<f64>,
    /// Collisions over all of the car's drives.
    pub collisions: u32,
    /// Episodes over them with the vehicle ahead nearer than the safety rule allows.
    pub rule_violations: u32,
    pub drives: usize,
}

/// What every model is examined with.
#[derive(Debug)]
pub(super) struct Examination<'a> {
    pub(super) people: &'a People,
    pub(super) scenario: &'a Scenario,
    pub(super) points: f64,
    pub(super) worlds: usize,
    pub(super) seed: u64,
    pub(super) jobs: usize,
}

/// What became of each question, over all models.
pub(super) fn findings(models: &[Examined]) -> Vec<Finding> {
    fn by_model<T>(models: &[Examined], rows: fn(&Examined) -> &Vec<T>) -> Vec<&[T]> {
        models.iter().map(|m| rows(m).as_slice()).collect()
    }
    let collisions: u32 = models.iter().map(|m| m.collisions).sum();
    let drives = models.iter().map(|m| m.drives).sum();
    let mut verdicts = vec![findings::own_style(&by_model(models, |m| &m.fidelity))];
    verdicts.extend(findings::recognised(&by_model(models, |m| &m.identity)));
    verdicts.push(findings::dial(&by_model(models, |m| &m.dial)));
    verdicts.extend(findings::style(&by_model(models, |m| &m.line)));
    verdicts.push(findings::safe(collisions as usize, drives));
    verdicts
}

/// Which of the two drives.
type Day = fn(&Person) -> &Drive;

const FIRST: Day = |person| &person.first;
const AGAIN: Day = |person| &person.again;

/// Settings of the dial, in ADB points.
const STEPS: [f64; 9] = [-20.0, -15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0, 20.0];
/// Where 0 stands among them.
const ZERO: usize = 4;

/// What a model learns of everybody's two drives: of the tested without their score and with it, of those it learned from without.
struct Fits {
    known_first: Vec<Personalized>,
    known_again: Vec<Personalized>,
    own: Vec<Embedding>,
    own_again: Vec<Embedding>,
    scored: Vec<Embedding>,
    scored_again: Vec<Embedding>,
    days: [Vec<Embedding>; 2],
}

/// Seven measures of both drives: of the tested, and of those the model learned from.
struct Measured<'a> {
    own: &'a [Values],
    again: &'a [Values],
    training: [&'a [Values]; 2],
}

/// What the car in the style of each drove, and what is read from it.
struct Car {
    values: Vec<Values>,
    read_back: Vec<Embedding>,
}

fn embeddings(known: &[Personalized]) -> Vec<Embedding> {
    known.iter().map(|k| k.embedding.clone()).collect()
}

fn values_of<'a>(ridden: impl IntoIterator<Item = &'a Ridden>) -> Vec<Values> {
    ridden.into_iter().map(|r| r.values).collect()
}

/// Seven measures of everybody's first drive, and of the second.
fn by_day(people: &[Person]) -> [Vec<Values>; 2] {
    [FIRST, AGAIN].map(|day| people.iter().map(|p| values(day(p))).collect())
}

impl Examination<'_> {
    pub(super) fn examine(
        &self,
        name: &str,
        model: &Model,
        watch: Watch<'_>,
    ) -> Result<Examined, StudyError> {
        let People { test, training, trained_on } = self.people;
        let axis = LinearHead::aggression(model)?;
        let fits = self.fits(model, watch)?;
        let (mut rides, steps) = (self.dial_rides(&axis, &fits.scored)?, STEPS.len() * self.worlds);
        let beyond: Vec<Embedding> = rides.iter().map(|r| r.embedding.clone()).collect();
        let (perpendicular, moved) = self.across(model, &axis, &fits.scored)?;
        rides.extend(perpendicular);
        rides.extend(self.beside_the_dial(model, &fits));
        let driven = for_each_on(self.jobs, &rides, watch, "drives", |r| self.drive(model, r))?;
        let (settings, rest) = driven.split_at(beyond.len());
        let (sideways, rest) = rest.split_at(test.len());
        let (elsewhere, rest) = rest.split_at(test.len());
        let (unscored, rest) = rest.split_at(test.len());
        let sweep = self.averaged(settings);
        // One drive a person, as in the study: fidelity is not helped by averaging roads.
        let own_style = || settings.chunks_exact(steps).map(|d| &d[ZERO * self.worlds]);
        let shown = |ridden: &[Ridden]| ridden.iter().map(|r| r.windows.clone()).collect();
        let seen = |day: Day| test.iter().map(|p| windows(day(p))).collect();
        let like = Driven {
            own: seen(FIRST),
            again: seen(AGAIN),
            mimic: own_style().map(|r| r.windows.clone()).collect(),
            average: shown(rest),
        };
        let mimic = values_of(own_style());
        let [own_values, again_values] = by_day(test);
        let [training_own, training_again] = by_day(training);
        let measured: Vec<Values> = trained_on.iter().map(|(v, _)| *v).collect();
        let z = standardiser(&measured);
        let car = Car {
            values: values_of(unscored),
            read_back: unscored.iter().filter_map(|r| r.read_back.clone()).collect(),
        };
        let measures = Measured {
            own: &own_values,
            again: &again_values,
            training: [&training_own, &training_again],
        };
        let (identity, errors) = self.identity(model, &fits, &measures, &car, &z)?;
        let regressed = regression(trained_on, &own_values, &z);
        let angles: Vec<f64> = moved.iter().map(|m| m.0).collect();
        Ok(Examined {
            model: name.to_owned(),
            heads: model.kind(),
            same: Vec::new(),
            identity,
            errors,
            days_of: model.days().map(|days| days.people),
            fidelity: fidelity(
                &own_values,
                &again_values,
                &mimic,
                &values_of(elsewhere),
                &training_own,
            ),
            likeness: likeness(&like, self.seed)?,
            likeness_by_column: likeness_by_column(&like, self.seed)?,
            rule_violations: driven.iter().map(|d| d.report.rule_violations).sum(),
            steps: STEPS.to_vec(),
            dial: dial(&STEPS, self.points, &sweep)?,
            perpendicular: across(&angles, &mimic, &values_of(sideways), &values_of(elsewhere))?,
            perpendicular_moves_s: moved.iter().map(|m| m.1).fold(0.0, f64::max),
            line: self.line(&axis, &fits, regressed)?,
            beyond_training: share_outside_training(model, &beyond)?,
            collisions: driven.iter().map(|d| d.report.collisions).sum(),
            drives: driven.len(),
        })
    }

    /// What the model learns of everybody's two drives.
    fn fits(&self, model: &Model, watch: Watch<'_>) -> Result<Fits, StudyError> {
        let People { test, training, .. } = self.people;
        let known = |people: &[Person], day: Day, with: bool| {
            for_each_on(self.jobs, people, watch, "embeddings", |p| {
                Ok(personalize(model, day(p), p.adb.filter(|_| with))?)
            })
        };
        let (known_first, known_again) = (known(test, FIRST, false)?, known(test, AGAIN, false)?);
        Ok(Fits {
            own: embeddings(&known_first),
            own_again: embeddings(&known_again),
            known_first,
            known_again,
            scored: embeddings(&known(test, FIRST, true)?),
            scored_again: embeddings(&known(test, AGAIN, true)?),
            days: [
                embeddings(&known(training, FIRST, false)?),
                embeddings(&known(training, AGAIN, false)?),
            ],
        })
    }

    /// Who is recognised in what, and how well the stated standard errors hold.
    fn identity(
        &self,
        model: &Model,
        fits: &Fits,
        measures: &Measured<'_>,
        car: &Car,
        z: &dyn Fn(&Values) -> Vec<f64>,
    ) -> Result<(Vec<Identification>, Held), StudyError> {
        let places = |points: &[Embedding]| -> Vec<Vec<f64>> {
            points.iter().map(|e| e.coordinates().to_vec()).collect()
        };
        let zs = |values: &[Values]| -> Vec<Vec<f64>> { values.iter().map(z).collect() };
        let [first_day, second_day] = &fits.days;
        let by_days = within_person(&places(first_day), &places(second_day));
        let [training_own, training_again] = measures.training;
        let by_measures = within_person(&zs(training_own), &zs(training_again));
        let questions = [
            ("embedding of the second drive", places(&fits.own), places(&fits.own_again), &by_days),
            (
                "seven measures of the second drive",
                zs(measures.own),
                zs(measures.again),
                &by_measures,
            ),
            (
                "embedding read back from the car",
                places(&fits.own),
                places(&car.read_back),
                &by_days,
            ),
            ("seven measures of the car", zs(measures.own), zs(&car.values), &by_measures),
            (
                "embedding fitted with ADB (tells nothing: same score twice)",
                places(&fits.scored),
                places(&fits.scored_again),
                &by_days,
            ),
        ];
        let mut identity = Vec::new();
        for (what, known, seen, by) in &questions {
            identity.extend(identify(what, known, seen, by.as_ref())?);
        }
        let styles = |fits: &[Personalized]| fits.iter().map(with_covariance).collect();
        let first: Vec<Option<Known>> = styles(&fits.known_first);
        let again = styles(&fits.known_again);
        let prior = matches!(model.heads(), Heads::Linear(_));
        let errors = held(&first, &again, prior, self.seed)?;
        let complete =
            |styles: Vec<Option<Known>>| styles.into_iter().collect::<Option<Vec<Known>>>();
        if let (Some(first), Some(again)) = (complete(first), complete(again)) {
            let what = "embedding of the second drive";
            identity.extend(identify_posteriors(what, &first, &again)?);
        }
        Ok((identity, errors))
    }

    /// How well the place on the line agrees with score and trait, beside a regression on the measures.
    fn line(
        &self,
        axis: &LinearHead,
        fits: &Fits,
        regressed: Vec<Option<f64>>,
    ) -> Result<Vec<Agreement>, StudyError> {
        let test = &self.people.test;
        let position = |points: &[Embedding]| -> Result<Vec<Option<f64>>, StudyError> {
            points.iter().map(|e| Ok(Some(axis.position(e)?))).collect()
        };
        let adb: Vec<Option<f64>> = test.iter().map(|p| p.adb.map(StyleScore::points)).collect();
        let latent: Vec<Option<f64>> = test.iter().map(|p| p.latent).collect();
        let readings = [
            (Reading::WithScore, position(&fits.scored)?),
            (Reading::WithoutScore, position(&fits.own)?),
            (Reading::Regression, regressed),
        ];
        let rows = readings.iter();
        let rows = rows.map(|(what, values)| agreement(*what, values, &adb, &latent));
        Ok(rows.collect::<Result<_, maveric_rehearsal::RehearsalError>>()?)
    }

    /// Mean over the roads of each driver and setting, shape `(drivers, settings)`.
    fn averaged(&self, settings: &[Ridden]) -> Vec<Vec<Values>> {
        let settings = values_of(settings);
        let means = settings.chunks_exact(self.worlds).map(column_means);
        let means: Vec<Values> = means.collect();
        means.chunks_exact(STEPS.len()).map(<[Values]>::to_vec).collect()
    }
}

/// A style with its covariance, if it has one.
pub(super) fn with_covariance(style: &Personalized) -> Option<Known> {
    let rows = style.covariance.as_ref()?;
    let rows = rows.chunks_exact(style.embedding.size());
    let rows = rows.map(<[f64]>::to_vec).collect();
    Some((style.embedding.coordinates().to_vec(), rows))
}
