//! The lexer: it splits a formula into numbers, units in brackets, names and signs.

use super::error::ExpressionError;
use bulge_muscles::shown::shortened;
use bulge_numerics::tape::Comparison;
use std::ops::Range;

/// The kind of a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Token {
    Number,
    /// The text within the brackets after a number.
    Unit,
    Name,
    Plus,
    Minus,
    Times,
    Over,
    Power,
    Open,
    Close,
    Comma,
    Compare(Comparison),
    End,
}

/// Reads one word after the other.
pub(crate) struct Lexer<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> Lexer<'t> {
    pub(crate) fn new(text: &'t str) -> Self {
        Self { text, at: 0 }
    }

    /// The next word and its bytes. At the end of the text the word is empty.
    pub(crate) fn next(&mut self) -> Result<(Token, Range<usize>), ExpressionError> {
        self.at = self.text.len() - self.text[self.at..].trim_start().len();
        let start = self.at;
        let rest = &self.text[start..];
        let Some(first) = rest.chars().next() else { return Ok((Token::End, start..start)) };
        let (token, length) = match first {
            '0'..='9' | '.' => (Token::Number, self.number()?),
            'a'..='z' | 'A'..='Z' | '_' => {
                let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
                (Token::Name, rest.find(|c| !is_part(c)).unwrap_or(rest.len()))
            }
            '[' => (Token::Unit, self.unit()?),
            '<' if rest.starts_with("<=") => (Token::Compare(Comparison::LessOrEqual), 2),
            '>' if rest.starts_with(">=") => (Token::Compare(Comparison::GreaterOrEqual), 2),
            '<' => (Token::Compare(Comparison::Less), 1),
            '>' => (Token::Compare(Comparison::Greater), 1),
            '*' if rest.starts_with("**") => {
                return Err(self.error(2, "`**` is no sign of a formula", "write `^` for a power"));
            }
            '+' => (Token::Plus, 1),
            '-' | '\u{2212}' => (Token::Minus, first.len_utf8()),
            '*' | '\u{b7}' | '\u{d7}' | '\u{22c5}' => (Token::Times, first.len_utf8()),
            '/' => (Token::Over, 1),
            '^' => (Token::Power, 1),
            '(' => (Token::Open, 1),
            ')' => (Token::Close, 1),
            ',' => (Token::Comma, 1),
            other => return Err(self.unknown(other)),
        };
        self.at += length;
        Ok((token, start..self.at))
    }

    fn error(&self, length: usize, what: impl Into<String>, instead: impl Into<String>) -> ExpressionError {
        let end = self.text.floor_char_boundary(self.at + length);
        ExpressionError::new(self.text, self.at..end, what, instead)
    }

    /// The length of the number at this place: digits, point, exponent. Only a name or a sign may follow.
    fn number(&self) -> Result<usize, ExpressionError> {
        let bytes = &self.text.as_bytes()[self.at..];
        let digits =
            |from: usize| bytes[from.min(bytes.len())..].iter().take_while(|b| b.is_ascii_digit()).count();
        let mut end = digits(0);
        if bytes.get(end) == Some(&b'.') {
            end += 1 + digits(end + 1);
        }
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent = digits(end + 1 + sign);
            end += if exponent > 0 { 1 + sign + exponent } else { 0 };
        }
        let number = &self.text[self.at..self.at + end];
        if bytes.get(end) == Some(&b'.') || number == "." {
            let instead = "write a number such as `0.5`, or `*` for a product";
            return Err(self.error(end + 1, "a decimal point without its number", instead));
        }
        match number.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(end),
            _ => {
                let what = format!("the number `{}` is not finite", shortened(number));
                Err(self.error(end, what, "write a number below 1.8e308"))
            }
        }
    }

    /// The length of the brackets at this place, including the unit in them.
    fn unit(&self) -> Result<usize, ExpressionError> {
        let rest = &self.text[self.at + 1..];
        match rest.find([']', '[', '\n']) {
            Some(at) if rest[at..].starts_with(']') => Ok(at + 2),
            _ => Err(self.error(1, "the bracket `[` is not closed", "write a unit as in `3 [N]`")),
        }
    }

    fn unknown(&self, first: char) -> ExpressionError {
        const GREEK: [(char, &str); 12] = [
            ('\u{3b1}', "alpha"),
            ('\u{3b2}', "beta"),
            ('\u{3b3}', "gamma"),
            ('\u{3b4}', "delta"),
            ('\u{3b5}', "eps"),
            ('\u{3b8}', "theta"),
            ('\u{3bb}', "lambda"),
            ('\u{3bc}', "mu"),
            ('\u{b5}', "mu"),
            ('\u{3c0}', "pi"),
            ('\u{3c3}', "sigma"),
            ('\u{3c4}', "tau"),
        ];
        let shown = shortened(&first.to_string());
        let (what, instead) = match first {
            '=' | '&' | '|' | '!' => (
                format!("`{shown}` is no sign of a formula"),
                "compare within `if`: `if(a < b, x, y)`, with <, <=, > or >=".to_owned(),
            ),
            '%' => ("`%` is a unit".to_owned(), "write `20 [%]`, or `0.2`".to_owned()),
            '\u{b2}' | '\u{b3}' => {
                (format!("`{shown}` is no sign of a formula"), "write a power as `^2`".to_owned())
            }
            _ => match GREEK.iter().find(|(letter, _)| *letter == first) {
                Some((_, name)) => {
                    (format!("`{shown}` is no letter of a name"), format!("write it out, such as `{name}`"))
                }
                None if first.is_alphabetic() => (
                    format!("`{shown}` is no letter of a name"),
                    "write names with the letters a to z, digits and `_`".to_owned(),
                ),
                None => (
                    format!("`{shown}` is no sign of a formula"),
                    "write numbers, names, + - * / ^, parentheses and functions".to_owned(),
                ),
            },
        };
        self.error(first.len_utf8(), what, instead)
    }
}
