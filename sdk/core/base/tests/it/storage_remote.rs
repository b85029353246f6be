//! Ranges of one version of a file, and their cost.

use crate::storage_common as common;

use common::{MOST, at, bytes, said, storage};
use htex_base::storage::{Location, Remote, StorageError, StorageProblem, Usage};
use htex_object_server::{Fault, Server};

const NAME: &str = "surfaces/all.htexlib";
const URI: &str = "s3://surfaces/all.htexlib";

fn server() -> (Server, Vec<u8>) {
    let (server, bytes) = (Server::start(), bytes(1_000_000));
    server.put(NAME, &bytes);
    (server, bytes)
}

fn read(remote: &Remote, offset: u64, len: usize) -> Result<Vec<u8>, StorageError> {
    let mut buffer = vec![0; len];
    remote.read_at(offset, &mut buffer).map(|()| buffer)
}

/// The size comes with the first range, without a separate request.
#[test]
fn opening_and_two_reads_are_three_requests() {
    let (server, bytes) = server();
    let remote = storage(&server).open(&at(URI), 4_096).unwrap();
    assert_eq!(remote.len(), 1_000_000);
    assert_eq!(read(&remote, 100, 3_996).unwrap(), bytes[100..4_096]);
    assert_eq!(server.requests().len(), 1);
    assert_eq!(read(&remote, 4_095, 2).unwrap(), bytes[4_095..4_097]);
    assert_eq!(read(&remote, 999_000, 1_000).unwrap(), bytes[999_000..]);
    let requests = server.requests();
    assert!(requests.iter().all(|request| request.method == "GET"));
    let ranges: Vec<_> = requests.iter().map(|r| r.range.clone().unwrap()).collect();
    assert_eq!(ranges, ["bytes=0-4095", "bytes=4095-4096", "bytes=999000-999999"]);
    let usage = remote.usage();
    assert_eq!(usage, Usage { requests: 3, bytes: 4_096 + 2 + 1_000 });
}

#[test]
fn the_end_of_a_file_is_kept() {
    let (server, _) = server();
    server.put("surfaces/empty", b"");
    let remote = storage(&server).open(&at(URI), 16).unwrap();
    assert!(said(read(&remote, 999_999, 2)).contains("it has 1000000"));
    assert!(said(read(&remote, u64::MAX, 2)).contains("it has 1000000"));
    assert_eq!(read(&remote, 1_000_000, 0).unwrap(), b"");
    let empty = storage(&server).open(&at("s3://surfaces/empty"), 16).unwrap();
    assert!(empty.is_empty());
    assert!(read(&empty, 0, 1).is_err());
    let error = storage(&server).open(&at("s3://surfaces/none"), 16);
    assert!(
        matches!(error, Err(StorageError { problem: StorageProblem::Missing, .. })),
        "{error:?}"
    );
}

#[test]
fn a_local_file_is_read_alike() {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes(10_000)).unwrap();
    let storage = storage(&Server::start());
    let remote = storage.open(&Location::from(file.path().to_owned()), 64).unwrap();
    assert_eq!(remote.len(), 10_000);
    assert_eq!(read(&remote, 8, 8).unwrap(), bytes(10_000)[8..16]);
    assert_eq!(read(&remote, 9_000, 100).unwrap(), bytes(10_000)[9_000..9_100]);
    assert_eq!(remote.usage(), Usage { requests: 2, bytes: 164 });
    assert!(said(read(&remote, 9_999, 2)).contains("it has 10000"));
}

#[test]
fn a_replaced_file_is_an_error_and_never_a_mixture() {
    let (server, _) = server();
    // With the same size, with a tag and without.
    for fault in [Fault::None, Fault::WithoutTag] {
        server.put(NAME, bytes(1_000_000));
        server.fail(move |_, _| fault.clone());
        let remote = storage(&server).open(&at(URI), 16).unwrap();
        // The times of versions without a tag are in whole seconds.
        std::thread::sleep(std::time::Duration::from_millis(1_100));
        server.put(NAME, vec![7; 1_000_000]);
        let error = read(&remote, 500_000, 10);
        assert!(
            matches!(error, Err(StorageError { problem: StorageProblem::Changed, .. })),
            "{error:?}"
        );
        assert!(said(error).contains("was replaced while it was read"));
    }
}

/// The connection is cut, and when it is resumed the file has another version.
#[test]
fn a_file_that_is_replaced_in_the_middle_is_an_error() {
    let (server, _) = server();
    let path = server.path(NAME);
    server.fail(move |n, _| match n {
        0 => Fault::Cut(100_000),
        _ => {
            std::fs::write(&path, vec![7; 1_000_000]).unwrap();
            Fault::None
        }
    });
    let error = storage(&server).read(&at(URI), MOST);
    assert!(
        matches!(error, Err(StorageError { problem: StorageProblem::Changed, .. })),
        "{error:?}"
    );
    assert_eq!(server.requests().len(), 2);
}

#[test]
fn a_range_that_is_cut_is_resumed() {
    let (server, bytes) = server();
    let remote = storage(&server).open(&at(URI), 16).unwrap();
    server.fail(|n, _| if n < 2 { Fault::Cut(50_000) } else { Fault::None });
    assert_eq!(read(&remote, 100_000, 200_000).unwrap(), bytes[100_000..300_000]);
    assert_eq!(server.requests().len(), 3);
}
