//! Membrane triangles with three or six nodes under large displacements and rotations.
//!
//! With X the positions in the flat stress-free pattern and F = dx/dX (3 x 2):
//!
//! ```text
//! energy = integral of W(E) dA,   C = F'F,   E = (C - 1)/2,   force on node a: F S grad N_a
//! V = 1/2 integral of (x, y, 0).n dA
//! ```
//!
//! The flux form of the volume vanishes on planes z = const. and on planes through the z axis, so that end
//! discs and planes of symmetry need no elements.

use super::shape::{triangle_strain, triangle_volume};
use super::{Local, Vector, add, cross, dot, mixed, norm, scaled, sub};
use crate::material::{Plane, Sheet, Tension};

#[derive(Debug, Clone, Copy)]
struct Point<const N: usize> {
    /// Gradients of the shape functions in the pattern.
    by: [[f64; 2]; N],
    area: f64,
}

/// A membrane element.
#[derive(Debug, Clone)]
pub(crate) struct Triangle<const N: usize> {
    points: Vec<Point<N>>,
    /// `None`: it only transmits the pressure.
    sheet: Option<Sheet>,
}

/// A quadrature point of [`Triangle::volume_rule`].
pub(crate) type VolumePoint<const N: usize> = (f64, [f64; N], [[f64; N]; 2]);

/// Forces of a membrane at the middle of an element: principal forces per unit current length, N/m, the
/// larger first, the stretches, and the direction of the larger force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Carried {
    pub(crate) force: [f64; 2],
    pub(crate) stretch: [f64; 2],
    pub(crate) direction: Vector,
    pub(crate) tension: Tension,
    pub(crate) folded: f64,
}

impl<const N: usize> Triangle<N> {
    /// An element through the stress-free positions of its nodes, on a surface in space or in the plane of a
    /// pattern. `warp` is the direction of the sheet's first axis. `None` if the element has no area or folds
    /// over.
    pub(crate) fn new(places: &[Vector; N], warp: Vector, sheet: Option<Sheet>) -> Option<Self> {
        let mut points = Vec::new();
        let corner = cross(sub(places[1], places[0]), sub(places[2], places[0]));
        for (weight, _, d) in triangle_strain::<N>() {
            let (u, v) = (mixed(places, &d[0]), mixed(places, &d[1]));
            let normal = cross(u, v);
            let size = norm(normal);
            // An area much smaller than the edges means a needle or a fold.
            if !(size.is_finite() && size > 1e-10 * (dot(u, u) + dot(v, v)) && dot(normal, corner) > 0.0) {
                return None;
            }
            let normal = scaled(normal, 1.0 / size);
            let (e1, e2) = axes(normal, warp, u);
            // dX/dxi in the axes of the plane, inverted.
            let j = [[dot(u, e1), dot(v, e1)], [dot(u, e2), dot(v, e2)]];
            let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
            let mut by = [[0.0; 2]; N];
            for (a, by) in by.iter_mut().enumerate() {
                by[0] = (d[0][a] * j[1][1] - d[1][a] * j[1][0]) / det;
                by[1] = (d[1][a] * j[0][0] - d[0][a] * j[0][1]) / det;
            }
            points.push(Point { by, area: weight * size });
        }
        Some(Self { points, sheet })
    }

    #[inline]
    fn gradient(point: &Point<N>, x: &[Vector; N]) -> [Vector; 2] {
        let mut f = [[0.0; 3]; 2];
        for (x, by) in x.iter().zip(&point.by) {
            for i in 0..3 {
                f[0][i] += x[i] * by[0];
                f[1][i] += x[i] * by[1];
            }
        }
        f
    }

    #[inline]
    fn plane(sheet: &Sheet, f: &[Vector; 2]) -> Plane {
        sheet.plane([dot(f[0], f[0]), dot(f[1], f[1]), dot(f[0], f[1])])
    }

    pub(crate) fn energy(&self, x: &[Vector; N]) -> f64 {
        let Some(sheet) = &self.sheet else { return 0.0 };
        self.points.iter().map(|point| point.area * Self::plane(sheet, &Self::gradient(point, x)).w).sum()
    }

    /// Quadrature points of [`Triangle::volume`].
    pub(crate) fn volume_rule() -> Vec<VolumePoint<N>> {
        triangle_volume()
    }

