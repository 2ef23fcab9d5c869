//! What a person is shown, one step after the other.

use crate::{hindrance::Hindrance, needs::Need, words::Words};
use maveric_domain::{
    ConditionId, Lent, Moment, Occasion, Ride, Scale,
    design::Than,
    nearest,
    survey::{Item, ItemWords, Wording},
};
use maveric_seat_page::{Event, RideStyle};
use serde::{Deserialize, Serialize};
use std::num::NonZeroU32;

/// Steps of a drive in a second.
pub(crate) const TICKS_PER_S: f64 = 100.0;

/// How an event of a drive begins that ends it since the person stopped, and the reason of who pressed the button.
pub(crate) const STOPPED: &str = "stopped: ";
const UNWELL: &str = "unwell";

/// So long after somebody stopped they are asked once more how they feel, in s.
pub(crate) const ASKED_AGAIN_S: f64 = 600.0;

/// How an event of a drive begins that says that the device is gone with which somebody drives.
pub(crate) const DEVICE_GONE: &str = "device gone: ";

/// How the experimenter leaves a step out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Act {
    /// Somebody goes on at the next.
    Skip,
    /// Nothing is driven any more: somebody goes on where they are told what those are told who stop.
    Abort,
}

impl Act {
    /// As the record says it.
    pub(crate) fn past(self) -> &'static str {
        match self {
            Self::Skip => "skipped",
            Self::Abort => "aborted",
        }
    }
}

/// What somebody is shown or does before they go on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Step {
    /// In which language somebody goes on.
    Language {
        /// Those among which they choose.
        languages: Vec<String>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        chosen: Option<String>,
    },
    /// What the computer must have; the page judges, and no number leaves it.
    Computer { needs: Vec<Need> },
    /// Scales by which the page judges who takes part; no answer leaves it.
    Screen {
        /// A page each, of the kind [`Step::Scale`].
        sheets: Vec<Step>,
        /// What has to be so, all of it.
        rules: Vec<Judged>,
    },
    /// A text to read, to agree to where it says so.
    Text {
        title: String,
        /// Paragraphs, divided by empty lines; `#` heads one, `-` begins a point.
        text: String,
        /// Whether going on means agreeing: recorded with the text's hash.
        agree: bool,
        /// What the box below says whose tick lends the person's style to others; none where nobody is asked.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        lend: Option<String>,
    },
    /// One scale, on one page.
    Scale {
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
    /// A rest, until somebody goes on.
    Break {
        /// Not before so long, in s.
        #[serde(rename = "at_least_s")]
        seconds: f64,
    },
    /// Choosing and trying keyboard, gamepad or wheel.
    Controls,
    /// Driving until the lane was kept and somebody passed, or the time is over.
    Practice {
        /// At most so long, in s.
        seconds: f64,
        /// Time in the lane that is asked for, in s.
        lane_kept_s: f64,
        passes: u32,
        /// Root of the world's random choices.
        seed: String,
        /// As in [`Step::Ride`].
        #[serde(default, skip_serializing_if = "Option::is_none")]
        probe: Option<AskedProbe>,
    },
    /// The drive by hand that is learned from.
    Drive {
        /// The label of the drive.
        condition: ConditionId,
        /// Of which session it is.
        #[serde(flatten)]
        occasion: Occasion,
        seconds: f64,
        /// Root of the world's random choices.
        seed: String,
        /// As in [`Step::Ride`].
        #[serde(default, skip_serializing_if = "Option::is_none")]
        probe: Option<AskedProbe>,
    },
    /// A drive by the automation, in one condition.
    Ride {
        condition: ConditionId,
        /// Which ride of the condition it is.
        #[serde(flatten)]
        occasion: Occasion,
        /// Its number within its session, as the person is told.
        number: usize,
        seconds: f64,
        /// Root of the world's random choices.
        seed: String,
        style: RideStyle,
        /// From where on the dial, in points of the study's style.
        points: f64,
        /// Points a step of the dial towards sportier (negative on a score of calmness), where the person may turn it.
        turns: Option<f64>,
        /// Whose style it is where somebody else's is lent, once the drive by hand was learned from.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        lent: Option<Lent>,
        /// What is asked on the way.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        probe: Option<AskedProbe>,
    },
    /// A ride in a car that is not the seat's: somebody goes there, and comes back.
    Elsewhere {
        condition: ConditionId,
        /// Which ride of the condition it is.
        #[serde(flatten)]
        occasion: Occasion,
        /// Its number within its session, as the person is told.
        number: usize,
    },
    /// Between two sessions: nobody goes on before the day.
    Between {
        session: NonZeroU32,
        /// Fewest and most days from the one before.
        days: [u32; 2],
    },
    /// What somebody is told who stopped; whoever did not goes past it.
    Aftercare {
        /// As in [`Step::Text`].
        text: String,
        /// What is asked once more, so long after they came here.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        again: Option<AskedProbe>,
    },
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
    #[serde(flatten)]
    pub item: Item,
    /// Question and labels, in the language of the person.
    #[serde(flatten)]
    pub words: ItemWords,
}

