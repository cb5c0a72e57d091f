//! Lobes: cloth between the fibres of a pleated muscle, inextensible around it, and the area that it encloses
//! as a function of the fibre radius.
//!
//! Two neighbouring fibres at radius r are the ends of a chord 2w = 2 r sin(pi/n); the cloth between them has
//! the width s = C/n all along the muscle (C: circumference of the cloth). Under pressure it is an arc of
//! radius rho and half-opening v, like the lobes of a pumpkin balloon:
//!
//! ```text
//! rho = s/(2 v)        sin(v)/v = 2w/s
//! A   = (n/2) sin(2 pi/n) r^2 + n rho^2 (v - sin v cos v)
//! A'  = 2 n sin(pi/n) (r cos(pi/n) - rho cos(v))                 the pull p rho of two lobes on a fibre, by virtual work
//! A'' = 2 n sin(pi/n) (cos(pi/n) - sin(pi/n) (v sin v + cos v)/(sin v - v cos v))
//! ```
//!
//! Surplus cloth lets the lobes open until they touch their neighbours, where the arc is tangent to the
//! radial plane of the fibre: v = pi/2 + pi/n =: v_c. From there on two layers lie back to back between the
//! fibre and a radius a, where the arc begins:
//!
//! ```text
//! s/2 = (a - r) + rho v_c        rho = a tan(pi/n)        hence a = (s/2 + r)/(1 + v_c tan(pi/n))
//! A = n tan(pi/n) (1 + v_c tan(pi/n)) a^2        A' = 2 n tan(pi/n) a        A'' = 2 n tan(pi/n)/(1 + v_c tan(pi/n))
//! ```
//!
//! A, A' and A'' are continuous there. The simpler rule "touch at v = pi/2", with semicircles over the chord
//! of the radius a, is not a minimum of energy: its A' jumps, by 0.03 % for n = 40 and by 7 % for n = 6.
//!
//! A' vanishes where the lobes form one circle, v = pi/n, rho = r = C/(2 pi): fibres there are straight, and
//! no pressure opens the muscle further.

use bulge_numerics::Real;
use std::f64::consts::{FRAC_PI_2, PI};

/// The cloth of a pleated muscle, in lobes; lengths over the reference radius.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lobes<D> {
    /// Number of fibres n.
    fibres: D,
    /// Width s of the cloth between two fibres.
    width: D,
    /// Sine and cosine of pi/n.
    sin: D,
    cos: D,
    /// 1 + v_c tan(pi/n).
    spread: D,
    /// Which of the two laws acts: one smooth law on either side of [`Lobes::contact_radius`].
    touching: bool,
}

/// The area of a cross-section with its derivatives by the radius of the fibres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Section<D> {
    /// A(r).
    pub(crate) area: D,
    /// A'(r).
    pub(crate) area_r: D,
    /// A''(r).
    pub(crate) area_rr: D,
}

impl<D: Real> Lobes<D> {
    /// Cloth of a circumference between `fibres` fibres.
    pub(crate) fn new(fibres: D, circumference: D) -> Self {
        let half = D::from(PI) / fibres;
        let (sin, cos) = half.sin_cos();
        let spread = (half + FRAC_PI_2) * sin / cos + 1.0;
        Self { fibres, width: circumference / fibres, sin, cos, spread, touching: false }
    }

    /// The same with the law that acts at a radius.
    pub(crate) fn acting_at(self, r: f64) -> Self {
        Self { touching: r < self.contact_radius().value(), ..self }
    }

    /// The radius of the fibres beyond which the lobes no longer touch.
    pub(crate) fn contact_radius(&self) -> D {
        self.width * 0.5 / (self.spread - 1.0)
    }

    /// The radius C/(2 pi) at which the lobes form one circle and A' vanishes.
    pub(crate) fn limit(&self) -> D {
        self.fibres * self.width / (2.0 * PI)
    }

