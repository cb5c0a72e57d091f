//! A muscle on its side of a joint: its pull, the derivatives of the pull, and its uncertainty.

use bulge_effects::{Group, Known};
use bulge_fibre::{Approach, Problem, Response};
use bulge_model::{MuscleWithEffects, MuscleWithEffectsError};
use bulge_muscles::{Muscle, Parameter, Pressure, Quantity as _};
use bulge_numerics::root::illinois;
use serde::Serialize;

use super::geometry::Reach;
use super::{Cause, JointError, Linkage, Side};
use crate::gas::{pulling, taut};

/// Steps of the differences, relative to the range of angles, to the contraction if the force is infinite at
/// 0, and to the pressure.
const ANGLE_STEP: f64 = 1e-4;
const CONTRACTION_STEP: f64 = 1e-2;
const PRESSURE_STEP: f64 = 1e-4;
/// Offsets and weights of the difference of fourth order, to be divided by 12 steps.
const STENCIL: [(f64, f64); 4] = [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)];

/// A muscle on its side of a joint.
#[derive(Debug, Clone, Serialize)]
pub struct JointMuscle {
    pub(super) side: Side,
    pub(super) muscle: Muscle,
    /// Contraction at the angle 0.
    pub(super) contraction: f64,
    #[serde(skip)]
    pub(super) linkage: Linkage,
    #[serde(skip)]
    pub(super) extended: MuscleWithEffects,
    /// Whether the force is infinite at the contraction 0.
    #[serde(skip)]
    pub(super) is_singular: bool,
    #[serde(skip)]
    known: Vec<Known>,
    /// The numbers for which its file states a width, and these widths.
    #[serde(skip)]
    unsure: Vec<(Number, f64)>,
}

/// A number of a muscle, or of one of its effects, by their indices.
#[derive(Debug, Clone, Copy)]
enum Number {
    Muscle(Parameter),
    Effect(usize, usize),
}

/// Contribution of a muscle to the torque, with derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pull {
    /// Torque \[N m\]; negative for the antagonist.
    pub torque: f64,
    /// Derivative of the torque with respect to the angle \[N m/rad\].
    pub by_angle: f64,
    /// Contraction of the muscle.
    pub contraction: f64,
    /// Derivative of the contraction with respect to the angle \[1/rad\].
    pub contraction_by_angle: f64,
}

impl JointMuscle {
    /// A muscle with the given contraction at the angle 0 of a linkage, and with its known effects.
    ///
    /// # Errors
    /// If an effect is impossible for the muscle, or the muscle has no equilibrium problem.
    pub fn new(
        side: Side,
        linkage: Linkage,
        muscle: Muscle,
        known: Vec<Known>,
        contraction: f64,
    ) -> Result<Self, MuscleWithEffectsError> {
        let extended = MuscleWithEffects::new(&muscle, &known)?;
        let is_singular = Problem::new(extended.parts(), Pressure::bar(1.0))?.is_singular();
        let unsure = stated_widths(&muscle, &known);
        Ok(Self { side, muscle, contraction, linkage, extended, is_singular, known, unsure })
    }

    /// Side of the joint.
    #[must_use]
    pub const fn side(&self) -> Side {
        self.side
    }

    /// The muscle.
    #[must_use]
    pub const fn muscle(&self) -> &Muscle {
        &self.muscle
    }

    pub(super) fn reach(&self, angle: f64) -> Reach {
        self.linkage.at(self.side, angle)
    }

    pub(super) fn contraction(&self, angle: f64) -> f64 {
        self.contraction + self.reach(angle).shortening / self.muscle.length().si()
    }

    /// The angle in a range at which the muscle has a contraction, if there is one.
    pub(super) fn angle_at(&self, contraction: f64, [low, high]: [f64; 2]) -> f64 {
        illinois(|angle| self.contraction(angle) - contraction, low, high, 1e-12)
    }

    /// Response of the muscle alone at an angle \[rad\] and a gauge pressure \[Pa\] at which it pulls.
    pub(super) fn response(&self, angle: f64, pressure: f64) -> Result<Response, JointError> {
        pulling(&self.extended, pressure, self.contraction(angle), Approach::Auto)
            .map_err(|error| self.failed(angle, pressure, error))
    }

    /// Contribution to the torque at an angle \[rad\] and a gauge pressure \[Pa\].
    ///
    /// ```text
    /// M_i = F m,   m = -dl/dtheta,   dk/dtheta = m/l0,   dM_i/dtheta = dF/dk m^2/l0 + F dm/dtheta
    /// ```
    ///
    /// # Errors
    /// [`JointError::Muscle`] if it doesn't pull.
    pub fn pull(&self, angle: f64, pressure: f64) -> Result<Pull, JointError> {
        let (reach, length) = (self.reach(angle), self.muscle.length().si());
        let found = self.response(angle, pressure)?;
        let by_contraction = -found.stiffness_n_per_m * (found.length_m / (1.0 - found.contraction));
        Ok(Pull {
            torque: found.force_n * reach.arm,
            by_angle: by_contraction * reach.arm * reach.arm / length + found.force_n * reach.arm_by_angle,
            contraction: self.contraction(angle),
            contraction_by_angle: reach.arm / length,
        })
    }

