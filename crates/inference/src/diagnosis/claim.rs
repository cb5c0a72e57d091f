//! Level of a claim (mechanism, family or form) with the confidence of each, and the form error that the data
//! want.

use bulge_effects::{Effect, Mechanism};
use bulge_model::Record;
use std::sync::Arc;

use crate::diagnosis::classes::{Class, Rival};
use crate::diagnosis::confidence::Confidence;
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::document::{FormErrorAt, FormErrorResult, Level};
use crate::diagnosis::explained::bent_curves;
use crate::diagnosis::form_error::Bent;
use crate::vector::rms;

/// Probability that a claim is right on three levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Levels {
    /// For the mechanism or an effect that these data can't tell from the named one. It decides what is named;
    /// the others are what is stated.
    pub(crate) alike: f64,
    pub(crate) mechanism: f64,
    pub(crate) family: f64,
    pub(crate) form: f64,
}

impl Levels {
    /// Confidence of one of `named` effects. It is the weight of its related effects among all rivals, and at
    /// most the simulated confidence. A rival of another mechanism counts against it even if the data can't tell
    /// the two apart.
    pub(crate) fn of(class: &Class, simulated: &Confidence, named: usize) -> Self {
        let own = class.effect.card();
        let weights = |counts: &dyn Fn(&Rival) -> bool| -> f64 {
            let rivals = class.rivals.iter().filter(|rival| rival.log_evidence.is_finite() && counts(rival));
            rivals.map(|rival| (rival.log_evidence - class.log_evidence).exp()).sum()
        };
        let all = 1.0 + weights(&|_| true);
        let sure = (1.0 - RULE.incomplete)
            * RULE.further.powi(i32::try_from(named).unwrap_or(i32::MAX).saturating_sub(1));
        let part = |counts: &dyn Fn(&Rival) -> bool| sure * (1.0 + weights(counts)) / all;
        let is_of_mechanism = |rival: &Rival| is_same_mechanism(&rival.effect, &class.effect);
        let alike = part(&|rival| rival.separation < RULE.same || is_of_mechanism(rival));
        let mechanism = part(&is_of_mechanism);
        let family = part(&|rival| rival.effect.card().family == own.family);
        let family = family.min(simulated.named);
        // If no truth that the linearised model leaves possible is of the class, the fit lies far outside of it.
        let [alike, mechanism] =
            [alike, mechanism].map(|part| if simulated.class > 0.0 { part } else { 0.0 });
        // A user's formula without a mechanism represents itself, so a statement about it holds for its form,
        // family and mechanism alike.
        let form = part(&|_| false).min(family);
        Self { alike: alike.max(family), mechanism: mechanism.max(family), family, form }
    }

    /// The most specific level at which the claim is more likely right than wrong.
    pub(crate) fn decided(self) -> Level {
        match self {
            Self { form, .. } if form >= RULE.decides => Level::Form,
            Self { family, .. } if family >= RULE.decides => Level::Family,
            Self { mechanism, .. } if mechanism >= RULE.decides => Level::Mechanism,
            _ => Level::Class,
        }
    }
}

/// Whether two effects have the same mechanism; users' effects without one only share a family.
fn is_same_mechanism(a: &Arc<dyn Effect>, b: &Arc<dyn Effect>) -> bool {
    let (a, b) = (a.card(), b.card());
    a.mechanism == b.mechanism && (a.mechanism != Mechanism::User || a.family == b.family)
}

/// The form error of an effect that the data want.
pub(crate) fn form_error(record: &Record, bent: &Bent) -> FormErrorResult {
    let largest =
        (0..bent.bending.len()).max_by(|a, b| bent.bending[*a].abs().total_cmp(&bent.bending[*b].abs()));
    let at = largest.filter(|_| bent.may_bend()).map(|row| {
        let moment = &record.moments()[row];
        FormErrorAt {
            pressure_pa: moment.pressure,
            contraction: moment.contraction,
            direction: moment.branch(),
            formula_n: bent.change[row],
            bending_n: bent.bending[row],
            sd_n: bent.bending_sd[row],
        }
    });
    FormErrorResult {
        share: bent.part,
        rms_n: rms(&bent.bending),
        r#where: at,
        curves: if bent.may_bend() { bent_curves(record, bent) } else { Vec::new() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Catalogue;

    #[test]
    fn a_claim_is_as_sure_as_its_kin_are_likely_among_all_rivals() {
        let catalogue = Catalogue::builtin();
        let rival = |name: &str, behind: f64, separation: f64| Rival {
            effect: Arc::clone(catalogue.find(name).unwrap()),
            log_evidence: 20.0 - behind,
            separation,
            in_class: true,
            fit: None,
        };
        let class = Class {
            effect: Arc::clone(catalogue.find("coulomb-friction").unwrap()),
            log_evidence: 20.0,
            may_be_form_error: false,
            detectability: 6.0,
            scatter: 1.0,
            is_further: false,
            // Rivals: one of the family, one of the mechanism, one that is indistinguishable on these data,
            // and another one.
            rivals: vec![
                rival("asymmetric-friction", 0.5, 2.0),
                rival("pressure-friction", 1.0, 2.0),
                rival("valve-hysteresis", 1.5, 0.5),
                rival("creep", 2.0, 4.0),
            ],
        };
        let simulated = |named| Confidence { named, class: 1.0, interval: [0.0, 1.0], claims: 100 };
        let [family, kin, same, other] = [0.5_f64, 1.0, 1.5, 2.0].map(|behind| (-behind).exp());
        let all = 1.0 + family + kin + same + other;
        let found = Levels::of(&class, &simulated(1.0), 1);
        let expected = [1.0 + family + kin, 1.0 + family, 1.0].map(|part| 0.9 * part / all);
        for (found, expected) in [found.mechanism, found.family, found.form].into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        assert!((found.alike - 0.9 * (1.0 + family + kin + same) / all).abs() < 1e-12);
        // At most the simulated confidence, and a tenth less for each further name.
        assert!((Levels::of(&class, &simulated(0.4), 1).family - 0.4).abs() < 1e-12);
        assert!((Levels::of(&class, &simulated(1.0), 3).mechanism / found.mechanism - 0.81).abs() < 1e-12);
        // Nothing is sure of what no possible truth holds, however much it explains.
        let impossible = Confidence { named: 0.0, class: 0.0, interval: [0.0, 1.0], claims: 0 };
        assert!(Levels::of(&class, &impossible, 1).mechanism <= 0.0);
        let unseen = Confidence { class: 0.2, ..impossible };
        assert!((Levels::of(&class, &unseen, 1).mechanism - found.mechanism).abs() < 1e-12);
    }

    #[test]
    fn the_deepest_level_that_is_likelier_right_than_wrong_is_stated() {
        let level = |mechanism, family, form| Levels { alike: 1.0, mechanism, family, form }.decided();
        assert_eq!(level(0.9, 0.8, 0.6), Level::Form);
        assert_eq!(level(0.9, 0.8, 0.4), Level::Family);
        assert_eq!(level(0.9, 0.4, 0.4), Level::Mechanism);
        assert_eq!(level(0.4, 0.3, 0.1), Level::Class);
    }
}
