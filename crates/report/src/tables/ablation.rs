//! What each part of the model is worth, in numbers.

use super::{Cell, Column, Table};
use crate::apa::number;
use crate::figures::ablation::{Ablation, Difference};
use crate::markup;

/// Builds the table `ablation` of the variants that [`crate::figures::ablation()`] draws: the mean loss of each and how
/// much it is above the first variant's on the same drives, with the paired 95% interval.
pub fn ablation(input: &Ablation) -> Table {
    let mut columns = vec![Column::left("Variant")];
    for loss in &input.losses {
        columns.push(Column::right(loss));
        columns.push(Column::right("Difference [95% CI]"));
    }
    let reference = input.variants.first();
    let row = |(index, variant): (usize, &crate::figures::ablation::AblationVariant)| {
        let mut cells = vec![Cell::text(&variant.name)];
        for (loss, values) in variant.losses.iter().enumerate() {
            let have: Vec<f64> = values.iter().flatten().copied().collect();
            let mean = have.iter().sum::<f64>() / have.len() as f64;
            cells.push(Cell::number_or(
                (!have.is_empty()).then_some(mean),
                3,
                "no unseen drive has this loss",
            ));
            let first = reference.and_then(|first| first.losses.get(loss));
            let difference = first.and_then(|first| Difference::of(values, first));
            cells.push(match (index, difference) {
                (0, _) => Cell::MissingBecause("what the others are compared with".to_owned()),
                (_, Some(d)) => Cell::text(format!(
                    "{} [{}, {}]",
                    number(d.mean, 3),
                    number(d.mean - d.half, 3),
                    number(d.mean + d.half, 3)
                )),
                (_, None) => Cell::MissingBecause("no drive has it in both variants".to_owned()),
            });
        }
        cells
    };
    let name = reference.map_or_else(String::new, |first| markup::literal(&first.name));
    let drives = reference
        .and_then(|first| first.losses.first())
        .map_or(0, Vec::len);
    Table {
        name: "ablation".to_owned(),
        title: "What each part is worth".to_owned(),
        columns,
        rows: input.variants.iter().enumerate().map(row).collect(),
        notes: vec![format!(
            "Mean loss on drivers that the networks have not seen ({}-fold cross-validation by driver), and the \
             difference from {name} on the same drives with its paired 95% interval (*t*): above 0 is worse. *n* = \
             {drives} drives; no adjustment for the number of variants.",
            input.folds
        )],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::ablation::AblationVariant;

    #[test]
    fn a_variant_without_a_loss_has_a_dash_with_its_reason() {
        let variant = |name: &str, values: [Option<f64>; 2]| AblationVariant {
            name: name.into(),
            losses: vec![values.to_vec()],
        };
        let table = ablation(&Ablation {
            losses: vec!["*L*_{1}".into()],
            variants: vec![
                variant("size 3", [Some(0.4), Some(0.5)]),
                variant("size_1", [Some(0.5), Some(0.6)]),
                variant("none", [None, None]),
            ],
            folds: 5,
        });
        table.check().unwrap();
        let latex = table.to_latex();
        assert!(
            latex.contains("size\\_1 & 0.550 & 0.100 [0.100, 0.100]"),
            "{latex}"
        );
        assert!(
            latex.contains("none & –\\textsuperscript{b} & –\\textsuperscript{c}"),
            "{latex}"
        );
    }
}
