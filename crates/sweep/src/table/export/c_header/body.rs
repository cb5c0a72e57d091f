//! The lookup function in C, written out for the axes and outputs of one table.

use bulge_table::{Axis, Form, Table};
use std::fmt::{self, Write as _};

use super::super::{axes, outputs};
use super::literal::double;
use super::widest;

/// Appends the lookup function. Writing to a string can't fail.
pub(super) fn body(text: &mut String, table: &Table<'_>, name: &str) {
    let _ = written(text, table, name);
}

fn written(text: &mut String, table: &Table<'_>, name: &str) -> fmt::Result {
    let (axes, outputs) = (axes(table), table.outputs());
    let a = axes.len();
    writeln!(
        text,
        "/* All outputs y[o] at x and their derivatives dy[o][i] by the axes; 1 inside the domain, else 0 and nothing is written. */\n\
         static inline int {name}_at(const double x[{a}], double y[{outputs}], double dy[{outputs}][{a}])\n{{\n\
         \x20   double at[{a}], own[{a}], shift[{a}] = {{0.0}}, s, u;\n\
         \x20   double value[{a}][{most}], slope[{a}][{most}];\n\
         \x20   size_t cell[{a}] = {{0}};",
        most = widest(table)
    )?;
    if table.is_fitted() {
        writeln!(text, "    double scale, pole, below, q;")?;
    }
    for (i, axis) in axes.iter().enumerate().skip(1) {
        plain_axis(text, i, axis)?;
    }
    first_axis(text, table, name, &axes)?;
    places(text, table, name, &axes)?;
    let nodes: Vec<usize> = axes.iter().map(|axis| axis.nodes).collect();
    let sum = Sum { prefix: "g", numbers: format!("{name}_coefficients"), first: 0, nodes: &nodes, outputs };
    let count = |i: usize| if table.form() == Form::Spline { 4 } else { nodes[i] };
    sum.write(text, &count, ["cell", "value", "slope"])?;
    if table.form() == Form::Spline {
        for (i, axis) in axes.iter().enumerate() {
            each(text, outputs, 1, &format!("g_by[{i}][o] *= {:?};", (axis.nodes - 3) as f64))?;
        }
    }
    factors(text, table, a)?;
    writeln!(text, "    return 1;\n}}\n")
}

/// Writes the coordinate of an axis with two fixed ends.
fn plain_axis(text: &mut String, i: usize, axis: &Axis<'_>) -> fmt::Result {
    let (low, high, scale) = (double(axis.low), double(axis.high), double(axis.scale));
    writeln!(text, "    if (!(x[{i}] >= {low} && x[{i}] <= {high})) {{\n        return 0;\n    }}")?;
    writeln!(text, "    s = x[{i}] - {low};")?;
    stretched(text, axis.pole)?;
    writeln!(
        text,
        "        at[{i}] = {scale} * q < 1.0 ? {scale} * q : 1.0;\n        own[{i}] = {scale} * by;\n    }}"
    )
}

/// Opens a block with q = s/(s + c) and its derivative.
fn stretched(text: &mut String, pole: f64) -> fmt::Result {
    if pole.is_infinite() {
        return writeln!(text, "    {{\n        const double q = s, by = 1.0;");
    }
    let pole = double(pole);
    writeln!(
        text,
        "    {{\n        const double below = 1.0 / (s + {pole}), q = s * below, by = {pole} * below * below;"
    )
}