/// A rule on one answer of a screening.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// As the design has it.
    pub rule: String,
    /// Which of the sheets, from 0.
    pub sheet: usize,
    /// Which of its items, from 0.
    pub item: usize,
    /// How the answer is held against the number.
    pub than: Than,
    pub value: i32,
}

/// A scale of one item that is asked again and again on the way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AskedProbe {
    pub scale: String,
    /// What stands above the question.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instruction: Option<String>,
    /// What is asked, with its answers and their words, as a sheet has it.
    pub question: Asked,
    /// How far apart, in s.
    pub every_s: f64,
    /// What is not answered by then is missing, in s.
    pub within_s: f64,
    /// From which answer on nobody goes on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stop: Option<StopRule>,
}

/// From which answer to a probe on nobody goes on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StopRule {
    /// As the design has it.
    pub rule: String,
    /// How the answer is held against the number.
    pub than: Than,
    pub value: i32,
}

impl AskedProbe {
    /// How an event of a drive that answers it begins.
    const EVENT: &str = "probe:";

    /// When it was asked and what was answered, of an event of a drive; an error is an answer that it does not have.
    pub(crate) fn answer(&self, event: &Event) -> Option<Result<(f64, Option<i32>), String>> {
        let scale = event.what.strip_prefix(Self::EVENT)?;
        let number = (event.tick as f64 / TICKS_PER_S / self.every_s).floor();
        let possible = |answer: f64| answer.fract() == 0.0 && self.takes(answer as i32);
        if scale != self.scale || number < 1.0 || !event.points.is_none_or(possible) {
            let range = self.question.item.range();
            return Some(Err(format!(
                "an answer to a probe that is not asked here, or not {range}"
            )));
        }
        Some(Ok((number * self.every_s, event.points.map(|a| a as i32))))
    }

    /// Whether this is an answer of it.
    pub(crate) fn takes(&self, answer: i32) -> bool {
        self.question.item.takes(answer)
    }

    /// Whether nobody goes on after this answer.
    pub(crate) fn stops(&self, answer: i32) -> bool {
        let rule = self.stop.as_ref();
        rule.is_some_and(|rule| rule.than.holds(answer, rule.value))
    }

    /// Whether an event of a drive answers a probe.
    pub(crate) fn is_answered_by(event: &Event) -> bool {
        event.what.starts_with(Self::EVENT)
    }
}

/// Each ride of these steps, and what the page calls it.
pub(crate) fn coded_rides(steps: &[Step]) -> Vec<(Ride, ConditionId)> {
    let coded = |step: &Step| match step {
        Step::Ride { number, .. } | Step::Elsewhere { number, .. } => {
            let ride = step.ridden()?;
            Some((ride, ConditionId::new(&format!("ride-{number}")).ok()?))
        }
        _ => None,
    };
    steps.iter().filter_map(coded).collect()
}

impl Step {
    /// What is driven or ridden here, also elsewhere.
    pub(crate) fn ride(&self) -> Option<Ride> {
        match self {
            Self::Drive { condition, occasion, .. }
            | Self::Ride { condition, occasion, .. }
            | Self::Elsewhere { condition, occasion, .. } => {
                Some(Ride { condition: *condition, occasion: *occasion })
            }
            _ => None,
        }
    }

    /// The drive that this step makes: its label, of which session, and whether a person drives.
    pub fn drives(&self) -> Option<(Ride, bool)> {
        let by_hand = matches!(self, Self::Drive { .. });
        let ride = self.ride()?;
        (by_hand || matches!(self, Self::Ride { .. })).then_some((ride, by_hand))
    }

