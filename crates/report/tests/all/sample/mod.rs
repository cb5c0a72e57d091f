//! Comparisons to draw: a simulated braided muscle in loops, and odd cases derived from it.

#![expect(clippy::float_cmp, reason = "values are compared with those they were copied from")]

use bulge_inference::{
    Bin, Breakdown, Comparison, Convergence, Curve, CurvePoint, DataSummary, Fit, Fitted, HeldLoad,
    HeldLoadPoint, LeftOut, LoopGap, NoiseFloor, Part, ResidualMap, Rival, Rows, Rung, Stack,
};
use bulge_measurements::{Finding, FindingKind, LineRange, Severity, SweepKind};
use std::f64::consts::PI;

/// A name that looks like markup but is text.
const HOSTILE: &str = "<script>alert(\"1\")</script> & 'b' \u{7}";

/// Parameters of the simulation.
#[derive(Debug, Clone)]
pub(crate) struct Recipe {
    /// Pressure levels \[Pa\].
    pub(crate) pressures_pa: Vec<f64>,
    /// Names of the specimens.
    pub(crate) specimens: Vec<String>,
    /// Rows of each sweep.
    pub(crate) rows: usize,
}

impl Recipe {
    /// Two specimens at five pressures.
    pub(crate) fn usual() -> Self {
        let pressures_pa = vec![0.5e5, 1e5, 1.5e5, 2e5, 3e5];
        Self { pressures_pa, specimens: vec!["A".to_owned(), "B".to_owned()], rows: 45 }
    }

    /// One pressure, few rows.
    pub(crate) fn bare() -> Self {
        Self { pressures_pa: vec![2e5], specimens: vec!["1".to_owned()], rows: 12 }
    }

    /// Many of everything.
    pub(crate) fn crowded() -> Self {
        Self {
            pressures_pa: (1..=40).map(|i| 1e4 * f64::from(i)).collect(),
            specimens: (1..=9).map(|i| format!("spring series of last year, number {i}")).collect(),
            rows: 8,
        }
    }

    /// A specimen whose name looks like markup.
    pub(crate) fn hostile() -> Self {
        Self { pressures_pa: vec![1e5, 2e5], specimens: vec![HOSTILE.to_owned(), "2".to_owned()], rows: 10 }
    }
}

/// One simulated reading with the forces of the first and the last rung.
#[derive(Debug, Clone, Copy)]
struct Row {
    pressure: f64,
    contraction: f64,
    direction: f64,
    time: f64,
    sweep: usize,
    specimen: usize,
    measured: f64,
    first: f64,
    last: f64,
}

/// Ideal braided cylinder of 10 mm radius and 24 deg: F = p pi r^2 (3 (1 - eps)^2/tan^2 - 1/sin^2).
fn ideal(pressure: f64, contraction: f64) -> f64 {
    let alpha = 24_f64.to_radians();
    pressure * PI * 1e-4 * (3.0 * (1.0 - contraction).powi(2) / alpha.tan().powi(2) - alpha.sin().powi(-2))
}

/// Contributions of the effects: bladder, friction, pressure gain, ends.
fn effects(pressure: f64, contraction: f64, direction: f64) -> [f64; 4] {
    [
        -60.0 * (1.0 - (1.0 - contraction).powi(2)) - 18.0,
        -direction * (6.0 + 4e-5 * pressure),
        -0.06 * ideal(pressure, contraction),
        -1.2e-3 * pressure * contraction,
    ]
}

