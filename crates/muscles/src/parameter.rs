//! The numbers of a muscle that a sweep or a fit may change, by name.

use crate::construction::Kind;
use crate::quantity::{Angle, Force, Length, LineStiffness, Pressure};
use crate::units::{self, Quantity, UnitError};
use serde::Serialize;

/// A number of a muscle. `Muscle::get` reads it, `Muscle::with` changes it; values are in SI.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Parameter {
    /// Unpressurised length l0 (m).
    Length,
    /// Pleated: fibre radius R at the fittings; braided: braid radius r0 (m).
    Radius,
    /// Radius at the end fittings, if it is stated separately (m).
    FittingRadius,
    /// Braid angle alpha0 (rad).
    BraidAngle,
    /// Number of fibres, a whole number.
    Fibres,
    /// Pleat depth (m).
    PleatDepth,
    /// Misalignment of pleated fibres (rad).
    Misalignment,
    /// Fibre stiffness EA (N).
    FibreStiffness,
    /// First Mooney-Rivlin constant of the bladder (Pa).
    C10,
    /// Second Mooney-Rivlin constant of the bladder (Pa).
    C01,
    /// Wall thickness (m).
    Wall,
    /// Thickness by which the gas stays inside the braid radius (m).
    GasWall,
    /// Hoop stiffness of cloth that limits the unfolding (N/m).
    HoopStiffness,
    /// Radius beyond which the cloth is taut (m).
    UnfoldedRadius,
    /// Circumference of the cloth that bulges in lobes between the fibres (m).
    ClothCircumference,
}

