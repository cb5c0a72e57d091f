//! The fibre net that every muscle consists of, as functions of the radius r and the fibre tension t.
//!
//! A net of n fibres in two opposite families, pinned where they cross. One unit of *unstretched fibre
//! length* S spans the meridional length sigma and turns by q = sin(alpha0)/r0 about the axis, so a fibre
//! with strain e obeys
//!
//! ```text
//! (1 + e)^2 = sigma^2 + q^2 r^2          (1 + e) sin(theta) = q r          (1 + e) cos(theta) = sigma
//! ```
//!
//! Its stored energy per unit of S, with T the tension of all fibres and 1/EA = c (c = 0: inextensible, e is
//! a constraint and T its multiplier):
//!
//! ```text
//! w(r, sigma) = c T^2/2  +  B W(sigma/cos(alpha0), r/r0)  +  sigma u(r)                fibres + wall + cloth
//! ```
//!
//! The equilibrium of -p A(r) dx and w dS then needs only these local quantities:
//!
//! ```text
//! N = dw/dsigma    meridional force            h = (1/sigma) dw/dr    hoop term;  dN/dr = h along the meridian
//! k = (A' - h cos(psi))/N                      curvature of the meridian
//! ```
//!
//! `theta(r)`, `A(r)` and `u(r)` of the theory are `q`, [`Net::area`] and [`Cloth`]; the pleated muscle is
//! q = 0. Everything is dimensionless: lengths in the reference radius R, forces in p R^2.

use bulge_numerics::{Dual, Real};
use std::borrow::Cow;
use std::f64::consts::PI;

use crate::formulas::Formulas;
use crate::formulas::MOST_GAPS;
use crate::lobes::{Lobes, Section};

/// Place of the first coefficient of the rubber, and that of the cloth after it.
const RUBBER: usize = 13;
const CLOTH: usize = RUBBER + EVEN_POWERS.len();
/// Largest count of numbers in a net without formulas: with lobes, rubber and cloth.
pub(crate) const OWN_NUMBERS: usize = CLOTH + 2;
/// Largest count of numbers in a net.
pub(crate) const NUMBERS: usize = OWN_NUMBERS + Formulas::<f64>::NUMBERS;

/// Exponents of the stretches l1 and l2 in the terms of an energy that is solved with in closed form.
///
/// Along fibres that don't stretch l1^2 is linear in l2^2. The second divided differences of all these terms by
/// l2^2 together then take no more than three coefficients.
pub const EVEN_POWERS: [[i32; 2]; 8] = [[2, 0], [0, 2], [-2, -2], [-2, 0], [0, -2], [2, 2], [4, 0], [0, 4]];

/// Energy of a wall that follows the net point by point: a sum of [`EVEN_POWERS`] of the stretches
/// l1 = sigma/cos(alpha0) along the meridian and l2 = r/r0 around it, 0 at rest.
///
/// ```text
/// w = sum of c_k (l1^i_k l2^j_k - 1),       (i_k, j_k) the exponents
/// ```
///
/// Incompressible rubber after Mooney and Rivlin, W = c10 (I1 - 3) + c01 (I2 - 3), has c10 in the first three
/// terms and c01 in the next three.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EvenPowers<D> {
    /// 2 pi r0 cos(alpha0)/(p R^2) times the energy per area at rest: per unstretched fibre length.
    pub(crate) terms: [D; EVEN_POWERS.len()],
}

/// Cloth that stops unfolding at r_u: u(r) = K (2 pi (r - r_u))^2/(2 * 2 pi r_u) beyond it, per meridian
/// length.
///
/// In a [`Net`] it acts at every radius, so that the law is smooth; [`Net::acting_at`] leaves it out where it
/// is slack.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cloth<D> {
    /// Hoop stiffness K/(p R).
    pub(crate) stiffness: D,
    /// Unfolded radius r_u/R.
    pub(crate) radius: D,
}

