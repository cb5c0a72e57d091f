//! The two unknowns of the shooting and the middle of a meridian that they stand for.

use bulge_numerics::{Dual, Real};

use crate::equator::Equator;
use crate::meridian::Middle;
use crate::net::Net;

/// What the two unknowns stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// ln B and ln k of a bulge. Where lobes or cloth limit the radius they are ln(push/(k B)) and ln k, and with
    /// an angle besides ln(push/B) and ln k.
    Bulge,
    /// ln|B| and the logarithm of the excess of the tension of a waist over that of a cylinder.
    Waist,
    /// ln T of a bulge, and ln(gap/B) with the gap from its radius to that of the cylinder with the same tension.
    BulgeByTension,
}

impl Kind {
    /// +1 for a bulge, -1 for a waist.
    pub(crate) const fn side(self) -> f64 {
        match self {
            Self::Bulge | Self::BulgeByTension => 1.0,
            Self::Waist => -1.0,
        }
    }
}

/// The two unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unknowns {
    pub(crate) kind: Kind,
    pub(crate) logs: [f64; 2],
}

/// ln|k| below which the middle is a cylinder up to rounding. The integration then starts at this value, see
/// [`Middle::beyond`].
pub(crate) const FLAT: f64 = -40.0;

/// Part of the fitting's radius below which the gap to a cylinder is small and the curvature linear in it. At this gap the
/// difference of push and hoop term is rounded to 1e-8, and its square would change the curvature by some 1e-7.
const SMALL: f64 = 1e-8;

/// Largest part of the way to the radius of the lobes' circle that a start may cover.
const OPEN: f64 = 0.98;

impl Unknowns {
    /// A bulge (+1) or a waist (-1) with ln|B| and the second unknown.
    pub(crate) fn new(net: &Net<f64>, side: f64, [ln_bulge, second]: [f64; 2]) -> Self {
        if !is_limited(net, side) {
            let kind = if side > 0.0 { Kind::Bulge } else { Kind::Waist };
            return Self { kind, logs: [ln_bulge, second] };
        }
        let bulge = ln_bulge.exp().min(OPEN * net.most_bulge());
        let r = net.end_radius + bulge;
        let slope = net.acting_at(r).push(r) / bulge;
        let first = match (net.has_wall(), net.turn == 0.0) {
            (true, _) => (0.5 * slope).asinh(),
            (false, true) => slope.ln() - second,
            (false, false) => slope.ln(),
        };
        Self { kind: Kind::Bulge, logs: [first, second] }
    }

    /// Nearly the same bulge, by its tension. A bulge that reaches 1/q has several tensions for one curvature, but each
    /// tension has one curvature at each radius. Waists, and bulges that lobes or cloth limit, stay as they are.
    ///
    /// The gap to the cylinder is of first order in the curvature: Newton's method corrects it.
    pub(crate) fn by_tension(&self, net: &Net<f64>) -> Option<Self> {
        if self.kind != Kind::Bulge || is_limited(net, 1.0) {
            return Some(*self);
        }
        let near = Self { logs: [self.logs[0], self.logs[1].max(FLAT)], ..*self };
        let Middle { bulge, curvature, tension, force, .. } = near.curved(net, near.logs.map(f64::from))?;
        let (_, slope) = net.cylinder_bulge(tension)?;
        let gap = curvature * force / slope;
        let logs = [tension.ln(), (gap / bulge).ln() + self.logs[1] - near.logs[1]];
        logs.iter().all(|log| log.is_finite()).then_some(Self { kind: Kind::BulgeByTension, logs })
    }

    /// The middle of the meridian. If `D` carries derivatives, the unknowns are variables number 0 and 1.
    /// `None` if the fibres can't be there with a positive tension.
    ///
    /// The curvature of a waist is bounded: towards -q^2 r/sigma^2 the tension grows without limit. The
    /// second unknown of a waist therefore stands for the tension, T = T_c + T_p exp(..), with T_c the
    /// tension of a cylinder of this radius and T_p the same without rubber. For a shallow waist it is ln|k|
    /// up to a constant.
    pub(crate) fn middle<D: Real>(
        &self,
        net: &Net<D>,
        variable: impl Fn(f64, usize) -> D,
    ) -> Option<Middle<D>> {
        let logs = [variable(self.logs[0], 0), variable(self.logs[1], 1)];
        if self.logs[1] < FLAT {
            let middle = Self { kind: self.kind, logs: [self.logs[0], FLAT] };
            // The first unknown keeps its derivative; the second one lengthens the cylinder.
            let middle = middle.curved(net, [logs[0], D::from(FLAT)])?;
            return middle.beyond(net, -logs[1] + FLAT);
        }
        self.curved(net, logs)
    }

