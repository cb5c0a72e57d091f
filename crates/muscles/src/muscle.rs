//! One muscle: its construction, its materials and the instruments it is measured with, always valid.

use crate::construction::{Braided, Construction, Ends, FibreCount, Kind, Pleated};
use crate::error::{MuscleError, check};
use crate::file_error::FileError;
use crate::fitted::FittedNumbers;
use crate::instrument::Instruments;
use crate::learnt::Learnt;
use crate::material::Fibre;
use crate::parameter::Parameter;
use crate::quantity::{Angle, Area, Force, Length};
use crate::shown::{LONGEST_NAME, one_line};
use crate::specimen::Specimen;
use crate::units::Quantity;

/// A pneumatic artificial muscle.
///
/// ```
/// use bulge_muscles::{Construction, FibreCount, Length, Muscle, Parameter, Pleated};
/// let pleated = Pleated::new(Length::mm(16.0), FibreCount::Discrete(40))?;
/// let muscle = Muscle::new("second-generation PPAM", Length::mm(110.0), Construction::Pleated(pleated))?;
/// let slender = muscle.with(Parameter::Radius, 0.0115)?;
/// assert_eq!(slender.end_radius(), Length::mm(11.5));
/// assert!(muscle.with(Parameter::Radius, -0.0115).is_err());
/// # Ok::<(), bulge_muscles::MuscleError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Muscle {
    name: String,
    kind: Kind,
    ends: Ends,
    /// The numbers in SI that have a place of their own in the file, in the order of [`Parameter::ALL`]. Those of
    /// a bladder stand together, as do those of a limit to the unfolding; a pleated muscle without fibres is
    /// continuous.
    numbers: [Option<f64>; Parameter::ALL.len()],
    fibre_section: Option<Area>,
    /// Thickness of the bladder in SI if it is not that of the muscle's wall.
    bladder_wall: Option<f64>,
    /// Whether the gas acts on the inner face of the wall, however thick that is.
    has_inner_gas: bool,
    pub(crate) learnt: Vec<Learnt>,
    pub(crate) instruments: Instruments,
    widths: Vec<(Parameter, f64)>,
    pub(crate) specimens: Vec<Specimen>,
    pub(crate) data_columns: Vec<(String, String)>,
    pub(crate) fitted: Option<FittedNumbers>,
}

impl Muscle {
    /// A muscle of unpressurised length l0 between the end fittings, with inextensible fibres and no bladder.
    ///
    /// # Errors
    /// If the name is blank, the length is not finite and > 0, or the wall leaves no room for gas.
    pub fn new(
        name: impl Into<String>,
        length: Length,
        construction: Construction,
    ) -> Result<Self, MuscleError> {
        Parameter::Length.check(length.si())?;
        let mut numbers = [None; Parameter::ALL.len()];
        let mut put = |parameter, value| numbers[parameter as usize] = Some(value);
        put(Parameter::Length, length.si());
        let mut ends = Ends::Clamped;
        let fibres = match construction {
            Construction::Pleated(pleated) => {
                put(Parameter::Radius, pleated.radius.si());
                put(Parameter::PleatDepth, 0.0);
                put(Parameter::Misalignment, 0.0);
                if let FibreCount::Discrete(count) = pleated.fibres { Some(count) } else { None }
            }
            Construction::Braided(braided) => {
                put(Parameter::Radius, braided.radius.si());
                put(Parameter::BraidAngle, braided.braid_angle.si());
                if let Some(wall) = braided.wall {
                    put(Parameter::Wall, wall.si());
                }
                ends = braided.ends;
                braided.fibres
            }
        };
        if let Some(count) = fibres {
            put(Parameter::Fibres, f64::from(count));
        }
        let muscle = Self {
            name: String::new(),
            kind: construction.kind(),
            ends,
            numbers,
            fibre_section: None,
            bladder_wall: None,
            has_inner_gas: false,
            learnt: Vec::new(),
            instruments: Instruments::default(),
            widths: Vec::new(),
            specimens: Vec::new(),
            data_columns: Vec::new(),
            fitted: None,
        };
        muscle.checked()?.with_name(name)
    }

