//! A sheet: its law, whether it wrinkles, and its stress and tangent at any state of strain.

use super::law::{Energy, Law};
use super::orthotropic::Orthotropic;
use super::tension_field::{Principal, Tension, relaxed};
use serde::Serialize;

/// The material law of a sheet.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Cloth {
    /// Isotropic.
    Isotropic(Law),
    /// Woven: stiff along warp and weft.
    Orthotropic(Orthotropic),
}

/// A membrane's material.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sheet {
    /// Its law.
    pub cloth: Cloth,
    /// Whether it wrinkles under compression (cloth, thin rubber) or carries it.
    pub wrinkles: bool,
    /// Fraction of the unrelaxed stiffness that a wrinkled or slack sheet keeps, so that the positions of its
    /// nodes are determined. A fraction of 1e-6 changes forces by less than 1e-6.
    pub residual: f64,
}

/// Energy per unit area, with stress and tangent with respect to Green's strain in the order 11, 22, 2 x 12.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Plane {
    pub(crate) w: f64,
    pub(crate) s: [f64; 3],
    pub(crate) d: [[f64; 3]; 3],
    pub(crate) tension: Tension,
}

impl Sheet {
    /// Evaluates the right Cauchy-Green tensor C = (C11, C22, C12).
    #[inline]
    pub(crate) fn plane(&self, c: [f64; 3]) -> Plane {
        match &self.cloth {
            Cloth::Isotropic(law) => spectral(c, self.wrinkles, |c1, c2| self.principal_of(law, c1, c2)),
            Cloth::Orthotropic(cloth) => {
                let e = [0.5 * (c[0] - 1.0), 0.5 * (c[1] - 1.0), c[2]];
                let full = cloth.taut(e);
                if !self.wrinkles {
                    return full;
                }
                mixed(cloth.relaxed(e), &full, self.residual)
            }
        }
    }

    /// Evaluates squared stretches along the sheet's own axes, without shear, as in a membrane of revolution.
    #[inline]
    pub(crate) fn principal(&self, c1: f64, c2: f64) -> Principal {
        match &self.cloth {
            Cloth::Isotropic(law) => self.principal_of(law, c1, c2),
            Cloth::Orthotropic(_) => {
                let p = self.plane([c1, c2, 0.0]);
                // dE/dc = 1/2.
                let energy = Energy {
                    w: p.w,
                    w1: 0.5 * p.s[0],
                    w2: 0.5 * p.s[1],
                    w11: 0.25 * p.d[0][0],
                    w12: 0.25 * p.d[0][1],
                    w22: 0.25 * p.d[1][1],
                };
                Principal { energy, tension: p.tension }
            }
        }
    }

    /// The fraction of the width that is folded away at these stretches. A taut sheet has none, although
    /// pulled cloth is narrower than it was cut; in a wrinkled one it is the difference to its natural width.
    pub(crate) fn folded(&self, stretch: [f64; 2], tension: Tension) -> f64 {
        let [narrow, wide] = [stretch[0].min(stretch[1]), stretch[0].max(stretch[1])];
        let width = match (tension, &self.cloth) {
            (Tension::Taut, _) => return 0.0,
            (Tension::Wrinkled, Cloth::Isotropic(law)) if wide > 1.0 => law.natural_width(wide * wide).sqrt(),
            _ => 1.0,
        };
        (1.0 - narrow / width).max(0.0)
    }

    #[inline]
    fn principal_of(&self, law: &Law, c1: f64, c2: f64) -> Principal {
        if !self.wrinkles {
            let energy = law.energy(c1, c2);
            let taut = usize::from(energy.w1 > 0.0) + usize::from(energy.w2 > 0.0);
            return Principal { energy, tension: [Tension::Slack, Tension::Wrinkled, Tension::Taut][taut] };
        }
        let Principal { energy: e, tension } = relaxed(law, c1, c2);
        if tension == Tension::Taut || self.residual == 0.0 {
            return Principal { energy: e, tension };
        }
        let f = law.energy(c1, c2);
        let r = self.residual;
        let mix = |a: f64, b: f64| a + r * (b - a);
        let energy = Energy {
            w: mix(e.w, f.w),
            w1: mix(e.w1, f.w1),
            w2: mix(e.w2, f.w2),
            w11: mix(e.w11, f.w11),
            w12: mix(e.w12, f.w12),
            w22: mix(e.w22, f.w22),
        };
        Principal { energy, tension }
    }
}

