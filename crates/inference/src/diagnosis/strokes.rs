//! Strokes of a record: its parts in one direction, and the position of each row on them. Rows of different
//! strokes in about the same state are near replicates.

use bulge_effects::Moment;
use bulge_model::Record;

use crate::comparison::levels::Levels;
use crate::median::median;
use crate::vector::range;

/// Contractions that differ by less count as the same held length.
const HELD: f64 = 2e-3;

/// A row of a stroke.
pub(crate) struct Point {
    /// Contraction, or pressure at held length, as a fraction of its range.
    pub(crate) place: f64,
    pub(crate) row: usize,
}

/// What strokes that repeat each other have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct State {
    pub(crate) specimen: u32,
    /// Whether the length is held and the pressure moves.
    pub(crate) is_held: bool,
    /// Level of the pressure, or the held length.
    pub(crate) level: i64,
    /// Whether the muscle shortens, or the pressure rises.
    pub(crate) is_up: bool,
}

/// A part in one direction within one cycle, ordered by position.
pub(crate) struct Stroke {
    pub(crate) state: State,
    pub(crate) sweep: usize,
    /// Whether it belongs to the first of three or more cycles of its sweep.
    pub(crate) is_first: bool,
    pub(crate) points: Vec<Point>,
}

/// Gap between neighbouring places over the median of all, from which rests lie on either side. Places that are drawn at
/// random have gaps of ten medians among some thousands.
const GAP: f64 = 20.0;

/// Orders the rows of each rest by time, on the places of all of them. What orders readings of one true state is their noise,
/// which the misfit holds as well: neighbours would differ by less than their noise.
fn by_time_in_rests(points: &mut [Point], is_up: bool) {
    let gap = |pair: &[Point]| pair[1].place - pair[0].place;
    let mut gaps: Vec<f64> = points.windows(2).map(gap).collect();
    let usual = if gaps.is_empty() { return } else { median(&mut gaps) };
    let has_rests = points.windows(2).any(|pair| gap(pair) > GAP * usual);
    for rest in points.chunk_by_mut(|a, b| b.place - a.place <= GAP * usual).filter(|_| has_rests) {
        let mut rows: Vec<usize> = rest.iter().map(|point| point.row).collect();
        rows.sort_unstable();
        if !is_up {
            rows.reverse();
        }
        for (point, row) in rest.iter_mut().zip(rows) {
            point.row = row;
        }
    }
}

/// All strokes of a record.
pub(crate) fn strokes(record: &Record) -> Vec<Stroke> {
    let levels = Levels::of(record, &vec![true; record.len()]);
    let width = |of: &dyn Fn(&Moment) -> f64| {
        let [low, high] = range(record.moments().iter().map(of));
        (high - low).max(f64::MIN_POSITIVE)
    };
    let [contractions, pressures] = [width(&|m| m.contraction), width(&|m| m.pressure)];
    let mut found = Vec::new();
    for (sweep, rows) in record.sweeps().iter().enumerate() {
        let moving: Vec<usize> = rows.clone().filter(|row| record.moments()[*row].branch() != 0.0).collect();
        let cycle = |row: usize| record.moments()[row].cycle.floor();
        let up = |row: usize| record.moments()[row].branch() > 0.0;
        let last = moving.last().map_or(0.0, |row| cycle(*row));
        let first = moving.first().map_or(0.0, |row| cycle(*row));
        for run in moving.chunk_by(|a, b| up(*a) == up(*b) && cycle(*a).total_cmp(&cycle(*b)).is_eq()) {
            let moment = &record.moments()[run[0]];
            let is_held = moment.direction == 0.0;
            let mut points: Vec<Point> = run
                .iter()
                .map(|row| {
                    let m = &record.moments()[*row];
                    let place = if is_held { m.pressure / pressures } else { m.contraction / contractions };
                    Point { place, row: *row }
                })
                .collect();
            points.sort_by(|a, b| a.place.total_cmp(&b.place));
            by_time_in_rests(&mut points, up(run[0]));
            #[expect(clippy::cast_possible_truncation, reason = "a contraction over 0.2 %")]
            let length = (moment.contraction / HELD).round() as i64;
            let level = if is_held { length } else { i64::try_from(levels.at(run[0])).unwrap_or(0) };
            let state = State { specimen: moment.specimen, is_held, level, is_up: up(run[0]) };
            let is_first = last >= first + 2.0 && cycle(run[0]) <= first;
            found.push(Stroke { state, sweep, is_first, points });
        }
    }
    found
}
