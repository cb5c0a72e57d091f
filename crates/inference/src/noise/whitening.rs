//! Whitening of correlated noise in O(n) by the innovations of a Kalman filter with two states, offset and
//! exponential (Anderson and Moore 1979, ch. 9).

use bulge_model::Record;
use rayon::prelude::*;
use std::ops::Range;

use crate::noise::error::NoiseError;
use crate::noise::law::{CorrelationTime, NoiseLaw};

/// A conditional variance below this fraction of the row's variance is rounding error.
const SINGULAR: f64 = 1e-13;

/// `K^-1/2` of a noise law on the used rows of a record: turns correlated noise into independent values of
/// variance 1.
///
/// ```text
/// K = blockdiag(K_b),    K_b = diag(s_i^2) + sa^2 exp(-|t_i - t_j|/l) + su^2 1 1'
/// K^-1/2 z = e_i/sqrt(S_i),    e_i = z_i - E(z_i | z_1 .. z_(i-1)),    S_i = var(e_i)
/// ```
/// Blocks b are the sweeps, s_i^2 = sw^2 + input variance \[N^2\]. `K^-1/2` is exactly the inverse of the
/// lower Cholesky factor of K.
#[derive(Debug, Clone, PartialEq)]
pub struct Whitening {
    blocks: Vec<Range<usize>>,
    steps: Vec<Step>,
    log_determinant: f64,
    /// Sum of 1/K_ii \[1/N^2\].
    information: f64,
}

/// The filter's coefficients at a row; they don't depend on the values.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Step {
    /// exp(-dt/l) since the row before.
    decay: f64,
    /// Kalman gain of the offset; the next field is that of the correlated part.
    to_offset: f64,
    to_correlated: f64,
    /// 1/sqrt(S).
    scale: f64,
}

impl Whitening {
    /// Whitening of the rows that are `used`. `input_variances` are the noise of pressure and contraction
    /// propagated to the force, one for each row of the record \[N^2\], or an empty slice.
    ///
    /// # Errors
    /// Numbers of values that don't match, values that aren't finite or are negative, a correlation time in
    /// seconds for a record without time, and a law under which a row has no noise of its own.
    pub fn new(
        law: &NoiseLaw,
        record: &Record,
        used: &[bool],
        input_variances: &[f64],
    ) -> Result<Self, NoiseError> {
        let components = Components::of(law)?;
        let layout = Layout::new(record, used, input_variances, law.time)?;
        Self::of(&components, &layout)
    }

    /// The filter's coefficients for variances on a layout.
    pub(crate) fn of(components: &Components, layout: &Layout) -> Result<Self, NoiseError> {
        let mut steps = Vec::with_capacity(layout.rows.len());
        let (mut log_determinant, mut information) = (0.0, 0.0);
        for block in &layout.blocks {
            let mut filter = Filter::new(components);
            for i in block.clone() {
                let white = components.white + layout.known[i];
                let total = white + components.correlated + components.offset;
                let (step, variance) = filter.step(white, layout.gaps[i]);
                if variance.is_nan() || variance <= SINGULAR * total {
                    return Err(NoiseError::Singular { row: layout.rows[i], variance, total });
                }
                log_determinant += variance.ln();
                information += 1.0 / total;
                steps.push(step);
            }
        }
        Ok(Self { blocks: layout.blocks.clone(), steps, log_determinant, information })
    }

