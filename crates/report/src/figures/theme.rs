//! One look for all figures: colours, sizes, widths.

use plotters::style::RGBColor;
use serde::{Deserialize, Serialize};

/// Width of a one-column figure, in millimetres.
pub(crate) const ONE_COLUMN_MM: f64 = 85.0;
/// Width of a two-column figure, in millimetres.
pub(crate) const TWO_COLUMNS_MM: f64 = 180.0;

/// Text and the participant's own drive.
pub(crate) const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
/// Secondary text.
pub(crate) const MUTED: RGBColor = RGBColor(0x5c, 0x5c, 0x5c);
/// A line that is there for orientation, and baselines to compare with.
pub(crate) const GREY: RGBColor = RGBColor(0x8c, 0x8c, 0x8c);
/// Grid lines.
pub(crate) const GRID: RGBColor = RGBColor(0xe6, 0xe6, 0xe6);
/// The ground of boxes in drawings.
pub(crate) const PALE: RGBColor = RGBColor(0xf4, 0xf4, 0xf4);
/// The ground.
pub(crate) const PAPER: RGBColor = RGBColor(0xff, 0xff, 0xff);
/// A second baseline.
pub(crate) const OCHRE: RGBColor = RGBColor(0xa8, 0x6a, 0x14);

/// Text sizes, in points.
pub(crate) mod size {
    /// A figure's or panel's title.
    pub(crate) const TITLE: f64 = 9.0;
    /// The test below it.
    pub(crate) const SUBTITLE: f64 = 7.0;
    /// Title of an axis.
    pub(crate) const AXIS: f64 = 7.5;
    /// Numbers at an axis, labels.
    pub(crate) const TICK: f64 = 7.0;
    /// The smallest: brackets, notes in the drawing.
    pub(crate) const SMALL: f64 = 6.5;
}

/// Line widths and radii, in points.
pub(crate) mod stroke {
    /// Axis lines.
    pub(crate) const AXIS: f64 = 0.5;
    /// Grid lines and participants' lines.
    pub(crate) const THIN: f64 = 0.4;
    /// Outline of a violin, a box in a drawing.
    pub(crate) const OUTLINE: f64 = 0.6;
    /// The box of a box plot.
    pub(crate) const BOX: f64 = 0.8;
    /// Means, fits, series.
    pub(crate) const STRONG: f64 = 1.0;
    /// Radius of a point.
    pub(crate) const POINT: f64 = 1.3;
}

/// Four colours; no two, nor one of them and [`INK`], are closer than 12 (Oklab × 100), for normal and
/// for colour-blind eyes.
pub(crate) const PURPLE: RGBColor = RGBColor(0x88, 0x2e, 0x72);
/// The second.
pub(crate) const ORANGE: RGBColor = RGBColor(0xd5, 0x5e, 0x00);
/// The third.
pub(crate) const BLUE: RGBColor = RGBColor(0x00, 0x5a, 0xb5);
/// The fourth.
pub(crate) const GREEN: RGBColor = RGBColor(0x0f, 0x9d, 0x7a);

/// The shape that goes with a colour, so that colour is never alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Marker {
    Circle,
    Square,
    TriangleUp,
    TriangleDown,
    Diamond,
    Star,
    Plus,
    TriangleLeft,
    TriangleRight,
    Cross,
    Hexagon,
}

impl Marker {
    /// Corners round the middle, as angle in degrees (0 to the right, 90 down) and distance for a radius of 1; none of a circle.
    pub(crate) fn corners(self) -> Vec<(f64, f64)> {
        let even = |first: f64, count: usize, far: f64| -> Vec<(f64, f64)> {
            (0..count).map(|k| (first + 360.0 * k as f64 / count as f64, far)).collect()
        };
        // Two corners an arm, one between two arms.
        let arms = |turn: f64| -> Vec<(f64, f64)> {
            let arm = |k: usize| {
                let middle = turn + 90.0 * k as f64;
                [(middle - 18.0, 1.3), (middle + 18.0, 1.3), (middle + 45.0, 0.57)]
            };
            (0..4).flat_map(arm).collect()
        };
        match self {
            Self::Circle => Vec::new(),
            Self::Square => even(45.0, 4, 1.27),
            Self::Diamond => even(0.0, 4, 1.25),
            Self::TriangleUp => even(-90.0, 3, 1.3),
            Self::TriangleDown => even(90.0, 3, 1.3),
            Self::TriangleLeft => even(180.0, 3, 1.3),
            Self::TriangleRight => even(0.0, 3, 1.3),
            Self::Hexagon => even(-90.0, 6, 1.15),
            Self::Plus => arms(0.0),
            Self::Cross => arms(45.0),
            Self::Star => (0..10)
                .map(|k| (-90.0 + 36.0 * f64::from(k), if k % 2 == 0 { 1.5 } else { 0.65 }))
                .collect(),
        }
    }

    /// Its name.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Circle => "circle",
            Self::Square => "square",
            Self::TriangleUp => "triangle up",
            Self::TriangleDown => "triangle down",
            Self::Diamond => "diamond",
            Self::Star => "star",
            Self::Plus => "plus",
            Self::TriangleLeft => "triangle left",
            Self::TriangleRight => "triangle right",
            Self::Cross => "cross",
            Self::Hexagon => "hexagon",
        }
    }
}

