//! Numbers in text: four to six significant digits, and a unit that suits the size.

use bulge_muscles::shown::shortened_to;
pub(crate) use bulge_muscles::units::significant;

/// Three significant digits.
pub(crate) fn three(value: f64) -> String {
    significant(value, 3)
}

/// A count with its word: `1 row`, `3 rows`.
pub(crate) fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// A value and the ends of its interval, so that the interval can be seen.
pub(crate) fn with_interval(value: f64, low: f64, high: f64) -> [String; 3] {
    bulge_report::with_interval(value, [low, high])
        .unwrap_or_else(|| [value, low, high].map(|x| significant(x, 3)))
}

/// Most characters of a cell of a table.
const WIDEST: usize = 300;

/// A table; the first row is the heading. Columns of numbers are aligned to the right, others to the left.
pub(crate) fn table(rows: &[Vec<String>]) -> String {
    // One long name would make every row as long.
    let shown = |cell: &String| match cell.chars().nth(WIDEST) {
        Some(_) => shortened_to(WIDEST, cell),
        None => cell.clone(),
    };
    let rows: Vec<Vec<String>> = rows.iter().map(|row| row.iter().map(shown).collect()).collect();
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |c: usize| rows.iter().filter_map(|row| row.get(c)).map(|cell| cell.chars().count()).max();
    let widths: Vec<usize> = (0..columns).map(|c| width(c).unwrap_or(0)).collect();
    let is_number =
        |c: usize| rows.last().and_then(|row| row.get(c)).is_none_or(|cell| cell.parse::<f64>().is_ok());
    let mut text = String::new();
    for row in &rows {
        let cells: Vec<String> = (row.iter().zip(&widths).enumerate())
            .map(|(c, (cell, w))| if is_number(c) { format!("{cell:>w$}") } else { format!("{cell:<w$}") })
            .collect();
        text.push_str("  ");
        text.push_str(cells.join("  ").trim_end());
        text.push('\n');
    }
    text
}

/// A table with a heading and units over its rows.
pub(crate) fn with_units<const N: usize>(
    heading: [&str; N],
    units: [&str; N],
    rows: impl IntoIterator<Item = [String; N]>,
) -> String {
    let head = [heading, units].map(|line| line.map(str::to_owned));
    table(&head.into_iter().chain(rows).map(Vec::from).collect::<Vec<_>>())
}

/// A file in the format of the long help.
pub(crate) fn shown(title: &str, file: &str) -> String {
    let mut text = format!("{title}:\n\n");
    for line in file.lines() {
        text.push_str("  ");
        text.push_str(line);
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_align() {
        let rows = [vec!["a".into(), "bb".into()], vec!["100".into(), "2".into()]];
        assert_eq!(table(&rows), "    a  bb\n  100   2\n");
    }
}
