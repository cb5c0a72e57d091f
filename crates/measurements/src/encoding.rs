//! Decodes text: UTF-8, UTF-16 with or without a byte order mark, otherwise the Western code page of old
//! instruments.

use crate::error::MeasurementError;
use crate::source::has_room;
use std::borrow::Cow;

/// Number of bytes that are searched for UTF-16 without a mark.
const LOOKED_AT: usize = 4096;
/// Characters of Windows-1252 from 0x80 to 0x9F; the others equal Latin-1. Undefined bytes map to the
/// replacement character.
const WINDOWS: [char; 32] = [
    '\u{20ac}', '\u{fffd}', '\u{201a}', '\u{192}', '\u{201e}', '\u{2026}', '\u{2020}', '\u{2021}', '\u{2c6}',
    '\u{2030}', '\u{160}', '\u{2039}', '\u{152}', '\u{fffd}', '\u{17d}', '\u{fffd}', '\u{fffd}', '\u{2018}',
    '\u{2019}', '\u{201c}', '\u{201d}', '\u{2022}', '\u{2013}', '\u{2014}', '\u{2dc}', '\u{2122}', '\u{161}',
    '\u{203a}', '\u{153}', '\u{fffd}', '\u{17e}', '\u{178}',
];

/// The text of a file, and the name of its encoding if it was guessed.
pub(crate) fn text<'a>(
    file: &str,
    bytes: &'a [u8],
) -> Result<(Cow<'a, str>, Option<&'static str>), MeasurementError> {
    if let Some(little) = utf16(bytes) {
        let units = bytes
            .chunks_exact(2)
            .map(|pair| if little { [pair[0], pair[1]] } else { [pair[1], pair[0]] })
            .map(u16::from_le_bytes);
        let characters = char::decode_utf16(units)
            .map(|character| character.unwrap_or(char::REPLACEMENT_CHARACTER))
            .enumerate()
            .filter(|(place, character)| (*place, *character) != (0, '\u{feff}'));
        let text = collected(file, bytes.len() / 2, characters.map(|(_, character)| character))?;
        return checked(file, Cow::Owned(text), Some("UTF-16"));
    }
    if let Ok(text) = std::str::from_utf8(bytes) {
        return checked(file, Cow::Borrowed(text.strip_prefix('\u{feff}').unwrap_or(text)), None);
    }
    let text = collected(file, bytes.len(), bytes.iter().map(|byte| western(*byte)))?;
    checked(file, Cow::Owned(text), Some("Latin-1 (Windows-1252)"))
}

/// The text of characters, of which nearly all take one byte.
fn collected(
    file: &str,
    count: usize,
    characters: impl Iterator<Item = char>,
) -> Result<String, MeasurementError> {
    let expected = count + count / 8;
    has_room(file, expected as u64)?;
    let mut text = String::with_capacity(expected);
    text.extend(characters);
    Ok(text)
}

fn western(byte: u8) -> char {
    match byte {
        0x80..=0x9f => WINDOWS[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

/// If bytes are UTF-16, whether the low byte comes first. Without a mark, every other byte of plain text is
/// zero.
fn utf16(bytes: &[u8]) -> Option<bool> {
    if bytes.starts_with(&[0xff, 0xfe]) {
        return Some(true);
    }
    if bytes.starts_with(&[0xfe, 0xff]) {
        return Some(false);
    }
    let start = &bytes[..bytes.len().min(LOOKED_AT)];
    let zeros = |from: usize| start.iter().skip(from).step_by(2).filter(|byte| **byte == 0).count();
    let (even, odd, pairs) = (zeros(0), zeros(1), start.len() / 2);
    let is_most = |zeros: usize, others: usize| pairs >= 8 && 10 * zeros > 9 * pairs && 10 * others < pairs;
    if is_most(odd, even) {
        Some(true)
    } else if is_most(even, odd) {
        Some(false)
    } else {
        None
    }
}

type Text<'a> = (Cow<'a, str>, Option<&'static str>);

/// A NUL is not text.
fn checked<'a>(
    file: &str,
    text: Cow<'a, str>,
    encoding: Option<&'static str>,
) -> Result<Text<'a>, MeasurementError> {
    if let Some(at) = text.bytes().position(|byte| byte == 0) {
        let line = text.as_bytes()[..at].split(|byte| *byte == b'\n').count();
        let what = "holds a NUL byte: it is damaged or no text; export it again as CSV in UTF-8";
        return Err(MeasurementError::at(file, line, what));
    }
    Ok((text, encoding))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_text_in_every_encoding() {
        let plain = "T [\u{b0}C];\u{3bc}m\n20,5;\u{e4}\n";
        let (little, big): (Vec<u8>, Vec<u8>) = (
            plain.encode_utf16().flat_map(u16::to_le_bytes).collect(),
            plain.encode_utf16().flat_map(u16::to_be_bytes).collect(),
        );
        let marked = |mark: [u8; 2], bytes: &[u8]| [&mark[..], bytes].concat();
        for bytes in [
            plain.as_bytes().to_vec(),
            format!("\u{feff}{plain}").into_bytes(),
            marked([0xff, 0xfe], &little),
            marked([0xfe, 0xff], &big),
            little,
            big,
        ] {
            assert_eq!(text("d.csv", &bytes).unwrap().0, plain);
        }
        let (latin, encoding) = text("d.csv", b"T [\xb0C]\x80\n").unwrap();
        assert_eq!((latin.as_ref(), encoding), ("T [\u{b0}C]\u{20ac}\n", Some("Latin-1 (Windows-1252)")));
        assert!(text("d.csv", b"a\n3\x000\n").unwrap_err().to_string().contains("d.csv:2: holds a NUL"));
    }
}
