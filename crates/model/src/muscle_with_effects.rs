//! A muscle with the effects that its file states, at rest: its shapes and characteristics.
//!
//! Shape and input effects change the muscle whose equilibrium is solved. Load effects add their force at
//! rest (no direction, no rate, no time). Effects of the rig or of one specimen are left out, because they
//! don't belong to the muscle.

use bulge_effects::{Group, Known, Moment};
use bulge_fibre::{Approach, FibreError, Given, Isobar, Parts, Problem, RangeEnd, Response, isobars};
use bulge_muscles::{Fault, Muscle, Pressure, Quantity};
use rayon::prelude::*;

use crate::error::ModelError;
use crate::evaluate::Wanted;
use crate::model::Model;
use crate::record::Record;

/// The largest number of Newton steps in the search for a force.
const MOST_STEPS: usize = 60;
/// The longest Newton step, in contraction.
const MOST_STEP: f64 = 0.05;

/// A muscle with the effects that its file states.
#[derive(Debug, Clone)]
pub struct MuscleWithEffects {
    /// The stated parts as changed by the shape effects.
    parts: Parts,
    model: Model,
    /// The model of the same parts without effects.
    bare: Model,
    /// Whether the force may differ from that of the equilibrium of `parts`.
    adds: bool,
    used: Vec<String>,
    left_out: Vec<String>,
}

/// Force at a point and its derivatives.
#[derive(Debug, Clone, Copy)]
struct Pull {
    force: f64,
    by_pressure: f64,
    by_contraction: f64,
}

impl MuscleWithEffects {
    /// A muscle with effects and their parameters, as [`bulge_effects::known`] reads them from the muscle.
    ///
    /// # Errors
    /// If an effect doesn't fit the muscle, or not with these parameters.
    pub fn new(muscle: &Muscle, known: &[Known]) -> Result<Self, ModelError> {
        let plain = muscle.clone().without_learnt();
        let mut model = Model::new(&plain);
        let (mut used, mut left_out) = (Vec::new(), Vec::new());
        for (effect, numbers) in known {
            let card = effect.card();
            if matches!(card.group, Group::Rig | Group::Specimen) {
                left_out.push(card.name.to_owned());
                continue;
            }
            used.push(card.name.to_owned());
            model = model.with(effect, Some(numbers))?;
        }
        let parts = model.parts(&model.start())?;
        let bare = Model::new(&plain).of_parts(&parts);
        let adds = !model.effects().is_empty();
        Ok(Self { parts, model, bare, adds, used, left_out })
    }

    /// The muscle as stated, without the effects of the catalogue.
    #[must_use]
    pub fn muscle(&self) -> &Muscle {
        self.model.muscle()
    }

    /// The parts whose equilibrium is solved: the stated parts as changed by the shape effects.
    #[must_use]
    pub fn parts(&self) -> &Parts {
        &self.parts
    }

    /// The stated length \[m\], to which contractions refer.
    fn stated(&self) -> f64 {
        self.model.muscle().length().si()
    }

    /// Whether effects have changed the length.
    fn is_longer(&self) -> bool {
        self.stated().to_bits() != self.parts.length.to_bits()
    }

    /// Whether the force may differ from that of the equilibrium of [`MuscleWithEffects::parts`].
    #[must_use]
    pub fn adds_force(&self) -> bool {
        self.adds
    }

    /// Names of the effects that are included.
    #[must_use]
    pub fn used(&self) -> &[String] {
        &self.used
    }

    /// Names of the effects of rig and specimen, which are left out.
    #[must_use]
    pub fn left_out(&self) -> &[String] {
        &self.left_out
    }