/// Marker and colour of the group or condition at a place in a list; the sixth begins anew.
pub(crate) fn nth_look(place: usize) -> (Marker, RGBColor) {
    const LOOKS: [(Marker, RGBColor); 5] = [
        (Marker::TriangleDown, BLUE),
        (Marker::TriangleUp, ORANGE),
        (Marker::Square, PURPLE),
        (Marker::Diamond, GREEN),
        (Marker::Circle, OCHRE),
    ];
    LOOKS[place % LOOKS.len()]
}

/// Colours of the dark page: what each drawn colour turns into there.
pub(crate) const DARK: [(RGBColor, &str); 13] = [
    (INK, "#ffffff"),
    (PURPLE, "#b565a7"),
    (ORANGE, "#ff8a3d"),
    (BLUE, "#5aa9ff"),
    (GREEN, "#7fe0c4"),
    (MUTED, "#b4b4b4"),
    (GREY, "#9a9a9a"),
    (GRID, "#3a3a3a"),
    (PALE, "#262626"),
    (PAPER, "#171717"),
    (OCHRE, "#d9a45b"),
    (ROAD, "#2e2e2e"),
    (LANE_LINE, "#8a8a8a"),
];

/// Tarmac, pale so that cars and labels stand out.
pub(crate) const ROAD: RGBColor = RGBColor(0xec, 0xec, 0xea);
/// Lane markings.
pub(crate) const LANE_LINE: RGBColor = RGBColor(0xb0, 0xb0, 0xac);

const VIRIDIS: [RGBColor; 10] = [
    RGBColor(0x44, 0x01, 0x54),
    RGBColor(0x48, 0x28, 0x78),
    RGBColor(0x3e, 0x49, 0x89),
    RGBColor(0x31, 0x68, 0x8e),
    RGBColor(0x26, 0x82, 0x8e),
    RGBColor(0x1f, 0x9e, 0x89),
    RGBColor(0x35, 0xb7, 0x79),
    RGBColor(0x6e, 0xce, 0x58),
    RGBColor(0xb5, 0xde, 0x2b),
    RGBColor(0xfd, 0xe7, 0x25),
];

/// The viridis scale at `share` in 0..=1 (clamped), in 40 steps.
pub(crate) fn viridis(share: f64) -> RGBColor {
    let stepped = (share.clamp(0.0, 1.0) * 39.0).round() / 39.0;
    let place = stepped * (VIRIDIS.len() - 1) as f64;
    let low = (place.floor() as usize).min(VIRIDIS.len() - 2);
    mixed(VIRIDIS[low], VIRIDIS[low + 1], place - low as f64)
}

/// `#rrggbb` in lower case, as figures and the dark page's rules write it.
pub(crate) fn hex(colour: RGBColor) -> String {
    format!("#{:02x}{:02x}{:02x}", colour.0, colour.1, colour.2)
}

/// `share` of the way from one colour to another.
pub(crate) fn mixed(from: RGBColor, to: RGBColor, share: f64) -> RGBColor {
    let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
    RGBColor(mix(from.0, to.0), mix(from.1, to.1), mix(from.2, to.2))
}

/// What a colour turns into on the dark page: as the list says, else so much lighter that it stands out there.
pub(crate) fn on_dark(colour: RGBColor) -> String {
    if let Some((_, dark)) = DARK.iter().find(|(light, _)| *light == colour) {
        return (*dark).to_owned();
    }
    let mut lighter = colour;
    // A contrast of 4.5 with the dark ground, whose luminance is 0.0086.
    while luminance(lighter) < 0.214 {
        lighter = mixed(lighter, PAPER, 0.1);
    }
    hex(lighter)
}

fn luminance(colour: RGBColor) -> f64 {
    let channel = |value: u8| {
        let share = f64::from(value) / 255.0;
        if share <= 0.040_45 { share / 12.92 } else { libm::pow((share + 0.055) / 1.055, 2.4) }
    };
    0.2126 * channel(colour.0) + 0.7152 * channel(colour.1) + 0.0722 * channel(colour.2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_the_dark_page_a_colour_is_that_of_the_list_or_stands_out_from_the_ground() {
        assert_eq!(on_dark(INK), "#ffffff");
        assert_eq!(on_dark(BLUE), "#5aa9ff");
        for (r, g, b) in [(0, 0, 0x40), (0x40, 0, 0), (0x22, 0x22, 0x22), (0xf0, 0xe0, 0x10)] {
            let dark = on_dark(RGBColor(r, g, b));
            let part = |at: usize| u8::from_str_radix(&dark[at..at + 2], 16).unwrap();
            let found = RGBColor(part(1), part(3), part(5));
            // Contrast as WCAG has it, with a ground of luminance 0.0086.
            assert!((luminance(found) + 0.05) / (0.0086 + 0.05) >= 4.5, "{dark}");
            let is_light = luminance(RGBColor(r, g, b)) >= 0.214;
            assert_eq!(found == RGBColor(r, g, b), is_light, "{dark}");
        }
    }
}
