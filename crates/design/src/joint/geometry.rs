//! Geometry of muscles on a joint: a pulley, levers by the law of cosines, or either of them on the crank of
//! a four-bar linkage.

use serde::Serialize;

use super::four_bar::{FourBar, Turn};

/// One of the two muscles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The muscle that a positive angle shortens.
    Agonist,
    /// The muscle that a positive angle lengthens.
    Antagonist,
}

impl Side {
    /// Its name in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Agonist => "agonist",
            Self::Antagonist => "antagonist",
        }
    }

    /// Sign of the angle that shortens the muscle: 1 or -1.
    pub(super) const fn sign(self) -> f64 {
        match self {
            Self::Agonist => 1.0,
            Self::Antagonist => -1.0,
        }
    }
}

/// Linkage that converts the pull of both muscles into torques. That of the antagonist is the mirror image of
/// that of the agonist.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Linkage {
    /// Belts on a pulley: l = l(0) - r theta.
    Pulley {
        /// Its radius r \[m\].
        radius: f64,
    },
    /// Levers: l = sqrt(a^2 + b^2 - 2 a b cos(phi)) minus a rigid part, phi = phi(0) - theta.
    Lever {
        /// Distance from the axis of the joint to the attachment on the moving link, a \[m\].
        arm: f64,
        /// Distance from the axis of the joint to the attachment on the base, b \[m\].
        base: f64,
        /// Angle phi(0) between both at the joint angle 0 \[rad\].
        lever_angle: f64,
    },
    /// A four-bar linkage from the joint to a crank on which the muscle pulls.
    FourBar {
        /// Its links.
        bar: FourBar,
        /// Linkage between the muscle and the crank.
        drive: Box<Linkage>,
    },
}

/// Kinematics of a muscle at an angle of the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reach {
    /// l(0) - l(theta) \[m\].
    pub(super) shortening: f64,
    /// Lever arm -dl/dtheta, the torque per force \[m\]; negative for the antagonist.
    pub(super) arm: f64,
    /// Derivative of the lever arm with respect to the angle \[m/rad\].
    pub(super) arm_by_angle: f64,
}

impl Linkage {
    /// Kinematics of a muscle at an angle \[rad\].
    ///
    /// ```text
    /// d^2 = a^2 + b^2 - 2 a b cos(phi),   dd/dphi = g = a b sin(phi)/d,   dg/dphi = a b cos(phi)/d - g^2/d
    /// ```
    pub(super) fn at(&self, side: Side, angle: f64) -> Reach {
        let sign = side.sign();
        match *self {
            Self::Pulley { radius } => {
                Reach { shortening: sign * radius * angle, arm: sign * radius, arm_by_angle: 0.0 }
            }
            Self::Lever { arm, base, lever_angle } => {
                let phi = lever_angle - sign * angle;
                let distance = distance(arm, base, phi);
                let (sin, cos) = phi.sin_cos();
                let by_phi = arm * base * sin / distance;
                // d(0) - d is computed without cancellation, as the difference of the squares divided by the
                // sum.
                let half = 2.0 * f64::midpoint(lever_angle, phi).sin() * (0.5 * (lever_angle - phi)).sin();
                let sum = self::distance(arm, base, lever_angle) + distance;
                Reach {
                    shortening: 2.0 * arm * base * half / sum,
                    arm: sign * by_phi,
                    arm_by_angle: (by_phi * by_phi - arm * base * cos) / distance,
                }
            }
            Self::FourBar { bar, ref drive } => {
                // The links of the antagonist are the mirror image, so its turn is -chi(-theta). Outside the
                // checked range the result is NaN.
                let still = Turn { angle: f64::NAN, ratio: f64::NAN, bend: f64::NAN };
                let Turn { angle: turn, ratio, bend } = bar.turn(sign * angle).unwrap_or(still);
                let there = drive.at(side, sign * turn);
                Reach {
                    shortening: there.shortening,
                    arm: there.arm * ratio,
                    arm_by_angle: there.arm_by_angle * ratio * ratio + there.arm * sign * bend,
                }
            }
        }
    }

    /// Angle between the attachments of a lever at the angle 0 \[rad\], and their distance \[m\]; none for a
    /// pulley.
    pub(super) fn lever(&self) -> Option<[f64; 2]> {
        match *self {
            Self::Pulley { .. } => None,
            Self::Lever { arm, base, lever_angle } => Some([lever_angle, distance(arm, base, lever_angle)]),
            Self::FourBar { ref drive, .. } => drive.lever(),
        }
    }
}

