//! Starting values for the shooting, and the limit to which a braid can be drawn out.

use bulge_numerics::{gauss, root::illinois};

use crate::net::Net;
use crate::shooting::straight_contraction;
use crate::unknowns::{Kind, Unknowns, is_limited, steepest};

/// Largest difference of the contraction from that of a straight meridian for which the start is taken from
/// the linear solution.
const SHALLOW: f64 = 1e-4;

/// Fraction of the way to the circle of the lobes. Beyond it an arc that ignores the lobes is no start.
const NEARLY_OPEN: f64 = 0.9;

/// Starting values, off by some per cent to some ten per cent.
pub(crate) fn start(net: &Net<f64>, contraction: f64) -> Option<Unknowns> {
    open_start(net, contraction).or_else(|| usual_start(net, contraction))
}

fn usual_start(net: &Net<f64>, contraction: f64) -> Option<Unknowns> {
    // Fibres that hardly turn bulge as straight ones do. So does a net that has no cylinder at the fitting's
    // radius.
    match straight_contraction(net) {
        Some(straight)
            if straight >= contraction - SHALLOW || net.turn * net.turn * net.half_fibre >= 0.02 =>
        {
            net_start(net, contraction)
        }
        _ => arc_start(net, contraction),
    }
}

/// A start for lobes that form a circle in the middle of the muscle, or for cloth that carries the pressure
/// there. Straight fibres at that radius r* lie between two curved ends. Let `g = (B(r*) - B(r))/T` with
/// B = A - u and u of the cloth. The first integral gives cos(psi) = 1 - g. The fibre length of an end and
/// its shortening against that length are
///
/// ```text
/// S_end = integral dr/sin(psi) from R to r* - z        d = integral tan(psi/2) dr,  tan^2(psi/2) = g/(2 - g)
/// ```
///
/// In the middle r* - r grows as cosh(lambda s), lambda^2 = -B''(r*)/T. An angle is neglected. `None` if the
/// middle isn't of this kind.
fn open_start(net: &Net<f64>, contraction: f64) -> Option<Unknowns> {
    // A braid carries the pressure even where its cloth is taut.
    let is_open = is_limited(net, 1.0) && (net.turn == 0.0 || net.lobes.is_some());
    let room = if is_open { net.most_bulge() } else { f64::INFINITY };
    let limit = net.end_radius + room;
    let angle = (6.0 * contraction).max(0.0).sqrt();
    if !room.is_finite() || 0.5 * angle * net.half_fibre < NEARLY_OPEN * room {
        return None;
    }
    let carried = |r: f64| {
        let net = net.acting_at(r);
        net.area(r) - net.cloth.map_or(0.0, |cloth| cloth.energy(r))
    };
    let rim = net.acting_at(limit);
    let bend = rim.cloth.map_or(0.0, |cloth| 2.0 * cloth.scale()) - rim.section(limit).area_rr;
    let most = carried(limit);
    let missing = |r: f64| most - carried(r);
    // r = r* - room exp(-u), because the length of the end has a logarithm at r*. Its last piece is linear.
    // Stiff cloth is taut on a small part of the room.
    let taut = net.cloth.map_or(room, |cloth| (limit - cloth.radius).clamp(1e-12 * room, room));
    let last = 6.0 + (room / taut).ln();
    let panels = if last > 8.0 { 24 } else { 6 };
    let along = |f: &dyn Fn(f64) -> f64| -> f64 {
        let piece = |i: i32| {
            let (from, to) = (last * f64::from(i) / f64::from(panels), last / f64::from(panels));
            gauss::integrate(|part| {
                let z = room * (-(from + part * to)).exp();
                f(missing(limit - z)) * z * to
            })
        };
        (0..panels).map(piece).sum()
    };
    let shortening = |tension: f64| {
        along(&|gap| {
            let g = (gap / tension).max(0.0);
            (g / (2.0 - g).max(1e-9)).sqrt()
        })
    };
    let asked = |tension: f64| {
        net.half_fibre * (contraction * net.cos_rest + 1.0 - net.cos_rest + net.compliance * tension)
    };
    let least = (0.5 * missing(net.end_radius)).ln();
    let ln_tension = illinois(|ln_t| shortening(ln_t.exp()) - asked(ln_t.exp()), least, least + 20.0, 1e-3);
    let tension = ln_tension.exp();
    let end = along(&|gap| {
        let g = gap / tension;
        1.0 / (g * (2.0 - g)).max(1e-18).sqrt()
    });
    let rate = (bend / tension).sqrt();
    let straight = net.half_fibre * (1.0 + net.compliance * tension) - end;
    // r* - r at mid-length is 2 z exp(-lambda s), with the z at which the end was left.
    let ln_gap = (2.0 * room).ln() - last - rate * straight;
    if ln_gap > (0.5 * room).ln() - last {
        return None;
    }
    let ln_curvature = ln_gap + 2.0 * rate.ln();
    // push = T k at mid-length, over k B. With an angle the push of the cylinder is added.
    let first = if net.turn == 0.0 {
        ln_tension - room.ln()
    } else {
        (tension * (rim.local(limit, tension).hoop_t + ln_curvature.exp()) / room).ln()
    };
    Some(Unknowns { kind: Kind::Bulge, logs: [first, ln_curvature] })
}

