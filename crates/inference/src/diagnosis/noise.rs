//! The noise law of a record, estimated before any candidate is tested and then kept fixed: from the
//! residuals of a saturated model, from repeats, or from the data sheets.

use bulge_effects::Catalogue;
use bulge_measurements::PureError;
use bulge_model::{ModelError, Record};
use bulge_muscles::Muscle;
use bulge_muscles::units::significant;

use crate::comparison::levels::Levels;
use crate::diagnosis::pure_error::BetweenCycles;
use crate::diagnosis::sensitivity::Sensitivities;
use crate::diagnosis::setpoints::setpoints;
use crate::diagnosis::smooth::smooth;
use crate::diagnosis::space::Space;
use crate::diagnosis::tangents::Tangents;
use crate::fit::nuisance::Prepared;
use crate::median::median;
use crate::noise::inputs::{Scatter, input_noise, part_of_stated};
use crate::noise::law::{NoiseLaw, NoiseSource};
use bulge_numerics::vector::{add, dot, norm};

/// Most independent columns of the saturated model relative to the rows: for effects here, for all columns in
/// the next constant. Fewer along a path, because a model with many parameters follows correlated noise and
/// hides it.
const EFFECTS_PART: [f64; 2] = [0.22, 0.08];
const ALL_PART: [f64; 2] = [0.4, 0.15];
/// Most independent columns; with many rows, more of them only cost time.
const MOST: usize = 160;
/// Columns that are allowed in any case, if there are enough rows.
const FEW: f64 = 40.0;
/// An effect is skipped if less than this fraction of it is new.
const ALIKE: f64 = 0.01;
/// A column is skipped if less than this fraction of it is new.
const NEW: f64 = 1e-4;
/// A remainder below this fraction of a column is rounding error.
const ROUNDING: f64 = 1e-9;
/// Degrees of freedom below which data sheets are better than the residuals.
const FEWEST: f64 = 8.0;
/// Degrees of freedom from which repeats of a static map determine the noise: to a sixth.
const ENOUGH_REPEATS: f64 = 20.0;

/// The data for estimating the law.
pub(crate) struct Source<'a> {
    pub(crate) catalogue: &'a Catalogue,
    pub(crate) muscle: &'a Muscle,
    /// Means of rows, with their forces.
    pub(crate) record: &'a Record,
    /// Variances of the means from noise of pressure and contraction \[N^2\].
    pub(crate) input_variances: &'a [f64],
    /// Derivatives of the force by contraction and pressure at the means.
    pub(crate) slopes: [&'a [f64]; 2],
    /// Number of readings in each mean.
    pub(crate) counts: &'a [f64],
    /// Variances in which the means differ for other reasons \[N^2\].
    pub(crate) unequal: &'a [f64],
    /// Scatter of the readings of each mean.
    pub(crate) within: &'a [Option<Scatter>],
    pub(crate) pure_error: Option<PureError>,
}

impl Source<'_> {
    /// The law under a base model with parameters `theta`, and the additional variances from noise of the
    /// inputs: the stated ones, or else those that the scatter shows. None if nothing is known about the
    /// noise.
    pub(crate) fn law(
        &self,
        prepared: &Prepared,
        theta: &[f64],
    ) -> Result<Option<(NoiseLaw, Vec<f64>)>, ModelError> {
        let mut stated_inputs = self.input_variances.to_vec();
        if let Some(pure) =
            self.pure_error.filter(|p| !self.record.is_path() && p.degrees_of_freedom >= ENOUGH_REPEATS)
        {
            let says = format!("repeated points, {:.0} degrees of freedom", pure.degrees_of_freedom);
            // The scatter of the repeats includes noise of the inputs.
            let most = self.counts.iter().copied().fold(1.0, f64::max);
            let sd_n = pure.sd_n / most.sqrt();
            let law = NoiseLaw::white(sd_n, NoiseSource::Repeats, pure.degrees_of_freedom, says);
            return Ok(Some((law, self.unequal.to_vec())));
        }
        let tangents = Tangents::of(prepared, theta, self.record)?;
        let residual = &tangents.residual;
        let sensitivities = Sensitivities::of(self.catalogue, None, prepared, theta, &tangents);
        let columns: Vec<&Vec<f64>> = sensitivities.sensitivities.iter().flat_map(|s| &s.columns).collect();
        let design = saturated(self.record, &tangents.columns, &columns);
        let n = self.record.len();
        let stated = self.muscle.instruments().force.map_or(0.0, |force| force.noise());
        let left = n as f64 - design.len() as f64;
        let found = (left >= FEWEST)
            .then(|| {
                let sweeps = if self.record.is_path() { self.record.sweeps() } else { &[] };
                let is_stated = stated_inputs.iter().any(|variance| *variance > 0.0);
                let part = if is_stated {
                    part_of_stated(residual, sweeps, &design, &stated_inputs, self.counts, self.within)
                } else {
                    1.0
                };
                for variance in &mut stated_inputs {
                    *variance *= part;
                }
                let shown = if is_stated {
                    None
                } else {
                    input_noise(residual, sweeps, &design, self.slopes, self.counts, self.within)
                };
                let mut inputs = shown.unwrap_or_else(|| stated_inputs.clone());
                for (variance, own) in inputs.iter_mut().zip(self.unequal) {
                    *variance += own;
                }
                let rows: Vec<f64> =
                    (0..n).flat_map(|i| design.iter().map(move |column| column[i])).collect();
                let mut law =
                    NoiseLaw::estimate(self.record, &vec![true; n], &inputs, &rows, residual).ok()?;
                if part < 1.0 {
                    law.says = format!(
                        "{}; the rows contradict the noise that the data sheets state of pressure and length: {} of its variance is taken",
                        law.says,
                        significant(part, 2)
                    );
                }
                let cycles = BetweenCycles::of(self.record, residual);
                // Use the median, because rows of uncertain direction have a large variance of their own.
                let law = match cycles {
                    Some(cycles) => {
                        let kurtosis = kurtosis(residual, &design, &inputs, &law);
                        cycles.bounds(law, median(&mut inputs.clone()), kurtosis)
                    }
                    None => law,
                };
                Some((law, inputs))
            })
            .flatten();
        Ok(found.or_else(|| {
            (stated > 0.0).then(|| {
                let says = "the data sheet of the load cell: these rows are too few to say".to_owned();
                (NoiseLaw::white(stated, NoiseSource::Instruments, 0.0, says), stated_inputs)
            })
        }))
    }
}

