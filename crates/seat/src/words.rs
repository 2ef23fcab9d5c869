//! The sentences that the seat says to whoever takes part and to whoever runs the study: a file a language, each of which a study may
//! replace.

use crate::{error::SeatError, escaped::plain};
use maveric_domain::{
    Design,
    design::{Car, Donors, Protocol},
    nearest,
};
use maveric_study::{DesignFile, atomic_write::read_text};
use path_slash::PathExt as _;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
    sync::LazyLock,
};

type Sentences = BTreeMap<String, String>;

/// The languages that the seat speaks by itself.
const SHIPPED: [(&str, &str); 2] =
    [(ENGLISH, include_str!("../words/en.toml")), ("de", include_str!("../words/de.toml"))];
const ENGLISH: &str = "en";
/// How the name of a sentence of the experimenter's page begins.
const TO_EXPERIMENTER: &str = "lab_";
/// What is said only where the style of somebody who takes part may be lent: no other study has to have it in a language of its own.
const WHERE_STYLES_ARE_LENT: &str = "lend_sentence";

/// What every language has to say.
static IN_ENGLISH: LazyLock<Sentences> = LazyLock::new(|| shipped(ENGLISH).unwrap_or_default());

/// The sentences of a language that the seat speaks by itself.
fn shipped(language: &str) -> Option<Sentences> {
    let (_, text) = SHIPPED.iter().find(|(known, _)| *known == language)?;
    toml::from_str(text).ok()
}

/// Whether the style of somebody who takes part may be lent: in a condition that lends, of those who ride or of those whom a model of this study learns from.
fn may_lend(design: &Design) -> bool {
    design.conditions().iter().any(|condition| {
        let Some(Car::Matched(matched)) = &condition.car else {
            return false;
        };
        matched.from == Donors::Tested || design.model().is_none()
    })
}

/// The English sentence of this name, for whoever runs the study.
pub(crate) fn in_english(name: &str) -> &'static str {
    IN_ENGLISH.get(name).map_or("", String::as_str)
}

/// All that a study says to whoever takes part.
#[derive(Debug, Clone)]
pub struct Words {
    /// As the web writes it.
    pub(crate) language: String,
    sentences: Sentences,
}

impl Default for Words {
    fn default() -> Self {
        Self { language: ENGLISH.to_owned(), sentences: IN_ENGLISH.clone() }
    }
}

impl Words {
    /// Those of a study in a language, with its own in their place: of another language than the study's in a file named by it, where
    /// that is there (`words.de.toml`).
    ///
    /// # Errors
    /// [`SeatError::Protocol`] for a language in which a sentence is missing, a sentence that the seat does not say, or one with other parts to
    /// be filled in; [`SeatError::Study`] for a file that cannot be read.
    pub fn of_study(study: &DesignFile, language: &str) -> Result<Self, SeatError> {
        let protocol = study.design.protocol();
        let lends = may_lend(&study.design);
        let file = protocol.words.as_ref();
        let file = file.map(|path| in_language(protocol, path, language));
        let applies =
            |path: &PathBuf| language == protocol.language || study.resolve(path).is_file();
        let Some(file) = file.filter(applies) else {
            return Self::for_language(language, None, lends);
        };
        let text = read_text(&study.resolve(&file))?;
        Self::for_language(language, Some((&file, &text)), lends)
    }

