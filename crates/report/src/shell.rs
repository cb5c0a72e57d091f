//! Words of a command line that a reader may copy.

/// A word of a command line, in quotes if a shell would take it for more than one.
#[must_use]
pub fn shell_word(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./,:=+@\\".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.to_owned() } else { format!("\"{word}\"") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_a_shell_are_quoted() {
        assert_eq!(["a.csv", "my file", ""].map(shell_word), ["a.csv", "\"my file\"", "\"\""]);
    }
}
