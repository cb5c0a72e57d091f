//! A sheet: its law, whether it wrinkles, and stress and tangent at any state of strain.

use super::law::{Energy, Law};
use super::orthotropic::Orthotropic;
use super::tension_field::{Principal, Tension, relaxed};
use serde::Serialize;

/// What the sheet is made of.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Cloth {
    /// The same in every direction.
    Isotropic(Law),
    /// Woven: stiff along warp and weft.
    Orthotropic(Orthotropic),
}

/// A membrane's material.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sheet {
    /// What it is made of.
    pub cloth: Cloth,
    /// Whether it gives way to compression by wrinkling (cloth, thin rubber), or carries it.
    pub wrinkles: bool,
    /// The part of the unrelaxed stiffness that a wrinkled or slack sheet keeps, so that its nodes know where to stay: 1e-6 of it moves
    /// forces by less than 1e-6.
    pub residual: f64,
}

/// Energy per unit area with stress and tangent over Green's strain in the order 11, 22, 2 x 12.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Plane {
    pub(crate) w: f64,
    pub(crate) s: [f64; 3],
    pub(crate) d: [[f64; 3]; 3],
    pub(crate) tension: Tension,
}

impl Sheet {
    /// At the right Cauchy-Green tensor C = (C11, C22, C12).
    #[inline]
    pub(crate) fn plane(&self, c: [f64; 3]) -> Plane {
        match &self.cloth {
            Cloth::Isotropic(law) => spectral(c, |c1, c2| self.principal_of(law, c1, c2)),
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

    /// At squared stretches along the sheet's own axes, where there is no shear: a membrane of revolution.
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

/// An isotropic energy w(c1, c2) at a tensor C with eigenvalues c1 >= c2 and their directions:
///
/// ```text
/// S_i = 2 w_i     dS_i/dE_j = 4 w_ij     dS_12/d(2 E_12) = (S_1 - S_2)/(c1 - c2), or 2 (w_11 - w_12) where c1 = c2
/// ```
#[inline]
fn spectral(c: [f64; 3], energy: impl Fn(f64, f64) -> Principal) -> Plane {
    let (mean, half, off) = (0.5 * (c[0] + c[1]), 0.5 * (c[0] - c[1]), c[2]);
    let radius = half.hypot(off);
    let (c1, c2) = (mean + radius, mean - radius);
    // cos and sin of twice the angle of the first direction.
    let (cos2, sin2) = if radius > 1e-14 * mean.abs() { (half / radius, off / radius) } else { (1.0, 0.0) };
    let Principal { energy: e, tension } = energy(c1, c2);
    let (s1, s2) = (2.0 * e.w1, 2.0 * e.w2);
    let shear = if radius > 1e-6 * mean {
        (s1 - s2) / (2.0 * radius)
    } else {
        // The mean of the two sides' derivatives, where they are the same up to O(radius).
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
