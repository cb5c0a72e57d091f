//! User-defined shape effects: the equilibrium of the net is solved with a formula.

use bulge_fibre::{EVEN_POWERS, Formula, FormulaInput, Jet, MOST_GAPS, MOST_PARAMETERS, Parts};
use bulge_muscles::{Dimension, MuscleError};
use bulge_numerics::Real;
use bulge_numerics::tape::{Builder, Function, Operator, Place, Tape};
use std::f64::consts::PI;
use std::sync::Arc;

use crate::expression::{Expression, ExpressionError, SHAPE_VARIABLES};

/// The quantity that a shape formula describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShapeQuantity {
    /// Stored energy of the wall per area at rest \[N/m\], added to that of the muscle's own bladder and
    /// cloth.
    Energy,
    /// Area on which the pressure acts at a radius \[m^2\], in place of that of the polygon or circle.
    Area,
    /// Turn of the fibres about the axis per length of fibre \[1/m\], in place of sin(alpha0)/r0.
    Twist,
}

impl ShapeQuantity {
    /// All shape quantities.
    pub const ALL: [Self; 3] = [Self::Energy, Self::Area, Self::Twist];

    /// The key in a file.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Energy => "energy",
            Self::Area => "area",
            Self::Twist => "twist",
        }
    }

    fn dimension(self) -> Dimension {
        match self {
            Self::Energy => Dimension::LINE_STIFFNESS,
            Self::Area => Dimension::AREA,
            Self::Twist => Dimension::NONE.over(Dimension::LENGTH).unwrap_or_default(),
        }
    }

    /// The variables on which it can't depend.
    const fn without(self) -> &'static [FormulaInput] {
        match self {
            Self::Energy => &[],
            Self::Area => &[FormulaInput::AlongMeridian],
            Self::Twist => &[FormulaInput::AlongMeridian, FormulaInput::AroundAxis, FormulaInput::Radius],
        }
    }
}

/// A shape formula with its derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeFormula {
    /// The quantity that it describes.
    pub quantity: ShapeQuantity,
    /// The formula as written.
    pub expression: Expression,
    /// The formula with the derivatives that the equilibrium needs.
    tape: Arc<Tape>,
    /// The factors of [`EVEN_POWERS`], for an energy that is a sum of these.
    even: Option<Arc<Tape>>,
    /// The gaps of its branches, if it has kinks.
    gaps: Option<Arc<Tape>>,
}

impl ShapeFormula {
    /// Reads a formula of [`SHAPE_VARIABLES`] and these parameters and differentiates it: an energy twice by
    /// the stretches, an area twice by the radius.
    ///
    /// # Errors
    /// As [`Expression::parse`]; also if it has more than [`MOST_PARAMETERS`] parameters, uses a variable on
    /// which the quantity can't depend, or is too long.
    pub fn parse(
        quantity: ShapeQuantity,
        text: &str,
        parameters: &[(&str, Dimension)],
    ) -> Result<Self, ExpressionError> {
        let refused = |what: String, instead: &str| ExpressionError::new(text, 0..0, what, instead);
        let expression = Expression::parse_over(text, &SHAPE_VARIABLES, parameters, quantity.dimension())?;
        if parameters.len() > MOST_PARAMETERS {
            let what = format!(
                "`{}` has {} parameters, but at most {MOST_PARAMETERS} are solved with",
                quantity.key(),
                parameters.len()
            );
            return Err(refused(what, "write numbers for those that are known"));
        }
        if let Some(input) =
            quantity.without().iter().find(|input| expression.uses_variable(**input as usize))
        {
            let name = SHAPE_VARIABLES[*input as usize].name;
            let what = format!("`{}` can't depend on `{name}`", quantity.key());
            return Err(refused(what, "write it by the other variables and by parameters"));
        }
        let (mut tape, place) = expression.steps();
        let outputs = match quantity {
            ShapeQuantity::Energy => {
                let by_1 = tape.derivative(place, FormulaInput::AlongMeridian as usize);
                let by_2 = by_circumference(&mut tape, place);
                let by_11 = tape.derivative(by_1, FormulaInput::AlongMeridian as usize);
                let (by_12, by_22) = (by_circumference(&mut tape, by_1), by_circumference(&mut tape, by_2));
                vec![place, by_1, by_2, by_11, by_12, by_22]
            }
            ShapeQuantity::Area => {
                let by_r = by_radius(&mut tape, place);
                let by_rr = by_radius(&mut tape, by_r);
                vec![place, by_r, by_rr]
            }
            ShapeQuantity::Twist => vec![place],
        };
        let tape = tape.finish(&outputs).ok_or_else(|| {
            let what = format!("`{}` and its derivatives need too many numbers at a time", quantity.key());
            refused(what, "write a shorter formula")
        })?;
        let even = if quantity == ShapeQuantity::Energy { even_powers(&expression) } else { None };
        let (mut steps, place) = expression.steps();
        let gaps = steps.gaps(place);
        if gaps.len() > MOST_GAPS {
            let what = format!(
                "`{}` has {} places where its branch may change, but at most {MOST_GAPS} are solved with",
                quantity.key(),
                gaps.len()
            );
            return Err(refused(what, "write fewer of `max`, `min`, `abs`, `clamp`, `if`"));
        }
        let gaps = if gaps.is_empty() { None } else { steps.finish(&gaps).map(Arc::new) };
        Ok(Self { quantity, expression, tape: Arc::new(tape), even: even.map(Arc::new), gaps })
    }

