//! The verdict on the result of a search. A tolerance is applied last and can only withdraw claims.

use bulge_effects::Effect;
use bulge_muscles::units::significant;
use std::sync::Arc;

use crate::comparison::document::{Bin, Comparison};
use crate::comparison::rows::full_scale;
use crate::diagnosis::bending::may_bend;
use crate::diagnosis::claim::Levels;
use crate::diagnosis::classes::Class;
use crate::diagnosis::confidence::Confidence;
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::document::Verdict;
use crate::diagnosis::jump::Jump;
use crate::diagnosis::misfit::misfit;
use crate::diagnosis::search::{MOST_EFFECTS, names};
use crate::diagnosis::stage::{Stage, Unsmooth};
use crate::diagnosis::write::Findings;
use crate::noise::law::NoiseSource;

/// The verdict without regard to a tolerance.
struct Said {
    verdict: Verdict,
    says: String,
    /// Names of the effects that are claimed.
    claimed: Vec<String>,
}

impl Said {
    fn nothing(verdict: Verdict, says: String) -> Self {
        Self { verdict, says, claimed: Vec::new() }
    }
}

impl Findings<'_> {
    /// Effects that the answer shows as added.
    pub(crate) fn shown(&self) -> &[Arc<dyn Effect>] {
        &self.shown_stage().added
    }

    pub(crate) fn last(&self) -> &Stage {
        &self.search.stages[self.search.stages.len() - 1]
    }

    /// The stage of the effects that are shown.
    pub(crate) fn shown_stage(&self) -> &Stage {
        if self.verdict().0.shows_effects() { self.last() } else { &self.search.stages[0] }
    }

    /// The stage for reading the geometry, without regard to a tolerance.
    pub(crate) fn regardless(&self) -> &Stage {
        if self.said().verdict.shows_effects() { self.last() } else { &self.search.stages[0] }
    }

    /// The verdict, a sentence or two, and the names of the effects that are claimed.
    pub(crate) fn verdict(&self) -> (Verdict, String, Vec<String>) {
        if let Some(event) = &self.event {
            return (Verdict::CannotTell, event.clone(), Vec::new());
        }
        let Said { verdict, says, claimed } = self.said();
        let is_known = self.context.law.source != NoiseSource::Instruments;
        let Some(tolerance) = self.tolerance_n.filter(|_| is_known) else {
            return (verdict, says, claimed);
        };
        let small = format!("{} N", significant(tolerance, 3));
        let within = |stage: &Stage| {
            let (left, interval) = misfit(&stage.linear, self.context.seed);
            (interval[1] <= tolerance)
                .then(|| format!("{} N (at most {})", significant(left, 2), significant(interval[1], 2)))
        };
        if let Some(left) = within(&self.search.stages[0]) {
            let says = format!(
                "the model explains these data within the tolerance of {small}: its systematic misfit is {left}"
            );
            return (Verdict::Adequate, says, Vec::new());
        }
        match verdict {
            Verdict::Adequate => {
                let says = format!(
                    "nothing is seen, but these data can't exclude a systematic misfit above the tolerance of {small}: it is {}; measure more rows",
                    self.size()
                );
                (Verdict::CannotTell, says, Vec::new())
            }
            Verdict::Missing => {
                // Effects added after a model that is good enough need not be claimed.
                let enough = self.search.stages.iter().skip(1).find_map(|stage| {
                    let is_needed =
                        |name: &&String| stage.added.iter().any(|e| e.card().name == name.as_str());
                    let needed: Vec<String> = claimed.iter().filter(is_needed).cloned().collect();
                    Some((needed, within(stage)?)).filter(|(needed, _)| !needed.is_empty())
                });
                match enough.filter(|(needed, _)| needed.len() < claimed.len()) {
                    Some((needed, left)) => {
                        let labels = self.labels(&needed);
                        let says = format!(
                            "missing: {labels}; what that leaves, {left} of systematic misfit, is within the tolerance of {small}"
                        );
                        (verdict, says, needed)
                    }
                    None => (verdict, says, claimed),
                }
            }
            Verdict::Unknown | Verdict::CannotTell => (verdict, says, claimed),
        }
    }

    /// The systematic misfit of the last model with its interval.
    fn size(&self) -> String {
        self.size_of(self.last())
    }

    fn size_of(&self, stage: &Stage) -> String {
        let (misfit_n, interval) = misfit(&stage.linear, self.context.seed);
        if interval[0] <= 0.0 {
            return format!("at most {} N", significant(interval[1], 2));
        }
        format!(
            "{} N ({} to {})",
            significant(misfit_n, 2),
            significant(interval[0], 2),
            significant(interval[1], 2)
        )
    }

    /// The names under which effects of the last model are reported.
    fn labels(&self, names: &[String]) -> String {
        let is_one = |effect: &&Arc<dyn Effect>| names.iter().any(|name| name == effect.card().name);
        self.last()
            .added
            .iter()
            .filter(is_one)
            .map(|effect| self.claimed(effect))
            .collect::<Vec<_>>()
            .join(" and ")
    }

    /// The verdict without a tolerance.
    fn said(&self) -> Said {
        let last = self.last();
        if self.context.law.source == NoiseSource::Instruments {
            let says = "these rows are too few to know their noise, and data sheets allow a ranking but no verdict: measure at least three pressures \
                        with 20 rows each, or repeat some rows";
            return Said::nothing(Verdict::CannotTell, says.to_owned());
        }
        let size = self.size();
        let all: Vec<String> = last.added.iter().map(|effect| effect.card().name.to_owned()).collect();
        if last.adequate && all.is_empty() {
            if self.is_large() {
                let stated = match self.stated_n() {
                    Some(stated) if self.is_beyond_data_sheet() => {
                        format!("; the data sheet of the load cell says {} N", significant(stated, 2))
                    }
                    _ => String::new(),
                };
                let says = format!(
                    "noise as large as the misfit itself would explain it ({} N of it shared by neighbouring readings or by whole sweeps{stated}), and so would something \
                     that is missing: the systematic misfit is {size}, and these data don't tell the two apart",
                    significant(self.slow_n(), 2)
                );
                return Said::nothing(Verdict::CannotTell, says);
            }
            let says = format!(
                "the model explains these data: nothing is missing that they could show; its systematic misfit is {size}"
            );
            return Said::nothing(Verdict::Adequate, says);
        }
        let bent = self.is_bent();
        if last.adequate && !bent && self.search.something_else.is_none() {
            return self.explained_by(&all);
        }
        let most =
            last.excess() < RULE.left * self.search.stages[0].excess() || last.something_else() < RULE.weak;
        let most = most && !bent && self.search.something_else != Some(0) || self.is_nearly_exact();
        let (sound, odd): (Vec<String>, Vec<String>) = all.into_iter().partition(|name| self.possible(name));
        if !sound.is_empty() && most {
            let beside = if odd.is_empty() {
                "that explains".to_owned()
            } else {
                format!(
                    "with {}, whose numbers no muscle has and which stands in for something else, that explains",
                    self.labels(&odd)
                )
            };
            let further = if last.added.len() >= MOST_EFFECTS {
                "after three effects, where the search stops: accept them and ask again"
            } else if may_bend(&last.confirmed.prepared) {
                "beside which no further effect is named while these formulas may be a little wrong: accept them and ask again"
            } else {
                "that no further effect explains"
            };
            // If something remains, effects with impossible parameters stand in for something else and are
            // not claimed.
            let claimed = if last.adequate { sound.into_iter().chain(odd).collect() } else { sound };
            let (claimed, doubtful) = self.apart(&claimed);
            if claimed.is_empty() {
                return self.nameless(&doubtful);
            }
            let says = format!(
                "missing: {}{}; {beside} most of the misfit, and {size} of structure remain {further}",
                self.labels(&claimed),
                self.beside(&doubtful)
            );
            return Said { verdict: Verdict::Missing, says, claimed };
        }
        self.unexplained(bent)
    }

    /// The verdict if no effect explains the data, or too much of what explains them is left to form errors.
    fn unexplained(&self, bent: bool) -> Said {
        let last = self.last();
        let size = self.size();
        let structure = if let Some(left) = self.unsmooth() {
            format!("{left} that")
        } else if misfit(&last.linear, self.context.seed).1[1] <= 0.0 {
            "a misfit that no smooth function follows and".to_owned()
        } else {
            format!("a structure of {size} that")
        };
        let explains = if self.context.only.is_some() {
            "none of the effects that were looked for explains"
        } else {
            "no effect of the catalogue explains"
        };
        if last.adequate && bent && last.adequacy.unsmooth.is_none() {
            // Nothing is left but what the formulas would have to be wrong by.
            let (size, with) = (self.size_of(&self.search.stages[0]), self.labels(&names(last.added.iter())));
            let says = format!(
                "these data hold a structure of {size} that {explains} by its formula: with {with} too much is left to errors of the formulas"
            );
            return Said::nothing(Verdict::Unknown, says);
        }
        let says = format!("these data hold {structure} {explains}");
        Said::nothing(Verdict::Unknown, says)
    }

    /// Whether a misfit that may be noise is too large for an adequate model.
    pub(crate) fn is_large(&self) -> bool {
        let (_, [low, high]) = misfit(&self.last().linear, self.context.seed);
        let force = self.context.record.force();
        let full = full_scale(force, 0..force.len());
        let has_none = self.search.stages.len() == 1;
        has_none
            && (low > RULE.surely * full
                || high > RULE.maybe * full && self.slow_n() > RULE.slow * self.context.row_n
                || self.is_beyond_data_sheet())
    }

    /// Noise of single readings from the data sheet of the load cell \[N\].
    fn stated_n(&self) -> Option<f64> {
        let force = self.last().confirmed.prepared.model.muscle().instruments().force?;
        Some(force.noise()).filter(|noise| *noise > 0.0)
    }

    /// Whether the apparent slow noise is far larger than that of the load cell, so that something unstated
    /// must vary.
    fn is_beyond_data_sheet(&self) -> bool {
        self.stated_n().is_some_and(|stated| self.slow_n() > RULE.slow * stated)
    }

    /// The part of the last model's residuals that no smooth function follows, in words.
    pub(crate) fn unsmooth(&self) -> Option<String> {
        Some(match self.last().adequacy.unsmooth? {
            Unsmooth::Oscillation(period) => {
                format!("an oscillation with a period of {} s", significant(period, 3))
            }
            Unsmooth::Jump(jump) => self.jump(jump),
            Unsmooth::Recurs => "a rough misfit common to several strokes".to_owned(),
        })
    }

    /// A jump that the last model leaves: the first row of the record behind it, and in words.
    pub(crate) fn jump_left(&self) -> Option<(usize, String)> {
        match self.last().adequacy.unsmooth? {
            Unsmooth::Jump(jump) => Some((jump.row, self.jump(jump))),
            Unsmooth::Oscillation(_) | Unsmooth::Recurs => None,
        }
    }

    /// The effects that are claimed, with their families.
    pub(crate) fn claims(&self) -> Vec<(&str, &str)> {
        let claimed = self.verdict().2;
        let is_claimed = |effect: &&Arc<dyn Effect>| claimed.iter().any(|name| name == effect.card().name);
        let effects = self.last().added.iter().filter(is_claimed);
        effects.map(|effect| (effect.card().name, effect.card().family)).collect()
    }

    /// A jump and its location, in words.
    fn jump(&self, jump: Jump) -> String {
        let record = self.context.record;
        let moment = &record.moments()[jump.row];
        let size = significant(jump.newtons.abs(), 2);
        let (pressure, contraction) = (moment.pressure / 1e5, 100.0 * moment.contraction);
        let [pressure, contraction] = [pressure, contraction].map(|value| significant(value, 3));
        let at = if record.has_time() {
            format!(", after {} s", significant(moment.clock, 4))
        } else {
            String::new()
        };
        format!("a jump of {size} N within a sweep (at {pressure} bar and {contraction} %{at})")
    }

    /// Noise that readings share with their neighbours or within a sweep \[N\].
    pub(crate) fn slow_n(&self) -> f64 {
        self.context.law.correlated_n.hypot(self.context.law.offset_n)
    }

    /// What is said of effects beside those that are claimed.
    fn beside(&self, doubtful: &[String]) -> String {
        let labels = self.labels(doubtful);
        if doubtful.is_empty() {
            String::new()
        } else if doubtful.iter().all(|name| self.may_be_form_error(name)) {
            format!(", and larger errors of formulas than usual, or {labels}")
        } else {
            format!(", and something that these data don't tell, nearest {labels}")
        }
    }

    /// The verdict if these effects explain the data.
    fn explained_by(&self, all: &[String]) -> Said {
        let (claimed, doubtful) = self.apart(all);
        if claimed.is_empty() {
            return self.nameless(&doubtful);
        }
        let with = if claimed.len() + doubtful.len() == 1 { "it" } else { "them" };
        let but = self.unsmooth().map_or_else(String::new, |left| format!(", but for {left}"));
        let and = self.beside(&doubtful);
        let says =
            format!("missing: {}{and}; with {with} the model explains the data{but}", self.labels(&claimed));
        Said { verdict: Verdict::Missing, says, claimed }
    }

    /// The verdict if none of the effects that explain the data deserves a claim.
    fn nameless(&self, doubtful: &[String]) -> Said {
        let likeliest = self.labels(doubtful);
        let says = if self.all_may_be_form_error {
            format!(
                "something is missing, most likely {likeliest}, or the formulas of the effects that the model has are less exact than usual: larger errors of them \
                 would explain as much. Measure more of what moves, or what those effects do on their own"
            )
        } else {
            format!(
                "something may be missing, and these data don't say what: the likeliest is {likeliest}, and such names are wrong more often than right; measure more rows, or \
                 more of what moves"
            )
        };
        Said::nothing(Verdict::CannotTell, says)
    }

    /// Confidence in the mechanism of a named effect, or in an effect that these data can't tell from it.
    fn alike(&self, name: &str) -> f64 {
        let found = self.class(name);
        found.map_or(1.0, |(class, sure)| Levels::of(class, sure, self.classes.len()).alike)
    }

    /// Whether larger errors of the other formulas would explain as much as a named effect.
    fn may_be_form_error(&self, name: &str) -> bool {
        self.class(name).is_some_and(|(class, _)| class.may_be_form_error)
    }

    fn class(&self, name: &str) -> Option<&(Class, Confidence)> {
        self.classes.iter().find(|(class, _)| class.effect.card().name == name)
    }

    /// Separates claims from doubtful names: further effects with little evidence over a model without them,
    /// or which larger errors of the other formulas would replace, or with a mechanism that is more likely wrong
    /// than right. The effect with the largest evidence and the surest one needn't be more likely right than
    /// wrong, but no name is claimed that is wrong in most cases, or that is likelier nothing and within the noise.
    fn apart(&self, names: &[String]) -> (Vec<String>, Vec<String>) {
        let evidence =
            |name: &String| self.class(name).map_or(f64::INFINITY, |(class, _)| class.log_evidence);
        let most = names.iter().map(evidence).fold(f64::NEG_INFINITY, f64::max);
        let surest = names.iter().map(|name| self.alike(name)).fold(0.0, f64::max);
        let is_seen = |name: &String| evidence(name) >= RULE.seen.min(most) && !self.may_be_form_error(name);
        let is_decided = |name: &String| self.alike(name) >= RULE.decides.min(surest);
        let is_there = |name: &String| {
            let is_seen = |class: &Class| class.log_evidence >= 0.0 || class.detectability >= RULE.separation;
            self.class(name).is_none_or(|(class, _)| is_seen(class))
        };
        let is_named = |name: &String| {
            self.alike(name) >= RULE.nameless && is_there(name) && !self.all_may_be_form_error
        };
        // Of effects that may all be errors of the others' formulas, the likeliest is named.
        let all_may_be = names.iter().all(|name| self.may_be_form_error(name));
        let is_most = |name: &String| evidence(name) >= most && (all_may_be || !self.may_be_form_error(name));
        let is_claimed =
            |name: &String| is_named(name) && (is_most(name) || is_seen(name) && is_decided(name));
        names.iter().cloned().partition(is_claimed)
    }

    /// Whether the formulas of the effects explain nearly everything as they are, so that the rest is their
    /// own error. If the remaining misfit may be zero, the smaller fraction required for claims is enough.
    fn is_nearly_exact(&self) -> bool {
        let may_be_none = || !self.is_bent() && misfit(&self.last().linear, self.context.seed).1[0] <= 0.0;
        is_nearly_all(self.last().by_formulas(&self.search.stages[0]), may_be_none)
    }

    /// Whether the claim rests on form errors; the effects are then only the nearest ones, not what is
    /// missing.
    fn is_bent(&self) -> bool {
        let (base, last) = (&self.search.stages[0].confirmed, &self.last().confirmed);
        let (form, base_form) = (last.form.log_evidence, base.form.log_evidence);
        form - base_form > (1.0 - RULE.exact) * (last.log_evidence - base.log_evidence)
            || self.last().added.len() > 1
                && self.last().by_formulas(&self.search.stages[0]) < RULE.by_formulas[0]
    }
}

