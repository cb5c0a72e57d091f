//! The numbers of a muscle that a sweep or a fit may change, by name.

use crate::construction::Kind;
use crate::error::MuscleError;
use crate::quantity::{Angle, Force, Length, LineStiffness, Pressure, Ratio};
use crate::units::{self, UnitError, Wanted};
use serde::Serialize;
use std::f64::consts::FRAC_PI_2;

/// Everything that is to be known about a parameter.
#[derive(Clone, Copy)]
struct Facts {
    name: &'static str,
    key: &'static str,
    kind: Option<Kind>,
    wanted: &'static Wanted,
    /// The unit in which a muscle file is written.
    unit: &'static str,
    range: Range,
}

/// The values that a parameter may have, in SI.
#[derive(Clone, Copy)]
enum Range {
    Positive,
    NotNegative,
    Count,
    BraidAngle,
    Misalignment,
}

/// The table of the parameters: name in sweeps, place in a muscle file, family, quantity and unit there, range.
macro_rules! parameters {
    ($($(#[$about:meta])* $variant:ident = $name:literal, $key:literal, $kind:expr, $quantity:ty, $unit:literal, $range:ident;)*) => {
        /// A number of a muscle. `Muscle::get` reads it, `Muscle::with` changes it; values are in SI.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Parameter {
            $($(#[$about])* $variant,)*
        }

        impl Parameter {
            /// All of them.
            pub const ALL: [Self; 15] = [$(Self::$variant),*];

            const fn facts(self) -> Facts {
                match self {
                    $(Self::$variant => Facts {
                        name: $name,
                        key: $key,
                        kind: $kind,
                        wanted: Wanted::of::<$quantity>(),
                        unit: $unit,
                        range: Range::$range,
                    },)*
                }
            }
        }
    };
}

const BRAIDED: Option<Kind> = Some(Kind::Braided);
const PLEATED: Option<Kind> = Some(Kind::Pleated);

parameters! {
    /// Unpressurised length l0 (m).
    Length = "length", "length", None, Length, "mm", Positive;
    /// Pleated: fibre radius R at the fittings; braided: braid radius r0 (m).
    Radius = "radius", "radius", None, Length, "mm", Positive;
    /// Radius at the end fittings, if it is stated separately (m).
    FittingRadius = "fitting_radius", "effects.end-radius.radius", None, Length, "mm", Positive;
    /// Braid angle alpha0 (rad).
    BraidAngle = "braid_angle", "braid_angle", BRAIDED, Angle, "deg", BraidAngle;
    /// Number of fibres, a whole number.
    Fibres = "fibres", "fibres", None, Ratio, "", Count;
    /// Distance of the pleats outside the fibres under pressure (m); 0 if not stated.
    PleatDepth = "pleat_depth", "effects.pleat-depth.depth", PLEATED, Length, "mm", NotNegative;
    /// Misalignment of pleated fibres (rad): the angle at which they leave the end fittings, in a slight helix;
    /// 0 if not stated.
    Misalignment = "misalignment", "effects.fibre-misalignment.angle", PLEATED, Angle, "deg", Misalignment;
    /// Fibre stiffness EA (N).
    FibreStiffness = "fibre_stiffness", "fibre.stiffness", None, Force, "kN", Positive;
    /// First Mooney-Rivlin constant of the bladder (Pa), W = c10 (I1 - 3) + c01 (I2 - 3).
    C10 = "c10", "effects.bladder-elasticity.c10", BRAIDED, Pressure, "MPa", NotNegative;
    /// Second Mooney-Rivlin constant of the bladder (Pa). With c01 = 0 it is a neo-Hookean rubber of shear
    /// modulus 2 c10.
    C01 = "c01", "effects.bladder-elasticity.c01", BRAIDED, Pressure, "MPa", NotNegative;
    /// Wall thickness at rest (m): that of the muscle, else that of its bladder.
    Wall = "wall", "wall", BRAIDED, Length, "mm", Positive;
    /// Thickness by which the gas stays inside the braid radius (m).
    GasWall = "gas_wall", "effects.wall-thickness.thickness", BRAIDED, Length, "mm", NotNegative;
    /// Hoop stiffness K = E t (N/m) of cloth that can unfold only so far. Beyond the unfolded radius it
    /// stretches.
    ///
    /// ```text
    /// u(r) = K (2 pi (r - r_u))^2 / (2 * 2 pi r_u)   for r > r_u, else 0
    /// ```
    /// u (N): hoop energy per unit meridian length; `r_u` (m): unfolded radius.
    HoopStiffness = "hoop_stiffness", "effects.limited-unfolding.hoop_stiffness", None, LineStiffness, "kN/m", Positive;
    /// Radius beyond which the cloth is taut (m).
    UnfoldedRadius = "unfolded_radius", "effects.limited-unfolding.unfolded_radius", None, Length, "mm", Positive;
    /// Circumference of the cloth that bulges in lobes between every two fibres (m).
    ClothCircumference = "cloth_circumference", "effects.lobes.circumference", PLEATED, Length, "mm", Positive;
}

impl Parameter {
    /// The name in sweeps, tables and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.facts().name
    }

    /// The parameter of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|parameter| parameter.name() == name)
    }

    /// Its place in a muscle file.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.facts().key
    }

    /// The effect whose table in a muscle file holds the parameter, and its key there, if there is one.
    #[must_use]
    pub fn effect(self) -> Option<(&'static str, &'static str)> {
        self.key().strip_prefix("effects.")?.split_once('.')
    }

    /// The parameters in the table `[effects.NAME]` of a muscle file, with their keys there.
    pub(crate) fn in_effect(name: &str) -> impl Iterator<Item = (Self, &'static str)> {
        let all = Self::ALL.into_iter().filter_map(|parameter| Some((parameter, parameter.effect()?)));
        all.filter(move |(_, (effect, _))| *effect == name).map(|(parameter, (_, key))| (parameter, key))
    }

    /// The parameter under this key in the table `[effects.NAME]`.
    #[must_use]
    pub fn of_effect(name: &str, key: &str) -> Option<Self> {
        Self::in_effect(name).find(|(_, own)| *own == key).map(|(parameter, _)| parameter)
    }

    /// The effects whose tables hold parameters of the muscle; every other `[effects.NAME]` is a
    /// [`crate::Learnt`] one.
    pub fn effects() -> impl Iterator<Item = &'static str> {
        let first = |name| Self::in_effect(name).next().map(|(parameter, _)| parameter);
        let of = move |parameter: Self| {
            parameter.effect().map(|(name, _)| name).filter(|name| first(name) == Some(parameter))
        };
        Self::ALL.into_iter().filter_map(of)
    }

    /// The SI unit; "1" for a count.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        // The SI unit is the first in every list; that of a ratio is empty.
        let unit = self.facts().wanted.known[0].0;
        if unit.is_empty() { "1" } else { unit }
    }

    /// The family it belongs to, if it belongs to only one.
    #[must_use]
    pub const fn kind(self) -> Option<Kind> {
        self.facts().kind
    }

    /// Refuses a value \[SI\] that no muscle can have.
    pub(crate) fn check(self, value: f64) -> Result<(), MuscleError> {
        let (key, unit) = (self.key(), self.unit());
        let (holds, error) = match self.facts().range {
            Range::Positive => (value > 0.0, MuscleError::NotPositive { key, value, unit }),
            Range::NotNegative => (value >= 0.0, MuscleError::Negative { key, value, unit }),
            Range::Count => {
                let is_count = value.fract() == 0.0 && (3.0..=f64::from(u32::MAX)).contains(&value);
                (is_count, MuscleError::FibreCount { value })
            }
            Range::BraidAngle => {
                let degrees = Angle::rad(value).to_deg();
                (value > 0.0 && value < FRAC_PI_2, MuscleError::BraidAngle { degrees })
            }
            Range::Misalignment => {
                let degrees = Angle::rad(value).to_deg();
                (value.abs() < FRAC_PI_2, MuscleError::Misalignment { degrees })
            }
        };
        if holds && value.is_finite() { Ok(()) } else { Err(error) }
    }

    /// Reads one value of this parameter, such as "100 mm" for `Length`, into SI.
    ///
    /// # Errors
    /// If the text is not a quantity of the parameter's dimension.
    pub fn parse(self, text: &str) -> Result<f64, UnitError> {
        Ok(units::read(self.facts().wanted, text)?.si)
    }

    /// The same with an optional width, such as "100 mm +- 1 mm".
    pub(crate) fn parse_with_width(self, text: &str) -> Result<(f64, Option<f64>), UnitError> {
        let (value, width) = units::read_with_width(self.facts().wanted, text)?;
        Ok((value.si, width))
    }

    /// A value in SI, and its width if there is one, as they are written in a muscle file, with unit and
    /// quotes. Reading gives exactly the same numbers.
    pub(crate) fn text(self, value: f64, width: Option<f64>) -> String {
        let Facts { wanted, unit, range, .. } = self.facts();
        if matches!(range, Range::Count) {
            return value.to_string();
        }
        let text = |si| units::exact_text_of(wanted, si, unit);
        let width = width.map(|width| format!(" +- {}", text(width))).unwrap_or_default();
        format!("\"{}{width}\"", text(value))
    }

    /// Reads values of this parameter, such as "100,110,120 mm" for `Length` or "20,40" for `Fibres`, into
    /// SI.
    ///
    /// # Errors
    /// If an item is not a quantity of the parameter's dimension.
    pub fn parse_list(self, text: &str) -> Result<Vec<f64>, UnitError> {
        units::read_list(self.facts().wanted, text)
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