    /// Derivative of the torque with respect to the pressure \[N m/Pa\]. It is exact, or a difference if the
    /// muscle has known effects.
    ///
    /// # Errors
    /// [`JointError::Muscle`] if there is no equilibrium.
    pub fn by_pressure(&self, angle: f64, pressure: f64) -> Result<f64, JointError> {
        let contraction = self.contraction(angle);
        let by = if self.known.is_empty() {
            Problem::new(&self.muscle, Pressure::pa(pressure))
                .and_then(|problem| problem.gradient(contraction, Approach::Auto))
                .map_err(|error| self.failed(angle, pressure, error))?
                .by_pressure[0]
        } else {
            let step = PRESSURE_STEP * pressure.abs().max(1e-3);
            let force = |times: f64| force(&self.extended, pressure + times * step, contraction);
            STENCIL
                .into_iter()
                .try_fold(0.0, |sum, (times, weight)| Ok(sum + weight * force(times)? / (12.0 * step)))
                .map_err(|error: MuscleWithEffectsError| self.failed(angle, pressure, error))?
        };
        Ok(by * self.reach(angle).arm)
    }

    /// Second derivatives of the torque, with respect to the angle and to angle and pressure. They are
    /// differences of the exact derivative by the angle; the step is a fraction of a range of angles of the
    /// given width \[rad\].
    ///
    /// # Errors
    /// As [`JointMuscle::pull`].
    pub fn bend(&self, width: f64, angle: f64, pressure: f64) -> Result<[f64; 2], JointError> {
        let mut by_angle = ANGLE_STEP * width;
        if self.is_singular {
            let per_angle = self.reach(angle).arm.abs() / self.muscle.length().si();
            by_angle = by_angle.min(CONTRACTION_STEP * self.contraction(angle) / per_angle);
        }
        let by_pressure = PRESSURE_STEP * pressure;
        let mut sums = [0.0; 2];
        for (times, weight) in STENCIL {
            let beside = self.pull(angle + times * by_angle, pressure)?;
            sums[0] += weight * beside.by_angle / (12.0 * by_angle);
            let beside = self.pull(angle, pressure + times * by_pressure)?;
            sums[1] += weight * beside.by_angle / (12.0 * by_pressure);
        }
        Ok(sums)
    }

    /// Standard deviation of the force \[N\] due to the widths in the muscle file, as if its numbers were
    /// independent. The slopes are differences over a fifth of a width.
    pub(super) fn unsure(&self, angle: f64, pressure: f64) -> Result<f64, JointError> {
        let contraction = self.contraction(angle);
        let mut sum = 0.0_f64;
        for (number, width) in &self.unsure {
            let step = 0.1 * width;
            let force = |by: f64| {
                let found =
                    self.moved(*number, by).and_then(|muscle| Ok(force(&muscle, pressure, contraction)?));
                found.map_err(|error| self.failed(angle, pressure, error))
            };
            // At a bound of the number, a one-sided difference is enough.
            let slope = match (force(step), force(-step)) {
                (Ok(up), Ok(down)) => (up - down) / (2.0 * step),
                (Ok(up), Err(_)) => (up - force(0.0)?) / step,
                (Err(_), Ok(down)) => (force(0.0)? - down) / step,
                (Err(error), Err(_)) => return Err(error),
            };
            sum = sum.hypot(slope * width);
        }
        Ok(sum)
    }

    /// The muscle with a number changed by the given amount.
    fn moved(&self, number: Number, by: f64) -> Result<MuscleWithEffects, Cause> {
        let (mut muscle, mut known) = (self.muscle.clone(), self.known.clone());
        match number {
            Number::Muscle(parameter) => {
                let value = muscle.get(parameter).unwrap_or_default();
                muscle = muscle.with(parameter, value + by)?;
            }
            Number::Effect(effect, number) => known[effect].1[number] += by,
        }
        Ok(MuscleWithEffects::new(&muscle, &known)?)
    }

    pub(super) fn failed(&self, angle: f64, pressure_pa: f64, error: impl Into<Cause>) -> JointError {
        JointError::Muscle { side: self.side, angle, pressure_pa, error: error.into() }
    }
}

/// Force at a contraction \[N\], even where the muscle would push.
fn force(muscle: &MuscleWithEffects, pressure: f64, contraction: f64) -> Result<f64, MuscleWithEffectsError> {
    taut(muscle, pressure, contraction, Approach::Auto).map(|found| found.force_n)
}

/// Numbers of a muscle file that have a width, with the width in SI: those of the effects that belong to the
/// muscle, and those of the muscle itself except its length and its number of fibres, which define a
/// contraction and a fibre.
fn stated_widths(muscle: &Muscle, known: &[Known]) -> Vec<(Number, f64)> {
    let mut found = Vec::new();
    for (parameter, width) in muscle.widths() {
        let is_fixed = matches!(parameter, Parameter::Length | Parameter::Fibres);
        // A width of 0 means that the number is exact.
        if !is_fixed && *width > 0.0 && muscle.get(*parameter).is_some() {
            found.push((Number::Muscle(*parameter), *width));
        }
    }
    for (i, (effect, _)) in known.iter().enumerate() {
        let card = effect.card();
        if matches!(card.group, Group::Rig | Group::Specimen) {
            continue;
        }
        let stated = muscle.learnt().iter().find(|learnt| learnt.name() == card.name);
        for value in stated.into_iter().flat_map(bulge_muscles::Learnt::values) {
            let place = effect.parameters().iter().position(|card| card.key == value.key);
            if let (Some(k), Some(width)) = (place, value.width.filter(|width| *width > 0.0)) {
                found.push((Number::Effect(i, k), width));
            }
        }
    }
    found
}
