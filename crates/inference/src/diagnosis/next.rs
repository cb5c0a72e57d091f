//! The next experiment: the protocol within the user's limits that best separates the remaining rivals, and
//! the number of repeats; or the answer that none does.
//!
//! ```text
//! d^2 after R repeats = d^2 of the data at hand + R d^2 of the protocol,    d the sigmas between the named effect and its nearest rival after refitting
//! ```

use bulge_effects::Parity;
use bulge_model::Wanted;
use bulge_muscles::units::{rounded, significant};

use crate::comparison::doubt::doubtful_sd;
use crate::comparison::levels::Levels;
use crate::diagnosis::classes::Class;
use crate::diagnosis::confidence::Confidence;
use crate::diagnosis::confirm::Confirmed;
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::document::NextExperiment;
use crate::diagnosis::linearised_model::Context;
use crate::diagnosis::proposals::{Limits, proposals};
use crate::fit::weights::Noise;
use crate::noise::law::{CorrelationTime, NoiseLaw};
use crate::noise::whitening::Whitening;
use crate::protocol::bench::{Protocol, ReadingNoise};
use crate::vector::minus;

/// Most repeats of a proposal.
const MOST_REPEATS: usize = 20;

/// A named effect with its class, and the two models with and without it.
pub(crate) struct Judged {
    pub(crate) class: Class,
    pub(crate) confidence: Confidence,
    /// The model with the effect, and the one without it.
    pub(crate) models: Option<(Confirmed, Confirmed)>,
}

/// The experiment that best separates the effects of the first class with several members; none if every
/// class is decided.
pub(crate) fn next_experiment(
    context: &Context<'_>,
    judged: &[Judged],
    limits: &Limits,
) -> Option<NextExperiment> {
    let is_open = |j: &&Judged| {
        let family = j.class.effect.card().family;
        j.class.rivals.iter().any(|rival| rival.in_class && rival.effect.card().family != family)
    };
    let open = judged.iter().find(is_open)?;
    let (with, without) = open.models.as_ref()?;
    let named = open.class.effect.card().name.to_owned();
    let own_family = open.class.effect.card().family;
    let rivals: Vec<(String, f64)> = open
        .class
        .rivals
        .iter()
        .filter(|rival| rival.in_class && rival.effect.card().family != own_family)
        .map(|rival| (rival.effect.card().name.to_owned(), rival.separation))
        .collect();
    let names: Vec<String> = rivals.iter().map(|(name, _)| name.clone()).collect();
    // A friction law is uncertain during standstill, so tests with holds decide nothing about it.
    let is_friction = open.class.effect.card().signature.parity == Parity::Odd;
    let tests = proposals(limits).into_iter().filter(|proposal| !(is_friction && proposal.holds()));
    let tried = tests.filter_map(|test| {
        let sigmas = separations(context, with, without, (&named, &names), &test.protocol)?;
        Some((Told::by(test.says, &rivals, &sigmas)?, test.protocol))
    });
    // Among equally good tests the first one is chosen.
    let best = tried.reduce(|best, other| if other.0.is_better(&best.0) { other } else { best });
    let separate = open.class.effect.card().separate;
    let nearest = |rivals: &[&(String, f64)]| {
        rivals.iter().min_by(|a, b| a.1.total_cmp(&b.1)).map(|rival| (rival.0.clone(), rival.1))
    };
    let Some((best, protocol)) = best else {
        let (nearest, at_hand) = nearest(&rivals.iter().collect::<Vec<_>>())?;
        return Some(NextExperiment {
            says: format!(
                "no test of force within these limits tells `{named}` from `{nearest}`. What does: {separate}"
            ),
            separates: vec![named, nearest],
            sigma: at_hand,
            repeats: 0,
            protocol: None,
        });
    };
    let (nearest, _) = nearest(&best.rivals)?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 1 and 20")]
    let repeats = best.repeats as usize;
    let times = if repeats == 1 { String::new() } else { format!(", all of it {repeats} times") };
    let told: Vec<String> = best.rivals.iter().map(|rival| rival.0.clone()).collect();
    let left: Vec<String> = names.into_iter().filter(|name| !told.contains(name)).collect();
    let but = if left.is_empty() {
        String::new()
    } else {
        format!(", but not from {}. What does: {separate}", listed(&left))
    };
    Some(NextExperiment {
        says: format!(
            "measure {}, {} and {} of contraction{times}: that tells `{named}` from {} ({} sigma){but}",
            limits.without_count(best.says),
            limits.pressures_in_words(),
            limits.contractions_in_words(),
            listed(&told),
            significant(best.after, 2)
        ),
        separates: vec![named, nearest],
        sigma: best.after,
        repeats,
        protocol: Some(Box::new(Protocol { noise: noise_of(context, &protocol), ..protocol })),
    })
}

