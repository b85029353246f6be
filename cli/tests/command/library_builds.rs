//! Libraries from recipes, as a user builds them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, SystemTime};

use crate::common::{Place, words};
use htex_format::library::{Entry, Library};
use serde_json::Value;

const RECIPE: &str = r#"
[library]
name = "surfaces"

[[textures]]
recordings = "rec/*.csv"
pattern = '(?<surface>[a-z-]+)_(?<take>\d)'
name = "{surface}/{take}"
models = ["bands", "sbeta"]
license = "CC0-1.0"
tags = ["{surface}"]
at = { speed_mm_s = 80, force_n = 0.4 }

[textures.gates]
license = true
min_segments = 1
"#;

/// A folder with a recipe and recordings of 2 s, two of each of three surfaces.
fn place() -> Place {
    let place = Place::new();
    fs::create_dir(place.path("rec")).unwrap();
    for surface in ["vinyl", "sandpaper", "fine-fabric"] {
        for take in ["1", "2"] {
            let file = format!("rec/{surface}_{take}.csv");
            place.simulated(&file, &["--surface", surface, "--seed", take, "--seconds", "2"]);
            // Files that have just changed are hashed again the next time.
            age(&place.path(&file), 60);
        }
    }
    place.write("library.toml", RECIPE);
    place
}

fn age(file: &Path, seconds: u64) {
    let file = fs::File::options().write(true).open(file).unwrap();
    let then = SystemTime::now() - Duration::from_secs(seconds);
    file.set_modified(then).unwrap();
}

/// All files of a folder but what is kept for the next build, by path.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(inside) = folders.pop() {
        for entry in fs::read_dir(inside).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(folder).unwrap().to_str().unwrap().to_owned();
            if !path.is_dir() {
                files.insert(name, fs::read(&path).unwrap());
            } else if name != ".htex-build" {
                folders.push(path);
            }
        }
    }
    files
}

/// The same files with the same bytes, without printing these.
fn assert_same(left: &BTreeMap<String, Vec<u8>>, right: &BTreeMap<String, Vec<u8>>) {
    assert!(left.keys().eq(right.keys()), "{:?}, {:?}", left.keys(), right.keys());
    for (name, bytes) in left {
        assert!(right[name] == *bytes, "{name}");
    }
}

fn entries(library: &Path) -> Vec<Entry> {
    let library = Library::open(library).unwrap();
    library.entries().map(Result::unwrap).collect()
}

fn build(place: &Place, output: &str, more: &[&str]) -> Value {
    place.json(&[&["build", "library.toml", "-o", output, "--json"], more].concat())
}

/// One change after another: what it concerns is fitted again, and nothing else.
#[test]
fn what_changed_is_built_and_nothing_else() {
    let place = place();
    let first = build(&place, "dist", &[]);
    assert_eq!((&first["fitted"], &first["textures"]), (&6.into(), &6.into()));
    // `bands` keeps more surfaces below the threshold than two numbers do; what repeats is counted
    // apart.
    let shares = |model: &str| first["felt_shares"][format!("org.htex.{model}")].clone();
    let below = |model: &str| shares(model)["below_difference_threshold"].as_u64();
    assert!(below("bands") > below("sbeta"), "{}", first["felt_shares"]);
    assert_eq!(shares("bands")["textures"], 6);
    assert!(
        shares("bands")["within_repeatability"].is_u64() && shares("bands")["either"].is_null()
    );
    let built = results(&place.path("dist"));
    for file in [
        "surfaces.htexlib",
        "textures/vinyl/1.htex",
        "sounds/vinyl/1.wav",
        "build-report.json",
        "index.html",
    ] {
        assert!(built.contains_key(file), "{file}: {:?}", built.keys());
    }
    let fitted_alone = place.run(&words(
        "fit rec/vinyl_1.csv --model bands,sbeta --speed 80 --force 0.4 -o 1.htex \
             --license CC0-1.0 --tag vinyl",
    ));
    assert_eq!(fitted_alone.code(), 0, "{}", fitted_alone.error());
    let alone = place.json(&["info", "1.htex", "--json"]);
    let ours = place.json(&["info", "dist/textures/vinyl/1.htex", "--json"]);
    assert_eq!(alone["representations"], ours["representations"]);
    let stated = |info: &serde_json::Value| info["manifest"]["representations"].clone();
    assert_eq!(stated(&alone), stated(&ours));

    // Nothing changed; then only times did.
    assert_eq!(build(&place, "dist", &[])["fitted"], 0);
    age(&place.path("rec/vinyl_1.csv"), 30);
    assert_eq!(build(&place, "dist", &[])["fitted"], 0);
    assert_same(&results(&place.path("dist")), &built);

    // A setting of two textures, a recording of one.
    place.write(
        "library.toml",
        RECIPE.to_owned() + "\n[[overrides]]\ntextures = \"vinyl/*\"\nlevel = \"fitted\"\n",
    );
    assert_eq!(build(&place, "dist", &[])["fitted"], 2);
    fs::copy(place.path("rec/sandpaper_2.csv"), place.path("rec/sandpaper_1.csv")).unwrap();
    assert_eq!(build(&place, "dist", &[])["fitted"], 1);

    // A gate concerns no fit; a texture that is gone takes its files along.
    fs::remove_file(place.path("rec/fine-fabric_1.csv")).unwrap();
    place.write(
        "library.toml",
        RECIPE.replace("min_segments = 1", "min_segments = 1\nmax_bytes = 5000"),
    );
    // The setting of two textures is taken back: what was fitted with it before is still there.
    let last = build(&place, "dist", &[]);
    assert_eq!((&last["fitted"], &last["textures"]), (&0.into(), &5.into()));
    let files = results(&place.path("dist"));
    assert!(
        !files.contains_key("textures/fine-fabric/1.htex")
            && !files.contains_key("sounds/fine-fabric/1.wav")
    );
}

