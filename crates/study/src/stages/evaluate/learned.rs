//! The model's networks as what drives in a driver's place.

use maveric_domain::Embedding;
use maveric_following::{
    Baselines, ClosedLoopStudy, Contender, DistanceLaw, FollowingMethod, FollowingRun,
    FollowingSettings, InPlaceOf, KeepDistance, OpenLoop, Predicted, distance_rmse_m,
    predicted_speeds_mps, simulate, speed_rmse_mps, straight_line, velocity_law,
};
use maveric_model::{Model, ModelError, Predictor, WindowBuffer};

/// Time over which the rate of the gap is taken, in s.
const GAP_RATE_S: f64 = 0.2;

/// A model with every driver's embedding, and the mean one, built in.
pub(super) struct Learned {
    own: Vec<Predictor>,
    mean: Predictor,
    window: WindowBuffer,
}

impl Learned {
    pub(super) fn new(model: &Model, own: &[Embedding]) -> Result<Self, ModelError> {
        Ok(Self {
            own: own
                .iter()
                .map(|w| Predictor::new(model, w))
                .collect::<Result<_, _>>()?,
            mean: Predictor::new(model, model.mean_embedding())?,
            window: model.window_buffer(),
        })
    }

    /// F of each driver with the own and with the mean embedding.
    pub(super) fn distances(&self) -> (Vec<DistanceLaw<'_>>, Vec<DistanceLaw<'_>>) {
        let by = |predictor: &'_ Predictor| -> DistanceLaw<'_> {
            let predictor = predictor.clone();
            Box::new(move |speed| predictor.following_distance(speed))
        };
        let mean = self.own.iter().map(|_| by(&self.mean)).collect();
        (self.own.iter().map(by).collect(), mean)
    }

    /// V alone, and the smaller of V's and F's commands, with the own embedding.
    pub(super) fn velocity<'a>(
        &'a self,
        runs: &[FollowingRun],
        baselines: &'a Baselines,
        settings: &'a FollowingSettings,
    ) -> Vec<Contender<'a>> {
        let entered = |method: FollowingMethod, with_distance: bool| {
            let driver = |at: usize| -> InPlaceOf<'a> {
                let (predictor, laws) = (&self.own[at], &baselines.drivers[at]);
                Box::new(move |stretch| {
                    let distance = with_distance.then_some(KeepDistance {
                        distance_m: |lead| predictor.following_distance(lead),
                        gains: laws.helly_population.law.gains,
                        safety: settings.safety,
                    });
                    let law = velocity_law(predictor, self.window.clone(), stretch, distance);
                    simulate(stretch, method.as_str(), law)
                })
            };
            Contender {
                method,
                drivers: (0..runs.len()).map(driver).collect(),
            }
        };
        vec![
            entered(FollowingMethod::VelocityOwn, false),
            entered(FollowingMethod::VelocityAndDistanceOwn, true),
        ]
    }

    /// What each predicts from the recorded past, without driving.
    pub(super) fn open_loop<'a>(
        &'a self,
        runs: &[FollowingRun],
        baselines: &Baselines,
        settings: &FollowingSettings,
    ) -> Vec<OpenLoop> {
        let above = settings.moving_above_mps;
        let row = |predicted, by: &str, of: &dyn Fn(usize) -> Option<f64>| {
            OpenLoop::new(predicted, by, (0..runs.len()).map(of).collect())
        };
        let speed = |by: &str, of: &dyn Fn(&FollowingRun, usize) -> f64| {
            row(Predicted::Speed, by, &|at| {
                speed_rmse_mps(&runs[at].test(), |row| of(&runs[at], row))
            })
        };
        let v = |by: &str, predictor: &dyn Fn(usize) -> &'a Predictor| {
            row(Predicted::Speed, by, &|at| {
                let test = runs[at].test();
                let found = predicted_speeds_mps(predictor(at), self.window.clone(), &test);
                speed_rmse_mps(&test, |row| found[row - test.rows().start])
            })
        };
        let gap = |by: &str, of: &dyn Fn(usize, f64) -> f64| {
            row(Predicted::Gap, by, &|at| {
                distance_rmse_m(&runs[at].test(), above, |lead| of(at, lead))
            })
        };
        let lines: Vec<Option<(f64, f64)>> = runs
            .iter()
            .map(|run| straight_line(&run.fit(), above))
            .collect();
        vec![
            speed("lead speed copied", &|run, row| {
                run.columns().lead_speed_mps[row]
            }),
            v("V, own embedding", &|at| &self.own[at]),
            v("V, mean embedding", &|_| &self.mean),
            speed("lead speed less the gap's rate", &|run, row| {
                let c = run.columns();
                let back = ((GAP_RATE_S * run.rate_hz()).round() as usize).clamp(1, row);
                let rate = (c.gap_m[row] - c.gap_m[row - back]) * run.rate_hz() / back as f64;
                c.lead_speed_mps[row] - rate
            }),
            speed("own speed one row ago", &|run, row| {
                run.columns().ego_speed_mps[row - 1]
            }),
            gap("own mean time gap x lead speed", &|at, lead| {
                baselines.drivers[at].constant_time_gap_own.time_gap_s * lead
            }),
            gap("own straight line", &|at, lead| {
                lines[at].map_or(f64::NAN, |(zero, slope)| zero + slope * lead)
            }),
            gap("F, own embedding", &|at, lead| {
                self.own[at].following_distance(lead)
            }),
            gap("F, mean embedding", &|_, lead| {
                self.mean.following_distance(lead)
            }),
        ]
    }
}

/// The first seed's network, with own and with mean embedding.
pub(super) fn closed_loop(study: &ClosedLoopStudy) -> [Contender<'_>; 2] {
    let network = &study.network;
    let by = |method: FollowingMethod, w: &'_ [f64]| -> InPlaceOf<'_> {
        let w = w.to_vec();
        Box::new(move |stretch| {
            let law = |g, v, lead| network.accel_mps2(&w, g, v, lead);
            simulate(stretch, method.as_str(), law)
        })
    };
    let (own, mean) = (
        FollowingMethod::ClosedLoopOwn,
        FollowingMethod::ClosedLoopMean,
    );
    let all = || study.embeddings.iter();
    [
        Contender {
            method: own,
            drivers: all().map(|w| by(own, w)).collect(),
        },
        Contender {
            method: mean,
            drivers: all().map(|_| by(mean, network.mean_embedding())).collect(),
        },
    ]
}
