//! The result of a prediction.

use bulge_measurements::{WrittenColumn, WrittenValues};
use serde::Serialize;

use crate::comparison::document::LeftOut;

/// The force of a muscle at rows that it wasn't fitted to.
///
/// Missing values are NaN (`null` in JSON): forces of rows without a state, and ends of intervals whose width
/// is unknown.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Predicted {
    /// Name and version of the document: `bulge.prediction/1`.
    pub schema: &'static str,
    /// Name of the muscle.
    pub muscle: String,
    /// Names of the files.
    pub files: Vec<String>,
    /// SHA-256 of the file, or of the digests of several files.
    pub sha256: String,
    /// Number of rows.
    pub rows: usize,
    /// Rows that have no state, and why.
    pub without_state: Option<LeftOut>,
    /// Rows that are left out of the errors because their measured force carries no information, and why.
    pub left_out: Vec<LeftOut>,
    /// The uncertain parameters behind the intervals.
    pub uncertain: Vec<UncertainNumber>,
    /// RMS deviation of a single reading from the model \[N\]: that of the fit, or else the noise of the
    /// instruments; none if neither is known.
    pub reading_sd_n: Option<f64>,
    /// Errors against measured forces, if there are any.
    pub against: Option<Against>,
    /// What a reader should know before trusting the numbers.
    pub warnings: Vec<String>,
    /// Row by row.
    pub columns: PredictedColumns,
}

/// A parameter whose uncertainty widens the intervals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UncertainNumber {
    /// The effect.
    pub effect: String,
    /// The name within the effect.
    pub name: String,
    /// Value in `unit`.
    pub value: f64,
    /// Standard deviation in `unit`.
    pub sd: f64,
    /// Unit of the value.
    pub unit: String,
    /// `fitted` if it comes from the table `[fitted]` of the muscle file, `stated` if its width does or comes
    /// from the instruments.
    pub from: &'static str,
    /// RMS change of the force for one standard deviation of the parameter \[N\].
    pub moves_n: f64,
}

/// Measured forces against the prediction, over the rows that count.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Against {
    /// Number of rows.
    pub rows: usize,
    /// RMS error \[N\].
    pub rmse_n: f64,
    /// Mean error, measured - predicted \[N\].
    pub bias_n: f64,
    /// Fraction of the readings within their 95 % intervals; none without intervals.
    pub coverage: Option<f64>,
}

/// A prediction row by row, in the order of the files.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictedColumns {
    /// Names of the specimens.
    pub specimens: Vec<String>,
    /// Names of the sweeps; none for a static map.
    pub sweeps: Option<Vec<String>>,
    /// Index of the file.
    pub file: Vec<u32>,
    /// Line in the file, or number of the row, from 1.
    pub line: Vec<u32>,
    /// Index of the sweep.
    pub sweep: Vec<u32>,
    /// Index of the specimen.
    pub specimen: Vec<u32>,
    /// Time as read \[s\], if there is any.
    pub time_s: Option<Vec<f64>>,
    /// Gauge pressure as read \[Pa\].
    pub pressure_pa: Vec<f64>,
    /// Contraction as read.
    pub contraction: Vec<f64>,
    /// Predicted force \[N\].
    pub force_n: Vec<f64>,
    /// Standard deviation of the predicted force from its uncertain parameters \[N\].
    pub sd_n: Vec<f64>,
    /// Lower end of the 95 % interval of a reading \[N\].
    pub low_n: Vec<f64>,
    /// Upper end.
    pub high_n: Vec<f64>,
    /// Measured force \[N\], if there is any.
    pub measured_n: Option<Vec<f64>>,
    /// Measured less predicted force \[N\].
    pub residual_n: Option<Vec<f64>>,
}

impl Predicted {
    /// The columns of a file, in SI units; [`bulge_measurements::written`] turns them into bytes. The column
    /// `force [N]` is the measured force if there is one, as in the files that are read; `model force [N]` is
    /// the predicted one.
    #[must_use]
    pub fn written_columns(&self) -> Vec<WrittenColumn<'_>> {
        let PredictedColumns { sweeps, specimens, time_s, measured_n, residual_n, .. } = &self.columns;
        let rows = &self.columns;
        let mut columns = vec![
            ("file", WrittenValues::names(&self.files, &rows.file)),
            ("line", WrittenValues::Counts(&rows.line)),
        ];
        columns.extend(sweeps.as_ref().map(|names| ("sweep", WrittenValues::names(names, &rows.sweep))));
        columns.push(("specimen", WrittenValues::names(specimens, &rows.specimen)));
        columns.extend(time_s.as_deref().map(|time| ("time [s]", WrittenValues::numbers(time))));
        columns.push(("pressure [Pa]", WrittenValues::numbers(&rows.pressure_pa)));
        columns.push(("contraction [-]", WrittenValues::numbers(&rows.contraction)));
        columns.extend(measured_n.as_deref().map(|force| ("force [N]", WrittenValues::numbers(force))));
        columns.push(("model force [N]", WrittenValues::numbers(&rows.force_n)));
        columns.push(("model uncertainty [N]", WrittenValues::numbers(&rows.sd_n)));
        columns.push(("low [N]", WrittenValues::numbers(&rows.low_n)));
        columns.push(("high [N]", WrittenValues::numbers(&rows.high_n)));
        columns.extend(residual_n.as_deref().map(|rest| ("residual [N]", WrittenValues::numbers(rest))));
        columns.into_iter().map(|(heading, values)| WrittenColumn { heading, values }).collect()
    }
}
