//! The volume of a muscle of inextensible fibres from its dimensions alone: a cylinder for a braid, circular
//! meridians for a pleated muscle.

use bulge_numerics::Real;

use crate::effect::{Jet, Setting};

/// Below this contraction the volume of a pleated muscle is held constant. Its slope grows without bound
/// towards 0, which real fibres never reach because they stretch by about as much.
const LEAST_CONTRACTION: f64 = 1e-3;

/// Lower limit of sin^2 of the braid angle. A braid drawn straight has no volume left.
const LEAST_SINE_SQUARED: f64 = 1e-3;

/// The volume divided by that at contraction 0, and its relative slope.
#[derive(Debug, Clone, Copy)]
pub(crate) struct IdealVolume {
    /// V/V0.
    pub(crate) ratio: Jet,
    /// (dV/d eps)/V.
    pub(crate) growth: Jet,
}

impl IdealVolume {
    /// The volume at a contraction.
    ///
    /// ```text
    /// braided:  V ~ (1 - eps) (1 - cos^2(a0) (1 - eps)^2)
    /// pleated:  meridian an arc of half-angle b with sin(b)/b = 1 - eps, which meets the fittings at the radius R
    /// ```
    /// Compared with the equilibrium of the shipped muscles, the slope is accurate to 1 % up to 20 % and 6 %
    /// too small at 35 % (pleated). It is 7 % too large at 10 % and 17 % too large at 25 % (clamped braid of
    /// 250 mm, whose ends hold gas back). The force is smallest where the error is largest.
    pub(crate) fn at(contraction: Jet, setting: &Setting) -> Self {
        if setting.is_pleated() {
            Self::barrel(contraction, setting.radius / setting.length)
        } else {
            Self::cylinder(contraction, setting.braid_angle.cos())
        }
    }

    fn cylinder(contraction: Jet, cosine: f64) -> Self {
        let stretch = -contraction + 1.0;
        let sine_squared = -(stretch * cosine).squared() + 1.0;
        let at_rest = (1.0 - cosine * cosine).max(LEAST_SINE_SQUARED);
        if sine_squared.value() < LEAST_SINE_SQUARED {
            // The braid angle is held here, so that only the length changes.
            return Self {
                ratio: stretch * (LEAST_SINE_SQUARED / at_rest),
                growth: Jet::from(-1.0) / stretch,
            };
        }
        let ratio = stretch * sine_squared / at_rest;
        let growth = Jet::from(-1.0) / stretch + stretch * (2.0 * cosine * cosine) / sine_squared;
        Self { ratio, growth }
    }

    /// Lengths are relative to l0. The arc of radius a = 1/(2 b) about a centre at d = R - a cos(b) from the
    /// axis encloses V/pi = 2 d^2 a sin(b) + 2 d a^2 (b + sin(b) cos(b)) + a^3 (2 sin(b) - 2/3 sin^3(b)).
    fn barrel(contraction: Jet, end_radius: f64) -> Self {
        let held = contraction.value() < LEAST_CONTRACTION;
        let contraction = if held { Jet::from(LEAST_CONTRACTION) } else { contraction };
        let (angle, angle_slope) = half_angle(contraction);
        let (s, c) = angle.sin_cos();
        let a = Jet::from(0.5) / angle;
        let a_slope = -a / angle;
        let d = -a * c + end_radius;
        let d_slope = a * (s + c / angle);
        let sector = angle + s * c;
        let cap = s * 2.0 - s.powi(3) * (2.0 / 3.0);
        let volume = d.squared() * a * s * 2.0 + d * a.squared() * sector * 2.0 + a.powi(3) * cap;
        let slope = d * d_slope * a * s * 4.0
            + d.squared() * (a_slope * s + a * c) * 2.0
            + (d_slope * a + d * a_slope * 2.0) * a * sector * 2.0
            + d * a.squared() * c.squared() * 4.0
            + a.squared() * a_slope * cap * 3.0
            + a.powi(3) * c.powi(3) * 2.0;
        Self { ratio: volume / (end_radius * end_radius), growth: slope * angle_slope / volume }
    }
}

