//! `husillo serve`: its arguments about the broker of a cell.

use clap::Args;

/// The broker, and what it may do.
#[derive(Debug, Args)]
pub struct Cell {
    /// Publish what the machines do at this broker (MQTT 5, Sparkplug B): `mqtt://HOST[:PORT]`, or
    /// `mqtts://` with TLS
    #[arg(long = "mqtt", value_name = "URL")]
    pub mqtt: Option<String>,
    /// Take jobs from the broker: whoever may write there can start programs
    #[arg(long, requires = "mqtt", conflicts_with = "watch_only")]
    pub mqtt_jobs: bool,
    /// Group of this server in the topics
    #[arg(long, value_name = "NAME", default_value = "husillo", value_parser = topic_part)]
    pub mqtt_group: String,
    /// Name of this server in the topics, different for each one [default: the name of this
    /// computer]
    #[arg(long, value_name = "NAME", value_parser = topic_part)]
    pub mqtt_node: Option<String>,
    /// User for the broker
    #[arg(long, value_name = "NAME", env = "HUSILLO_MQTT_USER")]
    pub mqtt_user: Option<String>,
    /// File with the password for the broker [default: the password in HUSILLO_MQTT_PASSWORD]
    #[arg(long, value_name = "FILE")]
    pub mqtt_password_file: Option<String>,
    /// File (PEM) with the certificates that the broker may have [default: those of the system]
    #[arg(long, value_name = "FILE")]
    pub mqtt_ca: Option<String>,
    /// File (PEM) with the certificate of this server for the broker
    #[arg(long, value_name = "FILE", requires = "mqtt_key")]
    pub mqtt_certificate: Option<String>,
    /// File (PEM) with its private key
    #[arg(long, value_name = "FILE", requires = "mqtt_certificate")]
    pub mqtt_key: Option<String>,
}

/// A name that can be a part of a topic.
fn topic_part(text: &str) -> Result<String, String> {
    let is_plain = |c: char| !c.is_control() && !"/+#".contains(c);
    match (1..=64).contains(&text.len()) && text.chars().all(is_plain) {
        true => Ok(text.into()),
        false => Err("a name of 1 to 64 bytes without / + # is expected".into()),
    }
}
