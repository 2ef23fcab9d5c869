//! The shell script that is one stage's task.
//!
//! A task may run twice, even at the same time: a node that was given up may go on. So each
//! run works in a directory of its own, in which it sees the stage's inputs and nothing
//! else, and moves its outputs to their places at the end, if nobody has before.

use std::path::Path;

use crate::paths::with_ancestors;
use crate::shell::quoted;
use crate::{Place, Stage};

/// The file that tells how task `index` ended: exit status and seconds.
pub(super) fn ending(spool: &Path, index: u32) -> std::path::PathBuf {
    spool.join(format!("{index}.ended"))
}

/// The task's script; without it, a task that runs nevertheless leaves its outputs alone.
pub(super) fn script(spool: &Path, index: u32) -> std::path::PathBuf {
    spool.join(format!("{index}.sh"))
}

/// What it printed: `out` or `err`.
pub(super) fn printed(spool: &Path, index: u32, stream: &str) -> std::path::PathBuf {
    spool.join(format!("{index}.{stream}"))
}

/// The text of the script. `root` and `spool` are absolute.
pub(super) fn text(
    stage: &Stage,
    files: &[String],
    place: &Place,
    root: &Path,
    spool: &Path,
    index: u32,
) -> String {
    let word = |text: &str| quoted([text]);
    let path = |path: &Path| word(&path.to_string_lossy());
    let reads: Vec<&str> = stage.reads().collect();
    let inside = |path: &&str| {
        with_ancestors(path)
            .skip(1)
            .any(|above| reads.contains(&above))
    };
    let outputs: Vec<&str> = stage.outputs.iter().map(String::as_str).collect();
    let is_relative = |path: &&str| !path.starts_with('/');
    let all = reads.iter().chain(&outputs);
    let up = all.map(|path| path.split('/').take_while(|part| *part == "..").count());
    let deep = "/d".repeat(up.max().unwrap_or(0) + 1);
    let mut lines = vec![
        "#!/bin/sh".to_owned(),
        format!("# stage {}", stage.name),
        format!("spool={}", path(spool)),
        format!("root={}", path(root)),
        format!("n={index}"),
        r#"[ -e "$spool/$n.ended" ] && exit 0"#.to_owned(),
        r#"stop() { echo "$1" >"$spool/$n.err"; echo 125 0 >"$spool/$n.ended"; exit 125; }"#
            .to_owned(),
        r#"work="$spool/$n.work.$(uname -n).$$.$(date +%s)""#.to_owned(),
        format!("mkdir -p \"$work{deep}\" && cd \"$work{deep}\" || stop \"cannot make $work\""),
    ];
    let folder = |path: &str| match path.rsplit_once('/') {
        Some((folder, _)) => format!("mkdir -p {} && ", word(folder)),
        None => String::new(),
    };
    for input in reads
        .iter()
        .filter(|path| is_relative(path) && !inside(path))
    {
        let name = word(input);
        lines.push(format!(
            "{}ln -s \"$root\"/{name} {name} || stop 'cannot link an input'",
            folder(input)
        ));
    }
    for output in outputs.iter().filter(|path| is_relative(path)) {
        lines.push(format!("{}:", folder(output)));
    }
    lines.push("start=$(date +%s)".to_owned());
    let program = place.program_of(stage);
    let program = if program.is_relative() && program.components().count() > 1 {
        root.join(program)
    } else {
        program
    };
    let program = program.to_string_lossy().into_owned();
    let arguments = stage.arguments(files);
    let command = quoted(std::iter::once(&program).chain(&arguments));
    lines.push(format!(
        "{command} </dev/null >\"$work.out\" 2>\"$work.err\""
    ));
    lines.push("code=$?".to_owned());
    // Another copy was first, or the run was given up: this one leaves no trace.
    lines.push(
        r#"if [ -e "$spool/$n.ended" ] || [ ! -e "$spool/$n.sh" ]; then rm -rf "$work" "$work".*; exit 0; fi"#
            .to_owned(),
    );
    for output in outputs
        .iter()
        .filter(|path| is_relative(path) && !inside(path))
    {
        let name = word(output);
        lines.push(format!(
            "[ $code = 0 ] && [ -e {name} ] && {{ {}rm -rf \"$root\"/{name}; mv {name} \"$root\"/{name} || code=126; }}",
            folder(output).replace("mkdir -p ", "mkdir -p \"$root\"/"),
        ));
    }
    lines.extend(
        [
            r#"mv "$work.out" "$spool/$n.out"; mv "$work.err" "$spool/$n.err""#,
            r#"echo "$code $(($(date +%s) - start))" >"$work.ended""#,
            r#"cd "$spool" && rm -rf "$work""#,
            r#"mv "$work.ended" "$spool/$n.ended""#,
            "exit $code",
        ]
        .map(str::to_owned),
    );
    lines.push(String::new());
    lines.join("\n")
}
