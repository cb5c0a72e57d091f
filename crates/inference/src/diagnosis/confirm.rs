//! Fits of hypotheses with the full model instead of its linear approximation: bounded, whitened, from
//! several starts, with a convergence certificate and the evidence.
//!
//! ```text
//! log Z = -chi^2/2 + log prior + (k/2) log 2 pi - (1/2) log |H|        (Laplace),   H = J' J + the curvature of the priors
//! ```

use bulge_effects::Effect;
use bulge_model::{Model, ModelError, Record};
use bulge_numerics::least_squares::{Bounds, Linearisation, Minimum, Options, Reason};
use rayon::prelude::*;
use std::sync::Arc;

use crate::diagnosis::candidates::log_prior;
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::form_error::FormError;
use crate::diagnosis::linearised_model::Context;
use crate::diagnosis::sensitivity::{Sensitivity, Sign, Size, longest_sweep, relaxes, sizes};
use crate::fit::carry_over::carry_over;
use crate::fit::frozen::{NEAR, minimise_frozen, minimise_solved, solved};
use crate::fit::nuisance::{Prepared, with_nuisances};
use crate::fit::problem::{FitProblem, free};
use crate::fit::states::{is_of_rows, minimise_partly, of_start};

/// Tolerance of the fits relative to the residuals. No step promises more than its square, 1e-7, of the sum
/// of squares, and evidence counts in hundredths. In the flat valleys of effects that do nearly the same, a
/// tolerance a hundred times smaller took five times as long.
const TOLERANCE: f64 = 3e-4;
const EVALUATIONS: usize = 50;
/// Rows on which a start is sought from which all rows have a state; rows without one take the longest to
/// solve.
const FEW_ROWS: usize = 300;
/// Number of starts that are followed to their minimum.
const FOLLOWED: usize = 2;

/// A model with its effects at their best parameters.
#[derive(Debug, Clone)]
pub(crate) struct Confirmed {
    pub(crate) prepared: Prepared,
    pub(crate) theta: Vec<f64>,
    pub(crate) minimum: Minimum,
    /// Log evidence, up to a constant of the data, including that of the form errors.
    pub(crate) log_evidence: f64,
    /// The penalty for implausible parameters that it includes.
    pub(crate) penalty: f64,
    /// Form errors of its effects.
    pub(crate) form: FormError,
    /// Whether the best search ended in a minimum.
    pub(crate) converged: bool,
}

impl Confirmed {
    /// The model and its parameters, as a start for other fits.
    pub(crate) fn numbers(&self) -> (&Model, &[f64]) {
        (&self.prepared.model, &self.theta)
    }

    /// Whether these effects have an absurd parameter: at the end of the searched range and beyond the
    /// plausible one, or a relaxation that takes longer than any sweep of the record. The latter acts as a
    /// spring and would only stand in for one. Such a fit explains nothing.
    pub(crate) fn is_absurd(&self, effects: &[Arc<dyn Effect>], record: &Record) -> bool {
        let model = &self.prepared.model;
        let longest = longest_sweep(record);
        free(model).into_iter().zip(&self.minimum.certificate.at_bound).any(|(index, at_bound)| {
            let (p, value) = (&model.parameters()[index], self.theta[index]);
            let Some(effect) = effects.iter().find(|effect| effect.card().name == p.effect) else {
                return false;
            };
            p.name == "time" && relaxes(effect, record) && value > longest
                || at_bound.is_some() && !(p.plausible.0..=p.plausible.1).contains(&value)
        })
    }

    /// Whether all sizes of these effects are off, so that the model equals the one without them.
    pub(crate) fn is_idle(&self, effects: &[Arc<dyn Effect>]) -> bool {
        let model = &self.prepared.model;
        let roles = roles(model);
        let mut sizes = (0..self.theta.len())
            .filter_map(|i| {
                let is_of = |effect: &Arc<dyn Effect>| effect.card().name == model.parameters()[i].effect;
                roles[i].filter(|_| effects.iter().any(is_of)).map(|size| (i, size))
            })
            .peekable();
        sizes.peek().is_some() && sizes.all(|(i, size)| (self.theta[i] - size.off).abs() <= 0.0)
    }

    /// The sum of squares of whitened residuals and priors.
    pub(crate) fn cost(&self) -> f64 {
        self.minimum.cost
    }

    /// The same, reduced by what the form errors explain.
    pub(crate) fn bent_cost(&self) -> f64 {
        self.minimum.cost - self.form.fall
    }
}

