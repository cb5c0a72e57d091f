//! The card of an effect: the information that people, fits, rankings and reports need about it.

use bulge_muscles::{Kind, Muscle, Parameter};
use serde::Serialize;

use crate::mechanism::{Form, Mechanism};

/// For [`Card::kind`]: an effect of pleated muscles only.
pub const PLEATED: Option<Kind> = Some(Kind::Pleated);
/// For [`Card::kind`]: an effect of braided muscles only.
pub const BRAIDED: Option<Kind> = Some(Kind::Braided);

/// The stage of an effect in the chain from reading to reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// It changes the muscle whose equilibrium is solved: geometry and material.
    Shape,
    /// It changes the input of that muscle: the true pressure and contraction behind the readings, or the way
    /// the equilibrium is evaluated.
    Input,
    /// It adds a force to that of the equilibrium.
    Load,
    /// It changes the reading of the load cell.
    Output,
}

/// The group of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// Dimensions and directions.
    Geometry,
    /// Elasticity of fibres, bladder and cloth.
    Material,
    /// Friction, rate, time, temperature, thresholds.
    Load,
    /// Sensors and frame.
    Rig,
    /// Differences between muscles of the same make.
    Specimen,
}

impl Group {
    /// All groups in the order of the catalogue.
    pub const ALL: [Self; 5] = [Self::Geometry, Self::Material, Self::Load, Self::Rig, Self::Specimen];

    /// The heading.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Geometry => "geometry",
            Self::Material => "material",
            Self::Load => "load",
            Self::Rig => "rig",
            Self::Specimen => "specimen",
        }
    }
}

/// The reliability of a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Evidence {
    /// Printed in one of the five source papers S1 to S5, with the errata corrected.
    Paper,
    /// Derived from the equilibrium equations and checked numerically.
    Derived,
    /// Read in a public source other than the five papers.
    LookedUp,
    /// Recalled from the literature. The formula was derived again where possible; the constants were not
    /// checked against the source.
    Literature,
    /// Stated by the user.
    User,
}

impl Evidence {
    /// In words.
    #[must_use]
    pub const fn says(self) -> &'static str {
        match self {
            Self::Paper => "printed in a source paper",
            Self::Derived => "derived, checked numerically",
            Self::LookedUp => "read in a public source",
            Self::Literature => "known from the literature, constants not read again",
            Self::User => "stated by the user",
        }
    }
}

/// Parity in the direction of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Parity {
    /// The same while shortening and lengthening.
    Even,
    /// Changes sign with the direction.
    Odd,
    /// Neither.
    Mixed,
}

/// The signature of an effect in a residual F - F_model(p, eps, direction).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Signature<'a> {
    /// Power of the pressure, in words: "0", "1", "2", "0 and 1".
    pub pressure: &'a str,
    /// Parity in the direction of motion.
    pub parity: Parity,
    /// Dependence on the contraction (and time, rate, temperature) in words.
    pub shape: &'a str,
}

/// Another effect that data may not distinguish from this one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Twin<'a> {
    /// Its name.
    pub name: &'a str,
    /// How similar it is: "identical", "0.98 after calibration".
    pub how: &'a str,
}

/// A card without its parameters, which are [`crate::Effect::parameters`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Card<'a> {
    /// Name in commands, files and reports: lower-case words with hyphens.
    pub name: &'a str,
    /// The family under which it counts. The first member of a family has the family's name.
    pub family: &'a str,
    /// The physical mechanism, which all members of a family share.
    pub mechanism: Mechanism,
    /// How exact the formula can be.
    pub form: Form,
    /// A heading.
    pub title: &'a str,
    /// The physical process, in two or three sentences.
    pub about: &'a str,
    /// The equation, in plain text.
    pub equation: &'a str,
    /// The source of the equation.
    pub source: &'a str,
    /// The reliability of the source.
    pub evidence: Evidence,
    /// The group.
    pub group: Group,
    /// The kind of muscle that has the effect; none if both have it.
    pub kind: Option<Kind>,
    /// The signature in a residual.
    pub signature: Signature<'a>,
    /// The effects with which it is confused.
    pub twins: &'a [Twin<'a>],
    /// The experiment that distinguishes it from its twins.
    pub separate: &'a str,
    /// Columns beyond pressure, contraction and force without which the effect cannot be seen.
    pub needs: Needs,
}

