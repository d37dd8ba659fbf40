//! The file of devices of the agent. It has exactly the items that the adapter sends.

use super::items::{Component, Item, axes, items};
use serde_json::Value;
use std::fmt::Write as _;

/// The version of MTConnect whose schema the file follows.
const SCHEMA: &str = "urn:mtconnect.org:MTConnectDevices:2.0";
/// Where that schema is.
const LOCATION: &str = "http://schemas.mtconnect.org/schemas/MTConnectDevices_2.0.xsd";

/// The file for machines that are described like this. `host` makes their identifiers unique.
pub fn document(machines: &[Value], host: &str) -> String {
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <MTConnectDevices xmlns=\"{SCHEMA}\"\n    \
         xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\"\n    \
         xsi:schemaLocation=\"{SCHEMA} {LOCATION}\">\n  \
         <Header creationTime=\"2026-01-01T00:00:00Z\" sender=\"husillo\" instanceId=\"1\"\n      \
         version=\"2.0.0.0\" assetBufferSize=\"1\" assetCount=\"0\" bufferSize=\"1\"\n      \
         deviceModelChangeTime=\"2026-01-01T00:00:00Z\"/>\n  <Devices>\n",
    );
    for machine in machines {
        device(&mut text, machine, host);
    }
    text.push_str("  </Devices>\n</MTConnectDevices>\n");
    text
}

fn device(text: &mut String, machine: &Value, host: &str) {
    let number = &machine["machine"];
    let port = escaped(machine["port"].as_str().unwrap_or_default());
    let all = items(machine);
    let of = |component| -> Vec<&Item> {
        all.iter()
            .filter(|item| item.component == component)
            .collect()
    };
    let id = |part: &str| format!("m{number}_{part}");
    // Writing to a text does not fail.
    let _ = writeln!(
        text,
        "    <Device id=\"{}\" name=\"machine-{number}\" uuid=\"{}-machine-{number}\">\n      \
         <Description>{port}</Description>",
        id("device"),
        escaped(host),
    );
    data_items(text, 6, number, &of(Component::Device));
    text.push_str("      <Components>\n");
    let _ = writeln!(
        text,
        "        <Axes id=\"{}\">\n          <Components>",
        id("axes")
    );
    for (axis, letter) in axes(machine).into_iter().enumerate() {
        let letter = escaped(letter);
        let own: Vec<_> = of(Component::Axis)
            .into_iter()
            .filter(|one| one.axis == axis)
            .collect();
        component(text, 12, "Linear", (&id(&letter), Some(&letter)), |text| {
            data_items(text, 14, number, &own);
        });
    }
    component(text, 12, "Rotary", (&id("spindle"), Some("S")), |text| {
        data_items(text, 14, number, &of(Component::Spindle));
    });
    text.push_str("          </Components>\n        </Axes>\n");
    component(text, 8, "Controller", (&id("controller"), None), |text| {
        data_items(text, 10, number, &of(Component::Controller));
        text.push_str("          <Components>\n");
        component(text, 12, "Path", (&id("path"), Some("path")), |text| {
            data_items(text, 14, number, &of(Component::Path));
        });
        text.push_str("          </Components>\n");
    });
    text.push_str("      </Components>\n    </Device>\n");
}

fn component(
    text: &mut String,
    indent: usize,
    kind: &str,
    (id, name): (&str, Option<&str>),
    content: impl FnOnce(&mut String),
) {
    let name = name.map_or_else(String::new, |name| format!(" name=\"{name}\""));
    let _ = writeln!(text, "{:indent$}<{kind} id=\"{id}\"{name}>", "");
    content(text);
    let _ = writeln!(text, "{:indent$}</{kind}>", "");
}

fn data_items(text: &mut String, indent: usize, number: &Value, items: &[&Item]) {
    let _ = writeln!(text, "{:indent$}<DataItems>", "");
    for item in items {
        let _ = write!(
            text,
            "{:indent$}  <DataItem id=\"m{number}_{key}\" name=\"{key}\" category=\"{}\" \
             type=\"{}\"",
            "",
            item.category,
            item.kind,
            key = item.key,
        );
        for (name, value) in item.attributes {
            let _ = write!(text, " {name}=\"{value}\"");
        }
        text.push_str("/>\n");
    }
    let _ = writeln!(text, "{:indent$}</DataItems>", "");
}

fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars().filter(|c| !c.is_control()) {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_item_is_once_in_the_file() {
        let machine = |number| json!({"machine": number, "port": "a<&b", "axes": ["X", "Y", "Z"]});
        let text = document(&[machine(1), machine(2)], "mill");
        for number in [1, 2] {
            for item in items(&machine(number)) {
                let id = format!("<DataItem id=\"m{number}_{}\"", item.key);
                assert_eq!(text.matches(&id).count(), 1, "{id}");
            }
        }
        assert!(text.contains("<Description>a&lt;&amp;b</Description>"));
        assert!(text.contains("uuid=\"mill-machine-2\""));
        for element in [
            "Device",
            "Axes",
            "Linear",
            "Rotary",
            "Controller",
            "Path",
            "DataItems",
        ] {
            let (open, close) = (format!("<{element}"), format!("</{element}>"));
            let opened = text.matches(&format!("{open} ")).count()
                + text.matches(&format!("{open}>")).count();
            assert_eq!(opened, text.matches(&close).count(), "{element}");
        }
    }
}
