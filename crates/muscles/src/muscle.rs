//! One muscle: its construction, its materials and the instruments it is measured with, always valid.

use crate::construction::{Braided, Construction, Ends, FibreCount, Kind, Pleated};
use crate::error::{MuscleError, check};
use crate::file_error::FileError;
use crate::fitted::FittedNumbers;
use crate::instrument::Instruments;
use crate::learnt::Learnt;
use crate::material::{Bladder, Fibre, Unfolding};
use crate::parameter::Parameter;
use crate::quantity::{Angle, Force, Length, LineStiffness, Pressure};
use crate::specimen::Specimen;
use crate::units::Quantity;
use serde::Serialize;

/// Where the gas acts in the wall of a braid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum GasWall {
    /// At the wall's inner face. The thickness is that of the wall and follows it.
    Inner,
    /// At a depth of its own.
    At(Length),
}

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
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Muscle {
    name: String,
    length: Length,
    construction: Construction,
    fibre: Option<Fibre>,
    bladder: Option<Bladder>,
    unfolding: Option<Unfolding>,
    gas_wall: Option<GasWall>,
    pub(crate) learnt: Vec<Learnt>,
    pub(crate) instruments: Instruments,
    widths: Vec<(Parameter, f64)>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) specimens: Vec<Specimen>,
    pub(crate) data_columns: Vec<(String, String)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fitted: Option<FittedNumbers>,
}

impl Muscle {
    /// A muscle of unpressurised length l0 between the end fittings, with inextensible fibres and no bladder.
    ///
    /// # Errors
    /// If the name is blank or the length is not finite and > 0.
    pub fn new(
        name: impl Into<String>,
        length: Length,
        construction: Construction,
    ) -> Result<Self, MuscleError> {
        check::positive("length", length)?;
        let muscle = Self {
            name: String::new(),
            length,
            construction,
            fibre: None,
            bladder: None,
            unfolding: None,
            gas_wall: None,
            learnt: Vec::new(),
            instruments: Instruments::default(),
            widths: Vec::new(),
            specimens: Vec::new(),
            data_columns: Vec::new(),
            fitted: None,
        };
        muscle.with_room()?.with_name(name)
    }

    /// The same muscle under another name.
    ///
    /// # Errors
    /// If the name is blank.
    pub fn with_name(mut self, name: impl Into<String>) -> Result<Self, MuscleError> {
        self.name = name.into();
        if self.name.trim().is_empty() { Err(MuscleError::NoName) } else { Ok(self) }
    }

    /// The same muscle with fibres that stretch.
    ///
    /// # Errors
    /// If a braid does not say how many fibres it has: the stiffness is per fibre.
    pub fn with_fibre(mut self, fibre: Fibre) -> Result<Self, MuscleError> {
        if matches!(&self.construction, Construction::Braided(Braided { fibres: None, .. })) {
            return Err(MuscleError::NoFibreCount);
        }
        self.fibre = Some(fibre);
        Ok(self)
    }

    /// The same muscle with a rubber bladder in the braid. The bladder is the wall if there is no other.
    ///
    /// # Errors
    /// If the muscle is pleated, or the wall leaves no room for gas.
    pub fn with_bladder(mut self, bladder: Bladder) -> Result<Self, MuscleError> {
        if self.is_pleated() {
            return Err(MuscleError::BladderInPleated);
        }
        self.bladder = Some(bladder);
        self.with_room()
    }

    /// The same muscle, if its walls leave room for gas inside the braid and its fittings.
    fn with_room(self) -> Result<Self, MuscleError> {
        let radius = self.radius().si();
        let walls = [
            ("wall", self.wall(), radius),
            ("effects.wall-thickness", self.gas_wall(), radius.min(self.end_radius().si())),
        ];
        for (key, wall, radius_m) in walls {
            if let Some(wall_m) = wall.map(Quantity::si).filter(|wall| *wall >= radius_m) {
                return Err(MuscleError::WallTooThick { key, wall_m, radius_m });
            }
        }
        Ok(self)
    }

