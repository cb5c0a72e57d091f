//! The layout of the bytes: offsets of the fields, and the records of axes and outputs. The crate's
//! documentation describes the format.

use core::ops::RangeInclusive;
use core::str;

use crate::TableError;

/// The first bytes of a table.
pub const MAGIC: [u8; 8] = *b"BulgeTab";
/// The version written and read.
pub const VERSION: u16 = 1;
/// Bytes of the header, before the records.
pub const HEADER: usize = 64;
/// Bytes of the record of an axis.
pub const AXIS: usize = 96;
/// Bytes of the record of an output.
pub const OUTPUT: usize = 104;
/// Bytes of a name.
pub const NAME: usize = 32;
/// Bytes of a unit.
pub const UNIT: usize = 16;
/// Most axes.
pub const MOST_AXES: usize = 4;
/// Most outputs.
pub const MOST_OUTPUTS: usize = 8;
/// Flag: the coordinate of axis 0 is the square root of the distance from its lower end.
pub const ROOT: u32 = 1;
/// Flag: the upper end of axis 0 is fitted as a function of the other axes.
pub const FITTED: u32 = 2;

/// How the outputs are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Cubic B-splines on equal cells of the coordinates: value, gradient and curvature are continuous; fast.
    Spline,
    /// One polynomial for the whole domain: small.
    Chebyshev,
}

impl Form {
    /// The code stored in the file.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Spline => 1,
            Self::Chebyshev => 2,
        }
    }

    /// The name in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Spline => "cubic B-splines",
            Self::Chebyshev => "Chebyshev polynomials",
        }
    }
}

/// One axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its unit; "1" for a pure number.
    pub unit: &'a str,
    /// Lower end.
    pub low: f64,
    /// Upper end; for a fitted axis the largest one.
    pub high: f64,
    /// Pole c of the coordinate s/(s + c), > 0; infinite for a linear one.
    pub pole: f64,
    /// Factor that makes the coordinate 1 at the upper end.
    pub scale: f64,
    /// Coefficients along this axis: cells + 3 of a spline, orders of a polynomial.
    pub nodes: usize,
    /// Coefficients of the edge along this axis; 0 on axis 0 or without a fitted edge.
    pub edge_nodes: usize,
}

/// One output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Output<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its unit; "1" for a pure number.
    pub unit: &'a str,
    /// Whether it grows as 1/u at the lower end of axis 0.
    pub is_singular: bool,
    /// Whether it vanishes as 1 - u at the upper end of axis 0.
    pub vanishes: bool,
    /// The errors measured.
    pub certificate: Certificate,
}

/// Errors of an output, measured off the grid against the solver. Relative errors are |error|/max(|value|,
/// floor) with floor = 0.001 scale; for a singular output the floor is divided by the root of the fraction of
/// the way to the upper end.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Certificate {
    /// Largest relative error of the value.
    pub value_max: f64,
    /// Its root mean square.
    pub value_rms: f64,
    /// Largest relative error of a component of the gradient, |error|/max(|component|, max(|value|, floor)/width of the axis).
    pub gradient_max: f64,
    /// Root mean square of the relative error of the gradient.
    pub gradient_rms: f64,
    /// Bound of the relative error of the value, found by subdivision.
    pub bound: f64,
    /// Largest |y| u^k, the scale with which small values are compared.
    pub scale: f64,
}

/// Little-endian number at an offset; `None` beyond the end.
pub(crate) fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

pub(crate) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

pub(crate) fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

pub(crate) fn f64_at(bytes: &[u8], at: usize) -> Option<f64> {
    u64_at(bytes, at).map(f64::from_bits)
}

/// Text up to the first zero.
fn text_at<'a>(
    bytes: &'a [u8],
    at: usize,
    length: usize,
    field: &'static str,
) -> Result<&'a str, TableError> {
    let malformed = TableError::Malformed { field };
    let field = bytes.get(at..at + length).ok_or(malformed)?;
    let end = field.iter().position(|byte| *byte == 0).unwrap_or(length);
    str::from_utf8(&field[..end]).ok().filter(|text| !text.is_empty()).ok_or(malformed)
}

pub(crate) fn axis_at(bytes: &[u8], at: usize) -> Result<Axis<'_>, TableError> {
    let number = |offset, field| {
        let value = f64_at(bytes, at + 48 + offset);
        value.filter(|value| !value.is_nan()).ok_or(TableError::Malformed { field })
    };
    let count =
        |offset| u32_at(bytes, at + 80 + offset).and_then(|count| usize::try_from(count).ok()).unwrap_or(0);
    let axis = Axis {
        name: text_at(bytes, at, NAME, "name of an axis")?,
        unit: text_at(bytes, at + NAME, UNIT, "unit of an axis")?,
        low: number(0, "lower end of an axis")?,
        high: number(8, "upper end of an axis")?,
        pole: number(16, "pole of an axis")?,
        scale: number(24, "scale of an axis")?,
        nodes: count(0),
        edge_nodes: count(4),
    };
    if u64_at(bytes, at + 88) != Some(0) {
        return Err(TableError::Malformed { field: "reserved bytes" });
    }
    let is_measure = |x: f64| MEASURES.contains(&x);
    let is_right = axis.low.is_finite()
        && is_measure(axis.high - axis.low)
        && (axis.pole == f64::INFINITY || is_measure(axis.pole));
    if is_right { Ok(axis) } else { Err(TableError::Malformed { field: "range of an axis" }) }
}

/// Range of widths and poles of axes: within it their products and quotients are finite in any unit.
const MEASURES: RangeInclusive<f64> = 1e-90..=1e90;

pub(crate) fn output_at(bytes: &[u8], at: usize) -> Result<Output<'_>, TableError> {
    let number = |i: usize| f64_at(bytes, at + 56 + 8 * i).unwrap_or(f64::NAN);
    let flag = |offset: usize| match bytes.get(at + 48 + offset) {
        Some(0) => Ok(false),
        Some(1) => Ok(true),
        _ => Err(TableError::Malformed { field: "factors of an output" }),
    };
    let (is_singular, vanishes) = (flag(0)?, flag(1)?);
    if bytes.get(at + 50..at + 56).is_none_or(|rest| rest.iter().any(|byte| *byte != 0)) {
        return Err(TableError::Malformed { field: "reserved bytes" });
    }
    // `>=` also rejects NaN, which would pass for a small error.
    if !(0..6).all(|i| number(i) >= 0.0) {
        return Err(TableError::Malformed { field: "errors of an output" });
    }
    Ok(Output {
        name: text_at(bytes, at, NAME, "name of an output")?,
        unit: text_at(bytes, at + NAME, UNIT, "unit of an output")?,
        is_singular,
        vanishes,
        certificate: Certificate {
            value_max: number(0),
            value_rms: number(1),
            gradient_max: number(2),
            gradient_rms: number(3),
            bound: number(4),
            scale: number(5),
        },
    })
}