    /// The same for a curvature that numbers can represent.
    fn curved<D: Real>(&self, net: &Net<D>, logs: [D; 2]) -> Option<Middle<D>> {
        if self.kind == Kind::BulgeByTension {
            return by_tension(net, logs);
        }
        let (second, straight) = (logs[1].exp(), D::from(0.0));
        let side = self.kind.side();
        if is_limited(net, side) {
            let slope = match (net.has_wall(), net.turn.value() == 0.0) {
                (true, _) => logs[0].exp() - (-logs[0]).exp(),
                (false, true) => (logs[0] + logs[1]).exp(),
                (false, false) => logs[0].exp(),
            };
            let bulge = net.bulge(slope)?;
            let r = net.end_radius + bulge;
            let Equator { tension, force } = net.acting_at(r.value()).at_equator(r, bulge * slope, second)?;
            return Some(Middle { bulge, curvature: second, tension, force, straight });
        }
        let bulge = logs[0].exp() * side;
        let r = net.end_radius + bulge;
        if r.value() <= 0.0 {
            return None;
        }
        let net = net.acting_at(r.value());
        let push = net.push(r);
        if side > 0.0 {
            let Equator { tension, force } = net.at_equator(r, push, second)?;
            return Some(Middle { bulge, curvature: second, tension, force, straight });
        }
        // A waist is taut where a cylinder of its radius would not be.
        let cylinder = if net.has_wall() {
            net.balance(r, push, D::from(0.0))?.tension
        } else {
            net.at_equator(r, push, D::from(0.0))?.tension
        };
        let at_cylinder = net.local(r, cylinder);
        // The tension of a cylinder without rubber. (The rubber may carry more than all of the pressure.)
        let unit = if net.has_wall() { push / at_cylinder.hoop_t } else { cylinder };
        let excess = unit * second;
        let tension = cylinder + excess;
        let local = net.local(r, tension);
        // k = (A' - h)/N = -(h(T) - h(T_c))/N. The difference is linear for inextensible fibres, and to first
        // order for a small excess.
        let linear = net.compliance.value() == 0.0 || second.value() < 1e-6;
        let hoop = if linear { at_cylinder.hoop_t * excess } else { local.hoop - at_cylinder.hoop };
        let curvature = -(hoop / local.force);
        (curvature.value() < 0.0 && local.force.value() > 0.0).then_some(Middle {
            bulge,
            curvature,
            tension,
            force: local.force,
            straight,
        })
    }

    /// Whether fibres are slack somewhere.
    pub(crate) fn is_slack(&self, net: &Net<f64>) -> bool {
        self.is_slack_within(net, 0.0)
    }

    /// Whether fibres are slack somewhere, or as good as slack: they carry less than a `part` of the
    /// meridional force.
    pub(crate) fn is_slack_within(&self, net: &Net<f64>, part: f64) -> bool {
        let slack = |middle: Middle<f64>| net.is_slack(net.end_radius + middle.bulge, middle.tension, part);
        net.has_wall() && self.middle(net, |value, _| value).is_some_and(slack)
    }

    pub(crate) fn seeded<const N: usize>(&self, net: &Net<Dual<N>>) -> Option<Middle<Dual<N>>> {
        self.middle(net, Dual::variable)
    }
}

/// The middle of a bulge with the tension `exp(logs[0])`. The gap to the radius of the cylinder with this tension
/// is `exp(logs[1])` times the bulge.
fn by_tension<D: Real>(net: &Net<D>, logs: [D; 2]) -> Option<Middle<D>> {
    let (tension, part) = (logs[0].exp(), logs[1].exp());
    let (reach, slope) = net.cylinder_bulge(tension)?;
    let bulge = reach / (part + 1.0);
    let (r, gap) = (net.end_radius + bulge, bulge * part);
    let local = net.local(r, tension);
    // The push less the hoop term: the difference is linear beside the cylinder.
    let is_small = gap.value() < SMALL * net.end_radius.value();
    let excess = if is_small { slope * gap } else { net.push(r) - local.hoop };
    let curvature = excess / local.force;
    let straight = D::from(0.0);
    (curvature.value() > 0.0).then_some(Middle { bulge, curvature, tension, force: local.force, straight })
}

