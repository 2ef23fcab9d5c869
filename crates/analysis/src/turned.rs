//! Where people left the dial who could turn it while riding.

use maveric_domain::ParticipantId;

/// How somebody turned the dial in one ride.
#[derive(Debug, Clone, PartialEq)]
pub struct Turns {
    /// Who rode.
    pub participant: ParticipantId,
    /// Time in the ride (s), and where the dial was from then on, in points from the own style; in order of time, 0 before the first.
    pub turned: Vec<(f64, f64)>,
    /// Length of the ride, in s.
    pub duration_s: f64,
    /// Points of one press.
    pub step: f64,
}

/// Where somebody left the dial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settled {
    /// In points from the own style: the mean over the second half of the ride.
    pub points: f64,
    /// How surely: the SD over the same time, and the grain of a press.
    pub sd: f64,
}

impl Turns {
    /// Where the dial stood in the second half of the ride; none where nobody touched it, which says as little of the person as of the dial.
    pub fn settled(&self) -> Option<Settled> {
        if self.turned.is_empty() || self.duration_s <= 0.0 {
            return None;
        }
        let (from, to) = (0.5 * self.duration_s, self.duration_s);
        let begins = std::iter::once((0.0, 0.0)).chain(self.turned.iter().copied());
        let ends = self.turned.iter().map(|(time, _)| *time).chain([to]);
        let (mut sum, mut square) = (0.0, 0.0);
        for ((begin, points), end) in begins.zip(ends) {
            let part = (end.min(to) - begin.max(from)).max(0.0) / (to - from);
            sum += part * points;
            square += part * points * points;
        }
        let variance = (square - sum * sum).max(0.0) + self.step * self.step / 12.0;
        Some(Settled { points: sum, sd: variance.sqrt() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turns(turned: &[(f64, f64)]) -> Turns {
        Turns {
            participant: ParticipantId::new("P1").unwrap(),
            turned: turned.to_vec(),
            duration_s: 100.0,
            step: 5.0,
        }
    }

    #[test]
    fn the_dial_is_where_it_stood_in_the_second_half_and_as_sure_as_it_stood_still() {
        assert_eq!(turns(&[]).settled(), None);
        let grain = 5.0 / 12.0_f64.sqrt();
        let still = turns(&[(10.0, 15.0), (40.0, 10.0)]).settled().unwrap();
        assert!((still.points - 10.0).abs() < 1e-12 && (still.sd - grain).abs() < 1e-12);
        let moved = turns(&[(10.0, 10.0), (75.0, 0.0)]).settled().unwrap();
        assert!((moved.points - 5.0).abs() < 1e-12);
        assert!((moved.sd - (25.0 + grain * grain).sqrt()).abs() < 1e-12);
    }
}