    /// The same muscle with cloth that can unfold only so far.
    #[must_use]
    pub fn with_unfolding(mut self, unfolding: Unfolding) -> Self {
        self.unfolding = Some(unfolding);
        self
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
        if self.is_pleated() {
            let (parameter, kind) = (Parameter::GasWall, Kind::Pleated);
            return Err(MuscleError::OtherKind { parameter, kind, owner: Kind::Braided });
        }
        self.gas_wall = Some(match thickness {
            Some(thickness) => {
                check::not_negative("effects.wall-thickness.thickness", thickness)?;
                GasWall::At(thickness)
            }
            None if self.wall().is_some() => GasWall::Inner,
            None => return Err(MuscleError::NoGasWall),
        });
        self.with_room()
    }

    /// The same muscle with other ends, if it is a braid: clamped in fittings, or a cylinder to the end.
    #[must_use]
    pub fn with_ends(mut self, ends: Ends) -> Self {
        if let Construction::Braided(braided) = &self.construction {
            self.construction = Construction::Braided(braided.with_ends(ends));
        }
        self
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
        match parameter {
            Parameter::Length => {
                changed.length = Length::m(value);
                check::positive("length", changed.length)?;
            }
            Parameter::FibreStiffness => {
                let stiffness = Force::n(value);
                let fibre = self
                    .fibre
                    .map_or_else(|| Fibre::new(stiffness), |fibre| fibre.with_stiffness(stiffness))?;
                return changed.with_fibre(fibre);
            }
            Parameter::HoopStiffness | Parameter::UnfoldedRadius => {
                let now = self.unfolding.ok_or(MuscleError::HalfUnfolding { parameter })?;
                changed.unfolding = Some(if parameter == Parameter::HoopStiffness {
                    Unfolding::new(LineStiffness::n_per_m(value), now.unfolded_radius())?
                } else {
                    Unfolding::new(now.hoop_stiffness(), Length::m(value))?
                });
            }
            Parameter::GasWall => return changed.with_gas_wall(Some(Length::m(value))),
            _ => match self.construction {
                Construction::Pleated(pleated) => {
                    changed.construction = Construction::Pleated(pleated_with(pleated, parameter, value)?);
                }
                Construction::Braided(braided) => changed.change_braided(braided, parameter, value)?,
            },
        }
        changed.with_room()
    }

