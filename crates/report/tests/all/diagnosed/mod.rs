//! Simulated diagnoses, one of each verdict, around a comparison.

use bulge_effects::Mechanism;
use bulge_inference::{
    BentCurve, CandidateResult, Comparison, Confidence, CorrelationTime, CurveAt, DiagnosedData,
    DiagnosedNoise, Diagnosis, ExplainedCurve, ExplainedStep, FormErrorAt, FormErrorResult, Geometry,
    LadderStep, Level, Located, Missing, NextExperiment, NoiseLaw, NoiseSource, ParameterResult, Remaining,
    RivalResult, SurfaceCurve, Verdict,
};

/// Rubber and friction are missing, the second and third rungs of the comparison; rubber has another form
/// than its formula.
pub(crate) fn missing(mut comparison: Comparison) -> Diagnosis {
    comparison.ladder.truncate(3);
    Diagnosis {
        schema: "bulge.diagnosis/1",
        muscle: comparison.muscle.clone(),
        data: DiagnosedData::of(&comparison, 0.2 * comparison.data.used as f64),
        noise: noise(),
        verdict: Verdict::Missing,
        says: "Two things are missing.".to_owned(),
        missing: vec![bladder(), friction()],
        nearest: Vec::new(),
        candidates: candidates(),
        ladder: vec![
            step(None, 31.0, 33.0, false),
            step(Some("bladder-elasticity"), 12.0, 12.5, false),
            step(Some("coulomb-friction"), 4.4, 4.5, false),
            LadderStep {
                bent: true,
                held_out_rmse_n: None,
                ..step(Some("bladder-elasticity"), 4.2, 0.0, true)
            },
        ],
        noise_floor_n: 4.1,
        r#where: vec![
            located("direction", 0.71, 1e-5, "flips sign with direction"),
            located("time", 0.29, 0.4, "drifts"),
        ],
        explained: vec![explained("bladder-elasticity"), explained("coulomb-friction")],
        remaining: Remaining {
            structured: false,
            misfit_n: 0.4,
            misfit_interval_n: [0.0, 1.2],
            by_formulas: Some(0.95),
            unseen_below_n: Some(0.32),
            hints: vec!["grows with the pressure".to_owned()],
            jump: None,
            event: None,
            surface: surface(),
        },
        geometry: Geometry::default(),
        not_looked_for: Vec::new(),
        next_experiment: Some(NextExperiment {
            says: "Hold at 3 bar for an hour.".to_owned(),
            separates: vec!["bladder-elasticity".to_owned(), "wall-thickness".to_owned()],
            sigma: 4.9,
            repeats: 2,
            protocol: None,
        }),
        warnings: vec!["one warning".to_owned()],
        comparison,
        rows: None,
    }
}

/// Nothing is missing.
pub(crate) fn adequate(comparison: Comparison) -> Diagnosis {
    let mut diagnosis = missing(comparison);
    diagnosis.verdict = Verdict::Adequate;
    "Nothing stands out.".clone_into(&mut diagnosis.says);
    diagnosis.missing.clear();
    diagnosis.explained.clear();
    diagnosis.comparison.ladder.truncate(1);
    diagnosis.ladder = vec![step(None, 4.1, 4.2, true)];
    diagnosis.r#where.retain(|located| located.p > 0.05);
    diagnosis.next_experiment = None;
    for candidate in diagnosis.candidates.iter_mut().filter(|c| matches!(c.status, "confirmed" | "rival")) {
        candidate.status = "rejected";
        candidate.log_evidence = -2.5;
    }
    diagnosis
}

/// An unknown effect is missing.
pub(crate) fn unknown(comparison: Comparison) -> Diagnosis {
    let mut diagnosis = missing(comparison);
    diagnosis.verdict = Verdict::Unknown;
    "A step at 12 % is left.".clone_into(&mut diagnosis.says);
    diagnosis.missing.truncate(1);
    diagnosis.nearest = std::mem::take(&mut diagnosis.missing);
    diagnosis.remaining.structured = true;
    for step in &mut diagnosis.ladder {
        step.adequate = false;
    }
    diagnosis
}

/// The data are insufficient.
pub(crate) fn cannot_tell(comparison: Comparison) -> Diagnosis {
    let mut diagnosis = adequate(comparison);
    diagnosis.verdict = Verdict::CannotTell;
    "Twelve rows are too few.".clone_into(&mut diagnosis.says);
    for step in &mut diagnosis.ladder {
        step.adequate = false;
    }
    diagnosis.r#where.clear();
    diagnosis.remaining.surface.clear();
    diagnosis
}

fn noise() -> DiagnosedNoise {
    let says = "what a saturated model of 40 numbers leaves".to_owned();
    let mut law = NoiseLaw::white(3.9, NoiseSource::Saturated, 500.0, says);
    law.correlated_n = 1.0;
    law.time = Some(CorrelationTime::Seconds(5.0));
    DiagnosedNoise { sd_n: 4.1, correlated: true, source: law.source, law }
}

fn number(value: f64, unit: &str, low: f64, high: f64) -> ParameterResult {
    ParameterResult { value, unit: unit.to_owned(), low, high }
}

fn rival(effect: &str, behind: f64, separation: f64) -> RivalResult {
    RivalResult { effect: effect.to_owned(), behind, separation }
}

