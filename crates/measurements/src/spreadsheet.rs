//! Excel workbooks: the first sheet with a table, read like text with tabs between fields.

use crate::csv_file;
use crate::error::MeasurementError;
use crate::line::Separator;
use crate::quote::quoted;
use crate::reading::ReadOptions;
use crate::source::has_room;
use crate::table::Table;
use bulge_muscles::shown::listed;
use calamine::{DataRef, ExcelDateTime, Reader, Xlsx, XlsxError};
use std::fmt::Write;
use std::io::Cursor;
use std::panic::catch_unwind;

/// The first bytes of a ZIP archive; such a workbook is one.
const ZIP_MAGIC: &[u8] = b"PK\x03\x04";
/// Most bytes of a sheet as text.
const MOST_BYTES: usize = 1 << 30;
/// Rows and columns of a sheet of Excel.
const MAX_ROWS: u32 = 1 << 20;
const MAX_COLUMNS: u32 = 1 << 14;
/// Seconds of a day: dates are stored in days.
const DAY: f64 = 86_400.0;

/// Whether bytes are such a workbook, or another archive.
pub(crate) fn is_one(bytes: &[u8]) -> bool {
    bytes.starts_with(ZIP_MAGIC)
}

/// Reads the named sheet of a workbook, otherwise the first one with a table. `file` is its name in messages.
pub(crate) fn read(
    file: &str,
    bytes: &[u8],
    sheet: Option<&str>,
    options: &ReadOptions,
) -> Result<Table, MeasurementError> {
    // The library counts cells without a check for overflow, and a damaged workbook must not end the program.
    catch_unwind(|| read_sheet(file, bytes, sheet, options))
        .unwrap_or_else(|_| Err(refused(file, &XlsxError::Unexpected("it is damaged"))))
}

fn read_sheet(
    file: &str,
    bytes: &[u8],
    sheet: Option<&str>,
    options: &ReadOptions,
) -> Result<Table, MeasurementError> {
    let mut book = Xlsx::new(Cursor::new(bytes)).map_err(|error| refused(file, &error))?;
    let names = book.sheet_names().clone();
    if let Some(sheet) = sheet {
        if names.iter().any(|name| name == sheet) {
            return one(&mut book, file, sheet, options)
                .unwrap_or_else(|| Err(MeasurementError::empty(file)));
        }
        let what = format!("there is no sheet `{}`: there are {}", quoted(sheet), listed(20, "`", &names));
        return Err(MeasurementError::of_file(file, what));
    }
    let mut complaint = None;
    for (place, name) in names.iter().enumerate() {
        match one(&mut book, file, name, options) {
            Some(Ok(mut table)) => {
                table.reading.notes.extend(other_sheets(&mut book, file, &names, place, options));
                return Ok(table);
            }
            Some(Err(error @ MeasurementError::TooLarge { .. })) => return Err(error),
            // The first sheet with content is the intended one, so its error is reported.
            Some(Err(error)) => {
                complaint.get_or_insert(error);
            }
            None => {}
        }
    }
    Err(complaint.unwrap_or_else(|| MeasurementError::empty(file)))
}

/// Reports which sheet was read, and which other tables there are.
fn other_sheets(
    book: &mut Xlsx<Cursor<&[u8]>>,
    file: &str,
    names: &[String],
    read: usize,
    options: &ReadOptions,
) -> Option<String> {
    let others: Vec<&String> = names[read + 1..]
        .iter()
        .filter(|name| matches!(one(book, file, name, options), Some(Ok(_))))
        .collect();
    let what = format!("{file}: read from the sheet `{}`", quoted(&names[read]));
    match others.first() {
        None => (names.len() > 1).then_some(what),
        Some(_) => Some(format!(
            "{what}, not from {}: name each that is to be read, such as `{file}#{}`",
            listed(20, "`", others),
            quoted(&names[read])
        )),
    }
}

/// Reads one sheet; none if it is empty.
fn one(
    book: &mut Xlsx<Cursor<&[u8]>>,
    file: &str,
    sheet: &str,
    options: &ReadOptions,
) -> Option<Result<Table, MeasurementError>> {
    Some(match text(book, file, sheet) {
        Ok(text) if text.trim().is_empty() => return None,
        Ok(text) if text.len() > MOST_BYTES => {
            let (bytes, limit) = (text.len() as u64, MOST_BYTES as u64);
            Err(MeasurementError::TooLarge { file: file.to_owned(), bytes, limit })
        }
        Ok(text) => csv_file::read_text(file, &text, Some(Separator::Byte(b'\t')), options),
        Err(error) => Err(error),
    })
}

