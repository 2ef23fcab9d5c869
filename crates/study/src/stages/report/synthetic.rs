//! The page of a study.

use super::{
    keys::{results, short},
    people::People,
    scene,
};
use crate::{
    atomic_write::read_json,
    error::StudyError,
    outcome::Watch,
    stages::{
        analyse::{AggressionLine as Line, Analysis, Correlation as Found, HomophilyRow, Panel},
        train::{MODEL_FILE, TrainingSummary, embeddings_path, read_model, training_path},
    },
    tables::{
        Table as File,
        conditions::{ConditionRow, read_conditions},
        drives::read_drive,
        embeddings::read_embeddings,
        measurements::{MeasuredDrive, read_measurements},
    },
};
use maveric_domain::{Condition, DriveId, MetresPerSecond};
use maveric_model::{
    Model,
    style_space::{AggressionAxis, PerpendicularEllipse},
};
use maveric_report::{
    Context, Figure, Report, apa,
    claims::{self, LedgerRow},
    figures::{
        aggression_line::{AggressionLine, LinePanel, aggression_line},
        architecture::{Architecture, architecture},
        difference_panels::{DifferencePanel, DifferencePanels, PairTest, difference_panels},
        domain,
        embedding_space::{EmbeddingPoint, EmbeddingSpace, ExampleConditions, embedding_space},
        perpendicular::{AngleChange, PerpendicularChanges, PerpendicularPanel, perpendicular},
        preference::{Preferences, ScalePreference, preference},
        simulator_view,
        training_curves::{LossTerm, TrainingCurves, training_curves},
    },
    html::{Provenance, Section},
    tables::{
        self, AccuracyRow, Coefficient, Correlation, CorrelationRow, Exclusion, LineCorrelation,
        Reliability,
    },
};
use std::{collections::BTreeMap, path::Path};

/// Number of points in which an ellipse is drawn.
const ELLIPSE_POINTS: usize = 72;

struct Run {
    analysis: Analysis,
    training: TrainingSummary,
    model: Model,
    measured: Vec<MeasuredDrive>,
    conditions: Vec<ConditionRow>,
    context: Context,
}

pub(super) fn page(
    folder: &Path,
    claims: &str,
    watch: Watch<'_>,
) -> Result<(Report, Vec<String>), StudyError> {
    let analysis: Analysis = read_json(&folder.join("analysis.json"))?;
    let training: TrainingSummary = read_json(&training_path(&folder.join(MODEL_FILE)))?;
    let measured = read_measurements(&folder.join("measurements.parquet"))?;
    let context = if analysis.synthetic {
        Context::synthetic(training.seed)
    } else {
        Context::real()
    };
    let run = Run {
        model: read_model(&folder.join(MODEL_FILE))?,
        conditions: read_conditions(&folder.join("conditions.csv"))?,
        analysis,
        training,
        measured,
        context,
    };
    let people = People::read(folder, &run.measured)?;
    let list = File::read(&folder.join("drives/study2/drives.csv"))?;
    let durations = list.all_numbers("duration_s")?;
    let minutes = durations.iter().sum::<f64>() / durations.len() as f64 / 60.0;
    let first = list.ids::<DriveId>("drive")?.into_iter().next();
    let road = match first {
        Some(id) => *read_drive(&folder.join(format!("drives/study2/{id}.parquet")))?.road(),
        None => return Err(StudyError::file(list.path(), "lists no drive")),
    };
    let moved = run
        .conditions
        .iter()
        .map(|c| c.moved_points.abs())
        .fold(0.0, f64::max);
    let setup = [
        ("scenario.drive_minutes", minutes.round()),
        (
            "scenario.posted_speed_mph",
            MetresPerSecond(road.posted_speed_mps).mph(),
        ),
        ("steer.adb_shift_points", moved),
        ("model.embedding_size", run.model.embedding_size() as f64),
    ];
    let paper = claims::load(claims)?;
    let ledger = claims::join(&paper, &results(&run.analysis, &people, &setup))?;
    watch.check()?;
    let reliabilities = reliabilities(folder)?;
    let findings = findings(&run);
    let sections = vec![
        section_setting(folder, &run, &people, &reliabilities)?,
        section_embedding(folder, &run, &ledger)?,
        section_conditions(&run, &ledger)?,
        section_kept(&run)?,
        section_homophily(&run, &ledger)?,
    ];
    let exclusions: Vec<Exclusion> = run
        .analysis
        .exclusions
        .iter()
        .map(|e| Exclusion {
            who: e.who.clone(),
            what: e.what.clone(),
            why: e.why.clone(),
        })
        .chain(ingest_exclusions(folder)?)
        .collect();
    let mut warnings = run.training.warnings.clone();
    if let Some(share) = run.analysis.beyond_training.filter(|s| *s > 0.0) {
        warnings.push(format!(
            "{:.0}% of the Aggressive and Cautious embeddings lie further out than any training driver's: the networks extrapolate there",
            100.0 * share
        ));
    }
    let made_up = if run.analysis.synthetic {
        "Synthetic participants: "
    } else {
        ""
    };
    let report = Report {
        title: "MAVERIC: personalised driving style".to_owned(),
        subtitle: format!(
            "{made_up}{} drives to learn from, {} participants who then sat through four AV conditions",
            run.training.drives, run.analysis.participants
        ),
        context: run.context.clone(),
        summary: findings.clone(),
        sections,
        ledger: Some(ledger),
        exclusions,
        warnings,
        provenance: Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            seed: Some(run.training.seed),
            command: format!(
                "maveric run pipelines/{}.toml",
                folder.file_name().unwrap_or_default().to_string_lossy()
            ),
            parameters: parameters(&run.training),
            inputs: Vec::new(),
        },
    };
    Ok((report, findings))
}

