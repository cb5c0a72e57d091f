//! Smooth functions of everything that was recorded: possible shapes of an unknown misfit.
//!
//! ```text
//! T_i(eps) T_j(p) x {1, direction};    distance since the last reversal x direction;
//! time in the sweep, clock, rate, pressure rate, temperature, cycle, specimen
//! ```
//! with T_i the Chebyshev polynomials over the range of the record, in the order of their roughness.

use bulge_model::Record;

use crate::chebyshev::chebyshev;
use crate::diagnosis::setpoints::setpoints;
use crate::vector::range;

/// Highest degree in the contraction.
const CONTRACTION: usize = 12;
/// Highest degree in the pressure, if the length is driven and if the pressure is.
const PRESSURE: [usize; 2] = [4, 8];
/// Highest degrees in contraction and pressure of functions that change sign with the direction, for the same
/// two cases.
const BY_DIRECTION: [[usize; 2]; 2] = [[5, 2], [5, 5]];
/// Weight of a degree in the pressure relative to one in the contraction.
const PRESSURE_WEIGHT: f64 = 1.5;
/// Lengths of transitions after a reversal, as fractions of the range of the contraction.
const REVERSALS: [f64; 2] = [0.03, 0.12];
/// Highest degree in the clock.
const CLOCK: usize = 5;

/// Most periods of a wave over the clock.
const TURNS: usize = 10;

/// Variable that a function depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Variable {
    /// None: the function is constant. If the contraction varies, the constant counts as its degree 0.
    Mean,
    Contraction,
    Pressure,
    Direction,
    Time,
    Rate,
    Temperature,
    Cycle,
    Specimen,
}

impl Variable {
    /// All variables, each with its name in results and with how a misfit behaves that depends on it.
    pub(crate) const ALL: [(Self, &str, &str); 9] = [
        (Self::Mean, "mean", "is alike in all rows"),
        (Self::Contraction, "contraction", "changes along the contraction, alike at all pressures"),
        (Self::Pressure, "pressure", "changes with the pressure"),
        (Self::Direction, "direction", "flips sign with the direction"),
        (Self::Time, "time", "changes with time"),
        (Self::Rate, "rate", "changes with the speed"),
        (Self::Temperature, "temperature", "changes with the temperature"),
        (Self::Cycle, "cycle", "changes from cycle to cycle"),
        (Self::Specimen, "specimen", "differs from specimen to specimen"),
    ];
}

/// One function, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Smooth {
    pub(crate) variable: Variable,
    /// Order of the functions: the smoothest come first.
    roughness: f64,
    pub(crate) values: Vec<f64>,
}

/// The functions for a record, the smoothest first.
///
/// At pressure levels, the mean of the level is used.
pub(crate) fn smooth(record: &Record) -> Vec<Smooth> {
    let record = &setpoints(record);
    let mut functions = map(record);
    if record.moments().iter().any(|m| m.branch() != 0.0) {
        functions.extend(by_direction(record));
    }
    functions.extend(in_time(record));
    functions.extend(others(record));
    functions.retain(|f| f.values.iter().all(|v| v.is_finite()));
    functions.sort_by(|a, b| a.roughness.total_cmp(&b.roughness));
    functions
}

fn map(record: &Record) -> Vec<Smooth> {
    let (x, y) = (scaled(record, |m| m.contraction), scaled(record, |m| m.pressure));
    let most = PRESSURE[usize::from(drives_pressure(record))].min(different(&y) - 1);
    let mut functions = Vec::new();
    let lengths = different(&x);
    for i in 0..=CONTRACTION.min(lengths - 1) {
        for j in 0..=most {
            let roughness = i as f64 + PRESSURE_WEIGHT * j as f64;
            if roughness > CONTRACTION as f64 {
                continue;
            }
            let values = x.iter().zip(&y).map(|(x, y)| chebyshev(i, *x) * chebyshev(j, *y)).collect();
            let variable = match j {
                0 if lengths == 1 => Variable::Mean,
                0 => Variable::Contraction,
                _ => Variable::Pressure,
            };
            functions.push(Smooth { variable, roughness, values });
        }
    }
    functions
}

