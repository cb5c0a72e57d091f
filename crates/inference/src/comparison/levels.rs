//! Pressure levels: rows measured at about the same pressure, and the folds of held-out data.

use bulge_model::Record;
use std::ops::Range;

/// Most levels. A map of more pressures is cut into this many.
const MOST: usize = 8;
/// Two pressures belong to different levels if a gap of this fraction of the largest pressure lies between
/// them.
const GAP: f64 = 0.03;
/// Most folds.
const FOLDS: usize = 6;

/// Pressure levels of a record.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Levels {
    /// Level of each row; there are few levels, so a byte is enough.
    of: Vec<u8>,
    /// Mean pressure of each level \[Pa\], ascending.
    pub(crate) mean: Vec<f64>,
    is_cut: bool,
}

impl Levels {
    /// Clusters the pressures of the rows that are used.
    pub(crate) fn of(record: &Record, used: &[bool]) -> Self {
        let moments = record.moments();
        let mut order: Vec<usize> = (0..record.len()).filter(|row| used[*row]).collect();
        order.sort_by(|a, b| moments[*a].pressure.total_cmp(&moments[*b].pressure));
        let largest = order.last().map_or(0.0, |row| moments[*row].pressure.abs());
        let mut ends: Vec<usize> = Vec::new();
        for i in 1..order.len() {
            if moments[order[i]].pressure - moments[order[i - 1]].pressure > GAP * largest {
                ends.push(i);
            }
        }
        ends.push(order.len());
        let is_cut = ends.len() > MOST;
        if is_cut {
            ends = (1..=MOST).map(|k| k * order.len() / MOST).collect();
        }
        let mut levels = Self { of: vec![0; record.len()], mean: Vec::new(), is_cut };
        let mut start = 0;
        for end in ends.into_iter().filter(|end| *end > 0) {
            if end <= start {
                continue;
            }
            let sum: f64 = order[start..end].iter().map(|row| moments[*row].pressure).sum();
            for row in &order[start..end] {
                levels.of[*row] = small(levels.mean.len());
            }
            levels.mean.push(sum / (end - start) as f64);
            start = end;
        }
        levels.place_unused(record, used);
        levels
    }

    fn place_unused(&mut self, record: &Record, used: &[bool]) {
        for row in (0..record.len()).filter(|row| !used[*row]) {
            let p = record.moments()[row].pressure;
            let nearest =
                |a: &usize, b: &usize| (self.mean[*a] - p).abs().total_cmp(&(self.mean[*b] - p).abs());
            self.of[row] = small((0..self.mean.len()).min_by(nearest).unwrap_or(0));
        }
    }

    /// Level of a row.
    pub(crate) fn at(&self, row: usize) -> usize {
        usize::from(self.of[row])
    }

    /// Whether the pressures have no distinct levels and were cut into some.
    pub(crate) fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// Number of levels.
    pub(crate) fn len(&self) -> usize {
        self.mean.len()
    }
}

/// Folds: the groups of rows that are left out of a fit in turn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Folds {
    /// `pressure`, `length`, `load`, `sweep` or `specimen`.
    pub(crate) by: &'static str,
    /// Fold of each row; there are few folds, so a byte is enough.
    of: Vec<u8>,
    /// Number of folds.
    pub(crate) count: usize,
}

/// Held lengths or loads belong to different levels if a gap of this fraction of their range lies between
/// them.
const HELD_GAP: f64 = 0.03;
/// Fewest rows per level, on average, for a quantity that counts as held.
const HELD_ROWS: usize = 5;

impl Folds {
    /// Folds by what the test kept distinct: three or more pressures, lengths (isometric) or loads
    /// (isotonic), else two or more specimens, else three or more sweeps; none if nothing can be left out.
    pub(crate) fn of(record: &Record, levels: &Levels, used: &[bool]) -> Option<Self> {
        let folded = |by, of: Vec<usize>, groups: usize| {
            let count = groups.min(FOLDS);
            Some(Self { by, of: of.into_iter().map(|group| small(group * count / groups)).collect(), count })
        };
        if levels.len() >= 3 && !levels.is_cut() {
            return folded("pressure", (0..record.len()).map(|row| levels.at(row)).collect(), levels.len());
        }
        let moments = record.moments();
        let lengths: Vec<f64> = moments.iter().map(|m| m.contraction).collect();
        for (by, values) in [("length", &lengths[..]), ("load", record.force())] {
            if let Some((of, groups)) = held(values, used) {
                return folded(by, of, groups);
            }
        }
        if levels.len() >= 3 {
            return folded("pressure", (0..record.len()).map(|row| levels.at(row)).collect(), levels.len());
        }
        if record.specimens().len() >= 2 {
            let of = moments.iter().map(|m| m.specimen as usize).collect();
            return folded("specimen", of, record.specimens().len());
        }
        if record.sweeps().len() >= 3 {
            let of = (0..record.len()).map(|row| sweep_of(record.sweeps(), row)).collect();
            return folded("sweep", of, record.sweeps().len());
        }
        None
    }

