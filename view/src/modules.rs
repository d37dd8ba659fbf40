//! The files of the viewer.

/// A module: an ES module, imported by the name `husillo/` and its path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Module {
    /// Its path in this package, such as `viewer/quantity.js`.
    pub path: &'static str,
    /// Its source.
    pub source: &'static str,
}

/// The modules of these paths.
macro_rules! modules {
    ($($path:literal)*) => {
        &[$(Module { path: $path, source: include_str!(concat!("../", $path)) }),*]
    };
}

/// The modules of the viewer.
pub const VIEWER: &[Module] = modules!["viewer/quantity.js"];

/// The style sheet of the viewer.
pub const VIEWER_STYLE: &str = include_str!("../viewer/viewer.css");

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::Path;

    #[test]
    fn every_module_in_the_folder_is_listed() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("viewer");
        let mut files = BTreeSet::new();
        for entry in std::fs::read_dir(folder).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            if name.ends_with(".js") {
                files.insert(format!("viewer/{name}"));
            }
        }
        let listed: BTreeSet<String> = VIEWER.iter().map(|module| module.path.into()).collect();
        assert_eq!(listed, files);
    }
}
