//! Two antagonistic muscles on a joint: torque and stiffness over angle and both pressures.
//!
//! ```text
//! torque     M = F1 (-dl1/dtheta) - F2 dl2/dtheta          [N m]; a positive angle shortens the agonist 1
//! stiffness  K = -dM/dtheta at constant pressures          [N m/rad]
//! ```
//! As S1 section 4.1 says, the difference of the pressures sets the angle, and their sum the stiffness.

mod field;
mod file;
mod four_bar;
mod geometry;
mod joint_state;
#[cfg(test)]
mod tests;

pub use field::{JointField, JointOutput};
pub use file::JOINT_EXAMPLE;
pub use four_bar::FourBar;
pub use geometry::{Drive, Linkage, Side};
pub use joint_state::{Closed, JointState, Outside, Readings, SideState};

use bulge_effects::{Catalogue, Group, known};
use bulge_fibre::Approach;
use bulge_muscles::{Muscle, Parameter, Quantity as _};
use bulge_numerics::root::{RootError, illinois, newton_bracketed};
use serde::Serialize;

use crate::family::Family;
use crate::family_error::FamilyError;
use crate::output::Output;
use crate::plan::{Axis, End, Plan, Quantity, Range, Spacing, TableRequirements};

/// Tolerance of an angle without load \[rad\]: a Newton step of this size ends far closer.
const ANGLE_TOLERANCE: f64 = 1e-9;

/// Contraction from which on a muscle of fibres that don't stretch is asked: at 0 its force is infinite.
const LEAST_CONTRACTION: f64 = 1e-4;
/// Part of a pressure to which the least one is found at which a muscle pulls.
const PRESSURE_TOLERANCE: f64 = 1e-9;

/// Why a joint has no torque, or no angle.
#[derive(Debug, thiserror::Error)]
pub enum JointError {
    /// No equilibrium of a muscle.
    #[error("the {} at the angle {:.4} deg and {pressure_pa} Pa: {error}", side.name(), angle.to_degrees())]
    Muscle {
        /// Which muscle.
        side: Side,
        /// Angle \[rad\].
        angle: f64,
        /// Its pressure \[Pa\].
        pressure_pa: f64,
        /// What is wrong.
        error: FamilyError,
    },
    /// An angle that isn't in the joint's range.
    #[error(
        "the angle {:.4} deg is outside the range of the joint, {:.4} deg to {:.4} deg",
        angle.to_degrees(), range[0].to_degrees(), range[1].to_degrees()
    )]
    Outside {
        /// Asked angle \[rad\].
        angle: f64,
        /// The range \[rad\].
        range: [f64; 2],
    },
    /// A stiffness that the range of pressures doesn't give at an angle.
    #[error(
        "no pressures in the joint's range give {stiffness:.4} N m/rad at {:.4} deg: there it is {:.4} to {:.4} N m/rad",
        angle.to_degrees(), range[0], range[1]
    )]
    Stiffness {
        /// Angle \[rad\].
        angle: f64,
        /// Asked stiffness \[N m/rad\].
        stiffness: f64,
        /// Least and most \[N m/rad\].
        range: [f64; 2],
    },
    /// An angle that no pressures hold.
    #[error(
        "no pressures in the joint's range hold {:.4} deg under {outside:.4} N m from outside: they can hold {:.4} to {:.4} N m there",
        angle.to_degrees(), range[0], range[1]
    )]
    Held {
        /// Angle \[rad\].
        angle: f64,
        /// Torque from outside \[N m\].
        outside: f64,
        /// Least and most that can be held \[N m\].
        range: [f64; 2],
    },
    /// A pressure outside the joint's range.
    #[error("the pressure of the {}, {:.4} bar, is outside the range of the joint, {:.4} to {:.4} bar", side.name(), 1e-5 * pressure_pa, 1e-5 * range[0], 1e-5 * range[1])]
    Pressure {
        /// Which muscle.
        side: Side,
        /// Its pressure \[Pa\].
        pressure_pa: f64,
        /// The range \[Pa\].
        range: [f64; 2],
    },
    /// A closed muscle that has lost its pressure.
    #[error("the closed {} has no pressure left at {:.4} deg: {pressure_pa:.0} Pa below the air around it; fill it more", side.name(), angle.to_degrees())]
    Empty {
        /// Which muscle.
        side: Side,
        /// Angle \[rad\].
        angle: f64,
        /// Gauge pressure that its gas would have \[Pa\].
        pressure_pa: f64,
    },
    /// The muscles turn the joint beyond an end of its range.
    #[error(
        "no rest at {} Pa and {} Pa: the torque of all is {:.4} N m at {:.4} deg and {:.4} N m at {:.4} deg; choose pressures closer to each other, less torque from outside, or a wider range",
        pressures[0], pressures[1], torques[0], range[0].to_degrees(), torques[1], range[1].to_degrees()
    )]
    NoRest {
        /// Pressures of agonist and antagonist \[Pa\].
        pressures: [f64; 2],
        /// Torques at the ends of the range \[N m\].
        torques: [f64; 2],
        /// The range \[rad\].
        range: [f64; 2],
    },
}

