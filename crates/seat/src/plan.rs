//! The steps of a person, made of a study's design and fixed when the person is let in.

use crate::{
    error::SeatError,
    hindrance::Hindrance,
    moments,
    steps::{AskedProbe, Step, Texts, sheet},
    withdrawal,
};
use maveric_domain::{
    ConditionId, Design, EmbeddingRow, Moment, ParticipantId, Scale,
    design::{Car, Condition, Protocol, ProtocolStep, williams},
    stream_seed,
};
use maveric_seat_page::{RideStyle, Seed};
use maveric_study::{StudyError, tables::embeddings::style_of};
use std::{collections::BTreeMap, path::PathBuf};

/// The files of styles that conditions name, by the path that the design has.
pub type Styles = BTreeMap<PathBuf, Vec<EmbeddingRow>>;

/// By what somebody's random choices and rows are found.
#[derive(Debug, Clone, Copy)]
pub enum Whose<'a> {
    /// By their id.
    Person(&'a str),
    /// By the token of their browser, where no server gives ids.
    Link(&'a str),
    /// Nobody's yet: the page draws by its token.
    Nobody,
}

impl Whose<'_> {
    /// Root of the random choices of a world.
    fn world(self, root: u64, what: &str) -> String {
        match self {
            Self::Person(id) => stream_seed(root, &[id, what, "world"]).to_string(),
            Self::Link(token) => maveric_seat_page::world(token, what).to_string(),
            Self::Nobody => String::new(),
        }
    }

    /// Root of the angle across the dial: of a person the one that `maveric steer` takes.
    fn angle(self, root: u64, condition: ConditionId) -> Seed {
        Seed(match self {
            Self::Person(id) => stream_seed(root, &[id, condition.as_str()]),
            Self::Link(token) => maveric_seat_page::world(token, &format!("{condition} across")),
            Self::Nobody => 0,
        })
    }
}

/// Somebody who rides.
#[derive(Debug, Clone, Copy)]
pub struct Riding<'a> {
    /// Their number among those who ride, from 0.
    pub index: usize,
    /// Points of the model for one of the study's style.
    pub stretch: f64,
    /// The styles that conditions name.
    pub styles: &'a Styles,
}

/// The steps of a person; `riding` is none while nobody rides.
///
/// # Errors
/// [`SeatError::Protocol`] for a scale without wording, a condition that the seat cannot drive or one that the design lets the program
/// simulate instead; [`SeatError::Study`] for somebody whose style no file has.
pub fn of_design(
    design: &Design,
    scales: &[Scale],
    texts: &Texts,
    whose: Whose<'_>,
    riding: Option<Riding<'_>>,
) -> Result<Vec<Step>, SeatError> {
    let protocol = design.protocol();
    let own = design
        .baseline_id()
        .map_or_else(|| ConditionId::new("own"), Ok);
    let own = own.map_err(|e| SeatError::Protocol {
        problem: e.to_string(),
        help: None,
    })?;
    let world = |what: &str| whose.world(protocol.seed, what);
    let probe = moments::probe(protocol, scales)?;
    // Where it may stop somebody it is asked in every drive.
    let stops = probe.clone().filter(|probe| probe.stop.is_some());
    let mut steps = Vec::new();
    for step in &protocol.steps {
        match step {
            ProtocolStep::Screen => steps.extend(moments::screen(protocol, scales)?),
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
                probe: stops.clone(),
            }),
            ProtocolStep::Drive => steps.push(Step::Drive {
                condition: own,
                seconds: protocol.drive_s,
                seed: world(own.as_str()),
                probe: stops.clone(),
            }),
            ProtocolStep::Rides => {
                if let Some(riding) = riding {
                    rides(design, (scales, probe.as_ref()), whose, riding, &mut steps)?;
                }
            }
            ProtocolStep::Post => {
                for id in &protocol.post {
                    steps.push(sheet(scales, id, Moment::Post, &protocol.language)?);
                }
            }
        }
    }
    let words = &texts.words;
    if steps.iter().any(|step| step.world().is_some()) {
        let told = || words.sentence("aftercare").to_owned();
        let text = texts.aftercare.clone().unwrap_or_else(told);
        steps.push(Step::Aftercare { text });
    }
    if let Some(text) = &texts.debrief {
        steps.push(Step::Text {
            title: words.sentence("debrief_title").to_owned(),
            text: text.clone(),
            agree: false,
        });
    }
    steps.push(Step::Thanks {
        text: texts.thanks.clone().unwrap_or_default(),
        code: protocol.code.clone(),
    });
    Ok(steps)
}

fn rides(
    design: &Design,
    (scales, probe): (&[Scale], Option<&AskedProbe>),
    whose: Whose<'_>,
    riding: Riding<'_>,
    steps: &mut Vec<Step>,
) -> Result<(), SeatError> {
    let protocol: &Protocol = design.protocol();
    let conditions = design.conditions();
    let order = williams(conditions.len(), riding.index);
    for (number, place) in order.into_iter().enumerate() {
        let condition = &conditions[place];
        let (style, points, turns) = driven(design, condition, whose, riding.styles)?;
        steps.push(Step::Ride {
            condition: condition.id,
            number: number + 1,
            seconds: protocol.ride_s,
            seed: whose.world(protocol.seed, condition.id.as_str()),
            style,
            points,
            stretch: riding.stretch,
            turns,
            probe: probe.cloned(),
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

/// What the car does in a condition: whose style, where on the dial it begins, and points a turn where it can be turned.
fn driven(
    design: &Design,
    condition: &Condition,
    whose: Whose<'_>,
    styles: &Styles,
) -> Result<(RideStyle, f64, Option<f64>), SeatError> {
    let step = design.style().map_or(DIAL_STEP, |style| {
        let points = style.points.map_or(DIAL_STEP, |points| points / 3.0);
        points * style.aggression.factor()
    });
    let root = design.protocol().seed;
    Ok(match car(condition)? {
        Car::Dial(points) => (RideStyle::Own, *points, None),
        Car::Free => (RideStyle::Own, 0.0, Some(step)),
        Car::Mean => (RideStyle::Mean, 0.0, None),
        Car::Across => (
            RideStyle::Across(whose.angle(root, condition.id)),
            0.0,
            None,
        ),
        Car::Embedding(file) => {
            let rows = styles.get(file).map_or(&[][..], Vec::as_slice);
            let id = match whose {
                Whose::Person(id) => Some(ParticipantId::new(id).map_err(StudyError::from)?),
                Whose::Link(_) | Whose::Nobody => None,
            };
            let style = style_of(rows, file, id.as_ref())?.clone();
            (RideStyle::Given(style), 0.0, None)
        }
        _ => {
            return Err(
                Hindrance::no_car(condition.id, "the seat does not drive its `car`").into(),
            );
        }
    })
}

/// The car of a condition, if the seat may drive it.
pub(crate) fn car(condition: &Condition) -> Result<&Car, Hindrance> {
    if condition.simulated() {
        return Err(Hindrance::SimulatedAgain {
            condition: condition.id,
        });
    }
    match &condition.car {
        None => Err(Hindrance::no_car(condition.id, "it has no `car`")),
        Some(car) => Ok(car),
    }
}
