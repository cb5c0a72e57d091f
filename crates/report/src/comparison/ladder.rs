//! The ladder of errors: one bar per rung, the noise floor as a line, and the error on unseen data as
//! diamonds.

use bulge_inference::{Comparison, Rung};

use crate::PlotError;
use crate::axis::Axis;
use crate::comparison::legend::{self, Mark};
use crate::comparison::number::{count, newton, three};
use crate::comparison::panel::Panel;
use crate::comparison::svg::{Anchor, Stroke, Style, Svg, TEXT, fitted};
use crate::comparison::wording::has_effects;
use crate::comparison::{Plot, WIDTH};
use crate::palette::{ALERT, FIRST, INK, LAST, SOFT_INK};

/// Width for the names of the rungs and the numbers.
const NAMES: f64 = 310.0;
/// Width for one name with its sign.
pub(crate) const NAME: f64 = NAMES - 20.0;
const NUMBERS: f64 = 150.0;
/// From this ratio on the error on unseen data counts as worse than that of an earlier rung: a smaller one
/// may be chance.
const MUCH_WORSE: f64 = 1.2;

/// The plot; `None` without a ladder.
///
/// # Errors
/// The range of the errors overflows.
pub(crate) fn plot(comparison: &Comparison) -> Result<Option<Plot>, PlotError> {
    let rungs = &comparison.ladder;
    if rungs.is_empty() {
        return Ok(None);
    }
    let floor = comparison.noise_floor.as_ref().map(|floor| floor.sd_n);
    let x = axis(rungs, floor)?;
    let row = if rungs.len() > 16 { 20.0 } else { 28.0 };
    let entries = entries(rungs, floor.is_some());
    let top = legend::height(&entries, WIDTH - 20.0) + 16.0;
    let height = row * rungs.len() as f64;
    let panel = Panel { x, y: x, left: NAMES, top, width: WIDTH - NAMES - NUMBERS, height };
    let mut svg = Svg::new("ladder", WIDTH, top + height + 52.0);
    legend::draw(&mut svg, (6.0, 4.0), WIDTH - 20.0, &entries);
    let labels = panel.draw_grid(&mut svg);
    for (i, rung) in rungs.iter().enumerate() {
        let y = top + (i as f64 + 0.5) * row;
        draw_rung(&mut svg, &panel, rung, (y, row));
    }
    if let Some(floor) = floor {
        panel.draw_upright(&mut svg, panel.across(floor), Stroke::dashed(ALERT, 1.5));
    }
    for (i, rung) in rungs.iter().enumerate() {
        if let Some(held_out) = rung.held_out_rmse_n {
            svg.diamond((panel.across(held_out), top + (i as f64 + 0.5) * row), 5.5, INK);
        }
    }
    panel.draw_across(&mut svg, &labels, "RMS error [N]");
    Ok(Some(Plot {
        name: "ladder",
        title: "Error after each effect added".to_owned(),
        caption: caption(comparison),
        svg: svg.finish("Error after each effect added"),
    }))
}

fn caption(comparison: &Comparison) -> String {
    let rows = if has_effects(comparison) { "Each row adds one effect to those above it; a" } else { "A" };
    let floor = match comparison.noise_floor {
        Some(_) => {
            " No model can get below the noise floor for good: a bar that ends to the left of it follows the scatter of these readings."
        }
        None => "",
    };
    format!("{rows} shorter bar is better.{floor}")
}

fn axis(rungs: &[Rung], floor: Option<f64>) -> Result<Axis, PlotError> {
    let errors = rungs.iter().flat_map(|rung| [Some(rung.rmse_n), rung.held_out_rmse_n]).flatten();
    Axis::of("RMS error [N]", errors.chain(floor).chain([0.0]))
}

