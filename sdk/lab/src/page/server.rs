//! The server of a page.
//!
//! `tiny_http` blocks and has no runtime; it listens on 127.0.0.1 alone.

use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde_json::Value;
use tiny_http::{Header, Method, Request, Response, Server};

use crate::page::{Content, PageError};

/// A tab that has asked for nothing for this long is gone.
const SILENT: Duration = Duration::from_secs(8);
/// Longest body of a request, bytes.
const MOST_BYTES: u64 = 4096;
/// Longest wait, at the end, for the page to show that all is done.
const FAREWELL: Duration = Duration::from_secs(2);

/// A page that is served while this value lives.
pub(crate) struct LocalPage {
    server: Arc<Server>,
    owner: Arc<Owner>,
    thread: Option<JoinHandle<()>>,
    url: String,
}

/// What a request must have.
struct Gate {
    /// Path that every request begins with: `/token/`.
    root: String,
    /// Host names of this server.
    hosts: [String; 2],
    owner: Arc<Owner>,
}

/// The tab that owns the page, and its last request.
#[derive(Default)]
struct Owner(Mutex<Option<(String, Instant)>>);

impl LocalPage {
    /// Serves a page on this machine; port 0 is any that is free.
    ///
    /// # Errors
    /// If the port is taken or there are no random numbers.
    pub(crate) fn open<C: Content>(port: u16, content: Arc<C>) -> Result<Self, PageError> {
        let failed = |problem: String| PageError { port, problem };
        let server = Server::http(("127.0.0.1", port)).map_err(|e| failed(e.to_string()))?;
        let server = Arc::new(server);
        let mut token = [0u8; 16];
        getrandom::fill(&mut token).map_err(|e| failed(e.to_string()))?;
        let token: String = token.iter().map(|byte| format!("{byte:02x}")).collect();
        let port = server.server_addr().to_ip().map_or(port, |at| at.port());
        let root = format!("/{token}/");
        let url = format!("http://127.0.0.1:{port}{root}");
        let owner = Arc::new(Owner::default());
        let gate = Gate {
            root,
            hosts: [format!("127.0.0.1:{port}"), format!("localhost:{port}")],
            owner: Arc::clone(&owner),
        };
        let served = Arc::clone(&server);
        let thread = std::thread::spawn(move || serve(&served, &gate, &*content));
        Ok(Self {
            server,
            owner,
            thread: Some(thread),
            url,
        })
    }

    pub(crate) fn url(&self) -> &str {
        &self.url
    }

    /// Waits until the page has what it shows at the end, if a tab has the page.
    pub(crate) fn wait_for_end(&self, is_shown: impl Fn() -> bool) {
        let start = Instant::now();
        while start.elapsed() < FAREWELL && self.owner.lock().is_some() && !is_shown() {
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for LocalPage {
    fn drop(&mut self) {
        self.server.unblock();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Owner {
    fn lock(&self) -> std::sync::MutexGuard<'_, Option<(String, Instant)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a tab owns the page, or may own it from now on.
    fn admits(&self, tab: &str) -> bool {
        let mut owner = self.lock();
        let now = Instant::now();
        let is_free = match &*owner {
            None => true,
            Some((owner, last)) => owner == tab || now.duration_since(*last) > SILENT,
        };
        let admitted = is_free && !tab.is_empty();
        if admitted {
            *owner = Some((tab.to_owned(), now));
        }
        admitted
    }

    fn leave(&self) {
        *self.lock() = None;
    }
}

fn serve<C: Content>(server: &Server, gate: &Gate, content: &C) {
    // An error of `recv` is the end of the server, too.
    while let Ok(mut request) = server.recv() {
        let (code, kind, body) = reply(&mut request, gate, content);
        let mut response = Response::from_string(body).with_status_code(code);
        let headers: [(&str, &str); 5] = [
            ("Content-Type", kind),
            ("Cache-Control", "no-store"),
            ("Referrer-Policy", "no-referrer"),
            ("X-Frame-Options", "DENY"),
            (
                "Content-Security-Policy",
                "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; connect-src 'self'; img-src data:",
            ),
        ];
        for (name, value) in headers {
            if let Ok(header) = Header::from_bytes(name, value) {
                response.add_header(header);
            }
        }
        // A tab that is gone needs no reply.
        let _ = request.respond(response);
    }
}

/// Status, content type and body of a reply.
fn reply<C: Content>(
    request: &mut Request,
    gate: &Gate,
    content: &C,
) -> (u16, &'static str, String) {
    let text = |code: u16, body: &str| (code, "text/plain; charset=utf-8", body.to_owned());
    let mut headers = request.headers().iter();
    let host = headers.find(|header| header.field.equiv("Host"));
    let host = host.map(|header| header.value.as_str().to_owned());
    let mut body = Vec::new();
    let read = std::io::Read::read_to_end(
        &mut std::io::Read::take(request.as_reader(), MOST_BYTES),
        &mut body,
    );
    let body: Value = match read {
        Ok(_) => serde_json::from_slice(&body).unwrap_or_default(),
        Err(_) => return text(400, "the request is incomplete"),
    };
    if !host.is_some_and(|host| gate.hosts.contains(&host)) {
        return text(403, "this page is for this machine alone");
    }
    let Some(path) = request.url().strip_prefix(&gate.root) else {
        return text(
            404,
            "the address is not complete; open the one that htex printed",
        );
    };
    let is_request = |path: &str| ["state", "leave"].contains(&path) || C::REQUESTS.contains(&path);
    match (request.method(), path) {
        (Method::Get, "") => (200, "text/html; charset=utf-8", C::HTML.to_owned()),
        (Method::Post, path) if is_request(path) => {
            let tab = body.get("tab").and_then(Value::as_str).unwrap_or_default();
            if !gate.owner.admits(tab) {
                return text(409, "the session is open in another tab");
            }
            match path {
                "leave" => gate.owner.leave(),
                "state" => {}
                _ => content.take(path, &body),
            }
            (200, "application/json", content.state().to_string())
        }
        _ => text(404, "there is no such page"),
    }
}
