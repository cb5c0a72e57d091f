//! A table as a C99 header: the coefficients, and a function that evaluates the lookup.

mod body;
mod literal;

use bulge_table::{Form, Table};
use std::fmt::Write as _;

use super::{ExportError, axes, coefficients, described};
use body::body;
use literal::{double, single};

/// Longest line of numbers.
const WIDTH: usize = 110;

/// A self-contained header (C99, only `<stddef.h>` and `<math.h>`). It has `static const` arrays with the
/// coefficients as stored, and the function
///
/// ```text
/// static inline int NAME_at(const double x[A], double y[O], double dy[O][A]);
/// ```
/// The function returns 1 and writes the outputs and their derivatives by the axes. Outside the domain and
/// for a NaN it returns 0 and writes nothing. It agrees with the lookup of `bulge_table` to rounding.
///
/// # Errors
/// [`ExportError::Input`] if the name has characters other than letters, digits and underscores, or doesn't
/// begin with a letter.
pub fn c_header(table: &Table<'_>, name: &str) -> Result<String, ExportError> {
    // Names with a leading underscore are reserved for the compiler.
    let is_name = name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !is_name {
        return Err(ExportError::Input(format!(
            "`{name}` is no name for C: use letters, digits and underscores, such as `knee_torque`"
        )));
    }
    let guard = format!("{}_H", name.to_uppercase());
    let mut text = String::from("/*\n");
    for line in described(table, &plain) {
        let _ = if line.is_empty() { writeln!(text, " *") } else { writeln!(text, " * {line}") };
    }
    let _ =
        writeln!(text, " */\n#ifndef {guard}\n#define {guard}\n\n#include <math.h>\n#include <stddef.h>\n");
    let [edge, data] = coefficients(table);
    if table.is_fitted() {
        array(&mut text, "double", &format!("{name}_edge"), edge.iter().copied().map(double));
    }
    let numbers = format!("{name}_coefficients");
    if table.precision() == 4 {
        array(&mut text, "float", &numbers, data.iter().copied().map(single));
    } else {
        array(&mut text, "double", &numbers, data.iter().copied().map(double));
    }
    helpers(&mut text, table, name);
    body(&mut text, table, name);
    let _ = writeln!(text, "#endif");
    Ok(text)
}

/// Makes text safe in a comment: it can't end the comment, open another, or start a trigraph.
fn plain(text: &str) -> String {
    bulge_muscles::shown::one_line(text).replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?")
}

fn array(text: &mut String, kind: &str, name: &str, numbers: impl ExactSizeIterator<Item = String>) {
    let _ = write!(text, "static const {kind} {name}[{}] = {{", numbers.len());
    let mut column = WIDTH;
    for number in numbers {
        if column + number.len() + 2 > WIDTH {
            text.push_str("\n   ");
            column = 3;
        }
        let _ = write!(text, " {number},");
        column += number.len() + 2;
    }
    text.push_str("\n};\n\n");
}

/// Writes the functions of one coordinate that the lookup needs.
fn helpers(text: &mut String, table: &Table<'_>, name: &str) {
    let is_spline = table.form() == Form::Spline;
    if is_spline || table.is_fitted() {
        let _ = writeln!(text, "{}", SPLINE.replace("NAME", name));
    }
    if !is_spline {
        let _ = writeln!(text, "{}", CHEBYSHEV.replace("NAME", name));
    }
}

/// Largest number of coefficients along an axis that one point uses.
fn widest(table: &Table<'_>) -> usize {
    match table.form() {
        Form::Spline => 4,
        Form::Chebyshev => axes(table).iter().map(|axis| axis.nodes).max().unwrap_or(1),
    }
}

const SPLINE: &str = "\
/* The cubic B-splines that are not zero in the cell of v in [0, 1], with derivatives by the place in it; returns the cell. */
static inline size_t NAME_spline(double v, size_t nodes, double *value, double *slope)
{
    const double along = v * (double)(nodes - 3);
    size_t cell = (size_t)along;
    double t, r, tt, rr;
    if (cell > nodes - 4) {
        cell = nodes - 4;
    }
    t = along - (double)cell;
    r = 1.0 - t;
    tt = t * t;
    rr = r * r;
    value[0] = rr * r * (1.0 / 6.0);
    value[1] = 2.0 / 3.0 - tt * (1.0 - 0.5 * t);
    value[2] = 2.0 / 3.0 - rr * (1.0 - 0.5 * r);
    value[3] = tt * t * (1.0 / 6.0);
    slope[0] = -0.5 * rr;
    slope[1] = t * (1.5 * t - 2.0);
    slope[2] = r * (2.0 - 1.5 * r);
    slope[3] = 0.5 * tt;
    return cell;
}
";

const CHEBYSHEV: &str = "\
/* T_i(2 u - 1) and its derivatives by u. */
static inline void NAME_chebyshev(double u, size_t orders, double *value, double *slope)
{
    const double x = 2.0 * u - 1.0;
    double before = 1.0, before_by = 0.0, now = x, now_by = 2.0;
    size_t i;
    for (i = 0; i < orders; i++) {
        const double next = 2.0 * x * now - before;
        const double next_by = 2.0 * x * now_by - before_by + 4.0 * now;
        value[i] = before;
        slope[i] = before_by;
        before = now;
        before_by = now_by;
        now = next;
        now_by = next_by;
    }
}
";
