//! Inputs and outputs by URI: the command against an S3-compatible server on loopback, with faults.

use std::process::Command;

use crate::common::{Place, Run, entries, signal, until, words};
use htex_object_server::{ACCESS_KEY, Fault, SECRET_KEY, Server};
use serde_json::json;

/// A server, a folder to work in, and a folder for temporary files.
pub struct Bench {
    pub server: Server,
    pub place: Place,
}

impl Bench {
    /// With nothing anywhere.
    pub fn empty() -> Self {
        let (server, place) = (Server::start(), Place::new());
        std::fs::create_dir(place.path("tmp")).unwrap();
        Self { server, place }
    }

    /// With a recording here and there, and an asset there.
    fn new() -> Self {
        let Self { server, place } = Self::empty();
        let recording = std::fs::read(place.path(&place.recording("vinyl"))).unwrap();
        server.put("surfaces/vinyl.csv", &recording);
        server.put("web/vinyl.csv", &recording);
        server.put("surfaces/cloth.htex", asset());
        Self { server, place }
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = self.place.command(arguments);
        for (name, _) in std::env::vars().filter(|(name, _)| name.starts_with("AWS_")) {
            command.env_remove(name);
        }
        command.envs(self.server.variables());
        command.env("TMPDIR", self.place.path("tmp")).env("NO_PROXY", "127.0.0.1");
        command.env("XDG_CACHE_HOME", self.place.path("cache"));
        command
    }

    /// Runs, and looks for secrets and copies that are left.
    pub fn run(&self, arguments: &[&str]) -> Run {
        let before = self.copies();
        let done = self.finish(self.command(arguments));
        assert_eq!(self.copies(), before);
        done
    }

    fn finish(&self, mut command: Command) -> Run {
        let done = Run::of(command.output().unwrap());
        for text in [done.text(), done.error()] {
            for secret in [SECRET_KEY, ACCESS_KEY, "AWS4-HMAC", "S3CR3T", "Signature="] {
                assert!(!text.contains(secret), "{text}");
            }
        }
        done
    }

    fn copies(&self) -> Vec<String> {
        entries(&self.place.path("tmp"))
    }
}

fn asset() -> Vec<u8> {
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes");
    std::fs::read(format!("{examples}/vinyl.htex")).unwrap()
}

/// From a recording to samples, each file elsewhere, while the server fails now and then.
#[test]
fn files_elsewhere_are_those_here() {
    let bench = Bench::new();
    let (place, server) = (&bench.place, &bench.server);
    let here = bench.run(&["fit", "vinyl.csv", "--model", "bands,ar", "-o", "vinyl.htex"]);
    assert_eq!(here.code(), 0, "{}", here.error());
    server.fail(|n, _| match n {
        0 | 3 => Fault::Status(503, "SlowDown"),
        1 => Fault::Cut(500_000),
        _ => Fault::None,
    });
    let there = bench.run(&words(
        "fit s3://surfaces/vinyl.csv --model bands,ar -o s3://surfaces/new/vinyl.htex \
             --report s3://surfaces/new/vinyl.html",
    ));
    assert_eq!(there.code(), 0, "{}", there.error());
    let methods: Vec<String> = server.requests().into_iter().map(|r| r.method).collect();
    assert_eq!(methods, ["GET", "GET", "GET", "PUT", "PUT", "PUT"]);
    assert_eq!(
        server.get("surfaces/new/vinyl.htex").unwrap(),
        std::fs::read(place.path("vinyl.htex")).unwrap()
    );
    let page = String::from_utf8(server.get("surfaces/new/vinyl.html").unwrap()).unwrap();
    assert!(
        page.contains("s3://surfaces/vinyl.csv")
            && !page.contains(place.path("tmp").to_str().unwrap())
    );
    assert_eq!(
        there.text().lines().next().unwrap(),
        here.text().lines().next().unwrap().replace("vinyl.htex", "s3://surfaces/new/vinyl.htex")
    );
    assert_eq!(there.text().lines().nth(1), here.text().lines().nth(1));

    let one = bench.run(&["process", "vinyl.csv"]).text();
    assert_eq!(bench.run(&["process", "s3://surfaces/vinyl.csv"]).text(), one);
    let web = format!("{}/web/vinyl.csv?sig=S3CR3T", server.url());
    assert_eq!(bench.run(&["process", &web]).text(), one);

    let uri = "s3://surfaces/new/vinyl.htex";
    let info: serde_json::Value =
        serde_json::from_str(&bench.run(&["info", uri, "--json"]).text()).unwrap();
    assert_eq!(info["asset"], uri);
    let valid = bench.run(&["validate", uri, "s3://surfaces/vinyl.csv"]);
    assert!(valid.text().starts_with(&format!("{uri}: valid\n")), "{}", valid.text());
    let synth = |asset: &str, output: &str| {
        let done = bench.run(&["synth", asset, "--seconds", "1", "-o", output]);
        assert_eq!(done.code(), 0, "{}", done.error());
    };
    synth("vinyl.htex", "vinyl.wav");
    synth(uri, "s3://surfaces/vinyl.wav");
    assert_eq!(
        server.get("surfaces/vinyl.wav").unwrap(),
        std::fs::read(place.path("vinyl.wav")).unwrap()
    );
}

