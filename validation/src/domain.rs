//! The domain map: random muscles of every kind over the supported ranges are each asked one random question,
//! and the outcomes are counted.
//!
//! Number i of a seed is the same muscle with the same question in every run, on any number of threads.

use bulge_fibre::{Approach, FibreError, Given, Problem, Response};
use bulge_muscles::{Fault, Muscle, MuscleError, Pressure, Quantity};
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::check::{Check, Claim};
use crate::integrals;
use crate::sample::Sampler;

mod invariants;
mod muscles;

pub use invariants::{Broken, equilibria};
use muscles::{KINDS, reference};

/// Largest residual of the end conditions that an answer may have. Its square remains after the last step.
const RESIDUAL: f64 = 1e-6;
/// Largest departure from the first integral.
const FIRST_INTEGRAL: f64 = 1e-9;
/// Relative difference of force and volume below which two equilibria are the same.
const SAME: f64 = 1e-5;
/// Most evaluations for one equilibrium.
pub const EVALUATIONS: u32 = 60_000;
/// Number of cases that are kept in a count.
const KEPT: usize = 40;

/// Outcome of a question.
#[derive(Debug, Clone, PartialEq)]
enum Ending {
    Solved {
        evaluations: u32,
    },
    /// Solved, but not an equilibrium.
    Wrong(String),
    /// Exit status 1 or 3.
    Refused(Fault),
    /// Exit status 4, and the judgement by the first integrals.
    Lost(String, Judgement),
    Panicked,
}

/// Result of a search by the first integrals ([`integrals::states`]) if the shooting found nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Judgement {
    /// An equilibrium with taut fibres that pulls: the question has an answer.
    Pulls(integrals::State),
    /// Only equilibria that would push or whose fibres are slack. The question has no answer, and the limit
    /// should have been reported.
    Beyond(integrals::State),
    /// No equilibrium.
    Nothing,
    /// No equilibrium was found, but for this muscle the search can't exclude one.
    Unknown,
}

impl Judgement {
    fn of(muscle: &Muscle, pressure: Pressure, question: Option<Given>) -> Self {
        let states = integrals::states(muscle, pressure, question);
        let scale = pressure.si() * muscle.radius().si().powi(2);
        let pulls = states.iter().find(|state| state.taut && state.force_n >= -1e-6 * scale);
        match (pulls, states.first()) {
            (Some(state), _) => Self::Pulls(*state),
            (None, Some(state)) => Self::Beyond(*state),
            (None, None) if integrals::can_exclude(muscle) => Self::Nothing,
            (None, None) => Self::Unknown,
        }
    }
}

/// Outcomes of the questions to one kind of muscle.
#[derive(Debug, Clone, Default)]
pub struct Count {
    /// The kind.
    pub kind: &'static str,
    /// Answered with an equilibrium.
    pub solved: usize,
    /// Refused as wrong input (exit status 1).
    pub input: usize,
    /// Without a solution; the limit was reported (exit status 3).
    pub no_solution: usize,
    /// Not converged (exit status 4).
    pub not_converged: usize,
    /// Of the questions that did not converge: those where the first integrals have an equilibrium that
    /// pulls, only one that pushes or has slack fibres, none, and those where they can't exclude one.
    pub judged: [usize; 4],
    /// Answered with a state that is not in equilibrium.
    pub wrong: usize,
    /// Panics.
    pub panicked: usize,
    /// Most evaluations of an answer.
    pub evaluations: u32,
    /// Failed cases: number, muscle, question and message.
    pub cases: Vec<String>,
}

impl Count {
    /// Number of all questions.
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
            Ending::Refused(Fault::Input) => self.input += 1,
            Ending::Refused(_) => self.no_solution += 1,
            Ending::Lost(what, judgement) => {
                keep(&format!("{what}, by the first integrals {judgement:?}"));
                self.not_converged += 1;
                self.judged[match judgement {
                    Judgement::Pulls(_) => 0,
                    Judgement::Beyond(_) => 1,
                    Judgement::Nothing => 2,
                    Judgement::Unknown => 3,
                }] += 1;
            }
            Ending::Panicked => {
                keep("panic");
                self.panicked += 1;
            }
        }
    }
}

