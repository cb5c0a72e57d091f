//! The fibre net of a muscle, implemented a second time: stored energy, meridional force and hoop term at a
//! radius.
//!
//! ```text
//! w = c T^2/2 + B W(sigma/cos(alpha0), r/r0) + sigma u(r)        (1 + c T)^2 = sigma^2 + q^2 r^2        c = p R^2/(n EA)
//! N = dw/dsigma        h = (1/sigma) dw/dr        H = sigma N - w
//! ```
//!
//! Lengths are in units of R (r0 for a braid), forces in p R^2.

use bulge_muscles::{Construction, FibreCount, Muscle, Parameter, Pressure, Quantity};
use std::f64::consts::{PI, TAU};

use crate::section;

/// Fraction of the radius as a step for the slope of the area of a lobed cross-section.
const LOBED_STEP: f64 = 1e-6;
/// Most Newton iterations for a tension.
const ITERATIONS: u32 = 60;

/// Squared sine of the angle of the fibres at the fittings above which sigma and the rubber change much on
/// the last part of the way.
const STEEP: f64 = 0.8;

/// Cross-section on which the pressure acts.
#[derive(Debug, Clone)]
enum Area {
    /// a pi (r + depth)^2
    Round { factor: f64, depth: f64 },
    /// From the geometry of the lobes; holds the muscle and its R \[m\].
    Lobed(Box<Muscle>, f64),
}

/// A muscle under pressure in dimensionless form.
#[derive(Debug, Clone)]
pub(super) struct Net {
    /// Radius at the fittings.
    pub(super) end: f64,
    /// Unstretched fibre length from a fitting to mid-length.
    pub(super) half: f64,
    /// Cosine of the angle at rest.
    pub(super) cos_rest: f64,
    /// Turn per fibre length, q.
    pub(super) turn: f64,
    compliance: f64,
    area: Area,
    /// 2 pi r0 t cos(alpha0) (c10, c01)/(p R^2).
    rubber: Option<[f64; 2]>,
    /// pi K/(p R r_u) and r_u.
    cloth: Option<[f64; 2]>,
}

/// The net at a radius and a tension.
#[derive(Debug, Clone, Copy)]
pub(super) struct Local {
    pub(super) sigma: f64,
    pub(super) force: f64,
    pub(super) hoop: f64,
    /// H.
    pub(super) conserved: f64,
    /// dN/dT and dh/dT at the same radius.
    pub(super) force_t: f64,
    pub(super) hoop_t: f64,
}

/// Energy of rubber and cloth and its derivatives by sigma (1) and r (2).
#[derive(Debug, Clone, Copy, Default)]
struct Wall {
    w: f64,
    w_1: f64,
    w_2: f64,
    w_11: f64,
    w_12: f64,
}

impl Net {
    pub(super) fn new(muscle: &Muscle, pressure: Pressure) -> Self {
        let (p, radius) = (pressure.si(), muscle.radius().si());
        let get = |parameter| muscle.get(parameter);
        let (angle, area) = match muscle.construction() {
            Construction::Pleated(pleated) => {
                let factor = match pleated.fibres() {
                    FibreCount::Discrete(n) => f64::from(n) / TAU * (TAU / f64::from(n)).sin(),
                    FibreCount::Continuous => 1.0,
                };
                let depth = get(Parameter::PleatDepth).unwrap_or(0.0) / radius;
                let lobed = get(Parameter::ClothCircumference).is_some();
                let round = Area::Round { factor, depth };
                let area = if lobed { Area::Lobed(Box::new(muscle.clone()), radius) } else { round };
                (get(Parameter::Misalignment).unwrap_or(0.0), area)
            }
            Construction::Braided(braided) => {
                let depth = -get(Parameter::GasWall).unwrap_or(0.0) / radius;
                (braided.braid_angle().si(), Area::Round { factor: 1.0, depth })
            }
        };
        let unit = p * radius * radius;
        let rubber = muscle.bladder_wall().map(|wall| {
            let scale = TAU * radius * wall.si() * angle.cos() / unit;
            [Parameter::C10, Parameter::C01].map(|constant| get(constant).unwrap_or(0.0) * scale)
        });
        let cloth =
            get(Parameter::HoopStiffness).zip(get(Parameter::UnfoldedRadius)).map(|(stiffness, unfolded)| {
                let taut = unfolded / radius;
                [PI * stiffness / (p * radius * taut), taut]
            });
        let fibres = muscle.fibres().map_or(1.0, f64::from);
        Self {
            end: muscle.end_radius().si() / radius,
            half: 0.5 * muscle.length().si() / (radius * angle.cos()),
            cos_rest: angle.cos(),
            turn: angle.sin().abs(),
            compliance: muscle.fibre().map_or(0.0, |fibre| unit / (fibre.stiffness().si() * fibres)),
            area,
            rubber,
            cloth,
        }
    }

