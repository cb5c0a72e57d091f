//! Null distributions: the largest score of the whole catalogue and the adaptive smooth test, by parametric
//! bootstrap in the coordinates of the screen.
//!
//! ```text
//! screen:  max over effects of the score S_e, as the normal quantile that chi^2 with as many degrees of freedom has (Wilson and Hilferty 1931)
//! smooth:  max over K of (|z_1|^2 + .. + |z_K|^2 - K)/sqrt(2 K)    (Fan 1996: adaptive Neyman), the smoothest functions first
//! ```
//! Under the model alone, z is standard normal times the ratio of the true to the estimated noise, which
//! follows from chi^2 with the degrees of freedom of the noise law. The draws account for sign constraints,
//! correlations between candidates, and the number of candidates.

use rayon::prelude::*;

use crate::diagnosis::candidates::Candidate;
use crate::noise::offset_belief::OffsetBelief;
use bulge_numerics::Random;
use bulge_numerics::vector::{add, dot};

/// Number of draws.
const DRAWS: usize = 2000;
/// Draws per random stream.
const PER_STREAM: usize = 100;
/// Numbers of smooth functions K of the smooth test.
const TOGETHER: [usize; 8] = [2, 4, 8, 12, 16, 24, 32, 48];

/// Both statistics of one data set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Statistics {
    /// Largest score of the candidates, as a normal quantile.
    pub(crate) screen: f64,
    /// Adaptive smooth test.
    pub(crate) smooth: f64,
}

/// The distribution of a right model's misfit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Chance<'a> {
    /// Number of coordinates.
    pub(crate) coordinates: usize,
    /// Degrees of freedom of the noise law.
    pub(crate) freedom: f64,
    /// One standard deviation of the offset of each sweep, in coordinates.
    pub(crate) offsets: &'a [Vec<f64>],
    /// The standard deviation of the offsets \[N\].
    pub(crate) offset_n: f64,
    /// Distribution of their true standard deviation.
    pub(crate) beliefs: &'a [OffsetBelief],
}

impl Chance<'_> {
    /// Draws the misfit of a right model, in coordinates. The true noise may exceed its estimate, and offsets
    /// estimated from few sweeps may be much larger.
    pub(crate) fn draw(&self, random: &mut Random) -> Vec<f64> {
        let scale = noise_ratio(random, self.freedom);
        let mut z: Vec<f64> = (0..self.coordinates).map(|_| scale * random.normal()).collect();
        if self.offsets.is_empty() {
            return z;
        }
        let mut left = random.uniform();
        let drawn = self.beliefs.iter().find(|belief| {
            left -= belief.weight;
            left <= 0.0
        });
        let ratio = drawn.map_or(1.0, |belief| belief.sd_n / self.offset_n);
        let excess = (ratio * ratio - 1.0).max(0.0).sqrt();
        for offset in self.offsets {
            let size = excess * random.normal();
            add(&mut z, size, offset);
        }
        z
    }
}

/// Null distributions of both statistics, sorted.
#[derive(Debug, Clone)]
pub(crate) struct Null {
    screen: Vec<f64>,
    smooth: Vec<f64>,
}

impl Statistics {
    /// The statistics of coordinates z; `smooth` are orthonormal directions, the smoothest first.
    pub(crate) fn of(z: &[f64], candidates: &[Candidate], smooth: &[Vec<f64>]) -> Self {
        let score = |c: &Candidate| quantile(c.explains(z).gain, c.columns.len());
        Self {
            screen: candidates.iter().map(score).fold(f64::NEG_INFINITY, f64::max),
            smooth: adaptive(smooth.iter().map(|unit| dot(unit, z).powi(2))),
        }
    }
}