/// A dimensionless fibre net under unit pressure between rigid fittings.
#[derive(Debug, Clone)]
pub(crate) struct Net<D> {
    /// Radius at the fittings.
    pub(crate) end_radius: D,
    /// Unstretched fibre length from a fitting to mid-length.
    pub(crate) half_fibre: D,
    /// Cosine of the rest angle: axial length per fibre length at rest.
    pub(crate) cos_rest: D,
    /// sin(alpha0)^2, the square of q at the rest radius.
    pub(crate) sin2_rest: D,
    /// Turn per unstretched fibre length, q.
    pub(crate) turn: D,
    /// 1/(n EA) in units of 1/(p R^2).
    pub(crate) compliance: D,
    /// Area of the cross-section over pi (r + depth)^2: (n/2 pi) sin(2 pi/n) for a polygon, 1 for a circle.
    pub(crate) area_factor: D,
    /// Distance outside the fibres at which the pressure acts, at r + depth: positive out to the crests of
    /// pleats, negative at the inner face of a wall.
    pub(crate) depth: D,
    /// Cloth in lobes between the fibres, if any. It replaces the polygon.
    pub(crate) lobes: Option<Lobes<D>>,
    /// Rubber or another wall whose energy has even powers only, if any.
    pub(crate) rubber: Option<EvenPowers<D>>,
    /// Cloth with limited unfolding, if any.
    pub(crate) cloth: Option<Cloth<D>>,
    /// A user's own formulas, if any: for an energy of the wall that has other powers, for the area.
    pub(crate) formulas: Option<Box<Formulas<D>>>,
}

/// Derivatives of the stored energy of bladder and cloth: w_1 = d/dsigma, w_2 = d/dr.
pub(crate) struct Wall<D> {
    pub(crate) w: D,
    pub(crate) w_1: D,
    pub(crate) w_2: D,
    pub(crate) w_11: D,
    pub(crate) w_12: D,
    pub(crate) w_22: D,
}

impl<D: Real> Wall<D> {
    fn add(&mut self, other: &Self) {
        self.w += other.w;
        self.w_1 += other.w_1;
        self.w_2 += other.w_2;
        self.w_11 += other.w_11;
        self.w_12 += other.w_12;
        self.w_22 += other.w_22;
    }
}

/// The net at one radius with one tension.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Local<D> {
    /// Meridional length per unstretched fibre length.
    pub(crate) sigma: D,
    /// Meridional force N.
    pub(crate) force: D,
    /// Hoop term h = dN/dr along the meridian.
    pub(crate) hoop: D,
    /// dh/dr along the meridian.
    pub(crate) hoop_r: D,
    /// dT/dr along the meridian.
    pub(crate) tension_r: D,
    /// dN/dT and dh/dT at fixed r.
    pub(crate) force_t: D,
    pub(crate) hoop_t: D,
}

