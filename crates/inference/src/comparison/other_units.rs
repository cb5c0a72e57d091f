//! Detects files and sweeps whose readings are in another unit or of the other sign than those of the rest: an
//! export that was set up anew, a comma that was lost when a sweep was typed in. Nothing is learnt from such
//! rows until they are corrected, but the others are as good as before.
//!
//! A part is off if its RMS error about the muscle as stated is many times that of the others. It counts as
//! meant otherwise if the error falls to that of the others with one of the usual meanings.

use bulge_measurements::{Data, Trace};
use bulge_model::{Model, Record};
use bulge_muscles::Muscle;
use bulge_muscles::units::significant;
use std::collections::BTreeMap;

use crate::comparison::mismatch::{ANSWERED, LEAST_AIR, Meaning, Trial, absolute, meanings, scale_of};
use crate::median::median;
use crate::vector::count;

/// Rows on which meanings are tried.
const ROWS: usize = 400;
/// Fewest parts, and fewest of these rows in each. Of two, the muscle as stated says which is right.
const FEWEST: [usize; 2] = [2, 5];
/// Most parts, each of which takes an evaluation.
const MOST_PARTS: usize = 100;
/// At most this fraction of the rows may be off: the others say what is meant.
const MOST: f64 = 0.5;
/// RMS error over the (lower) median of all parts from which a part is off. With the least force that is still measured
/// well, effects of the muscle make sweeps differ by less.
const OFF: f64 = 6.0;
/// RMS error over the RMS force of the other parts from which it is.
const LARGE: f64 = 0.15;
/// Error of what is meant over the median of all parts, and over the error as read.
const ALIKE: f64 = 2.5;
const LEFT: f64 = 0.2;
/// Factors of lengths: centimetres, decimetres, metres and inches read as millimetres, and the reverse.
const LENGTHS: [(f64, &str); 7] = [
    (10.0, "centimetres read as millimetres, or a lost comma"),
    (0.1, "millimetres read as centimetres, or a lost comma"),
    (25.4, "inches read as millimetres"),
    (1.0 / 25.4, "millimetres read as inches"),
    (100.0, "a lost comma"),
    (0.01, "a lost comma"),
    (1e-3, "a lost comma"),
];
/// Factors of forces beside those of units.
const COMMAS: [f64; 4] = [0.1, 0.01, 10.0, 100.0];

/// Rows that are meant otherwise, and why.
pub(crate) fn in_other_units(
    data: &Data,
    muscle: &Muscle,
    model: &Model,
    record: &Record,
    used: &[bool],
) -> Vec<(Vec<usize>, String)> {
    let sweep = |row: usize| data.sweeps().partition_point(|sweep| sweep.rows.end <= row);
    let file = |row: usize| data.line(row).0;
    let of_file = |place: usize| data.files().get(place).map_or("", |file| file.name.as_str()).to_owned();
    let of_sweep = |place: usize| {
        data.sweeps().get(place).map_or(String::new(), |sweep| format!("sweep `{}`", sweep.name))
    };
    let by_file = Parts { data, muscle, model, record, used, of: &file, name: &of_file };
    let found = by_file.meant_otherwise();
    if !found.is_empty() {
        return found;
    }
    Parts { of: &sweep, name: &of_sweep, ..by_file }.meant_otherwise()
}

/// The rows that count, in parts.
struct Parts<'a> {
    data: &'a Data,
    muscle: &'a Muscle,
    model: &'a Model,
    record: &'a Record,
    used: &'a [bool],
    /// Part of a row.
    of: &'a dyn Fn(usize) -> usize,
    /// Name of a part.
    name: &'a dyn Fn(usize) -> String,
}

