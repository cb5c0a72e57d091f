//! The two levels that a card adds to its name: the mechanism above its family, and how exact its formula can be.

use serde::Serialize;

/// What happens physically, above families and formulas: data may decide it although they don't decide the formula.
///
/// A mechanism has families, a family has members that are formulas of the same thing. Every member of a family has the mechanism of the family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mechanism {
    /// Surfaces that rub on each other: a force against the motion, whatever the speed.
    DryFriction,
    /// Viscosity: a force that grows with the speed.
    Rate,
    /// Material that yields under load with time, and forgets.
    Relaxation,
    /// A stiffness that changes with cycles, clock or temperature.
    SofteningAndHeat,
    /// Elasticity and loss of the bladder or membrane.
    Rubber,
    /// Fibres and cloth that stretch, aren't taut together, or unfold no further.
    ClothAndFibres,
    /// The form of the cross-section, and the radius at which it is held.
    Section,
    /// Lengths, angles and numbers of the fibres, and the wall between them.
    FibreGeometry,
    /// The ends, where the muscle can't widen.
    Ends,
    /// From the displacement sensor to the contraction: zero and gain.
    LengthChain,
    /// Frame, clamps and ends that give under the force.
    GiveOfTheRig,
    /// From the pressure sensor to the pressure that acts: zero, gain, threshold, hysteresis.
    PressureChain,
    /// Regulator and valve: a pressure that isn't held.
    Regulator,
    /// From the force to the reading of the load cell: zero, gain, curvature, drift.
    ForceChain,
    /// A reading that is late against the others.
    LateReading,
    /// Muscles of the same make that differ.
    Specimens,
    /// A formula of the user's whose mechanism isn't stated: each such family stands for itself.
    User,
}

impl Mechanism {
    /// Those that the catalogue knows: all but [`Mechanism::User`].
    pub const ALL: [Self; 16] = [
        Self::DryFriction,
        Self::Rate,
        Self::Relaxation,
        Self::SofteningAndHeat,
        Self::Rubber,
        Self::ClothAndFibres,
        Self::Section,
        Self::FibreGeometry,
        Self::Ends,
        Self::LengthChain,
        Self::GiveOfTheRig,
        Self::PressureChain,
        Self::Regulator,
        Self::ForceChain,
        Self::LateReading,
        Self::Specimens,
    ];

    /// In words; with hyphens for blanks it is the name in files and documents.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::DryFriction => "dry friction",
            Self::Rate => "rate",
            Self::Relaxation => "relaxation",
            Self::SofteningAndHeat => "softening and heat",
            Self::Rubber => "rubber",
            Self::ClothAndFibres => "cloth and fibres",
            Self::Section => "section",
            Self::FibreGeometry => "fibre geometry",
            Self::Ends => "ends",
            Self::LengthChain => "length chain",
            Self::GiveOfTheRig => "give of the rig",
            Self::PressureChain => "pressure chain",
            Self::Regulator => "regulator",
            Self::ForceChain => "force chain",
            Self::LateReading => "late reading",
            Self::Specimens => "specimens",
            Self::User => "user",
        }
    }
}

/// How well the formula of an effect can be expected to describe a real effect of its kind.
///
/// The error of the form is what remains between a real effect and the formula at its best numbers, as a part of the effect: its standard
/// deviation over the states that a test goes through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// Geometry or arithmetic: only its numbers can be wrong. A zero, a gain, a radius.
    Exact,
    /// A first term of what happens whose next terms are small: a drift that is nearly steady.
    Near,
    /// A constitutive law among several: friction, rubber, relaxation. Real ones follow none of them exactly.
    Loose,
}

impl Form {
    /// All of them, the most exact first.
    pub const ALL: [Self; 3] = [Self::Exact, Self::Near, Self::Loose];

    /// As files and documents have it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Near => "near",
            Self::Loose => "loose",
        }
    }

    /// The largest standard deviation of the relative error of the form in each of the ways in which it may be wrong.
    #[must_use]
    pub const fn largest_error(self) -> f64 {
        match self {
            Self::Exact => 0.0,
            Self::Near => 0.05,
            Self::Loose => 0.1,
        }
    }

    /// In words.
    #[must_use]
    pub const fn says(self) -> &'static str {
        match self {
            Self::Exact => "exact: only its numbers can be wrong",
            Self::Near => "near: a real effect of this kind may differ from the formula by 5 %",
            Self::Loose => "loose: a real effect of this kind may differ from the formula by 10 %",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_documents() {
        let written = |value: toml::Value| value.as_str().unwrap().to_owned();
        for mechanism in Mechanism::ALL.into_iter().chain([Mechanism::User]) {
            let found = written(toml::Value::try_from(mechanism).unwrap());
            assert_eq!(found, mechanism.name().replace(' ', "-"));
        }
        for form in Form::ALL {
            assert_eq!(written(toml::Value::try_from(form).unwrap()), form.name());
            assert!(form.says().starts_with(form.name()));
        }
        for (form, percent) in [(Form::Exact, 0.0), (Form::Near, 5.0), (Form::Loose, 10.0)] {
            assert!((100.0 * form.largest_error() - percent).abs() < 1e-12);
            assert_eq!(form.says().contains(&format!("by {percent} %")), percent > 0.0);
        }
    }
}
