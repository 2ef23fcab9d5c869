//! One driver's unseen last third, driven again by the models.

use super::prelude::*;
use super::thin::thinned;

/// Who is at the wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Follower {
    /// The recording itself.
    Recorded,
    /// The network with the driver's own embedding.
    Model,
    /// The network with the mean embedding of the training drivers.
    MeanEmbedding,
    /// The network trained in closed loop, with the driver's own embedding shrunken towards the mean one.
    ClosedLoop,
    /// The same with the mean embedding.
    ClosedLoopMean,
    /// IDM calibrated to this driver.
    Idm,
    /// IDM calibrated to the test rows themselves: no prediction.
    Floor,
    /// A constant time gap, the driver's own mean.
    ConstantTimeGap,
}

impl Follower {
    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::Recorded => "recorded",
            Self::Model => "F, own embedding",
            Self::MeanEmbedding => "F, mean embedding",
            Self::ClosedLoop => "network in closed loop, shrunken",
            Self::ClosedLoopMean => "network in closed loop, mean",
            Self::Idm => "IDM, own",
            Self::Floor => "floor",
            Self::ConstantTimeGap => "constant time gap, own",
        }
    }

    pub(crate) fn colour(self) -> RGBColor {
        match self {
            Self::Recorded => INK,
            Self::Model => PURPLE,
            Self::MeanEmbedding => GREY,
            Self::ClosedLoop | Self::ClosedLoopMean => GREEN,
            Self::Idm => BLUE,
            Self::Floor => MUTED,
            Self::ConstantTimeGap => OCHRE,
        }
    }

    pub(crate) fn marker(self) -> Marker {
        match self {
            Self::Recorded | Self::ClosedLoop | Self::Floor => Marker::Circle,
            Self::Model => Marker::Square,
            Self::MeanEmbedding => Marker::Diamond,
            Self::ClosedLoopMean | Self::ConstantTimeGap => Marker::TriangleDown,
            Self::Idm => Marker::TriangleUp,
        }
    }

    /// The pen of a short line across a driver's row, for what the points are held against.
    pub(crate) fn mark(self) -> Option<Pen> {
        matches!(self, Self::Idm | Self::Floor).then(|| Pen::new(self.colour(), 1.4))
    }

    fn pen(self) -> Pen {
        match self {
            Self::Recorded => Pen::new(self.colour(), 1.3),
            Self::Model | Self::ClosedLoop => Pen::new(self.colour(), stroke::STRONG),
            Self::MeanEmbedding | Self::ClosedLoopMean => {
                Pen::new(self.colour(), 0.8).dashed(1.2, 1.5)
            }
            Self::Idm => Pen::new(self.colour(), 0.8).dashed(4.0, 2.0),
            Self::Floor => Pen::new(self.colour(), 0.8).dashed(1.2, 2.5),
            Self::ConstantTimeGap => Pen::new(self.colour(), 0.8).dashed(2.0, 1.5),
        }
    }
}

/// Gap and speed over the test third.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CarFollowing {
    /// Id of the driver or car.
    pub driver: String,
    /// Name of the recordings.
    pub data_set: String,
    /// Time of each row, in seconds, rising.
    pub time_s: Vec<f64>,
    /// The recording and the models; each as long as `time_s`.
    pub series: Vec<FollowingSeries>,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FollowingSeries {
    /// Who drove.
    pub follower: Follower,
    /// Bumper-to-bumper gap, in metres.
    pub gap_m: Vec<f64>,
    /// Ego speed, in m/s.
    pub speed_mps: Vec<f64>,
}

const NAME: &str = "car-following";
/// Most points of a line.
const MOST_POINTS: usize = 800;

