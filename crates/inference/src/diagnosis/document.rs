//! The result of a diagnosis: everything that text, JSON and report show.

use bulge_effects::Mechanism;
use bulge_measurements::{Finding, Reading};
use serde::Serialize;
use std::collections::BTreeMap;

use crate::comparison::document::{Comparison, LeftOut, Mismatch};
use crate::comparison::row_by_row::Rows;
use crate::diagnosis::confidence::Confidence;
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::geometry::Geometry;
use crate::diagnosis::not_looked_for::NotLookedFor;
use crate::diagnosis::rungs::TOGETHER;
use crate::noise::law::{NoiseLaw, NoiseSource};
use crate::protocol::bench::Protocol;

/// The effects that are missing in the model of a muscle, according to the data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Name and version of the document: `bulge.diagnosis/1`.
    pub schema: &'static str,
    /// Name of the muscle.
    pub muscle: String,
    /// Summary of the data.
    pub data: DiagnosedData,
    /// The noise, estimated first and then kept fixed.
    pub noise: DiagnosedNoise,
    /// The verdict.
    pub verdict: Verdict,
    /// The verdict in a sentence or two.
    pub says: String,
    /// Missing effects, in the order in which they were added.
    pub missing: Vec<Missing>,
    /// Effects that lower the error but are not claimed: if the verdict is *unknown*, if something remains
    /// and their parameters are implausible, if the misfit without them is within the tolerance, or if the
    /// data don't say what a further effect is.
    pub nearest: Vec<Missing>,
    /// All effects that were tested.
    pub candidates: Vec<CandidateResult>,
    /// Errors from the base to the last effect by its formula, followed by those with the fitted form errors
    /// of the effects.
    pub ladder: Vec<LadderStep>,
    /// The error that no model can go below \[N\].
    pub noise_floor_n: f64,
    /// Variables on which the misfit of the base depends.
    pub r#where: Vec<Located>,
    /// The part of the misfit that each added effect explains: curves to plot.
    pub explained: Vec<ExplainedStep>,
    /// The remaining misfit.
    pub remaining: Remaining,
    /// The geometry behind the diagnosis, and its uncertainty.
    pub geometry: Geometry,
    /// Effects that could not be tested on these data but may be missing.
    pub not_looked_for: Vec<NotLookedFor>,
    /// The next measurement, if one would decide something.
    pub next_experiment: Option<NextExperiment>,
    /// What a reader should know before trusting the verdict.
    pub warnings: Vec<String>,
    /// The comparison with the effects that were found, for curves and plots; its ladder is empty if there
    /// were too few rows.
    #[serde(skip)]
    pub comparison: Comparison,
    /// Its rows, with the force of each rung; none if there were too few.
    #[serde(skip)]
    pub rows: Option<Rows>,
}

impl Diagnosis {
    /// All effects that were added: the missing ones, then those that are not claimed.
    pub fn added(&self) -> impl Iterator<Item = &Missing> {
        self.missing.iter().chain(&self.nearest)
    }
}

/// The four verdicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The base model explains the data within noise and tolerance.
    Adequate,
    /// Named effects are missing.
    Missing,
    /// There is a structure that no effect of the catalogue explains.
    Unknown,
    /// The data are too few or too noisy.
    CannotTell,
}

impl Verdict {
    /// Whether effects are shown with this verdict, as claims or as the nearest ones.
    pub(crate) const fn shows_effects(self) -> bool {
        matches!(self, Self::Missing | Self::Unknown)
    }
}

/// Summary of the data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiagnosedData {
    /// Rows in the files.
    pub rows: usize,
    /// Rows that count.
    pub used: usize,
    /// Effective number of independent rows under the noise law.
    pub effective_rows: f64,
    /// How the columns were interpreted, and the rows that can't be used.
    #[serde(flatten)]
    pub reading: Reading,
    /// SHA-256 of the file, or of the digests of several files.
    pub sha256: String,
    /// Number of sweeps.
    pub sweeps: usize,
    /// Number of specimens.
    pub specimens: usize,
    /// Rows that don't count, with the reasons.
    pub left_out: Vec<LeftOut>,
    /// Units, signs and scales that are impossible, with the evidence.
    pub findings: Vec<Mismatch>,
    /// Findings of the data check: spikes; readings that are clipped, frozen, duplicated or shifted.
    pub quality: Vec<Finding>,
}

impl DiagnosedData {
    /// The data of a comparison.
    #[must_use]
    pub fn of(comparison: &Comparison, effective_rows: f64) -> Self {
        let data = &comparison.data;
        Self {
            rows: data.rows,
            used: data.used,
            effective_rows,
            reading: data.reading.clone(),
            sha256: data.sha256.clone(),
            sweeps: data.sweeps,
            specimens: data.specimens.len(),
            left_out: data.left_out.clone(),
            findings: data.findings.clone(),
            quality: comparison.quality.clone(),
        }
    }
}

/// The noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiagnosedNoise {
    /// Standard deviation of a single row \[N\].
    pub sd_n: f64,
    /// Whether the rows of a sweep are correlated.
    pub correlated: bool,
    /// Origin.
    pub source: NoiseSource,
    /// The law.
    pub law: NoiseLaw,
}

