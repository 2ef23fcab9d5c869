//! The fragment and the page around it.

use super::check::check;
use super::drive::{PlayerDrive, WatchPlayer};
use super::pack::{Packer, Run, SAMPLES_PER_S, Sampled, sample};
use super::timeline::{Axes, GAP_AXIS_M, moment, timeline};
use super::view::{SHOWN_M, STRETCH, half_height_m, middle_m, stretch};
use crate::apa::number;
use crate::error::ReportError;
use crate::figures::{Context, font_face_css};
use crate::html::style::condition_colours;
use crate::html::template::fill;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maveric_domain::{SpeedUnit, drive::Direction};
use minijinja::{Value, context};
use serde_json::json;
use std::fmt::Write as _;

/// A player to put into a page. Style and script are the same for all players of a page and need to be there once.
///
/// Works under `default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'`: nothing is loaded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlayerFragment {
    /// A `<section class="drive-player">` with its data.
    pub html: String,
    /// Rules for a `<style>`; every selector begins with `.drive-player`.
    pub style: String,
    /// Content of a `<script>` after the last player of the page.
    pub script: &'static str,
}

/// Makes the fragment. The same drives give the same bytes.
///
/// # Errors
/// [`ReportError`] naming the drive and the column that is too short, not finite or out of range; if the player has no
/// drive, or its name is not a usable anchor.
///
/// # Example
/// ```
/// use maveric_domain::ConditionId;
/// use maveric_report::{Context, html::{PlayerDrive, Track, WatchPlayer, player}};
///
/// let track = |id, from_m: f64, speed_mps: f64| Track {
///     id,
///     length_m: 4.7,
///     width_m: 1.9,
///     first_row: 0,
///     x_m: (0..100).map(|i| from_m + speed_mps * f64::from(i) / 10.0).collect(),
///     y_m: vec![0.0; 100],
/// };
/// let drive = PlayerDrive {
///     label: "Mimic".into(),
///     note: "automated".into(),
///     condition: ConditionId::new("same").unwrap(),
///     lanes: 2,
///     lane_width_m: 3.66,
///     centre_line: None,
///     time_s: (0..100).map(|i| f64::from(i) / 10.0).collect(),
///     segment: vec![0; 100],
///     ego: track(0, 0.0, 25.0),
///     speed_mps: vec![25.0; 100],
///     gap_m: vec![Some(40.0 - 4.7); 100],
///     reference: vec![Some(1); 100],
///     others: vec![track(1, 40.0, 25.0)],
///     lane_changes: vec![],
///     interventions: Some(vec![]),
/// };
/// let drives = WatchPlayer { name: "watch-p07".into(), title: "Drives of P07".into(), drives: vec![drive] };
/// let fragment = player(&drives, &Context::real())?;
/// assert!(fragment.html.starts_with("<section class=\"drive-player\" id=\"watch-p07\""));
/// # Ok::<(), maveric_report::ReportError>(())
/// ```
pub fn player(player: &WatchPlayer, context: &Context) -> Result<PlayerFragment, ReportError> {
    check(player)?;
    let sampled: Vec<Sampled> = player.drives.iter().map(sample).collect();
    let axes = Axes::new(&sampled, context.speed);
    let moment = moment(&sampled);
    let drives = || player.drives.iter().zip(&sampled);
    let data = json!({
        "rate": SAMPLES_PER_S,
        "unit": { "name": context.speed.name(), "perMps": context.speed.per_mps() },
        "duration": rounded(axes.duration_s),
        "moment": moment,
        "ahead": rounded(SHOWN_M.1 / (SHOWN_M.0 + SHOWN_M.1)),
        "drives": drives().map(|(d, s)| drive_data(d, s)).collect::<Vec<_>>(),
    });
    let rows: Vec<Value> =
        drives().map(|(drive, sampled)| row_value(drive, sampled, &axes, moment)).collect();
    let straight = player.drives.iter().any(|d| d.centre_line.is_none());
    let html = fill(
        "player.html",
        context! {
            name => &player.name,
            title => &player.title,
            synthetic => context.synthetic,
            rows,
            moment => clock(moment as f64 / SAMPLES_PER_S),
            ticks => axes.ticks().iter().map(|&t| context! { at => percent(t, &axes), text => clock(t) }).collect::<Vec<_>>(),
            duration => rounded(axes.duration_s),
            start => moment as f64 / SAMPLES_PER_S,
            unit => context.speed.name(),
            gap_axis => number(GAP_AXIS_M, 0),
            stretch => straight.then(|| number(STRETCH, 1)),
            safety => player.drives.iter().any(|d| d.interventions.is_some()),
            // `<` in the data would end the script.
            data => Value::from_safe_string(data.to_string().replace('<', "\\u003c")),
        },
    )?;
    Ok(PlayerFragment { html, style: style(player, context), script: include_str!("player.js") })
}

