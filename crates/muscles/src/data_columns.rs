//! What the columns of a laboratory's files are, where a muscle file says so.

use crate::muscle::Muscle;

impl Muscle {
    /// The same with a column that files of its measurements have: the quantity, and the heading with its unit.
    #[must_use]
    pub fn with_data_column(mut self, quantity: impl Into<String>, column: impl Into<String>) -> Self {
        self.data_columns.push((quantity.into(), column.into()));
        self
    }

    /// Columns that files of its measurements have, as `[data.columns]` states them: quantity and heading, such as `force` and `Force_N [N]`.
    #[must_use]
    pub fn data_columns(&self) -> &[(String, String)] {
        &self.data_columns
    }
}
