//! Serves a folder of files, such as the studio, to browsers on this machine only.
//!
//! When the server starts, it reads all files of the folder into memory, so no request can make it
//! open a file on disk. The server refuses folders that contain links. A folder may come from
//! another person, and the scripts in it could read the files to which links point.
//!
//! The address is `http://NAME.localhost:PORT/`. NAME is a keyed hash of the folder, and only this
//! user can read the key. A browser keeps service workers and stored data separately for each name.
//! Therefore, other programs cannot leave a script at this address, and a page of one folder cannot
//! read data that a page of another folder stored. The same folder always gets the same name. The
//! server refuses requests to any other host name, including `127.0.0.1`.
//!
//! A page must not navigate its tab to another origin. Otherwise, a script could read the files
//! that the user drops on the page, and send their contents to another server as part of the new
//! address. No header can forbid navigation: browsers never supported `navigate-to`, and a sandbox
//! without `allow-top-navigation` restricts only frames. Therefore, each page begins with
//! `stay.js`, which uses the Navigation API to cancel every navigation to another origin. `stay.js`
//! has no effect in a browser without that API (`'navigation' in window` is false). The server does
//! not serve scripts of service workers, because a service worker could answer a request for the
//! page with a different page. Two ways to send data remain open to scripts: host names that a
//! browser looks up ahead of time (`dns-prefetch`), and WebRTC.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use htex_base::files::{Key, OwnFolder};
use http_body_util::Full;
use hyper::body::{Bytes, Incoming};
use hyper::header::HeaderValue;
use hyper::{Method, Request, Response, StatusCode};

use super::gate::{Refusal, check_origin, host};
use super::server::{Answers, Server, hexadecimal, listen, page_error};
use crate::error::LabError;

/// Limits of a folder: the number of files, the size of one file, and the nesting depth of folders.
const MOST_FILES: usize = 1_000;
const MOST_BYTES: u64 = 64 << 20;
const MOST_DEPTH: usize = 4;
/// The page served at `/`.
const INDEX: &str = "index.html";

/// The script that keeps a page at its address, and the text that is put at the start of each page.
/// The page's own doctype is then the second one, and browsers ignore it.
const STAY: &str = include_str!("stay.js");
const STAY_NAME: &str = "htex-stay.js";
const BEGINNING: &str = "<!doctype html><script src=\"/htex-stay.js\"></script>";

const HTML: &str = "text/html; charset=utf-8";
const SVG: &str = "image/svg+xml";

/// Policy for an image that is opened as a page. It may load and run nothing.
const PICTURE_POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; sandbox";
const POLICY: &str = "Content-Security-Policy";

/// Headers of all files. These headers forbid a page to access anything outside the folder.
const HEADERS: [(&str, &str); 5] = [
    ("Cache-Control", "no-cache"),
    ("Referrer-Policy", "no-referrer"),
    ("X-Content-Type-Options", "nosniff"),
    ("X-Frame-Options", "DENY"),
    (
        POLICY,
        "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; \
         connect-src 'self'; worker-src 'self'; manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; \
         sandbox allow-scripts allow-same-origin allow-downloads allow-modals",
    ),
];

/// A folder that is served as long as this value lives.
pub struct ServedFolder {
    url: String,
    _server: Server,
}

impl ServedFolder {
    /// Serves a folder's files on this machine. Port 0 means any free port. `key` is the user's
    /// key. A folder has the same host name each time it is served with the same key.
    ///
    /// # Errors
    /// Returns an error if the folder has no `index.html`, if one of its files is a link, cannot be
    /// read or is too large, or if the port is taken.
    pub fn open(folder: &Path, port: u16, key: &Key) -> Result<Self, LabError> {
        let mut files = BTreeMap::new();
        read(&OwnFolder::new(folder), "", 0, &mut files)?;
        if !files.contains_key(INDEX) {
            return Err(wrong(folder, format!("there is no {INDEX}")));
        }
        let (listener, own_port) = listen(port).map_err(|error| page_error(port, error))?;
        let mut files = files.into_iter().map(kept_at_home).collect::<BTreeMap<_, _>>();
        files.insert(STAY_NAME.to_owned(), Bytes::from_static(STAY.as_bytes()));
        let host = host(&name(folder, key), own_port);
        let url = format!("http://{host}/");
        let shelf = Files { host, files };
        let server = Server::start(listener, Arc::new(shelf));
        let server = server.map_err(|error| page_error(port, error))?;
        Ok(Self { url, _server: server })
    }

