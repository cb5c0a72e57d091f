//! The variables on which the misfit of the base depends: fractions as bars.

use bulge_inference::{Diagnosis, Located};

use crate::PlotError;
use crate::axis::Axis;
use crate::comparison::number::and;
use crate::comparison::panel::Panel;
use crate::comparison::svg::{Anchor, Style, Svg, TEXT, fitted};
use crate::comparison::{Plot, WIDTH};
use crate::diagnosis::words::{is_significant, once_in};
use crate::palette::{FIRST, LAST, SOFT_INK};

const NAMES: f64 = 110.0;
const NUMBERS: f64 = 510.0;
const ROW: f64 = 26.0;
const TOP: f64 = 8.0;

/// The plot; `None` if the misfit depends on none of the variables examined.
///
/// # Errors
/// None at present: the signature is that of the other plots.
pub(super) fn plot(diagnosis: &Diagnosis) -> Result<Option<Plot>, PlotError> {
    let rows = &diagnosis.r#where;
    if rows.is_empty() {
        return Ok(None);
    }
    let x = Axis::few("share [%]", 5.0, rows.iter().map(|row| 100.0 * row.share).chain([0.0]))?;
    let height = ROW * rows.len() as f64;
    let panel = Panel { x, y: x, left: NAMES, top: TOP, width: WIDTH - NAMES - NUMBERS, height };
    let mut svg = Svg::new("where", WIDTH, TOP + height + 52.0);
    let labels = panel.draw_grid(&mut svg);
    for (i, row) in rows.iter().enumerate() {
        draw(&mut svg, &panel, row, TOP + (i as f64 + 0.5) * ROW);
    }
    panel.draw_across(&mut svg, &labels, "share of the misfit [%]");
    Ok(Some(Plot {
        name: "where",
        title: "On what the misfit of the base depends".to_owned(),
        caption: "Share of the systematic misfit that goes with each variable. p is how often noise alone gives as much, all variables \
                  considered (Holm 1979); grey bars are no more than chance."
            .to_owned(),
        svg: svg.finish("On what the misfit of the base depends"),
    }))
}

fn draw(svg: &mut Svg, panel: &Panel, row: &Located, y: f64) {
    svg.text((NAMES - 10.0, y), &fitted(&row.variable, TEXT, NAMES - 16.0), Style::new(Anchor::End));
    let left = panel.across(0.0);
    let thick = 0.6 * ROW;
    let colour = if is_significant(row.p) { LAST } else { FIRST };
    svg.rect((left, y - 0.5 * thick), (panel.across(100.0 * row.share) - left, thick), colour);
    let right = WIDTH - NUMBERS;
    svg.text((right + 56.0, y), &format!("{:.0} %", 100.0 * row.share), Style::new(Anchor::End));
    svg.text((right + 70.0, y), &once_in(row.p), Style::new(Anchor::Start).colour(SOFT_INK));
    let says = fitted(&row.says, TEXT, NUMBERS - 170.0);
    svg.text((right + 156.0, y), &says, Style::new(Anchor::Start));
}

/// The sentence above the plot.
pub(super) fn says(diagnosis: &Diagnosis) -> String {
    let found = diagnosis.r#where.iter().filter(|located| is_significant(located.p));
    let names: Vec<String> = found.map(|located| located.variable.clone()).collect();
    if names.is_empty() {
        "The misfit of the base depends on nothing that stands out of the noise.".to_owned()
    } else {
        format!("The misfit of the base depends on {}.", and(&names))
    }
}
