//! Exact derivatives against differences of solutions.

use bulge_fibre::{ADIABATIC, AMBIENT_PRESSURE, Approach, Gradient, Problem, Variable};
use bulge_muscles::{Muscle, Parameter, Pressure, Quantity};

use crate::check::{Check, Claim, Tally, Trouble};
use crate::difference::derivative;
use crate::specimen::{at, every_kind};

const PRESSURE: Pressure = Pressure::bar(2.0);

/// dF and dV by the contraction, the pressure and every parameter.
pub(crate) fn gradients() -> Check {
    Claim {
        group: "derivatives",
        name: "exact dF and dV by contraction, pressure and every parameter, by the method that applies",
        source: "differences of sixth order of solutions",
        tolerance: 1e-7,
        why: "solutions are exact to 1e-11 and differ by about 1 %; the cloth's kink leaves 1e-8",
    }
    .run(|tally| {
        for (name, muscle, contraction) in every_kind()? {
            compare(tally, name, &muscle, contraction, Approach::Auto)?;
        }
        Ok(())
    })
}

/// The same by shooting where the closed form would apply, so that both are checked.
pub(crate) fn gradients_by_shooting() -> Check {
    Claim {
        group: "derivatives",
        name: "the same by shooting where there is a closed form",
        source: "differences of sixth order of solutions",
        tolerance: 2e-7,
        why: "solutions are exact to 1e-10 at l0/R = 200 and differ by about 1 %; against at least a tenth",
    }
    .run(|tally| {
        for (name, muscle, contraction) in every_kind()? {
            let closed = Problem::new(&muscle, PRESSURE)?.shoots();
            if muscle.is_pleated() && !closed {
                compare(tally, name, &muscle, contraction, Approach::Shooting)?;
            }
        }
        Ok(())
    })
}

fn compare(
    tally: &mut Tally,
    name: &str,
    muscle: &Muscle,
    contraction: f64,
    approach: Approach,
) -> Result<(), Trouble> {
    let problem = Problem::new(muscle, PRESSURE)?;
    let Gradient { by_contraction, by_variable } = problem.gradient(contraction, approach)?;
    let found = problem.follow(contraction, approach)?;
    let read = |problem: &Problem, eps: f64| {
        problem.follow(eps, approach).map(|found| [found.force_n, found.volume_m3])
    };
    let mut add = |what: &str, exact: [f64; 2], value: f64, difference: [f64; 2]| {
        // A derivative counts against at least a tenth of the output over the variable.
        for (i, (output, size)) in
            [("force", found.force_n), ("volume", found.volume_m3)].into_iter().enumerate()
        {
            let floor = 0.1 * size / value;
            tally.scaled(exact[i], difference[i], floor, || format!("d({output})/d({what}), {name}"));
        }
    };
    let difference = derivative(|eps| read(&problem, eps), contraction, 0.01 * contraction.abs())?;
    add("contraction", by_contraction, contraction, difference);
    for (variable, exact) in by_variable {
        let (value, step) = match variable {
            Variable::Pressure => (PRESSURE.to_pa(), 0.01 * PRESSURE.to_pa()),
            Variable::Parameter(parameter) => {
                let Some(value) = muscle.get(parameter) else {
                    return Err(format!("{name} has a derivative by {variable} but no such parameter").into());
                };
                // A count moves by whole numbers; what is absent stays absent.
                match parameter {
                    Parameter::Fibres if value < 20.0 => continue,
                    Parameter::Fibres => (value, 1.0),
                    _ if value == 0.0 => continue,
                    // The cloth's edge moves along a steep meridian.
                    Parameter::UnfoldedRadius => (value, 0.003 * value),
                    _ => (value, 0.01 * value),
                }
            }
        };
        let outputs = |value: f64| -> Result<[f64; 2], Trouble> {
            let problem = match variable {
                Variable::Pressure => Problem::new(muscle, Pressure::pa(value))?,
                Variable::Parameter(Parameter::Fibres) => {
                    Problem::new(&muscle.with(Parameter::Fibres, value.round())?, PRESSURE)?
                }
                Variable::Parameter(parameter) => Problem::new(&muscle.with(parameter, value)?, PRESSURE)?,
            };
            Ok(read(&problem, contraction)?)
        };
        add(&variable.to_string(), exact, value, derivative(outputs, value, step)?);
    }
    Ok(())
}

/// dF/dl at constant pressure, and at constant gas amount along a path on which `(p + p_ambient) V^g` is constant.
pub(crate) fn stiffness() -> Check {
    Claim {
        group: "derivatives",
        name: "stiffness at constant pressure and at constant gas amount, isothermal and adiabatic",
        source: "differences of sixth order along the path (p + 101325 Pa) V^g = const",
        tolerance: 1e-7,
        why: "solutions are exact to 1e-11 and differ by about 1 %",
    }
    .run(|tally| {
        for (name, muscle, contraction) in every_kind()? {
            let found = at(&muscle, PRESSURE, contraction)?;
            for (what, exponent, reported) in [
                ("constant pressure", 0.0, found.stiffness_n_per_m),
                ("isothermal", 1.0, found.stiffness_isothermal_n_per_m),
                ("adiabatic", ADIABATIC, found.stiffness_adiabatic_n_per_m),
            ] {
                let amount = found.volume_polygon_m3.powf(exponent) * (PRESSURE.to_pa() + AMBIENT_PRESSURE);
                let force = |eps| closed_vessel(&muscle, eps, exponent, amount).map(|force| [force]);
                let [slope] = derivative(force, contraction, 0.01 * contraction.abs())?;
                let expected = -slope / muscle.length().si();
                tally.relative(reported, expected, || format!("{what}, {name}"));
            }
        }
        Ok(())
    })
}

/// Force at a contraction with the pressure at which the gas amount is as given, by the secant method.
fn closed_vessel(muscle: &Muscle, contraction: f64, exponent: f64, amount: f64) -> Result<f64, Trouble> {
    let surplus = |pressure: f64| -> Result<[f64; 2], Trouble> {
        let found = at(muscle, Pressure::pa(pressure), contraction)?;
        let held = (pressure + AMBIENT_PRESSURE) * found.volume_polygon_m3.powf(exponent);
        Ok([held / amount - 1.0, found.force_n])
    };
    let mut old = (PRESSURE.to_pa(), surplus(PRESSURE.to_pa())?);
    let mut new = old;
    // The first step as if the volume did not depend on the pressure.
    let mut next = PRESSURE.to_pa() - old.1[0] * (PRESSURE.to_pa() + AMBIENT_PRESSURE);
    for _ in 0..20 {
        if (next - new.0).abs() <= 1e-13 * next {
            break;
        }
        old = std::mem::replace(&mut new, (next, surplus(next)?));
        let slope = (new.1[0] - old.1[0]) / (new.0 - old.0);
        if !slope.is_finite() || slope == 0.0 {
            break;
        }
        next = new.0 - new.1[0] / slope;
    }
    Ok(new.1[1])
}
