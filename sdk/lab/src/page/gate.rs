//! What a request must have, and the tab that owns the page. Nothing of a request but its head is
//! known here.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use hyper::header::{HOST, HeaderName, ORIGIN};
use hyper::http::request::Parts;
use hyper::{Method, StatusCode};

/// A tab that has asked for nothing for this long is gone.
const SILENT: Duration = Duration::from_secs(8);

/// The gate of a page.
pub(super) struct Gate {
    /// Path that every request begins with: `/token/`.
    root: String,
    /// Host names of this server, the one that is printed first.
    hosts: Vec<String>,
}

/// What a request asks for.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Asked {
    /// The page itself.
    Page,
    /// A request by name.
    Request(String),
}

/// Why a request is refused.
pub(super) type Refusal = (StatusCode, &'static str);

impl Gate {
    /// The gate of a page whose path begins with a token, at a name that no page had before. At a
    /// port that the system chose the number of this machine is also accepted, for browsers that do
    /// not resolve the other one.
    pub(super) fn new(token: &str, name: &str, port: u16, is_chosen: bool) -> Self {
        let number = (!is_chosen).then(|| format!("127.0.0.1:{port}"));
        Self {
            root: format!("/{token}/"),
            hosts: [host(name, port)].into_iter().chain(number).collect(),
        }
    }

    /// The addresses of the page, of which the first one is safe from what other programs left in
    /// the browser.
    pub(super) fn urls(&self) -> Vec<String> {
        let hosts = self.hosts.iter();
        hosts.map(|host| format!("http://{host}{}", self.root)).collect()
    }

    /// Decides by the head of a request, whose body has not been read.
    pub(super) fn admit(&self, head: &Parts, requests: &[&str]) -> Result<Asked, Refusal> {
        check_origin(head, &self.hosts)?;
        let Some(path) = head.uri.path().strip_prefix(&self.root) else {
            let why = "the address is not complete; open the one that htex printed";
            return Err((StatusCode::NOT_FOUND, why));
        };
        match (&head.method, path) {
            (&Method::GET, "") => Ok(Asked::Page),
            (&Method::POST, path) if requests.contains(&path) => {
                Ok(Asked::Request(path.to_owned()))
            }
            _ => Err((StatusCode::NOT_FOUND, "there is no such page")),
        }
    }
}

/// The host of a server of this machine by a name that only its user knows. A browser keeps scripts
/// (service workers) and data for each name: what another program left at `127.0.0.1` has no part
/// in this one.
pub(super) fn host(name: &str, port: u16) -> String {
    format!("{name}.localhost:{port}")
}

/// Refuses a request with another host name, or of another page.
pub(super) fn check_origin(head: &Parts, hosts: &[String]) -> Result<(), Refusal> {
    let text = |name: HeaderName| head.headers.get(name).map(|value| value.to_str().ok());
    let is_host = |text: &str| hosts.iter().any(|host| host == text);
    if !text(HOST).flatten().is_some_and(is_host) {
        let why = "this page is for this machine alone";
        return Err((StatusCode::FORBIDDEN, why));
    }
    // Programs have no origin; the page's requests have one.
    let is_own = |origin: Option<&str>| {
        let host = origin.and_then(|origin| origin.strip_prefix("http://"));
        host.is_some_and(is_host)
    };
    if !text(ORIGIN).is_none_or(is_own) {
        return Err((StatusCode::FORBIDDEN, "another page may not ask this one"));
    }
    Ok(())
}

/// The tab that owns the page, and its last request.
#[derive(Default)]
pub(super) struct Owner(Mutex<Option<(String, Instant)>>);

impl Owner {
    fn lock(&self) -> MutexGuard<'_, Option<(String, Instant)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a tab owns the page, or may own it from now on.
    pub(super) fn admits(&self, tab: &str) -> bool {
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

    pub(super) fn is_there(&self) -> bool {
        self.lock().is_some()
    }

    pub(super) fn leave(&self) {
        *self.lock() = None;
    }
}
