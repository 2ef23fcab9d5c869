//! A model of one number: the larger, the faster and the closer.

use maveric_model::{HEADS, Model};
use serde_json::json;

/// Free speed 27 m/s and 4 m/s more a unit of the style, which its score follows by 10 points a unit.
pub(crate) fn model() -> Model {
    let heads = HEADS.iter().map(|head| {
        let (common, slope) = match head.name {
            "free_speed_mps" => (vec![27.0], 4.0),
            "following_gap_s" => (vec![1.8_f64.ln(), 0.0], -0.2),
            "move_out_s" => (vec![1.5_f64.ln()], -0.2),
            "merge_back_s" => (vec![0.0], -0.2),
            "pass" => (vec![-2.0, 1.0], 0.5),
            _ => (vec![4.0, 0.0], 0.5),
        };
        json!({"name": head.name, "family": head.family, "common": common, "slopes": [slope], "between_sd": 1.0, "within_sd": 1.0, "events": 9, "drives": 3})
    });
    let heads: Vec<_> = heads.collect();
    // A population so wide that every drive is inside it.
    let n = HEADS.len();
    let covariance: Vec<f64> =
        (0..n * n).map(|at| if at % (n + 1) == 0 { 100.0 } else { 0.0 }).collect();
    serde_json::from_value(json!({
        "embedding_size": 1,
        "score_range": [11.0, 55.0],
        "training": [],
        "population": {"people": 3, "mean": vec![0.0; n], "covariance": covariance},
        "posted": {"free_speed": "absolute", "lowest_mps": 20.0, "highest_mps": 40.0, "mean_mps": 30.0},
        "heads": {"linear": {
            "heads": heads,
            "style": {
                "gradient": [10.0], "offset": 30.0, "covariance": [0.01, 0.0, 0.0, 0.01], "reading_sd": 1.0,
                "cross_fitted_rmse": null, "cross_fitted_r": null, "people": 3, "drives": 3,
            },
        }},
    }))
    .expect("a model of the present format")
}
