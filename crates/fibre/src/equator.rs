//! The middle of a meridian, where it is parallel to the axis: the radius and the tension that go with a
//! curvature, and whether fibres are slack.

use bulge_numerics::Real;
use std::f64::consts::PI;

use crate::net::{Local, Net};

/// Radii at which the fibres are tested for slackness.
const SAMPLES: usize = 17;
/// A ratio of push to bulge that is next to nothing.
const SLIGHT: f64 = 1e-304;
/// Margin, as a part of H, by which H must be too small for the fibres to count as slack.
const SLACK: f64 = 1e-12;

/// The net where the meridian is parallel to the axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Equator<D> {
    /// Tension of all fibres.
    pub(crate) tension: D,
    /// Meridional force N.
    pub(crate) force: D,
}

impl<D: Real> Net<D> {
    /// A'(r) less the hoop term of the cloth: the part that fibres and bladder carry.
    pub(crate) fn push(&self, r: D) -> D {
        match &self.cloth {
            Some(cloth) => self.area_r(r) - cloth.scale() * (r - cloth.radius) * 2.0,
            None => self.area_r(r),
        }
    }

    /// The bulge B > 0 at which the [`Net::push`] is B times `rate`, at the radius of the fitting plus B. The
    /// bulge falls with the rate, which is positive except with a bladder.
    ///
    /// Where lobes or a stiff cloth limit the radius, the push is the small difference of two numbers. B
    /// times the rate gives it exactly.
    pub(crate) fn bulge(&self, rate: D) -> Option<D> {
        let Some(lobes) = &self.lobes else { return self.bulge_of_polygon(rate) };
        let Some(cloth) = &self.cloth else { return lobes.bulge(self.end_radius + self.depth, -rate.ln()) };
        let free = lobes.bulge(self.end_radius + self.depth, -rate.ln())?;
        let room = cloth.radius - self.end_radius;
        if free.value() <= room.value() {
            return Some(free);
        }
        // The root lies between the cloth's radius and the bulge that the lobes alone would have. The gap
        // rises steadily.
        let gap = |bulge: D| {
            let r = self.end_radius + bulge;
            let acting = self.acting_at(r.value().max(cloth.radius.value() * (1.0 + 1e-15)));
            let slope = rate - acting.section(r).area_rr + cloth.scale() * 2.0;
            (bulge * rate - acting.push(r), slope)
        };
        let (mut low, mut high) = (room.value().max(0.0), free.value());
        let mut at = 0.5 * (low + high);
        for _ in 0..200 {
            let (value, slope) = gap(D::from(at));
            if value.value() > 0.0 {
                high = at;
            } else {
                low = at;
            }
            let newton = at - value.value() / slope.value();
            if (newton - at).abs() <= 1e-9 * at {
                let (value, slope) = gap(D::from(newton));
                return Some(-(value / slope.value()) + newton);
            }
            at = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        }
        None
    }

    fn bulge_of_polygon(&self, rate: D) -> Option<D> {
        let area_rr = self.area_factor * (2.0 * PI);
        let end = area_rr * (self.end_radius + self.depth);
        let free = end / (rate - area_rr);
        let Some(cloth) = &self.cloth else { return (free.value() > 0.0).then_some(free) };
        let room = cloth.radius - self.end_radius;
        if free.value() > 0.0 && free.value() <= room.value() {
            return Some(free);
        }
        let stiff = cloth.scale() * 2.0;
        let held = (end + stiff * room) / (rate - area_rr + stiff);
        (held.value() > 0.0).then_some(held)
    }

    /// The largest bulge at which there is a push. Infinite if nothing limits it.
    pub(crate) fn most_bulge(&self) -> f64 {
        let net = self.constant();
        let lobes = net.lobes.map_or(f64::INFINITY, |lobes| lobes.limit() - net.depth - net.end_radius);
        let held = net.bulge(SLIGHT).unwrap_or(f64::INFINITY);
        lobes.min(held)
    }

