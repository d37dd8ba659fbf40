//! Writes a page that has the viewer's modules and styles in it, and shows an empty scene.
//!
//! ```sh
//! cargo run -p husillo-view --example viewer_page -- viewer.html
//! ```

use husillo_view::{COLOURS, Page, VIEWER, VIEWER_STYLE};

fn main() -> std::io::Result<()> {
    let file = match std::env::args_os().nth(1) {
        Some(file) => file.into(),
        None => std::env::temp_dir().join("husillo-viewer.html"),
    };
    let page = Page {
        language: "en",
        title: "A part",
        styles: &[COLOURS, VIEWER_STYLE],
        body: "<main><h1>A part</h1><div id=\"viewer\"></div></main>\n",
        modules: VIEWER,
        entry: "viewer/quantity.js",
    };
    let html = page.html();
    std::fs::write(&file, &html)?;
    println!(
        "{}: {} modules, {} bytes",
        file.display(),
        VIEWER.len(),
        html.len()
    );
    Ok(())
}
