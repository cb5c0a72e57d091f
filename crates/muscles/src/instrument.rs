//! The accuracy of the rig: standard deviations from the data sheets of its instruments.

use crate::error::MuscleError;
use crate::muscle::Muscle;
use crate::quantity::Ratio;
use serde::Serialize;

/// The instruments of the rig. An instrument that no data sheet states is absent.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Instruments {
    /// The force sensor, in N.
    pub force: Option<Instrument>,
    /// The pressure sensor, in Pa.
    pub pressure: Option<Instrument>,
    /// The length (displacement) sensor, in m.
    pub length: Option<Instrument>,
}

/// One instrument: measured = true (1 + gain error) + zero error + noise, one standard deviation each.
///
/// A width of 0 means that none is stated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Instrument {
    noise: f64,
    zero: f64,
    gain: Ratio,
}

impl Instrument {
    /// Takes the standard deviations of noise and zero, in the SI unit of the measured quantity, and of the
    /// gain.
    ///
    /// # Errors
    /// If one is negative or not finite, or all are 0.
    pub fn new(noise: f64, zero: f64, gain: Ratio) -> Result<Self, MuscleError> {
        for (key, value) in [("noise", noise), ("zero", zero), ("gain", gain.to_one())] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(MuscleError::Negative { key, value, unit: "in SI units" });
            }
        }
        if noise + zero + gain.to_one() > 0.0 {
            Ok(Self { noise, zero, gain })
        } else {
            Err(MuscleError::NoSpread)
        }
    }

    /// Standard deviation of the noise of one reading, in SI; 0 if not stated.
    #[must_use]
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// Standard deviation of the zero, in SI; 0 if not stated.
    #[must_use]
    pub fn zero(&self) -> f64 {
        self.zero
    }

    /// Standard deviation of the gain; 0 if not stated.
    #[must_use]
    pub fn gain(&self) -> Ratio {
        self.gain
    }
}

impl Muscle {
    /// The same muscle, measured with other instruments.
    #[must_use]
    pub fn with_instruments(mut self, instruments: Instruments) -> Self {
        self.instruments = instruments;
        self
    }

    /// The instruments of the rig.
    #[must_use]
    pub fn instruments(&self) -> &Instruments {
        &self.instruments
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_instrument_has_a_spread() {
        let force = Instrument::new(4.0, 1.0, Ratio::percent(0.1)).unwrap();
        assert_eq!((force.noise(), force.zero(), force.gain()), (4.0, 1.0, Ratio::one(0.001)));
        assert_eq!(Instrument::new(0.0, 0.0, Ratio::one(0.0)), Err(MuscleError::NoSpread));
        let message = Instrument::new(-4.0, 1.0, Ratio::one(0.0)).unwrap_err().to_string();
        assert!(message.contains("`noise` is -4"), "{message}");
        assert!(Instrument::new(4.0, f64::NAN, Ratio::one(0.0)).is_err());
    }
}