    /// Area and derivatives by the law of [`Lobes::acting_at`]. Not a number beyond the radius at which the
    /// cloth is the chord.
    pub(crate) fn section(&self, r: D) -> Section<D> {
        let Self { fibres: n, width: s, sin, cos, spread, touching } = *self;
        if touching {
            let slope = n * sin / cos * 2.0;
            let a = (s * 0.5 + r) / spread;
            return Section {
                area: slope * spread * a * a * 0.5,
                area_r: slope * a,
                area_rr: slope / spread,
            };
        }
        let [v, sin_v, cos_v] = half_opening(r * sin * 2.0 / s);
        let rho = s * 0.5 / v;
        let slope = n * sin * 2.0;
        let stretch = (v * sin_v + cos_v) / (sin_v - v * cos_v);
        Section {
            area: n * (r * r * sin * cos + rho * rho * (v - sin_v * cos_v)),
            area_r: slope * (r * cos - rho * cos_v),
            area_rr: slope * (cos - sin * stretch),
        }
    }

    /// The bulge B > 0 over the radius `end` for which A'(end + B) = B exp(-y). It rises with y from 0 to the
    /// [`Lobes::limit`]. Its law is that of [`Lobes::acting_at`] at that radius.
    ///
    /// Close to the limit A' is the small difference of two numbers. B exp(-y) gives it exactly.
    pub(crate) fn bulge(&self, end: D, y: D) -> Option<D> {
        let (edge, plain) = (end.value(), self.map(|_, d| d.value()));
        let rate = (-y).exp();
        let most = plain.limit() - edge;
        let (mut low, mut high) = (0.0, most);
        let mut at = 0.5 * most;
        for _ in 0..200 {
            let section = plain.acting_at(edge + at).section(edge + at);
            let gap = at * rate.value() - section.area_r;
            if gap > 0.0 {
                high = at;
            } else {
                low = at;
            }
            let newton = at - gap / (rate.value() - section.area_rr);
            if (newton - at).abs() <= 1e-9 * at {
                let r = end + newton;
                let section = self.acting_at(r.value()).section(r);
                // The last step carries the derivatives.
                let gap = rate * newton - section.area_r;
                let bulge = -(gap / (rate - section.area_rr).value()) + newton;
                // Within rounding of the limit the bulge may lie on either side. Both formulas hold there.
                return (bulge.value() > 0.0 && bulge.value() < most * (1.0 + 1e-12)).then_some(bulge);
            }
            at = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        }
        None
    }

    /// The same for other scalars; each of the five numbers has its place.
    pub(crate) fn map<E>(&self, mut f: impl FnMut(usize, D) -> E) -> Lobes<E> {
        Lobes {
            fibres: f(0, self.fibres),
            width: f(1, self.width),
            sin: f(2, self.sin),
            cos: f(3, self.cos),
            spread: f(4, self.spread),
            touching: self.touching,
        }
    }
}

/// Coefficients of `v^2/(1 - q)` in powers of `1 - q`: a fit to 5e-6 in v on 0 < v < 2.65 (150 degrees, three
/// fibres that touch).
const OPENING: [f64; 7] =
    [6.000_016_55, 1.796_662_41, 0.892_954_38, -0.058_897_85, 1.883_829_22, -2.266_596, 1.582_291_62];

