//! The meridian by quadrature: two first integrals replace the equilibrium ODE. For fibres that stretch see
//! `elastic`.
//!
//! Fibres that don't stretch have sigma^2 = 1 - q^2 r^2, so that the stored energy w is a function W of the
//! radius alone. Besides N cos(chi) = F + A(r) a second quantity is then constant along the meridian,
//! H = sigma N - W (the energy conjugate to S). With y = r^2 and z = |y - y_mid|
//!
//! ```text
//! G = H + W - sigma (F + A)        1 - cos(chi) = G/(H + W)        H + W = sigma N = G + sigma (F + A)
//! S = integral dr/(sigma sin(chi))        d = integral (cos(alpha0) - sigma cos(chi)) dS        V = integral pi (r + depth)^2 sigma cos(chi) dS
//! ```
//!
//! G vanishes at mid-length. In a long braid its slope there is exp(-50), so it is never computed as a
//! difference:
//!
//! ```text
//! G = z (g_1 + g_2 z)        g_1 = sigma k N/(2 r) at mid-length        g_2 = second divided difference of W - sigma (F + A) by y at (mid, mid, y)
//! ```
//!
//! The divided differences of y^2, 1/y, 1/sigma^2, sigma and r are known without cancellation (for example,
//! sigma[y, y_m] = -q^2/(sigma + sigma_m)). A product fg has f_m g[m, m, y] + f[m, m] g[m, y] + f[m, m, y]
//! g(y).
//!
//! The substitution z = rho (r_mid + r) with rho = |r_mid - r| = (g_1/(2 r_mid g_2)) sinh^2(u) removes both
//! the square root at mid-length and the long way along a saddle from the integrands, which become smooth in
//! u. (In z itself they would contain 1/r, singular at the axis, not far beyond a fitting.) A Gauss-Kronrod
//! pair of 10 and 21 points (R. Piessens et al., *QUADPACK*, Springer 1983) finds the pieces by the values. With
//! many derivatives a pass without them finds the pieces first.

use arrayvec::ArrayVec;
use bulge_numerics::Real;
use std::f64::consts::PI;
use std::sync::LazyLock;

mod chebyshev;
mod elastic;
mod formula;

use chebyshev::GRIDS;
use elastic::{Elastic, Tensions};
pub(crate) use elastic::{slope_of_energy, tension_at};
use formula::Bend;

use crate::meridian::{Middle, NoTrajectory, State, Trajectory};
use crate::net::{self, Cloth, Net};

/// Kronrod's nodes between 0 and 1 with their weights, and Gauss' weights of the same nodes.
const PAIR: [(f64, f64, f64); 11] = [
    (0.0, 0.149_445_554_002_916_9, 0.0),
    (0.148_874_338_981_631_21, 0.147_739_104_901_338_49, 0.295_524_224_714_752_87),
    (0.294_392_862_701_460_2, 0.142_775_938_577_060_09, 0.0),
    (0.433_395_394_129_247_2, 0.134_709_217_311_473_34, 0.269_266_719_309_996_35),
    (0.562_757_134_668_604_7, 0.123_491_976_262_065_84, 0.0),
    (0.679_409_568_299_024_4, 0.109_387_158_802_297_64, 0.219_086_362_515_982_04),
    (0.780_817_726_586_416_9, 0.093_125_454_583_697_6, 0.0),
    (0.865_063_366_688_984_5, 0.075_039_674_810_919_96, 0.149_451_349_150_580_6),
    (0.930_157_491_355_708_2, 0.054_755_896_574_351_995, 0.0),
    (0.973_906_528_517_171_7, 0.032_558_162_307_964_725, 0.066_671_344_308_688_14),
    (0.995_657_163_025_808_1, 0.011_694_638_867_371_874, 0.0),
];
/// Largest relative difference of the two rules at which the larger rule is accepted. The error of the latter
/// is about the power 1.5 of that.
const DIFFERENCE: f64 = 1e-9;
/// Where the fibres run at an angle, the error of the shortening is relative to at least this fraction of the
/// fibre length.
const ANGLE: f64 = 1e-2;
/// Length in u of the piece next to the fitting, where the integrands change most; each further one is twice
/// as long.
const PIECE: f64 = 1.5;
/// Pieces after which an integral is given up.
const MOST_PIECES: usize = 60;
/// Least ratio of z to g_1/g_2 at the fitting. Below it the map changes nothing.
const LEAST_RATIO: f64 = 0.1;
/// Largest 1 - cos(chi), as in the integration of the ODE.
const MOST_TURNED: f64 = 1.999;

