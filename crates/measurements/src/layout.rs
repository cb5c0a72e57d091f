//! The layout of a text table: metadata before it, header, units beneath, separator, decimal sign.

use crate::assignment::{Header, MOST_COLUMNS};
use crate::cell::{Decimal, is_in_thousands};
use crate::clock::instant;
use crate::column_map::{ColumnMap, IGNORE};
use crate::error::MeasurementError;
use crate::heading::Field;
use crate::line::{SEPARATORS, Separator, checked_length, is_comment, unpad, without_line_end};
use crate::names::{Strength, guesses};
use crate::unit::unit;
use std::borrow::Cow;

/// Number of lines that are searched for the header.
const LOOKED_AT: usize = 500;
/// Longest line that is considered as a header, in bytes, unless it is the first.
const LONGEST: usize = 50_000;
/// Most lines between a header and its first row: units, rules, blank lines.
const BETWEEN: usize = 4;
/// Number of rows whose values are shown.
const SHOWN: usize = 3;
/// Number of rows for detecting the decimal sign.
const TRIED: usize = 500;
/// Most line breaks within the names of a header.
const MOST_BREAKS: usize = 60;
/// Key of the units of the channels in the metadata of a recorder's file, one field per column.
const CHANNEL_UNITS: &str = "Y_Unit_Label";
/// The end of the metadata of a recorder's file, which identifies such a file.
const END_OF_METADATA: &str = "***End_of_Header***";

/// The layout of a text.
pub(crate) struct Layout {
    pub(crate) separator: Separator,
    pub(crate) decimal: Decimal,
    /// Line of the header, counted from 1; 0 if there is none and columns are named by their numbers.
    pub(crate) line: usize,
    pub(crate) names: Vec<String>,
    pub(crate) units: Option<Vec<String>>,
    /// The first values of each column.
    pub(crate) first: Vec<Vec<String>>,
    /// Index of the first line that may be a row.
    pub(crate) rows_from: usize,
    pub(crate) notes: Vec<String>,
}

/// A possible header.
struct Candidate {
    /// Index of its line.
    at: usize,
    separator: Separator,
    names: Vec<String>,
    units: Option<Vec<String>>,
    rows_from: usize,
    /// Number of columns that it names among pressure, motion and force, or among those that the user names.
    score: usize,
}

/// Finds the table in a text.
pub(crate) fn find(
    file: &str,
    text: &str,
    (line_end, separator): (char, Option<Separator>),
    map: &ColumnMap,
) -> Result<Layout, MeasurementError> {
    let lines: Vec<&str> = text.split(line_end).take(LOOKED_AT).map(without_line_end).collect();
    let Some(start) = lines.iter().position(|line| is_content(line.trim())) else {
        // A header may be in a comment, but rows may not.
        return Err(MeasurementError::empty(file));
    };
    checked_length(file, start + 1, lines[start])?;
    let plain = plain(lines[start], separator).map(|(separator, names)| {
        let score = score(&names, None, map);
        Candidate { at: start, separator, names, units: None, rows_from: start + 1, score }
    });
    let chosen = match plain {
        Some(plain) if map.entries().is_empty() && is_exact(&plain.names) => plain,
        plain => best(&lines, start, separator, map)
            .or(plain)
            .ok_or_else(|| MeasurementError::one_field(file, start + 1, lines[start]))?,
    };
    let chosen = without_header(&lines, start, map, chosen);
    let mut notes = Vec::new();
    let before = lines[..chosen.at.min(lines.len())].iter().filter(|line| is_content(line.trim())).count();
    if before > 0 && chosen.rows_from > chosen.at {
        notes.push(format!(
            "{} before the header on line {} {} no part of the table",
            if before == 1 { "a line".to_owned() } else { format!("{before} lines") },
            chosen.at + 1,
            if before == 1 { "is" } else { "are" }
        ));
    }
    let is_headless = chosen.rows_from == chosen.at;
    let rows = || text.split(line_end).skip(chosen.rows_from).map(without_line_end);
    let sign = if chosen.separator == Separator::Byte(b',') { '"' } else { ',' };
    let decimal = if text.contains(sign) { decimal(rows(), chosen.separator) } else { Decimal::Point };
    if decimal != Decimal::Point {
        notes.push("numbers have decimal commas".to_owned());
    }
    Ok(Layout {
        first: first(rows(), chosen.separator, chosen.names.len()),
        decimal,
        separator: chosen.separator,
        line: if is_headless { 0 } else { chosen.at + 1 },
        names: chosen.names,
        units: chosen.units,
        rows_from: chosen.rows_from,
        notes,
    })
}

