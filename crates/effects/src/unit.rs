//! Units in which cards show their numbers, each with its size in SI.

/// A unit with its size in SI.
pub(crate) type Unit = (&'static str, f64);

pub(crate) const NUMBER: Unit = ("1", 1.0);
pub(crate) const PERCENT: Unit = ("%", 0.01);
pub(crate) const MILLIMETRE: Unit = ("mm", 1e-3);
pub(crate) const DEGREE: Unit = ("deg", std::f64::consts::PI / 180.0);
pub(crate) const NEWTON: Unit = ("N", 1.0);
pub(crate) const KILOPASCAL: Unit = ("kPa", 1e3);
pub(crate) const MEGAPASCAL: Unit = ("MPa", 1e6);
pub(crate) const NEWTON_PER_BAR: Unit = ("N/bar", 1e-5);
pub(crate) const SECOND: Unit = ("s", 1.0);
pub(crate) const KILONEWTON_PER_METRE: Unit = ("kN/m", 1e3);
pub(crate) const NEWTON_PER_METRE: Unit = ("N/m", 1.0);
pub(crate) const PERCENT_PER_KILONEWTON: Unit = ("%/kN", 1e-5);
pub(crate) const PERCENT_PER_SECOND: Unit = ("%/s", 0.01);
