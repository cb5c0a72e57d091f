//! MATLAB files of version 5 to 7.2: numeric vectors of one length, as variables or as fields of a structure.
//!
//! The format is described in the "MAT-File Format" reference of `MathWorks`: elements with a type, a number
//! of bytes and these bytes, padded to a multiple of eight.

use crate::assignment::{Header, assign};
use crate::csv_file::MOST_ROWS;
use crate::error::MeasurementError;
use crate::heading::Heading;
use crate::reading::ReadOptions;
use crate::slot::Slot;
use crate::source::has_room;
use crate::table::{Draft, Table, bytes_per_row};
use bulge_muscles::shown::listed;
use flate2::read::ZlibDecoder;
use std::io::Read;

/// The first bytes of every such file.
const MAGIC: &[u8] = b"MATLAB ";
/// Bytes of text and flags before the first element.
const START: usize = 128;
/// Most bytes of a decompressed element.
const MOST_BYTES: u64 = 1 << 30;
/// Deepest nesting of structures.
const DEEPEST: usize = 4;
/// Element types.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Array classes: a structure, and the numeric ones from double to 64-bit integers.
const STRUCTURE: u8 = 2;
const NUMERIC: std::ops::RangeInclusive<u8> = 6..=15;

/// Whether bytes are a file of MATLAB.
pub(crate) fn is_one(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// A column of numbers.
struct Variable {
    name: String,
    values: Vec<f64>,
}

/// Reads a file of MATLAB. `file` is its name, for messages.
pub(crate) fn read(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Table, MeasurementError> {
    if bytes.starts_with(b"MATLAB 7.3") {
        let what =
            "is a file of MATLAB 7.3, which is HDF5: load it in MATLAB and write `save('x.mat','-v7')`";
        return Err(MeasurementError::of_file(file, what));
    }
    let what = "is a damaged or cut-off file of MATLAB: write it again with `save('x.mat','-v7')`";
    let damaged = || MeasurementError::of_file(file, what);
    let mut all = Vec::new();
    let is_big = match bytes.get(126..START) {
        Some(b"IM") => false,
        Some(b"MI") => true,
        _ => return Err(damaged()),
    };
    variables(file, &Elements { bytes: &bytes[START..], is_big }, &mut all)?.ok_or_else(damaged)?;
    // The table consists of the vectors of the most common length; among equally common ones, the longest.
    let rows = all.iter().map(|variable| variable.values.len()).filter(|length| *length > 1);
    let count = |rows: usize| all.iter().filter(|variable| variable.values.len() == rows).count();
    let Some(rows) = rows.max_by_key(|rows| (count(*rows), *rows)) else {
        let what = "holds no numeric vectors: store each column as a variable or as a field of a structure (a `table` is none: `writetable` writes it as CSV)";
        return Err(MeasurementError::of_file(file, what));
    };
    if rows > MOST_ROWS {
        return Err(MeasurementError::too_many_rows(file, MOST_ROWS + 1));
    }
    let (columns, others): (Vec<Variable>, Vec<Variable>) =
        all.into_iter().partition(|variable| variable.values.len() == rows);
    let names: Vec<String> = columns.iter().map(|variable| variable.name.clone()).collect();
    let first: Vec<Vec<String>> = columns
        .iter()
        .map(|variable| variable.values.iter().take(3).map(ToString::to_string).collect())
        .collect();
    let header = Header { file, line: 1, names: &names, units: None, first: &first };
    let assignment = assign(&header, options)?;
    let used =
        assignment.headings.into_iter().zip(columns).filter_map(|(heading, column)| Some((heading?, column)));
    let (headings, columns): (Vec<Heading>, Vec<Variable>) = used.unzip();
    has_room(file, (rows * bytes_per_row(columns.len())) as u64)?;
    let slots = headings.into_iter().map(|heading| Slot::new(heading, rows)).collect();
    let mut draft = Draft::new(slots, assignment.uses, "row");
    if !others.is_empty() {
        let names = listed(10, "", others.iter().map(|variable| &variable.name));
        draft.notes.push(format!("{file}: of another length than {rows}, and ignored: {names}"));
    }
    // Each variable is dropped when its values are taken.
    for (slot, column) in columns.into_iter().enumerate() {
        for (row, value) in column.values.iter().enumerate() {
            if let Err(problem) = draft.slots[slot].push_number(*value) {
                draft.spoilt(slot, row, &problem);
            }
        }
    }
    draft.lines = (1..=u32::try_from(rows).unwrap_or(u32::MAX)).collect();
    draft.finish(file, options)
}

/// A sequence of elements.
struct Elements<'a> {
    bytes: &'a [u8],
    is_big: bool,
}

/// The type of an element and its bytes.
type Element<'a> = (u32, &'a [u8]);

