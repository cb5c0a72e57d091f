//! The periodic steady state, and the time to reach it.

use super::HeatError;
use super::cycle::{Runner, Tally};
use super::state::State;
use bulge_numerics::vector::{add, dot, norm};

/// Earlier cycles used by an extrapolation.
const WINDOW: usize = 8;
/// Largest change of a temperature by one extrapolation \[K\].
const LARGEST: f64 = 40.0;
/// A cycle whose residual exceeds the best one by this factor is rejected.
const WORSE: f64 = 4.0;
/// Damping below which extrapolation is abandoned.
const SMALLEST: f64 = 0.01;
/// Largest fraction of the way to the steady state that a jump of the transient covers.
const JUMP: f64 = 0.25;

/// The best cycle so far: the state at its start, its temperatures x with their estimated distances f to the
/// limit, and the largest |f|.
#[derive(Debug, Clone)]
struct Best {
    state: State,
    pair: (Vec<f64>, Vec<f64>),
    residual: f64,
}

/// Computes cycles until one ends as it began, within the tolerance. Returns the last cycle, and the
/// estimated distance from the limit \[K\].
///
/// A cycle maps temperatures x to G(x). In one cycle the walls cover only a small fraction of their way to
/// the limit. So their change is first divided by 1 - exp(-rate period), with the rate of a wall to which the
/// gas is weakly coupled. Anderson's method then extrapolates from the last cycles. If that diverges, it
/// restarts from the best cycle with half the damping factor. Once the factor is tiny, the cycles are
/// computed one by one without extrapolation.
pub(super) fn steady(runner: &mut Runner) -> Result<(Tally, f64), HeatError> {
    let numerics = runner.problem.numerics;
    let (mut history, mut damping) = (Vec::new(), 1.0);
    let mut extrapolates = numerics.accelerate;
    let mut best: Option<Best> = None;
    loop {
        let (x, state) = (runner.temperatures(), runner.state.clone());
        let mut lost = true;
        match (runner.cycle(), &best) {
            (Ok(tally), _) => {
                let way = ways(runner, &tally, &x);
                let residual = way.iter().fold(0.0_f64, |most, way| most.max(way.abs()));
                if residual <= numerics.tolerance_k {
                    return Ok((tally, residual));
                }
                if best.as_ref().is_none_or(|best| residual < WORSE * best.residual) {
                    lost = false;
                }
                history.push((x, way));
                if best.as_ref().is_none_or(|best| residual < best.residual)
                    && let Some(pair) = history.last().cloned()
                {
                    best = Some(Best { state, pair, residual });
                }
            }
            // An extrapolated state may be physically impossible.
            (Err(HeatError::NotConverged(_) | HeatError::Choked { .. }), Some(_)) if extrapolates => {}
            (Err(error), _) => return Err(error),
        }
        let residual_k = best.as_ref().map_or(f64::NAN, |best| best.residual);
        if runner.cycles >= numerics.max_cycles {
            return Err(HeatError::not_periodic(runner.cycles, residual_k));
        }
        if !extrapolates {
            history.clear();
            continue;
        }
        if let (true, Some(best)) = (lost, &best) {
            damping *= 0.5;
            history = vec![best.pair.clone()];
            runner.state.clone_from(&best.state);
            if damping < SMALLEST {
                extrapolates = false;
                continue;
            }
        }
        if history.len() > WINDOW {
            history.remove(0);
        }
        let next = anderson(&history, damping);
        runner.set_temperatures(&next);
    }
}

/// Change over a cycle that began at x, scaled to the estimated distance from the limit.
fn ways(runner: &Runner, tally: &Tally, x: &[f64]) -> Vec<f64> {
    let (after, scale) = (runner.temperatures(), scales(runner, tally));
    x.iter().zip(&after).zip(&scale).map(|((x, g), s)| (g - x) * s).collect()
}