    /// Puts the formula with its parameters into the parts of a muscle. If it changes nothing (at zero
    /// stiffness) and `theta` carries no derivatives, the parts stay unchanged.
    pub(crate) fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        if !theta.iter().any(Jet::moves) && self.changes_nothing(theta, parts) {
            return Ok(());
        }
        let formula = Formula {
            tape: Arc::clone(&self.tape),
            even: self.even.clone(),
            gaps: self.gaps.clone(),
            parameters: theta.to_vec(),
        };
        let place = match self.quantity {
            ShapeQuantity::Energy => &mut parts.energy,
            ShapeQuantity::Area => &mut parts.area,
            ShapeQuantity::Twist => &mut parts.twist,
        };
        if place.is_some() {
            return Err(MuscleError::TwoFormulas { what: self.quantity.key() });
        }
        *place = Some(formula);
        Ok(())
    }

    /// Whether the formula is that of the net without it: an energy of 0, pi r^2 or sin(alpha0)/r0. It is
    /// simplified for these parameters; one that is written in another way is solved with like any other.
    fn changes_nothing(&self, theta: &[Jet], parts: &Parts<Jet>) -> bool {
        let (steps, place) = self.expression.steps();
        let parameter = |index: usize| theta.get(index.checked_sub(SHAPE_VARIABLES.len())?);
        let (mut steps, places) = steps.with_known(|index| parameter(index).map(|number| number.value()));
        let found = places[place];
        match self.quantity {
            ShapeQuantity::Energy => steps.constant_at(found) == Some(0.0),
            ShapeQuantity::Area => {
                let (pi, r) = (steps.constant(PI), steps.input(FormulaInput::Radius as usize));
                let square = steps.whole_power(r, 2);
                let circle = steps.operate(Operator::Multiply, pi, square);
                !parts.is_polygon && parts.depth.value() == 0.0 && found == circle
            }
            ShapeQuantity::Twist => {
                let angle = steps.input(FormulaInput::Angle as usize);
                let sine = steps.call(Function::Sin, &[angle]);
                let reference = steps.input(FormulaInput::ReferenceRadius as usize);
                found == steps.operate(Operator::Divide, sine, reference)
            }
        }
    }
}

/// The factors of [`EVEN_POWERS`] in an energy, if it has no other powers. What depends on neither stretch is left
/// out: it changes nothing.
fn even_powers(expression: &Expression) -> Option<Tape> {
    use FormulaInput::{AlongMeridian, AroundAxis, Radius, ReferenceRadius};
    let (mut steps, place) = expression.steps();
    let terms = steps.powers(place, [AlongMeridian, AroundAxis, Radius].map(|input| input as usize))?;
    let reference = steps.input(ReferenceRadius as usize);
    let mut factors = [steps.constant(0.0); EVEN_POWERS.len()];
    for ([along, around, radius], factor) in terms {
        // r = l2 r0.
        let powers = [along, around.checked_add(radius)?];
        let scale = steps.whole_power(reference, radius);
        let factor = steps.operate(Operator::Multiply, factor, scale);
        match EVEN_POWERS.iter().position(|even| *even == powers) {
            Some(k) => factors[k] = steps.operate(Operator::Add, factors[k], factor),
            None if powers == [0, 0] => {}
            None => return None,
        }
    }
    steps.finish(&factors)
}

/// The derivative by l2, with r = l2 r0 following l2.
fn by_circumference(tape: &mut Builder, of: Place) -> Place {
    let [by_stretch, by_radius] =
        [FormulaInput::AroundAxis, FormulaInput::Radius].map(|input| tape.derivative(of, input as usize));
    let reference = tape.input(FormulaInput::ReferenceRadius as usize);
    let along = tape.operate(Operator::Multiply, reference, by_radius);
    tape.operate(Operator::Add, by_stretch, along)
}

