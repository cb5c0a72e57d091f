//! The next experiment: the protocol within the user's limits that best separates the remaining rivals, and
//! the number of repeats; or the answer that none does.
//!
//! ```text
//! d^2 after R repeats = d^2 of the data at hand + R d^2 of the protocol,    d the sigmas between the named effect and its nearest rival after refitting
//! ```

use bulge_effects::Parity;
use bulge_model::{Record, Wanted};
use bulge_muscles::units::significant;
use serde::Serialize;

use crate::comparison::levels::Levels;
use crate::diagnosis::classes::Class;
use crate::diagnosis::confidence::Confidence;
use crate::diagnosis::confirm::Confirmed;
use crate::diagnosis::decision_rule::RULE;
use crate::diagnosis::document::NextExperiment;
use crate::diagnosis::linearised_model::Context;
use crate::fit::weights::Noise;
use crate::noise::law::{CorrelationTime, NoiseLaw};
use crate::noise::whitening::Whitening;
use crate::protocol::bench::{Block, Path, Protocol, ReadingNoise};
use crate::vector::range;

/// Most repeats of a proposal.
const MOST_REPEATS: usize = 20;
/// Rows of each sweep of a proposal.
const ROWS: u32 = 60;

/// Limits of the next experiment; the ranges of the data if nothing is stated.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct NextLimits {
    /// Least and largest pressure \[Pa\].
    pub pressure_pa: Option<[f64; 2]>,
    /// Least and largest contraction.
    pub contraction: Option<[f64; 2]>,
}

/// The number of pressures as it appears in proposals.
const COUNTS: [&str; 8] = [
    ", at two pressures",
    " at the lowest and the highest pressure",
    " at two pressures",
    " at three pressures",
    ", at four pressures",
    " at six pressures",
    " at one pressure",
    " of eight pressures",
];

/// Highest gauge pressure \[Pa\], and contractions that a bench can set, as for a protocol.
const MOST_PRESSURE: f64 = 1e8;
const CONTRACTIONS: [f64; 2] = [-1.0, 0.6];

impl NextLimits {
    /// Checks whether a bench can keep within the limits.
    ///
    /// # Errors
    /// The name of the impossible limit, and what is wrong with it.
    pub fn check(&self) -> Result<(), (&'static str, String)> {
        let [least, most] = CONTRACTIONS;
        if let Some([low, high]) = self.pressure_pa
            && !(low > 0.0 && low < high && high <= MOST_PRESSURE)
        {
            let what = format!(
                "{low} to {high} Pa is not possible: gauge pressures lie above 0 and up to 1000 bar; write such as \"1 bar..6 bar\""
            );
            return Err(("pressure", what));
        }
        if let Some([low, high]) = self.contraction
            && !(low >= least && low < high && high <= most)
        {
            let what = format!(
                "{} to {} % is not possible: contractions lie within -100 % and 60 %; write such as \"0 %..20 %\"",
                significant(100.0 * low, 4),
                significant(100.0 * high, 4)
            );
            return Err(("contraction", what));
        }
        Ok(())
    }
}

/// The limits in effect.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    pressure_pa: [f64; 2],
    contraction: [f64; 2],
    /// Period of one loop of the data \[s\].
    period_s: f64,
}

impl Limits {
    /// The stated limits, completed by the ranges of a record.
    pub(crate) fn of(record: &Record, stated: NextLimits) -> Self {
        let range = |of: fn(&bulge_effects::Moment) -> f64| range(record.moments().iter().map(of));
        let levels = Levels::of(record, &vec![true; record.len()]);
        let [low, high] = range(|m| m.pressure);
        let kept = [levels.mean.first().copied().unwrap_or(low), levels.mean.last().copied().unwrap_or(high)];
        // The cycle number continues from sweep to sweep.
        let mut periods: Vec<f64> = record
            .sweeps()
            .iter()
            .map(|sweep| {
                let rows = || record.moments()[sweep.clone()].iter();
                let [first, last] = rows().fold([f64::INFINITY, 0.0], |[first, last]: [f64; 2], m| {
                    [first.min(m.cycle), last.max(m.cycle)]
                });
                rows().map(|m| m.time).fold(0.0, f64::max) / ((last - first).max(0.0).floor() + 1.0)
            })
            .collect();
        periods.sort_by(f64::total_cmp);
        let period = periods.get(periods.len() / 2).map_or(60.0, |period| period.clamp(1.0, 1e4));
        Self {
            pressure_pa: stated.pressure_pa.unwrap_or(kept),
            contraction: stated.contraction.unwrap_or_else(|| range(|m| m.contraction)),
            period_s: if record.has_time() { period } else { 60.0 },
        }
    }

