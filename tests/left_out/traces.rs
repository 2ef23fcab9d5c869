//! How somebody could be known again, and that nothing of it stands anywhere.

use super::*;

/// How somebody could be known again.
pub(crate) struct Traces {
    /// Words: the id, the pseudonym, coordinates of their style to six digits.
    words: Vec<String>,
    /// Speeds of each of their drives, in m/s.
    speeds: Vec<Vec<f64>>,
    /// The words as bytes, and eight successive speeds as `f64` and `f32`.
    patterns: [Patterns; 2],
}

impl Traces {
    /// Of those people in a study that was run.
    pub(crate) fn of(study: &TempStudy, people: &[&str]) -> Self {
        let key = blake3_key();
        let mut words: Vec<String> = Vec::new();
        for who in people {
            words.push((*who).to_owned());
            let hash = blake3::keyed_hash(&key, who.as_bytes()).to_hex();
            words.push(format!("P{}", &hash[..10]));
        }
        for table in ["embeddings.csv", "model_embeddings.csv"] {
            let rows = read_embeddings(&study.path("mine/results").join(table)).unwrap();
            for row in rows.iter().filter(|r| people.contains(&r.participant.as_str())) {
                let coordinates = row.embedding.coordinates().iter();
                words.extend(coordinates.map(|w| six_digits(*w)));
            }
        }
        let drives =
            ["mine/results/drives", "mine/results/av/drives"].map(|f| files(&study.path(f)));
        let mut speeds = Vec::new();
        for path in drives.concat().iter().filter(|p| p.extension().is_some_and(|e| e == "parquet"))
        {
            let drive = read_drive(path).unwrap();
            if people.contains(&drive.meta().participant.as_str()) {
                speeds.push(drive.rows().ego_speed_mps.clone());
            }
        }
        assert!(words.len() > 2 * people.len() && speeds.len() >= people.len());
        Self::by(words, speeds)
    }

    pub(crate) fn by(words: Vec<String>, speeds: Vec<Vec<f64>>) -> Self {
        let doubles = |eight: &[f64]| eight.iter().flat_map(|v| v.to_le_bytes()).collect();
        let singles = |eight: &[f64]| {
            let singles = eight.iter().map(|v| *v as f32);
            singles.flat_map(f32::to_le_bytes).collect()
        };
        let samples = eights(&speeds).flat_map(|eight| [doubles(eight), singles(eight)]);
        let bytes = words.iter().map(|word| word.clone().into_bytes());
        Self {
            patterns: [Patterns::of(bytes.collect()), Patterns::of(samples.collect())],
            words,
            speeds,
        }
    }

    /// The same without a word.
    pub(crate) fn samples_alone(&self) -> Self {
        Self::by(Vec::new(), self.speeds.clone())
    }

    /// A word that stands in a text.
    fn word_in(&self, text: &[u8]) -> Option<&str> {
        let at = self.patterns[0].first_in(text)?;
        Some(&self.words[at])
    }

    /// Whether eight successive samples stand among bytes, as `f64` or `f32`.
    fn samples_in_bytes(&self, bytes: &[u8]) -> bool {
        self.patterns[1].first_in(bytes).is_some()
    }

    /// Whether eight successive samples stand in a column, to a millimetre a second.
    fn samples_in(&self, column: &[f64]) -> bool {
        const NEAR: f64 = 6e-4;
        let mut eights: Vec<&[f64]> = eights(&self.speeds).collect();
        eights.sort_by(|a, b| a[0].total_cmp(&b[0]));
        column.windows(8).any(|window| {
            let from = eights.partition_point(|eight| eight[0] < window[0] - NEAR);
            let near = eights[from..].iter().take_while(|e| e[0] < window[0] + NEAR);
            let same = |eight: &&[f64]| eight.iter().zip(window).all(|(a, b)| (a - b).abs() < NEAR);
            near.copied().any(|eight| same(&eight))
        })
    }
}

/// Successive samples that are unlike each other, from all over each drive.
fn eights(speeds: &[Vec<f64>]) -> impl Iterator<Item = &[f64]> {
    let lively = |eight: &&[f64]| eight.windows(2).all(|w| (w[0] - w[1]).abs() > 2e-3);
    let all = speeds.iter().flat_map(|s| s.windows(8).step_by((s.len() / 40).max(1)));
    all.filter(lively)
}

fn blake3_key() -> [u8; 32] {
    blake3::derive_key("maveric study export pseudonyms v1", KEY.as_bytes())
}

