//! The family of muscles spanned by the axes of a plan: the muscle at a point of the axes.

use bulge_effects::{Group, Known, known};
use bulge_fibre::{Approach, Gradient};
use bulge_muscles::{Muscle, Parameter, Quantity as _};
use std::f64::consts::TAU;

use crate::family_error::FamilyError;
use crate::member::{Member, by_variable};
use crate::output::{Output, Variable};
use crate::plan::{Plan, Quantity};

/// A base muscle and the quantities that the axes vary.
#[derive(Debug, Clone)]
pub struct Family {
    muscle: Muscle,
    effects: Vec<Known>,
    pressure: f64,
    contraction: Option<f64>,
    approach: Approach,
    axes: Vec<Quantity>,
}

impl Family {
    /// The family of a plan.
    ///
    /// # Errors
    /// If the muscle file states an effect that doesn't exist or has other numbers.
    pub fn new(plan: &Plan) -> Result<Self, FamilyError> {
        let effects = known(&plan.muscle, &plan.catalogue()?)?;
        let family = Self {
            effects,
            muscle: plan.muscle.clone(),
            pressure: plan.pressure_pa,
            contraction: plan.contraction,
            approach: plan.approach,
            axes: plan.axes.iter().map(|axis| axis.quantity.clone()).collect(),
        };
        family.check_effects()?;
        Ok(family)
    }

    /// The family of a muscle at a pressure \[Pa\] with the given axes, for points without a plan.
    ///
    /// # Errors
    /// As [`Family::new`].
    pub fn of(
        muscle: &Muscle,
        effects: Vec<Known>,
        pressure_pa: f64,
        approach: Approach,
        axes: Vec<Quantity>,
    ) -> Result<Self, FamilyError> {
        let family = Self {
            muscle: muscle.clone(),
            effects,
            pressure: pressure_pa,
            contraction: None,
            approach,
            axes,
        };
        family.check_effects()?;
        Ok(family)
    }

    /// Refuses axes that vary an effect which is not part of the muscle.
    fn check_effects(&self) -> Result<(), FamilyError> {
        for axis in &self.axes {
            let Quantity::Effect { effect, .. } = axis else { continue };
            let is_part = |(known, _): &Known| {
                known.card().name == effect && !matches!(known.card().group, Group::Rig | Group::Specimen)
            };
            if !self.effects.iter().any(is_part) {
                return Err(FamilyError::no_part(effect));
            }
        }
        Ok(())
    }

    /// Whether two points differ only in the contraction, so that muscle and pressure are the same.
    #[must_use]
    pub fn is_same_member(&self, point: &[f64], other: &[f64]) -> bool {
        let same = |((axis, a), b): ((&Quantity, &f64), &f64)| {
            *axis == Quantity::Contraction || a.to_bits() == b.to_bits()
        };
        self.axes.iter().zip(point).zip(other).all(same)
    }

    /// Index of the contraction among the axes.
    #[must_use]
    pub fn contraction_axis(&self) -> Option<usize> {
        self.axes.iter().position(|axis| *axis == Quantity::Contraction)
    }

    /// The contraction at a point of the axes.
    #[must_use]
    pub fn contraction(&self, point: &[f64]) -> f64 {
        self.contraction_axis().and_then(|axis| point.get(axis).copied()).or(self.contraction).unwrap_or(0.0)
    }

    /// The muscle at a point of the axes, in SI. The contraction has no influence on it.
    ///
    /// # Errors
    /// If a value is out of range.
    pub fn member(&self, point: &[f64]) -> Result<Member, FamilyError> {
        let (muscle, effects, pressure) = self.varied(point)?;
        Member::new(muscle, effects, pressure, self.approach)
    }

    /// The muscle and its effects with the values of the axes, and the pressure.
    fn varied(&self, point: &[f64]) -> Result<(Muscle, Vec<Known>, f64), FamilyError> {
        let (mut muscle, mut effects, mut pressure) =
            (self.muscle.clone(), self.effects.clone(), self.pressure);
        let (mut slenderness, mut group) = (None, None);
        for (axis, value) in self.axes.iter().zip(point) {
            match axis {
                Quantity::Contraction => {}
                Quantity::Pressure => pressure = *value,
                Quantity::Slenderness => slenderness = Some(*value),
                Quantity::ElasticGroup => group = Some(*value),
                Quantity::Parameter(parameter) => {
                    if *parameter == Parameter::Fibres && value.fract() != 0.0 {
                        let what = format!("the number of fibres is {value}: it must be a whole number");
                        return Err(FamilyError::Input(what));
                    }
                    muscle = muscle.with(*parameter, *value)?;
                }
                Quantity::Effect { effect, key } => {
                    for (known, numbers) in &mut effects {
                        if known.card().name != effect {
                            continue;
                        }
                        let cards = known.parameters();
                        for (number, _) in numbers.iter_mut().zip(&cards).filter(|(_, card)| card.key == key)
                        {
                            *number = *value;
                        }
                    }
                }
            }
        }
        if let Some(slenderness) = slenderness {
            muscle = muscle.with(Parameter::Radius, muscle.length().si() / slenderness)?;
        }
        if let Some(group) = group {
            let n = f64::from(muscle.fibres().ok_or_else(FamilyError::no_fibre_number)?);
            let radius = muscle.end_radius().si();
            let stiffness = pressure * (TAU / n).sin() * radius * radius / group;
            muscle = muscle.with(Parameter::FibreStiffness, stiffness)?;
        }
        Ok((muscle, effects, pressure))
    }

