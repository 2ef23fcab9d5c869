//! What every file of a run holds, column by column: `docs/outputs.md` is written from this, and a test holds it against a run.

use maveric_measures::objective;
use std::fmt::Write as _;

/// A kind of file.
#[derive(Debug, Clone, Copy)]
pub struct OutputFile {
    /// Its name, `*` for what differs from drive to drive.
    pub name: &'static str,
    /// What it holds.
    pub what: &'static str,
    /// Its columns with their meaning, units included; empty for what is no table.
    pub columns: &'static [(&'static str, &'static str)],
}

const PERSON: (&str, &str) = ("participant", "id of the person");
const CONDITION: (&str, &str) = ("condition", "id of the condition, the baseline or a role");
const DRIVE: (&str, &str) = ("drive", "id of the drive");

const SCORES: &[(&str, &str)] = &[
    PERSON,
    ("moment", "`pre`, or the condition after which it was asked"),
    ("scale", "id of the questionnaire"),
    ("subscale", "id of the score"),
    (
        "value",
        "the score, in its own points; empty where too few items were answered",
    ),
    ("answered", "items answered"),
    ("items", "items of the score"),
];
const RELIABILITIES: &[(&str, &str)] = &[
    ("scale", "id of the questionnaire"),
    ("subscale", "id of the score"),
    ("items", "items"),
    ("n", "answer sheets on which every item is answered"),
    ("dropped", "answer sheets left out for a missing item"),
    ("people", "people who answered"),
    ("alpha", "Cronbach's alpha"),
    (
        "ci_low",
        "lower end of its 95 % interval (Feldt; a bootstrap over people where they answered several sheets)",
    ),
    ("ci_high", "upper end"),
    ("omega", "McDonald's omega"),
    ("mean", "mean score"),
    ("sd", "its standard deviation"),
    ("floor", "share of scores at the lowest possible value"),
    ("ceiling", "share of scores at the highest possible value"),
];
const ITEMS: &[(&str, &str)] = &[
    ("scale", "id of the questionnaire"),
    ("subscale", "id of the score"),
    ("item", "number of the item, from 1"),
    ("reversed", "whether it is scored the other way round"),
    ("n", "answers"),
    ("mean", "mean answer, after reversing"),
    ("sd", "its standard deviation"),
    ("r_rest", "correlation with the sum of the others"),
    ("alpha_dropped", "alpha without it"),
    ("floor", "share of answers at the lowest"),
    ("ceiling", "share of answers at the highest"),
];
const LEFT_OUT: &[(&str, &str)] = &[
    ("who", "person, or person and moment"),
    ("what", "what was left out"),
    ("why", "the reason"),
];
const ANSWERS: &[(&str, &str)] = &[
    PERSON,
    ("moment", "`pre`, or the condition after which it was asked"),
    ("scale", "id of the questionnaire"),
    ("item", "number of the item, from 1"),
    (
        "answer",
        "the answer as given; empty where the item was left out",
    ),
];
const EMBEDDING: &[(&str, &str)] = &[
    DRIVE,
    PERSON,
    CONDITION,
    (
        "adb_used",
        "whether the score of the style took part in the fit",
    ),
    ("adb", "the score of the style, in points"),
    (
        "adb_hat",
        "the score that the model reads from the embedding, in points",
    ),
    (
        "line_position",
        "place on the line of the style, in standard deviations of the drives learned from",
    ),
    ("readings", "events or rows that the fit rests on"),
    ("w*", "a coordinate of the embedding"),
    ("cov*", "an entry of its covariance"),
    (
        "line_position_se",
        "standard error of the place on the line",
    ),
];

