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

use bulge_numerics::Lanes;
use bulge_numerics::elliptic::{Pair, incomplete};
use std::f64::consts::{FRAC_PI_2, PI};
use wide::f64x4;

mod starts;

use crate::FibreError;
use starts::{contracted_start, starts, straight_d};

/// Iterations after which the solve is given up; four are usual.
const MAX_ITERATIONS: u32 = 60;
/// Largest Newton step in the logarithms.
const MAX_STEP: f64 = 0.7;
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
        is_near.then(|| [self.at[0].grown(moves[0]), self.at[1].grown(moves[1])])
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
        (self.t * self.t + 1.0).sqrt()
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
struct Integrals<L> {
    f: L,
    d: L,
    /// Squares of sin and cos of phi_R, and their product.
    s2: L,
    c2: L,
    sc: L,
    /// Delta = sqrt(1 - m sin^2 phi), and its inverse.
    delta: L,
    per_delta: L,
    /// dF/dm = (F - D - s c/Delta)/(2 (1 - m)).
    f_m: L,
}

impl<L: Lanes> Integrals<L> {
    #[inline]
    fn at(t: L, m: L) -> Self {
        #[cfg(test)]
        crate::work::count();
        let Pair { f, d } = incomplete(t, m);
        let c2 = L::from(1.0) / (t * t + 1.0);
        let (sc, s2) = (t * c2, t * t * c2);
        let delta = (-(m * s2) + 1.0).sqrt();
        let per_delta = L::from(1.0) / delta;
        let f_m = (f - d - sc * per_delta) / (m * -2.0 + 2.0);
        Self { f, d, s2, c2, sc, delta, per_delta, f_m }
    }
}

/// Jacobian of (ln left - ln right) of both equations with respect to (ln t, ln y), and the residuals, right to their
/// third power.
struct Equations<L> {
    residual: [L; 2],
    jacobian: [[L; 2]; 2],
    /// Inverses of eps y + kappa/y and y + kappa/y.
    per_a: L,
    per_b: L,
}

impl<L: Lanes> Equations<L> {
    #[inline]
    fn at(i: &Integrals<L>, [m, y]: [L; 2], a: L, [contraction, slenderness, kappa]: [L; 3]) -> Self {
        let elastic = kappa / y;
        let b = y + elastic;
        let one = L::from(1.0);
        let (per_a, per_b, per_d, per_f) = (one / a, one / b, one / i.d, one / i.f);
        let md_m = i.f_m - i.d * 0.5; // m dD/dm
        let bent = i.sc * i.per_delta; // dphi/d(ln t) / Delta
        let m_t = i.s2 * 2.0; // d(ln m)/d(ln t);  d(ln m)/d(ln y) = 2
        // ln(u/v) = 2 (u - v)/(u + v) up to its third power, which Newton's method doesn't notice.
        let log = |u: L, v: L| (u - v) * 2.0 / (u + v);
        let residual = [log(m * i.d * 2.0, slenderness * a), log(i.f, slenderness * b)];
        let jacobian = [
            [
                m_t + (i.s2 * bent + md_m * m_t) * per_d,
                md_m * per_d * 2.0 + 2.0 - (contraction * y - elastic) * per_a,
            ],
            [(bent + i.f_m * m * m_t) * per_f, m * i.f_m * per_f * 2.0 - (y - elastic) * per_b],
        ];
        Self { residual, jacobian, per_a, per_b }
    }

    /// The inverse of the Jacobian.
    #[inline]
    fn inverse(&self) -> [[L; 2]; 2] {
        let [[a, b], [c, d]] = self.jacobian;
        let per = L::from(1.0) / (a * d - b * c);
        [[d * per, -(b * per)], [-(c * per), a * per]]
    }
}

#[inline]
fn times<L: Lanes>([[a, b], [c, d]]: [[L; 2]; 2], [x, y]: [L; 2]) -> [L; 2] {
    [a * x + b * y, c * x + d * y]
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
        answer = search(start, [contraction, slenderness, kappa], LAST_STEP, f64::INFINITY).found(0);
        // A strain above 1 belongs to the other root, a muscle that has ballooned.
        if answer.as_ref().is_ok_and(|found| found.strain < 1.0) {
            break;
        }
    }
    answer
}

