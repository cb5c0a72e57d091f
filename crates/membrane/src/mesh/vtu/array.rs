//! Data arrays of VTK's XML files: <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>.
//!
//! An array is text, or bytes with a header that states their number. The bytes are inline as base64 or
//! appended, as base64 or raw, and may be compressed in blocks.

use super::super::MeshError;
use super::super::msh::quoted;
use super::document::CUT;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use bulge_muscles::shown::one_line;
use flate2::read::ZlibDecoder;
use roxmltree::{Document, Node};
use std::borrow::Cow;
use std::cell::Cell;
use std::io::Read as _;

/// Most bytes to which a file may unpack: this number plus this multiple of its length. Regular meshes unpack
/// to ten times their length; the bound is for files that were made to exhaust the memory.
const MOST_UNPACKED: (u64, u64) = (64 << 20, 30);

/// Remedy for inconsistent numbers.
const DAMAGED: &str =
    "the file is damaged or its writer is at fault: save it again, for example with ParaView";

/// How the arrays of a file are stored.
pub(super) struct Arrays<'a, 'xml> {
    origin: &'a str,
    document: &'a Document<'xml>,
    appended: &'a [u8],
    is_appended_raw: bool,
    /// Offsets at which appended arrays begin, in order.
    offsets: Vec<usize>,
    is_big_endian: bool,
    is_compressed: bool,
    /// Size of a header word in bytes.
    header: usize,
    /// Number of bytes that may still be unpacked.
    unpackable: Cell<u64>,
}

/// The size of a number in bytes, and its type.
#[derive(Debug, Clone, Copy)]
enum NumberType {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

/// A number of any type.
#[derive(Debug, Clone, Copy)]
enum Number {
    Whole(i128),
    Real(f64),
}

impl<'a, 'xml> Arrays<'a, 'xml> {
    /// Determines how arrays are stored. `length` is that of the whole file.
    pub(super) fn new(
        origin: &'a str,
        document: &'a Document<'xml>,
        appended: &'a [u8],
        length: usize,
    ) -> Result<Self, MeshError> {
        let (least, times) = MOST_UNPACKED;
        let mut arrays = Self {
            origin,
            document,
            appended,
            is_appended_raw: false,
            offsets: Vec::new(),
            is_big_endian: false,
            is_compressed: false,
            header: 4,
            unpackable: Cell::new((length as u64).saturating_mul(times).saturating_add(least)),
        };
        let root = document.root_element();
        arrays.is_big_endian = match root.attribute("byte_order") {
            None | Some("LittleEndian") => false,
            Some("BigEndian") => true,
            Some(other) => {
                return Err(arrays.error(root, format!("the byte order is `{}`", brief(other)), DAMAGED));
            }
        };
        arrays.header = match root.attribute("header_type") {
            None | Some("UInt32") => 4,
            Some("UInt64") => 8,
            Some(other) => {
                return Err(arrays.error(root, format!("the header type is `{}`", brief(other)), DAMAGED));
            }
        };
        arrays.is_compressed = match root.attribute("compressor") {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                let what = format!("the file is compressed by `{}`", brief(other));
                return Err(arrays.error(root, what, "save it with the compressor ZLib or none"));
            }
        };
        if let Some(data) = root.children().find(|node| node.has_tag_name("AppendedData")) {
            arrays.is_appended_raw = match data.attribute("encoding") {
                Some("raw") => true,
                None | Some("base64") => false,
                Some(other) => {
                    let what = format!("the appended data are encoded as `{}`", brief(other));
                    return Err(arrays.error(data, what, "save the file with the encoding base64 or raw"));
                }
            };
        }
        let offsets = root.descendants().filter_map(|node| node.attribute("offset")?.trim().parse().ok());
        arrays.offsets = offsets.collect();
        arrays.offsets.sort_unstable();
        Ok(arrays)
    }

    /// An error in an XML element.
    pub(super) fn error(&self, node: Node, what: impl Into<String>, instead: &str) -> MeshError {
        let line = self.document.text_pos_at(node.range().start).row;
        MeshError { file: format!("{}:{line}", self.origin), what: what.into(), instead: instead.to_owned() }
    }