/// Whether the meridians of a net are quadratures. The net must have no lobes, no formula for the area and no
/// kink in a formula.
pub(crate) fn suits<D: Real>(net: &Net<D>) -> bool {
    net.lobes.is_none() && !net.has_area() && !net.has_branches()
}

/// Makes the grids on which the meridians of a net are interpolated, once in a process. A solve then
/// allocates nothing.
pub(crate) fn prepare(net: &Net<f64>) {
    if net.compliance != 0.0 || net.has_energy() {
        LazyLock::force(&GRIDS);
    }
}

/// The quantities of both ends that the integrands need. The index m means mid-length.
struct Ends<D> {
    /// +1: bulge, -1: waist.
    side: f64,
    /// r_mid - r at the fitting, and its size.
    bulge: D,
    size: D,
    r_m: D,
    q2: D,
    depth: D,
    cos_rest: D,
    sin2_rest: D,
}

impl<D: Real> Ends<D> {
    fn of(net: &Net<D>, middle: &Middle<D>) -> Self {
        let side = middle.bulge.value().signum();
        Self {
            side,
            bulge: middle.bulge,
            size: middle.bulge * side,
            r_m: net.end_radius + middle.bulge,
            q2: net.turn * net.turn,
            depth: net.depth,
            cos_rest: net.cos_rest,
            sin2_rest: net.sin2_rest,
        }
    }
}

/// A meridian as a function of its radius.
trait Meridian<D: Real> {
    fn ends(&self) -> &Ends<D>;

    /// g_2 over g_1 at mid-length, times z at the fitting.
    fn ratio(&self) -> f64;

    /// Where the cloth comes taut, as rho over its value at the fitting, if that is on the way.
    fn kink(&self) -> Option<f64>;

    fn at(&self, point: &Point) -> Local<D>;

    /// The tension at the fitting, where `net` acts, and the net there.
    fn at_fitting(&self, net: &Net<D>, end: &Local<D>) -> (D, net::Local<D>);

    /// dS, dd and dV over `d(rho)/(2 sqrt(rho size))`. `None` where the fibres can't be.
    #[inline]
    fn rates(&self, point: &Point) -> Option<[D; 3]> {
        let at = self.at(point);
        let ends = self.ends();
        let turned = at.turned.value();
        // A comparison with NaN is false.
        let exists = at.g.value() > 0.0 && at.whole.value() > 0.0 && turned < MOST_TURNED;
        if !exists || turned.is_nan() {
            return None;
        }
        let square = ends.size * at.whole / (at.g * (-at.turned + 2.0) * (at.r + ends.r_m));
        let fibre = square.sqrt() * 2.0 / at.sigma;
        let longer = ends.q2 * at.y - ends.sin2_rest - at.strain * (at.strain + 2.0);
        let shortening = longer / (ends.cos_rest + at.sigma) + at.sigma * at.turned;
        let section = (at.r + ends.depth).squared() * at.sigma * (-at.turned + 1.0) * PI;
        Some([fibre, fibre * shortening, fibre * section])
    }
}

/// Fibres that don't stretch.
struct Inextensible<'a, D> {
    ends: Ends<D>,
    end_radius: D,
    sigma_m: D,
    /// F + A - u at mid-length, with u the cloth's energy.
    pull: D,
    /// g_1.
    slope: D,
    /// Coefficient of y^2 in W, and those of 1/y and 1/sigma^2 in the second divided difference of W.
    wall: Option<[D; 3]>,
    /// That of a user's own formula for the energy.
    formula: Option<&'a Bend<D>>,
    /// Coefficients of y and r in A - u.
    area: [D; 2],
    /// 1/(2 r_m), 1/(2 sigma_m), q^2/(2 sigma_m).
    halves: [D; 3],
    cloth: Option<Cloth<D>>,
}

/// The meridian at one radius.
struct Local<D> {
    y: D,
    r: D,
    sigma: D,
    /// Strain of the fibres.
    strain: D,
    /// sigma (N - F - A)/z.
    g: D,
    /// sigma N.
    whole: D,
    /// 1 - cos(chi).
    turned: D,
}

/// A point of the quadrature: rho over its value at the fitting, the weight, and whether the cloth is slack
/// there although it is taut at mid-length.
#[derive(Debug, Clone, Copy)]
struct Point {
    part: f64,
    weight: f64,
    slack: bool,
}

