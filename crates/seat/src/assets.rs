//! The built page: packed once, and named by what it holds, so that a browser keeps it until it changes.

use crate::words::Words;
use axum::{
    http::{HeaderMap, HeaderValue, StatusCode, header},
    response::{IntoResponse, Response},
};
use flate2::{Compression, write::GzEncoder};
use std::{io::Write as _, sync::LazyLock};

/// Name, kind and bytes of each file.
const FILES: [(&str, &str, &[u8]); 6] = [
    ("index.html", "text/html; charset=utf-8", include_bytes!("../page/built/index.html")),
    ("page.css", "text/css; charset=utf-8", include_bytes!("../page/built/page.css")),
    ("page.js", "text/javascript; charset=utf-8", include_bytes!("../page/built/page.js")),
    ("seat.wasm", "application/wasm", include_bytes!("../page/built/seat.wasm")),
    ("sheet.js", "text/javascript; charset=utf-8", include_bytes!("../page/built/sheet.js")),
    ("lab.js", "text/javascript; charset=utf-8", include_bytes!("../page/lab.js")),
];

/// Digits of the digest by which the files are named.
const DIGITS: usize = 16;
/// How long a browser may keep a file whose name says what it holds.
const KEPT: &str = "public, max-age=31536000, immutable";

/// What the files are named by.
static VERSION: LazyLock<String> = LazyLock::new(|| {
    let mut content = Vec::new();
    for (name, _, bytes) in FILES {
        content.extend_from_slice(name.as_bytes());
        content.extend_from_slice(bytes);
    }
    let mut digest = crate::token::digest(&content);
    digest.truncate(DIGITS);
    digest
});

/// The files packed, those that get smaller by it.
static PACKED: LazyLock<Vec<(&str, Vec<u8>)>> = LazyLock::new(|| {
    let packed = FILES.iter().filter_map(|(name, _, bytes)| {
        let mut packer = GzEncoder::new(Vec::new(), Compression::best());
        packer.write_all(bytes).ok()?;
        let packed = packer.finish().ok()?;
        (packed.len() < bytes.len()).then_some((*name, packed))
    });
    packed.collect()
});

/// Where a page finds this file.
pub(crate) fn address(name: &str) -> String {
    format!("/page/{}/{name}", *VERSION)
}

/// Where the page says its language, and where its sentences begin.
const HTML: &str = "<html lang=\"en\">";
const WORDS: &str = "<script id=\"words\" type=\"application/json\">";

/// The page that everybody with a link opens.
pub(crate) fn page(words: &Words) -> Response {
    let page = String::from_utf8_lossy(bytes("index.html"));
    let sentences = format!("{WORDS}{}", words.for_page());
    let page = page
        .replace(HTML, &format!("<html lang=\"{}\">", words.language))
        .replace(WORDS, &sentences)
        .replace("\"/page/", &format!("\"{}", address("")));
    ([(header::CONTENT_TYPE, "text/html; charset=utf-8")], page).into_response()
}

/// The file of this name, if it is one of this version; packed for who takes it so.
pub(crate) fn answer((version, name): (&str, &str), asked: &HeaderMap) -> Response {
    let file = FILES.iter().find(|(known, ..)| *known == name);
    let Some((_, kind, bytes)) = file.filter(|_| version == *VERSION) else {
        return (StatusCode::NOT_FOUND, "no such file").into_response();
    };
    let headers = [
        (header::CONTENT_TYPE, *kind),
        (header::CACHE_CONTROL, KEPT),
        (header::VARY, "accept-encoding"),
    ];
    let packed = PACKED.iter().find(|(known, _)| *known == name);
    match packed.filter(|_| takes_gzip(asked)) {
        Some((_, packed)) => {
            let mut response = (headers, packed.as_slice()).into_response();
            let coding = HeaderValue::from_static("gzip");
            response.headers_mut().insert(header::CONTENT_ENCODING, coding);
            response
        }
        None => (headers, *bytes).into_response(),
    }
}

fn takes_gzip(headers: &HeaderMap) -> bool {
    let values = headers.get_all(header::ACCEPT_ENCODING).iter();
    let mut words = values.filter_map(|v| v.to_str().ok()).flat_map(|v| v.split(','));
    words.any(|word| {
        let mut parts = word.split(';').map(str::trim);
        parts.next() == Some("gzip") && !parts.any(|p| p == "q=0" || p == "q=0.0")
    })
}

/// The bytes of this file; none where there is no such file.
pub(crate) fn bytes(name: &str) -> &'static [u8] {
    let file = FILES.iter().find(|(known, ..)| *known == name);
    file.map_or(&[], |(.., bytes)| *bytes)
}
