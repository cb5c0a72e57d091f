//! A model at its parameters on a record: the misfit, and the derivatives of the force by each free
//! parameter.

use bulge_model::{ModelError, Record, Wanted, Warm};

use crate::diagnosis::setpoints::setpoints;
use crate::fit::nuisance::Prepared;
use crate::fit::problem::free;
use crate::vector::minus;

/// Force and derivatives of a model.
pub(crate) struct Tangents {
    /// The history as it was set, at which the columns are evaluated.
    pub(crate) set: Record,
    /// Force at the readings \[N\].
    pub(crate) force: Vec<f64>,
    /// Force at the history as set \[N\].
    pub(crate) force_as_set: Vec<f64>,
    /// Measured less computed force \[N\].
    pub(crate) residual: Vec<f64>,
    /// Indices of the free parameters.
    pub(crate) free: Vec<usize>,
    /// Derivative of the force by each of them, column by column.
    pub(crate) columns: Vec<Vec<f64>>,
    /// Equilibria of the history as set.
    pub(crate) warm: Warm,
}

impl Tangents {
    /// The tangents of a model at parameters `theta`.
    pub(crate) fn of(prepared: &Prepared, theta: &[f64], record: &Record) -> Result<Self, ModelError> {
        let model = &prepared.model;
        let wanted = Wanted { parameters: free(model), readings: false };
        let set = setpoints(record);
        let warm = Warm::new();
        warm.hold();
        let at_set = model.evaluate_warm(&set, theta, &wanted, &warm)?;
        let force = model.evaluate_warm(record, theta, &Wanted::default(), &warm.shared())?.force;
        let residual = minus(record.force(), &force);
        let k = wanted.parameters.len();
        let columns = (0..k).map(|j| at_set.jacobian.iter().skip(j).step_by(k).copied().collect()).collect();
        Ok(Self { set, force, force_as_set: at_set.force, residual, free: wanted.parameters, columns, warm })
    }
}
