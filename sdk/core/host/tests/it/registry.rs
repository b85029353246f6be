//! Precedence among several models, and notes about the models that are not used.

use crate::common;

use std::path::Path;

use common::{ID, limits, text, with_descriptor};
use htex_host::{HostError, Note, Origin, Registry, Search};

/// Writes a plugin with this version.
fn write(folder: &Path, name: &str, version: &str) {
    let module = wat::parse_str(text(version, &[], "")).unwrap();
    std::fs::write(folder.join(name), module).unwrap();
}

fn search() -> Search {
    Search::builtin().with_limits(limits())
}

fn version(registry: &Registry) -> &str {
    &registry.find(ID).unwrap().descriptor().version
}

#[test]
fn files_precede_embedded_models_then_folders_then_built_in_models() {
    let dir = tempfile::tempdir().unwrap();
    let (folder, file) = (dir.path().join("plugins"), dir.path().join("named.wasm"));
    std::fs::create_dir(&folder).unwrap();
    write(&folder, "b.wasm", "1.2.0");
    write(&folder, "a.wasm", "2.0.0");
    write(dir.path(), "named.wasm", "3.0.0");
    let embedded = wat::parse_str(text("4.0.0", &[], "")).unwrap();

    let mut search = search();
    search.dirs.push(folder);
    let mut registry = Registry::search(&search).unwrap();
    assert_eq!(version(&registry), "2.0.0");
    assert_eq!(registry.models()[0].id(), ID, "before the built-in ones");
    let all = Registry::builtin_names().len() + 1;
    assert_eq!(registry.models().len(), all);
    registry.add_wasm_bytes("felt.htex", &embedded).unwrap();
    assert_eq!(version(&registry), "4.0.0");
    let origin = registry.find("hostile").unwrap().origin();
    assert_eq!(*origin, Origin::Embedded("felt.htex".to_owned()));

    search.files.push(file.clone());
    let mut registry = Registry::search(&search).unwrap();
    registry.add_wasm_bytes("felt.htex", &embedded).unwrap();
    assert_eq!(version(&registry), "3.0.0");
    assert_eq!(*registry.find(ID).unwrap().origin(), Origin::Wasm(file));
    assert_eq!(registry.models().len(), all, "each id once");
    let shadowed = |note: &Note| match note {
        Note::Shadowed { shadowed, .. } => shadowed.0.clone(),
        other => panic!("{other}"),
    };
    let notes: Vec<String> = registry.notes().iter().map(shadowed).collect();
    assert_eq!(notes, ["2.0.0", "1.2.0", "4.0.0"]);

    let versions = || registry.all(ID).map(|model| &model.descriptor().version[..]);
    assert_eq!(versions().find(|version| version.starts_with("1.")), Some("1.2.0"));
    assert_eq!(versions().next(), Some("3.0.0"));
}

/// Neither the file's name nor its place decides: a newer minor version can play everything that an
/// older one can.
#[test]
fn the_newest_installed_version_of_a_major_version_is_used() {
    let dir = tempfile::tempdir().unwrap();
    let folder = |name: &str| dir.path().join(name);
    let versions = |places: &[&[(&str, &str)]]| -> Vec<String> {
        let mut search = search();
        for (i, place) in places.iter().enumerate() {
            let at = folder(&format!("{i}"));
            let _ = std::fs::remove_dir_all(&at);
            std::fs::create_dir(&at).unwrap();
            for (file, version) in *place {
                write(&at, file, version);
            }
            search.dirs.push(at);
        }
        let registry = Registry::search(&search).unwrap();
        let all = registry.all(ID).map(|model| model.descriptor().version.clone());
        all.collect()
    };
    let in_one = [("a.wasm", "1.0.0"), ("b.wasm", "1.10.0"), ("c.wasm", "1.9.0")];
    assert_eq!(versions(&[&in_one]), ["1.10.0", "1.9.0", "1.0.0"]);
    let in_two: [&[_]; 2] = [&[("a.wasm", "1.0.0")], &[("b.wasm", "1.1.0")]];
    assert_eq!(versions(&in_two), ["1.1.0", "1.0.0"]);
    let majors: [&[_]; 2] = [&[("a.wasm", "1.0.0")], &[("b.wasm", "2.0.0"), ("c.wasm", "1.1.0")]];
    assert_eq!(versions(&majors), ["2.0.0", "1.1.0", "1.0.0"]);

    // An installed model replaces a built-in one of the same version, but not a newer built-in one.
    for (installed, is_used) in
        [("0.9.0", true), ("1.0.0", true), ("1.0.1", true), ("1.0.0-a", false)]
    {
        let at = folder("sbeta");
        std::fs::create_dir_all(&at).unwrap();
        let json = format!(
            r#"{{"id":"org.htex.sbeta","name":"H","version":"{installed}","summary":"S.","fields":[{{"name":"x","unit":"1","kind":{{"type":"scalar"}},"min":0,"max":1,"store":{{"type":"f32"}},"description":"X."}}]}}"#
        );
        let module = wat::parse_str(with_descriptor(&json, &[], "")).unwrap();
        std::fs::write(at.join("a.wasm"), module).unwrap();
        let registry = Registry::search(&search().with_dirs(vec![at])).unwrap();
        let sbeta = registry.find("sbeta").unwrap();
        assert_eq!(*sbeta.origin() != Origin::Builtin, is_used, "{installed}");
        assert_eq!(registry.notes().len(), 1);
    }

    // A file that the user names is used whatever its version.
    write(dir.path(), "named.wasm", "0.1.0");
    write(&folder("0"), "a.wasm", "3.0.0");
    let named = search().with_files(vec![folder("named.wasm")]).with_dirs(vec![folder("0")]);
    assert_eq!(version(&Registry::search(&named).unwrap()), "0.1.0");
}

