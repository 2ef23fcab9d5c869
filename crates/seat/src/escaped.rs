//! Text in pages.

/// Text that cannot become markup.
pub(crate) fn plain(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_stays_text() {
        assert_eq!(plain("<b title=\"&\">"), "&lt;b title=&quot;&amp;&quot;&gt;");
    }
}
