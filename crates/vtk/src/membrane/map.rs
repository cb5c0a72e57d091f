//! Rotations about the z axis and reflections, as matrices.

use std::f64::consts::TAU;

pub(super) type Vector = [f64; 3];

/// A linear map, stored by rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Map([Vector; 3]);

impl Map {
    pub(super) const SAME: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    /// Reflection in the plane z = 0.
    pub(super) const ENDS_SWAPPED: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]);

    /// Rotation about the z axis by this fraction of a turn.
    pub(super) fn turn(part: f64) -> Self {
        let (sin, cos) = (TAU * part).sin_cos();
        Self([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    }

    /// Reflection in the plane normal to `normal`, which isn't zero.
    pub(super) fn mirror(normal: Vector) -> Self {
        let square = dot(normal, normal);
        let same = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        Self(std::array::from_fn(|i| {
            std::array::from_fn(|j| same(i, j) - 2.0 * normal[i] * normal[j] / square)
        }))
    }

    pub(super) fn of(&self, v: Vector) -> Vector {
        self.0.map(|row| dot(row, v))
    }

    /// The composition: first `first`, then this map.
    pub(super) fn after(&self, first: &Self) -> Self {
        let columns = [0, 1, 2].map(|j| self.of([first.0[0][j], first.0[1][j], first.0[2][j]]));
        Self([0, 1, 2].map(|i| [columns[0][i], columns[1][i], columns[2][i]]))
    }

    /// Whether the map reverses orientation.
    pub(super) fn is_mirror(&self) -> bool {
        let [a, b, c] = self.0;
        dot(a, [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]]) < 0.0
    }
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The vector scaled to length 1; zero stays zero.
pub(super) fn unit(v: Vector) -> Vector {
    let length = dot(v, v).sqrt();
    if length > 0.0 { v.map(|x| x / length) } else { v }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_near(a: Vector, b: Vector) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15)
    }

    #[test]
    fn turns_and_mirrors() {
        let v = [3.0, 1.0, 2.0];
        assert!(is_near(Map::turn(0.25).of(v), [-1.0, 3.0, 2.0]));
        assert!(is_near(Map::mirror([0.0, 2.0, 0.0]).of(v), [3.0, -1.0, 2.0]));
        assert!(is_near(Map::mirror([1.0, -1.0, 0.0]).of(v), [1.0, 3.0, 2.0]));
        let both = Map::turn(0.25).after(&Map::mirror([0.0, 1.0, 0.0]));
        assert!(is_near(both.of(v), [1.0, 3.0, 2.0]));
        assert!(both.is_mirror() && !Map::turn(0.3).is_mirror());
        assert!(!Map::ENDS_SWAPPED.after(&both).is_mirror());
        assert!(is_near(unit([0.0, 0.0, -4.0]), [0.0, 0.0, -1.0]) && is_near(unit([0.0; 3]), [0.0; 3]));
    }
}