    /// Number of rows that are used.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.steps.len()
    }

    /// Replaces columns by `K^-1/2` times the columns: n x k values, row by row, of the n used rows in their
    /// order. O(n k). The blocks are computed in parallel, and the values don't depend on the number of
    /// threads.
    ///
    /// # Errors
    /// If the number of values isn't a multiple of the number of used rows.
    pub fn apply(&self, columns: &mut [f64]) -> Result<(), NoiseError> {
        let n = self.rows();
        let k = columns.len().checked_div(n).unwrap_or(0);
        if columns.len() != n * k {
            return Err(NoiseError::Lengths {
                what: "columns to whiten",
                given: columns.len(),
                expected: n * (k + 1),
                instead: "give every column one value for each used row",
            });
        }
        if k > 0 {
            self.whiten(columns, k);
        }
        Ok(())
    }

    /// A column of one value for each used row, whitened.
    pub(crate) fn whitened(&self, mut column: Vec<f64>) -> Vec<f64> {
        column.resize(self.rows(), 0.0);
        if !column.is_empty() {
            self.whiten(&mut column, 1);
        }
        column
    }

    fn whiten(&self, columns: &mut [f64], k: usize) {
        let mut parts = Vec::with_capacity(self.blocks.len());
        let mut rest = columns;
        for block in &self.blocks {
            let (part, after) = rest.split_at_mut(block.len() * k);
            parts.push((part, &self.steps[block.clone()]));
            rest = after;
        }
        parts.into_par_iter().for_each(|(part, steps)| filter(part, steps, k));
    }

    /// ln det K, with variances in N^2.
    #[must_use]
    pub fn log_determinant(&self) -> f64 {
        self.log_determinant
    }

    /// Effective number of independent rows: so many independent rows with the same variances would determine
    /// a constant equally well.
    ///
    /// ```text
    /// n_eff = n (1' K^-1 1)/(sum 1/K_ii)
    /// ```
    /// Ranges from 0 (only without rows) to n. It is n for white noise and the number of blocks if the noise
    /// consists of offsets alone. It refers to a constant: if offsets prevail, variations within a sweep are
    /// determined better than n_eff says.
    #[must_use]
    pub fn effective_rows(&self) -> f64 {
        let n = self.rows() as f64;
        if n == 0.0 {
            return n;
        }
        let ones = self.whitened(vec![1.0; self.rows()]);
        (n * ones.iter().map(|x| x * x).sum::<f64>() / self.information).min(n)
    }
}

/// Runs the filter over the rows of a block.
fn filter(part: &mut [f64], steps: &[Step], k: usize) {
    let mut offsets = vec![0.0; k];
    let mut correlated = vec![0.0; k];
    for (row, step) in part.chunks_exact_mut(k).zip(steps) {
        for ((value, u), a) in row.iter_mut().zip(&mut offsets).zip(&mut correlated) {
            *a *= step.decay;
            let innovation = *value - (*u + *a);
            *u += step.to_offset * innovation;
            *a += step.to_correlated * innovation;
            *value = innovation * step.scale;
        }
    }
}

/// Covariance matrix of the two states.
struct Filter {
    /// Variance of the correlated part and its time \[s or rows\].
    correlated: f64,
    time: f64,
    uu: f64,
    ua: f64,
    aa: f64,
}

impl Filter {
    fn new(components: &Components) -> Self {
        let Components { correlated, time, offset, .. } = *components;
        Self { correlated, time, uu: offset, ua: 0.0, aa: correlated }
    }

    /// Advances by `gap` and takes in a row with the white variance `white`. Returns the coefficients and the
    /// variance of the innovation.
    fn step(&mut self, white: f64, gap: f64) -> (Step, f64) {
        let decay = if self.correlated > 0.0 { (-gap / self.time).exp() } else { 1.0 };
        if self.correlated > 0.0 && gap > 0.0 {
            self.ua *= decay;
            self.aa = decay * decay * self.aa - self.correlated * (-2.0 * gap / self.time).exp_m1();
        }
        let (u, a) = (self.uu + self.ua, self.ua + self.aa);
        let variance = u + a + white;
        let (gu, ga) = (u / variance, a / variance);
        // P = (I - g h) P (I - g h)' + g s^2 g' (Joseph form): it stays positive where P - g g' S cancels.
        let (ku, ka) = (1.0 - gu, 1.0 - ga);
        let (uu, ua, aa) = (self.uu, self.ua, self.aa);
        self.uu = ku * ku * uu - 2.0 * ku * gu * ua + gu * gu * (aa + white);
        self.ua = (ku * ka + gu * ga) * ua - ku * ga * uu - gu * ka * aa + gu * ga * white;
        self.aa = ka * ka * aa - 2.0 * ka * ga * ua + ga * ga * (uu + white);
        (Step { decay, to_offset: gu, to_correlated: ga, scale: variance.sqrt().recip() }, variance)
    }
}

