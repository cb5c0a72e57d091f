//! Losses of a fit: how much a reading counts that lies far from the model.
//!
//! P. J. Huber, E. M. Ronchetti, *Robust Statistics*, 2nd ed., Wiley 2009, chapter 7.

use serde::Serialize;

/// What a reading contributes to the sum that a fit minimises, as a function of its residual r in standard
/// deviations. All begin as r^2; the others grow less for readings far off, so that spikes pull less.
///
/// ```text
/// squares   r^2
/// huber     r^2 for |r| < k, else 2 k |r| - k^2                  k = 1.345
/// soft-l1   2 k^2 (sqrt(1 + (r/k)^2) - 1)                        k = 1.287
/// cauchy    k^2 ln(1 + (r/k)^2)                                  k = 2.385
/// ```
/// The constants give estimates whose variance is 1/0.95 of that of least squares where the noise is normal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Loss {
    /// Least squares.
    #[default]
    Squares,
    /// Squares near the model, absolute values far from it.
    Huber,
    /// The same with a smooth transition.
    SoftL1,
    /// Readings far off count less and less. The sum may have several minima.
    Cauchy,
}

/// A weighted residual after the loss.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bent {
    /// The number whose square is the loss, with the sign of the residual.
    pub(crate) value: f64,
    /// Its derivative by the residual.
    pub(crate) slope: f64,
}

impl Loss {
    /// All losses.
    pub const ALL: [Self; 4] = [Self::Squares, Self::Huber, Self::SoftL1, Self::Cauchy];

    /// Its name in commands, functions and documents.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Squares => "squares",
            Self::Huber => "huber",
            Self::SoftL1 => "soft-l1",
            Self::Cauchy => "cauchy",
        }
    }

    /// The loss of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|loss| loss.name() == name)
    }

    /// The residual in standard deviations at which it departs from squares.
    fn scale(self) -> f64 {
        match self {
            Self::Squares => f64::INFINITY,
            Self::Huber => 1.345,
            Self::SoftL1 => 1.287,
            Self::Cauchy => 2.385,
        }
    }

    /// The root of the loss of a residual r.
    pub(crate) fn bent(self, r: f64) -> Bent {
        let k = self.scale();
        let x = (r / k).abs();
        match self {
            Self::Squares => Bent { value: r, slope: 1.0 },
            Self::Huber if x <= 1.0 => Bent { value: r, slope: 1.0 },
            Self::Huber => {
                let root = k * (2.0 * x - 1.0).sqrt();
                Bent { value: root.copysign(r), slope: k / root }
            }
            Self::SoftL1 => {
                let q = x.hypot(1.0);
                let part = (2.0 / (1.0 + q)).sqrt();
                Bent { value: r * part, slope: 1.0 / (q * part) }
            }
            Self::Cauchy => {
                // ln(1 + x^2)/x^2, whose limit is 1.
                let part = if x > 0.0 { ((x * x).ln_1p() / (x * x)).sqrt() } else { 1.0 };
                Bent { value: r * part, slope: 1.0 / ((1.0 + x * x) * part) }
            }
        }
    }

    /// The residual of a bent one.
    pub(crate) fn straightened(self, value: f64) -> f64 {
        let k = self.scale();
        let y = (value / k).abs();
        match self {
            Self::Squares => value,
            Self::Huber if y <= 1.0 => value,
            Self::Huber => (k * 0.5 * (y * y + 1.0)).copysign(value),
            Self::SoftL1 => {
                // sqrt((1 + y^2/2)^2 - 1) without cancellation.
                (k * y * (1.0 + 0.25 * y * y).sqrt()).copysign(value)
            }
            Self::Cauchy => (k * (y * y).exp_m1().sqrt()).copysign(value),
        }
    }

    /// The part of its influence that a reading keeps: 1 near the model.
    #[must_use]
    pub fn weight(self, r: f64) -> f64 {
        let Bent { value, slope } = self.bent(r);
        if r == 0.0 { 1.0 } else { value * slope / r }
    }

    /// Derivative of the influence: of half the slope of the loss.
    fn influence_slope(self, r: f64) -> f64 {
        let x = (r / self.scale()).powi(2);
        match self {
            Self::Squares => 1.0,
            Self::Huber => f64::from(u8::from(x <= 1.0)),
            Self::SoftL1 => (1.0 + x).powf(-1.5),
            Self::Cauchy => (1.0 - x) / (1.0 + x).powi(2),
        }
    }

    /// Variance of estimates over that of `(J^T J)^-1`, J being the derivatives of the bent residuals: the sum
    /// of squares over the freedom for least squares, and for others Huber's
    ///
    /// ```text
    /// mean(psi^2)/mean(psi')^2 mean(s'^2) n/freedom
    /// ```
    /// psi: influence, s: bent residual.
    pub(crate) fn spread(self, bent: &[f64], freedom: f64) -> f64 {
        let n = bent.len().max(1) as f64;
        let (mut square, mut slope, mut metric) = (0.0, 0.0, 0.0);
        for value in bent {
            let r = self.straightened(*value);
            let steep = self.bent(r).slope;
            square += (value * steep).powi(2);
            slope += self.influence_slope(r);
            metric += steep * steep;
        }
        let slope = (slope / n).max(LEAST_SLOPE);
        // Readings as exact as stated are not taken for more exact.
        (square / freedom / (slope * slope)).max(1.0) * metric / n
    }
}

