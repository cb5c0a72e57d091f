//! A number of a model that a fit may change.

use serde::Serialize;

/// One number of one effect (or coefficient of a law), in SI, for one muscle.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelParameter {
    /// The effect, or the law.
    pub effect: String,
    /// The name within the effect.
    pub name: String,
    /// Its key in a muscle file.
    pub key: String,
    /// The specimen it belongs to, where each has its own.
    pub specimen: Option<String>,
    /// Value: where a fit starts, or what a muscle file states.
    pub value: f64,
    /// Bounds.
    pub low: f64,
    /// Bounds.
    pub high: f64,
    /// The value at which the effect does nothing.
    pub off: f64,
    /// Mean and standard deviation from the literature.
    pub prior: Option<(f64, f64)>,
    /// Range outside which a value is a symptom, not a cure.
    pub plausible: (f64, f64),
    /// Whether a fit runs over the logarithm.
    pub logarithmic: bool,
    /// Unit in which it is shown, and its size in SI.
    pub unit: String,
    /// Size of the unit in SI.
    pub factor: f64,
    /// Whether the value is taken as known: stated in the muscle file and not asked for.
    pub fixed: bool,
    /// Whether it is held at its value by a [`crate::Restriction`]; it is `fixed` then.
    pub held: bool,
    /// The place of the number whose value it has, by a [`crate::Restriction`]; it is `fixed` then.
    pub tied: Option<usize>,
    /// What it is.
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
