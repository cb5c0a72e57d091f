//! Size of the form errors of a model's effects, and the evidence for them.
//!
//! ```text
//! y = F(theta) + B D c + noise,   c ~ N(0, 1),   D the standard deviations of the form errors by effect and kind
//! S = P K^-1/2 B,   z = P K^-1/2 (y - F),   M = 1 + D S'S D,   b = D S'z
//! ln Z_form = ln Z + b' M^-1 b/2 - ln|M|/2 + sum ln(prior(sd)/prior(0)),   chi^2_form = chi^2 - b' M^-1 b,   c = M^-1 b
//! ```
//! The standard deviations maximise the evidence over a few levels, by coordinate ascent. If all are 0, the
//! formulas are taken as exact.

use bulge_effects::Effect;
use nalgebra::{Cholesky, DMatrix, DVector};
use std::sync::Arc;

use crate::diagnosis::bending::{Bending, Kin, Kind};
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::space::{Space, orthogonal};
use bulge_numerics::vector::{add, dot, norm};

/// Passes of the coordinate ascent.
const ROUNDS: usize = 2;
/// Log evidence that a form error may lose when a form is drawn. The largest of the equally likely levels is
/// taken, so that the interval covers what the data leave open.
const AS_LIKELY: f64 = 1.0;
/// A direction in which form errors move the readings by less than this fraction of their variance is
/// negligible.
const NOTHING: f64 = 0.01;

/// The form error of one effect.
#[derive(Debug, Clone)]
pub(crate) struct Bent {
    pub(crate) effect: Arc<dyn Effect>,
    /// Standard deviations by [`Kind`].
    pub(crate) sd: [f64; 4],
    /// Relative size of the form error: |S c|/|K^-1/2 s|.
    pub(crate) part: f64,
    /// Change of the force by the effect's formula \[N\].
    pub(crate) change: Vec<f64>,
    /// Change of the model's force by the form error \[N\], with all parameters refitted, and its standard
    /// deviation.
    pub(crate) bending: Vec<f64>,
    pub(crate) bending_sd: Vec<f64>,
    /// Change of the force by the effect with its form error \[N\], and its standard deviation including that
    /// of its parameters.
    pub(crate) drawn: Vec<f64>,
    pub(crate) drawn_sd: Vec<f64>,
}

impl Bent {
    /// Whether any of its form errors has a standard deviation above 0.
    pub(crate) fn may_bend(&self) -> bool {
        self.sd.iter().any(|sd| *sd > 0.0)
    }
}

/// The form errors of a model.
#[derive(Debug, Clone, Default)]
pub(crate) struct FormError {
    /// Log evidence relative to the exact formulas.
    pub(crate) log_evidence: f64,
    /// Decrease of the squared misfit.
    pub(crate) fall: f64,
    pub(crate) effects: Vec<Bent>,
    /// Columns of kin, for models with the same effects.
    pub(crate) kin: Kin,
}

/// A form error of one standard deviation in a principal direction.
#[derive(Debug, Clone)]
pub(crate) struct FormDirection {
    /// Its change of each effect \[N\].
    by_effect: Vec<Vec<f64>>,
    /// Its change of the force \[N\].
    pub(crate) values: Vec<f64>,
    /// The same, whitened and outside the model's tangents. Different directions are orthogonal to each
    /// other.
    pub(crate) white: Vec<f64>,
}

impl FormDirection {
    /// Whether it moves the readings by more than a small fraction of the noise.
    pub(crate) fn is_seen(&self) -> bool {
        dot(&self.white, &self.white) > NOTHING
    }
}

/// All columns of a model, whitened and orthogonalised against its tangents.
struct Columns {
    /// Index of the effect, and kind.
    of: Vec<(usize, usize)>,
    gram: DMatrix<f64>,
    along: DVector<f64>,
    /// Gram matrix of the columns in newtons.
    raw_gram: DMatrix<f64>,
    /// Norms of the effects, whitened and in newtons.
    lengths: Vec<[f64; 2]>,
    /// Levels of the standard deviation, with their prior probabilities.
    levels: &'static [(f64, f64)],
}

