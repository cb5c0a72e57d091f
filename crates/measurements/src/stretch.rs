//! Monotone stretches of a motion: turning points by a zigzag with a dead band, and rests.

use crate::resolution::{Resolution, median};
use crate::window::Window;
use std::borrow::Cow;
use std::ops::Range;

/// Rows over which the motion keeps its direction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Stretch {
    /// Its rows; a turning point belongs to the stretch that it ends.
    pub(crate) rows: Range<usize>,
    /// +1 shortening, -1 lengthening, 0 at rest.
    pub(crate) direction: i8,
}

impl Stretch {
    /// The row at which the motion starts: the turning point before it, or the first row of the sweep.
    pub(crate) fn from(&self, sweep: &Range<usize>) -> usize {
        if self.rows.start > sweep.start { self.rows.start - 1 } else { self.rows.start }
    }
}

/// The smallest motion that isn't noise.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct DeadBand {
    /// A reversal counts if the motion goes back by more than this.
    pub(crate) width: f64,
    /// Half the band required by noise and quantisation, without the fraction of the travel.
    half_noise: f64,
}

impl DeadBand {
    /// Smallest reversal as a fraction of the total travel in the data.
    const OF_TRAVEL: f64 = 1e-3;
    /// Largest noise of a contraction, or of a length relative to the longest; a larger zigzag is motion,
    /// such as a list of set points.
    const MOST_NOISE: f64 = 0.003;
    /// Largest step of a length sensor; a wider grid is a list of set points.
    const WIDEST_STEP: f64 = 0.005;

    /// The band for a motion with this resolution, in sweeps of at most `rows` rows; `scale` is 1 for
    /// contractions and the longest length for lengths.
    ///
    /// The band is the largest of 1.5 quantisation steps (a reading flips by one step), 2 (1 + sqrt(2 ln n))
    /// standard deviations of the noise (n normal numbers stay within +-sqrt(2 ln n), nearly always within
    /// one more), and 1/1000 of the travel.
    pub(crate) fn new(resolution: &Resolution, rows: usize, scale: f64) -> Self {
        let noise = resolution.noise.min(Self::MOST_NOISE * scale);
        let step = if resolution.step <= Self::WIDEST_STEP * scale { resolution.step } else { 0.0 };
        let spread = 1.0 + (2.0 * (rows.max(2) as f64).ln()).sqrt();
        let half_noise = (0.75 * step).max(spread * noise);
        Self { width: (2.0 * half_noise).max(Self::OF_TRAVEL * resolution.range), half_noise }
    }

    /// The apparent travel that noise and steps of the sensor cause.
    pub(crate) fn resolved(&self) -> f64 {
        self.half_noise
    }
}

/// The stretches of one sweep, in order, covering `rows`. `shortening` is the contraction or the negative
/// length; it and `time` cover all rows.
pub(crate) fn find(
    shortening: &[f64],
    time: Option<&[f64]>,
    rows: &Range<usize>,
    band: DeadBand,
) -> Vec<Stretch> {
    let s = shortening.get(rows.clone()).unwrap_or_default();
    if s.is_empty() {
        return Vec::new();
    }
    let legs = legs(s, band.width);
    // The direction of the step that leads to each row.
    let mut directions = Vec::with_capacity(s.len());
    for leg in &legs {
        directions.resize(leg.end + 1, leg.direction);
    }
    let time = time.and_then(|time| time.get(rows.clone())).filter(|t| t.windows(2).all(|w| w[0] <= w[1]));
    for rest in rests(s, time, &legs, band) {
        directions[rest.start + 1..rest.end].fill(0);
    }
    // No step leads to the first row, so it belongs to the following stretch.
    if let Some(second) = directions.get(1).copied() {
        directions[0] = second;
    }
    let mut found = Vec::new();
    let mut start = 0;
    for part in directions.chunk_by(|a, b| a == b) {
        let end = start + part.len();
        found.push(Stretch { rows: rows.start + start..rows.start + end, direction: part[0] });
        start = end;
    }
    found
}

/// Rows on either side of a turning point that may belong to either stretch.
pub(crate) const NEAR_TURN: usize = 2;
/// Largest fraction of wrong labels among the moving rows for labels that are used.
const WRONG: f64 = 0.05;

