//! Local files, which need no feature.

use std::path::Path;

use htex_base::storage::{Location, Storage, StorageProblem};
use tempfile::TempDir;

fn at(folder: &TempDir, name: &str) -> Location {
    folder.path().join(name).into()
}

#[test]
fn files_here_are_whole_or_not_there() {
    let (folder, storage) = (TempDir::new().unwrap(), Storage::default());
    let file = at(&folder, "cloth.csv");
    assert!(!storage.exists(&file).unwrap());
    storage.write(&file, b"0123456789").unwrap();
    assert_eq!(storage.read(&file, 10).unwrap(), b"0123456789");
    assert_eq!(storage.read_range(&file, 3..5).unwrap(), b"34");
    assert_eq!(storage.read_range(&file, 3..3).unwrap(), b"");
    assert_eq!(storage.size(&file).unwrap(), 10);
    let error = storage.read(&file, 9).unwrap_err();
    assert!(matches!(error.problem, StorageProblem::TooLarge { most_bytes: 9, .. }), "{error}");
    let error = storage.read_range(&file, 5..11).unwrap_err();
    assert!(matches!(error.problem, StorageProblem::Range { len: 10, .. }), "{error}");
    storage.write_file(&at(&folder, "copy.csv"), file.local().unwrap()).unwrap();
    assert_eq!(storage.read(&at(&folder, "copy.csv"), 10).unwrap(), b"0123456789");
    let error = storage.write_file(&file, Path::new("none")).unwrap_err();
    assert!(error.to_string().starts_with("none: "), "{error}");
    assert!(storage.write(&at(&folder, "none/cloth.csv"), b"x").is_err());
    assert_eq!(storage.read(&file, 10).unwrap(), b"0123456789");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn a_list_is_by_name_and_by_pattern() {
    let (folder, storage) = (TempDir::new().unwrap(), Storage::default());
    for name in ["b.csv", "a.csv", "a.htex", "deep/c.csv"] {
        std::fs::create_dir_all(folder.path().join("deep")).unwrap();
        storage.write(&at(&folder, name), name.as_bytes()).unwrap();
    }
    let names = |pattern: &str| {
        let found = storage.list(&folder.path().to_owned().into(), pattern).unwrap();
        let names = found
            .iter()
            .map(|entry| entry.location.local().unwrap())
            .map(|path| path.strip_prefix(folder.path()).unwrap().to_owned());
        names.map(|path| path.to_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(names("*.csv"), ["a.csv", "b.csv"]);
    assert_eq!(names("**/*.csv"), ["a.csv", "b.csv", "deep/c.csv"]);
    assert!(storage.list(&at(&folder, "none"), "*").is_err());
}

#[cfg(not(feature = "cloud"))]
#[test]
fn a_file_elsewhere_is_an_error_without_the_feature() {
    let location = Location::parse("s3://surfaces/cloth.htex".as_ref()).unwrap();
    let storage = Storage::default();
    for error in [
        storage.read(&location, 1).unwrap_err(),
        storage.open(&location, 1).unwrap_err(),
        storage.write(&location, b"x").unwrap_err(),
        storage.list(&location, "*").unwrap_err(),
        storage.check_writable(&location).unwrap_err(),
    ] {
        assert!(matches!(error.problem, StorageProblem::NoCloud), "{error}");
    }
}
