//! How what is sent is kept from others on its way.

use crate::error::SeatError;
use std::path::{Path, PathBuf};

/// How what is sent is kept from others on its way.
#[derive(Debug, Clone)]
pub enum Wire {
    /// It does not leave this computer.
    Here,
    /// A proxy in front encrypts it, and answers for names.
    BehindProxy,
    /// The server encrypts it.
    #[cfg(feature = "tls")]
    Tls(tls::Identity),
}

impl Wire {
    /// Encrypts with a certificate, its chain behind it, and its private key, both as PEM.
    ///
    /// # Errors
    /// [`SeatError::Certificate`] naming the file that cannot be read or is none, or where the program was built without the feature
    /// `tls`.
    pub fn with_certificate(certificate: &Path, key: &Path) -> Result<Self, SeatError> {
        #[cfg(feature = "tls")]
        return tls::identity(certificate, key).map(Self::Tls);
        #[cfg(not(feature = "tls"))]
        {
            let _ = key;
            Err(refused(
                certificate,
                &"this program was built without encryption: build it with `--features tls`, or let a proxy encrypt",
            ))
        }
    }

    /// `https` where the server encrypts.
    pub fn scheme(&self) -> &'static str {
        match self {
            #[cfg(feature = "tls")]
            Self::Tls(_) => "https",
            _ => "http",
        }
    }
}

fn refused(file: &Path, problem: &impl ToString) -> SeatError {
    SeatError::Certificate {
        path: PathBuf::from(file),
        problem: problem.to_string(),
    }
}

#[cfg(feature = "tls")]
pub(crate) mod tls {
    //! A listener whose connections are encrypted.

    use super::refused;
    use crate::error::SeatError;
    use axum::serve::Listener;
    use std::{net::SocketAddr, path::Path, sync::Arc, time::Duration};
    use tokio::{net::TcpListener, net::TcpStream, sync::mpsc};
    use tokio_rustls::{
        TlsAcceptor,
        rustls::{
            ServerConfig,
            crypto::ring,
            pki_types::{CertificateDer, PrivateKeyDer, pem::PemObject as _},
        },
        server::TlsStream,
    };

    /// A greeting takes no longer.
    const GREETED_WITHIN: Duration = Duration::from_secs(10);
    /// Connections that were greeted and not yet taken.
    const WAITING: usize = 64;

    /// A certificate with its key.
    #[derive(Debug, Clone)]
    pub struct Identity(Arc<ServerConfig>);

    pub(super) fn identity(certificate: &Path, key: &Path) -> Result<Identity, SeatError> {
        let chain: Vec<_> = CertificateDer::pem_file_iter(certificate)
            .and_then(Iterator::collect)
            .map_err(|e| refused(certificate, &e))?;
        if chain.is_empty() {
            return Err(refused(certificate, &"holds no certificate (PEM)"));
        }
        let secret = PrivateKeyDer::from_pem_file(key).map_err(|e| refused(key, &e))?;
        let config = ServerConfig::builder_with_provider(Arc::new(ring::default_provider()))
            .with_safe_default_protocol_versions()
            .map_err(|e| refused(certificate, &e))?
            .with_no_client_auth()
            .with_single_cert(chain, secret)
            .map_err(|e| refused(key, &e))?;
        Ok(Identity(Arc::new(config)))
    }

    /// Hands on connections once they are encrypted; each is greeted by itself, so that nobody waits for a slow one.
    pub(crate) struct Encrypted {
        greeted: mpsc::Receiver<(TlsStream<TcpStream>, SocketAddr)>,
        address: SocketAddr,
    }

    impl Encrypted {
        pub(crate) fn new(mut plain: TcpListener, identity: Identity, address: SocketAddr) -> Self {
            let (done, greeted) = mpsc::channel(WAITING);
            let acceptor = TlsAcceptor::from(identity.0);
            tokio::spawn(async move {
                while !done.is_closed() {
                    let (stream, from) = Listener::accept(&mut plain).await;
                    let (acceptor, done) = (acceptor.clone(), done.clone());
                    tokio::spawn(async move {
                        let greeting =
                            tokio::time::timeout(GREETED_WITHIN, acceptor.accept(stream));
                        if let Ok(Ok(stream)) = greeting.await {
                            // Nobody takes it when the server has ended.
                            let _ = done.send((stream, from)).await;
                        }
                    });
                }
            });
            Self { greeted, address }
        }
    }

    impl Listener for Encrypted {
        type Io = TlsStream<TcpStream>;
        type Addr = SocketAddr;

        async fn accept(&mut self) -> (Self::Io, Self::Addr) {
            match self.greeted.recv().await {
                Some(greeted) => greeted,
                None => std::future::pending().await,
            }
        }

        fn local_addr(&self) -> std::io::Result<SocketAddr> {
            Ok(self.address)
        }
    }
}