/// A number as text, cut after six significant digits: it begins every longer way to write it.
fn six_digits(w: f64) -> String {
    let text = w.to_string();
    let mut digits = 0;
    let mut started = false;
    let end = text.char_indices().find(|(_, c)| {
        started |= c.is_ascii_digit() && *c != '0';
        digits += usize::from(started && c.is_ascii_digit());
        digits > 6
    });
    text[..end.map_or(text.len(), |(at, _)| at)].to_owned()
}

/// Patterns by their first two bytes, so that a text is gone through once.
struct Patterns {
    all: Vec<Vec<u8>>,
    by_start: Vec<Vec<usize>>,
}

impl Patterns {
    fn of(all: Vec<Vec<u8>>) -> Self {
        let mut by_start = vec![Vec::new(); 1 << 16];
        for (at, pattern) in all.iter().enumerate() {
            by_start[start(pattern)].push(at);
        }
        Self { all, by_start }
    }

    /// The pattern that stands first.
    fn first_in(&self, text: &[u8]) -> Option<usize> {
        (0..text.len().saturating_sub(1)).find_map(|from| {
            let candidates = &self.by_start[start(&text[from..])];
            let stands = |at: &&usize| text[from..].starts_with(&self.all[**at]);
            candidates.iter().find(stands).copied()
        })
    }
}

fn start(bytes: &[u8]) -> usize {
    usize::from(bytes[0]) << 8 | usize::from(bytes[1])
}

/// Reads every byte of the files, and what they hold: no trace is there. `may_name` says where the id itself may stand.
#[track_caller]
pub(crate) fn nowhere(
    study: &TempStudy,
    folder: &str,
    traces: &Traces,
    skip: impl Fn(&str) -> bool,
) {
    let root = study.path(folder);
    let mut read = 0;
    for path in files(&root) {
        let name = path.strip_prefix(&root).unwrap().to_string_lossy().into_owned();
        if skip(&name) {
            continue;
        }
        read += 1;
        let kind = path.extension().unwrap_or_default();
        assert_eq!(traces.word_in(name.as_bytes()), None, "the name of {name}");
        let bytes = std::fs::read(&path).unwrap();
        let mut texts = vec![bytes];
        if name.ends_with("analysis.json") {
            // The flow lists those who are left out, each with the reason.
            let mut json: serde_json::Value = serde_json::from_slice(&texts[0]).unwrap();
            json.as_object_mut().unwrap().remove("flow");
            texts[0] = json.to_string().into_bytes();
        }
        if kind == "html" {
            let inside = embedded(&texts[0]);
            texts.extend(inside);
        }
        for text in &texts {
            if let Some(word) = traces.word_in(text) {
                let at = text.windows(word.len()).position(|w| w == word.as_bytes()).unwrap();
                let around = &text[at.saturating_sub(120)..(at + 120).min(text.len())];
                panic!("{word} is in {name}: {}", String::from_utf8_lossy(around));
            }
            assert!(!traces.samples_in_bytes(text), "samples in {name}");
        }
        if kind == "parquet" {
            let table = Table::read(&path).unwrap();
            for column in table.columns() {
                if let Ok(words) = table.text(&column) {
                    let words: Vec<String> = words.into_iter().flatten().collect();
                    assert_eq!(traces.word_in(words.join("\n").as_bytes()), None, "{name}");
                }
                if let Ok(numbers) = table.numbers(&column) {
                    let numbers: Vec<f64> = numbers.into_iter().flatten().collect();
                    assert!(!traces.samples_in(&numbers), "samples in {name}, {column}");
                }
            }
        }
        if kind == "mcap" {
            let out = study.path("decoded");
            let _ = std::fs::remove_dir_all(&out);
            let args = ["ingest", path.to_str().unwrap(), "--out", "decoded"];
            study.maveric(&args).ok();
            for drive in
                files(&out).iter().filter(|p| p.extension().is_some_and(|e| e == "parquet"))
            {
                let drive = read_drive(drive).unwrap();
                let who = drive.meta().participant.as_str().to_owned();
                assert_eq!(traces.word_in(who.as_bytes()), None, "{name}");
                assert!(!traces.samples_in(&drive.rows().ego_speed_mps), "samples in {name}");
            }
        }
    }
    assert!(read > 3, "{read} files of {folder}");
}

/// What stands in a page as base64.
fn embedded(page: &[u8]) -> Vec<Vec<u8>> {
    use base64::Engine as _;
    let is_letter = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'/');
    let runs = page.split(|b| !is_letter(b)).filter(|run| run.len() >= 64);
    let decode = |run: &[u8]| {
        let engine = base64::engine::general_purpose::STANDARD_NO_PAD;
        engine.decode(run).ok()
    };
    runs.filter_map(decode).collect()
}
