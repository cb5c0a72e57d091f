//! Errors between a shape and a file on disk.

use std::path::PathBuf;

/// Why a VTK file wasn't written.
#[derive(Debug, thiserror::Error)]
pub enum VtkError {
    /// The meridian has fewer than two points.
    #[error("a surface needs at least 2 meridian points, the shape has {found}")]
    MeridianTooShort {
        /// Number of meridian points.
        found: usize,
    },
    /// A value of the shape is infinite or not a number.
    #[error("{quantity} is {value} at meridian point {station}: only finite values can be drawn")]
    NotFinite {
        /// Name of the quantity, with its unit.
        quantity: &'static str,
        /// Index of the meridian point.
        station: usize,
        /// The value found.
        value: f64,
    },
    /// A value of the shape as a whole is infinite or not a number.
    #[error("{quantity} is {value}: only finite values can be written")]
    ResponseNotFinite {
        /// Name of the quantity, with its unit.
        quantity: &'static str,
        /// The value found.
        value: f64,
    },
    /// A radius that isn't positive.
    #[error("the radius is {radius_m} m at meridian point {station}: it must be positive")]
    Radius {
        /// Index of the meridian point.
        station: usize,
        /// The radius found \[m\].
        radius_m: f64,
    },
    /// Too few facets around the axis.
    #[error("{found} facets are too few to draw a round cross-section: use {least} or more")]
    Facets {
        /// Number requested.
        found: u32,
        /// Smallest number.
        least: u32,
    },
    /// Too few fibres for a cloth between them.
    #[error("pleats need at least {least} fibres to stand between, found {found}")]
    Fibres {
        /// Number requested.
        found: u32,
        /// Smallest number.
        least: u32,
    },
    /// Pleats were requested for a braid.
    #[error(
        "pleats stand between straight fibres, but these turn by {turn_rad} rad about the axis: draw a surface of revolution"
    )]
    TurningFibres {
        /// Largest turn of a fibre \[rad\].
        turn_rad: f64,
    },
    /// The circumference of the cloth is not a length.
    #[error("the cloth circumference is {value_m} m: it must be positive and finite")]
    Cloth {
        /// The circumference found \[m\].
        value_m: f64,
    },
    /// More points than the format can count.
    #[error(
        "{stations} rings of {around} points are more than a file holds ({most}): draw fewer facets or fibres"
    )]
    TooLarge {
        /// Number of meridian points.
        stations: usize,
        /// Points around the axis, of cloth and fibres.
        around: usize,
        /// Largest number of points.
        most: u32,
    },
    /// The mesh couldn't be turned into XML.
    #[error("{}: the mesh can't be written as VTK XML: {reason}", path.display())]
    Encode {
        /// File that was to be written.
        path: PathBuf,
        /// Message of the encoder.
        reason: String,
    },
    /// The name has the wrong extension, by which ParaView chooses its reader.
    #[error("{}: the name of the file must end in .vtp", path.display())]
    Extension {
        /// File that was to be written.
        path: PathBuf,
    },
    /// The name has the wrong extension, by which ParaView chooses its reader.
    #[error("{}: the name of the file must end in .vtu", path.display())]
    GridExtension {
        /// File that was to be written.
        path: PathBuf,
    },
    /// A value of a membrane is infinite or not a number.
    #[error("{quantity} is {value} at {place}: only finite values can be written")]
    FieldNotFinite {
        /// Name of the array, with its unit.
        quantity: &'static str,
        /// Node or cell.
        place: String,
        /// The value found.
        value: f64,
    },
    /// The fields of a membrane are inconsistent.
    #[error("the fields of the membrane don't fit together: {what}")]
    Fields {
        /// The inconsistency.
        what: String,
    },
    /// The meshed part can't be completed to the requested whole.
    #[error("the whole can't be drawn: {what}")]
    Whole {
        /// The reason.
        what: String,
    },
    /// More points than the limit for a file.
    #[error(
        "{copies} copies of {points} points are more than a file holds ({most}): draw fewer facets or copies"
    )]
    TooManyPoints {
        /// Number of copies of the mesh, or of facets.
        copies: usize,
        /// Points per copy.
        points: usize,
        /// Largest number of points.
        most: u32,
    },
    /// The stem of a series can't be part of a file name.
    #[error("{stem:?} can't begin the file names of a series: use a name without folders")]
    Stem {
        /// The stem found.
        stem: String,
    },
    /// A series without members.
    #[error("a series needs at least one shape")]
    EmptySeries,
    /// The value of a member of a series isn't finite.
    #[error("the value of member {index} of the series is {value}: it must be finite")]
    SeriesValue {
        /// Index of the member.
        index: usize,
        /// The value found.
        value: f64,
    },
    /// An operation of the file system failed.
    #[error("{}: can't {action}: {source}", path.display())]
    File {
        /// File or folder concerned.
        path: PathBuf,
        /// The operation.
        action: &'static str,
        /// Its error.
        source: std::io::Error,
    },
}