impl Columns {
    /// Columns with a nonzero standard deviation, with that standard deviation.
    fn chosen(&self, sds: &[[f64; 4]]) -> Vec<(usize, f64)> {
        let sd = |i: usize| sds[self.of[i].0][self.of[i].1];
        (0..self.of.len()).map(|i| (i, sd(i))).filter(|(_, sd)| *sd > 0.0).collect()
    }

    /// The Cholesky factor of M, and b.
    fn solved(&self, chosen: &[(usize, f64)]) -> Option<(Cholesky<f64, nalgebra::Dyn>, DVector<f64>)> {
        let k = chosen.len();
        let inner = DMatrix::from_fn(k, k, |i, j| {
            let ((a, sa), (b, sb)) = (chosen[i], chosen[j]);
            sa * sb * self.gram[(a, b)] + f64::from(u8::from(i == j))
        });
        let right = DVector::from_fn(k, |i, _| chosen[i].1 * self.along[chosen[i].0]);
        Some((inner.cholesky()?, right))
    }

    /// Log evidence, decrease of the squared misfit, and relative form error of each effect; none if one of
    /// them is larger than allowed.
    fn evidence(&self, sds: &[[f64; 4]]) -> Option<(f64, f64, Vec<f64>)> {
        let chosen = self.chosen(sds);
        let prior = |sd: f64| {
            let level = self.levels.iter().find(|(level, _)| (level - sd).abs() < 1e-12);
            level.map_or(0.0, |level| (level.1 / self.levels[0].1).ln())
        };
        let mut log: f64 = sds.iter().flatten().map(|sd| prior(*sd)).sum();
        let (factor, right) = self.solved(&chosen)?;
        let c = factor.solve(&right);
        let fall = right.dot(&c);
        log += 0.5 * fall - factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let bent = |effect: usize, gram: &DMatrix<f64>| {
            let own: Vec<usize> = (0..chosen.len()).filter(|i| self.of[chosen[*i].0].0 == effect).collect();
            let pull = |i: usize| c[i] * chosen[i].1;
            let square: f64 = own
                .iter()
                .flat_map(|i| own.iter().map(move |j| (*i, *j)))
                .map(|(i, j)| pull(i) * pull(j) * gram[(chosen[i].0, chosen[j].0)])
                .sum();
            square.max(0.0).sqrt()
        };
        let parts = |gram: &DMatrix<f64>, of: usize| -> Vec<f64> {
            let part = |effect: usize| bent(effect, gram) / self.lengths[effect][of].max(f64::MIN_POSITIVE);
            (0..self.lengths.len()).map(part).collect()
        };
        let seen = parts(&self.gram, 0);
        let is_itself = |parts: &[f64], most: f64| parts.iter().all(|part| *part <= most);
        let allowed =
            is_itself(&seen, RULE.most_bent) && is_itself(&parts(&self.raw_gram, 1), RULE.most_bent_newtons);
        allowed.then_some((log, fall, seen))
    }

