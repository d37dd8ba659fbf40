//! The files of the operator's panel.

/// A file of the operator's panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Asset {
    /// Its path from the address of the panel, such as `panel/main.js`.
    pub path: &'static str,
    /// Its media type, such as `text/javascript; charset=utf-8`.
    pub media_type: &'static str,
    /// Its content.
    pub bytes: &'static [u8],
}

/// A file at its path in this package.
macro_rules! asset {
    ($path:literal, $media_type:expr) => {
        Asset {
            path: $path,
            media_type: $media_type,
            bytes: include_bytes!(concat!("../", $path)),
        }
    };
}

/// The page, the style sheets and the picture, then the modules of these paths.
macro_rules! assets {
    ($($module:literal)*) => {
        &[
            Asset {
                path: "index.html",
                media_type: HTML,
                bytes: include_bytes!("../panel/index.html"),
            },
            Asset {
                path: "favicon.svg",
                media_type: "image/svg+xml",
                bytes: include_bytes!("../panel/favicon.svg"),
            },
            asset!("viewer/colours.css", CSS),
            asset!("viewer/viewer.css", CSS),
            asset!("panel/panel.css", CSS),
            $(asset!($module, SCRIPT)),*
        ]
    };
}

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// The operator's panel: `index.html`, and every file that it loads. A server sends them at their
/// paths from one address, and `index.html` at that address itself. Their addresses are relative.
pub const PANEL: &[Asset] = assets![
    "panel/by_hand.js" "panel/change.js" "panel/console.js" "panel/desk.js" "panel/drill.js"
    "panel/drill_board.js" "panel/drill_hand.js" "panel/english.js" "panel/factory.js"
    "panel/factory_hand.js" "panel/fixes.js" "panel/gamepad.js" "panel/header.js"
    "panel/height_grid.js" "panel/height_map.js" "panel/hold.js" "panel/jog.js" "panel/joystick.js"
    "panel/keys.js" "panel/line_state.js" "panel/link.js" "panel/macros.js" "panel/main.js"
    "panel/measuring.js" "panel/mill.js" "panel/mill_jog.js" "panel/mill_plot.js"
    "panel/notices.js" "panel/page.js" "panel/positions.js" "panel/preview.js" "panel/probing.js"
    "panel/program.js" "panel/rig.js" "panel/routine.js" "panel/routine_drawing.js" "panel/run.js"
    "panel/settings.js" "panel/spanish.js" "panel/speeds.js" "panel/states.js" "panel/stop.js"
    "panel/tabs.js" "panel/tool_change.js" "panel/units.js" "panel/wizard.js" "panel/words.js"
    "viewer/camera.js" "viewer/canvas.js" "viewer/charts.js" "viewer/container.js"
    "viewer/element.js" "viewer/look.js" "viewer/material.js" "viewer/modal.js" "viewer/model.js"
    "viewer/overlay.js" "viewer/path.js" "viewer/pathview.js" "viewer/pick.js" "viewer/program.js"
    "viewer/quantity.js" "viewer/rulers.js" "viewer/scene.js" "viewer/segments.js" "viewer/stock.js"
    "viewer/timeline.js" "viewer/values.js" "viewer/viewer.js" "viewer/webgl.js" "viewer/words.js"
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::Path;

    #[test]
    fn every_module_of_both_folders_is_there() {
        let mut files = BTreeSet::new();
        for name in ["viewer", "panel"] {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
            for entry in std::fs::read_dir(folder).unwrap() {
                let file = entry.unwrap().file_name().into_string().unwrap();
                if file.ends_with(".js") || file.ends_with(".css") {
                    files.insert(format!("{name}/{file}"));
                }
            }
        }
        let listed: BTreeSet<String> = PANEL.iter().map(|asset| asset.path.into()).collect();
        assert_eq!(listed.len(), PANEL.len(), "a path twice");
        let both = &listed & &files;
        // The module that starts a report is the only one that the panel does not need.
        let left_out: Vec<_> = files.difference(&both).collect();
        assert_eq!(left_out, ["viewer/report.js"]);
        let others: Vec<_> = listed.difference(&both).collect();
        assert_eq!(others, ["favicon.svg", "index.html"]);
    }

    #[test]
    fn the_page_loads_only_files_that_are_there() {
        let page = std::str::from_utf8(PANEL[0].bytes).unwrap();
        assert!(!page.contains("http"), "{page}");
        let mut loaded = 0;
        for name in ["href=\"", "src=\""] {
            for part in page.split(name).skip(1) {
                let path = part.split('"').next().unwrap();
                assert!(PANEL.iter().any(|asset| asset.path == path), "{path}");
                loaded += 1;
            }
        }
        assert_eq!(loaded, 5);
    }
}
