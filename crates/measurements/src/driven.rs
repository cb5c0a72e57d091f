//! The driven quantity of a sweep.

use crate::data::Data;
use crate::stretch::{DeadBand, Stretch};
use crate::sweep::{Sweep, SweepKind};

/// The driven quantity of a sweep: the length, or the pressure if the length is held.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Driven<'a> {
    /// Its monotone stretches.
    pub(crate) stretches: &'a [Stretch],
    /// Contraction, length or pressure of all rows, as measured.
    pub(crate) values: &'a [f64],
    pub(crate) band: DeadBand,
}

impl Data {
    /// The sweeps whose rows follow each other, with their driven quantity.
    pub(crate) fn driven(&self) -> impl Iterator<Item = (&Sweep, Driven<'_>)> {
        self.paths().zip(self.pressure_paths()).map(|((sweep, stretches), filling)| {
            let structure = &self.structure;
            let driven = if sweep.kind == SweepKind::Isometric {
                Driven { stretches: filling, values: self.pressure(), band: structure.pressure_band }
            } else {
                Driven { stretches, values: self.columns().motion.values(), band: structure.band }
            };
            (sweep, driven)
        })
    }
}
