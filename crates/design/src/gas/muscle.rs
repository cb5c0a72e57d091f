//! Questions to a muscle with its effects: where it pulls, where it may push, from which length its contraction counts, what it carries.

use bulge_fibre::{Approach, FibreError, Given, Problem, Response};
use bulge_model::{Extended, ExtendedError};
use bulge_muscles::{Pressure, Quantity as _};

use super::{GasError, Load};

/// The muscle with its effects where it pulls.
pub(super) fn pulling(
    muscle: &Extended,
    pressure_pa: f64,
    contraction: f64,
    approach: Approach,
) -> Result<Response, GasError> {
    let failed = |error: ExtendedError| GasError::Muscle { pressure_pa, error: Box::new(error) };
    let found =
        muscle.solve(Pressure::pa(pressure_pa), Given::Contraction(contraction), approach).map_err(failed)?;
    // Effects may turn the pull of the equilibrium into a push. Rounding may as well, at the limit.
    let scale = pressure_pa * muscle.muscle().radius().si().powi(2);
    if found.force_n < -1e-9 * scale {
        return Err(failed(FibreError::WouldPush { contraction, force_n: found.force_n }.into()));
    }
    Ok(found)
}

/// Unpressurised length from which contractions of a muscle with its effects count \[m\].
pub(super) fn stated_length(muscle: &Extended) -> f64 {
    let own = muscle.muscle().length().si();
    // An effect may say that the fibres have another length: the length at half the contraction tells the stated one.
    match muscle.given(Given::Contraction(0.5)) {
        Given::Length(length) => 2.0 * length,
        _ => own,
    }
}

/// Whether shape and force per pressure are the same at any pressure.
pub(super) fn is_scale_free(muscle: &Extended) -> Result<bool, GasError> {
    let problem = problem(muscle, 1e5)?;
    Ok(problem.is_scale_free() && !muscle.adds_force())
}

pub(super) fn problem(muscle: &Extended, pressure_pa: f64) -> Result<Problem, GasError> {
    Problem::new(muscle.muscle(), Pressure::pa(pressure_pa))
        .map_err(|error| GasError::Muscle { pressure_pa, error: Box::new(error.into()) })
}

/// The muscle with its effects at a pressure and a contraction, also where it would push.
pub(super) fn follow(
    muscle: &Extended,
    pressure_pa: f64,
    contraction: f64,
    approach: Approach,
) -> Result<Response, GasError> {
    let failed = |error: ExtendedError| GasError::Muscle { pressure_pa, error: Box::new(error) };
    let own = muscle.muscle().length().si();
    let own_contraction = match muscle.given(Given::Contraction(contraction)) {
        Given::Length(length) => 1.0 - length / own,
        _ => contraction,
    };
    let plain = problem(muscle, pressure_pa)?
        .follow(own_contraction, approach)
        .map_err(|error| failed(error.into()))?;
    muscle.complete(&plain).map_err(|error| failed(error.into()))
}

/// Load at a contraction \[N\].
pub(super) fn load_at(load: &Load<'_>, muscle: &Extended, contraction: f64) -> f64 {
    match load {
        Load::Held(_) => f64::INFINITY,
        Load::Force(force) => *force,
        Load::Spring { preload_n, rate_n_per_m, from } => {
            preload_n + rate_n_per_m * stated_length(muscle) * (contraction - from)
        }
        Load::Law(law) => law(contraction),
    }
}
