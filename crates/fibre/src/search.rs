//! Search along the contraction. It goes from equilibrium to equilibrium until an excess of force or volume
//! vanishes, or until there is no further one.

use bulge_numerics::root::{RootError, newton_bracketed};

use crate::FibreError;
use crate::continuation::drawn_taut;
use crate::net::Net;
use crate::outcome::{Scheme, Solution};
use crate::path::{Paths, Place};
use crate::problem::Problem;
use crate::shooting::{self, ALONE, USUAL};
use crate::solve::Found;
use crate::start;
use crate::unknowns::Unknowns;

/// Newton step at which a root in the contraction is accepted. The result is exact to the square of this
/// step.
const ROOT_TOLERANCE: f64 = 1e-9;
/// Largest contraction at which a muscle is looked for. A slender one pulls up to 0.5431, a long braid up to
/// 1 - 1/sqrt(3), and one on wide fittings farther.
pub(crate) const FAR: f64 = 0.99;
/// Fraction of the meridional force. Where the equilibria end, fibres that carry less count as slack.
const NEARLY_SLACK: f64 = 1e-3;
/// Smallest step of the contraction from one equilibrium to the next. If it fails, there is no next one.
const SMALLEST: f64 = 1e-9;
/// Step below which a neighbour's solution is the only start. Cold starts have been tried nearby.
const BESIDE: f64 = 1e-3;
/// Halvings between two equilibria in search of the largest excess, and the part of their distance within which
/// it is found: the excess then differs from the largest one by the square of that.
const HALVINGS: u32 = 40;
const FLAT: f64 = 1e-6;
/// Part of a way that the first step may take after longer ones have lost the equilibria.
const PATIENT: f64 = 0.01;
/// Step of the contraction away from a border at which a way starts: far above rounding, and above
/// [`SMALLEST`].
const OFF_BORDER: f64 = 1e-8;
/// Equilibria after which a walk is given up. A walk to a border takes about 100.
const MOST_STEPS: u32 = 150;
/// Where an equilibrium is looked for between the contraction of drawn-out fibres and a start: fractions of
/// that way, the easiest first.
const DRAWN_OUT: [f64; 7] = [0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 1e-4];
/// Distance from the contraction of drawn-out fibres below which tolerances are relative to it, and the
/// smallest distance that rounding allows.
const DRAWN_OUT_ROOM: f64 = 1e-3;
pub(crate) const LEAST_ROOM: f64 = 1e-5;
/// Newton steps from a place on a path, and the largest one allowed.
const NEAR_STEPS: u32 = 12;
const NEARBY: f64 = 1e-4;
/// How far elastic fibres are drawn beyond their length in search of such an equilibrium, after `DRAWN_OUT`.
const STRETCHED: [f64; 5] = [1e-3, 3e-3, 1e-2, 3e-2, 0.1];

/// The extremes that a search has come across.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seen {
    /// The largest force \[N\], and its contraction.
    pub(crate) force: f64,
    pub(crate) contraction: f64,
    /// The least volume \[m^3\], and the equilibrium with the largest one.
    pub(crate) volume: f64,
    pub(crate) fullest: Option<Found>,
    /// The last equilibrium.
    pub(crate) last: Option<Unknowns>,
}

impl Seen {
    pub(crate) const NOTHING: Self =
        Self { force: f64::NEG_INFINITY, contraction: 0.0, volume: f64::INFINITY, fullest: None, last: None };

    fn add(&mut self, found: &Found) {
        let response = &found.response;
        self.last = found.unknowns();
        if response.force_n > self.force {
            (self.force, self.contraction) = (response.force_n, response.contraction);
        }
        self.volume = self.volume.min(response.volume_m3);
        if self.fullest.is_none_or(|most| response.volume_m3 > most.response.volume_m3) {
            self.fullest = Some(*found);
        }
    }
}

