//! The posterior of a fit: each parameter alone, and each pair.

use bulge_inference::{Posterior, PosteriorParameter};
use std::f64::consts::TAU;

use crate::PlotError;
use crate::axis::Axis;
use crate::comparison::panel::Panel;
use crate::comparison::svg::{Anchor, Stroke, Style, Svg, fitted};
use crate::interval::with_interval;
use crate::palette::{ALERT, GRID, INK, LAST, SOFT_INK};

/// Width and height of a panel, with the space for its labels.
const CELL: (f64, f64) = (172.0, 150.0);
const LEFT: f64 = 30.0;
const TOP: f64 = 56.0;
const SPACE: (f64, f64) = (52.0, 44.0);
/// Bars of a panel on the diagonal.
const BARS: usize = 24;
/// Dots of a pair.
const DOTS: usize = 400;
/// Semi-axes of the ellipse that holds 95 % of a normal distribution in two dimensions: the root of 5.991.
const ELLIPSE: f64 = 2.447_75;
/// Most parameters that are drawn: beyond them nobody reads the panels.
const MOST: usize = 10;

/// Draws the posterior of a fit as an SVG document: on the diagonal the draws of each parameter as bars and
/// its profile likelihood as a line, below it the draws of each pair as dots, with the ellipse of 95 % that
/// the covariance gives. Nuisance parameters are left out, and all beyond the tenth.
///
/// # Errors
/// There is no parameter, or a value isn't finite.
pub fn posterior_svg(title: &str, posterior: &Posterior) -> Result<String, PlotError> {
    let all = 0..posterior.parameters.len();
    let shown: Vec<usize> = all.filter(|place| !posterior.parameters[*place].nuisance).take(MOST).collect();
    if shown.is_empty() || posterior.draws.is_empty() {
        return Err(PlotError::NoCurves);
    }
    let axes: Vec<Axis> = shown
        .iter()
        .map(|place| {
            let profile = &posterior.parameters[*place].profile;
            // To three standard deviations: beyond them stand single draws.
            let near = profile.iter().filter(|[_, rise]| *rise <= 9.5).map(|[value, _]| *value);
            let quantiles = posterior.parameters[*place].quantiles;
            Axis::few("a parameter", 3.0, near.chain(quantiles))
        })
        .collect::<Result<_, _>>()?;
    let count = shown.len() as f64;
    let (width, height) = ((LEFT + count * CELL.0 + 8.0).max(560.0), TOP + count * CELL.1 + 18.0);
    let mut svg = Svg::new("posterior", width, height);
    svg.text((0.5 * width, 18.0), title, Style::new(Anchor::Middle).size(15.0));
    let legend = "bars and dots: draws; line: profile likelihood; ellipse: 95 % by the covariance";
    svg.text((0.5 * width, 38.0), legend, Style::new(Anchor::Middle).size(11.0).colour(SOFT_INK));
    for (row, place) in shown.iter().enumerate() {
        for (column, other) in shown.iter().enumerate().take(row + 1) {
            let corner = (LEFT + column as f64 * CELL.0, TOP + row as f64 * CELL.1);
            let panel = |y: Axis| Panel {
                x: axes[column],
                y,
                left: corner.0 + SPACE.0 - LEFT,
                top: corner.1 + 14.0,
                width: CELL.0 - SPACE.0,
                height: CELL.1 - SPACE.1,
            };
            if row == column {
                let unit = Axis::few("a likelihood", 2.0, [0.0, 1.0].into_iter())?;
                alone(&mut svg, &panel(unit), posterior, *place);
            } else {
                together(&mut svg, &panel(axes[row]), posterior, [*other, *place]);
            }
        }
    }
    Ok(svg.finish(title))
}

/// Name of a parameter with its unit.
fn name(parameter: &PosteriorParameter) -> String {
    let specimen = parameter.specimen.as_ref().map_or_else(String::new, |name| format!(" {name}"));
    let unit = if parameter.unit == "1" { String::new() } else { format!(" [{}]", parameter.unit) };
    format!("{}{specimen}{unit}", parameter.name)
}

