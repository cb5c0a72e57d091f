//! Checks that the axes of a sweep file are compatible with each other and with the muscle.

use bulge_effects::{Catalogue, known};
use bulge_fibre::{Approach, Parts, Problem};
use bulge_muscles::{Ends, FileError, Learnt, Muscle, Parameter, Pressure, Quantity as _};
use std::f64::consts::TAU;

use super::axes::Placed;
use crate::design::at_step;
use crate::plan::{End, Quantity, Range};

/// Advice for numbers of fibres that aren't whole.
const LIST: &str = "use a list, such as `list = [20, 40, 60]`";

/// The muscle of a sweep and its axes.
pub(super) struct Family<'p, 'a> {
    pub(super) muscle: &'p Muscle,
    pub(super) catalogue: &'p Catalogue,
    /// Gauge pressure \[Pa\] if no axis varies it.
    pub(super) pressure: f64,
    pub(super) axes: &'p [Placed<'a>],
}

impl Family<'_, '_> {
    /// Refuses two axes that vary the same quantity, and axes that are impossible for the muscle.
    pub(super) fn check(&self) -> Result<(), FileError> {
        for (i, placed) in self.axes.iter().enumerate() {
            let target = self.target(&placed.axis.quantity);
            let earlier = self.axes[..i].iter().find(|other| self.target(&other.axis.quantity) == target);
            if let Some(other) = earlier {
                let what = format!(
                    "the axes `{}` and `{}` vary the same number of the muscle",
                    other.axis.name, placed.axis.name
                );
                return Err(placed.settings.error(placed.name.clone(), what, "delete one of the two"));
            }
            if placed.axis.quantity == Quantity::ElasticGroup {
                self.check_group(placed)?;
            }
        }
        Ok(())
    }

    /// The quantity of the muscle that an axis actually changes.
    fn target(&self, quantity: &Quantity) -> Quantity {
        match quantity {
            Quantity::Slenderness => Quantity::Parameter(Parameter::Radius),
            Quantity::ElasticGroup => Quantity::Parameter(Parameter::FibreStiffness),
            // In a pleated muscle the radius at the fittings is the one that acts, under either name.
            Quantity::Parameter(Parameter::FittingRadius) if self.muscle.is_pleated() => {
                Quantity::Parameter(Parameter::Radius)
            }
            other => other.clone(),
        }
    }

    /// Whether an axis changes this quantity of the muscle.
    pub(super) fn varies(&self, quantity: &Quantity) -> bool {
        self.axes.iter().any(|placed| self.target(&placed.axis.quantity) == *quantity)
    }

    /// Refuses the elastic group unless the muscle has pleated fibres of known number.
    fn check_group(&self, placed: &Placed<'_>) -> Result<(), FileError> {
        let refused =
            |what: &str, instead: &str| Err(placed.settings.error(placed.name.clone(), what, instead));
        if !self.muscle.is_pleated() {
            return refused(
                "the elastic group p sin(2 pi/n) R^2/EA belongs to pleated muscles",
                "vary the stiffness of the fibres: `[axes.fibre_stiffness]`",
            );
        }
        if self.muscle.fibres().is_none() && !self.varies(&Quantity::Parameter(Parameter::Fibres)) {
            return refused(
                "the elastic group p sin(2 pi/n) R^2/EA is 0 for continuous fibres, n -> infinity",
                "name a muscle with a number of fibres, or add such as `axes.fibres.list = [40]`",
            );
        }
        Ok(())
    }

    /// The muscle at both ends of each axis. Axes that are set before it are at their lower ends, because it
    /// may depend on them: the stiffness of a fibre needs a number of fibres. All other axes are as in the
    /// muscle file.
    ///
    /// Values that are impossible for the muscle are refused.
    pub(super) fn muscles(&self) -> Result<Vec<Muscle>, FileError> {
        let mut ground = self.muscle.clone();
        let mut found = vec![];
        let mut axes: Vec<&Placed<'_>> = self.axes.iter().collect();
        // Quantities derived from others are set after them.
        axes.sort_by_key(|placed| match placed.axis.quantity {
            Quantity::ElasticGroup => 2,
            Quantity::Slenderness => 1,
            _ => 0,
        });
        for placed in axes {
            let ends = ends(&placed.axis.range);
            let mut at_ends = vec![];
            for value in ends.into_iter().flatten() {
                let muscle = self.with(&ground, &placed.axis.quantity, value);
                at_ends.push(muscle.map_err(|what| placed.wrong(what))?);
            }
            if placed.axis.quantity == Quantity::Parameter(Parameter::Fibres) {
                check_whole(placed)?;
            }
            if let Some(first) = at_ends.first() {
                ground = first.clone();
            }
            found.append(&mut at_ends);
        }
        Ok(found)
    }

