//! A parameter of a model, which a fit may change.

use serde::Serialize;

/// One parameter of one effect (or one coefficient of a law), in SI, for one muscle.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelParameter {
    /// Name of the effect or the law.
    pub effect: String,
    /// Name of the parameter within the effect.
    pub name: String,
    /// Its key in a muscle file.
    pub key: String,
    /// The specimen it belongs to, if each specimen has its own.
    pub specimen: Option<String>,
    /// The start of a fit, or the value in a muscle file.
    pub value: f64,
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
    /// The value at which the effect does nothing.
    pub off: f64,
    /// Mean and standard deviation from the literature.
    pub prior: Option<(f64, f64)>,
    /// The plausible range. A fitted value outside it points to another cause.
    pub plausible: (f64, f64),
    /// Whether the logarithm is fitted.
    pub logarithmic: bool,
    /// The unit in which it is shown.
    pub unit: String,
    /// Size of the unit in SI.
    pub factor: f64,
    /// Whether the value is known: stated in the muscle file, and not to be fitted.
    pub fixed: bool,
    /// Whether a [`crate::Restriction`] holds it at its value. It is then also `fixed`.
    pub held: bool,
    /// Index of the parameter to which a [`crate::Restriction`] ties it. It is then also `fixed`.
    pub tied: Option<usize>,
    /// A description.
    pub about: String,
}

impl ModelParameter {
    /// `effect.name`, with the specimen if there is one.
    #[must_use]
    pub fn label(&self) -> String {
        match &self.specimen {
            Some(specimen) => format!("{}.{}[{specimen}]", self.effect, self.name),
            None => format!("{}.{}", self.effect, self.name),
        }
    }

    /// A value in the shown unit.
    #[must_use]
    pub fn shown(&self, value: f64) -> f64 {
        value / self.factor
    }
}