fn bladder() -> Missing {
    Missing {
        effect: "bladder-elasticity".to_owned(),
        fitted: "bladder-elasticity".to_owned(),
        forms: vec!["bladder-c01".to_owned()],
        class: ["bladder-elasticity", "wall-thickness"].map(str::to_owned).to_vec(),
        family: "bladder-elasticity".to_owned(),
        mechanism: Mechanism::Rubber,
        form_error: Some(bent()),
        level: Level::Form,
        confidence: 0.97,
        confidence_mechanism: 0.98,
        confidence_form: 0.9,
        simulated: Confidence { named: 0.97, class: 0.99, interval: [0.95, 0.98], claims: 400 },
        parameters: [("modulus".to_owned(), number(0.31, "MPa", 0.28, 0.33))].into(),
        plausible: true,
        detectability: 9.3,
        log_evidence: 40.0,
        may_be_form_error: false,
        // Not sorted.
        rivals: vec![rival("hoop-elasticity", 25.0, 7.5), rival("wall-thickness", 0.8, 1.2)],
    }
}

fn bent() -> FormErrorResult {
    let at = FormErrorAt {
        pressure_pa: 2e5,
        contraction: 0.2,
        direction: 1.0,
        formula_n: 40.0,
        bending_n: -4.0,
        sd_n: 0.5,
    };
    let curve = BentCurve {
        at: CurveAt { pressure_pa: 2e5, direction: 1.0, contraction: vec![0.1, 0.2] },
        formula_n: vec![20.0, 40.0],
        bent_n: vec![20.5, 36.0],
        sd_n: vec![0.3, 0.5],
    };
    FormErrorResult { share: 0.08, rms_n: 2.3, r#where: Some(at), curves: vec![curve] }
}

fn friction() -> Missing {
    Missing {
        effect: "coulomb-friction".to_owned(),
        fitted: "bouc-wen".to_owned(),
        forms: Vec::new(),
        class: vec!["coulomb-friction".to_owned()],
        family: "coulomb-friction".to_owned(),
        mechanism: Mechanism::DryFriction,
        form_error: Some(FormErrorResult { share: 0.0, rms_n: 0.0, r#where: None, curves: Vec::new() }),
        level: Level::Form,
        confidence: 0.999,
        confidence_mechanism: 0.999,
        confidence_form: 0.9,
        simulated: Confidence { named: 0.999, class: 1.0, interval: [0.0, 1.0], claims: 0 },
        parameters: [("friction".to_owned(), number(14.0, "N", 8.0, 20.0))].into(),
        plausible: false,
        detectability: 40.0,
        log_evidence: 800.0,
        may_be_form_error: false,
        rivals: vec![rival("force-lag", 300.0, 32.0)],
    }
}

fn candidate(
    effect: &str,
    log_evidence: f64,
    status: &'static str,
    limit: f64,
    unit: &str,
) -> CandidateResult {
    CandidateResult {
        effect: effect.to_owned(),
        log_evidence,
        score: 2.0 * log_evidence.max(0.0),
        status,
        detection_limit: Some(limit),
        unit: unit.to_owned(),
        detection_limit_n: Some(0.5),
        compensation: 0.3,
        why: None,
    }
}

fn candidates() -> Vec<CandidateResult> {
    let mut failed = candidate("bouc-wen", f64::NEG_INFINITY, "not-converged", 0.1, "N");
    failed.detection_limit = None;
    let mut slip = candidate("end-slip", -60.0, "rejected", 0.05, "um/N");
    slip.detection_limit_n = None;
    let mut untested = candidate("temperature", 0.0, "not-testable", 1.0, "1/K");
    (untested.detection_limit, untested.detection_limit_n) = (None, None);
    untested.why = Some("needs a column `temperature` that changes".to_owned());
    vec![
        candidate("coulomb-friction", 310.0, "confirmed", 0.2, "N"),
        candidate("bladder-elasticity", 90.2, "confirmed", 0.0014, "MPa"),
        candidate("wall-thickness", 89.4, "rival", 0.0123, "mm"),
        candidate("creep", -3.8, "rejected", 0.22, "N/decade"),
        slip,
        failed,
        untested,
    ]
}

fn step(added: Option<&str>, rmse_n: f64, held_out: f64, adequate: bool) -> LadderStep {
    let added = added.map(str::to_owned);
    LadderStep { added, bent: false, rmse_n, held_out_rmse_n: Some(held_out), adequate }
}

fn located(variable: &str, share: f64, p: f64, says: &str) -> Located {
    Located { variable: variable.to_owned(), share, p, says: says.to_owned() }
}

/// Half of a misfit of 2 N is explained at each of five pressures.
fn explained(effect: &str) -> ExplainedStep {
    let curve = |at: CurveAt| ExplainedCurve {
        before_n: vec![2.0 * at.direction; 3],
        explained_n: vec![at.direction; 3],
        at,
    };
    ExplainedStep { effect: effect.to_owned(), curves: grid().map(curve).collect() }
}

fn surface() -> Vec<SurfaceCurve> {
    let curve =
        |at: CurveAt| SurfaceCurve { misfit_n: vec![0.5, -0.5, 0.25 * at.direction], sd_n: vec![0.4; 3], at };
    grid().map(curve).collect()
}

fn grid() -> impl Iterator<Item = CurveAt> {
    let at = |bar: i32, direction| CurveAt {
        pressure_pa: 1e5 * f64::from(bar),
        direction,
        contraction: vec![0.02, 0.1, 0.2],
    };
    (1..=5).flat_map(move |bar| [1.0, -1.0].map(|direction| at(bar, direction)))
}