/// Draws gap and speed over time. The figure's name ends in the driver's id.
///
/// # Errors
/// [`ReportError`] if there are fewer than two rows, no series, lengths differ, or a value is not
/// finite.
pub fn car_following(input: &CarFollowing, context: &Context) -> Result<Figure, ReportError> {
    let name = format!("{NAME}-{}", slug(&input.driver));
    let check = Check(&name);
    check.at_least(2, "rows", input.time_s.len())?;
    check.at_least(1, "series", input.series.len())?;
    check.finite("time_s", input.time_s.iter().copied())?;
    for series in &input.series {
        for (field, values) in [("gap_m", &series.gap_m), ("speed_mps", &series.speed_mps)] {
            check.length(field, values.len(), input.time_s.len())?;
            check.finite(field, values.iter().copied())?;
        }
    }
    let first = input.time_s[0];
    let last = input.time_s[input.time_s.len() - 1];
    let plan = Plan {
        name: name.clone(),
        size_mm: (TWO_COLUMNS_MM, 96.0),
        title: format!(
            "Following in closed loop: {}",
            markup::literal(&input.driver)
        ),
        caption: format!(
            "{}, {}: gap and speed over the unseen last third of the drive ({:.0} s). Recorded is \
             only the vehicle ahead; each model starts from the true gap and speed and then drives \
             on its own. *n* = 1 drive; no test.",
            markup::literal(&input.data_set),
            markup::literal(&input.driver),
            last - first
        ),
        alt: alternative(input),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, whole| {
        let keys: Vec<(Key, &str)> = input
            .series
            .iter()
            .map(|series| (Key::Line(series.follower.pen()), series.follower.label()))
            .collect();
        let whole = canvas.legend(whole, &keys);
        let split = whole.top + 0.56 * (whole.bottom - whole.top);
        let upper = Place {
            bottom: split - 4.0,
            ..whole
        };
        let lower = Place {
            top: split,
            ..whole
        };
        for (place, title, x_title, gap) in [
            (upper, "Gap to the vehicle ahead (m)", "", true),
            (
                lower,
                "Speed (m/s)",
                "Time since the start of the test third (s)",
                false,
            ),
        ] {
            let pick = |s: &'_ FollowingSeries| {
                if gap {
                    s.gap_m.clone()
                } else {
                    s.speed_mps.clone()
                }
            };
            let values: Vec<Vec<f64>> = input.series.iter().map(pick).collect();
            let y = Scale::over(
                values.iter().flatten().copied().chain(gap.then_some(0.0)),
                5,
            );
            let x = Scale::between(0.0, last - first, 8);
            let labels = Labels {
                x: x_title,
                y: title,
                numbers: 12.0,
                ..Labels::default()
            };
            let frame = Frame::draw(canvas, place, &labels, x, y);
            for (series, values) in input.series.iter().zip(&values).rev() {
                let times = input.time_s.iter().map(|time| time - first);
                let points: Vec<(f64, f64)> = times.zip(values.iter().copied()).collect();
                let path: Vec<(f64, f64)> = thinned(&points, MOST_POINTS)
                    .into_iter()
                    .map(|(time, value)| frame.at(time, value))
                    .collect();
                canvas.path(&path, series.follower.pen());
            }
        }
    })
}

fn slug(text: &str) -> String {
    let mut out = String::new();
    for sign in text.chars() {
        if sign.is_ascii_alphanumeric() {
            out.push(sign.to_ascii_lowercase());
        } else if !out.is_empty() && !out.ends_with('-') {
            out.push('-');
        }
    }
    let slug = out.trim_end_matches('-');
    if slug.is_empty() {
        "driver".to_owned()
    } else {
        slug.to_owned()
    }
}

fn alternative(input: &CarFollowing) -> String {
    let recorded = input
        .series
        .iter()
        .find(|series| series.follower == Follower::Recorded);
    let mut words = vec![format!("Gap and speed of {} over time.", input.driver)];
    if let Some(recorded) = recorded {
        for series in input
            .series
            .iter()
            .filter(|s| s.follower != Follower::Recorded)
        {
            let squares: f64 = series
                .gap_m
                .iter()
                .zip(&recorded.gap_m)
                .map(|(a, b)| (a - b).powi(2))
                .sum();
            let error = (squares / input.time_s.len() as f64).sqrt();
            words.push(format!(
                "{}: gap off by {error:.1} m (root mean square).",
                series.follower.label()
            ));
        }
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_becomes_a_file_name() {
        assert_eq!(slug("Audi A6 / 2"), "audi-a6-2");
        assert_eq!(slug("../<x>"), "x");
        assert_eq!(slug("😀"), "driver");
    }
}
