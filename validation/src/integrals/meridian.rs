//! One meridian by quadrature of its two first integrals, from mid-length to the fitting.
//!
//! D = N - F - A is 0 at mid-length, and 1 - cos(psi) = D/N =: g. With the distance rho from the radius at
//! mid-length,
//!
//! ```text
//! S = integral drho/(sigma sin(psi))        x = integral drho/tan(psi)        V = integral A drho/tan(psi)
//! D = d_1 rho + d_2 rho^2/2 + d_3 rho^3/6 near mid-length        rho = a (cosh(u) - 1), a = d_1/d_2
//! ```

use super::net::Net;

/// Nodes and weights of the Gauss rule with ten points on (0, 1).
const GAUSS: [(f64, f64); 10] = [
    (0.013_046_735_741_414_128, 0.033_335_672_154_344_07),
    (0.067_468_316_655_507_73, 0.074_725_674_575_290_3),
    (0.160_295_215_850_487_8, 0.109_543_181_257_991_02),
    (0.283_302_302_935_376_4, 0.134_633_359_654_998_2),
    (0.425_562_830_509_184_4, 0.147_762_112_357_376_44),
    (0.574_437_169_490_815_6, 0.147_762_112_357_376_44),
    (0.716_697_697_064_623_6, 0.134_633_359_654_998_2),
    (0.839_704_784_149_512_2, 0.109_543_181_257_991_02),
    (0.932_531_683_344_492_2, 0.074_725_674_575_290_3),
    (0.986_953_264_258_585_9, 0.033_335_672_154_344_07),
];
/// Fraction of the radius within which D is taken from its series.
const SERIES: f64 = 1e-4;
/// Longest piece in u.
const PIECE: f64 = 1.2;
/// Number of halvings towards fittings at which the fibres lie nearly along the circumference.
const HALVINGS: u32 = 12;
/// Fraction of the way below which a saddle is taken as an exact cosh.
const SADDLE: f64 = 1e-10;

/// A dimensionless meridian with its integrals.
#[derive(Debug, Clone, Copy)]
pub(super) struct Meridian {
    /// Logarithm of the fibre length divided by the required one; infinite if the meridian doesn't reach the
    /// fitting.
    pub(super) excess: f64,
    /// Axial distance from the fitting to mid-length.
    pub(super) half_length: f64,
    pub(super) half_volume: f64,
    pub(super) force: f64,
    /// A at mid-length. With |F| it gives the scale of forces.
    pub(super) area: f64,
    /// The smallest tension along the way.
    pub(super) least_tension: f64,
}

/// State at mid-length: radius, side relative to the radius of the fittings, tension, and d_1.
#[derive(Debug, Clone, Copy)]
struct Middle {
    radius: f64,
    side: f64,
    tension: f64,
    first: f64,
}

impl Middle {
    /// The state at a radius with the second parameter, which is ln(curvature) for a bulge and ln(T - T of
    /// the cylinder) for a waist.
    fn new(net: &Net, radius: f64, second: f64) -> Option<Self> {
        let side = (radius - net.end).signum();
        if side > 0.0 {
            let curvature = second.exp();
            let tension = net.balancing(radius, curvature)?;
            let force = net.local(radius, tension, net.is_taut(radius))?.force;
            return (force > 0.0).then_some(Self { radius, side, tension, first: curvature * force });
        }
        let cylinder = net.balancing(radius, 0.0)?;
        let more = second.exp();
        let local = net.local(radius, cylinder, net.is_taut(radius))?;
        let tension = cylinder + more;
        let linear = net.is_inextensible() || more < 1e-6 * cylinder.abs();
        let at = net.local(radius, tension, net.is_taut(radius))?;
        let first = if linear { local.hoop_t * more } else { at.hoop - local.hoop };
        (at.force > 0.0 && first > 0.0).then_some(Self { radius, side, tension, first })
    }
}

/// A stretch of the meridian with one law, for D and its slope.
struct Stretch<'a> {
    net: &'a Net,
    middle: Middle,
    taut: bool,
    /// F and H.
    force: f64,
    conserved: f64,
    /// d_1, d_2, d_3 at mid-length, and the distance within which the series is used. Only the first stretch
    /// has one.
    series: [f64; 3],
    within: f64,
}

