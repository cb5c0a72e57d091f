//! Paths of equilibria. A path joins all middles whose fibres have their length, by arc length in the plane
//! of the two unknowns.
//!
//! `S(first, second) = S_half` is a curve in that plane. Contraction, force and volume change along it. The
//! contraction is not its parameter. As a parameter it fails where stiff cloth comes taut: there force and
//! tension change while the contraction hardly does, or turns back.
//! The step is that of E. Riks, *An incremental approach to the solution of snapping and buckling problems*,
//! Int. J. Solids Struct. 15, 529 (1979): a predictor along the tangent and Newton's method on the line
//! across it.

use bulge_numerics::{Dual, Real};

use crate::meridian::{SHORTENING, Trajectory, VOLUME};
use crate::net::Net;
use crate::quadrature;
use crate::shooting::{Effort, solve_two};
use crate::start::drawn_out;
use crate::unknowns::{FLAT, Kind, Unknowns, is_limited};

/// Limit on the evaluations of all paths of a muscle.
const MOST_EVALUATIONS: u32 = 100_000;
/// Bulges and waists from which a path is sought, as fractions of the available range.
const SEEDS: [f64; 7] = [3e-3, 0.1, 0.3, 0.6, 0.9, 0.99, 0.999];
/// Most Newton steps for the second unknown of a seed, and for a step along a path.
const SEED_STEPS: u32 = 40;
const STEPS: u32 = 8;
/// Largest |ln(S/S_half)| at a place. One more step reduces it to rounding.
const MET: f64 = 1e-9;
/// The same for an equilibrium that is known from elsewhere.
const KNOWN: f64 = 1e-6;
/// Most steps of a root search between two places, and the distance of the two at which it ends.
const BETWEEN: u32 = 60;
const CLOSE: f64 = 1e-9;
/// First, least and largest step along a path, and the largest step along a cylinder as a fraction of ln|k|.
const ARC: [f64; 3] = [0.3, 1e-6, 2.0];
const CYLINDER: f64 = 0.15;
/// Largest step on the way to a seed, also as a fraction of ln|k|.
const FLATTER: f64 = 0.6;
/// Places of a path, at most.
const MOST_PLACES: usize = 300;
/// ln|k| below which a middle is too flat, and ln|B| below which it is straight.
const FLATTEST: f64 = -2e4;
const STRAIGHT: f64 = -9.0;
/// Axial force in p R^2 and strain of the fibres beyond which the fibres are drawn out far enough, and the strain where
/// the pressure stretches soft ones.
const DRAWN: [f64; 3] = [1e9, 0.5, 1.0];
/// Derivative of ln S by ln|B| above which a waist is as narrow as its fibres make it.
const STEEP: f64 = 1e5;
/// Places that are followed after the force has vanished.
const BEYOND: usize = 3;

/// An equilibrium on a path.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) unknowns: Unknowns,
    pub(crate) contraction: f64,
    /// Axial force in p R^2.
    pub(crate) force: f64,
    /// Whole volume in R^3.
    pub(crate) volume: f64,
    pub(crate) is_slack: bool,
    /// Derivatives of ln(S/S_half) by the unknowns.
    gradient: [f64; 2],
    /// Whether the fibres are drawn out far.
    is_drawn: bool,
}

/// The plane of the unknowns of a muscle, and the evaluations spent in it.
struct Plane<'a> {
    net: &'a Net<f64>,
    lifted: Net<Dual<2>>,
    effort: Effort,
}

/// The paths of a muscle.
pub(crate) struct Paths<'a> {
    plane: Plane<'a>,
    found: Vec<Vec<Place>>,
}