/// The rows that certainly belong to a stretch; the ends of a sweep aren't turning points.
pub(crate) fn inner(stretch: &Stretch, sweep: &Range<usize>) -> Range<usize> {
    let start = stretch.rows.start + if stretch.rows.start > sweep.start { NEAR_TURN } else { 0 };
    let end = stretch.rows.end.saturating_sub(if stretch.rows.end < sweep.end { NEAR_TURN } else { 0 });
    start..end.max(start)
}

/// The stretches given by stated directions of all rows, if these agree with the motion: they are more
/// accurate about turns and rests.
///
/// Directions that contradict the motion in more than 5 % of the rows that certainly move, or that change
/// more than twice as often, are not used.
pub(crate) fn told<'a>(
    found: &'a [Stretch],
    sweep: &Range<usize>,
    stated: Option<&[i8]>,
) -> Cow<'a, [Stretch]> {
    let Some(stated) = stated.and_then(|stated| stated.get(sweep.clone())) else { return found.into() };
    let (mut wrong, mut moving) = (0_usize, 0_usize);
    for stretch in found.iter().filter(|stretch| stretch.direction != 0) {
        let rows = inner(stretch, sweep);
        moving += rows.len();
        wrong += rows.filter(|row| stated[row - sweep.start] != stretch.direction).count();
    }
    let mut start = sweep.start;
    let parts = stated.chunk_by(|a, b| a == b).map(|part| {
        let rows = start..start + part.len();
        start = rows.end;
        Stretch { rows, direction: part[0] }
    });
    let told: Vec<Stretch> = parts.collect();
    let is_used = moving > 0 && wrong as f64 <= WRONG * moving as f64 && told.len() <= 2 * found.len() + 1;
    if is_used { told.into() } else { found.into() }
}

/// A leg from one turning point to the next; rows count from the start of the sweep.
struct Leg {
    start: usize,
    end: usize,
    direction: i8,
}

/// The zigzag: a row is a turning point if the motion goes back from it by more than the band before it goes
/// on.
fn legs(s: &[f64], band: f64) -> Vec<Leg> {
    let mut found: Vec<Leg> = Vec::new();
    let (mut lowest, mut highest, mut direction) = (0, 0, 0_i8);
    let mut close = |end: usize, direction: i8| {
        let start = found.last().map_or(0, |leg| leg.end);
        found.push(Leg { start, end, direction });
    };
    for (i, value) in s.iter().enumerate() {
        if *value > s[highest] {
            highest = i;
        }
        if *value < s[lowest] {
            lowest = i;
        }
        if direction <= 0 && value - s[lowest] > band {
            if direction < 0 {
                close(lowest, -1);
            }
            (direction, highest) = (1, i);
        } else if direction >= 0 && s[highest] - value > band {
            if direction > 0 {
                close(highest, 1);
            }
            (direction, lowest) = (-1, i);
        }
    }
    close(s.len() - 1, direction);
    found
}

/// Rests, as ranges of rows from the first to the last one that stand still.
///
/// Rows stand still if they stay within the band for much longer than a sine would near its turning point. A
/// sine of height H with the time D from one turning point to the next is within b of one of them for (2/pi)
/// D sqrt(b/H); three times as long is a rest. The time is counted in rows if none was measured.
fn rests(s: &[f64], time: Option<&[f64]>, legs: &[Leg], band: DeadBand) -> Vec<Range<usize>> {
    /// 3 * 2/pi, rounded.
    const TIMES: f64 = 2.0;
    let clock = |row: usize| time.map_or(row as f64, |time| time[row]);
    let longest: Vec<f64> = legs
        .iter()
        .map(|leg| {
            let height = (s[leg.end] - s[leg.start]).abs().max(band.width);
            let share = if height > 0.0 { (band.width / height).sqrt() } else { 0.0 };
            TIMES * share * (clock(leg.end) - clock(leg.start))
        })
        .collect();
    let allowed = |first: usize, last: usize| {
        let from = legs.partition_point(|leg| leg.end <= first);
        legs.iter()
            .zip(&longest)
            .skip(from)
            .take_while(|(leg, _)| leg.start < last)
            .map(|(_, d)| d)
            .sum::<f64>()
    };
    let is_rest =
        |first: usize, last: usize| last >= first + 2 && clock(last) - clock(first) > allowed(first, last);
    if legs.iter().all(|leg| leg.direction == 0) {
        return std::iter::once(0..s.len()).collect();
    }
    let tolerance = band.half_noise.max(0.25 * band.width);
    let mut found: Vec<Range<usize>> = Vec::new();
    let mut window = Window::new(s);
    let mut first = 0;
    while first < s.len() {
        let last = window.last_within(first, band.width);
        if !is_rest(first, last) {
            first += 1;
            continue;
        }
        let middle = median(&mut s[first..=last].to_vec());
        let is_still = |row: &usize| (s[*row] - middle).abs() <= tolerance;
        let start = (first..=last).find(is_still).unwrap_or(first);
        // The window contained some rows of the motion before; without them it reaches further.
        let last = window.last_within(start, band.width);
        let end = (start..=last).rev().find(is_still).unwrap_or(last);
        if !is_rest(start, end) {
            // Slow, but not at rest: continue from the middle.
            first = start + (last - start) / 2 + 1;
            continue;
        }
        match found.last_mut() {
            Some(Range { end: before, .. }) if *before >= start => *before = end + 1,
            _ => found.push(start..end + 1),
        }
        first = end + 1;
    }
    merged(found, dwells(s, &clock))
}

