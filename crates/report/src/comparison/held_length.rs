//! Force against pressure at constant lengths, for isometric tests.

use crate::PlotError;
use crate::axis::Axis;
use crate::comparison::Plot;
use crate::comparison::force::by_specimen;
use crate::comparison::legend::{self, Mark};
use crate::comparison::levels::{left_out, specimens, spread};
use crate::comparison::number::percent;
use crate::comparison::panel::Panel;
use crate::comparison::svg::{Stroke, Svg};
use crate::comparison::wording::has_effects;
use crate::palette::{self, Rgb};
use bulge_inference::{Comparison, Curve, CurvePoint};
use bulge_measurements::SweepKind;

/// Most lengths that are drawn, and most panels, one per specimen.
const LENGTHS: usize = 8;
const SPECIMENS: usize = 6;
/// A larger gap between contractions, as a fraction of their range, separates two lengths.
const APART: f64 = 0.03;
/// Smallest range that the fraction refers to: a length is held to within some thousandths.
const LEAST: f64 = 0.05;
const TITLE: &str = "Force against pressure";

/// Whether all sweeps of the test are isometric.
pub(crate) fn is_one(comparison: &Comparison) -> bool {
    let kinds = &comparison.data.sweep_kinds;
    !kinds.is_empty() && kinds.iter().all(|kind| *kind == SweepKind::Isometric)
}

/// The contractions at which the length was held, ascending.
fn lengths(points: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = points.collect();
    all.sort_by(f64::total_cmp);
    let range = all.last().zip(all.first()).map_or(0.0, |(last, first)| last - first);
    let groups = all.chunk_by(|a, b| b - a <= APART * range.max(LEAST));
    groups.map(|group| group.iter().sum::<f64>() / group.len() as f64).collect()
}

/// Index of the length nearest to a contraction.
fn nearest(lengths: &[f64], contraction: f64) -> usize {
    let off = |place: &usize| (lengths[*place] - contraction).abs();
    (0..lengths.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or_default()
}

/// The plot of at least one curve.
///
/// # Errors
/// The range of the pressures or forces overflows.
pub(crate) fn plot(comparison: &Comparison, curves: &[&Curve]) -> Result<Plot, PlotError> {
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let lengths = lengths(points().map(|point| point.contraction));
    let shown = spread(lengths.len(), LENGTHS);
    let all = specimens(curves.iter().map(|curve| &curve.specimen));
    let names = &all[..all.len().min(SPECIMENS)];
    let x = Axis::of("pressure [bar]", points().map(|p| 1e-5 * p.pressure_pa).chain([0.0]))?;
    let y = Axis::of("force [N]", points().flat_map(|p| [p.measured_n, p.first_n, p.last_n]).chain([0.0]))?;
    let colour = |place: usize| palette::colour(shown.len() - 1 - place, shown.len());
    let mut entries = legend::models(has_effects(comparison));
    entries.extend(
        shown.iter().enumerate().map(|(i, length)| (Mark::Box(colour(i)), percent(lengths[*length]))),
    );
    let svg = by_specimen(names, &entries, (x, "pressure [bar]"), y, |svg, panel, name| {
        for (place, length) in shown.iter().enumerate() {
            let here = |point: &&CurvePoint| nearest(&lengths, point.contraction) == *length;
            let of_specimen = curves.iter().filter(|curve| curve.specimen == name);
            let held: Vec<CurvePoint> =
                of_specimen.flat_map(|curve| &curve.points).filter(here).copied().collect();
            draw(svg, panel, &held, colour(place), has_effects(comparison));
        }
    });
    let left_out = left_out(shown.len(), lengths.len(), "lengths");
    Ok(Plot {
        name: "force",
        title: TITLE.to_owned(),
        caption: format!(
            "Dots are readings, lines the model at the same readings; colour is the contraction at which the length was held. The closer the {} lines run \
             through the dots, the better.{left_out}",
            if has_effects(comparison) { "solid" } else { "dashed" }
        ),
        svg: svg.finish("Force against pressure at held lengths, measured and modelled"),
    })
}

/// Readings at one length, and the models on each branch in the order of the pressure.
fn draw(svg: &mut Svg, panel: &Panel, points: &[CurvePoint], colour: Rgb, has_effects: bool) {
    let place = |point: &CurvePoint, force_n: f64| panel.at((1e-5 * point.pressure_pa, force_n));
    let dots: Vec<_> = points.iter().map(|p| place(p, p.measured_n)).collect();
    let (radius, opacity) = if dots.len() < 60 { (2.8, 0.8) } else { (2.6, 0.3) };
    svg.dots(&dots, radius, colour, opacity);
    for sign in [1.0, -1.0] {
        let mut branch: Vec<&CurvePoint> = points.iter().filter(|p| p.direction * sign > 0.0).collect();
        branch.sort_by(|a, b| a.pressure_pa.total_cmp(&b.pressure_pa));
        let line = |of: fn(&CurvePoint) -> f64| branch.iter().map(|p| place(p, of(p))).collect::<Vec<_>>();
        svg.polyline(&line(|p| p.first_n), Stroke::dashed(colour, 1.0));
        if has_effects {
            svg.polyline(&line(|p| p.last_n), Stroke::solid(colour, 1.3));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_told_apart_by_gaps() {
        let found = lengths([0.0101, 0.1, 0.0099, 0.102, 0.05].into_iter());
        assert_eq!(found.len(), 3, "{found:?}");
        assert!((found[0] - 0.01).abs() < 1e-12 && (found[2] - 0.101).abs() < 1e-12);
        assert_eq!([0.0, 0.04, 0.09].map(|c| nearest(&found, c)), [0, 1, 2]);
        // Readings within the noise of one length count as one length.
        assert_eq!(lengths([0.0499, 0.05, 0.0501].into_iter()).len(), 1);
    }
}