/// The settings of the training, as the page lists them.
pub(super) fn parameters(training: &TrainingSummary) -> Vec<(String, String)> {
    let settings = serde_json::to_value(&training.settings).unwrap_or_default();
    let fields = settings.as_object().cloned().unwrap_or_default();
    fields
        .into_iter()
        .map(|(name, value)| (format!("training: {name}"), value.to_string()))
        .collect()
}

fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "no value".to_owned(), |v| format!("{:.1}%", 100.0 * v))
}

fn said(c: &Found) -> String {
    match statement(c) {
        Some(s) => s.statement().markup().to_owned(),
        None => format!("not computed from {} pairs", c.n),
    }
}

fn statement(c: &Found) -> Option<Correlation> {
    let coefficient = match c.method.as_str() {
        "spearman" => Coefficient::Spearman,
        "rm_corr" => Coefficient::RepeatedMeasures,
        _ => Coefficient::Pearson,
    };
    Some(Correlation {
        coefficient,
        value: c.r?,
        df: c.df,
        p: c.p?,
    })
}

/// The ten lines that a run ends with.
fn findings(run: &Run) -> Vec<String> {
    let a = &run.analysis;
    let mut lines = Vec::new();
    if a.synthetic {
        lines.push(format!(
            "Synthetic participants: {} training drives, {} test participants, seed {}",
            run.training.drives, a.participants, run.training.seed
        ));
    }
    let accuracy: Vec<String> = a
        .accuracy
        .iter()
        .map(|r| format!("{} {}", r.title.to_lowercase(), percent(r.mean)))
        .collect();
    lines.push(format!("Mimic accuracy: {}", accuracy.join(", ")));
    let adb = |line: &Line| {
        line.rows
            .iter()
            .find(|r| r.measure == "adb")
            .map(|r| said(&r.correlation))
    };
    lines.push(format!(
        "Aggression line against ADB: {} (embedding fitted with the score), {} (without)",
        adb(&a.line).unwrap_or_default(),
        adb(&a.line_without_adb).unwrap_or_default()
    ));
    for panel in &a.panels {
        lines.push(format!(
            "{} over the conditions: {}",
            panel.title, panel.omnibus
        ));
    }
    lines
}

fn reliabilities(folder: &Path) -> Result<Vec<Reliability>, StudyError> {
    let mut rows = Vec::new();
    for file in [
        "scores_reliabilities.csv",
        "rating_scores_reliabilities.csv",
    ] {
        let table = File::read(&folder.join(file))?;
        let (scale, subscale) = (table.text("scale")?, table.text("subscale")?);
        let (items, n) = (table.all_numbers("items")?, table.all_numbers("n")?);
        let (alpha, low, high) = (
            table.numbers("alpha")?,
            table.numbers("ci_low")?,
            table.numbers("ci_high")?,
        );
        for i in 0..table.rows() {
            let when = if file.starts_with("rating") {
                " (after a condition)"
            } else {
                ""
            };
            rows.push(Reliability {
                scale: format!(
                    "{}: {}{when}",
                    scale[i].clone().unwrap_or_default(),
                    subscale[i].clone().unwrap_or_default()
                ),
                items: items[i] as usize,
                n: n[i] as usize,
                alpha: alpha[i],
                interval: low[i].zip(high[i]),
                omega: None,
            });
        }
    }
    Ok(rows)
}