    /// Fold of a row.
    pub(crate) fn at(&self, row: usize) -> usize {
        usize::from(self.of[row])
    }
}

/// A number below [`MOST`], as stored for each row.
fn small(number: usize) -> u8 {
    u8::try_from(number).unwrap_or(u8::MAX)
}

/// Levels of a quantity that was held, if there are three or more: the level of each row, and the number of
/// levels.
fn held(values: &[f64], used: &[bool]) -> Option<(Vec<usize>, usize)> {
    let mut sorted: Vec<f64> =
        values.iter().zip(used).filter(|(_, used)| **used).map(|(value, _)| *value).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let (low, high) = (sorted.first().copied()?, sorted.last().copied()?);
    let edges: Vec<f64> = sorted
        .windows(2)
        .filter(|pair| pair[1] - pair[0] > HELD_GAP * (high - low))
        .map(|pair| 0.5 * (pair[0] + pair[1]))
        .collect();
    let groups = edges.len() + 1;
    let of = values.iter().map(|value| edges.partition_point(|edge| edge < value)).collect();
    (groups >= 3 && sorted.len() >= HELD_ROWS * groups).then_some((of, groups))
}

/// Number of the sweep of each row.
pub(crate) fn sweep_of(sweeps: &[Range<usize>], row: usize) -> usize {
    sweeps.partition_point(|sweep| sweep.end <= row)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Moment;

    fn by(moments: Vec<Moment>, force: Vec<f64>, sweeps: Vec<Range<usize>>) -> Option<(&'static str, usize)> {
        let used = vec![true; moments.len()];
        let record = Record::from_moments(moments, force, sweeps)?;
        Folds::of(&record, &Levels::of(&record, &used), &used).map(|folds| (folds.by, folds.count))
    }

    #[test]
    fn held_out_is_what_was_set_apart() {
        let n = 240;
        let part = |i: usize| i as f64 / n as f64;
        let level = |i: usize| (i * 4 / n) as f64;
        let all = || std::iter::once(0..n).collect::<Vec<_>>();
        let wave = |i: usize| (20.0 * part(i)).sin();
        let of = |moment: &dyn Fn(usize) -> Moment, force: &dyn Fn(usize) -> f64, sweeps| {
            by((0..n).map(moment).collect(), (0..n).map(force).collect(), sweeps)
        };
        let isobaric = |i: usize| Moment::at_rest(1e5 * (1.0 + level(i)), 0.1 + 0.1 * wave(i));
        assert_eq!(of(&isobaric, &|i| 100.0 + 50.0 * wave(i), all()), Some(("pressure", 4)));
        // Hundreds of pressures at four lengths.
        let isometric = |i: usize| Moment::at_rest(2e5 + 1.5e5 * wave(i), 0.05 * level(i) + 1e-4 * wave(i));
        assert_eq!(of(&isometric, &|i| 300.0 + 200.0 * wave(i), all()), Some(("length", 4)));
        // Hundreds of pressures under four loads.
        let isotonic = |i: usize| Moment::at_rest(2e5 + 1.5e5 * wave(i), 0.1 + 0.1 * wave(i));
        assert_eq!(of(&isotonic, &|i| 50.0 * (1.0 + level(i)) + wave(i), all()), Some(("load", 4)));
        let mixed = |i: usize| 100.0 + 50.0 * wave(i);
        let sweeps = vec![0..80, 80..160, 160..n];
        assert_eq!(of(&isotonic, &mixed, sweeps), Some(("sweep", 3)));
        let two = |i: usize| Moment { specimen: u32::from(i >= 120), ..isotonic(i) };
        assert_eq!(of(&two, &mixed, vec![0..120, 120..n]), Some(("specimen", 2)));
        assert_eq!(of(&isotonic, &mixed, all()), None);
    }
}