/// The equilibria of a muscle one after the other, each found from the last.
struct Walk<'a, E> {
    problem: &'a Problem,
    scheme: Scheme,
    near: Option<Unknowns>,
    seen: &'a mut Seen,
    excess: E,
}

impl<E: Fn(&Found) -> f64> Walk<'_, E> {
    /// The equilibrium at a contraction. With `alone`, the last one is the only start.
    fn at(&mut self, contraction: f64, alone: bool) -> Result<Found, FibreError> {
        let ending = if alone && self.near.is_some() { ALONE } else { USUAL };
        let from = self.near.map(Solution::Shooting);
        let found = self.problem.at_with(self.scheme, contraction, (from, ending))?;
        self.near = found.unknowns();
        self.seen.add(&found);
        Ok(found)
    }

    /// The excess and its derivative by the contraction, from the slopes in the response.
    fn value(&mut self, contraction: f64, alone: bool) -> Result<(f64, f64), FibreError> {
        let found = self.at(contraction, alone)?;
        let l0 = self.problem.parts.length;
        let y = (self.excess)(&found);
        let step = 1e-6 * contraction.abs().max(1e-3);
        Ok((y, slope_of(&found, y, &self.excess, step * l0) * l0))
    }

    /// A contraction at which the excess is positive, and one from which to go on.
    fn below(&mut self, [start, end]: [f64; 2]) -> Result<(f64, f64), FibreError> {
        if self.problem.is_singular() {
            return Ok((0.0, start));
        }
        self.below_start([start, end]).or_else(|error| self.drawn_out(start).ok_or(error))
    }

    fn below_start(&mut self, [start, end]: [f64; 2]) -> Result<(f64, f64), FibreError> {
        let mut good: Option<(f64, f64)> = None;
        let mut x = start;
        let mut stride = (0.5 * start.abs()).max(1e-3);
        let mut failures = 0_u32;
        // Go to smaller contractions, in growing strides, until the excess is positive.
        for _ in 0..80 {
            match (self.value(x, false), good) {
                (Ok((y, _)), _) if y > 0.0 => return Ok((x, x)),
                (Ok((_, slope)), _) => {
                    // Past a largest excess between the last two equilibria.
                    if let Some((last, before)) = good
                        && before < 0.0
                        && slope > 0.0
                        && let Some(top) = self.top([x, last])
                    {
                        return Ok((top, top));
                    }
                    good = Some((x, slope));
                    // Elastic fibres can be drawn out farther; beside an end of the range strides stay small.
                    failures -= u32::from(failures > 0 && self.problem.net.compliance > 0.0);
                    stride *= if failures == 0 { 1.6 } else { 1.0 };
                }
                // No equilibrium here: go back to the last one and take smaller strides.
                (Err(_), Some(_)) if failures < 12 => {
                    failures += 1;
                    stride *= 0.3;
                }
                // The start itself overstretches the fibres. At rest this isn't checked.
                (Err(FibreError::Overstretched { .. }), None) if x < end.min(0.0) => {
                    x = end.min(0.0);
                    continue;
                }
                // The start itself lies beyond the range of a very short muscle.
                (Err(_), None) if failures < 12 => {
                    failures += 1;
                    x *= 0.3;
                    continue;
                }
                (Err(error), _) => return Err(error),
            }
            x = good.map_or(x, |(good, _)| good) - stride;
        }
        Err(not_converged(x, 80))
    }

    /// A contraction at which the excess is positive, next to its largest value between two contractions: it
    /// rises at the first and falls at the second. Its slope vanishes there. If the largest value isn't
    /// positive, the search goes on from where it was.
    fn top(&mut self, [mut low, mut high]: [f64; 2]) -> Option<f64> {
        let near = self.near;
        let room = high - low;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let Ok((y, slope)) = self.value(middle, false) else { break };
            if y > 0.0 {
                return Some(middle);
            }
            *(if slope > 0.0 { &mut low } else { &mut high }) = middle;
            if high - low < FLAT * room {
                break;
            }
        }
        self.near = near;
        None
    }

    /// Far enough drawn out, any muscle has an equilibrium: its fibres are nearly straight and carry far more
    /// than the pressure.
    fn drawn_out(&mut self, start: f64) -> Option<(f64, f64)> {
        let net = &self.problem.net;
        let longest = start::longest(&Net { compliance: 0.0, ..net.clone() });
        let stretched = STRETCHED.iter().filter(|_| net.compliance > 0.0).map(|part| longest - part);
        let places = DRAWN_OUT.iter().map(|part| longest + part * (start - longest)).chain(stretched);
        for place in places.collect::<Vec<_>>() {
            if let Ok(found) = self.at(place, false)
                && (self.excess)(&found) > 0.0
            {
                return Some((place, place));
            }
        }
        // The last resort: a tension is prescribed, and the contraction follows.
        let (place, unknowns) = drawn_taut(net)?;
        self.near = Some(unknowns);
        let found = self.at(place, true).ok()?;
        ((self.excess)(&found) > 0.0).then_some((place, place))
    }

    /// The root from `low` on, where the excess is positive, to `end`. The first step leads to `x`. The outer
    /// error is that of the way up, where no sign changes; the inner one that of the root between two signs.
    fn root(
        &mut self,
        [low, x, end]: [f64; 3],
        reach: f64,
        tolerance: [f64; 2],
    ) -> Result<Result<Found, FibreError>, FibreError> {
        let (low, high) = match self.up(low, [x, end], reach, tolerance)? {
            Step::Root(root) => return Ok(self.at(root, false)),
            Step::Between(low, high) => (low, high),
        };
        Ok(match newton_bracketed(|x| self.value(x, false), low, high, high, tolerance) {
            Ok(root) => self.at(root, false),
            Err(RootError::Function(error)) => Err(error),
            Err(RootError::Budget { at, value, .. }) => {
                Err(FibreError::NotConverged { contraction: at, residual: value, iterations: 100 })
            }
        })
    }

    /// Whether the fibres are all but slack at the last equilibrium.
    fn is_nearly_slack(&self) -> bool {
        self.near.is_some_and(|near| near.is_slack_within(&self.problem.net, NEARLY_SLACK))
    }

    /// Goes up by Newton steps, the first of which is trusted up to `reach`, until the sign changes. If `end`
    /// lies before [`FAR`], the sign has changed there. Where there is no equilibrium, the steps are halved
    /// until there is none beside the last one.
    fn up(
        &mut self,
        mut low: f64,
        [mut x, end]: [f64; 2],
        mut reach: f64,
        tolerance: [f64; 2],
    ) -> Result<Step, FibreError> {
        // The contraction at which slack fibres were seen.
        let mut slack = FAR;
        let mut failed = false;
        for _ in 0..MOST_STEPS {
            if end < FAR && x >= end {
                return Ok(Step::Between(low, end));
            }
            match self.value(x, failed && x - low < BESIDE) {
                Ok((y, slope)) if y > 0.0 => {
                    let gone = if failed { 1.0 } else { 2.0 } * (x - low);
                    (low, failed) = (x, false);
                    let step = -y / slope;
                    if step.abs() <= tolerance[0] + tolerance[1] * x.abs() {
                        return Ok(Step::Root(x + step));
                    }
                    if reach.is_finite() {
                        reach = reach.max(gone);
                    }
                    // A Newton step backwards says nothing: only the trusted reach limits the next step.
                    let wish = if step > 0.0 { step } else { f64::INFINITY };
                    x = low + wish.min(reach);
                    if x >= slack || x >= FAR {
                        x = 0.5 * (low + slack);
                    }
                }
                Ok(_) => return Ok(Step::Between(low, x)),
                // At a border, rounding decides whether there is an equilibrium.
                Err(_) if x - low < SMALLEST && !failed => (x, failed) = (low + OFF_BORDER, true),
                Err(error) => {
                    failed = true;
                    if matches!(error, FibreError::Slack { .. }) {
                        slack = x;
                    }
                    reach = 0.5 * (x - low);
                    if reach < SMALLEST {
                        let is_slack = matches!(error, FibreError::Slack { .. }) || self.is_nearly_slack();
                        let slack = FibreError::Slack { contraction: x, limit: Some(low) };
                        return Err(if is_slack { slack } else { error });
                    }
                    x = low + reach;
                }
            }
            if slack - low < SMALLEST {
                return Err(if slack < FAR {
                    FibreError::Slack { contraction: x, limit: Some(low) }
                } else {
                    not_converged(x, 0)
                });
            }
        }
        Err(not_converged(x, MOST_STEPS))
    }
}

