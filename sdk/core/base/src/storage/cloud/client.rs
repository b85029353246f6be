//! The HTTP clients: TLS with rustls, time limits, and a check of the addresses. The clients do not
//! follow redirects. The module [`super::redirects`] follows redirects with a separate client.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use reqwest::redirect::Policy;
use rustls::ClientConfig;
use rustls::crypto::ring::default_provider;
use rustls_platform_verifier::BuilderVerifierExt;

use super::addresses::{Resolver, UrlSource};
use crate::storage::Settings;

/// Longest time for opening a connection. If the server has not answered by then, the request is
/// sent again.
const LONGEST_CONNECT: Duration = Duration::from_secs(10);

/// The clients. Each is created when it is first needed and then shared together with its
/// connections.
#[derive(Debug, Default)]
pub(crate) struct Clients {
    /// Client for addresses that the user named.
    by_person: Mutex<Option<reqwest::Client>>,
    /// Client that connects only to public addresses.
    world: Mutex<Option<reqwest::Client>>,
}

impl Clients {
    /// Returns the client for addresses from this source.
    ///
    /// # Errors
    /// If no certificate of the system can be read. The error is a sentence.
    pub(super) fn client_for(
        &self,
        by: UrlSource,
        settings: &Settings,
    ) -> Result<reqwest::Client, String> {
        let kept = match by {
            UrlSource::Person => &self.by_person,
            UrlSource::Other => &self.world,
        };
        shared(kept, || client(settings, by))
    }
}

fn shared(
    kept: &Mutex<Option<reqwest::Client>>,
    make: impl FnOnce() -> Result<reqwest::Client, String>,
) -> Result<reqwest::Client, String> {
    let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(client) = &*kept {
        return Ok(client.clone());
    }
    Ok(kept.insert(make()?).clone())
}

fn client(settings: &Settings, by: UrlSource) -> Result<reqwest::Client, String> {
    let tls = ClientConfig::builder_with_provider(Arc::new(default_provider()))
        .with_safe_default_protocol_versions()
        .and_then(|tls| tls.with_platform_verifier())
        .map_err(|error| format!("no TLS: {error}"))?
        .with_no_client_auth();
    let stall = settings.stall.min(settings.total);
    reqwest::Client::builder()
        .user_agent(concat!("htex/", env!("CARGO_PKG_VERSION")))
        .tls_backend_preconfigured(tls)
        .http1_only()
        .connect_timeout(stall.min(LONGEST_CONNECT))
        .read_timeout(stall)
        .redirect(Policy::none())
        .referer(false)
        .dns_resolver(Arc::new(Resolver(by)))
        .build()
        .map_err(|error| format!("no HTTP client: {}", error.without_url()))
}
