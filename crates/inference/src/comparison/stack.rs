//! What each effect contributes to the force, with the numbers of the last fit.

use bulge_model::{Wanted, Warm};

use crate::comparison::analysis::{Analysis, Climbed};
use crate::comparison::document::{Part, Stack};
use crate::comparison::residuals::{bin, contractions};
use crate::error::InferenceError;
use crate::fit::carry_over::carry_over;

/// Bins of contraction.
const BINS: usize = 25;

/// Effects added one after the other, all with the numbers that the last fit gave them; rig errors within the data sheets come last.
pub(crate) fn contributions(analysis: &Analysis<'_>, last: &Climbed) -> Result<Vec<Stack>, InferenceError> {
    let effects = &analysis.options.effects;
    if effects.is_empty() {
        return Ok(Vec::new());
    }
    let record = &analysis.record;
    let counting = Warm::of_rows(&analysis.used.mask);
    let mut forces: Vec<Vec<f64>> = Vec::new();
    for count in 0..=effects.len() {
        let prepared = analysis.model(count)?;
        // Nuisances stay off until the last.
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
        forces.push(last.force.clone());
        names.push("rig within its data sheets".to_owned());
    }
    let [low, high] = contractions(analysis);
    let contraction: Vec<f64> = record.moments().iter().map(|m| m.contraction).collect();
    let all: Vec<&Vec<f64>> = forces.iter().collect();
    let mut stacks = Vec::new();
    for (level, pressure_pa) in analysis.levels.mean.iter().enumerate() {
        let mut rows_of = vec![Vec::new(); BINS];
        for row in analysis.with_state(&all).filter(|row| analysis.levels.at(*row) == level) {
            rows_of[bin(contraction[row], low, high, BINS)].push(row);
        }
        let filled: Vec<&Vec<usize>> = rows_of.iter().filter(|rows| !rows.is_empty()).collect();
        if filled.is_empty() {
            // With these numbers the muscle has no state here before all effects are in.
            continue;
        }
        let mean = |values: &[f64]| -> Vec<f64> {
            filled
                .iter()
                .map(|rows| rows.iter().map(|i| values[*i]).sum::<f64>() / rows.len() as f64)
                .collect()
        };
        let added = |i: usize| -> Vec<f64> {
            forces[i + 1].iter().zip(&forces[i]).map(|(with, without)| with - without).collect()
        };
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