impl Context<'_> {
    /// Fits a base model with further effects. Each of `starts` has the parameters of the effects in order.
    pub(crate) fn confirm(
        &self,
        base: &Model,
        effects: &[Arc<dyn Effect>],
        from: Option<(&Model, &[f64])>,
        starts: &[Vec<f64>],
    ) -> Result<Confirmed, ModelError> {
        let model = effects.iter().try_fold(base.clone(), |model, effect| model.with(effect, None))?;
        let prepared = with_nuisances(&model, self.catalogue)?;
        let mut first = prepared.start();
        if let Some((model, numbers)) = from {
            carry_over(model, numbers, &prepared.model, &mut first);
        }
        let own: usize = base.parameters().len();
        let all: usize = model.parameters().len() - own;
        let mut thetas: Vec<Vec<f64>> = starts
            .iter()
            .filter(|values| values.len() == all)
            .map(|values| {
                let mut theta = first.clone();
                theta[own..own + all].copy_from_slice(values);
                theta
            })
            .collect();
        if thetas.is_empty() {
            thetas.push(first);
        }
        let numbers = prepared.model.parameters();
        for theta in &mut thetas {
            theta.iter_mut().zip(numbers).for_each(|(value, p)| *value = value.clamp(p.low, p.high));
        }
        // Clamping to the bounds may have made starts equal.
        let mut different: Vec<Vec<f64>> = Vec::new();
        for theta in thetas {
            if !different.contains(&theta) {
                different.push(theta);
            }
        }
        self.best(prepared, &different)
    }

    /// Parameters at which more rows may have a state than at the start: the minimum over the rows that have
    /// one there. All rows must have a state in the end, so that no model gains by having none.
    fn nearer(
        &self,
        prepared: &Prepared,
        start: &[f64],
        priors: &[Option<(f64, f64)>],
        options: &Options,
    ) -> Option<Vec<f64>> {
        let model = &prepared.model;
        let (few, _) = self.record.thinned(FEW_ROWS);
        let sd = vec![self.row_n; few.len()];
        let problem =
            |used: &[bool], at: &[f64]| FitProblem::new(model, &few, used, sd.clone(), at.to_vec(), priors);
        let settle = |problem: &FitProblem<'_>, at: &[f64]| {
            let bounds = problem.bounds();
            minimise_frozen(problem, &inside(problem.coordinates(at), &bounds), &bounds, options)
                .map_err(of_start)
        };
        let used = vec![true; few.len()];
        let found = minimise_partly((model, &few), &used, start, problem, settle).ok()?;
        Some(found.problem.theta(&found.minimum.theta))
    }

    /// The starts nearest to the data, if there are many. A start at which some row has no state has an
    /// infinite distance.
    fn nearest<'s>(
        &'s self,
        prepared: &'s Prepared,
        starts: &'s [Vec<f64>],
        priors: &[Option<(f64, f64)>],
    ) -> Vec<Begun<'s>> {
        let begun = |start: &'s Vec<f64>| {
            let problem =
                FitProblem::whitened(&prepared.model, self.record, self.whitening, start.clone(), priors);
            let bounds = problem.bounds();
            let at = inside(problem.coordinates(start), &bounds);
            let linear = solved(&problem, &at);
            Begun { start, problem, bounds, at, linear }
        };
        let mut found: Vec<Begun<'s>> = starts.par_iter().map(begun).collect();
        if found.len() <= FOLLOWED {
            return found;
        }
        found.sort_by(|a, b| a.distance().total_cmp(&b.distance()));
        found.truncate(FOLLOWED);
        found
    }

    /// The lowest of the minima that several starts lead to.
    fn best(&self, prepared: Prepared, starts: &[Vec<f64>]) -> Result<Confirmed, ModelError> {
        let priors = prepared.nuisance_priors();
        let options = Options {
            check_curvature: false,
            tolerance: TOLERANCE,
            max_evaluations: EVALUATIONS,
            least_decrease: NEAR,
        };
        let searched: Vec<Result<(Minimum, Vec<f64>), ModelError>> = self
            .nearest(&prepared, starts, &priors)
            .into_par_iter()
            .map(|Begun { start, problem, bounds, at, linear }| {
                self.progress.beat();
                let found = match minimise_solved(&problem, &at, linear, &bounds, &options).map_err(of_start)
                {
                    Err(error) if is_of_rows(&error) => {
                        let nearer = self.nearer(&prepared, start, &priors, &options).ok_or(error)?;
                        let nearer = inside(problem.coordinates(&nearer), &bounds);
                        minimise_frozen(&problem, &nearer, &bounds, &options).map_err(of_start)
                    }
                    found => found,
                };
                found.map(|minimum| {
                    let theta = problem.theta(&minimum.theta);
                    (minimum, theta)
                })
            })
            .collect();
        let mut best: Option<(Minimum, Vec<f64>)> = None;
        let mut first_error = None;
        for found in searched {
            match found {
                Ok(found) => {
                    if best.as_ref().is_none_or(|other| found.0.cost < other.0.cost) {
                        best = Some(found);
                    }
                }
                Err(error) => first_error = first_error.or(Some(error)),
            }
        }
        let Some((minimum, theta)) = best else {
            return Err(first_error.unwrap_or(ModelError::Values { given: 0, expected: 1 }));
        };
        let form = self.form_error(&prepared, &theta)?.in_short();
        let penalty = penalty(&prepared, &theta);
        let log_evidence = log_evidence(&prepared, &theta, &minimum) + form.log_evidence - penalty;
        // A kink counts as converged: the cost can't decrease further by an amount that matters.
        let converged = minimum.certificate.converged || minimum.certificate.reason == Reason::Kink;
        Ok(Confirmed { prepared, theta, minimum, log_evidence, penalty, form, converged })
    }
}