    /// A(r).
    pub(super) fn area(&self, r: f64) -> f64 {
        match &self.area {
            Area::Round { factor, depth } => factor * PI * (r + depth).powi(2),
            Area::Lobed(muscle, radius) => section::area(muscle, r * radius) / (radius * radius),
        }
    }

    /// A'(r).
    pub(super) fn area_r(&self, r: f64) -> f64 {
        match &self.area {
            Area::Round { factor, depth } => factor * TAU * (r + depth),
            Area::Lobed(..) => {
                let step = LOBED_STEP * r;
                (self.area(r + step) - self.area(r - step)) / (2.0 * step)
            }
        }
    }

    /// Area for the reported volume, of circles or of lobes.
    pub(super) fn volume_area(&self, r: f64) -> f64 {
        match &self.area {
            Area::Round { depth, .. } => PI * (r + depth).powi(2),
            Area::Lobed(..) => self.area(r),
        }
    }

    /// The radius at which the cloth comes taut.
    pub(super) fn taut_radius(&self) -> Option<f64> {
        self.cloth.map(|[_, taut]| taut)
    }

    /// The radius beyond which the cloth alone carries the pressure, the radius at which inextensible fibres
    /// lie along the circumference, and the radius at which lobes form a circle.
    pub(super) fn limits(&self) -> [Option<f64>; 3] {
        let held = match (&self.area, self.cloth) {
            // factor 2 pi (r + depth) = 2 scale (r - r_u)
            (Area::Round { factor, depth }, Some([scale, taut])) if scale > factor * PI => {
                Some((scale * taut + factor * PI * depth) / (scale - factor * PI))
            }
            _ => None,
        };
        let circle = match &self.area {
            Area::Lobed(muscle, radius) => muscle.get(Parameter::ClothCircumference).map(|cloth| {
                let depth = muscle.get(Parameter::PleatDepth).unwrap_or(0.0);
                (cloth / TAU - depth) / radius
            }),
            Area::Round { .. } => None,
        };
        [held, (self.turn > 0.0 && self.is_inextensible()).then(|| 1.0 / self.turn), circle]
    }

    pub(super) fn is_inextensible(&self) -> bool {
        self.compliance == 0.0
    }

    /// Whether the fibres lie nearly along the circumference at the fittings.
    pub(super) fn is_steep(&self) -> bool {
        (self.turn * self.end).powi(2) > STEEP
    }

    fn wall(&self, r: f64, sigma: f64, taut: bool) -> Wall {
        let mut wall = Wall::default();
        if let Some([c10, c01]) = self.rubber {
            let (x, y) = (sigma / self.cos_rest, r);
            let (x2, y2) = (x * x, y * y);
            let cos = self.cos_rest;
            wall.w = c10 * (x2 + y2 + 1.0 / (x2 * y2) - 3.0) + c01 * (1.0 / x2 + 1.0 / y2 + x2 * y2 - 3.0);
            let by_x = 2.0 * c10 * (x - 1.0 / (x2 * x * y2)) + 2.0 * c01 * (x * y2 - 1.0 / (x2 * x));
            let by_xx = 2.0 * c10 * (1.0 + 3.0 / (x2 * x2 * y2)) + 2.0 * c01 * (y2 + 3.0 / (x2 * x2));
            let by_xy = 4.0 * c10 / (x2 * x * y2 * y) + 4.0 * c01 * x * y;
            (wall.w_1, wall.w_11, wall.w_12) = (by_x / cos, by_xx / (cos * cos), by_xy / cos);
            wall.w_2 = 2.0 * c10 * (y - 1.0 / (x2 * y2 * y)) + 2.0 * c01 * (y * x2 - 1.0 / (y2 * y));
        }
        if let (Some([scale, radius]), true) = (self.cloth, taut) {
            let excess = r - radius;
            wall.w += sigma * scale * excess * excess;
            wall.w_1 += scale * excess * excess;
            wall.w_2 += 2.0 * sigma * scale * excess;
            wall.w_12 += 2.0 * scale * excess;
        }
        wall
    }

    /// Whether the cloth is taut at a radius.
    pub(super) fn is_taut(&self, r: f64) -> bool {
        self.cloth.is_some_and(|[_, taut]| r > taut)
    }

