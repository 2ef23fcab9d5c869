//! What to cite: this program, and the paper whose method it implements. `CITATION.cff` at the top of the project says the same, for
//! sites that read it there; a test holds the two together.

use serde::Serialize;
use std::fmt::Write as _;

/// An entry of a bibliography.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Entry {
    /// BibTeX's word for the kind of thing.
    pub(crate) kind: &'static str,
    /// Under which it is cited.
    pub(crate) key: &'static str,
    /// Fields in BibTeX's names, in the order in which they are printed.
    pub(crate) fields: Vec<(&'static str, String)>,
}

impl Entry {
    pub(crate) fn bibtex(&self) -> String {
        let mut text = format!("@{}{{{},\n", self.kind, self.key);
        for (name, value) in &self.fields {
            // Writing into a text cannot fail.
            let _ = writeln!(text, "  {name} = {{{value}}},");
        }
        text + "}"
    }
}

/// The program, then the paper.
pub(crate) fn entries() -> [Entry; 2] {
    let software = [
        ("title", "{MAVERIC}: driving styles learned, driven and studied"),
        ("author", "{The MAVERIC founders}"),
        ("year", "2026"),
        ("version", env!("MAVERIC_VERSION")),
    ];
    let paper = [
        ("title", "{MAVERIC}: A Data-Driven Approach to Personalized Autonomous Driving"),
        ("author", "Schrum, Mariah L. and Sumner, Emily and Gombolay, Matthew C. and Best, Andrew"),
        ("year", "2023"),
        ("eprint", "2301.08595"),
        ("archiveprefix", "arXiv"),
    ];
    let owned = |fields: &[(&'static str, &str)]| {
        let field = |&(name, value): &(&'static str, &str)| (name, value.to_owned());
        fields.iter().map(field).collect()
    };
    [
        Entry { kind: "software", key: "maveric_software", fields: owned(&software) },
        Entry { kind: "misc", key: "schrum2023maveric", fields: owned(&paper) },
    ]
}
