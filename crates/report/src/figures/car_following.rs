//! One driver's unseen last third, driven again by the models.

use super::prelude::*;

/// Who is at the wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Follower {
    /// The recording itself.
    Recorded,
    /// IDM calibrated to the other people.
    IdmPopulation,
    /// The same with the driver's own time gap.
    IdmOwnTimeGap,
    /// IDM calibrated to this driver.
    Idm,
}

impl Follower {
    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::Recorded => "recorded",
            Self::IdmPopulation => "IDM, population",
            Self::IdmOwnTimeGap => "IDM, own time gap",
            Self::Idm => "IDM, own",
        }
    }

    pub(crate) fn colour(self) -> RGBColor {
        match self {
            Self::Recorded => INK,
            Self::IdmPopulation => GREY,
            Self::IdmOwnTimeGap => GREEN,
            Self::Idm => BLUE,
        }
    }

    pub(crate) fn marker(self) -> Marker {
        match self {
            Self::Recorded | Self::IdmOwnTimeGap => Marker::Circle,
            Self::IdmPopulation => Marker::Diamond,
            Self::Idm => Marker::TriangleUp,
        }
    }

    /// The pen of a short line across a driver's row, for what the points are held against.
    pub(crate) fn mark(self) -> Option<Pen> {
        (self == Self::IdmPopulation).then(|| Pen::new(self.colour(), 1.4))
    }

    /// What stands for it in a legend of marks, and its name.
    pub(crate) fn key(self) -> (Key, &'static str) {
        let point = Key::Point(self.marker(), self.colour());
        (self.mark().map_or(point, Key::Line), self.label())
    }

    fn pen(self) -> Pen {
        match self {
            // Dark and thick beside the strong green: told apart without colour.
            Self::Recorded => Pen::new(self.colour(), 1.8),
            Self::IdmOwnTimeGap => Pen::new(self.colour(), stroke::STRONG),
            Self::IdmPopulation => Pen::new(self.colour(), 0.8).dashed(1.2, 1.5),
            Self::Idm => Pen::new(self.colour(), 0.8).dashed(4.0, 2.0),
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
    let (first, last) = (input.time_s[0], input.time_s[input.time_s.len() - 1]);
    let driver = markup::literal(&input.driver);
    let plan = Plan {
        name: name.clone(),
        size_mm: (TWO_COLUMNS_MM, 96.0),
        title: format!("Following in closed loop: {driver}"),
        caption: format!(
            "{}, {driver}: gap and speed over the unseen last third of the drive ({:.0} s). Recorded is \
             only the vehicle ahead; each model starts from the true gap and speed and then drives \
             on its own. *n* = 1 drive; no test.",
            markup::literal(&input.data_set),
            last - first
        ),
        alt: alternative(input),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, whole| {
        let keys = input.series.iter().map(|s| s.follower);
        let keys: Vec<(Key, &str)> = keys.map(|f| (Key::Line(f.pen()), f.label())).collect();
        let whole = canvas.legend(whole, &keys);
        let split = whole.top + 0.56 * (whole.bottom - whole.top);
        let upper = Place { bottom: split - 4.0, ..whole };
        let lower = Place { top: split, ..whole };
        let gap = (upper, "Gap to the vehicle ahead (m)", "");
        let since = "Time since the start of the test third (s)";
        let speed = (lower, "Speed (m/s)", since);
        for (place, y_title, x_title) in [gap, speed] {
            let of_gap = x_title.is_empty();
            let pick = |s: &'_ FollowingSeries| -> Vec<f64> {
                if of_gap { &s.gap_m } else { &s.speed_mps }.clone()
            };
            let series: Vec<Vec<f64>> = input.series.iter().map(pick).collect();
            let values = series.iter().flatten().copied();
            let y = Scale::over(values.chain(of_gap.then_some(0.0)), 5);
            let labels = Labels { x: x_title, y: y_title, numbers: 12.0, ..Labels::default() };
            let x = Scale::between(0.0, last - first, 8);
            let mut panel = Panel::open(canvas, place, &labels, (x, y));
            for (run, values) in input.series.iter().zip(series).rev() {
                let times = input.time_s.iter().map(|time| time - first);
                let points: Vec<(f64, f64)> = times.zip(values).collect();
                panel.thin_line(&points, MOST_POINTS, run.follower.pen());
            }
        }
    })
}

fn slug(text: &str) -> String {
    let words = text.split(|sign: char| !sign.is_ascii_alphanumeric());
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    match words[..] {
        [] => "driver".to_owned(),
        _ => words.join("-").to_ascii_lowercase(),
    }
}

fn alternative(input: &CarFollowing) -> String {
    let runs = |recorded| {
        let runs = input.series.iter();
        runs.filter(move |run| (run.follower == Follower::Recorded) == recorded)
    };
    let first = format!("Gap and speed of {} over time.", input.driver);
    let errors = runs(true).take(1).flat_map(|recorded| {
        runs(false).map(|run| {
            let pairs = run.gap_m.iter().zip(&recorded.gap_m);
            let squares: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
            let error = (squares / input.time_s.len() as f64).sqrt();
            let label = run.follower.label();
            format!("{label}: gap off by {error:.1} m (root mean square).")
        })
    });
    sentences([first].into_iter().chain(errors))
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
