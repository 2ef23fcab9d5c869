//! What was found, over all models, as tables.

use super::{Agreement, Examined, FULL, Held, Metric, Retest, Right, ShareOfPeople, mean};
use maveric_rehearsal::findings::over_models;
use maveric_report::{
    figures::fidelity::Accuracy,
    tables::{Cell, Table, TableOf},
};

/// Mean, lowest and highest over the models that have a value.
pub(super) fn over<T>(models: &[T], of: impl Fn(&T) -> Option<f64>) -> Option<Accuracy> {
    let (mean, (low, high)) = over_models(models.iter().map(of))?;
    Some(Accuracy { mean, low, high })
}

/// Mean over the models and, in brackets, lowest and highest.
fn range(values: &[Option<f64>], decimals: usize) -> Cell {
    let Some(Accuracy { mean, low, high }) = over(values, |value| *value) else {
        return Cell::Missing;
    };
    if high - low < 1e-9 {
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

/// A table of the things that every model was asked: each with its place among them.
fn table<'a, T>(name: &str, title: impl Into<String>, of: &'a [T]) -> TableOf<(usize, &'a T)> {
    Table::of(format!("validation-{name}"), title, of.iter().enumerate())
}

/// All tables over `models`, which were examined on the same people.
pub(super) fn tables(models: &[Examined], retested: &[Retest], points: f64) -> Vec<Table> {
    let Some(one) = models.first() else {
        return Vec::new();
    };
    vec![
        retest(retested),
        identity(models, one),
        errors(models, one),
        fidelity(models, one),
        likeness(models, one),
        dial(models, one, points),
        perpendicular(models, one),
        line(models, one),
    ]
}

fn identity(models: &[Examined], one: &Examined) -> Table {
    let rate = |i: usize| each(models, |m| Some(m.identity[i].rate));
    let interval = |i: usize, n: usize| {
        let hits: f64 = rate(i).iter().flatten().sum::<f64>() / models.len() as f64 * n as f64;
        let whole = (hits.round() as usize).min(n);
        let interval = maveric_stats::proportion(whole, n, 0.95).ok();
        interval.map_or(Cell::Missing, |w| {
            Cell::text(format!("{:.0} to {:.0}", 100.0 * w.low, 100.0 * w.high))
        })
    };
    let n = one.identity.first().map_or(0, |r| r.n);
    let title = format!("Identity: who of {n} is it? Nearest to the own first drive (%)");
    table("identity", title, &one.identity)
        .text("Compared with the first drive", |(_, row)| row.what)
        .right("Distance", |(_, row)| {
            Cell::text(match row.metric {
                Metric::Euclidean => "straight",
                Metric::WithinPerson => "within-person",
                Metric::Posterior => "posterior",
            })
        })
        .right("Found", |(i, _)| percent(&rate(*i)))
        .right("95% of drivers", |(i, row)| interval(*i, row.n))
        .right("Mean rank", |(i, _)| {
            range(&each(models, |m| Some(m.identity[*i].mean_rank)), 1)
        })
        .noted(format!(
            "Fitted without the ADB score unless said. By chance {:.1}%, mean rank {:.1}. Mean over {} models, in brackets lowest and highest; \
             the interval is Wilson's for the mean rate of {n} drivers. Within-person: Mahalanobis distance by the covariance of two days of one \
             person over the training people; posterior: by what both fits leave open themselves.",
            100.0 / n as f64,
            f64::midpoint(n as f64, 1.0),
            models.len()
        ))
}

/// A share of 0 to 1 and its interval in percent, in words.
fn percent_words((low, high): (f64, f64)) -> String {
    format!("{:.1} to {:.1}", 100.0 * low, 100.0 * high)
}

fn errors(models: &[Examined], one: &Examined) -> Table {
    type Of = fn(&Held) -> Option<ShareOfPeople>;
    let rows: [(&str, f64, Of); 2] = [
        ("within 1 standard error", 68.3, |h| h.within_1),
        ("within 2 standard errors", 95.4, |h| h.within_2),
    ];
    let shares = |of: Of| each(models, |m| of(&m.errors).map(|s| s.estimate));
    let of_whom = match one.days_of {
        Some(people) => format!("of the person, by how far the days of {people} people learned from differ"),
        None => "of the drive alone, because nobody learned from drove twice: a person’s days are not in them".to_owned(),
    };
    table("errors", "Standard errors: second drives where the first expects them (%)", &rows)
        .text("Numbers of the style", |(_, row)| row.0)
        .right("Found", |(_, row)| percent(&shares(row.2)))
        .right("95% of people", |(_, row)| {
            let interval = row.2(&one.errors).and_then(|s| s.interval);
            interval.map_or(Cell::Missing, |i| Cell::text(percent_words(i)))
        })
        .right("Right would be", |(_, row)| Cell::number(Some(row.1), 1))
        .noted(format!(
            "Fitted without the score; {} numbers of {} people, {} more of which a drive says nothing, {} people without a standard error. The errors are \
             {of_whom}. Found: mean over {} models, in brackets lowest and highest; the interval is over people, first model.",
            one.errors.coordinates - one.errors.silent,
            one.errors.people,
            one.errors.silent,
            one.errors.left_out,
            models.len()
        ))
}

fn retest(rows: &[Retest]) -> Table {
    Table::of("validation-retest", "How much of a difference between drives is the driver’s: ICC(2,1) of two drives", rows)
        .text("Measure", |row| row.title)
        .right("ICC(2,1)", |row| Cell::number(row.icc, 2))
        .right("95% interval", |row| {
            let words = |(low, high): (f64, f64)| format!("{low:.2} to {high:.2}").replace('-', "−");
            row.interval.map_or(Cell::Missing, |i| Cell::text(words(i)))
        })
        .right("People", |row| Cell::number(Some(row.n as f64), 0))
        .right("Without a value", |row| Cell::number(Some(row.missing as f64), 0))
        .noted(
            "1: one person’s two drives are the same and people differ; 0: people differ no more than one person’s days. It bounds what can be learned of a \
             person from one drive. Interval of McGraw and Wong.",
        )
}

fn fidelity(models: &[Examined], one: &Examined) -> Table {
    type Of = fn(&super::Fidelity) -> Option<f64>;
    let each_of = |i: usize, of: Of| percent(&each(models, |m| of(&m.fidelity[i])));
    let fixed = |share: Option<f64>| Cell::number(share.map(|s| 100.0 * s), 1);
    let title = "Fidelity: the car in the own style against the driver’s own drive (%)";
    table("fidelity", title, &one.fidelity)
        .text("Measure", |(_, row)| row.title)
        .right("Car", |(i, _)| each_of(*i, |f| f.mimic))
        .right("Same driver, second drive", |(_, row)| fixed(row.test_retest))
        .right("Car, of that", |(i, _)| each_of(*i, |f| f.of_test_retest))
        .right("Paper", |(_, row)| fixed(row.paper))
        .right("Training mean as guess", |(_, row)| fixed(row.population_mean))
        .right("Bias of the car", |(i, _)| each_of(*i, |f| f.mimic_bias))
        .right("Bias of second drive", |(_, row)| fixed(row.test_retest_bias))
        .right("Car on another road", |(i, _)| each_of(*i, |f| f.car_again))
        .noted(
            "Accuracy: 1 − |found − own| / own, mean over drivers. Bias: mean of (found − own) / own. The car is driven once, from the embedding fitted \
             with the ADB score, as in the study; the last column holds it against itself on another road.",
        )
}

fn likeness(models: &[Examined], one: &Examined) -> Table {
    type Of = fn(&super::Likeness) -> Option<f64>;
    let of = |i: usize, of: Of| each(models, |m| of(&m.likeness[i]));
    let title = "Likeness by distribution: windows of 5 s beside the owner’s first drive";
    table("likeness", title, &one.likeness)
        .text("Drive", |(_, row)| row.what)
        .right("MMD²", |(i, _)| range(&of(*i, |l| l.mmd2), 3))
        .right("Divergence (nats)", |(i, _)| range(&of(*i, |l| l.divergence), 2))
        .right("Different, p < .05 (%)", |(i, _)| percent(&of(*i, |l| l.different)))
        .right("Owner nearest of all (%)", |(i, _)| percent(&of(*i, |l| l.owner_nearest)))
        .right("Mean rank of the owner", |(i, _)| range(&of(*i, |l| l.mean_rank), 1))
        .noted(
            "Speed, time gap, acceleration, jerk and lateral place, each in SDs over all windows of people. MMD²: maximum mean discrepancy, Gaussian \
             kernel, unbiased, so about 0 for two drives of one distribution; p by 99 random splits. Divergence: Kullback-Leibler, from distances to the \
             fifth-nearest window. Nearest and rank by MMD² among the first drives of all people.",
        )
}

fn dial(models: &[Examined], one: &Examined, points: f64) -> Table {
    type Side = fn(&super::Dial) -> &Right;
    let share = |i: usize, of: Side| percent(&each(models, |m| of(&m.dial[i]).share));
    let tied = |i: usize, of: Side| range(&each(models, |m| Some(of(&m.dial[i]).tied as f64)), 1);
    let change = |i: usize, of: Side| range(&each(models, |m| of(&m.dial[i]).mean_change), 2);
    let with_room = |right: &Right| {
        let n = right.with_room;
        (n > 0).then(|| right.right_with_room as f64 / n as f64)
    };
    let monotone = |i: usize| {
        let all = models.iter().filter(|m| m.dial[i].monotone == Some(true));
        Cell::text(format!("{} of {}", all.count(), models.len()))
    };
    let beyond: Vec<f64> = models.iter().filter_map(|m| m.beyond_training).collect();
    let ends = (one.steps.first(), one.steps.last());
    let title = format!("Dial: drivers for whom ±{points} points do what they should (%)");
    table("dial", title, &one.dial)
        .text("Measure", |(_, row)| row.title)
        .right("Aggressive right", |(i, _)| share(*i, |d| &d.aggressive))
        .right("of those with room", |(i, _)| {
            percent(&each(models, |m| with_room(&m.dial[*i].aggressive)))
        })
        .right("Cautious right", |(i, _)| share(*i, |d| &d.cautious))
        .right("Aggressive: ties", |(i, _)| tied(*i, |d| &d.aggressive))
        .right("Cautious: ties", |(i, _)| tied(*i, |d| &d.cautious))
        .right("Aggressive: change", |(i, _)| change(*i, |d| &d.aggressive))
        .right("Cautious: change", |(i, _)| change(*i, |d| &d.cautious))
        .right("Rising", |(i, _)| percent(&each(models, |m| m.dial[*i].rising)))
        .right("Kendall’s τ", |(i, _)| range(&each(models, |m| m.dial[*i].mean_tau), 2))
        .right("Mean curve monotone", |(i, _)| monotone(*i))
        .noted(format!(
            "No change is a tie and counts as wrong; a driver without a value at a setting is left out there. With room: for more lane changes, \
             those who make fewer than {FULL} of twelve at 0; for the rest everybody. Rising: drivers whose Spearman’s ρ over {} settings \
             from {} to {} points has the right sign; τ: mean over drivers, 1 being a perfect dial. Changes in the measure’s unit. {:.1}% of the \
             embeddings driven lie further out than any training driver.",
            one.steps.len(),
            ends.0.copied().unwrap_or_default(),
            ends.1.copied().unwrap_or_default(),
            100.0 * mean(&beyond).unwrap_or(0.0)
        ))
}

fn perpendicular(models: &[Examined], one: &Examined) -> Table {
    type Of = fn(&super::Across) -> Option<f64>;
    let of = |i: usize, of: Of| each(models, |m| of(&m.perpendicular[i]));
    let decimals = |row: &super::Across| {
        if row.measure == "left_lane_fraction" {
            3
        } else {
            2
        }
    };
    let small = |i: usize| {
        of(i, |a| a.angle_p.filter(|p| *p < 0.05))
            .iter()
            .flatten()
            .count()
    };
    let moves = models.iter().map(|m| m.perpendicular_moves_s);
    let largest = moves.fold(0.0, f64::max);
    let title = "Across the dial: what changes while S does not";
    table("perpendicular", title, &one.perpendicular)
        .text("Measure", |(_, row)| row.title)
        .right("Mean |change|", |(i, row)| range(&of(*i, |a| a.mean_change), decimals(row)))
        .right("By chance", |(i, row)| range(&of(*i, |a| a.by_chance), decimals(row)))
        .right("R with the angle", |(i, _)| range(&of(*i, |a| a.angle_r), 2))
        .right("p < .05", |(i, _)| Cell::text(format!("{} of {}", small(*i), models.len())))
        .noted(format!(
            "S changes by {largest:.1e} points at most. By chance: |change| of the car on another road. R: of the change on cosine and sine of the angle."
        ))
}

fn line(models: &[Examined], one: &Examined) -> Table {
    let of =
        |i: usize, of: fn(&Agreement) -> Option<f64>| range(&each(models, |m| of(&m.line[i])), 2);
    let title = "The aggression line against the ADB score and the generator’s aggressiveness (Pearson’s r)";
    table("line", title, &one.line)
        .text("Reading", |(_, row)| row.reading.title())
        .right("with ADB", |(i, _)| of(*i, |a| a.adb))
        .right("with the latent", |(i, _)| of(*i, |a| a.latent))
        .noted(
            "Fitted with ADB, the first is partly circular: the score itself pulled the embedding along the line. The regression learned on the training \
             drives alone and reads the seven measures of the first drive.",
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
