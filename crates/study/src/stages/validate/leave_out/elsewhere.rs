//! What a model that was learned elsewhere says of these people.

use super::{
    Bench,
    folds::{first_in, read_alone},
    role_of,
};
use crate::{
    error::StudyError,
    outcome::{Watch, for_each_on},
    recordings::Recorded,
    run_folder::read_model,
};
use maveric_domain::{BeyondWhy, ScoreRange};
use maveric_model::{Personalized, Support, style_space::LinearHead};
use maveric_rehearsal::leave_out::{
    By, Drove, Missing, Shipped, ShippedPerson, Uncounted, people, shipped,
};

/// Reads everybody's drive in the higher role and in the ordinary one by the model that was given; none where none was.
pub(super) fn said_of(
    bench: &Bench<'_>,
    rows: &[&Recorded],
    drove: &[Drove],
    watch: Watch<'_>,
) -> Result<Option<Shipped>, StudyError> {
    let Some(path) = bench.options.models.first() else {
        return Ok(None);
    };
    let model = read_model(path)?;
    let (axis, range) = (LinearHead::aggression(&model)?, model.score_range());
    let fitted = for_each_on(bench.options.jobs, rows, watch, "styles", |row| {
        Ok(read_alone(&model, &row.drive)?)
    })?;
    let (ordinary, higher) =
        (role_of(bench.table.lower.first().copied())?, role_of(bench.table.higher)?);
    let (mut readings, mut uncounted) = (Vec::new(), Vec::new());
    for who in people(drove) {
        for role in [ordinary, higher] {
            let why = match first_in(drove, &who, role) {
                None => Some(Missing::Drive { role }),
                Some(place) => fitted[place]
                    .is_none()
                    .then(|| Missing::Reading { drive: drove[place].drive.clone(), by: By::Line }),
            };
            uncounted.extend(why.map(|why| Uncounted { participant: who.clone(), why }));
        }
        let known = |role| -> Option<&Personalized> {
            let place = first_in(drove, &who, role)?;
            fitted[place].as_ref()
        };
        let position = |role| {
            let position = known(role).map(|k| axis.position(&k.embedding));
            position.transpose()
        };
        let (of_ordinary, of_higher) = (position(ordinary)?, position(higher)?);
        let se = |role| known(role).and_then(|k| k.sd_along(axis.gradient()));
        let ses = se(ordinary).zip(se(higher));
        readings.push(ShippedPerson {
            line: of_higher.zip(of_ordinary).map(|(h, o)| h - o),
            line_se: ses.map(|(o, h)| libm::hypot(o, h)),
            ordinary_beyond: known(ordinary).and_then(|k| beyond(range, k)),
            higher_beyond: known(higher).and_then(|k| beyond(range, k)),
            participant: who,
        });
    }
    Ok(Some(shipped(readings, model.people(), uncounted)?))
}

/// Whether a drive is beyond what the model has met, before any style is fitted or because it reads as a score that the scale does not
/// have; none where the model cannot say.
fn beyond(range: ScoreRange, known: &Personalized) -> Option<bool> {
    let (support, reading) = (known.support.as_ref(), known.aggression_hat);
    let (_, why) = BeyondWhy::of_reading(range, reading, support.and_then(Support::beyond));
    let says = support.is_some_and(|s| s.p.is_some());
    (says || why.is_some()).then(|| why.is_some())
}
