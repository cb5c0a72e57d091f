//! The parts of a muscle: all that its fibre net consists of, in SI. A base muscle is a constructor of these
//! parts, effects of the shape change them, and a [`crate::Problem`] makes them dimensionless.

use bulge_muscles::{
    Construction, Ends, FibreCount, Kind, Muscle, MuscleError, Parameter, Pressure, Quantity, check,
};
use bulge_numerics::{Dual, Real};
use std::f64::consts::PI;

use crate::FibreError;
use crate::formulas::{Formula, Formulas, MOST_PARAMETERS};
use crate::lobes::Lobes;
use crate::net::{Cloth, EvenPowers, Net};
use crate::problem::{
    BRAID_ANGLE, BRAIDED_SLENDERNESS, LOBED_FIBRES, LOBED_LENGTH, PLEATED_SLENDERNESS, WIDEST_FITTING,
};

/// Names of the numbers of formulas.
const ENERGY: [&str; MOST_PARAMETERS] =
    ["energy[0]", "energy[1]", "energy[2]", "energy[3]", "energy[4]", "energy[5]"];
const AREA: [&str; MOST_PARAMETERS] = ["area[0]", "area[1]", "area[2]", "area[3]", "area[4]", "area[5]"];
const TWIST: [&str; MOST_PARAMETERS] =
    ["twist[0]", "twist[1]", "twist[2]", "twist[3]", "twist[4]", "twist[5]"];

/// An arbitrary pressure, to see whether a formula has a value \[Pa\].
const ANY_PRESSURE: f64 = 1e5;

/// Derivatives that a [`Jet`] carries.
pub const LANES: usize = 8;

/// A number with its derivatives by up to [`LANES`] variables.
pub type Jet = Dual<LANES>;

/// Largest count of numbers in [`Parts`] without formulas.
pub(crate) const OWN_PARTS: usize = 14;
/// Largest count of numbers in [`Parts`].
pub(crate) const PARTS: usize = OWN_PARTS + 3 * MOST_PARAMETERS;

/// The parts of a fibre net, in SI. With [`Jet`]s each number also has derivatives by the variables of the
/// caller.
///
/// ```
/// use bulge_fibre::{Approach, Jet, Parts, Problem};
/// use bulge_muscles::{Pressure, preset};
///
/// // How the force depends on the depth of the pleats.
/// let mut parts = Parts::of(&preset("ppam-2-r16")?);
/// parts.depth = 0.002;
/// let mut moving: Parts<Jet> = parts.still();
/// moving.depth = Jet::variable(0.002, 0);
/// let problem = Problem::new(parts, Pressure::bar(2.0))?;
/// let found = problem.linearised(0.1, &moving, Approach::Auto)?;
/// assert!(found.force_n.by_lane[0] > 0.0); // N/m
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Parts<D = f64> {
    /// The family. It sets the ranges that are computed, and whether the reference radius is that of the
    /// fittings.
    pub kind: Kind,
    /// How the ends are held.
    pub ends: Ends,
    /// Whether the cloth between the fibres is flat, so that a cross-section is a polygon; else it is a
    /// circle.
    pub is_polygon: bool,
    /// Unpressurised length l0 \[m\].
    pub length: D,
    /// Reference radius R \[m\]: the radius of the fibres at the fittings in a pleated muscle, the radius at
    /// rest in a braid.
    pub radius: D,
    /// Radius of a braid at the fittings, if it differs from that at rest \[m\].
    pub fitting: Option<D>,
    /// Angle between fibre and axis at rest \[rad\].
    pub angle: D,
    /// Number of fibres, if they are counted.
    pub fibres: Option<D>,
    /// Strain of all fibres together over their tension, 1/(n EA) \[1/N\]. 0 if they don't stretch.
    pub compliance: D,
    /// Distance outside the fibres at which the pressure acts \[m\]: positive at the crests of pleats,
    /// negative at the inner face of a wall.
    pub depth: D,
    /// Thickness of the wall of a braid \[m\].
    pub wall: Option<D>,
    /// Circumference of cloth that bulges in a lobe between every two fibres \[m\].
    pub lobes: Option<D>,
    /// Rubber that follows the net.
    pub rubber: Option<Rubber<D>>,
    /// Cloth that stops unfolding.
    pub cloth: Option<TautCloth<D>>,
    /// A formula for the energy of the wall per area at rest \[N/m\], besides the rubber.
    pub energy: Option<Formula<D>>,
    /// A formula for the area on which the pressure acts \[m^2\], instead of polygon, circle and depth.
    pub area: Option<Formula<D>>,
    /// A formula for the turn of the fibres about the axis per fibre length \[rad/m\], instead of
    /// sin(alpha0)/r0.
    pub twist: Option<Formula<D>>,
}

