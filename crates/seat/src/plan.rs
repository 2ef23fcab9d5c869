//! The steps of a person, made of a study's design and fixed when the person is let in.

use crate::{
    crash,
    error::SeatError,
    hindrance::Hindrance,
    moments,
    needs::Need,
    steps::{ASKED_AGAIN_S, AskedProbe, Step, Texts, sheet},
    withdrawal,
};
use maveric_domain::{
    ConditionId, Design, EmbeddingRow, Moment, Occasion, ParticipantId, Ride, Scale, ScoreRange,
    design::{Car, Condition, Donors, Protocol, ProtocolStep, WHICH, World},
    occasion::is_first,
    stream_seed,
};
use maveric_seat_page::{RideStyle, Seed};
use maveric_study::tables::embeddings::style_of;
use std::{collections::BTreeMap, path::PathBuf};

/// The files of styles that conditions name, by the path that the design has.
pub(crate) type Styles = BTreeMap<PathBuf, Vec<EmbeddingRow>>;

/// Root of the random choices of a world that nobody else has.
fn own_world(root: u64, participant: &str, what: &str) -> String {
    stream_seed(root, &[participant, what, "world"]).to_string()
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Riding<'a> {
    /// The places that the conditions have in the design, in the order in which they are ridden.
    pub(crate) order: &'a [usize],
    /// The styles that conditions name.
    pub(crate) styles: &'a Styles,
    /// What the dial is counted in points of.
    pub(crate) range: ScoreRange,
}

/// The steps of a person; `riding` is none while nobody rides.
///
/// # Errors
/// [`SeatError::Protocol`] for a scale without wording, a condition that the seat cannot drive or one that the design lets the program
/// simulate instead; [`SeatError::Study`] for somebody whose style no file has.
pub(crate) fn of_design(
    design: &Design,
    scales: &[Scale],
    texts: &Texts,
    participant: &str,
    riding: Option<Riding<'_>>,
) -> Result<Vec<Step>, SeatError> {
    let baseline = ConditionId::new(design.own_drive_label())?;
    let language = texts.words.language.as_str();
    let probe = moments::probe(design.protocol(), scales, language)?;
    let planning = Planning {
        design,
        scales,
        texts,
        participant,
        riding,
        baseline,
        // Where it may stop somebody it is asked in every drive.
        stops: probe.clone().filter(|probe| probe.stop.is_some()),
        probe,
    };
    let mut steps = planning.before();
    for session in 1..=design.protocol().session_count() {
        if let Some(occasion) = Occasion::new(session, 1) {
            planning.session(occasion, &mut steps)?;
        }
    }
    planning.end(&mut steps);
    Ok(steps)
}

/// What the steps of a person are made of.
struct Planning<'a> {
    design: &'a Design,
    scales: &'a [Scale],
    texts: &'a Texts,
    participant: &'a str,
    riding: Option<Riding<'a>>,
    /// The label of the drive by hand.
    baseline: ConditionId,
    probe: Option<AskedProbe>,
    stops: Option<AskedProbe>,
}