    /// Returns the address of the folder's page.
    pub fn url(&self) -> &str {
        &self.url
    }
}

/// Returns a file as it is served. If the file is a page, adds the script that keeps the page at
/// its address.
fn kept_at_home((name, bytes): (String, Bytes)) -> (String, Bytes) {
    if kind_of(&name) != HTML {
        return (name, bytes);
    }
    // Removes a byte order mark. It would no longer come first, so it would become text of the
    // page.
    let text = bytes.strip_prefix("\u{FEFF}".as_bytes()).unwrap_or(&bytes);
    let begun = [BEGINNING.as_bytes(), text].concat();
    (name, begun.into())
}

/// Returns the name at which a folder is served: 32 hexadecimal digits that nobody without the key
/// can know.
fn name(folder: &Path, key: &Key) -> String {
    // The path is resolved, so that a folder has only one name, whichever path leads to it.
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let tag = key.tag("page", folder.as_os_str().as_encoded_bytes());
    // The whole tag of 32 bytes would give 64 digits, but a label of a host name has at most 63
    // characters.
    hexadecimal(&tag[..16])
}

fn wrong(path: &Path, problem: impl ToString) -> LabError {
    LabError::Folder { path: path.to_owned(), problem: problem.to_string() }
}

/// Reads the files of a folder and its subfolders, by their paths in an address.
fn read(
    own: &OwnFolder,
    below: &str,
    depth: usize,
    files: &mut BTreeMap<String, Bytes>,
) -> Result<(), LabError> {
    let folder = own.entry_path(below.as_ref()).map_err(|error| wrong(own.path(), error))?;
    let failed = |error: std::io::Error| wrong(&folder, error);
    for entry in std::fs::read_dir(&folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(failed)?);
        let name = format!("{below}{}", entry.file_name().to_string_lossy());
        // For a link, this is the type of the link itself, so `own.read` below refuses it.
        if kind.is_dir() {
            if depth == MOST_DEPTH {
                return Err(wrong(&path, "the folders lie too deep for a page"));
            }
            read(own, &format!("{name}/"), depth + 1, files)?;
            continue;
        }
        if files.len() == MOST_FILES {
            let problem =
                format!("there are more than {MOST_FILES} files; give the folder of a page");
            return Err(wrong(&folder, problem));
        }
        let bytes = own.read(name.as_ref(), MOST_BYTES).map_err(|error| wrong(&path, error))?;
        files.insert(name, bytes.into());
    }
    Ok(())
}

/// The files by their paths.
struct Files {
    host: String,
    files: BTreeMap<String, Bytes>,
}

impl Answers for Files {
    async fn answer(
        &self,
        request: Request<Incoming>,
        is_known: &AtomicBool,
    ) -> Result<Response<Full<Bytes>>, Refusal> {
        let (head, _) = request.into_parts();
        check_origin(&head, std::slice::from_ref(&self.host))?;
        is_known.store(true, Ordering::Relaxed);
        if head.method != Method::GET && head.method != Method::HEAD {
            return Err((StatusCode::METHOD_NOT_ALLOWED, "this page is only read"));
        }
        if head.headers.contains_key("Service-Worker") {
            let why = "a script of this page may not answer in its place (service worker)";
            return Err((StatusCode::FORBIDDEN, why));
        }
        let path = head.uri.path().trim_start_matches('/');
        let name = if path.is_empty() { INDEX } else { path };
        let bytes = self.files.get(name).ok_or((StatusCode::NOT_FOUND, "there is no such file"))?;
        let body = match head.method {
            Method::HEAD => Bytes::new(),
            _ => bytes.clone(),
        };
        let mut response = Response::new(Full::new(body));
        let headers = response.headers_mut();
        let kind = kind_of(name);
        headers.insert("Content-Type", HeaderValue::from_static(kind));
        for (name, value) in HEADERS {
            headers.insert(name, HeaderValue::from_static(value));
        }
        // An image may contain scripts. Therefore, this policy replaces the policy of pages.
        if kind == SVG {
            headers.insert(POLICY, HeaderValue::from_static(PICTURE_POLICY));
        }
        Ok(response)
    }
}

