//! What follows from the columns of a data set and its sweeps.

use crate::resolution::Resolution;
use crate::stretch::{DeadBand, Stretch};

/// What follows from columns and sweeps.
#[derive(Debug, Clone)]
pub(crate) struct Structure {
    /// The monotone stretches of the length in each sweep, one rest where the length is held; none in a static map.
    pub(crate) stretches: Vec<Vec<Stretch>>,
    /// Those of the pressure; none in sweeps in which it is held.
    pub(crate) pressure_stretches: Vec<Vec<Stretch>>,
    /// How large a change of the pressure is no noise.
    pub(crate) pressure_band: DeadBand,
    /// Of the motion.
    pub(crate) resolution: Resolution,
    pub(crate) band: DeadBand,
    /// 1 for contractions, the longest length for lengths: what a share of the muscle is, where l0 isn't known.
    pub(crate) scale: f64,
}
