//! Sentences and numbers of a diagnosis shared by page and command line: plain text, no markup.

use bulge_inference::{CorrelationTime, Diagnosis, LadderStep, NoiseSource, Verdict};

use crate::comparison::number::{count, newton, three};
use crate::interval::with_interval;

/// A probability in per cent: `97 %`, `more than 99 %`, `less than 1 %`.
#[must_use]
pub fn chance(share: f64) -> String {
    match share {
        s if s > 0.995 => "more than 99 %".to_owned(),
        s if s < 0.005 => "less than 1 %".to_owned(),
        s => format!("{:.0} %", 100.0 * s),
    }
}

/// The p-value in words: `p = 0.03`, `p < 0.001`.
#[must_use]
pub fn once_in(p: f64) -> String {
    if p < 0.001 { "p < 0.001".to_owned() } else { format!("p = {}", three(p)) }
}

/// Whether a p-value is significant.
#[must_use]
pub fn is_significant(p: f64) -> bool {
    p < 0.05
}

/// Source of the noise estimate.
#[must_use]
pub const fn found_by(source: NoiseSource) -> &'static str {
    match source {
        NoiseSource::Repeats => "from repeated readings",
        NoiseSource::Saturated => "from what a model that can follow everything smooth leaves",
        NoiseSource::Instruments => "from the data sheets of the instruments",
    }
}

/// The base of the ladder: `equilibrium`, or `equilibrium + end-taper` with the effects that it already has.
#[must_use]
pub fn base_name(diagnosis: &Diagnosis) -> String {
    let comparison = &diagnosis.comparison;
    let added = diagnosis.ladder.iter().filter(|step| step.added.is_some() && !step.bent).count();
    let has = comparison.ladder.len().saturating_sub(added);
    let effects = comparison.ladder.iter().take(has).filter_map(|rung| rung.added.as_deref());
    std::iter::once(comparison.base.as_str()).chain(effects).collect::<Vec<_>>().join(" + ")
}

/// A rung of the ladder: the base, or the effect that it adds. For an effect with a form error it says
/// whether the rung is `coulomb-friction, by its formula` or `coulomb-friction, as the data want it`.
#[must_use]
pub fn step_name(diagnosis: &Diagnosis, step: &LadderStep) -> String {
    step.added
        .as_ref()
        .map_or_else(|| base_name(diagnosis), |added| format!("{added}{}", form_of_step(diagnosis, step)))
}

/// The suffix that `step_name` puts after the name of an effect.
pub(super) fn form_of_step(diagnosis: &Diagnosis, step: &LadderStep) -> &'static str {
    let mut bent = diagnosis.ladder.iter().filter(|step| step.bent).flat_map(LadderStep::effects);
    let mut is_bent_later = || bent.any(|name| step.effects().any(|own| own == name));
    match (step.bent, step.effects().count() > 1) {
        (true, false) => ", as the data want it",
        (true, true) => ", as the data want them",
        (false, false) if is_bent_later() => ", by its formula",
        (false, true) if is_bent_later() => ", by their formulas",
        (false, _) => "",
    }
}

/// The noise in a sentence: its size, its correlation, its source, and the effective number of rows.
#[must_use]
pub fn noise_says(diagnosis: &Diagnosis) -> String {
    let (noise, law) = (&diagnosis.noise, &diagnosis.noise.law);
    let scatters = format!("a single reading scatters by {}", newton(noise.sd_n));
    let part = newton(law.correlated_n);
    let correlated = match law.time.filter(|_| noise.correlated && law.correlated_n > 0.0) {
        Some(CorrelationTime::Seconds(time)) => format!(", {part} of it correlated over {} s", three(time)),
        Some(CorrelationTime::Rows(rows)) => format!(", {part} of it correlated over {} rows", three(rows)),
        None => String::new(),
    };
    let offsets = if law.offset_n > 0.0 {
        format!(", whole sweeps are off by {}", newton(law.offset_n))
    } else {
        String::new()
    };
    let independent = if noise.correlated { "" } else { ", readings are independent" };
    let effective = diagnosis.data.effective_rows;
    let counted = if effective < 0.95 * diagnosis.data.used as f64 {
        format!("; {} count as {}", count(diagnosis.data.used, "row"), three(effective))
    } else {
        String::new()
    };
    format!("{scatters}{correlated}{offsets}{independent}, {}{counted}", found_by(noise.source))
}

/// The remaining misfit in a sentence: the systematic misfit with its interval, and whether it has structure.
#[must_use]
pub fn remains_says(diagnosis: &Diagnosis) -> String {
    let remaining = &diagnosis.remaining;
    let ends = remaining.misfit_interval_n;
    let [value, low, high] = with_interval(remaining.misfit_n, ends)
        .unwrap_or_else(|| [remaining.misfit_n, ends[0], ends[1]].map(three));
    let low_n = ends[0];
    let structure = match remaining.structured {
        _ if diagnosis.verdict == Verdict::CannotTell && low_n > 0.0 => "what it comes from cannot be told",
        _ if diagnosis.verdict == Verdict::CannotTell => "whether it has a structure cannot be told",
        true if remaining.misfit_n > 0.0 => "it has a structure beyond chance",
        true => "a structure beyond chance whose size these data don't tell",
        // The interval excludes zero, but the misfit is within the tolerance, or a rare chance.
        false if diagnosis.verdict == Verdict::Adequate && low_n > 0.0 => "no structure that counts",
        false => "no structure beyond chance",
    };
    format!("{value} N of systematic misfit (RMS; 95 % interval {low} to {high} N): {structure}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chances_are_never_certain() {
        assert_eq!(
            [1.0, 0.996, 0.97, 0.994, 0.0].map(chance),
            ["more than 99 %", "more than 99 %", "97 %", "99 %", "less than 1 %"]
        );
        assert_eq!(
            [1e-20, 0.001, 0.0312, 1.0].map(once_in),
            ["p < 0.001", "p = 0.00100", "p = 0.0312", "p = 1.00"]
        );
        assert!(is_significant(0.049) && !is_significant(0.05));
    }
}
