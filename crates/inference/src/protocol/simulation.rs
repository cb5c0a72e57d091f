//! Synthetic measurements: a model along a protocol, read with the noise, resolution and rig errors that the
//! protocol states.

use bulge_measurements::Data;
use bulge_model::{Model, ModelError, Prediction, Record, Wanted};
use bulge_muscles::{Instrument, Instruments, Muscle, Quantity, Ratio, units};
use std::fmt::Write;

use crate::comparison::requirements::check_needs;
use crate::error::InferenceError;
use crate::protocol::bench::{Block, Path, Protocol, RigErrors};
use crate::protocol::planned::Run;
use crate::protocol::truth::{Ended, RigReadings, Truth, hidden};
use bulge_numerics::Random;

/// Most passes in which ranges are shortened.
const MOST_PASSES: usize = 60;
/// Rows of a cycle when searching for the ends of the ranges.
const FEW_ROWS: u32 = 200;
/// A sweep over less contraction than this is dropped.
const LEAST_RANGE: f64 = 2e-3;
/// At held length, a sweep over less than this fraction of its highest pressure is dropped.
const LEAST_PRESSURE_RANGE: f64 = 0.1;
/// Decimals in the file: time \[s\], pressure \[bar\], contraction \[%\], temperature \[K\] and force \[N\].
const DECIMALS: [usize; 5] = [6, 7, 6, 4, 4];

/// Random streams: one for the rig and five for each sweep, so that changing one noise leaves the others as
/// they are.
const RIG_STREAM: u64 = 0;
const STREAMS: u64 = 8;
const WHITE: u64 = 0;
const CORRELATED: u64 = 1;
const OFFSET: u64 = 2;
const PRESSURE: u64 = 3;
const LENGTH: u64 = 4;

/// Synthetic measurements, and what is hidden in them.
#[derive(Debug, Clone)]
pub struct Simulation {
    /// The data file, as text.
    pub csv: String,
    /// The same data, as read from the text.
    pub data: Data,
    /// The planned moments of its rows, without noise, with the exact model force.
    pub exact: Record,
    /// The muscle as stated, without the hidden effects; its `[instruments]` have the noise.
    pub muscle: Muscle,
    /// What is hidden.
    pub truth: Truth,
}

/// The rows that a muscle can do, with their forces.
struct Done {
    runs: Vec<Run>,
    /// For a static map: whether each planned row is kept.
    kept: Vec<bool>,
    data: Data,
    record: Record,
    force: Vec<f64>,
}

/// What a bench would measure of a model with parameters `theta` along a protocol.
///
/// ```text
/// force = F(p, eps, history; theta) (1 + g_f) + z_f + u + a + w        u per sweep, a exponentially correlated in time, w white
/// pressure = p (1 + g_p) + z_p + w_p,    contraction = eps (1 + g_l) - (z_l + w_l)/l0        all rounded to the steps of the sensors
/// ```
/// p and eps are the planned values. A sweep ends before the contractions at which the muscle would push or
/// has no equilibrium; in a static map such rows are left out. Random numbers are counter-based ([`Random`]),
/// so that a seed gives the same text whatever the number of threads.
///
/// # Errors
/// If the protocol is impossible, if it can't show an effect whose parameters are not fixed, or if the muscle
/// pulls nowhere.
pub fn simulate(
    model: &Model,
    theta: &[f64],
    protocol: &Protocol,
    seed: u64,
) -> Result<Simulation, InferenceError> {
    protocol.check()?;
    let done = done(model, theta, protocol)?;
    for chosen in model.effects().iter().filter(|chosen| !chosen.fixed) {
        check_needs(&chosen.effect, &done.record)?;
    }
    let rig = rig(model.muscle(), protocol, seed)?;
    let names: Vec<&str> = (0..done.data.specimens().len())
        .map(|i| model.specimens().get(i).unwrap_or(&done.data.specimens()[i]).as_str())
        .collect();
    let length = |name: &&str| model.muscle().of_specimen(name).unwrap_or(model.muscle().clone()).length();
    let lengths = names.iter().map(|name| length(name).si()).collect();
    let csv = Readings { protocol, done: &done, rig, names, lengths, seed }.csv();
    let data = Data::from_csv(&csv, "data.csv").map_err(|error| InferenceError::Protocol {
        what: format!("the simulated readings make no data: {error}"),
        instead: "check the noise of the protocol".to_owned(),
    })?;
    let truth = Truth {
        schema: "bulge.simulation/1",
        muscle: model.muscle().name().to_owned(),
        seed,
        rows: data.len(),
        sweeps: data.sweeps().len(),
        effects: hidden(model, theta),
        rig,
        ended: ended(protocol, &done),
        protocol: protocol.clone(),
    };
    Ok(Simulation { csv, data, exact: done.exact(), muscle: stated(model.muscle(), protocol), truth })
}