/// Metadata are laid over what was fitted; what no texture uses any more stays until it is pruned.
#[test]
fn metadata_fit_nothing_again() {
    let place = place();
    assert_eq!(build(&place, "dist", &[])["fitted"], 6);
    let other = RECIPE
        .replace("CC0-1.0", "CC-BY-4.0")
        .replace("{surface}/{take}", "new/{surface}/{take}")
        .replace("tags = ", "author = \"A. N. Other\"\ntags = ");
    place.write("library.toml", &other);
    let dry = build(&place, "dist", &["--dry-run"]);
    assert_eq!((&dry["to_fit"], &dry["as_they_were"]), (&serde_json::json!([]), &6.into()));
    assert_eq!(build(&place, "dist", &[])["fitted"], 0);
    let info = &place.json(&["info", "dist/textures/new/vinyl/1.htex", "--json"])["manifest"];
    assert_eq!((&info["license"], &info["name"]), (&"CC-BY-4.0".into(), &"new/vinyl/1".into()));
    assert!(!place.path("dist/textures/vinyl").exists());
    // As if nothing else had ever been built, once the names that are gone were told.
    assert_eq!(build(&place, "dist", &[])["removed"], serde_json::json!([]));
    build(&place, "alone", &[]);
    assert_same(&results(&place.path("dist")), &results(&place.path("alone")));
    // Metadata that are left out leave nothing behind.
    place.write("library.toml", other.replace("author = \"A. N. Other\"\n", ""));
    assert_eq!(build(&place, "dist", &[])["fitted"], 0);
    let info = place.json(&["info", "dist/textures/new/vinyl/1.htex", "--json"]);
    assert!(info["manifest"]["author"].is_null());
    // An option that is taken back, before and after pruning.
    let with_level = RECIPE.replace("models = ", "level = \"fitted\"\nmodels = ");
    for (recipe, flags, fitted) in [
        (&with_level[..], &[][..], 6),
        (RECIPE, &[], 0),
        (RECIPE, &["--prune"], 0),
        (&with_level, &[], 6),
    ] {
        place.write("library.toml", recipe);
        assert_eq!(build(&place, "dist", flags)["fitted"], fitted);
    }
    let made = fs::read_dir(place.path("dist/.htex-build/made")).unwrap();
    assert_eq!(made.count(), 12);
}

/// A dry run checks what a build would, says why each texture would be fitted, and writes no
/// result.
#[test]
fn a_dry_run_checks_and_says_why() {
    let place = place();
    let why = |output: &str| -> BTreeMap<String, String> {
        let dry = build(&place, output, &["--dry-run"]);
        let text = |value: &Value| value.as_str().unwrap().to_owned();
        let listed = dry["to_fit"].as_array().unwrap().iter();
        listed.map(|one| (text(&one["texture"]), text(&one["why"]))).collect()
    };
    let new = why("dist");
    assert!(new.len() == 6 && new.values().all(|why| why == "new"), "{new:?}");
    assert!(!place.path("dist/surfaces.htexlib").exists());
    let run = place.run(&["build", "library.toml", "-o", "dist", "--dry-run"]);
    assert!(run.text().contains("6 textures: 6 to fit from 6 recordings"), "{}", run.text());
    build(&place, "dist", &[]);
    assert_eq!(why("dist"), BTreeMap::new());
    place.write(
        "library.toml",
        RECIPE.to_owned() + "[[overrides]]\ntextures = \"vinyl/1\"\nlevel = \"fitted\"\n",
    );
    fs::copy(place.path("rec/sandpaper_2.csv"), place.path("rec/sandpaper_1.csv")).unwrap();
    let changed = why("dist");
    assert_eq!(changed["vinyl/1"], "changed: options");
    // The same contents under another name are another recording.
    assert_eq!(changed["sandpaper/1"], "changed: recordings");
    assert_eq!(changed.len(), 2);
    for (from, to, said) in [
        ("models = [\"bands\"", "options.bands.order = 3\nmodels = [\"bands\"", "order"),
        ("models = [\"bands\"", "models = [\"spline\"", "spline"),
        (
            "min_segments = 1",
            "max_band_error_db = { ar = 1 }",
            "gates.max_band_error_db: ar is not fitted",
        ),
        ("min_segments = 1", "max_band_error_db = -1", "which no texture meets"),
        ("name = \"surfaces\"", "name = \"surfaces\"\nplugins = [\"none.wasm\"]", "none.wasm"),
    ] {
        place.write("library.toml", RECIPE.replace(from, to));
        for arguments in [
            &["build", "library.toml", "-o", "dist", "--dry-run"][..],
            &["validate", "library.toml"],
        ] {
            let run = place.run(arguments);
            let all = run.text() + &run.error();
            assert!(run.code() == 1 && all.contains(said), "{arguments:?} {to}: {all}");
        }
        // With `--json`, a failure is also JSON.
        let run = place.run(&["build", "library.toml", "-o", "dist", "--dry-run", "--json"]);
        let error: Value = serde_json::from_str(&run.text()).unwrap();
        assert!(error["error"].to_string().contains(said.split('"').next().unwrap()), "{error}");
    }
    place.write("library.toml", RECIPE);
    let run = place.run(&["validate", "library.toml"]);
    assert!(run.code() == 0 && run.text().contains("library.toml: valid"), "{}", run.text());
}

