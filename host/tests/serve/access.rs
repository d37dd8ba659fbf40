//! Who is let in.

use super::page::Served;
use std::time::{Duration, Instant};

#[test]
fn the_page_needs_no_token_and_may_load_only_from_here() {
    let served = Served::new(&[]);
    let page = served.get("/", "");
    assert!(page.starts_with("HTTP/1.1 200"), "{page}");
    let head = page.to_lowercase();
    for header in [
        "content-security-policy: default-src 'self'",
        "content-type: text/html",
        "x-content-type-options: nosniff",
    ] {
        assert!(head.contains(header), "{header}");
    }
    assert!(!page.contains(&served.token));
    assert!(served.get("/no/such/file", "").starts_with("HTTP/1.1 404"));
}

#[test]
fn machines_need_the_token() {
    let served = Served::new(&[]);
    for (headers, status) in [
        ("", "403"),
        ("Authorization: Bearer 0123\r\n", "403"),
        (
            &format!("Authorization: Bearer {}\r\n", served.token),
            "200",
        ),
    ] {
        let answer = served.get("/machines", headers);
        assert!(
            answer.starts_with(&format!("HTTP/1.1 {status}")),
            "{answer}"
        );
    }
    let upgrade = "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
                   Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
    let with = |path: &str, more: &str| {
        let host = &served.address;
        served.http(&format!(
            "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: upgrade, close\r\n\
             {upgrade}{more}\r\n"
        ))
    };
    assert!(with("/socket", "").starts_with("HTTP/1.1 403"));
    assert!(with("/socket?token=0", "").starts_with("HTTP/1.1 403"));
    let path = format!("/socket?token={}", served.token);
    let other = with(&path, "Origin: http://evil.example\r\n");
    assert!(other.starts_with("HTTP/1.1 403"), "{other}");
}

#[test]
fn other_hosts_are_refused() {
    let served = Served::new(&["--host", "mill.lan"]);
    for (host, status) in [
        ("evil.example", "421"),
        ("127.0.0.1:1", "421"),
        ("mill.lan", "200"),
    ] {
        let answer = served.http(&format!(
            "GET / HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"
        ));
        assert!(
            answer.starts_with(&format!("HTTP/1.1 {status}")),
            "{answer}"
        );
    }
}

#[test]
fn the_first_state_arrives_within_a_second() {
    let served = Served::new(&[]);
    // The controller may have to start first.
    drop(served.page());
    let begun = Instant::now();
    let page = served.page();
    let time = begun.elapsed();
    assert_eq!(page.states[0]["state"], "Alarm");
    assert!(time < Duration::from_secs(1), "{time:?}");
}
