//! Contradictions between data and muscle. A wrong unit, sign or zero is not physics, so the user is asked
//! about it, with the evidence.

use std::ops::Range;

use bulge_measurements::{Data, Trace};
use bulge_model::{Model, Record, Wanted, Warm};
use bulge_muscles::units::significant;
use bulge_muscles::{Muscle, Quantity};

use crate::comparison::clock;
use crate::comparison::document::Mismatch;
use crate::comparison::other_length;
use crate::comparison::rows::{full_scale, lines};
use crate::median::median;

/// An error below this fraction of full scale raises no question about units.
const LARGE: f64 = 0.08;
/// Largest remaining fraction of the error if the readings were meant otherwise.
pub(crate) const LEFT: f64 = 0.35;
/// An absolute pressure is decided if at most this fraction of the error remains, or a small error; otherwise
/// geometry or an effect may cause the offset as well.
const LEFT_SURELY: f64 = 0.15;
/// Factors between these may be gains, geometry, or effects.
const USUAL: (f64, f64) = (0.55, 1.8);
/// Two meanings are both named if their errors differ by less than this factor.
const ALIKE: f64 = 1.3;
/// Rows on which meanings are tried; the next constant is for rejecting most of them quickly.
const ROWS: usize = 300;
const FEW_ROWS: usize = 20;
/// Fraction of these rows that must have a state; the next constant is for the few rows.
pub(crate) const ANSWERED: f64 = 0.9;
const ANSWERED_OF_FEW: f64 = 0.7;
/// The standard atmosphere \[Pa\].
const ATMOSPHERE: f64 = 101_325.0;
/// The atmospheric pressure is above this value \[Pa\] in any weather and at usual heights, so that a lower
/// reading is no absolute pressure.
pub(crate) const LEAST_AIR: f64 = 0.85e5;
/// If the pressure is absolute, offsets that differ from the standard atmosphere by this much fit worse
/// \[Pa\].
const OTHER_OFFSET: f64 = 0.25e5;
/// A muscle doesn't match if a measured force is above this fraction of full scale where the model would
/// push.
const CLEARLY_PULLS: f64 = 0.1;
/// Readings below this fraction of full scale are no force.
const NO_FORCE: f64 = 0.01;
/// Sweeps without a force are asked about if the muscle as stated pulls with more than this fraction of full scale there.
const SURELY_PULLS: f64 = 0.25;
/// Factors between units of force, with the name of the unit and the heading to write.
const FORCES: [(f64, &str, &str); 4] = [
    (9.806_65, "kilograms", "force [kgf]"),
    (4.448_222, "pounds", "force [lbf]"),
    (1e3, "kilonewtons", "force [kN]"),
    (1e-3, "newtons", "force [N]"),
];
/// The same for pressures.
const PRESSURES: [(f64, &str); 8] = [
    (14.503_77, "bar read as psi"),
    (1.0 / 14.503_77, "psi read as bar"),
    (10.0, "MPa read as bar, or bar as 100 kPa"),
    (0.1, "bar read as MPa"),
    (100.0, "bar read as kPa"),
    (0.01, "kPa read as bar"),
    (6.894_76, "psi read as kPa"),
    (1.0 / 6.894_76, "kPa read as psi"),
];

/// Another muscle may explain a factor of the force as well as a unit.
const OTHER_MUSCLE: &str = ", or is the muscle not the one that was measured (its kind, its radius)?";

/// A possible meaning of the readings.
pub(crate) struct Meaning {
    pub(crate) kind: &'static str,
    /// The question, following "with ... the error falls from ... to ...: ".
    pub(crate) with: String,
    pub(crate) question: String,
    pub(crate) instead: String,
    /// Maps pressure, contraction and force as read to those that are meant.
    pub(crate) of: Box<dyn Fn([f64; 3]) -> [f64; 3]>,
}

