//! Checks that a diagnosis can be drawn: numbers are finite, and corresponding lists have the same length.

use bulge_inference::Diagnosis;

use crate::PlotError;
use crate::comparison::check::{check as check_comparison, finite, lengths};

/// Rejects values that would appear as a gap or a `NaN` in a drawing. Intervals of parameters may be
/// unbounded, and evidence may come from a failed fit.
///
/// # Errors
/// [`PlotError::Value`] and [`PlotError::Lengths`].
pub(super) fn check(diagnosis: &Diagnosis) -> Result<(), PlotError> {
    check_comparison(&diagnosis.comparison)?;
    finite(
        "the noise",
        [diagnosis.noise.sd_n, diagnosis.noise_floor_n, diagnosis.data.effective_rows].into_iter(),
    )?;
    let steps = &diagnosis.ladder;
    let errors = steps.iter().flat_map(|step| [Some(step.rmse_n), step.held_out_rmse_n]).flatten();
    finite("an error of the ladder", errors)?;
    for missing in diagnosis.added() {
        finite("a fitted number", missing.parameters.values().map(|p| p.value))?;
        finite(
            "a confidence",
            [missing.confidence, missing.detectability, missing.log_evidence, missing.simulated.class]
                .into_iter(),
        )?;
        finite("a confidence", missing.simulated.interval.into_iter())?;
        finite("a separation", missing.rivals.iter().map(|rival| rival.separation))?;
    }
    let limits = diagnosis.candidates.iter().flat_map(|c| [c.detection_limit, c.detection_limit_n]).flatten();
    finite("a detection limit", limits)?;
    finite("a share of the misfit", diagnosis.r#where.iter().flat_map(|located| [located.share, located.p]))?;
    for curve in diagnosis.explained.iter().flat_map(|step| &step.curves) {
        let lists = [&curve.before_n, &curve.explained_n];
        lengths("values of what an effect explains", curve.contraction.len(), &lists.map(Vec::len))?;
        let values = lists.into_iter().chain([&curve.contraction]).flatten().copied();
        finite("what an effect explains", values.chain([curve.pressure_pa]))?;
    }
    for error in diagnosis.added().filter_map(|missing| missing.form_error.as_ref()) {
        finite("a form error", [error.share, error.rms_n].into_iter())?;
        for curve in &error.curves {
            let lists = [&curve.formula_n, &curve.bent_n, &curve.sd_n];
            lengths("values of a bent effect", curve.contraction.len(), &lists.map(Vec::len))?;
            let values = lists.into_iter().chain([&curve.contraction]).flatten().copied();
            finite("a bent effect", values.chain([curve.pressure_pa]))?;
        }
    }
    for curve in &diagnosis.remaining.surface {
        let lists = [&curve.misfit_n, &curve.sd_n];
        lengths("values of the misfit that remains", curve.contraction.len(), &lists.map(Vec::len))?;
        let values = lists.into_iter().chain([&curve.contraction]).flatten().copied();
        finite("the misfit that remains", values.chain([curve.pressure_pa]))?;
    }
    let [low, high] = diagnosis.remaining.misfit_interval_n;
    let sigma = diagnosis.next_experiment.iter().map(|next| next.sigma);
    finite("the misfit that remains", [diagnosis.remaining.misfit_n, low, high].into_iter().chain(sigma))
}
