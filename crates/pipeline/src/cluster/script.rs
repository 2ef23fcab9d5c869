//! The shell script that is one stage's task.
//!
//! A task may run twice, even at the same time: a node that was given up may go on. So each
//! run works in a directory of its own, in which it sees the stage's inputs and nothing
//! else, and moves its outputs to their places at the end, if nobody has before.

use std::path::Path;

use crate::paths::with_ancestors;
use crate::shell::quoted;
use crate::{Place, Stage};

/// The file that tells how task `index` ended: exit status and seconds, and whether something stood in the way of its outputs;
/// then, of each file that it made, size and time.
pub(super) fn ending(spool: &Path, index: u32) -> std::path::PathBuf {
    spool.join(format!("{index}.ended"))
}

/// The task's script; without it, a task that runs nevertheless leaves its outputs alone.
pub(super) fn script(spool: &Path, index: u32) -> std::path::PathBuf {
    spool.join(format!("{index}.sh"))
}

/// A folder that whoever is first makes: the copy of the task that puts its outputs in place, or we, who gave the task up.
pub(super) fn first(spool: &Path, index: u32) -> std::path::PathBuf {
    spool.join(format!("{index}.first"))
}

/// Whether a task puts an output into place at its end, and only if it ended well; it writes others there itself.
pub(super) fn is_moved(output: &str) -> bool {
    !output.starts_with('/')
}

/// What it printed: `out` or `err`.
pub(super) fn printed(spool: &Path, index: u32, stream: &str) -> std::path::PathBuf {
    spool.join(format!("{index}.{stream}"))
}

/// The word of a task's ending that says that something stood in the way of its outputs, so that none was moved.
pub(super) const IN_THE_WAY: &str = "way";
/// The word that says that only some of its outputs could be moved.
pub(super) const HALF_MOVED: &str = "half";

/// How outputs get into place. A link to an empty directory is a person's choice of where an output lies.
const PUT_IN_PLACE: [&str; 14] = [
    r#"way=; : >"$work.made""#,
    "see() {",
    r#"  if [ $code != 0 ] && [ -z "$way" ] || [ ! -e "./$1" ]; then return; fi"#,
    r#"  find -H "./$1" -type f -printf '%s %T@\n' >>"$work.made" 2>/dev/null"#,
    r#"  if [ -L "$root/$1" ] && [ -d "$root/$1" ] && [ -d "./$1" ] && [ -z "$(ls -A "$root/$1")" ]; then return; fi"#,
    r#"  if [ -e "$root/$1" ]; then echo "$1 is in the way" >>"$work.err"; code=126; way=" way"; fi"#,
    "}",
    "put() {",
    // What a link leads to may have been moved before it.
    r#"  if [ $code != 0 ] || { [ ! -e "./$1" ] && [ ! -L "./$1" ]; }; then return; fi"#,
    r#"  mkdir -p "$(dirname "$root/$1")""#,
    r#"  if [ -L "$root/$1" ] && [ -d "$root/$1" ]; then find "./$1" -mindepth 1 -maxdepth 1 -exec mv -t "$root/$1" {} +"#,
    r#"  else mv -T "./$1" "$root/$1""#,
    r#"  fi || { code=126; way=" half"; }"#,
    r#"} 2>>"$work.err""#,
];

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
    let inside = |path: &&str| with_ancestors(path).skip(1).any(|above| reads.contains(&above));
    let outputs: Vec<&str> = stage.outputs.iter().map(String::as_str).collect();
    let is_relative = |path: &&str| is_moved(path);
    let paths = reads.iter().chain(&outputs);
    let up = paths.map(|path| path.split('/').take_while(|part| *part == "..").count());
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
    for input in reads.iter().filter(|path| is_relative(path) && !inside(path)) {
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
    let command = command(stage, files, place, root);
    let relative = outputs.iter().filter(|path| is_relative(path) && !inside(path));
    let relative: Vec<&str> = relative.copied().collect();
    let run = format!("{command} </dev/null >\"$work.out\" 2>\"$work.err\"; code=$?");
    if stage.retries == 0 {
        lines.push(run);
    } else {
        let clear = match relative.as_slice() {
            [] => String::new(),
            relative => format!(" rm -rf {};", quoted(relative)),
        };
        lines.push(format!(
            "try=0; while {run}; [ $code != 0 ] && [ $try -lt {} ]; do try=$((try + 1));{clear} done",
            stage.retries
        ));
    }
    // Another copy was first, or the run was given up: this one leaves no trace.
    lines.push(
        r#"if [ -e "$spool/$n.ended" ] || [ ! -e "$spool/$n.sh" ] || ! mkdir "$spool/$n.first" 2>/dev/null; then cd "$spool"; rm -rf "$work" "$work".*; exit 0; fi"#
            .to_owned(),
    );
    lines.extend(PUT_IN_PLACE.map(str::to_owned));
    // Nothing is moved while anything is in the way: what a task that failed left at these places is not its own.
    for step in ["see", "put"] {
        let words = relative.iter().map(|output| format!("{step} {}", word(output)));
        lines.extend(words);
    }
    lines.extend(
        [
            r#"mv "$work.out" "$spool/$n.out"; mv "$work.err" "$spool/$n.err""#,
            r#"{ echo "$code $(($(date +%s) - start))$way"; cat "$work.made"; } >"$work.ended""#,
            r#"cd "$spool" && rm -rf "$work" "$work.made""#,
            r#"mv "$work.ended" "$spool/$n.ended""#,
            "exit $code",
        ]
        .map(str::to_owned),
    );
    lines.push(String::new());
    lines.join("\n")
}

