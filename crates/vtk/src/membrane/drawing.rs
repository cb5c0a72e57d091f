//! Points and cells as they are drawn, each cell with the element it shows.

use super::map::{Map, Vector, minus, unit};
use super::{MembranePicture, Whole, copies};
use crate::VtkError;
use bulge_membrane::{CellKind, Fields, GroupFields};

/// Shape of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Vertex,
    Line,
    QuadraticLine,
    Triangle,
    QuadraticTriangle,
    Quadrangle,
}

impl Shape {
    pub(super) fn nodes(self) -> usize {
        match self {
            Self::Vertex => 1,
            Self::Line => 2,
            Self::QuadraticLine | Self::Triangle => 3,
            Self::Quadrangle => 4,
            Self::QuadraticTriangle => 6,
        }
    }

    /// Edges as indices into the nodes: both ends, and the middle of a quadratic edge. Lines have none.
    pub(super) fn edges(self) -> &'static [&'static [usize]] {
        match self {
            Self::Vertex | Self::Line | Self::QuadraticLine => &[],
            Self::Triangle => &[&[0, 1], &[1, 2], &[2, 0]],
            Self::QuadraticTriangle => &[&[0, 1, 3], &[1, 2, 4], &[2, 0, 5]],
            Self::Quadrangle => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
        }
    }

    /// The order of the nodes that reverses the normal.
    pub(super) fn turned_over(self) -> &'static [usize] {
        match self {
            // The first node of a surface cell stays first; a line keeps its nodes, so that a direction along
            // it keeps its sense.
            Self::Vertex => &[0],
            Self::Line => &[0, 1],
            Self::QuadraticLine => &[0, 1, 2],
            Self::Triangle => &[0, 2, 1],
            Self::QuadraticTriangle => &[0, 2, 1, 5, 4, 3],
            Self::Quadrangle => &[0, 3, 2, 1],
        }
    }
}

impl From<CellKind> for Shape {
    fn from(kind: CellKind) -> Self {
        match kind {
            CellKind::Point => Self::Vertex,
            CellKind::Line2 => Self::Line,
            CellKind::Line3 => Self::QuadraticLine,
            CellKind::Triangle3 => Self::Triangle,
            CellKind::Triangle6 => Self::QuadraticTriangle,
        }
    }
}

/// A cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cell {
    pub(super) shape: Shape,
    nodes: [usize; 6],
    /// The element: index of its group in the fields, and number in the group.
    pub(super) group: usize,
    pub(super) element: usize,
    /// Unit vector along the meridian of a membrane of revolution, as meshed; zero for other cells.
    pub(super) meridian: Vector,
    /// Index of the map from the mesh to this cell.
    pub(super) map: usize,
}

impl Cell {
    pub(super) fn nodes(&self) -> &[usize] {
        &self.nodes[..self.shape.nodes()]
    }

    /// The cell with new numbers of its nodes.
    pub(super) fn renumbered(mut self, number: impl Fn(usize) -> usize) -> Self {
        for node in &mut self.nodes[..self.shape.nodes()] {
            *node = number(*node);
        }
        self
    }

    /// The cell with its normal reversed.
    pub(super) fn turned_over(mut self) -> Self {
        let before = self.nodes;
        for (node, from) in self.nodes.iter_mut().zip(self.shape.turned_over()) {
            *node = before[*from];
        }
        self
    }
}

/// The content of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Drawing {
    pub(super) points: Vec<Vector>,
    pub(super) displacements: Vec<Vector>,
    pub(super) cells: Vec<Cell>,
    /// The maps that carry vectors from the mesh to the cells.
    pub(super) maps: Vec<Map>,
}

impl Drawing {
    /// Drawing of a picture that has passed its check.
    pub(super) fn new(picture: &MembranePicture) -> Result<Self, VtkError> {
        let fields = picture.fields;
        match picture.whole {
            Whole::AsMeshed => Ok(as_meshed(fields)),
            Whole::Revolved { facets, middle } => {
                let revolved = revolved(fields, facets)?;
                match middle {
                    None => Ok(revolved),
                    Some(z) => {
                        copies::copied(&revolved, &copies::Maps { turns: 1, mirror: None, middle: Some(z) })
                    }
                }
            }
            Whole::Sector { lobes, mirror, middle } => {
                let sector = used(as_meshed(fields));
                copies::copied(&sector, &copies::Maps { turns: lobes, mirror, middle })
            }
        }
    }
}

/// Size of the drawing: the diagonal of its bounding box.
pub(super) fn size(points: &[Vector]) -> f64 {
    let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for point in points {
        for (range, x) in range.iter_mut().zip(point) {
            *range = [range[0].min(*x), range[1].max(*x)];
        }
    }
    range.iter().map(|[low, high]| (high - low).powi(2)).sum::<f64>().sqrt()
}

/// Distance below which two points coincide, relative to the size.
pub(super) const SAME_PLACE: f64 = 1e-9;

/// The elements of a group with their nodes.
fn elements(group: &GroupFields) -> impl Iterator<Item = (usize, [usize; 6])> {
    group.cells.chunks_exact(group.kind.nodes()).enumerate().map(|(element, own)| {
        let mut nodes = [0; 6];
        for (node, own) in nodes.iter_mut().zip(own) {
            *node = *own as usize;
        }
        (element, nodes)
    })
}

/// The cells and nodes of the mesh, with the numbers of the mesh.
fn as_meshed(fields: &Fields) -> Drawing {
    let mut cells = Vec::new();
    for (index, group) in fields.groups.iter().enumerate() {
        cells.extend(elements(group).map(|(element, nodes)| meshed(fields, index, element, nodes)));
    }
    Drawing {
        points: fields.places.clone(),
        displacements: fields.displacements.clone(),
        cells,
        maps: vec![Map::SAME],
    }
}

