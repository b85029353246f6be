//! A folder of files, served on this machine alone: the studio.
//!
//! All files are read at the start, so that no request names a file of the disk. Nothing of it is secret: the address has no token, and stays the
//! same from one time to the next, by which a browser finds what it keeps for it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use htex_files::read_regular;
use http_body_util::Full;
use hyper::body::{Bytes, Incoming};
use hyper::header::HeaderValue;
use hyper::{Method, Request, Response, StatusCode};

use super::PageError;
use super::gate::{Refusal, check_origin, hosts};
use super::server::{Answers, Server, listen};

/// Most files of a folder, most bytes of one, and how deep folders lie.
const MOST_FILES: usize = 1_000;
const MOST_BYTES: u64 = 64 << 20;
const MOST_DEPTH: usize = 4;
/// The page that `/` is.
const INDEX: &str = "index.html";

/// What a page of the folder may do: nothing beyond the folder.
const HEADERS: [(&str, &str); 5] = [
    ("Cache-Control", "no-cache"),
    ("Referrer-Policy", "no-referrer"),
    ("X-Content-Type-Options", "nosniff"),
    ("X-Frame-Options", "DENY"),
    (
        "Content-Security-Policy",
        "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; \
         connect-src 'self'; worker-src 'self'; manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
];

/// A folder cannot be served.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    #[error(transparent)]
    Page(#[from] PageError),
    #[error("{}: {problem}", path.display())]
    Folder { path: PathBuf, problem: String },
}

/// A folder that is served while this value lives.
pub struct ServedFolder {
    url: String,
    _server: Server,
}

impl ServedFolder {
    /// Serves a folder's files on this machine; port 0 is any that is free.
    ///
    /// # Errors
    /// If the folder has no `index.html`, a file cannot be read or is too large, or the port is taken.
    pub fn open(folder: &Path, port: u16) -> Result<Self, FolderError> {
        let mut files = BTreeMap::new();
        read(folder, "", 0, &mut files)?;
        if !files.contains_key(INDEX) {
            return Err(wrong(folder, format!("there is no {INDEX}")));
        }
        let failed = |error: std::io::Error| PageError {
            port,
            problem: error.to_string(),
        };
        let (listener, port) = listen(port).map_err(failed)?;
        let hosts = hosts(port);
        let url = format!("http://{}/", hosts[0]);
        let shelf = Files { hosts, files };
        let server = Server::start(listener, Arc::new(shelf)).map_err(failed)?;
        Ok(Self {
            url,
            _server: server,
        })
    }

    /// The address of the folder's page.
    pub fn url(&self) -> &str {
        &self.url
    }
}

fn wrong(path: &Path, problem: impl ToString) -> FolderError {
    FolderError::Folder {
        path: path.to_owned(),
        problem: problem.to_string(),
    }
}

/// Reads the files of a folder and of its folders, by their paths in an address.
fn read(
    folder: &Path,
    below: &str,
    depth: usize,
    files: &mut BTreeMap<String, Bytes>,
) -> Result<(), FolderError> {
    let failed = |error: std::io::Error| wrong(folder, error);
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(failed)?);
        let name = format!("{below}{}", entry.file_name().to_string_lossy());
        if kind.is_dir() {
            if depth == MOST_DEPTH {
                return Err(wrong(&path, "the folders lie too deep for a page"));
            }
            read(&path, &format!("{name}/"), depth + 1, files)?;
            continue;
        }
        if files.len() == MOST_FILES {
            let problem =
                format!("there are more than {MOST_FILES} files; give the folder of a page");
            return Err(wrong(folder, problem));
        }
        let bytes = read_regular(&path, MOST_BYTES).map_err(|error| wrong(&path, error))?;
        files.insert(name, bytes.into());
    }
    Ok(())
}

/// The files, by their paths.
struct Files {
    hosts: [String; 2],
    files: BTreeMap<String, Bytes>,
}

impl Answers for Files {
    async fn answer(
        &self,
        request: Request<Incoming>,
        is_known: &AtomicBool,
    ) -> Result<Response<Full<Bytes>>, Refusal> {
        let (head, _) = request.into_parts();
        check_origin(&head, &self.hosts)?;
        is_known.store(true, Ordering::Relaxed);
        if head.method != Method::GET && head.method != Method::HEAD {
            return Err((StatusCode::METHOD_NOT_ALLOWED, "this page is only read"));
        }
        let path = head.uri.path().trim_start_matches('/');
        let name = if path.is_empty() { INDEX } else { path };
        let bytes = self.files.get(name);
        let bytes = bytes.ok_or((StatusCode::NOT_FOUND, "there is no such file"))?;
        let body = match head.method {
            Method::HEAD => Bytes::new(),
            _ => bytes.clone(),
        };
        let mut response = Response::new(Full::new(body));
        let headers = response.headers_mut();
        headers.insert("Content-Type", HeaderValue::from_static(kind_of(name)));
        for (name, value) in HEADERS {
            headers.insert(name, HeaderValue::from_static(value));
        }
        Ok(response)
    }
}

/// The type of a file, by its name.
fn kind_of(name: &str) -> &'static str {
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
    match extension {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "json" | "webmanifest" => "application/json",
        "svg" => "image/svg+xml",
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

    /// The reply to the head of a request.
    fn ask(served: &ServedFolder, request: &str, host: &str) -> String {
        let address = served
            .url()
            .trim_start_matches("http://")
            .trim_end_matches('/');
        let mut stream = TcpStream::connect(address).unwrap();
        let host = if host.is_empty() { address } else { host };
        write!(
            stream,
            "{request} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"
        )
        .unwrap();
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
        let served = ServedFolder::open(&folder, 0).unwrap();
        let page = ask(&served, "GET /", "");
        assert!(page.starts_with("HTTP/1.1 200"), "{page}");
        assert!(
            page.contains("script-src 'self' 'wasm-unsafe-eval';"),
            "{page}"
        );
        assert!(page.ends_with("<title>page</title>"), "{page}");
        let module = ask(&served, "GET /assets/a.wasm", "");
        assert!(module.contains("application/wasm"), "{module}");
        for (request, code) in [
            ("GET /../secret.html", "404"),
            ("GET /%2e%2e/secret.html", "404"),
            ("GET /assets", "404"),
            ("POST /", "405"),
        ] {
            let reply = ask(&served, request, "");
            assert!(
                reply.starts_with(&format!("HTTP/1.1 {code}")),
                "{request}: {reply}"
            );
        }
        let reply = ask(&served, "GET /", "elsewhere.example");
        assert!(reply.starts_with("HTTP/1.1 403"), "{reply}");
    }

    #[test]
    fn a_folder_without_a_page_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let error = ServedFolder::open(folder.path(), 0).err().unwrap();
        assert!(
            error.to_string().contains("there is no index.html"),
            "{error}"
        );
    }
}