/// The mean slope of the influence is not taken for less: a fit of which nine tenths are spikes has no interval.
const LEAST_SLOPE: f64 = 0.1;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bent_residuals_are_those_of_their_losses() {
        for loss in Loss::ALL {
            let k = loss.scale();
            for r in [-40.0, -3.0, -1.3, -1e-3, 0.0, 1e-9, 0.4, 1.345, 1.4, 2.5, 7.0, 300.0] {
                let x: f64 = r / k;
                let rho = match loss {
                    Loss::Squares => r * r,
                    Loss::Huber if r.abs() <= k => r * r,
                    Loss::Huber => 2.0 * k * r.abs() - k * k,
                    Loss::SoftL1 => 2.0 * k * k * ((1.0 + x * x).sqrt() - 1.0),
                    Loss::Cauchy => k * k * (1.0 + x * x).ln(),
                };
                let Bent { value, slope } = loss.bent(r);
                assert!((value * value - rho).abs() < 1e-12 * (1.0 + rho), "{loss:?} {r}");
                assert!((loss.straightened(value) - r).abs() < 1e-12 * (1.0 + r.abs()), "{loss:?} {r}");
                let h = 1e-6 * (1.0 + r.abs());
                let difference = (loss.bent(r + h).value - loss.bent(r - h).value) / (2.0 * h);
                assert!((slope - difference).abs() < 1e-5, "{loss:?} {r}: {slope} {difference}");
                let influence = |r: f64| loss.bent(r).value * loss.bent(r).slope;
                let difference = (influence(r + h) - influence(r - h)) / (2.0 * h);
                let is_kink = loss == Loss::Huber && (r.abs() - k).abs() < 2.0 * h;
                assert!(is_kink || (loss.influence_slope(r) - difference).abs() < 1e-5, "{loss:?} {r}");
            }
        }
    }

    /// Under normal noise estimates have the variance of least squares over 0.95: the constants of the losses,
    /// by quadrature.
    #[test]
    fn the_efficiency_is_that_stated() {
        for loss in [Loss::Huber, Loss::SoftL1, Loss::Cauchy] {
            let (mut square, mut slope) = (0.0, 0.0);
            let steps = 40_000;
            for step in 0..steps {
                let r = -10.0 + 20.0 * (f64::from(step) + 0.5) / f64::from(steps);
                let density = (-0.5 * r * r).exp() / std::f64::consts::TAU.sqrt() * 20.0 / f64::from(steps);
                let Bent { value, slope: steep } = loss.bent(r);
                square += density * (value * steep).powi(2);
                slope += density * loss.influence_slope(r);
            }
            let efficiency = slope * slope / square;
            assert!((efficiency - 0.95).abs() < 5e-4, "{loss:?} {efficiency}");
        }
    }

    #[test]
    fn the_spread_of_squares_is_the_sum_over_the_freedom() {
        let residuals = [2.0, -3.0, 1.0, 4.0];
        assert!((Loss::Squares.spread(&residuals, 3.0) - 10.0).abs() < 1e-12);
        assert!((Loss::Squares.spread(&[0.1, 0.2], 1.0) - 1.0).abs() < 1e-12);
    }
}
