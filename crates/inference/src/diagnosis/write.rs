//! Turns the findings of a search into a diagnosis for people and programs.

use bulge_effects::Effect;
use bulge_muscles::Muscle;
use std::collections::BTreeMap;
use std::sync::Arc;

use crate::comparison::document::Comparison;
use crate::comparison::row_by_row::Rows;
use crate::diagnosis::bending::may_bend;
use crate::diagnosis::claim::{Levels, form_error};
use crate::diagnosis::classes::{Class, Rival};
use crate::diagnosis::confidence::Confidence;
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::document::Located;
use crate::diagnosis::document::{
    CandidateResult, DiagnosedData, DiagnosedNoise, Diagnosis, ExplainedStep, LadderStep, Missing,
    NextExperiment, ParameterResult, Remaining, RivalResult, Verdict,
};
use crate::diagnosis::explained::{explained, surface};
use crate::diagnosis::geometry::Geometry;
use crate::diagnosis::hints::hints;
use crate::diagnosis::hypotheses::singles;
use crate::diagnosis::linearised_model::Context;
use crate::diagnosis::misfit::{located, misfit};
use crate::diagnosis::plan::SEEN;
use crate::diagnosis::rungs::{BentRung, TOGETHER, join_useless};
use crate::diagnosis::search::Search;
use crate::diagnosis::stage::Stage;
use crate::diagnosis::verdict::furthest;
use crate::fit::interval;
use crate::fit::problem::{FitProblem, free};
use crate::vector::{coarse, range, rms};
use bulge_numerics::least_squares::Side;

/// The family of hysteresis with a transition after each reversal; the next constant is the effect without
/// one.
const HYSTERESIS: &str = "presliding-hysteresis";
const COULOMB: &str = "coulomb-friction";
/// A transition shorter than this fraction of the stroke counts as none.
const SHORT: f64 = 0.025;

/// All findings.
pub(crate) struct Findings<'a> {
    pub(crate) context: &'a Context<'a>,
    pub(crate) search: &'a Search,
    pub(crate) classes: &'a [(Class, Confidence)],
    /// Standard deviation of a single row \[N\].
    pub(crate) sd_n: f64,
    pub(crate) effective_rows: f64,
    /// Number of effects of the base.
    pub(crate) known: usize,
    /// RMS misfit that doesn't matter \[N\].
    pub(crate) tolerance_n: Option<f64>,
    pub(crate) next: Option<NextExperiment>,
    /// Whether larger errors of the base's own formulas would explain as much as all effects that were found.
    pub(crate) all_may_be_form_error: bool,
    /// What is said of an event that no effect may be named across.
    pub(crate) event: Option<String>,
}

/// The diagnosis.
pub(crate) fn document(
    muscle: &Muscle,
    found: &Findings<'_>,
    (mut comparison, rows): (Comparison, Rows),
    bent: &[BentRung],
) -> Diagnosis {
    let Findings { context, search, classes, sd_n, .. } = *found;
    join_useless(&mut comparison.ladder, found.known);
    let (verdict, mut says, claimed) = found.verdict();
    if verdict == Verdict::CannotTell && found.event.is_none() && found.is_large() {
        says += &furthest(&comparison);
    }
    // If no effect is named, none is shown, and the remaining misfit is that of the base.
    let named = verdict.shows_effects();
    let classes = if named { classes } else { &[] };
    let last = found.shown_stage();
    let adequate = last.adequate && last.adequacy.unsmooth.is_none() || verdict == Verdict::Adequate;
    let (misfit_n, misfit_interval_n) = misfit(&last.linear, context.seed);
    let left = located(&last.linear);
    let added = classes.iter().map(|(class, sure)| found.missing(class, *sure));
    let (missing, nearest): (Vec<Missing>, Vec<Missing>) = added.partition(|m| claimed.contains(&m.fitted));
    Diagnosis {
        schema: "bulge.diagnosis/1",
        muscle: muscle.name().to_owned(),
        data: DiagnosedData::of(&comparison, found.effective_rows),
        noise: DiagnosedNoise {
            sd_n,
            correlated: !context.law.is_white(),
            source: context.law.source,
            law: context.law.clone(),
        },
        verdict,
        says,
        candidates: found.candidates(classes, &missing),
        missing,
        nearest,
        ladder: found.ladder(&comparison, bent, adequate && verdict != Verdict::CannotTell),
        noise_floor_n: sd_n,
        r#where: located(&search.stages[0].linear),
        explained: if named { found.explained() } else { Vec::new() },
        remaining: Remaining {
            structured: !adequate,
            misfit_n,
            misfit_interval_n,
            by_formulas: (named && !last.added.is_empty()).then(|| last.by_formulas(&search.stages[0])),
            unseen_below_n: if named { found.unseen_below_n() } else { None },
            hints: if adequate { Vec::new() } else { found.hints(&left) },
            jump: found.jump_left().filter(|_| !adequate).map(|(_, jump)| jump),
            event: found.event.clone(),
            surface: surface(context.record, &last.linear),
        },
        geometry: Geometry::default(),
        not_looked_for: Vec::new(),
        next_experiment: found.next.clone().filter(|_| named),
        warnings: comparison.warnings.clone(),
        comparison,
        rows: Some(rows),
    }
}