fn by_direction(record: &Record) -> Vec<Smooth> {
    let (x, y) = (scaled(record, |m| m.contraction), scaled(record, |m| m.pressure));
    let moments = record.moments();
    let levels = different(&y) - 1;
    let most = BY_DIRECTION[usize::from(drives_pressure(record))];
    let mut functions = Vec::new();
    for i in 0..=most[0] {
        for j in 0..=most[1].min(levels) {
            let value = |row: usize| moments[row].branch() * chebyshev(i, x[row]) * chebyshev(j, y[row]);
            functions.push(Smooth {
                variable: Variable::Direction,
                roughness: 1.0 + i as f64 + PRESSURE_WEIGHT * j as f64,
                values: (0..record.len()).map(value).collect(),
            });
        }
    }
    let [since, ..] = ways_to_reversals(record);
    for (number, length) in REVERSALS.iter().enumerate() {
        let value = |row: usize| moments[row].branch() * (-since[row] / length).exp();
        functions.push(Smooth {
            variable: Variable::Direction,
            roughness: 3.0 + number as f64,
            values: (0..record.len()).map(value).collect(),
        });
    }
    functions
}

/// Whether the pressure rises and falls within sweeps.
pub(crate) fn drives_pressure(record: &Record) -> bool {
    record.moments().iter().any(|m| m.pressure_step != 0.0)
}

/// Distance since the last reversal, to the next one, and since the beginning of the sweep before its first
/// reversal, as fractions of the range of the contraction, or of the pressure if the length is held; large
/// elsewhere.
pub(crate) fn ways_to_reversals(record: &Record) -> [Vec<f64>; 3] {
    let moments = record.moments();
    let [low, high] = range(moments.iter().map(|m| m.contraction));
    let whole = (high - low).max(f64::MIN_POSITIVE);
    let [low, high] = range(moments.iter().map(|m| m.pressure));
    let whole_pressure = (high - low).max(f64::MIN_POSITIVE);
    let step = |row: usize| {
        let moment = &moments[row];
        if moment.direction == 0.0 && moment.pressure_direction != 0.0 {
            moment.pressure_step.abs() / whole_pressure
        } else {
            moment.step.abs() / whole
        }
    };
    let mut since = Vec::with_capacity(moments.len());
    let mut begun = Vec::with_capacity(moments.len());
    let (mut way, mut direction, mut first) = (1.0, 0.0, 0.0);
    for (row, moment) in moments.iter().enumerate() {
        // A sweep begins as if its last reversal were a whole range away.
        if moment.begins {
            (way, direction, first) = (1.0, moment.branch(), 0.0);
        } else {
            first += step(row);
        }
        way += step(row);
        if moment.branch() * direction < 0.0 {
            (way, first) = (0.0, f64::INFINITY);
        }
        if moment.branch() != 0.0 {
            direction = moment.branch();
        }
        since.push(way);
        begun.push(first);
    }
    let mut next = vec![0.0; moments.len()];
    let (mut way, mut direction) = (1.0, 0.0);
    // The distance to the next reversal, found in the same way backwards.
    for row in (0..moments.len()).rev() {
        let branch = moments[row].branch();
        if branch * direction < 0.0 {
            way = 0.0;
        }
        if branch != 0.0 {
            direction = branch;
        }
        next[row] = way;
        way += step(row);
        if moments[row].begins {
            (way, direction) = (1.0, 0.0);
        }
    }
    [since, next, begun]
}