/// Every file of a run.
pub const OUTPUTS: &[OutputFile] = &[
    OutputFile {
        name: "logs/**/*.mcap",
        what: "a recording, as it was driven",
        columns: &[],
    },
    OutputFile {
        name: "drives/**/*.parquet",
        what: "a drive, a row a sample of 100 ms; `maveric inspect DRIVE --csv OUT.csv` writes it as text",
        columns: &[
            ("time_s", "time since the start, in s"),
            ("segment", "rises by one after each hole too long to bridge"),
            ("ego_x_m", "position along the road, in m"),
            ("ego_y_m", "lateral position, in m"),
            ("ego_speed_mps", "speed, in m/s"),
            ("lane", "lane, 0 the right one"),
            ("lead_present", "whether there is a reference vehicle"),
            ("lead_id", "its number within the recording"),
            ("lead_dx_m", "bumper-to-bumper distance to it, in m"),
            ("lead_dy_m", "lateral distance to it, in m"),
            ("lead_speed_mps", "its speed, in m/s"),
            (
                "lane_change",
                "whether a lane change is being started (the second that ends at its start)",
            ),
            (
                "changing",
                "+1 while changing to the left, -1 to the right, 0 while keeping lane",
            ),
            (
                "change_completes",
                "whether the last row of a change completes it",
            ),
            ("following", "whether ego follows the reference vehicle"),
            ("following_distance_m", "`lead_dx_m` while following, in m"),
            (
                "gap_behind_left_m",
                "gap to the vehicle behind in the lane to the left, in m; empty beyond 200 m",
            ),
            ("gap_behind_right_m", "the same to the right"),
        ],
    },
    OutputFile {
        name: "drives.csv",
        what: "the drives of a folder",
        columns: &[
            DRIVE,
            PERSON,
            CONDITION,
            (
                "driven_by",
                "`human`, `synthetic` (a driver model) or `automated` (the learned car)",
            ),
            ("rows", "rows"),
            ("duration_s", "length, in s"),
        ],
    },
    OutputFile {
        name: "exclusions.csv",
        what: "logs and drives that were left out, and why",
        columns: &[
            DRIVE,
            ("log", "file of the log"),
            ("what", "what was left out, and why"),
            ("count", "how many rows or events"),
            PERSON,
            CONDITION,
            ("rule", "the rule of the design, or of what a car can do"),
            ("duration_s", "length of what was left out, in s"),
        ],
    },
    OutputFile {
        name: "participants.csv",
        what: "people; every further column may be a factor or a covariate",
        columns: &[
            PERSON,
            ("study", "which part a person takes"),
            ("population", "where they were recruited"),
            ("age", "years"),
            ("gender", "as given"),
            ("professional", "whether a professional driver"),
            ("order", "conditions in the order in which they were shown"),
            ("synthetic", "whether made up"),
            (
                "latent_*",
                "a trait that a made-up person was made from, in standard deviations",
            ),
        ],
    },
    OutputFile {
        name: "surveys.csv",
        what: "answers, a row an item",
        columns: ANSWERS,
    },
    OutputFile {
        name: "ratings.csv",
        what: "answers after each condition, a row an item",
        columns: ANSWERS,
    },
    OutputFile {
        name: "scores.csv",
        what: "scores of the questionnaires",
        columns: SCORES,
    },
    OutputFile {
        name: "rating_scores.csv",
        what: "scores after each condition",
        columns: SCORES,
    },
    OutputFile {
        name: "scores_reliabilities.csv",
        what: "how well the items of a score agree",
        columns: RELIABILITIES,
    },
    OutputFile {
        name: "rating_scores_reliabilities.csv",
        what: "the same, after the conditions",
        columns: RELIABILITIES,
    },
    OutputFile {
        name: "scores_items.csv",
        what: "item by item",
        columns: ITEMS,
    },
    OutputFile {
        name: "rating_scores_items.csv",
        what: "the same, after the conditions",
        columns: ITEMS,
    },
    OutputFile {
        name: "scores_exclusions.csv",
        what: "scores that could not be computed",
        columns: LEFT_OUT,
    },
    OutputFile {
        name: "rating_scores_exclusions.csv",
        what: "the same, after the conditions",
        columns: LEFT_OUT,
    },
    OutputFile {
        name: "model.maveric",
        what: "the trained model",
        columns: &[],
    },
    OutputFile {
        name: "model_training.json",
        what: "how it was trained: settings, losses, warnings",
        columns: &[],
    },
    OutputFile {
        name: "model_embeddings.csv",
        what: "embeddings of the drives learned from",
        columns: EMBEDDING,
    },
    OutputFile {
        name: "embeddings.csv",
        what: "embeddings of the people who were tested",
        columns: EMBEDDING,
    },
    OutputFile {
        name: "conditions.csv",
        what: "where in style space each condition lies for each person",
        columns: &[
            PERSON,
            CONDITION,
            ("adb_hat", "predicted score there, in points"),
            (
                "moved_points",
                "how far it lies from the person's own, in points, after an end of the scale cut it short",
            ),
            (
                "moved_points_sd",
                "how well that is known: standard deviation, in points",
            ),
            ("clamped", "whether an end of the scale cut it short"),
            ("angle_rad", "angle on the ellipse across the dial, in rad"),
            (
                "beyond_training",
                "whether it lies further out than any drive learned from",
            ),
            ("w*", "a coordinate of the embedding"),
            DRIVE,
            ("attribute", "what was moved along, in a sweep"),
            (
                "requested_points",
                "how far it should have moved, in its own points",
            ),
            ("attribute_points", "how far it moved within its range"),
        ],
    },
    OutputFile {
        name: "rollouts.csv",
        what: "what happened in each drive of the learned car",
        columns: &[
            DRIVE,
            ("collisions", "collisions"),
            (
                "rule_violations",
                "episodes nearer to the vehicle ahead than the safety rule allows",
            ),
            (
                "inside_safe_distance_s",
                "time inside the safe distance, in s",
            ),
            (
                "least_safe_distance_share",
                "least gap over the safe distance",
            ),
            ("interventions", "times the safety layer braked"),
            (
                "held_changes",
                "lane changes that were wished and not allowed",
            ),
            (
                "given_up_changes",
                "lane changes that were begun and given up",
            ),
            ("started_changes", "lane changes that were begun"),
            ("leads", "slower vehicles met"),
        ],
    },
    OutputFile {
        name: "measurements.parquet",
        what: "the objective measures, a row a drive",
        columns: &[
            DRIVE,
            PERSON,
            CONDITION,
            ("driven_by", "`human`, `synthetic` or `automated`"),
        ],
    },
    OutputFile {
        name: "analysis.json",
        what: "every result with every check: what the page is drawn from",
        columns: &[],
    },
];