fn mixed(mut relaxed: Plane, full: &Plane, residual: f64) -> Plane {
    let mix = |a: &mut f64, b: f64| *a += residual * (b - *a);
    mix(&mut relaxed.w, full.w);
    for i in 0..3 {
        mix(&mut relaxed.s[i], full.s[i]);
        for j in 0..3 {
            mix(&mut relaxed.d[i][j], full.d[i][j]);
        }
    }
    relaxed
}

/// An isotropic energy w(c1, c2) for a tensor C with eigenvalues c1 >= c2 and their directions:
///
/// ```text
/// S_i = 2 w_i     dS_i/dE_j = 4 w_ij     dS_12/d(2 E_12) = (S_1 - S_2)/(c1 - c2), or 2 (w_11 - w_12) where c1 = c2
/// ```
#[inline]
fn spectral(c: [f64; 3], wrinkles: bool, energy: impl Fn(f64, f64) -> Principal) -> Plane {
    let (mean, half, off) = (0.5 * (c[0] + c[1]), 0.5 * (c[0] - c[1]), c[2]);
    let radius = half.hypot(off);
    let (c1, c2) = (mean + radius, mean - radius);
    // cos and sin of twice the angle of the first direction.
    let (cos2, sin2) = if radius > 1e-14 * mean.abs() { (half / radius, off / radius) } else { (1.0, 0.0) };
    let Principal { energy: e, tension } = energy(c1, c2);
    let (s1, s2) = (2.0 * e.w1, 2.0 * e.w2);
    // The limit of equal stretches requires an energy that is smooth there, which that of a wrinkling sheet
    // at small strains isn't.
    let is_smooth = !wrinkles || tension == Tension::Taut;
    let shear = if radius > if is_smooth { 1e-6 } else { 1e-14 } * mean {
        (s1 - s2) / (2.0 * radius)
    } else {
        // The mean of both sides' derivatives, which agree up to O(radius).
        e.w11 + e.w22 - 2.0 * e.w12
    };
    // Dyads of the directions: n1 n1 = (a, b, m), n2 n2 = (b, a, -m), the mixed one (-2 m, 2 m, cos2)/2 ... in the order 11, 22, 12.
    let (a, b, m) = (0.5 * (1.0 + cos2), 0.5 * (1.0 - cos2), 0.5 * sin2);
    let (n1, n2, n12) = ([a, b, m], [b, a, -m], [-m, m, 0.5 * cos2]);
    let mut s = [0.0; 3];
    let mut d = [[0.0; 3]; 3];
    let (d11, d12, d22) = (4.0 * e.w11, 4.0 * e.w12, 4.0 * e.w22);
    for i in 0..3 {
        s[i] = s1 * n1[i] + s2 * n2[i];
        for j in 0..3 {
            d[i][j] = d11 * n1[i] * n1[j]
                + d12 * (n1[i] * n2[j] + n2[i] * n1[j])
                + d22 * n2[i] * n2[j]
                + 4.0 * shear * n12[i] * n12[j];
        }
    }
    Plane { w: e.w, s, d, tension }
}

#[cfg(test)]
mod tests {
    use super::super::law::tests::LAWS;
    use super::*;

    const WOVEN: Orthotropic = Orthotropic { warp: 4.0, weft: 2.5, poisson: 0.35, shear: 0.4 };

    fn isotropic(law: Law, wrinkles: bool, residual: f64) -> Sheet {
        Sheet { cloth: Cloth::Isotropic(law), wrinkles, residual }
    }

    /// C with these eigenvalues, the first at `angle` to the first axis.
    fn tensor(c1: f64, c2: f64, angle: f64) -> [f64; 3] {
        let (sin, cos) = angle.sin_cos();
        [c1 * cos * cos + c2 * sin * sin, c1 * sin * sin + c2 * cos * cos, (c1 - c2) * sin * cos]
    }

