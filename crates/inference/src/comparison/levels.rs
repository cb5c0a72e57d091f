//! Pressure levels: which rows were measured at about the same pressure, and which rows to leave out together.

use bulge_model::Record;
use std::ops::Range;

/// Most levels that are told apart; a map of many pressures is cut into this many.
const MOST: usize = 8;
/// Two pressures belong to different levels if this part of the largest pressure lies between them without a row.
const GAP: f64 = 0.03;
/// Most groups that are left out in turn.
const FOLDS: usize = 6;

/// Pressure levels of a record.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Levels {
    /// Level of each row.
    pub(crate) of: Vec<usize>,
    /// Mean pressure of each level \[Pa\], rising.
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
                levels.of[*row] = levels.mean.len();
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
            self.of[row] = (0..self.mean.len()).min_by(nearest).unwrap_or(0);
        }
    }

    /// Whether the pressures have no levels of their own, but were cut into some.
    pub(crate) fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// Number of levels.
    pub(crate) fn len(&self) -> usize {
        self.mean.len()
    }
}

/// What is left out of a fit together, in turn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Folds {
    /// `pressure`, `specimen` or `sweep`.
    pub(crate) by: &'static str,
    /// Fold of each row.
    pub(crate) of: Vec<usize>,
    /// Number of folds.
    pub(crate) count: usize,
}

impl Folds {
    /// Whole pressures if there are three, else specimens, else sweeps; none if nothing can be left out.
    pub(crate) fn of(record: &Record, levels: &Levels) -> Option<Self> {
        let folded = |by, of: Vec<usize>, groups: usize| {
            let count = groups.min(FOLDS);
            Some(Self { by, of: of.into_iter().map(|group| group * count / groups).collect(), count })
        };
        if levels.len() >= 3 {
            return folded("pressure", levels.of.clone(), levels.len());
        }
        if record.specimens().len() >= 2 {
            let of = record.moments().iter().map(|m| m.specimen as usize).collect();
            return folded("specimen", of, record.specimens().len());
        }
        if record.sweeps().len() >= 3 {
            return folded("sweep", sweep_of(record.sweeps(), record.len()), record.sweeps().len());
        }
        None
    }
}

/// Number of the sweep of each row.
pub(crate) fn sweep_of(sweeps: &[Range<usize>], rows: usize) -> Vec<usize> {
    let mut of = vec![0; rows];
    for (number, sweep) in sweeps.iter().enumerate() {
        of[sweep.clone()].fill(number);
    }
    of
}
