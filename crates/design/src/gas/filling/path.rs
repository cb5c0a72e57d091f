//! Interpolated states of a chamber as functions of the pressure, because an integration needs thousands of
//! them.
//!
//! On a panel of pressures, contraction, force and volume are polynomials of degree 16 through equilibria at
//! Chebyshev points. A panel is halved if its polynomials miss an equilibrium between the points by more than
//! 1e-10. After ten halvings, or if equilibria are missing, each state is solved.

use std::cell::{Cell, RefCell};

use crate::gas::GasError;
use crate::gas::chamber::{Chamber, Inside, LEAST_PRESSURE_PA};

/// Degree of the polynomials.
const DEGREE: usize = 16;
/// Largest misfit, relative for volume and force, absolute for the contraction.
const MISFIT: f64 = 1e-10;
/// Most halvings of a panel.
const DEPTH: u32 = 10;
/// Positions on a panel, from -1 to 1, at which the polynomials are tested: between points, near the ends and
/// near the middle.
const TRIED: [f64; 3] = [-0.991, 0.094, 0.829];

/// Contraction, force, volume.
type Values = [f64; 3];

#[derive(Debug)]
enum Panel {
    Unknown,
    Polynomial(Box<[Values; DEGREE + 1]>),
    Halves(Box<[Panel; 2]>),
    Direct,
}

/// A chamber with its interpolated states.
#[derive(Debug)]
pub(super) struct Path<'a> {
    chamber: &'a Chamber<'a>,
    /// Largest gauge pressure that is interpolated.
    most: f64,
    /// Panels off the support and on it.
    panels: [RefCell<Panel>; 2],
    near: Cell<Option<f64>>,
}

impl<'a> Path<'a> {
    /// A path for gauge pressures up to `most`.
    pub(super) const fn new(chamber: &'a Chamber<'a>, most: f64) -> Self {
        let panels = [RefCell::new(Panel::Unknown), RefCell::new(Panel::Unknown)];
        Self { chamber, most, panels, near: Cell::new(None) }
    }

    pub(super) fn inside(&self, pressure_pa: f64, resting: bool) -> Result<Inside, GasError> {
        let low = LEAST_PRESSURE_PA;
        if self.chamber.is_vessel() || !(pressure_pa > low && pressure_pa <= self.most) {
            return self.solved(pressure_pa, resting);
        }
        let mut panel = self.panels[usize::from(resting)].borrow_mut();
        if let Some([contraction, force_n, volume_m3]) =
            self.value(&mut panel, [low, self.most], pressure_pa, resting, 0)
        {
            let gas_volume_m3 = volume_m3 + self.chamber.dead_volume_m3();
            return Ok(Inside { pressure_pa, contraction, force_n, volume_m3, gas_volume_m3 });
        }
        self.solved(pressure_pa, resting)
    }

    fn solved(&self, pressure_pa: f64, resting: bool) -> Result<Inside, GasError> {
        let found = self.chamber.inside(pressure_pa, resting, self.near.get())?;
        if !resting {
            self.near.set(Some(found.contraction));
        }
        Ok(found)
    }

    fn value(
        &self,
        panel: &mut Panel,
        range @ [low, high]: [f64; 2],
        p: f64,
        resting: bool,
        depth: u32,
    ) -> Option<Values> {
        if matches!(panel, Panel::Unknown) {
            *panel = match self.fitted(range, resting) {
                Some(polynomial) => Panel::Polynomial(Box::new(polynomial)),
                None if depth < DEPTH => Panel::Halves(Box::new([Panel::Unknown, Panel::Unknown])),
                None => Panel::Direct,
            };
        }
        match panel {
            Panel::Polynomial(values) => Some(interpolated(values, (2.0 * p - low - high) / (high - low))),
            Panel::Halves(halves) => {
                let middle = 0.5 * (low + high);
                let [below, above] = halves.as_mut();
                if p < middle {
                    self.value(below, [low, middle], p, resting, depth + 1)
                } else {
                    self.value(above, [middle, high], p, resting, depth + 1)
                }
            }
            Panel::Direct | Panel::Unknown => None,
        }
    }

    fn fitted(&self, [low, high]: [f64; 2], resting: bool) -> Option<[Values; DEGREE + 1]> {
        let at = |x: f64| {
            let found = self.solved(0.5 * (low + high) + 0.5 * (high - low) * x, resting).ok()?;
            Some([found.contraction, found.force_n, found.volume_m3])
        };
        let mut values = [[0.0; 3]; DEGREE + 1];
        for (k, value) in values.iter_mut().enumerate() {
            *value = at(point(k))?;
        }
        for x in TRIED {
            let (exact, found) = (at(x)?, interpolated(&values, x));
            let scales = [1.0, exact[1].abs().max(1e-3), exact[2]];
            let good = (0..3).all(|i| (exact[i] - found[i]).abs() <= MISFIT * scales[i]);
            if !good {
                return None;
            }
        }
        Some(values)
    }
}

/// Chebyshev points from -1 to 1, including the ends.
fn point(k: usize) -> f64 {
    -(std::f64::consts::PI * k as f64 / DEGREE as f64).cos()
}

/// Barycentric interpolation (J.-P. Berrut, L. N. Trefethen, SIAM Review 46, 2004) with weights (-1)^k,
/// halved at the ends.
fn interpolated(values: &[Values; DEGREE + 1], x: f64) -> Values {
    let (mut sum, mut weights) = ([0.0; 3], 0.0);
    for (k, value) in values.iter().enumerate() {
        let gap = x - point(k);
        if gap == 0.0 {
            return *value;
        }
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let weight = if k == 0 || k == DEGREE { 0.5 * sign } else { sign } / gap;
        weights += weight;
        for (total, part) in sum.iter_mut().zip(value) {
            *total += weight * part;
        }
    }
    sum.map(|total| total / weights)
}
