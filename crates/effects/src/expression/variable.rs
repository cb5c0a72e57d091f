//! The variables of formulas: the state of a muscle at one moment of a measured history.

use bulge_muscles::Dimension;

/// A variable that formulas may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Variable {
    /// The name in formulas.
    pub name: &'static str,
    /// An alternative name, if there is one.
    pub alias: Option<&'static str>,
    /// The dimension. The value is in SI units.
    pub dimension: Dimension,
    /// A description.
    pub meaning: &'static str,
}

const fn variable(name: &'static str, dimension: Dimension, meaning: &'static str) -> Variable {
    Variable { name, alias: None, dimension, meaning }
}

const fn also(alias: &'static str, variable: Variable) -> Variable {
    Variable { alias: Some(alias), ..variable }
}

/// All variables, in the order in which [`Expression::evaluate`](super::Expression::evaluate) takes their
/// values.
pub const VARIABLES: [Variable; 16] = [
    also("pressure", variable("p", Dimension::PRESSURE, "gauge pressure of the gas")),
    also("contraction", variable("eps", Dimension::NONE, "contraction 1 - length/l0")),
    variable("length", Dimension::LENGTH, "length now, between the end fittings"),
    variable("l0", Dimension::LENGTH, "length at rest"),
    variable(
        "radius",
        Dimension::LENGTH,
        "reference radius: pleated of the fibres at the fittings, braided of the braid at rest",
    ),
    variable("mid_radius", Dimension::LENGTH, "largest radius now"),
    variable("direction", Dimension::NONE, "+1 while it shortens, -1 while it lengthens, 0 at rest"),
    variable("rate", Dimension::RATE, "rate of the contraction, d eps/dt"),
    variable("time", Dimension::TIME, "time since the start of the sweep"),
    variable("temperature", Dimension::TEMPERATURE, "temperature above the reference temperature"),
    variable("force", Dimension::FORCE, "force of the muscle without this effect, positive where it pulls"),
    variable("cycle", Dimension::NONE, "number of loops done before, from 0"),
    variable("max_eps", Dimension::NONE, "largest contraction so far in the sweep"),
    variable("tension", Dimension::FORCE, "force of all fibres along the meridian at mid-length"),
    variable("fibres", Dimension::NONE, "number of fibres"),
    variable("braid_angle", Dimension::NONE, "angle between fibre and axis at rest, in rad"),
];

/// The variables of a formula for the shape: the wall of the net at one radius of the meridian.
pub const SHAPE_VARIABLES: [Variable; 7] = [
    variable("l1", Dimension::NONE, "stretch along the meridian"),
    variable("l2", Dimension::NONE, "stretch around the axis, r/r0"),
    variable("r", Dimension::LENGTH, "radius of the fibres"),
    variable(
        "r0",
        Dimension::LENGTH,
        "reference radius: pleated of the fibres at the fittings, braided of the braid at rest",
    ),
    also("pressure", variable("p", Dimension::PRESSURE, "gauge pressure of the gas")),
    also("braid_angle", variable("alpha0", Dimension::NONE, "angle between fibre and axis at rest, in rad")),
    variable("l0", Dimension::LENGTH, "length at rest"),
];

/// The index of a variable in a list, by name or alias.
#[must_use]
pub(crate) fn place(variables: &[Variable], name: &str) -> Option<usize> {
    variables.iter().position(|variable| variable.name == name || variable.alias == Some(name))
}

/// The index of a variable in [`VARIABLES`], by name or alias.
#[must_use]
pub fn variable_index(name: &str) -> Option<usize> {
    place(&VARIABLES, name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_to_their_place() {
        for (index, variable) in VARIABLES.iter().enumerate() {
            assert_eq!(variable_index(variable.name), Some(index));
            assert!(!variable.meaning.is_empty());
        }
        assert_eq!((variable_index("pressure"), variable_index("contraction")), (Some(0), Some(1)));
        assert_eq!(variable_index("P"), None);
    }
}
