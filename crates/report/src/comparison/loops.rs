//! Loops: the mean of both branches and half the gap between them, measured and modelled.

use bulge_inference::{Comparison, LoopGap};
use bulge_measurements::SweepKind;

use crate::PlotError;
use crate::axis::Axis;
use crate::comparison::legend;
use crate::comparison::levels::{Shown, left_out, specimens};
use crate::comparison::number::newton;
use crate::comparison::panel::{BELOW, Panel, columns};
use crate::comparison::svg::{BOLD, Stroke, Svg, name_fitted};
use crate::comparison::wording::has_effects;
use crate::comparison::{Plot, WIDTH};

/// Most pressure levels that are drawn.
const LEVELS: usize = 6;
/// Most specimens that are drawn, with one row of panels each.
const SPECIMENS: usize = 4;
const HEIGHT: f64 = 240.0;
const HEAD: f64 = 30.0;

/// The plot; `None` without loops.
///
/// # Errors
/// The range of the forces overflows.
pub(crate) fn plot(comparison: &Comparison) -> Result<Option<Plot>, PlotError> {
    let loops: Vec<&LoopGap> = comparison.loops.iter().filter(|gap| !gap.contraction.is_empty()).collect();
    if loops.is_empty() {
        return Ok(None);
    }
    let shown = Shown::new(loops.iter().map(|gap| gap.pressure_pa), LEVELS);
    let all = specimens(loops.iter().map(|gap| &gap.specimen));
    let names = &all[..all.len().min(SPECIMENS)];
    let entries = shown.entries(has_effects(comparison));
    let start = legend::height(&entries, WIDTH - 20.0) + 6.0;
    let row = HEAD + HEIGHT + BELOW;
    let mut svg = Svg::new("loops", WIDTH, start + row * names.len() as f64);
    legend::draw(&mut svg, (6.0, 2.0), WIDTH - 20.0, &entries);
    for (i, name) in names.iter().enumerate() {
        let specimen = if all.len() == 1 { String::new() } else { format!(", specimen {name}") };
        for (kind, (left, width)) in columns(2, WIDTH).into_iter().enumerate() {
            let (x, y) = axes(&loops, kind)?;
            let panel = Panel { x, y, left, top: start + row * i as f64 + HEAD, width, height: HEIGHT };
            let heading = name_fitted(&format!("{}{specimen}", HEADINGS[kind]), BOLD, width);
            panel.draw(&mut svg, &heading, "contraction [%]", QUANTITIES[kind]);
            for gap in loops.iter().filter(|gap| gap.specimen == *name) {
                draw(&mut svg, &panel, gap, kind, &shown, has_effects(comparison));
            }
        }
    }
    let left_out = left_out(names.len(), all.len(), "specimens");
    Ok(Some(Plot {
        name: "loops",
        title: "Mean and half-gap of the loops".to_owned(),
        caption: format!(
            "{} The mean of both branches is the force without friction; half of the gap between them is the friction itself. Dots \
             are measured, lines modelled.{}{left_out}",
            hint(comparison),
            shown.caption()
        ),
        svg: svg.finish("Mean and half-gap of the loops"),
    }))
}

/// The effect of friction on the branches.
fn hint(comparison: &Comparison) -> &'static str {
    if comparison.data.sweep_kinds.contains(&SweepKind::Isometric) {
        "At equal length and pressure, friction and losses of the rubber make a muscle pull harder while it is vented than while it is filled; a pressure that is \
         read late does the reverse."
    } else {
        "A muscle pulls harder while it is lengthened than while it shortens."
    }
}

const HEADINGS: [&str; 2] = ["Mean of both branches", "Half of the gap between them"];
const QUANTITIES: [&str; 2] = ["mean force [N]", "half-gap [N]"];

/// The measured, first and last values of the mean (kind 0) or the half-gap (kind 1).
fn values(gap: &LoopGap, kind: usize) -> [&Vec<f64>; 3] {
    if kind == 0 {
        [&gap.mean_measured_n, &gap.mean_model_n[0], &gap.mean_model_n[1]]
    } else {
        [&gap.half_gap_measured_n, &gap.half_gap_model_n[0], &gap.half_gap_model_n[1]]
    }
}

fn axes(loops: &[&LoopGap], kind: usize) -> Result<(Axis, Axis), PlotError> {
    let across = loops.iter().flat_map(|gap| gap.contraction.iter().map(|c| 100.0 * c));
    let upwards = loops.iter().flat_map(|gap| values(gap, kind)).flatten().copied().chain([0.0]);
    Ok((Axis::few("contraction [%]", 6.0, across)?, Axis::few(QUANTITIES[kind], 6.0, upwards)?))
}

fn draw(svg: &mut Svg, panel: &Panel, gap: &LoopGap, kind: usize, shown: &Shown, has_effects: bool) {
    let Some(colour) = shown.colour(gap.pressure_pa) else { return };
    let [measured, first, last] = values(gap, kind).map(|force| {
        gap.contraction.iter().zip(force).map(|(c, f)| panel.at((100.0 * c, *f))).collect::<Vec<_>>()
    });
    svg.dots(&measured, 2.6, colour, 0.6);
    svg.polyline(&first, Stroke::dashed(colour, 1.0));
    if has_effects {
        svg.polyline(&last, Stroke::solid(colour, 1.8));
    }
}

/// The sentence above the plot.
pub(crate) fn says(comparison: &Comparison) -> String {
    let mean = |kind: usize, which: usize| {
        let all: Vec<f64> =
            comparison.loops.iter().flat_map(|gap| values(gap, kind)[which]).copied().collect();
        all.iter().sum::<f64>() / all.len().max(1) as f64
    };
    let [measured, first, last] = [0, 1, 2].map(|which| mean(1, which));
    let [there, back] = comparison.data.branches;
    let base =
        format!("Half of the gap between {back} and {there} is {} on average; the base", newton(measured));
    let of_base = if first.abs() < 0.01 * measured.abs() {
        "has none".to_owned()
    } else {
        format!("has {}", newton(first))
    };
    if !has_effects(comparison) {
        return format!("{base} {of_base}.");
    }
    if measured <= 0.0 {
        return format!(
            "{base} {of_base}, the model with all effects {}: a muscle with friction would have a gap above zero.",
            newton(last)
        );
    }
    let share = last / measured;
    let meaning = if (share - 1.0).abs() < 0.1 {
        "the friction is there in the right size"
    } else if share < 1.0 {
        "part of the friction is still missing"
    } else {
        "the model has more friction than the muscle"
    };
    format!("{base} {of_base}, the model with all effects {}: {meaning}.", newton(last))
}
