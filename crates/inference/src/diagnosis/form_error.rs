//! How much the formulas of a model's effects are bent by the data, and what that is worth.
//!
//! ```text
//! y = F(theta) + B D c + noise,   c ~ N(0, 1),   D the standard deviations of the form errors by effect and kind
//! S = P K^-1/2 B,   z = P K^-1/2 (y - F),   M = 1 + D S'S D,   b = D S'z
//! ln Z_form = ln Z + b' M^-1 b/2 - ln|M|/2 + sum ln(prior(sd)/prior(0)),   chi^2_form = chi^2 - b' M^-1 b,   c = M^-1 b
//! ```
//! The standard deviations are those of the largest evidence, by coordinate ascent over a few levels. Where all are 0 the formulas are taken as exact.

use bulge_effects::Effect;
use nalgebra::{Cholesky, DMatrix, DVector};
use std::sync::Arc;

use crate::diagnosis::bending::{Bending, Kind};
use crate::diagnosis::space::{Space, norm};
use crate::dot::dot;

/// Standard deviations of a form error, as parts of the effect, and how likely each is before any data.
const LEVELS: [(f64, f64); 5] = [(0.0, 0.5), (0.05, 0.12), (0.1, 0.15), (0.2, 0.15), (0.4, 0.08)];
/// Times that each standard deviation is chosen anew beside the others.
const ROUNDS: usize = 2;
/// An effect that is bent by a larger part of it is another effect.
const MOST_BENT: f64 = 0.4;
/// A direction in which form errors move the readings by a smaller part of their variance says nothing.
const NOTHING: f64 = 0.01;

/// The form error of one effect.
#[derive(Debug, Clone)]
pub(crate) struct Bent {
    pub(crate) effect: Arc<dyn Effect>,
    /// Standard deviations by [`Kind`].
    pub(crate) sd: [f64; 4],
    /// How much of the effect is bent: |S c|/|K^-1/2 s|.
    pub(crate) part: f64,
}

/// The form errors of a model.
#[derive(Debug, Clone, Default)]
pub(crate) struct FormError {
    /// Log evidence over that of the exact formulas.
    pub(crate) log_evidence: f64,
    /// Fall of the square of the misfit.
    pub(crate) fall: f64,
    pub(crate) effects: Vec<Bent>,
}

/// A form error of one standard deviation in a principal direction.
#[derive(Debug, Clone)]
pub(crate) struct FormDirection {
    /// What it changes \[N\].
    pub(crate) values: Vec<f64>,
    /// The same whitened, outside of the model's tangents; those of several directions are orthogonal to each other.
    pub(crate) white: Vec<f64>,
}

/// All columns of a model, whitened and without what its numbers can do.
struct Columns {
    /// Place of the effect, kind.
    of: Vec<(usize, usize)>,
    gram: DMatrix<f64>,
    along: DVector<f64>,
}

impl Columns {
    /// Those whose standard deviations aren't 0, with these.
    fn chosen(&self, sds: &[[f64; 4]]) -> Vec<(usize, f64)> {
        let sd = |i: usize| sds[self.of[i].0][self.of[i].1];
        (0..self.of.len()).map(|i| (i, sd(i))).filter(|(_, sd)| *sd > 0.0).collect()
    }

    /// M, factored, and b.
    fn solved(&self, chosen: &[(usize, f64)]) -> Option<(Cholesky<f64, nalgebra::Dyn>, DVector<f64>)> {
        let k = chosen.len();
        let inner = DMatrix::from_fn(k, k, |i, j| {
            let ((a, sa), (b, sb)) = (chosen[i], chosen[j]);
            sa * sb * self.gram[(a, b)] + f64::from(u8::from(i == j))
        });
        let right = DVector::from_fn(k, |i, _| chosen[i].1 * self.along[chosen[i].0]);
        Some((inner.cholesky()?, right))
    }

    /// Log evidence, fall of the square of the misfit, and how much each effect is bent.
    fn evidence(&self, sds: &[[f64; 4]], lengths: &[f64]) -> Option<(f64, f64, Vec<f64>)> {
        let chosen = self.chosen(sds);
        let prior = |sd: f64| {
            LEVELS
                .iter()
                .find(|(level, _)| (level - sd).abs() < 1e-12)
                .map_or(0.0, |l| (l.1 / LEVELS[0].1).ln())
        };
        let mut log: f64 = sds.iter().flatten().map(|sd| prior(*sd)).sum();
        let (factor, right) = self.solved(&chosen)?;
        let c = factor.solve(&right);
        let fall = right.dot(&c);
        log += 0.5 * fall - factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let bent = |effect: usize| {
            let own: Vec<usize> = (0..chosen.len()).filter(|i| self.of[chosen[*i].0].0 == effect).collect();
            let pull = |i: usize| c[i] * chosen[i].1;
            let square: f64 = own
                .iter()
                .flat_map(|i| own.iter().map(move |j| (*i, *j)))
                .map(|(i, j)| pull(i) * pull(j) * self.gram[(chosen[i].0, chosen[j].0)])
                .sum();
            square.max(0.0).sqrt() / lengths[effect].max(f64::MIN_POSITIVE)
        };
        Some((log, fall, (0..lengths.len()).map(bent).collect()))
    }
}