    fn pressures_in_words(&self) -> String {
        let [low, high] = self.pressure_pa.map(|p| significant(p / 1e5, 3));
        if low == high { format!("at {low} bar") } else { format!("between {low} and {high} bar") }
    }

    /// A proposal in words, without its number of pressures if only one may be used.
    fn without_count(&self, says: &str) -> String {
        let one = self.pressures(2).len() == 1;
        let counts = COUNTS.iter().find(|counts| one && says.contains(**counts));
        counts.map_or_else(|| says.to_owned(), |counts| says.replacen(counts, "", 1))
    }

    fn pressures(&self, count: usize) -> Vec<f64> {
        let [low, high] = self.pressure_pa;
        if high - low <= 1e-3 * high {
            return vec![high];
        }
        (0..count).map(|i| low + (high - low) * i as f64 / (count - 1).max(1) as f64).collect()
    }
}

/// A named effect with its class, and the two models with and without it.
pub(crate) struct Judged {
    pub(crate) class: Class,
    pub(crate) confidence: Confidence,
    /// The model with the effect, and the one without it.
    pub(crate) models: Option<(Confirmed, Confirmed)>,
}

/// A protocol with its description.
struct Proposal {
    says: &'static str,
    protocol: Protocol,
}

impl Proposal {
    /// Whether the muscle is held in between.
    fn holds(&self) -> bool {
        self.protocol.blocks.iter().any(|block| matches!(block.path, Path::Stairs { .. }))
    }
}

/// The experiments to choose from.
fn proposals(limits: &Limits) -> Vec<Proposal> {
    let [low, high] = limits.contraction;
    // A loop needs a range. If the force is unbounded at rest, evaluating the model reports it.
    let whole = [low, high.max(low + 0.01)];
    let block = |pressures: usize, contraction: [f64; 2], path: Path, period: f64, cycles: u32| Block {
        path,
        cycles,
        rows: ROWS,
        ..Block::loops(limits.pressures(pressures), contraction, period)
    };
    let slow = limits.period_s;
    let one = |says, blocks: Vec<Block>| Proposal { says, protocol: Protocol::new(blocks) };
    let third_of_stroke = [whole[0], whole[0] + (whole[1] - whole[0]) / 3.0];
    let small = [whole[0], (whole[0] + 0.25 * (high - whole[0])).max(whole[0] + 0.01)];
    vec![
        one(
            "loops at six pressures over the whole range of contraction",
            vec![block(6, whole, Path::Triangle, slow, 1)],
        ),
        one(
            "loops at the lowest and the highest pressure, three times each",
            vec![block(2, whole, Path::Triangle, slow, 3)],
        ),
        one(
            "the same loops, and then ten times slower, at two pressures",
            vec![block(2, whole, Path::Triangle, slow, 1), block(2, whole, Path::Triangle, 10.0 * slow, 1)],
        ),
        one(
            "the same loops, and then ten times faster, at two pressures",
            vec![block(2, whole, Path::Triangle, slow, 1), block(2, whole, Path::Triangle, slow / 10.0, 1)],
        ),
        one(
            "the same loops, and then ten times slower and ten times faster, at two pressures",
            [slow, 10.0 * slow, slow / 10.0]
                .map(|period| block(2, whole, Path::Triangle, period, 1))
                .to_vec(),
        ),
        one(
            "loops over a third of the stroke, and over all of it at the same speed, at two pressures",
            vec![
                block(2, third_of_stroke, Path::Triangle, slow / 3.0, 2),
                block(2, whole, Path::Triangle, slow, 1),
            ],
        ),
        one(
            "sines at three pressures, whose speed goes through 0 at the ends",
            vec![block(3, whole, Path::Sine, slow, 2)],
        ),
        one(
            "small loops near the largest force, at four pressures",
            vec![block(4, small, Path::Triangle, slow, 2)],
        ),
        one(
            "steps of contraction with holds of a minute, at two pressures",
            vec![block(2, whole, Path::Stairs { steps: 4, hold_s: 60.0 }, 8.0 * 70.0, 1)],
        ),
        one(
            "twelve loops at one pressure, one after the other",
            vec![block(1, whole, Path::Triangle, slow, 12)],
        ),
        one("a static map of eight pressures", vec![Block::map(limits.pressures(8), whole, 20)]),
    ]
    .into_iter()
    .chain(filled(limits, whole))
    .collect()
}

