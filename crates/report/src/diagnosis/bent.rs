//! An effect by its formula, and with the form error that the data suggest: the starting point for a new
//! formula.

use bulge_inference::{BentCurve, CurveAt, Diagnosis, Missing};

use crate::PlotError;
use crate::comparison::Plot;
use crate::comparison::legend::Mark;
use crate::comparison::svg::{Stroke, Svg};
use crate::diagnosis::headline::bending_says;
use crate::diagnosis::multiples::{Frame, colour, directions, draw, points, stroke};
use crate::palette::SOFT_INK;

/// Names of the drawings; a search adds no more effects.
const NAMES: [&str; 3] = ["bent-1", "bent-2", "bent-3"];
/// Half-width of the 95 % interval in standard deviations.
const SURE: f64 = 1.96;

/// One plot for each effect with a form error, with the sentence above it.
///
/// # Errors
/// The range of the forces overflows.
pub(super) fn with_sentences(diagnosis: &Diagnosis) -> Result<Vec<(Plot, String)>, PlotError> {
    let bent = diagnosis.added().filter_map(|missing| {
        let curves = &missing.form_error.as_ref()?.curves;
        curves.iter().any(|curve| !curve.at.contraction.is_empty()).then_some((missing, &curves[..]))
    });
    bent.zip(NAMES)
        .map(|((missing, curves), name)| {
            let plot = plot(missing, curves, name, diagnosis.comparison.data.branches)?;
            Ok((plot, bending_says(missing).unwrap_or_default()))
        })
        .collect()
}

fn plot(
    missing: &Missing,
    curves: &[BentCurve],
    name: &'static str,
    branches: [&'static str; 2],
) -> Result<Plot, PlotError> {
    let pieces: Vec<&CurveAt> = curves.iter().map(|curve| &curve.at).collect();
    let title = format!("{} by its formula, and as the data want it", missing.effect);
    let mut entries = vec![
        (Mark::Line(Stroke::dashed(SOFT_INK, 1.5)), "by its formula".to_owned()),
        (Mark::Line(Stroke::solid(SOFT_INK, 2.0)), "as the data want it, with its 95 % interval".to_owned()),
    ];
    for (direction, name) in directions(&pieces, branches) {
        entries.push((Mark::Line(stroke(direction)), name.to_owned()));
    }
    let frame = Frame { name, title: &title, quantity: "change of the force [N]", entries: &entries };
    let ends = |c: &BentCurve, side: f64| -> Vec<f64> {
        c.bent_n.iter().zip(&c.sd_n).map(|(bent, sd)| bent + side * SURE * sd).collect()
    };
    let values =
        curves.iter().flat_map(|c| c.formula_n.iter().copied().chain(ends(c, -1.0)).chain(ends(c, 1.0)));
    let each = |svg: &mut Svg, panel: &_, place: usize| {
        let (piece, curve) = (&pieces[place], &curves[place]);
        let mut band = points(piece, panel, ends(curve, -1.0));
        band.extend(points(piece, panel, ends(curve, 1.0)).into_iter().rev());
        svg.veil(&band, colour(piece.direction), 0.18);
        let formula = points(piece, panel, curve.formula_n.iter().copied());
        svg.polyline(&formula, Stroke::dashed(colour(piece.direction), 1.5));
        svg.polyline(&points(piece, panel, curve.bent_n.iter().copied()), stroke(piece.direction));
    };
    let (svg, left_out) = draw(&frame, &pieces, values, each)?;
    let caption = format!(
        "What the effect changes of the force: dashed as the catalogue's formula has it at its best numbers, solid as the data want it, with the 95 % interval of the \
         difference as a band. Where the two lines part, the real effect has another form.{left_out}"
    );
    Ok(Plot { name, title, caption, svg })
}
