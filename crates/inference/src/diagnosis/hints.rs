//! Description of a misfit that no effect explains: where it is largest, how it depends on the pressure,
//! whether it changes sign with the direction, and which effect comes nearest.

use bulge_model::Record;

use crate::comparison::levels::Levels;
use crate::diagnosis::candidates::Candidate;
use crate::diagnosis::document::Located;
use crate::diagnosis::linearised_model::LinearisedModel;
use crate::vector::range;
use bulge_muscles::units::significant;
use bulge_numerics::vector::add;

/// Bins of the contraction in which levels are compared.
const BINS: usize = 12;
/// Share from which a variable is mentioned.
const MUCH: f64 = 0.3;
/// Largest p-value at which it is mentioned.
const CLEAR: f64 = 0.01;
/// Part of the most that effects explain which are the same but for rounding.
const ALIKE: f64 = 1.0 - 1e-6;

/// Sentences about the remaining misfit.
pub(crate) fn hints(record: &Record, linear: &LinearisedModel, located: &[Located]) -> Vec<String> {
    let misfit = linear.systematic(&linear.z);
    let mut found = Vec::new();
    found.extend(largest(record, &misfit));
    found.extend(exponent(record, &misfit));
    let clear =
        |variable: &str| located.iter().any(|l| l.variable == variable && l.share > MUCH && l.p < CLEAR);
    if clear("direction") {
        found.push("it turns its sign with the direction, as friction and hysteresis do".to_owned());
    } else if record.moments().iter().any(|m| m.branch() != 0.0)
        && located.iter().all(|l| l.variable != "direction" || l.share < 0.1)
    {
        found.push(
            "it is the same in both directions: geometry, elasticity or the rig rather than friction"
                .to_owned(),
        );
    }
    for (variable, says) in [
        ("time", "it changes with time: drift, creep, or an event"),
        ("rate", "it changes with the speed: viscous, or a lag of the rig"),
        ("temperature", "it changes with the temperature"),
        ("cycle", "it changes from cycle to cycle"),
        ("specimen", "it differs from specimen to specimen"),
    ] {
        if clear(variable) {
            found.push(says.to_owned());
        }
    }
    found.extend(nearest(record, linear));
    found
}

fn bar(pressure: f64) -> String {
    format!("{} bar", significant(pressure / 1e5, 2))
}

fn largest(record: &Record, misfit: &[f64]) -> Option<String> {
    let row = (0..misfit.len()).max_by(|a, b| misfit[*a].abs().total_cmp(&misfit[*b].abs()))?;
    let moment = &record.moments()[row];
    Some(format!(
        "it is largest near contraction {} % at {}: the muscle pulls {} N {} than the model",
        significant(100.0 * moment.contraction, 2),
        bar(moment.pressure),
        significant(misfit[row].abs(), 2),
        if misfit[row] > 0.0 { "more" } else { "less" }
    ))
}

