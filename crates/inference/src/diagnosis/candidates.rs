//! Candidates in the coordinates of the screen: what each effect could explain, alone and in pairs, and the
//! prior cost of assuming it.
//!
//! ```text
//! S_e = max over forms of |z|^2 - |z - s_e a|^2,    a of the sign that the effect can have
//! log evidence = S/2 + log prior(a) + (k/2) log 2 pi - (1/2) log |s's|
//! ```

use crate::diagnosis::sensitivity::{Sensitivities, Sensitivity, Sign, Size};
use crate::diagnosis::space::Space;
use bulge_numerics::vector::{add, dot, norm};

/// The prior of a size is uniform per decade from this fraction of the literature's scale
const SMALLEST: f64 = 1e-3;
/// up to this multiple of it; beyond, the density falls with the square.
const LARGEST: f64 = 3.0;
/// Most sign-constrained columns for which all combinations are tried.
const MOST_SIGNED: usize = 6;
/// A column counts as part of the model's own tangents if less than this fraction remains outside them.
const VISIBLE: f64 = 1e-4;

/// One form of an effect, in coordinates.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    /// Index of the effect.
    pub(crate) effect: usize,
    /// Index of its sensitivity.
    pub(crate) sensitivity: usize,
    pub(crate) columns: Vec<Vec<f64>>,
    pub(crate) sizes: Vec<Size>,
    pub(crate) whole: bool,
    /// Fraction of the column that the model's own parameters can compensate, c_e = 1 - |s_e|^2/|K^-1/2
    /// dF/dA|^2.
    pub(crate) compensated: f64,
    /// Log of the number of forms of the effect.
    log_forms: f64,
}

/// The part of the misfit that a set of columns explains.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Explained {
    /// Decrease of the squared misfit.
    pub(crate) gain: f64,
    /// Sizes as deviations from `off`; 0 if the sign constraint forbids one.
    pub(crate) sizes: Vec<f64>,
}

impl Candidate {
    /// All sensitivities in the coordinates of a space. `whiten` whitens a column and appends zeros for the
    /// priors.
    pub(crate) fn all(
        sensitivities: &Sensitivities,
        space: &mut Space,
        whiten: &dyn Fn(&[f64]) -> Vec<f64>,
    ) -> Vec<Self> {
        let forms =
            |effect: usize| sensitivities.sensitivities.iter().filter(|s| s.effect == effect).count() as f64;
        let mut all = Vec::with_capacity(sensitivities.sensitivities.len());
        let white: Vec<Vec<f64>> = sensitivities
            .sensitivities
            .iter()
            .flat_map(|s| s.columns.iter().map(|column| whiten(column)))
            .collect();
        let mut entered = space.enter_all(&white).into_iter();
        let mut white = white.into_iter();
        for (place, sensitivity) in sensitivities.sensitivities.iter().enumerate() {
            let Sensitivity { effect, sizes, columns, whole, .. } = sensitivity;
            let white: Vec<Vec<f64>> = white.by_ref().take(columns.len()).collect();
            let seen: Vec<Vec<f64>> = entered.by_ref().take(columns.len()).collect();
            let left: f64 = seen.iter().map(|c| dot(c, c)).sum();
            let all_of_it: f64 = white.iter().map(|c| dot(c, c)).sum();
            if left <= VISIBLE * VISIBLE * all_of_it {
                continue;
            }
            all.push(Self {
                effect: *effect,
                sensitivity: place,
                columns: seen,
                sizes: sizes.clone(),
                whole: *whole,
                compensated: 1.0 - left / all_of_it,
                log_forms: forms(*effect).ln(),
            });
        }
        all
    }

    /// The candidate in other coordinates.
    pub(crate) fn with_columns(&self, columns: Vec<Vec<f64>>) -> Self {
        Self { columns, ..self.clone() }
    }

    #[cfg(test)]
    pub(crate) fn for_test(columns: Vec<Vec<f64>>, size: Size) -> Self {
        let sizes = vec![size; columns.len()];
        Self { effect: 0, sensitivity: 0, columns, sizes, whole: false, compensated: 0.0, log_forms: 0.0 }
    }