impl<'a> Elements<'a> {
    fn word(&self, at: usize) -> Option<u32> {
        let word: [u8; 4] = self.bytes.get(at..at.checked_add(4)?)?.try_into().ok()?;
        Some(if self.is_big { u32::from_be_bytes(word) } else { u32::from_le_bytes(word) })
    }

    /// The next element; small ones pack type, length and data into eight bytes.
    fn next(&mut self) -> Option<Element<'a>> {
        let word = self.word(0)?;
        let (kind, start, length, end): (u32, usize, usize, usize) = if word >> 16 != 0 {
            (word & 0xffff, 4, (word >> 16) as usize, 8)
        } else {
            let length = self.word(4)? as usize;
            // Compressed elements aren't padded.
            let padded = if word == COMPRESSED { length } else { length.checked_next_multiple_of(8)? };
            (word, 8, length, padded.checked_add(8)?)
        };
        let found = self.bytes.get(start..start.checked_add(length)?)?;
        self.bytes = self.bytes.get(end..).unwrap_or_default();
        Some((kind, found))
    }

    fn within(&self, bytes: &'a [u8]) -> Self {
        Self { bytes, is_big: self.is_big }
    }

    /// The whole numbers of an element of 32-bit integers.
    fn counts(&self, (kind, bytes): Element<'a>) -> Option<Vec<usize>> {
        let words = self.within(bytes);
        let is_whole = matches!(kind, 5 | 6);
        is_whole.then(|| (0..bytes.len() / 4).filter_map(|i| Some(words.word(4 * i)? as usize)).collect())
    }

    /// The numbers of an element.
    fn numbers(&self, (kind, bytes): Element<'_>) -> Option<Vec<f64>> {
        fn all<const N: usize>(bytes: &[u8], is_big: bool, number: impl Fn([u8; N]) -> f64) -> Vec<f64> {
            let one = |chunk: &[u8]| {
                let mut word = [0; N];
                word.copy_from_slice(chunk);
                if is_big {
                    word.reverse();
                }
                number(word)
            };
            bytes.chunks_exact(N).map(one).collect()
        }
        let big = self.is_big;
        Some(match kind {
            1 => all(bytes, big, |word| f64::from(i8::from_le_bytes(word))),
            2 => all(bytes, big, |word| f64::from(u8::from_le_bytes(word))),
            3 => all(bytes, big, |word| f64::from(i16::from_le_bytes(word))),
            4 => all(bytes, big, |word| f64::from(u16::from_le_bytes(word))),
            5 => all(bytes, big, |word| f64::from(i32::from_le_bytes(word))),
            6 => all(bytes, big, |word| f64::from(u32::from_le_bytes(word))),
            7 => all(bytes, big, |word| f64::from(f32::from_le_bytes(word))),
            9 => all(bytes, big, f64::from_le_bytes),
            12 => all(bytes, big, |word| i64::from_le_bytes(word) as f64),
            13 => all(bytes, big, |word| u64::from_le_bytes(word) as f64),
            _ => return None,
        })
    }
}

/// All variables of a file; none if it is damaged.
fn variables(
    file: &str,
    elements: &Elements<'_>,
    found: &mut Vec<Variable>,
) -> Result<Option<()>, MeasurementError> {
    let mut elements = elements.within(elements.bytes);
    while elements.bytes.len() >= 8 {
        let Some((kind, bytes)) = elements.next() else { return Ok(None) };
        let is_sound = if kind == MATRIX {
            // The values as numbers, and the columns of a matrix.
            has_room(file, 2 * bytes.len() as u64)?;
            array(&elements.within(bytes), None, DEEPEST, found).is_some()
        } else if kind == COMPRESSED {
            let Some(unpacked) = unpacked(file, bytes, elements.is_big)? else { return Ok(None) };
            let mut inner = Elements { bytes: &unpacked, is_big: elements.is_big };
            match inner.next() {
                Some((MATRIX, bytes)) => array(&inner.within(bytes), None, DEEPEST, found).is_some(),
                _ => true,
            }
        } else {
            true
        };
        if !is_sound {
            return Ok(None);
        }
    }
    Ok(Some(()))
}