impl Findings<'_> {
    /// RMS change that a further effect needs to count beside the named ones; a smaller change could be an
    /// error of their formulas. The ratio of squares is `RULE.mends`.
    fn unseen_below_n(&self) -> Option<f64> {
        let last = self.last();
        let (explained_n, _) = misfit(&self.search.stages[0].linear, self.context.seed);
        (!last.added.is_empty() && may_bend(&last.confirmed.prepared))
            .then(|| RULE.mends.sqrt() * explained_n)
    }

    /// Each step of the search with the part of the misfit that it explained.
    fn explained(&self) -> Vec<ExplainedStep> {
        let step = |pair: &[Stage]| {
            let is_new = |effect: &&Arc<dyn Effect>| {
                pair[0].added.iter().all(|other| other.card().name != effect.card().name)
            };
            let names: Vec<String> =
                pair[1].added.iter().filter(is_new).map(|effect| self.label(effect)).collect();
            explained(&names.join(" + "), self.context.record, &pair[0].linear.force, &pair[1].linear.force)
        };
        self.search.stages.windows(2).map(step).collect()
    }

    /// The rungs of the base and of the added effects, then those with the fitted form errors.
    fn ladder(&self, comparison: &Comparison, bent: &[BentRung], adequate: bool) -> Vec<LadderStep> {
        let label = |name: &str| {
            let own = self.last().added.iter().find(|effect| effect.card().name == name);
            own.map_or_else(|| name.to_owned(), |effect| self.label(effect))
        };
        let rungs = comparison.ladder.iter().enumerate().skip(self.known);
        let formulas = rungs.map(|(i, rung)| LadderStep {
            added: (i > self.known).then(|| {
                rung.added
                    .iter()
                    .flat_map(|added| added.split(TOGETHER))
                    .map(label)
                    .collect::<Vec<_>>()
                    .join(TOGETHER)
            }),
            bent: false,
            rmse_n: rung.rmse_n,
            held_out_rmse_n: rung.held_out_rmse_n,
            adequate: false,
        });
        let bent = bent.iter().map(|rung| LadderStep {
            added: Some(rung.effects.iter().map(|name| label(name)).collect::<Vec<_>>().join(TOGETHER)),
            bent: true,
            rmse_n: rung.rmse_n,
            held_out_rmse_n: None,
            adequate: false,
        });
        let mut steps: Vec<LadderStep> = formulas.chain(bent).collect();
        // A stage is adequate with the form errors of its effects.
        if let Some(last) = steps.last_mut() {
            last.adequate = adequate;
        }
        steps
    }

    /// The name under which an effect is reported. Hysteresis with a transition much shorter than the stroke
    /// is practically Coulomb friction, since every real contact has a transition.
    pub(crate) fn label(&self, effect: &Arc<dyn Effect>) -> String {
        let card = effect.card();
        let confirmed = &self.last().confirmed;
        let distance = confirmed
            .prepared
            .model
            .parameters()
            .iter()
            .zip(&confirmed.theta)
            .find(|(p, _)| p.effect == card.name && p.name == "distance")
            .map(|(_, value)| *value);
        let stroke = |rows: &std::ops::Range<usize>| {
            let moments = &self.context.record.moments()[rows.clone()];
            let [low, high] = range(moments.iter().map(|m| m.contraction));
            high - low
        };
        let stroke = self.context.record.sweeps().iter().map(stroke).fold(0.0, f64::max);
        // At held length there is no such friction: friction of the length is no candidate then.
        let first = &self.search.stages[0].linear.sensitivities.effects;
        let is_candidate = first.iter().any(|sensitivity| sensitivity.effect.card().name == COULOMB);
        // Beside Coulomb friction, the effect represents the transition that it lacks.
        let has_coulomb = confirmed.prepared.model.effects().iter().any(|c| c.effect.card().name == COULOMB);
        let is_short = card.family == HYSTERESIS
            && is_candidate
            && !has_coulomb
            && distance.is_some_and(|d| d < SHORT * stroke);
        if is_short { COULOMB.to_owned() } else { card.name.to_owned() }
    }

    /// All effects that these data can't distinguish from this one, itself first: the head of its family, and
    /// the best of each other family. Then other members of its family.
    fn names(&self, class: &Class) -> (Vec<String>, Vec<String>) {
        let name = self.label(&class.effect);
        let own = class.effect.card().family;
        let mut names = vec![name.clone()];
        if name != own {
            names.push(own.to_owned());
        }
        let mut near: Vec<&Rival> = class.rivals.iter().filter(|rival| rival.in_class).collect();
        near.sort_by(|a, b| coarse(b.log_evidence).total_cmp(&coarse(a.log_evidence)));
        let mut forms = Vec::new();
        let mut families = vec![own];
        for rival in near {
            let card = rival.effect.card();
            if card.family == own {
                if card.name != class.effect.card().name && !names.iter().any(|name| name == card.name) {
                    forms.push(card.name.to_owned());
                }
            } else if !families.contains(&card.family) {
                families.push(card.family);
                // A name may stand there already: as that of the claim, under which another form was fitted.
                if !names.iter().any(|name| name == card.name) {
                    names.push(card.name.to_owned());
                }
            }
        }
        (names, forms)
    }

    /// The name in a claim, as specific as the data allow: an effect, or one of a class.
    pub(crate) fn claimed(&self, effect: &Arc<dyn Effect>) -> String {
        let label = self.label(effect);
        let is_it = |(class, _): &&(Class, Confidence)| class.effect.card().name == effect.card().name;
        let Some((class, sure)) = self.classes.iter().find(is_it) else { return label };
        let level = Levels::of(class, sure, self.classes.len()).decided();
        level.says(&label, class.effect.card().mechanism.name(), &self.names(class).0)
    }

    /// What the misfit that remains looks like; first what no smooth function follows, such as a jump.
    fn hints(&self, located: &[Located]) -> Vec<String> {
        let smooth = hints(self.context.record, &self.last().linear, located);
        self.unsmooth().map(|what| format!("it is {what}")).into_iter().chain(smooth).collect()
    }

    fn missing(&self, class: &Class, sure: Confidence) -> Missing {
        let card = class.effect.card();
        let fitted = card.name.to_owned();
        let (names, forms) = self.names(class);
        let levels = Levels::of(class, &sure, self.classes.len());
        let bent = &self.last().linear.form.effects;
        let bent = bent.iter().find(|bent| bent.effect.card().name == card.name);
        let label = self.label(&class.effect);
        // The form under whose name the claim stands is no rival of it.
        let others = class.rivals.iter().filter(|rival| rival.effect.card().name != label);
        let mut rivals: Vec<RivalResult> = others.map(|rival| rival_result(rival, class)).collect();
        rivals.sort_by(|a, b| coarse(a.behind).total_cmp(&coarse(b.behind)));
        Missing {
            effect: label,
            class: names,
            fitted,
            forms,
            family: card.family.to_owned(),
            mechanism: card.mechanism,
            form_error: bent.map(|bent| form_error(self.context.record, bent)),
            level: levels.decided(),
            confidence: levels.family,
            confidence_mechanism: levels.mechanism,
            confidence_form: levels.form,
            simulated: sure,
            parameters: self.parameters(&class.effect),
            plausible: self.plausible(class.effect.card().name),
            detectability: class.detectability,
            log_evidence: class.log_evidence,
            may_be_form_error: class.may_be_form_error,
            rivals,
        }
    }

    /// The parameters of an effect with 95 % intervals: from the covariance, or from the profile likelihood
    /// if the covariance can't be trusted.
    fn parameters(&self, effect: &Arc<dyn Effect>) -> BTreeMap<String, ParameterResult> {
        let last = self.last();
        let confirmed = &last.confirmed;
        let model = &confirmed.prepared.model;
        let priors = confirmed.prepared.nuisance_priors();
        let problem = FitProblem::whitened(
            model,
            self.context.record,
            self.context.whitening,
            confirmed.theta.clone(),
            &priors,
        );
        let scale = interval::Scale::known(last.scatter(), self.context.law.degrees_of_freedom);
        let mut found = BTreeMap::new();
        for (place, index) in free(model).into_iter().enumerate() {
            let p = &model.parameters()[index];
            if p.effect != effect.card().name {
                continue;
            }
            let value = confirmed.theta[index];
            let at_bound =
                matches!(confirmed.minimum.certificate.at_bound[place], Some(Side::Lower | Side::Upper));
            let determined = confirmed.minimum.certificate.is_determined(place);
            let found_interval =
                interval::of(&problem, &confirmed.minimum, place, &scale, at_bound || !determined);
            let name = p.specimen.as_ref().map_or_else(|| p.name.clone(), |s| format!("{}[{s}]", p.name));
            let [low, high] = found_interval.ends;
            let result = ParameterResult {
                value: p.shown(value),
                unit: p.unit.clone(),
                low: p.shown(low),
                high: p.shown(high),
            };
            found.insert(name, result);
        }
        found
    }

    pub(crate) fn plausible(&self, effect: &str) -> bool {
        self.is_within(effect, 0.0)
    }

    /// Whether the parameters of an effect are possible for it. The plausible range itself is only
    /// approximate.
    pub(crate) fn possible(&self, effect: &str) -> bool {
        self.is_within(effect, RULE.beyond)
    }

    /// Whether the parameters of an effect of the last model are plausible, or exceed the plausible range by
    /// no more than this fraction of it.
    fn is_within(&self, effect: &str, part: f64) -> bool {
        let confirmed = &self.last().confirmed;
        let numbers = confirmed.prepared.model.parameters().iter().zip(&confirmed.theta);
        numbers.filter(|(p, _)| p.effect == effect).all(|(p, value)| {
            let beyond = 1e-9 * (p.high - p.low) + part * (p.plausible.1 - p.plausible.0);
            (p.plausible.0 - beyond..=p.plausible.1 + beyond).contains(value)
        })
    }
}