    /// Those of a language, with those of a file in their place; `lends` says whether the style of somebody who takes part may be lent.
    fn for_language(
        language: &str,
        file: Option<(&Path, &str)>,
        lends: bool,
    ) -> Result<Self, SeatError> {
        let name = file.map_or_else(String::new, |(file, _)| file.to_slash_lossy().into_owned());
        let replacements = file.map(|(_, text)| toml::from_str::<Sentences>(text));
        let replacements = replacements.transpose();
        let replacements = replacements.map_err(|e| {
            let help = "expected lines such as begin = \"Start\"";
            SeatError::cannot(format!("{name}: {}", e.message()), help)
        })?;
        let replacements = replacements.unwrap_or_default();
        for (key, sentence) in &replacements {
            let Some(english) = IN_ENGLISH.get(key) else {
                let known = IN_ENGLISH.keys().map(String::as_str);
                let help = nearest(key, known).map_or_else(
                    || "leave it out".to_owned(),
                    |near| format!("did you mean `{near}`?"),
                );
                return Err(SeatError::cannot(
                    format!("{name}: `{key}` is no sentence of the seat"),
                    &help,
                ));
            };
            if let Some(part) = parts(sentence).difference(&parts(english)).next() {
                return Err(SeatError::cannot(
                    format!("{name}: `{key}` names {{{part}}}, which nothing fills in"),
                    &format!("the sentence is: {english}"),
                ));
            }
        }
        let spoken = shipped(language);
        let speaks = spoken.is_some();
        let mut sentences = spoken.unwrap_or_default();
        sentences.extend(replacements);
        let lacking: Vec<&str> = IN_ENGLISH
            .keys()
            .filter(|key| lends || *key != WHERE_STYLES_ARE_LENT)
            .filter(|key| !sentences.contains_key(*key))
            .map(String::as_str)
            .collect();
        if !speaks && !lacking.is_empty() {
            let (all, lack) = (IN_ENGLISH.len(), lacking.len());
            let shipped = SHIPPED.map(|(language, _)| language).join(", ");
            return Err(SeatError::cannot(
                format!(
                    "[protocol] language is `{language}`, which the seat does not speak: {lack} of its {all} sentences are missing ({}{})",
                    lacking[..lack.min(5)].join(", "),
                    if lack > 5 { ", …" } else { "" }
                ),
                &format!(
                    "write them into a file, and `words` = its name into [protocol]; the seat speaks {shipped}"
                ),
            ));
        }
        Ok(Self { language: language.to_owned(), sentences })
    }

    /// Those of a language that the seat speaks by itself; English for another.
    pub(crate) fn shipped(language: &str) -> Self {
        let general = language.split('-').next().unwrap_or_default();
        shipped(general).map_or_else(Self::default, |sentences| Self {
            language: general.to_owned(),
            sentences,
        })
    }

    pub(crate) fn sentence(&self, name: &str) -> &str {
        self.sentences.get(name).map_or("", String::as_str)
    }

    /// A sentence with its parts filled in.
    pub(crate) fn say(&self, name: &str, parts: &[(&str, &str)]) -> String {
        let filled = |text: String, (part, value): &(&str, &str)| {
            text.replace(&format!("{{{part}}}"), value)
        };
        parts.iter().fold(self.sentence(name).to_owned(), filled)
    }

    /// The same as text of a page, which never becomes markup.
    pub(crate) fn plain(&self, name: &str, parts: &[(&str, &str)]) -> String {
        plain(&self.say(name, parts))
    }

    /// All sentences but those of the experimenter's page, as JSON that can stand in a page.
    pub(crate) fn for_page(&self) -> String {
        let to_person = |(name, _): &(&String, &String)| !name.starts_with(TO_EXPERIMENTER);
        let sentences: BTreeMap<_, _> = self.sentences.iter().filter(to_person).collect();
        let json = serde_json::to_string(&sentences).unwrap_or_default();
        json.replace('<', "\\u003c")
    }
}

/// The file of a language: `consent.de.md` beside `consent.md`, which is the study's language's.
pub(crate) fn in_language(protocol: &Protocol, path: &Path, language: &str) -> PathBuf {
    if language == protocol.language {
        return path.to_owned();
    }
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    path.with_extension(format!("{language}.{ending}"))
}

