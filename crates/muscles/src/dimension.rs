//! The physical dimension of any quantity: powers of metre, kilogram, second and kelvin (angles and ratios
//! have none).

use serde::{Serialize, Serializer};
use std::fmt;

/// Powers of m, kg, s and K, kept in halves so that a square root stays exact: `sqrt(Pa)` has a dimension
/// too.
///
/// Exponents reach from -64 to 64; an operation that leaves this range gives `None`. Angles, ratios and
/// decades have no dimension ([`Dimension::NONE`]). `Display` writes the SI unit, in newtons, pascals or
/// joules where that is shorter, in a form that [`crate::units::unit`] reads back.
///
/// ```
/// use bulge_muscles::Dimension;
/// let viscosity = Dimension::PRESSURE.times(Dimension::TIME);
/// assert_eq!(viscosity.map(|dimension| dimension.to_string()), Some("Pa s".to_owned()));
/// assert_eq!(Dimension::AREA.root(), Some(Dimension::LENGTH));
/// assert_eq!(Dimension::FORCE.over(Dimension::AREA), Some(Dimension::PRESSURE));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Dimension {
    /// Twice the exponents of m, kg, s, K.
    halves: [i16; 4],
}

/// The largest magnitude of an exponent, in halves.
const LIMIT: i16 = 128;

/// Derived units in which a dimension is shown; each has kg to the power of one.
const DERIVED: [(&str, Dimension); 3] =
    [("N", Dimension::FORCE), ("Pa", Dimension::PRESSURE), ("J", Dimension::ENERGY)];

impl Dimension {
    /// A pure number.
    pub const NONE: Self = Self::whole(0, 0, 0, 0);
    /// Metre.
    pub const LENGTH: Self = Self::whole(1, 0, 0, 0);
    /// Square metre.
    pub const AREA: Self = Self::whole(2, 0, 0, 0);
    /// Cubic metre.
    pub const VOLUME: Self = Self::whole(3, 0, 0, 0);
    /// Kilogram.
    pub const MASS: Self = Self::whole(0, 1, 0, 0);
    /// Second.
    pub const TIME: Self = Self::whole(0, 0, 1, 0);
    /// One per second.
    pub const RATE: Self = Self::whole(0, 0, -1, 0);
    /// Kelvin.
    pub const TEMPERATURE: Self = Self::whole(0, 0, 0, 1);
    /// Newton = kg m/s^2.
    pub const FORCE: Self = Self::whole(1, 1, -2, 0);
    /// Pascal = kg/(m s^2).
    pub const PRESSURE: Self = Self::whole(-1, 1, -2, 0);
    /// Joule = kg m^2/s^2.
    pub const ENERGY: Self = Self::whole(2, 1, -2, 0);
    /// Newton per metre = kg/s^2.
    pub const LINE_STIFFNESS: Self = Self::whole(0, 1, -2, 0);

