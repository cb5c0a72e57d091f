//! The middle of a meridian, where it is parallel to the axis: the radius and the tension that go with a
//! curvature, and whether fibres are slack.

use bulge_numerics::Real;
use std::f64::consts::PI;

use crate::net::{Local, Net};

/// Radii at which the fibres are tested for slackness.
const SAMPLES: usize = 17;
/// Halvings after which a bracket is as narrow as rounding.
const HALVINGS: u32 = 200;
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
    /// The bulge of the widest cylinder whose elastic fibres have a tension, and -d(push - h)/dr there at this tension,
    /// which is positive. `None` if there is none wider than the fitting, or if rubber makes it no such cylinder. Lobes
    /// and cloth aren't asked for.
    ///
    /// ```text
    /// push - h = 2 pi a (r + depth) - T q^2 r/((1 + e) sigma)        of bare fibres, sigma^2 = (1 + e)^2 - q^2 r^2
    /// ```
    /// is concave in r and falls without limit towards sigma = 0. It has one zero if it is positive at the fitting; with
    /// gas inside the fibres it may be negative there, and has two. The outer one is meant.
    pub(crate) fn cylinder_bulge(&self, tension: D) -> Option<(D, D)> {
        let gap = |bulge: D| {
            let r = self.end_radius + bulge;
            let local = self.local(r, tension);
            let hoop_r = local.hoop_r - local.hoop_t * local.tension_r;
            (self.push(r) - local.hoop, hoop_r - self.section(r).area_rr)
        };
        let values = |bulge: f64| {
            let (value, slope) = gap(D::from(bulge));
            (value.value(), slope.value())
        };
        let room =
            (tension * self.compliance + 1.0).value() / self.turn.value().abs() - self.end_radius.value();
        if room.is_nan() || room <= 0.0 {
            return None;
        }
        let (mut low, mut high) = (0.0, room);
        // Up to where it is positive, if that is not at the fitting: it rises until then.
        for _ in 0..HALVINGS {
            let (value, slope) = values(low);
            if value > 0.0 {
                break;
            }
            let middle = 0.5 * (low + high);
            let (value, slope_there) = values(middle);
            if slope >= 0.0 {
                return None;
            }
            if value > 0.0 || slope_there < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        if values(low).0.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
            return None;
        }
        high = room;
        let mut at = 0.5 * (low + high);
        for _ in 0..HALVINGS {
            let (value, slope) = values(at);
            if value > 0.0 {
                low = at;
            } else {
                high = at;
            }
            let newton = at + value / slope;
            if (newton - at).abs() <= 1e-9 * at {
                let (value, slope) = gap(D::from(at));
                let bulge = value / slope + at;
                let slope = gap(bulge).1;
                // Next to a pole any step is small.
                let is_zero = value.value().abs() <= 1e-6 * self.push(self.end_radius + bulge).value().abs();
                return (is_zero && slope.value() > 0.0).then_some((bulge, slope));
            }
            at = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
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
        // Rubber or cloth holds the wave otherwise.
        let rich: Net<f64> = crate::net::tests::rich();
        for held in [
            Net { rubber: rich.rubber, ..net(1.001 * border) },
            Net { cloth: rich.cloth, ..net(1.001 * border) },
        ] {
            assert!(!held.undulates(contraction));
        }
    }

    /// A soft braid of 25 degrees, group 0.35.
    fn soft([end_radius, depth, area_factor]: [f64; 3]) -> Net<f64> {
        let (sin, cos) = 25.0_f64.to_radians().sin_cos();
        let net = Net {
            end_radius,
            depth,
            area_factor,
            turn: sin,
            cos_rest: cos,
            sin2_rest: sin * sin,
            ..Net::plain()
        };
        Net { compliance: 0.35 * sin * sin / (2.0 * PI), half_fibre: 20.0, ..net }
    }

    /// The widest radius at which push and hoop term balance, with derivatives, also where gas inside the fibres makes a
    /// second one nearer to a narrow fitting.
    #[test]
    fn the_cylinder_of_a_tension() {
        for form in [[1.0, 0.0, 1.0], [1.0, 0.3, 0.97], [1.0, -0.2, 1.0], [0.5, -0.2, 0.9], [0.3, -0.2, 1.0]]
        {
            let net = soft(form);
            for strain in [0.1, 0.3, 0.6, 0.9] {
                let tension = strain / net.compliance;
                let gap = |bulge: f64| {
                    let r = net.end_radius + bulge;
                    net.push(r) - net.local(r, tension).hoop
                };
                let room = (1.0 + strain) / net.turn - net.end_radius;
                let places: Vec<f64> = (1..4000).map(|i| room * f64::from(i) / 4000.0).collect();
                let widest = places.iter().rposition(|place| gap(*place) > 0.0);
                let Some((bulge, slope)) = net.cylinder_bulge(tension) else {
                    assert!(widest.is_none(), "{form:?} {strain}");
                    continue;
                };
                let widest = places[widest.unwrap()];
                assert!(
                    widest <= bulge && bulge < widest + room / 3900.0,
                    "{form:?} {strain}: {bulge} {widest}"
                );
                assert!(gap(bulge).abs() < 1e-12 * net.push(net.end_radius + bulge), "{form:?} {strain}");
                let h = 1e-5;
                let differences = (gap(bulge - h) - gap(bulge + h)) / (2.0 * h);
                assert!((slope / differences - 1.0).abs() < 1e-6, "{form:?} {strain}: {slope} {differences}");
                let moving =
                    net.lift::<1>().cylinder_bulge(bulge_numerics::Dual::variable(tension, 0)).unwrap();
                let step = 1e-5 * tension;
                let [more, less] = [step, -step].map(|step| net.cylinder_bulge(tension + step).unwrap());
                for (moving, more, less) in [(moving.0, more.0, less.0), (moving.1, more.1, less.1)] {
                    let differences = (more - less) / (2.0 * step);
                    assert!((moving.gradient()[0] - differences).abs() < 1e-6 * differences.abs() + 1e-9);
                }
            }
        }
        // Fibres of this length don't reach so wide a fitting.
        let wide = soft([3.0, 0.0, 1.0]);
        assert!(wide.cylinder_bulge(0.02 / wide.compliance).is_none());
    }
}
