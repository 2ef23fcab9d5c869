//! How near the car's own drive comes to its driver's, beside how near drivers come to themselves.

use super::prelude::*;

/// Accuracies measure by measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fidelity {
    /// The measures, from top to bottom.
    pub measures: Vec<FidelityRow>,
    /// Drivers, for the caption.
    pub drivers: usize,
    /// Trained models over which the ranges are taken, each of another training seed.
    pub seeds: usize,
}

/// One measure: accuracies as shares, 1 is the same.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FidelityRow {
    /// Such as `Mean velocity`.
    pub measure: String,
    /// The car's own drive as that driver.
    pub car: Accuracy,
    /// The driver's own second drive.
    pub test_retest: Option<Accuracy>,
    /// The mean of the drivers learned from.
    pub population: Option<Accuracy>,
    /// What the paper printed.
    pub paper: Option<f64>,
}

/// Mean over seeds, with the lowest and the highest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Mean over seeds.
    pub mean: f64,
    /// Lowest of a seed.
    pub low: f64,
    /// Highest of a seed.
    pub high: f64,
}

const NAME: &str = "fidelity";
const ROW: f64 = 17.0;

/// Draws a row a measure: the car, test-retest, the population mean, the paper's figure.
///
/// # Errors
/// [`ReportError`] if there is no measure or a value is not finite.
///
/// # Source
/// Method, section 9.2: 1 − |AV − driver| / driver, mean over drivers.
pub fn fidelity(input: &Fidelity, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "measures", input.measures.len())?;
    for row in &input.measures {
        check.finite(&row.measure, row.intervals().into_iter().flatten().flatten())?;
    }
    let count = input.measures.len() as f64;
    let points = match input.seeds {
        1 => "one trained model".to_owned(),
        seeds => format!("mean over {seeds} training seeds; line: their range"),
    };
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (120.0, (54.0 + ROW * count) / 72.0 * 25.4),
        title: "As near to the driver as the driver".to_owned(),
        caption: format!(
            "Accuracy, 1 − |AV − driver| / driver, mean over drivers. Point: {points}. The driver’s own second drive \
             is the most that can be asked; the mean of the drivers learned from is what needs no model. *n* = {} \
             drivers; no test.",
            input.drivers
        ),
        alt: sentences(input.measures.iter().map(FidelityRow::words)),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, place| {
        let keys = LOOKS.map(|(marker, colour, label)| (Key::Point(marker, colour), label));
        let place = canvas.legend(place, &keys);
        let values = input.measures.iter().flat_map(FidelityRow::intervals);
        let lowest = values.flatten().flatten().fold(90.0, f64::min);
        let rows = Rows::new(input.measures.iter().map(|row| &row.measure), 0.6);
        let labels = Labels { x: "Accuracy (%)", ..Labels::default() };
        let scales = (Scale::between(lowest - 3.0, 100.0, 6), rows.axis());
        let mut panel = Panel::open(canvas, place, &labels, scales);
        for (index, row) in input.measures.iter().enumerate() {
            let y = rows.y(index);
            panel.level(y, Pen::new(GRID, stroke::THIN));
            // Each series has its own height, so that none hides another.
            for (place, (interval, (marker, colour, _))) in
                row.intervals().into_iter().zip(LOOKS).enumerate()
            {
                let y = y + 0.27 - 0.18 * place as f64;
                let pen = Pen::new(colour, stroke::STRONG);
                if let Some(interval) = interval {
                    panel.level_interval(interval, y, pen, (2.2, marker, colour));
                }
            }
        }
    })
}

/// The series in the order of [`FidelityRow::intervals`].
const LOOKS: [(Marker, RGBColor, &str); 4] = [
    (Marker::Square, PURPLE, "Car"),
    (Marker::Circle, INK, "own second drive"),
    (Marker::TriangleDown, GREY, "training mean"),
    (Marker::Diamond, OCHRE, "paper"),
];

impl FidelityRow {
    /// Mean, lowest and highest of each series, in per cent.
    fn intervals(&self) -> [Option<[f64; 3]>; 4] {
        let accuracy = |a: Accuracy| [a.mean, a.low, a.high];
        let shares = [Some(self.car), self.test_retest, self.population];
        let [car, own, all] = shares.map(|share| share.map(accuracy));
        let paper = self.paper.map(|share| [share; 3]);
        [car, own, all, paper].map(|series| series.map(|ends| ends.map(|share| 100.0 * share)))
    }

    fn words(&self) -> String {
        let [car, own, all, paper] = self.intervals();
        let series = [
            ("the car", car),
            ("the driver’s second drive", own),
            ("the training mean", all),
            ("the paper", paper),
        ];
        let words =
            series.map(|(name, s)| s.map(|[mean, ..]| format!("{name} {}%", number(mean, 1))));
        let words: Vec<String> = words.into_iter().flatten().collect();
        format!("{}: {}.", self.measure, words.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_named_only_where_there_are_several_models() {
        let caption = |seeds| {
            let share = |mean| Accuracy { mean, low: mean, high: mean };
            let row = FidelityRow {
                measure: "Mean velocity".into(),
                car: share(0.9),
                test_retest: None,
                population: None,
                paper: None,
            };
            let input = Fidelity { measures: vec![row], drivers: 24, seeds };
            fidelity(&input, &Context::real()).unwrap().caption
        };
        assert!(caption(5).contains("mean over 5 training seeds; line: their range"));
        assert!(caption(1).contains("one trained model") && !caption(1).contains("range"));
    }

    #[test]
    fn an_accuracy_that_is_not_finite_is_refused() {
        let row = FidelityRow {
            measure: "Mean velocity".into(),
            car: Accuracy { mean: f64::NAN, low: 0.9, high: 1.0 },
            test_retest: None,
            population: None,
            paper: None,
        };
        let input = Fidelity { measures: vec![row], drivers: 24, seeds: 5 };
        assert!(matches!(fidelity(&input, &Context::real()), Err(ReportError::NotFinite { .. })));
    }
}
