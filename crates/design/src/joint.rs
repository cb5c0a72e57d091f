//! A joint with two antagonistic muscles: torque and stiffness as functions of the angle and of both
//! pressures.
//!
//! ```text
//! torque     M = F1 (-dl1/dtheta) - F2 dl2/dtheta          [N m]; a positive angle shortens the agonist 1
//! stiffness  K = -dM/dtheta at constant pressures          [N m/rad]
//! ```
//! The difference of the pressures sets the angle, and their sum the stiffness (S1, section 4.1).

mod file;
mod four_bar;
mod geometry;
mod muscle;
mod question;
mod state;
#[cfg(test)]
mod tests;

pub use file::{Checks, JOINT_EXAMPLE};
pub use four_bar::FourBar;
pub use geometry::{Linkage, Side};
pub use muscle::{JointMuscle, Pull};
pub use question::{JointAnswer, JointDocument, JointGas, JointParts, JointQuestion, MapPlace};
pub use state::{Closed, JointState, Outside, Readings, SideState};

use bulge_fibre::Approach;
use bulge_muscles::{Fault, Pressure};
use bulge_numerics::root::illinois;
use serde::Serialize;

/// Least contraction of a muscle whose fibres don't stretch, because its force is infinite at 0.
const LEAST_CONTRACTION: f64 = 1e-4;
/// Relative accuracy of the least pressure at which a muscle pulls.
const PRESSURE_TOLERANCE: f64 = 1e-9;
/// Tolerance of pressures and angles relative to their ranges.
const TOLERANCE: f64 = 1e-12;

/// The error of a muscle of a joint.
type Cause = Box<dyn std::error::Error + Send + Sync>;

/// Why a joint has no torque, or no angle.
#[derive(Debug, thiserror::Error)]
pub enum JointError {
    /// A muscle has no equilibrium.
    #[error("the {} at the angle {:.4} deg and {}: {error}", side.name(), angle.to_degrees(), Pressure::pa(*pressure_pa))]
    Muscle {
        /// The muscle.
        side: Side,
        /// Angle \[rad\].
        angle: f64,
        /// Its pressure \[Pa\].
        pressure_pa: f64,
        /// The cause.
        error: Cause,
    },
    /// An angle or a pressure outside the range of the joint, or a closed muscle without gauge pressure.
    #[error("{0}")]
    Outside(String),
    /// A stiffness that can't be reached at an angle within the range of pressures.
    #[error(
        "no pressures in the joint's range give {stiffness:.4} N m/rad at {:.4} deg: there it is {:.4} to {:.4} N m/rad",
        angle.to_degrees(), range[0], range[1]
    )]
    Stiffness {
        /// Angle \[rad\].
        angle: f64,
        /// Requested stiffness \[N m/rad\].
        stiffness: f64,
        /// Smallest and largest stiffness \[N m/rad\].
        range: [f64; 2],
    },
    /// An angle that can't be held by any pressures.
    #[error(
        "no pressures in the joint's range hold {:.4} deg under {outside:.4} N m from outside: they can hold {:.4} to {:.4} N m there",
        angle.to_degrees(), range[0], range[1]
    )]
    Held {
        /// Angle \[rad\].
        angle: f64,
        /// External torque \[N m\].
        outside: f64,
        /// Smallest and largest torque that can be held \[N m\].
        range: [f64; 2],
    },
    /// The muscles turn the joint beyond an end of its range.
    #[error(
        "no rest at {} and {}: the torque of all is {:.4} N m at {:.4} deg and {:.4} N m at {:.4} deg; choose pressures closer to each other, less torque from outside, or a wider range",
        Pressure::pa(pressures[0]), Pressure::pa(pressures[1]), torques[0], range[0].to_degrees(), torques[1], range[1].to_degrees()
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

impl JointError {
    /// The kind of the error: there is no such state.
    #[must_use]
    pub const fn fault(&self) -> Fault {
        Fault::NoSolution
    }
}

/// A joint with two muscles.
#[derive(Debug, Clone, Serialize)]
pub struct Joint {
    /// Its name.
    pub name: String,
    linkage: Linkage,
    muscles: [JointMuscle; 2],
    /// Range of the angle \[rad\].
    pub angle: [f64; 2],
    /// Range of both pressures \[Pa\].
    pub pressure: [f64; 2],
}

