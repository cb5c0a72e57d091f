//! A joint as a field to tabulate: over the angle and both pressures.

use bulge_muscles::Quantity as _;
use serde::Serialize;
use std::collections::HashMap;
use std::sync::Mutex;

use super::{Joint, JointError, Pull};
use crate::certified::{Field, FieldAxis, FieldOutput, NoValue};

/// Steps of the differences: parts of the range of angles, of the contraction where the force is infinite at 0, and of the pressure.
const ANGLE_STEP: f64 = 1e-4;
const CONTRACTION_STEP: f64 = 1e-2;
const PRESSURE_STEP: f64 = 1e-4;
/// Offsets and weights of the fourth-order difference, over 12 steps.
const STENCIL: [(f64, f64); 4] = [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)];
/// Most equilibria of a muscle that are kept.
const MOST_KEPT: usize = 1 << 16;

/// What a table of a joint may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum JointOutput {
    /// Torque of both muscles \[N m\].
    Torque,
    /// -d(torque)/d(angle) at constant pressures \[N m/rad\].
    Stiffness,
    /// Torque of the agonist \[N m\], >= 0.
    TorqueAgonist,
    /// Torque of the antagonist \[N m\], <= 0.
    TorqueAntagonist,
    /// Contraction of the agonist \[-\].
    ContractionAgonist,
    /// Contraction of the antagonist \[-\].
    ContractionAntagonist,
}

impl JointOutput {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Torque,
        Self::Stiffness,
        Self::TorqueAgonist,
        Self::TorqueAntagonist,
        Self::ContractionAgonist,
        Self::ContractionAntagonist,
    ];

    /// Its name in files and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Torque => "torque",
            Self::Stiffness => "stiffness",
            Self::TorqueAgonist => "torque_agonist",
            Self::TorqueAntagonist => "torque_antagonist",
            Self::ContractionAgonist => "contraction_agonist",
            Self::ContractionAntagonist => "contraction_antagonist",
        }
    }

    /// Its unit; "1" for a pure number.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Torque | Self::TorqueAgonist | Self::TorqueAntagonist => "N m",
            Self::Stiffness => "N m/rad",
            Self::ContractionAgonist | Self::ContractionAntagonist => "1",
        }
    }
}

/// Equilibria of a muscle by the bits of angle and pressure.
type Kept = Mutex<HashMap<[u64; 2], Pull>>;

/// A joint as a field: angle \[rad\], pressure of the agonist and of the antagonist \[Pa\].
#[derive(Debug)]
pub struct JointField<'a> {
    joint: &'a Joint,
    axes: Vec<FieldAxis>,
    outputs: Vec<FieldOutput>,
    /// On a grid each muscle's equilibria come again at every pressure of the other.
    kept: [Kept; 2],
}

impl<'a> JointField<'a> {
    /// The field of a joint and its outputs.
    #[must_use]
    pub fn new(joint: &'a Joint) -> Self {
        let axis = |name: &str, unit: &str, [low, high]: [f64; 2]| FieldAxis {
            name: name.to_owned(),
            unit: unit.to_owned(),
            low,
            high: Some(high),
        };
        let output = |output: &JointOutput| FieldOutput {
            name: output.name().to_owned(),
            unit: output.unit().to_owned(),
            is_singular: false,
            vanishes: false,
        };
        Self {
            joint,
            axes: vec![
                axis("angle", "rad", joint.angle),
                axis("pressure_agonist", "Pa", joint.pressure),
                axis("pressure_antagonist", "Pa", joint.pressure),
            ],
            outputs: joint.outputs.iter().map(output).collect(),
            kept: [Mutex::default(), Mutex::default()],
        }
    }

    /// A muscle's pull, from those kept if it is there.
    fn pull(&self, which: usize, angle: f64, pressure: f64) -> Result<Pull, JointError> {
        let key = [angle.to_bits(), pressure.to_bits()];
        // A poisoned lock loses speed only.
        if let Ok(kept) = self.kept[which].lock()
            && let Some(pull) = kept.get(&key)
        {
            return Ok(*pull);
        }
        let pull = self.joint.muscles[which].pull(&self.joint.linkage, angle, pressure)?;
        if let Ok(mut kept) = self.kept[which].lock()
            && kept.len() < MOST_KEPT
        {
            kept.insert(key, pull);
        }
        Ok(pull)
    }

