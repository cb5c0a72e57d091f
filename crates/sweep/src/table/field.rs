//! Fields that can be tabulated: outputs over a domain. The upper end of the first axis may depend on the
//! other axes.

/// One axis of a domain.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldAxis {
    /// Its name.
    pub name: String,
    /// Its unit; "1" for a pure number.
    pub unit: String,
    /// Lower end.
    pub low: f64,
    /// Upper end. None on axis 0 if it depends on the other axes; [`Field::upper_end`] then gives it.
    pub high: Option<f64>,
}

/// One output.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldOutput {
    /// Its name.
    pub name: String,
    /// Its unit; "1" for a pure number.
    pub unit: String,
    /// Whether it grows like the inverse square root of the distance from the lower end of axis 0.
    pub is_singular: bool,
    /// Whether it vanishes at the upper end of axis 0.
    pub vanishes: bool,
}

/// Why an output has no value at a point of the domain.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoValue(pub String);

/// Smooth outputs over a domain: a family of muscles, or a joint.
pub trait Field: Sync {
    /// The axes; the axis with the movable end comes first.
    fn axes(&self) -> &[FieldAxis];

    /// The outputs.
    fn outputs(&self) -> &[FieldOutput];

    /// Upper end of axis 0 at the given values of the other axes.
    ///
    /// # Errors
    /// If there is none.
    fn upper_end(&self, others: &[f64]) -> Result<f64, NoValue>;

    /// All outputs at a point. They continue smoothly slightly beyond the upper end.
    ///
    /// # Errors
    /// If there is no value.
    fn values(&self, point: &[f64], values: &mut [f64]) -> Result<(), NoValue>;

    /// All outputs and their derivatives by the axes: `gradients[o * axes + i]`.
    ///
    /// # Errors
    /// If there is no value at the point or next to it.
    fn gradients(&self, point: &[f64], values: &mut [f64], gradients: &mut [f64]) -> Result<(), NoValue>;
}
