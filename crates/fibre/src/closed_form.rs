//! The closed form: straight fibres (theta = 0) and pressure alone, by elliptic integrals, inextensible or
//! elastic.
//!
//! S1 eqs. 19 to 28 (B. Verrelst et al., *Second generation pleated pneumatic artificial muscle and its
//! robotic applications*, after F. Daerden's thesis of 1999). With R the fibre radius at the fittings and
//! L = l0/R:
//!
//! ```text
//! r = R cos(phi)/cos(phi_R)          x = R/(sqrt(m) cos phi_R) (E(phi|m) - F(phi|m)/2)         0 <= phi <= phi_R
//! (E - F/2)/(sqrt(m) cos phi_R) = (L/2)(1 - eps)                                              end distance (eq. 24)
//!  F       /(sqrt(m) cos phi_R) =  L (1 + T/EA)                                               fibre length (eq. 25, elastic)
//! T = p sin(2 pi/n) R^2/(4 m cos^2 phi_R)                                                     tension, constant along the fibre
//! F_t = p (n/2 pi) sin(2 pi/n) l0^2 f,     f = (pi/2)(1 - 2m)/(m cos^2 phi_R L^2)              force
//! ```
//!
//! The same pair is solved in variables that stay regular. With `t = tan(phi_R)`, `y = sqrt(m) cos(phi_R)`
//! (so that `T ~ 1/y^2` and `m = y^2 (1 + t^2)`), `D = (F - E)/m` and the elastic group
//! `kappa = p sin(2 pi/n) R^2/(4 EA)` of one fibre (so that `T/EA = kappa/y^2`):
//!
//! ```text
//! 2 m D = L (eps y + kappa/y)        F = L (y + kappa/y)
//! ```
//!
//! No term cancels as eps -> 0, where m -> 0 and the inextensible force diverges. Newton's method runs on
//! (ln t, ln y).

use bulge_numerics::elliptic::{Pair, incomplete};
use bulge_numerics::root::illinois;
use std::f64::consts::{FRAC_PI_2, PI};

use crate::FibreError;

/// Iterations after which the solve is given up; four are usual.
const MAX_ITERATIONS: u32 = 60;
/// Largest Newton step in the logarithms.
const MAX_STEP: f64 = 0.7;
/// Relative change of the stretched length at which the starting values are as good as their fit.
const ENOUGH: f64 = 3e-3;
/// Size of the last step. The error of the derivatives is of this size, that of the values of its square.
const LAST_STEP: f64 = 1e-10;
/// The same in a fit: values to 1e-13, derivatives to 3e-7.
const LAST_STEP_OF_FITS: f64 = 3e-7;
/// Largest first step from a neighbour's solution; a longer one comes from too far away.
const NEAR: f64 = 0.2;
/// Largest move of a neighbour's solution along its derivatives.
const FARTHEST: f64 = 0.5;

/// A value with its derivatives with respect to contraction, slenderness L and elastic group kappa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Graded {
    /// The value.
    pub value: f64,
    /// d/d(contraction).
    pub by_contraction: f64,
    /// d/dL.
    pub by_slenderness: f64,
    /// d/d(kappa).
    pub by_compliance: f64,
}

/// The meridian of straight fibres in closed form; dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosedForm {
    /// Parameter m of the elliptic integrals (k^2), 0 < m; force vanishes at 1/2.
    pub m: f64,
    /// tan(phi_R).
    pub t: f64,
    /// sqrt(m) cos(phi_R).
    pub y: f64,
    /// Fibre strain T/EA.
    pub strain: f64,
    /// f of S1 eq. 28: force / (p (n/2 pi) sin(2 pi/n) l0^2).
    pub force: Graded,
    /// v of S1 eq. 30: volume with circular sections / l0^3.
    pub volume: Graded,
    /// Largest radius over R: 1/cos(phi_R).
    pub radius: Graded,
    /// Newton iterations.
    pub iterations: u32,
    /// Evaluations of the pair of elliptic integrals.
    pub evaluations: u32,
    /// Largest relative residual of the two equations, predicted after the last step from its size.
    pub residual: f64,
    /// Derivatives of (ln t, ln y) by contraction, slenderness L and elastic group kappa.
    pub(crate) follow: [[f64; 2]; 3],
}

