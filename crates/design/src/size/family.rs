//! Muscles of one kind in every length: their pull and their limits.

use bulge_effects::Known;
use bulge_effects::law::{CoefficientTable, Law, LawGeometry, LawPoint};
use bulge_fibre::{Approach, BRAIDED_SLENDERNESS, FibreError, Given, PLEATED_SLENDERNESS};
use bulge_model::{MuscleWithEffects, MuscleWithEffectsError};
use bulge_muscles::{Kind, Muscle, MuscleError, Parameter, Pressure, Quantity};
use serde::Serialize;

use super::SizeError;

/// Limits of a kind of muscle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limits {
    /// Highest gauge pressure \[Pa\].
    pub pressure_pa: f64,
    /// Smallest and largest contraction.
    pub contraction: [f64; 2],
    /// Shortest and longest available muscle \[m\].
    pub length_m: [f64; 2],
    /// Largest force that it may carry \[N\].
    pub force_n: f64,
}

impl Limits {
    /// Limits of a Festo fluidic muscle of 20 mm, as stated by the manufacturer: 6 bar, contractions up to
    /// 25 %, 40 mm to 9 m, 1500 N.
    pub const FLUIDIC: Self =
        Self { pressure_pa: 6e5, contraction: [0.0, 0.25], length_m: [0.04, 9.0], force_n: 1500.0 };
    /// Limits of a pleated muscle: 3 bar and 3000 N as tested in S1, 5 to 35 % as S1 recommends for the life
    /// of the fibres, and lengths about those that were built.
    pub const PLEATED: Self =
        Self { pressure_pa: 3e5, contraction: [0.05, 0.35], length_m: [0.03, 1.0], force_n: 3000.0 };

    /// The limits of a kind.
    #[must_use]
    pub const fn of(kind: Kind) -> Self {
        if kind.is_pleated() { Self::PLEATED } else { Self::FLUIDIC }
    }

    fn check(&self) -> Result<(), SizeError> {
        let wish = |what, value, range| Err(SizeError::out_of_range(what, value, range));
        if !(self.pressure_pa > 0.0 && self.pressure_pa.is_finite()) {
            return wish("highest pressure [Pa]", self.pressure_pa, "a pressure above 0");
        }
        let [low, high] = self.contraction;
        if !(-1.0..1.0).contains(&low) {
            return wish("contraction where the muscle begins [%]", low, "between -100 % and 100 %");
        }
        if !(high > low && high < 1.0) {
            return wish(
                "largest contraction [%]",
                high,
                "beyond that where the muscle begins, and below 100 %",
            );
        }
        let [low, high] = self.length_m;
        if !(low > 0.0 && low.is_finite()) {
            return wish("shortest length [m]", low, "a length above 0");
        }
        if !(high >= low && high.is_finite()) {
            return wish("longest length [m]", high, "no shorter than the shortest one");
        }
        if !(self.force_n > 0.0 && self.force_n.is_finite()) {
            return wish("largest force [N]", self.force_n, "a force above 0");
        }
        Ok(())
    }
}

/// Source of the force.
#[derive(Debug, Clone)]
enum Source {
    /// A published force law, multiplied by the scale of the cross-section.
    Law { law: &'static Law, geometry: LawGeometry, coefficients: Vec<f64>, scale: f64 },
    /// The equilibrium of a muscle, with its known effects.
    Net { muscle: Box<Muscle>, known: Vec<Known>, is_similar: bool },
}

/// Muscles that differ by their length.
#[derive(Debug, Clone)]
pub struct Family {
    name: String,
    diameter_m: f64,
    limits: Limits,
    basis: String,
    source: Source,
}

impl Family {
    /// Muscles whose force is given by a law, with the coefficients of a table or with typical ones.
    ///
    /// # Errors
    /// If the limits are invalid.
    pub fn of_law(
        name: &str,
        law: &'static Law,
        table: Option<&'static CoefficientTable>,
        muscle: &Muscle,
        limits: Limits,
    ) -> Result<Self, SizeError> {
        limits.check()?;
        let geometry = LawGeometry::from(muscle);
        let basis = match table {
            Some(table) => format!("{} with {} ({})", law.name, table.name, table.source),
            None => format!("{} with typical numbers", law.name),
        };
        let coefficients = law.start(&geometry, table);
        let source = Source::Law { law, geometry, coefficients, scale: 1.0 };
        Ok(Self { name: name.to_owned(), diameter_m: 2.0 * geometry.radius, limits, basis, source })
    }

