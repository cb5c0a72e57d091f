//! Properties derived from the columns of a data set and its sweeps.

use crate::data::Data;
use crate::quality::Disturbance;
use crate::resolution::Resolution;
use crate::stretch::{DeadBand, Stretch};
use crate::sweep::{Sweep, SweepKind};
use std::sync::OnceLock;

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
    /// What [`Data::disturbed`] found; several questions about the same rows need it.
    pub(crate) disturbed: OnceLock<Vec<Disturbance>>,
}

impl Data {
    /// The pressure stretches in the sweeps of [`Data::paths`].
    pub(crate) fn pressure_paths(&self) -> impl Iterator<Item = &[Stretch]> {
        self.structure.pressure_stretches.iter().map(Vec::as_slice)
    }

    /// The sweeps whose rows follow each other, with the stretches of their length.
    pub(crate) fn paths(&self) -> impl Iterator<Item = (&Sweep, &[Stretch])> {
        let stretches = self.structure.stretches.iter().map(Vec::as_slice);
        self.sweeps().iter().filter(|sweep| sweep.kind != SweepKind::Static).zip(stretches)
    }
}
