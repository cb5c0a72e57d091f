//! Reduces the motion to one column: a displacement becomes a length, and of length and contraction the
//! measured one is kept.

use crate::data::Data;
use crate::error::MeasurementError;
use crate::heading::Field;
use crate::reading::{ReadOptions, Reading};
use crate::slot::Slot;
use crate::sweep;
use crate::table::place_of;

/// A displacement with nearly all readings between these fractions of the muscle's length is the length itself.
const LENGTHS: [f64; 2] = [0.4, 1.6];
/// One reading in this many may be wild.
const WILD: usize = 10;
/// Forces above this fraction of the largest show the sign of the load cell.
const PULLS: f64 = 0.1;
/// Correlation from which the motion under a weight goes with the pressure, and not with its noise.
const GOES_WITH: f64 = 0.5;
/// What the sizes of the forces leave of themselves beside a plane, over what the forces do, from which the load cell was turned.
const TURNED: f64 = 0.5;
/// Largest difference between a contraction and the one that follows from the length.
const SAME: f64 = 5e-3;

impl Data {
    /// Whether the motion of a row was read as a displacement.
    #[must_use]
    pub fn is_displaced(&self, row: usize) -> bool {
        self.displaced_from_m.get(self.line(row).0).is_some_and(Option::is_some)
    }
}

/// Leaves one motion among the columns; `is_good` marks the rows that count. Returns the length \[m\] from which
/// displacements count, if there are any.
pub(crate) fn settle(
    file: &str,
    slots: &mut Vec<Slot>,
    is_good: &[bool],
    options: &ReadOptions,
    reading: &mut Reading,
) -> Result<Option<f64>, MeasurementError> {
    if let Some(place) = place_of(slots, Field::Displacement) {
        return displacement(file, slots, place, is_good, options, reading);
    }
    let (Some(length), Some(contraction)) =
        (place_of(slots, Field::Length), place_of(slots, Field::Contraction))
    else {
        return Ok(None);
    };
    let pairs: Vec<[f64; 2]> =
        rows(is_good).map(|row| [slots[length].numbers()[row], slots[contraction].numbers()[row]]).collect();
    if !are_one(&pairs) {
        let what = "`contraction` and `length` are both given, and do not follow from one another: leave out the one that was computed (most rigs measure `length`)";
        return Err(MeasurementError::of_file(file, what));
    }
    let text = slots[contraction].heading.text.clone();
    note(reading, &text, None, "ignored: it follows from the length");
    slots.remove(contraction);
    Ok(None)
}

fn rows(is_good: &[bool]) -> impl Iterator<Item = usize> + Clone + '_ {
    (0..is_good.len()).filter(|row| is_good[*row])
}

/// Whether contraction = 1 - length/l0, with the best l0 from least squares of length = l0 (1 - contraction).
fn are_one(pairs: &[[f64; 2]]) -> bool {
    let (mut both, mut square) = (0.0, 0.0);
    for [length, contraction] in pairs {
        both += length * (1.0 - contraction);
        square += (1.0 - contraction).powi(2);
    }
    let l0 = both / square;
    l0.is_finite() && l0 > 0.0 && pairs.iter().all(|[length, c]| (1.0 - length / l0 - c).abs() <= SAME)
}

/// A displacement is measured from the unpressurised length; its sign is found from the force.
fn displacement(
    file: &str,
    slots: &mut [Slot],
    place: usize,
    is_good: &[bool],
    options: &ReadOptions,
    reading: &mut Reading,
) -> Result<Option<f64>, MeasurementError> {
    let heading = slots[place].heading.clone();
    let Some(l0) = options.l0_m.filter(|l0| l0.is_finite() && *l0 > 0.0) else {
        let what = format!(
            "the column `{}` is a displacement, whose zero is the length of the unpressurised muscle: name the muscle, or write `length` or `contraction` instead",
            heading.text
        );
        return Err(MeasurementError::of_file(file, what));
    };
    let values = slots[place].numbers();
    let is_other = |row: &usize| !(LENGTHS[0] * l0..=LENGTHS[1] * l0).contains(&values[*row]);
    let is_length = !heading.is_settled
        && rows(is_good).next().is_some()
        && WILD * rows(is_good).filter(is_other).count() <= rows(is_good).count();
    if is_length {
        slots[place].become_column(Field::Length, |value| value);
        let says = "taken for the length itself: its readings are about as long as the muscle";
        note(reading, &heading.text, Some("length"), says);
        return Ok(None);
    }
    let sign = if heading.is_settled {
        Sign { shortens: true, why: "as stated" }
    } else if heading.is_lengthening {
        Sign { shortens: false, why: "as its name says" }
    } else {
        sign(slots, place, is_good)
    };
    let factor = if sign.shortens { -1.0 } else { 1.0 };
    slots[place].become_column(Field::Length, |value| l0 + factor * value);
    let says = format!(
        "{} from {} mm ({})",
        if sign.shortens { "shortening" } else { "lengthening" },
        bulge_muscles::units::rounded(1e3 * l0, 6),
        sign.why
    );
    note(reading, &heading.text, Some("displacement"), &says);
    Ok(Some(l0))
}

