//! The space in which candidates are compared: whitened, orthogonal to the model's tangents, in few
//! coordinates.
//!
//! ```text
//! z = P K^-1/2 (y - F),    s = P K^-1/2 dF/dA,    P = 1 - Q Q',    Q orthonormal over the whitened tangents of the model
//! ```
//! Priors of the model's parameters are additional rows. The coordinates refer to an orthonormal frame over
//! all columns that were entered: thousands of rows become about a hundred numbers, in which bootstraps and
//! all pairs are cheap.

use nalgebra::DMatrix;

use bulge_numerics::vector::{add, dot, norm};

/// A column lies within the frame if less than this fraction of it is outside.
const WITHIN: f64 = 1e-7;

/// A smooth function is skipped if less than this fraction of it is new.
const NEW: f64 = 1e-3;
/// One pass of orthogonalisation suffices if it leaves at least this fraction of a column: the rounding
/// errors are then no larger than those of the column (Daniel and others 1976).
pub(crate) const ENOUGH: f64 = 0.5;

/// Columns that are orthogonalised against the frame together.
const BLOCK: usize = 24;

/// Orthonormal columns: the model's tangents first, then the frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Space {
    tangents: Vec<Vec<f64>>,
    frame: Vec<Vec<f64>>,
}

impl Space {
    /// A space orthogonal to the span of these columns.
    pub(crate) fn without(columns: &[Vec<f64>]) -> Self {
        let mut tangents: Vec<Vec<f64>> = Vec::new();
        for column in columns {
            let mut left = column.clone();
            subtract(&mut left, &tangents);
            subtract(&mut left, &tangents);
            let length = norm(&left);
            if length > WITHIN * norm(column) {
                tangents.push(scaled(left, 1.0 / length));
            }
        }
        Self { tangents, frame: Vec::new() }
    }

    /// Also excludes further columns, which are orthogonal to each other and to all columns excluded before.
    /// Each gets a row of its own for the prior of its coefficient, with standard deviation 1. Must be called
    /// before the first coordinate.
    pub(crate) fn leave_out(&mut self, columns: &[&[f64]]) {
        for unit in &mut self.tangents {
            unit.resize(unit.len() + columns.len(), 0.0);
        }
        for (place, column) in columns.iter().enumerate() {
            let mut unit = column.to_vec();
            unit.resize(column.len() + columns.len(), 0.0);
            unit[column.len() + place] = 1.0;
            let length = norm(&unit);
            self.tangents.push(scaled(unit, 1.0 / length));
        }
    }

    /// Number of coordinates.
    pub(crate) fn len(&self) -> usize {
        self.frame.len()
    }

    /// All directions of the frame.
    pub(crate) fn into_units(self) -> Vec<Vec<f64>> {
        self.frame
    }

    /// Coordinates of a column; the frame grows if the column lies outside.
    pub(crate) fn enter(&mut self, column: &[f64]) -> Vec<f64> {
        let mut left = column.to_vec();
        let mut coordinates = vec![0.0; self.frame.len()];
        subtract(&mut left, &self.tangents);
        let size = norm(&left);
        if size <= WITHIN * norm(column) {
            // A rounding error is no direction.
            return coordinates;
        }
        add(&mut coordinates, 1.0, &subtract(&mut left, &self.frame));
        let mut length = norm(&left);
        if length < ENOUGH * norm(column) {
            // A second pass removes what rounding left of them (Kahan, Parlett).
            subtract(&mut left, &self.tangents);
            add(&mut coordinates, 1.0, &subtract(&mut left, &self.frame));
            length = norm(&left);
        }
        if length > WITHIN * size {
            self.frame.push(scaled(left, 1.0 / length));
            coordinates.push(length);
        }
        coordinates
    }

    /// Coordinates of many columns; the frame grows by the parts outside. Equivalent to one [`Space::enter`]
    /// after the other, but columns are orthogonalised in blocks, so that the computation isn't limited by
    /// memory bandwidth.
    pub(crate) fn enter_all(&mut self, columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let Some(rows) = columns.first().map(Vec::len) else { return Vec::new() };
        let mut units = DMatrix::zeros(rows, self.tangents.len() + self.frame.len() + columns.len());
        for (place, unit) in self.tangents.iter().chain(&self.frame).enumerate() {
            units.column_mut(place).copy_from_slice(unit);
        }
        let mut found = Vec::with_capacity(columns.len());
        for block in columns.chunks(BLOCK) {
            let (tangents, known) = (self.tangents.len(), self.frame.len());
            let there = units.columns(0, tangents + known);
            let mut left = DMatrix::from_fn(rows, block.len(), |row, column| block[column][row]);
            let mut parts = DMatrix::zeros(tangents + known, block.len());
            for _ in 0..2 {
                let again = there.tr_mul(&left);
                left.gemm(-1.0, &there, &again, 1.0);
                parts += again;
            }
            for (place, column) in block.iter().enumerate() {
                let mut own = left.column(place).as_slice().to_vec();
                // The part outside the tangents, before the frame is subtracted.
                let along: Vec<f64> = parts.column(place).iter().skip(tangents).copied().collect();
                let size = norm(&along).hypot(norm(&own));
                let mut coordinates = along;
                if size <= WITHIN * norm(column) {
                    // A rounding error is no direction.
                    found.push(vec![0.0; self.frame.len()]);
                    continue;
                }
                let whole = norm(&own);
                coordinates.extend(subtract(&mut own, &self.frame[known..]));
                if norm(&own) < ENOUGH * whole {
                    let again = subtract(&mut own, &self.frame[known..]);
                    add(&mut coordinates[known..], 1.0, &again);
                }
                let length = norm(&own);
                if length > WITHIN * size {
                    coordinates.push(length);
                    let unit = scaled(own, 1.0 / length);
                    units.column_mut(tangents + self.frame.len()).copy_from_slice(&unit);
                    self.frame.push(unit);
                }
                found.push(coordinates);
            }
        }
        found
    }

