//! Minimises in rounds: equilibria are solved at the start of a round and linearised in the shape parameters
//! within it.
//!
//! Shooting for the equilibria is nearly the whole cost of a fit, while its shape parameters (a radius within
//! its tolerance, a modulus) change little from one evaluation to the next. When a round ends where it began,
//! the equilibria at its end are the solved ones, so its minimum is that of the model itself. If the rounds
//! don't get there, a fit without the linearisation follows.

use bulge_model::ModelError;
use bulge_numerics::least_squares::{
    Bounds, LeastSquaresError, Linearisation, Minimum, Options, minimise, minimise_from,
};

use crate::fit::problem::FitProblem;

/// Most rounds.
const ROUNDS: usize = 8;
/// Difference of the sum of squares that doesn't matter; log-likelihoods count half of it.
pub(crate) const NEAR: f64 = 0.01;
/// The same relative to the sum of squares.
const NEAR_PART: f64 = 1e-6;
/// A parameter is still if it moves by less than this fraction of a standard deviation.
const STILL: f64 = 0.05;

/// The minimum that a start leads to. Arguments and errors are those of [`minimise`].
pub(crate) fn minimise_frozen(
    problem: &FitProblem<'_>,
    start: &[f64],
    bounds: &Bounds,
    options: &Options,
) -> Result<Minimum, LeastSquaresError<ModelError>> {
    minimise_solved(problem, start, solved(problem, start), bounds, options)
}

/// Solves the equilibria at a point, holds them, and linearises the problem there; none if it has no value.
pub(crate) fn solved(problem: &FitProblem<'_>, at: &[f64]) -> Option<Linearisation> {
    problem.hold();
    Linearisation::at(problem, at).ok()
}

/// As [`minimise_frozen`], from a start with what [`solved`] found there.
pub(crate) fn minimise_solved(
    problem: &FitProblem<'_>,
    start: &[f64],
    first: Option<Linearisation>,
    bounds: &Bounds,
    options: &Options,
) -> Result<Minimum, LeastSquaresError<ModelError>> {
    let mut at = start.to_vec();
    // The last accepted point at which the equilibria were solved, and the sum of squares there.
    let mut accepted: Option<(Vec<f64>, f64)> = None;
    let mut here = Some(first);
    for _ in 0..ROUNDS {
        let began = accepted.as_ref().map_or(f64::INFINITY, |(_, cost)| *cost);
        let linear = here.take().unwrap_or_else(|| solved(problem, &at));
        let Some(linear) = linear.filter(|linear| linear.cost() <= began + near(began)) else {
            // The linearised step led to a point without equilibrium or with a larger cost: halve it.
            let Some((before, _)) = &accepted else { break };
            at = before.iter().zip(&at).map(|(before, at)| 0.5 * (before + at)).collect();
            continue;
        };
        let cost_here = linear.cost();
        if !problem.is_held() {
            // Nothing is interpolated, and what was evaluated here is the model itself. It stays so: no lattice may be held
            // on the way. The answers of the rows serve as long as neither the muscle nor its inputs change.
            problem.hold_no_more();
            let minimum = minimise_from(problem, linear, bounds, options);
            problem.release();
            return minimum;
        }
        let minimum = minimise_from(problem, linear, bounds, options)?;
        let is_end = minimum.cost >= cost_here - near(cost_here);
        if is_end && is_still(&at, &minimum) {
            problem.release();
            return Ok(minimum);
        }
        let there = solved(problem, &minimum.theta);
        // Solving the equilibria there confirms the linearised cost.
        let is_confirmed = |there: &Linearisation| (there.cost() - minimum.cost).abs() <= near(there.cost());
        if is_end && there.as_ref().is_some_and(is_confirmed) {
            problem.release();
            return Ok(minimum);
        }
        here = Some(there);
        let from = std::mem::replace(&mut at, minimum.theta);
        accepted = Some((from, cost_here));
    }
    problem.release();
    let from = accepted.map_or_else(|| start.to_vec(), |(from, _)| from);
    minimise(problem, &from, bounds, options)
}

/// Whether no parameter has moved by more than a small fraction of its standard deviation.
fn is_still(from: &[f64], minimum: &Minimum) -> bool {
    let k = from.len();
    let column = |j: usize| (0..k).map(|i| minimum.r[i * k + j].powi(2)).sum::<f64>().sqrt();
    from.iter().zip(&minimum.theta).enumerate().all(|(j, (from, to))| (to - from).abs() * column(j) < STILL)
}

fn near(cost: f64) -> f64 {
    NEAR + NEAR_PART * cost
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::nuisance::with_nuisances;
    use bulge_effects::{Catalogue, Moment};
    use bulge_model::{Model, Record};
    use bulge_muscles::from_toml;
    use bulge_numerics::Random;

    const BRAID: &str = "name = \"b\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm +- 0.1 mm\"\nbraid_angle = \"25 deg +- 0.2 deg\"\n\
                         ends = \"clamped\"\nwall = \"1.8 mm\"\n[instruments]\nforce = { noise = \"2 N\", zero = \"1 N\" }\n";

    /// Three strokes of a braid with rubber and friction.
    fn measured(model: &Model, theta: &[f64]) -> Record {
        let moment = |i: u32| Moment {
            direction: 1.0,
            begins: i.is_multiple_of(150),
            ..Moment::at_rest(2e5 + 1e5 * f64::from(i / 150), 0.01 + 0.001 * f64::from(i % 150))
        };
        let moments: Vec<Moment> = (0..450).map(moment).collect();
        let sweeps = (0..3).map(|i| 150 * i..150 * (i + 1)).collect();
        let record = Record::from_moments(moments, vec![0.0; 450], sweeps).unwrap();
        let exact = model.evaluate(&record, theta, &bulge_model::Wanted::default()).unwrap().force;
        let mut random = Random::new(5, 0);
        record.with_force(exact.iter().map(|force| force + 2.0 * random.normal()).collect())
    }

    #[test]
    fn rounds_lead_to_the_minimum_of_the_model_itself() {
        let catalogue = Catalogue::builtin();
        let add = |model: Model, name: &str| model.with(catalogue.find(name).unwrap(), None).unwrap();
        let base = Model::new(&from_toml(BRAID, "braid").unwrap());
        let model = ["bladder-elasticity", "coulomb-friction"].into_iter().fold(base, add);
        let record = measured(&model, &[2e5, 8.0]);
        let prepared = with_nuisances(&model, &catalogue).unwrap();
        let start = prepared.model.start();
        let problem = || {
            let used = vec![true; record.len()];
            FitProblem::new(
                &prepared.model,
                &record,
                &used,
                vec![2.0; record.len()],
                start.clone(),
                &prepared.priors,
            )
        };
        let (rounds, plain) = (problem(), problem());
        let (bounds, at) = (plain.bounds(), plain.coordinates(&start));
        let options = Options { check_curvature: false, tolerance: 1e-6, ..Options::default() };
        let found = minimise_frozen(&rounds, &at, &bounds, &options).unwrap();
        let exact = minimise(&plain, &at, &bounds, &options).unwrap();
        assert!(found.certificate.converged && !rounds.is_held());
        assert!((found.cost - exact.cost).abs() < 0.02, "{} {}", found.cost, exact.cost);
        let sd = exact.covariance(1.0);
        for (j, (a, b)) in found.theta.iter().zip(&exact.theta).enumerate() {
            let sd = sd[j * exact.theta.len() + j].sqrt();
            assert!((a - b).abs() < 0.05 * sd, "number {j}: {a} {b}, {sd}");
        }
    }
}