    /// The part of z that the candidate explains alone.
    pub(crate) fn explains(&self, z: &[f64]) -> Explained {
        explained(&[self], z)
    }

    /// Log evidence relative to the model without it.
    pub(crate) fn log_evidence(&self, explained: &Explained) -> f64 {
        log_evidence(&[self], explained)
    }

    /// Detectability of a deviation `size` of its first parameter from `off`: its length in sigmas.
    pub(crate) fn detectability(&self, size: f64) -> f64 {
        self.columns.first().map_or(0.0, |column| size.abs() * norm(column))
    }
}

/// The part of z that several candidates explain together.
pub(crate) fn explained(together: &[&Candidate], z: &[f64]) -> Explained {
    let columns: Vec<&[f64]> = together.iter().flat_map(|c| c.columns.iter().map(Vec::as_slice)).collect();
    let signs: Vec<Sign> = together.iter().flat_map(|c| c.sizes.iter().map(|size| size.sign)).collect();
    let wholes: Vec<bool> = together.iter().flat_map(|c| c.columns.iter().map(|_| c.whole)).collect();
    if !wholes.contains(&true) {
        let (gain, sizes) = signed_least_squares(&columns, &signs, z);
        return Explained { gain, sizes };
    }
    // Effects without a free size are subtracted first.
    let mut left = z.to_vec();
    for (column, _) in columns.iter().zip(&wholes).filter(|(_, whole)| **whole) {
        left.resize(left.len().max(column.len()), 0.0);
        add(&mut left, -1.0, column);
    }
    let of = |whole: bool| (0..columns.len()).filter(move |i| wholes[*i] == whole).collect::<Vec<_>>();
    let others = of(false);
    let chosen: Vec<&[f64]> = others.iter().map(|i| columns[*i]).collect();
    let chosen_signs: Vec<Sign> = others.iter().map(|i| signs[*i]).collect();
    let (rest, found) = signed_least_squares(&chosen, &chosen_signs, &left);
    let mut sizes = vec![1.0; columns.len()];
    for (i, size) in others.iter().zip(found) {
        sizes[*i] = size;
    }
    Explained { gain: dot(z, z) - dot(&left, &left) + rest, sizes }
}

/// Log evidence of several candidates relative to the model without them.
pub(crate) fn log_evidence(together: &[&Candidate], explained: &Explained) -> f64 {
    let mut log = 0.5 * explained.gain;
    let mut active: Vec<&[f64]> = Vec::new();
    let mut place = 0;
    for candidate in together {
        log -= candidate.log_forms;
        for (column, size) in candidate.columns.iter().zip(&candidate.sizes) {
            let value = explained.sizes.get(place).copied().unwrap_or(0.0);
            place += 1;
            if candidate.whole || value == 0.0 {
                continue;
            }
            // A size below one standard deviation gets the density at one standard deviation, because the
            // prior has no peak at 0.
            let sd = 1.0 / norm(column).max(f64::MIN_POSITIVE);
            log += log_prior(size, value.abs().max(sd)) + 0.5 * std::f64::consts::TAU.ln();
            active.push(column);
        }
    }
    log - 0.5 * log_determinant(&active)
}

/// Log prior density of a deviation from `off`: uniform per decade on the scale of the literature, less
/// beyond it.
pub(crate) fn log_prior(size: &Size, deviation: f64) -> f64 {
    let decades = (LARGEST / SMALLEST).ln() + 0.5;
    let deviation = deviation.abs().max(SMALLEST * size.scale);
    let beyond =
        (LARGEST.max(size.plausible.min(1e3 * size.scale) / size.scale) * size.scale / deviation).min(1.0);
    let sides = if size.sign == Sign::Any { 2.0_f64 } else { 1.0 };
    -(deviation * decades * sides).ln() + 2.0 * beyond.ln()
}

fn log_determinant(columns: &[&[f64]]) -> f64 {
    let mut space = Space::without(&[]);
    columns
        .iter()
        .map(|column| {
            let whole = norm(column);
            let coordinates = space.enter(column);
            // The last coordinate is the part outside the earlier columns.
            let own = if coordinates.len() == space.len() {
                coordinates.last().map_or(0.0, |c| c.abs())
            } else {
                0.0
            };
            2.0 * own.max(1e-6 * whole).max(f64::MIN_POSITIVE).ln()
        })
        .sum()
}