/// A fit at its start.
struct Begun<'s> {
    start: &'s [f64],
    problem: FitProblem<'s>,
    bounds: Bounds,
    /// The start in the coordinates of the search, within the bounds.
    at: Vec<f64>,
    /// The problem there, with its equilibria held; none if some row has no state.
    linear: Option<Linearisation>,
}

impl Begun<'_> {
    /// The sum of squares at the start.
    fn distance(&self) -> f64 {
        self.linear.as_ref().map_or(f64::INFINITY, Linearisation::cost)
    }
}

fn inside(mut coordinates: Vec<f64>, bounds: &Bounds) -> Vec<f64> {
    for ((x, low), high) in coordinates.iter_mut().zip(&bounds.lower).zip(&bounds.upper) {
        *x = if x.is_finite() { x.clamp(*low, *high) } else { *low };
    }
    coordinates
}

/// Laplace's approximation with the prior of each parameter: normal for data sheets, uniform per decade for
/// sizes of effects, uniform over the plausible range for forms. A parameter that the data don't inform costs
/// nothing.
fn log_evidence(prepared: &Prepared, theta: &[f64], minimum: &Minimum) -> f64 {
    let model = &prepared.model;
    let places = free(model);
    let k = places.len();
    let mut log = -0.5 * minimum.cost + 0.5 * k as f64 * std::f64::consts::TAU.ln();
    let mut curvature = vec![0.0; k];
    let mut held = vec![false; k];
    let roles = roles(model);
    for (column, index) in places.iter().enumerate() {
        let p = &model.parameters()[*index];
        if prepared.nuisance[*index] {
            if let Some((_, sd)) = prepared.priors[*index] {
                log -= (std::f64::consts::TAU.sqrt() * sd).ln();
            }
            continue;
        }
        let value = theta[*index];
        let jacobian = if p.logarithmic { value.abs().max(f64::MIN_POSITIVE) } else { 1.0 };
        if let Some(size) = roles[*index] {
            let deviation = value - size.off;
            if deviation == 0.0 {
                // The size is off, at its bound, so the parameter doesn't count.
                held[column] = true;
                continue;
            }
            let wide = size.scale.max(size.plausible.min(1e3 * size.scale)) / jacobian;
            curvature[column] = 1.0 / (wide * wide);
            let sd = 1.0 / (column_square(minimum, k, column).max(curvature[column])).sqrt() * jacobian;
            log += log_prior(&size, deviation.abs().max(sd)) + jacobian.ln();
        } else {
            let (low, high) = (p.plausible.0.max(p.low), p.plausible.1.min(p.high));
            let width = if p.logarithmic { (high / low.max(f64::MIN_POSITIVE)).ln() } else { high - low };
            if !(width > 0.0 && width.is_finite()) {
                held[column] = true;
                continue;
            }
            log -= width.ln();
            curvature[column] = 12.0 / (width * width);
        }
    }
    let active: Vec<usize> = (0..k).filter(|column| !held[*column]).collect();
    log -= 0.5 * (k - active.len()) as f64 * std::f64::consts::TAU.ln();
    log - 0.5 * log_determinant(minimum, k, &active, &curvature)
}

