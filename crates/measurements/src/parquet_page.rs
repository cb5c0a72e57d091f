//! Pages of a Parquet column, checked before they are decoded.
//!
//! The decoder of the `parquet` crate relies on the page's own description and panics on damaged pages: if a
//! dictionary is missing, if levels are longer than the page, if texts are truncated, or if the length of a
//! run has no end. Such pages are errors here.

use parquet::basic::{Encoding, Type};
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::schema::types::ColumnDescPtr;

/// Most bytes of the length of a run, which has seven bits in each byte.
const MOST_BYTES_OF_LENGTH: usize = 10;

/// Refuses a column with an impossible position in the file.
pub(crate) fn checked_place(column: &ColumnChunkMetaData) -> Result<()> {
    let start = column.dictionary_page_offset().unwrap_or_else(|| column.data_page_offset());
    if start < 0 || column.compressed_size() < 0 || column.num_values() < 0 {
        return damaged("a column's place in the file is negative");
    }
    Ok(())
}

/// The pages of one column, checked.
pub(crate) struct CheckedPages {
    pages: Box<dyn PageReader>,
    column: ColumnDescPtr,
    has_dictionary: bool,
}

impl CheckedPages {
    pub(crate) fn new(pages: Box<dyn PageReader>, column: ColumnDescPtr) -> Self {
        Self { pages, column, has_dictionary: false }
    }

    fn checked(&mut self, page: &Page) -> Result<()> {
        let is_optional = self.column.max_def_level() > 0;
        match page {
            Page::DictionaryPage { buf, num_values, .. } => {
                self.has_dictionary = true;
                self.checked_numbers(buf, *num_values)?;
                self.checked_texts(buf, *num_values)
            }
            Page::DataPage { buf, num_values, encoding, def_level_encoding, .. } => {
                if is_optional && *def_level_encoding != Encoding::RLE {
                    return damaged("levels are in an outdated encoding");
                }
                // Four bytes with the length of the levels, then the levels. The decoder checks these, but
                // not what follows.
                let levels = match buf.first_chunk::<4>() {
                    Some(length) if is_optional => 4 + u32::from_le_bytes(*length) as usize,
                    _ => 0,
                };
                self.checked_levels(buf.get(4..levels), *num_values)?;
                self.checked_values(buf.get(levels..), *encoding, *num_values)
            }
            Page::DataPageV2 {
                buf,
                num_values,
                encoding,
                num_nulls,
                def_levels_byte_len,
                rep_levels_byte_len,
                ..
            } => {
                let levels = *def_levels_byte_len as usize + *rep_levels_byte_len as usize;
                let count = num_values.saturating_sub(*num_nulls);
                self.checked_levels(buf.get(*rep_levels_byte_len as usize..levels), *num_values)?;
                self.checked_values(buf.get(levels..), *encoding, count)
            }
        }
    }

    fn checked_levels(&self, levels: Option<&[u8]>, count: u32) -> Result<()> {
        let width = (i16::BITS - self.column.max_def_level().leading_zeros()) as usize;
        checked_runs(levels.unwrap_or_default(), width, count)
    }

    fn checked_values(&self, values: Option<&[u8]>, encoding: Encoding, count: u32) -> Result<()> {
        let Some(values) = values else { return damaged("levels are longer than their page") };
        match encoding {
            Encoding::PLAIN => self.checked_texts(values, count),
            // The first byte is the width of an index in bits.
            Encoding::PLAIN_DICTIONARY | Encoding::RLE_DICTIONARY if self.has_dictionary => values
                .split_first()
                .map_or(Ok(()), |(width, runs)| checked_runs(runs, usize::from(*width), count)),
            Encoding::PLAIN_DICTIONARY | Encoding::RLE_DICTIONARY => damaged("a dictionary is missing"),
            // Rarely written and not checked: delta-encoded byte arrays and similar encodings.
            other => Err(ParquetError::General(format!("the encoding {other} is not read"))),
        }
    }

    /// Whether there are `count` numbers. The decoder makes room for as many as a dictionary states.
    fn checked_numbers(&self, bytes: &[u8], count: u32) -> Result<()> {
        let width = match self.column.physical_type() {
            Type::INT32 | Type::FLOAT => 4,
            Type::INT64 | Type::DOUBLE => 8,
            _ => return Ok(()),
        };
        if bytes.len() / width < count as usize {
            return damaged("a dictionary is cut off");
        }
        Ok(())
    }

