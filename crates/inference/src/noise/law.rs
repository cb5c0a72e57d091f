//! Noise law of a record: white noise, exponentially correlated noise within a sweep, and one offset per
//! sweep.

use bulge_model::Record;
use serde::Serialize;

use crate::noise::offset_belief::OffsetBelief;
use crate::noise::whitening::{gap, moment_of};
use bulge_numerics::Random;

/// Noise of the force at row i of sweep b:
///
/// ```text
/// u_b + a_i + w_i,    u_b ~ N(0, su^2),    cov(a_i, a_j) = sa^2 exp(-|t_i - t_j|/l),    w_i ~ N(0, sw^2 + v_i)
/// ```
/// v_i is the noise of pressure and contraction propagated to the force, (dF/dp)^2 sp^2 + (dF/deps)^2 se^2
/// \[N^2\]; the caller supplies it. Different sweeps are independent. [`Whitening`](crate::Whitening) applies
/// `K^-1/2` of this law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseLaw {
    /// Standard deviation sw of independent noise \[N\].
    pub white_n: f64,
    /// Standard deviation sa of correlated noise \[N\].
    pub correlated_n: f64,
    /// Correlation time l; none without correlated noise.
    pub time: Option<CorrelationTime>,
    /// Standard deviation su of the offsets of the sweeps \[N\].
    pub offset_n: f64,
    /// Origin of the law.
    pub source: NoiseSource,
    /// Degrees of freedom of the estimate: rows less independent columns; 0 for a data sheet.
    pub degrees_of_freedom: f64,
    /// Discrete distribution of the offsets' standard deviation, whose root mean square is `offset_n`. Empty
    /// if there are no offsets.
    pub offset_beliefs: Vec<OffsetBelief>,
    /// Degrees of freedom of the offsets: sweeps less what the saturated model can follow from sweep to
    /// sweep.
    pub offset_freedom: f64,
    /// In words: what the law was estimated from, what was left out, and why.
    pub says: String,
}

/// Correlation time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CorrelationTime {
    /// In seconds.
    Seconds(f64),
    /// In rows of the record, if it has no time. A thinned record has other rows.
    Rows(f64),
}

impl CorrelationTime {
    /// The value, in the unit of the variant.
    #[must_use]
    pub fn value(self) -> f64 {
        match self {
            Self::Seconds(value) | Self::Rows(value) => value,
        }
    }
}

/// Origin of a noise law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum NoiseSource {
    /// Scatter of repeated rows.
    Repeats,
    /// Residuals of a saturated model.
    Saturated,
    /// Data sheets.
    Instruments,
}

impl NoiseSource {
    /// Its name in documents.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Repeats => "repeats",
            Self::Saturated => "saturated",
            Self::Instruments => "instruments",
        }
    }
}

impl NoiseLaw {
    /// Independent noise of standard deviation `white_n` \[N\].
    #[must_use]
    pub fn white(white_n: f64, source: NoiseSource, degrees_of_freedom: f64, says: String) -> Self {
        Self {
            white_n,
            correlated_n: 0.0,
            time: None,
            offset_n: 0.0,
            source,
            degrees_of_freedom,
            offset_beliefs: Vec::new(),
            offset_freedom: 0.0,
            says,
        }
    }

    /// Whether rows are independent as far as is known. Offsets that are probably 0 don't count.
    #[must_use]
    pub fn is_white(&self) -> bool {
        let none = self.offset_beliefs.iter().filter(|belief| belief.sd_n == 0.0).map(|belief| belief.weight);
        let offsets = self.offset_n > 0.0 && none.sum::<f64>() < 0.5;
        self.correlated_n == 0.0 && !offsets
    }

    /// A realisation of the noise \[N\], one value for each row of the record: 0 in rows that aren't used.
    /// `input_variances` are as in [`Whitening::new`](crate::Whitening::new); missing ones are 0.
    ///
    /// The same seed gives the same noise, and each sweep has a random stream of its own ([`Random`]). The
    /// noise of a row doesn't depend on which other rows are used. With a law in seconds and a record without
    /// time, a is constant within each sweep.
    #[must_use]
    pub fn simulate(&self, record: &Record, used: &[bool], input_variances: &[f64], seed: u64) -> Vec<f64> {
        let mut noise = vec![0.0; record.len()];
        let at = moment_of(record, self.time);
        let time = self.time.map_or(1.0, CorrelationTime::value);
        for (stream, sweep) in (0..).zip(record.sweeps()) {
            let mut random = Random::new(seed, stream);
            let offset = self.offset_n * random.normal();
            let mut correlated = self.correlated_n * random.normal();
            for row in sweep.clone() {
                let since = if row == sweep.start { 0.0 } else { gap(at(row), at(row - 1)) };
                // sqrt(1 - exp(-2 dt/l)) without cancellation.
                let fresh = (-(-2.0 * since / time).exp_m1()).sqrt();
                correlated = (-since / time).exp() * correlated + fresh * self.correlated_n * random.normal();
                let known = input_variances.get(row).map_or(0.0, |v| v.max(0.0));
                let white = (self.white_n * self.white_n + known).sqrt() * random.normal();
                if used.get(row).copied().unwrap_or(false) {
                    noise[row] = offset + correlated + white;
                }
            }
        }
        noise
    }
}
