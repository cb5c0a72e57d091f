//! Numbers with derivatives: the operations that the integrator and the equilibrium laws need.
//!
//! Solvers are written once against [`Real`]; with `f64` they compute a value, with [`crate::Dual`] the same code also
//! carries exact derivatives. The elliptic integrals and the closed form need no derivatives of this kind; they are
//! written against [`crate::Lanes`].

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A real number, possibly with derivatives.
pub trait Real:
    Copy
    + Debug
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// The value without derivatives.
    fn value(self) -> f64;
    /// Square root; the argument must be positive for derivatives to be finite.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// Natural exponential.
    #[must_use]
    fn exp(self) -> Self;
    /// Natural logarithm.
    #[must_use]
    fn ln(self) -> Self;
    /// Hyperbolic tangent.
    #[must_use]
    fn tanh(self) -> Self;
    /// Inverse tangent, in radians.
    #[must_use]
    fn atan(self) -> Self;
    /// Absolute value; its derivative at 0 is taken as 0.
    #[must_use]
    fn abs(self) -> Self;
    /// An integer power; `0^0` is 1.
    #[must_use]
    fn powi(self, exponent: i32) -> Self;
    /// `self * a + b` with a plain factor: the inner operation of a Runge-Kutta stage.
    #[must_use]
    fn scale_add(self, a: f64, b: Self) -> Self;

    /// Square.
    #[must_use]
    fn squared(self) -> Self {
        self * self
    }
}

impl Real for f64 {
    #[inline]
    fn value(self) -> f64 {
        self
    }
    #[inline]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        Self::sin_cos(self)
    }
    #[inline]
    fn exp(self) -> Self {
        Self::exp(self)
    }
    #[inline]
    fn ln(self) -> Self {
        Self::ln(self)
    }
    #[inline]
    fn tanh(self) -> Self {
        Self::tanh(self)
    }
    #[inline]
    fn atan(self) -> Self {
        Self::atan(self)
    }
    #[inline]
    fn abs(self) -> Self {
        Self::abs(self)
    }
    #[inline]
    fn powi(self, exponent: i32) -> Self {
        // The powers of most formulas, in the order of operations of the general one.
        let square = self * self;
        match exponent {
            -4 => 1.0 / (square * square),
            -3 => 1.0 / (self * square),
            -2 => 1.0 / square,
            -1 => 1.0 / self,
            1 => self,
            2 => square,
            3 => self * square,
            4 => square * square,
            _ => Self::powi(self, exponent),
        }
    }
    #[inline]
    fn scale_add(self, a: f64, b: Self) -> Self {
        self * a + b
    }
}
