//! Forward-mode derivatives: a number that carries its gradient with respect to `N` variables.
//!
//! ```
//! use bulge_numerics::{Dual, Real};
//! let x = Dual::<2>::variable(3.0, 0);
//! let y = Dual::<2>::variable(2.0, 1);
//! let z = x * x * y + y.sqrt();
//! assert_eq!(z.value(), 18.0 + 2.0_f64.sqrt());
//! assert_eq!(z.gradient(), &[12.0, 9.0 + 0.5 / 2.0_f64.sqrt()]);
//! ```
//!
//! The gradient is a plain array (no heap, no option), so that a Runge-Kutta stage on `[Dual<N>; M]` stays in vector registers.

use crate::Real;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A value with its gradient with respect to `N` variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<const N: usize> {
    value: f64,
    gradient: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The variable number `index` (counted from 0) with its value.
    ///
    /// An `index` of `N` or more gives a constant.
    #[must_use]
    pub fn variable(value: f64, index: usize) -> Self {
        let mut variable = Self::from(value);
        if let Some(slope) = variable.gradient.get_mut(index) {
            *slope = 1.0;
        }
        variable
    }

    /// A value with a given gradient.
    #[must_use]
    pub const fn new(value: f64, gradient: [f64; N]) -> Self {
        Self { value, gradient }
    }

    /// Derivatives with respect to the `N` variables.
    #[must_use]
    pub const fn gradient(&self) -> &[f64; N] {
        &self.gradient
    }

    /// Whether any derivative differs from 0.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.gradient.iter().any(|slope| *slope != 0.0)
    }

    /// The chain rule: a function value at `self` with its derivative there.
    #[inline]
    #[must_use]
    pub fn chain(mut self, value: f64, derivative: f64) -> Self {
        self.value = value;
        for slope in &mut self.gradient {
            *slope *= derivative;
        }
        self
    }

    #[inline]
    fn combine(self, other: Self, value: f64, a: f64, b: f64) -> Self {
        self.with(&other, value, |x, y| a * x + b * y)
    }

    // A loop in place: with `array::from_fn` half of all code that the compiler sees would be that function.
    #[inline]
    fn with(mut self, other: &Self, value: f64, f: impl Fn(f64, f64) -> f64) -> Self {
        self.value = value;
        for (slope, other) in self.gradient.iter_mut().zip(&other.gradient) {
            *slope = f(*slope, *other);
        }
        self
    }
}

impl<const N: usize> From<f64> for Dual<N> {
    #[inline]
    fn from(value: f64) -> Self {
        Self { value, gradient: [0.0; N] }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        self.with(&o, self.value + o.value, |x, y| x + y)
    }
}
impl<const N: usize> AddAssign for Dual<N> {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        self.with(&o, self.value - o.value, |x, y| x - y)
    }
}
impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        self.combine(o, self.value * o.value, o.value, self.value)
    }
}
impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline]
    fn div(self, o: Self) -> Self {
        let inverse = 1.0 / o.value;
        let value = self.value * inverse;
        self.combine(o, value, inverse, -value * inverse)
    }
}
impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}
impl<const N: usize> Add<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn add(self, o: f64) -> Self {
        Self { value: self.value + o, ..self }
    }
}
impl<const N: usize> Sub<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn sub(self, o: f64) -> Self {
        Self { value: self.value - o, ..self }
    }
}
impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn mul(self, o: f64) -> Self {
        self.chain(self.value * o, o)
    }
}
impl<const N: usize> Div<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn div(self, o: f64) -> Self {
        self.chain(self.value / o, 1.0 / o)
    }
}

impl<const N: usize> Real for Dual<N> {
    #[inline]
    fn value(self) -> f64 {
        self.value
    }
    #[inline]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.value.sin_cos();
        (self.chain(s, c), self.chain(c, -s))
    }
    #[inline]
    fn exp(self) -> Self {
        let e = self.value.exp();
        self.chain(e, e)
    }
    #[inline]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), 1.0 / self.value)
    }
    #[inline]
    fn tanh(self) -> Self {
        let t = self.value.tanh();
        self.chain(t, 1.0 - t * t)
    }
    #[inline]
    fn atan(self) -> Self {
        self.chain(self.value.atan(), 1.0 / (1.0 + self.value * self.value))
    }
    #[inline]
    fn abs(self) -> Self {
        let sign = if self.value == 0.0 { 0.0 } else { self.value.signum() };
        self.chain(self.value.abs(), sign)
    }
    #[inline]
    fn powi(self, exponent: i32) -> Self {
        if exponent == 0 {
            return Self::from(1.0);
        }
        let [value, lower] = [exponent, exponent - 1].map(|exponent| Real::powi(self.value, exponent));
        self.chain(value, f64::from(exponent) * lower)
    }
    #[inline]
    fn scale_add(self, a: f64, b: Self) -> Self {
        self.with(&b, self.value * a + b.value, |x, y| x * a + y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation in one expression, against central differences.
    fn formula<D: Real>(x: D, y: D) -> D {
        let (s, c) = (x * y).sin_cos();
        (x / y - s * 2.0 + 1.5).squared().sqrt() * c
            + (-x + 0.25).exp() / 3.0
            + (y * y + x).ln().scale_add(0.7, y)
            - 0.1
            + (x * y - 1.0).tanh() * (x - y * 3.0).atan()
            + (x - y * 2.0).abs() * (x.powi(3) + y.powi(-2) * x.powi(0))
    }

    #[test]
    fn gradient_agrees_with_differences() {
        for (x, y) in [(0.3, 0.8), (1.7, 0.4), (2.0, 2.1)] {
            let z = formula(Dual::<2>::variable(x, 0), Dual::<2>::variable(y, 1));
            let h = 1e-6;
            let dx = (formula(x + h, y) - formula(x - h, y)) / (2.0 * h);
            let dy = (formula(x, y + h) - formula(x, y - h)) / (2.0 * h);
            assert!((z.value() - formula(x, y)).abs() < 1e-14);
            // Central differences: h^2 f'''/6 + 1e-16/h, about 1e-9 here.
            assert!((z.gradient()[0] - dx).abs() < 1e-8 && (z.gradient()[1] - dy).abs() < 1e-8);
        }
    }
}