impl OutputFile {
    /// Whether the entry is about the file of this path, `/` between its parts.
    pub fn is(&self, path: &str) -> bool {
        let file = path.rsplit('/').next().unwrap_or(path);
        match self.name.split_once("/**/*") {
            Some((_, ending)) => file.ends_with(ending) && file != "measurements.parquet",
            None => self.name == file,
        }
    }

    /// What a column means; of measurements also each measure.
    pub fn column(&self, wanted: &str) -> Option<String> {
        let known = self.columns.iter().find(|(name, _)| {
            let stem = name.strip_suffix('*');
            stem.map_or(*name == wanted, |stem| wanted.starts_with(stem))
        });
        let of_measure = || {
            let measured = self.name == "measurements.parquet";
            objective::find(wanted)
                .filter(|_| measured)
                .map(|m| format!("{} ({})", m.description, m.unit))
        };
        known
            .map(|(_, meaning)| (*meaning).to_owned())
            .or_else(of_measure)
    }
}

/// `docs/outputs.md`.
pub fn outputs_page() -> String {
    let mut out = String::from(
        "# What a run writes\n\nMade from `crates/study/src/dictionary.rs` and held against a run by `tests/outputs_dictionary.rs`; `UPDATE_GOLDEN=1 cargo test \
         --workspace --test outputs_dictionary` writes it anew.\n\nTables beside the page (`tables/*.csv`) hold numbers in full precision under the heads \
         that the page has; `*` stands for what differs from file to file or coordinate to coordinate.\n",
    );
    for file in OUTPUTS {
        let _ = write!(out, "\n## `{}`\n\n{}.\n", file.name, capital(file.what));
        if file.columns.is_empty() {
            continue;
        }
        out += "\n| column | means |\n|---|---|\n";
        for (name, meaning) in file.columns {
            let _ = writeln!(out, "| `{name}` | {meaning} |");
        }
        if file.name == "measurements.parquet" {
            for m in objective::all() {
                let _ = writeln!(
                    out,
                    "| `{}` | {} ({}) |",
                    m.name,
                    m.description.trim_end_matches('.'),
                    m.unit
                );
            }
        }
    }
    out
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}