impl Parameter {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::Length,
        Self::Radius,
        Self::FittingRadius,
        Self::BraidAngle,
        Self::Fibres,
        Self::PleatDepth,
        Self::Misalignment,
        Self::FibreStiffness,
        Self::C10,
        Self::C01,
        Self::Wall,
        Self::GasWall,
        Self::HoopStiffness,
        Self::UnfoldedRadius,
        Self::ClothCircumference,
    ];

    /// The name in sweeps, tables and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Length => "length",
            Self::Radius => "radius",
            Self::FittingRadius => "fitting_radius",
            Self::BraidAngle => "braid_angle",
            Self::Fibres => "fibres",
            Self::PleatDepth => "pleat_depth",
            Self::Misalignment => "misalignment",
            Self::FibreStiffness => "fibre_stiffness",
            Self::C10 => "c10",
            Self::C01 => "c01",
            Self::Wall => "wall",
            Self::GasWall => "gas_wall",
            Self::HoopStiffness => "hoop_stiffness",
            Self::UnfoldedRadius => "unfolded_radius",
            Self::ClothCircumference => "cloth_circumference",
        }
    }

    /// The parameter of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|parameter| parameter.name() == name)
    }

    /// Its place in a muscle file.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Length | Self::Radius | Self::BraidAngle | Self::Fibres | Self::Wall => self.name(),
            Self::FittingRadius => "effects.end-radius.radius",
            Self::PleatDepth => "effects.pleat-depth.depth",
            Self::Misalignment => "effects.fibre-misalignment.angle",
            Self::FibreStiffness => "fibre.stiffness",
            Self::C10 => "effects.bladder-elasticity.c10",
            Self::C01 => "effects.bladder-elasticity.c01",
            Self::GasWall => "effects.wall-thickness.thickness",
            Self::HoopStiffness => "effects.limited-unfolding.hoop_stiffness",
            Self::UnfoldedRadius => "effects.limited-unfolding.unfolded_radius",
            Self::ClothCircumference => "effects.lobes.circumference",
        }
    }

    /// The effect whose table in a muscle file holds the parameter, and its key there, if there is one.
    #[must_use]
    pub fn effect(self) -> Option<(&'static str, &'static str)> {
        self.key().strip_prefix("effects.")?.split_once('.')
    }

    /// The parameter under this key in the table `[effects.NAME]`.
    #[must_use]
    pub fn of_effect(name: &str, key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|parameter| parameter.effect() == Some((name, key)))
    }

    /// The effects whose tables hold parameters of the muscle; every other `[effects.NAME]` is a
    /// [`crate::Learnt`] one.
    pub fn effects() -> impl Iterator<Item = &'static str> {
        let is_first = |(i, name): &(usize, &str)| {
            !Self::ALL[..*i].iter().any(|other| other.effect().is_some_and(|(other, _)| other == *name))
        };
        let all = Self::ALL.into_iter().enumerate();
        all.filter_map(|(i, parameter)| Some((i, parameter.effect()?.0)))
            .filter(is_first)
            .map(|(_, name)| name)
    }

    /// The SI unit; "1" for a count.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Length
            | Self::Radius
            | Self::FittingRadius
            | Self::PleatDepth
            | Self::Wall
            | Self::GasWall
            | Self::UnfoldedRadius
            | Self::ClothCircumference => "m",
            Self::BraidAngle | Self::Misalignment => "rad",
            Self::Fibres => "1",
            Self::FibreStiffness => "N",
            Self::C10 | Self::C01 => "Pa",
            Self::HoopStiffness => "N/m",
        }
    }

    /// The family it belongs to, if it belongs to only one.
    #[must_use]
    pub const fn kind(self) -> Option<Kind> {
        match self {
            Self::BraidAngle | Self::C10 | Self::C01 | Self::Wall | Self::GasWall => Some(Kind::Braided),
            Self::PleatDepth | Self::Misalignment | Self::ClothCircumference => Some(Kind::Pleated),
            _ => None,
        }
    }

    /// Reads one value of this parameter, such as "100 mm" for `Length`, into SI.
    ///
    /// # Errors
    /// If the text is not a quantity of the parameter's dimension.
    pub fn parse(self, text: &str) -> Result<f64, UnitError> {
        match self.unit() {
            "rad" => units::parse::<Angle>(text).map(Quantity::si),
            "N" => units::parse::<Force>(text).map(Quantity::si),
            "Pa" => units::parse::<Pressure>(text).map(Quantity::si),
            "N/m" => units::parse::<LineStiffness>(text).map(Quantity::si),
            "1" => units::parse::<crate::quantity::Ratio>(text).map(Quantity::si),
            _ => units::parse::<Length>(text).map(Quantity::si),
        }
    }

    /// A value in SI as it is written in a muscle file, with its unit and quotes. Reading it gives exactly
    /// the same number.
    pub(crate) fn text(self, value: f64) -> String {
        let text = match self.unit() {
            "rad" => units::exact_text(Angle::from_si(value)),
            "N" => units::exact_text_in(Force::from_si(value), "kN"),
            "Pa" => units::exact_text_in(Pressure::from_si(value), "MPa"),
            "N/m" => units::exact_text(LineStiffness::from_si(value)),
            "1" => return value.to_string(),
            _ => units::exact_text(Length::from_si(value)),
        };
        format!("\"{text}\"")
    }

    /// Reads values of this parameter, such as "100,110,120 mm" for `Length` or "20,40" for `Fibres`, into
    /// SI.
    ///
    /// # Errors
    /// If an item is not a quantity of the parameter's dimension.
    pub fn parse_list(self, text: &str) -> Result<Vec<f64>, UnitError> {
        fn si<Q: Quantity>(text: &str) -> Result<Vec<f64>, UnitError> {
            Ok(units::parse_list::<Q>(text)?.into_iter().map(Quantity::si).collect())
        }
        match self.unit() {
            "rad" => si::<Angle>(text),
            "N" => si::<Force>(text),
            "Pa" => si::<Pressure>(text),
            "N/m" => si::<LineStiffness>(text),
            "1" => si::<crate::quantity::Ratio>(text),
            _ => si::<Length>(text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found() {
        for parameter in Parameter::ALL {
            assert_eq!(Parameter::named(parameter.name()), Some(parameter));
            assert_eq!(Parameter::ALL.iter().filter(|other| other.key() == parameter.key()).count(), 1);
        }
        assert_eq!(Parameter::named("lenght"), None);
        assert_eq!(Parameter::of_effect("pleat-depth", "depth"), Some(Parameter::PleatDepth));
        assert_eq!((Parameter::of_effect("pleat-depth", "radius"), Parameter::Wall.effect()), (None, None));
        assert_eq!(Parameter::effects().count(), 7);
    }

    #[test]
    fn lists_in_the_dimension_of_the_parameter() {
        assert_eq!(Parameter::Length.parse_list("100, 110 mm"), Ok(vec![0.1, 0.11]));
        assert_eq!(Parameter::Fibres.parse_list("20,40"), Ok(vec![20.0, 40.0]));
        assert_eq!(Parameter::C10.parse_list("0.2 MPa"), Ok(vec![2e5]));
        assert_eq!(Parameter::FibreStiffness.parse_list("12 kN"), Ok(vec![12e3]));
        assert_eq!(Parameter::HoopStiffness.parse_list("81 N/mm"), Ok(vec![81e3]));
        assert_eq!(Parameter::BraidAngle.parse_list("0.4 rad"), Ok(vec![0.4]));
        assert!(Parameter::Wall.parse_list("2 bar").unwrap_err().to_string().contains("pressure"));
    }
}