/// Straight fibres form a circular arc of the stretched fibre length and half-angle K. `sin(K)/K` is the end
/// distance over the fibre length. The tension that the curvature requires stretches the fibres.
fn arc_start(net: &Net<f64>, contraction: f64) -> Option<Unknowns> {
    let arc = |angle: f64| {
        let straight = net.half_fibre;
        let radius = |length: f64| net.end_radius + length * (1.0 - angle.cos()) / angle;
        let mut strain: f64 = 0.0;
        if net.compliance > 0.0 {
            // T = A'/k, and A' grows with the stretched length. The iteration converges unless the fibres
            // balloon.
            for _ in 0..6 {
                let length = straight * (1.0 + strain);
                strain = (net.compliance * slope_at(net, radius(length)) * length / angle).min(2.0);
            }
        }
        let length = straight * (1.0 + strain);
        let end_distance =
            (1.0 + strain) * if angle < 1e-4 { 1.0 - angle * angle / 6.0 } else { angle.sin() / angle };
        (end_distance, length, strain)
    };
    let angle = if net.compliance > 0.0 {
        let mismatch = |ln: f64| arc(ln.exp()).0 - (1.0 - contraction);
        illinois(mismatch, 1e-7_f64.ln(), 2.6_f64.ln(), 1e-3).exp()
    } else if contraction > 0.0 {
        let x = 6.0 * contraction; // K^2 = 6 eps (1 + 3 eps/10 + ...), bent up towards the Mylar balloon
        (x * (1.0 + 0.3 * contraction + 1.2 * contraction * contraction)).sqrt()
    } else {
        return None;
    };
    let (_, length, _) = arc(angle);
    let bulge = length * 0.5 * angle * (1.0 - angle * angle / 12.0);
    Some(Unknowns::new(net, 1.0, [bulge.ln(), (angle / length).ln()]))
}

/// A'(r) for a start. Where the lobes end, it is that of the last radius with some room.
fn slope_at(net: &Net<f64>, r: f64) -> f64 {
    let r = net.lobes.map_or(r, |lobes| r.min(0.99 * (lobes.limit() - net.depth)));
    net.acting_at(r).area_r(r)
}

