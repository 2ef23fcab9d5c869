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
    /// Those of them who did nothing of the kind, each in a row of `left_out`, too.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub absent: Vec<String>,
    /// People left out of those recruited, a row a reason.
    pub left_out: Vec<LeftOutFor>,
    /// People whom the design leaves out by name and whose drives would have been learned from alone, a row a reason; they are none of the
    /// recruited.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_learned_from: Vec<LeftOutFor>,
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
    let why_absent = Why::by(Rule::Absent, "no drive and no answer in any condition");
    let out = recruited.iter().filter_map(|&who| {
        let why_absent = (!there.contains(who)).then_some(&why_absent);
        Some((who.to_string(), left_out.people.get(who).or(why_absent)?))
    });
    let out: Vec<(String, &Why)> = out.collect();
    let absent = recruited.iter().filter(|who| !there.contains(**who));
    let absent: Vec<String> = absent.map(|&who| who.to_string()).collect();
    let drives = left_out.single_drives(&recruited);
    let learners = people.iter().filter(|p| p.learned && !p.tested);
    let named = learners.filter_map(|p| {
        let why = left_out.people.get(&p.id)?;
        (why.rule == Rule::People).then(|| (p.id.to_string(), why))
    });
    let drives = drives.map(|(drive, why)| (drive.to_string(), why));
    Flow {
        not_admitted: not_admitted.to_vec(),
        consents,
        recruited: recruited.len(),
        drove: recruited.len() - absent.len(),
        absent,
        analysed: recruited.len() - out.len(),
        left_out: by_reason(design, out),
        not_learned_from: by_reason(design, named),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_would_have_been_learned_from_and_is_left_out_by_name_is_counted_apart() {
        let text = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n[exclude]\npeople = { L1 = \"withdrew\", T1 = \"withdrew\", X1 = \"gone\" }\n";
        let design = Design::from_toml(text).unwrap();
        let person = |id: &str, learned: bool| Person {
            id: ParticipantId::new(id).unwrap(),
            learned,
            tested: !learned,
            order: Vec::new(),
            columns: BTreeMap::new(),
        };
        let people =
            [person("L1", true), person("L2", true), person("T1", false), person("T2", false)];
        let there = people.iter().map(|p| p.id.clone()).collect();
        let left_out = LeftOut::named(&design);
        let flow = flow(&design, &people, &there, &left_out, (&[], Vec::new()));
        let rows = |rows: &[LeftOutFor]| rows.iter().map(|r| r.who.clone()).collect::<Vec<_>>();
        assert_eq!(rows(&flow.not_learned_from), [["L1"]]);
        assert_eq!(rows(&flow.left_out), [["T1"]]);
        assert_eq!((flow.recruited, flow.analysed), (2, 1));
    }
}
