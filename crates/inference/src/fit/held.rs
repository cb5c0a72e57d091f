//! Parameters that a fit didn't change: held at a value, or tied to another parameter.

use bulge_model::{Model, ModelParameter};
use bulge_muscles::units;
use serde::Serialize;

/// A parameter that was held or tied.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HeldNumber {
    /// The effect (or law).
    pub effect: String,
    /// The name within the effect.
    pub name: String,
    /// The specimen, if each has its own parameter.
    pub specimen: Option<String>,
    /// Value in `unit`.
    pub value: f64,
    /// Unit in which the value is shown.
    pub unit: String,
    /// `held` or `tied`.
    pub how: &'static str,
    /// The parameter that it is tied to: `effect.name`, with the specimen if each has its own.
    pub to: Option<String>,
    /// Description.
    pub about: String,
}

/// `effect name = value unit (held)`, or `(tied to other.name)`.
impl std::fmt::Display for HeldNumber {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { effect, name, value, how, .. } = self;
        let unit = if self.unit == "1" { "" } else { self.unit.as_str() };
        let specimen = self.specimen.as_ref().map_or_else(String::new, |own| format!(" [{own}]"));
        let value = format!("{} {unit}", units::rounded(*value, 6));
        write!(f, "{effect} {name}{specimen} = {} (", value.trim_end())?;
        match &self.to {
            Some(to) => write!(f, "tied to {to})"),
            None => write!(f, "{how})"),
        }
    }
}

/// All held and tied parameters of a model with parameters `theta`, in the model's order.
pub(crate) fn held(model: &Model, theta: &[f64]) -> Vec<HeldNumber> {
    let number = |(p, value): (&ModelParameter, &f64)| HeldNumber {
        effect: p.effect.clone(),
        name: p.name.clone(),
        specimen: p.specimen.clone(),
        value: p.shown(*value),
        unit: p.unit.clone(),
        how: if p.tied.is_some() { "tied" } else { "held" },
        to: p.tied.and_then(|to| model.parameters().get(to)).map(ModelParameter::label),
        about: p.about.clone(),
    };
    model.parameters().iter().zip(theta).filter(|(p, _)| p.held || p.tied.is_some()).map(number).collect()
}