/// Repeatable noise with about the given standard deviation.
fn noise(state: &mut u64, sd: f64) -> f64 {
    let mut uniform = || {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let sum: f64 = (0..12).map(|_| uniform()).sum();
    sd * (sum - 6.0)
}

fn simulate(recipe: &Recipe) -> Vec<Row> {
    let mut state = 42;
    let mut rows = Vec::new();
    let mut sweep = 0;
    for (specimen, _) in recipe.specimens.iter().enumerate() {
        for pressure in &recipe.pressures_pa {
            for direction in [1.0, -1.0] {
                for i in 0..recipe.rows {
                    let share = i as f64 / (recipe.rows - 1).max(1) as f64;
                    let share = if direction > 0.0 { share } else { 1.0 - share };
                    let contraction = 0.005 + 0.25 * share;
                    let all: f64 = effects(*pressure, contraction, direction).iter().sum();
                    let first = ideal(*pressure, contraction);
                    let own = if specimen % 2 == 0 { 2.0 } else { -2.0 };
                    let missing = 3.0 * (contraction * 40.0).sin();
                    let measured = first + all + own + missing + noise(&mut state, 2.5);
                    let last = first + all;
                    let time = rows.len() as f64 * 0.2;
                    rows.push(Row {
                        pressure: *pressure,
                        contraction,
                        direction,
                        time,
                        sweep,
                        specimen,
                        measured,
                        first,
                        last,
                    });
                }
                sweep += 1;
            }
        }
    }
    rows
}

fn rms(errors: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = errors.fold((0.0, 0.0), |(s, n), e| (s + e * e, n + 1.0));
    (sum / f64::max(n, 1.0)).sqrt()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    sum / f64::max(n, 1.0)
}

fn broken_down(
    rows: &[Row],
    variable: &'static str,
    unit: &'static str,
    bins: &[(String, f64)],
    bin: impl Fn(&Row) -> usize,
) -> Breakdown {
    let of = |i: usize| rows.iter().filter(|row| bin(row) == i).collect::<Vec<_>>();
    let bins = bins.iter().enumerate().map(|(i, (label, at))| {
        let of = of(i);
        Bin {
            label: label.clone(),
            at: *at,
            rows: of.len(),
            bias_n: [
                mean(of.iter().map(|r| r.measured - r.first)),
                mean(of.iter().map(|r| r.measured - r.last)),
            ],
            rmse_n: [
                rms(of.iter().map(|r| r.measured - r.first)),
                rms(of.iter().map(|r| r.measured - r.last)),
            ],
        }
    });
    Breakdown { variable, unit, bins: bins.collect() }
}

fn part(value: f64, low: f64, high: f64, bins: usize) -> usize {
    let share = ((value - low) / (high - low)).clamp(0.0, 0.999_999);
    (0..bins).rev().find(|i| share >= *i as f64 / bins as f64).unwrap_or(0)
}

fn even(low: f64, high: f64, bins: usize) -> Vec<(String, f64)> {
    let width = (high - low) / bins as f64;
    let bin = |i| {
        let start = low + i as f64 * width;
        (format!("{start:.1} to {:.1}", start + width), start + 0.5 * width)
    };
    (0..bins).map(bin).collect()
}

fn breakdowns(rows: &[Row], recipe: &Recipe) -> Vec<Breakdown> {
    let level = |row: &Row| recipe.pressures_pa.iter().position(|p| *p == row.pressure).unwrap_or(0);
    let pressures: Vec<_> =
        recipe.pressures_pa.iter().map(|p| (format!("{:.2}", p / 1e5), p / 1e5)).collect();
    let end = rows.last().map_or(1.0, |row| row.time);
    let sweeps: Vec<_> = (0..=rows.last().map_or(0, |row| row.sweep))
        .map(|i| (format!("{}", i + 1), (i + 1) as f64))
        .collect();
    let directions = [("shortening".to_owned(), 1.0), ("lengthening".to_owned(), -1.0)];
    let specimens: Vec<_> =
        recipe.specimens.iter().enumerate().map(|(i, name)| (name.clone(), (i + 1) as f64)).collect();
    let all = vec![
        broken_down(rows, "pressure", "bar", &pressures, level),
        broken_down(rows, "contraction", "%", &even(0.5, 25.5, 10), |r| {
            part(r.contraction, 0.005, 0.255, 10)
        }),
        broken_down(rows, "direction", "", &directions, |r| usize::from(r.direction < 0.0)),
        broken_down(rows, "rate", "%/s", &even(-3.0, 3.0, 4), |r| part(r.direction, -1.5, 1.5, 4)),
        broken_down(rows, "time", "s", &even(0.0, end, 10), |r| part(r.time, 0.0, end, 10)),
        broken_down(rows, "sweep", "", &sweeps, |r| r.sweep),
        broken_down(rows, "specimen", "", &specimens, |r| r.specimen),
    ];
    all.into_iter()
        .map(|by| Breakdown { bins: by.bins.into_iter().filter(|bin| bin.rows > 0).collect(), ..by })
        .filter(|by| by.bins.len() > 1)
        .collect()
}

fn maps(rows: &[Row], recipe: &Recipe) -> Vec<ResidualMap> {
    let columns = 12;
    let contraction: Vec<f64> =
        (0..columns).map(|i| 0.005 + 0.25 * (i as f64 + 0.5) / columns as f64).collect();
    let map = |direction: &'static str, sign: f64| {
        let cell = |i: usize, error: fn(&Row) -> f64| {
            let (p, c) = (recipe.pressures_pa[i / columns], i % columns);
            let of = rows.iter().filter(|r| {
                r.direction == sign && r.pressure == p && part(r.contraction, 0.005, 0.255, columns) == c
            });
            let errors: Vec<f64> = of.map(error).collect();
            // At the lowest pressure the largest contraction isn't reached.
            let is_reached = i / columns > 0 || c < columns - 3;
            (is_reached && !errors.is_empty()).then(|| mean(errors.into_iter()))
        };
        let cells = recipe.pressures_pa.len() * columns;
        ResidualMap {
            direction,
            pressure_pa: recipe.pressures_pa.clone(),
            contraction: contraction.clone(),
            first_n: (0..cells).map(|i| cell(i, |r| r.measured - r.first)).collect(),
            last_n: (0..cells).map(|i| cell(i, |r| r.measured - r.last)).collect(),
        }
    };
    vec![map("shortening", 1.0), map("lengthening", -1.0)]
}

