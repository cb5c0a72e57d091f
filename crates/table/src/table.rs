//! A table as its bytes: checked once, then looked up.

use core::str;

use crate::TableError;
use crate::chebyshev::MOST_ORDERS;
use crate::coordinate::Fixed;
use crate::crc64::crc64;
use crate::format::{
    AXIS, Axis, FITTED, Form, HEADER, MAGIC, MOST_AXES, MOST_OUTPUTS, OUTPUT, Output, ROOT, VERSION, axis_at,
    f64_at, output_at, u16_at, u32_at, u64_at,
};
use crate::lookup::Lookup;
use crate::plane::Plane;
use crate::sqrt::reciprocal_root;

/// Bytes of the checksum.
const CHECKSUM: usize = 8;
/// Smallest coordinate at which a singular output is looked up: its gradient contains 1/u^2, which must not
/// overflow.
const LEAST_SINGULAR: f64 = 1e-90;
/// Coefficients of a spline with one cell.
const LEAST_NODES: usize = 4;
/// Most coefficients along an axis.
const MOST_NODES: usize = 1 << 20;

/// A table as its bytes. Everything was checked when it was created from them.
#[derive(Debug, Clone, Copy)]
pub struct Table<'a> {
    bytes: &'a [u8],
    form: Form,
    precision: usize,
    axes: usize,
    outputs: usize,
    flags: u32,
    edge: &'a [u8],
    data: &'a [u8],
    text: &'a str,
}

/// What a check of bytes has found: the same bytes become a table again without another check of all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Checked {
    length: usize,
    checksum: u64,
}

impl<'a> Table<'a> {
    /// Checks the bytes and returns a table that borrows them; nothing is copied.
    ///
    /// # Errors
    /// [`TableError`]: truncated, damaged, of another version, or no table at all. Bytes after the table's end are an error as well.
    pub fn from_bytes(bytes: &'a [u8]) -> Result<Self, TableError> {
        let truncated = |needed| TableError::Truncated { found: bytes.len(), needed };
        if !bytes.starts_with(&MAGIC) {
            return Err(if MAGIC.starts_with(bytes) { truncated(HEADER) } else { TableError::NoTable });
        }
        let short = truncated(HEADER + CHECKSUM);
        let version = u16_at(bytes, 8).ok_or(short)?;
        if version != VERSION {
            return Err(TableError::Version { found: version });
        }
        let length = size_at(bytes, 16).ok_or(short)?;
        if bytes.len() < HEADER + CHECKSUM {
            return Err(short);
        }
        if bytes.len() < length {
            return Err(truncated(length));
        }
        if bytes.len() > length || length < HEADER + CHECKSUM {
            return Err(TableError::Malformed { field: "length" });
        }
        let (body, end) = bytes.split_at(length - CHECKSUM);
        let (stored, computed) = (u64_at(end, 0).ok_or(short)?, crc64(body));
        if stored != computed {
            return Err(TableError::Checksum { stored, computed });
        }
        // Any mistake from here on was made by the program that wrote it.
        let table = Self::read(bytes, body)?;
        table.check_sizes()?;
        Ok(table)
    }

    /// The table as [`Self::again`] needs it.
    #[must_use]
    pub fn checked(&self) -> Checked {
        let length = self.bytes.len();
        Checked { length, checksum: u64_at(self.bytes, length - CHECKSUM).unwrap_or_default() }
    }

    /// The table of bytes that were checked before, for programs that can't keep a table beside its bytes: in
    /// nanoseconds, where [`Self::from_bytes`] reads all of them. Bytes of another length or with another
    /// checksum at their end are checked as there.
    ///
    /// # Errors
    /// As [`Self::from_bytes`].
    pub fn again(bytes: &'a [u8], checked: Checked) -> Result<Self, TableError> {
        let Checked { length, checksum } = checked;
        if bytes.len() != length || u64_at(bytes, length - CHECKSUM) != Some(checksum) {
            return Self::from_bytes(bytes);
        }
        Self::read(bytes, &bytes[..length - CHECKSUM])
    }

