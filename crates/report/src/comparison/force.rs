//! Force against contraction: measured points and the model before and after, one panel per specimen.

use bulge_inference::{Comparison, Curve, CurvePoint};

use crate::PlotError;
use crate::axis::Axis;
use crate::comparison::held_length;
use crate::comparison::legend::{self, Mark};
use crate::comparison::levels::{Shown, left_out, specimens};
use crate::comparison::number::{bar, newton};
use crate::comparison::panel::{BELOW, Panel, columns};
use crate::comparison::svg::{BOLD, Stroke, Svg, name_fitted};
use crate::comparison::wording::{has_effects, named, pulls, sentence};
use crate::comparison::{Plot, WIDTH};

/// Most pressure levels in one panel.
const LEVELS: usize = 8;
/// Most panels.
const SPECIMENS: usize = 6;

/// The plot; `None` without curves.
///
/// # Errors
/// The range of the forces overflows.
pub(crate) fn plot(comparison: &Comparison) -> Result<Option<Plot>, PlotError> {
    let curves: Vec<&Curve> = comparison.curves.iter().filter(|curve| !curve.points.is_empty()).collect();
    if curves.is_empty() {
        return Ok(None);
    }
    if held_length::is_one(comparison) {
        return held_length::plot(comparison, &curves).map(Some);
    }
    let shown = Shown::new(curves.iter().map(|curve| curve.pressure_pa), LEVELS);
    let all = specimens(curves.iter().map(|curve| &curve.specimen));
    let names = &all[..all.len().min(SPECIMENS)];
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let x = Axis::of("contraction [%]", points().map(|p| 100.0 * p.contraction))?;
    let y = Axis::of("force [N]", points().flat_map(|p| [p.measured_n, p.first_n, p.last_n]).chain([0.0]))?;
    let entries = shown.entries(has_effects(comparison));
    let svg = by_specimen(names, &entries, (x, "contraction [%]"), y, |svg, panel, name| {
        for curve in curves.iter().filter(|curve| curve.specimen == name) {
            draw_curve(svg, panel, curve, &shown, has_effects(comparison));
        }
    });
    let specimens = left_out(names.len(), all.len(), "specimens");
    Ok(Some(Plot {
        name: "force",
        title: "Force against contraction".to_owned(),
        caption: format!(
            "Dots are readings, lines the model at the same readings; colour is the pressure. The closer the {} lines run through the \
             dots, the better.{}{specimens}",
            if has_effects(comparison) { "solid" } else { "dashed" },
            shown.caption()
        ),
        svg: svg.finish("Force against contraction, measured and modelled"),
    }))
}

/// Forces in one panel for each specimen, under a legend.
pub(super) fn by_specimen(
    names: &[&str],
    entries: &[(Mark, String)],
    (x, across): (Axis, &str),
    y: Axis,
    draw: impl Fn(&mut Svg, &Panel, &str),
) -> Svg {
    let (in_a_row, height, head) = if names.len() == 1 { (1, 380.0, 10.0) } else { (2, 250.0, 30.0) };
    let start = legend::height(entries, WIDTH - 20.0) + 6.0;
    let row = head + height + BELOW;
    let mut svg = Svg::new("force", WIDTH, start + row * names.len().div_ceil(in_a_row) as f64);
    legend::draw(&mut svg, (6.0, 2.0), WIDTH - 20.0, entries);
    let columns = columns(in_a_row, WIDTH);
    for (i, name) in names.iter().enumerate() {
        let (left, width) = columns[i % in_a_row];
        let panel = Panel { x, y, left, top: start + row * (i / in_a_row) as f64 + head, width, height };
        let heading = if names.len() == 1 {
            String::new()
        } else {
            name_fitted(&format!("specimen {name}"), BOLD, width)
        };
        panel.draw(&mut svg, &heading, across, "force [N]");
        draw(&mut svg, &panel, name);
    }
    svg
}