impl Planning<'_> {
    /// What comes before anything is asked or driven.
    fn before(&self) -> Vec<Step> {
        let protocol = self.design.protocol();
        let chooses = (!protocol.languages.is_empty())
            .then(|| Step::Language { languages: protocol.languages.clone(), chosen: None });
        let needs = protocol.needs.as_ref().map(Need::of_study);
        let needs = needs.map(|needs| Step::Computer { needs });
        chooses.into_iter().chain(needs).collect()
    }

    /// Everything of one session, by its first ride.
    fn session(&self, occasion: Occasion, steps: &mut Vec<Step>) -> Result<(), SeatError> {
        let protocol = self.design.protocol();
        if occasion != Occasion::FIRST {
            let sessions = protocol.sessions.as_ref();
            steps.push(Step::Between {
                session: occasion.session,
                days: sessions.map_or([0, 0], |s| s.days_between),
            });
        }
        let (session, last) = (occasion.session.get(), protocol.session_count());
        let parts = protocol.steps.iter().copied();
        for part in parts.filter(|part| has_part(session, last, *part)) {
            self.part(part, occasion, steps)?;
        }
        Ok(())
    }

    /// One part of a session.
    fn part(
        &self,
        part: ProtocolStep,
        occasion: Occasion,
        steps: &mut Vec<Step>,
    ) -> Result<(), SeatError> {
        let protocol = self.design.protocol();
        match part {
            ProtocolStep::Screen => {
                steps.extend(moments::screen(protocol, self.scales, self.language())?);
            }
            ProtocolStep::Consent => steps.extend(self.consent()?),
            ProtocolStep::Before => self.sheets(&protocol.before, Moment::Pre, steps)?,
            ProtocolStep::Controls => steps.push(Step::Controls),
            ProtocolStep::Practice => steps.push(Step::Practice {
                seconds: protocol.practice.at_most_s,
                lane_kept_s: protocol.practice.lane_kept_s,
                passes: protocol.practice.passes,
                seed: own_world(protocol.seed, self.participant, "practice"),
                probe: self.stops.clone(),
            }),
            ProtocolStep::Drive => {
                let condition = self.baseline;
                let ride = Ride { condition, occasion };
                steps.push(Step::Drive {
                    condition,
                    occasion,
                    seconds: protocol.drive_s,
                    seed: world(protocol, self.participant, (0, ride)),
                    probe: self.stops.clone(),
                });
            }
            ProtocolStep::Rides => {
                if let Some(riding) = self.riding {
                    self.rides(riding, occasion.session.get(), steps)?;
                }
            }
            ProtocolStep::Which => {
                if let Some((pair, riding)) = protocol.which.zip(self.riding) {
                    steps.push(self.which(pair, riding.order)?);
                }
            }
            ProtocolStep::Break => steps.push(Step::Break { seconds: protocol.break_s }),
            ProtocolStep::Post => self.sheets(&protocol.post, Moment::Post, steps)?,
        }
        Ok(())
    }

    /// Which of two rides was in the own style: the numbers that these rides had for the person stand in what is asked.
    fn which(&self, pair: [ConditionId; 2], order: &[usize]) -> Result<Step, Hindrance> {
        let mut step = sheet(self.scales, WHICH, Moment::Post, self.language())?;
        let conditions = self.design.conditions();
        let is_one = |place: &usize| pair.contains(&conditions[*place].id);
        let numbers = (1..).zip(order).filter(|(_, place)| is_one(place));
        let numbers: Vec<String> = numbers.map(|(number, _)| number.to_string()).collect();
        if let (Step::Scale { instruction: Some(text), .. }, [earlier, later]) =
            (&mut step, numbers.as_slice())
        {
            *text = text.replace("{earlier}", earlier).replace("{later}", later);
        }
        Ok(step)
    }

    /// The rides of a session, each with what is asked after it.
    fn rides(
        &self,
        riding: Riding<'_>,
        session: u32,
        steps: &mut Vec<Step>,
    ) -> Result<(), SeatError> {
        let (design, participant) = (self.design, self.participant);
        let (protocol, conditions) = (design.protocol(), design.conditions());
        let trials = 1..=protocol.rides_per_condition;
        let ridden = trials.flat_map(|trial| riding.order.iter().map(move |place| (trial, *place)));
        let shown_again = conditions.iter().any(|c| c.car == Some(Car::Replay));
        let a_session = riding.order.len() * protocol.rides_per_condition as usize;
        for (number, (trial, place)) in (1..).zip(ridden) {
            let condition = &conditions[place];
            let ride = Ride {
                condition: condition.id,
                // Both are counted from 1.
                occasion: Occasion::new(session, trial).unwrap_or_default(),
            };
            if ridden_elsewhere(design) {
                steps.push(Step::Elsewhere {
                    condition: condition.id,
                    occasion: ride.occasion,
                    number,
                });
            } else {
                let (style, points, turns) = driven(design, condition, participant, riding)?;
                let among_all = (session as usize - 1) * a_session + number;
                // The world of the drive, where that is shown again.
                let among_all = if shown_again { 0 } else { among_all };
                steps.push(Step::Ride {
                    condition: condition.id,
                    occasion: ride.occasion,
                    number,
                    seconds: protocol.ride_s,
                    seed: world(protocol, participant, (among_all, ride)),
                    style,
                    points,
                    turns,
                    lent: None,
                    probe: self.probe.clone(),
                });
            }
            self.sheets(&protocol.after, Moment::After(ride), steps)?;
        }
        Ok(())
    }

    /// Scales that are asked at a moment.
    fn sheets(
        &self,
        ids: &[String],
        moment: Moment,
        steps: &mut Vec<Step>,
    ) -> Result<(), Hindrance> {
        for id in ids {
            steps.push(sheet(self.scales, id, moment, self.language())?);
        }
        Ok(())
    }

    fn language(&self) -> &str {
        &self.texts.words.language
    }

    /// What is agreed to; none where the study has no text.
    fn consent(&self) -> Result<Option<Step>, SeatError> {
        let Some(text) = &self.texts.consent else {
            return Ok(None);
        };
        let until = self.design.protocol().withdraw_until.as_deref();
        let words = &self.texts.words;
        let text = withdrawal::in_consent(text, until, words)?;
        Ok(Some(Step::Text {
            title: self.design.title().to_owned(),
            text: crash::in_consent(&text, words),
            agree: true,
            lend: self.may_lend().then(|| words.sentence("lend_sentence").to_owned()),
        }))
    }

    /// Whether this person's style may come to be lent to others: of everybody who is learned from, since a model that learned from them
    /// lends theirs until enough have ridden; and of everybody who rides, or for whom the program simulates, where the tested lend theirs.
    fn may_lend(&self) -> bool {
        let (design, protocol) = (self.design, self.design.protocol());
        let people = design.people();
        let rides = self.riding.is_some();
        let words = if rides { &people.test } else { &people.learn };
        let words = words.as_ref();
        let word = |column: &str| words?.get(column).map(String::as_str);
        let is_learned_from = design.model().is_none() && people.learns_from(word);
        let lends = |condition: &Condition| match &condition.car {
            Some(Car::Matched(matched)) => {
                let is_tested = rides || condition.simulated();
                is_learned_from || is_tested && matched.from == Donors::Tested
            }
            _ => false,
        };
        protocol.steps.contains(&ProtocolStep::Drive) && design.conditions().iter().any(lends)
    }

    /// What is told at the end.
    fn end(&self, steps: &mut Vec<Step>) {
        let (texts, words) = (self.texts, &self.texts.words);
        if steps.iter().any(|step| step.world().is_some()) {
            let standard = || words.sentence("aftercare").to_owned();
            let again =
                self.stops.clone().map(|probe| AskedProbe { every_s: ASKED_AGAIN_S, ..probe });
            steps.push(Step::Aftercare {
                text: texts.aftercare.clone().unwrap_or_else(standard),
                again,
            });
        }
        if let Some(text) = &texts.debrief {
            steps.push(Step::Text {
                title: words.sentence("debrief_title").to_owned(),
                text: text.clone(),
                agree: false,
                lend: None,
            });
        }
        steps.push(Step::Thanks {
            text: texts.thanks.clone().unwrap_or_default(),
            code: self.design.protocol().code.clone(),
        });
    }
}

