//! The equilibrium ODE of the meridian, integrated from mid-length to the fitting.
//!
//! With the unstretched fibre length S from mid-length as the independent variable, chi = -psi the angle by
//! which the meridian has turned towards the axis, and N, h, sigma, T_r, h_r from [`Net::local`]:
//!
//! ```text
//! rho' = sigma sin(chi)            rho = r_e - r, the distance from the radius at mid-length
//! d'   = cos(alpha0) - sigma cos(chi)     shortening of the axial distance against rest
//! chi' = sigma k                   carried as (sin chi, cos chi)
//! k'   = -(sigma sin(chi)/N) (A'' - h_r cos(chi) - 2 h k)          k = (A' - h cos(chi))/N, the curvature of the meridian
//! T'   = -T_r sigma sin(chi)
//! V'   = pi (r + depth)^2 sigma cos(chi)       with lobes: A sigma cos(chi)
//! ```
//!
//! This is the second-order balance. It is regular at mid-length and takes no square root of a difference.
//! The curvature k is carried as a state although r and T determine it. This is what makes long braids easy:
//! at mid-length they lie within exp(-50) of a saddle (the cylinder), where k from its definition is pure
//! rounding. As states, k and sin(chi) keep their *relative* accuracy however small they are. The first
//! integral `N cos(chi) = F + A(r)` is not used by the integration and so measures its error.

use arrayvec::ArrayVec;
use bulge_numerics::Real;
use bulge_numerics::dop853::{self, Dop853};

use crate::branches::{self, MOST_BRANCHES};
use crate::net::Net;

/// Indices of the state.
pub(crate) const RHO: usize = 0;
pub(crate) const SHORTENING: usize = 1;
pub(crate) const SIN: usize = 2;
pub(crate) const COS: usize = 3;
pub(crate) const CURVATURE: usize = 4;
pub(crate) const TENSION: usize = 5;
pub(crate) const VOLUME: usize = 6;
const STATES: usize = 7;

/// Steps after which an integration is given up. A braid of l0/r0 = 100 and 50 degrees takes about 500.
const MAX_STEPS: u32 = 1500;

/// Part of the way that one crossing step may cover. With rho as the independent variable a step is affected
/// by the square root at mid-length. Its error is about (this)^9.
const CROSSING: f64 = 0.04;

/// Part of the way to a place where a formula changes its branch that a step aims at. A step too far would meet
/// the other branch; the remainder is crossed in rho.
const SHORT: f64 = 0.9;

/// Distance from such a place, over R, at which its branch is certain: a hundred times the rounding.
const MARGIN: f64 = 1e-13;

pub(crate) type State<D> = [D; STATES];

/// A meridian from mid-length to the fitting.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trajectory<D> {
    /// Unstretched fibre length from mid-length to the point where the radius is that of the fitting.
    pub(crate) half_fibre: D,
    /// State at that point.
    pub(crate) end: State<D>,
    /// Axial force F = N - A at mid-length.
    pub(crate) force: D,
    /// Tension at mid-length.
    pub(crate) mid_tension: D,
    pub(crate) steps: u32,
    pub(crate) evaluations: u32,
    /// |N cos(chi) - A - F| at the fitting, relative to the largest of these forces there and at mid-length.
    pub(crate) first_integral: f64,
}

/// A net with the radius at mid-length fixed: the right-hand side of the ODE.
#[derive(Clone)]
struct Flow<D> {
    net: Net<D>,
    mid_radius: D,
    /// The radii of a piece on which every formula keeps its branches, if a formula has kinks.
    piece: Option<[f64; 2]>,
}

impl<D: Real> Flow<D> {
    fn slope(&self, y: &State<D>) -> State<D> {
        let net = &self.net;
        let (sin, cos, k, tension) = (y[SIN], y[COS], y[CURVATURE], y[TENSION]);
        let mut r = self.mid_radius - y[RHO];
        if let Some([low, high]) = self.piece {
            r = r + (r.value().clamp(low, high) - r.value());
        }
        let l = net.local(r, tension);
        let section = net.section(r);
        let out = l.sigma * sin;
        let turn = l.sigma * k;
        // cos(alpha0) - sigma cos(chi) without cancellation:
        // (cos^2(alpha0) - sigma^2)/(cos(alpha0) + sigma) + sigma (1 - cos(chi)).
        let strain = net.compliance * tension;
        let angle = (net.turn * r).squared() - net.sin2_rest;
        let shortening =
            (angle - strain * (strain + 2.0)) / (net.cos_rest + l.sigma) + l.sigma * sin * sin / (cos + 1.0);
        [
            out,
            shortening,
            cos * turn,
            -(sin * turn),
            -(out / l.force) * (section.area_rr - l.hoop_r * cos - l.hoop * k * 2.0),
            -(l.tension_r * out),
            net.volume_section(r, &section) * l.sigma * cos,
        ]
    }

