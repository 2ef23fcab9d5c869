//! Made-up input for every figure and table. The numbers come from sines and mean nothing.

use maveric_domain::condition::Condition;
use maveric_report::claims::{join, load};
use maveric_report::figures::{
    Context, Figure, ablation, aggression_line, architecture, calibration, car_following,
    dial_sweep, difference_panels, domain, embedding_space, fidelity, following_errors,
    learning_curve, perpendicular, preference, residuals, simulator_view, training_curves,
};
use maveric_report::html::{
    Input, Live, LiveContent, Methods, ParameterFile, Provenance, Section, SpaceDrive, SpacePerson,
    StyleSpace,
};
use maveric_report::tables::{
    AccuracyRow, Coefficient, Correlation, CorrelationRow, Exclusion, Table, correlations,
    mimic_accuracy,
};
use maveric_report::{Report, ReportError, apa};
use std::{collections::BTreeMap, f64::consts::TAU};

const PARTICIPANTS: usize = 24;

/// A number between −1 and 1 that looks like chance.
fn wobble(a: usize, b: usize) -> f64 {
    let x = (a as f64 * 12.989_8 + b as f64 * 78.233).sin() * 43_758.545_3;
    let y = (a as f64 * 39.346 + b as f64 * 11.135).sin() * 24_634.634_5;
    (x - x.floor()) + (y - y.floor()) - 1.0
}

pub(crate) fn figures(context: &Context) -> Result<Vec<Figure>, ReportError> {
    Ok(vec![
        domain(context)?,
        architecture(&network(), context)?,
        simulator_view(&moment(), context)?,
        embedding_space(&space(3), context)?,
        aggression_line(&line(), context)?,
        difference_panels(&differences(), context)?,
        perpendicular(&round_the_ellipse(), context)?,
        preference(&preferences(), context)?,
        training_curves(&training(), context)?,
        calibration(&probabilities(), context)?,
        residuals(&left_over(), context)?,
        learning_curve(&minutes(), context)?,
        ablation(&variants(), context)?,
        fidelity(&accuracies(), context)?,
        dial_sweep(&sweep(), context)?,
        car_following(&following(), context)?,
        following_errors(&errors(), context)?,
    ])
}

fn network() -> architecture::Architecture {
    architecture::Architecture {
        embedding: 3,
        window_steps: 20,
        following_distance: vec![4, 64, 64, 1],
        lane_encoder: vec![60, 64, 16],
        lane_change: vec![19, 64, 64, 2],
        speed_encoder: vec![60, 64, 16],
        velocity: vec![19, 64, 64, 1],
        style: vec![3, 1],
        mutual_information: vec![37, 64, 64, 6],
    }
}

fn moment() -> simulator_view::SimulatorView {
    let vehicle = |x_m, y_m, heading_rad, speed_mps| simulator_view::VehicleView {
        x_m,
        y_m,
        heading_rad,
        speed_mps,
        length_m: 4.6,
        width_m: 1.9,
    };
    simulator_view::SimulatorView {
        participant: "P07".into(),
        condition: Condition::Aggressive,
        time_s: 83.2,
        lanes: 2,
        lane_width_m: 3.66,
        ego: vehicle(2000.0, 0.5, 0.03, 29.4),
        others: vec![
            vehicle(2039.0, 0.0, 0.0, 22.1),
            vehicle(1958.0, 3.66, 0.0, 31.0),
            vehicle(2094.0, 3.66, 0.0, 30.2),
            vehicle(2700.0, 0.0, 0.0, 27.0),
        ],
        reference: Some(0),
        trail_m: (0..40)
            .map(|k| (1940.0 + 1.5 * f64::from(k), 0.0))
            .collect(),
        plan_m: (0..60)
            .map(|k| {
                let s = f64::from(k) / 59.0;
                (2002.0 + 90.0 * s, 0.5 + 3.16 * s * s * (3.0 - 2.0 * s))
            })
            .collect(),
    }
}

