//! Structure or slow noise: a misfit that noise explains no worse is no evidence that something is missing.
//!
//! A saturated model follows slow noise, and the law of what it leaves then knows too little of it. The same readings have another explanation: the base is right, and their noise is
//! what it leaves. Both are weighed by their likelihood, the model's own numbers integrated out (Patterson and Thompson 1971):
//!
//! ```text
//! noise:      ln p(y | K_0),                 K_0 the law of what the base leaves
//! structure:  ln p(y | K) + ln Z,            K the law of what a saturated model leaves, Z the larger of the evidence of named effects and of a smooth misfit
//! ln Z = ln mean over (A, J) of exp sum_j [-ln(1 + t_j)/2 + z_j^2 t_j/(1 + t_j)/2],    t_j = (A F exp(-j/J)/f_j)^2
//! ```
//! with z_j the coordinate of the misfit along the j-th smooth function, f_j the RMS of that function at one standard deviation, F the largest force. What repeats from cycle to cycle is
//! no noise: K_0 is bounded by it, as K is.

use bulge_model::{Model, ModelError};

use crate::diagnosis::ground::Ground;
use crate::diagnosis::pure_error::BetweenCycles;
use crate::diagnosis::scene::{Given, Scene};
use crate::diagnosis::search::Search;
use crate::diagnosis::tangents::Tangents;
use crate::dot::dot;
use crate::median::median;
use crate::noise::law::{NoiseLaw, NoiseSource};
use crate::noise::restricted_likelihood::log_likelihood;
use crate::noise::whitening::Whitening;

/// Sizes of a smooth misfit as parts of the largest force.
const SIZES: [f64; 6] = [3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1];
/// Numbers of functions over which it fades.
const FADES: [f64; 3] = [4.0, 12.0, 36.0];

/// Where a search took for structure what is chance, or as likely noise of the base, it becomes the search that found nothing: by the law and the whitening that are given back, if
/// the noise is another.
pub(crate) fn quieter(
    given: &Given<'_>,
    ground: &Ground,
    model: &Model,
    search: &mut Search,
) -> Result<Option<(NoiseLaw, Whitening)>, ModelError> {
    if is_chance(search) {
        search.stages[0].adequate = true;
        return Ok(None);
    }
    let Some(law) = noise_of_base(given, ground, search)? else { return Ok(None) };
    let all = vec![true; given.record.len()];
    // Both were made of this record: there is nothing to go wrong.
    let Ok(whitening) = Whitening::new(&law, given.record, &all, ground.input_variances()) else {
        return Ok(None);
    };
    let noisy = Given { whitening: &whitening, law: &law, ..*given };
    let confirmed = noisy.confirm(model, &[], Some(search.stages[0].confirmed.numbers()), &[])?;
    let stage = noisy.stage(Vec::new(), confirmed)?;
    if !stage.adequate {
        return Ok(None);
    }
    search.stages = vec![stage];
    Ok(Some((law, whitening)))
}

/// The law of the noise under which the base explains the readings, where that is as likely as a structure; none where it isn't.
fn noise_of_base(
    given: &Given<'_>,
    ground: &Ground,
    search: &Search,
) -> Result<Option<NoiseLaw>, ModelError> {
    let (base, last) = (&search.stages[0], &search.stages[search.stages.len() - 1]);
    if base.adequate || given.law.source != NoiseSource::Saturated || !given.record.is_path() {
        return Ok(None);
    }
    let tangents = Tangents::of(&base.confirmed.prepared, &base.confirmed.theta, given.record)?;
    let n = given.record.len();
    let design: Vec<f64> =
        (0..n).flat_map(|i| tangents.columns.iter().map(move |column| column[i])).collect();
    let inputs = ground.input_variances();
    let found = NoiseLaw::estimate(given.record, &vec![true; n], inputs, &design, &tangents.residual);
    let Ok(law) = found else { return Ok(None) };
    let law = match BetweenCycles::of(given.record, &tangents.residual) {
        Some(cycles) => cycles.bounds(law, median(&mut inputs.to_vec())),
        None => law,
    };
    let likelihood = |law| log_likelihood(law, given.record, inputs, &design, &tangents.residual);
    let (Some(noise), Some(saturated)) = (likelihood(&law), likelihood(given.law)) else { return Ok(None) };
    let named = last.confirmed.log_evidence - base.confirmed.log_evidence;
    let smooth = smooth_evidence(&base.scene);
    Ok((noise >= saturated + named.max(smooth)).then_some(law))
}

/// Whether a smooth misfit that nobody thought of is less likely than none, though a test is surprised by it.
fn is_chance(search: &Search) -> bool {
    let [only] = &search.stages[..] else { return false };
    !only.adequate && !only.scene.smooth.is_empty() && smooth_evidence(&only.scene) <= 0.0
}

/// Log evidence of a smooth misfit that the base has and nobody thought of, over that of none.
fn smooth_evidence(scene: &Scene) -> f64 {
    let largest = scene.force.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    let rows = scene.force.len().max(1) as f64;
    let found: Vec<(f64, f64)> = scene
        .smooth
        .iter()
        .map(|d| (dot(&d.unit, &scene.z), (dot(&d.values, &d.values) / rows).sqrt()))
        .collect();
    let of = |size: f64, fade: f64| -> f64 {
        let term = |(j, (z, rms)): (usize, &(f64, f64))| {
            let t = (size * largest * (-(j as f64) / fade).exp() / rms.max(f64::MIN_POSITIVE)).powi(2);
            0.5 * (z * z * t / (1.0 + t) - t.ln_1p())
        };
        found.iter().enumerate().map(term).sum()
    };
    let all: Vec<f64> = SIZES.iter().flat_map(|size| FADES.map(|fade| of(*size, fade))).collect();
    let largest = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    largest + (all.iter().map(|value| (value - largest).exp()).sum::<f64>() / all.len() as f64).ln()
}
