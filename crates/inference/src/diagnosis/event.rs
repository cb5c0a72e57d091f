//! Something happened during the test. What acts on the muscle acts on all of its rows, so nothing is named
//! that some rows ask for and others deny:
//!
//! - *a jump* within a sweep (a fitting that slipped, a sensor that was knocked): the rows before it and those
//!   after it are diagnosed each on their own, and what is named on one side must be named on the other,
//! - *odd rows* ask for what the others deny,
//! - *a late column*: nothing is missing if it is moved by some rows,
//! - *each sweep* has a zero or a gain of its own, which is the likelier cause of what isn't seen within the sweeps,
//! - *readings that are wrong*, rows out of their order, or a specimen that changes within a sweep, stand beside what no effect
//!   explains,
//! - *a wrong channel*: nothing is left if a bit of its converter is stuck, if it bends below a ceiling, or if it stands in the
//!   reverse order in some sweeps,
//! - *exchanged specimens*: if nothing is missing when two specimens have each other's numbers, they may have
//!   each other's name.

use bulge_measurements::Data;
use bulge_muscles::shown::shortened;

use crate::comparison::analysis::Analysis;
use crate::comparison::document::LeftOut;
use crate::comparison::rows::lines;
use crate::diagnosis::document::{Diagnosis, Verdict};
use crate::diagnosis::each_sweep::each_sweep;
use crate::diagnosis::late::Late;
use crate::diagnosis::odd::odd;
use crate::diagnosis::trimmed::{Linearised, by_chance};
use crate::diagnosis::write::Findings;
use crate::diagnosis::wrong_channel::{bent_channel, wrong_channel};
use crate::vector::minus;
use bulge_numerics::vector::dot;

/// Most specimens that are compared with each other.
pub(crate) const MOST_SPECIMENS: u32 = 5;

/// Fewest wrong readings beside which nothing is said to be unknown: one or two spikes happen in any test.
const DISTURBED: usize = 3;

/// Fewest sweeps for each change of the specimen within a sweep label that is taken for an error.
const RELABELLED: usize = 4;

/// Diagnoses of the same data made anew; none if there is no answer.
#[derive(Clone, Copy)]
pub(crate) struct Anew<'a> {
    /// Without some rows of the files.
    pub(crate) without: &'a dyn Fn(&[usize]) -> Option<Diagnosis>,
    /// With the numbers of two specimens exchanged.
    pub(crate) exchanged: &'a dyn Fn([&str; 2]) -> Option<Diagnosis>,
    /// With a column moved by some rows.
    pub(crate) moved: &'a dyn Fn(Late) -> Option<Diagnosis>,
}

/// What is said of an event across which no effect may be named, if there is one.
pub(crate) fn event(
    found: &Findings<'_>,
    analysis: &Analysis<'_>,
    groups: &[Vec<usize>],
    anew: Anew<'_>,
) -> Option<String> {
    let data: &Data = &analysis.data;
    let verdict = found.verdict().0;
    if verdict == Verdict::CannotTell && !found.last().added.is_empty() {
        // Where what was found may not be named, a late column may explain it.
        return late(found, analysis, anew);
    }
    if !verdict.shows_effects() {
        return None;
    }
    let among_the_rows = || {
        let base = &found.search.stages.first()?.confirmed;
        let linear = Linearised::of(&base.prepared, &base.theta, found.context.record).ok()?;
        late(found, analysis, anew)
            .or_else(|| wrong_channel(found, &linear, data, groups))
            .or_else(|| odd(found, &linear, data, groups, anew))
            .or_else(|| each_sweep(found, &linear, data, groups))
            // Rows that ask for a ceiling say more of it than a twin of what was named does.
            .or_else(|| bent_channel(found, &linear, data, groups))
    };
    let event = jump(found, data, groups, anew).or_else(among_the_rows);
    event.or_else(|| exchanged(found, data, anew)).or_else(|| disturbed(found, analysis))
}

/// What no effect explains beside a specimen that changes within a sweep, in rows whose order is lost, or beside readings that
/// are known to be wrong: what spoilt those may have spoilt others, less visibly.
fn disturbed(found: &Findings<'_>, analysis: &Analysis<'_>) -> Option<String> {
    let data = &analysis.data;
    if found.verdict().0 != Verdict::Unknown {
        return None;
    }
    let changes = data.specimen_changes();
    // Labels of several specimens each are a habit, not an error.
    if !changes.is_empty() && RELABELLED * changes.len() <= data.sweeps().len() {
        return Some(format!(
            "no effect of the catalogue explains these data, and the specimen changes within a sweep (line {}): have rows there the name of another one? See which \
             was on the bench, and ask again",
            lines(data, &changes)
        ));
    }
    if data.is_out_of_order() {
        return Some(
            "no effect of the catalogue explains these data, whose rows aren't in the order in which they were measured: noise, friction and drift, which follow the \
             time, look like a structure there. Export the rows as they were measured, and ask again"
                .to_owned(),
        );
    }
    let against = data.against_the_motion();
    if !against.is_empty() {
        return Some(format!(
            "no effect of the catalogue explains these data, and their directions are against the motion (line {}): does the motion count the other way, or were rows \
             or labels exchanged? See which, and ask again",
            lines(data, &against)
        ));
    }
    let wrong: Vec<&LeftOut> = analysis.used.left_out.iter().filter(|left_out| left_out.is_wrong()).collect();
    let rows: usize = wrong.iter().map(|left_out| left_out.rows).sum();
    let said = |one: &&LeftOut| format!("line {} ({})", one.lines, one.why);
    (rows >= DISTURBED).then(|| {
        format!(
            "no effect of the catalogue explains these data, and they hold readings that are wrong: {}. They don't count, but what spoilt them may have spoilt others \
             that look sound: see what happened, repeat these sweeps, and ask again",
            wrong.iter().map(said).collect::<Vec<_>>().join("; ")
        )
    })
}

