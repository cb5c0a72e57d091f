//! A table as Rust source: its bytes as a static, and the lookup.

use bulge_table::Table;
use std::fmt::Write as _;

use super::{ExportError, described};

/// Number of bytes in a line.
const ON_A_LINE: usize = 20;

/// A self-contained module with the bytes of the table as `pub static NAME: [u8; N]`, and `lookup()`, which
/// checks them and returns a `bulge_table::Lookup`. It depends only on the crate `bulge-table`.
///
/// # Errors
/// [`ExportError::Input`] if the name has characters other than capital letters, digits and underscores, or
/// doesn't begin with a capital letter.
pub fn rust_source(table: &Table<'_>, name: &str) -> Result<String, ExportError> {
    let is_name = name.starts_with(|c: char| c.is_ascii_uppercase())
        && name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
    if !is_name {
        return Err(ExportError::Input(format!(
            "`{name}` is no name for a Rust static: use capital letters, digits and underscores, such as `KNEE_TORQUE`"
        )));
    }
    let bytes = table.bytes();
    let mut text = format!("//! The table `{name}`: lookup with exact gradients, `None` outside.\n//!\n");
    // Carriage returns are not allowed in a comment, and a new line would end it.
    for line in described(table, &|text| text.replace(['\r', '\n'], " ")) {
        let _ = if line.is_empty() { writeln!(text, "//!") } else { writeln!(text, "//! - {line}") };
    }
    let (a, o) = (table.axes(), table.outputs());
    let _ = writeln!(
        text,
        "\n/// The lookup of the table; the bytes are checked first.\n///\n/// # Errors\n/// If they were changed.\npub fn lookup() -> Result<bulge_table::Lookup<'static, {a}, {o}>, bulge_table::TableError> {{\n    bulge_table::Table::from_bytes(&{name})?.lookup()\n}}\n"
    );
    let _ = writeln!(
        text,
        "/// The table's bytes.\n#[rustfmt::skip]\npub static {name}: [u8; {}] = [",
        bytes.len()
    );
    for line in bytes.chunks(ON_A_LINE) {
        let numbers: Vec<String> = line.iter().map(u8::to_string).collect();
        let _ = writeln!(text, "    {},", numbers.join(", "));
    }
    text.push_str("];\n");
    Ok(text)
}
