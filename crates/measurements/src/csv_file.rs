//! CSV: lines, comments, separators and quotes; every defect is one message with its line.
//!
//! Read by lines rather than by records: comments, blank lines and line breaks of any kind keep their true line numbers,
//! and a quote that is never closed is an error on its own line instead of a field with the rest of the file in it.

use crate::columns::Columns;
use crate::error::MeasurementError;
use crate::heading;
use crate::quote::quoted;
use crate::slot::{Slot, columns};
use std::borrow::Cow;

/// Most bytes of a line.
pub(crate) const MOST_BYTES_PER_LINE: usize = 1_000_000;
/// Most rows of a file.
pub(crate) const MOST_ROWS: usize = 20_000_000;
/// What may stand between fields; where a header has several kinds, the one it has most of.
const SEPARATORS: [u8; 3] = [b',', b';', b'\t'];

/// A table and, for each row, its line in the file.
#[derive(Debug)]
pub(crate) struct Table {
    pub(crate) columns: Columns,
    pub(crate) lines: Vec<u32>,
}

/// Reads CSV. `file` is its name, for messages.
pub(crate) fn read(file: &str, bytes: &[u8]) -> Result<Table, MeasurementError> {
    let text = checked_text(file, bytes)?;
    // A file without any line feed may have the carriage returns of old.
    let is_old = !text.contains('\n') && text.contains('\r');
    let mut lines = text.split(if is_old { '\r' } else { '\n' }).enumerate();
    // Spreadsheets write their separator on a line of its own.
    let is_content = |line: &str| {
        let is_hint =
            line.len() == 5 && line.get(..4).is_some_and(|start| start.eq_ignore_ascii_case("sep="));
        let is_empty = line.bytes().all(|byte| SEPARATORS.contains(&byte));
        !(is_empty || line.starts_with('#') || is_hint)
    };
    let header = lines.by_ref().map(|(i, line)| (i + 1, line.trim())).find(|(_, line)| is_content(line));
    let Some((header_line, header)) = header else {
        return Err(MeasurementError::Empty { file: file.to_owned() });
    };
    checked_length(file, header_line, header)?;
    let separator = separator(header);
    let mut fields = Vec::new();
    split(header, separator, &mut fields)
        .ok_or_else(|| MeasurementError::OpenQuote { file: file.to_owned(), line: header_line })?;
    unpad(&mut fields, 1);
    if let [field] = fields.as_slice()
        && field.parse::<f64>().is_err()
    {
        let text = quoted(field);
        return Err(MeasurementError::OneField {
            file: file.to_owned(),
            line: header_line,
            text,
            known: heading::known(),
        });
    }
    let names: Vec<&str> = fields.iter().map(AsRef::as_ref).collect();
    let headings = heading::read(file, header_line, &names)?;
    // A guess from the header's length; too small costs a few copies, too large only address space.
    let rows = (text.len() / header.len().max(1)).min(1 << 20);
    let mut slots: Vec<Slot> = headings.into_iter().map(|heading| Slot::new(heading, rows)).collect();
    let mut numbers = Vec::new();
    for (i, line) in lines {
        let content = without_line_end(line);
        if is_blank(content, separator) {
            continue;
        }
        if numbers.len() >= MOST_ROWS {
            return Err(MeasurementError::TooManyRows {
                file: file.to_owned(),
                line: i + 1,
                limit: MOST_ROWS,
            });
        }
        checked_length(file, i + 1, content)?;
        read_row(file, i + 1, content, separator, &mut fields, &mut slots)?;
        numbers.push(u32::try_from(i + 1).unwrap_or(u32::MAX));
    }
    if numbers.is_empty() {
        return Err(MeasurementError::NoRows { file: file.to_owned() });
    }
    Ok(Table { columns: columns(slots), lines: numbers })
}

/// The fields of one row into their columns.
fn read_row<'a>(
    file: &str,
    line: usize,
    content: &'a str,
    separator: u8,
    fields: &mut Vec<Cow<'a, str>>,
    slots: &mut [Slot],
) -> Result<(), MeasurementError> {
    split(content, separator, fields)
        .ok_or_else(|| MeasurementError::OpenQuote { file: file.to_owned(), line })?;
    unpad(fields, slots.len());
    if fields.len() != slots.len() {
        let (found, expected) = (fields.len(), slots.len());
        return Err(MeasurementError::Ragged { file: file.to_owned(), line, found, expected });
    }
    for (slot, field) in slots.iter_mut().zip(fields.iter()) {
        slot.push_text(field).map_err(|problem| MeasurementError::Cell {
            file: file.to_owned(),
            line,
            column: slot.heading.text.clone(),
            problem,
        })?;
    }
    Ok(())
}