/// The command line of the stage; a program that is named by a path is the one below `root`.
fn command(stage: &Stage, files: &[String], place: &Place, root: &Path) -> String {
    let mut program = place.program_of(stage);
    if program.is_relative() && program.components().count() > 1 {
        program = root.join(program);
    }
    let program = program.to_string_lossy().into_owned();
    quoted(std::iter::once(&program).chain(&place.arguments_of(stage, files)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pipeline;
    use std::fs;
    use std::process::{Child, Command};

    /// Starts a copy of the task that is the only stage of `text`.
    fn start(root: &Path, spool: &Path) -> Child {
        let copy = Command::new("sh").arg(script(spool, 0)).current_dir(root).spawn();
        copy.unwrap()
    }

    fn write_script(text_of: &str, root: &Path, spool: &Path) {
        let settings = crate::Settings::default();
        let pipeline = Pipeline::parse(text_of, "p.toml".as_ref(), root, &settings).unwrap();
        let place = Place::below(root);
        fs::create_dir_all(spool).unwrap();
        let text = text(&pipeline.stages()[0], &[], &place, root, spool, 0);
        fs::write(script(spool, 0), text).unwrap();
    }

    #[test]
    fn of_two_copies_at_once_one_puts_its_outputs_in_place_and_tells() {
        let text = "name = 'p'\n[[stage]]\nname = 'a'\noutputs = ['out']\n\
                    cmd = ['sh', '-c', 'mkdir out; echo $$ > out/file; sleep 0.05']\n";
        for round in 0..20 {
            let folder = tempfile::tempdir().unwrap();
            let (root, spool) = (folder.path().join("r"), folder.path().join("s"));
            fs::create_dir_all(&root).unwrap();
            write_script(text, &root, &spool);
            let copies = [start(&root, &spool), start(&root, &spool), start(&root, &spool)];
            for mut copy in copies {
                assert!(copy.wait().unwrap().success(), "round {round}");
            }
            let names: Vec<_> = fs::read_dir(root.join("out")).unwrap().flatten().collect();
            assert_eq!(names.len(), 1, "round {round}: {names:?}");
            assert!(fs::read_to_string(ending(&spool, 0)).unwrap().starts_with("0 "));
        }
    }

    #[test]
    fn a_file_in_the_way_is_not_overwritten() {
        let text = "name = 'p'\n[[stage]]\nname = 'a'\noutputs = ['out']\ncmd = ['touch', 'out']\n";
        let folder = tempfile::tempdir().unwrap();
        let (root, spool) = (folder.path().join("r"), folder.path().join("s"));
        fs::create_dir_all(&root).unwrap();
        fs::write(root.join("out"), "mine").unwrap();
        write_script(text, &root, &spool);
        assert_eq!(start(&root, &spool).wait().unwrap().code(), Some(126));
        assert_eq!(fs::read_to_string(root.join("out")).unwrap(), "mine");
        let said = fs::read_to_string(printed(&spool, 0, "err")).unwrap();
        assert_eq!(said, "out is in the way\n");
    }

    #[test]
    fn while_one_output_is_in_the_way_none_is_moved() {
        let text =
            "name = 'p'\n[[stage]]\nname = 'a'\noutputs = ['a', 'b']\ncmd = ['touch', 'a', 'b']\n";
        let folder = tempfile::tempdir().unwrap();
        let (root, spool) = (folder.path().join("r"), folder.path().join("s"));
        fs::create_dir_all(&root).unwrap();
        fs::write(root.join("b"), "mine").unwrap();
        write_script(text, &root, &spool);
        assert_eq!(start(&root, &spool).wait().unwrap().code(), Some(126));
        assert!(!root.join("a").exists());
        let told = fs::read_to_string(ending(&spool, 0)).unwrap();
        let words: Vec<&str> = told.lines().next().unwrap().split(' ').collect();
        assert_eq!((words[0], words[2]), ("126", IN_THE_WAY));
    }

    #[cfg(unix)]
    #[test]
    fn an_output_folder_behind_a_link_is_filled_if_it_is_empty() {
        let text = "name = 'p'\n[[stage]]\nname = 'a'\noutputs = ['out']\n\
                    cmd = ['sh', '-c', 'mkdir -p out/deep; echo 12345 > out/deep/1; echo 1 > out/.hidden']\n";
        for (full, code) in [(false, 0), (true, 126)] {
            let folder = tempfile::tempdir().unwrap();
            let (root, spool) = (folder.path().join("r"), folder.path().join("s"));
            let disk = folder.path().join("disk");
            fs::create_dir_all(&root).unwrap();
            fs::create_dir_all(&disk).unwrap();
            std::os::unix::fs::symlink("../disk", root.join("out")).unwrap();
            if full {
                fs::write(disk.join("mine"), "mine").unwrap();
            }
            write_script(text, &root, &spool);
            assert_eq!(start(&root, &spool).wait().unwrap().code(), Some(code));
            assert!(root.join("out").is_symlink());
            assert_eq!(disk.join("deep/1").exists(), !full);
            assert_eq!(disk.join(".hidden").exists(), !full);
            let told = fs::read_to_string(ending(&spool, 0)).unwrap();
            let sizes = told.lines().skip(1).filter_map(|line| line.split(' ').next());
            let mut sizes: Vec<&str> = sizes.collect();
            sizes.sort_unstable();
            assert_eq!(sizes, ["2", "6"], "{told}");
        }
    }

    #[test]
    fn a_task_tries_again_as_often_as_it_may_and_starts_clean() {
        let text = "name = 'p'\n[[stage]]\nname = 'a'\nretries = 2\noutputs = ['out']\n\
                    cmd = ['sh', '-c', 'echo x >> COUNT; echo $(wc -l < COUNT) >> out; [ $(wc -l < COUNT) -ge TIMES ]']\n";
        for (times, code, made) in [(3, 0, Some("3\n")), (4, 1, None)] {
            let folder = tempfile::tempdir().unwrap();
            let (root, spool) = (folder.path().join("r"), folder.path().join("s"));
            fs::create_dir_all(&root).unwrap();
            let count = folder.path().join("count").display().to_string();
            let text = text.replace("COUNT", &count).replace("TIMES", &times.to_string());
            write_script(&text, &root, &spool);
            assert_eq!(start(&root, &spool).wait().unwrap().code(), Some(code));
            assert_eq!(fs::read_to_string(root.join("out")).ok().as_deref(), made);
            assert_eq!(fs::read_to_string(&count).unwrap(), "x\nx\nx\n");
        }
    }
}