/// A solved meridian from which the search for a neighbour starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Near {
    /// t and y.
    at: [f64; 2],
    /// Contraction, slenderness and elastic group.
    of: [f64; 3],
    /// Derivatives of (ln t, ln y) by these.
    by: [[f64; 2]; 3],
}

impl Near {
    /// The solution for a contraction, slenderness and elastic group.
    pub(crate) fn new(found: &ClosedForm, of: [f64; 3]) -> Self {
        Self { at: [found.t, found.y], of, by: found.follow }
    }

    /// (t, y) to start with for another contraction, slenderness and elastic group. `None` if these are too
    /// far away.
    fn towards(&self, of: [f64; 3]) -> Option<[f64; 2]> {
        let mut moves = [0.0; 2];
        for ((new, old), by) in of.iter().zip(&self.of).zip(&self.by) {
            moves[0] += by[0] * (new - old);
            moves[1] += by[1] * (new - old);
        }
        let is_near = moves.iter().all(|step| step.abs() <= FARTHEST) && (of[0] < 0.0) == (self.of[0] < 0.0);
        is_near.then(|| [self.at[0] * moves[0].exp(), self.at[1] * moves[1].exp()])
    }
}

impl ClosedForm {
    /// phi_R in radians.
    #[must_use]
    pub fn phi_r(&self) -> f64 {
        self.t.atan()
    }

    /// Largest radius over R: 1/cos(phi_R).
    #[must_use]
    pub fn max_radius(&self) -> f64 {
        self.t.hypot(1.0)
    }

    /// Angle of the meridian against the axis at the left fitting, as in [`Self::point`] but without the
    /// elliptic integrals, which cost a tenth of a solve.
    pub(crate) fn end_slope(&self) -> f64 {
        2.0 * (self.m.sqrt() * self.t / self.max_radius()).asin()
    }

    /// Point of the meridian at amplitude phi in \[-phi_R, phi_R\]: x and r over R (x from mid-length), slope
    /// against the axis (positive where r grows with x) and unstretched fibre length from mid-length over R.
    ///
    /// `cos(slope) = 1 - 2 m sin^2(phi)`, hence `sin(slope/2) = -sqrt(m) sin(phi)`.
    #[must_use]
    pub fn point(&self, phi: f64) -> [f64; 4] {
        let Pair { f, d } = incomplete(phi.abs().tan(), self.m);
        let (s, c) = phi.sin_cos();
        let x = (0.5 * f - self.m * d) / self.y;
        let length = 0.5 * f / (self.y * (1.0 + self.strain));
        [x.copysign(phi), c * self.max_radius(), -2.0 * (self.m.sqrt() * s).asin(), length.copysign(phi)]
    }
}

/// The two integrals at (t, m), with the terms that Newton's method needs for their derivatives.
struct Integrals {
    f: f64,
    d: f64,
    /// sin, cos of phi_R and Delta = sqrt(1 - m sin^2 phi).
    s: f64,
    c: f64,
    delta: f64,
    /// dF/dm = (F - D - s c/Delta)/(2 (1 - m)).
    f_m: f64,
}

impl Integrals {
    fn at(t: f64, m: f64) -> Self {
        #[cfg(test)]
        crate::work::count();
        let Pair { f, d } = incomplete(t, m);
        let c2 = 1.0 / (1.0 + t * t);
        let (c, s) = (c2.sqrt(), t * c2.sqrt());
        let delta = (1.0 - m * s * s).sqrt();
        let f_m = (f - d - s * c / delta) / (2.0 * (1.0 - m));
        Self { f, d, s, c, delta, f_m }
    }
}

/// Jacobian of (ln left - ln right) of both equations with respect to (ln t, ln y), and the residuals.
struct Equations {
    residual: [f64; 2],
    jacobian: [[f64; 2]; 2],
    /// eps y + kappa/y and y + kappa/y.
    a: f64,
    b: f64,
}