/// A rubber tube that follows the net: W = c10 (I1 - 3) + c01 (I2 - 3), incompressible (Mooney and Rivlin).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rubber<D = f64> {
    /// First constant \[Pa\].
    pub c10: D,
    /// Second constant \[Pa\].
    pub c01: D,
    /// Thickness at rest \[m\].
    pub wall: D,
}

/// Cloth that is taut beyond a radius. Its energy there is K (2 pi (r - r_u))^2/(4 pi r_u) per meridian
/// length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TautCloth<D = f64> {
    /// Hoop stiffness K \[N/m\].
    pub stiffness: D,
    /// Radius r_u from which it is taut \[m\].
    pub radius: D,
}

impl<D: Real> Parts<D> {
    /// The parts of a muscle. `number` gives the value (and derivatives) of each of its parameters.
    fn with_numbers(muscle: &Muscle, number: impl Fn(Parameter, f64) -> D) -> Self {
        let get = |parameter| muscle.get(parameter).map(|value| number(parameter, value));
        let own = |parameter| get(parameter).filter(|_| muscle.is_stated(parameter));
        let or_0 = |number: Option<D>| number.unwrap_or(D::from(0.0));
        let is_pleated = muscle.is_pleated();
        let fibres = get(Parameter::Fibres);
        let all = fibres.unwrap_or(D::from(1.0));
        let cloth = get(Parameter::HoopStiffness).zip(get(Parameter::UnfoldedRadius));
        let (ends, is_polygon) = match muscle.construction() {
            Construction::Pleated(pleated) => {
                (Ends::Clamped, matches!(pleated.fibres(), FibreCount::Discrete(_)))
            }
            Construction::Braided(braided) => (braided.ends(), false),
        };
        let wall = get(Parameter::Wall);
        // Gas on the inner face of the wall follows the wall.
        let gas = own(Parameter::GasWall).or(wall.filter(|_| muscle.get(Parameter::GasWall).is_some()));
        let rubber = muscle.bladder_wall().map(|own_wall| Rubber {
            c10: or_0(get(Parameter::C10)),
            c01: or_0(get(Parameter::C01)),
            // A bladder whose thickness differs from that of the muscle's wall doesn't follow the wall.
            wall: wall.filter(|_| muscle.wall() == Some(own_wall)).unwrap_or(D::from(own_wall.si())),
        });
        Self {
            kind: muscle.kind(),
            ends,
            is_polygon,
            length: or_0(get(Parameter::Length)),
            radius: or_0(get(Parameter::Radius)),
            fitting: own(Parameter::FittingRadius).filter(|_| !is_pleated),
            angle: or_0(get(Parameter::BraidAngle).or(get(Parameter::Misalignment))),
            fibres,
            compliance: or_0(get(Parameter::FibreStiffness).map(|one| D::from(1.0) / (one * all))),
            depth: or_0(get(Parameter::PleatDepth).or(gas.map(|wall| -wall))),
            wall,
            lobes: get(Parameter::ClothCircumference),
            rubber,
            cloth: cloth.map(|(stiffness, radius)| TautCloth { stiffness, radius }),
            energy: None,
            area: None,
            twist: None,
        }
    }
}

impl From<&Muscle> for Parts {
    fn from(muscle: &Muscle) -> Self {
        Self::of(muscle)
    }
}

impl From<&Self> for Parts {
    fn from(parts: &Self) -> Self {
        parts.clone()
    }
}

impl Parts<Jet> {
    /// The parts of a muscle with derivatives by some of its parameters, each in its lane. Parameters beyond
    /// [`LANES`] carry none, nor do those that the muscle doesn't have. The number of fibres counts as
    /// continuous.
    #[must_use]
    pub fn seeded(muscle: &Muscle, parameters: &[Parameter]) -> Self {
        let lane = |parameter| parameters.iter().position(|other| *other == parameter);
        Self::with_numbers(muscle, |parameter, value| match lane(parameter) {
            Some(lane) => Jet::variable(value, lane),
            None => Jet::from(value),
        })
    }
}

impl Parts {
    /// The parts of a muscle as its file states them.
    #[must_use]
    pub fn of(muscle: &Muscle) -> Self {
        Self::with_numbers(muscle, |_, value| value)
    }