/// Rests by equal readings: rows that stay on one reading for much longer than on the readings before and
/// after it.
///
/// A steady motion stays equally long on every level of a sensor; a sine stays 5 times as long on that of its
/// turning point as beside it. For a motion along set points, which may look like a coarse sensor, this is
/// the only way to find rests.
fn dwells(s: &[f64], clock: &dyn Fn(usize) -> f64) -> Vec<Range<usize>> {
    const TIMES: f64 = 10.0;
    let mut runs: Vec<Range<usize>> = Vec::new();
    for part in s.chunk_by(|a, b| a.total_cmp(b).is_eq()) {
        let start = runs.last().map_or(0, |run| run.end);
        runs.push(start..start + part.len());
    }
    // The time until the next reading, if there is one.
    let dwell = |run: &Range<usize>| clock(run.end.min(s.len() - 1)) - clock(run.start);
    let beside = |i: usize| {
        let before = i.checked_sub(1).map(|i| &runs[i]);
        let longest = [before, runs.get(i + 1)].into_iter().flatten().map(&dwell).fold(f64::NAN, f64::max);
        // No reading follows the last one.
        if longest > 0.0 { longest } else { f64::INFINITY }
    };
    let is_rest = |(i, run): &(usize, &Range<usize>)| run.len() > 2 && dwell(run) > TIMES * beside(*i);
    runs.iter().enumerate().filter(is_rest).map(|(_, run)| run.clone()).collect()
}

