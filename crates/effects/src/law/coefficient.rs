//! Coefficients of force laws as printed, with the data that a fit needs: start, scale, bounds and linearity.

use super::point::LawGeometry;
use crate::Evidence;
use serde::Serialize;
use std::f64::consts::TAU;

/// A measure that a law takes from the muscle unless a coefficient replaces it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// Braid radius r0 \[mm\].
    Radius,
    /// Braid angle alpha0 at rest \[deg\].
    BraidAngle,
    /// Fibre length b = l0/cos(alpha0) \[mm\].
    FibreLength,
    /// Turns of a fibre N = b sin(alpha0)/(2 pi r0).
    Turns,
}

impl Measure {
    /// The value for a muscle, in the unit of the measure.
    #[must_use]
    pub fn of(self, geometry: &LawGeometry) -> f64 {
        let fibre_length = geometry.length / geometry.braid_angle.cos();
        match self {
            Self::Radius => geometry.radius * 1e3,
            Self::BraidAngle => geometry.braid_angle.to_degrees(),
            Self::FibreLength => fibre_length * 1e3,
            Self::Turns => fibre_length * geometry.braid_angle.sin() / (TAU * geometry.radius),
        }
    }
}

/// The role of a coefficient in a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// It is fitted, starting from its typical value or a table.
    Fitted,
    /// It is measured on the muscle. A fit changes it only on request.
    Measured(Measure),
    /// It stays at its typical value. The other coefficients have the same effect, so that a fit of all has
    /// no unique solution.
    Redundant,
}

/// One coefficient of a law.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Coefficient {
    /// The symbol, such as `a`.
    pub name: &'static str,
    /// The unit of its values, as the paper means it, such as "N/bar"; "1" for a pure number.
    pub unit: &'static str,
    /// A short description.
    pub meaning: &'static str,
    /// A usual value, from which a fit starts.
    pub typical: f64,
    /// A change that moves the force by tens of newtons somewhere at 3 bar. It is never 0.
    pub scale: f64,
    /// The lowest and highest meaningful value; infinite if unknown.
    pub bounds: [f64; 2],
    /// Whether the coefficient is linear: the force is linear in all marked coefficients together, with the
    /// others held.
    pub linear: bool,
    /// The role in a fit.
    pub role: Role,
}

impl Coefficient {
    /// A coefficient in which the force is linear.
    pub(super) const fn linear(
        name: &'static str,
        unit: &'static str,
        meaning: &'static str,
        typical: f64,
        scale: f64,
    ) -> Self {
        let bounds = [f64::NEG_INFINITY, f64::INFINITY];
        Self { name, unit, meaning, typical, scale, bounds, linear: true, role: Role::Fitted }
    }

    /// A coefficient in which the force is not linear.
    pub(super) const fn nonlinear(
        name: &'static str,
        unit: &'static str,
        meaning: &'static str,
        typical: f64,
        scale: f64,
    ) -> Self {
        Self { linear: false, ..Self::linear(name, unit, meaning, typical, scale) }
    }

    /// Sets bounds.
    pub(super) const fn within(self, lowest: f64, highest: f64) -> Self {
        Self { bounds: [lowest, highest], ..self }
    }

    /// Marks the coefficient as measured on the muscle.
    pub(super) const fn measured(self, measure: Measure) -> Self {
        Self { role: Role::Measured(measure), ..self }
    }

    /// Marks the coefficient as redundant.
    pub(super) const fn redundant(self) -> Self {
        Self { role: Role::Redundant, ..self }
    }

    /// The start of a fit without a table: the muscle's own measure, or else the typical value.
    #[must_use]
    pub fn start(&self, geometry: &LawGeometry) -> f64 {
        match self.role {
            Role::Measured(measure) => measure.of(geometry),
            Role::Fitted | Role::Redundant => self.typical,
        }
    }
}

/// A set of coefficients for one muscle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CoefficientTable {
    /// The name, such as "DMSP-20-200N".
    pub name: &'static str,
    /// The type of muscle, as in "DMSP-20-200". None if the table is for one state of it and has to be asked
    /// for by name.
    pub muscle: Option<&'static str>,
    /// Paper and table.
    pub source: &'static str,
    /// [`Evidence::Paper`] if the numbers are printed, [`Evidence::Derived`] if they are evaluated or fitted
    /// from printed functions.
    pub evidence: Evidence,
    /// Values in the order and units of the coefficients. Trailing measures of the muscle may be left out.
    pub values: &'static [f64],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_of_a_braid() {
        // S5 Table 2: b = 275.85 mm, N = 1.73, of l0 = 250 mm, alpha0 = 25 deg and r0 = 10.725 mm.
        let braid_angle = 25_f64.to_radians();
        let braid = LawGeometry { length: 0.25, radius: 0.010_725, braid_angle, fibres: None };
        assert!((Measure::FibreLength.of(&braid) - 275.85).abs() < 0.01);
        assert!((Measure::Turns.of(&braid) - 1.73).abs() < 1e-4);
        assert!((Measure::Radius.of(&braid) - 10.725).abs() < 1e-12);
        assert!((Measure::BraidAngle.of(&braid) - 25.0).abs() < 1e-12);
    }

    #[test]
    fn a_measured_coefficient_starts_at_the_muscle() {
        let geometry = LawGeometry { length: 0.25, radius: 0.012, braid_angle: 0.4, fibres: None };
        let radius = Coefficient::nonlinear("r0", "mm", "braid radius", 10.0, 0.3);
        assert!((radius.start(&geometry) - 10.0).abs() < 1e-12);
        assert!((radius.redundant().start(&geometry) - 10.0).abs() < 1e-12);
        assert!((radius.measured(Measure::Radius).start(&geometry) - 12.0).abs() < 1e-12);
    }
}