    /// Completes an equilibrium of [`MuscleWithEffects::parts`] with the effects' changes of force and
    /// stiffness. If an effect changes the length of the fibres, the contraction is converted to the stated
    /// length.
    ///
    /// The gas stiffness scales with the derivative F_p of the force by the pressure: K_gas = K' + (K_gas0 -
    /// K0) F_p'/F_p.
    ///
    /// # Errors
    /// If an effect gives no finite force there.
    pub fn complete(&self, response: &Response) -> Result<Response, ModelError> {
        if !self.adds {
            return Ok(*response);
        }
        let p = response.pressure_pa;
        let contraction = self.stated_contraction(response);
        let with = pull(&self.model, p, contraction)?;
        let without = pull(&self.bare, p, response.contraction)?;
        let added = without.by_contraction / self.parts.length - with.by_contraction / self.stated();
        let stiffness = response.stiffness_n_per_m + added;
        let ratio = with.by_pressure / without.by_pressure;
        let gas = |closed: f64| stiffness + (closed - response.stiffness_n_per_m) * ratio;
        Ok(Response {
            contraction,
            force_n: response.force_n + (with.force - without.force),
            stiffness_n_per_m: stiffness,
            stiffness_isothermal_n_per_m: gas(response.stiffness_isothermal_n_per_m),
            stiffness_adiabatic_n_per_m: gas(response.stiffness_adiabatic_n_per_m),
            ..*response
        })
    }

    /// The force of a completed equilibrium while the muscle shortens (direction 1) or lengthens (-1) \[N\].
    /// Friction makes the two differ. Effects with memory act as at the beginning of a motion.
    ///
    /// # Errors
    /// If an effect gives no finite force there.
    pub fn force_while(&self, response: &Response, direction: f64) -> Result<f64, ModelError> {
        if !self.adds {
            return Ok(response.force_n);
        }
        let (p, contraction) = (response.pressure_pa, response.contraction);
        let moving = Moment { direction, ..Moment::at_rest(p, contraction) };
        let change = pull_in(&self.model, moving)?.force - pull(&self.model, p, contraction)?.force;
        Ok(response.force_n + change)
    }

    /// The contraction of an equilibrium relative to the stated length.
    fn stated_contraction(&self, response: &Response) -> f64 {
        if self.is_longer() { 1.0 - response.length_m / self.stated() } else { response.contraction }
    }

    /// Converts a given quantity of the muscle with its effects to one of [`MuscleWithEffects::parts`]. A
    /// force isn't converted.
    #[must_use]
    pub fn given(&self, given: Given) -> Given {
        match given {
            Given::Contraction(e) if self.is_longer() => Given::Length(self.stated() * (1.0 - e)),
            _ => given,
        }
    }

    /// Solves for the contraction at which the muscle with its effects has a given force, length or volume.
    /// Returns the completed equilibrium there.
    ///
    /// # Errors
    /// Those of [`Problem::solve`]; also if no contraction gives the force.
    pub fn solve(
        &self,
        pressure: Pressure,
        given: Given,
        approach: Approach,
    ) -> Result<Response, MuscleWithEffectsError> {
        let problem = Problem::new(&self.parts, pressure)?;
        let mut found = self.complete(&problem.solve(self.given(given), approach)?)?;
        let Given::Force(wanted) = given else { return Ok(found) };
        for _ in 0..MOST_STEPS {
            let off = found.force_n - wanted;
            // The tolerance is the accuracy of the solver itself.
            if off.abs() <= 1e-10 * (wanted.abs() + found.force_n.abs()) + 1e-9 || !self.adds {
                return Ok(found);
            }
            let slope = -found.stiffness_n_per_m * self.stated();
            let step = (-off / slope).clamp(-MOST_STEP, MOST_STEP);
            if !step.is_finite() || slope >= 0.0 {
                break;
            }
            let next = self.given(Given::Contraction(found.contraction + step));
            found = self.complete(&problem.solve(next, approach)?)?;
        }
        Err(MuscleWithEffectsError::Force { wanted, contraction: found.contraction, force: found.force_n })
    }

