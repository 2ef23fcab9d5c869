//! The keys of a pipeline file: what the reader accepts and editors complete.

/// What a key's value may be.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Kind {
    Name,
    Text,
    Texts,
    Flag,
    /// A whole number from 1 on.
    Count,
    /// Values by name: strings, decimal numbers, booleans.
    Values,
    /// Arrays of values by name.
    Lists,
    /// A table with keys of its own.
    Table(&'static [Key]),
    /// Several of them.
    Tables(&'static [Key]),
}

/// A key of the file or of one of its tables.
#[derive(Debug)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    pub(crate) required: bool,
    pub(crate) about: &'static str,
}

const fn key(name: &'static str, kind: Kind, about: &'static str) -> Key {
    Key { name, kind, required: false, about }
}

const fn required(name: &'static str, kind: Kind, about: &'static str) -> Key {
    Key { required: true, ..key(name, kind, about) }
}

/// The keys at the top.
pub(crate) const TOP_KEYS: &[Key] = &[
    required("name", Kind::Name, "Names the pipeline in its ledger."),
    key(
        "extends",
        Kind::Text,
        "Another pipeline file, from the folder of this one: its stages and parameters, save \
         those that this file has itself.",
    ),
    key(
        "params",
        Kind::Values,
        "Parameters: `{name}` in a stage, or in another parameter, stands for the value; \
         `--set name=VALUE` replaces it for a run.",
    ),
    key(
        "stage",
        Kind::Tables(STAGE_KEYS),
        "The steps, in any order; one with the name of a stage in the file that this one extends \
         replaces it.",
    ),
];

/// What a `[[stage]]` may have.
pub(crate) const STAGE_KEYS: &[Key] = &[
    required(
        "name",
        Kind::Name,
        "Its name: letters, digits, `_` and `-`. Of a fan-out, the name of all its stages together.",
    ),
    required(
        "cmd",
        Kind::Texts,
        "Program and arguments, a string each. No shell is between: for one, write \
         [\"sh\", \"-c\", \"...\"].",
    ),
    key(
        "inputs",
        Kind::Texts,
        "Files or whole directories that it reads, relative to the root. Of a command of `maveric` \
         they follow from its words.",
    ),
    key(
        "outputs",
        Kind::Texts,
        "Files or whole directories that it makes, and no other stage. Of a command of `maveric` \
         they follow from its words.",
    ),
    key(
        "version",
        Kind::Text,
        "The version of what its command computes: another one makes the stage run again.",
    ),
    key("summary", Kind::Flag, "Whether its standard output is shown at the end of a run."),
    key("inputs_help", Kind::Text, "How to get its inputs, said when one is missing."),
    key(
        "foreach",
        Kind::Text,
        "A CSV table, relative to the root: a stage for each distinct combination of the columns \
         that stand in braces in its command and paths.",
    ),
    key(
        "matrix",
        Kind::Lists,
        "Lists of values by name: a stage for each combination, with the names in braces.",
    ),
    key(
        "shards",
        Kind::Count,
        "Cuts the stage into so many; `{shard}` is the number from 0, `{shards}` how many.",
    ),
    key(
        "over",
        Kind::Text,
        "The files that are dealt out over the shards: a directory, or a directory and names \
         with one `*`. The word `{files}` of cmd stands for a shard's files.",
    ),
    key(
        "retries",
        Kind::Count,
        "How many times it is tried again after a failure; none when not given.",
    ),
    key(
        "resources",
        Kind::Table(RESOURCE_KEYS),
        "What it asks of a machine or a cluster; no part of what its outputs are made from.",
    ),
];

/// What `resources` of a stage may have.
pub(crate) const RESOURCE_KEYS: &[Key] = &[
    key("cpus", Kind::Count, "Processor cores; only a cluster counts them."),
    key(
        "memory_mb",
        Kind::Count,
        "Memory in MiB: stages run at once only as long as it is enough for all of them.",
    ),
    key("minutes", Kind::Count, "The longest that it may run."),
];
