//! Something happened during the test. What acts on the muscle acts on all of its rows, so nothing is named
//! that some rows ask for and others deny:
//!
//! - *a jump* within a sweep (a fitting that slipped, a sensor that was knocked): the rows before it and those
//!   after it are diagnosed each on their own, and what is named on one side must be named on the other,
//! - *odd rows*, as files, sweeps or stretches of a record (a sensor zeroed anew, another unit, a reversed column,
//!   a reading that is held): those few whose misfit stands far out are left out. If nothing is then missing,
//!   although what was named would have shown in the others, they deny it,
//! - *exchanged specimens*: if nothing is missing when two specimens have each other's numbers, they may have
//!   each other's name.

use bulge_measurements::Data;
use bulge_muscles::shown::shortened;
use std::collections::{BTreeMap, BTreeSet};

use crate::comparison::rows::lines;
use crate::diagnosis::document::{Diagnosis, Verdict};
use crate::diagnosis::write::Findings;
use crate::median::median;

/// Fewest parts among which one can be odd, and how many of them may be.
const FEWEST: usize = 3;
const ONE_IN: usize = 4;
/// Stretches into which a record is cut: short ones hide no event, and each needs some rows.
const STRETCHES: usize = 24;
/// Mean square of its misfit over the median of all from which a part is odd. An effect of the muscle
/// grows with pressure or length, which makes a factor of 2 or 3 between sweeps.
const ODD: f64 = 4.0;
/// Sum of squares, in variances of the noise, that what was named would explain in the others: 8 sigma, from
/// which on effects are detected in nearly all tests (suite).
const EXPECTED: f64 = 64.0;

/// Most specimens that are exchanged in pairs.
const MOST_SPECIMENS: usize = 5;

/// Diagnoses of the same data made anew; none if there is no answer.
#[derive(Clone, Copy)]
pub(crate) struct Anew<'a> {
    /// Without some rows of the files.
    pub(crate) without: &'a dyn Fn(&[usize]) -> Option<Diagnosis>,
    /// With the numbers of two specimens exchanged.
    pub(crate) exchanged: &'a dyn Fn([&str; 2]) -> Option<Diagnosis>,
}

/// What is said of an event across which no effect may be named, if there is one.
pub(crate) fn event(
    found: &Findings<'_>,
    data: &Data,
    groups: &[Vec<usize>],
    anew: Anew<'_>,
) -> Option<String> {
    if !found.verdict().0.shows_effects() {
        return None;
    }
    jump(found, data, groups, anew)
        .or_else(|| odd(found, data, groups, anew))
        .or_else(|| exchanged(data, anew))
}