    /// The characteristics of the muscle with its effects, as [`bulge_fibre::isobars`] gives them without
    /// effects. They are computed on all cores, with the same bytes for any number of threads. Points at
    /// which the muscle with its effects would push are left out, with the reason.
    ///
    /// # Errors
    /// Those of [`bulge_fibre::isobars`]; also if an effect gives no finite force.
    pub fn isobars(
        &self,
        pressures: &[Pressure],
        contractions: &[f64],
        approach: Approach,
    ) -> Result<Vec<Isobar>, MuscleWithEffectsError> {
        let own = |e: &f64| {
            if self.is_longer() { 1.0 - self.stated() * (1.0 - e) / self.parts.length } else { *e }
        };
        let asked: Vec<f64> = contractions.iter().map(own).collect();
        let mut found = isobars(&self.parts, pressures, &asked, approach)?;
        if !self.adds {
            return Ok(found);
        }
        for isobar in &mut found {
            // The effects move the end of the range, and the muscle may push at some of the points.
            let end = self.range_end(Pressure::pa(isobar.pressure_pa), approach).ok();
            isobar.contraction_limit = end.map(RangeEnd::contraction);
            isobar.ends_slack = matches!(end, Some(RangeEnd::FibresSlacken(_)));
            let completed: Vec<Response> =
                isobar.points.par_iter().map(|point| self.complete(point)).collect::<Result<_, _>>()?;
            let largest = completed.iter().map(|point| point.force_n.abs()).fold(0.0, f64::max);
            let (pulling, pushing): (Vec<_>, Vec<_>) =
                completed.into_iter().partition(|point| point.pulls(largest));
            isobar.points = pulling;
            isobar.without.extend(pushing.into_iter().map(|Response { contraction, force_n, .. }| {
                (contraction, FibreError::WouldPush { contraction, force_n })
            }));
            isobar.without.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        Ok(found)
    }

    /// The contraction at which the force of the muscle with its effects vanishes, at most the limit of the
    /// equilibrium alone.
    ///
    /// # Errors
    /// As [`MuscleWithEffects::solve`].
    pub fn contraction_limit(
        &self,
        pressure: Pressure,
        approach: Approach,
    ) -> Result<f64, MuscleWithEffectsError> {
        match self.range_end(pressure, approach)? {
            RangeEnd::ForceVanishes(limit) => Ok(limit),
            end @ RangeEnd::FibresSlacken(limit) => Err(end.beyond(limit).into()),
        }
    }

    /// The end of the range in which the muscle with its effects pulls, at most the end of the range without
    /// effects.
    ///
    /// # Errors
    /// As [`MuscleWithEffects::solve`].
    pub fn range_end(
        &self,
        pressure: Pressure,
        approach: Approach,
    ) -> Result<RangeEnd, MuscleWithEffectsError> {
        let problem = Problem::new(&self.parts, pressure)?;
        let end = problem.range_end(approach)?;
        if !self.adds {
            return Ok(end);
        }
        let last = self.complete(&problem.solve(Given::Contraction(end.contraction()), approach)?)?;
        if last.force_n < 0.0 {
            let vanishes = self.solve(pressure, Given::Force(0.0), approach)?;
            return Ok(RangeEnd::ForceVanishes(vanishes.contraction));
        }
        Ok(match end {
            RangeEnd::ForceVanishes(_) => RangeEnd::ForceVanishes(last.contraction),
            RangeEnd::FibresSlacken(_) => RangeEnd::FibresSlacken(last.contraction),
        })
    }
}

/// Why a muscle with effects has no answer.
#[derive(Debug, thiserror::Error)]
pub enum MuscleWithEffectsError {
    /// The equilibrium failed.
    #[error("{0}")]
    Equilibrium(Box<FibreError>),
    /// An effect or the model failed.
    #[error("{0}")]
    Model(Box<ModelError>),
    /// No contraction gives the force.
    #[error(
        "no contraction was found at which the muscle with its effects pulls {wanted} N: at {:.3} % it pulls {force:.3} N", 100.0 * contraction
    )]
    Force {
        /// The force asked for \[N\].
        wanted: f64,
        /// The last contraction tried.
        contraction: f64,
        /// The force there \[N\].
        force: f64,
    },
}

