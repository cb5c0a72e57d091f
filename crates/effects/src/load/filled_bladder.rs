//! The stretch of a braid's bladder by the contraction and, at low pressure, by the gas that fills it out.

use bulge_numerics::Real;

use crate::effect::{Balance, Jet, Setting};
use crate::material::tube::Tube;

/// The pressure at which the gas has filled out the bladder by 76 % \[Pa\]. Muscles of 20 mm would push below
/// 0.5 to 1.5 bar at 4 to 16 %.
const TAUT: f64 = 1e5;
/// Lower limit of the scale of the force. At 45 deg the hoop shrinks as fast as the axis grows, and the scale
/// would be 0.
const LEAST_SCALE: f64 = 0.1;

/// The axial force of a neo-Hookean tube in a cylindrical braid, relative to the largest force for its
/// modulus and wall, times the degree to which the gas has filled it.
///
/// ```text
/// b = -(dW/d l1)/(cot^2 alpha0 - 1) tanh(p/1 bar)
/// W = (l1^2 + l2^2 + 1/(l1 l2)^2)/2,   l1 = 1 - eps,   l2^2 = (1 - l1^2 cos^2 alpha0)/sin^2 alpha0
/// ```
/// The sign is chosen such that b grows from 0 while the muscle shortens from rest.
pub(super) fn filled(balance: &Balance, setting: &Setting) -> Jet {
    let Some(Tube { hoop, slope }) = Tube::at(balance.contraction, setting) else { return Jet::from(0.0) };
    let axial = -balance.contraction + 1.0;
    let product = axial * hoop;
    let product_slope = hoop + axial * slope;
    let energy_slope = axial + hoop * slope - product_slope / (product * product * product);
    let largest = (1.0 / setting.braid_angle.tan().powi(2) - 1.0).abs().max(LEAST_SCALE);
    -energy_slope / largest * (balance.pressure / TAUT).tanh()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::{SETTING, balance};

    #[test]
    fn the_force_of_a_bladder_in_a_braid_of_25_degrees() {
        // b is compared with the derivative of W by central differences. It is 0 at rest length.
        let energy = |eps: f64| {
            let (sin, cos) = SETTING.braid_angle.sin_cos();
            let l1 = 1.0 - eps;
            let l2 = (1.0 - (l1 * cos).powi(2)) / (sin * sin);
            0.5 * (l1 * l1 + l2 + 1.0 / (l1 * l1 * l2))
        };
        let largest = 1.0 / SETTING.braid_angle.tan().powi(2) - 1.0;
        for eps in [0.0, 0.02, 0.1, 0.2] {
            let found = filled(&balance(eps), &SETTING).value();
            let expected = (energy(eps + 1e-6) - energy(eps - 1e-6)) / 2e-6 / largest * 2.0_f64.tanh();
            assert!((found - expected).abs() < 1e-8, "{eps}: {found} {expected}");
        }
        let at = |eps: f64| filled(&balance(eps), &SETTING).value();
        // An independent solution with clamped ends gives 28, 154, 194 and 204 N at 0.5, 5, 10 and 15 %. The
        // shapes agree within 12 %.
        for (eps, force) in [(0.05, 154.0), (0.1, 194.0), (0.15, 204.0)] {
            assert!(
                (at(eps) / at(0.15) / (force / 204.0) - 1.0).abs() < 0.12,
                "{eps} {}",
                at(eps) / at(0.15)
            );
        }
    }
}