impl Null {
    /// The null distributions for the catalogue and the smooth functions.
    pub(crate) fn of(chance: &Chance<'_>, candidates: &[Candidate], smooth: &[Vec<f64>], seed: u64) -> Self {
        let drawn: Vec<Statistics> = (0..DRAWS.div_ceil(PER_STREAM))
            .into_par_iter()
            .flat_map_iter(|stream| {
                let mut random = Random::new(seed, stream as u64);
                (0..PER_STREAM)
                    .map(|_| Statistics::of(&chance.draw(&mut random), candidates, smooth))
                    .collect::<Vec<_>>()
            })
            .collect();
        let sorted = |of: &dyn Fn(&Statistics) -> f64| {
            let mut values: Vec<f64> = drawn.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        Self { screen: sorted(&|s| s.screen), smooth: sorted(&|s| s.smooth) }
    }

    /// p-values of the screen and of the smooth test.
    pub(crate) fn chance(&self, found: &Statistics) -> [f64; 2] {
        let part = |sorted: &[f64], value: f64| {
            let above = sorted.len() - sorted.partition_point(|v| *v < value);
            (above as f64 + 1.0) / (sorted.len() as f64 + 1.0)
        };
        [part(&self.screen, found.screen), part(&self.smooth, found.smooth)]
    }
}

/// The ratio of the true to the estimated standard deviation, by which z is too large; the inverse is
/// sqrt(chi^2/freedom).
pub(crate) fn noise_ratio(random: &mut Random, freedom: f64) -> f64 {
    let freedom = freedom.max(1.0);
    let part = 2.0 / (9.0 * freedom);
    (1.0 - part + random.normal() * part.sqrt()).max(0.05).powf(-1.5)
}

/// The normal quantile that corresponds to chi^2 with `freedom` degrees of freedom.
pub(crate) fn quantile(square: f64, freedom: usize) -> f64 {
    let k = freedom.max(1) as f64;
    let part = 2.0 / (9.0 * k);
    ((square.max(0.0) / k).cbrt() - (1.0 - part)) / part.sqrt()
}

fn adaptive(squares: impl Iterator<Item = f64>) -> f64 {
    let mut sum = 0.0;
    let mut most = f64::NEG_INFINITY;
    let mut count = 0_usize;
    let mut last = f64::NEG_INFINITY;
    for square in squares {
        sum += square;
        count += 1;
        let k = count as f64;
        last = (sum - k) / (2.0 * k).sqrt();
        if TOGETHER.contains(&count) {
            most = most.max(last);
        }
    }
    most.max(last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::sensitivity::{Sign, Size};

    fn axis(place: usize, sign: Sign) -> Candidate {
        let mut column = vec![0.0; 10];
        column[place] = 1.0;
        Candidate::for_test(
            vec![column],
            Size { place: 0, copy: 0, scale: 1.0, off: 0.0, sign, plausible: 3.0, secant: None },
        )
    }

    fn white(freedom: f64) -> Chance<'static> {
        Chance { coordinates: 10, freedom, offsets: &[], offset_n: 0.0, beliefs: &[] }
    }

    impl Null {
        /// The score of a single effect (squared sigmas) that chance exceeds somewhere in the catalogue with
        /// probability alpha.
        fn score_at(&self, alpha: f64) -> f64 {
            let place = ((1.0 - alpha) * (self.screen.len() - 1) as f64).round();
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a place in the list"
            )]
            let w = self.screen[place as usize];
            // Back from the quantile to chi^2 with one degree of freedom.
            (1.0 - 2.0 / 9.0 + w * (2.0_f64 / 9.0).sqrt()).max(0.0).powi(3)
        }
    }

    #[test]
    fn the_largest_of_ten_normal_numbers() {
        let candidates: Vec<Candidate> = (0..10).map(|i| axis(i, Sign::Any)).collect();
        let null = Null::of(&white(1e9), &candidates, &[], 1);
        // P(max z_i^2 < x) = erf(sqrt(x/2))^10: 95 % at x = 7.84.
        assert!((null.score_at(0.05) - 7.84).abs() < 0.6, "{}", null.score_at(0.05));
        // With one sign only, half as many exceed a score.
        let signed: Vec<Candidate> = (0..10).map(|i| axis(i, Sign::Positive)).collect();
        let one_sided = Null::of(&white(1e9), &signed, &[], 1).score_at(0.05);
        assert!((one_sided - 6.58).abs() < 0.6, "{one_sided}");
        // With poorly known noise the threshold is higher.
        assert!(Null::of(&white(8.0), &candidates, &[], 1).score_at(0.05) > 9.0);
    }

    #[test]
    fn chance_is_uniform_under_the_null() {
        let candidates: Vec<Candidate> = (0..4).map(|i| axis(i, Sign::Any)).collect();
        let smooth: Vec<Vec<f64>> = (0..6).map(|i| axis(i, Sign::Any).columns.remove(0)).collect();
        let null = Null::of(&white(60.0), &candidates, &smooth, 3);
        let mut random = Random::new(9, 0);
        let mut below = [0_usize; 2];
        for _ in 0..2000 {
            let scale = noise_ratio(&mut random, 60.0);
            let z: Vec<f64> = (0..10).map(|_| scale * random.normal()).collect();
            let chance = null.chance(&Statistics::of(&z, &candidates, &smooth));
            for (count, p) in below.iter_mut().zip(chance) {
                *count += usize::from(p < 0.1);
            }
        }
        // 200 expected, with a standard deviation of 13, and of 14 for the bootstrap itself.
        assert!(below.iter().all(|count| (130..=270).contains(count)), "{below:?}");
    }

    #[test]
    fn a_bump_among_the_smoothest_functions_is_seen() {
        let smooth: Vec<Vec<f64>> = (0..10).map(|i| axis(i, Sign::Any).columns.remove(0)).collect();
        let null = Null::of(&white(1e9), &[], &smooth, 5);
        let mut z = vec![0.7; 10];
        z[3] = 6.0;
        assert!(null.chance(&Statistics::of(&z, &[], &smooth))[1] < 0.01);
    }
}