/// The root v of sin(v)/v = q with its sine and cosine: the fit, one step of third order on the values, and a
/// Newton step for the derivatives.
fn half_opening<D: Real>(q: D) -> [D; 3] {
    let u = 1.0 - q.value();
    let v = (u * OPENING.iter().rev().fold(0.0, |sum, c| sum * u + c)).sqrt();
    let (sin, cos) = v.sin_cos();
    // Halley's step for f = sin(v) - q v, whose second derivative is -sin(v).
    let (f, f_v) = (sin - q.value() * v, cos - q.value());
    let v = v - f / (f_v + 0.5 * f * sin / f_v);
    let (sin, cos) = v.sin_cos();
    let rest = (q * v - sin) / (cos - q.value());
    [rest + v, rest * cos + sin, -(rest * sin) + cos]
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_numerics::Dual;

    /// Area by Simpson's rule over the outline of one panel, from the geometry alone: an arc whose
    /// half-opening is found by bisection.
    fn area_by_outline(n: u32, circumference: f64, r: f64) -> f64 {
        let n = f64::from(n);
        let (half, s) = (PI / n, circumference / n);
        // Length of cloth of an arc tangent to nothing, with half-opening v over the chord at radius a.
        let (mut low, mut high) = (1e-9, FRAC_PI_2 + half);
        let touching = s > 2.0 * r * half.tan() * high;
        let (a, rho, v) = if touching {
            let a = (0.5 * s + r) / (1.0 + high * half.tan());
            (a, a * half.tan(), high)
        } else {
            for _ in 0..100 {
                let v: f64 = 0.5 * (low + high);
                if 2.0 * r * half.sin() * v / v.sin() < s { low = v } else { high = v }
            }
            (r, r * half.sin() / low.sin(), low)
        };
        // The centre of the arc lies on the panel's bisector; area = 1/2 integral (x dy - y dx) from the axis
        // along the outline.
        let centre = a * half.cos() - rho * v.cos();
        let steps = 2000;
        let mut area = 0.0;
        for i in 0..=steps {
            let t = v * (2.0 * f64::from(i) / f64::from(steps) - 1.0);
            let weight = if i == 0 || i == steps { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
            area += weight * 0.5 * (centre + rho * t.cos()) * rho * t.cos();
            area += weight * 0.5 * rho * t.sin() * rho * t.sin();
        }
        n * area * 2.0 * v / (3.0 * f64::from(steps))
    }

    fn at(n: u32, circumference: f64, r: f64) -> Section<f64> {
        Lobes::new(f64::from(n), circumference).acting_at(r).section(r)
    }

    #[test]
    fn area_is_that_of_the_outline() {
        for n in [3, 6, 15, 40, 200] {
            for circumference in [6.5, 8.0, 12.0, 30.0] {
                for r in [1.0, 1.03, 1.2, 1.6, 2.5, 4.0] {
                    if r >= circumference / (2.0 * PI) {
                        continue;
                    }
                    let (found, expected) =
                        (at(n, circumference, r).area, area_by_outline(n, circumference, r));
                    assert!(
                        (found / expected - 1.0).abs() < 1e-10,
                        "{n} {circumference} {r}: {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn derivatives_are_exact_on_both_sides() {
        for n in [3.0, 12.0, 40.0] {
            let lobes = Lobes::new(n, 12.0);
            let contact = lobes.contact_radius();
            for r in [
                0.3 * contact,
                0.99 * contact,
                1.01 * contact,
                0.5 * (contact + lobes.limit()),
                0.999 * lobes.limit(),
            ] {
                let exact = lobes.acting_at(r).section(r);
                let dual = lobes.acting_at(r).map(|_, d| Dual::<1>::from(d)).section(Dual::variable(r, 0));
                let close =
                    |got: f64, expected: f64| (got - expected).abs() < 1e-12 * expected.abs().max(10.0);
                assert!(close(dual.area.gradient()[0], exact.area_r), "{n} {r}: A'");
                assert!(close(dual.area_r.gradient()[0], exact.area_rr), "{n} {r}: A''");
                assert!(close(dual.area_r.value(), exact.area_r) && close(dual.area.value(), exact.area));
            }
        }
    }

    /// By the number of fibres and the circumference, against differences.
    #[test]
    fn derivatives_by_fibres_and_cloth() {
        let area = |n: f64, c: f64| Lobes::new(n, c).acting_at(1.4).section(1.4).area;
        for (n, c) in [(12.0, 9.5), (12.0, 16.0), (40.0, 9.2), (40.0, 14.0)] {
            let dual = Lobes::new(Dual::<2>::variable(n, 0), Dual::variable(c, 1)).acting_at(1.4);
            let found = *dual.section(Dual::from(1.4)).area.gradient();
            let h = 1e-5;
            let by_n = (area(n + h, c) - area(n - h, c)) / (2.0 * h);
            let by_c = (area(n, c + h) - area(n, c - h)) / (2.0 * h);
            assert!(
                (found[0] - by_n).abs() < 1e-8 && (found[1] - by_c).abs() < 1e-8,
                "{found:?} {by_n} {by_c}"
            );
        }
    }

    /// Area, slope and curvature of the area are continuous where the lobes begin to touch. The rule "touch
    /// at 90 degrees" has a step in the slope.
    #[test]
    fn the_laws_join_with_the_second_derivative() {
        for n in [3.0, 6.0, 40.0, 200.0] {
            let lobes = Lobes::new(n, 10.0);
            let r = lobes.contact_radius();
            let [touching, free] = [0.5 * r, 2.0 * r].map(|side| lobes.acting_at(side).section(r));
            for (a, b) in
                [(touching.area, free.area), (touching.area_r, free.area_r), (touching.area_rr, free.area_rr)]
            {
                assert!((a / b - 1.0).abs() < 1e-11, "n = {n}: {a} {b}");
            }
            let (sin, cos) = (PI / n).sin_cos();
            let jump = (cos + FRAC_PI_2 * sin) / (cos * (1.0 + FRAC_PI_2 * sin)) - 1.0;
            assert!(jump > 0.0 && (n > 6.0 || jump > 0.06), "{jump}");
        }
    }

    /// No surplus: the polygon. Fully lobed (v = 90 degrees): 12 % more than the polygon of 40 sides. One
    /// circle: no slope.
    #[test]
    fn limits() {
        let (sin, cos) = (PI / 40.0).sin_cos();
        let polygon = 40.0 * sin * cos;
        let flat = at(40, 2.0 * 40.0 * sin * (1.0 + 1e-9), 1.0).area;
        assert!((flat / polygon - 1.0).abs() < 1e-4 * (PI / 40.0), "{flat}");
        let full = at(40, PI * 40.0 * sin, 1.0).area / polygon;
        assert!((full - 1.0 - 0.12).abs() < 0.005, "{full}");
        assert!((full - 1.0 - FRAC_PI_2 * sin / cos).abs() < 1e-12, "{full}");
        for n in [3, 40, 200] {
            let circle = at(n, 2.0 * PI * 1.7, 1.7);
            assert!(
                (circle.area / (PI * 1.7 * 1.7) - 1.0).abs() < 1e-11
                    && circle.area_r.abs() < 1e-9
                    && circle.area_rr < 0.0
            );
        }
    }

    #[test]
    fn the_bulge_meets_its_slope() {
        let lobes = Lobes::new(40.0, 18.0);
        for y in [-12.0, -4.0, -2.0, -1.0, 0.0, 3.0, 20.0, 100.0] {
            let bulge = lobes.bulge(1.0, y).unwrap();
            let r = 1.0 + bulge;
            let slope = lobes.acting_at(r).section(r).area_r;
            assert!((slope - bulge * f64::exp(-y)).abs() < 1e-10, "{y}: {bulge} {slope}");
            let dual =
                lobes.map(|_, d| Dual::<1>::from(d)).bulge(Dual::from(1.0), Dual::variable(y, 0)).unwrap();
            let h = 1e-5;
            let difference =
                (lobes.bulge(1.0, y + h).unwrap() - lobes.bulge(1.0, y - h).unwrap()) / (2.0 * h);
            assert!(
                (dual.gradient()[0] - difference).abs() < 1e-8,
                "{y}: {:?} {difference}",
                dual.gradient()
            );
        }
    }
}
