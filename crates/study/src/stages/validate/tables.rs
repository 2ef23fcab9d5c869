//! What was found, over all models, as tables.

use super::{Agreement, Examined, FULL, Metric, Right, mean};
use maveric_report::tables::{Cell, Column, Table};

/// Mean over the models and, in brackets, lowest and highest.
fn range(values: &[Option<f64>], decimals: usize) -> Cell {
    let known: Vec<f64> = values.iter().copied().flatten().collect();
    let Some(mean) = mean(&known) else {
        return Cell::Missing;
    };
    let low = known.iter().copied().fold(f64::INFINITY, f64::min);
    let high = known.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if known.len() == 1 || high - low < 1e-9 {
        Cell::number(Some(mean), decimals)
    } else {
        let text = format!("{mean:.decimals$} ({low:.decimals$} to {high:.decimals$})");
        Cell::text(text.replace('-', "−"))
    }
}

fn percent(values: &[Option<f64>]) -> Cell {
    let shares: Vec<Option<f64>> = values.iter().map(|v| v.map(|v| 100.0 * v)).collect();
    range(&shares, 1)
}

/// `of` of every model.
fn each<T>(models: &[Examined], of: impl Fn(&Examined) -> T) -> Vec<T> {
    models.iter().map(of).collect()
}

fn table(name: &str, title: &str, columns: &[&str], rows: Vec<Vec<Cell>>, note: String) -> Table {
    let columns = columns.iter().enumerate().map(|(i, &header)| match i {
        0 => Column::left(header),
        _ => Column::right(header),
    });
    Table {
        name: format!("validation-{name}"),
        title: title.to_owned(),
        columns: columns.collect(),
        rows,
        notes: vec![note],
    }
}

/// All tables over `models`, which were examined on the same people.
pub(super) fn tables(models: &[Examined], points: f64) -> Vec<Table> {
    let Some(one) = models.first() else {
        return Vec::new();
    };
    vec![
        identity(models, one),
        fidelity(models, one),
        likeness(models, one),
        dial(models, one, points),
        perpendicular(models, one),
        line(models, one),
    ]
}

fn identity(models: &[Examined], one: &Examined) -> Table {
    let rows = one.identity.iter().enumerate().map(|(i, row)| {
        let rate = each(models, |m| Some(m.identity[i].rate));
        let hits: f64 = rate.iter().flatten().sum::<f64>() / models.len() as f64 * row.n as f64;
        let whole = (hits.round() as usize).min(row.n);
        let interval = maveric_stats::proportion(whole, row.n, 0.95).ok();
        vec![
            Cell::text(row.what),
            Cell::text(match row.metric {
                Metric::Euclidean => "straight",
                Metric::WithinPerson => "within-person",
                Metric::Posterior => "posterior",
            }),
            percent(&rate),
            interval.map_or(Cell::Missing, |w| {
                Cell::text(format!("{:.0} to {:.0}", 100.0 * w.low, 100.0 * w.high))
            }),
            range(&each(models, |m| Some(m.identity[i].mean_rank)), 1),
        ]
    });
    let n = one.identity.first().map_or(0, |r| r.n);
    table(
        "identity",
        &format!("Identity: who of {n} is it? Nearest to the own first drive (%)"),
        &[
            "Compared with the first drive",
            "Distance",
            "Found",
            "95% of drivers",
            "Mean rank",
        ],
        rows.collect(),
        format!(
            "Fitted without the ADB score unless said. By chance {:.1}%, mean rank {:.1}. Mean over {} models, in brackets lowest and highest; \
             the interval is Wilson's for the mean rate of {n} drivers. Within-person: Mahalanobis distance by the covariance of two days of one \
             person over the training people; posterior: by what both fits leave open themselves.",
            100.0 / n as f64,
            f64::midpoint(n as f64, 1.0),
            models.len()
        ),
    )
}

