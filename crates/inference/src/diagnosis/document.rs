//! A diagnosis as a value: everything that text, JSON and report show.

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
use crate::noise::law::NoiseLaw;
use crate::protocol::bench::Protocol;

/// What is missing in the model of a muscle, by the data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnosis {
    /// `bulge.diagnosis/1`.
    pub schema: &'static str,
    /// Name of the muscle.
    pub muscle: String,
    /// What was measured.
    pub data: DiagnosedData,
    /// The noise, found first and then frozen.
    pub noise: DiagnosedNoise,
    /// The verdict.
    pub verdict: Verdict,
    /// The verdict in a sentence or two.
    pub says: String,
    /// Effects that are missing, in the order of adding.
    pub missing: Vec<Missing>,
    /// Effects that lower the error and are no claim: where the verdict is *unknown*, where something remains and their numbers are implausible, where what is left
    /// without them is within the tolerance, and where the data don't say what a further effect is.
    pub nearest: Vec<Missing>,
    /// All effects that were looked at.
    pub candidates: Vec<CandidateResult>,
    /// Errors from the base to the last effect by its formula, then those of the effects as the data want them.
    pub ladder: Vec<LadderStep>,
    /// The error that no model can go below \[N\].
    pub noise_floor_n: f64,
    /// On what the misfit of the base depends.
    pub r#where: Vec<Located>,
    /// What each added effect explains of the misfit before it: curves to plot.
    pub explained: Vec<ExplainedStep>,
    /// What is left.
    pub remaining: Remaining,
    /// The geometry that the diagnosis rests on, and how doubtful it is.
    pub geometry: Geometry,
    /// Effects that could not be looked for in these data, and could be the answer.
    pub not_looked_for: Vec<NotLookedFor>,
    /// What to measure next, if that would decide something.
    pub next_experiment: Option<NextExperiment>,
    /// What a reader should know before trusting the verdict.
    pub warnings: Vec<String>,
    /// The comparison with the effects that were found, for curves and plots; its ladder is empty where there were too few rows.
    #[serde(skip)]
    pub comparison: Comparison,
    /// Its rows, with the force of each rung; none where there were too few.
    #[serde(skip)]
    pub rows: Option<Rows>,
}

impl Diagnosis {
    /// The effects that were added: those that are missing, then those of which nothing is claimed.
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
    /// Whether effects are shown beside it, as claims or as the nearest.
    pub(crate) const fn shows_effects(self) -> bool {
        matches!(self, Self::Missing | Self::Unknown)
    }
}

/// What was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiagnosedData {
    /// Rows in the files.
    pub rows: usize,
    /// Rows that count.
    pub used: usize,
    /// Rows that count as independent, under the noise law.
    pub effective_rows: f64,
    /// What the columns were taken for, and the rows that can't be used.
    #[serde(flatten)]
    pub reading: Reading,
    /// SHA-256 of the file, or of the digests of several.
    pub sha256: String,
    /// Number of sweeps.
    pub sweeps: usize,
    /// Number of specimens.
    pub specimens: usize,
    /// Rows that don't count, and why.
    pub left_out: Vec<LeftOut>,
    /// Units, signs and scales that can't be true, with the evidence.
    pub findings: Vec<Mismatch>,
    /// What the data check found: spikes, readings that are clipped, frozen, there twice, or shifted.
    pub quality: Vec<Finding>,
}

/// The noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiagnosedNoise {
    /// Standard deviation of a single row \[N\].
    pub sd_n: f64,
    /// Whether rows of a sweep depend on each other.
    pub correlated: bool,
    /// `repeats`, `saturated` or `instruments`.
    pub source: String,
    /// The law.
    pub law: NoiseLaw,
}

/// How far the data decide what an effect is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Level {
    /// This very effect.
    Form,
    /// Its family; other forms of it would do.
    Family,
    /// Its mechanism; other families of it would do.
    Mechanism,
    /// No more than that it is one of its class.
    Class,
}

