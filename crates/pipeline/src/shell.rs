//! Command lines and scripts of a POSIX shell.

/// The words joined by spaces, each quoted where it needs to be for the shell that people type into here: a POSIX shell, on
/// Windows `cmd` (and `PowerShell`, unless a word has `$` or a backquote in it).
///
/// # Example
/// ```
/// use maveric_pipeline::command_line;
/// let quoted = if cfg!(windows) { "\"it is\"" } else { "'it is'" };
/// assert_eq!(command_line(["echo", "it is", "a/b.csv"]), format!("echo {quoted} a/b.csv"));
/// ```
pub fn typed<S: AsRef<str>>(words: impl IntoIterator<Item = S>) -> String {
    if !cfg!(windows) {
        return quoted(words);
    }
    let word = |word: S| match word.as_ref() {
        plain
            if !plain.is_empty()
                && is_plain(&plain.replace('\\', "/"))
                && !plain.contains(['%', '^']) =>
        {
            plain.to_owned()
        }
        word => format!("\"{}\"", word.replace('"', "\\\"")),
    };
    let words: Vec<String> = words.into_iter().map(word).collect();
    words.join(" ")
}

/// The words joined by spaces, each quoted for a POSIX shell where it needs to be, whatever the system: ledgers and scripts.
pub(crate) fn quoted<S: AsRef<str>>(words: impl IntoIterator<Item = S>) -> String {
    let words: Vec<String> = words.into_iter().map(|w| quoted_word(w.as_ref())).collect();
    words.join(" ")
}

fn quoted_word(word: &str) -> String {
    if !word.is_empty() && is_plain(word) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// Whether a shell takes every character for itself.
fn is_plain(word: &str) -> bool {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%^".contains(c);
    word.chars().all(plain)
}

const SHELLS: [&str; 6] = ["sh", "bash", "dash", "ash", "ksh", "zsh"];

/// Whether the word after these of a command line is a shell's script: `sh -c`, `bash -eu -c`.
pub(crate) fn is_script<'a>(before: impl Iterator<Item = &'a str>) -> bool {
    let mut shell = false;
    let (mut has_c, mut skip) = (false, false);
    for word in before {
        let name = word.rsplit('/').next().unwrap_or(word);
        if SHELLS.contains(&name) {
            (shell, has_c, skip) = (true, false, false);
        } else if skip {
            skip = false; // what `-o` takes
        } else if let Some(flags) = word.strip_prefix(['-', '+']).filter(|f| !f.is_empty()) {
            has_c |= !flags.starts_with('-') && flags.contains('c');
            skip = !flags.starts_with('-') && flags.ends_with(['o', 'O']);
        } else {
            shell = false;
        }
    }
    shell && has_c && !skip
}

/// A place in a shell's script, as far as quoting goes.
///
/// It follows quotes, `$(...)` and comments. Where a script has what it does not follow (a
/// here-document, backquotes, `case` in brackets, quotes in `${...}`), it gives up, and only
/// values that need no quoting can be put in.
#[derive(Debug, Default)]
pub(crate) struct Script {
    /// Innermost last; none is the script itself.
    open: Vec<Open>,
    escaped: bool,
    lost: bool,
    /// What was passed last, from the start of a word on.
    word: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Open {
    Single,
    Double,
    /// `(` or `$(`
    Bracket,
    /// After `${`, until `}`
    Brace,
    Comment,
}

impl Script {
    /// Goes on over the text before the next value.
    pub(crate) fn pass(&mut self, text: &str) {
        for c in text.chars() {
            self.step(c);
        }
    }

    fn step(&mut self, c: char) {
        let top = self.open.last().copied();
        match top {
            Some(Open::Single) => {
                if c == '\'' {
                    self.open.pop();
                }
                return;
            }
            Some(Open::Comment) if c != '\n' => return,
            Some(Open::Comment) => drop(self.open.pop()),
            _ => {}
        }
        if std::mem::take(&mut self.escaped) {
            self.word.push('\\');
            return;
        }
        let double = top == Some(Open::Double);
        match c {
            '\\' => self.escaped = true,
            '`' => self.lost = true,
            '"' if double => drop(self.open.pop()),
            '\'' if double => {}
            '"' | '\'' if top == Some(Open::Brace) => self.lost = true,
            '\'' if self.word.ends_with('$') => self.lost = true,
            '"' => self.open.push(Open::Double),
            '\'' => self.open.push(Open::Single),
            '(' if !double || self.word.ends_with('$') => self.open.push(Open::Bracket),
            ')' if top == Some(Open::Bracket) => drop(self.open.pop()),
            '{' if self.word.ends_with('$') => self.open.push(Open::Brace),
            '}' if top == Some(Open::Brace) => drop(self.open.pop()),
            '#' if !double && self.word.is_empty() => self.open.push(Open::Comment),
            '<' if !double && self.word.ends_with('<') => self.lost = true,
            _ => {}
        }
        if c.is_whitespace() || ";|&()".contains(c) {
            self.lost |= self.word == "case" && self.open.contains(&Open::Bracket);
            self.word.clear();
        } else {
            self.word.push(c);
        }
    }

