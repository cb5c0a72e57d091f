//! A table as JSON. It holds everything in the bytes of the table, so that the lookup can be rebuilt
//! elsewhere.

use bulge_table::Table;
use serde_json::{Value, json};

use super::{axes, coefficients, outputs};

/// Axes, outputs with their certificates, form, edge, coefficients and origin. The documentation of
/// `bulge_table` states the equations of the lookup; the coefficients are in the order of its format. A
/// linear coordinate has the pole `null`.
///
/// Reading the numbers back gives the same bits. Coefficients of single precision are written as the equal
/// double.
#[must_use]
pub fn json(table: &Table<'_>) -> Value {
    let [edge, data] = coefficients(table);
    let [checks, seed] = table.checks();
    // Text that isn't JSON stays text.
    let text = table.text();
    let source = serde_json::from_str(text).unwrap_or_else(|_| Value::from(text));
    let axes: Vec<Value> = axes(table)
        .iter()
        .map(|axis| {
            json!({
                "name": axis.name, "unit": axis.unit, "low": axis.low, "high": axis.high, "pole": axis.pole,
                "scale": axis.scale, "nodes": axis.nodes, "edge_nodes": axis.edge_nodes,
            })
        })
        .collect();
    let outputs: Vec<Value> = outputs(table)
        .iter()
        .map(|output| {
            let c = output.certificate;
            json!({
                "name": output.name, "unit": output.unit,
                "is_singular": output.is_singular, "vanishes": output.vanishes,
                "certificate": {
                    "value_max": c.value_max, "value_rms": c.value_rms, "gradient_max": c.gradient_max,
                    "gradient_rms": c.gradient_rms, "bound": c.bound, "scale": c.scale,
                },
            })
        })
        .collect();
    json!({
        "format": "BulgeTab", "version": bulge_table::format::VERSION,
        "form": table.form().name(), "form_code": table.form().code(), "precision": table.precision(),
        "is_root": table.is_root(), "is_fitted": table.is_fitted(), "edge_error": table.edge_error(),
        "checks": {"points": checks, "seed": seed},
        "axes": axes, "outputs": outputs,
        "edge": edge, "coefficients": data,
        "source": source,
    })
}
