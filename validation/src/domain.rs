//! The domain map: random muscles of every kind over the ranges that are promised, one random question each, and how it ended.
//!
//! Number i of a seed is the same muscle with the same question in every run, whatever the number of threads.

use bulge_fibre::{
    Approach, BRAID_ANGLE, BRAIDED_SLENDERNESS, FibreError, Given, PLEATED_SLENDERNESS, Problem, Response,
};
use bulge_muscles::{
    Angle, Bladder, Braided, Construction, Ends, Fault, Fibre, FibreCount, Force, Length, LineStiffness,
    Muscle, MuscleError, Parameter, Pleated, Pressure, Quantity, Unfolding,
};
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::check::{Check, Claim};
use crate::sample::Sampler;

/// Range of the gauge pressure \[Pa\].
const PRESSURE: [f64; 2] = [1e3, 1.5e6];
/// Range of the strain by which pressure stretches fibres: about p R l0/(n EA), or 2 pi p r0^2/(n EA sin^2(alpha0)) of a braid.
const STRETCH: [f64; 2] = [1e-6, 5e-2];
/// Range of K/(p R) of cloth, in a pleated muscle and in a braid.
const CLOTH: [[f64; 2]; 2] = [[1e-2, 1e6], [1e-2, 1e3]];
/// Range of c10 t/(p r0) of a bladder.
const RUBBER: [f64; 2] = [1e-4, 1e2];
/// Largest residual of the end conditions that an answer may have, whose square remains after the last step.
const RESIDUAL: f64 = 1e-6;
/// Largest departure from the first integral.
const FIRST_INTEGRAL: f64 = 1e-9;
/// Evaluations that one equilibrium may take.
pub const EVALUATIONS: u32 = 60_000;
/// Cases of a count that are kept.
const KEPT: usize = 40;

/// A kind of muscle.
type Kind = (&'static str, fn(&mut Sampler) -> Result<Muscle, MuscleError>);

/// What is drawn, by name.
const KINDS: [Kind; 15] = [
    ("pleated", |s| pleated(s, &[])),
    ("pleated, elastic", |s| pleated(s, &[Extra::Elastic])),
    ("pleated, deep pleats", |s| pleated(s, &[Extra::Depth])),
    ("pleated, cloth", |s| pleated(s, &[Extra::Cloth])),
    ("pleated, misaligned", |s| pleated(s, &[Extra::Misaligned])),
    ("pleated, lobes", lobes),
    ("pleated, anything", anything_pleated),
    ("braid", |s| braid(s, &[])),
    ("braid, other fittings", |s| braid(s, &[Extra::Fitting])),
    ("braid, elastic", |s| braid(s, &[Extra::Elastic])),
    ("braid, bladder", |s| braid(s, &[Extra::Rubber])),
    ("braid, gas on the inner wall", |s| braid(s, &[Extra::Depth])),
    ("braid, cloth", |s| braid(s, &[Extra::Cloth])),
    ("braid, anything", anything_braided),
    ("cylinder", cylinder),
];

/// What a muscle may have besides its fibres.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Extra {
    Elastic,
    Depth,
    Cloth,
    Misaligned,
    Rubber,
    Fitting,
}

/// How a question ended.
#[derive(Debug, Clone, PartialEq)]
enum Ending {
    Solved {
        evaluations: u32,
    },
    /// Solved, but not an equilibrium.
    Wrong(String),
    /// Exit status 1, 3, 4.
    Refused(Fault, String),
    Panicked,
}

/// How the questions to one kind of muscle ended.
#[derive(Debug, Clone, Default)]
pub struct Count {
    /// The kind.
    pub kind: &'static str,
    /// Answered with an equilibrium.
    pub solved: usize,
    /// Refused as wrong input (exit status 1).
    pub input: usize,
    /// No solution, with the limit (exit status 3).
    pub no_solution: usize,
    /// Not converged (exit status 4).
    pub not_converged: usize,
    /// Answered with something that is no equilibrium.
    pub wrong: usize,
    /// Panics.
    pub panicked: usize,
    /// Most evaluations of an answer.
    pub evaluations: u32,
    /// What went wrong: number, muscle, question and message.
    pub cases: Vec<String>,
}

impl Count {
    /// Questions in all.
    #[must_use]
    pub fn all(&self) -> usize {
        self.solved + self.input + self.no_solution + self.not_converged + self.wrong + self.panicked
    }

