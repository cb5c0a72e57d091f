//! The stiffness of a closed muscle, split into the contributions of its geometry and of its gas.
//!
//! ```text
//! K = dF/dl = F_l + F_p dp/dl,      dp/dl = -n P V_l/(V + Vd + n P V_p)
//! ```
//! Subscripts denote derivatives with respect to the length at constant pressure and to the pressure at
//! constant length. F_l is `Response::stiffness_n_per_m`; V and its derivatives are those of `volume_m3`.
//! With Vd = 0, n = 1 or 1.4 and p0 = 101325 Pa, K is `Response::stiffness_isothermal_n_per_m` or
//! `_adiabatic_n_per_m`. These take V and V_l from the polygonal volume, but it is a constant fraction of the
//! circular one, which cancels in dp/dl. With dead volume it doesn't cancel, and V must be the volume that
//! the gas fills. In the limit Vd -> infinity the pressure is constant and K = F_l.
//!
//! F_p and V_p are exact (`Problem::gradient`, or F/p and 0 if nothing but the pressure shapes the muscle).
//! The contribution to F_p of effects that add to the force is a central difference over 1e-3 of the
//! pressure.

use bulge_muscles::Quantity as _;
use serde::Serialize;

use super::GasError;
use super::closed::{ClosedMuscle, ClosedState};
use super::muscle::{failed, follow, problem};

/// Relative pressure step for the force of added effects.
const DIFFERENCE: f64 = 1e-3;

/// The stiffness of a closed muscle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StiffnessSplit {
    /// Contribution F_l of the geometry, at constant pressure \[N/m\].
    pub geometry_n_per_m: f64,
    /// Contribution F_p dp/dl of the enclosed gas \[N/m\].
    pub gas_n_per_m: f64,
    /// Their sum, dF/dl of the closed muscle \[N/m\].
    pub total_n_per_m: f64,
    /// F_p, derivative of the pull with respect to the pressure at constant length \[m^2\].
    pub force_by_pressure_m2: f64,
    /// V_p at constant length \[m^3/Pa\]; 0 if nothing stretches.
    pub volume_by_pressure_m3_per_pa: f64,
    /// V_l at constant pressure \[m^2\], of the volume that the gas fills.
    pub volume_by_length_m2: f64,
    /// dp/dl of the closed muscle \[Pa/m\].
    pub pressure_by_length_pa_per_m: f64,
}

