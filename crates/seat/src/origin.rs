//! Who may ask: pages of this server alone.

use axum::http::{HeaderMap, header};
use std::net::SocketAddr;

/// The one header of this name; what is there twice is nobody's word.
fn only(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    let mut values = headers.get_all(name).iter();
    let first = values.next()?.to_str().ok()?;
    values.next().is_none().then_some(first)
}

/// Whether a request that changes something comes from a page of this server: its `Origin` is the `Host` it asks.
pub(crate) fn own(headers: &HeaderMap) -> bool {
    let (Some(origin), Some(host)) = (only(headers, header::ORIGIN), only(headers, header::HOST))
    else {
        return false;
    };
    ["http://", "https://"].iter().any(|scheme| origin.strip_prefix(scheme) == Some(host))
}

/// Whether a server that is bound to this machine is asked by its own name: another name that leads here is somebody else's page.
pub(crate) fn host_is_ours(headers: &HeaderMap, bound: SocketAddr) -> bool {
    if !bound.ip().is_loopback() {
        return true;
    }
    let port = bound.port();
    only(headers, header::HOST).is_some_and(|host| {
        ["127.0.0.1", "localhost", "[::1]"].iter().any(|name| host == format!("{name}:{port}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(header::HeaderName, &str)]) -> HeaderMap {
        let mut map = HeaderMap::new();
        for (name, value) in pairs {
            map.insert(name.clone(), value.parse().unwrap());
        }
        map
    }

    #[test]
    fn another_origin_no_origin_and_another_name_for_this_machine_are_refused() {
        let host = (header::HOST, "127.0.0.1:8000");
        let from = |origin: &str| own(&headers(&[host.clone(), (header::ORIGIN, origin)]));
        assert!(from("http://127.0.0.1:8000"));
        for origin in [
            "http://evil.example",
            "null",
            "http://127.0.0.1:8001",
            "http://127.0.0.1:8000.evil.example",
        ] {
            assert!(!from(origin), "{origin}");
        }
        assert!(!own(&headers(std::slice::from_ref(&host))));
        let bound: SocketAddr = "127.0.0.1:8000".parse().unwrap();
        assert!(host_is_ours(&headers(&[host]), bound));
        assert!(!host_is_ours(&headers(&[(header::HOST, "rebound.example:8000")]), bound));
    }
}
