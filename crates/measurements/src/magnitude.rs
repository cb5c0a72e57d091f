//! Units that no heading states, inferred from the size of the readings if exactly one is possible and all
//! others are far off.

use crate::error::MeasurementError;
use crate::heading::Field;
use crate::reading::{ReadOptions, Reading};
use crate::slot::Slot;
use crate::table::place_of;
use crate::unit::unit;
use bulge_muscles::units::significant;

/// Candidate units of pressure and length. Others (hPa, atm, kgf/cm^2, um) nearly equal one of these or are
/// never left out.
const PRESSURES: [&str; 6] = ["Pa", "mbar", "kPa", "psi", "bar", "MPa"];
const LENGTHS: [&str; 4] = ["mm", "cm", "m", "in"];
/// Range of a muscle's length in a test over its unpressurised length. The ratio of the ends is below that of
/// any two units of length (an inch is 2.54 cm), so at most one unit fits.
const OF_LENGTH: [f64; 2] = [0.55, 1.25];
/// Range of the largest displacement over the unpressurised length: smaller ones are not tested, larger ones
/// are impossible.
const OF_DISPLACEMENT: [f64; 2] = [0.005, 0.6];
/// Range of the largest gauge pressure in tests with air \[Pa\].
const OF_PRESSURE: [f64; 2] = [0.05e5, 15e5];
/// Units of force that may be left out, in newtons.
const FORCES: [(&str, f64); 4] = [("N", 1.0), ("lbf", 4.448_222), ("kgf", 9.806_65), ("kN", 1e3)];
/// Ratio of measured and computed forces, either way. Gains, rubber, friction and end effects stay below the
/// first value. A unit is accepted if all others are beyond the second: the nearest two, kPa and psi, differ
/// by a factor of 6.9.
const ALIKE: f64 = 2.5;
const OTHER: f64 = 4.0;
/// Rows count if their computed force is above this fraction of the largest.
const LARGE: f64 = 0.1;
/// At either end, one reading in this many may be an outlier.
const ODD: usize = 100;
/// A larger contraction can't be a fraction of the length.
const WHOLE: f64 = 1.0;

/// A possible unit of a column.
struct Possible {
    symbol: &'static str,
    why: String,
    /// The unit of the forces in that case, if it isn't the newton.
    force: Option<&'static str>,
}

impl Possible {
    fn new(symbol: &'static str, why: String) -> Self {
        Self { symbol, why, force: None }
    }
}

/// Sets the units of columns without one from their readings, and reports them; `is_good` marks the rows that
/// count.
pub(crate) fn settle(
    file: &str,
    slots: &mut [Slot],
    is_good: &[bool],
    options: &ReadOptions,
    reading: &mut Reading,
) -> Result<(), MeasurementError> {
    let rows: Vec<usize> = (0..is_good.len()).filter(|row| is_good[*row]).collect();
    let mut open = Vec::new();
    // The motion first, because the pressure is inferred with it.
    let motion_first = |place: &usize| slots[*place].heading.field == Field::Pressure;
    let mut places: Vec<usize> =
        (0..slots.len()).filter(|place| slots[*place].heading.open_unit.is_some()).collect();
    places.sort_by_key(motion_first);
    for place in places {
        let (field, inside) = (slots[place].heading.field, slots[place].units_inside);
        if inside > 0 && inside >= rows.len() {
            say(reading, &slots[place], None, "units stand in its fields");
            continue;
        }
        let possible = match field {
            _ if inside > 0 => Vec::new(),
            Field::Contraction => per_cent(&values(slots, field, &rows)),
            Field::Length | Field::Displacement => lengths(&values(slots, field, &rows), field, options.l0_m),
            Field::Force => continue,
            Field::Pressure if open.is_empty() => pressures(slots, &rows, options),
            Field::Pressure => by_size(&values(slots, field, &rows)),
            _ => Vec::new(),
        };
        match possible.as_slice() {
            [Possible { symbol, why, .. }] => {
                let Some(found) = unit(field, symbol) else { continue };
                slots[place].become_column(field, |value| found.scale.si(value));
                say(reading, &slots[place], Some(symbol), &format!("no unit is written: {why}"));
            }
            // The readings are fractions, as they should be.
            [] if field == Field::Contraction => {}
            _ => open.push((place, possible)),
        }
    }
    if open.is_empty() { Ok(()) } else { Err(refused(file, slots, &rows, &open)) }
}