impl Meaning {
    /// The question as a sentence of its own, about a part of the rows: the others are of the same muscle.
    pub(crate) fn asks_of_part(&self) -> String {
        let question = self.question.replace(OTHER_MUSCLE, "?");
        let mut letters = question.chars();
        let first = letters.next().map(|letter| letter.to_uppercase().to_string()).unwrap_or_default();
        first + letters.as_str()
    }
}

/// A muscle as stated, and some of the rows that count.
pub(crate) struct Trial<'a> {
    pub(crate) model: &'a Model,
    pub(crate) record: &'a Record,
    pub(crate) used: &'a [bool],
    /// Fraction of the rows that must have a state.
    pub(crate) answered: f64,
}

impl Trial<'_> {
    /// RMS error \[N\] and force of each row, with the readings as they are meant; none if too few rows have
    /// a state.
    pub(crate) fn error(&self, of: &dyn Fn([f64; 3]) -> [f64; 3]) -> Option<(f64, Vec<f64>)> {
        let moments = self.record.moments();
        let meant: Vec<[f64; 3]> = moments
            .iter()
            .zip(self.record.force())
            .map(|(m, force)| of([m.pressure, m.contraction, *force]))
            .collect();
        let used: Vec<bool> = (0..meant.len()).map(|row| self.used[row] && meant[row][0] > 0.0).collect();
        let count = |mask: &[bool]| mask.iter().filter(|counts| **counts).count() as f64;
        if count(&used) < self.answered * count(self.used) || count(&used) < 5.0 {
            return None;
        }
        let [pressure, contraction] = [0, 1].map(|i| meant.iter().map(|m| m[i]).collect::<Vec<f64>>());
        let record = self.record.clone().at(&pressure, &contraction);
        let theta = self.model.start();
        let warm = Warm::of_rows(&used);
        let force =
            self.model.evaluate_partly(&record, &theta, &Wanted::default(), &warm).ok()?.prediction.force;
        let squares: Vec<f64> = (0..meant.len())
            .filter(|row| used[*row])
            .map(|row| (meant[row][2] - force[row]).powi(2))
            .filter(|square| square.is_finite())
            .collect();
        let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
        (squares.len() as f64 >= self.answered * count(&used)).then(|| (mean.sqrt(), force))
    }
}

/// Questions about data for a muscle; `model` is the muscle as stated. Units and signs come first, then an
/// unexplained scale and sign.
pub(crate) fn questions(
    data: &Data,
    muscle: &Muscle,
    model: &Model,
    record: &Record,
    used: &[bool],
) -> Vec<Mismatch> {
    let (thin, kept) = record.thinned(ROWS);
    let counts: Vec<bool> = kept.iter().map(|row| used[*row]).collect();
    let trial = Trial { model, record: &thin, used: &counts, answered: ANSWERED };
    let (few, those) = thin.thinned(FEW_ROWS);
    let counting: Vec<bool> = those.iter().map(|row| counts[*row]).collect();
    let first = Trial { model, record: &few, used: &counting, answered: ANSWERED_OF_FEW };
    let Some((before, force)) = trial.error(&|read| read) else { return Vec::new() };
    let may_help = |meaning: &Meaning| first.error(&*meaning.of).is_some_and(|(after, _)| after <= before);
    let counted = (0..data.len()).filter(|row| used[*row]);
    let full = full_scale(data.force(), counted);
    let mut found: Vec<Mismatch> = clock::question(data, record, before).into_iter().collect();
    if before <= LARGE * full {
        return found;
    }
    let read =
        (squares(&thin, &counts) / counts.iter().filter(|counts| **counts).count().max(1) as f64).sqrt();
    // Compare errors relative to the forces as they are meant.
    let size = |meaning: &Meaning| scale_of(meaning) * read;
    let mut tried: Vec<(f64, Meaning)> = meanings(data, muscle)
        .into_iter()
        .filter(may_help)
        .filter_map(|meaning| Some((trial.error(&*meaning.of)?.0, meaning)))
        .filter(|(after, meaning)| *after <= LEFT * before.min(size(meaning)))
        .filter(|(after, meaning)| is_best(&trial, *after, meaning))
        .collect();
    tried.sort_by(|a, b| (a.0 / size(&a.1)).total_cmp(&(b.0 / size(&b.1))));
    let least = tried.first().map_or(0.0, |(after, meaning)| after / size(meaning));
    tried.retain(|(after, meaning)| *after <= ALIKE * least * size(meaning));
    if !tried.is_empty() {
        found.extend(tried.into_iter().map(|(after, meaning)| asked(before, after, full, meaning)));
        return found;
    }
    found.extend(other_length::question(data, muscle, &first, &trial, before));
    found.extend(scale(&thin, &counts, &force, before));
    found.extend(pushes(data, muscle, &thin, &kept, &counts, &force, [before, full]));
    found
}