/// A muscle on its side of a joint.
#[derive(Debug, Clone, Serialize)]
pub struct JointMuscle {
    side: Side,
    muscle: Muscle,
    /// Contraction at the angle 0.
    contraction: f64,
    #[serde(skip)]
    family: Family,
    /// Whether the force is infinite at the contraction 0.
    #[serde(skip)]
    is_singular: bool,
    /// The same muscle over the numbers that its file states with a width, with these numbers and widths.
    #[serde(skip)]
    unsure: Option<(Family, Vec<[f64; 2]>)>,
}

/// A joint with two muscles.
#[derive(Debug, Clone, Serialize)]
pub struct Joint {
    /// Its name.
    pub name: String,
    linkage: Linkage,
    muscles: [JointMuscle; 2],
    /// Range of the angle \[rad\].
    angle: [f64; 2],
    /// Range of both pressures \[Pa\].
    pressure: [f64; 2],
    outputs: Vec<JointOutput>,
    table: Option<TableRequirements>,
}

/// What a muscle contributes to the torque, with derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pull {
    torque: f64,
    by_angle: f64,
    contraction: f64,
}

impl JointMuscle {
    fn new(side: Side, muscle: Muscle, contraction: f64) -> Result<Self, FamilyError> {
        let axis = |quantity, name: &str, unit: &str| Axis {
            quantity,
            name: name.to_owned(),
            unit: unit.to_owned(),
            range: Range::Between { from: 0.0, to: End::Limit, points: None, spacing: Spacing::Linear },
        };
        // The family over contraction and pressure; ranges take no part in it.
        let mut plan = Plan {
            name: muscle.name().to_owned(),
            muscle,
            pressure_pa: 1e5,
            contraction: None,
            approach: Approach::Auto,
            axes: vec![
                axis(Quantity::Contraction, "contraction", "1"),
                axis(Quantity::Pressure, "pressure", "Pa"),
            ],
            design: None,
            outputs: vec![Output::Force],
            chunk: 1,
            table: None,
        };
        let family = Family::new(&plan)?;
        let is_singular = family.member(&[contraction, 1e5])?.problem().is_singular();
        let unsure = stated_widths(&plan.muscle)?;
        plan.axes.extend(unsure.iter().map(|(quantity, _)| axis(quantity.clone(), "number", "1")));
        let numbers: Vec<[f64; 2]> = unsure.into_iter().map(|(_, number)| number).collect();
        let unsure = if numbers.is_empty() { None } else { Some((Family::new(&plan)?, numbers)) };
        Ok(Self { side, muscle: plan.muscle, contraction, family, is_singular, unsure })
    }

    /// Which muscle of the joint.
    #[must_use]
    pub const fn side(&self) -> Side {
        self.side
    }

    /// The muscle.
    #[must_use]
    pub const fn muscle(&self) -> &Muscle {
        &self.muscle
    }

    fn contraction(&self, linkage: &Linkage, angle: f64) -> f64 {
        self.contraction + linkage.at(self.side, angle).shortening / self.muscle.length().si()
    }

    /// The angle in a range at which the muscle has a contraction, where it has.
    fn angle_at(&self, linkage: &Linkage, contraction: f64, [low, high]: [f64; 2]) -> f64 {
        illinois(|angle| self.contraction(linkage, angle) - contraction, low, high, 1e-12)
    }

    /// ```text
    /// M_i = F m,   m = -dl/dtheta,   dk/dtheta = m/l0,   dM_i/dtheta = dF/dk m^2/l0 + F dm/dtheta
    /// ```
    fn pull(&self, linkage: &Linkage, angle: f64, pressure: f64) -> Result<Pull, JointError> {
        let reach = linkage.at(self.side, angle);
        let contraction = self.contraction(linkage, angle);
        let mut values = [0.0; 2];
        let member = self.family.member(&[contraction, pressure]);
        member
            .and_then(|member| {
                member.pulling(contraction, None, &[Output::Force, Output::ForceByContraction], &mut values)
            })
            .map_err(|error| self.failed(angle, pressure, error))?;
        let [force, by_contraction] = values;
        Ok(Pull {
            torque: force * reach.arm,
            by_angle: by_contraction * reach.arm * reach.arm / self.muscle.length().si()
                + force * reach.arm_by_angle,
            contraction,
        })
    }