impl Equations {
    fn at(
        i: &Integrals,
        [m, t, y]: [f64; 3],
        a: f64,
        contraction: f64,
        slenderness: f64,
        kappa: f64,
    ) -> Self {
        let elastic = kappa / y;
        let b = y + elastic;
        let md_m = i.f_m - 0.5 * i.d; // m dD/dm
        let phi_t = t * i.c * i.c; // dphi/d(ln t)
        let m_t = 2.0 * i.s * i.s; // d(ln m)/d(ln t);  d(ln m)/d(ln y) = 2
        let residual = [(2.0 * m * i.d / (slenderness * a)).ln(), (i.f / (slenderness * b)).ln()];
        let jacobian = [
            [
                m_t + (i.s * i.s * phi_t / i.delta + md_m * m_t) / i.d,
                2.0 + 2.0 * md_m / i.d - (contraction * y - elastic) / a,
            ],
            [(phi_t / i.delta + i.f_m * m * m_t) / i.f, 2.0 * m * i.f_m / i.f - (y - elastic) / b],
        ];
        Self { residual, jacobian, a, b }
    }

    fn solve(&self, right: [f64; 2]) -> [f64; 2] {
        let [[a, b], [c, d]] = self.jacobian;
        let det = a * d - b * c;
        [(right[0] * d - b * right[1]) / det, (a * right[1] - c * right[0]) / det]
    }
}

/// Solves the closed form at a contraction (below 0 only with elastic fibres), for a slenderness L = l0/R and
/// an elastic group kappa = p sin(2 pi/n) R^2/(4 EA) >= 0.
///
/// Contractions beyond the limit (m > 1/2, the muscle pushes) are followed; the caller decides whether they
/// make sense.
///
/// # Errors
/// [`FibreError::NotConverged`] with the last residual where no equilibrium is found (fibres so soft that
/// they balloon, contraction far beyond the limit).
pub fn solve(contraction: f64, slenderness: f64, kappa: f64) -> Result<ClosedForm, FibreError> {
    let mut answer = Err(FibreError::NotConverged { contraction, residual: f64::INFINITY, iterations: 0 });
    for start in starts(contraction, slenderness, kappa).into_iter().flatten() {
        answer = search(start.into(), [contraction, slenderness, kappa], LAST_STEP, f64::INFINITY);
        // A strain above 1 belongs to the other root, a muscle that has ballooned.
        if answer.as_ref().is_ok_and(|found| found.strain < 1.0) {
            break;
        }
    }
    answer
}

/// The same within a fit, from a neighbour's solution if there is one: values to 1e-13, derivatives to 3e-7.
///
/// # Errors
/// Those of [`solve`].
pub(crate) fn solve_near(near: Option<&Near>, of: [f64; 3]) -> Result<ClosedForm, FibreError> {
    near.and_then(|near| near.towards(of))
        .and_then(|start| search(start, of, LAST_STEP_OF_FITS, NEAR).ok())
        .map_or_else(|| solve(of[0], of[1], of[2]), Ok)
}

/// Newton's method from (t, y) until a step is below `last`; the first one must not be longer than `first`.
fn search(start: [f64; 2], of: [f64; 3], last_step: f64, first: f64) -> Result<ClosedForm, FibreError> {
    let [contraction, slenderness, kappa] = of;
    let failed = |residual: f64, iterations| FibreError::NotConverged { contraction, residual, iterations };
    let [mut t, mut y] = start;
    let stretched = contraction < 0.0;
    // A stretched muscle is nearly straight and T/EA is nearly -eps. The gap eps + T/EA therefore takes the
    // place of y.
    let mut gap = if stretched { 2.0 * y * (1.0 + t * t) * straight_d(t) / slenderness } else { 0.0 };
    let mut last = f64::INFINITY;
    for iteration in 1..=MAX_ITERATIONS {
        if stretched {
            y = (kappa / (gap - contraction)).sqrt();
        }
        let a = if stretched { y * gap } else { contraction * y + kappa / y };
        let m = y * y * (1.0 + t * t);
        let integrals = Integrals::at(t, m);
        let equations = Equations::at(&integrals, [m, t, y], a, contraction, slenderness, kappa);
        let step = equations.solve(equations.residual);
        let gap_step = if stretched { step[1] * -2.0 * (gap - contraction) / gap } else { step[1] };
        let size = step[0].abs().max(step[1].abs()).max(gap_step.abs());
        if !size.is_finite() || (iteration == 1 && size > first) {
            return Err(failed(last, iteration));
        }
        if size < last_step {
            // The derivatives at this point serve for the outputs as well. Their error is of the size of the
            // step, and that of the corrected values of its square.
            return Ok(outputs(&integrals, &equations, [t, y], of, step, iteration));
        }
        last = equations.residual[0].abs().max(equations.residual[1].abs());
        let damping = (MAX_STEP / size).min(1.0);
        t *= (-damping * step[0]).exp();
        y *= (-damping * step[1]).exp();
        if stretched {
            gap *= (-damping * gap_step).exp();
        }
    }
    Err(failed(last, MAX_ITERATIONS))
}

