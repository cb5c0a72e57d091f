//! The surface of a muscle in material coordinates: radius, slope and stretch at every fraction of the fibre length.

use bulge_fibre::Shape;

use super::SensingError;
use super::winding::FEWEST_POINTS;

/// Points of each interpolating polynomial.
const STENCIL: usize = 6;
/// Indices of the interpolated values.
const X: usize = 0;
const R: usize = 1;
const PSI: usize = 2;
const SIGMA: usize = 3;

/// Relative difference of fibre lengths from which a meridian belongs to another muscle.
const SAME: f64 = 1e-6;

/// A surface element of the fibre net.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Element {
    /// Axial position \[m\].
    pub(super) x: f64,
    /// Radius of the fibres \[m\].
    pub(super) r: f64,
    /// Slope of the meridian \[rad\].
    pub(super) psi: f64,
    /// Meridian per unstretched fibre length.
    pub(super) sigma: f64,
    /// dpsi/dS \[rad/m\].
    pub(super) bend: f64,
}

/// A muscle at rest or in equilibrium.
#[derive(Debug, Clone)]
pub(super) enum Surface {
    /// A cylinder: radius, meridian per unstretched fibre length, and whole unstretched fibre length.
    Cylinder { r: f64, sigma: f64, fibre: f64 },
    /// Points of a meridian: s, the values there, and the whole unstretched fibre length \[m\].
    Meridian { s: Vec<f64>, values: Vec<[f64; 4]>, fibre: f64 },
}

impl Surface {
    /// From an equilibrium of a muscle whose fibres have this unstretched length \[m\].
    pub(super) fn of_shape(shape: &Shape, fibre: f64) -> Result<Self, SensingError> {
        let why = |why| {
            Err(SensingError::Input(format!(
                "this meridian doesn't fit the winding: {why}; give a shape of the same muscle with at least 7 points"
            )))
        };
        if shape.meridian.len() < FEWEST_POINTS {
            return why("it has too few points");
        }
        let last = shape.meridian[shape.meridian.len() - 1].fibre_length_m;
        if (last / fibre - 1.0).abs() > SAME || last.is_nan() {
            return why("its fibres have another length");
        }
        // Scaled so that the fibre ends exactly at 1: its length may differ by rounding.
        let s: Vec<f64> = shape.meridian.iter().map(|point| point.fibre_length_m / last).collect();
        let values: Vec<[f64; 4]> = shape
            .meridian
            .iter()
            .map(|point| {
                let sigma = (1.0 + point.fibre_strain) * point.braid_angle_rad.cos();
                [point.x_m, point.r_m, point.slope_rad, sigma]
            })
            .collect();
        if !s.windows(2).all(|pair| pair[0] < pair[1]) || s[0].abs() > SAME {
            return why("its points don't follow each other along the fibre");
        }
        let good =
            |value: &[f64; 4]| value.iter().all(|v| v.is_finite()) && value[R] > 0.0 && value[SIGMA] > 0.0;
        if !values.iter().all(good) {
            return why("a point has no finite, positive radius or stretch");
        }
        Ok(Self::Meridian { s, values, fibre })
    }

    /// The element at a fraction of the fibre length.
    pub(super) fn at(&self, at: f64) -> Element {
        match self {
            Self::Cylinder { r, sigma, fibre } => {
                Element { x: at * fibre * sigma, r: *r, psi: 0.0, sigma: *sigma, bend: 0.0 }
            }
            Self::Meridian { s, values, fibre } => {
                let cell = s.partition_point(|node| *node <= at);
                let first = cell.saturating_sub(STENCIL / 2).min(s.len() - STENCIL);
                let (value, slope) = interpolate(&s[first..], &values[first..], at);
                Element {
                    x: value[X],
                    r: value[R],
                    psi: value[PSI],
                    sigma: value[SIGMA],
                    bend: slope[PSI] / fibre,
                }
            }
        }
    }

    /// Ends of a zone and the borders between polynomials inside it.
    pub(super) fn pieces(&self, start: f64, end: f64) -> Vec<f64> {
        let inner: &[f64] = match self {
            Self::Cylinder { .. } => &[],
            Self::Meridian { s, .. } => s,
        };
        let inner = inner.iter().copied().filter(|s| *s > start && *s < end);
        std::iter::once(start).chain(inner).chain(std::iter::once(end)).collect()
    }
}

/// Values and first derivatives at `at` of the polynomials of degree 5 through the first six points (Lagrange).
pub(super) fn interpolate<const N: usize>(
    nodes: &[f64],
    values: &[[f64; N]],
    at: f64,
) -> ([f64; N], [f64; N]) {
    let (mut value, mut slope) = ([0.0; N], [0.0; N]);
    for j in 0..STENCIL {
        // The product of the factors (at - x_k)/(x_j - x_k) and, by the product rule, its derivative.
        let (mut weight, mut weight_slope) = (1.0, 0.0);
        for k in (0..STENCIL).filter(|k| *k != j) {
            let width = nodes[j] - nodes[k];
            let factor = (at - nodes[k]) / width;
            weight_slope = weight_slope * factor + weight / width;
            weight *= factor;
        }
        for (i, y) in values[j].iter().enumerate() {
            value[i] += weight * y;
            slope[i] += weight_slope * y;
        }
    }
    (value, slope)
}