/// Draws of one parameter, and its profile.
fn alone(svg: &mut Svg, panel: &Panel, posterior: &Posterior, place: usize) {
    let parameter = &posterior.parameters[place];
    let [low, high] = panel.x.ends();
    let mut bars = [0_usize; BARS];
    for draw in &posterior.draws {
        let share = (draw[place] - low) / (high - low);
        if (0.0..1.0).contains(&share) {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
            let bar = (share * BARS as f64) as usize;
            bars[bar] += 1;
        }
    }
    let most = bars.iter().copied().max().unwrap_or(0).max(1) as f64;
    let labels = panel.draw_grid(svg);
    for (bar, count) in bars.iter().enumerate() {
        let at = |edge: usize| panel.across(low + (high - low) * edge as f64 / BARS as f64);
        let height = panel.height * *count as f64 / most;
        svg.rect((at(bar), panel.bottom() - height), (at(bar + 1) - at(bar) - 0.5, height), GRID);
    }
    let likelihood = |[value, rise]: &[f64; 2]| panel.at((*value, (-0.5 * rise).exp()));
    let inside: Vec<[f64; 2]> =
        finely(&parameter.profile).into_iter().filter(|[value, _]| (low..=high).contains(value)).collect();
    svg.polyline(&inside.iter().map(likelihood).collect::<Vec<_>>(), Stroke::solid(LAST, 1.8));
    panel.draw_across(svg, &labels, &fitted(&name(parameter), 12.0, panel.width + 40.0));
    let [least, _, _, _, most] = parameter.quantiles;
    let shown = with_interval(parameter.value, [least, most]);
    let says = shown.map_or_else(String::new, |[value, low, high]| format!("{value} ({low} to {high})"));
    let style = Style::new(Anchor::Middle).size(11.0).colour(INK);
    svg.text((panel.left + 0.5 * panel.width, panel.top - 8.0), &says, style);
}

/// The profile between its points: its root is nearly straight in the parameter, on either side of the minimum.
fn finely(profile: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let root = |[value, rise]: [f64; 2], is_left: bool| {
        [value, rise.max(0.0).sqrt() * if is_left { -1.0 } else { 1.0 }]
    };
    let Some(least) = profile.iter().position(|[_, rise]| *rise <= 0.0) else { return profile.to_vec() };
    let signed: Vec<[f64; 2]> =
        profile.iter().enumerate().map(|(i, point)| root(*point, i < least)).collect();
    let between = |pair: &[[f64; 2]]| {
        let [[x0, z0], [x1, z1]] = [pair[0], pair[1]];
        (0..16).map(move |k| {
            let part = f64::from(k) / 16.0;
            [x0 + part * (x1 - x0), (z0 + part * (z1 - z0)).powi(2)]
        })
    };
    signed.windows(2).flat_map(between).chain(profile.last().copied()).collect()
}

/// Draws of two parameters, and the ellipse of their covariance.
fn together(svg: &mut Svg, panel: &Panel, posterior: &Posterior, [across, up]: [usize; 2]) {
    panel.draw(svg, "", "", "");
    let inside = |(x, y): &(f64, f64)| {
        (panel.left..=panel.right()).contains(x) && (panel.top..=panel.bottom()).contains(y)
    };
    let every = (posterior.draws.len() / DOTS).max(1);
    let dots: Vec<(f64, f64)> = posterior
        .draws
        .iter()
        .step_by(every)
        .map(|draw| panel.at((draw[across], draw[up])))
        .filter(inside)
        .collect();
    svg.dots(&dots, 1.4, LAST, 0.35);
    let count = posterior.parameters.len();
    let c = |i: usize, j: usize| posterior.covariance.get(i * count + j).copied().unwrap_or(f64::NAN);
    let (a, b, d) = (c(across, across).sqrt(), c(across, up), c(up, up));
    let rest = (d - (b / a).powi(2)).max(0.0).sqrt();
    if !(a > 0.0 && rest.is_finite()) {
        return;
    }
    let [x, y] = [across, up].map(|place| posterior.parameters[place].value);
    let edge: Vec<(f64, f64)> = (0..=72)
        .map(|k| {
            let (sin, cos) = (TAU * f64::from(k) / 72.0).sin_cos();
            panel.at((x + ELLIPSE * a * cos, y + ELLIPSE * (b / a * cos + rest * sin)))
        })
        .collect();
    for run in edge.split(|point| !inside(point)) {
        svg.polyline(run, Stroke::solid(ALERT, 1.4));
    }
}
