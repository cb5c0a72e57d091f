//! The bladder as a tube that follows a cylindrical braid: its hoop stretch, and the derivative of that by
//! the axial stretch.

use bulge_numerics::Real;

use crate::effect::{Jet, Setting};

/// Lower limit of the square of the hoop stretch. There the braid is drawn out to a third of its radius, and
/// inextensible fibres are nearly straight.
const LEAST: f64 = 0.1;

/// Hoop stretch of a tube inside a braid.
///
/// ```text
/// l1 = 1 - eps,   l2 = r/r0 = sqrt(1 - l1^2 cos^2(alpha0))/sin(alpha0),   dl2/dl1 = -l1 cot^2(alpha0)/l2
/// ```
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tube {
    /// l2.
    pub(crate) hoop: Jet,
    /// dl2/dl1.
    pub(crate) slope: Jet,
}

impl Tube {
    /// The stretch at a contraction; none without a braid angle.
    pub(crate) fn at(contraction: Jet, setting: &Setting) -> Option<Self> {
        let (sin, cos) = setting.braid_angle.sin_cos();
        if sin <= 0.0 || cos <= 0.0 {
            return None;
        }
        let axial = -contraction + 1.0;
        let square = (-(axial * axial * (cos * cos)) + 1.0) / (sin * sin);
        let square = if square.value() < LEAST { Jet::from(LEAST) } else { square };
        let hoop = square.sqrt();
        Some(Self { hoop, slope: -(axial * (cos * cos / (sin * sin)) / hoop) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::SETTING;

    #[test]
    fn the_slope_is_the_derivative_and_no_stretch_is_none() {
        let rest = Tube::at(Jet::from(0.0), &SETTING).unwrap();
        let cot = 1.0 / 25.0_f64.to_radians().tan();
        assert!((rest.hoop.value() - 1.0).abs() < 1e-14 && (rest.slope.value() + cot * cot).abs() < 1e-13);
        for contraction in [-0.08, 0.1, 0.3] {
            let tube = Tube::at(Jet::variable(contraction, 0), &SETTING).unwrap();
            assert!((tube.hoop.gradient()[0] + tube.slope.value()).abs() < 1e-12);
        }
        // The fibres of S5's muscle at 20 %: sin(theta)/sin(alpha0).
        let sin = (1.0_f64 - (0.8 * 25.0_f64.to_radians().cos()).powi(2)).sqrt();
        let found = Tube::at(Jet::from(0.2), &SETTING).unwrap().hoop.value();
        assert!((found - sin / 25.0_f64.to_radians().sin()).abs() < 1e-14);
    }

    #[test]
    fn a_number_beyond_the_longest_braid_and_none_without_angle() {
        assert!(Tube::at(Jet::from(-0.5), &SETTING).unwrap().slope.value().is_finite());
        assert!(Tube::at(Jet::from(0.1), &Setting { braid_angle: 0.0, ..SETTING }).is_none());
    }
}
