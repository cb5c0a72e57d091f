//! Values of an axis as text: numbers, lists and ranges, with units of the axis's dimension.

use bulge_muscles::shown::shortened;
use bulge_muscles::{Angle, Dimension, LearntValue, Parameter, Quantity as _, units};

/// The keyword for the contraction at which the force vanishes.
const LIMIT: &str = "limit";

/// Dimension and unit of the values of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scale {
    dimension: Dimension,
    is_angle: bool,
    /// SI unit; "1" for a pure number.
    pub(super) unit: String,
    /// Two example values, the smaller one first.
    example: [String; 2],
}

impl Scale {
    fn new(dimension: Dimension, is_angle: bool, unit: &str, [low, high]: [&str; 2]) -> Self {
        let example = [low.to_owned(), high.to_owned()];
        Self { dimension, is_angle, unit: unit.to_owned(), example }
    }

    /// Scale of the contraction.
    pub(super) fn contraction() -> Self {
        Self::new(Dimension::NONE, false, "1", ["1 %", "20 %"])
    }

    /// Scale of the pressure.
    pub(super) fn pressure() -> Self {
        Self::new(Dimension::PRESSURE, false, "Pa", ["1 bar", "4 bar"])
    }

    /// Scale of the slenderness l0/R.
    pub(super) fn slenderness() -> Self {
        Self::new(Dimension::NONE, false, "1", ["4", "20"])
    }

    /// Scale of the elastic group.
    pub(super) fn elastic_group() -> Self {
        Self::new(Dimension::NONE, false, "1", ["1e-5", "1e-3"])
    }

    /// Scale of a parameter of the muscle.
    pub(super) fn parameter(parameter: Parameter) -> Self {
        let (dimension, example) = match parameter.unit() {
            "rad" => (Dimension::NONE, ["20 deg", "30 deg"]),
            "N" => (Dimension::FORCE, ["5 kN", "20 kN"]),
            "Pa" => (Dimension::PRESSURE, ["0.1 MPa", "0.5 MPa"]),
            "N/m" => (Dimension::LINE_STIFFNESS, ["10 N/mm", "100 N/mm"]),
            "1" => (Dimension::NONE, ["20", "60"]),
            _ => (Dimension::LENGTH, ["10 mm", "20 mm"]),
        };
        Self::new(dimension, parameter.unit() == "rad", parameter.unit(), example)
    }

    /// Scale of a number of an effect.
    pub(super) fn effect(value: &LearntValue) -> Self {
        let is_angle = is_angle(&value.unit);
        let unit = if is_angle { "rad".to_owned() } else { value.dimension.to_string() };
        let stated = value.si.abs().max(f64::MIN_POSITIVE);
        let example = [stated, 2.0 * stated].map(|si| units::exact_any_text(si, &value.unit));
        Self { dimension: value.dimension, is_angle, unit, example }
    }

    /// An example of a range.
    pub(super) fn range_example(&self) -> String {
        let [low, high] = &self.example;
        format!("write such as `range = \"{low}..{high}\"`")
    }

    /// An example of a list.
    pub(super) fn list_example(&self) -> String {
        let [low, high] = &self.example;
        format!("write such as `list = [\"{low}\", \"{high}\"]`")
    }

    /// One value in SI. A bare number takes the unit `inherited`, if one is given.
    pub(super) fn one(&self, text: &str, inherited: Option<&str>) -> Result<f64, String> {
        let read = |text: &str| units::any(text).map_err(|error| error.to_string());
        let (mut text, mut found) = (text.trim().to_owned(), read(text)?);
        if let Some(unit) = inherited.filter(|unit| found.unit.is_empty() && !unit.is_empty()) {
            text = [text.as_str(), unit].join(" ");
            found = read(&text)?;
        }
        if found.dimension == self.dimension && is_angle(&found.unit) == self.is_angle {
            return Ok(found.si);
        }
        let describe = |dimension: Dimension, is_angle| {
            if is_angle { "an angle (rad)".to_owned() } else { dimension.describe() }
        };
        let is = describe(found.dimension, is_angle(&found.unit));
        Err(format!(
            "`{}` is {is}, but must be {}",
            shortened(&text),
            describe(self.dimension, self.is_angle)
        ))
    }

