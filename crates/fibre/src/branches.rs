//! Where formulas with kinks change their branches along a meridian.
//!
//! The curvature of the meridian follows W''. Where that jumps, at a radius that moves with the numbers of the
//! muscle, the derivative of an integral over the jump has a term that no derivative of the integrand shows. An
//! integration therefore ends at each such radius and begins anew, with the radius as a number that carries
//! derivatives. A branch changes where one of the formula's gaps g(l1, l2, r) vanishes (`max(a, b)` has the gap
//! a - b). The tension, on which l1 depends if the fibres stretch, follows from H.

use arrayvec::ArrayVec;
use bulge_numerics::root::newton_bracketed;
use bulge_numerics::{Dual, Real};

use crate::FibreError;
use crate::formulas::MOST_GAPS;
use crate::meridian::Middle;
use crate::net::Net;
use crate::quadrature::{slope_of_energy, tension_at};

/// Radii at which branches change between mid-length and fitting, at most. Each gap may vanish more than once.
pub(crate) const MOST_BRANCHES: usize = 12;
/// Radii at which the signs of the gaps are compared. A branch that counts on a shorter part of the way is missed.
const SAMPLES: u32 = 48;
/// Radii at which a formula is looked at if no equilibrium was found, how near to the widest that fibres at an angle
/// reach, and over the fitting's where nothing else limits them.
const LOOKS: u32 = 400;
const NEARLY: f64 = 0.999;
const WIDEST: f64 = 3.0;
/// Distance over which a slope jumps.
const STEP: f64 = 1e-9;
/// Accuracy of the radius, over R.
const ACCURACY: f64 = 1e-14;

/// The radii at which a branch changes.
pub(crate) fn radii<D: Real>(net: &Net<D>, middle: &Middle<D>) -> ArrayVec<D, MOST_BRANCHES> {
    let mut found = ArrayVec::new();
    if !net.has_branches() {
        return found;
    }
    let r_m = net.end_radius + middle.bulge;
    let energy = net.acting_at(r_m.value()).hamiltonian(r_m, middle.tension);
    let (plain, lifted) = (net.constant(), net.constant().lift::<1>());
    let way = Way { plain: &plain, lifted: &lifted, energy: energy.value() };
    let radius = |i: u32| r_m.value() - middle.bulge.value() * f64::from(i) / f64::from(SAMPLES);
    let mut tension = middle.tension.value();
    let mut before: Option<(f64, [Dual<1>; 2 * MOST_GAPS])> = None;
    for r in (0..=SAMPLES).map(radius) {
        let Some((here, gaps)) = way.gaps(r, tension) else { break };
        tension = here;
        if let Some((last, old)) = before {
            let crossed = (0..gaps.len()).filter(|k| changes_sign(old[*k].value(), gaps[*k].value()));
            let roots = crossed.filter_map(|k| {
                let is_falling = (old[k].value() > 0.0) == (last < r);
                let root = way.root(k, [last.min(r), last.max(r)], is_falling, tension)?;
                way.moving(net, k, root, tension, energy)
            });
            // More branches than there is room for are passed as they are.
            let room = MOST_BRANCHES - found.len();
            found.extend(roots.take(room));
        }
        before = Some((r, gaps));
    }
    found
}

/// Whether a gap vanishes between two places; where it is exactly 0 counts once.
fn changes_sign(one: f64, other: f64) -> bool {
    one.is_finite() && other.is_finite() && (one > 0.0) != (other > 0.0)
}

