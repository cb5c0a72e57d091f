//! Small cases, solved, and files read back and measured.

use bulge_membrane::case::Case;
use bulge_membrane::{Fields, State};
use std::collections::HashMap;
use std::fs;
use std::path::Path;

use crate::read;

pub(crate) type Point = [f64; 3];

pub(crate) const TUBE: &str = r#"
name = "a tube of rubber and a net"
[mesher]
kind = "tube"
radius = "10 mm"
length = "60 mm"
cells = [24]
order = 1
[[material]]
name = "rubber"
law = "neo-hooke"
thickness = "1 mm"
shear = "0.4 MPa"
[[part]]
group = "wall"
kind = "sheet"
material = "rubber"
[[part]]
group = "wall"
kind = "sheet"
material = "rubber"
[[part]]
group = "wall"
kind = "threads"
fibres = 40
angle = "25 deg"
stiffness = "1 kN"
[[step]]
pressure = "30 kPa"
places = { top = "-2 mm" }
"#;

pub(crate) const SPHERE: &str = r#"
name = "a ball"
[mesher]
kind = "sphere"
radius = "10 mm"
cells = [16]
order = 2
[[material]]
name = "rubber"
law = "neo-hooke"
thickness = "1 mm"
shear = "0.4 MPa"
[[part]]
group = "wall"
kind = "sheet"
material = "rubber"
[[step]]
pressure = "20 kPa"
"#;

pub(crate) const PLEATED: &str = r#"
name = "a pleated muscle"
[mesher]
kind = "pleated"
radius = "16 mm"
length = "110 mm"
fibres = 8
circumference = "288 mm"
cells = [6, 20]
order = 1
[[material]]
name = "cloth"
law = "st-venant"
thickness = "0.1 mm"
young = "0.5 GPa"
poisson = 0.3
[[part]]
group = "cloth"
kind = "membrane"
material = "cloth"
warp = [0, 1, 0]
[[part]]
group = "fibre"
kind = "cable"
stiffness = "1500 kN"
share = 0.5
[[step]]
pressure = "300 kPa"
contraction = "10 %"
"#;

pub(crate) const AIRBAG: &str = r#"
name = "a square airbag"
[mesher]
kind = "square"
side = "800 mm"
cells = [8, 8]
order = 2
[[material]]
name = "cloth"
law = "st-venant"
thickness = "0.6 mm"
young = "588 MPa"
poisson = 0.4
[[part]]
group = "cloth"
kind = "membrane"
material = "cloth"
warp = [1, 0, 0]
[[step]]
pressure = "5 kPa"
"#;

pub(crate) fn solved(toml: &str) -> (Case, State, Fields) {
    let case = Case::from_toml(toml, "case.toml", None).unwrap_or_else(|error| panic!("{error}"));
    let mut run = case.start().unwrap();
    run.last_row(|_| ()).unwrap();
    let (state, fields) = run.last();
    let state = state.clone();
    (case, state, fields)
}

/// A file read back.
pub(crate) struct Read {
    pub(crate) xml: String,
    pub(crate) points: Vec<Point>,
    pub(crate) cells: Vec<Vec<usize>>,
    pub(crate) types: Vec<CellType>,
    pub(crate) point_data: HashMap<String, Vec<f64>>,
    pub(crate) cell_data: HashMap<String, Vec<f64>>,
}

/// VTK's types of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CellType {
    Vertex = 1,
    Line = 3,
    Triangle = 5,
    Quad = 9,
    QuadraticEdge = 21,
    QuadraticTriangle = 22,
}

impl CellType {
    fn of(code: f64) -> Self {
        let all = [
            Self::Vertex,
            Self::Line,
            Self::Triangle,
            Self::Quad,
            Self::QuadraticEdge,
            Self::QuadraticTriangle,
        ];
        all.into_iter()
            .find(|own| f64::from(*own as u8) == code)
            .unwrap_or_else(|| panic!("a cell of {code}"))
    }
}