impl<'a, D: Real> Inextensible<'a, D> {
    fn of(net: &Net<D>, middle: &Middle<D>, formula: Option<&'a Bend<D>>) -> Self {
        let one = D::from(1.0);
        let ends = Ends::of(net, middle);
        let Ends { r_m, q2, .. } = ends;
        let net = net.acting_at(r_m.value());
        let y_m = r_m * r_m;
        let v_m = -(q2 * y_m) + 1.0;
        let sigma_m = v_m.sqrt();
        let force = middle.force;
        let half_sigma = one / (sigma_m * 2.0);
        let halves = [one / (r_m * 2.0), half_sigma, q2 * half_sigma];
        let mut area = [net.area_factor * PI, net.area_factor * net.depth * (2.0 * PI)];
        let mut pull = force;
        if let Some(cloth) = &net.cloth {
            // u = kappa (r - r_u)^2: A - u is a quadratic polynomial of r as A is.
            let kappa = cloth.scale();
            area = [area[0] - kappa, area[1] + kappa * cloth.radius * 2.0];
            pull = pull - kappa * (r_m - cloth.radius).squared();
        }
        let wall = net.rubber.as_ref().map(|rubber| {
            let [of_square, of_inverse, of_sigma] = rubber.along_fibres(q2, net.cos_rest * net.cos_rest);
            [of_square, of_inverse / (y_m * y_m), of_sigma * q2 * q2 / (v_m * v_m)]
        });
        Self {
            sigma_m,
            pull,
            slope: sigma_m * middle.curvature * force * halves[0] * ends.side,
            wall,
            formula,
            area,
            halves,
            cloth: net.cloth,
            end_radius: net.end_radius,
            ends,
        }
    }

    /// The meridian at one radius with G/z, and g_2.
    #[inline]
    fn with_curve(&self, part: f64, slack: bool) -> (Local<D>, D) {
        let Ends { r_m, q2, .. } = self.ends;
        let r = r_m - self.ends.bulge * part;
        let sum = r + r_m;
        let z = self.ends.size * sum * part;
        let y = r * r;
        let v = -(q2 * y) + 1.0;
        let sigma = v.sqrt();
        // First divided differences of r, sigma and A - u, and the second ones.
        let r_1 = D::from(1.0) / sum;
        let sigma_1 = -(q2 / (sigma + self.sigma_m));
        let area_1 = self.area[0] + self.area[1] * r_1;
        let area_2 = -(self.area[1] * r_1 * r_1 * self.halves[0]);
        let sigma_2 = -(sigma_1 * sigma_1 * self.halves[1]);
        let mut pull = self.pull - area_1 * z * self.ends.side;
        let mut curve = self.halves[2] * area_1 - self.sigma_m * area_2 - sigma_2 * pull;
        if let Some(wall) = &self.wall {
            curve += wall[0] + wall[1] / y + wall[2] / v;
        }
        if let Some(formula) = self.formula {
            curve += formula.at(part) * r_1 * r_1;
        }
        let mut g = self.slope + curve * z;
        if let Some(cloth) = &self.cloth {
            let u = cloth.scale() * (r - cloth.radius).squared();
            pull += u;
            if slack {
                g = g - sigma * u / z;
            }
        }
        let rise = g * z;
        let whole = rise + sigma * pull;
        (Local { y, r, sigma, strain: D::from(0.0), g, whole, turned: rise / whole }, curve)
    }
}

impl<D: Real> Meridian<D> for Inextensible<'_, D> {
    fn ends(&self) -> &Ends<D> {
        &self.ends
    }

    fn ratio(&self) -> f64 {
        let (_, curve) = self.with_curve(0.0, false);
        2.0 * (self.ends.r_m * self.ends.size * curve / self.slope).value()
    }

    fn kink(&self) -> Option<f64> {
        let cloth = self.cloth.filter(|cloth| cloth.radius.value() > self.end_radius.value())?;
        Some(((self.ends.r_m - cloth.radius) / self.ends.size).value())
    }

    #[inline]
    fn at(&self, point: &Point) -> Local<D> {
        #[cfg(test)]
        crate::work::count();
        self.with_curve(point.part, point.slack).0
    }

    fn at_fitting(&self, net: &Net<D>, end: &Local<D>) -> (D, net::Local<D>) {
        net.local_with_force(end.r, end.sigma, end.whole / end.sigma)
    }
}

