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

    /// Its name in sweep files, columns and tables.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::ForceF => "force_f".to_owned(),
            Self::VolumeV => "volume_v".to_owned(),
            Self::Force => "force".to_owned(),
            Self::Volume => "volume".to_owned(),
            Self::VolumePolygon => "volume_polygon".to_owned(),
            Self::MaxRadius => "max_radius".to_owned(),
            Self::RadiusRatio => "radius_ratio".to_owned(),
            Self::FibreTension => "fibre_tension".to_owned(),
            Self::FibreStrain => "fibre_strain".to_owned(),
            Self::Stiffness => "stiffness".to_owned(),
            Self::StiffnessIsothermal => "stiffness_isothermal".to_owned(),
            Self::StiffnessAdiabatic => "stiffness_adiabatic".to_owned(),
            Self::EndSlope => "end_slope".to_owned(),
            Self::ForceFByContraction => "force_f_by_contraction".to_owned(),
            Self::VolumeVByContraction => "volume_v_by_contraction".to_owned(),
            Self::ForceByContraction => "force_by_contraction".to_owned(),
            Self::VolumeByContraction => "volume_by_contraction".to_owned(),
            Self::ForceBy(variable) => format!("force_by_{}", variable.name()),
            Self::VolumeBy(variable) => format!("volume_by_{}", variable.name()),
        }
    }

    /// Its unit; "1" for a pure number.
    #[must_use]
    pub fn unit(self) -> String {
        let by = |unit: &str, variable: Variable| {
            let below = match variable {
                Variable::Pressure => "Pa",
                Variable::Parameter(parameter) => parameter.unit(),
            };
            match below {
                "1" => unit.to_owned(),
                _ if below.contains('/') => format!("{unit}/({below})"),
                _ => format!("{unit}/{below}"),
            }
        };
        match self {
            Self::Force | Self::FibreTension | Self::ForceByContraction => "N".to_owned(),
            Self::Volume | Self::VolumePolygon | Self::VolumeByContraction => "m^3".to_owned(),
            Self::MaxRadius => "m".to_owned(),
            Self::Stiffness | Self::StiffnessIsothermal | Self::StiffnessAdiabatic => "N/m".to_owned(),
            Self::EndSlope => "rad".to_owned(),
            Self::ForceBy(variable) => by("N", variable),
            Self::VolumeBy(variable) => by("m^3", variable),
            _ => "1".to_owned(),
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
