//! What every figure is drawn with.

pub(super) use super::axes::{Frame, Labels, Place, Scale, extent};
pub(super) use super::canvas::{Canvas, Look, Pen, cap_height};
pub(super) use super::check::Check;
pub(super) use super::figure::{Context, Figure, Plan, Shows, draw};
pub(super) use super::grid::{Grid, draw_panels};
pub(super) use super::legend::Key;
pub(super) use super::panel::Panel;
pub(super) use super::rows::Rows;
pub(super) use super::theme::{
    BLUE, GREEN, GREY, GRID, INK, MUTED, Marker, OCHRE, ONE_COLUMN_MM, ORANGE, PALE, PAPER, PURPLE,
    TWO_COLUMNS_MM, size, stroke,
};
pub(super) use super::words::{counted, described, of_part, sentences};
pub(super) use crate::error::ReportError;
pub(super) use crate::{apa::number, markup};
pub(super) use plotters::style::RGBColor;
pub(super) use serde::{Deserialize, Serialize};