/// An element drawn as one cell.
fn meshed(fields: &Fields, index: usize, element: usize, nodes: [usize; 6]) -> Cell {
    let group = &fields.groups[index];
    let meridian = if group.is_revolved { along(fields, nodes[0], nodes[1]) } else { [0.0; 3] };
    Cell { shape: group.kind.into(), nodes, group: index, element, meridian, map: 0 }
}

fn along(fields: &Fields, from: usize, to: usize) -> Vector {
    unit(minus(fields.places[to], fields.places[from]))
}

/// The drawing without the points that no cell uses.
fn used(drawing: Drawing) -> Drawing {
    let mut is_used = vec![false; drawing.points.len()];
    for node in drawing.cells.iter().flat_map(Cell::nodes) {
        is_used[*node] = true;
    }
    let mut count = 0;
    let numbers: Vec<usize> = is_used
        .iter()
        .map(|is_used| {
            count += usize::from(*is_used);
            count.saturating_sub(1)
        })
        .collect();
    let kept = |vectors: &[Vector]| -> Vec<Vector> {
        vectors.iter().zip(&is_used).filter(|(_, is_used)| **is_used).map(|(v, _)| *v).collect()
    };
    Drawing {
        points: kept(&drawing.points),
        displacements: kept(&drawing.displacements),
        cells: drawing.cells.into_iter().map(|cell| cell.renumbered(|node| numbers[node])).collect(),
        maps: drawing.maps,
    }
}

/// Index of the first point of a node of the mesh, and the number of its points.
#[derive(Debug, Clone, Copy)]
struct Ring {
    first: usize,
    points: usize,
}

impl Ring {
    fn point(self, facet: usize) -> usize {
        self.first + facet % self.points
    }
}

/// Membranes of revolution as facets, ordered by group, element and angle; other cells as meshed.
fn revolved(fields: &Fields, facets: u32) -> Result<Drawing, VtkError> {
    let count = facets as usize;
    copies::check_count(fields.places.len(), count)?;
    let turns: Vec<Map> = (0..facets).map(|j| Map::turn(f64::from(j) / f64::from(facets))).collect();
    let mut drawing = Drawing {
        // Maps to the middle of each facet; the last one is for cells that aren't revolved.
        maps: (0..facets)
            .map(|j| Map::turn((f64::from(j) + 0.5) / f64::from(facets)))
            .chain([Map::SAME])
            .collect(),
        ..Drawing::default()
    };
    let rings = rings(fields, &turns, &mut drawing);
    for (index, group) in fields.groups.iter().enumerate() {
        for (element, nodes) in elements(group) {
            if !group.is_revolved {
                let cell = meshed(fields, index, element, nodes).renumbered(|node| rings[node].first);
                drawing.cells.push(Cell { map: count, ..cell });
                continue;
            }
            let [a, b, middle, ..] = nodes;
            let pieces: &[[usize; 2]] =
                if group.kind == CellKind::Line3 { &[[a, middle], [middle, b]] } else { &[[a, b]] };
            for [a, b] in pieces {
                let meridian = along(fields, *a, *b);
                for j in 0..count {
                    let Some((shape, nodes)) = facet(rings[*a], rings[*b], j) else { continue };
                    drawing.cells.push(Cell { shape, nodes, group: index, element, meridian, map: j });
                }
            }
        }
    }
    Ok(drawing)
}

/// The points of each node: a circle, one point on the axis or off membranes of revolution, none if no cell
/// uses the node.
fn rings(fields: &Fields, turns: &[Map], drawing: &mut Drawing) -> Vec<Ring> {
    #[derive(Clone, Copy, PartialEq)]
    enum Use {
        No,
        AsMeshed,
        Revolved,
    }
    let mut uses = vec![Use::No; fields.places.len()];
    for group in &fields.groups {
        for node in &group.cells {
            let own = &mut uses[*node as usize];
            if group.is_revolved {
                *own = Use::Revolved;
            } else if *own == Use::No {
                *own = Use::AsMeshed;
            }
        }
    }
    let close = SAME_PLACE * size(&fields.places);
    uses.iter()
        .zip(fields.places.iter().zip(&fields.displacements))
        .map(|(used, (place, displacement))| {
            let is_circle = *used == Use::Revolved && place[0].hypot(place[1]) > close;
            let maps = match used {
                Use::No => &[],
                _ if is_circle => turns,
                _ => &turns[..1],
            };
            let ring = Ring { first: drawing.points.len(), points: maps.len().max(1) };
            drawing.points.extend(maps.iter().map(|map| map.of(*place)));
            drawing.displacements.extend(maps.iter().map(|map| map.of(*displacement)));
            ring
        })
        .collect()
}

/// The facet between two rings, with the normal outward if z grows from a to b; `None` between two points of
/// the axis.
fn facet(a: Ring, b: Ring, j: usize) -> Option<(Shape, [usize; 6])> {
    match (a.points > 1, b.points > 1) {
        (true, true) => {
            let nodes = [a.point(j), a.point(j + 1), b.point(j + 1), b.point(j), 0, 0];
            Some((Shape::Quadrangle, nodes))
        }
        (true, false) => Some((Shape::Triangle, [a.point(j), a.point(j + 1), b.first, 0, 0, 0])),
        (false, true) => Some((Shape::Triangle, [a.first, b.point(j + 1), b.point(j), 0, 0, 0])),
        (false, false) => None,
    }
}
