//! The ladder of a diagnosis: the error after each effect that was found, as bars and as rows of a table.

use bulge_inference::{Comparison, Diagnosis, LadderStep, NoiseFloor, NoiseSource, Verdict};
use serde::Serialize;

use crate::PlotError;
use crate::comparison::number::{newton, three};
use crate::comparison::wording::effect_title;
use crate::comparison::{Plot, ladder};
use crate::diagnosis::words::base_name;

/// The plot; none without a ladder.
///
/// # Errors
/// If the errors span more than an axis.
pub(super) fn plot(diagnosis: &Diagnosis) -> Result<Option<Plot>, PlotError> {
    ladder::plot(&with_noise(diagnosis))
}

/// The comparison with the noise floor of the diagnosis, which knows more of the noise.
pub(super) fn with_noise(diagnosis: &Diagnosis) -> Comparison {
    let law = &diagnosis.noise.law;
    let source = match law.source {
        NoiseSource::Repeats => "repeats",
        NoiseSource::Saturated => "saturated",
        NoiseSource::Instruments => "instruments",
    };
    let floor = NoiseFloor { sd_n: diagnosis.noise_floor_n, source, says: law.says.clone() };
    Comparison { noise_floor: Some(floor), ..diagnosis.comparison.clone() }
}

/// One row: forces in N.
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
            |added| effect_title(&diagnosis.comparison, added).to_owned(),
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
    format!(
        "The error goes from {} to {}{directed}, single readings scatter by {floor}: {}.",
        newton(first.rmse_n),
        newton(last.rmse_n),
        enough(last)
    )
}