/// Whether a session has a part of the protocol: the first has everything that comes before the drives, the last what is asked at the end.
fn has_part(session: u32, last: u32, part: ProtocolStep) -> bool {
    match part {
        ProtocolStep::Screen
        | ProtocolStep::Consent
        | ProtocolStep::Before
        | ProtocolStep::Practice => session == 1,
        ProtocolStep::Controls
        | ProtocolStep::Drive
        | ProtocolStep::Rides
        | ProtocolStep::Break => true,
        ProtocolStep::Which | ProtocolStep::Post => session == last,
    }
}

/// Root of the world of a ride by its number through all sessions, or of the drive by hand, which is 0 in each.
fn world(protocol: &Protocol, participant: &str, (ride, what): (usize, Ride)) -> String {
    let number = match protocol.world {
        World::ByRide => ride,
        World::Same => ride.min(1),
        World::Own => return own_world(protocol.seed, participant, &what.to_string()),
    };
    let number = number.to_string();
    let mut named = vec!["world", &number];
    // Nothing is met twice: the drive by hand of a further session is in a world of its own.
    let session = what.occasion.session.to_string();
    let again = ride == 0 && !is_first(&what.occasion.session);
    if protocol.world == World::ByRide && again {
        named.extend(["session", &session]);
    }
    stream_seed(protocol.seed, &named).to_string()
}

/// Whether every ride is in a car that is not the seat's: no condition has a car of ours.
pub(crate) fn ridden_elsewhere(design: &Design) -> bool {
    design.conditions().iter().all(|c| c.car.is_none())
}

/// What the car does in a condition: whose style, where on the dial it begins, and points a turn where it can be turned.
fn driven(
    design: &Design,
    condition: &Condition,
    participant: &str,
    riding: Riding<'_>,
) -> Result<(RideStyle, f64, Option<f64>), SeatError> {
    let style = design.style();
    let step = style.and_then(|s| s.points).unwrap_or(riding.range.step(1.0));
    // Three turns are a step.
    let turn = style.map_or(1.0, |s| s.aggression.factor()) * step / 3.0;
    // Root of the angle across the dial, and of the donor: the one that `maveric steer` takes.
    let place = || {
        let root = design.protocol().seed;
        Seed(stream_seed(root, &[participant, condition.id.as_str()]))
    };
    let style = match car(condition)? {
        Car::Dial(points) => return Ok((RideStyle::Own, *points, None)),
        Car::Free => return Ok((RideStyle::Own, 0.0, Some(turn))),
        Car::Replay => RideStyle::Replay,
        Car::Mean => RideStyle::Mean,
        Car::Across => RideStyle::Across(place()),
        Car::Matched(matched) => RideStyle::Lent {
            apart_sd: matched.apart_sd,
            seed: place(),
            // Who these are the seat says, which has asked them.
            withheld: std::collections::BTreeSet::new(),
        },
        Car::Embedding(file) => {
            let rows = riding.styles.get(file).map_or(&[][..], Vec::as_slice);
            let participant = ParticipantId::new(participant)?;
            RideStyle::Given(style_of(rows, file, &participant)?.clone())
        }
        _ => {
            return Err(Hindrance::no_car(condition.id, "the seat does not drive its `car`").into());
        }
    };
    Ok((style, 0.0, None))
}

/// The car of a condition, if the seat may drive it.
pub(crate) fn car(condition: &Condition) -> Result<&Car, Hindrance> {
    if condition.simulated() {
        return Err(Hindrance::SimulatedAgain { condition: condition.id });
    }
    let car = condition.car.as_ref();
    car.ok_or_else(|| Hindrance::no_car(condition.id, "it has no `car`"))
}

#[cfg(test)]
mod tests;