    /// `value` as it must be written at this place to stand for itself; `None` if that is not
    /// known.
    pub(crate) fn quoted(&mut self, value: &str) -> Option<String> {
        let escaped = std::mem::take(&mut self.escaped);
        self.word.push('_'); // whatever it is, it is part of a word
        let top = self.open.last().copied();
        match top {
            _ if is_plain(value) && !value.is_empty() && !escaped => Some(value.to_owned()),
            _ if self.lost || escaped => None,
            Some(Open::Single) => Some(value.replace('\'', r"'\''")),
            Some(Open::Double) => {
                let mut text = String::with_capacity(value.len());
                for c in value.chars() {
                    if "\\$`\"".contains(c) {
                        text.push('\\');
                    }
                    text.push(c);
                }
                Some(text)
            }
            Some(Open::Comment | Open::Brace) => None,
            None | Some(Open::Bracket) => Some(quoted_word(value)),
        }
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

    #[test]
    fn what_is_typed_is_quoted_for_the_shell_of_this_system() {
        let line = typed(["echo", "it is", "a/b.csv", "", "100%"]);
        let expected = if cfg!(windows) {
            r#"echo "it is" a/b.csv "" "100%""#
        } else {
            "echo 'it is' a/b.csv '' 100%"
        };
        assert_eq!(line, expected);
    }

    #[test]
    fn the_script_of_a_shell_is_known_by_the_words_before_it() {
        let script = |line: &str| is_script(line.split(' '));
        for line in ["sh -c", "/bin/bash -euo pipefail -c", "env A=1 sh -ec", "nice bash --norc -c"]
        {
            assert!(script(line), "{line}");
        }
        for line in ["sh", "sh -c script", "python -c", "tar -c", "bash -o", "sh run.sh -c"] {
            assert!(!script(line), "{line}");
        }
    }

    /// What a shell prints for a script with `value` between two parts.
    fn printed(before: &str, value: &str, after: &str) -> String {
        let mut script = Script::default();
        script.pass(before);
        let value = script.quoted(value).unwrap();
        let text = format!("{before}{value}{after}");
        let output = std::process::Command::new("sh").args(["-c", &text]).output().unwrap();
        assert!(output.status.success(), "{text}");
        String::from_utf8(output.stdout).unwrap()
    }

    const NASTY: [&str; 9] = [
        "$(touch pwned)",
        "a b;c|d & e",
        "it's",
        "\"",
        "`id`",
        "x\ny",
        "$HOME \\ \\\\ 'a' \"b\"",
        "*",
        "~",
    ];

    #[test]
    fn a_value_stands_for_itself_wherever_it_is_put() {
        for value in NASTY {
            for (before, after) in [
                ("printf %s ", ""),
                ("printf %s '", "'"),
                ("printf %s \"", "\""),
                ("printf %s \"it's ok\" >/dev/null; printf %s \"$(printf %s ", ")\""),
                ("# it's a comment\n(printf %s ", ")"),
                ("printf %s \"$(echo \"a'\" >/dev/null; printf %s '", "')\""),
                ("test a = \\'b; printf %s ", ""),
            ] {
                assert_eq!(printed(before, value, after), *value, "{before}|{after}");
            }
        }
    }

    #[test]
    fn where_quoting_is_not_understood_only_plain_values_are_put_in() {
        for before in [
            "cat <<END\n",
            "echo `echo ",
            "echo \"${x:-'",
            "echo $'",
            "# ",
            "echo \"$(case x in x) echo ",
            "echo \\",
        ] {
            let mut script = Script::default();
            script.pass(before);
            assert_eq!(script.quoted("a b"), None, "{before}");
        }
        let mut script = Script::default();
        script.pass("cat <<END\n");
        assert_eq!(script.quoted("plain-1.5").as_deref(), Some("plain-1.5"));
    }
}
