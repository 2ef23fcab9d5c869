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
    SeatError::Certificate { path: PathBuf::from(file), problem: problem.to_string() }
}

#[cfg(feature = "tls")]
pub(crate) mod tls {
    //! Connections that are encrypted.

    use super::refused;
    use crate::error::SeatError;
    use std::{path::Path, sync::Arc, time::Duration};
    use tokio::net::TcpStream;
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

    impl Identity {
        /// Encrypts a connection; none where the other end does not.
        pub(crate) async fn greet(&self, stream: TcpStream) -> Option<TlsStream<TcpStream>> {
            let acceptor = TlsAcceptor::from(Arc::clone(&self.0));
            let greeting = tokio::time::timeout(GREETED_WITHIN, acceptor.accept(stream));
            greeting.await.ok()?.ok()
        }
    }
}
