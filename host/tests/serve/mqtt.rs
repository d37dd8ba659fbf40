//! What a broker gets of the machines.

use super::broker::{Broker, Host, Message, Value, free};
use super::emulated::Emulated;
use super::page::Served;
use serde_json::json;
use std::process::Command;
use std::time::{Duration, Instant};

/// A server with the name `mill`.
fn served(broker: &Broker, options: &[&str]) -> Served {
    let url = broker.url();
    let own = ["--mqtt", &url, "--mqtt-node", "mill"];
    Served::with(&[options, &own].concat(), &broker.state())
}

fn is(message: &Message, kind: &str, about: &str) -> bool {
    (&*message.kind, &*message.about) == (kind, about)
}

#[test]
fn data_appear_within_a_second() {
    let Some(broker) = Broker::new("mqtt-data") else {
        return;
    };
    let mut host = Host::new(&broker);
    let served = served(
        &broker,
        &["--speed", "10", "--port", "sim", "--port", "sim"],
    );
    let birth = host.until("the server", |one| is(one, "NBIRTH", "mill"));
    assert_eq!((birth.seq, birth.number("bdSeq")), (Some(0), 0.0));
    assert_eq!(birth.value("Node Control/Rebirth"), Some(&Value::Is(false)));
    assert_eq!(
        birth.value("Properties/Takes Jobs"),
        Some(&Value::Is(false))
    );
    let machine = host.until("a machine", |one| is(one, "DBIRTH", "mill/machine-1"));
    assert_eq!(machine.value("Alarm/Active"), Some(&Value::Is(true)));
    assert_eq!(machine.value("Program/Name"), Some(&Value::Null));
    let mut page = served.operator();
    host.until("an operator", |one| {
        one.value("Operated") == Some(&Value::Is(true))
    });
    page.done(json!({"do": "line", "text": "G1 X3 F1200"}));
    page.until_at("machine_mm", 0, 3.0);
    let begun = Instant::now();
    let data = host.until("the position", |one| {
        is(one, "DDATA", "mill/machine-1") && one.number("Position/Machine/X") == 3.0
    });
    let took = data.at.saturating_duration_since(begun);
    assert!(took < Duration::from_secs(1), "{took:?}");
    // The birth of a machine has all that is ever told of it.
    let all = host.all.clone();
    let of = all.iter().filter(|one| is(one, "DDATA", "mill/machine-1"));
    for (name, _) in of.flat_map(|one| &one.metrics) {
        assert!(machine.value(name).is_some(), "{name}");
    }
    // A host that has lost a message asks for all of it.
    host.ask_for_births();
    let again = host.until("a rebirth", |one| is(one, "NBIRTH", "mill"));
    assert_eq!((again.seq, again.number("bdSeq")), (Some(0), 0.0));
    let machine = host.until("its machine", |one| is(one, "DBIRTH", "mill/machine-1"));
    assert_eq!(machine.number("Position/Machine/X"), 3.0);
    assert_eq!(machine.value("Alarm/Active"), Some(&Value::Is(false)));
    // No message is missing, in their order.
    let mut next = 0;
    for message in &host.all {
        if message.kind == "NBIRTH" {
            next = 0;
        }
        assert_eq!(message.seq, Some(next), "{message:?}");
        next = (next + 1) % 256;
    }
}

#[test]
fn a_broker_that_is_lost_changes_nothing_and_is_found_again() {
    let Some(mut broker) = Broker::new("mqtt-lost") else {
        return;
    };
    let mut host = Host::new(&broker);
    let served = served(&broker, &[]);
    let mut page = served.operator();
    host.until("a machine", |one| is(one, "DBIRTH", "mill/machine-1"));
    let lines: String = (1..=60).map(|x| format!("G1 X{x} F600\n")).collect();
    served.load(page.client, "long.nc", &lines);
    page.done(json!({"do": "run", "confirmed": true}));
    page.until("motion", |page| (page.at("work_mm", 0) > 2.0).then_some(()));
    broker.kill();
    let at = page.at("work_mm", 0);
    page.until("the loss", |page| {
        page.has_line("the broker is not reached").then_some(())
    });
    page.until("further motion", |page| {
        (page.at("work_mm", 0) > at + 5.0).then_some(())
    });
    assert_eq!(page.states[0]["program"]["phase"], "running");
    let begun = Instant::now();
    page.done(json!({"do": "stop"}));
    page.until_state("Idle");
    assert!(
        begun.elapsed() < Duration::from_secs(5),
        "{:?}",
        begun.elapsed()
    );
    assert!(broker.start());
    let mut host = Host::new(&broker);
    // The server may have been faster.
    host.ask_for_births();
    let birth = host.until("the server", |one| is(one, "NBIRTH", "mill"));
    assert!(birth.number("bdSeq") > 0.0 && birth.seq == Some(0));
    let machine = host.until("the machine", |one| is(one, "DBIRTH", "mill/machine-1"));
    assert_eq!(machine.text("Program/Phase"), "stopped");
}

