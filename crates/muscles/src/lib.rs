//! Pneumatic artificial muscles as data: pleated and braided muscles, materials, instruments and units, from
//! TOML.
//!
//! A muscle is a value that is always valid: constructors check, fields are private, and a change gives a new
//! muscle or an error. Quantities carry their dimension and are read and written in any of its units; inside
//! they are SI.
//!
//! ```
//! use bulge_muscles::{Force, Length, Parameter, from_toml};
//!
//! let text = r#"
//! name = "second-generation PPAM"
//! kind = "pleated"
//! length = "110 mm +- 0.2 mm"
//! radius = "16 mm"
//! fibres = 40
//! fibre = { stiffness = "12 kN", section = "0.3 mm^2" }
//!
//! [instruments]
//! force = { noise = "4 N", zero = "1 N", gain = "0.1 %" }
//! "#;
//! let muscle = from_toml(text, "muscle.toml")?;
//! assert_eq!(muscle.length(), Length::mm(110.0));
//! assert_eq!(muscle.fibre().map(|fibre| fibre.stiffness()), Some(Force::kn(12.0)));
//! assert_eq!(muscle.width(Parameter::Length), Some(0.0002));
//!
//! // What a file gets wrong is answered with its place and its cure.
//! let error = from_toml(&text.replace("length", "lenght"), "muscle.toml").unwrap_err();
//! assert_eq!((error.line(), error.instead()), (Some(4), "did you mean `length`?"));
//! # Ok::<(), bulge_muscles::FileError>(())
//! ```
//!
//! Deliberately absent: pressure, contraction and force. They are the state of a muscle, not the muscle.

mod construction;
mod data_columns;
mod digits;
mod dimension;
mod doubt;
mod error;
mod example;
mod fault;
mod file;
mod file_error;
mod file_kind;
mod fitted;
mod instrument;
mod json;
mod keys;
mod learnt;
mod learnt_table;
mod material;
pub mod memory;
mod muscle;
pub mod output;
mod parameter;
mod presets;
mod quantity;
pub mod settings;
pub mod shown;
mod specimen;
mod unit_error;
mod unit_expression;
mod unit_table;
pub mod units;
mod write;

pub use construction::{Braided, Construction, Ends, FibreCount, Kind, Pleated};
pub use dimension::Dimension;
pub use doubt::{USUAL_WIDTHS, UsualWidth};
pub use error::{MuscleError, check};
pub use example::{BRAIDED_EXAMPLE, PLEATED_EXAMPLE};
pub use fault::Fault;
pub use file::{from_toml, read};
pub use file_error::FileError;
pub use fitted::{FittedNumber, FittedNumbers};
pub use instrument::{Instrument, Instruments};
pub use learnt::{Learnt, LearntValue};
pub use material::Fibre;
pub use muscle::Muscle;
pub use parameter::Parameter;
pub use presets::{PRESETS, Preset, PresetError, preset};
pub use quantity::{Angle, Area, Force, Length, LineStiffness, Pressure, Ratio, Time, Volume};
pub use specimen::Specimen;
pub use units::{Quantity, UnitError};
pub use write::to_toml;
