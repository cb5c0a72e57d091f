//! Woven cloth: stress linear in Green's strain with its own stiffness along warp and weft, and its tension field.
//!
//! ```text
//! W = E.D.E/2,   D = 1/(1 - nu12 nu21) [[Y1, nu12 Y2, 0], [nu12 Y2, Y2, 0], [0, 0, (1 - nu12 nu21) G]],   nu21 = nu12 Y2/Y1
//! ```
//!
//! Relaxed energy: the minimum of W(E + Z) over all wrinkle strains Z >= 0 (in the matrix sense). If neither
//! the unrelaxed stress is a tension in every direction (taut) nor E a contraction in every direction
//! (slack), then Z = g n n with a single direction n across the wrinkles, along which no stress acts.

use super::sheet::Plane;
use super::tension_field::Tension;
use serde::Serialize;

/// Woven cloth times its thickness: moduli in N/m. Axis 1 (warp) is the first axis of the pattern.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Orthotropic {
    /// Y1 h, along the warp.
    pub warp: f64,
    /// Y2 h, along the weft.
    pub weft: f64,
    /// nu12: contraction along the weft per stretch along the warp.
    pub poisson: f64,
    /// G h.
    pub shear: f64,
}

/// Number of directions that are tried before the best one is refined.
const DIRECTIONS: usize = 24;
/// Most refinement steps; three are enough if the direction is well determined.
const STEPS: usize = 40;

impl Orthotropic {
    fn tangent(&self) -> [[f64; 3]; 3] {
        let below = 1.0 - self.poisson * self.poisson * self.weft / self.warp;
        let mixed = self.poisson * self.weft / below;
        [[self.warp / below, mixed, 0.0], [mixed, self.weft / below, 0.0], [0.0, 0.0, self.shear]]
    }

    /// The unrelaxed law at Green's strain (E11, E22, 2 E12).
    pub(crate) fn taut(&self, e: [f64; 3]) -> Plane {
        let d = self.tangent();
        let s = times(&d, e);
        let tension = match (is_positive([s[0], s[1], s[2]]), is_positive([-e[0], -e[1], -0.5 * e[2]])) {
            (true, _) => Tension::Taut,
            (false, true) => Tension::Slack,
            (false, false) => Tension::Wrinkled,
        };
        Plane { w: 0.5 * dot(s, e), s, d, tension }
    }

    /// The tension field.
    pub(crate) fn relaxed(&self, e: [f64; 3]) -> Plane {
        let full = self.taut(e);
        match full.tension {
            Tension::Taut => full,
            Tension::Slack => Plane { w: 0.0, s: [0.0; 3], d: [[0.0; 3]; 3], ..full },
            Tension::Wrinkled => wrinkled(e, full),
        }
    }
}

/// Relaxed along one direction.
fn wrinkled(e: [f64; 3], full: Plane) -> Plane {
    let d = full.d;
    let angle = across(&d, full.s);
    let Across { m, m1, m2 } = Across::at(angle);
    let (dm, dm1) = (times(&d, m), times(&d, m1));
    let (q, curvature) = (-dot(m, full.s), dot(m, dm));
    let g = (q / curvature).max(0.0);
    let z = [e[0] + g * m[0], e[1] + g * m[1], e[2] + g * m[2]];
    let s = times(&d, z);
    // Second derivatives by (g, angle) and mixed with E: D* = D - B H^-1 B'.
    let h11 = curvature;
    let h12 = dot(m1, s) + g * dot(m, dm1);
    let h22 = g * dot(m2, s) + g * g * dot(m1, dm1);
    let b1 = dm;
    let b2 = [g * dm1[0], g * dm1[1], g * dm1[2]];
    let det = h11 * h22 - h12 * h12;
    let mut tangent = d;
    for i in 0..3 {
        for j in 0..3 {
            tangent[i][j] -= if det > 1e-14 * h11 * h11 {
                (h22 * b1[i] * b1[j] - h12 * (b1[i] * b2[j] + b2[i] * b1[j]) + h11 * b2[i] * b2[j]) / det
            } else {
                b1[i] * b1[j] / h11
            };
        }
    }
    Plane { w: 0.5 * dot(s, z), s, d: tangent, tension: Tension::Wrinkled }
}