/// Variances of a noise law, all in the same unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Components {
    pub(crate) white: f64,
    pub(crate) correlated: f64,
    /// Correlation time, in seconds or rows like the layout's gaps.
    pub(crate) time: f64,
    pub(crate) offset: f64,
}

impl Components {
    pub(crate) fn of(law: &NoiseLaw) -> Result<Self, NoiseError> {
        let time = law.time.map_or(1.0, CorrelationTime::value);
        let sds = [law.white_n, law.correlated_n, law.offset_n];
        if let Some(place) = sds.iter().position(|sd| !(sd.is_finite() && *sd >= 0.0)) {
            let (what, bound) = ("standard deviation (white, correlated, offset)", " from 0");
            return Err(NoiseError::Value { what, place, value: sds[place], bound });
        }
        if !(time.is_finite() && time > 0.0) {
            let (what, bound) = ("correlation time", " above 0");
            return Err(NoiseError::Value { what, place: 0, value: time, bound });
        }
        let [white, correlated, offset] = sds.map(|sd| sd * sd);
        // A correlated part needs a correlation time.
        if correlated > 0.0 && law.time.is_none() {
            let (what, bound) = ("correlation time of a law with a correlated part", " above 0");
            return Err(NoiseError::Value { what, place: 0, value: 0.0, bound });
        }
        Ok(Self { white, correlated, time, offset })
    }
}

/// The used rows, block by block, with their gaps and input variances.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    /// Ranges of used rows, without empty ones.
    pub(crate) blocks: Vec<Range<usize>>,
    /// Row of the record for each used row.
    pub(crate) rows: Vec<usize>,
    /// Seconds or rows since the previous used row of the block; 0 for the first.
    pub(crate) gaps: Vec<f64>,
    /// Input variance of each used row.
    pub(crate) known: Vec<f64>,
}

impl Layout {
    pub(crate) fn new(
        record: &Record,
        used: &[bool],
        input_variances: &[f64],
        time: Option<CorrelationTime>,
    ) -> Result<Self, NoiseError> {
        let n = record.len();
        let mismatch = |what, given, instead| NoiseError::Lengths { what, given, expected: n, instead };
        if used.len() != n {
            return Err(mismatch(
                "used rows",
                used.len(),
                "say of every row of the record whether it counts",
            ));
        }
        if !input_variances.is_empty() && input_variances.len() != n {
            let instead = "give one for each row of the record, or none at all";
            return Err(mismatch("input variances", input_variances.len(), instead));
        }
        if let Some(place) = input_variances.iter().position(|v| !(v.is_finite() && *v >= 0.0)) {
            let (what, value) = ("input variance", input_variances[place]);
            return Err(NoiseError::Value { what, place, value, bound: " from 0" });
        }
        if let Some(CorrelationTime::Seconds(seconds)) = time
            && !record.has_time()
        {
            return Err(NoiseError::NoTime { seconds });
        }
        let at = moment_of(record, time);
        let mut layout = Self { blocks: Vec::new(), rows: Vec::new(), gaps: Vec::new(), known: Vec::new() };
        for sweep in record.sweeps() {
            let start = layout.rows.len();
            let mut before = None;
            for row in sweep.clone().filter(|row| used[*row]) {
                layout.gaps.push(before.map_or(0.0, |before| gap(at(row), before)));
                before = Some(at(row));
                layout.known.push(input_variances.get(row).copied().unwrap_or(0.0));
                layout.rows.push(row);
            }
            if layout.rows.len() > start {
                layout.blocks.push(start..layout.rows.len());
            }
        }
        Ok(layout)
    }
}

/// The position of each row in the unit of the correlation time.
pub(crate) fn moment_of(record: &Record, time: Option<CorrelationTime>) -> impl Fn(usize) -> f64 {
    let seconds = matches!(time, Some(CorrelationTime::Seconds(_)));
    move |row| if seconds { record.moments()[row].clock } else { row as f64 }
}

/// Time step; 0 where the clock runs backwards.
pub(crate) fn gap(now: f64, before: f64) -> f64 {
    (now - before).max(0.0)
}
