//! Properties derived from the columns of a data set and its sweeps.

use crate::resolution::Resolution;
use crate::stretch::{DeadBand, Stretch};

/// Properties derived from columns and sweeps.
#[derive(Debug, Clone, Default)]
pub(crate) struct Structure {
    /// The monotone stretches of the length in each sweep; a single rest if the length is held; none in a
    /// static map.
    pub(crate) stretches: Vec<Vec<Stretch>>,
    /// The monotone stretches of the pressure; none in sweeps at held pressure.
    pub(crate) pressure_stretches: Vec<Vec<Stretch>>,
    /// The smallest change of the pressure that isn't noise.
    pub(crate) pressure_band: DeadBand,
    /// Resolution of the motion.
    pub(crate) resolution: Resolution,
    pub(crate) band: DeadBand,
    /// 1 for contractions, the longest length for lengths: the size of the muscle if l0 isn't known.
    pub(crate) scale: f64,
}