/// Of a library elsewhere, only its parts are read: here the start of the file and the texture.
#[test]
fn a_texture_of_a_library_elsewhere_is_read_alone() {
    let bench = Bench::new();
    let (place, server) = (&bench.place, &bench.server);
    place.write("cloth.htex", asset());
    let pack = ["lib", "pack", "all.htexlib", "cloth.htex", "--unlicensed"];
    assert_eq!(place.run(&pack).code(), 0);
    server.put("surfaces/all.htexlib", std::fs::read(place.path("all.htexlib")).unwrap());
    let uri = "s3://surfaces/all.htexlib#cloth";
    let there = bench.run(&["spectrum", uri, "--json"]);
    assert_eq!(there.code(), 0, "{}", there.error());
    assert_eq!(there.text(), bench.run(&["spectrum", "cloth.htex", "--json"]).text());
    let ranges = server.requests().into_iter().filter(|r| r.path.contains("all.htexlib"));
    assert!(ranges.count() <= 3);
    let pattern = bench.run(&["validate", "s3://surfaces/all.htexlib#*"]);
    assert!(pattern.text().starts_with(&format!("{uri}: valid\n")), "{}", pattern.text());
    bench
        .run(&["info", "s3://surfaces/all.htexlib#clothe"])
        .failed(1, &["similar names are cloth"]);
}

/// The folder of an export goes elsewhere, with each file at its place.
#[test]
fn several_textures_are_exported_to_a_folder_elsewhere() {
    let bench = Bench::new();
    let (place, server) = (&bench.place, &bench.server);
    let library = "../spec/library-conformance/valid_four.htexlib";
    let library = std::fs::read(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(library));
    place.write("all.htexlib", library.unwrap());
    let export = |to| ["export", "all.htexlib#wood/*", "--to", "ahap", "-o", to];
    for to in ["here", "s3://surfaces/there"] {
        let done = bench.run(&export(to));
        assert_eq!(done.code(), 0, "{}", done.error());
    }
    for name in ["wood/birch.ahap", "wood/oak.ahap", "wood/Ölweide.ahap"] {
        let here = std::fs::read(place.path("here").join(name)).unwrap();
        assert_eq!(server.get(&format!("surfaces/there/{name}")).unwrap(), here);
    }
}

