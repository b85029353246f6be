//! Reads from a web server: links with signatures, redirects, addresses.

use crate::storage_common as common;

use common::{MOST, at, bytes, said, storage};
use htex_base::storage::{StorageError, StorageProblem};
use htex_object_server::{Fault, Server};

fn server() -> (Server, Vec<u8>) {
    let (server, bytes) = (Server::start(), bytes(200_000));
    server.put("web/a b.csv", &bytes);
    (server, bytes)
}

#[test]
fn a_file_is_read_without_credentials() {
    let (server, bytes) = server();
    let uri = at(&format!("{}/web/a%20b.csv", server.url()));
    assert_eq!(storage(&server).read(&uri, MOST).unwrap(), bytes);
    assert_eq!(storage(&server).read_range(&uri, 7..9).unwrap(), bytes[7..9]);
    assert_eq!(storage(&server).size(&uri).unwrap(), 200_000);
    server.fail(|_, _| Fault::Whole);
    let whole = storage(&server).open(&uri, 16).unwrap();
    let mut part = [0; 2];
    whole.read_at(150_000, &mut part).unwrap();
    assert_eq!((whole.len(), &part[..]), (200_000, &bytes[150_000..150_002]));
    server.put("web/large.csv", vec![0; (1 << 20) + 1]);
    let large = at(&format!("{}/web/large.csv", server.url()));
    assert!(said(storage(&server).open(&large, 16)).contains("whole files only"));
    server.fail(|_, _| Fault::None);
    let none = at(&format!("{}/web/none.csv", server.url()));
    assert!(!storage(&server).exists(&none).unwrap());
    assert!(server.requests().iter().all(|request| !request.is_signed));
    assert!(said(storage(&server).write(&uri, b"x")).contains("only read"));
    assert!(said(storage(&server).list(&uri, "*")).contains("no list"));
    assert_eq!(server.get("web/a b.csv").unwrap(), bytes);
}

/// The query is sent to the server and does not appear in any message.
#[test]
fn a_signed_link_stays_secret() {
    let (server, _) = server();
    let uri = at(&format!("{}/web/a%20b.csv?sig=S3CR3T%2F", server.url()));
    for fault in [
        Fault::Status(403, "AccessDenied"),
        Fault::Status(503, "X"),
        Fault::Cut(5),
        Fault::Status(404, "X"),
    ] {
        server.fail(move |_, _| fault.clone());
        assert!(said(storage(&server).read(&uri, MOST)).contains("a%20b.csv?…: "));
        assert_eq!(server.requests()[0].path, "/web/a%20b.csv?sig=S3CR3T%2F");
    }
}

/// Without a tag, versions cannot be distinguished, so the file is read from the start.
#[test]
fn a_cut_without_a_tag_is_read_from_the_start() {
    let (server, bytes) = server();
    let uri = at(&format!("{}/web/a%20b.csv", server.url()));
    server.fail(|n, _| if n < 2 { Fault::CutWithoutTag(150_000) } else { Fault::WithoutTag });
    assert_eq!(storage(&server).read(&uri, MOST).unwrap(), bytes);
    let requests = server.requests();
    assert_eq!(requests.len(), 3);
    assert!(requests.iter().all(|request| request.range.is_none()));
    server.fail(|_, _| Fault::CutWithoutTag(150_000));
    assert!(said(storage(&server).read(&uri, MOST)).contains("after 7 requests"));
}

#[test]
fn a_redirect_leads_to_no_inner_address() {
    let (server, bytes) = server();
    let to = format!("{}/web/a%20b.csv", server.url());
    let uri = at(&format!("{}/web/moved?sig=S3CR3T", server.url()));
    server.fail(move |n, _| if n == 0 { Fault::Redirect(to.clone()) } else { Fault::None });
    assert_eq!(storage(&server).read(&uri, MOST).unwrap(), bytes);
    assert_eq!(server.requests().len(), 2);
    assert!(server.requests().iter().all(|seen| seen.referer.is_none()));
    let port = server.url().rsplit(':').next().unwrap().to_owned();
    for to in [
        "http://169.254.169.254/latest/meta-data/".to_owned(),
        "http://[::ffff:169.254.169.254]/".to_owned(),
        "http://2852039166/".to_owned(),
        "http://10.0.0.1/".to_owned(),
        format!("http://localhost:{port}/web/a%20b.csv"),
    ] {
        let target = to.clone();
        server.fail(move |_, _| Fault::Redirect(target.clone()));
        let error = storage(&server).read(&uri, MOST);
        assert!(
            matches!(error, Err(StorageError { problem: StorageProblem::Refused { .. }, .. })),
            "{to}: {error:?}"
        );
        assert!(said(error).contains("an address of this machine or network"), "{to}");
        assert_eq!(server.requests().len(), 1, "{to}");
    }
    let again = format!("{}/web/moved", server.url());
    server.fail(move |_, _| Fault::Redirect(again.clone()));
    assert!(said(storage(&server).read(&uri, MOST)).contains("more than five times"));
    assert_eq!(server.requests().len(), 6);
}

/// A file may only name public addresses and the server on which it is stored. The user may name
/// any address.
#[test]
fn a_file_names_no_inner_address() {
    let (server, bytes) = server();
    let uri = at(&format!("{}/web/a%20b.csv", server.url()));
    let of_file = storage(&server).for_names_in_a_file(None);
    let refused = of_file.read(&uri, MOST);
    assert!(said(refused).contains("an address of this machine or network"));
    let by_name = at(&server.url().replace("127.0.0.1", "localhost"));
    assert!(
        said(of_file.read(&by_name.inside("web/a%20b.csv"), MOST)).contains("machine or network")
    );
    assert!(server.requests().is_empty());
    let recipe = at(&format!("{}/library.toml", server.url()));
    let beside = storage(&server).for_names_in_a_file(Some(&recipe));
    assert_eq!(beside.read(&uri, MOST).unwrap(), bytes);
    let elsewhere = at("http://127.0.0.1:1/library.toml");
    let other = storage(&server).for_names_in_a_file(Some(&elsewhere));
    assert!(said(other.read(&uri, MOST)).contains("machine or network"));
}