fn in_time(record: &Record) -> Vec<Smooth> {
    if !record.has_time() {
        return Vec::new();
    }
    let mut functions = Vec::new();
    let mut add = |variable, roughness, values: Vec<f64>| {
        if different(&values) > 1 {
            functions.push(Smooth { variable, roughness, values });
        }
    };
    let clock = scaled(record, |m| m.clock);
    for turns in 1..=TURNS {
        let wave = |shift: f64| {
            clock.iter().map(|c| (std::f64::consts::PI * (c * turns as f64 + shift)).cos()).collect()
        };
        add(Variable::Time, 4.0 + turns as f64, wave(0.0));
        add(Variable::Time, 4.0 + turns as f64, wave(0.5));
    }
    for i in 1..=CLOCK {
        add(Variable::Time, 1.0 + i as f64, clock.iter().map(|c| chebyshev(i, *c)).collect());
    }
    let longest = record.moments().iter().map(|m| m.time).fold(0.0_f64, f64::max).max(f64::MIN_POSITIVE);
    let of_time = |f: &dyn Fn(f64) -> f64| record.moments().iter().map(|m| f(m.time)).collect::<Vec<_>>();
    let logarithm = of_time(&|t| (1.0 + 100.0 * t / longest).ln());
    let x = scaled(record, |m| m.contraction);
    let y = scaled(record, |m| m.pressure);
    add(Variable::Time, 3.0, logarithm.clone());
    add(Variable::Time, 4.0, of_time(&|t| t / longest));
    add(Variable::Time, 5.0, product(&logarithm, &y));
    add(Variable::Time, 6.0, product(&clock, &x));
    add(Variable::Time, 6.5, product(&clock, &y));
    let fastest =
        record.moments().iter().map(|m| m.rate.abs()).fold(0.0_f64, f64::max).max(f64::MIN_POSITIVE);
    let rate: Vec<f64> = record.moments().iter().map(|m| m.rate / fastest).collect();
    add(Variable::Rate, 1.5, rate.clone());
    add(Variable::Rate, 2.5, product(&rate, &y));
    add(Variable::Rate, 3.5, product(&rate, &x));
    add(Variable::Rate, 4.5, rate.iter().map(|r| r * r).collect());
    add(Variable::Rate, 5.5, rate.iter().map(|r| r * r.abs()).collect());
    let quickest = record.moments().iter().map(|m| m.pressure_rate.abs()).fold(0.0_f64, f64::max);
    if quickest > 0.0 {
        add(Variable::Rate, 4.0, record.moments().iter().map(|m| m.pressure_rate / quickest).collect());
    }
    functions
}

fn others(record: &Record) -> Vec<Smooth> {
    let mut functions = Vec::new();
    let (x, y) = (scaled(record, |m| m.contraction), scaled(record, |m| m.pressure));
    let mut add = |variable, roughness, values: Vec<f64>| {
        if different(&values) > 1 {
            functions.push(Smooth { variable, roughness, values });
        }
    };
    let warmth = scaled(record, |m| m.temperature);
    if record.moments().iter().any(|m| m.temperature != 0.0) {
        add(Variable::Temperature, 1.5, warmth.clone());
        add(Variable::Temperature, 2.5, product(&warmth, &y));
        add(Variable::Temperature, 3.0, product(&warmth, &x));
        add(Variable::Temperature, 4.0, warmth.iter().map(|t| t * t).collect());
        add(Variable::Temperature, 5.0, product(&product(&warmth, &x), &y));
    }
    if record.moments().iter().any(|m| m.cycle >= 1.0) {
        let dying =
            |cycles: f64| record.moments().iter().map(|m| (-m.cycle / cycles).exp()).collect::<Vec<_>>();
        add(Variable::Cycle, 2.0, dying(1.5));
        add(Variable::Cycle, 3.0, record.moments().iter().map(|m| m.cycle).collect());
        add(Variable::Cycle, 4.0, product(&dying(1.5), &x));
        add(Variable::Cycle, 4.5, product(&dying(1.5), &y));
    }
    for specimen in 1..record.specimens().len() {
        let is_it: Vec<f64> =
            record.moments().iter().map(|m| f64::from(u8::from(m.specimen as usize == specimen))).collect();
        add(Variable::Specimen, 1.5, is_it.clone());
        add(Variable::Specimen, 2.5, product(&is_it, &x));
        add(Variable::Specimen, 3.0, product(&is_it, &y));
    }
    functions
}

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

/// A quantity scaled to -1 ..= 1.
pub(crate) fn scaled(record: &Record, of: impl Fn(&bulge_effects::Moment) -> f64) -> Vec<f64> {
    over_range(&record.moments().iter().map(of).collect::<Vec<_>>())
}

pub(crate) fn over_range(values: &[f64]) -> Vec<f64> {
    let [low, high] = range(values.iter().copied());
    let half = (0.5 * (high - low)).max(f64::MIN_POSITIVE);
    values.iter().map(|v| if high > low { (v - low) / half - 1.0 } else { 0.0 }).collect()
}

