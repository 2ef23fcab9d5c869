//! From a latent answer to a ticked box.

use maveric_domain::{Scale, Subscale, stream_seed, survey::Item};
use rand::{RngExt as _, SeedableRng as _};
use rand_distr::{Distribution as _, StandardNormal};
use rand_pcg::Pcg64;

/// A generator that belongs to `labels` alone.
pub(crate) fn stream(seed: u64, labels: &[&str]) -> Pcg64 {
    Pcg64::seed_from_u64(stream_seed(seed, labels))
}

/// One draw from N(0, 1).
pub(crate) fn normal(rng: &mut Pcg64) -> f64 {
    StandardNormal.sample(rng)
}

/// The box that is ticked for a latent answer in points, as scored: the nearest one within the range.
///
/// # Source
/// The graded-response model (Samejima 1969) in its normal-ogive form with equally spaced thresholds: an answer is
/// at least k where the latent answer exceeds k − ½.
pub(crate) fn grade(item: &Item, latent_points: f64) -> i32 {
    let (lowest, step) = (f64::from(item.min), f64::from(item.step));
    // `as` saturates, so the clamp sees any latent answer.
    let nearest = lowest + step * ((latent_points - lowest) / step).round();
    (nearest as i32).clamp(item.min, item.max)
}

/// The answer as given: reversed where the key reverses it back.
pub(crate) fn as_given(scale: &Scale, subscale: &Subscale, item: u32, scored: i32) -> i32 {
    match scale.item(item) {
        Some(asked) if scale.is_reversed(subscale, item) => asked.min + asked.max - scored,
        _ => scored,
    }
}

/// The answer, unless it is left out.
pub(crate) fn maybe_left_out(rng: &mut Pcg64, missing_rate: f64, answer: i32) -> Option<i32> {
    (!rng.random_bool(missing_rate)).then_some(answer)
}

/// Scored answers to these items that add up to `total`, scattered by about `item_sd` around their mean.
pub(crate) fn with_total(items: &[Item], total: i64, item_sd: f64, rng: &mut Pcg64) -> Vec<i32> {
    let sum_of = |answers: &[i32]| answers.iter().map(|&a| i64::from(a)).sum::<i64>();
    let ends = |end: fn(&Item) -> i32| sum_of(&items.iter().map(end).collect::<Vec<i32>>());
    let total = total.clamp(ends(|item| item.min), ends(|item| item.max));
    let mean = total as f64 / items.len() as f64;
    let mut answers: Vec<i32> =
        items.iter().map(|item| grade(item, mean + item_sd * normal(rng))).collect();
    loop {
        let step = (total - sum_of(&answers)).signum() as i32;
        let free: Vec<usize> =
            (0..items.len()).filter(|&i| items[i].takes(answers[i] + step)).collect();
        if step == 0 || free.is_empty() {
            return answers;
        }
        answers[free[rng.random_range(0..free.len())]] += step;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn scale() -> Scale {
        Scale::from_toml(maveric_data::SCALES_ADB).unwrap()
    }

    #[test]
    fn the_nearest_box_is_ticked_and_a_reversed_item_the_other_way() {
        let mut scale = scale();
        assert_eq!([0.4, 2.4, 2.5, 4.6, 9.0].map(|v| grade(&scale.items[0], v)), [1, 2, 3, 5, 5]);
        scale.items[1].reversed = true;
        let subscale = &scale.subscales[0];
        assert_eq!(as_given(&scale, subscale, 1, 4), 4);
        assert_eq!(as_given(&scale, subscale, 2, 4), 2);
        let left_out = (0..4000).filter(|i| {
            let mut rng = stream(7, &[&i.to_string()]);
            maybe_left_out(&mut rng, 0.25, 3).is_none()
        });
        assert!((900..1100).contains(&left_out.count()));
    }

    #[test]
    fn without_scatter_the_items_lie_beside_their_mean() {
        let sorted = |total| {
            let mut answers = with_total(&scale().items, total, 0.0, &mut stream(1, &["x"]));
            answers.sort_unstable();
            answers
        };
        assert_eq!(sorted(22), [2; 11]);
        assert_eq!(sorted(25), [2, 2, 2, 2, 2, 2, 2, 2, 3, 3, 3]);
    }

    proptest! {
        #[test]
        fn items_add_up_to_their_total(total in -20..80_i64, sd in 0.0..3.0_f64, seed: u64) {
            let answers = with_total(&scale().items, total, sd, &mut stream(seed, &["x"]));
            let sum: i64 = answers.iter().map(|&a| i64::from(a)).sum();
            prop_assert_eq!(sum, total.clamp(11, 55));
            prop_assert!(answers.iter().all(|a| (1..=5).contains(a)));
        }

        #[test]
        fn any_latent_answer_ticks_a_box(latent: f64) {
            prop_assert!((1..=5).contains(&grade(&scale().items[0], latent)));
        }
    }
}
