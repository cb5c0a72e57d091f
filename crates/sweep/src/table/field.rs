//! What is tabulated: outputs over a domain whose first axis may end where the others say.

/// One axis of a domain.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldAxis {
    /// Its name.
    pub name: String,
    /// Its unit; "1" for a pure number.
    pub unit: String,
    /// Lower end.
    pub low: f64,
    /// Upper end; none on axis 0 where [`Field::upper_end`] says it.
    pub high: Option<f64>,
}

/// One output.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldOutput {
    /// Its name.
    pub name: String,
    /// Its unit; "1" for a pure number.
    pub unit: String,
    /// Whether it grows as the inverse root of the distance from the lower end of axis 0.
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
    /// The axes, the one with the movable end first.
    fn axes(&self) -> &[FieldAxis];

    /// The outputs.
    fn outputs(&self) -> &[FieldOutput];

    /// Upper end of axis 0 at values of the others.
    ///
    /// # Errors
    /// If there is none.
    fn upper_end(&self, others: &[f64]) -> Result<f64, NoValue>;

    /// All outputs at a point. Slightly beyond the upper end they go on smoothly.
    ///
    /// # Errors
    /// If there is no value.
    fn values(&self, point: &[f64], values: &mut [f64]) -> Result<(), NoValue>;

    /// All outputs and their derivatives by the axes: `gradients[o * axes + i]`.
    ///
    /// # Errors
    /// If there is no value, or none beside it.
    fn gradients(&self, point: &[f64], values: &mut [f64], gradients: &mut [f64]) -> Result<(), NoValue>;
}