    /// A number from an attribute of an XML element.
    pub(super) fn count(&self, node: Node, attribute: &str) -> Result<usize, MeshError> {
        let text = node.attribute(attribute).unwrap_or_default();
        text.trim().parse().map_err(|_| {
            let what = format!(
                "`{attribute}` of <{}> is `{}`, which is no count",
                node.tag_name().name(),
                brief(text)
            );
            self.error(node, what, DAMAGED)
        })
    }

    /// The array as integers: `expected` of them, if given.
    pub(super) fn integers(&self, array: Node, expected: Option<usize>) -> Result<Vec<i64>, MeshError> {
        self.read(array, expected, |number| match number {
            Number::Whole(value) => i64::try_from(value).ok(),
            // Exact below 2^53, so the cast loses nothing.
            #[allow(clippy::cast_possible_truncation)]
            Number::Real(value) => {
                let whole = value.fract().abs() <= 0.0 && value.abs() <= 9_007_199_254_740_992.0;
                whole.then_some(value as i64)
            }
        })
    }

    /// The array as finite numbers.
    pub(super) fn numbers(&self, array: Node, expected: Option<usize>) -> Result<Vec<f64>, MeshError> {
        self.read(array, expected, |number| match number {
            Number::Whole(value) => Some(value as f64),
            Number::Real(value) => value.is_finite().then_some(value),
        })
    }

    /// An array of strings, each ended by a NUL.
    pub(super) fn strings(&self, array: Node) -> Result<Vec<String>, MeshError> {
        let bytes = if array.attribute("format") == Some("ascii") {
            // Character codes, which VTK writes as signed or unsigned.
            let byte = |code: i16| {
                u8::try_from(code).ok().or_else(|| i8::try_from(code).ok().map(i8::cast_unsigned))
            };
            let codes = texts(array).flat_map(str::split_ascii_whitespace);
            codes.map(|token| token.parse().ok().and_then(byte)).collect::<Option<Vec<_>>>().map(Cow::Owned)
        } else {
            Some(self.bytes(array)?)
        };
        let text = bytes.and_then(|bytes| String::from_utf8(bytes.into_owned()).ok());
        let Some(text) = text else {
            return Err(self.error(array, format!("{} is no text of UTF-8", name(array)), DAMAGED));
        };
        let ended = text.strip_suffix('\0').unwrap_or(&text);
        Ok(if text.is_empty() {
            Vec::new()
        } else {
            ended.split('\0').map(|name| one_line(name).into_owned()).collect()
        })
    }

    fn read<T>(
        &self,
        array: Node,
        expected: Option<usize>,
        value: impl Fn(Number) -> Option<T>,
    ) -> Result<Vec<T>, MeshError> {
        let number_type = self.number_type(array)?;
        let mut values = Vec::new();
        let mut push = |number: Option<Number>, quote: &dyn Fn() -> String| {
            let Some(value) = number.and_then(&value) else {
                let what = format!("entry {} of {} can't be `{}`", values.len(), name(array), quote());
                return Err(self.error(
                    array,
                    what,
                    "correct the array, or leave it out if the mesh doesn't need it",
                ));
            };
            values.push(value);
            Ok(())
        };
        if array.attribute("format") == Some("ascii") {
            for token in texts(array).flat_map(str::split_ascii_whitespace) {
                push(number_type.written(token), &|| brief(token))?;
            }
        } else {
            let bytes = self.bytes(array)?;
            let chunks = bytes.chunks_exact(number_type.bytes());
            self.charge(array, 8 * chunks.len() as u64)?;
            if !chunks.remainder().is_empty() {
                let what = format!("{} has {} bytes, no whole number of entries", name(array), bytes.len());
                return Err(self.error(array, what, DAMAGED));
            }
            for chunk in chunks {
                let number = number_type.number(chunk, self.is_big_endian);
                push(Some(number), &|| number.to_string())?;
            }
        }
        let found = values.len();
        if let Some(expected) = expected.filter(|expected| *expected != found) {
            let what = format!("{} has {found} entries where {expected} are expected", name(array));
            return Err(self.error(array, what, CUT));
        }
        Ok(values)
    }

