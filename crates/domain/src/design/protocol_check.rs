//! Whether what a design says of the seat can be.

use super::{
    Probe, Protocol, ProtocolStep,
    error::{Checked, DesignError, refuse},
    protocol::{Redirect, Sessions},
};

/// Most sessions, and most rides in a condition.
const MOST_REPEATS: u32 = 20;

/// Shortest and longest drive, in s.
pub const DRIVES_S: [f64; 2] = [10.0, 7_200.0];
/// Shortest and longest rest, in s.
const BREAK_S: [f64; 2] = [1.0, 3_600.0];

impl Protocol {
    pub(super) fn check(&self) -> Checked<()> {
        let lengths = [
            ("drive_s", self.drive_s, DRIVES_S),
            ("ride_s", self.ride_s, DRIVES_S),
            ("practice.at_most_s", self.practice.at_most_s, DRIVES_S),
            ("break_s", self.break_s, BREAK_S),
        ];
        for (key, found, [low, high]) in lengths {
            if !(low..=high).contains(&found) {
                let expected = format!("{low} to {high} s");
                return refuse(format!("protocol.{key}"), found, expected);
            }
        }
        let kept_s = self.practice.lane_kept_s;
        if !(0.0..=self.practice.at_most_s).contains(&kept_s) {
            let expected = "0 s to `at_most_s`";
            return refuse("protocol.practice.lane_kept_s", kept_s, expected);
        }
        let angles = [
            ("eye_m", self.view.eye_m, [0.5, 4.0], "m"),
            ("field_deg", self.view.field_deg, [10.0, 100.0], "degrees"),
            ("side_deg", self.view.side_deg, [0.0, 90.0], "degrees"),
        ];
        for (key, found, [low, high], unit) in angles {
            if !(low..=high).contains(&found) {
                let expected = format!("{low} to {high} {unit}");
                return refuse(format!("protocol.view.{key}"), found, expected);
            }
        }
        self.check_languages()?;
        if let Some(day) = self.withdraw_until.as_ref().filter(|day| !is_day(day)) {
            let expected = "a day such as 2026-12-31";
            return refuse("protocol.withdraw_until", day, expected);
        }
        self.check_platform()?;
        if ![1, 3].contains(&self.view.screens) {
            let screens = self.view.screens;
            return refuse("protocol.view.screens", screens, "1 or 3");
        }
        for (at, step) in self.steps.iter().enumerate() {
            if *step != ProtocolStep::Break && self.steps[..at].contains(step) {
                let repeated = format!("{step:?} twice").to_lowercase();
                let expected = "each once, but for `break`";
                return refuse("protocol.steps", repeated, expected);
            }
        }
        let tried = self.steps.contains(&ProtocolStep::Controls);
        self.needs.as_ref().map_or(Ok(()), |needs| needs.check(tried))?;
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
    /// Whether languages are such, each once, and those to choose among have the study's.
    fn check_languages(&self) -> Checked<()> {
        let expected = "a language as the web writes it, such as en, de or pt-br";
        if !is_language(&self.language) {
            let key = "protocol.language";
            return refuse(key, &self.language, expected);
        }
        let key = "protocol.languages";
        for (at, language) in self.languages.iter().enumerate() {
            if !is_language(language) {
                return refuse(key, language, expected);
            }
            if self.languages[..at].contains(language) {
                return refuse(key, format!("{language} twice"), "each once");
            }
        }
        if !self.languages.is_empty() && !self.languages.contains(&self.language) {
            let expected = format!("`{}` among them, which is `language`", self.language);
            return refuse(key, self.languages.join(", "), expected);
        }
        Ok(())
    }

    /// Whether a platform can name ids so, and be gone back to.
    fn check_platform(&self) -> Checked<()> {
        let named = |name: &&String| {
            let of_address = |b: u8| b.is_ascii_alphanumeric() || b == b'_';
            (1..=64).contains(&name.len()) && name.bytes().all(of_address)
        };
        if let Some(name) = self.platform.as_ref().filter(|name| !named(name)) {
            let expected = "letters, digits and `_`, such as PROLIFIC_PID";
            return refuse("protocol.platform", name, expected);
        }
        let elsewhere = self.redirect.iter().flat_map(Redirect::addresses);
        for (key, address) in elsewhere {
            if !address.starts_with("https://") || address.contains(char::is_whitespace) {
                let key = format!("protocol.redirect.{key}");
                return refuse(key, address, "an address, https://…");
            }
        }
        Ok(())
    }

    /// Whether there is a number of rides and sessions that somebody can come to, and a time between these.
    fn check_repeats(&self) -> Checked<()> {
        let rides = self.rides_per_condition;
        if !(1..=MOST_REPEATS).contains(&rides) {
            let expected = format!("1 to {MOST_REPEATS}");
            let key = "protocol.rides_per_condition";
            return refuse(key, rides, expected);
        }
        let Some(Sessions { count, days_between: [least, most] }) = &self.sessions else {
            return Ok(());
        };
        if !(2..=MOST_REPEATS).contains(count) {
            let expected =
                format!("2 to {MOST_REPEATS}; for one session leave out [protocol.sessions]");
            let key = "protocol.sessions.count";
            return refuse(key, count, expected);
        }
        if least > most {
            let expected = "the fewest days from one session to the next, then the most";
            let key = "protocol.sessions.days_between";
            return refuse(key, format!("[{least}, {most}]"), expected);
        }
        Ok(())
    }

    /// Whether what is to be asked can be asked, and what is judged is asked.
    fn check_moments(&self) -> Checked<()> {
        for (key, scales, step) in [
            ("screen", &self.screen, ProtocolStep::Screen),
            ("post", &self.post, ProtocolStep::Post),
        ] {
            if !scales.is_empty() && !self.steps.contains(&step) {
                let expected = format!("`{key}` among `steps`, or no scales here");
                return refuse(format!("protocol.{key}"), scales.join(", "), expected);
            }
        }
        for rule in &self.admit_if {
            if !self.screen.contains(&rule.scale) {
                let screen_scales = self.screen.iter().map(String::as_str);
                let key = "protocol.admit_if";
                return Err(DesignError::word(key, &rule.scale, screen_scales));
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
            return refuse(key, probe.every_s, expected);
        }
        if self.after.contains(&probe.scale) {
            let expected =
                "a scale that is not in `after`: each condition has one score of a scale";
            let key = "protocol.probe.scale";
            return refuse(key, &probe.scale, expected);
        }
        Ok(())
    }
}

/// Whether a text is a day of the calendar, as `2026-12-31`.
pub fn is_day(text: &str) -> bool {
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
    use crate::design::{Crash, World};

    #[test]
    fn a_language_is_a_word_as_the_web_writes_it() {
        for text in ["en", "de", "pt-br", "sgn-ase"] {
            assert!(is_language(text), "{text}");
        }
        for text in ["", "German", "DE", "d", "de_at", "de-", "englisch"] {
            assert!(!is_language(text), "{text}");
        }
        let protocol = Protocol { language: "German".to_owned(), ..Protocol::default() };
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
            "2026-00-10",
            "2026-02-29",
            "2100-02-29",
            "31.12.2026",
            "2026-1-1",
            "2026-04-31",
            "2026-12-31T00",
        ] {
            assert!(!is_day(text), "{text}");
        }
        let protocol =
            Protocol { withdraw_until: Some("2026-02-30".to_owned()), ..Protocol::default() };
        let told = protocol.check().unwrap_err().to_string();
        assert!(told.contains("withdraw_until") && told.contains("2026-02-30"), "{told}");
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
        refused("world = \"by_drive\"", &["by_drive", "by_ride", "same", "own"]);
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
        refused("steps = [\"drive\", \"drive\"]", &["protocol.steps", "drive twice", "`break`"]);
        refused("break_s = 3601", &["protocol.break_s", "3601", "1 to 3600 s"]);
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
        refused("rides_per_condition = 21", &["protocol.rides_per_condition", "21", "1 to 20"]);
        refused("rides_per_condition = 0", &["protocol.rides_per_condition", "found 0", "1 to 20"]);
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
        refused(&sessions("count = 2\ndays_between = [2, 14]\nrides = 2"), &["rides"]);
        let design = |protocol: &str| {
            let text = format!(
                "[study]\ntitle = \"x\"\n[[condition]]\nid = \"a\"\n[baseline]\nid = \"own\"\n[protocol]\n{protocol}"
            );
            crate::Design::from_toml(&text).unwrap()
        };
        let of = |design: &crate::Design, id: &str| {
            let occasions = design.occasions(id.parse().unwrap()).into_iter();
            occasions.map(|o| (o.session.get(), o.trial.get())).collect::<Vec<_>>()
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
        refused("languages = [\"de\"]", &["protocol.languages", "`en` among them"]);
        refused("languages = [\"en\", \"German\"]", &["protocol.languages", "German"]);
        refused("languages = [\"en\", \"en\"]", &["protocol.languages", "en twice"]);
        let text = "[study]\ntitle = \"x\"\n[[condition]]\nid = \"a\"\n[protocol]\nlanguages = [\"en\", \"de\"]";
        assert!(crate::Design::from_toml(text).is_ok());
    }

    #[test]
    fn a_platform_is_named_as_an_address_can_and_gone_back_to_encrypted() {
        refused("platform = \"my id\"", &["protocol.platform", "my id", "PROLIFIC_PID"]);
        refused(
            "redirect = { stopped = \"http://example.org\" }",
            &["protocol.redirect.stopped", "http://example.org", "https://"],
        );
        refused("redirect = { left = \"https://example.org\" }", &["left"]);
        let text = "[study]\ntitle = \"x\"\n[[condition]]\nid = \"a\"\n[protocol]\nplatform = \"PROLIFIC_PID\"\n\
                    redirect = { done = \"https://example.org/?cc=C1\" }";
        assert!(crate::Design::from_toml(text).is_ok());
    }

    #[test]
    fn what_is_judged_is_asked_and_what_is_to_be_asked_has_its_step() {
        refused("admit_if = [\"age.1 >= 18\"]", &["protocol.admit_if", "`age`", "there is none"]);
        refused(
            "screen = [\"health\"]\nadmit_if = [\"age.1 >= 18\"]",
            &["protocol.admit_if", "`age`", "`health`"],
        );
        refused("screen = [\"age\"]\nadmit_if = [\"age\"]", &["age", "a whole number"]);
        refused("post = [\"ssq\"]\nsteps = [\"drive\"]", &["protocol.post", "ssq", "`steps`"]);
        refused("screen = [\"age\"]\nsteps = [\"drive\"]", &["protocol.screen", "`steps`"]);
    }

    #[test]
    fn what_stops_a_ride_is_asked_on_the_way() {
        refused("stop_if = \"misc >= 6\"", &["protocol.stop_if", "`misc`", "there is none"]);
        let probe = "probe = { scale = \"misc\", every_s = 60 }\n";
        refused(
            &format!("{probe}stop_if = \"ssq >= 6\""),
            &["protocol.stop_if", "`ssq`", "`misc`"],
        );
        refused(&format!("{probe}stop_if = \"misc\""), &["`misc`", "a whole number"]);
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
