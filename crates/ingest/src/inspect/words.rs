//! What the name of a column says, in English or German: whose it is, what it is, and sometimes in which unit.

/// Whose value it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Whose {
    /// Ego's, the follower's, or nobody's in particular.
    Ego,
    /// That of the vehicle ahead.
    Lead,
    /// That of a vehicle behind, or beside.
    Another,
}

/// What it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum What {
    Time,
    Frame,
    Id,
    Group,
    /// A position along some axis.
    Position,
    Speed,
    SpeedX,
    SpeedY,
    Gap,
    Length,
    Width,
    Lane,
    /// A place in the lane, by its name.
    Offset,
    /// A place to the side: in the lane or across the road.
    Lateral,
    Heading,
}

/// What the name of a column says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Words {
    pub(super) whose: Whose,
    pub(super) what: Option<What>,
    /// Number of the vehicle in a platoon, at the end of the name.
    pub(super) number: Option<u32>,
    /// Unit at the end of the name.
    pub(super) unit: Option<&'static str>,
    /// Whether it is along y.
    pub(super) is_y: bool,
}

/// Words of a name, in small letters, `ä` as `ae` and so on: split at signs, at capitals and before numbers.
fn split(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut last = ' ';
    for c in name.chars() {
        let starts = !c.is_alphanumeric()
            || c.is_uppercase() && last.is_lowercase()
            || c.is_ascii_digit() != last.is_ascii_digit();
        if starts {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut().filter(|_| c.is_alphanumeric()) {
            for small in c.to_lowercase() {
                match small {
                    'ä' => word.push_str("ae"),
                    'ö' => word.push_str("oe"),
                    'ü' => word.push_str("ue"),
                    'ß' => word.push_str("ss"),
                    other => word.push(other),
                }
            }
        }
        last = c;
    }
    words.retain(|w| !w.is_empty());
    words
}

/// The words of a name, and the number behind them.
fn parted(name: &str) -> (Vec<String>, Option<u32>) {
    let mut words = split(name);
    let number = words.last().filter(|_| words.len() > 1);
    let number = number.and_then(|word| word.parse().ok());
    if number.is_some() {
        words.pop();
    }
    (words, number)
}

/// Reads a name.
pub(super) fn words(name: &str) -> Words {
    let (mut words, mut number) = parted(name);
    let unit = unit_of(name, &words);
    let before = name.split_once(['[', '(']).map_or("", |(before, _)| before);
    if unit.is_some() && !before.trim().is_empty() {
        (words, number) = parted(before);
    }
    if unit.is_some() && words.len() > 1 && words.last().is_some_and(|w| unit_at_end(w).is_some()) {
        // `t_ms` is a time, and `x_m` a position.
        words.pop();
    }
    let within = |any: &str, word: &String| any.split(' ').any(|a| a == word);
    let has = |any: &str| words.iter().any(|w| within(any, w));
    let is = |exact: &str| words.len() == 1 && within(exact, &words[0]);
    let whose = if has(
        "leader lead lv preceding front pred ahead vordermann vorderfahrzeug fuehrungsfahrzeug vorausfahrender",
    ) {
        Whose::Lead
    } else if has(
        "following rear behind left right alongside back folgefahrzeug hintermann hinterfahrzeug hinten links rechts",
    ) {
        Whose::Another
    } else {
        Whose::Ego
    };
    let differs = has(
        "dv diff rel relative delta acc accel acceleration class total differenz relativ relative beschleunigung soll limit",
    );
    // Places on a screen or in a picture, and what the driver's hands and eyes do, are no places on the road.
    let elsewhere = has(
        "pixel pixels px image img bbox screen camera cam gaze eye mouse steering wheel pedal gps lenkrad blick",
    );
    // A gap in seconds is a time gap. What an `Abstand` is one to has to be said: to a traffic light, it is none.
    let gap_in_time = unit.is_some_and(|unit| ["s", "ms"].contains(&unit));
    let to_the_leader = |word: &String| {
        within(
            "abstand folgeabstand laengsabstand zum zu dem vordermann vorderfahrzeug fuehrungsfahrzeug ego m in",
            word,
        )
    };
    // Upwards is no place on the road, and no speed along it.
    let what = if differs || elsewhere || has("z vz thw ttc") || has("headway gap") && has("time") {
        None
    } else if has("frame frames") {
        Some(What::Frame)
    } else if has("abstand folgeabstand laengsabstand") {
        (!gap_in_time && words.iter().all(to_the_leader)).then_some(What::Gap)
    } else if is("t") || has("time timestamp stamp utc seconds zeit uhrzeit zeitstempel messzeit") {
        Some(What::Time)
    } else if has("lane") && has("offset deviation dev position pos lateral distance dist")
        || is("offset")
        || has("lateral") && has("offset deviation")
        || has("spurablage spurabweichung querablage querabweichung")
    {
        Some(What::Offset)
    } else if has("lane spur fahrspur fahrstreifen spurnummer") {
        (!has("width change changes count breite wechsel anzahl")).then_some(What::Lane)
    } else if has("lateral querposition querlage") && !has("velocity vel speed") {
        Some(What::Lateral)
    } else if has("location site recording run scenario trial period") {
        Some(What::Group)
    } else if has("spacing gap ivs headway dhw clearance distance")
        || whose == Whose::Lead && has("dx")
    {
        (!gap_in_time).then_some(What::Gap)
    } else if has("length len laenge fahrzeuglaenge") {
        Some(What::Length)
    } else if has("width breite fahrzeugbreite") {
        Some(What::Width)
    } else if has("heading yaw bearing gierwinkel") {
        Some(What::Heading)
    } else if has(SPEED) || is("v vx vy") || has("v") && words.len() == 2 {
        Some(match () {
            () if has("x lon laengsgeschwindigkeit") || is("vx") => What::SpeedX,
            () if has("y lat quergeschwindigkeit") || is("vy") => What::SpeedY,
            () => What::Speed,
        })
    } else if has("id vehicle track veh") || is("preceding following leader") {
        Some(What::Id)
    } else if has("x y position pos station laengsposition weg wegstrecke") || is("s") {
        Some(What::Position)
    } else {
        None
    };
    Words { whose, what, number, unit, is_y: has("y") }
}

/// Words for a speed.
const SPEED: &str = "velocity vel speed spd geschwindigkeit eigengeschwindigkeit fahrgeschwindigkeit laengsgeschwindigkeit quergeschwindigkeit";

fn unit_of(name: &str, words: &[String]) -> Option<&'static str> {
    let name = name.to_ascii_lowercase();
    let within = |unit: &str| [format!("[{unit}]"), format!("({unit})")].map(|u| name.contains(&u));
    let written = ["km/h", "m/s", "ft/s"].into_iter().find(|u| name.contains(u));
    let bracketed = || ["m", "ft", "s", "ms"].into_iter().find(|u| within(u) != [false; 2]);
    let last = || unit_at_end(words.get(1..)?.last()?);
    written.or_else(bracketed).or_else(last)
}

