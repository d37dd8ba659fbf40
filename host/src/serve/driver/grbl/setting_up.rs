//! The settings of the controller: their meaning, and their changes.

use super::{Driver, Purpose};
use crate::serve::reply::Reply;
use husillo_transports::grbl::{SETTINGS, SettingKind, Settings, State};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Settings, each with its value or with a sentence about it.
type Numbered = Vec<(u16, String)>;

impl Driver<'_> {
    /// All settings with their meaning.
    pub(super) fn settings_list(&self) -> Value {
        let all = self.settings.iter().map(|(number, value)| {
            let known = SETTINGS.iter().find(|one| u16::from(one.number) == *number);
            let (kind, most) = known.map_or(("text", None), |one| limits(one.kind));
            json!({
                "number": number,
                "value": value,
                "name": known.map(|one| one.name),
                "unit": known.map(|one| one.unit),
                "kind": kind,
                "least": known.map(|_| 0),
                "most": most,
                "default": known.map(|one| f64::from(one.default_milli) / 1e3),
            })
        });
        json!({"settings": all.collect::<Vec<_>>()})
    }

    /// What would change, and what the controller has not or would refuse.
    pub(super) fn settings_diff(&self, values: &BTreeMap<u16, String>) -> Value {
        let (changes, refused) = self.compared(values);
        let changes = changes.iter().map(|(number, to)| {
            let known = SETTINGS.iter().find(|one| u16::from(one.number) == *number);
            json!({
                "number": number,
                "from": self.settings.get(number),
                "to": to,
                "name": known.map(|one| one.name),
                "unit": known.map(|one| one.unit),
            })
        });
        let refused = refused
            .iter()
            .map(|(number, why)| json!({"number": number, "why": why}));
        json!({
            "changes": changes.collect::<Vec<_>>(),
            "refused": refused.collect::<Vec<_>>(),
        })
    }

    /// Writes the settings that differ, and reads all back.
    pub(super) fn save_settings(&mut self, values: &BTreeMap<u16, String>, reply: Reply) {
        let (changes, refused) = self.compared(values);
        if let Some((_, why)) = refused.into_iter().next() {
            return reply.error(why);
        }
        if self.running.course.is_active() {
            return reply.error("a program runs");
        }
        // Grbl stores a setting only when it stands.
        if let Err(why) = self.takes_lines() {
            return reply.error(why);
        }
        if !matches!(self.session.state(), Some(State::Idle | State::Alarm)) {
            return reply.error("settings are written while the machine is at rest");
        }
        for (number, value) in changes {
            self.send(format!("${number}={value}"), Purpose::Written);
        }
        self.send("$$", Purpose::Settings(reply));
    }

    /// The changes, and the refused values with the reason.
    fn compared(&self, values: &BTreeMap<u16, String>) -> (Numbered, Numbered) {
        let (mut changes, mut refused) = (Vec::new(), Vec::new());
        for (number, value) in values {
            let value = value.trim();
            match self.judged(*number, value) {
                Err(why) => refused.push((*number, why)),
                Ok(true) => changes.push((*number, value.to_owned())),
                Ok(false) => {}
            }
        }
        (changes, refused)
    }

    /// Whether a value differs from the present one.
    fn judged(&self, number: u16, value: &str) -> Result<bool, String> {
        let present = self.settings.get(&number);
        let present = present.ok_or_else(|| format!("this controller has no setting {number}"))?;
        if value.is_empty() || value.len() > 60 || !value.bytes().all(|b| b.is_ascii_graphic()) {
            return Err(format!("${number}: `{value}` is no value"));
        }
        if value.contains(['!', '?', '~']) {
            return Err(format!(
                "${number}: `{value}` has a letter with a meaning of its own"
            ));
        }
        if let Ok(known) = u8::try_from(number) {
            let is_known = SETTINGS.iter().any(|one| one.number == known);
            // Soft limits need homing, which may be one of the other changes.
            let mut settings = Settings::DEFAULT;
            let written = settings
                .write(22, b"1")
                .and_then(|()| settings.write(known, value.as_bytes()));
            if let (true, Err(error)) = (is_known, written) {
                return Err(format!("${number}={value}: {}", error.text()));
            }
        }
        let same = match (present.parse::<f64>(), value.parse::<f64>()) {
            (Ok(present), Ok(value)) => present == value,
            _ => present == value,
        };
        Ok(!same)
    }
}

/// The kind of a setting as pages get it, and its largest value.
const fn limits(kind: SettingKind) -> (&'static str, Option<u32>) {
    match kind {
        SettingKind::Flag => ("switch", Some(1)),
        SettingKind::Byte => ("whole", Some(255)),
        SettingKind::Mask => ("mask", Some(255)),
        SettingKind::Word => ("whole", Some(65_535)),
        SettingKind::Decimal | SettingKind::Rounded => ("number", Some(4_294_967)),
    }
}
