//! Curves of a diagnosis: the misfit before each step, the part that the step explains, and the remaining
//! misfit.

use bulge_model::Record;

use crate::comparison::levels::Levels;
use crate::comparison::residuals::bin;
use crate::diagnosis::document::{BentCurve, CurveAt, ExplainedCurve, ExplainedStep, SurfaceCurve};
use crate::diagnosis::form_error::Bent;
use crate::diagnosis::linearised_model::LinearisedModel;
use crate::vector::range;
use bulge_numerics::vector::dot;

/// Bins of the contraction.
const BINS: usize = 24;

/// Rows of one pressure level, one direction and one bin of the contraction.
struct Cell {
    level: usize,
    direction: f64,
    contraction: f64,
    rows: Vec<usize>,
}

/// All cells with rows, by level and direction.
fn cells(record: &Record, levels: &Levels) -> Vec<Cell> {
    let moments = record.moments();
    let [low, high] = range(moments.iter().map(|m| m.contraction));
    let mut found = Vec::new();
    for level in 0..levels.len() {
        for direction in [1.0, 0.0, -1.0] {
            let mut rows = vec![Vec::new(); BINS];
            for (row, moment) in moments.iter().enumerate() {
                if levels.at(row) == level && moment.branch().total_cmp(&direction).is_eq() {
                    rows[bin(moment.contraction, low, high, BINS)].push(row);
                }
            }
            for rows in rows.into_iter().filter(|rows| !rows.is_empty()) {
                let contraction = mean(&rows, |row| moments[row].contraction);
                found.push(Cell { level, direction, contraction, rows });
            }
        }
    }
    found
}

fn mean(rows: &[usize], value: impl Fn(usize) -> f64) -> f64 {
    rows.iter().map(|row| value(*row)).sum::<f64>() / rows.len() as f64
}

/// A curve for each level and direction, from its place and its cells.
fn curves<T>(record: &Record, curve: impl Fn(CurveAt, &[Cell]) -> T) -> Vec<T> {
    let levels = Levels::of(record, &vec![true; record.len()]);
    let of = |cells: &[Cell]| {
        let [pressure_pa, direction] = [levels.mean[cells[0].level], cells[0].direction];
        let contraction = cells.iter().map(|cell| cell.contraction).collect();
        curve(CurveAt { pressure_pa, direction, contraction }, cells)
    };
    let is_same = |a: &Cell, b: &Cell| a.level == b.level && a.direction.total_cmp(&b.direction).is_eq();
    cells(record, &levels).chunk_by(is_same).map(of).collect()
}

/// The mean of a value in each cell.
fn means(cells: &[Cell], value: impl Fn(usize) -> f64) -> Vec<f64> {
    cells.iter().map(|cell| mean(&cell.rows, &value)).collect()
}

/// The part of the misfit that a step from one model to the next explains.
pub(crate) fn explained(effect: &str, record: &Record, before: &[f64], after: &[f64]) -> ExplainedStep {
    let curve = |at, cells: &[Cell]| ExplainedCurve {
        at,
        before_n: means(cells, |row| record.force()[row] - before[row]),
        explained_n: means(cells, |row| after[row] - before[row]),
    };
    ExplainedStep { effect: effect.to_owned(), curves: curves(record, curve) }
}

/// An effect by its formula, and with its fitted form error.
pub(crate) fn bent_curves(record: &Record, bent: &Bent) -> Vec<BentCurve> {
    curves(record, |at, cells| BentCurve {
        at,
        formula_n: means(cells, |row| bent.change[row]),
        bent_n: means(cells, |row| bent.drawn[row]),
        sd_n: means(cells, |row| bent.drawn_sd[row]),
    })
}

/// The systematic misfit of a model: the smooth functions that it can't follow, with their standard
/// deviation.
pub(crate) fn surface(record: &Record, linear: &LinearisedModel) -> Vec<SurfaceCurve> {
    let parts: Vec<f64> = linear.smooth.iter().map(|d| dot(&d.unit, &linear.z)).collect();
    let misfit = |cell: &Cell| {
        let means = linear.smooth.iter().map(|d| mean(&cell.rows, |row| d.values[row]));
        means.zip(&parts).fold((0.0, 0.0), |(sum, square), (f, part)| (sum + f * part, square + f * f))
    };
    curves(record, |at, cells| {
        let (misfit_n, variance): (Vec<f64>, Vec<f64>) = cells.iter().map(misfit).unzip();
        SurfaceCurve { at, misfit_n, sd_n: variance.into_iter().map(f64::sqrt).collect() }
    })
}