    /// The tension and force at which the meridian has curvature `curvature` where it is parallel to the axis,
    /// at radius `r` with the [`Net::push`] `push`: push - h = k N, with h of fibres and bladder.
    ///
    /// The equation is linear in T for inextensible fibres. Otherwise a bracketed Newton's method solves it
    /// for the values, and one more step gives the derivatives. `None` if no solution has a positive tension
    /// (with a bladder: a positive meridional force), or if the fibres can't reach that radius.
    pub(crate) fn at_equator(&self, r: D, push: D, curvature: D) -> Option<Equator<D>> {
        let found = self.balance(r, push, curvature)?;
        // Rubber may carry more than the pressure. The solution for fibres that can be pushed tells when they
        // become slack.
        let holds = if self.compliance.value() != 0.0 {
            true
        } else if self.has_wall() {
            found.force.value() > 0.0
        } else {
            found.tension.value() > 0.0
        };
        holds.then_some(found)
    }

    /// The same for either sign of tension and meridional force, as occurs with wide rubber.
    pub(crate) fn balance(&self, r: D, push: D, curvature: D) -> Option<Equator<D>> {
        // The cloth's force acts, and its hoop term is in the push.
        let bare = self.without_cloth();
        let pull = self.cloth.map_or(D::from(0.0), |cloth| cloth.energy(r));
        let of = |local: &Local<D>| {
            let gap = push - local.hoop - curvature * (local.force + pull);
            (gap, local.hoop_t + curvature * local.force_t)
        };
        let gap = |tension: D| of(&bare.local(r, tension));
        let at_zero = bare.local(r, D::from(0.0));
        let (residual, slope) = of(&at_zero);
        let linear = residual / slope;
        if self.compliance.value() == 0.0 {
            let force = at_zero.force + at_zero.force_t * linear + pull;
            return linear.value().is_finite().then_some(Equator { tension: linear, force });
        }
        let stretched = |tension: D| Equator { tension, force: bare.local(r, tension).force + pull };
        if linear.value() <= 0.0 && self.has_wall() {
            return pushed(gap, linear).map(stretched);
        }
        // Stretching makes the true tension smaller than the linear estimate by up to a power of the stretch.
        let mut tension = linear.value().abs() / (linear.value().abs() * self.compliance.value() + 1.0);
        let (mut low, mut high) = (0.0, f64::INFINITY);
        for _ in 0..200 {
            let (residual, slope) = gap(D::from(tension));
            let newton = tension + (residual / slope).value();
            if residual.value() > 0.0 {
                low = tension;
            } else {
                high = tension;
            }
            if (newton - tension).abs() <= 1e-9 * tension {
                // The quadratic step from here also settles the derivatives.
                return Some(stretched(residual / slope + tension));
            }
            tension = match (newton > low && newton < high, high.is_finite()) {
                (true, _) => newton.min(4.0 * tension),
                (false, true) => 0.5 * (low + high),
                (false, false) => 4.0 * tension,
            };
            if !tension.is_finite() || tension <= 0.0 {
                break;
            }
        }
        None
    }
}

impl<D: Real> Net<D> {
    /// The bulge of the cylinder whose elastic fibres have a tension, and -d(push - h)/dr there at this tension. The
    /// push exceeds the hoop term of narrower radii. `None` if it doesn't at the fitting's. Lobes and cloth aren't
    /// asked for.
    pub(crate) fn cylinder_bulge(&self, tension: D) -> Option<(D, D)> {
        let gap = |bulge: D| {
            let r = self.end_radius + bulge;
            let local = self.local(r, tension);
            let hoop_r = local.hoop_r - local.hoop_t * local.tension_r;
            (self.push(r) - local.hoop, hoop_r - self.section(r).area_rr)
        };
        // Up to the radius at which the fibres lie along the circumference, where the hoop term has no limit.
        let room =
            (tension * self.compliance + 1.0).value() / self.turn.value().abs() - self.end_radius.value();
        let (mut low, mut high) = (0.0, room);
        if high.is_nan() || high <= 0.0 || gap(D::from(0.0)).0.value() <= 0.0 {
            return None;
        }
        let mut at = 0.5 * (low + high);
        for _ in 0..200 {
            let (value, slope) = gap(D::from(at));
            if value.value() > 0.0 {
                low = at;
            } else {
                high = at;
            }
            let newton = at + (value / slope).value();
            if (newton - at).abs() <= 1e-9 * at {
                let bulge = value / slope + at;
                return Some((bulge, gap(bulge).1));
            }
            at = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if high - low <= f64::EPSILON * high {
                break;
            }
        }
        None
    }
}

