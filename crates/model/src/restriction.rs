//! Restrictions on a model's parameters before a fit: a parameter is held at a value, kept within narrower
//! bounds, or tied to another parameter.
//!
//! ```text
//! held    x = v                      no longer fitted
//! within  low <= x <= high           fitted, within these bounds and its own
//! tied    x = y                      not fitted itself: dF/dy is then dF/dy + dF/dx
//! ```
//! Restrictions refer to parameters by name. A restriction has no effect while the model lacks the parameter.
//! It applies as soon as the parameter's effect is added.

use serde::Serialize;
use std::borrow::Cow;

use crate::evaluate::Wanted;
use crate::model::Model;
use crate::parameter::ModelParameter;
use crate::prediction::Prediction;

/// The name of a parameter of a model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NumberName {
    /// Name of the effect or the law.
    pub effect: String,
    /// Name of the parameter within the effect.
    pub name: String,
    /// The specimen it belongs to; if none, the parameters of all specimens are meant.
    pub specimen: Option<String>,
}

/// The restriction on a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Says {
    /// It is held at this value \[SI\].
    Held(f64),
    /// It lies between these bounds \[SI\].
    Within([f64; 2]),
    /// It equals another parameter.
    Tied(NumberName),
}

/// A restriction and the parameter it applies to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Restriction {
    /// The parameter.
    pub number: NumberName,
    /// The restriction.
    pub says: Says,
}

impl NumberName {
    /// Whether the name refers to a parameter of a model.
    #[must_use]
    pub fn is_of(&self, parameter: &ModelParameter) -> bool {
        self.effect == parameter.effect
            && self.name == parameter.name
            && self.specimen.as_ref().is_none_or(|own| parameter.specimen.as_ref() == Some(own))
    }
}

impl std::fmt::Display for NumberName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { effect, name, specimen } = self;
        match specimen {
            Some(specimen) => write!(f, "{effect}.{name}[{specimen}]"),
            None => write!(f, "{effect}.{name}"),
        }
    }
}

impl Model {
    /// Restricts parameters of the model, including those of effects added later. A later restriction on the
    /// same parameter replaces an earlier one. Known parameters keep their values.
    #[must_use]
    pub fn restricted(mut self, restrictions: &[Restriction]) -> Self {
        self.restrictions = restrictions.into();
        self.restrict(0);
        self
    }

    /// Whether a restriction refers to one of this model's parameters.
    #[must_use]
    pub fn mentions(&self, restriction: &Restriction) -> bool {
        self.parameters().iter().any(|p| restriction.number.is_of(p))
    }

    /// Whether a restriction is in force for one of this model's parameters.
    #[must_use]
    pub fn has(&self, restriction: &Restriction) -> bool {
        let is_meant = |p: &&ModelParameter| restriction.number.is_of(p);
        match &restriction.says {
            Says::Held(_) => self.parameters().iter().filter(is_meant).any(|p| p.held),
            Says::Within(_) => self.parameters().iter().filter(is_meant).any(|p| !p.fixed),
            Says::Tied(_) => self.parameters().iter().filter(is_meant).any(|p| p.tied.is_some()),
        }
    }

    /// Applies the restrictions to the parameters from an index on, and every tie whose two parameters now
    /// exist.
    pub(crate) fn restrict(&mut self, from: usize) {
        let restrictions = std::sync::Arc::clone(&self.restrictions);
        for Restriction { number, says } in restrictions.iter() {
            for place in from..self.parameters.len() {
                let p = &mut self.parameters[place];
                // Coefficients of a law that isn't fitted are known, and so are values from a file.
                if p.fixed && !p.held || !number.is_of(p) {
                    continue;
                }
                match says {
                    Says::Held(value) => (p.value, p.fixed, p.held) = (*value, true, true),
                    Says::Within([low, high]) => p.narrow([*low, *high]),
                    Says::Tied(_) => {}
                }
            }
        }
        for Restriction { number, says } in restrictions.iter() {
            // Ties come last, because a tie copies the value of its source.
            let Says::Tied(to) = says else { continue };
            for place in 0..self.parameters.len() {
                let p = &self.parameters[place];
                if !p.fixed && number.is_of(p) {
                    self.tie(place, to);
                }
            }
        }
    }

    /// Ties a parameter to another one, if that exists. If each specimen has its own, it is the one of the
    /// same specimen.
    fn tie(&mut self, place: usize, to: &NumberName) {
        let own = self.parameters[place].specimen.clone();
        let is_source = |p: &ModelParameter| {
            to.is_of(p) && (to.specimen.is_some() || p.specimen.is_none() || p.specimen == own)
        };
        let Some(mut source) = self.parameters.iter().position(is_source) else { return };
        // Following ties to their source avoids chains of ties.
        while let Some(next) = self.parameters[source].tied {
            source = next;
        }
        // A circle of ties is ignored.
        if source == place {
            return;
        }
        let bounds = [self.parameters[place].low, self.parameters[place].high];
        self.parameters[source].narrow(bounds);
        let value = self.parameters[source].value;
        // Parameters tied to this one are now tied to its source.
        for (at, p) in self.parameters.iter_mut().enumerate() {
            if at == place || p.tied == Some(place) {
                (p.tied, p.fixed, p.value) = (Some(source), true, value);
            }
        }
    }

