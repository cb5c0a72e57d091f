//! What a test bench does and how it reads: pressures, motion, cycles, repeats, noise; prepared for models
//! before anything is measured.

use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

use bulge_muscles::Muscle;

use crate::error::InferenceError;
use crate::vector::range;

/// Most rows of a protocol.
pub const MOST_ROWS: usize = 1_000_000;
/// Most pressures of a block; also most cycles, repeats, specimens and steps of a staircase.
const MOST_COUNT: u32 = 10_000;
/// Contractions that a bench can set.
const CONTRACTIONS: RangeInclusive<f64> = -1.0..=0.6;
/// Highest gauge pressure \[Pa\].
const MOST_PRESSURE: f64 = 1e8;
/// Longest period, hold and pause \[s\].
const MOST_TIME: f64 = 1e7;
/// Largest noise, in the SI unit of what is read, and most warming \[K\].
const MOST_NOISE: f64 = 1e7;
const MOST_WARMING: f64 = 200.0;
/// Fewest degrees of freedom of Student's t, with some margin: its standard deviation is finite above 2.
const LEAST_TAILS: f64 = 2.1;

/// A test: a sequence of blocks, and how the rig reads. All numbers are SI.
///
/// ```
/// use bulge_inference::{Block, Protocol};
///
/// // Three triangular loops from 1 % to 15 % at each of two pressures.
/// let block = Block { cycles: 3, ..Block::loops(vec![2e5, 4e5], [0.01, 0.15], 50.0) };
/// let record = Protocol::new(vec![block]).moments(&bulge_muscles::preset("ppam-2-r16").unwrap())?;
/// assert_eq!((record.len(), record.sweeps().len(), record.moments()[10].direction), (300, 2, 1.0));
/// # Ok::<(), bulge_inference::InferenceError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Protocol {
    /// The blocks in the order of the test. Either all of them are static maps, or none is.
    pub blocks: Vec<Block>,
    /// Noise of the readings.
    pub noise: ReadingNoise,
    /// Resolution of the sensors.
    pub steps: ReadingSteps,
    /// Zero and gain errors of the sensors.
    pub rig: RigErrors,
    /// Pause between sweeps \[s\]; the time of one row if that is longer.
    pub pause_s: f64,
    /// Rise of the temperature over the whole test \[K\], linear in time. With 0 there is no temperature
    /// column.
    pub warming_k: f64,
}

/// The same motion at several pressures, or the same filling and venting at several lengths.
///
/// Each specimen goes through all repeats, and each repeat through all pressures (or lengths). Each of these
/// runs is one sweep.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Block {
    /// Gauge pressures \[Pa\], > 0. At held lengths, the lowest and the highest of them are the range.
    pub pressures_pa: Vec<f64>,
    /// Lowest and highest contraction; at held lengths the range of [`Block::held`].
    pub contraction: [f64; 2],
    /// Contractions that are held one after the other while the pressure rises and falls; empty if the
    /// pressures are held.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub held: Vec<f64>,
    /// How length or pressure moves between the ends of its range.
    pub path: Path,
    /// Cycles of each sweep; ignored in a static map.
    pub cycles: u32,
    /// Time of one cycle \[s\]; ignored in a static map.
    pub period_s: f64,
    /// Rows of one cycle, or contractions of a static map at each pressure.
    pub rows: u32,
    /// How often the whole block is repeated.
    pub repeats: u32,
    /// Number of specimens, named 1, 2, and so on.
    pub specimens: u32,
}

/// Motion of a muscle over time.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Path {
    /// Up and down at constant speed.
    Triangle,
    /// Up and down as a sine.
    Sine,
    /// Up and down in steps of equal size, with a hold on each level.
    Stairs {
        /// Steps up; as many go down.
        steps: u32,
        /// Hold time on each level \[s\].
        hold_s: f64,
    },
    /// A grid of single readings, without time.
    Static,
}

/// Noise of single readings, one standard deviation each.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReadingNoise {
    /// White noise of the force \[N\].
    pub force_n: f64,
    /// Degrees of freedom of Student's t if the white noise of the force has heavy tails; its standard
    /// deviation stays the same.
    pub tails: Option<f64>,
    /// Noise of the force that is exponentially correlated in time within a sweep \[N\].
    pub correlated_n: f64,
    /// Correlation time of the correlated noise \[s\].
    pub correlation_time_s: f64,
    /// Standard deviation of the force's offset from sweep to sweep \[N\].
    pub offset_n: f64,
    /// Noise of the pressure \[Pa\].
    pub pressure_pa: f64,
    /// Noise of the length \[m\].
    pub length_m: f64,
}

