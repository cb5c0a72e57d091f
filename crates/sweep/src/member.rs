//! A muscle of a family at a pressure, and its outputs.

use bulge_effects::Known;
use bulge_fibre::{Approach, FibreError, Given, Gradient, Problem, RangeEnd, Response};
use bulge_model::MuscleWithEffects;
use bulge_muscles::{Muscle, Parameter, Pressure, Quantity as _};
use std::f64::consts::TAU;

use crate::family_error::FamilyError;
use crate::output::{Output, Variable};

/// A muscle of a family at a pressure.
#[derive(Debug, Clone)]
pub struct Member {
    pub(crate) problem: Problem,
    /// The muscle as stated in its file.
    pub(crate) muscle: Muscle,
    /// The stated effects and the muscle with them; none if no effects are stated.
    extended: Option<(Vec<Known>, MuscleWithEffects)>,
    approach: Approach,
    /// Divisors that make force and volume dimensionless: p l0^2 a and l0^3.
    pub(crate) scales: [f64; 2],
}

/// A member, the contraction that is asked for, and the end of the range in which it pulls if that is known.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub(crate) member: &'a Member,
    pub(crate) contraction: f64,
    pub(crate) end: Option<RangeEnd>,
}

impl Member {
    pub(crate) fn new(
        muscle: Muscle,
        effects: Vec<Known>,
        pressure: f64,
        approach: Approach,
    ) -> Result<Self, FamilyError> {
        // The scales are those of the stated muscle, even if effects change its length or its number of
        // fibres: a user who multiplies back knows only the stated values.
        let length = muscle.length().si();
        let factor = match muscle.fibres().filter(|_| muscle.is_pleated()) {
            Some(n) => f64::from(n) / TAU * (TAU / f64::from(n)).sin(),
            None => 1.0,
        };
        let extended = if effects.is_empty() {
            None
        } else {
            let extended = MuscleWithEffects::new(&muscle, &effects)?;
            Some((effects, extended))
        };
        let pressure_pa = Pressure::pa(pressure);
        let problem = match &extended {
            Some((_, extended)) => Problem::new(extended.parts(), pressure_pa)?,
            None => Problem::new(&muscle, pressure_pa)?,
        };
        let scales = [pressure * length * length * factor, length.powi(3)];
        Ok(Self { problem, muscle, extended, approach, scales })
    }

    /// The problem that is solved.
    #[must_use]
    pub const fn problem(&self) -> &Problem {
        &self.problem
    }

    /// The contraction at which the force vanishes.
    ///
    /// # Errors
    /// If it isn't found.
    pub fn contraction_limit(&self) -> Result<f64, FamilyError> {
        match &self.extended {
            Some((_, extended)) => Ok(extended.contraction_limit(self.problem.pressure(), self.approach)?),
            None => Ok(self.problem.contraction_limit(self.approach)?),
        }
    }

    /// End of the range in which the muscle pulls: the force vanishes, or the fibres slacken before.
    ///
    /// # Errors
    /// If it isn't found.
    pub fn range_end(&self) -> Result<RangeEnd, FamilyError> {
        match &self.extended {
            Some((_, extended)) => Ok(extended.range_end(self.problem.pressure(), self.approach)?),
            None => Ok(self.problem.range_end(self.approach)?),
        }
    }

    /// Outputs at a contraction, which may lie beyond the limit.
    ///
    /// # Errors
    /// If there is no equilibrium.
    pub fn outputs(
        &self,
        contraction: f64,
        outputs: &[Output],
        values: &mut [f64],
    ) -> Result<(), FamilyError> {
        let response = self.response(contraction)?;
        self.outputs_of(&response, outputs, values)
    }

