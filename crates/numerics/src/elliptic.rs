//! Incomplete elliptic integrals by Carlson's duplication; the two that a meridian needs are computed in one
//! pass.
//!
//! B. C. Carlson, *Numerical computation of real or complex elliptic integrals*, Numerical Algorithms 10 (1995) 13-26;
//! NIST Digital Library of Mathematical Functions, sections 19.25 and 19.36.
//!
//! The second argument `m` is the *parameter* k^2, not the modulus k and not the modular angle (S1 writes `F(phi\m)`, which
//! elsewhere means the angle).

use crate::Lanes;

/// The pair `F(phi|m)` and `D(phi|m)`.
///
/// ```text
/// F = integral 0..phi of             dtheta / sqrt(1 - m sin^2 theta)      first kind
/// D = integral 0..phi of sin^2 theta dtheta / sqrt(1 - m sin^2 theta)      = (F - E)/m
/// E = F - m D                                                             second kind
/// ```
///
/// D is the well-behaved companion of F: formulas written with it keep all digits as m -> 0, where `(F - E)/m` loses them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair<L = f64> {
    /// First kind, F.
    pub f: L,
    /// (F - E)/m.
    pub d: L,
}

/// Deviation below which the series after the duplications is exact to rounding: its error is about 0.1 x^8.
const SERIES: f64 = 0.012;
/// Most duplications; each divides the deviation by four, which is enough for a spread of 1e300.
const MAX_DUPLICATIONS: u32 = 300;

/// F and D for the amplitude phi with `tan(phi) = t >= 0` (phi below 90 degrees) and `m < 1 + 1/t^2`.
///
/// ```text
/// F = t RF(1, 1 + (1 - m) t^2, 1 + t^2)        D = t^3/3 RD(1, 1 + (1 - m) t^2, 1 + t^2)
/// ```
///
/// Relative error below 2e-15 (F) and 4e-15 (D); NaN outside the range.
#[must_use]
#[inline]
pub fn incomplete<L: Lanes>(t: L, m: L) -> Pair<L> {
    let [x, y, z] = arguments(t, m);
    let (rf, rd) = carlson(x, y, z);
    Pair { f: t * rf, d: t * t * t * rd * (1.0 / 3.0) }
}

/// Number of duplications that [`incomplete`] makes: what it costs. Of several numbers, the most.
#[must_use]
pub fn duplications<L: Lanes>(t: L, m: L) -> u32 {
    let [x, y, z] = arguments(t, m);
    Duplicated::of(x, y, z).count
}

#[inline]
fn arguments<L: Lanes>(t: L, m: L) -> [L; 3] {
    let t2 = t * t;
    [L::from(1.0), (-m + 1.0) * t2 + 1.0, t2 + 1.0]
}

/// Carlson's RF(x, y, z) and RD(x, y, z) for positive arguments, sharing the duplications.
#[must_use]
#[inline]
pub fn carlson<L: Lanes>(x: L, y: L, z: L) -> (L, L) {
    let Duplicated { x, y, z, a, sum, quarter, .. } = Duplicated::of(x, y, z);
    (rf_series(x, y, z), quarter * rd_series(x, y, z, a) + sum * 3.0)
}

/// Arguments that are nearly equal after so many duplications, with the sum that RD keeps of them.
struct Duplicated<L> {
    x: L,
    y: L,
    z: L,
    /// Mean of the arguments, with z three times.
    a: L,
    sum: L,
    /// 4^-count.
    quarter: L,
    count: u32,
}

impl<L: Lanes> Duplicated<L> {
    #[inline]
    fn of(x: L, y: L, z: L) -> Self {
        let a = (x + y + z * 3.0) * 0.2;
        let mut at = Self { x, y, z, a, sum: L::from(0.0), quarter: L::from(1.0), count: 0 };
        while at.count < MAX_DUPLICATIONS {
            let Self { x, y, z, a, sum, quarter, count } = at;
            let spread = (a - x).abs().larger((a - y).abs()).larger((a - z).abs());
            // What isn't a number is not far.
            let is_far = (a * SERIES).is_below(spread);
            if L::all(!is_far) {
                break;
            }
            let (sx, sy, sz) = (x.sqrt(), y.sqrt(), z.sqrt());
            let lambda = sx * (sy + sz) + sy * sz;
            // A number that is done waits for its company, lest its last digits depend on it.
            let next = |now: L, next: L| L::select(is_far, next, now);
            at = Self {
                x: next(x, (x + lambda) * 0.25),
                y: next(y, (y + lambda) * 0.25),
                z: next(z, (z + lambda) * 0.25),
                a: next(a, (a + lambda) * 0.25),
                sum: next(sum, sum + quarter / (sz * (z + lambda))),
                quarter: next(quarter, quarter * 0.25),
                count: count + 1,
            };
        }
        at
    }
}

