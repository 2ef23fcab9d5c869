//! The drawing of the domain, which needs no numbers.

use maveric_report::{Context, Figure, ReportError, figures::domain::domain};

pub(crate) fn draw(context: &Context) -> Result<Figure, ReportError> {
    domain(context)
}