impl FormError {
    /// Of the effects of a model with these columns; `space` is without the model's tangents, `misfit` whitened, `whiten` whitens a column \[N\].
    pub(crate) fn of(
        bendings: &[Bending],
        space: &Space,
        misfit: &[f64],
        whiten: &dyn Fn(&[f64]) -> Vec<f64>,
    ) -> (Self, Vec<FormDirection>) {
        let mut of = Vec::new();
        let mut white: Vec<Vec<f64>> = Vec::new();
        let mut raw: Vec<(&[f64], f64)> = Vec::new();
        let mut lengths = Vec::new();
        for (effect, bending) in bendings.iter().enumerate() {
            let length = norm(&whiten(&bending.change));
            lengths.push(length);
            for (kind, column) in &bending.columns {
                let mut seen = whiten(column);
                let scale =
                    if *kind == Kind::Kin { length / norm(&seen).max(f64::MIN_POSITIVE) } else { 1.0 };
                seen.iter_mut().for_each(|value| *value *= scale);
                of.push((effect, *kind as usize));
                raw.push((column, scale));
                white.push(space.outside(&seen));
            }
        }
        if white.is_empty() {
            return (Self::default(), Vec::new());
        }
        let left = space.outside(misfit);
        let gram =
            DMatrix::from_fn(
                white.len(),
                white.len(),
                |i, j| {
                    if i <= j { dot(&white[i], &white[j]) } else { 0.0 }
                },
            );
        let gram = DMatrix::from_fn(white.len(), white.len(), |i, j| gram[(i.min(j), i.max(j))]);
        let along = DVector::from_fn(white.len(), |i, _| dot(&white[i], &left));
        let columns = Columns { of, gram, along };
        let mut sds = vec![[0.0; 4]; bendings.len()];
        let mut best = (0.0, 0.0, vec![0.0; bendings.len()]);
        for _ in 0..ROUNDS {
            let before = sds.clone();
            for (effect, bending) in bendings.iter().enumerate() {
                let largest = bending.effect.card().form.largest_error();
                for kind in Kind::ALL {
                    if !columns.of.contains(&(effect, kind as usize)) {
                        continue;
                    }
                    let mut kept = sds[effect][kind as usize];
                    for (level, _) in LEVELS.iter().filter(|(level, _)| *level <= largest) {
                        sds[effect][kind as usize] = *level;
                        let Some(found) = columns.evidence(&sds, &lengths) else { continue };
                        if found.0 > best.0 && found.2.iter().all(|part| *part <= MOST_BENT) {
                            (best, kept) = (found, *level);
                        }
                    }
                    sds[effect][kind as usize] = kept;
                }
            }
            if sds == before {
                break;
            }
        }
        let (log_evidence, fall, parts) = best;
        let effects = bendings
            .iter()
            .zip(&sds)
            .zip(parts)
            .map(|((bending, sd), part)| Bent { effect: Arc::clone(&bending.effect), sd: *sd, part })
            .collect();
        (Self { log_evidence, fall, effects }, columns.directions(&white, &raw, &sds))
    }
}

impl Columns {
    /// The principal directions of the form errors: orthogonal, those that move the readings by less than the noise left out.
    fn directions(&self, white: &[Vec<f64>], raw: &[(&[f64], f64)], sds: &[[f64; 4]]) -> Vec<FormDirection> {
        let chosen = self.chosen(sds);
        let k = chosen.len();
        let inner =
            DMatrix::from_fn(k, k, |i, j| chosen[i].1 * chosen[j].1 * self.gram[(chosen[i].0, chosen[j].0)]);
        if k == 0 {
            return Vec::new();
        }
        let found = inner.symmetric_eigen();
        let seen = (0..k).filter(|j| found.eigenvalues[*j] > NOTHING);
        seen.map(|j| {
            let mut values = vec![0.0; raw[0].0.len()];
            let mut sum = vec![0.0; white[0].len()];
            for (place, (i, sd)) in chosen.iter().enumerate() {
                let part = sd * found.eigenvectors[(place, j)];
                add(&mut sum, part, &white[*i]);
                add(&mut values, part * raw[*i].1, raw[*i].0);
            }
            FormDirection { values, white: sum }
        })
        .collect()
    }
}

fn add(sum: &mut [f64], part: f64, column: &[f64]) {
    for (total, value) in sum.iter_mut().zip(column) {
        *total += part * value;
    }
}