/// Least squares with sign constraints: the decrease of |z|^2 and the coefficients.
fn signed_least_squares(columns: &[&[f64]], signs: &[Sign], z: &[f64]) -> (f64, Vec<f64>) {
    match columns {
        [] => (0.0, Vec::new()),
        [column] => {
            let square = dot(column, column);
            let along = dot(column, z);
            if square <= 0.0 || !may(signs[0], along) {
                return (0.0, vec![0.0]);
            }
            (along * along / square, vec![along / square])
        }
        _ => {
            let signed: Vec<usize> = (0..columns.len()).filter(|i| signs[*i] != Sign::Any).collect();
            let tried = signed.len().min(MOST_SIGNED);
            let mut best = (0.0, vec![0.0; columns.len()]);
            // Try all active sets of the constrained columns, starting with the full one.
            for out in 0..1_usize << tried {
                let is_in = |i: &usize| {
                    !signed.iter().take(tried).enumerate().any(|(bit, j)| j == i && out >> bit & 1 == 1)
                };
                let active: Vec<usize> = (0..columns.len()).filter(is_in).collect();
                let Some((gain, sizes)) = least_squares(columns, &active, z) else { continue };
                let allowed = sizes.iter().zip(signs).all(|(size, sign)| may(*sign, *size));
                if allowed && gain > best.0 {
                    best = (gain, sizes);
                    if out == 0 {
                        break;
                    }
                }
            }
            best
        }
    }
}

fn may(sign: Sign, value: f64) -> bool {
    match sign {
        Sign::Positive => value >= 0.0,
        Sign::Negative => value <= 0.0,
        Sign::Any => true,
    }
}

