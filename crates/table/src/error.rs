//! Errors of reading a table: the bytes are no table, or it has another shape than requested.

use core::fmt;

/// What is wrong with the bytes of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableError {
    /// Fewer bytes than the smallest table has, or than the header says.
    Truncated {
        /// Bytes given.
        found: usize,
        /// Bytes needed.
        needed: usize,
    },
    /// The first eight bytes aren't those of a table.
    NoTable,
    /// A version of the format that this library doesn't know.
    Version {
        /// The version.
        found: u16,
    },
    /// The checksum doesn't match the bytes: they are damaged.
    Checksum {
        /// The checksum stored.
        stored: u64,
        /// The checksum of the bytes.
        computed: u64,
    },
    /// The checksum matches, but a field has an impossible value: the program that wrote the table has a
    /// fault.
    Malformed {
        /// The field.
        field: &'static str,
    },
    /// Another number of axes or outputs than requested.
    Shape {
        /// Axes of the table.
        axes: usize,
        /// Outputs of the table.
        outputs: usize,
    },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Truncated { found, needed } => {
                write!(f, "the table is truncated: it has {found} bytes of at least {needed}")
            }
            Self::NoTable => f.write_str("this is no table: it doesn't begin with `BulgeTab`"),
            Self::Version { found } => {
                write!(f, "this table has version {found} of the format; only version 1 is known")
            }
            Self::Checksum { stored, computed } => {
                write!(
                    f,
                    "the table is damaged: its checksum is {stored:016x}, that of its bytes {computed:016x}"
                )
            }
            Self::Malformed { field } => write!(f, "the table is malformed: its {field} makes no sense"),
            Self::Shape { axes, outputs } => {
                write!(f, "the table has {axes} axes and {outputs} outputs: ask for as many")
            }
        }
    }
}

impl core::error::Error for TableError {}