    /// The value of a parameter in SI; `None` if the muscle does not have it.
    #[must_use]
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        let construction = &self.construction;
        let pleated = if let Construction::Pleated(pleated) = construction { Some(pleated) } else { None };
        let braided = if let Construction::Braided(braided) = construction { Some(braided) } else { None };
        match parameter {
            Parameter::Length => Some(self.length.si()),
            Parameter::Radius => Some(self.radius().si()),
            Parameter::FittingRadius => Some(self.end_radius().si()),
            Parameter::BraidAngle => braided.map(|b| b.braid_angle.si()),
            Parameter::Fibres => self.fibres().map(f64::from),
            Parameter::PleatDepth => pleated.map(|p| p.pleat_depth.si()),
            Parameter::Misalignment => pleated.map(|p| p.misalignment.si()),
            Parameter::FibreStiffness => self.fibre.map(|fibre| fibre.stiffness().si()),
            Parameter::C10 => self.bladder.map(|bladder| bladder.c10().si()),
            Parameter::C01 => self.bladder.map(|bladder| bladder.c01().si()),
            Parameter::Wall => self.wall().map(Quantity::si),
            Parameter::GasWall => self.gas_wall().map(Quantity::si),
            Parameter::ClothCircumference => pleated.and_then(|p| p.cloth_circumference).map(Quantity::si),
            Parameter::HoopStiffness => self.unfolding.map(|limit| limit.hoop_stiffness().si()),
            Parameter::UnfoldedRadius => self.unfolding.map(|limit| limit.unfolded_radius().si()),
        }
    }

    /// The name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Unpressurised length l0 between the end fittings.
    #[must_use]
    pub fn length(&self) -> Length {
        self.length
    }

    /// How it is built.
    #[must_use]
    pub fn construction(&self) -> &Construction {
        &self.construction
    }

    /// The family.
    #[must_use]
    pub fn kind(&self) -> Kind {
        self.construction.kind()
    }

    /// Whether it is a pleated muscle.
    #[must_use]
    pub fn is_pleated(&self) -> bool {
        self.kind() == Kind::Pleated
    }

    /// Pleated: fibre radius R that acts at the fittings; braided: braid radius r0 at rest.
    #[must_use]
    pub fn radius(&self) -> Length {
        match &self.construction {
            Construction::Pleated(pleated) => pleated.radius(),
            Construction::Braided(braided) => braided.radius(),
        }
    }

    /// Radius at the end fittings: of the fibres in a pleated muscle, of the clamped ends in a braid.
    #[must_use]
    pub fn end_radius(&self) -> Length {
        match &self.construction {
            Construction::Pleated(pleated) => pleated.radius(),
            Construction::Braided(braided) => braided.fitting_radius(),
        }
    }

    /// Number of fibres; `None` for a continuous membrane, or a braid that does not say.
    #[must_use]
    pub fn fibres(&self) -> Option<u32> {
        match &self.construction {
            Construction::Pleated(Pleated { fibres: FibreCount::Discrete(count), .. }) => Some(*count),
            Construction::Pleated(_) => None,
            Construction::Braided(braided) => braided.fibres(),
        }
    }

    /// Fibres that stretch; `None` if they are inextensible.
    #[must_use]
    pub fn fibre(&self) -> Option<Fibre> {
        self.fibre
    }

    /// The rubber bladder, if the muscle has one that counts.
    #[must_use]
    pub fn bladder(&self) -> Option<Bladder> {
        self.bladder
    }

    /// The limit to the unfolding of the cloth, if there is one.
    #[must_use]
    pub fn unfolding(&self) -> Option<Unfolding> {
        self.unfolding
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
        self.own_wall().or_else(|| self.bladder.map(|bladder| bladder.wall()))
    }

    /// Distance inside the braid radius at which the gas acts; `None` if it acts at the braid.
    #[must_use]
    pub fn gas_wall(&self) -> Option<Length> {
        match self.gas_wall? {
            GasWall::Inner => self.wall(),
            GasWall::At(thickness) => Some(thickness),
        }
    }

    /// The wall thickness that the muscle states itself.
    pub(crate) fn own_wall(&self) -> Option<Length> {
        if let Construction::Braided(braided) = &self.construction { braided.wall() } else { None }
    }

    /// Whether the parameter has a place of its own in the muscle's file, where a width can be written. A
    /// fitting radius that is not stated follows the radius, and the inner face of the wall follows the wall.
    #[must_use]
    pub fn is_stated(&self, parameter: Parameter) -> bool {
        match (parameter, &self.construction) {
            (Parameter::FittingRadius, Construction::Pleated(pleated)) => pleated.end_radius.is_some(),
            (Parameter::FittingRadius, Construction::Braided(braided)) => braided.fitting_radius.is_some(),
            (Parameter::GasWall, _) => matches!(self.gas_wall, Some(GasWall::At(_))),
            _ => self.get(parameter).is_some(),
        }
    }

    fn change_braided(
        &mut self,
        mut braided: Braided,
        parameter: Parameter,
        value: f64,
    ) -> Result<(), MuscleError> {
        match parameter {
            Parameter::Radius => {
                braided.radius = Length::m(value);
                check::positive("radius", braided.radius)?;
            }
            Parameter::BraidAngle => {
                braided.braid_angle = Braided::new(braided.radius, Angle::rad(value))?.braid_angle;
            }
            Parameter::FittingRadius => braided = braided.with_fitting_radius(Length::m(value))?,
            Parameter::Fibres => braided = braided.with_fibres(whole(value)?)?,
            Parameter::Wall => return self.change_wall(braided, Length::m(value)),
            Parameter::C10 | Parameter::C01 => {
                let wall = self.wall().ok_or(MuscleError::NoWall)?;
                let none = Pressure::pa(0.0);
                let (c10, c01) = self.bladder.map_or((none, none), |bladder| (bladder.c10(), bladder.c01()));
                let wall = self.bladder.map_or(wall, |bladder| bladder.wall());
                let modulus = Pressure::pa(value);
                self.bladder = Some(if parameter == Parameter::C10 {
                    Bladder::new(modulus, c01, wall)?
                } else {
                    Bladder::new(c10, modulus, wall)?
                });
            }
            _ => return Err(MuscleError::OtherKind { parameter, kind: Kind::Braided, owner: Kind::Pleated }),
        }
        self.construction = Construction::Braided(braided);
        Ok(())
    }

    /// Changes the wall where it is stated: the muscle's, the bladder's, or both if they are the same.
    fn change_wall(&mut self, braided: Braided, wall: Length) -> Result<(), MuscleError> {
        check::positive("wall", wall)?;
        let own = braided.wall;
        if let Some(bladder) = self.bladder
            && own.is_none_or(|own| own == bladder.wall())
        {
            self.bladder = Some(Bladder::new(bladder.c10(), bladder.c01(), wall)?);
        }
        if own.is_some() || self.bladder.is_none() {
            self.construction = Construction::Braided(braided.with_wall(wall)?);
        }
        Ok(())
    }
}