/// UTF-8 without a byte order mark and without NUL.
fn checked_text<'a>(file: &str, bytes: &'a [u8]) -> Result<&'a str, MeasurementError> {
    let file_name = || file.to_owned();
    let line_at = |at: usize| bytes[..at].split(|byte| *byte == b'\n').count();
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(MeasurementError::Utf16 { file: file_name() });
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let at = error.valid_up_to();
        let byte = bytes.get(at).copied().unwrap_or_default();
        MeasurementError::NotUtf8 { file: file_name(), line: line_at(at), byte }
    })?;
    if let Some(at) = bytes.iter().position(|byte| *byte == 0) {
        return Err(MeasurementError::NulByte { file: file_name(), line: line_at(at) });
    }
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

fn checked_length(file: &str, line: usize, content: &str) -> Result<(), MeasurementError> {
    let (bytes, limit) = (content.len(), MOST_BYTES_PER_LINE);
    if bytes > limit {
        return Err(MeasurementError::LineTooLong { file: file.to_owned(), line, bytes, limit });
    }
    Ok(())
}

/// Without the carriage return of CRLF. Tabs stay: at the end of a row they separate an empty field.
fn without_line_end(line: &str) -> &str {
    line.strip_suffix('\r').unwrap_or(line)
}

/// Whether a line has nothing but a comment, or separators: an empty row of a spreadsheet.
fn is_blank(content: &str, separator: u8) -> bool {
    let start = content.trim_ascii_start();
    start.starts_with('#') || start.bytes().all(|byte| byte == separator || byte.is_ascii_whitespace())
}

/// Without empty fields beyond `width`: spreadsheets pad all rows to the longest.
fn unpad(fields: &mut Vec<Cow<'_, str>>, width: usize) {
    while fields.len() > width && fields.last().is_some_and(|field| field.is_empty()) {
        fields.pop();
    }
}

fn separator(header: &str) -> u8 {
    let count = |separator: u8| header.bytes().filter(|byte| *byte == separator).count();
    // `max_by_key` takes the last of equals: a comma before others.
    SEPARATORS.into_iter().rev().max_by_key(|separator| count(*separator)).unwrap_or(b',')
}

/// Splits a line into fields without the blanks around them; none if a quote stays open or is followed by more text.
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

