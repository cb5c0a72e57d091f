//! Distance of each missing effect to its nearest rivals, in standard deviations.

use bulge_inference::{Diagnosis, Missing, RivalResult, SEPARATION};

use crate::PlotError;
use crate::axis::Axis;
use crate::comparison::legend::{self, Mark};
use crate::comparison::number::{and, three};
use crate::comparison::panel::Panel;
use crate::comparison::svg::{Anchor, Stroke, Style, Svg, TEXT, name_fitted};
use crate::comparison::{Plot, WIDTH};
use crate::diagnosis::headline::others_in_class;
use crate::palette::{ALERT, FIRST, GRID, INK, SOFT_INK};

/// Most rivals drawn per effect.
const MOST: usize = 8;
/// Bars end here; the numbers are beside them.
const FAR: f64 = 15.0;
const NAMES: f64 = 190.0;
const NUMBERS: f64 = 230.0;
const ROW: f64 = 22.0;
const HEAD: f64 = 30.0;

/// Rivals of an effect, nearest first.
pub(super) fn nearest(missing: &Missing) -> Vec<&RivalResult> {
    let mut nearest: Vec<&RivalResult> = missing.rivals.iter().collect();
    nearest.sort_by(|a, b| a.separation.total_cmp(&b.separation));
    nearest
}

/// The plot; `None` without rivals.
///
/// # Errors
/// None at present: the signature is that of the other plots.
pub(super) fn plot(diagnosis: &Diagnosis) -> Result<Option<Plot>, PlotError> {
    let groups: Vec<(&Missing, Vec<&RivalResult>)> = diagnosis
        .added()
        .map(|missing| (missing, nearest(missing).into_iter().take(MOST).collect::<Vec<_>>()))
        .filter(|(_, rivals)| !rivals.is_empty())
        .collect();
    if groups.is_empty() {
        return Ok(None);
    }
    let drawn = |rival: &RivalResult| rival.separation.clamp(0.0, FAR);
    let values = groups.iter().flat_map(|(_, rivals)| rivals.iter().map(|r| drawn(r)));
    let x = Axis::of("separation [sigma]", values.chain([0.0, 1.5 * SEPARATION]))?;
    let entries = [
        (Mark::Box(ALERT), "in the class: not told apart".to_owned()),
        (Mark::Box(FIRST), "told apart".to_owned()),
        (Mark::Line(Stroke::dashed(INK, 1.5)), format!("{SEPARATION} sigma")),
    ];
    let top = legend::height(&entries, WIDTH - 20.0) + 4.0;
    let height: f64 = groups.iter().map(|(_, rivals)| HEAD + ROW * rivals.len() as f64).sum();
    let panel = Panel { x, y: x, left: NAMES, top, width: WIDTH - NAMES - NUMBERS, height };
    let mut svg = Svg::new("rivals", WIDTH, top + height + 52.0);
    legend::draw(&mut svg, (6.0, 2.0), WIDTH - 20.0, &entries);
    let labels = panel.labels();
    let mut y = top;
    for (missing, rivals) in &groups {
        let heading = format!("beside {}", missing.effect);
        svg.text((10.0, y + 0.5 * HEAD), &heading, Style::new(Anchor::Start).bold());
        y += HEAD;
        for (x, _) in &labels {
            svg.line((*x, y), (*x, y + ROW * rivals.len() as f64), Stroke::solid(GRID, 1.0));
        }
        for (i, rival) in rivals.iter().enumerate() {
            draw(&mut svg, &panel, (missing, rival, drawn(rival)), y + (i as f64 + 0.5) * ROW);
        }
        let line = panel.across(SEPARATION);
        y += ROW * rivals.len() as f64;
        svg.line((line, y - ROW * rivals.len() as f64), (line, y), Stroke::dashed(INK, 1.5));
    }
    panel.draw_across(&mut svg, &labels, "separation [sigma]");
    Ok(Some(Plot {
        name: "rivals",
        title: "Distance to the nearest rivals".to_owned(),
        caption: format!(
            "How far apart the data hold two explanations, after each has done its best, in standard deviations of the noise. Below \
             {SEPARATION} they are not told apart. “Behind” is by how much the log evidence of the rival is less. Bars end at {FAR}; at most \
             {MOST} rivals are shown."
        ),
        svg: svg.finish("Distance to the nearest rivals"),
    }))
}

fn draw(svg: &mut Svg, panel: &Panel, (missing, rival, drawn): (&Missing, &RivalResult, f64), y: f64) {
    let name = name_fitted(&rival.effect, TEXT, NAMES - 24.0);
    svg.text((NAMES - 10.0, y), &name, Style::new(Anchor::End));
    let in_class = others_in_class(missing).any(|name| name == rival.effect) || rival.separation < SEPARATION;
    let left = panel.across(0.0);
    let thick = 0.62 * ROW;
    let colour = if in_class { ALERT } else { FIRST };
    svg.rect((left, y - 0.5 * thick), (panel.across(drawn) - left, thick), colour);
    let right = WIDTH - NUMBERS;
    svg.text((right + 90.0, y), &format!("{} sigma", three(rival.separation)), Style::new(Anchor::End));
    if rival.behind.is_finite() {
        let behind = format!("behind {}", three(rival.behind));
        svg.text((right + 108.0, y), &behind, Style::new(Anchor::Start).colour(SOFT_INK));
    }
}

/// The sentence above the plot, with the class first.
pub(super) fn says(diagnosis: &Diagnosis) -> String {
    let of = |missing: &Missing| {
        let others: Vec<String> = others_in_class(missing).map(str::to_owned).collect();
        if others.is_empty() && missing.forms.is_empty() {
            format!("{} is told from all others by the weight of the evidence", missing.effect)
        } else if others.is_empty() {
            format!(
                "{} is told from all others but other forms of it, {}",
                missing.effect,
                and(&missing.forms)
            )
        } else {
            format!("these data cannot tell {} from {}", missing.effect, and(&others))
        }
    };
    if diagnosis.added().next().is_none() {
        return "No effect was found, so there is none to be told apart from another.".to_owned();
    }
    let all: Vec<String> = diagnosis.added().map(of).collect();
    format!("{}.", crate::comparison::wording::sentence(&all.join("; ")))
}
