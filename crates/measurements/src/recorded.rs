//! Rows that were recorded one after another, although neither a time nor a label of sweeps says so: pressure and motion
//! go to and fro in small steps. Set points in any order, and lists of them that begin anew for each pressure, leap.

use crate::columns::{Columns, Trace};
use crate::order::is_sorted_by_reading;

/// Fewest rows.
const FEWEST: usize = 40;
/// A pressure within this fraction of the largest is held, and a length within this fraction of itself: its steps are noise.
const HELD_PRESSURE: f64 = 0.2;
const HELD_LENGTH: f64 = 0.02;
/// One in so many readings on either side may be impossible.
const OUTER: usize = 50;
/// A step beyond this fraction of the range is a leap,
const LEAP: f64 = 0.25;
/// of which one row in ten may make one, from one run to the next.
const LEAPS: f64 = 0.1;
/// A way of at least this fraction of the range in small steps is a stroke.
const STROKE: f64 = 0.4;

/// What the order of the rows of files says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    /// What times and labels say; nothing without either.
    Stated,
    /// They were recorded one after another, although neither is given.
    Recorded,
    /// They were sorted, and the times numbered anew.
    Lost,
}

impl Order {
    /// `rows` is the number of rows of each file.
    pub(crate) fn of(columns: &Columns, rows: &[usize]) -> Self {
        if rows.len() == 1 && is_sorted_by_reading(columns) {
            return Self::Lost;
        }
        let is_path = columns.time_s.is_some() || columns.sweep.is_some();
        if !is_path && is_recorded(columns, rows) { Self::Recorded } else { Self::Stated }
    }

    pub(crate) fn says(self) -> Option<&'static str> {
        match self {
            Self::Stated => None,
            Self::Recorded => Some(
                "no time and no sweep is given, but the rows go to and fro in small steps: they are taken in their order, without rates. If that means nothing, \
                 number them all in a column `sweep`",
            ),
            Self::Lost => Some(
                "a reading only rises or only falls, while labels of sweeps return every few rows or another reading leaps: this isn't the order in which they were measured. They \
                 are taken as a static map, without times and sweeps; if they were sorted, export them as they were measured",
            ),
        }
    }
}

/// Whether the rows of files follow each other along a path: a channel goes up and down in small steps, and none that isn't held
/// leaps.
fn is_recorded(columns: &Columns, rows: &[usize]) -> bool {
    let ways: Vec<Way> =
        driven(columns).into_iter().map(|(values, range)| Way::of(values, rows, range)).collect();
    columns.len() >= FEWEST
        && ways.iter().all(|way| way.leaps as f64 <= LEAPS * columns.len() as f64)
        && ways.iter().any(|way| way.strokes.iter().all(|strokes| *strokes > 0))
}

/// Largest fraction of the rows in which a driven channel leaps.
pub(crate) fn leaping(columns: &Columns) -> f64 {
    let count = columns.len();
    let leaps =
        |(values, range): (&[f64], f64)| Way::of(values, &[count], range).leaps as f64 / count.max(1) as f64;
    driven(columns).into_iter().map(leaps).fold(0.0, f64::max)
}

/// Pressure and motion that aren't held, with their ranges.
fn driven(columns: &Columns) -> Vec<(&[f64], f64)> {
    let motion = columns.motion.values();
    let scale = if matches!(columns.motion, Trace::Contraction(_)) { 1.0 } else { inner(motion)[1].abs() };
    let channels = [
        (columns.pressure_pa.as_slice(), HELD_PRESSURE * inner(&columns.pressure_pa)[1].abs()),
        (motion, HELD_LENGTH * scale),
    ];
    let driven = channels.into_iter().filter_map(|(values, held)| {
        let [low, high] = inner(values);
        (high - low > held).then_some((values, high - low))
    });
    driven.collect()
}

/// The ends of values without the outer fiftieth on either side: an impossible reading is no range.
fn inner(values: &[f64]) -> [f64; 2] {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let outer = sorted.len() / OUTER;
    let at = |place: usize| sorted.get(place).copied().unwrap_or_default();
    [at(outer), at(sorted.len().saturating_sub(outer + 1))]
}

/// How a channel gets from row to row.
#[derive(Debug, PartialEq, Eq)]
struct Way {
    leaps: usize,
    /// Strokes upwards, and downwards.
    strokes: [usize; 2],
}

