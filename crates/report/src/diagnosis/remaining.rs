//! The remaining systematic misfit, smoothed, with a band of one standard deviation.

use bulge_inference::{CurveAt, Diagnosis};

use crate::PlotError;
use crate::comparison::Plot;
use crate::comparison::legend::Mark;
use crate::comparison::panel::Panel;
use crate::comparison::svg::Svg;
use crate::diagnosis::multiples::{Frame, colour, directions, draw, points, stroke};

/// The plot; `None` without a surface.
///
/// # Errors
/// The range of the forces overflows.
pub(super) fn plot(diagnosis: &Diagnosis) -> Result<Option<Plot>, PlotError> {
    let curves = &diagnosis.remaining.surface;
    let pieces: Vec<&CurveAt> = curves.iter().map(|curve| &curve.at).collect();
    if pieces.iter().all(|piece| piece.contraction.is_empty()) {
        return Ok(None);
    }
    let mut entries = Vec::new();
    for (direction, name) in directions(&pieces, diagnosis.comparison.data.branches) {
        entries.push((Mark::Line(stroke(direction)), format!("{name}, with one standard deviation")));
    }
    let title = "Systematic misfit that is left";
    let frame = Frame { name: "remaining", title, quantity: "misfit [N]", entries: &entries };
    let ends = |sign: f64| {
        curves.iter().flat_map(move |c| c.misfit_n.iter().zip(&c.sd_n).map(move |(m, sd)| m + sign * sd))
    };
    let each = |svg: &mut Svg, panel: &Panel, place: usize| {
        let (piece, curve) = (&pieces[place], &curves[place]);
        let side = |sign: f64| {
            points(piece, panel, curve.misfit_n.iter().zip(&curve.sd_n).map(move |(m, sd)| m + sign * sd))
        };
        let mut band = side(1.0);
        band.extend(side(-1.0).into_iter().rev());
        svg.veil(&band, colour(piece.direction), 0.16);
        svg.polyline(&points(piece, panel, curve.misfit_n.iter().copied()), stroke(piece.direction));
    };
    let (svg, left_out) = draw(&frame, &pieces, ends(1.0).chain(ends(-1.0)), each)?;
    Ok(Some(Plot {
        name: "remaining",
        title: title.to_owned(),
        caption: format!(
            "What the model with all effects that were found can't follow, smoothed over neighbouring readings. Where the band holds the \
             line of zero there is nothing to explain.{left_out}"
        ),
        svg,
    }))
}