/// The angle of n, at which the energy that a wrinkle can release, (m.S)^2/(m.D m)/2 with m.S < 0, is
/// largest.
fn across(d: &[[f64; 3]; 3], s: [f64; 3]) -> f64 {
    let gain = |angle: f64| {
        let m = Across::at(angle).m;
        let q = (-dot(m, s)).max(0.0);
        q * q / dot(m, times(d, m))
    };
    let step = core::f64::consts::PI / DIRECTIONS as f64;
    // Near the border to the taut state, the stress is compressive only in directions close to that of its
    // least principal value.
    let least = 0.5 * (-2.0 * s[2]).atan2(s[1] - s[0]);
    let best = (0..DIRECTIONS)
        .map(|i| i as f64 * step)
        .chain([least])
        .map(|angle| (gain(angle), angle))
        .fold((f64::MIN, least), |a, b| if b.0 > a.0 { b } else { a });
    let mut good = best.1;
    let (mut angle, mut low, mut high) = (good, good - step, good + step);
    // Newton's method on d/da ln gain = 2 q'/q - k'/k, kept within the bracket by bisection.
    for _ in 0..STEPS {
        let Across { m, m1, m2 } = Across::at(angle);
        let q = dot(m, s);
        if q >= 0.0 {
            // No compression there: go back towards the directions that had it.
            if angle > good {
                high = angle;
            } else {
                low = angle;
            }
            angle = 0.5 * (angle + good);
            continue;
        }
        good = angle;
        let (dm, dm1) = (times(d, m), times(d, m1));
        let (q1, q2) = (dot(m1, s), dot(m2, s));
        let (k, k1, k2) = (dot(m, dm), 2.0 * dot(m1, dm), 2.0 * (dot(m2, dm) + dot(m1, dm1)));
        let slope = 2.0 * q1 / q - k1 / k;
        let bend = 2.0 * (q2 / q - (q1 / q) * (q1 / q)) - (k2 / k - (k1 / k) * (k1 / k));
        let newton = angle - slope / bend;
        if bend < 0.0 && (newton - angle).abs() < 1e-15 {
            break;
        }
        if slope > 0.0 {
            low = angle;
        } else {
            high = angle;
        }
        angle = if bend < 0.0 && newton > low && newton < high { newton } else { 0.5 * (low + high) };
    }
    good
}

/// n n as strains (11, 22, 2 x 12), and its derivatives by the angle of n.
struct Across {
    m: [f64; 3],
    m1: [f64; 3],
    m2: [f64; 3],
}

impl Across {
    fn at(angle: f64) -> Self {
        let (sin, cos) = (2.0 * angle).sin_cos();
        Self {
            m: [0.5 * (1.0 + cos), 0.5 * (1.0 - cos), sin],
            m1: [-sin, sin, 2.0 * cos],
            m2: [-2.0 * cos, 2.0 * cos, -4.0 * sin],
        }
    }
}

