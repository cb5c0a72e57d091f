//! The winding around a muscle: zone, turns, section, layer; and the reference in which it has that section.

use bulge_fibre::Approach;
use bulge_muscles::{Pressure, Quantity, Ratio};
use serde::Serialize;
use std::f64::consts::PI;

use super::SensingError;
use crate::question::is;

/// Resistivity of eutectic gallium-indium \[ohm m\] (M. Dickey et al., *Advanced Functional Materials* 18 (2008) 1097).
pub const EGAIN_RESISTIVITY_OHM_M: f64 = 29.4e-8;

/// Smallest width of a zone, as a fraction of the fibre length.
const NARROWEST: f64 = 1e-6;
/// Most turns.
const MOST_TURNS: f64 = 1e6;
/// Most points of a meridian.
const MOST_POINTS: usize = 20_001;
/// Fewest points of a meridian: six are needed for one polynomial, and their number is odd.
pub(super) const FEWEST_POINTS: usize = 7;

/// How the distance t between channel and fibres changes with the shape of the muscle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Layer {
    /// It stays as in the reference (a layer of fixed thickness, such as one of many stiff rings).
    Kept,
    /// The elastomer below the channel is incompressible and bonded to the fibres: its volume per fibre
    /// length is constant,
    ///
    /// ```text
    /// sigma (r t + (cos(psi) + r kappa) t^2/2 + kappa cos(psi) t^3/3) = the same in the reference
    /// ```
    /// so that a thin layer thins as 1/(stretch of its area).
    #[default]
    Thinning,
}

/// A helical channel between two positions along the fibre.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Winding {
    /// Start, as a fraction of the unstretched fibre length from the left fitting, 0 ..= 1.
    pub start: f64,
    /// End, beyond the start, up to 1.
    pub end: f64,
    /// Turns N about the axis, 0 or more; not necessarily an integer.
    pub turns: f64,
    /// Section A0 of the channel in the reference \[m^2\].
    pub section_m2: f64,
    /// Distance t of its centre from the fibres in the reference, outwards along the normal \[m\], 0 or more.
    pub offset_m: f64,
    /// How that distance changes.
    pub layer: Layer,
    /// Resistivity of the liquid \[ohm m\], such as [`EGAIN_RESISTIVITY_OHM_M`].
    pub resistivity_ohm_m: f64,
}

impl Winding {
    /// The same channel with the same number of turns, in a zone of given centre and width, both fractions of
    /// the fibre length.
    #[must_use]
    pub fn placed(self, centre: f64, width: f64) -> Self {
        // Rounding must not keep a zone from reaching a fitting exactly.
        let [start, end] = [centre - 0.5 * width, centre + 0.5 * width];
        let snap = |s: f64| if s.abs() < 1e-12 { 0.0 } else { s };
        Self { start: snap(start), end: 1.0 - snap(1.0 - end), ..self }
    }

    /// Width of the zone, as a fraction of the fibre length.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.end - self.start
    }

    /// Diameter of a round channel of this section \[m\].
    #[must_use]
    pub fn diameter_m(&self) -> f64 {
        (4.0 * self.section_m2 / PI).sqrt()
    }

    /// Checks every number for a muscle of this rest radius \[m\].
    pub(super) fn check(&self, radius_m: f64) -> Result<(), SensingError> {
        let inside = self.start >= 0.0 && self.end <= 1.0 && self.width() >= NARROWEST;
        if !inside {
            let Self { start, end, .. } = self;
            return Err(SensingError::Input(format!(
                "the winding zone from {} to {} of the fibre length is none: it must lie in 0 % to 100 %, with its end at least 0.0001 % beyond its start",
                Ratio::from_si(*start),
                Ratio::from_si(*end)
            )));
        }
        number("number of turns", self.turns, "from 0 to 1e6", |n| (0.0..=MOST_TURNS).contains(&n))?;
        number("offset of the channel [m]", self.offset_m, "from 0 to the radius of the muscle", |t| {
            (0.0..=radius_m).contains(&t)
        })?;
        number("resistivity [ohm m]", self.resistivity_ohm_m, "a finite number greater than 0", is_positive)?;
        let diameter = (4.0 * self.section_m2.abs() / PI).sqrt().copysign(self.section_m2);
        let needs = "greater than 0, and at most the radius of the muscle";
        number("diameter of the channel [m]", diameter, needs, |d| is_positive(d) && d <= radius_m)
    }

    /// Checks that the turns fit into a zone with this meridian \[m\].
    pub(super) fn check_pitch(&self, meridian_m: f64) -> Result<(), SensingError> {
        let (pitch_m, diameter_m) = (meridian_m / self.turns, self.diameter_m());
        if pitch_m < diameter_m {
            return Err(SensingError::Input(format!(
                "the turns of the channel are {:.4} mm apart, but it is {:.4} mm wide: take fewer turns, a wider zone or a smaller section",
                1e3 * pitch_m,
                1e3 * diameter_m
            )));
        }
        Ok(())
    }
}

/// The state in which the channel has the section A0 everywhere and zero strain.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Reference {
    /// Unpressurised: a cylinder of the muscle's radius with the fibres at their rest angle.
    #[default]
    Rest,
    /// In equilibrium at a pressure and a contraction.
    At {
        /// Gauge pressure, > 0.
        pressure: Pressure,
        /// Contraction (l0 - l)/l0.
        contraction: f64,
    },
}

/// Method, resolution, and strain limit of the elastomer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Method of the equilibrium.
    pub approach: Approach,
    /// Points of the meridian, 7 to 20001 (made odd). Long braids, whose ends are short relative to their
    /// length, need more.
    pub points: usize,
    /// Largest strain along the channel that the elastomer can bear, > 0; infinite for no limit.
    pub max_strain: f64,
}

impl Default for Options {
    /// 201 points; a strain of 250 %, up to which such channels in silicone rubber have worked (Y.-L. Park,
    /// B.-R. Chen, R. J. Wood, *IEEE Sensors Journal* 12 (2012) 2711).
    fn default() -> Self {
        Self { approach: Approach::Auto, points: 201, max_strain: 2.5 }
    }
}

impl Options {
    pub(super) fn check(&self) -> Result<(), SensingError> {
        let points = self.points;
        number("number of meridian points", points as f64, "from 7 to 20001", |_| {
            (FEWEST_POINTS..=MOST_POINTS).contains(&points)
        })?;
        number("strain that the elastomer bears [%]", self.max_strain, "greater than 0", |strain| {
            strain > 0.0
        })
    }
}

/// A finite number greater than 0.
pub(super) fn is_positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

/// An error if a number violates its condition; a comparison with NaN is false.
pub(super) fn number(
    what: &str,
    value: f64,
    needs: &str,
    is_good: impl Fn(f64) -> bool,
) -> Result<(), SensingError> {
    if is_good(value) {
        return Ok(());
    }
    Err(SensingError::Input(format!("the {}: it must be {needs}", is(what, value))))
}
