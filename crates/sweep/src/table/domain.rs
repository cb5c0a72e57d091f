//! A field with its coordinates and its fitted edge. Together they convert between points and unit
//! coordinates.

use bulge_table::Form;

use super::coordinate::{Coordinates, coordinates, point_of, reduced};
use super::edge::Edge;
use super::field::{Field, NoValue};

/// Fraction of the tolerance that the edge may take.
const OF_TOLERANCE: f64 = 0.2;
/// The edge may take the size limit divided by this number.
const OF_SIZE: usize = 4;

/// A field, its coordinates and its edge; see the module.
pub(crate) struct Domain<'a> {
    pub(crate) field: &'a dyn Field,
    pub(crate) coordinates: Coordinates,
    pub(crate) edge: Option<Edge>,
    /// Largest value on each axis.
    pub(crate) highs: Vec<f64>,
}

impl<'a> Domain<'a> {
    /// Chooses the coordinates of a field and fits its edge, for a table of the given tolerance and size.
    pub(crate) fn new(
        field: &'a dyn Field,
        form: Form,
        tolerance: f64,
        floor: f64,
        most_bytes: usize,
    ) -> Result<Self, NoValue> {
        let coordinates = coordinates(field, form)?;
        let mut highs: Vec<f64> = field.axes().iter().map(|axis| axis.high.unwrap_or(f64::NAN)).collect();
        let mut edge = None;
        if field.axes()[0].high.is_none() && field.axes().len() == 1 {
            // There are no other axes on which the end could depend.
            highs[0] = field.upper_end(&[])?;
        } else if field.axes()[0].high.is_none() {
            // The error of an output that vanishes at the edge is relative to a fraction `floor` of its
            // largest value.
            let wanted = OF_TOLERANCE * tolerance * floor;
            let fitted = Edge::fitted(field, &coordinates, wanted, most_bytes / OF_SIZE)?;
            highs[0] = fitted.high;
            edge = Some(fitted);
        }
        Ok(Self { field, coordinates, edge, highs })
    }

    /// The upper end of axis 0 at values of the other axes, from the polynomial of the edge.
    pub(crate) fn upper_end(&self, others: &[f64]) -> f64 {
        let fitted = |edge: &Edge| edge.upper_end(&self.coordinates, &self.highs, others);
        self.edge.as_ref().map_or(self.highs[0], fitted)
    }

    /// The point at unit coordinates.
    pub(crate) fn point(&self, unit: &[f64]) -> Result<Vec<f64>, NoValue> {
        point_of(self.field.axes(), &self.coordinates, unit, &|others| Ok(self.upper_end(others)))
    }

    /// The reduced outputs at unit coordinates inside (0, 1).
    pub(crate) fn reduced(&self, unit: &[f64], values: &mut [f64]) -> Result<(), NoValue> {
        reduced(self.field, &self.coordinates, unit, &|others| Ok(self.upper_end(others)), values)
    }

    /// Factors that make each coordinate 1 at the upper end. On a fitted axis any positive number would do.
    pub(crate) fn scales(&self) -> Vec<f64> {
        self.coordinates.axes.iter().zip(&self.highs).map(|(c, high)| 1.0 / c.q(*high)).collect()
    }
}