    /// The muscle with another value on an axis, or the reason why that value is impossible.
    fn with(&self, muscle: &Muscle, quantity: &Quantity, value: f64) -> Result<Muscle, String> {
        let positive = |name: &str| {
            if value > 0.0 {
                Ok(())
            } else {
                Err(format!("the {name} {value} is not possible: it must be > 0"))
            }
        };
        let changed = |parameter, value| muscle.with(parameter, value).map_err(|error| error.to_string());
        match quantity {
            Quantity::Contraction if value.abs() >= 1.0 => {
                Err(format!("the contraction {value} is not possible: it must be between -1 and 1"))
            }
            Quantity::Contraction => Ok(muscle.clone()),
            Quantity::Pressure => positive("pressure").map(|()| muscle.clone()),
            Quantity::Slenderness => {
                positive("slenderness")?;
                changed(Parameter::Radius, muscle.length().si() / value)
            }
            Quantity::ElasticGroup => {
                positive("elastic group")?;
                let fibres = muscle.fibres().map_or(f64::INFINITY, f64::from);
                let radius = muscle.radius().si();
                let stiffness = self.pressure * (TAU / fibres).sin() * radius * radius / value;
                changed(Parameter::FibreStiffness, stiffness)
            }
            Quantity::Parameter(parameter) => changed(*parameter, value),
            Quantity::Effect { effect, key } => with_effect(muscle, self.catalogue, effect, key, value),
        }
    }

    /// Whether the force is infinite at the contraction 0 anywhere: it is for straight fibres that don't
    /// stretch.
    pub(super) fn is_singular(&self) -> bool {
        let stretches =
            self.muscle.fibre().is_some() || self.varies(&Quantity::Parameter(Parameter::FibreStiffness));
        let misalignment = Quantity::Parameter(Parameter::Misalignment);
        let axis = self.axes.iter().find(|placed| placed.axis.quantity == misalignment);
        let is_straight = match axis.map(|placed| &placed.axis.range) {
            // A braid has no misalignment.
            None => self.muscle.get(Parameter::Misalignment) == Some(0.0),
            Some(Range::List(values)) => values.contains(&0.0),
            Some(Range::Between { from, to, .. }) => {
                *from <= 0.0 && matches!(to, End::Value(to) if *to >= 0.0)
            }
        };
        is_straight && !stretches
    }

    /// Whether any of these muscles needs the integration of its meridian if the method may be chosen.
    pub(super) fn shoots(&self, muscles: &[Muscle]) -> bool {
        let shoots = |muscle: &Muscle| {
            Problem::new(muscle, Pressure::pa(self.pressure)).is_ok_and(|problem| problem.shoots())
        };
        muscles.iter().any(shoots)
    }

    /// The reason why the method is impossible; none if it is possible.
    pub(super) fn obstacle(&self, approach: Approach, shoots: bool) -> Option<&'static str> {
        let is_cylinder = Parts::of(self.muscle).ends == Ends::Cylinder;
        match approach {
            Approach::ClosedForm if shoots => Some("this muscle has no closed form"),
            Approach::Shooting if is_cylinder => {
                Some("a braid with cylindrical ends has no meridian to integrate")
            }
            _ => None,
        }
    }
}

/// The muscle with another value of a number of an effect.
fn with_effect(
    muscle: &Muscle,
    catalogue: &Catalogue,
    effect: &str,
    key: &str,
    value: f64,
) -> Result<Muscle, String> {
    let Some(stated) = muscle.learnt().iter().find(|learnt| learnt.name() == effect) else {
        return Err(format!("the muscle has no effect `{effect}`"));
    };
    let mut values = stated.values().to_vec();
    for number in values.iter_mut().filter(|number| number.key == key) {
        number.si = value;
    }
    let changed = Learnt::new(effect, values).map_err(|error| error.to_string())?;
    let muscle = muscle.clone().with_learnt(changed);
    known(&muscle, catalogue).map_err(|error| format!("{}: {}", error.what(), error.instead()))?;
    Ok(muscle)
}

/// The ends of an axis that don't depend on the muscle.
fn ends(range: &Range) -> [Option<f64>; 2] {
    match range {
        Range::List(values) => [values.first().copied(), values.last().copied()],
        Range::Between { from, to: End::Value(to), .. } => [Some(*from), Some(*to)],
        Range::Between { from, to: End::Limit, .. } => [Some(*from), None],
    }
}

/// Refuses numbers of fibres that aren't valid.
fn check_whole(placed: &Placed<'_>) -> Result<(), FileError> {
    let strange = match &placed.axis.range {
        Range::List(values) => values.iter().copied().find(|value| value.fract() != 0.0),
        range @ Range::Between { points: Some(points), .. } => (0..*points)
            .map(|step| at_step(range, step, *points).value(f64::NAN))
            .find(|value| value.fract() != 0.0),
        Range::Between { points: None, .. } => {
            let what = "a number of fibres is whole: only a grid can have a range of them";
            return Err(placed.settings.error(placed.values.clone(), what, LIST));
        }
    };
    let Some(strange) = strange else { return Ok(()) };
    let what = format!("{strange} is not a number of fibres: it must be a whole number of at least 3");
    Err(placed.settings.error(placed.values.clone(), what, LIST))
}