/// Whether a line has content besides comments, blanks, separators, and a spreadsheet's separator hint.
fn is_content(line: &str) -> bool {
    let is_hint = line.len() == 5 && line.get(..4).is_some_and(|start| start.eq_ignore_ascii_case("sep="));
    let is_empty = line.bytes().all(|byte| SEPARATORS.contains(&byte));
    !(is_empty || is_comment(line) || is_hint)
}

type Fields = (Separator, Vec<String>);

/// The fields of a line, split at its most frequent separator; a single field if it has none.
fn plain(line: &str, separator: Option<Separator>) -> Option<Fields> {
    let separator = separator.or_else(|| Separator::of(line)).unwrap_or(Separator::Byte(b','));
    Some((separator, fields(line, separator)?))
}

fn fields(line: &str, separator: Separator) -> Option<Vec<String>> {
    let mut fields: Vec<Cow<'_, str>> = Vec::new();
    separator.split(line.trim_matches([' ', '\r', '\u{feff}']), &mut fields)?;
    unpad(&mut fields, 1);
    Some(fields.into_iter().map(Cow::into_owned).collect())
}

/// Whether pressure, force and a motion have their standard names.
fn is_exact(names: &[String]) -> bool {
    let exact: Vec<Field> = names
        .iter()
        .take(MOST_COLUMNS)
        .filter_map(|name| guesses(name, None).into_iter().find(|guess| guess.strength == Strength::Exact))
        .map(|guess| guess.field)
        .collect();
    exact.contains(&Field::Pressure)
        && exact.contains(&Field::Force)
        && exact.iter().any(|field| field.is_motion())
}

