//! The motion of the muscle: direction, rate, reversals and cycles of each row.

use crate::columns::picked;
use crate::data::Data;
use crate::rate;
use crate::stretch::{self, Stretch};
use crate::sweep::{Sweep, SweepKind};
use serde::Serialize;

/// The motion of the muscle, one value per row.
///
/// Directions come from turning points: a row is a turning point if the contraction goes back from it by more
/// than a dead band before it goes on. The band is the largest of 1.5 quantisation steps, 2 (1 + sqrt(2 ln
/// n)) standard deviations of the noise (n rows in the longest sweep), and 1/1000 of the travel. Rows that
/// stay within the band for three times as long as a sine near its turning point are at rest. Directions
/// stated in the file are used if they agree with the motion. A turning point belongs to the stretch that it
/// ends, so that a row's direction is that of the motion that led to it; the first row of a sweep takes the
/// direction of the second.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct History {
    /// +1 shortening, -1 lengthening, 0 at rest and in isometric sweeps. In a static map: the stated
    /// direction, or 0.
    pub direction: Vec<f64>,
    /// +1 while the pressure rises, -1 while it falls, 0 at rest, in sweeps at constant pressure, and in a
    /// static map.
    pub pressure_direction: Vec<f64>,
    /// Direction of the last motion, also during a rest: the branch of the hysteresis loop on which the row
    /// lies; 0 before any motion. In isometric sweeps the direction of the pressure.
    pub approach: Vec<f64>,
    /// Rate of contraction \[1/s\], positive when shortening; 0 at rest, without time and in a static map.
    pub rate: Vec<f64>,
    /// Contraction since the last reversal, or since the start of the sweep, >= 0; in isometric sweeps since
    /// the last reversal of the pressure.
    pub since_reversal: Vec<f64>,
    /// Time since the last reversal, or since the start of the sweep \[s\]; 0 without time.
    pub time_since_reversal: Vec<f64>,
    /// Time \[s\]; 0 without time.
    pub time: Vec<f64>,
    /// Number of the load cycle: the stated one, otherwise the full loops that the specimen has done so far,
    /// from 0, over all its sweeps. If a sweep has the direction of the one before it and starts further
    /// back, a loop is counted whose return wasn't measured.
    pub cycle: Vec<f64>,
    /// Number of the monotone stretch in its sweep, from 0; a rest counts as a stretch.
    pub branch: Vec<u32>,
    /// Whether rows follow each other (they have a time or a sweep label).
    pub is_path: bool,
}

impl History {
    /// The rows with `keep`; rows beyond the end of `keep` are dropped.
    #[must_use]
    pub fn subset(&self, keep: &[bool]) -> Self {
        let rows: Vec<usize> =
            keep.iter().enumerate().filter(|(_, kept)| **kept).map(|(row, _)| row).collect();
        Self {
            direction: picked(&self.direction, &rows),
            pressure_direction: picked(&self.pressure_direction, &rows),
            approach: picked(&self.approach, &rows),
            rate: picked(&self.rate, &rows),
            since_reversal: picked(&self.since_reversal, &rows),
            time_since_reversal: picked(&self.time_since_reversal, &rows),
            time: picked(&self.time, &rows),
            cycle: picked(&self.cycle, &rows),
            branch: picked(&self.branch, &rows),
            is_path: self.is_path,
        }
    }
}