/// Sweeps that read no force from end to end, each where the muscle as stated pulls, and their rows.
pub(crate) fn unread(
    data: &Data,
    model: &Model,
    record: &Record,
    full: f64,
) -> Option<(Mismatch, Vec<usize>)> {
    let is_silent = |row: usize| data.pressure()[row] <= 0.0 || data.force()[row].abs() <= NO_FORCE * full;
    let sweeps = data.sweeps().iter().map(|sweep| sweep.rows.clone());
    let silent: Vec<Range<usize>> = sweeps.filter(|rows| rows.clone().all(is_silent)).collect();
    let (thin, kept) = record.thinned(ROWS);
    let asked: Vec<bool> = kept.iter().map(|row| silent.iter().any(|rows| rows.contains(row))).collect();
    // A muscle that hung slack in one sweep, and has no state there, says nothing of the others.
    let trial = Trial { model, record: &thin, used: &asked, answered: 0.0 };
    let (_, force) = trial.error(&|read| read)?;
    let pulls = |rows: &Range<usize>| -> Vec<f64> {
        let under_pressure = |at: &usize| rows.contains(&kept[*at]) && data.pressure()[kept[*at]] > 0.0;
        (0..kept.len()).filter(under_pressure).map(|at| force[at]).collect()
    };
    let is_pulling = |rows: &Range<usize>| {
        let mut pulls = pulls(rows);
        let all = pulls.len() as f64;
        pulls.retain(|force| force.is_finite());
        pulls.len() as f64 >= ANSWERED * all && median(&mut pulls) > SURELY_PULLS * full
    };
    let dead: Vec<Range<usize>> = silent.into_iter().filter(is_pulling).collect();
    let pulls: Vec<f64> = dead.iter().flat_map(pulls).filter(|force| force.is_finite()).collect();
    let rows: Vec<usize> = dead.into_iter().flatten().collect();
    let most = pulls.iter().copied().reduce(f64::max)?;
    let question = Mismatch {
        kind: "no-force",
        decided: false,
        rmse_n: (pulls.iter().map(|force| force * force).sum::<f64>() / pulls.len() as f64).sqrt(),
        meant_rmse_n: None,
        says: format!(
            "line {} read no force all along, where the muscle as stated pulls with up to {} N: was the load cell connected?",
            lines(data, &rows),
            significant(most, 3)
        ),
        instead: "these rows don't count; connect it and measure them again, or remove them".to_owned(),
    };
    Some((question, rows))
}

/// Ratio of the forces as meant to the forces as read.
pub(crate) fn scale_of(meaning: &Meaning) -> f64 {
    (meaning.of)([1.0, 0.0, 1.0])[2].abs()
}

/// Sum of squares of the forces of the rows that count.
fn squares(record: &Record, used: &[bool]) -> f64 {
    record.force().iter().zip(used).filter(|(_, used)| **used).map(|(force, _)| force * force).sum()
}

/// Whether an absolute pressure fits better than other offsets do.
fn is_best(trial: &Trial<'_>, after: f64, meaning: &Meaning) -> bool {
    let is_worse = |offset: f64| {
        let other = trial.error(&|[p, c, f]| [p - offset, c, f]);
        other.is_none_or(|(error, _)| error > after)
    };
    meaning.kind != "absolute-pressure"
        || [ATMOSPHERE - OTHER_OFFSET, ATMOSPHERE + OTHER_OFFSET].into_iter().all(is_worse)
}