fn draw_curve(svg: &mut Svg, panel: &Panel, curve: &Curve, shown: &Shown, has_effects: bool) {
    let Some(colour) = shown.colour(curve.pressure_pa) else { return };
    let place = |p: &CurvePoint, force_n: f64| panel.at((100.0 * p.contraction, force_n));
    let dots: Vec<_> = curve.points.iter().map(|p| place(p, p.measured_n)).collect();
    // A few dots must be visible, many must not hide the lines.
    let (radius, opacity, line) = if dots.len() < 60 { (2.8, 0.8, 1.8) } else { (2.6, 0.3, 1.3) };
    svg.dots(&dots, radius, colour, opacity);
    for stretch in stretches(&curve.points) {
        let mut points: Vec<_> = stretch.iter().map(|p| place(p, p.first_n)).collect();
        // The dashes of both branches coincide if both lines start on the left.
        if points.first() > points.last() {
            points.reverse();
        }
        svg.polyline(&points, Stroke::dashed(colour, 1.0));
        if has_effects {
            let points: Vec<_> = stretch.iter().map(|p| place(p, p.last_n)).collect();
            svg.polyline(&points, Stroke::solid(colour, line));
        }
    }
}

/// Splits points into runs in one direction: no line may run from the end of one sweep to the start of the
/// next.
fn stretches(points: &[CurvePoint]) -> Vec<&[CurvePoint]> {
    let steps: Vec<f64> = points.windows(2).map(|p| (p[1].contraction - p[0].contraction).abs()).collect();
    let mut sorted = steps.clone();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let (low, high) = crate::axis::range(points.iter().map(|p| p.contraction)).unwrap_or((0.0, 0.0));
    // The larger threshold holds, because a coarse static map has steps of a tenth of its range.
    let jump = (6.0 * usual).max(0.15 * (high - low));
    let mut found = Vec::new();
    let mut start = 0;
    for (i, step) in steps.iter().enumerate() {
        let turns = points[i].direction * points[i + 1].direction < 0.0;
        if turns || *step > jump {
            found.push(&points[start..=i]);
            start = i + 1;
        }
    }
    found.push(&points[start..]);
    found
}

/// Mean error of the first and the last rung along one curve \[N\].
fn mean_errors(curve: &Curve) -> [f64; 2] {
    let n = curve.points.len().max(1) as f64;
    let mean = |error: fn(&CurvePoint) -> f64| curve.points.iter().map(error).sum::<f64>() / n;
    [mean(|p| p.measured_n - p.first_n), mean(|p| p.measured_n - p.last_n)]
}

/// The sentence above the plot.
pub(crate) fn says(comparison: &Comparison) -> String {
    let worst = |rung: usize| {
        let errors = comparison.curves.iter().map(|curve| (curve, mean_errors(curve)[rung]));
        errors.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    };
    let (Some((first, before)), Some((last, after))) = (worst(0), worst(1)) else { return String::new() };
    let several = specimens(comparison.curves.iter().map(|curve| &curve.specimen)).len() > 1;
    let place = |curve: &Curve| {
        let specimen =
            if several { format!(" on {}", named("specimen", &curve.specimen)) } else { String::new() };
        format!("at {}{specimen}", bar(curve.pressure_pa))
    };
    let base = format!(
        "{} the base {} on average{}.",
        sentence(&place(first)),
        pulls(before),
        if comparison.curves.len() > 1 { ": there it is furthest off" } else { "" }
    );
    if has_effects(comparison) {
        format!("{base} With all effects the largest mean error is {}, {}.", newton(after.abs()), place(last))
    } else {
        base
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_breaks_between_sweeps_only() {
        let point = |i: i32| CurvePoint {
            pressure_pa: 2e5,
            contraction: 0.01 * f64::from(i),
            direction: 1.0,
            measured_n: 0.0,
            first_n: 0.0,
            last_n: 0.0,
        };
        let points: Vec<_> = (0..20).chain(0..20).map(point).collect();
        let lengths: Vec<_> = stretches(&points).iter().map(|s| s.len()).collect();
        assert_eq!(lengths, [20, 20]);
        let mut turning: Vec<_> = (0..5).chain((0..5).rev()).map(point).collect();
        turning[5..].iter_mut().for_each(|p| p.direction = -1.0);
        assert_eq!(stretches(&turning).iter().map(|s| s.len()).collect::<Vec<_>>(), [5, 5]);
        let coarse: Vec<_> = [0, 5, 12, 20].map(point).into();
        assert_eq!(stretches(&coarse).len(), 1);
        assert_eq!(stretches(&[]).len(), 1);
    }
}
