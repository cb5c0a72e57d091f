//! A comparison row by row: the readings, the forces of base and last rung, and whether the row counts.

use bulge_measurements::{SweepKind, WrittenColumn, WrittenValues};
use bulge_model::{Wanted, Warm};
use serde::Serialize;

use crate::comparison::analysis::{Analysis, Climbed};
use crate::comparison::levels::sweep_of;
use crate::error::InferenceError;
use crate::vector::minus;

/// Every row of the data in the order of the files; each column has one entry per row.
///
/// Model forces are given for rows that don't count as well. They are NaN (`null` in JSON) if the row has no
/// state.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rows {
    /// Names of the files.
    pub files: Vec<String>,
    /// Names of the sweeps.
    pub sweeps: Vec<String>,
    /// Kind of each sweep.
    pub sweep_kinds: Vec<SweepKind>,
    /// Names of the specimens.
    pub specimens: Vec<String>,
    /// Reasons why rows don't count.
    pub reasons: Vec<String>,
    /// Effects of the model behind `model_n`, in their order: all that were requested, except those at the
    /// end with which no row has a state.
    pub effects: Vec<String>,
    /// Index of the file in `files`.
    pub file: Vec<u32>,
    /// Line in the file, or number of the row if the file has no lines, from 1.
    pub line: Vec<u32>,
    /// Index of the sweep in `sweeps`.
    pub sweep: Vec<u32>,
    /// Index of the specimen in `specimens`.
    pub specimen: Vec<u32>,
    /// Whether the row enters errors and fits.
    pub counts: Vec<bool>,
    /// Index of the reason in `reasons`, for rows that don't count.
    pub reason: Vec<Option<u32>>,
    /// Whether the row was excluded by the user.
    pub excluded: Vec<bool>,
    /// Whether the rows follow each other in time; otherwise they are a static map, and sweeps have no
    /// meaning.
    pub is_path: bool,
    /// Time as read \[s\], if there is any.
    pub time_s: Option<Vec<f64>>,
    /// Temperature as read \[K\], if there is any.
    pub temperature_k: Option<Vec<f64>>,
    /// Gauge pressure as read \[Pa\].
    pub pressure_pa: Vec<f64>,
    /// Contraction as read, or 1 - l/l0 if the length was read.
    pub contraction: Vec<f64>,
    /// Rate of contraction \[1/s\], positive when shortening; 0 without time.
    pub rate: Vec<f64>,
    /// +1 shortening, -1 lengthening, 0 at rest; at held length the direction of the pressure.
    pub direction: Vec<f64>,
    /// Measured force \[N\].
    pub measured_n: Vec<f64>,
    /// Force of the base \[N\].
    pub base_n: Vec<f64>,
    /// Force of each rung between base and model \[N\], if requested.
    pub between_n: Vec<Vec<f64>>,
    /// Force of the model with the effects \[N\].
    pub model_n: Vec<f64>,
}