/// Time \[s\] at which the mean wall temperature of a cell has covered 90 % of its way from the ambient to
/// the steady state.
///
/// With acceleration, every few cycles are followed by a jump over many cycles. In a jump each temperature T
/// approaches its steady value T* at the rate observed in the last cycle, so that `T* - T` decays
/// exponentially.
pub(super) fn time_to_90(
    runner: &mut Runner,
    cell: usize,
    steady: &[f64],
    goal: f64,
) -> Result<f64, HeatError> {
    let problem = runner.problem;
    let ambient = problem.surroundings.ambient_k;
    let way = goal - ambient;
    if way.abs() < 10.0 * problem.numerics.tolerance_k {
        return Ok(0.0);
    }
    let limit = 2 * problem.numerics.max_cycles;
    let (mut passed, mut last) = (0.0, (0.0, 0.0));
    loop {
        let before = runner.temperatures();
        let tally = runner.cycle()?;
        passed += 1.0;
        let now = (passed - 0.5, (tally.muscle.wall_mean[cell] - ambient) / way);
        if now.1 >= 0.9 {
            // The remaining distance decays exponentially between two cycles.
            let left = |part: f64| (1.0 - part).max(1e-12).ln();
            let share = (left(last.1) - 0.1_f64.ln()) / (left(last.1) - left(now.1));
            return Ok((last.0 + share * (now.0 - last.0)) * problem.drive.period_s);
        }
        last = now;
        if runner.cycles >= limit {
            return Err(HeatError::not_periodic(runner.cycles, (1.0 - now.1) * way));
        }
        if problem.numerics.accelerate && passed > 1.5 && runner.cycles.is_multiple_of(2) {
            passed += jump(runner, &before, steady, cell);
        }
    }
}

/// Jumps over many cycles; returns their number.
fn jump(runner: &mut Runner, before: &[f64], steady: &[f64], cell: usize) -> f64 {
    let mut now = runner.temperatures();
    let rate = |i: usize| {
        let left = steady[i] - before[i];
        let part = (now[i] - before[i]) / left;
        if part.is_finite() { -(-part.clamp(0.0, 0.9)).ln_1p() } else { 0.0 }
    };
    let n = runner.mesh.x.len();
    let slow = rate(n + cell);
    let cycles = (-(-JUMP).ln_1p() / slow).floor();
    // A wall that moves away from its limit, as it may at first, gives no rate.
    if slow <= 0.0 || cycles < 1.0 {
        return 0.0;
    }
    let kept: Vec<f64> = (0..now.len()).map(|i| (-rate(i) * cycles).exp()).collect();
    for ((now, kept), steady) in now.iter_mut().zip(kept).zip(steady) {
        *now = steady + (*now - steady) * kept;
    }
    runner.set_temperatures(&now);
    cycles
}

/// Factors from the change in a cycle to the estimated distance from the limit.
fn scales(runner: &Runner, tally: &Tally) -> Vec<f64> {
    let (mesh, period) = (&runner.mesh, runner.problem.drive.period_s);
    let scale = |rate: f64| (-(-rate).exp_m1()).max(1e-9).recip();
    let muscle = tally.exchange[0].iter().enumerate().map(|(i, inner)| {
        // Gas that is hardly exchanged follows the wall, so only a fraction of its conductance counts.
        scale(0.1 * inner + period * mesh.wall_outer[i] / mesh.wall_capacity[i])
    });
    let pipe = tally.exchange[1].iter().map(|both| scale(*both));
    let ones = |n: usize| std::iter::repeat_n(1.0, n);
    ones(mesh.x.len()).chain(muscle).chain(ones(mesh.pipe_cells)).chain(pipe).collect()
}

/// Anderson's extrapolation of pairs (x, f): from x + damping f it subtracts the combination of differences
/// that minimises f.
fn anderson(history: &[(Vec<f64>, Vec<f64>)], damping: f64) -> Vec<f64> {
    let Some(((x, f), earlier)) = history.split_last() else { return Vec::new() };
    let mut step: Vec<f64> = f.iter().map(|f| damping * f).collect();
    // Differences of f are orthogonalised, newest first; those of x + damping f are combined with the same
    // coefficients.
    let mut basis: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    let mut after = (x, f);
    for (x0, f0) in earlier.iter().rev() {
        let mut df: Vec<f64> = after.1.iter().zip(f0).map(|(a, b)| a - b).collect();
        let mut dx: Vec<f64> =
            after.0.iter().zip(x0).zip(&df).map(|((a, b), df)| a - b + damping * df).collect();
        let size = norm(&df);
        for (q, p) in &basis {
            let share = dot(q, &df);
            add(&mut df, -share, q);
            add(&mut dx, -share, p);
        }
        let rest = norm(&df);
        // A difference that depends linearly on newer ones would only add rounding errors.
        if rest <= 1e-6 * size {
            break;
        }
        df.iter_mut().chain(&mut dx).for_each(|value| *value /= rest);
        add(&mut step, -dot(&df, f), &dx);
        basis.push((df, dx));
        after = (x0, f0);
    }
    let most = step.iter().fold(0.0_f64, |most, step| most.max(step.abs()));
    let factor = (LARGEST / most).min(1.0);
    x.iter().zip(step).map(|(x, step)| x + factor * step).collect()
}
