//! Contribution of each effect to the force, with the parameters of the last fit.

use bulge_model::{Wanted, Warm};

use crate::comparison::analysis::{Analysis, Climbed, FEWER_ROWS};
use crate::comparison::document::{Part, Stack};
use crate::comparison::residuals::{bin, contractions};
use crate::error::InferenceError;
use crate::fit::carry_over::carry_over;
use crate::vector::minus;

/// Bins of contraction.
const BINS: usize = 25;

/// Adds the effects one after the other, each with the parameters of the last fit; rig errors within the data
/// sheets come last.
pub(crate) fn contributions(analysis: &Analysis<'_>, last: &Climbed) -> Result<Vec<Stack>, InferenceError> {
    let effects = &analysis.options.effects;
    if effects.is_empty() {
        return Ok(Vec::new());
    }
    // A thinned record is enough for the bins.
    let (record, kept) = &analysis.record.thinned(FEWER_ROWS);
    let row_of = |place: usize| kept[place];
    let counts: Vec<bool> = (0..record.len()).map(|place| analysis.used.mask[row_of(place)]).collect();
    let counting = Warm::of_rows(&counts);
    let mut forces: Vec<Vec<f64>> = Vec::new();
    for count in 0..=effects.len() {
        let prepared = analysis.model(count)?;
        // Nuisance parameters stay off until the end.
        let mut theta = prepared.model.off();
        let asked = |i: usize| !prepared.nuisance[i];
        let mut final_values = theta.clone();
        carry_over(&last.prepared.model, &last.theta, &prepared.model, &mut final_values);
        for (i, value) in theta.iter_mut().enumerate() {
            if asked(i) {
                *value = final_values[i];
            }
        }
        let prediction = prepared.model.evaluate_partly(record, &theta, &Wanted::default(), &counting);
        forces.push(prediction.map_err(|error| analysis.about(error))?.prediction.force);
    }
    let mut names: Vec<String> = effects.iter().map(|effect| effect.card().name.to_owned()).collect();
    if last.prepared.nuisance.contains(&true) {
        forces.push((0..record.len()).map(|place| last.force[row_of(place)]).collect());
        names.push("rig within its data sheets".to_owned());
    }
    let [low, high] = contractions(analysis);
    let contraction: Vec<f64> = record.moments().iter().map(|m| m.contraction).collect();
    let has_state = |place: &usize| counts[*place] && forces.iter().all(|force| force[*place].is_finite());
    let mut stacks = Vec::new();
    for (level, pressure_pa) in analysis.levels.mean.iter().enumerate() {
        let mut rows_of = vec![Vec::new(); BINS];
        let here = (0..record.len()).filter(has_state);
        for place in here.filter(|place| analysis.levels.at(row_of(*place)) == level) {
            rows_of[bin(contraction[place], low, high, BINS)].push(place);
        }
        let filled: Vec<&Vec<usize>> = rows_of.iter().filter(|rows| !rows.is_empty()).collect();
        if filled.is_empty() {
            // With these parameters the muscle has no state here before all effects are added.
            continue;
        }
        let mean = |values: &[f64]| -> Vec<f64> {
            filled
                .iter()
                .map(|rows| rows.iter().map(|i| values[*i]).sum::<f64>() / rows.len() as f64)
                .collect()
        };
        let added = |i: usize| minus(&forces[i + 1], &forces[i]);
        stacks.push(Stack {
            pressure_pa: *pressure_pa,
            contraction: mean(&contraction),
            measured_n: mean(record.force()),
            base_n: mean(&forces[0]),
            parts: names
                .iter()
                .enumerate()
                .map(|(i, effect)| Part { effect: effect.clone(), force_n: mean(&added(i)) })
                .collect(),
        });
    }
    Ok(stacks)
}