impl Protocol {
    /// The planned moments as far as a model with parameters `theta` pulls. Sweeps end before the
    /// contractions at which it would push or has no equilibrium; in a static map such rows are left out. The
    /// forces of the record are those of the model.
    ///
    /// # Errors
    /// If the protocol is impossible, or if the muscle pulls nowhere in it.
    pub fn moments_within(&self, model: &Model, theta: &[f64]) -> Result<Record, InferenceError> {
        self.check()?;
        Ok(done(model, theta, self)?.exact())
    }

    /// The same, and the rows of uncertain direction.
    pub(crate) fn moments_in_doubt(
        &self,
        model: &Model,
        theta: &[f64],
    ) -> Result<(Record, Vec<usize>), InferenceError> {
        self.check()?;
        let done = done(model, theta, self)?;
        let doubtful = done.data.direction_in_doubt();
        Ok((done.exact(), doubtful))
    }
}

impl Done {
    /// The rows with the model's forces. `from_moments` can't fail here: the sweeps are the record's own, and
    /// there is one force per row.
    fn exact(self) -> Record {
        let (moments, sweeps) = (self.record.moments().to_vec(), self.record.sweeps().to_vec());
        Record::from_moments(moments, self.force, sweeps).unwrap_or(self.record)
    }
}

/// The rows of a protocol that a model can do.
fn done(model: &Model, theta: &[f64], protocol: &Protocol) -> Result<Done, InferenceError> {
    let mut runs = protocol.runs();
    if !protocol.is_static() {
        // A search for an equilibrium that doesn't exist takes long, so few rows find the ends of the ranges
        // first.
        runs = pulled(model, theta, &thinned(protocol), runs)?.runs;
    }
    pulled(model, theta, protocol, runs)
}

/// The protocol with one cycle of fewer rows in the same time.
fn thinned(protocol: &Protocol) -> Protocol {
    let thin = |block: &Block| {
        let least = if let Path::Stairs { steps, .. } = block.path { 4 * steps } else { 0 };
        Block { cycles: 1, rows: block.rows.min(FEW_ROWS.max(least)), ..block.clone() }
    };
    Protocol { blocks: protocol.blocks.iter().map(thin).collect(), ..protocol.clone() }
}

