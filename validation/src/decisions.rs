//! What must hold of any diagnosis, and how often it says the same of less data: random muscles are tested by
//! random protocols, with one hidden effect or none.

use bulge_effects::Catalogue;
use bulge_inference::{
    Block, DiagnoseOptions, Diagnosis, Options, Path, Protocol, ReadingNoise, Verdict, diagnose,
    simulate_with,
};
use bulge_measurements::{Columns, Data, Labels, MeasurementError, Trace};
use bulge_muscles::{Muscle, Parameter, preset};
use std::collections::BTreeSet;

use crate::domain::Broken;
use crate::sample::Sampler;

/// Muscles that are tested, each with its own numbers changed a little.
const MUSCLES: [&str; 4] = ["ppam-2-r16", "dmsp-20-250", "ppam-2-r16", "dmsp-20-250"];
/// Effects that are hidden; an empty one hides none.
const HIDDEN: [&str; 16] = [
    "",
    "",
    "",
    "coulomb-friction",
    "bladder-elasticity",
    "frame-compliance",
    "pressure-offset",
    "force-gain",
    "creep",
    "end-taper",
    "presliding-hysteresis",
    "viscous-damping",
    "force-offset",
    "length-zero-error",
    "pressure-gain",
    "fibre-stretch",
];

/// A test: the muscle as stated, what was measured, and what is hidden.
#[derive(Debug, Clone)]
pub struct Case {
    /// The muscle as stated.
    pub muscle: Muscle,
    /// The readings.
    pub data: Data,
    /// The file they were read from.
    csv: String,
    /// Name of the hidden effect; empty if there is none.
    pub hidden: &'static str,
}

/// The test that these numbers make; none if the muscle can't be tested so, as where it would push.
#[must_use]
pub fn drawn(sampler: &mut Sampler) -> Option<Case> {
    let muscle = preset(MUSCLES[sampler.below(MUSCLES.len())]).ok()?;
    let changed = [Parameter::Length, Parameter::Radius]
        .map(|parameter| (parameter, muscle.get(parameter).unwrap_or(0.0) * sampler.between(0.8, 1.25)));
    let muscle = muscle.with_all(&changed).ok()?;
    let pressures: Vec<f64> = (0..2 + sampler.below(3)).map(|_| sampler.between(5e4, 5e5)).collect();
    let high = sampler.between(0.08, 0.2);
    let mut block = Block::loops(pressures, [sampler.between(0.005, 0.03), high], sampler.between(5.0, 60.0));
    block.path = if sampler.chance(0.5) { Path::Triangle } else { Path::Sine };
    block.cycles = 2;
    block.rows = 24 + u32::try_from(sampler.below(20)).ok()?;
    if sampler.chance(0.3) {
        block.held = (0..2 + sampler.below(2)).map(|_| sampler.between(0.02, high)).collect();
    }
    if sampler.chance(0.2) {
        block.specimens = 2;
    }
    let force_n = sampler.log_between(0.3, 4.0);
    let correlated = sampler.chance(0.2);
    let noise = ReadingNoise {
        force_n,
        correlated_n: if correlated { 0.7 * force_n } else { 0.0 },
        correlation_time_s: if correlated { 2.0 } else { 0.0 },
        ..ReadingNoise::default()
    };
    let protocol = Protocol { noise, ..Protocol::new(vec![block]) };
    let hidden = HIDDEN[sampler.below(HIDDEN.len())];
    let with: Vec<String> = if hidden.is_empty() { Vec::new() } else { vec![hidden.to_owned()] };
    let seed = sampler.below(1 << 20) as u64;
    let done = simulate_with(&muscle, &Catalogue::builtin(), &protocol, &with, seed).ok()?;
    Some(Case { muscle: done.muscle, data: done.data, csv: done.csv, hidden })
}

/// The test that these bytes make is diagnosed as it is, with its labels renamed, and in other units. The
/// result is the number of diagnoses.
///
/// # Errors
/// The first invariant that doesn't hold.
pub fn decision(bytes: &[u8]) -> Result<u32, Broken> {
    let Some(case) = drawn(&mut Sampler::of_bytes(bytes)) else { return Ok(0) };
    checked(&case).map_err(|what| Broken(format!("{what}; hidden `{}`, {:?}", case.hidden, case.muscle)))
}

/// Diagnoses a test in three ways and compares them.
///
/// # Errors
/// The first invariant that doesn't hold.
pub fn checked(case: &Case) -> Result<u32, String> {
    let found = asked(case, &case.data)?;
    consistent(&found)?;
    let columns = case.data.columns();
    let turned = Data::from_csv(&reordered(&case.csv), "turned.csv").map_err(|error| error.to_string())?;
    if turned.columns() != columns {
        return Err("columns in another order are read as other data".to_owned());
    }
    for (what, other) in [("renamed", renamed(columns)), ("in other units", rounded(columns))] {
        let other = Data::from_columns(other).map_err(|error| error.to_string())?;
        let again = asked(case, &other)?;
        let (one, two) = (summary(&found), summary(&again));
        if one != two {
            return Err(format!("{what}: {two:?} instead of {one:?}"));
        }
        let rmse = |found: &Diagnosis| found.ladder.last().map_or(0.0, |step| step.rmse_n);
        let off = rmse(&again) / rmse(&found) - 1.0;
        if off.abs() > 1e-3 {
            return Err(format!("{what}, the last error differs by {off:e}"));
        }
    }
    Ok(3)
}

