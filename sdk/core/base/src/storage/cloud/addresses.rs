//! Decides to which addresses a program may send a request. This module checks addresses from
//! arguments, from names in files, and from redirects.
//!
//! The user may name any address in an argument or in an environment variable. A file such as a
//! recipe may name only public addresses and the server that the user named. Servers may redirect
//! only to addresses that such a file may name. Without this rule, an untrusted file could cause
//! requests inside the user's network, to the machine itself, and to the metadata service of the
//! cloud in which the machine runs. The rule applies to the IP address to which a host name
//! resolves, because the program connects to this address.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

use reqwest::dns::{Addrs, Name, Resolve, Resolving};

/// The source of an address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum UrlSource {
    Person,
    /// A file, or a server that redirects.
    Other,
}

/// The reason for refusing an address.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(super) struct RedirectRefusal(pub(super) &'static str);

/// The message for a file or a redirect that leads to an address that is not public.
pub(super) const INNER: &str = "it leads to an address of this machine or network, which only the user may name: give that URL as an \
                                argument if you mean it";

/// Returns whether an address is not public, i.e. it belongs to this machine, its network or a
/// provider, stands for several machines, or is unassigned.
pub(super) fn is_inner(address: IpAddr) -> bool {
    // An IPv6 address can hold an IPv4 address (`::ffff:127.0.0.1`), to which the same rules apply.
    match address.to_canonical() {
        IpAddr::V4(v4) => is_inner_v4(v4),
        IpAddr::V6(v6) => is_inner_v6(v6),
    }
}

/// Applies IANA's registries of special-purpose IPv4 addresses (RFC 6890).
fn is_inner_v4(v4: Ipv4Addr) -> bool {
    let [a, b, c, _] = v4.octets();
    v4.is_private()
        || v4.is_loopback()
        || v4.is_link_local()
        || v4.is_multicast()
        || v4.is_broadcast()
        || v4.is_documentation()
        // This network (RFC 791), and the reserved end of the address space (RFC 1112).
        || a == 0
        || a >= 240
        // Shared between the customers of a provider (RFC 6598).
        || (a == 100 && b & 0xC0 == 64)
        // Protocol assignments (RFC 6890), and benchmarks (RFC 2544).
        || (a == 192 && b == 0 && c == 0)
        || (a == 198 && b & 0xFE == 18)
}

/// Does the same for IPv6, including addresses that stand for an IPv4 address.
fn is_inner_v6(v6: Ipv6Addr) -> bool {
    let [a, b, c, d, e, f, g, h] = v6.segments();
    let v4 = |high: u16, low: u16| Ipv4Addr::from_bits(u32::from(high) << 16 | u32::from(low));
    v6.is_loopback()
        || v6.is_unspecified()
        || v6.is_multicast()
        || v6.is_unicast_link_local()
        || v6.is_unique_local()
        // Site-local (RFC 3879), documentation (RFC 3849, RFC 9637).
        || a & 0xFFC0 == 0xFEC0
        || (a, b) == (0x2001, 0xDB8)
        || a & 0xFFF0 == 0x3FF0
        // NAT64 (RFC 6052) and its local prefix (RFC 8215), IPv4-compatible (RFC 4291), 6to4 (RFC
        // 3056).
        || ((a, b, c, d, e, f) == (0x64, 0xFF9B, 0, 0, 0, 0) && is_inner_v4(v4(g, h)))
        || (a, b, c) == (0x64, 0xFF9B, 1)
        || ((a, b, c, d, e, f) == (0, 0, 0, 0, 0, 0) && is_inner_v4(v4(g, h)))
        || (a == 0x2002 && is_inner_v4(v4(b, c)))
        // Teredo (RFC 4380) hides the address of its client.
        || (a, b) == (0x2001, 0)
}

/// Returns whether a host is a numeric address that is not public. Such an address is never
/// resolved, so the [`Resolver`] does not see it.
pub(super) fn is_inner_number(host: &str) -> bool {
    let number = host.trim_start_matches('[').trim_end_matches(']');
    number.parse().is_ok_and(is_inner)
}

