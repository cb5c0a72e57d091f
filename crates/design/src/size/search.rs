//! The search for lengths and pressures.

use bulge_numerics::minimum::golden;
use bulge_numerics::root::illinois;
use rayon::prelude::*;
use serde::Serialize;

use super::SizeError;
use super::choice::{Choice, Given, Infeasible, contraction, holding_pressure, least};
use super::family::{CutMuscle, Family, Limits};
use super::load::{LoadCase, LoadPoint};

/// Weights of a compromise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Weights {
    /// Weight of (p/p_max)^2.
    pub pressure: f64,
    /// Weight of (e_end/e_max)^2.
    pub contraction: f64,
    /// Weight of (l/l_shortest)^2, with the shortest length that carries the load at the highest pressure.
    pub length: f64,
}

impl Default for Weights {
    fn default() -> Self {
        Self { pressure: 1.0, contraction: 1.0, length: 0.25 }
    }
}

/// Requirements on the muscles.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Requirements {
    /// Operating gauge pressures for which the shortest length is sought \[Pa\].
    pub pressures_pa: Vec<f64>,
    /// Lengths for which the lowest pressure is sought \[m\].
    pub lengths_m: Vec<f64>,
    /// Reserve of force, relative to the required force.
    pub margin: f64,
    /// Lengths are rounded up to multiples of this step \[m\]; 0 for exact lengths.
    pub step_m: f64,
    /// Weights of a compromise; `None` if no compromise is sought.
    pub weights: Option<Weights>,
}

/// Result of a sizing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sizing {
    /// The load.
    pub load: LoadCase,
    /// Muscles that carry the load, ranked by the strain of their life, the lowest first.
    pub choices: Vec<Choice>,
    /// Muscles that don't carry it.
    pub infeasible: Vec<Infeasible>,
}

/// Relative tolerance of a length.
const LENGTH_TOLERANCE: f64 = 1e-10;
/// Relative tolerance of the length of a compromise, whose minimum is flat.
const COMPROMISE_TOLERANCE: f64 = 1e-6;

/// Finds muscles, lengths and pressures that carry a load, and ranks them. The search runs in parallel; its
/// result doesn't depend on the number of threads.
///
/// ```
/// use bulge_design::size::{Family, Limits, LoadCase, Requirements, size};
/// use bulge_effects::law::Law;
///
/// // S4: 50 kg (500 N) by 50 mm at 4 bar with a DMSP-20.
/// let law = Law::find("sarosi-6").unwrap();
/// let muscle = bulge_muscles::preset("dmsp-20-400")?;
/// let family = Family::of_law("DMSP-20", law, law.table("DMSP-20-400N, S4"), &muscle, Limits::FLUIDIC)?;
/// let load = LoadCase::lift(0.05, 0.0, 500.0)?;
/// let wish = Requirements { pressures_pa: vec![4e5], lengths_m: vec![], margin: 0.0, step_m: 1e-3, weights: None };
/// let sizing = size(&[family], &load, &wish)?;
/// assert!((sizing.choices[0].length_m - 0.4).abs() < 0.015);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If a requirement is invalid, or the equilibrium of a muscle can't be found. A muscle that doesn't carry
/// the load is no error.
pub fn size(families: &[Family], load: &LoadCase, wish: &Requirements) -> Result<Sizing, SizeError> {
    check(wish)?;
    let asked = wish.pressures_pa.iter().map(|p| Given::Pressure { pressure_pa: *p });
    let asked = asked.chain(wish.lengths_m.iter().map(|l| Given::Length { length_m: *l }));
    let asked: Vec<Given> = asked.chain(wish.weights.map(|_| Given::Compromise)).collect();
    let tasks: Vec<(&Family, Given)> =
        families.iter().flat_map(|family| asked.iter().map(move |given| (family, *given))).collect();
    let found: Vec<Result<Choice, Infeasible>> =
        tasks.par_iter().map(|(family, given)| one(family, *given, load, wish)).collect::<Result<_, _>>()?;
    let (mut choices, mut infeasible) = (Vec::new(), Vec::new());
    for found in found {
        match found {
            Ok(choice) => choices.push(choice),
            Err(not) => infeasible.push(not),
        }
    }
    choices.sort_by(|a: &Choice, b: &Choice| a.strain.total_cmp(&b.strain));
    Ok(Sizing { load: load.clone(), choices, infeasible })
}

