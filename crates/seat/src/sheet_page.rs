//! A questionnaire as a page of its own, for whoever judges a study: one file, drawn by the seat's own script and style.

use crate::{
    Hindrance, SeatError, Words, assets,
    escaped::plain,
    steps::{Step, sheet},
};
use maveric_domain::{Moment, Scale};
use maveric_study::{DesignFile, atomic_write::atomic_write_bytes};
use std::path::Path;

/// The pages that were written, and the questionnaires of which there is none, each with the reason.
#[derive(Debug, Default)]
pub struct SheetPages {
    pub written: Vec<String>,
    pub lacking: Vec<String>,
}

/// Writes a page a questionnaire into a folder, in the language of the study and with its own sentences where it has some; without a
/// study in each questionnaire's language.
///
/// # Errors
/// [`SeatError::Study`] for a page that cannot be written; as [`Words::of_study`] for sentences of the study that cannot be said.
pub fn write_sheet_pages(
    scales: &[Scale],
    study: Option<&DesignFile>,
    folder: &Path,
) -> Result<SheetPages, SeatError> {
    let language = study.map(|study| study.design.protocol().language.as_str());
    let own_words = match study.zip(language) {
        Some((study, language)) if study.design.protocol().words.is_some() => {
            Some(Words::of_study(study, language)?)
        }
        _ => None,
    };
    let mut pages = SheetPages::default();
    for scale in scales {
        let language = language.unwrap_or(&scale.language);
        match sheet(scales, &scale.id, Moment::Pre, language) {
            Ok(step) => {
                let words = own_words.clone();
                let words = words.unwrap_or_else(|| Words::shipped(language));
                let page = page(scale, &step, (language, &words));
                let name = format!("{}.html", scale.id);
                atomic_write_bytes(&folder.join(&name), page.as_bytes())?;
                pages.written.push(name);
            }
            Err(hindrance) => pages.lacking.push(lacking(&hindrance)),
        }
    }
    Ok(pages)
}

/// Why there is no page of a questionnaire, whoever asks it.
fn lacking(hindrance: &Hindrance) -> String {
    match hindrance {
        Hindrance::NoWording { scale, worded, items } => {
            format!("scale `{scale}` has wording for {worded} of {items} items")
        }
        Hindrance::NoTranslation { scale, language, languages } => {
            format!("scale `{scale}` is there in {}, not in `{language}`", languages.join(", "))
        }
        other => other.to_string(),
    }
}

fn page(scale: &Scale, step: &Step, (language, words): (&str, &Words)) -> String {
    let text = |name: &str| String::from_utf8_lossy(assets::bytes(name)).into_owned();
    let (style, script) = (text("page.css"), text("sheet.js"));
    let sheet_json = serde_json::to_string(step).unwrap_or_default();
    let sheet_json = sheet_json.replace('<', "\\u003c");
    let words = words.for_page();
    let (title, language) = (plain(&scale.title), plain(language));
    format!(
        "<!doctype html>\n<html lang=\"{language}\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{style}</style>\n<main id=\"main\" tabindex=\"-1\"></main>\n\
         <script id=\"words\" type=\"application/json\">{words}</script>\n\
         <script id=\"sheet\" type=\"application/json\">{sheet_json}</script>\n<script>\n{script}</script>\n</html>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_holds_all_that_it_needs_and_no_answer_that_is_expected() {
        let scale = "id = \"read\"\ntitle = \"Read <b>\"\nreference = \"made up\"\nmin = 1\nmax = 7\n\
                     [[item]]\ntext = \"Tick </script> 2.\"\nexpected = 2\n[translation.de]\nitems = [\"Kreuzen Sie 2 an.\"]\n";
        let bare = scale.replace("text = \"Tick </script> 2.\"\n", "").replace("read", "bare");
        let bare = bare.split("[translation").next().unwrap().to_owned();
        let scales = [scale, &bare].map(|text| Scale::from_toml(text).unwrap());
        let folder = tempfile::tempdir().unwrap();
        let pages = write_sheet_pages(&scales, None, folder.path()).unwrap();
        assert_eq!(pages.written, ["read.html"]);
        assert!(pages.lacking[0].contains("`bare`") && pages.lacking[0].contains("0 of 1"));
        let read = || std::fs::read_to_string(folder.path().join("read.html")).unwrap();
        let page = read();
        assert!(page.contains("Tick \\u003c/script> 2.") && page.contains("<title>Read &lt;b&gt;"));
        assert!(page.contains("\"expected\":null") && page.contains(".points"));
        for elsewhere in ["src=", "href=", "@import", "url("] {
            assert!(!page.contains(elsewhere), "{elsewhere}");
        }
        let write_in = |protocol: &str| {
            let study = study_in(folder.path(), protocol);
            write_sheet_pages(&scales, Some(&study), folder.path())
        };
        write_in("language = \"de\"").unwrap();
        let page = read();
        assert!(page.contains("Kreuzen Sie 2 an.") && page.contains("Weiter"));
        let none = write_in("language = \"nl\"").unwrap();
        assert!(none.written.is_empty() && none.lacking[0].contains("not in `nl`"), "{none:?}");
    }

    /// A study with this in its `[protocol]`.
    fn study_in(folder: &Path, protocol: &str) -> DesignFile {
        let design = folder.join("study.toml");
        let text = format!(
            "[study]\ntitle = \"Read\"\n[baseline]\nid = \"own\"\n[[condition]]\nid = \"x\"\ncar = {{ recorded = true }}\n\
             [protocol]\nsteps = [\"controls\", \"drive\"]\n{protocol}\n"
        );
        std::fs::write(&design, text).unwrap();
        DesignFile::read(&design).unwrap()
    }

    #[test]
    fn a_page_says_the_sentences_that_the_study_has_in_the_place_of_the_seats() {
        let scale = "id = \"read\"\ntitle = \"Read\"\nreference = \"made up\"\nmin = 1\nmax = 7\nwording = [\"I read.\"]\n\
                     [translation.de]\nitems = [\"Ich lese.\"]\n";
        let scales = [Scale::from_toml(scale).unwrap()];
        let folder = tempfile::tempdir().unwrap();
        let written = |words: &str| {
            std::fs::write(folder.path().join("words.toml"), words).unwrap();
            let study = study_in(folder.path(), "language = \"de\"\nwords = \"words.toml\"");
            write_sheet_pages(&scales, Some(&study), folder.path())
        };
        written("continue = \"Auf zur nächsten Seite\"").unwrap();
        let page = std::fs::read_to_string(folder.path().join("read.html")).unwrap();
        assert!(page.contains("\"continue\":\"Auf zur nächsten Seite\""));
        assert!(page.contains("Ich lese.") && !page.contains("\"Weiter\""));
        let refused = written("kontinue = \"Weiter\"").unwrap_err().to_string();
        assert!(refused.contains("words.toml") && refused.contains("`kontinue`"), "{refused}");
        std::fs::remove_file(folder.path().join("words.toml")).unwrap();
        let study = study_in(folder.path(), "language = \"de\"\nwords = \"words.toml\"");
        let gone = write_sheet_pages(&scales, Some(&study), folder.path());
        assert!(gone.unwrap_err().to_string().contains("words.toml"));
    }
}
