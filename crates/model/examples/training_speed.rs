//! How fast training is, beside what the processor could do: rows a second and the share of its peak.
//!
//! A row is one row of data through all five sub-networks, forward and back, with the optimiser's step. Run with
//! `cargo run --release -p maveric-model --example training_speed`. On a busy machine
//! `RAYON_NUM_THREADS=1 … -- --processor-time` compares time on the processor instead of time on the wall.
#![allow(clippy::print_stdout, reason = "its output is what it is for")]

#[path = "../tests/support/drives.rs"]
mod drives;

use maveric_model::{HeadsKind, TrainSettings, TrainingDrive, train};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::{ops::ControlFlow, sync::OnceLock, time::Instant};

/// Fused multiply-adds in registers alone: 24 sums, as many as the training kernel keeps.
struct Peak {
    rounds: usize,
}

const SUMS: usize = 24;

impl WithSimd for Peak {
    type Output = f64;
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "must be inlined into the dispatch")]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let factor = simd.splat_f32s(0.999_9);
        let term = simd.splat_f32s(std::hint::black_box(1e-4));
        let mut sums = [term; SUMS];
        for _ in 0..self.rounds {
            for sum in &mut sums {
                *sum = simd.mul_add_e_f32s(*sum, factor, term);
            }
        }
        std::hint::black_box(sums.map(|sum| simd.reduce_sum_f32s(sum)));
        (2 * self.rounds * SUMS * S::F32_LANES) as f64
    }
}

/// Time since the first call, in s: that the processor spent on this program where the system says so (Linux), which a
/// busy machine does not blur, else that on the wall.
fn spent(wall: bool) -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    let on_the_wall = START.get_or_init(Instant::now).elapsed();
    let of_thread = |task: std::io::Result<std::fs::DirEntry>| -> Option<u64> {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse().ok()
    };
    match std::fs::read_dir("/proc/self/task") {
        Ok(tasks) if !wall => 1e-9 * tasks.filter_map(of_thread).sum::<u64>() as f64,
        _ => on_the_wall.as_secs_f64(),
    }
}

/// Best of a few tries, on all threads, in floating-point operations a second.
fn peak(wall: bool) -> f64 {
    let threads = rayon::current_num_threads();
    let once = |_| {
        let start = spent(wall);
        let work: f64 = (0..threads)
            .into_par_iter()
            .map(|_| Arch::new().dispatch(Peak { rounds: 2_000_000 }))
            .sum();
        work / (spent(wall) - start)
    };
    (0..7).map(once).fold(0.0, f64::max)
}

/// Best epoch of a training with that batch size, in rows a second.
fn rate(wall: bool, given: &[TrainingDrive<'_>], batch_size: usize) -> f64 {
    let settings = TrainSettings {
        heads: HeadsKind::Paper,
        epochs: 12,
        batch_size,
        validation_fraction: 0.0,
        ..TrainSettings::default()
    };
    let mut last = spent(wall);
    let mut best = f64::INFINITY;
    let mut seen = 0;
    let trained = train(given, &settings, 1, &mut |_| {
        seen += 1;
        if seen > 1 {
            best = best.min(spent(wall) - last);
        }
        last = spent(wall);
        ControlFlow::Continue(())
    })
    .expect("drives long enough");
    trained.report.networks.map_or(0, |n| n.rows) as f64 / best
}

fn main() {
    let drives = drives::drivers(38, 600.0);
    let given: Vec<_> = drives.iter().map(TrainingDrive::from).collect();
    let per_row = TrainSettings::default().architecture().operations_per_row();
    let wall = std::env::args().all(|argument| argument != "--processor-time");
    let before = peak(wall);
    let rates = [256, 512, 1024, 4096].map(|batch| (batch, rate(wall, &given, batch)));
    let peak = before.max(peak(wall));
    println!(
        "{} threads, peak {:.0} GFLOP/s, {:.1} kFLOP a row",
        rayon::current_num_threads(),
        peak / 1e9,
        per_row / 1e3
    );
    for (batch, rate) in rates {
        println!(
            "batch {batch:>5}: {:>8.0} rows/s, {:>4.0} GFLOP/s, {:>3.0}% of the peak",
            rate,
            rate * per_row / 1e9,
            100.0 * rate * per_row / peak
        );
    }
}
