//! Choice and colours of the pressure levels, and how specimens share a plot.

use crate::comparison::legend::{self, Mark};
use crate::comparison::number::bar;
use crate::palette::{self, Rgb};

/// At most `most` indices of `count`, evenly spread, including the first and the last.
pub(crate) fn spread(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    let last = most.saturating_sub(1).max(1);
    let mut chosen: Vec<usize> = (0..most).map(|i| (i * (count - 1) + last / 2) / last).collect();
    chosen.dedup();
    chosen
}

/// The distinct pressures (to 0.1 %), ascending.
pub(crate) fn distinct(pressures: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut found: Vec<f64> = pressures.collect();
    found.sort_by(f64::total_cmp);
    found.dedup_by(|a, b| same(*a, *b));
    found
}

/// Whether two pressures are the same level.
pub(crate) fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-3 * a.abs().max(b.abs())
}

/// The distinct specimens, in order.
pub(crate) fn specimens<'a>(names: impl Iterator<Item = &'a String>) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for name in names {
        if !found.contains(&name.as_str()) {
            found.push(name);
        }
    }
    found
}

/// A sentence where not all are shown.
pub(crate) fn left_out(shown: usize, all: usize, what: &str) -> String {
    if shown < all { format!(" Shown are {shown} of {all} {what}.") } else { String::new() }
}

/// The levels of a plot that are shown, with their colours.
pub(crate) struct Shown {
    levels: Vec<f64>,
    /// Total number of levels.
    pub(crate) of: usize,
}

impl Shown {
    /// Chooses at most `most` of the pressures.
    pub(crate) fn new(pressures: impl Iterator<Item = f64>, most: usize) -> Self {
        let all = distinct(pressures);
        let levels = spread(all.len(), most).into_iter().map(|i| all[i]).collect();
        Self { levels, of: all.len() }
    }

    /// Colour of a pressure; none if it isn't shown.
    pub(crate) fn colour(&self, pressure_pa: f64) -> Option<Rgb> {
        let place = self.levels.iter().position(|level| same(*level, pressure_pa))?;
        Some(palette::colour(place, self.levels.len()))
    }

    /// Entries of a legend: the models, then the levels, highest first as the curves mostly lie.
    pub(crate) fn entries(&self, has_effects: bool) -> Vec<(Mark, String)> {
        let levels = self.levels.iter().rev().filter_map(|p| Some((Mark::Box(self.colour(*p)?), bar(*p))));
        legend::models(has_effects).into_iter().chain(levels).collect()
    }

    /// Remark of a caption about levels that aren't shown.
    pub(crate) fn caption(&self) -> String {
        left_out(self.levels.len(), self.of, "pressure levels")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_has_both_ends_and_no_level_twice() {
        assert_eq!(spread(3, 8), [0, 1, 2]);
        assert_eq!(spread(40, 3), [0, 20, 39]);
        assert_eq!(spread(9, 8).len(), 8);
        assert_eq!(spread(0, 3), [0_usize; 0]);
        for n in 1..60 {
            let chosen = spread(n, 8);
            assert!(
                chosen[0] == 0 && chosen.last() == Some(&(n - 1)) && chosen.len() == n.min(8),
                "{n}: {chosen:?}"
            );
        }
    }

    #[test]
    fn levels_that_differ_by_rounding_are_one() {
        let shown = Shown::new([2e5, 1e5, 1.000_01e5, 3e5].into_iter(), 2);
        assert_eq!((shown.of, shown.levels.as_slice()), (3, &[1e5, 3e5][..]));
        assert!(shown.colour(1.000_01e5).is_some() && shown.colour(2e5).is_none());
        assert_eq!(shown.caption(), " Shown are 2 of 3 pressure levels.");
        assert_eq!(shown.entries(false)[2].1, "3 bar");
    }
}
