//! What people make of a drive, learned from how aggressive they called it.

use crate::{StudyData, error::AnalysisError};
use maveric_domain::{ConditionId, MeasureValues, ParticipantId, design::ScoreName, spread};
use maveric_stats::{PersonRows, hierarchical};
use std::collections::BTreeMap;

/// The scale of perceived aggressiveness.
const AGGRESSIVENESS: &str = "aggressiveness";
/// "As aggressive as I am" on the scale of perceived aggressiveness.
const SAME_AGGRESSIVENESS: f64 = 4.0;
/// Differences beyond this many SDs look alike.
const LARGEST_DIFFERENCE: f64 = 5.0;

/// Weights of the differences from the own drive, in SDs of own drives.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Percept {
    /// Of the perceived shift towards aggressive, by measure.
    pub(super) shift: BTreeMap<String, f64>,
    /// Of the squares in the perceived distance; they add up to 1.
    pub(super) distance: BTreeMap<String, f64>,
    /// SD of each measure over own drives.
    pub(super) spread: BTreeMap<String, f64>,
}

/// Where the dial is on average over people, in the unit of the perceived shift, and how far from the own drive that is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dial {
    /// Points between the own style and the two ends that were driven.
    pub(super) points: f64,
    /// Perceived shift of the low end of the dial, of the own style and of the high end.
    pub(super) shift: [f64; 3],
    /// Perceived distance of the three.
    pub(super) distance: [f64; 3],
}

impl Percept {
    /// Learns the weights: perceived aggressiveness on the differences in all measures, shrunk, with a habit a person. What people call
    /// aggressive is also what they notice: the distance weighs squares by the sizes of the same weights.
    ///
    /// # Errors
    /// [`AnalysisError::NothingToLearn`] where nobody said how aggressive a drive was; [`AnalysisError::Stats`] where all said the same.
    pub(super) fn learn(data: &StudyData, people: &[ParticipantId]) -> Result<Self, AnalysisError> {
        let own_drives: Vec<&MeasureValues> =
            people.iter().filter_map(|p| data.drive(p, data.design.baseline_id()?)).collect();
        let spread = spread(&own_drives);
        let names: Vec<&String> = spread.keys().collect();
        let felt =
            ScoreName { scale: AGGRESSIVENESS.to_owned(), subscale: AGGRESSIVENESS.to_owned() };
        let rows: Vec<PersonRows> = people
            .iter()
            .map(|p| {
                let mut rows = PersonRows::default();
                for c in data.design.condition_ids() {
                    let rated = data.rated(p, c, &felt);
                    if let (Some(rated), Some(differences)) =
                        (rated, differences(data, p, c, &spread))
                    {
                        let difference =
                            |name: &&String| differences.get(*name).copied().unwrap_or(0.0);
                        rows.y.push(rated - SAME_AGGRESSIVENESS);
                        rows.x.push(names.iter().map(difference).collect());
                        rows.z.push(vec![1.0]);
                    }
                }
                rows
            })
            .collect();
        if rows.iter().all(|rows| rows.y.is_empty()) {
            let problem =
                format!("nobody answered {felt} about a drive that can be compared with their own");
            return Err(AnalysisError::NothingToLearn { problem });
        }
        let fit = hierarchical(&rows, &vec![Some(0); names.len()])?;
        let weights = fit.coefficients.mean();
        let size: f64 = weights.iter().map(|w| w.abs()).sum();
        let named = |number: &dyn Fn(f64) -> f64| {
            let pairs = names.iter().zip(weights);
            pairs.map(|(name, w)| ((*name).clone(), number(*w))).collect()
        };
        Ok(Self {
            shift: named(&|w| w),
            distance: named(&|w| w.abs() / size.max(f64::MIN_POSITIVE)),
            spread,
        })
    }

    /// Perceived shift and distance of a drive from the own one.
    pub(super) fn perceived(&self, own: &MeasureValues, drive: &MeasureValues) -> (f64, f64) {
        let (mut shift, mut squares, mut compared) = (0.0, 0.0, 0.0);
        for (name, difference) in between(own, drive, &self.spread) {
            let weight = self.distance.get(&name).copied().unwrap_or(0.0);
            shift += self.shift.get(&name).copied().unwrap_or(0.0) * difference;
            squares += weight * difference * difference;
            compared += weight;
        }
        let distance = if compared > 0.0 { (squares / compared).sqrt() } else { 0.0 };
        (shift, distance)
    }

