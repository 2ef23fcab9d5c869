//! Command lines as a person would type them.

/// The words joined by spaces, each quoted for a POSIX shell where it needs to be.
pub(crate) fn quoted<S: AsRef<str>>(words: impl IntoIterator<Item = S>) -> String {
    let words: Vec<String> = words.into_iter().map(|w| quoted_word(w.as_ref())).collect();
    words.join(" ")
}

fn quoted_word(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%^".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_words_that_need_it_are_quoted() {
        let words = ["sh", "-c", "echo it's > a/b.csv", ""];
        assert_eq!(quoted(words), r"sh -c 'echo it'\''s > a/b.csv' ''");
    }
}