#[test]
fn a_machine_and_a_server_that_end_are_told() {
    let Some(broker) = Broker::new("mqtt-end") else {
        return;
    };
    let mut host = Host::new(&broker);
    let device = Emulated::listening("grbl", &[]);
    let served = served(&broker, &["--port", device.port()]);
    host.until("the machine", |one| is(one, "DBIRTH", "mill/machine-1"));
    drop(device);
    host.until("its end", |one| is(one, "DDEATH", "mill/machine-1"));
    let id = served.process.id().to_string();
    Command::new("kill").args(["-INT", &id]).status().unwrap();
    let death = host.until("the end", |one| is(one, "NDEATH", "mill"));
    assert_eq!((death.number("bdSeq"), death.seq), (0.0, None));
}

/// Nothing that is written to the topics of the server ends it or moves its machines.
#[test]
fn what_has_no_sense_is_ignored() {
    let Some(broker) = Broker::new("mqtt-sense") else {
        return;
    };
    let mut host = Host::new(&broker);
    let served = served(&broker, &[]);
    host.until("the machine", |one| is(one, "DBIRTH", "mill/machine-1"));
    for bytes in [
        &b""[..],
        b"{}",
        &[0xFF; 40],
        &[0x12, 200, 1],
        &[0x12, 2, 0x0A, 9],
    ] {
        for topic in [
            "NCMD/mill",
            "DCMD/mill/machine-1",
            "DCMD/mill/machine-9",
            "DCMD/mill/x",
        ] {
            host.write_bytes(&format!("spBv1.0/husillo/{topic}"), bytes.to_vec(), false);
        }
    }
    host.job("one", "G0 X1\n");
    let refused = host.until_job("one", "refused");
    assert!(refused.text("Job/Message").contains("--mqtt-jobs"));
    let page = served.page();
    assert_eq!(page.states[0]["state"], "Alarm");
    assert!(page.states[0]["program"].is_null());
}

/// A broker that asks for a password, and shows a certificate.
#[test]
fn a_broker_with_tls_and_a_password() {
    let rules = "allow_anonymous false\npassword_file FOLDER/users\ncertfile FOLDER/cert.pem\n\
                 keyfile FOLDER/key.pem\n";
    let folder = std::env::temp_dir().join(format!("husillo-mqtt-tls-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (key, certificate) = (folder.join("key.pem"), folder.join("cert.pem"));
    let made = Command::new("openssl")
        .args([
            "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2",
        ])
        .args([
            "-subj",
            "/CN=localhost",
            "-addext",
            "subjectAltName=DNS:localhost",
        ])
        .args(["-addext", "basicConstraints=critical,CA:FALSE", "-keyout"])
        .arg(&key)
        .arg("-out")
        .arg(&certificate)
        .output();
    let users = folder.join("users");
    let noted = Command::new("mosquitto_passwd")
        .args(["-b", "-c"])
        .arg(&users)
        .args(["mill", "secret"])
        .output();
    if made.is_err() || noted.is_err() {
        return eprintln!("skipped: there is no openssl or no mosquitto_passwd");
    }
    let Some(broker) = Broker::with("mqtt-tls", rules) else {
        return;
    };
    let password = folder.join("password");
    let url = format!("mqtts://localhost:{}", broker.port);
    let ca = certificate.to_str().unwrap();
    let server = |password_text: &str, ca: &[&str]| {
        std::fs::write(&password, format!("{password_text}\n")).unwrap();
        let file = password.to_str().unwrap();
        let own = [
            "--mqtt",
            &url,
            "--mqtt-user",
            "mill",
            "--mqtt-password-file",
            file,
        ];
        Served::new(&[&own, ca].concat())
    };
    let told = |served: &Served, text: &str| {
        let mut page = served.page();
        page.until(text, |page| page.has_line(text).then_some(()));
    };
    told(
        &server("secret", &["--mqtt-ca", ca]),
        "the broker is reached",
    );
    told(
        &server("wrong", &["--mqtt-ca", ca]),
        "the broker is not reached: Connection refused",
    );
    // A certificate that nobody has vouched for. A system without certificates has another text.
    if std::path::Path::new("/etc/ssl/certs/ca-certificates.crt").exists() {
        told(&server("secret", &[]), "the broker is not reached: TLS");
    }
}

#[test]
fn arguments_that_have_no_sense_are_refused() {
    let port = format!("mqtt://127.0.0.1:{}", free());
    for (args, why) in [
        (
            &["--mqtt", "mqtt://me:secret@cell"][..],
            "--mqtt-password-file",
        ),
        (&["--mqtt", "http://cell"], "is expected"),
        (&["--mqtt-jobs"], "--mqtt <URL>"),
        (
            &["--mqtt", &port, "--mqtt-jobs", "--watch-only"],
            "cannot be used with",
        ),
        (&["--mqtt", &port, "--mqtt-node", "a/b"], "without / + #"),
        (&["--mqtt", &port, "--mqtt-ca", "x"], "mqtts://"),
        (
            &["--mqtt", &port, "--mqtt-password-file", "/no/such"],
            "/no/such",
        ),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_husillo"))
            .args(["serve", "--listen", "127.0.0.1:0", "--for", "0"])
            .args(args)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.code() == Some(2) && said.contains(why),
            "{args:?}: {said}"
        );
    }
}