fn check(wish: &Requirements) -> Result<(), SizeError> {
    let fault = |what, value, range| Err(SizeError::out_of_range(what, value, range));
    for (what, values) in [("pressure [Pa]", &wish.pressures_pa), ("length [m]", &wish.lengths_m)] {
        if let Some(value) = values.iter().find(|value| !(**value > 0.0 && value.is_finite())) {
            return fault(what, *value, "a finite number above 0");
        }
    }
    if !(wish.margin >= 0.0 && wish.margin.is_finite()) {
        return fault("margin [%]", wish.margin, "0 or more");
    }
    if !(wish.step_m >= 0.0 && wish.step_m.is_finite()) {
        return fault("step of lengths [m]", wish.step_m, "0 or more");
    }
    if let Some(Weights { pressure, contraction, length }) = wish.weights {
        for value in [pressure, contraction, length] {
            if !(value >= 0.0 && value.is_finite()) {
                return fault("weight", value, "a finite number, 0 or more");
            }
        }
        if pressure + contraction + length <= 0.0 {
            return fault("sum of the weights", 0.0, "above 0");
        }
    }
    Ok(())
}

fn one(
    family: &Family,
    given: Given,
    load: &LoadCase,
    wish: &Requirements,
) -> Result<Result<Choice, Infeasible>, SizeError> {
    let not = |why: String| Ok(Err(Infeasible { family: family.name().to_owned(), given, why }));
    let task = Task { family, load, way: load.path(), margin: wish.margin };
    let Limits { pressure_pa: highest, force_n: strongest, .. } = family.limits();
    if load.largest_n() > strongest {
        return not(format!("it may carry {strongest:.0} N: the load goes to {:.1} N", load.largest_n()));
    }
    let (length, pressure) = match given {
        Given::Pressure { pressure_pa } if pressure_pa > highest => {
            return not(format!("its highest pressure is {} bar", highest / 1e5));
        }
        Given::Pressure { pressure_pa } => match task.shortest(pressure_pa)? {
            Ok(length) => (task.rounded(length, wish.step_m), Some(pressure_pa)),
            Err(why) => return not(why),
        },
        Given::Length { length_m } => (length_m, None),
        Given::Compromise => match task.shortest(highest)? {
            Ok(shortest) => (
                task.rounded(task.compromise(shortest, wish.weights.unwrap_or_default())?, wish.step_m),
                None,
            ),
            Err(why) => return not(why),
        },
    };
    let [low, high] = family.limits().length_m;
    // A given or rounded length may be outside the range.
    if !(low..=high).contains(&length) {
        return not(format!(
            "it would be {:.1} mm long: it can be had from {:.0} to {:.0} mm",
            1e3 * length,
            1e3 * low,
            1e3 * high
        ));
    }
    let muscle = family.at(length)?;
    let end = contraction(&muscle, load.stroke_m());
    let most = family.limits().contraction[1];
    if end > most * (1.0 + 1e-12) {
        return not(format!(
            "the stroke would take it to a contraction of {:.1} %: its largest is {:.1} %",
            100.0 * end,
            100.0 * most
        ));
    }
    let pressure = match pressure {
        Some(pressure) => pressure,
        None => match task.lowest(&muscle)? {
            Ok(pressure) => pressure,
            Err(why) => return not(why),
        },
    };
    Choice::new(&muscle, pressure, given, load).map(Ok)
}

/// A load and the family that is to carry it.
struct Task<'a> {
    family: &'a Family,
    load: &'a LoadCase,
    way: Vec<LoadPoint>,
    margin: f64,
}