/// Resolutions of the sensors; 0 means no rounding.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReadingSteps {
    /// Resolution of the force \[N\].
    pub force_n: f64,
    /// Resolution of the pressure \[Pa\].
    pub pressure_pa: f64,
    /// Resolution of the length \[m\].
    pub length_m: f64,
}

/// Zero and gain errors of the sensors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RigErrors {
    /// None.
    #[default]
    None,
    /// Drawn, by the seed, from the widths of the muscle's `[instruments]`.
    Drawn,
}

/// An invalid number: its key in a file, a sentence, and what to write.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Wrong {
    pub(crate) key: &'static str,
    pub(crate) what: String,
    pub(crate) instead: String,
}

impl Block {
    /// One triangular loop of 50 rows at each pressure \[Pa\], between two contractions, in `period_s` \[s\].
    #[must_use]
    pub fn loops(pressures_pa: Vec<f64>, contraction: [f64; 2], period_s: f64) -> Self {
        Self {
            pressures_pa,
            contraction,
            held: Vec::new(),
            path: Path::Triangle,
            cycles: 1,
            period_s,
            rows: 50,
            repeats: 1,
            specimens: 1,
        }
    }

    /// A static map with `rows` contractions at each pressure \[Pa\].
    #[must_use]
    pub fn map(pressures_pa: Vec<f64>, contraction: [f64; 2], rows: u32) -> Self {
        Self { path: Path::Static, rows, ..Self::loops(pressures_pa, contraction, 0.0) }
    }

    /// One filling and venting of 50 rows at each of the contractions `held`, between two pressures \[Pa\],
    /// in `period_s` \[s\].
    #[must_use]
    pub fn isometric(pressure_pa: [f64; 2], held: Vec<f64>, period_s: f64) -> Self {
        let ends = range(held.iter().copied());
        Self { held, ..Self::loops(pressure_pa.to_vec(), ends, period_s) }
    }

    /// Ranges of pressure \[Pa\] and contraction of each sweep in one repeat. The quantity that is held has
    /// twice the same value.
    pub(crate) fn sweeps(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
        let isobaric = self.pressures_pa.iter().map(|p| ([*p; 2], self.contraction));
        let range = self.pressure_range();
        let isometric = self.held.iter().map(move |e| (range, [*e; 2]));
        isobaric.take(if self.held.is_empty() { usize::MAX } else { 0 }).chain(isometric)
    }

    pub(crate) fn pressure_range(&self) -> [f64; 2] {
        range(self.pressures_pa.iter().copied())
    }

    /// Rows of one sweep.
    fn rows_of_sweep(&self) -> u64 {
        u64::from(self.rows) * u64::from(if self.path == Path::Static { 1 } else { self.cycles })
    }

    /// Rows of the whole block.
    #[must_use]
    pub fn len(&self) -> u64 {
        let levels = if self.held.is_empty() { self.pressures_pa.len() } else { self.held.len() };
        let sweeps =
            (levels as u64).saturating_mul(u64::from(self.repeats)).saturating_mul(u64::from(self.specimens));
        self.rows_of_sweep().saturating_mul(sweeps)
    }

