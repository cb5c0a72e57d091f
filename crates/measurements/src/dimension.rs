//! Temperature, whose scales have zero points, and the scale from a column's unit to SI.

use bulge_muscles::Dimension;
use bulge_muscles::units::{Quantity, UnitError, Wanted, to_si};

/// A temperature in kelvin. The factors are those of differences; the zero points are in [`Scale`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Temperature(f64);

impl Quantity for Temperature {
    const NAME: &'static str = "temperature";
    const DIMENSION: Dimension = Dimension::TEMPERATURE;
    const EXAMPLE: &'static str = "20 degC";
    const SHOWN: (&'static str, f64) = ("degC", 1.0);
    const UNITS: &'static [(&'static str, f64)] = &[("K", 1.0), ("C", 1.0), ("degC", 1.0)];

    fn from_si(value: f64) -> Self {
        Self(value)
    }

    fn si(self) -> f64 {
        self.0
    }
}

/// 0 degC in kelvin.
const CELSIUS_ZERO: f64 = 273.15;

/// Standard atmosphere \[Pa\].
const ATMOSPHERE: f64 = 101_325.0;

/// Converts numbers in a unit to SI: `si = number * factor + zero`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    factor: f64,
    zero: f64,
}

impl Scale {
    /// Pure numbers and SI units.
    pub(crate) const SI: Self = Self { factor: 1.0, zero: 0.0 };

    /// Degrees of Fahrenheit: 32 degF are 0 degC.
    pub(crate) const FAHRENHEIT: Self = Self { factor: 5.0 / 9.0, zero: CELSIUS_ZERO - 32.0 * 5.0 / 9.0 };

    /// A unit that equals `factor` SI units.
    pub(crate) fn by(factor: f64) -> Self {
        Self { factor, ..Self::SI }
    }

    /// The scale with the opposite sign, for a sensor that counts the other way.
    pub(crate) fn reversed(self) -> Self {
        Self { factor: -self.factor, ..self }
    }

    /// The scale of absolute pressures, as gauge pressures above the standard atmosphere.
    pub(crate) fn above_air(self) -> Self {
        Self { zero: self.zero - ATMOSPHERE, ..self }
    }

    /// The scale of a unit.
    pub(crate) fn of(wanted: &'static Wanted, unit: &str) -> Result<Self, UnitError> {
        let is_celsius = wanted.dimension == Some(Dimension::TEMPERATURE) && unit.trim_end().ends_with('C');
        Ok(Self { zero: if is_celsius { CELSIUS_ZERO } else { 0.0 }, ..Self::by(wanted.factor(unit)?) })
    }

    /// A number in SI.
    pub(crate) fn si(self, number: f64) -> f64 {
        // A reversed one as its mirror, so that 5 um is 5e-6 there too.
        to_si(number, self.factor.abs()) * self.factor.signum() + self.zero
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_muscles::{Length, Pressure, Ratio, Time};

    #[test]
    fn numbers_become_si() {
        let of_time = |unit, number| Scale::of(Wanted::of::<Time>(), unit).map(|scale| scale.si(number));
        assert_eq!(of_time("s", 2.5), Ok(2.5));
        assert_eq!(of_time("ms", 250.0), Ok(0.25));
        assert_eq!(of_time("min", 1.5), Ok(90.0));
        assert_eq!(of_time("h", 0.5), Ok(1800.0));
        let kelvin =
            |unit, number| Scale::of(Wanted::of::<Temperature>(), unit).map(|scale| scale.si(number));
        assert_eq!(kelvin("K", 293.0), Ok(293.0));
        for unit in ["C", "degC", "\u{b0}C", " degC "] {
            assert_eq!(kelvin(unit, 20.0), Ok(293.15), "{unit}");
        }
        assert!(kelvin("degF", 68.0).unwrap_err().to_string().contains("degC"));
        assert!(of_time("sec", 1.0).unwrap_err().to_string().contains("ms"));
    }

    #[test]
    fn decimal_units_are_the_literal() {
        assert_eq!(Scale::of(Wanted::of::<Length>(), "mm").map(|s| s.si(296.0)), Ok(0.296));
        assert_eq!(Scale::of(Wanted::of::<Length>(), "um").map(|s| s.si(5.0)), Ok(5e-6));
        assert_eq!(Scale::of(Wanted::of::<Ratio>(), "%").map(|s| s.si(7.0)), Ok(0.07));
        assert_eq!(Scale::of(Wanted::of::<Pressure>(), "kPa").map(|s| s.si(35.0)), Ok(35_000.0));
        assert_eq!(Scale::SI.si(0.1).to_bits(), 0.1_f64.to_bits());
    }
}