/// A scene is here, and what is rendered of it goes elsewhere.
#[test]
fn a_scene_is_rendered_to_a_file_elsewhere() {
    let bench = Bench::new();
    scene(&bench, "cloth.htex");
    bench.place.write("cloth.htex", asset());
    let done = bench.run(&["render", "s.scene.json", "-o", "s3://surfaces/s.wav", "--json"]);
    assert_eq!(done.code(), 0, "{}", done.error());
    let said: serde_json::Value = serde_json::from_str(&done.text()).unwrap();
    assert_eq!(said["file"], "s3://surfaces/s.wav");
    assert_eq!(bench.run(&["render", "s.scene.json", "-o", "s.wav"]).code(), 0);
    assert_eq!(
        bench.server.get("surfaces/s.wav").unwrap(),
        std::fs::read(bench.place.path("s.wav")).unwrap()
    );
    bench.run(&["render", "s3://surfaces/s.scene.json"]).failed(1, &["no such file"]);
    bench
        .server
        .put("surfaces/s.scene.json", std::fs::read(bench.place.path("s.scene.json")).unwrap());
    bench
        .run(&["render", "s3://surfaces/s.scene.json"])
        .failed(2, &["s3://surfaces/s.scene.json: a scene names files beside it"]);
}

/// One sentence each, with the URI, and nothing is written.
#[test]
fn what_fails_is_said_and_leaves_nothing() {
    let bench = Bench::new();
    let before = bench.server.files();
    let fit =
        ["fit", "s3://surfaces/vinyl.csv", "--model", "bands", "-o", "s3://surfaces/new.htex"];
    let with = |name: &str, value: &str| {
        let mut command = bench.command(&fit);
        command.env(name, value);
        bench.finish(command)
    };
    let uri = "s3://surfaces/vinyl.csv: ";
    with("AWS_SECRET_ACCESS_KEY", "another-S3CR3T")
        .failed(1, &[uri, "check AWS_SECRET_ACCESS_KEY"]);
    with("HTEX_STORAGE_TIMEOUT_S", "soon").failed(1, &["HTEX_STORAGE_TIMEOUT_S"]);
    bench
        .run(&["info", "s3://surfaces/none.htex"])
        .failed(1, &["s3://surfaces/none.htex: there is no such file"]);
    bench.run(&["info", "s3://surfaces/vinyl.csv"]).failed(1, &[uri]);
    bench.server.put("surfaces/large.htex", vec![0; 17 << 20]);
    bench.run(&["info", "s3://surfaces/large.htex"]).failed(1, &["more than"]);
    std::fs::remove_file(bench.server.path("surfaces/large.htex")).unwrap();
    bench
        .server
        .fail(|_, request| if request.method == "GET" { Fault::Stall(1_000) } else { Fault::None });
    with("HTEX_STORAGE_TIMEOUT_S", "0.5").failed(1, &[uri, "not done within 0.5 s"]);
    assert_eq!(bench.server.files(), before);
    assert!(bench.copies().is_empty());
}

/// Of a command that took long, the result is kept.
#[test]
fn a_result_that_cannot_be_written_is_kept() {
    let bench = Bench::new();
    bench.server.fail(|_, request| {
        if request.method == "PUT" { Fault::Status(403, "AccessDenied") } else { Fault::None }
    });
    let fit = words("fit s3://surfaces/vinyl.csv --model bands -o s3://surfaces/new.htex");
    let done = bench.finish(bench.command(&fit));
    done.failed(
        1,
        &["s3://surfaces/new.htex: the server refuses access", "the result is kept in "],
    );
    assert!(bench.server.get("surfaces/new.htex").is_none());
    let error = done.error();
    let kept = error.trim().rsplit("kept in ").next().unwrap();
    assert!(kept.starts_with(bench.place.path("tmp").to_str().unwrap()), "{error}");
    assert_eq!(bench.run(&["info", kept]).code(), 0);
}