    fn add(&mut self, case: impl FnOnce() -> String, ending: Ending) {
        let keep = |what: &str| {
            if self.cases.len() < KEPT {
                self.cases.push(format!("{what}: {}", case()));
            }
        };
        match ending {
            Ending::Solved { evaluations } => {
                self.solved += 1;
                self.evaluations = self.evaluations.max(evaluations);
            }
            Ending::Wrong(what) => {
                keep(&what);
                self.wrong += 1;
            }
            Ending::Refused(Fault::Input, _) => self.input += 1,
            Ending::Refused(Fault::NoSolution, _) => self.no_solution += 1,
            Ending::Refused(Fault::NotConverged, what) => {
                keep(&what);
                self.not_converged += 1;
            }
            Ending::Panicked => {
                keep("panic");
                self.panicked += 1;
            }
        }
    }
}

/// Questions of the check, and of them those that may not converge.
const SAMPLE: (usize, f64) = (2000, 3e-3);

/// A sample of the map: none wrong, no panic, evaluations bounded, and hardly any that didn't converge.
pub(crate) fn sample() -> Check {
    Claim {
        group: "domain",
        name: "random muscles of 15 kinds, one question each: part that is neither solved nor refused with a limit",
        source: "residuals, first integral",
        tolerance: SAMPLE.1,
        why: "0.095 % of 10^5, 1 or 2 of these: most of them braids with stiff cloth on narrow fittings; anything wrong, a panic or too many evaluations counts as all",
    }
    .run(|tally| {
        let counts = map(1, SAMPLE.0);
        let lost: usize = counts.iter().map(|count| count.not_converged).sum();
        let all: usize = counts.iter().map(Count::all).sum();
        let first = counts.iter().find_map(|count| count.cases.first().map(|case| format!("{}, {case}", count.kind)));
        tally.add(lost as f64 / all as f64, || format!("{lost} of {all}: {}", first.clone().unwrap_or_default()));
        for count in &counts {
            let broken = count.wrong + count.panicked > 0 || count.evaluations > EVALUATIONS;
            tally.add(if broken { 1.0 } else { 0.0 }, || format!("{count:?}"));
        }
        Ok(())
    })
}

/// Asks `count` muscles one question each, kind after kind in turn.
#[must_use]
pub fn map(seed: u64, count: usize) -> Vec<Count> {
    let endings: Vec<(String, Ending)> = (0..count).into_par_iter().map(|number| one(seed, number)).collect();
    let mut counts = KINDS.map(|(kind, _)| Count { kind, ..Count::default() });
    for (number, (case, ending)) in endings.into_iter().enumerate() {
        counts[number % KINDS.len()].add(|| format!("number {number}, {case}"), ending);
    }
    counts.into()
}

/// Number `number` of a seed: a muscle, its pressure, and what is asked; none: the limit.
///
/// # Errors
/// Never, unless a range here is wrong.
pub fn drawn(seed: u64, number: usize) -> Result<(Muscle, Pressure, Option<Given>), MuscleError> {
    let mut sampler = Sampler::new(seed.wrapping_add(number as u64).wrapping_mul(0x2545_F491_4F6C_DD1D));
    let (_, draw) = KINDS[number % KINDS.len()];
    let muscle = draw(&mut sampler)?;
    let pressure = Pressure::pa(reference(&muscle));
    let question = question(&mut sampler, &muscle, pressure);
    Ok((muscle, pressure, question))
}

/// The question in words and how it ended.
fn one(seed: u64, number: usize) -> (String, Ending) {
    let (muscle, pressure, question) = match drawn(seed, number) {
        Ok(drawn) => drawn,
        Err(error) => return (String::new(), Ending::Refused(Fault::Input, error.to_string())),
    };
    let ending = catch_unwind(AssertUnwindSafe(|| ask(&muscle, pressure, question)));
    let ending = ending.unwrap_or(Ending::Panicked);
    let case =
        if matches!(ending, Ending::Solved { .. } | Ending::Refused(Fault::Input | Fault::NoSolution, _)) {
            String::new()
        } else {
            format!("{question:?} at {pressure}, {muscle:?}")
        };
    (case, ending)
}

/// What is asked for; none: the limit.
fn question(sampler: &mut Sampler, muscle: &Muscle, pressure: Pressure) -> Option<Given> {
    let (radius, length) = (muscle.radius().si(), muscle.length().si());
    let part = sampler.between(0.0, 1.0);
    if part < 0.55 {
        return Some(Given::Contraction(sampler.between(-0.06, 0.5)));
    }
    if part < 0.75 {
        let scale = pressure.si() * (radius * radius + 0.1 * radius * length);
        return Some(Given::Force(scale * sampler.log_between(1e-3, 1e2)));
    }
    if part < 0.9 {
        let straight = std::f64::consts::PI * radius * radius * length;
        return Some(Given::Volume(straight * sampler.log_between(0.5, 10.0)));
    }
    None
}

