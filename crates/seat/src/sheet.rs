//! What is answered on one page.

use crate::{
    steps::{Asked, Step},
    token,
};
use maveric_domain::survey::Kind;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Most characters that somebody may write into one field.
const LONGEST_TEXT: usize = 4000;

/// Answers to one scale, or agreeing to a text.
#[derive(Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Sheet {
    /// One an item; null where it was left out.
    #[serde(default)]
    pub(crate) answers: Vec<Option<i32>>,
    /// What was written, by number of the item that asks for words.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) texts: BTreeMap<usize, String>,
    /// Whether the text was agreed to.
    #[serde(default)]
    pub(crate) agreed: bool,
    /// Whether the person's style may be lent to others; none where no box was shown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) style_lent: Option<bool>,
    /// Time on the page, in s.
    pub(crate) seconds: f64,
    /// Which rule held somebody back, of those of a screening; its answers stay in the page.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) refused: Option<usize>,
    /// When each probe of a ride was asked (s) and what was answered; taken from the ride's record, whatever is sent.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) probes: Vec<(f64, Option<i32>)>,
    /// SHA-256 of the text that was agreed to; set here, whatever is sent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) text_sha256: Option<String>,
}

impl Sheet {
    /// The sheet as it is kept, if it is what the step asks: what is wrong with it otherwise.
    pub(crate) fn checked(mut self, found: &Step) -> Result<String, String> {
        (self.text_sha256, self.probes) = (None, Vec::new());
        self.keep_text_alone();
        if !(0.0..1e6).contains(&self.seconds) {
            return Err(format!("seconds {}", self.seconds));
        }
        let rules = found.rules();
        if self.refused.is_some() && rules.is_none() {
            return Err("nobody is judged here".to_owned());
        }
        let lends = matches!(found, Step::Text { lend: Some(_), .. });
        if self.style_lent.is_some() && !lends {
            return Err("nobody is asked here whether they lend their style".to_owned());
        }
        match found {
            Step::Scale { items, .. } => self.fits(items)?,
            Step::Text { agree: true, text, .. } if self.agreed && self.answers.is_empty() => {
                self.text_sha256 = Some(token::sha256(text));
            }
            Step::Break { seconds } if self.answers.is_empty() && !self.agreed => {
                if self.seconds < *seconds {
                    let rested_s = self.seconds;
                    return Err(format!("a rest of {rested_s} s, expected {seconds} s or more"));
                }
            }
            Step::Aftercare { again: Some(probe), .. } if matches!(self.answers[..], [Some(answer)] if probe.takes(answer)) =>
                {}
            Step::Elsewhere { .. } if self.answers.is_empty() && !self.agreed => {}
            _ if rules.is_some_and(|rules| self.refused.is_none_or(|at| at < rules.len()))
                && self.answers.is_empty()
                && !self.agreed => {}
            _ => return Err("nothing is asked here".to_owned()),
        }
        serde_json::to_string(&self).map_err(|e| e.to_string())
    }

    /// Leaves out of what was written the characters that only a machine reads.
    fn keep_text_alone(&mut self) {
        for text in self.texts.values_mut() {
            text.retain(is_text);
        }
    }

    /// Whether these are answers to the items.
    fn fits(&self, items: &[Asked]) -> Result<(), String> {
        let n = items.len();
        if self.answers.len() != n {
            return Err(format!("expected {n} answers, each given or left out"));
        }
        for (number, (asked, answer)) in (1..).zip(items.iter().zip(&self.answers)) {
            if let Some(answer) = answer.filter(|a| !asked.item.takes(*a)) {
                let range = asked.item.range();
                return Err(format!("item {number}: {answer}, expected {range} or left out"));
            }
        }
        for (number, text) in &self.texts {
            let question = number.checked_sub(1).and_then(|place| items.get(place));
            let asks_words = question.is_some_and(|question| question.item.kind == Kind::Text);
            if !asks_words || text.chars().count() > LONGEST_TEXT {
                return Err(format!(
                    "item {number}: a text of at most {LONGEST_TEXT} characters is expected of an item that asks for words alone"
                ));
            }
        }
        Ok(())
    }
}

/// Whether two sheets that are kept say the same, however long each took.
pub(crate) fn say_the_same(one: &str, other: &str) -> bool {
    let answers = |kept: &str| {
        let mut sheet: Map<String, Value> = serde_json::from_str(kept).ok()?;
        sheet.remove("seconds");
        Some(sheet)
    };
    one == other || answers(one).is_some_and(|sheet| answers(other) == Some(sheet))
}