impl Parts<'_> {
    fn meant_otherwise(&self) -> Vec<(Vec<usize>, String)> {
        let (thin, kept) = self.record.thinned(ROWS);
        // The rows of each part among those that are tried.
        let mut parts: BTreeMap<usize, Vec<bool>> = BTreeMap::new();
        for (place, row) in kept.iter().enumerate().filter(|(_, row)| self.used[**row]) {
            parts.entry((self.of)(*row)).or_insert_with(|| vec![false; kept.len()])[place] = true;
            if parts.len() > MOST_PARTS {
                return Vec::new();
            }
        }
        parts.retain(|_, own| count(own) >= FEWEST[1]);
        if parts.len() < FEWEST[0] {
            return Vec::new();
        }
        // Error of a part with its readings as they are meant.
        let error = |own: &[bool], of: &dyn Fn([f64; 3]) -> [f64; 3]| {
            let trial = Trial { model: self.model, record: &thin, used: own, answered: ANSWERED };
            trial.error(of).map(|(error, _)| error)
        };
        let errors: Vec<f64> =
            parts.values().map(|own| error(own, &|read| read).unwrap_or(f64::INFINITY)).collect();
        // Of an even number the less: half of them may be off.
        let usual = median(&mut errors.iter().map(|error| -error).collect::<Vec<_>>()).abs();
        let rest = parts.values().zip(&errors).filter(|(_, error)| **error <= OFF * usual);
        let (square, rows) = rest.fold((0.0, 0), |(square, rows), (own, _)| {
            let forces = thin.force().iter().zip(own).filter(|(_, own)| **own);
            (square + forces.map(|(force, _)| force * force).sum::<f64>(), rows + count(own))
        });
        let all: usize = parts.values().map(|own| count(own)).sum();
        if !usual.is_finite() || rows == 0 || (rows as f64) < (1.0 - MOST) * all as f64 {
            return Vec::new();
        }
        let least = (OFF * usual).max(LARGE * (square / rows as f64).sqrt());
        let off = parts.iter().zip(errors).filter(|(_, error)| *error > least);
        off.filter_map(|((part, own), before)| {
            let after = |meaning: &Meaning| {
                let error = error(own, &*meaning.of)?;
                (error <= (ALIKE * usual).min(LEFT * before * scale_of(meaning).max(1.0))).then_some(error)
            };
            let tried = self.meanings(*part).into_iter();
            let tried = tried.filter_map(|meaning| Some((after(&meaning)?, meaning))).collect();
            let (after, meaning) = likeliest(tried, usual)?;
            let rows: Vec<usize> = (0..self.used.len()).filter(|row| (self.of)(*row) == *part).collect();
            let falls = if before.is_finite() {
                format!("falls from {} N to {} N", significant(before, 3), significant(after, 3))
            } else {
                format!("is {} N, and as read the muscle has no state", significant(after, 3))
            };
            let why = format!(
                "another unit or sign in {}: {} the error of the muscle as stated {falls} there. {} Correct it: until then its rows don't count",
                (self.name)(*part),
                meaning.with,
                meaning.asks_of_part(),
            );
            Some((rows, why))
        })
        .collect()
    }

    /// What a part may mean: what a whole test may, lost commas, and other lengths.
    fn meanings(&self, part: usize) -> Vec<Meaning> {
        let mut found = meanings(self.data, self.muscle);
        let pressure = self.data.pressure();
        let mut own = (0..self.used.len()).filter(|row| self.used[*row] && (self.of)(*row) == part);
        if own.all(|row| pressure[row] >= LEAST_AIR)
            && found.iter().all(|one| one.kind != "absolute-pressure")
        {
            found.push(absolute());
        }
        found.extend(COMMAS.map(|factor| Meaning {
            kind: "force-unit",
            with: format!("with forces {} times as large", significant(factor, 4)),
            question: "was a comma lost?".to_owned(),
            instead: String::new(),
            of: Box::new(move |[p, c, f]| [p, c, factor * f]),
        }));
        found.push(Meaning {
            kind: "pressure-sign",
            with: "with the sign of the pressure turned over".to_owned(),
            question: "is this sensor reversed?".to_owned(),
            instead: String::new(),
            of: Box::new(|[p, c, f]| [-p, c, f]),
        });
        let mut own = (0..self.used.len()).filter(|row| self.used[*row] && (self.of)(*row) == part);
        if own.all(|row| self.data.is_displaced(row)) {
            let turned = (-1.0, "displacements of the other sign");
            found.extend(LENGTHS.into_iter().chain([turned]).map(|(factor, what)| Meaning {
                kind: "length-unit",
                with: format!("with displacements {} times as large", significant(factor, 4)),
                question: format!("are these {what}?"),
                instead: String::new(),
                of: Box::new(move |[p, c, f]| [p, factor * c, f]),
            }));
        } else if matches!(self.data.motion(), Trace::Length(_)) {
            found.extend(LENGTHS.map(|(factor, what)| Meaning {
                kind: "length-unit",
                with: format!("with lengths {} times as large", significant(factor, 4)),
                question: format!("are these {what}?"),
                instead: String::new(),
                of: Box::new(move |[p, c, f]| [p, 1.0 - factor * (1.0 - c), f]),
            }));
        }
        found
    }
}

