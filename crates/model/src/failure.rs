//! Rows without a force: the reasons and the error that reports them.

use bulge_fibre::{Approach, FibreError, Problem};
use bulge_muscles::Pressure;

use crate::error::ModelError;
use crate::model::Model;
use crate::record::Record;

/// Why a row has no force.
pub(crate) enum RowError {
    Solver { pressure: f64, contraction: f64, source: FibreError },
    NotFinite,
}

impl Model {
    /// Adds to the error the limit that its first row exceeds, if that is the reason. This takes a search,
    /// which the evaluations of a fit skip.
    #[must_use]
    pub fn explained(&self, record: &Record, theta: &[f64], error: ModelError) -> ModelError {
        let ModelError::NoEquilibrium { rows, pressure_pa, contraction, source } = error else {
            return error;
        };
        let specimen = rows.first().and_then(|row| record.moments().get(*row)).map_or(0, |m| m.specimen);
        let parts = self.parts_of(self.body_of(specimen), theta).ok();
        let problem = parts.and_then(|parts| Problem::new(parts, Pressure::pa(pressure_pa)).ok());
        let source = match problem {
            Some(problem) => Box::new(problem.explained(*source, contraction, Approach::Auto)),
            None => source,
        };
        ModelError::NoEquilibrium { rows, pressure_pa, contraction, source }
    }
}

/// Combines all failed rows into one error.
pub(crate) fn failure(failed: Vec<(usize, RowError)>) -> ModelError {
    let mut rows = Vec::with_capacity(failed.len());
    let mut first = None;
    for (row, error) in failed {
        rows.push(row);
        if let (None, RowError::Solver { .. }) = (&first, &error) {
            first = Some(error);
        }
    }
    match first {
        Some(RowError::Solver { pressure, contraction, source }) => {
            ModelError::NoEquilibrium { rows, pressure_pa: pressure, contraction, source: Box::new(source) }
        }
        _ => ModelError::NotFinite { rows, what: "look at the readings of these rows and at the parameters" },
    }
}