impl Task<'_> {
    /// Rounds up to a multiple of the step, with a tolerance for rounding errors.
    fn rounded(&self, length: f64, step: f64) -> f64 {
        if step == 0.0 {
            return length;
        }
        let up = (length / step - 1e-6).ceil() * step;
        up.max(self.family.limits().length_m[0])
    }

    /// The smallest ratio of forces minus 1, for a muscle of a length.
    fn least(&self, length: f64, pressure: f64, way: &[LoadPoint]) -> Result<(f64, LoadPoint), SizeError> {
        least(&self.family.at(length)?, pressure, way, self.margin)
    }

    /// The shortest muscle that carries the load at a pressure, or the reason why none does.
    fn shortest(&self, pressure: f64) -> Result<Result<f64, String>, SizeError> {
        let limits = self.family.limits();
        let [from, to] = limits.contraction;
        let [low, high] = limits.length_m;
        // Shorter muscles would contract too far.
        let low = low.max(self.load.stroke_m() / (to - from));
        if low > high {
            return Ok(Err(format!(
                "the stroke needs {:.0} mm of it at least: it can be had to {:.0} mm",
                1e3 * low,
                1e3 * high
            )));
        }
        // The points come first; the whole way follows, because the load between them may require more.
        let mut length = low;
        for way in [self.load.points(), &self.way] {
            if self.least(length, pressure, way)?.0 >= -LENGTH_TOLERANCE {
                continue;
            }
            let (missing, at) = self.least(high, pressure, way)?;
            if missing < 0.0 {
                return Ok(Err(self.too_weak(&self.family.at(high)?, pressure, at)?));
            }
            let mut failed = None;
            // Solve in 1/l, to which contractions are proportional.
            let over = illinois(
                |over| match self.least(1.0 / over, pressure, way) {
                    Ok((ratio, _)) => ratio.min(1.0),
                    Err(error) => {
                        failed.get_or_insert(error);
                        f64::NAN
                    }
                },
                1.0 / high,
                1.0 / length,
                LENGTH_TOLERANCE / high,
            );
            if let Some(error) = failed {
                return Err(error);
            }
            length = 1.0 / over;
        }
        Ok(Ok(length))
    }

    fn too_weak(&self, muscle: &CutMuscle<'_>, pressure: f64, at: LoadPoint) -> Result<String, SizeError> {
        let force = muscle.force_n(pressure, contraction(muscle, at.travel_m))?;
        Ok(format!(
            "{:.1} mm long it pulls {force:.1} N at {} bar after {:.1} mm, where {:.1} N are needed",
            1e3 * muscle.length_m(),
            pressure / 1e5,
            1e3 * at.travel_m,
            (1.0 + self.margin) * at.force_n
        ))
    }

    /// The lowest pressure at which a muscle carries the load, or the reason why none does.
    fn lowest(&self, muscle: &CutMuscle<'_>) -> Result<Result<f64, String>, SizeError> {
        let highest = self.family.limits().pressure_pa;
        let (missing, at) = least(muscle, highest, &self.way, self.margin)?;
        if missing < 0.0 {
            return Ok(Err(self.too_weak(muscle, highest, at)?));
        }
        let mut lowest = 0.0_f64;
        // Begin at the end, where the required pressure is highest. A point that is already held needs no
        // search.
        for point in self.way.iter().rev() {
            let (needed, e) = ((1.0 + self.margin) * point.force_n, contraction(muscle, point.travel_m));
            if muscle.force_n(lowest, e)? < needed {
                lowest = holding_pressure(muscle, e, needed)?;
            }
        }
        Ok(Ok(lowest))
    }

    /// The length with the smallest weighted sum, between the shortest and the longest.
    fn compromise(&self, shortest: f64, weights: Weights) -> Result<f64, SizeError> {
        let longest = self.family.limits().length_m[1];
        let cost = |length: f64| -> Result<f64, SizeError> {
            let muscle = self.family.at(length)?;
            let limits = self.family.limits();
            let pressure = self.lowest(&muscle)?.unwrap_or(limits.pressure_pa) / limits.pressure_pa;
            let drawn = contraction(&muscle, self.load.stroke_m()) / limits.contraction[1];
            let long = length / shortest;
            Ok(weights.pressure * pressure * pressure
                + weights.contraction * drawn * drawn
                + weights.length * long * long)
        };
        if longest <= shortest * (1.0 + 1e-9) {
            return Ok(shortest);
        }
        let mut failed = None;
        let at = |log: f64| {
            let found = cost(log.exp()).unwrap_or_else(|error| {
                failed.get_or_insert(error);
                f64::INFINITY
            });
            (log, found)
        };
        let start = (shortest.ln(), cost(shortest)?);
        let (log, least) = golden(start, [start.0, longest.ln()], COMPROMISE_TOLERANCE, |place| *place, at);
        if let Some(error) = failed {
            return Err(error);
        }
        // The search never evaluates the upper end itself.
        Ok(if cost(longest)? < least { longest } else { log.exp() })
    }
}
