//! Small panels over the contraction, one per pressure level, with a colour and a dash pattern for each
//! direction of movement.

use bulge_inference::CurveAt;

use crate::PlotError;
use crate::axis::Axis;
use crate::comparison::WIDTH;
use crate::comparison::legend::{self, Mark};
use crate::comparison::levels::{distinct, left_out, same, spread};
use crate::comparison::number::bar;
use crate::comparison::panel::{BELOW, Panel, columns};
use crate::comparison::svg::{Stroke, Svg};
use crate::palette::{CATEGORIES, INK, Rgb};

/// Most panels.
const LEVELS: usize = 6;
const HEIGHT: f64 = 190.0;
const HEAD: f64 = 34.0;

/// Positions of a curve's values on a panel.
pub(super) fn points(at: &CurveAt, panel: &Panel, values: impl IntoIterator<Item = f64>) -> Vec<(f64, f64)> {
    at.contraction.iter().zip(values).map(|(c, value)| panel.at((100.0 * c, value))).collect()
}

/// Colour of a direction.
pub(super) fn colour(direction: f64) -> Rgb {
    if direction > 0.0 {
        CATEGORIES[0]
    } else if direction < 0.0 {
        CATEGORIES[5]
    } else {
        INK
    }
}

/// Line of a direction: lengthening is dashed, so that it can be distinguished in grey too.
pub(super) fn stroke(direction: f64) -> Stroke {
    if direction < 0.0 {
        Stroke::dashed(colour(direction), 2.0)
    } else {
        Stroke::solid(colour(direction), 2.0)
    }
}

/// The directions that occur, with their names: the two branches of a loop, and rest.
pub(super) fn directions(pieces: &[&CurveAt], [there, back]: [&'static str; 2]) -> Vec<(f64, &'static str)> {
    let named = [(1.0, there), (-1.0, back), (0.0, "at rest")];
    named
        .into_iter()
        .filter(|(of, _)| pieces.iter().any(|piece| colour(piece.direction) == colour(*of)))
        .collect()
}

/// What is drawn around the curves.
pub(super) struct Frame<'a> {
    /// Makes the ids of the drawing unique.
    pub(super) name: &'static str,
    /// Title of the drawing.
    pub(super) title: &'a str,
    /// Name of the vertical axis, with its unit.
    pub(super) quantity: &'static str,
    /// The legend.
    pub(super) entries: &'a [(Mark, String)],
}

/// The drawing, and the remark of its caption about levels that aren't shown.
///
/// # Errors
/// The range of the values overflows.
pub(super) fn draw(
    frame: &Frame<'_>,
    pieces: &[&CurveAt],
    values: impl Iterator<Item = f64> + Clone,
    mut draw_piece: impl FnMut(&mut Svg, &Panel, usize),
) -> Result<(String, String), PlotError> {
    let levels = distinct(pieces.iter().map(|piece| piece.pressure_pa));
    let shown: Vec<f64> = spread(levels.len(), LEVELS).into_iter().map(|i| levels[i]).collect();
    let across = pieces.iter().flat_map(|piece| piece.contraction.iter().map(|c| 100.0 * c));
    let x = Axis::few("contraction [%]", 4.0, across)?;
    let y = Axis::few(frame.quantity, 5.0, values.chain([0.0]))?;
    let side_by_side = if shown.len() == 4 { 2 } else { shown.len().clamp(1, 3) };
    let columns = columns(side_by_side, WIDTH);
    let top = legend::height(frame.entries, WIDTH - 20.0) + 4.0;
    let row = HEAD + HEIGHT + BELOW;
    let rows = shown.len().div_ceil(side_by_side) as f64;
    let mut svg = Svg::new(frame.name, WIDTH, top + rows * row);
    legend::draw(&mut svg, (6.0, 2.0), WIDTH - 20.0, frame.entries);
    for (i, level) in shown.iter().enumerate() {
        let (left, width) = columns[i % side_by_side];
        let top = top + row * (i / side_by_side) as f64 + HEAD;
        let panel = Panel { x, y, left, top, width, height: HEIGHT };
        panel.draw(&mut svg, &bar(*level), "contraction [%]", frame.quantity);
        for (place, _) in pieces.iter().enumerate().filter(|(_, piece)| same(piece.pressure_pa, *level)) {
            draw_piece(&mut svg, &panel, place);
        }
    }
    Ok((svg.finish(frame.title), left_out(shown.len(), levels.len(), "pressure levels")))
}