    /// The same with rho as the independent variable. S takes the place of rho in the state.
    fn slope_by_rho(&self, rho: D, y: &State<D>) -> State<D> {
        let mut state = *y;
        state[RHO] = rho;
        let mut slope = self.slope(&state);
        let per_rho = D::from(1.0) / slope[RHO];
        slope[RHO] = D::from(1.0);
        slope.map(|s| s * per_rho)
    }

    /// Goes from `y` to the given rho in one or a few steps of equal size (Hénon's way to hit a surface
    /// exactly: rho becomes the independent variable). Moves the state and returns the change of S. The way
    /// must be short, and rho must change steadily on it.
    fn cross_to(&self, y: &mut State<D>, rho: D, pieces: u32) -> D {
        // Here the place RHO of the array holds S; rho itself is appended as an eighth component of slope 1.
        let mut f = |z: &[D; STATES + 1]| {
            let slope = self.slope_by_rho(z[STATES], &std::array::from_fn(|i| z[i]));
            std::array::from_fn(|i| if i < STATES { slope[i] } else { D::from(1.0) })
        };
        let mut z: [D; STATES + 1] = std::array::from_fn(|i| if i < STATES { y[i] } else { y[RHO] });
        z[RHO] = D::from(0.0);
        let h = (rho - y[RHO]) / f64::from(pieces);
        for _ in 0..pieces {
            let k1 = f(&z);
            z = dop853::step(&mut f, &z, &k1, h);
        }
        let advance = std::mem::replace(&mut z[RHO], rho);
        *y = std::array::from_fn(|i| z[i]);
        advance
    }

    /// N cos(chi) - A, constant along the meridian.
    fn axial_force(&self, y: &State<D>) -> D {
        let r = self.mid_radius - y[RHO];
        self.net.local(r, y[TENSION]).force * y[COS] - self.net.area(r)
    }

    fn departure(&self, y: &State<D>, force: D) -> D {
        (self.axial_force(y) - force).abs()
    }

    /// The largest of the forces that the first integral adds up, here and at mid-length.
    fn largest(&self, y: &State<D>, mid_force: D) -> D {
        let r = self.mid_radius - y[RHO];
        let here = [self.net.local(r, y[TENSION]).force.abs(), self.net.area(r).abs()];
        here.into_iter().fold(mid_force.abs(), |a, b| if b.value() > a.value() { b } else { a })
    }

    /// Fibre length to the target rho by the local parabola, if it leads there.
    fn distance_to(&self, y: &State<D>, slope: &State<D>, target: f64) -> Option<f64> {
        let sign = target.signum();
        let rest = (target - y[RHO].value()) * sign;
        let speed = slope[RHO].value() * sign;
        let sigma = self.net.sigma(self.mid_radius - y[RHO], y[TENSION]).value();
        let push = sigma * slope[SIN].value() * sign;
        let h = 2.0 * rest / (speed + (speed * speed + 2.0 * push * rest).sqrt());
        (h.is_finite() && h > 0.0).then_some(h)
    }
}

/// Why a trajectory does not exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct NoTrajectory {
    /// Evaluations spent before this was known.
    pub(crate) evaluations: u32,
}

/// The middle of a meridian, from which a trajectory starts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Middle<D> {
    /// r_mid - r_fitting, positive for a bulge, negative for a waist.
    pub(crate) bulge: D,
    /// Curvature of the meridian, of the same sign and not zero.
    pub(crate) curvature: D,
    /// Tension of all fibres, with which push - h = k N.
    pub(crate) tension: D,
    /// Meridional force N.
    pub(crate) force: D,
    /// Fibre length from mid-length to this state, on which the meridian can't be told from a cylinder;
    /// usually 0.
    pub(crate) straight: D,
}

impl<D: Real> Middle<D> {
    /// The same without derivatives.
    pub(crate) fn constant(&self) -> Middle<f64> {
        Middle {
            bulge: self.bulge.value(),
            curvature: self.curvature.value(),
            tension: self.tension.value(),
            force: self.force.value(),
            straight: self.straight.value(),
        }
    }

    /// A middle whose curvature is exp(-`below`) of the one stated. Along a saddle, `rho'' = lambda^2 rho`
    /// with
    ///
    /// ```text
    /// lambda^2 = sigma^2 (h_r - A'')/N
    /// ```
    ///
    /// the curvature grows by the factor exp(lambda s). The way from this middle to the stated curvature is a
    /// cylinder. `None` if there is no saddle.
    pub(crate) fn beyond(mut self, net: &Net<D>, below: D) -> Option<Self> {
        let r = net.end_radius + self.bulge;
        let net = net.acting_at(r.value());
        let local = net.local(r, self.tension);
        let square = local.sigma.squared() * (local.hoop_r - net.section(r).area_rr) / local.force;
        self.straight = below / square.sqrt();
        self.straight.value().is_finite().then_some(self)
    }

