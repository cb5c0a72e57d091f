//! Functions of a tape that [`Real`] does not have, from those that it has, each with its exact derivative.

use crate::Real;
use std::f64::consts::{FRAC_PI_2, LN_10};

/// Square root; at 0 its derivative, which is infinite, is taken as 0.
pub(crate) fn square_root<D: Real>(x: D) -> D {
    if x.value() == 0.0 { D::from(0.0) } else { x.sqrt() }
}

pub(crate) fn log10<D: Real>(x: D) -> D {
    x.ln() / LN_10
}

pub(crate) fn tan<D: Real>(x: D) -> D {
    let (sine, cosine) = x.sin_cos();
    sine / cosine
}

/// asin x = atan(x / sqrt((1 - x)(1 + x))); at -1 and 1 the derivative, which is infinite, is taken as 0.
pub(crate) fn asin<D: Real>(x: D) -> D {
    match x.value() {
        1.0 => D::from(FRAC_PI_2),
        -1.0 => D::from(-FRAC_PI_2),
        _ => (x / ((-x + 1.0) * (x + 1.0)).sqrt()).atan(),
    }
}

/// sinh x = tanh x (e^x + e^-x)/2, which loses no digits near 0.
pub(crate) fn sinh<D: Real>(x: D) -> D {
    x.tanh() * (x.exp() + (-x).exp()) / 2.0
}

/// cosh x = 1 + 2 sinh^2(x/2), whose derivative loses no digits near 0.
pub(crate) fn cosh<D: Real>(x: D) -> D {
    sinh(x / 2.0).squared() * 2.0 + 1.0
}

/// -1, 0 or 1, without derivative.
pub(crate) fn sign<D: Real>(x: D) -> D {
    let x = x.value();
    D::from(if x == 0.0 || x.is_nan() { x.abs() } else { x.signum() })
}

/// Heaviside's step: 0, 1/2 at 0, 1; without derivative.
pub(crate) fn step<D: Real>(x: D) -> D {
    (sign(x) + 1.0) / 2.0
}

/// The smaller; of equal ones the first. What is not a number is passed on.
pub(crate) fn minimum<D: Real>(a: D, b: D) -> D {
    if b.value() < a.value() || b.value().is_nan() { b } else { a }
}

/// The larger; of equal ones the first. What is not a number is passed on.
pub(crate) fn maximum<D: Real>(a: D, b: D) -> D {
    if b.value() > a.value() || b.value().is_nan() { b } else { a }
}

/// `x` within two limits; the lower one counts if they cross. At a limit it is `x`.
pub(crate) fn clamp<D: Real>(x: D, low: D, high: D) -> D {
    maximum(minimum(x, high), low)
}

/// `x^y` = exp(y ln x) for x > 0. At x = 0 it is 0 for y > 0 (with derivative 0 except for y = 1), 1 for y = 0; for
/// x < 0 it is not defined.
pub(crate) fn power<D: Real>(x: D, y: D) -> D {
    match (x.value(), y.value()) {
        (base, _) if base > 0.0 => (x.ln() * y).exp(),
        (0.0, exponent) => at_zero(x, exponent),
        _ => D::from(f64::NAN),
    }
}

/// The same with a constant exponent, for which the derivative by the exponent does not matter.
pub(crate) fn real_power<D: Real>(x: D, exponent: f64) -> D {
    match x.value() {
        base if base > 0.0 => (x.ln() * exponent).exp(),
        0.0 => at_zero(x, exponent),
        _ => D::from(f64::NAN),
    }
}

fn at_zero<D: Real>(x: D, exponent: f64) -> D {
    match exponent {
        1.0 => x,
        y if y > 0.0 => D::from(0.0),
        0.0 => D::from(1.0),
        y if y < 0.0 => D::from(f64::INFINITY),
        _ => D::from(f64::NAN),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dual;

    /// Value and derivative against the standard library's function and a known derivative.
    #[track_caller]
    fn agrees(found: Dual<1>, value: f64, derivative: f64) {
        agrees_within(8.0, found, value, derivative);
    }

    #[track_caller]
    fn agrees_within(units: f64, found: Dual<1>, value: f64, derivative: f64) {
        let near = |a: f64, b: f64| (a - b).abs() <= units * f64::EPSILON * b.abs();
        assert!(near(found.value(), value), "{} is not {value}", found.value());
        assert!(near(found.gradient()[0], derivative), "{} is not {derivative}", found.gradient()[0]);
    }

    #[test]
    fn values_and_derivatives() {
        for x in [-1.3, -0.4, -1e-9, 1e-9, 1e-3, 0.2, 0.9, 1.4] {
            let d = Dual::<1>::variable(x, 0);
            agrees(tan(d), f64::tan(x), 1.0 / x.cos().powi(2));
            agrees(sinh(d), f64::sinh(x), f64::cosh(x));
            agrees(cosh(d), f64::cosh(x), f64::sinh(x));
            if x.abs() < 1.0 {
                agrees(asin(d), f64::asin(x), 1.0 / ((1.0 - x) * (1.0 + x)).sqrt());
            }
            if x > 0.0 {
                agrees(log10(d), f64::log10(x), 1.0 / (x * LN_10));
                // exp multiplies the rounding of y ln x, here up to 35.
                agrees_within(40.0, real_power(d, 1.7), f64::powf(x, 1.7), 1.7 * f64::powf(x, 0.7));
                agrees(power(Dual::from(x), d), f64::powf(x, x), x.ln() * f64::powf(x, x));
            }
        }
    }

    #[test]
    fn at_the_kinks() {
        let at = |x| Dual::<1>::variable(x, 0);
        let pair = |d: Dual<1>| (d.value(), d.gradient()[0]);
        assert_eq!(pair(square_root(at(0.0))), (0.0, 0.0));
        assert_eq!(pair(real_power(at(0.0), 0.3)), (0.0, 0.0));
        assert_eq!(pair(power(at(0.0), Dual::from(1.0))), (0.0, 1.0));
        assert_eq!(pair(power(at(0.0), Dual::from(2.5))), (0.0, 0.0));
        assert_eq!(pair(power(at(0.0), Dual::from(0.0))), (1.0, 0.0));
        assert!(power(at(0.0), Dual::from(-1.0)).value().is_infinite());
        assert!(power(at(-1.0), Dual::from(2.0)).value().is_nan());
        assert_eq!(pair(asin(at(-1.0))), (-FRAC_PI_2, 0.0));
        for (x, expected) in [(-2.0, -1.0), (0.0, 0.0), (-0.0, 0.0), (3.0, 1.0)] {
            assert_eq!(pair(sign(at(x))), (expected, 0.0));
            assert_eq!(pair(step(at(x))), (expected / 2.0 + 0.5, 0.0));
        }
        assert!(sign(f64::NAN).is_nan() && step(f64::NAN).is_nan());
        assert_eq!(pair(maximum(Dual::from(0.0), at(0.0))), (0.0, 0.0));
        assert_eq!(pair(maximum(at(0.0), Dual::from(0.0))), (0.0, 1.0));
        assert_eq!(pair(clamp(at(0.5), Dual::from(0.0), Dual::from(0.5))), (0.5, 1.0));
        assert_eq!(pair(clamp(at(0.6), Dual::from(0.0), Dual::from(0.5))), (0.5, 0.0));
        assert!(maximum(0.0, f64::NAN).is_nan() && minimum(f64::NAN, 0.0).is_nan());
    }
}