/// Whether a row is a header: it names at least two of pressure, motion and force.
pub(crate) fn names_columns(fields: &[Cow<'_, str>]) -> bool {
    let names: Vec<String> = fields.iter().map(ToString::to_string).collect();
    !names.iter().any(|name| is_number(name)) && score(&names, None, &ColumnMap::default()) >= 2
}

/// The text with its header on one line, if the header has line breaks within quotes; the lines after it keep
/// their numbers. None if there is no such header.
pub(crate) fn with_one_line_header(text: &str, line_end: char) -> Option<String> {
    let quotes = |line: &str| line.bytes().filter(|byte| *byte == b'"').count();
    let mut start = 0;
    let mut lines = text.split_inclusive(line_end).take(LOOKED_AT);
    let first = lines.find(|line| {
        let is_open = quotes(line) % 2 == 1;
        start += if is_open { 0 } else { line.len() };
        is_open
    })?;
    let (mut end, mut open, mut breaks) = (start + first.len(), true, 0);
    for line in lines.take(MOST_BREAKS) {
        end += line.len();
        breaks += 1;
        open ^= quotes(line) % 2 == 1;
        if !open {
            break;
        }
    }
    let header = text[start..end].trim_end_matches(['\r', '\n']);
    if open || header.len() > LONGEST {
        return None;
    }
    let header = header.replace(['\r', '\n'], " ");
    let (_, names) = plain(&header, None)?;
    let names: Vec<Cow<'_, str>> = names.into_iter().map(Cow::Owned).collect();
    let blank = line_end.to_string().repeat(breaks + 1);
    names_columns(&names).then(|| [&text[..start], header.as_str(), blank.as_str(), &text[end..]].concat())
}

/// Number of columns that a header has among pressure, motion and force, or among those that the user names.
fn score(names: &[String], units: Option<&[String]>, map: &ColumnMap) -> usize {
    let beneath = |place: usize| units.and_then(|units| units.get(place)).map(String::as_str);
    let all: Vec<Field> = names
        .iter()
        .enumerate()
        .take(MOST_COLUMNS)
        .flat_map(|(place, name)| guesses(name, beneath(place)))
        .map(|guess| guess.field)
        .collect();
    let stated: Vec<&str> = map.entries().iter().map(|entry| entry.quantity.as_str()).collect();
    let kinds: [&dyn Fn(Field) -> bool; 3] =
        [&|field| field == Field::Pressure, &|field| field == Field::Force, &Field::is_motion];
    let guessed = kinds.iter().filter(|is_it| {
        all.iter().any(|field| is_it(*field))
            && !Field::ALL.iter().any(|f| is_it(*f) && stated.contains(&f.name()))
    });
    let header = Header { file: "", line: 0, names, units, first: &[] };
    let named = map
        .entries()
        .iter()
        .filter(|entry| entry.quantity != IGNORE && crate::assignment::has_named(&header, &entry.column));
    // A column that the user names counts more than a guess.
    guessed.count() + 2 * named.count()
}

/// The best header above a row of numbers; the first one among equals.
fn best(lines: &[&str], start: usize, separator: Option<Separator>, map: &ColumnMap) -> Option<Candidate> {
    let after =
        lines.iter().rposition(|line| line.trim_start().starts_with(END_OF_METADATA)).map_or(0, |at| at + 1);
    let mut best: Option<Candidate> = None;
    for at in after..lines.len() {
        let line = lines[at].trim();
        // A comment may hold the header if the row beneath it is the first content.
        let is_header_in_comment = at < start && !is_content(line) && !line.is_empty();
        if line.is_empty() || line.len() > LONGEST || !(is_content(line) || is_header_in_comment) {
            continue;
        }
        let line = if is_header_in_comment { line.trim_start_matches(['#', '%', ' ']) } else { lines[at] };
        let line = line.trim_start_matches('%');
        for found in candidates(lines, at, line, separator, map) {
            if best.as_ref().is_none_or(|best| found.score > best.score) {
                best = Some(found);
            }
        }
    }
    if let Some(best) = best.as_mut().filter(|best| best.units.is_none()) {
        best.units = units_of_channels(&lines[..best.at], best);
    }
    best
}

/// Units in the metadata for columns whose names have none.
fn units_of_channels(metadata: &[&str], header: &Candidate) -> Option<Vec<String>> {
    let line = metadata.iter().rfind(|line| line.trim_start().starts_with(CHANNEL_UNITS))?;
    let mut stated = fields(line, header.separator)?;
    stated.resize(header.names.len(), String::new());
    let says_own = |name: &str| name.contains(['[', '(']);
    let known = |text: &str| Field::ALL.iter().any(|field| unit(*field, text).is_some());
    let of =
        |(text, name): (String, &String)| if known(&text) && !says_own(name) { text } else { String::new() };
    Some(stated.into_iter().zip(&header.names).map(of).collect())
}

/// The possible readings of a line as the header of the rows beneath it.
fn candidates(
    lines: &[&str],
    at: usize,
    line: &str,
    known: Option<Separator>,
    map: &ColumnMap,
) -> Vec<Candidate> {
    let separators = SEPARATORS.map(Separator::Byte).into_iter().chain([Separator::Blanks]);
    let separators = separators.filter(|separator| known.is_none_or(|known| known == *separator));
    let of = |separator: Separator| {
        let mut names = match separator {
            // Names may contain single blanks.
            Separator::Blanks if line.trim().contains("  ") => line
                .trim()
                .split("  ")
                .map(|name| name.trim().to_owned())
                .filter(|name| !name.is_empty())
                .collect(),
            _ => fields(line, separator)?,
        };
        let is_text = |name: &String| !name.is_empty() && !is_number(name);
        if names.len() < 2 || names.iter().filter(|name| is_text(name)).count() < 2 {
            return None;
        }
        let (units, row) = beneath(lines, at, separator)?;
        let width = fields(lines[row], separator)?.len();
        if matches!(separator, Separator::Blanks) && width != names.len() {
            names = fields(line, separator)?;
            if width != names.len() {
                return None;
            }
        }
        let score = score(&names, units.as_deref(), map);
        // Recorders name a last column of comments, which most rows lack.
        (2 * width >= names.len()).then_some(Candidate { at, separator, units, rows_from: row, score, names })
    };
    separators.filter_map(of).collect()
}

/// The row of units beneath a header, if there is one, and the index of the first row.
fn beneath(lines: &[&str], at: usize, separator: Separator) -> Option<(Option<Vec<String>>, usize)> {
    let mut units = None;
    let below = lines.iter().enumerate().skip(at + 1).filter(|(_, line)| is_content(line.trim()));
    for (row, line) in below.take(BETWEEN) {
        let found = fields(line, separator)?;
        if is_row(&found) {
            return Some((units, row));
        }
        let is_rule = line.bytes().all(|byte| b"-=_+| \t,;".contains(&byte));
        if units.is_none() && are_units(&found) {
            units = Some(found);
        } else if !is_rule {
            return None;
        }
    }
    None
}

/// Whether fields are a row: at least two numbers, and at least as many numbers as texts.
fn is_row(fields: &[String]) -> bool {
    let filled = fields.iter().filter(|field| !field.is_empty());
    let (numbers, texts): (Vec<&String>, Vec<&String>) = filled.partition(|field| is_number(field));
    numbers.len() >= 2 && numbers.len() >= texts.len()
}

fn is_number(field: &str) -> bool {
    field.parse::<f64>().is_ok()
        || (field.contains(',') && field.replace('.', "").replacen(',', ".", 1).parse::<f64>().is_ok())
        || instant(field).is_some()
        || crate::cell::with_unit(field).is_some_and(|(_, rest)| rest.len() < 8)
}

/// Whether fields are units: most of the nonempty ones, and at least two.
fn are_units(fields: &[String]) -> bool {
    let bare = |field: &String| field.trim_matches(['[', ']', '(', ')', ' ']).to_owned();
    let filled: Vec<String> =
        fields.iter().map(bare).filter(|field| !field.is_empty() && field != "-").collect();
    let known =
        filled.iter().filter(|text| Field::ALL.iter().any(|field| unit(*field, text).is_some())).count();
    known >= 2 && 2 * known >= filled.len()
}

/// Columns by their numbers, if the user names them in this way and the first line is a row already.
fn without_header(lines: &[&str], start: usize, map: &ColumnMap, chosen: Candidate) -> Candidate {
    let by_number =
        |column: &str| column.split('[').next().is_some_and(|text| text.trim().parse::<usize>().is_ok());
    let are_numbers = !map.entries().is_empty() && map.entries().iter().all(|entry| by_number(&entry.column));
    if !are_numbers || chosen.score >= 3 {
        return chosen;
    }
    let separators = [Separator::of(lines[start]), Some(Separator::Blanks)];
    let row = separators.into_iter().flatten().find_map(|separator| {
        let found = fields(lines[start], separator)?;
        is_row(&found).then_some((separator, found))
    });
    let Some((separator, found)) = row else { return chosen };
    let names = (1..=found.len()).map(|number| number.to_string()).collect();
    Candidate { at: start, separator, names, units: None, rows_from: start, score: 0 }
}

/// The first values of each column.
fn first<'a>(rows: impl Iterator<Item = &'a str>, separator: Separator, width: usize) -> Vec<Vec<String>> {
    let mut found = vec![Vec::new(); width];
    let mut fields = Vec::new();
    for line in rows.filter(|line| !separator.is_blank(line) && line.len() < 100_000).take(SHOWN) {
        if separator.split(line, &mut fields).is_some() {
            found.iter_mut().zip(&fields).for_each(|(column, field)| column.push(field.to_string()));
        }
    }
    found
}

