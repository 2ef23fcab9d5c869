//! How many people there were at each step, and who was left out.

use crate::{
    consents::ConsentVersion,
    exclusions::{LeftOut, Rule, Why},
    person::Person,
};
use maveric_domain::{Design, ParticipantId};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// How many people there were at each step: a flow of participants as CONSORT draws it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Flow {
    /// People who wanted to take part and were not admitted, a row a rule; they are in no table.
    pub not_admitted: Vec<NotAdmitted>,
    /// The versions of the consent, a row each; none where nobody was asked to agree.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub consents: Vec<ConsentVersion>,
    /// People in the table who were to sit through the conditions.
    pub recruited: usize,
    /// Those of them who drove or rated at least one condition, were measured in one, or drove the baseline.
    pub drove: usize,
    /// People left out, a row a reason.
    pub left_out: Vec<LeftOutFor>,
    /// People analysed.
    pub analysed: usize,
    /// Single drives left out of those analysed, a row a reason.
    pub drives: Vec<LeftOutFor>,
}

/// How many people a rule of the screening held back.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NotAdmitted {
    /// What they did not fulfil.
    pub rule: String,
    /// How many, each counted by the first rule that held them back.
    pub people: usize,
}

/// Those who are left out for one reason.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LeftOutFor {
    /// The rule that left them out.
    pub rule: Rule,
    /// In words.
    pub why: String,
    /// The people, or the drives.
    pub who: Vec<String>,
}

/// The flow of those who were to be tested: everybody in `there`, where there is no table of people.
pub(crate) fn flow(
    design: &Design,
    people: &[Person],
    there: &BTreeSet<ParticipantId>,
    left_out: &LeftOut,
    (not_admitted, consents): (&[NotAdmitted], Vec<ConsentVersion>),
) -> Flow {
    let recruited: BTreeSet<&ParticipantId> = if people.is_empty() {
        there.iter().collect()
    } else {
        people.iter().filter(|p| p.tested).map(|p| &p.id).collect()
    };
    let absent = Why::by(Rule::Absent, "no drive and no answer in any condition");
    let out = recruited.iter().filter_map(|&who| {
        let absent = (!there.contains(who)).then_some(&absent);
        Some((who.to_string(), left_out.people.get(who).or(absent)?))
    });
    let out: Vec<(String, &Why)> = out.collect();
    let drives = left_out.drives.iter();
    let drives = drives.map(|(drive, why)| (drive.to_string(), why));
    Flow {
        not_admitted: not_admitted.to_vec(),
        consents,
        recruited: recruited.len(),
        drove: recruited.iter().filter(|who| there.contains(**who)).count(),
        analysed: recruited.len() - out.len(),
        left_out: by_reason(design, out),
        drives: by_reason(design, drives),
    }
}

/// A row a reason; short drives are told together.
fn by_reason<'a>(
    design: &Design,
    left_out: impl IntoIterator<Item = (String, &'a Why)>,
) -> Vec<LeftOutFor> {
    let shortest = design.exclude().drive_shorter_than_s.unwrap_or_default();
    let mut reasons: BTreeMap<(Rule, String), Vec<String>> = BTreeMap::new();
    for (who, why) in left_out {
        let reason = match why.rule {
            Rule::Short => format!("drive shorter than {shortest:.0} s"),
            _ => why.reason.clone(),
        };
        reasons.entry((why.rule, reason)).or_default().push(who);
    }
    let row = |((rule, why), who)| LeftOutFor { rule, why, who };
    reasons.into_iter().map(row).collect()
}