/// The data that are needed for an effect to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Needs {
    /// Nothing: a static map will do.
    Nothing,
    /// A path: rows in the order of measurement, shortening and lengthening.
    Path,
    /// A path on which the length or the pressure reverses.
    Motion,
    /// A path with time on which the pressure rises and falls.
    PressurePath,
    /// A path with time.
    Time,
    /// Time or cycles.
    Cycles,
    /// A column `temperature` that changes.
    Temperature,
    /// Two specimens or more.
    Specimens,
}

impl Needs {
    /// In words.
    #[must_use]
    pub const fn says(self) -> &'static str {
        match self {
            Self::Nothing => "any force map",
            Self::Path => "a path: rows in the order of measurement, the length in both directions",
            Self::Motion => "a path: rows in the order of measurement, length or pressure in both directions",
            Self::PressurePath => "a path with a column `time` on which the pressure rises and falls",
            Self::Time => "a path with a column `time`",
            Self::Cycles => "several cycles of the same path",
            Self::Temperature => "a column `temperature` that changes",
            Self::Specimens => "a column `specimen` with two or more specimens",
        }
    }
}

/// One parameter of an effect.
///
/// `low`, `high`, `typical`, `off` and `prior` are in SI. If `relative_to` names a number of the muscle, they
/// are multiples of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ParameterCard<'a> {
    /// The name in results.
    pub name: &'a str,
    /// The key in the table `[effects.NAME]` of a muscle file; by default the name.
    pub key: &'a str,
    /// The unit in which it is shown and written, such as "MPa".
    pub unit: &'a str,
    /// Size of that unit in SI.
    pub factor: f64,
    /// Lower bound of a fit.
    pub low: f64,
    /// Upper bound of a fit.
    pub high: f64,
    /// The usual value from which a fit starts.
    pub typical: f64,
    /// The value at which the effect does nothing.
    pub off: f64,
    /// Mean and standard deviation from the literature, in the same units.
    pub prior: Option<(f64, f64)>,
    /// The plausible range; by default the bounds. A fitted value outside it points to another cause.
    pub plausible: Option<(f64, f64)>,
    /// The number of the muscle of which the values are multiples.
    pub relative_to: Option<Parameter>,
    /// Whether the logarithm is fitted. This suits positive parameters that may differ by orders of
    /// magnitude.
    pub logarithmic: bool,
    /// Whether results also show the reciprocal: its name, its unit and the size of the unit in SI.
    pub reciprocal: Option<(&'a str, &'a str, f64)>,
    /// Whether a muscle file may leave it out. The value is then `off`, as in files from before the effect
    /// had this parameter.
    pub may_be_absent: bool,
    /// A description.
    pub about: &'a str,
}

