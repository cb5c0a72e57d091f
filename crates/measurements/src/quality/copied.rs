//! Copied readings: a block of rows, or of one channel, that repeats an earlier block to the last digit.

use super::column::Column;
use super::{Finding, FindingKind, Gate, Severity, rows_in_words};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Fewest consecutive rows that must agree. Noisy readings agree so with a probability of at most 10^-7, those
/// of a moving muscle hardly ever. Readings that are equal more often must agree in more rows.
const BLOCK: usize = 8;
/// Fewest different readings among them.
const DIFFERENT: usize = 6;
/// Coarser readings repeat by chance.
const LEVELS: f64 = 100.0;
/// If more than this fraction of the rows is copied, the readings were made that way.
const MOST: f64 = 0.5;
/// If more than this fraction of the other rows equals the row as far away, a drive repeats itself.
const REPEATS: f64 = 0.2;
/// Fewest other rows, relative to the copied ones, that show whether a drive repeats itself.
const OTHERS: f64 = 0.5;
/// More different distances than this between equal blocks come from a drive as well.
const MOST_LAGS: usize = 20;

/// Rows that repeat earlier ones: in all readings, and in single channels, where nobody knows which of the two
/// blocks was measured.
pub(super) struct Copied {
    pub(super) all: Vec<usize>,
    pub(super) alone: Vec<(&'static str, Vec<usize>)>,
}

pub(super) fn rows(gate: &Gate) -> Copied {
    let is_fine = |column: &&Column<'_>| {
        column.resolution.levels().is_none_or(|levels| levels > LEVELS) && !column.are_set_points()
    };
    let is_measured = |column: &&Column<'_>| column.is_noisy() && is_fine(column);
    let fewest = BLOCK as f64 * Column::rows_for_one(gate.columns.iter().filter(is_fine));
    if fewest > gate.data.len() as f64 {
        return Copied { all: Vec::new(), alone: Vec::new() };
    }
    let key = |row: usize| gate.columns.map(|column| column.values[row].to_bits());
    let pairs = blocks(gate.data.len(), 0.0, key);
    let goes_on = |a: &(usize, usize), b: &(usize, usize)| b.0.abs_diff(a.0) == 1 && b.1.abs_diff(a.1) == 1;
    let is_long = |run: &&[(usize, usize)]| (BLOCK - 1 + run.len()) as f64 >= fewest;
    let pairs: Vec<_> = pairs.chunk_by(goes_on).filter(is_long).flatten().copied().collect();
    // Rows that are equal in their times as well are another finding.
    let is_later = |(earlier, later): &(usize, usize)| {
        gate.data.time().map_or(gate.data.is_path(), |time| time[*earlier].total_cmp(&time[*later]).is_ne())
    };
    let later: Vec<(usize, usize)> = pairs.iter().copied().filter(is_later).collect();
    let all = marked(&later, false);
    let of_all = marked(&pairs, true);
    let alone = gate.columns.iter().filter(is_measured).filter_map(|column| {
        let (name, values) = (column.name, column.values);
        let rows = marked(&blocks(values.len(), OTHERS, |row| values[row].to_bits()), true);
        let rows: Vec<usize> = rows.into_iter().filter(|row| of_all.binary_search(row).is_err()).collect();
        is_few(&rows, values.len()).then_some((name, rows))
    });
    let alone = alone.collect();
    Copied { all: if is_few(&all, gate.data.len()) { all } else { Vec::new() }, alone }
}

fn is_few(rows: &[usize], of: usize) -> bool {
    !rows.is_empty() && rows.len() as f64 <= MOST * of as f64
}

/// First rows of blocks that repeat a block of equal length before them, with the first row of that block, unless
/// the rows around them do as well, or so few are around them that nobody knows.
fn blocks<K: PartialEq + std::hash::Hash + Eq + Copy>(
    rows: usize,
    least_others: f64,
    key: impl Fn(usize) -> K,
) -> Vec<(usize, usize)> {
    // Readings by number. A block with one that is never read again repeats nothing.
    let mut numbers: HashMap<K, usize> = HashMap::with_capacity(rows);
    let mut times: Vec<usize> = Vec::with_capacity(rows);
    let numbered: Vec<usize> = (0..rows)
        .map(|row| {
            let number = *numbers.entry(key(row)).or_insert(times.len());
            match times.get_mut(number) {
                Some(times) => *times += 1,
                None => times.push(1),
            }
            number
        })
        .collect();
    let mut first: HashMap<&[usize], usize> = HashMap::new();
    let mut found: BTreeMap<usize, Vec<(usize, usize)>> = BTreeMap::new();
    let mut repeated = 0;
    for (last, number) in numbered.iter().enumerate() {
        repeated = if times[*number] > 1 { repeated + 1 } else { 0 };
        if repeated < BLOCK {
            continue;
        }
        let row = last + 1 - BLOCK;
        let block = &numbered[row..=last];
        // Few levels repeat by chance, and what stands still repeats itself.
        if (0..BLOCK).filter(|i| !block[..*i].contains(&block[*i])).count() < DIFFERENT {
            continue;
        }
        match first.get(block) {
            Some(earlier) if earlier + BLOCK <= row => {
                found.entry(row - earlier).or_default().push((*earlier, row));
            }
            Some(_) => {}
            None => {
                first.insert(block, row);
            }
        }
    }
    if found.len() > MOST_LAGS {
        return Vec::new();
    }
    let is_alone = |(lag, pairs): &(usize, Vec<(usize, usize)>)| {
        let copied: HashSet<usize> =
            pairs.iter().flat_map(|(earlier, _)| *earlier..earlier + BLOCK).collect();
        let others = (0..rows - lag).filter(|row| !copied.contains(row));
        let equal = others.clone().filter(|row| key(*row) == key(row + lag)).count();
        let others = others.count() as f64;
        others >= least_others * copied.len() as f64 && equal as f64 <= REPEATS * others
    };
    found.into_iter().filter(is_alone).flat_map(|(_, pairs)| pairs).collect()
}

/// The rows of the later blocks, and of the earlier ones if they count, in ascending order.
fn marked(blocks: &[(usize, usize)], with_earlier: bool) -> Vec<usize> {
    let earlier = blocks.iter().filter(|_| with_earlier).map(|(earlier, _)| *earlier);
    let starts = blocks.iter().map(|(_, later)| *later).chain(earlier);
    let mut rows: Vec<usize> = starts.flat_map(|start| start..start + BLOCK).collect();
    rows.sort_unstable();
    rows.dedup();
    rows
}

/// What is said of copied rows and of a copied channel.
pub(super) const ALL: &str = "the readings of a block of earlier rows again, to the last digit";
pub(super) const ALONE: &str = "is the same in two blocks of rows, to the last digit, while the rest differs";

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let Copied { all, alone } = rows(gate);
    let instead = "nothing: these rows don't count; remove what was copied";
    let all_says = |count| format!("{}: {ALL}", rows_in_words(count));
    let all = gate.finding_if_any(FindingKind::DuplicateRow, Severity::Warning, &all, all_says, instead);
    let alone = alone.iter().filter_map(|(name, rows)| {
        let says = |count| format!("{}: the {name} {ALONE}", rows_in_words(count));
        gate.finding_if_any(FindingKind::DuplicateRow, Severity::Warning, rows, says, instead)
    });
    all.into_iter().chain(alone).collect()
}