/// How specifically the data determine an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Level {
    /// This very effect.
    Form,
    /// Its family; other forms of the family would do as well.
    Family,
    /// Its mechanism; other families of the mechanism would do as well.
    Mechanism,
    /// Only that it is one of its class.
    Class,
}

impl Level {
    /// The name of an effect at this level: `coulomb-friction`, `dry friction, likeliest coulomb-friction`,
    /// `one of fibre-stretch, end-slip`.
    pub(crate) fn says(self, effect: &str, mechanism: &str, class: &[String]) -> String {
        match self {
            Self::Form | Self::Family => effect.to_owned(),
            Self::Class if class.len() > 1 => format!("one of {}", class.join(", ")),
            Self::Mechanism | Self::Class => format!("{mechanism}, likeliest {effect}"),
        }
    }
}

/// An effect that is missing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Missing {
    /// Its name.
    pub effect: String,
    /// The fitted effect, as `--with` takes it. It equals `effect`, except for friction that was fitted with
    /// a transition too short to matter.
    pub fitted: String,
    /// The family that it belongs to.
    pub family: String,
    /// The mechanism, in the words of [`bulge_effects::Mechanism`].
    pub mechanism: Mechanism,
    /// All effects that these data can't distinguish from it, itself first: the head of its family, and the
    /// best of each other family.
    pub class: Vec<String>,
    /// Other members of its family that these data can't distinguish from it: forms of one mechanism.
    pub forms: Vec<String>,
    /// Fitted form error; none if the formula is exact.
    pub form_error: Option<FormErrorResult>,
    /// The most specific level at which the claim is more likely right than wrong.
    pub level: Level,
    /// Probability that such a claim names the right family on data like these.
    pub confidence: f64,
    /// Probability that it names the right mechanism.
    pub confidence_mechanism: f64,
    /// Probability that it names the right form, which is this very effect.
    pub confidence_form: f64,
    /// Simulated confidence with its interval, and the probability that the class contains the right effect.
    pub simulated: Confidence,
    /// Its parameters with 95 % intervals.
    pub parameters: BTreeMap<String, ParameterResult>,
    /// Whether a muscle or rig can have these parameters.
    pub plausible: bool,
    /// Its length in sigmas, beside everything else that could explain it.
    pub detectability: f64,
    /// Log evidence over the model without it, natural logarithm.
    pub log_evidence: f64,
    /// Whether larger errors of the other effects' formulas would explain as much.
    pub may_be_form_error: bool,
    /// Rivals, with their distance.
    pub rivals: Vec<RivalResult>,
}

impl Missing {
    /// The claim, as specific as the data allow: `coulomb-friction`, `dry friction, likeliest
    /// coulomb-friction`, `one of fibre-stretch, end-slip`.
    #[must_use]
    pub fn claim(&self) -> String {
        self.level.says(&self.effect, self.mechanism.name(), &self.class)
    }

    /// Whether even its mechanism is uncertain, or the evidence over a model without it is small, or larger errors
    /// of other formulas would explain as much. Beside other effects it is then not claimed.
    #[must_use]
    pub fn is_doubtful(&self) -> bool {
        self.confidence_mechanism < RULE.decides || self.log_evidence < RULE.seen || self.may_be_form_error
    }
}

/// Fitted form error of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FormErrorResult {
    /// Size relative to the effect, in units of the noise; 0 if the formula holds.
    pub share: f64,
    /// RMS of the form error \[N\].
    pub rms_n: f64,
    /// Location of its maximum; none if the formula holds.
    pub r#where: Option<FormErrorAt>,
    /// The effect by its formula, and with its form error: curves to plot; none if the formula holds.
    pub curves: Vec<BentCurve>,
}

/// The location of the largest form error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FormErrorAt {
    /// Pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contraction.
    pub contraction: f64,
    /// +1 shortening, -1 lengthening, 0 at rest.
    pub direction: f64,
    /// Change of the force by the effect's formula there \[N\].
    pub formula_n: f64,
    /// Form error there \[N\].
    pub bending_n: f64,
    /// Standard deviation of the form error \[N\].
    pub sd_n: f64,
}

/// Place of a curve over contraction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CurveAt {
    /// Mean pressure of the level \[Pa\].
    pub pressure_pa: f64,
    /// +1 shortening, -1 lengthening, 0 at rest.
    pub direction: f64,
    /// Bin centres.
    pub contraction: Vec<f64>,
}

/// An effect over contraction, at one pressure and in one direction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BentCurve {
    /// Where it lies.
    #[serde(flatten)]
    pub at: CurveAt,
    /// Change of the force by the effect's formula \[N\].
    pub formula_n: Vec<f64>,
    /// Change of the force with the form error \[N\].
    pub bent_n: Vec<f64>,
    /// Standard deviation of the latter \[N\], including that of the effect's parameters.
    pub sd_n: Vec<f64>,
}