/// The bytes of a compressed element; none if it is damaged. It begins with its type and its length.
fn unpacked(file: &str, bytes: &[u8], is_big: bool) -> Result<Option<Vec<u8>>, MeasurementError> {
    let mut decoder = ZlibDecoder::new(bytes);
    let mut bytes = vec![0; 8];
    if decoder.read_exact(&mut bytes).is_err() {
        return Ok(None);
    }
    let length = Elements { bytes: &bytes, is_big }.word(4).map_or(0, u64::from).min(MOST_BYTES);
    // Itself, its values as numbers, and the columns of a matrix.
    has_room(file, 3 * length)?;
    Ok(decoder.take(length).read_to_end(&mut bytes).ok().map(|_| bytes))
}

/// The columns of an array: one for a vector, several for a matrix, those of its fields for a structure; none
/// for other arrays.
fn array(elements: &Elements<'_>, name: Option<&str>, depth: usize, found: &mut Vec<Variable>) -> Option<()> {
    let mut elements = elements.within(elements.bytes);
    // An empty array has no columns.
    let Some((_, flags)) = elements.next() else { return Some(()) };
    let class = *flags.get(if elements.is_big { 3 } else { 0 })?;
    let dimensions = elements.next()?;
    let dimensions = elements.counts(dimensions)?;
    let own = elements.next()?.1;
    let own = String::from_utf8_lossy(own).into_owned();
    let name = name.unwrap_or(&own);
    if class == STRUCTURE && depth > 0 && dimensions.iter().all(|count| *count == 1) {
        return structure(&mut elements, depth, found);
    }
    if !NUMERIC.contains(&class) {
        return Some(());
    }
    let real = elements.next()?;
    let values = elements.numbers(real)?;
    let count = |index: usize| dimensions.get(index).copied().unwrap_or(1);
    if dimensions.len() != 2 || count(0).checked_mul(count(1))? != values.len() {
        // An array with more than two dimensions isn't a table.
        return Some(());
    }
    let (rows, columns) = if count(0) == 1 { (count(1), 1) } else { (count(0), count(1)) };
    if columns == 1 {
        found.push(Variable { name: name.to_owned(), values });
        return Some(());
    }
    for column in 0..columns {
        let name = format!("{name}(:,{})", column + 1);
        found.push(Variable { name, values: values.get(column * rows..(column + 1) * rows)?.to_vec() });
    }
    Some(())
}

