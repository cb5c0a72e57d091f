//! The rows of a protocol before anything is measured: sweeps, planned readings, moments for models.

use bulge_measurements::{Columns, Data, Labels, Trace};
use bulge_model::Record;
use bulge_muscles::{Muscle, Quantity};

use crate::error::InferenceError;
use crate::protocol::bench::{Block, Path, Protocol};

/// Temperature of the first row if the bench warms up \[K\].
const COLD_K: f64 = 293.15;

/// One sweep of a plan: a specimen at one pressure or at one contraction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Run {
    pub(crate) block: usize,
    pub(crate) specimen: u32,
    /// First and last pressure of a stroke \[Pa\]; equal if the pressure is held.
    pub(crate) pressure_pa: [f64; 2],
    /// First and last contraction of a stroke; equal if the length is held.
    pub(crate) contraction: [f64; 2],
}

impl Run {
    /// Pressure \[Pa\] and contraction at a row of a cycle.
    pub(crate) fn at(&self, protocol: &Protocol, row: u32) -> [f64; 2] {
        let place = protocol.blocks[self.block].place(row);
        [self.pressure_pa, self.contraction].map(|[low, high]| low + (high - low) * place)
    }

    /// Whether the length is held.
    pub(crate) fn is_isometric(&self) -> bool {
        self.contraction[0].total_cmp(&self.contraction[1]).is_eq()
    }

    /// Whether this run is the planned one, or what is left of it.
    pub(crate) fn is_part_of(&self, planned: &Self) -> bool {
        let same = if planned.is_isometric() {
            Self { pressure_pa: planned.pressure_pa, ..*self }
        } else {
            Self { contraction: planned.contraction, ..*self }
        };
        same == *planned
    }
}

impl Block {
    /// Position of the muscle in its range, from 0 to 1, after `row` of the `rows` of a cycle.
    fn place(&self, row: u32) -> f64 {
        let phase = f64::from(row % self.rows) / f64::from(self.rows);
        match self.path {
            Path::Triangle => 1.0 - (2.0 * phase - 1.0).abs(),
            Path::Sine => 0.5 * (1.0 - (std::f64::consts::TAU * phase).cos()),
            Path::Stairs { steps, hold_s } => {
                let steps = f64::from(steps);
                let level = |stage: f64| steps - (stage - steps).abs();
                let (stage, part) = ((2.0 * steps * phase).floor(), (2.0 * steps * phase).fract());
                let held = hold_s * 2.0 * steps / self.period_s;
                let moved = ((part - held) / (1.0 - held)).max(0.0);
                (level(stage) + (level(stage + 1.0) - level(stage)) * moved) / steps
            }
            Path::Static => f64::from(row) / f64::from(self.rows - 1),
        }
    }
}

impl Protocol {
    /// The planned moments as a record for models. Nothing is measured yet, so forces are 0. Directions,
    /// rates and cycles are those that would be read from exact data.
    ///
    /// Whether the muscle can go there isn't checked here; [`crate::simulate`] does that.
    ///
    /// # Errors
    /// If a number of the protocol is impossible; the message says what to write.
    pub fn moments(&self, muscle: &Muscle) -> Result<Record, InferenceError> {
        self.check()?;
        Ok(Record::new(&self.planned(&self.runs())?, muscle.length().si()))
    }

    /// All sweeps in their order.
    pub(crate) fn runs(&self) -> Vec<Run> {
        let mut runs = Vec::new();
        for (i, block) in self.blocks.iter().enumerate() {
            for specimen in 0..block.specimens {
                for _ in 0..block.repeats {
                    runs.extend(block.sweeps().map(|(pressure_pa, contraction)| Run {
                        block: i,
                        specimen,
                        pressure_pa,
                        contraction,
                    }));
                }
            }
        }
        runs
    }

    /// The rows of some sweeps as exact data, with forces of 0.
    pub(crate) fn planned(&self, runs: &[Run]) -> Result<Data, InferenceError> {
        let (mut pressure, mut contraction, mut time) = (Vec::new(), Vec::new(), Vec::new());
        let (mut sweep, mut specimen) = (Labels::default(), Labels::default());
        let mut clock = 0.0;
        for (number, run) in runs.iter().enumerate() {
            let block = &self.blocks[run.block];
            let interval = block.period_s / f64::from(block.rows);
            let (label, name) = ((number + 1).to_string(), (run.specimen + 1).to_string());
            let cycles = if block.path == Path::Static { 1 } else { block.cycles };
            for row in 0..cycles * block.rows {
                let [p, e] = run.at(self, row);
                pressure.push(p);
                contraction.push(e);
                time.push(clock + f64::from(row) * interval);
                sweep.push(&label);
                specimen.push(&name);
            }
            clock += f64::from(cycles * block.rows - 1) * interval + self.pause_s.max(interval);
        }
        let rows = pressure.len();
        let mut columns = Columns::new(pressure, Trace::Contraction(contraction), vec![0.0; rows]);
        if self.warming_k != 0.0 {
            columns.temperature_k = Some(self.temperatures(&time));
        }
        if self.specimens().len() > 1 {
            columns.specimen = Some(specimen);
        }
        if !self.is_static() {
            columns.time_s = Some(time);
            columns.sweep = Some(sweep);
        }
        Data::from_columns(columns).map_err(|error| InferenceError::Protocol {
            what: format!("the protocol makes no data: {error}"),
            instead: "check its pressures, its range and its times".to_owned(),
        })
    }

