//! Form errors of an effect, the ways in which its formula may be wrong: columns along the state, along its
//! drive, at turns, and from related effects.
//!
//! ```text
//! F = F(theta) + sum over groups g of sd_g B_g c_g,    c ~ N(0, 1)
//! s = F(theta) - F(theta, the sizes of the effect off)
//! along the state:  1.4 s w_ij T_i(x) T_j(y),   0 < i + 1.5 j <= 4,   w = exp(-(i + 1.5 j - 1)/2), sum w^2 = 1
//! along its drive:  1.4 s w_i T_i(v),   v the force, the speed, .. that drives the effect, i <= 3
//! at turns:         3 s exp(-way/l),  way since the last reversal, to the next, since the beginning of a sweep;  3 s exp(-|rate|/(q fastest))
//! of kin:           |s| u,  u of length 1: other forms of the effect, what isn't in proportion to its sizes, other members of its family
//! ```
//! No real effect obeys a formula exactly: rubber has two constants, friction rounds off at a turn, and the
//! gain of a sensor changes over its range. The misfit that a formula leaves must not be taken for another
//! effect. The error of a sensor is bent along its reading alone.

use bulge_effects::{Card, Catalogue, Effect, Form, Group, Mechanism, Moment, Needs, ParameterCard, Stage};
use bulge_model::{ModelError, Wanted};
use std::collections::BTreeMap;
use std::sync::Arc;

use crate::chebyshev::chebyshev;
use crate::diagnosis::confirm::roles;
use crate::diagnosis::sensitivity::{Sensitivities, spread};
use crate::diagnosis::smooth::{drives_pressure, over_range, scaled, ways_to_reversals};
use crate::diagnosis::tangents::Tangents;
use crate::fit::nuisance::Prepared;
use crate::vector::minus;
use bulge_numerics::vector::{add, dot};

/// Size of the columns along the state: a form error of one standard deviation changes the effect by about
/// that fraction of it.
const ALONG: f64 = 1.4;
/// Highest degrees in the driven and in the held variable; the next two constants weight a degree of the
/// latter and bound the weighted sum.
const DEGREES: [usize; 2] = [4, 2];
const HELD_WEIGHT: f64 = 1.5;
const TOTAL: f64 = 4.0;
/// Difference between the two strokes, relative to the variation along the state.
const BY_STROKE: f64 = 0.5;
/// Highest degree in the variable that drives an effect.
const DRIVEN: usize = 3;
/// At a turn, friction is anything between -s and s, on few rows.
const AT_TURNS: f64 = 3.0;
/// Lengths of transitions at turns, as fractions of the stroke; then speeds, as fractions of the fastest.
const LENGTHS: [f64; 4] = [0.003, 0.012, 0.05, 0.15];
const SPEEDS: [f64; 4] = [0.012, 0.04, 0.12, 0.5];
/// Number of values, over the plausible range, of each parameter that isn't a size; fewer if each value needs
/// new equilibria.
const FORMS: [usize; 2] = [6, 3];
/// Multiples of the sizes at which a nonlinear effect is evaluated; fewer if each needs new equilibria.
const MULTIPLES: [&[f64]; 2] = [&[0.4, 0.7, 1.5, 2.5], &[0.5, 2.0]];
/// A deviation from proportionality below this fraction of the effect is rounding error.
const OUT_OF_PROPORTION: f64 = 1e-3;
/// Most columns of another member of the family.
const OF_MEMBER: usize = 4;

/// Kind of a form error; each kind has a standard deviation of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Along the state.
    State,
    /// Along the variable that drives the effect.
    Drive,
    /// At turns.
    Turn,
    /// From related effects: other forms, nonlinearity in the sizes, other members of the family.
    Kin,
}

impl Kind {
    pub(crate) const ALL: [Self; 4] = [Self::State, Self::Drive, Self::Turn, Self::Kin];
}

/// Kin columns by the name of their effect. They are kept because they hardly depend on the other effects and
/// need equilibria of their own.
pub(crate) type Kin = BTreeMap<String, Arc<Vec<Vec<f64>>>>;