/// Number of clearly different values, at most 12.
fn different(values: &[f64]) -> usize {
    let [low, high] = range(values.iter().copied());
    if high <= low {
        return 1;
    }
    let mut seen = [false; 12];
    for value in values {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 11")]
        let bin = (11.999 * (value - low) / (high - low)) as usize;
        seen[bin.min(11)] = true;
    }
    seen.iter().filter(|s| **s).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Moment;

    #[test]
    fn a_map_of_three_pressures_has_no_cubic_in_pressure() {
        let moments: Vec<Moment> =
            (0..60).map(|i| Moment::at_rest(1e5 * f64::from(1 + i / 20), 0.01 * f64::from(i % 20))).collect();
        let record = Record::from_moments(moments, vec![0.0; 60], std::iter::once(0..60).collect()).unwrap();
        let found = smooth(&record);
        assert!(found.iter().all(|f| f.variable <= Variable::Pressure));
        // Degrees i <= 11 (12 contractions are distinguished) and i + 1.5 j <= 12 with j <= 2: 12 + 11 + 10.
        assert_eq!(found.len(), 33);
        assert!(found[0].values.iter().all(|v| (*v - 1.0).abs() < 1e-15));
    }

    #[test]
    fn ways_are_counted_from_and_to_reversals() {
        let at = |i: usize| {
            let place = [0.0, 1.0, 2.0, 3.0, 4.0, 3.0, 2.0, 1.0][i % 8];
            let direction = if i % 8 < 5 { 1.0 } else { -1.0 };
            let step = if i.is_multiple_of(8) { 0.0 } else { direction * 0.01 };
            Moment { direction, step, begins: i.is_multiple_of(8), ..Moment::at_rest(2e5, 0.01 * place) }
        };
        let moments: Vec<Moment> = (0..16).map(at).collect();
        let record = Record::from_moments(moments, vec![0.0; 16], vec![0..8, 8..16]).unwrap();
        let [since, next, begun] = ways_to_reversals(&record);
        // The stroke is 0.04. At row 5 it has turned: the way is that since the turn.
        for sweep in [0, 8] {
            let at_turns = [since[sweep + 5], next[sweep + 4], begun[sweep]];
            assert!(at_turns.iter().all(|way| way.abs() < 1e-15), "{at_turns:?}");
            for i in 0..3 {
                let way = 0.25 * i as f64;
                assert!((since[sweep + 5 + i] - way).abs() < 1e-12, "{since:?}");
                assert!((next[sweep + 4 - i] - way).abs() < 1e-12, "{next:?}");
                assert!((begun[sweep + i] - way).abs() < 1e-12, "{begun:?}");
            }
            assert!(since[sweep..sweep + 5].iter().chain(&next[sweep + 5..sweep + 8]).all(|way| *way >= 1.0));
            assert!(begun[sweep + 5..sweep + 8].iter().all(|way| way.is_infinite()));
        }
    }

    #[test]
    fn at_a_single_length_nothing_depends_on_the_contraction() {
        let moments: Vec<Moment> = (0..30).map(|i| Moment::at_rest(1e5 + 1e4 * f64::from(i), 0.02)).collect();
        let record = Record::from_moments(moments, vec![0.0; 30], std::iter::once(0..30).collect()).unwrap();
        let variables: Vec<Variable> = smooth(&record).iter().map(|f| f.variable).collect();
        assert_eq!(variables[0], Variable::Mean);
        assert!(variables[1..].iter().all(|v| *v == Variable::Pressure) && variables.len() > 4);
    }

    #[test]
    fn what_does_not_vary_is_not_there() {
        let moments: Vec<Moment> = (0..30)
            .map(|i| Moment {
                direction: 1.0,
                clock: f64::from(i),
                time: f64::from(i),
                ..Moment::at_rest(2e5, 0.01 * f64::from(i))
            })
            .collect();
        let record = Record::from_moments(moments, vec![0.0; 30], std::iter::once(0..30).collect()).unwrap();
        let variables: Vec<Variable> = smooth(&record).iter().map(|f| f.variable).collect();
        for absent in [Variable::Pressure, Variable::Temperature, Variable::Cycle, Variable::Specimen] {
            assert!(!variables.contains(&absent), "{absent:?}");
        }
        assert!(variables.contains(&Variable::Time) && variables.contains(&Variable::Direction));
    }
}