    /// The same parts as [`Jet`]s without derivatives.
    #[must_use]
    pub fn still(&self) -> Parts<Jet> {
        self.map(|_, number| Jet::from(number))
    }

    /// Refuses parts that make no problem: walls that leave no room for gas inside the braid and its
    /// fittings.
    ///
    /// # Errors
    /// [`MuscleError::WallTooThick`].
    pub fn check(&self) -> Result<(), MuscleError> {
        let fitting = self.fitting.unwrap_or(self.radius);
        let walls = [("wall", self.wall.unwrap_or(0.0), self.radius), {
            ("effects.wall-thickness", -self.depth, self.radius.min(fitting))
        }];
        match walls.into_iter().find(|(_, wall, radius)| wall >= radius) {
            Some((key, wall_m, radius_m)) => Err(MuscleError::WallTooThick { key, wall_m, radius_m }),
            None => Ok(()),
        }
    }

    /// Refuses formulas without a value at rest, and a formula for the area if cloth already has one.
    fn check_formulas(&self) -> Result<(), FibreError> {
        let at_rest = [1.0, 1.0, self.radius, self.radius, ANY_PRESSURE, self.angle, self.length];
        let of = |formula: &Formula| formula.run::<1>(at_rest)[0];
        let all = [("energy", &self.energy), ("area", &self.area), ("twist", &self.twist)];
        for (what, formula) in all.into_iter().filter_map(|(what, formula)| Some((what, formula.as_ref()?))) {
            let value = of(formula);
            if !value.is_finite() {
                return Err(FibreError::FormulaWithoutValue { what, value });
            }
        }
        match &self.area {
            Some(_) if self.lobes.is_some() => Err(FibreError::AreaTwice { other: "lobes" }),
            Some(_) if self.cloth.is_some() => Err(FibreError::AreaTwice { other: "limited-unfolding" }),
            _ => Ok(()),
        }
    }

    /// Refuses values outside the ranges that are computed.
    pub(crate) fn check_ranges(&self) -> Result<(), FibreError> {
        let end_m = self.fitting.unwrap_or(self.radius);
        if let Some(cloth) = self.cloth.filter(|cloth| cloth.radius < end_m) {
            return Err(FibreError::ClothTooNarrow { taut_m: cloth.radius, end_m });
        }
        self.check_formulas()?;
        let inside = |what, value: f64, [low, high]: [f64; 2]| {
            // A ratio of two decimal lengths may miss a round limit by rounding.
            let slack = 1e-9 * high;
            if value >= low - slack && value <= high + slack {
                Ok(())
            } else {
                Err(FibreError::OutOfRange { what, value, low, high })
            }
        };
        let slenderness = self.length / self.radius;
        if let Some(circumference) = self.lobes {
            // The lobes form one circle of the cloth's circumference; at the fitting they must be further in.
            let taut_m = circumference / (2.0 * PI);
            let end_m = self.radius + self.depth;
            if taut_m <= end_m {
                return Err(FibreError::ClothTooNarrow { taut_m, end_m });
            }
            let fibres = self.fibres.unwrap_or(0.0);
            inside("number of fibres with lobes between them", fibres, LOBED_FIBRES)?;
            let length = fibres * self.length / taut_m;
            let range = [0.0, LOBED_LENGTH];
            inside("number of fibres times length over radius of the open lobes", length, range)?;
        }
        let degrees = self.angle.to_degrees();
        match (self.kind, self.ends) {
            (Kind::Pleated, _) if self.angle == 0.0 => {
                inside("slenderness l0/R", slenderness, PLEATED_SLENDERNESS)
            }
            (Kind::Pleated, _) => {
                let range = [PLEATED_SLENDERNESS[0], BRAIDED_SLENDERNESS[1]];
                inside("slenderness l0/R (with misaligned fibres)", slenderness, range)?;
                inside("misalignment in degrees", degrees, [-BRAID_ANGLE[1], BRAID_ANGLE[1]])
            }
            (Kind::Braided, Ends::Clamped) => {
                inside("length l0/r0", slenderness, BRAIDED_SLENDERNESS)?;
                inside("fitting radius over the braid radius", end_m / self.radius, [0.2, 2.0])?;
                inside("braid angle in degrees", degrees, BRAID_ANGLE)?;
                let widest_m = self.radius / self.angle.sin();
                // A formula for the turn has a limit of its own, which may depend on the pressure.
                if self.twist.is_none() && end_m > WIDEST_FITTING * widest_m {
                    return Err(FibreError::FittingTooWide { end_m, widest_m });
                }
                Ok(())
            }
            (Kind::Braided, Ends::Cylinder) => Ok(()),
        }
    }
}

