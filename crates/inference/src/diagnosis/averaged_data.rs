//! The data on which models are tried: means of the rows, and their noise.

use bulge_model::{ModelError, Record, Wanted, Warm};

use crate::comparison::analysis::{Analysis, Climbed};
use crate::diagnosis::averaged::Averaged;
use crate::diagnosis::confirm::Confirmed;
use crate::diagnosis::diagnose::DiagnoseOptions;
use crate::diagnosis::fits::Fits;
use crate::diagnosis::linearised_model::Context;
use crate::diagnosis::noise::Source;
use crate::diagnosis::search::Search;
use crate::diagnosis::setpoints::setpoints;
use crate::error::InferenceError;
use crate::median::median;
use crate::noise::law::{NoiseLaw, NoiseSource};
use crate::noise::whitening::Whitening;

/// Number of means on which models are tried. With 2500, fewer effects were named and more tests called unknown
/// (suite, forms suite), in half as much time again.
const MOST_ROWS: usize = 1000;
/// The noise law about a better model replaces the old one if its variance is below this fraction of the old
/// variance.
const LESS_NOISE: f64 = 0.7;
/// The search is repeated if the means move by more than this fraction of the variance (mean square).
const MOVED: f64 = 0.1;

/// Means of rows on which models are tried, and their noise.
pub(crate) struct AveragedData {
    pub(crate) averaged: Averaged,
    pub(crate) record: Record,
    input_variances: Vec<f64>,
    /// Typical variance of a single row from input noise that data sheets state \[N^2\].
    stated: f64,
    /// Variance of single rows about their means \[N^2\]; none if each row is its own mean.
    within: Option<f64>,
    pub(crate) law: Option<NoiseLaw>,
    /// Whitening by the law, or by unit white noise if there is no law.
    whitening: Whitening,
}

/// Reasons why a diagnosis stops.
pub(crate) enum Stop {
    Error(InferenceError),
    /// The base has no state at these rows of the record.
    Rows(Vec<usize>),
}

impl Stop {
    /// The reason for an error at means of rows.
    pub(crate) fn at_means(error: ModelError, averaged: &Averaged, analysis: &Analysis<'_>) -> Self {
        match &error {
            ModelError::NoEquilibrium { rows, .. } | ModelError::NotFinite { rows, .. }
                if !rows.is_empty() =>
            {
                Self::Rows(
                    rows.iter().filter_map(|row| averaged.groups.get(*row)).flatten().copied().collect(),
                )
            }
            _ => Self::Error(analysis.about(error)),
        }
    }
}

impl<E: Into<InferenceError>> From<E> for Stop {
    fn from(error: E) -> Self {
        Self::Error(error.into())
    }
}

impl AveragedData {
    /// The context for trying models; `fits` are those made under this law.
    pub(crate) fn context<'a>(
        &'a self,
        law: &'a NoiseLaw,
        options: &'a DiagnoseOptions,
        fits: Option<&'a Fits<'a>>,
    ) -> Context<'a> {
        Context {
            row_n: (white_of_row(law, self) - self.stated).max(law.white_n.powi(2)).sqrt(),
            seed: options.seed,
            only: options.among.as_deref(),
            progress: &options.progress,
            fits,
            ..Context::new(&options.base.catalogue, &self.record, &self.whitening, law)
        }
    }

    /// Variances of the means in addition to the law's white one \[N^2\].
    pub(crate) fn input_variances(&self) -> &[f64] {
        &self.input_variances
    }

    /// Variance of a mean under the law \[N^2\].
    fn variance(&self) -> f64 {
        let inputs = median(&mut self.input_variances.clone());
        self.law.as_ref().map_or(f64::INFINITY, |law| {
            law.white_n.powi(2) + law.correlated_n.powi(2) + law.offset_n.powi(2) + inputs
        })
    }
}

/// The averaged data about the best model of a search, if the noise is much smaller there or the means move.
pub(crate) fn averaged_data_again(
    analysis: &Analysis<'_>,
    search: &Search,
    before: &AveragedData,
    used: &[bool],
    options: &DiagnoseOptions,
) -> Option<AveragedData> {
    let last = search.stages.last().filter(|last| !last.added.is_empty())?;
    let Confirmed { prepared, theta, .. } = &last.confirmed;
    let found =
        prepared.model.evaluate_partly(&analysis.record, theta, &Wanted::default(), &Warm::of_rows(used));
    let force = found.ok().filter(|found| found.error.is_none())?.prediction.force;
    let about = Climbed { prepared: prepared.clone(), theta: theta.clone(), fit: None, force, failed: None };
    let again = averaged_data(analysis, &about, used, options).ok()?;
    let square: f64 =
        again.record.force().iter().zip(before.record.force()).map(|(a, b)| (a - b).powi(2)).sum();
    let moved = square / again.record.len().max(1) as f64;
    (again.variance() < LESS_NOISE * before.variance() || moved > MOVED * again.variance()).then_some(again)
}