    /// Adds the shortening and the volume of the cylinder to the state at the fitting. `net` is that of the
    /// middle.
    pub(crate) fn with_straight(&self, net: &Net<D>, mut end: State<D>) -> State<D> {
        if self.straight.value() == 0.0 {
            return end;
        }
        let middle = Flow { net: net.clone(), mid_radius: net.end_radius + self.bulge, piece: None };
        let rates = middle.slope(&self.state());
        end[SHORTENING] += rates[SHORTENING] * self.straight;
        end[VOLUME] += rates[VOLUME] * self.straight;
        end
    }

    fn state(&self) -> State<D> {
        let zero = D::from(0.0);
        [zero, zero, zero, D::from(1.0), self.curvature, self.tension, zero]
    }
}

/// Integrates from the middle until the radius is that of the fitting.
pub(crate) fn trajectory<D: Real>(
    net: &Net<D>,
    middle: Middle<D>,
    tolerance: f64,
) -> Result<Trajectory<D>, NoTrajectory> {
    let Middle { bulge, curvature, tension: mid_tension, straight, .. } = middle;
    let mid_radius = net.end_radius + bulge;
    let mut y = middle.state();
    let at_middle = net.acting_at(mid_radius.value());
    let targets = targets(net, &middle);
    let piece = |next: usize| {
        let from = if next == 0 { D::from(0.0) } else { targets[next - 1] };
        net.has_branches().then(|| within(mid_radius.value(), from.value(), targets[next].value()))
    };
    let mut flow = Flow { net: at_middle.as_ref().clone(), mid_radius, piece: piece(0) };
    let mut slope = flow.slope(&y);
    let mid = at_middle.local(mid_radius, mid_tension);
    let force = mid.force - at_middle.area(mid_radius);
    let (sign, size) = (bulge.value().signum(), bulge.value().abs());
    let mut next = 0;
    let parabola = (2.0 * size / (curvature.value().abs())).sqrt() / mid.sigma.value();
    let mut run = Dop853::new((0.5 * parabola).min(1.0 + 0.1 * net.half_fibre.value()), tolerance);
    let floor = shortening_floor(net, size, parabola);
    let mut fibre = D::from(0.0);
    let far = 10.0 * net.half_fibre.value();
    loop {
        let target = targets[next];
        let aim = if flow.piece.is_some() { SHORT } else { 1.0 };
        let limit = D::from(flow.distance_to(&y, &slope, target.value()).map_or(far, |h| (aim * h).min(far)));
        let stepped = run.advance(
            &mut |y: &State<D>| flow.slope(y),
            |a, b| scale(a, b, mid_radius.value(), floor),
            &mut y,
            &mut slope,
            limit,
        );
        let Ok(h) = stepped else { return Err(NoTrajectory { evaluations: run.evaluations }) };
        fibre += h;
        let remaining = (target.value() - y[RHO].value()) * sign;
        // The last step aims at the target with a Taylor estimate. A remainder of a few per cent is then
        // crossed in rho.
        let part = remaining / y[RHO].value().abs();
        if part < CROSSING {
            let pieces = (1..100).find(|pieces| part.abs() <= CROSSING * f64::from(*pieces)).unwrap_or(100);
            fibre += flow.cross_to(&mut y, target, pieces);
            run.evaluations += 12 * pieces;
            next += 1;
            if next == targets.len() {
                break;
            }
            let between = 0.5 * (target.value() + targets[next].value());
            flow.net = net.acting_at(mid_radius.value() - between).into_owned();
            flow.piece = piece(next);
            slope = flow.slope(&y);
        }
        if run.accepted > MAX_STEPS || y[COS].value() < -0.999 {
            return Err(NoTrajectory { evaluations: run.evaluations });
        }
    }
    let (steps, evaluations) = (run.accepted, run.evaluations);
    let first_integral = flow.departure(&y, force).value() / flow.largest(&y, mid.force).value();
    if !first_integral.is_finite() {
        return Err(NoTrajectory { evaluations });
    }
    let (half_fibre, end) = (fibre + straight, middle.with_straight(&at_middle, y));
    Ok(Trajectory { half_fibre, end, force, mid_tension, steps, evaluations, first_integral })
}