impl ClosedMuscle<'_> {
    /// Stiffness at a contraction: [`ClosedMuscle::at_contraction`], then the split.
    ///
    /// # Errors
    /// Those of [`ClosedMuscle::at_contraction`].
    pub fn stiffness(&self, contraction: f64) -> Result<StiffnessSplit, GasError> {
        self.split(&self.at_contraction(contraction)?)
    }

    /// Stiffness at a state of this muscle.
    ///
    /// # Errors
    /// [`GasError::Muscle`] if the derivatives can't be computed.
    pub fn split(&self, state: &ClosedState) -> Result<StiffnessSplit, GasError> {
        let response = &state.response;
        let [force_p, volume_p] = self.by_pressure(state)?;
        let volume_l = response.volume_slope_m2 * response.volume_m3 / response.volume_polygon_m3;
        let absolute = self.gas.exponent * self.gas.surroundings.absolute(state.pressure_pa);
        let pressure_l = -absolute * volume_l
            / (self.gas.surroundings.gas_volume(response.volume_m3) + absolute * volume_p);
        let geometry_n_per_m = response.stiffness_n_per_m;
        let gas_n_per_m = force_p * pressure_l;
        Ok(StiffnessSplit {
            geometry_n_per_m,
            gas_n_per_m,
            total_n_per_m: geometry_n_per_m + gas_n_per_m,
            force_by_pressure_m2: force_p,
            volume_by_pressure_m3_per_pa: volume_p,
            volume_by_length_m2: volume_l,
            pressure_by_length_pa_per_m: pressure_l,
        })
    }

    /// F_p and V_p at constant length.
    fn by_pressure(&self, state: &ClosedState) -> Result<[f64; 2], GasError> {
        let p = state.pressure_pa;
        let problem = problem(self.muscle, p)?;
        let failed = |error: bulge_fibre::FibreError| failed(p, error);
        let own = 1.0 - state.response.length_m / self.muscle.parts().length;
        let plain = |p: f64| {
            problem.at_pressure(bulge_muscles::Pressure::pa(p)).and_then(|at| at.follow(own, self.approach))
        };
        let mut by = if problem.is_scale_free() {
            [plain(p).map_err(failed)?.force_n / p, 0.0]
        } else {
            problem.gradient(own, self.approach).map_err(failed)?.by_pressure
        };
        if self.muscle.adds_force() {
            let added = |p: f64| {
                let with = follow(self.muscle, p, state.contraction, self.approach)?;
                Ok::<_, GasError>(with.force_n - plain(p).map_err(failed)?.force_n)
            };
            let h = DIFFERENCE * p;
            by[0] += (added(p + h)? - added(p - h)?) / (2.0 * h);
        }
        Ok(by)
    }

    /// Unpressurised length to which contractions refer \[m\].
    #[must_use]
    pub fn rest_length_m(&self) -> f64 {
        self.muscle.muscle().length().si()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gas::examples::{braid, forty, learnt, pleated, soft};

    /// dF/dl by differences of fourth order.
    fn differenced(closed: &ClosedMuscle<'_>, e: f64) -> f64 {
        let h = 2e-4;
        let force = |k: f64| closed.at_contraction(e + k * h).unwrap().force_n;
        let slope = (8.0 * (force(1.0) - force(-1.0)) - (force(2.0) - force(-2.0))) / (12.0 * h);
        -slope / closed.rest_length_m()
    }

    #[test]
    fn the_split_is_the_slope_of_the_closed_muscle() {
        for (muscle, tolerance) in
            [(pleated(), 1e-7), (forty(), 1e-7), (soft(), 1e-7), (braid(), 1e-7), (learnt(), 2e-6)]
        {
            for (n, dead) in [(1.0, 0.0), (1.2, 3e-5), (1.4, 1e-4)] {
                let closed = ClosedMuscle::new(&muscle, 2e5, 0.1, n).unwrap().with_dead_volume(dead).unwrap();
                let split = closed.stiffness(0.12).unwrap();
                let slope = differenced(&closed, 0.12);
                assert!((split.total_n_per_m / slope - 1.0).abs() < tolerance, "{split:?} {slope}");
                assert!(split.gas_n_per_m > 0.0 && split.geometry_n_per_m > 0.0);
            }
        }
    }

    #[test]
    fn without_dead_volume_it_is_that_of_the_response() {
        for (muscle, tolerance) in [(pleated(), 1e-12), (forty(), 1e-12), (soft(), 1e-9), (learnt(), 1e-6)] {
            for n in [1.0, 1.4] {
                let closed = ClosedMuscle::new(&muscle, 2e5, 0.1, n).unwrap();
                let state = closed.at_contraction(0.1).unwrap();
                let total = closed.split(&state).unwrap().total_n_per_m;
                let known = if n > 1.0 {
                    state.response.stiffness_adiabatic_n_per_m
                } else {
                    state.response.stiffness_isothermal_n_per_m
                };
                assert!((total / known - 1.0).abs() < tolerance, "{total} {known}");
            }
        }
    }

    #[test]
    fn much_dead_volume_keeps_the_pressure() {
        let muscle = soft();
        let split = |dead: f64| {
            let closed = ClosedMuscle::new(&muscle, 2e5, 0.1, 1.4).unwrap();
            closed.with_dead_volume(dead).unwrap().stiffness(0.1).unwrap()
        };
        let (large, larger) = (split(1.0), split(10.0));
        // The contribution of the gas is proportional to 1/Vd.
        assert!((large.gas_n_per_m / larger.gas_n_per_m - 10.0).abs() < 0.01);
        assert!((larger.total_n_per_m / larger.geometry_n_per_m - 1.0).abs() < 1e-3);
        assert!(split(0.0).gas_n_per_m > 10.0 * split(5e-3).gas_n_per_m);
    }

    /// An effect whose force depends on the pressure adds its slope to F_p.
    #[test]
    fn effects_that_depend_on_the_pressure_take_part() {
        let text = "[effects.stiff]\ntitle = \"x\"\nforce = \"k * p * p / p_ref\"\nparameters.k = { unit = \"mm^2\", typical = \"10 mm^2\", low = \"0 mm^2\", high = \"1000 mm^2\" }\nparameters.p_ref = { unit = \"bar\", typical = \"1 bar\", low = \"0.1 bar\", high = \"10 bar\" }\n";
        let mut catalogue = bulge_effects::Catalogue::builtin();
        for effect in bulge_effects::user::from_toml(text, "e.toml").unwrap() {
            catalogue = catalogue.with(effect).unwrap();
        }
        let plain = braid();
        let file = "name = \"x\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n\n[effects.stiff]\nk = \"100 mm^2\"\np_ref = \"1 bar\"\n";
        let muscle = bulge_muscles::from_toml(file, "m.toml").unwrap();
        let known = bulge_effects::known(&muscle, &catalogue).unwrap();
        let muscle = bulge_model::MuscleWithEffects::new(&muscle, &known).unwrap();
        let [with, without] =
            [&muscle, &plain].map(|m| ClosedMuscle::new(m, 2e5, 0.1, 1.0).unwrap().stiffness(0.1).unwrap());
        // d/dp of k p^2/p_ref = 2 k p/p_ref = 4e-4 m^2.
        let added = with.force_by_pressure_m2 - without.force_by_pressure_m2;
        assert!((added / 4e-4 - 1.0).abs() < 1e-8, "{added}");
    }

    /// The closed braid by hand: V = pi r^2 l, r^2 = r0^2 (1 - cos^2(alpha0) (l/l0)^2)/sin^2(alpha0).
    #[test]
    fn the_gas_of_a_braid_by_hand() {
        let muscle = braid();
        let split = ClosedMuscle::new(&muscle, 3e5, 0.1, 1.0).unwrap().stiffness(0.1).unwrap();
        let (sin, cos) = 25_f64.to_radians().sin_cos();
        let (l, l0, p) = (0.225, 0.25, 3e5);
        let section = std::f64::consts::PI * 1e-4 / (sin * sin);
        let along = (cos / l0).powi(2);
        let volume = section * l * (1.0 - along * l * l);
        let slope = section * (1.0 - 3.0 * along * l * l);
        let gas = slope * (p + 101_325.0) * slope / volume;
        assert!((split.gas_n_per_m / gas - 1.0).abs() < 1e-9);
        assert!((split.volume_by_length_m2 / slope - 1.0).abs() < 1e-9);
        assert!((split.geometry_n_per_m / (6.0 * p * section * along * l) - 1.0).abs() < 1e-9);
        assert!((split.force_by_pressure_m2 / -slope - 1.0).abs() < 1e-9);
    }
}
