//! What a person is shown, one step after the other: made of a study's design, fixed when the person is let in.

use crate::{error::SeatError, hindrance::Hindrance, withdrawal, words::Words};
use maveric_domain::{
    ConditionId, Design, Moment, Scale,
    design::{Car, Condition, Protocol, ProtocolStep, williams},
    nearest,
    survey::{Item, ItemWords},
};
use serde::{Deserialize, Serialize};

/// One step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Step {
    /// A text to read, to agree to where it says so.
    Text {
        /// Heading.
        title: String,
        /// Paragraphs, divided by empty lines; `#` heads one, `-` begins a point.
        text: String,
        /// Whether going on means agreeing: recorded with the text's hash.
        agree: bool,
    },
    /// One scale, on one page.
    Scale {
        /// Its id.
        scale: String,
        /// Its heading, if it has one.
        title: Option<String>,
        /// What stands above the items.
        instruction: Option<String>,
        /// What is asked, in the order of the items.
        items: Vec<Asked>,
        /// `pre`, or the condition it is asked after.
        moment: Moment,
    },
    /// Choosing and trying keyboard, gamepad or wheel.
    Controls,
    /// Driving until the lane was kept and somebody passed, or the time is over.
    Practice {
        /// At most so long, in s.
        seconds: f64,
        /// Time in the lane that is asked for, in s.
        lane_kept_s: f64,
        /// Vehicles to be passed.
        passes: u32,
        /// Root of the world's random choices.
        seed: String,
    },
    /// The drive by hand that is learned from.
    Drive {
        /// The label of the drive.
        condition: ConditionId,
        /// How long, in s.
        seconds: f64,
        /// Root of the world's random choices.
        seed: String,
    },
    /// A ride.
    Ride {
        /// The condition.
        condition: ConditionId,
        /// Its number, as the person is told.
        number: usize,
        /// How long, in s.
        seconds: f64,
        /// Root of the world's random choices.
        seed: String,
        /// Whose style.
        style: RideStyle,
        /// From where on the dial, in points of the study's style.
        points: f64,
        /// Points of the model for one of the study's.
        stretch: f64,
        /// Points a step of the dial towards sportier (negative on a score of calmness), where the person may turn it.
        turns: Option<f64>,
    },
    /// The end.
    Thanks {
        /// As in [`Step::Text`].
        text: String,
        /// For the platform that pays.
        code: Option<String>,
    },
}

/// An item as a page shows it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    /// How it is answered.
    #[serde(flatten)]
    pub item: Item,
    /// Its words.
    #[serde(flatten)]
    pub words: ItemWords,
}

/// Each ride of these steps, and what the page calls it.
pub(crate) fn coded_rides(steps: &[Step]) -> Vec<(ConditionId, ConditionId)> {
    let coded = |step: &Step| match step {
        Step::Ride {
            condition, number, ..
        } => {
            let number = ConditionId::new(&format!("ride-{number}"));
            Some((*condition, number.ok()?))
        }
        _ => None,
    };
    steps.iter().filter_map(coded).collect()
}

/// Whose style drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RideStyle {
    /// The person's own.
    Own,
    /// The average driver's.
    Mean,
}

impl Step {
    /// The drive that this step makes: its label and whether a person drives.
    pub fn drives(&self) -> Option<(ConditionId, bool)> {
        match self {
            Self::Drive { condition, .. } => Some((*condition, true)),
            Self::Ride { condition, .. } => Some((*condition, false)),
            _ => None,
        }
    }

    /// This step as the page is told it: a ride is known by its number, since who rides is not to read the condition.
    pub(crate) fn for_page(&self, rides: &[(ConditionId, ConditionId)]) -> Self {
        let coded = |id: ConditionId| rides.iter().find(|(c, _)| *c == id).map(|(_, n)| *n);
        let mut step = self.clone();
        match &mut step {
            Self::Ride { condition, .. } => {
                *condition = coded(*condition).unwrap_or(*condition);
            }
            Self::Scale {
                moment: Moment::After(condition),
                ..
            } => *condition = coded(*condition).unwrap_or(*condition),
            _ => {}
        }
        step
    }

    /// Seed and length in s of what is driven here, practice included.
    pub fn world(&self) -> Option<(&str, f64)> {
        match self {
            Self::Practice { seed, seconds, .. }
            | Self::Drive { seed, seconds, .. }
            | Self::Ride { seed, seconds, .. } => Some((seed, *seconds)),
            _ => None,
        }
    }
}

/// The texts that a protocol names, as they were read.
#[derive(Debug, Clone, Default)]
pub struct Texts {
    /// What is agreed to.
    pub consent: Option<String>,
    /// What is said at the end.
    pub thanks: Option<String>,
    /// What the seat says by itself.
    pub words: Words,
}