impl<D: Real> Net<D> {
    /// The net as it acts at radius `r`, with one smooth law: without the cloth where that is slack, with
    /// lobes that touch or that don't.
    pub(crate) fn acting_at(&self, r: f64) -> Cow<'_, Self> {
        if self.cloth.is_none() && self.lobes.is_none() {
            return Cow::Borrowed(self);
        }
        let cloth = self.cloth.filter(|cloth| r > cloth.radius.value());
        let lobes = self.lobes.map(|lobes| lobes.acting_at(r + self.depth.value()));
        Cow::Owned(Self { lobes, cloth, ..self.clone() })
    }

    /// The same net without cloth that limits the unfolding.
    pub(crate) fn without_cloth(&self) -> Cow<'_, Self> {
        match self.cloth {
            None => Cow::Borrowed(self),
            Some(_) => Cow::Owned(Self { cloth: None, ..self.clone() }),
        }
    }

    /// Whether something besides the fibres stores energy all along the meridian: rubber, or a formula.
    pub(crate) fn has_wall(&self) -> bool {
        self.rubber.is_some() || self.has_energy()
    }

    /// Whether a user's own formula gives the energy of the wall.
    pub(crate) fn has_energy(&self) -> bool {
        self.formulas.as_ref().is_some_and(|formulas| formulas.energy.is_some())
    }

    /// Whether a user's own formula has kinks. Quantities that follow from it are then no smooth functions of
    /// the radius.
    pub(crate) fn has_branches(&self) -> bool {
        self.formulas.as_ref().is_some_and(|formulas| formulas.have_branches())
    }

    /// The numbers whose signs decide which branches of the formulas count; not numbers where there are none.
    pub(crate) fn gaps(&self, r: D, tension: D) -> [D; 2 * MOST_GAPS] {
        let none = [D::from(f64::NAN); 2 * MOST_GAPS];
        let formulas = self.formulas.as_ref();
        formulas.map_or(none, |formulas| formulas.gaps(self.sigma(r, tension), r, self.cos_rest))
    }

    /// Whether a user's own formula gives the area.
    pub(crate) fn has_area(&self) -> bool {
        self.formulas.as_ref().is_some_and(|formulas| formulas.area.is_some())
    }

    /// The radii at which the law changes: where cloth becomes taut, and where lobes cease to touch.
    pub(crate) fn kinks(&self) -> [Option<D>; 2] {
        let cloth = self.cloth.map(|cloth| cloth.radius);
        [cloth, self.lobes.map(|lobes| lobes.contact_radius() - self.depth)]
    }

    /// The cross-section: the area A(r) on which the pressure acts, and its derivatives.
    #[inline]
    pub(crate) fn section(&self, r: D) -> Section<D> {
        // An integration asks for it at every radius: the usual section takes no call.
        if self.lobes.is_some() || self.formulas.is_some() {
            return self.section_of_parts(r);
        }
        self.usual_section(r + self.depth)
    }

    #[inline(never)]
    fn section_of_parts(&self, r: D) -> Section<D> {
        if let Some(section) = self.formulas.as_ref().and_then(|formulas| formulas.section(r)) {
            return section;
        }
        let r = r + self.depth;
        self.lobes.as_ref().map_or_else(|| self.usual_section(r), |lobes| lobes.section(r))
    }

    /// A polygon or circle that reaches out to r.
    #[inline]
    fn usual_section(&self, r: D) -> Section<D> {
        let area_rr = self.area_factor * (2.0 * PI);
        let area_r = area_rr * r;
        Section { area: area_r * r * 0.5, area_r, area_rr }
    }

    /// Whether the pressure acts on the reported volume (lobes, or a formula).
    fn is_whole(&self) -> bool {
        self.lobes.is_some() || self.has_area()
    }

    /// The area of the reported volume: that of a circle, or the one on which the pressure acts.
    #[inline]
    pub(crate) fn volume_section(&self, r: D, section: &Section<D>) -> D {
        if self.is_whole() { section.area } else { (r + self.depth).squared() * PI }
    }

    /// The volume on which the pressure acts, over the reported volume.
    pub(crate) fn volume_factor(&self) -> D {
        if self.is_whole() { D::from(1.0) } else { self.area_factor }
    }

    /// Area enclosed by a cross-section, A(r).
    pub(crate) fn area(&self, r: D) -> D {
        self.section(r).area
    }

    /// A'(r).
    pub(crate) fn area_r(&self, r: D) -> D {
        self.section(r).area_r
    }

    #[inline]
    pub(crate) fn wall(&self, sigma: D, r: D) -> Wall<D> {
        let zero = D::from(0.0);
        let mut wall = Wall { w: zero, w_1: zero, w_2: zero, w_11: zero, w_12: zero, w_22: zero };
        if let Some(rubber) = &self.rubber {
            rubber.add(&mut wall, sigma, r, self.cos_rest);
        }
        if let Some(cloth) = &self.cloth {
            cloth.add(&mut wall, sigma, r);
        }
        let formulas = self.formulas.as_ref();
        if let Some(own) = formulas.and_then(|formulas| formulas.wall(sigma, r, self.cos_rest)) {
            wall.add(&own);
        }
        wall
    }

    /// The energies of the wall as they act at `L` radii.
    pub(crate) fn acting_walls<const L: usize>(&self, sigma: [D; L], r: [D; L]) -> [Wall<D>; L] {
        let formulas = self.formulas.as_ref();
        let own = formulas.and_then(|formulas| formulas.walls(sigma, r, self.cos_rest));
        let others = Self { formulas: None, ..self.clone() };
        let mut walls = std::array::from_fn(|i| others.acting_at(r[i].value()).wall(sigma[i], r[i]));
        if let Some(own) = own {
            walls.iter_mut().zip(&own).for_each(|(wall, own)| wall.add(own));
        }
        walls
    }

    /// Meridional length per fibre length; NaN beyond the radius where the fibres would lie along the
    /// parallels.
    pub(crate) fn sigma(&self, r: D, tension: D) -> D {
        ((self.compliance * tension + 1.0).squared() - (self.turn * r).squared()).sqrt()
    }

    /// All local quantities at radius `r` and tension `tension` of all fibres.
    ///
    /// An integration spends most of its time here. The two usual nets are therefore written out: that of a
    /// braid takes half the time of the general formulas, to which both are equal up to rounding.
    pub(crate) fn local(&self, r: D, tension: D) -> Local<D> {
        #[cfg(test)]
        crate::work::count();
        if self.has_wall() || self.cloth.is_some() {
            return self.local_of_everything(r, tension);
        }
        if self.turn.value() == 0.0 {
            // N = T, h = 0.
            let zero = D::from(0.0);
            return Local {
                sigma: self.compliance * tension + 1.0,
                force: tension,
                hoop: zero,
                hoop_r: zero,
                tension_r: zero,
                force_t: D::from(1.0),
                hoop_t: zero,
            };
        }
        if self.compliance.value() == 0.0 {
            let q2 = self.turn * self.turn;
            let q2r = q2 * r;
            let sigma = (-(q2r * r) + 1.0).sqrt();
            let per_sigma = D::from(1.0) / sigma;
            let hoop_t = q2r * per_sigma;
            let hoop = tension * hoop_t;
            let tension_r = hoop * per_sigma * 2.0;
            let hoop_r = (q2 * (tension + r * tension_r) + hoop * hoop_t) * per_sigma;
            return Local { sigma, force: tension * sigma, hoop, hoop_r, tension_r, force_t: sigma, hoop_t };
        }
        self.local_of_everything(r, tension)
    }

    /// ```text
    /// N   = T sigma/(1 + e) + w_1                        h sigma = T q^2 r/(1 + e) + w_2
    /// T_r: sigma T_r/(1+e)^2 + (T/(1+e) + w_11) sigma_r + w_12 = h,       sigma sigma_r = (1 + e) c T_r - q^2 r
    /// ```
    fn local_of_everything(&self, r: D, tension: D) -> Local<D> {
        let stretch = self.compliance * tension + 1.0;
        let sigma = (stretch * stretch - self.turn * self.turn * r * r).sqrt();
        self.local_in(&self.wall(sigma, r), sigma, r, tension)
    }

    /// Tension and local quantities of fibres that don't stretch, where H has the value `energy`. The energy
    /// of the wall is computed only once.
    pub(crate) fn local_with_energy(&self, r: D, energy: D) -> (D, Local<D>) {
        #[cfg(test)]
        crate::work::count();
        let sigma = self.sigma(r, D::from(0.0));
        let wall = self.wall(sigma, r);
        let tension = (energy + wall.w - sigma * wall.w_1) / (sigma * sigma);
        (tension, self.local_in(&wall, sigma, r, tension))
    }

    /// Tension and local quantities of fibres that don't stretch, from the meridional force N = T sigma + w_1.
    pub(crate) fn local_with_force(&self, r: D, sigma: D, force: D) -> (D, Local<D>) {
        #[cfg(test)]
        crate::work::count();
        let wall = self.wall(sigma, r);
        let tension = (force - wall.w_1) / sigma;
        (tension, self.local_in(&wall, sigma, r, tension))
    }

    /// The same with a known energy of the wall.
    #[inline]
    fn local_in(&self, w: &Wall<D>, sigma: D, r: D, tension: D) -> Local<D> {
        let c = self.compliance;
        let stretch = c * tension + 1.0;
        let q2 = self.turn * self.turn;
        let q2r = q2 * r;
        let per_sigma = D::from(1.0) / sigma;
        let per_stretch = D::from(1.0) / stretch;
        let pull = tension * per_stretch;
        let force = pull * sigma + w.w_1;
        let hoop = (pull * q2r + w.w_2) * per_sigma;
        let turn_term = q2r * per_sigma;
        let force_t = sigma * per_stretch * per_stretch + (pull + w.w_11) * stretch * c * per_sigma;
        let tension_r = (hoop - w.w_12 + turn_term * (pull + w.w_11)) / force_t;
        let sigma_r = stretch * c * tension_r * per_sigma - turn_term;
        let pull_r = tension_r * per_stretch * per_stretch;
        let hoop_r = (q2 * (pull + r * pull_r) + w.w_22 + w.w_12 * sigma_r - hoop * sigma_r) * per_sigma;
        let sigma_t = stretch * c * per_sigma;
        let hoop_t = (q2r * per_stretch * per_stretch + w.w_12 * sigma_t - hoop * sigma_t) * per_sigma;
        Local { sigma, force, hoop, hoop_r, tension_r, force_t, hoop_t }
    }

    /// The constant of the motion conjugate to S: H = sigma N - w. It is the same all along a meridian. Its
    /// derivative by the tension at fixed r is sigma dN/dT.
    pub(crate) fn hamiltonian(&self, r: D, tension: D) -> D {
        let sigma = self.sigma(r, tension);
        let strain = self.compliance * tension;
        let wall = self.wall(sigma, r);
        let of_fibres = tension * (sigma * sigma / (strain + 1.0) - strain * 0.5);
        of_fibres + sigma * wall.w_1 - wall.w
    }
}