    /// Derivative of the torque by the pressure \[N m/Pa\].
    fn by_pressure(&self, linkage: &Linkage, angle: f64, pressure: f64) -> Result<f64, JointError> {
        let (mut force, mut by) = ([0.0], [0.0; 2]);
        let point = [self.contraction(linkage, angle), pressure];
        self.family
            .gradients(&point, &[Output::Force], &mut force, &mut by)
            .map_err(|error| self.failed(angle, pressure, error))?;
        Ok(by[1] * linkage.at(self.side, angle).arm)
    }

    /// Standard deviation of the force that comes of the widths in the muscle's file, as if its numbers were independent \[N\]: slopes by differences over a
    /// fifth of a width.
    fn unsure(&self, linkage: &Linkage, angle: f64, pressure: f64) -> Result<f64, JointError> {
        let Some((family, numbers)) = &self.unsure else { return Ok(0.0) };
        let contraction = self.contraction(linkage, angle);
        let force = |k: usize, moved: f64| {
            let mut point = vec![contraction, pressure];
            point.extend(numbers.iter().map(|[value, _]| *value));
            point[2 + k] += moved;
            let mut values = [0.0];
            let member = family.member(&point);
            member
                .and_then(|member| member.outputs(contraction, &[Output::Force], &mut values))
                .map_err(|error| self.failed(angle, pressure, error))?;
            Ok::<_, JointError>(values[0])
        };
        let mut sum = 0.0_f64;
        for (k, [_, width]) in numbers.iter().enumerate() {
            let step = 0.1 * width;
            // At a bound of the number one side is enough.
            let slope = match (force(k, step), force(k, -step)) {
                (Ok(up), Ok(down)) => (up - down) / (2.0 * step),
                (Ok(up), Err(_)) => (up - force(k, 0.0)?) / step,
                (Err(_), Ok(down)) => (force(k, 0.0)? - down) / step,
                (Err(error), Err(_)) => return Err(error),
            };
            sum = sum.hypot(slope * width);
        }
        Ok(sum)
    }

    fn failed(&self, angle: f64, pressure_pa: f64, error: FamilyError) -> JointError {
        JointError::Muscle { side: self.side, angle, pressure_pa, error }
    }
}

/// Numbers of a muscle file that have a width: of the muscle (but its length and its number of fibres, which say what a contraction and a fibre are) and of
/// the effects that belong to it, with value and width in SI.
fn stated_widths(muscle: &Muscle) -> Result<Vec<(Quantity, [f64; 2])>, FamilyError> {
    let mut found = Vec::new();
    for (parameter, width) in muscle.widths() {
        let is_fixed = matches!(parameter, Parameter::Length | Parameter::Fibres);
        // A width of 0 says that the number is exact.
        if let (Some(value), false) = (muscle.get(*parameter), is_fixed || *width <= 0.0) {
            found.push((Quantity::Parameter(*parameter), [value, *width]));
        }
    }
    for (effect, _) in known(muscle, &Catalogue::builtin())? {
        let card = effect.card();
        if matches!(card.group, Group::Rig | Group::Specimen) {
            continue;
        }
        let stated = muscle.learnt().iter().find(|learnt| learnt.name() == card.name);
        for value in stated.into_iter().flat_map(bulge_muscles::Learnt::values) {
            if let Some(width) = value.width.filter(|width| *width > 0.0) {
                let quantity = Quantity::Effect { effect: card.name.to_owned(), key: value.key.clone() };
                found.push((quantity, [value.si, width]));
            }
        }
    }
    Ok(found)
}

impl Joint {
    /// What turns pull into torque.
    #[must_use]
    pub const fn linkage(&self) -> Linkage {
        self.linkage
    }

    /// Agonist and antagonist.
    #[must_use]
    pub const fn muscles(&self) -> &[JointMuscle; 2] {
        &self.muscles
    }

    /// Range of the angle \[rad\].
    #[must_use]
    pub const fn angles(&self) -> [f64; 2] {
        self.angle
    }

    /// Range of both pressures \[Pa\].
    #[must_use]
    pub const fn pressures(&self) -> [f64; 2] {
        self.pressure
    }

    /// What is tabulated.
    #[must_use]
    pub fn outputs(&self) -> &[JointOutput] {
        &self.outputs
    }

    /// What its table must reach, if one is wanted; the outputs are those of the joint, not of the wish, which has none.
    #[must_use]
    pub const fn table(&self) -> Option<&TableRequirements> {
        self.table.as_ref()
    }