    /// The same muscle under another name, which is kept as a file can state it: on one line, of at most 1000 bytes.
    ///
    /// # Errors
    /// If the name is blank.
    pub fn with_name(mut self, name: impl Into<String>) -> Result<Self, MuscleError> {
        self.name = one_line(&name.into()).into_owned();
        self.name.truncate(self.name.floor_char_boundary(LONGEST_NAME));
        if self.name.trim().is_empty() { Err(MuscleError::NoName) } else { Ok(self) }
    }

    /// The same muscle with fibres that stretch.
    ///
    /// # Errors
    /// If a braid does not say how many fibres it has: the stiffness is per fibre.
    pub fn with_fibre(mut self, fibre: Fibre) -> Result<Self, MuscleError> {
        self.fibre_section = fibre.section();
        self.with(Parameter::FibreStiffness, fibre.stiffness().si())
    }

    /// The same muscle, if its numbers agree: those that need another one have it, and the walls leave room
    /// for gas inside the braid and its fittings.
    fn checked(self) -> Result<Self, MuscleError> {
        if self.stated(Parameter::Fibres).is_none() {
            if !self.is_pleated() && self.stated(Parameter::FibreStiffness).is_some() {
                return Err(MuscleError::NoFibreCount);
            }
            if self.stated(Parameter::ClothCircumference).is_some() {
                return Err(MuscleError::LobesOfContinuous);
            }
        }
        let [hoop, unfolded] = [Parameter::HoopStiffness, Parameter::UnfoldedRadius];
        if self.stated(hoop).is_some() != self.stated(unfolded).is_some() {
            let parameter = if self.stated(hoop).is_some() { hoop } else { unfolded };
            return Err(MuscleError::HalfUnfolding { parameter });
        }
        if let (Some(c10), Some(c01)) = (self.stated(Parameter::C10), self.stated(Parameter::C01)) {
            if self.wall().is_none() {
                return Err(MuscleError::NoWall);
            }
            if c10 + c01 <= 0.0 {
                return Err(MuscleError::NoElasticity { c10, c01 });
            }
        }
        if self.has_inner_gas && self.wall().is_none() {
            return Err(MuscleError::NoGasWall);
        }
        let radius = self.radius().si();
        let walls = [
            ("wall", Parameter::Wall, radius),
            ("effects.wall-thickness", Parameter::GasWall, radius.min(self.end_radius().si())),
        ];
        for (key, wall, radius_m) in walls {
            if let Some(wall_m) = self.get(wall).filter(|wall| *wall >= radius_m) {
                return Err(MuscleError::WallTooThick { key, wall_m, radius_m });
            }
        }
        Ok(self)
    }

    /// The same muscle with a bladder of this thickness, once its rubber is stated. Without, the bladder is as
    /// thick as the wall.
    pub(crate) fn with_bladder_wall(mut self, wall: Length) -> Result<Self, MuscleError> {
        check::positive("effects.bladder-elasticity.wall", wall)?;
        self.bladder_wall = Some(wall.si()).filter(|wall| self.get(Parameter::Wall) != Some(*wall));
        Ok(self)
    }

    /// The same muscle with gas that acts not at the braid radius but at this thickness inside it, on the
    /// inner face of the wall. `None`: the thickness of the muscle's wall, also if that is changed later.
    ///
    /// The wall keeps its thickness (C.-P. Chou and B. Hannaford, 1996). Rubber keeps its *volume* instead,
    /// and a braid that lies in the wall at the stated radius then needs no correction at all.
    ///
    /// # Errors
    /// If the thickness is negative, not finite or leaves no room for gas, if none is given and that of the
    /// wall is not known, or if the muscle is pleated.
    pub fn with_gas_wall(mut self, thickness: Option<Length>) -> Result<Self, MuscleError> {
        if let Some(thickness) = thickness {
            return self.with(Parameter::GasWall, thickness.si());
        }
        self.check_kind(Parameter::GasWall)?;
        *self.place(Parameter::GasWall) = None;
        self.has_inner_gas = true;
        self.checked()
    }