impl MuscleWithEffectsError {
    /// The fault behind the error.
    #[must_use]
    pub fn fault(&self) -> Fault {
        match self {
            Self::Equilibrium(source) => source.fault(),
            Self::Model(source) => source.fault(),
            Self::Force { .. } => Fault::NoSolution,
        }
    }
}

impl From<FibreError> for MuscleWithEffectsError {
    fn from(error: FibreError) -> Self {
        Self::Equilibrium(Box::new(error))
    }
}

impl From<ModelError> for MuscleWithEffectsError {
    fn from(error: ModelError) -> Self {
        Self::Model(Box::new(error))
    }
}

fn pull(model: &Model, pressure: f64, contraction: f64) -> Result<Pull, ModelError> {
    pull_in(model, Moment::at_rest(pressure, contraction))
}

fn pull_in(model: &Model, moment: Moment) -> Result<Pull, ModelError> {
    let record = Record::from_moments(vec![moment], vec![0.0], std::iter::once(0..1).collect())
        .ok_or(ModelError::Values { given: 0, expected: 1 })?;
    let wanted = Wanted { parameters: Vec::new(), readings: true };
    let found = model.evaluate(&record, &model.start(), &wanted)?;
    Ok(Pull {
        force: found.force[0],
        by_pressure: found.by_pressure[0],
        by_contraction: found.by_contraction[0],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::{Catalogue, known};
    use bulge_muscles::from_toml;

    fn bar3() -> Pressure {
        Pressure::bar(3.0)
    }

    fn braid(tables: &str) -> MuscleWithEffects {
        let text = format!(
            "name = \"x\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\n\n{tables}\n"
        );
        let muscle = from_toml(&text, "m.toml").unwrap();
        MuscleWithEffects::new(&muscle, &known(&muscle, &Catalogue::builtin()).unwrap()).unwrap()
    }

    const HOOP: &str =
        "[effects.radius-error]\nradius = \"10.7 mm\"\n[effects.hoop-elasticity]\nstiffness = \"20 kN/m\"";

    #[test]
    fn a_radius_is_the_radius() {
        let learnt = braid("[effects.radius-error]\nradius = \"10.7 mm\"");
        let text = "name = \"x\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10.7 mm\"\nbraid_angle = \"25 deg\"\n";
        let wide = Problem::new(&from_toml(text, "w.toml").unwrap(), bar3()).unwrap();
        let wide = wide.solve(Given::Contraction(0.1), Approach::Auto).unwrap();
        let found = learnt.solve(bar3(), Given::Contraction(0.1), Approach::Auto).unwrap();
        assert!((found.force_n / wide.force_n - 1.0).abs() < 1e-12);
        assert_eq!(found.volume_m3.to_bits(), wide.volume_m3.to_bits());
    }

    #[test]
    fn stiffness_is_the_slope_of_the_completed_force() {
        let muscle = braid(HOOP);
        let at = |e: f64| muscle.solve(bar3(), Given::Contraction(e), Approach::Auto).unwrap();
        let h = 1e-5;
        let slope = -(at(0.1 + h).force_n - at(0.1 - h).force_n) / (2.0 * h * 0.25);
        assert!((at(0.1).stiffness_n_per_m / slope - 1.0).abs() < 1e-6);
        // The effects scale the gas stiffness by the ratio of F_p, which is the same for any exponent.
        let (here, plain) = (at(0.1), Problem::new(muscle.parts(), bar3()).unwrap());
        let plain = plain.solve(Given::Contraction(0.1), Approach::Auto).unwrap();
        let gas = |r: &Response, k: f64| k - r.stiffness_n_per_m;
        let ratio =
            gas(&here, here.stiffness_isothermal_n_per_m) / gas(&plain, plain.stiffness_isothermal_n_per_m);
        let other =
            gas(&here, here.stiffness_adiabatic_n_per_m) / gas(&plain, plain.stiffness_adiabatic_n_per_m);
        assert!((ratio / other - 1.0).abs() < 1e-12);
    }

    #[test]
    fn forces_are_met_and_the_limit_pulls_nothing() {
        let muscle = braid(HOOP);
        let found = muscle.solve(bar3(), Given::Force(200.0), Approach::Auto).unwrap();
        assert!((found.force_n - 200.0).abs() < 1e-6);
        let alone = Problem::new(muscle.parts(), bar3()).unwrap();
        let limit = muscle.contraction_limit(bar3(), Approach::Auto).unwrap();
        assert!(limit < alone.contraction_limit(Approach::Auto).unwrap() - 1e-3);
        let there = muscle.solve(bar3(), Given::Contraction(limit), Approach::Auto).unwrap();
        assert!(there.force_n.abs() < 1e-6);
        assert!(muscle.solve(bar3(), Given::Force(1e6), Approach::Auto).is_err());
    }

    /// Friction of 14 N is pulled against while the muscle lengthens, and lost while it shortens.
    #[test]
    fn friction_acts_against_the_motion() {
        for (tables, friction) in
            [("[effects.coulomb-friction]\nforce = \"14 N\"", 14.0), (HOOP, 0.0), ("", 0.0)]
        {
            let muscle = braid(tables);
            let rest = muscle.solve(bar3(), Given::Contraction(0.1), Approach::Auto).unwrap();
            for direction in [1.0, 0.0, -1.0] {
                let moving = muscle.force_while(&rest, direction).unwrap();
                assert!((moving - rest.force_n + direction * friction).abs() < 1e-9, "{tables} {moving}");
            }
        }
    }

    /// Characteristics are asked for by the contraction of the stated length, as a single equilibrium is.
    #[test]
    fn isobars_are_made_of_single_equilibria() {
        for tables in ["[effects.fibre-length]\nexcess = \"1 %\"", HOOP] {
            let muscle = braid(tables);
            let found = muscle.isobars(&[bar3()], &[0.01, 0.03], Approach::Auto).unwrap();
            for (point, contraction) in found[0].points.iter().zip([0.01, 0.03]) {
                let alone = muscle.solve(bar3(), Given::Contraction(contraction), Approach::Auto).unwrap();
                assert!(
                    (point.force_n / alone.force_n - 1.0).abs() < 1e-9,
                    "{} {}",
                    point.force_n,
                    alone.force_n
                );
            }
            assert_eq!(found[0].points.len(), 2, "{tables}: {found:?}");
        }
    }

    #[test]
    fn other_fibres_are_asked_for_by_the_stated_length() {
        let muscle = braid("[effects.fibre-length]\nexcess = \"1 %\"");
        let found = muscle.solve(bar3(), Given::Contraction(0.1), Approach::Auto).unwrap();
        assert!((found.length_m - 0.225).abs() < 1e-12 && (found.contraction - 0.1).abs() < 1e-12);
        // The reference is a cylinder of 252.5 mm at the same length.
        let plain = Problem::new(muscle.parts(), bar3()).unwrap();
        let plain = plain.solve(Given::Length(0.225), Approach::Auto).unwrap();
        assert!((found.force_n / plain.force_n - 1.0).abs() < 1e-9);
        assert!((found.stiffness_n_per_m / plain.stiffness_n_per_m - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_rig_is_no_part_of_the_muscle() {
        let muscle =
            braid("[effects.force-offset]\noffset = \"10 N\"\n[effects.coulomb-friction]\nforce = \"14 N\"");
        assert_eq!(
            (muscle.used(), muscle.left_out()),
            (["coulomb-friction".to_owned()].as_slice(), ["force-offset".to_owned()].as_slice())
        );
        let plain =
            Problem::new(muscle.parts(), bar3()).unwrap().solve(Given::Contraction(0.1), Approach::Auto);
        let found = muscle.solve(bar3(), Given::Contraction(0.1), Approach::Auto).unwrap();
        // At rest friction has no direction and adds no force.
        assert_eq!(found.force_n.to_bits(), plain.unwrap().force_n.to_bits());
    }
}