/// The end of a way up.
enum Step {
    Root(f64),
    Between(f64, f64),
}

fn not_converged(contraction: f64, iterations: u32) -> FibreError {
    FibreError::NotConverged { contraction, residual: f64::INFINITY, iterations }
}

impl Problem {
    /// A contraction inside the range of this muscle, from which a search starts.
    pub(crate) fn contraction_start(&self) -> f64 {
        let net = &self.net;
        let ends = (net.half_fibre / (1.0 + net.half_fibre)).powi(2);
        // On fittings of another radius the range of a short braid may lie far from 0.
        let straight = if self.parts.fitting.is_some() && !self.is_cylinder() {
            shooting::straight_contraction(net)
        } else {
            None
        };
        // Lobes that open early leave little to contract: about a third of their room at either end.
        let room = net.lobes.map(|lobes| (lobes.limit() - net.depth - net.end_radius) / net.half_fibre);
        straight.unwrap_or(0.0) + (0.12 * ends).min(room.map_or(f64::INFINITY, |room| 0.1 * room))
    }

    /// Distance of a contraction from that of drawn-out fibres, where the force goes to infinity. 1 if that
    /// is far.
    fn room_at(&self, contraction: f64) -> f64 {
        let room = self.longest().map_or(1.0, |longest| contraction - longest);
        if room < DRAWN_OUT_ROOM { room.max(LEAST_ROOM) } else { 1.0 }
    }

