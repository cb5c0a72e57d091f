//! Exact derivatives against differences of solutions.

use bulge_fibre::{ADIABATIC, AMBIENT_PRESSURE, Approach, LANES, Parts, Problem};
use bulge_muscles::{Muscle, Parameter, Pressure, Quantity};

use crate::check::{Check, Claim, Tally, Trouble};
use crate::difference::derivative;
use crate::specimen::{at, every_kind, stride};

const PRESSURE: Pressure = Pressure::bar(2.0);

/// Derivatives of F and V with respect to the contraction, the pressure and every parameter.
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

/// The same derivatives by shooting where the closed form would apply, so that both methods are checked.
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
            let closed = !Problem::new(&muscle, PRESSURE)?.shoots();
            if muscle.is_pleated() && closed {
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
    let gradient = problem.gradient(contraction, approach)?;
    let found = problem.follow(contraction, approach)?;
    let read = |problem: &Problem, eps: f64| {
        problem.follow(eps, approach).map(|found| [found.force_n, found.volume_m3])
    };
    let mut add = |what: &str, exact: [f64; 2], value: f64, difference: [f64; 2]| {
        // The error of a derivative is related to at least a tenth of the output divided by the variable.
        for (i, (output, size)) in
            [("force", found.force_n), ("volume", found.volume_m3)].into_iter().enumerate()
        {
            let floor = 0.1 * size / value;
            tally.scaled(exact[i], difference[i], floor, || format!("d({output})/d({what}), {name}"));
        }
    };
    let difference =
        derivative(|eps| read(&problem, eps), contraction, 0.01 * stride(muscle) * contraction.abs())?;
    add("contraction", gradient.by_contraction, contraction, difference);
    let pressure = PRESSURE.to_pa();
    let outputs =
        |value: f64| Ok::<_, Trouble>(read(&Problem::new(muscle, Pressure::pa(value))?, contraction)?);
    add("pressure", gradient.by_pressure, pressure, derivative(outputs, pressure, 0.01 * pressure)?);
    for parameter in Parameter::ALL {
        let Some(exact) = gradient.by(muscle, parameter) else { continue };
        let Some((value, step)) = step_of(muscle, parameter) else { continue };
        let outputs = |value: f64| Ok::<_, Trouble>(read(&changed(muscle, parameter, value)?, contraction)?);
        add(parameter.name(), exact, value, derivative(outputs, value, step)?);
    }
    Ok(())
}

/// Value and step of a parameter; none if it is 0, or if it is a count too small for whole-number steps.
fn step_of(muscle: &Muscle, parameter: Parameter) -> Option<(f64, f64)> {
    let value = muscle.get(parameter).unwrap_or(0.0);
    match parameter {
        Parameter::Fibres => (value >= 20.0).then_some((value, 1.0)),
        // The edge of the cloth moves along a steep meridian.
        Parameter::UnfoldedRadius => Some((value, 0.003 * value)),
        _ => (value != 0.0).then_some((value, 0.01 * stride(muscle) * value)),
    }
}

/// The problem with another value of a parameter.
fn changed(muscle: &Muscle, parameter: Parameter, value: f64) -> Result<Problem, Trouble> {
    let value = if parameter == Parameter::Fibres { value.round() } else { value };
    Ok(Problem::new(&muscle.with(parameter, value)?, PRESSURE)?)
}

