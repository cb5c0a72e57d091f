//! The materials of a muscle: fibres that stretch, a rubber bladder, cloth that stops unfolding.

use crate::error::{MuscleError, check};
use crate::quantity::{Area, Force, Length, LineStiffness, Pressure};
use serde::Serialize;

/// Fibres that stretch by T / EA under a tension T.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fibre {
    stiffness: Force,
    section: Option<Area>,
}

impl Fibre {
    /// Fibres of stiffness EA, per fibre; for a continuous membrane, of the whole circumference.
    ///
    /// # Errors
    /// If the stiffness is not finite and > 0.
    pub fn new(stiffness: Force) -> Result<Self, MuscleError> {
        check::positive("fibre.stiffness", stiffness)?;
        Ok(Self { stiffness, section: None })
    }

    /// The same fibres with a known cross-section, which turns tension into stress.
    ///
    /// # Errors
    /// If the section is not finite and > 0.
    pub fn with_section(self, section: Area) -> Result<Self, MuscleError> {
        check::positive("fibre.section", section)?;
        Ok(Self { section: Some(section), ..self })
    }

    /// Stiffness EA: force per strain.
    #[must_use]
    pub fn stiffness(&self) -> Force {
        self.stiffness
    }

    /// Cross-section, if known.
    #[must_use]
    pub fn section(&self) -> Option<Area> {
        self.section
    }

    pub(crate) fn with_stiffness(self, stiffness: Force) -> Result<Self, MuscleError> {
        Ok(Self { section: self.section, ..Self::new(stiffness)? })
    }
}

/// A rubber tube inside a braid (effect `bladder-elasticity`): Mooney-Rivlin, W = c10 (I1 - 3) + c01
/// (I2 - 3).
///
/// With c01 = 0 it is a neo-Hookean rubber of shear modulus 2 c10.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bladder {
    c10: Pressure,
    c01: Pressure,
    wall: Length,
}

impl Bladder {
    /// A bladder with its wall thickness at rest.
    ///
    /// # Errors
    /// If a constant is negative or not finite, both are 0, or the wall is not finite and > 0.
    pub fn new(c10: Pressure, c01: Pressure, wall: Length) -> Result<Self, MuscleError> {
        check::not_negative("effects.bladder-elasticity.c10", c10)?;
        check::not_negative("effects.bladder-elasticity.c01", c01)?;
        if c10.to_pa() + c01.to_pa() <= 0.0 {
            return Err(MuscleError::NoElasticity { c10: c10.to_pa(), c01: c01.to_pa() });
        }
        check::positive("effects.bladder-elasticity.wall", wall)?;
        Ok(Self { c10, c01, wall })
    }

    /// First Mooney-Rivlin constant.
    #[must_use]
    pub fn c10(&self) -> Pressure {
        self.c10
    }

    /// Second Mooney-Rivlin constant.
    #[must_use]
    pub fn c01(&self) -> Pressure {
        self.c01
    }

    /// Wall thickness at rest.
    #[must_use]
    pub fn wall(&self) -> Length {
        self.wall
    }
}

/// Cloth that can unfold only so far (effect `limited-unfolding`): beyond the unfolded radius it stretches.
///
/// ```text
/// u(r) = K (2 pi (r - r_u))^2 / (2 * 2 pi r_u)   for r > r_u, else 0
/// ```
/// u (N): hoop energy per unit meridian length; K (N/m): hoop stiffness E t of the cloth; `r_u` (m): unfolded
/// radius.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Unfolding {
    hoop_stiffness: LineStiffness,
    unfolded_radius: Length,
}

impl Unfolding {
    /// Cloth of hoop stiffness K = E t that is taut beyond the unfolded radius.
    ///
    /// # Errors
    /// If either is not finite and > 0.
    pub fn new(hoop_stiffness: LineStiffness, unfolded_radius: Length) -> Result<Self, MuscleError> {
        check::positive("effects.limited-unfolding.hoop_stiffness", hoop_stiffness)?;
        check::positive("effects.limited-unfolding.unfolded_radius", unfolded_radius)?;
        Ok(Self { hoop_stiffness, unfolded_radius })
    }

    /// Hoop stiffness K = E t of the cloth.
    #[must_use]
    pub fn hoop_stiffness(&self) -> LineStiffness {
        self.hoop_stiffness
    }

    /// Radius at which the cloth is fully unfolded.
    #[must_use]
    pub fn unfolded_radius(&self) -> Length {
        self.unfolded_radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nonsense_is_refused_with_its_number() {
        let fibre = Fibre::new(Force::kn(12.0)).unwrap();
        let (modulus, none, wall) = (Pressure::mpa(0.2), Pressure::pa(0.0), Length::mm(2.0));
        let (stiffness, radius) = (LineStiffness::kn_per_m(81.0), Length::mm(52.6));
        for (error, part) in [
            (Fibre::new(Force::n(0.0)).err(), "`fibre.stiffness` is 0 N"),
            (Fibre::new(Force::n(f64::NAN)).err(), "NaN"),
            (fibre.with_section(Area::mm2(-1.0)).err(), "-0.000001 m^2"),
            (Bladder::new(Pressure::pa(-1.0), modulus, wall).err(), "c10` is -1 Pa"),
            (Bladder::new(modulus, Pressure::pa(f64::NAN), wall).err(), "c01` is NaN"),
            (Bladder::new(none, none, wall).err(), "c10 = 0 Pa and c01 = 0 Pa"),
            (Bladder::new(modulus, none, Length::m(0.0)).err(), "wall` is 0 m"),
            (Unfolding::new(LineStiffness::n_per_m(-1.0), radius).err(), "-1 N/m"),
            (Unfolding::new(stiffness, Length::m(f64::INFINITY)).err(), "inf m"),
        ] {
            let message = error.map(|e| e.to_string()).unwrap_or_default();
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
        assert!(Bladder::new(none, modulus, wall).is_ok());
    }
}
