//! User-defined effects: a TOML file with a formula and its parameters. The formula is either an added force
//! or a change of the shape: the energy of the wall, the area on which the pressure acts, or the turn of the
//! fibres.

mod act;
mod quantity;
mod reader;
mod shape;
mod value;

pub use shape::{ShapeFormula, ShapeQuantity};

use crate::expression::Expression;
use crate::mechanism::{Form, Mechanism};
use bulge_muscles::{Dimension, FileError};
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::ops::Range;
use std::path::Path;
use thiserror::Error;
use toml::de::DeTable;

/// The largest size of a file of effects, in bytes.
pub const MAX_BYTES: usize = 1 << 20;
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

/// An error in a file of effects. Its `Display` is the whole message, with the line and the cure.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{message}")]
pub struct EffectFileError {
    message: FileError,
}

impl From<EffectFileError> for FileError {
    fn from(error: EffectFileError) -> Self {
        error.message
    }
}

impl EffectFileError {
    /// The name of the file.
    #[must_use]
    pub fn origin(&self) -> &str {
        self.message.origin()
    }

    /// The line, counted from 1; none if the file couldn't be read.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        self.message.line()
    }

    /// The column in characters, counted from 1.
    #[must_use]
    pub fn column(&self) -> Option<usize> {
        self.message.column()
    }

    /// The error in one sentence.
    #[must_use]
    pub fn what(&self) -> &str {
        self.message.what()
    }

    /// The correction to make.
    #[must_use]
    pub fn instead(&self) -> &str {
        self.message.instead()
    }
}

/// Reads a file of effects.
///
/// # Errors
/// If the file can't be read, is larger than [`MAX_BYTES`], is not UTF-8, or contains an error.
pub fn read(path: impl AsRef<Path>) -> Result<Vec<UserEffect>, EffectFileError> {
    let path = path.as_ref();
    let origin = path.display().to_string();
    let bytes = read_bytes(path).map_err(|(what, instead)| whole(&origin, what, instead))?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        // The bytes up to `at` are valid, so the replacement character stands exactly there.
        let text = String::from_utf8_lossy(error.as_bytes());
        let instead = "save the file as plain text with the encoding UTF-8";
        located(&origin, &text, at..at + 1, format!("byte {at} is not UTF-8 text"), instead)
    })?;
    from_toml(&text, &origin)
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
/// # Ok::<(), user::EffectFileError>(())
/// ```
///
/// # Errors
/// With the place and the cure, if the text is larger than [`MAX_BYTES`], is not TOML, defines no effect, or
/// defines one that is incomplete or inconsistent.
pub fn from_toml(text: &str, origin: &str) -> Result<Vec<UserEffect>, EffectFileError> {
    if text.len() > MAX_BYTES {
        let (what, instead) = too_large();
        return Err(whole(origin, what, instead));
    }
    let root = DeTable::parse(text).map_err(|error| syntax_error(text, origin, &error))?;
    reader::effects(text, origin, root.get_ref())
}

fn whole(origin: &str, what: impl Into<String>, instead: impl Into<String>) -> EffectFileError {
    EffectFileError { message: FileError::whole(origin, what, instead) }
}

fn located(
    origin: &str,
    text: &str,
    span: Range<usize>,
    what: impl Into<String>,
    instead: impl Into<String>,
) -> EffectFileError {
    EffectFileError { message: FileError::at(origin, text, span, what, instead) }
}

type Complaint = (String, String);

fn read_bytes(path: &Path) -> Result<Vec<u8>, Complaint> {
    let name_one = || "name a file of effects, such as `effects.toml`".to_owned();
    let failed = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => {
            ("there is no such file".to_owned(), "check the path and the working directory".to_owned())
        }
        ErrorKind::PermissionDenied => {
            ("the file may not be read".to_owned(), "check its permissions, or copy it".to_owned())
        }
        _ => (format!("the file cannot be read: {error}"), name_one()),
    };
    if path.is_dir() {
        return Err(("this is a directory, not a file of effects".to_owned(), name_one()));
    }
    let limit = u64::try_from(MAX_BYTES).unwrap_or(u64::MAX).saturating_add(1);
    let mut bytes = Vec::new();
    File::open(path).map_err(failed)?.take(limit).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() > MAX_BYTES { Err(too_large()) } else { Ok(bytes) }
}

fn too_large() -> Complaint {
    let what = format!("the file is larger than {} KiB, so it is no file of effects", MAX_BYTES >> 10);
    (what, "name a file of effects: about ten lines of TOML for each effect".to_owned())
}

fn syntax_error(text: &str, origin: &str, error: &toml::de::Error) -> EffectFileError {
    let message = error.message().lines().collect::<Vec<_>>().join(", ");
    let instead = if message.contains("duplicate key") {
        "state each effect and each key once: delete one of the two, or rename it"
    } else {
        "each line is `key = value`, a `[table]` or a `# comment`, such as `force = \"-k * eps\"`; text stands in quotes"
    };
    located(origin, text, error.span().unwrap_or(0..0), format!("this is not TOML: {message}"), instead)
}

#[cfg(test)]
mod tests;
