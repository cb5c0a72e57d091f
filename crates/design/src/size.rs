//! Sizing: muscle, length and pressure for a load over a stroke.
//!
//! A load requires the forces F_i after the travels x_i, counted from the initial contraction e_0. A muscle
//! of length l at the gauge pressure p carries it if its pull is sufficient at each of these points:
//!
//! ```text
//! F(p, e_i, l) >= (1 + margin) F_i      e_i = e_0 + x_i/l      p <= p_max      e_i <= e_max      F_i <= F_max
//! ```
//! For a given pressure, the shortest such l is sought. For a given length, the lowest such p is sought (S4's
//! figure 2, "Sizing Fluidic Muscle Using Static Force Model"). A longer muscle contracts less and needs less
//! pressure. Both lengthen its life, so choices are ranked by
//!
//! ```text
//! strain of the muscle's life = sqrt((p/p_max)^2/2 + (e_end/e_max)^2/2)       0 .. 1, low is good
//! ```
//! This number orders choices; it is no forecast of cycles. Between the points the load is linear, and it is
//! checked there as well.

mod catalogue;
mod choice;
mod family;
mod load;
mod question;
mod search;
#[cfg(test)]
mod tests;

pub use catalogue::fluidic_muscles;
pub use choice::{AtPoint, Choice, Given, Infeasible};
pub use family::{CutMuscle, Family, Limits};
pub use load::{LoadCase, LoadPoint};
pub use question::{Candidates, Isobars, MUSCLES, OwnLimits, SizeDocument, SizeQuestion, force_or_weight};
pub use search::{Requirements, Sizing, Weights, size};

use crate::question::is;
use bulge_muscles::Fault;

/// Why nothing can be sized.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SizeError {
    /// An impossible load or requirement: what is wrong, and what to say instead.
    #[error("{0}")]
    Input(String),
    /// A muscle whose force can't be computed.
    #[error("{family} of {:.1} mm: {why}", 1e3 * length_m)]
    Muscle {
        /// Name of the muscle.
        family: String,
        /// Its length \[m\].
        length_m: f64,
        /// The cause.
        why: String,
    },
}

impl SizeError {
    /// The kind of the error: wrong input, or no solution.
    #[must_use]
    pub const fn fault(&self) -> Fault {
        match self {
            Self::Input(_) => Fault::Input,
            Self::Muscle { .. } => Fault::NoSolution,
        }
    }

    /// A load without points or without travel.
    fn no_stroke() -> Self {
        let cure = "say what force is needed after what travel, such as 500 N after 50 mm";
        Self::Input(format!("the load has no stroke: {cure}"))
    }

    /// A requirement outside its range.
    fn out_of_range(what: &str, value: f64, range: &str) -> Self {
        Self::Input(format!("the {}: it must be {range}", is(what, value)))
    }
}