fn loops(rows: &[Row], recipe: &Recipe) -> Vec<LoopGap> {
    let bins = 20;
    let contraction: Vec<f64> = (0..bins).map(|i| 0.005 + 0.25 * (i as f64 + 0.5) / bins as f64).collect();
    let mut loops = Vec::new();
    for (s, specimen) in recipe.specimens.iter().enumerate() {
        for p in &recipe.pressures_pa {
            let branch = |i: usize, sign: f64, force: fn(&Row) -> f64| {
                mean(
                    rows.iter()
                        .filter(|r| r.specimen == s && r.pressure == *p && r.direction == sign)
                        .filter(|r| part(r.contraction, 0.005, 0.255, bins) == i)
                        .map(force),
                )
            };
            let is_filled = |i: usize| {
                rows.iter().any(|r| r.pressure == *p && part(r.contraction, 0.005, 0.255, bins) == i)
            };
            let filled: Vec<usize> = (0..bins).filter(|i| is_filled(*i)).collect();
            let half = |sign: f64, force: fn(&Row) -> f64| -> Vec<f64> {
                filled
                    .iter()
                    .copied()
                    .map(|i| 0.5 * (branch(i, -1.0, force) + sign * branch(i, 1.0, force)))
                    .collect()
            };
            loops.push(LoopGap {
                pressure_pa: *p,
                specimen: specimen.clone(),
                contraction: filled.iter().map(|i| contraction[*i]).collect(),
                mean_measured_n: half(1.0, |r| r.measured),
                mean_model_n: [half(1.0, |r| r.first), half(1.0, |r| r.last)],
                half_gap_measured_n: half(-1.0, |r| r.measured),
                half_gap_model_n: [half(-1.0, |r| r.first), half(-1.0, |r| r.last)],
            });
        }
    }
    loops
}

const NAMES: [(&str, &str); 4] = [
    ("bladder-elasticity", "Elasticity of the bladder"),
    ("coulomb-friction", "Friction between the threads of the braid"),
    ("pressure-gain", "Gain of the pressure sensor"),
    ("end-taper", "Ends that do not bulge"),
];

