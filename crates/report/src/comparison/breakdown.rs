//! Breakdown of the error: mean and RMS error by pressure, contraction, direction, rate, time, sweep and
//! specimen, before and after.

use crate::PlotError;
use crate::axis::Axis;
use crate::comparison::legend::{self, Mark};
use crate::comparison::number::{level, newton, ticks};
use crate::comparison::panel::{BELOW, LEFT, Panel, columns};
use crate::comparison::svg::{Anchor, Stroke, Style, Svg, TEXT, name_fitted};
use crate::comparison::wording::{has_effects, named, names, negligible_n, pulls, sentence};
use crate::comparison::{Plot, WIDTH};
use crate::palette::{ALERT, FIRST, INK, LAST, Rgb};
use bulge_inference::{Bin, Breakdown, Comparison};

/// Most rows of a plot of named groups.
const MOST_ROWS: usize = 40;

/// Wording of the page for a variable.
struct Variable {
    /// Name of the variable in the comparison.
    name: &'static str,
    /// File name of its plot.
    plot: &'static str,
    /// Heading.
    title: &'static str,
    /// Wording if no group deviates.
    nowhere: &'static str,
    /// What a dependence of the error on the variable points to.
    hint: &'static str,
}

const VARIABLES: [Variable; 8] = [
    Variable {
        name: "pressure",
        plot: "error-by-pressure",
        title: "Error by pressure",
        nowhere: "at no pressure",
        hint: "something that depends on the pressure, or to a gauge that reads wrongly",
    },
    Variable {
        name: "contraction",
        plot: "error-by-contraction",
        title: "Error by contraction",
        nowhere: "at no contraction",
        hint: "the shape of the force curve: geometry, elasticity, or the zero of the length",
    },
    Variable {
        name: "direction",
        plot: "error-by-direction",
        title: "Error by direction",
        nowhere: "in no direction",
        hint: "something that depends on the direction: friction or hysteresis",
    },
    Variable {
        name: "rate",
        plot: "error-by-rate",
        title: "Error by rate of contraction",
        nowhere: "at no rate",
        hint: "something that depends on the speed or the direction: friction, or viscous losses",
    },
    Variable {
        name: "time",
        plot: "error-by-time",
        title: "Error by time",
        nowhere: "in no stretch of time",
        hint: "something that changes in the course of the measurement: creep, warming, a drifting sensor, or the specimen",
    },
    Variable {
        name: "sweep",
        plot: "error-by-sweep",
        title: "Error by sweep",
        nowhere: "in no sweep",
        hint: "sweeps that differ from one another: running-in, a drifting sensor, or the specimen",
    },
    Variable {
        name: "specimen",
        plot: "error-by-specimen",
        title: "Error by specimen",
        nowhere: "on no specimen",
        hint: "specimens that differ: each may need a number of its own",
    },
    Variable {
        name: "temperature",
        plot: "error-by-temperature",
        title: "Error by temperature",
        nowhere: "at no temperature",
        hint: "something that depends on the temperature: the rubber, or a sensor",
    },
];

/// One plot for each variable that varies.
///
/// # Errors
/// The range of the errors overflows.
pub(super) fn plots(comparison: &Comparison) -> Result<Vec<Plot>, PlotError> {
    known(comparison).map(|(variable, by)| plot(comparison, variable, by)).collect()
}

/// The plots, each with the sentence above it.
///
/// # Errors
/// As [`plots`].
pub(super) fn with_sentences(comparison: &Comparison) -> Result<Vec<(Plot, String)>, PlotError> {
    known(comparison)
        .map(|(variable, by)| Ok((plot(comparison, variable, by)?, says(comparison, variable, by))))
        .collect()
}

fn known(comparison: &Comparison) -> impl Iterator<Item = (&'static Variable, &Breakdown)> {
    comparison
        .by
        .iter()
        .filter(|by| !by.bins.is_empty())
        .filter_map(|by| Some((VARIABLES.iter().find(|variable| variable.name == by.variable)?, by)))
}

