//! Fitted parameters with their intervals, each on its own scale with its plausible range shaded.

use bulge_inference::{Comparison, Fitted};

use crate::comparison::correlations::HIGH;
use crate::comparison::legend::{self, Mark};
use crate::comparison::number::count;
use crate::comparison::parameters_table::{interval, label, value};
use crate::comparison::svg::{Anchor, Stroke, Style, Svg, TEXT, fitted};
use crate::comparison::wording::last_fit;
use crate::comparison::{Plot, WIDTH};
use crate::palette::{ALERT, GRID, INK, LAST, Rgb, SOFT_INK};
const NAMES: f64 = 250.0;
const NUMBERS: f64 = 250.0;
/// Colour of a plausible range.
const SHADE: Rgb = Rgb(222, 235, 222);
/// How far a scale reaches beyond the plausible range, in widths of it.
const BEYOND: f64 = 2.0;

/// The plot; `None` if nothing was fitted.
pub(crate) fn plot(comparison: &Comparison) -> Option<Plot> {
    let parameters = &last_fit(comparison)?.parameters;
    if parameters.is_empty() {
        return None;
    }
    let entries = [
        (Mark::Box(SHADE), "plausible range".to_owned()),
        (Mark::Dot(LAST), "value with 95 % interval".to_owned()),
        (Mark::Dot(ALERT), "not plausible, at a bound or not determined".to_owned()),
        (Mark::Dot(SOFT_INK), "nuisance".to_owned()),
    ];
    let top = legend::height(&entries, WIDTH - 20.0) + 8.0;
    let row = if parameters.len() > 16 { 20.0 } else { 28.0 };
    let mut svg = Svg::new("parameters", WIDTH, top + row * parameters.len() as f64 + 8.0);
    legend::draw(&mut svg, (6.0, 2.0), WIDTH - 20.0, &entries);
    for (i, parameter) in parameters.iter().enumerate() {
        draw(&mut svg, parameter, (top + (i as f64 + 0.5) * row, row));
    }
    Some(Plot {
        name: "parameters",
        title: "Fitted numbers with their intervals".to_owned(),
        caption: "Each row has a scale of its own. A value outside the green range lowers the error for the wrong reason. An arrow \
                  means that the interval goes on beyond the drawing."
            .to_owned(),
        svg: svg.finish("Fitted numbers with intervals and plausible ranges"),
    })
}

/// Ends of the scale of a row: they cover the plausible range and the interval, but at most [`BEYOND`] widths
/// beyond the plausible range.
fn ends(parameter: &Fitted) -> (f64, f64) {
    let [low, high] = parameter.plausible_range;
    let finite = |ends: [f64; 2]| ends[0].is_finite() && ends[1].is_finite() && ends[1] > ends[0];
    let size = parameter.value.abs().max(1e-300);
    if !finite([low, high]) {
        // Without a plausible range the interval fills the middle.
        let [a, b] = [parameter.low, parameter.high];
        let half = if finite([a, b]) { b - a } else { size };
        return (parameter.value - half, parameter.value + half);
    }
    let width = high - low;
    let within = |v: f64| if v.is_finite() { v } else { parameter.value };
    let least = within(parameter.low).min(parameter.value).min(low).max(low - BEYOND * width);
    let most = within(parameter.high).max(parameter.value).max(high).min(high + BEYOND * width);
    let margin = 0.08 * (most - least);
    (least - margin, most + margin)
}

/// Colour of a value by what is to be said about it.
fn colour(parameter: &Fitted) -> Rgb {
    if !parameter.plausible || parameter.at_bound.is_some() || !parameter.determined {
        ALERT
    } else if parameter.nuisance {
        SOFT_INK
    } else {
        LAST
    }
}