pub(crate) fn space(size: usize) -> embedding_space::EmbeddingSpace {
    let points = (0..38)
        .map(|i| {
            let embedding: Vec<f64> = (0..size).map(|k| 1.6 * wobble(i, k)).collect();
            let along = embedding.iter().sum::<f64>();
            embedding_space::EmbeddingPoint {
                adb_points: (28.0 + 6.0 * along + 3.0 * wobble(i, 90)).clamp(11.0, 55.0),
                mean_velocity_mps: 28.5 + 1.2 * along + wobble(i, 91),
                embedding,
            }
        })
        .collect();
    let gradient = [0.9, 0.5, 0.6];
    let unit = gradient.map(|g: f64| g / 1.42_f64.sqrt());
    let mimic = [0.2, -0.4, 0.1];
    let shifted = |t: f64| (0..3).map(|k| mimic[k] + t * unit[k]).collect::<Vec<f64>>();
    let a = [unit[1], -unit[0], 0.0].map(|x| x / unit[0].hypot(unit[1]));
    let b = [
        unit[1] * a[2] - unit[2] * a[1],
        unit[2] * a[0] - unit[0] * a[2],
        unit[0] * a[1] - unit[1] * a[0],
    ];
    let round = |angle: f64| {
        (0..3)
            .map(|k| mimic[k] + 0.9 * angle.cos() * a[k] + 0.9 * angle.sin() * b[k])
            .collect()
    };
    embedding_space::EmbeddingSpace {
        points,
        gradient: gradient.to_vec(),
        example: Some(embedding_space::ExampleConditions {
            participant: "P07".into(),
            mimic: mimic.to_vec(),
            aggressive: shifted(1.5),
            cautious: shifted(-1.5),
            perpendicular: Some(round(0.9)),
            ellipse: (0..48).map(|k| round(TAU * f64::from(k) / 48.0)).collect(),
        }),
    }
}

fn line() -> aggression_line::AggressionLine {
    let panel = |index: usize, title: &str, axis: &str, centre: f64, slope: f64, noise: f64| {
        aggression_line::LinePanel {
            title: title.into(),
            axis: axis.into(),
            points: (0..PARTICIPANTS)
                .map(|i| {
                    let x = 1.8 * wobble(i, 7);
                    (x, centre + slope * x + noise * wobble(i, 40 + index))
                })
                .collect(),
            statistic: apa::r(0.3 * slope.signum(), 22, 0.154).markup().to_owned(),
        }
    };
    aggression_line::AggressionLine {
        panels: vec![
            panel(0, "Mean velocity", "Mean velocity (mph)", 65.0, 2.6, 6.0),
            panel(
                1,
                "Mean headway time",
                "Mean headway time (s)",
                1.8,
                -0.22,
                0.7,
            ),
            panel(
                2,
                "Distance headway merge back",
                "Distance (m)",
                46.0,
                -5.0,
                16.0,
            ),
            panel(
                3,
                "Number of lane changes",
                "Lane changes (count)",
                9.0,
                1.1,
                3.0,
            ),
            panel(4, "Time headway merge back", "Time (s)", 1.5, -0.2, 0.5),
            panel(
                5,
                "Self-reported aggression",
                "ADB score (points)",
                29.0,
                6.0,
                5.0,
            ),
        ],
    }
}

