//! One number, or four side by side.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};
use wide::f64x4;

/// One number (`f64`), or four ([`f64x4`]) on which a processor works at once.
///
/// A formula that is written once against this trait gives the same bits for a number on its own and in any company: all
/// operations are those of IEEE 754 or are computed by the same polynomials. Where a program is compiled for fused
/// multiplication and addition, roots and inverse tangents use it, in the last digits.
pub trait Lanes:
    Copy
    + Debug
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// How many numbers there are.
    const COUNT: usize;
    /// A truth value for each.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask> + Not<Output = Self::Mask>;

    /// Takes number `i` of `of` for each `i` below [`Self::COUNT`].
    #[must_use]
    fn each(of: impl FnMut(usize) -> f64) -> Self;
    /// Number `i`.
    ///
    /// # Panics
    /// If `i` is not below [`Self::COUNT`].
    fn lane(self, i: usize) -> f64;
    /// Truth value `i`.
    fn is_set(mask: Self::Mask, i: usize) -> bool;
    /// Whether all are true.
    fn all(mask: Self::Mask) -> bool;
    /// Whether one is less than another; false if either is NaN.
    fn is_below(self, other: Self) -> Self::Mask;
    /// The first where the mask is set, the second elsewhere.
    #[must_use]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Cube root, within 1e-15.
    #[must_use]
    fn cbrt(self) -> Self;
    /// Inverse tangent in radians, within two units in the last place.
    #[must_use]
    fn atan(self) -> Self;

    /// The larger; the second if either is NaN.
    #[must_use]
    fn larger(self, other: Self) -> Self {
        Self::select(other.is_below(self), self, other)
    }

    /// The smaller; the second if either is NaN.
    #[must_use]
    fn smaller(self, other: Self) -> Self {
        Self::select(self.is_below(other), self, other)
    }

    /// `self e^s` up to s^3/12 of itself: a step of a search in logarithms, which must not leave the positive numbers and need
    /// not be exact. -2 < s < 2.
    #[must_use]
    fn grown(self, s: Self) -> Self {
        self * ((s * 0.5 + 1.0) / (s * -0.5 + 1.0))
    }
}

impl Lanes for f64 {
    const COUNT: usize = 1;
    type Mask = bool;

    #[inline]
    fn each(mut of: impl FnMut(usize) -> f64) -> Self {
        of(0)
    }
    #[inline]
    fn lane(self, i: usize) -> f64 {
        [self][i]
    }
    #[inline]
    fn is_set(mask: bool, _: usize) -> bool {
        mask
    }
    #[inline]
    fn all(mask: bool) -> bool {
        mask
    }
    #[inline]
    fn is_below(self, other: Self) -> bool {
        self < other
    }
    #[inline]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline]
    fn abs(self) -> Self {
        Self::abs(self)
    }
    #[inline]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    #[inline]
    fn cbrt(self) -> Self {
        f64x4::splat(self).cbrt().to_array()[0]
    }
    #[inline]
    fn atan(self) -> Self {
        f64x4::splat(self).atan().to_array()[0]
    }
}

impl Lanes for f64x4 {
    const COUNT: usize = 4;
    type Mask = Self;

    #[inline]
    fn each(of: impl FnMut(usize) -> f64) -> Self {
        Self::from(std::array::from_fn::<f64, 4, _>(of))
    }
    #[inline]
    fn lane(self, i: usize) -> f64 {
        self.as_array()[i]
    }
    #[inline]
    fn is_set(mask: Self, i: usize) -> bool {
        mask.to_bitmask() & (1 << i) != 0
    }
    #[inline]
    fn all(mask: Self) -> bool {
        Self::all(mask)
    }
    #[inline]
    fn is_below(self, other: Self) -> Self {
        self.simd_lt(other)
    }
    #[inline]
    fn select(mask: Self, yes: Self, no: Self) -> Self {
        mask.select(yes, no)
    }
    #[inline]
    fn abs(self) -> Self {
        Self::abs(self)
    }
    #[inline]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    #[inline]
    fn cbrt(self) -> Self {
        Self::cbrt(self)
    }
    #[inline]
    fn atan(self) -> Self {
        Self::atan(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elliptic::incomplete;

    /// Every operation gives the bits of the standard library's, or is within what it states.
    #[test]
    fn four_are_each_as_it_is_alone() {
        for x in [1e-9, 3e-3, 0.65, 0.67, 1.0, 2.4, 2.5, 7.0, 1e4, 1e9] {
            let four = f64x4::each(|lane| x * (1.0 + lane as f64));
            for lane in 0..4 {
                let y = x * (1.0 + lane as f64);
                assert_eq!(four.lane(lane).to_bits(), y.to_bits());
                for (many, one, exact, within) in [
                    (four.sqrt(), Lanes::sqrt(y), y.sqrt(), 0.0),
                    (Lanes::atan(four), Lanes::atan(y), y.atan(), 3e-16),
                    (Lanes::cbrt(four), Lanes::cbrt(y), f64::cbrt(y), 1e-15),
                    (Lanes::abs(-four), Lanes::abs(-y), y, 0.0),
                    (four.larger(f64x4::from(2.0)), y.larger(2.0), y.max(2.0), 0.0),
                    (four.smaller(f64x4::from(2.0)), y.smaller(2.0), y.min(2.0), 0.0),
                    (four.grown(f64x4::from(0.1)), y.grown(0.1), y * 0.1_f64.exp(), 1e-4),
                ] {
                    assert_eq!(many.lane(lane).to_bits(), one.to_bits(), "{y}");
                    assert!((one / exact - 1.0).abs() <= within, "{y}: {one} for {exact}");
                }
            }
        }
    }

    /// The size of a step in logarithms is right to its third power.
    #[test]
    fn steps_grow_to_third_order() {
        let error = |s: f64| (1.0_f64.grown(s) / s.exp() - 1.0) / s.powi(3);
        assert!((error(0.01) - 1.0 / 12.0).abs() < 1e-3, "{}", error(0.01));
        assert!(1.0_f64.grown(-1.9) > 0.0);
    }

    /// Arguments that take 0 to 14 duplications, and one that has no value, stand side by side.
    #[test]
    fn integrals_in_company() {
        let t = [1e-3, 1.0, 1e8, 2.0];
        let m = [0.3, 0.5, 0.1, 3.0];
        let pair = incomplete(f64x4::from(t), f64x4::from(m));
        for lane in 0..4 {
            let alone = incomplete(t[lane], m[lane]);
            assert_eq!(
                [pair.f.lane(lane), pair.d.lane(lane)].map(f64::to_bits),
                [alone.f, alone.d].map(f64::to_bits)
            );
        }
        assert!(pair.f.lane(3).is_nan());
    }
}