    /// Reads the header of a table whose checksum fits.
    fn read(bytes: &'a [u8], body: &'a [u8]) -> Result<Self, TableError> {
        let malformed = |field| TableError::Malformed { field };
        let number = |at| size_at(body, at).ok_or(malformed("header"));
        let form = match bytes[10] {
            1 => Form::Spline,
            2 => Form::Chebyshev,
            _ => return Err(malformed("form")),
        };
        let [precision, axes, outputs] = [11, 12, 13].map(|at: usize| usize::from(bytes[at]));
        if precision != 4 && precision != 8 {
            return Err(malformed("number of bytes of a coefficient"));
        }
        if !(1..=MOST_AXES).contains(&axes) || !(1..=MOST_OUTPUTS).contains(&outputs) {
            return Err(malformed("number of axes or outputs"));
        }
        let [data, edge, text, text_length] = [number(20)?, number(24)?, number(28)?, number(48)?];
        let flags = u32_at(body, 52).ok_or(malformed("header"))?;
        let records = HEADER + axes * AXIS + outputs * OUTPUT;
        let is_ordered = records <= edge && edge <= data && data <= text && text <= body.len();
        if !is_ordered || body.len() - text != text_length || flags & !(ROOT | FITTED) != 0 {
            return Err(malformed("header"));
        }
        if u16_at(body, 14) != Some(0) {
            return Err(malformed("reserved bytes"));
        }
        if !f64_at(body, 56).is_some_and(|error| error >= 0.0) {
            return Err(malformed("error of the edge"));
        }
        Ok(Self {
            bytes,
            form,
            precision,
            axes,
            outputs,
            flags,
            edge: &body[edge..data],
            data: &body[data..text],
            text: str::from_utf8(&body[text..]).map_err(|_| malformed("text"))?,
        })
    }

    /// Checks that edge and coefficients have the sizes given in the records, and that all numbers are
    /// finite.
    fn check_sizes(&self) -> Result<(), TableError> {
        let malformed = |field| TableError::Malformed { field };
        let product = |count: usize, by: usize| count.checked_mul(by).ok_or(malformed("number of nodes"));
        let nodes = match self.form {
            Form::Spline => LEAST_NODES..=MOST_NODES,
            Form::Chebyshev => 1..=MOST_ORDERS,
        };
        let mut count = self.outputs;
        // A fitted edge stores K = 1/Q and c.
        let mut edge = if self.is_fitted() { 2 } else { 0 };
        for i in 0..self.axes {
            let axis = axis_at(self.bytes, HEADER + i * AXIS)?;
            if !nodes.contains(&axis.nodes) {
                return Err(malformed("number of nodes"));
            }
            count = product(count, axis.nodes)?;
            let has_edge = i > 0 && self.is_fitted();
            let edge_nodes = if has_edge { LEAST_NODES..=MOST_NODES } else { 0..=0 };
            if !edge_nodes.contains(&axis.edge_nodes) {
                return Err(malformed("number of nodes of the edge"));
            }
            if has_edge {
                edge = product(edge, axis.edge_nodes)?;
            }
            // c and scale of a fitted axis aren't used.
            let has_scale = (i == 0 && self.is_fitted()) || fits_scale(&axis, i == 0 && self.is_root());
            if !(axis.scale > 0.0 && axis.scale.is_finite() && has_scale) {
                return Err(malformed("scale of an axis"));
            }
        }
        for o in 0..self.outputs {
            output_at(self.bytes, HEADER + self.axes * AXIS + o * OUTPUT)?;
        }
        if self.is_fitted() && self.axes == 1 {
            return Err(malformed("fitted edge of a single axis"));
        }
        if product(count, self.precision)? != self.data.len() || product(edge, 8)? != self.edge.len() {
            return Err(malformed("number of coefficients"));
        }
        let double = |chunk: &[u8]| f64_at(chunk, 0).is_some_and(f64::is_finite);
        let single = |chunk: &[u8]| u32_at(chunk, 0).is_some_and(|bits| f32::from_bits(bits).is_finite());
        let is_finite = if self.precision == 8 {
            self.data.chunks_exact(8).all(double)
        } else {
            self.data.chunks_exact(4).all(single)
        };
        if is_finite && self.edge.chunks_exact(8).all(double) {
            Ok(())
        } else {
            Err(malformed("coefficient (not finite)"))
        }
    }

