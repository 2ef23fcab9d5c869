//! What a person meets in the seat: the order of steps, their texts and lengths.

use super::{AnswerRule, Needs};
use crate::condition::ConditionId;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A part of the protocol, in the order in which it comes.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ProtocolStep {
    /// The scales by which it is judged who takes part; nothing of them is kept.
    Screen,
    /// The text of the consent, and agreeing to it.
    Consent,
    /// The scales asked before the drives.
    Before,
    /// Choosing keyboard, gamepad or wheel.
    Controls,
    /// The practice drive.
    Practice,
    /// The drive by hand.
    Drive,
    /// The rides in the person's order, each with the scales asked after it.
    Rides,
    /// Which of two rides was in the own style.
    Which,
    /// The scales asked at the end.
    Post,
    /// A rest, as often as it stands there.
    Break,
}

/// What becomes of a drive in which the car hits another vehicle. A practice begins again either way.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Crash {
    /// It ends, and nothing is heard or seen of a crash.
    #[default]
    Ends,
    /// It is heard and seen, and then the drive ends: the consent has to name it.
    Felt,
}

/// A scale of one item that is asked again and again during a ride.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Probe {
    /// Id of the scale, which has one item.
    pub scale: String,
    /// How far apart, in s.
    #[cfg_attr(feature = "schema", schemars(range(min = 10)))]
    pub every_s: f64,
}

impl Probe {
    /// What is not answered by then is missing, in s.
    pub const ANSWERED_WITHIN_S: f64 = 10.0;

    /// When it is asked in a ride of `length_s`, in s: as often as an answer can come in time.
    pub fn asked_s(every_s: f64, length_s: f64) -> impl Iterator<Item = f64> {
        let times_s = (1..).map(move |n| f64::from(n) * every_s);
        times_s.take_while(move |at_s| at_s + Self::ANSWERED_WITHIN_S <= length_s)
    }
}

/// Which draw of the scenario a drive or a ride meets: leads and their order, times, lanes that are blocked. Practice has a draw of
/// its own.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum World {
    /// Ride j of everybody is in world j, and the drive by hand in world 0: nothing is met twice, and world is one with period.
    #[default]
    ByRide,
    /// One draw for all rides of everybody, and another for the drive by hand; where a ride shows that drive again, its draw.
    Same,
    /// Another draw for each person and each ride.
    Own,
}

/// When a person has practised enough.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Practice {
    /// Time between the marks of one lane, without a break, in s.
    pub lane_kept_s: f64,
    /// Vehicles that were passed.
    pub passes: u32,
    /// The practice ends after so long whatever was done, in s; the record says what was.
    pub at_most_s: f64,
}

impl Default for Practice {
    fn default() -> Self {
        Self { lane_kept_s: 30.0, passes: 1, at_most_s: 300.0 }
    }
}

/// Several sessions of a person, each with a drive by hand and its rides. All rides have the style of the first session's drive.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sessions {
    /// How many sessions a person has.
    #[cfg_attr(feature = "schema", schemars(range(min = 2, max = 20)))]
    pub count: u32,
    /// Fewest and most days from one session to the next.
    pub days_between: [u32; 2],
}

/// Addresses of a platform that pays, by how somebody's part ended.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Redirect {
    /// Where who went through is led back to.
    #[cfg_attr(feature = "schema", schemars(extend("pattern" = "^https://")))]
    pub done: Option<String>,
    /// Where who was not admitted is led back to.
    #[cfg_attr(feature = "schema", schemars(extend("pattern" = "^https://")))]
    pub screened_out: Option<String>,
    /// Where who stopped, left or took everything back is led back to: they are paid, too.
    #[cfg_attr(feature = "schema", schemars(extend("pattern" = "^https://")))]
    pub stopped: Option<String>,
}

impl Redirect {
    /// Its keys and addresses.
    pub(super) fn addresses(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let addresses = [
            ("done", &self.done),
            ("screened_out", &self.screened_out),
            ("stopped", &self.stopped),
        ];
        addresses.into_iter().filter_map(|(key, address)| Some((key, address.as_deref()?)))
    }
}

/// What the person in the seat sees of the road.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SeatView {
    /// Height of the eyes above the road, in m.
    pub eye_m: f64,
    /// Field of view of a screen from its top to its bottom, in degrees.
    pub field_deg: f64,
    /// 1, or 3 side by side that the browser sees as one.
    #[cfg_attr(feature = "schema", schemars(extend("enum" = [1, 3])))]
    pub screens: u32,
    /// Angle between the middle of one screen and that of the next, in degrees.
    pub side_deg: f64,
}

impl Default for SeatView {
    fn default() -> Self {
        Self { eye_m: 1.22, field_deg: 44.0, screens: 1, side_deg: 60.0 }
    }
}

