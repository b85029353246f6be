//! Pages of a session: a server on this machine alone, for one browser tab.
//!
//! The address holds a random token, and requests with another host name or origin are refused
//! before they are read, so that other pages in the browser and other users of the machine can
//! neither see nor answer, nor delay anything. One tab owns the page, until it is closed or silent
//! for 8 s; others are refused. Each tab may stop the session at any time: a button, and Escape.

mod folder;
mod gate;
mod server;

use serde_json::Value;

pub use folder::{FolderError, ServedFolder};
pub(crate) use server::LocalPage;

/// A page cannot be served.
#[derive(Debug, thiserror::Error)]
#[error("cannot serve the page at 127.0.0.1:{port}: {problem}")]
pub struct PageError {
    /// The port; 0 if any was asked for.
    pub port: u16,
    pub problem: String,
}

/// What a page shows and takes. Both functions are called by the server's thread.
pub(crate) trait Content: Send + Sync + 'static {
    /// The page itself.
    const HTML: &'static str;
    /// Names of its requests, besides `state`, `leave` and `stop`, which every page has.
    const REQUESTS: &'static [&'static str];

    /// Takes a request of the tab that owns the page; `stop` of any tab.
    fn take(&self, request: &str, body: &Value);

    /// The reply to each request of that tab.
    fn state(&self) -> Value;
}
