//! The evidence for each effect of the catalogue, as bars.

use crate::PlotError;
use crate::axis::Axis;
use crate::comparison::legend::{self, Mark};
use crate::comparison::number::{count, level, three};
use crate::comparison::panel::Panel;
use crate::comparison::svg::{Anchor, Stroke, Style, Svg, TEXT, name_fitted};
use crate::comparison::wording::sentence;
use crate::comparison::{Plot, WIDTH};
use crate::palette::{ALERT, FIRST, LAST, Rgb, SOFT_INK};
use bulge_inference::{CandidateResult, Diagnosis};

/// Most bars.
const MOST: usize = 28;
/// Bars further to the left end here.
const LEAST: f64 = -20.0;
const NAMES: f64 = 190.0;
const NUMBERS: f64 = 190.0;
const ROW: f64 = 21.0;

/// The candidates that were tried, largest evidence first.
fn tried(diagnosis: &Diagnosis) -> Vec<&CandidateResult> {
    let mut tried: Vec<&CandidateResult> =
        diagnosis.candidates.iter().filter(|c| c.status != "not-testable").collect();
    tried.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
    tried
}

/// The plot; `None` if no effect could be tried.
///
/// # Errors
/// The range of the evidence overflows.
pub(super) fn plot(diagnosis: &Diagnosis) -> Result<Option<Plot>, PlotError> {
    let all = tried(diagnosis);
    let rows = &all[..all.len().min(MOST)];
    if rows.is_empty() {
        return Ok(None);
    }
    let bars = || rows.iter().map(|row| row.log_evidence).filter(|e| e.is_finite()).map(|e| e.max(LEAST));
    let x = Axis::of("log evidence", bars().chain([0.0]))?;
    let entries = entries(rows);
    let top = legend::height(&entries, WIDTH - 20.0) + 12.0;
    let height = ROW * rows.len() as f64;
    let panel = Panel { x, y: x, left: NAMES, top, width: WIDTH - NAMES - NUMBERS, height };
    let mut svg = Svg::new("candidates", WIDTH, top + height + 52.0);
    legend::draw(&mut svg, (6.0, 2.0), WIDTH - 20.0, &entries);
    let labels = panel.draw_grid(&mut svg);
    for (i, row) in rows.iter().enumerate() {
        draw(&mut svg, &panel, row, top + (i as f64 + 0.5) * ROW);
    }
    panel.draw_upright(&mut svg, panel.across(0.0), Stroke::solid(SOFT_INK, 1.0));
    panel.draw_across(&mut svg, &labels, "log evidence over the base");
    let left_out = if rows.len() < all.len() {
        format!(
            " {} with less evidence are in the table of detection limits.",
            count(all.len() - rows.len(), "effect")
        )
    } else {
        String::new()
    };
    let is_cut = rows.iter().any(|row| row.log_evidence.is_finite() && row.log_evidence < LEAST);
    let cut = if is_cut { format!(" Bars end at {}.", level(LEAST)) } else { String::new() };
    Ok(Some(Plot {
        name: "candidates",
        title: "Evidence for each effect alone".to_owned(),
        caption: format!(
            "Each effect is added to the base alone, with what it gains in likelihood and what its numbers cost. Above zero the data are \
             for it; 3 more are odds of twenty to one.{cut}{left_out}"
        ),
        svg: svg.finish("Evidence for each effect alone"),
    }))
}

fn colour(status: &str) -> Rgb {
    match status {
        "confirmed" => LAST,
        "rival" => ALERT,
        _ => FIRST,
    }
}

fn entries(rows: &[&CandidateResult]) -> Vec<(Mark, String)> {
    let named = [
        ("confirmed", "confirmed: it is missing"),
        ("rival", "rival: not told apart from one that is missing"),
        ("rejected", "rejected"),
    ];
    let occurs = |status: &str| rows.iter().any(|row| row.status == status);
    let found = named.into_iter().filter(|(status, _)| occurs(status));
    found.map(|(status, words)| (Mark::Box(colour(status)), words.to_owned())).collect()
}

fn draw(svg: &mut Svg, panel: &Panel, row: &CandidateResult, y: f64) {
    let name = name_fitted(&row.effect, TEXT, NAMES - 24.0);
    svg.text((NAMES - 10.0, y), &name, Style::new(Anchor::End));
    let right = WIDTH - NUMBERS;
    let status = Style::new(Anchor::Start).colour(SOFT_INK);
    if !row.log_evidence.is_finite() {
        svg.text((right + 82.0, y), row.status, status);
        return;
    }
    let (zero, end) = (panel.across(0.0), panel.across(row.log_evidence.max(LEAST)));
    let thick = 0.62 * ROW;
    if row.status == "not-converged" {
        svg.hatch((zero, y - 0.5 * thick), (end - zero, thick));
    } else {
        svg.rect((zero, y - 0.5 * thick), (end - zero, thick), colour(row.status));
    }
    svg.text((right + 70.0, y), &three(row.log_evidence), Style::new(Anchor::End));
    svg.text((right + 82.0, y), row.status, status);
}

/// The sentence above the plot.
pub(super) fn says(diagnosis: &Diagnosis) -> String {
    let of = |status: &str| diagnosis.candidates.iter().filter(|c| c.status == status).count();
    let not_testable = of("not-testable");
    let tried = diagnosis.candidates.len() - not_testable;
    let open = match of("not-converged") {
        0 => String::new(),
        1 => " The fit of one did not converge: it is neither confirmed nor rejected.".to_owned(),
        n => format!(" The fits of {n} did not converge: they are neither confirmed nor rejected."),
    };
    let untested = match not_testable {
        0 => String::new(),
        n => format!("; {n} could not be looked for in these data"),
    };
    let are = |number: usize| match number {
        0 => "none is".to_owned(),
        1 => "1 is".to_owned(),
        n => format!("{n} are"),
    };
    let confirmed = of("confirmed");
    let rivals = match confirmed {
        0 => String::new(),
        1 => format!(", {} not told apart from it", are(of("rival"))),
        _ => format!(", {} not told apart from them", are(of("rival"))),
    };
    format!(
        "{} of the catalogue {} looked for{untested}. {} confirmed{rivals}.{open}",
        count(tried, "effect"),
        if tried == 1 { "was" } else { "were" },
        sentence(&are(confirmed))
    )
}

/// Effects that could not be tested, with the reason.
pub(super) fn untested(diagnosis: &Diagnosis) -> Vec<(String, String)> {
    let untested = diagnosis.candidates.iter().filter(|c| c.status == "not-testable");
    let why =
        |c: &CandidateResult| c.why.clone().unwrap_or_else(|| "it would change nothing here".to_owned());
    untested.map(|c| (c.effect.clone(), why(c))).collect()
}
