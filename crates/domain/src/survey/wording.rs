//! The words of a questionnaire in one language.

use serde::{Deserialize, Serialize};

/// What a page says around and in its items.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wording {
    /// The heading that whoever answers reads, if there is one.
    pub shown_title: Option<String>,
    /// What stands above the items.
    pub instruction: Option<String>,
    /// In the order of the scale, one an item.
    pub items: Vec<ItemWords>,
}

/// What a page shows of an item: question, pair and labels of the answers.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ItemWords {
    /// What is asked; empty where a pair says it, or where the wording is not given.
    #[serde(default)]
    pub text: String,
    /// The words on the left and on the right of the boxes.
    #[serde(default)]
    pub pair: Option<[String; 2]>,
    /// Words of the answers: none, those of both ends, or one an answer.
    #[serde(default)]
    pub anchors: Vec<String>,
}

impl ItemWords {
    /// Whether there is something to read.
    pub fn is_worded(&self) -> bool {
        self.pair.is_some() || !self.text.is_empty()
    }
}

impl Wording {
    /// How many items have words.
    pub fn worded(&self) -> usize {
        self.items.iter().filter(|item| item.is_worded()).count()
    }
}