/// The text up to the closing quote, and what follows; two quotes stand for one.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::Trace;

    const HEADER: &str = "pressure [bar],length [mm],force [N]\n";

    #[track_caller]
    fn reads(text: &str) -> Table {
        read("d.csv", text.as_bytes()).unwrap()
    }

    #[track_caller]
    fn refuses(bytes: &[u8], line: Option<usize>, parts: &[&str]) {
        let error = read("d.csv", bytes).unwrap_err();
        let message = error.to_string();
        assert_eq!(error.line(), line, "{message}");
        for part in parts.iter().chain(&["d.csv"]) {
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
        assert!(!message.contains('\n') && message.len() < 700, "{message}");
    }

    #[test]
    fn the_same_rows_in_every_dialect() {
        let expected = reads(&format!("{HEADER}1,300,10\n2,290,20\n")).columns;
        assert_eq!(expected.pressure_pa, [1e5, 2e5]);
        assert_eq!(expected.motion, Trace::Length(vec![0.3, 0.29]));
        for text in [
            "\u{feff}# a comment\r\npressure [bar],length [mm],force [N]\r\n1,300,10\r\n\r\n2,290,20",
            "pressure [bar];length [mm];force [N]\n1;300;10\n# between\n2;290;20\n",
            "pressure [bar]\tlength [mm]\tforce [N]\n1\t300\t10\n2\t290\t20\n",
            "\"pressure [bar]\",\"length [mm]\",force [N]\n\"1\", \"300\" ,10\n 2 , 290 ,\"20\"\n",
            "force [N],length [m],pressure [kPa]\n10,0.3,100\n20,0.29,200\n",
            "pressure [bar],length [mm],force [N]\r1,300,10\r2,290,20\r",
            "sep=;\r\n;;;\r\npressure [bar];length [mm];force [N];;\r\n1;300;10;;\r\n;;;;\r\n2;290;20\r\n",
            "pressure [bar]\tlength [mm]\tforce [N]\t\n1\t300\t10\t\n\t\t\t\n2\t290\t20\n",
            "  # indented \"comment, with quote\n\n pressure [bar] , length [mm] , force [N] \n  #x\n1,300,10\n2,290,20\n",
        ] {
            assert_eq!(reads(text).columns, expected, "{text}");
        }
    }

    #[test]
    fn rows_know_their_lines() {
        let text = format!("# one\n\n{HEADER}1,300,10\n# five\n\r\n2,290,20\r\n3,280,30");
        assert_eq!(reads(&text).lines, [4, 7, 8]);
    }

    #[test]
    fn labels_and_quotes() {
        let text = "specimen,pressure [bar],length [mm],force [N],sweep,cycle,direction\n\
                    \"left, \"\"old\"\"\",1,300,10,run A,1,up\nright,1,300,10,2,2,-1\n";
        let columns = reads(text).columns;
        assert_eq!(columns.specimen.unwrap().names(), ["left, \"old\"", "right"]);
        assert_eq!(columns.sweep.unwrap().names(), ["run A", "2"]);
        assert_eq!((columns.cycle, columns.direction), (Some(vec![1, 2]), Some(vec![1, -1])));
    }

    #[test]
    fn each_defect_has_its_message() {
        let with = |row: &str| format!("{HEADER}1,300,10\n{row}\n").into_bytes();
        refuses(b"", None, &["empty", "header"]);
        refuses(b"\n# only a comment\n\n", None, &["empty"]);
        refuses(HEADER.as_bytes(), None, &["no row"]);
        refuses(b"1,2,3\n1,2,3\n", Some(1), &["`1`", "header"]);
        refuses(&with("1,2 mm,3"), Some(3), &["`length [mm]`", "`2 mm`", "write `2`"]);
        refuses(&with("1,abc,3"), Some(3), &["`length [mm]`", "`abc` is not a number"]);
        refuses(&with("1,,3"), Some(3), &["`length [mm]`", "empty"]);
        refuses(&with("1,nan,3"), Some(3), &["`nan`", "finite"]);
        refuses(&with("1,1e400,3"), Some(3), &["`1e400`", "finite"]);
        refuses(&with("1e308,300,3"), Some(3), &["`1e308`", "finite"]);
        refuses(&with("1,1e40,3"), Some(3), &["`1e40` is larger"]);
        refuses(&with("1,2"), Some(3), &["2 fields", "3"]);
        refuses(&with("end of test"), Some(3), &["has 1 field, the header has 3"]);
        refuses(&with("1 kPa,2,3"), Some(3), &["`1 kPa`", "write `0.01`, the number alone"]);
        refuses(&with("1 N,2,3"), Some(3), &["`1 N`", "write the number alone, in the unit of the header"]);
        refuses(&with("1,2,3,,4"), Some(3), &["5 fields"]);
        refuses(
            b"Test of 3 March\n1,2,3\n",
            Some(1),
            &["`Test of 3 March`", "single field", "begin comments with `#`", "force [N]"],
        );
        refuses(b"pressure [bar]|length [mm]\n", Some(1), &["single field", "commas, semicolons or tabs"]);
        refuses(b"1,5;300;10\n", Some(1), &["`1,5` is a number", "header"]);
        refuses(&with("1,2,3,4"), Some(3), &["4 fields", "surplus"]);
        refuses(&with("1,5,290,0,20,5"), Some(3), &["6 fields", "decimal points"]);
        refuses(&with("1,\"2,3"), Some(3), &["not closed"]);
        refuses(&with("1,\"2\"x,3"), Some(3), &["not closed"]);
        refuses(b"pressure [bar];length [mm];force [N]\n1,5;300;10\n", Some(2), &["decimal comma", "`1.5`"]);
        refuses(&with("1,3\u{0}0,3"), Some(3), &["NUL"]);
        let mut latin = with("1,2,3");
        latin.extend(b"# 20 \xb0C\n");
        refuses(&latin, Some(4), &["0xB0", "UTF-8"]);
        refuses(b"\xff\xfep\0r\0", Some(1), &["UTF-16"]);
        let mut long = with("1,2,3");
        long.extend(vec![b'7'; 10_000_000]);
        refuses(&long, Some(4), &["10000000 bytes", "1000000"]);
        refuses(&vec![b'p'; 2_000_000], Some(1), &["2000000 bytes"]);
    }
}