    /// Outputs of several members, each at a contraction at which it must pull. In their order, `told` receives the place and
    /// the values of the outputs, or why there are none: no equilibrium, or the muscle would push or its fibres slacken
    /// (naming the limit).
    pub(crate) fn pulling_each(
        asked: &[Asked<'_>],
        outputs: &[Output],
        mut told: impl FnMut(usize, Result<&[f64], FamilyError>),
    ) {
        let Some(first) = asked.first() else { return };
        let approach = first.member.approach;
        let problems: Vec<_> =
            asked.iter().map(|of| (&of.member.problem, of.member.own(of.contraction))).collect();
        let mut values = vec![0.0; outputs.len()];
        for (i, (of, found)) in asked.iter().zip(Problem::follow_each(&problems, approach)).enumerate() {
            let done = of.member.pulling(of, found, outputs, &mut values);
            told(i, done.map(|()| values.as_slice()));
        }
    }

    fn pulling(
        &self,
        of: &Asked<'_>,
        found: Result<Response, FibreError>,
        outputs: &[Output],
        values: &mut [f64],
    ) -> Result<(), FamilyError> {
        let Asked { contraction, end, .. } = *of;
        if let Some(end) = end
            && contraction > end.contraction()
        {
            return Err(end.beyond(contraction).into());
        }
        let response = self.completed(found).map_err(|error| self.with_limit(contraction, error))?;
        if !response.pulls(self.scales[0].abs()) {
            let end = self.range_end()?;
            let beyond = contraction > end.contraction();
            let pushes = FibreError::WouldPush { contraction, force_n: response.force_n };
            return Err(if beyond { end.beyond(contraction) } else { pushes }.into());
        }
        self.outputs_of(&response, outputs, values)?;
        match values.iter().zip(outputs).find(|(value, _)| !value.is_finite()) {
            Some((value, output)) => Err(FamilyError::NotFinite { output: output.name(), value: *value }),
            None => Ok(()),
        }
    }

    /// Adds the limit of the range to an error about slack fibres.
    fn with_limit(&self, contraction: f64, error: FamilyError) -> FamilyError {
        let is_unnamed = matches!(error, FamilyError::Equilibrium(FibreError::Slack { limit: None, .. }));
        match is_unnamed.then(|| self.range_end()) {
            Some(Ok(end)) if contraction > end.contraction() => end.beyond(contraction).into(),
            _ => error,
        }
    }

    pub(crate) fn response(&self, contraction: f64) -> Result<Response, FamilyError> {
        self.completed(self.problem.follow(self.own(contraction), self.approach))
    }

    /// The contraction of the muscle with its effects. The given one refers to the stated length, which effects may have
    /// changed.
    fn own(&self, contraction: f64) -> f64 {
        let Some((_, extended)) = &self.extended else { return contraction };
        match extended.given(Given::Contraction(contraction)) {
            Given::Length(length) => 1.0 - length / self.problem.parts().length,
            _ => contraction,
        }
    }

    /// Adds the effects outside the muscle.
    fn completed(&self, found: Result<Response, FibreError>) -> Result<Response, FamilyError> {
        match &self.extended {
            Some((_, extended)) => Ok(extended.complete(&found?)?),
            None => Ok(found?),
        }
    }

    pub(crate) fn outputs_of(
        &self,
        response: &Response,
        outputs: &[Output],
        values: &mut [f64],
    ) -> Result<(), FamilyError> {
        let [force_scale, volume_scale] = self.scales;
        let needs = |output: &Output| matches!(output, Output::ForceBy(_) | Output::VolumeBy(_));
        let gradient = if outputs.iter().any(needs) && self.extended.is_none() {
            Some(self.problem.gradient(response.contraction, self.approach)?)
        } else {
            None
        };
        // The contraction refers to the stated length.
        let length = match &self.extended {
            Some(_) => self.muscle.length().si(),
            None => response.length_m / (1.0 - response.contraction),
        };
        let by = |variable: Variable, which: usize| -> Result<f64, FamilyError> {
            if let Some((effects, _)) = &self.extended {
                let contraction = 1.0 - response.length_m / length;
                return Ok(self.by_stated(effects, variable, contraction)?[which]);
            }
            let by = gradient.as_ref().and_then(|gradient| by_variable(gradient, &self.muscle, variable));
            by.map(|by| by[which]).ok_or_else(|| FamilyError::no_variable(variable.name()))
        };
        let parts = self.problem.parts();
        let radius = parts.fitting.unwrap_or(parts.radius);
        // Circular volume divided by the volume of the sections that carry the pressure.
        let circular = response.volume_m3 / response.volume_polygon_m3;
        for (value, output) in values.iter_mut().zip(outputs) {
            *value = match *output {
                Output::ForceF => response.force_n / force_scale,
                Output::VolumeV => response.volume_m3 / volume_scale,
                Output::Force => response.force_n,
                Output::Volume => response.volume_m3,
                Output::VolumePolygon => response.volume_polygon_m3,
                Output::MaxRadius => response.max_radius_m,
                Output::RadiusRatio => response.max_radius_m / radius,
                Output::FibreTension => response.fibre_tension_n,
                Output::FibreStrain => response.fibre_strain,
                Output::Stiffness => response.stiffness_n_per_m,
                Output::StiffnessIsothermal => response.stiffness_isothermal_n_per_m,
                Output::StiffnessAdiabatic => response.stiffness_adiabatic_n_per_m,
                Output::EndSlope => response.end_slope_rad,
                Output::ForceFByContraction => -response.stiffness_n_per_m * length / force_scale,
                Output::ForceByContraction => -response.stiffness_n_per_m * length,
                Output::VolumeVByContraction => -response.volume_slope_m2 * circular * length / volume_scale,
                Output::VolumeByContraction => -response.volume_slope_m2 * circular * length,
                Output::ForceBy(variable) => by(variable, 0)?,
                Output::VolumeBy(variable) => by(variable, 1)?,
            };
        }
        Ok(())
    }

    /// Derivatives of force and volume by a number of the stated muscle, by differences of fourth order.
    fn by_stated(
        &self,
        effects: &[Known],
        variable: Variable,
        contraction: f64,
    ) -> Result<[f64; 2], FamilyError> {
        let (muscle, pressure) = (&self.muscle, self.problem.pressure().si());
        let value = match variable {
            Variable::Pressure => Some(pressure),
            // A whole number can't be varied by a small step.
            Variable::Parameter(Parameter::Fibres) => None,
            Variable::Parameter(parameter) => muscle.get(parameter),
        };
        let value = value.ok_or_else(|| FamilyError::no_variable(variable.name()))?;
        let step = 1e-4 * value.abs().max(1e-3);
        let mut by = [0.0; 2];
        for (times, weight) in [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)] {
            let moved = value + times * step;
            let (muscle, pressure) = match variable {
                Variable::Pressure => (muscle.clone(), moved),
                Variable::Parameter(parameter) => (muscle.with(parameter, moved)?, pressure),
            };
            let response =
                Self::new(muscle, effects.to_vec(), pressure, self.approach)?.response(contraction)?;
            by[0] += weight * response.force_n / (12.0 * step);
            by[1] += weight * response.volume_m3 / (12.0 * step);
        }
        Ok(by)
    }
}

/// Derivatives of force and volume by a variable; none if the muscle doesn't have that variable.
pub(crate) fn by_variable(gradient: &Gradient, muscle: &Muscle, variable: Variable) -> Option<[f64; 2]> {
    match variable {
        Variable::Pressure => Some(gradient.by_pressure),
        Variable::Parameter(parameter) => gradient.by(muscle, parameter),
    }
}
