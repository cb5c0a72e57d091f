//! The head of the page: the error before and after, its ratio to the scatter of the readings, and whether to
//! trust it.

use bulge_inference::Comparison;
use serde::Serialize;

use crate::comparison::number::{count, newton, three};
use crate::comparison::wording::{has_effects, last_fit, pulls};

/// A number in large print with its description.
#[derive(Debug, Serialize)]
pub(super) struct Figure {
    value: String,
    what: String,
}

/// The figures below the headline.
pub(super) fn figures(comparison: &Comparison) -> Vec<Figure> {
    let (Some(first), Some(last)) = (comparison.ladder.first(), comparison.ladder.last()) else {
        return Vec::new();
    };
    let error = |rung: &bulge_inference::Rung, what: &str| Figure {
        value: newton(rung.rmse_n),
        what: format!("{what}, {} % of full scale", three(rung.rmse_percent)),
    };
    let mut figures = vec![error(first, "RMS error of the base alone")];
    if has_effects(comparison) {
        figures.push(error(last, "RMS error with all effects"));
    }
    if let Some(held_out) = last.held_out_rmse_n {
        figures.push(Figure {
            value: newton(held_out),
            what: "RMS error on data held out of the fit".to_owned(),
        });
    }
    if let Some(floor) = &comparison.noise_floor {
        figures.push(Figure {
            value: newton(floor.sd_n),
            what: "noise floor: scatter of the readings".to_owned(),
        });
    }
    figures
}

/// The headline in one sentence.
pub(super) fn says(comparison: &Comparison) -> String {
    let (Some(first), Some(last)) = (comparison.ladder.first(), comparison.ladder.last()) else {
        return "No model was compared with these data.".to_owned();
    };
    let share = |percent: f64| format!("{} % of full scale", three(percent));
    if !has_effects(comparison) {
        return format!(
            "The base alone misses the measured force by {} ({}).",
            newton(first.rmse_n),
            share(first.rmse_percent)
        );
    }
    format!(
        "With {} the model misses the measured force by {} ({}); the base alone misses it by {} ({}).",
        count(comparison.ladder.len() - 1, "effect"),
        newton(last.rmse_n),
        share(last.rmse_percent),
        newton(first.rmse_n),
        share(first.rmse_percent)
    )
}

/// The bias: the mean error over all readings.
pub(super) fn mean_says(comparison: &Comparison) -> String {
    let (Some(first), Some(last)) = (comparison.ladder.first(), comparison.ladder.last()) else {
        return "No model was compared with these data.".to_owned();
    };
    let base = format!("On average over all readings the base {}", pulls(first.bias_n));
    if has_effects(comparison) {
        format!("{base}; the model with all effects {}.", pulls(last.bias_n))
    } else {
        format!("{base}.")
    }
}

/// The ratio of the error to the noise floor, and its interpretation.
pub(super) fn verdict(comparison: &Comparison) -> Vec<String> {
    let mut verdict = Vec::new();
    let Some(last) = comparison.ladder.last() else { return verdict };
    if let Some(floor) = comparison.noise_floor.as_ref().filter(|floor| floor.sd_n > 0.0) {
        if let Some(directed) = last.directed_rmse_n {
            verdict.push(format!(
                "Without the readings whose direction is in doubt, which count less, it is {}.",
                newton(directed)
            ));
        }
        let ratio = last.directed_rmse_n.unwrap_or(last.rmse_n) / floor.sd_n;
        let meaning = if ratio < 0.8 && last.fitted > 0 {
            "less than the readings themselves scatter, so part of the scatter was fitted"
        } else if ratio < 0.8 {
            "less than the readings themselves are thought to scatter, so the floor is an overestimate"
        } else if ratio < 1.3 {
            "as good as these data can tell"
        } else if ratio < 3.0 {
            "close to what these data allow, with something left to explain"
        } else {
            "far above what these data allow: something is still missing"
        };
        verdict.push(format!("That is {} times the noise floor: {meaning}.", three(ratio)));
    } else {
        verdict.push(
            "The scatter of the readings is not known, so how much of that is noise cannot be said."
                .to_owned(),
        );
    }
    if let Some(held_out) = last.held_out_rmse_n.filter(|_| last.fitted > 0) {
        let ratio = if last.rmse_n > 0.0 { held_out / last.rmse_n } else { f64::INFINITY };
        let meaning = if ratio < 1.15 {
            "about as large: the model does as well on what it has not seen"
        } else if ratio < 1.5 {
            "larger: a part of what the fit learnt holds only for these readings"
        } else {
            "much larger: the fit knows these readings better than the muscle"
        };
        verdict.push(format!("On data held out of the fit the error is {}, {meaning}.", newton(held_out)));
    }
    if last_fit(comparison).is_some_and(|fit| fit.parameters.iter().any(|p| !p.plausible)) {
        verdict.push(
            "At least one fitted number is implausible: that part of the improvement has the wrong cause."
                .to_owned(),
        );
    }
    verdict
}