/// Kurtosis of what orthonormal columns leave of the residuals, in standard deviations of single readings: 3 for
/// normal noise.
pub(crate) fn kurtosis(residual: &[f64], design: &[Vec<f64>], inputs: &[f64], law: &NoiseLaw) -> f64 {
    let mut left = residual.to_vec();
    for column in design {
        let part = dot(column, &left);
        add(&mut left, -part, column);
    }
    let alike = law.white_n * law.white_n + law.correlated_n * law.correlated_n;
    let squares =
        left.iter().zip(inputs).map(|(value, own)| value * value / (alike + own).max(f64::MIN_POSITIVE));
    let squares: Vec<f64> = squares.collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    squares.iter().map(|square| square * square).sum::<f64>() / (squares.len() as f64 * mean * mean)
}

/// The saturated model as orthonormal columns. Within the sweeps it contains the tangents of the base,
/// columns of the effects, and smooth functions; between sweeps only what is set: pressure, specimen,
/// temperature, and the clock. Any other difference between sweeps is an offset: with a rich model between
/// sweeps as well, no degrees of freedom would remain for the offsets.
fn saturated(record: &Record, tangents: &[Vec<f64>], effects: &[&Vec<f64>]) -> Vec<Vec<f64>> {
    let n = record.len() as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "numbers of columns")]
    let [effects_most, most] = [EFFECTS_PART, ALL_PART]
        .map(|part| (part[usize::from(record.is_path())] * n).max(FEW.min(0.4 * n)) as usize);
    let mut space = Space::without(&[]);
    for column in between(record) {
        enter_new(&mut space, &column);
    }
    for tangent in tangents {
        enter_new(&mut space, &within(record, tangent));
    }
    // Greedy choice: the column with the largest new part enters first, so that few columns represent many
    // effects. Each entry is a column and its new part.
    let mut left: Vec<(Vec<f64>, Vec<f64>)> = effects
        .iter()
        .map(|column| {
            let column = within(record, column);
            let new = space.outside(&column);
            (column, new)
        })
        .collect();
    while space.len() < effects_most.min(MOST).max(tangents.len() + 1) {
        let part = |(column, new): &(Vec<f64>, Vec<f64>)| norm(new) / norm(column).max(f64::MIN_POSITIVE);
        let best = (0..left.len()).map(|i| (i, part(&left[i]))).max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((place, _)) = best.filter(|best| best.1 > ALIKE) else { break };
        space.enter(&left.swap_remove(place).0);
        for (_, new) in &mut left {
            space.outside_last(new);
        }
    }
    for function in smooth(record) {
        if space.len() >= most.min(MOST).max(tangents.len() + 1) {
            break;
        }
        enter_new(&mut space, &within(record, &function.values));
    }
    space.into_units()
}

/// A column without its mean over each sweep.
fn within(record: &Record, column: &[f64]) -> Vec<f64> {
    let mut left = column.to_vec();
    if !record.is_path() {
        // The sweeps of a static map are no runs and have no offsets.
        return left;
    }
    for sweep in record.sweeps() {
        let values = &mut left[sweep.clone()];
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        for value in values {
            *value -= mean;
        }
    }
    if norm(&left) <= ROUNDING * norm(column) {
        // A column that is constant within each sweep leaves only rounding errors, which would give a
        // spurious direction.
        left.fill(0.0);
    }
    left
}

/// Columns of what is set from sweep to sweep.
fn between(record: &Record) -> Vec<Vec<f64>> {
    let kept = setpoints(record);
    let levels = Levels::of(record, &vec![true; record.len()]).len();
    let of = |f: &dyn Fn(&bulge_effects::Moment) -> f64| kept.moments().iter().map(f).collect::<Vec<f64>>();
    let largest = kept.moments().iter().map(|m| m.pressure).fold(f64::MIN_POSITIVE, f64::max);
    let mut columns = vec![vec![1.0; record.len()], of(&|m| m.pressure / largest)];
    if levels > 3 {
        columns.push(of(&|m| (m.pressure / largest).powi(2)));
    }
    for specimen in 1..record.specimens().len() {
        columns.push(of(&|m| f64::from(u8::from(m.specimen as usize == specimen))));
    }
    if kept.moments().iter().any(|m| m.temperature != 0.0) {
        columns.push(of(&|m| m.temperature));
    }
    if record.has_time() && record.sweeps().len() > levels {
        columns.push(of(&|m| m.clock));
    }
    columns
}

fn enter_new(space: &mut Space, column: &[f64]) {
    let whole = norm(column);
    if whole > 0.0 && norm(&space.outside(column)) > NEW * whole {
        space.enter(column);
    }
}
