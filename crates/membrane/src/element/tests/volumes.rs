//! Closed surfaces: volumes, areas, and elements without either.

use super::*;

/// The corners and faces of an icosahedron of edge 2, outwards.
fn icosahedron() -> (Vec<Vector>, Vec<[usize; 3]>) {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::new();
    for a in [1.0, -1.0] {
        for b in [g, -g] {
            corners.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
        }
    }
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let is_edge = |i: usize, j: usize| (norm(sub(corners[i], corners[j])) - 2.0).abs() < 1e-9;
                if is_edge(i, j) && is_edge(j, k) && is_edge(k, i) {
                    let normal = cross(sub(corners[j], corners[i]), sub(corners[k], corners[i]));
                    faces.push(if dot(normal, corners[i]) > 0.0 { [i, j, k] } else { [i, k, j] });
                }
            }
        }
    }
    assert_eq!(faces.len(), 20);
    (corners, faces)
}

/// Rotated about z, and displaced along it.
fn turned_about_z(x: Vector) -> Vector {
    let (sin, cos) = 0.7_f64.sin_cos();
    [cos * x[0] - sin * x[1], sin * x[0] + cos * x[1], x[2] + 4.0]
}

#[test]
fn a_closed_surface_of_facets() {
    let (corners, faces) = icosahedron();
    let rule = Triangle::<3>::volume_rule();
    let volume = |places: &[Vector]| -> f64 {
        faces.iter().map(|face| Triangle::<3>::volume(&face.map(|i| places[i]), &rule)).sum()
    };
    // 5 (3 + sqrt 5) a^3/12.
    let exact = 5.0 * (3.0 + 5.0_f64.sqrt()) * 8.0 / 12.0;
    // A closed surface may be rotated and displaced in any way.
    let anyhow = |x: &Vector| add(rotated(*x, 1.2), [2.0, -3.0, 1.0]);
    let places: Vec<Vector> = corners.iter().map(anyhow).collect();
    assert!((volume(&corners) - exact).abs() < 1e-13 && (volume(&places) - exact).abs() < 1e-12);
    let turned: Vec<Vector> = places.iter().map(|x| turned_about_z(*x)).collect();
    assert!((volume(&turned) - exact).abs() < 1e-12);
    // Each open piece may be rotated about z and displaced along it.
    for face in &faces {
        let x = face.map(|i| places[i]);
        let difference =
            Triangle::<3>::volume(&x, &rule) - Triangle::<3>::volume(&x.map(turned_about_z), &rule);
        assert!(difference.abs() < 1e-13);
    }
    // The force of the pressure on a corner: a third of that on each facet that meets there, along its
    // normal.
    let mut swept = vec![[0.0; 3]; 12];
    let mut flux = swept.clone();
    for face in &faces {
        let x = face.map(|i| places[i]);
        let local = Triangle::<3>::new(&x, WARP, None).unwrap().local(&x, PRESSURE, &rule);
        let area = scaled(cross(sub(x[1], x[0]), sub(x[2], x[0])), 0.5);
        for (i, sweep) in face.iter().zip(local.sweep) {
            swept[*i] = add(swept[*i], sweep);
            flux[*i] = add(flux[*i], scaled(area, 1.0 / 3.0));
        }
    }
    for (swept, flux) in swept.iter().zip(&flux) {
        assert!(norm(sub(*swept, *flux)) < 1e-12);
    }
}

/// A quarter of each half of the unit sphere in n x n curved triangles with nodes on it.
fn octants(n: usize) -> Vec<[Vector; 6]> {
    let on = |v: Vector| scaled(v, 1.0 / norm(v));
    let at = |i: usize, j: usize, x: f64, y: f64, z: f64| {
        let (a, b) = (i as f64 / (2 * n) as f64, j as f64 / (2 * n) as f64);
        on([x * (1.0 - a - b), y * a, z * b])
    };
    let mut out = Vec::new();
    for (x, y, z) in [1.0, -1.0]
        .into_iter()
        .flat_map(|x| [1.0, -1.0].map(|y| (x, y)))
        .flat_map(|(x, y)| [1.0, -1.0].map(|z| (x, y, z)))
    {
        let mut push = |corners: [[usize; 2]; 3]| {
            let middle = |a: usize, b: usize| [0, 1].map(|k| usize::midpoint(corners[a][k], corners[b][k]));
            let all = [corners[0], corners[1], corners[2], middle(0, 1), middle(1, 2), middle(2, 0)];
            let mut places = all.map(|[i, j]| at(i, j, x, y, z));
            if x * y * z < 0.0 {
                places.swap(1, 2);
                places.swap(3, 5);
            }
            out.push(places);
        };
        for i in 0..n {
            for j in 0..n - i {
                let (i, j) = (2 * i, 2 * j);
                push([[i, j], [i + 2, j], [i, j + 2]]);
                if i + j + 4 <= 2 * n {
                    push([[i + 2, j], [i + 2, j + 2], [i, j + 2]]);
                }
            }
        }
    }
    out
}

