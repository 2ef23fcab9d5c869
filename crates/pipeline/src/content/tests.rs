use super::*;

fn content(root: &Path, path: &str) -> Option<String> {
    let hasher = Hasher::new(root, root.join(".hashes"), &NEVER);
    hasher.content(path).unwrap()
}

#[test]
fn a_directory_changes_with_names_and_contents_below_it() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir_all(root.join("d/e")).unwrap();
    fs::write(root.join("d/e/one"), "1").unwrap();
    let first = content(root, "d").unwrap();
    assert!(first.ends_with(" in 1 file"));
    fs::rename(root.join("d/e/one"), root.join("d/e/two")).unwrap();
    let renamed = content(root, "d").unwrap();
    fs::write(root.join("d/e/two"), "2").unwrap();
    let rewritten = content(root, "d").unwrap();
    assert!(first != renamed && renamed != rewritten);
    assert_eq!(content(root, "nothing"), None);
    assert_eq!(content(root, "d/e/two/below a file"), None);
}

#[test]
fn what_python_keeps_of_its_scripts_is_no_source_and_is_an_output() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir_all(root.join("scripts/__pycache__")).unwrap();
    fs::write(root.join("scripts/a.py"), "print()").unwrap();
    let hasher = Hasher::new(root, root.join(".hashes"), &NEVER);
    let (source, made) = (hasher.input("scripts"), hasher.content("scripts"));
    fs::write(root.join("scripts/__pycache__/a.pyc"), "1").unwrap();
    assert_eq!(hasher.input("scripts").unwrap(), source.unwrap());
    assert_ne!(hasher.content("scripts").unwrap(), made.unwrap());
    fs::write(root.join("scripts/b.py"), "print()").unwrap();
    let with_another = hasher.input("scripts").unwrap().unwrap();
    assert!(with_another.ends_with("in 2 files"), "{with_another}");
}

#[test]
fn a_remembered_hash_is_dropped_when_the_file_changes() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::write(root.join("f"), "one").unwrap();
    std::thread::sleep(std::time::Duration::from_millis(40));
    let hasher = Hasher::new(root, root.join(".hashes"), &NEVER);
    let one = hasher.content("f").unwrap();
    hasher.save();
    let cached: Cache = serde_json::from_slice(&fs::read(root.join(".hashes")).unwrap()).unwrap();
    assert_eq!(cached.keys().collect::<Vec<_>>(), ["f"]);
    assert_eq!(content(root, "f"), one);
    fs::write(root.join("f"), "two").unwrap();
    assert_ne!(content(root, "f"), one);
}

#[test]
fn a_file_that_has_just_changed_is_not_remembered() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let path = root.join("f");
    fs::write(&path, "one").unwrap();
    // As if its clock were ahead.
    let ahead = SystemTime::now() + std::time::Duration::from_hours(1);
    File::options().write(true).open(&path).unwrap().set_modified(ahead).unwrap();
    let hasher = Hasher::new(root, root.join(".hashes"), &NEVER);
    hasher.content("f").unwrap();
    hasher.save();
    assert!(!root.join(".hashes").exists());
}

#[test]
fn a_damaged_cache_is_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::write(root.join("f"), "one").unwrap();
    fs::write(root.join(".hashes"), "{ not json").unwrap();
    assert_eq!(content(root, "f").unwrap().len(), 64);
}

#[test]
fn a_hash_does_not_depend_on_the_blocks_in_which_a_file_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let block = BLOCK as usize;
    for size in [0, 1, WORTH_THREADS, block - 1, block, block + 1, 2 * block + 3] {
        let bytes: Vec<u8> = (0..size).map(|i| (i * i / 7) as u8).collect();
        fs::write(root.join("f"), &bytes).unwrap();
        assert_eq!(content(root, "f"), Some(hash_of(&bytes)), "{size} bytes");
    }
}

#[cfg(unix)]
#[test]
fn of_an_input_what_lies_behind_a_linked_directory_counts_and_of_an_output_where_it_points() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir_all(root.join("far/deep")).unwrap();
    fs::create_dir(root.join("d")).unwrap();
    std::os::unix::fs::symlink("../far", root.join("d/day1")).unwrap();
    // Back and forth, and to the directory itself: it ends.
    std::os::unix::fs::symlink("../d", root.join("far/back")).unwrap();
    std::os::unix::fs::symlink(".", root.join("d/self")).unwrap();
    fs::write(root.join("far/deep/1"), "one").unwrap();
    let input = || {
        let hasher = Hasher::new(root, root.join(".hashes"), &NEVER);
        hasher.input("d").unwrap().unwrap()
    };
    let (read, made) = (input(), content(root, "d"));
    assert!(read.ends_with(" in 3 files"), "{read}");
    fs::write(root.join("far/deep/1"), "two").unwrap();
    let edited = input();
    fs::write(root.join("far/2"), "new").unwrap();
    assert!(read != edited && edited != input());
    assert_eq!(content(root, "d"), made);
}

#[cfg(unix)]
#[test]
fn an_input_without_linked_directories_has_the_content_of_an_output() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir_all(root.join("d/e")).unwrap();
    fs::write(root.join("d/e/1"), "one").unwrap();
    std::os::unix::fs::symlink("e/1", root.join("d/2")).unwrap();
    std::os::unix::fs::symlink("nothing", root.join("d/3")).unwrap();
    let hasher = Hasher::new(root, root.join(".hashes"), &NEVER);
    for path in ["d", "d/2", "none"] {
        assert_eq!(hasher.input(path).unwrap(), content(root, path));
    }
}

#[cfg(unix)]
#[test]
fn a_link_to_a_directory_above_has_an_end() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir(root.join("d")).unwrap();
    std::os::unix::fs::symlink("../d", root.join("d/loop")).unwrap();
    assert!(content(root, "d").unwrap().ends_with(" in 1 file"));
}
