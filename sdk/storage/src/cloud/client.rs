//! The HTTP clients: TLS by rustls, time limits, and the addresses that are connected to. They
//! follow no redirect: [`super::redirects`] does, by another client.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use reqwest::redirect::Policy;
use rustls::ClientConfig;
use rustls::crypto::ring::default_provider;
use rustls_platform_verifier::BuilderVerifierExt;

use super::addresses::{NamedBy, Resolver};
use crate::Settings;

/// Most time for a connection; a server that does not answer so soon is tried again.
const LONGEST_CONNECT: Duration = Duration::from_secs(10);

/// The clients, made when they are first needed and then shared with their connections.
#[derive(Debug, Default)]
pub(crate) struct Clients {
    /// For addresses that a person named.
    by_person: Mutex<Option<reqwest::Client>>,
    /// For addresses of the world alone.
    world: Mutex<Option<reqwest::Client>>,
}

impl Clients {
    /// The client for addresses that were named like this.
    ///
    /// # Errors
    /// A sentence, when no certificate of the system can be read.
    pub(super) fn of(&self, by: NamedBy, settings: &Settings) -> Result<reqwest::Client, String> {
        let kept = match by {
            NamedBy::Person => &self.by_person,
            NamedBy::Other => &self.world,
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

fn client(settings: &Settings, by: NamedBy) -> Result<reqwest::Client, String> {
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
