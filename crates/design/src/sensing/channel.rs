//! The channel on a surface: length, stretch, section and resistance.

use bulge_numerics::gauss;
use serde::Serialize;
use std::f64::consts::TAU;

use super::SensingError;
use super::surface::{Element, Surface};
use super::winding::{Layer, Winding};

/// Most Newton steps for the thickness of a layer; four are usual.
const MOST_STEPS: usize = 60;
/// Relative size of the last Newton step.
const LAST_STEP: f64 = 1e-14;

/// A winding at one contraction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reading {
    /// Gauge pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contraction (l0 - l)/l0 \[-\].
    pub contraction: f64,
    /// Distance between the end fittings \[m\].
    pub muscle_length_m: f64,
    /// Length L of the channel \[m\].
    pub channel_length_m: f64,
    /// Resistance R \[ohm\].
    pub resistance_ohm: f64,
    /// R/R0 - 1 \[-\], with R0 in the reference.
    pub relative_change: f64,
    /// R0 (L/L0)^2 \[ohm\]: the resistance if the stretch were uniform along the channel.
    pub uniform_resistance_ohm: f64,
    /// L/L0 \[-\].
    pub mean_stretch: f64,
    /// Largest strain lambda - 1 along the channel \[-\], at the points of the meridian and of the quadrature.
    pub largest_strain: f64,
    /// Position of the largest strain, as a fraction of the fibre length.
    pub largest_strain_at: f64,
    /// Smallest strain \[-\]; negative if the channel is compressed.
    pub smallest_strain: f64,
    /// Smallest section A0/lambda \[m^2\].
    pub smallest_section_m2: f64,
    /// Liquid in the channel, the integral of A dL \[m^3\]: the same at every contraction.
    pub liquid_m3: f64,
}

/// One point of the channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChannelPoint {
    /// Fraction of the unstretched fibre length from the left fitting.
    pub s: f64,
    /// Angle about the axis \[rad\], 0 at the start.
    pub angle_rad: f64,
    /// Distance from the left fitting along the axis \[m\].
    pub x_m: f64,
    /// Distance from the axis \[m\].
    pub radius_m: f64,
    /// Stretch lambda of the channel \[-\]; its strain is lambda - 1.
    pub stretch: f64,
    /// Section A0/lambda \[m^2\].
    pub section_m2: f64,
}

/// Integrals over the channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Totals {
    /// L and L0 \[m\].
    pub(super) length: f64,
    pub(super) length_0: f64,
    /// int lambda dL \[m\].
    pub(super) stretched: f64,
    /// int dL/lambda \[m\].
    pub(super) unstretched: f64,
    /// Meridian of the zone in the reference \[m\].
    pub(super) meridian_0: f64,
    /// Largest stretch and its position.
    pub(super) largest: [f64; 2],
    pub(super) smallest: f64,
}

/// A winding on a surface, with the surface of its reference.
#[derive(Debug, Clone, Copy)]
pub(super) struct Channel<'a> {
    pub(super) winding: &'a Winding,
    pub(super) surface: &'a Surface,
    pub(super) reference: &'a Surface,
    /// Whole unstretched fibre length \[m\].
    pub(super) fibre: f64,
}

/// The channel at one position: radius, meridian and length per unstretched fibre length, on the surface and
/// in the reference.
#[derive(Debug, Clone, Copy)]
struct Local {
    rho: f64,
    length: f64,
    meridian_0: f64,
    length_0: f64,
    thickness: f64,
    psi: f64,
    x: f64,
}

