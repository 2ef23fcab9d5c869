//! Item by item, the scores that are tested without some of their items.

use super::{run::Run, setting::titled};
use crate::{
    atomic_write::if_there, error::StudyError, stages::score::ItemMean, tables::read_rows,
};
use maveric_domain::design::Quantity;
use maveric_pages::study::ItemInCondition;
use std::path::Path;

/// What was answered to their items in the conditions, in the order of the design.
pub(super) fn items_of_reduced(
    folder: &Path,
    run: &Run,
) -> Result<Vec<ItemInCondition>, StudyError> {
    let mut rows = Vec::new();
    let reduced = run.design.outcomes().iter();
    let reduced = reduced.filter(|o| !o.drop_items.is_empty());
    let answered: Vec<ItemMean> =
        if_there(&folder.join("rating_scores_item_means.csv"), read_rows)?;
    for outcome in reduced {
        let Quantity::Score(name) = &outcome.quantity else {
            continue;
        };
        let Some(scale) = run.scales.iter().find(|s| s.id == name.scale) else {
            continue;
        };
        let Some(subscale) = scale.subscales.iter().find(|s| s.id == name.subscale) else {
            continue;
        };
        let title = titled(&run.scales, &scale.id, &subscale.id);
        for item in scale.items_of(subscale) {
            let words = scale.wording.items.get(item as usize - 1);
            for condition in run.design.conditions() {
                let is_it = |m: &&ItemMean| {
                    m.scale == scale.id && m.item == item && m.condition == condition.id
                };
                rows.extend(answered.iter().find(is_it).map(|answers| ItemInCondition {
                    outcome: outcome.id(),
                    title: title.clone(),
                    item,
                    words: words.map(|w| w.text.clone()).unwrap_or_default(),
                    is_dropped: outcome.drop_items.contains(&item),
                    condition: condition.id,
                    n: answers.n,
                    mean: answers.mean,
                    sd: answers.sd,
                }));
            }
        }
    }
    Ok(rows)
}
