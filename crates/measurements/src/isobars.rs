//! Isobaric runs within one recording: stretches of constant pressure over which the muscle is driven, and
//! the steps between them.

use crate::resolution::{Resolution, bounds, median};
use crate::window::Window;
use std::ops::Range;

/// A pressure within this fraction of the largest is constant: a regulator droops by a few per cent within a
/// loop.
const BAND: f64 = 0.08;
/// Two runs have different pressures if their medians differ by more than this fraction of the largest.
const STEP: f64 = 0.05;
/// Rows at the ends of a run that deviate from its median by more than this fraction of the largest pressure
/// belong to a step.
const EDGE: f64 = 0.02;
/// Fewer rows show no motion.
const FEWEST: usize = 4;
/// At constant pressure, a driven muscle covers at least this fraction of the travel of the recording; after
/// a pressure step at held length it covers none.
const TRAVEL: f64 = 0.25;
/// Its force changes by at least this fraction of its largest value; under a weight, which the pressure
/// moves, it hardly changes.
const FORCE: f64 = 0.2;
/// If isobaric runs cover less than this fraction of a recording,
const COVERED: f64 = 0.8;
/// each has to be constant within this fraction of the largest pressure in eight tenths of its rows: an
/// oscillating pressure stays near its extremes for a while.
const FLAT: f64 = 0.03;
/// Number of inner rows whose median the pressure at the ends of a run must reach while the muscle rests;
/// then the tolerance as a fraction of the largest pressure.
const SETTLED: usize = 15;
const SETTLED_TO: f64 = 2e-3;
/// Number of rows whose median is the pressure at an end of a run.
const JUNCTION: usize = 3;
/// Up to this many rows between two pieces are a disturbance if the pressure is the same after them.
const DISTURBED: usize = 3;

/// Rows at one pressure over which the muscle is driven.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Isobar {
    pub(crate) rows: Range<usize>,
    /// Median pressure \[Pa\].
    pub(crate) pressure: f64,
}

/// The readings of a recording.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Readings<'a> {
    pub(crate) pressure: &'a [f64],
    pub(crate) motion: &'a [f64],
    pub(crate) force: &'a [f64],
}

/// The isobaric runs of an uninterrupted recording, in order; none unless two successive ones have different
/// pressures.
///
/// A run is the longest piece whose pressure stays within 8 % of the largest pressure of the recording (and
/// within its noise), provided that the muscle covers a quarter of the total travel over it and its force
/// changes by a fifth. Hence pressure steps at held length (isometric) and under a weight (isotonic) are no
/// runs, and pressure ramps contain none.
pub(crate) fn find(readings: Readings<'_>, rows: &Range<usize>) -> Vec<Isobar> {
    let pressure = &readings.pressure[rows.clone()];
    let (low, high) = bounds(pressure);
    let largest = high.abs().max(low.abs());
    if rows.len() < 2 * FEWEST || high - low <= STEP * largest {
        return Vec::new();
    }
    let noise = |values: &[f64]| Resolution::of(values, std::slice::from_ref(&(0..values.len()))).noise;
    let spread = 2.0 * (1.0 + (2.0 * (rows.len() as f64).ln()).sqrt());
    let band = (BAND * largest).max(spread * noise(pressure));
    let judge = Judge {
        readings,
        way: travel(&readings.motion[rows.clone()]),
        force_noise: spread * noise(&readings.force[rows.clone()]),
        motion_noise: spread * noise(&readings.motion[rows.clone()]),
        pressure_noise: (0.5 * spread * noise(pressure)).max(SETTLED_TO * largest),
    };
    let mut found: Vec<Isobar> = Vec::new();
    for piece in pieces(pressure, band) {
        let piece = rows.start + piece.start..rows.start + piece.end;
        let middle = median(&mut readings.pressure[piece.clone()].to_vec());
        let isobar = Isobar { rows: piece, pressure: middle };
        match found.last_mut() {
            Some(last) if last.goes_on(&isobar, readings.pressure, [STEP * largest, 2.0 * band]) => {
                last.rows.end = isobar.rows.end;
                last.pressure = median(&mut readings.pressure[last.rows.clone()].to_vec());
            }
            _ => found.push(isobar),
        }
    }
    found.retain(|isobar| judge.is_driven(&isobar.rows));
    let covered: usize = found.iter().map(|isobar| isobar.rows.len()).sum();
    if (covered as f64) < COVERED * rows.len() as f64 {
        found.retain(|isobar| {
            spread_of(&pressure_of(readings, isobar)) <= FLAT * largest + 0.5 * (band - BAND * largest)
        });
    }
    for isobar in &mut found {
        judge.trim(isobar, (EDGE * largest).max(0.5 * (band - BAND * largest)));
    }
    for second in 1..found.len() {
        // Between the runs the pressure takes some time to settle.
        let (before, after) = (found[second - 1].rows.clone(), found[second].rows.clone());
        if before.end < after.start {
            found[second].rows.start = judge.settled(after.start, after.clone());
            found[second - 1].rows.end = judge.settled(before.end - 1, before.rev()) + 1;
        }
    }
    let is_step = |pair: &[Isobar]| (pair[1].pressure - pair[0].pressure).abs() > STEP * largest;
    if found.windows(2).any(is_step) { found } else { Vec::new() }
}

