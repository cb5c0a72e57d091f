//! The point at which a force law is evaluated, and the few measures of the muscle that it may use.

use bulge_muscles::{Muscle, Parameter, Quantity};
use bulge_numerics::Real;
use serde::Serialize;

/// The state of a muscle for a force law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawPoint<D> {
    /// Gauge pressure p \[Pa\].
    pub pressure: D,
    /// Contraction kappa = (l0 - l)/l0, a fraction.
    pub contraction: D,
    /// +1 while the muscle shortens, -1 while it lengthens, 0 for the mean of both.
    ///
    /// Values in between blend the branches linearly. Only [`directional`](super::Law::directional) laws use
    /// it.
    pub direction: f64,
}

impl<D: Real> LawPoint<D> {
    /// A point on the mean of both branches.
    pub const fn mean(pressure: D, contraction: D) -> Self {
        Self { pressure, contraction, direction: 0.0 }
    }

    /// Pressure \[bar\].
    pub(super) fn bar(self) -> D {
        self.pressure / 1e5
    }

    /// Contraction \[%\].
    pub(super) fn percent(self) -> D {
        self.contraction * 100.0
    }
}

/// Measures of a muscle at rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LawGeometry {
    /// Length l0 \[m\].
    pub length: f64,
    /// Radius \[m\]: of the braid (r0), or of the fibres at the fittings of a pleated muscle (R).
    pub radius: f64,
    /// Braid angle alpha0 between fibre and axis \[rad\]; 0 for a pleated muscle.
    pub braid_angle: f64,
    /// Number of fibres, if it is known.
    pub fibres: Option<u32>,
}

impl From<&Muscle> for LawGeometry {
    fn from(muscle: &Muscle) -> Self {
        Self {
            length: muscle.length().si(),
            radius: muscle.radius().si(),
            braid_angle: muscle.get(Parameter::BraidAngle).unwrap_or(0.0),
            fibres: muscle.fibres(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_muscles::preset;

    #[test]
    fn a_muscle_gives_its_measures() {
        let braid = LawGeometry::from(&preset("dmsp-20-250").unwrap());
        assert_eq!((braid.length, braid.radius, braid.fibres), (0.25, 0.010_725, None));
        assert!((braid.braid_angle - 25_f64.to_radians()).abs() < 1e-15);
        let pleated = LawGeometry::from(&preset("ppam-2-r16").unwrap());
        assert_eq!(pleated, LawGeometry { length: 0.11, radius: 0.016, braid_angle: 0.0, fibres: Some(40) });
    }

    #[test]
    fn the_units_of_the_papers() {
        let point = LawPoint::mean(3e5, 0.125);
        assert_eq!((point.bar(), point.percent(), point.direction), (3.0, 12.5, 0.0));
    }
}