/// Exponent of the pressure: levels as multiples of their common shape over the contraction.
fn exponent(record: &Record, misfit: &[f64]) -> Option<String> {
    let levels = Levels::of(record, &vec![true; record.len()]);
    if levels.len() < 2 || levels.mean.iter().any(|p| *p <= 0.0) {
        return None;
    }
    let moments = record.moments();
    let [low, high] = range(moments.iter().map(|m| m.contraction));
    let mut cells = vec![vec![(0.0, 0.0); BINS]; levels.len()];
    for (row, moment) in moments.iter().enumerate() {
        let cell = &mut cells[levels.at(row)]
            [crate::comparison::residuals::bin(moment.contraction, low, high, BINS)];
        *cell = (cell.0 + misfit[row], cell.1 + 1.0);
    }
    let mean = |cell: &(f64, f64)| if cell.1 > 0.0 { Some(cell.0 / cell.1) } else { None };
    let shape: Vec<Option<f64>> = (0..BINS)
        .map(|bin| {
            let values: Vec<f64> = cells.iter().filter_map(|level| mean(&level[bin])).collect();
            (values.len() == cells.len()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        })
        .collect();
    let square: f64 = shape.iter().flatten().map(|s| s * s).sum();
    if square <= 0.0 {
        return None;
    }
    let multiples: Vec<f64> = cells
        .iter()
        .map(|level| {
            let along = |(cell, shape): (&(f64, f64), &Option<f64>)| Some(mean(cell)? * (*shape)?);
            level.iter().zip(&shape).filter_map(along).sum::<f64>() / square
        })
        .collect();
    if multiples.iter().any(|m| *m <= 0.0) {
        return Some(
            "it changes its form with the pressure: no power of the pressure describes it".to_owned(),
        );
    }
    // Regression line through the logarithms.
    let points: Vec<(f64, f64)> = levels.mean.iter().zip(&multiples).map(|(p, m)| (p.ln(), m.ln())).collect();
    let x = points.iter().map(|p| p.0).sum::<f64>() / points.len() as f64;
    let spread: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    if spread <= 0.0 {
        return None;
    }
    let power = points.iter().map(|p| (p.0 - x) * p.1).sum::<f64>() / spread;
    let says = match power {
        p if p.abs() < 0.35 => {
            "it is about the same at all pressures (rubber, offsets of the load cell)".to_owned()
        }
        p if (0.65..=1.35).contains(&p) => "it goes about with the pressure (geometry, gains)".to_owned(),
        p if (1.65..=2.5).contains(&p) => {
            "it goes about with the square of the pressure (stretch of fibres or frame)".to_owned()
        }
        p => format!("it goes with the pressure to the power {}", significant(p, 2)),
    };
    Some(says)
}

/// The effect that explains most, and where it fails.
fn nearest(record: &Record, linear: &LinearisedModel) -> Option<String> {
    let whole = linear.structure() - linear.smooth.len() as f64;
    let gain = |c: &Candidate| c.explains(&linear.z).gain;
    let most = linear.candidates.iter().map(gain).fold(0.0, f64::max);
    // The first of those that are the same on these data, whatever their last digits.
    let best = linear.candidates.iter().find(|c| gain(c) >= ALIKE * most)?;
    let explained = best.explains(&linear.z);
    if whole <= 0.0 || explained.gain <= 1.0 {
        return None;
    }
    let mut left = linear.z.clone();
    for (column, size) in best.columns.iter().zip(&explained.sizes) {
        add(&mut left, -size, column);
    }
    let sum = linear.systematic(&left);
    let row = (0..sum.len()).max_by(|a, b| sum[*a].abs().total_cmp(&sum[*b].abs()))?;
    let moment = &record.moments()[row];
    Some(format!(
        "the nearest of the effects that were looked for, `{}`, explains {:.0} % of it and fails by {} N near contraction {} % at {}",
        linear.sensitivities.effects[best.effect].effect.card().name,
        100.0 * ((explained.gain - 1.0) / whole).clamp(0.0, 1.0),
        significant(sum[row].abs(), 2),
        significant(100.0 * moment.contraction, 2),
        bar(moment.pressure)
    ))
}

#[cfg(test)]
mod tests {
    use super::exponent;
    use bulge_effects::Moment;
    use bulge_model::Record;

    /// A misfit of one shape over the contraction that goes with a power of the pressure.
    fn of_power(power: f64) -> String {
        let states = [1e5, 2e5, 4e5].into_iter().flat_map(|p| (0..30).map(move |i| (p, 0.01 * f64::from(i))));
        let moments: Vec<Moment> = states.map(|(p, e)| Moment::at_rest(p, e)).collect();
        let misfit: Vec<f64> = moments
            .iter()
            .map(|m| (m.pressure / 1e5).powf(power) * (1.0 + (9.0 * m.contraction).sin()))
            .collect();
        let record = Record::from_moments(moments, misfit.clone(), vec![0..30, 30..60, 60..90]).unwrap();
        exponent(&record, &misfit).unwrap()
    }

    #[test]
    fn the_power_of_the_pressure_is_told() {
        for (power, says) in [
            (0.0, "about the same at all pressures"),
            (0.34, "about the same at all pressures"),
            (0.36, "to the power 0.36"),
            (0.64, "to the power 0.64"),
            (0.66, "about with the pressure"),
            (1.34, "about with the pressure"),
            (1.36, "to the power 1.4"),
            (1.66, "about with the square"),
            (2.49, "about with the square"),
            (3.0, "to the power 3"),
            (-2.0, "to the power -2"),
        ] {
            assert!(of_power(power).contains(says), "{power}: {}", of_power(power));
        }
    }
}