/// A part of the quadrature: its ends in u, and whether the cloth is slack there although it is taut at mid-length.
type Piece = (f64, f64, bool);

/// The sums of both rules over the points of a piece, the larger rule with derivatives.
struct Sums<D> {
    kronrod: [D; 3],
    /// That rule less the other one, and the sizes of the terms, of fibre length and shortening.
    difference: [f64; 2],
    size: [f64; 2],
}

impl<D: Real> Sums<D> {
    /// `None` where the fibres can't be.
    #[inline]
    fn of(meridian: &impl Meridian<D>, points: &[Point; 21]) -> Option<Self> {
        let mut sums = Self { kronrod: [D::from(0.0); 3], difference: [0.0; 2], size: [0.0; 2] };
        for (i, point) in points.iter().enumerate() {
            let (_, kronrod, gauss) = PAIR[i.div_ceil(2)];
            let rates = meridian.rates(point)?;
            for (sum, rate) in sums.kronrod.iter_mut().zip(rates) {
                *sum = rate.scale_add(point.weight, *sum);
            }
            let [fibre, shortening, _] = rates.map(|rate| rate.value() * point.weight);
            for (k, term) in [fibre, shortening].into_iter().enumerate() {
                sums.difference[k] += term * (1.0 - gauss / kronrod);
                sums.size[k] += term.abs();
            }
        }
        Some(sums)
    }

    /// Whether both rules agree on fibre length and shortening.
    fn agree(&self, ends: &Ends<D>) -> bool {
        let mut size = self.size;
        // An angle shortens or lengthens the muscle by itself. Near the straight meridian the sum is a difference
        // with rounding.
        if ends.q2.value() > 0.0 {
            size[1] += ANGLE * size[0];
        }
        (0..2).all(|k| self.difference[k].abs() <= DIFFERENCE * size[k])
    }
}

/// The pieces of a quadrature.
struct Plan {
    pieces: ArrayVec<Piece, MOST_PIECES>,
    ratio: f64,
    evaluations: u32,
}

impl Plan {
    /// Halves pieces until both rules agree on each. Returns the sums over all.
    fn fill<D: Real>(&mut self, meridian: &impl Meridian<D>) -> Result<[D; 3], NoTrajectory> {
        self.ratio = meridian.ratio().max(LEAST_RATIO);
        let end = self.ratio.sqrt().asinh();
        if !(end.is_finite() && end > 0.0) {
            return Err(NoTrajectory { evaluations: 1 });
        }
        // The cloth comes taut at a border between two pieces.
        let kink = meridian.kink().map(|part| (self.ratio * part).sqrt().asinh().min(end));
        // On the stack: a solve allocates nothing.
        let mut open: ArrayVec<Piece, MOST_PIECES> = ArrayVec::new();
        // The pieces begin at the fitting, where the integrands change most, and grow towards mid-length.
        for (low, high, slack) in [(0.0, kink.unwrap_or(end), false), (kink.unwrap_or(end), end, true)] {
            let (mut top, mut length) = (high, PIECE);
            while top > low {
                let bottom = if top - low < 1.3 * length { low } else { top - length };
                open.try_push((bottom, top, slack)).map_err(|_| NoTrajectory { evaluations: 1 })?;
                (top, length) = (bottom, 2.0 * length);
            }
        }
        let mut total = [D::from(0.0); 3];
        while let Some(piece) = open.pop() {
            self.evaluations += 21;
            let none = NoTrajectory { evaluations: self.evaluations };
            let sums = Sums::of(meridian, &points(piece, self.ratio)).ok_or(none)?;
            if sums.agree(meridian.ends()) {
                self.pieces.push(piece);
                total = plus(total, sums.kronrod);
            } else if self.pieces.len() + open.len() + 1 >= MOST_PIECES {
                return Err(none);
            } else {
                let (low, high, slack) = piece;
                let middle = 0.5 * (low + high);
                open.extend([(low, middle, slack), (middle, high, slack)]);
            }
        }
        Ok(total)
    }

    /// The sums over the same pieces with other derivatives.
    fn again<D: Real>(&self, meridian: &impl Meridian<D>) -> Option<[D; 3]> {
        self.pieces.iter().try_fold([D::from(0.0); 3], |total, piece| {
            Some(plus(total, Sums::of(meridian, &points(*piece, self.ratio))?.kronrod))
        })
    }
}