impl<D: Real> Net<D> {
    /// The same net for another scalar. Each number has its place of [`NUMBERS`], whether parts are absent or
    /// not.
    pub(crate) fn map<E>(&self, mut f: impl FnMut(usize, D) -> E) -> Net<E> {
        Net {
            end_radius: f(0, self.end_radius),
            half_fibre: f(1, self.half_fibre),
            cos_rest: f(2, self.cos_rest),
            sin2_rest: f(3, self.sin2_rest),
            turn: f(4, self.turn),
            compliance: f(5, self.compliance),
            area_factor: f(6, self.area_factor),
            depth: f(7, self.depth),
            lobes: self.lobes.map(|lobes| lobes.map(|i, d| f(8 + i, d))),
            rubber: self.rubber.map(|rubber| {
                let mut place = RUBBER;
                rubber.map(|term| {
                    place += 1;
                    f(place - 1, term)
                })
            }),
            cloth: self
                .cloth
                .map(|c| Cloth { stiffness: f(CLOTH, c.stiffness), radius: f(CLOTH + 1, c.radius) }),
            formulas: self
                .formulas
                .as_ref()
                .map(|formulas| Box::new(formulas.map(|i, d| f(OWN_NUMBERS + i, d)))),
        }
    }

    /// Its numbers with their places.
    pub(crate) fn each(&self, f: impl FnMut(usize, D)) {
        self.map(f);
    }

