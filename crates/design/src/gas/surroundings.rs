//! The surroundings of a muscle: dead volume of tubes and fittings, and ambient pressure.

use super::{GasError, at_least, positive};

/// Dead volume and ambient pressure, checked.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surroundings {
    /// Dead volume \[m^3\], >= 0.
    pub(crate) dead_volume_m3: f64,
    /// Ambient pressure \[Pa\], absolute, > 0.
    pub(crate) ambient_pa: f64,
}

impl Surroundings {
    /// The standard atmosphere without dead volume.
    pub(crate) const STANDARD: Self = Self { dead_volume_m3: 0.0, ambient_pa: bulge_fibre::AMBIENT_PRESSURE };

    pub(super) fn with_dead_volume(self, volume_m3: f64) -> Result<Self, GasError> {
        let dead_volume_m3 =
            at_least("the dead volume [m^3]", volume_m3, 0.0, "give a finite volume from 0 on")?;
        Ok(Self { dead_volume_m3, ..self })
    }

    pub(super) fn with_ambient(self, pressure_pa: f64) -> Result<Self, GasError> {
        Ok(Self { ambient_pa: positive("the ambient pressure [Pa]", pressure_pa)?, ..self })
    }

    /// Absolute pressure \[Pa\] at a gauge pressure \[Pa\].
    pub(super) const fn absolute(&self, pressure_pa: f64) -> f64 {
        pressure_pa + self.ambient_pa
    }

    /// Volume of the gas \[m^3\] for a volume of the muscle \[m^3\].
    pub(crate) const fn gas_volume(&self, volume_m3: f64) -> f64 {
        volume_m3 + self.dead_volume_m3
    }
}
