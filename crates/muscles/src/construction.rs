//! How a muscle is built: pleated (fibres along the meridians) or braided (fibres in a trellis).

use crate::error::{MuscleError, check};
use crate::parameter::Parameter;
use crate::quantity::{Angle, Length};
use crate::units::Quantity;
use serde::Serialize;

/// The two families of muscle. Both balance by the same equation; they differ in the path of the fibres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Construction {
    /// Pleated muscle (PPAM): every fibre lies in a meridian plane, and the cloth between the fibres unfolds.
    Pleated(Pleated),
    /// Braided muscle (McKibben): two families of fibres cross at a braid angle.
    Braided(Braided),
}

/// The family alone, as a muscle file names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// `kind = "pleated"`.
    Pleated,
    /// `kind = "braided"`.
    Braided,
}

impl Kind {
    /// Whether it is the pleated muscle.
    #[must_use]
    pub const fn is_pleated(self) -> bool {
        matches!(self, Self::Pleated)
    }

    /// The word in a muscle file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pleated => "pleated",
            Self::Braided => "braided",
        }
    }
}

impl Construction {
    /// The family.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        match self {
            Self::Pleated(_) => Kind::Pleated,
            Self::Braided(_) => Kind::Braided,
        }
    }
}

/// How many fibres carry a pleated muscle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FibreCount {
    /// n >= 3 fibres with flat cloth between them: cross-section (n/2) sin(2 pi/n) r^2.
    Discrete(u32),
    /// A membrane of fibres all round, the limit n -> infinity: cross-section pi r^2 (first-generation PPAM).
    Continuous,
}

/// A pleated muscle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Pleated {
    pub(crate) radius: Length,
    pub(crate) fibres: FibreCount,
}

impl Pleated {
    /// A pleated muscle with fibre radius R at the end fittings.
    ///
    /// # Errors
    /// If the radius is not finite and > 0 or there are fewer than 3 fibres.
    pub fn new(radius: Length, fibres: FibreCount) -> Result<Self, MuscleError> {
        Parameter::Radius.check(radius.si())?;
        if let FibreCount::Discrete(count) = fibres {
            check::count(count)?;
        }
        Ok(Self { radius, fibres })
    }

    /// Fibre radius R at the end fittings.
    #[must_use]
    pub fn radius(&self) -> Length {
        self.radius
    }

    /// Number n of fibres.
    #[must_use]
    pub fn fibres(&self) -> FibreCount {
        self.fibres
    }
}

/// How the braid is held at its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ends {
    /// Clamped to the fittings: the exact shape of the net, which tapers towards them.
    Clamped,
    /// A cylinder up to the fittings: the textbook formula.
    Cylinder,
}

impl Ends {
    /// The word in a muscle file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Clamped => "clamped",
            Self::Cylinder => "cylinder",
        }
    }
}

/// A braided muscle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Braided {
    pub(crate) radius: Length,
    pub(crate) braid_angle: Angle,
    pub(crate) fibres: Option<u32>,
    pub(crate) ends: Ends,
    pub(crate) wall: Option<Length>,
}

impl Braided {
    /// A braid of radius r0 and angle alpha0 between fibre and axis at rest, clamped to fittings of the same
    /// radius.
    ///
    /// # Errors
    /// If the radius is not finite and > 0, or the angle is not between 0 and 90 degrees, both excluded.
    pub fn new(radius: Length, braid_angle: Angle) -> Result<Self, MuscleError> {
        Parameter::Radius.check(radius.si())?;
        Parameter::BraidAngle.check(braid_angle.si())?;
        Ok(Self { radius, braid_angle, fibres: None, ends: Ends::Clamped, wall: None })
    }

    /// The same braid with a known number of fibres, both families together.
    ///
    /// # Errors
    /// If there are fewer than 3 fibres.
    pub fn with_fibres(self, fibres: u32) -> Result<Self, MuscleError> {
        check::count(fibres)?;
        Ok(Self { fibres: Some(fibres), ..self })
    }

    /// The same braid with other ends.
    #[must_use]
    pub fn with_ends(self, ends: Ends) -> Self {
        Self { ends, ..self }
    }

    /// The same braid with a wall of known thickness.
    ///
    /// # Errors
    /// If the thickness is not finite and > 0.
    pub fn with_wall(self, wall: Length) -> Result<Self, MuscleError> {
        Parameter::Wall.check(wall.si())?;
        Ok(Self { wall: Some(wall), ..self })
    }

    /// Braid radius r0 at rest.
    #[must_use]
    pub fn radius(&self) -> Length {
        self.radius
    }

    /// Angle alpha0 between fibre and axis at rest.
    #[must_use]
    pub fn braid_angle(&self) -> Angle {
        self.braid_angle
    }

    /// Number of fibres, both families together, if known.
    #[must_use]
    pub fn fibres(&self) -> Option<u32> {
        self.fibres
    }

    /// How the ends are held.
    #[must_use]
    pub fn ends(&self) -> Ends {
        self.ends
    }

    /// Thickness of the wall at rest, if known.
    #[must_use]
    pub fn wall(&self) -> Option<Length> {
        self.wall
    }

    /// Length b = l0 / cos(alpha0) of one fibre of a braid of length l0.
    #[must_use]
    pub fn fibre_length(&self, length: Length) -> Length {
        Length::from_si(length.si() / self.braid_angle.to_rad().cos())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nonsense_is_refused_with_its_number() {
        let braided = Braided::new(Length::mm(10.0), Angle::deg(25.0)).unwrap();
        for (error, part) in [
            (Pleated::new(Length::mm(-16.0), FibreCount::Continuous).err(), "-0.016 m"),
            (Pleated::new(Length::m(f64::NAN), FibreCount::Continuous).err(), "NaN"),
            (Pleated::new(Length::mm(16.0), FibreCount::Discrete(2)).err(), "says 2"),
            (Braided::new(Length::mm(10.0), Angle::deg(90.0)).err(), "90"),
            (Braided::new(Length::mm(10.0), Angle::deg(0.0)).err(), "0 deg"),
            (Braided::new(Length::mm(10.0), Angle::rad(f64::NAN)).err(), "NaN"),
            (Braided::new(Length::mm(0.0), Angle::deg(25.0)).err(), "`radius`"),
            (braided.with_fibres(1).err(), "says 1"),
            (braided.with_wall(Length::mm(0.0)).err(), "`wall`"),
        ] {
            let message = error.map(|e| e.to_string()).unwrap_or_default();
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
    }

    #[test]
    fn a_fibre_is_longer_than_the_muscle() {
        // DMSP-20-250: 275.85 mm measured.
        let braid = Braided::new(Length::mm(10.725), Angle::deg(25.0)).unwrap();
        assert!((braid.fibre_length(Length::mm(250.0)).to_mm() - 275.85).abs() < 0.01);
    }
}