    /// The values without derivatives.
    pub(crate) fn constant(&self) -> Net<f64> {
        self.map(|_, d| d.value())
    }
}

impl Net<f64> {
    /// How far the pressure stretches the fibres of a braid, 2 pi a p r0^2/(n EA sin^2(alpha0)) with a the
    /// [`Net::area_factor`].
    pub(crate) fn softness(&self) -> f64 {
        self.area_factor * self.compliance * std::f64::consts::TAU / (self.turn * self.turn)
    }

    /// Straight inextensible fibres, circular sections, of half-length 1.
    #[cfg(test)]
    pub(crate) const fn plain() -> Self {
        Self {
            end_radius: 1.0,
            half_fibre: 1.0,
            cos_rest: 1.0,
            sin2_rest: 0.0,
            turn: 0.0,
            compliance: 0.0,
            area_factor: 1.0,
            depth: 0.0,
            lobes: None,
            rubber: None,
            cloth: None,
            formulas: None,
        }
    }

    /// The same net for numbers with derivatives, as a constant.
    pub(crate) fn lift<const N: usize>(&self) -> Net<Dual<N>> {
        self.lift_to()
    }

    /// The same net for another scalar, as a constant.
    pub(crate) fn lift_to<D: Real>(&self) -> Net<D> {
        self.map(|_, d| D::from(d))
    }

