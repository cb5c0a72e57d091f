//! Certified force and volume tables of pneumatic muscles: one binary format and its lookup.
//!
//! A table holds a few outputs (force f, volume v, ...) over one to four axes (contraction, slenderness,
//! ...). They are piecewise or global polynomials in coordinates that follow the domain; the measured errors
//! are stored with them. A lookup gives the value and the exact gradient of the stored polynomial, or `None`
//! outside the domain. Nothing is ever extrapolated.
//!
//! ```
//! # fn look(bytes: &[u8]) -> Result<(), bulge_table::TableError> {
//! let table = bulge_table::Table::from_bytes(bytes)?;
//! let lookup = table.lookup::<2, 2>()?; // two axes, two outputs
//! if let Some([force, volume]) = lookup.at([0.2, 6.875]) {
//!     // value and gradient [d/d(contraction), d/d(slenderness)]
//!     let _ = (force.value, force.gradient, volume.value);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # Coordinates
//!
//! ```text
//! axis i >= 1:   v_i = q/Q,  q = s/(s + c),  s = x - low,  Q = q(high)          (c infinite: linear; else c and the widths of axes 1e-90 to 1e90)
//! axis 0:        the same, s = x - low or sqrt(x - low); with a fitted upper end (the contraction limit, say) Q(v) and c(v) of the others
//! output:        y = g(u, v) (1 - u)^j / u^k                                    j = 1: vanishes at the edge, k = 1: singular at low
//! ```
//!
//! # Format (version 1, little endian)
//!
//! | bytes | content |
//! |---|---|
//! | 0..8 | `BulgeTab` |
//! | 8..12 | version u16; form u8 (1 splines, 2 Chebyshev); bytes of a coefficient u8 (4 or 8) |
//! | 12..16 | axes A u8 (1..=4); outputs O u8 (1..=8); 0 u16 |
//! | 16..32 | length of the file u32; place of the coefficients u32; of the edge u32; of the text u32 |
//! | 32..48 | number of checks u64; seed of the checks u64 (0: none) |
//! | 48..64 | length of the text u32; flags u32 (bit 0: root on axis 0, bit 1: fitted edge on axis 0); largest error of the edge f64 |
//! | then A x 96 | name \[u8; 32\]; unit \[u8; 16\]; low, high, c, scale = 1/Q f64 (c and scale of a fitted axis 0: those in the middle); coefficients u32; those of the edge u32; 8 bytes 0 |
//! | then O x 104 | name \[u8; 32\]; unit \[u8; 16\]; k u8; j u8; 6 bytes 0; largest and RMS error of the value, of the gradient, bound, scale: 6 f64 |
//! | edge | B-splines of 1/Q and c over axes 1.. as f64, if the edge is fitted |
//! | coefficients | see below |
//! | text | UTF-8: where the table comes from |
//! | last 8 | CRC-64/XZ of all bytes before |
//!
//! Coefficients: one per output at each index along the axes (axis 0 slowest, the last axis fastest, then the
//! outputs). Splines: coefficients of the cubic B-splines on equal cells of \[0, 1\]; those with the indices
//! k to k + 3 are non-zero in cell k. Chebyshev: coefficients of T_{i_0}(2u - 1) T_{i_1}(2v_1 - 1) ... An
//! edge stores 1/Q and c like two outputs.
//!
//! Deliberately absent: std, an allocator, dependencies, `unsafe`, and building tables (`bulge-sweep` does
//! that).
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod chebyshev;
mod coordinate;
mod crc64;
mod curve;
mod error;
pub mod format;
mod lookup;
mod pair;
mod plane;
mod spline;
mod sqrt;
mod table;

pub use chebyshev::MOST_ORDERS;
pub use crc64::crc64;
pub use curve::Curve;
pub use error::TableError;
pub use format::{Axis, Certificate, Form, Output};
pub use lookup::{Lookup, Sample};
pub use table::{Checked, Table};
