//! Checks requests, and tracks which tab owns the page. The checks read the head of a request, but
//! not its body.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use hyper::header::{HOST, HeaderName, ORIGIN};
use hyper::http::request::Parts;
use hyper::{Method, StatusCode};

/// If a tab has not sent a request for this time, it counts as closed.
const SILENT: Duration = Duration::from_secs(8);

/// Decides which requests a page accepts.
pub(super) struct Gate {
    /// Start of the path of every request: `/TOKEN/`, with the page's random token.
    root: String,
    /// Host names of this server. The first one is printed first.
    hosts: Vec<String>,
}

/// What a request asks for.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum PageRequest {
    /// The page itself.
    Page,
    /// A request with a name, such as the state of the session.
    Request(String),
}

/// Why a request is refused: status and text.
pub(super) type Refusal = (StatusCode, &'static str);

impl Gate {
    /// Creates the gate of a page whose path starts with `token`. `name` must be a host name that
    /// was never used before. If the system chose the port, the gate also accepts `127.0.0.1`, for
    /// browsers that cannot resolve the host name.
    pub(super) fn new(token: &str, name: &str, port: u16, is_chosen: bool) -> Self {
        let number = (!is_chosen).then(|| format!("127.0.0.1:{port}"));
        Self {
            root: format!("/{token}/"),
            hosts: [host(name, port)].into_iter().chain(number).collect(),
        }
    }

    /// Returns the addresses of the page. Only the first one is safe from scripts that other
    /// programs left in the browser.
    pub(super) fn urls(&self) -> Vec<String> {
        let hosts = self.hosts.iter();
        hosts.map(|host| format!("http://{host}{}", self.root)).collect()
    }

    /// Checks the head of a request, before the body is read. Returns what the request asks for, or
    /// the reason for a refusal.
    pub(super) fn admit(&self, head: &Parts, requests: &[&str]) -> Result<PageRequest, Refusal> {
        check_origin(head, &self.hosts)?;
        let Some(path) = head.uri.path().strip_prefix(&self.root) else {
            let why = "the address is not complete; open the one that htex printed";
            return Err((StatusCode::NOT_FOUND, why));
        };
        match (&head.method, path) {
            (&Method::GET, "") => Ok(PageRequest::Page),
            (&Method::POST, path) if requests.contains(&path) => {
                Ok(PageRequest::Request(path.to_owned()))
            }
            _ => Err((StatusCode::NOT_FOUND, "there is no such page")),
        }
    }
}

/// Returns the host of a server on this machine, with a name that only its user knows. A browser
/// keeps scripts (service workers) and data separately for each name. Therefore, a script that
/// another program left at `127.0.0.1` cannot access this host.
pub(super) fn host(name: &str, port: u16) -> String {
    format!("{name}.localhost:{port}")
}

/// Refuses a request to another host name, or from another page.
pub(super) fn check_origin(head: &Parts, hosts: &[String]) -> Result<(), Refusal> {
    let text = |name: HeaderName| head.headers.get(name).map(|value| value.to_str().ok());
    let is_host = |text: &str| hosts.iter().any(|host| host == text);
    if !text(HOST).flatten().is_some_and(is_host) {
        let why = "this page is for this machine alone";
        return Err((StatusCode::FORBIDDEN, why));
    }
    // Requests of the page contain an origin. Programs other than browsers send none.
    let is_own = |origin: Option<&str>| {
        let host = origin.and_then(|origin| origin.strip_prefix("http://"));
        host.is_some_and(is_host)
    };
    if !text(ORIGIN).is_none_or(is_own) {
        return Err((StatusCode::FORBIDDEN, "another page may not ask this one"));
    }
    Ok(())
}

/// The tab that owns the page, and the time of its last request.
#[derive(Default)]
pub(super) struct Owner(Mutex<Option<(String, Instant)>>);

impl Owner {
    fn lock(&self) -> MutexGuard<'_, Option<(String, Instant)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns whether the tab owns the page, or can take it over now. If so, records its request.
    pub(super) fn admits(&self, tab: &str) -> bool {
        let mut owner = self.lock();
        let now = Instant::now();
        let is_free = match &*owner {
            None => true,
            Some((owner, last)) => owner == tab || now.duration_since(*last) > SILENT,
        };
        // A request that names no tab must not take over the page.
        let admitted = is_free && !tab.is_empty();
        if admitted {
            *owner = Some((tab.to_owned(), now));
        }
        admitted
    }

    pub(super) fn is_there(&self) -> bool {
        self.lock().is_some()
    }

    pub(super) fn leave(&self) {
        *self.lock() = None;
    }
}
