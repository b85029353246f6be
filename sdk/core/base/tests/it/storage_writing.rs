//! Files are written completely or not at all.

use crate::storage_common as common;

use std::path::PathBuf;
use std::time::Duration;

use common::{MOST, at, bytes, said, settings, storage};
use htex_base::storage::Storage;
use htex_object_server::{Fault, Seen, Server};
use tempfile::TempDir;

const NAME: &str = "surfaces/cloth.htex";
const URI: &str = "s3://surfaces/cloth.htex";
/// Size of a file that is sent in three parts, bytes.
const LARGE: usize = 20 << 20;

fn local(folder: &TempDir, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join("local");
    std::fs::write(&path, bytes).unwrap();
    path
}

fn is_part(request: &Seen, number: usize) -> bool {
    request.method == "PUT" && request.path.contains(&format!("partNumber={number}"))
}

#[test]
fn a_small_file_is_one_request() {
    let (server, folder) = (Server::start(), TempDir::new().unwrap());
    let small = bytes(100_000);
    storage(&server).write(&at(URI), &small).unwrap();
    assert_eq!(server.get(NAME).unwrap(), small);
    assert_eq!(server.requests().len(), 1);
    let file = local(&folder, b"other");
    storage(&server).write_file(&at(URI), &file).unwrap();
    assert_eq!(server.get(NAME).unwrap(), b"other");
    assert_eq!(server.requests().len(), 2);
    assert!(
        said(storage(&server).write_file(&at(URI), &folder.path().join("none"))).contains("none")
    );
}

#[test]
fn a_large_file_is_one_of_parts() {
    let (server, folder) = (Server::start(), TempDir::new().unwrap());
    let large = bytes(LARGE);
    let file = local(&folder, &large);
    // The second part fails once.
    let failed = std::sync::atomic::AtomicBool::new(false);
    server.fail(move |_, request| {
        if is_part(request, 2) && !failed.swap(true, std::sync::atomic::Ordering::Relaxed) {
            Fault::CutRequest(1_000_000)
        } else {
            Fault::None
        }
    });
    storage(&server).write_file(&at(URI), &file).unwrap();
    assert_eq!(storage(&server).read(&at(URI), MOST).unwrap(), large);
    let methods: Vec<String> = server.requests().into_iter().map(|r| r.method).collect();
    assert_eq!(methods, ["POST", "PUT", "PUT", "PUT", "PUT", "POST", "GET"]);
}

/// The old file stays unchanged. If there was none, there is none afterwards.
#[test]
fn a_write_that_fails_leaves_nothing() {
    let (server, folder) = (Server::start(), TempDir::new().unwrap());
    let (small, large) = (bytes(1_000_000), bytes(LARGE));
    type Rule = fn(&Seen) -> Fault;
    let cases: [(&str, &[u8], Rule); 7] = [
        ("refused", &small, |_| Fault::Status(403, "AccessDenied")),
        ("failing", &small, |_| Fault::Status(500, "InternalError")),
        ("cut", &small, |_| Fault::CutRequest(300_000)),
        ("no beginning", &large, |_| Fault::Status(503, "SlowDown")),
        ("part 2 failing", &large, |r| {
            if is_part(r, 2) { Fault::Status(500, "InternalError") } else { Fault::None }
        }),
        ("part 3 cut", &large, |r| {
            if is_part(r, 3) { Fault::CutRequest(100_000) } else { Fault::None }
        }),
        ("no end", &large, |r| {
            if r.method == "POST" && r.path.contains("uploadId") {
                Fault::Status(500, "InternalError")
            } else {
                Fault::None
            }
        }),
    ];
    for old in [None, Some(b"the old file")] {
        if let Some(old) = old {
            server.put(NAME, old);
        }
        let before = server.files();
        for (name, bytes, rule) in cases {
            server.fail(move |_, request| rule(request));
            let file = local(&folder, bytes);
            let text = said(storage(&server).write_file(&at(URI), &file));
            assert!(text.starts_with(URI), "{name}: {text}");
            assert_eq!(server.get(NAME).as_deref(), old.map(|old| &old[..]), "{name}");
            assert_eq!(server.files(), before, "{name}");
        }
    }
}

/// The parts are also removed after the time is over.
#[test]
fn a_write_that_takes_too_long_leaves_nothing() {
    let (server, folder) = (Server::start(), TempDir::new().unwrap());
    let file = local(&folder, &bytes(LARGE));
    let mut settings = settings();
    settings.total = Duration::from_secs(3);
    let storage = Storage::new(settings, server.variables().into_iter().collect());
    server.fail(|_, request| {
        if is_part(request, 2) { Fault::Delay(Duration::from_secs(600)) } else { Fault::None }
    });
    assert!(said(storage.write_file(&at(URI), &file)).contains("not done within 3 s"));
    assert!(server.files().is_empty(), "{:?}", server.files());
    assert_eq!(server.requests().last().unwrap().method, "DELETE");
}

/// A browser uses the media type to open a file, and compares its stored copy before it uses it.
#[test]
fn a_file_has_its_media_type_in_a_store() {
    let server = Server::start();
    let storage = storage(&server);
    for (name, media_type) in [
        ("index.html", "text/html; charset=utf-8"),
        ("textures/a.htex", "application/vnd.htex+zip"),
        ("cloth.htexlib", "application/vnd.htexlib"),
        ("sounds/a.wav", "audio/wav"),
        ("build-report.json", "application/json"),
        ("a", "application/octet-stream"),
    ] {
        storage.write(&at(&format!("s3://shop/{name}")), b"x").unwrap();
        let seen = server.requests().pop().unwrap();
        assert_eq!(seen.content_type.as_deref(), Some(media_type), "{name}");
        assert_eq!(seen.cache_control.as_deref(), Some("no-cache"), "{name}");
    }
    let large = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(large.path(), bytes(5 << 20)).unwrap();
    storage.write_file(&at("s3://shop/large.html"), large.path()).unwrap();
    let typed = |seen: &htex_object_server::Seen| {
        seen.content_type.as_deref() == Some("text/html; charset=utf-8")
    };
    assert!(server.requests().iter().filter(|seen| seen.path.contains("large")).any(typed));
}