fn plus<D: Real>(a: [D; 3], b: [D; 3]) -> [D; 3] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// Kronrod's points of a piece: its middle, then the pairs on both sides of it.
fn points((low, high, slack): Piece, ratio: f64) -> [Point; 21] {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let per_end = 1.0 / ratio.sqrt();
    let at_middle = middle.exp();
    // `growth` is e^u.
    let point = |u: f64, growth: f64, weight: f64| {
        let (sinh, cosh) = if u < 1e-2 {
            (u.sinh(), u.cosh())
        } else {
            (0.5 * (growth - 1.0 / growth), 0.5 * (growth + 1.0 / growth))
        };
        Point { part: (sinh * per_end).powi(2), weight: weight * half * cosh * per_end, slack }
    };
    let mut points = [point(middle, at_middle, PAIR[0].1); 21];
    for (sides, (node, weight, _)) in points[1..].chunks_exact_mut(2).zip(&PAIR[1..]) {
        let (away, growth) = (half * node, (half * node).exp());
        sides[0] = point(middle + away, at_middle * growth, *weight);
        sides[1] = point(middle - away, at_middle / growth, *weight);
    }
    points
}

/// Derivatives up to which a piece that is halved costs less than a pass without derivatives that finds the pieces.
const FEW: usize = 4;

/// The meridian from the middle to the fitting.
pub(crate) fn trajectory<D: Real>(net: &Net<D>, middle: Middle<D>) -> Result<Trajectory<D>, NoTrajectory> {
    let values = middle.constant();
    let plain = net.constant();
    let few = size_of::<D>() <= (1 + FEW) * size_of::<f64>();
    let mut plan = Plan { pieces: ArrayVec::new(), ratio: 0.0, evaluations: 0 };
    if plain.compliance == 0.0 {
        if !plain.has_energy() {
            if !few {
                plan.fill(&Inextensible::of(&plain, &values, None))?;
            }
            return along(net, &middle, &Inextensible::of(net, &middle, None), plan);
        }
        // A formula that no grid resolves takes the pieces of the other way.
        if let Some(bend) = Bend::resolved(&plain, &values, &mut plan.evaluations) {
            if !few {
                plan.fill(&Inextensible::of(&plain, &values, Some(&bend)))?;
            }
            let bend = Bend::on(&bend, net, &middle);
            return along(net, &middle, &Inextensible::of(net, &middle, bend.as_ref()), plan);
        }
    }
    let tensions = Tensions::of(&plain, &values, &mut plan.evaluations);
    let none = NoTrajectory { evaluations: plan.evaluations };
    let tensions = tensions.ok_or(none)?;
    if !few {
        plan.fill(&Elastic::of(&plain, &values, &tensions).ok_or(none)?)?;
    }
    along(net, &middle, &Elastic::of(net, &middle, &tensions).ok_or(none)?, plan)
}

/// The integrals along a meridian: over the pieces of a plan, or over those that it finds itself.
fn along<D: Real>(
    net: &Net<D>,
    middle: &Middle<D>,
    meridian: &impl Meridian<D>,
    mut plan: Plan,
) -> Result<Trajectory<D>, NoTrajectory> {
    let sums = if plan.pieces.is_empty() { Some(plan.fill(meridian)?) } else { plan.again(meridian) };
    let evaluations = plan.evaluations;
    let none = NoTrajectory { evaluations };
    let sums = sums.ok_or(none)?;
    let mid_radius = net.end_radius + middle.bulge;
    let at_middle = net.acting_at(mid_radius.value());
    let mid_force = middle.force;
    let force = mid_force - at_middle.area(mid_radius);
    let end = end(net, meridian, sums);
    let departure = (end.force * end.state[crate::meridian::COS] - net.area(net.end_radius) - force).value();
    let sizes = [mid_force, end.force, net.area(net.end_radius)].map(|size| size.value().abs());
    let first_integral = departure.abs() / sizes.into_iter().fold(0.0, f64::max);
    if !first_integral.is_finite() {
        return Err(none);
    }
    Ok(Trajectory {
        half_fibre: sums[0] + middle.straight,
        end: middle.with_straight(&at_middle, end.state),
        force,
        mid_tension: middle.tension,
        steps: u32::try_from(plan.pieces.len()).unwrap_or(u32::MAX),
        evaluations,
        first_integral,
    })
}

struct End<D> {
    state: State<D>,
    /// Meridional force at the fitting.
    force: D,
}

