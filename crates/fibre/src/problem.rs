//! A muscle under pressure as a dimensionless fibre net: where quantities with units become numbers.
//!
//! Lengths are divided by the reference radius R (pleated: fibre radius at the fittings; braided: braid radius at rest), forces by p R^2.

use bulge_muscles::{Construction, Ends, FibreCount, Muscle, Parameter, Pressure, Quantity};
use bulge_numerics::{Dual, Real};
use std::f64::consts::PI;
use std::sync::Arc;

use crate::FibreError;
use crate::lobes::Lobes;
use crate::net::{Bladder, Cloth, Net};
use crate::quadrature;

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

/// Largest radius of the fittings over r0/sin(alpha0), at which the fibres of a braid lie along the circumference.
pub const WIDEST_FITTING: f64 = 0.995;

/// Strain of the fibres of a muscle longer than at rest beyond which it isn't computed: nylon breaks at 0.15 to 0.3, polyester at 0.15, aramid at 0.03
/// (W. E. Morton and J. W. S. Hearle, *Physical Properties of Textile Fibres*, Woodhead 2008).
pub const MOST_STRAIN: f64 = 0.3;

/// Range of the number of fibres with lobes between them: with more, rounding is larger than the errors that the integration keeps to.
pub const LOBED_FIBRES: [f64; 2] = [3.0, 300.0];
/// Largest n l0/r* of n fibres with lobes between them that can open to the radius r*: how far the middle of a longer muscle is from a
/// cylinder, exp(-0.4 n l0/r*), can't be told from 0.
pub const LOBED_LENGTH: f64 = 600.0;

/// A muscle at a gauge pressure, ready to be asked.
#[derive(Debug, Clone)]
pub struct Problem {
    pub(crate) muscle: Arc<Muscle>,
    /// Gauge pressure \[Pa\].
    pub(crate) pressure: f64,
    pub(crate) net: Net<f64>,
}

impl Problem {
    /// Checks the ranges and makes the problem dimensionless.
    ///
    /// # Errors
    /// [`FibreError::PressureNotPositive`], [`FibreError::NotFinite`], [`FibreError::OutOfRange`] outside
    /// [`PLEATED_SLENDERNESS`], [`BRAIDED_SLENDERNESS`], [`BRAID_ANGLE`], [`LOBED_FIBRES`] and [`LOBED_LENGTH`], [`FibreError::ClothTooNarrow`]
    /// or [`FibreError::FittingTooWide`].
    pub fn new(muscle: &Muscle, pressure: Pressure) -> Result<Self, FibreError> {
        check_ranges(muscle)?;
        Self::checked(Arc::new(muscle.clone()), pressure)
    }

    /// The same muscle at another gauge pressure; it is shared, not copied.
    ///
    /// # Errors
    /// [`FibreError::PressureNotPositive`] or [`FibreError::NotFinite`].
    pub fn at_pressure(&self, pressure: Pressure) -> Result<Self, FibreError> {
        Self::checked(Arc::clone(&self.muscle), pressure)
    }

    fn checked(muscle: Arc<Muscle>, pressure: Pressure) -> Result<Self, FibreError> {
        let pressure = pressure.si();
        if !pressure.is_finite() {
            return Err(FibreError::NotFinite { what: "pressure", value: pressure });
        }
        if pressure <= 0.0 {
            return Err(FibreError::PressureNotPositive { pressure_pa: pressure });
        }
        let mut problem = Self { muscle, pressure, net: Net::plain() };
        problem.net = problem.net_of(|variable| problem.value(variable));
        quadrature::prepare(&problem.net);
        Ok(problem)
    }

    /// The muscle.
    #[must_use]
    pub fn muscle(&self) -> &Muscle {
        &self.muscle
    }

    /// The gauge pressure.
    #[must_use]
    pub fn pressure(&self) -> Pressure {
        Pressure::pa(self.pressure)
    }

    /// Value of a variable in SI; 0 for a parameter that the muscle doesn't have.
    pub(crate) fn value(&self, variable: Variable) -> f64 {
        match variable {
            Variable::Pressure => self.pressure,
            Variable::Parameter(parameter) => self.muscle.get(parameter).unwrap_or(0.0),
        }
    }