impl Way {
    /// Of the rows of files, one after the other.
    fn of(values: &[f64], rows: &[usize], range: f64) -> Self {
        let mut way = Self { leaps: 0, strokes: [0; 2] };
        let mut rest = values;
        for count in rows {
            let (own, others) = rest.split_at((*count).min(rest.len()));
            rest = others;
            way.along(own, range);
        }
        way
    }

    fn along(&mut self, values: &[f64], range: f64) {
        // The last turn on either side, and whether the last stroke rose.
        let [mut least, mut most] = [values.first().copied().unwrap_or_default(); 2];
        let mut last = None;
        for pair in values.windows(2) {
            let now = pair[1];
            if (now - pair[0]).abs() > LEAP * range {
                self.leaps += 1;
                (least, most, last) = (now, now, None);
                continue;
            }
            (least, most) = (least.min(now), most.max(now));
            if last != Some(true) && now - least > STROKE * range {
                self.strokes[0] += 1;
                (most, last) = (now, Some(true));
            } else if last != Some(false) && most - now > STROKE * range {
                self.strokes[1] += 1;
                (least, last) = (now, Some(false));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_path(states: impl Iterator<Item = (f64, f64)>) -> bool {
        let (pressure, contraction): (Vec<f64>, Vec<f64>) = states.unzip();
        let count = pressure.len();
        // In one file, or in two.
        let columns = Columns::new(pressure, Trace::Contraction(contraction), vec![0.0; count]);
        let found = is_recorded(&columns, &[count]);
        assert_eq!(found, is_recorded(&columns, &[count / 2, count - count / 2]));
        found
    }

    /// To and fro between 0 and 1 in `rows` rows.
    fn part(row: u32, rows: u32) -> f64 {
        1.0 - (f64::from(row % rows) / f64::from(rows) * 2.0 - 1.0).abs()
    }

    #[test]
    fn strokes_are_counted_between_leaps() {
        let way = |values: &[f64]| Way::of(values, &[values.len()], inner(values)[1] - inner(values)[0]);
        let stairs: Vec<f64> = (0..60).map(|row| part(row, 20)).collect();
        assert_eq!(way(&stairs), Way { leaps: 0, strokes: [3, 3] });
        let saw: Vec<f64> = (0..60).map(|row| f64::from(row % 20)).collect();
        assert_eq!(way(&saw), Way { leaps: 2, strokes: [3, 0] });
    }

    #[test]
    fn loops_and_fillings_are_recorded_and_lists_of_set_points_are_not() {
        // Loops at three pressures, fillings at three lengths, and both at once.
        assert!(is_path((0..120).map(|row| (1e5 * f64::from(1 + row / 40), 0.2 * part(row, 40)))));
        assert!(is_path((0..120).map(|row| (1e5 + 4e5 * part(row, 40), 0.05 * f64::from(row / 40)))));
        assert!(is_path((0..120).map(|row| (1e5 + 4e5 * part(row, 40), 0.1 * part(row, 40)))));
        // At a pressure that scatters, at a length that does, and with readings that are none.
        let noise = |row: u32| f64::from(row * 37 % 29) / 29.0 - 0.5;
        assert!(is_path((0..120).map(|row| (2e5 + 2e4 * noise(row), 0.2 * part(row, 40)))));
        assert!(is_path((0..120).map(|row| (1e5 + 4e5 * part(row, 40), 0.1 + 0.01 * noise(row)))));
        assert!(is_path((0..120).map(|row| (2e5, if row % 61 == 7 { 99.0 } else { 0.2 * part(row, 40) }))));
        // A grid, each pressure from the smallest contraction on; pressures at each contraction; any order; few rows.
        assert!(!is_path((0..120).map(|row| (1e5 * f64::from(1 + row / 20), 0.01 * f64::from(row % 20)))));
        assert!(!is_path((0..120).map(|row| (1e5 * f64::from(1 + row % 6), 0.01 * f64::from(row / 6)))));
        assert!(!is_path(
            (0..121).map(|row| (1e5 + 4e3 * f64::from(row * 37 % 121), 0.2 * part(row * 53 % 121, 121)))
        ));
        assert!(!is_path((0..30).map(|row| (2e5, 0.2 * part(row, 30)))));
        // Sorted by a column: nothing turns.
        assert!(!is_path((0..120).map(|row| (1e5 + 4e3 * f64::from(row), 0.1))));
    }
}