/// The decimal sign, from rows that have a comma within a field.
fn decimal<'a>(rows: impl Iterator<Item = &'a str>, separator: Separator) -> Decimal {
    let has_comma = |line: &&str| {
        let bytes = line.as_bytes();
        bytes.contains(&b',')
            && (separator != Separator::Byte(b',') || bytes.contains(&b'"'))
            && !separator.is_blank(line)
    };
    let (mut commas, mut points, mut fields) = (0, 0, Vec::new());
    for line in rows.filter(has_comma).take(TRIED) {
        if separator.split(line, &mut fields).is_none() {
            continue;
        }
        for field in &fields {
            match (field.contains(','), field.contains('.')) {
                (true, false) if field.replacen(',', ".", 1).parse::<f64>().is_ok() => commas += 1,
                (false, true) if field.parse::<f64>().is_ok() && !is_in_thousands(field) => points += 1,
                // 1,234.5
                (true, true) if field.rfind('.') > field.rfind(',') => points += 1,
                _ => {}
            }
        }
    }
    match (commas, points) {
        (0, _) => Decimal::Point,
        (_, 0) => Decimal::Comma,
        // With commas as separators, a comma in quotes more likely separates thousands.
        _ if separator == Separator::Byte(b',') => Decimal::Point,
        _ => Decimal::Either,
    }
}