impl Isobar {
    /// Whether the next piece belongs to the same run: at the same pressure after a disturbance, or reached
    /// without a step within `droop`, as a drooping regulator does.
    fn goes_on(&self, next: &Self, pressure: &[f64], [step, droop]: [f64; 2]) -> bool {
        let change = (next.pressure - self.pressure).abs();
        let gap = next.rows.start - self.rows.end;
        let ends = [self.rows.end.saturating_sub(JUNCTION).max(self.rows.start)..self.rows.end, {
            next.rows.start..(next.rows.start + JUNCTION).min(next.rows.end)
        }];
        let [before, after] = ends.map(|rows| median(&mut pressure[rows].to_vec()));
        if change <= step {
            return gap <= DISTURBED;
        }
        let all = &pressure[self.rows.start..next.rows.end];
        gap == 0 && (after - before).abs() < 0.5 * change && range(all) <= droop
    }
}

/// Pieces whose values stay within the band, each as long as possible: if a later start gives a longer piece,
/// the piece starts there.
fn pieces(values: &[f64], band: f64) -> Vec<Range<usize>> {
    let mut window = Window::new(values);
    let ends: Vec<usize> = (0..values.len()).map(|first| window.last_within(first, band) + 1).collect();
    let mut found = Vec::new();
    let mut start = 0;
    while start < values.len() {
        // Each step only tries starts that were not tried before.
        let mut seen = start + 1;
        loop {
            let longer = (seen..ends[start].min(values.len()))
                .rev()
                .max_by_key(|first| ends[*first] - first)
                .filter(|first| ends[*first] - first > ends[start] - start);
            seen = seen.max(ends[start]);
            match longer {
                Some(first) => start = first,
                None => break,
            }
        }
        if ends[start] - start >= FEWEST {
            found.push(start..ends[start]);
        }
        start = ends[start];
    }
    found
}

fn pressure_of(readings: Readings<'_>, isobar: &Isobar) -> Vec<f64> {
    readings.pressure[isobar.rows.clone()].to_vec()
}

/// Range of the middle eight tenths of the values.
fn spread_of(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let tenth = sorted.len() / 10;
    sorted[sorted.len() - 1 - tenth] - sorted[tenth]
}

fn range(values: &[f64]) -> f64 {
    let (low, high) = bounds(values);
    high - low
}

/// The range of a motion. One reading among others, such as one of the wrong sign, doesn't count.
fn travel(motion: &[f64]) -> f64 {
    let middle = |three: &[f64]| three[0].min(three[1]).max(three[0].max(three[1]).min(three[2]));
    let of_three: Vec<f64> = motion.windows(3).map(middle).collect();
    range(if of_three.is_empty() { motion } else { &of_three })
}

/// Distinguishes a driven muscle from one that follows its pressure.
struct Judge<'a> {
    readings: Readings<'a>,
    /// Total travel in the recording.
    way: f64,
    force_noise: f64,
    motion_noise: f64,
    pressure_noise: f64,
}

impl Judge<'_> {
    fn is_driven(&self, rows: &Range<usize>) -> bool {
        let force = &self.readings.force[rows.clone()];
        let way = travel(&self.readings.motion[rows.clone()]);
        let (low, high) = bounds(force);
        let largest = high.abs().max(low.abs());
        way > (TRAVEL * self.way).max(self.motion_noise)
            && high - low > (FORCE * largest).max(self.force_noise)
    }

    /// Assigns the rows of the steps at both ends to the steps.
    fn trim(&self, isobar: &mut Isobar, edge: f64) {
        let pressure = self.readings.pressure;
        let is_off = |row: usize| (pressure[row] - isobar.pressure).abs() > edge;
        // The median of a regulator that droops through the whole band may lie anywhere in it.
        let off = isobar.rows.clone().filter(|row| is_off(*row)).count();
        if 5 * off > isobar.rows.len() {
            return;
        }
        let start = isobar.rows.clone().find(|row| !is_off(*row)).unwrap_or(isobar.rows.start);
        let end = isobar.rows.clone().rev().find(|row| !is_off(*row)).map_or(isobar.rows.end, |row| row + 1);
        isobar.rows = start..end;
    }

    /// The first row, from an end of a run inwards, at which the muscle no longer rests where it did or the
    /// pressure has reached that of the following rows.
    fn settled(&self, from: usize, rows: impl Iterator<Item = usize> + Clone) -> usize {
        let mut rows = rows;
        loop {
            let mut ahead = rows.clone();
            let inside: Vec<f64> =
                ahead.by_ref().take(SETTLED).map(|row| self.readings.pressure[row]).collect();
            let Some(row) = rows.next() else { return from };
            if inside.len() < SETTLED || !self.settles(row, from, inside) {
                return row;
            }
        }
    }

    /// Whether the muscle still rests as at the end of the run while the pressure hasn't reached that of the
    /// inner rows.
    fn settles(&self, row: usize, from: usize, mut inside: Vec<f64>) -> bool {
        let motion = self.readings.motion;
        let pressure = self.readings.pressure;
        let middle = median(&mut inside);
        (motion[row] - motion[from]).abs() <= self.motion_noise
            && (pressure[row] - middle).abs() > self.pressure_noise
    }
}