fn fidelity(models: &[Examined], one: &Examined) -> Table {
    let rows = one.fidelity.iter().enumerate().map(|(i, row)| {
        let of =
            |value: fn(&super::Fidelity) -> Option<f64>| each(models, |m| value(&m.fidelity[i]));
        let fixed = |share: Option<f64>| Cell::number(share.map(|s| 100.0 * s), 1);
        vec![
            Cell::text(row.title),
            percent(&of(|f| f.mimic)),
            fixed(row.test_retest),
            percent(&of(|f| f.of_test_retest)),
            fixed(row.paper),
            fixed(row.population_mean),
            percent(&of(|f| f.mimic_bias)),
            fixed(row.test_retest_bias),
            percent(&of(|f| f.car_again)),
        ]
    });
    table(
        "fidelity",
        "Fidelity: the car in the own style against the driver’s own drive (%)",
        &[
            "Measure",
            "Car",
            "Same driver, second drive",
            "Car, of that",
            "Paper",
            "Training mean as guess",
            "Bias of the car",
            "Bias of second drive",
            "Car on another road",
        ],
        rows.collect(),
        "Accuracy: 1 − |found − own| / own, mean over drivers. Bias: mean of (found − own) / own. The car is driven once, from the embedding fitted \
         with the ADB score, as in the study; the last column holds it against itself on another road."
            .to_owned(),
    )
}

fn likeness(models: &[Examined], one: &Examined) -> Table {
    let rows = one.likeness.iter().enumerate().map(|(i, row)| {
        let of =
            |value: fn(&super::Likeness) -> Option<f64>| each(models, |m| value(&m.likeness[i]));
        vec![
            Cell::text(row.what),
            range(&of(|l| l.mmd2), 3),
            range(&of(|l| l.divergence), 2),
            percent(&of(|l| l.different)),
            percent(&of(|l| l.owner_nearest)),
            range(&of(|l| l.mean_rank), 1),
        ]
    });
    table(
        "likeness",
        "Likeness by distribution: windows of 5 s beside the owner’s first drive",
        &[
            "Drive",
            "MMD²",
            "Divergence (nats)",
            "Different, p < .05 (%)",
            "Owner nearest of all (%)",
            "Mean rank of the owner",
        ],
        rows.collect(),
        "Speed, time gap, acceleration, jerk and lateral place, each in SDs over all windows of people. MMD²: maximum mean discrepancy, Gaussian \
         kernel, unbiased, so about 0 for two drives of one distribution; p by 99 random splits. Divergence: Kullback-Leibler, from distances to the \
         fifth-nearest window. Nearest and rank by MMD² among the first drives of all people."
            .to_owned(),
    )
}