impl<'a> ParameterCard<'a> {
    /// A parameter with its unit (and the size of the unit in SI). Bounds and usual value are in that unit,
    /// and `off` is 0.
    #[must_use]
    pub const fn new(
        name: &'a str,
        (unit, factor): (&'a str, f64),
        (low, high): (f64, f64),
        typical: f64,
        about: &'a str,
    ) -> Self {
        Self {
            name,
            key: name,
            unit,
            factor,
            low: low * factor,
            high: high * factor,
            typical: typical * factor,
            off: 0.0,
            prior: None,
            plausible: None,
            relative_to: None,
            logarithmic: false,
            reciprocal: None,
            may_be_absent: false,
            about,
        }
    }

    /// A multiple of one of the muscle's own numbers, with `off` at 1. It is shown in `unit`.
    #[must_use]
    pub const fn multiple(
        name: &'a str,
        (unit, factor): (&'a str, f64),
        parameter: Parameter,
        (low, high): (f64, f64),
        about: &'a str,
    ) -> Self {
        let base = Self::new(name, (unit, factor), (0.0, 0.0), 0.0, about);
        Self { low, high, typical: 1.0, off: 1.0, relative_to: Some(parameter), ..base }
    }

    /// Sets the prior mean and standard deviation, in the shown unit (or as multiples).
    #[must_use]
    pub const fn prior(self, mean: f64, sd: f64) -> Self {
        let factor = if self.relative_to.is_some() { 1.0 } else { self.factor };
        Self { prior: Some((mean * factor, sd * factor)), ..self }
    }

    /// Sets the plausible range, in the shown unit (or as multiples).
    #[must_use]
    pub const fn plausible(self, low: f64, high: f64) -> Self {
        let factor = if self.relative_to.is_some() { 1.0 } else { self.factor };
        Self { plausible: Some((low * factor, high * factor)), ..self }
    }

    /// Has the logarithm fitted.
    #[must_use]
    pub const fn logarithmic(self) -> Self {
        Self { logarithmic: true, ..self }
    }

    /// Sets another key for muscle files.
    #[must_use]
    pub const fn key(self, key: &'a str) -> Self {
        Self { key, ..self }
    }

    /// Allows muscle files to leave the parameter out.
    #[must_use]
    pub const fn off_if_absent(self) -> Self {
        Self { may_be_absent: true, ..self }
    }

    /// Sets the value at which the effect does nothing, in the shown unit (or as a multiple).
    #[must_use]
    pub const fn off_at(self, off: f64) -> Self {
        let factor = if self.relative_to.is_some() { 1.0 } else { self.factor };
        Self { off: off * factor, ..self }
    }

    /// Has the reciprocal shown as well.
    #[must_use]
    pub const fn reciprocal(self, name: &'a str, unit: &'a str, factor: f64) -> Self {
        Self { reciprocal: Some((name, unit, factor)), ..self }
    }

    /// The card for one muscle, with multiples converted to SI values.
    ///
    /// A multiple of a number that the muscle doesn't have stays a multiple of 1.
    #[must_use]
    pub fn of(self, muscle: &Muscle) -> Self {
        let Some(parameter) = self.relative_to else { return self };
        let scale = muscle.get(parameter).unwrap_or(1.0);
        let pair = |(a, b): (f64, f64)| (a * scale, b * scale);
        Self {
            low: self.low * scale,
            high: self.high * scale,
            typical: self.typical * scale,
            off: self.off * scale,
            prior: self.prior.map(pair),
            plausible: self.plausible.map(pair),
            relative_to: None,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_muscles::preset;

    /// Multiples of the rest length become metres; absolute numbers are kept in the unit in which they are stated.
    #[test]
    fn cards_are_in_si_for_a_muscle() {
        let muscle = preset("dmsp-20-250").unwrap();
        let multiple = ParameterCard::multiple("l", ("mm", 1e-3), Parameter::Length, (0.5, 2.0), "a length")
            .prior(1.0, 0.1);
        let multiple = multiple.plausible(0.8, 1.2).off_at(0.96);
        let of = multiple.of(&muscle);
        let close = |found: f64, of_length: f64| (found - 0.25 * of_length).abs() < 1e-15;
        assert!(close(of.low, 0.5) && close(of.high, 2.0) && close(of.typical, 1.0) && close(of.off, 0.96));
        let (mean, sd) = of.prior.unwrap();
        let (low, high) = of.plausible.unwrap();
        assert!(close(mean, 1.0) && close(sd, 0.1) && close(low, 0.8) && close(high, 1.2));
        assert!(of.relative_to.is_none() && multiple.relative_to.is_some());
        let force =
            ParameterCard::new("f", ("kN", 1e3), (0.0, 2.0), 1.0, "a force").prior(1.0, 0.5).off_at(0.1);
        let force = force.plausible(0.5, 1.5).key("force").reciprocal("g", "1/kN", 1e-3).of(&muscle);
        assert_eq!((force.low, force.high, force.typical, force.off), (0.0, 2e3, 1e3, 100.0));
        assert_eq!((force.prior, force.plausible), (Some((1e3, 500.0)), Some((500.0, 1.5e3))));
        assert_eq!((force.key, force.reciprocal), ("force", Some(("g", "1/kN", 1e-3))));
    }
}
