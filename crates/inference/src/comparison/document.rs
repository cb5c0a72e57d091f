//! A comparison as a value: everything that text, JSON and report show, and nothing that they would have to compute.

use bulge_measurements::{Finding, Reading, SweepKind};
use serde::Serialize;

use crate::fit::document::Fit;
use crate::fit::held::HeldNumber;

/// Model against measurement, from the base law to the last effect added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// `bulge.comparison/1`.
    pub schema: &'static str,
    /// Name of the muscle.
    pub muscle: String,
    /// What the base is: `equilibrium`, or the name of a force law.
    pub base: String,
    /// What was measured.
    pub data: DataSummary,
    /// What the quality gate found.
    pub quality: Vec<Finding>,
    /// The error that no model can go below.
    pub noise_floor: Option<NoiseFloor>,
    /// The ladder of errors: the base first, then one rung for each effect added.
    pub ladder: Vec<Rung>,
    /// Error by pressure, contraction, direction, rate, sweep, specimen and time, as far as each varies.
    pub by: Vec<Breakdown>,
    /// Mean and half-gap of the loops.
    pub loops: Vec<LoopGap>,
    /// Error in contraction under held loads, one for each isotonic sweep.
    pub isotonic: Vec<HeldLoad>,
    /// Residuals over pressure and contraction, one map for each direction.
    pub maps: Vec<ResidualMap>,
    /// Force against contraction, one for each pressure level (and specimen).
    pub curves: Vec<Curve>,
    /// What each effect contributes to the force, one for each pressure level.
    pub contributions: Vec<Stack>,
    /// Measured force, force of the first rung, force of the last \[N\]: at most 2000 rows.
    pub scatter: Vec<[f64; 3]>,
    /// Force laws of the papers on the same data, where asked for.
    pub rivals: Vec<Rival>,
    /// What a reader should know before trusting the numbers.
    pub warnings: Vec<String>,
}

/// What was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DataSummary {
    /// Rows in the files.
    pub rows: usize,
    /// Rows that enter errors and fits.
    pub used: usize,
    /// Rows that don't, and why.
    pub left_out: Vec<LeftOut>,
    /// Units, signs and scales that can't be true, with the evidence.
    pub findings: Vec<Mismatch>,
    /// What the columns were taken for, and the rows that can't be used.
    #[serde(flatten)]
    pub reading: Reading,
    /// SHA-256 of the file, or of the digests of several.
    pub sha256: String,
    /// Names of the files.
    pub files: Vec<String>,
    /// Number of sweeps.
    pub sweeps: usize,
    /// What each sweep does.
    pub sweep_kinds: Vec<SweepKind>,
    /// What the two branches of a loop are called: shortening and lengthening, or filling and venting where only the pressure goes to and fro.
    pub branches: [&'static str; 2],
    /// Names of the specimens.
    pub specimens: Vec<String>,
    /// Whether the rows are a path, or a static map.
    pub is_path: bool,
    /// Least and largest pressure \[Pa\].
    pub pressure_pa: [f64; 2],
    /// Least and largest contraction.
    pub contraction: [f64; 2],
    /// Least and largest force \[N\].
    pub force_n: [f64; 2],
    /// Largest force that was measured \[N\]: errors are given in per cent of it.
    pub full_scale_n: f64,
}

/// Data and muscle that don't go together, and by what they would.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mismatch {
    /// What it is about: `absolute-pressure`, `pressure-unit`, `force-unit`, `force-sign`, `contraction-unit`, `displacement`, `length`, `time-unit`,
    /// `scale`, `pushes`.
    pub kind: &'static str,
    /// Whether the readings are those of another unit or sign beyond doubt: no physics can be learnt from them as they stand.
    pub decided: bool,
    /// RMS error of the muscle as stated \[N\], with the readings as they stand.
    pub rmse_n: f64,
    /// The same with the readings as they are meant, where something else would fit.
    pub meant_rmse_n: Option<f64>,
    /// What is seen, with numbers, and the question.
    pub says: String,
    /// What to write instead.
    pub instead: String,
}

impl std::fmt::Display for Mismatch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let stop = if self.says.ends_with('?') { "" } else { ":" };
        write!(f, "{}{stop} {}", self.says, self.instead)
    }
}

/// Rows that were left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOut {
    /// Why.
    pub why: String,
    /// Line numbers, as ranges: `12, 33-40`.
    pub lines: String,
    /// How many.
    pub rows: usize,
}

/// The scatter of the measurement itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseFloor {
    /// Standard deviation \[N\].
    pub sd_n: f64,
    /// `repeats`, `saturated` or `instruments`.
    pub source: &'static str,
    /// How it was found, in a sentence.
    pub says: String,
}

/// One rung of the ladder.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Rung {
    /// The effect added; none for the base.
    pub added: Option<String>,
    /// Its title.
    pub title: String,
    /// RMS error of the rows that have a state \[N\].
    pub rmse_n: f64,
    /// The same without the rows whose direction is in doubt and which therefore count less; none where that is no smaller.
    pub directed_rmse_n: Option<f64>,
    /// The same in per cent of full scale.
    pub rmse_percent: f64,
    /// Mean error, measured - model \[N\].
    pub bias_n: f64,
    /// Largest error \[N\].
    pub largest_n: f64,
    /// RMS error on what was left out of the fit \[N\]: whole pressures, sweeps or specimens in turn.
    pub held_out_rmse_n: Option<f64>,
    /// What was left out in turn: `pressure`, `length`, `load`, `sweep`, `specimen`.
    pub held_out_by: Option<&'static str>,
    /// Coefficient of determination 1 - SS_error/SS_total.
    pub r_squared: f64,
    /// Number of numbers fitted.
    pub fitted: usize,
    /// RMS error of half the gap between lengthening and shortening \[N\], where there are loops.
    pub half_gap_rmse_n: Option<f64>,
    /// The fit, where something was fitted.
    pub fit: Option<Fit>,
    /// Numbers that were held at a value or tied to another one.
    pub held: Vec<HeldNumber>,
    /// Rows of which this model says nothing: they have no state with its numbers, and aren't in its errors.
    pub without_state: Option<LeftOut>,
}