/// Shortens ranges, or leaves rows out, until the muscle pulls everywhere.
fn pulled(
    model: &Model,
    theta: &[f64],
    protocol: &Protocol,
    mut runs: Vec<Run>,
) -> Result<Done, InferenceError> {
    let l0 = model.muscle().length().si();
    let mut reason = None;
    let mut kept: Vec<bool> = Vec::new();
    for _ in 0..MOST_PASSES {
        if runs.is_empty() {
            break;
        }
        let mut data = protocol.planned(&runs)?;
        if protocol.is_static() {
            kept.resize(data.len(), true);
            data = data.subset(&kept);
            if data.is_empty() {
                break;
            }
        }
        let record = Record::new(&data, l0);
        // Rows without equilibrium, or in which the muscle would push.
        let bad: Vec<usize> = match model.evaluate(&record, theta, &Wanted::default()) {
            Ok(Prediction { force, .. }) => {
                let bad: Vec<usize> = (0..force.len()).filter(|row| force[*row] <= 0.0).collect();
                if bad.is_empty() {
                    return Ok(Done { runs, kept, data, record, force });
                }
                bad
            }
            Err(error) => {
                let rows = match &error {
                    ModelError::NoEquilibrium { rows, .. } | ModelError::NotFinite { rows, .. } => {
                        rows.clone()
                    }
                    _ => return Err(InferenceError::Model { what: String::new(), source: Box::new(error) }),
                };
                reason = Some(error);
                rows
            }
        };
        // A static map can drop single rows; the runs of a path are shortened instead.
        if protocol.is_static() {
            let places: Vec<usize> = (0..kept.len()).filter(|row| kept[*row]).collect();
            for row in bad {
                kept[places[row]] = false;
            }
        } else {
            runs = shortened(&runs, &record, &bad);
        }
    }
    Err(match reason {
        Some(error) => InferenceError::Model { what: String::new(), source: Box::new(error) },
        None => InferenceError::Protocol {
            what: "the muscle pulls nowhere in the protocol".to_owned(),
            instead: "take higher pressures or smaller contractions, or check the hidden effects".to_owned(),
        },
    })
}

/// The sweeps, shortened to end before their bad rows; sweeps with nothing left are dropped.
fn shortened(runs: &[Run], record: &Record, bad: &[usize]) -> Vec<Run> {
    let mut is_bad = vec![false; record.len()];
    for row in bad {
        is_bad[*row] = true;
    }
    let one = |(run, rows): (&Run, &std::ops::Range<usize>)| {
        if !rows.clone().any(|row| is_bad[row]) {
            return Some(*run);
        }
        // A muscle pushes where it is too short or, at held length, where the pressure is too low: beyond the
        // smallest bad value of the coordinate below.
        let value = |row: usize| {
            let moment = &record.moments()[row];
            if run.is_isometric() { -moment.pressure } else { moment.contraction }
        };
        let good = || rows.clone().filter(|row| !is_bad[*row]).map(value);
        let low = good().fold(f64::INFINITY, f64::min);
        let first = rows.clone().filter(|row| is_bad[*row]).map(value).filter(|e| *e >= low);
        let first = first.fold(f64::INFINITY, f64::min);
        let high = good().filter(|e| *e < first).fold(f64::NEG_INFINITY, f64::max);
        if run.is_isometric() {
            (high - low >= LEAST_PRESSURE_RANGE * -low).then_some(Run { pressure_pa: [-high, -low], ..*run })
        } else {
            (high - low >= LEAST_RANGE).then_some(Run { contraction: [low, high], ..*run })
        }
    };
    runs.iter().zip(record.sweeps()).filter_map(one).collect()
}

/// Draws the errors of the sensors.
fn rig(muscle: &Muscle, protocol: &Protocol, seed: u64) -> Result<RigReadings, InferenceError> {
    if protocol.rig == RigErrors::None {
        return Ok(RigReadings::default());
    }
    let Instruments { force, pressure, length } = *muscle.instruments();
    let widths = [force, pressure, length].map(|i| i.map_or([0.0; 2], |i| [i.zero(), i.gain().si()]));
    if widths.iter().flatten().all(|width| *width == 0.0) {
        return Err(InferenceError::Protocol {
            what: format!("`rig = \"drawn\"` needs widths of `zero` or `gain`, and {} states none", muscle.name()),
            instead: "add such as `force = { zero = \"1 N\", gain = \"0.1 %\" }` to the `[instruments]` of the muscle".to_owned(),
        });
    }
    let mut random = Random::new(seed, RIG_STREAM);
    let [[fz, fg], [pz, pg], [lz, lg]] = widths.map(|pair| pair.map(|width| width * random.normal()));
    Ok(RigReadings {
        force_zero_n: fz,
        force_gain: fg,
        pressure_zero_pa: pz,
        pressure_gain: pg,
        length_zero_m: lz,
        length_gain: lg,
    })
}

