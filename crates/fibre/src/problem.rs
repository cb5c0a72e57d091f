//! A muscle under pressure as a dimensionless fibre net: where quantities with units become numbers.
//!
//! Lengths are divided by the reference radius R (pleated: fibre radius at the fittings; braided: braid radius at rest), forces by p R^2.

use bulge_muscles::{Construction, Ends, FibreCount, Muscle, Parameter, Pressure, Quantity};
use bulge_numerics::Real;
use std::f64::consts::PI;

use crate::FibreError;
use crate::net::{Bladder, Cloth, Net};

/// What the result may be differentiated by, besides the contraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// Gauge pressure \[Pa\].
    Pressure,
    /// A parameter of the muscle, in SI.
    Parameter(Parameter),
}

impl Variable {
    /// Number of variables.
    pub const COUNT: usize = 1 + Parameter::ALL.len();

    /// All of them: the pressure, then the parameters in their order.
    pub fn all() -> impl Iterator<Item = Self> {
        std::iter::once(Self::Pressure).chain(Parameter::ALL.into_iter().map(Self::Parameter))
    }

    /// Place in [`Variable::all`].
    pub(crate) fn index(self) -> usize {
        match self {
            Self::Pressure => 0,
            Self::Parameter(parameter) => {
                1 + Parameter::ALL.iter().position(|p| *p == parameter).unwrap_or(usize::MAX - 1)
            }
        }
    }
}

/// Range of slenderness l0/R of pleated muscles.
pub const PLEATED_SLENDERNESS: [f64; 2] = [0.5, 1000.0];
/// Range of l0/r0 of braids with clamped ends.
pub const BRAIDED_SLENDERNESS: [f64; 2] = [1.0, 100.0];
/// Range of the braid angle at rest of braids with clamped ends, degrees.
pub const BRAID_ANGLE: [f64; 2] = [5.0, 50.0];

/// A muscle at a gauge pressure, ready to be asked.
#[derive(Debug, Clone)]
pub struct Problem {
    pub(crate) muscle: Muscle,
    /// Gauge pressure \[Pa\].
    pub(crate) pressure: f64,
    pub(crate) net: Net<f64>,
    /// Whether the fittings of a braid have the radius of the braid because nothing else is stated.
    fitting_follows: bool,
}

impl Problem {
    /// Checks the ranges and makes the problem dimensionless.
    ///
    /// # Errors
    /// [`FibreError::PressureNotPositive`], [`FibreError::NotFinite`], or [`FibreError::OutOfRange`] outside
    /// [`PLEATED_SLENDERNESS`], [`BRAIDED_SLENDERNESS`] and [`BRAID_ANGLE`].
    pub fn new(muscle: &Muscle, pressure: Pressure) -> Result<Self, FibreError> {
        let pressure = pressure.si();
        if !pressure.is_finite() {
            return Err(FibreError::NotFinite { what: "pressure", value: pressure });
        }
        if pressure <= 0.0 {
            return Err(FibreError::PressureNotPositive { pressure_pa: pressure });
        }
        check_ranges(muscle)?;
        let fitting_follows = !muscle.is_stated(Parameter::FittingRadius);
        let mut problem = Self { muscle: muscle.clone(), pressure, net: Net::plain(), fitting_follows };
        problem.net = problem.net_of(|variable| problem.value(variable));
        Ok(problem)
    }

    /// The muscle.
    #[must_use]
    pub fn muscle(&self) -> &Muscle {
        &self.muscle
    }

    /// Value of a variable in SI; 0 for a parameter that the muscle doesn't have.
    pub(crate) fn value(&self, variable: Variable) -> f64 {
        match variable {
            Variable::Pressure => self.pressure,
            Variable::Parameter(parameter) => self.muscle.get(parameter).unwrap_or(0.0),
        }
    }

    /// Whether shape, force/p and volume are the same at every pressure.
    pub(crate) fn is_scale_free(&self) -> bool {
        self.net.compliance == 0.0 && self.net.bladder.is_none() && self.net.cloth.is_none()
    }