/// Starting values (t, y), a few per cent off: the small- and large-bulge limits of
/// `2 F D (1 + t^2) = eps L^2`, joined. A muscle longer than at rest has two of them. If it is short, its
/// bulge is no shallow arc, and its strain is below [`natural_strain`].
fn starts(contraction: f64, slenderness: f64, kappa: f64) -> [Option<(f64, f64)>; 2] {
    if kappa == 0.0 {
        return [(contraction > 0.0).then(|| inextensible_start(contraction, slenderness)), None];
    }
    let contracted = contracted_start(contraction, slenderness, kappa);
    if contraction >= 0.0 {
        return [Some(contracted), None];
    }
    let stretched = stretched_start(contraction, slenderness, kappa);
    if -contraction < 0.5 * natural_strain(slenderness, kappa) {
        [Some(contracted), stretched]
    } else {
        [stretched, Some(contracted)]
    }
}

/// Size of the fibre strain at zero contraction (shallow arc, T^3 ~ EA (p l0)^2).
fn natural_strain(slenderness: f64, kappa: f64) -> f64 {
    kappa.cbrt() * slenderness.powf(2.0 / 3.0)
}

/// Elastic fibres, muscle contracted or hardly stretched. A fixed-point iteration on the inextensible muscle
/// with the stretched length gives the strain.
fn contracted_start(contraction: f64, slenderness: f64, kappa: f64) -> (f64, f64) {
    let mut strain = natural_strain(slenderness, kappa);
    let mut inner = (contraction, slenderness);
    for _ in 0..6 {
        inner = (((contraction + strain) / (1.0 + strain)).clamp(1e-12, 0.6), slenderness * (1.0 + strain));
        let (t, y) = inextensible_start(inner.0, inner.1);
        let next = (strain * kappa).sqrt().min(3.0 * y) / y;
        // An error of some per cent in a strain of some per cent is nothing to Newton's method.
        if (next - strain).abs() < ENOUGH * (1.0 + strain) {
            return (t, y);
        }
        strain = next;
    }
    inextensible_start(inner.0, inner.1)
}

/// Elastic fibres, muscle longer than at rest. For a given t the fibre length `F = L (y + kappa/y)` is a
/// quadratic in y. The end distance `eps = 2 y (1 + t^2) D/L - kappa/y^2` rises with t. This leaves one
/// monotone equation, here with F and D at m = 0.
fn stretched_start(contraction: f64, slenderness: f64, kappa: f64) -> Option<(f64, f64)> {
    let y_at = |phi: f64| {
        let half = 0.5 * phi / slenderness;
        half + (half * half - kappa).max(0.0).sqrt()
    };
    let excess = |ln_t: f64| {
        let t = ln_t.exp();
        let phi = t.atan();
        let y = y_at(phi);
        2.0 * y * (1.0 + t * t) * straight_d(t) / slenderness - kappa / (y * y) - contraction
    };
    let phi_min = 2.0 * slenderness * kappa.sqrt();
    let low = (phi_min < 1.55).then(|| phi_min.tan().ln())?;
    let t = illinois(excess, low, (2.0 * slenderness).max(2.0).ln(), 0.1).exp();
    Some((t, y_at(t.atan())))
}

/// D at m = 0: (phi - sin phi cos phi)/2, without cancellation for a small t.
fn straight_d(t: f64) -> f64 {
    if t < 1e-3 { t * t * t / 3.0 } else { 0.5 * (t.atan() - t / (1.0 + t * t)) }
}