impl<'a> Paths<'a> {
    /// All paths that the seeds lead to, and the path through a `known` equilibrium. There are none if the
    /// meridian is no quadrature.
    pub(crate) fn of(net: &'a Net<f64>, known: Option<Unknowns>) -> Self {
        let mut plane = Plane { net, lifted: net.lift(), effort: Effort::of_at_most(MOST_EVALUATIONS) };
        let mut found: Vec<Vec<Place>> = Vec::new();
        if quadrature::suits(net) {
            found.extend(known.and_then(|at| plane.known(at)).map(|seed| plane.through(seed)));
            for (side, bulge) in seeds(net) {
                let first = Unknowns::new(net, side, [bulge.ln(), FLAT]).logs[0];
                if !found.iter().any(|path| covers(path, side, first)) {
                    found.extend(plane.seed(side, bulge).map(|seed| plane.through(seed)));
                }
            }
        }
        Self { plane, found }
    }

    /// Neighbours of which at least one has taut fibres.
    fn pairs(&self) -> impl Iterator<Item = [Place; 2]> {
        let pairs = self.found.iter().flat_map(|path| path.windows(2)).map(|pair| [pair[0], pair[1]]);
        pairs.filter(|[a, b]| !(a.is_slack && b.is_slack))
    }

    /// The places with taut fibres at which an excess vanishes. It changes its sign there between two
    /// neighbours.
    pub(crate) fn crossings(&mut self, excess: impl Fn(&Place) -> f64) -> Vec<Place> {
        let changes: Vec<_> = self.pairs().filter(|[a, b]| (excess(a) > 0.0) != (excess(b) > 0.0)).collect();
        let places = changes.into_iter().map(|pair| self.plane.between(pair, &excess));
        places.map(|[place, _]| place).filter(|place| !place.is_slack).collect()
    }

    /// The contraction at which the fibres of a pulling muscle become slack, if a path gets there.
    pub(crate) fn slackening(&mut self) -> Option<f64> {
        let slack = |place: &Place| if place.is_slack { 1.0 } else { -1.0 };
        let ends: Vec<_> = self.pairs().filter(|[a, b]| a.is_slack != b.is_slack).collect();
        let mut ends = ends.into_iter().map(|pair| self.plane.between(pair, &slack));
        let [a, b] = ends.find(|[a, _]| a.force > 0.0)?;
        Some(if a.is_slack { b } else { a }.contraction)
    }
}

/// Whether a path passes a value of the first unknown.
fn covers(path: &[Place], side: f64, first: f64) -> bool {
    path.windows(2).any(|pair| {
        let [a, b] = [0, 1].map(|i| pair[i].unknowns);
        a.kind != Kind::BulgeByTension
            && a.kind.side() * side > 0.0
            && (a.logs[0] > first) != (b.logs[0] > first)
    })
}

/// Sides and bulges of the seeds. They reach from the fitting's radius to the narrowest and the widest
/// middle, on either side of the radius at which cloth comes taut.
fn seeds(net: &Net<f64>) -> Vec<(f64, f64)> {
    let is_straight = net.turn == 0.0;
    let widest =
        if is_straight { net.half_fibre } else { net.half_fibre.min(1.0 / net.turn.abs() - net.end_radius) };
    let most = widest.min(net.most_bulge());
    let slack = net.cloth.map_or(most, |cloth| (cloth.radius - net.end_radius).min(most));
    let mut rooms = vec![(1.0, 0.0, slack), (1.0, slack, most - slack)];
    if !is_straight {
        let (narrowest, _) = drawn_out(&Net { compliance: 0.0, ..net.clone() });
        rooms.push((-1.0, 0.0, net.end_radius - narrowest));
    }
    let of_room = |(side, from, room): (f64, f64, f64)| {
        SEEDS.iter().filter(move |_| room > 0.0).map(move |part| (side, from + part * room))
    };
    rooms.into_iter().flat_map(of_room).collect()
}

