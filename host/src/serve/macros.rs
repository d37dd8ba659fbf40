//! Macros: lines with a name, in a file of the user.

use super::request::Request;
use crate::app::sendable_lines;
use crate::input;
use crate::output::Outputs;
use husillo_simulator::text::name;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// Macros in a file.
const MOST: usize = 200;
/// Longest name, characters.
const LONGEST_NAME: usize = 60;
/// Longest text, bytes.
const LONGEST_TEXT: usize = 16 * 1024;

/// Lines with a name.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Macro {
    /// Its name.
    pub name: String,
    /// Its lines.
    pub text: String,
}

/// The file with the macros. It is read again for each request, so that it can be edited meanwhile.
#[derive(Debug)]
pub struct MacroFile {
    /// Its path, as the text of a name.
    path: String,
    /// Its folder, if this is the file of the user: it is made with the file.
    folder: Option<PathBuf>,
    /// Held while the file is changed.
    changing: Mutex<()>,
}

/// What is in the file.
#[derive(Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Content {
    #[serde(default, rename = "macro")]
    macros: Vec<Macro>,
}

impl MacroFile {
    /// This file, or that of the user: `husillo/macros.toml` in the folder of configurations.
    ///
    /// # Errors
    ///
    /// The file is no list of macros, or the user has no such folder.
    pub fn new(path: Option<&str>) -> Result<Self, String> {
        let (path, folder) = match path {
            Some(path) => (path.to_owned(), None),
            None => {
                let why = "where the configuration is kept is not known: add --macros FILE";
                let folder = folder().ok_or(why)?.join("husillo");
                (
                    name::text(folder.join("macros.toml").as_os_str()),
                    Some(folder),
                )
            }
        };
        let file = Self {
            path,
            folder,
            changing: Mutex::default(),
        };
        file.list()?;
        Ok(file)
    }

    /// Carries out a request of a page. The data of the answer are all macros.
    ///
    /// # Errors
    ///
    /// A sentence about the macro or the file.
    pub fn carry_out(&self, request: &Request) -> Result<Value, String> {
        let _changing = self.changing.lock().unwrap_or_else(PoisonError::into_inner);
        let all = match request {
            Request::MacroSave { name, text } => self.save(name, text),
            Request::MacroDelete { name } => self.delete(name),
            _ => self.list(),
        };
        all.map(|all| json!(all))
    }

    /// All macros. A file that is not there has none.
    ///
    /// # Errors
    ///
    /// A sentence about the file.
    pub fn list(&self) -> Result<Vec<Macro>, String> {
        let text = match input::read_to_string(&self.path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(self.named(error)),
        };
        let content: Content = toml::from_str(&text).map_err(|error| self.named(error))?;
        Ok(content.macros)
    }

    /// The lines of a macro, as the controller gets them.
    ///
    /// # Errors
    ///
    /// There is no such macro, or one of its lines cannot be sent.
    pub fn lines(&self, name: &str) -> Result<Vec<String>, String> {
        let all = self.list()?;
        let found = all.iter().find(|one| one.name == name);
        lines(
            &found
                .ok_or_else(|| format!("there is no macro `{name}`"))?
                .text,
        )
    }

    /// Adds a macro, or replaces that of this name. Returns all.
    ///
    /// # Errors
    ///
    /// The macro cannot be sent, or the file cannot be written.
    pub fn save(&self, name: &str, text: &str) -> Result<Vec<Macro>, String> {
        let name = name.trim();
        let length = name.chars().count();
        if !(1..=LONGEST_NAME).contains(&length) || name.chars().any(char::is_control) {
            return Err(format!("a name has 1 to {LONGEST_NAME} characters"));
        }
        lines(text)?;
        let mut all = self.list()?;
        let made = Macro {
            name: name.to_owned(),
            text: text.to_owned(),
        };
        match all.iter().position(|one| one.name == name) {
            Some(at) => all[at] = made,
            None if all.len() >= MOST => return Err(format!("there are {MOST} macros already")),
            None => all.push(made),
        }
        self.write(all)
    }