/// The meaning that leaves the error of the other parts, among those with nearly the least error relative to the
/// force. A tenth of the force fits as well as ten times the pressure, but leaves a tenth of the error.
fn likeliest(tried: Vec<(f64, Meaning)>, usual: f64) -> Option<(f64, Meaning)> {
    let relative = |(after, meaning): &(f64, Meaning)| after / scale_of(meaning);
    let least = tried.iter().map(relative).fold(f64::INFINITY, f64::min);
    let unlike = |(after, _): &(f64, Meaning)| (after / usual).max(f64::MIN_POSITIVE).ln().abs();
    let near = tried.into_iter().filter(|one| relative(one) <= ALIKE * least);
    near.min_by(|a, b| unlike(a).total_cmp(&unlike(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_measurements::{Columns, ReadOptions};
    use bulge_model::Wanted;
    use bulge_muscles::{Quantity, preset};

    /// Loops of 40 rows between 2 and 14 % at 1 to 5 bar, one sweep each, in pascals, metres and newtons, with the
    /// friction of a few per cent of the force that the model lacks.
    fn loops(muscle: &Muscle) -> Columns {
        let length = muscle.length().si();
        let (mut pressure, mut lengths, mut direction) = (Vec::new(), Vec::new(), Vec::new());
        for level in 1..=5 {
            for row in 0..40 {
                let part = f64::from(row) / 20.0;
                pressure.push(1e5 * f64::from(level));
                lengths.push(length * (0.98 - 0.12 * (1.0 - (part - 1.0).abs())));
                direction.push(if row < 20 { -1.0 } else { 1.0 });
            }
        }
        let mut columns = Columns::new(pressure, Trace::Length(lengths), vec![0.0; 200]);
        columns.sweep = Some((0..200).map(|row| (1 + row / 40).to_string()).collect());
        let record = Record::new(&Data::from_columns(columns.clone()).unwrap(), length);
        let exact = Model::new(muscle).evaluate(&record, &[], &Wanted::default()).unwrap().force;
        columns.force_n =
            exact.iter().zip(direction).map(|(force, way)| force * (1.0 + 0.02 * way)).collect();
        columns
    }

    fn found(muscle: &Muscle, columns: Columns) -> Vec<(Vec<usize>, String)> {
        let data = Data::from_columns(columns).unwrap();
        let record = Record::new(&data, muscle.length().si());
        let used: Vec<bool> = data.pressure().iter().map(|pressure| *pressure > 0.0).collect();
        in_other_units(&data, muscle, &Model::new(muscle), &record, &used)
    }

    #[test]
    fn a_sweep_in_another_unit_is_found_and_what_it_is() {
        let muscle = preset("ppam-2-r16").unwrap();
        let whole = loops(&muscle);
        assert_eq!(found(&muscle, whole.clone()), []);
        let own = 80..120;
        let meant = |spoil: &dyn Fn(&mut Columns), says: &str| {
            let mut columns = whole.clone();
            spoil(&mut columns);
            let found = found(&muscle, columns);
            let [(rows, why)] = &found[..] else { panic!("{says}: {found:?}") };
            assert_eq!(*rows, own.clone().collect::<Vec<_>>(), "{says}");
            assert!(why.contains(says) && why.contains("sweep `3`"), "{says}: {why}");
        };
        let times = |values: &mut Vec<f64>, factor: f64| {
            values[own.clone()].iter_mut().for_each(|value| *value *= factor);
        };
        meant(&|columns| times(&mut columns.pressure_pa, 14.503_77), "psi read as bar");
        meant(&|columns| times(&mut columns.pressure_pa, 0.1), "10.00 times as large");
        meant(&|columns| times(&mut columns.force_n, 1.0 / 4.448_222), "pounds");
        meant(&|columns| times(&mut columns.force_n, 100.0), "0.01000 times as large");
        meant(&|columns| times(&mut columns.force_n, -1.0), "Does this load cell read a pull as negative?");
        meant(
            &|columns| columns.pressure_pa[own.clone()].iter_mut().for_each(|p| *p += 101_325.0),
            "absolute",
        );
        meant(
            &|columns| {
                let Trace::Length(lengths) = &mut columns.motion else { unreachable!() };
                times(lengths, 1.0 / 25.4);
            },
            "inches",
        );
        // Of two sweeps the muscle as stated says which is right.
        let mut columns = whole.clone();
        let Trace::Length(lengths) = &mut columns.motion else { unreachable!() };
        lengths.truncate(80);
        columns.pressure_pa.truncate(80);
        columns.force_n.truncate(80);
        columns.sweep = Some((0..80).map(|row| (1 + row / 40).to_string()).collect());
        assert_eq!(found(&muscle, columns.clone()), []);
        columns.pressure_pa[..40].iter_mut().for_each(|pressure| *pressure *= 10.0);
        let of_two = found(&muscle, columns);
        let [(rows, why)] = &of_two[..] else { panic!("{of_two:?}") };
        assert!(*rows == (0..40).collect::<Vec<_>>() && why.contains("0.1000 times as large"), "{why}");
        // All of it in another unit is no part, and neither is half of it.
        let mut columns = whole.clone();
        columns.force_n.iter_mut().for_each(|force| *force *= 100.0);
        assert_eq!(found(&muscle, columns), []);
        let mut columns = whole.clone();
        columns.force_n[..120].iter_mut().for_each(|force| *force *= 100.0);
        assert_eq!(found(&muscle, columns), []);
    }

    #[test]
    fn displacements_of_a_sweep_in_another_unit_or_of_the_other_sign() {
        let muscle = preset("ppam-2-r16").unwrap();
        let (columns, length) = (loops(&muscle), muscle.length().si());
        for (factor, says) in [
            (1.0, None),
            (0.1, Some("10.00 times")),
            (1.0 / 25.4, Some("inches")),
            (-1.0, Some("of the other sign")),
        ] {
            let row = |row: usize| {
                let factor = if (40..80).contains(&row) { factor } else { 1.0 };
                let way = 1e3 * (length - columns.motion.values()[row]) * factor;
                format!("{},{way},{},{}\n", columns.pressure_pa[row], columns.force_n[row], row / 40)
            };
            let rows: String = (0..200).map(row).collect();
            let text = format!("pressure [Pa],shortening [mm],force [N],sweep\n{rows}");
            let options = ReadOptions { l0_m: Some(length), ..ReadOptions::default() };
            let data = Data::from_bytes(text.as_bytes(), "d.csv", &options).unwrap();
            let record = Record::new(&data, length);
            let found = in_other_units(&data, &muscle, &Model::new(&muscle), &record, &[true; 200]);
            let rows: Vec<Vec<usize>> = found.iter().map(|(rows, _)| rows.clone()).collect();
            let expected: Vec<Vec<usize>> = says.iter().map(|_| (40..80).collect()).collect();
            assert_eq!(rows, expected, "{found:?}");
            assert!(found.iter().zip(says).all(|((_, why), says)| why.contains(says)), "{found:?}");
        }
    }

    #[test]
    fn what_no_unit_explains_stays() {
        let muscle = preset("ppam-2-r16").unwrap();
        let mut columns = loops(&muscle);
        // A slack cable: no factor, no sign and no offset.
        for (row, force) in columns.force_n[80..120].iter_mut().enumerate() {
            *force *= if row % 2 == 0 { 3.0 } else { 0.2 };
        }
        assert_eq!(found(&muscle, columns), []);
    }
}
