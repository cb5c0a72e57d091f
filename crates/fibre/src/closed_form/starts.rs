//! Where the search for a meridian begins.
//!
//! Two integrals give contraction and slenderness of an amplitude phi and a parameter m:
//!
//! ```text
//! eps = 2 m D/F        L = F/(sqrt(m) cos phi)        X = eps L^2 = 2 F D (1 + t^2)
//! t0^4 = X (1.5 + 0.98 sqrt(X) + 0.1643 X)            between t^4 = 3X/2 (flat) and t^2 = 4X/pi^2 (round)
//! ```
//!
//! The way back is fitted: t/t0 and F/atan(t0) are polynomials in `u = atan(t0)/(pi/2)` and `v = 2 eps` for m up to
//! 0.53 (`reference/starts.py`). Newton's method then needs two evaluations of the integrals, the second of which
//! only confirms.

use bulge_numerics::Lanes;
use bulge_numerics::root::illinois;
use std::f64::consts::FRAC_2_PI;

/// Relative change of the stretched length at which the starting values are as good as their fit.
const ENOUGH: f64 = 3e-3;
/// Largest contraction for which the fit is used. The force vanishes below it.
const MOST_CONTRACTION: f64 = 0.6;

/// tan(phi_R)/t0: the coefficient of v^j u^i is in row j at place i. Largest error 1.7e-6.
#[rustfmt::skip]
#[expect(clippy::unreadable_literal, reason = "as reference/starts.py writes them")]
const TANGENT: [&[f64]; 8] = [
    &[1.0000016975, -0.0000325969, 0.0006027538, -0.0053426745, 0.0229080878, -0.0431254448, 0.0442186127, -0.0192961382],
    &[-0.0880741663, 0.0053364085, -0.0784342255, 0.1036647623, -0.1959692333, 0.1606677720, -0.0634308029],
    &[-0.0028780183, -0.0531952491, 0.1329473380, -0.1795380433, 0.1329658616, -0.0425056965],
    &[-0.0246357176, 0.0984979793, -0.1625246690, 0.1192283334, -0.0324290456],
    &[0.0053826366, -0.0250720024, 0.0318283465, -0.0124292683],
    &[0.0015263618, -0.0028255754, 0.0011735970],
    &[-0.0005564869, 0.0005814940],
    &[-0.0000128180],
];
/// F/atan(t0), likewise. Largest error 8.7e-7.
#[rustfmt::skip]
#[expect(clippy::unreadable_literal, reason = "as reference/starts.py writes them")]
const LENGTH: [&[f64]; 8] = [
    &[0.9999991635, 0.0000050769, -0.0001802316, 0.0009674876, -0.0021437731, 0.0098293779, -0.0162194753, 0.0077415393],
    &[0.0377097908, -0.0014463644, 0.1045313558, -0.0236288488, 0.0326814553, -0.0376499545, 0.0128044240],
    &[0.0026671915, 0.0196882616, -0.0438218755, 0.0960653802, -0.0692966781, 0.0220141006],
    &[0.0139722518, -0.0413922810, 0.0413379607, 0.0000682300, -0.0070015731],
    &[-0.0082571379, 0.0334290395, -0.0437758327, 0.0200134670],
    &[-0.0006240238, 0.0031715850, -0.0014937942],
    &[-0.0007996525, 0.0004999359],
    &[0.0001914828],
];

/// Starting values (t, y). A muscle longer than at rest has two of them. If it is short, its
/// bulge is no shallow arc, and its strain is below [`natural_strain`].
pub(super) fn starts(contraction: f64, slenderness: f64, kappa: f64) -> [Option<[f64; 2]>; 2] {
    if kappa == 0.0 && contraction <= 0.0 {
        return [None, None];
    }
    let contracted = contracted_start([contraction, slenderness, kappa]);
    if contraction >= 0.0 {
        return [Some(contracted), None];
    }
    let stretched = stretched_start(contraction, slenderness, kappa);
    if -contraction < 0.5 * natural_strain(slenderness, kappa) {
        [Some(contracted), stretched]
    } else {
        [stretched, Some(contracted)]
    }
}

/// Fibre strain at zero contraction: a shallow arc has `2 phi^4 = 3 e L^2` and `e = kappa L^2/phi^2`.
#[inline]
fn natural_strain<L: Lanes>(slenderness: L, kappa: L) -> L {
    let load = kappa * slenderness;
    (load * load * (2.0 / 3.0)).cbrt()
}

