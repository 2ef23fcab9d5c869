//! Random tables, most of them odd, through every analysis of a within-subject design.
//!
//! `cargo run --release -p maveric-stats --example fuzz_within [SECONDS]`; 60 by default. A table may be refused; an answer
//! may hold no NaN or infinity, no p of 0, and no missing number without a reason. A panic ends the run.
#![expect(clippy::print_stdout, reason = "an example shows what it found on the terminal")]

use maveric_stats::{
    Adjustment, CorrelationMethod, PosthocTest, WithinSubjects, alpha, compare, correlate, levene,
    normality, posthoc, rm_correlation, within,
};
use rand::Rng;
use rand_pcg::Pcg64;
use serde_json::Value;
use std::time::{Duration, Instant};

const ODD: [f64; 12] =
    [0.0, -0.0, 1e-300, 5e-324, 1e75, -1e75, 1e76, f64::NAN, f64::INFINITY, 0.1, 0.3, 1e12];

struct Draws(Pcg64);

impl Draws {
    fn below(&mut self, limit: u32) -> u32 {
        self.0.next_u32() % limit
    }

    fn uniform(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 4_294_967_296.0
    }

    fn value(&mut self, kind: u32, offset: f64) -> Option<f64> {
        let u = self.uniform();
        match self.below(60) {
            0 if kind > 5 => return None,
            1 if kind > 5 => return Some(ODD[self.below(12) as usize]),
            _ => {}
        }
        Some(match kind % 6 {
            0 => offset + u,
            1 => offset + (u * 4.0).floor(),
            2 => ((u * 100.0).round() / 10.0) + offset,
            3 => (u - 0.5).powi(9) * 1e20,
            4 => f64::from_bits(u64::from(self.0.next_u32()) << 32 | u64::from(self.0.next_u32())),
            _ => 3.0,
        })
    }
}

/// Names below which something is wrong.
fn faults(value: &Value, name: &str, root: &Value, messages: &mut Vec<String>) {
    match value {
        Value::Object(map) => {
            for (key, inner) in map.iter().filter(|(key, _)| *key != "undefined") {
                let dot = if name.is_empty() { "" } else { "." };
                faults(inner, &format!("{name}{dot}{key}"), root, messages);
            }
        }
        Value::Array(list) => {
            for (i, inner) in list.iter().enumerate() {
                faults(inner, &format!("{name}.{i}"), root, messages);
            }
        }
        // JSON has neither NaN nor infinity: they are written as null.
        Value::Null => {
            let has_reason = root["undefined"].as_object().is_some_and(|reasons| {
                reasons.keys().any(|key| {
                    let rest = name.strip_prefix(key.as_str());
                    rest.is_some_and(|r| r.is_empty() || r.starts_with('.'))
                })
            });
            if !has_reason {
                messages.push(format!("{name} is null without a reason"));
            }
        }
        Value::Number(n) if name.rsplit('.').next() == Some("p") && n.as_f64() == Some(0.0) => {
            messages.push(format!("{name} is exactly 0"));
        }
        _ => {}
    }
}

fn main() {
    let seconds = std::env::args().nth(1).and_then(|text| text.parse().ok());
    let end = Instant::now() + Duration::from_secs(seconds.unwrap_or(60));
    let mut draws = Draws(Pcg64::new(7, 7));
    let (mut tables, mut refused, mut wrong) = (0_u64, 0_u64, 0_u64);
    while Instant::now() < end {
        let (n, k) = (1 + draws.below(9), 1 + draws.below(5));
        let kind = draws.below(12);
        let offset = [0.0, 1.0, 1e9, -1e12, 1e-9][draws.below(5) as usize];
        let (mut subjects, mut conditions, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for cell in 0..n * k {
            subjects.push(format!("s{}", cell / k));
            conditions.push(format!("c{}", cell % k));
            values.push(draws.value(kind, offset));
        }
        tables += 1;
        let mut answers: Vec<Value> = Vec::new();
        match WithinSubjects::from_long(&subjects, &conditions, &values) {
            Err(_) => refused += 1,
            Ok(data) => {
                answers.extend(serde_json::to_value(within(&data)));
                answers.extend(
                    compare(&data, 0.05).ok().map(serde_json::to_value).and_then(Result::ok),
                );
                for test in [
                    PosthocTest::T,
                    PosthocTest::PooledT,
                    PosthocTest::Wilcoxon,
                    PosthocTest::Conover,
                    PosthocTest::Nemenyi,
                ] {
                    let result = posthoc(&data, test, Adjustment::Bh, 0.05);
                    answers.extend(result.ok().map(serde_json::to_value).and_then(Result::ok));
                }
            }
        }
        let (x, y) = values.split_at(values.len() / 2);
        let y = &y[..x.len()];
        let others = [
            correlate(x, y, CorrelationMethod::All, None).ok().map(serde_json::to_value),
            rm_correlation(&subjects[..x.len()], x, y).ok().map(serde_json::to_value),
            normality(&values).ok().map(serde_json::to_value),
            levene(&conditions, &values).ok().map(serde_json::to_value),
            alpha(&[("x", x), ("y", y)], None).ok().map(serde_json::to_value),
        ];
        answers.extend(others.into_iter().flatten().flatten());
        for answer in &answers {
            let mut messages = Vec::new();
            faults(answer, "", answer, &mut messages);
            wrong += messages.len() as u64;
            for fault in messages.iter().take(3).filter(|_| wrong < 30) {
                println!("{fault}: {values:?}, {k} conditions");
            }
        }
    }
    println!("{tables} tables, {refused} of them refused as designs: {wrong} faults");
}
