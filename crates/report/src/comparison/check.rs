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
    for force in &comparison.curves {
        let values = force.points.iter().flat_map(|p| [p.contraction, p.measured_n, p.first_n, p.last_n]);
        finite("a force curve", values.chain([force.pressure_pa]))?;
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
        curve(["values of a loop", "a loop"], (&gap.contraction, gap.pressure_pa), &lists)?;
    }
    for held in &comparison.isotonic {
        let values = held.points.iter().flat_map(|p| [p.pressure_pa, p.contraction, p.first, p.last]);
        finite("a contraction under a held load", values.chain(held.rmse_contraction).chain([held.load_n]))?;
    }
    for stack in &comparison.contributions {
        let mut lists = vec![&stack.measured_n, &stack.base_n];
        lists.extend(stack.parts.iter().map(|part| &part.force_n));
        let at = (&stack.contraction, stack.pressure_pa);
        curve(["values of a contribution", "a contribution"], at, &lists)?;
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

/// Rejects a curve at one pressure \[Pa\] with lists of another length than its contractions, or with values
/// that aren't finite. `names` are those of its values and of the curve.
pub(crate) fn curve(
    names: [&'static str; 2],
    (contraction, pressure_pa): (&Vec<f64>, f64),
    lists: &[&Vec<f64>],
) -> Result<(), PlotError> {
    lengths(names[0], contraction.len(), &lists.iter().map(|list| list.len()).collect::<Vec<_>>())?;
    let values = lists.iter().copied().chain([contraction]).flatten().copied();
    finite(names[1], values.chain([pressure_pa]))
}

/// Rejects lists of another length than expected.
pub(crate) fn lengths(what: &'static str, expected: usize, found: &[usize]) -> Result<(), PlotError> {
    match found.iter().find(|found| **found != expected) {
        Some(found) => Err(PlotError::Lengths { what, expected, found: *found }),
        None => Ok(()),
    }
}