/// Merges two lists of ranges, in order; overlapping ranges become one.
fn merged(mut one: Vec<Range<usize>>, other: Vec<Range<usize>>) -> Vec<Range<usize>> {
    one.extend(other);
    one.sort_by_key(|range| range.start);
    let mut found: Vec<Range<usize>> = Vec::new();
    for range in one {
        match found.last_mut() {
            Some(before) if range.start < before.end => before.end = before.end.max(range.end),
            _ => found.push(range),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated::Noise;

    #[track_caller]
    fn directions(s: &[f64]) -> Vec<(usize, i8)> {
        let rows = 0..s.len();
        let resolution = Resolution::of(s, std::slice::from_ref(&rows));
        let found = find(s, None, &rows, DeadBand::new(&resolution, s.len(), 1.0));
        let mut end = 0;
        for stretch in &found {
            assert_eq!(stretch.rows.start, end);
            end = stretch.rows.end;
        }
        assert_eq!(end, s.len());
        found.iter().map(|stretch| (stretch.rows.end, stretch.direction)).collect()
    }

    /// Values from corner to corner, with this many steps between them.
    fn polyline(corners: &[(f64, usize)]) -> Vec<f64> {
        let mut s = vec![corners[0].0];
        for pair in corners.windows(2) {
            let ((from, _), (to, steps)) = (pair[0], pair[1]);
            s.extend((1..=steps).map(|i| from + (to - from) * i as f64 / steps as f64));
        }
        s
    }

    #[test]
    fn turning_points_of_a_sine() {
        let s: Vec<f64> = (0..=800).map(|i| -(f64::from(i) * std::f64::consts::TAU / 400.0).cos()).collect();
        assert_eq!(directions(&s), [(201, 1), (401, -1), (601, 1), (801, -1)]);
    }

    #[test]
    fn triangles_with_minor_loops() {
        let s = polyline(&[(0.0, 0), (0.2, 100), (0.15, 25), (0.18, 15), (0.0, 90), (0.01, 5), (0.0, 5)]);
        assert_eq!(directions(&s), [(101, 1), (126, -1), (141, 1), (231, -1), (236, 1), (241, -1)]);
    }

    #[test]
    fn rests_between_ramps() {
        // Rests before the motion, at the top, on the way down, and after it.
        let s = polyline(&[
            (0.0, 0),
            (0.0, 30),
            (0.2, 100),
            (0.2, 40),
            (0.0937, 50),
            (0.0937, 35),
            (0.0, 50),
            (0.0, 30),
        ]);
        assert_eq!(directions(&s), [(31, 0), (131, 1), (171, 0), (221, -1), (256, 0), (306, -1), (336, 0)]);
    }

    #[test]
    fn noise_flips_nothing() {
        for seed in 0..20 {
            let mut noise = Noise::new(seed);
            let corners =
                [(0.0, 0), (0.2, 400), (0.2, 300), (0.05, 300), (0.05, 300), (0.2, 300), (0.0, 400)];
            let mut s = polyline(&corners);
            for value in &mut s {
                *value += 2e-4 * noise.normal();
            }
            let found = directions(&s);
            assert_eq!(
                found.iter().map(|(_, d)| *d).collect::<Vec<_>>(),
                [1, 0, -1, 0, 1, -1],
                "{seed}: {found:?}"
            );
            for ((end, _), expected) in found.iter().zip([401, 701, 1001, 1301, 1601, 2001]) {
                assert!(end.abs_diff(expected) <= 6, "{seed}: {found:?}");
            }
        }
    }

    #[test]
    fn a_hold_with_noise_is_one_rest() {
        for seed in 0..20 {
            let mut noise = Noise::new(seed);
            let s: Vec<f64> = (0..5000).map(|_| 0.1 + 1e-4 * noise.normal()).collect();
            assert_eq!(directions(&s), [(5000, 0)], "{seed}");
            let coarse: Vec<f64> = s.iter().map(|v| (v / 1e-4).round() * 1e-4).collect();
            assert_eq!(directions(&coarse), [(5000, 0)], "{seed}");
        }
    }

    #[test]
    fn steps_of_a_coarse_sensor_are_motion() {
        let s: Vec<f64> = polyline(&[(0.0, 0), (0.1, 2000), (0.0, 2000)]);
        let coarse: Vec<f64> = s.iter().map(|v| (v / 0.002).round() * 0.002).collect();
        let found = directions(&coarse);
        assert_eq!(found.iter().map(|(_, d)| *d).collect::<Vec<_>>(), [1, -1]);
        assert!(found[0].0.abs_diff(2001) <= 25, "{found:?}");
    }

    /// Steps of one ramp row each look like the levels of a coarse sensor, and hide the holds between them
    /// from the band.
    #[test]
    fn holds_between_set_points_on_a_grid_are_rests() {
        let mut corners = vec![(0.0, 0)];
        for level in [1, 2, 3, 2, 1, 0] {
            let last = corners[corners.len() - 1].0;
            corners.extend([(last, 60), (0.03 * f64::from(level), 6)]);
        }
        let s: Vec<f64> = polyline(&corners).iter().map(|v| (v / 0.005).round() * 0.005).collect();
        let holds: Vec<i8> = directions(&s).iter().map(|(_, d)| *d).collect();
        assert_eq!(holds, [0, 1, 0, 1, 0, 1, 0, -1, 0, -1, 0, -1]);
        // A slow sine on the same grid stays longest at its turning points, but never rests.
        let sine = (0..=4000).map(|i| 0.05 * (1.0 - (f64::from(i) * std::f64::consts::TAU / 2000.0).cos()));
        let coarse: Vec<f64> = sine.map(|v: f64| (v / 0.005).round() * 0.005).collect();
        assert!(directions(&coarse).iter().all(|(_, d)| *d != 0), "{:?}", directions(&coarse));
    }

    #[test]
    fn lists_of_set_points() {
        assert_eq!(directions(&[0.0, 0.05, 0.10, 0.15, 0.10, 0.05, 0.0]), [(4, 1), (7, -1)]);
        let zigzag = [0.0, 0.10, 0.03, 0.15, 0.07, 0.20];
        assert_eq!(directions(&zigzag), [(2, 1), (3, -1), (4, 1), (5, -1), (6, 1)]);
        assert_eq!(directions(&[0.1]), [(1, 0)]);
        assert_eq!(directions(&[0.1, 0.2]), [(2, 1)]);
        assert_eq!(directions(&[0.1; 5]), [(5, 0)]);
        assert_eq!(directions(&[]), []);
    }
}
