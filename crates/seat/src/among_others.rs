//! Somebody's style beside those of the others, for who has taken part.

use crate::{error::SeatError, listed::Listed, person::Person, seat::Seat};
use maveric_domain::design::Sign;
use serde::Serialize;

/// Fewer others could be told apart by who knows when they drove.
const FEWEST_OTHERS: usize = 4;

/// Scores that the model reads from how people drove, in the scale's points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct AmongOthers {
    /// Their own; none of a drive beyond what the model has learned from.
    pub(crate) own: Option<f64>,
    /// The others' who are through, lowest first; nobody's who is beyond.
    pub(crate) others: Vec<f64>,
    /// Whether more points are sportier.
    pub(crate) sportier_up: bool,
}

/// What is known of somebody's score: none without any, inside none where their drive is beyond what the model has learned from.
#[expect(
    clippy::option_option,
    reason = "nothing to say, and a score that nobody can say, are two"
)]
fn score(person: &Person) -> Option<Option<f64>> {
    let style = person.style()?;
    if style.beyond.is_some() {
        return Some(None);
    }
    style.score.filter(|_| style.readings > 0).map(Some)
}

fn through(person: &Person) -> bool {
    person.ended.as_deref() == Some("done")
}

/// The score of `person`, as [`score`] has it, and those of the others who are through, lowest first; none before they are through or
/// beside too few.
fn beside(person: &Person, everybody: &[Person]) -> Option<(Option<f64>, Vec<f64>)> {
    let own_score = score(person).filter(|_| through(person))?;
    let others = everybody.iter().filter(|p| through(p) && p.token != person.token);
    let mut others: Vec<f64> = others.filter_map(score).flatten().collect();
    others.sort_by(f64::total_cmp);
    (others.len() >= FEWEST_OTHERS).then_some((own_score, others))
}

impl Seat {
    /// Those of whom others may see something: not who was taken out of the study.
    pub(crate) fn seen(&self, mut everybody: Vec<Person>) -> Vec<Person> {
        let excluded = &self.settings.design.exclude().people;
        let out = |p: &Person| excluded.keys().any(|id| id.as_str() == p.participant);
        everybody.retain(|p| p.listed != Listed::TakenOut && !out(p));
        everybody
    }

    /// What `person` may see of the others: nothing where the study does not show it.
    pub(crate) fn among_others(&self, person: &Person) -> Result<Option<AmongOthers>, SeatError> {
        let design = &self.settings.design;
        let Some(style) = design.style().filter(|_| design.protocol().show_style) else {
            return Ok(None);
        };
        let seen = self.store.look(|b| b.everybody().map(|people| self.seen(people)))?;
        let scores = beside(person, &seen);
        Ok(scores.map(|(own, others)| AmongOthers {
            own,
            others,
            sportier_up: style.aggression == Sign::Plus,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn person(token: &str, score: f64, ended: Option<&str>) -> Person {
        let fit =
            format!(r#"{{"embedding":[0.0],"covariance":null,"score":{score},"readings":3}}"#);
        Person {
            ended: ended.map(str::to_owned),
            fit: Some(fit),
            ..Person::new(token.to_owned(), token.to_owned(), Vec::new())
        }
    }

    #[test]
    fn a_style_is_shown_beside_those_who_are_through_and_not_beside_too_few() {
        let mut all: Vec<Person> = [31.0, 18.5, 40.0, 25.0]
            .iter()
            .enumerate()
            .map(|(i, score)| person(&i.to_string(), *score, Some("done")))
            .collect();
        all.push(person("left", 50.0, Some("left")));
        let me = person("me", 20.0, Some("done"));
        let found = beside(&me, &all);
        assert_eq!(found, Some((Some(20.0), vec![18.5, 25.0, 31.0, 40.0])));
        assert_eq!(beside(&person("me", 20.0, None), &all), None);
        // Three others: they could be told apart.
        assert_eq!(beside(&all[0], &all), None);
    }

    #[test]
    fn who_drives_beyond_what_the_model_has_learned_from_has_no_place_among_the_others_and_is_nobodys_neighbour()
     {
        let mut all: Vec<Person> = [31.0, 18.5, 40.0, 25.0]
            .iter()
            .enumerate()
            .map(|(i, score)| person(&i.to_string(), *score, Some("done")))
            .collect();
        let others = vec![18.5, 25.0, 31.0, 40.0];
        let off_the_scale = |token: &str| {
            let mut person = person(token, 60.0, Some("done"));
            let fit = person.fit.take().unwrap();
            person.fit = Some(fit.replace("60", r#"null,"beyond":"scale""#));
            person
        };
        all.push(off_the_scale("other"));
        let off_the_scale = off_the_scale("me");
        assert_eq!(beside(&off_the_scale, &all), Some((None, others.clone())));
        let mut stranger = person("me", 20.0, Some("done"));
        let fit = stranger.fit.take().unwrap();
        stranger.fit = Some(fit.replace('}', r#","beyond":"style:pass"}"#));
        assert_eq!(beside(&stranger, &all), Some((None, others)));
        // Who shows nothing is not compared at all.
        let nothing = stranger.fit.take().unwrap();
        stranger.fit = Some(
            nothing
                .replace(r#","beyond":"style:pass""#, "")
                .replace("\"readings\":3", "\"readings\":0"),
        );
        all.push(stranger.clone());
        assert_eq!(beside(&stranger, &all), None);
    }
}