    /// Coordinates of the part of a column within the frame.
    pub(crate) fn coordinates(&self, column: &[f64]) -> Vec<f64> {
        let left = self.outside_of_left_out(column);
        self.frame.iter().map(|unit| dot(unit, &left)).collect()
    }

    /// Orthonormal columns of the excluded directions.
    pub(crate) fn left_out(&self) -> &[Vec<f64>] {
        &self.tangents
    }

    /// The part of a column outside the excluded directions.
    pub(crate) fn outside_of_left_out(&self, column: &[f64]) -> Vec<f64> {
        let mut left = column.to_vec();
        subtract(&mut left, &self.tangents);
        left
    }

    /// The part of a column outside the model's tangents and the frame.
    pub(crate) fn outside(&self, column: &[f64]) -> Vec<f64> {
        let mut left = self.outside_of_left_out(column);
        subtract(&mut left, &self.frame);
        left
    }

    /// Orthogonalises against the latest direction of the frame a column that is orthogonal to all earlier
    /// ones.
    pub(crate) fn outside_last(&self, left: &mut [f64]) {
        subtract(left, &self.frame[self.frame.len().saturating_sub(1)..]);
    }
}

/// Subtracts from a column its projections on orthonormal columns, and returns their coefficients.
fn subtract(column: &mut [f64], units: &[Vec<f64>]) -> Vec<f64> {
    let without = |unit: &Vec<f64>| {
        let part = dot(unit, column);
        add(column, -part, unit);
        part
    };
    units.iter().map(without).collect()
}

fn scaled(mut column: Vec<f64>, factor: f64) -> Vec<f64> {
    for value in &mut column {
        *value *= factor;
    }
    column
}

/// A function orthogonalised against others so that its white column has norm 1; none if it contains nothing
/// new.
pub(crate) fn orthogonal(
    mut raw: Vec<f64>,
    mut white: Vec<f64>,
    known: &[(Vec<f64>, Vec<f64>)],
) -> Option<(Vec<f64>, Vec<f64>)> {
    let whole = norm(&white);
    let mut left = whole;
    for _ in 0..2 {
        let before = left;
        for (other, unit) in known {
            let part = dot(&white, unit);
            add(&mut white, -part, unit);
            add(&mut raw, -part, other);
        }
        left = norm(&white);
        if left > ENOUGH * before {
            break;
        }
    }
    if left <= NEW * whole {
        return None;
    }
    for value in raw.iter_mut().chain(&mut white) {
        *value /= left;
    }
    Some((raw, white))
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
        // All together give the same as one after the other.
        let mut together = Space::without(&tangents);
        let again = together.enter_all(&[a.clone(), tangents[1].clone(), b.clone()]);
        let gap = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(gap(&again[0], &ca) < 1e-12 && gap(&again[2], &cb) < 1e-12 && norm(&again[1]) < 1e-12);
        assert_eq!([again[0].len(), again[1].len(), again[2].len()], [1, 1, 2]);
        let many: Vec<Vec<f64>> = (10..80).map(column).collect();
        let at_once = Space::without(&tangents).enter_all(&many);
        let mut one_by_one = Space::without(&tangents);
        for (place, (once, column)) in at_once.iter().zip(&many).enumerate() {
            let one = one_by_one.enter(column);
            assert!(gap(once, &one) < 1e-11 * norm(column) && once.len() == one.len(), "{place}");
        }
        assert_eq!(one_by_one.len(), 48);
        // A combination of all columns has no part outside, and none along the tangents.
        let sum: Vec<f64> = (0..50).map(|i| 3.0 * tangents[0][i] + 2.0 * a[i] - b[i]).collect();
        let c = space.enter(&sum);
        assert!(space.len() == 2 && norm(&space.outside(&sum)) < 1e-10);
        assert!((c[0] - (2.0 * ca[0] - cb[0])).abs() < 1e-12);
        assert!(norm(&space.enter(&tangents[1])) < 1e-12);
        // A nearly dependent column gives a direction that is orthogonal to all others.
        let nearly: Vec<f64> = (0..50).map(|i| sum[i] + 1e-5 * column(5)[i]).collect();
        space.enter(&nearly);
        let last = &space.frame[2];
        let others = space.tangents.iter().chain(&space.frame[..2]);
        assert!(
            others.map(|unit| dot(unit, last).abs()).fold(0.0, f64::max) < 1e-15
                && (norm(last) - 1.0).abs() < 1e-15
        );
    }
}