/// The numbers of a column in the rows that count.
fn values(slots: &[Slot], field: Field, rows: &[usize]) -> Vec<f64> {
    let all = place_of(slots, field).map_or(&[][..], |place| slots[place].numbers());
    rows.iter().filter_map(|row| all.get(*row).copied()).collect()
}

/// The smallest and the largest value without outliers.
fn range(values: &[f64]) -> [f64; 2] {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let odd = sorted.len() / ODD;
    let at = |place: usize| sorted.get(place).copied().unwrap_or(0.0);
    [at(odd), at(sorted.len().saturating_sub(1 + odd))]
}

/// Per cent, if the values aren't fractions.
fn per_cent(values: &[f64]) -> Vec<Possible> {
    let [_, high] = range(values);
    let why = format!("{} is no fraction", significant(high, 3));
    if high > WHOLE { vec![Possible::new("%", why)] } else { Vec::new() }
}

/// Units in which the values are possible lengths, or displacements, of a muscle.
fn lengths(values: &[f64], field: Field, l0: Option<f64>) -> Vec<Possible> {
    let Some(l0) = l0.filter(|l0| l0.is_finite() && *l0 > 0.0) else { return Vec::new() };
    let [low, high] = range(values);
    let among = |[least, most]: [f64; 2], [low, high]: [f64; 2], what: &str| -> Vec<Possible> {
        let found = LENGTHS.into_iter().filter_map(|symbol| {
            let factor = unit(field, symbol)?.scale.si(1.0);
            let why = format!("{what} {} % of the muscle", significant(100.0 * factor * high / l0, 2));
            (least * l0 <= factor * low && factor * high <= most * l0).then(|| Possible::new(symbol, why))
        });
        found.collect()
    };
    let whole = among(OF_LENGTH, [low, high], "up to");
    if field == Field::Length || !whole.is_empty() {
        return whole;
    }
    let largest = high.abs().max(low.abs());
    among(OF_DISPLACEMENT, [largest, largest], "a displacement of")
}

/// Units in which the values are pressures of a test with air.
fn by_size(values: &[f64]) -> Vec<Possible> {
    let [_, largest] = range(values);
    let found = PRESSURES.into_iter().filter_map(|symbol| {
        let pascals = unit(Field::Pressure, symbol)?.scale.si(largest);
        let why = format!("up to {} bar", significant(1e-5 * pascals, 2));
        (OF_PRESSURE[0]..=OF_PRESSURE[1]).contains(&pascals).then(|| Possible::new(symbol, why))
    });
    found.collect()
}

/// The unit in which the muscle as stated pulls about as much as was measured, if no other unit does so for
/// any unit of force that may have been left out.
fn pressures(slots: &[Slot], rows: &[usize], options: &ReadOptions) -> Vec<Possible> {
    let (pressure, force) = (values(slots, Field::Pressure, rows), values(slots, Field::Force, rows));
    let by_size = by_size(&pressure);
    let Some(ratio) = ratio(&pressure, &force, &contraction(slots, rows, options.l0_m), &options.pull) else {
        return by_size;
    };
    let says_newtons =
        place_of(slots, Field::Force).is_some_and(|place| slots[place].heading.open_unit.is_none());
    let forces = if says_newtons { &FORCES[..1] } else { &FORCES[..] };
    let mut alike: Vec<(f64, Possible)> = Vec::new();
    let mut is_sure = false;
    for Possible { symbol, .. } in &by_size {
        let Some(pascals) = unit(Field::Pressure, symbol).map(|unit| unit.scale.si(1.0)) else { continue };
        let times = |newtons: f64| newtons * ratio / pascals;
        let off = |newtons: f64| times(newtons).max(1.0 / times(newtons));
        let Some((of_force, newtons)) = forces.iter().min_by(|a, b| off(a.1).total_cmp(&off(b.1))) else {
            continue;
        };
        if off(*newtons) <= OTHER {
            is_sure = off(1.0) <= ALIKE;
            let (newtons, force) =
                if is_sure || *of_force == FORCES[0].0 { (1.0, None) } else { (*newtons, Some(*of_force)) };
            let with = force.map_or_else(String::new, |force| format!(", if these are {force}"));
            let times = significant(times(newtons), 2);
            let why = format!("the forces are {times} times those of the muscle{with}");
            alike.push((off(newtons), Possible { symbol, why, force }));
        }
    }
    alike.sort_by(|a, b| a.0.total_cmp(&b.0));
    let is_sure = is_sure && alike.len() == 1;
    if is_sure || alike.len() > 1 {
        alike.into_iter().map(|(_, possible)| possible).collect()
    } else {
        by_size
    }
}

