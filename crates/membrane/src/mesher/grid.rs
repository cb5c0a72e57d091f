//! Meshes any surface over the unit square with triangles.

use crate::mesh::{Block, CellKind, Mesh};

/// A surface over (u, v), each from 0 to 1.
pub struct Surface<'a> {
    /// Initial position.
    pub place: &'a dyn Fn(f64, f64) -> [f64; 3],
    /// Position in the flat stress-free pattern; `None`: the initial positions are stress-free.
    pub pattern: Option<&'a dyn Fn(f64, f64) -> [f64; 2]>,
    /// Cells along u and v.
    pub cells: [usize; 2],
    /// Whether triangles have six nodes.
    pub is_quadratic: bool,
}

/// Two triangles per cell, with alternating diagonals; the normal is that of u x v.
///
/// Groups: `cloth`, the triangles; `u0`, `u1`, `v0`, `v1`, the lines of the four edges.
#[must_use]
pub fn grid(surface: &Surface<'_>) -> Mesh {
    let [nu, nv] = surface.cells;
    let each = if surface.is_quadratic { 2 } else { 1 };
    let (columns, rows) = (each * nu + 1, each * nv + 1);
    let at = |i: usize, j: usize| [i as f64 / (each * nu) as f64, j as f64 / (each * nv) as f64];
    let number = |i: usize, j: usize| j * columns + i;
    let mut mesh = Mesh::default();
    for j in 0..rows {
        for i in 0..columns {
            let [u, v] = at(i, j);
            mesh.nodes.push((surface.place)(u, v));
            mesh.numbers.push(mesh.nodes.len() as u64);
        }
    }
    let mut triangles = Vec::new();
    for j in 0..nv {
        for i in 0..nu {
            let [a, b, c, d] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            let halves = if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            for half in halves {
                // Corners, then the middles of the edges 1-2, 2-3, 3-1.
                triangles.extend(half.map(|[i, j]| [each * i, each * j]));
                if surface.is_quadratic {
                    triangles.extend((0..3).map(|k| {
                        let ([i, j], [l, m]) = (half[k], half[(k + 1) % 3]);
                        [i + l, j + m]
                    }));
                }
            }
        }
    }
    let edge = |to: &dyn Fn(usize) -> [usize; 2], cells: usize| -> Vec<[usize; 2]> {
        let mut line = Vec::new();
        for k in 0..cells {
            line.extend([to(each * k), to(each * k + each)]);
            if surface.is_quadratic {
                line.push(to(2 * k + 1));
            }
        }
        line
    };
    let kinds = if surface.is_quadratic {
        (CellKind::Triangle6, CellKind::Line3)
    } else {
        (CellKind::Triangle3, CellKind::Line2)
    };
    let parts = [
        ("cloth", kinds.0, triangles),
        ("u0", kinds.1, edge(&|k| [0, k], nv)),
        ("u1", kinds.1, edge(&|k| [columns - 1, k], nv)),
        ("v0", kinds.1, edge(&|k| [k, 0], nu)),
        ("v1", kinds.1, edge(&|k| [k, rows - 1], nu)),
    ];
    let mut count = 0;
    for (group, kind, places) in parts {
        let cells: Vec<usize> = places.iter().map(|[i, j]| number(*i, *j)).collect();
        let pattern = surface.pattern.map(|pattern| {
            places
                .iter()
                .map(|[i, j]| {
                    let [u, v] = at(*i, *j);
                    pattern(u, v)
                })
                .collect()
        });
        let many = (cells.len() / kind.nodes()) as u64;
        mesh.blocks.push(Block {
            group: group.to_owned(),
            kind,
            cells,
            numbers: (count + 1..=count + many).collect(),
            pattern,
        });
        count += many;
    }
    mesh
}