fn differences() -> difference_panels::DifferencePanels {
    let omnibus = apa::f(&apa::F {
        f: 25.23,
        df_effect: 2.76,
        df_error: 63.49,
        p: 1e-9,
        eta2_partial: Some(0.52),
        interval: None,
        epsilon: Some(0.92),
    });
    let friedman = apa::chi2(41.19, 3, 24, 1e-8, Some(0.57));
    let pair = |second, p_holm| difference_panels::PairTest {
        first: Condition::Mimic,
        second,
        p_holm,
    };
    let panel = |index: usize, title: &str, axis: &str, step: f64, noise: f64, reference: f64| {
        let shift = [0.0, step, -step, 0.1 * step];
        difference_panels::DifferencePanel {
            title: title.into(),
            axis: axis.into(),
            conditions: Condition::AV.to_vec(),
            rows: (0..PARTICIPANTS)
                .map(|i| {
                    (0..4)
                        .map(|c| {
                            let value = reference
                                + shift[c]
                                + noise * (wobble(i, 8 * index) + wobble(i, c + 8 * index));
                            // Two participants never merged back in one condition.
                            (index != 2 || i > 1 || c != 2).then_some(value)
                        })
                        .collect()
                })
                .collect(),
            omnibus: if index == 3 {
                friedman.markup()
            } else {
                omnibus.markup()
            }
            .to_owned(),
            pairs: vec![
                pair(Condition::Aggressive, 0.0002),
                pair(Condition::Cautious, 0.017),
                pair(Condition::Perpendicular, 0.62),
            ],
            reference: Some(reference),
        }
    };
    difference_panels::DifferencePanels {
        panels: vec![
            panel(0, "Mean velocity", "Difference (mph)", 4.5, 1.6, 0.0),
            panel(1, "Mean headway time", "Difference (s)", -0.3, 0.35, 0.0),
            panel(
                2,
                "Distance headway merge back",
                "Difference (m)",
                -10.0,
                6.0,
                0.0,
            ),
            panel(
                3,
                "Number of lane changes",
                "Difference (count)",
                1.6,
                1.4,
                0.0,
            ),
            panel(
                4,
                "Time headway merge back",
                "Difference (s)",
                -0.4,
                0.3,
                0.0,
            ),
            panel(
                5,
                "Subjective aggressiveness",
                "Rating (1 to 7; 4 = as I drive)",
                1.0,
                0.6,
                4.0,
            ),
        ],
    }
}

fn round_the_ellipse() -> perpendicular::PerpendicularChanges {
    let panel = |index: usize, title: &str, axis: &str, size: f64, statistic: apa::Statement| {
        perpendicular::PerpendicularPanel {
            title: title.into(),
            axis: axis.into(),
            points: (0..PARTICIPANTS)
                .map(|i| {
                    let angle_rad = TAU * f64::midpoint(wobble(i, 3), 1.0);
                    let change =
                        size * ((angle_rad + index as f64).sin() + 0.7 * wobble(i, 60 + index));
                    perpendicular::AngleChange { angle_rad, change }
                })
                .collect(),
            statistic: statistic.markup().to_owned(),
        }
    };
    perpendicular::PerpendicularChanges {
        panels: vec![
            panel(
                0,
                "Minimum headway distance",
                "Change from Mimic (m)",
                6.0,
                apa::r(0.61, 22, 0.0015),
            ),
            panel(
                1,
                "Fraction of time in the left lane",
                "Change from Mimic (share)",
                0.11,
                apa::r(-0.4, 22, 0.053),
            ),
        ],
    }
}

fn preferences() -> preference::Preferences {
    let scale = |scale: &str, aggressive_above, cautious_above| preference::ScalePreference {
        scale: scale.into(),
        n: PARTICIPANTS,
        aggressive_above,
        cautious_above,
    };
    preference::Preferences {
        scales: vec![
            scale("Trust", 6, 12),
            scale("Competence", 7, 13),
            scale("Intelligence", 5, 9),
            scale("Discomfort", 9, 11),
            scale("Similarity", 3, 0),
        ],
    }
}

fn training() -> training_curves::TrainingCurves {
    let term = |index: usize, title: &str, from: f64, to: f64| {
        let curve = |lag: f64, noise: usize| {
            (0..40)
                .map(|e| {
                    to + (from - to) * (-f64::from(e) / lag).exp()
                        + 0.02 * to * wobble(e as usize, noise + index)
                })
                .collect()
        };
        training_curves::LossTerm {
            title: title.into(),
            train: curve(6.0, 5),
            validation: curve(7.5, 25),
        }
    };
    training_curves::TrainingCurves {
        terms: vec![
            term(0, "*L*_{1}  following distance", 1.1, 0.3),
            term(1, "*L*_{2}  lane change", 0.69, 0.35),
            term(2, "*L*_{3}  velocity", 1.0, 0.06),
            term(3, "*L*_{4}  style", 1.0, 0.04),
            term(4, "*L*_{5}  mutual information", 1.3, 0.2),
        ],
        drives: 38,
    }
}

