//! Dahl's friction: the traction approaches its limit in the direction of the motion.

use bulge_numerics::Real;

use crate::effect::Jet;

/// The traction at the end of a step. `limit` > 0 is the largest traction. `travel` > 0 is the distance over
/// which the difference from the limit falls to 1/e.
///
/// ```text
/// z -> s L + (z - s L) exp(-|step|/travel),    s = sign(step)
/// ```
/// This is exact for steps of any size.
pub(crate) fn dragged(held: Jet, step: Jet, travel: Jet, limit: Jet) -> Jet {
    if step.value() == 0.0 {
        return held;
    }
    let s = step.value().signum();
    let fades = (-(step * s / travel)).exp();
    (held - limit * s) * fades + limit * s
}