    /// Whether the car is given what hands and feet do, or did: in what is driven by hand, and where that is shown again.
    pub(crate) fn is_given_inputs(&self) -> bool {
        !matches!(self, Self::Ride { style, .. } if *style != RideStyle::Replay)
    }

    /// Whether this is the drive by hand that a style is learned of: that of the first session.
    pub(crate) fn is_learned_of(&self) -> bool {
        matches!(self, Self::Drive { occasion, .. } if *occasion == Occasion::FIRST)
    }

    /// What is ridden here, in the seat or elsewhere.
    pub(crate) fn ridden(&self) -> Option<Ride> {
        self.ride().filter(|_| !matches!(self, Self::Drive { .. }))
    }

    /// This step as the page is told it: a ride is known by its number, since who rides is not to read the condition.
    pub(crate) fn for_page(&self, rides: &[(Ride, ConditionId)]) -> Self {
        let coded = |ride: Ride| rides.iter().find(|(r, _)| *r == ride).map(|(_, n)| *n);
        let mut step = self.clone();
        // A number is a ride's alone within its session; a trial would say which condition comes again.
        let first = Occasion::FIRST.trial;
        match &mut step {
            Self::Ride { condition, occasion, .. }
            | Self::Elsewhere { condition, occasion, .. } => {
                *condition = self.ride().and_then(coded).unwrap_or(*condition);
                occasion.trial = first;
            }
            Self::Scale { moment: Moment::After(ride), .. } => {
                ride.condition = coded(*ride).unwrap_or(ride.condition);
                ride.occasion.trial = first;
            }
            _ => {}
        }
        if let Self::Ride { lent, .. } = &mut step {
            *lent = None;
        }
        step
    }

    /// The rules by which it is judged here who takes part, as they are counted; none where nobody is judged.
    pub(crate) fn rules(&self) -> Option<Vec<String>> {
        match self {
            Self::Computer { needs } => Some(needs.iter().map(|need| need.rule()).collect()),
            Self::Screen { rules, .. } => Some(rules.iter().map(|j| j.rule.clone()).collect()),
            _ => None,
        }
    }

    /// What is asked here on the way.
    pub(crate) fn probe(&self) -> Option<&AskedProbe> {
        match self {
            Self::Practice { probe, .. } | Self::Drive { probe, .. } | Self::Ride { probe, .. } => {
                probe.as_ref()
            }
            _ => None,
        }
    }

    /// Why somebody stopped here, of an event of a drive; an error is a reason that the step does not have.
    pub(crate) fn stopped(&self, event: &Event) -> Option<Result<String, String>> {
        let reason = event.what.strip_prefix(STOPPED)?;
        let rule = self.probe().and_then(|probe| probe.stop.as_ref());
        let known = reason == UNWELL || rule.is_some_and(|stop| stop.rule == reason);
        Some(if known {
            Ok(reason.to_owned())
        } else {
            Err("stopped for a reason that this step does not have".to_owned())
        })
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
    pub consent: Option<String>,
    /// What somebody is told who stopped.
    pub aftercare: Option<String>,
    /// What the study was about.
    pub debrief: Option<String>,
    /// What is said at the end.
    pub thanks: Option<String>,
    /// What the seat says by itself.
    pub words: Words,
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
    let (scale, wording, items) = worded_scale(scales, id, language)?;
    Ok(Step::Scale {
        scale: scale.id.clone(),
        title: wording.shown_title.clone(),
        instruction: wording.instruction.clone(),
        items,
        moment,
    })
}

/// A scale with its words in a language, and its items as a page shows them; errors as of [`sheet`].
pub(crate) fn worded_scale<'a>(
    scales: &'a [Scale],
    id: &str,
    language: &str,
) -> Result<(&'a Scale, &'a Wording, Vec<Asked>), Hindrance> {
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
        return Err(Hindrance::NoWording { scale, worded, items });
    }
    let items = scale.items.iter().zip(&wording.items);
    let shown = |(item, words): (&Item, &ItemWords)| Asked {
        // What the answers are scored and judged by is not for the page.
        item: Item { reversed: false, expected: None, ..item.clone() },
        words: words.clone(),
    };
    Ok((scale, wording, items.map(shown).collect()))
}
