//! Serves a session's page from this machine to a single browser tab.
//!
//! The address contains a random token. The server refuses requests with another host name or
//! origin before it reads their bodies. Therefore, other pages in the browser and other users of
//! the machine cannot see, answer or delay the requests of the session's page. One tab owns the
//! page until it is closed or silent for 8 s; other tabs are refused. Any tab can stop the session
//! at any time, with a button or with Escape.

mod folder;
mod gate;
mod server;

use serde_json::Value;

pub use folder::ServedFolder;
pub(crate) use server::LocalPage;

/// The content of a page, and the requests that it accepts. The server's thread calls both
/// functions.
pub(crate) trait Content: Send + Sync + 'static {
    /// The page itself.
    const HTML: &'static str;
    /// Names of the page's own requests. Every page also has `state`, `leave` and `stop`.
    const REQUESTS: &'static [&'static str];

    /// Handles a request from the tab that owns the page. Also handles `stop` from any tab.
    fn handle(&self, request: &str, body: &Value);

    /// Returns the reply to each request of the owner.
    fn state(&self) -> Value;
}