/// The columns of one effect.
pub(crate) struct Bending {
    pub(crate) effect: Arc<dyn Effect>,
    /// Change of the force by the effect, by the catalogue's formula \[N\].
    pub(crate) change: Vec<f64>,
    /// Form errors of one standard deviation along the state, along the drive and at turns \[N\]; those of
    /// kin only define a direction.
    pub(crate) columns: Vec<(Kind, Vec<f64>)>,
    /// The columns of kin.
    pub(crate) kin: Arc<Vec<Vec<f64>>>,
}

/// The columns of all effects of a model whose formulas may be wrong. `tangent` belongs to the same model at
/// the same parameters; `kin` are columns that are known already.
pub(crate) fn bendings(
    catalogue: &Catalogue,
    prepared: &Prepared,
    theta: &[f64],
    tangent: &Tangents,
    kin: Option<&Kin>,
) -> Vec<Bending> {
    let bending = |effect: &Arc<dyn Effect>| {
        let known = kin.and_then(|kin| kin.get(effect.card().name));
        Bent { catalogue, prepared, theta, tangent, effect }.bending(known)
    };
    inexact(prepared).filter_map(bending).collect()
}

/// Whether a model has effects whose formulas may be wrong.
pub(crate) fn may_bend(prepared: &Prepared) -> bool {
    inexact(prepared).next().is_some()
}

fn inexact(prepared: &Prepared) -> impl Iterator<Item = &Arc<dyn Effect>> {
    let chosen = prepared.model.effects().iter().map(|chosen| &chosen.effect);
    chosen.filter(|effect| effect.card().form != Form::Exact && is_asked(prepared, effect.card().name))
}

/// Whether an effect is more than a nuisance from data sheets.
fn is_asked(prepared: &Prepared, name: &str) -> bool {
    let numbers = prepared.model.parameters().iter().zip(&prepared.nuisance);
    numbers.filter(|(p, _)| p.effect == name).any(|(_, nuisance)| !nuisance)
}

/// What the form error of an effect is a function of, for a row and the force there: the variable that drives the effect
/// (of a rate its root, which spreads slow and fast rows).
fn drive(card: &Card<'_>) -> Option<fn(&Moment, f64) -> f64> {
    match card.mechanism {
        Mechanism::GiveOfTheRig | Mechanism::ForceChain | Mechanism::ClothAndFibres => Some(|_, force| force),
        Mechanism::Rate => Some(|moment, _| moment.rate.abs().sqrt()),
        Mechanism::Rubber | Mechanism::Ends | Mechanism::Section => Some(|moment, _| moment.contraction),
        Mechanism::PressureChain => Some(|moment, _| moment.pressure),
        Mechanism::SofteningAndHeat if card.needs == Needs::Temperature => {
            Some(|moment, _| moment.temperature)
        }
        _ => None,
    }
}

/// Whether an effect is an error of a sensor, which depends on nothing but its reading.
fn is_of_sensor(card: &Card<'_>) -> bool {
    let is_chain = matches!(card.mechanism, Mechanism::ForceChain | Mechanism::PressureChain);
    is_chain && card.group == Group::Rig && card.needs == Needs::Nothing
}

fn driven_weight(degree: usize) -> f64 {
    (-0.5 * (degree as f64 - 1.0)).exp()
}

/// An effect of a model at its parameters.
struct Bent<'a> {
    catalogue: &'a Catalogue,
    prepared: &'a Prepared,
    theta: &'a [f64],
    tangent: &'a Tangents,
    effect: &'a Arc<dyn Effect>,
}

/// A parameter of the effect in the model.
struct Number<'a> {
    index: usize,
    /// For a size: the value at which the effect is off.
    off: Option<f64>,
    card: ParameterCard<'a>,
}