/// Solves the closed form for many triples (contraction, slenderness > 0, kappa >= 0), four at a time. The answers are those of
/// [`solve`] to the last bit, whatever stands beside a triple.
#[must_use]
pub fn solve_many(asked: &[[f64; 3]]) -> Vec<Result<ClosedForm, FibreError>> {
    let unsolved =
        |of: &[f64; 3]| FibreError::NotConverged { contraction: of[0], residual: 0.0, iterations: 0 };
    let mut answers: Vec<_> = asked.iter().map(|of| Err(unsolved(of))).collect();
    let (together, alone): (Vec<usize>, Vec<usize>) = (0..asked.len()).partition(|i| asked[*i][0] > 0.0);
    for four in together.chunks(f64x4::COUNT) {
        let place = |lane: usize| four.get(lane).copied().unwrap_or(four[0]);
        let of = [0, 1, 2].map(|number| f64x4::each(|lane| asked[place(lane)][number]));
        let searched = search(contracted_start(of), of, LAST_STEP, f64::INFINITY);
        for (lane, i) in four.iter().enumerate() {
            answers[*i] = searched.found(lane);
        }
    }
    for i in alone {
        let [contraction, slenderness, kappa] = asked[i];
        answers[i] = solve(contraction, slenderness, kappa);
    }
    answers
}

/// The same as [`solve`] within a fit, from a neighbour's solution if there is one: values to 1e-13, derivatives to 3e-7.
///
/// # Errors
/// Those of [`solve`].
pub(crate) fn solve_near(near: Option<&Near>, of: [f64; 3]) -> Result<ClosedForm, FibreError> {
    near.and_then(|near| near.towards(of))
        .and_then(|start| search(start, of, LAST_STEP_OF_FITS, NEAR).found(0).ok())
        .map_or_else(|| solve(of[0], of[1], of[2]), Ok)
}

/// Where a search has ended, of one triple or of several.
struct Searched<L: Lanes> {
    of: [L; 3],
    /// Where it has converged; the outputs of others mean nothing.
    is_found: L::Mask,
    outputs: Outputs<L>,
    /// The last residual where it was lost.
    residual: L,
    iterations: L,
}

impl<L: Lanes> Searched<L> {
    #[inline]
    fn found(&self, lane: usize) -> Result<ClosedForm, FibreError> {
        let [contraction, residual, iterations] =
            [self.of[0], self.residual, self.iterations].map(|of| of.lane(lane));
        let iterations = (1..MAX_ITERATIONS).find(|n| f64::from(*n) >= iterations).unwrap_or(MAX_ITERATIONS);
        if L::is_set(self.is_found, lane) {
            Ok(self.outputs.lane(lane, iterations))
        } else {
            Err(FibreError::NotConverged { contraction, residual, iterations })
        }
    }
}

/// Newton's method from (t, y) until a step is below `last`; the first one must not be longer than `first`. Of several
/// triples, all must be contracted or all stretched.
#[inline]
fn search<L: Lanes>(start: [L; 2], of: [L; 3], last_step: f64, first: f64) -> Searched<L> {
    let [contraction, slenderness, kappa] = of;
    let [mut t, mut y] = start;
    let stretched = L::all(contraction.is_below(L::from(0.0)));
    // A stretched muscle is nearly straight and T/EA is nearly -eps. The gap eps + T/EA therefore takes the
    // place of y.
    let mut gap =
        if stretched { y * 2.0 * (t * t + 1.0) * straight_d(t) / slenderness } else { L::from(0.0) };
    let (mut residual, mut iterations) = (L::from(f64::INFINITY), L::from(1.0));
    let mut iteration = 1;
    loop {
        if stretched {
            y = (kappa / (gap - contraction)).sqrt();
        }
        let a = if stretched { y * gap } else { contraction * y + kappa / y };
        let m = y * y * (t * t + 1.0);
        let integrals = Integrals::at(t, m);
        let equations = Equations::at(&integrals, [m, y], a, of);
        let inverse = equations.inverse();
        let step = times(inverse, equations.residual);
        let gap_step = if stretched { step[1] * -2.0 * (gap - contraction) / gap } else { step[1] };
        let size = step[0].abs().larger(gap_step.abs()).larger(step[1].abs());
        // The larger of two may hide a first one that isn't a number.
        let is_found = size.is_below(L::from(last_step)) & step[0].abs().is_below(L::from(f64::INFINITY));
        let longest = if iteration == 1 { first } else { f64::MAX };
        // What isn't a number is lost.
        let goes_on = !is_found & size.is_below(L::from(longest));
        if L::all(!goes_on) || iteration == MAX_ITERATIONS {
            // The derivatives at this point serve for the outputs as well. Their error is of the size of the
            // step, and that of the corrected values of its square.
            let outputs = Outputs::at(&integrals, &equations, inverse, [m, t, y], of, step);
            return Searched { of, is_found, outputs, residual, iterations };
        }
        let going = |next: L, now: L| L::select(goes_on, next, now);
        residual = going(equations.residual[0].abs().larger(equations.residual[1].abs()), residual);
        let damping = L::from(-MAX_STEP) / size.larger(L::from(MAX_STEP));
        t = going(t.grown(damping * step[0]), t);
        y = going(y.grown(damping * step[1]), y);
        if stretched {
            gap = going(gap.grown(damping * gap_step), gap);
        }
        iteration += 1;
        iterations = going(iterations + 1.0, iterations);
    }
}

