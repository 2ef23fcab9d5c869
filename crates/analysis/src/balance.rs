//! How evenly the conditions stand in the orders in which people met them.

use maveric_domain::{ConditionId, Design};
use serde::{Deserialize, Serialize};

/// How often each condition stood in each place of people's orders, and after each other condition.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct OrderBalance {
    /// People whose order is known.
    pub people: usize,
    /// People whose order is not known.
    pub unknown: usize,
    /// A row a condition, in the order of the design.
    pub conditions: Vec<PlacesOf>,
    /// What the counts come to.
    pub balance: Balance,
}

/// Where one condition stood.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlacesOf {
    /// The condition whose places are counted.
    pub condition: ConditionId,
    /// How many people met it first, second and so on.
    pub places: Vec<usize>,
    /// How many people met it directly after each condition, in the order of the design; 0 after itself.
    pub after: Vec<usize>,
}

/// How even counts are: as even as their number lets them be, where none differs from another by more than 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Balance {
    /// Each condition stands as often in every place as every other, and directly after every other.
    PlacesAndSuccession,
    /// In every place, not after every other.
    Places,
    /// Not in every place.
    Neither,
}

impl OrderBalance {
    /// Of the orders of people, empty where they are not known; none where nobody's is.
    pub fn of<'o>(
        design: &Design,
        orders: impl IntoIterator<Item = &'o [ConditionId]>,
    ) -> Option<Self> {
        let ids: Vec<ConditionId> = design.condition_ids().collect();
        let n = ids.len();
        let none = |condition: &ConditionId| PlacesOf {
            condition: *condition,
            places: vec![0; n],
            after: vec![0; n],
        };
        let mut rows: Vec<PlacesOf> = ids.iter().map(none).collect();
        let (mut people, mut unknown) = (0, 0);
        for order in orders {
            if order.is_empty() {
                unknown += 1;
                continue;
            }
            people += 1;
            let numbers = order.iter().map(|id| ids.iter().position(|known| known == id));
            let numbers: Vec<Option<usize>> = numbers.collect();
            for (place, number) in numbers.iter().enumerate() {
                let Some(row) = number.and_then(|number| rows.get_mut(number)) else {
                    continue;
                };
                if let Some(count) = row.places.get_mut(place) {
                    *count += 1;
                }
                let before = place.checked_sub(1).and_then(|place| numbers[place]);
                if let Some(count) = before.and_then(|before| row.after.get_mut(before)) {
                    *count += 1;
                }
            }
        }
        let even = |counts: Vec<usize>| match (counts.iter().min(), counts.iter().max()) {
            (Some(least), Some(most)) => most - least <= 1,
            _ => true,
        };
        let places = even(rows.iter().flat_map(|row| row.places.clone()).collect());
        let others = |(number, row): (usize, &PlacesOf)| -> Vec<usize> {
            let others = row.after.iter().enumerate().filter(|(before, _)| *before != number);
            others.map(|(_, count)| *count).collect()
        };
        let succession = even(rows.iter().enumerate().flat_map(others).collect());
        let balance = match (places, succession) {
            (true, true) => Balance::PlacesAndSuccession,
            (true, false) => Balance::Places,
            (false, _) => Balance::Neither,
        };
        (people > 0).then_some(Self { people, unknown, conditions: rows, balance })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::design::{OrderPlan, Square};

    fn design() -> Design {
        let conditions = ["a", "b", "c", "d"].map(|id| format!("[[condition]]\nid = \"{id}\"\n"));
        Design::from_toml(&format!("[study]\ntitle = \"t\"\n{}", conditions.concat())).unwrap()
    }

    fn balance(square: Square, people: usize) -> OrderBalance {
        let design = design();
        let plan = OrderPlan::new(&design, square, None).unwrap();
        let orders: Vec<Vec<ConditionId>> = (0..people).map(|person| plan.order(person)).collect();
        OrderBalance::of(&design, orders.iter().map(Vec::as_slice)).unwrap()
    }

    #[test]
    fn a_williams_square_is_even_in_places_and_succession_a_latin_one_in_places_alone() {
        let williams = balance(Square::Williams, 8);
        assert_eq!(williams.balance, Balance::PlacesAndSuccession);
        assert_eq!(williams.conditions[0].places, [2, 2, 2, 2]);
        assert_eq!(williams.conditions[0].after, [0, 2, 2, 2]);
        let latin = balance(Square::Latin, 8);
        assert_eq!(latin.balance, Balance::Places);
        assert_eq!(latin.conditions[1].after, [6, 0, 0, 0]);
    }

    #[test]
    fn people_beyond_a_whole_square_are_as_even_as_can_be_and_the_same_order_for_all_is_not() {
        assert_eq!(balance(Square::Williams, 5).balance, Balance::PlacesAndSuccession);
        let design = design();
        let plan = OrderPlan::new(&design, Square::Williams, None).unwrap();
        let order = plan.order(0);
        let uneven = OrderBalance::of(&design, [&order[..], &order[..], &[]]).unwrap();
        assert_eq!((uneven.people, uneven.unknown), (2, 1));
        assert_eq!(uneven.balance, Balance::Neither);
        assert_eq!(uneven.conditions[0].places, [2, 0, 0, 0]);
    }

    #[test]
    fn without_any_order_there_is_no_balance() {
        assert_eq!(OrderBalance::of(&design(), [&[][..], &[][..]]), None);
    }
}