/// The derivative by r, with l2 = r/r0 following r.
fn by_radius(tape: &mut Builder, of: Place) -> Place {
    let by_stretch = by_circumference(tape, of);
    let reference = tape.input(FormulaInput::ReferenceRadius as usize);
    tape.operate(Operator::Divide, by_stretch, reference)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Effect;
    use crate::geometry::bench::{cylinder, force};
    use crate::user::{MAX_PARAMETERS, SHAPE_EXAMPLE, from_toml};
    use bulge_fibre::{Approach, FibreError, Given, Problem};
    use bulge_muscles::{Muscle, Parameter, Pressure, preset};

    fn own(text: &str) -> Box<dyn Effect> {
        Box::new(from_toml(text, "own.toml").unwrap().remove(0))
    }

    fn clamped() -> Muscle {
        preset("dmsp-20-250").unwrap().with(Parameter::Wall, 0.002).unwrap()
    }

    fn stated(muscle: &Muscle, c10: f64) -> Parts {
        Parts::of(&muscle.with(Parameter::C10, c10).unwrap())
    }

    /// The bladder of the catalogue as a formula gives the same force, stiffness, volume and derivatives,
    /// with the ODE and by quadrature.
    #[test]
    fn the_shipped_bladder_as_a_formula_is_the_same() {
        for muscle in [clamped(), cylinder().with(Parameter::Wall, 0.002).unwrap()] {
            let formula = own(SHAPE_EXAMPLE).reshaped(&[3e5, 0.002], &muscle).unwrap();
            let shipped = stated(&muscle, 3e5);
            let mut tried = 0;
            for bar in [1.0, 2.0, 4.0] {
                for contraction in [-0.02, 0.01, 0.05, 0.12, 0.2] {
                    let [a, b] =
                        [&shipped, &formula].map(|parts| Problem::new(parts, Pressure::bar(bar)).unwrap());
                    let found = [&a, &b].map(|problem| problem.follow(contraction, Approach::Auto));
                    let [Ok(one), Ok(other)] = found else { continue };
                    let size = 1e5 * bar * 1e-4;
                    assert!(
                        (one.force_n - other.force_n).abs() < 1e-12 * (one.force_n.abs() + size),
                        "{one:?} {other:?}"
                    );
                    let relative = |x: f64, y: f64| (x / y - 1.0).abs();
                    assert!(relative(one.volume_m3, other.volume_m3) < 1e-12);
                    assert!(relative(one.stiffness_n_per_m, other.stiffness_n_per_m) < 1e-10);
                    assert!(
                        relative(one.stiffness_adiabatic_n_per_m, other.stiffness_adiabatic_n_per_m) < 1e-10
                    );
                    // Derivatives by c10, as fits ask for them.
                    let mut moving = [shipped.still(), formula.still()];
                    let c10 = Jet::variable(3e5, 0);
                    moving[0].rubber.as_mut().unwrap().c10 = c10;
                    moving[1].energy.as_mut().unwrap().parameters[0] = c10;
                    let one = a.linearised(contraction, &moving[0], Approach::Auto).unwrap();
                    let other = b.linearised(contraction, &moving[1], Approach::Auto).unwrap();
                    let (one, other) = (one.force_n, other.force_n);
                    assert!(
                        (one.value - other.value).abs() < 1e-11 * (one.value.abs() + size),
                        "{one:?} {other:?}"
                    );
                    assert!(relative(one.by_lane[0], other.by_lane[0]) < 1e-7, "{one:?} {other:?}");
                    assert!(relative(one.by_pressure, other.by_pressure) < 1e-7, "{one:?} {other:?}");
                    tried += 1;
                }
            }
            assert!(tried > 8, "{tried}");
        }
    }

    const GENT: &str = "[effects.gent]\ntitle = \"Gent\"\nenergy = \"-h*mu*jm/2*ln(1 - (l1^2 + l2^2 + 1/(l1*l2)^2 - 3)/jm)\"\n\
        parameters.mu = { unit = \"MPa\", typical = \"0.6 MPa\", low = \"0 MPa\", high = \"6 MPa\" }\n\
        parameters.jm = { unit = \"1\", typical = 30, low = 5, high = 1e9 }\n\
        parameters.h = { unit = \"mm\", typical = \"2 mm\", low = \"0.5 mm\", high = \"5 mm\" }\n";
    const OGDEN: &str = "[effects.ogden]\ntitle = \"Ogden\"\nenergy = \"h*mu/a*(l1^a + l2^a + (l1*l2)^(-a) - 3)\"\n\
        parameters.mu = { unit = \"MPa\", typical = \"0.6 MPa\", low = \"0 MPa\", high = \"6 MPa\" }\n\
        parameters.a = { unit = \"1\", typical = 1.3, low = 0.5, high = 8 }\n\
        parameters.h = { unit = \"mm\", typical = \"2 mm\", low = \"0.5 mm\", high = \"5 mm\" }\n";

    /// Energies of even powers are solved with in closed form, however they are written; others give the same by
    /// series.
    #[test]
    fn even_powers_are_found() {
        let parameters =
            "parameters.k = { unit = \"N/m\", typical = \"500 N/m\", low = \"0 N/m\", high = \"1e6 N/m\" }\n";
        let of = |energy: &str| {
            own(&format!("[effects.own]\ntitle = \"Own\"\nenergy = \"{energy}\"\n{parameters}"))
        };
        let parts = |energy: &str| of(energy).reshaped(&[500.0], &clamped()).unwrap();
        let force = |parts: &Parts| force(parts, 3.0, 0.1);
        for (even, other) in [
            ("k*(l1^2 + (r/r0)^2 + 1/(l1*l2)^2 - 3)", "k*(l1^2 + l2^2 + 1/(l1*l2)^2.0000000000001 - 3)"),
            ("k*(l1^-2 + l2^-2 + (l1*l2)^2)", "k*(exp(-2*ln(l1)) + 1/l2^2 + l1^2*l2^2)"),
            ("0.5*k*((l1^2 - 1)^2 + (l2^2 - 1)^2)", "0.5*k*((sqrt(l1)^4 - 1)^2 + (l2^2 - 1)^2)"),
            ("k*(l2 - 1/l2)^2", "k*(sqrt(l2)^2 - 1/l2)^2"),
        ] {
            let (even, other) = (parts(even), parts(other));
            let is_even = |parts: &Parts| parts.energy.as_ref().unwrap().even.is_some();
            assert!(is_even(&even) && !is_even(&other));
            assert!((force(&even) / force(&other) - 1.0).abs() < 1e-11, "{} {}", force(&even), force(&other));
            assert!((force(&even) / force(&Parts::of(&clamped())) - 1.0).abs() > 1e-4);
        }
        for other in ["k*(l2 - 1)^2", "k*l1*l2", "k*(l1^2 + l2^2 - 2)^2/(l1^2 + l2^2)", "k*l2^6"] {
            assert!(parts(other).energy.unwrap().even.is_none(), "{other}");
        }
    }

    /// Every number of an elastic braid with rubber and formulas for energy and area, more than ten independent
    /// groups: its derivative against a difference.
    #[test]
    fn derivatives_by_all_parts_are_those_of_differences() {
        let muscle = preset("dmsp-20-250")
            .unwrap()
            .with(Parameter::Wall, 0.002)
            .and_then(|muscle| muscle.with(Parameter::C10, 2e5))
            .and_then(|muscle| muscle.with(Parameter::C01, 5e4))
            .and_then(|muscle| muscle.with(Parameter::FittingRadius, 0.0105))
            .unwrap();
        let energy = "[effects.own]\ntitle = \"Own\"\nenergy = \"a*l2^2.5 + b*l1^1.5 + c*ln(l2)^2 + d*l1*l2 + e*(l1 - 1)^4 + f*exp(l2)\"\n";
        let area =
            "[effects.area]\ntitle = \"Area\"\narea = \"pi*(r - t)^2*(1 + g*(l2 - 1)^2) + h*r*(r - r0)\"\n";
        let number = |name: &str, unit: &str| {
            format!(
                "parameters.{name} = {{ unit = \"{unit}\", typical = \"1 {unit}\", low = \"0 {unit}\", high = \"1e6 {unit}\" }}\n"
            )
        };
        let plain =
            |name: &str| format!("parameters.{name} = {{ unit = \"1\", typical = 1, low = 0, high = 10 }}\n");
        let energy: String =
            energy.to_owned() + &["a", "b", "c", "d", "e", "f"].map(|name| number(name, "N/m")).concat();
        let area = area.to_owned() + &number("t", "mm") + &plain("g") + &plain("h");
        let mut moving =
            own(&energy).reshaped(&[90.0, 70.0, 50.0, 40.0, 60.0, 20.0], &muscle).unwrap().still();
        own(&area).reshape(&[0.001, 0.1, 0.05].map(Jet::from), &mut moving).unwrap();
        moving.compliance = Jet::from(1e-5);
        let parts = moving.values();
        let (pressure, contraction) = (Pressure::bar(3.0), 0.1);
        let found = Problem::new(&parts, pressure).unwrap().gradient(contraction, Approach::Auto).unwrap();
        let mut tried = 0;
        for (name, number) in parts.numbers() {
            let step = 1e-5 * if number == 0.0 { 1e-3 } else { number };
            let at = |sign: f64| {
                let moved = parts.map(|other, value| if other == name { value + sign * step } else { value });
                let problem = Problem::new(&moved, pressure).unwrap();
                let found = problem.follow(contraction, Approach::Auto).unwrap();
                [found.force_n, found.volume_m3]
            };
            let (up, down) = (at(1.0), at(-1.0));
            let (_, exact) = found.by_part.iter().find(|(other, _)| *other == name).unwrap();
            // A difference is exact to the rounding of force and volume over the step.
            for (i, rounding) in [1e-8, 1e-14].into_iter().enumerate() {
                let difference = (up[i] - down[i]) / (2.0 * step);
                let bound = 1e-5 * exact[i].abs() + rounding / step;
                assert!((exact[i] - difference).abs() < bound, "{name} {i}: {} {difference}", exact[i]);
            }
            tried += u32::from(exact[0] != 0.0);
        }
        assert!(tried > 15, "{tried}");
    }

    /// dF = 2 pi r0 (W_1 - W_2 l1 cot^2(alpha0)/l2) for a cylinder, with W per area at rest.
    #[test]
    fn gent_and_ogden_pull_as_their_energies_say() {
        let (muscle, contraction) = (cylinder(), 0.15);
        let (s, c) = 25.0_f64.to_radians().sin_cos();
        let l1: f64 = 1.0 - contraction;
        let l2 = (1.0 - (l1 * c).powi(2)).sqrt() / s;
        let (mu, h, jm, a) = (6e5, 0.002, 30.0, 1.3);
        let i1 = l1 * l1 + l2 * l2 + 1.0 / (l1 * l2).powi(2);
        let gent = |x: f64, y: f64| h * mu * jm / (jm - (i1 - 3.0)) * (x - 1.0 / (x.powi(3) * y * y));
        let ogden = |x: f64, y: f64| h * mu * (x.powf(a) - (x * y).powf(-a)) / x;
        for (text, theta, slopes) in [
            (GENT, [mu, jm, h], [gent(l1, l2), gent(l2, l1)]),
            (OGDEN, [mu, a, h], [ogden(l1, l2), ogden(l2, l1)]),
        ] {
            let parts = own(text).reshaped(&theta, &muscle).unwrap();
            let expected = 2.0 * PI * 0.01 * (slopes[0] - slopes[1] * l1 * (c / s).powi(2) / l2);
            let found = force(&parts, 4.0, contraction) - force(&muscle, 4.0, contraction);
            assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
        }
        // Both tend to the neo-Hookean law with c10 = mu/2.
        let neo = force(&stated(&clamped(), 3e5), 3.0, 0.1);
        for (text, theta) in [(GENT, [6e5, 1e9, 0.002]), (OGDEN, [6e5, 2.0, 0.002])] {
            let limit = force(&own(text).reshaped(&theta, &clamped()).unwrap(), 3.0, 0.1);
            assert!((limit / neo - 1.0).abs() < 1e-6, "{limit} {neo}");
        }
    }

    /// Formulas for the gas on the inner face of a wall and for fibres that turn as in another braid agree
    /// with the catalogue.
    #[test]
    fn area_and_twist_are_those_of_the_net() {
        let muscle = clamped();
        let area = "[effects.inside]\ntitle = \"Inside\"\narea = \"pi*(r - t)^2\"\n\
            parameters.t = { unit = \"mm\", typical = \"1 mm\", low = \"0 mm\", high = \"5 mm\" }\n";
        let inside = own(area).reshaped(&[0.001], &muscle).unwrap();
        let wall = Parts::of(&muscle.with(Parameter::GasWall, 0.001).unwrap());
        let twist = "[effects.turn]\ntitle = \"Turn\"\ntwist = \"sin(alpha0)/r0*(1 + k*p)\"\n\
            parameters.k = { unit = \"1/MPa\", typical = 0.05, low = -1, high = 1 }\n"
            .replace(
                "typical = 0.05, low = -1, high = 1",
                "typical = \"0.05 1/MPa\", low = \"-1 1/MPa\", high = \"1 1/MPa\"",
            );
        let turned = own(&twist);
        for contraction in [0.02, 0.1, 0.2] {
            let (a, b) = (force(&inside, 3.0, contraction), force(&wall, 3.0, contraction));
            assert!((a / b - 1.0).abs() < 1e-10, "{a} {b}");
            // 5 % more turn at 2 bar corresponds to 1.25 % at 0.5 bar, because only the product counts.
            let at = |k: f64, bar: f64| {
                let parts = turned.reshaped(&[k], &muscle).unwrap();
                force(&parts, bar, contraction) / bar
            };
            let (a, b) = (at(0.25e-6, 2.0), at(1e-6, 0.5));
            assert!((a / b - 1.0).abs() < 1e-10 && (a / at(0.0, 2.0) - 1.0).abs() > 1e-3, "{a} {b}");
            // A formula that is sin(alpha0)/r0 to rounding is the muscle itself.
            assert!((at(1e-18, 2.0) / at(0.0, 2.0) - 1.0).abs() < 1e-10);
        }
        // At 0 nothing changes.
        assert_eq!(own(area).reshaped(&[0.0], &muscle).unwrap(), Parts::of(&muscle));
        assert_eq!(turned.reshaped(&[0.0], &muscle).unwrap(), Parts::of(&muscle));
        assert_eq!(own(SHAPE_EXAMPLE).reshaped(&[0.0, 0.002], &muscle).unwrap(), Parts::of(&muscle));
    }

    /// Since F = dU/dl at constant pressure, the force of a muscle with a formula derives from a potential.
    /// The test is dF/dp = -dV/dl.
    #[test]
    fn formulas_obey_maxwell() {
        let parts = own(GENT).reshaped(&[6e5, 20.0, 0.002], &clamped()).unwrap();
        let problem = Problem::new(&parts, Pressure::bar(3.0)).unwrap();
        for contraction in [0.02, 0.1, 0.18] {
            let gradient = problem.gradient(contraction, Approach::Auto).unwrap();
            let volume = gradient.by_contraction[1] / parts.length;
            assert!((gradient.by_pressure[0] / volume - 1.0).abs() < 1e-8);
        }
        let limit = problem.contraction_limit(Approach::Auto).unwrap();
        assert!(problem.solve(Given::Force(0.0), Approach::Auto).unwrap().contraction - limit < 1e-9);
    }

    #[test]
    fn as_many_kinks_as_are_solved_with() {
        let read = |count: usize| {
            let slings: Vec<String> = (0..count).map(|i| format!("max(0, l2 - 1.{i})")).collect();
            let energy = format!("k*({})", slings.join(" + "));
            let text = format!(
                "[effects.slings]\ntitle = \"Slings\"\nenergy = \"{energy}\"\n\
                 parameters.k = {{ unit = \"N/m\", typical = \"1 N/m\", low = \"0 N/m\", high = \"9 N/m\" }}\n"
            );
            from_toml(&text, "own.toml")
        };
        assert!(read(MOST_GAPS - 1).is_ok() && read(MOST_GAPS).is_ok());
        for count in [MOST_GAPS + 1, MOST_GAPS + 2] {
            let error = read(count).unwrap_err().to_string();
            assert!(error.contains(&format!("has {count} places where its branch may change")), "{error}");
        }
    }

    /// A sling that comes taut on the way. Its energy has a kink, so the meridian is integrated.
    #[test]
    fn a_kink_is_integrated() {
        let sling = "[effects.sling]\ntitle = \"Sling\"\nenergy = \"k*max(0, l2 - 1.2)^2\"\n\
            parameters.k = { unit = \"N/m\", typical = \"2000 N/m\", low = \"0 N/m\", high = \"1e6 N/m\" }\n";
        let at = |k: f64, contraction: f64| {
            let parts = own(sling).reshaped(&[k], &clamped()).unwrap();
            let problem = Problem::new(&parts, Pressure::bar(3.0)).unwrap();
            let found = problem.follow(contraction, Approach::Auto).unwrap();
            (found.force_n, problem.gradient(contraction, Approach::Auto).unwrap())
        };
        // The sling is slack up to a contraction. Beyond it the loss of force grows with the stiffness.
        assert!((at(2e3, 0.03).0 / at(0.0, 0.03).0 - 1.0).abs() < 1e-9);
        let [soft, stiff] = [2e3, 4e3].map(|k| at(0.0, 0.18).0 - at(k, 0.18).0);
        assert!(soft > 1.0 && stiff > 1.5 * soft, "{soft} {stiff}");
        let gradient = at(2e3, 0.18).1;
        let volume = gradient.by_contraction[1] / clamped().length().to_m();
        assert!((gradient.by_pressure[0] / volume - 1.0).abs() < 1e-8);
    }

    /// Laws that change their branch on the way, at radii that move with the numbers of law and muscle: derivatives
    /// against differences.
    #[test]
    fn derivatives_across_kinks_are_those_of_differences() {
        let law = |formula: &str| {
            own(&format!(
                "[effects.own]\ntitle = \"Own\"\n{formula}\n\
                parameters.k = {{ unit = \"N/m\", typical = \"1000 N/m\", low = \"0 N/m\", high = \"1e6 N/m\" }}\n\
                parameters.s = {{ unit = \"1\", typical = 1.2, low = 0.5, high = 2 }}\n"
            ))
        };
        let short = clamped().with(Parameter::Length, 0.04).unwrap();
        let laws = [
            ("energy = \"k*max(0, l2 - s)^2\"", 6e3, 1.2),
            ("energy = \"k*if(l2 > s, (l2 - s)^2*l1, 0) + k*max(0, l2 - 1.05)^3\"", 2e3, 1.12),
            ("energy = \"10*k*min(l1 - s, 0)^2 + k*(l1^2 + l2^2 + 1/(l1*l2)^2 - 3)\"", 300.0, 0.96),
            ("area = \"pi*r^2 - (k/1000 [N/m])*max(l2 - s, 0)^2*r0^2\"", 100.0, 1.1),
        ];
        for (formula, k, limit) in laws {
            for (muscle, compliance) in [(&clamped(), 0.0), (&clamped(), 1e-4), (&short, 0.0)] {
                let parts = law(formula).reshaped(&[k, limit], muscle).unwrap();
                let parts = Parts { compliance, ..parts };
                let force = |parts: &Parts, bar: f64, contraction: f64| {
                    let problem = Problem::new(parts, Pressure::bar(bar)).unwrap();
                    problem.follow(contraction, Approach::Auto).unwrap()
                };
                for contraction in [0.04, 0.08, 0.14] {
                    let problem = Problem::new(&parts, Pressure::bar(3.0)).unwrap();
                    let found = problem.follow(contraction, Approach::Auto).unwrap();
                    let gradient = problem.gradient(contraction, Approach::Auto).unwrap();
                    let close = |what: &str, exact: f64, high: f64, low: f64, step: f64, size: f64| {
                        let difference = (high - low) / step;
                        assert!(
                            (exact - difference).abs() < 3e-5 * difference.abs() + 2e-6 * size,
                            "{formula} {contraction} {what}: {exact} {difference}"
                        );
                    };
                    let h = 1e-4;
                    let [low, high] = [-h, h].map(|h| force(&parts, 3.0, contraction + h));
                    let size = found.force_n.abs() + 100.0;
                    close("length", gradient.by_contraction[0], high.force_n, low.force_n, 2.0 * h, size);
                    let [low, high] = [-h, h].map(|h| force(&parts, 3.0 + h, contraction));
                    close(
                        "pressure",
                        gradient.by_pressure[0] * 1e5,
                        high.force_n,
                        low.force_n,
                        2.0 * h,
                        size,
                    );
                    for (name, [by, _]) in &gradient.by_part {
                        let moved = |h: f64| {
                            let moved = parts
                                .map(|other, number| number * if other == *name { 1.0 + h } else { 1.0 });
                            force(&moved, 3.0, contraction).force_n
                        };
                        let value = parts.numbers().iter().find(|(other, _)| other == name).unwrap().1;
                        close(name, by * value, moved(h), moved(-h), 2.0 * h, size);
                    }
                }
            }
        }
    }

    /// Formulas that can't be solved with are told, with the stretches where.
    #[test]
    fn what_is_wrong_with_a_formula_is_told() {
        let jumps = "the slope of the formula for `energy` jumps at l1 = ";
        let ends = "the wall may be stretched to l1 = ";
        for (energy, clamped_braid, long_braid) in [
            ("k*abs(l2 - 1.2)", Some((jumps, "0.9510, l2 = 1.2000")), None),
            ("k*max(l2, 1.1)^2/100", Some((jumps, "0.9769, l2 = 1.1000")), None),
            ("k*sqrt(l2 - 1)", Some((ends, "1.0000, l2 = 1.0000")), None),
            ("k*ln(1.5 - l2)", Some((ends, "0.8529, l2 = 1.5012")), Some((ends, "0.7800, l2 = 1.6736"))),
        ] {
            let law = own(&format!(
                "[effects.own]\ntitle = \"Own\"\nenergy = \"{energy}\"\n\
                parameters.k = {{ unit = \"N/m\", typical = \"1000 N/m\", low = \"0 N/m\", high = \"1e6 N/m\" }}\n"
            ));
            for (muscle, expected) in [(clamped(), clamped_braid), (cylinder(), long_braid)] {
                let parts = law.reshaped(&[2000.0], &muscle).unwrap();
                let found = Problem::new(&parts, Pressure::bar(3.0)).unwrap().follow(0.22, Approach::Auto);
                let told = found.err().map(|error| error.to_string());
                let expected = expected.map(|(what, place)| format!("{what}{place}"));
                assert_eq!(told.is_some(), expected.is_some(), "{energy}: {told:?}");
                assert!(
                    told.as_ref().zip(expected).is_none_or(|(told, part)| told.contains(&part)),
                    "{energy}: {told:?}"
                );
            }
        }
    }

    /// An energy with a step that no series resolves: by pieces of the meridian it gives what the ODE gives.
    #[test]
    fn a_sharp_energy_is_solved_by_pieces() {
        let step = "[effects.step]\ntitle = \"Step\"\nenergy = \"k*atan((l2 - 1.3)/0.02)\"\n\
            parameters.k = { unit = \"N/m\", typical = \"5 N/m\", low = \"0 N/m\", high = \"1e6 N/m\" }\n";
        let at = |k: f64, approach: Approach| {
            let parts = own(step).reshaped(&[k], &clamped()).unwrap();
            Problem::new(&parts, Pressure::bar(3.0)).unwrap().follow(0.12, approach).unwrap()
        };
        let (auto, ode) = (at(5.0, Approach::Auto), at(5.0, Approach::Shooting));
        assert!((auto.force_n / ode.force_n - 1.0).abs() < 1e-9, "{} {}", auto.force_n, ode.force_n);
        assert!((auto.volume_m3 / ode.volume_m3 - 1.0).abs() < 1e-9);
        assert!((auto.force_n / at(0.0, Approach::Auto).force_n - 1.0).abs() > 1e-3);
    }

    /// A parameter at which the formula vanishes leaves the muscle as it is; one that acts only far away
    /// doesn't.
    #[test]
    fn what_changes_nothing_is_left_out() {
        let untouched = Parts::of(&clamped());
        let sling = "[effects.sling]\ntitle = \"Sling\"\nenergy = \"k*max(0, l2 - 1.9)^2\"\n\
            parameters.k = { unit = \"N/m\", typical = \"2000 N/m\", low = \"0 N/m\", high = \"1e6 N/m\" }\n";
        let turn = "[effects.turn]\ntitle = \"Turn\"\ntwist = \"sin(alpha0)/r0*(1 + k*p)\"\n\
            parameters.k = { unit = \"1/MPa\", typical = \"0.05 1/MPa\", low = \"-1 1/MPa\", high = \"1 1/MPa\" }\n";
        for (text, theta) in [(SHAPE_EXAMPLE, vec![0.0, 0.002]), (sling, vec![0.0]), (turn, vec![0.0])] {
            assert_eq!(own(text).reshaped(&theta, &clamped()).unwrap(), untouched, "{text}");
        }
        assert!(own(sling).reshaped(&[1e3], &clamped()).unwrap().energy.is_some());
        assert!(own(turn).reshaped(&[1e-9], &clamped()).unwrap().twist.is_some());
        let depth = "[effects.crest]\ntitle = \"Crest\"\narea = \"pi*(r + h)^2\"\n\
            parameters.h = { unit = \"mm\", typical = \"1 mm\", low = \"0 mm\", high = \"5 mm\" }\n";
        assert_eq!(own(depth).reshaped(&[0.0], &clamped()).unwrap(), untouched);
    }

    /// Fibres lie along the circumference at the fittings where sin(alpha0) (1 + k p) is 1: with 25 degrees and 5/MPa at
    /// 2.732 bar. Beyond, there is no equilibrium, below, there are those of another braid.
    #[test]
    fn fibres_turned_further_than_the_fittings_bear_are_refused_at_their_pressures() {
        let turned = own("[effects.turn]\ntitle = \"Turn\"\ntwist = \"sin(alpha0)/r0*(1 + k*p)\"\n\
            parameters.k = { unit = \"1/MPa\", typical = \"1 1/MPa\", low = \"0 1/MPa\", high = \"9 1/MPa\" }\n");
        let problem =
            Problem::new(turned.reshaped(&[5e-6], &clamped()).unwrap(), Pressure::bar(9.0)).unwrap();
        let at = |bar: f64, contraction: f64| {
            let problem = problem.at_pressure(Pressure::bar(bar)).unwrap();
            problem.solve(Given::Contraction(contraction), Approach::Auto)
        };
        let is_too_wide = |bar| matches!(at(bar, 0.02), Err(FibreError::FittingTooWide { .. }));
        assert!(is_too_wide(2.74) && is_too_wide(9.0) && !is_too_wide(2.72));
        assert!(at(0.5, 0.02).unwrap().force_n > 0.0);
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let none = SHAPE_EXAMPLE.replace("l1^2 +", "ln(l1 - 2) +");
        let parts = own(&none).reshaped(&[3e5, 0.002], &clamped()).unwrap();
        let message = Problem::new(&parts, Pressure::bar(1.0)).unwrap_err().to_string();
        assert!(message.contains("`energy` is NaN at rest"), "{message}");
        let lobed = preset("ppam-2-r16").unwrap().with(Parameter::ClothCircumference, 0.33).unwrap();
        let area = "[effects.x]\ntitle = \"x\"\narea = \"pi*(r + t)^2\"\n\
            parameters.t = { unit = \"mm\", typical = \"1 mm\", low = \"0 mm\", high = \"5 mm\" }\n";
        let parts = own(area).reshaped(&[0.001], &lobed).unwrap();
        let message = Problem::new(&parts, Pressure::bar(1.0)).unwrap_err().to_string();
        assert!(message.contains("so does `lobes`"), "{message}");
        let two = own(SHAPE_EXAMPLE);
        let mut parts = two.reshaped(&[3e5, 0.002], &clamped()).unwrap().still();
        let theta = [3e5, 0.002].map(Jet::from);
        let message = two.reshape(&theta, &mut parts).unwrap_err().to_string();
        assert!(message.contains("energy") && message.contains("sum"), "{message}");
        for (formula, part) in [
            ("area = \"pi*r^2*l1*t/t\"", "can't depend on `l1`"),
            ("twist = \"1/r*t/t\"", "can't depend on `r`"),
            ("energy = \"t\"", "(m)"),
            ("energy = \"t*eps*1 [Pa]\"", "unknown name `eps`"),
            ("energy = \"t*1 [Pa]\"\nforce = \"t*1 [N/m]\"", "one for"),
        ] {
            let text = format!(
                "[effects.x]\ntitle = \"x\"\n{formula}\nparameters.t = {{ unit = \"mm\", typical = \"1 mm\", low = \"0 mm\", high = \"5 mm\" }}\n"
            );
            let message = from_toml(&text, "own.toml").unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
        let names: Vec<String> = (0..=MOST_PARAMETERS).map(|i| format!("a{i}")).collect();
        let known: Vec<(&str, Dimension)> =
            names.iter().map(|name| (name.as_str(), Dimension::LINE_STIFFNESS)).collect();
        let sum = names.join(" + ");
        let error = ShapeFormula::parse(ShapeQuantity::Energy, &sum, &known).unwrap_err();
        assert!(error.what().contains("at most 6") && MOST_PARAMETERS < MAX_PARAMETERS);
    }
}