    /// Whether the block has no row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(crate) fn check(&self) -> Result<(), Wrong> {
        let pressures = self.pressures_pa.len();
        Wrong::unless(
            (1..=MOST_COUNT as usize).contains(&pressures),
            "pressures",
            format_args!("there are {pressures} pressures, but 1 to {MOST_COUNT} are possible"),
            "write such as `pressures = [\"2 bar\", \"3 bar\"]`",
        )?;
        for pressure in &self.pressures_pa {
            Wrong::unless(
                *pressure > 0.0 && *pressure <= MOST_PRESSURE,
                "pressures",
                format_args!(
                    "a pressure of {pressure} Pa is not possible: gauge pressures lie above 0 and up to 1000 bar"
                ),
                "write such as \"2 bar\"",
            )?;
        }
        self.check_held()?;
        let [low, high] = self.contraction;
        let rises = low < high || !self.held.is_empty();
        Wrong::unless(
            CONTRACTIONS.contains(&low) && CONTRACTIONS.contains(&high) && rises,
            "contraction",
            format_args!(
                "a contraction from {:.4} % to {:.4} % is not possible: it must rise, within -100 % and 60 %",
                100.0 * low,
                100.0 * high
            ),
            "write such as `contraction = \"1 %..20 %\"`",
        )?;
        count("rows", self.rows, 2, "rows = 50")?;
        count("repeats", self.repeats, 1, "repeats = 2")?;
        count("specimens", self.specimens, 1, "specimens = 3")?;
        if self.path == Path::Static {
            return Ok(());
        }
        count("rows", self.rows, 4, "rows = 50")?;
        count("cycles", self.cycles, 1, "cycles = 3")?;
        Wrong::unless(
            self.period_s > 0.0 && self.period_s <= MOST_TIME,
            "period",
            format_args!(
                "a period of {} s is not possible: it must be > 0 s and at most 1e7 s",
                self.period_s
            ),
            "write such as `period = \"50 s\"`",
        )?;
        self.check_stairs()
    }

    fn check_held(&self) -> Result<(), Wrong> {
        if self.held.is_empty() {
            return Ok(());
        }
        let held = self.held.len();
        Wrong::unless(
            held <= MOST_COUNT as usize && self.held.iter().all(|e| CONTRACTIONS.contains(e)),
            "contractions",
            format_args!(
                "{held} contractions are held, and 1 to {MOST_COUNT} within -100 % and 60 % are possible"
            ),
            "write such as `contractions = [\"2 %\", \"10 %\"]`",
        )?;
        let [low, high] = self.pressure_range();
        Wrong::unless(
            low < high,
            "pressure",
            format_args!("the pressure goes from {low} to {high} Pa, but must change at held length"),
            "write such as `pressure = \"1 bar..6 bar\"`",
        )
    }

    fn check_stairs(&self) -> Result<(), Wrong> {
        let Path::Stairs { steps, hold_s } = self.path else { return Ok(()) };
        count("steps", steps, 1, "steps = 8")?;
        let (all, period_s) = (2 * steps, self.period_s);
        let stage = period_s / f64::from(all);
        Wrong::unless(
            hold_s >= 0.0 && hold_s < stage,
            "hold",
            format_args!(
                "a hold of {hold_s} s is not possible: a period of {period_s} s leaves {stage} s for each of {all} steps, and the way takes some of it"
            ),
            "write a shorter `hold`, or a longer `period`",
        )?;
        Wrong::unless(
            u64::from(self.rows) >= 4 * u64::from(steps),
            "rows",
            format_args!("{} rows are too few for {all} steps: each needs two or more", self.rows),
            &format!("write `rows = {}` or more", 4 * steps),
        )
    }
}

fn count(key: &'static str, value: u32, least: u32, example: &str) -> Result<(), Wrong> {
    Wrong::unless(
        (least..=MOST_COUNT).contains(&value),
        key,
        format_args!("`{key}` is {value}, but must be a whole number from {least} to {MOST_COUNT}"),
        &format!("write such as `{example}`"),
    )
}

impl ReadingNoise {
    pub(crate) fn check(&self, is_static: bool) -> Result<(), Wrong> {
        let sizes = [
            ("force", self.force_n, "2 N"),
            ("correlated", self.correlated_n, "1 N"),
            ("offset", self.offset_n, "1 N"),
            ("pressure", self.pressure_pa, "100 Pa"),
            ("length", self.length_m, "20 um"),
        ];
        for (key, value, example) in sizes {
            size(key, value, "a standard deviation", example)?;
        }
        let tails = self.tails.unwrap_or(LEAST_TAILS);
        Wrong::unless(
            (LEAST_TAILS..=1e6).contains(&tails),
            "tails",
            format_args!(
                "`tails` is {tails}, but must be from {LEAST_TAILS} to 1e6: the degrees of freedom of Student's t"
            ),
            "write such as `tails = 4`, or leave it out for normal noise",
        )?;
        let (is_correlated, time) = (self.correlated_n > 0.0, self.correlation_time_s);
        Wrong::unless(
            !(is_correlated && is_static),
            "correlated",
            format_args!("`correlated` noise needs time, and a static map has none"),
            "leave it out",
        )?;
        Wrong::unless(
            !is_correlated || time > 0.0 && time <= MOST_TIME,
            "correlation_time",
            format_args!(
                "a correlation time of {time} s is not possible: `correlated` noise needs one > 0 s"
            ),
            "write such as `correlation_time = \"5 s\"`",
        )
    }
}

impl ReadingSteps {
    pub(crate) fn check(&self) -> Result<(), Wrong> {
        size("force", self.force_n, "a step", "0.1 N")?;
        size("pressure", self.pressure_pa, "a step", "10 Pa")?;
        size("length", self.length_m, "a step", "10 um")
    }
}