/// Writes the coordinate of axis 0, which may be a root and may end at the fitted edge.
fn first_axis(text: &mut String, table: &Table<'_>, name: &str, axes: &[Axis<'_>]) -> fmt::Result {
    let axis = &axes[0];
    let (low, high) = (double(axis.low), double(axis.high));
    // At the lower end itself, the root has no derivative.
    let least = if table.is_root() { double(f64::MIN_POSITIVE) } else { "0.0".to_owned() };
    let end = if table.is_fitted() { String::new() } else { format!(" && x[0] <= {high}") };
    writeln!(text, "    s = x[0] - {low};\n    if (!(s >= {least}{end})) {{\n        return 0;\n    }}")?;
    let by = if table.is_root() {
        writeln!(text, "    own[0] = 0.5 / sqrt(s);\n    s = sqrt(s);")?;
        " * own[0]"
    } else {
        ""
    };
    if table.is_fitted() {
        edge(text, name, axes)?;
        writeln!(
            text,
            "    scale = e[0];\n    pole = e[1];\n    below = 1.0 / (s + pole);\n    q = s * below;\n    u = q * scale;\n    \
             own[0] = scale * pole * below * below{by};"
        )?;
        for i in 1..axes.len() {
            writeln!(text, "    shift[{i}] = q * (e_by[{i}][0] - scale * below * e_by[{i}][1]);")?;
        }
    } else {
        stretched(text, axis.pole)?;
        let scale = double(axis.scale);
        writeln!(text, "        u = q * {scale};\n        own[0] = by * {scale}{by};\n    }}")?;
    }
    let is_singular = outputs(table).iter().any(|output| output.is_singular);
    // Rounding may exceed the ends slightly. The condition also refuses NaN.
    let least = if is_singular { double(f64::MIN_POSITIVE) } else { "0.0".to_owned() };
    let most = double(1.0 + 4.0 * f64::EPSILON);
    writeln!(
        text,
        "    if (!(u >= {least} && u <= {most})) {{\n        return 0;\n    }}\n    at[0] = u < 1.0 ? u : 1.0;"
    )
}

/// Writes the numbers K and c of the edge with their derivatives by the coordinates.
fn edge(text: &mut String, name: &str, axes: &[Axis<'_>]) -> fmt::Result {
    let nodes: Vec<usize> = axes.iter().map(|axis| axis.edge_nodes).collect();
    let a = axes.len();
    writeln!(text, "    size_t e_cell[{a}] = {{0}};\n    double e_value[{a}][4], e_slope[{a}][4];")?;
    for (i, nodes) in nodes.iter().enumerate().skip(1) {
        writeln!(text, "    e_cell[{i}] = {name}_spline(at[{i}], {nodes}, e_value[{i}], e_slope[{i}]);")?;
    }
    let sum = Sum { prefix: "e", numbers: format!("{name}_edge"), first: 1, nodes: &nodes, outputs: 2 };
    sum.write(text, &|_| 4, ["e_cell", "e_value", "e_slope"])?;
    for (i, nodes) in nodes.iter().enumerate().skip(1) {
        each(text, 2, 1, &format!("e_by[{i}][o] *= {:?};", (nodes - 3) as f64))?;
    }
    Ok(())
}

/// Writes the basis functions at the coordinates.
fn places(text: &mut String, table: &Table<'_>, name: &str, axes: &[Axis<'_>]) -> fmt::Result {
    for (i, axis) in axes.iter().enumerate() {
        let nodes = axis.nodes;
        match table.form() {
            Form::Spline => {
                writeln!(text, "    cell[{i}] = {name}_spline(at[{i}], {nodes}, value[{i}], slope[{i}]);")?;
            }
            Form::Chebyshev => {
                writeln!(text, "    {name}_chebyshev(at[{i}], {nodes}, value[{i}], slope[{i}]);")?;
            }
        }
    }
    Ok(())
}

/// A sum of coefficients times basis functions over the axes from `first` on. Like the lookup, it proceeds
/// from the last axis to the first.
struct Sum<'a> {
    /// The result is `prefix[o]` and `prefix_by[i][o]`.
    prefix: &'static str,
    /// The array of the coefficients.
    numbers: String,
    first: usize,
    nodes: &'a [usize],
    outputs: usize,
}