    /// The contraction at which `excess` is zero. The excess falls with the contraction; its derivative is
    /// taken from the response. The way leads from a start to an end where the excess is negative, or to
    /// [`FAR`].
    pub(crate) fn root(
        &self,
        scheme: Scheme,
        [start, end]: [f64; 2],
        seen: &mut Seen,
        excess: impl Fn(&Found) -> f64,
    ) -> Result<Found, FibreError> {
        let mut walk = Walk { problem: self, scheme, near: None, seen, excess };
        let (low, x) = walk.below([start, end])?;
        if low > end {
            return Err(not_converged(low, 0));
        }
        // The force of straight inextensible fibres is infinite at 0, and large forces belong to tiny
        // contractions.
        let tolerance = if self.is_singular() {
            [0.0, ROOT_TOLERANCE]
        } else {
            [ROOT_TOLERANCE * self.room_at(low), 0.0]
        };
        let near = walk.near;
        walk.root([low, x, end], f64::INFINITY, tolerance)?.or_else(|error| {
            // Newton's method jumped to where no start leads, though the sign changes: go there in steps.
            walk.near = near;
            walk.root([low, x, end], PATIENT * (end - low), tolerance)?.map_err(|_| error)
        })
    }
}

impl Problem {
    /// The equilibrium of a muscle that is drawn out to a contraction below the start of searches, step by
    /// step from there. A cold start finds it only nearby.
    pub(crate) fn drawn_to(&self, scheme: Scheme, contraction: f64) -> Option<Found> {
        let start = self.contraction_start();
        if contraction >= start {
            return None;
        }
        let excess = |_: &Found| 0.0;
        let mut walk = Walk { problem: self, scheme, near: None, seen: &mut { Seen::NOTHING }, excess };
        walk.at(start, false).ok()?;
        let (mut x, mut stride) = (start, 0.25 * (start - contraction));
        for _ in 0..MOST_STEPS {
            let next = (x - stride).max(contraction);
            match walk.at(next, false) {
                Ok(found) if next <= contraction => return Some(found),
                Ok(_) => (x, stride) = (next, 2.0 * stride),
                Err(_) => stride *= 0.25,
            }
            if stride < SMALLEST {
                break;
            }
        }
        None
    }
}