/// The system's resolver, limited to addresses to which a connection is allowed.
pub(super) struct Resolver(pub(super) UrlSource);

impl Resolver {
    /// Returns whether a connection to an address is allowed. No name may lead to a link-local
    /// address, because a machine in a cloud gets its credentials from such an address.
    fn may_connect(&self, address: IpAddr) -> bool {
        let is_link_local = match address.to_canonical() {
            IpAddr::V4(v4) => v4.is_link_local(),
            IpAddr::V6(v6) => v6.is_unicast_link_local(),
        };
        match self.0 {
            UrlSource::Person => !is_link_local,
            UrlSource::Other => !is_inner(address),
        }
    }
}

impl Resolve for Resolver {
    fn resolve(&self, name: Name) -> Resolving {
        let here = Self(self.0);
        Box::pin(async move {
            // The addresses are filtered here and not beforehand, because a name could resolve to
            // another address the next time.
            let found = tokio::net::lookup_host((name.as_str(), 0)).await?;
            let usable: Vec<SocketAddr> = found.filter(|a| here.may_connect(a.ip())).collect();
            if usable.is_empty() {
                let reason = match here.0 {
                    UrlSource::Person => "its name has only link-local addresses",
                    UrlSource::Other => INNER,
                };
                return Err(RedirectRefusal(reason).into());
            }
            Ok(Box::new(usable.into_iter()) as Addrs)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inner_addresses_in_every_form() {
        let inner = [
            "127.0.0.1",
            "127.255.255.254",
            "10.1.2.3",
            "192.168.0.1",
            "172.16.0.1",
            "172.31.255.255",
            "169.254.169.254",
            "0.0.0.0",
            "0.1.2.3",
            "100.64.0.1",
            "100.127.255.255",
            "192.0.0.8",
            "198.18.0.1",
            "198.19.255.255",
            "224.0.0.1",
            "239.1.1.1",
            "240.0.0.1",
            "255.255.255.255",
            "192.0.2.1",
            "::1",
            "::",
            "fe80::1",
            "febf::1",
            "fec0::1",
            "fd00::1",
            "fc00::1",
            "ff02::1",
            "::ffff:169.254.169.254",
            "::ffff:10.0.0.1",
            "::127.0.0.1",
            "64:ff9b::10.0.0.1",
            "64:ff9b::169.254.169.254",
            "64:ff9b::7f00:1",
            "64:ff9b:1::1",
            "2002:7f00:1::",
            "2002:a00:1::1",
            "2001:db8::1",
            "2001::1",
            "3fff::1",
        ];
        for address in inner {
            assert!(address.parse().is_ok_and(is_inner), "{address}");
            assert!(is_inner_number(address), "{address}");
        }
        let outer = [
            "8.8.8.8",
            "100.63.255.255",
            "100.128.0.1",
            "172.32.0.1",
            "198.20.0.1",
            "192.0.1.1",
            "1.1.1.1",
            "223.255.255.255",
            "2606:4700::1111",
            "64:ff9b::8.8.8.8",
            "2002:808:808::1",
            "::ffff:8.8.8.8",
        ];
        for address in outer {
            assert!(address.parse().is_ok_and(|address| !is_inner(address)), "{address}");
        }
        assert!(is_inner_number("[::1]") && !is_inner_number("example.org"));
    }

    #[test]
    fn what_a_person_names_may_be_an_inner_address_and_none_by_link() {
        let may = |by, address: &str| address.parse().is_ok_and(|a| Resolver(by).may_connect(a));
        assert!(may(UrlSource::Person, "127.0.0.1") && !may(UrlSource::Other, "127.0.0.1"));
        assert!(!may(UrlSource::Person, "169.254.169.254"));
        assert!(may(UrlSource::Other, "8.8.8.8"));
    }
}
