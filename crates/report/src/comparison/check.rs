//! Checks that a comparison can be drawn: numbers are finite, and corresponding lists have the same length.

use bulge_inference::Comparison;

use crate::PlotError;

/// Rejects values that would appear as a gap or a `NaN` in a drawing. Intervals and plausible ranges may be
/// unbounded.
///
/// # Errors
/// [`PlotError::Value`] and [`PlotError::Lengths`].
pub(crate) fn check(comparison: &Comparison) -> Result<(), PlotError> {
    numbers(comparison)?;
    series(comparison)?;
    for map in &comparison.maps {
        let cells = map.pressure_pa.len() * map.contraction.len();
        lengths("cells of a residual map", cells, &[map.first_n.len(), map.last_n.len()])?;
        finite("a residual map", map.pressure_pa.iter().chain(&map.contraction).copied())?;
        finite("a residual map", map.first_n.iter().chain(&map.last_n).flatten().copied())?;
    }
    for fit in comparison.ladder.iter().filter_map(|rung| rung.fit.as_ref()) {
        finite("a fitted number", fit.parameters.iter().map(|p| p.value))?;
        finite("a fit", [fit.rmse_n, fit.effective_rows, fit.convergence.gradient_cosine].into_iter())?;
        finite("a correlation", fit.correlations.iter().copied())?;
        let count = fit.parameters.len();
        if !fit.correlations.is_empty() {
            lengths("correlations", count * count, &[fit.correlations.len()])?;
        }
    }
    Ok(())
}

fn numbers(comparison: &Comparison) -> Result<(), PlotError> {
    let data = &comparison.data;
    let ranges = data.pressure_pa.iter().chain(&data.contraction).chain(&data.force_n).copied();
    finite("the range of the data", ranges.chain([data.full_scale_n]))?;
    finite("the noise floor", comparison.noise_floor.iter().map(|floor| floor.sd_n))?;
    for rung in &comparison.ladder {
        let always = [rung.rmse_n, rung.rmse_percent, rung.bias_n, rung.largest_n, rung.r_squared];
        let sometimes = [rung.held_out_rmse_n, rung.half_gap_rmse_n].into_iter().flatten();
        finite("an error of the ladder", always.into_iter().chain(sometimes))?;
    }
    for by in &comparison.by {
        let values = by.bins.iter().flat_map(|bin| bin.bias_n.into_iter().chain(bin.rmse_n).chain([bin.at]));
        finite(&format!("an error by {}", by.variable), values)?;
    }
    for rival in &comparison.rivals {
        let sometimes = [rival.printed_rmse_n, rival.held_out_rmse_n].into_iter().flatten();
        // A law that could not be fitted has no error to show.
        let always = [rival.rmse_n, rival.rmse_percent].into_iter().filter(|_| rival.failed.is_none());
        finite("the error of a law", sometimes.chain(always))?;
    }
    Ok(())
}

fn series(comparison: &Comparison) -> Result<(), PlotError> {
    for curve in &comparison.curves {
        let values = curve.points.iter().flat_map(|p| [p.contraction, p.measured_n, p.first_n, p.last_n]);
        finite("a force curve", values.chain([curve.pressure_pa]))?;
    }
    for gap in &comparison.loops {
        let lists = [
            &gap.mean_measured_n,
            &gap.mean_model_n[0],
            &gap.mean_model_n[1],
            &gap.half_gap_measured_n,
            &gap.half_gap_model_n[0],
            &gap.half_gap_model_n[1],
        ];
        lengths("values of a loop", gap.contraction.len(), &lists.map(Vec::len))?;
        let values = lists.into_iter().chain([&gap.contraction]).flatten().copied();
        finite("a loop", values.chain([gap.pressure_pa]))?;
    }
    for held in &comparison.isotonic {
        let values = held.points.iter().flat_map(|p| [p.pressure_pa, p.contraction, p.first, p.last]);
        finite("a contraction under a held load", values.chain(held.rmse_contraction).chain([held.load_n]))?;
    }
    for stack in &comparison.contributions {
        let lists =
            || [&stack.measured_n, &stack.base_n].into_iter().chain(stack.parts.iter().map(|p| &p.force_n));
        let found: Vec<usize> = lists().map(Vec::len).collect();
        lengths("values of a contribution", stack.contraction.len(), &found)?;
        let values = lists().chain([&stack.contraction]).flatten().copied();
        finite("a contribution", values.chain([stack.pressure_pa]))?;
    }
    finite("a predicted force", comparison.scatter.iter().flatten().copied())
}

/// Rejects a value that is infinite or not a number.
pub(crate) fn finite(what: &str, mut values: impl Iterator<Item = f64>) -> Result<(), PlotError> {
    match values.find(|value| !value.is_finite()) {
        Some(value) => Err(PlotError::Value { quantity: what.to_owned(), value }),
        None => Ok(()),
    }
}

/// Rejects lists of another length than expected.
pub(crate) fn lengths(what: &'static str, expected: usize, found: &[usize]) -> Result<(), PlotError> {
    match found.iter().find(|found| **found != expected) {
        Some(found) => Err(PlotError::Lengths { what, expected, found: *found }),
        None => Ok(()),
    }
}