/// Measured forces over those of the muscle, per unit of the pressure readings: the median over the most
/// informative rows.
fn ratio(pressure: &[f64], force: &[f64], contraction: &[f64], pull: &[[f64; 2]]) -> Option<f64> {
    let pulls: Vec<f64> = pressure.iter().zip(contraction).map(|(p, c)| p * at(pull, *c)).collect();
    let most = pulls.iter().copied().fold(0.0, f64::max);
    let mut ratios: Vec<f64> = pulls
        .iter()
        .zip(force)
        .filter(|(pull, _)| **pull > LARGE * most)
        .map(|(pull, force)| force.abs() / pull)
        .collect();
    let middle = ratios.len() / 2;
    (!ratios.is_empty()).then(|| *ratios.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Contractions, as far as the motion shows them without its sign.
fn contraction(slots: &[Slot], rows: &[usize], l0: Option<f64>) -> Vec<f64> {
    let of = |field| values(slots, field, rows);
    let share = |value: &f64, l0: f64| (value / l0).abs();
    match l0 {
        _ if place_of(slots, Field::Contraction).is_some() => of(Field::Contraction),
        Some(l0) if place_of(slots, Field::Length).is_some() => {
            of(Field::Length).iter().map(|length| 1.0 - share(length, l0)).collect()
        }
        Some(l0) => {
            let shares: Vec<f64> = of(Field::Displacement).iter().map(|way| share(way, l0)).collect();
            let is_length = range(&shares)[0] >= OF_LENGTH[0];
            if is_length { shares.iter().map(|share| 1.0 - share).collect() } else { shares }
        }
        None => Vec::new(),
    }
}

/// Linear interpolation in a table; 0 beyond its ends.
fn at(table: &[[f64; 2]], place: f64) -> f64 {
    let next = table.partition_point(|[x, _]| *x <= place);
    match (next.checked_sub(1).and_then(|before| table.get(before)), table.get(next)) {
        (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (place - x0) / (x1 - x0),
        (Some([x, y]), None) if place <= *x => *y,
        _ => 0.0,
    }
}

/// Reports what the readings of a column show.
fn say(reading: &mut Reading, slot: &Slot, symbol: Option<&str>, says: &str) {
    let is_it = |used: &&mut crate::reading::ColumnUse| {
        used.column == slot.heading.text && used.quantity.as_deref() == Some(slot.heading.field.name())
    };
    if let Some(used) = reading.columns.iter_mut().find(is_it) {
        used.unit = symbol.map(str::to_owned);
        used.guessed = true;
        used.add(says);
    }
}

fn refused(file: &str, slots: &[Slot], rows: &[usize], open: &[(usize, Vec<Possible>)]) -> MeasurementError {
    let (mut whats, mut instead) = (Vec::new(), Vec::new());
    for (place, possible) in open {
        let (slot, heading) = (&slots[*place], &slots[*place].heading);
        let [low, high] = range(&values(slots, heading.field, rows)).map(|value| significant(value, 3));
        let may_be: Vec<String> =
            possible.iter().map(|Possible { symbol, why, .. }| format!("{symbol} ({why})")).collect();
        let may_be = match may_be.as_slice() {
            _ if slot.units_inside > 0 => "some of its fields have one".to_owned(),
            [] => "none fits its readings".to_owned(),
            several => format!("it may be {}", several.join(" or ")),
        };
        whats.push(format!("column `{}` has no unit ({low} to {high}): {may_be}", heading.text));
        let example = heading.field.example().split(['[', ']']).nth(1).unwrap_or_default();
        let symbol = possible.first().map_or(example, |possible| possible.symbol);
        instead.push(entry(slot, symbol));
        let force = place_of(slots, Field::Force).zip(possible.first().and_then(|possible| possible.force));
        instead.extend(force.map(|(place, symbol)| entry(&slots[place], symbol)));
    }
    let first = &slots[open[0].0].heading;
    let what = format!(
        "{}: write the unit in brackets behind the name, such as `{}`, or say it, such as `--columns \"{}\"`",
        whats.join("; "),
        first.field.example(),
        instead.join(", ")
    );
    MeasurementError::at(file, first.open_unit.unwrap_or_default(), what)
}

/// The entry of a column for `--columns`.
fn entry(slot: &Slot, symbol: &str) -> String {
    let heading = &slot.heading;
    let quotes = if heading.text.contains([',', '=']) { "\\\"" } else { "" };
    format!("{}={quotes}{}{quotes} [{symbol}]", heading.field.name(), heading.text)
}