impl Stretch<'_> {
    fn tension(&self, rho: f64, guess: f64) -> Option<f64> {
        self.net.tension(self.middle.radius - self.middle.side * rho, self.conserved, self.taut, guess)
    }

    /// dD/drho = side (A' - h).
    fn slope(&self, rho: f64) -> Option<f64> {
        let r = self.middle.radius - self.middle.side * rho;
        let local = self.net.local(r, self.tension(rho, self.middle.tension)?, self.taut)?;
        Some(self.middle.side * (self.net.area_r(r) - local.hoop))
    }

    /// Adds the series at mid-length, by central differences of the slope.
    fn with_series(mut self) -> Option<Self> {
        let mut step = SERIES * self.middle.radius;
        let [before, after] = loop {
            match (self.slope(-step), self.slope(step)) {
                (Some(before), Some(after)) => break [before, after],
                _ if step > 1e-3 * SERIES * self.middle.radius => step *= 0.2,
                _ => return None,
            }
        };
        let here = self.slope(0.0)?;
        let second = (after - before) / (2.0 * step);
        self.series = [self.middle.first, second, (before - 2.0 * here + after) / (step * step)];
        self.within = step;
        Some(self)
    }

    /// D, N, sigma and T.
    fn at(&self, rho: f64, guess: f64) -> Option<[f64; 4]> {
        let r = self.middle.radius - self.middle.side * rho;
        let tension = self.tension(rho, guess)?;
        let local = self.net.local(r, tension, self.taut)?;
        let gap = if rho < self.within {
            let [a, b, c] = self.series;
            rho * (a + rho * (b / 2.0 + rho * c / 6.0))
        } else {
            local.force - self.force - self.net.area(r)
        };
        Some([gap, local.force, local.sigma, tension])
    }
}

/// The meridian with a radius and the second parameter at mid-length; none if there is no such meridian.
pub(super) fn meridian(net: &Net, radius: f64, second: f64) -> Option<Meridian> {
    let middle = Middle::new(net, radius, second)?;
    let size = (radius - net.end).abs();
    let taut = net.is_taut(radius);
    let local = net.local(radius, middle.tension, taut)?;
    let force = local.force - net.area(radius);
    let stretch = |taut| Stretch {
        net,
        middle,
        taut,
        force,
        conserved: local.conserved,
        series: [0.0; 3],
        within: 0.0,
    };
    // Cloth changes the law along the way, but neither H nor F.
    let kink =
        net.taut_radius().map(|taut| middle.side * (radius - taut)).filter(|rho| *rho > 0.0 && *rho < size);
    let first = stretch(taut).with_series()?;
    let (d_1, d_2) = (first.series[0], first.series[1]);
    let scale = (d_1 / d_2.abs()).min(size);
    let mut sum = Sum { least: middle.tension, guess: middle.tension, ..Sum::default() };
    let mut from = 0.0;
    if d_2 > 0.0 && scale < 1e-4 * SADDLE * size {
        // Up to this distance, D is that of a cosh.
        let to = SADDLE * size.min(kink.unwrap_or(size));
        let fibre = (2.0 * (1.0 + to / scale)).ln() * (local.force / d_2).sqrt() / local.sigma;
        let x = fibre * local.sigma;
        (sum.fibre, sum.x, sum.volume) = (fibre, x, x * net.volume_area(radius));
        from = (2.0 * to / scale).ln();
    }
    let place = |u: f64| 2.0 * scale * (0.5 * u).sinh().powi(2);
    let end = |rho: f64| 2.0 * (rho / (2.0 * scale)).sqrt().asinh();
    let other = kink.map(|_| stretch(!taut));
    let stretches = [Some((&first, kink.unwrap_or(size))), other.as_ref().map(|other| (other, size))];
    for (stretch, last) in stretches.into_iter().flatten() {
        let to = end(last);
        let pieces = ((to - from) / PIECE).ceil().max(2.0);
        let whole = (to - from) / pieces;
        // If the fibres lie nearly along the circumference, the last piece is halved towards its end.
        let mut left = from;
        let mut halvings = if net.is_steep() { HALVINGS } else { 0 };
        while left < to - 1e-12 * (to - from) {
            let rest = to - left;
            let is_last = rest < 1.5 * whole;
            let step = if is_last && halvings > 0 { 0.5 * rest } else { rest.min(whole) };
            halvings -= u32::from(is_last && halvings > 0);
            for (node, weight) in GAUSS {
                let u = left + step * node;
                let rho = place(u);
                let [gap, force, sigma, tension] = stretch.at(rho, sum.guess)?;
                let turned = gap / force;
                if turned <= 0.0 {
                    return Some(Meridian {
                        excess: f64::INFINITY,
                        half_length: 0.0,
                        half_volume: 0.0,
                        force: 0.0,
                        area: 1.0,
                        least_tension: 0.0,
                    });
                }
                let sine = (turned * (2.0 - turned)).sqrt();
                if sine.is_nan() {
                    return None;
                }
                let along = weight * step * scale * u.sinh();
                let r = middle.radius - middle.side * rho;
                sum.add(along / sine, sigma, 1.0 - turned, net.volume_area(r), tension);
            }
            left += step;
        }
        from = to;
    }
    let least_tension = sum.least.min(other.as_ref().unwrap_or(&first).tension(size, sum.guess)?);
    let excess = (sum.fibre / net.half).ln();
    Some(Meridian {
        excess,
        half_length: sum.x,
        half_volume: sum.volume,
        force,
        area: net.area(radius),
        least_tension,
    })
}

/// Values of the integrals so far.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    fibre: f64,
    x: f64,
    volume: f64,
    least: f64,
    guess: f64,
}

impl Sum {
    fn add(&mut self, along: f64, sigma: f64, cosine: f64, area: f64, tension: f64) {
        self.fibre += along / sigma;
        self.x += along * cosine;
        self.volume += along * cosine * area;
        self.least = self.least.min(tension);
        self.guess = tension;
    }
}