/// A page of its own around a player: one file that needs nothing else. `provenance` is listed at its foot, as plain text.
///
/// # Errors
/// As [`player`].
pub fn watch_page(
    drives: &WatchPlayer,
    context: &Context,
    provenance: &[(String, String)],
) -> Result<String, ReportError> {
    let fragment = player(drives, context)?;
    let PlayerFragment { html, style, script } = fragment;
    fill(
        "watch.html",
        context! {
            title => &drives.title,
            synthetic => context.synthetic,
            metadata => context.metadata(),
            style => Value::from_safe_string(format!("{}{style}", font_face_css())),
            player => Value::from_safe_string(html),
            script => Value::from_safe_string(script.to_owned()),
            provenance => provenance.to_vec(),
        },
    )
}

/// The rules, with the conditions' colours for light and dark; grey for those that no design describes.
fn style(player: &WatchPlayer, context: &Context) -> String {
    let mut context = context.clone();
    for drive in &player.drives {
        if context.conditions.iter().all(|look| look.id != drive.condition) {
            let look = context.look(drive.condition);
            context.conditions.push(look);
        }
    }
    let mut out = include_str!("player.css").to_owned();
    out.push_str(&condition_colours(&context, ".drive-player"));
    for look in &context.conditions {
        let id = look.id;
        let _ = writeln!(out, ".drive-player .pl-{id}{{--pl-colour:var(--of-{id})}}");
    }
    out
}

/// Three decimals at most, so that data stay short.
fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

fn sample_at(time_s: f64) -> f64 {
    (time_s * SAMPLES_PER_S).round()
}

/// What the script is told of a drive.
fn drive_data(drive: &PlayerDrive, sampled: &Sampled) -> serde_json::Value {
    let start_m = drive.ego.x_m[0];
    let mut references: Vec<(usize, i64)> = Vec::new();
    for (i, id) in sampled.reference.iter().enumerate() {
        let id = id.map_or(-1, i64::from);
        if references.last().is_none_or(|(_, last)| *last != id) {
            references.push((i, id));
        }
    }
    let run = |run: &Run| json!([run.first, run.count]);
    let cars = sampled.seen.iter().map(|car| {
        let (length, width) = (rounded(car.length_m), rounded(car.width_m));
        json!([car.id, car.run.first, car.run.count, length, width])
    });
    let line = drive.centre_line.as_ref().map(|line| {
        json!([rounded(line.start_m - start_m), rounded(line.step_m), line.map_m.len()])
    });
    let bytes = Packer::default().drive(drive, sampled, start_m);
    json!({
        "samples": sampled.samples,
        "lanes": drive.lanes,
        "laneWidth": rounded(drive.lane_width_m),
        "middle": rounded(middle_m(drive)),
        "half": rounded(half_height_m(drive)),
        "stretch": stretch(drive),
        "ego": [rounded(drive.ego.length_m), rounded(drive.ego.width_m)],
        "runs": sampled.runs.iter().map(run).collect::<Vec<_>>(),
        "cars": cars.collect::<Vec<_>>(),
        "references": references,
        "events": events(drive).iter().map(|e| json!([sample_at(e.start_s), sample_at(e.end_s), e.kind])).collect::<Vec<_>>(),
        "line": line,
        "bytes": STANDARD.encode(bytes),
    })
}