fn refused(file: &str, why: &XlsxError) -> MeasurementError {
    let why = quoted(&why.to_string());
    let cure = "unpack it if it is another archive, save it as .xlsx again, or export the sheet as CSV";
    MeasurementError::of_file(file, format!("can't be read as an Excel workbook ({why}): {cure}"))
}

/// A sheet as tab-separated lines with the same line numbers.
fn text(book: &mut Xlsx<Cursor<&[u8]>>, file: &str, name: &str) -> Result<String, MeasurementError> {
    let refused = |error: XlsxError| refused(file, &error);
    let mut cells = book.worksheet_cells_reader(name).map_err(refused)?;
    let (mut text, mut line, mut field) = (String::new(), 0, 0);
    let mut checked = 0;
    while let Some(cell) = cells.next_cell().map_err(refused)? {
        // The text takes twice its memory while it grows.
        if text.len() >= checked {
            checked = 2 * text.len();
            has_room(file, checked as u64)?;
        }
        let (row, column) = cell.get_position();
        // A damaged workbook may put a cell anywhere below 2^32, and every line up to there would be written.
        if row >= MAX_ROWS {
            return Err(refused(XlsxError::RowNumberOverflow));
        }
        if column >= MAX_COLUMNS {
            return Err(refused(XlsxError::ColumnNumberOverflow));
        }
        // A cell out of order would belong to a line that is complete already.
        if row < line || (row == line && column < field) || text.len() > MOST_BYTES {
            continue;
        }
        if row > line {
            text.extend(std::iter::repeat_n('\n', (row - line) as usize));
            (line, field) = (row, 0);
        }
        text.extend(std::iter::repeat_n('\t', (column - field) as usize));
        field = column;
        push(&mut text, cell.get_value());
    }
    Ok(text)
}

/// Writes a cell so that its type is recognised when it is read.
fn push(text: &mut String, value: &DataRef<'_>) {
    let plain = |text: &mut String, value: &str| {
        let is_odd = |c: char| c.is_control() || c == '"';
        // A line break within a heading becomes a blank.
        let value = value.trim().replace(is_odd, " ");
        text.push_str(&value);
    };
    // Writing to a String can't fail.
    let _ = match value {
        DataRef::Int(number) => write!(text, "{number}"),
        DataRef::Float(number) => write!(text, "{number}"),
        DataRef::Bool(flag) => write!(text, "{}", i32::from(*flag)),
        DataRef::DateTime(when) => write!(text, "{}", clock(when)),
        DataRef::Error(error) => write!(text, "{error}"),
        DataRef::String(value) | DataRef::DateTimeIso(value) | DataRef::DurationIso(value) => {
            plain(text, value);
            Ok(())
        }
        DataRef::SharedString(value) => {
            plain(text, value);
            Ok(())
        }
        DataRef::Empty => Ok(()),
    };
}