fn dial(models: &[Examined], one: &Examined, points: f64) -> Table {
    let rows = one.dial.iter().enumerate().map(|(i, row)| {
        let share = |of: fn(&super::Dial) -> &Right| each(models, |m| of(&m.dial[i]).share);
        let room = |of: fn(&super::Dial) -> &Right| {
            each(models, |m| {
                let right = of(&m.dial[i]);
                let n = right.with_room;
                (n > 0).then(|| right.right_with_room as f64 / n as f64)
            })
        };
        let tied =
            |of: fn(&super::Dial) -> &Right| each(models, |m| Some(of(&m.dial[i]).tied as f64));
        let change = |of: fn(&super::Dial) -> &Right| each(models, |m| of(&m.dial[i]).mean_change);
        let monotone = each(models, |m| m.dial[i].monotone == Some(true));
        vec![
            Cell::text(row.title),
            percent(&share(|d| &d.aggressive)),
            percent(&room(|d| &d.aggressive)),
            percent(&share(|d| &d.cautious)),
            range(&tied(|d| &d.aggressive), 1),
            range(&tied(|d| &d.cautious), 1),
            range(&change(|d| &d.aggressive), 2),
            range(&change(|d| &d.cautious), 2),
            percent(&each(models, |m| m.dial[i].rising)),
            range(&each(models, |m| m.dial[i].mean_tau), 2),
            Cell::text(format!(
                "{} of {}",
                monotone.iter().filter(|m| **m).count(),
                models.len()
            )),
        ]
    });
    let beyond: Vec<f64> = models.iter().filter_map(|m| m.beyond_training).collect();
    let ends = (one.steps.first(), one.steps.last());
    table(
        "dial",
        &format!("Dial: drivers for whom ±{points} points do what they should (%)"),
        &[
            "Measure",
            "Aggressive right",
            "of those with room",
            "Cautious right",
            "Aggressive: ties",
            "Cautious: ties",
            "Aggressive: change",
            "Cautious: change",
            "Rising",
            "Kendall’s τ",
            "Mean curve monotone",
        ],
        rows.collect(),
        format!(
            "No change is a tie and counts as wrong; a driver without a value at a setting is left out there. With room: for more lane changes, \
             those who make fewer than {FULL} of twelve at 0; for the rest everybody. Rising: drivers whose Spearman’s ρ over {} settings \
             from {} to {} points has the right sign; τ: mean over drivers, 1 being a perfect dial. Changes in the measure’s unit. {:.1}% of the \
             embeddings driven lie further out than any training driver.",
            one.steps.len(),
            ends.0.copied().unwrap_or_default(),
            ends.1.copied().unwrap_or_default(),
            100.0 * mean(&beyond).unwrap_or(0.0)
        ),
    )
}

fn perpendicular(models: &[Examined], one: &Examined) -> Table {
    let rows = one.perpendicular.iter().enumerate().map(|(i, row)| {
        let of =
            |value: fn(&super::Across) -> Option<f64>| each(models, |m| value(&m.perpendicular[i]));
        let decimals = if row.measure == "left_lane_fraction" {
            3
        } else {
            2
        };
        let small = of(|a| a.angle_p)
            .into_iter()
            .flatten()
            .filter(|p| *p < 0.05)
            .count();
        vec![
            Cell::text(row.title),
            range(&of(|a| a.mean_change), decimals),
            range(&of(|a| a.by_chance), decimals),
            range(&of(|a| a.angle_r), 2),
            Cell::text(format!("{small} of {}", models.len())),
        ]
    });
    let largest = models
        .iter()
        .map(|m| m.perpendicular_moves_s)
        .fold(0.0, f64::max);
    table(
        "perpendicular",
        "Across the dial: what changes while S does not",
        &[
            "Measure",
            "Mean |change|",
            "By chance",
            "R with the angle",
            "p < .05",
        ],
        rows.collect(),
        format!(
            "S changes by {largest:.1e} points at most. By chance: |change| of the car on another road. R: of the change on cosine and sine of the angle."
        ),
    )
}

fn line(models: &[Examined], one: &Examined) -> Table {
    let rows = one.line.iter().enumerate().map(|(i, row)| {
        let of = |value: fn(&Agreement) -> Option<f64>| each(models, |m| value(&m.line[i]));
        vec![
            Cell::text(row.reading),
            range(&of(|a| a.adb), 2),
            range(&of(|a| a.latent), 2),
        ]
    });
    table(
        "line",
        "The aggression line against the ADB score and the generator’s aggressiveness (Pearson’s r)",
        &["Reading", "with ADB", "with the latent"],
        rows.collect(),
        "Fitted with ADB, the first is partly circular: the score itself pulled the embedding along the line. The regression learned on the training \
         drives alone and reads the seven measures of the first drive."
            .to_owned(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_model_shows_its_number_and_several_their_range() {
        assert_eq!(range(&[Some(0.5)], 2), Cell::number(Some(0.5), 2));
        let cell = range(&[Some(0.5), None, Some(0.7)], 2);
        assert_eq!(cell, Cell::text("0.60 (0.50 to 0.70)"));
        assert_eq!(range(&[None], 2), Cell::Missing);
    }
}
