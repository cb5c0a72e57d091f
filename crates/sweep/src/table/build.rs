//! Builds a table: coordinates, edge, polynomials in place of the solver, then the smallest table of a form
//! that meets the tolerance.

use bulge_table::{Certificate, Form, MOST_ORDERS, Table, TableError};
use rayon::prelude::*;
use std::cmp::Reverse;

use super::bound::bound;
use super::certificate::{FLOOR, golden, measured};
use super::coordinate::hermite;
use super::domain::Domain;
use super::encode::{Draft, EncodeError};
use super::field::{Field, NoValue};
use super::polynomial::Polynomial;
use crate::plan::TableForm;

/// Polynomials follow the solver to this fraction of the tolerance times the floor.
const FOLLOW: f64 = 0.05;
/// Accuracy of the solver itself.
const SOLVER: f64 = 1e-13;
/// Points at which a candidate is measured during the search.
const ON_THE_WAY: u64 = 2048;
/// Number of the first certificate point. Candidates are measured at other points.
const FIRST_CHECK: u64 = 1 << 20;
/// Points from which scales, and errors along one axis, are estimated.
const ESTIMATE: u64 = 512;
/// Number of cells with which the errors along one axis are estimated.
const ESTIMATE_CELLS: usize = 32;
/// Most tries to meet the tolerance.
const MOST_TRIES: usize = 12;
/// Other proportions of cells that are tried for each axis.
const TILTS: [f64; 4] = [0.75, 0.88, 1.14, 1.33];
/// Single precision is tried from this tolerance on.
const SINGLE: f64 = 4e-7;

/// Requirements on a table, and its text.
#[derive(Debug, Clone, PartialEq)]
pub struct Requirements {
    /// Largest relative error of the values.
    pub tolerance: f64,
    /// Largest relative error of the gradients.
    pub gradient: f64,
    /// Largest size in bytes.
    pub max_bytes: usize,
    /// Its form.
    pub form: TableForm,
    /// Number of points at which the table is certified.
    pub checks: u64,
    /// Origin of the table, as JSON.
    pub text: String,
}

/// A built table.
#[derive(Debug, Clone, PartialEq)]
pub struct Built {
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// Whether the tolerance was met; otherwise the size limit was reached first.
    pub is_met: bool,
    /// Errors of each output.
    pub certificates: Vec<Certificate>,
}

/// Why no table was built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// The solver has no value at a point of the domain.
    #[error("no table: {0}; leave the region out of the ranges of the axes")]
    NoValue(#[from] NoValue),
    /// The table can't be encoded.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// The encoded table can't be read back.
    #[error("the table was not written as it is read: {0}")]
    Table(#[from] TableError),
    /// Not even the smallest table fits.
    #[error(
        "a table of these axes and outputs needs at least {needed} bytes: `max_size` is {limit}; allow more, or drop outputs"
    )]
    TooSmall {
        /// Bytes of the smallest table.
        needed: usize,
        /// The limit.
        limit: usize,
    },
}

/// A table during the search.
#[derive(Debug, Clone)]
struct Candidate {
    form: Form,
    is_single: bool,
    nodes: Vec<usize>,
}

/// Data shared by all candidates.
struct Builder<'a> {
    domain: Domain<'a>,
    fit: Polynomial,
    scales: Vec<f64>,
    edge_error: f64,
    wish: &'a Requirements,
}

