//! Columns of a laboratory's files, as a muscle file states them.

use crate::muscle::Muscle;

impl Muscle {
    /// The same muscle with a column of the files of its measurements: the quantity, and the heading with its
    /// unit.
    #[must_use]
    pub fn with_data_column(mut self, quantity: impl Into<String>, column: impl Into<String>) -> Self {
        self.data_columns.push((quantity.into(), column.into()));
        self
    }

    /// Columns of the files of its measurements, as `[data.columns]` states them: quantity and heading, such
    /// as `force` and `Force_N [N]`.
    #[must_use]
    pub fn data_columns(&self) -> &[(String, String)] {
        &self.data_columns
    }
}