/// Globs lead out of the recipe's folder, and links that lead nowhere stop nothing.
#[cfg(unix)]
#[test]
fn globs_find_what_they_say_wherever_it_is() {
    use std::os::unix::fs::symlink;
    let place = place();
    fs::create_dir_all(place.path("recipes/rec")).unwrap();
    for link in ["recipes/nowhere", "recipes/rec/nowhere.csv", "rec/nowhere.csv"] {
        symlink("/nowhere", place.path(link)).unwrap();
    }
    symlink("..", place.path("recipes/loop")).unwrap();
    fs::copy(place.path("rec/vinyl_1.csv"), place.path("recipes/rec/vinyl_1.csv")).unwrap();
    let absolute = place.path("rec").canonicalize().unwrap();
    let absolute = absolute.display();
    for (glob, textures) in [
        ("../rec/*.csv".to_owned(), 6),
        ("../rec/vinyl_{1,2}.csv".to_owned(), 2),
        ("../**/sandpaper_1.csv".to_owned(), 1),
        ("rec/../../rec/vinyl_*.csv".to_owned(), 2),
        (format!("{absolute}/*.csv"), 6),
        (format!("{absolute}/vinyl_1.csv"), 1),
        (format!("file://{absolute}/*_1.csv"), 3),
        ("rec/*.csv".to_owned(), 1),
    ] {
        place.write("recipes/library.toml", RECIPE.replace("rec/*.csv", &glob));
        let run =
            place.run(&["build", "recipes/library.toml", "-o", "dist", "--dry-run", "--json"]);
        assert_eq!(run.code(), 0, "{glob}: {}", run.error());
        let dry: Value = serde_json::from_str(&run.text()).unwrap();
        assert_eq!(dry["textures"], textures, "{glob}");
    }
}

/// Recordings of one texture with one file name are told apart, in reports by their folders and in
/// the asset by their hashes.
#[test]
fn an_asset_has_the_name_and_the_hash_of_each_recording() {
    let place = place();
    for day in ["monday", "tuesday"] {
        fs::create_dir_all(place.path(&format!("days/{day}/take"))).unwrap();
        let from = if day == "monday" { "rec/vinyl_1.csv" } else { "rec/vinyl_2.csv" };
        fs::copy(place.path(from), place.path(&format!("days/{day}/take/a.csv"))).unwrap();
    }
    let recipe = "[library]\nname = \"days\"\n[[textures]]\nrecordings = \"days/**/*.csv\"\nname = \"one\"\nmodels = [\"bands\"]\n\
                  at = { speed_mm_s = 80, force_n = 0.4 }\n";
    place.write("library.toml", recipe);
    build(&place, "dist", &[]);
    let asset = htex_format::Asset::open(&place.path("dist/textures/one.htex")).unwrap();
    let sources = &asset.manifest.provenance.recordings;
    let names: Vec<&str> = sources.iter().map(|source| &source.file[..]).collect();
    assert_eq!(names, ["a.csv", "a.csv"]);
    for (source, file) in sources.iter().zip(["rec/vinyl_1.csv", "rec/vinyl_2.csv"]) {
        let hash = blake3::hash(&fs::read(place.path(file)).unwrap()).to_hex();
        assert_eq!(source.blake3.as_deref(), Some(hash.as_str()));
    }
    let report: Value =
        serde_json::from_slice(&fs::read(place.path("dist/build-report.json")).unwrap()).unwrap();
    assert_eq!(report["textures"][0]["recordings"][1]["file"], "tuesday/take/a.csv");
}