fn rival_result(rival: &Rival, class: &Class) -> RivalResult {
    RivalResult {
        effect: rival.effect.card().name.to_owned(),
        behind: class.log_evidence - rival.log_evidence,
        separation: rival.separation,
    }
}

impl Findings<'_> {
    /// Every effect of the catalogue, tested on the base.
    fn candidates(&self, classes: &[(Class, Confidence)], claimed: &[Missing]) -> Vec<CandidateResult> {
        let stage = &self.search.stages[0];
        let linear = &stage.linear;
        let alone = singles(linear, &stage.confirmed.prepared.model);
        let given_muscle = stage.confirmed.prepared.model.muscle();
        let mut found: Vec<CandidateResult> = Vec::new();
        for (place, screened) in linear.sensitivities.effects.iter().enumerate() {
            let name = screened.effect.card().name;
            let alone = alone.iter().find(|h| h.effects == [place]);
            let tried = stage.tried.iter().find(|t| t.hypothesis.effects == [place]);
            let is_rival =
                |class: &Class| class.rivals.iter().any(|r| r.in_class && r.effect.card().name == name);
            let is_named = classes.iter().any(|(class, _)| self.label(&class.effect) == name);
            let status = if claimed.iter().any(|missing| missing.effect == name) {
                "confirmed"
            } else if is_named
                || classes.iter().any(|(class, _)| is_rival(class) || class.effect.card().name == name)
            {
                "rival"
            } else if screened.untestable.is_some() || alone.is_none() {
                "not-testable"
            } else if tried.is_some_and(|t| t.confirmed.as_ref().is_none_or(|c| !c.converged)) {
                "not-converged"
            } else {
                "rejected"
            };
            let candidate = linear.candidates.iter().find(|c| c.effect == place);
            let numbers = screened.effect.parameters();
            let number = candidate.and_then(|c| numbers.get(c.sizes.first()?.place));
            let per_size = candidate.map_or(0.0, |c| c.detectability(1.0));
            let limit = (per_size > 0.0).then(|| SEEN / per_size);
            // A limit beyond the bounds of the parameter means that these data can't show the effect.
            let limit = limit
                .filter(|l| number.is_none_or(|n| *l <= n.of(given_muscle).high - n.of(given_muscle).low));
            let column =
                candidate.and_then(|c| linear.sensitivities.sensitivities[c.sensitivity].columns.first());
            let rms = column.map(|c| rms(c));
            let fitted = tried.map(|t| t.log_evidence).filter(|evidence| evidence.is_finite());
            found.push(CandidateResult {
                effect: name.to_owned(),
                log_evidence: fitted.or(alone.map(|h| h.log_evidence)).unwrap_or(0.0),
                score: alone.map_or(0.0, |h| h.gain),
                status,
                // An effect that is either present or absent has no size.
                detection_limit: number
                    .filter(|_| candidate.is_some_and(|c| !c.whole))
                    .and_then(|n| Some(limit? / n.factor)),
                unit: number.map_or(String::new(), |n| n.unit.to_owned()),
                detection_limit_n: limit.zip(rms).map(|(limit, rms)| limit * rms),
                compensation: candidate.map_or(1.0, |c| c.compensated),
                why: screened.untestable.clone(),
            });
        }
        found.sort_by(|a, b| coarse(b.log_evidence).total_cmp(&coarse(a.log_evidence)));
        found
    }
}