fn stacks(recipe: &Recipe) -> Vec<Stack> {
    let contraction: Vec<f64> = (0..25).map(|i| 0.005 + 0.01 * f64::from(i)).collect();
    let stack = |pressure: f64| {
        let parts = NAMES.iter().enumerate().map(|(k, (name, _))| Part {
            effect: (*name).to_owned(),
            force_n: contraction.iter().map(|e| effects(pressure, *e, 0.05)[k]).collect(),
        });
        let base_n: Vec<f64> = contraction.iter().map(|e| ideal(pressure, *e)).collect();
        let measured = |e: f64| {
            ideal(pressure, e) + effects(pressure, e, 0.0).iter().sum::<f64>() + 3.0 * (40.0 * e).sin()
        };
        Stack {
            pressure_pa: pressure,
            measured_n: contraction.iter().map(|e| measured(*e)).collect(),
            base_n,
            parts: parts.collect(),
            contraction: contraction.clone(),
        }
    };
    recipe.pressures_pa.iter().map(|p| stack(*p)).collect()
}

/// A fitted parameter without remarks.
pub(crate) fn fitted(
    effect: &str,
    name: &str,
    unit: &str,
    [value, low, high]: [f64; 3],
    plausible: [f64; 2],
) -> Fitted {
    Fitted {
        effect: effect.to_owned(),
        name: name.to_owned(),
        specimen: None,
        value,
        low,
        high,
        unit: unit.to_owned(),
        interval: "covariance",
        at_bound: None,
        plausible: value >= plausible[0] && value <= plausible[1],
        plausible_range: plausible,
        determined: true,
        nuisance: false,
        also: None,
        about: format!("the {name} of {effect}"),
    }
}

fn fit() -> Fit {
    let mut parameters = vec![
        fitted("bladder-elasticity", "modulus", "MPa", [0.914, 0.871, 0.957], [0.3, 3.0]),
        fitted("coulomb-friction", "force", "N", [7.12, 6.83, 7.41], [0.0, 30.0]),
        fitted("coulomb-friction", "per pressure", "N/bar", [3.98, 3.84, 4.12], [0.0, 12.0]),
        fitted("pressure-gain", "gain", "%", [-6.02, -6.31, -5.73], [-2.0, 2.0]),
        fitted("end-taper", "length", "mm", [40.0, 21.0, 40.0], [0.0, 40.0]),
        fitted("force-offset", "offset", "N", [-18.2, -19.9, -16.5], [-20.0, 20.0]),
        fitted("fibre-stretch", "compliance", "%/kN", [0.0031, -0.4, 0.41], [0.0, 0.5]),
        fitted("specimen-spread", "force", "N", [2.04, 1.71, 2.37], [-10.0, 10.0]),
    ];
    parameters[4].at_bound = Some("upper");
    parameters[5].nuisance = true;
    parameters[5].interval = "profile";
    parameters[6].determined = false;
    parameters[6].also = Some(("EA of all fibres".to_owned(), 322.6, "kN".to_owned()));
    parameters[7].specimen = Some("A".to_owned());
    let n = parameters.len();
    let mut correlations = vec![0.1; n * n];
    for i in 0..n {
        correlations[i * n + i] = 1.0;
    }
    for (i, j, r) in [(0, 5, -0.973), (3, 4, 0.914)] {
        correlations[i * n + j] = r;
        correlations[j * n + i] = r;
    }
    Fit {
        parameters,
        rmse_n: 4.02,
        cost: 512.3,
        sd_n: 2.51,
        effective_rows: 118.4,
        correlations,
        convergence: Convergence {
            converged: true,
            reason: "the step became smaller than 1e-10 of the numbers".to_owned(),
            gradient_cosine: 3.2e-9,
            iterations: 17,
            starts: 12,
            agreeing: 10,
            minima: 2,
            rank: 7,
        },
        warnings: vec![
            "pressure-gain.gain is -6.02 %, which no gauge has (plausible: -2 to 2 %): it stands in for something else"
                .to_owned(),
        ],
        ..Fit::default()
    }
}