    /// Muscles like this one in every length, computed from the equilibrium of their fibres and with the
    /// known effects. Lengths are limited to the slenderness for which meridians are computed,
    /// [`PLEATED_SLENDERNESS`] or [`BRAIDED_SLENDERNESS`].
    ///
    /// # Errors
    /// If the limits are invalid.
    pub fn of_muscle(muscle: &Muscle, known: Vec<Known>, mut limits: Limits) -> Result<Self, SizeError> {
        let radius = muscle.radius().si().max(muscle.end_radius().si());
        let [low, high] = limits.length_m;
        let least = muscle.radius().si().min(muscle.end_radius().si());
        let [stocky, slender] = if muscle.is_pleated() { PLEATED_SLENDERNESS } else { BRAIDED_SLENDERNESS };
        // Slightly inside, so that rounding doesn't leave the range.
        limits.length_m = [low.max(radius * stocky * (1.0 + 1e-9)), high.min(least * slender * (1.0 - 1e-9))];
        limits.check()?;
        // Effects that change the shape are numbers of the muscle itself.
        let mut effects: Vec<&str> = known.iter().map(|(effect, _)| effect.card().name).collect();
        effects.extend(muscle.bladder_wall().map(|_| "bladder-elasticity"));
        effects.extend(muscle.get(Parameter::HoopStiffness).map(|_| "limited-unfolding"));
        let basis = if effects.is_empty() {
            "equilibrium".to_owned()
        } else {
            format!("equilibrium with {}", effects.join(", "))
        };
        Ok(Self {
            name: muscle.name().to_owned(),
            diameter_m: 2.0 * muscle.radius().si(),
            limits,
            basis,
            source: Source::Net { muscle: Box::new(muscle.clone()), known, is_similar: false },
        })
    }

    /// The family with every radius proportional to the length, as S1 requires for pleated muscles of another
    /// length. They keep their slenderness l0/R, and with it the force over p l0^2 and the room for their
    /// cloth.
    ///
    /// This applies only if no effects of the muscle are known, since their numbers hold for its own radius.
    /// Otherwise, and for a law, the family is unchanged.
    #[must_use]
    pub fn similar(mut self) -> Self {
        if let Source::Net { known, is_similar, muscle } = &mut self.source
            && known.is_empty()
            && muscle.get(Parameter::HoopStiffness).is_none()
            && !*is_similar
        {
            *is_similar = true;
            self.basis += ", radius in proportion to the length";
        }
        self
    }

    /// Muscles of another diameter with a similar cross-section. At equal pressure and contraction the force
    /// is proportional to the square of the diameter, and so is its limit.
    ///
    /// A family whose force is an equilibrium is unchanged; state the other radius in its muscle instead.
    #[must_use]
    pub fn scaled(mut self, name: &str, diameter_m: f64) -> Self {
        if let Source::Law { scale, .. } = &mut self.source {
            let ratio = diameter_m / self.diameter_m;
            *scale *= ratio * ratio;
            self.limits.force_n *= ratio * ratio;
            self.basis = format!("{}, scaled from {:.0} mm", self.basis, 1e3 * self.diameter_m);
            self.diameter_m = diameter_m;
            name.clone_into(&mut self.name);
        }
        self
    }

    /// The family under another name.
    #[must_use]
    pub fn named(mut self, name: &str) -> Self {
        name.clone_into(&mut self.name);
        self
    }

