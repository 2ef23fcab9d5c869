//! The embedding space, to be turned by hand.

use crate::figures::{ConditionLook, Context};
use maveric_domain::ConditionId;
use serde_json::{Value, json};

/// People beyond this number cannot be chosen, drives beyond it are not drawn: the page stays small.
const MOST: usize = 1000;

/// Drives and participants in a style space of three dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct StyleSpace {
    /// The training drives.
    pub drives: Vec<SpaceDrive>,
    /// The test participants.
    pub people: Vec<SpacePerson>,
    /// The gradient of the style predictor, shape `(3,)`; not zero. Its direction is drawn.
    pub gradient: [f64; 3],
    /// The half-axes of the ellipse across the gradient, round each participant's own style, shape `(2, 3)`; `None` where no condition
    /// moves across it.
    pub ellipse: Option<[[f64; 3]; 2]>,
    /// What the size of a point says: lowest and highest score, and what the score is called.
    pub score: (f64, f64, String),
    /// The conditions from the low end of the dial to the high one, between which a line is drawn.
    pub dial: Vec<ConditionId>,
}

/// A drive as a point of the space.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceDrive {
    /// Its id; any text.
    pub name: String,
    /// Its embedding.
    pub at: [f64; 3],
    /// Score of the driver in points; `None` for a driver who has none.
    pub score_points: Option<f64>,
    /// Mean velocity in m/s.
    pub velocity_mps: f64,
}

/// One test participant.
#[derive(Debug, Clone, PartialEq)]
pub struct SpacePerson {
    /// The own drive.
    pub own: SpaceDrive,
    /// Where the conditions lie.
    pub conditions: Vec<(ConditionId, [f64; 3])>,
}

impl StyleSpace {
    pub(super) fn check(&self) -> Result<(), String> {
        let finite = |what: &str, values: &[f64]| match values.iter().find(|v| !v.is_finite()) {
            Some(value) => Err(format!("{what} is {value}, expected a finite number")),
            None => Ok(()),
        };
        if self.drives.is_empty() && self.people.is_empty() {
            return Err("no drive to show, expected at least 1".to_owned());
        }
        let own_drives = self.people.iter().map(|p| &p.own);
        for drive in self.drives.iter().chain(own_drives) {
            finite(&format!("the embedding of {}", drive.name), &drive.at)?;
            let rest = [drive.score_points.unwrap_or_default(), drive.velocity_mps];
            finite(&format!("score or velocity of {}", drive.name), &rest)?;
        }
        for person in &self.people {
            for (condition, at) in &person.conditions {
                finite(&format!("{condition} of {}", person.own.name), at)?;
            }
        }
        finite("the gradient", &self.gradient)?;
        finite("the ellipse", self.ellipse.as_slice().as_flattened().as_flattened())?;
        if self.gradient.iter().all(|g| *g == 0.0) {
            return Err("the gradient is zero".to_owned());
        }
        Ok(())
    }

    /// What the script reads.
    pub(super) fn json(&self, context: &Context) -> Value {
        let rounded = |point: &[f64; 3]| json!(point.map(short));
        let drive = |d: &SpaceDrive| json!({ "name": d.name, "at": rounded(&d.at), "score": d.score_points.map(short), "speed": short(d.velocity_mps * context.speed.per_mps()) });
        let person = |p: &SpacePerson| {
            let conditions =
                p.conditions.iter().map(|(c, where_)| json!([c.to_string(), rounded(where_)]));
            let mut out = drive(&p.own);
            out["conditions"] = conditions.collect();
            out
        };
        json!({
            "drives": self.drives.iter().take(MOST).map(drive).collect::<Vec<_>>(),
            "people": self.people.iter().take(MOST).map(person).collect::<Vec<_>>(),
            "unit": context.speed.name(),
            "gradient": direction(self.gradient),
            "ellipse": self.ellipse.map(|axes| axes.map(|axis| rounded(&axis))),
            "score": [self.score.0, self.score.1, self.score.2],
            "dial": self.dial.iter().map(ToString::to_string).collect::<Vec<_>>(),
            "looks": self.looks(context).map(|look| json!([look.id.to_string(), look.label, look.marker.corners()])).collect::<Vec<_>>(),
        })
    }

    /// How the conditions look that are placed here, in the order of the study.
    fn looks<'a>(&'a self, context: &'a Context) -> impl Iterator<Item = &'a ConditionLook> {
        let placed = |look: &&ConditionLook| {
            let mut places = self.people.iter().flat_map(|p| &p.conditions);
            places.any(|(c, _)| *c == look.id)
        };
        context.conditions.iter().filter(placed)
    }

    /// Which marker is which condition, and the ellipse, in words.
    pub(super) fn key(&self, context: &Context) -> String {
        let one = |look: &ConditionLook| format!("{} {}", look.marker.words(), look.label);
        let key = self.looks(context).map(one).collect::<Vec<_>>().join(", ");
        match self.ellipse {
            Some(_) => {
                format!("{key}, and the ellipse across the gradient, one standard deviation wide")
            }
            None => key,
        }
    }

    /// The ids that can be chosen.
    pub(super) fn names(&self) -> Vec<String> {
        let names = self.people.iter().take(MOST).map(|p| p.own.name.clone());
        names.collect()
    }

    /// What is not shown, in words.
    pub(super) fn left_out(&self) -> Option<String> {
        let beyond = |n: usize| n.saturating_sub(MOST);
        let (drives, people) = (beyond(self.drives.len()), beyond(self.people.len()));
        (drives + people > 0).then(|| {
            format!(
                "Not shown: {drives} further training drives and {people} further participants."
            )
        })
    }
}

/// The same way, one long: rounded to decimals a gradient on a narrow scale would have none.
fn direction(gradient: [f64; 3]) -> [f64; 3] {
    let largest = gradient.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
    let [x, y, z] = gradient.map(|g| g / largest);
    let length = libm::hypot(libm::hypot(x, y), z);
    [x, y, z].map(|g| g / length)
}

/// A number with four decimals: more than a screen can show.
fn short(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::direction;

    #[test]
    fn a_gradient_however_small_keeps_its_direction() {
        for size in [1.0, 1e-6, 1e-200] {
            let [x, y, z] = direction([3.0 * size, 0.0, -4.0 * size]);
            assert!((x - 0.6).abs() < 1e-12 && (z + 0.8).abs() < 1e-12);
            assert!(y.abs() < 1e-12);
        }
    }
}