/// A date with its time, or a time alone.
fn clock(when: &ExcelDateTime) -> String {
    let days = when.as_f64();
    // Whole microseconds: the last digits of a date are rounding errors.
    let seconds = |days: f64| (days * DAY * 1e6).round() / 1e6;
    let shown = |seconds: f64| {
        let minutes = (seconds / 60.0).floor();
        let (hours, rest) = ((minutes / 60.0).floor(), seconds - 60.0 * minutes);
        format!("{hours}:{}:{rest:.6}", minutes - 60.0 * hours)
    };
    if when.is_duration() || !(1.0..3e6).contains(&days) {
        return shown(seconds(days.clamp(0.0, 400.0)));
    }
    let (year, month, day, ..) = when.to_ymd_hms_milli();
    format!("{year:04}-{month:02}-{day:02} {}", shown(seconds(days.fract())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Crc;

    /// An archive of uncompressed files.
    fn archive(files: &[(&str, String)]) -> Vec<u8> {
        let (mut bytes, mut list) = (Vec::new(), Vec::new());
        for (name, text) in files {
            let mut crc = Crc::new();
            crc.update(text.as_bytes());
            let size = u32::try_from(text.len()).unwrap().to_le_bytes();
            let start = u32::try_from(bytes.len()).unwrap();
            // Version, flags, method, time, date; checksum, sizes; lengths of name and extra field.
            let mut head = vec![20, 0, 0, 0, 0, 0, 0, 0, 33, 0];
            head.extend(crc.sum().to_le_bytes());
            head.extend([size, size].concat());
            head.extend(u16::try_from(name.len()).unwrap().to_le_bytes());
            head.extend([0, 0]);
            bytes.extend(b"PK\x03\x04");
            bytes.extend(&head);
            bytes.extend(name.as_bytes());
            bytes.extend(text.as_bytes());
            list.extend(b"PK\x01\x02\x14\x00");
            list.extend(&head);
            list.extend([0; 10]);
            list.extend(start.to_le_bytes());
            list.extend(name.as_bytes());
        }
        let (start, count) = (u32::try_from(bytes.len()).unwrap(), u16::try_from(files.len()).unwrap());
        let size = u32::try_from(list.len()).unwrap();
        bytes.extend(list);
        bytes.extend(b"PK\x05\x06\0\0\0\0");
        bytes.extend([count.to_le_bytes(), count.to_le_bytes()].concat());
        bytes.extend([size.to_le_bytes(), start.to_le_bytes()].concat());
        bytes.extend([0, 0]);
        bytes
    }

    const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>";
    const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";

    /// A workbook with sheets of cells, which are text or numbers, or a number at another place (`A7|5`).
    pub(crate) fn workbook(sheets: &[&[&[&str]]]) -> Vec<u8> {
        let package = "http://schemas.openxmlformats.org/package/2006";
        let office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
        let (mut list, mut relations, mut files) = (String::new(), String::new(), Vec::new());
        for (i, rows) in sheets.iter().enumerate() {
            let n = i + 1;
            let _ = write!(list, "<sheet name=\"S{n}\" sheetId=\"{n}\" r:id=\"r{n}\"/>");
            let _ = write!(
                relations,
                "<Relationship Id=\"r{n}\" Type=\"{office}/worksheet\" Target=\"worksheets/sheet{n}.xml\"/>"
            );
            let mut data = String::new();
            for (row, cells) in rows.iter().enumerate() {
                let _ = write!(data, "<row r=\"{}\">", row + 1);
                for (column, cell) in cells.iter().enumerate().filter(|(_, cell)| !cell.is_empty()) {
                    let place = format!("{}{}", char::from(b'A' + u8::try_from(column).unwrap()), row + 1);
                    let _ = if let Some((place, value)) = cell.split_once('|') {
                        write!(data, "<c r=\"{place}\"><v>{value}</v></c>")
                    } else if let Some(date) = cell.strip_prefix('@') {
                        write!(data, "<c r=\"{place}\" s=\"1\"><v>{date}</v></c>")
                    } else if cell.parse::<f64>().is_ok() {
                        write!(data, "<c r=\"{place}\"><v>{cell}</v></c>")
                    } else {
                        write!(data, "<c r=\"{place}\" t=\"inlineStr\"><is><t>{cell}</t></is></c>")
                    };
                }
                data.push_str("</row>");
            }
            let sheet =
                format!("{HEAD}<worksheet xmlns=\"{MAIN}\"><sheetData>{data}</sheetData></worksheet>");
            files.push((format!("xl/worksheets/sheet{n}.xml"), sheet));
        }
        let types = format!(
            "{HEAD}<Types xmlns=\"{package}/content-types\"><Default Extension=\"xml\" ContentType=\"application/xml\"/></Types>"
        );
        let top = format!(
            "{HEAD}<Relationships xmlns=\"{package}/relationships\"><Relationship Id=\"r1\" Type=\"{office}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
        );
        let book = format!(
            "{HEAD}<workbook xmlns=\"{MAIN}\" xmlns:r=\"{office}\"><sheets>{list}</sheets></workbook>"
        );
        let styles = format!(
            "{HEAD}<styleSheet xmlns=\"{MAIN}\"><cellXfs count=\"2\"><xf numFmtId=\"0\"/><xf numFmtId=\"22\"/></cellXfs></styleSheet>"
        );
        let inner = format!(
            "{HEAD}<Relationships xmlns=\"{package}/relationships\">{relations}<Relationship Id=\"rs\" Type=\"{office}/styles\" Target=\"styles.xml\"/></Relationships>"
        );
        let mut all = vec![
            ("[Content_Types].xml", types),
            ("_rels/.rels", top),
            ("xl/workbook.xml", book),
            ("xl/styles.xml", styles),
            ("xl/_rels/workbook.xml.rels", inner),
        ];
        all.extend(files.iter().map(|(name, text)| (name.as_str(), text.clone())));
        archive(&all)
    }

    #[test]
    fn a_sheet_with_metadata_units_and_gaps() {
        let bytes = workbook(&[
            &[&["Notes"], &["only text"]],
            &[
                &["Operator", "me"],
                &[],
                &["Time", "Druck", "L\u{e4}nge", "Kraft", "Note"],
                &["", "bar", "mm", "N"],
                &["@46082.5", "2.5", "300", "812.25", "start"],
                &["@46082.50001157407", "2.5", "298.5", "790.125"],
                &["@46082.50002314815", "2.5", "297", "771"],
                &["@46082.50003472222", "2.5", "295.5", "752.5"],
                &["@46082.50004629630", "2.5", "294", "#N/A"],
            ],
        ]);
        let table = read("d.xlsx", &bytes, None, &ReadOptions::default()).unwrap();
        assert_eq!(table.columns.force_n, [812.25, 790.125, 771.0, 752.5]);
        assert_eq!(table.columns.pressure_pa, [2.5e5; 4]);
        let time = table.columns.time_s.unwrap();
        for (found, expected) in time.iter().zip([0.0, 1.0, 2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-5, "{time:?}");
        }
        assert_eq!(table.lines, [5, 6, 7, 8]);
        assert_eq!(table.reading.set_apart[0].row, 9);
        assert!(
            table.reading.notes.iter().any(|note| note.contains("the sheet `S2`")),
            "{:?}",
            table.reading.notes
        );
    }

    #[test]
    fn sheets_by_their_names() {
        let head: &[&str] = &["pressure [bar]", "length [mm]", "force [N]"];
        let bytes = workbook(&[&[head, &["1", "300", "5"]], &[head, &["2", "300", "9"]], &[&["Notes"]]]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("b.xlsx");
        std::fs::write(&path, bytes).unwrap();
        let name = |sheet: &str| format!("{}#{sheet}", path.display());
        let both = crate::Data::read(&[name("S1"), name("S2")]).unwrap();
        assert_eq!(both.force(), [5.0, 9.0]);
        let first = crate::Data::read(&[&path]).unwrap();
        let notes = first.reading().notes.join("\n");
        assert!(notes.contains("the sheet `S1`, not from `S2`: name each"), "{notes}");
        let error = crate::Data::read(&[name("S4")]).unwrap_err().to_string();
        assert!(error.contains("no sheet `S4`: there are `S1`, `S2`, `S3`"), "{error}");
    }

    #[test]
    fn cells_far_outside_of_a_sheet_are_errors() {
        for place in ["A4000000000|5", "ZZZZ7|5"] {
            let bytes = workbook(&[&[&["pressure [bar]", "length [mm]", "force [N]"], &["1", "300", place]]]);
            let error = read("d.xlsx", &bytes, None, &ReadOptions::default()).unwrap_err().to_string();
            assert!(
                error.contains("can't be read as an Excel workbook (") && error.contains("number overflow"),
                "{error}"
            );
        }
    }

    #[test]
    fn damaged_workbooks_are_errors() {
        let bytes = workbook(&[&[
            &["pressure [bar]", "length [mm]", "force [N]"],
            &["1", "300", "5"],
            &["1", "290", "4"],
        ]]);
        assert!(read("d.xlsx", &bytes, None, &ReadOptions::default()).is_ok());
        let mut state = 1_u64;
        let mut next = |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % below
        };
        for _ in 0..2000 {
            let mut changed = bytes.clone();
            for _ in 0..=next(4) {
                let at = next(changed.len());
                changed[at] = u8::try_from(next(256)).unwrap();
            }
            changed.truncate(bytes.len() - if next(8) == 0 { next(bytes.len()) } else { 0 });
            if let Err(error) = read("d.xlsx", &changed, None, &ReadOptions::default()) {
                assert!(error.to_string().contains("d.xlsx"), "{error}");
            }
        }
    }
}