#[test]
fn wrong_usage_is_refused_before_any_request() {
    let bench = Bench::new();
    bench.server.fail(|_, _| Fault::None);
    let (csv, htex) = ("s3://surfaces/vinyl.csv", "s3://surfaces/cloth.htex");
    // Without an extension, since the extension of another format would be refused first.
    let file = "s3://surfaces/cloth";
    for (arguments, code, words) in [
        (&["fit", file, "-o", file][..], 2, "it is read here, and would be lost"),
        (&["fit", csv, "-o", file, "--report", file], 2, "two outputs would be written to it"),
        (&["fit", csv, "-o", "https://example.org/a.htex"], 2, "only read"),
        (&["info", "ftp://example.org/a.htex"], 2, "its scheme is none of"),
        (
            &["info", "https://a:S3CR3T@example.org/a.htex"],
            2,
            "credentials are read from the environment",
        ),
        (&["info", "s3://surfaces/"], 2, "no file name"),
    ] {
        bench.run(arguments).failed(code, &[words]);
        assert!(bench.server.requests().is_empty(), "{arguments:?}");
    }
    bench.run(&["edit", htex, "--author", "A"]).failed(2, &[htex, "name another file"]);
    assert_eq!(
        bench.run(&["edit", htex, "--author", "A", "-o", "s3://surfaces/edited.htex"]).code(),
        0
    );
    assert!(bench.server.get("surfaces/edited.htex").is_some());
    assert_eq!(bench.server.get("surfaces/cloth.htex").unwrap(), asset());
}

/// Only an argument is a URI: what a scene or an asset names is a file beside it.
#[test]
fn a_scene_and_an_asset_name_no_uri() {
    let bench = Bench::new();
    bench.server.put("web/cloth.htex", asset());
    bench.server.fail(|_, _| Fault::None);
    let web = format!("{}/web/cloth.htex", bench.server.url());
    for asset in
        [&web, "s3://surfaces/cloth.htex", "http://169.254.169.254/a.htex", "file:///etc/passwd"]
    {
        scene(&bench, asset);
        for arguments in [
            &["render", "s.scene.json", "-o", "s.wav"][..],
            &["plan", "s.scene.json"],
            &["validate", "s.scene.json"],
        ] {
            let done = bench.run(arguments);
            assert_eq!(done.code(), 1, "{arguments:?} {asset}: {}", done.error());
        }
    }
    assert!(bench.server.requests().is_empty());
    let line =
        format!("edit s3://surfaces/cloth.htex --source {web} --description {web} -o cloth.htex");
    let arguments = words(&line);
    assert_eq!(bench.run(&arguments).code(), 0);
    bench.server.fail(|_, _| Fault::None);
    assert_eq!(bench.run(&["synth", "cloth.htex", "--seconds", "1", "-o", "cloth.wav"]).code(), 0);
    assert!(bench.run(&["info", "cloth.htex"]).text().contains(&web));
    assert!(bench.server.requests().is_empty());
}

/// The query of a link is in no output, the report's command line included.
#[test]
fn a_signed_link_is_shown_without_its_query() {
    let bench = Bench::new();
    let link = format!("{}/web/vinyl.csv?sig=S3CR3T", bench.server.url());
    let frf = format!("--frf={}/web/rig.csv?sig=S3CR3T", bench.server.url());
    bench.server.put("web/rig.csv", "frequency_hz,magnitude\n20,1\n1000,1\n");
    let arguments =
        ["fit", &link, &frf, "--model", "bands", "-o", "vinyl.htex", "--report", "vinyl.html"];
    assert_eq!(bench.run(&arguments).code(), 0);
    for file in ["vinyl.html", "vinyl.htex"] {
        let bytes = std::fs::read(bench.place.path(file)).unwrap();
        assert!(!String::from_utf8_lossy(&bytes).contains("S3CR3T"), "{file}");
    }
    let manifest = bench.run(&["info", "vinyl.htex", "--json"]).text();
    assert!(!manifest.contains("S3CR3T"));
    let page = std::fs::read_to_string(bench.place.path("vinyl.html")).unwrap();
    assert!(page.contains("/web/vinyl.csv?…"));
}

#[cfg(unix)]
#[test]
fn an_ended_program_leaves_no_copy() {
    let bench = Bench::new();
    bench.server.fail(|_, _| Fault::Stall(300_000));
    let mut child = bench.command(&["process", "s3://surfaces/vinyl.csv"]).spawn().unwrap();
    until("something is asked for", || !bench.server.requests().is_empty());
    assert!(!bench.copies().is_empty());
    signal(&child, "-TERM");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(bench.copies().is_empty());
}

fn scene(bench: &Bench, asset: &str) {
    bench.place.scene("s.scene.json", asset, &json!({ "duration_s": 0.2 }));
}