    /// Whether `count` texts follow each other, each after its length in four bytes.
    fn checked_texts(&self, mut bytes: &[u8], count: u32) -> Result<()> {
        if self.column.physical_type() != Type::BYTE_ARRAY {
            return Ok(());
        }
        for _ in 0..count {
            let rest = bytes.split_first_chunk::<4>();
            let rest = rest.and_then(|(length, rest)| rest.get(u32::from_le_bytes(*length) as usize..));
            let Some(rest) = rest else { return damaged("a text is missing or cut off") };
            bytes = rest;
        }
        Ok(())
    }
}

/// Whether each run of `count` small numbers, each of `width` bits, has a length that ends: the number of
/// repetitions of one value, or of groups of eight values if it is odd.
fn checked_runs(mut bytes: &[u8], width: usize, count: u32) -> Result<()> {
    let mut left = u64::from(count);
    loop {
        let Some(last) = bytes.iter().take(MOST_BYTES_OF_LENGTH).position(|byte| byte & 0x80 == 0) else {
            return match bytes.len() {
                // The page ends within a length: the decoder takes it for the end of the runs.
                ..=MOST_BYTES_OF_LENGTH => Ok(()),
                _ => damaged("a run has a length without an end"),
            };
        };
        let length = bytes[..=last].iter().rev().fold(0_u64, |sum, byte| (sum << 7) | u64::from(byte & 0x7f));
        let (values, size) = match length & 1 {
            0 => (length >> 1, width.div_ceil(8) as u64),
            _ => ((length >> 1).saturating_mul(8), (length >> 1).saturating_mul(width as u64)),
        };
        // What is stated too long is noticed by the decoder.
        let size = usize::try_from(size).unwrap_or(usize::MAX).min(bytes.len() - last - 1);
        bytes = &bytes[last + 1 + size..];
        left = left.saturating_sub(values);
        if left == 0 || length == 0 {
            return Ok(());
        }
    }
}

fn damaged(why: &str) -> Result<()> {
    Err(ParquetError::General(why.to_owned()))
}

impl Iterator for CheckedPages {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl PageReader for CheckedPages {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        let page = self.pages.get_next_page()?;
        if let Some(page) = &page {
            self.checked(page)?;
        }
        Ok(page)
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.pages.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.pages.skip_next_page()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One page.
    struct One(Option<Page>);

    impl Iterator for One {
        type Item = Result<Page>;

        fn next(&mut self) -> Option<Self::Item> {
            self.0.take().map(Ok)
        }
    }

    impl PageReader for One {
        fn get_next_page(&mut self) -> Result<Option<Page>> {
            Ok(self.0.take())
        }

        fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
            Ok(None)
        }

        fn skip_next_page(&mut self) -> Result<()> {
            Ok(())
        }
    }

    /// The decoder would make room for a billion numbers.
    #[test]
    fn a_dictionary_has_the_numbers_that_it_states() {
        for (physical, width) in [(Type::DOUBLE, 8), (Type::INT64, 8), (Type::FLOAT, 4), (Type::INT32, 4)] {
            for (count, is_there) in [(6, true), (7, false), (1_000_000_000, false)] {
                let column =
                    parquet::schema::types::Type::primitive_type_builder("x", physical).build().unwrap();
                let path = parquet::schema::types::ColumnPath::from("x");
                let column = parquet::schema::types::ColumnDescriptor::new(column.into(), 0, 0, path);
                let buf = vec![0; 6 * width].into();
                let page = Page::DictionaryPage {
                    buf,
                    num_values: count,
                    encoding: Encoding::PLAIN,
                    is_sorted: false,
                };
                let mut pages = CheckedPages::new(Box::new(One(Some(page))), column.into());
                assert_eq!(pages.get_next_page().is_ok(), is_there, "{count} of {physical}");
            }
        }
    }

    #[test]
    fn lengths_of_runs_end() {
        // 300 times the number 5, then 16 numbers in two groups, of three bits each.
        let mut runs = vec![0xd8, 0x04, 5, 0x05, 1, 2, 3, 4, 5, 6];
        assert!(checked_runs(&runs, 3, 316).is_ok());
        runs.extend([0xff; 11]);
        assert!(checked_runs(&runs, 3, 316).is_ok(), "what follows the last value is not read");
        assert!(checked_runs(&runs, 3, 317).is_err());
        assert!(checked_runs(&runs, 4, 317).is_ok(), "ten bytes are left, which are a page that is cut off");
        runs.extend([0xff; 2]);
        assert!(checked_runs(&runs, 4, 317).is_err());
        assert!(checked_runs(&[0x80, 0x80, 0x00], 3, 8).is_ok(), "zeros that fill a page up");
    }
}