fn ladder(rows: &[Row]) -> Vec<Rung> {
    let base = rms(rows.iter().map(|r| r.measured - r.first));
    let last = rms(rows.iter().map(|r| r.measured - r.last));
    let scale = rows.iter().map(|r| r.measured).fold(1.0, f64::max);
    let steps = [1.0, 0.55, 0.31, 0.02, 0.0];
    let mut ladder = Vec::new();
    for (i, share) in steps.into_iter().enumerate() {
        let rmse = last + share * (base - last);
        let (added, title) = if i == 0 {
            (None, "Equilibrium of fibres and pressure".to_owned())
        } else {
            (Some(NAMES[i - 1].0.to_owned()), NAMES[i - 1].1.to_owned())
        };
        ladder.push(Rung {
            added,
            title,
            rmse_n: rmse,
            rmse_percent: 100.0 * rmse / scale,
            bias_n: -0.6 * rmse * share,
            largest_n: 2.7 * rmse,
            held_out_rmse_n: (i > 0).then_some(if i == 4 { 1.4 * rmse } else { 1.08 * rmse }),
            held_out_by: Some("pressure"),
            r_squared: 1.0 - 0.09 * (rmse / base).powi(2),
            fitted: 2 * i,
            half_gap_rmse_n: Some(if i < 2 { 12.4 } else { 0.84 }),
            fit: (i > 0).then(fit),
            ..Rung::default()
        });
    }
    ladder
}

fn quality() -> Vec<Finding> {
    vec![
        Finding {
            kind: FindingKind::Quantised,
            severity: Severity::Note,
            rows: Vec::new(),
            count: 900,
            says: "The force has 412 levels of 1 N: steps are 0.4 times the scatter.".to_owned(),
            instead: "Nothing: this is finer than what is compared.".to_owned(),
        },
        Finding {
            kind: FindingKind::Spike,
            severity: Severity::Warning,
            rows: vec![
                LineRange { file: 0, first: 118, last: 118 },
                LineRange { file: 0, first: 402, last: 405 },
            ],
            count: 5,
            says: "5 readings lie more than 8 scatters from their neighbours.".to_owned(),
            instead:
                "Look at these lines; leave them out with `--without-lines` if the load cell was touched."
                    .to_owned(),
        },
    ]
}

fn rivals() -> Vec<Rival> {
    let rival = |law: &str, title: &str, printed, rmse: f64, fitted| Rival {
        law: law.to_owned(),
        title: title.to_owned(),
        printed_rmse_n: printed,
        rmse_n: rmse,
        rmse_percent: rmse / 8.0,
        held_out_rmse_n: Some(1.1 * rmse),
        fitted,
        failed: None,
    };
    let mut rivals = vec![
        rival("chou-hannaford", "Chou and Hannaford 1996", Some(88.1), 21.7, 2),
        rival("sarosi", "Sárosi 2012", None, 9.63, 6),
        rival("hildebrandt", "Hildebrandt 2005", None, 0.0, 12),
    ];
    rivals[2].failed = Some("it needs six pressures or more, and there are five".to_owned());
    rivals
}

/// The rows of a comparison created from this recipe, with the force of each of its rungs.
pub(crate) fn rows(recipe: &Recipe, comparison: &Comparison) -> Rows {
    let rows = simulate(recipe);
    let sweeps = comparison.data.sweeps;
    let added: Vec<String> = comparison.ladder.iter().filter_map(|rung| rung.added.clone()).collect();
    let rung = |k: usize| -> Vec<f64> {
        let error = |k: usize| comparison.ladder[k].rmse_n;
        let share = if k == 0 { 0.0 } else { (error(0) - error(k)) / (error(0) - error(added.len())) };
        rows.iter().map(|r| r.first + share * (r.last - r.first)).collect()
    };
    let place = |value: usize| u32::try_from(value).unwrap_or(u32::MAX);
    // Every fiftieth row doesn't count; every second of those was excluded by hand.
    let is_out = |row: usize| row % 50 == 49;
    Rows {
        files: comparison.data.files.clone(),
        sweeps: (1..=sweeps).map(|sweep| sweep.to_string()).collect(),
        sweep_kinds: comparison.data.sweep_kinds.clone(),
        specimens: comparison.data.specimens.clone(),
        reasons: vec!["spike".to_owned(), "excluded by hand".to_owned()],
        file: vec![0; rows.len()],
        line: (2..).take(rows.len()).collect(),
        sweep: rows.iter().map(|row| place(row.sweep)).collect(),
        specimen: rows.iter().map(|row| place(row.specimen)).collect(),
        counts: (0..rows.len()).map(|row| !is_out(row)).collect(),
        reason: (0..rows.len()).map(|row| is_out(row).then_some(u32::from(row % 100 == 99))).collect(),
        excluded: (0..rows.len()).map(|row| row % 100 == 99).collect(),
        is_path: comparison.data.is_path,
        time_s: comparison.data.is_path.then(|| rows.iter().map(|row| row.time).collect()),
        temperature_k: None,
        pressure_pa: rows.iter().map(|row| row.pressure).collect(),
        contraction: rows.iter().map(|row| row.contraction).collect(),
        rate: rows.iter().map(|row| 0.028 * row.direction).collect(),
        direction: rows.iter().map(|row| row.direction).collect(),
        measured_n: rows.iter().map(|row| row.measured).collect(),
        base_n: rung(0),
        between_n: (1..added.len()).map(rung).collect(),
        model_n: rung(added.len()),
        effects: added,
    }
}

