//! The commented `study.toml` of a new study.

use maveric_domain::{ConditionId, design::ScoreName};
use std::fmt::Write as _;

/// What the text is to say.
pub(super) struct Wanted<'a> {
    pub(super) conditions: &'a [ConditionId],
    /// The score that the dial turns, and its range; none where every car was recorded elsewhere.
    pub(super) style: Option<(&'a ScoreName, [f64; 2])>,
    pub(super) synthetic: bool,
}

/// A third of the range, to two digits: 15 points of the 44 of the ADB scale.
fn step([low, high]: [f64; 2]) -> f64 {
    let third = (high - low) / 3.0;
    let digit = 10f64.powi(libm::log10(third).floor() as i32 - 1);
    let rounded = (third / digit).round() * digit;
    // No tail of binary digits in the file.
    (rounded * 1e6).round() / 1e6
}

/// The text; it reads as a design.
pub(super) fn study_text(wanted: &Wanted<'_>) -> String {
    let mut text = format!(
        "# What this study is. Every command obeys this file; a key that is not known is an error that names it.\n\n\
         [study]\n\
         title = \"A study\"                      # heads the page\n\
         authors = []\n\
         synthetic = {}                      # true puts a banner on every page: the people are made up\n\n\
         [files]                                # paths from this file's folder\n\
         logs = \"logs\"\n\
         mapping = \"mapping.toml\"\n\
         answers = \"surveys/answers.csv\"\n",
        wanted.synthetic
    );
    text.push_str(if wanted.synthetic {
        "software = \"table\"                     # participant, moment, scale, item, answer; or \"otree\", \"jspsych\"\neffects = \"effects.toml\"\n"
    } else {
        "software = \"otree\"                     # any table with a row a participant; or \"jspsych\", or \"table\": participant, moment, scale, item, answer\n\
         columns = \"surveys/columns.toml\"\n"
    });
    text.push_str("scales = \"scales\"\nscenario = \"scenario.toml\"\n# claims = \"claims.toml\"               # a ledger of what others reported, beside yours\n\n[people]\nfile = \"participants.csv\"               # a row a person; every further column may be a factor or a covariate\n");
    match wanted.style {
        None => text.push_str(
            "# learn = { part = \"learn\" }             # whose drives the networks learn from; left out, nobody's\n\
             # test = { part = \"test\" }               # who sat through the conditions; left out, everybody else\n\n",
        ),
        Some((score, range)) => {
            let [low, high] = range;
            let _ = write!(
                text,
                "learn = {{ part = \"learn\" }}             # whose drives the networks learn from: column = value\n\
                 test = {{ part = \"test\" }}               # who sat through the conditions\n\n\
                 [style]                                # what the dial turns\n\
                 score = \"{score}\"\n\
                 range = [{low}, {high}]\n\
                 points = {}                            # a step of the dial\n\n",
                step(range)
            );
        }
    }
    let middle = (wanted.conditions.len() as f64 - 1.0) / 2.0;
    for (place, id) in wanted.conditions.iter().enumerate() {
        let car = if wanted.style.is_some() {
            let steps = place as f64 - middle;
            let sign = if steps > 0.0 { "+" } else { "" };
            format!(
                "{{ dial = \"{sign}{steps}\" }}                 # steps from the person's own style; or {{ across = true }}, {{ mean = true }}, {{ recorded = true }}"
            )
        } else {
            "{ recorded = true }               # the car was yours, its logs are read".to_owned()
        };
        let _ = write!(
            text,
            "[[condition]]\nid = \"{id}\"\nlabel = \"{}\"\ncar = {car}\n\n",
            label(*id)
        );
    }
    text.push_str(
        "[baseline]                             # the drive by hand that differences are taken from; leave it out where there is none\nid = \"own\"\nlabel = \"Own\"\nby = \"hand\"\n\n\
         # [[outcome]]                          # what is tested; left out: all objective measures and every scale asked after a condition\n\
         # measure = \"mean_headway_time_s\"\n\
         # [[outcome]]\n\
         # scale = \"jian_trust.overall\"\n\n\
         [contrasts]\n\
         compare = \"all\"                        # or \"against ID\", or [[\"a\", \"b\"], …]\n\n\
         # [[hypothesis]]\n\
         # says = \"…\"\n\
         # outcome = \"mean_headway_time_s\"\n",
    );
    if let [first, .., last] = wanted.conditions {
        let _ = writeln!(text, "# contrast = [\"{last}\", \"{first}\"]");
    }
    text.push_str(
        "# direction = \"-\"                      # or equivalent = [-0.1, 0.1]\n\n\
         [exclude]                              # before anything is computed, everywhere, listed with its reason\n\
         # people = { P07 = \"withdrew consent\" }\n\
         # drives = { \"P03-ID\" = \"simulator sickness\" }\n\
         # drive_shorter_than_s = 300\n",
    );
    text
}

fn label(id: ConditionId) -> String {
    let word = id.as_str().replace(['_', '-'], " ");
    let mut letters = word.chars();
    let first = letters.next().map(|c| c.to_ascii_uppercase());
    first.into_iter().chain(letters).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{Design, design::Condition};

    fn of(conditions: &[&str], style: Option<(&str, [f64; 2])>) -> Design {
        let ids: Vec<ConditionId> = conditions.iter().map(|c| c.parse().unwrap()).collect();
        let score = style.map(|(name, range)| (name.parse::<ScoreName>().unwrap(), range));
        let text = study_text(&Wanted {
            conditions: &ids,
            style: score.as_ref().map(|(name, range)| (name, *range)),
            synthetic: false,
        });
        Design::from_toml(&text).unwrap()
    }

    #[test]
    fn what_init_writes_is_a_design() {
        let none = of(&["calm", "normal", "sporty"], None);
        assert!(none.conditions().iter().all(|c| c.car.is_none()) && none.style().is_none());
        let five = of(
            &["a", "b", "c", "d", "e"],
            Some(("adb.total", [11.0, 55.0])),
        );
        let dials: Vec<f64> = five
            .conditions()
            .iter()
            .filter_map(Condition::dial)
            .collect();
        assert!(
            dials
                .iter()
                .zip([-30.0, -15.0, 0.0, 15.0, 30.0])
                .all(|(a, b)| (a - b).abs() < 1e-9)
        );
        let risky = of(&["calm", "sporty"], Some(("mdsi.risky", [1.0, 6.0])));
        assert!((risky.conditions()[1].dial().unwrap() - 0.85).abs() < 1e-9);
    }
}
