//! Rotated and mirrored copies of a drawing, merged at their seams.

use super::drawing::{Drawing, SAME_PLACE, Shape, size};
use super::map::{Map, Vector, dot, minus};
use crate::VtkError;
use std::collections::{HashMap, HashSet};

/// Most points of a file, which then takes some 500 MB.
const MOST_POINTS: u32 = 5_000_000;

/// How a part is copied: mirrored at the plane of its lobe, rotated, and mirrored at its middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Maps {
    pub(super) turns: u32,
    pub(super) mirror: Option<Vector>,
    pub(super) middle: Option<f64>,
}

impl Maps {
    /// All maps, each with whether it mirrors at the middle.
    fn all(&self) -> Vec<(Map, bool)> {
        let halves = [Some(Map::SAME), self.mirror.map(Map::mirror)];
        let turns = (0..self.turns).map(|k| Map::turn(f64::from(k) / f64::from(self.turns)));
        let round: Vec<Map> =
            turns.flat_map(|turn| halves.into_iter().flatten().map(move |half| turn.after(&half))).collect();
        let swapped = self.middle.map(|_| round.iter().map(|map| (Map::ENDS_SWAPPED.after(map), true)));
        round.iter().map(|map| (*map, false)).chain(swapped.into_iter().flatten()).collect()
    }
}

/// Checks that a file may hold so many points.
pub(super) fn check_count(points: usize, copies: usize) -> Result<(), VtkError> {
    let all = points.checked_mul(copies).and_then(|all| u32::try_from(all).ok());
    match all {
        Some(all) if all <= MOST_POINTS => Ok(()),
        _ => Err(VtkError::TooManyPoints { copies, points, most: MOST_POINTS }),
    }
}

/// The copies of a drawing, one after another.
///
/// Only points on free edges are merged. If a mirror plane completes the lobe, a point is merged only with
/// images of the same node. So two layers of cloth that lie on each other, such as those of an empty airbag,
/// stay separate.
pub(super) fn copied(part: &Drawing, maps: &Maps) -> Result<Drawing, VtkError> {
    // Checked before the maps are created, since their number may be far too large.
    let halves = 1 + usize::from(maps.mirror.is_some());
    let ends = 1 + usize::from(maps.middle.is_some());
    check_count(part.points.len(), (maps.turns as usize).saturating_mul(halves * ends))?;
    let all = maps.all();
    let is_seam = free(part);
    let close = SAME_PLACE * size(&part.points);
    let mut seams = Seams { close, is_cyclic: maps.mirror.is_none(), places: HashMap::new() };
    let mut whole = Drawing::default();
    let mut lines = HashSet::new();
    for (copy, (map, is_swapped)) in all.iter().enumerate() {
        let shift = if *is_swapped { 2.0 * maps.middle.unwrap_or_default() } else { 0.0 };
        let mut numbers = Vec::with_capacity(part.points.len());
        for (node, (point, displacement)) in part.points.iter().zip(&part.displacements).enumerate() {
            let [x, y, z] = map.of(*point);
            let image = Image { place: [x, y, z + shift], node, copy, number: whole.points.len() };
            if let Some(number) = is_seam[node].then(|| seams.find_or_add(image)).flatten() {
                numbers.push(number);
                continue;
            }
            numbers.push(image.number);
            whole.points.push(image.place);
            whole.displacements.push(map.of(*displacement));
        }
        let first = whole.maps.len();
        whole.maps.extend(part.maps.iter().map(|own| map.after(own)));
        for cell in &part.cells {
            let mut image = cell.renumbered(|node| numbers[node]);
            image.map += first;
            if matches!(cell.shape, Shape::Vertex | Shape::Line | Shape::QuadraticLine) {
                // The copies of a cable in a seam coincide: it is drawn once.
                let mut nodes = image.nodes().to_vec();
                nodes.sort_unstable();
                if !lines.insert((cell.group, cell.element, nodes)) {
                    continue;
                }
            }
            whole.cells.push(if map.is_mirror() { image.turned_over() } else { image });
        }
    }
    Ok(whole)
}

/// Whether each point lies on a free edge of the surfaces, or on no surface.
fn free(part: &Drawing) -> Vec<bool> {
    // Neighbours run through a common edge in opposite directions, so their contributions cancel.
    let mut edges: HashMap<(usize, usize), (i32, Option<usize>)> = HashMap::new();
    let mut is_free = vec![true; part.points.len()];
    for cell in &part.cells {
        let nodes = cell.nodes();
        if !cell.shape.edges().is_empty() {
            for node in nodes {
                is_free[*node] = false;
            }
        }
        for edge in cell.shape.edges() {
            let (a, b) = (nodes[edge[0]], nodes[edge[1]]);
            let (sum, middle) = edges.entry((a.min(b), a.max(b))).or_default();
            *sum += if a < b { 1 } else { -1 };
            *middle = edge.get(2).map(|place| nodes[*place]);
        }
    }
    for ((a, b), (sum, middle)) in edges {
        if sum != 0 {
            for node in [Some(a), Some(b), middle].into_iter().flatten() {
                is_free[node] = true;
            }
        }
    }
    is_free
}

/// A point of a copy.
#[derive(Debug, Clone, Copy)]
struct Image {
    place: Vector,
    node: usize,
    copy: usize,
    /// Number of the point it is merged with, or of the new point.
    number: usize,
}

/// Points on seams, hashed by position into cubes as wide as the distance below which two points are merged.
struct Seams {
    close: f64,
    /// Whether a seam joins two different edges of the part, rather than an edge with its own image.
    is_cyclic: bool,
    places: HashMap<[i64; 3], Vec<Image>>,
}

impl Seams {
    /// The number of a point at the same position. If there is none, `None`, and the point is stored.
    fn find_or_add(&mut self, image: Image) -> Option<usize> {
        // A cloth in one point has size 0; narrower cubes would need more than 2^63 of them.
        #[expect(clippy::cast_possible_truncation, reason = "saturates, and then only compares more places")]
        let cube = image.place.map(|x| (x / self.close.max(f64::MIN_POSITIVE)).floor() as i64);
        let mut found: Option<Image> = None;
        for i in 0..27_i64 {
            let next = [cube[0], cube[1], cube[2]];
            let step = [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1];
            let key = [0, 1, 2].map(|k| next[k].saturating_add(step[k]));
            for other in self.places.get(&key).into_iter().flatten() {
                let apart = minus(other.place, image.place);
                let is_same = other.node == image.node;
                let is_candidate = other.copy != image.copy && (is_same || self.is_cyclic);
                if is_candidate && dot(apart, apart).sqrt() <= self.close {
                    // An image of the same node takes precedence over another node: the edges of a slit stay
                    // separate.
                    if is_same || found.is_none() {
                        found = Some(*other);
                    }
                }
            }
        }
        let number = found.map(|other| other.number);
        // A match with another node is stored under this node as well, since a third copy may meet either.
        if found.is_none_or(|other| other.node != image.node) {
            let image = Image { number: number.unwrap_or(image.number), ..image };
            self.places.entry(cube).or_default().push(image);
        }
        number
    }
}