    pub(crate) fn volume(x: &[Vector; N], rule: &[VolumePoint<N>]) -> f64 {
        rule.iter()
            .map(|(w, n, d)| {
                let [x0, y0, _] = mixed(x, n);
                0.5 * w * dot([x0, y0, 0.0], cross(mixed(x, &d[0]), mixed(x, &d[1])))
            })
            .sum()
    }

    pub(crate) fn local(&self, x: &[Vector; N], pressure: f64, rule: &[VolumePoint<N>]) -> Local<N> {
        let mut out = Local::ZERO;
        if let Some(sheet) = &self.sheet {
            for point in &self.points {
                Self::strain(sheet, point, x, &mut out);
            }
        }
        for (w, n, d) in rule {
            swept(0.5 * w, n, d, x, pressure, &mut out);
        }
        out
    }

    #[inline]
    fn strain(sheet: &Sheet, point: &Point<N>, x: &[Vector; N], out: &mut Local<N>) {
        let f = Self::gradient(point, x);
        let Plane { w, s, d, .. } = Self::plane(sheet, &f);
        out.energy += point.area * w;
        // Variations of (E11, E22, 2 E12) with node a, and the resulting forces.
        let mut strain = [[[0.0; 3]; 3]; N];
        let mut stress = [[[0.0; 3]; 3]; N];
        for a in 0..N {
            let [b0, b1] = point.by[a];
            for i in 0..3 {
                let e = [b0 * f[0][i], b1 * f[1][i], b0 * f[1][i] + b1 * f[0][i]];
                strain[a][i] = e;
                out.force[a][i] += point.area * (s[0] * e[0] + s[1] * e[1] + s[2] * e[2]);
                for k in 0..3 {
                    stress[a][i][k] = point.area * (d[k][0] * e[0] + d[k][1] * e[1] + d[k][2] * e[2]);
                }
            }
        }
        for a in 0..N {
            let [a0, a1] = point.by[a];
            for b in a..N {
                let [b0, b1] = point.by[b];
                let bend = point.area * (s[0] * a0 * b0 + s[1] * a1 * b1 + s[2] * (a0 * b1 + a1 * b0));
                let k = &mut out.stiffness[a][b];
                for i in 0..3 {
                    for j in 0..3 {
                        k[i][j] += dot(strain[a][i], stress[b][j]);
                    }
                    k[i][i] += bend;
                }
            }
        }
    }

    /// Forces averaged over its points; `None` for a facet without material.
    pub(crate) fn carried(&self, x: &[Vector; N]) -> Option<Carried> {
        let sheet = self.sheet.as_ref()?;
        let share = 1.0 / self.points.len() as f64;
        let mut sum = Carried {
            force: [0.0; 2],
            stretch: [0.0; 2],
            direction: [0.0; 3],
            tension: Tension::Taut,
            folded: 0.0,
        };
        for point in &self.points {
            let f = Self::gradient(point, x);
            let plane = Self::plane(sheet, &f);
            let at = principal(&f, &plane);
            for i in 0..2 {
                sum.force[i] += share * at.force[i];
                sum.stretch[i] += share * at.stretch[i];
            }
            // A direction and its negative are equivalent.
            let sign = if dot(sum.direction, at.direction) < 0.0 { -1.0 } else { 1.0 };
            sum.direction = add(sum.direction, scaled(at.direction, sign));
            sum.tension = sum.tension.min(at.tension);
        }
        let size = norm(sum.direction);
        if size > 0.0 {
            sum.direction = scaled(sum.direction, 1.0 / size);
        }
        sum.folded = sheet.folded(sum.stretch, sum.tension);
        Some(sum)
    }

    /// Stress-free area.
    pub(crate) fn area(&self) -> f64 {
        self.points.iter().map(|point| point.area).sum()
    }
}

/// Unit axes of the plane orthogonal to `normal`. The first is along `warp`, or along `instead` if `warp` is
/// perpendicular to the plane.
fn axes(normal: Vector, warp: Vector, instead: Vector) -> (Vector, Vector) {
    let in_plane = |v: Vector| sub(v, scaled(normal, dot(v, normal)));
    let mut first = in_plane(warp);
    if norm(first) <= 1e-6 * norm(warp) {
        first = in_plane(instead);
    }
    let first = scaled(first, 1.0 / norm(first));
    (first, cross(normal, first))
}