/// Derivatives of all outputs of the linearised answer with respect to the contraction, the pressure and
/// every parameter, starting from a neighbouring solution.
pub(crate) fn linearised() -> Check {
    Claim {
        group: "derivatives",
        name: "linearised force, meridional force, mid radius and volume by contraction, pressure and every parameter",
        source: "differences of sixth order of solutions",
        tolerance: 1e-7,
        why: "solutions are exact to 1e-11 and differ by about 1 %; the cloth's kink leaves 1e-8",
    }
    .run(|tally| {
        for (name, muscle, contraction) in every_kind()? {
            let problem = Problem::new(&muscle, PRESSURE)?;
            let still = problem.parts().still();
            let near = problem.linearised(1.001 * contraction, &still, Approach::Auto)?;
            let here = problem.linearised_from(near.start(), contraction, &still, Approach::Auto)?;
            let found = problem.follow(contraction, Approach::Auto)?;
            let values = outputs(&problem, contraction)?;
            tally.relative(here.force_n.value, found.force_n, || format!("force, {name}"));
            let difference =
                derivative(|eps| outputs(&problem, eps), contraction, 0.01 * stride(&muscle) * contraction.abs())?;
            let linear =
                [here.force_n, here.equator_force_n, here.mid_radius_m, here.volume_polygon_m3];
            let mut add = |what: &str, exact: [f64; 4], value: f64, difference: [f64; 4]| {
                for (i, output) in ["force", "meridional force", "radius", "volume"].iter().enumerate() {
                    let floor = 0.1 * values[i] / value;
                    tally.scaled(exact[i], difference[i], floor, || format!("d({output})/d({what}), {name}"));
                }
            };
            add("contraction", linear.map(|l| l.by_contraction), contraction, difference);
            let pressure = PRESSURE.to_pa();
            let at = |value: f64| outputs(&Problem::new(&muscle, Pressure::pa(value))?, contraction);
            let difference = derivative(at, pressure, 0.01 * pressure)?;
            add("pressure", linear.map(|l| l.by_pressure), pressure, difference);
            let has = |parameter: &Parameter| muscle.get(*parameter).is_some();
            let parameters: Vec<Parameter> = Parameter::ALL.into_iter().filter(has).collect();
            for parameters in parameters.chunks(LANES) {
                let moving = Parts::seeded(&muscle, parameters);
                let near = problem.linearised(1.001 * contraction, &moving, Approach::Auto)?;
                let here = problem.linearised_from(near.start(), contraction, &moving, Approach::Auto)?;
                let linear =
                    [here.force_n, here.equator_force_n, here.mid_radius_m, here.volume_polygon_m3];
                for (lane, &parameter) in parameters.iter().enumerate() {
                    let of_pleated = parameter == Parameter::FittingRadius && muscle.is_pleated();
                    if !muscle.is_stated(parameter) || of_pleated {
                        continue;
                    }
                    if let Some((value, step)) = step_of(&muscle, parameter) {
                        let at = |value: f64| outputs(&changed(&muscle, parameter, value)?, contraction);
                        let exact = linear.map(|l| l.by_lane[lane]);
                        add(parameter.name(), exact, value, derivative(at, value, step)?);
                    }
                }
            }
        }
        Ok(())
    })
}

/// Values of the linearised answer.
fn outputs(problem: &Problem, contraction: f64) -> Result<[f64; 4], Trouble> {
    let found = problem.linearised(contraction, &problem.parts().still(), Approach::Auto)?;
    Ok([
        found.force_n.value,
        found.equator_force_n.value,
        found.mid_radius_m.value,
        found.volume_polygon_m3.value,
    ])
}

/// dF/dl at constant pressure, and at constant gas amount along a path on which `(p + p_ambient) V^g` is
/// constant.
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
                let [slope] = derivative(force, contraction, 0.01 * stride(&muscle) * contraction.abs())?;
                let expected = -slope / muscle.length().si();
                tally.relative(reported, expected, || format!("{what}, {name}"));
            }
        }
        Ok(())
    })
}

/// Force at a contraction, with the pressure for which the gas amount has the given value, by the secant
/// method.
fn closed_vessel(muscle: &Muscle, contraction: f64, exponent: f64, amount: f64) -> Result<f64, Trouble> {
    let surplus = |pressure: f64| -> Result<[f64; 2], Trouble> {
        let found = at(muscle, Pressure::pa(pressure), contraction)?;
        let held = (pressure + AMBIENT_PRESSURE) * found.volume_polygon_m3.powf(exponent);
        Ok([held / amount - 1.0, found.force_n])
    };
    let mut old = (PRESSURE.to_pa(), surplus(PRESSURE.to_pa())?);
    let mut new = old;
    // The first step neglects that the volume depends on the pressure.
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
