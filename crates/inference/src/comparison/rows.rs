//! Which rows enter errors and fits, and how rows are named to people.

use bulge_measurements::{Data, Reading};
use bulge_muscles::units::significant;
use std::fmt::Write;

use crate::comparison::document::LeftOut;

/// Rows that count, and those that don't with the reason.
pub(crate) struct Used {
    pub(crate) mask: Vec<bool>,
    pub(crate) left_out: Vec<LeftOut>,
    /// How the data were read, with the rows that no equilibrium has.
    pub(crate) reading: Reading,
}

/// Readings at zero say only that the muscle didn't pull: two or more of exactly the lowest force, within 1 % of full scale of zero; rows that moved
/// on at zero force; rows in which the muscle pushed.
pub(crate) fn used(data: &Data) -> Used {
    let force = data.force();
    let full = full_scale(force);
    let lowest = force.iter().copied().fold(f64::INFINITY, f64::min);
    let is_cut = |row: usize| force[row].total_cmp(&lowest).is_eq();
    let cut: Vec<usize> = (0..force.len()).filter(|row| is_cut(*row)).collect();
    let mut mask = vec![true; force.len()];
    let mut left_out = Vec::new();
    let mut reading = data.reading().clone();
    let vented = without_pressure(data, &mut mask, &mut reading);
    left_out.extend(vented);
    let cut: Vec<usize> = cut.into_iter().filter(|row| mask[*row]).collect();
    if cut.len() >= 2 && cut.len() < force.len() && lowest.abs() <= 0.01 * full {
        for row in &cut {
            mask[*row] = false;
        }
        left_out.push(LeftOut {
            why: format!("slack: {lowest} N, the lowest reading, says only that the muscle didn't pull"),
            lines: lines(data, &cut),
            rows: cut.len(),
        });
    }
    let idle: Vec<usize> = data.not_pulling().into_iter().filter(|row| mask[*row]).collect();
    if !idle.is_empty() && idle.len() < mask.iter().filter(|counts| **counts).count() {
        for row in &idle {
            mask[*row] = false;
        }
        left_out.push(LeftOut {
            why: "slack or pushing: the muscle didn't pull, and says nothing about its force".to_owned(),
            lines: lines(data, &idle),
            rows: idle.len(),
        });
    }
    Used { mask, left_out, reading }
}

/// Leaves out rows whose gauge pressure is 0 or, by the noise of a zero, below: nothing balances the fibres there.
fn without_pressure(data: &Data, mask: &mut [bool], reading: &mut Reading) -> Option<LeftOut> {
    let pressure = data.pressure();
    let rows: Vec<usize> = (0..pressure.len()).filter(|row| pressure[*row] <= 0.0).collect();
    if rows.is_empty() {
        return None;
    }
    for row in &rows {
        mask[*row] = false;
        let (file, line) = data.line(*row);
        let file = data.files().get(file).map_or("", |file| file.name.as_str());
        let reason = format!("a gauge pressure of {} Pa has no equilibrium", significant(pressure[*row], 4));
        reading.add(file, line, reason);
    }
    Some(LeftOut {
        why: "no gauge pressure: nothing balances the fibres".to_owned(),
        lines: lines(data, &rows),
        rows: rows.len(),
    })
}

/// Largest force that was measured \[N\].
pub(crate) fn full_scale(force: &[f64]) -> f64 {
    force.iter().fold(0.0_f64, |most, f| most.max(f.abs()))
}

/// Line numbers of rows: `12, 33-40`, with the names of the files where there are several. Long lists end with a count.
pub(crate) fn lines(data: &Data, rows: &[usize]) -> String {
    const MOST: usize = 12;
    let mut ranges: Vec<(usize, usize, usize)> = Vec::new();
    for row in rows {
        let (file, line) = data.line(*row);
        match ranges.last_mut() {
            Some((last_file, _, end)) if *last_file == file && *end + 1 == line => *end = line,
            _ => ranges.push((file, line, line)),
        }
    }
    let several = data.files().len() > 1;
    let one = |(file, start, end): &(usize, usize, usize)| {
        let name = if several { format!("{}:", data.files()[*file].name) } else { String::new() };
        if start == end { format!("{name}{start}") } else { format!("{name}{start}-{end}") }
    };
    let mut text = ranges.iter().take(MOST).map(one).collect::<Vec<_>>().join(", ");
    if ranges.len() > MOST {
        let _ = write!(text, " and {} more", ranges.len() - MOST);
    }
    text
}