fn size(key: &'static str, value: f64, name: &str, example: &str) -> Result<(), Wrong> {
    Wrong::unless(
        (0.0..=MOST_NOISE).contains(&value),
        key,
        format_args!("`{key}` is {value} in SI units: {name} lies between 0 and 1e7"),
        &format!("write such as `{key} = \"{example}\"`, or leave it out"),
    )
}

impl Protocol {
    /// Blocks without noise, rig errors or warming, with 10 s between sweeps.
    #[must_use]
    pub fn new(blocks: Vec<Block>) -> Self {
        Self {
            blocks,
            noise: ReadingNoise::default(),
            steps: ReadingSteps::default(),
            rig: RigErrors::None,
            pause_s: 10.0,
            warming_k: 0.0,
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> u64 {
        self.blocks.iter().fold(0, |all, block| all.saturating_add(block.len()))
    }

    /// Whether the protocol has no row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether the protocol is a static map, without time.
    #[must_use]
    pub fn is_static(&self) -> bool {
        self.blocks.first().is_some_and(|block| block.path == Path::Static)
    }

    /// Names of the specimens.
    #[must_use]
    pub fn specimens(&self) -> Vec<String> {
        let count = self.blocks.iter().map(|block| block.specimens).max().unwrap_or(1);
        (1..=count).map(|specimen| specimen.to_string()).collect()
    }

    /// The muscle to try and the names of its specimens. The muscle's own specimens are used if there are as
    /// many as in the protocol. A protocol with one specimen takes the muscle as stated.
    ///
    /// # Errors
    /// If the muscle states another number of specimens.
    pub(crate) fn specimens_of(&self, muscle: &Muscle) -> Result<(Muscle, Vec<String>), InferenceError> {
        let (own, stated) = (self.specimens(), muscle.specimens());
        if own.len() == 1 || stated.is_empty() {
            return Ok((muscle.clone().without_specimens(), own));
        }
        if own.len() == stated.len() {
            return Ok((muscle.clone(), stated.iter().map(|specimen| specimen.name().to_owned()).collect()));
        }
        let count = stated.len();
        Err(InferenceError::Protocol {
            what: format!("the protocol has {} specimens, but {} states {count}", own.len(), muscle.name()),
            instead: format!("write `specimens = {count}`, or 1 for the muscle as stated"),
        })
    }

    /// Checks a protocol that a program built, as a file would be checked.
    pub(crate) fn check(&self) -> Result<(), InferenceError> {
        for (i, block) in self.blocks.iter().enumerate() {
            block.check().map_err(|wrong| wrong.of(&format!("block {}", i + 1)))?;
        }
        self.noise.check(self.is_static()).map_err(|wrong| wrong.of("noise"))?;
        self.steps.check().map_err(|wrong| wrong.of("sampling"))?;
        self.check_whole().map_err(|wrong| wrong.of("protocol"))
    }

    /// Checks what concerns no single table.
    pub(crate) fn check_whole(&self) -> Result<(), Wrong> {
        Wrong::unless(
            !self.blocks.is_empty(),
            "block",
            format_args!("a protocol needs a block"),
            "write such as `[[block]]`",
        )?;
        Wrong::unless(
            self.blocks.iter().all(|block| (block.path == Path::Static) == self.is_static()),
            "block",
            format_args!("a static map has no time, the other blocks have: they don't fit into one file"),
            "write two protocols",
        )?;
        Wrong::unless(
            self.len() <= MOST_ROWS as u64,
            "block",
            format_args!("the protocol has {} rows, and {MOST_ROWS} are the most", self.len()),
            "take fewer `rows`, `cycles`, `repeats` or `specimens`, or a longer `interval`",
        )?;
        Wrong::unless(
            (0.0..=MOST_TIME).contains(&self.pause_s),
            "pause",
            format_args!("a pause of {} s is not possible: it lies between 0 s and 1e7 s", self.pause_s),
            "write such as `pause = \"10 s\"`",
        )?;
        Wrong::unless(
            self.warming_k.abs() <= MOST_WARMING,
            "warming",
            format_args!("a warming by {} K is not possible: at most {MOST_WARMING} K are", self.warming_k),
            "write such as `warming = \"10 K\"`",
        )
    }
}

impl Wrong {
    fn unless(
        is_fine: bool,
        key: &'static str,
        what: std::fmt::Arguments<'_>,
        instead: &str,
    ) -> Result<(), Self> {
        if is_fine { Ok(()) } else { Err(Self { key, what: what.to_string(), instead: instead.to_owned() }) }
    }

    fn of(self, place: &str) -> InferenceError {
        InferenceError::Protocol { what: format!("{place}: {}", self.what), instead: self.instead }
    }
}
