//! Words of a command line for a reader to copy.

/// A word of a command line, quoted if a shell would take it for more than one word.
///
/// Names of files and headings are arbitrary. A name that a shell would evaluate within double quotes, such
/// as `$(..)`, is put in single quotes.
#[must_use]
pub fn shell_word(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./,:=+@\\".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else if word.contains(['$', '`', '"', '!']) {
        format!("'{}'", word.replace('\'', r"'\''"))
    } else {
        format!("\"{word}\"")
    }
}

/// The arguments of an analysis on the command line: `compare`, `diagnose` and `fit` take the same ones.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Call {
    /// Data files.
    pub data: Vec<String>,
    /// Assignment of the columns.
    pub columns: Option<String>,
    /// Lines of the rows that are excluded.
    pub exclude: Option<String>,
    /// Muscle: a file, or the name of a shipped one.
    pub muscle: String,
    /// File of the user's own effects.
    pub effects: Option<String>,
    /// Effects, in order.
    pub with: Vec<String>,
    /// Restrictions on parameters: `--hold`, `--bound` or `--tie`, each with its value.
    pub restrictions: Vec<(&'static str, String)>,
}

impl Call {
    /// The text after the name of the command.
    #[must_use]
    pub fn arguments(&self) -> String {
        let mut words: Vec<String> = self.data.iter().map(|file| shell_word(file)).collect();
        let mut option = |name: &str, value: Option<&str>| {
            words.extend(value.map(|value| format!("{name} {}", shell_word(value))));
        };
        option("--columns", self.columns.as_deref());
        option("--exclude", self.exclude.as_deref());
        option("--muscle", Some(&self.muscle));
        option("--effects", self.effects.as_deref());
        let with = self.with.join(",");
        option("--with", Some(with.as_str()).filter(|with| !with.is_empty()));
        for (name, value) in &self.restrictions {
            option(name, Some(value));
        }
        words.join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_says_all_that_was_said() {
        let mut call =
            Call { data: vec!["a b.csv".into(), "c.csv".into()], muscle: "m.toml".into(), ..Call::default() };
        assert_eq!(call.arguments(), "\"a b.csv\" c.csv --muscle m.toml");
        call.columns = Some("force=F [N]".into());
        call.exclude = Some("3-5".into());
        call.effects = Some("own.toml".into());
        call.with = vec!["creep".into(), "hose".into()];
        call.restrictions = vec![("--hold", "creep.time=3 s".into())];
        let whole = "\"a b.csv\" c.csv --columns \"force=F [N]\" --exclude 3-5 --muscle m.toml --effects own.toml --with creep,hose --hold \"creep.time=3 s\"";
        assert_eq!(call.arguments(), whole);
    }

    #[test]
    fn words_of_a_shell_are_quoted() {
        assert_eq!(["a.csv", "my file", ""].map(shell_word), ["a.csv", "\"my file\"", "\"\""]);
        // Nothing in a name is executed.
        let names = ["$(reboot).csv", "`x`", "a\"; x", "it's $x"].map(shell_word);
        assert_eq!(names, ["'$(reboot).csv'", "'`x`'", "'a\"; x'", r"'it'\''s $x'"]);
    }
}
