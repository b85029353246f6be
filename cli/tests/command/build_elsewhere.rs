//! `htex build` and `htex lib` with files of an S3-compatible server on loopback.

use std::fs;
use std::time::{Duration, SystemTime};

use crate::browser::Browser;
use crate::storage::Bench;
use htex_object_server::Fault;
use serde_json::{Value, json};

/// The part of a recipe before its recordings.
const LIBRARY: &str = "[library]\nname = \"surfaces\"\n[[textures]]\n";
/// The part after the recordings.
const SETTINGS: &str = r#"
pattern = '(?<surface>[a-z]+)_(?<take>\d)'
name = "{surface}/{take}"
models = ["bands"]
license = "CC0-1.0"
at = { speed_mm_s = 80, force_n = 0.4 }
"#;
const NAMES: [&str; 3] = ["vinyl_1", "vinyl_2", "sandpaper_1"];

/// Three recordings here and on a server, with a recipe each.
fn bench() -> Bench {
    let bench = Bench::empty();
    let Bench { server, place } = &bench;
    fs::create_dir(place.path("rec")).unwrap();
    for name in NAMES {
        let (surface, take) = name.split_once('_').unwrap();
        let file = format!("rec/{name}.csv");
        place.simulated(&file, &["--surface", surface, "--seed", take, "--seconds", "2"]);
        let name = format!("lab/{file}");
        server.put(&name, fs::read(place.path(&file)).unwrap());
        // This server has no entity tags in lists; a time that has just been set may stay after
        // another change.
        let there = fs::File::options().write(true).open(server.path(&name)).unwrap();
        there.set_modified(SystemTime::now() - Duration::from_secs(60)).unwrap();
    }
    let relative = format!("{LIBRARY}recordings = \"rec/*.csv\"{SETTINGS}");
    server.put("lab/library.toml", &relative);
    server.put("shop/other", "of somebody else");
    place.write("library.toml", relative);
    let away = format!("{LIBRARY}recordings = \"s3://lab/rec/*.csv\"{SETTINGS}");
    place.write("away.toml", away);
    bench
}

impl Bench {
    fn json(&self, arguments: &[&str]) -> Value {
        let run = self.run(&[arguments, &["--json"]].concat());
        assert_eq!(run.code(), 0, "{}", run.error());
        serde_json::from_str(&run.text()).unwrap()
    }

    fn requests(&self, arguments: &[&str]) -> Vec<String> {
        let before = self.server.requests().len();
        self.json(arguments);
        let requests = self.server.requests().split_off(before);
        let line = |seen: htex_object_server::Seen| format!("{} {}", seen.method, seen.path);
        requests.into_iter().map(line).collect()
    }
}

/// Recipe, recordings and results, each of them here or there: the same bytes.
#[test]
fn where_files_are_changes_no_byte() {
    let bench = bench();
    let here = bench.json(&["build", "library.toml", "-o", "dist"]);
    assert_eq!(here["fitted"], 3);
    bench.server.fail(|n, _| match n {
        1 => Fault::Status(503, "SlowDown"),
        4 => Fault::Cut(100_000),
        _ => Fault::None,
    });
    let away = bench.json(&["build", "away.toml", "-o", "s3://shop/vinyls"]);
    assert_eq!((&away["fitted"], &away["textures"]), (&3.into(), &3.into()));
    assert_eq!(away["library"], "s3://shop/vinyls/surfaces.htexlib");
    bench.json(&["build", "s3://lab/library.toml", "-o", "third"]);
    for file in [
        "surfaces.htexlib",
        "textures/vinyl/1.htex",
        "textures/sandpaper/1.htex",
        "sounds/vinyl/2.wav",
        "build-report.json",
        "index.html",
    ] {
        let dist = fs::read(bench.place.path(&format!("dist/{file}"))).unwrap();
        let third = fs::read(bench.place.path(&format!("third/{file}"))).unwrap();
        let shop = bench.server.get(&format!("shop/vinyls/{file}")).unwrap();
        assert!(dist == third && dist == shop, "{file}");
    }
    let listed = bench.json(&["lib", "ls", "s3://shop/vinyls/surfaces.htexlib"]);
    assert_eq!(listed.as_array().unwrap().len(), 3);
    let cat = ["lib", "cat", "s3://shop/vinyls/surfaces.htexlib", "vinyl/1"];
    let texture = bench.run(&[&cat[..], &["-o", "s3://shop/one.htex"]].concat());
    assert_eq!(texture.code(), 0, "{}", texture.error());
    let one = fs::read(bench.place.path("dist/textures/vinyl/1.htex")).unwrap();
    assert!(bench.server.get("shop/one.htex").unwrap() == one);
}

/// What has not changed is neither read nor written again: a list of the recordings, and two of the
/// results.
#[test]
fn a_second_build_reads_and_writes_what_changed() {
    let bench = bench();
    let build = ["build", "away.toml", "-o", "s3://shop/vinyls", "--work", "w"];
    let first = bench.requests(&build);
    let gets = first.iter().filter(|line| line.contains("GET /lab/rec/"));
    assert_eq!(gets.count(), 3, "each recording once: {first:#?}");
    let again = bench.requests(&build);
    let is_list = |line: &String| line.starts_with("GET") && line.contains("list-type=2");
    assert!(again.iter().all(is_list), "{again:#?}");
    assert_eq!(again.len(), 3, "{again:#?}");
    assert!(!bench.place.path("w/.htex-build/elsewhere").exists());

    let other = fs::read(bench.place.path("rec/vinyl_1.csv")).unwrap();
    bench.server.put("lab/rec/vinyl_2.csv", other);
    fs::remove_file(bench.server.path("lab/rec/sandpaper_1.csv")).unwrap();
    let changed = bench.json(&build);
    assert_eq!((&changed["fitted"], &changed["textures"]), (&1.into(), &2.into()));
    let files = bench.server.files();
    assert!(!files.contains("shop/vinyls/textures/sandpaper/1.htex"), "{files:?}");
    assert!(files.contains("shop/vinyls/textures/vinyl/2.htex"));
}