impl Plane<'_> {
    /// Two places close to each other. The excess changes its sign between them as it does between the two
    /// neighbours.
    fn between(&mut self, [mut a, mut b]: [Place; 2], excess: &impl Fn(&Place) -> f64) -> [Place; 2] {
        self.effort = Effort::of_at_most(MOST_EVALUATIONS);
        for step in 0..BETWEEN {
            let [from, to] = [a, b].map(|place| place.unknowns.logs);
            let chord = [to[0] - from[0], to[1] - from[1]];
            let length = chord[0].hypot(chord[1]);
            let offs = [excess(&a), excess(&b)];
            if length < CLOSE || offs[0] == 0.0 {
                break;
            }
            // Every third step halves: regula falsi alone may creep.
            let part =
                if step % 3 == 2 { 0.5 } else { (offs[0] / (offs[0] - offs[1])).clamp(1e-3, 1.0 - 1e-3) };
            let Some(middle) = self.step(&a, chord.map(|part| part / length), part * length, true) else {
                break;
            };
            if (excess(&middle) > 0.0) == (offs[0] > 0.0) {
                a = middle;
            } else {
                b = middle;
            }
        }
        if excess(&a).abs() <= excess(&b).abs() { [a, b] } else { [b, a] }
    }

    fn run(&mut self, at: Unknowns) -> Option<(Trajectory<Dual<2>>, Dual<2>)> {
        if self.effort.is_spent() {
            return None;
        }
        let middle = at.seeded(&self.lifted)?;
        let run = quadrature::trajectory(&self.lifted, middle);
        self.effort.evaluations += run.as_ref().map_or_else(|none| none.evaluations, |run| run.evaluations);
        let run = run.ok()?;
        let length = (run.half_fibre / self.net.half_fibre).ln();
        length.value().is_finite().then_some((run, length))
    }

    fn place(&self, at: Unknowns, run: &Trajectory<Dual<2>>, length: &Dual<2>) -> Place {
        let net = self.net;
        let strain = net.compliance * run.mid_tension.value();
        Place {
            unknowns: at,
            contraction: run.end[SHORTENING].value() / (net.cos_rest * net.half_fibre),
            force: run.force.value(),
            volume: 2.0 * run.end[VOLUME].value(),
            is_slack: at.is_slack(net),
            gradient: *length.gradient(),
            is_drawn: run.force.value() > DRAWN[0]
                || strain > if at.kind == Kind::BulgeByTension { DRAWN[2] } else { DRAWN[1] }
                || (at.kind == Kind::Waist && length.gradient()[0] > STEEP),
        }
    }

    /// The place with a given bulge. Newton's method finds its second unknown; where there is no meridian, a
    /// flatter one is tried.
    fn seed(&mut self, side: f64, bulge: f64) -> Option<Place> {
        let mut second = (2.0 * bulge / self.net.half_fibre.powi(2)).ln();
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for _ in 0..SEED_STEPS {
            let at = Unknowns::new(self.net, side, [bulge.ln(), second]);
            let newton = match self.run(at) {
                Some((run, length)) if length.value().abs() < MET => {
                    return Some(self.place(at, &run, &length));
                }
                Some((_, length)) => {
                    if length.value() > 0.0 {
                        low = second;
                    } else {
                        high = second;
                    }
                    // The slope at a given bulge: the first unknown may depend on the second one.
                    let moved =
                        Unknowns::new(self.net, side, [bulge.ln(), second + 1.0]).logs[0] - at.logs[0];
                    let slope = length.gradient()[1] + moved * length.gradient()[0];
                    let most = if second < FLAT { FLATTER * second.abs() } else { 4.0 };
                    second - (length.value() / slope).clamp(-most, most)
                }
                None => {
                    high = second;
                    second - 2.0
                }
            };
            // Newton's value counts inside the bracket. Otherwise bisect.
            second = match (newton > low && newton < high, low.is_finite() && high.is_finite()) {
                (true, _) => newton,
                (false, true) => 0.5 * (low + high),
                (false, false) => return None,
            };
            if self.effort.is_spent() || second < FLATTEST {
                return None;
            }
        }
        None
    }

    /// The place of a known equilibrium.
    fn known(&mut self, at: Unknowns) -> Option<Place> {
        let (run, length) = self.run(at)?;
        (length.value().abs() < KNOWN).then(|| self.place(at, &run, &length))
    }

    /// The path through a place.
    fn through(&mut self, seed: Place) -> Vec<Place> {
        let mut path = self.along(seed, -1.0);
        path.reverse();
        path.push(seed);
        path.extend(self.along(seed, 1.0));
        path
    }

    /// Follows a path from a place in one direction. It ends where the fibres are slack, drawn out far or as
    /// good as straight, where the muscle pushes more and more, or where there is no next place.
    fn along(&mut self, seed: Place, direction: f64) -> Vec<Place> {
        let mut path: Vec<Place> = Vec::new();
        let mut at = seed;
        let mut tangent = across(at.gradient).map(|part| direction * part);
        let mut arc = ARC[0];
        let mut pushing = 0;
        while path.len() < MOST_PLACES
            && !at.is_slack
            && !at.is_drawn
            && !self.is_straight(&at)
            && pushing < BEYOND
        {
            let second = at.unknowns.logs[1];
            let most = if second < FLAT && tangent[1].abs() > 0.9 { CYLINDER * second.abs() } else { ARC[2] };
            arc = arc.min(most);
            let Some(next) = self.step(&at, tangent, arc, false) else {
                arc *= 0.3;
                if arc < ARC[1] || self.effort.is_spent() {
                    break;
                }
                continue;
            };
            pushing = if next.force < 0.0 && next.force < at.force { pushing + 1 } else { 0 };
            let new = across(next.gradient);
            // The tangent is known up to its sign: go on in the same direction.
            let sign = (new[0] * tangent[0] + new[1] * tangent[1]).signum();
            tangent = new.map(|part| sign * part);
            arc *= 1.6;
            at = next;
            path.push(next);
        }
        path
    }

    fn is_straight(&self, place: &Place) -> bool {
        let Unknowns { kind, logs } = place.unknowns;
        if logs[1] < FLATTEST || place.contraction > 1.0 {
            return true;
        }
        if kind == Kind::BulgeByTension {
            return logs[1] > -STRAIGHT;
        }
        let side = kind.side();
        let shallow = Unknowns::new(self.net, side, [STRAIGHT, logs[1]]).logs[0];
        if is_limited(self.net, side) { logs[0] > shallow } else { logs[0] < shallow }
    }

    /// The next place, an arc further along a tangent. `exact`: up to rounding.
    fn step(&mut self, from: &Place, tangent: [f64; 2], arc: f64, exact: bool) -> Option<Place> {
        let Unknowns { kind, logs } = from.unknowns;
        let ahead = [logs[0] + arc * tangent[0], logs[1] + arc * tangent[1]];
        let mut at = ahead;
        let mut is_met = false;
        for _ in 0..STEPS {
            let unknowns = Unknowns { kind, logs: at };
            let (run, length) = self.run(unknowns)?;
            let was_met = is_met;
            is_met = length.value().abs() < MET;
            if was_met || (is_met && !exact) {
                return Some(self.place(unknowns, &run, &length));
            }
            // Newton's method for the fibre length on the line across the tangent.
            let missed = tangent[0] * (at[0] - ahead[0]) + tangent[1] * (at[1] - ahead[1]);
            let step = solve_two([*length.gradient(), tangent], [length.value(), missed]);
            let size = step[0].hypot(step[1]);
            if size.is_nan() || size > 2.0 * arc {
                return None;
            }
            at = [at[0] - step[0], at[1] - step[1]];
        }
        None
    }
}

/// The unit vector perpendicular to another one.
fn across([a, b]: [f64; 2]) -> [f64; 2] {
    let size = a.hypot(b);
    [-b / size, a / size]
}