/// Turns forces into readings.
struct Readings<'a> {
    protocol: &'a Protocol,
    done: &'a Done,
    rig: RigReadings,
    /// Names of the specimens, and their lengths \[m\].
    names: Vec<&'a str>,
    lengths: Vec<f64>,
    seed: u64,
}

impl Readings<'_> {
    fn csv(&self) -> String {
        let is_static = self.protocol.is_static();
        let several = self.done.data.specimens().len() > 1;
        let warms = self.done.data.temperature().is_some();
        let mut text = format!("# Simulated, not measured: `bulge simulate`, seed {}.\n", self.seed);
        text.push_str(if is_static { "" } else { "time [s],sweep," });
        text.push_str(if several { "specimen," } else { "" });
        text.push_str("pressure [bar],contraction [%],");
        text.push_str(if warms { "temperature [degC]," } else { "" });
        text.push_str("force [N]\n");
        for (number, sweep) in self.done.record.sweeps().iter().enumerate() {
            let forces = self.forces(number, sweep);
            let [mut pressures, mut lengths] = [PRESSURE, LENGTH].map(|kind| self.random(number, kind));
            for (row, force) in sweep.clone().zip(forces) {
                let [pressure, contraction] = self.inputs(row, [pressures.normal(), lengths.normal()]);
                if let Some(time) = self.done.data.time() {
                    let _ = write!(text, "{},{},", decimal(time[row], DECIMALS[0]), number + 1);
                }
                if several {
                    let specimen = self.done.data.specimen_of(row) as usize;
                    let _ = write!(text, "{},", self.names[specimen]);
                }
                let _ = write!(text, "{},", decimal(pressure / 1e5, DECIMALS[1]));
                let _ = write!(text, "{},", decimal(100.0 * contraction, DECIMALS[2]));
                if let Some(temperature) = self.done.data.temperature() {
                    let celsius = temperature[row] - 273.15;
                    let _ = write!(text, "{},", decimal(celsius, DECIMALS[3]));
                }
                let _ = writeln!(text, "{}", decimal(force, DECIMALS[4]));
            }
        }
        text
    }

    fn random(&self, sweep: usize, kind: u64) -> Random {
        Random::new(self.seed, STREAMS * (sweep as u64 + 1) + kind)
    }

    /// Readings of the pressure and length sensors, with standard normal noise.
    fn inputs(&self, row: usize, noise: [f64; 2]) -> [f64; 2] {
        let Protocol { noise: sd, steps, .. } = self.protocol;
        let moment = &self.done.record.moments()[row];
        let pressure = moment.pressure * (1.0 + self.rig.pressure_gain)
            + self.rig.pressure_zero_pa
            + sd.pressure_pa * noise[0];
        let l0 = self.lengths[moment.specimen as usize];
        let way = l0 * moment.contraction * (1.0 + self.rig.length_gain)
            - self.rig.length_zero_m
            - sd.length_m * noise[1];
        [stepped(pressure, steps.pressure_pa), stepped(way, steps.length_m) / l0]
    }

    /// Readings of the load cell in one sweep.
    fn forces(&self, number: usize, sweep: &std::ops::Range<usize>) -> Vec<f64> {
        let sd = &self.protocol.noise;
        let [mut white, mut correlated, mut offset] =
            [WHITE, CORRELATED, OFFSET].map(|kind| self.random(number, kind));
        let offset = sd.offset_n * offset.normal();
        let mut drift = sd.correlated_n * correlated.normal();
        let reading = |row: usize| {
            let since = self.done.record.moments()[row].since;
            if row > sweep.start && sd.correlated_n > 0.0 {
                // Exact for any time step between the rows.
                let kept = (-since / sd.correlation_time_s).exp();
                drift = kept * drift + sd.correlated_n * (1.0 - kept * kept).sqrt() * correlated.normal();
            }
            let single = match sd.tails {
                Some(tails) => white.student(tails) * ((tails - 2.0) / tails).sqrt(),
                None => white.normal(),
            };
            let exact = self.done.force[row] * (1.0 + self.rig.force_gain) + self.rig.force_zero_n;
            stepped(exact + offset + drift + sd.force_n * single, self.protocol.steps.force_n)
        };
        sweep.clone().map(reading).collect()
    }
}