/// The diagnosis of a test with these readings.
///
/// # Errors
/// The message, if there is none.
pub fn asked(case: &Case, data: &Data) -> Result<Diagnosis, String> {
    let mut base = Options::new(Catalogue::builtin(), Vec::new());
    base.held_out = false;
    base.rivals = false;
    diagnose(data, &case.muscle, &DiagnoseOptions::new(base)).map_err(|error| error.to_string())
}

/// The verdict, and the first name of each claim.
#[must_use]
pub fn summary(found: &Diagnosis) -> (Verdict, Vec<&str>) {
    (found.verdict, found.missing.iter().map(|missing| missing.family.as_str()).collect())
}

/// Verdict, claims, ladder, remainder and noise agree with each other.
fn consistent(found: &Diagnosis) -> Result<(), String> {
    let wrong = |what: &str| Err(format!("{what}: {:?}, {}", found.verdict, found.says));
    if (found.verdict == Verdict::Missing) == found.missing.is_empty() {
        return wrong("names and verdict disagree");
    }
    if found.verdict == Verdict::Adequate && (!found.nearest.is_empty() && found.remaining.structured) {
        return wrong("adequate, but structured");
    }
    if found.says.is_empty() {
        return wrong("no sentence");
    }
    let mut names = BTreeSet::new();
    for one in found.added() {
        if !names.insert(&one.effect) {
            return wrong("a name twice");
        }
        if one.class.first() != Some(&one.effect)
            || one.class.iter().collect::<BTreeSet<_>>().len() != one.class.len()
        {
            return wrong("a class that doesn't begin with its effect, or names one twice");
        }
        let rises = [one.confidence_form, one.confidence, one.confidence_mechanism];
        let in_order = rises.windows(2).all(|pair| pair[0] <= pair[1] + 1e-9);
        if !in_order || !rises.iter().all(|share| (0.0..=1.0).contains(share)) {
            return wrong("confidences that don't rise from form to family to mechanism");
        }
        if one.rivals.iter().any(|rival| rival.effect == one.effect) {
            return wrong("its own rival");
        }
        for (name, number) in &one.parameters {
            if !(number.low <= number.value && number.value <= number.high) {
                return wrong(&format!(
                    "{name} = {} outside [{}, {}]",
                    number.value, number.low, number.high
                ));
            }
        }
    }
    let rungs: Vec<f64> = found.ladder.iter().map(|step| step.rmse_n).collect();
    if rungs.windows(2).any(|pair| pair[1] > pair[0] * (1.0 + 1e-3)) {
        return wrong(&format!("a ladder that rises, {rungs:?}"));
    }
    if found.verdict != Verdict::CannotTell && rungs.iter().any(|rmse| !(*rmse > 0.0 && rmse.is_finite())) {
        return wrong(&format!("an error that is none, {rungs:?}"));
    }
    if !(found.noise_floor_n >= 0.0 && found.noise_floor_n.is_finite()) {
        return wrong("a floor that is none");
    }
    if let Some(last) = rungs.last()
        && *last < 0.5 * found.noise_floor_n
    {
        return wrong(&format!("an error of {last} below half the floor of {}", found.noise_floor_n));
    }
    Ok(())
}

/// Specimens, sweeps and cycles by other names; their order is the same.
fn renamed(columns: &Columns) -> Columns {
    let mut other = columns.clone();
    let named = |labels: &Labels| -> Labels {
        labels.rows().iter().map(|row| format!("no. {}", 7 + 3 * row)).collect()
    };
    other.specimen = columns.specimen.as_ref().map(named);
    other.sweep = columns.sweep.as_ref().map(named);
    other
}

/// Readings that were written in other units and read back: each is rounded once more.
fn rounded(columns: &Columns) -> Columns {
    let mut other = columns.clone();
    let through = |values: &mut [f64], factor: f64| values.iter_mut().for_each(|x| *x = *x * factor / factor);
    through(&mut other.pressure_pa, 1.0 / 6_894.757_293_168);
    through(&mut other.force_n, 1.0 / 4.448_221_615_260_5);
    match &mut other.motion {
        Trace::Contraction(values) => through(values, 0.3),
        Trace::Length(values) => through(values, 1.0 / 0.0254),
    }
    other
}

/// Every second row, as if it had been measured so.
///
/// # Errors
/// Never for a data set of several rows.
pub fn thinned(data: &Data) -> Result<Data, MeasurementError> {
    picked(data, |row, _| row % 2 == 0)
}

/// The first or the second half of each sweep, which is one of its two cycles.
///
/// # Errors
/// Never for a data set whose sweeps have several rows.
pub fn half(data: &Data, second: bool) -> Result<Data, MeasurementError> {
    picked(data, |_, part| (part >= 0.5) == second)
}

/// The rows for which `keep` says so of the row's number and its place in its sweep, 0 to 1.
fn picked(data: &Data, keep: impl Fn(usize, f64) -> bool) -> Result<Data, MeasurementError> {
    let mut rows = vec![false; data.len()];
    for sweep in data.sweeps() {
        for row in sweep.rows.clone() {
            rows[row] = keep(row, (row - sweep.rows.start) as f64 / sweep.rows.len() as f64);
        }
    }
    Data::from_columns(data.subset(&rows).columns().as_ref().clone())
}

/// Columns in reverse order make the same data set.
fn reordered(csv: &str) -> String {
    let turned = |line: &str| line.split(',').rev().collect::<Vec<_>>().join(",");
    csv.lines()
        .map(|line| if line.starts_with('#') { line.to_owned() } else { turned(line) } + "\n")
        .collect()
}
