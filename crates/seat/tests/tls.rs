//! What is sent to other computers, encrypted by the server itself: `cargo test --workspace --features maveric-seat/tls --test seat tls`.

use crate::support::{folder, runtime, seat};
use maveric_seat::{Wire, serve};
use std::{
    io::{Read as _, Write as _},
    net::{SocketAddr, TcpStream},
    path::Path,
    sync::Arc,
};
use tokio_rustls::rustls::{
    ClientConfig, ClientConnection, RootCertStore, StreamOwned,
    pki_types::{CertificateDer, ServerName, pem::PemObject as _},
};

const FILES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/certificate");

fn wire(certificate: &str, key: &str) -> Result<Wire, maveric_seat::SeatError> {
    let at = |name: &str| Path::new(FILES).join(name);
    Wire::with_certificate(&at(certificate), &at(key))
}

#[test]
fn a_page_comes_encrypted_and_whoever_does_not_greet_keeps_nobody_waiting() {
    let folder = folder();
    let seat = Arc::new(seat(folder.path()));
    let runtime = runtime();
    let everywhere = SocketAddr::from(([0, 0, 0, 0], 0));
    let wire = wire("certificate.pem", "key.pem").unwrap();
    assert_eq!(wire.scheme(), "https");
    let serving = runtime.block_on(serve(seat, everywhere, wire, |_| {})).unwrap();
    let address = SocketAddr::from(([127, 0, 0, 1], serving.address.port()));
    runtime.spawn(serving.forever());
    let _silent = TcpStream::connect(address).unwrap();

    let mut roots = RootCertStore::empty();
    let certificate = Path::new(FILES).join("certificate.pem");
    roots.add(CertificateDer::from_pem_file(certificate).unwrap()).unwrap();
    let config = ClientConfig::builder().with_root_certificates(roots).with_no_client_auth();
    let name = ServerName::try_from("127.0.0.1").unwrap();
    let client = ClientConnection::new(Arc::new(config), name).unwrap();
    let mut stream = StreamOwned::new(client, TcpStream::connect(address).unwrap());
    let request = format!("GET /lab HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).unwrap();
    let mut reply = String::new();
    // The server may close without a farewell.
    let _ = stream.read_to_string(&mut reply);
    runtime.shutdown_background();
    assert!(reply.starts_with("HTTP/1.1 200"), "{reply}");
    assert!(reply.contains("Laboratory"), "{reply}");
}

#[test]
fn a_file_that_is_no_certificate_or_not_its_key_is_named() {
    let error = |certificate, key| wire(certificate, key).unwrap_err().to_string();
    assert!(error("none.pem", "key.pem").contains("none.pem"));
    assert!(error("key.pem", "key.pem").contains("holds no certificate"));
    assert!(error("certificate.pem", "certificate.pem").contains("certificate.pem"));
}