impl Channel<'_> {
    /// theta' \[rad/m\].
    fn turning(&self) -> f64 {
        TAU * self.winding.turns / (self.winding.width() * self.fibre)
    }

    fn local(&self, at: f64) -> Result<Local, SensingError> {
        let (offset, turning) = (self.winding.offset_m, self.turning());
        let folded = || {
            SensingError::Input(format!(
                "a channel {:.4} mm outside the fibres has no place at {:.2} % of the fibre length: the muscle is too sharply waisted there; take a thinner layer",
                1e3 * offset,
                100.0 * at
            ))
        };
        let (now, then) = (self.surface.at(at), self.reference.at(at));
        let [rho_0, meridian_0] = lifted(&then, offset).ok_or_else(folded)?;
        let thickness = match self.winding.layer {
            Layer::Kept => offset,
            Layer::Thinning => thinned(&now, &then, offset).ok_or_else(folded)?,
        };
        let [rho, meridian] = lifted(&now, thickness).ok_or_else(folded)?;
        let [length, length_0] = [[rho, meridian], [rho_0, meridian_0]].map(|[r, a]| (turning * r).hypot(a));
        Ok(Local { rho, length, meridian_0, length_0, thickness, psi: now.psi, x: now.x })
    }

    /// Integrals by six Gauss points on each piece on which the surface is a single polynomial.
    pub(super) fn totals(&self) -> Result<Totals, SensingError> {
        let edges = self.surface.pieces(self.winding.start, self.winding.end);
        let mut sums = [0.0; 5];
        let mut largest = [f64::NEG_INFINITY, 0.0];
        let mut smallest = f64::INFINITY;
        let mut seen = |stretch: f64, at: f64| {
            if stretch > largest[0] {
                largest = [stretch, at];
            }
            smallest = smallest.min(stretch);
        };
        for edge in &edges {
            let local = self.local(*edge)?;
            seen(local.length / local.length_0, *edge);
        }
        for pair in edges.windows(2) {
            let width = pair[1] - pair[0];
            for (node, weight) in gauss::SIX {
                let at = pair[0] + width * node;
                let local = self.local(at)?;
                let stretch = local.length / local.length_0;
                seen(stretch, at);
                let integrands = [
                    local.length,
                    local.length_0,
                    stretch * local.length,
                    local.length / stretch,
                    local.meridian_0,
                ];
                for (sum, integrand) in sums.iter_mut().zip(integrands) {
                    *sum += weight * width * self.fibre * integrand;
                }
            }
        }
        let [length, length_0, stretched, unstretched, meridian_0] = sums;
        Ok(Totals { length, length_0, stretched, unstretched, meridian_0, largest, smallest })
    }

    /// Points of the channel, equally spaced in s.
    pub(super) fn points(&self, count: usize) -> Result<Vec<ChannelPoint>, SensingError> {
        let Winding { start, end, turns, section_m2, .. } = *self.winding;
        let point = |i: usize| {
            let part = i as f64 / (count - 1) as f64;
            let s = if i + 1 == count { end } else { start + (end - start) * part };
            let local = self.local(s)?;
            let stretch = local.length / local.length_0;
            Ok(ChannelPoint {
                s,
                angle_rad: TAU * turns * part,
                x_m: local.x - local.thickness * local.psi.sin(),
                radius_m: local.rho,
                stretch,
                section_m2: section_m2 / stretch,
            })
        };
        (0..count).map(point).collect()
    }
}

/// Radius and meridian per unstretched fibre length at a distance outside the fibres; `None` if the parallel
/// surface folds.
fn lifted(element: &Element, distance: f64) -> Option<[f64; 2]> {
    let rho = element.r + distance * element.psi.cos();
    let meridian = element.sigma - distance * element.bend;
    (rho > 0.0 && meridian > 0.0).then_some([rho, meridian])
}

/// Volume of the layer up to a distance, per angle about the axis and per unstretched fibre length, and its
/// derivative by the distance.
fn layer_volume(element: &Element, distance: f64) -> [f64; 2] {
    let Element { r, psi, sigma, bend, .. } = *element;
    let (cos, t) = (psi.cos(), distance);
    let volume = sigma * r * t + (sigma * cos - r * bend) * t * t / 2.0 - bend * cos * t * t * t / 3.0;
    [volume, (r + t * cos) * (sigma - t * bend)]
}

/// The distance at which the layer has the same volume as in the reference; `None` if there is no room for
/// it.
fn thinned(now: &Element, then: &Element, offset: f64) -> Option<f64> {
    if offset == 0.0 {
        return Some(0.0);
    }
    let [wanted, _] = layer_volume(then, offset);
    // Start: a thin layer thins in inverse proportion to the area of the surface.
    let mut t = offset * then.r * then.sigma / (now.r * now.sigma);
    for _ in 0..MOST_STEPS {
        let [volume, slope] = layer_volume(now, t);
        let step = (wanted - volume) / slope;
        // Beyond a fold the volume decreases again.
        if !step.is_finite() || slope <= 0.0 {
            return None;
        }
        t = (t + step).max(0.5 * t);
        if step.abs() <= LAST_STEP * t {
            return Some(t);
        }
    }
    None
}