    fn number_type(&self, array: Node) -> Result<NumberType, MeshError> {
        let text = array.attribute("type").unwrap_or_default();
        Ok(match text {
            "Int8" => NumberType::Signed(1),
            "Int16" => NumberType::Signed(2),
            "Int32" => NumberType::Signed(4),
            "Int64" => NumberType::Signed(8),
            "UInt8" => NumberType::Unsigned(1),
            "UInt16" => NumberType::Unsigned(2),
            "UInt32" => NumberType::Unsigned(4),
            "UInt64" => NumberType::Unsigned(8),
            "Float32" => NumberType::Float(4),
            "Float64" => NumberType::Float(8),
            _ => {
                let what = format!("{} is of type `{}`", name(array), brief(text));
                return Err(self.error(array, what, "write it as Int8 to UInt64, Float32 or Float64"));
            }
        })
    }

    /// The unpacked bytes of an array that isn't text.
    fn bytes(&self, array: Node) -> Result<Cow<'a, [u8]>, MeshError> {
        let packed = match array.attribute("format") {
            Some("binary") => self.base64(array, texts(array).flat_map(str::bytes))?,
            Some("appended") => self.appended(array)?,
            other => {
                let what = format!("{} has the format `{}`", name(array), brief(other.unwrap_or_default()));
                return Err(self.error(array, what, "save the file as ascii, binary or appended"));
            }
        };
        if packed.is_empty() {
            return Ok(packed);
        }
        let word = |place: usize| {
            let bytes = packed.get(place.checked_mul(self.header)?..)?.get(..self.header)?;
            Some(unsigned(bytes, self.is_big_endian))
        };
        let cut = || self.error(array, format!("{} is shorter than its header says", name(array)), CUT);
        let first = word(0).and_then(|first| usize::try_from(first).ok()).ok_or_else(cut)?;
        if !self.is_compressed {
            let end = self.header.checked_add(first).ok_or_else(cut)?;
            return match packed {
                Cow::Borrowed(bytes) => bytes.get(self.header..end).map(Cow::Borrowed),
                Cow::Owned(mut bytes) => (end <= bytes.len()).then(|| {
                    bytes.truncate(end);
                    bytes.drain(..self.header);
                    Cow::Owned(bytes)
                }),
            }
            .ok_or_else(cut);
        }
        // Compressed data: the number of blocks, their unpacked size, the size of the last one if it differs,
        // and all compressed sizes.
        if first == 0 {
            return Ok(Cow::Borrowed(&[]));
        }
        let (size, last) = word(1).zip(word(2)).ok_or_else(cut)?;
        let mut at = first.checked_add(3).and_then(|words| words.checked_mul(self.header)).ok_or_else(cut)?;
        if at > packed.len() {
            return Err(cut());
        }
        let total =
            (first as u64 - u64::from(last > 0)).checked_mul(size).and_then(|full| full.checked_add(last));
        self.charge(array, total.unwrap_or(u64::MAX))?;
        let mut out = Vec::new();
        for block in 0..first {
            let size = if block + 1 == first && last > 0 { last } else { size };
            let length = word(block + 3).and_then(|length| usize::try_from(length).ok()).ok_or_else(cut)?;
            let end = at.checked_add(length).ok_or_else(cut)?;
            let bytes = packed.get(at..end).ok_or_else(cut)?;
            at = end;
            // One byte more than wanted, so that the end of the stream and its checksum are read.
            let mut stream = ZlibDecoder::new(bytes).take(size.saturating_add(1));
            let unpacked = stream.read_to_end(&mut out);
            if unpacked.ok().is_none_or(|unpacked| unpacked as u64 != size) {
                let what = format!("{} can't be unpacked: block {block} is damaged", name(array));
                return Err(self.error(array, what, CUT));
            }
        }
        Ok(Cow::Owned(out))
    }

    /// Charges bytes that are kept to the allowance.
    fn charge(&self, array: Node, bytes: u64) -> Result<(), MeshError> {
        let Some(left) = self.unpackable.get().checked_sub(bytes) else {
            let what = format!("with {} the file unpacks to far more than meshes do", name(array));
            return Err(self.error(array, what, "save the file without compression, and each array once"));
        };
        self.unpackable.set(left);
        Ok(())
    }

    /// The bytes from the array's offset to the next one, or to the end.
    fn appended(&self, array: Node) -> Result<Cow<'a, [u8]>, MeshError> {
        let begin = self.count(array, "offset")?;
        let next = self.offsets.partition_point(|offset| *offset <= begin);
        let end = self.offsets.get(next).copied().unwrap_or(usize::MAX).min(self.appended.len());
        let Some(bytes) = self.appended.get(begin..end).filter(|bytes| !bytes.is_empty()) else {
            let what = format!("{} begins at {begin}, after the end of the appended data", name(array));
            return Err(self.error(array, what, CUT));
        };
        // Any number of arrays may begin at one offset.
        self.charge(array, bytes.len() as u64)?;
        if self.is_appended_raw {
            Ok(Cow::Borrowed(bytes))
        } else {
            self.base64(array, bytes.iter().copied())
        }
    }

    /// Base64 text in one piece, or in several with their own padding: VTK encodes the header of compressed
    /// data separately.
    fn base64(&self, array: Node, text: impl Iterator<Item = u8>) -> Result<Cow<'a, [u8]>, MeshError> {
        let text: Vec<u8> = text.filter(|byte| !byte.is_ascii_whitespace()).collect();
        let mut out = Vec::with_capacity(text.len() / 4 * 3);
        let mut rest = text.as_slice();
        while !rest.is_empty() {
            let padding = rest.iter().position(|byte| *byte == b'=');
            let end = padding.map_or(rest.len(), |at| (at / 4 + 1) * 4);
            let unit = rest.get(..end).and_then(|unit| STANDARD.decode_vec(unit, &mut out).ok());
            if unit.is_none() {
                let place = text.len() - rest.len();
                let what = format!("{} is no base64: see its characters from {place} on", name(array));
                return Err(self.error(array, what, CUT));
            }
            rest = rest.get(end..).unwrap_or_default();
        }
        Ok(Cow::Owned(out))
    }
}