/// Law of cosines, without cancellation if the attachments are close to each other.
fn distance(arm: f64, base: f64, phi: f64) -> f64 {
    let sin = (0.5 * phi).sin();
    (arm - base).hypot(2.0 * (arm * base).sqrt() * sin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levers_follow_the_law_of_cosines() {
        let (a, b, phi) = (0.04_f64, 0.15_f64, 1.3_f64);
        let lever = Linkage::Lever { arm: a, base: b, lever_angle: phi };
        let d = |phi: f64| (a * a + b * b - 2.0 * a * b * phi.cos()).sqrt();
        assert!((lever.lever().unwrap()[1] - d(phi)).abs() < 1e-15);
        for angle in [-0.9, -0.3, 0.0, 1e-6, 0.4, 1.1] {
            for (side, sign) in [(Side::Agonist, 1.0), (Side::Antagonist, -1.0)] {
                let at = |angle: f64| lever.at(side, angle);
                let found = at(angle);
                assert!((found.shortening - (d(phi) - d(phi - sign * angle))).abs() < 1e-15);
                let h = 1e-5;
                let slope = (at(angle + h).shortening - at(angle - h).shortening) / (2.0 * h);
                assert!((found.arm - slope).abs() < 1e-9 && found.arm * sign > 0.0, "{found:?}");
                let bend = (at(angle + h).arm - at(angle - h).arm) / (2.0 * h);
                assert!((found.arm_by_angle - bend).abs() < 1e-9, "{found:?} {bend}");
            }
        }
        // The lever arm is the height over the line between the attachments.
        let right = Linkage::Lever { arm: 0.03, base: 0.04, lever_angle: std::f64::consts::FRAC_PI_2 };
        assert!((right.at(Side::Agonist, 0.0).arm - 0.024).abs() < 1e-15);
    }

    /// Shortening, lever arm and its slope with a four-bar linkage, for both muscles, and the antagonist as
    /// the mirror image.
    #[test]
    fn a_four_bar_linkage_gears_the_arm() {
        let bar = FourBar {
            ground: 0.1,
            crank: 0.04,
            coupler: 0.09,
            rocker: 0.05,
            rocker_angle: 2.0,
            is_crossed: false,
        };
        let lever = Linkage::Lever { arm: 0.03, base: 0.16, lever_angle: 1.4 };
        for drive in [Linkage::Pulley { radius: 0.02 }, lever.clone()] {
            let linkage = Linkage::FourBar { bar, drive: Box::new(drive) };
            for angle in [-0.35, -0.1, 0.0, 0.2, 0.38] {
                for side in [Side::Agonist, Side::Antagonist] {
                    let at = |angle: f64| linkage.at(side, angle);
                    let found = at(angle);
                    let h = 1e-5;
                    let [up, down] = [at(angle + h), at(angle - h)];
                    assert!((found.arm - (up.shortening - down.shortening) / (2.0 * h)).abs() < 1e-9);
                    assert!((found.arm_by_angle - (up.arm - down.arm) / (2.0 * h)).abs() < 1e-8);
                    assert!(found.arm * side.sign() > 0.0);
                }
                let (one, other) = (linkage.at(Side::Agonist, angle), linkage.at(Side::Antagonist, -angle));
                assert!(
                    (one.shortening - other.shortening).abs() < 1e-15 && (one.arm + other.arm).abs() < 1e-15
                );
            }
        }
        // A parallelogram has the ratio 1.
        let bar = FourBar { coupler: 0.1, rocker: 0.04, ..bar };
        let geared = Linkage::FourBar { bar, drive: Box::new(lever.clone()) };
        for angle in [-0.3, 0.25] {
            let [one, other] = [&geared, &lever].map(|linkage| linkage.at(Side::Antagonist, angle));
            assert!((one.shortening - other.shortening).abs() < 1e-14 && (one.arm - other.arm).abs() < 1e-14);
        }
    }

    #[test]
    fn pulleys_are_mirrored() {
        let pulley = Linkage::Pulley { radius: 0.04 };
        let (one, other) = (pulley.at(Side::Agonist, 0.3), pulley.at(Side::Antagonist, -0.3));
        assert!(
            (one.shortening - 0.012).abs() < 1e-17 && one.shortening.to_bits() == other.shortening.to_bits()
        );
        assert_eq!((one.arm, other.arm, one.arm_by_angle), (0.04, -0.04, 0.0));
    }
}