/// The noise of the data at hand, as far as it applies to another test: a correlation over rows doesn't.
fn noise_of(context: &Context<'_>, protocol: &Protocol) -> ReadingNoise {
    let seconds = match context.law.time {
        Some(CorrelationTime::Seconds(time)) if !protocol.is_static() => Some(time),
        _ => None,
    };
    let correlated_n = seconds.map_or(0.0, |_| context.law.correlated_n);
    let force_n =
        if seconds.is_some() { context.row_n } else { context.row_n.hypot(context.law.correlated_n) };
    // Noise isn't known better than by three digits.
    ReadingNoise {
        force_n: rounded(force_n, 3),
        correlated_n: rounded(correlated_n, 3),
        correlation_time_s: rounded(seconds.filter(|_| correlated_n > 0.0).unwrap_or(0.0), 3),
        offset_n: rounded(context.law.offset_n, 3),
        ..ReadingNoise::default()
    }
}

/// How well a proposed test separates the rivals from the named effect.
struct Told<'a> {
    says: &'static str,
    /// The rivals that it separates, with their separation in the data at hand.
    rivals: Vec<&'a (String, f64)>,
    /// Number of repeats that separates all of them.
    repeats: f64,
    /// Separation of the nearest one in sigmas after the repeats, including the data at hand.
    after: f64,
}

impl<'a> Told<'a> {
    /// The result of a test that may be repeated, from the sigmas between the named effect and each rival;
    /// none if it separates no rival.
    fn by(says: &'static str, rivals: &'a [(String, f64)], sigmas: &[f64]) -> Option<Self> {
        let is_told = |((_, at_hand), sigma): &(&(String, f64), &f64)| {
            **sigma > 0.0 && repeats(*at_hand, **sigma) <= MOST_REPEATS as f64
        };
        let told: Vec<(&(String, f64), &f64)> = rivals.iter().zip(sigmas).filter(is_told).collect();
        let repeats = told.iter().map(|(rival, sigma)| repeats(rival.1, **sigma)).reduce(f64::max)?;
        let after =
            |(rival, sigma): &(&(String, f64), &f64)| (rival.1.powi(2) + repeats * sigma.powi(2)).sqrt();
        let after = told.iter().map(after).fold(f64::INFINITY, f64::min);
        Some(Self { says, rivals: told.into_iter().map(|(rival, _)| rival).collect(), repeats, after })
    }

    /// Whether it separates more rivals, or as many in fewer repeats, or as many in as few with a larger
    /// separation.
    fn is_better(&self, other: &Self) -> bool {
        let number = self.rivals.len().cmp(&other.rivals.len());
        let faster = other.repeats.total_cmp(&self.repeats);
        number.then(faster).then(self.after.total_cmp(&other.after)).is_gt()
    }
}

/// Number of repeats of a test that separates a rival by `sigma`; `at_hand` is the separation in the data at
/// hand.
fn repeats(at_hand: f64, sigma: f64) -> f64 {
    ((RULE.separation.powi(2) - at_hand.powi(2)).max(0.0) / (sigma * sigma)).ceil().max(1.0)
}