    /// Number of axes.
    #[must_use]
    pub const fn axes(&self) -> usize {
        self.axes
    }

    /// Number of outputs.
    #[must_use]
    pub const fn outputs(&self) -> usize {
        self.outputs
    }

    /// The axis with index i; `None` beyond the last one.
    #[must_use]
    pub fn axis(&self, i: usize) -> Option<Axis<'a>> {
        if i < self.axes { axis_at(self.bytes, HEADER + i * AXIS).ok() } else { None }
    }

    /// The output with index o; `None` beyond the last one.
    #[must_use]
    pub fn output(&self, o: usize) -> Option<Output<'a>> {
        let at = HEADER + self.axes * AXIS + o * OUTPUT;
        if o < self.outputs { output_at(self.bytes, at).ok() } else { None }
    }

    /// How the outputs are stored.
    #[must_use]
    pub const fn form(&self) -> Form {
        self.form
    }

    /// Bytes of a coefficient: 4 or 8.
    #[must_use]
    pub const fn precision(&self) -> usize {
        self.precision
    }

    /// Whether the coordinate of axis 0 is the square root of the distance from its lower end.
    #[must_use]
    pub const fn is_root(&self) -> bool {
        self.flags & ROOT != 0
    }

    /// Whether the upper end of axis 0 depends on the other axes.
    #[must_use]
    pub const fn is_fitted(&self) -> bool {
        self.flags & FITTED != 0
    }

    /// Number of points at which the errors were measured, and the seed with which they were drawn.
    #[must_use]
    pub fn checks(&self) -> [u64; 2] {
        [32, 40].map(|at| u64_at(self.bytes, at).unwrap_or(0))
    }

    /// Largest error of the fitted upper end of axis 0, in the unit of the axis; 0 without a fitted end.
    #[must_use]
    pub fn edge_error(&self) -> f64 {
        f64_at(self.bytes, 56).unwrap_or(0.0)
    }

    /// Origin of the table: JSON, as `bulge-sweep` writes it.
    #[must_use]
    pub const fn text(&self) -> &'a str {
        self.text
    }

    /// All bytes of the table.
    #[must_use]
    pub const fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// The coefficients of the edge and of the outputs, as stored.
    #[must_use]
    pub const fn coefficients(&self) -> [&'a [u8]; 2] {
        [self.edge, self.data]
    }

    /// A lookup of all outputs.
    ///
    /// # Errors
    /// [`TableError::Shape`] if the table has another number of axes or outputs.
    pub fn lookup<const A: usize, const O: usize>(&self) -> Result<Lookup<'a, A, O>, TableError> {
        if (A, O) != (self.axes, self.outputs) {
            return Err(TableError::Shape { axes: self.axes, outputs: self.outputs });
        }
        let mut lookup = Lookup {
            form: self.form,
            is_single: self.precision == 4,
            is_root: self.is_root(),
            is_fitted: self.is_fitted(),
            axes: [Fixed::default(); A],
            nodes: [0; A],
            edge_nodes: [0; A],
            edge: self.edge,
            data: self.data,
            cells: [0.0; A],
            edge_cells: [0.0; A],
            // At the lower end itself the root has no derivative, and the fast root needs a normal number.
            least: if self.is_root() { f64::MIN_POSITIVE } else { 0.0 },
            least_u: 0.0,
            singular: [0.0; O],
            vanishing: [0.0; O],
            plane: Plane::default(),
        };
        for i in 0..A {
            let axis = axis_at(self.bytes, HEADER + i * AXIS)?;
            lookup.axes[i] = Fixed { low: axis.low, high: axis.high, pole: axis.pole, scale: axis.scale };
            (lookup.nodes[i], lookup.edge_nodes[i]) = (axis.nodes, axis.edge_nodes);
            lookup.cells[i] = axis.nodes.saturating_sub(3) as f64;
            lookup.edge_cells[i] = axis.edge_nodes.saturating_sub(3) as f64;
        }
        for o in 0..O {
            let output = output_at(self.bytes, HEADER + A * AXIS + o * OUTPUT)?;
            lookup.singular[o] = f64::from(u8::from(output.is_singular));
            lookup.vanishing[o] = f64::from(u8::from(output.vanishes));
            if output.is_singular {
                lookup.least_u = LEAST_SINGULAR;
            }
        }
        lookup.plane = Plane::new(&lookup);
        Ok(lookup)
    }

    /// All outputs at a point, written into `values`, and their derivatives into `gradients` (that of output
    /// o by axis i at `o * axes + i`). This is for callers that learn the shape of the table at run time; it
    /// is slower than a [`Lookup`]. `None` outside the domain, or if a length doesn't fit.
    #[must_use]
    pub fn sample(&self, point: &[f64], values: &mut [f64], gradients: &mut [f64]) -> Option<()> {
        match self.axes {
            1 => self.sample_of::<1>(point, values, gradients),
            2 => self.sample_of::<2>(point, values, gradients),
            3 => self.sample_of::<3>(point, values, gradients),
            _ => self.sample_of::<4>(point, values, gradients),
        }
    }

    fn sample_of<const A: usize>(
        &self,
        point: &[f64],
        values: &mut [f64],
        gradients: &mut [f64],
    ) -> Option<()> {
        fn all<const A: usize, const O: usize>(
            table: &Table<'_>,
            point: [f64; A],
            values: &mut [f64],
            gradients: &mut [f64],
        ) -> Option<()> {
            let found = table.lookup::<A, O>().ok()?.at(point)?;
            for ((value, gradient), sample) in
                values.iter_mut().zip(gradients.chunks_exact_mut(A)).zip(&found)
            {
                *value = sample.value;
                gradient.copy_from_slice(&sample.gradient);
            }
            Some(())
        }
        let point: [f64; A] = *point.first_chunk().filter(|_| point.len() == A)?;
        if values.len() != self.outputs || gradients.len() != self.outputs * A {
            return None;
        }
        match self.outputs {
            1 => all::<A, 1>(self, point, values, gradients),
            2 => all::<A, 2>(self, point, values, gradients),
            3 => all::<A, 3>(self, point, values, gradients),
            4 => all::<A, 4>(self, point, values, gradients),
            5 => all::<A, 5>(self, point, values, gradients),
            6 => all::<A, 6>(self, point, values, gradients),
            7 => all::<A, 7>(self, point, values, gradients),
            _ => all::<A, 8>(self, point, values, gradients),
        }
    }

    /// The upper end of axis 0 at the values of the other axes (the value of axis 0 in `point` is ignored);
    /// `None` outside, or if the number of coordinates doesn't fit.
    #[must_use]
    pub fn upper_end(&self, point: &[f64]) -> Option<f64> {
        fn of<const A: usize>(table: &Table<'_>, point: &[f64]) -> Option<f64> {
            let point: [f64; A] = *point.first_chunk().filter(|_| point.len() == A)?;
            match table.outputs {
                1 => table.lookup::<A, 1>().ok()?.upper_end(point),
                2 => table.lookup::<A, 2>().ok()?.upper_end(point),
                3 => table.lookup::<A, 3>().ok()?.upper_end(point),
                4 => table.lookup::<A, 4>().ok()?.upper_end(point),
                5 => table.lookup::<A, 5>().ok()?.upper_end(point),
                6 => table.lookup::<A, 6>().ok()?.upper_end(point),
                7 => table.lookup::<A, 7>().ok()?.upper_end(point),
                _ => table.lookup::<A, 8>().ok()?.upper_end(point),
            }
        }
        match self.axes {
            1 => of::<1>(self, point),
            2 => of::<2>(self, point),
            3 => of::<3>(self, point),
            _ => of::<4>(self, point),
        }
    }
}

/// Whether the scale is 1/Q: otherwise the coordinate would end before or after its axis.
fn fits_scale(axis: &Axis<'_>, is_root: bool) -> bool {
    let width = axis.high - axis.low;
    let s = if is_root { width * reciprocal_root(width) } else { width };
    let q = if axis.pole == f64::INFINITY { s } else { s / (s + axis.pole) };
    (axis.scale * q - 1.0).abs() < 1e-9
}

fn size_at(bytes: &[u8], at: usize) -> Option<usize> {
    u32_at(bytes, at).and_then(|n| usize::try_from(n).ok())
}
