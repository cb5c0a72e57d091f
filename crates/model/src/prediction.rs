//! The force of every row with its derivatives, assembled segment by segment.

use bulge_effects::Jet;
use bulge_numerics::Real;
use std::ops::Range;

use crate::error::ModelError;
use crate::evaluate::Wanted;
use crate::pass::Pass;

/// The force of every row.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Predicted reading of the load cell \[N\].
    pub force: Vec<f64>,
    /// Derivatives by the wanted parameters, row by row.
    pub jacobian: Vec<f64>,
    /// dF/d(pressure reading) \[N/Pa\], if wanted.
    pub by_pressure: Vec<f64>,
    /// dF/d(contraction reading) \[N\], if wanted.
    pub by_contraction: Vec<f64>,
}

/// The force of the rows that have a state, and the list of the rows that have none.
#[derive(Debug, Clone)]
pub struct Partly {
    /// The prediction. In rows without a state the force is NaN and the derivatives are 0.
    pub prediction: Prediction,
    /// Rows without a state, in ascending order.
    pub without_state: Vec<usize>,
    /// The error of those rows; none if all rows have a state.
    pub error: Option<ModelError>,
}

/// The rows of one segment in a [`Prediction`].
pub(crate) struct Part<'a> {
    force: &'a mut [f64],
    jacobian: &'a mut [f64],
    by_pressure: &'a mut [f64],
    by_contraction: &'a mut [f64],
}

impl Prediction {
    /// A prediction of zeros, with room for the wanted derivatives.
    pub(crate) fn zero(rows: usize, wanted: &Wanted) -> Self {
        let readings = if wanted.readings { rows } else { 0 };
        Self {
            force: vec![0.0; rows],
            jacobian: vec![0.0; rows * wanted.parameters.len()],
            by_pressure: vec![0.0; readings],
            by_contraction: vec![0.0; readings],
        }
    }

    /// Sets the force to NaN and the derivatives to 0 in rows without a state.
    pub(crate) fn leave_out(&mut self, rows: &[usize]) {
        let columns = self.jacobian.len().checked_div(self.force.len()).unwrap_or(0);
        for row in rows {
            self.force[*row] = f64::NAN;
            self.jacobian[row * columns..(row + 1) * columns].fill(0.0);
            for slopes in [&mut self.by_pressure, &mut self.by_contraction] {
                slopes.iter_mut().skip(*row).take(1).for_each(|slope| *slope = 0.0);
            }
        }
    }

    /// Splits the prediction into one part for each of the consecutive segments.
    pub(crate) fn parts(&mut self, segments: &[Range<usize>], columns: usize) -> Vec<Part<'_>> {
        let readings = !self.by_pressure.is_empty();
        let mut rest =
            [&mut *self.force, &mut *self.jacobian, &mut *self.by_pressure, &mut *self.by_contraction];
        let per_row = [1, columns, usize::from(readings), usize::from(readings)];
        let part = |rows: &Range<usize>| {
            let mut next = 0;
            let [force, jacobian, by_pressure, by_contraction] = rest.each_mut().map(|rest| {
                let count = rows.len() * per_row[next];
                next += 1;
                rest.split_off_mut(..count).unwrap_or_default()
            });
            Part { force, jacobian, by_pressure, by_contraction }
        };
        segments.iter().map(part).collect()
    }
}

impl Part<'_> {
    /// Writes the result of one pass for row `i`.
    pub(crate) fn fill(&mut self, i: usize, number: usize, pass: &Pass, columns: usize, reading: Jet) {
        if number == 0 {
            self.force[i] = reading.value();
        }
        let gradient = reading.gradient();
        for (lane, column) in &pass.columns {
            self.jacobian[i * columns + column] = gradient[*lane];
        }
        if let Some(lane) = pass.pressure_lane {
            self.by_pressure[i] = gradient[lane];
        }
        if let Some(lane) = pass.contraction_lane {
            self.by_contraction[i] = gradient[lane];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_without_a_state_have_no_derivatives() {
        let mut prediction = Prediction {
            force: vec![1.0; 3],
            jacobian: vec![2.0; 6],
            by_pressure: vec![3.0; 3],
            by_contraction: vec![4.0; 3],
        };
        prediction.leave_out(&[1]);
        assert!(prediction.force[1].is_nan() && prediction.force[0] + prediction.force[2] >= 2.0);
        assert_eq!(prediction.jacobian, [2.0, 2.0, 0.0, 0.0, 2.0, 2.0]);
        assert_eq!(prediction.by_pressure, [3.0, 0.0, 3.0]);
        assert_eq!(prediction.by_contraction, [4.0, 0.0, 4.0]);
    }
}
