//! An evaluation as tables and sentences, for its page and for a terminal.

use maveric_following::{FollowingEvaluation, Shrinkage};
use maveric_report::{
    markup,
    tables::{Cell, Table},
};

/// The errors of every method, means over drivers.
pub(crate) fn following_table(found: &FollowingEvaluation, data_set: &str) -> Table {
    let drivers = found.drivers.len();
    let title = "Following in closed loop on the unseen last third";
    Table::of("following-errors", title, &found.means)
        .text("Model", |mean| {
            let best = if found.is_best(mean.method) { " *" } else { "" };
            format!("{}{best}", mean.method.label())
        })
        .right("Gap RMSE (m)", |mean| Cell::number(Some(mean.gap_rmse_m), 2))
        .right("Median (m)", |mean| Cell::number(Some(mean.gap_rmse_median_m), 2))
        .right("Speed RMSE (m/s)", |mean| Cell::number(Some(mean.speed_rmse_mps), 2))
        .right("Gap NRMSE", |mean| Cell::number(Some(mean.nrmse), 3))
        .right("Mixed error", |mean| Cell::number(Some(mean.mixed), 3))
        .right("Gap reached 0", |mean| Cell::text(format!("{}/{drivers}", mean.reached_zero)))
        .noted(format!(
            "{}, *n* = {drivers} drivers, each with the same weight. Recorded is only the vehicle \
             ahead; nothing of the last third was read before it but by the floor. The asterisk marks \
             the least error of the gap among those that know the driver's first two thirds, and among \
             those that are the same for everybody. No test.",
            markup::literal(data_set)
        ))
}

/// Two methods driver by driver.
pub(crate) fn compared(found: &FollowingEvaluation) -> Table {
    Table::of("following-compared", "Two models driver by driver", &found.compared)
        .text("Model", |pair| pair.method.label())
        .text("less", |pair| pair.beside.label())
        .right("Mean (m)", |pair| Cell::number(Some(pair.mean_m), 2))
        .right("2.5 %", |pair| Cell::number(pair.low_m, 2))
        .right("97.5 %", |pair| Cell::number(pair.high_m, 2))
        .right("Median (m)", |pair| Cell::number(Some(pair.median_m), 2))
        .right("Nearer", |pair| Cell::count(pair.better))
        .right("Further", |pair| Cell::count(pair.worse))
        .noted(
            "Root-mean-square error of the gap under one model less that under the other. Interval of the mean: bootstrap, \
             drivers drawn with replacement; with a handful of drivers it is too narrow. A few drivers carry a mean: the median \
             and the counts say how many. No test.",
        )
}

/// How much of what was fitted to a person was believed.
pub(crate) fn shrinkage(found: &FollowingEvaluation) -> Vec<String> {
    let one = |what: &str, s: &Shrinkage| {
        let strength = s
            .strength_s
            .map_or_else(|| "no bound".to_owned(), |k| format!("{k:.0} s"));
        format!(
            "Shrunken is the own {what} towards what people are like, by how far {} people moved between the halves of their fit \
             rows: strength {strength}; of a fit to {:.0} s {:.0} % is kept.",
            s.people,
            2.0 * s.half_s,
            100.0 * s.share(2.0 * s.half_s)
        )
    };
    let network = found.closed_loop.as_ref().and_then(|c| c.trained.first());
    std::iter::once(one("time gap", &found.time_gap_shrinkage))
        .chain(network.map(|n| one("embedding", &n.shrinkage)))
        .collect()
}