    /// Standard deviations by effect and kind that maximise the evidence, and the result of
    /// [`Columns::evidence`] for them. If forms are drawn, the largest equally likely ones.
    fn likeliest(&self, bendings: &[Bending], to_draw: bool) -> (Vec<[f64; 4]>, (f64, f64, Vec<f64>)) {
        let levels_of = |effect: &Arc<dyn Effect>| {
            let largest = effect.card().form.largest_error() * if to_draw { RULE.drawn } else { 1.0 };
            self.levels.iter().map(|(level, _)| *level).filter(move |level| *level <= largest)
        };
        let mut sds = vec![[0.0; 4]; bendings.len()];
        let mut best = (0.0, 0.0, vec![0.0; bendings.len()]);
        // Coordinate ascent, one standard deviation at a time, in at most `ROUNDS` rounds.
        for _ in 0..ROUNDS {
            let before = sds.clone();
            for (effect, bending) in bendings.iter().enumerate() {
                for kind in Kind::ALL {
                    if !self.of.contains(&(effect, kind as usize)) {
                        continue;
                    }
                    let mut kept = sds[effect][kind as usize];
                    for level in levels_of(&bending.effect) {
                        sds[effect][kind as usize] = level;
                        let Some(found) = self.evidence(&sds) else { continue };
                        if found.0 > best.0 {
                            (best, kept) = (found, level);
                        }
                    }
                    sds[effect][kind as usize] = kept;
                }
            }
            if sds == before {
                break;
            }
        }
        // Raises each standard deviation as long as the evidence stays within `AS_LIKELY` of the best.
        if to_draw {
            let likeliest = best.0;
            for (effect, bending) in bendings.iter().enumerate() {
                for kind in Kind::ALL.map(|kind| kind as usize) {
                    let chosen = sds[effect][kind];
                    for level in levels_of(&bending.effect).filter(|level| chosen > 0.0 && *level > chosen) {
                        let before = std::mem::replace(&mut sds[effect][kind], level);
                        match self.evidence(&sds).filter(|found| found.0 > likeliest - AS_LIKELY) {
                            // The evidence stays that of the likeliest.
                            Some((_, fall, parts)) => best = (likeliest, fall, parts),
                            None => sds[effect][kind] = before,
                        }
                    }
                }
            }
        }
        (sds, best)
    }
}

/// Gram matrix of some columns.
fn gram(columns: &[&[f64]]) -> DMatrix<f64> {
    let half = DMatrix::from_fn(columns.len(), columns.len(), |i, j| {
        if i <= j { dot(columns[i], columns[j]) } else { 0.0 }
    });
    DMatrix::from_fn(columns.len(), columns.len(), |i, j| half[(i.min(j), i.max(j))])
}