/// The same bytes with one job and with three, in another folder, and after a result was damaged.
#[test]
fn the_bytes_do_not_depend_on_jobs_folder_or_order() {
    let place = place();
    build(&place, "one", &["--jobs", "1"]);
    build(&place, "three", &["--jobs", "3"]);
    let expected = results(&place.path("one"));
    assert_same(&results(&place.path("three")), &expected);
    let kept = fs::read_dir(place.path("one/.htex-build/made"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .next()
        .unwrap();
    let mut bytes = fs::read(&kept).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(&kept, bytes).unwrap();
    fs::write(place.path("one/textures/vinyl/1.htex"), b"edited").unwrap();
    fs::write(place.path("one/surfaces.htexlib"), b"edited").unwrap();
    assert_eq!(build(&place, "one", &[])["fitted"], 1);
    assert_same(&results(&place.path("one")), &expected);
    let entries = entries(&place.path("one/surfaces.htexlib"));
    let names: Vec<&str> = entries.iter().map(|entry| &entry.name[..]).collect();
    let sorted =
        ["fine-fabric/1", "fine-fabric/2", "sandpaper/1", "sandpaper/2", "vinyl/1", "vinyl/2"];
    assert_eq!(names, sorted);
}

/// Killed at moments over the length of a build, then run again: as if nothing had happened.
#[cfg(unix)]
#[test]
fn a_killed_build_goes_on_to_the_same_bytes() {
    let place = place();
    let start = std::time::Instant::now();
    build(&place, "whole", &["--jobs", "2"]);
    let whole = start.elapsed();
    for kill in 1..=20 {
        let build = ["build", "library.toml", "-o", "killed", "--jobs", "2"];
        let mut child =
            place.command(&build).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        // Moments that are spread over the build by a number that has no period with it.
        let part = (f64::from(kill) * 0.618).fract();
        std::thread::sleep(whole.mul_f64(part));
        child.kill().unwrap();
        child.wait().unwrap();
        if kill % 4 == 0 {
            fs::remove_dir_all(place.path("killed/.htex-build/made")).unwrap();
        }
    }
    build(&place, "killed", &[]);
    assert_same(&results(&place.path("killed")), &results(&place.path("whole")));
}

/// What misses a gate is left out with a reason, what cannot be fitted stops the build or is left
/// out; the others stand.
#[test]
fn what_fails_is_reported_and_the_others_stand() {
    let place = place();
    place.write("rec/broken_1.csv", "t_s,lateral_n\n0,1\n0.1,zero\n");
    let run = place.run(&["build", "library.toml", "-o", "dist"]);
    assert_eq!(run.code(), 1);
    assert!(run.error().contains("broken/1") && run.error().contains("zero"), "{}", run.error());
    let run = place.run(&["build", "library.toml", "-o", "dist", "--keep-going"]);
    assert_eq!(run.code(), 3, "{}", run.error());
    assert!(run.text().contains("left out: broken/1: fit: broken_1.csv"), "{}", run.text());
    assert_eq!(entries(&place.path("dist/surfaces.htexlib")).len(), 6);
    let report: Value =
        serde_json::from_slice(&fs::read(place.path("dist/build-report.json")).unwrap()).unwrap();
    let left_out: Vec<&Value> = report["textures"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|t| t["status"] == "left_out")
        .collect();
    assert_eq!((left_out.len(), &left_out[0]["name"]), (1, &"broken/1".into()));
}

/// Cuts the lateral force of a recording off at 60 % of its largest value.
fn clip(file: &Path) {
    let text = fs::read_to_string(file).unwrap();
    let (head, rows): (Vec<&str>, Vec<&str>) =
        text.lines().partition(|line| !line.starts_with(|c: char| c.is_ascii_digit()));
    let cells: Vec<Vec<f64>> =
        rows.iter().map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    let most = cells.iter().map(|row| row[1].abs()).fold(0.0, f64::max);
    let clipped = cells.iter().map(|row| {
        let mut row = row.clone();
        row[1] = row[1].clamp(-0.6 * most, 0.6 * most);
        row.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
    });
    let lines: Vec<String> = head.iter().map(ToString::to_string).chain(clipped).collect();
    fs::write(file, lines.join("\n")).unwrap();
    age(file, 60);
}

/// Recordings that clip are counted by the code of their finding wherever a build is told of, and
/// gates leave them out.
#[test]
fn findings_are_counted_by_code_and_denied_by_gates() {
    let place = place();
    for name in ["vinyl_1", "sandpaper_2"] {
        clip(&place.path(&format!("rec/{name}.csv")));
    }
    let run = place.run(&["build", "library.toml", "-o", "dist"]);
    assert_eq!(run.code(), 0, "{}", run.error());
    let line = "RECORDING_CLIPPED (error): 2 textures, 2 in the library: sandpaper/2, vinyl/1\n";
    assert!(run.text().contains(line), "{}", run.text());
    let again = build(&place, "dist", &[]);
    let clipped = &again["findings"]["RECORDING_CLIPPED"];
    assert_eq!(
        *clipped,
        serde_json::json!({
            "severity": "error", "textures": 2, "in_library": 2, "first": ["sandpaper/2", "vinyl/1"],
        })
    );
    let report = |folder: &str| -> Value {
        let file = place.path(folder).join("build-report.json");
        serde_json::from_slice(&fs::read(file).unwrap()).unwrap()
    };
    let report_of_first = report("dist");
    assert_eq!(report_of_first["findings"], again["findings"]);
    let own = &report_of_first["textures"][3]["asset"]["findings"];
    assert_eq!(report_of_first["textures"][3]["name"], "sandpaper/2");
    assert!(own.to_string().contains("\"recordings\":[\"sandpaper_2.csv\"]"), "{own}");
    let page = fs::read_to_string(place.path("dist/index.html")).unwrap();
    assert!(page.contains("\"code\":\"RECORDING_CLIPPED\""), "the catalogue has it");
    // Another gate fits nothing again.
    let gated = |gate: &str| {
        place.write("library.toml", RECIPE.replace("min_segments = 1", gate));
        let run = place.run(&["build", "library.toml", "-o", "dist", "--json"]);
        let built: Value = serde_json::from_str(&run.text()).unwrap();
        let left_out = built["left_out"].as_array().unwrap().clone();
        // Some are left out, or all.
        let code = if left_out.len() == 6 { 1 } else { 3 };
        assert_eq!((run.code(), &built["fitted"]), (code, &0.into()), "{built}");
        assert_eq!(built["textures"], 6 - left_out.len());
        left_out
    };
    let left_out = gated("deny = [\"RECORDING_CLIPPED\"]");
    let names: Vec<&Value> = left_out.iter().map(|texture| &texture["name"]).collect();
    assert_eq!(names, ["sandpaper/2", "vinyl/1"]);
    let reason = left_out[0]["missed"][0]["reason"].as_str().unwrap();
    assert!(
        left_out[0]["missed"][0]["gate"] == "deny"
            && reason.starts_with("RECORDING_CLIPPED (sandpaper_2.csv): "),
        "{reason}"
    );
    assert_eq!(report("dist")["findings"]["RECORDING_CLIPPED"]["in_library"], 0);
    for (gate, value) in [
        ("max_repeatability_db", "0.001"),
        ("max_band_error_db", "{ sbeta = 0.01 }"),
        ("max_felt_error_db", "0.001"),
        ("max_felt_error_db", "{ sbeta = 0.001 }"),
    ] {
        let left_out = gated(&format!("{gate} = {value}"));
        assert_eq!(left_out.len(), 6, "{gate}");
        assert_eq!(left_out[0]["missed"][0]["gate"], gate);
    }
}

/// An error that ends a build is in the report, beside what an earlier build left; the next build
/// is as if it had not been.
#[test]
fn an_error_that_ends_a_build_is_in_its_report() {
    let place = place();
    let report = || -> Value {
        let report = fs::read(place.path("dist/build-report.json")).unwrap();
        serde_json::from_slice(&report).unwrap()
    };
    let failed = |output: &str| {
        let run = place.run(&["build", "library.toml", "-o", output, "--json"]);
        assert_eq!(run.code(), 1, "{}", run.error());
        serde_json::from_str::<Value>(&run.text()).unwrap()["error"].clone()
    };
    place.write("library.toml", "[library]\nnames = 1\nnome = 2\n");
    failed("dist");
    assert!(!place.path("dist").exists(), "no build has begun");

    place.write("library.toml", RECIPE.replace("\"sbeta\"", "\"spline\""));
    let error = failed("dist");
    assert_eq!(report()["error"], error);
    assert!(error[0].as_str().unwrap().contains("spline"), "{error}");
    assert_eq!(report()["textures"], Value::Array(Vec::new()));

    place.write("library.toml", RECIPE);
    build(&place, "dist", &[]);
    let whole = report();
    assert!(whole.get("error").is_none());
    place.write("rec/broken_1.csv", "t_s,lateral_n\n0,1\n0.1,zero\n");
    let error = failed("dist");
    assert!(error[0].as_str().unwrap().contains("broken/1"), "{error}");
    let mut after = report();
    assert_eq!(after["error"], error);
    after.as_object_mut().unwrap().remove("error");
    assert_eq!(after, whole);

    place.write("library.toml", "[library]\nnames = 1\nnome = 2\n");
    let before = report();
    let dry = place.run(&["build", "library.toml", "-o", "dist", "--dry-run"]);
    assert_eq!((dry.code(), report()), (1, before));
    let error = failed("dist");
    assert_eq!(report()["error"], error);
    assert!(error.as_array().unwrap().len() > 1, "its lines: {error}");

    let fewer = RECIPE.replace("rec/*.csv", "rec/vinyl_*.csv");
    place.write("library.toml", fewer);
    build(&place, "dist", &[]);
    assert!(report().get("error").is_none());
    assert!(!place.path("dist/textures/sandpaper/1.htex").exists());
}

/// Wrong recipes say where and what, and make no library.
#[test]
fn wrong_recipes_say_where() {
    let place = place();
    let cases = [
        ("name = \"surfaces\"", "name = \"a\nmodels", "library.toml: line 4, column 7: "),
        (
            "[[textures]]",
            "[defaults]\nlicence = \"CC-BY-4.0\"\n[[textures]]",
            "library.toml: line 6: there is no key `defaults.licence`; did you mean `license`?",
        ),
        ("rec/*.csv", "rec/*.tdms", "no file matches rec/*.tdms"),
        (
            "{surface}/{take}",
            "{surfce}",
            "nothing is called `surfce`; there are file, folder, stem, surface, take",
        ),
        ("{surface}/{take}", "../{stem}", "textures[0].name: a part of it is empty, `.` or `..`"),
        ("(?<take>", "(?<take", "textures[0].pattern"),
        ("(?<surface>[a-z-]+)", "(?<surface>x)", "does not match"),
        ("CC0-1.0", "free for all", "license"),
        (
            "speed_mm_s = 80",
            "speed_mm_s = \"{surface}\"",
            "speed_mm_s is `fine-fabric`; it is a number",
        ),
        (
            "[textures.gates]",
            "[[overrides]]\ntextures = \"vynil/*\"\n[overrides.gates]",
            "no texture has such a name",
        ),
        ("\"sbeta\"", "\"spline\"", "spline"),
        (
            "min_segments = 1",
            "deny = [\"RECORDING_CLIPED\"]",
            "gates.deny: no recording of an asset has a finding RECORDING_CLIPED; there are RECORDING_CLOCK_GAP",
        ),
    ];
    for (from, to, expected) in cases {
        place.write("library.toml", RECIPE.replace(from, to));
        let run = place.run(&["build", "library.toml", "-o", "dist"]);
        assert!(matches!(run.code(), 1 | 2), "{to}");
        let error = run.error();
        let is_escaped = expected.contains("column") && error.contains("\\n");
        assert!(error.contains(expected) && !is_escaped, "{to}: {error}");
        assert!(!place.path("dist/surfaces.htexlib").exists(), "{to}");
    }
}

/// A table names recordings, conditions and fields.
#[test]
fn a_table_says_what_files_do_not() {
    let place = place();
    let table = "recording,name,speed_mm_s,force_n,price\nrec/vinyl_1.csv,A,80,0.4,cheap\nrec/vinyl_2.csv,A,160,0.4,cheap\n\
                 rec/sandpaper_1.csv,B,80,0.4,dear\n";
    place.write("recordings.csv", table);
    let recipe = "[library]\nname = \"t\"\n[[textures]]\ntable = \"recordings.csv\"\nmodels = [\"bands\"]\ntags = [\"{price}\"]\n";
    place.write("library.toml", recipe);
    let run = place.run(&["build", "library.toml", "-o", "dist"]);
    // The simulated finger moves at 80 mm/s: a recording that is said to be at 160 has no segment
    // there.
    assert_eq!(run.code(), 1);
    assert!(run.error().contains("vinyl_2.csv") && run.error().contains("160"), "{}", run.error());
    place.write("recordings.csv", table.replace("160", "80"));
    build(&place, "dist", &[]);
    let entries_of = entries;
    let entries = entries_of(&place.path("dist/t.htexlib"));
    assert_eq!((&entries[0].name[..], &entries[1].tags[0][..]), ("A", "dear"));
    let recordings = place.json(&["info", "dist/textures/A.htex", "--json"]);
    assert_eq!(recordings["manifest"]["conditions"].as_array().unwrap().len(), 1);

    // A row whose file is missing stops the build, or its texture is left out and the others stand.
    let missing = table.replace("160", "80") + "rec/none.csv,C,80,0.4,dear\n";
    place.write("recordings.csv", missing);
    let run = place.run(&["build", "library.toml", "-o", "dist"]);
    assert_eq!(run.code(), 1);
    assert!(run.error().contains("none.csv"), "{}", run.error());
    let run = place.run(&["build", "library.toml", "-o", "dist", "--keep-going"]);
    assert_eq!(run.code(), 3, "{}", run.error());
    let text = run.text();
    assert!(text.contains("left out: C: fit: cannot read ./rec/none.csv"), "{text}");
    assert!(text.contains("0 fitted, 2 as they were"), "{text}");
    assert_eq!(entries_of(&place.path("dist/t.htexlib")).len(), 2);
}

/// A folder that was moved takes its textures out of the library: that is said, and refused where
/// nothing may be removed.
#[test]
fn textures_whose_recordings_are_gone_are_named() {
    let place = place();
    build(&place, "dist", &[]);
    let before = results(&place.path("dist"));
    for take in ["1", "2"] {
        fs::remove_file(place.path(&format!("rec/vinyl_{take}.csv"))).unwrap();
    }
    let names = serde_json::json!(["vinyl/1", "vinyl/2"]);
    assert_eq!(build(&place, "dist", &["--dry-run"])["removed"], names);
    let line = ["build", "library.toml", "-o", "dist"];
    let refused = |place: &Place| {
        let run = place.run(&[&line[..], &["--no-removals"]].concat());
        assert_eq!(run.code(), 1, "{}", run.text());
        assert_same(&results(&place.path("dist")), &before);
        run.error()
    };
    let error = refused(&place);
    assert!(error.contains("would lose 2 textures (vinyl/…)"), "{error}");
    // A report that is gone hides nothing: the library has its own index.
    let report = place.path("dist/build-report.json");
    fs::remove_file(&report).unwrap();
    assert_eq!(build(&place, "dist", &["--dry-run"])["removed"], names);
    fs::write(&report, &before["build-report.json"]).unwrap();

    let run = place.run(&line);
    assert_eq!(run.code(), 0, "{}", run.error());
    let text = run.text();
    assert!(text.contains("removed: 2 textures (vinyl/…)\n"), "{text}");
    let after = results(&place.path("dist"));
    assert!(!after.contains_key("textures/vinyl/1.htex"));
    let report: Value = serde_json::from_slice(&after["build-report.json"]).unwrap();
    assert_eq!(report["removed"], names);
    let page = String::from_utf8_lossy(&after["index.html"]).into_owned();
    assert!(page.contains("2 removed (vinyl/…)"));
    assert_eq!(build(&place, "dist", &["--no-removals"])["removed"], serde_json::json!([]));

    // A texture that misses a gate is also lost.
    let before = results(&place.path("dist"));
    place.write("library.toml", RECIPE.replace("min_segments = 1", "min_segments = 900"));
    let run = place.run(&[&line[..], &["--no-removals"]].concat());
    assert_eq!(run.code(), 1, "{}", run.text());
    assert!(run.error().contains("would lose 4 textures"), "{}", run.error());
    assert_same(&results(&place.path("dist")), &before);
}

/// Textures whose recordings are archived stay in the library as they were, through later builds, and
/// a library may not lose more textures than the recipe says.
#[test]
fn textures_without_recordings_stay_or_are_missed() {
    let place = place();
    build(&place, "dist", &[]);
    let library =
        |name: &str| Library::open(&place.path("dist/surfaces.htexlib")).unwrap().get(name);
    let before = library("vinyl/1").unwrap();
    fs::rename(place.path("rec/vinyl_1.csv"), place.path("archived.csv")).unwrap();
    fs::rename(place.path("rec/vinyl_2.csv"), place.path("archived too.csv")).unwrap();

    let first = "[library]\nname = \"surfaces\"";
    place.write("library.toml", RECIPE.replace(first, &format!("{first}\nmax_removed = 1")));
    let refused = place.run(&["build", "library.toml", "-o", "dist"]);
    assert!(refused.code() == 1 && refused.error().contains("would lose 2 textures (vinyl/…)"));
    assert!(library("vinyl/1").unwrap() == before);

    place.write("library.toml", RECIPE.replace(first, &format!("{first}\nmissing = \"keep\"")));
    for _ in 0..2 {
        let kept = build(&place, "dist", &["--no-removals"]);
        assert_eq!(kept["kept"], serde_json::json!(["vinyl/1", "vinyl/2"]), "{kept}");
        assert_eq!([&kept["textures"], &kept["fitted"]], [6, 0]);
        assert!(library("vinyl/1").unwrap() == before);
        assert!(place.path("dist/textures/vinyl/1.htex").exists());
    }
    assert_eq!(place.run(&["lib", "verify", "dist/surfaces.htexlib"]).code(), 0);
    let text = place.run(&["build", "library.toml", "-o", "dist"]).text();
    assert!(text.contains("kept: 2 textures (vinyl/…)"), "{text}");

    // They cannot be kept without the library that has them.
    fs::remove_file(place.path("dist/surfaces.htexlib")).unwrap();
    let lost = place.run(&["build", "library.toml", "-o", "dist"]);
    assert!(lost.code() == 1 && lost.error().contains("library.missing"), "{}", lost.error());

    place.write("library.toml", RECIPE);
    let removed = build(&place, "dist", &[]);
    assert_eq!(
        [&removed["textures"], &removed["removed"][0]],
        [&Value::from(4), &"vinyl/1".into()]
    );
    assert!(!place.path("dist/textures/vinyl/1.htex").exists());
}

/// A recording that cannot be fitted is not fitted at each build, and each build says so.
#[test]
fn a_failed_fit_is_remembered() {
    let place = place();
    place.write("rec/short_1.csv", "t_s,fx_n\n0,0.1\n0.001,0.2\n");
    age(&place.path("rec/short_1.csv"), 60);
    let left_out = |built: &Value| {
        let missed = &built["left_out"][0]["missed"][0];
        (built["left_out"][0]["name"].clone(), missed["gate"].clone(), missed["reason"].clone())
    };
    let run = || place.run(&["build", "library.toml", "-o", "dist", "--keep-going", "--json"]);
    let first: Value = serde_json::from_str(&run().text()).unwrap();
    let second: Value = serde_json::from_str(&run().text()).unwrap();
    assert_eq!((&first["fitted"], &second["fitted"]), (&7.into(), &0.into()));
    assert_eq!(left_out(&first), left_out(&second));
    assert_eq!(left_out(&first).0, "short/1");
    let strict = place.run(&["build", "library.toml", "-o", "dist"]);
    let reason = left_out(&first).2;
    assert!(strict.code() == 1 && strict.error().contains(reason.as_str().unwrap()));

    // In the formats of continuous integration.
    let format = |format: &str| {
        place.run(&["build", "library.toml", "-o", "dist", "--keep-going", "--format", format])
    };
    let github = format("github").text();
    assert!(github.contains("::error file=short/1,title=FIT::"), "{github}");
    let junit = format("junit").text();
    assert!(junit.contains("tests=\"7\" failures=\"1\""), "{junit}");

    // Other contents are another recording.
    place.simulated("rec/short_1.csv", &["--surface", "vinyl", "--seed", "9", "--seconds", "2"]);
    let mended = build(&place, "dist", &[]);
    assert_eq!([&mended["fitted"], &mended["textures"]], [1, 7]);
}

/// A recipe says what its library is, and the index knows what the build measured.
#[test]
fn a_recipe_describes_its_library() {
    let place = place();
    let first = "[library]\nname = \"surfaces\"";
    let described =
        format!("{first}\nversion = \"1.2\"\nauthors = [\"Ana\"]\ndate = \"2026-11-30\"");
    place.write("library.toml", RECIPE.replace(first, &described));
    build(&place, "dist", &[]);
    let info = place.json(&["lib", "info", "dist/surfaces.htexlib", "--json"]);
    assert_eq!([&info["version"], &info["authors"][0]], [&Value::from("1.2"), &"Ana".into()]);
    // What the report says of the model that an app plays.
    let report: Value =
        serde_json::from_str(&fs::read_to_string(place.path("dist/build-report.json")).unwrap())
            .unwrap();
    let felt = &report["textures"][0]["asset"]["felt"]["org.htex.bands"]["error_rms_db"];
    let entry = &place.json(&["lib", "ls", "dist/surfaces.htexlib", "--json"])[0];
    let known = entry["felt_error_rms_db"].as_f64().unwrap();
    assert!(known >= felt.as_f64().unwrap() && known < felt.as_f64().unwrap() + 0.0101, "{entry}");
    let wrong = RECIPE.replace(first, &format!("{first}\ndate = \"soon\""));
    place.write("library.toml", &wrong);
    let run = place.run(&["build", "library.toml", "-o", "dist"]);
    assert!(run.code() == 1 && run.error().contains("library: date is no date"), "{}", run.error());
}

/// Two builds of a part each, merged, have what one build of both has.
#[test]
fn merged_builds_are_the_build_of_all() {
    let place = place();
    let whole = build(&place, "whole", &[]);
    for part in ["vinyl", "sandpaper"] {
        let recipe = RECIPE.replace("rec/*.csv", &format!("rec/{part}*.csv"));
        place.write("library.toml", &recipe);
        build(&place, part, &[]);
    }
    place.write("library.toml", RECIPE.replace("rec/*.csv", "rec/fine*.csv"));
    build(&place, "fine", &[]);
    let merge = ["lib", "merge", "vinyl", "sandpaper", "fine", "-o", "dist", "--name", "surfaces"];
    let merged = place.json(&[&merge[..], &["--json"]].concat());
    assert_eq!([&merged["textures"], &merged["left_out"]], [&whole["textures"], &0.into()]);
    let (ours, theirs) = (results(&place.path("dist")), results(&place.path("whole")));
    assert_same(&ours, &theirs);
    let prefixed = [&merge[..6], &["prefixed", "--prefix", "a/,b/,c/"]].concat();
    assert_eq!(place.run(&prefixed).code(), 0);
    assert!(place.path("prefixed/textures/b/sandpaper/1.htex").exists());
    assert_eq!(place.run(&["lib", "verify", "prefixed/library.htexlib"]).code(), 0);

    let again = place.run(&["lib", "merge", "vinyl", "rec", "-o", "none"]);
    assert!(again.code() == 1 && again.error().contains("no build has written this folder"));
    let mixed = place.run(&["lib", "merge", "vinyl", "vinyl/surfaces.htexlib", "-o", "none"]);
    assert_eq!(mixed.code(), 2);
}
