use super::*;

fn parsed(text: &str) -> Result<Pipeline, PipelineError> {
    Pipeline::parse(text, Path::new("p.toml"), Path::new("."), &Settings::default())
}

fn message(text: &str) -> String {
    let error = parsed(text).unwrap_err();
    let help = error.suggestion().map_or_else(String::new, |help| format!(" ({help})"));
    format!("{error}{help}")
}

const STAGE_A: &str = "name = 'p'\n[params]\nseed = 1_000\nrate = 2.50\n[[stage]]\nname = 'a'\n";

#[test]
fn numbers_are_put_in_as_written() {
    let text = format!("{STAGE_A}cmd = ['x', '{{seed}}', '{{rate}}']");
    let pipeline = parsed(&text).unwrap();
    assert_eq!(pipeline.stages()[0].command, ["x", "1000", "2.50"]);
    assert_eq!(pipeline.stages()[0].params["seed"], "1000");
}

#[test]
fn an_override_replaces_a_value_and_is_kept() {
    let text = format!("{STAGE_A}cmd = ['x', '{{seed}}']");
    let settings =
        Settings { set: vec![("seed".to_owned(), "7".to_owned())], ..Settings::default() };
    let pipeline = Pipeline::parse(&text, Path::new("p.toml"), Path::new("."), &settings).unwrap();
    assert_eq!(pipeline.stages()[0].command, ["x", "7"]);
    assert_eq!(pipeline.overrides()["seed"], "7");
}

#[test]
fn an_unknown_key_has_its_position_and_the_key_that_was_meant() {
    assert_eq!(
        message(&format!("{STAGE_A}cmd = ['x']\ninptus = []")),
        "p.toml:8:1: unknown key `inptus` in [[stage]] (did you mean `inputs`?)"
    );
}

#[test]
fn an_unknown_parameter_has_its_position_and_the_name_that_was_meant() {
    assert_eq!(
        message(&format!("{STAGE_A}cmd = ['x', '{{sed}}']")),
        "p.toml:7:13: `{sed}` stands for a parameter, and [params] has no `sed` \
         (did you mean `seed`?)"
    );
}

fn in_folder(table: &str, stage: &str) -> Result<Pipeline, PipelineError> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), table).unwrap();
    let text = format!("name = 'p'\n[params]\nseed = 1\n[[stage]]\nname = 'fit'\n{stage}");
    let settings = Settings::default();
    Pipeline::parse(&text, Path::new("p.toml"), folder.path(), &settings)
}

fn names(pipeline: &Pipeline) -> Vec<&str> {
    pipeline.stages().iter().map(|s| s.name.as_str()).collect()
}

#[test]
fn a_table_gives_a_stage_for_each_distinct_use_of_its_columns() {
    let table = "who,day,note\nann,1,x y\nann,2,{odd}\nbob b,1,\n";
    let stage = "foreach = 't.csv'\ncmd = ['x', '{who}', '{seed}']";
    let pipeline = in_folder(table, stage).unwrap();
    assert_eq!(names(&pipeline), ["fit.ann", "fit.bob_b"]);
    let bob = &pipeline.stages()[1];
    assert_eq!((bob.family.as_str(), bob.command[1].as_str()), ("fit", "bob b"));
    assert_eq!(bob.row.as_ref().map(|row| row.line), Some(4));
    assert_eq!(bob.params["who"], "bob b");
    let stage = "foreach = 't.csv'\ncmd = ['x', '{who}', '{note}']";
    let pipeline = in_folder(table, stage).unwrap();
    assert_eq!(names(&pipeline), ["fit.ann.x_y", "fit.ann._odd_", "fit.bob_b."]);
    assert_eq!(pipeline.stages()[1].command[2], "{odd}");
}

#[test]
fn a_matrix_gives_all_combinations_and_shards_cut_each() {
    let stage = "matrix = { z = [1, 2.5], a = ['k'] }\nshards = 2\nover = 'd/*.csv'\n\
                 cmd = ['x', '{z}', '{a}', '{shard}/{shards}', '{files}']";
    let pipeline = in_folder("", stage).unwrap();
    assert_eq!(names(&pipeline), ["fit.1.k.0", "fit.1.k.1", "fit.2.5.k.0", "fit.2.5.k.1"]);
    let last = &pipeline.stages()[3];
    assert_eq!(last.command[1..], ["2.5", "k", "1/2", "{files}"]);
    assert_eq!(last.arguments(&["d/1.csv".to_owned()])[3..], ["d/1.csv"]);
    assert_eq!(last.reads().collect::<Vec<_>>(), ["d"]);
}

