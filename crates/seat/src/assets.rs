//! The built page.

use axum::{
    http::{StatusCode, header},
    response::{IntoResponse, Response},
};

/// Name, kind and bytes of each file.
const FILES: [(&str, &str, &[u8]); 4] = [
    (
        "index.html",
        "text/html; charset=utf-8",
        include_bytes!("../page/built/index.html"),
    ),
    (
        "page.css",
        "text/css; charset=utf-8",
        include_bytes!("../page/built/page.css"),
    ),
    (
        "page.js",
        "text/javascript; charset=utf-8",
        include_bytes!("../page/built/page.js"),
    ),
    (
        "seat.wasm",
        "application/wasm",
        include_bytes!("../page/built/seat.wasm"),
    ),
];

/// The file of this name, if there is one.
pub(crate) fn answer(name: &str) -> Response {
    match FILES.iter().find(|(known, ..)| *known == name) {
        Some((_, kind, bytes)) => ([(header::CONTENT_TYPE, *kind)], *bytes).into_response(),
        None => (StatusCode::NOT_FOUND, "no such file").into_response(),
    }
}