impl FormError {
    /// Form errors of the effects of a model with these columns, for comparison with other models or, if
    /// `to_draw`, for drawing their forms. `space` excludes the model's tangents, `misfit` is whitened, and
    /// `whiten` whitens a column \[N\].
    pub(crate) fn of(
        bendings: &[Bending],
        space: &Space,
        misfit: &[f64],
        whiten: &dyn Fn(&[f64]) -> Vec<f64>,
        to_draw: bool,
    ) -> (Self, Vec<FormDirection>) {
        let mut of = Vec::new();
        let mut white: Vec<Vec<f64>> = Vec::new();
        let mut raw: Vec<(&[f64], f64)> = Vec::new();
        let mut lengths = Vec::new();
        for (effect, bending) in bendings.iter().enumerate() {
            let length = norm(&whiten(&bending.change));
            lengths.push([length, norm(&bending.change)]);
            for (kind, column) in &bending.columns {
                let mut seen = whiten(column);
                // A column of kind `Kin` is scaled to the length of the effect's own change.
                let scale =
                    if *kind == Kind::Kin { length / norm(&seen).max(f64::MIN_POSITIVE) } else { 1.0 };
                for value in &mut seen {
                    *value *= scale;
                }
                of.push((effect, *kind as usize));
                raw.push((column, scale));
                white.push(space.outside(&seen));
            }
        }
        if white.is_empty() {
            return (Self::default(), Vec::new());
        }
        let left = space.outside(misfit);
        let scaled: Vec<Vec<f64>> =
            raw.iter().map(|(column, scale)| column.iter().map(|v| v * scale).collect()).collect();
        let raw_gram = gram(&scaled.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let gram = gram(&white.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let along = DVector::from_fn(white.len(), |i, _| dot(&white[i], &left));
        let levels: &[(f64, f64)] = if to_draw { &RULE.drawn_errors } else { &RULE.form_errors };
        let columns = Columns { of, gram, along, raw_gram, lengths, levels };
        let (sds, best) = columns.likeliest(bendings, to_draw);
        let (log_evidence, fall, parts) = best;
        let effects = bendings.iter().zip(&sds).zip(parts);
        let directions = columns.directions(&white, &raw, &sds);
        let effects = effects
            .map(|((bending, sd), part)| {
                let (effect, change) = (Arc::clone(&bending.effect), bending.change.clone());
                let [bending, bending_sd, drawn, drawn_sd] = [const { Vec::new() }; 4];
                Bent { effect, sd: *sd, part, change, bending, bending_sd, drawn, drawn_sd }
            })
            .collect();
        let kin = |bending: &Bending| (bending.effect.card().name.to_owned(), Arc::clone(&bending.kin));
        let kin = bendings.iter().map(kin).collect();
        (Self { log_evidence, fall, effects, kin }, directions)
    }

    /// Adds the fitted form errors row by row. `misfit` is whitened, `tangents` are those of the model's
    /// parameters, and `owner` names the effect that each belongs to.
    pub(crate) fn row_by_row(
        mut self,
        directions: &[FormDirection],
        misfit: &[f64],
        tangents: &[(Vec<f64>, Vec<f64>)],
        owner: &[&str],
        whiten: &dyn Fn(&[f64]) -> Vec<f64>,
    ) -> Self {
        let of = |name: Option<&str>| {
            let mut known: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
            for ((raw, white), owner) in tangents.iter().zip(owner) {
                let counts = name.is_none_or(|name| name == *owner);
                let raw = if counts { raw.clone() } else { vec![0.0; raw.len()] };
                known.extend(orthogonal(raw, white.clone(), &known));
            }
            known
        };
        let all = of(None);
        for (place, effect) in self.effects.iter_mut().enumerate().filter(|(_, effect)| effect.may_bend()) {
            let own = of(Some(effect.effect.card().name));
            let sums = |values: &mut dyn FnMut(&FormDirection) -> Vec<f64>| sums(directions, misfit, values);
            (effect.bending, effect.bending_sd) = sums(&mut |direction| {
                let values = &direction.by_effect[place];
                without(values, &whiten(values), &all)
            });
            // The parameters of the effect are refitted to the form errors of all effects.
            let (moved, mut sd) =
                sums(&mut |direction| without(&direction.by_effect[place], &whiten(&direction.values), &own));
            for (row, sd) in sd.iter_mut().enumerate() {
                let of_numbers: f64 = own.iter().map(|(raw, _)| raw[row] * raw[row]).sum();
                *sd = (*sd * *sd + of_numbers).sqrt();
            }
            effect.drawn = effect.change.iter().zip(&moved).map(|(change, moved)| change + moved).collect();
            effect.drawn_sd = sd;
        }
        self
    }

    /// Drops the results row by row.
    pub(crate) fn in_short(mut self) -> Self {
        for effect in &mut self.effects {
            let rows = [&mut effect.change, &mut effect.bending, &mut effect.bending_sd];
            for values in rows.into_iter().chain([&mut effect.drawn, &mut effect.drawn_sd]) {
                *values = Vec::new();
            }
        }
        self
    }
}

/// The column after refitting the parameters; `known` are their orthonormal columns, in newtons and whitened.
fn without(values: &[f64], white: &[f64], known: &[(Vec<f64>, Vec<f64>)]) -> Vec<f64> {
    let mut left = values.to_vec();
    for (raw, unit) in known {
        add(&mut left, -dot(white, unit), raw);
    }
    left
}

/// Sum of the fitted directions row by row, and its standard deviation. Their coordinates are independent: c
/// = t'z/(1 + |t|^2) with the variance 1/(1 + |t|^2). `values` gives the change of the force by a direction
/// \[N\].
fn sums(
    directions: &[FormDirection],
    misfit: &[f64],
    values: &mut dyn FnMut(&FormDirection) -> Vec<f64>,
) -> (Vec<f64>, Vec<f64>) {
    let rows = directions.first().map_or(0, |direction| direction.values.len());
    let (mut sum, mut square) = (vec![0.0; rows], vec![0.0; rows]);
    for direction in directions {
        let own = 1.0 + dot(&direction.white, &direction.white);
        let c = dot(&direction.white, misfit) / own;
        for ((sum, square), value) in sum.iter_mut().zip(&mut square).zip(&values(direction)) {
            *sum += c * value;
            *square += value * value / own;
        }
    }
    (sum, square.into_iter().map(f64::sqrt).collect())
}

impl Columns {
    /// The orthogonal principal directions of the form errors.
    fn directions(&self, white: &[Vec<f64>], raw: &[(&[f64], f64)], sds: &[[f64; 4]]) -> Vec<FormDirection> {
        let chosen = self.chosen(sds);
        let k = chosen.len();
        let inner =
            DMatrix::from_fn(k, k, |i, j| chosen[i].1 * chosen[j].1 * self.gram[(chosen[i].0, chosen[j].0)]);
        if k == 0 {
            return Vec::new();
        }
        let found = inner.symmetric_eigen();
        let direction = |j: usize| {
            let mut values = vec![0.0; raw[0].0.len()];
            let mut by_effect = vec![vec![0.0; values.len()]; sds.len()];
            let mut sum = vec![0.0; white[0].len()];
            for (place, (i, sd)) in chosen.iter().enumerate() {
                let part = sd * found.eigenvectors[(place, j)];
                add(&mut sum, part, &white[*i]);
                add(&mut values, part * raw[*i].1, raw[*i].0);
                add(&mut by_effect[self.of[*i].0], part * raw[*i].1, raw[*i].0);
            }
            FormDirection { by_effect, values, white: sum }
        };
        (0..k).map(direction).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Catalogue;
    use bulge_numerics::Random;

    const ROWS: usize = 60;

    fn columns(seed: u64, count: usize) -> Vec<Vec<f64>> {
        let mut random = Random::new(seed, 0);
        (0..count).map(|_| (0..ROWS).map(|_| random.normal()).collect()).collect()
    }

    fn bending(name: &str, kinds: &[Kind], seed: u64, size: f64) -> Bending {
        let effect = Arc::clone(Catalogue::builtin().find(name).unwrap());
        let change: Vec<f64> = columns(seed + 100, 1).remove(0).iter().map(|v| size * v).collect();
        let made = columns(seed, kinds.len());
        let own = kinds.iter().zip(made);
        let columns = own.map(|(kind, c)| (*kind, c.iter().map(|v| 0.5 * size * v).collect())).collect();
        Bending { effect, change, columns, kin: Arc::default() }
    }

    /// ln N(z; 0, 1 + B D^2 B') - ln N(z; 0, 1) outside the tangents, from the dense matrix.
    fn dense(white: &[Vec<f64>], sds: &[f64], z: &[f64]) -> f64 {
        let n = z.len();
        let covariance = DMatrix::from_fn(n, n, |i, j| {
            let sum: f64 = white.iter().zip(sds).map(|(c, sd)| sd * sd * c[i] * c[j]).sum();
            sum + f64::from(u8::from(i == j))
        });
        let factor = covariance.cholesky().unwrap();
        let z = DVector::from_column_slice(z);
        let log_determinant = 2.0 * factor.l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        0.5 * (z.dot(&z) - z.dot(&factor.solve(&z))) - 0.5 * log_determinant
    }

    #[test]
    fn evidence_and_fall_are_those_of_the_dense_covariance() {
        let tangents = columns(1, 3);
        let space = Space::without(&tangents);
        let bent = bending("coulomb-friction", &[Kind::State, Kind::State, Kind::Turn], 5, 30.0);
        // Form errors in the first and the third column, plus noise.
        let mut misfit = columns(9, 1).remove(0);
        for ((value, a), c) in misfit.iter_mut().zip(&bent.columns[0].1).zip(&bent.columns[2].1) {
            *value += 0.2 * a - 0.15 * c;
        }
        let same = |column: &[f64]| column.to_vec();
        let (found, directions) = FormError::of(std::slice::from_ref(&bent), &space, &misfit, &same, false);
        let sd = found.effects[0].sd;
        assert!(sd[Kind::State as usize] > 0.0 && sd[Kind::Turn as usize] > 0.0, "{sd:?}");
        let white: Vec<Vec<f64>> = bent.columns.iter().map(|(_, c)| space.outside(c)).collect();
        let own: Vec<f64> = bent.columns.iter().map(|(kind, _)| sd[*kind as usize]).collect();
        let prior = |sd: f64| {
            (RULE.form_errors.iter().find(|level| (level.0 - sd).abs() < 1e-12).unwrap().1 / 0.5).ln()
        };
        let expected =
            dense(&white, &own, &space.outside(&misfit)) + sd.iter().map(|sd| prior(*sd)).sum::<f64>();
        assert!((found.log_evidence - expected).abs() < 1e-9, "{} {expected}", found.log_evidence);
        // No other levels are more likely.
        for state in RULE.form_errors {
            for turn in RULE.form_errors {
                let own: Vec<f64> = bent
                    .columns
                    .iter()
                    .map(|(kind, _)| if *kind == Kind::State { state.0 } else { turn.0 })
                    .collect();
                let other = dense(&white, &own, &space.outside(&misfit)) + prior(state.0) + prior(turn.0);
                assert!(other <= expected + 1e-9 || found.effects[0].part > 0.3, "{state:?} {turn:?}");
            }
        }
        // As additional tangents, the directions remove what the form errors explain.
        let whole: f64 = dot(&space.outside(&misfit), &space.outside(&misfit));
        let mut beside = space.clone();
        beside.leave_out(&directions.iter().map(|d| &d.white[..]).collect::<Vec<_>>());
        let mut longer = misfit.clone();
        longer.resize(ROWS + directions.len(), 0.0);
        let left = beside.outside(&longer);
        assert!((whole - dot(&left, &left) - found.fall).abs() < 1e-6 * found.fall, "{}", found.fall);
        assert!(found.effects[0].part > 0.05 && found.effects[0].part < RULE.most_bent);
    }

    #[test]
    fn a_formula_that_holds_is_not_bent_and_an_exact_one_never() {
        let space = Space::without(&columns(1, 3));
        let same = |column: &[f64]| column.to_vec();
        let noise = columns(9, 1).remove(0);
        let loose = bending("coulomb-friction", &[Kind::State, Kind::Turn, Kind::Kin], 5, 30.0);
        let (found, directions) = FormError::of(std::slice::from_ref(&loose), &space, &noise, &same, false);
        assert!(found.log_evidence.abs() < 1e-12 && found.fall.abs() < 1e-12 && directions.is_empty());
        let mut misfit = noise;
        add(&mut misfit, 0.3, &loose.columns[0].1);
        let exact =
            Bending { effect: Arc::clone(Catalogue::builtin().find("length-zero-error").unwrap()), ..loose };
        let (found, directions) = FormError::of(&[exact], &space, &misfit, &same, false);
        assert!(found.log_evidence.abs() < 1e-12 && directions.is_empty());
    }

    #[test]
    fn what_is_bent_by_more_than_its_part_is_another_effect() {
        let space = Space::without(&[]);
        let same = |column: &[f64]| column.to_vec();
        let loose = bending("coulomb-friction", &[Kind::State], 5, 30.0);
        let mut misfit = columns(9, 1).remove(0);
        add(&mut misfit, 2.0, &loose.columns[0].1);
        let (found, _) = FormError::of(&[loose], &space, &misfit, &same, false);
        assert!(found.effects[0].part <= RULE.most_bent && !found.effects[0].may_bend());
    }

    #[test]
    fn the_bending_is_drawn_as_it_is_and_without_what_the_numbers_can_do() {
        let raw = columns(1, 1).remove(0);
        let length = norm(&raw);
        let unit: Vec<f64> = raw.iter().map(|v| v / length).collect();
        let space = Space::without(std::slice::from_ref(&raw));
        let same = |column: &[f64]| column.to_vec();
        let loose = bending("coulomb-friction", &[Kind::State], 5, 300.0);
        let column = loose.columns[0].1.clone();
        let mut misfit = columns(9, 1).remove(0);
        for ((value, c), t) in misfit.iter_mut().zip(&column).zip(&raw) {
            *value += 0.1 * c + 7.0 * t;
        }
        let (found, directions) = FormError::of(&[loose], &space, &misfit, &same, false);
        let found =
            found.row_by_row(&directions, &misfit, &[(unit.clone(), unit.clone())], &["another"], &same);
        let expected = space.outside(&column);
        let bent = &found.effects[0];
        for ((b, e), sd) in bent.bending.iter().zip(&expected).zip(&bent.bending_sd) {
            // 0.1 within the standard deviation of one parameter, 1/|column|.
            assert!((b - 0.1 * e).abs() < 4.0 * e.abs() / norm(&expected) + 1e-9, "{b} {e}");
            let level = bent.sd[Kind::State as usize];
            let exact = level * e.abs() / (1.0 + (level * norm(&expected)).powi(2)).sqrt();
            assert!((sd - exact).abs() < 1e-9 * exact + 1e-12, "{sd} {exact}");
        }
    }

    #[test]
    fn the_drawn_form_and_its_interval_are_those_of_all_numbers_and_form_errors_together() {
        let same = |column: &[f64]| column.to_vec();
        let tangents: Vec<(Vec<f64>, Vec<f64>)> = columns(1, 3).into_iter().map(|c| (c.clone(), c)).collect();
        let owner = ["coulomb-friction", "another", "coulomb-friction"];
        let space = Space::without(&tangents.iter().map(|(_, white)| white.clone()).collect::<Vec<_>>());
        let loose = bending("coulomb-friction", &[Kind::State, Kind::State, Kind::Turn], 5, 300.0);
        let mut misfit = columns(9, 1).remove(0);
        for ((value, a), c) in misfit.iter_mut().zip(&loose.columns[0].1).zip(&loose.columns[2].1) {
            *value += 0.1 * a - 0.07 * c;
        }
        // The parameters are fitted.
        let misfit = space.outside(&misfit);
        let own: Vec<Vec<f64>> = loose.columns.iter().map(|(_, column)| column.clone()).collect();
        let (found, directions) = FormError::of(&[loose], &space, &misfit, &same, false);
        let found = found.row_by_row(&directions, &misfit, &tangents, &owner, &same);
        let bent = &found.effects[0];
        let levels = [Kind::State, Kind::State, Kind::Turn].map(|kind| bent.sd[kind as usize]);
        let all = DMatrix::from_fn(ROWS, 6, |i, j| if j < 3 { tangents[j].0[i] } else { own[j - 3][i] });
        let mut precision = all.transpose() * &all;
        for (place, level) in levels.iter().enumerate() {
            precision[(3 + place, 3 + place)] += level.powi(-2);
        }
        let covariance = precision.try_inverse().unwrap();
        let mean = &covariance * all.transpose() * DVector::from_column_slice(&misfit);
        for row in 0..ROWS {
            let shown = DVector::from_fn(6, |j, _| if j == 1 { 0.0 } else { all[(row, j)] });
            let drawn = bent.change[row] + shown.dot(&mean);
            let sd = shown.dot(&(&covariance * &shown)).sqrt();
            assert!((bent.drawn[row] - drawn).abs() < 1e-7 * (1.0 + drawn.abs()), "{row}: {drawn}");
            assert!(
                (bent.drawn_sd[row] - sd).abs() < 1e-7 * (1.0 + sd),
                "{row}: {sd} {}",
                bent.drawn_sd[row]
            );
        }
    }
}
