//! Shape functions and quadrature points of lines and triangles with two or three, three or six nodes.

/// A point of a line: weight (the weights of a line sum to 2), shape functions, and their derivatives by xi in \[-1, 1\].
pub(crate) type LinePoint<const N: usize> = (f64, [f64; N], [f64; N]);

/// A point of a triangle: weight (their sum is 1/2), shape functions, and their derivatives by xi and eta.
pub(crate) type TrianglePoint<const N: usize> = (f64, [f64; N], [[f64; N]; 2]);

/// 1/sqrt(3) and sqrt(3/5): Gauss points.
const TWO: f64 = 0.577_350_269_189_625_8;
const THREE: f64 = 0.774_596_669_241_483_4;

/// Shape functions of a line at xi: ends -1 and 1, then the middle.
pub(crate) fn line<const N: usize>(xi: f64) -> ([f64; N], [f64; N]) {
    let (mut n, mut d) = ([0.0; N], [0.0; N]);
    if N == 2 {
        (n[0], n[1]) = (0.5 * (1.0 - xi), 0.5 * (1.0 + xi));
        (d[0], d[1]) = (-0.5, 0.5);
    } else {
        (n[0], n[1], n[2]) = (0.5 * xi * (xi - 1.0), 0.5 * xi * (xi + 1.0), 1.0 - xi * xi);
        (d[0], d[1], d[2]) = (xi - 0.5, xi + 0.5, -2.0 * xi);
    }
    (n, d)
}

fn line_points<const N: usize>(points: &[(f64, f64)]) -> Vec<LinePoint<N>> {
    points
        .iter()
        .map(|(weight, xi)| {
            let (n, d) = line(*xi);
            (*weight, n, d)
        })
        .collect()
}

/// Strain points: as many as the nodes have independent strains, so that inextensible threads don't lock.
pub(crate) fn line_strain<const N: usize>() -> Vec<LinePoint<N>> {
    if N == 2 { line_points(&[(2.0, 0.0)]) } else { line_points(&[(1.0, -TWO), (1.0, TWO)]) }
}

/// Exact for the volume of a line of revolution, where r^2 dz has degree 2 or 5.
pub(crate) fn line_volume<const N: usize>() -> Vec<LinePoint<N>> {
    if N == 2 {
        line_points(&[(1.0, -TWO), (1.0, TWO)])
    } else {
        line_points(&[(5.0 / 9.0, -THREE), (8.0 / 9.0, 0.0), (5.0 / 9.0, THREE)])
    }
}

/// Shape functions of a triangle at (xi, eta): corners (0, 0), (1, 0), (0, 1), then the midpoints of the
/// edges 1-2, 2-3, 3-1.
pub(crate) fn triangle<const N: usize>(xi: f64, eta: f64) -> ([f64; N], [[f64; N]; 2]) {
    let l = [1.0 - xi - eta, xi, eta];
    let by = [[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]];
    let (mut n, mut d) = ([0.0; N], [[0.0; N]; 2]);
    for i in 0..3 {
        if N == 3 {
            n[i] = l[i];
        } else {
            n[i] = l[i] * (2.0 * l[i] - 1.0);
            let j = (i + 1) % 3;
            n[3 + i] = 4.0 * l[i] * l[j];
        }
        for (d, by) in d.iter_mut().zip(by) {
            if N == 3 {
                d[i] = by[i];
            } else {
                let j = (i + 1) % 3;
                d[i] = (4.0 * l[i] - 1.0) * by[i];
                d[3 + i] = 4.0 * (l[i] * by[j] + l[j] * by[i]);
            }
        }
    }
    (n, d)
}

fn triangle_points<const N: usize>(points: &[(f64, f64, f64)]) -> Vec<TrianglePoint<N>> {
    points
        .iter()
        .map(|(weight, xi, eta)| {
            let (n, d) = triangle(*xi, *eta);
            (*weight, n, d)
        })
        .collect()
}

/// Strain points: one point, or three of degree 2.
pub(crate) fn triangle_strain<const N: usize>() -> Vec<TrianglePoint<N>> {
    let (w, a, b) = (1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0);
    if N == 3 {
        triangle_points(&[(0.5, 1.0 / 3.0, 1.0 / 3.0)])
    } else {
        triangle_points(&[(w, a, a), (w, b, a), (w, a, b)])
    }
}

/// Exact for the volume of a triangle: one point of degree 1, or six of degree 4 (Cowper 1973).
pub(crate) fn triangle_volume<const N: usize>() -> Vec<TrianglePoint<N>> {
    if N == 3 {
        return triangle_strain();
    }
    let (w, a) = (0.111_690_794_839_005_73, 0.445_948_490_915_965);
    let (v, b) = (0.054_975_871_827_660_93, 0.091_576_213_509_770_74);
    triangle_points(&[
        (w, a, a),
        (w, 1.0 - 2.0 * a, a),
        (w, a, 1.0 - 2.0 * a),
        (v, b, b),
        (v, 1.0 - 2.0 * b, b),
        (v, b, 1.0 - 2.0 * b),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_integrate_polynomials_of_their_degree() {
        let sum = |points: &[LinePoint<3>], power: i32| -> f64 {
            // xi itself is -n0 + n1.
            points.iter().map(|(w, n, _)| w * (n[1] - n[0]).powi(power)).sum()
        };
        for power in 0..6 {
            let exact = if power % 2 == 0 { 2.0 / (f64::from(power) + 1.0) } else { 0.0 };
            assert!((sum(&line_volume(), power) - exact).abs() < 1e-15);
            if power < 4 {
                assert!((sum(&line_strain(), power) - exact).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn triangles_integrate_polynomials_of_their_degree() {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        for (points, degree) in [(triangle_strain::<6>(), 2), (triangle_volume::<6>(), 4)] {
            for i in 0..=degree {
                for j in 0..=degree - i {
                    let sum: f64 = points
                        .iter()
                        .map(|(w, n, _)| {
                            let xi = n[1] + 0.5 * (n[3] + n[4]);
                            let eta = n[2] + 0.5 * (n[4] + n[5]);
                            w * xi.powi(i) * eta.powi(j)
                        })
                        .sum();
                    let exact = factorial(i) * factorial(j) / factorial(i + j + 2);
                    assert!((sum - exact).abs() < 1e-15, "{i} {j}: {sum} {exact}");
                }
            }
        }
    }
}
