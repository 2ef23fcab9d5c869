//! What a person meets in the seat: the order of steps, their texts and lengths.

use super::DesignError;
use crate::units::SpeedUnit;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A part of the protocol, in the order in which it comes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ProtocolStep {
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
    /// The study's own sentences in the place of the seat's, from the folder of the design's file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub words: Option<PathBuf>,
    /// The text of the consent, from the folder of the design's file.
    pub consent: Option<PathBuf>,
    /// Scales asked before the drives, in this order.
    pub before: Vec<String>,
    /// Scales asked after each ride, in this order.
    pub after: Vec<String>,
    /// When a person has practised enough.
    pub practice: Practice,
    /// Length of the drive by hand, in s.
    pub drive_s: f64,
    /// Length of a ride, in s.
    pub ride_s: f64,
    /// In which unit speeds are shown, where `[study] units` does not say it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed: Option<SpeedUnit>,
    /// What is seen of the road.
    pub view: SeatView,
    /// What is said at the end, from the folder of the design's file.
    pub thanks: Option<PathBuf>,
    /// A code for the platform that pays.
    pub code: Option<String>,
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
        use ProtocolStep::{Before, Consent, Controls, Drive, Practice as Practises, Rides};
        Self {
            steps: vec![Consent, Before, Controls, Practises, Drive, Rides],
            language: "en".to_owned(),
            words: None,
            consent: None,
            before: Vec::new(),
            after: Vec::new(),
            practice: Practice::default(),
            drive_s: 600.0,
            ride_s: 600.0,
            speed: None,
            view: SeatView::default(),
            thanks: None,
            code: None,
            show_style: false,
            withdraw_until: None,
            seed: 1,
        }
    }
}

/// Shortest and longest drive, in s.
const DRIVES_S: [f64; 2] = [10.0, 7_200.0];

impl Protocol {
    pub(super) fn check(&self) -> Result<(), DesignError> {
        let lengths = [
            ("drive_s", self.drive_s),
            ("ride_s", self.ride_s),
            ("practice.at_most_s", self.practice.at_most_s),
        ];
        let [low, high] = DRIVES_S;
        for (key, found) in lengths {
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
        if !is_language(&self.language) {
            let expected = "a language as the web writes it, such as en, de or pt-br";
            return Err(DesignError::key(
                "protocol.language",
                &self.language,
                expected,
            ));
        }
        if let Some(day) = self.withdraw_until.as_ref().filter(|day| !is_day(day)) {
            let expected = "a day such as 2026-12-31";
            return Err(DesignError::key("protocol.withdraw_until", day, expected));
        }
        if ![1, 3].contains(&self.view.screens) {
            let found = self.view.screens;
            return Err(DesignError::key("protocol.view.screens", found, "1 or 3"));
        }
        for (at, step) in self.steps.iter().enumerate() {
            if self.steps[..at].contains(step) {
                let found = format!("{step:?} twice").to_lowercase();
                return Err(DesignError::key("protocol.steps", found, "each once"));
            }
        }
        let place = |step| self.steps.iter().position(|s| *s == step);
        if let Some(rides) = place(ProtocolStep::Rides)
            && place(ProtocolStep::Drive).is_none_or(|drive| drive > rides)
        {
            return Err(DesignError::key(
                "protocol.steps",
                "rides without a drive before them",
                "`drive` before `rides`: a style is learned from it",
            ));
        }
        Ok(())
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
}