/// The places on the way to the fitting at which the law changes, and the fitting itself, as values of rho in
/// the order in which they are met. The law is smooth between them, and each is hit exactly.
fn targets<D: Real>(net: &Net<D>, middle: &Middle<D>) -> ArrayVec<D, { MOST_BRANCHES + 3 }> {
    let (bulge, mid_radius) = (middle.bulge, net.end_radius + middle.bulge);
    let (sign, size) = (bulge.value().signum(), bulge.value().abs());
    let mut targets: ArrayVec<D, { MOST_BRANCHES + 3 }> = ArrayVec::new();
    let radii = net.kinks().into_iter().flatten().chain(branches::radii(net, middle));
    targets.extend(radii.map(|radius| mid_radius - radius).filter(|rho| {
        let way = rho.value() * sign;
        way > 0.0 && way < size
    }));
    targets.sort_by(|a, b| a.value().abs().total_cmp(&b.value().abs()));
    targets.push(bulge);
    targets
}

/// The radii between two values of rho, less a margin. The ends of a piece are computed only up to rounding, and
/// beyond them other branches count.
fn within(mid_radius: f64, from: f64, to: f64) -> [f64; 2] {
    let [low, high] = [mid_radius - from.max(to) + MARGIN, mid_radius - from.min(to) - MARGIN];
    if low < high { [low, high] } else { [0.5 * (low + high); 2] }
}

/// A point of the meridian, from mid-length outwards; dimensionless.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Station {
    /// Unstretched fibre length from mid-length.
    pub(crate) fibre: f64,
    /// Axial distance from mid-length.
    pub(crate) x: f64,
    pub(crate) r: f64,
    /// Angle by which the meridian has turned towards the axis.
    pub(crate) chi: f64,
    pub(crate) tension: f64,
}

/// The meridian at `pieces + 1` points, equally spaced in fibre length, from mid-length to the fitting at
/// `half_fibre`. Also the largest departure from the first integral over all points, relative to the largest
/// of its forces.
pub(crate) fn stations(
    net: &Net<f64>,
    middle: Middle<f64>,
    half_fibre: f64,
    tolerance: f64,
    pieces: usize,
) -> Result<(Vec<Station>, f64), NoTrajectory> {
    let (mut y, mid_radius, tension) = (middle.state(), net.end_radius + middle.bulge, middle.tension);
    let flow_at = |y: &State<f64>| Flow {
        net: net.acting_at(mid_radius - y[RHO]).into_owned(),
        mid_radius,
        piece: None,
    };
    let mut f = |y: &State<f64>| flow_at(y).slope(y);
    let mut slope = f(&y);
    let mid_force = flow_at(&y).net.local(mid_radius, tension).force;
    let force = flow_at(&y).axial_force(&y);
    let floor = shortening_floor(net, middle.bulge.abs(), half_fibre);
    let mut run = Dop853::new(half_fibre / pieces as f64, tolerance);
    let mut departure: f64 = 0.0;
    let mut found = Vec::with_capacity(pieces + 1);
    let mut fibre = middle.straight;
    for i in 0..=pieces {
        let target = half_fibre * i as f64 / pieces as f64;
        if target < middle.straight {
            let x = target * flow_at(&y).net.local(mid_radius, tension).sigma;
            found.push(Station { fibre: target, x, r: mid_radius, chi: 0.0, tension });
            continue;
        }
        while target - fibre > 1e-13 * half_fibre {
            fibre += run
                .advance(&mut f, |a, b| scale(a, b, mid_radius, floor), &mut y, &mut slope, target - fibre)
                .map_err(|_| NoTrajectory { evaluations: run.evaluations })?;
        }
        let r = mid_radius - y[RHO];
        let flow = flow_at(&y);
        departure = departure.max(flow.departure(&y, force) / flow.largest(&y, mid_force));
        let x = net.cos_rest * fibre - middle.with_straight(&net.acting_at(mid_radius), y)[SHORTENING];
        found.push(Station { fibre, x, r, chi: y[SIN].atan2(y[COS]), tension: y[TENSION] });
    }
    Ok((found, departure))
}

/// Size of the shortening below which its relative error does not count: a fraction of the shortening that
/// the bulge itself causes.
fn shortening_floor<D: Real>(net: &Net<D>, size: f64, parabola: f64) -> f64 {
    if net.turn.value() != 0.0 || net.compliance.value() != 0.0 {
        // Angle and strain shorten or lengthen the muscle by themselves.
        return 0.01 * net.half_fibre.value();
    }
    let slope = size / parabola;
    (slope * slope).min(1.0) * parabola.min(net.half_fibre.value()) * 1e-2
}

/// The sizes against which errors count. Curvature and slope count against each other, since both vanish
/// together near a saddle.
fn scale<D: Real>(old: &State<D>, new: &State<D>, radius: f64, floor: f64) -> [f64; STATES] {
    let largest = |i: usize| old[i].value().abs().max(new[i].value().abs());
    let angle = largest(SIN) + largest(CURVATURE) * radius;
    [
        largest(RHO) + 1e-3 * radius.min(angle * radius),
        largest(SHORTENING) + floor,
        angle,
        1.0,
        angle / radius,
        largest(TENSION),
        largest(VOLUME) + radius * radius * radius,
    ]
}