    /// The same muscle with other ends, if it is a braid: clamped in fittings, or a cylinder to the end.
    #[must_use]
    pub fn with_ends(self, ends: Ends) -> Self {
        if self.is_pleated() { self } else { Self { ends, ..self } }
    }

    /// The same muscle with a stated width (one standard deviation, SI) of a parameter; it replaces an
    /// earlier one. 0 says that the number is exact.
    ///
    /// # Errors
    /// If the width is not finite and >= 0, or the parameter is a count or is not stated.
    pub fn with_width(mut self, parameter: Parameter, width: f64) -> Result<Self, MuscleError> {
        if !(width.is_finite() && width >= 0.0) {
            return Err(MuscleError::NegativeWidth { parameter, width });
        }
        if parameter == Parameter::Fibres || !self.is_stated(parameter) {
            return Err(MuscleError::NoWidth { parameter });
        }
        self.widths.retain(|(other, _)| *other != parameter);
        self.widths.push((parameter, width.abs()));
        self.widths.sort_by_key(|(parameter, _)| *parameter);
        Ok(self)
    }

    /// A copy with one parameter changed, in SI; a parameter that was absent is added.
    ///
    /// - `Radius`: radii that are not stated separately follow. For a pleated muscle with a separate end
    ///   radius it means that one, the radius that acts.
    /// - `Wall`: a bladder of the same thickness follows, and so does gas on the inner face of the wall.
    /// - `GasWall` adds the effect if it is absent.
    /// - `Fibres` must be a whole number; a continuous membrane becomes discrete.
    /// - `C10` or `C01` add a bladder to a braid without one, if the wall is known.
    ///
    /// # Errors
    /// If the value is out of range, or the muscle cannot have the parameter.
    pub fn with(&self, parameter: Parameter, value: f64) -> Result<Self, MuscleError> {
        let mut changed = self.clone();
        changed.set(parameter, value)?;
        changed.checked()
    }

    /// A copy with several parameters changed, in SI. A number that doesn't change leaves the muscle as it is,
    /// to the bit. Numbers that need each other may be new together.
    ///
    /// # Errors
    /// As [`Muscle::with`].
    pub fn with_all(&self, numbers: &[(Parameter, f64)]) -> Result<Self, MuscleError> {
        let mut changed = self.clone();
        for &(parameter, value) in numbers {
            if changed.get(parameter) != Some(value) {
                changed.set(parameter, value)?;
            }
        }
        changed.checked()
    }

    /// Changes one number, whether or not it agrees with the others.
    fn set(&mut self, parameter: Parameter, value: f64) -> Result<(), MuscleError> {
        self.check_kind(parameter)?;
        let has = |parameter| self.stated(parameter).is_some();
        let is_end = parameter == Parameter::Radius && self.is_pleated() && has(Parameter::FittingRadius);
        let parameter = if is_end { Parameter::FittingRadius } else { parameter };
        parameter.check(value)?;
        if parameter == Parameter::Wall && self.bladder_wall.is_some() && !has(Parameter::Wall) {
            self.bladder_wall = Some(value);
            return Ok(());
        }
        *self.place(parameter) = Some(value);
        match parameter {
            Parameter::C10 => _ = self.place(Parameter::C01).get_or_insert(0.0),
            Parameter::C01 => _ = self.place(Parameter::C10).get_or_insert(0.0),
            Parameter::Wall => {
                self.bladder_wall = self.bladder_wall.filter(|wall| wall.to_bits() != value.to_bits());
            }
            Parameter::GasWall => self.has_inner_gas = false,
            _ => {}
        }
        Ok(())
    }

    fn check_kind(&self, parameter: Parameter) -> Result<(), MuscleError> {
        match parameter.kind().filter(|owner| *owner != self.kind) {
            Some(owner) => Err(MuscleError::OtherKind { parameter, kind: self.kind, owner }),
            None => Ok(()),
        }
    }

