//! What `verify`, `trace`, `diff` and `clean` tell, of one variant and of several.

use super::*;

#[test]
fn verify_reads_everything_again() {
    let novels = Novels::new();
    let found = verify(&novels.pipeline(), &novels.place()).unwrap();
    assert_eq!((found.compared, found.never_run.len()), (0, 9));
    novels.run();
    let found = verify(&novels.pipeline(), &novels.place()).unwrap();
    assert!(found.findings.is_empty() && found.compared > 9, "{found:?}");
    fs::write(novels.path("made/table.csv"), "edited").unwrap();
    fs::remove_file(novels.path("texts/moby.txt")).unwrap();
    let found = verify(&novels.pipeline(), &novels.place()).unwrap().findings;
    let told: Vec<_> = found.iter().map(|f| (f.stage.as_str(), f.role, f.state)).collect();
    assert!(told.contains(&("table", Role::Output, FileState::Changed)), "{told:?}");
    assert!(told.contains(&("count.moby", Role::Input, FileState::Missing)), "{told:?}");
}

#[test]
fn trace_walks_back_to_the_rows_and_files() {
    let novels = Novels::new();
    novels.run();
    let trace = |path: &str| trace(&novels.at().ledger, &novels.place(), path);
    let found = trace("made/table.csv").unwrap();
    assert_eq!(found.stages.len(), 9);
    assert_eq!(found.stages[0].stage, "table");
    let sources: Vec<_> = found.sources.iter().map(|source| source.path.as_str()).collect();
    assert_eq!(sources, ["texts/cities.txt", "texts/moby.txt", "texts/pride.txt"]);
    let of_one = trace("./made/rows/pride.csv").unwrap();
    let names: Vec<_> = of_one.stages.iter().map(|s| s.stage.as_str()).collect();
    assert_eq!(names, ["row.pride.1813", "count.pride"]);
    let lines = of_one.lines();
    assert_eq!(lines[1], "<- stage row.pride.1813 (row on line 3 of books.csv)");
    assert!(lines[3].starts_with("     took "), "{lines:?}");
    fs::write(novels.path("texts/pride.txt"), "other").unwrap();
    let lines = trace("made/rows/pride.csv").unwrap().lines();
    assert!(lines.last().unwrap().ends_with("texts/pride.txt (changed since)"));
    let error = trace("made/tabel.csv").unwrap_err();
    assert_eq!(error.suggestion().as_deref(), Some("did you mean `made/table.csv`?"));
    let root = novels.folder.path();
    assert_eq!(below_root(&root.join("made/../a.csv"), root), "a.csv");
}

#[test]
fn diff_names_parameters_inputs_and_numbers() {
    let (mut first, mut second) = (Novels::new(), Novels::new());
    first.set = vec![("out".to_owned(), "made/here".to_owned())];
    second.set = vec![("out".to_owned(), "there".to_owned())];
    first.run();
    second.run();
    let same = diff(&first.at(), &second.at()).unwrap();
    assert_eq!(same.same, 9, "another folder is no difference: {same:?}");
    let books = second.read("books.csv").replace("1813", "1814");
    fs::write(second.path("books.csv"), books).unwrap();
    let text = second.read("texts/moby.txt");
    fs::write(second.path("texts/moby.txt"), format!("{text} whale whale")).unwrap();
    second.run();
    let found = diff(&first.at(), &second.at()).unwrap();
    assert_eq!(found.only_first, ["row.pride.1813"]);
    let lines = found.lines().join("\n");
    assert!(lines.contains("input `texts/moby.txt` changed"), "{lines}");
    assert!(lines.contains("{out}/table.csv: 1 of 3 numbers differ"), "{lines}");
    assert!(lines.contains("pride, year: 1813 -> 1814"), "{lines}");
    fs::write(second.path("there/table.csv"), "edited").unwrap();
    let lines = diff(&first.at(), &second.at()).unwrap().lines().join("\n");
    assert!(lines.contains("no longer what the second run had made"), "{lines}");
}

#[test]
fn clean_removes_what_was_made_here_and_nothing_else() {
    let novels = Novels::new();
    novels.run();
    fs::write(novels.path("made/rows/pride.csv"), "edited").unwrap();
    fs::write(novels.path("made/notes.txt"), "mine").unwrap();
    let clean = |targets: &[&str], force, dry_run| {
        let targets: Vec<String> = targets.iter().map(|t| (*t).to_owned()).collect();
        clean(&novels.pipeline(), &novels.place(), &targets, force, dry_run).unwrap()
    };
    assert_eq!(clean(&[], false, true).removed.len(), 8);
    assert_eq!(novels.read("made/table.csv"), TABLE);
    assert_eq!(clean(&["table"], false, false).removed, ["made/table.csv"]);
    let cleaned = clean(&[], false, false);
    assert_eq!(
        (cleaned.removed.len(), cleaned.kept.as_slice()),
        (7, &["made/rows/pride.csv".to_owned()][..])
    );
    assert!(!novels.path("made/counts").exists());
    assert_eq!(clean(&[], true, false).removed, ["made/rows/pride.csv"]);
    assert_eq!(novels.read("made/notes.txt"), "mine");
    assert!(novels.at().ledger.run.is_empty());
    assert_eq!(novels.run_with(State::Done).len(), 9);
}

#[test]
fn variants_stand_side_by_side_and_are_compared_and_cleaned_apart() {
    let mut novels = Novels::new();
    novels.run();
    novels.variant = Some("two".to_owned());
    novels.set = vec![("top".to_owned(), "2".to_owned())];
    let report = novels.run();
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    assert_eq!(novels.run_with(State::UpToDate).len(), 9);
    let second = novels.at();
    (novels.variant, novels.set) = (None, Vec::new());
    assert_eq!(novels.run_with(State::UpToDate).len(), 9);
    assert!(novels.run().summaries[0].text.contains("moby,1851,the and i\n"));
    assert_eq!(novels.read("made/table.csv"), TABLE);
    assert_eq!(second.ledger.variants().into_iter().collect::<Vec<_>>(), ["two"]);
    let lines = diff(&novels.at(), &second).unwrap().lines().join("\n");
    assert!(lines.contains("parameter `top` changed from 3 to 2"), "{lines}");
    assert!(!lines.contains("`out`") && lines.contains("{out}/table.csv"), "{lines}");
    let trace = trace(&second.ledger, &novels.place(), "made-two/table.csv").unwrap();
    assert_eq!(trace.stages.len(), 9);
    assert!(trace.sources.iter().all(|s| !s.path.starts_with("made")));
    // The same into the same place: said, and nothing of it stays.
    novels.set = vec![("top".to_owned(), "1".to_owned())];
    let warnings = novels.run().warnings;
    let expected = "the former results (top=3, now 1) were replaced; `--variant NAME` keeps both";
    assert_eq!(warnings.iter().map(ToString::to_string).collect::<Vec<_>>(), [expected]);
    novels.set = Vec::new();
    assert!(novels.run().warnings[0].to_string().contains("top=1, now 3"));
    let cleaned = clean(&novels.pipeline(), &novels.place(), &[], false, false).unwrap();
    assert_eq!((cleaned.removed.len(), cleaned.kept.len()), (9, 0));
    assert!(!novels.path("made").exists() && novels.path("made-two/table.csv").exists());
    novels.variant = Some("two".to_owned());
    let cleaned = clean(&novels.pipeline(), &novels.place(), &[], false, false).unwrap();
    assert_eq!(cleaned.removed.len(), 9);
    assert!(!novels.path("made-two").exists());
}