fn ingest_exclusions(folder: &Path) -> Result<Vec<Exclusion>, StudyError> {
    let mut found = Vec::new();
    for study in ["study1", "study2"] {
        let path = folder.join("drives").join(study).join("exclusions.csv");
        if !path.exists() {
            continue;
        }
        let table = File::read(&path)?;
        let (drive, what) = (table.text("drive")?, table.text("what")?);
        for i in 0..table.rows() {
            found.push(Exclusion {
                who: drive[i].clone().unwrap_or_default(),
                what: "ingest".to_owned(),
                why: what[i].clone().unwrap_or_default(),
            });
        }
    }
    Ok(found)
}

fn section_setting(
    folder: &Path,
    run: &Run,
    people: &People,
    reliabilities: &[Reliability],
) -> Result<Section, StudyError> {
    let mut figures = vec![domain(&run.context)?, architecture_of(run)?];
    if let Some(view) = scene::view(&folder.join("av/logs"))? {
        figures.push(simulator_view(&view, &run.context)?);
    }
    figures.push(training_of(run)?);
    Ok(Section {
        title: "Setting, people, model".to_owned(),
        intro: Vec::new(),
        figures,
        tables: vec![
            tables::participants(&people.groups(), run.analysis.synthetic),
            tables::reliabilities(reliabilities),
        ],
    })
}

fn architecture_of(run: &Run) -> Result<Figure, StudyError> {
    let a = run.model.architecture();
    let hidden = |inputs: usize, outputs: usize| {
        let mut layers = vec![inputs];
        layers.extend(std::iter::repeat_n(a.hidden_units, a.hidden_layers));
        layers.push(outputs);
        layers
    };
    let (w, z) = (a.embedding_size, a.encoding_size);
    let encoder = vec![3 * a.window_steps, a.encoder_units, z];
    let sizes = Architecture {
        embedding: w,
        window_steps: a.window_steps,
        following_distance: hidden(w + 1, 1),
        lane_encoder: encoder.clone(),
        lane_change: hidden(w + z, 2),
        speed_encoder: encoder,
        velocity: hidden(w + z, 1),
        style: vec![w, 1],
        mutual_information: hidden(1 + 2 * z + 4, 2 * w),
    };
    Ok(architecture(&sizes, &run.context)?)
}

fn training_of(run: &Run) -> Result<Figure, StudyError> {
    type Of = fn(&maveric_model::LossTerms) -> Option<f64>;
    let terms: [(&str, Of); 5] = [
        ("*L*_{1} following distance", |l| l.following_distance),
        ("*L*_{2} lane change", |l| l.lane_change),
        ("*L*_{3} velocity", |l| l.velocity),
        ("*L*_{4} style", |l| l.aggression),
        ("*L*_{5} mutual information", |l| l.mutual_information),
    ];
    let term = |(title, of): (&str, Of)| {
        let train: Option<Vec<f64>> = run.training.epochs.iter().map(|e| of(&e.losses)).collect();
        Some(LossTerm {
            title: title.to_owned(),
            train: train?,
            validation: Vec::new(),
        })
    };
    let terms = terms.into_iter().filter_map(term).collect();
    Ok(training_curves(
        &TrainingCurves {
            terms,
            drives: run.training.drives,
        },
        &run.context,
    )?)
}

