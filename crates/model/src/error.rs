//! What can go wrong with models.

use crate::heads_kind::HeadsKind;
use maveric_domain::{DomainError, DriveId, ScoreRange};

/// A training, a personalising or a model file that this crate refuses.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A setting outside its range.
    #[error("`{name}` is {found}, expected {expected}")]
    BadSetting {
        /// Name of the setting.
        name: &'static str,
        /// What was given.
        found: f64,
        /// The range in words.
        expected: &'static str,
    },
    /// Nobody whose style could be lent.
    #[error("the model keeps nobody whose style could be lent to somebody else")]
    NoDonor,
    /// Nothing to learn from.
    #[error("no drive to train on: {given} given, {excluded} of them shorter than a window")]
    NoDrives {
        /// Drives given.
        given: usize,
        /// Drives that were excluded.
        excluded: usize,
    },
    /// Two drives with one identifier.
    #[error("drive {drive} is given twice")]
    DuplicateDrive {
        /// The identifier that both have.
        drive: DriveId,
    },
    /// A drive without rows to fit an embedding to.
    #[error("drive {drive} lasts {found_s} s, expected at least {expected_s} s (one window)")]
    DriveTooShort {
        /// The drive that is too short.
        drive: DriveId,
        /// Its duration within the rows that may be used, in s.
        found_s: f64,
        /// The window's duration, in s.
        expected_s: f64,
    },
    /// Losses that stopped being numbers.
    #[error("training diverged in epoch {epoch}; lower `learning_rate`")]
    Diverged {
        /// The epoch, from 1.
        epoch: usize,
    },
    /// The caller asked to stop.
    #[error("stopped after epoch {epoch}")]
    Cancelled {
        /// Epochs that were completed.
        epoch: usize,
    },
    /// An embedding that does not belong to this model.
    #[error("embedding has {found} coordinates, the model has {expected}")]
    EmbeddingSize {
        /// Coordinates given.
        found: usize,
        /// Coordinates of the model.
        expected: usize,
    },
    /// A score of another scale than the model's, or than the other drives'.
    #[error("a score on a scale of {found}, expected one of {expected}")]
    OtherScale {
        /// The scale of the score.
        found: ScoreRange,
        /// The scale of the model, or of the other scores.
        expected: ScoreRange,
    },
    /// A window of another length than the model reads.
    #[error("window has {found} steps, the model reads {expected}")]
    WindowLength {
        /// Steps given.
        found: usize,
        /// Steps expected.
        expected: usize,
    },
    /// A window into which nothing was pushed.
    #[error("the window is empty; push a situation first")]
    EmptyWindow,
    /// A situation that is not later than the one before.
    #[error("situation at {found_s} s is not later than the one before at {last_s} s")]
    TimeNotIncreasing {
        /// Its time, in s.
        found_s: f64,
        /// The time before, in s.
        last_s: f64,
    },
    /// A signal that is NaN or infinite.
    #[error("`{signal}` is {found}, expected a finite number")]
    NotFinite {
        /// Name of the signal.
        signal: &'static str,
        /// What was found.
        found: f64,
    },
    /// A model trained without scores of the style has no direction of aggression.
    #[error(
        "the model learned no aggression axis: no drive it was trained on had a score of the style"
    )]
    NoAggressionAxis,
    /// An embedding of one number has nothing perpendicular to its axis.
    #[error("an embedding of size {found} has no perpendicular directions, expected at least 2")]
    NoPerpendicular {
        /// The model's embedding size.
        found: usize,
    },
    /// Too few scored drives to fit an attribute head to.
    #[error(
        "score `{score}`: {found} training drives have it, expected at least {expected} (two more than the embedding has numbers)"
    )]
    TooFewScores {
        /// Name of the score.
        score: String,
        /// Scored training drives.
        found: usize,
        /// Fewest that will do.
        expected: usize,
    },
    /// A score that is the same for every driver.
    #[error("score `{score}` is {found} for every training drive, expected drivers that differ")]
    ConstantScore {
        /// Name of the score.
        score: String,
        /// What it is.
        found: f64,
    },
    /// Scored drives that do not span style space.
    #[error(
        "score `{score}`: the {drives} training drives that have it do not differ in every direction of style space"
    )]
    FlatEmbeddings {
        /// Name of the score.
        score: String,
        /// Drives with the score.
        drives: usize,
    },
    /// An attribute head whose gradient is zero.
    #[error("attribute `{head}` does not change in any direction of style space")]
    FlatHead {
        /// The attribute.
        head: String,
    },
    /// More attributes than directions.
    #[error("{found} attributes to move or hold, expected 1 to {expected} (the embedding's size)")]
    TooManyAttributes {
        /// Attributes given.
        found: usize,
        /// The embedding's size.
        expected: usize,
    },
    /// Attributes that point the same way.
    #[error("`{moved}` cannot move alone: attributes {} point the same way in style space", heads.join(", "))]
    CollinearHeads {
        /// All of them.
        heads: Vec<String>,
        /// The one to move.
        moved: String,
    },
    /// Too few drivers for that many folds.
    #[error("{drivers} drivers cannot be split into {folds} folds")]
    TooFewDrivers {
        /// Drivers given.
        drivers: usize,
        /// Folds asked for.
        folds: usize,
    },
    /// Bytes that do not start like a model file.
    #[error("not a MAVERIC model file")]
    NotAModelFile,
    /// A model file of another version.
    #[error("model file has version {found}, this program reads {expected}; train again")]
    OtherVersion {
        /// Version of the file.
        found: u32,
        /// Version this program reads.
        expected: u32,
    },
    /// A model file that was cut off or added to.
    #[error("model file has {found} bytes after its header, expected {expected}")]
    WrongLength {
        /// Bytes found.
        found: usize,
        /// Bytes the header promises.
        expected: usize,
    },
    /// A model file with changed bytes.
    #[error("model file is damaged: checksum {found:016x}, expected {expected:016x}")]
    Damaged {
        /// Checksum of the bytes.
        found: u64,
        /// Checksum in the header.
        expected: u64,
    },
    /// A model file that contradicts itself.
    #[error("model file is not valid: {problem}")]
    BadModelFile {
        /// What is wrong.
        problem: String,
    },
    /// A model with other heads than asked for.
    #[error("the model has {found} heads, expected {expected}")]
    OtherHeads {
        /// Heads of the model.
        found: HeadsKind,
        /// Heads asked for.
        expected: HeadsKind,
    },
    /// A word that names no heads.
    #[error("no heads are called `{found}`, expected `linear` or `paper`")]
    UnknownHeads {
        /// The word.
        found: String,
    },
    /// A word for how free speeds are read that is not known.
    #[error("`{found}` is no way to read a free speed, expected `absolute` or `posted`")]
    UnknownFreeSpeed {
        /// The word.
        found: String,
    },
    /// A value that the domain refuses.
    #[error(transparent)]
    Domain(#[from] DomainError),
}

