//! Diagnoses without an answer, which only state the reason.

use bulge_measurements::Data;
use bulge_muscles::{Muscle, Quantity};

use crate::comparison::compare::quality;
use crate::comparison::document::{Comparison, DataSummary};
use crate::comparison::loops::branches;
use crate::comparison::rows::full_scale;
use crate::diagnosis::document::{DiagnosedData, DiagnosedNoise, Diagnosis, Remaining, Verdict};
use crate::diagnosis::geometry::Geometry;
use crate::noise::law::{NoiseLaw, NoiseSource};
use crate::vector::range;

/// The data have too few rows for any statement.
pub(crate) fn cannot_tell(data: &Data, muscle: &Muscle, reason: &str) -> Diagnosis {
    let stated = muscle.instruments().force.map_or(0.0, |force| force.noise());
    let law = NoiseLaw::white(stated, NoiseSource::Instruments, 0.0, "not known from these rows".to_owned());
    let comparison = nothing_compared(data, muscle);
    Diagnosis {
        schema: "bulge.diagnosis/1",
        muscle: muscle.name().to_owned(),
        data: DiagnosedData::of(&comparison, data.len() as f64),
        noise: DiagnosedNoise { sd_n: stated, correlated: false, source: law.source, law },
        verdict: Verdict::CannotTell,
        says: format!(
            "these data can't tell: {reason}. Measure at least three pressures with 20 rows each, shortening and lengthening, with a column `time`"
        ),
        missing: Vec::new(),
        nearest: Vec::new(),
        candidates: Vec::new(),
        ladder: Vec::new(),
        noise_floor_n: stated,
        r#where: Vec::new(),
        explained: Vec::new(),
        remaining: Remaining::default(),
        geometry: Geometry::default(),
        not_looked_for: Vec::new(),
        next_experiment: None,
        warnings: Vec::new(),
        comparison,
        rows: None,
    }
}

/// The readings have another unit or sign than stated. No effect is looked for, and the question about the
/// unit or sign is the answer.
pub(crate) fn unanswered(data: &Data, muscle: &Muscle, comparison: Comparison) -> Diagnosis {
    let questions: Vec<String> = comparison.data.findings.iter().map(ToString::to_string).collect();
    let diagnosis = cannot_tell(data, muscle, "");
    Diagnosis {
        says: format!(
            "no physics is looked for in readings that seem to be others than stated: {}",
            questions.join("; or ")
        ),
        data: DiagnosedData {
            used: comparison.data.used,
            left_out: comparison.data.left_out.clone(),
            findings: comparison.data.findings.clone(),
            quality: comparison.quality.clone(),
            ..diagnosis.data
        },
        // Those of the fit of the base are of readings that are others.
        warnings: questions,
        comparison,
        ..diagnosis
    }
}

/// A summary of the data without any model.
fn nothing_compared(data: &Data, muscle: &Muscle) -> Comparison {
    let range = |values: &[f64]| range(values.iter().copied());
    let summary = DataSummary {
        rows: data.len(),
        used: data.len(),
        reading: data.reading().clone(),
        sha256: data.sha256(),
        files: data.files().iter().map(|file| file.name.clone()).collect(),
        sweeps: data.sweeps().len(),
        sweep_kinds: data.sweeps().iter().map(|sweep| sweep.kind).collect(),
        branches: branches(data),
        specimens: data.specimens().to_vec(),
        is_path: data.time().is_some(),
        pressure_pa: range(data.pressure()),
        contraction: range(&data.contraction(muscle.length().si())),
        force_n: range(data.force()),
        full_scale_n: full_scale(data.force(), 0..data.len()),
        ..DataSummary::default()
    };
    Comparison {
        schema: "bulge.comparison/1",
        muscle: muscle.name().to_owned(),
        base: "equilibrium".to_owned(),
        data: summary,
        quality: quality(data, muscle),
        ..Comparison::default()
    }
}