/// Whether lobes or cloth limit the radius of a bulge. The first unknown then stands for the tension.
pub(crate) fn is_limited<D: Real>(net: &Net<D>, side: f64) -> bool {
    side > 0.0 && (net.lobes.is_some() || net.cloth.is_some())
}

/// Curvature of a waist of inextensible fibres at infinite tension, q^2 r/sigma^2.
pub(crate) fn steepest(net: &Net<f64>, r: f64) -> f64 {
    let angle2 = (net.turn * r).powi(2);
    angle2 / (r * (1.0 - angle2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the curvature becomes linear in the gap it jumps by less than a Newton step that is accepted, and the logarithm
    /// of the gap is that of the curvature.
    #[test]
    fn the_curvature_beside_a_cylinder_is_linear_in_the_gap() {
        let (sin, cos) = 25.0_f64.to_radians().sin_cos();
        for depth in [0.0, 0.3, -0.2] {
            let net = Net {
                turn: sin,
                cos_rest: cos,
                sin2_rest: sin * sin,
                half_fibre: 20.0,
                depth,
                ..Net::plain()
            };
            let net = Net { compliance: 0.35 * sin * sin / (2.0 * std::f64::consts::PI), ..net };
            for strain in [0.1, 0.3, 0.9] {
                let tension: f64 = strain / net.compliance;
                let bulge = net.cylinder_bulge(tension).unwrap().0;
                let ln_k = |gap: f64| {
                    let at =
                        Unknowns { kind: Kind::BulgeByTension, logs: [tension.ln(), (gap / bulge).ln()] };
                    at.middle(&net, |value, _| value).unwrap().curvature.ln()
                };
                let jump = ln_k(SMALL * 1.000_001) - ln_k(SMALL * 0.999_999) - 2e-6;
                assert!(jump.abs() < 5e-7, "{depth} {strain}: {jump:e}");
                assert!((ln_k(1e-12) - ln_k(1e-14) - 100.0_f64.ln()).abs() < 1e-9, "{depth} {strain}");
                assert!((ln_k(1e-4) - ln_k(1e-6) - 100.0_f64.ln()).abs() < 1e-2, "{depth} {strain}");
            }
        }
    }

    /// A shallow stretch of the same muscle by either pair of unknowns.
    #[test]
    fn a_bulge_by_its_tension_is_nearly_the_same() {
        let (sin, cos) = 25.0_f64.to_radians().sin_cos();
        let net = Net { turn: sin, cos_rest: cos, sin2_rest: sin * sin, half_fibre: 20.0, ..Net::plain() };
        let net = Net { compliance: 0.1 * sin * sin / (2.0 * std::f64::consts::PI), ..net };
        let middle = |at: Unknowns| at.middle(&net, |value, _| value).unwrap();
        for ln_k in [-60.0, -20.0, -8.0] {
            let at = Unknowns::new(&net, 1.0, [0.5_f64.ln(), ln_k]);
            let by_tension = at.by_tension(&net).unwrap();
            assert_eq!(by_tension.kind, Kind::BulgeByTension);
            let [a, b] = [at, by_tension].map(middle);
            assert!(
                (a.tension / b.tension - 1.0).abs() < 1e-12 && (a.bulge / b.bulge - 1.0).abs() < 1e-2,
                "{ln_k}"
            );
            // Below a curvature that numbers can represent, a cylinder stands for the rest.
            let differs = (a.curvature / b.curvature - 1.0).abs();
            assert!(differs < 2e-2 || a.straight > 0.0, "{ln_k}: {} {}", a.curvature, b.curvature);
            assert_eq!(a.straight > 0.0, b.straight > 0.0, "{ln_k}");
        }
        let waist = Unknowns::new(&net, -1.0, [-3.0, -3.0]);
        assert_eq!(waist.by_tension(&net), Some(waist));
    }
}