/// A comparison in which every section has something to show.
pub(crate) fn rich(recipe: &Recipe) -> Comparison {
    let rows = simulate(recipe);
    let forces = || rows.iter().map(|r| r.measured);
    let [low, high] = forces().fold([f64::MAX, f64::MIN], |[l, h], f| [l.min(f), h.max(f)]);
    let mut curves = Vec::new();
    for (s, specimen) in recipe.specimens.iter().enumerate() {
        for p in &recipe.pressures_pa {
            let points = rows.iter().filter(|r| r.specimen == s && r.pressure == *p).map(|r| CurvePoint {
                pressure_pa: *p,
                contraction: r.contraction,
                direction: r.direction,
                measured_n: r.measured,
                first_n: r.first,
                last_n: r.last,
            });
            curves.push(Curve { pressure_pa: *p, specimen: specimen.clone(), points: points.collect() });
        }
    }
    Comparison {
        schema: "bulge.comparison/1",
        muscle: "Braided muscle 20 × 300, clamped ends".to_owned(),
        base: "equilibrium".to_owned(),
        data: DataSummary {
            rows: rows.len() + 17,
            used: rows.len(),
            left_out: vec![LeftOut { why: "slack: no force at all".to_owned(), lines: "12, 33–48".to_owned(), rows: 17 }],
            sha256: "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08".to_owned(),
            files: vec!["loops-a.csv".to_owned()],
            sweeps: rows.last().map_or(0, |row| row.sweep + 1),
            sweep_kinds: vec![SweepKind::Loop; rows.last().map_or(0, |row| row.sweep + 1)],
            branches: ["shortening", "lengthening"],
            specimens: recipe.specimens.clone(),
            is_path: true,
            pressure_pa: [recipe.pressures_pa[0], *recipe.pressures_pa.last().unwrap_or(&0.0)],
            contraction: [0.005, 0.255],
            force_n: [low, high],
            full_scale_n: high,
            ..DataSummary::default()
        },
        quality: quality(),
        noise_floor: Some(NoiseFloor {
            sd_n: 2.51,
            source: "repeats",
            says: "from 32 groups of readings that were repeated at the same pressure and contraction".to_owned(),
        }),
        ladder: ladder(&rows),
        by: breakdowns(&rows, recipe),
        loops: loops(&rows, recipe),
        isotonic: held_loads(),
        maps: maps(&rows, recipe),
        curves,
        contributions: stacks(recipe),
        scatter: rows.iter().take(2000).map(|r| [r.measured, r.first, r.last]).collect(),
        rivals: rivals(),
        warnings: vec![
            "pressure-gain.gain is -6.02 %, which no gauge has (plausible: -2 to 2 %): it stands in for something else"
                .to_owned(),
            "end-taper.length lies at its upper bound of 40 mm: the true value may be larger".to_owned(),
        ],
    }
}

/// Two loads, each during filling and venting.
fn held_loads() -> Vec<HeldLoad> {
    [100.0, 300.0]
        .map(|load_n| {
            let points = (0..40).map(|i| {
                let pressure_pa = 1e5 * (1.0 + 0.1 * f64::from(if i < 20 { i } else { 40 - i }));
                let contraction = 0.2 - 2e4 / pressure_pa - 1e-4 * load_n;
                let direction = if i < 20 { 1.0 } else { -1.0 };
                HeldLoadPoint {
                    pressure_pa,
                    contraction,
                    direction,
                    first: contraction + 0.01,
                    last: contraction + 1e-3,
                }
            });
            HeldLoad {
                sweep: format!("{load_n} N"),
                specimen: "A".to_owned(),
                load_n,
                rmse_contraction: [0.01, 1e-3],
                points: points.collect(),
            }
        })
        .into()
}

