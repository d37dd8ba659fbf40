//! The panel of an emulated network.

mod emulated;

use assert_cmd::Command;
use emulated::Emulated;

/// Power that goes and comes back, and a cable that is pulled, at the panel.
#[test]
fn the_panel_of_a_network() {
    let Some(mut network) = Emulated::new("cmm", "network-panel", &[]) else {
        return;
    };
    let port = network.port().to_owned();
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
        network.type_line(off, answer);
        status().code(1);
        network.type_line(on, back);
        status().success();
    }
    network.type_line("close probe", "probe: close");
    network.type_line("fly", "there are close|open|free probe");
}