    /// Whether any parameter is tied to another.
    fn has_ties(&self) -> bool {
        self.parameters().iter().any(|p| p.tied.is_some())
    }

    /// The values with those of tied parameters replaced by the values they are tied to.
    #[must_use]
    pub fn with_ties<'t>(&self, theta: &'t [f64]) -> Cow<'t, [f64]> {
        if !self.has_ties() || theta.len() != self.parameters().len() {
            return Cow::Borrowed(theta);
        }
        let value = |(place, p): (usize, &ModelParameter)| theta[p.tied.unwrap_or(place)];
        Cow::Owned(self.parameters().iter().enumerate().map(value).collect())
    }

    /// The derivatives that must be evaluated: the wanted parameters, followed by those tied to them.
    pub(crate) fn wanted_with_ties<'w>(&self, wanted: &'w Wanted) -> Cow<'w, Wanted> {
        let is_moved = |p: &ModelParameter| p.tied.is_some_and(|to| wanted.parameters.contains(&to));
        let tied: Vec<usize> =
            (0..self.parameters().len()).filter(|place| is_moved(&self.parameters()[*place])).collect();
        if tied.is_empty() {
            return Cow::Borrowed(wanted);
        }
        let parameters = wanted.parameters.iter().copied().chain(tied).collect();
        Cow::Owned(Wanted { parameters, readings: wanted.readings })
    }

    /// Adds the derivatives by tied parameters to those by the parameters they are tied to.
    pub(crate) fn folded(&self, mut prediction: Prediction, wanted: &Wanted, found: &Wanted) -> Prediction {
        let (k, all) = (wanted.parameters.len(), found.parameters.len());
        if all == k {
            return prediction;
        }
        let column_of = |place: &usize| {
            let to = self.parameters()[*place].tied?;
            wanted.parameters.iter().position(|other| *other == to)
        };
        let into: Vec<Option<usize>> = found.parameters[k..].iter().map(column_of).collect();
        let mut jacobian = Vec::with_capacity(prediction.force.len() * k);
        for row in prediction.jacobian.chunks_exact(all) {
            let start = jacobian.len();
            jacobian.extend_from_slice(&row[..k]);
            for (slope, column) in row[k..].iter().zip(&into) {
                if let Some(column) = column {
                    jacobian[start + column] += slope;
                }
            }
        }
        prediction.jacobian = jacobian;
        prediction
    }
}

