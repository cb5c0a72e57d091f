//! Enclosed gas, and a closed muscle, which is filled, shut, and then moved.
//!
//! ```text
//! P (V(p, e) + Vd)^n = P1 (V(p1, e1) + Vd)^n        1 <= n <= 1.4: isothermal (slow) to adiabatic (fast)
//! m = P1 (V1 + Vd)/(R T1),    T = T1 P (V + Vd)/(P1 (V1 + Vd))
//! ```
//! For inextensible fibres V depends on e alone, and p follows directly. If fibres, bladder or cloth stretch,
//! p is the root of an equation. V is `Response::volume_m3`.

use std::cell::Cell;

use bulge_fibre::{Approach, Response};
use bulge_model::MuscleWithEffects;
use serde::Serialize;

use super::chamber::{Chamber, Inside, Load, with_gas};
use super::muscle::{failed, pulling};
use super::surroundings::Surroundings;
use super::{AMBIENT_TEMPERATURE_K, GAMMA, GasError, R_AIR, at_least, finite, positive};

/// Enclosed gas with its polytropic exponent.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShutGas {
    pub(crate) surroundings: Surroundings,
    pub(crate) exponent: f64,
    /// Gauge pressure at which it was enclosed \[Pa\].
    pub(crate) pressure_pa: f64,
    /// Volume of the muscle when it was enclosed \[m^3\].
    pub(crate) volume_m3: f64,
}

impl ShutGas {
    /// P1 (V1 + Vd) \[J\].
    fn filled(&self) -> f64 {
        self.surroundings.absolute(self.pressure_pa) * self.surroundings.gas_volume(self.volume_m3)
    }

    /// The state of the chamber that obeys the law of the gas. The search starts from a gauge pressure
    /// \[Pa\].
    pub(crate) fn state(
        &self,
        inside: impl Fn(f64) -> Result<Inside, GasError>,
        start_pa: f64,
    ) -> Result<Inside, GasError> {
        let around = self.surroundings;
        let z =
            around.absolute(self.pressure_pa).ln() + self.exponent * around.gas_volume(self.volume_m3).ln();
        with_gas(inside, around.ambient_pa, [z, self.exponent], start_pa)
    }
}

/// A muscle with enclosed gas.
#[derive(Debug, Clone, Copy)]
pub struct ClosedMuscle<'a> {
    pub(super) muscle: &'a MuscleWithEffects,
    pub(super) approach: Approach,
    pub(super) gas: ShutGas,
    temperature_k: f64,
}

/// A state of a closed muscle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ClosedState {
    /// Gauge pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contraction.
    pub contraction: f64,
    /// Pull \[N\].
    pub force_n: f64,
    /// Volume of the muscle \[m^3\], without the dead volume.
    pub volume_m3: f64,
    /// Temperature of the gas after the polytropic change \[K\].
    pub temperature_k: f64,
    /// Mass of the gas including the dead volume \[kg\]; the same in every state.
    pub mass_kg: f64,
    /// The equilibrium. Its stiffnesses with enclosed gas don't include the dead volume; see
    /// [`ClosedMuscle::stiffness`].
    pub response: Response,
}

impl<'a> ClosedMuscle<'a> {
    /// A muscle that was filled to a gauge pressure \[Pa\] > 0 at a contraction and then shut. The exponent
    /// is from 1 (isothermal) to 1.4 (adiabatic). Unless changed, there is no dead volume, the temperature is
    /// 293.15 K, and the ambient pressure is 101325 Pa.
    ///
    /// # Errors
    /// [`GasError::Number`], or [`GasError::Muscle`] if the muscle doesn't pull at that contraction.
    pub fn new(
        muscle: &'a MuscleWithEffects,
        pressure_pa: f64,
        contraction: f64,
        exponent: f64,
    ) -> Result<Self, GasError> {
        positive("the gauge pressure of the filling [Pa]", pressure_pa)?;
        if !(1.0..=GAMMA).contains(&exponent) {
            return Err(GasError::number(
                "the polytropic exponent",
                exponent,
                "give a number from 1 (isothermal) to 1.4 (adiabatic)",
            ));
        }
        let found = pulling(muscle, pressure_pa, contraction, Approach::Auto);
        let volume_m3 = found.map_err(|error| failed(pressure_pa, error))?.volume_m3;
        let gas = ShutGas { surroundings: Surroundings::STANDARD, exponent, pressure_pa, volume_m3 };
        Ok(Self { muscle, approach: Approach::Auto, gas, temperature_k: AMBIENT_TEMPERATURE_K })
    }

