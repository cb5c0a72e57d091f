//! From a load over a stroke to muscle, length and pressure.
//!
//! A load asks for the forces F_i after the travels x_i from where the muscle begins, at the contraction e_0. A muscle of length l at the gauge pressure p
//! does it if it pulls as much at each of them:
//!
//! ```text
//! F(p, e_i, l) >= (1 + margin) F_i      e_i = e_0 + x_i/l      p <= p_max      e_i <= e_max      F_i <= F_max
//! ```
//! With a pressure given, the shortest such l is sought; with a length given, the lowest such p (S4's figure 2, "Sizing Fluidic Muscle Using Static Force
//! Model"). A longer muscle contracts less and needs less pressure: both lengthen its life, so choices are ranked by
//!
//! ```text
//! strain of the muscle's life = sqrt((p/p_max)^2/2 + (e_end/e_max)^2/2)       0 .. 1, low is good
//! ```
//! which orders choices and is no forecast of cycles. Between the points the load is linear, and is looked at as well.

mod catalogue;
mod choice;
mod family;
mod load;
mod search;
#[cfg(test)]
mod tests;

pub use catalogue::fluidic_muscles;
pub use choice::{AtPoint, Choice, Given, Infeasible};
pub use family::{CutMuscle, Family, Limits};
pub use load::{LoadCase, LoadPoint};
pub use search::{Requirements, Sizing, Weights, size};

/// Why nothing can be sized.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SizeError {
    /// A load without points, or without a travel.
    #[error("the load has no stroke: say what force is needed after what travel, such as 500 N after 50 mm")]
    NoStroke,
    /// A travel or a force that makes no sense.
    #[error("point {point} of the load has the {what} {value}: it must be a finite number, 0 or more")]
    Load {
        /// Number of the point, from 1.
        point: usize,
        /// Travel or force.
        what: &'static str,
        /// Its value in SI.
        value: f64,
    },
    /// Points that don't go on.
    #[error(
        "point {point} of the load lies at the travel {travel_m} m, not beyond the one before: give the points in order, each travel once"
    )]
    Order {
        /// Number of the point, from 1.
        point: usize,
        /// Its travel \[m\].
        travel_m: f64,
    },
    /// No force at any point.
    #[error("the load is 0 N everywhere: any muscle carries it")]
    NoForce,
    /// A wish out of its range.
    #[error("the {what} is {value}: it must be {range}")]
    Requirements {
        /// What.
        what: &'static str,
        /// Its value in SI.
        value: f64,
        /// Where it may lie.
        range: &'static str,
    },
    /// A muscle that has no force where it is asked.
    #[error("{family} of {:.1} mm: {why}", 1e3 * length_m)]
    Muscle {
        /// Which muscle.
        family: String,
        /// Its length \[m\].
        length_m: f64,
        /// What is wrong.
        why: String,
    },
}