impl<D: Real> Parts<D> {
    /// The same parts with every number changed, in a fixed order. The names are those of the fields;
    /// those of a formula's parameters are counted: `energy[0]`.
    pub fn map<E>(&self, mut f: impl FnMut(&'static str, D) -> E) -> Parts<E> {
        let fitting = |f: &mut dyn FnMut(&'static str, D) -> E| self.fitting.map(|d| f("fitting", d));
        Parts {
            kind: self.kind,
            ends: self.ends,
            is_polygon: self.is_polygon,
            length: f("length", self.length),
            radius: f("radius", self.radius),
            fitting: fitting(&mut f),
            angle: f("angle", self.angle),
            fibres: self.fibres.map(|d| f("fibres", d)),
            compliance: f("compliance", self.compliance),
            depth: f("depth", self.depth),
            wall: self.wall.map(|d| f("wall", d)),
            lobes: self.lobes.map(|d| f("lobes", d)),
            rubber: self.rubber.map(|rubber| Rubber {
                c10: f("rubber.c10", rubber.c10),
                c01: f("rubber.c01", rubber.c01),
                wall: f("rubber.wall", rubber.wall),
            }),
            cloth: self.cloth.map(|cloth| TautCloth {
                stiffness: f("cloth.stiffness", cloth.stiffness),
                radius: f("cloth.radius", cloth.radius),
            }),
            energy: self.energy.as_ref().map(|formula| formula.map_named(&ENERGY, &mut f)),
            area: self.area.as_ref().map(|formula| formula.map_named(&AREA, &mut f)),
            twist: self.twist.as_ref().map(|formula| formula.map_named(&TWIST, &mut f)),
        }
    }

    /// The numbers with their names, in the order of [`Parts::map`].
    #[must_use]
    pub fn numbers(&self) -> Vec<(&'static str, D)> {
        let mut numbers = Vec::with_capacity(PARTS);
        self.map(|name, number| numbers.push((name, number)));
        numbers
    }
}

impl Parts<Jet> {
    /// Sets the radius of the fibres at the fittings. In a pleated muscle this is its radius; in a braid it
    /// may differ from the radius at rest.
    pub fn set_fitting(&mut self, radius: Jet) {
        match self.kind {
            Kind::Pleated => self.radius = radius,
            // Fittings that follow the braid go on following it if their radius is the same.
            Kind::Braided
                if self.fitting.is_none()
                    && radius.value().to_bits() == self.radius.value().to_bits()
                    && !radius.moves() => {}
            Kind::Braided => self.fitting = Some(radius),
        }
    }

    /// Sets a constant of the rubber. Rubber that isn't there yet takes the thickness of the wall. At 0 the
    /// muscle keeps its stated values.
    ///
    /// # Errors
    /// If the constant is negative or not finite, or if a wall is needed and not known. `key` is the place of
    /// the constant in a muscle file.
    pub fn set_rubber(
        &mut self,
        key: &'static str,
        constant: Jet,
        which: impl Fn(&mut Rubber<Jet>) -> &mut Jet,
    ) -> Result<(), MuscleError> {
        check::not_negative(key, Pressure::pa(constant.value()))?;
        if constant.value() == 0.0 && (self.rubber.is_some() || !constant.moves()) {
            return Ok(());
        }
        let Some(wall) = self.rubber.map(|rubber| rubber.wall).or(self.wall) else {
            // Rubber that isn't there yet needs no wall.
            return if constant.value() == 0.0 { Ok(()) } else { Err(MuscleError::NoWall) };
        };
        let none = Jet::from(0.0);
        *which(self.rubber.get_or_insert(Rubber { c10: none, c01: none, wall })) = constant;
        Ok(())
    }
}

impl<D: Real> Parts<D> {
    /// The values without derivatives.
    #[must_use]
    pub fn values(&self) -> Parts {
        self.map(|_, number| number.value())
    }

    /// Whether the parts are those of a pleated muscle.
    #[must_use]
    pub fn is_pleated(&self) -> bool {
        self.kind.is_pleated()
    }

    /// Whether the parts contain a formula of the user.
    pub(crate) fn has_formulas(&self) -> bool {
        self.energy.is_some() || self.area.is_some() || self.twist.is_some()
    }

    /// Whether a formula may depend on the pressure.
    pub(crate) fn follows_pressure(&self) -> bool {
        self.twist.is_some() || self.area.is_some()
    }

    /// Number of fibres to which tension and stiffness refer. 1 if the muscle doesn't say or is continuous.
    pub(crate) fn fibre_number(&self) -> D {
        self.fibres.unwrap_or(D::from(1.0))
    }

    /// The dimensionless net under a pressure \[Pa\]: lengths over R, forces over p R^2.
    pub(crate) fn net(&self, pressure: D) -> Net<D> {
        let radius = self.radius;
        // Fibres at an angle make the unpressurised muscle a braid of radius R. The law of pinned crossings
        // needs a second family, or cloth that takes the torque: a lone family would follow geodesics.
        let (sin, cos) = self.angle.sin_cos();
        let none = D::from(f64::NAN);
        let inputs = [none, none, none, radius, pressure, self.angle, self.length];
        let turn = self.twist.as_ref().map(|twist| twist.run::<1>(inputs)[0] * radius);
        // Per unstretched fibre length: 2 pi r0 W per axial length at rest, cos(alpha0) of that.
        let scale = cos * (2.0 * PI) / (radius * pressure);
        let rubber = self.rubber.map(|rubber| {
            let scale = rubber.wall * scale;
            EvenPowers::mooney_rivlin(scale * rubber.c10, scale * rubber.c01)
        });
        let even = self.energy.as_ref().and_then(|energy| energy.even_powers(inputs));
        let own = even.map(|terms| EvenPowers { terms: terms.map(|term| scale * term) });
        let energy = if own.is_none() { self.energy.clone() } else { None };
        let formulas = (energy.is_some() || self.area.is_some()).then(|| {
            Box::new(Formulas {
                energy,
                area: self.area.clone(),
                scale,
                radius,
                pressure,
                angle: self.angle,
                length: self.length,
            })
        });
        let polygon = self.fibres.filter(|_| self.is_polygon);
        Net {
            half_fibre: self.length / (radius * 2.0) / cos,
            cos_rest: cos,
            sin2_rest: sin * sin,
            turn: turn.unwrap_or(sin),
            end_radius: self.fitting.map_or(D::from(1.0), |fitting| fitting / radius),
            depth: self.depth / radius,
            compliance: pressure * radius * radius * self.compliance,
            area_factor: polygon
                .map_or(D::from(1.0), |n| n * (D::from(2.0 * PI) / n).sin_cos().0 / (2.0 * PI)),
            lobes: polygon
                .and_then(|n| self.lobes.map(|circumference| Lobes::new(n, circumference / radius))),
            rubber: match (rubber, own) {
                (Some(rubber), Some(own)) => Some(rubber.with(&own)),
                (rubber, own) => rubber.or(own),
            },
            cloth: self.cloth.map(|cloth| Cloth {
                stiffness: cloth.stiffness / (pressure * radius),
                radius: cloth.radius / radius,
            }),
            formulas,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{FibreError, Problem};
    use bulge_muscles::{Pressure, from_toml};

    /// Straight fibres have a closed form for muscles that are longer than an integration follows.
    #[test]
    fn misaligned_fibres_have_ranges_of_their_own() {
        let of = |length: &str, effects: &str| {
            let text = format!(
                "name = \"m\"\nkind = \"pleated\"\nlength = \"{length}\"\nradius = \"16 mm\"\nfibres = 40\n{effects}"
            );
            Problem::new(&from_toml(&text, "m.toml").unwrap(), Pressure::bar(2.0))
        };
        let turned =
            |degrees: u32| format!("effects = {{ fibre-misalignment = {{ angle = \"{degrees} deg\" }} }}\n");
        let refused = |found: Result<Problem, FibreError>| match found {
            Err(FibreError::OutOfRange { what, .. }) => what,
            other => panic!("{other:?}"),
        };
        assert!(
            of("3.2 m", "").is_ok() && of("110 mm", &turned(4)).is_ok() && of("1.5 m", &turned(4)).is_ok()
        );
        assert_eq!(refused(of("3.2 m", &turned(4))), "slenderness l0/R (with misaligned fibres)");
        assert_eq!(refused(of("20 m", "")), "slenderness l0/R");
        assert_eq!(refused(of("110 mm", &turned(60))), "misalignment in degrees");
    }
}