impl ModelError {
    pub(crate) fn bad_file(problem: impl Into<String>) -> Self {
        Self::BadModelFile { problem: problem.into() }
    }

    /// Refuses an embedding of `found` coordinates where `expected` are read.
    pub(crate) fn check_size(found: usize, expected: usize) -> Result<(), Self> {
        if found == expected { Ok(()) } else { Err(Self::EmbeddingSize { found, expected }) }
    }

    /// The next step, where one is known.
    pub fn suggestion(&self) -> Option<&'static str> {
        match self {
            Self::NoDrives { .. } | Self::DriveTooShort { .. } => {
                Some("record longer drives, or shorten `window_s`")
            }
            Self::TooFewScores { .. } | Self::FlatEmbeddings { .. } => {
                Some("score more of the training drivers, or train a smaller embedding")
            }
            Self::ConstantScore { .. } | Self::FlatHead { .. } => Some("choose another score"),
            Self::TooManyAttributes { .. } | Self::CollinearHeads { .. } => {
                Some("hold fewer attributes")
            }
            Self::NoPerpendicular { .. } => Some("train with `embedding_size` 2 or more"),
            Self::NoAggressionAxis => Some(
                "score the questionnaire of the style (the ADB's without a study) and train with its scores",
            ),
            Self::OtherScale { .. } => Some(
                "give scores of the model's own scale, or the study whose `[style]` says theirs, on which the model is then put",
            ),
            Self::Diverged { .. } => Some("lower `learning_rate` or `gradient_clip`"),
            Self::OtherHeads { expected: HeadsKind::Paper, .. } => {
                Some("train with `--heads paper`")
            }
            Self::OtherHeads { .. } => Some("train with `--heads linear`"),
            Self::NotAModelFile
            | Self::OtherVersion { .. }
            | Self::WrongLength { .. }
            | Self::Damaged { .. }
            | Self::BadModelFile { .. } => Some("train the model again"),
            _ => None,
        }
    }
}

/// Something left out while training or personalising, and why.
#[derive(Debug, Clone, PartialEq, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum ModelWarning {
    /// A drive that was not used.
    #[error("drive {drive} left out: {found_s} s, shorter than one window of {expected_s} s")]
    DriveLeftOut {
        /// The drive that is too short.
        drive: DriveId,
        /// Its duration, in s.
        found_s: f64,
        /// The window's duration, in s.
        expected_s: f64,
    },
    /// Nobody to tell apart.
    #[error(
        "all drives are of participant {participant}: what is style and what is the road cannot be told apart; \
         train on several drivers"
    )]
    OneDriver {
        /// Who drove.
        participant: maveric_domain::ParticipantId,
    },
    /// A drive that shows no habit.
    #[error("drive {drive} left out: it shows no habit")]
    NoHabits {
        /// The drive in which no head has an event.
        drive: DriveId,
    },
    /// A loss without data.
    #[error("{loss} left out: {reason}")]
    LossLeftOut {
        /// Which loss.
        loss: crate::losses::Loss,
        /// Why.
        reason: &'static str,
    },
}