/// Muscle contracted or hardly stretched. With elastic fibres, a fixed-point iteration on the inextensible muscle with the
/// stretched length gives the strain.
#[inline]
pub(super) fn contracted_start<L: Lanes>([contraction, slenderness, kappa]: [L; 3]) -> [L; 2] {
    let is_elastic = L::from(0.0).is_below(kappa);
    // Of inextensible fibres any contraction has a shape; of elastic ones the strain is more than a tiny contraction.
    let least = L::select(is_elastic, L::from(1e-12), L::from(1e-250));
    let inner = |strain: L| {
        let stretch = strain + 1.0;
        let inner = (contraction + strain) / stretch;
        [inner.larger(least).smaller(L::from(MOST_CONTRACTION)), slenderness * stretch]
    };
    if L::all(!is_elastic) {
        let [contraction, slenderness] = inner(kappa);
        return inextensible_start(contraction, slenderness);
    }
    let mut strain = natural_strain(slenderness, kappa);
    for _ in 0..6 {
        let [contraction, slenderness] = inner(strain);
        let phi = joined_tangent(contraction, slenderness).atan();
        // F/phi to some per cent.
        let y = phi * (contraction * (phi * 0.17 + 0.07) + 1.0) / slenderness;
        // T/EA of this shape changes by -(part) of the change of strain: half of it for a shallow arc at zero contraction.
        let part = strain / (contraction * (strain + 1.0)) * 0.5;
        let change = (kappa / (y * y) - strain) / (part + 1.0);
        let is_enough = change.abs().is_below((strain + 1.0) * ENOUGH);
        strain = L::select(is_enough, strain, (strain + change).smaller(L::from(3.0)));
        if L::all(is_enough) {
            break;
        }
    }
    let [contraction, slenderness] = inner(strain);
    inextensible_start(contraction, slenderness)
}

/// Elastic fibres, muscle longer than at rest. For a given t the fibre length `F = L (y + kappa/y)` is a
/// quadratic in y. The end distance `eps = 2 y (1 + t^2) D/L - kappa/y^2` rises with t. This leaves one
/// monotone equation, here with F and D at m = 0.
fn stretched_start(contraction: f64, slenderness: f64, kappa: f64) -> Option<[f64; 2]> {
    let y_at = |phi: f64| {
        let half = 0.5 * phi / slenderness;
        half + (half * half - kappa).max(0.0).sqrt()
    };
    let excess = |ln_t: f64| {
        let t = ln_t.exp();
        let phi = t.atan();
        let y = y_at(phi);
        2.0 * y * (1.0 + t * t) * straight_d(t) / slenderness - kappa / (y * y) - contraction
    };
    let phi_min = 2.0 * slenderness * kappa.sqrt();
    let low = (phi_min < 1.55).then(|| phi_min.tan().ln())?;
    let t = illinois(excess, low, (2.0 * slenderness).max(2.0).ln(), 0.1).exp();
    Some([t, y_at(t.atan())])
}

/// D at m = 0: (phi - sin phi cos phi)/2, without cancellation for a small t.
#[inline]
pub(super) fn straight_d<L: Lanes>(t: L) -> L {
    let t2 = t * t;
    L::select(t.is_below(L::from(1e-3)), t2 * t * (1.0 / 3.0), (t.atan() - t / (t2 + 1.0)) * 0.5)
}

/// t0 of the equations above.
#[inline]
fn joined_tangent<L: Lanes>(contraction: L, slenderness: L) -> L {
    let x = contraction * slenderness * slenderness;
    (x * (x.sqrt() * 0.98 + 1.5 + x * 0.1643)).sqrt().sqrt()
}

/// (t, y) of inextensible fibres, within 2e-6 for contractions up to the limit.
#[inline]
fn inextensible_start<L: Lanes>(contraction: L, slenderness: L) -> [L; 2] {
    let t0 = joined_tangent(contraction, slenderness);
    let phi = t0.atan();
    let (u, v) = (phi * FRAC_2_PI, contraction * 2.0);
    let horner = |row: &[f64]| row.iter().rev().fold(L::from(0.0), |sum, c| sum * u + *c);
    let polynomial =
        |rows: [&[f64]; 8]| rows.iter().rev().fold(L::from(0.0), |sum, row| sum * v + horner(row));
    [t0 * polynomial(TANGENT), phi * polynomial(LENGTH) / slenderness]
}
