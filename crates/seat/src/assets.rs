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

/// The bytes of this file; none where there is no such file.
pub(crate) fn bytes(name: &str) -> &'static [u8] {
    let found = FILES.iter().find(|(known, ..)| *known == name);
    found.map_or(&[], |(.., bytes)| *bytes)
}

/// The page as a file beside its script and its study, with the policy that the server would send; `sends_to` is where it may send.
pub(crate) fn static_page(sends_to: Option<&str>) -> Vec<u8> {
    let page = String::from_utf8_lossy(bytes("index.html"));
    let policy = format!(
        "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; connect-src 'self' {}; img-src 'self' data:; \
         base-uri 'none'; form-action 'none'",
        sends_to.unwrap_or_default()
    );
    let meta = format!(
        "<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n<meta name=\"referrer\" content=\"no-referrer\">"
    );
    page.replace(
        "<html lang=\"en\">",
        "<html lang=\"en\" data-study=\"study.json\">",
    )
    .replace("<meta charset=\"utf-8\">", &meta)
    .replace("\"/page/", "\"")
    .into_bytes()
}