/// Builds a table of a field. It runs in parallel and gives the same bytes on any number of threads. `told`
/// receives messages on the progress.
///
/// # Errors
/// [`BuildError`].
pub fn build(field: &dyn Field, wish: &Requirements, told: &dyn Fn(&str)) -> Result<Built, BuildError> {
    let limit = wish.max_bytes;
    let forms: &[Form] = match wish.form {
        TableForm::Splines => &[Form::Spline],
        TableForm::Chebyshev => &[Form::Chebyshev],
        TableForm::Fastest | TableForm::Smallest => &[Form::Spline, Form::Chebyshev],
    };
    let mut best: Option<(f64, Candidate, Builder<'_>)> = None;
    let mut failure = None;
    for form in forms {
        told(&format!("choosing {}", form.name()));
        let builder = Builder::new(field, *form, wish)?;
        let (ratio, candidate) = match builder.best(*form) {
            Ok(found) => found,
            Err(error) => {
                failure = Some(error);
                continue;
            }
        };
        let size = builder.size(&candidate);
        let better = match &best {
            None => true,
            Some((old, _, _)) if *old > 1.0 || ratio > 1.0 => ratio < *old,
            Some((_, kept, kept_builder)) => size < kept_builder.size(kept),
        };
        if better {
            best = Some((ratio, candidate, builder));
        }
        if wish.form == TableForm::Fastest && ratio <= 1.0 && size <= limit {
            break;
        }
    }
    let Some((_, candidate, builder)) = best else {
        return Err(failure.unwrap_or(BuildError::TooSmall { needed: limit, limit }));
    };
    told("certifying the table");
    builder.certified(candidate)
}

/// Largest |y| u^k of each output.
fn scales(fit: &Polynomial, field: &dyn Field, axes: usize) -> Vec<f64> {
    let outputs = fit.outputs;
    let mut scales = vec![0.0_f64; outputs];
    let (mut values, mut by) = (vec![0.0; outputs], vec![0.0; outputs * axes]);
    for k in 0..ESTIMATE {
        let unit = golden(k, axes);
        fit.at(&unit, &mut values, &mut by);
        for ((scale, value), output) in scales.iter_mut().zip(&values).zip(field.outputs()) {
            let factor = if output.vanishes { 1.0 - unit[0] } else { 1.0 };
            *scale = scale.max((value * factor).abs());
        }
    }
    scales
}

/// Largest difference between the stored edge and the edge found by the solver.
fn edge_error(domain: &Domain<'_>) -> Result<f64, NoValue> {
    let Some(edge) = &domain.edge else { return Ok(0.0) };
    let errors: Vec<f64> = (0..ESTIMATE)
        .into_par_iter()
        .map(|k| {
            let mut unit = golden(FIRST_CHECK + k, domain.highs.len());
            unit[0] = 1.0;
            let others = &domain.point(&unit)?[1..];
            let stored = edge.stored(&domain.coordinates, &unit[1..]);
            Ok((stored - domain.field.upper_end(others)?).abs())
        })
        .collect::<Result<_, NoValue>>()?;
    Ok(errors.into_iter().fold(0.0, f64::max))
}

impl<'a> Builder<'a> {
    fn new(field: &'a dyn Field, form: Form, wish: &'a Requirements) -> Result<Self, BuildError> {
        let domain = Domain::new(field, form, wish.tolerance, FLOOR, wish.max_bytes)?;
        let wanted = (FOLLOW * FLOOR * wish.tolerance).max(SOLVER);
        let (axes, outputs) = (field.axes().len(), field.outputs().len());
        let most = if axes <= 2 { MOST_ORDERS } else { MOST_ORDERS / 2 };
        let reduced = |unit: &[f64], values: &mut [f64]| domain.reduced(unit, values);
        let fit = Polynomial::fitted(axes, outputs, most, wanted, &reduced)?;
        let scales = scales(&fit, field, axes);
        let edge_error = edge_error(&domain)?;
        Ok(Self { domain, fit, scales, edge_error, wish })
    }

    fn bytes(
        &self,
        candidate: &Candidate,
        certificates: &[Certificate],
        checks: [u64; 2],
    ) -> Result<Vec<u8>, EncodeError> {
        let fit = &self.fit;
        let coefficients = match candidate.form {
            Form::Spline => fit.splines(&candidate.nodes),
            Form::Chebyshev => fit.truncated(&candidate.nodes).coefficients,
        };
        let poles: Vec<f64> = self.domain.coordinates.axes.iter().map(|c| c.pole).collect();
        Draft {
            form: candidate.form,
            is_single: candidate.is_single,
            is_root: self.domain.coordinates.axes[0].is_root,
            axes: self.domain.field.axes(),
            highs: &self.domain.highs,
            poles: &poles,
            scales: &self.domain.scales(),
            nodes: &candidate.nodes,
            edge: self.domain.edge.as_ref().map(|edge| (edge.nodes.as_slice(), edge.numbers.as_slice())),
            edge_error: self.edge_error,
            outputs: self.domain.field.outputs(),
            certificates,
            checks,
            coefficients: &coefficients,
            text: &self.wish.text,
        }
        .bytes()
    }

    /// Size of a candidate.
    fn size(&self, candidate: &Candidate) -> usize {
        let (axes, outputs) = (candidate.nodes.len(), self.fit.outputs);
        let each = if candidate.is_single { 4 } else { 8 };
        let edge = self.domain.edge.as_ref().map_or(0, |edge| 8 * edge.numbers.len());
        let records = bulge_table::format::HEADER
            + axes * bulge_table::format::AXIS
            + outputs * bulge_table::format::OUTPUT
            + 8;
        let nodes: usize = candidate.nodes.iter().product();
        records + edge + self.wish.text.len() + each * outputs * nodes
    }

    /// Largest error of a candidate relative to the allowed one, measured at a few points: 1 just meets the
    /// requirements.
    fn ratio(&self, candidate: &Candidate) -> Result<f64, BuildError> {
        let empty = vec![Certificate::default(); self.scales.len()];
        let bytes = self.bytes(candidate, &empty, [0, 0])?;
        let table = Table::from_bytes(&bytes)?;
        let found = measured(&self.domain, &table, &self.scales, (0, ON_THE_WAY))?;
        Ok(self.worst(&found))
    }

    fn worst(&self, certificates: &[Certificate]) -> f64 {
        let one =
            |c: &Certificate| (c.value_max / self.wish.tolerance).max(c.gradient_max / self.wish.gradient);
        certificates.iter().map(one).fold(0.0, f64::max)
    }

    /// The smallest table of a form that meets the requirements, or the best one that the size allows, and
    /// its error ratio.
    fn best(&self, form: Form) -> Result<(f64, Candidate), BuildError> {
        match form {
            Form::Spline => self.spline(),
            Form::Chebyshev => self.chebyshev(),
        }
    }

    /// Splines with the fewest nodes that meet the requirements, or as many nodes as the size allows, and the
    /// error ratio.
    fn spline(&self) -> Result<(f64, Candidate), BuildError> {
        let axes = self.fit.orders.len();
        let mut needed: Vec<f64> = (0..axes).map(|axis| self.cells_needed(axis)).collect();
        let mut best = self.splines(&needed)?;
        // The errors of the axes are estimates. More cells on one axis and fewer on the others may do better.
        for axis in 0..axes {
            for factor in TILTS {
                let mut other = needed.clone();
                other[axis] *= factor;
                let found = self.splines(&other)?;
                let smaller = self.size(&found.1) < self.size(&best.1);
                if if found.0 <= 1.0 { best.0 > 1.0 || smaller } else { found.0 < best.0 } {
                    (best, needed) = (found, other);
                }
            }
        }
        Ok(best)
    }

    /// The smallest splines whose cells have the given proportions.
    fn splines(&self, cells: &[f64]) -> Result<(f64, Candidate), BuildError> {
        let is_single = self.wish.tolerance >= SINGLE;
        let at = |scale: f64, is_single: bool| Candidate {
            form: Form::Spline,
            is_single,
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
            nodes: cells.iter().map(|n| 3 + (n * scale).ceil().clamp(1.0, 65_536.0) as usize).collect(),
        };
        self.fewest(is_single, 0.25, &at)
    }

    /// Polynomials with the fewest orders that meet the requirements.
    fn chebyshev(&self) -> Result<(f64, Candidate), BuildError> {
        let orders = self.fit.orders.clone();
        let at = |scale: f64, is_single: bool| Candidate {
            form: Form::Chebyshev,
            is_single,
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
            nodes: orders.iter().map(|n| ((*n as f64 * scale).ceil().max(1.0) as usize).min(*n)).collect(),
        };
        let is_single = self.wish.tolerance >= SINGLE;
        let (mut ratio, mut best) = self.fewest(is_single, 0.1, &at)?;
        // Drop orders one by one, beginning with the axis that saves most.
        let mut axes: Vec<usize> = (0..orders.len()).collect();
        axes.sort_by_key(|axis| Reverse(best.nodes[*axis]));
        for axis in axes {
            while best.nodes[axis] > 1 && ratio <= 1.0 {
                let mut fewer = best.clone();
                fewer.nodes[axis] -= 1;
                let next = self.ratio(&fewer)?;
                if next > 1.0 {
                    break;
                }
                (ratio, best) = (next, fewer);
            }
        }
        Ok((ratio, best))
    }

    /// The smallest scale of nodes that meets the requirements within the size limit. The steps follow from
    /// the order of the error. Double precision is used where single precision isn't enough.
    fn fewest(
        &self,
        is_single: bool,
        order: f64,
        at: &dyn Fn(f64, bool) -> Candidate,
    ) -> Result<(f64, Candidate), BuildError> {
        let limit = self.wish.max_bytes;
        let mut found: Option<(f64, Candidate)> = None;
        // Single precision comes first; double is tried only if single fails to meet the requirements.
        for is_single in [true, false].into_iter().filter(|single| is_single || !single) {
            let (mut scale, mut low, mut high) = (1.0, 0.0, f64::INFINITY);
            // Start from the largest scale that fits.
            while self.size(&at(scale, is_single)) > limit && scale > 1e-3 {
                scale *= 0.9;
            }
            for _ in 0..MOST_TRIES {
                let candidate = at(scale, is_single);
                if self.size(&candidate) > limit {
                    high = scale;
                    scale = 0.5 * (low + high);
                    if high - low < 0.01 * high {
                        break;
                    }
                    continue;
                }
                let ratio = self.ratio(&candidate)?;
                let better = match &found {
                    None => true,
                    Some((old, _)) if *old > 1.0 => ratio < *old,
                    Some((_, kept)) => ratio <= 1.0 && self.size(&candidate) < self.size(kept),
                };
                if better {
                    found = Some((ratio, candidate.clone()));
                }
                if ratio <= 1.0 {
                    high = scale;
                } else {
                    low = scale;
                }
                // The error is taken as a power of the scale; a step out of the bracket becomes a bisection.
                let mut next = scale * ratio.powf(order).clamp(0.5, 2.0) * 1.005;
                if !(next > low && next < high) {
                    next = if high.is_finite() { 0.5 * (low + high) } else { 1.05 * low };
                }
                if at(next, is_single).nodes == candidate.nodes || high - low < 0.01 * high {
                    break;
                }
                scale = next;
            }
            if found.as_ref().is_some_and(|(ratio, _)| *ratio <= 1.0) {
                break;
            }
        }
        found.ok_or_else(|| BuildError::TooSmall { needed: self.size(&at(1e-3, is_single)), limit })
    }

    /// Number of cells along an axis for its share of the tolerance. It follows from the error of splines
    /// along this axis alone: fourth order in the values, third order in the slopes.
    fn cells_needed(&self, axis: usize) -> f64 {
        let (axes, outputs) = (self.fit.orders.len(), self.fit.outputs);
        let cells = ESTIMATE_CELLS as f64;
        let worst = (0..ESTIMATE)
            .into_par_iter()
            .map(|k| {
                let mut unit = golden(k, axes);
                let along = unit[axis] * cells;
                let (start, t) = (along.floor() / cells, along.fract());
                let mut at = |u: f64| {
                    unit[axis] = u;
                    let (mut values, mut by) = (vec![0.0; outputs], vec![0.0; outputs * axes]);
                    self.fit.at(&unit, &mut values, &mut by);
                    (values, by[axis * outputs..(axis + 1) * outputs].to_vec())
                };
                let [(v, dv), (v0, d0), (v1, d1)] =
                    [at((start * cells + t) / cells), at(start), at(start + 1.0 / cells)];
                let r = 1.0 - t;
                let mut worst = [0.0_f64; 2];
                for o in 0..outputs {
                    let (s0, s1) = (d0[o] / cells, d1[o] / cells);
                    let value: f64 = hermite(t).iter().zip([v0[o], s0, v1[o], s1]).map(|(h, v)| h * v).sum();
                    let bend = 6.0 * t * r * (v1[o] - v0[o]);
                    let slope = (bend + s0 * r * (r - 2.0 * t) + s1 * t * (t - 2.0 * r)) * cells;
                    let size = v[o].abs().max(FLOOR * self.scales[o]);
                    worst[0] = worst[0].max((value - v[o]).abs() / size);
                    worst[1] = worst[1].max((slope - dv[o]).abs() / dv[o].abs().max(size));
                }
                worst
            })
            .reduce(|| [0.0; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        // Half of the tolerance, divided equally among the axes.
        let share = 0.5 / axes as f64;
        let value = (worst[0] / (share * self.wish.tolerance)).powf(0.25);
        let slope = (worst[1] / (share * self.wish.gradient)).powf(1.0 / 3.0);
        cells * value.max(slope).max(1.0 / cells)
    }

    /// The table with its certificate. It is refined if the many certificate points find a larger error than
    /// the few points before.
    fn certified(&self, mut candidate: Candidate) -> Result<Built, BuildError> {
        let checks = [self.wish.checks, FIRST_CHECK];
        let empty = vec![Certificate::default(); self.scales.len()];
        let mut last: Option<Built> = None;
        for _ in 0..MOST_TRIES {
            let bytes = self.bytes(&candidate, &empty, checks)?;
            let table = Table::from_bytes(&bytes)?;
            let mut certificates =
                measured(&self.domain, &table, &self.scales, (FIRST_CHECK, self.wish.checks))?;
            let bounds = bound(&self.domain, &self.fit, &table, &self.scales, &candidate.nodes)?;
            for (certificate, bound) in certificates.iter_mut().zip(bounds) {
                // The largest error measured at the samples is a lower limit of any bound.
                certificate.bound = bound.max(certificate.value_max);
            }
            let ratio = self.worst(&certificates);
            let built = Built {
                bytes: self.bytes(&candidate, &certificates, checks)?,
                is_met: ratio <= 1.0,
                certificates,
            };
            let finer = self.finer(&candidate, ratio);
            if built.is_met || self.size(&finer) > self.wish.max_bytes || finer.nodes == candidate.nodes {
                return Ok(built);
            }
            (last, candidate) = (Some(built), finer);
        }
        last.ok_or(BuildError::TooSmall { needed: self.size(&candidate), limit: self.wish.max_bytes })
    }

    fn finer(&self, candidate: &Candidate, ratio: f64) -> Candidate {
        let mut finer = candidate.clone();
        for (nodes, orders) in finer.nodes.iter_mut().zip(&self.fit.orders) {
            match candidate.form {
                Form::Spline => {
                    let factor = ratio.powf(0.3).clamp(1.0, 2.0);
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
                    let more = (*nodes as f64 * factor).ceil() as usize;
                    *nodes = more.max(*nodes + 1);
                }
                Form::Chebyshev => *nodes = (*nodes + 1).min(*orders),
            }
        }
        finer
    }
}
