//! The plan of a sweep: axes, design, outputs and table, as a sweep file states them. Plans are plain values;
//! [`Plan::read`] reads them and [`crate::run`] runs them.

use bulge_effects::{Catalogue, user};
use bulge_fibre::Approach;
use bulge_muscles::{FileError, Muscle, Parameter};
use serde::Serialize;

use crate::output::Output;

/// Quantity varied by an axis.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Contraction (l0 - l)/l0 \[-\].
    Contraction,
    /// Gauge pressure \[Pa\].
    Pressure,
    /// Slenderness l0/R \[-\]: the radius changes, the length stays constant.
    Slenderness,
    /// Elastic group p sin(2 pi/n) R^2/EA of one fibre \[-\]: it determines the fibre stiffness.
    ElasticGroup,
    /// A parameter of the muscle, in SI.
    Parameter(Parameter),
    /// A number of an effect that the muscle file states, in SI.
    Effect {
        /// Name of the effect.
        effect: String,
        /// Key in its table.
        key: String,
    },
}

impl Quantity {
    /// The quantity that a name in a sweep file varies; none if the muscle doesn't have it.
    #[must_use]
    pub fn named(name: &str, muscle: &Muscle) -> Option<Self> {
        crate::file::quantity(name, muscle).map(|(quantity, _, _)| quantity)
    }
}

/// Spacing of the points of a grid between the ends of an axis, and of the fractions of a random design.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Spacing {
    /// Equal differences.
    Linear,
    /// Equal ratios; both ends > 0.
    Log,
    /// Chebyshev points of the second kind (Gauss-Lobatto): both ends, and cosines between them.
    Chebyshev,
}

/// Upper end of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// A value in SI.
    Value(f64),
    /// The contraction at which the force of the muscle vanishes. Only for the contraction axis.
    Limit,
}

/// Source of the values of an axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Range {
    /// Values between two ends. Grids need `points`; it is absent if only a table is wanted.
    Between {
        /// Lower end in SI.
        from: f64,
        /// Upper end.
        to: End,
        /// Number of values.
        points: Option<u64>,
        /// Their spacing.
        spacing: Spacing,
    },
    /// A list of values in SI.
    List(Vec<f64>),
}

/// One axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    /// The varied quantity.
    pub quantity: Quantity,
    /// Its name in columns and tables.
    pub name: String,
    /// SI unit of its values; "1" for a pure number.
    pub unit: String,
    /// Its values.
    pub range: Range,
}

/// Arrangement of the points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Design {
    /// All combinations of the values of the axes. The contraction varies fastest, then the axes from the
    /// last to the first.
    Grid,
    /// Independent, uniformly distributed points.
    Random {
        /// Number of points.
        points: u64,
        /// Seed.
        seed: u64,
    },
    /// Sobol's low-discrepancy sequence (without its first point, the corner).
    Sobol {
        /// Number of points.
        points: u64,
    },
    /// A Latin hypercube: every axis is divided into `points` equal layers, and each layer holds one point.
    LatinHypercube {
        /// Number of points.
        points: u64,
        /// Seed.
        seed: u64,
    },
}

/// Requested form of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TableForm {
    /// Cubic B-splines if they fit the size limit, otherwise Chebyshev polynomials.
    Fastest,
    /// The smaller of the two.
    Smallest,
    /// Cubic B-splines.
    Splines,
    /// Chebyshev polynomials.
    Chebyshev,
}

/// Requirements on a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableRequirements {
    /// Outputs of the table.
    pub outputs: Vec<Output>,
    /// Largest relative error of the values.
    pub tolerance: f64,
    /// Largest relative error of the gradients.
    pub gradient: f64,
    /// Largest size in bytes.
    pub max_bytes: u64,
    /// Its form.
    pub form: TableForm,
    /// Number of points off the grid at which the table is certified.
    pub checks: u64,
}

/// A sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plan {
    /// Its name.
    pub name: String,
    /// The base muscle.
    pub muscle: Muscle,
    /// Effects defined by the user, which the muscle may state, as the TOML text of their file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub own_effects: Option<String>,
    /// Gauge pressure \[Pa\] where no axis varies it.
    pub pressure_pa: f64,
    /// Contraction where no axis varies it.
    pub contraction: Option<f64>,
    /// Method for the equilibria.
    #[serde(skip)]
    pub approach: Approach,
    /// The axes in the order of the file.
    pub axes: Vec<Axis>,
    /// Arrangement of the points; none if only a table is wanted.
    pub design: Option<Design>,
    /// Outputs computed at each point.
    pub outputs: Vec<Output>,
    /// Number of points of a chunk.
    pub chunk: u64,
    /// The table, if one is wanted.
    pub table: Option<TableRequirements>,
}

impl Plan {
    /// The effects that the muscle may state: those of the catalogue and those of the user.
    ///
    /// # Errors
    /// If the text of the user's effects defines no effects, or uses names of the catalogue.
    pub fn catalogue(&self) -> Result<Catalogue, FileError> {
        catalogue(self.own_effects.as_deref(), "effects")
    }
}

/// The catalogue with the effects of a file. Messages call that file `origin`.
pub(crate) fn catalogue(own: Option<&str>, origin: &str) -> Result<Catalogue, FileError> {
    let mut catalogue = Catalogue::builtin();
    for effect in own.map_or(Ok(Vec::new()), |text| user::from_toml(text, origin))? {
        catalogue = catalogue
            .with(effect)
            .map_err(|error| FileError::whole(origin, error.to_string(), "rename the effect"))?;
    }
    Ok(catalogue)
}
