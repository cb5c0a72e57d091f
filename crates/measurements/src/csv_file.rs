//! Reads text: metadata, comments, a header, units beneath, rows. Every defect is one message with its line.
//!
//! The text is read by lines rather than by records. In this way comments, blank lines and line breaks of any
//! kind keep their true line numbers, and a quote that is never closed only spoils its own line.

use crate::assignment::{Header, assign};
use crate::encoding;
use crate::error::MeasurementError;
use crate::heading::Heading;
use crate::layout::{self, Layout};
use crate::line::{Separator, checked_length, unpad, without_line_end};
use crate::quote::quoted;
use crate::reading::ReadOptions;
use crate::slot::Slot;
use crate::source::has_room;
use crate::table::{Draft, Table, bytes_per_row};

/// Most rows of a file.
pub(crate) const MOST_ROWS: usize = 20_000_000;

/// Reads text. `file` is its name, for messages.
pub(crate) fn read(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Table, MeasurementError> {
    let (text, encoding) = encoding::text(file, bytes)?;
    let mut table = read_text(file, &text, None, options)?;
    table.reading.notes.extend(encoding.map(|name| format!("{file}: read as {name}")));
    Ok(table)
}

/// Reads the lines of a text; the separator is given or detected.
pub(crate) fn read_text(
    file: &str,
    text: &str,
    separator: Option<Separator>,
    options: &ReadOptions,
) -> Result<Table, MeasurementError> {
    // A file without line feeds may use the old carriage returns.
    let line_end = if !text.contains('\n') && text.contains('\r') { '\r' } else { '\n' };
    let joined = layout::with_one_line_header(text, line_end);
    let text = joined.as_deref().unwrap_or(text);
    let layout = layout::find(file, text, (line_end, separator), &options.columns)?;
    complain_of_header(file, &layout)?;
    let header = Header {
        file,
        line: layout.line,
        names: &layout.names,
        units: layout.units.as_deref(),
        first: &layout.first,
    };
    let assignment = assign(&header, options)?;
    let headings = assignment.headings.into_iter().enumerate();
    let (places, headings): (Vec<usize>, Vec<Heading>) =
        headings.filter_map(|(place, heading)| Some((place, heading?))).unzip();
    // At most one row for each line, and a digit with a separator for each of its fields.
    let lines = text.bytes().filter(|byte| char::from(*byte) == line_end).count() + 1;
    let rows = lines.min(text.len() / (2 * places.len()).max(1) + 1).min(MOST_ROWS);
    has_room(file, (rows * bytes_per_row(places.len())) as u64)?;
    let slots = headings.into_iter().map(|heading| Slot::new(heading, rows)).collect();
    let mut draft = Draft::new(slots, assignment.uses, "line");
    draft.lines.reserve_exact(rows);
    draft.notes.extend(layout.notes.iter().map(|note| format!("{file}: {note}")));
    let mut fields = Vec::new();
    for (i, line) in text.split(line_end).enumerate().skip(layout.rows_from) {
        let content = without_line_end(line);
        if layout.separator.is_blank(content) {
            continue;
        }
        let row = draft.lines.len();
        if row >= MOST_ROWS {
            return Err(MeasurementError::too_many_rows(file, i + 1));
        }
        checked_length(file, i + 1, content)?;
        draft.lines.push(u32::try_from(i + 1).unwrap_or(u32::MAX));
        if layout.separator.split(content, &mut fields).is_none() {
            draft.broken(
                row,
                "a quoted field is not closed on its line",
                "a quoted field is not closed".to_owned(),
            );
            continue;
        }
        unpad(&mut fields, layout.names.len());
        let (found, expected) = (fields.len(), layout.names.len());
        let least = places.last().map_or(0, |place| place + 1);
        if found > expected || found < least {
            let kind =
                if found > expected { "more fields than the header" } else { "fewer fields than the header" };
            let plural = if found == 1 { "" } else { "s" };
            draft.broken(row, kind, format!("the row has {found} field{plural}, the header has {expected}"));
            continue;
        }
        if fields[0] == layout.names[0] && fields.iter().zip(&layout.names).all(|(field, name)| field == name)
        {
            draft.broken(row, "the header again", "the header again".to_owned());
            continue;
        }
        let mut spoilt = 0;
        for (slot, place) in places.iter().enumerate() {
            if let Err(problem) = draft.slots[slot].push_text(&fields[*place], layout.decimal) {
                spoilt += 1;
                draft.spoilt(slot, row, &problem);
            }
        }
        if spoilt == places.len() && layout::names_columns(&fields) {
            let columns: Vec<String> = fields.iter().map(|name| format!("`{}`", quoted(name))).collect();
            let what = format!(
                "another table begins here, with the columns {}: write it into a file of its own, and name both files",
                columns.join(", ")
            );
            return Err(MeasurementError::at(file, i + 1, what));
        }
    }
    draft.finish(file, options)
}

/// Complains about an impossible header: a single field, or numbers.
fn complain_of_header(file: &str, layout: &Layout) -> Result<(), MeasurementError> {
    let line = layout.line;
    if line == 0 {
        return Ok(());
    }
    let first = layout.names.first().map_or("", String::as_str);
    let is_number = first.trim().replacen(',', ".", 1).parse::<f64>().is_ok();
    if is_number && layout.names.iter().all(|name| name.trim().replacen(',', ".", 1).parse::<f64>().is_ok()) {
        let what = format!(
            "`{}` is a number where a column's name is needed: write a header first, such as `pressure [bar],length [mm],force [N]`, or say the columns by their numbers, such as `--columns \"time=1 [s],pressure=2 [bar],length=3 [mm],force=4 [N]\"`",
            quoted(first)
        );
        return Err(MeasurementError::at(file, line, what));
    }
    if layout.names.len() == 1 {
        return Err(MeasurementError::one_field(file, line, first));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::Trace;

    const HEADER: &str = "pressure [bar],length [mm],force [N]\n";

    #[track_caller]
    fn reads(text: &str) -> Table {
        read("d.csv", text.as_bytes(), &ReadOptions::default()).unwrap()
    }

    #[track_caller]
    fn refuses(bytes: &[u8], line: Option<usize>, parts: &[&str]) {
        let error = read("d.csv", bytes, &ReadOptions::default()).unwrap_err();
        let message = error.to_string();
        assert_eq!(error.line(), line, "{message}");
        for part in parts.iter().chain(&["d.csv"]) {
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
        assert!(message.len() < 900, "{message}");
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
        refuses(b"", None, &["empty", "header"]);
        refuses(b"\n# only a comment\n\n", None, &["empty"]);
        refuses(HEADER.as_bytes(), None, &["no row"]);
        refuses(b"1,2,3\n1,2,3\n", Some(1), &["`1`", "header"]);
        refuses(
            b"Test of 3 March\n1,2,3\n",
            Some(1),
            &["`Test of 3 March`", "single field", "begin comments with `#`", "force [N]"],
        );
        refuses(b"pressure [bar]|length [mm]\n", Some(1), &["single field", "commas, semicolons or tabs"]);
        refuses(b"1,5;300;10\n", Some(1), &["`1,5` is a number", "header"]);
        let mut nul = HEADER.as_bytes().to_vec();
        nul.extend(b"1,3\x000,3\n");
        refuses(&nul, Some(2), &["NUL"]);
        let mut long = format!("{HEADER}1,2,3\n1,2,3\n").into_bytes();
        long.extend(vec![b'7'; 10_000_000]);
        refuses(&long, Some(4), &["10000000 bytes", "1000000"]);
        refuses(&vec![b'p'; 2_000_000], Some(1), &["2000000 bytes"]);
    }

    /// An unusable row is set apart with its line and its reason, and the others are read.
    #[test]
    fn rows_that_can_not_be_used() {
        for (row, reason) in [
            ("1,2 N,3", "`length [mm]`: `2 N` is another unit than the column's"),
            ("1,abc,3", "`length [mm]`: `abc` is not a number"),
            ("1,#N/A,3", "`length [mm]`: `#N/A` is not a number"),
            ("#N/A,290,3", "`pressure [bar]`: `#N/A` is not a number"),
            ("1,,3", "`length [mm]` is empty"),
            ("1,nan,", "`length [mm]`: `nan` is not a finite number; `force [N]` is empty"),
            ("1,1e400,3", "`length [mm]`: `1e400` is not a finite number"),
            ("1e308,300,3", "`pressure [bar]`: `1e308` is not a finite number"),
            ("1,1e40,3", "`length [mm]`: `1e40` is larger than anything that is measured"),
            ("1,2", "the row has 2 fields, the header has 3"),
            ("end of test", "the row has 1 field, the header has 3"),
            ("1,2,3,,4", "the row has 5 fields, the header has 3"),
            ("1,\"2,3", "a quoted field is not closed"),
            ("1,\"2\"x,3", "a quoted field is not closed"),
        ] {
            let table = reads(&format!("{HEADER}1,300,10\n{row}\n{}", "2,290,20\n".repeat(4)));
            assert_eq!(table.columns.force_n, [10.0, 20.0, 20.0, 20.0, 20.0], "{row}");
            assert_eq!(table.lines, [2, 4, 5, 6, 7]);
            let shown: Vec<_> = table.reading.set_apart.iter().map(|s| (s.row, s.reason.as_str())).collect();
            assert_eq!((shown, table.reading.set_apart_rows), (vec![(3, reason)], 1));
        }
        // The meaning is unambiguous here.
        let table = reads(&format!("{HEADER}20 kPa,0.3 m,10 N\n\u{2212}1,290,\"1,234.5\"\n"));
        assert_eq!((table.columns.pressure_pa, table.columns.force_n), (vec![2e4, -1e5], vec![10.0, 1234.5]));
    }

    /// With more than a fifth of such rows there is one message with all reasons, counted, and their first
    /// lines.
    #[test]
    fn too_many_rows_that_can_not_be_used() {
        let good = "1,300,10\n".repeat(8);
        assert_eq!(reads(&format!("{HEADER}{good}1,,3\n1,x,3\n")).lines.len(), 8);
        refuses(
            format!("{HEADER}{good}1,,3\n1,x,3\n1,,3\n").as_bytes(),
            None,
            &[
                "3 of 11 rows",
                "more than a fifth",
                "2 x `length [mm]` is empty (lines 10, 12)",
                "1 x `length [mm]` is not a number (line 11)",
            ],
        );
        refuses(
            format!("{HEADER}1,5,290,0,20,5\n").as_bytes(),
            None,
            &["1 x more fields than the header (line 2)", "decimal commas"],
        );
        // Optional columns are dropped instead of rows.
        let table =
            reads("pressure [bar],length [mm],force [N],volume [ml]\n1,300,10,\n2,290,20,x\n2,280,30,5\n");
        assert_eq!((table.columns.force_n.len(), table.columns.volume_m3), (3, None));
        let says = table.reading.columns[3].says.as_deref();
        assert_eq!(says, Some("ignored: 2 of 3 values can't be used"));
    }
}