/// Whether a character is kept of what people write: of those that only a machine reads, such as a zero byte, with which no table could
/// be read any more, a new line and a tab.
pub(crate) fn is_text(letter: char) -> bool {
    !letter.is_control() || matches!(letter, '\n' | '\t')
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::steps::sheet;
    use maveric_domain::{Moment, Scale};

    fn checked(body: &str) -> Result<String, String> {
        let scale = "id = \"all\"\ntitle = \"All\"\nreference = \"made up\"\n\
                     [[item]]\nkind = \"slider\"\ntext = \"a\"\nmin = 0\nmax = 100\nstep = 5\n\
                     [[item]]\nkind = \"choice\"\ntext = \"b\"\nlevels = [\"x\", \"y\"]\n\
                     [[item]]\nkind = \"number\"\ntext = \"c\"\nmin = 18\nmax = 99\n\
                     [[item]]\nkind = \"text\"\ntext = \"d\"\n";
        let scale = Scale::from_toml(scale).unwrap();
        let step = sheet(&[scale], "all", Moment::Pre, "en").unwrap();
        let sheet: Sheet = serde_json::from_str(body).map_err(|e| e.to_string())?;
        sheet.checked(&step)
    }

    #[test]
    fn a_rest_is_over_when_it_was_long_enough_and_asks_nothing() {
        let rested = |body: &str| {
            let sheet: Sheet = serde_json::from_str(body).unwrap();
            sheet.checked(&Step::Break { seconds: 60.0 })
        };
        assert!(rested("{\"seconds\":60}").is_ok() && rested("{\"seconds\":400.5}").is_ok());
        let early = rested("{\"seconds\":59}").unwrap_err();
        assert!(early.contains("59 s, expected 60 s"), "{early}");
        assert!(rested("{\"seconds\":60,\"answers\":[1]}").is_err());
        assert!(rested("{\"seconds\":60,\"agreed\":true}").is_err());
    }

    #[test]
    fn sheets_say_the_same_whose_answers_are_whatever_time_they_took() {
        let kept = |answers: &str, seconds: f64| {
            let body = format!("{{\"answers\":{answers},\"seconds\":{seconds}}}");
            checked(&body).unwrap()
        };
        let first = kept("[95,2,18,null]", 3.0);
        assert!(say_the_same(&first, &kept("[95,2,18,null]", 7.5)));
        assert!(!say_the_same(&first, &kept("[95,1,18,null]", 3.0)));
        assert!(!say_the_same(&first, "damaged"));
    }

    #[test]
    fn answers_are_taken_as_each_item_can_be_answered_and_no_others() {
        let words = "\"texts\":{\"4\":\"cars\"}";
        for answers in ["[95,2,18,null]", "[null,null,null,null]"] {
            let kept =
                checked(&format!("{{\"answers\":{answers},{words},\"seconds\":3}}")).unwrap();
            assert!(kept.contains(words) && kept.contains(answers), "{kept}");
        }
        for (answers, words, said) in [
            ("[96,null,null,null]", "{}", "item 1: 96, expected 0 to 100 by 5"),
            ("[null,3,null,null]", "{}", "item 2: 3, expected 1 to 2"),
            ("[null,null,17,null]", "{}", "item 3: 17, expected 18 to 99"),
            ("[null,null,null,0]", "{}", "item 4: 0, expected words"),
            ("[null,null,null]", "{}", "expected 4 answers"),
            ("[null,null,null,null]", "{\"1\":\"cars\"}", "item 1: a text"),
            ("[null,null,null,null]", "{\"5\":\"cars\"}", "item 5: a text"),
            ("[1.5,null,null,null]", "{}", "expected i32"),
        ] {
            let body = format!("{{\"answers\":{answers},\"texts\":{words},\"seconds\":3}}");
            let error = checked(&body).err().unwrap();
            assert!(error.contains(said), "{answers}: {error}");
        }
        let body = r#"{"answers":[null,null,null,null],"texts":{"4":"a\u0000b\r\n\tc\u2028"},"seconds":3}"#;
        let kept: Sheet = serde_json::from_str(&checked(body).unwrap()).unwrap();
        assert_eq!(kept.texts[&4], "ab\n\tc\u{2028}");
        let long = "x".repeat(LONGEST_TEXT + 1);
        let body = format!(
            "{{\"answers\":[null,null,null,null],\"texts\":{{\"4\":\"{long}\"}},\"seconds\":3}}"
        );
        assert!(checked(&body).is_err());
    }
}
