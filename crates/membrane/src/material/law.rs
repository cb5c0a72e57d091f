//! Isotropic laws in plane stress: energy per unit area over the squared principal stretches.
//!
//! | law | W/h over the stretches l1, l2 |
//! |---|---|
//! | Hencky | Y/(2 (1 - nu^2)) (e1^2 + e2^2 + 2 nu e1 e2), e = ln l |
//! | St Venant-Kirchhoff | the same with e = (l^2 - 1)/2 |
//! | neo-Hooke | mu/2 (I1 - 3) |
//! | Mooney-Rivlin | c1 (I1 - 3) + c2 (I2 - 3) |
//! | Gent | -mu J/2 ln(1 - (I1 - 3)/J) |
//!
//! The last three are incompressible: I1 = l1^2 + l2^2 + 1/(l1 l2)^2, I2 = 1/l1^2 + 1/l2^2 + (l1 l2)^2.

use serde::Serialize;

/// An isotropic law times the thickness of the sheet; all moduli are in N/m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Law {
    /// Quadratic in the logarithmic strain.
    Hencky {
        /// Y h.
        stiffness: f64,
        /// Poisson's ratio.
        poisson: f64,
    },
    /// Quadratic in Green's strain: for cloth, whose strains are small.
    SaintVenantKirchhoff {
        /// Y h.
        stiffness: f64,
        /// Poisson's ratio.
        poisson: f64,
    },
    /// Rubber at moderate stretches.
    NeoHooke {
        /// mu h.
        shear: f64,
    },
    /// Rubber at larger stretches.
    MooneyRivlin {
        /// c1 h.
        c1: f64,
        /// c2 h.
        c2: f64,
    },
    /// Rubber with finite chain extensibility: I1 stays below 3 + J.
    Gent {
        /// mu h.
        shear: f64,
        /// J.
        limit: f64,
    },
}

/// An energy and its derivatives by the squared principal stretches c1, c2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Energy {
    pub(crate) w: f64,
    pub(crate) w1: f64,
    pub(crate) w2: f64,
    pub(crate) w11: f64,
    pub(crate) w12: f64,
    pub(crate) w22: f64,
}

impl Law {
    /// Energy at the squared stretches; infinite beyond the limit of the law.
    #[inline]
    pub(crate) fn energy(&self, c1: f64, c2: f64) -> Energy {
        match *self {
            Self::Hencky { stiffness, poisson } => {
                if !(c1 > 0.0 && c2 > 0.0) {
                    return Energy { w: f64::INFINITY, ..Energy::default() };
                }
                let y = stiffness / (1.0 - poisson * poisson);
                let (e1, e2) = (0.5 * c1.ln(), 0.5 * c2.ln());
                // de/dc = 1/(2 c).
                let (d1, d2) = (0.5 / c1, 0.5 / c2);
                let (s1, s2) = (y * (e1 + poisson * e2), y * (e2 + poisson * e1));
                Energy {
                    w: 0.5 * (s1 * e1 + s2 * e2),
                    w1: s1 * d1,
                    w2: s2 * d2,
                    w11: y * d1 * d1 - s1 * d1 / c1,
                    w12: y * poisson * d1 * d2,
                    w22: y * d2 * d2 - s2 * d2 / c2,
                }
            }
            Self::SaintVenantKirchhoff { stiffness, poisson } => {
                let y = stiffness / (1.0 - poisson * poisson);
                let (e1, e2) = (0.5 * (c1 - 1.0), 0.5 * (c2 - 1.0));
                let (s1, s2) = (y * (e1 + poisson * e2), y * (e2 + poisson * e1));
                Energy {
                    w: 0.5 * (s1 * e1 + s2 * e2),
                    w1: 0.5 * s1,
                    w2: 0.5 * s2,
                    w11: 0.25 * y,
                    w12: 0.25 * y * poisson,
                    w22: 0.25 * y,
                }
            }
            Self::NeoHooke { shear } => rubber(0.5 * shear, 0.0, c1, c2),
            Self::MooneyRivlin { c1: first, c2: second } => rubber(first, second, c1, c2),
            Self::Gent { shear, limit } => {
                // W = -mu J/2 ln(1 - i/J), dW/di = mu/2 J/(J - i), d2W/di2 = mu/2 J/(J - i)^2 with i = I1 - 3.
                let i = rubber(1.0, 0.0, c1, c2);
                let left = limit - i.w;
                if left.is_nan() || left <= 0.0 {
                    return Energy { w: f64::INFINITY, ..Energy::default() };
                }
                let first = 0.5 * shear * limit / left;
                let second = first / left;
                Energy {
                    w: -0.5 * shear * limit * (-i.w / limit).ln_1p(),
                    w1: first * i.w1,
                    w2: first * i.w2,
                    w11: first * i.w11 + second * i.w1 * i.w1,
                    w12: first * i.w12 + second * i.w1 * i.w2,
                    w22: first * i.w22 + second * i.w2 * i.w2,
                }
            }
        }
    }

