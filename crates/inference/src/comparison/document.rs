//! The result of a comparison: everything that text, JSON and report show, so that they compute nothing.

use bulge_measurements::{Finding, Reading, SweepKind};
use serde::Serialize;

use crate::fit::document::Fit;
use crate::fit::held::HeldNumber;

/// The comparison of a model with measurements, from the base to the last effect added.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Comparison {
    /// Name and version of the document: `bulge.comparison/1`.
    pub schema: &'static str,
    /// Name of the muscle.
    pub muscle: String,
    /// The base: `equilibrium`, or the name of a force law.
    pub base: String,
    /// Summary of the data.
    pub data: DataSummary,
    /// Findings of the quality check.
    pub quality: Vec<Finding>,
    /// The error that no model can go below.
    pub noise_floor: Option<NoiseFloor>,
    /// The ladder of errors: the base first, then one rung for each effect added.
    pub ladder: Vec<Rung>,
    /// Error by pressure, contraction, direction, rate, sweep, specimen and time, for those that vary.
    pub by: Vec<Breakdown>,
    /// Mean and half-gap of the loops.
    pub loops: Vec<LoopGap>,
    /// Error in contraction under held loads, one for each isotonic sweep.
    pub isotonic: Vec<HeldLoad>,
    /// Residuals over pressure and contraction, one map for each direction.
    pub maps: Vec<ResidualMap>,
    /// Force against contraction, one for each pressure level (and specimen).
    pub curves: Vec<Curve>,
    /// Contribution of each effect to the force, one stack for each pressure level.
    pub contributions: Vec<Stack>,
    /// Measured force, force of the first rung, and force of the last rung \[N\]: at most 2000 rows.
    pub scatter: Vec<[f64; 3]>,
    /// Published force laws on the same data, if requested.
    pub rivals: Vec<Rival>,
    /// What a reader should know before trusting the numbers.
    pub warnings: Vec<String>,
}

/// Summary of the data.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct DataSummary {
    /// Rows in the files.
    pub rows: usize,
    /// Rows that enter errors and fits.
    pub used: usize,
    /// Rows that don't, with the reasons.
    pub left_out: Vec<LeftOut>,
    /// Units, signs and scales that are impossible, with the evidence.
    pub findings: Vec<Mismatch>,
    /// How the columns were interpreted, and the rows that can't be used.
    #[serde(flatten)]
    pub reading: Reading,
    /// SHA-256 of the file, or of the digests of several files.
    pub sha256: String,
    /// Names of the files.
    pub files: Vec<String>,
    /// Number of sweeps.
    pub sweeps: usize,
    /// Kind of each sweep.
    pub sweep_kinds: Vec<SweepKind>,
    /// Names of the two branches of a loop: shortening and lengthening, or filling and venting if only the
    /// pressure moves.
    pub branches: [&'static str; 2],
    /// Names of the specimens.
    pub specimens: Vec<String>,
    /// Whether the rows are a path; otherwise they are a static map.
    pub is_path: bool,
    /// Least and largest pressure \[Pa\].
    pub pressure_pa: [f64; 2],
    /// Least and largest contraction.
    pub contraction: [f64; 2],
    /// Least and largest force \[N\].
    pub force_n: [f64; 2],
    /// Largest measured force \[N\]; errors are given in per cent of it.
    pub full_scale_n: f64,
}

/// A contradiction between data and muscle, with the change that would resolve it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mismatch {
    /// What it is about: `absolute-pressure`, `pressure-unit`, `force-unit`, `force-sign`,
    /// `contraction-unit`, `displacement`, `length`, `time-unit`, `muscle-length`, `scale`, `pushes`, `no-force`.
    pub kind: &'static str,
    /// Whether the readings have another unit or sign beyond doubt. Nothing can be learnt about the muscle
    /// from them as they stand.
    pub decided: bool,
    /// RMS error of the muscle as stated \[N\], with the readings as they stand.
    pub rmse_n: f64,
    /// The same with the readings as they are probably meant, if another meaning fits.
    pub meant_rmse_n: Option<f64>,
    /// The evidence, with numbers, and the question.
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
    /// The reason.
    pub why: String,
    /// Line numbers, as ranges: `12, 33-40`.
    pub lines: String,
    /// Number of rows.
    pub rows: usize,
}

/// The noise level of the measurement itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseFloor {
    /// Standard deviation \[N\].
    pub sd_n: f64,
    /// Origin: `repeats`, `saturated` or `instruments`.
    pub source: &'static str,
    /// How it was estimated, in a sentence.
    pub says: String,
}

