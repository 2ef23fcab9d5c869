//! Who lets nobody be driven in their style, of a study whose people were asked in the seat.

use crate::tables::collected::ConsentRow;
use maveric_domain::{Design, DriveId, ParticipantId};
use std::collections::BTreeSet;

/// Whoever agreed to take part and did not tick that their style may be lent, also where they were not asked.
pub(super) fn people(consents: &[ConsentRow]) -> BTreeSet<ParticipantId> {
    let refused = consents.iter().filter(|row| row.style_lent != Some(true));
    refused.map(|row| row.participant.clone()).collect()
}

/// Those drives of a model of this study that are by one of these people; of a model that was learned elsewhere, which may know others by the
/// same ids, none.
pub fn drives<'a>(
    people: &BTreeSet<ParticipantId>,
    design: &Design,
    learned: impl IntoIterator<Item = &'a DriveId>,
) -> BTreeSet<DriveId> {
    if design.model().is_some() {
        return BTreeSet::new();
    }
    let roles = design.roles().iter().map(|role| role.id.as_str());
    let labels: Vec<&str> = std::iter::once(design.own_drive_label()).chain(roles).collect();
    // `P1-own`, or `P1-own_s2_t1`.
    let is_label = |rest: &str| {
        labels.iter().any(|label| {
            let occasion = rest.strip_prefix(label);
            occasion.is_some_and(|occasion| occasion.is_empty() || occasion.starts_with("_s"))
        })
    };
    let is_by = |drive: &DriveId, who: &ParticipantId| {
        let rest = drive.as_str().strip_prefix(who.as_str());
        rest.and_then(|rest| rest.strip_prefix('-')).is_some_and(is_label)
    };
    let learned = learned.into_iter();
    learned.filter(|drive| people.iter().any(|who| is_by(drive, who))).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(who: &str, style_lent: Option<bool>) -> ConsentRow {
        ConsentRow {
            participant: ParticipantId::new(who).unwrap(),
            step: 1,
            text_sha256: "aa".to_owned(),
            at: None,
            style_lent,
        }
    }

    fn withheld(rows: &[ConsentRow]) -> Vec<String> {
        people(rows).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn whoever_agreed_and_did_not_tick_lends_nothing_and_whoever_ticked_or_was_to_agree_to_nothing_does()
     {
        let (ticked, left) = (row("P1", Some(true)), row("P2", Some(false)));
        let before = row("P3", None);
        assert_eq!(withheld(&[ticked.clone(), left, before.clone()]), ["P2", "P3"]);
        assert!(withheld(std::slice::from_ref(&ticked)).is_empty());
        assert_eq!(withheld(&[before]), ["P3"]);
        assert!(withheld(&[]).is_empty());
    }

    #[test]
    fn drives_that_this_study_learned_from_are_their_peoples_and_those_of_another_model_are_not() {
        let design = |learned: &str| {
            let text = format!(
                "[study]\ntitle = \"Two\"\n{learned}\n[style]\nscore = \"adb.total\"\n\
                 [[condition]]\nid = \"other\"\ncar = {{ other = \"matched\" }}\n"
            );
            Design::from_toml(&text).unwrap()
        };
        let ids = ["P1-own", "P1-own_s2_t1", "P1-by-hand", "P1-2-own", "P10-own", "P2-own"];
        let learned = ids.map(|id| DriveId::new(id).unwrap());
        let refused = BTreeSet::from([ParticipantId::new("P1").unwrap()]);
        let here = design("[people]\nlearn = { part = \"learn\" }");
        let of = |design: &Design| {
            let kept_back = drives(&refused, design, &learned).into_iter();
            let ids: Vec<String> = kept_back.map(|drive| drive.to_string()).collect();
            ids
        };
        // Without a baseline the seat names a drive by hand `own`; with one as it is named.
        assert_eq!(of(&here), ["P1-own", "P1-own_s2_t1"]);
        let named = design("[people]\nlearn = { part = \"learn\" }\n[baseline]\nid = \"by-hand\"");
        assert_eq!(of(&named), ["P1-by-hand"]);
        assert!(drives(&BTreeSet::new(), &here, &learned).is_empty());
        let elsewhere = design("[model]\nfile = \"lab.maveric\"");
        assert!(drives(&refused, &elsewhere, &learned).is_empty());
    }
}