fn inextensible_start(contraction: f64, slenderness: f64) -> (f64, f64) {
    // phi (phi - sin phi cos phi)(1 + t^2) = X at m = 0, solved to 1 % by a fit between t^4 = 3X/2 and
    // t^2 = 4X/pi^2; the product F D grows with m, which tends to eps for a slender muscle.
    let growth = contraction * (0.65 + 0.75 * contraction);
    let guess = |x: f64| (x * (1.5 + 0.98 * x.sqrt() + 0.1643 * x)).sqrt();
    let whole = contraction * slenderness * slenderness;
    let t2 = guess(whole);
    let s2 = t2 / (1.0 + t2);
    let t2 = guess(whole / (1.0 + growth * s2 * s2));
    let t = t2.sqrt();
    let phi = t.atan();
    let d0 = 0.5 * (phi - t / (1.0 + t2));
    let m = 0.5 * contraction * phi / d0;
    (t, (phi + 0.5 * m.min(0.5) * d0 * (1.0 + 0.7 * m.min(0.5))) / slenderness)
}

/// Force and volume with their derivatives, corrected by the last Newton step (-step in ln t and ln y).
fn outputs(
    i: &Integrals,
    equations: &Equations,
    [t, y]: [f64; 2],
    of: [f64; 3],
    step: [f64; 2],
    iterations: u32,
) -> ClosedForm {
    let [_, l, kappa] = of;
    let m = y * y * (1.0 + t * t);
    let m_t = 2.0 * m * i.s * i.s;
    let m_y = 2.0 * m;
    // Implicit function theorem: dz/dparameter = -J^-1 (d residual / d parameter).
    let by_contraction = equations.solve([y / equations.a, 0.0]);
    let by_slenderness = equations.solve([1.0 / l, 1.0 / l]);
    let by_compliance = equations.solve([1.0 / (y * equations.a), 1.0 / (y * equations.b)]);
    let graded = |value: f64, z: [f64; 2], slenderness_power: f64| {
        let along = |direction: [f64; 2]| z[0] * direction[0] + z[1] * direction[1];
        Graded {
            value: value - along(step),
            by_contraction: along(by_contraction),
            by_slenderness: along(by_slenderness) + slenderness_power * value / l,
            by_compliance: along(by_compliance),
        }
    };
    // f = (pi/2)(1 - 2m)/(y^2 L^2)
    let f_scale = FRAC_PI_2 / (y * y * l * l);
    let f = f_scale * (1.0 - 2.0 * m);
    let force = graded(f, [-2.0 * f_scale * m_t, -2.0 * f - 2.0 * f_scale * m_y], -2.0);
    // v = (pi/3)(1 + t^2)/(y L^3) G,   G = F + (1 - 2m) D + 2 s c Delta
    let sc = i.s * i.c;
    let g = i.f + (1.0 - 2.0 * m) * i.d + 2.0 * sc * i.delta;
    let scale = PI / 3.0 * (1.0 + t * t) / (y * l * l * l);
    let s2 = i.s * i.s;
    let g_phi = (1.0 + (1.0 - 2.0 * m) * s2 - 2.0 * m * sc * sc) / i.delta + 2.0 * (1.0 - 2.0 * s2) * i.delta;
    let mg_m = m * (i.f_m - 2.0 * i.d - sc * s2 / i.delta) + (1.0 - 2.0 * m) * (i.f_m - 0.5 * i.d);
    let v = scale * g;
    let v_t = scale * (g_phi * t * i.c * i.c + mg_m * 2.0 * s2) + 2.0 * s2 * v;
    let v_y = scale * 2.0 * mg_m - v;
    let volume = graded(v, [v_t, v_y], -3.0);
    let largest = t.hypot(1.0);
    let radius = graded(largest, [t * t / largest, 0.0], 0.0);
    let (t, y) = (t * (1.0 - step[0]), y * (1.0 - step[1]));
    let size = step[0].abs().max(step[1].abs());
    let residual = (size * size).max(f64::EPSILON);
    ClosedForm {
        m: y * y * (1.0 + t * t),
        t,
        y,
        strain: kappa / (y * y),
        force,
        volume,
        radius,
        iterations,
        evaluations: iterations,
        residual,
        follow: [by_contraction, by_slenderness, by_compliance],
    }
}
