//! The last seconds of four signals, evenly sampled: what C and V read.
//!
//! One rule makes every window, in training and in the moving car: values between two samples are
//! interpolated linearly; before the first sample of a drive, or after a hole in it, the first value is
//! repeated. So a buffer fed at any rate from 5 Hz on gives the windows of the offline code.

use crate::error::ModelError;
use maveric_domain::Situation;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Signals of a window, in order: v_ego, v_lead, d_x, d_y. C reads the first three, V the last three.
pub const SIGNALS: usize = 4;

/// Length and rate of a window.
///
/// # Source
/// Method section 3 (4.0 s at 5 Hz, ours); `gap_scale_m` is from calibration section 3.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WindowSettings {
    /// Length, in s.
    pub window_s: f64,
    /// Samples a second.
    pub window_rate_hz: f64,
    /// d_x enters as asinh(d_x / this), so that the near metres that matter get resolution; `None`: as it is.
    pub gap_scale_m: Option<f64>,
}

impl Default for WindowSettings {
    fn default() -> Self {
        Self { window_s: 4.0, window_rate_hz: 5.0, gap_scale_m: Some(20.0) }
    }
}

impl WindowSettings {
    /// Number of samples of each signal; the last is now.
    pub fn steps(&self) -> usize {
        (self.window_s * self.window_rate_hz).round() as usize
    }

    /// The four signals of a situation, d_x transformed.
    pub(crate) fn signals(&self, situation: &Situation) -> [f64; SIGNALS] {
        let reference = &situation.reference;
        let gap = match self.gap_scale_m {
            Some(scale) => libm::asinh(reference.dx_m / scale),
            None => reference.dx_m,
        };
        [situation.ego_speed_mps, reference.speed_mps, gap, reference.dy_m]
    }
}

/// A window: the signals in order, each oldest first, d_x transformed, nothing standardised.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    pub(crate) values: Vec<f64>,
    pub(crate) steps: usize,
}

impl Window {
    /// Shape `(4 × steps,)`.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Samples of each signal.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// v_lead now, in m/s.
    pub fn lead_speed_mps(&self) -> f64 {
        self.values[2 * self.steps - 1]
    }
}

/// Collects situations as they come and gives the window that ends at the last one.
#[derive(Debug, Clone)]
pub struct WindowBuffer {
    settings: WindowSettings,
    samples: VecDeque<(f64, [f64; SIGNALS])>,
}

impl WindowBuffer {
    /// An empty buffer.
    pub fn new(settings: WindowSettings) -> Self {
        Self { settings, samples: VecDeque::new() }
    }

    /// Forgets everything: a new drive, or a hole in this one.
    pub fn clear(&mut self) {
        self.samples.clear();
    }

    /// Takes the next situation.
    ///
    /// # Errors
    /// [`ModelError::TimeNotIncreasing`] or [`ModelError::NotFinite`]; the situation is not taken.
    pub fn push(&mut self, situation: &Situation) -> Result<(), ModelError> {
        let time = situation.time_s;
        let values = self.settings.signals(situation);
        let names = ["ego_speed_mps", "lead_speed_mps", "lead_dx_m", "lead_dy_m", "time_s"];
        for (signal, found) in names.into_iter().zip(values.into_iter().chain([time])) {
            if !found.is_finite() {
                return Err(ModelError::NotFinite { signal, found });
            }
        }
        if let Some(&(last_s, _)) = self.samples.back()
            && time <= last_s
        {
            return Err(ModelError::TimeNotIncreasing { found_s: time, last_s });
        }
        self.samples.push_back((time, values));
        let span = self.settings.steps().saturating_sub(1) as f64 / self.settings.window_rate_hz;
        // The last sample at or before the window's start stays, to interpolate from.
        while self.samples.len() > 1 && self.samples[1].0 <= time - span {
            self.samples.pop_front();
        }
        Ok(())
    }

    /// The window that ends at the last situation; `None` before the first.
    pub fn window(&self) -> Option<Window> {
        let &(now, _) = self.samples.back()?;
        let steps = self.settings.steps();
        let mut values = vec![0.0; SIGNALS * steps];
        let mut index = 0;
        for step in 0..steps {
            let time = now - (steps - 1 - step) as f64 / self.settings.window_rate_hz;
            while index + 1 < self.samples.len() && self.samples[index + 1].0 <= time {
                index += 1;
            }
            let (before, low) = self.samples[index];
            let (share, high) = match self.samples.get(index + 1) {
                Some(&(after, high)) if time > before => ((time - before) / (after - before), high),
                _ => (0.0, low),
            };
            for signal in 0..SIGNALS {
                values[signal * steps + step] = low[signal] + share * (high[signal] - low[signal]);
            }
        }
        Some(Window { values, steps })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::Reference;

    fn situation(time_s: f64) -> Situation {
        Situation {
            time_s,
            ego_speed_mps: 20.0 + time_s,
            reference: Reference {
                vehicle: None,
                dx_m: 40.0,
                dy_m: -time_s,
                speed_mps: 25.0 - 2.0 * time_s,
            },
        }
    }

    fn fed(rate_hz: f64, seconds: f64) -> WindowBuffer {
        let mut buffer = WindowBuffer::new(WindowSettings::default());
        for i in 0..=(seconds * rate_hz).round() as usize {
            buffer.push(&situation(i as f64 / rate_hz)).unwrap();
        }
        buffer
    }

    #[test]
    fn any_rate_gives_the_same_window() {
        let reference = fed(20.0, 6.0).window().unwrap();
        for rate in [5.0, 7.0, 10.0, 50.0, 100.0] {
            let window = fed(rate, 6.0).window().unwrap();
            for (a, b) in window.values().iter().zip(reference.values()) {
                assert!((a - b).abs() < 1e-9, "{rate} Hz");
            }
        }
    }

    #[test]
    fn the_last_step_is_now_and_the_first_four_seconds_less_one_step_ago() {
        let window = fed(20.0, 6.0).window().unwrap();
        assert_eq!(window.steps(), 20);
        assert!((window.values()[19] - 26.0).abs() < 1e-12);
        assert!((window.values()[0] - 22.2).abs() < 1e-9);
        assert!((window.lead_speed_mps() - 13.0).abs() < 1e-12);
    }

    #[test]
    fn before_the_start_the_first_value_is_repeated() {
        let window = fed(20.0, 1.0).window().unwrap();
        assert!(window.values()[..15].iter().all(|v| (v - 20.0).abs() < 1e-9));
        assert!((window.values()[16] - 20.4).abs() < 1e-9);
    }

    #[test]
    fn bad_situations_are_refused_and_forgotten() {
        let mut buffer = fed(20.0, 1.0);
        let before = buffer.window();
        assert!(matches!(buffer.push(&situation(1.0)), Err(ModelError::TimeNotIncreasing { .. })));
        let mut bad = situation(2.0);
        bad.reference.dx_m = f64::NAN;
        assert!(matches!(
            buffer.push(&bad),
            Err(ModelError::NotFinite { signal: "lead_dx_m", .. })
        ));
        assert_eq!(buffer.window(), before);
    }
}