/// Whether the groups have names instead of values.
fn is_named(by: &Breakdown) -> bool {
    matches!(by.variable, "direction" | "specimen")
}

fn plot(comparison: &Comparison, variable: &Variable, by: &Breakdown) -> Result<Plot, PlotError> {
    let svg = if is_named(by) { rows(comparison, variable, by)? } else { bars(comparison, variable, by)? };
    let left_out = if is_named(by) && by.bins.len() > MOST_ROWS {
        format!(" Shown are the first {MOST_ROWS} of {}.", by.bins.len())
    } else {
        String::new()
    };
    let left = if has_effects(comparison) {
        ", in the middle what is left of it with all effects, enlarged"
    } else {
        ""
    };
    Ok(Plot {
        name: variable.plot,
        title: variable.title.to_owned(),
        caption: format!(
            "The mean error shows to which side the model is off (above zero: it pulls too weakly){left}; the RMS error shows how \
             far, whichever side.{left_out}"
        ),
        svg,
    })
}

/// What a panel shows.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Mean error of all rungs that are drawn.
    Mean,
    /// Mean error of the last rung in its own panel, since the error of the base would dwarf it.
    MeanLeft,
    /// RMS error of all rungs that are drawn.
    Rms,
}

impl Kind {
    /// The panels of a plot.
    fn of(has_effects: bool) -> &'static [Self] {
        if has_effects { &[Self::Mean, Self::MeanLeft, Self::Rms] } else { &[Self::Mean, Self::Rms] }
    }

    fn quantity(self) -> &'static str {
        match self {
            Self::Mean => "mean error [N]",
            Self::MeanLeft => "mean error left [N]",
            Self::Rms => "RMS error [N]",
        }
    }

    /// Errors of one group with their colours.
    fn errors(self, bin: &Bin, has_effects: bool) -> Vec<(f64, Rgb)> {
        let both = if self == Self::Rms { bin.rmse_n } else { bin.bias_n };
        let all = [(both[0], FIRST), (both[1], LAST)];
        match (self, has_effects) {
            (Self::MeanLeft, _) => all[1..].to_vec(),
            (_, true) => all.to_vec(),
            (_, false) => all[..1].to_vec(),
        }
    }

    /// Values at which the noise floor is drawn.
    fn floors(self, comparison: &Comparison) -> Vec<f64> {
        let Some(sd) = comparison.noise_floor.as_ref().map(|floor| floor.sd_n) else { return Vec::new() };
        match self {
            Self::Mean => Vec::new(),
            Self::MeanLeft => vec![-sd, sd],
            Self::Rms => vec![sd],
        }
    }

    /// Axis of the errors, which includes zero.
    fn axis(self, comparison: &Comparison, by: &Breakdown) -> Result<Axis, PlotError> {
        let errors = || by.bins.iter().flat_map(|bin| self.errors(bin, has_effects(comparison)));
        let values = errors().map(|(error, _)| error).chain([0.0]).chain(self.floors(comparison));
        Axis::few(self.quantity(), 4.0, values)
    }
}

fn entries(comparison: &Comparison) -> Vec<(Mark, String)> {
    let boxes = [Mark::Box(FIRST), Mark::Box(LAST)].into_iter();
    let mut entries: Vec<_> = boxes.zip(names(comparison).into_iter().map(str::to_owned)).collect();
    if comparison.noise_floor.is_some() {
        entries.push((Mark::Line(Stroke::dashed(ALERT, 1.5)), "noise floor".to_owned()));
    }
    entries
}

