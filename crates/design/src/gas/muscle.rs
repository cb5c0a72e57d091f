//! Solves a muscle with its effects: where it pulls, where it may push, its reference length, and its load.

use bulge_fibre::{Approach, FibreError, Given, Problem, Response};
use bulge_model::{MuscleWithEffects, MuscleWithEffectsError};
use bulge_muscles::{Pressure, Quantity as _};

use super::{GasError, Load};

/// The error of a muscle at a pressure.
pub(crate) fn failed(pressure_pa: f64, error: impl Into<MuscleWithEffectsError>) -> GasError {
    GasError::Muscle { pressure_pa, error: Box::new(error.into()) }
}

/// Solves the muscle with its effects where it pulls.
pub(crate) fn pulling(
    muscle: &MuscleWithEffects,
    pressure_pa: f64,
    contraction: f64,
    approach: Approach,
) -> Result<Response, MuscleWithEffectsError> {
    let found = muscle.solve(Pressure::pa(pressure_pa), Given::Contraction(contraction), approach)?;
    // Effects may turn the pull of the equilibrium into a push.
    if !found.pulls(pressure_pa * muscle.parts().radius.powi(2)) {
        return Err(FibreError::WouldPush { contraction, force_n: found.force_n }.into());
    }
    Ok(found)
}

/// Whether shape and force per pressure are independent of the pressure.
pub(super) fn is_scale_free(muscle: &MuscleWithEffects) -> Result<bool, GasError> {
    let problem = problem(muscle, 1e5)?;
    Ok(problem.is_scale_free() && !muscle.adds_force())
}

pub(super) fn problem(muscle: &MuscleWithEffects, pressure_pa: f64) -> Result<Problem, GasError> {
    Problem::new(muscle.parts(), Pressure::pa(pressure_pa)).map_err(|error| failed(pressure_pa, error))
}

/// Solves the muscle with its effects at a pressure and a contraction, even where it would push.
///
/// At low pressure a bladder may carry the whole load, so that the fibres are slack and there is no net to
/// solve. The muscle is then continued downwards from the lowest pressure at which the fibres are taut, with
/// pull and volume linear in the pressure. (The force of a net on rubber is p times a shape minus the force
/// of the rubber.)
pub(super) fn follow(
    muscle: &MuscleWithEffects,
    pressure_pa: f64,
    contraction: f64,
    approach: Approach,
) -> Result<Response, GasError> {
    taut(muscle, pressure_pa, contraction, approach).or_else(|error| {
        Lowest::of(muscle, contraction, approach)
            .filter(|lowest| lowest.is_above(pressure_pa))
            .map_or(Err(failed(pressure_pa, error)), |lowest| Ok(lowest.down_to(pressure_pa)))
    })
}

/// Pressure above which slack fibres are no longer followed \[Pa\].
const HIGHEST_SLACK_PA: f64 = 1e6;
/// Pressure at which the search for taut fibres begins \[Pa\].
const LOWEST_TAUT_PA: f64 = 1e3;
/// Halvings at the end of that search.
const HALVINGS: u32 = 20;
/// Relative distance between the two pressures of the continuation.
const APART: f64 = 1e-3;

/// A muscle with a bladder at the lowest pressure at which its fibres are taut, and slightly above.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lowest {
    pressure_pa: f64,
    one: Response,
    other: Response,
}

impl Lowest {
    /// Finds this state at a contraction; none if the fibres are taut at every pressure, or never.
    pub(super) fn of(muscle: &MuscleWithEffects, contraction: f64, approach: Approach) -> Option<Self> {
        muscle.parts().rubber?;
        let at = |p: f64| taut(muscle, p, contraction, approach);
        // The pressure is raised until a solution exists, then bisected.
        let (mut low, mut high) = (0.0, LOWEST_TAUT_PA);
        while at(high).is_err() {
            (low, high) = (high, 2.0 * high);
            if high > HIGHEST_SLACK_PA {
                return None;
            }
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if at(middle).is_ok() {
                high = middle;
            } else {
                low = middle;
            }
        }
        Some(Self { pressure_pa: high, one: at(high).ok()?, other: at((1.0 + APART) * high).ok()? })
    }

    /// Whether the lowest pressure with taut fibres is above a pressure.
    pub(super) const fn is_above(&self, pressure_pa: f64) -> bool {
        pressure_pa < self.pressure_pa
    }

