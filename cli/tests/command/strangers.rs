//! Recipes, tables and folders of results that come from somebody else.

use std::fs;
use std::io::Write;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{Place, Run, words};
use htex_object_server::{Fault, Server};
use serde_json::Value;

const RECIPE: &str = r#"
[library]
name = "surfaces"
[[textures]]
recordings = "rec/*.csv"
models = ["bands"]
at = { speed_mm_s = 80, force_n = 0.4 }
"#;
/// Longest time of a refusal; the machine may be busy.
const SOON: Duration = Duration::from_secs(20);

/// A folder with a recipe and a recording.
fn place() -> Place {
    let place = Place::new();
    fs::create_dir(place.path("rec")).unwrap();
    place.simulated("rec/a.csv", &["--surface", "vinyl", "--seconds", "2"]);
    place.write("library.toml", RECIPE);
    place
}

fn build(place: &Place, more: &[&str]) -> Run {
    place.run(&[&["build", "library.toml", "-o", "dist"], more].concat())
}

/// Runs and ends in time, whatever a file leads to; with at most 2 GiB of addresses.
fn bounded(place: &Place, arguments: &[&str]) -> Run {
    let start = Instant::now();
    let program = place.command(arguments);
    let mut limited = Command::new("sh");
    limited
        .arg("-c")
        .arg("ulimit -v 2097152; exec timeout -k 1 60 \"$0\" \"$@\"")
        .arg(program.get_program())
        .args(program.get_args())
        .current_dir(program.get_current_dir().unwrap());
    let run = Run::of(limited.output().unwrap());
    assert!(start.elapsed() < SOON, "{arguments:?}: {:?}", start.elapsed());
    run
}

fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

/// A native library that writes a file when it is loaded.
fn native(place: &Place) -> bool {
    let path = place.path("loaded").display().to_string();
    let source = format!(
        "#include <stdio.h>\n__attribute__((constructor)) static void run(void) {{ FILE *f = fopen(\"{path}\", \"w\"); if (f) fclose(f); }}\n"
    );
    place.write("m.c", source);
    let compiled = Command::new("cc")
        .args(["-shared", "-fPIC", "-o", "m.so", "m.c"])
        .current_dir(place.path(""))
        .status();
    let is_compiled = compiled.is_ok_and(|status| status.success());
    assert!(
        is_compiled || std::env::var_os("CI").is_none(),
        "continuous integration has a C compiler"
    );
    is_compiled
}

/// No recipe, local or remote, can name code that runs outside the sandbox, whatever the key or the
/// name. Only the user can.
#[test]
fn a_recipe_runs_no_native_code() {
    let place = place();
    if !native(&place) {
        eprintln!("skipped: there is no C compiler");
        return;
    }
    fs::copy(place.path("m.so"), place.path("m.wasm")).unwrap();
    let library = fs::read(place.path("m.so")).unwrap();
    assert!(!library.is_empty());
    for file in ["m.so", "m.wasm"] {
        let in_library =
            RECIPE.replace("\"surfaces\"", &format!("\"surfaces\"\nplugins = [\"{file}\"]"));
        let embedded =
            RECIPE.replace("models =", &format!("embed_plugins = [\"{file}\"]\nmodels ="));
        for recipe in [in_library, embedded] {
            place.write("library.toml", &recipe);
            for more in [&[][..], &["--keep-going"], &["--dry-run"]] {
                let run = build(&place, more);
                assert_eq!(run.code(), 1, "{recipe}");
                assert!(!place.path("loaded").exists(), "{recipe}");
                let said = run.error() + &run.text();
                assert!(said.contains("no WASM module") && said.contains("--plugin"), "{said}");
            }
            let run = place.run(&["validate", "library.toml"]);
            assert!(run.code() == 1 && run.text().contains("RECIPE_INVALID"), "{}", run.text());
            assert!(!place.path("loaded").exists());
        }
    }
    // The same for a recipe from a server, and a library named relative to it.
    let bytes = RECIPE.replace("\"surfaces\"", "\"surfaces\"\nplugins = [\"m.so\"]");
    let server = Server::start();
    server.put("web/library.toml", bytes);
    server.put("web/m.so", "\u{7f}ELF");
    let run = place.run(&["build", &format!("{}/web/library.toml", server.url()), "-o", "dist"]);
    assert!(run.code() == 1 && !place.path("loaded").exists(), "{}", run.error());
    // If the user names the library, it is loaded. It is no model, and the error says so.
    place.write("library.toml", RECIPE);
    let run = build(&place, &["--plugin", "m.so"]);
    assert!(run.code() == 1 && place.path("loaded").exists(), "{}", run.error());
    let run = build(&place, &["--plugin", "https://example.org/m.so"]);
    assert!(
        run.code() == 2 && run.error().contains("takes a path of this machine, not a URI"),
        "{}",
        run.error()
    );
}

