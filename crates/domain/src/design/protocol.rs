//! What a person meets in the seat: the order of steps, their texts and lengths.

use super::{AnswerRule, DesignError, Needs};
use crate::{condition::ConditionId, units::SpeedUnit};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A part of the protocol, in the order in which it comes.
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Probe {
    /// The scale.
    pub scale: String,
    /// How far apart, in s.
    pub every_s: f64,
}

impl Probe {
    /// What is not answered by then is missing, in s.
    pub const ANSWERED_WITHIN_S: f64 = 10.0;
}

/// Which draw of the scenario a drive or a ride meets: leads and their order, times, lanes that are blocked. Practice has a draw of
/// its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum World {
    /// Ride j of everybody is in world j, and the drive by hand in world 0: nothing is met twice, and world is one with period.
    #[default]
    ByRide,
    /// One draw for all rides of everybody, and another for the drive by hand.
    Same,
    /// Another draw for each person and each ride.
    Own,
}

/// When a person has practised enough.
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
        Self {
            lane_kept_s: 30.0,
            passes: 1,
            at_most_s: 300.0,
        }
    }
}

/// Several sessions of a person, each with a drive by hand and its rides. All rides have the style of the first session's drive.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sessions {
    /// How many.
    pub count: u32,
    /// Fewest and most days from one to the next.
    pub days_between: [u32; 2],
}

/// Addresses of a platform that pays, by how somebody's part ended.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Redirect {
    /// Of who went through.
    pub done: Option<String>,
    /// Of who was not admitted.
    pub screened_out: Option<String>,
    /// Of who stopped, left, or took back what was given: they are paid, too.
    pub stopped: Option<String>,
}

impl Redirect {
    /// Its keys and addresses.
    fn addresses(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let all = [
            ("done", &self.done),
            ("screened_out", &self.screened_out),
            ("stopped", &self.stopped),
        ];
        all.into_iter()
            .filter_map(|(key, address)| Some((key, address.as_deref()?)))
    }
}

/// What the person in the seat sees of the road.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SeatView {
    /// Height of the eyes above the road, in m.
    pub eye_m: f64,
    /// Field of view of a screen from its top to its bottom, in degrees.
    pub field_deg: f64,
    /// 1, or 3 side by side that the browser sees as one.
    pub screens: u32,
    /// Angle between the middle of one screen and that of the next, in degrees.
    pub side_deg: f64,
}