    /// As [`Percept::perceived`], of a participant's condition.
    pub(super) fn of_condition(
        &self,
        data: &StudyData,
        p: &ParticipantId,
        c: ConditionId,
    ) -> Option<(f64, f64)> {
        let own_drive = data.drive(p, data.design.baseline_id()?)?;
        Some(self.perceived(own_drive, data.drive(p, c)?))
    }

    /// Where the dial is on average.
    pub(super) fn dial(&self, data: &StudyData, people: &[ParticipantId]) -> Option<Dial> {
        let mut dial = Dial { points: 0.0, shift: [0.0; 3], distance: [0.0; 3] };
        let ends = ends(data)?;
        for (i, c) in ends.into_iter().enumerate() {
            let perceived: Vec<(f64, f64)> =
                people.iter().filter_map(|p| self.of_condition(data, p, c)).collect();
            if perceived.is_empty() {
                return None;
            }
            let n = perceived.len() as f64;
            dial.shift[i] = perceived.iter().map(|f| f.0).sum::<f64>() / n;
            dial.distance[i] = perceived.iter().map(|f| f.1).sum::<f64>() / n;
        }
        let moved: Vec<f64> = people
            .iter()
            .flat_map(|p| [ends[0], ends[2]].map(|c| data.condition(p, c)))
            .filter_map(|row| Some(row?.moved_points?.abs()))
            .collect();
        dial.points = moved.iter().sum::<f64>() / moved.len().max(1) as f64;
        let [low, middle, high] = dial.shift;
        (dial.points > 0.0 && low < middle && middle < high).then_some(dial)
    }
}

/// The conditions furthest down the dial, at 0 and furthest up.
fn ends(data: &StudyData) -> Option<[ConditionId; 3]> {
    let dials = data.design.conditions().iter();
    let dials: Vec<(f64, ConditionId)> = dials.filter_map(|c| Some((c.dial()?, c.id))).collect();
    let low = dials.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let high = dials.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    (low.0 < 0.0 && high.0 > 0.0).then_some([low.1, data.design.own_style()?, high.1])
}

impl Dial {
    /// Points of the style's score at which the car is perceived to be shifted by `shift`, on a straight line to either end and beyond.
    pub(super) fn points_at(&self, shift: f64) -> f64 {
        let [low, middle, high] = self.shift;
        let step = if shift >= middle { high - middle } else { middle - low };
        self.points * (shift - middle) / step
    }

    /// Perceived shift and distance that a setting in points is expected to have.
    pub(super) fn expected(&self, points: f64) -> (f64, f64) {
        let part = points / self.points;
        let end = if part >= 0.0 { 2 } else { 0 };
        let shift = self.shift[1] + part.abs() * (self.shift[end] - self.shift[1]);
        // Squares add up: the car's error, and the dial's own part.
        let (error, whole) = (self.distance[1].powi(2), self.distance[end].powi(2));
        let distance = (error + part * part * (whole - error).max(0.0)).sqrt();
        (shift, distance)
    }
}

fn between(
    own: &MeasureValues,
    drive: &MeasureValues,
    spread: &BTreeMap<String, f64>,
) -> BTreeMap<String, f64> {
    let difference = |(name, sd): (&String, &f64)| {
        let value = |values: &MeasureValues| values.get(name).copied().flatten();
        let difference = (value(drive)? - value(own)?) / sd;
        Some((name.clone(), difference.clamp(-LARGEST_DIFFERENCE, LARGEST_DIFFERENCE)))
    };
    spread.iter().filter_map(difference).collect()
}

fn differences(
    data: &StudyData,
    p: &ParticipantId,
    c: ConditionId,
    spread: &BTreeMap<String, f64>,
) -> Option<BTreeMap<String, f64>> {
    Some(between(data.drive(p, data.design.baseline_id()?)?, data.drive(p, c)?, spread))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_of_the_dial_is_found_back_from_what_it_looks_like() {
        let dial = Dial { points: 15.0, shift: [-0.8, -0.1, 0.6], distance: [1.0, 0.4, 0.9] };
        for points in [-20.0, -15.0, -4.0, 0.0, 7.5, 15.0] {
            assert!((dial.points_at(dial.expected(points).0) - points).abs() < 1e-9);
        }
        assert!((dial.expected(15.0).1 - 0.9).abs() < 1e-12);
        assert!(dial.expected(5.0).1 < dial.expected(10.0).1);
    }
}
