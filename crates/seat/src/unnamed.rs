//! What a page is given of the people learned from: their styles under numbers. It tells neither who they are nor whose style may not be lent.

use crate::{error::SeatError, steps::Step};
use maveric_domain::DriveId;
use maveric_model::{Model, model_file};
use maveric_seat_page::RideStyle;

/// The names that the drives of a model have on a page, in their order.
fn numbers(model: &Model) -> Result<Vec<DriveId>, SeatError> {
    let numbers = (1..=model.training().len()).map(|number| DriveId::new(format!("D{number}")));
    Ok(numbers.collect::<Result<_, _>>()?)
}

/// The file of a model with numbers in the place of the names.
pub(crate) fn model(model: &Model) -> Result<Vec<u8>, SeatError> {
    let unnamed = model.clone().with_names(numbers(model)?);
    Ok(model_file::to_bytes(&unnamed)?)
}

/// A step whose style is drawn with that file.
pub(crate) fn step(model: Option<&Model>, mut step: Step) -> Result<Step, SeatError> {
    if let Step::Ride { style: RideStyle::Lent { withheld, .. }, .. } = &mut step
        && let Some(model) = model
    {
        let named = std::mem::take(withheld);
        let drives = model.training().iter().zip(numbers(model)?);
        let drives = drives.filter(|(drive, _)| named.contains(&drive.drive));
        withheld.extend(drives.map(|(_, number)| number));
    }
    Ok(step)
}