impl Level {
    /// An effect as far as it is decided: `coulomb-friction`, `dry friction, likeliest coulomb-friction`, `one of fibre-stretch, end-slip`.
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
    /// The effect whose numbers these are, as `--with` takes it. It is `effect`, but for friction that was fitted with a transition too short to matter.
    pub fitted: String,
    /// The family of which it is a member.
    pub family: String,
    /// The mechanism, in the words of [`bulge_effects::Mechanism`].
    pub mechanism: Mechanism,
    /// All effects that these data can't tell from it, itself first: the head of its family, and of each other family the best.
    pub class: Vec<String>,
    /// Others of its own family that these data can't tell from it: forms of one mechanism.
    pub forms: Vec<String>,
    /// How much the data bend its formula; none where the formula is exact.
    pub form_error: Option<FormErrorResult>,
    /// The deepest level at which the claim is likelier right than wrong.
    pub level: Level,
    /// How often such a claim names the right family on data like these.
    pub confidence: f64,
    /// How often it names the right mechanism.
    pub confidence_mechanism: f64,
    /// How often it names the right form, which is this very effect.
    pub confidence_form: f64,
    /// The same with its interval, and how often the class holds the right one.
    pub simulated: Confidence,
    /// Its numbers with 95 % intervals.
    pub parameters: BTreeMap<String, ParameterResult>,
    /// Whether a muscle or rig can have these numbers.
    pub plausible: bool,
    /// Its length in sigmas, beside everything else that could explain it.
    pub detectability: f64,
    /// Log evidence over the model without it, natural logarithm.
    pub log_evidence: f64,
    /// Rivals, with how far they are.
    pub rivals: Vec<RivalResult>,
}

impl Missing {
    /// What is claimed, as far as the data decide it: `coulomb-friction`, `dry friction, likeliest coulomb-friction`, `one of fibre-stretch, end-slip`.
    #[must_use]
    pub fn claim(&self) -> String {
        self.level.says(&self.effect, self.mechanism.name(), &self.class)
    }

    /// Whether the data don't even say its mechanism, or it hardly leads a model without it: beside other effects it is no claim.
    #[must_use]
    pub fn is_doubtful(&self) -> bool {
        self.confidence_mechanism < RULE.decides || self.log_evidence < RULE.seen
    }
}

/// How much the data bend the formula of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FormErrorResult {
    /// Part of the effect by which it is bent, in units of the noise; 0 where the formula holds.
    pub share: f64,
    /// RMS of what is added to the formula \[N\].
    pub rms_n: f64,
    /// Where that is largest; none where the formula holds.
    pub r#where: Option<FormErrorAt>,
    /// The effect by its formula, and as the data want it: curves to plot; none where the formula holds.
    pub curves: Vec<BentCurve>,
}

/// The place of the largest form error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FormErrorAt {
    /// Pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contraction.
    pub contraction: f64,
    /// +1 shortening, -1 lengthening, 0 at rest.
    pub direction: f64,
    /// What the effect changes there by its formula \[N\].
    pub formula_n: f64,
    /// What the data add to that \[N\].
    pub bending_n: f64,
    /// Its standard deviation \[N\].
    pub sd_n: f64,
}

/// An effect over contraction, at one pressure and in one direction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BentCurve {
    /// Mean pressure of the level \[Pa\].
    pub pressure_pa: f64,
    /// +1 shortening, -1 lengthening, 0 at rest.
    pub direction: f64,
    /// Bin centres.
    pub contraction: Vec<f64>,
    /// What the effect changes by its formula \[N\].
    pub formula_n: Vec<f64>,
    /// What it changes as the data want it \[N\].
    pub bent_n: Vec<f64>,
    /// Standard deviation of that \[N\], with that of the numbers of the effect.
    pub sd_n: Vec<f64>,
}

/// A number of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterResult {
    /// Value in `unit`.
    pub value: f64,
    /// The unit.
    pub unit: String,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// An effect beside a named one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RivalResult {
    /// Its name.
    pub effect: String,
    /// Log evidence of the named effect over it.
    pub behind: f64,
    /// Sigmas between the two.
    pub separation: f64,
}

