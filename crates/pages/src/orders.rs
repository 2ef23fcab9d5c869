//! How evenly the conditions stand in people's orders, in words; they are `texts/orders.toml`.

use crate::texts::Texts;
use maveric_analysis::{Balance, OrderBalance};
use maveric_domain::Design;
use maveric_report::ReportError;
use minijinja::context;

/// A sentence on what the counts come to, then one a condition: how often it stands first, second and so on.
///
/// # Errors
/// [`ReportError::Template`] for a text that asks for a value which is not given.
pub fn orders(design: &Design, balance: &OrderBalance) -> Result<Vec<String>, ReportError> {
    let texts = Texts::read("orders.toml", include_str!("../texts/orders.toml"))?;
    let values = context! { people => balance.people, unknown => balance.unknown };
    let key = match balance.balance {
        Balance::PlacesAndSuccession => "places_and_succession",
        Balance::Places => "places",
        Balance::Neither => "neither",
    };
    let first = texts.say("orders", "people", &values)? + &texts.say("orders", key, &values)?;
    let mut lines = vec![first];
    for row in &balance.conditions {
        let counts = row.places.iter().enumerate();
        let places = counts.map(|(at, people)| format!("{} for {people}", ordinal(at + 1)));
        let label = design.label(row.condition);
        let values = context! { label, places => places.collect::<Vec<_>>() };
        lines.push(texts.say("orders", "row", &values)?);
    }
    Ok(lines)
}

/// The word for a place.
fn ordinal(place: usize) -> String {
    let end = match (place % 10, place % 100) {
        (1, n) if n != 11 => "st",
        (2, n) if n != 12 => "nd",
        (3, n) if n != 13 => "rd",
        _ => "th",
    };
    format!("{place}{end}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::ConditionId;

    #[test]
    fn the_balance_is_told_with_the_count_of_each_place() {
        let text = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\nlabel = \"Calm\"\n[[condition]]\nid = \"sporty\"\n";
        let design = Design::from_toml(text).unwrap();
        let [calm, sporty] = ["calm", "sporty"].map(|id| id.parse::<ConditionId>().unwrap());
        let told = |orders: &[&[ConditionId]]| {
            let balance = OrderBalance::of(&design, orders.iter().copied()).unwrap();
            super::orders(&design, &balance).unwrap()
        };
        let lines = told(&[&[calm, sporty], &[sporty, calm], &[]]);
        assert!(
            lines[0].starts_with(
                "2 people met the conditions in an order that is known, 1 in one that is not."
            ),
            "{lines:?}"
        );
        assert!(lines[0].contains("directly after every other, as often"), "{lines:?}");
        assert_eq!(lines[1], "Calm was 1st for 1, 2nd for 1.");
        let lines = told(&[&[calm, sporty], &[calm, sporty]]);
        assert!(lines[0].contains("not balanced"), "{lines:?}");
    }

    #[test]
    fn places_have_their_ordinals() {
        let words = [1, 2, 3, 4, 11, 12, 13, 21].map(ordinal);
        assert_eq!(words, ["1st", "2nd", "3rd", "4th", "11th", "12th", "13th", "21st"]);
    }
}