    /// The same net with a fraction of the stiffness of wall and cloth.
    pub(crate) fn with_walls(&self, part: f64) -> Self {
        let rubber = self.rubber.map(|rubber| rubber.map(|term| part * term));
        let cloth = self.cloth.map(|c| Cloth { stiffness: part * c.stiffness, ..c });
        let formulas = self.formulas.as_ref().map(|formulas| Box::new(formulas.with_part(part)));
        Self { rubber, cloth, formulas, ..self.clone() }
    }
}

impl<D: Real> EvenPowers<D> {
    /// Rubber after Mooney and Rivlin.
    pub(crate) fn mooney_rivlin(c10: D, c01: D) -> Self {
        let none = D::from(0.0);
        Self { terms: [c10, c10, c10, c01, c01, c01, none, none] }
    }

    /// The energies of both.
    pub(crate) fn with(&self, other: &Self) -> Self {
        Self { terms: std::array::from_fn(|k| self.terms[k] + other.terms[k]) }
    }

    /// Each term changed.
    pub(crate) fn map<E>(self, f: impl FnMut(D) -> E) -> EvenPowers<E> {
        EvenPowers { terms: self.terms.map(f) }
    }

    /// The factors of y^2, 1/y and 1/sigma^2 in the energy of fibres that don't stretch, with y = r^2,
    /// l2^2 = y and l1^2 = sigma^2/cos(alpha0)^2 = (1 - q^2 y)/cos(alpha0)^2. The rest is linear in y.
    pub(crate) fn along_fibres(&self, q2: D, cos2: D) -> [D; 3] {
        let [_, _, both, along, around, product, along_4, around_4] = self.terms;
        let share = q2 / cos2;
        // 1/(l1 l2)^2 = cos^2 (1/y + q^2/sigma^2).
        [around_4 + share * (share * along_4 - product), both * cos2 + around, (both * q2 + along) * cos2]
    }

