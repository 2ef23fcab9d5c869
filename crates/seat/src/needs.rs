//! What a study needs of a computer, as the page looks for it before anybody agrees.

use maveric_domain::design::{InputDevice, Needs};
use serde::{Deserialize, Serialize};

/// One thing that is needed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum Need {
    /// A browser that draws the road.
    Webgl,
    /// How often a second the browser draws the road.
    PicturesPerSecond {
        least: f64,
    },
    WidthPx {
        /// At least so many pixels.
        least: f64,
    },
    HeightPx {
        /// At least so many pixels.
        least: f64,
    },
    Device {
        device: InputDevice,
    },
}

impl Need {
    /// All that a study needs, in the order in which it is looked for: what draws before how well it does.
    pub(crate) fn of_study(needs: &Needs) -> Vec<Self> {
        let some = [
            Some(Self::Webgl),
            needs.device.map(|device| Self::Device { device }),
            needs.width_px.map(|least| Self::WidthPx { least }),
            needs.height_px.map(|least| Self::HeightPx { least }),
            needs.pictures_per_second.map(|least| Self::PicturesPerSecond { least }),
        ];
        some.into_iter().flatten().collect()
    }

    /// As it is counted whom it held back.
    pub(crate) fn rule(self) -> String {
        match self {
            Self::Webgl => "needs.webgl".to_owned(),
            Self::PicturesPerSecond { least } => format!("needs.pictures_per_second >= {least}"),
            Self::WidthPx { least } => format!("needs.width_px >= {least}"),
            Self::HeightPx { least } => format!("needs.height_px >= {least}"),
            Self::Device { device } => format!("needs.device = {}", device.as_str()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_browser_that_draws_is_needed_always_and_the_rest_as_the_study_says() {
        let rules = |needs: &Needs| -> Vec<String> {
            let needs = Need::of_study(needs);
            needs.into_iter().map(Need::rule).collect()
        };
        assert_eq!(rules(&Needs::default()), ["needs.webgl"]);
        let needs = Needs {
            pictures_per_second: Some(20.0),
            width_px: Some(1280.0),
            height_px: Some(800.0),
            device: Some(InputDevice::Wheel),
        };
        assert_eq!(
            rules(&needs),
            [
                "needs.webgl",
                "needs.device = wheel",
                "needs.width_px >= 1280",
                "needs.height_px >= 800",
                "needs.pictures_per_second >= 20"
            ]
        );
    }
}
