//! What each added effect explains: the misfit before it as dots, its contribution as a line.

use bulge_inference::{CurveAt, Diagnosis, ExplainedStep};

use crate::PlotError;
use crate::comparison::Plot;
use crate::comparison::legend::Mark;
use crate::comparison::number::newton;
use crate::comparison::svg::{Stroke, Svg};
use crate::diagnosis::multiples::{Frame, colour, directions, draw, points, stroke};
use crate::palette::SOFT_INK;

/// Names of the drawings; later steps have none.
const NAMES: [&str; 6] =
    ["explained-1", "explained-2", "explained-3", "explained-4", "explained-5", "explained-6"];

/// One plot for each step that has curves.
///
/// # Errors
/// The range of the forces overflows.
pub(super) fn plots(diagnosis: &Diagnosis) -> Result<Vec<Plot>, PlotError> {
    Ok(with_sentences(diagnosis)?.into_iter().map(|(plot, _)| plot).collect())
}

/// The plots, each with the sentence above it.
///
/// # Errors
/// As [`plots`].
pub(super) fn with_sentences(diagnosis: &Diagnosis) -> Result<Vec<(Plot, String)>, PlotError> {
    let steps =
        diagnosis.explained.iter().filter(|step| step.curves.iter().any(|c| !c.at.contraction.is_empty()));
    steps
        .zip(NAMES)
        .map(|(step, name)| Ok((plot(step, name, diagnosis.comparison.data.branches)?, says(step))))
        .collect()
}

fn plot(step: &ExplainedStep, name: &'static str, branches: [&'static str; 2]) -> Result<Plot, PlotError> {
    let pieces: Vec<&CurveAt> = step.curves.iter().map(|curve| &curve.at).collect();
    let title = format!("What {} explains", step.effect);
    let mut entries = vec![
        (Mark::Dot(SOFT_INK), "misfit before it was added".to_owned()),
        (Mark::Line(Stroke::solid(SOFT_INK, 2.0)), "what it changes".to_owned()),
    ];
    for (direction, name) in directions(&pieces, branches) {
        entries.push((Mark::Line(stroke(direction)), name.to_owned()));
    }
    let frame = Frame { name, title: &title, quantity: "misfit [N]", entries: &entries };
    let values = step.curves.iter().flat_map(|c| c.before_n.iter().chain(&c.explained_n).copied());
    let each = |svg: &mut Svg, panel: &_, place: usize| {
        let (piece, curve) = (&pieces[place], &step.curves[place]);
        svg.dots(&points(piece, panel, curve.before_n.iter().copied()), 2.6, colour(piece.direction), 0.65);
        svg.polyline(&points(piece, panel, curve.explained_n.iter().copied()), stroke(piece.direction));
    };
    let (svg, left_out) = draw(&frame, &pieces, values, each)?;
    Ok(Plot {
        name,
        title,
        caption: format!(
            "A dot is the mean misfit (measured less modelled) of neighbouring readings before the effect was added; the line is what \
             the model changes with it, all its numbers fitted again. The effect is right where the line runs through the dots.{left_out}"
        ),
        svg,
    })
}

/// The sentence above a plot: the fraction of the squared mean misfit that the step removes.
fn says(step: &ExplainedStep) -> String {
    let pairs = || step.curves.iter().flat_map(|c| c.before_n.iter().zip(&c.explained_n));
    let count = pairs().count().max(1) as f64;
    let before = pairs().map(|(before, _)| before * before).sum::<f64>();
    let after = pairs().map(|(before, explained)| (before - explained).powi(2)).sum::<f64>();
    let [from, to] = [before, after].map(|sum| newton((sum / count).sqrt()));
    let part = if before > 0.0 { (1.0 - after / before).max(0.0) } else { 0.0 };
    format!(
        "With {} the mean misfit (RMS over the dots) goes from {from} to {to}: it explains {:.0} % of what varied.",
        step.effect,
        100.0 * part
    )
}
