//! The panel of an emulated chain.

mod emulated;

use assert_cmd::Command;
use emulated::Emulated;

/// Power that goes and comes back, and a cable that is pulled, at the panel.
#[test]
fn the_panel_of_a_chain() {
    let Some(mut chain) = Emulated::new("cmm", "chain-panel", &[]) else {
        return;
    };
    let port = chain.port().to_owned();
    let status = || {
        let mut command = Command::cargo_bin("husillo").unwrap();
        command.args(["measure", "-m", "cmm", "--port", &port, "status"]);
        command.assert()
    };
    status().success();
    for (off, answer, on, back) in [
        ("power off", "is off", "power on", "is on"),
        ("unplug", "unplugged", "plug", "plugged in"),
    ] {
        chain.type_line(off, answer);
        status().code(1);
        chain.type_line(on, back);
        status().success();
    }
    chain.type_line("close probe", "probe: close");
    chain.type_line("fly", "there are close|open|free probe");
}
