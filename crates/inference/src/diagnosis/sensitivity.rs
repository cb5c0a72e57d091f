//! Sensitivities of a record to effects: the change of the force by the size of each effect, at the current
//! parameters of a model.

use bulge_effects::{Catalogue, Effect, Mechanism, ParameterCard, Stage};
use bulge_model::{Model, ModelError, Record, Wanted, Warm};
use rayon::prelude::*;
use std::sync::Arc;

use crate::comparison::requirements::check_needs;
use crate::diagnosis::held_load::{LATE_FORCE, is_under_loads};
use crate::diagnosis::tangents::Tangents;
use crate::error::InferenceError;
use crate::fit::nuisance::Prepared;
use crate::vector::minus;

/// Number of values of each parameter that is not a size (a distance, a time) at which an effect is
/// evaluated.
const GRID: usize = 5;
/// Most grid points for an effect with several such parameters.
const MOST_POINTS: usize = 25;
/// Fraction of the usual size at which an effect without a first-order change is evaluated.
const SECANT: f64 = 0.5;
/// A derivative counts as zero if its change of the force per usual size is below this fraction of full
/// scale.
const NOTHING: f64 = 1e-9;
/// One form of an effect.
#[derive(Debug, Clone)]
pub(crate) struct Sensitivity {
    /// Index of the effect in [`Sensitivities::effects`].
    pub(crate) effect: usize,
    /// All parameters of the effect (of one specimen), with the sizes at `off`.
    pub(crate) values: Vec<f64>,
    /// Its sizes; there are several if they differ by direction, by specimen and so on.
    pub(crate) sizes: Vec<Size>,
    /// Change of the force per size \[N per SI unit\], one column for each size.
    pub(crate) columns: Vec<Vec<f64>>,
    /// The effect has no continuous size: its column is the change itself, and its size is 1.
    pub(crate) whole: bool,
}

/// A parameter that measures the size of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Size {
    /// Index among the parameters of the effect.
    pub(crate) place: usize,
    /// Index of the specimen, if each has its own.
    pub(crate) copy: usize,
    /// Scale from the literature: the usual deviation from `off`, in SI.
    pub(crate) scale: f64,
    /// Value at which the effect vanishes.
    pub(crate) off: f64,
    /// Possible signs of the deviation from `off`.
    pub(crate) sign: Sign,
    /// Largest plausible deviation from `off`.
    pub(crate) plausible: f64,
    /// Deviation from `off` at which the column was taken; none if it is the derivative there.
    pub(crate) secant: Option<f64>,
}

/// Possible signs of a size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sign {
    /// Only above `off`.
    Positive,
    /// Only below `off`.
    Negative,
    /// Both.
    Any,
}

/// An effect of the catalogue, and whether these data can show it.
#[derive(Debug, Clone)]
pub(crate) struct Screened {
    pub(crate) effect: Arc<dyn Effect>,
    /// Why it can't be tested, if so.
    pub(crate) untestable: Option<String>,
    /// Whether the model has it already as a rig error within its data sheet: to be named, it must be larger
    /// than that.
    pub(crate) nuisance: bool,
}

/// All effects of the catalogue that the model doesn't have, and their sensitivities.
pub(crate) struct Sensitivities {
    pub(crate) effects: Vec<Screened>,
    pub(crate) sensitivities: Vec<Sensitivity>,
}

/// The point at which the columns are evaluated.
struct ExpansionPoint<'a> {
    prepared: &'a Prepared,
    theta: &'a [f64],
    record: &'a Record,
    /// Force of the model \[N\].
    force: &'a [f64],
    full_scale: f64,
    /// Equilibria at this point.
    warm: &'a Warm,
}

