//! Two numbers that go through the same operations, which the compiler turns into packed instructions.

use core::array;
use core::ops::{Add, Mul, Sub};

use crate::sqrt::reciprocal_root;

/// Two numbers, aligned so that one instruction can load them from memory.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(16))]
pub(crate) struct Pair(pub(crate) [f64; 2]);

impl Pair {
    /// The same number twice.
    #[inline]
    pub(crate) const fn both(x: f64) -> Self {
        Self([x, x])
    }

    #[inline]
    pub(crate) fn reciprocal(self) -> Self {
        Self(self.0.map(|x| 1.0 / x))
    }

    #[inline]
    pub(crate) fn reciprocal_root(self) -> Self {
        Self(self.0.map(reciprocal_root))
    }

    /// The smaller of `self` and `other`. A NaN in `self` is dropped, a NaN in `other` stays.
    #[inline]
    pub(crate) fn or_less(self, other: Self) -> Self {
        let less = |i: usize| if self.0[i] < other.0[i] { self.0[i] } else { other.0[i] };
        Self([less(0), less(1)])
    }

    /// The larger of `self` and `other`.
    #[inline]
    pub(crate) fn or_more(self, other: Self) -> Self {
        let more = |i: usize| if self.0[i] > other.0[i] { self.0[i] } else { other.0[i] };
        Self([more(0), more(1)])
    }
}

impl Add for Pair {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self([self.0[0] + other.0[0], self.0[1] + other.0[1]])
    }
}

impl Sub for Pair {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self([self.0[0] - other.0[0], self.0[1] - other.0[1]])
    }
}

impl Mul for Pair {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self([self.0[0] * other.0[0], self.0[1] * other.0[1]])
    }
}

/// Weights of the four coefficients of a cell, applied in two steps. The first gives six times the two
/// numbers L and H of the last but one step of de Boor's algorithm; the second gives their mean L + t (H -
/// L). The slope is half of H - L.
///
/// ```text
/// L = (1 - t)^2 k0 + (4 - 2 t^2) k1 + (1 + t)^2 k2      H = (2 - t)^2 k1 + (4 - 2 (1 - t)^2) k2 + t^2 k3
/// ```
#[derive(Debug, Clone, Copy)]
pub(crate) struct Weights {
    low: [Pair; 3],
    high: [Pair; 3],
    t: Pair,
}

impl Weights {
    #[inline]
    pub(crate) fn at(t: Pair) -> Self {
        let [one, four] = [1.0, 4.0].map(Pair::both);
        let rest = one - t;
        let (below, above) = (rest * rest, t * t);
        let (next, last) = (one + t, one + rest);
        Self {
            low: [below, four - (above + above), next * next],
            high: [last * last, four - (below + below), above],
            t,
        }
    }

    /// The weights of both numbers, each duplicated in a pair.
    #[inline]
    pub(crate) fn of_each(t: Pair) -> [Self; 2] {
        let both = Self::at(t);
        [0, 1].map(|i| {
            let b = |p: Pair| Pair::both(p.0[i]);
            Self { low: both.low.map(b), high: both.high.map(b), t: b(both.t) }
        })
    }

    /// L and H.
    #[inline]
    pub(crate) fn ends(&self, four: &[Pair; 4]) -> [Pair; 2] {
        let sum = |w: &[Pair; 3], at: usize| (w[0] * four[at] + w[1] * four[at + 1]) + w[2] * four[at + 2];
        [sum(&self.low, 0), sum(&self.high, 1)]
    }

    /// The weighted mean L + t (H - L) of two ends.
    #[inline]
    pub(crate) fn mean(&self, [low, high]: [Pair; 2]) -> Pair {
        low + self.t * (high - low)
    }
}

/// The factors (1 - u)^j/u^k of two outputs, divided by 36, in the form a + b u + c/u.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Factors {
    constant: Pair,
    linear: Pair,
    inverse: Pair,
}

impl Factors {
    /// From the exponents k and j of both outputs, each 0 or 1.
    pub(crate) fn new(singular: [f64; 2], vanishing: [f64; 2]) -> Self {
        let each =
            |number: fn(f64, f64) -> f64| Pair(array::from_fn(|o| number(singular[o], vanishing[o]) / 36.0));
        Self {
            constant: each(|k, j| 1.0 - k - j * k),
            linear: each(|k, j| j * (k - 1.0)),
            inverse: each(|k, _| k),
        }
    }

    /// The factors of one of the two outputs, duplicated.
    #[inline]
    pub(crate) fn only(&self, o: usize) -> Self {
        let both = |two: Pair| Pair::both(two.0[o]);
        Self { constant: both(self.constant), linear: both(self.linear), inverse: both(self.inverse) }
    }

    /// The factors and minus their derivatives by u, from u and 1/u.
    #[inline]
    pub(crate) fn at(&self, u: Pair, over: Pair) -> [Pair; 2] {
        let inverse = self.inverse * over;
        [(self.constant + self.linear * u) + inverse, inverse * over - self.linear]
    }
}