/// Experiments at held length in which the pressure rises and falls.
fn filled(limits: &Limits, whole: [f64; 2]) -> Vec<Proposal> {
    let slow = limits.period_s;
    let one = |says, blocks: Vec<Block>| Proposal { says, protocol: Protocol::new(blocks) };
    let [low_pressure, high_pressure] = limits.pressure_pa;
    let third = low_pressure.max(high_pressure / 3.0);
    let filling = |from: f64, lengths: u32, period: f64| {
        let from = from.min(0.9 * high_pressure);
        let held = (0..lengths)
            .map(|i| whole[0] + (whole[1] - whole[0]) * (0.1 + 0.8 * f64::from(i) / f64::from(lengths - 1)));
        let block = Block::isometric([from, high_pressure], held.collect(), period);
        Block { cycles: 2, rows: ROWS, ..block }
    };
    vec![
        one("filling and venting at three held lengths, twice each", vec![filling(low_pressure, 3, slow)]),
        one(
            "filling and venting at two held lengths, from the lowest pressure and from a third of the highest",
            vec![filling(low_pressure, 2, slow), filling(third, 2, slow)],
        ),
        one(
            "filling and venting at two held lengths, and then ten times slower",
            vec![filling(low_pressure, 2, slow), filling(low_pressure, 2, 10.0 * slow)],
        ),
        one(
            "filling and venting at two held lengths, and then ten times slower and ten times faster",
            [slow, 10.0 * slow, slow / 10.0].map(|period| filling(low_pressure, 2, period)).to_vec(),
        ),
    ]
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
    let times = if repeats == 1 { "once".to_owned() } else { format!("{repeats} times") };
    let told: Vec<String> = best.rivals.iter().map(|rival| rival.0.clone()).collect();
    let left: Vec<String> = names.into_iter().filter(|name| !told.contains(name)).collect();
    let but = if left.is_empty() {
        String::new()
    } else {
        format!(", but not from {}. What does: {separate}", listed(&left))
    };
    Some(NextExperiment {
        says: format!(
            "measure {}, {} and between {} and {} % of contraction, {times}: that tells `{named}` from {} ({} sigma){but}",
            limits.without_count(best.says),
            limits.pressures_in_words(),
            significant(100.0 * limits.contraction[0], 2),
            significant(100.0 * limits.contraction[1], 3),
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
    ReadingNoise {
        force_n: if seconds.is_some() {
            context.row_n
        } else {
            context.row_n.hypot(context.law.correlated_n)
        },
        correlated_n,
        correlation_time_s: seconds.filter(|_| correlated_n > 0.0).unwrap_or(0.0),
        offset_n: context.law.offset_n,
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
    let record = protocol.moments_within(&with.prepared.model, &with.theta).ok()?;
    let model = &without.prepared.model;
    let readings = Wanted { parameters: Vec::new(), readings: true };
    let prediction = model.evaluate(&record, &without.theta, &readings).ok()?;
    let noise = Noise::of(model.muscle(), context.row_n);
    let slopes = prediction.by_pressure.iter().zip(&prediction.by_contraction);
    let variances: Vec<f64> =
        slopes.map(|(p, e)| (p * noise.pressure_pa).powi(2) + (e * noise.contraction).powi(2)).collect();
    let reading = noise_of(context, protocol);
    let timed = reading.correlated_n > 0.0;
    let law = NoiseLaw {
        correlated_n: reading.correlated_n,
        time: context.law.time.filter(|_| timed),
        white_n: reading.force_n,
        ..context.law.clone()
    };
    let record = record.with_force(prediction.force);
    let whitening = Whitening::new(&law, &record, &vec![true; record.len()], &variances).ok()?;
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
    fn with_one_pressure_no_proposal_speaks_of_several() {
        let limits = |high| Limits { pressure_pa: [2e5, high], contraction: [0.0, 0.2], period_s: 60.0 };
        for proposal in proposals(&limits(2e5)) {
            let says = limits(2e5).without_count(proposal.says);
            assert!(!says.contains("pressures") || says.contains("from the lowest pressure"), "{says}");
            let pressures = proposal.protocol.blocks.iter().filter(|block| block.held.is_empty());
            assert!(pressures.into_iter().all(|block| block.pressures_pa == [2e5]), "{says}");
            assert_eq!(limits(4e5).without_count(proposal.says), proposal.says);
        }
    }

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