impl Sensitivities {
    /// Sensitivities of all effects of the catalogue (or of those in `only`) that the model doesn't have, at
    /// parameters `theta`, in the history as it was set.
    pub(crate) fn of(
        catalogue: &Catalogue,
        only: Option<&[String]>,
        prepared: &Prepared,
        theta: &[f64],
        Tangents { set: record, force_as_set: force, warm, .. }: &Tangents,
    ) -> Self {
        let full_scale = force.iter().fold(f64::MIN_POSITIVE, |most, f| most.max(f.abs()));
        let expansion = ExpansionPoint { prepared, theta, record, force, full_scale, warm };
        let mut effects = Vec::new();
        for effect in catalogue.iter() {
            let card = effect.card();
            if card.kind.is_some_and(|kind| kind != prepared.model.muscle().kind()) {
                continue;
            }
            if only.is_some_and(|names| names.iter().all(|name| name != card.name)) {
                continue;
            }
            let nuisance = is_nuisance(prepared, card.name);
            if !nuisance && prepared.model.effects().iter().any(|c| c.effect.card().name == card.name) {
                continue;
            }
            if nuisance && is_held(prepared, card.name) {
                continue;
            }
            let untestable = check_needs(effect, record).err().map(|error| match error {
                InferenceError::Needs { needs, .. } => format!("needs {needs}"),
                other => other.to_string(),
            });
            let untestable = untestable.or_else(|| {
                (card.family == LATE_FORCE && is_under_loads(record)).then(|| {
                    "needs a force that rises and falls: a load that is held shows no late reading of it"
                        .to_owned()
                })
            });
            effects.push(Screened { effect: Arc::clone(effect), untestable, nuisance });
        }
        let found: Vec<Result<Vec<Sensitivity>, String>> = effects
            .par_iter()
            .enumerate()
            .map(|(place, screened)| {
                if screened.untestable.is_some() {
                    return Ok(Vec::new());
                }
                expansion.sensitivities(place, screened).map_err(|error| error.to_string())
            })
            .collect();
        let mut sensitivities = Vec::new();
        for (screened, found) in effects.iter_mut().zip(found) {
            match found {
                Ok(found) if found.is_empty() && screened.untestable.is_none() => {
                    screened.untestable = Some("does nothing at these pressures and contractions".to_owned());
                }
                Ok(found) => sensitivities.extend(found),
                Err(why) => screened.untestable = Some(why),
            }
        }
        Self { effects, sensitivities }
    }
}

/// Whether an effect relaxes over time; a relaxation slower than any sweep acts as a spring.
pub(crate) fn relaxes(effect: &Arc<dyn Effect>, record: &Record) -> bool {
    effect.card().mechanism == Mechanism::Relaxation && record.has_time()
}

/// Duration of the longest sweep \[s\].
pub(crate) fn longest_sweep(record: &Record) -> f64 {
    let moments = record.moments();
    let lasts = |rows: &std::ops::Range<usize>| moments[rows.end - 1].clock - moments[rows.start].clock;
    record.sweeps().iter().map(lasts).fold(0.0, f64::max)
}

/// Whether all parameters of an effect are stated, so that it can't be larger.
fn is_held(prepared: &Prepared, name: &str) -> bool {
    prepared.model.parameters().iter().filter(|p| p.effect == name).all(|p| p.fixed)
}

/// Whether a model has an effect only as a nuisance from data sheets.
pub(crate) fn is_nuisance(prepared: &Prepared, name: &str) -> bool {
    let of_effect =
        || prepared.model.parameters().iter().zip(&prepared.nuisance).filter(|(p, _)| p.effect == name);
    of_effect().next().is_some() && of_effect().all(|(_, nuisance)| *nuisance)
}