    /// Names in words, for messages.
    const NAMES: [(&'static str, Self); 12] = [
        ("a pure number", Self::NONE),
        ("a length", Self::LENGTH),
        ("an area", Self::AREA),
        ("a volume", Self::VOLUME),
        ("a mass", Self::MASS),
        ("a time", Self::TIME),
        ("a rate", Self::RATE),
        ("a temperature", Self::TEMPERATURE),
        ("a force", Self::FORCE),
        ("a pressure", Self::PRESSURE),
        ("an energy", Self::ENERGY),
        ("a stiffness per width", Self::LINE_STIFFNESS),
    ];

    const fn whole(metre: i16, kilogram: i16, second: i16, kelvin: i16) -> Self {
        Self { halves: [2 * metre, 2 * kilogram, 2 * second, 2 * kelvin] }
    }

    /// Whether it is a pure number.
    #[must_use]
    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    /// The exponents of m, kg, s and K.
    #[must_use]
    pub fn exponents(self) -> [f64; 4] {
        self.halves.map(|half| f64::from(half) / 2.0)
    }

    /// Dimension of a product.
    #[must_use]
    pub fn times(self, other: Self) -> Option<Self> {
        self.combined(other, 1)
    }

    /// Dimension of a quotient.
    #[must_use]
    pub fn over(self, other: Self) -> Option<Self> {
        self.combined(other, -1)
    }

    /// Dimension of a power; `None` if an exponent is no multiple of 1/2 or is beyond 64.
    #[must_use]
    pub fn power(self, exponent: f64) -> Option<Self> {
        let mut halves = [0; 4];
        for (to, from) in halves.iter_mut().zip(self.halves) {
            let half = if from == 0 { 0.0 } else { f64::from(from) * exponent };
            if half.fract() != 0.0 || half.abs() > f64::from(LIMIT) {
                return None;
            }
            #[expect(
                clippy::cast_possible_truncation,
                reason = "whole and at most 128, which was just checked"
            )]
            let whole = half as i16;
            *to = whole;
        }
        Some(Self { halves })
    }

    /// Dimension of a square root; `None` if an exponent is already an odd number of halves.
    #[must_use]
    pub fn root(self) -> Option<Self> {
        self.power(0.5)
    }

    /// Its common name in words, such as "a pressure", if it has one.
    #[must_use]
    pub fn name(self) -> Option<&'static str> {
        Self::NAMES.iter().find(|(_, dimension)| *dimension == self).map(|(name, _)| *name)
    }

    /// Its description for a message: "a pressure (Pa)", or "a quantity in N s".
    #[must_use]
    pub fn describe(self) -> String {
        match self.name() {
            Some(name) if self.is_none() => name.to_owned(),
            Some(name) => format!("{name} ({self})"),
            None => format!("a quantity in {self}"),
        }
    }

    fn combined(self, other: Self, sign: i16) -> Option<Self> {
        let mut halves = self.halves;
        for (to, from) in halves.iter_mut().zip(other.halves) {
            // Both are at most 128, so the sum fits.
            *to += sign * from;
            if to.abs() > LIMIT {
                return None;
            }
        }
        Some(Self { halves })
    }

    /// Powers (in halves) of a derived unit, kg, m, s and K.
    fn split(self, symbol: &'static str, power: i16) -> [(&'static str, i16); 5] {
        let [metre, kilogram, second, kelvin] = self.halves;
        [(symbol, power), ("kg", kilogram), ("m", metre), ("s", second), ("K", kelvin)]
    }

    /// The shortest way of writing it, with the smallest sum of exponents. Newtons come before the others.
    /// Base units are used only if they are shorter by more than one power (a damping is N s/m, not kg/s).
    fn shortest(self) -> [(&'static str, i16); 5] {
        let length = |factors: &[(&str, i16); 5]| factors.iter().map(|(_, half)| half.abs()).sum::<i16>();
        let [_, power, second, _] = self.halves;
        let base = self.split("", 0);
        let mut best = base;
        let mut least = length(&base) + if power != 0 && second != 0 { 3 } else { 0 };
        for (symbol, unit) in DERIVED {
            let rest = unit.power(f64::from(power) / 2.0).and_then(|derived| self.over(derived));
            let Some(other) = rest.map(|rest| rest.split(symbol, power)) else { continue };
            // Joules and metres together would be newtons.
            let is_clear = symbol != "J" || other[2].1 == 0;
            if is_clear && length(&other) < least {
                least = length(&other);
                best = other;
            }
        }
        best
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let factors = self.shortest();
        let side = |sign: i16| {
            let powers = factors.iter().filter(|(_, half)| half.signum() == sign);
            powers.map(|(symbol, half)| power_text(symbol, half.abs())).collect::<Vec<_>>()
        };
        let (above, below) = (side(1), side(-1));
        let numerator = if above.is_empty() { "1".to_owned() } else { above.join(" ") };
        match below.as_slice() {
            [] => f.pad(&numerator),
            [one] => f.pad(&format!("{numerator}/{one}")),
            more => f.pad(&format!("{numerator}/({})", more.join(" "))),
        }
    }
}

/// `m`, `m^2`, `m^1.5`.
fn power_text(symbol: &str, halves: i16) -> String {
    if halves == 2 { symbol.to_owned() } else { format!("{symbol}^{}", f64::from(halves) / 2.0) }
}

