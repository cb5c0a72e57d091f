//! The geometry behind a diagnosis: which numbers are uncertain, where the data move them, and which
//! measurement would settle them.
//!
//! A number without a stated width gets the usual width for such muscles ([`Muscle::with_usual_widths`]) and
//! is fitted along within it. A braid without a stated wall gets a nominal one, so that rubber can be looked
//! for: the force only shows modulus times thickness.
//!
//! ```text
//! departure = d' C^-1 d,    d = found - stated,  C the covariance of the numbers beside all others
//! ```
//! From 4 sigma on, the diagnosis is repeated with exact geometry. No such muscle has a number that is more
//! than three usual widths away: the uncertainty then absorbs something else, and the answer for the geometry
//! as stated is given.

use bulge_effects::{Catalogue, Mechanism};
use bulge_model::{ModelParameter, Wanted, Warm};
use bulge_muscles::units::significant;
use bulge_muscles::{Muscle, Parameter};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use crate::comparison::analysis::Analysis;
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::document::{Diagnosis, Missing, Verdict};
use crate::diagnosis::stage::Stage;
use crate::fit::nuisance::is_geometry;
use crate::fit::problem::free;
use crate::noise::law::NoiseSource;

/// Sigmas and widths from which a number is reported as moved.
const MOVED: [f64; 2] = [2.0, 0.3];

/// Uncertainty of the geometry.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Geometry {
    /// In words; empty if the file states all widths and the wall.
    pub says: String,
    /// Numbers with a width.
    pub doubtful: Vec<DoubtfulNumber>,
    /// Numbers that the file doesn't state and that were assumed.
    pub assumed: Vec<AssumedNumber>,
    /// RMS error of the base with geometry, rig and everything else as stated \[N\].
    pub as_stated_rmse_n: Option<f64>,
    /// Squared distance between the fitted and the stated geometry, in sigmas.
    pub departure: f64,
    /// The answer with exact numbers instead of usual widths, if the data move them far; otherwise none.
    pub if_exact: Option<OtherAnswer>,
    /// The answer with usual widths, if the geometry is taken as stated because the data exceed those widths;
    /// otherwise none.
    pub if_doubtful: Option<OtherAnswer>,
}

/// A number of the geometry with its uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DoubtfulNumber {
    /// Its key in the muscle file.
    pub number: String,
    /// Value as stated, in `unit`.
    pub value: f64,
    /// Standard deviation, in `unit`.
    pub width: f64,
    /// Unit of all values.
    pub unit: &'static str,
    /// Whether the file states no width, so that the usual one is taken.
    pub by_default: bool,
    /// The value after the fit; none if the force doesn't depend on this number by itself.
    pub found: Option<MovedNumber>,
}

/// An uncertain number after the fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MovedNumber {
    /// Fitted value.
    pub value: f64,
    /// Standard deviation; none if data and width don't determine it.
    pub sd: Option<f64>,
    /// Distance from the stated value, in widths.
    pub widths: f64,
}

/// A number that was assumed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AssumedNumber {
    /// Its key in the muscle file.
    pub number: &'static str,
    /// Value in `unit`.
    pub value: f64,
    /// Unit of the value.
    pub unit: &'static str,
}

/// The answer if the uncertain numbers were exact, or the other way round.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OtherAnswer {
    /// The verdict.
    pub verdict: Verdict,
    /// Names of the effects that would be missing.
    pub missing: Vec<String>,
    /// Whether the answer differs.
    pub differs: bool,
}

impl OtherAnswer {
    fn of(other: &Diagnosis, answer: &Diagnosis) -> Self {
        let differs = other.verdict != answer.verdict || !is_same_set(names(other), names(answer));
        Self { verdict: other.verdict, missing: names(other), differs }
    }

    fn says(&self) -> String {
        match self.verdict {
            Verdict::Adequate => "nothing missing".to_owned(),
            Verdict::Missing => format!("missing: {}", self.missing.join(" and ")),
            Verdict::Unknown => "unknown".to_owned(),
            Verdict::CannotTell => "that these data cannot tell".to_owned(),
        }
    }
}

fn names(diagnosis: &Diagnosis) -> Vec<String> {
    diagnosis.missing.iter().map(|missing| missing.effect.clone()).collect()
}

/// Whether these are the same names. Their order, which tells what explains more, makes no other answer.
fn is_same_set(mut one: Vec<String>, mut other: Vec<String>) -> bool {
    one.sort_unstable();
    other.sort_unstable();
    one == other
}

/// How much of an answer is needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Asked {
    /// All of it.
    Whole,
    /// The verdict and the names.
    Names,
}