/// The condition that a place on a path must satisfy.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Goal {
    Contraction(f64),
    /// \[N\].
    Force(f64),
    /// \[m^3\].
    Volume(f64),
}

impl Problem {
    /// An equilibrium from the paths of this muscle and from what a search has seen. This takes long. It is
    /// the first one that pulls, or the first that exists if it need not pull.
    pub(crate) fn on_a_path(
        &self,
        scheme: Scheme,
        goal: Goal,
        must_pull: bool,
        seen: &Seen,
    ) -> Option<Found> {
        self.on_one_of(&mut Paths::of(&self.net, seen.last), scheme, goal, must_pull)
    }

    /// The end of the range on a path: the equilibrium at which the force vanishes, or the contraction at
    /// which the fibres of a pulling muscle become slack.
    pub(crate) fn limit_on_a_path(&self, scheme: Scheme, seen: &Seen) -> Option<Result<Found, f64>> {
        let mut paths = Paths::of(&self.net, seen.last);
        let found = self.on_one_of(&mut paths, scheme, Goal::Force(0.0), true).map(Ok);
        found.or_else(|| paths.slackening().map(Err))
    }

    fn on_one_of(&self, paths: &mut Paths, scheme: Scheme, goal: Goal, must_pull: bool) -> Option<Found> {
        let radius = self.parts.radius;
        let [unit_force, unit_volume] = [self.pressure * radius * radius, radius.powi(3)];
        let excess = |place: &Place| match goal {
            Goal::Contraction(asked) => place.contraction - asked,
            Goal::Force(asked) => place.force - asked / unit_force,
            Goal::Volume(asked) => place.volume - asked / unit_volume,
        };
        let places = paths.crossings(excess);
        places.iter().find_map(|place| {
            let found = self.near_place(scheme, goal, place).ok()?;
            (self.pulls(&found.response) || !must_pull).then_some(found)
        })
    }

    /// The equilibrium beside a place, solved in the usual way.
    fn near_place(&self, scheme: Scheme, goal: Goal, place: &Place) -> Result<Found, FibreError> {
        let excess = |found: &Found| match goal {
            Goal::Contraction(asked) => asked - found.response.contraction,
            Goal::Force(asked) => found.response.force_n - asked,
            Goal::Volume(asked) => asked - found.response.volume_m3,
        };
        let near = Some(place.unknowns);
        let mut walk = Walk { problem: self, scheme, near, seen: &mut { Seen::NOTHING }, excess };
        if let Goal::Contraction(asked) = goal {
            return walk.at(asked, true);
        }
        let mut at = place.contraction;
        for _ in 0..NEAR_STEPS {
            let (y, slope) = walk.value(at, true)?;
            let step = -y / slope;
            if step.abs() > NEARBY {
                break;
            }
            at += step;
            if step.abs() <= NEARBY * ROOT_TOLERANCE {
                return walk.at(at, true);
            }
        }
        Err(not_converged(at, NEAR_STEPS))
    }
}

/// Derivative of an excess of contraction, force or volume by the contraction, per length l0. The response is
/// moved along its exact slopes by a small shortening.
fn slope_of(found: &Found, y: f64, excess: &impl Fn(&Found) -> f64, shortening: f64) -> f64 {
    let mut moved = *found;
    let r = &mut moved.response;
    r.contraction += shortening * (1.0 - r.contraction) / r.length_m;
    r.force_n -= r.stiffness_n_per_m * shortening;
    r.volume_m3 -= r.volume_slope_m2 * shortening * r.volume_m3 / r.volume_polygon_m3;
    (excess(&moved) - y) / shortening
}