/// Returns the media type of a file by its name.
fn kind_of(name: &str) -> &'static str {
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
    match extension {
        "html" => HTML,
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "json" | "webmanifest" => "application/json",
        "svg" => SVG,
        "png" => "image/png",
        "wasm" => "application/wasm",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Write};
    use std::net::TcpStream;

    use super::*;

    /// Returns the host of a page.
    fn host_of(served: &ServedFolder) -> &str {
        served.url().trim_start_matches("http://").trim_end_matches('/')
    }

    /// Returns the reply to the head of a request.
    fn ask(served: &ServedFolder, request: &str, host: &str) -> String {
        let own = host_of(served);
        let port: u16 = own.split_once(':').unwrap().1.parse().unwrap();
        let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        let host = if host.is_empty() { own } else { host };
        write!(stream, "{request} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
        let mut reply = Vec::new();
        stream.read_to_end(&mut reply).unwrap();
        String::from_utf8_lossy(&reply).into_owned()
    }

    #[test]
    fn files_of_the_folder_alone_are_served_to_this_machine() {
        let outer = tempfile::tempdir().unwrap();
        let folder = outer.path().join("static");
        std::fs::create_dir_all(folder.join("assets")).unwrap();
        std::fs::write(outer.path().join("secret.html"), "secret").unwrap();
        std::fs::write(folder.join(INDEX), "<title>page</title>").unwrap();
        std::fs::write(folder.join("assets/a.wasm"), [0, 97, 115, 109]).unwrap();
        let key = Key::passing().unwrap();
        let served = ServedFolder::open(&folder, 0, &key).unwrap();
        let page = ask(&served, "GET /", "");
        assert!(page.starts_with("HTTP/1.1 200"), "{page}");
        assert!(page.contains("script-src 'self' 'wasm-unsafe-eval';"), "{page}");
        let begun = format!("{BEGINNING}<title>page</title>");
        assert!(page.ends_with(&begun), "{page}");
        let module = ask(&served, "GET /assets/a.wasm", "");
        assert!(module.contains("application/wasm"), "{module}");
        for (request, code) in [
            ("GET /../secret.html", "404"),
            ("GET /%2e%2e/secret.html", "404"),
            ("GET /assets", "404"),
            ("POST /", "405"),
        ] {
            let reply = ask(&served, request, "");
            assert!(reply.starts_with(&format!("HTTP/1.1 {code}")), "{request}: {reply}");
        }
        let port = host_of(&served).split_once(':').unwrap().1;
        let by_number = format!("127.0.0.1:{port}");
        let by_name = format!("localhost:{port}");
        for host in ["elsewhere.example", &by_number, &by_name] {
            let reply = ask(&served, "GET /", host);
            assert!(reply.starts_with("HTTP/1.1 403"), "{host}: {reply}");
        }
    }

    /// A folder keeps its name as long as the user has the same key. Every other folder and every
    /// other user has another name.
    #[test]
    fn the_name_is_of_the_user_and_of_the_folder() {
        let outer = tempfile::tempdir().unwrap();
        let [one, other] = ["one", "other"].map(|name| outer.path().join(name));
        for folder in [&one, &other] {
            std::fs::create_dir(folder).unwrap();
        }
        let key = Key::load_or_create(&outer.path().join("config"), "studio.key").unwrap();
        let again = Key::load_or_create(&outer.path().join("config"), "studio.key").unwrap();
        let own = name(&one, &key);
        assert!(own.len() == 32 && own.bytes().all(|c| c.is_ascii_hexdigit()));
        assert_eq!(own, name(&one.join("../one"), &again));
        assert_ne!(own, name(&other, &key));
        assert_ne!(own, name(&one, &Key::passing().unwrap()));
    }

    /// A page from another person could read the file to which a link points.
    #[cfg(unix)]
    #[test]
    fn a_link_in_the_folder_is_refused() {
        let outer = tempfile::tempdir().unwrap();
        std::fs::write(outer.path().join("id_rsa"), "secret").unwrap();
        for link in ["id.txt", "assets"] {
            let folder = outer.path().join(format!("page-{link}"));
            std::fs::create_dir(&folder).unwrap();
            std::fs::write(folder.join(INDEX), "<title>page</title>").unwrap();
            let target = match link {
                "assets" => outer.path().to_owned(),
                _ => outer.path().join("id_rsa"),
            };
            std::os::unix::fs::symlink(target, folder.join(link)).unwrap();
            let error =
                ServedFolder::open(&folder, 0, &Key::passing().unwrap()).err().unwrap().to_string();
            assert!(error.contains(link) && error.contains("is a symbolic link"), "{error}");
        }
    }

    #[test]
    fn a_folder_without_a_page_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let key = Key::passing().unwrap();
        let error = ServedFolder::open(folder.path(), 0, &key).err().unwrap();
        assert!(error.to_string().contains("there is no index.html"), "{error}");
    }
}