/// Whether the part that the formulas explain is enough, if the rest `may_be_none`.
fn is_nearly_all(part: f64, may_be_none: impl FnOnce() -> bool) -> bool {
    part >= RULE.by_formulas[1] || part >= RULE.exact && may_be_none()
}

/// The sweep with the largest error, or the pressure if there is only one sweep, as a clause that continues a
/// sentence.
pub(crate) fn furthest(comparison: &Comparison) -> String {
    let of = |variable: &str| {
        let bins = comparison.by.iter().find(|by| by.variable == variable).map(|by| (&by.bins, by.unit))?;
        let furthest = |a: &&Bin, b: &&Bin| a.rmse_n[1].total_cmp(&b.rmse_n[1]);
        Some((bins.0.iter().max_by(furthest)?, bins.1))
    };
    let Some((bin, what)) = of("sweep")
        .map(|(bin, _)| (bin, format!("sweep {:.0} (`{}`)", bin.at, bin.label)))
        .or_else(|| of("pressure").map(|(bin, unit)| (bin, format!("{} {unit}", bin.label))))
    else {
        return String::new();
    };
    let bias_n = bin.bias_n[1];
    let side = if bias_n < 0.0 { "below" } else { "above" };
    let by = significant(bias_n.abs(), 2);
    format!("; furthest off is {what}, where the readings lie {by} N {side} the model on average: repeat it")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rest_that_may_be_none_takes_a_smaller_part_to_claim() {
        let [_, without] = RULE.by_formulas;
        let between = 0.5 * (RULE.exact + without);
        for (part, may_be_none, all) in [
            (without, false, true),
            (between, false, false),
            (between, true, true),
            (RULE.exact, true, true),
            (0.99 * RULE.exact, true, false),
        ] {
            assert_eq!(is_nearly_all(part, || may_be_none), all, "{part} {may_be_none}");
        }
    }
}
