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
pub const VIEWER: &[Module] = modules![
    "viewer/camera.js" "viewer/canvas.js" "viewer/charts.js" "viewer/container.js"
    "viewer/element.js" "viewer/look.js" "viewer/material.js" "viewer/modal.js"
    "viewer/model.js" "viewer/overlay.js" "viewer/path.js" "viewer/pathview.js" "viewer/pick.js"
    "viewer/program.js" "viewer/quantity.js" "viewer/report.js" "viewer/rulers.js"
    "viewer/scene.js" "viewer/segments.js" "viewer/stock.js" "viewer/timeline.js"
    "viewer/values.js" "viewer/viewer.js" "viewer/webgl.js" "viewer/words.js"
];

/// The colours of all pages, light and dark.
pub const COLOURS: &str = include_str!("../viewer/colours.css");

/// The layout of the viewer.
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
