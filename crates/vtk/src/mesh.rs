//! Points, quadrangles, polylines and fields of a drawn shape.

use crate::bulge::{Bulge, Style};
use crate::panel::Panel;
use bulge_fibre::MeridianPoint;
use std::f64::consts::TAU;

type Point = [f64; 3];

/// A field: its name, which ends in the unit, and one value per point or cell.
type Field = (&'static str, Vec<f64>);

/// Value of the array `part` for the cloth.
const CLOTH: i32 = 0;
/// Value of the array `part` for a fibre.
const FIBRE: i32 = 1;

/// The content of a file: a drawn shape as points and cells \[SI\]. Points: the rings of cloth one after the
/// other, then the fibres one after the other. Cells: the fibres, then the quadrangles ring by ring (VTK
/// counts the lines of a `PolyData` before its polygons).
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Points \[m\], with x along the axis.
    pub points: Vec<Point>,
    /// Vertices of the quadrangles, counter-clockwise seen from outside.
    pub quads: Vec<[usize; 4]>,
    /// Vertices of every fibre from left to right.
    pub fibres: Vec<Vec<usize>>,
    /// Fields with one value per point; the unit ends the name.
    pub point_fields: Vec<Field>,
    /// Fields with one value per cell: first the fibres, then the quadrangles.
    pub cell_fields: Vec<Field>,
    /// 0 for cloth, 1 for a fibre, one per cell.
    pub part: Vec<i32>,
}

impl Mesh {
    /// Mesh of a bulge that has passed its check.
    pub(crate) fn new(bulge: &Bulge) -> Self {
        let meridian = &bulge.shape.meridian;
        let (stations, columns) = (meridian.len(), bulge.columns());
        let mut points = cloth(bulge);
        let quads = quads(stations, columns);
        let paths = fibre_paths(bulge);
        let fibres = paths.iter().enumerate().map(|(i, path)| {
            let first = points.len() + i * path.len();
            (first..first + path.len()).collect()
        });
        let fibres: Vec<Vec<usize>> = fibres.collect();
        points.extend(paths.into_iter().flatten());

        let point_fields = point_fields(meridian, &points, columns, fibres.len());
        let areas = quads.iter().map(|quad| area(quad.map(|p| points[p])));
        let cell_fields = vec![
            ("area_m2", std::iter::repeat_n(0.0, fibres.len()).chain(areas).collect()),
            ("membrane_force_N_per_m", cell_forces(meridian, columns, fibres.len())),
        ];
        let part = std::iter::repeat_n(FIBRE, fibres.len()).chain(std::iter::repeat_n(CLOTH, quads.len()));
        Self { part: part.collect(), points, quads, fibres, point_fields, cell_fields }
    }
}

/// Rings of cloth, station by station.
fn cloth(bulge: &Bulge) -> Vec<Point> {
    let meridian = &bulge.shape.meridian;
    match bulge.style {
        Style::Revolution => meridian.iter().flat_map(|p| circle(p, bulge.facets)).collect(),
        Style::Pleats { cloth_circumference } => {
            let width = bulge.cloth_width(cloth_circumference);
            meridian.iter().flat_map(|p| pleated_ring(p, bulge.fibres, width, bulge.facets)).collect()
        }
    }
}

/// Point at the angle `theta` about the axis: y points to theta = 0, z to theta = pi/2.
fn at(x: f64, radius: f64, theta: f64) -> Point {
    [x, radius * theta.cos(), radius * theta.sin()]
}

fn circle(p: &MeridianPoint, facets: u32) -> impl Iterator<Item = Point> {
    let (x, r) = (p.x_m, p.r_m);
    (0..facets).map(move |j| at(x, r, TAU * f64::from(j) / f64::from(facets)))
}