/// The root of a `gap` with its slope, at a negative tension. Newton's method starts from the linear
/// estimate.
fn pushed<D: Real>(gap: impl Fn(D) -> (D, D), linear: D) -> Option<D> {
    let mut tension = linear.value();
    for _ in 0..30 {
        let (residual, slope) = gap(D::from(tension));
        let step = (residual / slope).value();
        if step.abs() <= 1e-9 * tension.abs() {
            return Some(residual / slope + tension);
        }
        tension += step;
    }
    None
}

impl Net<f64> {
    /// Whether a braid whose gas acts inside its fibres is too long for one middle at a contraction. Beside
    /// the cylinder of that contraction,
    ///
    /// ```text
    /// (r - r_c)'' = sigma^2 (h_r - A'')/N (r - r_c)
    /// ```
    /// Where the solution is a wave instead of a saddle, half a wave must reach from fitting to fitting. A
    /// braid with rubber or cloth is not judged.
    pub(crate) fn undulates(&self, contraction: f64) -> bool {
        let sigma = self.cos_rest * (1.0 - contraction);
        let radius = (1.0 - sigma * sigma).sqrt() / self.turn;
        let holds_otherwise = self.has_wall() || self.cloth.is_some();
        if holds_otherwise || self.depth >= 0.0 || radius.is_nan() || radius + self.depth <= 0.0 {
            return false;
        }
        let net = self.acting_at(radius);
        let Some(Equator { tension, .. }) = net.at_equator(radius, net.push(radius), 0.0) else {
            return false;
        };
        let local = net.local(radius, tension);
        let square = local.sigma.powi(2) * (local.hoop_r - net.section(radius).area_rr) / local.force;
        (-square).max(0.0).sqrt() * 2.0 * self.half_fibre > PI
    }

    /// Whether fibres are slack somewhere between mid-length and the fitting. H = sigma N - w is constant
    /// along the meridian, and the tension T has the sign of H - f, where f = sigma w_1 - w belongs to the
    /// walls on fibres of their own length. Fibres count as slack up to a `part` of sigma N.
    pub(crate) fn is_slack(&self, mid_radius: f64, mid_tension: f64, part: f64) -> bool {
        if !self.has_wall() {
            return false;
        }
        let middle = self.acting_at(mid_radius);
        let local = middle.local(mid_radius, mid_tension);
        let stored = 0.5 * self.compliance * mid_tension.powi(2) + middle.wall(local.sigma, mid_radius).w;
        let energy = local.sigma * local.force - stored;
        let most = energy + SLACK * energy.abs() - part * (local.sigma * local.force).abs();
        let way = self.end_radius - mid_radius;
        let radii: [f64; SAMPLES] =
            std::array::from_fn(|i| mid_radius + way * i as f64 / (SAMPLES - 1) as f64);
        let sigmas = radii.map(|r| (1.0 - (self.turn * r).powi(2)).sqrt());
        let walls = self.acting_walls(sigmas, radii);
        // Where fibres of their own length don't reach, sigma is NaN, and the fibres are taut.
        sigmas.iter().zip(&walls).any(|(sigma, wall)| most < sigma * wall.w_1 - wall.w)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For inextensible fibres alone, with the gas at r - d: h = 2 pi (r - d), N = h sigma^2/(q^2 r) and
    /// h_r = (h/r)(1 + 3 q^2 r^2/sigma^2).
    #[test]
    fn a_cylinder_undulates_from_half_a_wave_on() {
        let (sin, cos) = 24.0_f64.to_radians().sin_cos();
        let (contraction, gas) = (-0.05, 0.3);
        let sigma = cos * (1.0 - contraction);
        let r = (1.0 - sigma * sigma).sqrt() / sin;
        let hoop = 2.0 * PI * (r - gas);
        let hoop_r = hoop / r * (1.0 + 3.0 * (sin * r / sigma).powi(2));
        let wave = (sin * sin * r * (2.0 * PI - hoop_r) / hoop).sqrt();
        let net = |half_fibre: f64| Net {
            half_fibre,
            cos_rest: cos,
            sin2_rest: sin * sin,
            turn: sin,
            depth: -gas,
            ..Net::plain()
        };
        let border = 0.5 * PI / wave;
        assert!(!net(0.999 * border).undulates(contraction) && net(1.001 * border).undulates(contraction));
        assert!(!Net { depth: 0.0, ..net(10.0 * border) }.undulates(contraction));
    }
}
