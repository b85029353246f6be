//! Transfers while a server restarts, with the default retries of programs.

use crate::storage_common as common;

use std::thread;
use std::time::{Duration, Instant};

use common::{MOST, at, bytes};
use htex_base::storage::{Settings, Storage};
use htex_object_server::{Fault, Server};

/// How long connections are refused, and then requests. The earlier default of 6 retries paused for
/// 11 s at most.
const REFUSED: Duration = Duration::from_secs(7);
const BUSY: Duration = Duration::from_secs(5);

#[test]
fn transfers_outlast_a_restart() {
    let begun = Instant::now();
    let server = Server::start_after(REFUSED);
    server.fail(move |_, _| {
        if begun.elapsed() < REFUSED + BUSY {
            Fault::Status(503, "ServiceUnavailable")
        } else {
            Fault::None
        }
    });
    let (small, large) = (bytes(100_000), bytes(20 << 20));
    server.put("surfaces/cloth.csv", &small);
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), &large).unwrap();
    let variables = server.variables().into_iter().collect();
    let storage = Storage::new(Settings::default(), variables);
    thread::scope(|scope| {
        scope.spawn(|| {
            let read = storage.read(&at("s3://surfaces/cloth.csv"), MOST);
            assert_eq!(read.unwrap(), small);
        });
        scope.spawn(|| {
            let written = storage.write(&at("s3://surfaces/small"), &small);
            written.unwrap();
        });
        scope.spawn(|| {
            let written = storage.write_file(&at("s3://surfaces/large"), file.path());
            written.unwrap();
        });
    });
    assert_eq!(server.get("surfaces/small").unwrap(), small);
    assert_eq!(server.get("surfaces/large").unwrap(), large);
}
