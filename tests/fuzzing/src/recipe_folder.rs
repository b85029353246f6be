//! Recipes with a table, in a folder with traps. The files they name are found, checked and hashed
//! as in a build, but nothing is fitted. Errors go into the report of the folder, where links lead
//! outside.

use std::net::TcpListener;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use htex_base::finding::plain;
use htex_build::{Build, BuildError, BuildOptions, check, report_failure};
use tempfile::TempDir;

use crate::promise::sentence;

/// Number of requests to the local server.
static REQUESTS: AtomicUsize = AtomicUsize::new(0);
const PRECIOUS: &[u8] = b"precious";

/// A recipe, a zero byte, and a table. In both, `PORT` stands for the port of a local server.
pub fn recipe_folder(input: &[u8]) -> bool {
    let (folder, port) = traps();
    let (recipe, table) = match input.iter().position(|byte| *byte == 0) {
        Some(at) => (&input[..at], &input[at + 1..]),
        None => (input, &[][..]),
    };
    let work = folder.path().join("work");
    for (name, bytes) in [("library.toml", recipe), ("table.csv", table)] {
        let text = String::from_utf8_lossy(bytes).replace("PORT", port);
        std::fs::write(work.join(name), text).unwrap();
    }
    let file = work.join("library.toml");
    let checked = taken(check(&file, &BuildOptions::new("fuzz 1")));
    let dist = work.join("dist");
    let opened = taken(Build::open(&file, &dist, BuildOptions::new("fuzz 1")));
    let lines: Vec<String> = String::from_utf8_lossy(recipe).lines().map(str::to_owned).collect();
    let _ = report_failure(&dist, "fuzz 1", &lines);
    assert_eq!(REQUESTS.load(Ordering::SeqCst), 0, "a recipe made a request");
    let outside = folder.path().join("outside");
    assert_eq!(std::fs::read(outside.join("victim")).unwrap(), PRECIOUS);
    assert_eq!(std::fs::read_dir(outside).unwrap().count(), 1);
    checked || opened
}

fn taken<T>(result: Result<T, BuildError>) -> bool {
    if let Err(error) = &result {
        // A TOML reader shows the wrong line, which may be long.
        let text: String = plain(&error.to_string()).chars().take(2000).collect();
        sentence(&text);
    }
    result.is_ok()
}

/// Returns the folder, which is made once, and the port.
fn traps() -> &'static (TempDir, String) {
    static TRAPS: OnceLock<(TempDir, String)> = OnceLock::new();
    TRAPS.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["work/rec", "work/traps", "work/dist/.htex-build", "outside"] {
            std::fs::create_dir_all(at(name)).unwrap();
        }
        std::fs::write(at("outside/victim"), PRECIOUS).unwrap();
        std::fs::write(at("work/rec/a.csv"), "t_s,fx_n\n0,0.1\n0.001,0.2\n").unwrap();
        links(&at("work"));
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port().to_string();
        std::thread::spawn(move || {
            for stream in listener.incoming() {
                REQUESTS.fetch_add(1, Ordering::SeqCst);
                drop(stream);
            }
        });
        (folder, port)
    })
}

#[cfg(unix)]
fn links(work: &Path) {
    for (name, to) in [
        ("traps/zero.csv", "/dev/zero"),
        ("traps/nowhere.csv", "/nowhere"),
        ("traps/loop", "."),
        ("traps/victim", "../../outside/victim"),
        ("dist/.htex-build/files.json", "../../../outside/victim"),
        ("dist/.htex-build/made", "../../../outside"),
        ("dist/textures", "../../outside"),
        ("dist/build-report.json", "../../outside/victim"),
    ] {
        std::os::unix::fs::symlink(to, work.join(name)).unwrap();
    }
    let pipe = std::process::Command::new("mkfifo").arg(work.join("traps/pipe.csv")).status();
    assert!(pipe.unwrap().success());
}

#[cfg(not(unix))]
fn links(_: &Path) {}