    /// Newton's method only converges quadratically if the tangent is exact at any strain, also below 1e-6,
    /// where the principal directions rotate fast.
    #[test]
    fn the_tangent_is_right_at_tiny_strains() {
        for law in LAWS {
            let sheet = isotropic(law, true, 0.0);
            for size in [1e-5, 3e-7, 1e-8] {
                let c = tensor(1.0 + 2.0 * size, 1.0 - 3.0 * size, 0.4);
                let plane = sheet.plane(c);
                assert_eq!(plane.tension, Tension::Wrinkled);
                for j in 0..3 {
                    let h = 1e-3 * size;
                    let at = |h: f64| {
                        let mut moved = c;
                        moved[j] += h;
                        sheet.plane(moved).s
                    };
                    let (up, down) = (at(h), at(-h));
                    for i in 0..3 {
                        // E = (C - 1)/2 over (11, 22, 2 x 12).
                        let slope = (up[i] - down[i]) / (2.0 * h) * if j < 2 { 2.0 } else { 1.0 };
                        assert!(
                            (plane.d[i][j] - slope).abs() < 2e-3,
                            "{law:?} {size:e} {i} {j}: {slope} {:?}",
                            plane.d
                        );
                    }
                }
            }
        }
    }

    /// Half of the natural width means that half is folded away; rubber pulled to l has the natural width
    /// 1/sqrt(l).
    #[test]
    fn folds_are_what_is_missing_to_the_natural_width() {
        let rubber = isotropic(Law::NeoHooke { shear: 1.3 }, true, 0.0);
        let folded = |l: f64, across: f64| {
            rubber.folded([l, across], rubber.principal(l * l, across * across).tension)
        };
        assert!((folded(1.44, 0.5 / 1.2) - 0.5).abs() < 1e-12);
        assert!((folded(1.44, 0.99 / 1.2) - 0.01).abs() < 1e-12);
        assert!(folded(1.44, 1.01 / 1.2) == 0.0 && folded(1.44, 1.44) == 0.0);
        assert!((folded(0.9, 0.7) - 0.3).abs() < 1e-12);
    }

    /// Stress and tangent against fourth-order differences in each component of C. With E = (C - 1)/2 over
    /// (11, 22, 2 x 12), a step of C11 is half as large in E11, and a step of C12 equals one of 2 E12.
    fn check(sheet: &Sheet, c: [f64; 3], what: &str) {
        let now = sheet.plane(c);
        let h = 1e-4;
        for j in 0..3 {
            let [a, b, d, e] = [-2.0, -1.0, 1.0, 2.0].map(|steps| {
                let mut c = c;
                c[j] += steps * h;
                sheet.plane(c)
            });
            let over = if j < 2 { 2.0 } else { 1.0 };
            let slope =
                |f: &dyn Fn(&Plane) -> f64| over * (8.0 * (f(&d) - f(&b)) - (f(&e) - f(&a))) / (12.0 * h);
            let stress = slope(&|plane| plane.w);
            assert!((stress - now.s[j]).abs() < 1e-9, "{what}: S {j} {} {stress}", now.s[j]);
            for i in 0..3 {
                let tangent = slope(&|plane| plane.s[i]);
                assert!((tangent - now.d[i][j]).abs() < 1e-8, "{what}: D {i} {j} {} {tangent}", now.d[i][j]);
                assert!((now.d[i][j] - now.d[j][i]).abs() < 1e-14, "{what}: {i} {j}");
            }
        }
    }