impl Joint {
    /// The linkage that converts pull into torque.
    #[must_use]
    pub const fn linkage(&self) -> &Linkage {
        &self.linkage
    }

    /// Agonist and antagonist.
    #[must_use]
    pub const fn muscles(&self) -> &[JointMuscle; 2] {
        &self.muscles
    }

    /// Torque of both muscles \[N m\] at an angle \[rad\] and the pressures of agonist and antagonist \[Pa\], > 0.
    ///
    /// # Errors
    /// [`JointError::Outside`] for an angle outside the range, or [`JointError::Muscle`] if there is no
    /// equilibrium.
    pub fn torque(&self, angle: f64, agonist_pa: f64, antagonist_pa: f64) -> Result<f64, JointError> {
        self.inside(angle)?;
        self.moment(angle, [agonist_pa, antagonist_pa])
    }

    /// Stiffness -dM/dtheta at constant pressures \[N m/rad\].
    ///
    /// # Errors
    /// As [`Joint::torque`].
    pub fn stiffness(&self, angle: f64, agonist_pa: f64, antagonist_pa: f64) -> Result<f64, JointError> {
        self.inside(angle)?;
        let [one, other] = self.pulls(angle, [agonist_pa, antagonist_pa])?;
        Ok(-(one.by_angle + other.by_angle))
    }

    /// The range of angles in which both muscles pull at their pressures, with the torques at its ends. It is
    /// the range of the joint or a part of it.
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
            let end = muscle.extended.range_end(Pressure::pa(pressure), Approach::Auto);
            let end = end.map_err(|error| muscle.failed(0.0, pressure, error))?;
            let bounds =
                [if muscle.is_singular { LEAST_CONTRACTION } else { f64::NEG_INFINITY }, end.contraction()];
            for angle in whole {
                let contraction = muscle.contraction(angle);
                let bound = contraction.clamp(bounds[0], bounds[1]);
                if bound.to_bits() != contraction.to_bits() {
                    let border = muscle.angle_at(bound, whole);
                    if angle > border { high = high.min(border) } else { low = low.max(border) }
                }
            }
        }
        if low >= high {
            // One muscle doesn't pull at any angle at which the other one does.
            self.pulls(0.5 * (whole[0] + whole[1]), pressures)?;
        }
        Ok(([low, high], [torque(low)?, torque(high)?]))
    }

    /// The smallest pressure in the range of the joint at which a muscle pulls at an angle.
    fn least_pressure(&self, muscle: &JointMuscle, angle: f64) -> Result<f64, JointError> {
        let [mut low, mut high] = self.pressure;
        if muscle.pull(angle, low).is_ok() {
            return Ok(low);
        }
        muscle.pull(angle, high)?;
        // Bisection keeps `high` a pressure at which the muscle pulls.
        while high - low > PRESSURE_TOLERANCE * high {
            let middle = 0.5 * (low + high);
            match muscle.pull(angle, middle) {
                Ok(_) => high = middle,
                Err(_) => low = middle,
            }
        }
        Ok(high)
    }

    fn inside(&self, angle: f64) -> Result<(), JointError> {
        let [low, high] = self.angle;
        if angle >= low && angle <= high {
            return Ok(());
        }
        Err(JointError::Outside(format!(
            "the angle {:.4} deg is outside the range of the joint, {:.4} deg to {:.4} deg",
            angle.to_degrees(),
            low.to_degrees(),
            high.to_degrees()
        )))
    }

    fn pulls(&self, angle: f64, pressures: [f64; 2]) -> Result<[Pull; 2], JointError> {
        let [one, other] = &self.muscles;
        Ok([one.pull(angle, pressures[0])?, other.pull(angle, pressures[1])?])
    }

    /// Torque of both muscles \[N m\] at any angle.
    fn moment(&self, angle: f64, pressures: [f64; 2]) -> Result<f64, JointError> {
        let [one, other] = self.pulls(angle, pressures)?;
        Ok(one.torque + other.torque)
    }
}

/// Root of a function between two places, or the first error of the function.
fn root(
    function: impl Fn(f64) -> Result<f64, JointError>,
    [low, high]: [f64; 2],
    tolerance: f64,
) -> Result<f64, JointError> {
    let mut failed = None;
    let value = |x: f64| {
        function(x).unwrap_or_else(|error| {
            failed.get_or_insert(error);
            f64::NAN
        })
    };
    let found = illinois(value, low, high, tolerance);
    failed.map_or(Ok(found), Err)
}