    /// Reads "20,40,60" or "1,2,3 bar": numbers without a unit take the unit of the last one.
    pub(super) fn list(&self, text: &str) -> Result<Vec<f64>, String> {
        let last = text.rsplit(',').next().unwrap_or_default();
        let unit = unit_of(last)?;
        text.split(',').map(|item| self.one(item, Some(&unit))).collect()
    }

    /// Reads "1..3 bar" into both ends. The upper end is none for the word `limit`.
    pub(super) fn range(&self, text: &str) -> Result<(f64, Option<f64>), String> {
        let Some((from, to)) = text.split_once("..") else {
            return Err(format!("`{}` is no range: two values with `..` between them", shortened(text)));
        };
        if to.trim() == LIMIT {
            return Ok((self.one(from, None)?, None));
        }
        Ok((self.one(from, Some(&unit_of(to)?))?, Some(self.one(to, None)?)))
    }
}

fn unit_of(text: &str) -> Result<String, String> {
    units::any(text).map(|found| found.unit).map_err(|error| error.to_string())
}

fn is_angle(unit: &str) -> bool {
    Angle::UNITS.iter().any(|(symbol, _)| *symbol == unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_inherited_backwards() {
        let pressure = Scale::pressure();
        assert_eq!(pressure.list("1, 2,3 bar"), Ok(vec![1e5, 2e5, 3e5]));
        assert_eq!(pressure.list("10 kPa,1 bar"), Ok(vec![1e4, 1e5]));
        assert_eq!(pressure.range("1..3 bar"), Ok((1e5, Some(3e5))));
        assert_eq!(Scale::contraction().range("0.5..35 %"), Ok((0.005, Some(0.35))));
        assert_eq!(Scale::contraction().range("0.5 % .. limit"), Ok((0.005, None)));
        assert_eq!(Scale::slenderness().range("2..1e2"), Ok((2.0, Some(100.0))));
        let angle = Scale::parameter(Parameter::BraidAngle);
        assert_eq!(angle.range("0.1..0.2 rad"), Ok((0.1, Some(0.2))));
    }

    #[test]
    fn other_dimensions_are_refused() {
        let angle = Scale::parameter(Parameter::BraidAngle);
        for (found, part) in [
            (angle.one("20 %", None), "`20 %` is a pure number, but must be an angle (rad)"),
            (angle.one("20", None), "`20` is a pure number"),
            (Scale::slenderness().one("20 deg", None), "is an angle (rad), but must be a pure number"),
            (Scale::pressure().one("3", None), "`3` is a pure number, but must be a pressure (Pa)"),
            (Scale::pressure().one("3 mm", Some("bar")), "a length (m)"),
            (Scale::pressure().one("3", Some("mm")), "`3 mm` is a length (m)"),
            (Scale::pressure().one("3 bra", None), "unknown unit `bra`"),
            (Scale::pressure().one("inf Pa", None), "not a finite number"),
        ] {
            let message = found.unwrap_err();
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
        assert!(Scale::pressure().list("1,2,").unwrap_err().contains("no number is given"));
        assert!(Scale::pressure().range("1 bar").unwrap_err().contains("`1 bar` is no range"));
    }

    #[test]
    fn examples_are_read() {
        let effect = |unit: &str, dimension, si| {
            Scale::effect(&LearntValue {
                key: "x".to_owned(),
                si,
                dimension,
                unit: unit.to_owned(),
                width: None,
            })
        };
        assert_eq!(effect("deg", Dimension::NONE, 0.1).unit, "rad");
        assert_eq!(effect("N", Dimension::FORCE, -14.0).example, ["14 N", "28 N"]);
        let plain = [Scale::contraction(), Scale::pressure(), Scale::slenderness(), Scale::elastic_group()];
        let effects = [effect("deg", Dimension::NONE, 0.1), effect("kN", Dimension::FORCE, 14.0)];
        let parameters = Parameter::ALL.into_iter().map(Scale::parameter);
        for scale in plain.into_iter().chain(effects).chain(parameters) {
            let text = scale.range_example();
            let text = text.trim_start_matches("write such as `range = \"").trim_end_matches("\"`");
            assert!(matches!(scale.range(text), Ok((low, Some(high))) if low < high), "{text}");
            assert_eq!(units::unit(&scale.unit).unwrap().1, scale.dimension);
        }
    }
}