    /// Removes a macro. Returns all others.
    ///
    /// # Errors
    ///
    /// There is no such macro, or the file cannot be written.
    pub fn delete(&self, name: &str) -> Result<Vec<Macro>, String> {
        let mut all = self.list()?;
        let before = all.len();
        all.retain(|one| one.name != name);
        match all.len() < before {
            true => self.write(all),
            false => Err(format!("there is no macro `{name}`")),
        }
    }

    /// Replaces the file.
    fn write(&self, macros: Vec<Macro>) -> Result<Vec<Macro>, String> {
        let content = Content { macros };
        let text = toml::to_string_pretty(&content).map_err(|error| self.named(error))?;
        if let Some(folder) = &self.folder {
            fs::create_dir_all(folder).map_err(|error| self.named(error))?;
        }
        // It replaces the file that was read.
        let mut outputs = Outputs::rewriting();
        let written = outputs.write(&self.path, text.as_bytes());
        let written = written.and_then(|()| outputs.finish());
        written.map_err(|error| error.to_string())?;
        Ok(content.macros)
    }

    fn named(&self, error: impl std::fmt::Display) -> String {
        format!("{}: {error}", self.path)
    }
}

/// The folder of configurations of the user.
fn folder() -> Option<PathBuf> {
    let of = |name| std::env::var_os(name).map(PathBuf::from);
    let is_absolute = |path: &PathBuf| path.is_absolute();
    if cfg!(windows) {
        return of("APPDATA").filter(is_absolute);
    }
    of("XDG_CONFIG_HOME")
        .filter(is_absolute)
        .or_else(|| Some(of("HOME").filter(is_absolute)?.join(".config")))
}

/// The lines of a text, as the controller gets them.
fn lines(text: &str) -> Result<Vec<String>, String> {
    if text.len() > LONGEST_TEXT {
        return Err(format!("a macro has at most {LONGEST_TEXT} bytes"));
    }
    let lines = sendable_lines(text.as_bytes())?;
    let is_plain = |c: char| (c.is_ascii_graphic() || c == ' ') && !"!?~".contains(c);
    if let Some((number, _)) = lines.iter().find(|(_, line)| !line.chars().all(is_plain)) {
        return Err(format!("line {number}: ASCII without ! ? ~ is expected"));
    }
    match lines.is_empty() {
        true => Err("the macro has no commands".into()),
        false => Ok(lines.into_iter().map(|(_, line)| line).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn macros_are_kept_in_a_file() {
        let folder = std::env::temp_dir().join(format!("husillo-macros-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("deep").join("macros.toml");
        let path = path.to_str().unwrap();
        let file = MacroFile::new(Some(path)).unwrap();
        assert_eq!(file.list(), Ok(Vec::new()));
        file.save("Park", "G53 G0 Z0 (up)\n\nG53 G0 X-5 Y-5\n")
            .unwrap();
        file.save(" Lift ", "$H").unwrap();
        assert_eq!(file.lines("Park").unwrap(), ["G53G0Z0", "G53G0X-5Y-5"]);
        assert_eq!(file.save("Park", "G0X1").unwrap().len(), 2);
        // Another one reads the same.
        let other = MacroFile::new(Some(path)).unwrap();
        assert_eq!(other.lines("Park").unwrap(), ["G0X1"]);
        assert!(fs::read_to_string(path).unwrap().starts_with("[[macro]]"));
        assert_eq!(other.delete("Park").unwrap()[0].name, "Lift");
        assert!(file.delete("Park").is_err() && file.lines("Park").is_err());
        let far = "G1".repeat(50);
        for (name, text) in [
            ("", "G0"),
            ("a\nb", "G0"),
            ("a", "(no)"),
            ("a", "G0?"),
            ("a", &far),
        ] {
            assert!(file.save(name, text).is_err(), "{name} {text}");
        }
        fs::write(path, "[[macro]]\nnaem = \"x\"\n").unwrap();
        assert!(MacroFile::new(Some(path)).unwrap_err().contains("naem"));
        fs::remove_dir_all(&folder).unwrap();
    }
}
