//! Area of a cross-section on which the pressure acts, from the geometry of each muscle alone.

use bulge_muscles::{Kind, Muscle, Parameter};
use std::f64::consts::{FRAC_PI_2, PI};

/// A(r) \[m^2\] with the fibres at the radius r \[m\].
pub(crate) fn area(muscle: &Muscle, r: f64) -> f64 {
    let number = |parameter| muscle.get(parameter).unwrap_or(0.0);
    let (depth, gas) = (number(Parameter::PleatDepth), number(Parameter::GasWall));
    match (muscle.kind(), muscle.fibres()) {
        (Kind::Pleated, Some(n)) => {
            let (n, crest) = (f64::from(n), r + depth);
            let Some(cloth) = muscle.get(Parameter::ClothCircumference) else {
                return 0.5 * n * (2.0 * PI / n).sin() * crest * crest;
            };
            n * panel(PI / n, cloth / n, crest)
        }
        (Kind::Pleated, None) => PI * (r + depth).powi(2),
        (Kind::Braided, _) => PI * (r - gas).powi(2),
    }
}

/// Area between the axis, two fibres at radius r on planes at +-`half` from the middle, and the arc of cloth
/// of length s between them. If the arc is too long to stay between the planes, it touches them, and the rest
/// of the cloth lies on them.
fn panel(half: f64, s: f64, r: f64) -> f64 {
    // Half-opening of an arc from plane to plane, by bisection: the arc gets longer as it opens.
    let arc = |opening: f64| 2.0 * r * half.sin() * opening / opening.sin();
    let tangent = FRAC_PI_2 + half;
    let (opening, start) = if arc(tangent) < s {
        // 2 (a - r) + 2 a tan(half) tangent = s
        (tangent, (0.5 * s + r) / (1.0 + half.tan() * tangent))
    } else {
        let (mut low, mut high) = (0.0, tangent);
        while high - low > 1e-16 * tangent {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if arc(middle) < s { low = middle } else { high = middle }
        }
        (0.5 * (low + high), r)
    };
    let radius = start * half.sin() / opening.sin();
    // Two triangles up to the chord, and the segment beyond it.
    start * start * half.sin() * half.cos() + radius * radius * (opening - 0.5 * (2.0 * opening).sin())
}
