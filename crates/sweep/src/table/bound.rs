//! A bound of the error of a table, by subdivision.
//!
//! Every cell is divided into parts. The error against the polynomial, which stands for the solver, is
//! computed in the middle of each part and at the middles of its faces. Between these points a smooth error
//! rises by at most an eighth of its second difference along each axis. The misfit between polynomial and
//! solver is added to the largest of these values. The bound is never less than the measured error. It relies
//! on the error being smooth on a part of a cell; it is no proof.

use bulge_table::{Form, Table};
use rayon::prelude::*;

use super::certificate::{FLOOR, golden};
use super::domain::Domain;
use super::field::NoValue;
use super::polynomial::Polynomial;

/// Most parts in total if cells are divided; an undivided cell is one part.
const MOST_PARTS: usize = 24_000;
/// Most multiplications for the bound. If all cells would take more, only as many evenly spread ones are used
/// as this allows.
const MOST_WORK: usize = 3_000_000_000;
/// Most parts of a cell along an axis.
const PARTS: usize = 3;
/// Points at which the polynomial is compared with the solver.
const POINTS: u64 = 1000;

/// Bound of the relative error of each output.
pub(crate) fn bound(
    domain: &Domain<'_>,
    fit: &Polynomial,
    table: &Table<'_>,
    scales: &[f64],
    nodes: &[usize],
) -> Result<Vec<f64>, NoValue> {
    let axes = nodes.len();
    // Cells of a spline. For polynomials there are as many cells as orders.
    let less = if table.form() == Form::Spline { 3 } else { 0 };
    let cells: Vec<usize> = nodes.iter().map(|n| n.saturating_sub(less).max(1)).collect();
    let all = |each: usize| cells.iter().map(|cells| cells * each).product::<usize>();
    let each = (1..=PARTS).rev().find(|each| all(*each) <= MOST_PARTS).unwrap_or(1);
    let parts: Vec<usize> = cells.iter().map(|cells| cells * each).collect();
    let outputs = scales.len();
    let count: usize = parts.iter().product();
    let most = MOST_WORK / (fit.coefficients.len() * (2 * axes + 1)).max(1);
    let chosen = count.min(most.max(1));
    let worst = (0..chosen)
        .into_par_iter()
        .map(|part| {
            let middle = if chosen == count {
                numbered(&parts, part)
            } else {
                let even = golden(part as u64, axes);
                even.iter().zip(&parts).map(|(v, n)| ((v * *n as f64).floor() + 0.5) / *n as f64).collect()
            };
            let at = errors(domain, fit, table, scales, &middle)?;
            let mut worst: Vec<f64> = at.iter().map(|error| error.abs()).collect();
            for i in 0..axes {
                let step = 0.5 / parts[i] as f64;
                let beside = |by: f64| {
                    let mut unit = middle.clone();
                    unit[i] = (unit[i] + by).clamp(1e-6, 1.0 - 1e-6);
                    errors(domain, fit, table, scales, &unit)
                };
                let (up, down) = (beside(step)?, beside(-step)?);
                for o in 0..outputs {
                    let rise = (up[o] - 2.0 * at[o] + down[o]).abs() / 8.0;
                    worst[o] = worst[o].max(up[o].abs()).max(down[o].abs()) + rise;
                }
            }
            Ok(worst)
        })
        .try_reduce(|| vec![0.0; outputs], |a, b| Ok(larger(&a, &b)))?;
    let misfit = (0..POINTS)
        .into_par_iter()
        .map(|k| {
            let unit = golden(k, axes);
            let (mut exact, mut fitted) = (vec![0.0; outputs], vec![0.0; outputs]);
            domain.reduced(&unit, &mut exact)?;
            fit.at(&unit, &mut fitted, &mut vec![0.0; outputs * axes]);
            let off = |o: usize| (exact[o] - fitted[o]).abs() / exact[o].abs().max(FLOOR * scales[o]);
            Ok((0..outputs).map(off).collect())
        })
        .try_reduce(|| vec![0.0; outputs], |a, b| Ok(larger(&a, &b)))?;
    Ok(worst.iter().zip(misfit).map(|(error, misfit)| error + misfit).collect())
}

/// Middle of the part with the given number.
fn numbered(parts: &[usize], mut number: usize) -> Vec<f64> {
    let mut middle = vec![0.0; parts.len()];
    for (middle, parts) in middle.iter_mut().zip(parts).rev() {
        *middle = ((number % parts) as f64 + 0.5) / *parts as f64;
        number /= parts;
    }
    middle
}

fn larger(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a.max(*b)).collect()
}

/// Signed relative errors of a table against the polynomial.
fn errors(
    domain: &Domain<'_>,
    fit: &Polynomial,
    table: &Table<'_>,
    scales: &[f64],
    unit: &[f64],
) -> Result<Vec<f64>, NoValue> {
    let (axes, outputs) = (unit.len(), scales.len());
    let point = domain.point(unit)?;
    let (mut values, mut by) = (vec![0.0; outputs], vec![0.0; outputs * axes]);
    fit.at(unit, &mut values, &mut by);
    let (mut found, mut slopes) = (vec![0.0; outputs], vec![0.0; outputs * axes]);
    let is_inside = table.sample(&point, &mut found, &mut slopes).is_some();
    Ok((0..outputs)
        .map(|o| {
            let output = &domain.field.outputs()[o];
            let over = if output.is_singular { 1.0 / unit[0] } else { 1.0 };
            let factor = over * if output.vanishes { 1.0 - unit[0] } else { 1.0 };
            let exact = values[o] * factor;
            // Within the error of the edge, a point may lie outside the table.
            let found = if is_inside { found[o] } else { exact };
            (found - exact) / exact.abs().max(FLOOR * scales[o] * over)
        })
        .collect())
}