/// A static map with the base alone: no loops, one pressure, nothing fitted.
pub(crate) fn bare() -> Comparison {
    let mut all = rich(&Recipe::bare());
    all.data.is_path = false;
    all.data.left_out.clear();
    all.data.rows = all.data.used;
    for bin in all.by.iter_mut().flat_map(|by| &mut by.bins) {
        (bin.bias_n[1], bin.rmse_n[1]) = (bin.bias_n[0], bin.rmse_n[0]);
    }
    all.quality.clear();
    all.noise_floor = None;
    all.ladder.truncate(1);
    all.ladder[0].half_gap_rmse_n = None;
    all.by.retain(|by| by.variable == "contraction");
    for map in &mut all.maps {
        map.direction = "at rest";
    }
    all.maps.truncate(1);
    all.loops.clear();
    all.isotonic.clear();
    all.contributions.clear();
    all.rivals.clear();
    all.warnings.clear();
    all
}

/// Nothing at all: no rung, no row.
pub(crate) fn empty() -> Comparison {
    let mut all = bare();
    all.ladder.clear();
    all.by.clear();
    all.maps.clear();
    all.curves.clear();
    all.scatter.clear();
    all
}

/// Forty pressures, nine specimens with long names, thirty effects.
pub(crate) fn crowded() -> Comparison {
    let mut all = rich(&Recipe::crowded());
    let last = all.ladder.pop();
    for i in 0..26 {
        let mut rung = all.ladder[3].clone();
        rung.added = Some(format!("effect-number-{i}"));
        rung.title =
            format!("Effect number {i} with a title that is much longer than any drawing has room for");
        rung.rmse_n *= 1.0 - 0.005 * f64::from(i);
        rung.fitted = 8 + all.ladder.len();
        all.ladder.push(rung);
    }
    all.ladder.extend(last);
    if let Some(fit) = all.ladder.last_mut().and_then(|rung| rung.fit.as_mut()) {
        for i in 0..40 {
            let name = format!("number {i} with a long name");
            let value = 1.37_f64.powi(i - 20);
            fit.parameters.push(fitted(
                "effect",
                &name,
                "N/m",
                [value, 0.9 * value, 1.1 * value],
                [0.0, 2.0 * value],
            ));
        }
        fit.correlations = vec![0.95; fit.parameters.len() * fit.parameters.len()];
    }
    for stack in &mut all.contributions {
        for i in 0..26 {
            let force_n = stack.contraction.iter().map(|e| f64::from(i - 13) * 0.3 * (1.0 - e)).collect();
            stack.parts.push(Part { effect: format!("effect-number-{i}"), force_n });
        }
    }
    all
}

/// Names that look like markup but are text.
pub(crate) fn hostile() -> Comparison {
    let name = HOSTILE;
    let mut all = rich(&Recipe::hostile());
    name.clone_into(&mut all.muscle);
    name.clone_into(&mut all.base);
    all.data.files = vec![name.to_owned(), name.to_owned()];
    all.warnings.push(name.to_owned());
    name.clone_into(&mut all.quality[0].says);
    name.clone_into(&mut all.data.left_out[0].why);
    for rung in &mut all.ladder {
        name.clone_into(&mut rung.title);
        rung.added = rung.added.as_ref().map(|_| name.to_owned());
        for parameter in rung.fit.iter_mut().flat_map(|fit| &mut fit.parameters) {
            name.clone_into(&mut parameter.name);
            name.clone_into(&mut parameter.unit);
            parameter.low = f64::NEG_INFINITY;
            parameter.plausible_range[1] = f64::INFINITY;
        }
    }
    for part in all.contributions.iter_mut().flat_map(|stack| &mut stack.parts) {
        name.clone_into(&mut part.effect);
    }
    all
}
