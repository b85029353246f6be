//! Reads from an S3 store with temporary faults, permanent faults, and credentials that do not
//! work.

use crate::storage_common as common;

use std::time::{Duration, Instant};

use common::{MOST, at, bytes, said, settings, storage, storage_with};
use htex_base::storage::{Storage, StorageError, StorageProblem};
use htex_object_server::{Fault, Server};

const NAME: &str = "surfaces/cloth.csv";
const URI: &str = "s3://surfaces/cloth.csv";

/// A server with a file of 300,000 bytes.
fn server() -> (Server, Vec<u8>) {
    let (server, bytes) = (Server::start(), bytes(300_000));
    server.put(NAME, &bytes);
    (server, bytes)
}

#[test]
fn what_is_read_is_what_is_stored() {
    let (server, bytes) = server();
    let storage = storage(&server);
    assert_eq!(storage.read(&at(URI), MOST).unwrap(), bytes);
    assert_eq!(server.requests().len(), 1);
    assert!(server.requests()[0].is_signed);
    assert_eq!(storage.read_range(&at(URI), 1_000..1_010).unwrap(), bytes[1_000..1_010]);
    assert_eq!(server.requests()[1].range.as_deref(), Some("bytes=1000-1009"));
    assert_eq!(storage.size(&at(URI)).unwrap(), 300_000);
    let etag = storage.stat(&at(URI)).unwrap().unwrap().etag;
    assert!(etag.is_some());
    assert!(!storage.exists(&at("s3://surfaces/none.csv")).unwrap());
    assert!(said(storage.read(&at("s3://surfaces/none.csv"), MOST)).contains("no such file"));
    assert!(said(storage.read(&at("s3://none/cloth.csv"), MOST)).contains("no such file"));
    assert!(said(storage.read(&at(URI), 299_999)).contains("more than 299999 bytes"));
    assert!(said(storage.read_range(&at(URI), 299_999..300_001)).contains("it has 300000"));
    server.put(NAME, b"other");
    assert_ne!(storage.stat(&at(URI)).unwrap().unwrap().etag, etag);
}

#[test]
fn keys_are_taken_as_they_are_written() {
    let (server, _) = server();
    for key in ["a b/ä+c.csv", "50%25.csv", "#1?x=y&z.csv"] {
        let uri = at(&format!("s3://surfaces/{key}"));
        storage(&server).write(&uri, key.as_bytes()).unwrap();
        assert_eq!(server.get(&format!("surfaces/{key}")).unwrap(), key.as_bytes());
        assert_eq!(storage(&server).read(&uri, MOST).unwrap(), key.as_bytes());
    }
    for key in ["a//b", "a/../b", "a/"] {
        let uri = at(&format!("s3://surfaces/{key}"));
        assert!(said(storage(&server).read(&uri, MOST)).contains("the key"), "{key}");
    }
}

#[test]
fn a_list_is_by_name_and_by_pattern() {
    let server = Server::start();
    for key in ["set/b.csv", "set/a.csv", "set/a.htex", "set/deep/c.csv", "settee/d.csv"] {
        server.put(&format!("surfaces/{key}"), key);
    }
    let names = |folder: &str, pattern: &str| {
        let found = storage(&server).list(&at(folder), pattern).unwrap();
        let names = found.into_iter().map(|entry| {
            assert_eq!(
                storage(&server).read(&entry.location, MOST).unwrap().len() as u64,
                entry.bytes
            );
            entry.location.to_string().replace("s3://surfaces/", "")
        });
        names.collect::<Vec<_>>()
    };
    assert_eq!(names("s3://surfaces/set/", "*.csv"), ["set/a.csv", "set/b.csv"]);
    assert_eq!(
        names("s3://surfaces/set", "**/*.csv"),
        ["set/a.csv", "set/b.csv", "set/deep/c.csv"]
    );
    assert_eq!(names("s3://surfaces", "*/d.csv"), ["settee/d.csv"]);
    assert!(said(storage(&server).list(&at("s3://surfaces/set"), "[")).contains("the pattern ["));
}

/// Temporary faults, each with the number of requests that it takes.
#[test]
fn faults_that_pass_are_retried() {
    let (server, bytes) = server();
    let mut settings = settings();
    settings.stall = Duration::from_millis(700);
    let storage = Storage::new(settings, server.variables().into_iter().collect());
    type Rule = fn(usize) -> Fault;
    let cases: [(&str, usize, Rule); 7] =
        [
            ("503 thrice", 4, |n| if n < 3 { Fault::Status(503, "SlowDown") } else { Fault::None }),
            ("429 twice", 3, |n| {
                if n < 2 { Fault::Status(429, "TooManyRequests") } else { Fault::None }
            }),
            ("500 and then a cut", 3, |n| match n {
                0 => Fault::Status(500, "InternalError"),
                1 => Fault::Cut(70_000),
                _ => Fault::None,
            }),
            ("a late response", 1, |_| Fault::Delay(Duration::from_millis(100))),
            ("no response in time", 2, |n| match n {
                0 => Fault::Delay(Duration::from_secs(60)),
                _ => Fault::None,
            }),
            ("three cuts", 4, |n| if n < 3 { Fault::Cut(90_000) } else { Fault::None }),
            ("a stall", 2, |n| if n < 1 { Fault::Stall(100_000) } else { Fault::None }),
        ];
    for (name, requests, rule) in cases {
        server.fail(move |n, _| rule(n));
        assert_eq!(storage.read(&at(URI), MOST).unwrap(), bytes, "{name}");
        assert_eq!(server.requests().len(), requests, "{name}");
    }
    let resumed = server.requests()[1].range.clone().unwrap();
    let from: u64 =
        resumed.trim_start_matches("bytes=").split('-').next().unwrap().parse().unwrap();
    assert!((1..=100_000).contains(&from), "{resumed}");
}

