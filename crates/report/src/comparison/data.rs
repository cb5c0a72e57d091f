//! What was measured, what was left out, and the findings of the quality gate.

use bulge_inference::{Comparison, UNPRESSURISED};
use bulge_measurements::{ColumnUse, Finding, LineRange, SetApart, Severity};
use serde::Serialize;

use crate::comparison::number::{and, bar, count, newton, percent};

/// Ranges of lines that are listed before `and so on`.
const MOST_RANGES: usize = 6;
/// Most columns and rows listed, and digits of a reading.
const MOST_COLUMNS: usize = 40;
const MOST_ROWS: usize = 12;
const DIGITS: usize = 6;
/// Most specimens named.
const MOST_NAMES: usize = 12;

/// One finding.
#[derive(Debug, Serialize)]
pub(crate) struct Row {
    severity: &'static str,
    says: String,
    instead: String,
    rows: String,
}

/// The sentence above the table.
pub(super) fn says(comparison: &Comparison) -> String {
    let data = &comparison.data;
    let used = if data.used == data.rows {
        format!("All {} are used", count(data.rows, "row"))
    } else {
        format!("{} of {} are used", data.used, count(data.rows, "row"))
    };
    let worst = comparison.quality.iter().map(|finding| finding.severity).max();
    let verdict = match worst {
        None => "the check of the data found nothing wrong",
        Some(Severity::Note) => {
            "the check of the data has remarks, but found nothing that spoils the comparison"
        }
        Some(Severity::Warning) => "the check of the data found something that may spoil the comparison",
        Some(Severity::Error) => "the check of the data found faults: repair them before trusting this page",
    };
    format!("{used}; {verdict}.")
}

/// Names and values.
pub(super) fn facts(comparison: &Comparison) -> Vec<(&'static str, String)> {
    let data = &comparison.data;
    let range = |[low, high]: [f64; 2], show: fn(f64) -> String| {
        if low < high { format!("{} to {}", show(low), show(high)) } else { show(low) }
    };
    let named = &data.specimens[..data.specimens.len().min(MOST_NAMES)];
    let more = data.specimens.len() - named.len();
    let mut names = named.to_vec();
    if more > 0 {
        names.push(format!("{more} more"));
    }
    let kind = if data.is_path {
        format!("a path in {}", count(data.sweeps, "sweep"))
    } else {
        "a static map: single readings without direction or order".to_owned()
    };
    let mut facts = vec![
        ("kind", kind),
        (if data.specimens.len() == 1 { "specimen" } else { "specimens" }, and(&names)),
        ("pressure", range(data.pressure_pa, bar)),
        ("contraction", range(data.contraction, percent)),
        ("force", range(data.force_n, newton)),
        ("full scale", newton(data.full_scale_n)),
    ];
    if let Some(floor) = &comparison.noise_floor {
        facts.push(("noise floor", format!("{}: {}", newton(floor.sd_n), floor.says)));
    }
    facts
}

/// The assignment of the columns, if any of them was guessed: heading, quantity, unit, first values, and a
/// remark.
pub(super) fn columns(comparison: &Comparison) -> Vec<[String; 5]> {
    let reading = &comparison.data.reading;
    if !reading.is_guessed() {
        return Vec::new();
    }
    let row = |column: &ColumnUse| {
        let first: Vec<String> = column.first.iter().map(|text| shortened(text)).collect();
        [
            column.column.clone(),
            column.quantity.clone().unwrap_or_else(|| "not read".to_owned()),
            column.unit.clone().unwrap_or_default(),
            first.join(" "),
            column.says.clone().filter(|says| says != "ignored").unwrap_or_default(),
        ]
    };
    reading.columns.iter().take(MOST_COLUMNS).map(row).collect()
}

/// A number rounded to six digits if it has more; any other text unchanged.
fn shortened(text: &str) -> String {
    match text.parse::<f64>() {
        Ok(number) if text.len() > DIGITS + 3 => bulge_muscles::units::rounded(number, DIGITS).to_string(),
        _ => text.to_owned(),
    }
}

/// The first rows that can't be used, except those left out as unpressurised: line and reason.
pub(super) fn set_apart(comparison: &Comparison) -> Vec<[String; 2]> {
    let reading = &comparison.data.reading;
    let several = comparison.data.files.len() > 1;
    let line =
        |row: &SetApart| if several { format!("{}:{}", row.file, row.row) } else { row.row.to_string() };
    let is_unread = |row: &&SetApart| !row.reason.starts_with(UNPRESSURISED);
    let unread = reading.set_apart.iter().filter(is_unread);
    let count = unread.clone().count();
    let mut rows: Vec<[String; 2]> =
        unread.take(MOST_ROWS).map(|row| [line(row), row.reason.clone()]).collect();
    if count > rows.len() {
        rows.push([String::new(), format!("and {} more", count - rows.len())]);
    }
    rows
}

/// Findings of the quality gate, most severe first.
pub(crate) fn findings(comparison: &Comparison) -> Vec<Row> {
    let mut findings: Vec<&Finding> = comparison.quality.iter().collect();
    findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    findings.into_iter().map(|finding| row(finding, &comparison.data.files)).collect()
}

fn row(finding: &Finding, files: &[String]) -> Row {
    Row {
        severity: match finding.severity {
            Severity::Note => "note",
            Severity::Warning => "warning",
            Severity::Error => "error",
        },
        says: finding.says.clone(),
        instead: finding.instead.clone(),
        rows: lines(&finding.rows, files),
    }
}

/// `12, 33–40`, with the file if there are several.
fn lines(ranges: &[LineRange], files: &[String]) -> String {
    let shown = ranges.iter().take(MOST_RANGES).map(|range| {
        let lines = if range.first == range.last {
            range.first.to_string()
        } else {
            format!("{}–{}", range.first, range.last)
        };
        match files.get(range.file).filter(|_| files.len() > 1) {
            Some(file) => format!("{file}: {lines}"),
            None => lines,
        }
    });
    let mut shown: Vec<String> = shown.collect();
    if ranges.len() > MOST_RANGES {
        shown.push(format!("and {} more ranges", ranges.len() - MOST_RANGES));
    }
    shown.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_short_and_name_the_file_only_if_there_are_several() {
        let range = |file, first, last| LineRange { file, first, last };
        let files = ["a.csv".to_owned(), "b.csv".to_owned()];
        assert_eq!(lines(&[range(0, 3, 3), range(0, 7, 9)], &files[..1]), "3, 7–9");
        assert_eq!(lines(&[range(1, 3, 3)], &files), "b.csv: 3");
        let many: Vec<_> = (0..10).map(|i| range(0, 10 * i, 10 * i)).collect();
        assert!(lines(&many, &files[..1]).ends_with("50, and 4 more ranges"));
    }
}
