//! Pages that the server writes itself, and the forms in them.

use crate::{assets, sheet::is_text, words::Words};
use axum::{
    http::{StatusCode, header},
    response::{IntoResponse, Response},
};

/// A page in the study's language.
pub(crate) fn html(words: &Words, body: &str) -> Response {
    let page = format!(
        "<!doctype html><html lang=\"{}\"><meta charset=\"utf-8\"><title>{}</title>\
         <link rel=\"stylesheet\" href=\"{}\"><main>{body}</main></html>",
        words.language,
        words.plain("lab_title", &[]),
        assets::address("page.css")
    );
    ([(header::CONTENT_TYPE, "text/html; charset=utf-8")], page).into_response()
}

/// The same under a heading, with the way back to the experimenter's page.
pub(crate) fn html_with_way_back(words: &Words, heading: &str, body: &str) -> Response {
    let back = words.plain("back", &[]);
    let body = format!("<h1>{heading}</h1>{body}<p><a href=\"/lab\">{back}</a></p>");
    html(words, &body)
}

/// A field of a form, as browsers encode it, less what is no text.
pub(crate) fn form_field(body: &[u8], name: &str) -> Option<String> {
    let text = std::str::from_utf8(body).ok()?;
    let field = text.split('&').find_map(|f| f.strip_prefix(name)?.strip_prefix('='))?;
    let mut bytes = Vec::new();
    let mut rest = field.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'+' => b' ',
            b'%' => {
                let digits = [rest.next()?, rest.next()?];
                u8::from_str_radix(std::str::from_utf8(&digits).ok()?, 16).ok()?
            }
            plain => plain,
        });
    }
    let mut text = String::from_utf8(bytes).ok()?;
    text.retain(is_text);
    Some(text)
}

/// Back to the experimenter's page.
pub(crate) fn to_lab() -> Response {
    (StatusCode::SEE_OTHER, [(header::LOCATION, "/lab")]).into_response()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_form_is_read_as_browsers_write_it() {
        let given = |body: &str| form_field(body.as_bytes(), "password");
        assert_eq!(given("password=a%26b+c").as_deref(), Some("a&b c"));
        assert_eq!(given("other=1&password=x").as_deref(), Some("x"));
        assert_eq!(given("password=%zz"), None);
        assert_eq!(given("password=a%00b%0D%0Ac").as_deref(), Some("ab\nc"));
    }
}
