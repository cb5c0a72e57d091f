//! The ladder of a diagnosis: the error after each effect that was found, as bars and as rows of a table.

use bulge_inference::{Comparison, Diagnosis, LadderStep, NoiseFloor, Rung, Verdict};
use serde::Serialize;

use crate::PlotError;
use crate::comparison::number::{newton, three};
use crate::comparison::svg::{TEXT, name_fitted, width};
use crate::comparison::wording::effect_title;
use crate::comparison::{Plot, ladder};
use crate::diagnosis::words::{base_name, form_of_step, step_name};

/// Explanation of the rungs with form errors.
const BENT: &str = " The last bars bend the formulas of effects as the data want it and add none; on data held out of the fit that was not tried.";

/// The plot; `None` without a ladder.
///
/// # Errors
/// The range of the errors overflows.
pub(super) fn plot(diagnosis: &Diagnosis) -> Result<Option<Plot>, PlotError> {
    let mut comparison = with_noise(diagnosis);
    let is_bent = diagnosis.ladder.iter().any(|step| step.bent);
    // The end of a name identifies the rung; `+ ` precedes it.
    let name =
        |step: &LadderStep| name_fitted(&step_name(diagnosis, step), TEXT, ladder::NAME - width("+ ", TEXT));
    let full_scale = comparison.data.full_scale_n.max(f64::MIN_POSITIVE);
    for step in diagnosis.ladder.iter().filter(|step| !form_of_step(diagnosis, step).is_empty()) {
        if step.bent {
            comparison.ladder.push(Rung {
                added: step.added.clone(),
                title: name(step),
                rmse_n: step.rmse_n,
                rmse_percent: 100.0 * step.rmse_n / full_scale,
                ..Rung::default()
            });
        } else if let Some(rung) = comparison.ladder.iter_mut().find(|rung| rung.added == step.added) {
            rung.title = name(step);
        }
    }
    let plot = ladder::plot(&comparison)?;
    Ok(plot.map(|plot| if is_bent { Plot { caption: plot.caption + BENT, ..plot } } else { plot }))
}

/// The comparison with the noise floor of the diagnosis, whose noise estimate uses more information.
pub(super) fn with_noise(diagnosis: &Diagnosis) -> Comparison {
    let law = &diagnosis.noise.law;
    let floor =
        NoiseFloor { sd_n: diagnosis.noise_floor_n, source: law.source.name(), says: law.says.clone() };
    Comparison { noise_floor: Some(floor), ..diagnosis.comparison.clone() }
}

/// One row, with forces in N.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    title: String,
    added: String,
    rmse: String,
    percent: String,
    held_out: String,
    adequate: bool,
}

/// All steps.
pub(super) fn rows(diagnosis: &Diagnosis) -> Vec<Row> {
    let full_scale = diagnosis.comparison.data.full_scale_n;
    let row = |step: &LadderStep| Row {
        title: step.added.as_deref().map_or_else(
            || base_name(diagnosis),
            |added| effect_title(&diagnosis.comparison, added).to_owned() + form_of_step(diagnosis, step),
        ),
        added: step.added.clone().unwrap_or_default(),
        rmse: three(step.rmse_n),
        percent: if full_scale > 0.0 { three(100.0 * step.rmse_n / full_scale) } else { "–".to_owned() },
        held_out: step.held_out_rmse_n.map_or_else(|| "–".to_owned(), three),
        adequate: step.adequate,
    };
    diagnosis.ladder.iter().map(row).collect()
}

/// The sentence above the plot.
pub(super) fn says(diagnosis: &Diagnosis) -> String {
    let (Some(first), Some(last)) = (diagnosis.ladder.first(), diagnosis.ladder.last()) else {
        return "No model was compared with these data.".to_owned();
    };
    let floor = newton(diagnosis.noise_floor_n);
    let enough = |step: &LadderStep| match diagnosis.verdict {
        _ if step.adequate => "no structure is left that stands out of the noise",
        Verdict::CannotTell => "these data can't tell whether structure is left",
        _ => "structure is left",
    };
    let directed = diagnosis.comparison.ladder.last().and_then(|rung| rung.directed_rmse_n);
    let directed = directed.map_or_else(String::new, |error| {
        format!(" ({} without the readings whose direction is in doubt, which count less)", newton(error))
    });
    if diagnosis.ladder.len() == 1 {
        return format!(
            "The model misses the measurement by {}{directed}, single readings scatter by {floor}: {}.",
            newton(first.rmse_n),
            enough(first)
        );
    }
    let formulas = diagnosis.ladder.iter().rfind(|step| !step.bent).unwrap_or(first);
    let formulas = match (formulas.added.is_some(), last.bent) {
        (true, true) => format!(" to {} by the formulas{directed} and", newton(formulas.rmse_n)),
        _ => String::new(),
    };
    let reached = if last.bent { " with effects as the data want them" } else { &*directed };
    format!(
        "The error goes from {}{formulas} to {}{reached}, single readings scatter by {floor}: {}.",
        newton(first.rmse_n),
        newton(last.rmse_n),
        enough(last)
    )
}
