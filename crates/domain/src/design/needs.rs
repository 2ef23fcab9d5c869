//! What a study needs of the computer of whoever takes part, looked at before anybody agrees.

use super::error::{Checked, refuse};
use serde::{Deserialize, Serialize};

/// What somebody drives with.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum InputDevice {
    /// The keys of a computer.
    Keyboard,
    /// A steering wheel with pedals.
    Wheel,
}

impl InputDevice {
    /// As the design has it.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Keyboard => "keyboard",
            Self::Wheel => "wheel",
        }
    }
}

/// The section `[protocol.needs]`: nobody takes part whose computer has less; a browser that draws the road is needed always.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Needs {
    /// Pictures of the road in a second, at least.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 240)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pictures_per_second: Option<f64>,
    /// Width of the window, at least, in pixels as the browser counts them.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 16384)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width_px: Option<f64>,
    /// Height of the window, at least, in pixels as the browser counts them.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 16384)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height_px: Option<f64>,
    /// With what everybody drives; left out, each person chooses.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device: Option<InputDevice>,
}

/// What can be asked for: no browser draws more, and no screen is larger.
const MOST_PICTURES: f64 = 240.0;
const MOST_PX: f64 = 16_384.0;

impl Needs {
    /// `tried` is whether what somebody drives with is tried before the drives.
    pub(super) fn check(&self, tried: bool) -> Checked<()> {
        for (key, least, most, unit) in [
            ("pictures_per_second", self.pictures_per_second, MOST_PICTURES, "pictures a second"),
            ("width_px", self.width_px, MOST_PX, "pixels"),
            ("height_px", self.height_px, MOST_PX, "pixels"),
        ] {
            if let Some(least) = least.filter(|least| !(1.0..=most).contains(least)) {
                let expected = format!("1 to {most} {unit}");
                return refuse(format!("protocol.needs.{key}"), least, expected);
            }
        }
        if self.device == Some(InputDevice::Wheel) && !tried {
            return refuse(
                "protocol.needs.device",
                "wheel",
                "`controls` among `steps`: a wheel is measured there",
            );
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Design;

    fn read(lines: &str) -> Checked<Design> {
        Design::from_toml(&format!(
            "[study]\ntitle = \"x\"\n[[condition]]\nid = \"a\"\n[protocol]\n{lines}"
        ))
    }

    #[test]
    fn a_study_needs_nothing_unless_it_says_so() {
        assert_eq!(read("").unwrap().protocol().needs, None);
        let design = read(
            "needs = { pictures_per_second = 20, width_px = 1280, height_px = 800, device = \"wheel\" }",
        );
        let needs = Needs {
            pictures_per_second: Some(20.0),
            width_px: Some(1280.0),
            height_px: Some(800.0),
            device: Some(InputDevice::Wheel),
        };
        assert_eq!(design.unwrap().protocol().needs, Some(needs));
    }

    #[test]
    fn what_no_computer_has_cannot_be_needed() {
        for (line, words) in [
            ("pictures_per_second = 0", ["pictures_per_second", "1 to 240"]),
            ("pictures_per_second = 241", ["pictures_per_second", "1 to 240"]),
            ("width_px = -1", ["width_px", "1 to 16384 pixels"]),
            ("height_px = nan", ["height_px", "1 to 16384 pixels"]),
            ("device = \"joystick\"", ["joystick", "wheel"]),
            ("hight_px = 800", ["hight_px", "height_px"]),
        ] {
            let told = read(&format!("needs = {{ {line} }}")).unwrap_err();
            let told = told.to_string();
            assert!(words.iter().all(|word| told.contains(word)), "{told}");
        }
        for border in ["pictures_per_second = 1", "pictures_per_second = 240"] {
            assert!(read(&format!("needs = {{ {border} }}")).is_ok(), "{border}");
        }
    }

    #[test]
    fn a_wheel_is_needed_only_where_it_is_measured() {
        let steps = "steps = [\"drive\"]\n";
        let told = read(&format!("{steps}needs = {{ device = \"wheel\" }}"));
        let told = told.unwrap_err().to_string();
        assert!(told.contains("protocol.needs.device") && told.contains("`controls`"), "{told}");
        assert!(read(&format!("{steps}needs = {{ device = \"keyboard\" }}")).is_ok());
    }
}