/// Principal forces per current length for S at F: those of the Kirchhoff stress F S F' over the area
/// stretch.
fn principal(f: &[Vector; 2], plane: &Plane) -> Carried {
    let (g11, g22, g12) = (dot(f[0], f[0]), dot(f[1], f[1]), dot(f[0], f[1]));
    let [s11, s22, s12] = plane.s;
    let area = norm(cross(f[0], f[1]));
    // Stretches from C; forces as the eigenvalues of S C, which are those of F S F'.
    let (mean, half) = (0.5 * (g11 + g22), (0.25 * (g11 - g22).powi(2) + g12 * g12).sqrt());
    let stretch = [(mean + half).sqrt(), (mean - half).max(0.0).sqrt()];
    let (a, b) = (s11 * g11 + s12 * g12, s11 * g12 + s12 * g22);
    let (c, d) = (s12 * g11 + s22 * g12, s12 * g12 + s22 * g22);
    let (mean, half) = (0.5 * (a + d), (0.25 * (a - d).powi(2) + b * c).max(0.0).sqrt());
    let force = [(mean + half) / area, (mean - half) / area];
    // Left eigenvector of S C as a combination of F's columns.
    let first = mean + half;
    let u = if (first - d).abs() >= (first - a).abs() { [first - d, c] } else { [b, first - a] };
    let direction = add(scaled(f[0], u[0]), scaled(f[1], u[1]));
    let size = norm(direction);
    let direction = if size > 0.0 { scaled(direction, 1.0 / size) } else { [0.0; 3] };
    Carried { force, stretch, direction, tension: plane.tension, folded: 0.0 }
}

/// Adds weight a.(u x v) with a = (x, y, 0), u = x_xi, v = x_eta, its gradient, and -p times its second
/// derivatives.
#[inline]
fn swept<const N: usize>(
    weight: f64,
    n: &[f64; N],
    d: &[[f64; N]; 2],
    x: &[Vector; N],
    pressure: f64,
    out: &mut Local<N>,
) {
    let [x0, y0, _] = mixed(x, n);
    let (a, u, v) = ([x0, y0, 0.0], mixed(x, &d[0]), mixed(x, &d[1]));
    let (uv, va, au) = (cross(u, v), cross(v, a), cross(a, u));
    out.volume += weight * dot(a, uv);
    let p = weight * pressure;
    for i in 0..N {
        for k in 0..3 {
            let flat = if k < 2 { n[i] * uv[k] } else { 0.0 };
            out.sweep[i][k] += weight * (flat + d[0][i] * va[k] + d[1][i] * au[k]);
        }
        for j in i..N {
            // da.(du x v) + da.(u x dv) + a.(du x dv), and with i and j exchanged: [w]x is skew, so each pair
            // has one vector.
            let on_v = n[i] * d[0][j];
            let on_v_back = n[j] * d[0][i];
            let on_u = n[i] * d[1][j];
            let on_u_back = n[j] * d[1][i];
            let on_a = d[0][i] * d[1][j] - d[0][j] * d[1][i];
            // Row k of the cross product with w: (w x e_l)_k.
            let k = &mut out.stiffness[i][j];
            let first = sub(scaled(u, on_u), scaled(v, on_v));
            let second = sub(scaled(u, on_u_back), scaled(v, on_v_back));
            for row in 0..3 {
                for column in 0..3 {
                    let mut value = -on_a * crossed(a, row, column);
                    if row < 2 {
                        value += crossed(first, row, column);
                    }
                    if column < 2 {
                        value += crossed(second, column, row);
                    }
                    k[row][column] -= p * value;
                }
            }
        }
    }
}

/// (w x e_column)_row.
#[inline]
fn crossed(w: Vector, row: usize, column: usize) -> f64 {
    match (row, column) {
        (0, 1) => -w[2],
        (1, 0) => w[2],
        (0, 2) => w[1],
        (2, 0) => -w[1],
        (1, 2) => -w[0],
        (2, 1) => w[0],
        _ => 0.0,
    }
}