/// Something to mark on the time line.
struct Event {
    start_s: f64,
    end_s: f64,
    kind: &'static str,
}

fn events(drive: &PlayerDrive) -> Vec<Event> {
    let changes = drive.lane_changes.iter().map(|c| Event {
        start_s: c.start_s,
        end_s: c.end_s,
        kind: match c.direction {
            Direction::Left => "left",
            Direction::Right => "right",
        },
    });
    let braked = drive.interventions.iter().flatten().map(|i| Event {
        start_s: i.start_s,
        end_s: i.end_s,
        kind: "safety",
    });
    let mut events: Vec<Event> = changes.chain(braked).collect();
    events.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
    events
}

fn percent(time_s: f64, axes: &Axes) -> String {
    format!("{:.2}", 100.0 * time_s / axes.duration_s)
}

/// Minutes and seconds: 83.2 s is 1:23.
fn clock(time_s: f64) -> String {
    let seconds = time_s.floor() as u64;
    format!("{}:{:02}", seconds / 60, seconds % 60)
}

fn row_value(drive: &PlayerDrive, sampled: &Sampled, axes: &Axes, moment: usize) -> Value {
    let there: Vec<usize> = (0..sampled.samples).filter(|&i| sampled.has(i)).collect();
    let sum: f64 = there.iter().map(|&i| sampled.speed_mps[i]).sum();
    let mean_mps = sum / there.len().max(1) as f64;
    let changes = |way: Direction| {
        let changes = drive.lane_changes.iter();
        changes.filter(|c| c.direction == way).count()
    };
    let marks: Vec<Value> = events(drive)
        .iter()
        .map(|e| {
            context! {
                kind => e.kind,
                at => percent(e.start_s, axes),
                wide => percent((e.end_s - e.start_s).max(0.0), axes),
            }
        })
        .collect();
    context! {
        label => &drive.label,
        note => &drive.note,
        condition => drive.condition.as_str(),
        now => now(sampled, moment, axes.unit),
        lines => Value::from_safe_string(timeline(sampled, axes)),
        marks,
        head => percent((moment as f64 / SAMPLES_PER_S).min(axes.duration_s), axes),
        fastest => number(axes.speed.1, 0),
        slowest => number(axes.speed.0, 0),
        length => clock((sampled.samples - 1) as f64 / SAMPLES_PER_S),
        mean_speed => number(mean_mps * axes.unit.per_mps(), 1),
        left => changes(Direction::Left),
        right => changes(Direction::Right),
        interventions => drive.interventions.as_ref().map(Vec::len),
    }
}

/// Half a lane to the side is another lane: what is passed is not ahead.
const ASIDE_M: f64 = 1.8;

/// Whether the reference vehicle is in another lane than ego.
fn aside(sampled: &Sampled, sample: usize) -> bool {
    let offset_m = sampled.reference[sample].and_then(|id| {
        let shows = |run: &Run| (run.first..run.first + run.count).contains(&sample);
        let car = sampled.seen.iter().find(|seen| seen.id == id && shows(&seen.run))?;
        Some(car.y_m[sample - car.run.first] - sampled.y_m[sample])
    });
    offset_m.is_some_and(|dy| dy.abs() > ASIDE_M)
}

/// What happens at a sample, in words; the script says it in the same words.
fn now(sampled: &Sampled, sample: usize, unit: SpeedUnit) -> String {
    if !sampled.has(sample) {
        return "no recording here".to_owned();
    }
    let speed = number(sampled.speed_mps[sample] * unit.per_mps(), 0);
    let gap = match sampled.gap_m[sample] {
        None => "nobody to follow".to_owned(),
        Some(gap) if gap.abs() < 0.5 => "beside the other car".to_owned(),
        Some(gap) if gap > 0.0 && aside(sampled, sample) => {
            format!("{} m to the car in the other lane", number(gap, 0))
        }
        Some(gap) if gap > 0.0 => format!("{} m to the car ahead", number(gap, 0)),
        Some(gap) => format!("{} m past the car", number(-gap, 0)),
    };
    format!("{speed} {}, {gap}", unit.name())
}