#[test]
fn a_fan_out_that_cannot_be_is_refused_where_it_stands() {
    let cases = [
        ("foreach = 'u.csv'\ncmd = ['x']", "p.toml:6:11: cannot read the table `u.csv`"),
        ("foreach = 't.csv'\ncmd = ['x']", "uses no column of its table"),
        ("foreach = 't.csv'\ncmd = ['{wo}']", "did you mean `who`"),
        ("matrix = { seed = [1] }\ncmd = ['{seed}']", "`seed` is also a parameter"),
        ("matrix = { a = [] }\ncmd = ['{a}']", "p.toml:6:16: `a` is an array"),
        ("shards = 0\ncmd = ['x']", "`shards` is 0, expected a whole number from 1 on"),
        ("over = 'd'\ncmd = ['x']", "[[stage]] with `over` lacks `shards`"),
        ("shards = 2\nover = '*/d'\ncmd = ['x']", "`*/d` cannot be dealt out"),
        ("shards = 2\nover = 'd'\ncmd = ['a{files}']", "`{files}` must be a word of its own"),
        ("shards = 2\nmatrix = {a=['é','é']}\ncmd = ['{a}{shard}']", "a second stage"),
        ("foreach = 't.csv'\nmatrix = {a=[1]}\ncmd = ['x']", "both `foreach` and `matrix`"),
    ];
    for (stage, expected) in cases {
        let error = in_folder("who\nann\n", stage).unwrap_err();
        let help = error.suggestion().unwrap_or_default();
        let message = format!("{error} ({help})");
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn an_empty_parameter_makes_no_path_in_the_root_of_the_disk() {
    let text = "name = 'p'\n[params]\nout = 'data'\nmodel = '{out}/model'\n\
                [[stage]]\nname = 'a'\ncmd = ['x']\noutputs = ['{model}/a.txt']\n";
    let with = |out: &str| {
        let settings =
            Settings { set: vec![("out".to_owned(), out.to_owned())], ..Settings::default() };
        Pipeline::parse(text, Path::new("p.toml"), Path::new("."), &settings)
    };
    let error = with("").unwrap_err().to_string();
    assert!(error.contains("`{out}` is empty"), "{error}");
    // What is meant to be absolute may be.
    assert_eq!(with("/data").unwrap().stages()[0].outputs, ["/data/model/a.txt"]);
}

#[test]
fn combinations_whose_names_are_spelled_alike_are_numbered() {
    let matrix = "matrix = { a = [1, 1.2], b = [3, 2.3] }\ncmd = ['x', '{a}', '{b}']";
    let pipeline = in_folder("", matrix).unwrap();
    assert_eq!(names(&pipeline)[1..3], ["fit.1.2.3", "fit.1.2.3-2"]);
    assert_eq!(pipeline.stages()[2].command[1..], ["1.2", "3"]);
    let rows = "foreach = 't.csv'\ncmd = ['x', '{who}']";
    let pipeline = in_folder("who\na b\na;b\na b\na;b\na:b\n", rows).unwrap();
    assert_eq!(names(&pipeline), ["fit.a_b", "fit.a_b-2", "fit.a_b-3"]);
}

#[test]
fn a_long_value_gives_a_name_that_a_file_can_have_and_that_is_its_own() {
    let long = "an open answer ".repeat(40);
    let rows = "foreach = 't.csv'\ncmd = ['x', '{who}']";
    let table = format!("who,note\n{long}1,a\n{long}2,a\nshort,a\n{long}1,b\n");
    let pipeline = in_folder(&table, rows).unwrap();
    let names = names(&pipeline);
    assert!(names[..2].iter().all(|name| name.len() == 109), "{names:?}");
    assert_eq!(names[0][..100], names[1][..100]);
    assert_ne!(names[0], names[1]);
    assert_eq!(names[2..], ["fit.short"]);
}

/// Reads the first of several files.
fn extended(files: &[(&str, &str)]) -> Result<Pipeline, String> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let path = folder.path().join(files[0].0);
    Pipeline::read(&path, folder.path(), &Settings::default()).map_err(|error| {
        let help = error.suggestion().unwrap_or_default();
        let folder = format!("{}/", folder.path().display());
        format!("{error} ({help})").replace(&folder, "")
    })
}

const BASE: (&str, &str) = (
    "base.toml",
    "name = 'base'\n[params]\nseed = 1\nout = 'data'\n\
     [[stage]]\nname = 'a'\ncmd = ['x', '{seed}']\noutputs = ['{out}/a']\n\
     [[stage]]\nname = 'b'\ncmd = ['y']\ninputs = ['{out}/a']\noutputs = ['{out}/b']\n",
);

#[test]
fn a_file_that_extends_another_changes_values_replaces_stages_and_adds_some() {
    let text = "name = 'mine'\nextends = 'middle.toml'\n[params]\nout = 'made'\nextra = 5\n\
                [[stage]]\nname = 'c'\ncmd = ['z', '{extra}']\n\
                [[stage]]\nname = 'a'\ncmd = ['w', '{seed}']\noutputs = ['{out}/a']\n";
    let middle = "name = 'middle'\nextends = 'base.toml'\n[params]\nseed = 2\n";
    let pipeline = extended(&[("mine.toml", text), ("middle.toml", middle), BASE]).unwrap();
    assert_eq!(pipeline.name(), "mine");
    assert_eq!(names(&pipeline), ["a", "b", "c"]);
    let [a, b, c] = pipeline.stages() else { unreachable!() };
    assert_eq!((&*a.command[0], &*a.command[1]), ("w", "2"));
    assert_eq!((&*b.inputs[0], &*b.outputs[0]), ("made/a", "made/b"));
    assert_eq!(c.command, ["z", "5"]);
}

#[test]
fn mistakes_in_files_that_extend_others_are_named_in_the_file_that_has_them() {
    let head = "name = 'mine'\nextends = 'base.toml'\n";
    let cases = [
        (
            "[params]\nsed = 2\n",
            "mine.toml:4:1: `sed` is no parameter of what this file extends, and no stage uses \
             it (did you mean `seed`?)",
        ),
        (
            "[params]\nseed = 'two'\n",
            "mine.toml:4:8: `seed` is a string, expected a whole number ()",
        ),
        (
            "[[stage]]\nname = 'a'\ncmd = ['x']\n[[stage]]\nname = 'a'\ncmd = ['x']\n",
            "mine.toml:7:8: a second stage `a`; the first is on line 4 ()",
        ),
        ("[[stage]]\nname = 'a'\n", "mine.toml:3:1: [[stage]] lacks `cmd` ()"),
    ];
    for (text, expected) in cases {
        let text = format!("{head}{text}");
        let error = extended(&[("mine.toml", &text), BASE]).unwrap_err();
        assert_eq!(error, expected);
    }
    let bad = BASE.1.replace("{seed}", "{sede}");
    let error = extended(&[("mine.toml", head), ("base.toml", &bad)]).unwrap_err();
    assert!(error.starts_with("base.toml:7:13: `{sede}`"), "{error}");
    let error = extended(&[("mine.toml", head)]).unwrap_err();
    let expected = "mine.toml:2:11: cannot read base.toml, which this file extends";
    assert!(error.starts_with(expected), "{error}");
    let again = "name = 'base'\nextends = 'mine.toml'\n";
    let error = extended(&[("mine.toml", head), ("base.toml", again)]).unwrap_err();
    assert_eq!(error, "base.toml:2:11: mine.toml extends itself ()");
}

#[test]
fn a_variant_moves_the_parameters_with_which_outputs_begin() {
    let variant = |text: &str, name: &str| {
        let settings = Settings {
            variant: Some(name.to_owned()),
            provided: BTreeMap::from([("command".to_owned(), "run {x}".to_owned())]),
            ..Settings::default()
        };
        Pipeline::parse(text, Path::new("p.toml"), Path::new("."), &settings)
    };
    let text = "name = 'p'\n[params]\nout = 'data/'\nmodel = '{out}/model'\nreport = 'r'\nraw = 'in'\n\
                [[stage]]\nname = 'a'\ncmd = ['x', '{raw}', '{model}', '{command}']\n\
                inputs = ['{raw}']\noutputs = ['{model}']\n\
                [[stage]]\nname = 'b'\ncmd = ['y']\ninputs = ['{out}/model']\noutputs = ['{report}.html']\n";
    let pipeline = variant(text, "b").unwrap();
    let [a, b] = pipeline.stages() else { unreachable!() };
    assert_eq!(a.command[1..], ["in", "data-b/model", "run {x}"]);
    assert_eq!((&*a.outputs[0], &*b.inputs[0]), ("data-b/model", "data-b/model"));
    assert_eq!((&*b.outputs[0], pipeline.variant()), ("r-b.html", Some("b")));
    let error = variant(&text.replace("'{report}.html'", "'made/it'"), "b").unwrap_err();
    let expected =
        "`--variant b` cannot move `made/it` of stage `b`: it does not begin with a parameter";
    assert_eq!(error.to_string(), expected);
    assert!(variant(text, "a/b").is_err());
}

#[test]
fn what_a_table_or_set_says_is_no_script() {
    let stage = "foreach = 't.csv'\ncmd = ['sh', '-c', 'echo {who} > hello.txt', '{who}']";
    let pipeline = in_folder("who\n$(touch pwned)\nann\n", stage).unwrap();
    let words = |i: usize| &pipeline.stages()[i].command[2..];
    let nasty = ["echo '$(touch pwned)' > hello.txt", "$(touch pwned)"];
    assert_eq!(words(0), nasty);
    assert_eq!(words(1), ["echo ann > hello.txt", "ann"]);
    let stage = "foreach = 't.csv'\ncmd = ['sh', '-c', \"cat <<E\\n{who}\\nE\"]";
    let error = in_folder("who\na b\n", stage).unwrap_err();
    assert!(error.to_string().contains("cannot be quoted safely"), "{error}");
    assert!(error.suggestion().unwrap().contains("\"{who}\"]"));
}

#[test]
fn a_cell_that_makes_a_path_must_be_an_id() {
    let stage = "foreach = 't.csv'\ncmd = ['x']\noutputs = ['made/{who}.txt']";
    for cell in ["../../evil", "a/b", "a b", "..", "$(id)", "{x}"] {
        let error = in_folder(&format!("who\nann\n{cell}\n"), stage).unwrap_err();
        let expected = format!("column `who` of `t.csv` makes a path, and line 3 has `{cell}`");
        assert!(error.to_string().contains(&expected), "{error}");
    }
    assert!(in_folder("who\nÉva-1.b_2\n", stage).is_ok());
}

#[test]
fn a_fan_out_beyond_all_measure_is_an_error_with_its_number() {
    let many: Vec<String> = (0..2000).map(|i| i.to_string()).collect();
    let many = many.join(",");
    let cases = [
        ("shards = 4_000_000_000".to_owned(), "4000000000"),
        (format!("matrix = {{a = [{many}], b = [{many}], c = [{many}]}}"), "8000000000"),
        (format!("shards = 1000\nmatrix = {{a = [{many}]}}"), "2000000"),
    ];
    for (fan, number) in cases {
        let error = in_folder("", &format!("{fan}\ncmd = ['x']")).unwrap_err();
        let expected = format!("the fan-out gives {number} stages, at most 1000000");
        assert!(error.to_string().contains(&expected), "{error}");
    }
}

#[test]
fn other_mistakes_are_named_where_they_stand() {
    let cases = [
        ("name = 'p'", "p.toml:1:1: the pipeline has no [[stage]]"),
        ("", "p.toml:1:1: the pipeline lacks `name`"),
        ("name = 'p'\n[[stage]]\nname = 'a'", "p.toml:2:1: [[stage]] lacks `cmd`"),
        (
            "name = 'p'\n[[stage]]\nname = 'a'\ncmd = 'ls'",
            "p.toml:4:7: `cmd` is a string, expected an array of strings",
        ),
        (
            "name = 'p'\n[[stage]]\nname = 'a'\ncmd = ['x']\noutputs = ['a/..']",
            "p.toml:5:12: `a/..` cannot be an input or output: it names no file or \
             directory below the root",
        ),
        (
            "name = 'p'\n[[stage]]\nname = 'a'\ncmd = ['x']\n[[stage]]\nname = 'a'\ncmd = ['x']",
            "p.toml:6:8: a second stage `a`; the first is on line 3",
        ),
        (
            "name = 'a/b'",
            "p.toml:1:8: `a/b` cannot be a name: letters, digits, `_` and `-`, the first a \
             letter or digit",
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(message(text), expected);
    }
    assert!(message("name = 'p").starts_with("p.toml:1:"));
}