/// Nets with an angle. The trial meridian `r = r_mid - B (cosh(kappa S) - 1)/(cosh(kappa S_half) - 1)` solves
/// the equation linearised about the mid radius. Its bulge B is the one that gives the end distance asked
/// for.
fn net_start(net: &Net<f64>, contraction: f64) -> Option<Unknowns> {
    let straight = straight_contraction(net)?;
    let side = if contraction >= straight { 1.0 } else { -1.0 };
    let asked = (1.0 - contraction) * net.cos_rest * net.half_fibre;
    let half = net.half_fibre;
    // kappa^2 = 3 q^4 r^2/sigma^2 holds for the plain net. Bladder and strain change it little enough for a
    // start.
    let rate = |r: f64| {
        let angle = (net.turn * r).min(0.98);
        3.0_f64.sqrt() * net.turn * angle / (1.0 - angle * angle).sqrt()
    };
    let end = net.acting_at(net.end_radius);
    let strain = end
        .at_equator(end.end_radius, end.push(end.end_radius), 0.0)
        .map_or(0.0, |found| net.compliance * found.tension);
    let end_distance = |bulge: f64| {
        let mid = net.end_radius + side * bulge;
        let kappa = rate(mid);
        let whole = shape(kappa * half);
        gauss::integrate(|tau| {
            let r = mid - side * bulge * shape(kappa * half * tau) / whole;
            let slope = bulge * shape_slope(kappa * half * tau) * kappa / whole;
            let square = (1.0 + strain).powi(2) - (net.turn * r).powi(2) - slope * slope;
            square.max(1e-4).sqrt() * half
        }) - asked
    };
    let most = if side > 0.0 { (0.999 / net.turn - net.end_radius).min(half) } else { 0.9 * net.end_radius };
    // For a shallow bulge its square root is nearer to linear in the end distance than the bulge itself. A
    // waist first lengthens the muscle, then its slope shortens it again. The root on the first branch is
    // wanted.
    let (mut low, mut high) = (1e-9, most.max(1e-8).sqrt());
    if side < 0.0 {
        let mut probe = low;
        while probe < high && end_distance(probe * probe) < 0.0 {
            low = probe;
            probe *= 2.0;
        }
        high = probe.min(high);
    }
    let bulge = if (contraction - straight).abs() < SHALLOW {
        // First order in the bulge: d(sigma)/dr = -q^2 r/sigma.
        let kappa = rate(net.end_radius);
        let mean = gauss::integrate(|tau| 1.0 - shape(kappa * half * tau) / shape(kappa * half));
        let sigma = net.cos_rest * (1.0 - straight);
        (contraction - straight).abs() * net.cos_rest * sigma / (net.turn * net.turn * net.end_radius * mean)
    } else {
        illinois(|b| end_distance(b * b), low, high, 1e-4 * high).powi(2)
    };
    let mid = net.end_radius + side * bulge;
    let kappa = rate(mid);
    let sigma2 = ((1.0 + strain).powi(2) - (net.turn * mid).powi(2)).max(1e-3);
    let ln_curvature = bulge.ln() + 2.0 * kappa.ln() - sigma2.ln() - ln_shape(kappa * half);
    let second = if side > 0.0 {
        ln_curvature
    } else {
        let share = (ln_curvature.exp() / steepest(net, mid)).min(0.98);
        (share / (1.0 - share)).ln()
    };
    Some(Unknowns::new(net, side, [bulge.ln(), second]))
}