fn probabilities() -> calibration::Calibration {
    let bins = (0..8).map(|k| {
        let predicted = 0.004 * 1.9_f64.powi(k);
        calibration::CalibrationBin {
            predicted,
            observed: predicted * (1.0 + 0.2 * wobble(k as usize, 3)),
            seconds: 6000.0 / f64::from(1 + 3 * k),
        }
    });
    calibration::Calibration {
        bins: bins.collect(),
        expected_error: 0.0042,
        drives: 38,
        held_out: true,
    }
}

fn left_over() -> residuals::Residuals {
    let normal = [-2.33, -1.64, -1.28, -0.67, 0.0, 0.67, 1.28, 1.64, 2.33];
    let shares = [0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99];
    let panel = |title: &str, unit: &str, width: f64| residuals::ResidualPanel {
        title: title.into(),
        axis: format!("Predicted − recorded ({unit})"),
        unit: unit.into(),
        quantiles: shares
            .iter()
            .zip(normal)
            .map(|(share, z)| (*share, width * (z + 0.1)))
            .collect(),
        mean: 0.1 * width,
        rms: width,
        rows: 9000,
    };
    residuals::Residuals {
        panels: vec![
            panel("Following distance (F)", "m", 5.0),
            panel("Ego speed (V)", "m/s", 1.1),
        ],
        drives: 38,
        held_out: true,
    }
}

fn minutes() -> learning_curve::LearningCurve {
    let panel = |title: &str, axis: &str, from: f64, to: f64| learning_curve::LearningPanel {
        title: title.into(),
        axis: axis.into(),
        points: [1.0, 2.0, 5.0, 10.0]
            .map(|minutes: f64| {
                let mean = to + (from - to) / (1.0 + minutes);
                learning_curve::LearningPoint {
                    minutes,
                    mean,
                    low: 0.93 * mean,
                    high: 1.07 * mean,
                }
            })
            .to_vec(),
        before: Some(from),
    };
    learning_curve::LearningCurve {
        panels: vec![
            panel("*L*_{1} following", "loss", 0.9, 0.35),
            panel("*L*_{2} lane change", "loss", 0.42, 0.33),
            panel("*L*_{3} speed", "loss", 0.5, 0.21),
            panel("To the whole drive’s", "SD", 1.6, 0.0),
        ],
        drivers: PARTICIPANTS,
        judged_on: "Losses on the last third of each drive.".into(),
    }
}

fn variants() -> ablation::Ablation {
    let names = [
        "size 3",
        "size 1",
        "size 2",
        "size 5",
        "size 8",
        "without M",
        "without S",
        "Gaussian L5",
    ];
    let variants = names
        .iter()
        .enumerate()
        .map(|(v, name)| ablation::AblationVariant {
            name: (*name).to_owned(),
            losses: (0..3)
                .map(|loss| {
                    let of = |i: usize| {
                        0.4 + 0.05 * wobble(i, 7) + 0.01 * v as f64 * (1.0 + wobble(i + v, loss))
                    };
                    (0..38).map(|i| (i % 9 != loss).then(|| of(i))).collect()
                })
                .collect(),
        });
    ablation::Ablation {
        losses: ["following", "lane change", "speed"]
            .iter()
            .enumerate()
            .map(|(k, name)| format!("*L*_{{{}}} {name}", k + 1))
            .collect(),
        variants: variants.collect(),
        folds: 5,
    }
}

fn accuracies() -> fidelity::Fidelity {
    let names = [
        "Mean velocity",
        "Mean headway time",
        "Distance headway merge back",
        "Number of lane changes",
        "Time headway merge back",
    ];
    let around = |mean: f64| fidelity::Accuracy {
        mean,
        low: mean - 0.012,
        high: mean + 0.01,
    };
    fidelity::Fidelity {
        measures: names
            .iter()
            .enumerate()
            .map(|(k, name)| fidelity::FidelityRow {
                measure: (*name).to_owned(),
                mimic: around(0.98 - 0.04 * k as f64),
                test_retest: Some(around(0.985 - 0.03 * k as f64)),
                population: Some(around(0.92 - 0.07 * k as f64)),
                paper: (k != 3).then_some(0.9 - 0.02 * k as f64),
            })
            .collect(),
        drivers: PARTICIPANTS,
        seeds: 5,
    }
}