#[test]
fn faults_that_stay_are_one_error() {
    let (server, _) = server();
    server.fail(|_, _| Fault::Status(503, "SlowDown"));
    let text = said(storage(&server).read(&at(URI), MOST));
    assert!(
        text.contains("s3://surfaces/cloth.csv: status 503, SlowDown, after 7 requests"),
        "{text}"
    );
    assert_eq!(server.requests().len(), 7);
    server.fail(|_, _| Fault::Cut(10));
    let text = said(storage(&server).read(&at(URI), MOST));
    assert!(text.contains("after 7 requests") && text.contains("try again later"), "{text}");
    server.fail(|_, _| Fault::Status(501, "NotImplemented"));
    assert!(said(storage(&server).stat(&at(URI))).contains("status 501"));
    let gone = storage(&server);
    drop(server);
    assert!(said(gone.read(&at(URI), MOST)).contains("refused"));
}

/// The limit applies to all requests together, whatever each of them does.
#[test]
fn the_total_time_is_bounded() {
    let (server, _) = server();
    let mut settings = settings();
    settings.total = Duration::from_millis(800);
    settings.stall = Duration::from_millis(300);
    let storage = Storage::new(settings, server.variables().into_iter().collect());
    for fault in [Fault::Stall(1_000), Fault::Delay(Duration::from_secs(60))] {
        server.fail(move |_, _| fault.clone());
        let begun = Instant::now();
        let error = storage.read(&at(URI), MOST);
        assert!(
            matches!(error, Err(StorageError { problem: StorageProblem::TooSlow { .. }, .. })),
            "{error:?}"
        );
        assert!(said(error).contains("HTEX_STORAGE_TIMEOUT_S"));
        assert!(begun.elapsed() < Duration::from_secs(20));
    }
}

/// These failures are not retried, and each message names the variable.
#[test]
fn credentials_that_do_not_work_are_said_so() {
    let (server, _) = server();
    let none = [("AWS_ACCESS_KEY_ID", ""), ("AWS_SECRET_ACCESS_KEY", "")];
    let cases = [
        (&[("AWS_SECRET_ACCESS_KEY", "another-S3CR3T")][..], "check AWS_SECRET_ACCESS_KEY"),
        (&[("AWS_ACCESS_KEY_ID", "AKID-S3CR3T")], "AWS_ACCESS_KEY_ID"),
        // Credentials are not looked for elsewhere, in particular not in the metadata service of a
        // cloud machine.
        (&none, "no credentials are set; set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY"),
    ];
    for (over, words) in cases {
        server.fail(|_, _| Fault::None);
        let text = said(storage_with(&server, over).read(&at(URI), MOST));
        assert!(text.contains("refuses access (status 403") && text.contains(words), "{text}");
        assert_eq!(server.requests().len(), 1, "{text}");
        assert_eq!(server.requests()[0].is_signed, over != none);
    }
    for (over, words) in [
        (("AWS_SECRET_ACCESS_KEY", ""), "belong together"),
        (("AWS_ALLOW_HTTP", ""), "set AWS_ALLOW_HTTP=true"),
        (("AWS_SKIP_SIGNATURE", "perhaps"), "a variable of AWS_* is not valid"),
    ] {
        server.fail(|_, _| Fault::None);
        let text = said(storage_with(&server, &[over]).read(&at(URI), MOST));
        assert!(text.contains(words), "{text}");
        assert!(server.requests().is_empty());
    }
}

/// Refusals whose document quotes the request's signature.
#[test]
fn refusals_are_said_by_their_code_alone() {
    let (server, _) = server();
    for (fault, words) in [
        (
            Fault::Status(400, "ExpiredToken"),
            "status 400, ExpiredToken); the credentials have expired",
        ),
        (Fault::Status(403, "RequestTimeTooSkewed"), "the clock of this machine is wrong"),
        (Fault::Status(403, "AccessDenied"), "these credentials may not do this"),
        (Fault::Status(403, "AKID S3CR3T"), "(status 403); these credentials"),
        (Fault::Status(400, "InvalidArgument"), "refused: status 400, InvalidArgument"),
        (Fault::Status(301, "PermanentRedirect"), "set AWS_REGION"),
        (Fault::Unsigned, "(status 403, AccessDenied)"),
    ] {
        server.fail(move |_, _| fault.clone());
        let text = said(storage(&server).read(&at(URI), MOST));
        assert!(text.starts_with(URI) && text.contains(words), "{text}");
        assert_eq!(server.requests().len(), 1, "{text}");
    }
}