fn section_embedding(
    folder: &Path,
    run: &Run,
    ledger: &[LedgerRow],
) -> Result<Section, StudyError> {
    let axis = AggressionAxis::of(&run.model)?;
    let speed_of = |drive: &DriveId| {
        run.measured
            .iter()
            .find(|d| d.meta.drive == *drive)
            .and_then(|d| d.values.get("mean_velocity_mps").copied().flatten())
    };
    let mut points = Vec::new();
    for row in read_embeddings(&embeddings_path(&folder.join(MODEL_FILE)))? {
        if let (Some(adb_points), Some(mean_velocity_mps)) = (row.adb, speed_of(&row.drive)) {
            points.push(EmbeddingPoint {
                embedding: row.embedding.coordinates().to_vec(),
                adb_points,
                mean_velocity_mps,
            });
        }
    }
    let space = EmbeddingSpace {
        points,
        gradient: axis.gradient().to_vec(),
        example: example(run)?,
    };
    let lines = line_panels(&run.analysis.line);
    let rows: Vec<LineCorrelation> = run
        .analysis
        .line
        .rows
        .iter()
        .zip(&run.analysis.line_without_adb.rows)
        .map(|(with, without)| LineCorrelation {
            measure: with.title.clone(),
            ours: statement(&with.correlation),
            without_style_loss: statement(&without.correlation),
            paper: printed(ledger, &format!("line.{}.r", short(&with.measure))),
        })
        .collect();
    Ok(Section {
        title: "Embedding space and the aggression line".to_owned(),
        intro: vec![
            "The embeddings of the test participants were fitted with their ADB score, as the paper does; the line's correlation with \
             ADB is then partly built in, so the table shows the fit without the score beside it."
                .to_owned(),
        ],
        figures: vec![embedding_space(&space, &run.context)?, aggression_line(&lines, &run.context)?],
        tables: vec![tables::embedding_line(&rows, run.analysis.participants)],
    })
}

fn example(run: &Run) -> Result<Option<ExampleConditions>, StudyError> {
    // The participant nearest to the middle of the line shows both directions best.
    let middle = f64::midpoint(maveric_domain::AdbScore::MIN, maveric_domain::AdbScore::MAX);
    let mimic = run
        .conditions
        .iter()
        .filter(|c| c.condition == Condition::Mimic);
    let Some(own) = mimic.min_by(|a, b| {
        (a.adb_hat - middle)
            .abs()
            .total_cmp(&(b.adb_hat - middle).abs())
    }) else {
        return Ok(None);
    };
    let of = |condition| {
        let mine = |c: &&ConditionRow| c.participant == own.participant && c.condition == condition;
        run.conditions
            .iter()
            .find(mine)
            .map(|c| c.embedding.coordinates().to_vec())
    };
    let (Some(aggressive), Some(cautious)) = (of(Condition::Aggressive), of(Condition::Cautious))
    else {
        return Ok(None);
    };
    let round = PerpendicularEllipse::of(&run.model)?;
    let at = |i: usize| -> Result<Vec<f64>, StudyError> {
        let angle = std::f64::consts::TAU * i as f64 / ELLIPSE_POINTS as f64;
        Ok(round
            .at_angle(&own.embedding, angle)?
            .embedding
            .coordinates()
            .to_vec())
    };
    Ok(Some(ExampleConditions {
        participant: own.participant.to_string(),
        mimic: own.embedding.coordinates().to_vec(),
        aggressive,
        cautious,
        perpendicular: of(Condition::Perpendicular),
        ellipse: (0..ELLIPSE_POINTS).map(at).collect::<Result<_, _>>()?,
    }))
}

fn line_panels(line: &Line) -> AggressionLine {
    let panel = |row: &crate::stages::analyse::LineRow| {
        let (axis, scale) = match row.measure.as_str() {
            "mean_velocity_mps" => ("Mean velocity (mph)".to_owned(), MetresPerSecond(1.0).mph()),
            "adb" => ("ADB score (points)".to_owned(), 1.0),
            "lane_changes" => ("Lane changes".to_owned(), 1.0),
            measure if measure.ends_with("_m") => (format!("{} (m)", row.title), 1.0),
            _ => (format!("{} (s)", row.title), 1.0),
        };
        LinePanel {
            title: row.title.clone(),
            axis,
            points: row.points.iter().map(|(x, y)| (*x, y * scale)).collect(),
            statistic: said(&row.correlation),
        }
    };
    AggressionLine {
        panels: line
            .rows
            .iter()
            .filter(|r| !r.points.is_empty())
            .map(panel)
            .collect(),
    }
}

fn printed(ledger: &[LedgerRow], key: &str) -> Option<Correlation> {
    let claim = &ledger.iter().find(|row| row.claim.key == key)?.claim;
    let coefficient = if claim.quantity == claims::Quantity::Rho {
        Coefficient::Spearman
    } else {
        Coefficient::Pearson
    };
    let printed = claim.printed_p.as_ref()?;
    // "< .001" is printed again as such, not as ".001".
    let p = if printed.bound == Some('<') {
        printed.value * 0.999
    } else {
        printed.value
    };
    Some(Correlation {
        coefficient,
        value: claim.printed.value,
        df: claim.df? as usize,
        p,
    })
}