    /// Extrapolates down to a pressure.
    pub(super) fn down_to(&self, pressure_pa: f64) -> Response {
        let part = (pressure_pa - self.pressure_pa) / (APART * self.pressure_pa);
        let (one, other) = (&self.one, &self.other);
        let on = |a: f64, b: f64| a + part * (b - a);
        Response {
            pressure_pa,
            force_n: on(one.force_n, other.force_n),
            volume_m3: on(one.volume_m3, other.volume_m3),
            volume_polygon_m3: on(one.volume_polygon_m3, other.volume_polygon_m3),
            ..*one
        }
    }
}

/// Solves the muscle with its effects at a contraction, even where it would push.
pub(crate) fn taut(
    muscle: &MuscleWithEffects,
    pressure_pa: f64,
    contraction: f64,
    approach: Approach,
) -> Result<Response, MuscleWithEffectsError> {
    let own = match muscle.given(Given::Contraction(contraction)) {
        Given::Length(length) => 1.0 - length / muscle.parts().length,
        _ => contraction,
    };
    let problem = Problem::new(muscle.parts(), Pressure::pa(pressure_pa))?;
    Ok(muscle.complete(&problem.follow(own, approach)?)?)
}

/// Load at a contraction \[N\].
pub(super) fn load_at(load: &Load<'_>, muscle: &MuscleWithEffects, contraction: f64) -> f64 {
    match load {
        Load::Held(_) => f64::INFINITY,
        Load::Force(force) => *force,
        Load::Spring { preload_n, rate_n_per_m, from } => {
            preload_n + rate_n_per_m * muscle.muscle().length().si() * (contraction - from)
        }
        Load::Law(law) => law(contraction),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gas::{Chamber, Lift, Stroke};
    use bulge_muscles::from_toml;

    const RUBBER: &str = "name = \"rubber\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10.725 mm\"\nbraid_angle = \"25 deg\"\nwall = \"2 mm\"\n[effects.bladder-elasticity]\nc10 = \"0.34 MPa\"\n";

    fn rubber() -> MuscleWithEffects {
        MuscleWithEffects::new(&from_toml(RUBBER, "m.toml").unwrap(), &[]).unwrap()
    }

    /// Stiff rubber at 100 Pa: there is no net to solve, and the muscle pushes. The force is continuous and
    /// rises with the pressure through the point where the fibres become taut.
    #[test]
    fn slack_fibres_are_passed() {
        let muscle = rubber();
        let force = |p: f64| follow(&muscle, p, 0.05, Approach::Auto).unwrap().force_n;
        assert!(taut(&muscle, 100.0, 0.05, Approach::Auto).is_err() && force(100.0) < 0.0);
        let lowest = Lowest::of(&muscle, 0.05, Approach::Auto).unwrap();
        // The chamber gives the same result.
        assert!((lowest.down_to(100.0).force_n - force(100.0)).abs() < 1e-12 && lowest.is_above(100.0));
        let mut before = force(100.0);
        for k in 1..=60 {
            let p = 100.0 + 2e3 * f64::from(k);
            let now = force(p);
            // The slope of a net: that of the cylinder, p pi r0^2 (3 (1 - e)^2 cos^2 - 1)/sin^2, is 0.0028
            // N/Pa.
            let slope = (now - before) / 2e3;
            assert!((1e-3..6e-3).contains(&slope), "{p} {slope}");
            before = now;
        }
    }

    /// A stroke begins and ends where the muscle carries the load; a chamber covers all pressures from zero
    /// on.
    #[test]
    fn muscles_with_rubber_lift() {
        let muscle = rubber();
        let stroke = Stroke::new(&muscle, 300.0, [0.05, 0.12], Lift::PressureRise, 6e5).cycle().unwrap();
        for (p, e) in [(stroke.start_pressure_pa, 0.05), (stroke.end_pressure_pa, 0.12)] {
            let pull = muscle.solve(Pressure::pa(p), Given::Contraction(e), Approach::Auto).unwrap().force_n;
            assert!((pull / 300.0 - 1.0).abs() < 1e-9, "{pull}");
        }
        assert!(stroke.efficiency > 0.01 && stroke.efficiency < 0.2);
        let chamber = Chamber::muscle(&muscle, Load::Held(0.05)).unwrap();
        let [empty, full] = [0.0, 5e5].map(|p| chamber.at(p).unwrap());
        let there = muscle.solve(Pressure::pa(5e5), Given::Contraction(0.05), Approach::Auto).unwrap();
        assert!((full.force_n / there.force_n - 1.0).abs() < 1e-12 && empty.force_n < 0.0);
        assert!((full.volume_m3 / empty.volume_m3 - 1.0).abs() < 0.2);
    }
}