fn ask(muscle: &Muscle, pressure: Pressure, question: Option<Given>) -> Ending {
    let answer = || -> Result<Option<Response>, FibreError> {
        let problem = Problem::new(muscle, pressure)?;
        match question {
            Some(given) => problem.solve(given, Approach::Auto).map(Some),
            None => problem.contraction_limit(Approach::Auto).map(|_| None),
        }
    };
    match answer() {
        Ok(None) => Ending::Solved { evaluations: 0 },
        Ok(Some(found)) => wrong_with(&found, question)
            .map_or(Ending::Solved { evaluations: found.convergence.evaluations }, Ending::Wrong),
        Err(error) => Ending::Refused(error.fault(), error.to_string()),
    }
}

/// Why an answer is no equilibrium, or none to the question.
fn wrong_with(found: &Response, question: Option<Given>) -> Option<String> {
    let numbers = [
        found.force_n,
        found.stiffness_n_per_m,
        found.stiffness_isothermal_n_per_m,
        found.stiffness_adiabatic_n_per_m,
        found.volume_slope_m2,
        found.end_slope_rad,
        found.fibre_tension_n,
        found.fibre_strain,
    ];
    let positive =
        [found.volume_m3, found.volume_polygon_m3, found.max_radius_m, found.mid_radius_m, found.length_m];
    let scale = found.pressure_pa * found.max_radius_m.powi(2);
    let missed = match question {
        Some(Given::Force(force)) => (found.force_n - force).abs() > 1e-6 * (force + scale),
        Some(Given::Volume(volume)) => (found.volume_m3 / volume - 1.0).abs() > 1e-6,
        _ => false,
    };
    let convergence = &found.convergence;
    if numbers.iter().chain(&positive).any(|number| !number.is_finite()) {
        Some(format!("a number is none: {found:?}"))
    } else if positive.iter().any(|number| *number <= 0.0) || found.fibre_tension_n < 0.0 {
        Some(format!("not positive: {found:?}"))
    } else if convergence.residual > RESIDUAL || convergence.first_integral > FIRST_INTEGRAL {
        Some(format!("residual {:e}, first integral {:e}", convergence.residual, convergence.first_integral))
    } else {
        missed.then(|| format!("{} N, {} m^3 is not what was asked for", found.force_n, found.volume_m3))
    }
}

/// The pressure \[Pa\] at which a muscle is asked: part of its name, as groups of stiffness over pressure are drawn.
fn reference(muscle: &Muscle) -> f64 {
    muscle.name().parse().unwrap_or(1e5)
}

fn pleated(sampler: &mut Sampler, extras: &[Extra]) -> Result<Muscle, MuscleError> {
    let has = |extra| extras.contains(&extra);
    let pressure = sampler.log_between(PRESSURE[0], PRESSURE[1]);
    let radius = sampler.log_between(0.002, 0.05);
    let [low, high] = PLEATED_SLENDERNESS;
    let most = if has(Extra::Misaligned) { BRAIDED_SLENDERNESS[1] } else { high };
    let length = radius * sampler.log_between(low, most);
    let count = sampler.one_of(&[Some(3), Some(12), Some(40), None]);
    let count = count.map_or(FibreCount::Continuous, FibreCount::Discrete);
    let construction = Construction::Pleated(Pleated::new(Length::m(radius), count)?);
    let mut muscle = Muscle::new(pressure.to_string(), Length::m(length), construction)?;
    if has(Extra::Depth) {
        muscle = muscle.with(Parameter::PleatDepth, radius * sampler.log_between(1e-3, 2.0))?;
    }
    if has(Extra::Misaligned) {
        let most = (0.9 * radius / (radius + 0.4 * length)).asin();
        muscle = muscle.with(Parameter::Misalignment, most * sampler.between(0.02, 1.0))?;
    }
    finished(sampler, muscle, extras, 0.4 * length)
}

fn lobes(sampler: &mut Sampler) -> Result<Muscle, MuscleError> {
    lobed(sampler, &[])
}

/// Cloth from just wider than the fibres at the fittings to plenty.
fn lobed(sampler: &mut Sampler, extras: &[Extra]) -> Result<Muscle, MuscleError> {
    let pressure = sampler.log_between(PRESSURE[0], PRESSURE[1]);
    let radius = sampler.log_between(0.002, 0.05);
    let fibres = sampler.log_between(3.0, 300.0).round();
    let open = radius * sampler.log_between(1.02, 6.0);
    let most = (PLEATED_SLENDERNESS[1] * radius).min(600.0 * open / fibres);
    let length = sampler.log_between(PLEATED_SLENDERNESS[0] * radius, most.max(0.6 * radius));
    let construction = Construction::Pleated(Pleated::new(Length::m(radius), FibreCount::Discrete(3))?);
    let muscle = Muscle::new(pressure.to_string(), Length::m(length), construction)?
        .with(Parameter::Fibres, fibres)?
        .with(Parameter::ClothCircumference, std::f64::consts::TAU * open)?;
    finished(sampler, muscle, extras, open - radius)
}

