//! Who may ask: pages of this server alone.

use axum::http::{HeaderMap, header};
use std::net::SocketAddr;

/// Whether a request that changes something comes from a page of this server: its `Origin` is the `Host` it asks.
pub(crate) fn own(headers: &HeaderMap) -> bool {
    let text = |name| headers.get(name).and_then(|v| v.to_str().ok());
    let (Some(origin), Some(host)) = (text(header::ORIGIN), text(header::HOST)) else {
        return false;
    };
    ["http://", "https://"]
        .iter()
        .any(|scheme| origin.strip_prefix(scheme) == Some(host))
}

/// Whether a server that is bound to this machine is asked by its own name: another name that leads here is somebody else's page.
pub(crate) fn host_is_ours(headers: &HeaderMap, bound: SocketAddr) -> bool {
    if !bound.ip().is_loopback() {
        return true;
    }
    let host = headers.get(header::HOST).and_then(|v| v.to_str().ok());
    let port = bound.port();
    host.is_some_and(|host| {
        ["127.0.0.1", "localhost", "[::1]"]
            .iter()
            .any(|name| host == format!("{name}:{port}"))
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
        assert!(!host_is_ours(
            &headers(&[(header::HOST, "rebound.example:8000")]),
            bound
        ));
    }
}
