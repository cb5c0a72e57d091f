//! A muscle under pressure as a dimensionless fibre net. Quantities with units become numbers here.
//!
//! Lengths are divided by the reference radius R (pleated: fibre radius at the fittings; braided: braid
//! radius at rest), forces by p R^2.

use bulge_muscles::{Ends, Pressure, Quantity};
use std::sync::Arc;

use crate::FibreError;
use crate::net::Net;
use crate::parts::Parts;
use crate::quadrature;

/// Range of slenderness l0/R of pleated muscles.
pub const PLEATED_SLENDERNESS: [f64; 2] = [0.5, 1000.0];
/// Range of l0/r0 of braids with clamped ends.
pub const BRAIDED_SLENDERNESS: [f64; 2] = [1.0, 100.0];
/// Range of the braid angle at rest of braids with clamped ends, degrees.
pub const BRAID_ANGLE: [f64; 2] = [5.0, 50.0];

/// Largest radius of the fittings over r0/sin(alpha0), the radius at which the fibres of a braid lie along
/// the circumference.
pub const WIDEST_FITTING: f64 = 0.995;

/// Largest fibre strain for which a muscle longer than at rest is computed. Nylon breaks at 0.15 to 0.3,
/// polyester at 0.15, aramid at 0.03 (W. E. Morton and J. W. S. Hearle, *Physical Properties of Textile
/// Fibres*, Woodhead 2008).
pub const MOST_STRAIN: f64 = 0.3;

/// Range of the number of fibres with lobes between them. With more fibres, rounding is larger than the
/// errors that the integration keeps to.
pub const LOBED_FIBRES: [f64; 2] = [3.0, 300.0];
/// Largest n l0/r* of n fibres with lobes between them that can open to the radius r*. The middle of a longer
/// muscle differs from a cylinder by exp(-0.4 n l0/r*), which can't be told from 0.
pub const LOBED_LENGTH: f64 = 600.0;

/// A muscle at a gauge pressure, ready to be solved.
#[derive(Debug, Clone)]
pub struct Problem {
    pub(crate) parts: Arc<Parts>,
    /// Gauge pressure \[Pa\].
    pub(crate) pressure: f64,
    pub(crate) net: Net<f64>,
}

impl Problem {
    /// Checks the ranges of a muscle (`&Muscle`), or of parts that effects have changed, and makes the
    /// problem dimensionless.
    ///
    /// # Errors
    /// [`FibreError::PressureNotPositive`], [`FibreError::NotFinite`], [`FibreError::OutOfRange`] outside
    /// [`PLEATED_SLENDERNESS`], [`BRAIDED_SLENDERNESS`], [`BRAID_ANGLE`], [`LOBED_FIBRES`] and
    /// [`LOBED_LENGTH`], [`FibreError::ClothTooNarrow`] or [`FibreError::FittingTooWide`].
    pub fn new(parts: impl Into<Parts>, pressure: Pressure) -> Result<Self, FibreError> {
        let parts = parts.into();
        parts.check_ranges()?;
        Self::checked(Arc::new(parts), pressure)
    }

    /// The same muscle at another gauge pressure; its parts are shared, not copied.
    ///
    /// # Errors
    /// [`FibreError::PressureNotPositive`] or [`FibreError::NotFinite`].
    pub fn at_pressure(&self, pressure: Pressure) -> Result<Self, FibreError> {
        Self::checked(Arc::clone(&self.parts), pressure)
    }

    fn checked(parts: Arc<Parts>, pressure: Pressure) -> Result<Self, FibreError> {
        let pressure = pressure.si();
        if !pressure.is_finite() {
            return Err(FibreError::NotFinite { what: "pressure", value: pressure });
        }
        if pressure <= 0.0 {
            return Err(FibreError::PressureNotPositive { pressure_pa: pressure });
        }
        let net = parts.net(pressure);
        quadrature::prepare(&net);
        Ok(Self { parts, pressure, net })
    }

    /// The parts of the muscle.
    #[must_use]
    pub fn parts(&self) -> &Parts {
        &self.parts
    }

    /// The gauge pressure.
    #[must_use]
    pub fn pressure(&self) -> Pressure {
        Pressure::pa(self.pressure)
    }

    /// Whether shape, force/p and volume are the same at every pressure.
    #[must_use]
    pub fn is_scale_free(&self) -> bool {
        let net = &self.net;
        net.compliance == 0.0 && !net.has_wall() && net.cloth.is_none() && !self.parts.follows_pressure()
    }

    /// Whether the braid is the textbook cylinder.
    pub(crate) fn is_cylinder(&self) -> bool {
        self.parts.ends == Ends::Cylinder
    }
}