/// The error by one variable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Breakdown {
    /// `pressure`, `contraction`, `direction`, `rate`, `sweep`, `specimen`, `time`.
    pub variable: &'static str,
    /// Unit of the bins, for people.
    pub unit: &'static str,
    /// In order.
    pub bins: Vec<Bin>,
}

/// Rows with about the same value of a variable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bin {
    /// What to call it.
    pub label: String,
    /// Middle of the bin, in the breakdown's unit (the number of the sweep, specimen ... where it has none).
    pub at: f64,
    /// How many.
    pub rows: usize,
    /// Mean error of the first and the last rung, measured - model \[N\].
    pub bias_n: [f64; 2],
    /// RMS error of the first and the last rung \[N\].
    pub rmse_n: [f64; 2],
}

/// Loops at one pressure level: half of the sum and half of the difference of the lengthening and the shortening branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoopGap {
    /// Mean pressure \[Pa\].
    pub pressure_pa: f64,
    /// The specimen.
    pub specimen: String,
    /// Mean contractions of the readings that were taken together.
    pub contraction: Vec<f64>,
    /// Mean of both branches, measured \[N\].
    pub mean_measured_n: Vec<f64>,
    /// The same of the first and the last rung.
    pub mean_model_n: [Vec<f64>; 2],
    /// (lengthening - shortening)/2, measured \[N\].
    pub half_gap_measured_n: Vec<f64>,
    /// The same of the first and the last rung.
    pub half_gap_model_n: [Vec<f64>; 2],
}

/// A sweep under a held load: the contraction that was read, and those at which models bear the load, to first order in the error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HeldLoad {
    /// The sweep.
    pub sweep: String,
    /// The specimen.
    pub specimen: String,
    /// Mean load \[N\].
    pub load_n: f64,
    /// RMS error of the contraction of the first and the last rung.
    pub rmse_contraction: [f64; 2],
    /// In the order of measurement: at most 400.
    pub points: Vec<HeldLoadPoint>,
}

/// One row of a sweep under a held load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HeldLoadPoint {
    /// Pressure as read \[Pa\].
    pub pressure_pa: f64,
    /// Contraction as read.
    pub contraction: f64,
    /// +1 shortening, -1 lengthening, 0 at rest.
    pub direction: f64,
    /// Contraction of the first rung.
    pub first: f64,
    /// Contraction of the last rung.
    pub last: f64,
}

/// Mean residuals (measured - model) on a grid of pressure and contraction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResidualMap {
    /// Name of a branch (see [`DataSummary::branches`]), or `at rest`.
    pub direction: &'static str,
    /// Middle of the rows of the grid \[Pa\].
    pub pressure_pa: Vec<f64>,
    /// Middle of its columns.
    pub contraction: Vec<f64>,
    /// Of the first rung, row by row \[N\]; none where nothing was measured.
    pub first_n: Vec<Option<f64>>,
    /// Of the last rung.
    pub last_n: Vec<Option<f64>>,
}

/// Force against contraction at one pressure level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// Mean pressure \[Pa\].
    pub pressure_pa: f64,
    /// The specimen.
    pub specimen: String,
    /// In the order of measurement (by contraction in a static map): at most 400.
    pub points: Vec<CurvePoint>,
}

/// One row of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Gauge pressure as read \[Pa\].
    pub pressure_pa: f64,
    /// Contraction as read.
    pub contraction: f64,
    /// +1 shortening, -1 lengthening, 0 at rest; at held length that of the pressure.
    pub direction: f64,
    /// Measured \[N\].
    pub measured_n: f64,
    /// Of the first rung \[N\].
    pub first_n: f64,
    /// Of the last rung \[N\].
    pub last_n: f64,
}

/// What the effects contribute at one pressure level, averaged over both directions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stack {
    /// Mean pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contractions.
    pub contraction: Vec<f64>,
    /// Measured \[N\].
    pub measured_n: Vec<f64>,
    /// The base without effects \[N\].
    pub base_n: Vec<f64>,
    /// Each effect with what it adds to the force of all before it \[N\].
    pub parts: Vec<Part>,
}

/// The contribution of one effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// The effect.
    pub effect: String,
    /// What it adds, by contraction \[N\].
    pub force_n: Vec<f64>,
}

/// A force law of the papers, fitted to the same data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rival {
    /// Name of the law.
    pub law: String,
    /// Its title.
    pub title: String,
    /// RMS error with the printed coefficients \[N\], where there are any for this muscle.
    pub printed_rmse_n: Option<f64>,
    /// RMS error fitted \[N\].
    pub rmse_n: f64,
    /// In per cent of full scale.
    pub rmse_percent: f64,
    /// On what was left out of the fit.
    pub held_out_rmse_n: Option<f64>,
    /// How many numbers were fitted.
    pub fitted: usize,
    /// Why not, where it wasn't possible.
    pub failed: Option<String>,
}