impl Data {
    /// The motion of the muscle. `l0` is the unpressurised length \[m\], > 0; it only matters if the length
    /// was measured.
    #[must_use]
    pub fn history(&self, l0: f64) -> History {
        let rows = self.len();
        let mut history = History {
            direction: vec![0.0; rows],
            pressure_direction: vec![0.0; rows],
            approach: vec![0.0; rows],
            rate: vec![0.0; rows],
            since_reversal: vec![0.0; rows],
            time_since_reversal: vec![0.0; rows],
            time: self.time().map_or_else(|| vec![0.0; rows], <[f64]>::to_vec),
            cycle: vec![0.0; rows],
            branch: vec![0; rows],
            is_path: self.is_path(),
        };
        if history.is_path {
            let shortening = self.shortening();
            let mut loops: Vec<Loops> = vec![Loops::default(); self.specimens().len()];
            for ((sweep, stretches), filling) in self.paths().zip(self.pressure_paths()) {
                let is_isometric = sweep.kind == SweepKind::Isometric;
                // The driven quantity: the length, or the pressure if the length is held.
                let (driven, values, band) = if is_isometric {
                    (filling, self.pressure(), self.structure.pressure_band)
                } else {
                    (stretches, &shortening[..], self.structure.band)
                };
                let driven = &*stretch::told(driven, &sweep.rows, self.columns().direction.as_deref());
                let contraction = self.contraction_per_shortening(sweep.specimen, l0);
                self.follow(sweep, driven, &shortening, contraction, &mut history);
                if is_isometric {
                    history.direction[sweep.rows.clone()].fill(0.0);
                    history.rate[sweep.rows.clone()].fill(0.0);
                }
                for stretch in if is_isometric { driven } else { filling } {
                    history.pressure_direction[stretch.rows.clone()].fill(f64::from(stretch.direction));
                }
                if let Some(loops) = loops.get_mut(sweep.specimen as usize) {
                    loops.count(sweep, driven, values, band.width, &mut history.cycle);
                }
            }
        } else if let Some(stated) = self.columns().direction.as_deref() {
            history.direction = stated.iter().map(|direction| f64::from(*direction)).collect();
            history.approach.clone_from(&history.direction);
            for sweep in self.sweeps() {
                let runs = stated[sweep.rows.clone()].chunk_by(|a, b| a == b);
                let branches =
                    runs.zip(0_u32..).flat_map(|(run, branch)| std::iter::repeat_n(branch, run.len()));
                history.branch.splice(sweep.rows.clone(), branches);
            }
        }
        if let Some(cycle) = self.columns().cycle.as_deref() {
            history.cycle = cycle.iter().map(|cycle| *cycle as f64).collect();
        }
        history
    }

    /// Directions, rates and reversals of one sweep.
    fn follow(
        &self,
        sweep: &Sweep,
        stretches: &[Stretch],
        s: &[f64],
        contraction: f64,
        history: &mut History,
    ) {
        let time = self.time();
        let (mut approach, mut reversal) = (0_i8, sweep.rows.start);
        for (stretch, branch) in stretches.iter().zip(0_u32..) {
            let from = stretch.from(&sweep.rows);
            if stretch.direction != 0 {
                if approach == -stretch.direction {
                    reversal = from;
                }
                approach = stretch.direction;
            }
            for row in stretch.rows.clone() {
                history.direction[row] = f64::from(stretch.direction);
                history.approach[row] = f64::from(approach);
                history.branch[row] = branch;
                history.since_reversal[row] = ((s[row] - s[reversal]) * contraction).abs();
                history.time_since_reversal[row] =
                    time.map_or(0.0, |time| (time[row] - time[reversal]).max(0.0));
            }
            if let Some(time) = time
                && stretch.direction != 0
            {
                let all = from..stretch.rows.end;
                let resolution = &self.structure.resolution;
                let rates = rate::along(&s[all.clone()], &time[all.clone()], stretch.direction, resolution);
                let own = rates.iter().skip(stretch.rows.start - from).map(|rate| rate * contraction);
                history.rate.splice(stretch.rows.clone(), own);
            }
        }
    }
}

/// Counts the full loops of a specimen.
#[derive(Debug, Clone, Copy, Default)]
struct Loops {
    /// Direction of the first motion; 0 before any motion.
    first: i8,
    /// Direction of the last motion; the next field is its end.
    last: i8,
    end: f64,
    done: u32,
}

impl Loops {
    fn count(&mut self, sweep: &Sweep, stretches: &[Stretch], s: &[f64], band: f64, cycle: &mut [f64]) {
        for (i, stretch) in stretches.iter().enumerate() {
            let direction = stretch.direction;
            if direction != 0 {
                let start = s[stretch.from(&sweep.rows)];
                let is_back = (self.end - start) * f64::from(direction) > band;
                let is_new_sweep = stretches[..i].iter().all(|earlier| earlier.direction == 0);
                let returns = if direction == self.last {
                    is_new_sweep && is_back
                } else {
                    self.last != 0 && direction == self.first
                };
                self.done += u32::from(returns);
                if self.first == 0 {
                    self.first = direction;
                }
                (self.last, self.end) = (direction, s[stretch.rows.end - 1]);
            }
            cycle[stretch.rows.clone()].fill(f64::from(self.done));
        }
    }
}