/// Errors name the file; a result that could not be written is there after the next run.
#[test]
fn errors_name_uris() {
    let bench = bench();
    bench.server.put("lab/rec/vinyl_2.csv", "time,lateral\n0,x\n");
    bench.run(&["build", "away.toml", "-o", "dist"]).failed(1, &["vinyl/2: vinyl_2.csv, line 2"]);
    for (recordings, words) in [
        ("s3://lab/none/*.csv", "no file matches *.csv in s3://lab/none"),
        ("s3://lab/none.csv", "s3://lab/none.csv"),
        ("https://host/*.csv", "list"),
        ("ftp://host/a.csv", "its scheme"),
    ] {
        let recipe = format!("{LIBRARY}recordings = \"{recordings}\"\nname = \"a\"");
        bench.place.write("wrong.toml", recipe);
        bench.run(&["build", "wrong.toml", "-o", "wrong"]).failed(1, &[words]);
    }
    bench.server.fail(|_, seen| match seen.method.as_str() {
        "PUT" if seen.path.contains("htexlib") => Fault::Status(403, "AccessDenied"),
        _ => Fault::None,
    });
    bench
        .place
        .write("one.toml", format!("{LIBRARY}recordings = \"s3://lab/rec/vinyl_1.csv\"{SETTINGS}"));
    let build = ["build", "one.toml", "-o", "s3://shop/one", "--work", "w"];
    bench.run(&build).failed(1, &["s3://shop/one/surfaces.htexlib"]);
    assert!(bench.server.get("shop/one/index.html").is_none());
    bench.server.fail(|_, _| Fault::None);
    assert_eq!(bench.json(&build)["fitted"], 0);
    assert!(bench.server.get("shop/one/index.html").is_some());
}

/// A bucket that cannot be written is found out before anything is fitted, and the report says so.
#[test]
fn a_bucket_is_tried_before_anything_is_fitted() {
    let bench = bench();
    let to = "s3://shop/vinyls";
    let build = ["build", "away.toml", "-o", to, "--work", "w"];
    bench.server.fail(|_, seen| match seen.method.as_str() {
        "PUT" => Fault::Status(403, "AccessDenied"),
        _ => Fault::None,
    });
    let words = "s3://shop/vinyls/.htex-build-tries: the server refuses access";
    bench.run(&build).failed(1, &[words]);
    let requests = bench.server.requests();
    assert_eq!(requests.iter().filter(|seen| seen.method == "PUT").count(), 1);
    let made = crate::common::entries(&bench.place.path("w/.htex-build/made"));
    assert!(made.is_empty(), "{made:?}");
    let report = fs::read(bench.place.path("w/build-report.json")).unwrap();
    let report: Value = serde_json::from_slice(&report).unwrap();
    let error = report["error"][0].as_str().unwrap();
    assert!(error.contains(words), "{report}");
    bench.server.fail(|_, _| Fault::None);
    assert_eq!(bench.json(&build)["fitted"], 3);
    assert!(bench.server.get("shop/vinyls/.htex-build-tries").is_none());
}

/// What the catalogue in a store shows, links to and plays is there, under the media type that it
/// was stored with.
#[test]
fn a_catalogue_opens_from_a_store() {
    let installed = crate::browser::installed();
    if !xtask::needs::CHROMIUM.met(installed.is_some()) {
        return;
    }
    let bench = bench();
    bench.json(&["build", "away.toml", "-o", "s3://web/vinyls"]);
    bench.server.fail(|_, _| Fault::None);
    let mut browser = Browser::start(installed.unwrap(), &bench.place.path("browser"));
    let tab = browser.open(&format!("{}/web/vinyls/index.html", bench.server.url()));
    browser.shows(&tab, "3 of 3");
    let document = browser.value(&tab, "[document.contentType, document.characterSet]");
    assert_eq!(document, json!(["text/html", "UTF-8"]));
    let linked = "Promise.all([...document.querySelectorAll('td a')].map(async (link) => { const got = await fetch(link.href); \
        return [got.status, got.headers.get('content-type'), (await got.arrayBuffer()).byteLength > 0]; }))";
    let texture = json!([200, "application/vnd.htex+zip", true]);
    assert_eq!(browser.promised(&tab, linked), json!([texture, texture, texture]));
    browser.click(&tab, "button.play");
    let played = "new Promise((done) => setInterval(() => performance.getEntriesByType('resource').some((e) => e.name.endsWith('.wav')) \
        && done(document.querySelector('button.play').textContent), 20))";
    assert_eq!(browser.promised(&tab, played), "▶");
    let answers = bench.server.answers();
    let has = |end: &str| answers.iter().any(|(path, _)| path.ends_with(end));
    assert!(has("/index.html") && has(".htex") && has(".wav"), "{answers:?}");
    let failed: Vec<_> = answers.iter().filter(|(_, status)| *status >= 400).collect();
    assert!(failed.is_empty(), "{failed:?}");
}
