//! In which order people meet the conditions of a design.

use super::{Design, DesignError, Square, error::refuse};
use crate::condition::ConditionId;

/// Orders of a design's conditions, a person each: rows of a square; where the levels of a factor are met in blocks, a square of the
/// blocks, and within each a square of its conditions.
///
/// # Example
/// ```
/// # use maveric_domain::{Design, design::{OrderPlan, Square}};
/// let design = Design::from_toml(r#"
///     [study]
///     title = "Calm or sporty"
///     [[condition]]
///     id = "calm"
///     [[condition]]
///     id = "sporty"
/// "#)?;
/// let plan = OrderPlan::new(&design, Square::Williams, None)?;
/// assert_eq!(plan.people(), 2);
/// assert_eq!(plan.order(1)[0].as_str(), "sporty");
/// # Ok::<(), maveric_domain::DesignError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OrderPlan {
    square: Square,
    /// The conditions of each block, in the order of the design; one block where nothing divides them.
    blocks: Vec<Vec<ConditionId>>,
}

impl OrderPlan {
    /// A plan for a design; `blocks` is the factor whose levels are met one after the other.
    ///
    /// # Errors
    /// [`DesignError::Key`] for a factor that the conditions do not cross, naming those that they do; levels with different numbers of
    /// conditions.
    pub fn new(design: &Design, square: Square, blocks: Option<&str>) -> Result<Self, DesignError> {
        let conditions = design.conditions();
        let Some(factor) = blocks else {
            let ids = conditions.iter().map(|c| c.id).collect();
            return Ok(Self { square, blocks: vec![ids] });
        };
        let mut levels: Vec<&String> = Vec::new();
        for condition in conditions {
            let Some(level) = condition.levels.get(factor) else {
                let crossed = conditions.iter().flat_map(|c| c.levels.keys());
                return Err(DesignError::word(
                    "condition.levels",
                    factor,
                    crossed.map(String::as_str),
                ));
            };
            if !levels.contains(&level) {
                levels.push(level);
            }
        }
        let of_level = |level: &&String| -> Vec<ConditionId> {
            let there = conditions.iter().filter(|c| c.levels.get(factor) == Some(*level));
            there.map(|c| c.id).collect()
        };
        let blocks: Vec<Vec<ConditionId>> = levels.iter().map(of_level).collect();
        if let Some((level, block)) =
            levels.iter().zip(&blocks).find(|(_, b)| b.len() != blocks[0].len())
        {
            return refuse(
                format!("condition.levels.{factor}"),
                format!("{} conditions at `{level}`", block.len()),
                format!("{} as at `{}`, so that blocks are alike", blocks[0].len(), levels[0]),
            );
        }
        Ok(Self { square, blocks })
    }

    /// After how many people every order has been met equally often.
    pub fn people(&self) -> usize {
        self.rows_of_blocks() * self.square.rows(self.in_a_block())
    }

    /// One block has one order, which no square doubles.
    fn rows_of_blocks(&self) -> usize {
        match self.blocks.len() {
            0 | 1 => 1,
            several => self.square.rows(several),
        }
    }

    fn in_a_block(&self) -> usize {
        self.blocks.first().map_or(0, Vec::len)
    }

    /// The order of the person `index`, from 0.
    pub fn order(&self, index: usize) -> Vec<ConditionId> {
        let rows = self.rows_of_blocks();
        let within = self.square.row(self.in_a_block(), index / rows);
        let blocks = self.square.row(self.blocks.len(), index % rows);
        let of_block = |block: usize| within.iter().map(move |place| (block, *place));
        let places = blocks.into_iter().flat_map(of_block);
        places.map(|(block, place)| self.blocks[block][place]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[expect(clippy::format_push_string, reason = "a small table, put together")]
    fn crossed() -> Design {
        let mut text = "[study]\ntitle = \"t\"\n".to_owned();
        for traffic in ["dense", "light"] {
            for style in ["calm", "own", "sporty"] {
                text += &format!(
                    "[[condition]]\nid = \"{style}-{traffic}\"\nlevels = {{ style = \"{style}\", traffic = \"{traffic}\" }}\n"
                );
            }
        }
        Design::from_toml(&text).unwrap()
    }

    #[test]
    fn blocks_stay_together_and_each_condition_stands_in_every_place_equally_often() {
        let plan = OrderPlan::new(&crossed(), Square::Williams, Some("traffic")).unwrap();
        assert_eq!(plan.people(), 2 * 6);
        let mut places: BTreeMap<(usize, ConditionId), usize> = BTreeMap::new();
        for person in 0..plan.people() {
            let order = plan.order(person);
            let traffic = |at: usize| order[at].as_str().split('-').next_back().unwrap().to_owned();
            assert!(
                traffic(0) == traffic(1) && traffic(1) == traffic(2) && traffic(2) != traffic(3)
            );
            for (place, condition) in order.into_iter().enumerate() {
                *places.entry((place, condition)).or_default() += 1;
            }
        }
        assert_eq!(places.len(), 36);
        assert!(places.values().all(|n| *n == 2));
        assert_eq!(plan.order(0), plan.order(12));
    }

    #[test]
    fn without_blocks_it_is_the_square_of_all_conditions() {
        let design = crossed();
        for (square, people) in [(Square::Williams, 6), (Square::Latin, 6)] {
            let plan = OrderPlan::new(&design, square, None).unwrap();
            assert_eq!(plan.people(), people);
            let numbers = square.row(6, 1).into_iter().map(|i| design.conditions()[i].id);
            assert_eq!(plan.order(1), numbers.collect::<Vec<_>>());
        }
    }

    #[test]
    fn blocks_by_a_factor_that_is_none_are_refused_by_name() {
        let error = OrderPlan::new(&crossed(), Square::Latin, Some("trafic")).unwrap_err();
        assert_eq!(error.suggestion().unwrap(), "did you mean `traffic`?");
        let plain = Design::from_toml(
            "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n[[condition]]\nid = \"b\"\n",
        )
        .unwrap();
        assert!(OrderPlan::new(&plain, Square::Latin, Some("traffic")).is_err());
    }
}