    /// Second derivatives of a muscle's torque, by the angle and by angle and pressure: differences of its exact derivative by the angle.
    fn bend(&self, which: usize, angle: f64, pressure: f64) -> Result<[f64; 2], JointError> {
        let (muscle, linkage) = (&self.joint.muscles[which], &self.joint.linkage);
        let [low, high] = self.joint.angle;
        let mut by_angle = ANGLE_STEP * (high - low);
        if muscle.is_singular {
            let per_angle = linkage.at(muscle.side, angle).arm.abs() / muscle.muscle.length().si();
            by_angle = by_angle.min(CONTRACTION_STEP * muscle.contraction(linkage, angle) / per_angle);
        }
        let by_pressure = PRESSURE_STEP * pressure;
        let mut sums = [0.0; 2];
        for (times, weight) in STENCIL {
            let beside = muscle.pull(linkage, angle + times * by_angle, pressure)?;
            sums[0] += weight * beside.by_angle / (12.0 * by_angle);
            let beside = muscle.pull(linkage, angle, pressure + times * by_pressure)?;
            sums[1] += weight * beside.by_angle / (12.0 * by_pressure);
        }
        Ok(sums)
    }

    fn filled(&self, [one, other]: &[Pull; 2], values: &mut [f64]) {
        for (value, output) in values.iter_mut().zip(&self.joint.outputs) {
            *value = match output {
                JointOutput::Torque => one.torque + other.torque,
                JointOutput::Stiffness => -(one.by_angle + other.by_angle),
                JointOutput::TorqueAgonist => one.torque,
                JointOutput::TorqueAntagonist => other.torque,
                JointOutput::ContractionAgonist => one.contraction,
                JointOutput::ContractionAntagonist => other.contraction,
            };
        }
    }

    fn both(&self, angle: f64, [agonist, antagonist]: [f64; 2]) -> Result<[Pull; 2], JointError> {
        Ok([self.pull(0, angle, agonist)?, self.pull(1, angle, antagonist)?])
    }

    fn graded(
        &self,
        angle: f64,
        pressures: [f64; 2],
        values: &mut [f64],
        gradients: &mut [f64],
    ) -> Result<(), JointError> {
        let joint = self.joint;
        let pulls = self.both(angle, pressures)?;
        self.filled(&pulls, values);
        let needs = |wanted: &[JointOutput]| joint.outputs.iter().any(|output| wanted.contains(output));
        let (mut by_pressure, mut bends, mut contracts) = ([0.0; 2], [[0.0; 2]; 2], [0.0; 2]);
        for (i, muscle) in joint.muscles.iter().enumerate() {
            contracts[i] = joint.linkage.at(muscle.side, angle).arm / muscle.muscle.length().si();
            if needs(&[JointOutput::Torque, JointOutput::TorqueAgonist, JointOutput::TorqueAntagonist]) {
                by_pressure[i] = muscle.by_pressure(&joint.linkage, angle, pressures[i])?;
            }
            if needs(&[JointOutput::Stiffness]) {
                bends[i] = self.bend(i, angle, pressures[i])?;
            }
        }
        let [one, other] = pulls;
        for (gradient, output) in gradients.chunks_exact_mut(3).zip(&joint.outputs) {
            gradient.copy_from_slice(&match output {
                JointOutput::Torque => [one.by_angle + other.by_angle, by_pressure[0], by_pressure[1]],
                JointOutput::Stiffness => [-(bends[0][0] + bends[1][0]), -bends[0][1], -bends[1][1]],
                JointOutput::TorqueAgonist => [one.by_angle, by_pressure[0], 0.0],
                JointOutput::TorqueAntagonist => [other.by_angle, 0.0, by_pressure[1]],
                JointOutput::ContractionAgonist => [contracts[0], 0.0, 0.0],
                JointOutput::ContractionAntagonist => [contracts[1], 0.0, 0.0],
            });
        }
        Ok(())
    }
}

/// Angle and pressures of a point of the field.
fn parts(point: &[f64]) -> Result<(f64, [f64; 2]), NoValue> {
    match point {
        [angle, agonist, antagonist] => Ok((*angle, [*agonist, *antagonist])),
        _ => Err(NoValue(format!("a joint has 3 axes, not {}", point.len()))),
    }
}

#[expect(clippy::needless_pass_by_value, reason = "taken by map_err")]
fn none(error: JointError) -> NoValue {
    NoValue(error.to_string())
}

impl Field for JointField<'_> {
    fn axes(&self) -> &[FieldAxis] {
        &self.axes
    }

    fn outputs(&self) -> &[FieldOutput] {
        &self.outputs
    }

    fn upper_end(&self, _: &[f64]) -> Result<f64, NoValue> {
        Ok(self.joint.angle[1])
    }

    fn values(&self, point: &[f64], values: &mut [f64]) -> Result<(), NoValue> {
        let (angle, pressures) = parts(point)?;
        let pulls = self.both(angle, pressures).map_err(none)?;
        self.filled(&pulls, values);
        Ok(())
    }

    fn gradients(&self, point: &[f64], values: &mut [f64], gradients: &mut [f64]) -> Result<(), NoValue> {
        let (angle, pressures) = parts(point)?;
        self.graded(angle, pressures, values, gradients).map_err(none)
    }
}