/// Penalty for sizes beyond the plausible range.
fn penalty(prepared: &Prepared, theta: &[f64]) -> f64 {
    let beyond = |(index, size): (usize, Option<Size>)| {
        let size = size.filter(|_| !prepared.nuisance[index])?;
        let deviation = (theta[index] - size.off).abs();
        (deviation > 0.0).then(|| RULE.implausible * (deviation / size.plausible - 1.0).max(0.0))
    };
    let free = free(&prepared.model);
    let roles = roles(&prepared.model);
    roles.into_iter().enumerate().filter(|(index, _)| free.contains(index)).filter_map(beyond).sum()
}

/// Squared norm of a column of the Jacobian.
fn column_square(minimum: &Minimum, k: usize, column: usize) -> f64 {
    (0..k).map(|row| minimum.r[row * k + column].powi(2)).sum()
}

fn log_determinant(minimum: &Minimum, k: usize, active: &[usize], curvature: &[f64]) -> f64 {
    let entry = |i: usize, j: usize| {
        let sum: f64 = (0..k).map(|row| minimum.r[row * k + i] * minimum.r[row * k + j]).sum();
        if i == j { sum + curvature[i] } else { sum }
    };
    let scale: Vec<f64> = active.iter().map(|i| entry(*i, *i).max(f64::MIN_POSITIVE).sqrt()).collect();
    let n = active.len();
    if n == 0 {
        return 0.0;
    }
    let scaled = nalgebra::DMatrix::from_fn(n, n, |i, j| entry(active[i], active[j]) / (scale[i] * scale[j]));
    let eigenvalues = scaled.symmetric_eigenvalues();
    let own: f64 = eigenvalues.iter().map(|value| value.max(1e-12).ln()).sum();
    own + 2.0 * scale.iter().map(|s| s.ln()).sum::<f64>()
}

/// For each parameter of a model, its size description if it is a size of an effect.
pub(crate) fn roles(model: &Model) -> Vec<Option<Size>> {
    let mut roles = vec![None; model.parameters().len()];
    for chosen in model.effects() {
        let card = chosen.effect.card();
        let cards: Vec<_> = chosen.effect.parameters().into_iter().map(|c| c.of(model.muscle())).collect();
        for size in sizes(&cards) {
            for (index, p) in model.parameters().iter().enumerate() {
                if p.effect == card.name && p.name == cards[size.place].name {
                    roles[index] = Some(size);
                }
            }
        }
    }
    roles
}

