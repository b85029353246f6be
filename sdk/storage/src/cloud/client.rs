//! The HTTP client: TLS by rustls, time limits, and which redirects and addresses are followed.

use std::net::{IpAddr, SocketAddr};
use std::sync::{Arc, Mutex, PoisonError};

use reqwest::dns::{Addrs, Name, Resolve, Resolving};
use reqwest::redirect::{Attempt, Policy};
use rustls::ClientConfig;
use rustls::crypto::ring::default_provider;
use rustls_platform_verifier::BuilderVerifierExt;

use crate::Settings;

/// Most redirects of one request.
const MOST_REDIRECTS: usize = 5;

/// The clients, made when they are first needed and then shared with their connections.
#[derive(Debug, Default)]
pub(crate) struct Clients {
    /// For requests with credentials, which follow no redirect.
    stores: Mutex<Option<reqwest::Client>>,
    web: Mutex<Option<reqwest::Client>>,
}

impl Clients {
    /// The client for stores.
    ///
    /// # Errors
    /// A sentence, when no certificate of the system can be read.
    pub(crate) fn stores(&self, settings: &Settings) -> Result<reqwest::Client, String> {
        shared(&self.stores, || client(settings, Policy::none()))
    }

    /// The client for web servers.
    ///
    /// # Errors
    /// As [`Self::stores`].
    pub(crate) fn web(&self, settings: &Settings) -> Result<reqwest::Client, String> {
        shared(&self.web, || client(settings, Policy::custom(redirect)))
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

fn client(settings: &Settings, redirects: Policy) -> Result<reqwest::Client, String> {
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
        .connect_timeout(stall)
        .read_timeout(stall)
        .redirect(redirects)
        .dns_resolver(Arc::new(Resolver))
        .build()
        .map_err(|error| format!("no HTTP client: {}", error.without_url()))
}

/// The reason not to follow a redirect or a name.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(super) struct NotFollowed(pub(super) &'static str);

/// Follows a redirect of a web server, but from a server of the world neither to one of this machine or network, nor from
/// HTTPS to HTTP.
fn redirect(attempt: Attempt<'_>) -> reqwest::redirect::Action {
    let before = attempt.previous();
    let (Some(first), Some(last)) = (before.first(), before.last()) else {
        return attempt.follow();
    };
    let to = attempt.url();
    let is_elsewhere = to.host_str() != first.host_str();
    let refused = match () {
        () if before.len() > MOST_REDIRECTS => "it redirects more than five times",
        () if !matches!(to.scheme(), "http" | "https") => "it redirects to another protocol",
        () if last.scheme() == "https" && to.scheme() == "http" => {
            "it redirects from HTTPS to HTTP; name the other URL if you mean it"
        }
        () if is_elsewhere && to.host_str().is_none_or(is_inner) => {
            "it redirects to an address of this machine or network; name that URL if you mean it"
        }
        () => return attempt.follow(),
    };
    attempt.error(NotFollowed(refused))
}

/// Whether a host is this machine, or one of its network, by its name or number.
fn is_inner(host: &str) -> bool {
    let number = host.trim_start_matches('[').trim_end_matches(']');
    match number.parse::<IpAddr>() {
        Ok(address) => is_inner_address(address),
        Err(_) => {
            let name = host.trim_end_matches('.').to_ascii_lowercase();
            let ends = [".localhost", ".local", ".internal"];
            name == "localhost" || ends.iter().any(|end| name.ends_with(end))
        }
    }
}

fn is_inner_address(address: IpAddr) -> bool {
    match address.to_canonical() {
        IpAddr::V4(v4) => {
            v4.is_loopback() || v4.is_private() || v4.is_link_local() || v4.is_unspecified()
        }
        IpAddr::V6(v6) => {
            let local = v6.is_unicast_link_local() || v6.is_unique_local();
            local || v6.is_loopback() || v6.is_unspecified()
        }
    }
}

fn is_link_local(address: IpAddr) -> bool {
    match address.to_canonical() {
        IpAddr::V4(v4) => v4.is_link_local(),
        IpAddr::V6(v6) => v6.is_unicast_link_local(),
    }
}

/// The system's resolver without link-local addresses: where a cloud's machine keeps its credentials, no name leads.
struct Resolver;

impl Resolve for Resolver {
    fn resolve(&self, name: Name) -> Resolving {
        Box::pin(async move {
            let found = tokio::net::lookup_host((name.as_str(), 0)).await?;
            let usable: Vec<SocketAddr> = found.filter(|a| !is_link_local(a.ip())).collect();
            if usable.is_empty() {
                return Err(NotFollowed("its name has only link-local addresses").into());
            }
            Ok(Box::new(usable.into_iter()) as Addrs)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inner_hosts_by_number_and_by_name() {
        let inner = [
            "127.0.0.1",
            "10.1.2.3",
            "192.168.0.1",
            "172.16.0.1",
            "169.254.169.254",
            "0.0.0.0",
            "[::1]",
            "[fe80::1]",
            "[fd00::1]",
            "[::ffff:169.254.169.254]",
            "localhost",
            "LOCALHOST.",
            "metadata.google.internal",
        ];
        for host in inner {
            assert!(is_inner(host), "{host}");
        }
        for host in ["example.org", "8.8.8.8", "[2001:db8::1]", "local.example"] {
            assert!(!is_inner(host), "{host}");
        }
    }
}