/// Least squares over some of the columns; none if they are linearly dependent.
fn least_squares(columns: &[&[f64]], active: &[usize], z: &[f64]) -> Option<(f64, Vec<f64>)> {
    let k = active.len();
    let scale: Vec<f64> = active.iter().map(|i| norm(columns[*i])).collect();
    if scale.iter().any(|s| *s <= 0.0) {
        return None;
    }
    let gram = nalgebra::DMatrix::from_fn(k, k, |i, j| {
        dot(columns[active[i]], columns[active[j]]) / (scale[i] * scale[j])
    });
    let along = nalgebra::DVector::from_fn(k, |i, _| dot(columns[active[i]], z) / scale[i]);
    let factor = gram.cholesky()?;
    if factor.l_dirty().diagonal().iter().any(|d| *d < 1e-6) {
        return None;
    }
    let solution = factor.solve(&along);
    let mut sizes = vec![0.0; columns.len()];
    for (place, i) in active.iter().enumerate() {
        sizes[*i] = solution[place] / scale[place];
    }
    Some((along.dot(&solution), sizes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_numerics::Random;

    fn size(sign: Sign) -> Size {
        Size { place: 0, copy: 0, scale: 1.0, off: 0.0, sign, plausible: 3.0, secant: None }
    }

    fn candidate(columns: &[&[f64]], sign: Sign, whole: bool) -> Candidate {
        let columns = columns.iter().map(|c| c.to_vec()).collect();
        Candidate { whole, ..Candidate::for_test(columns, size(sign)) }
    }

    #[track_caller]
    fn is(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found}");
    }

    /// The conditions of Karush, Kuhn and Tucker hold at the least squares with signs.
    #[test]
    fn least_squares_with_signs_is_a_minimum() {
        let mut random = Random::new(7, 0);
        for draw in 0..200 {
            let mut vector = || (0..8).map(|_| random.normal()).collect::<Vec<f64>>();
            let columns: Vec<Vec<f64>> = (0..4).map(|_| vector()).collect();
            let z = vector();
            let signs =
                [[Sign::Positive, Sign::Any, Sign::Negative, Sign::Positive], [Sign::Any; 4]][draw % 2];
            let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
            for many in 0..=4 {
                let (columns, signs) = (&columns[..many], &signs[..many]);
                let (gain, sizes) = signed_least_squares(columns, signs, &z);
                let mut left = z.clone();
                for (column, size) in columns.iter().zip(&sizes) {
                    add(&mut left, -size, column);
                }
                assert!((dot(&z, &z) - dot(&left, &left) - gain).abs() < 1e-9);
                for ((column, sign), size) in columns.iter().zip(signs).zip(&sizes) {
                    let slope = dot(column, &left);
                    assert!(may(*sign, *size));
                    // Where a sign keeps a coefficient at zero, only the other one would decrease the sum.
                    let held = size.abs() < 1e-12 && *sign != Sign::Any && !may(*sign, slope);
                    assert!(slope.abs() < 1e-9 || held, "{many}: {size} {slope}");
                }
            }
        }
    }

    #[test]
    fn an_effect_of_the_wrong_sign_explains_nothing() {
        let z = [-3.0, 1.0];
        is(candidate(&[&[1.0, 0.0]], Sign::Positive, false).explains(&z).gain, 0.0);
        is(candidate(&[&[1.0, 0.0]], Sign::Negative, false).explains(&z).gain, 9.0);
        let both = candidate(&[&[1.0, 0.0], &[0.0, 2.0]], Sign::Positive, false).explains(&z);
        assert_eq!((both.gain, both.sizes), (1.0, vec![0.0, 0.5]));
    }

    #[test]
    fn what_is_there_as_a_whole_is_there_once() {
        let whole = candidate(&[&[2.0, 0.0]], Sign::Positive, true);
        // |z|^2 - |z - s|^2 = 2 z.s - s.s
        is(whole.explains(&[5.0, 1.0]).gain, 16.0);
        is(whole.explains(&[0.5, 1.0]).gain, -2.0);
        let slope = candidate(&[&[0.0, 1.0]], Sign::Any, false);
        is(explained(&[&whole, &slope], &[5.0, 1.0]).gain, 17.0);
    }

    #[test]
    fn pairs_of_oblique_columns_explain_what_least_squares_does() {
        let (a, b) =
            (candidate(&[&[1.0, 0.0]], Sign::Any, false), candidate(&[&[1.0, 1.0]], Sign::Any, false));
        let found = explained(&[&a, &b], &[1.0, 3.0]);
        assert!((found.gain - 10.0).abs() < 1e-12);
        assert!((found.sizes[0] + 2.0).abs() < 1e-12 && (found.sizes[1] - 3.0).abs() < 1e-12);
    }

    #[test]
    fn evidence_is_the_integral_over_the_prior() {
        // One column s = 50: likelihood ratio exp(z s a - s^2 a^2/2), with the prior of a integrated by
        // quadrature.
        let one = candidate(&[&[50.0]], Sign::Any, false);
        let z = [8.0];
        let found = one.log_evidence(&one.explains(&z));
        let steps = 200_000;
        let width = 2.0 / f64::from(steps);
        let sum: f64 = (0..steps)
            .map(|i| -1.0 + (f64::from(i) + 0.5) * width)
            .map(|a| log_prior(&size(Sign::Any), a) + z[0] * 50.0 * a - 0.5 * (50.0 * a).powi(2))
            .map(f64::exp)
            .sum();
        assert!((found - (sum * width).ln()).abs() < 0.05, "{found} {}", (sum * width).ln());
    }

    #[test]
    fn the_prior_is_a_density() {
        // Positive sizes from 0 to infinity, with the substitution a = exp(t).
        let sum: f64 = (-200_000..200_000)
            .map(|i| f64::from(i) * 1e-4)
            .map(|t: f64| (log_prior(&size(Sign::Positive), t.exp()) + t).exp() * 1e-4)
            .sum();
        // Contributions: 1 up to 10^-3, then the decades, and 1/2 beyond 3.
        let expected = (1.0 + (LARGEST / SMALLEST).ln() + 0.5) / ((LARGEST / SMALLEST).ln() + 0.5);
        assert!((sum - expected).abs() < 1e-3, "{sum} {expected}");
    }
}
