//! A channel that may be chosen.

use super::slots::Role;

/// What is known of a channel when choosing.
#[derive(Debug, Clone)]
pub(crate) struct Candidate<'a> {
    pub(crate) topic: &'a str,
    pub(crate) type_name: &'a str,
    pub(crate) messages: usize,
    pub(crate) role: Result<Option<Role>, &'a str>,
}
