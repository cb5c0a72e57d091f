//! Running text on a terminal: paragraphs of constant width.

use std::fmt::Write;

/// Width of running text.
pub(crate) const WIDTH: usize = 108;
/// No-break space, which keeps a number and its unit on one line.
const TIE: char = '\u{a0}';

/// Running text, wrapped at spaces (not before a per cent sign); lines after the first are indented a little
/// more.
pub(crate) fn paragraph(out: &mut String, indent: &str, words: &str) {
    let mut line = indent.to_owned();
    let mut is_empty = true;
    let tied = words.replace(" %", &format!("{TIE}%"));
    for word in tied.split([' ', '\n']).filter(|word| !word.is_empty()) {
        if !is_empty && line.chars().count() + 1 + word.chars().count() > WIDTH {
            let _ = writeln!(out, "{line}");
            line = format!("{indent}  ");
            is_empty = true;
        }
        if !is_empty {
            line.push(' ');
        }
        line.push_str(&word.replace(TIE, " "));
        is_empty = false;
    }
    let _ = writeln!(out, "{line}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn running_text_keeps_its_words_and_its_width() {
        let words = "bladder-elasticity and more ".repeat(20);
        let mut out = String::new();
        paragraph(&mut out, "    ", &words);
        assert!(
            out.lines().count() > 4
                && out.lines().all(|line| line.len() <= WIDTH && line.starts_with("    "))
        );
        assert!(out.split_whitespace().eq(words.split_whitespace()));
        let mut out = String::new();
        paragraph(&mut out, "", &"right 99 % ".repeat(40));
        assert!(
            out.lines().count() > 3 && !out.contains("\n  %") && out.matches("99 %").count() == 40,
            "{out}"
        );
    }
}