/// A muscle with the uncertainty of the numbers that its file doesn't state.
pub(crate) struct Doubt {
    /// The muscle with usual widths.
    pub(crate) doubted: Muscle,
    /// The muscle with exact numbers instead.
    pub(crate) exact: Muscle,
    added: Vec<Parameter>,
    /// The assumed wall \[m\].
    wall: Option<f64>,
}

impl Doubt {
    pub(crate) fn of(muscle: &Muscle) -> Self {
        let (doubted, added) = muscle.clone().with_usual_widths();
        let (doubted, wall) = doubted.with_usual_wall();
        let added: Vec<Parameter> = added.into_iter().map(|(parameter, _)| parameter).collect();
        let sure = |muscle: Muscle, p: &Parameter| muscle.clone().with_width(*p, 0.0).unwrap_or(muscle);
        Self { exact: added.iter().fold(doubted.clone(), sure), doubted, added, wall }
    }

    /// The final diagnosis, given one with usual widths. `answer_on` exact geometry is called if another
    /// answer may be expected.
    pub(crate) fn settled<E>(
        &self,
        mut doubtful: Diagnosis,
        answer_on: impl FnOnce(&Muscle, Asked) -> Result<Diagnosis, E>,
    ) -> Result<Diagnosis, E> {
        for number in &mut doubtful.geometry.doubtful {
            number.by_default = self.added.iter().any(|parameter| parameter.name() == number.number);
        }
        let beyond = |number: &DoubtfulNumber| {
            number.by_default
                && number.found.as_ref().is_some_and(|found| found.widths.abs() > RULE.another_muscle)
        };
        let is_beyond = doubtful.geometry.doubtful.iter().any(beyond);
        if self.added.is_empty() || !(is_beyond || doubtful.geometry.departure > RULE.departed) {
            return Ok(doubtful);
        }
        let may_be_taken = is_beyond || doubtful.verdict == Verdict::Unknown;
        let mut exact = answer_on(&self.exact, if may_be_taken { Asked::Whole } else { Asked::Names })?;
        // Take the exact geometry if its diagnosis got as far as an answer, whatever a tolerance says about
        // it; and if an event explains there what nothing explains in a muscle that may have any of these numbers.
        let is_event = doubtful.verdict == Verdict::Unknown && exact.remaining.event.is_some();
        if (is_beyond || is_event) && exact.noise.law.source != NoiseSource::Instruments {
            let if_doubtful = Some(OtherAnswer::of(&doubtful, &exact));
            exact.geometry = Geometry { if_doubtful, ..doubtful.geometry };
            return Ok(exact);
        }
        doubtful.geometry.if_exact = Some(OtherAnswer::of(&exact, &doubtful));
        Ok(doubtful)
    }

    /// Completes the geometry of a diagnosis, with its sentence.
    pub(crate) fn say(&self, diagnosis: &mut Diagnosis, catalogue: &Catalogue) {
        let rubber = self.wall.map(|wall| rubber(diagnosis, catalogue, wall));
        let geometry = &mut diagnosis.geometry;
        geometry.assumed = self
            .wall
            .map(|wall| AssumedNumber { number: "wall", value: 1e3 * wall, unit: "mm" })
            .into_iter()
            .collect();
        geometry.says = [rubber.unwrap_or_default(), geometry.doubt_says()]
            .into_iter()
            .filter(|says| !says.is_empty())
            .collect::<Vec<_>>()
            .join("; ");
    }
}

/// The modulus times thickness of the rubber that was found, if only this product is known.
fn rubber(diagnosis: &Diagnosis, catalogue: &Catalogue, wall: f64) -> String {
    let is_modulus = |missing: &Missing, name: &str| {
        let effect = catalogue.find(&missing.fitted).ok()?;
        let is_rubber = effect.card().mechanism == Mechanism::Rubber;
        effect
            .parameters()
            .iter()
            .find(|p| is_rubber && p.name == name && p.unit == "MPa")
            .map(|p| p.key.to_owned())
    };
    let found: Vec<String> = diagnosis
        .added()
        .flat_map(|missing| missing.parameters.iter().map(move |(name, number)| (missing, name, number)))
        .filter_map(|(missing, name, number)| {
            let key = is_modulus(missing, name)?;
            let line = |modulus: f64| significant(1e6 * modulus * wall, 3);
            let (value, low, high) = (line(number.value), line(number.low), line(number.high));
            Some(format!("{} is known as {key} x t = {value} N/m ({low} to {high})", missing.effect))
        })
        .collect();
    if found.is_empty() {
        return String::new();
    }
    format!(
        "{}: the wall t isn't stated, {} mm assumed; write `wall = \"...\"` into the muscle file",
        found.join(", "),
        significant(1e3 * wall, 3)
    )
}

