//! Searches all equilibria of a muscle on a dense grid. For each radius at mid-length (or length of a
//! cylinder) it finds all curvatures with which the fibres have their length. Between neighbours on either
//! side of the required quantity it finds the equilibrium.

use bulge_fibre::Given;
use bulge_muscles::{Construction, Ends, Muscle, Pressure, Quantity};

use super::meridian::{Meridian, meridian};
use super::net::Net;

/// Second parameters at which fibre lengths are evaluated, as steps from a first one. A long braid has e^-150
/// in its middle.
const SECOND: [(f64, f64, u32); 3] = [(-690.0, 20.0, 33), (-30.0, 0.75, 52), (9.0, 1.5, 8)];
/// Distances of grid radii from places where something changes: e^-step of the way.
const CLOSE: (f64, u32) = (0.4, 50);
/// Number of equal parts of the way.
const EVEN: u32 = 40;
/// Halvings of an interval at the edge of existence, and on the way to a root.
const EDGE: u32 = 24;
const ROOT: u32 = 200;
/// Distance from the required quantity, relative to its scale, below which a minimum may hide two equilibria.
const MISSED: f64 = 0.05;
/// Accepted error of a fibre length, as a logarithm, and of the required quantity, relative to its scale.
const LENGTH: f64 = 1e-9;
const ASKED: f64 = 1e-7;

/// An equilibrium that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Contraction \[-\].
    pub contraction: f64,
    /// Axial force \[N\], pull positive.
    pub force_n: f64,
    /// Volume \[m^3\] of circles, or of lobes.
    pub volume_m3: f64,
    /// Whether all fibres are taut.
    pub taut: bool,
}

/// The required quantity in dimensionless form, with its scale.
#[derive(Debug, Clone, Copy)]
enum Asked {
    HalfLength(f64),
    Force(f64),
    HalfVolume(f64),
}

/// A point of the search: the first parameter, the second parameter for which a muscle exists, and the
/// muscle.
#[derive(Debug, Clone, Copy)]
struct Point {
    first: f64,
    second: f64,
    found: Meridian,
}

/// The path that is searched.
struct Way<'a> {
    net: &'a Net,
    cylinder: bool,
    asked: Asked,
}

/// Whether the search can prove that there is no equilibrium. If lobes or cloth limit the radius of straight
/// fibres, the radius in the middle is closer to that limit than numbers resolve, and is no suitable
/// parameter.
#[must_use]
pub fn can_exclude(muscle: &Muscle) -> bool {
    let net = Net::new(muscle, Pressure::bar(1.0));
    net.turn > 0.0 || (net.taut_radius().is_none() && net.limits()[2].is_none())
}

/// All equilibria that are found from a dense grid. If `given` is none, those without force.
#[must_use]
pub fn states(muscle: &Muscle, pressure: Pressure, given: Option<Given>) -> Vec<State> {
    let net = Net::new(muscle, pressure);
    let radius = muscle.radius().si();
    let (unit, l0) = (pressure.si() * radius * radius, muscle.length().si());
    let asked = match given {
        None => Asked::Force(0.0),
        Some(Given::Contraction(contraction)) => Asked::HalfLength(0.5 * l0 / radius * (1.0 - contraction)),
        Some(Given::Length(length)) => Asked::HalfLength(0.5 * length / radius),
        Some(Given::Force(force)) => Asked::Force(force / unit),
        Some(Given::Volume(volume)) => Asked::HalfVolume(0.5 * volume / radius.powi(3)),
    };
    let cylinder =
        matches!(muscle.construction(), Construction::Braided(braided) if braided.ends() == Ends::Cylinder);
    let way = Way { net: &net, cylinder, asked };
    way.states()
        .into_iter()
        .map(|point| State {
            contraction: 1.0 - 2.0 * point.found.half_length * radius / l0,
            force_n: point.found.force * unit,
            volume_m3: 2.0 * point.found.half_volume * radius.powi(3),
            taut: point.found.least_tension >= 0.0,
        })
        .collect()
}

