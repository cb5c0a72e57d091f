//! Loops: half of the sum and half of the difference of the lengthening and the shortening branch.

use bulge_measurements::{Data, Sweep, SweepKind};

use crate::comparison::analysis::Analysis;
use crate::comparison::document::LoopGap;
use crate::comparison::residuals::{bin, contractions};

/// Bins of contraction.
const BINS: usize = 25;

/// What the two branches of a loop are called.
pub(crate) fn branches(data: &Data) -> [&'static str; 2] {
    let is_isometric = |sweep: &Sweep| sweep.kind == SweepKind::Isometric;
    match (data.sweeps().iter().any(is_isometric), data.sweeps().iter().all(is_isometric)) {
        (true, true) => ["filling", "venting"],
        (true, false) => ["shortening or filling", "lengthening or venting"],
        (false, _) => ["shortening", "lengthening"],
    }
}

/// Sums over one bin: rows, contraction, measured and two models, for shortening and lengthening.
#[derive(Debug, Clone, Copy, Default)]
struct Branches {
    rows: [usize; 2],
    sums: [[f64; 4]; 2],
}

/// Mean and half-gap at each pressure level and specimen where both branches were measured. The means of a bin are taken at slightly
/// different contractions on the two branches; the model is taken at the same rows, so that its difference from the measurement is fair.
pub(crate) fn gaps(analysis: &Analysis<'_>, forces: [&Vec<f64>; 2]) -> Vec<LoopGap> {
    let moments = analysis.record.moments();
    let measured = analysis.record.force();
    let specimens = analysis.record.specimens();
    let [low, high] = contractions(analysis);
    let place = |level: usize, specimen: usize, bin: usize| (level * specimens.len() + specimen) * BINS + bin;
    let mut bins = vec![Branches::default(); analysis.levels.len() * specimens.len() * BINS];
    for row in analysis.with_state(&forces).filter(|row| moments[*row].branch() != 0.0) {
        let m = &moments[row];
        let at = place(analysis.levels.at(row), m.specimen as usize, bin(m.contraction, low, high, BINS));
        let branch = usize::from(m.branch() < 0.0);
        bins[at].rows[branch] += 1;
        for (sum, value) in bins[at].sums[branch].iter_mut().zip([
            m.contraction,
            measured[row],
            forces[0][row],
            forces[1][row],
        ]) {
            *sum += value;
        }
    }
    let mut gaps = Vec::new();
    for (level, pressure_pa) in analysis.levels.mean.iter().enumerate() {
        for (specimen, name) in specimens.iter().enumerate() {
            let mut gap = LoopGap {
                pressure_pa: *pressure_pa,
                specimen: name.clone(),
                contraction: Vec::new(),
                mean_measured_n: Vec::new(),
                mean_model_n: [Vec::new(), Vec::new()],
                half_gap_measured_n: Vec::new(),
                half_gap_model_n: [Vec::new(), Vec::new()],
            };
            for i in 0..BINS {
                let branches = bins[place(level, specimen, i)];
                if branches.rows.contains(&0) {
                    continue;
                }
                let mean =
                    |branch: usize, what: usize| branches.sums[branch][what] / branches.rows[branch] as f64;
                let half = |what: usize| {
                    [0.5 * (mean(1, what) + mean(0, what)), 0.5 * (mean(1, what) - mean(0, what))]
                };
                gap.contraction.push(half(0)[0]);
                let all = [half(1), half(2), half(3)];
                gap.mean_measured_n.push(all[0][0]);
                gap.half_gap_measured_n.push(all[0][1]);
                for model in 0..2 {
                    gap.mean_model_n[model].push(all[1 + model][0]);
                    gap.half_gap_model_n[model].push(all[1 + model][1]);
                }
            }
            if gap.contraction.len() > 2 {
                gaps.push(gap);
            }
        }
    }
    gaps
}

/// RMS error of the half-gap \[N\]; none without loops.
pub(crate) fn half_gap_error(analysis: &Analysis<'_>, force: &Vec<f64>) -> Option<f64> {
    let gaps = gaps(analysis, [force, force]);
    let errors: Vec<f64> = gaps
        .iter()
        .flat_map(|gap| gap.half_gap_measured_n.iter().zip(&gap.half_gap_model_n[1]))
        .map(|(measured, model)| (measured - model).powi(2))
        .collect();
    (!errors.is_empty()).then(|| (errors.iter().sum::<f64>() / errors.len() as f64).sqrt())
}