    /// Temperatures, linear in time, or in the row number if there is no time.
    fn temperatures(&self, time: &[f64]) -> Vec<f64> {
        let rows = time.len().saturating_sub(1).max(1) as f64;
        let end = time.last().copied().unwrap_or(0.0);
        let part = |(row, t): (usize, &f64)| {
            if end > 0.0 && !self.is_static() { t / end } else { row as f64 / rows }
        };
        time.iter().enumerate().map(|row| COLD_K + self.warming_k * part(row)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_muscles::preset;

    fn record(block: Block) -> Record {
        Protocol::new(vec![block]).moments(&preset("ppam-2-r16").unwrap()).unwrap()
    }

    /// Loops have the directions and speeds of the planned motion, up to the rows at the turning points.
    #[test]
    fn loops_move_as_planned() {
        let block = Block { cycles: 2, ..Block::loops(vec![1e5, 2e5], [0.02, 0.12], 40.0) };
        let found = record(block.clone());
        assert_eq!((found.len(), found.sweeps().len(), found.has_time()), (200, 2, true));
        let moments = found.moments();
        for (row, moment) in moments.iter().enumerate().take(100) {
            let phase = row % 50;
            let expected = if phase == 0 && row > 0 || phase > 25 { -1.0 } else { 1.0 };
            assert!((moment.direction - expected).abs() < 1e-12, "row {row}: {moment:?}");
            // 10 % in 20 s.
            assert!((moment.rate - 0.005 * expected).abs() < 1e-6, "row {row}: {moment:?}");
            assert!((moment.time - 0.8 * row as f64).abs() < 1e-9);
        }
        assert!((moments[25].contraction - 0.12).abs() < 1e-15 && (moments[100].pressure - 2e5).abs() < 1e-9);
        assert!((moments[100].clock - (99.0 * 0.8 + 10.0)).abs() < 1e-9);
        // The cycle number includes the fraction of a loop (50 rows) that is done.
        assert!((moments[60].cycle - 1.2).abs() < 1e-9 && (moments[110].cycle - 2.2).abs() < 1e-9);
        let sine = record(Block { path: Path::Sine, ..block });
        let fastest = 0.05 * std::f64::consts::TAU / 40.0;
        let rate = sine.moments()[12].rate;
        assert!((rate / fastest - 1.0).abs() < 0.02, "{rate} is not {fastest}");
    }

    #[test]
    fn stairs_rest_on_their_levels() {
        let path = Path::Stairs { steps: 4, hold_s: 6.0 };
        let block = Block { path, rows: 160, ..Block::loops(vec![1e5], [0.0, 0.2], 64.0) };
        // A stage of 8 s has 20 rows: 15 at rest, 5 on the way to the next level.
        let moments = record(block).moments().to_vec();
        for stage in 0..8 {
            let level = 0.05 * f64::from(4 - (stage - 4_i32).abs());
            let first = 20 * usize::try_from(stage).unwrap();
            for moment in &moments[first + 1..first + 15] {
                assert!((moment.contraction - level).abs() < 1e-12, "{stage}: {moment:?}");
                assert!(moment.direction.abs() < 1e-12, "{stage}: {moment:?}");
            }
            let direction = if stage < 4 { 1.0 } else { -1.0 };
            for moment in &moments[first + 17..first + 20] {
                assert!((moment.direction - direction).abs() < 1e-12, "{stage}: {moment:?}");
            }
        }
    }

    #[test]
    fn a_map_has_no_time_and_a_warm_bench_has_temperatures() {
        let found = record(Block::map(vec![1e5, 2e5], [0.05, 0.25], 5));
        let contractions: Vec<f64> = found.moments().iter().map(|m| m.contraction).collect();
        assert_eq!((found.is_path(), found.has_time(), found.len()), (false, false, 10));
        for (found, expected) in contractions.iter().zip([0.05, 0.1, 0.15, 0.2, 0.25, 0.05]) {
            assert!((found - expected).abs() < 1e-12);
        }
        let protocol = Protocol {
            warming_k: 8.0,
            ..Protocol::new(vec![Block { specimens: 2, ..Block::loops(vec![1e5], [0.0, 0.1], 10.0) }])
        };
        let found = protocol.moments(&preset("ppam-2-r16").unwrap()).unwrap();
        assert_eq!(found.specimens(), ["1", "2"]);
        let last = found.moments()[found.len() - 1];
        assert!((last.temperature - 8.0).abs() < 1e-9 && last.specimen == 1, "{last:?}");
    }

    #[test]
    fn what_a_program_gets_wrong_is_refused() {
        let muscle = preset("ppam-2-r16").unwrap();
        let good = Block::loops(vec![1e5], [0.0, 0.1], 10.0);
        for (protocol, part) in [
            (Protocol::new(Vec::new()), "needs a block"),
            (Protocol::new(vec![Block { rows: 3, ..good.clone() }]), "block 1: `rows` is 3"),
            (Protocol::new(vec![Block { period_s: f64::NAN, ..good.clone() }]), "period of NaN"),
            (
                Protocol::new(vec![Block { contraction: [0.0, 0.9], ..good.clone() }]),
                "within -100 % and 60 %",
            ),
            (Protocol { pause_s: -1.0, ..Protocol::new(vec![good.clone()]) }, "a pause of -1 s"),
            (Protocol { warming_k: 900.0, ..Protocol::new(vec![good]) }, "900 K"),
        ] {
            let message = protocol.moments(&muscle).unwrap_err().to_string();
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
    }
}