impl Default for SeatView {
    fn default() -> Self {
        Self {
            eye_m: 1.22,
            field_deg: 44.0,
            screens: 1,
            side_deg: 60.0,
        }
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Protocol {
    /// The parts in their order; a text that no file is named for is left out.
    pub steps: Vec<ProtocolStep>,
    /// In which language people are spoken to, such as `en` or `de`.
    pub language: String,
    /// Languages among which the person chooses, `language` among them; none where nobody is asked.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub languages: Vec<String>,
    /// The study's own sentences in the place of the seat's, from the folder of the design's file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub words: Option<PathBuf>,
    /// What the computer of whoever takes part must have.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub needs: Option<Needs>,
    /// The text of the consent, from the folder of the design's file.
    pub consent: Option<PathBuf>,
    /// Scales by which it is judged who takes part, in this order.
    pub screen: Vec<String>,
    /// What has to be so of the answers to them.
    pub admit_if: Vec<AnswerRule>,
    /// Scales asked before the drives, in this order.
    pub before: Vec<String>,
    /// What is asked again and again during a ride.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probe: Option<Probe>,
    /// Scales asked after each ride, in this order.
    pub after: Vec<String>,
    /// Two conditions, one of them the own style: people are asked which of the two rides it was.
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
    /// How often a person rides in each condition of a session.
    #[serde(skip_serializing_if = "is_one")]
    pub rides_per_condition: u32,
    /// Several sessions of a person; one where none are given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sessions: Option<Sessions>,
    /// Which draw of the scenario each drive meets.
    pub world: World,
    /// What becomes of a drive in which the car hits another vehicle.
    pub crash: Crash,
    /// Shortest rest at the step `break`, in s.
    pub break_s: f64,
    /// In which unit speeds are shown, where `[study] units` does not say it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed: Option<SpeedUnit>,
    /// What is seen of the road.
    pub view: SeatView,
    /// From which answer to the probe on somebody drives and rides no further.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_if: Option<AnswerRule>,
    /// What somebody is told who stopped, from the folder of the design's file.
    pub aftercare: Option<PathBuf>,
    /// What the study was about, told at the end, from the folder of the design's file.
    pub debrief: Option<PathBuf>,
    /// What is said at the end, from the folder of the design's file.
    pub thanks: Option<PathBuf>,
    /// A code for the platform that pays.
    pub code: Option<String>,
    /// How the address of whoever a platform sends names their id on it, such as `PROLIFIC_PID`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub platform: Option<String>,
    /// Where the page leads back to at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub redirect: Option<Redirect>,
    /// Whether people see their own style beside those of the others at the end.
    pub show_style: bool,
    /// Last day on which people can take back what they gave, such as `2026-12-31`; none where they always can.
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
            steps: vec![
                Screen, Consent, Before, Controls, Practises, Drive, Rides, Which, Post,
            ],
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
            speed: None,
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

/// Most sessions, and most rides in a condition.
const MOST_REPEATS: u32 = 20;

/// Shortest and longest drive, in s.
pub const DRIVES_S: [f64; 2] = [10.0, 7_200.0];
/// Shortest and longest rest, in s.
const BREAK_S: [f64; 2] = [1.0, 3_600.0];

impl Protocol {
    pub(super) fn check(&self) -> Result<(), DesignError> {
        let lengths = [
            ("drive_s", self.drive_s, DRIVES_S),
            ("ride_s", self.ride_s, DRIVES_S),
            ("practice.at_most_s", self.practice.at_most_s, DRIVES_S),
            ("break_s", self.break_s, BREAK_S),
        ];
        for (key, found, [low, high]) in lengths {
            if !(low..=high).contains(&found) {
                let expected = format!("{low} to {high} s");
                return Err(DesignError::key(format!("protocol.{key}"), found, expected));
            }
        }
        let kept_s = self.practice.lane_kept_s;
        if !(0.0..=self.practice.at_most_s).contains(&kept_s) {
            let expected = "0 s to `at_most_s`";
            return Err(DesignError::key(
                "protocol.practice.lane_kept_s",
                kept_s,
                expected,
            ));
        }
        let angles = [
            ("eye_m", self.view.eye_m, [0.5, 4.0], "m"),
            ("field_deg", self.view.field_deg, [10.0, 100.0], "degrees"),
            ("side_deg", self.view.side_deg, [0.0, 90.0], "degrees"),
        ];
        for (key, found, [low, high], unit) in angles {
            if !(low..=high).contains(&found) {
                let expected = format!("{low} to {high} {unit}");
                return Err(DesignError::key(
                    format!("protocol.view.{key}"),
                    found,
                    expected,
                ));
            }
        }
        self.check_languages()?;
        if let Some(day) = self.withdraw_until.as_ref().filter(|day| !is_day(day)) {
            let expected = "a day such as 2026-12-31";
            return Err(DesignError::key("protocol.withdraw_until", day, expected));
        }
        self.check_platform()?;
        if ![1, 3].contains(&self.view.screens) {
            let found = self.view.screens;
            return Err(DesignError::key("protocol.view.screens", found, "1 or 3"));
        }
        for (at, step) in self.steps.iter().enumerate() {
            if *step != ProtocolStep::Break && self.steps[..at].contains(step) {
                let found = format!("{step:?} twice").to_lowercase();
                let expected = "each once, but for `break`";
                return Err(DesignError::key("protocol.steps", found, expected));
            }
        }
        let tried = self.steps.contains(&ProtocolStep::Controls);
        self.needs
            .as_ref()
            .map_or(Ok(()), |needs| needs.check(tried))?;
        self.check_repeats()?;
        self.check_moments()
    }
}

/// Whether a text is a language with its region, as `de` or `pt-br`.
fn is_language(text: &str) -> bool {
    let mut parts = text.split('-');
    let letters = |part: &str| part.bytes().all(|b| b.is_ascii_lowercase());
    let first = parts.next().unwrap_or_default();
    (2..=3).contains(&first.len())
        && letters(first)
        && parts.all(|part| (2..=8).contains(&part.len()) && letters(part))
}

impl Protocol {
    /// How many sessions a person has.
    pub fn session_count(&self) -> u32 {
        self.sessions.as_ref().map_or(1, |s| s.count)
    }

    /// Whether languages are such, each once, and those to choose among have the study's.
    fn check_languages(&self) -> Result<(), DesignError> {
        let expected = "a language as the web writes it, such as en, de or pt-br";
        if !is_language(&self.language) {
            let key = "protocol.language";
            return Err(DesignError::key(key, &self.language, expected));
        }
        let key = "protocol.languages";
        for (at, language) in self.languages.iter().enumerate() {
            if !is_language(language) {
                return Err(DesignError::key(key, language, expected));
            }
            if self.languages[..at].contains(language) {
                return Err(DesignError::key(
                    key,
                    format!("{language} twice"),
                    "each once",
                ));
            }
        }
        if !self.languages.is_empty() && !self.languages.contains(&self.language) {
            let expected = format!("`{}` among them, which is `language`", self.language);
            return Err(DesignError::key(key, self.languages.join(", "), expected));
        }
        Ok(())
    }

    /// Whether a platform can name ids so, and be gone back to.
    fn check_platform(&self) -> Result<(), DesignError> {
        let named = |name: &&String| {
            let of_address = |b: u8| b.is_ascii_alphanumeric() || b == b'_';
            (1..=64).contains(&name.len()) && name.bytes().all(of_address)
        };
        if let Some(name) = self.platform.as_ref().filter(|name| !named(name)) {
            let expected = "letters, digits and `_`, such as PROLIFIC_PID";
            return Err(DesignError::key("protocol.platform", name, expected));
        }
        let elsewhere = self.redirect.iter().flat_map(Redirect::addresses);
        for (key, address) in elsewhere {
            if !address.starts_with("https://") || address.contains(char::is_whitespace) {
                let key = format!("protocol.redirect.{key}");
                return Err(DesignError::key(key, address, "an address, https://…"));
            }
        }
        Ok(())
    }

    /// Whether there is a number of rides and sessions that somebody can come to, and a time between these.
    fn check_repeats(&self) -> Result<(), DesignError> {
        let rides = self.rides_per_condition;
        if !(1..=MOST_REPEATS).contains(&rides) {
            let expected = format!("1 to {MOST_REPEATS}");
            let key = "protocol.rides_per_condition";
            return Err(DesignError::key(key, rides, expected));
        }
        let Some(Sessions {
            count,
            days_between: [least, most],
        }) = &self.sessions
        else {
            return Ok(());
        };
        if !(2..=MOST_REPEATS).contains(count) {
            let expected =
                format!("2 to {MOST_REPEATS}; for one session leave out [protocol.sessions]");
            let key = "protocol.sessions.count";
            return Err(DesignError::key(key, count, expected));
        }
        if least > most {
            let expected = "the fewest days from one session to the next, then the most";
            let key = "protocol.sessions.days_between";
            return Err(DesignError::key(
                key,
                format!("[{least}, {most}]"),
                expected,
            ));
        }
        Ok(())
    }

    /// Whether what is to be asked can be asked, and what is judged is asked.
    fn check_moments(&self) -> Result<(), DesignError> {
        for (key, scales, step) in [
            ("screen", &self.screen, ProtocolStep::Screen),
            ("post", &self.post, ProtocolStep::Post),
        ] {
            if !scales.is_empty() && !self.steps.contains(&step) {
                let expected = format!("`{key}` among `steps`, or no scales here");
                return Err(DesignError::key(
                    format!("protocol.{key}"),
                    scales.join(", "),
                    expected,
                ));
            }
        }
        for rule in &self.admit_if {
            if !self.screen.contains(&rule.scale) {
                let asked = self.screen.iter().map(String::as_str);
                let key = "protocol.admit_if";
                return Err(DesignError::word(key, &rule.scale, asked));
            }
        }
        let probed = self.probe.iter().map(|probe| probe.scale.as_str());
        if let Some(rule) = &self.stop_if
            && !probed.clone().any(|scale| scale == rule.scale)
        {
            return Err(DesignError::word("protocol.stop_if", &rule.scale, probed));
        }
        let Some(probe) = &self.probe else {
            return Ok(());
        };
        if !(Probe::ANSWERED_WITHIN_S..self.ride_s).contains(&probe.every_s) {
            let (low, high) = (Probe::ANSWERED_WITHIN_S, self.ride_s);
            let expected = format!("{low} s to less than {high} s, the length of a ride");
            let key = "protocol.probe.every_s";
            return Err(DesignError::key(key, probe.every_s, expected));
        }
        if self.after.contains(&probe.scale) {
            let expected =
                "a scale that is not in `after`: each condition has one score of a scale";
            let key = "protocol.probe.scale";
            return Err(DesignError::key(key, &probe.scale, expected));
        }
        Ok(())
    }
}

/// Whether a text is a day of the calendar, as `2026-12-31`.
fn is_day(text: &str) -> bool {
    let parts: Vec<&str> = text.split('-').collect();
    let [year, month, day] = parts[..] else {
        return false;
    };
    let digits = |part: &str, many: usize| {
        (part.len() == many && part.bytes().all(|b| b.is_ascii_digit()))
            .then(|| part.parse::<u32>().ok())
            .flatten()
    };
    let (Some(year), Some(month), Some(day)) = (digits(year, 4), digits(month, 2), digits(day, 2))
    else {
        return false;
    };
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let days = match month {
        4 | 6 | 9 | 11 => 30,
        2 => 28 + u32::from(leap),
        1..=12 => 31,
        _ => 0,
    };
    (1..=days).contains(&day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_language_is_a_word_as_the_web_writes_it() {
        for text in ["en", "de", "pt-br", "sgn-ase"] {
            assert!(is_language(text), "{text}");
        }
        for text in ["", "German", "DE", "d", "de_at", "de-", "englisch"] {
            assert!(!is_language(text), "{text}");
        }
        let protocol = Protocol {
            language: "German".to_owned(),
            ..Protocol::default()
        };
        let told = protocol.check().unwrap_err().to_string();
        assert!(told.contains("protocol.language"), "{told}");
    }

    #[test]
    fn the_last_day_of_taking_back_is_a_day_of_the_calendar() {
        for day in ["2026-12-31", "2028-02-29", "2000-02-29"] {
            assert!(is_day(day), "{day}");
        }
        for text in [
            "",
            "yesterday",
            "2026-13-01",
            "2026-02-29",
            "2100-02-29",
            "31.12.2026",
            "2026-1-1",
            "2026-04-31",
            "2026-12-31T00",
        ] {
            assert!(!is_day(text), "{text}");
        }
        let protocol = Protocol {
            withdraw_until: Some("2026-02-30".to_owned()),
            ..Protocol::default()
        };
        let told = protocol.check().unwrap_err().to_string();
        assert!(
            told.contains("withdraw_until") && told.contains("2026-02-30"),
            "{told}"
        );
    }

    fn refused(protocol: &str, words: &[&str]) {
        let text =
            format!("[study]\ntitle = \"x\"\n[[condition]]\nid = \"a\"\n[protocol]\n{protocol}");
        let told = crate::Design::from_toml(&text).unwrap_err().to_string();
        for word in words {
            assert!(told.contains(word), "{protocol}: {told}");
        }
    }

    #[test]
    fn a_world_is_by_ride_unless_the_study_says_otherwise_and_no_other_word_is_one() {
        let protocol = |line: &str| {
            let text =
                format!("[study]\ntitle = \"x\"\n[[condition]]\nid = \"a\"\n[protocol]\n{line}");
            crate::Design::from_toml(&text).unwrap().protocol().world
        };
        assert_eq!(protocol(""), World::ByRide);
        assert_eq!(protocol("world = \"by_ride\""), World::ByRide);
        assert_eq!(protocol("world = \"same\""), World::Same);
        assert_eq!(protocol("world = \"own\""), World::Own);
        refused(
            "world = \"by_drive\"",
            &["by_drive", "by_ride", "same", "own"],
        );
    }

    #[test]
    fn a_break_may_come_again_and_no_other_step_and_it_has_a_length() {
        let of = |protocol: &str| {
            let text = format!(
                "[study]\ntitle = \"x\"\n[[condition]]\nid = \"a\"\n[protocol]\n{protocol}"
            );
            let design = crate::Design::from_toml(&text).unwrap();
            let protocol = design.protocol();
            (protocol.steps.len(), protocol.break_s)
        };
        let steps = "steps = [\"before\", \"break\", \"drive\", \"break\", \"rides\"]";
        assert_eq!(of(steps), (5, 60.0));
        assert_eq!(of(&format!("{steps}\nbreak_s = 90")), (5, 90.0));
        refused(
            "steps = [\"drive\", \"drive\"]",
            &["protocol.steps", "drive twice", "`break`"],
        );
        refused(
            "break_s = 3601",
            &["protocol.break_s", "3601", "1 to 3600 s"],
        );
    }

    #[test]
    fn a_crash_ends_a_drive_unless_the_study_says_that_it_is_felt() {
        let of = |line: &str| {
            let text =
                format!("[study]\ntitle = \"x\"\n[[condition]]\nid = \"a\"\n[protocol]\n{line}");
            crate::Design::from_toml(&text).unwrap().protocol().crash
        };
        assert_eq!(of(""), Crash::Ends);
        assert_eq!(of("crash = \"felt\""), Crash::Felt);
        refused("crash = \"loud\"", &["loud", "ends", "felt"]);
    }

    #[test]
    fn rides_and_sessions_are_numbers_that_somebody_can_come_to_and_none_are_one_each() {
        refused(
            "rides_per_condition = 21",
            &["protocol.rides_per_condition", "21", "1 to 20"],
        );
        refused(
            "rides_per_condition = 0",
            &["protocol.rides_per_condition", "found 0", "1 to 20"],
        );
        let sessions = |keys: &str| format!("[protocol.sessions]\n{keys}");
        refused(
            &sessions("count = 1\ndays_between = [2, 14]"),
            &["protocol.sessions.count", "2 to 20", "leave out"],
        );
        refused(
            &sessions("count = 2\ndays_between = [14, 2]"),
            &["protocol.sessions.days_between", "[14, 2]", "fewest"],
        );
        refused(&sessions("count = 2"), &["days_between"]);
        refused(
            &sessions("count = 2\ndays_between = [2, 14]\nrides = 2"),
            &["rides"],
        );
        let design = |protocol: &str| {
            let text = format!(
                "[study]\ntitle = \"x\"\n[[condition]]\nid = \"a\"\n[baseline]\nid = \"own\"\n[protocol]\n{protocol}"
            );
            crate::Design::from_toml(&text).unwrap()
        };
        let of = |design: &crate::Design, id: &str| {
            let occasions = design.occasions(id.parse().unwrap()).into_iter();
            occasions
                .map(|o| (o.session.get(), o.trial.get()))
                .collect::<Vec<_>>()
        };
        let several = design(
            "rides_per_condition = 2\n[protocol.sessions]\ncount = 2\ndays_between = [2, 2]",
        );
        assert_eq!(of(&several, "a"), [(1, 1), (1, 2), (2, 1), (2, 2)]);
        // By hand a person drives once a session.
        assert_eq!(of(&several, "own"), [(1, 1), (2, 1)]);
        assert!(several.repeats());
        let one = design("");
        assert_eq!(of(&one, "a"), [(1, 1)]);
        assert!(!one.repeats());
    }

    #[test]
    fn people_choose_among_languages_of_which_the_studys_is_one() {
        refused(
            "languages = [\"de\"]",
            &["protocol.languages", "`en` among them"],
        );
        refused(
            "languages = [\"en\", \"German\"]",
            &["protocol.languages", "German"],
        );
        refused(
            "languages = [\"en\", \"en\"]",
            &["protocol.languages", "en twice"],
        );
        let text = "[study]\ntitle = \"x\"\n[[condition]]\nid = \"a\"\n[protocol]\nlanguages = [\"en\", \"de\"]";
        assert!(crate::Design::from_toml(text).is_ok());
    }

    #[test]
    fn a_platform_is_named_as_an_address_can_and_gone_back_to_encrypted() {
        refused(
            "platform = \"my id\"",
            &["protocol.platform", "my id", "PROLIFIC_PID"],
        );
        refused(
            "redirect = { stopped = \"http://example.org\" }",
            &[
                "protocol.redirect.stopped",
                "http://example.org",
                "https://",
            ],
        );
        refused("redirect = { left = \"https://example.org\" }", &["left"]);
        let text = "[study]\ntitle = \"x\"\n[[condition]]\nid = \"a\"\n[protocol]\nplatform = \"PROLIFIC_PID\"\n\
                    redirect = { done = \"https://example.org/?cc=C1\" }";
        assert!(crate::Design::from_toml(text).is_ok());
    }

    #[test]
    fn what_is_judged_is_asked_and_what_is_to_be_asked_has_its_step() {
        refused(
            "admit_if = [\"age.1 >= 18\"]",
            &["protocol.admit_if", "`age`", "there is none"],
        );
        refused(
            "screen = [\"health\"]\nadmit_if = [\"age.1 >= 18\"]",
            &["protocol.admit_if", "`age`", "`health`"],
        );
        refused(
            "screen = [\"age\"]\nadmit_if = [\"age\"]",
            &["age", "a whole number"],
        );
        refused(
            "post = [\"ssq\"]\nsteps = [\"drive\"]",
            &["protocol.post", "ssq", "`steps`"],
        );
        refused(
            "screen = [\"age\"]\nsteps = [\"drive\"]",
            &["protocol.screen", "`steps`"],
        );
    }

    #[test]
    fn what_stops_a_ride_is_asked_on_the_way() {
        refused(
            "stop_if = \"misc >= 6\"",
            &["protocol.stop_if", "`misc`", "there is none"],
        );
        let probe = "probe = { scale = \"misc\", every_s = 60 }\n";
        refused(
            &format!("{probe}stop_if = \"ssq >= 6\""),
            &["protocol.stop_if", "`ssq`", "`misc`"],
        );
        refused(
            &format!("{probe}stop_if = \"misc\""),
            &["`misc`", "a whole number"],
        );
    }

    #[test]
    fn a_probe_comes_at_least_once_a_ride_and_is_no_scale_of_afterwards() {
        let every =
            |s: f64| format!("ride_s = 60\nprobe = {{ scale = \"misc\", every_s = {s:?} }}");
        for s in [60.0, 600.0, 9.9] {
            refused(&every(s), &["protocol.probe.every_s", "10 s", "60 s"]);
        }
        refused(
            &format!("{}\nafter = [\"misc\"]", every(30.0)),
            &["protocol.probe.scale", "misc", "`after`"],
        );
        let text = format!(
            "[study]\ntitle = \"x\"\n[[condition]]\nid = \"a\"\n[protocol]\n{}",
            every(30.0)
        );
        let design = crate::Design::from_toml(&text).unwrap();
        assert_eq!(design.protocol().probe.as_ref().unwrap().scale, "misc");
    }
}