/// One ring of n panels. The last point of a panel is the first one of the next, so the ring closes.
fn pleated_ring(p: &MeridianPoint, n: u32, width: f64, facets: u32) -> impl Iterator<Item = Point> {
    let (x, r) = (p.x_m, p.r_m);
    let half_angle = TAU / f64::from(2 * n);
    let panel = Panel::new(r * half_angle.sin(), width);
    let apothem = r * half_angle.cos();
    (0..n).flat_map(move |k| {
        let (sin, cos) = (f64::from(2 * k + 1) * half_angle).sin_cos();
        (0..facets).map(move |j| {
            let [along, height] = panel.point(f64::from(j) / f64::from(facets));
            let out = apothem + height;
            [x, out * cos - along * sin, out * sin + along * cos]
        })
    })
}

/// Quadrangles between neighbouring rings, with outward normals.
fn quads(stations: usize, columns: usize) -> Vec<[usize; 4]> {
    let vertex = |i: usize, j: usize| i * columns + j % columns;
    (1..stations)
        .flat_map(|i| {
            (0..columns)
                .map(move |j| [vertex(i - 1, j), vertex(i - 1, j + 1), vertex(i, j + 1), vertex(i, j)])
        })
        .collect()
}

/// The paths of the fibres: straight ones evenly spaced about the axis, turning ones in two opposite
/// families.
fn fibre_paths(bulge: &Bulge) -> Vec<Vec<Point>> {
    let path = |start: f64, sense: f64| {
        bulge.shape.meridian.iter().map(|p| at(p.x_m, p.r_m, start + sense * p.turn_rad)).collect()
    };
    let family = |n: u32, sense: f64| (0..n).map(move |k| path(TAU * f64::from(k) / f64::from(n), sense));
    if bulge.is_braided() {
        let left = bulge.fibres / 2;
        family(bulge.fibres - left, 1.0).chain(family(left, -1.0)).collect()
    } else {
        family(bulge.fibres, 1.0).collect()
    }
}

