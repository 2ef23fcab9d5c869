//! What each part of the model is worth on drivers it has not seen.

use super::prelude::*;
use maveric_stats::{mean, mean_interval};

/// Variants of the model on the same unseen drivers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ablation {
    /// Titles of the panels, one a loss; with marks.
    pub losses: Vec<String>,
    /// The variants from top to bottom; the first is the one that all others are compared with.
    pub variants: Vec<AblationVariant>,
    /// Folds of the cross-validation, for the caption.
    pub folds: usize,
}

/// The model that the others are compared with, or one that differs from it in a part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AblationVariant {
    /// Such as `size 2`.
    pub name: String,
    /// For each loss its value on every unseen drive, in the same order for all variants; `None`: that drive has
    /// none.
    pub losses: Vec<Vec<Option<f64>>>,
}

const NAME: &str = "ablation";

/// A variant's loss minus the reference's, drive by drive: mean and its 95% interval, which is the mean itself for a single drive;
/// `None` if no drive has a loss in both.
fn difference(variant: &[Option<f64>], reference: &[Option<f64>]) -> Option<[f64; 3]> {
    let pairs = variant.iter().zip(reference);
    let by_drive: Vec<f64> = pairs.filter_map(|(v, r)| Some((*v)? - (*r)?)).collect();
    mean_interval(&by_drive, 0.95).or_else(|| mean(&by_drive).map(|mean| [mean; 3]))
}

/// Draws, loss by loss, how much worse each variant is than the first, with paired 95% intervals.
///
/// # Errors
/// [`ReportError`] if there is no loss or fewer than two variants, lengths differ, or a value is not finite.
pub fn ablation(input: &Ablation, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "losses", input.losses.len())?;
    check.at_least(2, "variants", input.variants.len())?;
    let reference = &input.variants[0];
    for variant in &input.variants {
        check.length(&variant.name, variant.losses.len(), input.losses.len())?;
        for (values, first) in variant.losses.iter().zip(&reference.losses) {
            check.length(&variant.name, values.len(), first.len())?;
            check.finite(&variant.name, values.iter().flatten().copied())?;
        }
    }
    let names = input.variants.iter().map(|variant| &variant.name);
    let rows = Rows::new(names, 0.6);
    let reference_name = markup::literal(&reference.name);
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 24.0 + 5.2 * input.variants.len() as f64),
        title: "What each part is worth".to_owned(),
        caption: format!(
            "Loss on drivers that the networks have not seen ({}-fold cross-validation by driver), minus that of \
             {reference_name} on the same drive: mean over drives with its 95% interval. Right of the line is worse. *n* = \
             {} drives{}; no test.",
            input.folds,
            reference.losses[0].len(),
            input.fewer(),
        ),
        alt: sentences((0..input.losses.len()).filter_map(|loss| input.worst(loss))),
        shows: Shows::Participants,
    };
    let minus = format!("Minus {reference_name}");
    draw(plan, context, |canvas, whole| {
        // The first panel carries the variants' names: the others get the room that it loses.
        let (count, widest, gap) = (input.losses.len() as f64, rows.width(), 12.0);
        let each = (whole.right - whole.left - widest - gap * (count - 1.0)) / count;
        for (index, title) in input.losses.iter().enumerate() {
            let left = whole.left + index as f64 * (each + gap);
            let place = Place {
                left: if index > 0 { left + widest } else { left },
                right: left + widest + each,
                ..whole
            };
            let losses: Vec<f64> = reference.losses[index].iter().flatten().copied().collect();
            let subtitle =
                mean(&losses).map(|mean| format!("{reference_name}: {}", number(mean, 3)));
            let labels = Labels {
                title,
                subtitle: &subtitle.unwrap_or_default(),
                x: &minus,
                ..Labels::default()
            };
            let differences = input.differences(index);
            let x = Scale::over(differences.iter().flatten().flatten().copied().chain([0.0]), 4);
            let y = if index == 0 { rows.axis() } else { rows.unnamed() };
            let mut panel = Panel::open(canvas, place, &labels, (x, y));
            panel.upright(0.0, Pen::new(MUTED, stroke::AXIS).dashed(2.0, 2.0));
            for (row, interval) in differences.into_iter().enumerate() {
                let colour = if row == 0 { GREY } else { INK };
                let (pen, mark) = (Pen::new(colour, stroke::BOX), (2.2, Marker::Circle, colour));
                if let Some(interval) = interval {
                    panel.level_interval(interval, rows.y(row), pen, mark);
                }
            }
        }
    })
}

impl Ablation {
    /// Of each variant from the first, in one loss.
    fn differences(&self, loss: usize) -> Vec<Option<[f64; 3]>> {
        let reference = &self.variants[0].losses[loss];
        let variants = self.variants.iter();
        variants.map(|v| difference(&v.losses[loss], reference)).collect()
    }

    /// The losses that some drives do not have, such as `, 25 of them with following distance (m)`.
    fn fewer(&self) -> String {
        let losses = self.variants[0].losses.iter().zip(&self.losses);
        let fewer = losses.filter(|(drives, _)| drives.contains(&None));
        let clauses = fewer.map(|(drives, title)| {
            format!(", {} of them with {title}", drives.iter().flatten().count())
        });
        clauses.collect()
    }

    /// Which variant is furthest above the first, in words.
    fn worst(&self, loss: usize) -> Option<String> {
        let others = self.differences(loss).into_iter().zip(&self.variants).skip(1);
        let others = others.filter_map(|(interval, variant)| Some((interval?[0], &variant.name)));
        let (by, name) = others.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let (title, first) = (markup::plain(&self.losses[loss]), &self.variants[0].name);
        Some(format!("{title}: {name} is furthest above {first}, by {}.", number(by, 3)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_taken_drive_by_drive() {
        let variant = [Some(2.0), None, Some(5.0)];
        let reference = [Some(1.0), Some(9.0), Some(4.0)];
        for value in difference(&variant, &reference).unwrap() {
            assert!((value - 1.0).abs() < 1e-12);
        }
        assert!(difference(&[None], &[Some(1.0)]).is_none());
    }

    #[test]
    fn a_variant_alone_is_compared_with_nothing() {
        let only = AblationVariant { name: "default".into(), losses: vec![vec![Some(1.0)]] };
        let input = Ablation { losses: vec!["L".into()], variants: vec![only], folds: 5 };
        assert!(matches!(ablation(&input, &Context::real()), Err(ReportError::TooFew { .. })));
    }
}