/// Vertical bars over an ordered variable.
fn bars(comparison: &Comparison, variable: &Variable, by: &Breakdown) -> Result<String, PlotError> {
    let kinds = Kind::of(has_effects(comparison));
    let mut svg = Svg::new(variable.plot, WIDTH, 36.0 + 200.0 + BELOW);
    legend::draw(&mut svg, (6.0, 2.0), WIDTH, &entries(comparison));
    let unit = if by.unit.is_empty() { String::new() } else { format!(" [{}]", by.unit) };
    for (kind, (left, width)) in kinds.iter().zip(columns(kinds.len(), WIDTH)) {
        let y = kind.axis(comparison, by)?;
        let panel = Panel { x: y, y, left, top: 36.0, width, height: 200.0 };
        panel.draw_upwards(&mut svg, kind.quantity());
        let slot = width / by.bins.len() as f64;
        let mut labels = Vec::new();
        for (i, (bin, label)) in by.bins.iter().zip(bar_labels(by, slot)).enumerate() {
            let middle = left + (i as f64 + 0.5) * slot;
            let errors = kind.errors(bin, has_effects(comparison));
            let thick = (0.8 * slot / errors.len() as f64).min(24.0);
            let start = middle - 0.5 * thick * errors.len() as f64;
            for (rung, (error, colour)) in errors.into_iter().enumerate() {
                let corner = (start + rung as f64 * thick, panel.up(0.0));
                svg.rect(corner, (thick, panel.up(error) - panel.up(0.0)), colour);
            }
            labels.push((middle, label));
        }
        for floor in kind.floors(comparison) {
            let y = panel.up(floor);
            svg.line((left, y), (left + width, y), Stroke::dashed(ALERT, 1.5));
        }
        panel.draw_across(&mut svg, &labels, &format!("{}{unit}", by.variable));
    }
    Ok(svg.finish(variable.title))
}

/// Labels under the bars: the middle of a group if the variable has a unit, else the group's name.
fn bar_labels(by: &Breakdown, slot: f64) -> Vec<String> {
    if by.unit.is_empty() {
        return by.bins.iter().map(|bin| name_fitted(&bin.label, TEXT, slot.max(60.0))).collect();
    }
    let middles: Vec<f64> = by.bins.iter().map(|bin| bin.at).collect();
    // Pressures are levels and not evenly spaced.
    if by.variable == "pressure" { middles.into_iter().map(level).collect() } else { ticks(&middles) }
}

/// Horizontal bars of groups with names, which may be long.
fn rows(comparison: &Comparison, variable: &Variable, by: &Breakdown) -> Result<String, PlotError> {
    let kinds = Kind::of(has_effects(comparison));
    let shown = &by.bins[..by.bins.len().min(MOST_ROWS)];
    let row = if shown.len() > 12 { 20.0 } else { 32.0 };
    let height = row * shown.len() as f64;
    let mut svg = Svg::new(variable.plot, WIDTH, 36.0 + height + BELOW);
    legend::draw(&mut svg, (6.0, 2.0), WIDTH, &entries(comparison));
    let name_room = 150.0;
    let each = (WIDTH - name_room) / kinds.len() as f64;
    for (place, kind) in kinds.iter().enumerate() {
        let x = kind.axis(comparison, by)?;
        let left = name_room + place as f64 * each + 12.0;
        let panel = Panel { x, y: x, left, top: 36.0, width: each - 0.6 * LEFT, height };
        let labels = panel.draw_grid(&mut svg);
        for (i, bin) in shown.iter().enumerate() {
            let middle = panel.top + (i as f64 + 0.5) * row;
            let start = middle - 0.35 * row;
            let errors = kind.errors(bin, has_effects(comparison));
            let thick = 0.7 * row / errors.len() as f64;
            for (rung, (error, colour)) in errors.into_iter().enumerate() {
                let corner = (panel.across(0.0), start + rung as f64 * thick);
                svg.rect(corner, (panel.across(error) - panel.across(0.0), thick), colour);
            }
            if place == 0 {
                let name = name_fitted(&bin.label, TEXT, name_room - 12.0);
                svg.text((name_room - 4.0, middle), &name, Style::new(Anchor::End));
            }
        }
        panel.draw_upright(&mut svg, panel.across(0.0), Stroke::solid(INK, 1.0));
        for floor in kind.floors(comparison) {
            panel.draw_upright(&mut svg, panel.across(floor), Stroke::dashed(ALERT, 1.5));
        }
        panel.draw_across(&mut svg, &labels, kind.quantity());
    }
    Ok(svg.finish(variable.title))
}