/// The means, their forces, and their noise, under a model that is approximately right.
pub(crate) fn averaged_data(
    analysis: &Analysis<'_>,
    base: &Climbed,
    used: &[bool],
    options: &DiagnoseOptions,
) -> Result<AveragedData, Stop> {
    let none = || InferenceError::NoRows { left_out: "none of them has a state".to_owned() };
    let averaged = Averaged::of(&analysis.record, used, &analysis.levels, MOST_ROWS).ok_or_else(none)?;
    let readings = Wanted { parameters: Vec::new(), readings: true };
    let model = &base.prepared.model;
    let whole = |record: &Record| {
        let found = model.evaluate_partly(record, &base.theta, &readings, &Warm::new());
        let found = found.map_err(|error| Stop::at_means(error, &averaged, analysis))?;
        match found.error {
            Some(error) => Err(Stop::at_means(error, &averaged, analysis)),
            None => Ok(found.prediction),
        }
    };
    let at_means = whole(&averaged.record)?;
    // Only checks that the model has a state at every set point.
    whole(&setpoints(&averaged.record))?;
    let forces = averaged.forces(&analysis.record, &base.force, &at_means.force);
    let record = averaged.record.clone().with_force(forces);
    let noise = analysis.noise;
    let slopes = at_means.by_pressure.iter().zip(&at_means.by_contraction);
    // Errors of pressure and contraction act through the slopes of the force and average out within a mean.
    let input_variances: Vec<f64> = slopes
        .zip(averaged.counts())
        .enumerate()
        .map(|(row, ((p, e), count))| {
            let contraction = noise.contraction * record.shortness(row);
            ((p * noise.pressure_pa).powi(2) + (e * contraction).powi(2)) / count
        })
        .collect();
    let counts: Vec<f64> = averaged.counts().collect();
    let stated = variance_of_rows(&input_variances, &counts);
    let residual = analysis.residuals(base);
    let (sum, freedom) = averaged.within(&residual);
    let within = (freedom > 0.0).then(|| sum / freedom);
    let extra = unequal(&averaged, &counts, within.unwrap_or(0.0), analysis.record.force_sd());
    let source = Source {
        catalogue: &options.base.catalogue,
        muscle: analysis.muscle,
        record: &record,
        input_variances: &input_variances,
        slopes: [&at_means.by_contraction, &at_means.by_pressure],
        counts: &counts,
        unequal: &extra,
        within: &averaged.within_each(&residual),
        pure_error: analysis.pure_error,
    };
    let found = source.law(&base.prepared, &base.theta);
    let found = found.map_err(|error| Stop::at_means(error, &averaged, analysis))?;
    let (law, input_variances) = found.map_or((None, input_variances), |(law, inputs)| (Some(law), inputs));
    let white = || NoiseLaw::white(1.0, NoiseSource::Instruments, 0.0, String::new());
    let all = vec![true; record.len()];
    let whitening = Whitening::new(law.as_ref().unwrap_or(&white()), &record, &all, &input_variances)?;
    Ok(AveragedData { averaged, record, input_variances, stated, within, law, whitening })
}

/// Variances of the means in addition to their common one \[N^2\]: a mean of fewer rows has a larger
/// variance, and a file may state a scatter for each row.
fn unequal(averaged: &Averaged, counts: &[f64], within: f64, stated: Option<&[f64]>) -> Vec<f64> {
    let most = counts.iter().copied().fold(1.0, f64::max);
    let squares = stated.map(|sd| averaged.means(&sd.iter().map(|sd| sd * sd).collect::<Vec<_>>()));
    let least = squares.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let of = |(place, count): (usize, &f64)| {
        let own = squares.as_ref().map_or(0.0, |squares| (squares[place] - least) / count);
        within * (1.0 / count - 1.0 / most) + own
    };
    counts.iter().enumerate().map(of).collect()
}

/// Effective number of independent rows: so many single rows determine a constant as well as the means do.
pub(crate) fn effective_rows(context: &Context<'_>, averaged_data: &AveragedData, sd_n: f64) -> f64 {
    let law = context.law;
    let inputs = median(&mut averaged_data.input_variances.clone());
    let of_mean = law.white_n.powi(2) + law.correlated_n.powi(2) + law.offset_n.powi(2) + inputs;
    let rows: f64 = averaged_data.averaged.counts().sum();
    if of_mean > 0.0 { (context.whitening.effective_rows() * sd_n * sd_n / of_mean).min(rows) } else { rows }
}

/// Standard deviation of a single row: from the law of the means, the scatter that the means have averaged,
/// and noise of pressure and contraction.
pub(crate) fn row_sd(law: &NoiseLaw, averaged_data: &AveragedData) -> f64 {
    (white_of_row(law, averaged_data) + law.correlated_n.powi(2) + law.offset_n.powi(2)).sqrt()
}

/// Variance of a single row without the noise that it shares with its neighbours \[N^2\].
fn white_of_row(law: &NoiseLaw, averaged_data: &AveragedData) -> f64 {
    let counts: Vec<f64> = averaged_data.averaged.counts().collect();
    let inputs = variance_of_rows(&averaged_data.input_variances, &counts);
    let own = law.white_n.powi(2) + inputs;
    // The scatter of rows includes curvature from row to row if few rows form a mean, so the variance of the
    // means is an upper bound.
    let most = counts.iter().copied().fold(1.0, f64::max);
    let of_means = law.white_n.powi(2) * most + inputs;
    averaged_data.within.map_or(own, |within| within.min(of_means).max(own))
}

/// Median variance of single rows, from those of the means. The median disregards rows of uncertain
/// direction.
fn variance_of_rows(variances: &[f64], counts: &[f64]) -> f64 {
    let mut of_rows: Vec<f64> =
        variances.iter().zip(counts).map(|(variance, count)| variance * count).collect();
    median(&mut of_rows)
}
