//! Loops: half the sum and half the difference of the lengthening and the shortening branch.

use bulge_measurements::{Data, Sweep, SweepKind};

use crate::comparison::analysis::Analysis;
use crate::comparison::document::LoopGap;
use crate::comparison::residuals::{bin, contractions};

/// Bins of contraction.
const BINS: usize = 25;

/// Names of the two branches of a loop.
pub(crate) fn branches(data: &Data) -> [&'static str; 2] {
    let is_isometric = |sweep: &Sweep| sweep.kind == SweepKind::Isometric;
    match (data.sweeps().iter().any(is_isometric), data.sweeps().iter().all(is_isometric)) {
        (true, true) => ["filling", "venting"],
        (true, false) => ["shortening or filling", "lengthening or venting"],
        (false, _) => ["shortening", "lengthening"],
    }
}

/// Largest distance of two rows between which a reading is interpolated: neighbours, apart from a few rows
/// that don't count.
const APART: usize = 3;

/// Sums at one place, for shortening and lengthening: number of readings; contraction, measured force and the
/// forces of two models.
#[derive(Debug, Clone, Copy, Default)]
struct Branches {
    rows: [usize; 2],
    sums: [[f64; 4]; 2],
}

/// Mean and half-gap at each pressure level and specimen for which both branches were measured.
///
/// Both branches are taken at the same place, interpolated between the two rows around it: the middle of a
/// contraction bin or, at held length, the mean of a pressure level. A model without hysteresis therefore has
/// no gap.
pub(crate) fn gaps(analysis: &Analysis<'_>, forces: [&Vec<f64>; 2]) -> Vec<LoopGap> {
    let specimens = analysis.record.specimens();
    let place = |level: usize, specimen: usize, bin: usize| (level * specimens.len() + specimen) * BINS + bin;
    let mut bins = vec![Branches::default(); analysis.levels.len() * specimens.len() * BINS];
    let rows: Vec<usize> = analysis.with_state(&forces).collect();
    for sweep in analysis.data.sweeps() {
        let [start, end] = [sweep.rows.start, sweep.rows.end].map(|row| rows.partition_point(|r| *r < row));
        collect(analysis, forces, sweep, &rows[start..end], |level, bin, branch, values| {
            let found = &mut bins[place(level, sweep.specimen as usize, bin)];
            found.rows[branch] += 1;
            found.sums[branch].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        });
    }
    let is_isometric = analysis.data.sweeps().iter().any(|sweep| sweep.kind == SweepKind::Isometric);
    // Few lengths are held, but many contractions are passed.
    let fewest = if is_isometric { 1 } else { 3 };
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
            if gap.contraction.len() >= fewest {
                gaps.push(gap);
            }
        }
    }
    gaps
}

/// Passes on what is read at each place that the rows of a sweep go through: level, bin, branch, and
/// contraction, measured force and model forces.
fn collect(
    analysis: &Analysis<'_>,
    forces: [&Vec<f64>; 2],
    sweep: &Sweep,
    rows: &[usize],
    mut take: impl FnMut(usize, usize, usize, [f64; 4]),
) {
    let (moments, measured) = (analysis.record.moments(), analysis.record.force());
    let [low, high] = contractions(analysis);
    let held = rows.iter().map(|row| moments[*row].contraction).sum::<f64>() / rows.len().max(1) as f64;
    let middle = |bin: usize| low + (bin as f64 + 0.5) * (high - low) / BINS as f64;
    let is_isometric = sweep.kind == SweepKind::Isometric;
    for pair in rows.windows(2).filter(|pair| pair[1] - pair[0] <= APART) {
        let (a, b) = (&moments[pair[0]], &moments[pair[1]]);
        let branch = usize::from(a.branch() < 0.0);
        if a.branch() * b.branch() <= 0.0 {
            continue;
        }
        let mut at = |level: usize, bin: usize, [from, to]: [f64; 2], place: f64| {
            let share = (place - from) / (to - from);
            let between = |values: [f64; 2]| values[0] + share * (values[1] - values[0]);
            let force = |force: &[f64]| between([force[pair[0]], force[pair[1]]]);
            let contraction = between([a.contraction, b.contraction]);
            take(level, bin, branch, [contraction, force(measured), force(forces[0]), force(forces[1])]);
        };
        let passes = |[from, to]: [f64; 2], place: f64| from.min(to) < place && place <= from.max(to);
        if is_isometric {
            let way = [a.pressure, b.pressure];
            for (level, mean) in analysis.levels.mean.iter().enumerate().filter(|(_, p)| passes(way, **p)) {
                at(level, bin(held, low, high, BINS), way, *mean);
            }
        } else if analysis.levels.at(pair[0]) == analysis.levels.at(pair[1]) {
            let way = [a.contraction, b.contraction];
            let [first, last] = [way[0].min(way[1]), way[0].max(way[1])].map(|c| bin(c, low, high, BINS));
            for bin in (first..=last).filter(|bin| passes(way, middle(*bin))) {
                at(analysis.levels.at(pair[0]), bin, way, middle(bin));
            }
        }
    }
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