fn section_conditions(run: &Run, ledger: &[LedgerRow]) -> Result<Section, StudyError> {
    let panels = DifferencePanels {
        // A panel without a single value has nothing to show: the exclusions say who is missing and why.
        panels: run
            .analysis
            .panels
            .iter()
            .filter(|p| p.rows.iter().flatten().any(Option::is_some))
            .map(panel)
            .collect(),
    };
    let reported: BTreeMap<&str, f64> = ledger
        .iter()
        .map(|row| (row.claim.key.as_str(), row.claim.printed.value))
        .collect();
    let rows: Vec<AccuracyRow> = run
        .analysis
        .accuracy
        .iter()
        .map(|r| AccuracyRow {
            measure: r.title.clone(),
            n: r.n,
            ours: r.mean,
            paper: reported
                .get(format!("mimic_accuracy.{}", short(&r.measure)).as_str())
                .map(|v| v / 100.0),
            population_mean: r.population_mean,
            test_retest: None,
        })
        .collect();
    let mut intro = vec![
        "Differences from each participant's own drive. Which test was used, and why, is recorded with every check in \
         analysis.json."
            .to_owned(),
    ];
    for panel in run.analysis.panels.iter().filter(|p| !p.reasons.is_empty()) {
        intro.push(format!(
            "{}: {}. {}.",
            panel.title,
            panel.omnibus,
            capital(&panel.reasons.join("; "))
        ));
    }
    Ok(Section {
        title: "Mimicking and modulating aggression".to_owned(),
        intro,
        figures: vec![difference_panels(&panels, &run.context)?],
        tables: vec![tables::mimic_accuracy(&rows), nearer_table(run)],
    })
}

fn nearer_table(run: &Run) -> tables::Table {
    use tables::{Cell, Column};
    let row = |r: &crate::stages::analyse::Nearer| {
        let p = r
            .p_holm
            .map_or_else(|| "n/a".to_owned(), |p| apa::p_holm(p).markup().to_owned());
        vec![
            Cell::text(r.title.clone()),
            Cell::text(r.than.to_string()),
            Cell::count(r.n),
            Cell::number(r.share.map(|s| 100.0 * s), 0),
            Cell::Marked(p),
        ]
    };
    tables::Table {
        name: "nearer".to_owned(),
        title: "Is Mimic nearer to the participant's own drive?".to_owned(),
        columns: vec![
            Column::left("Measure"),
            Column::left("Than"),
            Column::right("*n*"),
            Column::right("Mimic nearer (%)"),
            Column::left("Wilcoxon"),
        ],
        rows: run.analysis.nearer.iter().map(row).collect(),
        notes: vec![
            "Wilcoxon's signed ranks of |Mimic − own| against |condition − own|; p adjusted after Holm over the ten rows.".to_owned(),
        ],
    }
}

fn panel(panel: &Panel) -> DifferencePanel {
    let axis = match (panel.measure.as_str(), panel.unit.as_str()) {
        ("aggressiveness", _) => "Rated aggressiveness (1 to 7)".to_owned(),
        (_, "") => "Difference from own drive".to_owned(),
        (_, unit) => format!("Difference from own drive ({unit})"),
    };
    let pair = |p: &crate::stages::analyse::PanelPair| {
        Some(PairTest {
            first: p.first,
            second: p.second,
            p_holm: p.p_holm?,
        })
    };
    DifferencePanel {
        title: panel.title.clone(),
        axis,
        conditions: Condition::AV.to_vec(),
        rows: panel.rows.clone(),
        omnibus: panel.omnibus_short.clone(),
        pairs: panel
            .pairs
            .iter()
            .filter_map(pair)
            .filter(|p| p.first == Condition::Mimic)
            .collect(),
        reference: Some(panel.same),
    }
}

