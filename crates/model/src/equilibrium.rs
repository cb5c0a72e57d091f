//! One equilibrium of a muscle with its effects as a value: shape, response, limit, and the change by the
//! effects.

use bulge_fibre::{Approach, Given, MeridianPoint, PleatedNumbers, Problem, RangeEnd, Response, Shape};
use bulge_muscles::{Muscle, Pressure, Quantity};
use serde::Serialize;

use crate::muscle_with_effects::{MuscleWithEffects, MuscleWithEffectsError};

/// An equilibrium of a muscle with the effects that its file states.
#[derive(Debug, Clone)]
pub struct Equilibrium {
    /// Name of the muscle.
    pub muscle: String,
    /// The meridian and the quantities that follow from it. Force and stiffness include the effects.
    pub shape: Shape,
    /// The contraction at which the force vanishes or the fibres slacken, if it is found.
    pub contraction_limit: Option<f64>,
    /// Whether the fibres slacken at the limit while the muscle still pulls.
    pub ends_slack: bool,
    /// Fibre tension divided by the fibre section \[Pa\], if the section is given.
    pub fibre_stress_pa: Option<f64>,
    /// m, phi_R, f and v of a pleated muscle.
    pub pleated: Option<PleatedNumbers>,
    /// The force without the effects \[N\], if any effect adds to it.
    pub equilibrium_force_n: Option<f64>,
    /// Names of the effects that are included.
    pub effects: Vec<String>,
}

/// The JSON document of an equilibrium.
#[derive(Debug, Serialize)]
pub struct EquilibriumDocument<'a> {
    schema: &'static str,
    muscle: &'a str,
    #[serde(flatten)]
    response: &'a Response,
    contraction_limit: Option<f64>,
    ends_slack: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    fibre_stress_pa: Option<f64>,
    #[serde(flatten)]
    pleated: Option<PleatedNumbers>,
    /// The force without the effects that the muscle file states.
    #[serde(skip_serializing_if = "Option::is_none")]
    equilibrium_force_n: Option<f64>,
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    effects: &'a [String],
    meridian: &'a [MeridianPoint],
}

impl Equilibrium {
    /// The equilibrium of a muscle with its effects at a pressure. The meridian has `points` points.
    ///
    /// # Errors
    /// Those of [`Problem::shape`] and [`MuscleWithEffects::solve`].
    pub fn new(
        extended: &MuscleWithEffects,
        pressure: Pressure,
        given: Given,
        approach: Approach,
        points: usize,
    ) -> Result<Self, MuscleWithEffectsError> {
        let problem = Problem::new(extended.parts(), pressure)?;
        if !extended.adds_force() {
            let shape = problem.shape(given, approach, points)?;
            return Ok(Self::of(extended, &problem, shape, None, approach));
        }
        let response = extended.solve(pressure, given, approach)?;
        let there = extended.given(Given::Contraction(response.contraction));
        let mut shape = problem.shape(there, approach, points)?;
        let alone = shape.response.force_n;
        shape.response = response;
        Ok(Self::of(extended, &problem, shape, Some(alone), approach))
    }

    /// The equilibrium that belongs to a shape computed elsewhere.
    #[must_use]
    pub fn of(
        extended: &MuscleWithEffects,
        problem: &Problem,
        shape: Shape,
        equilibrium_force_n: Option<f64>,
        approach: Approach,
    ) -> Self {
        let muscle = extended.muscle();
        let end = extended.range_end(problem.pressure(), approach).ok();
        Self {
            muscle: muscle.name().to_owned(),
            contraction_limit: end.map(RangeEnd::contraction),
            ends_slack: matches!(end, Some(RangeEnd::FibresSlacken(_))),
            fibre_stress_pa: stress(muscle, &shape.response),
            pleated: problem.pleated_numbers(&shape.response),
            shape,
            equilibrium_force_n,
            effects: extended.used().to_vec(),
        }
    }

    /// The JSON document.
    #[must_use]
    pub fn document(&self) -> EquilibriumDocument<'_> {
        EquilibriumDocument {
            schema: "bulge.shape/1",
            muscle: &self.muscle,
            response: &self.shape.response,
            contraction_limit: self.contraction_limit,
            ends_slack: self.ends_slack,
            fibre_stress_pa: self.fibre_stress_pa,
            pleated: self.pleated,
            equilibrium_force_n: self.equilibrium_force_n,
            effects: &self.effects,
            meridian: &self.shape.meridian,
        }
    }
}

/// Fibre tension divided by the fibre section \[Pa\], if the section is given.
fn stress(muscle: &Muscle, response: &Response) -> Option<f64> {
    let section = muscle.fibre()?.section()?;
    Some(response.fibre_tension_n / section.si())
}