/// What is filled in, in a sentence.
fn parts(sentence: &str) -> BTreeSet<&str> {
    let after = sentence.split('{').skip(1);
    after.filter_map(|rest| Some(rest.split_once('}')?.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    fn of(language: &str, own: Option<&str>) -> Result<Words, SeatError> {
        let file = Path::new("words.toml");
        Words::for_language(language, own.map(|text| (file, text)), true)
    }

    fn refused(language: &str, own: Option<&str>) -> String {
        let error = of(language, own).unwrap_err();
        format!("{error}; {}", error.suggestion().unwrap_or_default())
    }

    #[test]
    fn a_file_of_another_language_is_named_by_it_and_so_is_its_fault() {
        let protocol = Protocol::default();
        let named = |language| in_language(&protocol, Path::new("texts/words.toml"), language);
        assert_eq!(named("en"), Path::new("texts/words.toml"));
        assert_eq!(named("de"), Path::new("texts/words.de.toml"));
        let wrong = Words::for_language("de", Some((&named("de"), "beginn = \"Los\"")), false);
        let told = wrong.unwrap_err().to_string();
        assert!(told.contains("words.de.toml"), "{told}");
    }

    #[test]
    fn every_language_says_the_same_sentences_with_the_same_parts() {
        for (language, text) in SHIPPED {
            let sentences: Sentences = toml::from_str(text).unwrap();
            let names = |s: &Sentences| s.keys().cloned().collect::<Vec<_>>();
            assert_eq!(names(&sentences), names(&IN_ENGLISH), "{language}");
            for (name, sentence) in &sentences {
                let english = &IN_ENGLISH[name];
                assert_eq!(parts(sentence), parts(english), "{language}: {name}");
                let keys = |s: &str| s.matches('[').count();
                assert_eq!(keys(sentence), keys(english), "{language}: {name}");
            }
        }
    }

    /// What the scripts and the page name, between these marks.
    fn named(files: &[(PathBuf, String)], before: &str) -> BTreeSet<String> {
        let texts = files.iter().flat_map(|(_, text)| text.split(before).skip(1));
        let names = texts.filter_map(|rest| Some(rest.split_once('"')?.0.to_owned()));
        names.collect()
    }

    #[test]
    fn the_page_says_every_sentence_and_no_other_and_has_none_of_its_own() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("page/src");
        let files: Vec<(PathBuf, String)> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.extension().is_some_and(|e| e == "ts" || e == "html"))
            .map(|path| (path.clone(), std::fs::read_to_string(path).unwrap()))
            .collect();
        let marks = ["say(\"", "data-say=\"", "data-label=\""];
        let said: BTreeSet<String> = marks.iter().flat_map(|m| named(&files, m)).collect();
        let all = |name: &String| IN_ENGLISH.contains_key(name);
        let unknown: Vec<_> = said.iter().filter(|name| !all(name)).collect();
        assert!(unknown.is_empty(), "{unknown:?}");
        // Some are chosen between two, or named in a list; some are said by the server alone.
        let by_server =
            ["withdraw_sentence", "crash_sentence", "lend_sentence", "aftercare", "debrief_title"];
        let by_page = |name: &&String| !by_server.contains(&name.as_str());
        let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let sources: Vec<String> = std::fs::read_dir(sources)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.extension().is_some_and(|e| e == "rs"))
            .map(|path| std::fs::read_to_string(path).unwrap())
            .collect();
        for name in IN_ENGLISH.keys().filter(by_page) {
            let quoted = format!("\"{name}\"");
            let used = if name.starts_with(TO_EXPERIMENTER) {
                sources.iter().any(|text| text.contains(&quoted))
            } else {
                files.iter().any(|(_, text)| text.contains(&quoted))
            };
            assert!(used, "`{name}` is said nowhere");
        }
        for (path, text) in files.iter().filter(|(p, _)| p.extension().is_some_and(|e| e == "ts")) {
            for (number, line) in (1..).zip(text.lines()) {
                let code = line.split("//").next().unwrap();
                for string in code.split('"').skip(1).step_by(2) {
                    let sentence = string.contains(' ')
                        && string.starts_with(|c: char| c.is_ascii_uppercase());
                    assert!(!sentence, "{}:{number}: {string}", path.to_slash_lossy());
                }
            }
        }
    }

    #[test]
    fn a_study_replaces_sentences_and_the_rest_stays() {
        let words = of("de", Some("begin = \"Los\"")).unwrap();
        assert_eq!(words.sentences["begin"], "Los");
        assert_eq!(words.sentences["continue"], "Weiter");
        let english = of("en", None).unwrap();
        assert_eq!(english.sentences["begin"], "Begin");
        let said = words.say("withdraw_sentence", &[("until", "2026-12-31")]);
        assert!(said.starts_with("Bis 2026-12-31"), "{said}");
    }

    #[test]
    fn a_language_of_which_sentences_are_missing_is_refused_and_one_that_is_whole_is_spoken() {
        let told = refused("fr", Some("begin = \"Commencer\""));
        let all = IN_ENGLISH.len();
        let lacks = format!("{} of its {all}", all - 1);
        assert!(told.contains("`fr`") && told.contains(&lacks), "{told}");
        assert!(told.contains("aborted, ") && told.contains("en, de"), "{told}");
        let whole = toml::to_string(&*IN_ENGLISH).unwrap();
        assert_eq!(of("fr", Some(&whole)).unwrap().language, "fr");
        // What is said where styles are lent has to be there where they are, and nowhere else.
        let mut without = IN_ENGLISH.clone();
        without.remove(WHERE_STYLES_ARE_LENT).unwrap();
        let without = toml::to_string(&without).unwrap();
        let told = refused("fr", Some(&without));
        assert!(told.contains(WHERE_STYLES_ARE_LENT), "{told}");
        let file = Some((Path::new("words.toml"), without.as_str()));
        assert_eq!(Words::for_language("fr", file, false).unwrap().language, "fr");
    }

    #[test]
    fn a_style_may_be_lent_of_those_who_ride_or_are_learned_from_here_and_of_nobody_else() {
        let may = |learned: &str, car: &str| {
            let text = format!(
                "[study]\ntitle = \"Two\"\n{learned}\n[style]\nscore = \"adb.total\"\n[baseline]\nid = \"own\"\n\
                 [[condition]]\nid = \"other\"\ncar = {{ {car}, recorded = true }}\n"
            );
            may_lend(&Design::from_toml(&text).unwrap())
        };
        let here = "[people]\nlearn = { part = \"learn\" }";
        let elsewhere = "[model]\nfile = \"lab.maveric\"";
        let (tested, learned) = ("other = \"matched\"", "other = \"matched\", from = \"learned\"");
        assert!(may(here, tested) && may(here, learned) && may(elsewhere, tested));
        assert!(!may(elsewhere, learned) && !may(here, "mean = true"));
    }

    #[test]
    fn a_sentence_that_the_seat_does_not_say_or_cannot_fill_in_is_refused() {
        let told = refused("en", Some("begins = \"Go\""));
        assert!(told.contains("`begins`") && told.contains("`begin`"), "{told}");
        let told = refused("en", Some("ride = \"Ride {nr}\""));
        assert!(told.contains("{nr}") && told.contains("{number}"), "{told}");
        let told = refused("en", Some("begin = 3"));
        assert!(told.contains("words.toml"), "{told}");
    }

    #[test]
    fn a_part_that_is_filled_in_is_text_and_what_the_experimenter_reads_goes_to_nobody_else() {
        let words = Words::default();
        let parts = [("step", "3"), ("who", "<b>"), ("of", "9")];
        assert_eq!(words.say("lab_step_title", &parts), "Step 3 of <b>");
        assert_eq!(words.plain("lab_step_title", &parts), "Step 3 of &lt;b&gt;");
        let page = words.for_page();
        assert!(page.contains("\"begin\"") && !page.contains(TO_EXPERIMENTER));
    }

    #[test]
    fn no_sentence_ends_the_place_in_the_page_where_it_stands() {
        let words = of("en", Some("begin = \"</script><b>\"")).unwrap();
        assert!(!words.for_page().contains('<'));
        let read: Sentences = serde_json::from_str(&words.for_page()).unwrap();
        assert_eq!(read["begin"], "</script><b>");
    }
}