    /// Torque of both muscles \[N m\] at an angle \[rad\] and the pressures of agonist and antagonist \[Pa\], > 0.
    ///
    /// # Errors
    /// [`JointError::Outside`] its range of angles, or [`JointError::Muscle`] without equilibrium.
    pub fn torque(&self, angle: f64, agonist_pa: f64, antagonist_pa: f64) -> Result<f64, JointError> {
        self.inside(angle)?;
        Ok(self.pulls(angle, [agonist_pa, antagonist_pa])?.map(|pull| pull.torque).iter().sum())
    }

    /// Stiffness -dM/dtheta at constant pressures \[N m/rad\].
    ///
    /// # Errors
    /// As [`Joint::torque`].
    pub fn stiffness(&self, angle: f64, agonist_pa: f64, antagonist_pa: f64) -> Result<f64, JointError> {
        self.inside(angle)?;
        Ok(-self.pulls(angle, [agonist_pa, antagonist_pa])?.map(|pull| pull.by_angle).iter().sum::<f64>())
    }

    /// Angle without load \[rad\] at the pressures of agonist and antagonist \[Pa\]: where the torque vanishes and falls with the angle.
    ///
    /// # Errors
    /// [`JointError::NoRest`] if it isn't in the range of angles, or [`JointError::Muscle`].
    pub fn angle(&self, agonist_pa: f64, antagonist_pa: f64) -> Result<f64, JointError> {
        let pressures = [agonist_pa, antagonist_pa];
        let value = |angle: f64| {
            let [one, other] = self.pulls(angle, pressures)?;
            Ok::<_, JointError>((one.torque + other.torque, one.by_angle + other.by_angle))
        };
        let torque = |angle: f64| value(angle).map(|(torque, _)| torque);
        let (range @ [low, high], torques) = self.ends(torque, pressures)?;
        let none = JointError::NoRest { pressures, torques, range };
        if !(torques[0] >= 0.0 && torques[1] <= 0.0) {
            return Err(none);
        }
        match newton_bracketed(value, low, high, 0.5 * (low + high), [ANGLE_TOLERANCE, 0.0]) {
            Ok(angle) => Ok(angle),
            Err(RootError::Function(error)) => Err(error),
            Err(RootError::Budget { .. }) => Err(none),
        }
    }

    /// The range of angles in which both muscles pull at their pressures, with a torque at its ends: that of the joint, or less of it.
    fn ends(
        &self,
        torque: impl Fn(f64) -> Result<f64, JointError>,
        pressures: [f64; 2],
    ) -> Result<([f64; 2], [f64; 2]), JointError> {
        let whole @ [low, high] = self.angle;
        if let (Ok(first), Ok(last)) = (torque(low), torque(high)) {
            return Ok((whole, [first, last]));
        }
        let [mut low, mut high] = whole;
        for (muscle, pressure) in self.muscles.iter().zip(pressures) {
            let end = muscle.family.member(&[muscle.contraction, pressure]).and_then(|m| m.range_end());
            let end = end.map_err(|error| muscle.failed(0.0, pressure, error))?;
            let bounds =
                [if muscle.is_singular { LEAST_CONTRACTION } else { f64::NEG_INFINITY }, end.contraction()];
            for angle in whole {
                let contraction = muscle.contraction(&self.linkage, angle);
                let bound = contraction.clamp(bounds[0], bounds[1]);
                if bound.to_bits() != contraction.to_bits() {
                    let border = muscle.angle_at(&self.linkage, bound, whole);
                    if angle > border { high = high.min(border) } else { low = low.max(border) }
                }
            }
        }
        if low >= high {
            // One of them doesn't pull at any angle at which the other one does.
            self.pulls(0.5 * (whole[0] + whole[1]), pressures)?;
        }
        Ok(([low, high], [torque(low)?, torque(high)?]))
    }

    /// The least of the joint's pressures at which a muscle pulls at an angle.
    fn least_pressure(&self, muscle: &JointMuscle, angle: f64) -> Result<f64, JointError> {
        let [mut low, mut high] = self.pressure;
        if muscle.pull(&self.linkage, angle, low).is_ok() {
            return Ok(low);
        }
        muscle.pull(&self.linkage, angle, high)?;
        while high - low > PRESSURE_TOLERANCE * high {
            let middle = 0.5 * (low + high);
            match muscle.pull(&self.linkage, angle, middle) {
                Ok(_) => high = middle,
                Err(_) => low = middle,
            }
        }
        Ok(high)
    }

    fn inside(&self, angle: f64) -> Result<(), JointError> {
        let range @ [low, high] = self.angle;
        if angle >= low && angle <= high { Ok(()) } else { Err(JointError::Outside { angle, range }) }
    }

    fn pulls(&self, angle: f64, pressures: [f64; 2]) -> Result<[Pull; 2], JointError> {
        let [one, other] = &self.muscles;
        Ok([one.pull(&self.linkage, angle, pressures[0])?, other.pull(&self.linkage, angle, pressures[1])?])
    }
}