    /// The variables as dual numbers, each with the place of its derivative (from [`Dual::variable`]: beyond `N` for a constant).
    ///
    /// What isn't stated separately follows: the fitting's radius that of the braid, the inner face of the wall the wall. A derivative by such a
    /// follower is that of stating it.
    pub(crate) fn seeded<const N: usize>(
        &self,
        place: impl Fn(Variable) -> usize,
    ) -> impl Fn(Variable) -> Dual<N> {
        let own = move |variable, value| Dual::variable(value, place(variable));
        move |variable| {
            let value = self.value(variable);
            let own_of = |parameter, value| own(Variable::Parameter(parameter), value);
            let Variable::Parameter(parameter) = variable else { return own(variable, value) };
            let follows = !self.muscle.is_stated(parameter);
            match parameter {
                // The fibre radius that acts in a pleated muscle is that at the fittings, under either name.
                Parameter::Radius | Parameter::FittingRadius if self.muscle.is_pleated() => {
                    own_of(Parameter::Radius, value) + own_of(Parameter::FittingRadius, 0.0)
                }
                Parameter::FittingRadius if follows => {
                    own_of(Parameter::Radius, value) + own_of(parameter, 0.0)
                }
                Parameter::GasWall if follows => own_of(Parameter::Wall, value) + own_of(parameter, 0.0),
                _ => own_of(parameter, value),
            }
        }
    }

    /// Whether shape, force/p and volume are the same at every pressure.
    #[must_use]
    pub fn is_scale_free(&self) -> bool {
        self.net.compliance == 0.0 && self.net.bladder.is_none() && self.net.cloth.is_none()
    }

    /// The dimensionless net, with the values (and derivatives) of the variables from `value`.
    pub(crate) fn net_of<D: Real>(&self, value: impl Fn(Variable) -> D) -> Net<D> {
        let get = |parameter| value(Variable::Parameter(parameter));
        let has = |parameter| self.muscle.get(parameter).is_some();
        let p = value(Variable::Pressure);
        let radius = get(Parameter::Radius);
        let half_length = get(Parameter::Length) / (radius * 2.0);
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
                    if has(Parameter::ClothCircumference) {
                        net.lobes = Some(Lobes::new(n, get(Parameter::ClothCircumference) / radius));
                    }
                }
            }
            Construction::Braided(_) => {
                let (sin, cos) = get(Parameter::BraidAngle).sin_cos();
                net.end_radius = get(Parameter::FittingRadius) / radius;
                if has(Parameter::GasWall) {
                    net.depth = -(get(Parameter::GasWall) / radius);
                }
                net.half_fibre = half_length / cos;
                net.cos_rest = cos;
                net.turn = sin;
                net.sin2_rest = sin * sin;
                if let Some(bladder) = self.muscle.bladder() {
                    // 2 pi r0 t W per axial length at rest; cos(alpha0) of that per fibre length. A bladder of another thickness than that of
                    // the muscle's wall doesn't follow it.
                    let shared = self.muscle.wall() == Some(bladder.wall());
                    let wall = if shared { get(Parameter::Wall) } else { D::from(bladder.wall().si()) };
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
        !self.muscle.is_pleated() && !self.is_cylinder() && self.muscle.is_stated(Parameter::FittingRadius)
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
    if let Some(circumference) = muscle.get(Parameter::ClothCircumference) {
        // The lobes form one circle of the cloth's circumference; at the fitting they must be further in.
        let taut_m = circumference / (2.0 * PI);
        let end_m = muscle.radius().si() + muscle.get(Parameter::PleatDepth).unwrap_or(0.0);
        if taut_m <= end_m {
            return Err(FibreError::ClothTooNarrow { taut_m, end_m });
        }
        let fibres = muscle.fibres().map_or(0.0, f64::from);
        inside("number of fibres with lobes between them", fibres, LOBED_FIBRES)?;
        let length = fibres * muscle.length().si() / taut_m;
        inside("number of fibres times length over radius of the open lobes", length, [0.0, LOBED_LENGTH])?;
    }
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
            inside("braid angle in degrees", braided.braid_angle().si().to_degrees(), BRAID_ANGLE)?;
            let (end_m, widest_m) =
                (muscle.end_radius().si(), muscle.radius().si() / braided.braid_angle().si().sin());
            if end_m > WIDEST_FITTING * widest_m {
                return Err(FibreError::FittingTooWide { end_m, widest_m });
            }
            Ok(())
        }
        Construction::Braided(_) => Ok(()),
    }
}