fn sweep() -> dial_sweep::DialSweep {
    let points: Vec<f64> = (-4..=4).map(|k| 5.0 * f64::from(k)).collect();
    let panel = |title: &str, axis: &str, mean: f64, slope: f64| dial_sweep::DialPanel {
        title: title.into(),
        axis: axis.into(),
        drivers: (0..PARTICIPANTS)
            .map(|i| {
                let own = mean * (1.0 + 0.1 * wobble(i, 31));
                let value = |k: usize| own + slope * points[k] + 0.01 * mean * wobble(i, k);
                (0..points.len())
                    .map(|k| ((i + k) % 37 != 0).then(|| value(k)))
                    .collect()
            })
            .collect(),
        statistic: "right way: 92% at +15, 88% at −15".into(),
    };
    dial_sweep::DialSweep {
        panels: vec![
            panel("Mean velocity", "mph", 65.0, 0.3),
            panel("Mean headway time", "s", 1.8, -0.012),
            panel("Distance headway merge back", "m", 46.0, -0.7),
            panel("Number of lane changes", "count", 9.0, 0.1),
            panel("Time headway merge back", "s", 1.5, -0.02),
        ],
        points,
    }
}

fn following() -> car_following::CarFollowing {
    use car_following::{Follower, FollowingSeries};
    let rows = 4000;
    let series = |follower, lag: f64, noise: f64| {
        let wave = |t: f64| ((t - lag) / 40.0).sin() + 0.5 * ((t - lag) / 13.0).sin();
        let at = |i: usize| i as f64 * 0.1;
        FollowingSeries {
            follower,
            gap_m: (0..rows)
                .map(|i| 34.0 + (14.0 + noise) * wave(at(i)) + noise * (at(i) / 7.0).sin())
                .collect(),
            speed_mps: (0..rows)
                .map(|i| 20.0 + (6.0 + 0.1 * noise) * wave(at(i) + 2.0))
                .collect(),
        }
    };
    car_following::CarFollowing {
        driver: "Made-up driver 1".into(),
        data_set: "Made-up recordings".into(),
        time_s: (0..rows).map(|i| 800.0 + i as f64 * 0.1).collect(),
        series: vec![
            series(Follower::Recorded, 0.0, 0.0),
            series(Follower::Model, 1.0, 1.5),
            series(Follower::Idm, 2.0, 3.0),
            series(Follower::ConstantTimeGap, 3.0, 6.0),
        ],
    }
}

fn errors() -> following_errors::FollowingErrors {
    use car_following::Follower;
    let model = |model, centre: f64, seed: usize| following_errors::ModelErrors {
        model,
        gap_rmse_m: (0..6)
            .map(|i| centre + 0.3 * centre * wobble(i, seed))
            .collect(),
    };
    following_errors::FollowingErrors {
        data_set: "Made-up recordings".into(),
        drivers: (1..=6).map(|i| format!("Made-up driver {i}")).collect(),
        models: vec![
            model(Follower::Model, 7.0, 1),
            model(Follower::MeanEmbedding, 12.0, 2),
            model(Follower::Idm, 7.5, 3),
            model(Follower::ConstantTimeGap, 10.6, 4),
        ],
    }
}

fn tables() -> Vec<Table> {
    let correlation = |coefficient, value, df, p| {
        Some(Correlation {
            coefficient,
            value,
            df,
            p,
        })
    };
    let accuracy = [
        ("Mean velocity", 0.96, 0.936),
        ("Mean headway time", 0.79, 0.802),
    ]
    .map(|(measure, ours, paper)| AccuracyRow {
        measure: measure.into(),
        n: PARTICIPANTS,
        ours: Some(ours),
        paper: Some(paper),
        population_mean: Some(0.8 * ours),
        test_retest: None,
    });
    vec![
        mimic_accuracy(&accuracy),
        correlations(
            &[CorrelationRow {
                independent: "Conscientiousness <script>".into(),
                dependent: "M−C competence".into(),
                ours: correlation(Coefficient::Spearman, -0.51, 22, 0.011),
                repeated: None,
                paper: correlation(Coefficient::Spearman, -0.71, 22, 0.0001),
            }],
            PARTICIPANTS,
        ),
    ]
}