/// A column that is late, without which nothing is missing.
fn late(found: &Findings<'_>, analysis: &Analysis<'_>, anew: Anew<'_>) -> Option<String> {
    let alike = Late::of(found, analysis);
    let is_all = (anew.moved)(*alike.first()?).is_some_and(|found| found.verdict == Verdict::Adequate);
    is_all.then(|| Late::asks(&alike, &analysis.data))
}

/// Two specimens with each other's numbers, of which nothing is missing; or nothing is known to be, and they explain
/// half of what was named, without a number.
fn exchanged(found: &Findings<'_>, data: &Data, anew: Anew<'_>) -> Option<String> {
    let names = data.specimens();
    if names.len() > MOST_SPECIMENS as usize {
        return None;
    }
    let pairs = (1..names.len()).flat_map(|other| (0..other).map(move |one| [one, other]));
    let record = found.context.record;
    let left = |force: &[f64]| minus(record.force(), force);
    let [base, last] = [found.search.stages.first()?, found.last()].map(|stage| left(&stage.linear.force));
    let (base, chance) = (dot(&base, &base), by_chance(&last));
    // No number is fitted for it.
    let half = base - (0.5 * (base - dot(&last, &last))).max(chance);
    let enough = (half.max(0.0) / record.len().max(1) as f64).sqrt();
    let fits = |pair: [usize; 2]| {
        let found = (anew.exchanged)(pair.map(|place| names[place].as_str()))?;
        let is_less = || found.ladder.first().is_some_and(|base| base.rmse_n < enough);
        let says = match found.verdict {
            Verdict::Adequate => "nothing is missing",
            Verdict::CannotTell if is_less() => "most of what would be named otherwise is gone",
            _ => return None,
        };
        Some((pair, says))
    };
    let (pair, says) = pairs.into_iter().find_map(fits)?;
    let [one, other] = pair.map(|place| shortened(&names[place]));
    Some(format!(
        "with the numbers of the specimens `{one}` and `{other}` exchanged {says}: has each the name of the other, in the data or in the muscle \
         file? Correct it, and ask again"
    ))
}

fn jump(
    found: &Findings<'_>,
    data: &Data,
    groups: &[Vec<usize>],
    Anew { without, .. }: Anew<'_>,
) -> Option<String> {
    let (row, what) = found.jump_left()?;
    let row = *groups.get(row)?.first()?;
    let own = |other: &usize| data.specimen_of(*other) == data.specimen_of(row);
    let sides: [Vec<usize>; 2] = [(0..row).filter(own).collect(), (row..data.len()).filter(own).collect()];
    let [before, after] = [without(&sides[1]), without(&sides[0])];
    let claimed = found.claims();
    if !claimed.is_empty() && claimed.iter().all(|claim| is_on_both([&before, &after], *claim)) {
        return None;
    }
    Some(format!(
        "{what}, as if a fitting had slipped or a sensor was knocked. Before it (line {}) {}; after it (line {}) {}. See what happened there, and diagnose the \
         rows of one state of the rig",
        lines(data, &sides[0]),
        said(before.as_ref()),
        lines(data, &sides[1]),
        said(after.as_ref()),
    ))
}

/// Whether an effect may be what is named on both sides of a jump, or on one of them if the other can't tell.
fn is_on_both(sides: [&Option<Diagnosis>; 2], claim: Claim<'_>) -> bool {
    let on = |side: &Option<Diagnosis>| side.as_ref().is_some_and(|found| names(found, claim));
    let silent =
        |side: &Option<Diagnosis>| side.as_ref().is_none_or(|found| found.verdict == Verdict::CannotTell);
    sides.iter().any(|side| on(side)) && sides.iter().all(|side| on(side) || silent(side))
}

/// An effect that is claimed, and its family.
pub(crate) type Claim<'a> = (&'a str, &'a str);

/// Whether a diagnosis names the family of an effect, or has the effect in a class.
pub(crate) fn names(found: &Diagnosis, (effect, family): Claim<'_>) -> bool {
    found.missing.iter().any(|one| one.family == family || one.class.iter().any(|name| name == effect))
}

/// A verdict in a few words.
pub(crate) fn said(found: Option<&Diagnosis>) -> String {
    let Some(found) = found else { return "the rows don't tell".to_owned() };
    match found.verdict {
        Verdict::Adequate => "nothing is missing".to_owned(),
        Verdict::Missing => {
            let names: Vec<&str> = found.missing.iter().map(|missing| missing.effect.as_str()).collect();
            format!("{} would be missing", names.join(" and "))
        }
        Verdict::Unknown => "no effect of the catalogue explains the rows".to_owned(),
        Verdict::CannotTell => "the rows don't tell".to_owned(),
    }
}