    /// Squared transverse stretch of an unsupported strip that is pulled to the squared stretch c, so that
    /// its transverse stress is zero.
    #[inline]
    pub(crate) fn natural_width(&self, c: f64) -> f64 {
        match *self {
            Self::Hencky { poisson, .. } => c.powf(-poisson),
            Self::SaintVenantKirchhoff { poisson, .. } => 1.0 - poisson * (c - 1.0),
            Self::NeoHooke { .. } | Self::MooneyRivlin { .. } | Self::Gent { .. } => 1.0 / c.sqrt(),
        }
    }

    /// Stiffness at small strains, N/m.
    #[cfg(test)]
    fn stiffness(&self) -> f64 {
        match *self {
            Self::Hencky { stiffness, .. } | Self::SaintVenantKirchhoff { stiffness, .. } => stiffness,
            Self::NeoHooke { shear } | Self::Gent { shear, .. } => 3.0 * shear,
            Self::MooneyRivlin { c1, c2 } => 6.0 * (c1 + c2),
        }
    }
}

/// `a` (I1 - 3) + `b` (I2 - 3).
#[inline]
fn rubber(a: f64, b: f64, c1: f64, c2: f64) -> Energy {
    if !(c1 > 0.0 && c2 > 0.0) {
        return Energy { w: f64::INFINITY, ..Energy::default() };
    }
    let (i1, i2) = (1.0 / c1, 1.0 / c2);
    let c3 = i1 * i2;
    Energy {
        w: a * (c1 + c2 + c3 - 3.0) + b * (i1 + i2 + c1 * c2 - 3.0),
        w1: a * (1.0 - c3 * i1) + b * (c2 - i1 * i1),
        w2: a * (1.0 - c3 * i2) + b * (c1 - i2 * i2),
        w11: 2.0 * (a * c3 * i1 * i1 + b * i1 * i1 * i1),
        w12: a * c3 * c3 + b,
        w22: 2.0 * (a * c3 * i2 * i2 + b * i2 * i2 * i2),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) const LAWS: [Law; 5] = [
        Law::Hencky { stiffness: 3.0, poisson: 0.3 },
        Law::SaintVenantKirchhoff { stiffness: 3.0, poisson: 0.4 },
        Law::NeoHooke { shear: 1.3 },
        Law::MooneyRivlin { c1: 0.6, c2: 0.2 },
        Law::Gent { shear: 1.3, limit: 30.0 },
    ];

    #[test]
    fn derivatives_are_those_of_the_energy() {
        let h = 1e-5;
        for law in LAWS {
            for (c1, c2) in [(1.0, 1.0), (1.7, 0.6), (0.8, 2.4), (3.0, 3.0)] {
                let e = law.energy(c1, c2);
                let d1 = |f: &dyn Fn(Energy) -> f64| {
                    (f(law.energy(c1 + h, c2)) - f(law.energy(c1 - h, c2))) / (2.0 * h)
                };
                let d2 = |f: &dyn Fn(Energy) -> f64| {
                    (f(law.energy(c1, c2 + h)) - f(law.energy(c1, c2 - h))) / (2.0 * h)
                };
                for (given, expected) in [
                    (e.w1, d1(&|e| e.w)),
                    (e.w2, d2(&|e| e.w)),
                    (e.w11, d1(&|e| e.w1)),
                    (e.w12, d1(&|e| e.w2)),
                    (e.w12, d2(&|e| e.w1)),
                    (e.w22, d2(&|e| e.w2)),
                ] {
                    assert!((given - expected).abs() < 1e-8 * (1.0 + expected.abs()), "{law:?} {c1} {c2}");
                }
            }
        }
    }

    #[test]
    fn a_strip_of_natural_width_has_no_stress_across() {
        for law in LAWS {
            for c in [1.05, 1.5, 3.0] {
                let width = law.natural_width(c);
                if width > 0.0 {
                    assert!(law.energy(c, width).w2.abs() < 1e-14, "{law:?} {c}");
                }
            }
        }
    }

    #[test]
    fn small_strains_see_the_stated_stiffness() {
        for law in LAWS {
            // Uniaxial: S = 2 dW/dc = Y h e.
            let c = 1.0 + 2e-6;
            let s = 2.0 * law.energy(c, law.natural_width(c)).w1;
            assert!((s / 1e-6 / law.stiffness() - 1.0).abs() < 1e-4, "{law:?}");
        }
    }

    #[test]
    fn a_law_ends_where_its_chains_end() {
        assert!(Law::Gent { shear: 1.0, limit: 2.0 }.energy(5.0, 1.0).w.is_infinite());
        assert!(Law::NeoHooke { shear: 1.0 }.energy(0.0, 1.0).w.is_infinite());
    }
}