/// The section `[protocol]`.
///
/// # Example
/// ```
/// # use maveric_domain::Design;
/// let design = Design::from_toml(r#"
///     [study]
///     title = "Calm or sporty"
///     [[condition]]
///     id = "calm"
///     [[condition]]
///     id = "sporty"
///     [protocol]
///     consent = "consent.md"
///     after = ["jian_trust"]
///     drive_s = 300
/// "#)?;
/// assert_eq!(design.protocol().ride_s, 600.0);
/// assert_eq!(design.protocol().after, ["jian_trust"]);
/// # Ok::<(), maveric_domain::DesignError>(())
/// ```
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Protocol {
    /// The parts in their order, `break` as often as it is wanted; a text that no file is named for is left out.
    pub steps: Vec<ProtocolStep>,
    /// In which language the seat speaks to people, such as `en` or `de`.
    pub language: String,
    /// Languages among which people choose, the study's among them; none where nobody is asked.
    #[cfg_attr(feature = "schema", schemars(extend("uniqueItems" = true)))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub languages: Vec<String>,
    /// File with the study's own sentences in the place of the seat's, from the folder of the design's file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub words: Option<PathBuf>,
    /// What the computer of whoever takes part must have, looked at before anybody agrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub needs: Option<Needs>,
    /// File with the text of the consent, from the folder of the design's file.
    pub consent: Option<PathBuf>,
    /// Scales by which it is judged who takes part, in this order; nothing of them is kept.
    pub screen: Vec<String>,
    /// What has to be so of the answers to them, such as `demographics.age >= 18`.
    pub admit_if: Vec<AnswerRule>,
    /// Scales asked before the drives, in this order.
    pub before: Vec<String>,
    /// What is asked again and again during a ride.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probe: Option<Probe>,
    /// Scales asked after each ride, in this order.
    pub after: Vec<String>,
    /// Two conditions, one of them with `car = { dial = 0 }`: after the rides people are asked which was in their own style, by the scale `which`; a
    /// debrief has to follow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub which: Option<[ConditionId; 2]>,
    /// Scales asked at the end, in this order.
    pub post: Vec<String>,
    /// When a person has practised enough.
    pub practice: Practice,
    /// Length of the drive by hand, in s.
    pub drive_s: f64,
    /// Length of a ride, in s.
    pub ride_s: f64,
    /// How often a person rides in each condition of a session; 1 when not given.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 20)))]
    #[serde(skip_serializing_if = "is_one")]
    pub rides_per_condition: u32,
    /// Several sessions of a person, each with a drive by hand and its rides; all rides have the style of the first session's drive. One where none
    /// are given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sessions: Option<Sessions>,
    /// Which draw of the scenario is met: ride j of everybody in world j and the drive in world 0 (`by_ride`, the default), one draw for all rides
    /// (`same`), or another for each person and ride (`own`).
    pub world: World,
    /// What becomes of a drive in which the car hits another vehicle: it ends, and nothing is heard or seen of it (`ends`, the default), or it is
    /// heard and seen before (`felt`), which the consent has to name by `{crash}`.
    pub crash: Crash,
    /// Shortest rest at the step `break`, in s; 60 when not given.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 3600)))]
    pub break_s: f64,
    /// How the road is seen.
    pub view: SeatView,
    /// From which answer to the probe on somebody drives and rides no further, such as `misc >= 6`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_if: Option<AnswerRule>,
    /// File with what somebody is told who stopped, from the folder of the design's file.
    pub aftercare: Option<PathBuf>,
    /// File with what the study was about, told at the end, from the folder of the design's file.
    pub debrief: Option<PathBuf>,
    /// File with what is said at the end, from the folder of the design's file.
    pub thanks: Option<PathBuf>,
    /// A code for the platform that pays.
    pub code: Option<String>,
    /// By which name a platform puts its id into the address, such as `PROLIFIC_PID`.
    #[cfg_attr(feature = "schema", schemars(extend("pattern" = "^[A-Za-z0-9_]{1,64}$")))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub platform: Option<String>,
    /// Where a button of the page leads at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub redirect: Option<Redirect>,
    /// Whether people see their own style beside those of the others at the end.
    pub show_style: bool,
    /// Last day on which people can take back what they gave, such as `2026-12-31`; left out, they always can.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub withdraw_until: Option<String>,
    /// Root of every random choice.
    pub seed: u64,
}

impl Default for Protocol {
    fn default() -> Self {
        use ProtocolStep::{
            Before, Consent, Controls, Drive, Post, Practice as Practises, Rides, Screen, Which,
        };
        Self {
            steps: vec![Screen, Consent, Before, Controls, Practises, Drive, Rides, Which, Post],
            language: "en".to_owned(),
            languages: Vec::new(),
            words: None,
            needs: None,
            consent: None,
            screen: Vec::new(),
            admit_if: Vec::new(),
            before: Vec::new(),
            probe: None,
            after: Vec::new(),
            which: None,
            post: Vec::new(),
            practice: Practice::default(),
            drive_s: 600.0,
            ride_s: 600.0,
            rides_per_condition: 1,
            sessions: None,
            world: World::ByRide,
            crash: Crash::Ends,
            break_s: 60.0,
            view: SeatView::default(),
            stop_if: None,
            aftercare: None,
            debrief: None,
            thanks: None,
            code: None,
            platform: None,
            redirect: None,
            show_style: false,
            withdraw_until: None,
            seed: 1,
        }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks by reference")]
fn is_one(number: &u32) -> bool {
    *number == 1
}

impl Protocol {
    /// How many sessions a person has.
    pub fn session_count(&self) -> u32 {
        self.sessions.as_ref().map_or(1, |s| s.count)
    }
}
