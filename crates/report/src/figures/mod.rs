//! The figures: each a function from exactly the plain numbers that it draws.

mod axes;
mod canvas;
pub(crate) mod check;
mod fit;
mod font;
mod page;
mod png;
mod projection;
mod theme;
mod vehicle;

pub mod ablation;
pub mod aggression_line;
pub mod architecture;
pub mod calibration;
pub mod car_following;
pub mod curves;
pub mod dial_sweep;
pub mod difference_panels;
pub mod domain;
pub mod drive_overview;
pub mod embedding_space;
pub mod false_positives;
pub mod fidelity;
pub mod following_errors;
pub mod learning_curve;
pub mod perpendicular;
pub mod preference;
pub mod recommendation;
pub mod residuals;
pub mod simulator_view;
pub mod training_curves;

mod figure;

pub use ablation::ablation;
pub use aggression_line::aggression_line;
pub use architecture::architecture;
pub use calibration::calibration;
pub use car_following::car_following;
pub use curves::curves;
pub use dial_sweep::dial_sweep;
pub use difference_panels::difference_panels;
pub use domain::domain;
pub use drive_overview::drive_overview;
pub use embedding_space::embedding_space;
pub use false_positives::false_positives;
pub use fidelity::fidelity;
pub use figure::{Context, Figure};
pub use following_errors::following_errors;
pub use learning_curve::learning_curve;
pub use perpendicular::perpendicular;
pub use preference::preference;
pub use recommendation::recommendation;
pub use residuals::residuals;
pub use simulator_view::simulator_view;
pub use training_curves::training_curves;

pub(crate) use figure::{Plan, Shows, draw};
pub(crate) use font::font_face_css;
pub(crate) use theme::{DARK, colour as condition_colour, hex};
