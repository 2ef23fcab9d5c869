//! The same numbers as for the straight axis, all round.

pub(crate) use super::perpendicular::input;
use maveric_report::{
    Context, Figure, ReportError, figures::perpendicular_circle::perpendicular_circle,
};

pub(crate) fn draw(context: &Context) -> Result<Figure, ReportError> {
    perpendicular_circle(&input(), context)
}