/// Series of RF about equal arguments (DLMF 19.36.1).
#[inline]
fn rf_series<L: Lanes>(x: L, y: L, z: L) -> L {
    let inverse = L::from(3.0) / (x + y + z);
    let (dx, dy) = (-(x * inverse) + 1.0, -(y * inverse) + 1.0);
    let dz = -(dx + dy);
    let e2 = dx * dy - dz * dz;
    let e3 = dx * dy * dz;
    let (second, third) = (e2 * e2, e3 * e3);
    let series = e2 * (-1.0 / 10.0) + e3 * (1.0 / 14.0) + second * (1.0 / 24.0)
        - e2 * e3 * (3.0 / 44.0)
        - second * e2 * (5.0 / 208.0)
        + third * (3.0 / 104.0)
        + second * e3 * (1.0 / 16.0)
        + 1.0;
    series * inverse.sqrt()
}

/// Series of RD about equal arguments (DLMF 19.36.2).
#[inline]
fn rd_series<L: Lanes>(x: L, y: L, z: L, a: L) -> L {
    let inverse = L::from(1.0) / a;
    let (dx, dy) = (-(x * inverse) + 1.0, -(y * inverse) + 1.0);
    let dz = (a - z) * inverse;
    let (xy, z2) = (dx * dy, dz * dz);
    let e2 = xy - z2 * 6.0;
    let e3 = (xy * 3.0 - z2 * 8.0) * dz;
    let e4 = (xy - z2) * z2 * 3.0;
    let e5 = xy * z2 * dz;
    let second = e2 * e2;
    let series = e2 * (-3.0 / 14.0) + e3 * (1.0 / 6.0) + second * (9.0 / 88.0)
        - e4 * (3.0 / 22.0)
        - e2 * e3 * (9.0 / 52.0)
        + e5 * (3.0 / 26.0)
        - second * e2 * (1.0 / 16.0)
        + e3 * e3 * (3.0 / 40.0)
        + e2 * e4 * (3.0 / 20.0)
        + second * e3 * (45.0 / 272.0)
        - (e3 * e4 + e2 * e5) * (9.0 / 68.0)
        + 1.0;
    series * inverse * inverse.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_sixty_digits() {
        let rows: Vec<[f64; 4]> = include_str!("../reference/elliptic.csv")
            .lines()
            .filter(|line| !line.starts_with(['#', 't']))
            .map(|line| {
                let mut cells = line.split(',').map(|cell| cell.parse().unwrap());
                std::array::from_fn(|_| cells.next().unwrap())
            })
            .collect();
        assert_eq!(rows.len(), 132);
        let worst = |value: fn(Pair<f64>) -> f64, column: usize| {
            rows.iter()
                .map(|row| (value(incomplete(row[0], row[1])) / row[column] - 1.0).abs())
                .fold(0.0, f64::max)
        };
        let (f, d) = (worst(|pair| pair.f, 2), worst(|pair| pair.d, 3));
        assert!(f < 2e-15 && d < 4e-15, "F {f:e}, D {d:e}");
    }

    /// Each divides the deviations from the mean by four: 0.425 of it becomes 0.007 in three (t = 1), and 0.99 in four (t = 10,
    /// where the mean falls as well).
    #[test]
    fn duplications_are_counted() {
        let counts = [1e-3, 0.1, 1.0, 10.0].map(|t| duplications(t, 0.3));
        assert_eq!(counts, [0, 0, 3, 4]);
    }

    #[test]
    fn limits() {
        // m = 0: F = phi, D = (phi - sin phi cos phi)/2; t -> 0: F -> t, D -> t^3/3.
        let pair = incomplete(1.0, 0.0);
        let phi = std::f64::consts::FRAC_PI_4;
        assert!((pair.f - phi).abs() < 1e-15 && (pair.d - (phi - 0.5) / 2.0).abs() < 1e-15);
        let pair = incomplete(1e-8, 0.3);
        assert!((pair.f / 1e-8 - 1.0).abs() < 1e-15 && (pair.d / (1e-24 / 3.0) - 1.0).abs() < 1e-15);
    }

    /// Without a duplication both series err by the eighth power of the spread: no term before it is wrong.
    #[test]
    fn the_series_end_at_the_eighth_power() {
        let errors = |spread: f64| {
            let (x, y, z) = (1.0 - spread, 1.0 + 0.3 * spread, 1.0 + spread);
            let (rf, rd) = carlson(x, y, z);
            [rf_series(x, y, z) / rf - 1.0, rd_series(x, y, z, (x + y + 3.0 * z) * 0.2) / rd - 1.0]
        };
        let (wide, narrow) = (errors(0.06), errors(0.03));
        for (wide, narrow) in wide.into_iter().zip(narrow) {
            let order = (wide / narrow).abs().log2();
            assert!((order - 8.0).abs() < 0.15, "observed order {order}, errors {wide:e} {narrow:e}");
        }
    }
}
