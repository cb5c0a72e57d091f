//! Requirements on data for a comparison with a muscle and its effects.

use bulge_effects::{Effect, Needs};
use bulge_measurements::{Data, Sweep};
use bulge_model::Record;
use bulge_muscles::units::significant;
use bulge_muscles::{Construction, Muscle, Quantity, memory};
use std::ops::RangeInclusive;
use std::sync::Arc;

use crate::comparison::mismatch::possible_motion;
use crate::comparison::rows::{Used, lines};
use crate::error::InferenceError;

/// No muscle shortens by more: a pleated one ends at 54.3 %, and a braid at less.
const SHORTEST: f64 = 0.6;

/// Fraction of the rest length by which fibres that are soft and a wrong zero lengthen a muscle beyond straight fibres.
const STRETCH: f64 = 0.1;

/// Fraction of the rows that may have others: a lost comma, one file in another unit.
const FEW: f64 = 0.25;
/// The same of sweeps whose displacements have the other sign. A wrong length of the muscle makes no lengthening impossible
/// unless it is much too short, and with a wrong zero some sweep passes through it, or lies just beyond.
const TURNED: f64 = 0.49;
/// Lengthening of the other rows, at most: the zero of a displacement is off by less.
const ZERO: f64 = 0.02;

/// Bytes that a row takes beside its columns. Measured on 10^6 rows in time: 240 in a comparison, with and
/// without effects, while the record is made from the motion; 410 in a diagnosis.
pub(crate) const COMPARED: u64 = 280;
pub(crate) const DIAGNOSED: u64 = 460;

/// Refuses rows that don't fit into the memory: an allocation that fails would end the process.
pub(crate) fn check_memory(data: &Data, bytes_per_row: u64) -> Result<(), InferenceError> {
    memory::check(data.len() as u64 * bytes_per_row).map_err(|shortage| {
        let files: Vec<&str> = data.files().iter().map(|file| file.name.as_str()).collect();
        InferenceError::Memory { files: files.join(", "), rows: data.len(), shortage }
    })
}

/// Contractions that no muscle can have, if few rows have them, and why they don't count; or all rows of sweeps whose
/// displacements have the other sign.
pub(crate) fn of_no_muscle(
    data: &Data,
    muscle: &Muscle,
    record: &Record,
    used: &Used,
) -> Option<(Vec<usize>, String)> {
    let possible = possible(muscle);
    let contraction = |row: &usize| record.moments()[*row].contraction;
    let is_other = |row: &usize| !possible.contains(&contraction(row));
    let rows: Vec<usize> = used.rows().filter(is_other).collect();
    let first = contraction(rows.first()?);
    let is_turned = |row: &usize| {
        let turned = -contraction(row);
        data.is_displaced(*row) && turned >= -ZERO && possible.contains(&turned)
    };
    let of_sweep = |sweep: &Sweep| sweep.rows.clone().filter(|row| used.mask[*row]).collect::<Vec<usize>>();
    let sweeps = data.sweeps().iter().map(of_sweep);
    let turned: Vec<usize> =
        sweeps.filter(|sweep| sweep.iter().any(is_other) && sweep.iter().all(is_turned)).flatten().collect();
    let part = |rows: &[usize]| rows.len() as f64 / used.rows().count() as f64;
    let is_in = |row: &usize| turned.binary_search(row).is_ok();
    let are_others_right = || used.rows().filter(|row| !is_in(row)).all(|row| contraction(&row) > -ZERO);
    let (rows, check) = if rows.iter().all(is_in) && part(&turned) <= TURNED && are_others_right() {
        (turned, "see whether the sign of the displacement was turned there")
    } else if part(&rows) <= FEW {
        (rows, "check the unit and the digits there")
    } else {
        return None;
    };
    let why = format!(
        "an impossible length: no muscle of {} mm has a contraction of {} %; {check}",
        significant(1e3 * muscle.length().si(), 4),
        significant(100.0 * first, 3),
    );
    Some((rows, why))
}

/// Contractions that a muscle can have: with straight fibres it doesn't lengthen but for their stretch.
fn possible(muscle: &Muscle) -> RangeInclusive<f64> {
    let straight = match muscle.construction() {
        Construction::Braided(braided) => braided.fibre_length(muscle.length()).si() / muscle.length().si(),
        Construction::Pleated(_) => 1.0,
    };
    1.0 - straight - STRETCH..=SHORTEST
}

/// Refuses contractions that no muscle can have: the data are those of another one.
pub(crate) fn check_size(
    data: &Data,
    muscle: &Muscle,
    record: &Record,
    mask: &[bool],
) -> Result<(), InferenceError> {
    let possible = possible(muscle);
    let is_possible = |contraction: f64| possible.contains(&contraction);
    let moments = record.moments();
    let rows: Vec<usize> =
        (0..record.len()).filter(|row| mask[*row] && !is_possible(moments[*row].contraction)).collect();
    let Some(&row) = rows.first() else { return Ok(()) };
    let specimen = record.specimens().get(record.moments()[row].specimen as usize);
    let own = specimen.and_then(|name| Some((name, muscle.of_specimen(name).ok()?)));
    let own = own.filter(|(name, _)| muscle.specimens().iter().any(|stated| stated.name() == *name));
    let (name, length) = own.map_or_else(
        || (muscle.name().to_owned(), muscle.length()),
        |(name, own)| (format!("the specimen `{name}` of {}", muscle.name()), own.length()),
    );
    Err(InferenceError::OtherSize {
        muscle: name,
        lines: format!("line {}", lines(data, &rows)),
        contraction: record.moments()[row].contraction,
        length_m: length.si(),
        meant: possible_motion(data, muscle, &is_possible),
    })
}

/// Refuses an effect that needs something these data don't have.
pub(crate) fn check_needs(effect: &Arc<dyn Effect>, record: &Record) -> Result<(), InferenceError> {
    let card = effect.card();
    let moments = record.moments();
    let has = match card.needs {
        Needs::Nothing => true,
        Needs::Path => moments.iter().any(|m| m.direction != 0.0),
        Needs::Motion => moments.iter().any(|m| m.branch() != 0.0),
        Needs::PressurePath => record.has_time() && moments.iter().any(|m| m.pressure_direction != 0.0),
        Needs::Time => record.has_time(),
        Needs::Cycles => moments.iter().any(|m| m.cycle >= 1.0),
        Needs::Temperature => moments.iter().any(|m| m.temperature != 0.0),
        Needs::Specimens => record.specimens().len() > 1,
    };
    if has {
        return Ok(());
    }
    Err(InferenceError::Needs { effect: card.name.to_owned(), needs: lacking(card.needs, record) })
}

/// The unmet needs of an effect, in words.
fn lacking(needs: Needs, record: &Record) -> &'static str {
    match needs {
        Needs::Path | Needs::Motion if !record.is_path() => {
            "a path: rows in an order, by a column `sweep` or `time`"
        }
        Needs::Path => "a path: the length in both directions",
        Needs::Motion => "a path: the length or the pressure in both directions",
        _ => needs.says(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_muscles::preset;

    /// Straight fibres of 25 deg: 1/cos(25 deg) = 1.103378; those of a pleated muscle are straight at rest.
    #[test]
    fn a_muscle_is_no_longer_than_its_fibres_and_a_tenth() {
        for (name, longest) in [("dmsp-20-250", -0.203_378), ("ppam-2-r16", -0.1)] {
            let possible = possible(&preset(name).unwrap());
            assert!((possible.start() - longest).abs() < 1e-6, "{name}: {possible:?}");
            assert!(possible.contains(&0.543) && !possible.contains(&0.61));
        }
    }
}