impl Way<'_> {
    fn off(&self, found: &Meridian) -> f64 {
        match self.asked {
            Asked::HalfLength(asked) => (found.half_length - asked) / asked,
            Asked::Force(asked) => (found.force - asked) / (found.area + asked.abs()),
            Asked::HalfVolume(asked) => (found.half_volume - asked) / asked,
        }
    }

    fn at(&self, first: f64, second: f64) -> Option<Meridian> {
        if self.cylinder { cylinder(self.net, first, second) } else { meridian(self.net, first, second) }
    }

    /// First parameters: dense near all places where something changes, and evenly spaced between them.
    fn grid(&self) -> Vec<f64> {
        let net = self.net;
        let (low, high) = if self.cylinder {
            (1e-3, 1.5)
        } else {
            let most = net.end + 1.6 * net.half;
            (1e-9 * net.end, net.limits().into_iter().skip(1).flatten().fold(most, f64::min))
        };
        let mut marks = vec![low, high];
        if !self.cylinder {
            marks.extend(
                [Some(net.end), net.taut_radius(), net.limits()[0], self.cylinder_radius()]
                    .into_iter()
                    .flatten(),
            );
        }
        marks.retain(|mark| *mark >= low && *mark <= high);
        marks.sort_by(f64::total_cmp);
        marks.dedup();
        let mut grid = Vec::new();
        for pair in marks.windows(2) {
            let room = pair[1] - pair[0];
            grid.extend((1..EVEN).map(|i| pair[0] + room * f64::from(i) / f64::from(EVEN)));
            for part in (1..=CLOSE.1).map(|i| (-CLOSE.0 * f64::from(i)).exp()) {
                grid.extend([pair[0] + room * part, pair[1] - room * part]);
            }
        }
        grid.retain(|first| *first > low && *first < high && (*first - net.end).abs() > 1e-11 * net.end);
        grid.sort_by(f64::total_cmp);
        grid.dedup();
        grid
    }

    /// The radius of the cylinder of inextensible fibres at the required contraction.
    fn cylinder_radius(&self) -> Option<f64> {
        let Asked::HalfLength(half) = self.asked else { return None };
        let sigma = half / self.net.half;
        (self.net.turn > 0.0 && sigma < 1.0).then(|| (1.0 - sigma * sigma).sqrt() / self.net.turn)
    }

    /// The second parameters for which a muscle exists with a first one.
    fn points(&self, first: f64) -> Vec<Point> {
        let seconds = SECOND
            .iter()
            .flat_map(|(from, step, count)| (0..*count).map(move |i| from + step * f64::from(i)));
        let mut points = Vec::new();
        let mut before: Option<(f64, Option<f64>)> = None;
        let mut last: Option<(f64, Option<f64>)> = None;
        for second in seconds {
            let here = self.at(first, second).map(|found| found.excess);
            match last {
                Some((before, Some(excess))) if here.is_some_and(|here| (here > 0.0) != (excess > 0.0)) => {
                    points.extend(self.length(first, [before, second], excess > 0.0));
                }
                // A root of the length may be hidden at an edge of existence.
                Some((before, Some(excess))) if here.is_none() => {
                    points.extend(self.edge(first, [before, second], excess));
                }
                Some((before, None)) if let Some(excess) = here => {
                    points.extend(self.edge(first, [second, before], excess));
                }
                _ => {}
            }
            // Two roots between the last three points may not show in the signs.
            if let ([Some((a, Some(left))), Some((_, Some(middle)))], right) = ([before, last], here)
                && middle > 0.0
                && middle < left
                && right.is_none_or(|right| right > middle)
            {
                points.extend(self.pair(first, [a, second]));
            }
            (before, last) = (last, Some((second, here)));
        }
        points
    }

    /// The two roots of the length next to the shortest fibre between two second parameters, if that fibre is
    /// too short.
    fn pair(&self, first: f64, [a, b]: [f64; 2]) -> Vec<Point> {
        let excess = |second: f64| self.at(first, second).map_or(f64::INFINITY, |found| found.excess);
        let (mut low, mut high) = (a, b);
        for _ in 0..EDGE {
            let third = (high - low) / 3.0;
            let inner = [low + third, high - third];
            let values = inner.map(excess);
            if values[0] < 0.0 || values[1] < 0.0 {
                let short = if values[0] < 0.0 { inner[0] } else { inner[1] };
                let before = self.length(first, [a, short], true);
                let after = self.at(first, b).and_then(|_| self.length(first, [short, b], false));
                return before.into_iter().chain(after).collect();
            }
            if values[0] < values[1] { high = inner[1] } else { low = inner[0] }
        }
        Vec::new()
    }

    /// Moves from a parameter with a muscle towards one without. Returns the point at which the fibres have
    /// their length if the excess changes its sign on the way.
    fn edge(&self, first: f64, [mut good, mut bad]: [f64; 2], excess: f64) -> Option<Point> {
        for _ in 0..EDGE {
            let middle = 0.5 * (good + bad);
            match self.at(first, middle) {
                Some(found) if (found.excess > 0.0) != (excess > 0.0) => {
                    return self.length(first, [good, middle], excess > 0.0);
                }
                Some(_) => good = middle,
                None => bad = middle,
            }
        }
        None
    }

    /// The second parameter between two others at which the fibres have their length.
    fn length(&self, first: f64, [mut low, mut high]: [f64; 2], low_is_long: bool) -> Option<Point> {
        let mut best: Option<Point> = None;
        let mut sides: [Option<f64>; 2] = [None; 2];
        for step in 0..ROOT {
            let even = 0.5 * (low + high);
            // Every third step bisects, because regula falsi alone may converge slowly.
            let second = match sides {
                [Some(a), Some(b)] if step % 3 != 2 => {
                    low + (high - low) * (a / (a - b)).clamp(1e-3, 1.0 - 1e-3)
                }
                _ => even,
            };
            let found = self.at(first, second)?;
            let excess = found.excess;
            if best.is_none_or(|best| excess.abs() < best.found.excess.abs()) {
                best = Some(Point { first, second, found });
            }
            let place = usize::from((excess > 0.0) != low_is_long);
            if place == 0 {
                low = second;
            } else {
                high = second;
            }
            sides[place] = excess.is_finite().then_some(excess);
            if excess.abs() < 1e-14 || (high - low).abs() <= 4.0 * f64::EPSILON * even.abs() {
                break;
            }
        }
        best.filter(|best| best.found.excess.abs() < LENGTH)
    }

    fn states(&self) -> Vec<Point> {
        let mut rows: Vec<(f64, Vec<Point>)> =
            self.grid().into_iter().map(|first| (first, self.points(first))).collect();
        self.refine(&mut rows);
        let mut found: Vec<Point> = Vec::new();
        for pair in rows.windows(2) {
            for one in &pair[0].1 {
                if self.off(&one.found).abs() < 1e-12 {
                    found.push(*one);
                }
                if let Some(other) = nearest(&pair[1].1, one.second)
                    && (self.off(&one.found) > 0.0) != (self.off(&other.found) > 0.0)
                {
                    found.extend(self.between(*one, other));
                }
            }
        }
        found
    }

    /// Adds rows at the edges of existence and where the required quantity is almost met.
    fn refine(&self, rows: &mut Vec<(f64, Vec<Point>)>) {
        let mut more = Vec::new();
        for pair in rows.windows(2) {
            let counts = [pair[0].1.len(), pair[1].1.len()];
            if counts[0] == counts[1] {
                continue;
            }
            let (mut a, mut b) = (pair[0].0, pair[1].0);
            for _ in 0..EDGE {
                let middle = 0.5 * (a + b);
                let points = self.points(middle);
                if points.len() == counts[0] {
                    a = middle;
                } else {
                    b = middle;
                }
                more.push((middle, points));
            }
        }
        for three in rows.windows(3) {
            let Some(middle) = three[1].1.first() else { continue };
            let [a, b] =
                [0, 2].map(|i| nearest(&three[i].1, middle.second).map(|point| self.off(&point.found)));
            let (Some(a), Some(b), off) = (a, b, self.off(&middle.found)) else { continue };
            let lowest = off.abs() < a.abs()
                && off.abs() < b.abs()
                && (a > 0.0) == (b > 0.0)
                && (a > 0.0) == (off > 0.0)
                && off.abs() < MISSED;
            if lowest {
                self.lowest([three[0].0, three[1].0, three[2].0], off.abs(), &mut more);
            }
        }
        rows.extend(more);
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    /// Minimises the distance from the required quantity between three rows.
    fn lowest(&self, [mut a, mut b, mut c]: [f64; 3], mut least: f64, more: &mut Vec<(f64, Vec<Point>)>) {
        for _ in 0..2 * EDGE {
            let left = b - a > c - b;
            let probe = if left { 0.5 * (a + b) } else { 0.5 * (b + c) };
            let points = self.points(probe);
            let off = points.iter().map(|point| self.off(&point.found).abs()).fold(f64::INFINITY, f64::min);
            more.push((probe, points));
            match (off < least, left) {
                (true, true) => (b, c, least) = (probe, b, off),
                (true, false) => (a, b, least) = (b, probe, off),
                (false, true) => a = probe,
                (false, false) => c = probe,
            }
        }
    }

    /// The equilibrium between two points on either side of the required quantity.
    fn between(&self, mut a: Point, mut b: Point) -> Option<Point> {
        for step in 0..ROOT {
            let offs = [self.off(&a.found), self.off(&b.found)];
            let part =
                if step % 3 == 2 { 0.5 } else { (offs[0] / (offs[0] - offs[1])).clamp(1e-3, 1.0 - 1e-3) };
            let first = a.first + part * (b.first - a.first);
            if first <= a.first.min(b.first) || first >= a.first.max(b.first) {
                break;
            }
            let Some(middle) = nearest(
                &self.points_near(first, a.second, b.second),
                a.second + part * (b.second - a.second),
            ) else {
                break;
            };
            let off = self.off(&middle.found);
            if (off > 0.0) == (offs[0] > 0.0) {
                a = middle;
            } else {
                b = middle;
            }
            if off.abs() < 1e-13 {
                break;
            }
        }
        let best = if self.off(&a.found).abs() < self.off(&b.found).abs() { a } else { b };
        (self.off(&best.found).abs() < ASKED).then_some(best)
    }

    /// Like [`Way::points`], but searches near the second parameters of two neighbours first.
    fn points_near(&self, first: f64, a: f64, b: f64) -> Vec<Point> {
        let room = (b - a).abs() + 1e-9;
        let ends = [a.min(b) - room, a.max(b) + room];
        if let (Some(low), Some(high)) = (self.at(first, ends[0]), self.at(first, ends[1]))
            && (low.excess > 0.0) != (high.excess > 0.0)
            && let Some(point) = self.length(first, ends, low.excess > 0.0)
        {
            return vec![point];
        }
        self.points(first)
    }
}

fn nearest(points: &[Point], second: f64) -> Option<Point> {
    points.iter().copied().min_by(|a, b| (a.second - second).abs().total_cmp(&(b.second - second).abs()))
}

/// A cylinder whose fibres have the meridional stretch `sigma`, with a tension that exceeds the one needed
/// for this stretch by exp(`second`). Its excess is that of the pressure over the hoop term instead of that
/// of a length.
fn cylinder(net: &Net, sigma: f64, second: f64) -> Option<Meridian> {
    let (radius, tension) = net.of_sigma(sigma, second.exp())?;
    let local = net.local(radius, tension, net.is_taut(radius))?;
    let (area, area_r) = (net.area(radius), net.area_r(radius));
    Some(Meridian {
        excess: (area_r - local.hoop) / area_r,
        half_length: net.half * sigma,
        half_volume: net.half * sigma * net.volume_area(radius),
        force: local.force - area,
        area,
        least_tension: tension,
    })
}
