//! Rows of uncertain direction: at turning points, and at the start of a sweep.

use crate::data::Data;
use crate::driven::Driven;
use crate::stretch::Stretch;
use std::ops::Range;

/// A rest of up to this many rows at a turning point is a repeated reading of a set point.
const REPEATED: usize = 3;

impl Data {
    /// Rows of uncertain direction, in ascending order. These are the first row of a sweep and of an isobar
    /// in it, to which no motion leads; each turning point, at which friction may have either sign; and the
    /// rows next to them, as long as the distance is within noise and steps of the sensor (rows that read the
    /// same set point again, or that a file assigns to the other branch). At held length the direction is
    /// that of the pressure. None in a static map.
    #[must_use]
    pub fn direction_in_doubt(&self) -> Vec<usize> {
        let mut found = Vec::new();
        for (sweep, Driven { stretches, values: s, band }) in self.driven() {
            let resolved = band.resolved();
            if stretches.iter().all(|stretch| stretch.direction == 0) {
                continue;
            }
            let reach = |from: usize, rows: &mut dyn Iterator<Item = usize>| {
                let rows = rows.take_while(|row| (s[*row] - s[from]).abs() <= resolved);
                rows.filter(|row| moves(stretches, *row)).collect::<Vec<_>>()
            };
            // No motion leads to the first row of an isobar either.
            let between = self.between_isobars();
            let is_between = |row: usize| between.binary_search(&row).is_ok();
            let begins = |row: &usize| *row > sweep.rows.start && is_between(row - 1) && !is_between(*row);
            let after_steps: Vec<usize> = sweep.rows.clone().filter(begins).collect();
            found.extend(&after_steps);
            for turn in turns(&sweep.rows, stretches).into_iter().chain(after_steps) {
                found.extend(reach(turn, &mut (turn..sweep.rows.end)));
                found.extend(reach(turn, &mut (sweep.rows.start..turn).rev()));
            }
        }
        found.sort_unstable();
        found.dedup();
        found
    }
}

/// The first row, and the last row of each motion that is followed by one in the other direction.
fn turns(rows: &Range<usize>, stretches: &[Stretch]) -> Vec<usize> {
    let mut found = Vec::new();
    let mut last: Option<&Stretch> = None;
    for stretch in stretches.iter().filter(|stretch| stretch.direction != 0) {
        match last {
            None if stretch.rows.start <= rows.start + REPEATED => found.push(rows.start),
            Some(last) if last.direction != stretch.direction => found.push(last.rows.end - 1),
            _ => {}
        }
        last = Some(stretch);
    }
    found
}

/// Whether a row belongs to a motion, or to a rest so short that it is a repeated reading of a set point.
fn moves(stretches: &[Stretch], row: usize) -> bool {
    let place = stretches.partition_point(|stretch| stretch.rows.end <= row);
    stretches.get(place).is_some_and(|stretch| stretch.direction != 0 || stretch.rows.len() <= REPEATED)
}
