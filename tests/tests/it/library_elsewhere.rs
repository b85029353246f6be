//! Libraries on an S3-compatible server, which counts the requests.

use std::sync::LazyLock;

use htex_base::storage::{Location, Settings, Storage};
use htex_format::Asset;
use htex_format::library::{Library, LibraryError, LibraryFile, Writer};
use htex_object_server::{Fault, Server};

const NAME: &str = "textures/many.htexlib";
const URI: &str = "s3://textures/many.htexlib";
/// Largest number of bytes read apart from the texture.
const MOST_BYTES: u64 = 64 << 10;

/// A server with a library of `count` textures.
fn server(count: u32) -> Server {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("many.htexlib");
    let mut writer = Writer::create(&path, "Many").unwrap();
    for i in 0..count {
        writer.add(&name(i), &texture(i)).unwrap();
    }
    writer.finish().unwrap();
    let server = Server::start();
    server.put(NAME, std::fs::read(&path).unwrap());
    server
}

/// The bytes of a texture, which are those of no other.
fn texture(i: u32) -> Vec<u8> {
    static VINYL: LazyLock<Asset> = LazyLock::new(|| {
        let path = htex_tests::workspace().join("examples/scenes/vinyl.htex");
        Asset::open(&path).unwrap()
    });
    let mut asset = VINYL.clone();
    asset.manifest.name = name(i);
    asset.to_bytes().unwrap()
}

fn name(i: u32) -> String {
    format!("group-{:03}/texture-{i:07}", i % 100)
}

fn storage(server: &Server) -> Storage {
    Storage::new(Settings::default(), server.variables().into_iter().collect())
}

fn open(server: &Server) -> Result<Library<LibraryFile>, LibraryError> {
    Library::open_located(&storage(server), &Location::parse(URI.as_ref()).unwrap())
}

/// Section 1 of the specification: the start of the file, a page, the texture.
#[test]
fn one_texture_takes_three_requests_whatever_the_size() {
    for count in [1_000, 20_000] {
        let server = server(count);
        for i in [0, count / 3, count - 1] {
            let before = server.requests().len();
            let library = open(&server).unwrap();
            assert_eq!(library.len(), u64::from(count));
            let bytes = texture(i);
            assert_eq!(library.get(&name(i)).unwrap(), bytes);
            let requests = server.requests().split_off(before);
            assert!(requests.len() <= 3, "{count}: {requests:?}");
            assert!(requests.iter().all(|r| r.method == "GET" && r.range.is_some()));
            let read: u64 = requests.iter().map(|r| length(r.range.as_deref())).sum();
            let others = read - bytes.len() as u64;
            assert!(others <= MOST_BYTES, "{count}: {others} bytes");
            println!("{count} textures: {} requests, {others} bytes besides", requests.len());
        }
    }
}

/// The length that a header `Range: bytes=A-B` requests.
fn length(range: Option<&str>) -> u64 {
    let (first, last) = range.unwrap().trim_start_matches("bytes=").split_once('-').unwrap();
    last.parse::<u64>().unwrap() - first.parse::<u64>().unwrap() + 1
}

/// A library that is replaced between two reads is not read as a mixture.
#[test]
fn a_replaced_library_and_a_failing_server_are_errors() {
    let server = server(1_000);
    let library = open(&server).unwrap();
    assert_eq!(library.get(&name(7)).unwrap(), texture(7));
    server.put(NAME, vec![7; 3_000_000]);
    let error = library.get(&name(999)).unwrap_err().to_string();
    assert!(error.contains("replaced"), "{error}");
    assert!(matches!(open(&server), Err(LibraryError::Invalid { .. })));
    server.fail(|_, _| Fault::Status(403, "AccessDenied"));
    let error = open(&server).map(drop).unwrap_err();
    assert!(matches!(&error, LibraryError::Storage(_)), "{error}");
    assert!(error.to_string().contains(URI), "{error}");
}
