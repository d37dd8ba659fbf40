//! Where the broker is, and how this program shows who it is.

use crate::cli::Cell;
use rumqttc::TlsConfiguration;
use rumqttc::v5::MqttOptions;
use rustls::crypto::ring;
use rustls::pki_types::pem::PemObject as _;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::{ClientConfig, RootCertStore};
use std::fs;
use std::sync::Arc;
use std::time::Duration;

/// The broker notices within one and a half times this interval that this computer is gone.
const KEEP_ALIVE: Duration = Duration::from_secs(10);
/// Longest message with a job, bytes: a program of the greatest length.
const JOB: u32 = 33 * 1024 * 1024;
/// Longest other message, bytes.
const COMMAND: u32 = 64 * 1024;

/// The options of a connection, without the will.
///
/// # Errors
///
/// A sentence about the URL, the password or a certificate.
pub fn options(url: &str, client: &str, cell: &Cell) -> Result<MqttOptions, String> {
    let (host, port, is_secret) = address(url)?;
    let mut options = MqttOptions::new(client, host, port);
    options
        .set_keep_alive(KEEP_ALIVE)
        .set_clean_start(true)
        .set_max_packet_size(Some(if cell.mqtt_jobs { JOB } else { COMMAND }));
    let password = match &cell.mqtt_password_file {
        Some(path) => {
            let text = fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?;
            Some(text.trim_end_matches(['\r', '\n']).to_owned())
        }
        None => std::env::var("HUSILLO_MQTT_PASSWORD").ok(),
    };
    if let Some(user) = &cell.mqtt_user {
        options.set_credentials(user, password.unwrap_or_default());
    }
    match (is_secret, &cell.mqtt_ca, &cell.mqtt_certificate) {
        (true, ..) => {
            options.set_transport(rumqttc::Transport::tls_with_config(tls(cell)?));
        }
        (false, None, None) => {}
        _ => return Err("certificates are for a URL with mqtts://".into()),
    }
    Ok(options)
}

/// Host and port of a URL, and whether it is encrypted.
fn address(url: &str) -> Result<(String, u16, bool), String> {
    let expected = || format!("{url}: mqtt://HOST[:PORT] or mqtts://HOST[:PORT] is expected");
    let (scheme, rest) = url.split_once("://").ok_or_else(expected)?;
    let (is_secret, port) = match scheme {
        "mqtt" => (false, 1883),
        "mqtts" => (true, 8883),
        _ => return Err(expected()),
    };
    let rest = rest.strip_suffix('/').unwrap_or(rest);
    if rest.contains('@') {
        let why = "a password in the URL can be read by all users of this computer: use \
                   --mqtt-user and --mqtt-password-file";
        return Err(why.into());
    }
    let (host, port) = match rest.rsplit_once(':') {
        Some((host, text)) if !text.ends_with(']') => (host, text.parse().map_err(|_| expected())?),
        _ => (rest, port),
    };
    match host.is_empty() || host.contains(['/', '?', '#']) {
        true => Err(expected()),
        false => Ok((host.to_owned(), port, is_secret)),
    }
}

/// Which certificates are accepted and shown.
fn tls(cell: &Cell) -> Result<TlsConfiguration, String> {
    let mut roots = RootCertStore::empty();
    match &cell.mqtt_ca {
        Some(path) => {
            roots.add_parsable_certificates(certificates(path)?);
        }
        None => {
            roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
        }
    }
    if roots.is_empty() {
        return Err("no certificate of an authority is known: add --mqtt-ca FILE".into());
    }
    let provider = Arc::new(ring::default_provider());
    let config = ClientConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .map_err(|error| error.to_string())?
        .with_root_certificates(roots);
    let config = match (&cell.mqtt_certificate, &cell.mqtt_key) {
        (Some(certificate), Some(path)) => {
            let key = PrivateKeyDer::from_pem_file(path);
            let key = key.map_err(|error| format!("{path}: {error}"))?;
            let chain = certificates(certificate)?;
            let config = config.with_client_auth_cert(chain, key);
            config.map_err(|error| format!("{certificate}: {error}"))?
        }
        _ => config.with_no_client_auth(),
    };
    Ok(config.into())
}

fn certificates(path: &str) -> Result<Vec<CertificateDer<'static>>, String> {
    let named = |error| format!("{path}: {error}");
    let all = CertificateDer::pem_file_iter(path).map_err(named)?;
    all.collect::<Result<_, _>>().map_err(named)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn urls_have_a_host_and_perhaps_a_port() {
        let is = |url, host: &str, port, is_secret| {
            assert_eq!(address(url), Ok((host.to_owned(), port, is_secret)));
        };
        is("mqtt://cell", "cell", 1883, false);
        is("mqtt://10.0.0.1:99/", "10.0.0.1", 99, false);
        is("mqtts://cell.lan", "cell.lan", 8883, true);
        is("mqtt://[::1]", "[::1]", 1883, false);
        is("mqtt://[::1]:5", "[::1]", 5, false);
        for wrong in [
            "cell",
            "mqtt://",
            "http://cell",
            "mqtt://a:b",
            "mqtt://a/b",
            "mqtt://:1",
        ] {
            assert!(address(wrong).is_err(), "{wrong}");
        }
        assert!(
            address("mqtt://me:secret@cell")
                .unwrap_err()
                .contains("--mqtt-password-file")
        );
    }
}
