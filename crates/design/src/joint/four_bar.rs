//! A four-bar linkage between the joint and a crank on which a muscle pulls.
//!
//! ```text
//! crank a on the pivot O, joint's axis at (d, 0), rocker c on the moving link at psi = psi_0 + theta, coupler b between their ends:
//!
//! P(psi) = (d + c cos(psi), c sin(psi))        g = a^2 + P.P - 2 a (Px cos(phi) + Py sin(phi)) - b^2 = 0
//! phi'  = -g_psi/g_phi                         phi'' = -(g_psipsi + 2 g_phipsi phi' + g_phiphi phi'^2)/g_phi
//! ```
//! The turn of the crank, chi = phi - phi(psi_0), is positive for rising angles of the joint, so that a
//! positive angle shortens the agonist.

use serde::Serialize;

/// Links of a four-bar linkage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FourBar {
    /// Distance from the pivot of the crank to the axis of the joint, d \[m\].
    pub ground: f64,
    /// Length of the crank, a \[m\].
    pub crank: f64,
    /// Length of the coupler, b \[m\].
    pub coupler: f64,
    /// Distance from the axis of the joint to the end of the coupler on the moving link, c \[m\].
    pub rocker: f64,
    /// Angle psi_0 at the joint angle 0 between the rocker and the line from the pivot of the crank through
    /// the axis of the joint \[rad\].
    pub rocker_angle: f64,
    /// Selects one of the two ways in which the links close: the one in which the coupler crosses that line.
    pub is_crossed: bool,
}

/// Turn of the crank and its derivatives with respect to the joint angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    /// chi \[rad\].
    pub(super) angle: f64,
    /// dchi/dtheta.
    pub(super) ratio: f64,
    /// d2chi/dtheta2 \[1/rad\].
    pub(super) bend: f64,
}

/// Smallest sine of the angle between crank and coupler. Closer to their dead centre the links can't carry.
const LEAST_SINE: f64 = 1e-3;

impl FourBar {
    /// phi, phi' and phi'' at psi; `None` if the links don't reach, or at a dead centre.
    fn crank_at(&self, psi: f64) -> Option<[f64; 3]> {
        let Self { ground: d, crank: a, coupler: b, rocker: c, is_crossed, .. } = *self;
        let (sin, cos) = psi.sin_cos();
        let (p, p1, p2) = ([d + c * cos, c * sin], [-c * sin, c * cos], [-c * cos, -c * sin]);
        let square = p[0] * p[0] + p[1] * p[1];
        let between = (a * a + square - b * b) / (2.0 * a * square.sqrt());
        // A NaN is refused as well.
        if between.is_nan() || between.abs() >= 1.0 {
            return None;
        }
        let open = if is_crossed { -between.acos() } else { between.acos() };
        let phi = p[1].atan2(p[0]) + open;
        let (s, k) = phi.sin_cos();
        let along = |v: [f64; 2]| v[0] * k + v[1] * s;
        let across = |v: [f64; 2]| v[0] * s - v[1] * k;
        let dot = |v: [f64; 2], w: [f64; 2]| v[0] * w[0] + v[1] * w[1];
        let g_phi = 2.0 * a * across(p);
        // 2 a |P| sin(phi - beta) equals 2 a b times the sine of the angle between crank and coupler.
        if g_phi.abs() < 2.0 * a * b * LEAST_SINE {
            return None;
        }
        let g_psi = 2.0 * dot(p, p1) - 2.0 * a * along(p1);
        let first = -g_psi / g_phi;
        let g_psi_psi = 2.0 * (dot(p1, p1) + dot(p, p2)) - 2.0 * a * along(p2);
        let (g_phi_psi, g_phi_phi) = (2.0 * a * across(p1), 2.0 * a * along(p));
        let second = -(g_psi_psi + 2.0 * g_phi_psi * first + g_phi_phi * first * first) / g_phi;
        Some([phi, first, second])
    }

    /// Turn of the crank at a joint angle \[rad\]; `None` if the links don't close.
    pub(super) fn turn(&self, angle: f64) -> Option<Turn> {
        let [rest, ratio, _] = self.crank_at(self.rocker_angle)?;
        let [phi, first, second] = self.crank_at(self.rocker_angle + angle)?;
        let sign = ratio.signum();
        // Relative to the angle at rest, reduced to less than half a turn.
        let turn =
            (phi - rest + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        Some(Turn { angle: sign * turn, ratio: sign * first, bend: sign * second })
    }

    /// The first angle of a range, from 0 outwards, at which the links don't close or the crank stands still;
    /// `None` if there is none.
    pub(super) fn fault(&self, [low, high]: [f64; 2]) -> Option<f64> {
        const STEPS: u32 = 400;
        let works = |angle: f64| self.turn(angle).is_some_and(|turn| turn.ratio > 1e-3);
        (0..=STEPS)
            .flat_map(|k| {
                let part = f64::from(k) / f64::from(STEPS);
                [part * low.min(0.0), part * high.max(0.0)]
            })
            .find(|angle| !works(*angle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BAR: FourBar = FourBar {
        ground: 0.1,
        crank: 0.04,
        coupler: 0.09,
        rocker: 0.05,
        rocker_angle: 2.0,
        is_crossed: false,
    };

    /// On both branches, the distance between the ends of crank and rocker equals the coupler length; slopes
    /// are compared with differences.
    #[test]
    fn the_links_keep_their_lengths() {
        for is_crossed in [false, true] {
            let bar = FourBar { is_crossed, ..BAR };
            let mut last = None;
            for k in -40..=40 {
                let angle = 0.01 * f64::from(k);
                let psi = bar.rocker_angle + angle;
                let [phi, first, second] = bar.crank_at(psi).unwrap();
                let (x, y) = (0.1 + 0.05 * psi.cos() - 0.04 * phi.cos(), 0.05 * psi.sin() - 0.04 * phi.sin());
                assert!((x.hypot(y) - 0.09).abs() < 1e-15);
                let h = 1e-5;
                let [up, down] = [psi + h, psi - h].map(|psi| bar.crank_at(psi).unwrap());
                assert!((first - (up[0] - down[0]) / (2.0 * h)).abs() < 1e-8);
                assert!((second - (up[1] - down[1]) / (2.0 * h)).abs() < 1e-7);
                let turn = bar.turn(angle).unwrap();
                assert!(turn.ratio > 0.0 && last.is_none_or(|before| turn.angle > before));
                last = Some(turn.angle);
            }
            assert!(bar.turn(0.0).unwrap().angle.abs() < 1e-15);
        }
    }

    /// In a parallelogram the crank turns as the joint does.
    #[test]
    fn a_parallelogram_is_no_gear() {
        let bar = FourBar {
            ground: 0.1,
            crank: 0.04,
            coupler: 0.1,
            rocker: 0.04,
            rocker_angle: 1.5,
            is_crossed: false,
        };
        for angle in [-0.6, -0.1, 0.0, 0.4, 0.9] {
            let Turn { angle: turn, ratio, bend } = bar.turn(angle).unwrap();
            assert!((turn - angle).abs() < 1e-12 && (ratio - 1.0).abs() < 1e-12 && bend.abs() < 1e-11);
        }
    }

    #[test]
    fn links_that_do_not_reach_are_found() {
        assert_eq!(BAR.fault([-0.4, 0.4]), None);
        let at = BAR.fault([-0.4, 2.5]).unwrap();
        assert!(at > 0.4 && at < 2.5);
        let short = FourBar { coupler: 0.01, ..BAR };
        assert_eq!((short.turn(0.0), short.fault([-0.1, 0.1])), (None, Some(0.0)));
    }
}