impl Read {
    pub(crate) fn of(path: &Path) -> Self {
        let xml = fs::read_to_string(path).unwrap();
        let mut arrays = read::arrays(&xml);
        let mut take =
            |element: &str, name: &str| arrays.remove(&(element.to_owned(), name.to_owned())).unwrap();
        let points = take("Points", "Points");
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "numbers of points, written as whole numbers"
        )]
        let whole = |numbers: Vec<f64>| numbers.into_iter().map(|number| number as usize).collect::<Vec<_>>();
        let (connectivity, offsets) = (whole(take("Cells", "connectivity")), whole(take("Cells", "offsets")));
        let types = take("Cells", "types").into_iter().map(CellType::of).collect();
        let data = |element: &str| {
            let own = arrays.iter().filter(|((of, _), _)| of == element);
            own.map(|((_, name), values)| (name.clone(), values.clone())).collect()
        };
        let mut start = 0;
        let cells = offsets
            .iter()
            .map(|end| {
                let nodes = connectivity[start..*end].to_vec();
                start = *end;
                nodes
            })
            .collect();
        let read = Self {
            points: points.as_chunks::<3>().0.to_vec(),
            cells,
            types,
            point_data: data("PointData"),
            cell_data: data("CellData"),
            xml,
        };
        for (name, values) in read.cell_data.iter().chain(&read.point_data) {
            assert!(values.iter().all(|value| value.is_finite()), "{name}");
        }
        for (name, values) in &read.cell_data {
            let each = if name.starts_with("direction_1") { 3 } else { 1 };
            assert_eq!(values.len(), each * read.cells.len(), "{name}");
        }
        assert_eq!(read.point_data["displacement_m"].len(), 3 * read.points.len());
        read
    }

    pub(crate) fn field(&self, name: &str) -> f64 {
        let (_, rest) = self.xml.split_once(&format!("Name=\"{name}\"")).unwrap();
        let (_, rest) = rest.split_once('>').unwrap();
        rest.split_once('<').unwrap().0.parse().unwrap()
    }

    pub(crate) fn vector(&self, name: &str, at: usize) -> Point {
        let values = self.cell_data.get(name).unwrap_or_else(|| &self.point_data[name]);
        values.as_chunks::<3>().0[at]
    }

    pub(crate) fn count(&self, wanted: CellType) -> usize {
        self.types.iter().filter(|own| **own == wanted).count()
    }

    /// Plane triangles of a surface cell; a quadratic one is divided into 4 N^2 by its shape functions.
    pub(crate) fn triangles(&self, cell: usize) -> Vec<[Point; 3]> {
        let x: Vec<Point> = self.cells[cell].iter().map(|node| self.points[*node]).collect();
        match self.types[cell] {
            CellType::Triangle => vec![[x[0], x[1], x[2]]],
            CellType::Quad => vec![[x[0], x[1], x[2]], [x[0], x[2], x[3]]],
            CellType::QuadraticTriangle => {
                let n = 12;
                let at = |i: usize, j: usize| {
                    let (s, t) = (i as f64 / n as f64, j as f64 / n as f64);
                    let l = [1.0 - s - t, s, t];
                    std::array::from_fn(|k| {
                        (0..3)
                            .map(|a| {
                                let corner = l[a] * (2.0 * l[a] - 1.0) * x[a][k];
                                corner + 4.0 * l[a] * l[(a + 1) % 3] * x[3 + a][k]
                            })
                            .sum()
                    })
                };
                let mut all = Vec::new();
                for i in 0..n {
                    for j in 0..n - i {
                        all.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                        if i + j + 1 < n {
                            all.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                        }
                    }
                }
                all
            }
            _ => Vec::new(),
        }
    }

    pub(crate) fn area(&self) -> f64 {
        let all = (0..self.cells.len()).flat_map(|cell| self.triangles(cell));
        all.map(|t| normal(t).iter().map(|n| n * n).sum::<f64>().sqrt()).sum()
    }

    /// Volume as the flux of (x, y, 0)/2, to which ends across the z axis contribute nothing; positive if the
    /// normals point outward.
    pub(crate) fn volume(&self) -> f64 {
        let flow = |t: [Point; 3]| {
            let (n, third) = (normal(t), 1.0 / 3.0);
            let middle = [0, 1].map(|k| third * (t[0][k] + t[1][k] + t[2][k]));
            0.5 * (n[0] * middle[0] + n[1] * middle[1])
        };
        (0..self.cells.len()).flat_map(|cell| self.triangles(cell)).map(flow).sum()
    }

    /// Edges of surface cells that don't cancel with an edge of a neighbour.
    pub(crate) fn open_edges(&self) -> Vec<(usize, usize)> {
        let mut edges: HashMap<(usize, usize), i32> = HashMap::new();
        for (cell, kind) in self.cells.iter().zip(&self.types) {
            let corners = match kind {
                CellType::Triangle | CellType::QuadraticTriangle => 3,
                CellType::Quad => 4,
                _ => 0,
            };
            for i in 0..corners {
                let (a, b) = (cell[i], cell[(i + 1) % corners]);
                *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        }
        edges.into_iter().filter(|(_, sum)| *sum != 0).map(|(edge, _)| edge).collect()
    }
}

/// Half the cross product of two sides.
fn normal([a, b, c]: [Point; 3]) -> Point {
    let (e, f) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
    [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]].map(|x| 0.5 * x)
}
