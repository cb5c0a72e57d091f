//! What is swept: axes, design, outputs and table, as a sweep file states them. Plain values, read by [`Plan::read`] and run by [`crate::run`].

use bulge_effects::{Catalogue, user};
use bulge_fibre::Approach;
use bulge_muscles::{FileError, Muscle, Parameter};
use serde::Serialize;

use crate::output::Output;

/// What an axis varies.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Contraction (l0 - l)/l0 \[-\].
    Contraction,
    /// Gauge pressure \[Pa\].
    Pressure,
    /// l0/R: the radius changes, the length stays \[-\].
    Slenderness,
    /// p sin(2 pi/n) R^2/EA of one fibre: the fibre stiffness follows from it \[-\].
    ElasticGroup,
    /// A number of the muscle, SI.
    Parameter(Parameter),
    /// A number of an effect that the muscle file states, SI.
    Effect {
        /// Name of the effect.
        effect: String,
        /// Key in its table.
        key: String,
    },
}

impl Quantity {
    /// What a name of a sweep file varies, if the muscle has it.
    #[must_use]
    pub fn named(name: &str, muscle: &Muscle) -> Option<Self> {
        crate::file::quantity(name, muscle).map(|(quantity, _, _)| quantity)
    }
}

/// How the points of a grid lie between the ends, and how fractions of a random design are stretched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Spacing {
    /// Equal differences.
    Linear,
    /// Equal ratios; both ends > 0.
    Log,
    /// Chebyshev points of the second kind (Gauss-Lobatto): the ends and cosines between them.
    Chebyshev,
}

/// Upper end of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// A value in SI.
    Value(f64),
    /// The contraction at which this muscle's force vanishes; of the contraction alone.
    Limit,
}

/// Where the values of an axis come from.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Range {
    /// From an end to the other. `points` is needed by grids, and absent where only a table is wanted.
    Between {
        /// Lower end in SI.
        from: f64,
        /// Upper end.
        to: End,
        /// How many values.
        points: Option<u64>,
        /// How they are spaced.
        spacing: Spacing,
    },
    /// These, in SI.
    List(Vec<f64>),
}

/// One axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    /// What it varies.
    pub quantity: Quantity,
    /// Its name in columns and tables.
    pub name: String,
    /// SI unit of its values; "1" for a pure number.
    pub unit: String,
    /// Its values.
    pub range: Range,
}

/// Which points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Design {
    /// Every combination of the axes' values; the contraction varies fastest, then the axes from the last to the first.
    Grid,
    /// Independent uniform points.
    Random {
        /// How many.
        points: u64,
        /// Seed.
        seed: u64,
    },
    /// Sobol's low-discrepancy sequence (without its first point, the corner).
    Sobol {
        /// How many.
        points: u64,
    },
    /// A Latin hypercube: of `points` equal layers of every axis each holds one point.
    LatinHypercube {
        /// How many.
        points: u64,
        /// Seed.
        seed: u64,
    },
}

/// What form of table is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TableForm {
    /// Cubic B-splines where they fit the size limit, else Chebyshev polynomials.
    Fastest,
    /// Whichever is smaller.
    Smallest,
    /// Cubic B-splines.
    Splines,
    /// Chebyshev polynomials.
    Chebyshev,
}

/// What a table must reach.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableRequirements {
    /// Outputs of the table.
    pub outputs: Vec<Output>,
    /// Largest relative error of the values.
    pub tolerance: f64,
    /// Largest relative error of the gradients.
    pub gradient: f64,
    /// Most bytes.
    pub max_bytes: u64,
    /// Its form.
    pub form: TableForm,
    /// How many points off the grid certify it.
    pub checks: u64,
}

/// A sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plan {
    /// Its name.
    pub name: String,
    /// The muscle that is varied.
    pub muscle: Muscle,
    /// Effects of one's own that the muscle may state, as the TOML of their file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub own_effects: Option<String>,
    /// Gauge pressure \[Pa\] where no axis varies it.
    pub pressure_pa: f64,
    /// Contraction where no axis varies it.
    pub contraction: Option<f64>,
    /// How equilibria are computed.
    #[serde(skip)]
    pub approach: Approach,
    /// The axes in the order of the file.
    pub axes: Vec<Axis>,
    /// Which points; none if only a table is wanted.
    pub design: Option<Design>,
    /// What is computed at each.
    pub outputs: Vec<Output>,
    /// Points of one chunk.
    pub chunk: u64,
    /// The table, if one is wanted.
    pub table: Option<TableRequirements>,
}

impl Plan {
    /// The effects that the muscle may state: those of the catalogue, and one's own.
    ///
    /// # Errors
    /// If one's own are no effects, or have names of the catalogue.
    pub fn catalogue(&self) -> Result<Catalogue, FileError> {
        catalogue(self.own_effects.as_deref(), "effects")
    }
}

/// The catalogue with the effects of a file; `origin` is what messages call it.
pub(crate) fn catalogue(own: Option<&str>, origin: &str) -> Result<Catalogue, FileError> {
    let mut catalogue = Catalogue::builtin();
    for effect in own.map_or(Ok(Vec::new()), |text| user::from_toml(text, origin))? {
        catalogue = catalogue
            .with(effect)
            .map_err(|error| FileError::whole(origin, error.to_string(), "rename the effect"))?;
    }
    Ok(catalogue)
}
