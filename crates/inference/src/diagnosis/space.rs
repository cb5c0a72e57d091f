//! The space in which candidates are compared: whitened, without what the model's own numbers can do, in few coordinates.
//!
//! ```text
//! z = P K^-1/2 (y - F),    s = P K^-1/2 dF/dA,    P = 1 - Q Q',    Q orthonormal over the whitened tangents of the model
//! ```
//! Priors of the model's numbers are further rows. The coordinates are those of an orthonormal frame over all columns that were asked for: thousands
//! of rows become about a hundred numbers, in which bootstraps and all pairs cost next to nothing.

use crate::dot::dot;

/// A column whose part outside the frame is smaller than this part of it lies within the frame.
const WITHIN: f64 = 1e-7;

/// Orthonormal columns: those of the model first, then the frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Space {
    tangents: Vec<Vec<f64>>,
    frame: Vec<Vec<f64>>,
}

impl Space {
    /// Without what these columns span.
    pub(crate) fn without(columns: &[Vec<f64>]) -> Self {
        let mut tangents: Vec<Vec<f64>> = Vec::new();
        for column in columns {
            if let Some((unit, _)) = remainder(column, &[&tangents], WITHIN) {
                tangents.push(unit);
            }
        }
        Self { tangents, frame: Vec::new() }
    }

    /// Number of coordinates.
    pub(crate) fn len(&self) -> usize {
        self.frame.len()
    }

    /// All directions of the frame.
    pub(crate) fn into_units(self) -> Vec<Vec<f64>> {
        self.frame
    }

    /// Coordinates of a column; the frame grows if it lies outside.
    pub(crate) fn enter(&mut self, column: &[f64]) -> Vec<f64> {
        let mut left = column.to_vec();
        subtract(&mut left, &self.tangents);
        let size = norm(&left);
        let mut coordinates = self.coordinates(&left);
        if size > WITHIN * norm(column)
            && let Some((unit, length)) = remainder(&left, &[&self.tangents, &self.frame], WITHIN)
        {
            self.frame.push(unit);
            coordinates.push(length);
        }
        if size <= WITHIN * norm(column) {
            // Rounding is no direction.
            coordinates.fill(0.0);
        }
        coordinates
    }

    /// Coordinates of the part of a column within the frame.
    pub(crate) fn coordinates(&self, column: &[f64]) -> Vec<f64> {
        let mut left = column.to_vec();
        subtract(&mut left, &self.tangents);
        self.frame.iter().map(|unit| dot(unit, &left)).collect()
    }

    /// Square of the part of a column that is outside the model's tangents and the frame.
    pub(crate) fn outside(&self, column: &[f64]) -> f64 {
        let mut left = column.to_vec();
        subtract(&mut left, &self.tangents);
        subtract(&mut left, &self.frame);
        dot(&left, &left)
    }
}

/// Takes the parts along orthonormal columns out of a column; twice, so that nothing of them is left (Kahan, Parlett).
fn subtract(column: &mut [f64], units: &[Vec<f64>]) {
    for _ in 0..2 {
        for unit in units {
            let part = dot(unit, column);
            for (value, u) in column.iter_mut().zip(unit) {
                *value -= part * u;
            }
        }
    }
}

/// The part of a column outside orthonormal columns, as unit and length; none if that is only rounding.
fn remainder(column: &[f64], spans: &[&Vec<Vec<f64>>], within: f64) -> Option<(Vec<f64>, f64)> {
    let whole = norm(column);
    let mut left = column.to_vec();
    for _ in 0..2 {
        for span in spans {
            subtract(&mut left, span);
        }
    }
    let length = norm(&left);
    (length > within * whole && length > 0.0).then(|| {
        for value in &mut left {
            *value /= length;
        }
        (left, length)
    })
}

pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(seed: u64) -> Vec<f64> {
        let mut random = bulge_numerics::Random::new(seed, 0);
        (0..50).map(|_| random.normal()).collect()
    }

    #[test]
    fn coordinates_keep_lengths_and_angles_outside_the_tangents() {
        let tangents = [column(1), column(2), column(1)];
        let mut space = Space::without(&tangents);
        assert_eq!(space.tangents.len(), 2);
        let [a, b] = [column(3), column(4)];
        let (ca, cb) = (space.enter(&a), space.enter(&b));
        let outside = |v: &[f64]| {
            let mut v = v.to_vec();
            subtract(&mut v, &space.tangents);
            v
        };
        assert!((dot(&ca, &cb) - dot(&outside(&a), &outside(&b))).abs() < 1e-12);
        assert!((norm(&cb) - norm(&outside(&b))).abs() < 1e-12);
        assert_eq!((space.len(), ca.len(), cb.len()), (2, 1, 2));
        // A combination of all has nothing outside, and nothing of the tangents.
        let sum: Vec<f64> = (0..50).map(|i| 3.0 * tangents[0][i] + 2.0 * a[i] - b[i]).collect();
        let c = space.enter(&sum);
        assert!(space.len() == 2 && space.outside(&sum) < 1e-20);
        assert!((c[0] - (2.0 * ca[0] - cb[0])).abs() < 1e-12);
        assert!(norm(&space.enter(&tangents[1])) < 1e-12);
    }
}