fn anything_pleated(sampler: &mut Sampler) -> Result<Muscle, MuscleError> {
    let lobes = sampler.chance(0.3);
    let extras = some(sampler, &[Extra::Elastic, Extra::Depth, Extra::Cloth, Extra::Misaligned]);
    if lobes { lobed(sampler, &extras) } else { pleated(sampler, &extras) }
}

fn anything_braided(sampler: &mut Sampler) -> Result<Muscle, MuscleError> {
    let extras = some(sampler, &[Extra::Elastic, Extra::Depth, Extra::Cloth, Extra::Rubber, Extra::Fitting]);
    braid(sampler, &extras)
}

/// Each with the probability one half.
fn some(sampler: &mut Sampler, all: &[Extra]) -> Vec<Extra> {
    all.iter().copied().filter(|_| sampler.chance(0.5)).collect()
}

fn braid(sampler: &mut Sampler, extras: &[Extra]) -> Result<Muscle, MuscleError> {
    let has = |extra| extras.contains(&extra);
    let pressure = sampler.log_between(PRESSURE[0], PRESSURE[1]);
    let radius = sampler.log_between(0.002, 0.03);
    let length = radius * sampler.log_between(BRAIDED_SLENDERNESS[0], BRAIDED_SLENDERNESS[1]);
    let angle = Angle::deg(sampler.between(BRAID_ANGLE[0], BRAID_ANGLE[1]));
    let mut braided = Braided::new(Length::m(radius), angle)?.with_fibres(60)?;
    let fitting = if has(Extra::Fitting) { radius * sampler.between(0.2, 2.0) } else { radius };
    if has(Extra::Fitting) {
        braided = braided.with_fitting_radius(Length::m(fitting))?;
    }
    let mut muscle = Muscle::new(pressure.to_string(), Length::m(length), Construction::Braided(braided))?;
    if has(Extra::Depth) {
        let depth = radius.min(fitting) * sampler.between(0.01, 0.3);
        muscle = muscle.with_gas_wall(Some(Length::m(depth)))?;
    }
    finished(sampler, muscle, extras, 0.5 * radius)
}

fn cylinder(sampler: &mut Sampler) -> Result<Muscle, MuscleError> {
    let extras = some(sampler, &[Extra::Elastic, Extra::Rubber]);
    let pressure = sampler.log_between(PRESSURE[0], PRESSURE[1]);
    let radius = sampler.log_between(0.002, 0.03);
    let angle = Angle::deg(sampler.between(BRAID_ANGLE[0], BRAID_ANGLE[1]));
    let braided = Braided::new(Length::m(radius), angle)?.with_fibres(60)?.with_ends(Ends::Cylinder);
    let length = Length::m(radius * sampler.log_between(1.0, 100.0));
    let muscle = Muscle::new(pressure.to_string(), length, Construction::Braided(braided))?;
    finished(sampler, muscle, &extras, 0.5 * radius)
}

/// With what has a stiffness: elastic fibres, a bladder, and cloth that comes taut within twice the `room`.
fn finished(
    sampler: &mut Sampler,
    mut muscle: Muscle,
    extras: &[Extra],
    room: f64,
) -> Result<Muscle, MuscleError> {
    let (pressure, radius, length) = (reference(&muscle), muscle.radius().si(), muscle.length().si());
    if extras.contains(&Extra::Elastic) {
        let pull = match muscle.construction() {
            Construction::Braided(braided) => {
                std::f64::consts::TAU * (radius / braided.braid_angle().si().sin()).powi(2)
            }
            Construction::Pleated(_) => radius * length,
        } * pressure;
        let total = pull / sampler.log_between(STRETCH[0], STRETCH[1]);
        let each = total / muscle.fibres().map_or(1.0, f64::from);
        muscle = muscle.with_fibre(Fibre::new(Force::n(each))?)?;
    }
    if extras.contains(&Extra::Rubber) {
        let wall = radius * sampler.log_between(0.01, 0.3);
        let c10 = Pressure::pa(pressure * radius / wall * sampler.log_between(RUBBER[0], RUBBER[1]));
        let second = if sampler.chance(0.5) { sampler.between(0.0, 0.5) } else { 0.0 };
        let c01 = Pressure::pa(second * c10.si());
        muscle = muscle.with_bladder(Bladder::new(c10, c01, Length::m(wall))?)?;
    }
    if extras.contains(&Extra::Cloth) {
        let unfolded = muscle.end_radius().si() + room * sampler.log_between(1e-3, 2.0);
        let [low, high] = CLOTH[usize::from(!muscle.is_pleated())];
        let stiffness = LineStiffness::n_per_m(pressure * radius * sampler.log_between(low, high));
        muscle = muscle.with_unfolding(Unfolding::new(stiffness, Length::m(unfolded))?);
    }
    Ok(muscle)
}