/// The angle b with sin(b)/b = 1 - eps, and db/d eps, by Newton's method.
/// The largest angle is b = 3.11, at 1 - eps = 0.01.
fn half_angle(contraction: Jet) -> (Jet, Jet) {
    let chord = (1.0 - contraction.value()).max(0.01);
    let slope = |b: f64| (b * b.cos() - b.sin()) / (b * b);
    let mut angle = (6.0 * (1.0 - chord)).sqrt();
    for _ in 0..40 {
        let step = (angle.sin() / angle - chord) / slope(angle);
        angle -= step;
        if step.abs() <= 1e-15 * angle {
            break;
        }
    }
    // db/d eps = -1/(sin(b)/b)', and its own derivative by b uses (sin(b)/b)'' = -sin(b)/b - 2/b (sin(b)/b)'.
    let first = slope(angle);
    let second = -angle.sin() / angle - 2.0 / angle * first;
    let by_contraction = -1.0 / first;
    let angle = contraction.chain(angle, by_contraction);
    (angle, angle.chain(by_contraction, second / (first * first)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_fibre::{Approach, Given, Problem};
    use bulge_muscles::{Pressure, preset};

    #[test]
    fn cylinder_by_hand() {
        // At a0 = 25 deg and eps = 10 % the ratio is 0.9 (1 - 0.821394 0.81)/(1 - 0.821394) = 1.686414, and
        // the growth is -1/0.9 + 2 0.821394 0.9/0.334671 = 3.306687.
        let found = IdealVolume::cylinder(Jet::variable(0.1, 0), 25_f64.to_radians().cos());
        assert!((found.ratio.value() - 1.686_414).abs() < 1e-6, "{}", found.ratio.value());
        assert!((found.growth.value() - 3.306_687).abs() < 1e-6, "{}", found.growth.value());
        assert!((found.ratio.gradient()[0] / found.ratio.value() - found.growth.value()).abs() < 1e-12);
    }

    #[test]
    fn barrel_is_a_cylinder_at_rest_and_a_sphere_when_round() {
        // Half a turn of fibre without fittings: the arc of b = pi/2 is a half circle, and V = 4/3 pi
        // (1/pi)^3 for l0 = 1.
        let contraction = 1.0 - 2.0 / std::f64::consts::PI;
        let small = 1e-9;
        let round = IdealVolume::barrel(Jet::from(contraction), small).ratio.value() * small * small;
        assert!((round / (4.0 / 3.0 / std::f64::consts::PI.powi(3)) - 1.0).abs() < 1e-7);
        // Nearly straight: V/V0 = 1 + (8/3) (b/4)/R up to order b^2, with b = sqrt(6 eps).
        let near = IdealVolume::barrel(Jet::from(1e-3), 1.0).ratio.value();
        let b = 6e-3_f64.sqrt();
        assert!((near - (1.0 - 1e-3) * (1.0 + b / 3.0 + b * b / 30.0)).abs() < 2e-5, "{near}");
    }

    #[test]
    fn growth_is_the_slope_of_the_ratio() {
        for contraction in [2e-3, 0.01, 0.1, 0.3, 0.5] {
            let found = IdealVolume::barrel(Jet::variable(contraction, 0), 0.15);
            let growth = found.ratio.gradient()[0] / found.ratio.value();
            assert!((growth / found.growth.value() - 1.0).abs() < 1e-9, "{contraction}");
        }
        let held = IdealVolume::barrel(Jet::variable(-0.02, 0), 0.15);
        assert_eq!((held.ratio.gradient()[0], held.growth.gradient()[0]), (0.0, 0.0));
        let drawn = IdealVolume::cylinder(Jet::variable(-0.12, 0), 0.95);
        assert!((drawn.ratio.gradient()[0] / drawn.ratio.value() - drawn.growth.value()).abs() < 1e-12);
    }

    #[test]
    fn it_is_near_the_equilibrium() {
        // Contractions, and the allowed relative error of (dV/d eps)/V there. A clamped braid keeps part of
        // its volume in its ends, so its volume grows more slowly than that of the cylinder.
        let pleated = [(0.01, 0.002), (0.05, 0.004), (0.1, 0.006), (0.2, 0.012), (0.35, 0.065)];
        let braided = [(0.0, 1e-6), (0.05, 0.04), (0.1, 0.07), (0.15, 0.095), (0.25, 0.17)];
        for (name, points) in [("ppam-2-r16", pleated), ("ppam-2-r11.5", pleated), ("dmsp-20-250", braided)] {
            let muscle = preset(name).unwrap();
            let setting = Setting::of(&muscle);
            let problem = Problem::new(&muscle, Pressure::bar(2.0)).unwrap();
            for (contraction, tolerance) in points {
                let exact = problem.solve(Given::Contraction(contraction), Approach::Auto).unwrap();
                let growth = -exact.volume_slope_m2 * setting.length / exact.volume_polygon_m3;
                let found = IdealVolume::at(Jet::from(contraction), &setting).growth.value();
                assert!((found / growth - 1.0).abs() < tolerance, "{name} {contraction} {found} {growth}");
            }
        }
    }
}
