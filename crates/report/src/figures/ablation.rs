//! What each part of the model is worth on drivers it has not seen.

use super::fit;
use super::prelude::*;

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

/// One variant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AblationVariant {
    /// Such as `size 2`.
    pub name: String,
    /// For each loss its value on every unseen drive, in the same order for all variants; `None`: that drive has
    /// none.
    pub losses: Vec<Vec<Option<f64>>>,
}

const NAME: &str = "ablation";

/// A variant's loss minus the reference's, drive by drive.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Difference {
    pub(crate) mean: f64,
    /// Half its 95% interval; 0 for a single drive.
    pub(crate) half: f64,
}

impl Difference {
    /// `None` if no drive has a loss in both.
    pub(crate) fn of(variant: &[Option<f64>], reference: &[Option<f64>]) -> Option<Self> {
        let pairs = variant.iter().zip(reference);
        let by_drive: Vec<f64> = pairs.filter_map(|(v, r)| Some((*v)? - (*r)?)).collect();
        let mean = fit::mean(&by_drive)?;
        let n = by_drive.len();
        let half = if n > 1 {
            fit::t_975(n - 1) * fit::standard_deviation(&by_drive) / (n as f64).sqrt()
        } else {
            0.0
        };
        Some(Self { mean, half })
    }
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
    let drives = reference.losses[0].len();
    let mut found = Vec::new();
    for (index, title) in input.losses.iter().enumerate() {
        let worst = input.variants[1..]
            .iter()
            .filter_map(|v| {
                Some((
                    Difference::of(&v.losses[index], &reference.losses[index])?.mean,
                    &v.name,
                ))
            })
            .max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((by, name)) = worst {
            let title = markup::plain(title);
            found.push(format!(
                "{title}: {name} is furthest above {}, by {}.",
                reference.name,
                number(by, 3)
            ));
        }
    }
    let rows = input.variants.len();
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 24.0 + 5.2 * rows as f64),
        title: "What each part is worth".to_owned(),
        caption: format!(
            "Loss on drivers that the networks have not seen ({}-fold cross-validation by driver), minus that of \
             {} on the same drive: mean over drives with its 95% interval. Right of the line is worse. *n* = \
             {drives} drives; no test.",
            input.folds,
            markup::literal(&reference.name)
        ),
        alt: found.join(" "),
        shows: Shows::Participants,
    };
    let difference_from = format!("Minus {}", markup::literal(&reference.name));
    draw(plan, context, |canvas, whole| {
        let last = rows as f64 - 1.0;
        let names: Vec<(f64, String)> = input
            .variants
            .iter()
            .enumerate()
            .map(|(index, v)| (last - index as f64, markup::literal(&v.name)))
            .collect();
        let count = input.losses.len();
        // The first panel carries the variants' names: the others get the room that it loses.
        let named = super::canvas::Look::new(super::theme::size::TICK);
        let widest = names
            .iter()
            .map(|(_, n)| named.width(n))
            .fold(0.0, f64::max);
        let gap = 12.0;
        let each = (whole.right - whole.left - widest - gap * (count as f64 - 1.0)) / count as f64;
        for (index, title) in input.losses.iter().enumerate() {
            let mut place = whole;
            place.left = whole.left + index as f64 * (each + gap);
            if index > 0 {
                place.left += widest;
            }
            place.right = whole.left + widest + index as f64 * (each + gap) + each;
            let differences: Vec<Option<Difference>> = input
                .variants
                .iter()
                .map(|v| Difference::of(&v.losses[index], &reference.losses[index]))
                .collect();
            let ends = differences
                .iter()
                .flatten()
                .flat_map(|d| [d.mean - d.half, d.mean + d.half]);
            let ticks = if index == 0 {
                names.clone()
            } else {
                names.iter().map(|(at, _)| (*at, String::new())).collect()
            };
            let of_reference: Vec<f64> =
                reference.losses[index].iter().flatten().copied().collect();
            let subtitle = fit::mean(&of_reference).map_or_else(String::new, |mean| {
                format!("{}: {}", markup::literal(&reference.name), number(mean, 3))
            });
            let labels = Labels {
                title,
                subtitle: &subtitle,
                x: &difference_from,
                ..Labels::default()
            };
            let x = Scale::over(ends.chain([0.0]), 4);
            let frame = Frame::draw(
                canvas,
                place,
                &labels,
                x,
                Scale::labelled(-0.6, last + 0.6, ticks),
            );
            let zero = frame.x.at(0.0);
            canvas.line(
                (zero, frame.place.bottom),
                (zero, frame.place.top),
                Pen::new(MUTED, stroke::AXIS).dashed(2.0, 2.0),
            );
            for (row, found) in differences.iter().enumerate() {
                let Some(Difference { mean, half }) = found else {
                    continue;
                };
                let y = last - row as f64;
                let colour = if row == 0 { GREY } else { INK };
                canvas.line(
                    frame.at(mean - half, y),
                    frame.at(mean + half, y),
                    Pen::new(colour, stroke::BOX),
                );
                canvas.marker(frame.at(*mean, y), 2.2, Marker::Circle, colour);
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_taken_drive_by_drive() {
        let Difference { mean, half } = Difference::of(
            &[Some(2.0), None, Some(5.0)],
            &[Some(1.0), Some(9.0), Some(4.0)],
        )
        .unwrap();
        assert!((mean - 1.0).abs() < 1e-12 && half.abs() < 1e-12);
        assert!(Difference::of(&[None], &[Some(1.0)]).is_none());
    }

    #[test]
    fn a_variant_alone_is_compared_with_nothing() {
        let only = AblationVariant {
            name: "default".into(),
            losses: vec![vec![Some(1.0)]],
        };
        let input = Ablation {
            losses: vec!["L".into()],
            variants: vec![only],
            folds: 5,
        };
        assert!(matches!(
            ablation(&input, &Context::real()),
            Err(ReportError::TooFew { .. })
        ));
    }
}