/// One rung of the ladder.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Rung {
    /// The added effect; none for the base.
    pub added: Option<String>,
    /// Title of the rung.
    pub title: String,
    /// RMS error over the rows that have a state \[N\].
    pub rmse_n: f64,
    /// The same without the rows of uncertain direction, which have smaller weights; none if it is hardly
    /// smaller.
    pub directed_rmse_n: Option<f64>,
    /// RMS error in per cent of full scale.
    pub rmse_percent: f64,
    /// Mean error, measured - model \[N\].
    pub bias_n: f64,
    /// Largest absolute error \[N\].
    pub largest_n: f64,
    /// RMS error on data left out of the fit \[N\]: whole pressures, lengths, loads, sweeps or specimens in
    /// turn.
    pub held_out_rmse_n: Option<f64>,
    /// What was left out in turn: `pressure`, `length`, `load`, `sweep`, `specimen`.
    pub held_out_by: Option<&'static str>,
    /// Coefficient of determination 1 - SS_error/SS_total.
    pub r_squared: f64,
    /// Number of fitted parameters.
    pub fitted: usize,
    /// RMS error of half the gap between lengthening and shortening \[N\], if there are loops.
    pub half_gap_rmse_n: Option<f64>,
    /// The fit, if there were free parameters.
    pub fit: Option<Fit>,
    /// Parameters that were held at a value or tied to another one.
    pub held: Vec<HeldNumber>,
    /// Rows that have no state with the parameters of this model; they are left out of its errors.
    pub without_state: Option<LeftOut>,
}

/// The error by one variable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Breakdown {
    /// `pressure`, `contraction`, `direction`, `rate`, `sweep`, `specimen`, `time`.
    pub variable: &'static str,
    /// Unit of the bins, as shown.
    pub unit: &'static str,
    /// Bins in ascending order.
    pub bins: Vec<Bin>,
}

/// Rows with about the same value of a variable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bin {
    /// Label.
    pub label: String,
    /// Middle of the bin, in the breakdown's unit; the number of the sweep, specimen etc. if there is no
    /// unit.
    pub at: f64,
    /// Number of rows.
    pub rows: usize,
    /// Mean error of the first and the last rung, measured - model \[N\].
    pub bias_n: [f64; 2],
    /// RMS error of the first and the last rung \[N\].
    pub rmse_n: [f64; 2],
}

/// Loops at one pressure level: half the sum and half the difference of the lengthening and the shortening
/// branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoopGap {
    /// Mean pressure \[Pa\].
    pub pressure_pa: f64,
    /// The specimen.
    pub specimen: String,
    /// Mean contractions of the readings in each bin.
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

/// A sweep under a held load: the contractions that were read, and those at which the models bear the load,
/// to first order in the error.
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
    /// Points in the order of measurement: at most 400.
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
    /// Mean residuals of the first rung, row by row \[N\]; none in cells without measurements.
    pub first_n: Vec<Option<f64>>,
    /// Mean residuals of the last rung \[N\].
    pub last_n: Vec<Option<f64>>,
}

/// Force against contraction at one pressure level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// Mean pressure \[Pa\].
    pub pressure_pa: f64,
    /// The specimen.
    pub specimen: String,
    /// Points in the order of measurement (by contraction in a static map): at most 400.
    pub points: Vec<CurvePoint>,
}

/// One row of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Gauge pressure as read \[Pa\].
    pub pressure_pa: f64,
    /// Contraction as read.
    pub contraction: f64,
    /// +1 shortening, -1 lengthening, 0 at rest; at held length the direction of the pressure.
    pub direction: f64,
    /// Measured force \[N\].
    pub measured_n: f64,
    /// Force of the first rung \[N\].
    pub first_n: f64,
    /// Force of the last rung \[N\].
    pub last_n: f64,
}

/// Contributions of the effects at one pressure level, averaged over both directions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stack {
    /// Mean pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contractions.
    pub contraction: Vec<f64>,
    /// Measured force \[N\].
    pub measured_n: Vec<f64>,
    /// Force of the base without effects \[N\].
    pub base_n: Vec<f64>,
    /// Contribution of each effect to the force, on top of the effects before it \[N\].
    pub parts: Vec<Part>,
}

/// The contribution of one effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// Name of the effect.
    pub effect: String,
    /// Its contribution at each contraction \[N\].
    pub force_n: Vec<f64>,
}

/// A published force law, fitted to the same data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rival {
    /// Name of the law.
    pub law: String,
    /// Its title.
    pub title: String,
    /// RMS error with the printed coefficients \[N\], if there are any for this muscle.
    pub printed_rmse_n: Option<f64>,
    /// RMS error of the fit \[N\].
    pub rmse_n: f64,
    /// RMS error of the fit in per cent of full scale.
    pub rmse_percent: f64,
    /// RMS error on data left out of the fit \[N\].
    pub held_out_rmse_n: Option<f64>,
    /// Number of fitted coefficients.
    pub fitted: usize,
    /// Why the law couldn't be fitted.
    pub failed: Option<String>,
}
