//! The position of the reader in an MSH file: reads one number after another, as text or binary, and locates
//! mistakes.
//!
//! MSH 4.1 has the same numbers in the same order in both encodings, so that one reader serves both. Text is
//! read by lines, as Gmsh writes it: a missing or superfluous number is detected on its own line instead of
//! shifting everything after it.

use super::super::MeshError;
use bulge_muscles::shown::shortened_to;
use std::fmt::Display;
use std::str::FromStr;

/// Remedy for a truncated file.
pub(super) const CUT: &str = "the file is cut or damaged: copy it again, or save it again with Gmsh";
/// Remedy for a file that no version of Gmsh writes.
pub(super) const DAMAGED: &str = "the file is damaged or was edited by hand: save it again with Gmsh";

/// Longest quotation from a file, in characters.
const LONGEST_QUOTE: usize = 60;

/// Encoding of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// A position in the file.
pub(super) struct Cursor<'a> {
    pub(super) encoding: Encoding,
    origin: &'a str,
    bytes: &'a [u8],
    at: usize,
    /// Start of the number that was read last.
    last: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(origin: &'a str, bytes: &'a [u8]) -> Self {
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { encoding: Encoding::Text, origin, bytes, at, last: at }
    }

    pub(super) fn is_text(&self) -> bool {
        self.encoding == Encoding::Text
    }

    fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    /// An error at the number that was read last.
    pub(super) fn error(&self, what: impl Display, instead: &str) -> MeshError {
        self.error_at(self.last, what, instead)
    }

    /// An error at the current position.
    pub(super) fn error_here(&self, what: impl Display, instead: &str) -> MeshError {
        self.error_at(self.at, what, instead)
    }

    fn error_at(&self, at: usize, what: impl Display, instead: &str) -> MeshError {
        let instead = instead.to_owned();
        if !self.is_text() {
            return MeshError { file: self.origin.to_owned(), what: format!("byte {at}: {what}"), instead };
        }
        let before = self.bytes.get(..at).unwrap_or(self.bytes);
        let line = before.split(|byte| *byte == b'\n').count();
        MeshError { file: format!("{}:{line}", self.origin), what: what.to_string(), instead }
    }

    /// An error without a position, because something is missing.
    pub(super) fn error_of_file(&self, what: impl Display, instead: &str) -> MeshError {
        MeshError { file: self.origin.to_owned(), what: what.to_string(), instead: instead.to_owned() }
    }

    /// Opens the next section: its name without `$`, or none at the end of the file.
    pub(super) fn open_section(&mut self) -> Result<Option<&'a str>, MeshError> {
        self.skip(is_white);
        self.last = self.at;
        if self.rest().is_empty() {
            return Ok(None);
        }
        let line = self.take_line();
        let name = std::str::from_utf8(line).ok().and_then(|line| line.trim().strip_prefix('$'));
        match name {
            Some(name) if !name.is_empty() && !name.starts_with("End") => Ok(Some(name)),
            _ => Err(self.error(
                format_args!("`{}` stands where a section such as `$Nodes` must begin", quoted(line)),
                "remove it, or put it between `$Comments` and `$EndComments`",
            )),
        }
    }

    /// Closes a section whose declared contents have been read.
    pub(super) fn close_section(&mut self, name: &str) -> Result<(), MeshError> {
        self.skip(is_white);
        self.last = self.at;
        let found = self.rest();
        let end = format!("$End{name}");
        if found.starts_with(end.as_bytes()) && found.get(end.len()).is_none_or(|byte| is_white(*byte)) {
            self.at += end.len();
            return Ok(());
        }
        let is_cut = found.len() < end.len() && end.as_bytes().starts_with(found);
        if is_cut {
            return Err(self.error(format_args!("the file ends before `{end}`"), CUT));
        }
        let start = found.split(|byte| *byte == b'\n').next().unwrap_or_default();
        let found = if self.is_text() { format!(", but `{}`", quoted(start)) } else { String::new() };
        Err(self.error(
            format_args!("after what ${name} declares there is no `{end}`{found}"),
            "correct the number of entries that the section declares, or save the file again with Gmsh",
        ))
    }

    /// Skips a section, whatever it contains.
    pub(super) fn skip_section(&mut self, name: &str) -> Result<(), MeshError> {
        let end = format!("$End{name}");
        let mut from = self.at;
        while let Some(found) = find(self.bytes.get(from..).unwrap_or_default(), end.as_bytes()) {
            from += found + end.len();
            if self.bytes.get(from).is_none_or(|byte| is_white(*byte)) {
                self.at = from;
                return Ok(());
            }
        }
        Err(self.error(
            format_args!("section ${} has no `{}`", quoted(name.as_bytes()), quoted(end.as_bytes())),
            CUT,
        ))
    }

    /// Goes to the next line of text that isn't blank; does nothing in binary files.
    pub(super) fn begin_record(&mut self) {
        if self.is_text() {
            self.skip(is_white);
        }
    }

    /// Checks that a line of text has ended.
    pub(super) fn end_record(&mut self, what: impl Display) -> Result<(), MeshError> {
        if self.is_text() { self.end_line(what) } else { Ok(()) }
    }

    /// Checks the same for a line that is text in every file.
    pub(super) fn end_line(&mut self, what: impl Display) -> Result<(), MeshError> {
        self.skip(|byte| is_white(byte) && byte != b'\n');
        match self.rest().first() {
            None => Ok(()),
            Some(b'\n') => {
                self.at += 1;
                Ok(())
            }
            Some(_) => {
                self.last = self.at;
                let surplus = quoted(self.take_line());
                Err(self.error(format_args!("`{surplus}` is too much on the line of {what}"), DAMAGED))
            }
        }
    }

    /// The next complete line that isn't blank; text in every file.
    pub(super) fn line(&mut self) -> &'a [u8] {
        self.skip(is_white);
        self.last = self.at;
        self.take_line().trim_ascii()
    }

    /// An integer of four bytes.
    pub(super) fn int(&mut self, what: impl Display) -> Result<i32, MeshError> {
        match self.encoding {
            Encoding::Text => self.written(what),
            Encoding::LittleEndian => self.array(what).map(i32::from_le_bytes),
            Encoding::BigEndian => self.array(what).map(i32::from_be_bytes),
        }
    }

    /// A nonnegative integer of eight bytes.
    pub(super) fn size(&mut self, what: impl Display) -> Result<u64, MeshError> {
        match self.encoding {
            Encoding::Text => self.written(what),
            Encoding::LittleEndian => self.array(what).map(u64::from_le_bytes),
            Encoding::BigEndian => self.array(what).map(u64::from_be_bytes),
        }
    }

    /// A number, finite or not.
    pub(super) fn any_number(&mut self, what: impl Display) -> Result<f64, MeshError> {
        match self.encoding {
            Encoding::Text => self.written(what),
            Encoding::LittleEndian => self.array(what).map(f64::from_le_bytes),
            Encoding::BigEndian => self.array(what).map(f64::from_be_bytes),
        }
    }

    /// A finite number.
    pub(super) fn number(&mut self, what: impl Display) -> Result<f64, MeshError> {
        let value = self.any_number(&what)?;
        if value.is_finite() {
            return Ok(value);
        }
        let instead = "give every node a place; if Gmsh wrote this, its geometry is degenerate there";
        Err(self.error(format_args!("{what} is {value}"), instead))
    }

    /// The number of following entries, each of at least so many bytes in text and in binary. A number that
    /// doesn't fit into the rest of the file is refused before memory is allocated.
    pub(super) fn count(&mut self, what: &str, (text, binary): (u64, u64)) -> Result<usize, MeshError> {
        let declared = self.size(what)?;
        self.covered(declared, what, if self.is_text() { text } else { binary })
    }

    /// The same for a number on a line of its own, which is text in every file.
    pub(super) fn counted_line(
        &mut self,
        what: &str,
        (text, binary): (u64, u64),
    ) -> Result<usize, MeshError> {
        self.skip(is_white);
        let declared = self.written(what)?;
        let count = self.covered(declared, what, if self.is_text() { text } else { binary })?;
        self.end_line(what)?;
        Ok(count)
    }

    fn covered(&self, declared: u64, what: &str, each: u64) -> Result<usize, MeshError> {
        let left = self.rest().len();
        let bytes = declared.saturating_mul(each);
        usize::try_from(declared).ok().filter(|_| bytes <= left as u64).ok_or_else(|| {
            self.error(format_args!("{what} is {declared}, but only {left} bytes follow"), CUT)
        })
    }

    /// The next number of a line of text.
    pub(super) fn written<T: FromStr>(&mut self, what: impl Display) -> Result<T, MeshError> {
        let token = self.token();
        if token.is_empty() {
            let why = if self.rest().is_empty() { "the file ends" } else { "the line ends" };
            let instead = if self.rest().is_empty() { CUT } else { DAMAGED };
            return Err(self.error_here(format_args!("{what} is missing: {why}"), instead));
        }
        if token.starts_with(b"$") {
            let instead =
                "correct the number of entries that the section declares, or save the file again with Gmsh";
            return Err(
                self.error(format_args!("{what} is missing: `{}` comes first", quoted(token)), instead)
            );
        }
        let value = std::str::from_utf8(token).ok().and_then(|token| token.parse().ok());
        value.ok_or_else(|| {
            self.error(format_args!("{what} can't be `{}`", quoted(token)), "write a number that fits")
        })
    }

    fn token(&mut self) -> &'a [u8] {
        self.skip(|byte| is_white(byte) && byte != b'\n');
        self.last = self.at;
        let rest = self.rest();
        let end = rest.iter().position(|byte| is_white(*byte)).unwrap_or(rest.len());
        self.at += end;
        rest.get(..end).unwrap_or_default()
    }

    /// The next N bytes.
    pub(super) fn array<const N: usize>(&mut self, what: impl Display) -> Result<[u8; N], MeshError> {
        self.last = self.at;
        let Some(bytes) = self.rest().first_chunk::<N>() else {
            return Err(self.error(format_args!("{what} is missing: the file ends"), CUT));
        };
        self.at += N;
        Ok(*bytes)
    }

    fn take_line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let line = rest.split(|byte| *byte == b'\n').next().unwrap_or_default();
        self.at = (self.at + line.len() + 1).min(self.bytes.len());
        line
    }

    fn skip(&mut self, is_skipped: impl Fn(u8) -> bool) {
        let rest = self.rest();
        self.at += rest.iter().position(|byte| !is_skipped(*byte)).unwrap_or(rest.len());
    }
}

fn is_white(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b
}

/// The first position of `part` in `bytes`.
pub(in crate::mesh) fn find(bytes: &[u8], part: &[u8]) -> Option<usize> {
    let first = *part.first()?;
    let mut from = 0;
    while let Some(step) = bytes.get(from..)?.iter().position(|byte| *byte == first) {
        from += step;
        if bytes.get(from..)?.starts_with(part) {
            return Some(from);
        }
        from += 1;
    }
    None
}

/// A piece of the file for a message: short, on one line, printable.
pub(in crate::mesh) fn quoted(bytes: &[u8]) -> String {
    // A character takes between one and four bytes.
    let start = bytes.get(..bytes.len().min(4 * (LONGEST_QUOTE + 1))).unwrap_or_default();
    shortened_to(LONGEST_QUOTE, &String::from_utf8_lossy(start))
}
