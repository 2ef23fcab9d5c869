//! How the conditions of a study look: label, colour and marker come from its design.

use super::legend::Key;
use super::style::{Looks, colour};
use super::theme::{BLUE, GREEN, INK, MUTED, Marker, OCHRE, ORANGE, PURPLE, mixed};
use maveric_domain::{ConditionId, Design, design::Condition};
use plotters::style::RGBColor;
use serde::{Deserialize, Serialize};

/// How a condition looks on every figure.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ConditionLook {
    /// Which condition.
    pub id: ConditionId,
    /// What pages and figures call it.
    pub label: String,
    /// Red, green and blue.
    pub colour: [u8; 3],
    pub(crate) marker: Marker,
}

impl ConditionLook {
    /// The same as a style wants it.
    pub(super) fn dressed(self, other: &Looks) -> Self {
        let colour = other.color.as_deref().and_then(colour);
        Self {
            label: other.label.clone().unwrap_or(self.label),
            colour: colour.unwrap_or(self.colour),
            marker: other.marker.unwrap_or(self.marker),
            ..self
        }
    }

    /// The baseline and the conditions of a design, in its order: their own colours, else along a scale from blue over purple to orange
    /// by their place on the dial (by their order where nothing turns a dial), other cars beside it.
    pub fn of(design: &Design) -> Vec<Self> {
        let conditions = design.conditions();
        let furthest =
            conditions.iter().filter_map(Condition::dial).fold(0.0, |far: f64, d| far.max(d.abs()));
        let turned = conditions.iter().any(|c| c.dial().is_some());
        let mut beside = [GREEN, OCHRE, MUTED].into_iter().cycle();
        let mut looks = Vec::new();
        if let Some(baseline) = design.baseline().filter(|b| design.condition(b.id).is_none()) {
            looks.push(Self {
                id: baseline.id,
                label: baseline.label.clone(),
                colour: channels(INK),
                marker: Marker::Circle,
            });
        }
        let shapes = [
            Marker::Square,
            Marker::TriangleUp,
            Marker::TriangleDown,
            Marker::Diamond,
            Marker::Star,
            Marker::Plus,
            Marker::TriangleLeft,
            Marker::TriangleRight,
            Marker::Cross,
            Marker::Hexagon,
        ];
        for (condition, marker) in conditions.iter().zip(shapes.into_iter().cycle()) {
            let share = match condition.dial() {
                Some(_) if furthest <= 0.0 => Some(0.0),
                Some(dial) => Some(dial / furthest),
                None if turned => None,
                None if conditions.len() == 1 => Some(0.0),
                None => Some(2.0 * condition.place as f64 / (conditions.len() - 1) as f64 - 1.0),
            };
            let by_default = share.map_or_else(|| beside.next().unwrap_or(MUTED), along);
            looks.push(Self {
                id: condition.id,
                label: condition.label.clone(),
                colour: condition.color.map_or(channels(by_default), |c| c.0),
                marker,
            });
        }
        looks
    }

    /// One that no design describes: its id, in grey.
    pub(crate) fn unknown(id: ConditionId) -> Self {
        Self {
            id,
            label: crate::markup::capital(id.as_str()),
            colour: channels(MUTED),
            marker: Marker::Circle,
        }
    }

    pub(crate) fn rgb(&self) -> RGBColor {
        let [r, g, b] = self.colour;
        RGBColor(r, g, b)
    }

    /// What stands for it in a legend.
    pub(crate) fn key(&self) -> Key {
        Key::Point(self.marker, self.rgb())
    }

    /// The label with marks made harmless, for a caption.
    pub(crate) fn words(&self) -> String {
        crate::markup::literal(&self.label)
    }
}

fn channels(colour: RGBColor) -> [u8; 3] {
    [colour.0, colour.1, colour.2]
}

/// A place between -1 (blue) and 1 (orange).
fn along(share: f64) -> RGBColor {
    let end = if share < 0.0 { BLUE } else { ORANGE };
    mixed(PURPLE, end, share.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looks(text: &str) -> Vec<ConditionLook> {
        ConditionLook::of(&Design::from_toml(text).unwrap())
    }

    #[test]
    fn conditions_without_a_colour_lie_along_the_dial_and_other_cars_beside_it() {
        let found = looks(
            r##"
            [study]
            title = "t"
            [people]
            learn = { study = "1" }
            [style]
            score = "adb.total"
            [baseline]
            id = "own"
            [[condition]]
            id = "calm"
            car = { dial = -10 }
            [[condition]]
            id = "mine"
            car = { dial = 0 }
            [[condition]]
            id = "mean"
            label = "Average driver"
            car = { mean = true }
            color = "#102030"
            [[condition]]
            id = "other"
            car = { across = true }
            "##,
        );
        let colours: Vec<[u8; 3]> = found.iter().map(|l| l.colour).collect();
        assert_eq!(colours, [INK, BLUE, PURPLE, RGBColor(0x10, 0x20, 0x30), OCHRE].map(channels));
    }

    #[test]
    fn ten_conditions_stay_apart_by_shape_and_by_colour() {
        let one = |i: usize| format!("[[condition]]\nid = \"c{i}\"\n");
        let conditions = (0..10).map(one).collect::<Vec<_>>().concat();
        let found = looks(&format!("[study]\ntitle = \"t\"\n{conditions}"));
        for (i, a) in found.iter().enumerate() {
            for b in &found[..i] {
                assert!(a.marker != b.marker && a.colour != b.colour, "{} {}", a.id, b.id);
            }
        }
    }

    #[test]
    fn conditions_that_were_only_recorded_go_from_blue_to_orange() {
        let found = looks(
            "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n[[condition]]\nid = \"b\"\n[[condition]]\nid = \"c\"\n",
        );
        let colours: Vec<[u8; 3]> = found.iter().map(|l| l.colour).collect();
        assert_eq!(colours, [BLUE, PURPLE, ORANGE].map(channels));
    }
}
