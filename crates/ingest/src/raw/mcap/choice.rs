//! Which channels make the drive.

use super::channels::Role;
use crate::{
    error::{IngestError, nearest},
    mapping::McapMapping,
};
use std::path::Path;

/// What is known of a channel when choosing.
#[derive(Debug, Clone)]
pub(crate) struct Found<'a> {
    pub(crate) topic: &'a str,
    pub(crate) type_name: &'a str,
    pub(crate) messages: usize,
    pub(crate) role: Result<Option<Role>, &'a str>,
}

/// Which channels make the drive: indices into what was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Choice {
    pub(crate) ego: usize,
    pub(crate) objects: Option<usize>,
    /// Said where there was more than one candidate.
    pub(crate) others: Option<String>,
}

/// The topic without its last part.
pub(crate) fn parent(topic: &str) -> &str {
    topic.rsplit_once('/').map_or("", |(parent, _)| parent)
}

/// Chooses ego's channel and that of the others.
///
/// # Errors
/// [`IngestError::NoEgo`], [`IngestError::UnknownTopic`].
pub(crate) fn choose(
    path: &Path,
    mapping: Option<&McapMapping>,
    found: &[Found<'_>],
) -> Result<Choice, IngestError> {
    let with_role = |role: Role| {
        let indices = (0..found.len()).filter(move |&i| found[i].role == Ok(Some(role)));
        indices.filter(|&i| found[i].messages > 0)
    };
    let named = |topic: &str, roles: &[Role]| {
        let candidates = || roles.iter().flat_map(|&role| with_role(role));
        let exact = candidates().find(|&i| found[i].topic == topic);
        exact.ok_or_else(|| IngestError::UnknownTopic {
            path: path.to_owned(),
            topic: topic.to_owned(),
            nearest: nearest(topic, candidates().map(|i| found[i].topic)),
        })
    };
    let best = |role: Role, prefer: &dyn Fn(&str) -> bool| {
        with_role(role).max_by_key(|&i| {
            let f = &found[i];
            (prefer(f.topic), f.messages, std::cmp::Reverse(f.topic))
        })
    };
    let names_ego = |topic: &str| {
        let topic = topic.to_ascii_lowercase();
        topic.contains("ego") || topic.contains("hero")
    };
    let ego = match mapping.and_then(|m| m.ego_topic.as_deref()) {
        Some(topic) => named(topic, &[Role::Odometry, Role::Pose])?,
        None => best(Role::Odometry, &names_ego)
            .or_else(|| best(Role::Pose, &names_ego))
            .ok_or_else(|| IngestError::NoEgo {
                path: path.to_owned(),
                found: describe(found),
            })?,
    };
    let beside_ego = |topic: &str| parent(topic) == parent(found[ego].topic);
    let objects = match mapping.and_then(|m| m.objects_topic.as_deref()) {
        Some(topic) => Some(named(topic, &[Role::Objects])?),
        None => best(Role::Objects, &beside_ego),
    };
    let role = found[ego].role;
    let rivals = (0..found.len()).filter(|&i| i != ego && found[i].role == role);
    let rivals: Vec<&str> = rivals.map(|i| found[i].topic).collect();
    let others = (!rivals.is_empty()).then(|| {
        let chosen = found[ego].topic;
        format!(
            "ego is taken from `{chosen}`, not from {}",
            rivals.join(", ")
        )
    });
    Ok(Choice {
        ego,
        objects,
        others,
    })
}

fn describe(found: &[Found<'_>]) -> String {
    const MOST: usize = 6;
    if found.is_empty() {
        return "it has no channels".to_owned();
    }
    let one = |f: &Found<'_>| {
        let why = match &f.role {
            Err(why) => format!(", {why}"),
            Ok(Some(_)) if f.messages == 0 => ", no messages".to_owned(),
            Ok(_) => String::new(),
        };
        format!("`{}` ({}{why})", f.topic, f.type_name)
    };
    let mut list: Vec<String> = found.iter().take(MOST).map(one).collect();
    if found.len() > MOST {
        list.push(format!("and {} more", found.len() - MOST));
    }
    list.join(", ")
}