/// The unit that a word at the end of a name is.
fn unit_at_end(word: &str) -> Option<&'static str> {
    ENDS.iter().find(|(end, _)| *end == word).map(|e| e.1)
}

/// Words at the end of a name that are its unit.
const ENDS: [(&str, &str); 17] = [
    ("mps", "m/s"),
    ("kmh", "km/h"),
    ("kph", "km/h"),
    ("mph", "mph"),
    ("fps", "ft/s"),
    ("ft", "ft"),
    ("feet", "ft"),
    ("m", "m"),
    ("meters", "m"),
    ("metres", "m"),
    ("s", "s"),
    ("sec", "s"),
    ("ms", "ms"),
    ("us", "us"),
    ("ns", "ns"),
    ("deg", "deg"),
    ("rad", "rad"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_known_tables_are_read() {
        let said = |name: &str| {
            let w = words(name);
            (w.whose, w.what)
        };
        for (name, whose, what) in [
            ("t", Whose::Ego, Some(What::Time)),
            ("x_follower", Whose::Ego, Some(What::Position)),
            ("v_leader", Whose::Lead, Some(What::Speed)),
            ("a_leader", Whose::Lead, None),
            ("leader_length", Whose::Lead, Some(What::Length)),
            ("spacing", Whose::Ego, Some(What::Gap)),
            ("lead_dx_m", Whose::Lead, Some(What::Gap)),
            ("lead_dy_m", Whose::Lead, None),
            ("dv", Whose::Ego, None),
            ("Vehicle_ID", Whose::Ego, Some(What::Id)),
            ("Global_Time", Whose::Ego, Some(What::Time)),
            ("Local_Y", Whose::Ego, Some(What::Position)),
            ("v_Vel", Whose::Ego, Some(What::Speed)),
            ("v_length", Whose::Ego, Some(What::Length)),
            ("v_Class", Whose::Ego, None),
            ("Lane_ID", Whose::Ego, Some(What::Lane)),
            ("Preceding", Whose::Lead, Some(What::Id)),
            ("Following", Whose::Another, Some(What::Id)),
            ("Space_Headway", Whose::Ego, Some(What::Gap)),
            ("Time_Headway", Whose::Ego, None),
            ("preceding_Vehicle_Velocity", Whose::Lead, Some(What::Speed)),
            ("preceding_Local_Y", Whose::Lead, Some(What::Position)),
            ("xVelocity", Whose::Ego, Some(What::SpeedX)),
            ("precedingId", Whose::Lead, Some(What::Id)),
        ] {
            assert_eq!(said(name), (whose, what), "{name}");
        }
        for (name, what) in [
            ("lane_offset", What::Offset),
            ("LanePosition", What::Offset),
            ("offset", What::Offset),
            ("lateral_position", What::Lateral),
            ("lane", What::Lane),
            ("lane_id", What::Lane),
        ] {
            assert_eq!(words(name).what, Some(what), "{name}");
        }
        for (name, what, unit) in [
            ("t_ms", What::Time, "ms"),
            ("speed_kmh", What::Speed, "km/h"),
            ("v_kmh", What::Speed, "km/h"),
            ("x_m", What::Position, "m"),
            ("gap_m", What::Gap, "m"),
        ] {
            assert_eq!((words(name).what, words(name).unit), (Some(what), Some(unit)), "{name}");
        }
        for name in
            ["camera_x", "pixel_y", "gaze_pos", "steering_wheel_position", "velocityZ", "z_m"]
        {
            assert_eq!(words(name).what, None, "{name}");
        }
        for (name, whose, what, unit) in [
            ("Zeit [s]", Whose::Ego, What::Time, Some("s")),
            ("Geschwindigkeit [km/h]", Whose::Ego, What::Speed, Some("km/h")),
            ("v_Ego", Whose::Ego, What::Speed, None),
            ("v_Vordermann [km/h]", Whose::Lead, What::Speed, Some("km/h")),
            ("GeschwindigkeitVorderfahrzeug", Whose::Lead, What::Speed, None),
            ("Längsgeschwindigkeit", Whose::Ego, What::SpeedX, None),
            ("Abstand [m]", Whose::Ego, What::Gap, Some("m")),
            ("Folgeabstand", Whose::Ego, What::Gap, None),
            ("Abstand_zum_Vordermann_m", Whose::Lead, What::Gap, Some("m")),
            ("Längsposition", Whose::Ego, What::Position, None),
            ("Spur", Whose::Ego, What::Lane, None),
            ("Querablage [m]", Whose::Ego, What::Offset, Some("m")),
            ("Fahrzeuglaenge", Whose::Ego, What::Length, None),
        ] {
            let read = words(name);
            assert_eq!((read.whose, read.what, read.unit), (whose, Some(what), unit), "{name}");
        }
        for name in [
            "Abstand_Ampel",
            "Abstand [s]",
            "gap_s",
            "Zeitabstand",
            "Sollgeschwindigkeit",
            "Soll_Geschwindigkeit",
            "speed_limit",
            "Relativgeschwindigkeit",
            "Lenkrad_Position",
            "Spur_Breite",
            "lane_width",
        ] {
            assert_eq!(words(name).what, None, "{name}");
        }
        assert_eq!(words("v_Folgefahrzeug").whose, Whose::Another);
        assert_eq!(words("Speed12").number, Some(12));
        assert_eq!(words("IVS1").what, Some(What::Gap));
        assert_eq!(words("ego_speed_mps").unit, Some("m/s"));
        assert_eq!(words("Time [ms]").unit, Some("ms"));
    }
}