    /// The value of a parameter in SI; `None` if the muscle does not have it.
    #[must_use]
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        match parameter {
            Parameter::Radius if self.is_pleated() => {
                self.stated(Parameter::FittingRadius).or_else(|| self.stated(Parameter::Radius))
            }
            Parameter::FittingRadius => self.stated(parameter).or_else(|| self.stated(Parameter::Radius)),
            Parameter::Wall => self.stated(parameter).or(self.bladder_wall),
            Parameter::GasWall if self.has_inner_gas => self.get(Parameter::Wall),
            _ => self.stated(parameter),
        }
    }

    /// The number as the file states it, if it has a place of its own there.
    pub(crate) fn stated(&self, parameter: Parameter) -> Option<f64> {
        self.numbers[parameter as usize]
    }

    fn place(&mut self, parameter: Parameter) -> &mut Option<f64> {
        &mut self.numbers[parameter as usize]
    }

    fn length_of(&self, parameter: Parameter) -> Option<Length> {
        self.get(parameter).map(Length::from_si)
    }

    /// The name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Unpressurised length l0 between the end fittings.
    #[must_use]
    pub fn length(&self) -> Length {
        self.length_of(Parameter::Length).unwrap_or(Length::m(0.0))
    }

    /// How it is built, at the radius that acts.
    #[must_use]
    pub fn construction(&self) -> Construction {
        let (radius, fibres) = (self.radius(), self.fibres());
        match self.kind {
            Kind::Pleated => {
                let fibres = fibres.map_or(FibreCount::Continuous, FibreCount::Discrete);
                Construction::Pleated(Pleated { radius, fibres })
            }
            Kind::Braided => {
                let braid_angle = Angle::rad(self.get(Parameter::BraidAngle).unwrap_or(0.0));
                let wall = self.stated(Parameter::Wall).map(Length::m);
                Construction::Braided(Braided { radius, braid_angle, fibres, ends: self.ends, wall })
            }
        }
    }

    /// The family.
    #[must_use]
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Whether it is a pleated muscle.
    #[must_use]
    pub fn is_pleated(&self) -> bool {
        self.kind == Kind::Pleated
    }

    /// Pleated: fibre radius R that acts at the fittings; braided: braid radius r0 at rest.
    #[must_use]
    pub fn radius(&self) -> Length {
        self.length_of(Parameter::Radius).unwrap_or(Length::m(0.0))
    }

    /// Radius at the end fittings: of the fibres in a pleated muscle, of the clamped ends in a braid.
    #[must_use]
    pub fn end_radius(&self) -> Length {
        self.length_of(Parameter::FittingRadius).unwrap_or(Length::m(0.0))
    }

    /// Number of fibres; `None` for a continuous membrane, or a braid that does not say.
    #[must_use]
    pub fn fibres(&self) -> Option<u32> {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number in range"
        )]
        self.get(Parameter::Fibres).map(|count| count as u32)
    }

    /// Fibres that stretch; `None` if they are inextensible.
    #[must_use]
    pub fn fibre(&self) -> Option<Fibre> {
        let stiffness = self.get(Parameter::FibreStiffness).map(Force::n)?;
        Some(Fibre { stiffness, section: self.fibre_section })
    }

    /// Thickness of the rubber bladder, if the muscle has one that counts: its own, else that of the wall.
    #[must_use]
    pub fn bladder_wall(&self) -> Option<Length> {
        self.get(Parameter::C10)?;
        self.bladder_wall.map(Length::m).or_else(|| self.wall())
    }

    /// The effects in the file besides those that shape the muscle, in the order of the file.
    #[must_use]
    pub fn learnt(&self) -> &[Learnt] {
        &self.learnt
    }

    /// An error in learnt effect number `index` with its place in the file: what, and what to write instead.
    #[must_use]
    pub fn learnt_error(
        &self,
        index: usize,
        what: impl Into<String>,
        instead: impl Into<String>,
    ) -> FileError {
        match self.learnt.get(index) {
            Some(effect) => effect.error(what, instead),
            None => FileError::whole(&self.name, what, instead),
        }
    }

    /// Refuses learnt effects whose name is not among `known`: slips, also in the name of an effect that
    /// shapes the muscle.
    ///
    /// # Errors
    /// Names the first one with its place in the file and the nearest known name.
    pub fn check_learnt(&self, known: &[&str]) -> Result<(), FileError> {
        self.learnt.iter().try_for_each(|effect| effect.check(known))
    }

    /// Stated widths ("110 mm +- 0.2 mm"), one standard deviation in SI each, ordered as [`Parameter::ALL`].
    #[must_use]
    pub fn widths(&self) -> &[(Parameter, f64)] {
        &self.widths
    }

    /// The stated width of one parameter.
    #[must_use]
    pub fn width(&self, parameter: Parameter) -> Option<f64> {
        self.widths.iter().find(|(other, _)| *other == parameter).map(|(_, width)| *width)
    }

    /// Wall thickness: the muscle's own, else the bladder's.
    #[must_use]
    pub fn wall(&self) -> Option<Length> {
        self.length_of(Parameter::Wall)
    }

    /// Whether the parameter has a place of its own in the muscle's file, where a width can be written. A
    /// fitting radius that is not stated follows the radius, and the inner face of the wall follows the wall.
    #[must_use]
    pub fn is_stated(&self, parameter: Parameter) -> bool {
        self.stated(parameter).is_some() || (parameter == Parameter::Wall && self.bladder_wall.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Area;

    fn pleated() -> Muscle {
        let pleated = Pleated::new(Length::mm(16.0), FibreCount::Discrete(40)).unwrap();
        Muscle::new("p", Length::mm(110.0), Construction::Pleated(pleated)).unwrap()
    }

    fn braided() -> Muscle {
        let braided = Braided::new(Length::mm(10.0), Angle::deg(25.0)).unwrap();
        Muscle::new("b", Length::mm(250.0), Construction::Braided(braided)).unwrap()
    }

    #[test]
    fn what_is_set_is_read() {
        let unfolding = [(Parameter::HoopStiffness, 81e3), (Parameter::UnfoldedRadius, 0.0526)];
        let full = [
            pleated().with_all(&unfolding).unwrap(),
            braided().with_all(&unfolding).unwrap().with(Parameter::Wall, 0.002).unwrap(),
        ];
        for muscle in full {
            for parameter in Parameter::ALL {
                let value = match parameter {
                    Parameter::Fibres => 30.0,
                    Parameter::Wall | Parameter::GasWall => 0.0023,
                    _ => 0.0123,
                };
                let muscle = if parameter == Parameter::FibreStiffness {
                    muscle.with(Parameter::Fibres, 30.0).unwrap()
                } else {
                    muscle.clone()
                };
                let changed = muscle.with(parameter, value);
                if parameter.kind().is_none_or(|kind| kind == muscle.kind()) {
                    assert_eq!(changed.unwrap().get(parameter), Some(value), "{parameter:?}");
                } else {
                    assert_eq!(muscle.get(parameter), None);
                    let message = changed.unwrap_err().to_string();
                    assert!(
                        message.contains(parameter.name()) && message.contains(muscle.kind().name()),
                        "{message}"
                    );
                }
            }
        }
    }

    #[test]
    fn no_parameter_takes_nonsense() {
        for muscle in [pleated(), braided().with(Parameter::Fibres, 60.0).unwrap()] {
            for parameter in Parameter::ALL {
                for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -100.0] {
                    assert!(muscle.with(parameter, value).is_err(), "{parameter:?} = {value}");
                }
            }
            for value in [2.0, 40.5, 1e10, 0.0] {
                let message = muscle.with(Parameter::Fibres, value).unwrap_err().to_string();
                assert!(message.contains("whole number of at least 3"), "{message}");
            }
        }
    }

    #[test]
    fn fittings_follow_the_braid_unless_stated() {
        let muscle = braided().with(Parameter::Radius, 0.012).unwrap();
        assert_eq!(muscle.end_radius(), Length::mm(12.0));
        let muscle =
            muscle.with(Parameter::FittingRadius, 0.008).unwrap().with(Parameter::Radius, 0.011).unwrap();
        assert_eq!((muscle.radius(), muscle.end_radius()), (Length::mm(11.0), Length::mm(8.0)));
        let muscle =
            pleated().with(Parameter::FittingRadius, 0.011).unwrap().with(Parameter::Radius, 0.012).unwrap();
        assert_eq!((muscle.radius(), muscle.end_radius()), (Length::mm(12.0), Length::mm(12.0)));
    }

    #[test]
    fn a_bladder_shares_the_wall() {
        assert_eq!(braided().with(Parameter::C10, 2e5), Err(MuscleError::NoWall));
        let muscle = braided().with(Parameter::Wall, 0.002).unwrap().with(Parameter::C10, 2e5).unwrap();
        let thick = muscle.with(Parameter::Wall, 0.003).unwrap();
        assert_eq!((thick.bladder_wall(), thick.get(Parameter::C10)), (Some(Length::mm(3.0)), Some(2e5)));
        assert_eq!(muscle.with(Parameter::C10, 0.0).unwrap_err().key(), "effects.bladder-elasticity.c10");
        // A bladder that states its own wall keeps it, unless the muscle has no other.
        let own =
            |muscle: Muscle| muscle.with_bladder_wall(Length::mm(1.0)).unwrap().with(Parameter::C10, 2e5);
        let muscle = own(braided()).unwrap();
        assert_eq!(muscle.get(Parameter::Wall), Some(0.001));
        let muscle = muscle.with(Parameter::Wall, 0.0015).unwrap();
        assert_eq!((muscle.stated(Parameter::Wall), muscle.bladder_wall()), (None, Some(Length::mm(1.5))));
        let two = own(braided().with(Parameter::Wall, 0.002).unwrap()).unwrap();
        let two = two.with(Parameter::Wall, 0.003).unwrap();
        assert_eq!((two.wall(), two.bladder_wall()), (Some(Length::mm(3.0)), Some(Length::mm(1.0))));
    }

    /// Numbers that need each other may come in any order, if they come together.
    #[test]
    fn the_order_of_numbers_does_not_count() {
        let mut rubber = [(Parameter::C10, 0.0), (Parameter::C01, 2e5), (Parameter::Wall, 0.002)];
        let muscle = braided().with_all(&rubber).unwrap();
        rubber.reverse();
        assert_eq!(braided().with_all(&rubber).as_ref(), Ok(&muscle));
        assert!(braided().with_all(&rubber[1..]).is_err() && muscle.with(Parameter::C01, 0.0).is_err());
        let lobes = [(Parameter::ClothCircumference, 0.33), (Parameter::Fibres, 40.0)];
        let pleated = Pleated::new(Length::mm(16.0), FibreCount::Continuous).unwrap();
        let muscle = Muscle::new("p", Length::mm(110.0), Construction::Pleated(pleated)).unwrap();
        assert_eq!(muscle.with_all(&lobes[..1]), Err(MuscleError::LobesOfContinuous));
        assert!(muscle.with_all(&lobes).is_ok());
    }

    #[test]
    fn nonsense_is_refused_with_its_number() {
        let braided = braided().with(Parameter::Wall, 0.002).unwrap();
        for (muscle, parameter, value, part) in [
            (pleated(), Parameter::FittingRadius, 0.0, "`effects.end-radius.radius` is 0 m"),
            (pleated(), Parameter::PleatDepth, -0.001, "-0.001 m"),
            (pleated(), Parameter::PleatDepth, f64::INFINITY, "inf"),
            (pleated(), Parameter::Misalignment, -std::f64::consts::FRAC_PI_2, "-90"),
            (pleated(), Parameter::Misalignment, f64::NAN, "NaN"),
            (pleated(), Parameter::ClothCircumference, -0.33, "-0.33 m"),
            (braided.clone(), Parameter::FittingRadius, 0.0, "end-radius"),
            (braided.clone(), Parameter::C10, -1.0, "c10` is -1 Pa"),
            (braided.clone(), Parameter::C01, f64::NAN, "c01` is NaN"),
            (braided.clone(), Parameter::C10, 0.0, "c10 = 0 Pa and c01 = 0 Pa"),
            (braided.clone(), Parameter::HoopStiffness, -1.0, "-1 N/m"),
            (braided, Parameter::UnfoldedRadius, f64::INFINITY, "inf m"),
        ] {
            let message = muscle.with(parameter, value).unwrap_err().to_string();
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
        let message = pleated().with_bladder_wall(Length::m(0.0)).unwrap_err().to_string();
        assert!(message.contains("wall` is 0 m"), "{message}");
    }

    #[test]
    fn gas_acts_on_the_wall_that_is_there() {
        assert!(matches!(
            braided().with(Parameter::Wall, braided().radius().si()),
            Err(MuscleError::WallTooThick { key: "wall", .. })
        ));
        assert!(matches!(
            braided().with(Parameter::GasWall, braided().radius().si()),
            Err(MuscleError::WallTooThick { key: "effects.wall-thickness", .. })
        ));
        assert_eq!(braided().with_gas_wall(None), Err(MuscleError::NoGasWall));
        let message = pleated().with_gas_wall(None).unwrap_err().to_string();
        assert!(message.contains("`gas_wall`") && message.contains("braided"), "{message}");
        let follows = braided().with(Parameter::Wall, 0.002).unwrap().with_gas_wall(None).unwrap();
        assert_eq!(
            (follows.get(Parameter::GasWall), follows.is_stated(Parameter::GasWall)),
            (Some(0.002), false)
        );
        assert_eq!(follows.with(Parameter::Wall, 0.003).unwrap().get(Parameter::GasWall), Some(0.003));
        let own = follows.with(Parameter::GasWall, 0.001).unwrap().with(Parameter::Wall, 0.003).unwrap();
        assert_eq!((own.get(Parameter::GasWall), own.wall()), (Some(0.001), Some(Length::mm(3.0))));
        assert!(own.with_width(Parameter::GasWall, 1e-4).is_ok());
        assert!(follows.with_width(Parameter::GasWall, 1e-4).is_err());
    }

    #[test]
    fn elastic_fibres_of_a_braid_are_counted() {
        let fibre = Fibre::new(Force::kn(12.0)).unwrap().with_section(Area::mm2(0.3)).unwrap();
        assert_eq!(braided().with_fibre(fibre), Err(MuscleError::NoFibreCount));
        let muscle = pleated().with_fibre(fibre).unwrap().with(Parameter::FibreStiffness, 5e3).unwrap();
        assert_eq!(muscle.fibre().unwrap().stiffness(), Force::kn(5.0));
        assert_eq!(muscle.fibre().unwrap().section(), Some(Area::mm2(0.3)));
    }

    #[test]
    fn widths_belong_to_stated_numbers() {
        let muscle = pleated().with_width(Parameter::Radius, 1e-4).unwrap();
        let muscle =
            muscle.with_width(Parameter::Length, 3e-4).unwrap().with_width(Parameter::Length, 2e-4).unwrap();
        assert_eq!(muscle.widths(), [(Parameter::Length, 2e-4), (Parameter::Radius, 1e-4)]);
        assert_eq!(muscle.width(Parameter::Length), Some(2e-4));
        assert_eq!(muscle.width(Parameter::C10), None);
        for parameter in [Parameter::Fibres, Parameter::FittingRadius, Parameter::BraidAngle] {
            assert_eq!(muscle.clone().with_width(parameter, 1e-4), Err(MuscleError::NoWidth { parameter }));
        }
        assert_eq!(
            muscle.clone().with_width(Parameter::Length, 0.0).unwrap().width(Parameter::Length),
            Some(0.0)
        );
        for width in [-1e-4, f64::NAN, f64::INFINITY] {
            assert!(muscle.clone().with_width(Parameter::Length, width).is_err());
        }
    }

    #[test]
    fn readers() {
        let muscle = braided();
        assert_eq!((muscle.kind(), muscle.is_pleated(), muscle.fibres()), (Kind::Braided, false, None));
        assert_eq!((muscle.fibre(), muscle.bladder_wall()), (None, None));
        assert_eq!(muscle.get(Parameter::BraidAngle), Some(Angle::deg(25.0).to_rad()));
        let Construction::Braided(braid) = muscle.construction() else { panic!("a braid") };
        assert_eq!((braid.ends(), braid.with_ends(Ends::Cylinder).ends()), (Ends::Clamped, Ends::Cylinder));
        assert_eq!(pleated().fibres(), Some(40));
        assert_eq!(muscle.clone().with_name("  "), Err(MuscleError::NoName));
        assert!(muscle.with(Parameter::HoopStiffness, 1e4).unwrap_err().to_string().contains("together"));
    }
}
