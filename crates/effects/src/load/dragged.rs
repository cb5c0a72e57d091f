//! Dahl's friction: a traction that is drawn towards its limit in the direction of the motion.

use bulge_numerics::Real;

use crate::effect::Jet;

/// The traction at the end of a step; `limit` > 0 is the largest one, `travel` > 0 the way on which it is reached but for 1/e.
///
/// ```text
/// z -> s L + (z - s L) exp(-|step|/travel),    s = sign(step)
/// ```
/// Exact, whatever the size of the step.
pub(crate) fn dragged(held: Jet, step: Jet, travel: Jet, limit: Jet) -> Jet {
    if step.value() == 0.0 {
        return held;
    }
    let s = step.value().signum();
    let fades = (-(step * s / travel)).exp();
    (held - limit * s) * fades + limit * s
}