/// Rounds to the nearest step.
fn stepped(value: f64, step: f64) -> f64 {
    if step > 0.0 { (value / step).round() * step } else { value }
}

/// A number with at most `decimals` decimals. The last bits, in which machines may differ, are not written.
fn decimal(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// The parts of the plan that are not in the data, each pressure (or held length) and range once.
fn ended(protocol: &Protocol, done: &Done) -> Vec<Ended> {
    let mut found: Vec<Ended> = Vec::new();
    let mut add = |run: &Run, reached: Option<[[f64; 2]; 2]>, count: usize| {
        // Twelve digits hide the rounding errors of the grid.
        let reached = reached.map(|ranges| ranges.map(|range| range.map(|value| units::rounded(value, 12))));
        let [pressures, contractions] = reached.map_or([None; 2], |ranges| ranges.map(Some));
        let ended = Ended {
            pressure_pa: run.pressure_pa[1],
            planned: run.contraction,
            reached: contractions,
            pressure_reached_pa: pressures.filter(|_| run.is_isometric()),
            count,
        };
        match found.iter_mut().find(|other| Ended { count, ..**other } == ended) {
            Some(same) => same.count += count,
            None => found.push(ended),
        }
    };
    let planned = protocol.runs();
    if protocol.is_static() {
        let mut first = 0;
        for run in &planned {
            let rows = protocol.blocks[run.block].rows;
            let is_kept = |row: &u32| done.kept.get(first + *row as usize).copied().unwrap_or(true);
            let kept: Vec<f64> = (0..rows).filter(is_kept).map(|row| run.at(protocol, row)[1]).collect();
            first += rows as usize;
            if kept.len() < rows as usize {
                let reached =
                    kept.first().zip(kept.last()).map(|(low, high)| [run.pressure_pa, [*low, *high]]);
                add(run, reached, rows as usize - kept.len());
            }
        }
        return found;
    }
    let mut left = done.runs.iter().peekable();
    for run in &planned {
        // Both lists are in the same order; the second one lacks the sweeps with nothing left.
        match left.next_if(|other| other.is_part_of(run)) {
            Some(other) if other == run => {}
            other => add(run, other.map(|other| [other.pressure_pa, other.contraction]), 1),
        }
    }
    found
}

/// The muscle with the noise of one reading in its `[instruments]`, if the protocol states one:
///
/// ```text
/// sd^2 = white^2 + correlated^2 + step^2/12
/// ```
fn stated(muscle: &Muscle, protocol: &Protocol) -> Muscle {
    let Protocol { noise, steps, .. } = protocol;
    let Instruments { force, pressure, length } = *muscle.instruments();
    let one = |known: Option<Instrument>, white: f64, correlated: f64, step: f64| {
        let sd = (white * white + correlated * correlated + step * step / 12.0).sqrt();
        let (zero, gain) = known.map_or((0.0, None), |known| (known.zero(), Some(known.gain())));
        let gain = gain.unwrap_or(Ratio::one(0.0));
        // Four digits: a number in a file should not pretend to be exact.
        let sd = units::rounded(sd, 4);
        if sd > 0.0 { Instrument::new(sd, zero, gain).ok() } else { known }
    };
    muscle.clone().with_instruments(Instruments {
        force: one(force, noise.force_n, noise.correlated_n, steps.force_n),
        pressure: one(pressure, noise.pressure_pa, 0.0, steps.pressure_pa),
        length: one(length, noise.length_m, 0.0, steps.length_m),
    })
}