fn section_kept(run: &Run) -> Result<Section, StudyError> {
    let panels = run
        .analysis
        .kept
        .iter()
        .filter(|k| !k.points.is_empty())
        .map(|k| {
            let round = match (k.circular_r, k.circular_p) {
                (Some(r), Some(p)) => {
                    format!("*R* = {}, {}", apa::bounded(r, 2), apa::p(p).markup())
                }
                _ => format!("not computed from {} participants", k.points.len()),
            };
            PerpendicularPanel {
                title: k.title.clone(),
                axis: if k.unit.is_empty() {
                    "Change from Mimic".to_owned()
                } else {
                    format!("Change from Mimic ({})", k.unit)
                },
                points: k
                    .points
                    .iter()
                    .map(|(angle_rad, change)| AngleChange {
                        angle_rad: *angle_rad,
                        change: *change,
                    })
                    .collect(),
                statistic: round,
            }
        })
        .collect::<Vec<_>>();
    let figures = if panels.is_empty() {
        Vec::new()
    } else {
        vec![perpendicular(
            &PerpendicularChanges { panels },
            &run.context,
        )?]
    };
    let intro = run.analysis.kept.iter().map(|k| {
        format!(
            "{}: along the aggression line {}; against the angle, as the paper does it, {}. An angle has no natural zero, so the \
             figure gives the multiple correlation with its cosine and sine.",
            k.title,
            said(&k.line),
            said(&k.angle)
        )
    });
    Ok(Section {
        title: "Other habits".to_owned(),
        intro: intro.collect(),
        figures,
        tables: Vec::new(),
    })
}

fn section_homophily(run: &Run, ledger: &[LedgerRow]) -> Result<Section, StudyError> {
    let shown = |row: &&HomophilyRow| {
        let key = homophily_key(row);
        row.correlation.p.is_some_and(|p| p < 0.05) || ledger.iter().any(|l| l.claim.key == key)
    };
    let mut rows: Vec<CorrelationRow> = run
        .analysis
        .homophily
        .iter()
        .filter(shown)
        .map(|row| CorrelationRow {
            independent: capital(&row.factor),
            dependent: format!("Mimic − {}, {}", capital(row.versus.as_str()), row.rating),
            ours: statement(&row.correlation),
            repeated: None,
            paper: printed(ledger, &homophily_key(row)),
        })
        .collect();
    rows.extend(run.analysis.similarity.iter().map(|row| CorrelationRow {
        independent: "Perceived similarity".to_owned(),
        dependent: capital(&row.rating),
        ours: statement(&row.pooled),
        repeated: statement(&row.within),
        paper: printed(ledger, &format!("correlation.similarity.{}.r", row.rating)),
    }));
    let bars = Preferences {
        scales: run
            .analysis
            .preferences
            .iter()
            .filter(|p| p.n > 0)
            .map(|p| ScalePreference {
                scale: if p.rating == "discomfort" {
                    "Comfort".to_owned()
                } else {
                    capital(&p.rating)
                },
                n: p.n,
                aggressive_above: p.aggressive_above,
                cautious_above: p.cautious_above,
            })
            .collect(),
    };
    let tested = run
        .analysis
        .homophily
        .iter()
        .filter(|r| r.correlation.p.is_some())
        .count();
    let low = run
        .analysis
        .homophily
        .iter()
        .filter(|r| r.correlation.p.is_some_and(|p| p < 0.05))
        .count();
    let holm = run
        .analysis
        .homophily
        .iter()
        .filter(|r| r.p_holm.is_some_and(|p| p < 0.05))
        .count();
    let bh = run
        .analysis
        .homophily
        .iter()
        .filter(|r| r.p_bh.is_some_and(|p| p < 0.05))
        .count();
    let figures = if bars.scales.is_empty() {
        Vec::new()
    } else {
        vec![preference(&bars, &run.context)?]
    };
    Ok(Section {
        title: "Homophily".to_owned(),
        intro: vec![format!(
            "{tested} correlations of a factor with a rating difference were tested: {low} are below .05 as printed ({:.0} would be by \
             chance), {bh} with the false discovery rate controlled (Benjamini and Hochberg), {holm} after Holm. The table shows the \
             pairs that the paper printed and those below .05 here, uncorrected as in the paper.",
            0.05 * tested as f64
        )],
        figures,
        tables: vec![tables::correlations(&rows, run.analysis.participants)],
    })
}

fn homophily_key(row: &HomophilyRow) -> String {
    let versus = if row.versus == Condition::Cautious {
        "mc"
    } else {
        "ma"
    };
    format!("correlation.{}.{versus}_{}.r", row.factor, row.rating)
}

fn capital(word: &str) -> String {
    let words = word.replace('_', "-");
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}
