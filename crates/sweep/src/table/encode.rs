//! Encodes a table as bytes; `bulge_table` reads them.

use bulge_table::format::{
    AXIS, FITTED, HEADER, MAGIC, MOST_AXES, MOST_OUTPUTS, NAME, OUTPUT, ROOT, UNIT, VERSION,
};
use bulge_table::{Certificate, Form, crc64};

use super::field::{FieldAxis, FieldOutput};

/// A table before it is encoded.
#[derive(Debug, Clone)]
pub(crate) struct Draft<'a> {
    pub(crate) form: Form,
    /// Whether coefficients are stored in single precision.
    pub(crate) is_single: bool,
    pub(crate) is_root: bool,
    pub(crate) axes: &'a [FieldAxis],
    /// Largest value on each axis.
    pub(crate) highs: &'a [f64],
    pub(crate) poles: &'a [f64],
    /// Factors that make each coordinate 1 at the upper end.
    pub(crate) scales: &'a [f64],
    pub(crate) nodes: &'a [usize],
    /// Numbers of edge nodes on each axis (0 on the first), and the edge coefficients; none if the edge isn't
    /// fitted.
    pub(crate) edge: Option<(&'a [usize], &'a [f64])>,
    pub(crate) edge_error: f64,
    pub(crate) outputs: &'a [FieldOutput],
    pub(crate) certificates: &'a [Certificate],
    pub(crate) checks: [u64; 2],
    pub(crate) coefficients: &'a [f64],
    pub(crate) text: &'a str,
}

/// Why a table can't be encoded.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct EncodeError(String);

impl Draft<'_> {
    /// Encodes the table.
    pub(crate) fn bytes(&self) -> Result<Vec<u8>, EncodeError> {
        let (axes, outputs) = (self.axes.len(), self.outputs.len());
        if axes > MOST_AXES || outputs > MOST_OUTPUTS {
            return Err(EncodeError(format!(
                "a table has at most {MOST_AXES} axes and {MOST_OUTPUTS} outputs, not {axes} and {outputs}"
            )));
        }
        let records = HEADER + axes * AXIS + outputs * OUTPUT;
        let edge_bytes = self.edge.map_or(0, |(_, numbers)| 8 * numbers.len());
        let each = if self.is_single { 4 } else { 8 };
        let data = records + edge_bytes;
        let text = data + each * self.coefficients.len();
        let length = text + self.text.len() + 8;
        let too_large = |_| EncodeError(format!("a table of {length} bytes is too large for its format"));
        let word = |n: usize| u32::try_from(n).map_err(too_large);
        let mut bytes = Vec::with_capacity(length);
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        #[expect(clippy::cast_possible_truncation, reason = "4 or 8, at most 4, at most 8")]
        bytes.extend([self.form.code(), each as u8, axes as u8, outputs as u8, 0, 0]);
        for place in [length, data, records, text] {
            bytes.extend(word(place)?.to_le_bytes());
        }
        for number in self.checks {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(word(self.text.len())?.to_le_bytes());
        let flags = if self.is_root { ROOT } else { 0 } | if self.edge.is_some() { FITTED } else { 0 };
        bytes.extend(flags.to_le_bytes());
        bytes.extend(self.edge_error.to_le_bytes());
        for (i, axis) in self.axes.iter().enumerate() {
            named(&mut bytes, &axis.name, &axis.unit)?;
            for number in [axis.low, self.highs[i], self.poles[i], self.scales[i]] {
                bytes.extend(number.to_le_bytes());
            }
            bytes.extend(word(self.nodes[i])?.to_le_bytes());
            bytes.extend(word(self.edge.map_or(0, |(nodes, _)| nodes[i]))?.to_le_bytes());
            bytes.extend([0; 8]);
        }
        for (output, certificate) in self.outputs.iter().zip(self.certificates) {
            named(&mut bytes, &output.name, &output.unit)?;
            bytes.extend([u8::from(output.is_singular), u8::from(output.vanishes), 0, 0, 0, 0, 0, 0]);
            let c = certificate;
            for number in [c.value_max, c.value_rms, c.gradient_max, c.gradient_rms, c.bound, c.scale] {
                bytes.extend(number.to_le_bytes());
            }
        }
        for number in self.edge.iter().flat_map(|(_, numbers)| numbers.iter()) {
            bytes.extend(number.to_le_bytes());
        }
        for number in self.coefficients {
            if self.is_single {
                #[expect(clippy::cast_possible_truncation, reason = "what single precision means")]
                bytes.extend((*number as f32).to_le_bytes());
            } else {
                bytes.extend(number.to_le_bytes());
            }
        }
        bytes.extend(self.text.as_bytes());
        // The checksum covers all bytes before it.
        let checksum = crc64(&bytes);
        bytes.extend(checksum.to_le_bytes());
        Ok(bytes)
    }
}

fn named(bytes: &mut Vec<u8>, name: &str, unit: &str) -> Result<(), EncodeError> {
    for (text, most) in [(name, NAME), (unit, UNIT)] {
        if text.len() > most || text.is_empty() {
            return Err(EncodeError(format!("`{text}` is too long for a table: at most {most} bytes")));
        }
        bytes.extend(text.as_bytes());
        bytes.extend(std::iter::repeat_n(0, most - text.len()));
    }
    Ok(())
}