/// Starts of a fit: parameters of an effect from the sizes of the linear approximation. There are several if
/// the effect isn't proportional to its parameter.
pub(crate) fn starts(
    sensitivity: &Sensitivity,
    effect: &Arc<dyn Effect>,
    model: &Model,
    found: &[f64],
) -> Vec<Vec<f64>> {
    let cards: Vec<_> = effect.parameters().into_iter().map(|card| card.of(model.muscle())).collect();
    if cards.is_empty() {
        return vec![Vec::new()];
    }
    if sensitivity.whole {
        return vec![sensitivity.values.clone()];
    }
    let copies = model.copies(effect.as_ref());
    let mut all: Vec<Vec<f64>> = Vec::new();
    let quadratic = sensitivity.sizes.iter().any(|size| size.secant.is_some());
    for variant in if quadratic { &[0, 1][..] } else { &[0][..] } {
        let mut values: Vec<f64> = (0..copies).flat_map(|_| sensitivity.values.clone()).collect();
        for (size, deviation) in sensitivity.sizes.iter().zip(found) {
            let place = size.copy * cards.len() + size.place;
            let card = &cards[size.place];
            let deviation = match size.secant {
                // For F = c v^2 the secant estimates c step, so v^2 = deviation step.
                Some(step) if *variant == 1 => (deviation * step).abs().sqrt().copysign(step),
                _ => *deviation,
            };
            // Not exactly off, where a derivative may vanish.
            let least = 1e-3 * size.scale * if size.sign == Sign::Negative { -1.0 } else { 1.0 };
            let moved = if deviation == 0.0 { least } else { deviation };
            values[place] = (size.off + moved).clamp(card.low, card.high);
        }
        all.push(values);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::law::{NoiseLaw, NoiseSource};
    use crate::noise::whitening::Whitening;
    use bulge_effects::{Catalogue, Moment};
    use bulge_model::{Record, Wanted};
    use bulge_muscles::preset;
    use bulge_numerics::Random;

    const NOISE: f64 = 2.0;

    /// A static map of a pleated muscle whose load cell reads 3 N too much.
    fn record(base: &Model) -> Record {
        let at = |i: u32| Moment::at_rest(1e5 * f64::from(1 + i % 3), 0.05 + 0.003 * f64::from(i / 3));
        let record =
            Record::from_moments((0..90).map(at).collect(), vec![0.0; 90], std::iter::once(0..90).collect())
                .unwrap();
        let exact = base.evaluate(&record, &[], &Wanted::default()).unwrap().force;
        let mut random = Random::new(8, 0);
        record.with_force(exact.iter().map(|force| force + 3.0 + NOISE * random.normal()).collect())
    }

    #[test]
    fn evidence_is_the_integral_over_the_prior() {
        let catalogue = Catalogue::builtin();
        let base = Model::new(&preset("ppam-2-r16").unwrap());
        let record = record(&base);
        let law = NoiseLaw::white(NOISE, NoiseSource::Saturated, 1e6, String::new());
        let whitening = Whitening::new(&law, &record, &vec![true; record.len()], &[]).unwrap();
        let context = Context::new(&catalogue, &record, &whitening, &law);
        let offset = catalogue.find("force-offset").unwrap();
        let without = context.confirm(&base, &[], None, &[]).unwrap();
        let with = context.confirm(&base, &[Arc::clone(offset)], None, &[]).unwrap();
        let found = with.log_evidence - without.log_evidence;
        // The sum of squares is a parabola in the offset.
        let model = base.with(offset, None).unwrap();
        let size = roles(&model)[0].unwrap();
        let exact = base.evaluate(&record, &[], &Wanted::default()).unwrap().force;
        let square = |a: f64| -> f64 {
            record.force().iter().zip(&exact).map(|(y, f)| ((y - f - a) / NOISE).powi(2)).sum()
        };
        let steps = 20_000;
        let width = 20.0 / f64::from(steps);
        let sum: f64 = (0..steps)
            .map(|i| -10.0 + (f64::from(i) + 0.5) * width)
            .map(|a| (log_prior(&size, a) - 0.5 * (square(a) - square(0.0))).exp() * width)
            .sum();
        assert!((found - sum.ln()).abs() < 0.02, "{found} {}", sum.ln());
        assert!((with.theta[0] - 3.0).abs() < 4.0 * NOISE / 90.0_f64.sqrt() && with.converged);
    }

    #[test]
    fn an_effect_at_its_bound_is_idle_and_equal_starts_are_one() {
        let catalogue = Catalogue::builtin();
        let base = Model::new(&preset("ppam-2-r16").unwrap());
        let moment = |i: u32| Moment {
            direction: if i % 30 < 15 { 1.0 } else { -1.0 },
            ..Moment::at_rest(2e5, 0.05 + 0.01 * f64::from(if i % 30 < 15 { i % 30 } else { 29 - i % 30 }))
        };
        let moments: Vec<Moment> = (0..90).map(moment).collect();
        let record = Record::from_moments(moments, vec![0.0; 90], std::iter::once(0..90).collect()).unwrap();
        let exact = base.evaluate(&record, &[], &Wanted::default()).unwrap().force;
        let friction = [Arc::clone(catalogue.find("coulomb-friction").unwrap())];
        for (sign, idle) in [(1.0, false), (-1.0, true)] {
            let mut random = Random::new(4, 0);
            let force = exact.iter().zip(record.moments());
            let force = force.map(|(f, m)| f - sign * 5.0 * m.direction + random.normal()).collect();
            let record = record.clone().with_force(force);
            let law = NoiseLaw::white(1.0, NoiseSource::Saturated, 1e6, String::new());
            let whitening = Whitening::new(&law, &record, &vec![true; record.len()], &[]).unwrap();
            let context = Context::new(&catalogue, &record, &whitening, &law);
            let found = context.confirm(&base, &friction, None, &[vec![2.0], vec![2.0]]).unwrap();
            assert_eq!(found.is_idle(&friction), idle, "{:?}", found.theta);
            let one = context.confirm(&base, &friction, None, &[vec![2.0]]).unwrap();
            assert_eq!((one.theta, one.log_evidence.to_bits()), (found.theta, found.log_evidence.to_bits()));
        }
    }
}
