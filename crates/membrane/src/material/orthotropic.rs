//! Woven cloth: stress linear in Green's strain with its own stiffness along warp and weft, and its tension field.
//!
//! ```text
//! W = E.D.E/2,   D = 1/(1 - nu12 nu21) [[Y1, nu12 Y2, 0], [nu12 Y2, Y2, 0], [0, 0, (1 - nu12 nu21) G]],   nu21 = nu12 Y2/Y1
//! ```
//!
//! Relaxed: the least of W(E + Z) over all wrinkle strains Z >= 0 (in the sense of matrices). Where neither the unrelaxed stress is a
//! tension in every direction (taut) nor E a contraction in every direction (slack), Z = g n n with one direction n across the wrinkles:
//! no stress acts across it.

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

/// Directions looked at before the best is polished.
const DIRECTIONS: usize = 24;
/// Steps of polishing; three are enough where the direction is sharp.
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

/// The angle of n: where the energy that a wrinkle can take, (m.S)^2/(m.D m)/2 with m.S < 0, is largest.
fn across(d: &[[f64; 3]; 3], s: [f64; 3]) -> f64 {
    let gain = |angle: f64| {
        let m = Across::at(angle).m;
        let q = (-dot(m, s)).max(0.0);
        q * q / dot(m, times(d, m))
    };
    let step = core::f64::consts::PI / DIRECTIONS as f64;
    let best = (0..DIRECTIONS)
        .map(|i| (gain(i as f64 * step), i as f64 * step))
        .fold((f64::MIN, 0.0), |a, b| if b.0 > a.0 { b } else { a });
    let mut angle = best.1;
    let (mut low, mut high) = (angle - step, angle + step);
    // Newton on d/da ln gain = 2 q'/q - k'/k, kept within the bracket by halving it.
    for _ in 0..STEPS {
        let Across { m, m1, m2 } = Across::at(angle);
        let (dm, dm1) = (times(d, m), times(d, m1));
        let (q, q1, q2) = (dot(m, s), dot(m1, s), dot(m2, s));
        let (k, k1, k2) = (dot(m, dm), 2.0 * dot(m1, dm), 2.0 * (dot(m2, dm) + dot(m1, dm1)));
        let slope = 2.0 * q1 / q - k1 / k;
        let bend = 2.0 * (q2 / q - (q1 / q) * (q1 / q)) - (k2 / k - (k1 / k) * (k1 / k));
        if slope > 0.0 {
            low = angle;
        } else {
            high = angle;
        }
        let newton = angle - slope / bend;
        let next = if bend < 0.0 && newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - angle).abs() < 1e-15 {
            break;
        }
        angle = next;
    }
    angle
}

/// n n over the strains (11, 22, 2 x 12), and its derivatives by the angle of n.
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