impl ModelParameter {
    /// Also keeps the parameter within these bounds.
    fn narrow(&mut self, [low, high]: [f64; 2]) {
        (self.low, self.high) = (self.low.max(low), self.high.min(high));
        if !self.fixed && self.low <= self.high {
            self.value = self.value.clamp(self.low, self.high);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Record;
    use bulge_effects::{Catalogue, Moment};
    use bulge_muscles::from_toml;

    const BRAID: &str = "name = \"b\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nwall = \"1.8 mm\"\nbraid_angle = \"25 deg\"\nends = \"clamped\"\n";

    fn name(text: &str) -> NumberName {
        let (effect, name) = text.split_once('.').unwrap();
        NumberName { effect: effect.to_owned(), name: name.to_owned(), specimen: None }
    }

    fn model(effects: &[&str], restrictions: &[(&str, Says)]) -> Model {
        let catalogue = Catalogue::builtin();
        let restrictions: Vec<Restriction> = restrictions
            .iter()
            .map(|(text, says)| Restriction { number: name(text), says: says.clone() })
            .collect();
        let base = Model::new(&from_toml(BRAID, "b").unwrap()).restricted(&restrictions);
        effects.iter().fold(base, |model, effect| model.with(catalogue.find(effect).unwrap(), None).unwrap())
    }

    fn record() -> Record {
        let moment = |i: u32| Moment {
            direction: if i < 20 { 1.0 } else { -1.0 },
            begins: i == 0,
            ..Moment::at_rest(2e5 + 2e3 * f64::from(i), 0.02 + 0.004 * f64::from(i))
        };
        let moments = (0..40).map(moment).collect();
        Record::from_moments(moments, vec![0.0; 40], std::iter::once(0..40).collect()).unwrap()
    }

    #[test]
    fn numbers_are_held_bounded_and_tied_as_they_come() {
        let effects = ["coulomb-friction", "force-offset", "pressure-offset"];
        let says = [
            ("coulomb-friction.force", Says::Tied(name("force-offset.offset"))),
            ("force-offset.offset", Says::Within([2.0, 7.0])),
            ("pressure-offset.offset", Says::Held(1500.0)),
        ];
        let partly = model(&effects[..1], &says);
        assert!(!partly.parameters()[0].fixed && partly.parameters()[0].tied.is_none());
        let whole = model(&effects, &says);
        let [friction, offset, pressure] = whole.parameters() else { panic!("three numbers") };
        assert_eq!((friction.tied, friction.fixed, friction.held), (Some(1), true, false));
        assert!(!offset.fixed && (offset.low - 2.0).abs() + (offset.high - 7.0).abs() < 1e-12);
        assert!((offset.value - 2.0).abs() < 1e-12 && (friction.value - 2.0).abs() < 1e-12);
        assert!(pressure.held && (pressure.value - 1500.0).abs() < 1e-12);
        assert_eq!(whole.with_ties(&[9.0, 3.0, 1500.0]).to_vec(), [3.0, 3.0, 1500.0]);
        // A missing parameter leaves the model free, a known one stays known, and ties follow ties.
        let known =
            model(&[], &says).with(Catalogue::builtin().find("coulomb-friction").unwrap(), Some(&[5.0]));
        assert!((known.unwrap().parameters()[0].value - 5.0).abs() < 1e-12);
        let chain = model(
            &["coulomb-friction", "force-offset", "presliding-hysteresis"],
            &[
                ("force-offset.offset", Says::Tied(name("presliding-hysteresis.force"))),
                ("coulomb-friction.force", Says::Tied(name("force-offset.offset"))),
            ],
        );
        let root = chain.parameters().iter().position(|p| p.effect == "presliding-hysteresis").unwrap();
        assert_eq!([chain.parameters()[0].tied, chain.parameters()[1].tied], [Some(root); 2]);
    }

    /// Numbers of all specimens can follow one that they share; a shared one can't follow those of specimens, which differ.
    #[test]
    fn ties_across_specimens() {
        let muscle = from_toml(&format!("{BRAID}[specimens.2]\nlength = \"80 mm\"\n"), "b").unwrap();
        let catalogue = Catalogue::builtin();
        let tied = |number: &str, to: &str| {
            let restriction = Restriction { number: name(number), says: Says::Tied(name(to)) };
            let base = Model::new(&muscle).for_specimens(&["1".to_owned(), "2".to_owned()]).unwrap();
            let model = ["coulomb-friction", "force-offset"]
                .into_iter()
                .fold(base.restricted(&[restriction]), |model, effect| {
                    model.with(catalogue.find(effect).unwrap(), None).unwrap()
                });
            model.parameters().iter().map(|p| p.tied).collect::<Vec<_>>()
        };
        assert_eq!(tied("force-offset.offset", "coulomb-friction.force"), [None, Some(0), Some(0)]);
        assert_eq!(tied("coulomb-friction.force", "force-offset.offset"), [None; 3]);
    }

    /// The derivative by a parameter is the sum of those by all parameters tied to it, for load effects and
    /// for shape effects.
    #[test]
    fn derivatives_are_those_of_both_numbers_together() {
        for (effects, tied, to) in [
            (["coulomb-friction", "force-offset"], "coulomb-friction.force", "force-offset.offset"),
            (["bladder-elasticity", "bladder-c01"], "bladder-c01.modulus", "bladder-elasticity.modulus"),
        ] {
            let (free, tied) = (model(&effects, &[]), model(&effects, &[(tied, Says::Tied(name(to)))]));
            let source = tied.parameters().iter().position(|p| p.tied.is_none() && to.starts_with(&p.effect));
            let other = tied.parameters().iter().position(|p| p.tied.is_some());
            let (source, other) = (source.unwrap(), other.unwrap());
            let mut theta = tied.start();
            theta[source] = if effects[1] == "bladder-c01" { 4e4 } else { 6.0 };
            let wanted = Wanted { parameters: vec![source], readings: false };
            let found = tied.evaluate(&record(), &theta, &wanted).unwrap();
            let both = tied.with_ties(&theta).to_vec();
            let wanted = Wanted { parameters: vec![source, other], readings: false };
            let apart = free.evaluate(&record(), &both, &wanted).unwrap();
            assert_eq!(found.force, apart.force);
            assert_eq!(found.jacobian.len(), 40);
            for (row, slope) in found.jacobian.iter().enumerate() {
                let sum = apart.jacobian[2 * row] + apart.jacobian[2 * row + 1];
                assert!((slope - sum).abs() <= 1e-12 * sum.abs(), "{row}: {slope} {sum}");
            }
            assert!(found.jacobian.iter().any(|slope| slope.abs() > 0.0));
        }
    }
}
