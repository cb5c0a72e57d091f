//! Checks that a diagnosis can be drawn: numbers are finite, and corresponding lists have the same length.

use bulge_inference::{CurveAt, Diagnosis};

use crate::PlotError;
use crate::comparison::check::{check as check_comparison, curve, finite};

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
    for step in diagnosis.explained.iter().flat_map(|step| &step.curves) {
        let names = ["values of what an effect explains", "what an effect explains"];
        curve(names, at(&step.at), &[&step.before_n, &step.explained_n])?;
    }
    for error in diagnosis.added().filter_map(|missing| missing.form_error.as_ref()) {
        finite("a form error", [error.share, error.rms_n].into_iter())?;
        for bent in &error.curves {
            let lists = [&bent.formula_n, &bent.bent_n, &bent.sd_n];
            curve(["values of a bent effect", "a bent effect"], at(&bent.at), &lists)?;
        }
    }
    for left in &diagnosis.remaining.surface {
        let names = ["values of the misfit that remains", "the misfit that remains"];
        curve(names, at(&left.at), &[&left.misfit_n, &left.sd_n])?;
    }
    let [low, high] = diagnosis.remaining.misfit_interval_n;
    let sigma = diagnosis.next_experiment.iter().map(|next| next.sigma);
    finite("the misfit that remains", [diagnosis.remaining.misfit_n, low, high].into_iter().chain(sigma))
}

/// The contractions and the pressure of a curve.
fn at(curve: &CurveAt) -> (&Vec<f64>, f64) {
    (&curve.contraction, curve.pressure_pa)
}
