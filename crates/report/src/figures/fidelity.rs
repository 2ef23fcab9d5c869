//! How near the car's own drive comes to its driver's, beside how near drivers come to themselves.

use super::prelude::*;

/// Accuracies measure by measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fidelity {
    /// The measures, from top to bottom.
    pub measures: Vec<FidelityRow>,
    /// Drivers, for the caption.
    pub drivers: usize,
    /// Training seeds over which the ranges are taken.
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
    /// The mean of all drivers.
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
    let all = |row: &FidelityRow| -> Vec<f64> {
        [Some(row.car), row.test_retest, row.population]
            .into_iter()
            .flatten()
            .flat_map(|a| [a.low, a.mean, a.high])
            .chain(row.paper)
            .collect()
    };
    for row in &input.measures {
        check.finite(&row.measure, all(row))?;
    }
    let percent = |share: f64| number(100.0 * share, 1);
    let found: Vec<String> = input
        .measures
        .iter()
        .map(|row| {
            let mut words = vec![format!(
                "{}: the car {}%",
                row.measure,
                percent(row.car.mean)
            )];
            if let Some(own) = row.test_retest {
                words.push(format!("the driver’s second drive {}%", percent(own.mean)));
            }
            if let Some(paper) = row.paper {
                words.push(format!("the paper {}%", percent(paper)));
            }
            words.join(", ") + "."
        })
        .collect();
    let rows = input.measures.len();
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (120.0, (54.0 + ROW * rows as f64) / 72.0 * 25.4),
        title: "As near to the driver as the driver".to_owned(),
        caption: format!(
            "Accuracy, 1 − |AV − driver| / driver, mean over drivers. Point: mean over {} training seeds; line: \
             their range. The driver’s own second drive is the most that can be asked; the mean of all drivers is \
             what needs no model. *n* = {} drivers; no test.",
            input.seeds, input.drivers
        ),
        alt: found.join(" "),
        shows: Shows::Participants,
    };
    let looks = [
        (Marker::Square, PURPLE, "Car"),
        (Marker::Circle, INK, "own second drive"),
        (Marker::TriangleDown, GREY, "mean of all drivers"),
        (Marker::Diamond, OCHRE, "paper"),
    ];
    draw(plan, context, |canvas, mut place| {
        let keys = looks.map(|(marker, colour, label)| (Key::Point(marker, colour), label));
        canvas.legend_row((place.left, place.top + 4.0), &keys);
        place.top += cap_height(size::TICK) + 6.0;
        let lowest = input.measures.iter().flat_map(all).fold(0.9, f64::min);
        let x = Scale::between(100.0 * lowest - 3.0, 100.0, 6);
        let last = rows as f64 - 1.0;
        let ticks = input
            .measures
            .iter()
            .enumerate()
            .map(|(index, row)| (last - index as f64, markup::literal(&row.measure)))
            .collect();
        let labels = Labels {
            x: "Accuracy (%)",
            ..Labels::default()
        };
        let frame = Frame::draw(
            canvas,
            place,
            &labels,
            x,
            Scale::labelled(-0.6, last + 0.6, ticks),
        );
        for (index, row) in input.measures.iter().enumerate() {
            let y = last - index as f64;
            canvas.line(
                (frame.place.left, frame.y.at(y)),
                (frame.place.right, frame.y.at(y)),
                Pen::new(GRID, stroke::THIN),
            );
            let alone = |share: f64| Accuracy {
                mean: share,
                low: share,
                high: share,
            };
            let series = [
                Some(row.car),
                row.test_retest,
                row.population,
                row.paper.map(alone),
            ];
            // Each series has its own height, so that none hides another.
            for (place, (accuracy, (marker, colour, _))) in
                series.into_iter().zip(looks).enumerate()
            {
                let Some(accuracy) = accuracy else { continue };
                let y = y + 0.27 - 0.18 * place as f64;
                canvas.line(
                    frame.at(100.0 * accuracy.low, y),
                    frame.at(100.0 * accuracy.high, y),
                    Pen::new(colour, stroke::STRONG),
                );
                canvas.marker(frame.at(100.0 * accuracy.mean, y), 2.2, marker, colour);
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_accuracy_that_is_not_finite_is_refused() {
        let row = FidelityRow {
            measure: "Mean velocity".into(),
            car: Accuracy {
                mean: f64::NAN,
                low: 0.9,
                high: 1.0,
            },
            test_retest: None,
            population: None,
            paper: None,
        };
        let input = Fidelity {
            measures: vec![row],
            drivers: 24,
            seeds: 5,
        };
        assert!(matches!(
            fidelity(&input, &Context::real()),
            Err(ReportError::NotFinite { .. })
        ));
    }
}
