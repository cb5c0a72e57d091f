//! The textbook braid: a cylinder up to the fittings (psi = 0 everywhere), with everything that the net can
//! carry.
//!
//! At a given end distance sigma is known, and radius and tension follow from the net and the radial balance:
//!
//! ```text
//! (1 + e)^2 = sigma^2 + q^2 r^2          A'(r) = h(r, T)          F = N - A
//! ```
//!
//! For inextensible fibres without bladder this is the formula of Schulte, Chou and Hannaford, Tondu and
//! Lopez (S2 eq. 12, S5 eq. 11): `F = pi r0^2 p (3 (1 - eps)^2/tan^2(alpha0) - 1/sin^2(alpha0))`.

use bulge_numerics::{Dual, Real};
use std::f64::consts::E;

use crate::FibreError;
use crate::net::Net;

/// Tension that counts as zero, in parts of p R^2.
const SLACK: f64 = 1e-12;

/// A cylinder in equilibrium; dimensionless.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cylinder<D> {
    pub(crate) radius: D,
    pub(crate) tension: D,
    pub(crate) force: D,
    pub(crate) volume: D,
    pub(crate) iterations: u32,
    /// Radial imbalance that is left, in parts of A'.
    pub(crate) residual: f64,
}

/// Radius and tension with a tension `more` beyond the one that stretches the fibres to the end distance:
/// `q^2 r^2 = (1 + e)^2 - sigma^2` without a difference of two nearly equal numbers.
fn stretched<D: Real>(net: &Net<D>, sigma: D, more: D) -> (D, D) {
    let stretch = net.compliance * more;
    let (least, square) = if sigma.value() > 1.0 {
        ((sigma - 1.0) / net.compliance, stretch * (stretch + sigma * 2.0))
    } else {
        (D::from(0.0), -(sigma * sigma) + 1.0 + stretch * (stretch + 2.0))
    };
    (square.sqrt() / net.turn, least + more)
}

/// The radius, and the radial imbalance A' - h there.
fn balance<D: Real>(net: &Net<D>, sigma: D, more: D) -> (D, D) {
    let (radius, tension) = stretched(net, sigma, more);
    (radius, net.area_r(radius) - net.acting_at(radius.value()).local(radius, tension).hoop)
}

/// The cylinder at a contraction.
///
/// # Errors
/// [`FibreError::TooLong`] if inextensible fibres can't reach the end distance, [`FibreError::Slack`] if the
/// rubber alone carries the pressure, [`FibreError::NotConverged`] otherwise.
pub(crate) fn solve<D: Real>(net: &Net<D>, contraction: D) -> Result<Cylinder<D>, FibreError> {
    let sigma = net.cos_rest * (-contraction + 1.0);
    let inextensible = net.compliance.value() == 0.0;
    if inextensible && sigma.value() >= 1.0 {
        let limit = 1.0 - 1.0 / net.cos_rest.value();
        return Err(FibreError::TooLong { contraction: contraction.value(), limit });
    }
    let (more, iterations) = tension(net, sigma, contraction.value())?;
    let (radius, tension) = stretched(net, sigma, more);
    let local = net.acting_at(radius.value()).local(radius, tension);
    let section = net.section(radius);
    let force = local.force - section.area;
    let volume = net.volume_section(radius, &section) * sigma * net.half_fibre * 2.0;
    let pressure = net.area_r(radius).value();
    let residual = ((pressure - local.hoop.value()) / pressure).abs();
    Ok(Cylinder { radius, tension, force, volume, iterations, residual })
}

/// The tension of the radial balance, see [`balance`]. Newton's method in T solves it for the values, and one
/// more step gives the derivatives. For inextensible fibres the balance is linear, and the first step is exact.
fn tension<D: Real>(net: &Net<D>, sigma: D, contraction: f64) -> Result<(D, u32), FibreError> {
    let plain = net.constant();
    let lifted = plain.lift::<1>();
    let s = sigma.value();
    let residual = |ln_t: f64| {
        let (r, gap) = balance(&lifted, Dual::from(s), Dual::<1>::variable(ln_t, 0).exp());
        (r.value(), gap.value(), gap.gradient()[0])
    };
    let mut ln_t = (plain.area_r(1.0) / (plain.turn * plain.turn)).ln();
    let mut last = f64::INFINITY;
    for iteration in 1..=100 {
        let (r, gap, slope) = residual(ln_t);
        let step = gap / slope;
        if !step.is_finite() || !r.is_finite() {
            ln_t += 0.5;
            continue;
        }
        last = gap.abs();
        if step.abs() < 1e-9 {
            let at = D::from(ln_t.exp());
            let (_, gap) = balance(net, sigma, at);
            let tension = at - gap * (ln_t.exp() / slope);
            return if tension.value() > 0.0 { Ok((tension, iteration)) } else { break };
        }
        // T -> T - gap/(dgap/dT), by a factor of e at most.
        ln_t += (1.0 - step).clamp(1.0 / E, E).ln();
    }
    // The wall may hold more than the pressure at hardly any tension.
    let (r, gap, _) = residual(SLACK.ln());
    if r.is_finite() && gap < 0.0 {
        return Err(FibreError::Slack { contraction, limit: None });
    }
    Err(FibreError::NotConverged { contraction, residual: last, iterations: 100 })
}

#[cfg(test)]
mod tests {
    use crate::{Approach, FibreError, Problem};
    use bulge_muscles::{Ends, Parameter, Pressure, preset};

    /// Straight fibres along the axis are l0/cos(alpha0) long.
    #[test]
    fn fibres_that_do_not_stretch_are_only_so_long() {
        let braid = preset("dmsp-20-250").unwrap().with_ends(Ends::Cylinder);
        let angle = braid.get(Parameter::BraidAngle).unwrap();
        let longest = 1.0 - 1.0 / angle.cos();
        let at = |contraction: f64| {
            Problem::new(&braid, Pressure::bar(3.0)).unwrap().follow(contraction, Approach::Auto)
        };
        assert!(at(0.999 * longest).is_ok());
        let Err(FibreError::TooLong { limit, .. }) = at(1.001 * longest) else {
            panic!("longer than its fibres")
        };
        assert!((limit - longest).abs() < 1e-12, "{limit} {longest}");
    }
}