fn entries(rungs: &[Rung], has_floor: bool) -> Vec<(Mark, String)> {
    let mut entries = vec![(Mark::Box(FIRST), "base alone".to_owned())];
    if rungs.len() > 1 {
        entries.push((Mark::Box(LAST), "with effects".to_owned()));
    }
    if let Some(by) = rungs.iter().find_map(|rung| rung.held_out_rmse_n.and(rung.held_out_by)) {
        entries.push((Mark::Diamond(INK), format!("on data held out of the fit ({by} by {by})")));
    }
    if has_floor {
        entries.push((Mark::Line(Stroke::dashed(ALERT, 1.5)), "noise floor".to_owned()));
    }
    entries
}

fn draw_rung(svg: &mut Svg, panel: &Panel, rung: &Rung, (y, row): (f64, f64)) {
    let colour = if rung.added.is_some() { LAST } else { FIRST };
    let name = if rung.added.is_some() { format!("+ {}", rung.title) } else { rung.title.clone() };
    let words = fitted(&name, TEXT, NAME);
    svg.text((NAMES - 10.0, y), &words, Style::new(Anchor::End));
    let left = panel.across(0.0);
    let thick = 0.6 * row;
    svg.rect((left, y - 0.5 * thick), (panel.across(rung.rmse_n) - left, thick), colour);
    let numbers = format!("{} N", three(rung.rmse_n));
    svg.text((WIDTH - NUMBERS + 70.0, y), &numbers, Style::new(Anchor::End));
    let share = format!("{} %", three(rung.rmse_percent));
    svg.text((WIDTH - 16.0, y), &share, Style::new(Anchor::End).colour(SOFT_INK));
}

/// The sentence above the plot.
pub(crate) fn says(comparison: &Comparison) -> String {
    let (Some(first), Some(last)) = (comparison.ladder.first(), comparison.ladder.last()) else {
        return "No model was compared with these data.".to_owned();
    };
    if !has_effects(comparison) {
        return format!(
            "The base alone misses the measurement by {}: no effect was added.",
            newton(first.rmse_n)
        );
    }
    let steps = || comparison.ladder.windows(2);
    let best = steps().max_by(|a, b| (a[0].rmse_n - a[1].rmse_n).total_cmp(&(b[0].rmse_n - b[1].rmse_n)));
    let helps = best.filter(|pair| pair[1].rmse_n < pair[0].rmse_n).map_or_else(
        || " None of the effects lowers the error.".to_owned(),
        |pair| format!(" “{}” helps most: {} less.", pair[1].title, newton(pair[0].rmse_n - pair[1].rmse_n)),
    );
    let effects = count(comparison.ladder.len() - 1, "effect");
    let [before, after] = [first, last].map(|rung| newton(rung.rmse_n));
    let (moved, to) = if before == after {
        ("leave", "at")
    } else if last.rmse_n < first.rmse_n {
        ("bring", "down to")
    } else {
        ("raise", "to")
    };
    let verb = if comparison.ladder.len() == 2 { format!("{moved}s") } else { moved.to_owned() };
    let held_out = held_out(comparison);
    format!(
        "The base alone misses the measurement by {before}; {effects} {verb} the error {to} {after}.{helps}{held_out}"
    )
}

/// Whether the last rungs still help on unseen data.
fn held_out(comparison: &Comparison) -> String {
    let unseen =
        || comparison.ladder.iter().enumerate().filter_map(|(i, r)| Some((i, r, r.held_out_rmse_n?)));
    let Some((place, rung, error)) = unseen().min_by(|a, b| a.2.total_cmp(&b.2)) else {
        return String::new();
    };
    let last = comparison.ladder.len() - 1;
    match unseen().next_back() {
        Some((i, _, at_last)) if i == last && at_last > MUCH_WORSE * error && place < last => format!(
            " On data held out of the fit the error is lowest with “{}” ({}): what was added after it follows these readings, not the muscle.",
            rung.title,
            newton(error)
        ),
        Some((i, _, at_last)) if i == last => {
            format!(" On data held out of the fit it is {}.", newton(at_last))
        }
        _ => String::new(),
    }
}
