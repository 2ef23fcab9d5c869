//! How the losses fell while training.

use super::prelude::*;

/// The terms of the loss, epoch by epoch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrainingCurves {
    /// One panel a term.
    pub terms: Vec<LossTerm>,
    /// Training drives, for the caption.
    pub drives: usize,
}

/// A term of the loss, over the epochs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LossTerm {
    /// Such as `*L*_{1} following distance`; with marks.
    pub title: String,
    /// Value after each epoch, from epoch 1.
    pub train: Vec<f64>,
    /// The same on rows kept back; as long as `train`, or empty.
    pub validation: Vec<f64>,
}

const NAME: &str = "training-curves";

/// Draws each term against the epoch; logarithmic where a positive term falls more than tenfold.
///
/// # Errors
/// [`ReportError`] if there is no term, a term has no epoch, lengths differ, or a value is not
/// finite.
pub fn training_curves(input: &TrainingCurves, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "terms", input.terms.len())?;
    for term in &input.terms {
        let (train, kept) = (&term.train, &term.validation);
        check.at_least(1, "epochs", train.len())?;
        check.finite(&term.title, train.iter().chain(kept).copied())?;
        if !kept.is_empty() {
            check.length("the validation curve", kept.len(), train.len())?;
        }
    }
    let grid = Grid::limited(input.terms.len(), 3, (12.0, 9.0));
    let validated = input.terms.iter().any(|term| !term.validation.is_empty());
    let epochs = input.terms.iter().map(|term| term.train.len()).max();
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 44.0 * grid.rows() + 6.0),
        title: "Training".to_owned(),
        caption: format!(
            "Each term of the loss by epoch, unweighted, on standardised targets, over {} training \
             drives and {} epochs; no test.{}",
            input.drives,
            epochs.unwrap_or(0),
            if validated { " Dashed: the last part of every drive, not learned from." } else { "" }
        ),
        alt: sentences(input.terms.iter().map(LossTerm::course)),
        shows: Shows::Participants,
    };
    let solid = Pen::new(INK, stroke::STRONG);
    let dashed = Pen::new(GREY, stroke::STRONG).dashed(3.0, 2.0);
    let keys = [
        (Key::Line(solid), "rows learned from"),
        (Key::Line(dashed), "last part of each drive, kept back"),
    ];
    let keys = if validated { &keys[..] } else { &[] };
    draw_panels(plan, context, grid, keys, |canvas, index, place| {
        let term = &input.terms[index];
        let values = || term.train.iter().chain(&term.validation).copied();
        let (low, high) = extent(values());
        let y = if low > 0.0 && high / low > 10.0 {
            Scale::log_over(values())
        } else {
            Scale::over(values(), 4)
        };
        let x = Scale::between(0.0, term.train.len() as f64, 4);
        let labels = Labels { title: &term.title, x: "Epoch", y: "Loss", ..Labels::default() };
        let mut panel = Panel::open(canvas, place, &labels, (x, y));
        for (curve, pen) in [(&term.validation, dashed), (&term.train, solid)] {
            let epochs = (1..=curve.len()).map(|epoch| epoch as f64);
            panel.line(epochs.zip(curve.iter().copied()), pen);
        }
    })
}

impl LossTerm {
    /// From where to where it went, in words.
    fn course(&self) -> String {
        let name = markup::plain(&self.title);
        let (first, last) = (self.train[0], self.train[self.train.len() - 1]);
        let kept = self.validation.iter().copied().enumerate();
        let least = kept.min_by(|a, b| a.1.total_cmp(&b.1));
        let kept = least.zip(self.validation.last()).map_or_else(String::new, |((at, least), end)| {
            format!(" On what was kept back it is least after epoch {} ({least:.3}) and ends at {end:.3}.", at + 1)
        });
        format!("{name} goes from {first:.3} to {last:.3} on what is learned from.{kept}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loss_that_rises_on_what_was_kept_back_is_told_to_rise() {
        let term = LossTerm {
            title: "Following distance".into(),
            train: vec![1.0, 0.5, 0.25],
            validation: vec![0.9, 0.62, 1.02],
        };
        let input = TrainingCurves { terms: vec![term], drives: 3 };
        let alt = training_curves(&input, &Context::real()).unwrap().alt;
        assert_eq!(
            alt,
            "Following distance goes from 1.000 to 0.250 on what is learned from. On what was kept back it is least after epoch 2 \
             (0.620) and ends at 1.020."
        );
    }

    #[test]
    fn a_validation_curve_of_another_length_is_refused() {
        let term = LossTerm { title: "L".into(), train: vec![1.0, 0.5], validation: vec![1.0] };
        let refused =
            training_curves(&TrainingCurves { terms: vec![term], drives: 3 }, &Context::real());
        assert!(matches!(refused, Err(ReportError::LengthMismatch { .. })));
    }
}
