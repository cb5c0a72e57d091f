//! What must hold of the equilibria of any muscle, whatever it is made of.

use bulge_fibre::{Approach, FibreError, Given, Problem, Response};
use bulge_muscles::{Fault, Muscle, MuscleError, Parameter, Pressure};

use super::muscles::KINDS;
use super::{Judgement, drawn_of, wrong_with};
use crate::sample::Sampler;

/// Factors by which the units of mass and length are changed. They are no powers of two, so that every number
/// is rounded anew.
const UNITS: [f64; 2] = [3.0, 0.7];
/// Difference of two equilibria that should be one, relative to force and size of the muscle. Roots are found
/// to 1e-9, and a force near the limit is a small difference.
const SAME: f64 = 1e-6;
/// Steps of the contraction for a difference quotient, and how well it agrees with the derivative where both
/// steps agree with each other.
const STEPS: [f64; 2] = [2e-4, 1e-4];
const QUOTIENT: f64 = 2e-3;

/// An invariant that doesn't hold: what, and of which muscle.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Broken(pub String);

/// The muscle and the question that these bytes make, checked against every invariant. The result is the
/// number of equilibria that were computed.
///
/// # Errors
/// The first invariant that doesn't hold.
pub fn equilibria(bytes: &[u8]) -> Result<u32, Broken> {
    let Some((kind, rest)) = bytes.split_first() else { return Ok(0) };
    let mut sampler = Sampler::of_bytes(rest);
    let drawn = drawn_of(usize::from(*kind) % KINDS.len(), &mut sampler);
    let Ok((muscle, pressure, question)) = drawn else { return Ok(0) };
    let mut count = 0;
    checked(&muscle, pressure, question, &mut count)
        .map_err(|what| Broken(format!("{what}; {question:?} at {pressure}, {muscle:?}")))?;
    Ok(count)
}

fn checked(
    muscle: &Muscle,
    pressure: Pressure,
    question: Option<Given>,
    count: &mut u32,
) -> Result<(), String> {
    let Ok(problem) = Problem::new(muscle, pressure) else { return Ok(()) };
    *count += 1;
    let question = match question {
        Some(given) => given,
        None => match problem.contraction_limit(Approach::Auto) {
            // At the limit itself the force is rounding.
            Ok(limit) => Given::Contraction(limit - 1e-3),
            Err(error) => return lost(&error, muscle, pressure, None),
        },
    };
    let found = match problem.solve(question, Approach::Auto) {
        Ok(found) => found,
        Err(error) => return lost(&error, muscle, pressure, Some(question)),
    };
    if let Some(wrong) = wrong_with(&found, Some(question)) {
        return Err(wrong);
    }
    *count += 3;
    returns(&problem, &found)?;
    *count += 5;
    derivatives(&problem, &found)?;
    *count += 1;
    other_units(muscle, &found).map_err(|what| format!("in other units, {what}"))
}

/// A search that failed is wrong if there is an equilibrium that pulls.
fn lost(
    error: &FibreError,
    muscle: &Muscle,
    pressure: Pressure,
    question: Option<Given>,
) -> Result<(), String> {
    if error.fault() != Fault::NotConverged {
        return Ok(());
    }
    match Judgement::of(muscle, pressure, question) {
        Judgement::Pulls(state) => Err(format!("{error}, but {state:?} is an equilibrium")),
        _ => Ok(()),
    }
}

/// Force of the size of the muscle.
fn scale(found: &Response) -> f64 {
    found.pressure_pa * found.max_radius_m.powi(2) + found.force_n.abs()
}

