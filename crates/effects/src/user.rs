//! User-defined effects: a TOML file with a formula and its parameters. The formula is either an added force
//! or a change of the shape: the energy of the wall, the area on which the pressure acts, or the turn of the
//! fibres.

mod act;
mod quantity;
mod reader;
mod shape;

pub use shape::{ShapeFormula, ShapeQuantity};

use crate::expression::Expression;
use crate::mechanism::{Form, Mechanism};
use bulge_muscles::settings::{Document, FileKind};
use bulge_muscles::{Dimension, FileError};
use std::path::Path;

/// The file of effects in messages.
pub const KIND: FileKind = FileKind { name: "effects", file: "effects.toml", line: "force = \"-k * eps\"" };
/// The largest number of parameters of an effect.
pub const MAX_PARAMETERS: usize = 12;

/// The shortest possible file of effects.
pub const EXAMPLE: &str = "\
[effects.hose-stiffness]
title = \"Hose pulls on the muscle\"
force = \"-k * (eps - eps_free)\"          # added to the force of the muscle, in N
parameters.k = { unit = \"N\", typical = \"50 N\", low = \"0 N\", high = \"500 N\", prior = \"50 N +- 30 N\" }
parameters.eps_free = { unit = \"1\", typical = 0.1, low = -0.1, high = 0.4 }
";

/// A user-defined rubber in the wall of a braid. It is neo-Hookean: energy per area at rest as a function of
/// the stretches l1 along the meridian and l2 around it.
pub const SHAPE_EXAMPLE: &str = "\
[effects.my-rubber]
title = \"Neo-Hookean rubber\"
energy = \"h * c10 * (l1^2 + l2^2 + 1/(l1*l2)^2 - 3)\"          # in N/m: J per m^2 of the wall at rest
parameters.c10 = { unit = \"MPa\", typical = \"0.3 MPa\", low = \"0 MPa\", high = \"3 MPa\" }
parameters.h = { unit = \"mm\", typical = \"2 mm\", low = \"0.5 mm\", high = \"5 mm\" }
";

/// The formula of a user-defined effect.
#[derive(Debug, Clone, PartialEq)]
pub enum UserFormula {
    /// A force \[N\] added to that of the muscle, as a function of [`crate::expression::VARIABLES`].
    Force(Expression),
    /// A change of the shape, as a function of [`crate::expression::SHAPE_VARIABLES`].
    Shape(ShapeFormula),
}

impl UserFormula {
    /// The formula itself.
    #[must_use]
    pub fn expression(&self) -> &Expression {
        match self {
            Self::Force(expression) => expression,
            Self::Shape(formula) => &formula.expression,
        }
    }
}

/// A physical effect that a file defines by a formula.
#[derive(Debug, Clone, PartialEq)]
pub struct UserEffect {
    /// The name, in lower-case words with hyphens.
    pub name: String,
    /// The title in reports.
    pub title: String,
    /// The physical process.
    pub about: Option<String>,
    /// The source of the formula.
    pub source: Option<String>,
    /// The family of effects that it belongs to.
    pub family: Option<String>,
    /// The mechanism: the stated one, or that of the family if the catalogue has it, or [`Mechanism::User`].
    pub mechanism: Mechanism,
    /// How exact the formula can be; loose if not stated.
    pub form: Form,
    /// Names of effects that a measurement may confuse with this one.
    pub twins: Vec<String>,
    /// The formula, as a function of the parameters in their order.
    pub formula: UserFormula,
    /// The parameters in the order of the file, from 1 to [`MAX_PARAMETERS`].
    pub parameters: Vec<UserParameter>,
}

/// A parameter of a user-defined effect. Numbers are in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct UserParameter {
    /// The name in the formula.
    pub name: String,
    /// The unit in which it is shown, as written in the file.
    pub unit: String,
    /// The size of that unit in SI.
    pub factor: f64,
    /// The dimension.
    pub dimension: Dimension,
    /// A usual value, `low <= typical <= high`.
    pub typical: f64,
    /// The smallest possible value.
    pub low: f64,
    /// The largest possible value, `low < high`.
    pub high: f64,
    /// Prior mean (within the bounds) and standard deviation (> 0).
    pub prior: Option<(f64, f64)>,
    /// A description.
    pub about: Option<String>,
}

/// Reads a file of effects.
///
/// # Errors
/// If the file can't be read, is larger than 1 MiB, is not UTF-8, or contains an error. The message is
/// complete.
pub fn read(path: impl AsRef<Path>) -> Result<Vec<UserEffect>, FileError> {
    let path = path.as_ref();
    from_toml(&KIND.read(path)?, &path.display().to_string())
}

/// Reads effects from TOML text. Messages call the text by the name `origin`, usually a file name.
///
/// ```
/// use bulge_effects::user;
/// let effects = user::from_toml(user::EXAMPLE, "effects.toml")?;
/// assert_eq!(effects[0].name, "hose-stiffness");
/// assert_eq!(effects[0].parameters[0].prior, Some((50.0, 30.0)));
///
/// let error = user::from_toml(&user::EXAMPLE.replace("eps -", "p -"), "effects.toml").unwrap_err();
/// assert_eq!((error.line(), error.column()), (Some(3), Some(16)));
/// assert_eq!(error.what(), "`eps_free` (1) cannot be subtracted from `p` (Pa)");
/// # Ok::<(), bulge_muscles::FileError>(())
/// ```
///
/// # Errors
/// With the place and the cure, if the text is larger than 1 MiB, is not TOML, defines no effect, or defines
/// one that is incomplete or inconsistent.
pub fn from_toml(text: &str, origin: &str) -> Result<Vec<UserEffect>, FileError> {
    reader::effects(&Document::parse(KIND, text, origin)?)
}

#[cfg(test)]
mod tests;