fn asked(before: f64, after: f64, full: f64, meaning: Meaning) -> Mismatch {
    let Meaning { kind, with, question, instead, .. } = meaning;
    Mismatch {
        kind,
        decided: kind != "absolute-pressure" || after <= LARGE * full || after <= LEFT_SURELY * before,
        rmse_n: before,
        meant_rmse_n: Some(after),
        says: format!(
            "{with} the error of the muscle as stated falls from {} N to {} N: {question}",
            significant(before, 3),
            significant(after, 3)
        ),
        instead,
    }
}

/// Pressures that count from a vacuum.
pub(crate) fn absolute() -> Meaning {
    Meaning {
            kind: "absolute-pressure",
            with: "with 1.013 bar less".to_owned(),
            question: "is the pressure absolute?".to_owned(),
            instead: "write `pressure [bar abs]` (or the unit that it has, with `abs`) in the header, or `--columns \"pressure=NAME [bar abs]\"`: the standard atmosphere is then taken off; with a barometer, subtract its reading"
                .to_owned(),
            of: Box::new(|[p, c, f]| [p - ATMOSPHERE, c, f]),
        }
}

/// All meanings that these columns may have.
pub(crate) fn meanings(data: &Data, muscle: &Muscle) -> Vec<Meaning> {
    let mut found = vec![Meaning {
        kind: "force-sign",
        with: "with the sign of the force turned over".to_owned(),
        question: "does this load cell read a pull as negative?".to_owned(),
        instead: "turn the sign of the column `force`: a pull is positive".to_owned(),
        of: Box::new(|[p, c, f]| [p, c, -f]),
    }];
    if data.pressure().iter().all(|p| *p >= LEAST_AIR) {
        found.push(absolute());
    }
    found.extend(FORCES.map(|(factor, what, heading)| Meaning {
        kind: "force-unit",
        with: format!("with forces {} times as large", significant(factor, 4)),
        question: format!("are these {what}{OTHER_MUSCLE}"),
        instead: format!("write `{heading}` in the header"),
        of: Box::new(move |[p, c, f]| [p, c, factor * f]),
    }));
    found.extend(PRESSURES.map(|(factor, what)| Meaning {
        kind: "pressure-unit",
        with: format!("with pressures {} times as large", significant(factor, 4)),
        question: format!("is this {what}{OTHER_MUSCLE}"),
        instead: "correct the unit of `pressure` in the header".to_owned(),
        of: Box::new(move |[p, c, f]| [factor * p, c, f]),
    }));
    found.extend(motions(data, muscle));
    found
}

/// Meanings of the motion column.
fn motions(data: &Data, muscle: &Muscle) -> Vec<Meaning> {
    let l0 = muscle.length().si();
    let meaning = |kind, with: &str, question: &str, instead: &str, of: fn(f64, f64) -> f64| Meaning {
        kind,
        with: with.to_owned(),
        question: question.to_owned(),
        instead: instead.to_owned(),
        of: Box::new(move |[p, c, f]| [p, of(c, l0), f]),
    };
    match data.motion() {
        Trace::Contraction(_) => vec![
            meaning(
                "contraction-unit",
                "with contractions 100 times as large",
                "are these fractions under `%`?",
                "write `contraction [-]` in the header",
                |c, _| 100.0 * c,
            ),
            meaning(
                "contraction-unit",
                "with contractions a hundredth as large",
                "is this per cent without its `%`?",
                "write `contraction [%]` in the header",
                |c, _| 0.01 * c,
            ),
            meaning(
                "contraction-unit",
                "with the sign of the contraction turned over",
                "is this an elongation?",
                "turn the sign of the column `contraction`: shortening is positive",
                |c, _| -c,
            ),
            meaning(
                "length",
                "with the contractions read as lengths in metres",
                "are these lengths?",
                "write `length [m]` in the header",
                |c, l0| 1.0 - c / l0,
            ),
            meaning(
                "length",
                "with the contractions read as lengths in millimetres",
                "are these lengths?",
                "write `length [mm]` in the header",
                |c, l0| 1.0 - 0.1 * c / l0,
            ),
        ],
        Trace::Length(_) => vec![meaning(
            "displacement",
            "with the lengths read as displacements",
            "is this how far the muscle has shortened?",
            "write the length between the fittings, or `contraction [%]`: displacement over unpressurised length",
            |c, _| 1.0 - c,
        )],
    }
}

