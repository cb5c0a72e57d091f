//! Curves of a diagnosis: the misfit before each step, the part that the step explains, and the remaining
//! misfit.

use bulge_model::Record;

use crate::comparison::levels::Levels;
use crate::comparison::residuals::bin;
use crate::diagnosis::document::{BentCurve, ExplainedCurve, ExplainedStep, SurfaceCurve};
use crate::diagnosis::form_error::Bent;
use crate::diagnosis::linearised_model::LinearisedModel;
use crate::dot::dot;

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
    let [low, high] = moments
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], m| [l.min(m.contraction), h.max(m.contraction)]);
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

/// The cells of each curve.
fn curves(cells: &[Cell]) -> impl Iterator<Item = &[Cell]> {
    cells.chunk_by(|a, b| a.level == b.level && a.direction.total_cmp(&b.direction).is_eq())
}

/// The part of the misfit that a step from one model to the next explains.
pub(crate) fn explained(effect: &str, record: &Record, before: &[f64], after: &[f64]) -> ExplainedStep {
    let levels = Levels::of(record, &vec![true; record.len()]);
    let cells = cells(record, &levels);
    let curve = |cells: &[Cell]| ExplainedCurve {
        pressure_pa: levels.mean[cells[0].level],
        direction: cells[0].direction,
        contraction: cells.iter().map(|cell| cell.contraction).collect(),
        before_n: cells.iter().map(|c| mean(&c.rows, |row| record.force()[row] - before[row])).collect(),
        explained_n: cells.iter().map(|c| mean(&c.rows, |row| after[row] - before[row])).collect(),
    };
    ExplainedStep { effect: effect.to_owned(), curves: curves(&cells).map(curve).collect() }
}

/// An effect by its formula, and with its fitted form error.
pub(crate) fn bent_curves(record: &Record, bent: &Bent) -> Vec<BentCurve> {
    let levels = Levels::of(record, &vec![true; record.len()]);
    let cells = cells(record, &levels);
    let curve = |cells: &[Cell]| {
        let of = |value: &dyn Fn(usize) -> f64| cells.iter().map(|cell| mean(&cell.rows, value)).collect();
        BentCurve {
            pressure_pa: levels.mean[cells[0].level],
            direction: cells[0].direction,
            contraction: cells.iter().map(|cell| cell.contraction).collect(),
            formula_n: of(&|row| bent.change[row]),
            bent_n: of(&|row| bent.drawn[row]),
            sd_n: of(&|row| bent.drawn_sd[row]),
        }
    };
    curves(&cells).map(curve).collect()
}

/// The systematic misfit of a model: the smooth functions that it can't follow, with their standard
/// deviation.
pub(crate) fn surface(record: &Record, linear: &LinearisedModel) -> Vec<SurfaceCurve> {
    let levels = Levels::of(record, &vec![true; record.len()]);
    let cells = cells(record, &levels);
    let parts: Vec<f64> = linear.smooth.iter().map(|d| dot(&d.unit, &linear.z)).collect();
    let at = |cell: &Cell| {
        let means = linear.smooth.iter().map(|d| mean(&cell.rows, |row| d.values[row]));
        means.zip(&parts).fold((0.0, 0.0), |(sum, square), (f, part)| (sum + f * part, square + f * f))
    };
    let curve = |cells: &[Cell]| {
        let found: Vec<(f64, f64)> = cells.iter().map(at).collect();
        SurfaceCurve {
            pressure_pa: levels.mean[cells[0].level],
            direction: cells[0].direction,
            contraction: cells.iter().map(|cell| cell.contraction).collect(),
            misfit_n: found.iter().map(|f| f.0).collect(),
            sd_n: found.iter().map(|f| f.1.sqrt()).collect(),
        }
    };
    curves(&cells).map(curve).collect()
}