/// The parameters of an effect that measure its size; the others determine its form.
pub(crate) fn sizes(cards: &[ParameterCard<'_>]) -> Vec<Size> {
    let differs = |card: &ParameterCard<'_>| card.typical.total_cmp(&card.off).is_ne();
    let any_differs = cards.iter().any(differs);
    let is_size = |card: &&(usize, &ParameterCard<'_>)| !any_differs || differs(card.1);
    cards
        .iter()
        .enumerate()
        .collect::<Vec<_>>()
        .iter()
        .filter(is_size)
        .map(|(place, card)| size(*place, card))
        .collect()
}

fn size(place: usize, card: &ParameterCard<'_>) -> Size {
    let usual = (card.typical - card.off).abs();
    let scale = match card.prior {
        Some((mean, sd)) => sd.max((mean - card.off).abs()),
        None if usual > 0.0 => usual,
        None => 0.1 * (card.high - card.low),
    };
    let (low, high) = card.plausible.unwrap_or((card.low, card.high));
    let sign = if card.low >= card.off {
        Sign::Positive
    } else if card.high <= card.off {
        Sign::Negative
    } else {
        Sign::Any
    };
    Size {
        place,
        copy: 0,
        scale,
        off: card.off,
        sign,
        plausible: (low - card.off).abs().max((high - card.off).abs()),
        secant: None,
    }
}

/// Grid points of the parameters that are not sizes; the sizes are `off`.
pub(crate) fn forms(cards: &[ParameterCard<'_>], sizes: &[Size]) -> Vec<Vec<f64>> {
    let is_size = |place: usize| sizes.iter().any(|size| size.place == place);
    let others = (0..cards.len()).filter(|place| !is_size(*place)).count();
    let mut per_number = GRID;
    while per_number > 1 && per_number.pow(u32::try_from(others).unwrap_or(8)) > MOST_POINTS {
        per_number -= 1;
    }
    let mut points: Vec<Vec<f64>> = vec![cards.iter().map(|card| card.off).collect()];
    for (place, card) in cards.iter().enumerate().filter(|(place, _)| !is_size(*place)) {
        let values = spread(card, per_number);
        points = points
            .iter()
            .flat_map(|point| {
                values.iter().map(move |value| {
                    let mut point = point.clone();
                    point[place] = *value;
                    point
                })
            })
            .collect();
    }
    points
}

/// Values spread over the plausible range of a parameter, within its bounds.
pub(crate) fn spread(card: &ParameterCard<'_>, count: usize) -> Vec<f64> {
    let (low, high) = card.plausible.unwrap_or((card.low, card.high));
    let (low, high) = (low.max(card.low), high.min(card.high));
    let at = |i: usize| {
        let part = (i as f64 + 0.5) / count as f64;
        if card.logarithmic && low > 0.0 { low * (high / low).powf(part) } else { low + (high - low) * part }
    };
    if count == 1 { vec![card.typical] } else { (0..count).map(at).collect() }
}

impl ExpansionPoint<'_> {
    /// All forms of an effect.
    fn sensitivities(&self, place: usize, screened: &Screened) -> Result<Vec<Sensitivity>, ModelError> {
        let effect = &screened.effect;
        let cards: Vec<ParameterCard<'_>> =
            effect.parameters().into_iter().map(|card| card.of(self.prepared.model.muscle())).collect();
        if screened.nuisance {
            return self.of_nuisance(place, effect, &cards);
        }
        let model = self.prepared.model.with(effect, None)?;
        if cards.is_empty() {
            return Ok(self.whole(place, &model, &[]).into_iter().collect());
        }
        let sizes = sizes(&cards);
        let mut found = Vec::new();
        for values in self.shown_within_a_sweep(effect, &cards, forms(&cards, &sizes)) {
            match self.at(place, effect, &model, &cards, &sizes, values) {
                Ok(sensitivity) => found.extend(sensitivity),
                // The parameter has no small values; the effect is tried as a whole below.
                Err(_) if effect.stage() == Stage::Shape && sizes.len() == 1 => {}
                Err(error) => return Err(error),
            }
        }
        if found.is_empty() && sizes.len() == 1 && effect.stage() == Stage::Shape {
            // The effect is either present or absent, like a cloth between the fibres.
            let card = &cards[sizes[0].place];
            for value in spread(card, GRID) {
                let mut values: Vec<f64> = cards.iter().map(|card| card.typical).collect();
                values[sizes[0].place] = value;
                found.extend(self.whole(place, &model, &values));
            }
        }
        Ok(found)
    }

    /// The forms of a relaxation that ends within a sweep, and at least the fastest one. Slower ones act as
    /// springs and would crowd the list of explanations.
    fn shown_within_a_sweep(
        &self,
        effect: &Arc<dyn Effect>,
        cards: &[ParameterCard<'_>],
        mut forms: Vec<Vec<f64>>,
    ) -> Vec<Vec<f64>> {
        let is_time = |card: &ParameterCard<'_>| card.name == "time";
        let Some(place) = cards.iter().position(is_time).filter(|_| relaxes(effect, self.record)) else {
            return forms;
        };
        let fastest = forms.iter().map(|values| values[place]).fold(f64::INFINITY, f64::min);
        let longest = longest_sweep(self.record).max(fastest);
        forms.retain(|values| values[place] <= longest);
        forms
    }

    /// For a rig error that the model has within its data sheet, the derivatives are those of the model.
    fn of_nuisance(
        &self,
        place: usize,
        effect: &Arc<dyn Effect>,
        cards: &[ParameterCard<'_>],
    ) -> Result<Vec<Sensitivity>, ModelError> {
        let model = &self.prepared.model;
        let name = effect.card().name;
        let parameters: Vec<usize> =
            (0..model.parameters().len()).filter(|i| model.parameters()[*i].effect == name).collect();
        let sizes = sizes(cards);
        let columns = self.derivatives(model, self.theta, &parameters)?;
        let values = cards.iter().map(|card| card.off).collect();
        let columns: Vec<Vec<f64>> =
            sizes.iter().filter_map(|size| columns.get(size.place).cloned()).collect();
        Ok(vec![Sensitivity { effect: place, values, sizes, columns, whole: false }])
    }

    /// The effect as a whole, relative to the model without it.
    fn whole(&self, place: usize, model: &Model, values: &[f64]) -> Option<Sensitivity> {
        let theta: Vec<f64> = self.theta.iter().chain(values).copied().collect();
        let Ok(with) = model.evaluate_warm(self.record, &theta, &Wanted::default(), &self.warm.shared())
        else {
            // Without an equilibrium everywhere, the effect can't have produced these data.
            return None;
        };
        let change = minus(&with.force, self.force);
        let size = Size {
            place: 0,
            copy: 0,
            scale: 1.0,
            off: 0.0,
            sign: Sign::Positive,
            plausible: f64::INFINITY,
            secant: None,
        };
        let shows = self.shows(&change, 1.0);
        shows.then(|| Sensitivity {
            effect: place,
            values: values.to_vec(),
            sizes: vec![size],
            columns: vec![change],
            whole: true,
        })
    }

    /// Whether a column times a size exceeds rounding errors.
    fn shows(&self, column: &[f64], size: f64) -> bool {
        column.iter().all(|c| c.is_finite())
            && column.iter().any(|c| (c * size).abs() > NOTHING * self.full_scale)
    }

    /// The effect in one form.
    fn at(
        &self,
        place: usize,
        effect: &Arc<dyn Effect>,
        model: &Model,
        cards: &[ParameterCard<'_>],
        sizes: &[Size],
        values: Vec<f64>,
    ) -> Result<Option<Sensitivity>, ModelError> {
        let copies = (model.parameters().len() - self.theta.len()) / cards.len().max(1);
        let mut theta = self.theta.to_vec();
        for _ in 0..copies {
            theta.extend(&values);
        }
        let parameters: Vec<usize> = (0..copies)
            .flat_map(|copy| sizes.iter().map(move |size| self.theta.len() + copy * cards.len() + size.place))
            .collect();
        let mut columns = self.derivatives(model, &theta, &parameters)?;
        let mut sizes: Vec<Size> =
            (0..copies).flat_map(|copy| sizes.iter().map(move |size| Size { copy, ..*size })).collect();
        for ((column, size), parameter) in columns.iter_mut().zip(&mut sizes).zip(&parameters) {
            if self.shows(column, size.scale) {
                continue;
            }
            // There is no change to first order, as for an angle or a spread: take the secant. A parameter
            // without small values may have no state here.
            let card = &cards[size.place];
            let sign = if size.sign == Sign::Negative { -1.0 } else { 1.0 };
            let step = (sign * SECANT * size.scale).clamp(card.low - card.off, card.high - card.off);
            let mut moved = theta.clone();
            moved[*parameter] += step;
            let Ok(with) = model.evaluate_warm(self.record, &moved, &Wanted::default(), &self.warm.shared())
            else {
                return Ok(None);
            };
            *column =
                with.force.iter().zip(self.force).map(|(with, without)| (with - without) / step).collect();
            size.secant = Some(step);
        }
        // Drop columns without any change, like the modulus of rubber that is absent.
        let visible: Vec<bool> =
            columns.iter().zip(&sizes).map(|(c, size)| self.shows(c, size.scale)).collect();
        let mut keep = visible.iter();
        columns.retain(|_| keep.next().copied().unwrap_or(false));
        let mut keep = visible.iter();
        sizes.retain(|_| keep.next().copied().unwrap_or(false));
        let shows = !columns.is_empty();
        let absent = effect.stage() == Stage::Shape
            && sizes.iter().any(|size| size.secant.is_some_and(|s| is_absent_below(effect, model, size, s)));
        Ok((shows && !absent).then_some(Sensitivity { effect: place, values, sizes, columns, whole: false }))
    }

    /// Derivatives of the force by some parameters, column by column.
    fn derivatives(
        &self,
        model: &Model,
        theta: &[f64],
        parameters: &[usize],
    ) -> Result<Vec<Vec<f64>>, ModelError> {
        let wanted = Wanted { parameters: parameters.to_vec(), readings: false };
        let prediction = model.evaluate_warm(self.record, theta, &wanted, &self.warm.shared())?;
        let k = parameters.len();
        Ok((0..k).map(|j| prediction.jacobian.iter().skip(j).step_by(k).copied().collect()).collect())
    }
}

/// Whether an effect has no small values of a size, so that it is either present or absent.
fn is_absent_below(effect: &Arc<dyn Effect>, model: &Model, size: &Size, step: f64) -> bool {
    let cards = effect.parameters();
    let muscle = model.muscle();
    let mut values: Vec<f64> = cards.iter().map(|card| card.of(muscle).typical).collect();
    let Some(value) = values.get_mut(size.place) else { return false };
    *value = size.off + 1e-3 * step;
    effect.reshaped(&values, muscle).is_err()
}
