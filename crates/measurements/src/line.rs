//! Lines of a table: separators, quotes, comments.

use crate::error::MeasurementError;
use std::borrow::Cow;

/// Most bytes of a line.
pub(crate) const MOST_BYTES_PER_LINE: usize = 1_000_000;
/// Texts that a spreadsheet writes for missing values. They aren't comments, although they begin like one.
const NO_VALUES: [&str; 8] = ["#N/A", "#DIV/0!", "#VALUE!", "#REF!", "#NAME?", "#NUM!", "#NULL!", "#NV"];

/// The separator between fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Separator {
    Byte(u8),
    /// One or more blanks.
    Blanks,
}

/// Possible separators. If a line has several kinds, the most frequent one is taken; a comma wins ties.
pub(crate) const SEPARATORS: [u8; 3] = [b',', b';', b'\t'];

impl Separator {
    /// The most frequent separator of a line; none if it has none.
    pub(crate) fn of(line: &str) -> Option<Self> {
        let count = |separator: u8| line.bytes().filter(|byte| *byte == separator).count();
        let most = SEPARATORS.into_iter().rev().max_by_key(|separator| count(*separator))?;
        (count(most) > 0).then_some(Self::Byte(most))
    }

    /// Splits a line into trimmed fields; none if a quote stays open or is followed by more text.
    pub(crate) fn split<'a>(self, line: &'a str, fields: &mut Vec<Cow<'a, str>>) -> Option<()> {
        match self {
            Self::Byte(separator) => split(line, separator, fields),
            Self::Blanks => {
                fields.clear();
                fields.extend(line.split_whitespace().map(Cow::Borrowed));
                Some(())
            }
        }
    }

    /// Whether a line consists of a comment or of separators only, like an empty row of a spreadsheet.
    pub(crate) fn is_blank(self, content: &str) -> bool {
        let start = content.trim_ascii_start();
        let is_empty = |byte: u8| {
            byte.is_ascii_whitespace() || matches!(self, Self::Byte(separator) if separator == byte)
        };
        is_comment(start) || start.bytes().all(is_empty)
    }
}

/// Whether a line, without leading blanks, is a comment.
pub(crate) fn is_comment(start: &str) -> bool {
    start.starts_with('#') && !NO_VALUES.iter().any(|text| start.starts_with(text))
}

/// The line without the carriage return of CRLF. Tabs stay, because one at the end of a row separates an
/// empty field.
pub(crate) fn without_line_end(line: &str) -> &str {
    line.strip_suffix('\r').unwrap_or(line)
}

pub(crate) fn checked_length(file: &str, line: usize, content: &str) -> Result<(), MeasurementError> {
    let (bytes, limit) = (content.len(), MOST_BYTES_PER_LINE);
    if bytes > limit {
        let what = format!(
            "the line has {bytes} bytes, but at most {limit} are read: put each row on a line of its own"
        );
        return Err(MeasurementError::at(file, line, what));
    }
    Ok(())
}

/// Removes empty fields beyond `width`: spreadsheets pad all rows to the longest.
pub(crate) fn unpad(fields: &mut Vec<Cow<'_, str>>, width: usize) {
    while fields.len() > width && fields.last().is_some_and(|field| field.is_empty()) {
        fields.pop();
    }
}

fn split<'a>(line: &'a str, separator: u8, fields: &mut Vec<Cow<'a, str>>) -> Option<()> {
    fields.clear();
    if !line.as_bytes().contains(&b'"') {
        fields.extend(line.split(char::from(separator)).map(|field| Cow::Borrowed(field.trim())));
        return Some(());
    }
    let mut rest = line;
    loop {
        let start = rest.trim_start_matches(|c: char| c.is_whitespace() && c != char::from(separator));
        let (field, after) = if let Some(inside) = start.strip_prefix('"') {
            unquoted(inside)?
        } else {
            let end = start.bytes().position(|byte| byte == separator).unwrap_or(start.len());
            (Cow::Borrowed(start[..end].trim()), &start[end..])
        };
        fields.push(field);
        let after = after.trim_start_matches(|c: char| c.is_whitespace() && c != char::from(separator));
        if after.is_empty() {
            return Some(());
        }
        rest = after.strip_prefix(char::from(separator))?;
    }
}

/// The text up to the closing quote, and the rest; a doubled quote stands for one.
fn unquoted(inside: &str) -> Option<(Cow<'_, str>, &str)> {
    let mut end = inside.find('"')?;
    if !inside[end + 1..].starts_with('"') {
        return Some((Cow::Borrowed(inside[..end].trim()), &inside[end + 1..]));
    }
    let mut text = String::new();
    let mut start = 0;
    while inside[end + 1..].starts_with('"') {
        text.push_str(&inside[start..=end]);
        start = end + 2;
        end = start + inside[start..].find('"')?;
    }
    text.push_str(&inside[start..end]);
    Some((Cow::Owned(text.trim().to_owned()), &inside[end + 1..]))
}
