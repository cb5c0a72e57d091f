//! Meshes any meridian as a line in the half-plane y = 0.

use crate::mesh::{Block, CellKind, Mesh};

/// Distribution of the elements along a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Grading {
    /// Uniform.
    Even,
    /// Finer towards both ends: the first element is this many times shorter than in a uniform mesh.
    Ends(f64),
    /// Finer towards the end, in the same way.
    End(f64),
}

impl Grading {
    /// Maps \[0, 1\] to itself with a slope of 1/ratio at the fine ends.
    pub(crate) fn at(self, t: f64) -> f64 {
        match self {
            Self::Even => t,
            // A cubic with slope 1/ratio at both ends.
            Self::Ends(ratio) => {
                let slope = 1.0 / ratio;
                t * (slope + t * (3.0 * (1.0 - slope) - 2.0 * (1.0 - slope) * t))
            }
            Self::End(ratio) => {
                let slope = 1.0 / ratio;
                let back = 1.0 - t;
                1.0 - back * (slope + (1.0 - slope) * back)
            }
        }
    }
}

/// The line t -> (r, z), 0 <= t <= 1, in `elements` elements with two nodes, or three if `is_quadratic` (the
/// middle node is halfway between the ends in the parameter).
///
/// Groups: `wall`, the line; `first` and `last`, its end nodes. The volume is positive if z grows along the
/// line.
#[must_use]
pub fn revolved(
    line: impl Fn(f64) -> [f64; 2],
    elements: usize,
    is_quadratic: bool,
    grading: Grading,
) -> Mesh {
    let each = if is_quadratic { 2 } else { 1 };
    let nodes: Vec<[f64; 3]> = (0..=each * elements)
        .map(|i| {
            // Middle nodes are halfway between the ends in a graded line too.
            let end = |j: usize| grading.at(j as f64 / elements as f64);
            let t = if i % each == 0 { end(i / each) } else { 0.5 * (end(i / 2) + end(i / 2 + 1)) };
            let [r, z] = line(t);
            [r, 0.0, z]
        })
        .collect();
    let mut cells = Vec::with_capacity((each + 1) * elements);
    for e in 0..elements {
        cells.extend([each * e, each * e + each]);
        if is_quadratic {
            cells.push(2 * e + 1);
        }
    }
    let kind = if is_quadratic { CellKind::Line3 } else { CellKind::Line2 };
    let point = |group: &str, node: usize, number: usize| Block {
        group: group.to_owned(),
        kind: CellKind::Point,
        cells: vec![node],
        numbers: vec![number as u64],
        pattern: None,
    };
    let wall = Block {
        group: "wall".to_owned(),
        kind,
        cells,
        numbers: (1..=elements as u64).collect(),
        pattern: None,
    };
    let last = nodes.len() - 1;
    Mesh {
        numbers: (1..=nodes.len() as u64).collect(),
        nodes,
        blocks: vec![wall, point("first", 0, elements + 1), point("last", last, elements + 2)],
    }
}
