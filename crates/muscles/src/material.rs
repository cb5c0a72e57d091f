//! The material of the fibres.

use crate::error::{MuscleError, check};
use crate::quantity::{Area, Force};
use serde::Serialize;

/// Fibres that stretch by T / EA under a tension T.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fibre {
    pub(crate) stiffness: Force,
    pub(crate) section: Option<Area>,
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nonsense_is_refused_with_its_number() {
        let fibre = Fibre::new(Force::kn(12.0)).unwrap();
        for (error, part) in [
            (Fibre::new(Force::n(0.0)).err(), "`fibre.stiffness` is 0 N"),
            (Fibre::new(Force::n(f64::NAN)).err(), "NaN"),
            (fibre.with_section(Area::mm2(-1.0)).err(), "-0.000001 m^2"),
        ] {
            let message = error.map(|e| e.to_string()).unwrap_or_default();
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
    }
}