fn listed(names: &[String]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// Sigmas between an effect and each of its rivals in a planned test; none if the test is impossible with
/// this muscle.
fn separations(
    context: &Context<'_>,
    with: &Confirmed,
    without: &Confirmed,
    (named, rivals): (&String, &[String]),
    protocol: &Protocol,
) -> Option<Vec<f64>> {
    let (record, doubtful) = protocol.moments_in_doubt(&with.prepared.model, &with.theta).ok()?;
    let model = &without.prepared.model;
    let readings = Wanted { parameters: Vec::new(), readings: true };
    let prediction = model.evaluate(&record, &without.theta, &readings).ok()?;
    let noise = Noise::of(model.muscle(), context.row_n);
    let slopes = prediction.by_pressure.iter().zip(&prediction.by_contraction);
    let mut variances: Vec<f64> =
        slopes.map(|(p, e)| (p * noise.pressure_pa).powi(2) + (e * noise.contraction).powi(2)).collect();
    // Rows of uncertain direction will tell nothing of friction, as in the data at hand.
    let all = vec![true; record.len()];
    let signal = minus(record.force(), &prediction.force);
    let levels = Levels::of(&record, &all);
    if let Some(sd) = doubtful_sd(&record, (&doubtful, None), &all, &levels, &signal, context.row_n) {
        let further = sd.iter().map(|sd| sd * sd - context.row_n.powi(2));
        variances.iter_mut().zip(further).for_each(|(variance, further)| *variance += further);
    }
    let reading = noise_of(context, protocol);
    let timed = reading.correlated_n > 0.0;
    let law = NoiseLaw {
        correlated_n: reading.correlated_n,
        time: context.law.time.filter(|_| timed),
        white_n: reading.force_n,
        ..context.law.clone()
    };
    let record = record.with_force(prediction.force);
    let whitening = Whitening::new(&law, &record, &all, &variances).ok()?;
    // Coordinates span the candidates only. Without the effect itself among them, most of its signal would be
    // lost.
    let only: Vec<String> = rivals.iter().chain([named]).cloned().collect();
    let planned = Context {
        record: &record,
        whitening: &whitening,
        law: &law,
        only: Some(&only),
        is_planned: true,
        ..*context
    };
    let linear = planned.linearised(&without.prepared, &without.theta).ok()?;
    let signal = planned.signal(with, &linear).ok()?;
    let beside = planned.beside(&linear, &signal, &[]);
    // A rival that can't act in the test isn't separated by it.
    let of = |name: &String| linear.place(name).map_or(0.0, |place| beside.separation(&linear, place));
    Some(rivals.iter().map(of).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rival_that_no_test_tells_does_not_take_the_others_away() {
        let rivals = [("near".to_owned(), 0.5), ("same".to_owned(), 0.0), ("far".to_owned(), 2.5)];
        let by = |says, sigmas: [f64; 3]| Told::by(says, &rivals, &sigmas);
        let two = by("two", [2.0, 0.0, 0.8]).unwrap();
        assert_eq!(two.rivals.iter().map(|rival| rival.0.as_str()).collect::<Vec<_>>(), ["near", "far"]);
        // The far one takes ceil((3.29^2 - 2.5^2)/0.8^2) = 8 repeats, the near one ceil((3.29^2 - 0.5^2)/2^2)
        // = 3.
        assert!((two.repeats - 8.0).abs() < 1e-12);
        assert!((two.after - (2.5_f64.powi(2) + 8.0 * 0.64).sqrt()).abs() < 1e-12);
        // Twenty times 0.7^2 is less than 3.29^2.
        assert!(by("none", [0.7, 0.7, 0.2]).is_none());
        // Just at the limit: 3.29 sigma takes one repeat, 3.28 sigma takes two.
        assert!((repeats(0.0, 3.29) - 1.0).abs() < 1e-12 && (repeats(0.0, 3.28) - 2.0).abs() < 1e-12);
        // More rivals are preferred to fewer repeats, and those to a larger separation.
        let one = by("one", [9.0, 0.7, 0.1]).unwrap();
        assert!(two.is_better(&one) && !one.is_better(&two));
        let further = by("further", [2.0, 0.0, 0.9]).unwrap();
        assert!(further.is_better(&two) && !two.is_better(&by("again", [3.0, 0.0, 0.8]).unwrap()));
    }
}
