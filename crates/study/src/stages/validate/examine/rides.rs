//! What the car drives so that a model can be examined: settings of the dial, places across it, other roads, the average driver.

use super::{Examination, Fits, STEPS};
use crate::{
    error::StudyError,
    stages::{simulate::drive_style, validate::people::Person},
};
use maveric_domain::{Drive, DriveId, DriveMeta, DrivenBy, Embedding, stream_seed};
use maveric_measures::likeness::{Window, windows};
use maveric_model::{
    Model, personalize,
    style_space::{LinearHead, PerpendicularEllipse},
};
use maveric_rehearsal::validation::{Values, values};
use maveric_simulator::RolloutReport;
use rand_pcg::{Pcg64Mcg, rand_core::SeedableRng};

/// The car's drive and who is to be recognised in it.
#[derive(Debug, Clone)]
pub(super) struct Ride<'a> {
    person: &'a Person,
    pub(super) embedding: Embedding,
    /// Number of the road: the same traffic seed for one driver at every setting.
    world: usize,
    /// Whether an embedding is to be read back from it.
    read_back: bool,
}

pub(super) struct Ridden {
    pub(super) values: Values,
    pub(super) report: RolloutReport,
    pub(super) windows: Vec<Window>,
    pub(super) read_back: Option<Embedding>,
}

/// Rides across the dial; the angle of each, in rad, and by how much it moves S, in points.
pub(super) type Sideways<'a> = (Vec<Ride<'a>>, Vec<(f64, f64)>);

impl Examination<'_> {
    /// A ride across the dial for each person, with its angle and by how much it moves S.
    pub(super) fn across(
        &self,
        model: &Model,
        axis: &LinearHead,
        scored: &[Embedding],
    ) -> Result<Sideways<'_>, StudyError> {
        let ellipse = PerpendicularEllipse::of(model)?;
        let (mut rides, mut moved) = (Vec::new(), Vec::new());
        for (person, w) in self.people.test.iter().zip(scored) {
            let labels = [person.participant.as_str(), "perpendicular"];
            let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(self.seed, &labels));
            let point = ellipse.sample(w, &mut rng)?;
            let change = axis.read(&point.embedding)? - axis.read(w)?;
            moved.push((point.angle_rad, change.abs()));
            rides.push(Self::ride(person, &point.embedding, 0));
        }
        Ok((rides, moved))
    }

    /// Rides on another road, in the style that no score was asked for, and as the average driver: a person each, one after the other.
    pub(super) fn beside_the_dial(&self, model: &Model, fits: &Fits) -> Vec<Ride<'_>> {
        let test = &self.people.test;
        let scored = test.iter().zip(&fits.scored);
        let elsewhere = scored.map(|(person, w)| Self::ride(person, w, self.worlds));
        let unscored = test
            .iter()
            .zip(&fits.own)
            .map(|(person, w)| Ride { read_back: true, ..Self::ride(person, w, 0) });
        let average = test.iter().map(|person| Self::ride(person, model.mean_embedding(), 0));
        elsewhere.chain(unscored).chain(average).collect()
    }

    fn ride<'p>(person: &'p Person, embedding: &Embedding, world: usize) -> Ride<'p> {
        Ride { person, embedding: embedding.clone(), world, read_back: false }
    }

    /// Driver by driver, setting by setting, road by road.
    pub(super) fn dial_rides(
        &self,
        axis: &LinearHead,
        scored: &[Embedding],
    ) -> Result<Vec<Ride<'_>>, StudyError> {
        let mut rides = Vec::new();
        for (person, w) in self.people.test.iter().zip(scored) {
            for points in STEPS {
                let there = axis.shift(w, points)?.embedding;
                rides.extend((0..self.worlds).map(|world| Self::ride(person, &there, world)));
            }
        }
        Ok(rides)
    }

    pub(super) fn drive(&self, model: &Model, ride: &Ride<'_>) -> Result<Ridden, StudyError> {
        let id = ride.person.participant.as_str();
        let world = stream_seed(self.seed, &[id, "validate", &ride.world.to_string()]);
        let driven = drive_style(model, &ride.embedding, self.scenario, world)?.completed()?;
        let meta = DriveMeta::new(
            DriveId::new(format!("{id}-validate"))?,
            ride.person.participant.clone(),
            ride.person.first.meta().condition,
            DrivenBy::Automated,
        );
        let drive = Drive::from_recording(meta, &driven.recording)?;
        let read_back = ride
            .read_back
            .then(|| personalize(model, &drive, None))
            .transpose()?
            .map(|k| k.embedding);
        Ok(Ridden {
            values: values(&drive),
            report: driven.report,
            windows: windows(&drive),
            read_back,
        })
    }
}
