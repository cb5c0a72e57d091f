//! Why values do not make a muscle: one variant per event, with its numbers.

use crate::construction::Kind;
use crate::digits::rounded;
use crate::parameter::Parameter;
use crate::quantity::Length;
use thiserror::Error;

/// Why values do not make a muscle. Values are in SI; `key` is the place of the value in a muscle file.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MuscleError {
    /// A value that must be finite and > 0.
    #[error("`{key}` is {} {unit}: it must be finite and greater than 0", rounded(*value, 12))]
    NotPositive {
        /// Where it stands in a muscle file.
        key: &'static str,
        /// The value in SI.
        value: f64,
        /// Its SI unit.
        unit: &'static str,
    },
    /// A value that must be finite and >= 0.
    #[error("`{key}` is {} {unit}: it must be finite and not negative", rounded(*value, 12))]
    Negative {
        /// Where it stands in a muscle file.
        key: &'static str,
        /// The value in SI.
        value: f64,
        /// Its SI unit.
        unit: &'static str,
    },
    /// Too few fibres to enclose a volume.
    #[error("`fibres` says {count}: at least 3 are needed to enclose a volume")]
    TooFewFibres {
        /// The count.
        count: u32,
    },
    /// A number of fibres that is not a whole number from 3 to 4294967295.
    #[error("{value} is not a number of fibres: it must be a whole number of at least 3")]
    FibreCount {
        /// The value.
        value: f64,
    },
    /// A braid angle that makes no braid.
    #[error("`braid_angle` is {degrees} deg: it must lie between 0 deg and 90 deg, both excluded")]
    BraidAngle {
        /// The angle in degrees.
        degrees: f64,
    },
    /// Fibres that do not run from end to end.
    #[error(
        "`effects.fibre-misalignment.angle` is {degrees} deg: it must lie between -90 deg and 90 deg, both excluded"
    )]
    Misalignment {
        /// The angle in degrees.
        degrees: f64,
    },
    /// Both constants of the bladder are zero.
    #[error("the bladder has c10 = {c10} Pa and c01 = {c01} Pa: a rubber needs at least one greater than 0")]
    NoElasticity {
        /// The first Mooney-Rivlin constant.
        c10: f64,
        /// The second Mooney-Rivlin constant.
        c01: f64,
    },
    /// A muscle without a name.
    #[error("`name` is empty: every table and report shows it")]
    NoName,
    /// Elastic fibres of unknown number.
    #[error("`fibre` gives the stiffness of one fibre, but `fibres` does not say how many the braid has")]
    NoFibreCount,
    /// A bladder without thickness.
    #[error("a bladder needs a wall thickness: `wall` is not stated")]
    NoWall,
    /// Gas inside a wall of unknown thickness.
    #[error("the gas acts on the inner wall, but `wall` does not say how thick the wall is")]
    NoGasWall,
    /// No gas is left inside the wall.
    #[error("`{key}` is {:.4} thick, and the braid or its fittings have a radius of {:.4}: it must be thinner than that to leave room for gas", Length::m(*wall_m), Length::m(*radius_m))]
    WallTooThick {
        /// Where it stands in a muscle file.
        key: &'static str,
        /// Thickness of the wall \[m\].
        wall_m: f64,
        /// Radius of the braid, or of its fittings \[m\].
        radius_m: f64,
    },
    /// Lobes between continuous fibres, which have no distance.
    #[error(
        "lobes stand between fibres that can be counted, such as `fibres = 40`: `continuous` fibres have none"
    )]
    LobesOfContinuous,
    /// One part of a limit to the unfolding without the other.
    #[error("`{}` alone does not limit the unfolding: hoop stiffness and unfolded radius are needed together", parameter.name())]
    HalfUnfolding {
        /// The one given.
        parameter: Parameter,
    },
    /// A parameter of the other family.
    #[error("a {} muscle has no `{}`: that belongs to a {} muscle", kind.name(), parameter.name(), owner.name())]
    OtherKind {
        /// The parameter.
        parameter: Parameter,
        /// The family of this muscle.
        kind: Kind,
        /// The family that has it.
        owner: Kind,
    },
    /// An effect of the other family.
    #[error("the effect `{effect}` belongs to {} muscles, and this one is {}", owner.name(), kind.name())]
    EffectOfOtherKind {
        /// Name of the effect.
        effect: String,
        /// The family of this muscle.
        kind: Kind,
        /// The family that has it.
        owner: Kind,
    },
    /// Two formulas for one quantity of the shape.
    #[error(
        "two effects state a formula for the {what} of the wall: write their sum as one formula, or leave one out"
    )]
    TwoFormulas {
        /// The quantity.
        what: &'static str,
    },
    /// A width for a parameter that can't have one.
    #[error("`{}` has no stated value that could have a width", parameter.name())]
    NoWidth {
        /// The parameter.
        parameter: Parameter,
    },
    /// A width that is not finite and >= 0.
    #[error("the width of `{}` is {width} in SI units: it must be finite and not negative", parameter.name())]
    NegativeWidth {
        /// The parameter.
        parameter: Parameter,
        /// The width in SI.
        width: f64,
    },
    /// A learnt effect that can't be written into a file.
    #[error("the effect `{name}` {what}")]
    Learnt {
        /// Name of the effect.
        name: String,
        /// What is wrong with it.
        what: String,
    },
    /// A specimen whose name can't stand in a file.
    #[error(
        "`{name}` can't name a specimen: a name has letters, digits or other signs, but no quotes, backslashes or control characters"
    )]
    SpecimenName {
        /// The name.
        name: String,
    },
    /// An instrument without any standard deviation.
    #[error("an instrument needs at least one of `noise`, `zero` and `gain` greater than 0")]
    NoSpread,
}

