//! A page that contains its modules.

use crate::Module;
use std::fmt::Write;

/// The parts of a self-contained page. It needs no network, and no other file.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// Language of the static text, such as `en`.
    pub language: &'a str,
    /// Title, as plain text.
    pub title: &'a str,
    /// Style sheets, one after the other.
    pub styles: &'a [&'a str],
    /// Content of the element `body`: HTML.
    pub body: &'a str,
    /// The modules.
    pub modules: &'a [Module],
    /// Path of the module that starts the page.
    pub entry: &'a str,
}

/// Only what the page itself contains is loaded or run.
const POLICY: &str = "default-src 'none';script-src 'unsafe-inline' 'wasm-unsafe-eval' data:;\
                      style-src 'unsafe-inline';img-src data: blob:";

impl Page<'_> {
    /// The page as HTML.
    pub fn html(&self) -> String {
        let mut page = String::from("<!DOCTYPE html>\n");
        let title = text(self.title);
        // Writing to a String cannot fail.
        let _ = write!(
            page,
            "<html lang=\"{}\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
             <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
             <link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n",
            text(self.language)
        );
        for style in self.styles {
            let _ = writeln!(page, "<style>{style}</style>");
        }
        page.push_str(&import_map(self.modules));
        let _ = write!(
            page,
            "</head>\n<body>\n{}<script type=\"module\">import \"husillo/{}\"</script>\n\
             </body>\n</html>\n",
            self.body, self.entry
        );
        page
    }
}

/// The element that gives the modules their names. It stands before the first module script.
pub fn import_map(modules: &[Module]) -> String {
    let mut map = String::from("<script type=\"importmap\">{\"imports\":{");
    for (index, module) in modules.iter().enumerate() {
        let comma = if index == 0 { "" } else { "," };
        let _ = write!(map, "{comma}\n\"husillo/{}\":\"", module.path);
        map.push_str("data:text/javascript;charset=utf-8,");
        for character in module.source.chars() {
            escape(&mut map, character);
        }
        map.push('"');
    }
    map.push_str("\n}}</script>\n");
    map
}

/// Writes a character of a module into a `data:` address in a JSON string in a script element.
fn escape(map: &mut String, character: char) {
    match character {
        // They end or change an address, a JSON string, or the element.
        '%' | '#' | '"' | '\\' | '<' | '\n' | '\r' | '\t' | '\0'..='\x1f' => {
            let _ = write!(map, "%{:02X}", u32::from(character));
        }
        _ => map.push(character),
    }
}

/// Plain text as HTML.
fn text(plain: &str) -> String {
    let plain = plain.replace('&', "&amp;").replace('<', "&lt;");
    plain.replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODULE: Module = Module {
        path: "viewer/a.js",
        source: "const a = '</script>' // 100 % \"é\\n\" #1\n",
    };

    #[test]
    fn a_module_cannot_leave_its_string() {
        let map = import_map(&[MODULE]);
        let inner = map.strip_prefix("<script type=\"importmap\">").unwrap();
        let inner = inner.strip_suffix("</script>\n").unwrap();
        assert!(!inner.contains('<'), "{inner}");
        assert_eq!(inner.matches('"').count(), 6, "{inner}");
        assert!(inner.contains("const a = '%3C/script>' // 100 %25 %22é%5Cn%22 %231%0A"));
    }

    #[test]
    fn the_title_is_plain_text() {
        let page = Page {
            language: "en",
            title: "</title><b>",
            styles: &["p{}"],
            body: "<p>",
            modules: &[MODULE],
            entry: "viewer/a.js",
        };
        let html = page.html();
        assert!(html.contains("<title>&lt;/title&gt;&lt;b&gt;</title>"));
        assert!(html.contains("import \"husillo/viewer/a.js\""));
    }
}
