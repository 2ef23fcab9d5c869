//! Drives made by hand for the tests.

use maveric_domain::{
    Drive, DriveMeta, DrivenBy, EgoTrack, ObjectTrack, Recording, Road, VehicleId, drive::Rows,
};

const RATE_HZ: f64 = 20.0;
const LENGTH_M: f64 = 5.0;

/// A drive of `seconds` on the paper's road: a speed over time, one pass, one lead vehicle.
pub(crate) struct Scripted {
    seconds: f64,
    speed: Box<dyn Fn(f64) -> f64>,
    out_s: f64,
    back_s: f64,
    lead: Option<(f64, f64)>,
}

impl Scripted {
    pub(crate) fn new(seconds: f64) -> Self {
        Self { seconds, speed: Box::new(|_| 30.0), out_s: 1e9, back_s: 1e9, lead: None }
    }

    pub(crate) fn speed(mut self, speed: impl Fn(f64) -> f64 + 'static) -> Self {
        self.speed = Box::new(speed);
        self
    }

    /// Moves to the passing lane from `out_s` on and back from `back_s` on, 4 s each.
    pub(crate) fn pass(mut self, out_s: f64, back_s: f64) -> Self {
        (self.out_s, self.back_s) = (out_s, back_s);
        self
    }

    /// A vehicle in the slow lane, `gap_m` bumper to bumper ahead at the start.
    pub(crate) fn lead(mut self, gap_m: f64, speed_mps: f64) -> Self {
        self.lead = Some((gap_m, speed_mps));
        self
    }

    pub(crate) fn drive(self) -> Drive {
        let n = (self.seconds * RATE_HZ).round() as usize;
        let time_s: Vec<f64> = (0..n).map(|i| i as f64 / RATE_HZ).collect();
        let step = |t: f64, from: f64| {
            let s = ((t - from) / 4.0).clamp(0.0, 1.0);
            3.66 * s * s * (3.0 - 2.0 * s)
        };
        let speed_mps: Vec<f64> = time_s.iter().map(|&t| (self.speed)(t)).collect();
        let mut x = 0.0;
        let x_m = speed_mps
            .iter()
            .map(|v| {
                let here = x;
                x += v / RATE_HZ;
                here
            })
            .collect();
        let y_m = time_s.iter().map(|&t| step(t, self.out_s) - step(t, self.back_s)).collect();
        let others = self.lead.map(|(gap_m, lead_mps)| ObjectTrack {
            id: VehicleId(1),
            length_m: LENGTH_M,
            first_row: 0,
            x_m: time_s.iter().map(|t| gap_m + LENGTH_M + lead_mps * t).collect(),
            y_m: vec![0.0; n],
            speed_mps: vec![lead_mps; n],
        });
        let ego = EgoTrack { length_m: LENGTH_M, x_m, y_m, speed_mps };
        let recording = Recording::new(
            Road::PAPER,
            RATE_HZ,
            time_s,
            vec![0; n],
            ego,
            others.into_iter().collect(),
        )
        .unwrap();
        let meta = DriveMeta::named("S2P01-own", "S2P01", "own", DrivenBy::Synthetic).unwrap();
        Drive::from_recording(meta, &recording).unwrap()
    }
}

/// A drive of `n` rows at `rate_hz` behind one lead 40 m ahead, both at 20 m/s, changed row by row.
pub(crate) fn by_rows(rate_hz: f64, n: usize, change: impl FnOnce(&mut Rows)) -> Drive {
    let mut rows = Rows {
        time_s: (0..n).map(|row| row as f64 / rate_hz).collect(),
        segment: vec![0; n],
        ego_x_m: vec![0.0; n],
        ego_y_m: vec![0.0; n],
        ego_speed_mps: vec![20.0; n],
        lane: vec![0; n],
        lead_present: vec![true; n],
        lead_id: vec![Some(1); n],
        lead_dx_m: vec![40.0; n],
        lead_dy_m: vec![0.0; n],
        lead_speed_mps: vec![20.0; n],
        lane_change: vec![false; n],
        changing: vec![0; n],
        change_completes: vec![false; n],
        following: vec![true; n],
        gap_behind_left_m: vec![None; n],
        gap_behind_right_m: vec![None; n],
    };
    change(&mut rows);
    let meta = Scripted::new(1.0).drive().meta().clone();
    Drive::from_rows(meta, Road::PAPER, rate_hz, rows).unwrap()
}