/// Two specimens with each other's numbers, of which nothing is missing.
fn exchanged(data: &Data, anew: Anew<'_>) -> Option<String> {
    let names = data.specimens();
    if names.len() > MOST_SPECIMENS {
        return None;
    }
    let pairs = (1..names.len()).flat_map(|other| (0..other).map(move |one| [one, other]));
    let fits = |pair: &[usize; 2]| {
        let found = (anew.exchanged)(pair.map(|place| names[place].as_str()));
        found.is_some_and(|found| found.verdict == Verdict::Adequate)
    };
    let [one, other] = pairs.into_iter().find(fits)?.map(|place| shortened(&names[place]));
    Some(format!(
        "with the numbers of the specimens `{one}` and `{other}` exchanged nothing is missing: has each the name of the other, in the data or in the muscle \
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

fn odd(
    found: &Findings<'_>,
    data: &Data,
    groups: &[Vec<usize>],
    Anew { without, .. }: Anew<'_>,
) -> Option<String> {
    let sweep = |row: usize| data.sweeps().partition_point(|sweep| sweep.rows.end <= row);
    let file = |row: usize| data.line(row).0;
    let stretch = |row: usize| row * STRETCHES / data.len();
    let of: [&dyn Fn(usize) -> usize; 3] = [&file, &sweep, &stretch];
    let mut tried = BTreeSet::new();
    let few = of.into_iter().filter_map(|part| {
        let places = stand_out(found, groups, part)?;
        Some((0..data.len()).filter(|row| places.contains(&part(*row))).collect::<Vec<usize>>())
    });
    few.chain(sides(found, data, groups)).find_map(|odd| {
        let is_odd: BTreeSet<usize> = odd.iter().copied().collect();
        if !is_seen(found, groups, |row| !is_odd.contains(&row)) || !tried.insert(odd.clone()) {
            return None;
        }
        let rest = without(&odd)?;
        let claimed = found.claims();
        let denied = match rest.verdict {
            Verdict::Adequate => true,
            Verdict::Missing => {
                !claimed.is_empty() && !claimed.iter().any(|claim| names(&rest, *claim))
            }
            Verdict::Unknown | Verdict::CannotTell => false,
        };
        denied.then(|| {
            let others: Vec<usize> = (0..data.len()).filter(|row| !is_odd.contains(row)).collect();
            format!(
                "some rows ask for something that the others deny: without line {} {} (line {}). See what happened there: a fitting that slipped, a sensor zeroed \
                 anew, reversed or held, another unit, another specimen",
                lines(data, &odd),
                said(Some(&rest)),
                lines(data, &others),
            )
        })
    })
}

/// The rows behind the clearest jump in the misfit of the base, and those before it: what stays after an event
/// may be most of a record.
fn sides(found: &Findings<'_>, data: &Data, groups: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let jump = found.search.stages.first().and_then(|base| base.linear.jump(found.context));
    let Some(row) = jump.and_then(|jump| groups.get(jump.row)?.first().copied()) else { return Vec::new() };
    let own = |other: &usize| data.specimen_of(*other) == data.specimen_of(row);
    vec![(row..data.len()).filter(own).collect(), (0..row).filter(own).collect()]
}

/// Whether what is named would show in these rows of the files, or nothing is named.
fn is_seen(found: &Findings<'_>, groups: &[Vec<usize>], is_kept: impl Fn(usize) -> bool) -> bool {
    let Some(base) = found.search.stages.first() else { return false };
    let both = base.linear.white.iter().zip(&found.last().linear.white);
    let kept = groups.iter().zip(both).filter(|(group, _)| group.first().is_some_and(|row| is_kept(*row)));
    let expected: f64 = kept.map(|(_, (base, last))| (base - last).powi(2)).sum();
    expected > EXPECTED || found.claims().is_empty()
}

/// The few parts of the data whose misfit of the base stands far out.
fn stand_out(
    found: &Findings<'_>,
    groups: &[Vec<usize>],
    part: &dyn Fn(usize) -> usize,
) -> Option<BTreeSet<usize>> {
    // Squares of the misfit, and rows, part by part.
    let mut sums: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for (group, misfit) in groups.iter().zip(&found.search.stages.first()?.linear.white) {
        let sum = sums.entry(part(*group.first()?)).or_default();
        *sum = [sum[0] + misfit * misfit, sum[1] + 1.0];
    }
    if sums.len() < FEWEST {
        return None;
    }
    let mean = |[square, rows]: [f64; 2]| square / rows;
    let usual = median(&mut sums.values().copied().map(mean).collect::<Vec<_>>()).max(1.0);
    let odd: BTreeSet<usize> =
        sums.iter().filter(|(_, sum)| mean(**sum) > ODD * usual).map(|(place, _)| *place).collect();
    (!odd.is_empty() && odd.len() <= (sums.len() / ONE_IN).max(1)).then_some(odd)
}

/// An effect that is claimed, and its family.
pub(crate) type Claim<'a> = (&'a str, &'a str);

/// Whether a diagnosis names the family of an effect, or has the effect in a class.
fn names(found: &Diagnosis, (effect, family): Claim<'_>) -> bool {
    found.missing.iter().any(|one| one.family == family || one.class.iter().any(|name| name == effect))
}

/// A verdict in a few words.
fn said(found: Option<&Diagnosis>) -> String {
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