    /// The family with other limits.
    ///
    /// # Errors
    /// If the limits are invalid.
    pub fn with_limits(mut self, limits: Limits) -> Result<Self, SizeError> {
        limits.check()?;
        self.limits = limits;
        Ok(self)
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its nominal diameter \[m\]; twice the radius for a muscle file.
    #[must_use]
    pub fn diameter_m(&self) -> f64 {
        self.diameter_m
    }

    /// Its limits.
    #[must_use]
    pub fn limits(&self) -> Limits {
        self.limits
    }

    /// Source of its forces, in words.
    #[must_use]
    pub fn basis(&self) -> &str {
        &self.basis
    }

    /// The muscle of the given length \[m\].
    ///
    /// # Errors
    /// If the muscle can't have this length.
    pub fn at(&self, length_m: f64) -> Result<CutMuscle<'_>, SizeError> {
        let wrong = |why: String| SizeError::Muscle { family: self.name.clone(), length_m, why };
        let mut diameter_m = self.diameter_m;
        let pull = match &self.source {
            Source::Law { law, geometry, coefficients, scale } => Pull::Law {
                law,
                geometry: LawGeometry { length: length_m, ..*geometry },
                coefficients,
                scale: *scale,
            },
            Source::Net { muscle, known, is_similar } => {
                let factor = if *is_similar { length_m / muscle.length().si() } else { 1.0 };
                diameter_m *= factor;
                let muscle = stretched(muscle, length_m, factor).map_err(|error| wrong(error.to_string()))?;
                let extended =
                    MuscleWithEffects::new(&muscle, known).map_err(|error| wrong(error.to_string()))?;
                Pull::Net(Box::new(extended))
            }
        };
        Ok(CutMuscle { family: self, length_m, diameter_m, pull })
    }
}

/// Lateral dimensions of a muscle.
const ACROSS: [Parameter; 5] = [
    Parameter::Radius,
    Parameter::FittingRadius,
    Parameter::PleatDepth,
    Parameter::ClothCircumference,
    Parameter::UnfoldedRadius,
];

/// A muscle of another length, with its lateral dimensions multiplied by a factor.
fn stretched(muscle: &Muscle, length_m: f64, factor: f64) -> Result<Muscle, MuscleError> {
    let mut changed = muscle.with(Parameter::Length, length_m)?;
    for parameter in ACROSS {
        if let (Some(value), true) = (muscle.get(parameter), factor.to_bits() != 1.0_f64.to_bits()) {
            changed = changed.with(parameter, factor * value)?;
        }
    }
    Ok(changed)
}

/// Computation of the pull of a muscle of one length.
#[derive(Debug)]
enum Pull<'a> {
    Law { law: &'static Law, geometry: LawGeometry, coefficients: &'a [f64], scale: f64 },
    Net(Box<MuscleWithEffects>),
}

/// A muscle of a family, with a length.
#[derive(Debug)]
pub struct CutMuscle<'a> {
    family: &'a Family,
    length_m: f64,
    diameter_m: f64,
    pull: Pull<'a>,
}

impl CutMuscle<'_> {
    /// Its family.
    #[must_use]
    pub fn family(&self) -> &Family {
        self.family
    }

    /// Its length \[m\].
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Its nominal diameter \[m\].
    #[must_use]
    pub fn diameter_m(&self) -> f64 {
        self.diameter_m
    }

    /// Pull \[N\] at a gauge pressure \[Pa\] and a contraction. It is 0 where the muscle would push, or
    /// without pressure. It is infinite where fibres that don't stretch are straight.
    ///
    /// # Errors
    /// If no equilibrium was found for another reason than these.
    pub fn force_n(&self, pressure_pa: f64, contraction: f64) -> Result<f64, SizeError> {
        if pressure_pa <= 0.0 {
            return Ok(0.0);
        }
        let wrong = |why: String| SizeError::Muscle {
            family: self.family.name.clone(),
            length_m: self.length_m,
            why,
        };
        match &self.pull {
            Pull::Law { law, geometry, coefficients, scale } => {
                // The pull while lifting: laws that distinguish directions give a smaller force for a
                // shortening muscle.
                let at = LawPoint { pressure: pressure_pa, contraction, direction: 1.0 };
                if !law.is_defined_at(at) {
                    return Ok(f64::INFINITY);
                }
                Ok((scale * law.force(at, geometry, coefficients)).max(0.0))
            }
            Pull::Net(extended) => {
                let pressure = Pressure::pa(pressure_pa);
                match extended.solve(pressure, Given::Contraction(contraction), Approach::Auto) {
                    Ok(found) => {
                        let lifting =
                            extended.force_while(&found, 1.0).map_err(|error| wrong(error.to_string()))?;
                        Ok(lifting.max(0.0))
                    }
                    Err(MuscleWithEffectsError::Equilibrium(error)) => match *error {
                        FibreError::BeyondLimit { .. }
                        | FibreError::WouldPush { .. }
                        | FibreError::Slack { .. } => Ok(0.0),
                        FibreError::TooLong { .. } => Ok(f64::INFINITY),
                        other => Err(wrong(other.to_string())),
                    },
                    Err(error) => Err(wrong(error.to_string())),
                }
            }
        }
    }

    /// Contractions and forces of an isobar, from the initial contraction to the largest one, or to where the
    /// pull vanishes. Points with an infinite force are left out.
    ///
    /// # Errors
    /// As [`CutMuscle::force_n`].
    pub fn isobar(&self, pressure_pa: f64, points: usize) -> Result<Vec<[f64; 2]>, SizeError> {
        let [low, high] = self.family.limits.contraction;
        let last = points.max(2) - 1;
        let mut isobar = Vec::with_capacity(points);
        for k in 0..=last {
            let contraction = low + (high - low) * k as f64 / last as f64;
            let force = self.force_n(pressure_pa, contraction)?;
            if force.is_finite() {
                isobar.push([contraction, force]);
            }
            if force == 0.0 {
                break;
            }
        }
        Ok(isobar)
    }
}
