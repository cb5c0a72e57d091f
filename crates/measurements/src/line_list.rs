//! Rows named by the lines of their files, as users write them: `12, 33-40`.

use crate::data::Data;
use crate::error::MeasurementError;
use crate::quote::quoted;
use bulge_muscles::shown::listed;

/// Separator between a file and its line.
const FILE: char = ':';

impl Data {
    /// The lines of rows, with neighbours combined into ranges: `12`, `33-40`; preceded by the name of the
    /// file and a colon if there are several.
    #[must_use]
    pub fn line_ranges(&self, rows: &[usize]) -> Vec<String> {
        let mut ranges: Vec<(usize, usize, usize)> = Vec::new();
        for row in rows {
            let (file, line) = self.line(*row);
            match ranges.last_mut() {
                Some((last_file, _, end)) if *last_file == file && *end + 1 == line => *end = line,
                _ => ranges.push((file, line, line)),
            }
        }
        let several = self.files().len() > 1;
        let one = |(file, start, end): &(usize, usize, usize)| {
            let name = if several { format!("{}{FILE}", self.files()[*file].name) } else { String::new() };
            if start == end { format!("{name}{start}") } else { format!("{name}{start}-{end}") }
        };
        ranges.iter().map(one).collect()
    }

    /// The rows of a list of lines, in ascending order. Lines without a row, such as comments, are ignored.
    ///
    /// # Errors
    /// If it isn't a list of lines, names a file that isn't among these, or contains no row at all.
    pub fn rows_of_lines(&self, list: &str) -> Result<Vec<usize>, MeasurementError> {
        let mut rows = Vec::new();
        for range in list.split(',').map(str::trim).filter(|range| !range.is_empty()) {
            let refuse = |why: &str| {
                let range = quoted(range);
                MeasurementError::Request(format!("lines `{range}`: {why}; write such as `12, 33-40`"))
            };
            let (name, lines) =
                range.rsplit_once(FILE).map_or((None, range), |(name, lines)| (Some(name), lines));
            let file = match name {
                Some(name) => self.files().iter().position(|file| file.name == name).map(Some),
                None if self.files().len() > 1 => None,
                None => Some(None),
            };
            let file = file.ok_or_else(|| {
                let names = listed(20, "", self.files().iter().map(|file| &file.name));
                refuse(&format!("it must begin with the name of a file, of {names}"))
            })?;
            let (first, last) = lines.split_once('-').unwrap_or((lines, lines));
            let (Ok(first), Ok(last)) = (first.trim().parse::<usize>(), last.trim().parse::<usize>()) else {
                return Err(refuse("it is no line and no range of lines"));
            };
            let is_in = |row: &usize| {
                let (its, line) = self.line(*row);
                file.is_none_or(|file| file == its) && (first..=last).contains(&line)
            };
            let before = rows.len();
            rows.extend((0..self.len()).filter(is_in));
            if rows.len() == before {
                return Err(refuse("no row that can be used stands there"));
            }
        }
        rows.sort_unstable();
        rows.dedup();
        Ok(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn data() -> Data {
        let text = "# a comment\npressure [bar],contraction [%],force [N]\n1,1,10\n1,2,9\n# another\n1,3,8\n1,4,7\n2,1,20\n";
        Data::from_csv(text, "a.csv").unwrap()
    }

    #[test]
    fn there_and_back() {
        let data = data();
        for rows in [vec![0, 1, 3], vec![2], vec![0, 1, 2, 3, 4]] {
            let lines = data.line_ranges(&rows).join(",");
            assert_eq!(data.rows_of_lines(&lines).unwrap(), rows, "{lines}");
        }
        assert_eq!(data.line_ranges(&[0, 1, 3]), ["3-4", "7"]);
        assert_eq!(data.rows_of_lines(" 7, a.csv:3-5 ,").unwrap(), [0, 1, 3]);
    }

    #[test]
    fn what_is_no_line_is_refused() {
        for (list, part) in [("x", "no line"), ("1-2", "no row"), ("b.csv:3", "of a.csv"), ("3,99", "`99`")] {
            let message = data().rows_of_lines(list).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
    }
}