impl Serialize for Dimension {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::Dimension as D;
    use super::*;
    use crate::units;

    #[test]
    fn shown_as_people_write_it() {
        let product = |list: &[(Dimension, f64)]| {
            list.iter().fold(Dimension::NONE, |all, (dimension, power)| {
                all.times(dimension.power(*power).unwrap()).unwrap()
            })
        };
        for (dimension, text) in [
            (D::NONE, "1"),
            (product(&[(D::FORCE, 1.0), (D::TIME, 1.0), (D::LENGTH, -1.0)]), "N s/m"),
            (D::MASS, "kg"),
            (D::FORCE, "N"),
            (D::PRESSURE, "Pa"),
            (D::AREA, "m^2"),
            (D::RATE, "1/s"),
            (D::ENERGY, "J"),
            (D::LINE_STIFFNESS, "N/m"),
            (D::TEMPERATURE.power(-1.0).unwrap(), "1/K"),
            (product(&[(D::FORCE, 1.0), (D::TIME, 1.0)]), "N s"),
            (product(&[(D::PRESSURE, 1.0), (D::TIME, 1.0)]), "Pa s"),
            (product(&[(D::FORCE, 1.0), (D::TIME, 1.0), (D::PRESSURE, -1.0)]), "m^2 s"),
            (product(&[(D::LENGTH, 1.0), (D::TIME, -2.0)]), "m/s^2"),
            (product(&[(D::MASS, 1.0), (D::LENGTH, -3.0)]), "kg/m^3"),
            (product(&[(D::FORCE, 1.0), (D::LENGTH, -1.0), (D::TEMPERATURE, -1.0)]), "N/(m K)"),
            (product(&[(D::PRESSURE, -1.0)]), "1/Pa"),
            (product(&[(D::FORCE, 0.5)]), "N^0.5"),
            (product(&[(D::FORCE, 2.0), (D::LENGTH, 1.5)]), "N^2 m^1.5"),
        ] {
            assert_eq!(dimension.to_string(), text);
        }
        assert_eq!(format!("{:>4}|{:<4}|", D::FORCE, D::PRESSURE), "   N|Pa  |");
    }

    #[test]
    fn the_text_is_read_back() {
        let range = [-3_i16, -2, -1, 0, 1, 2, 4];
        for m in range {
            for kg in range {
                for s in range {
                    for k in [-2, 0, 1, 2] {
                        let dimension = Dimension { halves: [m, kg, s, k] };
                        assert_eq!(units::unit(&dimension.to_string()), Ok((1.0, dimension)), "{dimension}");
                    }
                }
            }
        }
    }

    #[test]
    fn arithmetic_stays_within_its_range() {
        let large = Dimension::LENGTH.power(64.0).unwrap();
        assert_eq!(
            (large.to_string(), large.exponents()[0].to_bits()),
            ("m^64".to_owned(), 64.0_f64.to_bits())
        );
        assert_eq!(large.times(Dimension::LENGTH), None);
        assert_eq!(large.power(-1.0).and_then(|small| small.over(Dimension::LENGTH)), None);
        assert_eq!(Dimension::LENGTH.power(64.5), None);
        assert_eq!(Dimension::LENGTH.power(0.3), None);
        assert_eq!(Dimension::LENGTH.power(f64::NAN), None);
        assert_eq!(Dimension::NONE.power(f64::INFINITY), Some(Dimension::NONE));
        assert_eq!(Dimension::LENGTH.root().and_then(Dimension::root), None);
        assert_eq!(Dimension::FORCE.root().unwrap().power(2.0), Some(Dimension::FORCE));
        assert_eq!(Dimension::AREA.power(0.25), Dimension::LENGTH.root());
    }

    #[test]
    fn described_in_words() {
        assert_eq!(Dimension::PRESSURE.describe(), "a pressure (Pa)");
        assert_eq!(Dimension::NONE.describe(), "a pure number");
        assert_eq!(Dimension::FORCE.times(Dimension::TIME).unwrap().describe(), "a quantity in N s");
    }
}