/// A start beside a straight meridian, to first order in the bulge B, with everything that the net carries:
///
/// ```text
/// r - r_end = B (1 - (cosh(kappa s) - 1)/(cosh(kappa s_end) - 1))        kappa^2 = sigma^2 (h_r - A'')/N, of either sign (cos for cosh)
/// ```
///
/// The fibres are inextensible here. Fibres that stretch follow nearly the same law.
pub(crate) fn linear_start(net: &Net<f64>, contraction: f64) -> Option<Unknowns> {
    let straight = straight_contraction(net)?;
    let (end, half) = (net.acting_at(net.end_radius), net.half_fibre);
    let tension = end.at_equator(end.end_radius, end.push(end.end_radius), 0.0)?.tension;
    let local = end.local(end.end_radius, tension);
    let square = local.sigma.powi(2) * (local.hoop_r - end.section(end.end_radius).area_rr) / local.force;
    let kappa = square.abs().sqrt();
    let (ln_whole, mean) = if square > 0.0 {
        let x = kappa * half;
        let mean = gauss::integrate(|tau| 1.0 - (ln_shape(x * tau) - ln_shape(x)).exp());
        (ln_shape(x), mean)
    } else {
        let x = (kappa * half).min(1.5);
        let part = |tau: f64| (1.0 - (x * tau).cos()) / (1.0 - x.cos());
        ((1.0 - x.cos()).ln(), gauss::integrate(|tau| 1.0 - part(tau)))
    };
    let by_radius = net.turn * net.turn * net.end_radius / local.sigma;
    let bulge = (contraction - straight).abs() * net.cos_rest / (by_radius * mean);
    let side = (contraction - straight).signum();
    let ln_curvature = bulge.ln() + 2.0 * kappa.ln() - 2.0 * local.sigma.ln() - ln_whole;
    let second = if side > 0.0 {
        ln_curvature
    } else {
        let share = (ln_curvature.exp() / steepest(net, net.end_radius)).min(0.98);
        (share / (1.0 - share)).ln()
    };
    Some(Unknowns::new(net, side, [bulge.ln(), second]))
}

/// cosh(x) - 1. Large x are kept below where cosh would overflow (for ratios at the same x).
fn shape(x: f64) -> f64 {
    let s = (0.5 * x.min(600.0)).sinh();
    2.0 * s * s
}
fn shape_slope(x: f64) -> f64 {
    x.min(600.0).sinh()
}
fn ln_shape(x: f64) -> f64 {
    if x > 30.0 { x - 2.0_f64.ln() } else { shape(x).ln() }
}

/// The limit of the contraction to which a braid of inextensible fibres can be drawn out. The tension has no
/// limit there.
///
/// The pressure no longer counts in this limit, and the end distance is the largest one,
/// `integral of sqrt(1 - q^2 r^2 - r'^2) dS`. With the radius `r_m cosh(w)` the first integral of this
/// functional gives, from the middle to the fitting,
///
/// ```text
/// S = sqrt(1 - q^2 r_m^2)/q  integral dw/sqrt(1 - q^2 r_m^2 cosh^2 w)        x = 1/q  integral sqrt(1 - q^2 r_m^2 cosh^2 w) dw
/// ```
pub(crate) fn longest(net: &Net<f64>) -> f64 {
    drawn_out(net).1
}

/// The radius at mid-length in the drawn-out limit, and the contraction there.
pub(crate) fn drawn_out(net: &Net<f64>) -> (f64, f64) {
    let q = net.turn.abs();
    let drawn = |ln_mid: f64| {
        let mid = ln_mid.exp();
        // Rounding of the logarithm may make the middle wider than the fitting.
        let end = (net.end_radius / mid).max(1.0).acosh();
        let panels = end.ceil().max(1.0);
        let (mut fibre, mut distance, mut left) = (0.0, 0.0, 0.0);
        while left < panels {
            let root = |part: f64| {
                let r = mid * (end * (left + part) / panels).cosh();
                (1.0 - q * q * r * r).max(0.0).sqrt()
            };
            fibre += gauss::integrate(|part| 1.0 / root(part)) * end / panels;
            distance += gauss::integrate(root) * end / panels;
            left += 1.0;
        }
        (fibre * (1.0 - q * q * mid * mid).sqrt() / q, distance / q)
    };
    let top = net.end_radius.ln();
    let mismatch = |ln_mid: f64| drawn(ln_mid).0 - net.half_fibre;
    // S grows by 1/q for every factor e of the radius.
    let ln_mid = illinois(mismatch, top - q * net.half_fibre - 3.0, top, 1e-13);
    (ln_mid.exp(), 1.0 - drawn(ln_mid).1 / (net.cos_rest * net.half_fibre))
}