/// A value with its derivatives by contraction, slenderness and elastic group.
type GradedLanes<L> = [L; 4];

/// What a search has found, before it is told apart.
struct Outputs<L> {
    m: L,
    t: L,
    y: L,
    strain: L,
    force: GradedLanes<L>,
    volume: GradedLanes<L>,
    radius: GradedLanes<L>,
    residual: L,
    follow: [[L; 2]; 3],
}

impl<L: Lanes> Outputs<L> {
    /// Force and volume with their derivatives, corrected by the last Newton step (-step in ln t and ln y).
    #[inline]
    fn at(
        i: &Integrals<L>,
        equations: &Equations<L>,
        inverse: [[L; 2]; 2],
        [m, t, y]: [L; 3],
        [_, l, kappa]: [L; 3],
        step: [L; 2],
    ) -> Self {
        let m_t = m * i.s2 * 2.0;
        let m_y = m * 2.0;
        let one = L::from(1.0);
        let (per_l, per_y) = (one / l, one / y);
        // Implicit function theorem: dz/dparameter = -J^-1 (d residual / d parameter).
        let (per_a, per_b) = (equations.per_a, equations.per_b);
        let by_contraction = times(inverse, [y * per_a, L::from(0.0)]);
        let by_slenderness = times(inverse, [per_l, per_l]);
        let by_compliance = times(inverse, [per_y * per_a, per_y * per_b]);
        let graded = |value: L, z: [L; 2], slenderness_power: f64| {
            let along = |direction: [L; 2]| z[0] * direction[0] + z[1] * direction[1];
            let by_scale = value * per_l * slenderness_power;
            [
                value - along(step),
                along(by_contraction),
                along(by_slenderness) + by_scale,
                along(by_compliance),
            ]
        };
        // f = (pi/2)(1 - 2m)/(y^2 L^2)
        let per_yl = per_y * per_l;
        let f_scale = per_yl * per_yl * FRAC_PI_2;
        let push = m * -2.0 + 1.0;
        let f = f_scale * push;
        let force = graded(f, [f_scale * m_t * -2.0, (f + f_scale * m_y) * -2.0], -2.0);
        // v = (pi/3)(1 + t^2)/(y L^3) G,   G = F + (1 - 2m) D + 2 s c Delta
        let wide = t * t + 1.0;
        let g = i.f + push * i.d + i.sc * i.delta * 2.0;
        let scale = wide * per_yl * per_l * per_l * (PI / 3.0);
        let g_phi =
            (push * i.s2 + 1.0 - m * i.sc * i.sc * 2.0) * i.per_delta + (i.s2 * -2.0 + 1.0) * i.delta * 2.0;
        let mg_m = m * (i.f_m - i.d * 2.0 - i.sc * i.s2 * i.per_delta) + push * (i.f_m - i.d * 0.5);
        let v = scale * g;
        let v_t = scale * (g_phi * t * i.c2 + mg_m * i.s2 * 2.0) + i.s2 * v * 2.0;
        let v_y = scale * mg_m * 2.0 - v;
        let volume = graded(v, [v_t, v_y], -3.0);
        let largest = wide.sqrt();
        let radius = graded(largest, [t * t / largest, L::from(0.0)], 0.0);
        let (t, y) = (t * (-step[0] + 1.0), y * (-step[1] + 1.0));
        let size = step[0].abs().larger(step[1].abs());
        Self {
            m: y * y * (t * t + 1.0),
            t,
            y,
            strain: kappa / (y * y),
            force,
            volume,
            radius,
            residual: (size * size).larger(L::from(f64::EPSILON)),
            follow: [by_contraction, by_slenderness, by_compliance],
        }
    }

    #[inline]
    fn lane(&self, lane: usize, iterations: u32) -> ClosedForm {
        let at = |of: L| of.lane(lane);
        let graded = |of: GradedLanes<L>| {
            let [value, by_contraction, by_slenderness, by_compliance] = of.map(at);
            Graded { value, by_contraction, by_slenderness, by_compliance }
        };
        ClosedForm {
            m: at(self.m),
            t: at(self.t),
            y: at(self.y),
            strain: at(self.strain),
            force: graded(self.force),
            volume: graded(self.volume),
            radius: graded(self.radius),
            iterations,
            evaluations: iterations,
            residual: at(self.residual),
            follow: self.follow.map(|by| by.map(at)),
        }
    }
}