/// What in a formula may keep an equilibrium from being found: no finite value or slope, or a slope that jumps, at
/// a radius between that of the fittings and the widest, or at that of a cylinder.
pub(crate) fn obstacle(net: &Net<f64>, is_cylinder: bool, contraction: f64) -> Option<FibreError> {
    let formulas = net.formulas.as_ref()?;
    // Fibres that stretch may go farther; nothing is judged there.
    let [low, high] = if is_cylinder {
        let sigma = net.cos_rest * (1.0 - contraction);
        [(1.0 - sigma * sigma).sqrt() / net.turn; 2]
    } else {
        [net.end_radius, if net.turn > 0.0 { NEARLY / net.turn } else { WIDEST * net.end_radius }]
    };
    let stretches = |r: f64| (net.sigma(r, 0.0) / net.cos_rest, r);
    let slopes = |r: f64| {
        let sigma = net.sigma(r, 0.0);
        let energy =
            formulas.wall(sigma, r, net.cos_rest).map(|wall| [wall.w_1, wall.w_2, wall.w_11, wall.w_22]);
        let area = formulas.section(r).map(|section| [0.0, section.area_r, 0.0, section.area_rr]);
        [("energy", energy), ("area", area)]
    };
    let mut before: Option<(f64, [f64; 2 * MOST_GAPS])> = None;
    for r in (0..=LOOKS).map(|i| low + (high - low) * f64::from(i) / f64::from(LOOKS)) {
        let (along, around) = stretches(r);
        for (what, slopes) in slopes(r) {
            if slopes.is_some_and(|slopes| !slopes.iter().all(|slope| slope.is_finite())) {
                return Some(FibreError::FormulaEnds { contraction, what, along, around });
            }
        }
        let gaps = net.gaps(r, 0.0);
        if let Some((last, old)) = before {
            for k in (0..gaps.len()).filter(|k| changes_sign(old[*k], gaps[*k])) {
                let is_left = |at: f64| (net.gaps(at, 0.0)[k] > 0.0) == (old[k] > 0.0);
                let (mut left, mut right) = (last, r);
                while right - left > STEP {
                    let middle = 0.5 * (left + right);
                    *(if is_left(middle) { &mut left } else { &mut right }) = middle;
                }
                let (along, around) = stretches(left);
                for ((what, one), (_, other)) in slopes(left).into_iter().zip(slopes(right)) {
                    let Some((one, other)) = one.zip(other) else { continue };
                    // A slope that is continuous changes by its derivative times the distance.
                    let jumps = |i: usize| {
                        (one[i] - other[i]).abs() > 1e3 * STEP * (one[i + 2].abs() + other[i + 2].abs())
                    };
                    if jumps(0) || jumps(1) {
                        return Some(FibreError::FormulaJumps { contraction, what, along, around });
                    }
                }
            }
        }
        before = Some((r, gaps));
    }
    None
}

/// A meridian on which the gaps are looked at.
struct Way<'a> {
    plain: &'a Net<f64>,
    lifted: &'a Net<Dual<1>>,
    energy: f64,
}

impl Way<'_> {
    /// The tension at a radius and the gaps with their slopes along the meridian.
    fn gaps(&self, r: f64, near: f64) -> Option<(f64, [Dual<1>; 2 * MOST_GAPS])> {
        let radius = Dual::variable(r, 0);
        if self.plain.compliance == 0.0 {
            return Some((near, self.lifted.gaps(radius, Dual::from(near))));
        }
        let net = self.plain.acting_at(r);
        let tension = tension_at(&net, r, self.energy, near)?;
        let slope = net.local(r, tension).tension_r;
        Some((tension, self.lifted.gaps(radius, Dual::new(tension, [slope]))))
    }

    /// The radius between two at which the gap `k` vanishes. It falls or grows with the radius.
    fn root(&self, k: usize, [low, high]: [f64; 2], is_falling: bool, near: f64) -> Option<f64> {
        // Newton's method goes from positive to negative.
        let sign = if is_falling { 1.0 } else { -1.0 };
        let gap = |r: f64| {
            let (_, gaps) = self.gaps(r, near).ok_or(())?;
            Ok::<_, ()>((sign * gaps[k].value(), sign * gaps[k].gradient()[0]))
        };
        newton_bracketed(gap, low, high, 0.5 * (low + high), [ACCURACY, 0.0]).ok()
    }

    /// The radius at which the gap `k` vanishes, with its derivatives.
    fn moving<D: Real>(&self, net: &Net<D>, k: usize, root: f64, near: f64, energy: D) -> Option<D> {
        let (tension, gaps) = self.gaps(root, near)?;
        let radius = D::from(root);
        let moving = if self.plain.compliance == 0.0 {
            D::from(tension)
        } else {
            let gap = net.acting_at(root).hamiltonian(radius, D::from(tension)) - energy;
            -gap / slope_of_energy(&self.plain.acting_at(root), root, tension) + tension
        };
        let moved = net.gaps(radius, moving)[k] / gaps[k].gradient()[0];
        moved.value().is_finite().then(|| radius - moved)
    }
}