    /// A derivative of a power is the power times its exponent over the stretch. The exponents are written out: an
    /// integration spends most of its time here.
    fn add(&self, wall: &mut Wall<D>, sigma: D, r: D, cos_rest: D) {
        let (l1, per_sigma, per_r) = (sigma / cos_rest, D::from(1.0) / sigma, D::from(1.0) / r);
        let per_l1 = cos_rest * per_sigma;
        let (a, b, per_a, per_b) = (l1 * l1, r * r, per_l1 * per_l1, per_r * per_r);
        let powers = [a, b, per_a * per_b, per_a, per_b, a * b, a * a, b * b];
        let parts: [D; EVEN_POWERS.len()] = std::array::from_fn(|k| self.terms[k] * powers[k]);
        for (part, term) in parts.iter().zip(&self.terms) {
            wall.w += *part - *term;
        }
        let [a, b, both, per_a, per_b, product, a2, b2] = parts;
        let odd = product - both;
        wall.w_1 += (odd + a - per_a + a2 * 2.0) * 2.0 * per_sigma;
        wall.w_2 += (odd + b - per_b + b2 * 2.0) * 2.0 * per_r;
        let along = (both + per_a) * 3.0 + product + a + a2 * 6.0;
        let around = (both + per_b) * 3.0 + product + b + b2 * 6.0;
        wall.w_11 += along * 2.0 * per_sigma * per_sigma;
        wall.w_12 += (both + product) * 4.0 * per_sigma * per_r;
        wall.w_22 += around * 2.0 * per_r * per_r;
    }
}

impl<D: Real> Cloth<D> {
    /// pi K/r_u: u over (r - r_u)^2.
    pub(crate) fn scale(&self) -> D {
        self.stiffness * PI / self.radius
    }

    /// u = pi K (r - r_u)^2/r_u.
    pub(crate) fn energy(&self, r: D) -> D {
        self.scale() * (r - self.radius).squared()
    }

