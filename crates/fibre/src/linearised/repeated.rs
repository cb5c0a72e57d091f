//! The same question at many pressures and contractions. Everything that doesn't depend on them is computed
//! once.

use bulge_muscles::{Pressure, Quantity};

use super::straight::Straight;
use super::{Linearised, Start};
use crate::FibreError;
use crate::outcome::Approach;
use crate::parts::{Jet, Parts};
use crate::problem::Problem;

/// The parts of a muscle with the derivatives that its answers have.
#[derive(Debug, Clone)]
pub struct Repeated {
    problem: Problem,
    moving: Parts<Jet>,
    /// The closed form, if there is one.
    straight: Option<Straight>,
}

/// An arbitrary pressure to make the problem.
const REFERENCE: f64 = 1e5;

impl Repeated {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Those of [`Problem::new`].
    pub fn new(moving: Parts<Jet>) -> Result<Self, FibreError> {
        let problem = Problem::new(moving.values(), Pressure::pa(REFERENCE))?;
        let straight = Straight::of(&problem, &moving);
        Ok(Self { problem, moving, straight })
    }

    /// The muscle at an arbitrary pressure.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// [`Problem::linearised_from`] at a gauge pressure, for a fit. From a neighbouring equilibrium the
    /// values of straight fibres are as exact as without one, to 1e-13, and their derivatives to 3e-7.
    ///
    /// # Errors
    /// Those of [`Problem::at_pressure`] and [`Problem::linearised`].
    pub fn linearised_from(
        &self,
        start: Option<&Start>,
        pressure: Pressure,
        contraction: f64,
    ) -> Result<Linearised, FibreError> {
        let found =
            self.straight.as_ref().and_then(|straight| straight.at(start, pressure.si(), contraction));
        // If there is no answer, or none that makes sense, the usual way tells why.
        found.map_or_else(
            || {
                self.problem.at_pressure(pressure)?.linearised_from(
                    start,
                    contraction,
                    &self.moving,
                    Approach::Auto,
                )
            },
            Ok,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linearised::Linear;
    use bulge_muscles::{Muscle, Parameter, from_toml};

    fn pleated(extra: &str) -> Muscle {
        let text = format!(
            "name = \"x\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\n{extra}\n"
        );
        from_toml(&text, "m.toml").unwrap()
    }

    /// The values agree within the first part, the slopes by contraction, pressure and the variables, of
    /// these sizes, within the second.
    fn close(a: &Linear, b: &Linear, [value, slope]: [f64; 2], sizes: &[f64]) {
        assert!((a.value - b.value).abs() <= value * b.value.abs(), "{a:?} {b:?}");
        let slopes = |l: &Linear| -> Vec<f64> {
            [l.by_contraction, l.by_pressure].iter().chain(&l.by_lane).copied().collect()
        };
        let (a_slopes, b_slopes) = (slopes(a), slopes(b));
        for ((x, y), size) in a_slopes.into_iter().zip(b_slopes).zip(sizes) {
            // A slope may vanish where the value doesn't.
            assert!((x - y).abs() <= slope * (y.abs() + b.value.abs() / size), "{x} {y}");
        }
    }

    fn all_close(a: &Linearised, b: &Linearised, parts: [f64; 2], sizes: &[f64]) {
        close(&a.force_n, &b.force_n, parts, sizes);
        close(&a.equator_force_n, &b.equator_force_n, parts, sizes);
        close(&a.mid_radius_m, &b.mid_radius_m, parts, sizes);
        close(&a.volume_polygon_m3, &b.volume_polygon_m3, parts, sizes);
    }

    #[test]
    fn the_short_way_is_the_usual_one() {
        use Parameter::{FibreStiffness, Fibres, Length, Radius};
        let cases = [
            (pleated(""), vec![Radius, Length, Fibres]),
            (
                pleated("[fibre]\nstiffness = \"12.5 kN\"\n[effects.pleat-depth]\ndepth = \"2 mm\""),
                vec![Length, FibreStiffness, Radius],
            ),
            (pleated("[fibre]\nstiffness = \"12.5 kN\""), Vec::new()),
        ];
        for (muscle, parameters) in cases {
            let moving = Parts::seeded(&muscle, &parameters);
            let repeated = Repeated::new(moving.clone()).unwrap();
            assert!(repeated.straight.is_some());
            let mut near: Option<Start> = None;
            for i in 0..40 {
                let (pressure, contraction) =
                    (Pressure::kpa(100.0 + 5.0 * f64::from(i)), 0.01 + 0.009 * f64::from(i));
                let problem = Problem::new(&muscle, pressure).unwrap();
                let usual = problem.linearised(contraction, &moving, Approach::Auto).unwrap();
                let mut sizes = vec![1.0, pressure.si()];
                sizes.extend(parameters.iter().filter_map(|parameter| muscle.get(*parameter)));
                let short = repeated.linearised_from(None, pressure, contraction).unwrap();
                all_close(&short, &usual, [1e-14, 1e-12], &sizes);
                let moved = repeated.linearised_from(near.as_ref(), pressure, contraction).unwrap();
                all_close(&moved, &usual, [1e-12, 3e-6], &sizes);
                near = moved.start().cloned();
            }
        }
    }

    #[test]
    fn errors_are_those_of_the_usual_way() {
        let repeated = Repeated::new(Parts::of(&pleated("")).still()).unwrap();
        let at = |pa: f64, contraction: f64| {
            let usual = Problem::new(&pleated(""), Pressure::pa(pa)).and_then(|problem| {
                problem.linearised(contraction, &problem.parts().still(), Approach::Auto)
            });
            let short = repeated.linearised_from(None, Pressure::pa(pa), contraction);
            assert_eq!(short.unwrap_err(), usual.unwrap_err());
        };
        at(-1.0, 0.1);
        at(1e5, -0.01);
        at(1e5, 1.2);
    }
}