/// A parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterResult {
    /// Value in `unit`.
    pub value: f64,
    /// Unit of the values.
    pub unit: String,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// A rival of a named effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RivalResult {
    /// Its name.
    pub effect: String,
    /// Log evidence of the named effect over this one, and what this one loses by being bent more.
    pub behind: f64,
    /// Sigmas between the two effects.
    pub separation: f64,
}

/// One effect of the catalogue.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CandidateResult {
    /// Its name.
    pub effect: String,
    /// Log evidence over the base, including the prior.
    pub log_evidence: f64,
    /// Squared sigmas that it explains alone.
    pub score: f64,
    /// `confirmed`, `rival`, `rejected`, `not-converged` or `not-testable`.
    pub status: &'static str,
    /// Smallest detectable deviation of its first parameter, in `unit`.
    pub detection_limit: Option<f64>,
    /// The unit of the limit.
    pub unit: String,
    /// RMS change of the force at that limit \[N\].
    pub detection_limit_n: Option<f64>,
    /// Fraction of the effect that the model's own parameters can compensate.
    pub compensation: f64,
    /// Why it could not be tested, if so.
    pub why: Option<String>,
}

/// One rung of the ladder.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LadderStep {
    /// The effect that is added, or gets its form error; none for the base.
    pub added: Option<String>,
    /// Whether the effect has its fitted form error, from this rung on, instead of its plain formula.
    pub bent: bool,
    /// RMS error \[N\].
    pub rmse_n: f64,
    /// RMS error on held-out data \[N\]; none for an effect with a form error.
    pub held_out_rmse_n: Option<f64>,
    /// Whether the data show no further structure.
    pub adequate: bool,
}

impl LadderStep {
    /// Names of the effects that are added or get a form error; several if they lower the error only
    /// together.
    pub fn effects(&self) -> impl Iterator<Item = &str> {
        self.added.iter().flat_map(|added| added.split(TOGETHER))
    }
}

/// A variable on which a misfit depends.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Located {
    /// `mean`, `contraction`, `pressure`, `direction`, `time`, `rate`, `temperature`, `cycle`, `specimen`.
    pub variable: String,
    /// Fraction of the misfit.
    pub share: f64,
    /// p-value, including Holm's correction.
    pub p: f64,
    /// In words.
    pub says: String,
}

/// The remaining misfit.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Remaining {
    /// Whether there is structure beyond chance.
    pub structured: bool,
    /// RMS systematic misfit \[N\].
    pub misfit_n: f64,
    /// Its 95 % interval \[N\].
    pub misfit_interval_n: [f64; 2],
    /// Fraction of the base's squared misfit that the formulas of the shown effects explain, without form
    /// errors; none if no effect is shown.
    pub by_formulas: Option<f64>,
    /// RMS change below which a further effect can't be distinguished from an error of the named formulas
    /// \[N\]; none if those are exact.
    pub unseen_below_n: Option<f64>,
    /// Description of the misfit, in words.
    pub hints: Vec<String>,
    /// A jump within a sweep, with its size and place in words: something happened there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jump: Option<String>,
    /// What happened during the test, in words: no effect is named across it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub event: Option<String>,
    /// The systematic misfit over pressure, contraction and direction, if there is structure.
    pub surface: Vec<SurfaceCurve>,
}

/// The part of the misfit that an effect explains when it is added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExplainedStep {
    /// The effect.
    pub effect: String,
    /// One curve for each pressure level and direction.
    pub curves: Vec<ExplainedCurve>,
}

/// Misfit over contraction, at one pressure and in one direction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExplainedCurve {
    /// Where it lies.
    #[serde(flatten)]
    pub at: CurveAt,
    /// Mean misfit of the model before the effect was added, measured - model \[N\].
    pub before_n: Vec<f64>,
    /// Change by the effect and by refitting all parameters \[N\].
    pub explained_n: Vec<f64>,
}

/// Systematic misfit over contraction, at one pressure and in one direction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SurfaceCurve {
    /// Where it lies.
    #[serde(flatten)]
    pub at: CurveAt,
    /// Misfit, smoothed \[N\].
    pub misfit_n: Vec<f64>,
    /// Its standard deviation \[N\].
    pub sd_n: Vec<f64>,
}

/// The next measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextExperiment {
    /// In words.
    pub says: String,
    /// Effects that it separates.
    pub separates: Vec<String>,
    /// Sigmas by which it separates them.
    pub sigma: f64,
    /// Number of repeats.
    pub repeats: usize,
    /// One pass of the test, with the noise of the data at hand; none if no test within the limits separates
    /// them.
    pub protocol: Option<Box<Protocol>>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_of_the_ladder_knows_all_its_effects() {
        let step = |added: Option<&str>| LadderStep {
            added: added.map(str::to_owned),
            bent: false,
            rmse_n: 1.0,
            held_out_rmse_n: None,
            adequate: false,
        };
        let names = |added| step(added).effects().map(str::to_owned).collect::<Vec<_>>();
        assert!(names(None).is_empty());
        assert_eq!(names(Some("creep")), ["creep"]);
        assert_eq!(names(Some(&format!("creep{TOGETHER}end-slip"))), ["creep", "end-slip"]);
    }
}