impl Geometry {
    fn doubt_says(&self) -> String {
        let taken: Vec<&DoubtfulNumber> = self.doubtful.iter().filter(|number| number.by_default).collect();
        let stated: Vec<String> = taken.iter().map(|number| number.says()).collect();
        let moved: Vec<String> = self.doubtful.iter().filter_map(DoubtfulNumber::moved_says).collect();
        if taken.is_empty() && moved.is_empty() {
            return String::new();
        }
        let data = match (moved.is_empty(), self.as_stated_rmse_n) {
            (true, _) => "the data move none of them".to_owned(),
            (false, Some(error)) => {
                format!(
                    "the data want {} (as stated the base is off by {} N)",
                    moved.join(", "),
                    significant(error, 3)
                )
            }
            (false, None) => format!("the data want {}", moved.join(", ")),
        };
        if taken.is_empty() {
            return format!("of the numbers that the file states with a width {data}");
        }
        let default = format!("{} by default (state `+- ...`, `+- 0` if exact)", stated.join(", "));
        let ruler = || self.ruler().map_or_else(String::new, |ruler| format!(": {ruler} settles that"));
        match (&self.if_exact, &self.if_doubtful) {
            (_, Some(other)) if other.differs => format!(
                "{default}: {data}, which no such muscle has, so all is taken as stated; with that doubt the answer would be {}{}",
                other.says(),
                ruler()
            ),
            (_, Some(_)) => {
                format!(
                    "{default}: {data}, which no such muscle has, so all is taken as stated; the answer is the same with that doubt"
                )
            }
            (Some(other), _) if other.differs => {
                format!(
                    "{default}: {data}; were what is by default exact, the answer would be {}{}",
                    other.says(),
                    ruler()
                )
            }
            (Some(_), _) => {
                format!("{default}: {data}; were what is by default exact, the answer would be the same")
            }
            (None, None) => format!("{default}: {data}"),
        }
    }

    /// The decisive measurement: of the number that moved furthest, to a third of its move.
    fn ruler(&self) -> Option<String> {
        let moved =
            self.doubtful.iter().filter(|n| n.by_default).filter_map(|n| Some((n, n.found.as_ref()?)));
        let (number, found) = moved.max_by(|a, b| a.1.widths.abs().total_cmp(&b.1.widths.abs()))?;
        let to = significant((found.value - number.value).abs() / 3.0, 1);
        Some(format!("the {} measured to {to} {}", number.number.replace('_', " "), number.unit))
    }
}

impl DoubtfulNumber {
    fn says(&self) -> String {
        format!(
            "{} {} {} +- {}",
            self.number.replace('_', " "),
            significant(self.value, 4),
            self.unit,
            significant(self.width, 2)
        )
    }

    fn moved_says(&self) -> Option<String> {
        let found = self.found.as_ref()?;
        let sd = found.sd?;
        let is_far = (found.value - self.value).abs() > MOVED[0] * sd && found.widths.abs() > MOVED[1];
        is_far.then(|| {
            let (value, widths) = (significant(found.value, 4), significant(found.widths.abs(), 2));
            format!("{} {value} {}, {widths} widths off", self.number.replace('_', " "), self.unit)
        })
    }
}

/// A parameter of the fit that represents a number of the geometry.
struct Fitted {
    parameter: Parameter,
    /// Index among the free parameters.
    place: usize,
    /// Fitted and stated value, in the SI unit of the parameter.
    value: f64,
    stated: f64,
    /// Derivative of the parameter in SI by the coordinate of the search.
    per_coordinate: f64,
    /// Distance in coordinates.
    distance: f64,
}

/// The geometry of a model.
pub(crate) fn geometry(analysis: &Analysis<'_>, stage: &Stage) -> Geometry {
    let muscle = analysis.muscle;
    let fitted = fitted(muscle, stage);
    let minimum = &stage.confirmed.minimum;
    let sd = minimum.standard_deviations(stage.scatter());
    let in_unit = |parameter: Parameter, value: f64| match parameter {
        Parameter::BraidAngle => (value.to_degrees(), "deg"),
        _ => (1e3 * value, "mm"),
    };
    let doubtful = muscle.widths().iter().filter(|(p, width)| is_geometry(*p) && *width > 0.0);
    let number = |(parameter, width): &(Parameter, f64)| {
        let (value, unit) = in_unit(*parameter, muscle.get(*parameter)?);
        let found = fitted.iter().find(|f| f.parameter == *parameter).map(|f| MovedNumber {
            value: in_unit(*parameter, f.value).0,
            sd: sd.get(f.place).copied().flatten().map(|sd| in_unit(*parameter, sd * f.per_coordinate).0),
            widths: (f.value - f.stated) / width,
        });
        let width = in_unit(*parameter, *width).0;
        Some(DoubtfulNumber {
            number: parameter.name().to_owned(),
            value,
            width,
            unit,
            by_default: false,
            found,
        })
    };
    Geometry {
        doubtful: doubtful.filter_map(number).collect(),
        as_stated_rmse_n: as_stated(analysis),
        departure: departure(stage, &fitted),
        ..Geometry::default()
    }
}