/// The question about the motion column if its contractions are impossible as read, but possible with another
/// meaning; it is added to the refusal.
pub(crate) fn possible_motion(data: &Data, muscle: &Muscle, is_possible: &dyn Fn(f64) -> bool) -> String {
    let read = data.contraction(muscle.length().si());
    let all = |meaning: &Meaning| {
        let meant = read.iter().map(|c| (meaning.of)([1.0, *c, 1.0])[1]);
        let (mut possible, mut largest) = (true, 0.0_f64);
        for c in meant {
            possible &= is_possible(c);
            largest = largest.max(c.abs());
        }
        // Dividing by 100 makes every value possible, but a muscle moves by more than a hundredth.
        possible && largest > 0.01
    };
    let found = motions(data, muscle).into_iter().find(all);
    found.map_or_else(String::new, |meaning| {
        format!("; {} all are possible: {} {}", meaning.with, meaning.question, meaning.instead)
    })
}

/// Asks about measured and computed forces that differ by a single large factor.
fn scale(record: &Record, used: &[bool], model: &[f64], before: f64) -> Option<Mismatch> {
    let force = record.force();
    let rows = || (0..record.len()).filter(|row| used[*row] && model[*row].is_finite());
    let square: f64 = rows().map(|row| model[row] * model[row]).sum();
    let along: f64 = rows().map(|row| model[row] * force[row]).sum();
    let factor = if square > 0.0 { along / square } else { return None };
    let squares: f64 = rows().map(|row| (force[row] - factor * model[row]).powi(2)).sum();
    let after = (squares / rows().count().max(1) as f64).sqrt();
    (!(USUAL.0..=USUAL.1).contains(&factor) && factor > 0.0 && after <= LEFT * before).then(|| Mismatch {
        kind: "scale",
        decided: false,
        rmse_n: before,
        meant_rmse_n: Some(after),
        says: format!(
            "the measured forces are {} times those of the muscle as stated at all pressures and contractions (with that factor the error falls from {} N \
             to {} N), which few effects do",
            significant(factor, 3),
            significant(before, 3),
            significant(after, 3)
        ),
        instead: "check the radius of the muscle, and the units of pressure and force".to_owned(),
    })
}

/// Asks about a model that would push where the muscle pulls.
fn pushes(
    data: &Data,
    muscle: &Muscle,
    record: &Record,
    kept: &[usize],
    used: &[bool],
    model: &[f64],
    [before, full]: [f64; 2],
) -> Option<Mismatch> {
    let measured = record.force();
    let is_pushing = |row: &usize| used[*row] && model[*row] < 0.0 && measured[*row] > CLEARLY_PULLS * full;
    let rows: Vec<usize> = (0..record.len()).filter(is_pushing).collect();
    let first = *rows.first()?;
    let moment = &record.moments()[first];
    let places: Vec<usize> = rows.iter().map(|row| kept[*row]).collect();
    let most = rows.iter().map(|row| measured[*row]).fold(0.0, f64::max);
    Some(Mismatch {
        kind: "pushes",
        decided: false,
        rmse_n: before,
        meant_rmse_n: None,
        says: format!(
            "{} as stated would push at {} of {} rows (line {}; first at contraction {:.3} and {:.0} Pa: {:.0} N), where the measured muscle pulls with up to \
             {most:.0} N",
            muscle.name(),
            rows.len(),
            record.len(),
            lines(data, &places),
            moment.contraction,
            moment.pressure,
            model[first]
        ),
        instead: "check length, radius and the zero of the contraction".to_owned(),
    })
}