/// The sign of a displacement, and the reason for it.
struct Sign {
    shortens: bool,
    why: &'static str,
}

/// The sign of c in force = a + b pressure + c displacement, since the force falls as a muscle shortens at
/// constant pressure. Under a weight a muscle shortens as the pressure rises. A wild reading counts as the last but a tenth of
/// its column; a load cell that reads most pulls as negative is turned over. What it then still reads as a push it may have read
/// turned over for a while, or tared under a load: where what pulls is a weight, or the sizes of the forces follow such a plane
/// much better, it was turned.
fn sign(slots: &[Slot], place: usize, is_good: &[bool]) -> Sign {
    let numbers = |field| place_of(slots, field).map_or(&[][..], |place| slots[place].numbers());
    let of = |values: &[f64]| clamped(rows(is_good).map(|row| values[row]).collect());
    let [pressure, mut force, way] =
        [of(numbers(Field::Pressure)), of(numbers(Field::Force)), of(slots[place].numbers())];
    let large = PULLS * force.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    let pulls = force.iter().filter(|force| force.abs() > large);
    if 2 * pulls.clone().filter(|force| **force < 0.0).count() > pulls.count() {
        for force in &mut force {
            *force = -*force;
        }
    }
    let centred = |values: &[f64], counts: &dyn Fn(usize) -> bool| -> Vec<f64> {
        let values: Vec<f64> = (0..values.len()).filter(|row| counts(*row)).map(|row| values[row]).collect();
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        values.iter().map(|value| value - mean).collect()
    };
    let pulls = |row: usize| force[row] >= -large;
    let [p, d] = [&pressure, &way].map(|values| centred(values, &pulls));
    let (pp, dd, pd) = (dot(&p, &p), dot(&d, &d), dot(&p, &d));
    let pulling = force.iter().copied().filter(|force| *force >= -large);
    if sweep::is_weight(pulling) && pd.abs() > GOES_WITH * (pp * dd).sqrt() {
        return Sign { shortens: pd > 0.0, why: "at a held force it goes with the pressure" };
    }
    let [p, d] = [&pressure, &way].map(|values| centred(values, &|_| true));
    let [as_read, turned] = [force.clone(), force.iter().map(|force| force.abs()).collect()]
        .map(|force| plane(&p, &d, &centred(&force, &|_| true)));
    let (slope, _) = if turned.1 < TURNED * as_read.1 { turned } else { as_read };
    match slope {
        slope if slope < 0.0 => Sign { shortens: true, why: "the force falls as it grows" },
        slope if slope > 0.0 => Sign { shortens: false, why: "the force rises as it grows" },
        _ => Sign { shortens: true, why: "nothing shows which way it counts" },
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The slope c of force = b pressure + c displacement, all of mean 0, and the fraction of the force's squares that this leaves. At a
/// single pressure the force follows the displacement alone.
fn plane(pressure: &[f64], way: &[f64], force: &[f64]) -> (f64, f64) {
    let [pp, dd, pd] = [dot(pressure, pressure), dot(way, way), dot(pressure, way)];
    let [pf, df, ff] = [dot(pressure, force), dot(way, force), dot(force, force)];
    let determinant = pp * dd - pd * pd;
    let [b, c] = if pp > 0.0 && pp * dd > 1.0001 * pd * pd {
        [(pf * dd - df * pd) / determinant, (df * pp - pf * pd) / determinant]
    } else {
        [0.0, if dd > 0.0 { df / dd } else { 0.0 }]
    };
    (c, if ff > 0.0 { (ff - b * pf - c * df) / ff } else { 0.0 })
}

/// The values, those of the outer tenth on either side moved to where it begins.
fn clamped(mut values: Vec<f64>) -> Vec<f64> {
    let mut sorted = values.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let outer = values.len() / WILD;
    if let (Some(low), Some(high)) = (sorted.get(outer), sorted.iter().nth_back(outer)) {
        for value in &mut values {
            *value = value.clamp(*low, *high);
        }
    }
    values
}

/// Reports how a column was used.
fn note(reading: &mut Reading, column: &str, quantity: Option<&str>, says: &str) {
    if let Some(used) =
        reading.columns.iter_mut().find(|used| used.column == column && used.quantity.is_some())
    {
        used.quantity = quantity.map(str::to_owned);
        used.guessed |= quantity.is_some();
        used.add(says);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outer_tenth_is_moved_in() {
        let values: Vec<f64> = (0..20).map(f64::from).chain([1e9]).collect();
        let moved = clamped(values.clone());
        assert_eq!(
            (moved[0], moved[1], moved[2], moved[18], moved[19], moved[20]),
            (2.0, 2.0, 2.0, 18.0, 18.0, 18.0)
        );
        assert_eq!(clamped(values[..9].to_vec()), values[..9]);
        assert!(clamped(Vec::new()).is_empty());
    }

    /// Which way a displacement counts, of rows of pressure, displacement and force.
    fn says(rows: &[[f64; 3]]) -> String {
        let mut text = "p [bar],Weg (mm),F [N]\n".to_owned();
        for [p, d, f] in rows {
            text.extend([p.to_string(), format!(",{d},{f}\n")]);
        }
        let options = ReadOptions { l0_m: Some(0.3), ..ReadOptions::default() };
        let data = crate::Data::from_bytes(text.as_bytes(), "d.csv", &options).unwrap();
        data.reading().columns[1].says.clone().unwrap()
    }

    #[test]
    fn noise_of_a_held_pressure_does_not_decide() {
        let [low, high] = [[1.001, 1.003, 1.0, 1.002], [3.002, 3.0, 3.003, 3.001]];
        let rows: Vec<[f64; 3]> = [108.0, 109.0, 101.0, 103.0]
            .into_iter()
            .enumerate()
            .flat_map(|(i, f)| {
                let d = i as f64 + 1.0;
                [[low[i], d, f], [high[i], 20.0 + d, 100.0 + f]]
            })
            .collect();
        assert!(says(&rows).starts_with("shortening"), "{}", says(&rows));
        // Under a weight at one pressure, whose noise says nothing.
        let hung: Vec<[f64; 3]> = (0..40)
            .map(|i| [2.5 + 1e-3 * f64::from(i * 7 % 5), f64::from(i % 8), 100.0 - 0.1 * f64::from(i % 8)])
            .collect();
        assert!(says(&hung).contains("the force falls"), "{}", says(&hung));
        // A weight whose load cell is turned for a while, most of it where the muscle is long.
        let turned = |i: i32| if (10..24).contains(&i) { -600.0 } else { 600.0 };
        let hung: Vec<[f64; 3]> = (0..60_i32)
            .map(|i| {
                let bar = 2.0 + f64::from((i % 40 - 20).abs()) / 10.0;
                [bar, 8.0 * (bar - 1.5), turned(i) + f64::from(i * 7 % 5)]
            })
            .collect();
        assert!(says(&hung).starts_with("shortening"), "{}", says(&hung));
        assert!(says(&hung).contains("at a held force"), "{}", says(&hung));
        // A cell that was tared between two weights reads the lighter one as a push; the muscle is shorter under that.
        let weights: Vec<[f64; 3]> = (0..40_i32)
            .map(|i| {
                let [p, d] = [f64::from(i * 7 % 5), f64::from(i * 3 % 8)].map(|noise| 1e-3 * noise);
                let [way, force] = if i / 10 % 2 == 0 { [-11.0, 236.0] } else { [-42.0, -218.0] };
                [3.8 + p, way + d, force]
            })
            .collect();
        assert!(says(&weights).starts_with("lengthening"), "{}", says(&weights));
    }

    #[test]
    fn a_load_cell_that_was_turned_for_a_sweep_does_not_decide() {
        // Three isobaric sweeps of a muscle that shortens as the displacement falls; the cell is turned over in the strongest.
        let rows: Vec<[f64; 3]> = (0..30)
            .map(|i| {
                let [bar, d] = [2.0_f64.powi(i / 10), 2.0 * f64::from(i % 10)];
                [bar, -d, if i < 20 { bar * (200.0 - 5.0 * d) } else { -bar * (200.0 - 5.0 * d) }]
            })
            .collect();
        assert!(says(&rows).starts_with("lengthening"), "{}", says(&rows));
    }

    #[test]
    fn a_slack_muscle_with_an_offset_is_no_load_cell_turned_over() {
        let pulls = (0..8).map(|i| [3.0, 20.0 / 7.0 * f64::from(i), 500.0 - 70.0 * f64::from(i)]);
        let slack = (0..10).map(|i| [3.0, 21.0 + 2.0 * f64::from(i), -0.4]);
        let rows: Vec<[f64; 3]> = pulls.chain(slack).collect();
        assert!(says(&rows).contains("the force falls"), "{}", says(&rows));
    }
}