impl Sum<'_> {
    /// Appends the sum. `count` gives the number of functions of an axis; the names are those of cells,
    /// values and slopes.
    fn write(
        &self,
        text: &mut String,
        count: &dyn Fn(usize) -> usize,
        names: [&'static str; 3],
    ) -> fmt::Result {
        let (prefix, outputs, axes) = (self.prefix, self.outputs, self.nodes.len());
        writeln!(
            text,
            "    double {prefix}[{outputs}] = {{0.0}}, {prefix}_by[{axes}][{outputs}] = {{{{0.0}}}};"
        )?;
        self.level(text, self.first, count, names)
    }

    /// Writes the loop over one axis.
    fn level(
        &self,
        text: &mut String,
        axis: usize,
        count: &dyn Fn(usize) -> usize,
        names: [&'static str; 3],
    ) -> fmt::Result {
        let [cell, value, slope] = names;
        let (prefix, outputs, axes) = (self.prefix, self.outputs, self.nodes.len());
        let own =
            |axis: usize| if axis == self.first { prefix.to_owned() } else { format!("{prefix}{axis}") };
        let (sum, part) = (own(axis), own(axis + 1));
        let depth = axis - self.first + 1;
        let pad = "    ".repeat(depth);
        writeln!(text, "{pad}for (size_t k{axis} = 0; k{axis} < {}; k{axis}++) {{", count(axis))?;
        if axis + 1 == axes {
            let mut place = String::new();
            for i in self.first..axes {
                let index = format!("{cell}[{i}] + k{i}");
                place =
                    if place.is_empty() { index } else { format!("({place}) * {} + {index}", self.nodes[i]) };
            }
            writeln!(text, "{pad}    const size_t place = ({place}) * {outputs};")?;
            let from = format!("{}[place + o]", self.numbers);
            each(text, outputs, depth + 1, &format!("{sum}[o] += {value}[{axis}][k{axis}] * {from};"))?;
            each(
                text,
                outputs,
                depth + 1,
                &format!("{sum}_by[{axis}][o] += {slope}[{axis}][k{axis}] * {from};"),
            )?;
        } else {
            writeln!(
                text,
                "{pad}    double {part}[{outputs}] = {{0.0}}, {part}_by[{axes}][{outputs}] = {{{{0.0}}}};"
            )?;
            self.level(text, axis + 1, count, names)?;
            each(text, outputs, depth + 1, &format!("{sum}[o] += {value}[{axis}][k{axis}] * {part}[o];"))?;
            each(
                text,
                outputs,
                depth + 1,
                &format!("{sum}_by[{axis}][o] += {slope}[{axis}][k{axis}] * {part}[o];"),
            )?;
            for later in axis + 1..axes {
                let line =
                    format!("{sum}_by[{later}][o] += {value}[{axis}][k{axis}] * {part}_by[{later}][o];");
                each(text, outputs, depth + 1, &line)?;
            }
        }
        writeln!(text, "{pad}}}")
    }
}

/// Writes a loop over the outputs.
fn each(text: &mut String, outputs: usize, depth: usize, line: &str) -> fmt::Result {
    let pad = "    ".repeat(depth);
    writeln!(text, "{pad}for (size_t o = 0; o < {outputs}; o++) {{\n{pad}    {line}\n{pad}}}")
}

/// Writes the factors (1 - u)^j/u^k of the outputs, and the chain rule.
fn factors(text: &mut String, table: &Table<'_>, axes: usize) -> fmt::Result {
    writeln!(text, "    u = at[0];")?;
    for (o, output) in outputs(table).iter().enumerate() {
        let (factor, by_u) = match (output.vanishes, output.is_singular) {
            (false, false) => ("1.0", "0.0"),
            (true, false) => ("1.0 - u", "-1.0"),
            (false, true) => ("1.0 / u", "-factor * (1.0 / u)"),
            (true, true) => ("(1.0 - u) * (1.0 / u)", "(-1.0 - factor) * (1.0 / u)"),
        };
        writeln!(
            text,
            "    {{\n        const double factor = {factor}, by_u = {by_u};\n        \
             const double along = g_by[0][{o}] * factor + g[{o}] * by_u;\n        \
             y[{o}] = g[{o}] * factor;\n        dy[{o}][0] = along * own[0];"
        )?;
        for i in 1..axes {
            writeln!(
                text,
                "        dy[{o}][{i}] = (g_by[{i}][{o}] * factor + along * shift[{i}]) * own[{i}];"
            )?;
        }
        writeln!(text, "    }}")?;
    }
    if axes == 1 {
        writeln!(text, "    (void)shift;")?;
    }
    if table.form() == Form::Chebyshev {
        writeln!(text, "    (void)cell;")?;
    }
    Ok(())
}
