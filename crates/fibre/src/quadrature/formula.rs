//! A formula for the energy of the wall, beside fibres that don't stretch.
//!
//! Its energy W is a function of the radius alone, but a formula has no divided differences in closed form.
//! They follow from its second derivative, without cancellation as those of the parts that are written out:
//!
//! ```text
//! W[m, m, y] = (1/(r + r_m)^2) integral from 0 to 1 of (1 - t) (W''(r_m + t (r - r_m)) - W'(r_m)/r_m) dt
//! ```
//!
//! The integral is a smooth function of the radius, and becomes its Chebyshev series (see `chebyshev`). The
//! points are doubled until the last coefficients vanish.

use arrayvec::ArrayVec;
use bulge_numerics::Real;

use super::chebyshev::{GRIDS, Grid, MOST, RESOLVED, value};
use crate::formulas::Formulas;
use crate::meridian::Middle;
use crate::net::Net;

/// Size of coefficients that are rounding, relative to the energy's second derivative.
const ROUNDING: f64 = 1e-15;

/// The second divided difference of the energy by y, times (r + r_m)^2, between mid-length and fitting.
pub(super) struct Bend<D> {
    /// Index of the grid.
    grid: usize,
    /// Coefficients up to the last one that counts.
    series: ArrayVec<D, MOST>,
}

/// Radii at which a formula is computed at once. A grid has a multiple of them besides mid-length, and so has
/// each grid besides the one before.
const BLOCK: usize = 8;

impl Bend<f64> {
    /// On the first grid that resolves the energy from a middle; each point counts as an evaluation. `None` if
    /// no grid does.
    pub(super) fn resolved(net: &Net<f64>, middle: &Middle<f64>, evaluations: &mut u32) -> Option<Self> {
        let law = Law::of(net, middle)?;
        let mut bends: ArrayVec<f64, MOST> = ArrayVec::new();
        for (index, grid) in GRIDS.iter().enumerate() {
            // Every other point is one of the grid before.
            let before = std::mem::take(&mut bends);
            let known =
                |i: usize| if i == 0 { law.at_middle } else { before.get(i / 2).copied().unwrap_or(0.0) };
            bends.extend((0..grid.places.len()).map(known));
            let step = if before.is_empty() { 1 } else { 2 };
            law.fill(grid, step, &mut bends)?;
            *evaluations += u32::try_from(bends.len() - before.len()).unwrap_or(u32::MAX);
            let mut series = series(grid, grid.places.len(), &bends);
            // The curvature of the cross-section is of order 1.
            let largest = |values: &[f64]| values.iter().fold(1.0, |most: f64, value| most.max(value.abs()));
            let last: f64 = series.iter().rev().take(2).map(|value| value.abs()).sum();
            if last <= RESOLVED * largest(&series) {
                let least = ROUNDING * largest(&bends);
                let used = series.iter().rposition(|value| value.abs() > least).map_or(1, |last| last + 1);
                series.truncate(used);
                return Some(Self { grid: index, series });
            }
        }
        None
    }
}

impl<D: Real> Bend<D> {
    /// The same with derivatives.
    pub(super) fn on(resolved: &Bend<f64>, net: &Net<D>, middle: &Middle<D>) -> Option<Self> {
        let law = Law::of(net, middle)?;
        let grid = &GRIDS[resolved.grid];
        let mut bends: ArrayVec<D, MOST> = grid.places.iter().map(|_| law.at_middle).collect();
        law.fill(grid, 1, &mut bends)?;
        Some(Self { grid: resolved.grid, series: series(grid, resolved.series.len(), &bends) })
    }

    /// Its value where rho is this part of that at the fitting.
    #[inline]
    pub(super) fn at(&self, part: f64) -> D {
        value(&self.series, part)
    }
}

/// The first coefficients of the series.
fn series<D: Real>(grid: &Grid, count: usize, bends: &ArrayVec<D, MOST>) -> ArrayVec<D, MOST> {
    let sum = |row: &Vec<f64>| {
        let terms = row.iter().zip(bends);
        terms.fold(D::from(0.0), |sum, (weight, bend)| bend.scale_add(*weight, sum))
    };
    grid.series.iter().take(count).map(sum).collect()
}

/// The energy as a function of the radius.
struct Law<'a, D> {
    net: &'a Net<D>,
    formulas: &'a Formulas<D>,
    r_m: D,
    bulge: D,
    /// W'/r at mid-length.
    linear: D,
    /// W'' - W'/r there.
    at_middle: D,
}

impl<'a, D: Real> Law<'a, D> {
    fn of(net: &'a Net<D>, middle: &Middle<D>) -> Option<Self> {
        let r_m = net.end_radius + middle.bulge;
        let formulas = net.formulas.as_ref()?;
        let [[slope, bend]] = formulas.slopes(net.turn, [r_m], net.cos_rest)?;
        let linear = slope / r_m;
        Some(Self { net, formulas, r_m, bulge: middle.bulge, linear, at_middle: bend - linear })
    }

    /// W'' - W'(r_m)/r_m at every point of a grid besides mid-length, or at every other one.
    fn fill(&self, grid: &Grid, step: usize, bends: &mut [D]) -> Option<()> {
        for first in (1..grid.places.len()).step_by(step * BLOCK) {
            let place = |k: usize| first + k * step;
            let r = std::array::from_fn::<_, BLOCK, _>(|k| self.r_m - self.bulge * grid.places[place(k)]);
            let slopes = self.formulas.slopes(self.net.turn, r, self.net.cos_rest)?;
            for (k, [_, bend]) in slopes.into_iter().enumerate() {
                bends[place(k)] = bend - self.linear;
            }
        }
        Some(())
    }
}