    /// sigma u(r).
    fn add(&self, wall: &mut Wall<D>, sigma: D, r: D) {
        let excess = r - self.radius;
        let scale = self.scale();
        let u = scale * excess * excess;
        let u_r = scale * excess * 2.0;
        wall.w += sigma * u;
        wall.w_1 += u;
        wall.w_2 += sigma * u_r;
        wall.w_12 += u_r;
        wall.w_22 += sigma * scale * 2.0;
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// An elastic net with rubber and cloth, every term alive.
    pub(crate) fn rich<D: Real>() -> Net<D> {
        Net {
            end_radius: D::from(1.0),
            half_fibre: D::from(5.0),
            cos_rest: D::from(0.9),
            sin2_rest: D::from(0.19),
            turn: D::from(0.19_f64.sqrt()),
            compliance: D::from(0.004),
            area_factor: D::from(0.97),
            depth: D::from(0.1),
            lobes: None,
            rubber: Some(EvenPowers { terms: [0.3, 0.3, 0.3, 0.1, 0.1, 0.1, 0.04, 0.02].map(D::from) }),
            cloth: Some(Cloth { stiffness: D::from(0.7), radius: D::from(1.2) }),
            formulas: None,
        }
    }

    /// Stored energy as a function of (sigma, r) with the fibre strain from the geometry: the definition,
    /// without T.
    fn energy(net: &Net<Dual<2>>, sigma: Dual<2>, r: Dual<2>) -> Dual<2> {
        let strain = (sigma * sigma + (net.turn * r).squared()).sqrt() - 1.0;
        strain * strain / (net.compliance * 2.0) + net.wall(sigma, r).w
    }

    #[test]
    fn force_and_hoop_are_derivatives_of_the_stored_energy() {
        let net: Net<f64> = rich();
        for r in [0.9, 1.1, 1.3, 1.6] {
            let tension = 9.0;
            let sigma = net.sigma(r, tension);
            let w = energy(&rich(), Dual::variable(sigma, 0), Dual::variable(r, 1));
            let local = net.local(r, tension);
            assert!((local.force / w.gradient()[0] - 1.0).abs() < 1e-12);
            assert!((local.hoop * sigma / w.gradient()[1] - 1.0).abs() < 1e-12);
        }
    }

    /// Along the meridian H is constant, dN/dr = h, and the derivatives that the ODE uses are those of N, h
    /// and T.
    #[test]
    fn derivatives_along_the_meridian() {
        let net: Net<f64> = rich();
        let (r, tension, h) = (1.35, 9.0, 1e-5);
        let local = net.local(r, tension);
        let (up, down) = (tension + h * local.tension_r, tension - h * local.tension_r);
        let difference = |f: &dyn Fn(f64, f64) -> f64| (f(r + h, up) - f(r - h, down)) / (2.0 * h);
        // T(r) is known to first order only, so these differences are exact to h^2 |T_rr| ~ 1e-9.
        assert!(difference(&|r, t| net.hamiltonian(r, t)).abs() < 1e-7);
        assert!((difference(&|r, t| net.local(r, t).force) - local.hoop).abs() < 1e-7);
        assert!((difference(&|r, t| net.local(r, t).hoop) - local.hoop_r).abs() < 1e-7);
        let by_t = |f: &dyn Fn(f64) -> f64| (f(tension + h) - f(tension - h)) / (2.0 * h);
        assert!((by_t(&|t| net.local(r, t).force) - local.force_t).abs() < 1e-8);
        assert!((by_t(&|t| net.local(r, t).hoop) - local.hoop_t).abs() < 1e-8);
    }

    /// The energy of even powers is the sum of its terms, and its derivatives are those of this sum.
    #[test]
    fn even_powers_are_those_of_the_list() {
        type Twice = Dual<2>;
        let (sigma, r, cos_rest) = (0.8, 1.3, 0.9);
        for (k, [i, j]) in EVEN_POWERS.into_iter().enumerate() {
            let terms = std::array::from_fn(|other| if other == k { 0.7 } else { 0.0 });
            let (mut found, mut moving) =
                (Net::plain().wall(sigma, r), Net::plain().lift().wall(sigma.into(), r.into()));
            EvenPowers { terms }.add(&mut found, sigma, r, cos_rest);
            let at: [Twice; 2] = [Dual::variable(sigma, 0), Dual::variable(r, 1)];
            EvenPowers { terms: terms.map(Dual::from) }.add(&mut moving, at[0], at[1], cos_rest.into());
            let exact = ((at[0] / cos_rest).powi(i) * at[1].powi(j) - 1.0) * 0.7;
            let pairs = [
                (found.w, exact.value()),
                (found.w_1, exact.gradient()[0]),
                (found.w_2, exact.gradient()[1]),
                (found.w_11, moving.w_1.gradient()[0]),
                (found.w_12, moving.w_1.gradient()[1]),
                (found.w_12, moving.w_2.gradient()[0]),
                (found.w_22, moving.w_2.gradient()[1]),
            ];
            for (found, exact) in pairs {
                assert!((found - exact).abs() < 1e-14 * (1.0 + exact.abs()), "{k}: {found} {exact}");
            }
        }
    }

    /// The nets that are written out are special cases of the general formulas.
    #[test]
    fn usual_nets_agree_with_the_general_formulas() {
        let trellis = Net { turn: 0.42, ..Net::plain() };
        let elastic = Net { compliance: 0.004, ..Net::plain() };
        for net in [Net::plain(), trellis, elastic] {
            let numbers =
                |l: Local<f64>| [l.sigma, l.force, l.hoop, l.hoop_r, l.tension_r, l.force_t, l.hoop_t];
            let (usual, general) = (numbers(net.local(1.4, 9.0)), numbers(net.local_of_everything(1.4, 9.0)));
            for (usual, general) in usual.iter().zip(general) {
                assert!((usual - general).abs() <= 4.0 * f64::EPSILON * general.abs(), "{usual} {general}");
            }
        }
    }

    #[test]
    fn tension_at_equator_meets_the_curvature() {
        let net: Net<f64> = rich();
        for curvature in [-0.05, 1e-12, 0.3, 1.0] {
            let tension = net.at_equator(1.4, net.push(1.4), curvature).unwrap().tension;
            let local = net.local(1.4, tension);
            assert!((net.area_r(1.4) - local.hoop - curvature * local.force).abs() < 1e-12 * local.force);
        }
    }
}