/// Whether the symmetric matrix (11, 22, 12) has no negative eigenvalue.
fn is_positive([a, b, c]: [f64; 3]) -> bool {
    a >= 0.0 && b >= 0.0 && a * b >= c * c
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn times(d: &[[f64; 3]; 3], e: [f64; 3]) -> [f64; 3] {
    [dot(d[0], e), dot(d[1], e), dot(d[2], e)]
}

#[cfg(test)]
mod tests {
    use super::super::law::Law;
    use super::super::sheet::{Cloth, Sheet};
    use super::*;
    use core::f64::consts::PI;

    const WOVEN: Orthotropic = Orthotropic { warp: 4.0, weft: 2.5, poisson: 0.35, shear: 0.4 };
    /// Very different along warp and weft, very soft in shear, and one that contracts more across than it is
    /// stretched.
    const CLOTHS: [Orthotropic; 4] = [
        WOVEN,
        Orthotropic { warp: 40.0, weft: 1.0, poisson: 0.3, shear: 0.05 },
        Orthotropic { warp: 1.0, weft: 3.0, poisson: 0.5, shear: 2.0 },
        Orthotropic { warp: 4.0, weft: 2.0, poisson: 1.2, shear: 0.5 },
    ];

    /// Green's strain with these principal values, the first at `angle`.
    fn strain(e1: f64, e2: f64, angle: f64) -> [f64; 3] {
        let (sin, cos) = angle.sin_cos();
        [e1 * cos * cos + e2 * sin * sin, e1 * sin * sin + e2 * cos * cos, 2.0 * (e1 - e2) * sin * cos]
    }

    /// Strains throughout the three states.
    fn strains() -> impl Iterator<Item = [f64; 3]> {
        let sizes = [-0.3, -0.11, -0.02, 0.01, 0.04, 0.13, 0.3];
        let pairs = sizes.into_iter().flat_map(move |a| sizes.map(|b| (a, b)));
        pairs.flat_map(|(a, b)| (0..11).map(move |i| strain(a, b, 0.27 * f64::from(i) + 0.1 * a)))
    }

    /// The principal values of (11, 22, 12), the larger first.
    fn principal([a, b, c]: [f64; 3]) -> [f64; 2] {
        let (mean, radius) = (0.5 * (a + b), (0.5 * (a - b)).hypot(c));
        [mean + radius, mean - radius]
    }

    #[test]
    fn alike_in_both_directions_it_is_isotropic() {
        let (stiffness, poisson) = (3.0, 0.35);
        let woven = Orthotropic {
            warp: stiffness,
            weft: stiffness,
            poisson,
            shear: 0.5 * stiffness / (1.0 + poisson),
        };
        let law = Law::SaintVenantKirchhoff { stiffness, poisson };
        let mut seen = [0; 3];
        for wrinkles in [false, true] {
            let [woven, isotropic] = [Cloth::Orthotropic(woven), Cloth::Isotropic(law)].map(|cloth| Sheet {
                cloth,
                wrinkles,
                residual: 0.0,
            });
            for e in strains() {
                let c = [1.0 + 2.0 * e[0], 1.0 + 2.0 * e[1], e[2]];
                let (a, b) = (woven.plane(c), isotropic.plane(c));
                if wrinkles {
                    assert_eq!(a.tension, b.tension, "{e:?}");
                    seen[a.tension as usize] += 1;
                }
                assert!((a.w - b.w).abs() < 1e-15, "{e:?}: {} {}", a.w, b.w);
                for i in 0..3 {
                    assert!((a.s[i] - b.s[i]).abs() < 1e-13, "{e:?}: {:?} {:?}", a.s, b.s);
                    for j in 0..3 {
                        // With equal stretches, the last digits of the isotropic law's directions are lost.
                        assert!((a.d[i][j] - b.d[i][j]).abs() < 1e-9, "{e:?} {i} {j}: {:?} {:?}", a.d, b.d);
                    }
                }
            }
        }
        println!("slack, wrinkled, taut: {seen:?}");
        assert!(seen.iter().all(|seen| *seen > 50), "{seen:?}");
    }

    #[test]
    fn the_relaxed_energy_is_the_least() {
        for cloth in CLOTHS {
            for e in strains().step_by(5) {
                let relaxed = cloth.relaxed(e);
                let full = cloth.taut(e).w;
                assert!(relaxed.w >= -1e-16 && relaxed.w <= full + 1e-15, "{cloth:?} {e:?}");
                // Wrinkles of any direction and amount, and others across them. Along each direction the
                // energy is a parabola, whose minimum follows from three values of the unrelaxed law.
                let mut least = full;
                for i in 0..720 {
                    let n = Across::at(f64::from(i) * PI / 720.0).m;
                    let across = Across::at((f64::from(i) + 360.0) * PI / 720.0).m;
                    let mut z = e;
                    for _ in 0..20 {
                        for (m, other) in [(n, e), (across, e)] {
                            let at =
                                |g: f64| cloth.taut([z[0] + g * m[0], z[1] + g * m[1], z[2] + g * m[2]]).w;
                            let (a, b, c) = (at(-1.0), at(0.0), at(1.0));
                            let by = -0.5 * (c - a) / (a - 2.0 * b + c);
                            // The wrinkle strain along m so far, which mustn't become negative.
                            let so_far = (z[0] - other[0]) * m[0]
                                + (z[1] - other[1]) * m[1]
                                + 0.5 * (z[2] - other[2]) * m[2];
                            let by = by.max(-so_far);
                            for k in 0..3 {
                                z[k] += by * m[k];
                            }
                        }
                    }
                    least = least.min(cloth.taut(z).w);
                }
                // The grid of directions misses the minimum by O(step^2).
                assert!(relaxed.w <= least + 1e-14, "{cloth:?} {e:?}: {} {least}", relaxed.w);
                assert!(least - relaxed.w < 2e-3 * full + 1e-14, "{cloth:?} {e:?}: {} {least}", relaxed.w);
            }
        }
    }

    #[test]
    fn no_stress_acts_across_wrinkles() {
        // Optimality conditions of the convex energy: S >= 0, Z >= 0, S:Z = 0 with Z = D^-1 S - E.
        for cloth in CLOTHS {
            let mut wrinkled = 0;
            for e in strains() {
                let relaxed = cloth.relaxed(e);
                let s = relaxed.s;
                let z = [
                    (s[0] - cloth.poisson * s[1]) / cloth.warp - e[0],
                    s[1] / cloth.weft - cloth.poisson * s[0] / cloth.warp - e[1],
                    s[2] / cloth.shear - e[2],
                ];
                let what = format!("{cloth:?} {e:?}: {s:?} {z:?}");
                let [stress, none] = principal(s);
                let [wrinkle, least] = principal([z[0], z[1], 0.5 * z[2]]);
                assert!(none >= -1e-12 && least >= -1e-12 && dot(s, z).abs() < 1e-12, "{what}");
                if relaxed.tension == Tension::Wrinkled {
                    wrinkled += 1;
                    assert!(none.abs() < 1e-12 && least.abs() < 1e-12, "{what}");
                    assert!(stress > 0.0 && wrinkle > 0.0, "{what}");
                }
                if relaxed.tension == Tension::Slack {
                    assert!(stress.abs() < 1e-15, "{what}");
                }
            }
            assert!(wrinkled > 100);
        }
    }

    /// Tangent against differences of the stress, and stress against differences of the energy.
    fn check(cloth: &Orthotropic, e: [f64; 3], h: f64, tolerance: f64) {
        let now = cloth.relaxed(e);
        for j in 0..3 {
            let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|steps| {
                let mut e = e;
                e[j] += steps * h;
                cloth.relaxed(e)
            });
            if [&a, &b, &c, &d].iter().any(|plane| plane.tension != now.tension) {
                continue;
            }
            let slope = |f: &dyn Fn(&Plane) -> f64| (8.0 * (f(&c) - f(&b)) - (f(&d) - f(&a))) / (12.0 * h);
            let what = format!("{cloth:?} {e:?}");
            let stress = slope(&|plane| plane.w);
            let tolerance = tolerance * cloth.warp.max(cloth.weft);
            assert!((stress - now.s[j]).abs() < tolerance, "{what}: S {j} {} {stress}", now.s[j]);
            for i in 0..3 {
                let tangent = slope(&|plane| plane.s[i]);
                assert!(
                    (tangent - now.d[i][j]).abs() < 100.0 * tolerance,
                    "{what}: D {i} {j} {} {tangent}",
                    now.d[i][j]
                );
                assert!((now.d[i][j] - now.d[j][i]).abs() < 1e-13, "{what}");
            }
        }
    }

    #[test]
    fn stress_and_tangent_are_those_of_the_energy() {
        for cloth in CLOTHS {
            for e in strains() {
                check(&cloth, e, 1e-5, 1e-9);
            }
        }
    }

    /// The parameter on the line of strains from `a` to `b` at which the state changes.
    fn border(cloth: &Orthotropic, a: [f64; 3], b: [f64; 3]) -> f64 {
        let at = |t: f64| cloth.relaxed(between(a, b, t)).tension;
        let (mut low, mut high) = (0.0, 1.0);
        assert_ne!(at(0.0), at(1.0));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if at(middle) == at(0.0) {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    fn between(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
        core::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
    }

    #[test]
    fn stress_is_continuous_across_the_borders() {
        // At the transition from taut to wrinkled, the direction of the wrinkles is sharp: very few
        // directions have any compression.
        for cloth in CLOTHS {
            for i in 0..40 {
                let angle = 0.08 * f64::from(i);
                let (slack, wrinkled) = (strain(-0.1, -0.15, angle), strain(0.2, -0.4, angle));
                let mut taut = strain(0.2, 0.18, angle);
                if cloth.taut(taut).tension != Tension::Taut {
                    taut = strain(0.2, 0.2, angle);
                }
                for (from, to) in [(taut, wrinkled), (slack, wrinkled)] {
                    let at = border(&cloth, from, to);
                    for apart in [1e-12, 1e-9, 1e-7, 1e-5, 1e-3] {
                        let [a, b] = [at - apart, at + apart].map(|t| cloth.relaxed(between(from, to, t)));
                        let what = format!("{cloth:?} {angle} {apart}");
                        for i in 0..3 {
                            // A strain difference of 0.6 x 2 times the stiffness.
                            assert!(
                                (a.s[i] - b.s[i]).abs() < 3.0 * apart * cloth.warp.max(cloth.weft) + 1e-14,
                                "{what}: {:?} {:?}",
                                a.s,
                                b.s
                            );
                        }
                        // The sheet never pushes, however close to the border.
                        assert!(principal(b.s)[1] > -1e-13, "{what}: {:?} {:e}", b.s, principal(b.s)[1]);
                    }
                    for apart in [1e-6, 1e-5, 1e-4, 1e-3] {
                        for side in [-1.0, 1.0] {
                            let e = between(from, to, at + side * apart);
                            check(&cloth, e, 0.03 * apart, if apart > 1e-5 { 1e-8 } else { 1e-6 });
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn known_stresses_of_woven_cloth() {
        // Pulled along the warp with free sides, S = Y1 E, and along the weft S = Y2 E; in shear, S12 = 2 G
        // E12.
        let pulled = WOVEN.relaxed([0.1, -0.2, 0.0]);
        assert!((pulled.s[0] - 0.4).abs() < 1e-15 && (pulled.w - 0.02).abs() < 1e-16, "{pulled:?}");
        assert!((pulled.d[0][0] - 4.0).abs() < 1e-13 && pulled.d[1][1].abs() < 1e-13, "{pulled:?}");
        let pulled = WOVEN.relaxed([-0.2, 0.1, 0.0]);
        assert!((pulled.s[1] - 0.25).abs() < 1e-15 && (pulled.w - 0.0125).abs() < 1e-16, "{pulled:?}");
        let sheared = WOVEN.taut([0.3, 0.3, 0.05]);
        let below = 1.0 - 0.35 * 0.35 * 2.5 / 4.0;
        assert!((sheared.s[2] - 0.02).abs() < 1e-16);
        assert!((sheared.s[0] - (4.0 + 0.35 * 2.5) * 0.3 / below).abs() < 1e-15);
        assert!((sheared.s[1] - (2.5 + 0.35 * 2.5) * 0.3 / below).abs() < 1e-15);
        // Pulled along n at 0.6 rad to the warp: 1/Y = c^4/Y1 + s^4/Y2 + s^2 c^2 (1/G - 2 nu12/Y1), with E = E_n under uniaxial stress.
        let (s, c) = 0.6_f64.sin_cos();
        let y = 1.0 / (c.powi(4) / 4.0 + s.powi(4) / 2.5 + s * s * c * c * (1.0 / 0.4 - 2.0 * 0.35 / 4.0));
        let stress = [c * c * 0.1, s * s * 0.1, s * c * 0.1];
        // The strain under that stress, contracted further across it: wrinkles absorb the rest.
        let free =
            [(stress[0] - 0.35 * stress[1]) / 4.0, stress[1] / 2.5 - 0.35 * stress[0] / 4.0, stress[2] / 0.4];
        for more in [1e-6, 1e-3, 0.1, 1.0] {
            let e = [free[0] - more * s * s, free[1] - more * c * c, free[2] + 2.0 * more * s * c];
            let relaxed = WOVEN.relaxed(e);
            for i in 0..3 {
                assert!((relaxed.s[i] - stress[i]).abs() < 1e-14, "{more}: {:?} {stress:?}", relaxed.s);
            }
            assert!((relaxed.w - 0.5 * 0.01 / y).abs() < 1e-15, "{more}");
        }
    }
}