/// The steps of a person; `world` gives the root of random choices of what is driven (`practice`, or a condition), `riding` is the person's number among those who ride (from 0) and the points of the model for one of the
/// study's style, none while nobody rides.
///
/// # Errors
/// [`SeatError::Protocol`] for a scale without wording, a condition that the seat cannot drive or one that the design lets the program
/// simulate instead.
pub fn of_design(
    design: &Design,
    scales: &[Scale],
    texts: &Texts,
    world: &dyn Fn(&str) -> String,
    riding: Option<(usize, f64)>,
) -> Result<Vec<Step>, SeatError> {
    let protocol = design.protocol();
    let own = design
        .baseline_id()
        .map_or_else(|| ConditionId::new("own"), Ok);
    let own = own.map_err(|e| SeatError::Protocol {
        problem: e.to_string(),
        help: None,
    })?;
    let mut steps = Vec::new();
    for step in &protocol.steps {
        match step {
            ProtocolStep::Consent => {
                if let Some(text) = &texts.consent {
                    steps.push(Step::Text {
                        title: design.title().to_owned(),
                        text: withdrawal::in_consent(
                            text,
                            protocol.withdraw_until.as_deref(),
                            &texts.words,
                        )?,
                        agree: true,
                    });
                }
            }
            ProtocolStep::Before => {
                for id in &protocol.before {
                    steps.push(sheet(scales, id, Moment::Pre, &protocol.language)?);
                }
            }
            ProtocolStep::Controls => steps.push(Step::Controls),
            ProtocolStep::Practice => steps.push(Step::Practice {
                seconds: protocol.practice.at_most_s,
                lane_kept_s: protocol.practice.lane_kept_s,
                passes: protocol.practice.passes,
                seed: world("practice"),
            }),
            ProtocolStep::Drive => steps.push(Step::Drive {
                condition: own,
                seconds: protocol.drive_s,
                seed: world(own.as_str()),
            }),
            ProtocolStep::Rides => {
                if let Some(who) = riding {
                    rides(design, scales, world, who, &mut steps)?;
                }
            }
        }
    }
    steps.push(Step::Thanks {
        text: texts.thanks.clone().unwrap_or_default(),
        code: protocol.code.clone(),
    });
    Ok(steps)
}

fn rides(
    design: &Design,
    scales: &[Scale],
    world: &dyn Fn(&str) -> String,
    (index, stretch): (usize, f64),
    steps: &mut Vec<Step>,
) -> Result<(), SeatError> {
    let protocol: &Protocol = design.protocol();
    let conditions = design.conditions();
    for (number, place) in williams(conditions.len(), index).into_iter().enumerate() {
        let condition = &conditions[place];
        let (style, points, turns) = car(design, condition)?;
        steps.push(Step::Ride {
            condition: condition.id,
            number: number + 1,
            seconds: protocol.ride_s,
            seed: world(condition.id.as_str()),
            style,
            points,
            stretch,
            turns,
        });
        for id in &protocol.after {
            let moment = Moment::After(condition.id);
            steps.push(sheet(scales, id, moment, &protocol.language)?);
        }
    }
    Ok(())
}

/// Points that the dial turns at a press where the design has no step: a third of the paper's 15.
const DIAL_STEP: f64 = 5.0;

/// What a car does: whose style, where on the dial it begins, and points a turn where it can be turned.
type Driven = (RideStyle, f64, Option<f64>);

/// What the car does in a condition.
pub(crate) fn car(design: &Design, condition: &Condition) -> Result<Driven, Hindrance> {
    let id = condition.id;
    if condition.simulated() {
        return Err(Hindrance::SimulatedAgain { condition: id });
    }
    let step = design.style().map_or(DIAL_STEP, |style| {
        let points = style.points.map_or(DIAL_STEP, |points| points / 3.0);
        points * style.aggression.factor()
    });
    match &condition.car {
        Some(Car::Dial(points)) => Ok((RideStyle::Own, *points, None)),
        Some(Car::Mean) => Ok((RideStyle::Mean, 0.0, None)),
        Some(Car::Free) => Ok((RideStyle::Own, 0.0, Some(step))),
        other => Err(Hindrance::Car {
            condition: id,
            problem: match other {
                None => "it has no `car`",
                Some(Car::Embedding(_)) => {
                    "its `car` drives by a file of embeddings, which the seat does not"
                }
                Some(_) => "its `car` drives `across` the dial, which the seat does not",
            },
        }),
    }
}

/// A scale as a page, in the study's language.
///
/// # Errors
/// [`Hindrance`] for a scale that no file has, one without that language, or one without wording.
pub fn sheet(
    scales: &[Scale],
    id: &str,
    moment: Moment,
    language: &str,
) -> Result<Step, Hindrance> {
    let Some(scale) = scales.iter().find(|s| s.id == id) else {
        let known: Vec<String> = scales.iter().map(|s| s.id.clone()).collect();
        return Err(Hindrance::UnknownScale {
            scale: id.to_owned(),
            nearest: nearest(id, known.iter().map(String::as_str)).map(str::to_owned),
            known,
        });
    };
    let Some(wording) = scale.wording_in(language) else {
        return Err(Hindrance::NoTranslation {
            scale: id.to_owned(),
            language: language.to_owned(),
            languages: scale.languages().map(str::to_owned).collect(),
        });
    };
    let (worded, items) = (wording.worded(), scale.items.len());
    if worded != items {
        let scale = id.to_owned();
        return Err(Hindrance::NoWording {
            scale,
            worded,
            items,
        });
    }
    let items = scale.items.iter().zip(&wording.items);
    let asked = |(item, words): (&Item, &ItemWords)| Asked {
        // What the answers are scored and judged by is not for the page.
        item: Item {
            reversed: false,
            expected: None,
            ..item.clone()
        },
        words: words.clone(),
    };
    Ok(Step::Scale {
        scale: scale.id.clone(),
        title: wording.shown_title.clone(),
        instruction: wording.instruction.clone(),
        items: items.map(asked).collect(),
        moment,
    })
}