    /// Outputs and their derivatives by the axes at a point: `gradients[o * axes + i]`. They are exact for
    /// force and volume (dimensionless or not). They are differences of the outputs for all others, and where
    /// effects add to the force.
    ///
    /// # Errors
    /// If there is no equilibrium at the point or next to it.
    pub fn gradients(
        &self,
        point: &[f64],
        outputs: &[Output],
        values: &mut [f64],
        gradients: &mut [f64],
    ) -> Result<(), FamilyError> {
        let is_exact = |output: &Output| {
            matches!(output, Output::ForceF | Output::VolumeV | Output::Force | Output::Volume)
        };
        let member = self.member(point)?;
        let contraction = self.contraction(point);
        let response = member.response(contraction)?;
        member.outputs_of(&response, outputs, values)?;
        if !self.effects.is_empty() || !outputs.iter().all(is_exact) {
            return self.differences(point, outputs, gradients);
        }
        let count = self.axes.len();
        let exact = member.problem.gradient(contraction, self.approach)?;
        for axis in 0..count {
            let (along, growth) = if self.axes[axis] == Quantity::Contraction {
                (exact.by_contraction, [0.0; 2])
            } else {
                self.along(axis, point[axis], &member, &exact)
            };
            for (o, output) in outputs.iter().enumerate() {
                let quotient = |i: usize, value: f64| (along[i] - value * growth[i]) / member.scales[i];
                gradients[o * count + axis] = match output {
                    Output::ForceF => quotient(0, response.force_n),
                    Output::VolumeV => quotient(1, response.volume_m3),
                    Output::Force => along[0],
                    _ => along[1],
                };
            }
        }
        Ok(())
    }

    /// Derivatives of force, volume and the logarithms of their scales by an axis (not the contraction).
    fn along(&self, axis: usize, value: f64, member: &Member, exact: &Gradient) -> ([f64; 2], [f64; 2]) {
        let muscle = &member.muscle;
        let has = |quantity: &Quantity| self.axes.contains(quantity);
        let (length, radius) = (muscle.length().si(), muscle.end_radius().si());
        // d ln(n sin(2 pi/n))/dn and d ln(sin(2 pi/n))/dn.
        let n = muscle.fibres().map_or(f64::INFINITY, f64::from);
        let of_sine = -TAU / (n * n) / (TAU / n).tan();
        let mut moved: Vec<(Variable, f64)> = Vec::with_capacity(3);
        let mut growth = [0.0; 2];
        match &self.axes[axis] {
            Quantity::Contraction | Quantity::Effect { .. } | Quantity::ElasticGroup => {}
            Quantity::Pressure => {
                moved.push((Variable::Pressure, 1.0));
                growth[0] = 1.0 / value;
            }
            Quantity::Slenderness => moved.push((Variable::Parameter(Parameter::Radius), -radius / value)),
            Quantity::Parameter(parameter) => {
                moved.push((Variable::Parameter(*parameter), 1.0));
                match parameter {
                    Parameter::Length => growth = [2.0 / value, 3.0 / value],
                    Parameter::Fibres if muscle.is_pleated() => growth[0] = 1.0 / n + of_sine,
                    _ => {}
                }
                if *parameter == Parameter::Length && has(&Quantity::Slenderness) {
                    moved.push((Variable::Parameter(Parameter::Radius), radius / length));
                }
            }
        }
        if has(&Quantity::ElasticGroup) {
            // EA = p sin(2 pi/n) R^2/group.
            let one = |(variable, rate): &(Variable, f64)| match variable {
                Variable::Pressure => rate / member.problem.pressure().si(),
                Variable::Parameter(Parameter::Radius | Parameter::FittingRadius) => 2.0 * rate / radius,
                Variable::Parameter(Parameter::Fibres) => rate * of_sine,
                Variable::Parameter(_) => 0.0,
            };
            let group = if self.axes[axis] == Quantity::ElasticGroup { -1.0 / value } else { 0.0 };
            let rate = group + moved.iter().map(one).sum::<f64>();
            let stiffness = muscle.get(Parameter::FibreStiffness).unwrap_or(0.0);
            moved.push((Variable::Parameter(Parameter::FibreStiffness), stiffness * rate));
        }
        let mut along = [0.0; 2];
        for (variable, rate) in moved {
            let by = by_variable(exact, muscle, variable).unwrap_or_default();
            along[0] += by[0] * rate;
            along[1] += by[1] * rate;
        }
        (along, growth)
    }

    /// Outputs and their derivatives as in `gradients`, but by central differences of fourth order.
    fn differences(
        &self,
        point: &[f64],
        outputs: &[Output],
        gradients: &mut [f64],
    ) -> Result<(), FamilyError> {
        let count = self.axes.len();
        let mut around = vec![0.0; outputs.len()];
        gradients.fill(0.0);
        for axis in 0..count {
            let step = 1e-4 * point[axis].abs().max(1e-3);
            for (times, weight) in [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)] {
                let mut moved = point.to_vec();
                moved[axis] += times * step;
                let member = self.member(&moved)?;
                member.outputs(self.contraction(&moved), outputs, &mut around)?;
                for (o, value) in around.iter().enumerate() {
                    gradients[o * count + axis] += weight * value / (12.0 * step);
                }
            }
        }
        Ok(())
    }
}