    /// sigma^2. It is negative at radii that the fibres don't reach.
    fn square(&self, r: f64, tension: f64) -> f64 {
        (1.0 + self.compliance * tension).powi(2) - (self.turn * r).powi(2)
    }

    /// The net at a radius and a tension. If `taut`, the law includes the cloth.
    pub(super) fn local(&self, r: f64, tension: f64, taut: bool) -> Option<Local> {
        let (c, stretch) = (self.compliance, 1.0 + self.compliance * tension);
        let square = self.square(r, tension);
        if !(square > 0.0 && stretch > 0.0) {
            return None;
        }
        let sigma = square.sqrt();
        let wall = self.wall(r, sigma, taut);
        let pull = tension / stretch;
        let force = pull * sigma + wall.w_1;
        let around = self.turn * self.turn * r;
        let hoop = (pull * around + wall.w_2) / sigma;
        let stored = 0.5 * c * tension * tension + wall.w;
        let sigma_t = stretch * c / sigma;
        let force_t = sigma / (stretch * stretch) + (pull + wall.w_11) * sigma_t;
        let hoop_t = (around / (stretch * stretch) + (wall.w_12 - hoop) * sigma_t) / sigma;
        Some(Local { sigma, force, hoop, conserved: sigma * force - stored, force_t, hoop_t })
    }

    /// The tension at which H has the given value, starting from a guess.
    pub(super) fn tension(&self, r: f64, conserved: f64, taut: bool, guess: f64) -> Option<f64> {
        if self.is_inextensible() {
            let sigma = self.square(r, 0.0).sqrt();
            let wall = self.wall(r, sigma, taut);
            let tension = ((conserved + wall.w) / sigma - wall.w_1) / sigma;
            return tension.is_finite().then_some(tension);
        }
        // The fibres must reach the radius.
        let reach = (self.turn * r - 1.0) / self.compliance;
        let mut tension = if guess > reach { guess } else { reach + 0.1 * (1.0 + reach.abs()) };
        for _ in 0..ITERATIONS {
            let local = self.local(r, tension, taut)?;
            let step = (local.conserved - conserved) / (local.sigma * local.force_t);
            let next = tension - step;
            tension = if next > reach { next } else { 0.5 * (tension + reach) };
            if step.abs() <= 1e-14 * tension.abs() + 1e-300 {
                return Some(tension);
            }
        }
        let off = self.local(r, tension, taut)?.conserved - conserved;
        (off.abs() <= 1e-11 * conserved.abs()).then_some(tension)
    }

    /// The tension at which A' - h = `curvature` N, that is, the load that the hoop term leaves to the
    /// curvature of the meridian.
    pub(super) fn balancing(&self, r: f64, curvature: f64) -> Option<f64> {
        let taut = self.is_taut(r);
        let area_r = self.area_r(r);
        let gap = |tension: f64| {
            let local = self.local(r, tension, taut)?;
            Some(area_r - local.hoop - curvature * local.force)
        };
        if self.is_inextensible() {
            let (zero, one) = (gap(0.0)?, gap(1.0)?);
            let tension = zero / (zero - one);
            return tension.is_finite().then_some(tension);
        }
        let reach = ((self.turn * r - 1.0) / self.compliance).max(0.0);
        let mut low = reach + 1e-9 * (1.0 + reach);
        if gap(low)? <= 0.0 {
            return None;
        }
        let mut high = low + 1e-3;
        while gap(high)? > 0.0 {
            (low, high) = (high, reach + 2.0 * (high - reach));
            if high > 1e12 {
                return None;
            }
        }
        let mut at = 0.5 * (low + high);
        for _ in 0..200 {
            let local = self.local(r, at, taut)?;
            let value = area_r - local.hoop - curvature * local.force;
            if value > 0.0 {
                low = at;
            } else {
                high = at;
            }
            let newton = at + value / (local.hoop_t + curvature * local.force_t);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - at).abs() <= 1e-15 * at {
                return Some(next);
            }
            at = next;
        }
        Some(at)
    }
}

impl Net {
    /// Radius and tension of a cylinder whose fibres have the meridional stretch `sigma`. The tension exceeds
    /// the one needed for this stretch by `more`.
    pub(super) fn of_sigma(&self, sigma: f64, more: f64) -> Option<(f64, f64)> {
        let least = if sigma > 1.0 { (sigma - 1.0) / self.compliance } else { 0.0 };
        let tension = least + more;
        let square = (1.0 + self.compliance * tension).powi(2) - sigma * sigma;
        (square > 0.0 && tension.is_finite()).then(|| (square.sqrt() / self.turn, tension))
    }
}