    /// The muscle with the dead volume \[m^3\] of tubes and fittings.
    ///
    /// # Errors
    /// [`GasError::Number`] unless it is finite and not negative.
    pub fn with_dead_volume(mut self, volume_m3: f64) -> Result<Self, GasError> {
        self.gas.surroundings = self.gas.surroundings.with_dead_volume(volume_m3)?;
        Ok(self)
    }

    /// The muscle at another ambient pressure \[Pa\], absolute.
    ///
    /// # Errors
    /// [`GasError::Number`] unless it is positive.
    pub fn with_ambient(mut self, pressure_pa: f64) -> Result<Self, GasError> {
        self.gas.surroundings = self.gas.surroundings.with_ambient(pressure_pa)?;
        Ok(self)
    }

    /// The muscle filled with gas of this temperature \[K\].
    ///
    /// # Errors
    /// [`GasError::Number`] unless it is positive.
    pub fn at_temperature(mut self, temperature_k: f64) -> Result<Self, GasError> {
        self.temperature_k = positive("the temperature of the gas [K]", temperature_k)?;
        Ok(self)
    }

    /// Mass of the gas including the dead volume \[kg\].
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.gas.filled() / (R_AIR * self.temperature_k)
    }

    /// The state at a contraction.
    ///
    /// # Errors
    /// [`GasError::Muscle`] if the muscle doesn't pull at that contraction, or [`GasError::NoBalance`].
    pub fn at_contraction(&self, contraction: f64) -> Result<ClosedState, GasError> {
        finite("the contraction [%]", contraction)?;
        let inside = self.shut(Load::Held(contraction))?;
        self.state(inside.pressure_pa, contraction)
    }

    /// The state under a force \[N\] >= 0, including the contraction.
    ///
    /// # Errors
    /// [`GasError::Number`], [`GasError::Muscle`] if the muscle can't carry the force, or
    /// [`GasError::NoBalance`].
    pub fn under_force(&self, force_n: f64) -> Result<ClosedState, GasError> {
        at_least("the force [N]", force_n, 0.0, "give a finite force from 0 on: a muscle doesn't push")?;
        let inside = self.shut(Load::Force(force_n))?;
        self.state(inside.pressure_pa, inside.contraction)
    }

    fn shut(&self, load: Load<'a>) -> Result<Inside, GasError> {
        let chamber =
            Chamber::muscle(self.muscle, load)?.within(self.gas.surroundings).solved_by(self.approach);
        let near = Cell::new(None);
        let inside = |p: f64| {
            let found = chamber.inside(p, false, near.get())?;
            near.set(Some(found.contraction));
            Ok(found)
        };
        self.gas.state(inside, self.gas.pressure_pa)
    }

    fn state(&self, pressure_pa: f64, contraction: f64) -> Result<ClosedState, GasError> {
        let response = pulling(self.muscle, pressure_pa, contraction, self.approach)
            .map_err(|error| failed(pressure_pa, error))?;
        let around = self.gas.surroundings;
        let now = around.absolute(pressure_pa) * around.gas_volume(response.volume_m3);
        Ok(ClosedState {
            pressure_pa,
            contraction,
            force_n: response.force_n,
            volume_m3: response.volume_m3,
            temperature_k: self.temperature_k * now / self.gas.filled(),
            mass_kg: self.mass_kg(),
            response,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gas::examples::{braid, learnt, pleated, soft};
    use bulge_fibre::Given;
    use bulge_muscles::Pressure;
    use bulge_muscles::Quantity as _;
    use bulge_numerics::gauss::SIX;

    const P0: f64 = 101_325.0;

    /// Integral of f over a range of contractions.
    fn over([from, to]: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
        let panels = 12;
        let width = (to - from) / f64::from(panels);
        (0..panels)
            .flat_map(|k| SIX.map(|(at, weight)| (from + width * (f64::from(k) + at), weight * width)))
            .map(|(e, weight)| weight * f(e))
            .sum()
    }

    #[test]
    fn inextensible_muscles_follow_the_law_by_hand() {
        for (muscle, n, dead) in [(pleated(), 1.0, 0.0), (pleated(), 1.4, 5e-5), (braid(), 1.2, 2e-5)] {
            let volume = |e: f64| {
                muscle.solve(Pressure::bar(1.0), Given::Contraction(e), Approach::Auto).unwrap().volume_m3
            };
            let closed = ClosedMuscle::new(&muscle, 2e5, 0.1, n).unwrap().with_dead_volume(dead).unwrap();
            let mass = (2e5 + P0) * (volume(0.1) + dead) / (287.05 * 293.15);
            assert!((closed.mass_kg() / mass - 1.0).abs() < 1e-12);
            for e in [0.03, 0.1, 0.2, 0.25] {
                let found = closed.at_contraction(e).unwrap();
                let ratio = (volume(0.1) + dead) / (volume(e) + dead);
                let absolute = (2e5 + P0) * ratio.powf(n);
                assert!(((found.pressure_pa + P0) / absolute - 1.0).abs() < 1e-11);
                assert!((found.temperature_k / (293.15 * ratio.powf(n - 1.0)) - 1.0).abs() < 1e-11);
                let alone =
                    muscle.solve(Pressure::pa(absolute - P0), Given::Contraction(e), Approach::Auto).unwrap();
                assert!((found.force_n / alone.force_n - 1.0).abs() < 1e-10);
                assert_eq!(found.mass_kg.to_bits(), closed.mass_kg().to_bits());
            }
        }
    }

    #[test]
    fn muscles_that_stretch_follow_it_with_their_own_volume() {
        for (muscle, p) in [(soft(), 3e5), (learnt(), 2e5)] {
            let closed = ClosedMuscle::new(&muscle, p, 0.1, 1.4)
                .unwrap()
                .with_dead_volume(1e-5)
                .unwrap()
                .at_temperature(300.0)
                .unwrap()
                .with_ambient(9e4)
                .unwrap();
            let law = |s: &ClosedState| (s.pressure_pa + 9e4) * (s.volume_m3 + 1e-5).powf(1.4);
            let first = closed.at_contraction(0.1).unwrap();
            assert!((first.pressure_pa / p - 1.0).abs() < 1e-10);
            for e in [0.06, 0.15, 0.2] {
                let found = closed.at_contraction(e).unwrap();
                assert!(
                    (law(&found) / law(&first) - 1.0).abs() < 1e-9,
                    "{}",
                    law(&found) / law(&first) - 1.0
                );
                // m R T = P (V + Vd).
                let gas = (found.pressure_pa + 9e4) * (found.volume_m3 + 1e-5);
                assert!((gas / (found.mass_kg * R_AIR * found.temperature_k) - 1.0).abs() < 1e-12);
            }
        }
        // The effect is relevant: at the same contraction the volume of the soft muscle changes with the
        // pressure by more than 1 %.
        let muscle = soft();
        let volume = |bar: f64| {
            muscle.solve(Pressure::bar(bar), Given::Contraction(0.1), Approach::Auto).unwrap().volume_m3
        };
        assert!(volume(3.0) / volume(1.0) > 1.01);
    }

    #[test]
    fn the_force_finds_its_contraction() {
        for (muscle, tolerance) in [(pleated(), 1e-10), (soft(), 1e-9), (braid(), 1e-10), (learnt(), 1e-8)] {
            let closed = ClosedMuscle::new(&muscle, 2e5, 0.1, 1.3).unwrap().with_dead_volume(1e-5).unwrap();
            for e in [0.07, 0.13, 0.2] {
                let there = closed.at_contraction(e).unwrap();
                let back = closed.under_force(there.force_n).unwrap();
                assert!((back.contraction - e).abs() < tolerance, "{e}: {}", back.contraction - e);
                assert!((back.pressure_pa / there.pressure_pa - 1.0).abs() < 10.0 * tolerance);
            }
        }
    }

    /// First law: the work put in, F dl, equals the energy gained by the gas minus the work of the
    /// atmosphere.
    #[test]
    fn work_is_the_energy_of_the_gas() {
        for muscle in [pleated(), braid()] {
            let l0 = muscle.muscle().length().si();
            for n in [1.0, 1.25, 1.4] {
                let closed =
                    ClosedMuscle::new(&muscle, 2e5, 0.22, n).unwrap().with_dead_volume(3e-5).unwrap();
                let ends = [0.22, 0.05];
                let work = -l0 * over(ends, |e| closed.at_contraction(e).unwrap().force_n);
                let [a, b] = ends.map(|e| closed.at_contraction(e).unwrap());
                let gas = |s: &ClosedState| (s.pressure_pa + P0) * (s.volume_m3 + 3e-5);
                let given = if n > 1.0 {
                    (gas(&b) - gas(&a)) / (n - 1.0)
                } else {
                    gas(&a) * ((a.volume_m3 + 3e-5) / (b.volume_m3 + 3e-5)).ln()
                };
                let wanted = given + P0 * (b.volume_m3 - a.volume_m3);
                assert!((work / wanted - 1.0).abs() < 1e-8, "{n}: {}", work / wanted - 1.0);
                assert!(work > 0.0);
            }
        }
    }

    /// Forward by the contraction, back by the force: F dl + l dF over the closed path is zero, even if
    /// fibres store energy.
    #[test]
    fn a_closed_path_takes_no_work() {
        let muscle = soft();
        let closed = ClosedMuscle::new(&muscle, 2e5, 0.1, 1.4).unwrap();
        let [a, b] = [0.1, 0.2].map(|e| closed.at_contraction(e).unwrap());
        let there = -0.11 * over([0.1, 0.2], |e| closed.at_contraction(e).unwrap().force_n);
        let length = |force: f64| closed.under_force(force).unwrap().response.length_m;
        let back = over([b.force_n, a.force_n], length);
        let corners = a.force_n * a.response.length_m - b.force_n * b.response.length_m;
        assert!((there + corners - back).abs() < 1e-8 * there.abs(), "{there} {back} {corners}");
    }

    #[test]
    fn pull_is_minus_p_times_the_volume_by_the_length() {
        for muscle in [pleated(), braid()] {
            let closed = ClosedMuscle::new(&muscle, 2e5, 0.15, 1.0).unwrap();
            let at = |e: f64| closed.at_contraction(e).unwrap();
            let h = 1e-4;
            let volume = at(0.15 + h).volume_m3 - at(0.15 - h).volume_m3;
            let length = at(0.15 + h).response.length_m - at(0.15 - h).response.length_m;
            assert!((-2e5 * volume / length / at(0.15).force_n - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn what_cannot_be_is_said() {
        let muscle = pleated();
        for (p, e, n) in
            [(0.0, 0.1, 1.0), (f64::NAN, 0.1, 1.0), (1e5, 0.1, 0.9), (1e5, 0.1, 1.41), (1e5, 0.1, f64::NAN)]
        {
            assert!(matches!(ClosedMuscle::new(&muscle, p, e, n), Err(GasError::Number { .. })));
        }
        assert!(matches!(ClosedMuscle::new(&muscle, 1e5, 0.7, 1.0), Err(GasError::Muscle { .. })));
        assert!(matches!(ClosedMuscle::new(&muscle, 1e5, f64::NAN, 1.0), Err(GasError::Muscle { .. })));
        let closed = ClosedMuscle::new(&muscle, 1e4, 0.05, 1.0).unwrap();
        assert!(closed.with_dead_volume(-1.0).is_err() && closed.with_ambient(0.0).is_err());
        assert!(closed.at_temperature(f64::INFINITY).is_err());
        assert!(closed.at_contraction(f64::NAN).is_err() && closed.at_contraction(0.0).is_err());
        assert!(closed.under_force(-1.0).is_err() && closed.under_force(f64::NAN).is_err());
        // At this contraction the small amount of gas would be below the ambient pressure.
        let error = closed.at_contraction(0.3).unwrap_err();
        assert!(matches!(error, GasError::NoBalance(_)), "{error}");
        assert!(error.to_string().contains("start with a higher pressure"));
    }
}
