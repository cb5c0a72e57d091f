//! Contraction against pressure under constant loads, measured and modelled.

use bulge_inference::{Comparison, HeldLoad, HeldLoadPoint};

use crate::PlotError;
use crate::axis::Axis;
use crate::comparison::legend::{self, Mark};
use crate::comparison::levels::{left_out, spread};
use crate::comparison::number::{newton, percent};
use crate::comparison::panel::{BELOW, Panel, columns};
use crate::comparison::svg::{Stroke, Svg};
use crate::comparison::wording::{has_effects, last_model};
use crate::comparison::{Plot, WIDTH};
use crate::palette;

/// Most loads that are drawn.
const LOADS: usize = 6;
/// Loads that differ by less than this fraction of the largest count as one: friction of the guide and the
/// zero of the load cell cause that much.
const SAME: f64 = 0.02;
const HEIGHT: f64 = 340.0;
const TITLE: &str = "Contraction under held loads";

/// The plot; `None` without isotonic sweeps.
///
/// # Errors
/// The range of the pressures or contractions overflows.
pub(crate) fn plot(comparison: &Comparison) -> Result<Option<Plot>, PlotError> {
    let all = &comparison.isotonic;
    if all.is_empty() {
        return Ok(None);
    }
    let mut by_load: Vec<&HeldLoad> = all.iter().collect();
    by_load.sort_by(|a, b| a.load_n.total_cmp(&b.load_n));
    let loads = loads(&by_load);
    let shown: Vec<&[&HeldLoad]> = spread(loads.len(), LOADS).into_iter().map(|i| loads[i]).collect();
    let points = || shown.iter().flat_map(|load| load.iter()).flat_map(|held| &held.points);
    let up = points().flat_map(|p| [p.contraction, p.first, p.last]).map(|c| 100.0 * c);
    let x = Axis::of("pressure [bar]", points().map(|p| p.pressure_pa / 1e5))?;
    let y = Axis::of("contraction [%]", up)?;
    let mut entries = legend::models(has_effects(comparison));
    let colour = |place: usize| palette::colour(place, shown.len());
    entries
        .extend(shown.iter().enumerate().rev().map(|(i, load)| (Mark::Box(colour(i)), newton(mean(load)))));
    let top = legend::height(&entries, WIDTH - 20.0) + 16.0;
    let mut svg = Svg::new("isotonic", WIDTH, top + HEIGHT + BELOW);
    legend::draw(&mut svg, (6.0, 2.0), WIDTH - 20.0, &entries);
    let (left, width) = columns(1, WIDTH)[0];
    let panel = Panel { x, y, left, top, width, height: HEIGHT };
    panel.draw(&mut svg, "", "pressure [bar]", "contraction [%]");
    let sweeps =
        shown.iter().enumerate().flat_map(|(place, load)| load.iter().map(move |held| (place, held)));
    for (place, held) in sweeps {
        let line = |of: fn(&HeldLoadPoint) -> f64| -> Vec<_> {
            held.points.iter().map(|p| panel.at((p.pressure_pa / 1e5, 100.0 * of(p)))).collect()
        };
        svg.dots(&line(|p| p.contraction), 2.6, colour(place), 0.5);
        svg.polyline(&line(|p| p.first), Stroke::dashed(colour(place), 1.0));
        if has_effects(comparison) {
            svg.polyline(&line(|p| p.last), Stroke::solid(colour(place), 1.6));
        }
    }
    let left_out = left_out(shown.len(), loads.len(), "loads");
    Ok(Some(Plot {
        name: "isotonic",
        title: TITLE.to_owned(),
        caption: format!(
            "Dots are readings while the load was held, lines the contractions at which the model bears the load that was read, to first order: \
             reading plus (measured - modelled force) over the model's slope. Force is what was fitted.{left_out}"
        ),
        svg: svg.finish(TITLE),
    }))
}

/// Groups sweeps by load; `by_load` is sorted by load.
fn loads<'a, 'b>(by_load: &'b [&'a HeldLoad]) -> Vec<&'b [&'a HeldLoad]> {
    let largest = by_load.last().map_or(0.0, |held| held.load_n.abs());
    by_load.chunk_by(|a, b| b.load_n - a.load_n <= SAME * largest).collect()
}

/// Mean load of some sweeps \[N\].
fn mean(load: &[&HeldLoad]) -> f64 {
    load.iter().map(|held| held.load_n).sum::<f64>() / load.len().max(1) as f64
}

/// The sentence above the plot.
pub(crate) fn says(comparison: &Comparison) -> String {
    let rms = |which: usize| {
        let squares = comparison.isotonic.iter().map(|held| held.rmse_contraction[which].powi(2));
        (squares.sum::<f64>() / comparison.isotonic.len().max(1) as f64).sqrt()
    };
    let base = format!("Under held loads the base is off by {} of contraction (RMS)", percent(rms(0)));
    if has_effects(comparison) {
        format!("{base}, {} by {}.", last_model(comparison), percent(rms(1)))
    } else {
        format!("{base}.")
    }
}