/// `at 3 bar`, `while lengthening`, `on specimen A`, `in sweep 4`.
fn place(by: &Breakdown, bin: &Bin) -> String {
    let label = || bin.label.replace('-', "−");
    match by.variable {
        "pressure" => format!("at {} bar", level(bin.at)),
        "direction" if bin.label == "at rest" => "at rest".to_owned(),
        "direction" => format!("while {}", bin.label),
        "specimen" => format!("on {}", named("specimen", &bin.label)),
        "sweep" => format!("in {}", named("sweep", &bin.label)),
        "time" => format!("from {} {}", label(), by.unit),
        _ => format!("at {} {}", label(), by.unit),
    }
}

/// The sentence above the plot.
fn says(comparison: &Comparison, variable: &Variable, by: &Breakdown) -> String {
    let worst =
        |rung: usize| by.bins.iter().max_by(|a, b| a.bias_n[rung].abs().total_cmp(&b.bias_n[rung].abs()));
    let (Some(first), Some(last)) = (worst(0), worst(1)) else { return String::new() };
    let base = format!("{} the base {} on average", sentence(&place(by, first)), pulls(first.bias_n[0]));
    if !has_effects(comparison) {
        return format!("{base}. {}.", sentence(&meaning(comparison, variable, by)));
    }
    let left = newton(last.bias_n[1].abs());
    let place = place(by, last);
    format!(
        "{base}; with all effects the largest mean error is {left}, {place}. {}.",
        sentence(&meaning(comparison, variable, by))
    )
}

/// Interpretation of the mean errors of the last rung.
fn meaning(comparison: &Comparison, variable: &Variable, by: &Breakdown) -> String {
    let negligible = negligible_n(comparison);
    let (low, high) = crate::axis::range(by.bins.iter().map(|bin| bin.bias_n[1])).unwrap_or((0.0, 0.0));
    let nowhere = variable.nowhere;
    if low >= -negligible && high <= negligible {
        return match comparison.noise_floor {
            Some(_) => format!("{nowhere} is the mean error larger than a single reading scatters"),
            None => format!("{nowhere} is the mean error larger than half a per cent of full scale"),
        };
    }
    if low < -0.5 * negligible && high > 0.5 * negligible {
        return format!("the error changes sign, which points to {}", variable.hint);
    }
    if high - low > negligible {
        return format!("the error is not equally large everywhere, which points to {}", variable.hint);
    }
    "the model is off to the same side throughout, by about as much".to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variables_have_plots_of_their_own() {
        for (i, variable) in VARIABLES.iter().enumerate() {
            let others = &VARIABLES[..i];
            assert!(others.iter().all(|other| other.plot != variable.plot && other.name != variable.name));
        }
    }

    #[test]
    fn places_read_as_people_say_them() {
        let bin = |label: &str| Bin {
            label: label.to_owned(),
            at: 2.5,
            rows: 1,
            bias_n: [0.0; 2],
            rmse_n: [0.0; 2],
        };
        let by = |variable, unit| Breakdown { variable, unit, bins: Vec::new() };
        assert_eq!(place(&by("pressure", "bar"), &bin("2.50")), "at 2.5 bar");
        assert_eq!(place(&by("direction", ""), &bin("lengthening")), "while lengthening");
        assert_eq!(place(&by("sweep", ""), &bin("3 up")), "in sweep “3 up”");
        assert_eq!(place(&by("time", "s"), &bin("0.0 to 9.5")), "from 0.0 to 9.5 s");
        assert_eq!(place(&by("rate", "%/s"), &bin("-1.5 to 0.0")), "at −1.5 to 0.0 %/s");
    }
}
