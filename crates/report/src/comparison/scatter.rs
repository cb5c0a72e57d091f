//! Predicted against measured force, before and after, with the line of equality.

use bulge_inference::Comparison;

use crate::PlotError;
use crate::axis::Axis;
use crate::comparison::number::{newton, share};
use crate::comparison::panel::{BELOW, Panel, columns};
use crate::comparison::svg::{Stroke, Svg};
use crate::comparison::wording::{has_effects, names, sentence};
use crate::comparison::{Plot, WIDTH};
use crate::palette::{FIRST, INK, LAST};

const HEAD: f64 = 34.0;
const HEIGHT: f64 = 360.0;

/// The plot; `None` without rows.
///
/// # Errors
/// The range of the forces overflows.
pub(super) fn plot(comparison: &Comparison) -> Result<Option<Plot>, PlotError> {
    let rows = &comparison.scatter;
    if rows.is_empty() {
        return Ok(None);
    }
    let names = names(comparison);
    let values = rows.iter().flat_map(|row| row.iter().take(1 + names.len())).copied();
    let axis = Axis::few("force [N]", 6.0, values)?;
    let mut svg = Svg::new("scatter", WIDTH, HEAD + HEIGHT + BELOW);
    // A single panel is centred.
    let aside = if names.len() == 1 { 0.25 * WIDTH } else { 0.0 };
    for (i, ((left, width), name)) in columns(2, WIDTH).into_iter().zip(&names).enumerate() {
        let left = left + aside;
        let panel = Panel { x: axis, y: axis, left, top: HEAD, width, height: HEIGHT };
        panel.draw(&mut svg, &sentence(name), "measured force [N]", "predicted force [N]");
        let [low, high] = axis.ends();
        svg.line(panel.at((low, low)), panel.at((high, high)), Stroke::solid(INK, 1.0));
        let dots: Vec<_> = rows.iter().map(|row| panel.at((row[0], row[1 + i]))).collect();
        let radius = if dots.len() < 200 { 3.0 } else { 2.0 };
        // Grey fades more than blue.
        let (colour, opacity) = if i == 0 { (FIRST, 0.9) } else { (LAST, 0.5) };
        svg.dots(&dots, radius, colour, opacity);
    }
    Ok(Some(Plot {
        name: "scatter",
        title: "Predicted against measured force".to_owned(),
        caption: "Each dot is one reading. On the line the prediction is exact; above it the model pulls too hard, below it too weakly."
            .to_owned(),
        svg: svg.finish("Predicted against measured force"),
    }))
}

/// The sentence above the plot.
pub(super) fn says(comparison: &Comparison) -> String {
    let (Some(first), Some(last)) = (comparison.ladder.first(), comparison.ladder.last()) else {
        return String::new();
    };
    let [before, after] = [first, last].map(|rung| share(rung.r_squared));
    let better = "The closer the dots lie to the line, the better";
    if has_effects(comparison) {
        format!(
            "{better}: R², which is 1 for a perfect model, is {before} for the base and {after} with all effects; the largest single error \
             that is left is {}.",
            newton(last.largest_n)
        )
    } else {
        format!(
            "{better}: R², which is 1 for a perfect model, is {before}, and the largest single error is {}.",
            newton(first.largest_n)
        )
    }
}