/// One effect of the catalogue.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CandidateResult {
    /// Its name.
    pub effect: String,
    /// Log evidence over the base, prior chance included.
    pub log_evidence: f64,
    /// Square of sigmas that it explains alone.
    pub score: f64,
    /// `confirmed`, `rival`, `rejected`, `not-converged` or `not-testable`.
    pub status: &'static str,
    /// Least deviation of its first number that these data would show, in `unit`.
    pub detection_limit: Option<f64>,
    /// The unit of the limit.
    pub unit: String,
    /// RMS change of the force at that limit \[N\].
    pub detection_limit_n: Option<f64>,
    /// Part of the effect that the model's own numbers can compensate.
    pub compensation: f64,
    /// Why it could not be looked for, if so.
    pub why: Option<String>,
}

/// One rung of the ladder.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LadderStep {
    /// The effect added, or bent; none for the base.
    pub added: Option<String>,
    /// Whether the effect has the form that the data want, in the place of its formula, on this rung and on those after it.
    pub bent: bool,
    /// RMS error \[N\].
    pub rmse_n: f64,
    /// RMS error on what took no part in the fit \[N\]; none of a bent effect.
    pub held_out_rmse_n: Option<f64>,
    /// Whether the data show no structure beyond.
    pub adequate: bool,
}

impl LadderStep {
    /// Names of the effects that are added or bent: several where only together they lower the error.
    pub fn effects(&self) -> impl Iterator<Item = &str> {
        self.added.iter().flat_map(|added| added.split(TOGETHER))
    }
}

/// A variable on which a misfit depends.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Located {
    /// `mean`, `contraction`, `pressure`, `direction`, `time`, `rate`, `temperature`, `cycle`, `specimen`.
    pub variable: String,
    /// Part of the misfit.
    pub share: f64,
    /// How often chance alone gives as much, Holm's correction included.
    pub p: f64,
    /// In words.
    pub says: String,
}

/// What is left.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Remaining {
    /// Whether there is structure beyond chance.
    pub structured: bool,
    /// RMS systematic misfit \[N\].
    pub misfit_n: f64,
    /// Its 95 % interval \[N\].
    pub misfit_interval_n: [f64; 2],
    /// Part of the base's misfit that the formulas of the effects that are shown explain as they are, not bent (as squares); none where no effect is shown.
    pub by_formulas: Option<f64>,
    /// A further effect that changes less than this is not told from an error of the formulas that are named (RMS) \[N\]; none where those are exact.
    pub unseen_below_n: Option<f64>,
    /// What it looks like, in words.
    pub hints: Vec<String>,
    /// The systematic misfit over pressure, contraction and direction, where there is structure.
    pub surface: Vec<SurfaceCurve>,
}

/// What an effect explains, when it is added.
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
    /// Mean pressure of the level \[Pa\].
    pub pressure_pa: f64,
    /// +1 shortening, -1 lengthening, 0 at rest.
    pub direction: f64,
    /// Bin centres.
    pub contraction: Vec<f64>,
    /// Mean misfit of the model before the effect was added, measured - model \[N\].
    pub before_n: Vec<f64>,
    /// What the effect (and the refit of all numbers) changes \[N\].
    pub explained_n: Vec<f64>,
}

/// Systematic misfit over contraction, at one pressure and in one direction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SurfaceCurve {
    /// Mean pressure of the level \[Pa\].
    pub pressure_pa: f64,
    /// +1 shortening, -1 lengthening, 0 at rest.
    pub direction: f64,
    /// Bin centres.
    pub contraction: Vec<f64>,
    /// Misfit, smoothed \[N\].
    pub misfit_n: Vec<f64>,
    /// Its standard deviation \[N\].
    pub sd_n: Vec<f64>,
}

/// What to measure next.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextExperiment {
    /// In words.
    pub says: String,
    /// Effects that it separates.
    pub separates: Vec<String>,
    /// By how many sigmas.
    pub sigma: f64,
    /// How often to repeat it.
    pub repeats: usize,
    /// The test once, with the noise of the data at hand; none if no test within the limits tells them apart.
    pub protocol: Option<Box<Protocol>>,
}
