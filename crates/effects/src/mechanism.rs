//! Two properties of an effect besides its name: its mechanism, which stands above its family, and how exact
//! its formula can be.

use serde::Serialize;

/// The physical mechanism, above families and formulas. Data may identify the mechanism even if they can't
/// identify the formula.
///
/// A mechanism has families, and the members of a family are formulas for the same thing. All members of a
/// family share its mechanism.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mechanism {
    /// Friction between surfaces: a force against the motion that doesn't depend on the speed.
    DryFriction,
    /// Viscosity: a force that grows with the speed.
    Rate,
    /// Material that yields under load in the course of time, and recovers.
    Relaxation,
    /// A stiffness that changes with cycles, clock or temperature.
    SofteningAndHeat,
    /// Elasticity and loss of the bladder or membrane.
    Rubber,
    /// Fibres and cloth that stretch, aren't equally taut, or stop unfolding.
    ClothAndFibres,
    /// The shape of the cross-section, and the radius at which it is held.
    Section,
    /// Lengths, angles and number of the fibres, and the wall between them.
    FibreGeometry,
    /// The ends, where the muscle can't widen.
    Ends,
    /// Zero and gain between the displacement sensor and the contraction.
    LengthChain,
    /// Compliance of frame, clamps and ends under the force.
    GiveOfTheRig,
    /// Zero, gain, threshold and hysteresis between the pressure sensor and the acting pressure.
    PressureChain,
    /// Regulator and valve that don't hold the pressure.
    Regulator,
    /// Zero, gain, curvature and drift between the force and the reading of the load cell.
    ForceChain,
    /// A reading that lags behind the others.
    LateReading,
    /// Differences between muscles of the same make.
    Specimens,
    /// A user's formula without a stated mechanism. Each such family stands for itself.
    User,
}

impl Mechanism {
    /// The mechanisms of the catalogue: all but [`Mechanism::User`].
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

    /// The mechanism in words. With hyphens in place of blanks this is the name in files and documents.
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
/// The error of the form is the difference that remains between a real effect and the formula with its best
/// parameters, relative to the effect. It is stated as a standard deviation over the states of a test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// Geometry or arithmetic such as a radius or a dead weight: only the parameters can be wrong.
    Exact,
    /// A first term whose next terms are small, such as a nearly steady drift.
    Near,
    /// One of several constitutive laws, for friction, rubber or relaxation, which real materials follow only
    /// roughly; or a gain of force or pressure, which changes over the range of its sensor.
    Loose,
}

impl Form {
    /// All forms, the most exact first.
    pub const ALL: [Self; 3] = [Self::Exact, Self::Near, Self::Loose];

    /// The name in files and documents.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Near => "near",
            Self::Loose => "loose",
        }
    }

    /// The largest standard deviation of the relative error of the form, for each of the ways in which it may
    /// be wrong.
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