fn pleated_with(mut pleated: Pleated, parameter: Parameter, value: f64) -> Result<Pleated, MuscleError> {
    match parameter {
        Parameter::Radius if pleated.end_radius.is_none() => {
            pleated.radius = Length::m(value);
            check::positive("radius", pleated.radius)?;
            Ok(pleated)
        }
        Parameter::Radius | Parameter::FittingRadius => pleated.with_end_radius(Length::m(value)),
        Parameter::Fibres => {
            pleated.fibres = FibreCount::Discrete(whole(value)?);
            Ok(pleated)
        }
        Parameter::PleatDepth => pleated.with_pleat_depth(Length::m(value)),
        Parameter::Misalignment => pleated.with_misalignment(Angle::rad(value)),
        Parameter::ClothCircumference => pleated.with_cloth_circumference(Length::m(value)),
        _ => Err(MuscleError::OtherKind { parameter, kind: Kind::Pleated, owner: Kind::Braided }),
    }
}

/// A number of fibres from a sweep, as a whole number.
fn whole(value: f64) -> Result<u32, MuscleError> {
    if value.fract() == 0.0 && (3.0..=f64::from(u32::MAX)).contains(&value) {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number in range"
        )]
        let count = value as u32;
        Ok(count)
    } else {
        Err(MuscleError::FibreCount { value })
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
        let unfolding = Unfolding::new(LineStiffness::kn_per_m(81.0), Length::mm(52.6)).unwrap();
        let full = [
            pleated().with_unfolding(unfolding),
            braided().with_unfolding(unfolding).with(Parameter::Wall, 0.002).unwrap(),
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
        assert_eq!(thick.bladder().unwrap().wall(), Length::mm(3.0));
        assert_eq!(thick.bladder().unwrap().c10(), Pressure::mpa(0.2));
        assert_eq!(muscle.with(Parameter::C10, 0.0).unwrap_err().key(), "effects.bladder-elasticity.c10");
        // A bladder that states its own wall keeps it, unless the muscle has no other.
        let own = Bladder::new(Pressure::mpa(0.2), Pressure::pa(0.0), Length::mm(1.0)).unwrap();
        let muscle = braided().with_bladder(own).unwrap();
        assert_eq!(muscle.get(Parameter::Wall), Some(0.001));
        let muscle = muscle.with(Parameter::Wall, 0.0015).unwrap();
        assert_eq!((muscle.own_wall(), muscle.bladder().unwrap().wall()), (None, Length::mm(1.5)));
        assert_eq!(pleated().with_bladder(own), Err(MuscleError::BladderInPleated));
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
            (follows.gas_wall(), follows.is_stated(Parameter::GasWall)),
            (Some(Length::mm(2.0)), false)
        );
        assert_eq!(follows.with(Parameter::Wall, 0.003).unwrap().gas_wall(), Some(Length::mm(3.0)));
        let own = follows.with(Parameter::GasWall, 0.001).unwrap().with(Parameter::Wall, 0.003).unwrap();
        assert_eq!((own.gas_wall(), own.wall()), (Some(Length::mm(1.0)), Some(Length::mm(3.0))));
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
        assert_eq!((muscle.fibre(), muscle.bladder(), muscle.unfolding()), (None, None, None));
        assert_eq!(muscle.get(Parameter::BraidAngle), Some(Angle::deg(25.0).to_rad()));
        let Construction::Braided(braid) = muscle.construction() else { panic!("a braid") };
        assert_eq!((braid.ends(), braid.with_ends(Ends::Cylinder).ends()), (Ends::Clamped, Ends::Cylinder));
        assert_eq!(pleated().fibres(), Some(40));
        assert_eq!(muscle.clone().with_name("  "), Err(MuscleError::NoName));
        assert!(muscle.with(Parameter::HoopStiffness, 1e4).unwrap_err().to_string().contains("together"));
    }
}
