//! Which channels make the drive.

use super::{candidate::Candidate, rigs, slots::Role};
use crate::{
    error::IngestError,
    mapping::{McapMapping, Topics, names::matches},
};
use maveric_domain::nearest;
use std::path::Path;

/// Which channels make the drive: indices into the candidates.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Choice {
    /// Ego's pose; the others' channel where ego is told from it.
    pub(crate) ego: usize,
    pub(crate) objects: Option<usize>,
    /// Ego's speed, where its pose comes without one.
    pub(crate) speed: Option<usize>,
    /// Says which object is ego.
    pub(crate) identity: Option<usize>,
    /// Said where there was more than one candidate.
    pub(crate) others: Option<String>,
    /// The rig that the channels show.
    pub(crate) rig: Option<&'static str>,
    /// What applies: the mapping over the rig's.
    pub(crate) mapping: McapMapping,
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
    given: Option<&McapMapping>,
    candidates: &[Candidate<'_>],
) -> Result<Choice, IngestError> {
    let chooser = Chooser { path, candidates };
    let (mapping, rig) = rigs::applied(given, candidates);
    let named = |topics: fn(&McapMapping) -> &Topics, roles: &[Role]| {
        let must = given.is_some_and(|g| !topics(g).0.is_empty());
        chooser.named(topics(&mapping), roles, must)
    };
    let identity = chooser.best(Role::Identity, &|_| false);
    let objects_named = named(|m| &m.objects_topic, &[Role::Objects])?;
    let of_ego = [Role::Odometry, Role::Pose, Role::Frames, Role::Fix];
    let by_name = named(|m| &m.ego_topic, &of_ego)?;
    let names_ego = |topic: &str| {
        let topic = topic.to_ascii_lowercase();
        topic.contains("ego") || topic.contains("hero")
    };
    let by_type = || of_ego.into_iter().find_map(|role| chooser.best(role, &names_ego));
    let among_objects = || {
        let known = mapping.ego_object.is_some() || identity.is_some();
        let list = objects_named.or_else(|| chooser.best(Role::Objects, &|_| false));
        list.filter(|_| known)
    };
    let by_object = given.is_some_and(|g| g.ego_object.is_some() && g.ego_topic.0.is_empty());
    let ego = if by_object { among_objects() } else { None };
    let ego = ego.or(by_name).or_else(by_type).or_else(among_objects);
    let ego = ego
        .ok_or_else(|| IngestError::NoEgo { path: path.to_owned(), found: describe(candidates) })?;
    let beside_ego = |topic: &str| parent(topic) == parent(candidates[ego].topic);
    let objects = objects_named.or_else(|| chooser.best(Role::Objects, &beside_ego));
    let role = candidates[ego].role;
    let speed = match role {
        Ok(Some(Role::Pose | Role::Frames | Role::Fix)) => {
            named(|m| &m.speed_topic, &[Role::Speed])?
                .or_else(|| chooser.best(Role::Speed, &beside_ego))
        }
        _ => None,
    };
    let rivals = (0..candidates.len()).filter(|&i| i != ego && candidates[i].role == role);
    let rivals: Vec<&str> = rivals.map(|i| candidates[i].topic).collect();
    let others = (!rivals.is_empty() && role != Ok(Some(Role::Objects))).then(|| {
        let chosen = candidates[ego].topic;
        format!("ego is taken from `{chosen}`, not from {}", rivals.join(", "))
    });
    Ok(Choice { ego, objects, speed, identity, others, rig, mapping })
}

struct Chooser<'a> {
    path: &'a Path,
    candidates: &'a [Candidate<'a>],
}

impl Chooser<'_> {
    fn with_role(&self, role: Role) -> impl Iterator<Item = usize> {
        let indices = 0..self.candidates.len();
        indices.filter(move |&i| {
            self.candidates[i].role == Ok(Some(role)) && self.candidates[i].messages > 0
        })
    }

    /// The first channel that a pattern names, by pattern, then role, then number of messages.
    fn named(
        &self,
        topics: &Topics,
        roles: &[Role],
        must: bool,
    ) -> Result<Option<usize>, IngestError> {
        let candidates = || roles.iter().flat_map(|&role| self.with_role(role));
        for pattern in &topics.0 {
            let fits = |topic: &str| matches(pattern, topic);
            let of_role = |&role: &Role| {
                let best = self.best(role, &fits);
                best.filter(|&i| fits(self.candidates[i].topic))
            };
            let most = roles.iter().find_map(of_role);
            if most.is_some() {
                return Ok(most);
            }
        }
        match topics.0.first().filter(|_| must) {
            None => Ok(None),
            Some(topic) => Err(IngestError::UnknownTopic {
                path: self.path.to_owned(),
                topic: topic.clone(),
                nearest: nearest(topic, candidates().map(|i| self.candidates[i].topic))
                    .map(str::to_owned),
            }),
        }
    }

    fn best(&self, role: Role, prefer: &dyn Fn(&str) -> bool) -> Option<usize> {
        self.with_role(role).max_by_key(|&i| {
            let f = &self.candidates[i];
            (prefer(f.topic), f.messages, std::cmp::Reverse(f.topic))
        })
    }
}

fn describe(candidates: &[Candidate<'_>]) -> String {
    const MOST: usize = 6;
    if candidates.is_empty() {
        return "it has no channels".to_owned();
    }
    let one = |f: &Candidate<'_>| {
        let why = match &f.role {
            Err(why) => format!(", {why}"),
            Ok(Some(_)) if f.messages == 0 => ", no messages".to_owned(),
            Ok(_) => String::new(),
        };
        format!("`{}` ({}{why})", f.topic, f.type_name)
    };
    let mut list: Vec<String> = candidates.iter().take(MOST).map(one).collect();
    if candidates.len() > MOST {
        list.push(format!("and {} more", candidates.len() - MOST));
    }
    list.join(", ")
}