#[test]
fn a_broken_plugin_is_a_note_in_a_folder_and_an_error_by_name() {
    let dir = tempfile::tempdir().unwrap();
    let broken = dir.path().join("broken.wasm");
    std::fs::write(&broken, "no module").unwrap();
    let native = dir.path().join(format!("x.{}", std::env::consts::DLL_EXTENSION));
    std::fs::write(&native, "no library").unwrap();
    std::fs::write(dir.path().join("README.md"), "no plugin").unwrap();
    write(dir.path(), "fine.wasm", "1.0.0");

    let mut in_folder = search();
    in_folder.dirs.push(dir.path().to_owned());
    let registry = Registry::search(&in_folder).unwrap();
    assert_eq!(version(&registry), "1.0.0");
    let paths = registry.notes().iter().map(|note| match note {
        Note::Broken { path, .. } => path.clone(),
        other => panic!("{other}"),
    });
    assert_eq!(paths.collect::<Vec<_>>(), [broken.clone(), native]);

    for path in [broken, dir.path().join("missing.wasm")] {
        let mut by_name = search();
        by_name.files.push(path);
        assert!(matches!(Registry::search(&by_name), Err(HostError::Load { .. })));
    }
    let mut no_folder = search();
    no_folder.dirs.push(dir.path().join("missing"));
    assert!(matches!(Registry::search(&no_folder), Err(HostError::Load { .. })));
}

#[test]
fn a_short_name_that_two_ids_have_is_noted() {
    let twin = text("1.0.0", &[], "").replace("org.example.hostile", "com.example.hostile");
    let mut registry = Registry::search(&search()).unwrap();
    let own = wat::parse_str(text("1.0.0", &[], "")).unwrap();
    registry.add_wasm_bytes("a", &own).unwrap();
    registry.add_wasm_bytes("b", &wat::parse_str(twin).unwrap()).unwrap();
    assert_eq!(registry.find("hostile").unwrap().id(), ID);
    assert_eq!(registry.find("com.example.hostile").unwrap().id(), "com.example.hostile");
    let note = registry.notes()[0].to_string();
    assert!(note.contains("`hostile` means org.example.hostile"), "{note}");
}

#[test]
fn limits_reach_every_plugin_of_a_search() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), "a.wasm", "1.0.0");
    let tight = Search::builtin()
        .with_dirs(vec![dir.path().to_owned()])
        .with_limits(limits().with_module_bytes(100));
    let mut registry = Registry::search(&tight).unwrap();
    assert!(registry.notes()[0].to_string().contains("100 bytes"));
    let module = std::fs::read(dir.path().join("a.wasm")).unwrap();
    assert!(registry.add_wasm_bytes("felt.htex", &module).is_err());
}

/// Runs itself in another process with changed environment variables.
#[test]
fn folders_of_the_environment() {
    const INSIDE: &str = "HTEX_TEST_INSIDE";
    if std::env::var_os(INSIDE).is_some() {
        let registry = Registry::search(
            &Search::default().with_limits(limits().with_cache(htex_host::WasmCache::User)),
        )
        .unwrap();
        assert_eq!(version(&registry), "2.0.0", "HTEX_PLUGIN_PATH before the user's folder");
        let mut all = registry.all(ID);
        assert!(all.any(|model| model.descriptor().version == "1.0.0"), "the user's folder");
        assert!(matches!(registry.notes()[0], Note::Folder { .. }), "{:?}", registry.notes());
        return assert_eq!(registry.notes().len(), 2);
    }
    let dir = tempfile::tempdir().unwrap();
    let (listed, user) = (dir.path().join("listed"), dir.path().join("data/htex/plugins"));
    std::fs::create_dir_all(&user).unwrap();
    std::fs::create_dir(&listed).unwrap();
    write(&listed, "a.wasm", "2.0.0");
    write(&user, "a.wasm", "1.0.0");
    let listed = std::env::join_paths([dir.path().join("missing"), listed]).unwrap();
    let inside = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "registry::folders_of_the_environment"])
        .env(INSIDE, "1")
        .env("HTEX_PLUGIN_PATH", listed)
        .env("XDG_DATA_HOME", dir.path().join("data"))
        .env("HTEX_CACHE_DIR", dir.path().join("cache"))
        .output()
        .unwrap();
    assert!(inside.status.success(), "{}", String::from_utf8_lossy(&inside.stdout));
    let kept = std::fs::read_dir(dir.path().join("cache/wasm")).unwrap();
    assert_eq!(kept.count(), 2, "both modules are kept, compiled");
}
