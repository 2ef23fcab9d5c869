//! The words in a questionnaire's file, held against its items.

use super::{
    item::{Item, Kind},
    wording::{ItemWords, Wording},
};
use serde::Deserialize;

/// The words of a language, as a translation gives them.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Words {
    pub(super) shown_title: Option<String>,
    pub(super) instruction: Option<String>,
    pub(super) anchors: Vec<String>,
    pub(super) levels: Vec<String>,
    pub(super) items: Vec<String>,
    pub(super) pairs: Vec<Vec<String>>,
    pub(super) item: Vec<ItemTexts>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ItemTexts {
    pub(super) text: String,
    pub(super) pair: Vec<String>,
    pub(super) anchors: Vec<String>,
    pub(super) levels: Vec<String>,
}

impl Words {
    /// The words of each item; `texts` is the key of the list of texts, `kind` that of the scale.
    pub(super) fn wording(
        self,
        texts: &str,
        kind: Kind,
        items: &[Item],
    ) -> Result<Wording, String> {
        let n = items.len();
        for (key, found) in
            [(texts, self.items.len()), ("pairs", self.pairs.len()), ("[[item]]", self.item.len())]
        {
            if found != 0 && found != n {
                return Err(format!("{key} has {found} texts for {n} items"));
            }
        }
        let mut worded = Vec::new();
        for (place, item) in items.iter().enumerate() {
            let table = self.item.get(place);
            let list = |words_of: fn(&ItemTexts) -> &Vec<String>, of_scale: &Vec<String>| {
                let own_words = table.map(words_of).filter(|words| !words.is_empty());
                let of_scale = (item.kind == kind).then_some(of_scale);
                own_words.or(of_scale).cloned().unwrap_or_default()
            };
            let table_text = table.map(|t| t.text.clone()).unwrap_or_default();
            let pair = table.map(|t| &t.pair).filter(|pair| !pair.is_empty());
            let words = RawWords {
                text: [self.items.get(place).cloned().unwrap_or_default(), table_text],
                pair: pair.or_else(|| self.pairs.get(place)).cloned(),
                anchors: list(|t| &t.anchors, &self.anchors),
                levels: list(|t| &t.levels, &self.levels),
            };
            let checked = words.checked(item);
            worded.push(checked.map_err(|problem| format!("item {}: {problem}", place + 1))?);
        }
        let given = worded.iter().filter(|w| w.is_worded()).count();
        if let Some(without) = worded.iter().position(|w| !w.is_worded()).filter(|_| given > 0) {
            return Err(format!("item {} has no text, and {given} of {n} have one", without + 1));
        }
        Ok(Wording { shown_title: self.shown_title, instruction: self.instruction, items: worded })
    }
}

/// The words of an item, before they are held against its kind.
struct RawWords {
    /// From the list of texts, and from its table.
    text: [String; 2],
    pair: Option<Vec<String>>,
    anchors: Vec<String>,
    levels: Vec<String>,
}

impl RawWords {
    fn checked(self, item: &Item) -> Result<ItemWords, String> {
        let kind = item.kind.name();
        let [listed, own] = self.text;
        if !listed.is_empty() && !own.is_empty() {
            return Err("has two texts, one in the list and one in its [[item]]".to_owned());
        }
        let pair = match self.pair.map(<[String; 2]>::try_from) {
            None => None,
            Some(Ok(pair)) if item.kind == Kind::Bipolar && pair.iter().all(|w| !w.is_empty()) => {
                Some(pair)
            }
            Some(Ok(_)) if item.kind != Kind::Bipolar => {
                return Err(format!("a `{kind}` has no pair, expected kind = \"bipolar\""));
            }
            Some(Ok(pair)) => return Err(format!("pair {pair:?}, expected two words")),
            Some(Err(words)) => return Err(format!("pair {words:?}, expected two words")),
        };
        if !self.levels.is_empty() && !item.kind.has_levels() {
            return Err(format!("a `{kind}` has no `levels`, expected `anchors`"));
        }
        let takes_anchors = matches!(item.kind, Kind::Likert | Kind::Slider);
        if !self.anchors.is_empty() && !takes_anchors {
            let expected = if item.kind.has_levels() { "`levels`" } else { "none" };
            return Err(format!("a `{kind}` has no `anchors`, expected {expected}"));
        }
        let (found, points) = (self.anchors.len(), item.points());
        if takes_anchors && ![0, 2, points].contains(&found) {
            return Err(format!(
                "{found} anchors, expected 2 (of the ends) or {points} (one an answer)"
            ));
        }
        // The levels are what a ladder says: without them it has no wording.
        let unworded = item.kind == Kind::Ladder && listed.is_empty() && own.is_empty();
        let count = self.levels.len();
        if item.kind.has_levels() && count != points && !(unworded && count == 0) {
            return Err(format!("{count} levels, expected {points}"));
        }
        Ok(ItemWords {
            text: if listed.is_empty() { own } else { listed },
            pair,
            anchors: if takes_anchors { self.anchors } else { self.levels },
        })
    }
}

/// The translation, if it has all that the file's own language has.
pub(super) fn complete(translated: Wording, own: &Wording) -> Result<Wording, String> {
    let lacks = |what: String| Err(format!("lacks {what}, which the file's own language has"));
    if own.shown_title.is_some() && translated.shown_title.is_none() {
        return lacks("shown_title".to_owned());
    }
    if own.instruction.is_some() && translated.instruction.is_none() {
        return lacks("instruction".to_owned());
    }
    for (number, (theirs, own)) in (1..).zip(translated.items.iter().zip(&own.items)) {
        if own.is_worded() && !theirs.is_worded() {
            return lacks(format!("the words of item {number}"));
        }
        if own.anchors.len() != theirs.anchors.len() {
            let (found, expected) = (theirs.anchors.len(), own.anchors.len());
            return Err(format!(
                "item {number} has words for {found} answers, expected {expected}"
            ));
        }
    }
    Ok(translated)
}
