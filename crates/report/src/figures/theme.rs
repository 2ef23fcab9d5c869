//! One look for all figures: colours, sizes, widths.

use maveric_domain::ConditionId;
use plotters::style::RGBColor;

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

/// The fixed colour of a condition; no two are closer than 12 (Oklab × 100), for normal and
/// for colour-blind eyes.
pub(crate) fn colour(condition: ConditionId) -> RGBColor {
    match condition {
        ConditionId::OWN => INK,
        ConditionId::MIMIC => RGBColor(0x88, 0x2e, 0x72),
        ConditionId::AGGRESSIVE => RGBColor(0xd5, 0x5e, 0x00),
        ConditionId::CAUTIOUS => RGBColor(0x00, 0x5a, 0xb5),
        ConditionId::PERPENDICULAR => RGBColor(0x0f, 0x9d, 0x7a),
        _ => MUTED,
    }
}

/// The name of a condition as figures and tables write it.
pub(crate) fn condition_name(condition: ConditionId) -> String {
    let word = condition.as_str();
    word[..1].to_ascii_uppercase() + &word[1..]
}

/// The shape that goes with a colour, so that colour is never alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Marker {
    Circle,
    Square,
    TriangleUp,
    TriangleDown,
    Diamond,
}

/// The fixed marker of a condition.
pub(crate) fn marker(condition: ConditionId) -> Marker {
    match condition {
        ConditionId::MIMIC => Marker::Square,
        ConditionId::AGGRESSIVE => Marker::TriangleUp,
        ConditionId::CAUTIOUS => Marker::TriangleDown,
        ConditionId::PERPENDICULAR => Marker::Diamond,
        _ => Marker::Circle,
    }
}

/// Marker and colour of the group or condition at a place in a list; the sixth begins anew.
pub(crate) fn nth_look(place: usize) -> (Marker, RGBColor) {
    const LOOKS: [(Marker, RGBColor); 5] = [
        (Marker::TriangleDown, RGBColor(0x00, 0x5a, 0xb5)),
        (Marker::TriangleUp, RGBColor(0xd5, 0x5e, 0x00)),
        (Marker::Square, RGBColor(0x88, 0x2e, 0x72)),
        (Marker::Diamond, RGBColor(0x0f, 0x9d, 0x7a)),
        (Marker::Circle, OCHRE),
    ];
    LOOKS[place % LOOKS.len()]
}

/// Colours of the dark page: what each drawn colour turns into there.
pub(crate) const DARK: [(RGBColor, &str); 13] = [
    (INK, "#ffffff"),
    (RGBColor(0x88, 0x2e, 0x72), "#b565a7"),
    (RGBColor(0xd5, 0x5e, 0x00), "#ff8a3d"),
    (RGBColor(0x00, 0x5a, 0xb5), "#5aa9ff"),
    (RGBColor(0x0f, 0x9d, 0x7a), "#7fe0c4"),
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
    let part = place - low as f64;
    let (a, b) = (VIRIDIS[low], VIRIDIS[low + 1]);
    let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * part).round() as u8;
    RGBColor(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

/// `#rrggbb` in lower case, as figures and the dark page's rules write it.
pub(crate) fn hex(colour: RGBColor) -> String {
    format!("#{:02x}{:02x}{:02x}", colour.0, colour.1, colour.2)
}

/// A coefficient from −1 (blue) over 0 (nearly white) to 1 (orange), clamped.
///
/// The darkest are those of Cautious and Aggressive, the widest apart for colour-blind eyes.
pub(crate) fn diverging(value: f64) -> RGBColor {
    const MIDDLE: RGBColor = RGBColor(0xf6, 0xf6, 0xf6);
    let value = value.clamp(-1.0, 1.0);
    let end = colour(if value < 0.0 {
        ConditionId::CAUTIOUS
    } else {
        ConditionId::AGGRESSIVE
    });
    let share = value.abs();
    let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
    let mixed = RGBColor(
        mix(MIDDLE.0, end.0),
        mix(MIDDLE.1, end.1),
        mix(MIDDLE.2, end.2),
    );
    // The end itself is a condition's colour, which the dark page changes; a cell stays as it is.
    if mixed == end {
        RGBColor(end.0, end.1, end.2 + 1)
    } else {
        mixed
    }
}

/// Text on a coloured cell: dark or light, whichever has more contrast. Not the ink and paper of
/// the page, which change with it.
pub(crate) fn on_colour(ground: RGBColor) -> RGBColor {
    let channel = |value: u8| {
        let share = f64::from(value) / 255.0;
        if share <= 0.040_45 {
            share / 12.92
        } else {
            ((share + 0.055) / 1.055).powf(2.4)
        }
    };
    let luminance =
        0.2126 * channel(ground.0) + 0.7152 * channel(ground.1) + 0.0722 * channel(ground.2);
    // Where contrast with black and with white are the same.
    if luminance > 0.179 {
        RGBColor(0x16, 0x16, 0x16)
    } else {
        RGBColor(0xfe, 0xfe, 0xfe)
    }
}