/// A folder of results with links: each of them is refused or replaced, and what it leads to stays.
#[test]
fn a_build_follows_no_link_in_the_folder_of_its_results() {
    let place = place();
    let outside = place.path("outside");
    let links = [
        ("lock", "victim.part"),
        ("made", ""),
        ("parts", ""),
        ("elsewhere", ""),
        ("files.json", "victim.part"),
        ("library.json", "victim.part"),
    ];
    let in_dist = [
        ("textures", ""),
        ("sounds", ""),
        (".htex-build", ""),
        ("index.html", "victim.part"),
        ("index.html.part", "victim.part"),
        ("build-report.json", "victim.part"),
        ("surfaces.htexlib", "victim.part"),
        ("textures/a.htex", "victim.part"),
        ("textures/a.htex.part", "victim.part"),
        ("sounds/a.wav", "victim.part"),
    ];
    let inside = links.map(|(name, to)| (format!(".htex-build/{name}"), to));
    let all = inside.into_iter().chain(in_dist.map(|(name, to)| (name.to_owned(), to)));
    let key = "0".repeat(64);
    for (name, to) in all {
        let _ = fs::remove_dir_all(place.path("dist"));
        let _ = fs::remove_dir_all(&outside);
        fs::create_dir(&outside).unwrap();
        for file in ["victim.part", &key, "a.htex", "a.htex.part"] {
            fs::write(outside.join(file), "precious").unwrap();
        }
        let link = place.path("dist").join(&name);
        fs::create_dir_all(link.parent().unwrap()).unwrap();
        symlink(outside.join(to), &link).unwrap();
        for more in ["--dry-run", "--prune"] {
            let run = build(&place, &[more]);
            assert!(
                run.code() == 0 || run.error().contains("symbolic link"),
                "{name}: {}",
                run.error()
            );
            assert_eq!(crate::common::entries(&outside).len(), 4, "{name}");
            for file in ["victim.part", &key, "a.htex", "a.htex.part"] {
                assert_eq!(fs::read(outside.join(file)).unwrap(), b"precious", "{name}");
            }
        }
    }
    // The folder that the user names may be a link.
    fs::remove_dir_all(place.path("dist")).unwrap();
    fs::create_dir(place.path("disk")).unwrap();
    symlink(place.path("disk"), place.path("dist")).unwrap();
    assert_eq!(build(&place, &[]).code(), 0);
    assert!(place.path("disk/surfaces.htexlib").exists());
}