fn end<D: Real>(net: &Net<D>, meridian: &impl Meridian<D>, sums: [D; 3]) -> End<D> {
    let (radius, ends) = (net.end_radius, meridian.ends());
    let at = meridian.at(&Point { part: 1.0, weight: 0.0, slack: meridian.kink().is_some() });
    let net = net.acting_at(radius.value());
    let cos = -at.turned + 1.0;
    let sin = (at.turned * (-at.turned + 2.0)).sqrt() * ends.side;
    let (tension, local) = meridian.at_fitting(&net, &at);
    let force = local.force;
    let curvature = (net.area_r(radius) - local.hoop * cos) / force;
    End { state: [ends.bulge, sums[1], sin, cos, curvature, tension, sums[2]], force }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meridian;
    use crate::net::EvenPowers;
    use crate::unknowns::Unknowns;
    use bulge_numerics::Dual;

    fn braid() -> Net<f64> {
        let (sin, cos) = 28.6_f64.to_radians().sin_cos();
        Net { half_fibre: 15.0 / cos, cos_rest: cos, sin2_rest: sin * sin, turn: sin, ..Net::plain() }
    }

    fn nets() -> Vec<(&'static str, Net<f64>)> {
        let rubber = Some(EvenPowers::mooney_rivlin(0.5, 0.2));
        let even = Some(EvenPowers { terms: [0.5, 0.3, 0.2, 0.1, 0.4, 0.1, 0.05, 0.08] });
        let cloth = Some(Cloth { stiffness: 3.0, radius: 1.1 });
        vec![
            ("braid", braid()),
            ("bladder", Net { rubber, depth: -0.1, ..braid() }),
            ("even powers", Net { rubber: even, ..braid() }),
            ("even powers, elastic", Net { rubber: even, compliance: 1e-3, ..braid() }),
            ("fittings", Net { rubber, end_radius: 0.8, ..braid() }),
            ("straight", Net { half_fibre: 3.0, area_factor: 0.98, depth: 0.1, ..Net::plain() }),
            ("cloth", Net { half_fibre: 3.0, cloth, ..Net::plain() }),
            ("all", Net { rubber, cloth, depth: 0.1, half_fibre: 5.0, ..braid() }),
            ("elastic", Net { compliance: 4e-3, ..braid() }),
            ("elastic bladder", Net { compliance: 1e-3, rubber, depth: -0.1, ..braid() }),
            ("hardly elastic", Net { compliance: 1e-7, rubber, end_radius: 0.8, ..braid() }),
            ("elastic, straight", Net { compliance: 1e-2, half_fibre: 3.0, depth: 0.1, ..Net::plain() }),
            ("elastic cloth", Net { compliance: 4e-3, cloth, ..braid() }),
            ("elastic, straight, cloth", Net { compliance: 1e-2, half_fibre: 3.0, cloth, ..Net::plain() }),
            ("elastic, all", Net { compliance: 1e-3, rubber, cloth, depth: 0.1, half_fibre: 5.0, ..braid() }),
        ]
    }

    #[test]
    fn the_pair_is_exact_to_its_degrees() {
        let integral = |degree: i32, rule: fn(&(f64, f64, f64)) -> f64| -> f64 {
            PAIR.iter().map(|p| rule(p) * p.0.powi(degree) * if p.0 > 0.0 { 2.0 } else { 1.0 }).sum()
        };
        for degree in (0..32).step_by(2) {
            let exact = 2.0 / f64::from(degree + 1);
            assert!((integral(degree, |p| p.1) - exact).abs() < 4e-16, "{degree}");
            assert_eq!((integral(degree, |p| p.2) - exact).abs() < 4e-16, degree < 20, "{degree}");
        }
        assert!((integral(34, |p| p.1) - 2.0 / 35.0).abs() > 1e-14);
    }

    /// Bulges and waists, shallow and deep, near a saddle and far from it, agree with the ODE, with all
    /// derivatives.
    #[test]
    fn agrees_with_the_equilibrium_ode() {
        let mut tried = Vec::new();
        for (name, net) in nets() {
            let mut of_this = 0;
            for (side, ln_bulge) in [(1.0, -0.7), (1.0, -4.0), (-1.0, -2.0), (-1.0, -5.0)] {
                for second in [-30.0, -8.0, -1.5, -0.5] {
                    let lifted = net.map(|_, d| Dual::<6>::from(d));
                    let seeded = Net {
                        turn: lifted.turn + Dual::variable(0.0, 2),
                        end_radius: lifted.end_radius + Dual::variable(0.0, 3),
                        rubber: lifted.rubber.map(|rubber| rubber.map(|term| term + Dual::variable(0.0, 4))),
                        compliance: if net.compliance > 0.0 {
                            Dual::variable(net.compliance, 5)
                        } else {
                            lifted.compliance
                        },
                        ..lifted
                    };
                    let at = Unknowns::new(&net, side, [ln_bulge, second]);
                    let Some(middle) = at.middle(&seeded, Dual::variable) else { continue };
                    let ode = meridian::trajectory(&seeded, middle, 1e-13);
                    let found = trajectory(&seeded, middle);
                    let Some(ode) = ode.ok().filter(|ode| ode.end[meridian::COS].value() > -0.5) else {
                        continue;
                    };
                    let Ok(found) = found else { panic!("{name} {side} {ln_bulge} {second}") };
                    // With few derivatives one pass finds pieces and sums.
                    let few = net.map(|_, d| Dual::<2>::from(d));
                    let few = trajectory(&few, at.middle(&few, Dual::variable).unwrap()).unwrap();
                    for (many, few) in [(found.half_fibre, few.half_fibre), (found.end[1], few.end[1])] {
                        let first = many.gradient().iter().zip(few.gradient());
                        let slopes = first.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                        let largest = few.gradient().iter().fold(few.value().abs(), |m, v| m.max(v.abs()));
                        assert!(slopes <= 1e-11 * largest, "{name} {side} {ln_bulge} {second}: {slopes:e}");
                    }
                    let pairs = [
                        (ode.half_fibre, found.half_fibre, 0.0),
                        (ode.end[1], found.end[1], 1e-2 * ode.half_fibre.value()),
                        (ode.end[2], found.end[2], 0.0),
                        (ode.end[3], found.end[3], 1.0),
                        (ode.end[4], found.end[4], ode.end[2].value().abs()),
                        (ode.end[5], found.end[5], 0.0),
                        (ode.end[6], found.end[6], 0.0),
                        (ode.force, found.force, 1.0),
                    ];
                    for (i, (a, b, floor)) in pairs.iter().enumerate() {
                        let size = a.value().abs() + floor;
                        let error = (a.value() - b.value()).abs() / size;
                        assert!(
                            error < 2e-11,
                            "{name} {side} {ln_bulge} {second} {i}: {error:e} {a:?} {b:?}"
                        );
                        let slopes = a.gradient().iter().zip(b.gradient());
                        let largest = a.gradient().iter().fold(size, |m, v| m.max(v.abs()));
                        let error = slopes.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max) / largest;
                        assert!(error < 1e-9, "{name} {side} {ln_bulge} {second} {i}: {error:e} {a:?} {b:?}");
                    }
                    assert!(found.first_integral < 1e-12, "{name} {:e}", found.first_integral);
                    of_this += 1;
                }
            }
            tried.push((name, of_this));
        }
        // 163 of the 208 have a meridian that doesn't turn far back; straight fibres have no waist.
        let all: u32 = tried.iter().map(|(_, count)| count).sum();
        assert!(all >= 160 && tried.iter().all(|(_, count)| *count >= 6), "{all}: {tried:?}");
    }

    /// A deep waist between fittings on which the fibres nearly lie along the circumference: G'' grows a
    /// thousandfold within a fortieth of the way.
    #[test]
    fn a_deep_waist_keeps_its_first_integral() {
        let turn: f64 = 0.555_101_278_868_038;
        let rubber = Some(EvenPowers::mooney_rivlin(0.012_229_751_065_880_427, 0.0));
        for compliance in [0.0, 1.838_454_295_801_838e-7] {
            let net = Net {
                end_radius: 1.759_921_190_323_371_1,
                half_fibre: 17.791_240_408_582_47,
                cos_rest: (1.0 - turn * turn).sqrt(),
                sin2_rest: turn * turn,
                turn,
                compliance,
                rubber,
                ..Net::plain()
            };
            let at = Unknowns::new(&net, -1.0, [0.482_900_125_306_665_76, -9.216_759_708_977_916]);
            let found = trajectory(&net, at.middle(&net, |value, _| value).unwrap()).unwrap();
            assert!(found.first_integral < 1e-12, "{compliance} {:e}", found.first_integral);
        }
    }
}