fn fitted(muscle: &Muscle, stage: &Stage) -> Vec<Fitted> {
    let confirmed = &stage.confirmed;
    let numbers = confirmed.prepared.model.parameters();
    let mut found: Vec<Fitted> = Vec::new();
    for (place, index) in free(&confirmed.prepared.model).into_iter().enumerate() {
        let number = &numbers[index];
        let Some((parameter, at_off, scale)) = stands_for(muscle, number, confirmed.prepared.nuisance[index])
        else {
            continue;
        };
        // If specimens differ, the first one represents all.
        if found.iter().any(|f| f.parameter == parameter) {
            continue;
        }
        let value = confirmed.theta[index];
        let stated = muscle.get(parameter).unwrap_or(0.0);
        let of_stated = (stated - at_off) / scale;
        let (distance, slope) =
            if number.logarithmic { ((value / of_stated).ln(), value) } else { (value - of_stated, 1.0) };
        let per_coordinate = (slope * scale).abs();
        found.push(Fitted {
            parameter,
            place,
            value: at_off + scale * value,
            stated,
            per_coordinate,
            distance,
        });
    }
    found
}

/// The number of the geometry that an effect's parameter represents, as `(parameter, offset, factor)`:
/// parameter = offset + factor number.
fn stands_for(muscle: &Muscle, number: &ModelParameter, is_nuisance: bool) -> Option<(Parameter, f64, f64)> {
    let stated = |parameter| muscle.get(parameter);
    match number.effect.as_str() {
        "fibre-length" => stated(Parameter::Length).map(|l| (Parameter::Length, l, l)),
        "end-radius" if muscle.is_pleated() => Some((Parameter::Radius, 0.0, 1.0)),
        "radius-error" => Some((Parameter::Radius, 0.0, 1.0)),
        "braid-angle-error" => stated(Parameter::BraidAngle).map(|angle| (Parameter::BraidAngle, angle, 1.0)),
        "bladder-elasticity" if is_nuisance && number.key == "c10" => {
            let (wall, c10) = (stated(Parameter::Wall)?, stated(Parameter::C10)?);
            Some((Parameter::Wall, 0.0, wall / c10))
        }
        "wall-thickness" if is_nuisance => Some((Parameter::Wall, 0.0, 1.0)),
        _ => None,
    }
}

fn departure(stage: &Stage, fitted: &[Fitted]) -> f64 {
    let minimum = &stage.confirmed.minimum;
    let (all, some) = (minimum.theta.len(), fitted.len());
    if some == 0 {
        return 0.0;
    }
    let covariance = minimum.covariance(stage.scatter());
    let of = |i: usize, j: usize| covariance[fitted[i].place * all + fitted[j].place];
    let distance = DVector::from_iterator(some, fitted.iter().map(|f| f.distance));
    let found = DMatrix::from_fn(some, some, of).cholesky().map(|c| distance.dot(&c.solve(&distance)));
    // A number held at a bound has no covariance; it counts as infinitely far away.
    found.filter(|square| square.is_finite()).unwrap_or(f64::MAX)
}

/// RMS error of the base without any fit \[N\].
fn as_stated(analysis: &Analysis<'_>) -> Option<f64> {
    let model = analysis.base(0).ok()?;
    let counting = Warm::of_rows(&analysis.used.mask);
    let found =
        model.evaluate_partly(&analysis.record, &model.start(), &Wanted::default(), &counting).ok()?;
    let force = &found.prediction.force;
    let forces = [force];
    let errors = analysis.with_state(&forces).map(|row| (analysis.record.force()[row] - force[row]).powi(2));
    let (rows, square) = errors.fold((0_usize, 0.0), |(n, sum), error| (n + 1, sum + error));
    (rows > 0).then(|| (square / rows as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_names_in_another_order_are_the_same_answer() {
        let names = |of: &[&str]| of.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let rubber_first = names(&["bladder-elasticity", "presliding-hysteresis"]);
        assert!(is_same_set(rubber_first.clone(), names(&["presliding-hysteresis", "bladder-elasticity"])));
        assert!(!is_same_set(rubber_first.clone(), names(&["bladder-elasticity", "maxwell-slip"])));
        assert!(!is_same_set(rubber_first, names(&["bladder-elasticity"])));
    }
}