/// Fields of the points: the fields of the meridian, constant around every ring, and the distance of each
/// point from the axis.
fn point_fields(meridian: &[MeridianPoint], points: &[Point], columns: usize, fibres: usize) -> Vec<Field> {
    type Reader = fn(&MeridianPoint) -> f64;
    let readers: [(&'static str, Reader); 6] = [
        ("membrane_force_N_per_m", |p| p.membrane_force_n_per_m),
        ("radius_m", |p| p.r_m),
        ("slope_rad", |p| p.slope_rad),
        ("braid_angle_rad", |p| p.braid_angle_rad),
        ("fibre_tension_N", |p| p.fibre_tension_n),
        ("fibre_strain", |p| p.fibre_strain),
    ];
    let mut fields: Vec<Field> = readers
        .into_iter()
        .map(|(name, read)| {
            let rings = meridian.iter().flat_map(|p| std::iter::repeat_n(read(p), columns));
            let along = std::iter::repeat_n(meridian, fibres).flatten().map(read);
            (name, rings.chain(along).collect())
        })
        .collect();
    fields.push(("cloth_radius_m", points.iter().map(|[_, y, z]| y.hypot(*z)).collect()));
    fields
}

/// Area of a quadrangle: half the cross product of its diagonals, exact if it is plane.
fn area([a, b, c, d]: [Point; 4]) -> f64 {
    let minus = |p: Point, q: Point| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let (e, f) = (minus(c, a), minus(d, b));
    let normal = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    0.5 * normal.iter().map(|n| n * n).sum::<f64>().sqrt()
}

/// Membrane force of the cells: the mean along a fibre, and the mean of the two rings for the cloth.
fn cell_forces(meridian: &[MeridianPoint], columns: usize, fibres: usize) -> Vec<f64> {
    let pairs = || meridian.windows(2).map(|p| (&p[0], &p[1]));
    let middle =
        |a: &MeridianPoint, b: &MeridianPoint| 0.5 * (a.membrane_force_n_per_m + b.membrane_force_n_per_m);
    let chord = |a: &MeridianPoint, b: &MeridianPoint| (b.x_m - a.x_m).hypot(b.r_m - a.r_m);
    let length: f64 = pairs().map(|(a, b)| chord(a, b)).sum();
    let mean = if length > 0.0 {
        pairs().map(|(a, b)| middle(a, b) * chord(a, b)).sum::<f64>() / length
    } else {
        meridian.first().map_or(0.0, |p| p.membrane_force_n_per_m)
    };
    let rings = pairs().flat_map(|(a, b)| std::iter::repeat_n(middle(a, b), columns));
    std::iter::repeat_n(mean, fibres).chain(rings).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{barrel, cone, cylinder, sphere};
    use bulge_fibre::Shape;
    use std::collections::HashMap;
    use std::f64::consts::PI;

    fn revolution(shape: &Shape, facets: u32, fibres: u32) -> Mesh {
        let bulge = Bulge { shape, fibres, style: Style::Revolution, facets };
        bulge.check().unwrap();
        Mesh::new(&bulge)
    }

    fn pleated(shape: &Shape, cloth_circumference: Option<f64>) -> Mesh {
        let style = Style::Pleats { cloth_circumference };
        let bulge = Bulge { shape, fibres: 10, style, facets: 8 };
        bulge.check().unwrap();
        Mesh::new(&bulge)
    }

    fn cloth_area(mesh: &Mesh) -> f64 {
        mesh.cell_fields[0].1.iter().sum()
    }

    /// Volume inside the cloth with plane ends, by the divergence theorem; positive if the normals point outward.
    fn volume(mesh: &Mesh, rings: usize, columns: usize) -> f64 {
        let p = |v: usize| mesh.points[v];
        let triple = |[a, b, c]: [Point; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        let side: f64 = mesh
            .quads
            .iter()
            .map(|&[a, b, c, d]| triple([p(a), p(b), p(c)]) + triple([p(a), p(c), p(d)]))
            .sum();
        // The left end lies in x = 0 and contributes nothing.
        let last = &mesh.points[(rings - 1) * columns..rings * columns];
        let right: f64 = (0..columns)
            .map(|j| (last[j], last[(j + 1) % columns]))
            .map(|(a, b)| 0.5 * a[0] * (a[1] * b[2] - a[2] * b[1]))
            .sum();
        side / 6.0 + right / 3.0
    }

    #[test]
    fn counts() {
        let mesh = revolution(&barrel(20, 1.5), 24, 7);
        assert_eq!((mesh.points.len(), mesh.quads.len(), mesh.fibres.len()), (21 * 24 + 7 * 21, 20 * 24, 7));
        let mesh = pleated(&barrel(20, 0.0), None);
        assert_eq!(
            (mesh.points.len(), mesh.quads.len(), mesh.fibres.len()),
            (21 * 80 + 10 * 21, 20 * 80, 10)
        );
        assert_eq!(revolution(&barrel(20, 1.5), 24, 0).fibres.len(), 0);
    }

    #[test]
    fn every_field_has_one_value_per_point_or_cell() {
        for mesh in [revolution(&barrel(12, 1.5), 16, 6), pleated(&barrel(12, 0.0), Some(0.3))] {
            let cells = mesh.fibres.len() + mesh.quads.len();
            assert_eq!(mesh.part.len(), cells);
            assert!(mesh.cell_fields.iter().all(|(_, values)| values.len() == cells));
            assert!(mesh.point_fields.iter().all(|(_, values)| values.len() == mesh.points.len()));
            let values = mesh.point_fields.iter().chain(&mesh.cell_fields).flat_map(|(_, values)| values);
            assert!(values.into_iter().all(|value| value.is_finite()));
            assert_eq!(mesh.part.iter().filter(|&&part| part == FIBRE).count(), mesh.fibres.len());
        }
    }

    /// Every interior edge belongs to two quadrangles that run through it in opposite directions; edges of
    /// only one quadrangle lie in the two ends.
    #[test]
    fn surface_closes_around_the_axis() {
        for (mesh, columns) in
            [(revolution(&barrel(9, 1.5), 11, 4), 11), (pleated(&barrel(9, 0.0), Some(0.4)), 80)]
        {
            let mut edges: HashMap<(usize, usize), i32> = HashMap::new();
            for quad in &mesh.quads {
                for i in 0..4 {
                    let (a, b) = (quad[i], quad[(i + 1) % 4]);
                    *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
                }
            }
            let open: Vec<_> = edges.iter().filter(|(_, sum)| **sum != 0).collect();
            assert_eq!(open.len(), 2 * columns);
            for ((a, b), _) in open {
                let x = |v: &usize| mesh.points[*v][0];
                assert!(
                    [a, b].into_iter().all(|v| x(v).abs() < 1e-15)
                        || [a, b].into_iter().all(|v| (x(v) - 0.09).abs() < 1e-15)
                );
            }
        }
    }

    /// Areas converge to the exact ones: facets inscribed in circles and arcs have order 2.
    #[test]
    fn area_of_revolution_converges_with_order_two() {
        type Case = (fn(u32) -> Shape, f64);
        let cases: [Case; 3] = [
            (cylinder, TAU * 0.02 * 0.1),
            (cone, PI * (0.01 + 0.03) * 0.1_f64.hypot(0.02)),
            (sphere, TAU * 0.03 * 0.04),
        ];
        for (shape, exact) in cases {
            let error = |n: u32| (cloth_area(&revolution(&shape(n), 2 * n, 0)) / exact - 1.0).abs();
            let order = (error(40) / error(80)).log2();
            assert!((order - 2.0).abs() < 0.02, "order {order}");
            assert!(error(80) < 1e-3, "error {}", error(80));
        }
    }

    /// V = pi int r^2 dx = pi (R^2 l + 4 R a l/pi + a^2 l/2) for the barrel r = R + a sin(pi x/l).
    #[test]
    fn normals_point_outward() {
        let (radius, a, l) = (0.016_f64, 0.02, 0.09);
        let exact = PI * l * (radius * radius + 4.0 * radius * a / PI + a * a / 2.0);
        let mesh = revolution(&barrel(200, 0.0), 200, 0);
        assert!((volume(&mesh, 201, 200) / exact - 1.0).abs() < 1e-3);
        let polygon = pleated(&barrel(200, 0.0), None);
        assert!(volume(&polygon, 201, 80) > 0.9 * exact);
    }

    #[test]
    fn cloth_is_as_wide_at_every_station() {
        let circumference = 0.5;
        let style = Style::Pleats { cloth_circumference: Some(circumference) };
        let shape = barrel(10, 0.0);
        let bulge = Bulge { shape: &shape, fibres: 10, style, facets: 400 };
        let mesh = Mesh::new(&bulge);
        for ring in mesh.points[..11 * 4000].chunks(4000) {
            let around = (0..4000).map(|j| (ring[j], ring[(j + 1) % 4000]));
            let length: f64 = around.map(|(p, q)| (p[1] - q[1]).hypot(p[2] - q[2])).sum();
            assert!((length / circumference - 1.0).abs() < 1e-4, "{length} m at x = {} m", ring[0][0]);
        }
    }

    #[test]
    fn cloth_just_unfolds_at_the_largest_radius() {
        let mesh = pleated(&barrel(10, 0.0), None);
        let ring = |station: usize| &mesh.point_fields[6].1[station * 80..(station + 1) * 80];
        let spread = |values: &[f64]| values.iter().fold(0.0, |m: f64, v| m.max(*v));
        assert!(spread(ring(5)) <= 0.036 * (1.0 + 1e-12), "flat panels in the middle");
        assert!(spread(ring(0)) > 0.016 * 1.2, "pleats stand out at the fitting");
    }

    #[test]
    fn braid_has_two_opposite_families() {
        let mesh = revolution(&barrel(10, 1.5), 12, 6);
        let turned = |fibre: usize| {
            let [_, y, z] = mesh.points[*mesh.fibres[fibre].last().unwrap()];
            z.atan2(y)
        };
        assert!((turned(0) - 1.5).abs() < 1e-12 && (turned(3) + 1.5).abs() < 1e-12);
        let straight = revolution(&barrel(10, 0.0), 12, 6);
        let starts: Vec<_> = straight.fibres.iter().map(|f| straight.points[f[0]]).collect();
        assert!(
            starts
                .iter()
                .enumerate()
                .all(|(i, p)| starts[..i].iter().all(|q| (p[1] - q[1]).hypot(p[2] - q[2]) > 1e-3)),
            "fibres lie apart"
        );
    }
}