fn draw(svg: &mut Svg, parameter: &Fitted, (y, row): (f64, f64)) {
    let (low, high) = ends(parameter);
    let (left, right) = (NAMES, WIDTH - NUMBERS);
    let place = |v: f64| {
        let share = (v - low) / (high - low);
        // An unbounded end is drawn at the edge.
        left + (right - left) * if share.is_nan() { 0.5 } else { share.clamp(0.0, 1.0) }
    };
    let ink = colour(parameter);
    let name = fitted(&label(parameter), TEXT, NAMES - 20.0);
    svg.text((NAMES - 10.0, y), &name, Style::new(Anchor::End));
    svg.rect((left, y - 0.4 * row), (right - left, 0.8 * row), Rgb(248, 248, 248));
    let [a, b] = parameter.plausible_range.map(place);
    svg.rect((a, y - 0.4 * row), (b - a, 0.8 * row), SHADE);
    svg.line((left, y), (right, y), Stroke::solid(GRID, 1.0));
    let [a, b] = [parameter.low, parameter.high].map(place);
    svg.line((a, y), (b, y), Stroke::solid(ink, 2.0));
    for (end, x, side) in [(parameter.low, a, 1.0), (parameter.high, b, -1.0)] {
        if end < low || end > high {
            svg.polygon(&[(x, y), (x + 7.0 * side, y - 4.0), (x + 7.0 * side, y + 4.0)], ink);
        } else {
            svg.line((x, y - 4.0), (x, y + 4.0), Stroke::solid(ink, 2.0));
        }
    }
    svg.dots(&[(place(parameter.value), y)], 4.0, ink, 1.0);
    let words = format!("{} {}", value(parameter), interval(parameter));
    svg.text((right + 10.0, y), &fitted(&words, TEXT, NUMBERS - 14.0), Style::new(Anchor::Start).colour(INK));
}

/// The sentences above the plot.
pub(crate) fn says(comparison: &Comparison) -> String {
    fitted_says(comparison) + &held_says(comparison)
}

/// The parameters that were fixed or tied; empty if there are none.
fn held_says(comparison: &Comparison) -> String {
    let held = comparison.ladder.last().map_or(&[][..], |rung| &rung.held);
    if held.is_empty() {
        return String::new();
    }
    let all: Vec<String> = held.iter().map(ToString::to_string).collect();
    format!(" Not fitted: {}.", all.join(", "))
}

fn fitted_says(comparison: &Comparison) -> String {
    let Some(fit) = last_fit(comparison).filter(|fit| !fit.parameters.is_empty()) else {
        return "Nothing was fitted: all numbers are those of the muscle file and of the literature."
            .to_owned();
    };
    let number = |holds: fn(&Fitted) -> bool| fit.parameters.iter().filter(|p| holds(p)).count();
    let fitted = count(fit.parameters.len(), "number");
    let were = if fit.parameters.len() == 1 { "was" } else { "were" };
    let mut remarks = Vec::new();
    let mut remark = |number: usize, says: &str| {
        if number > 0 {
            remarks.push(format!("{number} {says}"));
        }
    };
    remark(number(|p| !p.plausible), "outside the plausible range (a wrong cure)");
    remark(number(|p| p.at_bound.is_some()), "at a bound of the search");
    remark(number(|p| !p.determined), "not determined by these data");
    if remarks.is_empty() {
        let told_apart = fit
            .correlations
            .chunks(fit.parameters.len())
            .enumerate()
            .all(|(i, row)| row.iter().enumerate().all(|(j, r)| i == j || r.abs() <= HIGH));
        let data = if told_apart {
            "the data determine them"
        } else {
            "but not all can be told apart (see the correlations)"
        };
        format!("{fitted} {were} fitted: all are plausible, {}{data}.", if told_apart { "and " } else { "" })
    } else {
        format!(
            "{fitted} {were} fitted: {}. Do not use the values that are marked elsewhere.",
            remarks.join(", ")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(value: f64, low: f64, high: f64, plausible_range: [f64; 2]) -> Fitted {
        Fitted {
            effect: "a".to_owned(),
            name: "b".to_owned(),
            specimen: None,
            value,
            low,
            high,
            unit: "N".to_owned(),
            interval: "covariance",
            at_bound: None,
            plausible: true,
            plausible_range,
            determined: true,
            nuisance: false,
            also: None,
            about: String::new(),
        }
    }

    #[test]
    fn a_scale_holds_value_interval_and_plausible_range() {
        let (low, high) = ends(&parameter(5.0, 4.0, 6.0, [0.0, 10.0]));
        assert!(low < 0.0 && low > -1.0 && high > 10.0 && high < 11.0);
        let (low, high) = ends(&parameter(1e6, -1e9, 1e9, [0.0, 10.0]));
        assert!(low > -30.0 && high < 40.0, "{low} {high}");
    }

    #[test]
    fn open_ranges_have_a_scale() {
        for (low, high) in [
            ends(&parameter(5.0, 4.0, 6.0, [0.0, f64::INFINITY])),
            ends(&parameter(5.0, f64::NEG_INFINITY, f64::INFINITY, [f64::NEG_INFINITY, f64::INFINITY])),
            ends(&parameter(0.0, f64::NEG_INFINITY, f64::INFINITY, [0.0, 0.0])),
            ends(&parameter(5.0, f64::NEG_INFINITY, 6.0, [0.0, 10.0])),
        ] {
            assert!(low.is_finite() && high.is_finite() && low < high, "{low} {high}");
        }
    }
}