/// The fields of a structure: the length of their names, the names, and an array for each.
fn structure(elements: &mut Elements<'_>, depth: usize, found: &mut Vec<Variable>) -> Option<()> {
    let length = elements.next()?;
    let length = *elements.counts(length)?.first()?;
    let (_, names) = elements.next()?;
    if length == 0 {
        return None;
    }
    for name in names.chunks_exact(length) {
        let (_, bytes) = elements.next()?;
        let end = name.iter().position(|byte| *byte == 0).unwrap_or(length);
        let name = String::from_utf8_lossy(&name[..end]).into_owned();
        array(&elements.within(bytes), Some(&name), depth - 1, found)?;
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::ZlibEncoder};
    use std::io::Write;

    fn element(kind: u32, bytes: &[u8], is_big: bool) -> Vec<u8> {
        let word = |value: u32| if is_big { value.to_be_bytes() } else { value.to_le_bytes() };
        let mut found = [word(kind), word(u32::try_from(bytes.len()).unwrap())].concat();
        found.extend(bytes);
        found.resize(found.len().next_multiple_of(8), 0);
        found
    }

    /// An array of doubles.
    fn doubles(name: &str, rows: u32, values: &[f64], is_big: bool) -> Vec<u8> {
        let word = |value: u32| if is_big { value.to_be_bytes() } else { value.to_le_bytes() };
        let columns = u32::try_from(values.len()).unwrap() / rows;
        let number = |value: &f64| if is_big { value.to_be_bytes() } else { value.to_le_bytes() };
        let body = [
            element(6, &[word(6), word(0)].concat(), is_big),
            element(5, &[word(rows), word(columns)].concat(), is_big),
            element(1, name.as_bytes(), is_big),
            element(9, &values.iter().flat_map(number).collect::<Vec<u8>>(), is_big),
        ];
        element(MATRIX, &body.concat(), is_big)
    }

    fn file(elements: &[Vec<u8>], is_big: bool) -> Vec<u8> {
        let mut bytes = b"MATLAB 5.0 MAT-file, Platform: GLNXA64".to_vec();
        bytes.resize(124, b' ');
        bytes.extend(if is_big { *b"\x01\0MI" } else { *b"\0\x01IM" });
        bytes.extend(elements.concat());
        bytes
    }

    fn compressed(element: &[u8]) -> Vec<u8> {
        let mut packer = ZlibEncoder::new(Vec::new(), Compression::default());
        packer.write_all(element).unwrap();
        let packed = packer.finish().unwrap();
        let length = u32::try_from(packed.len()).unwrap();
        [&COMPRESSED.to_le_bytes()[..], &length.to_le_bytes(), &packed].concat()
    }

    const P: [f64; 4] = [1.0, 2.0, 2.5, 3.0];
    const L: [f64; 4] = [300.0, 299.0, 298.0, 297.5];
    const F: [f64; 4] = [10.0, 20.125, 30.0, 40.0];

    fn variables(is_big: bool) -> Vec<Vec<u8>> {
        vec![
            doubles("p_bar", 4, &P, is_big),
            doubles("L_mm", 1, &L, is_big),
            doubles("force_N", 4, &F, is_big),
            doubles("rate", 1, &[10.0], is_big),
        ]
    }

    #[test]
    fn variables_fields_and_matrices() {
        let plain = ReadOptions::default();
        let packed: Vec<Vec<u8>> = variables(false).iter().map(|element| compressed(element)).collect();
        // One structure: the length of its field names, the names, and an unnamed array for each field.
        let fields = ["p_bar", "L_mm", "force_N"].map(|name| format!("{name:\0<32}")).concat();
        let fields_of =
            [doubles("", 4, &P, false), doubles("", 4, &L, false), doubles("", 4, &F, false)].concat();
        let small = [&[5, 0, 4, 0][..], &32_u32.to_le_bytes()].concat();
        let one = [1_u32.to_le_bytes(); 2].concat();
        let body = [
            element(6, &[2, 0, 0, 0, 0, 0, 0, 0], false),
            element(5, &one, false),
            element(1, b"run", false),
            small,
            element(1, fields.as_bytes(), false),
            fields_of,
        ];
        let structure = element(MATRIX, &body.concat(), false);
        let matrix = doubles("data", 4, &[P, L, F].concat(), false);
        let map = "pressure=data(:,1) [bar],length=data(:,2) [mm],force=data(:,3) [N]".parse().unwrap();
        for (name, bytes, options) in [
            ("plain", file(&variables(false), false), plain.clone()),
            ("big", file(&variables(true), true), plain.clone()),
            ("compressed", file(&packed, false), plain.clone()),
            ("structure", file(&[structure], false), plain.clone()),
            ("matrix", file(&[matrix], false), ReadOptions { columns: map, ..ReadOptions::default() }),
        ] {
            let table = read("d.mat", &bytes, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!((table.columns.force_n.as_slice(), table.lines), (&F[..], vec![1, 2, 3, 4]), "{name}");
            assert_eq!(table.columns.pressure_pa, P.map(|p| p * 1e5), "{name}");
            assert_eq!(table.columns.motion.values(), L.map(|l| l / 1e3), "{name}");
        }
    }

    #[test]
    fn other_and_damaged_files_are_errors() {
        let says = |bytes: &[u8]| read("d.mat", bytes, &ReadOptions::default()).unwrap_err().to_string();
        assert!(says(b"MATLAB 7.3 MAT-file, HDF5").contains("`save('x.mat','-v7')`"));
        assert!(says(&file(&[], false)).contains("no numeric vectors"));
        let bytes = file(&variables(false), false);
        assert!(says(&bytes[..200]).contains("damaged"));
        let mut state = 1_u64;
        let mut next = |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % below
        };
        for round in 0..5000 {
            let mut changed =
                if round % 2 == 0 { bytes.clone() } else { file(&[compressed(&variables(false)[0])], false) };
            for _ in 0..=next(4) {
                let at = next(changed.len());
                changed[at] = u8::try_from(next(256)).unwrap();
            }
            if let Err(error) = read("d.mat", &changed, &ReadOptions::default()) {
                assert!(error.to_string().contains("d.mat"), "{error}");
            }
        }
    }
}
