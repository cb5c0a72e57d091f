//! Outputs computed at each point, with names and units.

use bulge_muscles::Parameter;
use serde::Serialize;

/// Variable with respect to which force and volume are differentiated, besides the contraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// Gauge pressure \[Pa\].
    Pressure,
    /// A parameter of the muscle, in SI.
    Parameter(Parameter),
}

impl Variable {
    /// All variables: the pressure, then the parameters in their order.
    pub fn all() -> impl Iterator<Item = Self> {
        std::iter::once(Self::Pressure).chain(Parameter::ALL.into_iter().map(Self::Parameter))
    }

    /// Its name in outputs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pressure => "pressure",
            Self::Parameter(parameter) => parameter.name(),
        }
    }

    /// Its SI unit; "1" for a pure number.
    const fn unit(self) -> &'static str {
        match self {
            Self::Pressure => "Pa",
            Self::Parameter(parameter) => parameter.unit(),
        }
    }
}

/// One output of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// F/(p l0^2 a), a = (n/2 pi) sin(2 pi/n) for a pleated muscle of n fibres, else 1: f of S1 eq. 28 \[-\].
    ForceF,
    /// V/l0^3 with circular sections: v of S1 eq. 30 \[-\].
    VolumeV,
    /// Axial force \[N\].
    Force,
    /// Enclosed volume with circular sections \[m^3\].
    Volume,
    /// Enclosed volume with the sections that carry the pressure \[m^3\].
    VolumePolygon,
    /// Largest radius \[m\].
    MaxRadius,
    /// Largest radius divided by the radius at the fittings \[-\].
    RadiusRatio,
    /// Largest tension of a fibre \[N\].
    FibreTension,
    /// Largest strain of a fibre \[-\].
    FibreStrain,
    /// dF/dl at constant pressure \[N/m\].
    Stiffness,
    /// dF/dl at constant gas amount, isothermal \[N/m\].
    StiffnessIsothermal,
    /// dF/dl at constant gas amount, adiabatic \[N/m\].
    StiffnessAdiabatic,
    /// Angle of the meridian against the axis at the fittings \[rad\].
    EndSlope,
    /// df/d(contraction) \[-\].
    ForceFByContraction,
    /// dv/d(contraction) \[-\].
    VolumeVByContraction,
    /// dF/d(contraction) \[N\].
    ForceByContraction,
    /// dV/d(contraction) \[m^3\].
    VolumeByContraction,
    /// dF/d(variable) at constant contraction, per SI unit of the variable.
    ForceBy(Variable),
    /// dV/d(variable) at constant contraction, per SI unit of the variable.
    VolumeBy(Variable),
}

impl Output {
    /// All outputs except the derivatives by variables of the muscle.
    pub const PLAIN: [Self; 17] = [
        Self::ForceF,
        Self::VolumeV,
        Self::Force,
        Self::Volume,
        Self::VolumePolygon,
        Self::MaxRadius,
        Self::RadiusRatio,
        Self::FibreTension,
        Self::FibreStrain,
        Self::Stiffness,
        Self::StiffnessIsothermal,
        Self::StiffnessAdiabatic,
        Self::EndSlope,
        Self::ForceFByContraction,
        Self::VolumeVByContraction,
        Self::ForceByContraction,
        Self::VolumeByContraction,
    ];

    /// All outputs.
    pub fn all() -> impl Iterator<Item = Self> {
        let by = Variable::all().flat_map(|variable| [Self::ForceBy(variable), Self::VolumeBy(variable)]);
        Self::PLAIN.into_iter().chain(by)
    }

    /// The output with the given name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|output| output.name() == name)
    }

    /// Its name, up to the variable of a derivative, and its unit, up to that of the variable.
    const fn name_and_unit(self) -> (&'static str, &'static str) {
        match self {
            Self::ForceF => ("force_f", "1"),
            Self::VolumeV => ("volume_v", "1"),
            Self::Force => ("force", "N"),
            Self::Volume => ("volume", "m^3"),
            Self::VolumePolygon => ("volume_polygon", "m^3"),
            Self::MaxRadius => ("max_radius", "m"),
            Self::RadiusRatio => ("radius_ratio", "1"),
            Self::FibreTension => ("fibre_tension", "N"),
            Self::FibreStrain => ("fibre_strain", "1"),
            Self::Stiffness => ("stiffness", "N/m"),
            Self::StiffnessIsothermal => ("stiffness_isothermal", "N/m"),
            Self::StiffnessAdiabatic => ("stiffness_adiabatic", "N/m"),
            Self::EndSlope => ("end_slope", "rad"),
            Self::ForceFByContraction => ("force_f_by_contraction", "1"),
            Self::VolumeVByContraction => ("volume_v_by_contraction", "1"),
            Self::ForceByContraction => ("force_by_contraction", "N"),
            Self::VolumeByContraction => ("volume_by_contraction", "m^3"),
            Self::ForceBy(_) => ("force_by_", "N"),
            Self::VolumeBy(_) => ("volume_by_", "m^3"),
        }
    }

    /// The variable of a derivative.
    const fn variable(self) -> Option<Variable> {
        match self {
            Self::ForceBy(variable) | Self::VolumeBy(variable) => Some(variable),
            _ => None,
        }
    }

    /// Its name in sweep files, columns and tables.
    #[must_use]
    pub fn name(self) -> String {
        self.name_and_unit().0.to_owned() + self.variable().map_or("", Variable::name)
    }

    /// Its unit; "1" for a pure number.
    #[must_use]
    pub fn unit(self) -> String {
        let unit = self.name_and_unit().1;
        match self.variable().map_or("1", Variable::unit) {
            "1" => unit.to_owned(),
            below if below.contains('/') => format!("{unit}/({below})"),
            below => format!("{unit}/{below}"),
        }
    }
}

impl Serialize for Output {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found() {
        let names: Vec<String> = Output::all().map(Output::name).collect();
        for (i, output) in Output::all().enumerate() {
            assert_eq!(Output::named(&names[i]), Some(output));
            assert_eq!(names.iter().filter(|name| **name == names[i]).count(), 1);
        }
        assert_eq!(Output::named("forse"), None);
        assert_eq!(Output::named("force_by_pressure").unwrap().unit(), "N/Pa");
    }
}