impl Rows {
    /// The rows for the rungs from the base to the model: all of them, or these two.
    pub(crate) fn of(
        analysis: &Analysis<'_>,
        rungs: &[&Climbed],
        effects: usize,
    ) -> Result<Self, InferenceError> {
        let (data, record, used) = (&analysis.data, &analysis.record, &analysis.used);
        let moments = record.moments();
        let rows = 0..record.len();
        let lines: Vec<(usize, usize)> = rows.clone().map(|row| data.line(row)).collect();
        let mut forces =
            rungs.iter().map(|rung| force_of_all(analysis, rung)).collect::<Result<Vec<_>, _>>()?;
        let model_n = forces.pop().unwrap_or_default();
        let (base_n, between_n) = match forces.split_first() {
            Some((base, between)) => (base.clone(), between.to_vec()),
            None => (model_n.clone(), Vec::new()),
        };
        let mut excluded = vec![false; record.len()];
        analysis.options.excluded.iter().for_each(|row| excluded[*row] = true);
        let names = analysis.options.effects[..effects].iter().map(|effect| effect.card().name.to_owned());
        Ok(Self {
            files: data.files().iter().map(|file| file.name.clone()).collect(),
            sweeps: data.sweeps().iter().map(|sweep| sweep.name.clone()).collect(),
            sweep_kinds: data.sweeps().iter().map(|sweep| sweep.kind).collect(),
            specimens: record.specimens().to_vec(),
            reasons: used.left_out.iter().map(|left| left.why.clone()).collect(),
            effects: names.collect(),
            file: lines.iter().map(|(file, _)| short(*file)).collect(),
            line: lines.iter().map(|(_, line)| short(*line)).collect(),
            sweep: rows.map(|row| short(sweep_of(record.sweeps(), row))).collect(),
            specimen: moments.iter().map(|moment| moment.specimen).collect(),
            counts: used.mask.clone(),
            reason: used.reason.clone(),
            excluded,
            is_path: data.is_path(),
            time_s: data.time().map(<[f64]>::to_vec),
            temperature_k: data.temperature().map(<[f64]>::to_vec),
            pressure_pa: moments.iter().map(|moment| moment.pressure).collect(),
            contraction: moments.iter().map(|moment| moment.contraction).collect(),
            rate: moments.iter().map(|moment| moment.rate).collect(),
            direction: moments.iter().map(bulge_effects::Moment::branch).collect(),
            measured_n: record.force().to_vec(),
            base_n,
            between_n,
            model_n,
        })
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.counts.len()
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.counts.is_empty()
    }

    /// The columns of a file that Bulge can read again, in SI units; [`bulge_measurements::written`] turns
    /// them into bytes.
    #[must_use]
    pub fn columns(&self) -> Vec<WrittenColumn<'_>> {
        let numbers = WrittenValues::numbers;
        let mut columns = vec![
            ("file", WrittenValues::names(&self.files, &self.file)),
            ("line", WrittenValues::Counts(&self.line)),
        ];
        // A sweep column would turn the rows of a static map into a path.
        if self.is_path {
            columns.push(("sweep", WrittenValues::names(&self.sweeps, &self.sweep)));
        }
        columns.extend([
            ("specimen", WrittenValues::names(&self.specimens, &self.specimen)),
            ("counts", WrittenValues::Flags(&self.counts)),
            ("why", WrittenValues::Names(&self.reasons, self.reason.clone())),
        ]);
        columns.extend(self.time_s.as_deref().map(|time| ("time [s]", numbers(time))));
        columns.extend([
            ("pressure [Pa]", numbers(&self.pressure_pa)),
            ("contraction [-]", numbers(&self.contraction)),
        ]);
        columns.extend(self.temperature_k.as_deref().map(|t| ("temperature [K]", numbers(t))));
        columns.extend([
            ("force [N]", numbers(&self.measured_n)),
            ("base force [N]", numbers(&self.base_n)),
            ("model force [N]", numbers(&self.model_n)),
            ("residual [N]", WrittenValues::Numbers(self.residual_n().into())),
        ]);
        columns.into_iter().map(|(heading, values)| WrittenColumn { heading, values }).collect()
    }

    /// Measured force less that of the model with the effects \[N\]; NaN without a state.
    #[must_use]
    pub fn residual_n(&self) -> Vec<f64> {
        minus(&self.measured_n, &self.model_n)
    }
}

/// The force of all rows \[N\], including those that don't count and are left out of the fits.
fn force_of_all(analysis: &Analysis<'_>, climbed: &Climbed) -> Result<Vec<f64>, InferenceError> {
    let mut force = climbed.force.clone();
    let others: Vec<bool> = analysis.used.mask.iter().map(|counts| !counts).collect();
    if others.contains(&true) {
        let only = Warm::of_rows(&others);
        let model = &climbed.prepared.model;
        let found = model.evaluate_partly(&analysis.record, &climbed.theta, &Wanted::default(), &only);
        let found = found.map_err(|error| analysis.about(error))?.prediction.force;
        for row in (0..force.len()).filter(|row| others[*row]) {
            force[row] = found[row];
        }
    }
    Ok(force)
}

pub(crate) fn short(number: usize) -> u32 {
    // Files with more rows aren't read, so line numbers fit in this type.
    u32::try_from(number).unwrap_or(u32::MAX)
}
