//! Structure or slow noise: a misfit that noise explains equally well is no evidence for a missing effect.
//!
//! A saturated model follows slow noise, so the law of its residuals underestimates that noise. The same
//! readings have another explanation: the base is right, and its residuals are noise. Both are weighed by
//! their likelihood, with the model's own parameters integrated out (Patterson and Thompson 1971):
//!
//! ```text
//! noise:      ln p(y | K_0),                 K_0 the law of what the base leaves
//! structure:  ln p(y | K) + ln Z,            K the law of what a saturated model leaves, Z the larger of the evidence of named effects and of a smooth misfit
//! ```
//! A misfit that repeats from cycle to cycle isn't noise: it bounds K_0 as it bounds K.

use bulge_model::{Model, ModelError};

use crate::diagnosis::averaged_data::AveragedData;
use crate::diagnosis::linearised_model::Context;
use crate::diagnosis::noise::kurtosis;
use crate::diagnosis::pure_error::BetweenCycles;
use crate::diagnosis::search::Search;
use crate::diagnosis::something_else::smooth_evidence;
use crate::diagnosis::tangents::Tangents;
use crate::median::median;
use crate::noise::law::{NoiseLaw, NoiseSource};
use crate::noise::restricted_likelihood::log_likelihood;
use crate::noise::whitening::Whitening;

/// If a search took chance for structure, or noise of the base that is as likely, replaces it by a search
/// without findings. Returns the law and the whitening if they are others than before.
pub(crate) fn quieter(
    context: &Context<'_>,
    averaged_data: &AveragedData,
    model: &Model,
    search: &mut Search,
) -> Result<Option<(NoiseLaw, Whitening)>, ModelError> {
    if is_chance(search) {
        search.stages[0].adequate = true;
        return Ok(None);
    }
    let Some(law) = noise_of_base(context, averaged_data, search)? else { return Ok(None) };
    let all = vec![true; context.record.len()];
    // This can't fail, because both belong to this record.
    let Ok(whitening) = Whitening::new(&law, context.record, &all, averaged_data.input_variances()) else {
        return Ok(None);
    };
    let noisy = Context { whitening: &whitening, law: &law, fits: None, ..*context };
    let confirmed = noisy.confirm(model, &[], Some(search.stages[0].confirmed.numbers()), &[])?;
    let stage = noisy.stage(Vec::new(), confirmed)?;
    if !stage.adequate {
        return Ok(None);
    }
    *search = Search { stages: vec![stage], something_else: None, beside: Vec::new() };
    Ok(Some((law, whitening)))
}

/// The noise law under which the base explains the readings, if that is as likely as a structure; otherwise
/// none.
fn noise_of_base(
    context: &Context<'_>,
    averaged_data: &AveragedData,
    search: &Search,
) -> Result<Option<NoiseLaw>, ModelError> {
    let (base, last) = (&search.stages[0], &search.stages[search.stages.len() - 1]);
    if base.adequate || context.law.source != NoiseSource::Saturated || !context.record.is_path() {
        return Ok(None);
    }
    let tangents = Tangents::of(&base.confirmed.prepared, &base.confirmed.theta, context.record)?;
    let n = context.record.len();
    let design: Vec<f64> =
        (0..n).flat_map(|i| tangents.columns.iter().map(move |column| column[i])).collect();
    let inputs = averaged_data.input_variances();
    let found = NoiseLaw::estimate(context.record, &vec![true; n], inputs, &design, &tangents.residual);
    let Ok(law) = found else { return Ok(None) };
    let law = match BetweenCycles::of(context.record, &tangents.residual) {
        Some(cycles) => {
            let kurtosis = kurtosis(&tangents.residual, &[], inputs, &law);
            cycles.bounds(law, median(&mut inputs.to_vec()), kurtosis)
        }
        None => law,
    };
    let likelihood = |law| log_likelihood(law, context.record, inputs, &design, &tangents.residual);
    let (Some(noise), Some(saturated)) = (likelihood(&law), likelihood(context.law)) else { return Ok(None) };
    let named = last.confirmed.log_evidence - base.confirmed.log_evidence;
    let smooth = smooth_evidence(&base.linear);
    Ok((noise >= saturated + named.max(smooth)).then_some(law))
}

/// Whether a smooth unknown misfit is less likely than none although a test rejects the model.
fn is_chance(search: &Search) -> bool {
    let [only] = &search.stages[..] else { return false };
    !only.adequate
        && !only.adequacy.fit_fails
        && only.adequacy.unsmooth.is_none()
        && !only.linear.smooth.is_empty()
        && smooth_evidence(&only.linear) <= 0.0
}