impl NumberType {
    fn bytes(self) -> usize {
        let (Self::Signed(bytes) | Self::Unsigned(bytes) | Self::Float(bytes)) = self;
        bytes
    }

    fn written(self, token: &str) -> Option<Number> {
        match self {
            Self::Float(_) => token.parse().ok().map(Number::Real),
            _ => token.parse().ok().map(Number::Whole),
        }
    }

    fn number(self, bytes: &[u8], is_big_endian: bool) -> Number {
        let word = unsigned(bytes, is_big_endian);
        match self {
            Self::Unsigned(_) => Number::Whole(word.into()),
            Self::Signed(bytes) => {
                // The sign is the highest of the used bits.
                let unused = 64 - 8 * bytes;
                Number::Whole(((word << unused).cast_signed() >> unused).into())
            }
            Self::Float(4) => {
                // Four bytes: the upper half is empty.
                #[allow(clippy::cast_possible_truncation)]
                Number::Real(f32::from_bits(word as u32).into())
            }
            Self::Float(_) => Number::Real(f64::from_bits(word)),
        }
    }
}

impl std::fmt::Display for Number {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Whole(value) => value.fmt(formatter),
            Self::Real(value) => value.fmt(formatter),
        }
    }
}

/// A number of at most eight bytes.
fn unsigned(bytes: &[u8], is_big_endian: bool) -> u64 {
    let join = |word: u64, byte: &u8| word << 8 | u64::from(*byte);
    if is_big_endian { bytes.iter().fold(0, join) } else { bytes.iter().rev().fold(0, join) }
}

/// The text nodes of an array; VTK appends elements with further information.
fn texts<'a>(array: Node<'a, '_>) -> impl Iterator<Item = &'a str> {
    array.children().filter(Node::is_text).filter_map(|node| node.text())
}

/// The name of an array in messages.
pub(super) fn name(array: Node) -> String {
    array
        .attribute("Name")
        .map_or_else(|| "an array without a name".to_owned(), |name| format!("array `{}`", brief(name)))
}

pub(super) fn brief(text: &str) -> String {
    quoted(text.as_bytes())
}