    /// The dimensionless net, with the values (and derivatives) of the variables from `value`.
    pub(crate) fn net_of<D: Real>(&self, value: impl Fn(Variable) -> D) -> Net<D> {
        let get = |parameter| value(Variable::Parameter(parameter));
        let has = |parameter| self.muscle.get(parameter).is_some();
        let p = value(Variable::Pressure);
        let radius = get(Parameter::Radius);
        let half_length = get(Parameter::Length) / (radius * 2.0);
        let one = D::from(1.0);
        let mut net = Net { half_fibre: half_length, ..Net::plain().lift_to() };
        match self.muscle.construction() {
            Construction::Pleated(pleated) => {
                net.depth = get(Parameter::PleatDepth) / radius;
                // Misaligned fibres make the unpressurised muscle a braid of radius R and angle gamma. The law
                // of pinned crossings needs a second family, or cloth that takes the torque: a lone family would follow geodesics.
                let (sin, cos) = get(Parameter::Misalignment).sin_cos();
                net.half_fibre = half_length / cos;
                net.cos_rest = cos;
                net.turn = sin;
                net.sin2_rest = sin * sin;
                if let FibreCount::Discrete(_) = pleated.fibres() {
                    let n = get(Parameter::Fibres);
                    net.area_factor = n * (D::from(2.0 * PI) / n).sin_cos().0 / (2.0 * PI);
                }
            }
            Construction::Braided(_) => {
                let (sin, cos) = get(Parameter::BraidAngle).sin_cos();
                // Where the fitting's radius isn't stated separately it is the braid's, and follows it.
                net.end_radius =
                    if self.fitting_follows { one } else { get(Parameter::FittingRadius) / radius };
                net.half_fibre = half_length / cos;
                net.cos_rest = cos;
                net.turn = sin;
                net.sin2_rest = sin * sin;
                if has(Parameter::C10) {
                    // 2 pi r0 t W per axial length at rest; cos(alpha0) of that per fibre length.
                    let wall = self.muscle.bladder().map_or(one, |_| get(Parameter::Wall));
                    let scale = wall * cos * (2.0 * PI) / (radius * p);
                    net.bladder =
                        Some(Bladder { c10: scale * get(Parameter::C10), c01: scale * get(Parameter::C01) });
                }
            }
        }
        if has(Parameter::FibreStiffness) {
            let total = get(Parameter::FibreStiffness) * self.fibre_number(&value);
            net.compliance = p * radius * radius / total;
        }
        if has(Parameter::HoopStiffness) {
            net.cloth = Some(Cloth {
                stiffness: get(Parameter::HoopStiffness) / (p * radius),
                radius: get(Parameter::UnfoldedRadius) / radius,
            });
        }
        net
    }

    /// Number of fibres over which tension and stiffness are counted; 1 where the muscle doesn't say or is continuous.
    pub(crate) fn fibre_number<D: From<f64>>(&self, value: impl Fn(Variable) -> D) -> D {
        if self.muscle.fibres().is_some() {
            value(Variable::Parameter(Parameter::Fibres))
        } else {
            D::from(1.0)
        }
    }

    /// Whether the radius of the fittings is a variable of its own: a clamped braid where it is stated.
    pub(crate) fn has_own_fitting(&self) -> bool {
        !self.muscle.is_pleated() && !self.is_cylinder() && !self.fitting_follows
    }

    /// Whether the braid is the textbook cylinder.
    pub(crate) fn is_cylinder(&self) -> bool {
        matches!(self.muscle.construction(), Construction::Braided(braided) if braided.ends() == Ends::Cylinder)
    }
}

fn check_ranges(muscle: &Muscle) -> Result<(), FibreError> {
    if let Some(cloth) = muscle.unfolding() {
        let (taut, end) = (cloth.unfolded_radius().si(), muscle.end_radius().si());
        if taut < end {
            return Err(FibreError::ClothTooNarrow { taut_m: taut, end_m: end });
        }
    }
    let inside = |what, value: f64, [low, high]: [f64; 2]| {
        // A ratio of two decimal lengths may miss a round limit by rounding.
        let slack = 1e-9 * high;
        if value >= low - slack && value <= high + slack {
            Ok(())
        } else {
            Err(FibreError::OutOfRange { what, value, low, high })
        }
    };
    let slenderness = muscle.length().si() / muscle.radius().si();
    match muscle.construction() {
        Construction::Pleated(pleated) if pleated.misalignment().si() == 0.0 => {
            inside("slenderness l0/R", slenderness, PLEATED_SLENDERNESS)
        }
        Construction::Pleated(pleated) => {
            let range = [PLEATED_SLENDERNESS[0], BRAIDED_SLENDERNESS[1]];
            inside("slenderness l0/R (with misaligned fibres)", slenderness, range)?;
            let degrees = pleated.misalignment().si().to_degrees();
            inside("misalignment in degrees", degrees, [-BRAID_ANGLE[1], BRAID_ANGLE[1]])
        }
        Construction::Braided(braided) if braided.ends() == Ends::Clamped => {
            inside("length l0/r0", slenderness, BRAIDED_SLENDERNESS)?;
            inside(
                "fitting radius over the braid radius",
                muscle.end_radius().si() / muscle.radius().si(),
                [0.2, 2.0],
            )?;
            inside("braid angle in degrees", braided.braid_angle().si().to_degrees(), BRAID_ANGLE)
        }
        Construction::Braided(_) => Ok(()),
    }
}