impl MuscleError {
    /// Place of the cause in a muscle file, as a dotted path. `name` and `fibre` are such paths, too.
    #[must_use]
    pub fn key(&self) -> &'static str {
        match self {
            Self::NotPositive { key, .. } | Self::Negative { key, .. } | Self::WallTooThick { key, .. } => {
                key
            }
            Self::TooFewFibres { .. } | Self::FibreCount { .. } => "fibres",
            Self::BraidAngle { .. } => "braid_angle",
            Self::Misalignment { .. } => "effects.fibre-misalignment.angle",
            Self::NoElasticity { .. } => "effects.bladder-elasticity.c10",
            Self::NoName => "name",
            Self::NoFibreCount => "fibre",
            Self::NoWall => "effects.bladder-elasticity",
            Self::NoGasWall => "effects.wall-thickness",
            Self::LobesOfContinuous => "effects.lobes",
            Self::HalfUnfolding { .. } => "effects.limited-unfolding",
            Self::OtherKind { parameter, .. }
            | Self::NoWidth { parameter }
            | Self::NegativeWidth { parameter, .. } => parameter.key(),
            Self::Learnt { .. } | Self::EffectOfOtherKind { .. } | Self::TwoFormulas { .. } => "effects",
            Self::SpecimenName { .. } => "specimens",
            Self::NoSpread => "instruments",
        }
    }

    /// The allowed range in words, if one number is out of it.
    #[must_use]
    pub(crate) fn range(&self) -> Option<&'static str> {
        match self {
            Self::NotPositive { .. } => Some("a value greater than 0"),
            Self::Negative { .. } => Some("0 or more"),
            Self::BraidAngle { .. } => Some("an angle between 0 deg and 90 deg"),
            Self::Misalignment { .. } => Some("an angle between -90 deg and 90 deg"),
            _ => None,
        }
    }
}

/// The ranges that several constructors share.
pub mod check {
    use super::MuscleError;
    use crate::units::Quantity;

    /// Refuses a quantity that is not finite and > 0.
    ///
    /// # Errors
    /// [`MuscleError::NotPositive`].
    pub fn positive<Q: Quantity>(key: &'static str, quantity: Q) -> Result<(), MuscleError> {
        let value = quantity.si();
        let holds = value.is_finite() && value > 0.0;
        if holds { Ok(()) } else { Err(MuscleError::NotPositive { key, value, unit: si_unit::<Q>() }) }
    }

    /// Refuses a quantity that is not finite and >= 0.
    ///
    /// # Errors
    /// [`MuscleError::Negative`].
    pub fn not_negative<Q: Quantity>(key: &'static str, quantity: Q) -> Result<(), MuscleError> {
        let value = quantity.si();
        let holds = value.is_finite() && value >= 0.0;
        if holds { Ok(()) } else { Err(MuscleError::Negative { key, value, unit: si_unit::<Q>() }) }
    }

    /// Refuses fewer than three fibres.
    ///
    /// # Errors
    /// [`MuscleError::TooFewFibres`].
    pub fn count(count: u32) -> Result<(), MuscleError> {
        if count >= 3 { Ok(()) } else { Err(MuscleError::TooFewFibres { count }) }
    }

    /// The SI unit is the first in every list.
    fn si_unit<Q: Quantity>() -> &'static str {
        Q::UNITS.first().map_or("", |unit| unit.0)
    }
}