    #[test]
    fn stress_and_tangent_are_those_of_the_energy() {
        for law in LAWS {
            let n = law.natural_width(1.4);
            for (wrinkles, residual) in [(false, 0.0), (true, 0.0), (true, 0.02)] {
                let sheet = isotropic(law, wrinkles, residual);
                for (c1, c2) in [
                    (1.7, 1.3),
                    (1.4, n + 1e-3),
                    (1.4, n - 1e-3),
                    (1.5, 0.5),
                    (1.001, 0.6),
                    (0.999, 0.6),
                    (0.8, 0.6),
                ] {
                    for angle in [0.0, 0.4, core::f64::consts::FRAC_PI_4, 1.3, 1.9, 2.6] {
                        check(&sheet, tensor(c1, c2, angle), &format!("{sheet:?} {c1} {c2} {angle}"));
                    }
                }
            }
        }
    }

    #[test]
    fn equal_and_nearly_equal_stretches_make_no_difference() {
        for law in LAWS {
            for (wrinkles, residual) in [(false, 0.0), (true, 0.0), (true, 0.02)] {
                let sheet = isotropic(law, wrinkles, residual);
                for mean in [1.5, 0.8] {
                    for apart in [0.0, 1e-15, 1e-9, 1e-7, 0.9e-6, 1.1e-6, 1e-5] {
                        for angle in [0.0, 0.4, core::f64::consts::FRAC_PI_4, 2.6] {
                            let c = tensor(mean * (1.0 + apart), mean * (1.0 - apart), angle);
                            check(&sheet, c, &format!("{sheet:?} {mean} {apart} {angle}"));
                        }
                    }
                }
            }
        }
        // Also without load, if the sheet doesn't wrinkle: D = Y/(1 - nu^2) [[1, nu, 0], [nu, 1, 0], [0, 0,
        // (1 - nu)/2]].
        let law = Law::SaintVenantKirchhoff { stiffness: 3.0, poisson: 0.4 };
        let y = 3.0 / 0.84;
        for apart in [0.0, 1e-9, 1e-5] {
            let plane = isotropic(law, false, 0.0).plane(tensor(1.0 + apart, 1.0 - apart, 0.4));
            let expected = [[y, 0.4 * y, 0.0], [0.4 * y, y, 0.0], [0.0, 0.0, 0.3 * y]];
            for (given, expected) in plane.d.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((given - expected).abs() < 1e-9, "{apart}: {:?}", plane.d);
            }
        }
        // Rubber is isotropic and incompressible: Y = 3 mu, nu = 1/2.
        let plane = isotropic(Law::NeoHooke { shear: 1.3 }, false, 0.0).plane([1.0, 1.0, 0.0]);
        for (given, expected) in [(plane.d[0][0], 5.2), (plane.d[0][1], 2.6), (plane.d[2][2], 1.3)] {
            assert!((given - expected).abs() < 1e-13);
        }
    }

    #[test]
    fn known_energies_and_stresses() {
        // By hand at stretches 2 and 1: I1 = 5.25, I2 = 5.25; 2 dW/dc = (1/l) dW/dl.
        let at = |law| isotropic(law, true, 0.0).plane(tensor(4.0, 1.0, 0.0));
        let plane = at(Law::NeoHooke { shear: 1.3 });
        for (given, expected) in
            [(plane.w, 0.65 * 2.25), (plane.s[0], 1.3 * (1.0 - 1.0 / 16.0)), (plane.s[1], 1.3 * 0.75)]
        {
            assert!((given - expected).abs() < 1e-14, "{plane:?}");
        }
        let plane = at(Law::MooneyRivlin { c1: 0.6, c2: 0.2 });
        assert!((plane.w - 0.8 * 2.25).abs() < 1e-14);
        // 2 c1 (1 - 1/(c1^2 c2)) + 2 c2 (c2 - 1/c1^2), and with 1 and 2 exchanged.
        assert!((plane.s[0] - (1.2 + 0.4) * (1.0 - 1.0 / 16.0)).abs() < 1e-14);
        assert!((plane.s[1] - (1.2 * 0.75 + 0.4 * 3.0)).abs() < 1e-14);
        let plane = at(Law::Gent { shear: 1.3, limit: 30.0 });
        assert!((plane.w + 0.65 * 30.0 * (1.0_f64 - 2.25 / 30.0).ln()).abs() < 1e-14);
        assert!((plane.s[1] - 1.3 * 30.0 / 27.75 * 0.75).abs() < 1e-14);
        let plane = at(Law::Hencky { stiffness: 3.0, poisson: 0.3 });
        let e = 2.0_f64.ln();
        assert!((plane.w - 1.5 / 0.91 * e * e).abs() < 1e-14);
        assert!(
            (plane.s[0] - 3.0 / 0.91 * e / 4.0).abs() < 1e-14 && (plane.s[1] - 0.9 / 0.91 * e).abs() < 1e-14
        );
        let plane = at(Law::SaintVenantKirchhoff { stiffness: 3.0, poisson: 0.4 });
        assert!((plane.w - 1.5 / 0.84 * 2.25).abs() < 1e-14);
        assert!(
            (plane.s[0] - 3.0 / 0.84 * 1.5).abs() < 1e-14 && (plane.s[1] - 1.2 / 0.84 * 1.5).abs() < 1e-14
        );
    }

    #[test]
    fn a_residual_is_a_share_of_the_whole_sheet() {
        let cloths = LAWS.map(Cloth::Isotropic).into_iter().chain([Cloth::Orthotropic(WOVEN)]);
        for cloth in cloths {
            let at = |wrinkles, residual, c| Sheet { cloth, wrinkles, residual }.plane(c);
            for (c1, c2) in [(1.7, 1.5), (1.5, 0.5), (0.8, 0.6)] {
                let c = tensor(c1, c2, 0.4);
                let (relaxed, full, mixed) = (at(true, 0.0, c), at(false, 0.0, c), at(true, 0.03, c));
                assert_eq!(relaxed.tension, mixed.tension);
                let mix = |a: f64, b: f64| 0.97 * a + 0.03 * b;
                let what = format!("{cloth:?} {c1} {c2}");
                assert!((mixed.w - mix(relaxed.w, full.w)).abs() < 1e-14, "{what}");
                for i in 0..3 {
                    assert!((mixed.s[i] - mix(relaxed.s[i], full.s[i])).abs() < 1e-14, "{what}");
                    for j in 0..3 {
                        assert!((mixed.d[i][j] - mix(relaxed.d[i][j], full.d[i][j])).abs() < 1e-13, "{what}");
                    }
                }
                // The residual stiffness only shows where the sheet is wrinkled or slack.
                let is_taut = relaxed.tension == Tension::Taut;
                assert_eq!((relaxed.w - full.w).abs() < 1e-14, is_taut, "{what}");
            }
        }
    }

    #[test]
    fn along_the_axes_of_a_sheet() {
        // The energy for a membrane of revolution is that of the same sheet.
        let h = 1e-4;
        let cloths = LAWS.map(Cloth::Isotropic).into_iter().chain([Cloth::Orthotropic(WOVEN)]);
        for cloth in cloths {
            for (wrinkles, residual) in [(false, 0.0), (true, 0.0), (true, 0.02)] {
                let sheet = Sheet { cloth, wrinkles, residual };
                for (c1, c2) in [(1.7, 1.3), (1.3, 1.7), (1.5, 0.5), (0.5, 1.5), (0.8, 0.6)] {
                    let now = sheet.principal(c1, c2);
                    let plane = sheet.plane([c1, c2, 0.0]);
                    assert!((now.energy.w - plane.w).abs() < 1e-14 && now.tension == plane.tension);
                    let slope = |f: &dyn Fn(f64) -> f64| {
                        (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
                    };
                    let at = |a: f64, b: f64| sheet.principal(c1 + a, c2 + b).energy;
                    for (given, expected) in [
                        (now.energy.w1, slope(&|x| at(x, 0.0).w)),
                        (now.energy.w2, slope(&|x| at(0.0, x).w)),
                        (now.energy.w11, slope(&|x| at(x, 0.0).w1)),
                        (now.energy.w12, slope(&|x| at(0.0, x).w1)),
                        (now.energy.w22, slope(&|x| at(0.0, x).w2)),
                    ] {
                        assert!((given - expected).abs() < 1e-8, "{sheet:?} {c1} {c2}: {given} {expected}");
                    }
                }
            }
        }
    }
}