fn style_space() -> StyleSpace {
    let at = |i: usize| [wobble(i, 1), wobble(i, 2), wobble(i, 3)].map(|v| 2.0 * v);
    let drive = |i: usize, name: String| SpaceDrive {
        name,
        at: at(i),
        adb_points: Some(33.0 + 20.0 * wobble(i, 4)),
        velocity_mph: 65.0 + 10.0 * wobble(i, 5),
    };
    StyleSpace {
        drives: (0..30)
            .map(|i| drive(i, format!("D{i:02} </script>")))
            .collect(),
        people: (40..46)
            .map(|i| SpacePerson {
                own: drive(i, format!("P{i} <b>&\u{202e}")),
                conditions: vec![
                    (Condition::Mimic, at(i)),
                    (Condition::Aggressive, at(i).map(|v| v + 0.8)),
                    (Condition::Cautious, at(i).map(|v| v - 0.8)),
                ],
            })
            .collect(),
        gradient: [1.0, 1.0, 1.0],
        ellipse: [[0.7, -0.7, 0.0], [0.4, 0.4, -0.8]],
    }
}

pub(crate) fn report(context: &Context) -> Result<Report, ReportError> {
    let claims = load(include_str!("../../../../study_data/claims.toml"))?;
    let results = BTreeMap::from([
        ("line.mean_velocity.r".to_owned(), 0.3),
        ("line.mean_velocity.p".to_owned(), 0.154),
        ("mimic_accuracy.mean_velocity".to_owned(), 96.0),
        ("participants.study2.n".to_owned(), 24.0),
        ("nearer.mean_velocity.aggressive.p".to_owned(), 0.02),
        ("nearer.mean_velocity.aggressive.direction".to_owned(), 1.0),
        ("correlation.openness.ma_discomfort.r".to_owned(), -0.1),
    ]);
    Ok(Report {
        title: "Gallery of made-up numbers".into(),
        subtitle: "Every figure and table that a report can have, drawn from sines.".into(),
        context: context.clone(),
        summary: vec![
            "Made up: position on the aggression line with ADB, *r*(22) = .30, *p* = .154".into(),
            "Made up: mimic accuracy of mean velocity, 96.0%".into(),
        ],
        sections: vec![
            Section {
                title: "Figures".into(),
                intro: vec!["All of these are drawn from sines, and mean nothing.".into()],
                figures: figures(context)?,
                tables: Vec::new(),
            },
            Section {
                title: "Tables".into(),
                tables: tables(),
                ..Section::default()
            },
        ],
        live: vec![Live {
            below: "embedding-space".into(),
            content: LiveContent::StyleSpace(style_space()),
        }],
        methods: Methods {
            text: vec!["Sines, wobbled.".into()],
            files: vec![ParameterFile {
                path: "study_data/effects.toml".into(),
                text: "# nothing\n[of]\nthis = \"<is> & used\"\n".into(),
            }],
        },
        ledger: Some(join(&claims, &results)?),
        exclusions: vec![Exclusion {
            who: "P03 \u{202e}<b>&".into(),
            what: "time headway merge back".into(),
            why: "never merged back in Cautious".into(),
        }],
        warnings: vec!["Two drives met only five of the six lead vehicles.".into()],
        provenance: Provenance {
            version: env!("CARGO_PKG_VERSION").into(),
            seed: context.seed,
            command: "cargo run -p maveric-report --example gallery -- FOLDER".into(),
            parameters: vec![
                ("window_s".into(), "4.0".into()),
                ("embedding.size".into(), "3".into()),
            ],
            inputs: vec![Input {
                path: "study_data/claims.toml".into(),
                hash: "0f1e2d3c4b5a".into(),
            }],
        },
    })
}