/// What another user kept is not taken as a fit, nor as a known file or library.
#[test]
fn what_another_user_kept_is_made_again() {
    let place = place();
    let as_user = |name: &str, output: &str| -> Value {
        let mut command = place.command(&["build", "library.toml", "-o", output, "--json"]);
        command.env("HTEX_CONFIG_DIR", place.path(name));
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    assert_eq!(as_user("eve", "dist")["fitted"], 1);
    assert_eq!(as_user("eve", "dist")["fitted"], 0);
    let honest = fs::read(place.path("dist/textures/a.htex")).unwrap();
    assert_eq!(as_user("adam", "dist")["fitted"], 1);
    assert_eq!(as_user("adam", "dist")["fitted"], 0);
    assert_eq!(fs::read(place.path("dist/textures/a.htex")).unwrap(), honest);
    // Nor is one under another name of the same user.
    place.write("library.toml", RECIPE.to_owned() + "level = \"fitted\"\n");
    let made = place.path("dist/.htex-build/made");
    let before = crate::common::entries(&made);
    assert_eq!(as_user("adam", "dist")["fitted"], 1);
    let now = crate::common::entries(&made);
    let new = now.iter().find(|name| !before.contains(name)).unwrap();
    fs::copy(made.join(&before[0]), made.join(new)).unwrap();
    assert_eq!(as_user("adam", "dist")["fitted"], 1);
}

/// Files that are no entries of the cache stay, whatever their names end in.
#[test]
fn only_own_entries_are_removed() {
    let place = place();
    assert_eq!(build(&place, &[]).code(), 0);
    for file in [
        ".htex-build/made/notes.txt",
        ".htex-build/made/x.part",
        "textures/mine.part",
        "sounds/mine.part",
    ] {
        fs::write(place.path("dist").join(file), "mine").unwrap();
    }
    place.write("library.toml", RECIPE.replace("bands", "sbeta"));
    assert_eq!(build(&place, &["--prune"]).code(), 0);
    for file in [
        ".htex-build/made/notes.txt",
        ".htex-build/made/x.part",
        "textures/mine.part",
        "sounds/mine.part",
    ] {
        assert!(place.path("dist").join(file).exists(), "{file}");
    }
    assert_eq!(crate::common::entries(&place.path("dist/.htex-build/made")).len(), 3);
}

/// A recipe requests nothing from this machine or its network. It may request files from its own
/// server, which the user named.
#[cfg(feature = "cloud")]
#[test]
fn a_recipe_names_no_inner_address() {
    let place = place();
    let server = Server::start();
    let url = server.url();
    let port = url.rsplit(':').next().unwrap();
    let hosts = [
        "localhost",
        "[::1]",
        "[::ffff:127.0.0.1]",
        "0.0.0.0",
        "2130706433",
        "[64:ff9b::7f00:1]",
        "100.64.0.1",
    ];
    let keys = ["recordings", "table", "tracker", "response", "plugins", "embed_plugins"];
    let addresses = hosts.map(|host| ("recordings", host));
    for (key, host) in keys.map(|key| (key, "127.0.0.1")).into_iter().chain(addresses) {
        let uri = format!("http://{host}:{port}/a.csv");
        let recipe = match key {
            "recordings" => RECIPE.replace("rec/*.csv", &uri),
            "table" => RECIPE.replace("recordings = \"rec/*.csv\"", &format!("table = \"{uri}\"")),
            "plugins" => {
                RECIPE.replace("\"surfaces\"", &format!("\"surfaces\"\nplugins = [\"{uri}\"]"))
            }
            "embed_plugins" => format!("{RECIPE}{key} = [\"{uri}\"]\n"),
            key => format!("{RECIPE}{key} = \"{uri}\"\n"),
        };
        place.write("library.toml", recipe);
        let run = build(&place, &[]);
        assert_eq!(run.code(), 1, "{key} {uri}");
        assert!(run.error().contains("machine or network"), "{key} {uri}: {}", run.error());
    }
    assert!(server.requests().is_empty());
    server.put("web/library.toml", RECIPE.replace("rec/*.csv", "rec/a.csv"));
    server.put("web/rec/a.csv", fs::read(place.path("rec/a.csv")).unwrap());
    let run = place.run(&["build", &format!("{url}/web/library.toml"), "-o", "dist"]);
    assert_eq!(run.code(), 0, "{}", run.error());
}

/// A redirect to a name that resolves to this machine is not followed, and no request says where it
/// comes from.
#[cfg(feature = "cloud")]
#[test]
fn a_redirect_by_name_leads_nowhere_inside() {
    let place = place();
    let (inner, server) = (Server::start(), Server::start());
    let to = format!("{}/web/a.csv", inner.url().replace("127.0.0.1", "localhost"));
    server.fail(move |_, _| Fault::Redirect(to.clone()));
    let run = place.run(&["process", &format!("{}/web/a.csv?sig=S3CR3T", server.url())]);
    assert_eq!(run.code(), 1);
    assert!(run.error().contains("machine or network"), "{}", run.error());
    assert!(inner.requests().is_empty());
    assert!(server.requests().iter().all(|seen| seen.referer.is_none()));
}

/// Whatever a recipe or a table names, a build ends soon and takes little memory.
#[test]
fn what_a_file_names_is_regular_and_bounded() {
    let place = place();
    pipe(&place.path("pipe"));
    pipe(&place.path("rec/pipe.csv"));
    place.write("pipes.csv", "recording\npipe\n");
    let named = |what: &str| RECIPE.replace("recordings = \"rec/*.csv\"", what);
    let deep = "{".repeat(50_000);
    let recipes = [
        named("table = \"/dev/zero\""),
        named("table = \"pipe\""),
        named("table = \"pipes.csv\""),
        named("recordings = \"/dev/zero\""),
        named("recordings = \"pipe\""),
        named(&format!("recordings = \"{deep}\"")),
        format!("{RECIPE}[[overrides]]\ntextures = \"{deep}\"\n"),
        format!("{RECIPE}tracker = \"/dev/zero\"\n"),
        format!("{RECIPE}tracker = \"pipe\"\n"),
        format!("{RECIPE}response = \"pipe\"\n"),
        format!("{RECIPE}embed_plugins = [\"/dev/zero\"]\n"),
        format!("{RECIPE}embed_plugins = [\"pipe\"]\n"),
        format!("a = {}", "[".repeat(100_000)),
        "x".repeat(2 << 20),
    ];
    for recipe in recipes {
        place.write("library.toml", &recipe);
        let run = bounded(&place, &["build", "library.toml", "-o", "dist"]);
        let shown: String = recipe.chars().take(300).collect();
        assert_eq!(run.code(), 1, "{shown}: {}", run.error());
        assert!(!run.error().is_empty() && !run.error().contains("panicked"), "{}", run.error());
    }
    // A pipe among recordings is none of them.
    place.write("library.toml", RECIPE);
    assert_eq!(bounded(&place, &["build", "library.toml", "-o", "dist"]).code(), 0);
    // Nor does one beside a recording say how it is read, or one in the folder of results what was
    // made.
    pipe(&place.path("rec/a.json"));
    let run = bounded(&place, &["process", "rec/a.csv"]);
    assert_eq!(run.code(), 0, "{}", run.error());
    for kept in fs::read_dir(place.path("dist/.htex-build")).unwrap() {
        let kept = kept.unwrap().path();
        if kept.is_file() {
            fs::remove_file(&kept).unwrap();
            pipe(&kept);
        }
    }
    let run = bounded(&place, &["build", "library.toml", "-o", "dist"]);
    assert!(run.error().contains("lock"), "{}", run.error());
}

/// Twenty thousand rows of one texture: the time grows with them and not with their square.
#[test]
fn many_recordings_of_one_texture_are_planned_soon() {
    let place = place();
    fs::create_dir(place.path("many")).unwrap();
    let mut table = "recording,name,speed_mm_s,force_n\n".to_owned();
    for i in 0..20_000 {
        fs::hard_link(place.path("rec/a.csv"), place.path(&format!("many/{i}.csv"))).unwrap();
        table += &format!("many/{i}.csv,one,80,0.4\n");
    }
    // The last row is wrong, so that nothing is read.
    table += "many/0.csv,one,80,0.4\n";
    place.write("table.csv", table);
    place.write(
        "library.toml",
        RECIPE.replace("recordings = \"rec/*.csv\"", "table = \"table.csv\""),
    );
    let run = bounded(&place, &["build", "library.toml", "-o", "dist"]);
    assert!(run.code() == 1 && run.error().contains("twice"), "{}", run.error());
}

/// A million rows are refused; fifty thousand with long names are planned in less than 512 MiB.
#[cfg(target_os = "linux")]
#[test]
fn many_textures_take_little_memory() {
    let place = place();
    let recipe = RECIPE.replace("recordings = \"rec/*.csv\"", "table = \"table.csv\"");
    place.write("library.toml", recipe);
    let long = "long-".repeat(40);
    for (rows, code, name) in [(50_000, 0, &long[..]), (1_000_000, 1, "t")] {
        let mut table = "recording,name\n".to_owned();
        (0..rows).for_each(|i| table += &format!("rec/a.csv,{name}{i}\n"));
        place.write("table.csv", table);
        let mut command = place.command(&["build", "library.toml", "-o", "dist", "--dry-run"]);
        let end = crate::common::measured::run(&mut command, &place.path("errors"));
        assert_eq!(end.code, code, "{}", end.error);
        println!("{rows} rows: {} KiB", end.memory_kib);
        assert!(end.memory_kib < 512 << 10, "{rows} rows: {} KiB", end.memory_kib);
    }
}

/// A tracker's line without an end is an error.
#[test]
fn a_line_without_an_end_is_an_error() {
    let place = place();
    place.write("signal.csv", fs::read(place.path("rec/a.csv")).unwrap());
    let record = words("record --source file:signal.csv --tracker lines:- --seconds 1 -o takes");
    let mut child = place
        .command(&record)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    let start = Instant::now();
    let block = vec![b'1'; 1 << 20];
    let mut sent = 0;
    while start.elapsed() < SOON
        && child.try_wait().unwrap().is_none()
        && input.write_all(&block).is_ok()
    {
        sent += block.len();
        // The program reads what a pipe holds and then no more.
        assert!(sent < 64 << 20, "it took {sent} bytes");
    }
    drop(input);
    let _ = child.kill();
    child.wait().unwrap();
}

/// A variable with a line break is an error that names it.
#[cfg(feature = "cloud")]
#[test]
fn a_line_break_in_a_variable_is_an_error() {
    let place = place();
    for (name, uri) in [
        ("AWS_REGION", "s3://bucket/a.csv"),
        ("AWS_ACCESS_KEY_ID", "s3://bucket/a.csv"),
        ("AWS_ENDPOINT_URL", "s3://bucket/a.csv"),
        ("AZURE_STORAGE_ACCOUNT_NAME", "az://bucket/a.csv"),
        ("GOOGLE_SERVICE_ACCOUNT", "gs://bucket/a.csv"),
    ] {
        let mut command = place.command(&["info", uri]);
        for other in ["AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"] {
            command.env(other, "x");
        }
        command.env(name, "a\r\nHost: b").env("HTEX_STORAGE_TIMEOUT_S", "5");
        let run = Run::of(command.output().unwrap());
        assert_eq!(run.code(), 1);
        let said = run.error();
        assert!(said.contains(name) && said.contains("control character"), "{said}");
    }
}

/// Only the user can read downloads, answers and recordings.
#[cfg(feature = "lab")]
#[test]
fn recordings_of_participants_are_the_users_alone() {
    let place = place();
    place.write("signal.csv", fs::read(place.path("rec/a.csv")).unwrap());
    let record =
        words("record --source file:signal.csv --fast --seconds 1 --min-on-target 0 -o takes");
    let run = place.run(&record);
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    let folder = place.path("takes");
    assert!(folder.is_dir(), "{}", run.error());
    assert_eq!(mode(&folder), 0o700);
    for name in crate::common::entries(&folder) {
        let path = folder.join(name);
        assert_eq!(mode(&path) & 0o077, 0, "{}", path.display());
    }
}

/// What quotes a file's name steers no terminal, in JSON either, and is the same text.
#[test]
fn json_steers_no_terminal() {
    let place = place();
    assert_eq!(build(&place, &[]).code(), 0);
    let name = "a\u{9b}31m\u{202e}\u{2066}\u{200f}\u{2028}b.htex";
    fs::copy(place.path("dist/textures/a.htex"), place.path(name)).unwrap();
    let run = place.run(&["info", name, "--json"]);
    assert_eq!(run.code(), 0, "{}", run.error());
    let steers =
        |c: char| c.is_control() && c != '\n' || "\u{202e}\u{2066}\u{200f}\u{2028}".contains(c);
    assert!(!run.text().contains(steers), "{:?}", run.text());
    let json: Value = serde_json::from_str(&run.text()).unwrap();
    assert_eq!(json["asset"], name);
}

/// Where one asset is meant, a library or a second asset is an error that says what to do.
#[test]
fn a_library_in_place_of_an_asset_says_what_to_do() {
    let place = place();
    assert_eq!(build(&place, &[]).code(), 0);
    let (asset, library) = ("dist/textures/a.htex", "dist/surfaces.htexlib");
    for (arguments, said) in [
        (&["info", library][..], "htex lib ls"),
        (&["edit", library, "--author", "A", "-o", "b.htex"], "surfaces.htexlib#NAME"),
        (&["compare", "rec/a.csv", library], "LIBRARY#NAME"),
        (&["compare", library, library], "htex lib diff"),
        (&["edit", asset, asset, "--author", "A"], "run the command for each"),
    ] {
        let run = place.run(arguments);
        assert!(run.code() == 2 && run.error().contains(said), "{arguments:?}: {}", run.error());
    }
}

/// A folder of results may have links in it, whoever filled it: no command writes through one,
/// neither to a file nor into a folder.
#[test]
#[cfg(feature = "lab")]
fn no_command_follows_a_link_in_the_folder_of_its_results() {
    let place = place();
    let vinyl = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes/vinyl.htex");
    place.write("vinyl.htex", fs::read(vinyl).unwrap());
    let study = "htex_study = '1.0'\nparticipants = ['Ann', 'Bob']\nmodels = ['ar']\nrepetitions = 1\ntrial_s = 0.05\nphases = ['testing']\n\
        motion = { constant = { speed_mm_s = 80, force_n = 0.4 } }\ndevice = { adapter = 'file' }\n[[textures]]\nasset = 'vinyl.htex'\n";
    place.write("study.toml", study);
    let record = "record --source file:rec/a.csv --fast --take x --seconds 1 -o DIR";
    let study = "study run study.toml --simulated 1 --fast -o DIR --participant";
    let demo = "rig.csv vinyl.csv vinyl.htex vinyl-ar.wav report.html spectra.svg";
    // A command, and what is a link in its folder: files, folders.
    let cases = [
        ("demo DIR".to_owned(), demo, ""),
        ("man DIR".to_owned(), "htex.1 htex-fit.1", ""),
        (record.to_owned(), "x-001.part x-001.json", "tracker"),
        (format!("{record} --target-force 5 --attempts 1"), "", "rejected incomplete"),
        (format!("{study} Ann"), "Ann.jsonl", ""),
        (format!("{study} Ann"), "Ann/trial-0001.wav", ""),
        (format!("{study} Bob"), "", "Bob"),
    ];
    let outside = place.path("outside");
    fs::create_dir(&outside).unwrap();
    fs::write(outside.join("victim"), "precious").unwrap();
    for (number, (command, files, folders)) in cases.iter().enumerate() {
        let folder = format!("results-{number}");
        let links = files.split_whitespace().map(|name| (name, "victim"));
        for (name, to) in links.chain(folders.split_whitespace().map(|name| (name, ""))) {
            let link = place.path(&folder).join(name);
            fs::create_dir_all(link.parent().unwrap()).unwrap();
            symlink(outside.join(to), link).unwrap();
        }
        let command = command.replace("DIR", &folder);
        let arguments: Vec<&str> = command.split_whitespace().collect();
        let run = place.run(&arguments);
        assert!(
            run.code() == 0
                || run.error().contains("symbolic link")
                || run.error().contains("target"),
            "{command}: {}",
            run.error()
        );
        assert_eq!(crate::common::entries(&outside), ["victim"], "{command}");
        assert_eq!(fs::read(outside.join("victim")).unwrap(), b"precious", "{command}");
    }
}
