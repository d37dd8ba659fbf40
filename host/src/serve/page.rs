//! The page and its files.

use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};

/// What the page may load: only from this server.
const POLICY: &str = "default-src 'self'; connect-src 'self'; style-src 'self' 'unsafe-inline'; \
                      script-src 'self' 'unsafe-inline' blob:; img-src 'self' data: blob:; \
                      worker-src 'self' blob:; frame-ancestors 'none'; base-uri 'none'; \
                      form-action 'none'";

/// What a report may load: nothing, and it reaches no server. Its modules are in itself.
pub const REPORT_POLICY: &str = "default-src 'none'; script-src 'unsafe-inline' \
                                 'wasm-unsafe-eval' data:; \
                                 style-src 'unsafe-inline'; img-src data: blob:; \
                                 frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

/// Headers of every answer that has none of its own.
pub fn headers() -> [(HeaderName, HeaderValue); 5] {
    [
        (
            header::CONTENT_SECURITY_POLICY,
            HeaderValue::from_static(POLICY),
        ),
        (
            header::X_CONTENT_TYPE_OPTIONS,
            HeaderValue::from_static("nosniff"),
        ),
        (
            header::REFERRER_POLICY,
            HeaderValue::from_static("no-referrer"),
        ),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
        (header::X_FRAME_OPTIONS, HeaderValue::from_static("DENY")),
    ]
}

/// A file of the page. The empty path is that of the page itself.
pub fn file(path: &str) -> Response {
    let path = if path.is_empty() { "index.html" } else { path };
    match husillo_view::PANEL.iter().find(|file| file.path == path) {
        Some(file) => ([(header::CONTENT_TYPE, file.media_type)], file.bytes).into_response(),
        None => (StatusCode::NOT_FOUND, "there is no such file\n").into_response(),
    }
}