impl Bent<'_> {
    fn bending(&self, known: Option<&Arc<Vec<Vec<f64>>>>) -> Option<Bending> {
        let (change, off) = self.change()?;
        if change.iter().all(|c| *c == 0.0) || change.iter().any(|c| !c.is_finite()) {
            return None;
        }
        let mut columns: Vec<(Kind, Vec<f64>)> = Vec::new();
        if !is_of_sensor(&self.effect.card()) {
            columns.extend(self.along_state(&change).into_iter().map(|column| (Kind::State, column)));
        }
        columns.extend(self.along_drive(&change).into_iter().map(|column| (Kind::Drive, column)));
        columns.extend(self.at_another_zero(&change, off.as_deref()).map(|column| (Kind::Drive, column)));
        columns.extend(self.at_turns(&change).into_iter().map(|column| (Kind::Turn, column)));
        let shows = |column: &[f64]| column.iter().all(|c| c.is_finite()) && dot(column, column) > 0.0;
        columns.retain(|(_, column)| shows(column));
        let kin = known.map_or_else(
            || {
                let mut kin = self.of_kin(&change, off.as_deref());
                kin.retain(|column| shows(column));
                Arc::new(kin)
            },
            Arc::clone,
        );
        columns.extend(kin.iter().map(|column| (Kind::Kin, column.clone())));
        Some(Bending { effect: Arc::clone(self.effect), change, columns, kin })
    }

    /// The parameters of the effect.
    fn numbers(&self) -> Vec<Number<'_>> {
        let (card, model) = (self.effect.card(), &self.prepared.model);
        let cards: Vec<_> = self.effect.parameters().into_iter().map(|c| c.of(model.muscle())).collect();
        let roles = roles(model);
        let own = model.parameters().iter().enumerate().filter(|(_, p)| p.effect == card.name);
        own.filter_map(|(index, p)| {
            let card = *cards.iter().find(|card| card.name == p.name)?;
            Some(Number { index, off: roles[index].map(|size| size.off), card })
        })
        .collect()
    }

    fn force(&self, theta: &[f64]) -> Result<Vec<f64>, ModelError> {
        let (model, tangent) = (&self.prepared.model, self.tangent);
        Ok(model.evaluate_warm(&tangent.set, theta, &Wanted::default(), &tangent.warm.shared())?.force)
    }

    /// Change of the force by the effect, and the force without it if there is one; otherwise the change is
    /// the one to first order.
    fn change(&self) -> Option<(Vec<f64>, Option<Vec<f64>>)> {
        let sizes: Vec<(usize, f64)> =
            self.numbers().iter().filter_map(|number| Some((number.index, number.off?))).collect();
        if sizes.is_empty() {
            return None;
        }
        let mut theta = self.theta.to_vec();
        for (index, off) in &sizes {
            theta[*index] = *off;
        }
        let with = &self.tangent.force_as_set;
        if let Ok(off) = self.force(&theta)
            && off.iter().all(|force| force.is_finite())
        {
            return Some((minus(with, &off), Some(off)));
        }
        let mut change = vec![0.0; with.len()];
        for (index, off) in &sizes {
            let place = self.tangent.free.iter().position(|free| free == index)?;
            add(&mut change, self.theta[*index] - off, &self.tangent.columns[place]);
        }
        Some((change, None))
    }

    fn along_state(&self, change: &[f64]) -> Vec<Vec<f64>> {
        let set = &self.tangent.set;
        let (contraction, pressure) = (scaled(set, |m| m.contraction), scaled(set, |m| m.pressure));
        // At held lengths the pressure is the driven variable.
        let is_held = drives_pressure(set) && set.moments().iter().all(|m| m.direction == 0.0);
        let [x, y] = if is_held { [pressure, contraction] } else { [contraction, pressure] };
        let total = |i: usize, j: usize| i as f64 + HELD_WEIGHT * j as f64;
        let weight = |i: usize, j: usize| (-0.5 * (total(i, j) - 1.0)).exp();
        let degrees: Vec<(usize, usize)> = (0..=DEGREES[0])
            .flat_map(|i| (0..=DEGREES[1]).map(move |j| (i, j)))
            .filter(|(i, j)| i + j > 0 && total(*i, *j) <= TOTAL)
            .collect();
        let norm = degrees.iter().map(|(i, j)| weight(*i, *j).powi(2)).sum::<f64>().sqrt();
        let times = |f: &dyn Fn(usize) -> f64| -> Vec<f64> {
            change.iter().enumerate().map(|(row, s)| ALONG * s * f(row)).collect()
        };
        let mut columns: Vec<Vec<f64>> = degrees
            .iter()
            .map(|(i, j)| {
                let weight = weight(*i, *j) / norm;
                times(&|row| weight * chebyshev(*i, x[row]) * chebyshev(*j, y[row]))
            })
            .collect();
        if matches!(self.effect.card().mechanism, Mechanism::DryFriction | Mechanism::Rate) {
            // The two strokes may differ.
            let branch: Vec<f64> = set.moments().iter().map(Moment::branch).collect();
            columns.extend((0..=1).map(|i| times(&|row| BY_STROKE * branch[row] * chebyshev(i, x[row]))));
        }
        if matches!(self.effect.card().needs, Needs::Time | Needs::Cycles | Needs::PressurePath) {
            let clock = scaled(set, |m| m.clock);
            columns.extend((1..=2).map(|i| times(&|row| chebyshev(i, clock[row]) / ALONG)));
        }
        columns
    }

    /// An effect depends above all on its drive: compliance of the rig on the force, viscosity on the speed.
    fn along_drive(&self, change: &[f64]) -> Vec<Vec<f64>> {
        let Some(drive) = drive(&self.effect.card()) else { return Vec::new() };
        let (moments, force) = (self.tangent.set.moments(), &self.tangent.force_as_set);
        let drive: Vec<f64> =
            moments.iter().zip(force).map(|(moment, force)| drive(moment, *force)).collect();
        let drive = over_range(&drive);
        let norm = (1..=DRIVEN).map(driven_weight).map(|w| w * w).sum::<f64>().sqrt();
        let column = |i: usize| {
            let weight = ALONG * driven_weight(i) / norm;
            change.iter().zip(&drive).map(|(s, x)| weight * s * chebyshev(i, *x)).collect()
        };
        (1..=DRIVEN).map(column).collect()
    }

    /// A shift of the temperature at which the effect vanishes. It acts like a gain, with the size of the
    /// effect.
    fn at_another_zero(&self, change: &[f64], off: Option<&[f64]>) -> Option<Vec<f64>> {
        let off = off.filter(|_| self.effect.card().needs == Needs::Temperature)?;
        let scale = (dot(change, change) / dot(off, off).max(f64::MIN_POSITIVE)).sqrt();
        Some(off.iter().map(|force| scale * force).collect())
    }

    /// Layers at turns, which only friction has.
    fn at_turns(&self, change: &[f64]) -> Vec<Vec<f64>> {
        let (card, set) = (self.effect.card(), &self.tangent.set);
        if card.mechanism != Mechanism::DryFriction && card.name != "valve-hysteresis" || !set.is_path() {
            return Vec::new();
        }
        let times = |f: &dyn Fn(usize) -> f64| -> Vec<f64> {
            change.iter().enumerate().map(|(row, s)| AT_TURNS * s * f(row)).collect()
        };
        let ways = ways_to_reversals(set);
        let mut columns: Vec<Vec<f64>> = ways
            .iter()
            .flat_map(|way| LENGTHS.map(|length| times(&|row| (-way[row] / length).exp())))
            .collect();
        let fastest = set.moments().iter().map(|m| m.rate.abs()).fold(0.0, f64::max);
        if set.has_time() && fastest > 0.0 {
            let rate = |row: usize| set.moments()[row].rate.abs() / fastest;
            columns.extend(SPEEDS.map(|speed| times(&|row| (-rate(row) / speed).exp())));
        }
        columns
    }

    /// Other forms of the effect, its deviation from proportionality, and other members of its family.
    fn of_kin(&self, change: &[f64], off: Option<&[f64]>) -> Vec<Vec<f64>> {
        let mut columns = Vec::new();
        let Some(off) = off else { return columns };
        let numbers = self.numbers();
        let less = |force: Vec<f64>, part: f64| -> Vec<f64> {
            force.iter().zip(off).zip(change).map(|((f, off), s)| f - off - part * s).collect()
        };
        let is_shape = usize::from(self.effect.stage() == Stage::Shape);
        let mut done: Vec<&str> = Vec::new();
        for number in numbers.iter().filter(|number| number.off.is_none()) {
            if done.contains(&number.card.name) {
                continue;
            }
            done.push(number.card.name);
            for value in spread(&number.card, FORMS[is_shape]) {
                let mut theta = self.theta.to_vec();
                for other in numbers.iter().filter(|other| other.card.name == number.card.name) {
                    theta[other.index] = value;
                }
                columns.extend(self.force(&theta).map(|force| less(force, 0.0)));
            }
        }
        for part in MULTIPLES[is_shape] {
            let mut theta = self.theta.to_vec();
            for number in &numbers {
                let Some(zero) = number.off else { continue };
                let value = zero + *part * (theta[number.index] - zero);
                theta[number.index] = value.clamp(number.card.low, number.card.high);
            }
            let Ok(force) = self.force(&theta) else { continue };
            let column = less(force, *part);
            if dot(&column, &column) > (OUT_OF_PROPORTION * part).powi(2) * dot(change, change) {
                columns.push(column);
            }
        }
        columns.extend(self.of_family());
        columns
    }

    fn of_family(&self) -> Vec<Vec<f64>> {
        let own = self.effect.card();
        let members: Vec<String> = self
            .catalogue
            .iter()
            .map(|effect| effect.card())
            .filter(|card| card.family == own.family && card.name != own.name)
            .map(|card| card.name.to_owned())
            .collect();
        if members.is_empty() {
            return Vec::new();
        }
        let found =
            Sensitivities::of(self.catalogue, Some(&members), self.prepared, self.theta, self.tangent);
        let mut columns = Vec::new();
        for member in 0..found.effects.len() {
            let own: Vec<&Vec<f64>> =
                found.sensitivities.iter().filter(|s| s.effect == member).flat_map(|s| &s.columns).collect();
            let step = own.len().div_ceil(OF_MEMBER).max(1);
            columns.extend(own.into_iter().step_by(step).cloned());
        }
        columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn errors_of_sensors_depend_on_their_readings_alone() {
        let catalogue = Catalogue::builtin();
        let of_sensors = catalogue.iter().filter(|effect| is_of_sensor(&effect.card()));
        let bent = of_sensors.filter(|effect| effect.card().form != Form::Exact);
        let names: Vec<String> = bent.map(|effect| effect.card().name.to_owned()).collect();
        let expected = ["force-gain", "force-nonlinearity", "line-drop", "pressure-gain", "pressure-offset"];
        assert_eq!(BTreeSet::from_iter(names), BTreeSet::from(expected.map(str::to_owned)));
    }

    #[test]
    fn each_effect_is_driven_by_its_own_variable() {
        let moment = Moment { rate: -4.0, temperature: 310.0, ..Moment::at_rest(2e5, 0.1) };
        let catalogue = Catalogue::builtin();
        let driven = |name: &str| {
            let effect = catalogue.find(name).unwrap();
            drive(&effect.card()).map(|drive| drive(&moment, 70.0))
        };
        for (name, value) in [
            ("frame-compliance", Some(70.0)),
            ("viscous-damping", Some(2.0)),
            ("bladder-elasticity", Some(0.1)),
            ("pressure-offset", Some(2e5)),
            ("temperature", Some(310.0)),
            // Of the same mechanism as the temperature, which softens no rubber.
            ("stress-softening", None),
            ("coulomb-friction", None),
        ] {
            assert_eq!(driven(name), value, "{name}");
        }
    }
}