#[test]
fn a_closed_surface_of_curved_triangles() {
    let rule = Triangle::<6>::volume_rule();
    let volume = |all: &[[Vector; 6]]| -> f64 { all.iter().map(|x| Triangle::<6>::volume(x, &rule)).sum() };
    let exact = 4.0 / 3.0 * PI;
    let errors = [4, 8, 16].map(|n| {
        let error = volume(&octants(n)) / exact - 1.0;
        println!("sphere of {n}: {error:e}");
        error
    });
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        println!("order {order}");
        assert!((3.8..4.2).contains(&order), "{order}");
    }
    let all = octants(2);
    let turned: Vec<_> = all.iter().map(|x| x.map(|x| add(rotated(x, 0.9), [3.0, 1.0, -2.0]))).collect();
    assert!((volume(&all) - volume(&turned)).abs() < 1e-12);
    // The volume by another formula, from x.n/3, and the force of the pressure as the integral of N n dA.
    // Both use other quadrature points: a square of Gauss points collapsed into the triangle.
    let gauss = [
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    ];
    let gauss: Vec<(f64, f64)> = gauss
        .into_iter()
        .flat_map(|(x, w)| [(0.5 * (1.0 - x), 0.5 * w), (0.5 * (1.0 + x), 0.5 * w)])
        .collect();
    let mut cone = 0.0;
    let mut nodes: Vec<(Vector, Vector, Vector)> = Vec::new();
    for x in &all {
        let local = Triangle::<6>::new(x, WARP, None).unwrap().local(x, PRESSURE, &rule);
        let mut flux = [[0.0; 3]; 6];
        for (u, wu) in &gauss {
            for (v, wv) in &gauss {
                let (n, d) = triangle::<6>(*u, v * (1.0 - u));
                let weight = wu * wv * (1.0 - u);
                let normal = scaled(cross(mixed(x, &d[0]), mixed(x, &d[1])), weight);
                cone += dot(mixed(x, &n), normal) / 3.0;
                for (flux, n) in flux.iter_mut().zip(n) {
                    *flux = add(*flux, scaled(normal, n));
                }
            }
        }
        for i in 0..6 {
            let found = nodes.iter_mut().find(|(place, _, _)| norm(sub(*place, x[i])) < 1e-9);
            if let Some((_, swept, flown)) = found {
                *swept = add(*swept, local.sweep[i]);
                *flown = add(*flown, flux[i]);
            } else {
                nodes.push((x[i], local.sweep[i], flux[i]));
            }
        }
    }
    assert!((cone - volume(&all)).abs() < 1e-13);
    assert_eq!(nodes.len(), 66);
    for (_, swept, flown) in &nodes {
        assert!(norm(sub(*swept, *flown)) < 1e-14, "{swept:?} {flown:?}");
    }
}

#[test]
fn a_sphere_of_revolution_sweeps_its_area() {
    // The force of the pressure on a ring between two open ends: 2 pi r N (dz, -dr) and the share of the end
    // discs along z.
    let x = MERIDIAN;
    let rule = Ring::<3>::volume_rule();
    let local = Ring::<3>::new(&x, &[]).unwrap().local(&x, PENALTY, PRESSURE, &rule);
    let mut flux = [[0.0; 3]; 3];
    // Gauss points of degree 9.
    for (xi, w) in [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683, 0.478_628_670_499_366_5),
        (-0.538_469_310_105_683, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ] {
        let (n, d) = super::shape::line::<3>(xi);
        let (r, dr, dz) = (mixed(&x, &n)[0], mixed(&x, &d)[0], mixed(&x, &d)[2]);
        for (flux, n) in flux.iter_mut().zip(n) {
            flux[0] += w * 2.0 * PI * r * dz * n;
            flux[2] -= w * 2.0 * PI * r * dr * n;
        }
    }
    // pi r^2 at the ends: the force that a disc there would carry.
    flux[0][2] -= PI * x[0][0].powi(2);
    flux[1][2] += PI * x[1][0].powi(2);
    for (swept, flux) in local.sweep.iter().zip(&flux) {
        assert!(norm(sub(*swept, *flux)) < 1e-13, "{swept:?} {flux:?}");
    }
}

#[test]
fn elements_without_size_are_refused() {
    let cloth = Sheet { cloth: Cloth::Isotropic(LAWS[0]), wrinkles: true, residual: 0.0 };
    assert!(Triangle::<3>::new(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], WARP, Some(cloth)).is_none());
    let mut folded = six(FLAT, 0.0);
    folded[3] = folded[2];
    assert!(Triangle::<6>::new(&folded, WARP, Some(cloth)).is_none());
    assert!(Cable::<2>::new(&[[1.0; 3]; 2], Thread::Inextensible, 1.0).is_none());
    assert!(Ring::<2>::new(&[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]], &[]).is_none());
    assert!(Ring::<2>::new(&[[1.0, 0.0, 1.0], [1.0, 0.0, 1.0]], &[]).is_none());
    // If the warp is perpendicular to the element, some direction in its plane is taken.
    assert!(Triangle::<3>::new(&FLAT, [0.0, 0.0, 1.0], Some(cloth)).is_some());
}