/// The force, the volume and the length of an equilibrium each lead back to an equilibrium that has them.
fn returns(problem: &Problem, found: &Response) -> Result<(), String> {
    let givens =
        [Given::Length(found.length_m), Given::Volume(found.volume_m3), Given::Force(found.force_n.max(0.0))];
    for given in givens {
        let again = problem
            .solve(given, Approach::Auto)
            .map_err(|error| format!("{given:?} was found at {}, but {error}", found.contraction))?;
        let off = match given {
            Given::Volume(volume) => again.volume_m3 / volume - 1.0,
            _ => (again.force_n - found.force_n) / scale(found),
        };
        if off.abs() > SAME {
            return Err(format!("{given:?} leads to another equilibrium: {off:e}"));
        }
    }
    Ok(())
}

/// Force and volume are the derivatives of one potential G(l, p), dG = F dl - V dp, that is concave in p:
///
/// ```text
/// dF/dp = -dV/dl (Maxwell),    dV/dp >= 0 at constant length
/// ```
/// and dF/d(contraction) agrees with a difference quotient. V is the volume with the section that carries the
/// pressure.
fn derivatives(problem: &Problem, found: &Response) -> Result<(), String> {
    let contraction = found.contraction;
    let gradient = problem
        .gradient(contraction, Approach::Auto)
        .map_err(|error| format!("no gradient at {contraction}: {error}"))?;
    let carries = found.volume_polygon_m3 / found.volume_m3;
    let [force_by_contraction, volume_by_contraction] = gradient.by_contraction;
    let [force_by_pressure, volume_by_pressure] = gradient.by_pressure;
    let by_length = -carries * volume_by_contraction / problem.parts().length;
    let area = found.max_radius_m.powi(2) + by_length.abs();
    if (force_by_pressure + by_length).abs() > SAME * area {
        return Err(format!("dF/dp = {force_by_pressure:e}, but dV/dl = {by_length:e}"));
    }
    if volume_by_pressure < -1e-9 * found.volume_m3 / found.pressure_pa {
        return Err(format!("the volume falls with the pressure: {volume_by_pressure:e}"));
    }
    let quotient = |step: f64| {
        let at = |contraction| problem.follow(contraction, Approach::Auto).ok().map(|at| at.force_n);
        Some((at(contraction + step)? - at(contraction - step)?) / (2.0 * step))
    };
    let [Some(wide), Some(narrow)] = STEPS.map(quotient) else { return Ok(()) };
    let size = narrow.abs() + scale(found);
    // Where cloth comes taut, or next to a straight pleated muscle, the two steps differ.
    if (wide - narrow).abs() < 0.1 * QUOTIENT * size
        && (narrow - force_by_contraction).abs() > QUOTIENT * size
    {
        return Err(format!("dF/d(contraction) = {force_by_contraction}, by differences {narrow}"));
    }
    Ok(())
}

/// The same muscle in other units of mass and length is the same muscle.
fn other_units(muscle: &Muscle, found: &Response) -> Result<(), String> {
    let [mass, length] = UNITS;
    let factor = |unit: &str| match unit {
        "m" => length,
        "Pa" => mass / length,
        "N" => mass * length,
        "N/m" => mass,
        _ => 1.0,
    };
    let renamed = |muscle: &Muscle| -> Result<Muscle, MuscleError> {
        let numbers: Vec<_> = Parameter::ALL
            .into_iter()
            .filter(|parameter| muscle.is_stated(*parameter))
            .filter_map(|parameter| Some((parameter, muscle.get(parameter)? * factor(parameter.unit()))))
            .collect();
        muscle.with_all(&numbers)
    };
    let other = renamed(muscle).map_err(|error| error.to_string())?;
    let pressure = Pressure::pa(found.pressure_pa * factor("Pa"));
    let again = Problem::new(&other, pressure)
        .and_then(|problem| problem.solve(Given::Contraction(found.contraction), Approach::Auto))
        .map_err(|error| error.to_string())?;
    let force = (again.force_n / factor("N") - found.force_n) / scale(found);
    let volume = again.volume_m3 / (length.powi(3) * found.volume_m3) - 1.0;
    if force.abs() > SAME || volume.abs() > SAME {
        return Err(format!("the force differs by {force:e}, the volume by {volume:e}"));
    }
    Ok(())
}