/// Number of questions of the check, and the fraction of them that may fail to converge.
const SAMPLE: (usize, f64) = (1000, 3e-3);

/// A sample of the map: no wrong answer, no panic, a bounded number of evaluations, and almost no failure to
/// converge.
pub(crate) fn sample() -> Check {
    Claim {
        group: "domain",
        name: "random muscles of 15 kinds, one question each: part that is neither solved nor refused with a limit",
        source: "residuals, first integral",
        tolerance: SAMPLE.1,
        why: "below 0.1 % of 10^5, 1 or 2 of these: most of them braids with stiff cloth on narrow fittings; anything wrong, a panic or too many evaluations counts as all",
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

/// Number of questions whose solutions are also searched for by the first integrals.
const SEARCHED: usize = 15;

/// The equilibria of random muscles, searched for by their two first integrals.
pub(crate) fn by_integrals() -> Check {
    Claim {
        group: "domain",
        name: "force and volume of random muscles, all kinds, by a search over two first integrals on a dense grid",
        source: "first integrals: no differential equation, no start",
        tolerance: 1e-6,
        why: "a fibre length is met to 1e-9, the contraction to 1e-13; a force may be a small difference",
    }
    .run(|tally| {
        let both: Vec<_> = (0..SEARCHED).into_par_iter().filter_map(|number| both(1, number)).collect();
        for found in both {
            if found.can_exclude || found.off < SAME {
                tally.add(found.off, || found.case.clone());
            }
        }
        Ok(())
    })
}

/// Asks `count` muscles one question each, cycling through the kinds.
#[must_use]
pub fn map(seed: u64, count: usize) -> Vec<Count> {
    let endings: Vec<(String, Ending)> = (0..count).into_par_iter().map(|number| one(seed, number)).collect();
    let mut counts = KINDS.map(|(kind, _)| Count { kind, ..Count::default() });
    for (number, (case, ending)) in endings.into_iter().enumerate() {
        counts[number % KINDS.len()].add(|| format!("number {number}, {case}"), ending);
    }
    counts.into()
}

/// Lists the questions of a range: the question, its outcome, and, if there was no answer, the judgement by
/// the first integrals.
#[must_use]
pub fn listed(seed: u64, range: std::ops::Range<usize>) -> Vec<String> {
    range.into_par_iter().map(|number| told(seed, number)).collect()
}

fn told(seed: u64, number: usize) -> String {
    let (kind, _) = KINDS[number % KINDS.len()];
    let (muscle, pressure, question) = match drawn(seed, number) {
        Ok(drawn) => drawn,
        Err(error) => return format!("{kind}, number {number}: {error}"),
    };
    let asked = || answer(&muscle, pressure, question);
    let ending = match catch_unwind(AssertUnwindSafe(asked)) {
        Ok(Ok(Answer::Found(found))) => {
            let wrong =
                wrong_with(&found, question).map_or_else(String::new, |what| format!("wrong, {what}: "));
            format!(
                "{wrong}{} N, {} m^3 at {}, {:?}",
                found.force_n, found.volume_m3, found.contraction, found.convergence
            )
        }
        Ok(Ok(Answer::Limit(limit))) => format!("limit {limit}"),
        Ok(Err(error)) => {
            let judgement = Judgement::of(&muscle, pressure, question);
            format!("{:?}, {error}; by the first integrals {judgement:?}", error.fault())
        }
        Err(_) => "panic".to_owned(),
    };
    format!("{kind}, number {number}, {question:?} at {pressure}: {ending}; {muscle:?}")
}

/// Tests how often the search by the first integrals finds the solutions of the shooting. Of `count`
/// questions, it returns the number that were solved, the number found with the same force and volume, and
/// the remaining cases.
#[must_use]
pub fn found_by_integrals(seed: u64, count: usize) -> (usize, usize, Vec<String>) {
    let both: Vec<Both> = (0..count).into_par_iter().filter_map(|number| both(seed, number)).collect();
    let missed: Vec<String> = both
        .iter()
        .filter(|both| both.off.is_nan() || both.off > SAME)
        .map(|both| both.case.clone())
        .collect();
    (both.len(), both.len() - missed.len(), missed)
}

/// A question that the shooting solves and the first integrals search for.
struct Both {
    /// Relative difference of force and volume of the nearest state; 1 if there is none.
    off: f64,
    can_exclude: bool,
    case: String,
}

fn both(seed: u64, number: usize) -> Option<Both> {
    let (muscle, pressure, question) = drawn(seed, number).ok()?;
    let problem = Problem::new(&muscle, pressure).ok()?;
    let solved = if let Some(given) = question {
        problem.solve(given, Approach::Auto).ok()?
    } else {
        let limit = problem.contraction_limit(Approach::Auto).ok()?;
        problem.follow(limit, Approach::Auto).ok()?
    };
    let states = integrals::states(&muscle, pressure, question);
    let scale = pressure.si() * solved.max_radius_m.powi(2) + solved.force_n.abs();
    let off = |state: &integrals::State| {
        let force = (state.force_n - solved.force_n).abs() / scale;
        force.max((state.volume_m3 / solved.volume_m3 - 1.0).abs())
    };
    let (kind, _) = KINDS[number % KINDS.len()];
    Some(Both {
        off: states.iter().map(off).fold(1.0, f64::min),
        can_exclude: integrals::can_exclude(&muscle),
        case: format!(
            "{kind}, number {number}: {} N, {} m^3 at {} by {question:?}; by the first integrals {states:?}",
            solved.force_n, solved.volume_m3, solved.contraction
        ),
    })
}

/// Number `number` of a seed: a muscle, its pressure, and the question; none stands for the limit.
///
/// # Errors
/// Never, unless a range here is wrong.
pub fn drawn(seed: u64, number: usize) -> Result<(Muscle, Pressure, Option<Given>), MuscleError> {
    let mut sampler = Sampler::new(seed.wrapping_add(number as u64).wrapping_mul(0x2545_F491_4F6C_DD1D));
    drawn_of(number % KINDS.len(), &mut sampler)
}

pub(crate) fn drawn_of(
    kind: usize,
    sampler: &mut Sampler,
) -> Result<(Muscle, Pressure, Option<Given>), MuscleError> {
    let (_, draw) = KINDS[kind];
    let muscle = draw(sampler)?;
    let pressure = Pressure::pa(reference(&muscle));
    let question = question(sampler, &muscle, pressure);
    Ok((muscle, pressure, question))
}

/// The question in words and how it ended.
fn one(seed: u64, number: usize) -> (String, Ending) {
    let Ok((muscle, pressure, question)) = drawn(seed, number) else {
        return (String::new(), Ending::Refused(Fault::Input));
    };
    let ending = catch_unwind(AssertUnwindSafe(|| ask(&muscle, pressure, question)));
    let ending = ending.unwrap_or(Ending::Panicked);
    let case = if matches!(ending, Ending::Solved { .. } | Ending::Refused(_)) {
        String::new()
    } else {
        format!("{question:?} at {pressure}, {muscle:?}")
    };
    (case, ending)
}

/// The question; none stands for the limit.
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

/// Answer to a question.
enum Answer {
    Found(Box<Response>),
    Limit(f64),
}

fn answer(muscle: &Muscle, pressure: Pressure, question: Option<Given>) -> Result<Answer, FibreError> {
    let problem = Problem::new(muscle, pressure)?;
    match question {
        Some(given) => problem.solve(given, Approach::Auto).map(|found| Answer::Found(Box::new(found))),
        None => problem.contraction_limit(Approach::Auto).map(Answer::Limit),
    }
}

fn ask(muscle: &Muscle, pressure: Pressure, question: Option<Given>) -> Ending {
    match answer(muscle, pressure, question) {
        Ok(Answer::Limit(_)) => Ending::Solved { evaluations: 0 },
        Ok(Answer::Found(found)) => wrong_with(&found, question)
            .map_or(Ending::Solved { evaluations: found.convergence.evaluations }, Ending::Wrong),
        Err(error) if error.fault() == Fault::NotConverged => {
            Ending::Lost(error.to_string(), Judgement::of(muscle, pressure, question))
        }
        Err(error) => Ending::Refused(error.fault()),
    }
}

/// Why an answer is not an equilibrium, or not the one in question.
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
