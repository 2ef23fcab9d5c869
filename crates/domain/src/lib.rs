#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod as_text;
pub mod condition;
pub mod design;
pub mod drive;
pub mod embedding;
pub mod error;
pub mod fitted;
pub mod ids;
pub mod measurement;
mod nearest;
pub mod occasion;
pub mod press;
pub mod recording;
pub mod scene;
pub mod seed;
pub mod sees;
pub mod setpoints;
pub mod steered;
pub mod survey;
pub mod trace;
pub mod traits;
pub mod units;

pub use condition::ConditionId;
pub use design::{Design, DesignError};
pub use drive::{Drive, DriveMeta, DrivenBy, LaneChange};
pub use embedding::Embedding;
pub use error::DomainError;
pub use fitted::{BeyondWhy, EmbeddingRow};
pub use ids::{DriveId, ParticipantId, VehicleId};
pub use measurement::{MeasureValues, MeasuredDrive, OwnMeasurement, spread};
pub use nearest::nearest;
pub use occasion::{Occasion, Ride};
pub use recording::{EgoTrack, ObjectTrack, Recording};
pub use scene::{EgoState, Reference, Road, Scene, Situation, VehicleState};
pub use seed::stream_seed;
pub use sees::Sees;
pub use setpoints::{LaneWish, Setpoints, When};
pub use steered::{ConditionRow, Lent, SweepPoint};
pub use survey::{
    Answer, Moment, NormCorrelation, Norms, ProbeAnswer, Scale, Score, ScoreRange, StyleScore,
    Subscale,
};
pub use trace::{LaneActivity, TraceRow};
pub use traits::LatentTraits;
pub use units::{Metres, MetresPerSecond, Seconds, SpeedUnit};
