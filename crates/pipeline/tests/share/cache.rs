//! The cache: what is taken from it, and what of it is not believed.

use super::*;

#[test]
fn a_colleague_with_the_same_inputs_takes_everything_from_the_cache() {
    let cache = tempfile::tempdir().unwrap();
    let with_cache = || Novels::with_cache(cache.path());
    let (mine, theirs) = (with_cache(), with_cache());
    assert_eq!(mine.run_with(State::Done).len(), 9);
    let report = theirs.run();
    assert!(report.stages.iter().all(|stage| stage.state == State::Restored));
    assert!(report.summaries[0].text.contains("words in all"));
    assert_eq!(theirs.read("made/table.csv"), TABLE);
    assert_eq!(theirs.run_with(State::UpToDate).len(), 9);
    assert_eq!(mine.digest_of("table"), theirs.digest_of("table"));

    // Damaged: said, thrown out, made again and put in again.
    let mut damaged = 0;
    let content = cache.path().join("v1/content");
    for entry in
        fs::read_dir(&content).unwrap().flatten().flat_map(|e| fs::read_dir(e.path()).unwrap())
    {
        let path = entry.unwrap().path();
        if fs::read_to_string(&path).unwrap() == TABLE {
            fs::write(&path, "damaged").unwrap();
            damaged += 1;
        }
    }
    assert_eq!(damaged, 1);
    let next = with_cache();
    let report = next.run();
    assert_eq!(report.warnings.len(), 1);
    assert!(report.warnings[0].to_string().contains("damaged for stage `table`"));
    assert_eq!(next.read("made/table.csv"), TABLE);
    let last = with_cache();
    assert_eq!(last.run_with(State::Restored).len(), 9);

    // A cache that cannot be written costs a warning.
    let mut without = Novels::new();
    without.options.cache = Some(without.path("books.csv"));
    let warnings = without.run().warnings;
    assert_eq!(warnings.len(), 9);
    #[cfg(unix)]
    assert!(warnings[0].to_string().contains(": Not a directory"), "{}", warnings[0]);
}

#[test]
fn an_entry_of_the_cache_that_could_write_anywhere_is_not_believed() {
    let cache = tempfile::tempdir().unwrap();
    let with_cache = || {
        let mut novels = Novels::with_cache(cache.path());
        novels.options.targets = vec!["table".to_owned()];
        novels
    };
    let first = with_cache();
    first.run();
    let entries = || {
        let folders = fs::read_dir(cache.path().join("v1/made")).unwrap().flatten();
        let files = folders.flat_map(|e| fs::read_dir(e.path()).unwrap());
        files.map(|e| e.unwrap().path()).collect::<Vec<_>>()
    };
    let table = entries()
        .into_iter()
        .find(|path| fs::read_to_string(path).unwrap().contains("made/table.csv"))
        .unwrap();
    let good = fs::read_to_string(&table).unwrap();
    let entry: serde_json::Value = serde_json::from_str(&good).unwrap();
    let hash = entry["files"][0]["content"].as_str().unwrap().to_owned();
    let with = |pointer: &str, value: serde_json::Value| {
        let mut entry = entry.clone();
        *entry.pointer_mut(pointer).unwrap() = value;
        entry.to_string()
    };
    for bad in [
        with("/files/0/output", "../outside".into()),
        with("/files/0/output", "/tmp/outside".into()),
        with("/files/0/output", "books.csv".into()),
        with("/files/0/within", "/../../outside".into()),
        with("/files/0/within", "x/../outside".into()),
        with("/files/0/content", "../../../../books.csv".into()),
        with("/files/0/content", hash[1..].into()),
        with("/outputs", serde_json::json!({})),
        with("/outputs", serde_json::json!({"books.csv": hash})),
        with("/digest", hash.clone().into()),
        "{".to_owned(),
    ] {
        fs::write(&table, &bad).unwrap();
        let next = with_cache();
        let books = next.read("books.csv");
        let report = next.run();
        assert_eq!(report.warnings.len(), 1, "{bad}: {:?}", report.warnings);
        assert!(report.warnings[0].to_string().contains("damaged for stage `table`"));
        assert_eq!(
            (next.read("made/table.csv"), next.read("books.csv")),
            (TABLE.to_owned(), books)
        );
        assert!(!next.path("../outside").exists() && !Path::new("/tmp/outside").exists());
    }
    assert_eq!(with_cache().run_with(State::Restored).len(), 9, "it was put in again");
}

#[test]
fn a_folder_in_the_place_of_a_file_of_the_cache_is_no_file_and_stays() {
    let cache = tempfile::tempdir().unwrap();
    let with_cache = || Novels::with_cache(cache.path());
    with_cache().run();
    let content = fs::read_dir(cache.path().join("v1/content")).unwrap().flatten();
    let mut files = content.flat_map(|e| fs::read_dir(e.path()).unwrap().flatten());
    let is_table = |path: &std::path::PathBuf| fs::read_to_string(path).unwrap() == TABLE;
    let blob = files.find_map(|e| Some(e.path()).filter(is_table)).unwrap();
    fs::remove_file(&blob).unwrap();
    fs::create_dir(&blob).unwrap();
    fs::write(blob.join("mine"), "mine").unwrap();
    let next = with_cache();
    let report = next.run();
    assert_eq!(report.outcome, Outcome::Done, "{:?}", report.failures);
    assert_eq!(next.read("made/table.csv"), TABLE);
    let warnings: Vec<String> = report.warnings.iter().map(ToString::to_string).collect();
    assert!(warnings[0].contains("damaged for stage `table`"), "{warnings:?}");
    assert!(warnings[1].contains("was not put into the cache"), "{warnings:?}");
    assert!(blob.join("mine").exists());
}

#[cfg(unix)]
#[test]
fn what_is_restored_is_as_private_as_what_a_stage_makes() {
    use std::os::unix::fs::PermissionsExt;
    const AGAIN: &str = "MAVERIC_PIPELINE_TEST_PRIVATE";
    const NAME: &str = "cache::what_is_restored_is_as_private_as_what_a_stage_makes";
    // The umask belongs to a process: the test starts itself again with another.
    if std::env::var_os(AGAIN).is_none() {
        let again = std::process::Command::new("sh")
            .args(["-c", "umask 077; exec \"$0\" --exact \"$1\""])
            .arg(std::env::current_exe().unwrap())
            .arg(NAME)
            .env(AGAIN, "")
            .output()
            .unwrap();
        let printed = String::from_utf8_lossy(&again.stdout).into_owned();
        assert!(printed.contains("1 passed"), "{printed}");
        return;
    }
    let cache = tempfile::tempdir().unwrap();
    let with_cache = || Novels::with_cache(cache.path());
    with_cache().run();
    let theirs = with_cache();
    assert_eq!(theirs.run_with(State::Restored).len(), 9);
    let made = fs::metadata(theirs.path("made/table.csv")).unwrap();
    assert_eq!(made.permissions().mode() & 0o777, 0o600);
}

#[test]
fn a_url_is_refused_as_a_cache_before_anything_runs() {
    let url = Path::new("s3://bucket/cache");
    let novels = Novels::with_cache(url);
    let refused = run(&novels.pipeline(), &novels.place(), &novels.options, &mut |_| {});
    let message = refused.unwrap_err().to_string();
    assert!(message.contains("s3://bucket/cache"), "{message}");
    assert!(!Path::new("s3:").exists());
}
